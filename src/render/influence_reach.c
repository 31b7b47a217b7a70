/* The region that a lamp lights: rays that leave it in all directions, and what they meet. Each stands for an equal
 * part of all directions; docs/estimator.md, "What a lamp lights". */
#include "render/influence.h"

#include "light/bound.h"
#include "render/influence_core.h"

#include <math.h>

enum { MOST_LIGHTS = 16, PIECE = 4096 }; /* lights of an emitter that rays leave from; rays at once */

#define GOLDEN_TURN 2.39996322972865332 /* radians: of the golden section of a turn */

/* Light that an object gets. */
typedef struct got {
    double lumens;
    uint32_t object; /* UINT32_MAX: free */
    noc_class cls;
} got;

typedef struct reaching {
    noc_view *view;
    const noc_reach_params *params;
    struct core_context core;
    uint32_t lights[MOST_LIGHTS];
    size_t count;
    double scale;     /* flux of all its lights over that of those */
    double angle;     /* sr, of a ray */
    double centre[3]; /* of the light that they leave */
    noc_reach *out;
    NOC_ARRAY(got) objects;
} reaching;

/* What its lights bring there, were nothing between. */
static double lux_at(const reaching *r, const noc_hit *h) {
    const struct core_context *ctx = &r->core;
    v3 p = V3((float)h->place[0], (float)h->place[1], (float)h->place[2]);
    v3 n = V3((float)h->normal[0], (float)h->normal[1], (float)h->normal[2]);
    double lux = 0;
    for (size_t i = 0; i < r->count; i++)
        lux += light_lux(shining_sample(ctx, light_load(ctx, r->lights[i]), p, 0.5f, 0.5f), n);
    return lux * r->scale;
}

static bool give(reaching *r, const noc_hit *h, double lumens) {
    for (size_t i = 0; i < r->objects.len; i++)
        if (r->objects.data[i].object == (uint32_t)h->object) {
            r->objects.data[i].lumens += lumens;
            return true;
        }
    return array_push(&r->objects, (got){ lumens, (uint32_t)h->object, h->cls });
}

/* A ray that meets a surface at r m under the angle t to its normal stands for r^2 angle / cos t of it. */
static bool take(reaching *r, const noc_ray *ray, const noc_hit *h) {
    noc_reach *o = r->out;
    double cosine = 0, d2 = 0;
    for (int k = 0; k < 3; k++) {
        cosine -= ray->direction[k] * h->normal[k];
        d2 += (h->place[k] - r->centre[k]) * (h->place[k] - r->centre[k]);
    }
    if (!h->hit || !(cosine > 1e-6))
        return true;
    double lux = lux_at(r, h), area = d2 * r->angle / cosine / (double)r->count;
    if (h->cls == NOC_CLASS_LAMP || !(lux > 0))
        return true;
    if (lux >= r->params->area_lux)
        o->area += area;
    if (lux >= r->params->far_lux && d2 > o->far * o->far) {
        o->far = sqrt(d2);
        memcpy(o->far_place, h->place, sizeof(o->far_place));
    }
    if (lux > o->most) {
        o->most = lux;
        memcpy(o->most_place, h->place, sizeof(o->most_place));
    }
    o->met += lux * area;
    return give(r, h, lux * area);
}

static noc_status send(reaching *r, uint32_t light_index, size_t first, size_t count, size_t all, noc_ray *rays,
                       noc_hit *hits) {
    const noc_light_record *l = &r->core.lights[light_index];
    bool flat = l->kind == NOC_LIGHT_TRIANGLE || l->kind == NOC_LIGHT_PARALLELOGRAM;
    for (int k = 0; k < 3; k++)
        r->centre[k] = l->p[k] + (flat ? 0.5 * ((double)l->a[k] + l->b[k]) : 0);
    for (size_t i = 0; i < count; i++) {
        double z = 1 - (2 * (double)(first + i) + 1) / (double)all, across = sqrt(fmax(1 - z * z, 0));
        double turn = GOLDEN_TURN * (double)(first + i);
        float d[3] = { (float)(across * cos(turn)), (float)(across * sin(turn)), (float)z }, o[3];
        noc_light_leave(l, d, 0.5f, 0.5f, o);
        rays[i] = (noc_ray){ .far = INFINITY };
        for (int k = 0; k < 3; k++) {
            rays[i].origin[k] = o[k];
            rays[i].direction[k] = d[k];
        }
    }
    noc_status status = r->view->backend->cast(r->view->state, rays, count, hits);
    for (size_t i = 0; i < count && !status; i++)
        if (!take(r, &rays[i], &hits[i]))
            status = noc_no_memory(r->view->log, "influence");
    return status;
}

