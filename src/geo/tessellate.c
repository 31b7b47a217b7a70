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

tessellation tessellate(const double *uv, const size_t *ring_size, size_t ring_count, geo_triangles *out,
                        size_t first_vertex) {
    struct job job = { .out = out, .first_index = out->indices.len, .result = { .ok = true } };
    GLUtesselator *tess = gluNewTess();
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
    for (size_t r = 0; r < ring_count; r++) {
        gluTessBeginContour(tess);
        for (size_t end = i + ring_size[r]; i < end; i++) {
            GLdouble place[3] = { uv[2 * i], uv[2 * i + 1], 0 };
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
