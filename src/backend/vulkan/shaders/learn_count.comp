#version 460
/* The visibility cache learns: a run of cells by 16 invocations, each of which counts the lights of one set. Rows of a
 * run come in the order of tiles, and of cells in a tile, so that the outcome is the same however they were listed. */
#extension GL_GOOGLE_include_directive : require
#include "bridge.glsl"
layout(local_size_x = 64) in;

#include "core/learned.h"

#define set_ (gl_LocalInvocationIndex % 16u)

#include "backend/vulkan/list_memory.h"

/* Of the run at hand: its first cell, and its cells' keys and times, which all 16 keep. Of all other words each has
 * those of its set, and the first one the counts of all lights. */
uint first_;
uint head_[CELL_RUN][3];

bool owned(uint word) {
    return word < CELL_LIGHT ? set_ == 0u : (word - CELL_LIGHT) % CELL_LIGHTS / CELL_WAYS == set_;
}
uint cell_word(uint cell, uint word) { return CACHE_HEAD + CELL_WORDS * cell + word; }
uint cell_load(uint cell, uint word) {
    return word < 3u ? head_[cell - first_][word] : HERE.learned.at[cell_word(cell, word)];
}
void cell_store(uint cell, uint word, uint x) {
    if (word < 3u)
        head_[cell - first_][word] = x;
    else if (owned(word))
        HERE.learned.at[cell_word(cell, word)] = x;
}

#include "list_seen.glsl"
#include "core/learned_cells.h"

/* The row, from 1 on, of the lowest item of the run's from `least` on; 0: there is none. */
uint next_row(uint rows, uint least) {
    uint best = 0u, item = 0xffffffffu;
    for (uint row = rows; row != 0u; row = HERE.observed.at[row_word(row - 1u) + ROW_NEXT]) {
        uint here = HERE.observed.at[row_word(row - 1u) + ROW_ITEM];
        if (here >= least && here <= item) {
            item = here;
            best = row;
        }
    }
    return best;
}

void take_counts(uint cell, uint counts, uint light) {
    if (set_ == 0u)
        cell_count_all(cell, counts & 0xffffu, counts >> 16);
    if (cell_set(light) == set_ * CELL_WAYS)
        cell_count_light(cell, light, counts & 0xffffu, counts >> 16);
}

void take_row(uint row) {
    uint at = row_word(row), lights = lights_word(HERE.observed.at[at + ROW_ITEM] / TILE_CELLS);
    uint count = HERE.observed.at[lights], some = 0u;
    for (uint i = 0u; i < count; i++)
        some |= HERE.observed.at[at + ROW_COUNTS + i];
    if (some == 0u)
        return;
    uint cell = cell_claim(cell_key(HERE.observed.at[at + ROW_KEY], HERE.observed.at[at + ROW_KEY + 1u]), HERE.cells,
                           HERE.learn_time);
    for (uint i = 0u; i < count; i++) {
        uint counts = HERE.observed.at[at + ROW_COUNTS + i];
        if (counts != 0u)
            take_counts(cell, counts, HERE.observed.at[lights + 1u + i]);
    }
}

void main() {
    uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    uint run = group * 4u + gl_LocalInvocationIndex / 16u, rows = 0u;
    first_ = run * CELL_RUN;
    if (run < HERE.cells / CELL_RUN)
        rows = HERE.learned.at[run_word(run)];
    if (rows != 0u)
        for (uint i = 0u; i < CELL_RUN; i++)
            for (uint k = 0u; k < 3u; k++)
                head_[i][k] = HERE.learned.at[cell_word(first_ + i, k)];
    barrier(); /* all 16 have loaded what the first one will store */
    if (rows == 0u)
        return;
    uint least = 0u;
    for (uint row = next_row(rows, least); row != 0u; row = next_row(rows, least)) {
        take_row(row - 1u);
        least = HERE.observed.at[row_word(row - 1u) + ROW_ITEM] + 1u;
    }
    if (set_ != 0u)
        return;
    for (uint i = 0u; i < CELL_RUN; i++)
        for (uint k = 0u; k < 3u; k++)
            HERE.learned.at[cell_word(first_ + i, k)] = head_[i][k];
}
