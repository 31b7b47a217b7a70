/* What is computed between rays, for one block of 16 pixels at a time: core/ in scalar C and in wide C, behind one
 * table an instruction set. Ray tracing stays outside: a kernel leaves segments, passes.c has them traced and calls the
 * next one. Lanes are told apart by bits of a uint32_t. Scalar and wide tables give the same bits. */
#ifndef NOC_CPU_KERNELS_H
#define NOC_CPU_KERNELS_H

#include "core/blocks.h"
#include "core/frame.h"
#include "core/list_limits.h"
#include "light/alias.h"
#include "light/clusters.h"
#include "light/environment.h"
#include "light/influence.h"
#include "light/tree.h"
#include "render/backend.h"

enum { MOST_SHADOW_RAYS = 16, PICK_AHEAD = 8 };

/* What the pixels of a tile evaluate: core/lists.h. */
typedef struct light_list {
    uint32_t count;
    uint32_t copies; /* of every light: count / copies are told apart */
    uint32_t light[LIST_ROOM];
    float weight[LIST_ROOM];
} light_list;

/* Candidates that a picker has drawn for the pixels of a block: draw, lane. PICK_AHEAD more are there than draws. */
typedef struct pick_block {
    uint32_t (*light)[BLOCK];
    float (*inverse)[BLOCK]; /* 1 / pmf; 0: nothing was picked */
} pick_block;

/* 16 of the samples that blocks share, candidates of the same number of a block's pixels: core/presampled.h. */
enum { MOST_DRAWS = 1024 };
typedef struct presample_row {
    ALIGNED float x[3][BLOCK];
    float normal[3][BLOCK], shine[3][BLOCK], bare[BLOCK], sided[BLOCK], close2[BLOCK], radius[BLOCK];
    float inverse[BLOCK];
    uint32_t light[BLOCK], place[BLOCK];
} presample_row;
/* influence: the volumes of their lights, which all sets ask that take them. */
typedef struct presample_volumes {
    ALIGNED float c[3][BLOCK];
    float size[BLOCK], m[3][BLOCK], root[BLOCK], turn[BLOCK]; /* turn: influence_turn */
    uint32_t id[BLOCK];
} presample_volumes;
/* One of them. */
typedef struct presample_pick1 {
    uint32_t light, place;
    float inverse;
} presample_pick1;

/* Pixels on their way down a light tree: backend/cpu/tree_draws_tmpl.h. One array a field, TREE_ITEMS each. */
typedef struct tree_items {
    uint32_t count;
    uint32_t *pair, *what; /* what: lane, first draw << 4, draws << 16 */
    float *pmf;
} tree_items;
/* every draw of every pixel alone, and places that are read or written past them */
enum { TREE_ITEMS = 16 * 1024 + 64 };

/* Where core's bridge functions read next. */
typedef struct core_cursors {
    const gblock *const *tile;   /* its blocks */
    const uint32_t *tile_pixels; /* and what of them sees a surface */
    struct list_scratch *lists;  /* of the tile */
    const struct priors *priors;
    struct list_asked *asked; /* of the block */
    const struct ray_draw *found;
    const float *bright;          /* of the picture's blocks */
    noc_found *volumes;           /* of the tile: what its points find among influence volumes */
    struct influence_cut *cut;    /* and its pixels in sixteens: influence.c */
    const pick_block *picks;      /* of the block */
    const presample_row *samples; /* of the block: its subset */
    float (*weighed)[BLOCK];      /* and sums of their weights */
    const struct combining *combining;
    struct reference_scratch *reference;
    int lane; /* blocks are read from this one on */
} core_cursors;

/* What core's bridge functions read. */
struct core_context {
    const frame_constants *frame;
    const light_record *lights;
    uint32_t light_count;
    const float *profiles;              /* core/profile.h: cells, 16-byte aligned; NULL: no light has one */
    float ray_offset;                   /* of shadow rays at least, m: core/shadow.h */
    const material_record *materials;   /* at least one */
    const uint32_t *texels;             /* core/texture.h; NULL: no material has a texture */
    const noc_clusters *clusters[2];    /* lists only: of lights that stand, of those that move; NULL: none */
    const noc_alias *alias;             /* power only */
    const noc_tree *tree;               /* light-bvh only */
    const noc_influence *influence;     /* influence only */
    const noc_environment *environment; /* NULL: no map around the scene */
    const noc_map_light *map_light;     /* where it lights only */
    core_cursors at;
};

