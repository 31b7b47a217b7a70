/* The frame before, of a scene that is edited: see past.h. */
#include "render/past.h"

#include "core/placement.h"

/* ---- instances ---- */

bool noc_placings_reserve(noc_placings *p, const noc_scene *scene) {
    return array_reserve(&p->now, scene->instances.len) && array_reserve(&p->back, scene->instances.len);
}

void noc_placings_free(noc_placings *p) {
    array_free(&p->now);
    array_free(&p->back);
}

/* The way back, in doubles: a transform is a rotation times a scale, so its inverse is its transpose over the square of
 * that. */
static placing_back way_back(const float now[12], const float then[12]) {
    placing_back b = { .known = 1 };
    double scale2 = (double)now[0] * now[0] + (double)now[4] * now[4] + (double)now[8] * now[8];
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            double sum = 0;
            for (int n = 0; n < 3; n++)
                sum += (double)then[4 * i + n] * now[4 * k + n];
            b.rows.m[4 * i + k] = (float)(sum / scale2);
        }
        b.rows.m[4 * i + 3] = then[4 * i + 3];
        b.from[i] = now[4 * i + 3];
    }
    return b;
}

void noc_placings_follow(noc_placings *p, const noc_scene *scene) {
    size_t before = p->now.len;
    uint64_t shape = noc_scene_shape(&scene->versions);
    p->now.len = p->back.len = scene->instances.len;
    for (size_t i = 0; i < p->now.len; i++) {
        const noc_scene_instance *in = &scene->instances.data[i];
        noc_scene_place *place = &p->now.data[i];
        bool was_there = i < before && place->model && place->model == in->model;
        p->back.data[i] = was_there ? way_back(in->transform, place->transform) : (placing_back){ .known = 0 };
        place->model = in->model;
        memcpy(place->transform, in->transform, sizeof(place->transform));
    }
    p->past = p->known ? p->shape : shape;
    p->shape = shape;
    p->known = true;
}

/* The way back of an instance that was there in the frame before; NULL: there is none. */
static const placing_back *back_of(const noc_placings *p, uint32_t instance) {
    const placing_back *b = instance < p->back.len ? &p->back.data[instance] : NULL;
    return b && b->known ? b : NULL;
}

/* Takes lane l of g back. */
static void take_back(const placing_back *b, gblock *g, int l) {
    receiver r = { V3(g->px[l], g->py[l], g->pz[l]), V3(g->nx[l], g->ny[l], g->nz[l]), g->depth[l], g->material[l],
                   g->light[l] };
    r = receiver_back(r, splat3(b->from), placement_of_rows(b->rows));
    g->px[l] = r.p.x;
    g->py[l] = r.p.y;
    g->pz[l] = r.p.z;
    g->nx[l] = r.n.x;
    g->ny[l] = r.n.y;
    g->nz[l] = r.n.z;
}

const gblock *noc_past_surfaces(const noc_past *past, const noc_scene *scene, const noc_placings *placings,
                                const uint32_t instance[BLOCK], const gblock *g, gblock *moved) {
    if (!instance || !noc_past_other_shape(past, scene))
        return g;
    *moved = *g;
    for (int l = 0; l < BLOCK; l++) {
        const placing_back *b = back_of(placings, instance[l]);
        if (b)
            take_back(b, moved, l);
    }
    return moved;
}

uint32_t noc_past_known(const noc_past *past, const noc_scene *scene, const noc_placings *placings,
                        const uint32_t instance[BLOCK]) {
    bool then = placings->past == noc_scene_shape(&past->seen);
    uint32_t known = 0;
    if (!instance || !noc_past_other_shape(past, scene))
        return 0xffff;
    for (int l = 0; l < BLOCK; l++)
        known |= (uint32_t)(instance[l] == NO_INSTANCE || (then && back_of(placings, instance[l]))) << l;
    return known;
}

/* ---- lights ---- */

static bool same_lights(const noc_scene_versions *a, const noc_scene_versions *b) {
    return a->lights == b->lights && a->moved == b->moved && a->emission == b->emission;
}

/* Scenes whose lights have never changed do without a copy. Where one is changed for the first time, the frame before
 * has left none, and its reservoirs are not reused. */
static bool keeps_lights(const noc_scene *scene) {
    const noc_scene_versions *v = &scene->versions;
    return scene->moving.len || v->lights || v->moved || v->emission;
}

size_t noc_past_begin(noc_past *past, const noc_scene *scene, const noc_plan *plan) {
    size_t need = scene->lights.len;
    past->lost = false;
    if (!plan->previous_lights)
        past->filled = false;
    if (!plan->previous_lights || !keeps_lights(scene))
        return 0;
    return need > past->room && past->room ? need + need / 4 : need;
}

void noc_past_check(noc_past *past, const noc_scene *scene, const noc_placings *placings, const noc_plan *plan) {
    const noc_scene_versions *now = &scene->versions, *then = &past->seen;
    past->lost =
        plan->previous_lights && ((!same_lights(now, then) && !past->filled) || now->materials != then->materials ||
                                  (noc_past_other_shape(past, scene) && placings->past != noc_scene_shape(then)));
}

noc_range noc_past_keep(noc_past *past, const noc_scene *scene) {
    static const noc_range none = { 0, 0 };
    noc_scene_versions then = past->seen;
    past->seen = scene->versions;
    if (!past->room || (past->filled && same_lights(&then, &past->seen)))
        return none;
    if (past->room < scene->lights.len) /* this frame's plan asked for none, and more lights came */
        return none;
    bool last = past->filled && then.commits + 1 == past->seen.commits; /* that commit wrote these, and no others */
    past->filled = true;
    return last ? scene->dirty_lights : (noc_range){ 0, scene->lights.len };
}

bool noc_past_other_lights(const noc_past *past, const noc_scene *scene) {
    return past->filled && !same_lights(&past->seen, &scene->versions);
}
