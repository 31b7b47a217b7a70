#include "geo/tessellate.h"

#include <GL/glu.h>
#include <math.h>

struct job {
    geo_triangles *out;
    size_t first_index;
    tessellation result;
};

static void *as_pointer(size_t vertex) { return (void *)(uintptr_t)(vertex + 1); } /* never NULL: GLU gives NULL for none */

static void on_vertex(void *data, void *user) {
    struct job *job = user;
    array_push(&job->out->indices, (uint32_t)((uintptr_t)data - 1));
}

/* Its presence makes GLU give plain triangles, neither strips nor fans. */
static void on_edge_flag(GLboolean flag, void *user) { (void)flag, (void)user; }

static void on_error(GLenum error, void *user) {
    (void)error;
    ((struct job *)user)->result.ok = false;
}

/* Edges cross, or points coincide. The new vertex lies between its (up to) four neighbours in space, so that a ring that is
 * not flat stays closed. */
static void on_combine(GLdouble place[3], void *data[4], GLfloat weight[4], void **out, void *user) {
    (void)place;
    struct job *job = user;
    double p[3] = { 0 }, sum = 0;
    size_t count = 0;
    for (int i = 0; i < 4 && data[i]; i++, count++)
        sum += weight[i];
    bool touch = true;
    for (size_t i = 0; i < count; i++) {
        const double *q = job->out->xyz.data + 3 * ((uintptr_t)data[i] - 1);
        const double *q0 = job->out->xyz.data + 3 * ((uintptr_t)data[0] - 1);
        for (int k = 0; k < 3; k++) {
            p[k] += q[k] * (double)weight[i] / sum;
            touch = touch && q[k] == q0[k];
        }
    }
    if (touch) {
        job->result.touches++;
        *out = data[0];
        return;
    }
    /* two points: they coincide in the plane alone; four: a crossing */
    if (count > 2)
        job->result.crossings++;
    else
        job->result.touches++;
    *out = as_pointer(job->out->xyz.len / 3);
    array_append(&job->out->xyz, p, 3);
}

/* ---- rings that cross themselves too often ---- */

typedef struct edge {
    double lo; /* smaller u */
    const double *a, *b;
} edge;

static int by_lo(const void *x, const void *y) {
    double a = ((const edge *)x)->lo, b = ((const edge *)y)->lo;
    return (a > b) - (a < b);
}

static double side(const double *a, const double *b, const double *p) {
    return (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
}

static bool cross_properly(const edge *e, const edge *f) {
    return side(e->a, e->b, f->a) * side(e->a, e->b, f->b) < 0 && side(f->a, f->b, e->a) * side(f->a, f->b, e->b) < 0;
}

#define FEW_POINTS 100        /* that many cannot cross often enough to matter */
#define MANY_CROSSINGS 1000
#define PAIR_BUDGET 20000000  /* pairs of edges that are looked at; the rest is extrapolated */

/* Each crossing costs the tessellator time that grows with the number of edges: a ring of a few thousand random points
 * takes minutes. */
static bool crosses_too_often(const double *uv, const size_t *ring_size, size_t ring_count, size_t points) {
    if (points < FEW_POINTS)
        return false;
    edge *edges = noc_alloc(points * sizeof(*edges));
    size_t n = 0, limit = MANY_CROSSINGS, crossings = 0, pairs = 0, i = 0;
    for (size_t r = 0; r < ring_count; uv += 2 * ring_size[r++])
        for (size_t k = 0; k < ring_size[r]; k++) {
            const double *a = uv + 2 * k, *b = uv + 2 * ((k + 1) % ring_size[r]);
            edges[n++] = (edge){ NOC_MIN(a[0], b[0]), a, b };
        }
    qsort(edges, n, sizeof(*edges), by_lo);
    for (; i < n && crossings <= limit && pairs < PAIR_BUDGET; i++) {
        double hi = NOC_MAX(edges[i].a[0], edges[i].b[0]);
        for (size_t j = i + 1; j < n && edges[j].lo <= hi; j++, pairs++)
            crossings += cross_properly(&edges[i], &edges[j]);
    }
    bool too_often = (double)crossings * (double)n > (double)limit * (double)NOC_MAX(i, 1);
    free(edges);
    return too_often;
}

/* The tessellator sweeps along x, in time that grows with the edges it meets at once: how many, on average, along u and
 * along v. */
static bool sweep_along_v(const double *uv, const size_t *ring_size, size_t ring_count) {
    double length[2] = { 0 }, lo[2] = { INFINITY, INFINITY }, hi[2] = { -INFINITY, -INFINITY };
    for (size_t r = 0; r < ring_count; uv += 2 * ring_size[r++])
        for (size_t i = 0; i < ring_size[r]; i++)
            for (size_t k = 0; k < 2; k++) {
                double x = uv[2 * i + k];
                length[k] += fabs(uv[2 * ((i + 1) % ring_size[r]) + k] - x);
                lo[k] = NOC_MIN(lo[k], x);
                hi[k] = NOC_MAX(hi[k], x);
            }
    return length[1] * (hi[0] - lo[0]) < length[0] * (hi[1] - lo[1]);
}

tessellation tessellate(const double *uv, const size_t *ring_size, size_t ring_count, geo_triangles *out,
                        size_t first_vertex) {
    struct job job = { .out = out, .first_index = out->indices.len, .result = { .ok = true } };
    size_t points = 0;
    for (size_t r = 0; r < ring_count; r++)
        points += ring_size[r];
    GLUtesselator *tess = crosses_too_often(uv, ring_size, ring_count, points) ? NULL : gluNewTess();
    if (!tess)
        return (tessellation){ 0 };
    gluTessCallback(tess, GLU_TESS_VERTEX_DATA, (_GLUfuncptr)on_vertex);
    gluTessCallback(tess, GLU_TESS_EDGE_FLAG_DATA, (_GLUfuncptr)on_edge_flag);
    gluTessCallback(tess, GLU_TESS_ERROR_DATA, (_GLUfuncptr)on_error);
    gluTessCallback(tess, GLU_TESS_COMBINE_DATA, (_GLUfuncptr)on_combine);
    gluTessProperty(tess, GLU_TESS_WINDING_RULE, ring_count > 1 ? GLU_TESS_WINDING_POSITIVE : GLU_TESS_WINDING_ODD);
    gluTessNormal(tess, 0, 0, 1);
    gluTessBeginPolygon(tess, &job);
    size_t i = 0;
    bool turned = sweep_along_v(uv, ring_size, ring_count);
    for (size_t r = 0; r < ring_count; r++) {
        gluTessBeginContour(tess);
        for (size_t end = i + ring_size[r]; i < end; i++) {
            GLdouble place[3] = { turned ? uv[2 * i + 1] : uv[2 * i], turned ? -uv[2 * i] : uv[2 * i + 1], 0 };
            gluTessVertex(tess, place, as_pointer(first_vertex + i));
        }
        gluTessEndContour(tess);
    }
    gluTessEndPolygon(tess);
    gluDeleteTess(tess);
    if ((out->indices.len - job.first_index) % 3) { /* GLU gave up in a triangle */
        out->indices.len = job.first_index;
        job.result.ok = false;
    }
    return job.result;
}
