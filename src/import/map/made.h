/* made: files that GDAL makes in memory, from where they are written as all outputs are. */
#ifndef NOC_IMPORT_MAP_MADE_H
#define NOC_IMPORT_MAP_MADE_H

#include "base/base.h"
#include "import/map/gdal.h"

#if NOC_HAVE_GDAL

typedef struct map_made {
    const char *format, *ending;                    /* "GeoTIFF", ".tif" */
    const char *option, *value;                     /* of GDAL's configuration, while it is made */
    bool (*make)(const void *of, const char *name); /* false: GDAL has said why */
} map_made;

/* GDAL is loaded. NOC_ERR_IO, NOC_ERR_MEMORY after reporting. */
noc_status map_write_made(const map_made *m, const void *of, const char *path, noc_log *log);

#endif

#endif
