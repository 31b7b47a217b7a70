#version 460
/* Rays of the spatial combination. */
#extension GL_GOOGLE_include_directive : require
#define SPATIAL
#include "bridge.glsl"
#include "pixel.glsl"
#include "reuse.glsl"
#include "reuse_ask.glsl"
