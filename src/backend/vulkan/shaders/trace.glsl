/* Rays that an `ask` shader has written, one invocation each. */
layout(set = 0, binding = 0) uniform accelerationStructureEXT scene;

#include "payload.glsl"

uint my_slot() {
    return gl_LaunchIDEXT.z * HERE.slots + gl_LaunchIDEXT.y * gl_LaunchSizeEXT.x + gl_LaunchIDEXT.x;
}
