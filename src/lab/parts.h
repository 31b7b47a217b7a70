/* lab: tables of processes that share a spec. */
#ifndef NOC_LAB_PARTS_H
#define NOC_LAB_PARTS_H

#include "lab/session.h"

/* Makes a file and locks it, once no other process has it locked; what, which may be NULL, is noted where that takes
 * time. Closing the descriptor releases it. -1: it cannot be made, or the wait was cancelled. File systems without
 * locks do without. */
int lab_wait_for(lab_session *lab, const char *path, const char *what);
/* Opens the table of this part, and reads the rows of all tables of the folder. NOC_ERR_IO after reporting that another
 * process is the same part. */
noc_status lab_open_part(lab_session *lab);
/* Reads the rows of all parts and holds their tables. Sets *busy, and holds none, if one of them is being written. */
noc_status lab_take_parts(lab_session *lab, bool *busy);
/* Removes the tables that are held, whose rows are in results.csv by now. keep: puts them aside, for rows that are not.
 */
noc_status lab_remove_parts(lab_session *lab, bool keep);
void lab_release_parts(lab_session *lab); /* for the next session */
/* Returns true if the run is one of this part: parts are blocks of runs, so that few of them share a reference. */
bool lab_is_mine(const lab_session *lab, const lab_run *run);

#endif
