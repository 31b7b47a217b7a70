/* State of the CPU backend: a device, the worlds on it (a scene each), and the views of each world. */
#ifndef NOC_CPU_H
#define NOC_CPU_H

#include "backend/cpu/backend.h"
#include "backend/cpu/kernels.h"
#include "backend/cpu/tracer.h"
#include "backend/parts.h"
#include "core/presample_limits.h"
#include "light/learned.h"
#include "light/set.h"
#include "render/emitter_coverage.h"
#include "render/past.h"
#include "render/frame_views.h"

#include <pthread.h>
#include <stdatomic.h>

enum { TILE_BLOCKS = 4 }; /* a tile is 4x4 blocks: 16x16 pixels */
_Static_assert((int)NOC_QUERY_BLOCKS == TILE_BLOCKS * TILE_BLOCKS && (int)NOC_QUERY_POINTS == (int)BLOCK,
               "a tile's points ask together");
typedef enum packet_kind {
    PACKET_PRIMARY, /* block.light: by which its rays meet surfaces that let light through */
    PACKET_SHADOW,
    PACKET_THROUGH, /* segments that nothing blocks, for what surfaces let through */
} packet_kind;

/* A packet kept for the trace floor. Shadow rays that were traced in one call lie one after the other. */
typedef struct packet {
    shadow_block block;
    int together; /* so many of them from here on were one call */
    packet_kind kind;
    noc_ray_world in;
} packet;

/* What is expected in a cell of the scene, and what its rays find. */
typedef struct tile_cell {
    cell_key key;
    priors priors;
    uint16_t asked[LIST_ROOM], seen[LIST_ROOM];
} tile_cell;

/* Segments of a tile's blocks, gathered to be traced in company. */
typedef struct ray_batch {
    int count;
    shadow_block blocks[TILE_BLOCKS * TILE_BLOCKS * MAX_NEIGHBOURS];
} ray_batch;

/* What the passes of one tile hand on to each other. */
typedef struct tile_rays {
    list_asked asked;                          /* of the block at hand */
    size_t at[TILE_BLOCKS * TILE_BLOCKS];      /* the tile's blocks in the picture */
    uint32_t lanes[TILE_BLOCKS * TILE_BLOCKS]; /* that see a surface */
    int cell_of[TILE_BLOCKS * TILE_BLOCKS];
    float n[TILE_BLOCKS * TILE_BLOCKS][BLOCK]; /* draws of pixels */
    int cells, count;
    uint32_t fresh[TILE_BLOCKS * TILE_BLOCKS]; /* restir: lanes that no earlier frames stand behind */
    /* restir: what of a pixel's light is its reservoir's; its rays have the rest */
    float reused[TILE_BLOCKS * TILE_BLOCKS][BLOCK];
    tile_cell cell[TILE_BLOCKS * TILE_BLOCKS];
    ray_draw draws[TILE_BLOCKS * TILE_BLOCKS * MOST_SHADOW_RAYS];
    shadow_block segments[TILE_BLOCKS * TILE_BLOCKS * MOST_SHADOW_RAYS];
} tile_rays;

/* Where a tile's observations are: so many cells. */
typedef struct learned_tile {
    int worker;
    size_t first, count;
} learned_tile;

/* Scratch of passes, one a thread, made when a plan first has such a pass (scratch.c). */
typedef struct list_pass { /* lists: the list of the tile at work and the rays over it, from pass to pass of a stage */
    list_scratch build;
    tile_rays rays;
    NOC_ARRAY(noc_cell_observations) observed; /* of the frame being made, as are the next ones */
    NOC_ARRAY(noc_observation) observations;
} list_pass;

typedef struct pick_pass { /* influence, light-bvh */
    pick_block drawn;      /* light-bvh, as the next ones */
    tree_items items[2];
    presample_row *set; /* influence: samples at work */
    noc_found found;    /* by the tile at work */
    /* [found_bins] surfaces of the frame by the number of lights found; NULL: never asked */
    uint64_t *found_counts;
} pick_pass;

typedef struct share_pass { /* uniform, power, influence: of the block, or of the subset at work */
    ALIGNED float weighed[MOST_DRAWS][BLOCK];
    presample_pick1 drawn[MOST_DRAWS * BLOCK];
} share_pass;

/* Rays that are kept to be traced again. */
typedef struct recorder {
    packet *packets;
    size_t count, room;
    bool lost; /* there was no memory for all of them */
} recorder;

