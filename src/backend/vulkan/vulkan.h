/* State of the Vulkan backend: a device, the worlds on it (a scene each), and the views of each world.
 *
 * A device has one queue, and one lock that is held from the first stage of a frame to its submission, so commands of
 * views that render at the same time follow each other. Everything is ordered by that queue: uploads and builds are
 * command buffers of their own, submitted before the frame that needs them. */
#ifndef NOC_VULKAN_H
#define NOC_VULKAN_H

#include "backend/parts.h"
#include "backend/vulkan/records.h"
#include "backend/vulkan/schedule.h"
#include "light/set.h"
#include "render/backend.h"
#include "render/frame_views.h"
#include "render/past.h"

#include <pthread.h>
#include <stdatomic.h>
#include <volk.h>

/* ---- memory.c ---- */

/* A buffer with an allocation of its own. bytes 0: there is none. */
typedef struct vk_buffer {
    VkBuffer buffer;
    VkDeviceMemory memory;
    VkDeviceAddress address;
    VkDeviceSize bytes;
    void *mapped; /* NULL: the host does not see it */
} vk_buffer;

/* Where a buffer is allocated. */
typedef enum vk_place {
    VK_PLACE_DEVICE,   /* memory of the device; filled by noc_vk_write */
    VK_PLACE_SHARED,   /* mapped, written by the host, read by the device */
    VK_PLACE_READBACK, /* mapped, written by the device, read by the host */
} vk_place;

/* A command buffer for uploads and builds, with its part of the staging ring. */
typedef struct vk_upload {
    VkCommandBuffer commands;
    VkFence fence;
    VkDeviceSize used;
    bool pending; /* submitted, and the fence not waited for */
} vk_upload;

enum { VK_UPLOADS = 4, VK_UPLOAD_BYTES = 8 << 20 };

/* ---- device.c ---- */

/* A pipeline and, of ray tracing ones, where its shaders are in the binding table. */
typedef struct vk_pipeline {
    VkPipeline pipeline;
    VkStridedDeviceAddressRegionKHR raygen, miss, hit;
} vk_pipeline;

/* Stages that read the push constant, the address of a dispatch's record. */
#define VK_PUSH_STAGES (VK_SHADER_STAGE_COMPUTE_BIT | VK_SHADER_STAGE_RAYGEN_BIT_KHR | VK_SHADER_STAGE_ANY_HIT_BIT_KHR)

/* Specialization constants of all compute shaders, by their numbers; set before pipelines are made. */
typedef struct vk_constants {
    uint32_t list_workers, share_workers; /* invocations of a work group: of a tile's list, of the choice of rays */
    VkBool32 rounds; /* quotients and roots are the device's own: it rounds them as IEEE 754 does */
} vk_constants;

typedef struct vk_device {
    noc_log *log;
    noc_pool *pool;
    VkInstance instance;
    VkDebugUtilsMessengerEXT messenger; /* VK_NULL_HANDLE: validation is off */
    VkPhysicalDevice physical;
    VkDevice device;
    VkQueue queue;
    uint32_t family;
    VkPhysicalDeviceMemoryProperties memory;
    VkDeviceSize largest; /* buffer that it gives */
    bool budgeted;        /* it tells how much memory is free */
    VkPhysicalDeviceRayTracingPipelinePropertiesKHR rays;
    VkPhysicalDeviceAccelerationStructurePropertiesKHR structures;
    char name[VK_MAX_PHYSICAL_DEVICE_NAME_SIZE];
    bool software;      /* a processor plays the device */
    double tick;        /* s, of a timestamp */
    uint64_t tick_mask; /* valid bits of a timestamp; 0: there are none */
    pthread_mutex_t lock;
    bool lost; /* reported */
    VkCommandPool commands;
    vk_buffer staging, readback;
    vk_upload uploads[VK_UPLOADS];
    int upload;     /* the open one, or the next to be opened */
    bool uploading; /* it is open */
    VkDescriptorSetLayout set_layout;
    VkPipelineLayout layout;
    VkPipelineCache cache;
    vk_pipeline pipelines[VK_SHADER_COUNT];
    vk_buffer table;                             /* shader binding table, of all ray tracing pipelines */
    double compile_seconds, compile_cpu_seconds; /* of all pipelines so far */
    vk_constants constants;
    size_t band_bytes;   /* vk_facts */
    uint32_t pool_most;  /* influence: lights that the pool of a band has room for at most */
    double keep_seconds; /* between readings of a mean that nobody asks for */
    size_t bytes;        /* allocated */
    noc_device_params params;
    pthread_mutex_t host_lock;
    void *host; /* the CPU backend's device; NULL: no question was asked yet */
} vk_device;

