#version 460
/* Candidates of all lights alike. */
#extension GL_GOOGLE_include_directive : require
#include "bridge.glsl"
#include "presample.glsl"

pick draw_sample(uint key, uint i, uint share) {
    return pick(scale_u32(presample_bits(key, i, share), HERE.light_count), float(HERE.light_count));
}

#include "presample_body.glsl"
