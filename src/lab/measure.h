/* lab: the loops behind noc_lab_measure and noc_lab_reference, and behind the runs of a spec. */
#ifndef NOC_LAB_MEASURE_H
#define NOC_LAB_MEASURE_H

#include "base/base.h"

#include <nocturne/lab.h>

/* One configuration over its frames, in a fresh view. */
typedef struct lab_loop {
    noc_device *device;
    const noc_scene *scene;
    noc_render_params params; /* accumulate is off */
    double *sum;              /* room for 3 numbers a pixel; NULL: the mean of the frames is not wanted */
    noc_log *log;
    void *user;
    /* Sets the camera of a frame, and edits the scene for it. Frames count from 1. */
    noc_status (*prepare)(void *user, int frame, noc_camera *camera);
    bool (*progress)(void *user, int frame, double done);
    /* A frame is there. *last: no other is rendered. Returns whether its picture is wanted; where the mean is, each is.
     */
    bool (*rendered)(void *user, int frame, const noc_frame_stats *stats, const noc_light_stats *lights, bool *last);
    /* The view of a frame whose picture is wanted, before `take`. May be NULL. */
    noc_status (*seen)(void *user, int frame, noc_view *view);
    /* The picture of the frame, and then the mean of all so far. */
    noc_status (*take)(void *user, int frame, bool mean, const noc_image *image);
} lab_loop;

noc_status lab_run_loop(const lab_loop *loop);

/* A reference by so many frames. */
typedef struct lab_making {
    noc_device *device;
    const noc_scene *scene;
    const noc_camera *camera;
    noc_render_params params;
    int frames;
    double ceiling;
    noc_log *log;
    void *user;
    bool (*progress)(void *user, int frame, double done);
    void (*rendered)(void *user, int frame); /* a frame is there; may be NULL */
} lab_making;

noc_status lab_render_reference(const lab_making *making, noc_image **image, noc_lab_noise *noise);

#endif
