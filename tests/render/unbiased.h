/* Means of independent short runs against the reference, in every tile and over the whole picture, at some frames of a
 * run. */
#ifndef NOC_TEST_UNBIASED_H
#define NOC_TEST_UNBIASED_H

#include "rooms.h"
#include "../own_view.h"

enum { W = 24, H = 16, TILE = 8, TILES = (W / TILE) * (H / TILE), FRAMES = 6, CHECKS = 3 };
static const int check_at[CHECKS] = { 1, 3, 6 };

typedef struct {
    double sum[TILES + 1], square[TILES + 1];
    size_t n;
} moments;

/* rgb: three a pixel, whose luminance counts; else one, below 0 where there is none. */
static inline void add_values(moments *m, const float *value, bool rgb) {
    double tile[TILES + 1] = { 0 };
    for (int y = 0; y < H; y++)
        for (int x = 0; x < W; x++) {
            double v = rgb ? luma(value + 3 * (y * W + x)) : fmax(value[y * W + x], 0);
            tile[y / TILE * (W / TILE) + x / TILE] += v / (TILE * TILE);
            tile[TILES] += v / (W * H);
        }
    for (int t = 0; t <= TILES; t++) {
        m->sum[t] += tile[t];
        m->square[t] += tile[t] * tile[t];
    }
    m->n++;
}

static inline void add_picture(moments *m, noc_view *r) {
    noc_image *image = noc_view_image(r);
    add_values(m, image->rgb, true);
    noc_image_destroy(image);
}

/* What the surfaces are lit with, in the picture's place. */
static inline void add_illuminance(moments *m, noc_view *r) {
    noc_channel *lux = noc_view_aov(r, NOC_AOV_ILLUMINANCE);
    assert_non_null(lux);
    add_values(m, lux->value, false);
    noc_channel_destroy(lux);
}

static inline double mean_of(const moments *m, int t) { return m->sum[t] / (double)m->n; }
static inline double error_of(const moments *m, int t) {
    double mean = mean_of(m, t);
    return sqrt(fmax(m->square[t] / (double)m->n - mean * mean, 0) / (double)m->n);
}

/* ---- comparison ---- */

static inline noc_camera camera_at(int frame, bool moving) {
    double t = moving ? 0.35 * frame : 0;
    return look(2 + t, -11 + 0.3 * t, 4.5, 0.5 + 0.5 * t, 0, 1, 62);
}

typedef struct config {
    const char *name;
    noc_method method;
    noc_bias bias;
    bool temporal, spatial, rays, reuse;
    int passes, neighbours;
    int list;              /* > 0: lists of so many lights and as many draws from the rest */
    noc_candidates picker; /* list = 0 */
    noc_influence_boxes boxes;
    double influence; /* influence: S_r; 0: found */
    int share;        /* influence: lights a volume; 0: 1 */
    int times;        /* so many times the runs, where rare draws from all lights are worth much; 0: 1 */
    int shadow_rays;  /* ris with lists; 0: the default */
    bool unlearned;
    bool lux; /* of the illuminance */
} config;

static inline noc_render_params params_of(const config *c, uint32_t seed) {
    noc_render_params p = measure(W, H, c->method);
    p.seed = seed;
    p.draws = 8;
    p.candidates = c->list ? NOC_CANDIDATES_LISTS : c->picker;
    p.list = c->list;
    p.influence_boxes = c->boxes;
    p.influence = c->influence;
    p.influence_cluster = c->share ? c->share : 1;
    p.shadow_rays = c->shadow_rays ? c->shadow_rays : p.shadow_rays;
    p.learn = !c->unlearned;
    p.tail = c->list ? c->list : 1;
    p.accumulate = false;
    p.aovs = c->lux ? 1u << NOC_AOV_ILLUMINANCE : 0;
    p.emitters = false; /* the same in all methods, and much brighter than what they differ in */
    p.bias = c->bias;
    p.temporal = c->temporal;
    p.spatial = c->spatial;
    p.bias_rays = c->rays;
    p.visibility_reuse = c->reuse;
    p.passes = c->passes ? c->passes : 1;
    p.neighbours = c->neighbours ? c->neighbours : 3;
    p.radius = 5;
    p.history = 8;
    /* neighbours that differ much: what is hardest on the combination's weights */
    p.reject_normal = 0.2;
    p.reject_depth = 0.5;
    return p;
}

