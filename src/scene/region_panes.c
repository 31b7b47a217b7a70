/* Walls behind panes: triangles of walls are cut along the triangles of the panes before them, in coordinates (s, t) of
 * the wall's triangle, in which a place is p + s u + t v. */
#include "scene/region_panes.h"

#include <math.h>

enum { CORNERS = 12, DEEPEST = 400 }; /* three cuts of a triangle leave fewer corners, whatever is rounded */
#define REACH 0.6                     /* m: panes further before a wall are no part of it */
#define BEHIND 2e-3                   /* m: a pane that lies in the wall may be that far behind it */
#define CLEAR 1e-3                    /* m: places at the face of a pane are that far before it */
#define LEAST 1e-6                    /* m2: smaller pieces are left as they are */
#define FACING 0.8 /* cosine between a wall and its pane, at least: before curved walls panes are flat */

typedef struct polygon {
    int count;
    double at[CORNERS][2];
} polygon;

/* A pane's triangle as the wall sees it; counter-clockwise. before: m that it stands before (s, t), the sum of
 * before[0], before[1] s and before[2] t. */
typedef struct outline {
    double at[3][2], lo[2], hi[2], before[3];
} outline;

typedef struct cutting {
    const noc_patch *wall;
    double area; /* m2 of the wall's triangle */
    region_panes *panes;
    noc_region *to;
    noc_status status;
} cutting;

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

bool region_panes_add(region_panes *panes, const noc_patch *pane) {
    region_pane t = { .lo = { INFINITY, INFINITY, INFINITY }, .hi = { -INFINITY, -INFINITY, -INFINITY } };
    for (int k = 0; k < 3; k++) {
        t.n[k] = (double)pane->n[k];
        for (int i = 0; i < 3; i++) {
            t.p[i][k] = (double)pane->p[k] + (i == 1 ? (double)pane->u[k] : i == 2 ? (double)pane->v[k] : 0);
            t.lo[k] = fmin(t.lo[k], t.p[i][k]);
            t.hi[k] = fmax(t.hi[k], t.p[i][k]);
        }
    }
    panes->widest = fmax(panes->widest, t.hi[0] - t.lo[0]);
    return array_push(&panes->of, t);
}

static int by_west(const void *a, const void *b) {
    const region_pane *x = a, *y = b;
    return x->lo[0] < y->lo[0] ? -1 : x->lo[0] > y->lo[0];
}

void region_panes_sort(region_panes *panes) {
    if (panes->of.len)
        qsort(panes->of.data, panes->of.len, sizeof(region_pane), by_west);
}

void region_panes_free(region_panes *panes) { array_free(&panes->of); }

/* ---- polygons ---- */

