#version 460
/* Candidates by the lights' power. */
#extension GL_GOOGLE_include_directive : require
#include "bridge.glsl"
#include "presample.glsl"

pick draw_sample(uint key, uint i, uint share) {
    if (HERE.alias_count == 0u)
        return pick(0u, 0.0);
    return alias_draw(HERE.alias_count, presample_bits(key, i, share), presample_choice(key, i));
}

#include "presample_body.glsl"
