/* confine: what its files share: limits (confine.c), files by Landlock (confine_files.c), system calls by seccomp
 * (confine_calls.c). */
#ifndef NOC_IMPORT_CONFINE_H
#define NOC_IMPORT_CONFINE_H

#include "import/remote/remote.h"

/* What a reader needs beside the input's bytes. */
typedef struct confine_needs {
    bool whole;    /* all files of the input's folder */
    bool anywhere; /* all files that this user may read */
    bool lists;    /* the names in the input's folder */
    bool scratch;  /* to write in the temporary folder */
} confine_needs;

bool confine_has_landlock(void);
bool confine_has_seccomp(void);
/* From now on this thread, and those that it starts, open nothing but what is needed: files of the system, and those
 * of the input at path. Nothing happens where the system or the build has no Landlock. */
void confine_files(const char *path, const confine_needs *needs);
/* From now on all threads of this process make those system calls alone that reading takes: others fail, as on a
 * system that lacks them. Nothing happens where the system or the build has no seccomp. */
void confine_calls(const confine_needs *needs);

#endif
