/* lab: cameras of a spec. */
#ifndef NOC_LAB_CAMERAS_H
#define NOC_LAB_CAMERAS_H

#include "lab/member.h"

/* Added to the spec's. */
noc_status lab_read_cameras(lab_spec *spec, const char *place, json_t *cameras, size_t scene);

#endif
