/* nocturne/render.h: direct light of a committed scene, by the methods of docs/estimator.md. */
#ifndef NOCTURNE_RENDER_H
#define NOCTURNE_RENDER_H

#include <nocturne/image.h>
#include <nocturne/scene.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum noc_method {
    NOC_METHOD_REFERENCE,
    NOC_METHOD_IS,
    NOC_METHOD_RIS,
    NOC_METHOD_RESTIR,
    /* No light of the scene: what a lamp at the eye would show, to find one's way by. It asks for no light and no
     * shadow ray, so nothing of the lights is built for it. Numbers of it are no photometry */
    NOC_METHOD_HEADLIGHT,
    NOC_METHOD_COUNT
} noc_method;
/* Weights of a combination of reservoirs: docs/estimator.md, "Reservoirs and reuse". */
typedef enum noc_bias {
    NOC_BIAS_BIASED,   /* 1 / M: Bitterli 2020, Algorithm 4 */
    NOC_BIAS_MIS,      /* balance heuristic */
    NOC_BIAS_PAIRWISE, /* balance heuristic between the pixel's own reservoir and one other at a time */
    NOC_BIAS_COUNTED,  /* 1 / Z, M counted over those that could have made the sample: Bitterli 2020, Algorithm 6 */
    NOC_BIAS_COUNT
} noc_bias;
/* Where light candidates come from: docs/estimator.md, "Pickers". */
typedef enum noc_candidates {
    NOC_CANDIDATES_UNIFORM,
    NOC_CANDIDATES_LISTS,
    NOC_CANDIDATES_POWER,
    NOC_CANDIDATES_INFLUENCE,
    NOC_CANDIDATES_LIGHT_BVH,
    NOC_CANDIDATES_COUNT
} noc_candidates;
/* influence: what bounds a light's influence volume: distance, or what its light reaches as well. */
typedef enum noc_influence_boxes { NOC_INFLUENCE_SPHERE, NOC_INFLUENCE_VISIBLE } noc_influence_boxes;
/* Code that computes what is between rays. All of them give the same bits. */
typedef enum noc_isa {
    NOC_ISA_AUTO,     /* what the environment variable NOCTURNE_ISA names, else the widest that this processor has */
    NOC_ISA_SCALAR,   /* a pixel at a time */
    NOC_ISA_BASELINE, /* 4 at a time, in what every processor of the architecture has (SSE2, NEON) */
    NOC_ISA_AVX2,     /* 8 */
    NOC_ISA_AVX512,   /* 16 */
    NOC_ISA_COUNT
} noc_isa;
NOC_API const char *noc_isa_name(noc_isa isa); /* "avx2" */
NOC_API bool noc_isa_runs(noc_isa isa);        /* on this processor */

/* How a light got its place. */
typedef enum noc_placed {
    NOC_PLACED_OTHER,    /* no lamp: windows, what shines by its material, what moves */
    NOC_PLACED_MAPPED,   /* a lamp of the data */
    NOC_PLACED_INFERRED, /* a lamp that a rule has placed */
    NOC_PLACED_COUNT
} noc_placed;

/* Views of how lights were sampled, and of the surfaces that are seen: docs/views.md. The reservoir is the one that the
 * frame shaded. */