/* ---- blas.c ---- */

/* A buffer that pieces are cut from. It goes when nobody holds it. */
typedef struct vk_chunk {
    vk_buffer buffer;
    VkDeviceSize used;
    int holders;
} vk_chunk;

typedef struct vk_piece {
    vk_chunk *chunk; /* that it holds; NULL: there is none */
    VkDeviceSize at, bytes;
} vk_piece;

/* Triangles that are built together, and where their numbers in the scene are. */
typedef struct vk_blas {
    VkAccelerationStructureKHR structure;
    VkDeviceAddress address;
    vk_piece store, order;
} vk_blas;

typedef NOC_ARRAY(vk_blas) vk_blas_list;

/* ---- structure.c ---- */

/* Surfaces that block light, and those that let it through: each kind in BLASes of its own. */
typedef enum vk_layer { VK_LAYER_SOLID, VK_LAYER_THROUGH, VK_LAYERS } vk_layer;

typedef struct vk_part {
    noc_part of;
    vk_blas_list blas[VK_LAYERS];
    int holders;
} vk_part;

typedef NOC_ARRAY(vk_part *) vk_parts;

/* What rays are traced against: all parts of the world, and models where instances are. */
typedef struct vk_tlas {
    VkAccelerationStructureKHR structure;
    vk_buffer store;
    VkDescriptorSet set;
    vk_parts held; /* parts that it refers to */
    uint32_t room; /* instances that it has room for */
} vk_tlas;

typedef struct vk_structure {
    vk_parts world;  /* parts of the world in the order of their meshes */
    vk_parts models; /* NULL for those that no instance has shown */
    vk_tlas tlas[2]; /* now and past, by turns */
    int now;
    vk_buffer instances, entries, scratch; /* of the TLAS */
    vk_chunk *open;                        /* for the next small pieces of BLASes; NULL: none yet */
    VkDescriptorPool sets;
    uint64_t geometry, moved;     /* versions of the scene that it knows */
    const noc_progress *progress; /* asked before each part is built; NULL: the caller does not break it off */
} vk_structure;

/* ---- world.c ---- */

/* An array of the scene on the device. */
typedef struct vk_array {
    vk_buffer buffer;
    size_t filled; /* bytes */
} vk_array;

/* What the tables of candidates on the device were made from. */
typedef struct vk_sources_key {
    uint64_t commits, volumes;
    const void *alias, *tree, *map, *clusters[NOC_HALVES];
} vk_sources_key;

typedef struct vk_world {
    vk_device *device;
    const noc_scene *scene;
    noc_log *log;
    vk_structure structure;
    vk_array positions, indices, triangle_material, triangle_light, materials, lights, profiles, texels;
    vk_array triangle_facade, facades, facade_cells;
    vk_array image_places, image_corners; /* textures: of each material; of each vertex */
    vk_array panes;                       /* of each material; none: no surface lets light through */
    vk_array instances, instance_lights, backs;
    vk_array backdrop, environment, environment_slots, environment_sines;
    vk_array alias, tree, clusters, volumes;
    vk_sources_key drawn_from;
    noc_scene_versions seen; /* that the arrays know */
    bool filled;
    noc_placings placings;
    double build_seconds;
    noc_ray_scale scale;
    noc_light_set *lights_set;
    void *host; /* the CPU backend's world; NULL: no question was asked yet */
} vk_world;

/* ---- view.c and frame.c ---- */

enum { VK_FRAMES = 2, VK_STEPS = 192, VK_CONSTANTS_BYTES = 512 };
_Static_assert(sizeof(frame_constants) <= VK_CONSTANTS_BYTES, "constants lie before the records of dispatches");

/* What a frame in flight has for itself. */
typedef struct vk_flight {
    VkCommandBuffer commands;
    VkFence fence;
    VkQueryPool times;
    vk_buffer constants; /* frame_constants, then a vk_binding for each step */
    vk_buffer counts;    /* read back: vk_counts */
    int steps;
    noc_pass timed[VK_STEPS]; /* the pass that ends with each timestamp but the first */
    int times_count;
    noc_frame_stats found; /* pass_seconds and rays so far */
    bool pending;
} vk_flight;

