/* osm_ways: buildings and streets in files of OpenStreetMap, which are counted, so that it can be said that they are
 * not read. */
#ifndef NOC_IMPORT_OSM_WAYS_H
#define NOC_IMPORT_OSM_WAYS_H

#include "import/import.h"

typedef enum osm_way { OSM_NEITHER, OSM_STREET, OSM_PART, OSM_BUILDING } osm_way;

/* What a tag makes of a way or relation; of several the largest counts. */
osm_way osm_way_of(const char *key, const char *value);
void osm_count_way(geo_features *features, osm_way way);

/* Counts the ways and relations of a file of XML, or of PBF, by their tags alone. Where the file is not what it should
 * be the count ends: whoever reads its lamps says so. NOC_ERR_MEMORY and errors of the stream are reported. */
noc_status osm_count_ways(noc_stream *stream, bool pbf, geo_sink *sink, geo_features *features) NOC_MUST_USE;

#endif
