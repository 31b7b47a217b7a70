/* crs_kept: what PROJ found once. It opens its database for every context (1 ms) and searches it for every transform
 * (5 to 40 ms), and a scene of many files asks for the same few again and again. What is kept is bounded, and lives as
 * long as the process. */
#ifndef NOC_GEO_CRS_KEPT_H
#define NOC_GEO_CRS_KEPT_H

#include "base/base.h"
#include "geo/crs_proj.h"

/* A context as crs_context_create makes it, the caller's until it is given back. NULL where memory is refused. */
PJ_CONTEXT *crs_context_take(bool strict);
void crs_context_give(PJ_CONTEXT *context, bool strict); /* NULL is nothing */

#define CRS_KEY 1024 /* bytes of a key, with its end; a CRS with a longer definition has none ("") */

/* A copy of what was kept for the two keys, the caller's; NULL if there is none. */
PJ *crs_kept(PJ_CONTEXT *context, const char *from, const char *to);
/* Keeps a copy of pj, unless a key is empty. */
void crs_keep(const PJ *pj, const char *from, const char *to);
size_t crs_kept_count(void); /* times that something was kept: for tests */

#endif
