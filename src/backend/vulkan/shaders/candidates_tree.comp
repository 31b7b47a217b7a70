#version 460
/* Each pixel's reservoir, of candidates drawn from the light tree. */
#extension GL_GOOGLE_include_directive : require
#include "bridge.glsl"
#include "pixel.glsl"
#include "core/measured.h"
#include "core/shading.h"
#include "core/tree.h"
#include "surfaces.glsl"

tree_child child_at(uint at) {
    Words w = HERE.tree;
    tree_child c;
    c.c = vec3(uintBitsToFloat(w.at[at]), uintBitsToFloat(w.at[at + 1u]), uintBitsToFloat(w.at[at + 2u]));
    c.radius = uintBitsToFloat(w.at[at + 3u]);
    c.axis_xy = w.at[at + 4u];
    c.axis_cone = w.at[at + 5u];
    c.power = uintBitsToFloat(w.at[at + 6u]);
    c.link = w.at[at + 7u];
    return c;
}
tree_pair tree_load(uint i) { return tree_pair(child_at(16u * i), child_at(16u * i + 8u)); }

surf surf_;
uint key_;

pick pick_load(int i) {
    return tree_draw(surf_.p, surf_.n, key_, HERE.tree_root, HERE.draws, uint(i), int(HERE.tree_depth));
}

#include "core/given.h"

/* How often the chosen light is expected among the candidates; -1: it is none of them. */
float expected(uint light) {
    for (uint i = 0u; i < HERE.draws; i++) {
        pick drawn = pick_load(int(i));
        if (drawn.light == light && drawn.inverse > 0.0)
            return expected_draws(HERE.draws, drawn.inverse);
    }
    return -1.0;
}

void main() {
    if (!in_grid())
        return;
    place p = my_place();
    reservoir q = reservoir_empty();
    if (receives(receiver_at(HERE.surfaces, p.block, p.lane))) {
        surf_ = surf_at(HERE.surfaces, p.block, p.lane, eye_now());
        key_ = key_at(p, FRAME.index);
        q = ris_given(surf_, key_, int(HERE.draws));
        if ((HERE.views & VK_VIEW_DENSITY) != 0u && q.w > 0.0)
            HERE.view_density.at[p.slot] = expected(q.light);
    }
    reservoir_put(HERE.target, p.block, p.lane, q);
    HERE.target_visible.at[p.slot] = 0u;
}
