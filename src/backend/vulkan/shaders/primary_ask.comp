#version 460
/* A ray of the camera for each pixel. */
#extension GL_GOOGLE_include_directive : require
#define UNCOUNTED
#include "bridge.glsl"
#include "pixel.glsl"

void main() {
    if (!in_grid())
        return;
    place p = my_place();
    ray_put(p, 0u, p.inside, splat3(FRAME.camera.eye), frame_direction(p.x, p.y));
}