typedef struct result {
    moments at[CHECKS];
} result;

/* Moves a scene's lights to where they are in a frame. */
typedef void (*pose_fn)(noc_scene *s, int frame);

/* Does a frame depend on those before it? */
static inline bool remembers(const config *c) { return c->method == NOC_METHOD_RESTIR || c->list; }

/* moving: the camera; pose: NULL if no light moves. Frames that nothing depends on are not made. */
static inline result measure_runs(noc_scene *s, const config *c, bool moving, pose_fn pose, int runs) {
    result out = { 0 };
    noc_view *r = own_view(s, 2, NULL);
    assert_non_null(r);
    for (int run = 0; run < runs; run++) {
        noc_render_params p = params_of(c, (uint32_t)run * 7919 + 17);
        noc_view_reset(r);
        for (int f = 1, at = 0; f <= FRAMES; f++) {
            if (f != check_at[at] && !remembers(c))
                continue;
            noc_camera cam = camera_at(f, moving);
            if (pose)
                pose(s, f);
            assert_int_equal(noc_view_render(r, &cam, &p, NULL), NOC_OK);
            if (f != check_at[at])
                continue;
            (c->lux ? add_illuminance : add_picture)(&out.at[at++], r);
        }
    }
    noc_frame_stats stats;
    noc_view_get_stats(r, &stats);
    assert_int_equal(stats.dropped, 0);
    close_view(r);
    return out;
}

static inline result measure_reference_of(noc_scene *s, bool moving, pose_fn pose, int frames, bool lux) {
    result out = { 0 };
    noc_view *r = own_view(s, 2, NULL);
    config c = { .method = NOC_METHOD_REFERENCE, .lux = lux };
    noc_render_params p = params_of(&c, 99);
    p.rays = 32;
    for (int at = 0; at < CHECKS; at++) {
        if (!moving && !pose && at) {
            out.at[at] = out.at[0];
            continue;
        }
        noc_camera cam = camera_at(check_at[at], moving);
        if (pose)
            pose(s, check_at[at]);
        for (int f = 0; f < frames; f++) {
            assert_int_equal(noc_view_render(r, &cam, &p, NULL), NOC_OK);
            (lux ? add_illuminance : add_picture)(&out.at[at], r);
        }
    }
    close_view(r);
    return out;
}

static inline result measure_reference(noc_scene *s, bool moving, pose_fn pose, int frames) {
    return measure_reference_of(s, moving, pose, frames, false);
}

/* Largest distance in standard errors over tiles, picture and checked frames. Of few samples the errors say nothing. */
static inline double worst(const char *name, const result *x, const result *reference) {
    double z = 0;
    for (int at = 0; at < CHECKS; at++)
        for (int t = 0; t <= TILES; t++) {
            double d = mean_of(&x->at[at], t) - mean_of(&reference->at[at], t);
            double e = hypot(error_of(&x->at[at], t), error_of(&reference->at[at], t));
            if (mean_of(&reference->at[at], t) > 0)
                z = fmax(z, fabs(d) / fmax(e, 1e-7 * mean_of(&reference->at[at], t)));
        }
    double r = mean_of(&reference->at[CHECKS - 1], TILES);
    print_message("# %-46s %6.2f standard errors, %+.2f%% +- %.2f%% of the last picture\n", name, z,
                  100 * (mean_of(&x->at[CHECKS - 1], TILES) / r - 1), 100 * error_of(&x->at[CHECKS - 1], TILES) / r);
    return z;
}

/* Is it the reference's mean? */
static inline bool agrees(const char *name, const result *x, const result *reference) {
    double z = worst(name, x, reference);
    return SANITIZED ? isfinite(z) : z < 4;
}

#endif
