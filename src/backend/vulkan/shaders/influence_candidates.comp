#version 460
/* Each pixel's reservoir, chosen among the samples of its lane of a set. */
#extension GL_GOOGLE_include_directive : require
#include "bridge.glsl"
#include "pixel.glsl"
#include "list_pixel.glsl"
#include "core/measured.h"
#include "core/shading.h"
#include "surfaces.glsl"
#include "influence.glsl"
#include "influence_asked.glsl"

uint row_; /* word of the lane's first sample */
uint sums_;
float inverse_; /* of the sample that was loaded last: in the end, of the one that is chosen */

presample_pick presample_pick_load(uint i) {
    uint at = row_ + i * DRAW_WORDS;
    inverse_ = uintBitsToFloat(HERE.scratch.at[at + 32u]);
    return presample_pick(HERE.scratch.at[at], HERE.scratch.at[at + 16u], inverse_);
}
presample presample_load(int i) {
    presample_pick k = presample_pick_load(uint(i));
    return presample_of(light_load(k.light), unit_low(k.place), unit_high(k.place));
}
float presample_inverse(int i) { return uintBitsToFloat(HERE.scratch.at[row_ + uint(i) * DRAW_WORDS + 32u]); }
uint sum_word(uint i) { return sums_ + i * HERE.slots + pixel_; }
void weighed_store(int i, float sum) { HERE.scratch.at[sum_word(uint(i))] = floatBitsToUint(sum); }
float weighed_at(uint i) { return uintBitsToFloat(HERE.scratch.at[sum_word(i)]); }
float weighed_load(int i) { return weighed_at(uint(i)); }

void main() {
    if (!in_grid())
        return;
    place p = my_place();
    find_pixel(p);
    reservoir q = reservoir_empty();
    if (receives(receiver_at(HERE.surfaces, p.block, p.lane))) {
        uint word = tile_load(FOUND_PIXEL + 16u * number_in_tile(p) + p.lane);
        row_ = draws_at(tile_, word >> 20) + (word >> 16 & 15u);
        sums_ = sums_at();
        float xi = rng(key_at(p, FRAME.index), DIM_CANDIDATE);
        q = ris_presampled(surf_at(HERE.surfaces, p.block, p.lane, eye_now()), xi, int(HERE.draws));
        if ((HERE.views & VK_VIEW_LIGHTS) != 0u)
            HERE.view_lights.at[p.slot] = float(found_count(word & 0xffffu));
        if ((HERE.views & VK_VIEW_DENSITY) != 0u && q.w > 0.0)
            HERE.view_density.at[p.slot] = expected_draws(HERE.draws, inverse_);
    }
    reservoir_put(HERE.target, p.block, p.lane, q);
    HERE.target_visible.at[p.slot] = 0u;
}
