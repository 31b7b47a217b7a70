/* Polygons as surveyors deliver them, cleaned and cut into triangles. */
#include "geo/geo.h"
#include "geo/tessellate.h"

#include <math.h>

#define SAME_POINT 1e-4      /* m; neighbouring points nearer than this are one */
#define PLANE_TOLERANCE 0.01 /* m; points further off the best plane make a polygon non-planar */
#define LARGEST 1e6          /* m; no surface of a city is wider, and floats could not hold it */
#define MOST_HOLES 1000      /* that are compared with each other */
#define MOST_LOOKS 200000000 /* at edges of the exterior, to tell of holes outside of it */
#define SMALLEST_AREA 1e-8   /* m2 */

/* A polygon at work: cleaned points of all rings, relative to `centre`, and the same in the coordinates of its plane.
 */
struct work {
    const char *id;
    geo_issues *issues;
    NOC_ARRAY(double) xyz;
    NOC_ARRAY(double) uv;
    NOC_ARRAY(size_t) given; /* of each point: its number in the polygon */
    NOC_ARRAY(size_t) ring_size;
    NOC_ARRAY(double) ring_sum; /* of the ring's points, 3 a ring */
    double centre[3], normal[3];
    bool no_memory;
};

static void subtract(const double *a, const double *b, double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = a[k] - b[k];
}

static double dot(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void cross(const double *a, const double *b, double out[3]) {
    double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2], z = a[0] * b[1] - a[1] * b[0];
    out[0] = x, out[1] = y, out[2] = z;
}

static bool near(const double *a, const double *b) {
    double d[3];
    subtract(a, b, d);
    return dot(d, d) < SAME_POINT * SAME_POINT;
}

/* Is b the tip of a spike: does the ring come back from it the way it went? */
static bool is_spike(const double *a, const double *b, const double *c) {
    double in[3], out[3], n[3];
    subtract(b, a, in);
    subtract(c, b, out);
    if (dot(in, out) >= 0)
        return false;
    cross(in, out, n);
    double longer = NOC_MAX(dot(in, in), dot(out, out));
    return dot(n, n) < SAME_POINT * SAME_POINT * longer;
}

struct defects {
    bool repeated, spike, non_finite;
};

/* Removes what the last points of the ring p[0..n) show; removing a spike may bring another to light. given: of each
 * point, goes with it. */
static size_t clean_end(double *p, size_t *given, size_t n, struct defects *found) {
    for (;;) {
        if (n >= 2 && near(p + 3 * (n - 2), p + 3 * (n - 1))) {
            found->repeated = true;
            n--;
        } else if (n >= 3 && is_spike(p + 3 * (n - 3), p + 3 * (n - 2), p + 3 * (n - 1))) {
            found->spike = true;
            memmove(p + 3 * (n - 2), p + 3 * (n - 1), 3 * sizeof(double));
            given[n - 2] = given[n - 1];
            n--;
        } else {
            return n;
        }
    }
}

/* The same where the ring closes. What goes at its beginning is moved away once, at the end. */
static size_t clean_seam(double *ring, size_t *given, size_t n, struct defects *found) {
    double *p = ring;
    while (n >= 3) {
        if (near(p, p + 3 * (n - 1))) {
            found->repeated = true;
            n--;
        } else if (is_spike(p + 3 * (n - 2), p + 3 * (n - 1), p)) {
            found->spike = true;
            n--;
        } else if (is_spike(p + 3 * (n - 1), p, p + 3)) {
            found->spike = true;
            p += 3;
            n--;
        } else {
            break;
        }
    }
    if (p != ring) {
        memmove(given, given + (p - ring) / 3, n * sizeof(*given));
        memmove(ring, p, 3 * n * sizeof(double));
    }
    return n;
}