typedef enum noc_aov {
    /* lights that the query found: influence: volumes that hold the point; lists: entries of the tile's list */
    NOC_AOV_LIGHTS,
    /* of the light that this frame's candidates chose: how many of a pixel's M draws fall on it on average, M times its
     * probability; of a tile's list how often it is in it, 1 for lights that always are */
    NOC_AOV_DENSITY,
    NOC_AOV_LIGHT,      /* the reservoir's light: its index in the scene, exact below 2^24 */
    NOC_AOV_WEIGHT,     /* the reservoir's W: 1 / (density of its sample), 0 where it holds none */
    NOC_AOV_CONFIDENCE, /* the reservoir's M, candidates */
    NOC_AOV_RAYS,       /* shadow rays traced for the pixel in the last frame, for the sky too */
    /* of the luminance of one frame, (cd/m2)^2, from the frames accumulated since it was asked for */
    NOC_AOV_VARIANCE,
    NOC_AOV_ERROR,  /* relative standard error of their mean: sqrt(variance / frames) / mean */
    NOC_AOV_DEPTH,  /* distance from the eye of what the last frame saw, m */
    NOC_AOV_NORMAL, /* its unit normal on the viewer's side, in the scene's local frame: three components */
    NOC_AOV_CLASS,  /* its noc_class */
    NOC_AOV_OBJECT, /* its object, for noc_scene_object_name; exact below 2^24 */
    /* what brings the most luminance, of the frames accumulated since it was asked for; of an emitter that is seen it
     * is its own. Where a pixel has light of more than eight groups, it is sure of a share that is an eighth above the
     * next */
    NOC_AOV_GROUP,  /* the group of lights: its index, as noc_scene_groups has them; 0: lights of no group */
    NOC_AOV_PLACED, /* how the light got its place: a noc_placed */
    /* Where the surface that is seen was in the complete frame before, by that frame's camera and by where its instance
     * stood then: three components. x, y: from its place in this picture to its place then, in pixels of this picture,
     * to the right and down, exactly 0 where nothing moved; that place may lie outside the picture. z: how far it was
     * from the eye then, along the view, m, above 0. 0 0 0 where it is not known: no surface, no frame before (the
     * first one after a reset), behind that camera, or on an instance that was not there. A change of the picture's
     * size alone is no motion: then both places are in pixels of the new size. Sub-pixel positions are no motion */
    NOC_AOV_MOTION,
    NOC_AOV_LUMINANCE, /* of the picture, cd/m2: sky and emitters, too */
    /* of the surfaces that a pixel sees, lx: light that arrives straight from lights and the sky, whatever is reflected
     * of it. The mean over the frames accumulated since it was asked for, of those that saw a surface. None for
     * emitters, and for surfaces that reflect nothing of some light's colour (black ones): no ray is sent there */
    NOC_AOV_ILLUMINANCE,
    /* What brings the most luminance, and the second most, of the frames accumulated since one of these four was asked
     * for: the first light of a noc_emitter (nocturne/influence.h), for noc_scene_get_light; exact below 2^24. Of an
     * emitter that is seen it is its own. And the share of each of all the pixel's light from lights and the sky, 0..1.
     * A pixel has room for NOC_AOV_EMITTERS of them: what brings more than one part in so many has a place, and a share
     * is never too small, and at most that part too large, but for the estimator's noise */
    NOC_AOV_INFLUENTIAL,
    NOC_AOV_INFLUENTIAL_SHARE,
    NOC_AOV_RUNNER_UP,
    NOC_AOV_RUNNER_UP_SHARE, /* 0 where there is a first and no second */
    /* Expected luminance, cd/m2, estimated without shadow rays: unshadowed luminance of each light in the tile's list,
     * times its visibility in earlier frames (1/2 if unknown), summed. Candidates lists alone. The mean over the frames
     * accumulated since the view was first requested */
    NOC_AOV_EXPECTED,
    NOC_AOV_COUNT
} noc_aov;

#define NOC_AOV_EMITTERS 16

