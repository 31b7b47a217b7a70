/* map_parts: files beside a map file that belong to it. */
#ifndef NOC_IMPORT_MAP_PARTS_H
#define NOC_IMPORT_MAP_PARTS_H

#include "import/import.h"
#include "import/map/gdal.h"
#include "import/scratch.h"

#define MAP_COPY_NAME "copy.gpkg"

/* Are the parts of the Shapefile at path regular files in its folder? An error is reported. The listener, which may be
 * NULL, gets their paths. */
noc_status map_check_shapefile(const char *path, bool anywhere, const import_listener *listener, noc_log *log);

/* Can what tells its CRS and its encoding (.prj, .cpg) be read to the end, where it is there? An error is reported. */
noc_status map_check_told(const char *path, noc_log *log);

#if NOC_HAVE_GDAL
/* Says in text[size] how many rows and shapes the Shapefile has, where its .dbf and its .shx disagree; else "". path is
 * GDAL's. GDAL reads those that both have, and tells nobody. */
void map_count_shapefile(const char *path, char *text, size_t size);
#endif

/* A GeoPackage with changes that are still in a log beside it is copied with it to a folder of our own, because SQLite
 * would write them into the file. The copy has the holes of the original, and is held to the budget's memory.
 * folder->path is NULL where there is no such log; else to be removed in any case. */
noc_status map_copy_geopackage(const char *path, bool anywhere, const import_budget *budget,
                               const import_listener *listener, noc_log *log, scratch_folder *folder);

#endif