/* Appends one ring, cleaned; returns its number of points. before: points of the polygon before it. */
static size_t add_ring(struct work *w, const double *xyz, size_t before, size_t count, struct defects *found) {
    size_t first = w->xyz.len;
    double *p = w->xyz.data + first;
    size_t n = 0, *given = w->given.data + first / 3;
    for (size_t i = 0; i < count; i++) {
        double q[3];
        subtract(xyz + 3 * i, w->centre, q);
        if (!isfinite(q[0]) || !isfinite(q[1]) || !isfinite(q[2])) {
            found->non_finite = true;
            continue;
        }
        given[n] = before + i;
        memcpy(p + 3 * n++, q, sizeof(q));
        n = clean_end(p, given, n, found);
    }
    n = clean_seam(p, given, n, found);
    w->xyz.len = first + 3 * n;
    return n;
}

/* Newell's normal: twice the area as a vector; exact for planar rings, the best plane's for others. */
static void newell(const double *p, size_t n, double normal[3]) {
    normal[0] = normal[1] = normal[2] = 0;
    for (size_t i = 1; i + 1 < n; i++) {
        double a[3], b[3], c[3];
        subtract(p + 3 * i, p, a);
        subtract(p + 3 * (i + 1), p, b);
        cross(a, b, c);
        for (int k = 0; k < 3; k++)
            normal[k] += c[k];
    }
}

/* The widest triangle of a fan: a plane for rings whose parts cancel (a bow tie has no area by Newell). */
static void widest(const double *p, size_t n, double normal[3]) {
    double best = -1;
    for (size_t i = 1; i + 1 < n; i++) {
        double a[3], b[3], c[3];
        subtract(p + 3 * i, p, a);
        subtract(p + 3 * (i + 1), p, b);
        cross(a, b, c);
        if (dot(c, c) > best) {
            best = dot(c, c);
            memcpy(normal, c, sizeof(c));
        }
    }
}

/* The plane of the exterior ring, turned as the ring is; false if it has none. */
static bool find_plane(struct work *w) {
    size_t n = w->ring_size.data[0];
    double size = 0;
    for (size_t i = 0; i < w->xyz.len; i++)
        size = NOC_MAX(size, fabs(w->xyz.data[i]));
    if (!(size < LARGEST)) {
        geo_issue(w->issues, GEO_SKIPPED, "polygon wider than 1000 km", w->id);
        return false;
    }
    double wide[3] = { 0 };
    newell(w->xyz.data, n, w->normal);
    widest(w->xyz.data, n, wide);
    if (dot(w->normal, w->normal) < 1e-6 * dot(wide, wide)) {
        double sign = dot(w->normal, wide) < 0 ? -1 : 1;
        for (int k = 0; k < 3; k++)
            w->normal[k] = sign * wide[k];
    }
    double length = sqrt(dot(w->normal, w->normal));
    if (!(length >= 2 * SMALLEST_AREA)) {
        geo_issue(w->issues, GEO_SPARED, "polygon without area", w->id);
        return false;
    }
    for (int k = 0; k < 3; k++)
        w->normal[k] /= length;
    return true;
}

/* Coordinates in the plane, counter-clockwise as seen against the normal; reports how flat the polygon is. */
static void project(struct work *w) {
    double u[3] = { 0 }, v[3];
    const double *n = w->normal;
    int least = fabs(n[0]) < fabs(n[1]) ? (fabs(n[0]) < fabs(n[2]) ? 0 : 2) : (fabs(n[1]) < fabs(n[2]) ? 1 : 2);
    u[least] = 1;
    cross(n, u, v);
    double length = sqrt(dot(v, v));
    for (int k = 0; k < 3; k++)
        v[k] /= length;
    cross(v, n, u);
    size_t count = w->xyz.len / 3;
    w->uv.len = 2 * count;
    double lowest = INFINITY, highest = -INFINITY;
    for (size_t i = 0; i < count; i++) {
        const double *p = w->xyz.data + 3 * i;
        w->uv.data[2 * i] = dot(p, u);
        w->uv.data[2 * i + 1] = dot(p, v);
        double height = dot(p, n);
        lowest = NOC_MIN(lowest, height);
        highest = NOC_MAX(highest, height);
    }
    if (highest - lowest > 2 * PLANE_TOLERANCE)
        geo_issue(w->issues, GEO_REPAIRED, "non-planar polygon", w->id);
}

