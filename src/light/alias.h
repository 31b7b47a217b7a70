/* light/alias: alias table over the lights' luminous flux, or other numbers (core/alias.h). */
#ifndef NOC_LIGHT_ALIAS_H
#define NOC_LIGHT_ALIAS_H

#include "scene/scene.h"

typedef struct noc_alias_slot {
    float keep;
    uint32_t other;
    float inverse, inverse_other;
} noc_alias_slot;

typedef struct noc_alias {
    uint32_t count;        /* slots; 0: no light emits anything */
    noc_alias_slot *slots; /* one a light */
    size_t bytes;
} noc_alias;

/* Returns NULL after reporting that memory was refused. */
noc_alias *noc_alias_create(const noc_scene *scene, noc_log *log);
/* The same over n numbers that are not negative, their sum finite. what: for messages. */
noc_alias *noc_alias_of(const double *weight, size_t n, const char *what, noc_log *log);
void noc_alias_destroy(noc_alias *alias); /* NULL is allowed */

#endif
