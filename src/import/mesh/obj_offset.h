/* obj_offset: vertices of an OBJ as plain numbers; one in map coordinates keeps its small steps although Assimp holds
 * vertices in floats. */
#ifndef NOC_OBJ_OFFSET_H
#define NOC_OBJ_OFFSET_H

#include "geo/geo.h"

typedef NOC_ARRAY(long long) obj_numbers; /* of vertices, from 1, ascending */

/* Makes vertices of the OBJ text what Assimp understands, three plain numbers each: weights are divided by, colours and
 * remarks left out. What is none of a float's numbers is counted in issues and listed in bad; the others keep their
 * numbers. Whole metres are taken off where the vertices lie far from zero: offset[k] is to be added to the coordinates
 * that are read from the text. *data (from malloc, with a 0 behind it) is replaced where that needs it. NOC_ERR_MEMORY
 * is reported. places: those in textures (vt) become two plain numbers each, too. */
noc_status obj_plain_vertices(char **data, size_t *size, bool places, double offset[3], obj_numbers *bad,
                              geo_issues *issues, const char *name, noc_log *log);

#endif