/* A reservoir of another pixel with that pixel's surface; lanes outside `lanes` were rejected and have m = w = 0. */
typedef struct neighbour {
    gblock g;
    rblock r;
    uint32_t lanes;
} neighbour;

/* The samples that neighbours are asked about: core's builder. */
typedef struct held_block {
    ALIGNED float u[BLOCK];
    float v[BLOCK], p[BLOCK], w_sum[BLOCK], m[BLOCK], tag[BLOCK];
    uint32_t light[BLOCK];
} held_block;

/* A block whose reservoirs are being combined with others'. */
typedef struct combining {
    size_t at; /* in the picture */
    int x, y;  /* pixel of lane 0 */
    const gblock *g;
    const rblock *own;
    uint32_t visible;        /* lanes whose sample is known to be seen from its pixel */
    uint32_t dim;            /* DIM_TEMPORAL, or DIM_SPATIAL + 64 a pass */
    const frame_camera *eye; /* the neighbours' */
    int k;                   /* draws of neighbours, those with no lane, too */
    bool partners;           /* one of them is asked, another one for each lane; else all are */
    held_block held;
    float p_at[MAX_NEIGHBOURS][BLOCK]; /* its target there */
    uint32_t asked[MAX_NEIGHBOURS],
        unoccluded[MAX_NEIGHBOURS]; /* lanes of rays from there; those that nothing blocks */
    gblock partner; /* surfaces of those that lanes ask where that differs from lane to lane; no depth, no light */
    neighbour n[MAX_NEIGHBOURS];
} combining;

/* Of the i-th neighbour that is asked. */
static inline const gblock *noc_asked_surface(const combining *b, int i) {
    return b->partners ? &b->partner : &b->n[i].g;
}

/* Scratch of the reference method, one a worker. */
typedef struct reference_scratch {
    float (*sums)[BLOCK];     /* unshadowed luminance a chunk of lights */
    uint32_t (*light)[BLOCK]; /* entry, lane: `rays` entries */
    float (*w)[BLOCK];
    uint32_t count[BLOCK]; /* entries a lane */
} reference_scratch;

/* What core/list_build.h remembers of patches and of groups. */
typedef struct patch_record {
    float c[3], radius, axis[3], spread, share, reflectance, wo[3], gloss, alpha2;
} patch_record;

typedef struct group_record {
    uint32_t block;
    uint8_t part, level;
} group_record;

/* A tile's list, and scratch of building it, one a worker. */
typedef struct list_scratch {
    light_list list;
    ALIGNED float scores[LIST_GROUPS + 1][16];
    ALIGNED uint32_t sketches[SKETCH_WORDS][LIST_ROOM]; /* fields of list_sketch by row and place: core/list_faces.h */
    float parents[LIST_CHOSEN];
    uint32_t line[LIST_GROUPS + 1]; /* core/list_tail.h */
    group_record groups[LIST_GROUPS];
    uint32_t pieces[LIST_PATCHES];
    patch_record patches[LIST_PATCHES];
} list_scratch;

/* What is expected of a list's entries by row and place, and so how they are weighed; 0 where there is none. */
typedef struct priors {
    ALIGNED float share[LIST_ROOM]; /* weight * pull */
    float expect[LIST_ROOM];        /* weight * visibility */
} priors;

/* The place of the entry after the one at that place, in a list of so many entries: core/list_faces.h. */
static inline uint32_t next_place(uint32_t at, uint32_t count) {
    return at + 16 < (count + 15) / 16 * 16 ? at + 16 : at % 16 + 1;
}

/* What the pixels of a block see: struct surf, and how far. */
typedef struct seen_block {
    ALIGNED float p[3][BLOCK];
    float n[3][BLOCK], wo[3][BLOCK], albedo[3][BLOCK], f0[BLOCK], alpha[BLOCK], depth[BLOCK];
} seen_block;

/* What a face of a block weighs: core/list_faces.h. */
typedef struct face_weights {
    ALIGNED float far[LIST_ROWS + 2][16]; /* sums down the columns, of the rows before; and what is expected */
    float column[17];                     /* sums of the columns before */
    uint32_t near[LIST_ROWS];             /* bits of places */
    uint32_t pixels;
} face_weights;

/* An entry that is near for some pixels of a block. */
typedef struct near_record {
    uint32_t entry;
    uint16_t place, pixels;
} near_record;

