/* The regular table of a profile. */
#include "photometry/photometry.h"

#include <math.h>

/* Most steps of gamma (a quarter of a degree) and planes (half a degree), and values. */
enum { MOST_ROWS = 721, MOST_COLUMNS = 720, MOST_TABLE = 1 << 18 };

static long gcd(long a, long b) { return b ? gcd(b, a % b) : a; }

/* Steps that divide `range` and meet all the angles to 0.01 degrees; `most` where there are no such few. */
static int steps_of(const double *angle, size_t n, double range, int most) {
    long step = lround(range * 100);
    for (size_t i = 0; i < n; i++) {
        long at = lround(angle[i] * 100);
        if (fabs((double)at / 100 - angle[i]) > 1e-6)
            return most;
        step = gcd(step, at);
    }
    return step > 0 && lround(range * 100) / step <= most ? (int)(lround(range * 100) / step) : most;
}

/* Where nothing is sent beyond; exactly 90 where nothing is sent upward. */
static double last_gamma(const noc_profile *p) {
    size_t n = p->gamma.len, last = 0;
    bool above = false;
    for (size_t i = 0; i < p->cd.len; i++)
        if (p->cd.data[i] > 0) {
            last = NOC_MAX(last, i % n);
            above = above || p->gamma.data[i % n] > 90;
        }
    double end = p->gamma.data[NOC_MIN(last + 1, n - 1)];
    return above ? end : NOC_MIN(end, 90);
}

/* Of the table as core reads it, with its values as they are. */
static double table_flux(const photometry_table *t) {
    double flux = 0, step = t->gamma_max / (t->rows - 1);
    for (int r = 0; r + 1 < t->rows; r++)
        for (int c = 0; c < t->columns; c++) {
            const float *a = t->value.data + (size_t)r * (size_t)t->columns + c;
            flux += photometry_sine_integral(r * step, (r + 1) * step, a[0], a[t->columns], r * step, (r + 1) * step);
        }
    return flux * 2 * M_PI / t->columns;
}

noc_status photometry_table_make(photometry_table *t, const noc_profile *p, noc_log *log) {
    *t = (photometry_table){ .gamma_max = last_gamma(p) };
    size_t n = p->gamma.len;
    while (n > 2 && p->gamma.data[n - 1] > t->gamma_max)
        n--;
    t->rows = steps_of(p->gamma.data, n, t->gamma_max, MOST_ROWS - 1) + 1;
    t->columns = p->c.len == 1 ? 1 : steps_of(p->c.data, p->c.len, 360, MOST_COLUMNS);
    while ((long)t->rows * t->columns > MOST_TABLE && t->columns > 72)
        t->columns = t->columns % 2 ? 72 : t->columns / 2;
    size_t count = (size_t)t->rows * (size_t)t->columns;
    if (!array_reserve(&t->value, count))
        return noc_no_memory(log, "profile");
    t->value.len = count;
    for (int r = 0; r < t->rows; r++)
        for (int c = 0; c < t->columns; c++)
            t->value.data[r * t->columns + c] =
                (float)noc_profile_intensity(p, 360.0 * c / t->columns, t->gamma_max * r / (t->rows - 1));
    double flux = table_flux(t);
    if (!(flux > 0)) {
        photometry_table_free(t);
        return noc_error(log, NOC_ERR_FORMAT, "profile: it sends no light");
    }
    for (size_t i = 0; i < count; i++) {
        t->value.data[i] = (float)(t->value.data[i] / flux);
        t->peak = fmaxf(t->peak, t->value.data[i]);
    }
    t->upward = t->gamma_max > 90;
    return NOC_OK;
}

void photometry_table_free(photometry_table *t) { array_free(&t->value); }
