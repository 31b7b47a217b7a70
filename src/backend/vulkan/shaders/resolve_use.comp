#version 460
/* No sample is left whose ray was blocked; of the others it is known that they are unoccluded. */
#extension GL_GOOGLE_include_directive : require
#include "bridge.glsl"
#include "pixel.glsl"

void main() {
    if (!in_grid())
        return;
    place p = my_place();
    uint answer = HERE.answers.at[p.slot];
    if (answer == VK_ANSWER_CLEAR)
        HERE.target_visible.at[p.slot] = 1u;
    if (answer == VK_ANSWER_WANTED)
        HERE.target.at[p.block].w[p.lane] = 0.0;
}
