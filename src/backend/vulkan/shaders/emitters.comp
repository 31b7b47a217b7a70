#version 460
/* A pixel's colour begins with the emitter that it sees. */
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
    uint light = HERE.surfaces.at[p.block].light[p.lane];
    vec3 c = emitter_shade(light);
    colour_put(HERE.colour, p, c);
    if (sees_emitter(light))
        note_light(p, light, c);
    else if ((HERE.views & VK_VIEW_LUX) != 0u && receives(receiver_at(HERE.surfaces, p.block, p.lane)) &&
             lux_measurable(HERE.light_colours, surf_at(HERE.surfaces, p.block, p.lane, eye_now()).albedo))
        HERE.view_lux.at[p.slot] = 0.0;
}
