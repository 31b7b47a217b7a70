#version 460
/* Which pixels have less than two earlier frames behind them. */
#extension GL_GOOGLE_include_directive : require
#define TEMPORAL
#include "bridge.glsl"
#include "pixel.glsl"
#include "reuse.glsl"
#include "list_pixel.glsl"
#include "core/list_mix.h"

void main() {
    if (!in_grid())
        return;
    place p = my_place();
    find_pixel(p);
    bool fresh = receives(receiver_at(HERE.surfaces, p.block, p.lane));
    if (fresh && (FRAME.flags & FRAME_HISTORY) != 0u) {
        gather(p);
        fresh = list_is_fresh(neighbour_resv(0).m, float(FRAME.draws));
    }
    pixel_store(PIXEL_FRESH, fresh ? 1u : 0u);
}
