#ifndef NOC_IMPORT_OBJ_FACES_H
#define NOC_IMPORT_OBJ_FACES_H

#include "geo/geo.h"

/* Blanks out the faces of an OBJ whose vertices, texture places or normals are not there, or are no numbers, and counts
 * them: one bad face makes Assimp refuse the whole file. */
void obj_drop_bad_faces(char *data, size_t size, geo_issues *issues);

#endif
