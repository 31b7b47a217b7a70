/* What the files of a ranking (nocturne/influence.h) hand on to each other. Definitions and why they are unbiased:
 * docs/estimator.md, "Who lights this". */
#ifndef NOC_RENDER_INFLUENCE_H
#define NOC_RENDER_INFLUENCE_H

#include "render/view.h"
#include "scene/emitters.h"
#include "scene/region.h"

enum {
    RANKING_BATCHES = 64, /* independent estimates, whose spread tells the standard error */
    RANKING_POINTS = 32,  /* of a region, a batch and round */
    RANKING_DRAWS = 64,   /* of a light tree, a point of a region */
    RANKING_RAYS = 16,    /* over them */
    RANKING_LIST = 128    /* rays over all lights, a batch and round at a single point */
};

/* What emitters brought, by their numbers: open addressing. */
typedef struct ranking_sums {
    uint32_t *emitter; /* NOC_NO_EMITTER: free */
    double *value;     /* lx, summed over samples */
    size_t len, cap;   /* a power of two */
} ranking_sums;

/* What brings light: the kinds of emitters, and the sky. */
enum { RANKING_SKY = NOC_EMITTER_KIND_COUNT, RANKING_PARTS };

typedef struct ranking_batch {
    ranking_sums sums;
    double lux[RANKING_PARTS][NOC_CLASS_COUNT]; /* sums over samples, by what brings it and the surface's class */
    double luminance[2];                        /* by windows [1], and by all else */
    double points[NOC_CLASS_COUNT];             /* number of samples of each class, weighted by noc_ranking.counts */
    uint64_t rays;
    bool refused; /* memory */
} ranking_batch;

/* A light that could shine on the point. */
typedef struct ranking_light {
    uint32_t light;
    float weight; /* what it could bring, about, lx; never 0 where it might bring anything */
} ranking_light;

/* At a single point: all lights that could shine on it. The first `certain` are looked at in each round, by so many
 * rays each; of the rest some are drawn. */
typedef struct ranking_list {
    NOC_ARRAY(ranking_light) lights;
    NOC_ARRAY(double) before; /* weights of the rest before each of them; one more at the end */
    NOC_ARRAY(int) turns;     /* rays to each of the certain ones */
    size_t certain;
    int draws; /* from the rest */
} ranking_list;

struct noc_ranking {
    noc_view *view;
    noc_region *region; /* sorted */
    double *before; /* [patches + 1] samples that fall before each of them, in the mean, in units of their weights */
    double weight[NOC_CLASS_COUNT]; /* of the patches of each class */
    double counts[NOC_CLASS_COUNT]; /* what a sample of each class counts: its weight over its samples */
    bool point;
    noc_render_params params;
    bool seen;          /* somebody's luminance is asked for */
    bool count_windows; /* noc_ranking_params */
    float eye[3];
    frame_constants frame;
    noc_emitters emitters;
    ranking_list list;
    bool started;                    /* what follows is of commit */
    uint64_t commit, lights, rounds; /* lights: those that were added and removed until then */
    ranking_batch batch[RANKING_BATCHES];
    double seconds;
    uint64_t restarts;
};

/* influence_list.c: the lights of a single point. The scene is held. */
noc_status noc_ranking_list(noc_ranking *r, const noc_asking *by);
void noc_ranking_free_list(ranking_list *list);

/* influence_draw.c: one more round of a batch, by any thread. */
void noc_ranking_draw(noc_ranking *r, const noc_asking *by, int batch);

/* influence_sums.c */
bool noc_sums_add(ranking_sums *sums, uint32_t emitter, double value) NOC_MUST_USE;
double noc_sums_get(const ranking_sums *sums, uint32_t emitter);
void noc_sums_free(ranking_sums *sums);
/* The greater of the relative standard errors of the lux and of the greatest share; 0: nothing lights the region. */
noc_status noc_ranking_error(const noc_ranking *r, double *error);

#endif
