/* Nearest hits of rays traced with RAY_FLAGS. */
#include "bridge.glsl"
#include "trace.glsl"

layout(location = 0) rayPayloadEXT nearest_hit hit;

void main() {
    uint slot = my_slot();
    uint b = slot / BLOCK, l = slot % BLOCK;
    hit.triangle = 0xffffffffu;
    if (HERE.answers.at[slot] == VK_ANSWER_WANTED)
        traceRayEXT(scene, RAY_FLAGS, 0xff, 0, 0, 0, ray_origin(slot), 0.0, ray_way(slot), 1e30, 0);
    HERE.hits.at[b].triangle[l] = hit.triangle;
    HERE.hits.at[b].entry[l] = hit.entry;
    HERE.hits.at[b].u[l] = hit.u;
    HERE.hits.at[b].v[l] = hit.v;
    HERE.hits.at[b].t[l] = hit.t;
}
