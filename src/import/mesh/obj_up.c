/* A city with z up that is read with y up stands on its edge: as high as it is long, over a strip as wide as its houses
 * are high; and where its coordinates are those of a map, thousands of kilometres above the ground. */
#include "import/mesh/obj_up.h"

#include <math.h>

#define HIGHEST 9000.0 /* m above the sea, and the lowest below it, that ground lies on Earth */
#define LOWEST (-500.0)
#define TALL 200.0 /* m that few models are high, and cities long */
#define FLAT 5.0   /* times as long and as wide as it is high: a city, no tower and no slab */
#define WALLS .3   /* least area that faces up, of that which faces east */

static void add_vertex(obj_spread *s, const double p[3]) {
    if (!isfinite(p[0]) || !isfinite(p[1]) || !isfinite(p[2]))
        return;
    s->count++;
    /* B. P. Welford, Technometrics 4 (1962): far from zero sums of squares would not do */
    for (int k = 0; k < 3; k++) {
        double d = p[k] - s->mean[k];
        s->mean[k] += d / (double)s->count;
        s->square[k] += d * (p[k] - s->mean[k]);
    }
}

void obj_spread_add(obj_spread *s, const double *xyz, size_t vertices, const uint32_t *indices, size_t triangles) {
    for (size_t i = 0; i < vertices; i++)
        add_vertex(s, xyz + 3 * i);
    for (size_t t = 0; t < triangles; t++) {
        if (indices[3 * t] >= vertices || indices[3 * t + 1] >= vertices || indices[3 * t + 2] >= vertices)
            continue; /* the scene drops it */
        const uint32_t *corner = indices + 3 * t;
        const double *a = xyz + 3 * (size_t)corner[0], *b = xyz + 3 * (size_t)corner[1],
                     *c = xyz + 3 * (size_t)corner[2];
        for (int k = 0; k < 3; k++) {
            int u = (k + 1) % 3, v = (k + 2) % 3;
            double area = fabs((b[u] - a[u]) * (c[v] - a[v]) - (b[v] - a[v]) * (c[u] - a[u])) / 2;
            s->area[k] += isfinite(area) ? area : 0;
        }
    }
}

static bool on_earth(double height) { return height >= LOWEST && height <= HIGHEST; }

void obj_check_up(const obj_spread *s, bool z_up, const char *path, noc_log *log) {
    if (s->count < 3)
        return;
    double length[3]; /* what two heaps of vertices at its ends would have, about: a stray vertex does not make it */
    for (int k = 0; k < 3; k++)
        length[k] = 2 * sqrt(s->square[k] / (double)s->count);
    double other = z_up ? s->mean[1] : -s->mean[1]; /* the height, were the other axis up */
    bool aloft = !on_earth(s->mean[2]) && on_earth(other);
    /* on its edge: its walls then face as much up as they face east; a tower's, or a front's, do not */
    bool on_edge =
        length[2] > TALL && NOC_MIN(length[0], length[2]) > FLAT * length[1] && s->area[2] > WALLS * s->area[0];
    if (!aloft && !on_edge)
        return;
    noc_warn(
        log,
        "%s: read with %c up it is some %.0f m high, over %.0f x %.0f m, at a height of %.0f m: is %c up? --obj-up %c "
        "reads it so",
        path, z_up ? 'z' : 'y', length[2], length[0], length[1], s->mean[2], z_up ? 'y' : 'z', z_up ? 'y' : 'z');
}
