#ifndef NOC_IMPORT_OBJ_FACES_H
#define NOC_IMPORT_OBJ_FACES_H

#include "import/mesh/obj_offset.h"

/* Makes faces of the OBJ text what Assimp understands, in place, and returns how many there are: vertices alone, or
 * with `places` those and their places in textures, where all of a face's are there (normals are not used), no indents,
 * no remarks. Those with vertices that are not there, or of fewer than three, are blanked out and counted, as are those
 * with a bad vertex: one bad face makes Assimp refuse the whole file. */
size_t obj_plain_faces(char *data, size_t size, bool places, const obj_numbers *bad, geo_issues *issues);

/* Behind the last byte of a statement: of its line, or of the lines that backslashes join to it. */
const char *obj_statement_end(const char *p, const char *stop);

#endif
