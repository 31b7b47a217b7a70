#version 460
#extension GL_EXT_ray_tracing : require
#extension GL_GOOGLE_include_directive : require

#include "payload.glsl"
layout(location = 0) rayPayloadInEXT nearest_hit hit;
hitAttributeEXT vec2 at;

void main() {
    hit.triangle = gl_PrimitiveID;
    hit.entry = gl_InstanceCustomIndexEXT;
    hit.u = at.x;
    hit.v = at.y;
    hit.t = gl_HitTEXT;
}
