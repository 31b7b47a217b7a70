/* Rays that an `ask` shader has written, one invocation each. */
layout(set = 0, binding = 0) uniform accelerationStructureEXT scene;

#include "payload.glsl"

uint my_slot() {
    uint row = HERE.first_row + gl_LaunchIDEXT.y;
    return gl_LaunchIDEXT.z * HERE.slots + row * gl_LaunchSizeEXT.x + gl_LaunchIDEXT.x;
}

vec3 ray_origin(uint slot) {
    uint b = slot / BLOCK, l = slot % BLOCK;
    return vec3(HERE.rays.at[b].o[0][l], HERE.rays.at[b].o[1][l], HERE.rays.at[b].o[2][l]);
}
vec3 ray_way(uint slot) {
    uint b = slot / BLOCK, l = slot % BLOCK;
    return vec3(HERE.rays.at[b].d[0][l], HERE.rays.at[b].d[1][l], HERE.rays.at[b].d[2][l]);
}
