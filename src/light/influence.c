/* Point queries of influence volumes, but for the search itself: backend/cpu/influence_near_tmpl.h. */
#include "light/influence.h"

#include "core/influence.h"

void noc_influence_destroy(noc_influence *v) {
    if (!v)
        return;
    for (int i = 0; i < NOC_HALVES; i++)
        free(v->half[i].nodes);
    free(v->volumes);
    free(v->boxes);
    free(v->box_of);
    free(v->box_reach);
    free(v->first);
    free(v->ids);
    free(v->volume_of);
    free(v);
}

/* ---- boxes of points ---- */

noc_near_query noc_near_none(float scale, uint32_t most) {
    return (noc_near_query){ .lo = { INFINITY, INFINITY, INFINITY },
                             .hi = { -INFINITY, -INFINITY, -INFINITY },
                             .back = INFINITY,
                             .scale = scale,
                             .most = most };
}

void noc_near_add(noc_near_query *q, const float *const p[3], const float *const n[3], uint32_t lanes) {
    for (uint32_t bits = lanes; bits; bits &= bits - 1) {
        int l = __builtin_ctz(bits);
        bool first = q->lo[0] > q->hi[0], same = true;
        for (int k = 0; k < 3; k++) {
            if (first)
                q->n[k] = n[k][l];
            same = same && fabsf(q->n[k] - n[k][l]) <= NOC_SAME_NORMAL;
            q->lo[k] = NOC_MIN(q->lo[k], p[k][l]);
            q->hi[k] = NOC_MAX(q->hi[k], p[k][l]);
        }
        if (!same) {
            memset(q->n, 0, sizeof(q->n));
            q->back = -INFINITY;
        }
        q->back = NOC_MIN(q->back, q->n[0] * p[0][l] + q->n[1] * p[1][l] + q->n[2] * p[2][l]);
    }
}

void noc_found_free(noc_found *f) {
    array_free(&f->ids);
    array_free(&f->near[0].groups);
    array_free(&f->near[1].groups);
    array_free(&f->gives);
}

bool noc_influence_finds(const noc_influence *v, uint32_t light, const noc_near_query *q) {
    influence a;
    uint32_t volume = v->volume_of[light];
    influence_region r = influence_box(V3(q->lo[0], q->lo[1], q->lo[2]), V3(q->hi[0], q->hi[1], q->hi[2]),
                                       V3(q->n[0], q->n[1], q->n[2]), q->back);
    memcpy(&a, &v->volumes[volume], sizeof(a));
    if (!influence_holds(a, r, q->scale) || (q->least > 0 && !(influence_gives(a, influence_turn(a), r) >= q->least)))
        return false;
    if (!v->boxes)
        return true;
    const noc_influence_box *b = &v->boxes[v->box_of[volume]];
    return influence_meets(V3(b->lo[0], b->lo[1], b->lo[2]), V3(b->hi[0], b->hi[1], b->hi[2]), r);
}
