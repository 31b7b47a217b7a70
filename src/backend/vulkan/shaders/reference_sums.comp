#version 460
/* Luminances of REFERENCE_CHUNKS chunks of lights, from HERE.first on. */
#extension GL_GOOGLE_include_directive : require
#include "bridge.glsl"
#include "pixel.glsl"
#include "reference.glsl"

void main() {
    if (!in_grid())
        return;
    place p = my_place();
    if (!receives(receiver_at(HERE.surfaces, p.block, p.lane)))
        return;
    pixel_ = slot_in_band(p);
    surf s = surf_at(HERE.surfaces, p.block, p.lane, eye_now());
    uint end = min(HERE.first + VK_REFERENCE_CHUNKS, chunks());
    for (uint i = HERE.first; i < end; i++)
        reference_sum(s, key_at(p, FRAME.index), i, HERE.light_count);
}
