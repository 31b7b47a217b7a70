/* core/camera.h: pinhole camera. Pixel coordinates run from (0, 0) at the top left corner to (width, height). */
#ifndef CORE_CAMERA_H
#define CORE_CAMERA_H

#include "core/dialect.h"
#include "core/frame.h"

struct camera {
    v3 eye;
    v3 right;        /* from the picture's centre to its right edge, at distance 1 */
    v3 up;           /* to its upper edge */
    v3 forward;      /* unit */
    real inv_right2; /* 1 / |right|^2 */
    real inv_up2;
    real width;
    real height;
};

#ifndef CORE_GLSL
typedef struct camera camera;
#endif

FN camera camera_of(frame_camera f) {
    camera c;
    c.eye = splat3(f.eye);
    c.right = splat3(f.right);
    c.up = splat3(f.up);
    c.forward = splat3(f.forward);
    c.inv_right2 = K(f.inv_right2);
    c.inv_up2 = K(f.inv_up2);
    c.width = K(f.width);
    c.height = K(f.height);
    return c;
}

/* Unnormalised direction through a place in the picture. */
FN v3 camera_direction(camera c, real px, real py) {
    EXACT real x = px / c.width * K(2.0f) - K(1.0f);
    EXACT real y = K(1.0f) - py / c.height * K(2.0f);
    EXACT real dx = c.forward.x + (c.right.x * x + c.up.x * y);
    EXACT real dy = c.forward.y + (c.right.y * x + c.up.y * y);
    EXACT real dz = c.forward.z + (c.right.z * x + c.up.z * y);
    return V3(dx, dy, dz);
}

/* The same of pixel (x, y) in this frame: its ray's, from FRAME.camera.eye. */
FN v3 frame_direction(CTX u32 x, u32 y) {
    return camera_direction(camera_of(FRAME.camera), to_real(x) + K(FRAME.camera.jitter[0]),
                            to_real(y) + K(FRAME.camera.jitter[1]));
}

/* Where a point is seen: pixel coordinates in x, y and depth along the view in z (not in front of the camera: z <= 0).
 */
FN v3 camera_project(camera c, v3 p) {
    v3 d = sub3(p, c.eye);
    real z = dot3(d, c.forward);
    EXACT real inv = K(1.0f) / sel(z > K(0.0f), z, K(1.0f));
    EXACT real x = dot3(d, c.right) * inv * c.inv_right2;
    EXACT real y = dot3(d, c.up) * inv * c.inv_up2;
    EXACT real px = (x + K(1.0f)) * K(0.5f) * c.width;
    EXACT real py = (K(1.0f) - y) * K(0.5f) * c.height;
    return V3(px, py, z);
}

#endif