/* What the pixels of a block ask for over their tile's list: core/list_rays.h. */
typedef struct list_asked {
    seen_block seen;
    face_weights face[LIST_FACES];
    near_record near[LIST_ROOM];
    ALIGNED float summed[LIST_ROOM + 1][BLOCK]; /* what chooses near entries, of all before each */
    uint32_t face_of[BLOCK];                    /* a pixel's face */
    float all[BLOCK], bright[BLOCK];            /* list_sums, of near and far entries */
    float n[BLOCK];                             /* draws */
    int most;                                   /* rays of a lane at most */
    uint32_t fresh;                             /* the caller's: lanes that ask for more */
    uint32_t entry[MOST_SHADOW_RAYS][BLOCK];    /* of a lane's ray */
    float times[MOST_SHADOW_RAYS][BLOCK];       /* drawn so often; 0: no such ray */
    float weighed[MOST_SHADOW_RAYS][BLOCK];
} list_asked;

/* Rays of one block, a lane each. */
typedef struct ray_draw {
    rblock r;             /* w: W, 0 where the ray was blocked; m is not used */
    cblock brings;        /* what the surface reflects of the sample, unshadowed */
    uint8_t entry[BLOCK]; /* of the list */
    uint8_t times[BLOCK]; /* it was drawn so often; 0: there is no such ray */
    int block;            /* of the tile */
    int rays;             /* the block has so many of them, one after the other */
} ray_draw;

/* The triangles that a block's primary rays hit, as core/primary.h reads them. */
typedef struct struck_block {
    uint32_t lanes, placed, textured; /* that hit a triangle; of these on an instance; on a texture */
    ALIGNED float at[3][3][BLOCK];    /* corner, coordinate */
    float u[BLOCK], v[BLOCK], t[BLOCK];
    uint32_t material[BLOCK], light[BLOCK];
    float transform[12][BLOCK]; /* of `placed` */
    uint32_t texture[BLOCK];    /* place of its head; of `textured` as the next one */
    float image[3][2][BLOCK];   /* corner, u or v */
} struck_block;

