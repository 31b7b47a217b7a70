#version 460
/* Adds the frame to the picture, and to the sums of the emitters that are seen (core/moments.h). */
#extension GL_GOOGLE_include_directive : require
#include "bridge.glsl"
#include "pixel.glsl"
#include "core/moments.h"

void main() {
    if (!in_grid())
        return;
    place p = my_place();
    vec3 c = colour_at(HERE.colour, p);
    vec3 mean = colour_at(HERE.picture, p);
    vec4 seen = HERE.coverage.at[p.slot];
    if (HERE.fresh != 0u) {
        mean = c;
        seen = vec4(0.0);
    } else {
        mean.x = mean_add(mean.x, c.x, HERE.share);
        mean.y = mean_add(mean.y, c.y, HERE.share);
        mean.z = mean_add(mean.z, c.z, HERE.share);
    }
    if (HERE.surfaces.at[p.block].light[p.lane] != NO_LIGHT) {
        EXACT vec3 sum = seen.xyz + c;
        seen = vec4(sum, seen.w + 1.0);
    }
    colour_put(HERE.picture, p, mean);
    HERE.coverage.at[p.slot] = seen;
}
