#version 460
/* Ray number HERE.first of each surface to the sky; how many there will be is settled at the first one and kept beside
 * the answer. The sky behind everything is shown at once. */
#extension GL_GOOGLE_include_directive : require
#include "bridge.glsl"
#include "pixel.glsl"
#include "core/shading.h"
#include "surfaces.glsl"

void main() {
    if (!in_grid())
        return;
    place p = my_place();
    bool surface = receives(receiver_at(HERE.surfaces, p.block, p.lane));
    vec3 c = colour_at(HERE.colour, p);
    if (!surface && p.inside && HERE.first == 0u)
        colour_put(HERE.colour, p, add_colour(c, sky_behind(p.x, p.y), p.slot));
    uint turns = HERE.first == 0u ? sky_turns(c) : HERE.answers.at[p.slot] >> 8;
    bool on = surface && HERE.sky_turns > HERE.first && HERE.first < turns;
    segment s;
    s.o = s.d = vec3(0.0);
    if (on)
        s = sky_ray(surf_at(HERE.surfaces, p.block, p.lane, eye_now()), key_at(p, 0u), FRAME.index * turns + HERE.first,
                    HERE.ray_offset);
    ray_put(p, 0u, on, s.o, s.d);
    HERE.answers.at[p.slot] |= turns << 8;
}
