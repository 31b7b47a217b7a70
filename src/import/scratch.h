/* scratch: a folder of our own for a while, in the system's temporary one. */
#ifndef NOC_IMPORT_SCRATCH_H
#define NOC_IMPORT_SCRATCH_H

#include "base/base.h"

typedef struct scratch_folder {
    char *path; /* NULL: none */
    int lock;   /* of the folder, while we live: so a later run can tell it from what killed ones left */
} scratch_folder;

const char *scratch_place(void); /* TMPDIR, or /tmp */
/* Makes one, and removes what killed runs of this user left beside it. name: of the file it is for, in errors. */
noc_status scratch_make(scratch_folder *s, const char *name, noc_log *log);
void scratch_remove(scratch_folder *s); /* with all that is in it; nothing where there is none */

#endif
