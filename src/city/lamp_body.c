#include "city/lamp.h"

#include <math.h>

#define GAP 0.01 /* m between the light's disc and a head above it */

/* Columns are where the model's axes go, with one scale. */
static bool show(noc_scene *scene, const city_body *body, const double axes[3][3], double scale, const double at[3]) {
    noc_instance instance = { .model = body->model };
    for (int row = 0; row < 3; row++) {
        for (int column = 0; column < 3; column++)
            instance.transform[4 * row + column] = scale * axes[column][row];
        instance.transform[4 * row + 3] = at[row];
    }
    return noc_scene_add_instance(scene, &instance) >= 0;
}

bool body_show_head(noc_scene *scene, const city_body *body, const double light[3], const double axis[3],
                    const double street[2]) {
    /* its front is -y, and its up, z, is away from where the light shines */
    double front[3] = { street[0], street[1], 0 }, along = front[0] * axis[0] + front[1] * axis[1], axes[3][3], at[3];
    double length = 0;
    for (int k = 0; k < 3; k++) {
        axes[2][k] = -axis[k];
        front[k] -= along * axis[k];
        length += front[k] * front[k];
        at[k] = light[k] - GAP * axis[k];
    }
    if (!(length > 1e-6)) { /* it shines level: its top is up */
        front[0] = front[1] = 0;
        front[2] = length = 1;
    }
    for (int k = 0; k < 3; k++)
        axes[1][k] = -front[k] / sqrt(length);
    for (int k = 0; k < 3; k++) /* x = y cross z */
        axes[0][k] = axes[1][(k + 1) % 3] * axes[2][(k + 2) % 3] - axes[1][(k + 2) % 3] * axes[2][(k + 1) % 3];
    return show(scene, body, axes, 1, at);
}

bool body_show_whole(noc_scene *scene, const city_body *body, const double foot[3], double height,
                     const double street[2], double light[3]) {
    const double axes[3][3] = { { -street[1], street[0], 0 }, { -street[0], -street[1], 0 }, { 0, 0, 1 } };
    double scale = height / body->light[2];
    for (int k = 0; k < 3; k++)
        light[k] =
            foot[k] + scale * (axes[0][k] * body->light[0] + axes[1][k] * body->light[1] + axes[2][k] * body->light[2]);
    return show(scene, body, axes, scale, foot);
}
