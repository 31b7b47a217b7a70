#version 460
#extension GL_EXT_ray_tracing : require
#extension GL_GOOGLE_include_directive : require

#include "payload.glsl"
layout(location = 0) rayPayloadInEXT nearest_hit hit;

void main() { hit.triangle = 0xffffffffu; }
