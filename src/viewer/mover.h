/* mover: a client's camera, by what its hand does. */
#ifndef NOC_VIEWER_MOVER_H
#define NOC_VIEWER_MOVER_H

#include "viewer/viewer.h"
#include "viewer/wire.h"
#include "viewer/world.h"

/* A camera by its name, as it was found; aspect 0: it was not asked for yet. */
typedef struct mover_named {
    noc_camera camera;
    double aspect;
    bool there;
} mover_named;

typedef struct mover {
    viewer_world *world;
    const viewer_source *source;
    noc_view *view; /* for rays: what is walked on, and into */
    noc_navigator *navigator;
    noc_camera camera;
    mover_named *named; /* the recipe's, then those that are found in the scene: to find one takes some 40 ms */
    double stepped;     /* when it was moved last, s */
    char name[64];      /* of the camera that it stands at; "" once it has moved */
} mover;

/* Of a scene that is there; it stands where the source says. */
noc_status mover_init(mover *m, viewer_world *world, const viewer_source *source, double aspect);
void mover_finish(mover *m);
void mover_input(mover *m, const wire_input *input, double aspect, double now);
/* Time passes for a camera on its way. false: it is on none. */
bool mover_advance(mover *m, double aspect, double now);
bool mover_moves(const mover *m);
/* These are false, with why, where it cannot be. */
bool mover_go(mover *m, const wire_camera *to, double aspect, double now, char *why, size_t size);
bool mover_jump(mover *m, const double at[2], double aspect, double now, char *why, size_t size);
/* Who is on the way is there. */
void mover_arrive(mover *m, double aspect, double now);
bool mover_look(mover *m, const double place[3], double distance, double now, char *why, size_t size);
bool mover_navigate(mover *m, wire_mode mode, double speed, double now, char *why, size_t size);
json_t *mover_camera(const mover *m);     /* state.camera */
json_t *mover_navigation(const mover *m); /* state.navigate */

#endif
