#version 460
/* Rays to a pixel's entries from HERE.first on. */
#extension GL_GOOGLE_include_directive : require
#include "bridge.glsl"
#include "pixel.glsl"
#include "reference.glsl"

void main() {
    if (!in_grid())
        return;
    place p = my_place();
    receiver r = receiver_at(HERE.surfaces, p.block, p.lane);
    pixel_ = slot_in_band(p);
    p.slot = pixel_;
    uint count = HERE.scratch.at[count_word()];
    for (uint i = 0u; i < VK_REFERENCE_RAYS; i++) {
        uint entry = HERE.first + i;
        bool on = entry < count;
        segment s;
        s.o = s.d = vec3(0.0);
        if (on) {
            uint id = HERE.scratch.at[entry_word(entry, 0u)];
            v3 at = reference_place(key_at(p, FRAME.index), id);
            s = shadow_segment(r.p, r.n, light_load(id), at.x, at.y, HERE.ray_offset);
        }
        ray_put(p, i, on, s.o, s.d);
    }
}
