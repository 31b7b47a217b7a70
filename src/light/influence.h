/* light/influence: a hierarchy over the lights' influence volumes (core/influence.h), for point queries.
 *
 * Volumes scale with S_r, so the hierarchy does not know it: a node holds the box around its lights' shapes and the
 * largest sqrt(intensity), and is entered if the box comes nearer than S_r times that. Lights are sorted by size first
 * and Morton code then, so that few large volumes do not blow up the nodes of many small ones.
 *
 * Lights that stand and lights that move have a hierarchy each, and a query searches both. Dark lights have volumes
 * too, which hold nothing until they shine: so a change of what lights emit moves nothing in either hierarchy. */
#ifndef NOC_LIGHT_INFLUENCE_H
#define NOC_LIGHT_INFLUENCE_H

#include "light/bound.h"
#include "light/influence_rule.h"
#include "scene/scene.h"

#include <float.h>
#include <math.h>
#include <stdio.h>

enum { NOC_INFLUENCE_WIDTH = 16, NOC_INFLUENCE_LEVELS = 8, NOC_QUERY_POINTS = 16, NOC_QUERY_BLOCKS = 16 };

/* Children side by side; those that are not there have root = 0. */
typedef struct noc_influence_node {
    float lo[3][NOC_INFLUENCE_WIDTH], hi[3][NOC_INFLUENCE_WIDTH], root[NOC_INFLUENCE_WIDTH];
} noc_influence_node;

typedef struct noc_influence_volume { /* struct influence of core/influence.h */
    float c[3], size, m[3], root;
} noc_influence_volume;

/* The hierarchy over volumes [first, first + count). Level 0: a child is 16 volumes in order; the last level has one
 * node. */
typedef struct noc_influence_half {
    uint32_t first, count;
    noc_influence_node *nodes;               /* of all levels */
    uint32_t level_at[NOC_INFLUENCE_LEVELS]; /* where a level begins among them */
    int levels;                              /* 0: there is no volume */
} noc_influence_half;

typedef struct noc_influence_box {
    float lo[3], hi[3];
} noc_influence_box;

/* How strong lights are: how many shine, and the mean of their roots. */
typedef struct noc_influence_mean {
    uint32_t shining;
    double root;
} noc_influence_mean;

/* What building takes time for. Tuning is left out where S_r is given, boxes where none are asked for. */
enum { NOC_STEP_VOLUMES, NOC_STEP_TUNING, NOC_STEP_HIERARCHY, NOC_STEP_BOXES, NOC_INFLUENCE_STEPS };

typedef struct noc_influence {
    uint64_t number;              /* light/set: a pointer may come again once these are gone, this does not */
    uint32_t count;               /* lights of the scene, those without emission too */
    uint32_t stand;               /* of the lights in `ids` those that stand */
    uint32_t listed;              /* lights in `ids` */
    uint32_t shining[NOC_HALVES]; /* of them those that emit something */
    uint32_t volume_count, box_count;
    /* those that stand, then those that move, each in its hierarchy's order; behind the last, one that holds nothing */
    noc_influence_volume *volumes;
    uint32_t *box_of;         /* parallel: the box that a volume shares with volumes near it */
    noc_influence_box *boxes; /* what their lights see, then one that is everywhere; NULL: nothing is in their way */
    float *box_reach;         /* parallel: S_r times the largest root that a box was made for */
    /* volume i has the lights ids[first[i]..first[i + 1]); NULL: one each */
    uint32_t *first;
    uint32_t *ids;
    uint32_t *volume_of; /* a light of the scene */
    noc_influence_half half[NOC_HALVES];
    float scale;             /* S_r for this scene, sqrt(m2 / cd) */
    float usual;             /* median root */
    bool found;              /* S_r, from what the lights emitted then: */
    float found_scale;       /* S_r */
    float found_floor;       /* the rule's */
    float built_usual;       /* median root */
    noc_influence_mean was;  /* of the lights that stand */
    noc_influence_rule rule; /* for it, and for what each point lists */
    size_t bytes;
    double seconds[NOC_INFLUENCE_STEPS]; /* wall seconds that each step of building took */
} noc_influence;

/* A S_r that was set, as volumes take it: 0 stays "found for the scene", and what is too small for a float does not
 * become 0. */
static inline float noc_influence_scale(double set) { return set > 0 ? fmaxf((float)set, FLT_MIN) : 0; }

/* Distances along segments o + t d, t in [0, 1], to what they hit first; 1 where nothing is in their way. Called from
 * several threads. */
enum { NOC_PROBES = 16 };
typedef struct noc_probes {
    _Alignas(64) float o[3][NOC_PROBES], d[3][NOC_PROBES];
    float t[NOC_PROBES];
} noc_probes;
typedef void noc_probe_fn(void *user, noc_probes *probes);

typedef struct noc_influence_params {
    int cluster;         /* at most so many lights share a volume (Algorithm 5); 0, 1: each has its own */
    double scale;        /* S_r that was set, which boxes and shared volumes are for; 0: found for the scene */
    bool boxes;          /* visibility-aware boxes (Algorithm 4): wants a probe */
    noc_probe_fn *probe; /* traces; NULL: S_r is found as if some lights were hidden anywhere */
    void *user;
    noc_pool *pool; /* NULL: the caller's thread alone */
} noc_influence_params;

