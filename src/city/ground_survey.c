/* A ground of our own through surveyed heights: lamps that tell their elevation, and the feet of buildings.
 *
 * Successive corrections (P. Bergthorsson and B. R. Doos, "Numerical weather map analysis", Tellus 7, 1955; G. P. Cressman, Monthly
 * Weather Review 87, 1959): what the field lacks at the points is spread around them, first widely, then ever more narrowly, so that
 * it runs smoothly between them. Our weights end in 0 at the radius, and a lone point spreads no more than its share. At last the
 * corners around each lamp are moved by the least that brings the mesh through it (Kaczmarz' projections). */
#include "city/ground_field.h"

#include <math.h>

#define WIDEST 60.0   /* m: of the first correction */
#define FOOT_WEIGHT .5 /* of a cell of feet beside a lamp's 1: they begin below the street where there are basements */
#define SWEEPS 40

typedef struct around {
    size_t corner[3];
    double weight[3];
} around;

/* The corners of the mesh's triangle at (x, y); outside of the middles the border's heights go on. */
static around find(const ground_field *f, double x, double y) {
    double u = NOC_CLAMP((x - f->min[0]) / f->step[0] - .5, 0, f->nx - 1), v = NOC_CLAMP((y - f->min[1]) / f->step[1] - .5, 0, f->ny - 1);
    int i = NOC_MIN((int)u, f->nx - 2), j = NOC_MIN((int)v, f->ny - 2);
    double s = u - i, t = v - j;
    size_t a = (size_t)j * (size_t)f->nx + (size_t)i, c = a + (size_t)f->nx;
    return s >= t ? (around){ { a, a + 1, c + 1 }, { 1 - s, s - t, t } } : (around){ { a, c, c + 1 }, { 1 - t, t - s, s } };
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

double field_distance(const ground_field *f, double x, double y) {
    int cx = (int)NOC_CLAMP((x - f->min[0]) / f->step[0], 0, f->nx - 1), cy = (int)NOC_CLAMP((y - f->min[1]) / f->step[1], 0, f->ny - 1);
    double best = INFINITY, step = NOC_MIN(f->step[0], f->step[1]);
    for (int r = 0; r < NOC_MAX(f->nx, f->ny) && (r - 1) * step < best; r++) /* rings of cells */
        for (int j = -r; j <= r; j++)
            for (int i = -r; i <= r; i += abs(j) == r ? 1 : NOC_MAX(2 * r, 1)) {
                int a = cx + i, b = cy + j;
                if (a >= 0 && b >= 0 && a < f->nx && b < f->ny && f->fixed[(size_t)b * (size_t)f->nx + (size_t)a])
                    best = NOC_MIN(best, hypot(i * f->step[0], j * f->step[1]));
            }
    return best;
}

/* What one point lacks, spread over the cells within a radius. */
static void spread(const ground_field *f, double *sum, double *weight, double x, double y, double lack, double share, double radius) {
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

static void correct(ground_field *f, const double *points, size_t count, double radius, double *sum) {
    size_t n = (size_t)f->nx * (size_t)f->ny;
    double *weight = sum + n;
    memset(sum, 0, 2 * n * sizeof(*sum));
    for (size_t i = 0; i < count; i++)
        if (isfinite(points[3 * i + 2]))
            spread(f, sum, weight, points[3 * i], points[3 * i + 1], points[3 * i + 2] - field_height(f, points[3 * i], points[3 * i + 1]), 1,
                   radius);
    for (size_t i = 0; i < n; i++)
        if (!isnan(f->foot[i]))
            spread(f, sum, weight, f->min[0] + ((double)(i % (size_t)f->nx) + .5) * f->step[0],
                   f->min[1] + ((double)(i / (size_t)f->nx) + .5) * f->step[1], (double)f->foot[i] - f->height[i], FOOT_WEIGHT, radius);
    for (size_t i = 0; i < n; i++)
        f->height[i] += (float)(sum[i] / NOC_MAX(weight[i], 1));
}

static void keep_under_streets(ground_field *f) {
    for (size_t i = 0; i < (size_t)f->nx * (size_t)f->ny; i++)
        f->height[i] = NOC_MIN(f->height[i], f->street[i]);
}

void field_follow(ground_field *f, const double *points, size_t count) {
    double *sum = noc_alloc(2 * (size_t)f->nx * (size_t)f->ny * sizeof(*sum)), step = NOC_MAX(f->step[0], f->step[1]);
    for (double radius = NOC_MAX(WIDEST, 4 * step); radius >= 2 * step; radius /= 2)
        correct(f, points, count, radius, sum);
    free(sum);
    keep_under_streets(f);
    for (int sweep = 0; sweep < SWEEPS; sweep++)
        for (size_t i = 0; i < count; i++) {
            if (!isfinite(points[3 * i + 2]))
                continue;
            around at = find(f, points[3 * i], points[3 * i + 1]);
            double lack = points[3 * i + 2] - height_at(f, &at), length = 0;
            for (int k = 0; k < 3; k++)
                length += at.weight[k] * at.weight[k];
            for (int k = 0; k < 3; k++)
                f->height[at.corner[k]] += (float)(at.weight[k] * lack / length);
        }
    keep_under_streets(f);
}
