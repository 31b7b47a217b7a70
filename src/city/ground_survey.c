/* A ground of our own through surveyed heights: lamps that tell their elevation, and the feet of buildings.
 *
 * Successive corrections (P. Bergthorsson and B. R. Doos, "Numerical weather map analysis", Tellus 7, 1955; G. P.
 * Cressman, Monthly Weather Review 87, 1959): what the field lacks at the points is spread around them, first widely,
 * then ever more narrowly, so that it runs smoothly between them. Our weights end in 0 at the radius, and a lone point
 * spreads no more than its share. At last the corners around each lamp are moved by the least that brings the mesh
 * through it. */
#include "city/ground_field.h"

#include <math.h>

#define WIDEST 60.0 /* m: of the first correction */
#define FOOT_WEIGHT                                                                                                    \
    .5 /* of a cell of feet beside a lamp's 1: they begin below the street where there are basements                   \
        */
#define SWEEPS 40

typedef struct around {
    size_t corner[3];
    double weight[3];
} around;

/* The corners of the mesh's triangle at (x, y); outside of the middles the border's heights go on. */
static around find(const ground_field *f, double x, double y) {
    double u = NOC_CLAMP((x - f->min[0]) / f->step[0] - .5, 0, f->nx - 1),
           v = NOC_CLAMP((y - f->min[1]) / f->step[1] - .5, 0, f->ny - 1);
    int i = NOC_MIN((int)u, f->nx - 2), j = NOC_MIN((int)v, f->ny - 2);
    double s = u - i, t = v - j;
    size_t a = (size_t)j * (size_t)f->nx + (size_t)i, c = a + (size_t)f->nx;
    return s >= t ? (around){ { a, a + 1, c + 1 }, { 1 - s, s - t, t } }
                  : (around){ { a, c, c + 1 }, { 1 - t, t - s, s } };
}

static double height_at(const ground_field *f, const around *at) {
    double h = 0;
    for (int k = 0; k < 3; k++)
        h += at->weight[k] * f->height[at->corner[k]];
    return h;
}

double field_height(const ground_field *f, double x, double y) {
    around at = find(f, x, y);
    return height_at(f, &at);
}

/* Chamfer distances: two sweeps, there and back, over the neighbours that came before. */
void field_measure(ground_field *f) {
    size_t n = (size_t)f->nx * (size_t)f->ny;
    double dx = f->step[0], dy = f->step[1];
    const struct {
        int i, j;
        double d;
    } before[] = { { -1, 0, dx }, { -1, -1, hypot(dx, dy) }, { 0, -1, dy }, { 1, -1, hypot(dx, dy) } };
    for (size_t i = 0; i < n; i++)
        f->away[i] = f->fixed[i] ? 0 : INFINITY;
    for (int back = 0; back < 2; back++)
        for (size_t c = 0; c < n; c++) {
            size_t cell = back ? n - 1 - c : c;
            int x = (int)(cell % (size_t)f->nx), y = (int)(cell / (size_t)f->nx);
            for (size_t k = 0; k < NOC_COUNT(before); k++) {
                int u = x + (back ? -before[k].i : before[k].i), v = y + (back ? -before[k].j : before[k].j);
                if (u >= 0 && v >= 0 && u < f->nx && v < f->ny)
                    f->away[cell] =
                        (float)NOC_MIN(f->away[cell], f->away[(size_t)v * (size_t)f->nx + (size_t)u] + before[k].d);
            }
        }
}

double field_distance(const ground_field *f, double x, double y) {
    int i = (int)NOC_CLAMP((x - f->min[0]) / f->step[0], 0, f->nx - 1),
        j = (int)NOC_CLAMP((y - f->min[1]) / f->step[1], 0, f->ny - 1);
    return f->away[(size_t)j * (size_t)f->nx + (size_t)i];
}

