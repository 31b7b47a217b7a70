#version 460
/* A ray of the camera for each pixel. */
#extension GL_GOOGLE_include_directive : require
#include "bridge.glsl"
#include "pixel.glsl"

void main() {
    if (!in_grid())
        return;
    place p = my_place();
    frame_camera c = FRAME.camera;
    vec3 d = camera_direction(camera_of(c), float(p.x) + c.jitter[0], float(p.y) + c.jitter[1]);
    ray_put(p, 0u, p.inside, splat3(c.eye), d);
}
