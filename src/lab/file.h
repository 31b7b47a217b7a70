/* lab: files of its folder. */
#ifndef NOC_LAB_FILE_H
#define NOC_LAB_FILE_H

#include "base/output.h"

/* name: in the folder. */
noc_status lab_create_file(const char *folder, const char *name, noc_log *log, output *file);
FILE *lab_open_file(const char *path, noc_log *log);        /* a regular one, to read; NULL after reporting */
noc_status lab_make_folder(const char *path, noc_log *log); /* and those above it */
/* The whole text, as noc_fprintf writes a number: nan and inf, too. */
bool lab_parse_number(const char *text, double *out);
noc_status lab_io_error(noc_log *log, const char *path); /* tells errno */

#endif