static noc_status reach_from_all(reaching *r) {
    noc_ray *rays = noc_alloc(PIECE * sizeof(*rays));
    noc_hit *hits = noc_alloc(PIECE * sizeof(*hits));
    size_t all = (size_t)r->params->rays;
    noc_status status = rays && hits ? NOC_OK : noc_no_memory(r->view->log, "influence");
    r->angle = 4 * M_PI / (double)all;
    for (size_t i = 0; i < r->count && !status; i++)
        for (size_t first = 0; first < all && !status; first += PIECE)
            status = send(r, r->lights[i], first, NOC_MIN((size_t)PIECE, all - first), all, rays, hits);
    free(rays);
    free(hits);
    return status;
}

static int most_first(const void *a, const void *b) {
    const got *x = a, *y = b;
    if (x->lumens != y->lumens)
        return x->lumens > y->lumens ? -1 : 1;
    return x->object < y->object ? -1 : x->object > y->object;
}

static void fill_objects(const reaching *r, noc_reach_object *objects, size_t count) {
    const noc_scene *s = r->view->scene;
    if (r->objects.len)
        qsort(r->objects.data, r->objects.len, sizeof(got), most_first);
    for (size_t i = 0; i < count && i < r->objects.len; i++) {
        const got *g = &r->objects.data[i];
        const char *name = g->object < s->meshes.len ? s->meshes.data[g->object].name : NULL;
        objects[i] = (noc_reach_object){ name ? name : "", g->cls, g->object, g->lumens };
    }
}

/* Of many lights some, evenly among them, stand for all. */
static void choose(reaching *r, const noc_emitters *emitters, uint32_t emitter) {
    const noc_scene *s = r->view->scene;
    size_t all = emitters->all.data[emitter].count, most = NOC_MIN(all, (size_t)MOST_LIGHTS), n = 0;
    double chosen = 0;
    for (uint32_t i = 0; i < s->lights.len && r->count < most; i++)
        if (emitters->of[i] == emitter && n++ == r->count * all / most) {
            r->lights[r->count++] = i;
            chosen += noc_light_flux(&s->lights.data[i]);
        }
    r->scale = chosen > 0 ? emitters->all.data[emitter].lumens / chosen : 1;
}

static noc_status start(reaching *r, size_t light_index, noc_emitters *emitters) {
    const noc_scene *s = r->view->scene;
    if (light_index >= s->lights.len || s->lights.data[light_index].flags & NOC_LIGHT_FREE)
        return noc_error(r->view->log, NOC_ERR_ARGUMENT, "influence: there is no light %zu", light_index);
    if (!noc_emitters_make(s, emitters))
        return noc_no_memory(r->view->log, "influence");
    uint32_t emitter = emitters->of[light_index];
    noc_emitter_describe(s, emitters, emitter, &r->out->emitter);
    choose(r, emitters, emitter);
    noc_asking by;
    r->core = (struct core_context){ .lights = s->lights.data, .profiles = s->profile_cells.data };
    return r->view->backend->ask(r->view->state, &(noc_render_params){ 0 }, false, &by);
}

noc_status noc_view_reach(noc_view *view, size_t light_index, const noc_reach_params *params, noc_reach *out,
                          noc_reach_object *objects, size_t count, size_t *found) {
    if (!view || !out || (count && !objects))
        return noc_null(view ? view->log : NULL, __func__);
    const noc_reach_params defaults = noc_reach_default_params();
    params = params ? params : &defaults;
    if (params->rays < 1 || params->rays > 1 << 24 || !(params->area_lux > 0) || !(params->far_lux > 0))
        return noc_error(view->log, NOC_ERR_ARGUMENT, "influence: rays must be in 1..%d, illuminances above 0",
                         1 << 24);
    reaching r = { .view = view, .params = params, .out = out };
    noc_emitters emitters = { 0 };
    *out = (noc_reach){ 0 };
    noc_scene_lock_frame(view->scene);
    noc_status status = start(&r, light_index, &emitters);
    status = status ? status : reach_from_all(&r);
    if (!status)
        fill_objects(&r, objects, count);
    noc_scene_unlock_frame(view->scene);
    if (found)
        *found = status ? 0 : NOC_MIN(count, r.objects.len);
    out->objects = r.objects.len;
    array_free(&r.objects);
    noc_emitters_free(&emitters);
    return status;
}
