/* roads: lines of maps that are roads or railways, by their tags or columns. */
#ifndef NOC_IMPORT_MAP_ROADS_H
#define NOC_IMPORT_MAP_ROADS_H

#include "import/lamps/tags.h"

/* Do the tags make a line a road or a railway in use? Then fills all of it but id, point_count and xyz. name points
 * into tags. */
bool road_read(const lamp_tag *tags, size_t count, geo_road *road);
/* Do the tags make an area open water? */
bool water_read(const lamp_tag *tags, size_t count);

#endif
