#version 460
/* Rows of observations are told apart by the run of cells that they lie in: each run has a list of them. */
#extension GL_GOOGLE_include_directive : require
#include "bridge.glsl"
layout(local_size_x = 64) in;

#include "backend/vulkan/list_memory.h"
#include "core/learned.h"
#include "list_seen.glsl"

void main() {
    uint row = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
    if (row >= minu1(HERE.observed.at[SEEN_ROWS], HERE.observed_rows))
        return;
    uint at = row_word(row);
    cell_key k = cell_key(HERE.observed.at[at + ROW_KEY], HERE.observed.at[at + ROW_KEY + 1u]);
    uint run = cell_run(k, HERE.cells) / CELL_RUN;
    HERE.observed.at[at + ROW_NEXT] = atomicExchange(HERE.learned.at[run_word(run)], row + 1u);
}