/* One a thread; a multiple of a cache line apart. */
typedef struct worker {
    ALIGNED double seconds[NOC_PASS_COUNT];
    uint64_t rays_primary, rays_shadow, dropped;
    bool no_memory;  /* was refused to a tile: the frame is dropped */
    ray_batch batch; /* of the pass at work */
    list_pass *lists;
    pick_pass *picks;
    share_pass *shares;
    combining *combining; /* reuse: of a tile's blocks */
    reference_scratch *reference;
    recorder record;
} worker;

/* Buffers of one picture; every array has an entry a block. */
typedef struct frame_buffers {
    int width, height, sets;
    int blocks_x, blocks_y, tiles_x, tiles_y;
    gblock *g[2];
    rblock *r[NOC_RESERVOIR_SETS];
    uint16_t *visible[NOC_RESERVOIR_SETS]; /* lanes whose sample is known to be seen from its own pixel */
    cblock *colour;                        /* of the frame being made */
    cblock *picture;                       /* mean, or last frame */
    uint16_t *emitter;                     /* lanes that see an emitter in the frame being made */
    uint32_t (*instance)[BLOCK];           /* that each lane sees, or NO_INSTANCE; NULL: the scene has had none */
    noc_coverage coverage;
    noc_views views;
    int kept; /* surfaces of the last complete frame: g[kept] */
    size_t bytes;
} frame_buffers;

/* Threads and a ray tracer, shared by all worlds. */
typedef struct cpu_device {
    noc_log *log;
    noc_pool *pool;
    const noc_tracer *tracer;
    void *rays; /* the tracer's device */
} cpu_device;

/* A scene on a device: its ray tracing structure, and what light candidates are drawn from. */
typedef struct cpu_world {
    cpu_device *device;
    const noc_scene *scene;
    noc_log *log;
    void *rays;           /* the tracer's structure */
    pthread_mutex_t lock; /* held while it follows the scene */
    noc_placings placings;
    double build_seconds;
    noc_ray_scale scale;
    noc_material_record no_material; /* stands in where the scene has none */
    noc_light_set *lights;
} cpu_world;

/* One picture of a world, with its buffers, its history and the scratch of each thread. */
typedef struct cpu_view {
    cpu_world *world;
    const noc_scene *scene; /* of the world, as are the next two */
    noc_log *log;
    noc_pool *pool;
    noc_light_sources sources;      /* of the last frame; what it does not hold may be gone when that is over */
    const noc_map_light *map_light; /* of the last frame that was lit by the scene's map */
    noc_light_stats told;           /* of that frame's candidates and volumes */
    frame_buffers b;
    /* of a worker: from 0 to the number of lights; the last of NOC_FOUND_MOST + 1 counts what finds more too */
    uint32_t found_bins;
    noc_learned *learned;   /* it is of places in the scene, so it outlives the size of the picture */
    uint32_t learned_epoch; /* noc_frame.epoch that it is of */
    learned_tile *learned_tiles;
    noc_observations *observations;    /* of the frame's tiles */
    float *block_bright;               /* core/list_bright.h, of the frame being made */
    float list_brightness;             /* mean luminance that the last frame expected, cd/m2; 0: not known */
    noc_light_record *previous_lights; /* all lights as they were in the last frame that left reservoirs */
    noc_past past;
    size_t chunks;                     /* of lights, that the reference has room for */
    presample_row *samples;            /* that the blocks of a frame share: [PRESAMPLES / 16]; NULL: never asked for */
    presample_volumes *sample_volumes; /* influence: parallel */
    uint32_t subsets;
    bool wanted_subsets[PRESAMPLES / BLOCK];
    worker *workers;
    int worker_count;
    bool recording;
    const kernels *kernels; /* of the last frame */
    int shaded_set;         /* reservoirs that the last frame shaded */
} cpu_view;

/* A stage at work: what every tile needs. */
typedef struct stage_run {
    cpu_view *s;
    const noc_frame *frame;
    struct core_context ctx;
    const noc_stage *stage;
    const kernels *k;
    const noc_progress *progress;
    const char *what;
    double from, to;
    size_t tiles;
    atomic_size_t done;
    atomic_bool cancelled;
} stage_run;

/* The blocks of a tile, one after the other. */
typedef struct tile {
    int x0, y0, x1, y1; /* blocks */
} tile;

typedef struct tile_block {
    size_t at; /* in the picture */
    int x, y;  /* pixel of lane 0 */
} tile_block;

/* The surfaces that the blocks of a tile see. */
typedef struct tile_points {
    int count;
    tile_block block[TILE_BLOCKS * TILE_BLOCKS];
    const gblock *g[TILE_BLOCKS * TILE_BLOCKS];
    uint32_t lanes[TILE_BLOCKS * TILE_BLOCKS];
} tile_points;