typedef struct kernels {
    const char *name;
    /* Receivers of a block's camera rays; none outside h->lanes. */
    void (*hits)(const struct core_context *ctx, const rayblock *rays, const struck_block *h, gblock *g);
    /* A subset of the candidates that blocks share: m rows, of all lights alike or by power. scratch: 16 m. */
    void (*presample)(const struct core_context *ctx, uint32_t subset, int m, bool by_power, presample_pick1 *scratch,
                      presample_row *out);
    /* A reservoir of m samples, a row each, for the lanes of `lanes`; w = m = 0 elsewhere. pixels: y * width + x.
     * scratch: m. */
    void (*presampled)(const struct core_context *ctx, const gblock *g, uint32_t lanes, const uint32_t pixels[BLOCK],
                       int m, const presample_row *samples, float (*scratch)[BLOCK], rblock *out);
    /* The list of a tile of `blocks` blocks into scratch->list: core/list_build.h. Then candidates from ctx->lists. */
    void (*list_build)(const struct core_context *ctx, const gblock *const *g, const uint32_t *lanes, int blocks,
                       uint32_t start, list_scratch *scratch);
    void (*list_candidates)(const struct core_context *ctx, const gblock *g, uint32_t lanes, int x, int y, rblock *out);
    /* Several rays a pixel over the list (core/list_rays.h): its lights several times where there is room; how many
     * rays, to which entries; ray k of each lane, into all of out but r.m. From what the `rays` of a block are or have
     * found: the reservoirs that stand for its lanes in views of the candidates, of n draws each, and those that lanes
     * keep, both with the M that is there; and what of a pixel is its reservoir's. */
    void (*list_fill)(const struct core_context *ctx);
    void (*list_share)(const struct core_context *ctx, const gblock *g, uint32_t lanes, int x, int y, float brightness,
                       const priors *priors, list_asked *out);
    void (*list_ray)(const struct core_context *ctx, int x, int y, list_asked *asked, int k, ray_draw *out,
                     rayblock *way);
    void (*list_stand_in)(const struct core_context *ctx, int x, int y, const ray_draw *found, int rays,
                          const float n[BLOCK], rblock *out);
    void (*list_resample)(const struct core_context *ctx, int x, int y, const ray_draw *found, int rays, rblock *out);
    void (*list_mix)(const struct core_context *ctx, const float m[BLOCK], float reused[BLOCK]);
    /* Light pickers: m candidates for the lanes of a block; then a reservoir of such candidates. */
    void (*pick_tree)(const struct core_context *ctx, const gblock *g, uint32_t lanes, int x, int y, int m,
                      tree_items items[2], pick_block *out);
    /* The volumes of a subset of m rows. */
    void (*influence_volumes)(const struct core_context *ctx, int m, const presample_row *rows, presample_volumes *out);
    /* What the surfaces of n blocks, a tile, find among the influence volumes; then m rows of samples for pixels of
     * groups that are given, a lane each: set `number` of the frame. shared: those drawn from all lights. */
    void (*influence_find)(const struct core_context *ctx, const gblock *const *g, const uint32_t *lanes, int n,
                           noc_found *out);
    void (*influence_draw)(const struct core_context *ctx, const noc_found *found, const uint16_t of[BLOCK],
                           uint32_t number, int m, const presample_row *shared, const presample_volumes *volumes,
                           presample_row *out);
    void (*given)(const struct core_context *ctx, const gblock *g, uint32_t lanes, int x, int y, int m,
                  const pick_block *picks, rblock *out);
    /* The pixels of the previous picture that saw this frame's surfaces; returns the lanes that have one. */
    uint32_t (*history_places)(const struct core_context *ctx, const gblock *g, uint32_t x[BLOCK], uint32_t y[BLOCK]);
    /* The 4x4 pixels from (x, y) on, which may lie outside the picture, as neighbours of the pixels of `here`: those of
     * the lanes `wanted` that are inside and on a surface like theirs. g, r: the picture's. n->g is left without its
     * depth and light, and undefined where `lanes` is 0. */
    void (*neighbours)(const struct core_context *ctx, const gblock *g, const rblock *r, const gblock *here,
                       uint32_t wanted, int x, int y, neighbour *n);
    /* Segments from g to the samples. */
    void (*segments)(const struct core_context *ctx, const gblock *g, const uint32_t *light, const float *u,
                     const float *v, rayblock *out);
    /* The steps of core/reuse.h. reuse_ask sets `p_at` and `asked` for the samples held; there: the context with the
     * lights that the neighbours' reservoirs were made with. reuse_end leaves in `visible` what still holds. */
    void (*reuse_begin)(const struct core_context *ctx, combining *b);
    void (*reuse_ask)(const struct core_context *there, combining *b);
    void (*reuse_end)(const struct core_context *ctx, combining *b, rblock *out);
    /* rgb += reflected * w for `lanes`; returns the lanes whose sum was not finite: those keep what they had. */
    uint32_t (*shade)(const struct core_context *ctx, const gblock *g, const rblock *r, uint32_t lanes, cblock *out);
    /* The same, where what is reflected is known. */
    uint32_t (*shade_known)(const cblock *brings, const float w[BLOCK], uint32_t lanes, cblock *out);
    /* The lights' unshadowed luminance at each lane, then entries placed over it: see reference.c. */
    void (*reference)(const struct core_context *ctx, const gblock *g, uint32_t lanes, int x, int y,
                      reference_scratch *scratch);
    /* (u, v) that `reference` used for a lane's light. */
    void (*reference_place)(const struct core_context *ctx, int x, int y, rblock *r);
    /* A direction a lane, as a ray that leaves the scene, from place number[lane] of the pixel's sequence; then, where
     * it is free, its light times share[lane]. */
    void (*sky_rays)(const struct core_context *ctx, const gblock *g, int x, int y, const uint32_t *number,
                     rayblock *out);
    uint32_t (*sky_shade)(const struct core_context *ctx, const gblock *g, const rayblock *rays, const float *share,
                          uint32_t lanes, cblock *out);
    /* lux += what the samples, or the sky along those rays, light their surfaces with, for `lanes`; what is not finite
     * is left out. lux: one a lane. */
    void (*samples_lux)(const struct core_context *ctx, const gblock *g, const rblock *r, uint32_t lanes, float *lux);
    void (*sky_lux)(const struct core_context *ctx, const gblock *g, const rayblock *rays, const float *share,
                    uint32_t lanes, float *lux);
    /* rgb += what a lamp at the eye shows of the surfaces of `lanes`. */
    void (*headlight)(const struct core_context *ctx, const gblock *g, uint32_t lanes, cblock *out);
    void (*sky_background)(const struct core_context *ctx, uint32_t lanes, int x, int y, cblock *out);
} kernels;

extern const kernels noc_kernels_scalar, noc_kernels_baseline, noc_kernels_avx2, noc_kernels_avx512;
/* All that this machine can run: scalar first, the widest last. Returns how many. */
enum { NOC_MAX_KERNELS = NOC_ISA_COUNT - 1 };
int noc_runnable_kernels(const kernels *out[NOC_MAX_KERNELS]);
/* Of a level that noc_choose_isa takes. */
const kernels *noc_pick_kernels(noc_isa isa);

#endif
