#version 460
/* Where the lights of each tile go in the pool of a band: tiles in their order, one work group for all. What comes too
 * late ends behind the pool. 1 barrier. */
#extension GL_GOOGLE_include_directive : require
#include "list_group.glsl"
#include "bridge.glsl"
#include "tile.glsl"
#include "influence.glsl"
#include "influence_asked.glsl"

shared uint part_[WORKERS];

uint tile_word(uint tile, uint at) { return tile * HERE.tile_words + at; }
uint add_tile(uint sum, uint tile) {
    return min(sum + HERE.scratch.at[tile_word(tile, FOUND_TAKES)], HERE.pool_room);
}

void main() {
    uint tiles = tiles_of_band(), run = (tiles + WORKERS - 1u) / WORKERS;
    uint begin = min(worker * run, tiles), end = min(begin + run, tiles), sum = 0u;
    for (uint i = begin; i < end; i++)
        sum = add_tile(sum, i);
    part_[worker] = sum;
    settle();
    sum = 0u;
    for (uint i = 0u; i < worker; i++)
        sum = min(sum + part_[i], HERE.pool_room);
    for (uint i = begin; i < end; i++) {
        HERE.scratch.at[tile_word(i, FOUND_FROM)] = sum;
        sum = add_tile(sum, i);
    }
}