typedef struct noc_render_params {
    int width, height; /* 1..NOC_IMAGE_MAX_SIDE */
    noc_method method;
    noc_candidates candidates; /* ris, restir: source of the light candidates */
    int draws;                 /* M: candidates a pixel and frame, 1..1024 */
    int list, tail;            /* lists: strongest lights of a tile, 0..128; draws from all others, 1..128 */
    /* lists: shadow rays that a pixel is to send in a frame, 1..8. It sends from 1 to twice as many, by how much of the
     * light around it is expected to arrive */
    int shadow_rays;
    bool learn; /* lists: visibility found in earlier frames says where rays are sent */
    /* influence: S_r, the distance at which a light of 1 cd is last found, m; 0 = found for the scene;
     * points then list the strongest lights within it */
    double influence;
    noc_influence_boxes influence_boxes;
    int influence_cluster; /* influence: at most so many lights that lie close together share a volume, 1..64 */
    int uniform_every;     /* influence: of so many draws one is from all lights, 1..1024 */
    int rays;              /* reference: shadow rays a pixel and frame, 1..1024 */
    /* reuse (restir only) */
    bool temporal, spatial;
    int neighbours; /* k, 0..20 */
    double radius;  /* pixels, 1..64 */
    int passes;     /* spatial passes, 1..4 */
    double history; /* cap of M as a multiple of a frame's candidates, 0..1000 */
    noc_bias bias;
    /* mis, pairwise, counted: visibility in the target of the combination, which makes it unbiased. Not
     * needed, and not traced, without visibility_reuse: targets are unshadowed then */
    bool bias_rays;
    bool visibility_reuse; /* one shadow ray after the candidates: occluded ones are not reused (ris, restir) */
    bool final_ray;        /* shadow ray to the chosen light; off = unshadowed: no shadow rays at all */
    double reject_depth;   /* relative distance to a neighbour's plane that rejects it */
    double reject_normal;  /* cosine between normals that rejects it */
    /* picture */
    uint32_t seed;
    bool jitter;     /* sub-pixel positions change from frame to frame */
    bool accumulate; /* running mean over frames, else the last frame alone */
    double sky;      /* luminance of the sky at the zenith, cd/m2; 0 = off. Default: 18.8 mag/arcsec2 */
    bool emitters;   /* emitters seen directly are shown */
    bool gloss;      /* surfaces mirror, too; off: they reflect diffusely alone, and light is sampled for that */
    /* Of the map around the scene (noc_scene_set_environment), where it has one; it is the background then. A change of
     * them builds nothing anew. */
    double environment_scale;    /* cd/m2 for 1 in the map; default 1 */
    double environment_lux;      /* lx: what the map is to light an open horizontal surface with, before that scale; 0,
                                    the default: its numbers are taken as they are */
    double environment_rotation; /* degrees: bearing of the map's middle, clockwise from north (y); default 0 */
    bool environment_light;      /* it lights the scene, in place of sky; default false */
    /* instruction set; one that the processor lacks is NOC_ERR_UNSUPPORTED. Embree's own code for
     * rays is chosen by Embree */
    noc_isa isa;
    /* views to keep, bits 1 << noc_aov. They never change the picture, and may be asked for and
     * dropped from frame to frame: history and accumulation go on */
    uint32_t aovs;
} noc_render_params;

#define NOC_RENDER_DEFAULTS(set)                                                                                       \
    set(width, 1280) set(height, 720) set(method, NOC_METHOD_RIS) set(candidates, NOC_CANDIDATES_LISTS) set(draws, 32) \
        set(list, 64) set(tail, 128) set(shadow_rays, 8) set(learn, true) set(influence_cluster, 1)                    \
            set(uniform_every, 4) set(rays, 64) set(temporal, true) set(spatial, true) set(neighbours, 5)              \
                set(radius, 10) set(passes, 1) set(history, 20) set(bias, NOC_BIAS_PAIRWISE) set(bias_rays, true)      \
                    set(visibility_reuse, true) set(final_ray, true) set(reject_depth, 0.1) set(reject_normal, 0.9)    \
                        set(seed, 1) set(jitter, true) set(accumulate, true) set(sky, 0.0032) set(emitters, true)      \
                            set(gloss, true) set(environment_scale, 1) set(isa, NOC_ISA_AUTO)
#ifdef __cplusplus
NOC_DEFAULT_PARAMS(noc_render_params, noc_render_default_params, NOC_RENDER_DEFAULTS)
#else
#define noc_render_default_params() ((noc_render_params){ NOC_RENDER_DEFAULTS(NOC_DEFAULT_IN_C) })
#endif

/* The sky's brightness as a sky quality meter tells it [mag/arcsec2], of its luminance [cd/m2]: L = 108,000 * 10^(-0.4
 * m). noc_sky_sqm returns NaN for a luminance of 0. */