/* Buffers of one picture. */
typedef struct vk_picture {
    int width, height, sets;
    size_t ray_room; /* rays that there is room for */
    uint32_t blocks_x, blocks_y;
    vk_buffer surfaces[2], reservoirs[NOC_RESERVOIR_SETS], visible[NOC_RESERVOIR_SETS];
    vk_buffer colour, picture, coverage;
    vk_buffer rays, answers, hits; /* hits: one a pixel */
    vk_buffer through;             /* transmittance on the way of each ray; none: no surface lets light through */
    vk_buffer instance;            /* that each pixel sees; none: the scene has had none */
    size_t bytes;
} vk_picture;

/* Learned visibility of lights: list_memory.h. The cache outlives the size of the picture. */
typedef struct vk_learning {
    vk_buffer cache, observed, bright;
    uint32_t head[16];                           /* the cache's, while it is moved */
    size_t tiles;                                /* of the picture that the cache has room for */
    uint32_t cells, rows;                        /* of the cache; of observations */
    uint32_t room;                               /* entries of a list */
    bool told;                                   /* that observations had no room */
    uint32_t time, epoch, next_time, next_epoch; /* of the cache; and when the frame at hand is complete */
} vk_learning;

/* Views (noc_aov): what shaders gather for them, and the host's copy of what the last complete frame left. Buffers and
 * arrays are there where a frame has needed them. */
typedef struct vk_views {
    noc_views of;
    uint32_t bits;                     /* VK_VIEW_: gathered by the frame being made */
    vk_buffer gathered[NOC_AOV_COUNT]; /* as of.made */
    vk_buffer triangles, labels;       /* that pixels see; of emitters */
    uint64_t labelled[2];              /* of.labelled, that `labels` is of */
    gblock *g;                         /* [blocks], as are the next ones */
    rblock *r;
    cblock *colour;
    uint32_t (*instance)[BLOCK], (*triangle)[BLOCK];
    uint16_t *emitter; /* lanes that saw one in a frame of the mean */
    noc_past past;     /* as it was while that frame was made */
} vk_views;

/* The mean as the host read it last: what is left of a picture when the device is lost. */
typedef struct vk_mean {
    cblock *colour; /* [blocks], as the next one; NULL: it was not read yet */
    float (*coverage)[BLOCK][4];
    uint64_t frames;  /* in it; 0: it is of an earlier mean, or was not read yet */
    uint64_t version; /* of the device's that it is */
    double read;      /* when, or when the mean began */
} vk_mean;

/* How a frame that takes long is cut into pieces: pace.c. */
typedef struct vk_pace {
    /* Of each pass and shader: s an invocation, 0: not measured; and invocations that are recorded, not submitted. */
    double cost[NOC_PASS_COUNT][VK_SHADER_COUNT], recorded[NOC_PASS_COUNT][VK_SHADER_COUNT];
    double due;                   /* s that what is recorded is expected to take */
    bool on;                      /* the frame at hand is cut */
    const noc_progress *progress; /* of the stage at work; NULL: the caller does not break it off */
    double done;                  /* share of the frame that it is told */
} vk_pace;

/* Rays of a step, kept to be traced again. */
typedef struct vk_kept_rays {
    vk_step step;
    vk_buffer rays, answers;
} vk_kept_rays;

/* Answers the rays of a step in place of the device, for tests: the steps before have run, and what it writes is there
 * for those after. The device is locked. */
typedef struct vk_answerer {
    noc_status (*answer)(void *user, const vk_step *step);
    void *user;
} vk_answerer;

typedef struct vk_view {
    vk_world *world;
    vk_device *device;
    const noc_scene *scene;
    noc_log *log;
    vk_picture b;
    vk_flight flights[VK_FRAMES];
    int flight; /* of the frame being made, or of the next one */
    bool open;  /* a frame is being recorded, and the device is locked */
    vk_hazards hazards;
    vk_buffer samples, scratch, counters, given;
    vk_buffer found;     /* influence: surfaces of the last frame by the number of lights that they found */
    uint32_t found_bins; /* of them */
    vk_learning learning;
    vk_steps steps; /* of the stage at work */
    vk_views views;
    vk_buffer past_lights;
    noc_past past;
    noc_light_sources sources;
    const noc_map_light *map_light;
    bool draws;            /* the last frame drew candidates */
    noc_light_stats drawn; /* from what: what is told of it, but for what the light set knows */
    bool crowded;          /* told that lights had no room */
    uint32_t subsets, subset_rows;
    uint64_t mean_frames, mean_version; /* of the mean on the device */
    vk_mean mean;
    vk_pace pace;
    noc_frame_stats stats; /* of the last finished frame; dropped: of all since it was last asked for */
    bool recording;        /* rays are kept */
    NOC_ARRAY(vk_kept_rays) kept;
    const vk_answerer *answerer; /* NULL: the device traces */
    void *host;                  /* the CPU backend's view; NULL: no question was asked yet */
} vk_view;

