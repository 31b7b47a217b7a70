#version 460
/* What each group of a tile's points finds in the leaves near the tile: at first lights by what they give, in the bins
 * of the rule, and how many there are (core/influence_find.h); later (HERE.first is 1) those that give as much as was
 * settled, which go into the pool. 2 barriers for as many leaves, or volumes, as there are invocations. */
#extension GL_GOOGLE_include_directive : require
#include "list_group.glsl"
#include "bridge.glsl"
#include "tile.glsl"
#include "influence.glsl"
#include "influence_asked.glsl"
#include "compact.glsl"

bool takes_ = HERE.first != 0u;
uint leaves_;

/* Volumes that were found at once, in their order. */
shared uint held_[WORKERS];
shared uint lights_[WORKERS];
shared float gives_[WORKERS];
shared uint bin_[WORKERS];

/* ---- leaves ---- */

/* Places of children of level 0 in both halves, some of which are of no child. */
uint places_of(uint k) { return 16u * half_word(k, HALF_NODES); }

uint leaf_at(uint i) {
    if (leaves_ != FOUND_ALL)
        return tile_load(FOUND_LEAF + i);
    uint k = i < places_of(0u) ? 0u : 1u;
    uint at = i - (k == 0u ? 0u : places_of(0u));
    return (places_of(k) - 16u - (at & ~15u) + (at & 15u)) | (k == 0u ? 0u : LEAF_MOVES);
}

/* ---- what is found ---- */

rule_bin bin_of_worker_;
uint found_; /* lights */

/* What a round found: n volumes. A bin has its worker. */
void look(uint n) {
    if (worker >= RULE_BINS)
        return;
    for (uint i = 0u; i < n; i++)
        if (bin_[i] == worker)
            bin_of_worker_ = rule_bin_add(bin_of_worker_, float(lights_[i]), gives_[i]);
}

uint lights_before(uint end) {
    uint sum = 0u;
    if (volumes_word(VOLUMES_FIRST) == 0u)
        return end;
    for (uint i = 0u; i < end; i++)
        sum += lights_[i];
    return sum;
}

void take(uint n, uint to) {
    if (worker >= n)
        return;
    uvec2 of = lights_of_volume(held_[worker]);
    uint at = pool_word(to + lights_before(worker));
    for (uint k = 0u; k < of.y; k++)
        HERE.scratch.at[at + k] = volumes_word(volumes_word(VOLUMES_IDS) + of.x + k);
}

/* Looks at 16 volumes of each leaf that was chosen. */
void look_at_leaves(uint leaves, uint to, influence_region r, float scale, float least, rule_range range) {
    uint before;
    for (uint at = worker / 16u; at - worker / 16u < leaves; at += WORKERS / 16u) {
        uint volume = 0u;
        float gives = 0.0;
        if (at < leaves) {
            uint leaf = chosen_[at];
            volume = volume_of_leaf(leaf) + worker % 16u;
            if (volume < half_word(half_of_leaf(leaf), HALF_END)) {
                influence v = influence_load(volume);
                gives = near_gives(volume, v, influence_turn(v), r, scale, least);
            }
        }
        uint n = compact(gives > 0.0, before);
        if (gives > 0.0) {
            held_[before] = volume;
            lights_[before] = lights_of_volume(volume).y;
            gives_[before] = gives;
            bin_[before] = rule_place(range, gives);
        }
        settle();
        if (takes_)
            take(n, to + found_);
        else if (least > 0.0)
            look(n);
        found_ += lights_before(n);
    }
}

void store_bin(uint group) {
    if (worker >= RULE_BINS)
        return;
    uint at = pool_word(tile_ * FOUND_POOL + ((group - 1u) * RULE_BINS + worker) * BIN_WORDS);
    HERE.scratch.at[at] = floatBitsToUint(bin_of_worker_.lights);
    HERE.scratch.at[at + 1u] = floatBitsToUint(bin_of_worker_.e);
    HERE.scratch.at[at + 2u] = floatBitsToUint(bin_of_worker_.e2);
}

void group_looks(uint group, near_query q) {
    influence_region r = group_region(group);
    float least = tile_real(group_word(group, GROUP_LEAST));
    rule_range range = rule_from(least);
    uint to = takes_ ? found_from(group) : 0u, before;
    uint most = leaves_ != FOUND_ALL ? leaves_ : places_of(0u) + places_of(1u);
    found_ = 0u;
    bin_of_worker_ = rule_bin_empty();
    for (uint first = 0u; first < most; first += WORKERS) {
        uint leaf = 0u;
        bool on = first + worker < most;
        if (on) {
            leaf = leaf_at(first + worker);
            near_children c = leaf_load(leaf);
            on = box_near(c.lo, c.hi, r, c.root * near_scale(q));
        }
        uint n = compact(on, before);
        if (on)
            chosen_[before] = leaf;
        settle();
        look_at_leaves(n, to, r, q.scale, least, range);
    }
    if (takes_)
        return;
    if (least > 0.0)
        store_bin(group);
    else if (FIRST_WORKER)
        tile_store(group_word(group, GROUP_COUNT), found_);
}

/* What is told of what the group's points found. */
void note_found(uint group, uint count) {
    atomicAdd(HERE.found.at[min(count, HERE.found_bins - 1u)], tile_load(group_word(group, GROUP_POINTS)));
    if (count < tile_load(group_word(group, GROUP_COUNT)))
        count_one(VK_COUNT_UNLISTED, tile_);
}

void main() {
    uint groups = tile_load(FOUND_GROUPS);
    near_query q = asks();
    leaves_ = tile_load(FOUND_LEAVES);
    compact_begin();
    for (uint g = 1u; g < groups; g++) {
        uint count = takes_ ? found_count(g) : 0u;
        if (takes_ && FIRST_WORKER)
            note_found(g, count);
        if (!takes_ || count > 0u)
            group_looks(g, q);
    }
}
