/* State of the Embree backend. */
#ifndef NOC_EMBREE_H
#define NOC_EMBREE_H

#include "backend/embree/kernels.h"
#include "backend/embree/rt.h"
#include "light/learned.h"

#include <stdatomic.h>
#include <sys/types.h>

/* Numbers of lights found are told apart up to that; 64 k bins take half a megabyte a thread. */
enum { FOUND_MOST = 1 << 16 };
enum { TILE_BLOCKS = 4 }; /* a tile is 4x4 blocks: 16x16 pixels */
_Static_assert((int)NOC_QUERY_BLOCKS == TILE_BLOCKS * TILE_BLOCKS && (int)NOC_QUERY_POINTS == (int)BLOCK,
               "a tile's points ask together");
enum { MANY_BLOCKS = 32 }; /* whose segments are traced together */

/* Segments of 16 pixels to be traced together with those of other blocks. */
typedef struct segment_block {
    rayblock rays;
    uint32_t light[BLOCK]; /* what each leads to: any number will do, equal ones are traced together */
    uint32_t valid, clear; /* lanes to be traced; those of them that nothing blocks */
    float *counts;         /* of the block's pixels, for the view that counts rays, or NULL */
} segment_block;

/* A packet kept for the trace floor. Shadow rays that were traced in one call lie one after the other. */
typedef struct packet {
    segment_block block;
    int together; /* so many of them from here on were one call */
    bool primary;
} packet;

/* ris over lists: rays of one block, a lane each. */
typedef struct ray_draw {
    rblock r;             /* w: W, 0 where the ray was blocked; m and p are not used */
    uint8_t entry[BLOCK]; /* of the list */
    int block;            /* of the tile */
    int rays;             /* the block has so many of them, one after the other */
} ray_draw;

/* What is believed in a cell of the scene, and what its rays find. */
typedef struct tile_cell {
    uint64_t key;
    beliefs beliefs;
    uint16_t asked[2 * LIST_ENTRIES], seen[2 * LIST_ENTRIES];
} tile_cell;

/* Segments of a tile's blocks, gathered to be traced in company. */
typedef struct segment_batch {
    int count;
    segment_block blocks[TILE_BLOCKS * TILE_BLOCKS * MAX_NEIGHBOURS];
} segment_batch;

/* A block whose reservoirs are being combined with others': reuse.c. */
typedef struct combining {
    size_t at; /* in the picture */
    int x, y;  /* pixel of lane 0 */
    const rblock *own;
    uint32_t visible;               /* lanes whose sample is known to be seen from its pixel */
    int k;                          /* neighbours */
    uint32_t asked[MAX_NEIGHBOURS]; /* lanes that a ray from the neighbour was asked for */
    uint32_t seen[MAX_NEIGHBOURS];  /* lanes whose sample counts as seen from the neighbour */
    combination c;
    neighbour n[MAX_NEIGHBOURS];
} combining;

/* What the passes of one tile hand on to each other. */
typedef struct tile_rays {
    weighed weighed;                      /* of the block at hand */
    size_t at[TILE_BLOCKS * TILE_BLOCKS]; /* the tile's blocks in the picture */
    int cell_of[TILE_BLOCKS * TILE_BLOCKS];
    int kept[TILE_BLOCKS * TILE_BLOCKS][BLOCK]; /* the draw that stands for a pixel in views */
    int cells, count;
    /* restir: what of a pixel's light is its reservoir's; its rays have the rest */
    float reused[TILE_BLOCKS * TILE_BLOCKS][BLOCK];
    double bright;
    tile_cell cell[TILE_BLOCKS * TILE_BLOCKS];
    ray_draw draws[TILE_BLOCKS * TILE_BLOCKS * MOST_SHADOW_RAYS];
    segment_block segments[TILE_BLOCKS * TILE_BLOCKS * MOST_SHADOW_RAYS];
} tile_rays;

/* Where a tile's sightings are. */
typedef struct learned_tile {
    int worker;
    size_t first, count;
    double bright; /* sum of what its pixels are expected to see, cd/m2 */
} learned_tile;

