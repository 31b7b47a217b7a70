#version 460
/* The light of a pixel's rays, or, where earlier frames are reused, its share beside the reservoir's. */
#extension GL_GOOGLE_include_directive : require
#include "bridge.glsl"
#include "pixel.glsl"
#include "list_rays.glsl"
#include "surfaces.glsl"

void main() {
    if (!in_grid())
        return;
    place p = my_place();
    find_pixel(p);
    uint rays = pixel_load(PIXEL_COUNT);
    if (rays == 0u)
        return;
    float rest = 1.0;
    if ((HERE.list_flags & LIST_MIXES) != 0u) {
        EXACT float share = 1.0 - list_reused(HERE.target.at[p.block].m[p.lane], float(FRAME.draws));
        rest = share;
    }
    vec3 c = colour_at(HERE.colour, p);
    for (uint k = 0u; k < rays; k++) {
        float w = found_w(k);
        if (!(w > 0.0))
            continue;
        EXACT float weight = w * rest;
        vec3 brings = vec3(pixel_real(ray_field(k, RAY_BRINGS)), pixel_real(ray_field(k, RAY_BRINGS + 1u)),
                           pixel_real(ray_field(k, RAY_BRINGS + 2u)));
        c = add_colour(c, mul3(brings, weight), p.slot);
    }
    colour_put(HERE.colour, p, c);
}
