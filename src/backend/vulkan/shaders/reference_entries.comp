#version 460
/* A pixel's entries, by the luminances of chunks. */
#extension GL_GOOGLE_include_directive : require
#include "bridge.glsl"
#include "pixel.glsl"
#include "reference.glsl"

void main() {
    if (!in_grid())
        return;
    place p = my_place();
    pixel_ = slot_in_band(p);
    entries_ = 0u;
    if (receives(receiver_at(HERE.surfaces, p.block, p.lane))) {
        surf s = surf_at(HERE.surfaces, p.block, p.lane, eye_now());
        if (HERE.light_count <= FRAME.rays)
            reference_all(s, key_at(p, FRAME.index), HERE.light_count);
        else
            reference_drawn(s, key_at(p, FRAME.index), HERE.light_count);
    }
    HERE.scratch.at[count_word()] = entries_;
}
