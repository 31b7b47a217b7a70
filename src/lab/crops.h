/* lab: shown frames beside the reference. */
#ifndef NOC_LAB_CROPS_H
#define NOC_LAB_CROPS_H

#include "lab/session.h"

noc_status lab_make_crops(lab_session *lab, size_t camera); /* while its reference is there */

#endif