NOC_API double noc_sky_luminance(double sqm);
NOC_API double noc_sky_sqm(double luminance);
/* Fills *luminance [cd/m2] from "sqm:18.8" (14 to 25 mag/arcsec2) or "bortle:7" (1 to 9: docs/defaults.md). Returns
 * NULL, or what is wrong with the text: "is not ...". */
NOC_API const char *noc_sky_read(const char *text, double *luminance);

/* Settings for a purpose, chosen by measurement (docs/measurements.md, "Presets"). */
typedef enum noc_preset {
    NOC_PRESET_STILL,       /* the defaults: ris over lists of 64 + 128, 8 rays. Least error after a minute */
    NOC_PRESET_INTERACTIVE, /* the same over lists of 32 + 64: frames take about a tenth less time, and are noisier. For
                               first pictures and a camera that is moved by hand */
    NOC_PRESET_QUICK        /* as still, 4 rays: for a picture of few frames that is smoothed (nocturne/smooth.h) */
} noc_preset;

/* Sets all that says how light is estimated and reused; the picture's size, seed, sky and the like stay as they are. */
NOC_API void noc_render_use_preset(noc_render_params *params, noc_preset preset);

/* A device is what renders: threads, memory, a ray tracer. All scenes and views of a process may share one. */
typedef struct noc_device noc_device;

/* The code of a frame, and the kind of device that it is for. All backends share the estimators (src/core); pictures
 * differ where rays graze. */
typedef enum noc_backend_id {
    NOC_BACKEND_EMBREE, /* the processor; rays by Embree */
    NOC_BACKEND_VULKAN, /* a device with Vulkan ray tracing */
    NOC_BACKEND_AUTO,   /* vulkan if a GPU with hardware ray tracing is usable, else embree */
    NOC_BACKEND_COUNT
} noc_backend_id;
NOC_API const char *noc_backend_name(noc_backend_id backend); /* "embree" */

typedef enum noc_device_kind {
    NOC_DEVICE_PROCESSOR,  /* the only device of embree */
    NOC_DEVICE_SOFTWARE,   /* a Vulkan driver that runs on the processor */
    NOC_DEVICE_OTHER,      /* a GPU of unknown kind */
    NOC_DEVICE_VIRTUAL,    /* a GPU of a virtual machine's host */
    NOC_DEVICE_INTEGRATED, /* a GPU that shares the processor's memory */
    NOC_DEVICE_DISCRETE,   /* a GPU with memory of its own */
    NOC_DEVICE_KIND_COUNT
} noc_device_kind;
NOC_API const char *noc_device_kind_name(noc_device_kind kind); /* "discrete" */

typedef struct noc_device_info {
    noc_backend_id backend; /* never auto */
    int number;             /* among the devices of its backend, from 0; -1: the backend has none, and `why` says why */
    noc_device_kind kind;
    char name[256];   /* "NVIDIA GeForce RTX 3060" */
    char driver[128]; /* "NVIDIA 550.54"; "": none, or unknown */
    bool usable;
    char why[256]; /* why it is not usable; "": it is */
} noc_device_info;

/* Fills the first `capacity` of the devices of all backends, and returns how many there are. Drivers are loaded for it,
 * which takes some 50 ms. */
NOC_API size_t noc_devices(noc_device_info *devices, size_t capacity);

typedef struct noc_device_params {
    int threads; /* of the processor; 0: one a core that the process may run on */
    noc_backend_id backend;
    /* vulkan: its number, its name, or a part that no other usable device has in its name, case ignored; NULL: discrete
     * GPUs first, software last */
    const char *device;
} noc_device_params;

#define NOC_DEVICE_DEFAULTS(set) set(threads, 0) set(backend, NOC_BACKEND_EMBREE)
#ifdef __cplusplus
NOC_DEFAULT_PARAMS(noc_device_params, noc_device_default_params, NOC_DEVICE_DEFAULTS)
#else
#define noc_device_default_params() ((noc_device_params){ NOC_DEVICE_DEFAULTS(NOC_DEFAULT_IN_C) })
#endif

