/* overpass: what the reader of Overpass JSON (overpass.c) and that of its shapes (overpass_shapes.c) share. */
#ifndef NOC_IMPORT_MAP_OVERPASS_H
#define NOC_IMPORT_MAP_OVERPASS_H

#include "import/lamps/tags.h"

#include <jansson.h>

typedef struct overpass_tags {
    NOC_ARRAY(lamp_tag) tags;
    char id[64]; /* "way/12" */
} overpass_tags;

/* False: memory was refused. */
bool overpass_collect(json_t *element, overpass_tags *list);
bool overpass_number(const json_t *object, const char *key, double *out);
bool overpass_is(const json_t *element, const char *type);

/* Hands on the ways that are roads, and the ways and relations that are buildings or areas of a class, where the sink
 * wants such. */
noc_status overpass_shapes(json_t *elements, lamp_writer *w) NOC_MUST_USE;

#endif
