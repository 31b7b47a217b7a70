/* lab: where the present camera is, frame by frame. */
#ifndef NOC_LAB_MOTION_H
#define NOC_LAB_MOTION_H

#include "lab/session.h"

noc_status lab_place_cameras(lab_session *lab, size_t camera); /* once its scene is there */
noc_camera lab_camera_at(const lab_session *lab, size_t camera, int frame);
/* Moves the scene's cars to where the camera's frame has them: in its last frame where the load put them. */
noc_status lab_place_cars(lab_session *lab, size_t camera, int frame);

#endif
