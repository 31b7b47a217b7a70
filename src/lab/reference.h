/* lab: the present scene and its reference. */
#ifndef NOC_LAB_REFERENCE_H
#define NOC_LAB_REFERENCE_H

#include "lab/session.h"

noc_status lab_load_scene(lab_session *lab, size_t scene);
noc_status lab_place_camera(lab_session *lab, size_t camera);   /* and its reference is named */
noc_status lab_make_reference(lab_session *lab, size_t camera); /* read or rendered, once the camera is placed */

#endif