/* Sets *info to the device that noc_device_create would open. NOC_ERR_ARGUMENT after reporting that there is no such
 * device, NOC_ERR_UNSUPPORTED after reporting why it is not usable. NULL params are the defaults. */
NOC_API noc_status noc_device_find(const noc_device_params *params, noc_device_info *info, noc_log *log);
/* NULL params are the defaults; NULL after reporting an error. The device keeps the log, which must outlive it and is
 * told of all that goes wrong in its views. */
NOC_API noc_device *noc_device_create(const noc_device_params *params, noc_log *log);
NOC_API const noc_device_info *noc_device_get_info(const noc_device *device); /* the device's; NULL of NULL */
/* After all of its views. */
NOC_API void noc_device_destroy(noc_device *device);

/* A view is one picture of a scene: its size, camera, options, history and accumulation. Any number of views may look
 * at one scene: they share the ray tracing structure and what lights are drawn from, which are built for the first view
 * of a scene on a device and go with the last.
 *
 * Threads. Views are independent: each may render in a thread of its own at the same time, and the device's threads
 * serve them all. One view belongs to one thread at a time: while noc_view_render or noc_view_trace_floor runs, no
 * other call may be made on it, neither from another thread nor from the progress callback, which comes from the thread
 * that made the call. What only reads the scene (noc_scene_get_info, get_light, object_name, ground, camera, to_local,
 * from_local) may be called at any time from any thread, also during a frame and in callbacks. What edits the scene may
 * be called during a frame, too, by one thread at a time: it only stages (nocturne/scene.h). noc_scene_commit waits for
 * the frames that are being rendered, so it must not be called from their callbacks. noc_image and noc_channel are the
 * caller's: any thread may use them once the call that made them has returned. The log's callback may come from any
 * thread. */
typedef struct noc_view noc_view;

/* The scene must be committed and outlive the view, as must the device. NULL after reporting an error. */
NOC_API noc_view *noc_view_create(noc_device *device, const noc_scene *scene);
NOC_API void noc_view_destroy(noc_view *view);
NOC_API noc_device *noc_view_device(const noc_view *view); /* that it was created on */

/* Everything about params that noc_view_render would refuse, as one reported error: to be asked before long work. */
NOC_API noc_status noc_render_check(const noc_render_params *params, noc_log *log);

/* Renders one frame; NULL params are the defaults. What is forgotten where params differ from those of the frame before
 * is a column of the option table (noc_option.resets); accumulation starts anew when the camera or a light moves, too,
 * and history goes on. progress may be NULL; when it cancels, the frame is dropped, what was accumulated stays (of the
 * camera and parameters that it was made with, so nothing where those have changed), and NOC_ERR_CANCELLED is returned.
 * So it is with NOC_ERR_MEMORY; where there was none for the picture's buffers, the picture starts anew. Either way the
 * next frame may succeed. After NOC_ERR_LOST none does: what stays is the picture as it was read last, by
 * noc_view_image or every ten seconds by the view itself, and noc_frame_stats.frames is the number of its frames, 0 for
 * none. */
NOC_API noc_status noc_view_render(noc_view *view, const noc_camera *camera, const noc_render_params *params,
                                   const noc_progress *progress);
/* Forgets history and accumulation, the frame number, and what was learned of the lights' visibility. */
NOC_API void noc_view_reset(noc_view *view);
/* Begins the mean anew with the next frame, as for the next picture of an animation whose camera rests. History, and
 * what was learned, go on. */
NOC_API void noc_view_restart(noc_view *view);

/* Copy of the picture so far (accumulated or last frame), with its emitter mask. NULL before the first frame, and after
 * reporting an error. */
NOC_API noc_image *noc_view_image(noc_view *view);