/* NULL params are those of one volume a light, without boxes. Equal for any number of threads. Returns NULL after
 * reporting that memory was refused. */
noc_influence *noc_influence_create(const noc_scene *scene, const noc_influence_params *params, noc_log *log);
void noc_influence_destroy(noc_influence *influence); /* NULL is allowed */

/* After lights of the moving half have changed in any way: makes that half anew. others: some were added or removed.
 * They have volumes of their own, and no boxes. S_r stays: it is found from what stands, and only where nothing that
 * stands shines from what moves. NOC_ERR_MEMORY after reporting it: then there is nothing left to do with the volumes
 * but to destroy them; so it is with noc_influence_relight.
 *
 * Lights that the standing half is to take in, or to forget, want new volumes altogether. */
noc_status noc_influence_move(noc_influence *influence, const noc_scene *scene, bool others, noc_log *log) NOC_MUST_USE;

/* After lights of the standing half have changed what they emit: sizes and bounds are fitted where they are. Where S_r
 * was found it goes on with the lights: in proportion to 1 / (r sqrt(n)), n of them shining, r the mean of their roots,
 * and the rule's floor to r^2 n, so that a city that is dimmed finds what it found before. Boxes are probed anew where
 * a light reaches further than its box was made for. */
noc_status noc_influence_relight(noc_influence *influence, const noc_scene *scene, const noc_influence_params *params,
                                 noc_log *log) NOC_MUST_USE;

/* Was there no light to find S_r from, and now there is? Then the volumes are to be made anew. */
bool noc_influence_lacks_scale(const noc_influence *influence, const noc_influence_params *params);

/* ---- queries ---- */

/* Numbers that are kept of a volume near a box, each beside the same of the next one. */
enum {
    NOC_NEAR_C,
    NOC_NEAR_SIZE = NOC_NEAR_C + 3,
    NOC_NEAR_M,
    NOC_NEAR_ROOT = NOC_NEAR_M + 3,
    NOC_NEAR_TURN, /* influence_turn */
    NOC_NEAR_ID,   /* the volume's, whole */
    NOC_NEAR_FIELDS
};

/* Volumes near a box. Starts zeroed, and is used again and again. */
typedef struct noc_near {
    float *data;        /* field k of volume i: k * room + i; the next 16 behind the last: root, id 0 */
    size_t room, count; /* room: with 32 that may be written behind the last */
    NOC_ARRAY(noc_influence_node) packs; /* boxes around 16 volumes each, and their largest roots */
    bool no_memory;                      /* for all of them */
} noc_near;
/* Makes room for as many again, or the first. */
bool noc_near_grow(noc_near *near) NOC_MUST_USE;

/* struct near_query of core/influence_points.h */
typedef struct noc_near_query {
    float lo[3], hi[3]; /* box of the points */
    float n[3];         /* normal that they all have, 0: not the same */
    float back;         /* least dot(n, point); -INFINITY where n = 0 */
    float scale;        /* S_r */
    float least;        /* lights that give less lux there are left out; 0: none */
    uint32_t most;      /* stops at more volumes than that */
} noc_near_query;

/* The query of one point p with normal n, of all lights. */
noc_near_query noc_near_point(const float p[3], const float n[3], float scale);

/* Points that ask as one, and what they found. Where S_r was set, the lights whose volumes hold the query; where it is
 * found, those of them that give at least as many lux as the points settled for. */
typedef struct noc_found_group {
    noc_near_query query;
    uint32_t count, from; /* ids[from], ids[from + 1], ... */
} noc_found_group;

/* What the points of a tile found. Starts zeroed, and is used again and again. */
typedef struct noc_found {
    int groups;
    noc_found_group group[1 + NOC_QUERY_BLOCKS * NOC_QUERY_POINTS]; /* the first: points that did not ask */
    uint16_t of[NOC_QUERY_BLOCKS][NOC_QUERY_POINTS];                /* a point's group */
    NOC_ARRAY(uint32_t) ids;
    uint32_t pending[NOC_QUERY_BLOCKS]; /* scratch: points that have not asked yet, as bits */
    noc_near near[2];                   /* scratch: volumes near all points, near a group */
    NOC_ARRAY(uint32_t) looked;         /* scratch: packs that a group looks at */
    NOC_ARRAY(float) gives;             /* scratch: by volume of those, lux; 0: does not hold it */
    noc_influence_bins bins;            /* scratch */
    bool no_memory;                     /* for all that the tile found: it is less */
} noc_found;
void noc_found_free(noc_found *found);

/* How many lights a point of a block found. */
static inline uint32_t noc_found_count(const noc_found *found, int block, int point) {
    return found->group[found->of[block][point]].count;
}

/* Does a query find the light? */
bool noc_influence_finds(const noc_influence *influence, uint32_t light, const noc_near_query *query);

/* influence_obj.c: each volume as a closed body, each box as a box, in OBJ with y up. set: S_r that was set, 0: the one
 * that was found. What cannot be written shows in the file's error flag. */
void noc_influence_write(const noc_influence *influence, const noc_scene *scene, double set, FILE *file);

#endif
