#include "import/mesh/polygons.h"

#include <math.h>

#define WORKING_SIZE                                                                                                   \
    100.0 /* m; geo_triangulate's tolerances are for buildings, so a polygon is cut at the size of one */

static void area_vector(const double *a, const double *b, const double *c, double out[3]) {
    double e[3], f[3];
    for (int k = 0; k < 3; k++)
        e[k] = b[k] - a[k], f[k] = c[k] - a[k];
    for (int k = 0; k < 3; k++)
        out[k] = e[(k + 1) % 3] * f[(k + 2) % 3] - e[(k + 2) % 3] * f[(k + 1) % 3];
}

static bool same_side(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] > 0; }

static void add_triangle(cut_mesh *m, unsigned a, unsigned b, unsigned c) {
    uint32_t *to = m->indices + 3 * m->triangle_count++;
    to[0] = a;
    to[1] = b;
    to[2] = c;
}

/* Along a diagonal that leaves both triangles on the same side; false where none does (it crosses itself, or is flat).
 */
static bool cut_quad(cut_mesh *m, const unsigned *v) {
    for (int first = 0; first < 2; first++) {
        unsigned a = v[first], b = v[first + 1], c = v[first + 2], d = v[(first + 3) % 4];
        double one[3], other[3];
        area_vector(m->xyz + 3 * (size_t)a, m->xyz + 3 * (size_t)b, m->xyz + 3 * (size_t)c, one);
        area_vector(m->xyz + 3 * (size_t)a, m->xyz + 3 * (size_t)c, m->xyz + 3 * (size_t)d, other);
        if (same_side(one, other)) {
            add_triangle(m, a, b, c);
            add_triangle(m, a, c, d);
            return true;
        }
    }
    return false;
}

static void cut_polygon(cut_mesh *m, const unsigned *corner, size_t count) {
    double *ring = noc_alloc(3 * count * sizeof(*ring)), lo[3], hi[3], size = 0;
    float *uv = m->uv ? noc_alloc(2 * count * sizeof(*uv)) : NULL;
    if (!ring || (m->uv && !uv)) {
        m->extra.no_memory = true;
        free(ring);
        free(uv);
        return;
    }
    for (size_t i = 0; i < count && uv; i++)
        memcpy(uv + 2 * i, m->uv + 2 * (size_t)corner[i], 2 * sizeof(*uv));
    bool finite = true;
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) {
            double x = m->xyz[3 * (size_t)corner[i] + (size_t)k];
            ring[3 * i + (size_t)k] = x;
            lo[k] = i ? NOC_MIN(lo[k], x) : x;
            hi[k] = i ? NOC_MAX(hi[k], x) : x;
            finite = finite && isfinite(x);
        }
    for (int k = 0; k < 3; k++)
        size = NOC_MAX(size, hi[k] - lo[k]);
    if (!finite || !(size > 0 && isfinite(size))) {
        geo_issue(m->issues, finite && !(size > 0) ? GEO_SPARED : GEO_SKIPPED,
                  finite && !(size > 0) ? "polygon of no extent" : "polygon with a coordinate that is no number",
                  m->name);
    } else {
        double scale = WORKING_SIZE / size;
        for (size_t i = 0; i < 3 * count; i++)
            ring[i] = (ring[i] - lo[i % 3]) * scale;
        const geo_polygon polygon = {
            .cls = NOC_CLASS_OTHER, .id = m->name, .ring_count = 1, .ring_size = &count, .xyz = ring, .uv = uv
        };
        size_t before = m->extra.xyz.len;
        if (geo_triangulate(&polygon, &m->extra, m->issues))
            for (size_t i = before; i < m->extra.xyz.len; i++)
                m->extra.xyz.data[i] = m->extra.xyz.data[i] / scale + lo[(i - before) % 3];
    }
    free(ring);
    free(uv);
}

void cut_face(cut_mesh *m, const unsigned *corner, size_t count) {
    if (count == 3)
        add_triangle(m, corner[0], corner[1], corner[2]);
    else if (count > 3 && (count > 4 || !cut_quad(m, corner)))
        cut_polygon(m, corner, count);
}
