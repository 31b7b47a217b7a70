#version 460
/* Each pixel's reservoir, chosen among all entries of its tile's list. */
#extension GL_GOOGLE_include_directive : require
#include "bridge.glsl"
#include "pixel.glsl"
#include "list_pixel.glsl"
#include "core/shading.h"
#include "surfaces.glsl"
#include "core/lists.h"

list_entry entry_load(uint i) { return list_entry(tile_load(TILE_CHOSEN + i), tile_real(TILE_CHANCE + i)); }

void main() {
    if (!in_grid())
        return;
    place p = my_place();
    find_pixel(p);
    reservoir q = reservoir_empty();
    uint count = tile_load(TILE_ENTRIES);
    if (receives(receiver_at(HERE.surfaces, p.block, p.lane))) {
        if (count > 0u)
            q = ris_list(surf_at(HERE.surfaces, p.block, p.lane, eye_now()), key_at(p, FRAME.index), count);
        q.m = float(FRAME.draws);
    }
    reservoir_put(HERE.target, p.block, p.lane, q);
    HERE.target_visible.at[p.slot] = 0u;
}
