/* backend: what a device must be able to do to render. view.c validates, keeps history and decides what is run in
 * which order (frame.c); a backend only executes, so that methods, history and views are the same on every device. */
#ifndef NOC_BACKEND_H
#define NOC_BACKEND_H

#include "core/frame.h"
#include "render/plan.h"
#include "scene/scene.h"
#include <nocturne/render.h>

/* A point that light is to be found for, and the way it faces. What a camera sees makes receivers, too (core/receiver.h
 * is a receiver as passes have it); points may as well be given, as of a grid that is measured on. */
typedef struct noc_receiver {
    float p[3], n[3];  /* local metres; unit */
    uint32_t material; /* whose reflectance the result is seen by; NO_SURFACE: here is none */
} noc_receiver;

/* One frame. Nothing in it changes while the frame is run. */
typedef struct noc_frame {
    const noc_render_params *params;
    const noc_plan *plan;
    const noc_receiver *receivers; /* one a pixel, row by row; NULL: what the camera sees */
    uint32_t epoch;                /* counts resets: what was learned in another one is forgotten */
    frame_constants constants;     /* what kernels and shaders read of it */
    uint64_t accumulated;          /* frames in the mean so far; 0 starts it anew */
    bool seen_before; /* constants.previous is the camera of the complete frame before, in pixels of this size */
    bool history;     /* the frame before is of the same size and parameters: its reservoirs can be reused */
    int history_set;  /* set that holds the previous frame's reservoirs */
    int gbuffer, previous_gbuffer; /* 0 or 1: this frame's, and the previous frame's; the same where it is kept */
} noc_frame;

/* What estimates apart from frames are made with (render/influence.c), while the scene is held for a frame. */
typedef struct noc_asking {
    noc_pool *pool;
    const struct noc_tree *tree;           /* NULL: not asked for */
    const struct noc_map_light *map_light; /* NULL: the scene's map does not light */
    float ray_offset;                      /* least, of shadow rays, m */
} noc_asking;

/* A segment that something may be in the way of. */
typedef struct noc_sight {
    float o[3], d[3]; /* its beginning, and from there to its end */
    uint32_t light;   /* that it leads to: any number will do, equal ones are traced together */
} noc_sight;

/* The last complete frame alone, and what it saw: planes of the picture's width * height numbers, rows from the top.
 * Vectors may be NULL; of those that are not, rgb and motion need a frame that kept NOC_AOV_MOTION. */
typedef struct noc_frame_rows {
    float *rgb[3];
    float *reflects[3]; /* of a surface: albedo and what gloss mirrors at least; light over it has no texture */
    float *normal[3];   /* unit; 0: there is no surface */
    float *depth;       /* along the view, m; 0: there is no surface */
    float *motion[3];   /* as NOC_AOV_MOTION */
    uint32_t *what;     /* a noc_row_kind, NOC_ROW_ALPHA, and between them what instance and material come to */
} noc_frame_rows;

typedef enum noc_row_kind { NOC_ROW_NOTHING, NOC_ROW_EMITTER, NOC_ROW_SURFACE, NOC_ROW_KINDS = 3 } noc_row_kind;
#define NOC_ROW_ALPHA 26  /* from this bit on: how wide a surface's gloss is, GGX alpha times NOC_ROW_MATTE - 1; */
#define NOC_ROW_MATTE 63u /* it has none */

struct noc_influence;
typedef struct noc_backend {
    /* Fills the first `capacity` devices but for backend and number, and returns how many there are, at least 1:
     * without any, one without a name whose `why` says why. NULL: the processor is the only one. */
    size_t (*devices)(noc_device_info *devices, size_t capacity);
    /* Each of these sets its last argument on success only, and reports its errors. `number` is one that `devices` gave
     * a usable device. */
    noc_status (*device_create)(const noc_device_params *params, int number, noc_log *log, void **device);
    void (*device_destroy)(void *device);
    /* A scene on the device: builds the ray tracing structure. Any number of views, from several threads, share it. */
    noc_status (*world_create)(void *device, const noc_scene *scene, void **world);
    void (*world_destroy)(void *world);
    /* What follows is of a view; one thread at a time uses it. */
    noc_status (*view_create)(void *world, void **view);
    void (*view_destroy)(void *view);
    /* What a picture takes of the machine's memory, to be held against it before anything is allocated. */
    size_t (*bytes_a_pixel)(int reservoir_sets, uint32_t aovs);
    /* Buffers for pictures of this size, with so many reservoir sets. What was held is lost where the size changes, and
     * when this fails; more sets for the same size leave it as it is. */
    noc_status (*resize)(void *view, int width, int height, int reservoir_sets);
    /* progress may be NULL; from..to is the stage's share of the frame. Any error leaves the picture as it was. */
    noc_status (*stage)(void *view, const noc_frame *frame, const noc_stage *stage, const noc_progress *progress,
                        double from, double to);
    /* Adds the frame to the picture: into the mean, or in its place when frame->accumulated is 0. NOC_ERR_MEMORY leaves
     * it as it was. */
    noc_status (*accumulate)(void *view, const noc_frame *frame);
    /* Picture, emitter mask (1 where the pixel itself sees an emitter in a frame of the mean) and coverage. */
    noc_status (*read)(void *view, noc_image *image);
    /* A view that the last accumulated frame kept into value, a number a pixel (-1: none), normals three (0: none).
     * NOC_ERR_ARGUMENT, which the caller reports: it kept none. */
    noc_status (*aov)(void *view, noc_aov aov, float *value);
    /* Returns true if the device was lost. *frames: in the mean that `read` gives from now on; 0: it gives none. NULL:
     * the device cannot be lost. */
    bool (*lost)(void *view, uint64_t *frames);
    void (*rows)(void *view, const frame_camera *camera, const noc_frame_rows *rows); /* camera: of that frame */
    /* Calls fn for each item by the device's threads, as noc_pool_run does. */
    void (*run)(void *device, size_t items, void (*fn)(void *ctx, size_t item, int worker), void *ctx);
    /* Adds up into stats: pass_seconds, rays, dropped, all since the last call; sets build_seconds, memory,
     * path and, where shaders are compiled, what that took. */
    void (*stats)(void *view, noc_frame_stats *stats);
    /* Waits until the last frame is finished; returns true if it was not yet. NULL: frames are when they return. */
    bool (*finish)(void *view);
    /* Of the structure that the last frame drew candidates from, though other views' frames may have followed. */
    void (*light_stats)(void *view, noc_light_stats *stats);
    /* Influence volumes for these parameters, whatever they draw from; the backend's own, until the next call of any.
     */
    noc_status (*influence)(void *view, const noc_render_params *params, const struct noc_influence **volumes);
    /* Nearest hits of rays that are in order, in the scene as it is: noc_view_cast. */
    noc_status (*cast)(void *view, const noc_ray *rays, size_t count, noc_hit *hits);
    /* tree: lights are drawn from one. */
    noc_status (*ask)(void *view, const noc_render_params *params, bool tree, noc_asking *out);
    /* Of each how much arrives, 0 where something is in the way, in the scene as `ask` has found it. Any number of
     * threads may call it. */
    void (*clear)(void *view, const noc_sight *sights, size_t count, float *clear);
    /* Rays of the stages run between record(true) and record(false) are kept; replay traces them and nothing else, and
     * forgets them. floor is NULL: it only forgets them. progress may be NULL. */
    void (*record)(void *view, bool on);
    noc_status (*replay)(void *view, const noc_progress *progress, noc_trace_floor *floor);
} noc_backend;

