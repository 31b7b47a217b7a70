#version 460
/* Each pixel's reservoir, of the candidates of its block's subset. */
#extension GL_GOOGLE_include_directive : require
#include "bridge.glsl"
#include "pixel.glsl"
#include "core/measured.h"
#include "core/shading.h"
#include "surfaces.glsl"
#include "presample.glsl"

void main() {
    if (!in_grid())
        return;
    place p = my_place();
    reservoir q = reservoir_empty();
    if (receives(receiver_at(HERE.surfaces, p.block, p.lane))) {
        row_ = presample_subset(FRAME.seed, p.block, FRAME.index, HERE.subsets) * HERE.subset_rows;
        lane_ = p.lane;
        float xi = rng(key_at(p, FRAME.index), DIM_CANDIDATE);
        q = ris_presampled_twice(surf_at(HERE.surfaces, p.block, p.lane, eye_now()), xi, int(HERE.draws));
    }
    if ((HERE.views & VK_VIEW_DENSITY) != 0u && q.w > 0.0) {
        float inverse = float(HERE.light_count);
        if (HERE.by_power != 0u)
            inverse = alias_load(q.light).inverse;
        HERE.view_density.at[p.slot] = expected_draws(HERE.draws, inverse);
    }
    reservoir_put(HERE.target, p.block, p.lane, q);
    HERE.target_visible.at[p.slot] = 0u;
}
