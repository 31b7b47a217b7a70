/* The lights that could shine on a single point: all of them are looked at once. */
#include "render/influence.h"

#include "light/bound.h"
#include "render/influence_core.h"

#include <math.h>

enum { CHUNK = 4096 };

typedef struct listing {
    const noc_ranking *r;
    struct core_context core;
    float *weight; /* [lights of the scene] */
} listing;

/* What the light could bring: what its middle would, and at least a part of what it could at best; 0 only where it can
 * bring nothing. A point's or spot's middle is all of it. */
static float weight_of(const struct core_context *ctx, const noc_light_record *record, v3 p, v3 n) {
    light l = light_of_record(*record);
    float lux = light_lux(shining_sample(ctx, l, p, 0.5f, 0.5f), n);
    if (record->kind >= LIGHT_POINT)
        return lux;
    noc_light_bound b = noc_bound_light(record);
    v3 d = sub3(splat3(b.p), p);
    float d2 = dot3(d, d), slack = b.radius * 1.05f + 1e-4f * sqrtf(d2) + 1e-6f;
    bool before = dot3(n, d) > -slack;
    bool faces = dot3(splat3(b.n), splat3(b.n)) < 0.5f || dot3(splat3(b.n), d) < slack;
    float most = b.intensity / fmaxf(d2, fmaxf(0.25f * b.radius * b.radius, 1e-4f));
    return before && faces && most > 0 && most < 1e30f ? fmaxf(lux, 0.02f * most) : 0;
}

static void weigh(void *ctx, size_t item, int worker) {
    const listing *l = ctx;
    const noc_scene *scene = l->r->view->scene;
    const noc_patch *y = &l->r->region->patches.data[0];
    size_t end = NOC_MIN((item + 1) * CHUNK, scene->lights.len);
    (void)worker;
    for (size_t i = item * CHUNK; i < end; i++) {
        const noc_light_record *record = &scene->lights.data[i];
        bool dark = record->flags & NOC_LIGHT_FREE || !(record->e[0] > 0 || record->e[1] > 0 || record->e[2] > 0);
        l->weight[i] = dark ? 0 : weight_of(&l->core, record, splat3(y->p), splat3(y->n));
    }
}

static double expected(double weight, double all) { return RANKING_LIST * weight / all; }

/* First those that are sure of a ray, then the others; each in the order of the scene. */
static bool share_out(ranking_list *list, const float *weight, size_t count) {
    double all = 0, rest = 0;
    size_t some = 0;
    for (size_t i = 0; i < count; i++) {
        all += weight[i];
        some += weight[i] > 0;
    }
    if (!array_reserve(&list->lights, some) || !array_reserve(&list->turns, RANKING_LIST) ||
        !array_reserve(&list->before, some + 1))
        return false;
    for (size_t i = 0; i < count; i++)
        if (weight[i] > 0 && expected(weight[i], all) >= 1) {
            list->lights.data[list->lights.len++] = (ranking_light){ (uint32_t)i, weight[i] };
            list->turns.data[list->turns.len++] = (int)ceil(expected(weight[i], all));
        }
    list->certain = list->lights.len;
    for (size_t i = 0; i < count; i++)
        if (weight[i] > 0 && expected(weight[i], all) < 1) {
            list->lights.data[list->lights.len++] = (ranking_light){ (uint32_t)i, weight[i] };
            list->before.data[list->before.len++] = rest;
            rest += weight[i];
        }
    list->before.data[list->before.len++] = rest;
    list->draws = rest > 0 ? NOC_MAX(16, (int)ceil(expected(rest, all))) : 0;
    return true;
}

noc_status noc_ranking_list(noc_ranking *r, const noc_asking *by) {
    const noc_scene *scene = r->view->scene;
    size_t count = scene->lights.len;
    listing l = { r,
                  { .frame = &r->frame, .lights = scene->lights.data, .profiles = scene->profile_cells.data },
                  noc_alloc(NOC_MAX(count, 1) * sizeof(float)) };
    noc_ranking_free_list(&r->list);
    if (l.weight)
        noc_pool_run(by->pool, (count + CHUNK - 1) / CHUNK, weigh, &l);
    bool ok = l.weight && share_out(&r->list, l.weight, count);
    free(l.weight);
    return ok ? NOC_OK : noc_no_memory(r->view->log, "influence");
}

void noc_ranking_free_list(ranking_list *list) {
    array_free(&list->lights);
    array_free(&list->before);
    array_free(&list->turns);
    *list = (ranking_list){ 0 };
}
