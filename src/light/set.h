/* light/set: the lights of a scene, as the views of a world draw candidates from them. Each structure is made when a
 * frame first needs it, follows the scene's lights, and is shared by all views.
 *
 * Structures change only while no frame of the scene draws from them: a frame holds the scene for reading from its
 * first look to its last, a commit waits until none does, and the first frame after a commit that asks for candidates
 * brings all of them up to date, before it or another draws. What a commit costs then:
 *
 *              lights that move                  what lights emit               lights added or removed
 *   lists      their half is made anew           powers are summed up anew      the moving half is made anew
 *   power      nothing                           a new table, linear time       a new table
 *   influence  their half is made anew           sizes and bounds are refitted  the moving half is made anew
 *   light-bvh  their half is refitted, or built  powers are summed up anew      the moving half is built anew
 *              anew where it has become bad
 *
 * Lights that are added after the first commit come to the moving half, and those that stood and are removed stay in
 * the standing half as dark ones, which costs what a change of emission does. When these two together have become many,
 * a commit settles them (scene/relight.c): the standing half takes in what was added and forgets what was removed, and
 * both halves are made anew. */
#ifndef NOC_LIGHT_SET_H
#define NOC_LIGHT_SET_H

#include "light/alias.h"
#include "light/clusters.h"
#include "light/environment.h"
#include "light/influence.h"
#include "light/tree.h"

#include <nocturne/render.h>

typedef struct noc_light_set noc_light_set;

/* What a frame draws from. Entries that it did not ask for may be NULL. */
typedef struct noc_light_sources {
    const noc_clusters *clusters[NOC_HALVES];
    const noc_alias *alias;
    const noc_tree *tree;
    const noc_influence *influence;
    uint64_t volumes; /* number of what is held of it; 0: nothing */
} noc_light_sources;

/* probe: as in noc_influence_params. The scene must be committed and outlive the set. NULL after reporting that memory
 * was refused. */
noc_light_set *noc_light_set_create(const noc_scene *scene, noc_pool *pool, noc_probe_fn *probe, void *user,
                                    noc_log *log);
void noc_light_set_destroy(noc_light_set *set); /* NULL is allowed */

/* Follows lights that have changed since, and makes what candidates of that kind need with these parameters. Several
 * threads may ask at once. What `sources` got is held for its owner until he asks again or releases it; he starts with
 * a zeroed record. */
noc_status noc_light_set_get(noc_light_set *set, noc_candidates candidates, const noc_render_params *params,
                             noc_light_sources *sources);
void noc_light_set_release(noc_light_set *set, noc_light_sources *sources);

/* Fills what is told of influence volumes that these parameters asked for. */
void noc_light_set_note(const noc_influence *volumes, const noc_render_params *params, noc_light_stats *out);

/* Numbers of lights found are told apart up to that; 64 k bins take half a megabyte a thread. */
enum { NOC_FOUND_MOST = 1 << 16 };
static inline uint32_t noc_found_bins(size_t lights) { return (uint32_t)NOC_MIN(lights, (size_t)NOC_FOUND_MOST) + 1; }
/* Fills what surfaces of a frame found; count returns how many of them found so many lights, below `bins`. */
void noc_light_set_note_found(uint64_t (*count)(const void *user, uint32_t lights), const void *user, uint32_t bins,
                              noc_light_stats *out);

/* What directions are drawn from of the scene's map, which it must have: made when it is first asked for, and anew
 * where the map is another one. */
noc_status noc_light_set_map(noc_light_set *set, const noc_map_light **map);
size_t noc_light_set_map_bytes(noc_light_set *set); /* 0 where it is not there */

/* Bytes of what candidates of that kind are drawn from, 0 where it is not there; and wall seconds that it took to make.
 */
size_t noc_light_set_bytes(noc_light_set *set, noc_candidates candidates);
double noc_light_set_seconds(noc_light_set *set, noc_candidates candidates);

#endif
