#version 460
/* One of a pixel's rays that arrived becomes its reservoir. */
#extension GL_GOOGLE_include_directive : require
#include "bridge.glsl"
#include "pixel.glsl"
#include "list_rays.glsl"

void main() {
    if (!in_grid())
        return;
    place p = my_place();
    find_pixel(p);
    reservoir own = reservoir_at(HERE.target, p.block, p.lane);
    own = list_resampled(key_at(p, FRAME.index), pixel_load(PIXEL_COUNT), own);
    reservoir_put(HERE.target, p.block, p.lane, own);
    HERE.target_visible.at[p.slot] = own.w > 0.0 ? 1u : 0u;
}
