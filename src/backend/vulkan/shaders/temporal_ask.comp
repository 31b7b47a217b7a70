#version 460
/* Rays of the temporal combination. */
#extension GL_GOOGLE_include_directive : require
#define TEMPORAL
#include "bridge.glsl"
#include "pixel.glsl"
#include "reuse.glsl"
#include "reuse_ask.glsl"