static double signed_area(const double *uv, size_t n) {
    double sum = 0;
    for (size_t i = 1; i + 1 < n; i++) {
        const double *a = uv + 2 * i, *b = a + 2;
        sum += (a[0] - uv[0]) * (b[1] - uv[1]) - (a[1] - uv[1]) * (b[0] - uv[0]);
    }
    return sum / 2;
}

static bool inside(const double *uv, size_t n, double x, double y) {
    bool in = false;
    for (size_t i = 0, j = n - 1; i < n; j = i++) {
        const double *a = uv + 2 * i, *b = uv + 2 * j;
        if ((a[1] > y) != (b[1] > y) && x < (b[0] - a[0]) * (y - a[1]) / (b[1] - a[1]) + a[0])
            in = !in;
    }
    return in;
}

static void reverse_ring(struct work *w, size_t first, size_t n) {
    for (size_t i = 0, j = n - 1; i < j; i++, j--) {
        for (size_t k = 0; k < 3; k++) {
            double *a = &w->xyz.data[3 * (first + i) + k], *b = &w->xyz.data[3 * (first + j) + k], t = *a;
            *a = *b, *b = t;
        }
        for (size_t k = 0; k < 2; k++) {
            double *a = &w->uv.data[2 * (first + i) + k], *b = &w->uv.data[2 * (first + j) + k], t = *a;
            *a = *b, *b = t;
        }
        size_t *a = &w->given.data[first + i], *b = &w->given.data[first + j], t = *a;
        *a = *b, *b = t;
    }
}

/* Does any of the ring's edges (of a sample of them, if there are many) have its middle in the exterior ring? Corners
 * say less: they may touch it. Where many looks were taken already, it is believed. */
static bool lies_in_exterior(const struct work *w, const double *uv, size_t n, size_t *looks) {
    size_t step = n / 64 + 1, edges = w->ring_size.data[0];
    for (size_t i = 0; i < n; i += step) {
        const double *a = uv + 2 * i, *b = uv + 2 * ((i + 1) % n);
        if (*looks + edges > MOST_LOOKS)
            return true;
        *looks += edges;
        if (inside(w->uv.data, edges, (a[0] + b[0]) / 2, (a[1] + b[1]) / 2))
            return true;
    }
    return false;
}

/* Is the ring the same as an earlier interior ring, begun at whatever point? Their corner sums tell. */
static bool is_repeated(const struct work *w, size_t ring) {
    size_t n = w->ring_size.data[ring];
    for (size_t r = 1; r < ring; r++) {
        double d[3];
        subtract(w->ring_sum.data + 3 * r, w->ring_sum.data + 3 * ring, d);
        if (w->ring_size.data[r] == n && dot(d, d) < SAME_POINT * SAME_POINT * (double)n)
            return true;
    }
    return false;
}

/* Holes must run against the exterior and lie in it. The rest is the tessellator's: the winding rule ignores what is
 * outside, and what is cut out twice. */
static void check_holes(struct work *w) {
    size_t first = w->ring_size.data[0], looks = 0;
    for (size_t r = 1; r < w->ring_size.len; first += w->ring_size.data[r++]) {
        size_t n = w->ring_size.data[r];
        double *uv = w->uv.data + 2 * first;
        if (r <= MOST_HOLES && is_repeated(w, r))
            geo_issue(w->issues, GEO_REPAIRED, "interior ring given twice", w->id);
        if (!lies_in_exterior(w, uv, n, &looks))
            geo_issue(w->issues, GEO_GUESSED, "interior ring outside the exterior", w->id);
        if (signed_area(uv, n) > 0) {
            geo_issue(w->issues, GEO_REPAIRED, "interior ring turned like the exterior", w->id);
            reverse_ring(w, first, n);
        }
    }
}

/* An interior ring by its edges: the same whichever point it begins at. */
typedef struct hole {
    uint64_t edges;
    size_t ring;
} hole;

