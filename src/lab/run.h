/* lab: one run, which is one configuration under one camera, one repetition. */
#ifndef NOC_LAB_RUN_H
#define NOC_LAB_RUN_H

#include "lab/session.h"

/* Measures what misses; the reference of its camera is there. */
noc_status lab_measure_run(lab_session *lab, lab_run *run);
/* Sets *misses if rows or pictures of the run are missing. */
noc_status lab_run_misses(const lab_session *lab, const lab_run *run, bool *misses);

#endif
