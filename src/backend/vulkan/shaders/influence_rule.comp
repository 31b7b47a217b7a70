#version 460
/* How many lights each group of a tile lists (core/influence_rule.h): an invocation each. 1 barrier. */
#extension GL_GOOGLE_include_directive : require
#include "list_group.glsl"
#include "bridge.glsl"
#include "tile.glsl"
#include "influence.glsl"
#include "influence_asked.glsl"

shared uint count_[256];
uint group_;

rule_bin rule_bin_load(uint i) {
    uint at = pool_word(tile_ * FOUND_POOL + ((group_ - 1u) * RULE_BINS + i) * BIN_WORDS);
    return rule_bin(uintBitsToFloat(HERE.scratch.at[at]), uintBitsToFloat(HERE.scratch.at[at + 1u]),
                    uintBitsToFloat(HERE.scratch.at[at + 2u]), 0.0);
}
void rule_bin_store(uint i, rule_bin bin) {} /* bins are there */

influence_rule rule_of_volumes() {
    influence_rule rule;
    for (uint i = 0u; i < RULE_SHARES; i++)
        rule.seen[i] = volumes_real(VOLUMES_RULE + i);
    rule.floor_ = volumes_real(VOLUMES_RULE + RULE_SHARES);
    return rule;
}

/* Settles for what gives `least` at least, and returns how many lights do. */
uint settle_for_strongest(float least) {
    rule_range range = rule_from(least);
    float best = max1(rule_best(range, rule_of_volumes(), float(HERE.light_count), float(FRAME.uniform_every)), least);
    uint count = 0u;
    for (uint i = 0u; i < RULE_BINS; i++)
        if (rule_edge(range, i) >= best)
            count += to_u32(rule_bin_load(i).lights);
    tile_store(group_word(group_, GROUP_LEAST), best);
    return count;
}

void main() {
    uint groups = tile_load(FOUND_GROUPS);
    EACH_INDEX(i, groups - 1u) {
        group_ = i + 1u;
        float least = tile_real(group_word(group_, GROUP_LEAST));
        uint count = tile_load(group_word(group_, GROUP_COUNT));
        if (least > 0.0) {
            count = settle_for_strongest(least);
            tile_store(group_word(group_, GROUP_COUNT), count);
        }
        count_[i] = count;
    }
    settle();
    EACH_INDEX(i, groups) {
        uint sum = 0u;
        for (uint k = 0u; k < i; k++)
            sum += count_[k];
        tile_store(i + 1u == groups ? FOUND_TAKES : group_word(i + 1u, GROUP_FROM), sum);
    }
}
