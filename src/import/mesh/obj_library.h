/* obj_library: material libraries (MTL) as they are written, under the names that they are given. */
#ifndef NOC_OBJ_LIBRARY_H
#define NOC_OBJ_LIBRARY_H

#include "geo/geo.h"

/* Where libraries are looked for. */
typedef struct obj_folder {
    const char *path; /* with a slash at its end, or "" */
    bool anywhere;    /* they may lie outside it */
    const char *why;  /* the last one could not be opened */
    bool refused;     /* memory was, to one of them, which then is not there; stays set */
} obj_folder;

/* The text of a library named by mtllib, with a 0 behind it, free() it; NULL where there is none. The name may hold
 * blanks, be several names, or a path of another machine, whose last part is then looked for in the folder. Statements
 * with numbers that are none are blanked out and counted, as are textures. */
char *obj_open_library(obj_folder *folder, const char *name, size_t *size, geo_issues *issues);

#endif
