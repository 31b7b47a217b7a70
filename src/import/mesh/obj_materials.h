/* obj_materials: the materials that an OBJ asks for, and what reading it will take. */
#ifndef NOC_OBJ_MATERIALS_H
#define NOC_OBJ_MATERIALS_H

#include "import/import.h"
#include "import/mesh/obj_chunks.h"
#include "import/mesh/obj_library.h"

/* Names that usemtl asks for and no library in the folder defines become one, as all of them stand for the default
 * material, and are counted. images: gets those of the others; NULL: they are of no use. Then counts what reading the
 * text will take; NOC_ERR_MEMORY after reporting where that is more than the budget has. */
noc_status obj_plain_materials(obj_chunks *text, obj_folder *folder, obj_images *images, import_budget *budget,
                               geo_issues *issues, const char *name, noc_log *log);

#endif
