/* lab: one plot of errors. */
#ifndef NOC_LAB_PLOT_H
#define NOC_LAB_PLOT_H

#include "lab/session.h"

/* Error over frames or CPU seconds as SVG; name is the file's, in the folder. */
noc_status lab_plot(const lab_session *lab, size_t camera, int mode, bool over_time, const char *name);

#endif