/* What rays meet first in the scene as of the last commit, for who picks, measures or walks: hits[i] is that of
 * rays[i]. Like all that is a call on a view it belongs to the view's thread, and may come before the first frame. It
 * takes nothing of the view's picture, history or what was learned. Up to 256 rays are traced by the thread that calls,
 * which waits for no frame of another view; more are shared out among the device's threads. Who asks beside a frame
 * that is being rendered makes a view for it, which without a picture takes little. A commit waits for it as for a
 * frame, so it must not be called from a frame's progress. The first one after an edit of geometry or instances has the
 * ray tracing structure follow, as the next frame would. NOC_ERR_ARGUMENT after reporting a ray without direction or
 * place: no hit is set. NOC_ERR_MEMORY: so, too. */
NOC_API noc_status noc_view_cast(noc_view *view, const noc_ray *rays, size_t count, noc_hit *hits);
/* The ground at those places, local metres, as it is seen from above: the surface there of one of these classes
 * (1u << noc_class each), through trees, lamps and the like, but not through buildings. Without one, hits[i].hit is
 * false; so it is where something stands on the ground (it is inside of a body) or covers it lower than 2.5 m over it,
 * as a car does, or is steeper than 60 degrees. Where only what stands or lies there forbids it, the hit's material is
 * that of the ground (else -1), and its place is the ground's. Otherwise as noc_view_cast. */
NOC_API noc_status noc_view_cast_down(noc_view *view, const double (*xy)[2], size_t count, uint32_t classes,
                                      noc_hit *hits);

NOC_API const char *noc_aov_name(noc_aov aov); /* "lights" */
/* What a view's numbers are, as noc_channel has it. NOC_CHANNEL_LABELS have neither bar nor range. */
typedef struct noc_aov_info {
    const char *name, *unit;
    const char *title; /* Latin-1 */
    noc_channel_scale scale;
    int components;
} noc_aov_info;
/* All 0 and "" where there is no such view. */
NOC_API noc_aov_info noc_aov_get_info(noc_aov aov);
/* Copy of a view that the last complete frame kept. -1 where a pixel has none: no surface, an emitter seen directly, no
 * light chosen, fewer than two frames. NULL after reporting an error, and before the first frame. */
NOC_API noc_channel *noc_view_aov(noc_view *view, noc_aov aov);

/* What a frame is made of, in order; which of them run depends on the parameters. */
typedef enum noc_pass {
    NOC_PASS_PRIMARY,     /* what each pixel sees */
    NOC_PASS_FIND_LIGHTS, /* influence: the lights around the points of a tile */
    NOC_PASS_BUILD_LIST,  /* lists: the strongest lights of a tile, and draws from the others */
    NOC_PASS_CANDIDATES_UNIFORM,
    NOC_PASS_CANDIDATES_LIST,
    NOC_PASS_CANDIDATES_POWER,
    NOC_PASS_CANDIDATES_INFLUENCE,
    NOC_PASS_CANDIDATES_LIGHT_BVH,
    NOC_PASS_SEEN_BEFORE,  /* which pixels have earlier frames behind them: others get more rays */
    NOC_PASS_SHARE_RAYS,   /* lists: which entries a pixel's shadow rays go to */
    NOC_PASS_VISIBILITY,   /* a shadow ray to each pixel's sample */
    NOC_PASS_TRACE_SHARED, /* the shared rays */
    NOC_PASS_RESAMPLE,     /* one of a pixel's shared rays becomes its reservoir */
    NOC_PASS_TEMPORAL,
    NOC_PASS_SPATIAL,
    NOC_PASS_EMITTERS, /* that are seen directly */
    NOC_PASS_SHADE_SHARED,
    NOC_PASS_SHADE,
    NOC_PASS_SHADE_ALL, /* reference */
    NOC_PASS_HEADLIGHT,
    NOC_PASS_SKY,
    NOC_PASS_COUNT
} noc_pass;

NOC_API const char *noc_pass_name(noc_pass pass);

