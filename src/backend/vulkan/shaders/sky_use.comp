#version 460
/* The sky's light along rays that left the scene. */
#extension GL_GOOGLE_include_directive : require
#include "bridge.glsl"
#include "pixel.glsl"
#include "core/shading.h"
#include "surfaces.glsl"
#include "views.glsl"

void main() {
    if (!in_grid())
        return;
    place p = my_place();
    uint answer = HERE.answers.at[p.slot];
    if ((answer & 3u) != VK_ANSWER_CLEAR)
        return;
    vec3 way = vec3(HERE.rays.at[p.block].d[0][p.lane], HERE.rays.at[p.block].d[1][p.lane],
                    HERE.rays.at[p.block].d[2][p.lane]);
    EXACT float share = 1.0 / float(answer >> 8);
    if (HERE.weakens != 0u) {
        EXACT float rest = share * HERE.through.at[p.slot];
        share = rest;
    }
    surf s = surf_at(HERE.surfaces, p.block, p.lane, eye_now());
    vec3 light = sky_shade(s, way, share);
    if (measures(p))
        add_lux(p, sky_lux(s, way, share));
    note_sky(p, light);
    colour_put(HERE.colour, p, add_colour(colour_at(HERE.colour, p), light, p.slot));
}
