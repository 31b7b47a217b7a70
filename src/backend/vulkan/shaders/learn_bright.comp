#version 460
/* The mean brightness that the frame expects (core/list_bright.h). */
#extension GL_GOOGLE_include_directive : require
#include "bridge.glsl"
layout(local_size_x = 256) in;

#include "backend/vulkan/list_memory.h"
#include "core/list_bright.h"

float block_bright(uint block) { return HERE.block_bright.at[block]; }

shared float sums_[BRIGHT_COLUMNS];

void main() {
    uint k = gl_LocalInvocationIndex;
    sums_[k] = column_bright(k, FRAME.blocks_x * HERE.blocks_y);
    for (uint half_ = BRIGHT_COLUMNS / 2u; half_ > 0u; half_ /= 2u) {
        memoryBarrierShared();
        barrier();
        if (k < half_) {
            precise float sum = sums_[k] + sums_[k + half_];
            sums_[k] = sum;
        }
    }
    if (k == 0u) {
        precise float mean = sums_[0] / (float(FRAME.width) * float(FRAME.height));
        HERE.learned.at[CACHE_BRIGHT] = floatBitsToUint(mean);
    }
}
