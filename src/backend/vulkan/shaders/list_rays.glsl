/* A pixel's rays after they were traced. After the bridge. */
#include "list_pixel.glsl"
#include "core/shading.h"
#include "core/list_rays.h"

uint ray_entry(uint k) { return pixel_load(ray_field(k, RAY_DRAWN)) & 255u; }
float drawn_times(uint k) { return float(pixel_load(ray_field(k, RAY_DRAWN)) >> 8); }
float found_p(uint k) { return pixel_real(ray_field(k, RAY_P)); }
float found_w(uint k) { return pixel_real(ray_field(k, RAY_W)); }

list_found found_of(uint k) { return list_found(ray_entry(k), drawn_times(k), found_w(k), found_p(k)); }
