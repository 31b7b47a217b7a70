/* The regular table of a profile. */
#include "photometry/photometry.h"

#include <math.h>

/* Most steps of gamma (a quarter of a degree) and planes (half a degree), and cells; of types A and B, whose tables
 * cover no more than was measured, most cells. */
enum { MOST_ROWS = 720, MOST_COLUMNS = 720, MOST_TABLE = 1 << 18, MOST_WINDOW = 1 << 19, CELL = 4 };

static long gcd(long a, long b) { return b ? gcd(b, a % b) : a; }

/* Steps that divide from..to and meet all the angles to 0.01 degrees; `most` where there are no such few. */
static int steps_of(const double *angle, size_t n, double from, double to, int most) {
    long range = lround((to - from) * 100), step = range;
    for (size_t i = 0; i < n; i++) {
        long at = lround((angle[i] - from) * 100);
        if (fabs((double)at / 100 - (angle[i] - from)) > 1e-6)
            return most;
        step = gcd(step, at);
    }
    return step > 0 && range / step <= most ? (int)(range / step) : most;
}

/* Where nothing is sent beyond. */
static double last_gamma(const noc_profile *p) {
    size_t n = p->gamma.len, last = 0;
    for (size_t i = 0; i < p->cd.len; i++)
        if (p->cd.data[i] > 0)
            last = NOC_MAX(last, i % n);
    return p->gamma.data[NOC_MIN(last + 1, n - 1)];
}

static void fit_steps(photometry_table *t, const noc_profile *p) {
    size_t n = p->gamma.len;
    t->type = 'C';
    t->row_to = t->gamma_max = last_gamma(p);
    t->column_to = 360;
    while (n > 2 && p->gamma.data[n - 1] > t->gamma_max)
        n--;
    t->rows = steps_of(p->gamma.data, n, 0, t->gamma_max, MOST_ROWS);
    t->columns = p->c.len == 1 ? 1 : steps_of(p->c.data, p->c.len, 0, 360, MOST_COLUMNS);
}

static void fit_window(photometry_table *t, const photometry_grid *g) {
    bool a = g->type == 'A';
    const double *row = a ? g->gamma.data : g->c.data, *column = a ? g->c.data : g->gamma.data;
    size_t rows = a ? g->gamma.len : g->c.len, columns = a ? g->c.len : g->gamma.len;
    t->type = g->type;
    photometry_span(row, rows, &t->row_from, &t->row_to);
    photometry_span(column, columns, &t->column_from, &t->column_to);
    t->rows = steps_of(row, rows, t->row_from, t->row_to, MOST_ROWS);
    t->columns = steps_of(column, columns, t->column_from, t->column_to, MOST_COLUMNS);
}

static double row_at(const photometry_table *t, int r) {
    return fmin(t->row_from + (t->row_to - t->row_from) * r / t->rows, t->row_to);
}

static double column_at(const photometry_table *t, int c) {
    return fmin(t->column_from + (t->column_to - t->column_from) * c / t->columns, t->column_to);
}

/* cd at a row and a column of steps. */
static double corner(const photometry_table *t, const noc_profile *p, int r, int c) {
    double row = row_at(t, r), column = column_at(t, c);
    switch (t->type) {
    case 'A': return photometry_grid_at(&p->own, column, row);
    case 'B': return photometry_grid_at(&p->own, row, column);
    default: return noc_profile_intensity(p, column, fmax(row, p->gamma.data[0]));
    }
}

/* What a file does not hold is no light, up to its first angle. */
static bool is_measured(const photometry_table *t, const noc_profile *p, int r) {
    return t->type != 'C' || (row_at(t, r) + row_at(t, r + 1)) / 2 > p->gamma.data[0];
}