static int compare_holes(const void *a, const void *b) {
    const hole *x = a, *y = b;
    return x->edges != y->edges ? (x->edges > y->edges) - (x->edges < y->edges)
                                : (x->ring > y->ring) - (x->ring < y->ring);
}

static uint64_t mix(uint64_t h, const double *xyz) {
    uint64_t bits[3];
    memcpy(bits, xyz, sizeof(bits));
    for (int k = 0; k < 3; k++)
        h = ((h ^ bits[k]) * 0xd6e8feb86659fd93u ^ h >> 29) * 0x9e3779b97f4a7c15u;
    return h ^ h >> 32;
}

/* Keyed with what a file's author does not know: no two other rings can be made to have the same. */
static uint64_t sum_of_edges(const double *xyz, size_t n) {
    uint64_t sum = n, secret = base_secret();
    for (size_t i = 0; i < n; i++)
        sum += mix(mix(secret, xyz + 3 * i), xyz + 3 * ((i + 1) % n));
    return sum;
}

/* Marks interior rings that are exactly an earlier one by a sum that is no number. */
static bool mark_repeated(struct work *w) {
    size_t count = w->ring_size.len - 1, first = w->ring_size.data[0];
    hole *holes = noc_alloc(count * sizeof(*holes));
    if (!holes)
        return false;
    for (size_t r = 1; r <= count; first += w->ring_size.data[r++])
        holes[r - 1] = (hole){ sum_of_edges(w->xyz.data + 3 * first, w->ring_size.data[r]), r };
    qsort(holes, count, sizeof(*holes), compare_holes);
    for (size_t i = 1; i < count; i++) {
        if (holes[i].edges != holes[i - 1].edges)
            continue;
        if (holes[i].ring > MOST_HOLES) /* the others are counted */
            geo_issue(w->issues, GEO_REPAIRED, "interior ring given twice", w->id);
        w->ring_sum.data[3 * holes[i].ring] = NAN;
    }
    free(holes);
    return true;
}

/* Drops interior rings that are given twice: cutting them out again changes nothing, and the tessellator's time grows
 * with the square of the points at one place. */
static void drop_repeated(struct work *w) {
    if (w->ring_size.len < 3)
        return;
    if (!mark_repeated(w)) {
        w->no_memory = true;
        return;
    }
    size_t kept = 1, to = w->ring_size.data[0], from = to;
    for (size_t r = 1; r < w->ring_size.len; r++) {
        size_t n = w->ring_size.data[r];
        if (!isnan(w->ring_sum.data[3 * r])) {
            memmove(w->xyz.data + 3 * to, w->xyz.data + 3 * from, 3 * n * sizeof(double));
            memmove(w->uv.data + 2 * to, w->uv.data + 2 * from, 2 * n * sizeof(double));
            memmove(w->given.data + to, w->given.data + from, n * sizeof(size_t));
            w->ring_size.data[kept++] = n;
            to += n;
        }
        from += n;
    }
    w->ring_size.len = kept;
    w->xyz.len = 3 * to;
    w->uv.len = 2 * to;
}

/* Room was reserved. */
static void put_ring(struct work *w, size_t n) {
    double *sum = w->ring_sum.data + w->ring_sum.len;
    w->ring_sum.len += 3;
    memset(sum, 0, 3 * sizeof(*sum));
    for (size_t i = w->xyz.len - 3 * n; i < w->xyz.len; i++)
        sum[i % 3] += w->xyz.data[i];
    w->ring_size.data[w->ring_size.len++] = n;
}

size_t geo_most_points = 20000000; /* ten times the largest that is known of a map */

