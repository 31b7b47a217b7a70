/* A pixel's rays after they were traced. After the bridge. */
#include "list_pixel.glsl"
#include "core/shading.h"
#include "core/list_rays.h"

uint ray_entry(uint k) { return pixel_load(ray_field(k, RAY_DRAWN)) & 255u; }
float drawn_times(uint k) { return float(pixel_load(ray_field(k, RAY_DRAWN)) >> 8); }
float found_p(uint k) { return pixel_real(ray_field(k, RAY_P)); }
float found_w(uint k) { return pixel_real(ray_field(k, RAY_W)); }

list_found found_of(uint k) { return list_found(ray_entry(k), drawn_times(k), found_w(k), found_p(k)); }
vec3 ray_brings(uint k) {
    return vec3(pixel_real(ray_field(k, RAY_BRINGS)), pixel_real(ray_field(k, RAY_BRINGS + 1u)),
                pixel_real(ray_field(k, RAY_BRINGS + 2u)));
}

/* Of a pixel's light, what its rays show; its reservoir shows the rest. */
float share_of_rays(place p) {
    if ((HERE.list_flags & LIST_MIXES) == 0u)
        return 1.0;
    EXACT float share = 1.0 - list_reused(HERE.target.at[p.block].m[p.lane], float(FRAME.draws));
    return share;
}
