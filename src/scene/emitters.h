/* Which lights are one thing to people: the emitters of nocturne/influence.h. */
#ifndef NOC_EMITTERS_H
#define NOC_EMITTERS_H

#include "scene/scene.h"
#include <nocturne/influence.h>

#define NOC_NO_EMITTER UINT32_MAX

/* An emitter's lights; what else there is to say of it follows from them. */
typedef struct noc_emitter_entry {
    noc_emitter_kind kind;
    uint32_t first, count; /* light; how many */
    uint32_t instance;     /* UINT32_MAX: none */
    float lumens;
} noc_emitter_entry;

typedef struct noc_emitters {
    uint32_t *of; /* [lights of the scene] */
    size_t lights;
    NOC_ARRAY(noc_emitter_entry) all;
} noc_emitters;

/* Of the scene as it is; the caller holds it for reading. false: no memory, not reported. */
bool noc_emitters_make(const noc_scene *scene, noc_emitters *out) NOC_MUST_USE;
void noc_emitters_free(noc_emitters *emitters);
/* What is told of emitter number i. A NULL scene: its lights are others now, and no name or place is told. */
void noc_emitter_describe(const noc_scene *scene, const noc_emitters *emitters, uint32_t i, noc_emitter *out);

#endif
