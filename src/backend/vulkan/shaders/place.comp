#version 460
/* Receivers that are given, in place of what a camera sees; no instance shows them. */
#extension GL_GOOGLE_include_directive : require
#include "bridge.glsl"
#include "pixel.glsl"

void main() {
    if (!in_grid())
        return;
    place p = my_place();
    receiver r = receiver_none();
    if (p.inside) {
        uint at = 7u * (p.y * FRAME.width + p.x); /* noc_receiver */
        r.p = vec3(HERE.given.at[at], HERE.given.at[at + 1u], HERE.given.at[at + 2u]);
        r.n = vec3(HERE.given.at[at + 3u], HERE.given.at[at + 4u], HERE.given.at[at + 5u]);
        v3 d = sub3(r.p, splat3(FRAME.camera.eye));
        EXACT float depth = sqrt(dot3(d, d));
        r.depth = depth;
        r.material = floatBitsToUint(HERE.given.at[at + 6u]);
    }
    receiver_put(HERE.surfaces, p.block, p.lane, r, 0u);
    if ((HERE.views & VK_VIEW_TRIANGLES) != 0u)
        HERE.view_triangles.at[p.slot] = VK_NO_TRIANGLE;
    if (HERE.instanced != 0u)
        HERE.instance.at[p.slot] = NO_INSTANCE;
}