/* devices.c */
enum { VK_EXTENSIONS = 3 };
extern const char *const noc_vk_extensions[VK_EXTENSIONS]; /* of devices; every one is needed */

/* Features that are switched on. */
typedef struct vk_features {
    VkPhysicalDeviceRayTracingPipelineFeaturesKHR rays;
    VkPhysicalDeviceAccelerationStructureFeaturesKHR structures;
    VkPhysicalDeviceVulkan12Features v12;
    VkPhysicalDeviceFeatures2 all; /* the head of the chain */
} vk_features;
void noc_vk_chain_features(vk_features *f); /* all off */
bool noc_vk_has_extension(VkPhysicalDevice physical, const char *name);

#define VK_VALIDATION_LAYER "VK_LAYER_KHRONOS_validation"
/* Loads the Vulkan loader and makes an instance, with the validation layer unless `messages` is NULL. Returns why there
 * is none; NULL: it is made. */
const char *noc_vk_make_instance(const VkDebugUtilsMessengerCreateInfoEXT *messages, VkInstance *instance);
VkPhysicalDevice noc_vk_physical_device(VkInstance instance, int number); /* VK_NULL_HANDLE: it is not there */
/* The number of a queue family that computes, and how many bits of its timestamps count. UINT32_MAX: none. */
uint32_t noc_vk_compute_family(VkPhysicalDevice physical, uint32_t *bits);
size_t noc_vk_devices(noc_device_info *devices, size_t capacity);

/* device.c */
/* Reports a result that is no success, once; a lost device once for all that follows. what: "building ...". */
noc_status noc_vk_failed(vk_device *d, VkResult result, const char *what);
/* Locks the device; one that was lost is not locked, and that is reported. */
noc_status noc_vk_enter(vk_device *d) NOC_MUST_USE;
noc_status noc_vk_device_create(const noc_device_params *params, int number, noc_log *log, void **device);
void noc_vk_device_destroy(void *device);

/* memory.c */
/* Makes a buffer of `bytes` > 0 bytes; what is in *b is overwritten. usage: beside storage, transfers and its address.
 * On failure, which is reported with `what`, *b is empty. */
noc_status noc_vk_make_buffer(vk_device *d, VkDeviceSize bytes, VkBufferUsageFlags usage, vk_place place,
                              const char *what, vk_buffer *b);
void noc_vk_free_buffer(vk_device *d, vk_buffer *b); /* an empty one is allowed; no command in flight may use it */
/* Reports what needs more bytes than the device has free, once so many are given back. Of less than 64 MB the driver is
 * the judge: what it tells is an estimate. */
noc_status noc_vk_check_room(vk_device *d, VkDeviceSize bytes, VkDeviceSize given_back, const char *what);
VkDeviceSize noc_vk_free_bytes(const vk_device *d); /* as far as the driver tells */
noc_status noc_vk_memory_create(vk_device *d);
void noc_vk_memory_destroy(vk_device *d);
/* Commands that come after all that was submitted before, and before what is submitted later; the device is locked.
 * *commands is for this call's user until the next call of these four. */
noc_status noc_vk_open_upload(vk_device *d, VkCommandBuffer *commands);
noc_status noc_vk_write(vk_device *d, const vk_buffer *to, VkDeviceSize at, const void *data, size_t bytes);
noc_status noc_vk_submit_upload(vk_device *d); /* nothing is open: nothing happens */
noc_status noc_vk_wait_idle(vk_device *d);     /* submits what is open, too */
/* The same before things are freed, as well as it can be done: what fails is not reported, and for nobody to see. */
void noc_vk_settle(vk_device *d);
/* Waits for all that was submitted, and copies. */
noc_status noc_vk_read(vk_device *d, const vk_buffer *from, VkDeviceSize at, void *data, size_t bytes);
/* Writes of all commands before are seen by all commands after. */
void noc_vk_barrier(VkCommandBuffer commands);

/* pipelines.c */
noc_status noc_vk_pipelines_create(vk_device *d);
void noc_vk_pipelines_destroy(vk_device *d);
/* The pipeline of a shader, made when it is first asked for. */
noc_status noc_vk_pipeline(vk_device *d, vk_shader shader, const vk_pipeline **pipeline);

