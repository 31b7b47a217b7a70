/* world: the scene that all clients share: its loading, what can be set of it, and the clock of its traffic. All of it
 * may be called from any thread.
 *
 * Edits are staged and published by the world's own thread, which waits for frames (noc_scene_commit), so that nobody
 * else does: what is set shows in the next frame that begins after it. */
#ifndef NOC_VIEWER_WORLD_H
#define NOC_VIEWER_WORLD_H

#include "viewer/viewer.h"

#include <jansson.h>

typedef struct viewer_world viewer_world;

/* Begins to load, in a thread of its own. source and log must outlive it. NULL after reporting. */
viewer_world *world_create(const viewer_source *source, noc_log *log);
/* After all views of its scene. Ends the loading, too. NULL is allowed. */
void world_destroy(viewer_world *world);

/* false once it is over, well or not. */
bool world_loading(viewer_world *world, char *what, size_t size, double *done);
/* Why it could not be loaded; NULL: it was, or is not yet over. It belongs to the world. */
const char *world_failed(viewer_world *world);
/* NULL while it loads, and where that failed. */
noc_scene *world_scene(viewer_world *world);
noc_device *world_device(viewer_world *world);
const noc_report *world_report(viewer_world *world);

/* What can be set (docs/viewer-protocol.md): a list of options; and an object of `values` and `idle`. */
json_t *world_schema(viewer_world *world);
json_t *world_state(viewer_world *world);
/* Sets an option, which the next frame shows. false, with why: nothing has changed. */
bool world_set(viewer_world *world, const char *name, const char *value, char *why, size_t size);
/* Somebody looks now: cars drive while that was said within the last second. */
void world_look(viewer_world *world);
/* Waits until all that was set is in the scene. */
void world_settle(viewer_world *world);

/* Counts what makes other pictures: what was set, and the cars' moves. */
uint64_t world_version(viewer_world *world);
/* Counts commits. A frame that begins at the `version` of world_state, or later, shows its values. */
uint64_t world_published(viewer_world *world);
/* Counts changes of world_state but the time of cars that drive. */
uint64_t world_told(viewer_world *world);

/* Words of a command line that say the world as it is now, beside the inputs: of `given` and of what was set. NULL: no
 * memory. Each, and the list, is the caller's. *beyond: something was set that no option says (materials). */
char **world_words(viewer_world *world, size_t *count, bool *beyond);

/* What inputs are read with, windows, time and rain as they are set. */
void world_import(viewer_world *world, noc_import_params *import);

/* What was set of the world, for a recipe. */
typedef struct world_setting {
    const noc_option *option; /* of noc_import_options */
    char value[64];
} world_setting;
typedef struct world_group {
    const char *name; /* the scene's */
    bool on;
    double scale;
    char colour[16]; /* "2200K", "#ffb060", or "own" */
} world_group;
enum { WORLD_SETTINGS = 8 };
typedef struct world_made {
    world_setting settings[WORLD_SETTINGS];
    size_t setting_count;
    noc_material materials[NOC_CLASS_COUNT]; /* of classes that were set, dry */
    size_t material_count;
    world_group *groups; /* that are not as inputs and recipe have them; free() them */
    size_t group_count;
    bool no_traffic; /* the cars are out of sight */
} world_made;
/* "0.5,2200K" */
const char *world_group_name(const viewer_world *world, int index); /* of the scene's group; "": it has none */
void world_group_text(const world_group *group, char *text, size_t size);
/* false: no memory. */
bool world_get_made(viewer_world *world, world_made *made);

#endif
