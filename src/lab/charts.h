/* lab: one SVG over all cameras, where the configurations are not too many. */
#ifndef NOC_LAB_CHARTS_H
#define NOC_LAB_CHARTS_H

#include "lab/session.h"

bool lab_has_bars(const lab_spec *spec); /* frame times */
noc_status lab_bars(const lab_session *lab, const char *name);
bool lab_has_dots(const lab_spec *spec); /* errors */
noc_status lab_dots(const lab_session *lab, const char *name);

#endif
