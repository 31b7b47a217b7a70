/* Triangles that are split, seen from above, until they follow heights. */
#include "city/drape.h"

#include <math.h>

#define QUARTERS 16.0 /* m: of longer edges the quarters are asked for, too */
enum { PIECES = 5, /* looked at, for each triangle that is allowed */ DEEPEST = 24, AT_ONCE = 4096 };

bool drape_is_full(const drape *d) { return d->index.len / 3 >= d->most || d->pieces / PIECES >= d->most; }

/* Beyond what the scene has there is no ground. */
static bool is_outside(const drape *d, const drape_piece *p) {
    bool outside = false;
    for (int k = 0; k < 2; k++) {
        double lo = fmin(fmin(p->c[0].xyz[k], p->c[1].xyz[k]), p->c[2].xyz[k]);
        double hi = fmax(fmax(p->c[0].xyz[k], p->c[1].xyz[k]), p->c[2].xyz[k]);
        outside = outside || hi < d->scene->bounds_min[k] || lo > d->scene->bounds_max[k];
    }
    return outside;
}

static drape_corner on_ground(const drape *d, double x, double y) {
    return (drape_corner){ { x, y, d->height(d->user, x, y) } };
}

/* How far the heights lie off an edge, at a share of the way. NaN: there are none. */
static double off_at(const drape *d, const double *from, const double *to, double t) {
    double at[3];
    for (int k = 0; k < 3; k++)
        at[k] = from[k] + (to[k] - from[k]) * t;
    return fabs(d->height(d->user, at[0], at[1]) - at[2]);
}

/* An edge is split by what lies between its two ends alone, so that triangles on both sides of it agree. */
static bool splits(const drape *d, const drape_corner *a, const drape_corner *b, drape_corner *middle) {
    const double *from = a->xyz, *to = b->xyz;
    bool turned = from[0] > to[0] || (from[0] == to[0] && from[1] > to[1]); /* the same numbers both ways */
    if (turned) {
        from = b->xyz;
        to = a->xyz;
    }
    double length = hypot(to[0] - from[0], to[1] - from[1]);
    *middle = on_ground(d, (from[0] + to[0]) / 2, (from[1] + to[1]) / 2);
    if (length < d->shortest)
        return false;
    double off = middle->xyz[2] - (from[2] + to[2]) / 2;
    if (length > d->longest || !(fabs(off) < d->flat))
        return true;
    return length > QUARTERS && !(off_at(d, from, to, 0.25) < d->flat && off_at(d, from, to, 0.75) < d->flat);
}

static void keep(drape *d, const drape_piece *p) {
    for (int i = 0; i < 3; i++)
        if (!isfinite(p->c[i].xyz[2]))
            return;
    uint32_t first = (uint32_t)(d->position.len / 3);
    for (int i = 0; i < 3; i++) {
        const double at[3] = { p->c[i].xyz[0], p->c[i].xyz[1], p->c[i].xyz[2] + d->lift };
        d->no_memory =
            !array_append(&d->position, at, (size_t)3) || !array_push(&d->index, first + (uint32_t)i) || d->no_memory;
    }
}

/* In two, three or four, as edges split. */
static void take(drape *d, const drape_piece *p) {
    drape_corner m[3];
    bool split[3];
    int count = 0;
    d->pieces++;
    if (is_outside(d, p))
        return;
    for (int i = 0; i < 3; i++)
        count += split[i] = p->depth < DEEPEST && splits(d, &p->c[i], &p->c[(i + 1) % 3], &m[i]);
    if (!count) {
        keep(d, p);
        return;
    }
    int depth = p->depth + 1, i = 0;
    drape_piece out[4];
    if (count == 3) {
        out[0] = (drape_piece){ { p->c[0], m[0], m[2] }, depth };
        out[1] = (drape_piece){ { p->c[1], m[1], m[0] }, depth };
        out[2] = (drape_piece){ { p->c[2], m[2], m[1] }, depth };
        out[3] = (drape_piece){ { m[0], m[1], m[2] }, depth };
    } else if (count == 2) {
        while (split[i])
            i++; /* the edge that stays */
        const drape_corner *a = &p->c[i], *b = &p->c[(i + 1) % 3], *c = &p->c[(i + 2) % 3], *bc = &m[(i + 1) % 3],
                           *ca = &m[(i + 2) % 3];
        out[0] = (drape_piece){ { *c, *ca, *bc }, depth };
        out[1] = (drape_piece){ { *a, *b, *bc }, depth };
        out[2] = (drape_piece){ { *a, *bc, *ca }, depth };
    } else {
        while (!split[i])
            i++;
        const drape_corner *a = &p->c[i], *b = &p->c[(i + 1) % 3], *c = &p->c[(i + 2) % 3];
        out[0] = (drape_piece){ { *a, m[i], *c }, depth };
        out[1] = (drape_piece){ { m[i], *b, *c }, depth };
    }
    for (int k = 0; k < count + 1; k++)
        d->no_memory = !array_push(&d->waiting, out[k]) || d->no_memory;
}

/* Facing upwards, whichever way its ring went round. */
static drape_piece piece_of(const drape *d, const double *const at[3]) {
    double turn = (at[1][0] - at[0][0]) * (at[2][1] - at[0][1]) - (at[2][0] - at[0][0]) * (at[1][1] - at[0][1]);
    const double *b = turn > 0 ? at[1] : at[2], *c = turn > 0 ? at[2] : at[1];
    return (drape_piece){ { on_ground(d, at[0][0], at[0][1]), on_ground(d, b[0], b[1]), on_ground(d, c[0], c[1]) }, 0 };
}

noc_status drape_triangle(drape *d, const double *const corners[3], const noc_progress *progress) {
    drape_piece p = piece_of(d, corners);
    take(d, &p);
    while (d->waiting.len && !d->no_memory && !drape_is_full(d)) {
        p = d->waiting.data[--d->waiting.len];
        take(d, &p);
        if (d->pieces % AT_ONCE == 0 && progress && progress->update && !progress->update(progress->user, "areas", 0))
            return NOC_ERR_CANCELLED;
    }
    return d->no_memory ? NOC_ERR_MEMORY : NOC_OK;
}

void drape_free(drape *d) {
    array_free(&d->waiting);
    array_free(&d->position);
    array_free(&d->index);
}
