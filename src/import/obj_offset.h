/* obj_offset: an OBJ in map coordinates keeps its small steps although Assimp holds vertices in floats. */
#ifndef NOC_OBJ_OFFSET_H
#define NOC_OBJ_OFFSET_H

#include "base/base.h"

/* Takes whole metres off the vertices of the OBJ text where they lie far from zero, and tells how many: offset[k] is to be
 * added to the coordinates that are read from the text. *data (from malloc, with a 0 behind it) is replaced then. Texts
 * with vertices that are not three plain numbers stay as they are, with no offset. NOC_ERR_MEMORY is reported. */
noc_status obj_take_offset(char **data, size_t *size, double offset[3], const char *name, noc_log *log);

#endif