/* What one point lacks, spread over the cells within a radius. */
static void spread(const ground_field *f, double *sum, double *weight, double x, double y, double lack, double share,
                   double radius) {
    int lo[2], hi[2], n[2] = { f->nx, f->ny };
    const double p[2] = { x, y };
    for (int k = 0; k < 2; k++) {
        lo[k] = (int)NOC_CLAMP((p[k] - radius - f->min[k]) / f->step[k], 0, n[k] - 1);
        hi[k] = (int)NOC_CLAMP((p[k] + radius - f->min[k]) / f->step[k], 0, n[k] - 1);
    }
    for (int j = lo[1]; j <= hi[1]; j++)
        for (int i = lo[0]; i <= hi[0]; i++) {
            double dx = f->min[0] + (i + .5) * f->step[0] - x, dy = f->min[1] + (j + .5) * f->step[1] - y;
            double q = 1 - (dx * dx + dy * dy) / (radius * radius);
            if (q <= 0)
                continue;
            size_t cell = (size_t)j * (size_t)f->nx + (size_t)i;
            sum[cell] += share * q * q * lack;
            weight[cell] += share * q * q;
        }
}

static void correct(ground_field *f, const double *points, size_t count, double radius) {
    size_t n = (size_t)f->nx * (size_t)f->ny;
    double *sum = f->scratch, *weight = sum + n;
    memset(sum, 0, 2 * n * sizeof(*sum));
    for (size_t i = 0; i < count; i++)
        if (isfinite(points[3 * i + 2]))
            spread(f, sum, weight, points[3 * i], points[3 * i + 1],
                   points[3 * i + 2] - field_height(f, points[3 * i], points[3 * i + 1]), 1, radius);
    for (size_t i = 0; i < n; i++)
        if (!isnan(f->foot[i]))
            spread(f, sum, weight, f->min[0] + ((double)(i % (size_t)f->nx) + .5) * f->step[0],
                   f->min[1] + ((double)(i / (size_t)f->nx) + .5) * f->step[1], (double)f->foot[i] - f->height[i],
                   FOOT_WEIGHT, radius);
    for (size_t i = 0; i < n; i++)
        f->height[i] += (float)(sum[i] / NOC_MAX(weight[i], 1));
}

static void keep_under_streets(ground_field *f) {
    for (size_t i = 0; i < (size_t)f->nx * (size_t)f->ny; i++)
        f->height[i] = NOC_MIN(f->height[i], f->street[i]);
}

/* Kaczmarz' projections. No corner moves farther than twice what its lamps lack: two lamps side by side on different
 * levels, or one with a wrong place, make no spike. */
static void run_through(ground_field *f, const double *points, size_t count) {
    size_t n = (size_t)f->nx * (size_t)f->ny;
    float *was = (float *)f->scratch, *most = was + n;
    memcpy(was, f->height, n * sizeof(*was));
    memset(most, 0, n * sizeof(*most));
    for (int sweep = 0; sweep <= SWEEPS; sweep++) /* the first one measures */
        for (size_t i = 0; i < count; i++) {
            if (!isfinite(points[3 * i + 2]))
                continue;
            around at = find(f, points[3 * i], points[3 * i + 1]);
            double lack = points[3 * i + 2] - height_at(f, &at), length = 0;
            for (int k = 0; k < 3; k++)
                length += at.weight[k] * at.weight[k];
            for (int k = 0; k < 3; k++) {
                size_t c = at.corner[k];
                if (sweep == 0)
                    most[c] = NOC_MAX(most[c], 2 * (float)fabs(lack));
                else
                    f->height[c] = NOC_CLAMP(f->height[c] + (float)(at.weight[k] * lack / length), was[c] - most[c],
                                             was[c] + most[c]);
            }
        }
}

void field_follow(ground_field *f, const double *points, size_t count) {
    double step = NOC_MAX(f->step[0], f->step[1]);
    for (double radius = NOC_MAX(WIDEST, 4 * step); radius >= 2 * step; radius /= 2)
        correct(f, points, count, radius);
    keep_under_streets(f);
    run_through(f, points, count);
    keep_under_streets(f);
}