/* One a thread; a multiple of a cache line apart. */
typedef struct worker {
    ALIGNED double seconds[NOC_PASS_COUNT];
    uint64_t rays_primary, rays_shadow, dropped;
    combining *combining; /* of a tile's blocks */
    segment_batch batch;
    reference_scratch reference;
    list_scratch lists;
    tile_rays shared;
    NOC_ARRAY(noc_sighting) sightings; /* of the frame being made */
    pick_block picks;
    tree_items tree_items[2];
    noc_found found; /* influence: by a tile */
    /* [found_bins] surfaces of the frame by the number of lights found; NULL: never asked */
    uint64_t *found_counts;
    bool no_memory;  /* was refused to a tile: the frame is dropped */
    packet *packets; /* kept while recording */
    size_t packet_count, packet_room;
    bool packets_lost; /* there was no memory for all of them */
} worker;

/* Views (noc_aov): those of the frame being made, and of the last complete one. Entries that are not asked for are
 * NULL. */
typedef struct view_buffers {
    float (*made[NOC_AOV_COUNT])[BLOCK], (*kept[NOC_AOV_COUNT])[BLOCK];
    uint32_t asked, held; /* bits: buffers that the frame being made works on, that a complete frame has left */
    uint64_t frames;      /* in the moments of the luminance */
    int gbuffer;          /* of the last complete frame */
} view_buffers;

/* Sums over the frames of the mean, of those in which a lane saw an emitter: coverage.c. */
typedef struct coverage_sum {
    float rgb[3][BLOCK];
    uint32_t frames[BLOCK];
} coverage_sum;

typedef struct coverage {
    uint32_t *place; /* [blocks] index + 1 in sums, 0: saw none; NULL: no frame yet */
    NOC_ARRAY(coverage_sum) sums;
    uint64_t frames; /* of the mean */
} coverage;

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
    coverage coverage;
    view_buffers views;
    size_t bytes;
} frame_buffers;

typedef struct embree_state {
    const noc_scene *scene;
    noc_log *log;
    noc_pool *pool;
    RTCDevice device;
    RTCScene rtc;
    double build_seconds;
    float stand_off;                 /* of shadow rays at least, m */
    _Atomic ssize_t build_bytes;     /* held by Embree */
    atomic_bool refused;             /* memory that it asked for */
    noc_status failed;               /* its first error, which has been told */
    noc_material_record no_material; /* stands in where the scene has none */
    frame_buffers b;
    noc_clusters *clusters; /* these are made when first needed */
    noc_alias *alias;
    noc_influence *influence;
    noc_influence_params influence_params; /* that it was made with */
    noc_tree *tree;
    /* of a worker: from 0 to the number of lights; the last of FOUND_MOST + 1 counts what finds more too */
    uint32_t found_bins;
    noc_learned *learned; /* for pictures of this size */
    learned_tile *learned_tiles;
    noc_sightings *sightings;      /* of the frame's tiles */
    float list_brightness;         /* mean luminance that the last frame expected, cd/m2; 0: not known */
    uint64_t moves, power_changes; /* of the scene's lights, that these know of */
    /* all lights as they were in the last frame that left reservoirs; NULL: never needed */
    noc_light_record *past_lights;
    uint64_t past_moves;                                /* of the scene at that frame */
    bool past_filled;                                   /* past_lights has been written */
    double light_seconds[NOC_CANDIDATES_LIGHT_BVH + 1]; /* what each took to build */
    worker *workers;
    int worker_count;
    bool recording;
    const kernels *kernels; /* of the last stage */
    int shaded_set;         /* reservoirs that the last frame shaded */
} embree_state;

