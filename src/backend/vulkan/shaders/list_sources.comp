#version 460
/* Views of where light comes from, of a pixel's rays over its tile's list. */
#extension GL_GOOGLE_include_directive : require
#include "bridge.glsl"
#include "pixel.glsl"
#include "list_rays.glsl"
#include "surfaces.glsl"
#include "views.glsl"
#include "weaken.glsl"

void main() {
    if (!in_grid())
        return;
    place p = my_place();
    find_pixel(p);
    uint rays = pixel_load(PIXEL_COUNT), key = key_at(p, FRAME.index);
    float rest = share_of_rays(p);
    surf s = surf_at(HERE.surfaces, p.block, p.lane, eye_now());
    for (uint k = 0u; k < rays; k++) {
        if (!(found_w(k) > 0.0))
            continue;
        EXACT float w = found_w(k) * rest;
        w = weakened(w, k * HERE.slots + pixel_);
        reservoir q = list_sample(key, ray_entry(k), w, found_p(k), 0.0);
        note_sample(p, s, q, light_load(q.light), mul3(ray_brings(k), w));
    }
}