/* device.c */
/* Has the world follow what was edited; before anything of a frame. */
noc_status noc_cpu_follow(cpu_world *world);
size_t noc_cpu_rays_bytes(const cpu_world *world); /* of the ray tracing structure */
/* view.c: before a frame, room for what the scene has more than before */
noc_status noc_cpu_fit_scene(cpu_view *s);
/* A frame of the view, with these surfaces, for views and rows. */
noc_frame_blocks noc_cpu_blocks(const cpu_view *s, int gbuffer);
/* rays.c: what the tracer answers, and the book-keeping around it */
/* Traces the segments of many blocks, the more the better up to MANY_BLOCKS. Sets `clear`, which is 0 outside `valid`.
 * Counts rays where each block says, and keeps them when recording. */
void noc_cpu_trace_occlusion(cpu_view *s, worker *w, noc_ray_world in, shadow_block *blocks, int count);
/* Transmittance of the unoccluded segments of up to MANY_BLOCKS blocks. False, and nothing is written: no surface of
 * the scene lets light through. */
bool noc_cpu_through(const cpu_view *s, worker *w, const shadow_block *blocks, int count, float (*out)[BLOCK]);
/* Traces camera rays and stores the receivers that they find in block `at` of the G-buffer, with their instances, and
 * their objects and walls for the views that ask for these. Lanes outside `valid` find nothing. chance: the pixels'
 * keys, as noc_tracer.closest has them. */
void noc_cpu_primary(const stage_run *run, worker *w, const rayblock *rays, const uint32_t *chance, uint32_t valid,
                     size_t at);
void noc_cpu_probe(void *user, noc_probes *probes); /* a noc_probe_fn; user is the cpu_world */
noc_status noc_cpu_replay_rays(cpu_view *s, const noc_progress *progress, noc_trace_floor *floor);

/* scratch.c: what the passes of a plan want, for each thread */
noc_status noc_cpu_prepare_scratch(cpu_view *s, const noc_plan *plan);
void noc_cpu_free_scratch(cpu_view *s);

/* lights.c: what the candidates of these parameters are drawn from */
noc_status noc_cpu_prepare_lights(cpu_view *s, const noc_plan *plan, const noc_render_params *p);
void noc_cpu_release_lights(cpu_view *s);
void noc_cpu_forget_found(cpu_view *s); /* of the last frame, before candidates are drawn */
/* The candidates that a frame's blocks share, where its plan has such, drawn by all threads; so many a pixel. */
void noc_cpu_presample(stage_run *run);
int noc_cpu_shared_draws(const stage_run *run);
/* moved.c: what the frame before saw of a scene that is edited */
/* Before a frame: room for the lights of the previous one, where reservoirs of it will be reused with these parameters,
 * and whether they can be. */
noc_status noc_cpu_begin_past(cpu_view *s, const noc_plan *plan);
/* After a frame: its reservoirs were made with the scene as it is now. */
void noc_cpu_keep_past(cpu_view *s);
/* The context that the previous frame's targets and visibility are asked of: *now with its lights. in: what its rays
 * are traced against. */
struct core_context noc_cpu_previous(const cpu_view *s, const struct core_context *now, noc_ray_world *in);
/* Takes surfaces that instances show back to where they were in the frame before; g itself where all stand. */
const gblock *noc_cpu_taken_back(const cpu_view *s, size_t at, const gblock *g, gblock *moved);
size_t noc_cpu_past_bytes(const cpu_view *s);
size_t noc_cpu_light_bytes(const cpu_world *world);

/* passes.c: one pass over one tile */
void noc_cpu_pass(stage_run *run, worker *w, noc_pass pass, tile t);
/* The blocks of a tile in their order; returns how many. */
int noc_cpu_tile_blocks(const stage_run *run, tile t, tile_block out[TILE_BLOCKS * TILE_BLOCKS]);
/* The next block of w->batch, for noc_cpu_trace_occlusion: `valid` lanes are to be traced, counted for block `at` of
 * the picture. The rays are left to the caller; or they are segments from the surfaces of g to samples. */
shadow_block *noc_cpu_gather(const stage_run *run, worker *w, size_t at, uint32_t valid);
void noc_cpu_gather_segments(const stage_run *run, worker *w, size_t at, uint32_t valid, const gblock *g,
                             const uint32_t *light, const float *u, const float *v);
/* Traces rays to the samples of `count` blocks at `at` in the stage's target that are not known to be seen from their
 * own pixels, all in company: those that are left are known to be. */
