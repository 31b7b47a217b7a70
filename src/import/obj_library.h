/* obj_library: material libraries (MTL) as they are written, under the names that they are given. */
#ifndef NOC_OBJ_LIBRARY_H
#define NOC_OBJ_LIBRARY_H

#include "geo/geo.h"

/* The text of a library named by mtllib, with a 0 behind it, free() it; NULL where there is none. The name may hold blanks,
 * be several names, or a path of another machine, whose last part is then looked for in the folder (with a slash at its
 * end, or ""). Statements with numbers that are none are blanked out and counted, as are textures. */
char *obj_open_library(const char *folder, const char *name, size_t *size, geo_issues *issues);

#endif
