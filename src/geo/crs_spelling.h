/* crs_spelling: what a srsName means, before PROJ is asked. Pure text. */
#ifndef NOC_GEO_CRS_SPELLING_H
#define NOC_GEO_CRS_SPELLING_H

#include "base/base.h"

/* A CRS as "AUTHORITY:CODE", and that of the heights where the spelling is of a compound CRS; "" where absent. */
typedef struct crs_spelling {
    char horizontal[48];
    char vertical[48];
} crs_spelling;

/* True if the definition names a registered CRS in one of the known spellings; false: it may be WKT, a PROJ string or
 * the full name of a CRS, which are PROJ's to read. */
bool crs_spelling_parse(const char *definition, crs_spelling *out);

#endif