extern const noc_backend noc_backend_embree, noc_backend_vulkan;

/* devices.c */
/* The backend of this build; NULL: it has none. */
const noc_backend *noc_backend_of(noc_backend_id id);
/* The device of a backend's list that `wanted` means, as noc_device_params.device does. What is wrong is reported. */
noc_status noc_choose_device(const noc_device_info *list, size_t count, const char *wanted, noc_device_info *info,
                             noc_log *log);
/* NULL: no GPU of the list is usable. */
const noc_device_info *noc_best_gpu(const noc_device_info *list, size_t count);

/* frame.c */
/* Everything of a camera that can be wrong, as one reported error. */
noc_status noc_check_camera(const noc_camera *camera, noc_log *log);
void noc_make_frame_camera(const noc_camera *camera, const noc_render_params *params, uint32_t frame,
                           frame_camera *out);
/* The constants of a frame of these parameters, but for its cameras. history: as in noc_frame. */
void noc_make_frame_constants(const noc_render_params *params, uint32_t frame, bool history, frame_constants *out);

/* Those of them that are of the scene's map, where it has one. */
void noc_make_frame_environment(const noc_scene *scene, const noc_render_params *params, frame_constants *out);

/* hit.c */
/* What a ray met: a triangle of the scene (NO_INSTANCE: of the world), at these barycentric coordinates of its second
 * and third corner. */
typedef struct noc_met {
    uint32_t triangle, instance;
    float u, v;
} noc_met;
double noc_ray_length(const noc_ray *ray); /* of its direction */
void noc_describe_hit(const noc_scene *scene, const noc_ray *ray, const noc_met *met, noc_hit *out);

/* isa.c */
#define NOC_ISA_VARIABLE "NOCTURNE_ISA"
/* What auto stands for here, or the level asked for; reports one that is unknown or not of this processor, from the
 * environment too, and leaves *chosen as it is. */
noc_status noc_choose_isa(noc_isa asked, noc_isa *chosen, noc_log *log);
/* The one of kernels over rows, where a frame has run with it. */
noc_isa noc_rows_isa(noc_isa asked);

/* aov.c */
/* Can these views be had of these parameters? What cannot is reported. */
noc_status noc_check_aovs(const noc_render_params *params, noc_log *log);
int noc_aov_components(noc_aov aov); /* of a pixel: 1, or 3 */
/* Name, unit, title and scale. */
void noc_describe_aov(const noc_render_params *params, noc_aov aov, noc_channel *channel);

/* history.c: what may be carried from frame to frame. */
typedef struct noc_history {
    uint32_t epoch;
    bool started;  /* params and camera are those of an earlier frame */
    bool viewed;   /* view is the camera of a complete frame */
    bool reusable; /* that frame was completed, and its reservoirs are there */
    bool surfaces; /* the G-buffer is there that view saw, of the scene after `seen` commits */
    noc_render_params params;
    noc_camera camera;
    frame_camera view;
    uint32_t index; /* of the next frame */
    uint64_t accumulated;
    uint64_t commits; /* of the scene, that the frame knew */
    uint64_t seen;
    int set, gbuffer;
} noc_history;

void noc_history_reset(noc_history *history);
void noc_history_forget(noc_history *history, unsigned resets); /* noc_resets */
/* Describes the next frame; forgets what this camera, these parameters and edits of the scene (commits: its versions')
 * make useless. */
void noc_history_begin(noc_history *history, const noc_camera *camera, const noc_render_params *params,
                       uint64_t commits, noc_frame *frame);
/* The frame was completed, or dropped, in its first stage or later. */
void noc_history_end(noc_history *history, const noc_frame *frame, int next_set);
void noc_history_drop(noc_history *history, const noc_frame *frame, bool first_stage);

#endif
