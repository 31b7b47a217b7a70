/* roads: lines of maps that are roads or railways, by their tags or columns. */
#ifndef NOC_IMPORT_MAP_ROADS_H
#define NOC_IMPORT_MAP_ROADS_H

#include "import/lamps/tags.h"

/* Do the tags make a line a road or a railway in use? Then fills all of it but id, point_count and xyz. name points
 * into tags. */
bool road_read(const lamp_tag *tags, size_t count, geo_road *road);
/* The class that the tags make of an area: water, green, sidewalk, road; NOC_CLASS_OTHER: none of them. */
noc_class area_class(const lamp_tag *tags, size_t count);

#endif
