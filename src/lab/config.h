/* lab: configurations of a spec. */
#ifndef NOC_LAB_CONFIG_H
#define NOC_LAB_CONFIG_H

#include "lab/member.h"

/* shared holds what all configurations have in common, and is what they begin as. */
noc_status lab_read_shared(lab_spec *spec, json_t *object, lab_config *shared);
/* One entry, which may stand for several: added to the spec's. */
noc_status lab_read_config(lab_spec *spec, const char *place, json_t *object, const lab_config *shared, size_t entry);
void lab_warn_of_idle(const lab_spec *spec, json_t *root); /* of options that change nothing */

#endif
