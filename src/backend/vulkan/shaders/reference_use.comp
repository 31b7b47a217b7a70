#version 460
/* The light of a pixel's entries from HERE.first on, where nothing blocks it. */
#extension GL_GOOGLE_include_directive : require
#include "bridge.glsl"
#include "pixel.glsl"
#include "reference.glsl"
#include "views.glsl"
#include "weaken.glsl"

void main() {
    if (!in_grid())
        return;
    place p = my_place();
    surf s = surf_at(HERE.surfaces, p.block, p.lane, eye_now());
    vec3 c = colour_at(HERE.colour, p);
    pixel_ = slot_in_band(p);
    uint count = HERE.scratch.at[count_word()];
    for (uint i = 0u; i < VK_REFERENCE_RAYS && HERE.first + i < count; i++) {
        uint entry = HERE.first + i;
        float w = uintBitsToFloat(HERE.scratch.at[entry_word(entry, 1u)]);
        if ((FRAME.flags & FRAME_FINAL_RAY) != 0u && HERE.answers.at[i * HERE.slots + pixel_] != VK_ANSWER_CLEAR)
            continue;
        w = weakened(w, i * HERE.slots + pixel_);
        uint id = HERE.scratch.at[entry_word(entry, 0u)];
        v3 at = reference_place(key_at(p, FRAME.index), id);
        reservoir q = reservoir(id, at.x, at.y, w, 0.0, 0.0);
        vec3 light = sample_shade(s, q, light_load(id));
        note_sample(p, s, q, light_load(id), light);
        c = add_colour(c, light, p.slot);
    }
    colour_put(HERE.colour, p, c);
}
