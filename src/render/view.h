/* A view, as the files of this room see it. */
#ifndef NOC_VIEW_H
#define NOC_VIEW_H

#include "render/device.h"

/* What of the last complete frame those need to know who go on from frame to frame. */
typedef struct noc_last_frame {
    uint64_t number; /* of the view's complete frames */
    bool there;      /* no other frame was begun since */
    bool motion;     /* it kept NOC_AOV_MOTION */
    bool connected;  /* to the complete frame before: its motion vectors lead there */
    bool still;      /* neither camera nor scene have changed since */
    noc_isa isa;     /* that was asked for */
    frame_camera camera;
    noc_scene_versions seen;
} noc_last_frame;

struct noc_view {
    noc_device *device;
    noc_world *world;
    const noc_scene *scene;
    noc_log *log;
    const noc_backend *backend;
    void *state; /* the backend's */
    noc_history history;
    int width, height, sets; /* of the backend's buffers; 0: none */
    noc_frame_stats stats;
    double began_wall, began_cpu; /* s, of the last frame */
    noc_last_frame last;
};

/* A frame of the light at these places, width times height of them by params, row by row, in place of what a camera
 * sees: noc_view_render else. */
noc_status noc_view_receive(noc_view *view, const noc_receiver *receivers, const noc_render_params *params,
                            const noc_progress *progress);

/* The last complete frame alone. */
void noc_view_rows(noc_view *view, const noc_frame_rows *rows);

#endif