typedef struct noc_frame_stats {
    uint64_t frames;                     /* accumulated so far */
    double wall_seconds;                 /* of the last frame */
    double cpu_seconds;                  /* process CPU time of the last frame */
    double pass_seconds[NOC_PASS_COUNT]; /* by the clock, summed over threads, last frame */
    uint64_t rays_primary, rays_shadow;  /* of the last frame */
    uint64_t dropped;                    /* samples dropped for being NaN or infinite, since the last reset */
    double build_seconds;                /* of the ray tracing structure */
    /* shaders that were compiled for the device, by the clock and on the processor; the frames that first needed them
     * waited, and have that in their seconds */
    double compile_seconds, compile_cpu_seconds;
    size_t memory_bytes;    /* of the view and of what it shares, without the scene */
    size_t picture_bytes;   /* of these: what each pixel takes, in the view's buffers and views (aovs) */
    size_t structure_bytes; /* of these: the ray tracing structure */
    size_t learned_bytes;   /* of these: what the view has learned of the lights' visibility */
    const char *path;       /* instruction set and lanes: "scalar", "avx2 x8", "avx512 x16", ... */
} noc_frame_stats;

/* Waits for the last frame where it is still being made (Vulkan has two in flight); else figures are those of the last
 * one that was finished. The view's thread calls it. */
NOC_API void noc_view_get_stats(noc_view *view, noc_frame_stats *stats);

/* The structure that the last frame's light candidates were drawn from. What does not apply to it is 0. */
typedef struct noc_light_stats {
    noc_candidates candidates; /* of the last frame */
    size_t lights;             /* of the scene */
    double build_seconds;      /* wall seconds that the structure took to build */
    size_t bytes;              /* that it holds */
    /* what that is to be compared with: the scene's geometry, materials and lights, and
     * the ray tracing structure */
    size_t scene_bytes;
    double influence; /* influence: S_r, m */
    size_t volumes;   /* influence: influence volumes; fewer than lights where lights share them */
    /* influence: what build_seconds went into: volumes and their order; S_r, where none was set; the hierarchy;
     * visibility-aware boxes */
    double volumes_seconds, tuning_seconds, hierarchy_seconds, boxes_seconds;
    /* influence: pixels of the last frame that saw a surface, and so asked for lights */
    uint64_t surfaces;
    double found_none; /* influence: share of them that no volume held */
    /* influence: lights that they found: median and 99th percentile; 65,536 stands for more too */
    uint32_t found_median, found_99;
} noc_light_stats;

/* All 0 but lights and scene_bytes before the first frame, and for methods that draw no candidates. */
NOC_API void noc_view_light_stats(const noc_view *view, noc_light_stats *stats);

/* Writes the influence volumes that these parameters ask for (influence, influence_boxes, influence_cluster; NULL: the
 * defaults), whatever the candidates are, as OBJ to look at: metres in the scene's local frame, y up as most programs
 * take it (x, y, z of the scene are written as x z -y). Each volume is an object, a sphere or the part of one that
 * one-sided lights face, its corners on the surface, its name that of its first light; visibility-aware boxes follow,
 * and names tell which volume lies in which. The target is replaced when the file is whole. About 6 kB a volume. Not
 * during a frame. */
NOC_API noc_status noc_view_write_influence(noc_view *view, const noc_render_params *params, const char *path);

/* What the rays of a frame take by themselves. */
typedef struct noc_trace_floor {
    double wall_seconds;
    double cpu_seconds; /* of the process */
} noc_trace_floor;

/* The trace floor: renders the next frame as noc_view_render does, keeps its rays (primary, visibility, bias, final,
 * and sky where it is on, and the same through surfaces that let light through), then traces those rays again through
 * the same structure and nothing else. What the second time takes goes into *floor. Takes about 600 bytes for 16 rays
 * while it lasts. progress may be NULL; NOC_ERR_CANCELLED where it breaks either off. */
NOC_API noc_status noc_view_trace_floor(noc_view *view, const noc_camera *camera, const noc_render_params *params,
                                        const noc_progress *progress, noc_trace_floor *floor);

#ifdef __cplusplus
}
#endif
#endif
