/* Polygons are cut into triangles by GLU's tessellator, whose time grows with points times edges that its sweep meets
 * at once. Where that would be long, the plane is halved until each piece is small. */
#include "geo/tessellate.h"

#include <GL/glu.h>
#include <math.h>

struct job {
    geo_triangles *out;
    size_t first_index;
    size_t first_made; /* vertices from here on lie on the edges of pieces: what meets there says nothing of the ring */
    tessellation result;
};

static void refuse(struct job *job) {
    job->result.no_memory = true;
    job->result.ok = false;
}

static void *as_pointer(size_t vertex) {
    return (void *)(uintptr_t)(vertex + 1);
} /* never NULL: GLU gives NULL for none */

static void on_vertex(void *data, void *user) {
    struct job *job = user;
    if (!array_push(&job->out->indices, (uint32_t)((uintptr_t)data - 1)))
        refuse(job);
}

/* Its presence makes GLU give plain triangles, neither strips nor fans. */
static void on_edge_flag(GLboolean flag, void *user) { (void)flag, (void)user; }

static void on_error(GLenum error, void *user) {
    struct job *job = user;
    job->result.ok = false;
    job->result.no_memory |= error == GLU_OUT_OF_MEMORY;
}

/* Edges cross, or points coincide. The new vertex lies between its (up to) four neighbours in space, so that a ring
 * that is not flat stays closed. */
