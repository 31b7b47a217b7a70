/* Cells on a strip of wall: windows where one fits wholly into it. */
#include "city/windows/parts.h"

#define SILL 0.56        /* share of a storey's free height that is under a window */
#define SHOP_HEAD 0.9    /* m of a shop's storey that stay wall above its front; its sill is SHOP_SILL */
#define SHOP_SILL 0.3    /* m */
#define SHOP_PIER 0.6    /* m of wall between shop fronts */
#define SHOP_CELLS 2     /* cells that a shop front takes */
#define OFFICE_PIER 0.35 /* m of wall between the windows of an office: they fill their cells */
#define BARE 1e-4        /* m2 of a window's place that may be no wall */
#define MOST_PIECES 128
#define MOST_CORNERS 16

typedef struct polygon {
    double p[MOST_CORNERS][2];
    int n;
} polygon;

/* A triangle of the strip: in s and t. */
typedef struct flat_triangle {
    double p[3][2], lo[2], hi[2];
    double n[7][2], d[7]; /* lines around it: n . x <= d */
    int sides;
    double out; /* m that it sticks out of its facet's plane, 0 or more */
} flat_triangle;

/* Splits at the line of the points x where n . x = d: what is beyond it, n . x > d, and the rest. */
static void split(const polygon *a, const double n[2], double d, polygon *beyond, polygon *rest) {
    beyond->n = rest->n = 0;
    for (int i = 0; i < a->n; i++) {
        const double *p = a->p[i], *q = a->p[(i + 1) % a->n];
        double x = n[0] * p[0] + n[1] * p[1] - d, y = n[0] * q[0] + n[1] * q[1] - d;
        polygon *to = x > 0 ? beyond : rest;
        if (to->n < MOST_CORNERS)
            memcpy(to->p[to->n++], p, sizeof(*to->p));
        if ((x > 0) == (y > 0))
            continue;
        double share = x / (x - y), m[2] = { p[0] + share * (q[0] - p[0]), p[1] + share * (q[1] - p[1]) };
        if (beyond->n < MOST_CORNERS)
            memcpy(beyond->p[beyond->n++], m, sizeof(m));
        if (rest->n < MOST_CORNERS)
            memcpy(rest->p[rest->n++], m, sizeof(m));
    }
}

static double area_of(const polygon *a) {
    double sum = 0;
    for (int i = 0; i < a->n; i++) {
        const double *p = a->p[i], *q = a->p[(i + 1) % a->n];
        sum += p[0] * q[1] - q[0] * p[1];
    }
    return fabs(sum) / 2;
}

/* The sides of a triangle, moved out by half a gap so that gaps close, and those of the box around it, so that its
 * sharp corners do not move far. */
static void find_sides(flat_triangle *t) {
    const double half = WINDOW_GAP_MM / 2000;
    int count = 0;
    double turn =
        (t->p[1][0] - t->p[0][0]) * (t->p[2][1] - t->p[0][1]) - (t->p[2][0] - t->p[0][0]) * (t->p[1][1] - t->p[0][1]);
    for (int i = 0; i < 3; i++) {
        const double *a = t->p[i], *b = t->p[(i + 1) % 3];
        double x = b[1] - a[1], y = a[0] - b[0], length = hypot(x, y);
        if (!(length > 0))
            continue;
        length = turn < 0 ? -length : length;
        t->n[count][0] = x / length;
        t->n[count][1] = y / length;
        t->d[count] = t->n[count][0] * a[0] + t->n[count][1] * a[1] + half;
        count++;
    }
    for (int i = 0; i < 4; i++, count++) {
        double sign = i & 1 ? 1 : -1;
        t->n[count][0] = i < 2 ? sign : 0;
        t->n[count][1] = i < 2 ? 0 : sign;
        t->d[count] = sign * (i & 1 ? t->hi : t->lo)[i / 2] + half;
    }
    t->sides = count;
}

/* How many corners are beyond the line. */
static int count_beyond(const polygon *a, const double n[2], double d) {
    int count = 0;
    for (int i = 0; i < a->n; i++)
        count += n[0] * a->p[i][0] + n[1] * a->p[i][1] - d > 0;
    return count;
}

/* Is the rectangle all wall? What triangles leave of it is kept as convex pieces, so that wall given twice counts once.
 */
