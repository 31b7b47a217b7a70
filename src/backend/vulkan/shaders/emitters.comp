#version 460
/* A pixel's colour begins with the emitter that it sees. */
#extension GL_GOOGLE_include_directive : require
#include "bridge.glsl"
#include "pixel.glsl"
#include "core/shading.h"

void main() {
    if (!in_grid())
        return;
    place p = my_place();
    colour_put(HERE.colour, p, emitter_shade(HERE.surfaces.at[p.block].light[p.lane]));
}