static void on_combine(GLdouble place[3], void *data[4], GLfloat weight[4], void **out, void *user) {
    (void)place;
    struct job *job = user;
    double p[3] = { 0 }, sum = 0;
    float at[2] = { 0 };
    bool in_image = job->out->uv.len > 0;
    size_t count = 0;
    for (int i = 0; i < 4 && data[i]; i++, count++)
        sum += weight[i];
    bool touch = true, given = true;
    for (size_t i = 0; i < count; i++) {
        given = given && (uintptr_t)data[i] - 1 < job->first_made;
        const double *q = job->out->xyz.data + 3 * ((uintptr_t)data[i] - 1);
        const double *q0 = job->out->xyz.data + 3 * ((uintptr_t)data[0] - 1);
        for (int k = 0; k < 3; k++) {
            p[k] += q[k] * (double)weight[i] / sum;
            touch = touch && q[k] == q0[k];
        }
        for (size_t k = 0; k < 2 && in_image; k++)
            at[k] += job->out->uv.data[2 * ((uintptr_t)data[i] - 1) + k] * (float)((double)weight[i] / sum);
    }
    if (touch) {
        job->result.touches += given;
        *out = data[0];
        return;
    }
    /* two points: they coincide in the plane alone; four: a crossing */
    if (count > 2)
        job->result.crossings += given;
    else
        job->result.touches += given;
    *out = as_pointer(job->out->xyz.len / 3);
    if ((in_image && !array_append(&job->out->uv, at, 2)) || !array_append(&job->out->xyz, p, 3)) {
        *out = data[0];
        refuse(job);
    }
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

#define MANY_CROSSINGS 1000  /* of a polygon; and no more than */
#define FEW_CROSSINGS 10     /* or than it has points: each becomes a vertex and triangles of its own */
#define PAIRS_A_POINT 1000   /* of edges that are looked at; the rest is extrapolated */
#define PAIR_BUDGET 20000000 /* the same, of a polygon */
#define TOO_FEW_POINTS 6     /* to cross more often than that: a ring of six points has nine pairs of edges apart */

/* Each crossing costs the tessellator time that grows with the number of edges: a ring of a few thousand random points
 * takes minutes. And many small rings whose edges all cross are as many triangles as the square of their points. */
static bool crosses_too_often(struct job *job, const double *uv, const size_t *ring_size, size_t ring_count,
                              size_t points) {
    if (points <= TOO_FEW_POINTS)
        return false;
    edge *edges = noc_alloc(points * sizeof(*edges));
    if (!edges) {
        refuse(job);
        return false;
    }
    size_t n = 0, crossings = 0, pairs = 0, i = 0, most_pairs = NOC_MIN(PAIRS_A_POINT * points, (size_t)PAIR_BUDGET);
    size_t limit = NOC_CLAMP(points, (size_t)FEW_CROSSINGS, (size_t)MANY_CROSSINGS);
    for (size_t r = 0; r < ring_count; uv += 2 * ring_size[r++])
        for (size_t k = 0; k < ring_size[r]; k++) {
            const double *a = uv + 2 * k, *b = uv + 2 * ((k + 1) % ring_size[r]);
            edges[n++] = (edge){ NOC_MIN(a[0], b[0]), a, b };
        }
    qsort(edges, n, sizeof(*edges), by_lo);
    for (; i < n && crossings <= limit && pairs < most_pairs; i++) {
        double hi = NOC_MAX(edges[i].a[0], edges[i].b[0]);
        for (size_t j = i + 1; j < n && edges[j].lo <= hi; j++, pairs++)
            crossings += cross_properly(&edges[i], &edges[j]);
    }
    bool too_often = (double)crossings * (double)n > (double)limit * (double)NOC_MAX(i, 1);
    free(edges);
    return too_often;
}

/* ---- pieces ---- */

/* Part of a polygon: rings of points in the plane, and the vertices they are in the output. */
typedef struct piece {
    NOC_ARRAY(double) uv;
    NOC_ARRAY(uint32_t) vertex;
    NOC_ARRAY(size_t) ring_size;
} piece;

static void piece_free(piece *p) {
    array_free(&p->uv);
    array_free(&p->vertex);
    array_free(&p->ring_size);
}

/* Directions that a polygon may be swept along: u, v, and across most of its edges' length (the minor axis of their
 * second moments): teeth of a comb are swept one after the other however they are turned. */
enum { ALONG_U, ALONG_V, ACROSS_EDGES, DIRECTIONS };

static void directions(const piece *p, double axis[DIRECTIONS][2]) {
    double uu = 0, uv = 0, vv = 0;
    const double *at = p->uv.data;
    for (size_t r = 0; r < p->ring_size.len; at += 2 * p->ring_size.data[r++])
        for (size_t i = 0, n = p->ring_size.data[r]; i < n; i++) {
            const double *a = at + 2 * i, *b = at + 2 * (i + 1 < n ? i + 1 : 0);
            double u = b[0] - a[0], v = b[1] - a[1], length = sqrt(u * u + v * v);
            if (length > 0)
                uu += u * u / length, uv += u * v / length, vv += v * v / length;
        }
    double angle = 0.5 * atan2(2 * uv, uu - vv); /* of the major axis */
    const double all[DIRECTIONS][2] = { { 1, 0 }, { 0, 1 }, { -sin(angle), cos(angle) } };
    memcpy(axis, all, sizeof(all));
}

/* Lengths of all edges along each direction, over the polygon's extent: the edges that a line across it meets on
 * average. */
static void edges_at_once(const piece *p, const double axis[DIRECTIONS][2], double met[DIRECTIONS]) {
    double length[DIRECTIONS] = { 0 }, lo[DIRECTIONS], hi[DIRECTIONS];
    for (int d = 0; d < DIRECTIONS; d++)
        lo[d] = INFINITY, hi[d] = -INFINITY;
    const double *uv = p->uv.data;
    for (size_t r = 0; r < p->ring_size.len; uv += 2 * p->ring_size.data[r++])
        for (size_t i = 0, n = p->ring_size.data[r]; i < n; i++) {
            const double *a = uv + 2 * i, *b = uv + 2 * (i + 1 < n ? i + 1 : 0);
            for (int d = 0; d < DIRECTIONS; d++) {
                double x = a[0] * axis[d][0] + a[1] * axis[d][1];
                length[d] += fabs((b[0] - a[0]) * axis[d][0] + (b[1] - a[1]) * axis[d][1]);
                lo[d] = NOC_MIN(lo[d], x);
                hi[d] = NOC_MAX(hi[d], x);
            }
        }
    for (int d = 0; d < DIRECTIONS; d++)
        met[d] = hi[d] > lo[d] ? length[d] / (hi[d] - lo[d]) : INFINITY;
}

/* The direction that meets the fewest; another than u and v only where those meet more than enough, and it is worth the
 * rounding. */
static int best_direction(const double met[DIRECTIONS], double enough) {
    int best = met[ALONG_V] < met[ALONG_U] ? ALONG_V : ALONG_U;
    return met[best] > enough && met[ACROSS_EDGES] < 0.5 * met[best] ? ACROSS_EDGES : best;
}

/* Turns the plane so that a direction becomes u. */
static void turn(piece *p, const double axis[2]) {
    for (size_t i = 0; i < p->vertex.len && axis[0] != 1; i++) {
        double *uv = p->uv.data + 2 * i, u = uv[0] * axis[0] + uv[1] * axis[1];
        uv[1] = uv[1] * axis[0] - uv[0] * axis[1];
        uv[0] = u;
    }
}

/* By GLU, which sweeps along u. */
static void sweep(struct job *job, const piece *p, bool odd) {
    GLUtesselator *tess = gluNewTess();
    if (!tess) {
        refuse(job);
        return;
    }
    gluTessCallback(tess, GLU_TESS_VERTEX_DATA, (_GLUfuncptr)on_vertex);
    gluTessCallback(tess, GLU_TESS_EDGE_FLAG_DATA, (_GLUfuncptr)on_edge_flag);
    gluTessCallback(tess, GLU_TESS_ERROR_DATA, (_GLUfuncptr)on_error);
    gluTessCallback(tess, GLU_TESS_COMBINE_DATA, (_GLUfuncptr)on_combine);
    gluTessProperty(tess, GLU_TESS_WINDING_RULE, odd ? GLU_TESS_WINDING_ODD : GLU_TESS_WINDING_POSITIVE);
    gluTessNormal(tess, 0, 0, 1);
    gluTessBeginPolygon(tess, job);
    for (size_t r = 0, i = 0; r < p->ring_size.len; r++) {
        gluTessBeginContour(tess);
        for (size_t end = i + p->ring_size.data[r]; i < end; i++) {
            GLdouble place[3] = { p->uv.data[2 * i], p->uv.data[2 * i + 1], 0 };
            gluTessVertex(tess, place, as_pointer(p->vertex.data[i]));
        }
        gluTessEndContour(tess);
    }
    gluTessEndPolygon(tess);
    gluDeleteTess(tess);
    if ((job->out->indices.len - job->first_index) % 3) { /* GLU gave up in a triangle */
        job->out->indices.len = job->first_index;
        job->result.ok = false;
    }
}

/* Where an edge crosses the cut. */
typedef struct crossing {
    double v;
    uint32_t vertex; /* made there */
    size_t to;       /* the point that the edge leads to */
    size_t edge;     /* the point that it comes from */
    size_t partner;  /* crossing that a ring goes on from, along the cut */
    bool up;         /* from the lower half to the upper one */
} crossing;

typedef struct cut_line {
    double at;
    size_t *next;    /* of each point: the one behind it in its ring */
    size_t *crossed; /* of each point: crossing + 1 of its edge, 0 if none; SIZE_MAX once it is in a half */
    NOC_ARRAY(crossing) crossings;
} cut_line;

static int by_v(const void *x, const void *y) {
    const crossing *a = x, *b = y;
    return a->v != b->v ? (a->v > b->v) - (a->v < b->v) : (a->edge > b->edge) - (a->edge < b->edge);
}

static void find_crossings(struct job *job, const piece *p, cut_line *line) {
    const double *uv = p->uv.data;
    for (size_t r = 0, base = 0; r < p->ring_size.len; base += p->ring_size.data[r++])
        for (size_t i = 0, n = p->ring_size.data[r]; i < n; i++) {
            size_t a = base + i, b = base + (i + 1 < n ? i + 1 : 0);
            line->next[a] = b;
            if ((uv[2 * a] > line->at) == (uv[2 * b] > line->at))
                continue;
            double t = (line->at - uv[2 * a]) / (uv[2 * b] - uv[2 * a]), xyz[3];
            const double *x = job->out->xyz.data + 3 * (size_t)p->vertex.data[a];
            const double *y = job->out->xyz.data + 3 * (size_t)p->vertex.data[b];
            for (int k = 0; k < 3; k++)
                xyz[k] = x[k] + t * (y[k] - x[k]);
            float at[2];
            const float *in_image = job->out->uv.len ? job->out->uv.data : NULL;
            for (size_t k = 0; k < 2 && in_image; k++) {
                float from = in_image[2 * (size_t)p->vertex.data[a] + k],
                      to = in_image[2 * (size_t)p->vertex.data[b] + k];
                at[k] = from + (float)t * (to - from);
            }
            crossing c = { .v = uv[2 * a + 1] + t * (uv[2 * b + 1] - uv[2 * a + 1]),
                           .vertex = (uint32_t)(job->out->xyz.len / 3),
                           .to = b,
                           .edge = a,
                           .up = uv[2 * b] > line->at };
            if ((in_image && !array_append(&job->out->uv, at, 2)) || !array_append(&job->out->xyz, xyz, 3) ||
                !array_push(&line->crossings, c)) {
                refuse(job);
                return;
            }
        }
}

/* Joins ends along the cut: each with the next one of the other direction that has no partner, like brackets. Where no
 * rings cross these are neighbours, so that no two joints overlap. */
static void join_ends(struct job *job, cut_line *line) {
    crossing *c = line->crossings.data;
    size_t n = line->crossings.len, depth = 0, *open = noc_alloc((n + 1) * sizeof(*open));
    if (!open) {
        refuse(job);
        return;
    }
    if (n)
        qsort(c, n, sizeof(*c), by_v);
    for (size_t i = 0; i < n; i++) {
        line->crossed[c[i].edge] = i + 1;
        if (depth && c[open[depth - 1]].up != c[i].up) {
            c[i].partner = open[--depth];
            c[c[i].partner].partner = i;
        } else {
            open[depth++] = i;
        }
    }
    free(open);
}

/* Into room that was reserved. */
static void put_point(piece *p, double u, double v, uint32_t vertex) {
    p->uv.data[p->uv.len++] = u;
    p->uv.data[p->uv.len++] = v;
    p->vertex.data[p->vertex.len++] = vertex;
}

/* Cuts a piece in two where u is `at`. */
static void cut(struct job *job, const piece *p, double at, piece half[2]) {
    size_t n = p->vertex.len;
    cut_line line = { .at = at,
                      .next = noc_alloc(n * sizeof(*line.next)),
                      .crossed = noc_calloc(n, sizeof(*line.crossed)) };
    if (!line.next || !line.crossed)
        refuse(job);
    if (job->result.ok)
        find_crossings(job, p, &line);
    if (job->result.ok)
        join_ends(job, &line);
    size_t most = n + 2 * line.crossings.len; /* in either half */
    for (int i = 0; i < 2 && job->result.ok; i++)
        if (!array_reserve(&half[i].uv, 2 * most) || !array_reserve(&half[i].vertex, most) ||
            !array_reserve(&half[i].ring_size, most / 3 + 1))
            refuse(job);
    for (size_t start = 0; start < n && job->result.ok; start++) {
        piece *to = &half[p->uv.data[2 * start] > at];
        size_t first = to->vertex.len;
        for (size_t i = start; line.crossed[i] != SIZE_MAX;) {
            size_t c = line.crossed[i];
            line.crossed[i] = SIZE_MAX;
            put_point(to, p->uv.data[2 * i], p->uv.data[2 * i + 1], p->vertex.data[i]);
            i = line.next[i];
            if (!c)
                continue;
            const crossing *out = &line.crossings.data[c - 1], *in = &line.crossings.data[out->partner];
            put_point(to, at, out->v, out->vertex);
            put_point(to, at, in->v, in->vertex);
            i = in->to;
        }
        if (to->vertex.len - first >= 3) {
            to->ring_size.data[to->ring_size.len++] = to->vertex.len - first;
        } else {
            to->vertex.len = first;
            to->uv.len = 2 * first;
        }
    }
    free(line.next);
    free(line.crossed);
    array_free(&line.crossings);
}

static int by_value(const void *x, const void *y) {
    double a = *(const double *)x, b = *(const double *)y;
    return (a > b) - (a < b);
}

/* Median of a sample of the points' u, or the middle between the first and last where it is one of these: points of
 * earlier cuts lie there in numbers. */
static double middle(const piece *p) {
    enum { SAMPLE = 1023 };
    double sample[SAMPLE];
    size_t n = NOC_MIN(p->vertex.len, (size_t)SAMPLE);
    for (size_t i = 0; i < n; i++)
        sample[i] = p->uv.data[2 * (size_t)((double)i / (double)n * (double)p->vertex.len)];
    qsort(sample, n, sizeof(*sample), by_value);
    double median = sample[n / 2], lo = sample[0], hi = sample[n - 1];
    return median > lo && median < hi ? median : (lo + hi) / 2;
}

#define WORK_AT_ONCE 2e7  /* points times edges met at once, that GLU does in a second */
#define HOLE_WORK 0.25    /* edges met at once that a ring costs as much as: GLU numbers all its edges anew */
#define WORK_OF_PIECE 2e5 /* the same, of pieces: small ones cost less in all, but their cuts show in the triangles */
#define POINTS_AT_ONCE 500000 /* GLU takes half a kilobyte a point */
#define MOST_MADE 8           /* points made by cutting, a point given */

struct division {
    bool odd;
    double most_work;
    size_t most_vertices;
};

/* Takes p's memory. */
static void tessellate_piece(struct job *job, piece *p, const struct division *d) {
    double axis[DIRECTIONS][2], met[DIRECTIONS];
    directions(p, axis);
    edges_at_once(p, axis, met);
    size_t n = p->vertex.len;
    int direction = best_direction(met, d->most_work / (double)n);
    turn(p, axis[direction]);
    double work = (double)n * (met[direction] + HOLE_WORK * (double)p->ring_size.len);
    piece half[2] = { 0 };
    if (n > POINTS_AT_ONCE || work > d->most_work)
        cut(job, p, middle(p), half);
    if (!job->result.ok) {
        piece_free(p);
        piece_free(&half[0]);
        piece_free(&half[1]);
        return;
    }
    bool whole = !half[0].vertex.len && !half[1].vertex.len, smaller = half[0].vertex.len < n && half[1].vertex.len < n;
    if (whole || (!smaller && n <= POINTS_AT_ONCE && work <= WORK_AT_ONCE))
        sweep(job, p, d->odd);
    else
        job->result.ok = job->result.ok && smaller && job->out->xyz.len / 3 <= d->most_vertices;
    piece_free(p);
    const struct division further = { d->odd, WORK_OF_PIECE, d->most_vertices };
    for (int i = 0; i < 2; i++) {
        if (smaller && !whole && job->result.ok)
            tessellate_piece(job, &half[i], &further);
        else
            piece_free(&half[i]);
    }
}

tessellation tessellate(const double *uv, const size_t *ring_size, size_t ring_count, geo_triangles *out,
                        size_t first_vertex) {
    size_t points = 0;
    for (size_t r = 0; r < ring_count; r++)
        points += ring_size[r];
    struct job job = {
        .out = out, .first_index = out->indices.len, .first_made = first_vertex + points, .result = { .ok = true }
    };
    if (crosses_too_often(&job, uv, ring_size, ring_count, points))
        return (tessellation){ .tangled = true };
    piece whole = { 0 };
    size_t numbers = 2 * points;
    if (!job.result.ok || !array_append(&whole.uv, uv, numbers) ||
        !array_append(&whole.ring_size, ring_size, ring_count) || !array_reserve(&whole.vertex, points)) {
        refuse(&job);
        piece_free(&whole);
        return job.result;
    }
    while (whole.vertex.len < points) {
        whole.vertex.data[whole.vertex.len] = (uint32_t)(first_vertex + whole.vertex.len);
        whole.vertex.len++;
    }
    const struct division division = { ring_count == 1, WORK_AT_ONCE, first_vertex + (MOST_MADE + 1) * points };
    tessellate_piece(&job, &whole, &division);
    return job.result;
}