/* A stage at work: what every tile needs. */
typedef struct stage_run {
    embree_state *s;
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

/* room.c */
/* Is there memory for a block of so many bytes, and all that TBB may take beside it? */
bool noc_embree_room(const embree_state *s, size_t bytes);
/* Can TBB's threads be started? */
bool noc_embree_room_for_threads(const embree_state *s);
/* device.c */
noc_status noc_embree_build(embree_state *s);
void noc_embree_release(embree_state *s);
/* Traces the segments of many blocks, the more the better up to MANY_BLOCKS: those that lead to one light side by side,
 * the others as a stream (bench/bench_rays has the gain). Sets `clear`, which is 0 outside `valid`. Counts rays where
 * each block says, and keeps them when recording. */
void noc_embree_free_many(embree_state *s, worker *w, segment_block *blocks, int count);
/* Nearest hits of camera rays into a block; lanes outside `valid` see nothing. */
/* object: of each lane, -1 where there is none; may be NULL. */
void noc_embree_primary(embree_state *s, worker *w, const rayblock *rays, uint32_t valid, gblock *g, float *object);
/* many.c: what noc_embree_free_many does with up to MANY_BLOCKS blocks, without the book-keeping. */
void noc_embree_trace_many(RTCScene scene, segment_block *blocks, int count);
/* A noc_probe_fn; user is the embree_state. */
void noc_embree_probe(void *user, noc_probes *probes);
noc_status noc_embree_replay(embree_state *s, double *seconds);
size_t noc_embree_build_bytes(const embree_state *s);

/* lights.c: what the candidates of these parameters are drawn from */
noc_status noc_embree_prepare_lights(embree_state *s, const noc_render_params *p);
void noc_embree_release_lights(embree_state *s);
void noc_embree_forget_found(embree_state *s); /* of the last frame, before candidates are drawn */
/* moved.c: lights that move */
/* Before a frame: what was made for lights that have moved since is refitted, or destroyed to be made again. */
noc_status noc_embree_follow_lights(embree_state *s, const noc_render_params *p);
/* After a frame: its reservoirs were made with the lights as they are now. */
void noc_embree_keep_lights(embree_state *s);
/* The context that the previous frame's targets and visibility are asked of: *now with its lights. */
struct core_context noc_embree_past(const embree_state *s, const struct core_context *now);
size_t noc_embree_past_bytes(const embree_state *s);
size_t noc_embree_light_bytes(const embree_state *s);
void noc_embree_light_stats(void *state, const noc_render_params *params, noc_light_stats *stats);
noc_status noc_embree_influence(void *state, const noc_render_params *params, const struct noc_influence **volumes);

/* passes.c: one pass over one tile */
void noc_embree_pass(stage_run *run, worker *w, noc_pass pass, tile t);
/* The blocks of a tile in their order; returns how many. */
int noc_embree_tile_blocks(const stage_run *run, tile t, tile_block out[TILE_BLOCKS * TILE_BLOCKS]);
/* The next block of w->batch, for noc_embree_free_many: `valid` lanes are to be traced, counted for block `at` of the
 * picture. The rays are left to the caller; or they are segments from the surfaces of g to samples. */
segment_block *noc_embree_gather(const stage_run *run, worker *w, size_t at, uint32_t valid);
void noc_embree_gather_segments(const stage_run *run, worker *w, size_t at, uint32_t valid, const gblock *g,
                                const uint32_t *light, const float *u, const float *v);

/* list_rays.c: the passes of a tile where every pixel shares out several rays over its list, after the list was built
 * into w->lists.list */
bool noc_embree_shares_rays(const noc_render_params *p);
void noc_embree_share_candidates(stage_run *run, worker *w, const tile_points *points);
void noc_embree_share_visibility(stage_run *run, worker *w, tile t);
void noc_embree_share_shade(stage_run *run, worker *w, tile t);
/* Before a frame's first stage, and when the frame is complete; one that is dropped is not learned from. */
noc_status noc_embree_begin_learning(embree_state *s, const noc_frame *frame);
void noc_embree_end_learning(embree_state *s, const noc_frame *frame);
void noc_embree_release_learning(embree_state *s);

/* reuse.c: temporal and spatial combination of a tile's blocks */
void noc_embree_temporal(stage_run *run, worker *w, tile t);
void noc_embree_spatial(stage_run *run, worker *w, tile t);

/* views.c */
noc_status noc_embree_begin_views(embree_state *s, uint32_t aovs, bool first_stage);
/* What the candidates of a block were, as far as the frame asks; r: the reservoirs they ended in. */
void noc_embree_view_candidates(const stage_run *run, const worker *w, int i, size_t block, uint32_t lanes,
                                const rblock *r);
void noc_embree_keep_views(embree_state *s, const noc_frame *frame); /* the frame is complete */

/* coverage.c: what emitters that are seen directly add to the mean */
/* room for the frame, when its shading is done */
noc_status noc_embree_make_coverage(embree_state *s, const noc_frame *frame);
void noc_embree_keep_coverage(embree_state *s, const noc_frame *frame);                      /* the frame is complete */
void noc_embree_read_coverage(const frame_buffers *b, size_t block, int lane, float out[4]); /* as noc_image.coverage */
bool noc_embree_saw_emitter(const frame_buffers *b, size_t block, int lane); /* in a frame of the mean */
void noc_embree_free_coverage(coverage *c);
bool noc_embree_read_view(void *state, noc_aov aov, float *value);
void noc_embree_free_views(view_buffers *views);
size_t noc_embree_view_bytes(uint32_t aovs); /* a pixel */

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
