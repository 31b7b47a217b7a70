/* render/rows.h: what kernels over rows of a finished picture share: the smoother's and those of stills. */
#ifndef NOC_ROWS_H
#define NOC_ROWS_H

#include "render/backend.h"

#define PLANE_TOLERANCE 0.02f /* of the depth */
#define NORMAL_SHARPNESS 6.f  /* weights are 0 from 1 - 1/6 in cosine on: 34 degrees */
#define MOST_LIGHT 1e30f

static inline float max_of(float a, float b) { return a > b ? a : b; } /* one instruction; b for NaN */
static inline float least_of(float a, float b) { return a < b ? a : b; }
static inline int most_int(int a, int b) { return a > b ? a : b; }
static inline int least_int(int a, int b) { return a < b ? a : b; }
static inline float luma(float r, float g, float b) { return 0.2126f * r + 0.7152f * g + 0.0722f * b; }
static inline float green(float y, float r, float b) { return (y - 0.2126f * r - 0.0722f * b) * (1 / 0.7152f); }
static inline noc_row_kind kind_of(uint32_t what) { return (noc_row_kind)(what & 3); }

/* 1 / depth along the view, and its change a pixel to the right and down. */
typedef struct row_plane {
    float inverse, slope_x, slope_y;
} row_plane;

/* The plane of the surface that pixel (x, y), number i, sees. Along a plane 1 / depth is linear in the picture: (normal
 * . direction of the pixel) / (normal . (plane - eye)). depth 0: no surface, all are 0. */
static inline row_plane plane_of(const frame_camera *c, const float *const normal[3], float depth, int x, int y,
                                 size_t i) {
    float step_x = 2 / c->width, step_y = -2 / c->height, n[3] = { 0 };
    float sx = step_x * ((float)x + c->jitter[0]) - 1, sy = 1 + step_y * ((float)y + c->jitter[1]);
    for (int k = 0; k < 3; k++) {
        n[0] += normal[k][i] * c->right[k];
        n[1] += normal[k][i] * c->up[k];
        n[2] += normal[k][i] * c->forward[k];
    }
    float facing = n[2] + n[0] * sx + n[1] * sy, inverse = depth > 0 ? 1 / depth : 0;
    float across = facing < -1e-6f ? inverse / facing : 0;
    return (row_plane){ inverse, across * n[0] * step_x, across * n[1] * step_y };
}

#endif
