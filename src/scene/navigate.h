/* A navigator, as its files see it: navigate.c moves the camera, navigate_walk.c the walker, navigate_stand.c finds
 * where one can stand, navigate_go.c flies to places. */
#ifndef NOC_SCENE_NAVIGATE_H
#define NOC_SCENE_NAVIGATE_H

#include "scene/scene.h"
#include <nocturne/navigate.h>
#include <nocturne/path.h>

#define NAV_STEP (1.0 / 120) /* s */
#define NAV_EYE 1.7          /* m over the feet */
#define NAV_BODY 0.3         /* m: radius of a walker */
#define NAV_KERB 0.4         /* m: what is stepped on */
#define NAV_LEVEL 0.643      /* cosine of 50 degrees: what is steeper is a wall */
#define NAV_FAR_BELOW 2000.0 /* m: there is nothing below */

typedef struct nav_pose {
    double eye[3], yaw, pitch; /* yaw: from x to y; radians */
    double distance;           /* m to what it looks at */
    double fov;
} nav_pose;

typedef struct nav_walker {
    double foot;     /* height of its feet */
    double fall;     /* m/s downward */
    double lag;      /* m that the eye is behind its feet, which steps take at once */
    double aside[2]; /* m that panning has still to do */
} nav_walker;

struct noc_navigator {
    const noc_scene *scene;
    noc_cast_fn cast;
    void *user;
    noc_status failed; /* of the callback, since the last input */
    noc_navigate_mode mode;
    double speed, pace;    /* m/s: set, or 0; that keys have */
    nav_pose now, before;  /* at the last whole step, and at the one before that */
    double leftover;       /* s since the last whole step */
    double velocity[3];    /* m/s, of keys */
    double zoom, pivot[3]; /* steps still to go, and the place that they go to */
    double middle[3], reach, top;
    nav_walker walker;
    noc_camera_path *flight; /* NULL: none */
    double flown, lasts;     /* s of it */
    nav_pose there;          /* where it ends */
};

static inline double nav_dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* navigate.c */
void nav_forward(const nav_pose *p, double out[3]);
bool nav_pose_of(const noc_camera *camera, nav_pose *out); /* false: it looks nowhere */
void nav_camera_of(const nav_pose *p, noc_camera *out);
void nav_rest(noc_navigator *n); /* nothing of what went before moves it any more */
/* Turns about what is in the middle of the view. */
void nav_find_middle(noc_navigator *n);
/* Casts; what fails hits nothing. */
void nav_cast(noc_navigator *n, const noc_ray *rays, size_t count, noc_hit *hits);
noc_hit nav_cast_one(noc_navigator *n, const double from[3], const double way[3], double far);

/* navigate_walk.c: a step of the walker, whose feet are to go by d. */
void nav_walk(noc_navigator *n, const double d[2]);
bool nav_is_wall(const noc_hit *h);
/* First thing below that a walker may stand on, through cars and, if so told, trees. */
bool nav_drop(noc_navigator *n, const double from[3], bool through_trees, noc_hit *hit);
/* Room for a body on these feet? */
bool nav_has_room(noc_navigator *n, const double foot[3]);

/* navigate_stand.c: where to stand, near a place that an eye is at. false: nowhere. */
bool nav_find_stand(noc_navigator *n, const double eye[3], double foot[3]);

/* navigate_go.c */
noc_status nav_go_to(noc_navigator *n, const nav_pose *there);
void nav_fly_on(noc_navigator *n); /* a step of the flight */
void nav_end_flight(noc_navigator *n);

#endif
