#version 460
/* The rays that pixels share out over their tile's list, one of each pixel a layer of the dispatch. */
#extension GL_GOOGLE_include_directive : require
#include "bridge.glsl"
#include "pixel.glsl"
#include "list_pixel.glsl"
#include "core/shading.h"
#include "core/shadow.h"
#include "surfaces.glsl"
#include "core/list_rays.h"

void main() {
    if (!in_grid())
        return;
    place p = my_place();
    find_pixel(p);
    uint k = gl_GlobalInvocationID.z;
    list_ray r;
    r.w = 0.0;
    segment way;
    way.o = way.d = vec3(0.0);
    if (k < pixel_load(PIXEL_COUNT)) {
        uint word = pixel_load(ray_field(k, RAY_DRAWN));
        list_drawn d = list_drawn(word & 255u, float(word >> 8), pixel_real(ray_field(k, RAY_W)));
        list_sums sums = list_sums(pixel_real(PIXEL_ALL), 0.0);
        surf s = surf_at(HERE.surfaces, p.block, p.lane, eye_now());
        light to = light_load(entry_light(d.entry));
        r = list_ask(s, sums, pixel_real(PIXEL_DRAWS), key_at(p, FRAME.index), d, to);
        way = segment_to(s.p, s.n, to, r.at, HERE.ray_offset);
        pixel_store(ray_field(k, RAY_W), r.w);
        pixel_store(ray_field(k, RAY_P), r.p);
        for (uint c = 0u; c < 3u; c++)
            pixel_store(ray_field(k, RAY_BRINGS + c), r.brings[c]);
    }
    p.slot = pixel_;
    ray_put(p, k, r.w > 0.0 && (FRAME.flags & FRAME_FINAL_RAY) != 0u, way.o, way.d);
}
