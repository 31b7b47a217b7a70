#version 460
/* Views of candidates over lists: how many lights the list of a pixel's tile has, and how often the light that it chose
 * is expected in such lists. */
#extension GL_GOOGLE_include_directive : require
#include "bridge.glsl"
#include "pixel.glsl"
#include "core/measured.h"
#include "list_rays.glsl"

/* A light's first entry, of lists that hold it so many times. */
float expected(uint id, uint lights, uint weights, uint count, uint copies) {
    for (uint i = 0u; i < count; i++)
        if (tile_load(lights + i) == id)
            return expected_entries(tile_real(weights + i), copies);
    return -1.0;
}

void main() {
    if (!in_grid())
        return;
    place p = my_place();
    find_pixel(p);
    uint once = tile_load(TILE_ENTRIES);
    bool shares = (HERE.list_flags & LIST_SHARES) != 0u;
    if (!receives(receiver_at(HERE.surfaces, p.block, p.lane)) || (shares && once == 0u))
        return;
    if ((HERE.views & VK_VIEW_LIGHTS) != 0u)
        HERE.view_lights.at[p.slot] = float(once);
    if ((HERE.views & VK_VIEW_DENSITY) == 0u)
        return;
    float density = -1.0;
    reservoir q;
    if (shares) {
        uint count = tile_load(TILE_COUNT);
        q = list_stand_in(key_at(p, FRAME.index), pixel_load(PIXEL_COUNT), pixel_real(PIXEL_DRAWS), 0.0);
        density = expected(q.light, TILE_LIGHT, TILE_WEIGHT, count, count / once);
    } else {
        q = reservoir_at(HERE.target, p.block, p.lane);
        density = expected(q.light, TILE_CHOSEN, TILE_CHANCE, once, 1u);
    }
    if (q.w > 0.0)
        HERE.view_density.at[p.slot] = density;
}