/* Rings cleaned into w, plane found, holes turned. False if the polygon was skipped. */
static bool prepare(struct work *w, const geo_polygon *polygon) {
    struct defects found = { 0 };
    const double *p = polygon->xyz;
    size_t count = polygon->ring_count ? polygon->ring_size[0] : 0, i = 0, points = 0;
    for (size_t r = 0; r < polygon->ring_count; r++)
        points += polygon->ring_size[r];
    if (points > geo_most_points) {
        geo_issue(w->issues, GEO_SKIPPED, "polygon of more than 20 million points", w->id);
        return false;
    }
    w->no_memory = !array_reserve(&w->xyz, 3 * points) || !array_reserve(&w->uv, 2 * points) ||
                   !array_reserve(&w->given, points) || !array_reserve(&w->ring_size, polygon->ring_count) ||
                   !array_reserve(&w->ring_sum, 3 * polygon->ring_count);
    if (w->no_memory)
        return false;
    while (i < count && !(isfinite(p[3 * i]) && isfinite(p[3 * i + 1]) && isfinite(p[3 * i + 2])))
        i++;
    if (i < count)
        memcpy(w->centre, p + 3 * i, sizeof(w->centre));
    for (size_t r = 0; r < polygon->ring_count; p += 3 * polygon->ring_size[r++]) {
        size_t n = add_ring(w, p, (size_t)(p - polygon->xyz) / 3, polygon->ring_size[r], &found);
        if (n < 3) {
            bool few = polygon->ring_size[r] < 3;
            geo_issue(w->issues,
                      r     ? GEO_REPAIRED
                      : few ? GEO_SKIPPED
                            : GEO_SPARED,
                      r     ? few ? "interior ring with too few points" : "collapsed interior ring"
                      : few ? "ring with too few points"
                            : "collapsed ring",
                      w->id);
            if (!r)
                return false;
            w->xyz.len -= 3 * n;
            continue;
        }
        put_ring(w, n);
    }
    if (!w->ring_size.len) {
        geo_issue(w->issues, GEO_SKIPPED, "ring with too few points", w->id);
        return false;
    }
    if (!find_plane(w))
        return false;
    if (found.non_finite)
        geo_issue(w->issues, GEO_GUESSED, "coordinates that are not finite", w->id);
    if (found.repeated)
        geo_issue(w->issues, GEO_REPAIRED, "repeated point", w->id);
    if (found.spike)
        geo_issue(w->issues, GEO_REPAIRED, "spike", w->id);
    project(w);
    check_holes(w);
    drop_repeated(w);
    return !w->no_memory;
}

static double corner(const double *uv, size_t a, size_t b, size_t c) {
    const double *p = uv + 2 * a, *q = uv + 2 * b, *r = uv + 2 * c;
    return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
}

/* Most polygons of a city are triangles and quadrilaterals. A quadrilateral is cut along the shorter diagonal of those
 * that lie inside it; where neither does, it crosses itself and the tessellator must do it. There is room. */
static bool cut_simple(const struct work *w, uint32_t v, geo_triangles *out) {
    size_t n = w->ring_size.data[0];
    if (w->ring_size.len > 1 || n > 4)
        return false;
    const double *uv = w->uv.data;
    uint32_t *to = out->indices.data + out->indices.len;
    if (n == 3) {
        memcpy(to, ((uint32_t[]){ v, v + 1, v + 2 }), 3 * sizeof(*to));
        out->indices.len += 3;
        return true;
    }
    bool ac = corner(uv, 0, 1, 2) > 0 && corner(uv, 0, 2, 3) > 0,
         bd = corner(uv, 1, 2, 3) > 0 && corner(uv, 1, 3, 0) > 0;
    if (!ac && !bd)
        return false;
    if (ac && bd) {
        double p[3], q[3];
        subtract(w->xyz.data + 6, w->xyz.data, p);
        subtract(w->xyz.data + 9, w->xyz.data + 3, q);
        ac = dot(p, p) <= dot(q, q);
    }
    memcpy(to,
           ac ? (uint32_t[]){ v, v + 1, v + 2, v, v + 2, v + 3 } : (uint32_t[]){ v + 1, v + 2, v + 3, v + 1, v + 3, v },
           6 * sizeof(*to));
    out->indices.len += 6;
    return true;
}