static bool is_wall(const flat_triangle *t, const uint32_t *near, size_t count, const double lo[2],
                    const double hi[2]) {
    polygon bare[MOST_PIECES];
    int n = 1;
    bare[0] = (polygon){ { { lo[0], lo[1] }, { hi[0], lo[1] }, { hi[0], hi[1] }, { lo[0], hi[1] } }, 4 };
    for (size_t i = 0; i < count && n; i++) {
        const flat_triangle *a = &t[near[i]];
        if (a->hi[1] < lo[1] || a->lo[1] > hi[1] || a->hi[0] < lo[0] || a->lo[0] > hi[0])
            continue;
        int before = n;
        for (int k = 0; k < before;) {
            polygon rest = bare[k], beyond;
            bare[k] = bare[--before]; /* this one goes; what is left of it comes behind all */
            bare[before] = bare[--n];
            for (int j = 0; j < a->sides && rest.n > 2; j++) {
                polygon inside;
                int out = count_beyond(&rest, a->n[j], a->d[j]);
                if (!out)
                    continue;
                if (out == rest.n) {
                    beyond = rest;
                    inside.n = 0;
                } else {
                    split(&rest, a->n[j], a->d[j], &beyond, &inside);
                }
                if (beyond.n > 2 && area_of(&beyond) > BARE / MOST_PIECES) {
                    if (n == MOST_PIECES)
                        return false;
                    bare[n++] = beyond;
                }
                rest = inside;
            }
        }
    }
    double area = 0;
    for (int i = 0; i < n; i++)
        area += area_of(&bare[i]);
    return area <= BARE;
}

typedef NOC_ARRAY(flat_triangle) flat_list;

static bool flatten(const wall_facets *f, const strip *s, flat_list *out) {
    for (size_t i = 0; i < s->count; i++) {
        const facet *a = &f->facets.data[s->parts[i].facet];
        for (uint32_t k = a->first; k < a->first + a->count; k++) {
            flat_triangle t = { .lo = { INFINITY, INFINITY }, .hi = { -INFINITY, -INFINITY } };
            for (int j = 0; j < 3; j++) {
                t.out = fmax(t.out, wall_plane_at(&a->plane, f->pieces.data[f->by_facet.data[k]].t.p[j], t.p[j]));
                t.p[j][0] += s->parts[i].s - a->lo[0];
                t.p[j][1] += a->plane.c[2];
                for (int m = 0; m < 2; m++) {
                    t.lo[m] = fmin(t.lo[m], t.p[j][m]);
                    t.hi[m] = fmax(t.hi[m], t.p[j][m]);
                }
            }
            find_sides(&t);
            if (!array_push(out, t))
                return false;
        }
    }
    return true;
}

/* A flat window before the wall from lo to hi: on a curved one before its chord, and clear of what bulges over that. */
static city_window window_at(const wall_facets *f, const strip *s, const double lo[2], const double hi[2]) {
    city_window w = { .corner = { 0 } };
    double a[3], b[3], level[3];
    const wall_plane *left, *right;
    wall_strip_place(f, s, lo[0], lo[1], a, &left);
    wall_strip_place(f, s, hi[0], lo[1], b, &right);
    sub3(b, a, w.edge_u);
    if (left != right)
        w.edge_u[2] = 0;
    double length = sqrt(dot3(w.edge_u, w.edge_u)), up[3] = { 0, 0, 1 };
    memcpy(level, left == right ? left->v : up, sizeof(level));
    double n[3], bulge = 0;
    cross3(w.edge_u, level, n);
    for (int k = 0; k < 3; k++)
        n[k] /= length;
    for (size_t i = 1; i < s->count; i++) {
        double p[3], d[3];
        if (!(s->parts[i].s > lo[0] && s->parts[i].s < hi[0]))
            continue;
        wall_strip_place(f, s, s->parts[i].s, lo[1], p, NULL);
        sub3(p, a, d);
        bulge = fmax(bulge, dot3(d, n));
    }
    for (int k = 0; k < 3; k++) {
        w.corner[k] = a[k] + (WINDOW_OFFSET_MM / 1000 + bulge) * n[k];
        w.edge_v[k] = (hi[1] - lo[1]) * level[k];
    }
    return w;
}

/* How far the window's corner is before where it belongs in a flat wall. */
static double find_back(const flat_list *flat, const uint32_t *near, size_t count, const double lo[2],
                        const double hi[2]) {
    double out = 0;
    for (size_t i = 0; i < count; i++) {
        const flat_triangle *t = &flat->data[near[i]];
        if (t->hi[1] > lo[1] && t->lo[1] < hi[1] && t->hi[0] > lo[0] && t->lo[0] < hi[0])
            out = fmax(out, t->out);
    }
    return WINDOW_OFFSET_MM / 1000 - out;
}

