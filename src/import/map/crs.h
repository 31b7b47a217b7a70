/* map_crs: what a map's CRS may make GDAL open. It reads CRSs as it opens a map, by a context of PROJ's that nobody
 * else reaches. */
#ifndef NOC_IMPORT_MAP_CRS_H
#define NOC_IMPORT_MAP_CRS_H

#include "import/map/source.h"

#if NOC_HAVE_GDAL

/* An error if the text of a CRS names a file: a grid, a file of definitions. */
noc_status map_check_crs_text(const char *text, const char *name, noc_log *log);
/* The same of all CRSs of a GeoJSON, a FlatGeobuf or a Shapefile, put together as GDAL does, before it sees them. path
 * is GDAL's. Sets m->crs_named and m->odd_crs. */
noc_status map_check_crs(map_source *m, noc_stream *stream, const char *path, const map_format *format);
/* Of a GeoPackage, once it is open: GDAL reads the CRS of a layer as the layer is asked for. Their table must be one of
 * which each query gets what it holds: without indexes, hidden and generated columns. */
noc_status map_check_crs_rows(map_source *m);

#endif

#endif
