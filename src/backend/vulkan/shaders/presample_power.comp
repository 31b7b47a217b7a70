#version 460
/* Candidates by the lights' power. */
#extension GL_GOOGLE_include_directive : require
#include "bridge.glsl"
#include "presample.glsl"

presample_pick draw_sample(uint key, uint i, uint n) { return presample_draw_power(key, i, n, HERE.alias_count); }

#include "presample_body.glsl"