/* Columns of `width` from `start` along the wall on, rows of `height`. */
static void set_grid(const wall_facets *f, const strip *s, double start, double width, double height,
                     city_facade *facade) {
    const wall_plane *plane;
    wall_strip_place(f, s, start, s->lo, facade->origin, &plane);
    for (int k = 0; k < 3; k++) {
        facade->along[k] = width * plane->u[k];
        facade->up[k] = height * plane->v[k];
    }
}

typedef struct row {
    double floor, height; /* m: t of its floor, height of a storey */
    int storey;
    noc_window_kind kind;
} row;

/* What a window of a row takes of its `cells` cells from s on. */
static void place_of(const noc_window_params *p, const row *r, double s, int cells, double lo[2], double hi[2]) {
    double width = p->width, height = p->height, sill, span = cells * p->cell;
    if (r->kind == NOC_WINDOW_SHOP) {
        width = fmax(span - SHOP_PIER, width);
        sill = SHOP_SILL;
        height = fmax(r->height - SHOP_SILL - SHOP_HEAD, 0.5);
    } else {
        if (r->kind == NOC_WINDOW_OFFICE)
            width = fmax(span - OFFICE_PIER, width);
        sill = SILL * fmax(r->height - height, 0);
    }
    lo[0] = s + 0.5 * (span - width);
    hi[0] = lo[0] + width;
    lo[1] = r->floor + sill;
    hi[1] = lo[1] + height;
}

/* Triangles over a span of the strip. */
static bool gather(const flat_list *flat, double lo, double hi, uint32_t *near, size_t *count) {
    *count = 0;
    for (size_t i = 0; i < flat->len; i++)
        if (flat->data[i].lo[0] <= hi + 0.1 && flat->data[i].hi[0] >= lo - 0.1)
            near[(*count)++] = (uint32_t)i;
    return *count > 0;
}

bool wall_cells_find(const wall_facets *f, const strip *s, const noc_window_params *p, const building_use *use,
                     double foot, size_t *tests, size_t most_tests, city_facade *facade, city_window_list *out) {
    const double slack = 1e-3; /* m: a wall of exactly three cells has three */
    flat_list flat = { 0 };
    double cell = p->cell, span = s->length + slack;
    long columns = (long)(span / cell), rows = (long)((s->hi - s->lo) / p->storey_height) + 1;
    if (!columns && span >= p->width + 2 * p->margin)
        columns = 1;
    if (!columns)
        return true;
    double start = 0.5 * (s->length - (double)columns * cell);
    bool ok = flatten(f, s, &flat), street = use->shops && s->lo - foot < 0.5 * p->storey_height;
    uint32_t *near = ok ? noc_alloc(NOC_MAX(flat.len, 1u) * sizeof(*near)) : NULL;
    ok = ok && near;
    if (s->count == 1) { /* fronts of shops may begin in the middle of a cell */
        bool halves = street && columns % SHOP_CELLS;
        set_grid(f, s, start, halves ? cell / 2 : cell, p->storey_height, facade);
        facade->columns = (uint32_t)(halves ? 2 * columns : columns);
        facade->rows = (uint32_t)rows;
    }
    for (int shops = street; ok && shops >= 0; shops--) {
        int step = shops ? SHOP_CELLS : 1;
        double first = shops ? start + 0.5 * (double)(columns % SHOP_CELLS) * cell : start;
        for (long c = 0; ok && c < columns / step && *tests < most_tests; c++) {
            size_t count;
            *tests += flat.len / 8; /* which are sooner seen not to matter */
            double at = first + (double)(c * step) * cell;
            if (!gather(&flat, at - p->margin, at + step * cell + p->margin, near, &count))
                continue;
            for (long r = shops ? 0 : street; ok && r < (shops ? 1 : rows); r++) {
                row k = { s->lo + (double)r * p->storey_height, p->storey_height, (int)r,
                          shops          ? NOC_WINDOW_SHOP
                          : use->offices ? NOC_WINDOW_OFFICE
                                         : NOC_WINDOW_FLAT };
                double lo[2], hi[2];
                place_of(p, &k, at, step, lo, hi);
                const double a[2] = { lo[0] - p->margin, lo[1] - p->margin },
                             b[2] = { hi[0] + p->margin, hi[1] + p->margin };
                if (b[1] > s->hi + slack)
                    continue;
                *tests += count - 1; /* one is what every cell takes */
                if (!is_wall(flat.data, near, count, a, b))
                    continue;
                city_window w = window_at(f, s, lo, hi);
                w.back = find_back(&flat, near, count, lo, hi);
                w.storey = (int)r;
                w.column = (int)c;
                w.kind = k.kind;
                ok = array_push(out, w);
            }
        }
    }
    free(near);
    array_free(&flat);
    return ok;
}