/* blas.c */
/* Builds a BLAS of so many triangles, whose numbers in the scene it puts in the order of the BLAS, and appends it to
 * the layer's list; on failure what is appended is to be freed, too. */
noc_status noc_vk_build_blas(vk_world *w, vk_layer layer, uint32_t *order, size_t count, vk_blas_list *list);
void noc_vk_free_blas(vk_device *d, vk_blas *b); /* no command in flight may use it */
/* A structure of this type in `bytes` bytes of a buffer, from byte `at` on, a multiple of 256. */
noc_status noc_vk_make_structure(vk_device *d, VkAccelerationStructureTypeKHR type, const vk_buffer *store,
                                 VkDeviceSize at, VkDeviceSize bytes, VkAccelerationStructureKHR *structure,
                                 VkDeviceAddress *address);
VkDeviceAddress noc_vk_piece_address(const vk_piece *p);
void noc_vk_let_go_of_chunk(vk_device *d, vk_chunk *chunk); /* NULL: nothing happens */

/* structure.c */
noc_status noc_vk_structure_create(vk_world *w);
/* Brings the structure to the scene's meshes and instances; it is as it was where this fails. */
noc_status noc_vk_structure_follow(vk_world *w);
void noc_vk_structure_destroy(vk_world *w);
size_t noc_vk_structure_bytes(const vk_world *w);

/* world.c */
noc_status noc_vk_world_create(void *device, const noc_scene *scene, void **world);
void noc_vk_world_destroy(void *world);
/* Brings everything on the device to the scene as it is; the device is locked. progress: NULL, or asked as parts are
 * built, 0 of it done, whether to go on. */
noc_status noc_vk_world_follow(vk_world *w, const noc_progress *progress);
/* Bytes of the scene's geometry, materials and lights, and of the ray tracing structure. */
size_t noc_vk_world_bytes(const vk_world *w);
/* Uploads what the candidates of the sources are drawn from. */
noc_status noc_vk_world_fill_sources(vk_world *w, const noc_light_sources *sources, const noc_map_light *map);

/* view.c */
noc_status noc_vk_view_create(void *world, void **view);
void noc_vk_view_destroy(void *view);
size_t noc_vk_bytes_a_pixel(int sets, uint32_t aovs);
noc_status noc_vk_view_resize(void *view, int width, int height, int sets);
/* Room for so many rays, so much scratch, and for instances where the scene has some. */
noc_status noc_vk_view_fit(vk_view *v, size_t rays, size_t scratch);
/* Makes a buffer of `bytes` at least of an empty or smaller one, whose contents are lost. what: as in
 * noc_vk_make_buffer. */
noc_status noc_vk_fit_buffer(vk_view *v, size_t bytes, const char *what, vk_buffer *b);
/* Room for the lights of the frame before, where the plan reuses what it made, and whether it can be. */
noc_status noc_vk_view_begin_past(vk_view *v, const noc_plan *plan);
/* Room for candidates that are drawn before the frame, and how many subsets there are of `rows` a pixel. */
noc_status noc_vk_view_fit_samples(vk_view *v, uint32_t rows);

/* mean.c */
/* The frame just submitted made the mean one of so many frames, 1: a new one. Reads it now and then. */
noc_status noc_vk_note_mean(vk_view *v, uint64_t frames);
/* Brings v->mean to the device's mean. Where the device was lost it is what was read last, if that is of this mean. */
noc_status noc_vk_read_mean(vk_view *v);
void noc_vk_free_mean(vk_view *v);
noc_status noc_vk_read_picture(void *view, noc_image *image);
bool noc_vk_lost(void *view, uint64_t *frames);

/* lists.c */
/* Returns all hierarchies as shaders read them, NULL where memory is refused. */
void *noc_vk_pack_clusters(const noc_clusters *const clusters[NOC_HALVES], size_t *bytes);
/* Room for what a frame observes and learns. */
noc_status noc_vk_view_fit_learning(vk_view *v, const frame_constants *constants);
/* Before the first step of a frame that learns, and when it was submitted; one that is dropped is not learned from. */
void noc_vk_begin_learning(vk_view *v, uint32_t epoch, VkCommandBuffer commands);
void noc_vk_end_learning(vk_view *v);
void noc_vk_free_learning(vk_view *v);

/* influence.c */
/* What the view draws from, and what is told of it; before the frame and when it is recorded: room for what is counted,
 * and zeros. */
