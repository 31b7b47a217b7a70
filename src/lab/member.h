/* lab: members of a spec's objects to fields of structs, by option tables. What is wrong is reported with its place. */
#ifndef NOC_LAB_MEMBER_H
#define NOC_LAB_MEMBER_H

#include "lab/spec.h"

#include <jansson.h>

/* An option table and where its params struct lies in the one that is filled; arrays of them end with a NULL table. */
typedef struct lab_options {
    const noc_option *(*table)(void);
    size_t offset;
    const char *const *hidden; /* names of rows that are not offered, NULL-ended; may be NULL */
} lab_options;

/* NOC_ERR_FORMAT, reported. place: "configurations[2]", or "". */
noc_status lab_wrong(const lab_spec *spec, const char *place, const char *fmt, ...) NOC_PRINTF(3, 4);
noc_status lab_too_many(const lab_spec *spec, const char *place, size_t count, size_t most, const char *what);
/* The spec's arena was refused something. */
noc_status lab_spec_no_memory(const lab_spec *spec);

const noc_option *lab_option(const lab_options *options, const char *name, size_t *offset);
/* others: names that are right here but no options */
noc_status lab_set(lab_spec *spec, const char *place, const lab_options *options, const char *const *others,
                   void *params, const char *name, json_t *value);
noc_status lab_set_all(lab_spec *spec, const char *place, json_t *object, const lab_options *options,
                       const char *const *others, void *params);
noc_status lab_read_name(lab_spec *spec, const char *place, json_t *object, const char **name);
bool lab_read_box(const char *text, int width, int height, int box[4]); /* "x,y,width,height" inside a picture */

#endif
