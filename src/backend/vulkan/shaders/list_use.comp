#version 460
/* What a pixel's rays have found: W is 0 where one was blocked, and the visibility cache will learn of it. One of the
 * rays, at random, stands for the pixel in views of the candidates. */
#extension GL_GOOGLE_include_directive : require
#include "bridge.glsl"
#include "pixel.glsl"
#include "list_rays.glsl"
#include "list_seen.glsl"

void observe(uint row, uint entry, bool arrived) {
    if (row < HERE.observed_rows)
        atomicAdd(HERE.observed.at[row_word(row) + ROW_COUNTS + entry], arrived ? 0x10001u : 1u);
}

void main() {
    if (!in_grid())
        return;
    place p = my_place();
    find_pixel(p);
    uint rays = pixel_load(PIXEL_COUNT), key = key_at(p, FRAME.index);
    bool traced = (FRAME.flags & FRAME_FINAL_RAY) != 0u, learns = (HERE.list_flags & LIST_LEARNS) != 0u;
    uint row = learns && rays > 0u ? tile_load(TILE_ROW + tile_load(TILE_CELL + number_in_tile(p))) : 0u;
    for (uint k = 0u; k < rays; k++) {
        if (!(found_w(k) > 0.0))
            continue;
        bool arrived = !traced || HERE.answers.at[k * HERE.slots + pixel_] == VK_ANSWER_CLEAR;
        if (learns)
            observe(row, ray_entry(k), arrived);
        if (!arrived)
            pixel_store(ray_field(k, RAY_W), 0.0);
    }
    float m = pixel_load(PIXEL_SEES) != 0u ? float(FRAME.draws) : 0.0;
    reservoir_put(HERE.target, p.block, p.lane, list_stand_in(key, rays, pixel_real(PIXEL_DRAWS), m));
    HERE.target_visible.at[p.slot] = 0u;
}
