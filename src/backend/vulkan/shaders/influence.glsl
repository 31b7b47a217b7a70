/* Influence volumes on the device (influence_memory.h), and what points of tiles have found among them. After the
 * bridge. */
#include "backend/vulkan/influence_memory.h"
#include "core/influence_find.h"

uint volumes_word(uint at) { return HERE.volumes.at[at]; }
float volumes_real(uint at) { return uintBitsToFloat(volumes_word(at)); }
vec3 volumes_three(uint at, uint step) {
    return vec3(volumes_real(at), volumes_real(at + step), volumes_real(at + 2u * step));
}

influence influence_load(uint volume) {
    uint at = volumes_word(VOLUMES_RECORDS) + VOLUME_WORDS * volume;
    return influence(volumes_three(at, 1u), volumes_real(at + 3u), volumes_three(at + 4u, 1u), volumes_real(at + 7u));
}
uint influence_volume(uint id) { return volumes_word(volumes_word(VOLUMES_OF_LIGHT) + id); }
bool influence_seen(uint volume, influence_region r) {
    uint box_of = volumes_word(VOLUMES_BOX_OF);
    if (box_of == 0u)
        return true;
    uint at = volumes_word(VOLUMES_BOXES) + 6u * volumes_word(box_of + volume);
    return influence_meets(volumes_three(at, 1u), volumes_three(at + 3u, 1u), r);
}

/* The lights of a volume: so many from that place of VOLUMES_IDS on. */
uvec2 lights_of_volume(uint volume) {
    uint first = volumes_word(VOLUMES_FIRST);
    if (first == 0u)
        return uvec2(volume, 1u);
    uint begin = volumes_word(first + volume);
    return uvec2(begin, volumes_word(first + volume + 1u) - begin);
}

/* ---- hierarchies ---- */

uint half_word(uint k, uint field) { return volumes_word(VOLUMES_HALF + HALF_WORDS * k + field); }
near_children child_load(uint nodes, uint child) {
    uint at = nodes + NODE_WORDS * (child / 16u) + child % 16u;
    return near_children(volumes_three(at, 16u), volumes_three(at + 48u, 16u), volumes_real(at + 96u));
}

/* The half of a leaf, and its first volume. */
uint half_of_leaf(uint leaf) { return (leaf & LEAF_MOVES) != 0u ? 1u : 0u; }
near_children leaf_load(uint leaf) {
    return child_load(half_word(half_of_leaf(leaf), HALF_CHILDREN), leaf & ~LEAF_MOVES);
}
uint volume_of_leaf(uint leaf) {
    return half_word(half_of_leaf(leaf), HALF_FIRST) + 16u * (leaf & ~LEAF_MOVES);
}

/* ---- queries ---- */

near_query asks() { return near_asks(FRAME.influence, volumes_real(VOLUMES_SCALE)); }

uint group_word(uint group, uint field) { return FOUND_GROUP + field * FOUND_MOST_GROUPS + group; }
