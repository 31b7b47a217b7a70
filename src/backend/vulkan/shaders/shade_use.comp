#version 460
/* The light of each pixel's sample, where nothing blocks it. */
#extension GL_GOOGLE_include_directive : require
#include "bridge.glsl"
#include "pixel.glsl"
#include "backend/vulkan/list_memory.h"
#include "core/list_mix.h"
#include "core/shading.h"
#include "surfaces.glsl"
#include "views.glsl"
#include "weaken.glsl"

void main() {
    if (!in_grid())
        return;
    place p = my_place();
    reservoir q = reservoir_at(HERE.target, p.block, p.lane);
    bool on = q.w > 0.0;
    if (on && (FRAME.flags & FRAME_FINAL_RAY) != 0u)
        on = HERE.answers.at[p.slot] != VK_ANSWER_WANTED;
    if (!on)
        return;
    q.w = weakened(q.w, p.slot);
    if ((HERE.list_flags & LIST_MIXES) != 0u) {
        EXACT float w = q.w * list_reused(q.m, float(FRAME.draws));
        q.w = w;
    }
    surf s = surf_at(HERE.surfaces, p.block, p.lane, eye_now());
    vec3 light = sample_shade(s, q, light_load(q.light));
    note_sample(p, s, q, light_load(q.light), light);
    colour_put(HERE.colour, p, add_colour(colour_at(HERE.colour, p), light, p.slot));
}
