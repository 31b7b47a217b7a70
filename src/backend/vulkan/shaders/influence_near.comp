#version 460
/* The leaves of the hierarchies near a tile's points, in the order in which core/influence_near.h visits them: of each
 * half nodes of level 0 from the last one on, and their children from the first one on. A work group looks at all of
 * these nodes at once, so that levels above them would save nothing. 2 barriers for as many nodes, or children, as
 * there are invocations. */
#extension GL_GOOGLE_include_directive : require
#include "list_group.glsl"
#include "bridge.glsl"
#include "tile.glsl"
#include "influence.glsl"
#include "compact.glsl"

near_query tile_query() {
    near_query q = asks();
    q.lo = vec3(tile_real(FOUND_BOX), tile_real(FOUND_BOX + 1u), tile_real(FOUND_BOX + 2u));
    q.hi = vec3(tile_real(FOUND_BOX + 3u), tile_real(FOUND_BOX + 4u), tile_real(FOUND_BOX + 5u));
    q.back = -uintBitsToFloat(NEAR_INFINITY);
    return q;
}

void main() {
    near_query q = tile_query();
    influence_region r = near_region(q);
    float scale = near_scale(q);
    uint found = 0u, before;
    compact_begin();
    for (uint k = 0u; k < NEAR_HALVES && q.lo.x <= q.hi.x; k++) {
        uint nodes = half_word(k, HALF_NODES), children = half_word(k, HALF_CHILDREN);
        uint parents = half_word(k, HALF_PARENTS);
        for (uint first = 0u; first < nodes; first += WORKERS) {
            uint node = nodes - 1u - (first + worker); /* below 0: beyond all */
            bool on = node < nodes;
            if (on && parents != 0u) {
                near_children c = child_load(parents, node);
                on = box_near(c.lo, c.hi, r, c.root * scale);
            }
            uint n = compact(on, before);
            if (on)
                chosen_[before] = node;
            settle();
            for (uint at = worker / 16u; at - worker / 16u < n; at += WORKERS / 16u) {
                uint leaf = 0u;
                on = at < n;
                if (on) {
                    leaf = 16u * chosen_[at] + worker % 16u;
                    near_children c = child_load(children, leaf);
                    on = box_near(c.lo, c.hi, r, c.root * scale);
                }
                uint more = compact(on, before);
                if (on && found + before < FOUND_ROOM)
                    tile_store(FOUND_LEAF + found + before, leaf | (k == 0u ? 0u : LEAF_MOVES));
                found += more;
                settle();
            }
        }
    }
    if (FIRST_WORKER)
        tile_store(FOUND_LEAVES, found > FOUND_ROOM ? FOUND_ALL : found);
}
