#include "photometry/photometry.h"

#include <math.h>

#define RADIANS (M_PI / 180)

double photometry_sine_integral(double t0, double t1, double a, double b, double from, double to) {
    double slope = (b - a) / ((t1 - t0) * RADIANS), x0 = from * RADIANS, x1 = to * RADIANS;
    double start = a + slope * (from - t0) * RADIANS, end = a + slope * (to - t0) * RADIANS;
    return start * cos(x0) - end * cos(x1) + slope * (sin(x1) - sin(x0));
}

/* Over C from c0 to c1 of what is linear between the planes: weights of each, in radians. */
static double plane_weight(const noc_profile *p, size_t plane, double c0, double c1) {
    size_t n = p->c.len;
    if (n == 1)
        return (c1 - c0) * RADIANS;
    double sum = 0;
    for (int side = 0; side < 2; side++) { /* from the plane before, and to the one behind */
        double mid = p->c.data[plane];
        double edge = side ? (plane + 1 < n ? p->c.data[plane + 1] : p->c.data[0] + 360)
                           : (plane > 0 ? p->c.data[plane - 1] : p->c.data[n - 1] - 360);
        double width = fabs(edge - mid);
        for (int turn = -360; turn <= 720; turn += 360) {
            double lo = fmax(fmin(edge, mid) + turn, c0), hi = fmin(fmax(edge, mid) + turn, c1);
            if (lo >= hi)
                continue;
            double at_lo = 1 - fabs(lo - turn - mid) / width, at_hi = 1 - fabs(hi - turn - mid) / width;
            sum += 0.5 * (at_lo + at_hi) * (hi - lo) * RADIANS;
        }
    }
    return sum;
}

double noc_profile_flux(const noc_profile *p, double gamma_min, double gamma_max, double c) {
    double flux = 0;
    if (!p || isinf(c))
        return 0;
    c -= 360 * floor(c / 360);
    size_t n = p->gamma.len;
    for (size_t i = 0; i < p->c.len; i++) {
        const double *cd = p->cd.data + i * n, *g = p->gamma.data;
        double weight = isnan(c) ? plane_weight(p, i, 0, 360) : plane_weight(p, i, c - 90, c + 90), sum = 0;
        for (size_t k = 0; k + 1 < n && weight > 0; k++) {
            double from = fmax(g[k], gamma_min), to = fmin(g[k + 1], gamma_max);
            if (from < to)
                sum += photometry_sine_integral(g[k], g[k + 1], cd[k], cd[k + 1], from, to);
        }
        flux += weight * sum;
    }
    return fmax(flux, 0);
}

/* Type A: the area of a cell is cos V dV dH; type B: cos H dH dV. Angles from the horizon are those from a pole. */
double photometry_grid_flux(const photometry_grid *g) {
    size_t nc = g->c.len, ng = g->gamma.len;
    const double *h = g->c.data, *v = g->gamma.data;
    bool by_v = g->type == 'A';
    double sum = 0;
    for (size_t i = 0; i + 1 < nc; i++)
        for (size_t k = 0; k + 1 < ng; k++) {
            double c00 = g->cd.data[i * ng + k], c01 = g->cd.data[i * ng + k + 1];
            double c10 = g->cd.data[(i + 1) * ng + k], c11 = g->cd.data[(i + 1) * ng + k + 1];
            if (by_v)
                sum += (h[i + 1] - h[i]) * RADIANS *
                       photometry_sine_integral(90 + v[k], 90 + v[k + 1], (c00 + c10) / 2, (c01 + c11) / 2, 90 + v[k],
                                                90 + v[k + 1]);
            else
                sum += (v[k + 1] - v[k]) * RADIANS *
                       photometry_sine_integral(90 + h[i], 90 + h[i + 1], (c00 + c01) / 2, (c10 + c11) / 2, 90 + h[i],
                                                90 + h[i + 1]);
        }
    return sum * (h[0] == 0 ? 2 : 1) * (v[0] == 0 ? 2 : 1);
}
