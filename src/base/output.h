/* output: a file that appears under its name only when it is complete. Temporary files lie beside it, and those that
 * killed runs left are swept. */
#ifndef NOC_BASE_OUTPUT_H
#define NOC_BASE_OUTPUT_H

#include "base/base.h"

typedef struct output {
    FILE *file;
    char *path;      /* the target, as given: for messages */
    char *target;    /* with symbolic links resolved */
    char *temporary; /* beside target */
} output;
/* on failure nothing is left, and o need not be closed */
noc_status output_open(output *o, const char *path, noc_log *log);
/* Closes; if status is NOC_OK renames, else removes. Returns status, or the reported failure of the closing or
 * renaming. */
noc_status output_close(output *o, noc_status status, noc_log *log);
noc_status output_failed(output *o, noc_log *log); /* reports errno as a failure of writing */

#endif