/* Corners that the cells before a cell, or those of the row before, have are theirs. */
static void fill_cells(photometry_table *t, const noc_profile *p) {
    float *cell = t->cells.data;
    bool above = false;
    for (int r = 0; r < t->rows; r++) {
        bool measured = is_measured(t, p, r);
        for (int c = 0; c < t->columns; c++, cell += CELL) {
            const float *up = above ? cell - CELL * t->columns : NULL;
            if (!measured) {
                memset(cell, 0, CELL * sizeof(*cell));
                continue;
            }
            cell[0] = up ? up[2] : c ? cell[1 - CELL] : (float)corner(t, p, r, c);
            cell[1] = up ? up[3] : (float)corner(t, p, r, c + 1);
            cell[2] = c ? cell[3 - CELL] : (float)corner(t, p, r + 1, c);
            cell[3] = (float)corner(t, p, r + 1, c + 1);
        }
        above = measured;
    }
}

/* Of the table as core reads it, with its values as they are. */
static double table_flux(const photometry_table *t) {
    double flux = 0, pole = t->type == 'C' ? 0 : 90;
    const float *cell = t->cells.data;
    for (int r = 0; r < t->rows; r++)
        for (int c = 0; c < t->columns; c++, cell += CELL) {
            double from = pole + row_at(t, r), to = pole + row_at(t, r + 1);
            flux += photometry_sine_integral(from, to, ((double)cell[0] + (double)cell[1]) / 2,
                                             ((double)cell[2] + (double)cell[3]) / 2, from, to);
        }
    return flux * (t->column_to - t->column_from) / t->columns * M_PI / 180;
}

/* Degrees from the axis of the farthest corner of types A and B, 180 for one behind the luminaire. */
static double reach_of(const photometry_table *t, int r, int c) {
    double most = 0;
    for (int k = 0; k < CELL; k++) {
        double row = row_at(t, r + k / 2) * M_PI / 180, column = column_at(t, c + k % 2) * M_PI / 180;
        if (fabs(column) > M_PI / 2 + 1e-9)
            return 180;
        most = fmax(most, acos(cos(row) * cos(column)) * 180 / M_PI);
    }
    return most;
}

/* gamma_max of types A and B, a little more for the rounding of angles. */
static void find_reach(photometry_table *t) {
    const float *cell = t->cells.data;
    for (int r = 0; r < t->rows; r++)
        for (int c = 0; c < t->columns; c++, cell += CELL)
            if (cell[0] > 0 || cell[1] > 0 || cell[2] > 0 || cell[3] > 0)
                t->gamma_max = fmax(t->gamma_max, reach_of(t, r, c));
    t->upward = t->gamma_max > 90 + 1e-6;
    t->gamma_max = fmin(t->gamma_max + .001, t->upward ? 180 : 90);
}

noc_status photometry_table_make(photometry_table *t, const noc_profile *p, noc_log *log) {
    *t = (photometry_table){ 0 };
    bool own = p->own.cd.len > 0;
    if (own)
        fit_window(t, &p->own);
    else
        fit_steps(t, p);
    while ((long)t->rows * t->columns > (own ? MOST_WINDOW : MOST_TABLE) && t->columns > 72)
        t->columns = t->columns % 2 ? 72 : t->columns / 2;
    size_t count = (size_t)t->rows * (size_t)t->columns * CELL;
    if (!array_reserve(&t->cells, count))
        return noc_no_memory(log, "profile");
    t->cells.len = count;
    fill_cells(t, p);
    double flux = table_flux(t);
    if (!(flux > 0)) {
        photometry_table_free(t);
        return noc_error(log, NOC_ERR_FORMAT, "profile: it sends no light");
    }
    t->upward = t->gamma_max > 90;
    if (own)
        find_reach(t);
    for (size_t i = 0; i < count; i++) {
        t->cells.data[i] = (float)(t->cells.data[i] / flux);
        t->peak = fmaxf(t->peak, t->cells.data[i]);
    }
    return NOC_OK;
}

void photometry_table_free(photometry_table *t) { array_free(&t->cells); }
