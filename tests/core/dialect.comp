#version 460
/* The dialect kernel as a compute shader. */
#extension GL_GOOGLE_include_directive : require
#define CORE_GLSL 1

layout(local_size_x = 64) in;
layout(std430, binding = 0) writeonly buffer answers { uint bits[]; } answer;
layout(push_constant) uniform constants { uint items; };

#include "core/dialect.h"
#include "dialect_slots.h"

void put_u32(uint item, int slot, uint x) { answer.bits[uint(slot) * items + item] = x; }
void put_real(uint item, int slot, float x) { put_u32(item, slot, floatBitsToUint(x)); }

void put_u1(uint item, int slot, uint x) { put_u32(item, slot, x); }
uint words[TILE_WORDS];
uint word_load(uint i) { return words[i]; }
void word_store(uint i, uint x) { words[i] = x; }
uint words_load(uint first) { return words[first]; }
void words_store(uint first, uint x) { words[first] = x; }
uint lane_places(uint first) { return first; }

#define ITEM_COUNT items
#include "dialect_kernel.h"

/* llvmpipe gives an invocation 65,535 rounds for all its loops together, and then leaves each loop after its first:
 * lists are a shader of their own for that, too. */
void main() {
    uint item = gl_GlobalInvocationID.x;
    if (item < items)
        DIALECT_PART(item);
}
