/* Rankings: their life, and rounds of samples until a target is met. */
#include "render/influence.h"

#include <math.h>
#include <stdatomic.h>

static noc_region *sorted(const noc_scene *scene, const noc_region *region) {
    noc_scene_lock_read(scene);
    noc_region *r = noc_region_sorted(region, scene);
    noc_scene_unlock_read(scene);
    return r;
}

/* A class gets samples by its weight, and at least one in so many. */
enum { LEAST_SAMPLES = 32 };

static void share_samples(noc_ranking *r) {
    const noc_scene *scene = r->view->scene;
    size_t n = r->region->patches.len;
    double all = 0, samples = 0;
    noc_scene_lock_read(scene);
    for (size_t i = 0; i < n; i++)
        r->weight[noc_patch_class(&r->region->patches.data[i], scene)] += r->region->patches.data[i].weight;
    for (int c = 0; c < NOC_CLASS_COUNT; c++)
        all += r->weight[c];
    for (int c = 0; c < NOC_CLASS_COUNT; c++) {
        double least = fmax(1, all / (LEAST_SAMPLES * r->weight[c])); /* times as many as its weight wants */
        r->counts[c] = r->weight[c] > 0 ? 1 / least : 0;
        samples += r->weight[c] > 0 ? r->weight[c] * least : 0;
    }
    for (int c = 0; c < NOC_CLASS_COUNT; c++)
        r->counts[c] *= samples / all;
    r->before[0] = 0;
    for (size_t i = 0; i < n; i++) {
        const noc_patch *p = &r->region->patches.data[i];
        r->before[i + 1] = r->before[i] + p->weight / r->counts[noc_patch_class(p, scene)];
    }
    noc_scene_unlock_read(scene);
}

noc_ranking *noc_ranking_create(noc_view *view, const noc_region *region, const noc_ranking_params *params) {
    if (!view || !region) {
        noc_null(view ? view->log : NULL, __func__);
        return NULL;
    }
    if (!region->patches.len) {
        noc_error(view->log, NOC_ERR_ARGUMENT, "influence: the region is empty");
        return NULL;
    }
    const noc_ranking_params defaults = { 0 };
    params = params ? params : &defaults;
    const noc_render_params render = params->render ? *params->render : noc_render_default_params();
    if (noc_render_check(&render, view->log) != NOC_OK)
        return NULL;
    noc_ranking *r = noc_calloc(1, sizeof(*r));
    if (!r || !(r->region = sorted(view->scene, region)) ||
        !(r->before = noc_alloc((r->region->patches.len + 1) * sizeof(*r->before)))) {
        noc_ranking_destroy(r);
        noc_no_memory(view->log, "influence");
        return NULL;
    }
    r->view = view;
    r->params = render;
    r->point = region->patches.len == 1 && noc_patch_is_point(&region->patches.data[0]);
    r->seen = params->eye != NULL;
    r->count_windows = params->count_windows;
    for (int k = 0; k < 3 && params->eye; k++)
        r->eye[k] = (float)params->eye[k];
    share_samples(r);
    return r;
}

static void forget(noc_ranking *r) {
    for (int b = 0; b < RANKING_BATCHES; b++) {
        noc_sums_free(&r->batch[b].sums);
        r->batch[b] = (ranking_batch){ 0 };
    }
    noc_ranking_free_list(&r->list);
    noc_emitters_free(&r->emitters);
    r->started = false;
    r->rounds = 0;
}

void noc_ranking_destroy(noc_ranking *r) {
    if (!r)
        return;
    forget(r);
    noc_region_destroy(r->region);
    free(r->before);
    free(r);
}

/* What all rounds of this commit need. */
static noc_status start(noc_ranking *r, const noc_asking *by) {
    if (r->rounds)
        r->restarts++;
    forget(r);
    noc_make_frame_constants(&r->params, 0, false, &r->frame);
    noc_make_frame_environment(r->view->scene, &r->params, &r->frame);
    if (!noc_emitters_make(r->view->scene, &r->emitters))
        return noc_no_memory(r->view->log, "influence");
    noc_status status = r->point ? noc_ranking_list(r, by) : NOC_OK;
    r->started = status == NOC_OK;
    r->commit = r->view->scene->versions.commits;
    r->lights = r->view->scene->versions.lights;
    return status;
}

typedef struct round_run {
    noc_ranking *r;
    const noc_asking *by;
} round_run;

static void draw(void *ctx, size_t item, int worker) {
    const round_run *run = ctx;
    (void)worker;
    noc_ranking_draw(run->r, run->by, (int)item);
}

/* One round of all batches. A batch that was refused memory has lost some of what it found. */
static noc_status add_round(noc_ranking *r) {
    noc_view *v = r->view;
    noc_asking by;
    noc_scene_lock_frame(v->scene);
    noc_status status = v->backend->ask(v->state, &r->params, !r->point, &by);
    if (status == NOC_OK && (!r->started || r->commit != v->scene->versions.commits))
        status = start(r, &by);
    if (status == NOC_OK) {
        round_run run = { r, &by };
        noc_pool_run(by.pool, RANKING_BATCHES, draw, &run);
        r->rounds++;
    }
    noc_scene_unlock_frame(v->scene);
    bool refused = false;
    for (int b = 0; b < RANKING_BATCHES; b++)
        refused = refused || r->batch[b].refused;
    if (!refused)
        return status;
    forget(r);
    return noc_no_memory(v->log, "influence");
}

static uint64_t rays_of(const noc_ranking *r) {
    uint64_t rays = 0;
    for (int b = 0; b < RANKING_BATCHES; b++)
        rays += r->batch[b].rays;
    return rays;
}

/* How near the target is, 0 to 1; 1: it is met. Looks at errors only now and then, for it looks at all emitters. */
static noc_status nearness(const noc_ranking *r, const noc_ranking_target *t, double began, uint64_t *look,
                           double *near) {
    if (t->seconds > 0)
        *near = fmax(*near, (noc_wall_seconds() - began) / t->seconds);
    if (t->rays > 0)
        *near = fmax(*near, (double)rays_of(r) / (double)t->rays);
    if (!(t->seconds > 0) && !t->rays && !(t->error > 0))
        *near = 1;
    if (!(t->error > 0) || r->rounds < *look)
        return NOC_OK;
    double error; /* 0 where nothing lights it: there is no more to be known */
    noc_status status = noc_ranking_error(r, &error);
    *look = r->rounds + NOC_MAX(1, r->rounds / 8);
    if (status == NOC_OK)
        *near = fmax(*near, fmin(1, t->error * t->error / fmax(error * error, 1e-300)));
    return status;
}

noc_status noc_ranking_refine(noc_ranking *r, const noc_ranking_target *target, const noc_progress *progress) {
    if (!r)
        return NOC_ERR_ARGUMENT;
    const noc_ranking_target once = { 0 };
    double began = noc_wall_seconds(), near = 0;
    uint64_t look = 0;
    noc_status status = NOC_OK;
    target = target ? target : &once;
    do {
        if (progress && progress->update && !progress->update(progress->user, "asking who lights it", near))
            status = noc_cancelled(r->view->log, "influence: cancelled");
        if (status == NOC_OK)
            status = add_round(r);
        if (status == NOC_OK)
            status = nearness(r, target, began, &look, &near);
    } while (status == NOC_OK && near < 1);
    r->seconds += noc_wall_seconds() - began;
    return status;
}