void noc_cpu_resolve(const stage_run *run, worker *w, const size_t *at, int count);

/* The numbers of a block's pixels in the picture. */
static inline void noc_cpu_pixels(const stage_run *run, const tile_block *b, uint32_t pixel[BLOCK]) {
    for (int l = 0; l < BLOCK; l++)
        pixel[l] = (uint32_t)(b->y + l / BLOCK_SIDE) * run->ctx.frame->width + (uint32_t)(b->x + l % BLOCK_SIDE);
}

/* influence.c: reservoirs of a tile's pixels, after w->picks->found has what they find. number: of the tile */
void noc_cpu_draw_influence(const stage_run *run, worker *w, const tile_points *points, uint32_t number);

/* list_rays.c: the passes of a tile where every pixel shares out several rays over its list, after the list was built
 * into w->lists.list */
void noc_cpu_share_candidates(stage_run *run, worker *w, const tile_points *points);
/* Are the reservoirs of a frame read? Where all samples share rays, only views are made of them. */
bool noc_cpu_keeps_reservoirs(const noc_render_params *params);
void noc_cpu_trace_shared(stage_run *run, worker *w, tile t);
void noc_cpu_resample(stage_run *run, worker *w, tile t);
void noc_cpu_shade_shared(stage_run *run, worker *w, tile t);
/* learning.c */
/* Counts the shared rays of a tile, and those that arrived, in the cells of the visibility cache that it lies in. */
void noc_cpu_note_observations(stage_run *run, worker *w, tile t);
float noc_cpu_sum_in_halves(float *x, int n); /* of n numbers, a power of two; overwrites them */
/* Before a frame's first stage, and when the frame is complete; one that is dropped is not learned from. */
noc_status noc_cpu_begin_learning(cpu_view *s, const noc_frame *frame);
void noc_cpu_end_learning(cpu_view *s, const noc_frame *frame);
void noc_cpu_release_tiles(cpu_view *s); /* what depends on the size of the picture */
void noc_cpu_release_learning(cpu_view *s);

/* reuse.c: temporal and spatial combination of a tile's blocks */
void noc_cpu_temporal(stage_run *run, worker *w, tile t);
void noc_cpu_spatial(stage_run *run, worker *w, tile t);
/* Which lanes have less than two earlier frames behind them, into w->lists->rays: a matter of surfaces, not of samples.
 */
void noc_cpu_seen_before(stage_run *run, worker *w, tile t);

/* shading.c: what light adds to a block's colour, and to the views that ask for it */
/* What the candidates of a block were, as far as the frame asks; r: the reservoirs they ended in. */
void noc_cpu_note_candidates(const stage_run *run, const worker *w, int i, size_t block, uint32_t lanes,
                             const rblock *r);
/* The samples' light goes into a block's colour, and into the views of where light comes from. brings: what the surface
 * reflects of each sample, unshadowed; NULL: not known. Returns the lanes that were dropped. */
uint32_t noc_cpu_shade_samples(const stage_run *run, const gblock *g, const rblock *r, const cblock *brings,
                               uint32_t lanes, size_t block);
/* The same of the sky's rays, of which each is so much of its pixel's. */
uint32_t noc_cpu_shade_sky(const stage_run *run, const gblock *g, const rayblock *rays, const float *share,
                           uint32_t lanes, size_t block);
/* Emitters that are seen: c is their luminance. Comes before the two. */
void noc_cpu_note_emitters(const stage_run *run, const gblock *g, const cblock *c, size_t block);

static inline size_t block_at(const frame_buffers *b, int bx, int by) {
    return (size_t)by * (size_t)b->blocks_x + (size_t)bx;
}

static inline uint32_t lanes_inside(const frame_buffers *b, int bx, int by) {
    uint32_t lanes = 0;
    for (int l = 0; l < BLOCK; l++)
        lanes |= (uint32_t)(bx * BLOCK_SIDE + (l & 3) < b->width && by * BLOCK_SIDE + (l >> 2) < b->height) << l;
    return lanes;
}

static inline uint32_t lanes_with_surface(const gblock *g) {
    uint32_t lanes = 0;
    for (int l = 0; l < BLOCK; l++)
        lanes |= (uint32_t)(g->material[l] != NO_SURFACE) << l;
    return lanes;
}

static inline uint32_t lanes_with_sample(const rblock *r) {
    uint32_t lanes = 0;
    for (int l = 0; l < BLOCK; l++)
        lanes |= (uint32_t)(r->w[l] > 0) << l;
    return lanes;
}

#endif
