/* camera: what the parts of the derived views share. */
#ifndef NOC_SCENE_CAMERA_H
#define NOC_SCENE_CAMERA_H

#include "scene/scene.h"

#include <nocturne/path.h>

void noc_light_centre(const noc_light_record *r, double p[3]);
/* The square root of its flux, so that one floodlight does not outweigh a street. */
double noc_light_weight(const noc_light_record *r);

/* A view from inside where what lies within lo..hi is a room whose lights are in it; false, and *camera as it was,
 * else. */
bool noc_room_camera(const noc_scene *scene, const double lo[3], const double hi[3], double aspect, noc_camera *camera);

/* From outside, so that what lies within lo..hi fills the picture; what lies beyond counts as at its border. False
 * where memory was refused. */
bool noc_overview_camera(const noc_scene *scene, const double lo[3], const double hi[3], double aspect,
                         noc_camera *camera);

/* Keys of one turn about the vertical through the target, or the eye. A path through them is a circle to 2e-5 of its
 * radius. */
enum { NOC_TURN_KEYS = 36 };
void noc_turn_keys(const noc_camera *camera, bool about_eye, noc_camera_key keys[NOC_TURN_KEYS]);

#endif