/* Twice its area, of the triangle's. */
static double size_of(const polygon *p) {
    double sum = 0;
    for (int i = 1; i + 1 < p->count; i++) {
        const double *a = p->at[0], *b = p->at[i], *c = p->at[i + 1];
        sum += (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    }
    return sum;
}

/* What lies to the left of the way from a to b, and what does not. */
static void split(const polygon *p, const double a[2], const double b[2], polygon *in, polygon *out) {
    double side[CORNERS];
    in->count = out->count = 0;
    for (int i = 0; i < p->count; i++)
        side[i] = (b[0] - a[0]) * (p->at[i][1] - a[1]) - (b[1] - a[1]) * (p->at[i][0] - a[0]);
    for (int i = 0; i < p->count; i++) {
        int j = (i + 1) % p->count;
        polygon *of = side[i] >= 0 ? in : out;
        memcpy(of->at[of->count++], p->at[i], sizeof(p->at[i]));
        if ((side[i] >= 0) == (side[j] >= 0))
            continue;
        double t = side[i] / (side[i] - side[j]);
        for (int k = 0; k < 2; k++)
            in->at[in->count][k] = out->at[out->count][k] = p->at[i][k] + t * (p->at[j][k] - p->at[i][k]);
        in->count++;
        out->count++;
    }
}

static double before(const outline *o, const double at[2]) {
    return o->before[0] + o->before[1] * at[0] + o->before[2] * at[1];
}

/* What of a polygon the pane hides, and what is left of it by each side of the pane. false: nothing worth a cut. */
static bool hide(const cutting *c, const polygon *p, const outline *o, polygon *hidden, polygon left[3]) {
    polygon rest = *p;
    for (int i = 0; i < 3; i++) {
        split(&rest, o->at[i], o->at[(i + 1) % 3], hidden, &left[i]);
        rest = *hidden;
    }
    if (!(size_of(hidden) * c->area > LEAST))
        return false;
    for (int i = 0; i < hidden->count; i++) {
        double far = before(o, hidden->at[i]);
        if (!(far > -BEHIND && far < REACH))
            return false;
    }
    return true;
}

/* ---- pieces ---- */

/* Adds a triangle of the wall, moved out by so much. */
static void add_piece(cutting *c, const double a[2], const double b[2], const double d[2], double out) {
    const noc_patch *w = c->wall;
    double size = (b[0] - a[0]) * (d[1] - a[1]) - (b[1] - a[1]) * (d[0] - a[0]);
    if (c->status || !(size * c->area > 1e-3 * LEAST))
        return;
    noc_patch p = *w;
    for (int k = 0; k < 3; k++) {
        double u = (double)w->u[k], v = (double)w->v[k];
        p.p[k] = (float)((double)w->p[k] + a[0] * u + a[1] * v + out * (double)w->n[k]);
        p.u[k] = (float)((b[0] - a[0]) * u + (b[1] - a[1]) * v);
        p.v[k] = (float)((d[0] - a[0]) * u + (d[1] - a[1]) * v);
    }
    for (int k = 0; k < 2; k++) {
        double u = (double)w->image_u[k], v = (double)w->image_v[k];
        p.image[k] = (float)((double)w->image[k] + a[0] * u + a[1] * v);
        p.image_u[k] = (float)((b[0] - a[0]) * u + (b[1] - a[1]) * v);
        p.image_v[k] = (float)((d[0] - a[0]) * u + (d[1] - a[1]) * v);
    }
    p.weight = (float)((double)w->weight * size);
    if (c->panes->pieces++ == REGION_PIECES)
        c->status = NOC_ERR_ARGUMENT;
    else if (!array_push(&c->to->patches, p))
        c->status = NOC_ERR_MEMORY;
}

static void add_hidden(cutting *c, const polygon *p, const outline *o) {
    double out = 0;
    for (int i = 0; i < p->count; i++)
        out = fmax(out, before(o, p->at[i]));
    for (int i = 1; i + 1 < p->count; i++)
        add_piece(c, p->at[0], p->at[i], p->at[i + 1], out + CLEAR);
}

static bool meets(const polygon *p, const outline *o) {
    double lo[2] = { INFINITY, INFINITY }, hi[2] = { -INFINITY, -INFINITY };
    for (int i = 0; i < p->count; i++)
        for (int k = 0; k < 2; k++) {
            lo[k] = fmin(lo[k], p->at[i][k]);
            hi[k] = fmax(hi[k], p->at[i][k]);
        }
    return lo[0] < o->hi[0] && hi[0] > o->lo[0] && lo[1] < o->hi[1] && hi[1] > o->lo[1];
}

/* Adds what of a triangle is before no pane of the list, or lies at the face of one. The list is in order, so that its
 * middle halves a wall of many windows. */
static void cut(cutting *c, const polygon *p, const outline *all, const uint32_t *list, size_t count, int depth) {
    polygon hidden, left[3];
    size_t n = 0, by = 0;
    bool found = false;
    uint32_t *of = count ? noc_alloc(count * sizeof(*of)) : NULL;
    if (c->status || (count && !of) || depth > DEEPEST) {
        c->status = c->status ? c->status : depth > DEEPEST ? NOC_ERR_ARGUMENT : NOC_ERR_MEMORY;
        free(of);
        return;
    }
    for (size_t i = 0; i < count; i++)
        if (meets(p, &all[list[i]]))
            of[n++] = list[i];
    for (size_t i = 0; i < n && !found; i++) {
        by = (n / 2 + i) % n;
        found = hide(c, p, &all[of[by]], &hidden, left);
    }
    if (!found) {
        add_piece(c, p->at[0], p->at[1], p->at[2], 0);
        free(of);
        return;
    }
    if (!c->panes->counted)
        add_hidden(c, &hidden, &all[of[by]]);
    memmove(of + by, of + by + 1, (n - by - 1) * sizeof(*of));
    for (int side = 0; side < 3; side++)
        for (int i = 1; i + 1 < left[side].count; i++) {
            polygon part = { .count = 3 };
            memcpy(part.at[0], left[side].at[0], sizeof(part.at[0]));
            memcpy(part.at[1], left[side].at[i], 2 * sizeof(part.at[0]));
            cut(c, &part, all, of, n - 1, depth + 1);
        }
    free(of);
}

/* ---- a wall's triangle and its panes ---- */

typedef struct plane {
    double p[3], u[3], v[3], n[3], uu, uv, vv, det;
} plane;

static plane plane_of(const noc_patch *w) {
    plane l;
    for (int k = 0; k < 3; k++) {
        l.p[k] = (double)w->p[k];
        l.u[k] = (double)w->u[k];
        l.v[k] = (double)w->v[k];
        l.n[k] = (double)w->n[k];
    }
    l.uu = dot(l.u, l.u);
    l.uv = dot(l.u, l.v);
    l.vv = dot(l.v, l.v);
    l.det = l.uu * l.vv - l.uv * l.uv;
    return l;
}

/* false: it is not before the wall. */
static bool see(const plane *w, const region_pane *pane, outline *o) {
    double facing = dot(w->n, pane->n), d[3];
    if (!(facing > FACING))
        return false;
    *o = (outline){ .lo = { INFINITY, INFINITY }, .hi = { -INFINITY, -INFINITY } };
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++)
            d[k] = pane->p[i][k] - w->p[k];
        double du = dot(d, w->u), dv = dot(d, w->v);
        o->at[i][0] = (du * w->vv - dv * w->uv) / w->det;
        o->at[i][1] = (dv * w->uu - du * w->uv) / w->det;
        for (int k = 0; k < 2; k++) {
            o->lo[k] = fmin(o->lo[k], o->at[i][k]);
            o->hi[k] = fmax(o->hi[k], o->at[i][k]);
        }
        if (i == 0)
            o->before[0] = dot(d, pane->n) / facing;
    }
    o->before[1] = -dot(w->u, pane->n) / facing;
    o->before[2] = -dot(w->v, pane->n) / facing;
    return o->hi[0] > 0 && o->hi[1] > 0 && o->lo[0] + o->lo[1] < 1;
}

