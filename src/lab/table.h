/* lab: results.csv. */
#ifndef NOC_LAB_TABLE_H
#define NOC_LAB_TABLE_H

#include "lab/session.h"

noc_status lab_open_table(lab_session *lab);
noc_status lab_claim(lab_session *lab, lab_run *run); /* rows of earlier sessions become the run's */
noc_status lab_append(lab_session *lab, const lab_run *run, int mode, int frame); /* frame from 1 */
noc_status lab_tidy_table(lab_session *lab); /* at the end: leaves out rows of other settings */

#endif
