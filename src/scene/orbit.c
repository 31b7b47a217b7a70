/* An orbit that clears what stands in its way. */
#include "scene/camera.h"

#include <math.h>

enum { WAY = 360 }; /* places of the way that are looked down from, */
#define ASIDE 10.0  /* m to either side, too */
#define ABOVE 8.0   /* m over what is there */
#define SLOPE 0.5   /* at which the eye rises and sinks */

static double highest(const noc_scene *scene, const noc_camera *camera, double angle) {
    double dx = camera->eye[0] - camera->target[0], dy = camera->eye[1] - camera->target[1], r = hypot(dx, dy);
    double from = atan2(dy, dx), top = -INFINITY, z;
    for (int i = -1; i <= 1; i++) {
        double x = camera->target[0] + (r + i * ASIDE) * cos(from + angle);
        double y = camera->target[1] + (r + i * ASIDE) * sin(from + angle);
        if (noc_scene_top(scene, x, y, &z))
            top = NOC_MAX(top, z);
    }
    return top;
}

/* Least height of the eye at each key. */
static void clear_heights(const noc_scene *scene, const noc_camera *camera, double heights[NOC_TURN_KEYS]) {
    double r = hypot(camera->eye[0] - camera->target[0], camera->eye[1] - camera->target[1]);
    for (int k = 0; k < NOC_TURN_KEYS; k++)
        heights[k] = camera->eye[2];
    for (int i = 0; i < WAY; i++) {
        double top = highest(scene, camera, 2 * M_PI * i / WAY) + ABOVE;
        for (int k = 0; k < NOC_TURN_KEYS; k++) {
            double apart = fabs((double)i / WAY - (double)k / NOC_TURN_KEYS);
            double way = 2 * M_PI * r * NOC_MAX(NOC_MIN(apart, 1 - apart) - 1.5 / NOC_TURN_KEYS, 0);
            heights[k] = NOC_MAX(heights[k], top - SLOPE * way);
        }
    }
}

noc_status noc_scene_orbit(const noc_scene *scene, const noc_camera *camera, double seconds, noc_camera_path **path) {
    if (!scene || !camera || !path)
        return noc_null(scene ? scene->log : NULL, __func__);
    *path = NULL;
    noc_camera_key keys[NOC_TURN_KEYS];
    double heights[NOC_TURN_KEYS];
    noc_scene_lock_read(scene);
    noc_status status = noc_ground_ready(scene);
    if (!status)
        clear_heights(scene, camera, heights);
    noc_scene_unlock_read(scene);
    if (status)
        return status;
    noc_turn_keys(camera, false, keys);
    for (int k = 0; k < NOC_TURN_KEYS; k++)
        keys[k].camera.eye[2] = heights[k];
    return noc_camera_path_create(keys, NOC_TURN_KEYS, true, seconds, scene->log, path);
}
