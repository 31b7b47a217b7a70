/* A region of nocturne/influence.h. */
#ifndef NOC_REGION_H
#define NOC_REGION_H

#include "base/base.h"
#include <nocturne/influence.h>

struct noc_region {
    noc_log *log;
    NOC_ARRAY(noc_patch) patches;
    size_t left_out; /* places where something stands */
};

static inline bool noc_patch_is_point(const noc_patch *p) {
    for (int k = 0; k < 3; k++)
        if (p->u[k] != 0 || p->v[k] != 0)
            return false;
    return true;
}

/* The caller holds the scene for reading. */
noc_class noc_patch_class(const noc_patch *patch, const noc_scene *scene);
/* A copy whose patches are sorted by class, and those of a class along a curve through space, so that those that follow
 * one another are neighbours. The caller holds the scene for reading. NULL: no memory, not reported. */
noc_region *noc_region_sorted(const noc_region *region, const noc_scene *scene) NOC_MUST_USE;

#endif
