#version 460
/* Candidates of all lights alike. */
#extension GL_GOOGLE_include_directive : require
#include "bridge.glsl"
#include "presample.glsl"

presample_pick draw_sample(uint key, uint i, uint n) { return presample_draw(key, i, n, HERE.light_count); }

#include "presample_body.glsl"