noc_status noc_vk_get_influence(vk_view *v, const noc_frame *frame);
void noc_vk_clear_found(vk_view *v, VkCommandBuffer commands);
/* Waits for the last frame. */
void noc_vk_note_found(vk_view *v, noc_light_stats *out);
/* Returns the volumes as shaders read them, NULL where memory is refused. */
void *noc_vk_pack_influence(const noc_influence *influence, size_t *bytes);

/* frame.c */
noc_status noc_vk_stage(void *view, const noc_frame *frame, const noc_stage *stage, const noc_progress *progress,
                        double from, double to);
noc_status noc_vk_accumulate(void *view, const noc_frame *frame);
void noc_vk_stats(void *view, noc_frame_stats *stats);
bool noc_vk_finish(void *view);
noc_status noc_vk_finish_flights(vk_view *v); /* waits for the view's frames in flight and takes what they counted */

/* record.c */
/* Empties a command buffer, which a frame that was dropped may have left half recorded, and opens it; submits it. */
VkResult noc_vk_begin_commands(const vk_flight *f);
VkResult noc_vk_submit_commands(const vk_device *d, const vk_flight *f);
/* Times of passes: before the first step, and when the commands have run; these are added up, and their sum returned.
 */
void noc_vk_start_times(const vk_device *d, vk_flight *f);
double noc_vk_take_times(vk_view *v, vk_flight *f);
/* Records v->steps, or runs them: from..to is their share of the frame. */
noc_status noc_vk_record_steps(vk_view *v, const vk_binding *common, double from, double to);
/* Traces the kept rays again, and nothing else. */
noc_status noc_vk_trace_kept(vk_view *v, const noc_progress *progress, noc_trace_floor *floor);

/* pace.c */
double noc_vk_expected_seconds(const vk_view *v, const vk_step *step); /* INFINITY: it is not known */
/* Before the first step of a frame of which so much is expected, and so many when it has run at once. */
void noc_vk_begin_pace(vk_view *v, double expected);
void noc_vk_note_frame(vk_view *v, double seconds);
bool noc_vk_may_go_on(const vk_view *v); /* false: the caller breaks the frame off */
/* Returns true if what is recorded is to be run before the step. */
bool noc_vk_piece_is_due(const vk_view *v, const vk_step *next);
/* Rows of the step to be recorded from `first` on; last: those of its last piece, 0 where there is none. */
uint32_t noc_vk_next_piece(vk_view *v, const vk_step *step, uint32_t first, uint32_t last);
void noc_vk_note_piece(vk_view *v, double seconds); /* what is recorded has run */

/* floor.c */
void noc_vk_record(void *view, bool on);
noc_status noc_vk_replay(void *view, const noc_progress *progress, noc_trace_floor *floor);
/* Keeps the rays that the step is about to trace. */
noc_status noc_vk_keep_rays(vk_view *v, const vk_step *step);
void noc_vk_forget_rays(vk_view *v);

/* readback.c */
size_t noc_vk_views_bytes(uint32_t aovs); /* a pixel */
/* Before a frame that asks for these views: room, and what shaders need; then the commands that empty buffers. */
noc_status noc_vk_begin_views(vk_view *v, uint32_t aovs);
void noc_vk_clear_views(vk_view *v, VkCommandBuffer commands);
/* The frame is submitted: waits for it and keeps its views. past: as it was while the frame was made. */
noc_status noc_vk_keep_views(vk_view *v, const noc_frame *frame, const noc_past *past);
void noc_vk_views_free(vk_view *v);
noc_status noc_vk_read_aov(void *view, noc_aov aov, float *value);
void noc_vk_rows(void *view, const frame_camera *camera, const noc_frame_rows *rows);

/* frame.c */
void noc_vk_light_stats(void *view, noc_light_stats *stats);

/* host.c: questions that the CPU backend answers */
void noc_vk_run(void *device, size_t items, void (*fn)(void *ctx, size_t item, int worker), void *ctx);
noc_status noc_vk_cast(void *view, const noc_ray *rays, size_t count, noc_hit *hits);
noc_status noc_vk_ask(void *view, const noc_render_params *params, bool tree, noc_asking *out);
void noc_vk_clear(void *view, const noc_sight *sights, size_t count, float *clear);
noc_status noc_vk_influence(void *view, const noc_render_params *params, const struct noc_influence **volumes);
void noc_vk_forget_host_view(vk_view *v);
void noc_vk_forget_host_world(vk_world *w);
void noc_vk_forget_host_device(vk_device *d);

#endif
