#version 460
/* A ray from each pixel to its sample, where it is not known whether it arrives. HERE.first 1: to all samples. */
#extension GL_GOOGLE_include_directive : require
#include "bridge.glsl"
#include "pixel.glsl"
#include "core/reuse.h"
#include "core/shadow.h"

void main() {
    if (!in_grid())
        return;
    place p = my_place();
    reservoir q = reservoir_at(HERE.target, p.block, p.lane);
    bool ask = resolve_asks(q, HERE.first == 0u && HERE.target_visible.at[p.slot] != 0u);
    segment s;
    s.o = s.d = vec3(0.0);
    if (ask) {
        receiver r = receiver_at(HERE.surfaces, p.block, p.lane);
        s = shadow_segment(r.p, r.n, light_load(q.light), q.u, q.v, HERE.ray_offset);
    }
    ray_put(p, 0u, ask, s.o, s.d);
}
