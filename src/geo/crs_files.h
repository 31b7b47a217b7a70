/* crs_files: which files a coordinate system may open. Grids and init files are files, and a definition names them. */
#ifndef NOC_GEO_CRS_FILES_H
#define NOC_GEO_CRS_FILES_H

#include "base/base.h"
#include "geo/crs_proj.h"

/* A context that never asks a network, says nothing, and opens regular files alone (a pipe would hang it): all of them,
 * or, strict, none but PROJ's database. NULL: memory was refused. */
PJ_CONTEXT *crs_context_create(bool strict);

/* The first thing in a definition that may make PROJ open a file (a PROJ parameter that is not known to be a number or
 * a name, a grid of a WKT), copied to what; false if there is none. */
bool crs_text_names_file(const char *definition, char what[40]);
/* The same of what PROJ understood. */
bool crs_names_file(PJ_CONTEXT *context, const PJ *crs, char what[40]);

#endif