/* Points in a straight line give the tessellator triangles without area: they show nothing. */
static void drop_flat_triangles(geo_triangles *t, size_t first_index) {
    size_t kept = first_index;
    for (size_t i = first_index; i < t->indices.len; i += 3) {
        const uint32_t *v = t->indices.data + i;
        double a[3], b[3], n[3];
        subtract(t->xyz.data + 3 * (size_t)v[1], t->xyz.data + 3 * (size_t)v[0], a);
        subtract(t->xyz.data + 3 * (size_t)v[2], t->xyz.data + 3 * (size_t)v[0], b);
        cross(a, b, n);
        if (dot(n, n) > 4 * SMALLEST_AREA * SMALLEST_AREA) {
            memmove(t->indices.data + kept, v, 3 * sizeof(*v));
            kept += 3;
        }
    }
    t->indices.len = kept;
}

/* Where the cleaned points are in the image. */
static bool place_in_image(struct work *w, const float *uv, geo_triangles *out) {
    size_t points = w->xyz.len / 3;
    if (!array_reserve(&out->uv, out->uv.len + 2 * points))
        return false;
    for (size_t i = 0; i < 2 * points; i++)
        out->uv.data[out->uv.len++] = uv[2 * w->given.data[i / 2] + i % 2];
    return true;
}

static bool triangulate(struct work *w, const float *uv, geo_triangles *out) {
    size_t first_index = out->indices.len, first_vertex = out->xyz.len, first_uv = out->uv.len;
    if (out->xyz.len / 3 + w->xyz.len / 3 > UINT32_MAX / 2)
        return false;
    /* With two triangles fewer than points, and two more a hole. */
    size_t triangles = w->xyz.len / 3 + 2 * w->ring_size.len;
    if (!array_reserve(&out->indices, out->indices.len + 3 * triangles) || (uv && !place_in_image(w, uv, out)) ||
        !array_append(&out->xyz, w->xyz.data, w->xyz.len)) {
        out->uv.len = first_uv;
        w->no_memory = true;
        return false;
    }
    bool simple = cut_simple(w, (uint32_t)(first_vertex / 3), out);
    if (!simple) {
        tessellation t = tessellate(w->uv.data, w->ring_size.data, w->ring_size.len, out, first_vertex / 3);
        if (t.crossings)
            geo_issue(w->issues, GEO_GUESSED, "self-intersecting ring", w->id);
        else if (t.touches && w->ring_size.len == 1) /* a hole may touch the exterior */
            geo_issue(w->issues, GEO_REPAIRED, "self-touching ring", w->id);
        w->no_memory = t.no_memory;
        drop_flat_triangles(out, first_index);
        if (!t.ok || out->indices.len == first_index) {
            if (!t.no_memory)
                geo_issue(w->issues, t.ok && !t.tangled ? GEO_SPARED : GEO_SKIPPED,
                          t.tangled
                              ? "polygon that crosses itself more than 1000 times, or more often than it has points"
                          : t.ok ? "polygon without area"
                                 : "polygon that cannot be triangulated",
                          w->id);
            out->indices.len = first_index;
            out->xyz.len = first_vertex;
            out->uv.len = first_uv;
            return false;
        }
    }
    for (size_t i = first_vertex; i < out->xyz.len; i += 3)
        for (size_t k = 0; k < 3; k++)
            out->xyz.data[i + k] += w->centre[k];
    return true;
}

bool geo_triangulate(const geo_polygon *polygon, geo_triangles *out, geo_issues *issues) {
    struct work w = { .id = polygon->id, .issues = issues };
    bool ok = prepare(&w, polygon) && triangulate(&w, polygon->uv, out);
    out->no_memory = out->no_memory || w.no_memory;
    array_free(&w.xyz);
    array_free(&w.uv);
    array_free(&w.given);
    array_free(&w.ring_size);
    array_free(&w.ring_sum);
    return ok;
}

void geo_triangles_free(geo_triangles *t) {
    array_free(&t->xyz);
    array_free(&t->uv);
    array_free(&t->indices);
}
