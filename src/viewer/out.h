/* out: what leaves the viewer: a command line that renders the same picture, a recipe, files of pictures. */
#ifndef NOC_VIEWER_OUT_H
#define NOC_VIEWER_OUT_H

#include "viewer/look.h"
#include "viewer/world.h"

/* What a pane shows. */
typedef struct out_view {
    const viewer_source *source;
    viewer_world *world;
    const look *look;
    const noc_camera *camera;
    int width, height;
    uint64_t frames;    /* in its mean */
    const noc_bar *bar; /* of its newest picture; NULL, or high 0: that has none */
} out_view;

/* Its look, with the ends of the colour bar that were found for it, so that colours stay what they are. */
look out_look(const out_view *view);

/* "nocturne render INPUTS ... -o night.png", for a POSIX shell: only what differs from what the inputs, their recipe
 * and the program say already. The camera stands in the scene's local frame, with all of its digits, so that the pixels
 * are the same. What no option says (materials) is told behind a #. The caller frees it. NULL: no memory. */
char *out_command(const out_view *view);

/* "nocturne influence INPUTS ... --count-windows --region REGION", which asks the same of the world as it is. camera,
 * of a picture of that size: where the region is said by its pixels; else NULL. The caller frees it. NULL: no memory.
 */
char *out_influence(const viewer_source *source, viewer_world *world, const noc_render_params *render,
                    const char *region, const noc_camera *camera, int width, int height);

/* A camera that the page keeps. */
typedef struct out_bookmark {
    const char *name;
    noc_camera camera;
} out_bookmark;
/* The view as a recipe, which noc_recipe_load takes: inputs by whole paths, all that their recipe says and that was
 * said beside it, and what was set. Its cameras are the view, the bookmarks, and the recipe's; with two bookmarks or
 * more the path `bookmarks` goes through them. The caller frees it. NULL, with why. */
char *out_recipe(const out_view *view, const out_bookmark *bookmarks, size_t count, char *why, size_t size);

/* The picture of a pane as a file in memory, with the metadata that `nocturne render` writes: PNG, or EXR with linear
 * values. The caller frees *data. false, with why. */
bool out_picture(const out_view *view, noc_view *of, bool exr, unsigned char **data, size_t *size, char *why,
                 size_t why_size);

#endif
