#version 460
/* A lamp at the eye, and the sky behind everything. */
#extension GL_GOOGLE_include_directive : require
#include "bridge.glsl"
#include "pixel.glsl"
#include "core/headlight.h"
#include "core/shading.h"
#include "surfaces.glsl"

void main() {
    if (!in_grid())
        return;
    place p = my_place();
    receiver r = receiver_at(HERE.surfaces, p.block, p.lane);
    vec3 c = colour_at(HERE.colour, p);
    if (receives(r))
        c = add_colour(c, headlight_shade(surf_at(HERE.surfaces, p.block, p.lane, eye_now()), r.depth, FRAME.sky),
                       p.slot);
    else if (p.inside)
        c = add_colour(c, sky_behind(p.x, p.y), p.slot);
    colour_put(HERE.colour, p, c);
}
