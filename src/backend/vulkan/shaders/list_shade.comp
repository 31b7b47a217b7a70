#version 460
/* The light of a pixel's rays, or, where earlier frames are reused, its share beside the reservoir's. */
#extension GL_GOOGLE_include_directive : require
#include "bridge.glsl"
#include "pixel.glsl"
#include "list_rays.glsl"
#include "surfaces.glsl"
#include "weaken.glsl"

void main() {
    if (!in_grid())
        return;
    place p = my_place();
    find_pixel(p);
    uint rays = pixel_load(PIXEL_COUNT);
    if (rays == 0u)
        return;
    float rest = share_of_rays(p);
    vec3 c = colour_at(HERE.colour, p);
    for (uint k = 0u; k < rays; k++) {
        float w = found_w(k);
        if (!(w > 0.0))
            continue;
        EXACT float weight = w * rest;
        weight = weakened(weight, k * HERE.slots + pixel_);
        c = add_colour(c, mul3(ray_brings(k), weight), p.slot);
    }
    colour_put(HERE.colour, p, c);
}
