/* lab: results.csv. */
#ifndef NOC_LAB_TABLE_H
#define NOC_LAB_TABLE_H

#include "lab/session.h"

noc_status lab_open_table(lab_session *lab);
/* Reads the rows of earlier sessions from a table. *whole: bytes up to the end of its last whole line, 0 if it is not
 * there; -1: it is no such table. */
noc_status lab_read_table(lab_session *lab, const char *path, long *whole);
noc_status lab_open_rows(lab_session *lab, const char *path, long whole); /* for rows behind those bytes */
/* Returns a name in the folder that no table that was put aside has; free() it. NULL after reporting. */
char *lab_old_name(const lab_session *lab);
noc_status lab_claim(lab_session *lab, lab_run *run); /* rows of earlier sessions become the run's */
noc_status lab_append(lab_session *lab, const lab_run *run, int mode, int frame); /* frame from 1 */
/* At the end: leaves out rows of other settings, and writes those of parts in the order of runs. *left_out: there were
 * rows that results.csv does not have. */
noc_status lab_tidy_table(lab_session *lab, bool *left_out);

#endif
