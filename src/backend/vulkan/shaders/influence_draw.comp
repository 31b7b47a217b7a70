#version 460
/* A tile's sets of samples (core/influence_draw.h), an invocation each sample: from what the lane's points list, or one
 * of those that are drawn from all lights before the frame. */
#extension GL_GOOGLE_include_directive : require
#include "list_group.glsl"
#include "bridge.glsl"
#include "tile.glsl"
#include "influence.glsl"
#include "influence_asked.glsl"

uint influence_found(uint place) { return HERE.scratch.at[pool_word(place)]; }

influence_asked asked_of(uint group) {
    return influence_asked(group_region(group), tile_real(group_word(group, GROUP_LEAST)), found_count(group),
                           found_from(group));
}

presample_pick draw(influence_asked a, uint number, uint row, uint lane) {
    uint listed = influence_listed(HERE.draws, FRAME.uniform_every);
    presample_pick k;
    bool in_list = a.count > 0u;
    if (row < listed) {
        k = influence_draw(a, presample_key(FRAME.seed, number, FRAME.index, 0u), row, lane,
                           presample_share(16u * listed), HERE.light_count, 0.0);
    } else {
        uint subset = presample_subset(FRAME.seed, number, FRAME.index, HERE.subsets);
        uint at = subset * HERE.subset_rows + row - listed;
        near_query q = asks();
        k.light = HERE.samples.at[at].light[lane];
        k.place = HERE.samples.at[at].place[lane];
        uint volume = influence_volume(k.light);
        influence v = influence_load(volume);
        in_list = influence_lists(volume, v, influence_turn(v), a, q.scale, q.least > 0.0);
    }
    k.inverse = influence_inverse(in_list, a, HERE.light_count, int(HERE.draws), int(FRAME.uniform_every));
    return k;
}

void main() {
    uint sets = tile_load(FOUND_SETS), first = tile_number_ * INFLUENCE_SETS;
    EACH_INDEX(i, sets * HERE.draws * 16u) {
        uint set = i / (16u * HERE.draws), row = i / 16u % HERE.draws, lane = i % 16u;
        presample_pick k = draw(asked_of(tile_load(FOUND_LANE + 16u * set + lane)), first + set, row, lane);
        uint at = draws_at(tile_, set) + row * DRAW_WORDS + lane;
        HERE.scratch.at[at] = k.light;
        HERE.scratch.at[at + 16u] = k.place;
        HERE.scratch.at[at + 32u] = floatBitsToUint(k.inverse);
    }
}
