/* built: a scene with its report in one file, and out of it. noct/noct.h is the file, scene/keep.h what a scene keeps.
 */
#ifndef NOC_IMPORT_BUILT_H
#define NOC_IMPORT_BUILT_H

#include "import/load/load.h"
#include "noct/noct.h"

/* A number for all that must be the same where a file is written and where it is read. */
uint64_t built_layout(void);
/* Into an empty scene and the importer's report. */
noc_status built_read(importer *im, const char *path);

/* report.c */
void built_write_report(noct_writer *w, const noc_report *report);
noc_status built_read_report(noct_file *f, noc_report *report);
/* A number for what a report's file is kept as. */
uint64_t built_report_layout(void);

#endif
