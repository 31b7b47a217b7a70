#version 460
/* The temporal combination. */
#extension GL_GOOGLE_include_directive : require
#define TEMPORAL
#include "bridge.glsl"
#include "pixel.glsl"
#include "reuse.glsl"
#include "reuse_use.glsl"
