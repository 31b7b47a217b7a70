/* Point queries of influence volumes, but for the search itself: core/influence_find.h. */
#include "light/influence.h"

#include "core/influence_points.h"

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

noc_near_query noc_near_point(const float p[3], const float n[3], float scale) {
    near_query have =
        near_add_point(near_none(scale, 0, NEAR_NO_LIMIT), (f3){ p[0], p[1], p[2] }, (f3){ n[0], n[1], n[2] });
    noc_near_query q;
    _Static_assert(sizeof(q) == sizeof(have), "records are core's");
    memcpy(&q, &have, sizeof(q));
    return q;
}

void noc_found_free(noc_found *f) {
    array_free(&f->ids);
    for (int i = 0; i < 2; i++) {
        free(f->near[i].data);
        array_free(&f->near[i].packs);
    }
    array_free(&f->looked);
    array_free(&f->gives);
}

bool noc_near_grow(noc_near *n) {
    size_t room = n->room ? 2 * n->room : 1040; /* a power of two, and fields would fight for lines of the cache */
    float *data = noc_alloc_large(room * NOC_NEAR_FIELDS, sizeof(*data));
    if (!data)
        return false;
    for (size_t k = 0; k < NOC_NEAR_FIELDS && n->data; k++)
        memcpy(data + k * room, n->data + k * n->room, n->count * sizeof(*data));
    free(n->data);
    n->data = data;
    n->room = room;
    return true;
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
