/* What the frame before saw of a scene that is edited: its lights, where its instances were, what blocked its rays.
 * Temporal reuse evaluates its reservoirs' targets by that, so that it stays unbiased. What is decided here is the same
 * for every backend; the copies are the backends' own. */
#ifndef NOC_PAST_H
#define NOC_PAST_H

#include "core/blocks.h"
#include "render/plan.h"
#include "scene/scene.h"

/* Of a world: where instances are now and how to get back to where they were before the last change of shape. */
typedef struct noc_placings {
    NOC_ARRAY(noc_scene_place) now; /* of each instance of the scene */
    NOC_ARRAY(placing_back) back;   /* parallel */
    uint64_t shape, past;           /* noc_scene_shape of the scene that is known, and of that before */
    bool known;                     /* a scene was taken in */
} noc_placings;

/* Room for the scene's instances; false where memory is refused, and nothing has changed. */
bool noc_placings_reserve(noc_placings *p, const noc_scene *scene) NOC_MUST_USE;
/* Takes in where the scene's instances are; there must be room. The first call only notes that. */
void noc_placings_follow(noc_placings *p, const noc_scene *scene);
void noc_placings_free(noc_placings *p);

/* Of a view. Zero-initialise. */
typedef struct noc_past {
    noc_scene_versions seen; /* of the scene in the last complete frame */
    size_t room;             /* lights that the copy has room for; those beyond the frame's are dark in it */
    bool filled;             /* the copy is of that frame */
    bool lost;               /* something of the frame before is not known any more: nothing of it is reused */
} noc_past;

/* Before a frame. Returns how many lights the copy must have room for from now on, 0 where none is needed. Where there
 * is not enough, the caller makes room, keeping what there is if `filled`, and sets `room`. */
size_t noc_past_begin(noc_past *past, const noc_scene *scene, const noc_plan *plan);
/* After that: sets `lost`. */
void noc_past_check(noc_past *past, const noc_scene *scene, const noc_placings *placings, const noc_plan *plan);
/* After a frame: its reservoirs were made with the scene as it is. Returns the lights that are to be copied. */
noc_range noc_past_keep(noc_past *past, const noc_scene *scene);
/* Returns true if the frame before had other lights than the scene has now: those of the copy. */
bool noc_past_other_lights(const noc_past *past, const noc_scene *scene);
/* Returns true if rays met another scene in the frame before. */
static inline bool noc_past_other_shape(const noc_past *past, const noc_scene *scene) {
    return noc_scene_shape(&past->seen) != noc_scene_shape(&scene->versions);
}
/* The surfaces of a block, where they were in the frame before: those that moved instances show are taken back. Returns
 * g itself where all are static, else `moved`. instance: that each lane sees; NULL: none. */
const gblock *noc_past_surfaces(const noc_past *past, const noc_scene *scene, const noc_placings *placings,
                                const uint32_t instance[BLOCK], const gblock *g, gblock *moved);
/* Lanes of a block of which it is known where they were then: those of the world, and of instances that were there. */
uint32_t noc_past_known(const noc_past *past, const noc_scene *scene, const noc_placings *placings,
                        const uint32_t instance[BLOCK]);

#endif
