/* outlines: buildings of maps, by their tags or columns: what is a building, and how high it is. */
#ifndef NOC_IMPORT_MAP_OUTLINES_H
#define NOC_IMPORT_MAP_OUTLINES_H

#include "import/lamps/tags.h"

/* Do the tags say that an area is a building? 1: yes; 0: no; -1: they say nothing of it. */
int outline_verdict(const lamp_tag *tags, size_t count);
/* Does the name of a layer say that it holds buildings ("buildings", "Gebaeude", "bati", ...)? */
bool outline_layer(const char *name);
/* Fills heights, NaN where the tags do not tell them, and the use. */
void outline_read(const lamp_tag *tags, size_t count, geo_footprint *footprint);

#endif