/* Those that the wall sees; they face as it does, so they are counter-clockwise, too. */
static noc_status find_panes(const region_panes *panes, const noc_patch *wall, outline **out, size_t *count) {
    const plane w = plane_of(wall);
    NOC_ARRAY(outline) found = { 0 };
    double lo[3], hi[3];
    size_t first = 0, last = panes->of.len;
    for (int k = 0; k < 3; k++) {
        lo[k] = w.p[k] + fmin(0, fmin(w.u[k], w.v[k])) - REACH;
        hi[k] = w.p[k] + fmax(0, fmax(w.u[k], w.v[k])) + REACH;
    }
    while (first < last) {
        size_t mid = (first + last) / 2;
        *(panes->of.data[mid].lo[0] < lo[0] - panes->widest ? &first : &last) =
            panes->of.data[mid].lo[0] < lo[0] - panes->widest ? mid + 1 : mid;
    }
    for (size_t i = first; i < panes->of.len && panes->of.data[i].lo[0] <= hi[0]; i++) {
        const region_pane *p = &panes->of.data[i];
        outline o;
        bool near = p->hi[0] >= lo[0];
        for (int k = 1; k < 3; k++)
            near = near && p->hi[k] >= lo[k] && p->lo[k] <= hi[k];
        if (near && see(&w, p, &o) && !array_push(&found, o)) {
            array_free(&found);
            return NOC_ERR_MEMORY;
        }
    }
    *out = found.data;
    *count = found.len;
    return NOC_OK;
}

noc_status region_panes_cut(region_panes *panes, const noc_patch *wall, noc_region *to) {
    static const polygon whole = { 3, { { 0, 0 }, { 1, 0 }, { 0, 1 } } };
    outline *seen = NULL;
    size_t count = 0;
    noc_status status = find_panes(panes, wall, &seen, &count);
    uint32_t *list = count ? noc_alloc(count * sizeof(*list)) : NULL;
    if (!status && count && !list)
        status = NOC_ERR_MEMORY;
    for (size_t i = 0; i < count && list; i++)
        list[i] = (uint32_t)i;
    cutting c = { wall, (double)wall->weight, panes, to, NOC_OK };
    if (!status && !count)
        status = array_push(&to->patches, *wall) ? NOC_OK : NOC_ERR_MEMORY;
    else if (!status)
        cut(&c, &whole, seen, list, count, 0);
    free(list);
    free(seen);
    return status ? status : c.status;
}
