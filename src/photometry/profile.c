/* A profile: what readers found, made whole around the axis, and what is to be told of it. */
#include "photometry/photometry.h"

#include <math.h>

void photometry_grid_free(photometry_grid *g) {
    array_free(&g->c);
    array_free(&g->gamma);
    array_free(&g->cd);
}

noc_profile *photometry_new(noc_log *log, const char *name, const char *format) {
    noc_profile *p = noc_calloc(1, sizeof(*p));
    if (!p) {
        (void)noc_no_memory(log, name);
        return NULL;
    }
    p->info = (noc_profile_info){ .format = format,
                                  .name = "",
                                  .manufacturer = "",
                                  .lamp = "",
                                  .symmetry = "none",
                                  .lamp_lumens = NAN,
                                  .lor = NAN,
                                  .flux_error = NAN };
    return p;
}

void noc_profile_destroy(noc_profile *p) {
    if (!p)
        return;
    array_free(&p->c);
    array_free(&p->gamma);
    array_free(&p->cd);
    photometry_grid_free(&p->own);
    arena_free(&p->texts);
    free(p);
}

/* ---- reading between the angles ---- */

/* The interval of ascending angles that x lies in, and the share of its end; false beyond them. */
static bool locate(const double *angle, size_t n, double x, size_t *i, double *share) {
    if (!(x >= angle[0] && x <= angle[n - 1]))
        return false;
    size_t lo = 0, hi = n - 1;
    while (hi - lo > 1) {
        size_t mid = (lo + hi) / 2;
        if (angle[mid] <= x)
            lo = mid;
        else
            hi = mid;
    }
    *i = lo;
    *share = n > 1 ? (x - angle[lo]) / (angle[lo + 1] - angle[lo]) : 0;
    return true;
}

/* ---- types A and B ---- */

void photometry_span(const double *angle, size_t n, double *from, double *to) {
    *to = angle[n - 1];
    *from = angle[0] == 0 ? -*to : angle[0];
}

/* Angles that are beyond the first or last by their rounding alone are these. */
static double to_span(const double *angle, size_t n, double x) {
    double in = NOC_CLAMP(x, angle[0], angle[n - 1]);
    return fabs(in - x) < 1e-9 ? in : x;
}

double photometry_grid_at(const photometry_grid *g, double h, double v) {
    size_t i, k;
    double s, t;
    if (g->c.data[0] == 0)
        h = fabs(h);
    if (g->gamma.data[0] == 0)
        v = fabs(v);
    h = to_span(g->c.data, g->c.len, h);
    v = to_span(g->gamma.data, g->gamma.len, v);
    if (!locate(g->c.data, g->c.len, h, &i, &s) || !locate(g->gamma.data, g->gamma.len, v, &k, &t))
        return 0;
    size_t n = g->gamma.len;
    const double *a = g->cd.data + i * n + k, *b = g->cd.data + NOC_MIN(i + 1, g->c.len - 1) * n + k;
    double cd = (1 - s) * ((1 - t) * a[0] + t * a[1]) + s * ((1 - t) * b[0] + t * b[1]);
    return fmin(cd, fmax(fmax(a[0], a[1]), fmax(b[0], b[1]))); /* rounding makes no peak of its own */
}

/* Looks along the axis: right is C 0, up is C 90. In type A the horizontal angle turns around the upright pole, in B
 * the vertical angle turns around the pole that lies to the right. */
static double own_intensity(const photometry_grid *g, double c_deg, double gamma_deg) {
    double c = c_deg * M_PI / 180, t = gamma_deg * M_PI / 180;
    double right = sin(t) * cos(c), up = sin(t) * sin(c), ahead = cos(t), h, v;
    if (g->type == 'A') {
        h = atan2(right, ahead);
        v = asin(NOC_CLAMP(up, -1, 1));
    } else {
        h = asin(NOC_CLAMP(right, -1, 1));
        v = atan2(up, ahead);
    }
    return photometry_grid_at(g, h * 180 / M_PI, v * 180 / M_PI);
}

double noc_profile_intensity(const noc_profile *p, double c, double gamma) {
    size_t k, n;
    double t;
    if (p && p->own.cd.len)
        return own_intensity(&p->own, c, gamma);
    if (!p || !locate(p->gamma.data, p->gamma.len, gamma, &k, &t))
        return 0;
    n = p->c.len;
    c -= 360 * floor(c / 360);
    size_t i = n - 1; /* between the last plane and the first */
    while (i > 0 && c < p->c.data[i])
        i--;
    if (c < p->c.data[0])
        i = n - 1;
    size_t next = (i + 1) % n;
    double from = p->c.data[i], width = p->c.data[next] - from;
    width += width <= 0 ? 360 : 0;
    double off = c - from, share = n > 1 ? (off < 0 ? off + 360 : off) / width : 0;
    const double *a = p->cd.data + i * p->gamma.len + k, *b = p->cd.data + next * p->gamma.len + k;
    return (1 - share) * ((1 - t) * a[0] + t * a[1]) + share * ((1 - t) * b[0] + t * b[1]);
}

static double least_step(const double *angle, size_t n) {
    double least = 5;
    for (size_t i = 0; i + 1 < n; i++)
        least = fmin(least, angle[i + 1] - angle[i]);
    return least;
}

/* The same, nearly, in planes of C: what is told of the profile. */
static bool turn_grid(noc_profile *p, const photometry_grid *g) {
    double step = fmin(least_step(g->c.data, g->c.len), least_step(g->gamma.data, g->gamma.len));
    size_t rows = (size_t)ceil(180 / NOC_CLAMP(step, .25, 5)) + 1, planes = rows > 200 ? 144 : 72;
    if (!array_reserve(&p->c, planes) || !array_reserve(&p->gamma, rows) || !array_reserve(&p->cd, planes * rows))
        return false;
    for (size_t i = 0; i < planes; i++)
        p->c.data[i] = 360.0 * (double)i / (double)planes;
    for (size_t k = 0; k < rows; k++)
        p->gamma.data[k] = 180.0 * (double)k / (double)(rows - 1);
    for (size_t i = 0; i < planes; i++)
        for (size_t k = 0; k < rows; k++)
            p->cd.data[i * rows + k] = own_intensity(g, p->c.data[i], p->gamma.data[k]);
    p->c.len = planes;
    p->gamma.len = rows;
    p->cd.len = planes * rows;
    return true;
}

/* ---- type C ---- */

typedef enum shape { AXIAL, QUARTER, HALF, HALF_ACROSS, WHOLE, UNKNOWN } shape;

static shape shape_of(const double *c, size_t n) {
    double first = c[0], last = c[n - 1];
    if (n == 1)
        return AXIAL;
    if (first == 90 && last == 270)
        return HALF_ACROSS;
    if (first != 0)
        return UNKNOWN;
    return last == 90 ? QUARTER : last == 180 ? HALF : last > 180 ? WHOLE : UNKNOWN;
}

/* Plane `from` of the file at angle c of the whole, which come in ascending order. */
static void put_plane(noc_profile *p, const photometry_grid *g, double c, size_t from) {
    size_t n = g->gamma.len;
    if (c >= 360 || (p->c.len && c <= p->c.data[p->c.len - 1]))
        return; /* the mirror's own plane */
    memcpy(p->cd.data + p->c.len * n, g->cd.data + from * n, n * sizeof(double));
    p->c.data[p->c.len++] = c;
    p->cd.len += n;
}

static bool unfold(noc_profile *p, const photometry_grid *g, shape s) {
    size_t n = g->c.len, most = n * 4;
    if (!array_reserve(&p->c, most) || !array_append(&p->gamma, g->gamma.data, g->gamma.len) ||
        !array_reserve(&p->cd, most * g->gamma.len))
        return false;
    const double *c = g->c.data;
    if (s == AXIAL) {
        put_plane(p, g, 0, 0);
        return true;
    }
    if (s == HALF_ACROSS) { /* C and 180 - C are the same */
        for (size_t i = n; i-- > 0;)
            put_plane(p, g, c[i] <= 180 ? 180 - c[i] : 540, i);
        for (size_t i = 0; i < n; i++)
            put_plane(p, g, c[i], i);
        for (size_t i = n; i-- > 0;)
            put_plane(p, g, c[i] > 180 ? 540 - c[i] : 540, i);
        return true;
    }
    for (size_t i = 0; i < n; i++)
        put_plane(p, g, c[i], i);
    for (size_t i = n; i-- > 0 && s == QUARTER;)
        put_plane(p, g, 180 - c[i], i);
    for (size_t i = 0; i < n && s == QUARTER; i++)
        put_plane(p, g, 180 + c[i], i);
    for (size_t i = n; i-- > 0 && s != WHOLE;)
        put_plane(p, g, 360 - c[i], i);
    return true;
}

static const char *const shape_names[] = { "about the axis", "C 0-90", "C 0-180", "C 90-270", "none" };

/* ---- filling ---- */

#define CLOSEST 1e-6 /* degrees between two angles: what lies between them is divided by it */

/* What is wrong with angles, NULL if nothing. */
static const char *angle_fault(const photometry_grid *g) {
    double most_c = g->type == 'C' ? 360 : g->type == 'A' ? 180 : 90, least_c = g->type == 'C' ? 0 : -most_c;
    double most_g = g->type == 'B' || g->type == 'C' ? 180 : 90, least_g = g->type == 'C' ? 0 : -most_g;
    for (size_t i = 0; i < g->c.len; i++) {
        if (!(g->c.data[i] >= least_c && g->c.data[i] <= most_c))
            return "a horizontal angle is out of its range";
        if (i > 0 && !(g->c.data[i] > g->c.data[i - 1]))
            return "horizontal angles do not ascend";
        if (i > 0 && g->c.data[i] - g->c.data[i - 1] < CLOSEST)
            return "two horizontal angles are nearly the same";
    }
    for (size_t i = 0; i < g->gamma.len; i++) {
        if (!(g->gamma.data[i] >= least_g && g->gamma.data[i] <= most_g))
            return "a vertical angle is out of its range";
        if (i > 0 && !(g->gamma.data[i] > g->gamma.data[i - 1]))
            return "vertical angles do not ascend";
        if (i > 0 && g->gamma.data[i] - g->gamma.data[i - 1] < CLOSEST)
            return "two vertical angles are nearly the same";
    }
    if (g->type != 'C')
        return g->c.len < 2 ? "types A and B need two horizontal angles at least" : NULL;
    return shape_of(g->c.data, g->c.len) == UNKNOWN
               ? "horizontal angles do not go from 0 to 0, 90, 180 or more than 180,"
                 " or from 90 to 270"
               : NULL;
}

/* Of light below the horizon: how much more goes along C 0 and 180 than along C 90 and 270, as a share. */
static double elongation(const noc_profile *p) {
    double sum = 0, along = 0;
    for (double c = 0; c < 360; c += 5)
        for (double gamma = 2.5; gamma < 90; gamma += 5) {
            double part = noc_profile_intensity(p, c, gamma) * sin(gamma * M_PI / 180);
            sum += part;
            along += part * cos(2 * c * M_PI / 180);
        }
    return sum > 0 ? along / sum : 0;
}

#define CLEARLY .01 /* share of the light below the horizon */

void photometry_face_street(noc_profile *p, double usual) {
    double ahead = noc_profile_flux(p, 0, 90, 0) - noc_profile_flux(p, 0, 90, 180);
    double aside = noc_profile_flux(p, 0, 90, 90) - noc_profile_flux(p, 0, 90, 270);
    double clearly = CLEARLY * noc_profile_flux(p, 0, 90, NAN);
    if (fmax(fabs(ahead), fabs(aside)) > clearly) {
        p->info.street = fabs(ahead) > fabs(aside) ? (ahead > 0 ? 0 : 180) : aside > 0 ? 90 : 270;
        return;
    }
    double longer = elongation(p);
    p->info.street = fabs(longer) > CLEARLY ? (longer > 0 ? 90 : 0) : usual;
}

/* Of the file's own angles. */
static void find_own_peak(noc_profile_info *info, const photometry_grid *g) {
    size_t n = g->gamma.len, most = 0;
    for (size_t i = 0; i < g->cd.len; i++)
        most = g->cd.data[i] > g->cd.data[most] ? i : most;
    double h = g->c.data[most / n] * M_PI / 180, v = g->gamma.data[most % n] * M_PI / 180;
    double right = g->type == 'A' ? cos(v) * sin(h) : sin(h), up = g->type == 'A' ? sin(v) : cos(h) * sin(v);
    double c = atan2(up, right) * 180 / M_PI;
    info->peak = g->cd.data[most];
    info->peak_c = c < 0 ? c + 360 : c;
    info->peak_gamma = atan2(hypot(right, up), cos(h) * cos(v)) * 180 / M_PI;
}

static void find_peak(noc_profile *p) {
    size_t n = p->gamma.len;
    if (p->own.cd.len) {
        find_own_peak(&p->info, &p->own);
        return;
    }
    for (size_t i = 0; i < p->cd.len; i++)
        if (p->cd.data[i] > p->info.peak) {
            p->info.peak = p->cd.data[i];
            p->info.peak_c = p->c.data[i / n];
            p->info.peak_gamma = p->gamma.data[i % n];
        }
}

noc_status photometry_fill(noc_profile *p, photometry_grid *g, noc_log *log, const char *name, int line) {
    char place[32] = "";
    if (line)
        noc_snprintf(place, sizeof(place), ":%d", line);
    const char *fault = angle_fault(g);
    if (fault)
        return noc_error(log, NOC_ERR_FORMAT, "%s%s: %s", name, place, fault);
    shape s = g->type == 'C' ? shape_of(g->c.data, g->c.len) : WHOLE;
    if (g->type == 'C' ? !unfold(p, g, s) : !turn_grid(p, g))
        return noc_no_memory(log, name);
    noc_profile_info *info = &p->info;
    info->symmetry = shape_names[p->c.len == 1 ? AXIAL : s];
    if (g->type != 'C')
        info->symmetry = g->c.data[0] == 0 ? "left and right" : "none";
    info->planes = (int)g->c.len;
    info->gammas = (int)g->gamma.len;
    info->c_min = g->c.data[0];
    info->c_max = g->c.data[g->c.len - 1];
    info->gamma_min = g->gamma.data[0];
    info->gamma_max = g->gamma.data[g->gamma.len - 1];
    p->info.street = 90; /* up, as a floodlight was measured */
    if (g->type == 'C')
        photometry_face_street(p, s == HALF_ACROSS ? 90 : 0);
    if (g->type != 'C') {
        p->own = *g;
        *g = (photometry_grid){ .type = g->type };
    }
    find_peak(p);
    info->lumens = p->own.cd.len ? photometry_grid_flux(&p->own) : noc_profile_flux(p, 0, 180, NAN);
    if (!(info->peak > PHOTOMETRY_LEAST) || !(info->lumens > PHOTOMETRY_LEAST))
        return noc_error(log, NOC_ERR_FORMAT, "%s%s: sends no light", name, place);
    return NOC_OK;
}

void photometry_scale(noc_profile *p, double factor) {
    for (size_t i = 0; i < p->cd.len; i++)
        p->cd.data[i] *= factor;
    p->info.lumens *= factor;
    p->info.peak *= factor;
}

void photometry_judge(noc_profile *p, noc_log *log, const char *name) {
    noc_profile_info *info = &p->info;
    double stated = info->lamp_lumens * (isnan(info->lor) ? 1 : info->lor);
    if (isnan(stated))
        return;
    if (!(stated > 0)) {
        noc_warn(log, "%s: states no light output to compare its intensities with", name);
        return;
    }
    info->flux_error = info->lumens / stated - 1;
    if (isnan(info->lor))
        info->flux_error = fmax(info->flux_error, 0);
    if (fabs(info->flux_error) <= NOC_PROFILE_TOLERANCE)
        return;
    if (isnan(info->lor))
        noc_warn(log, "%s: its intensities make %.0f lm, %.0f %% more than the %.0f lm of its lamps", name,
                 info->lumens, 100 * info->flux_error, stated);
    else
        noc_warn(log, "%s: its intensities make %.0f lm, its lamps and light output ratio %.0f lm: %+.0f %%", name,
                 info->lumens, stated, 100 * info->flux_error);
}

noc_status noc_profile_create(noc_log *log, const noc_profile_params *params, noc_profile **profile) {
    const char *const what = "profile";
    if (!params || !profile || !params->c || !params->gamma || !params->cd)
        return noc_null(log, __func__);
    *profile = NULL;
    if (params->planes < 1 || params->gammas < 2 || params->planes > PHOTOMETRY_MOST_ANGLES ||
        params->gammas > PHOTOMETRY_MOST_ANGLES || params->planes * params->gammas > PHOTOMETRY_MOST_VALUES)
        return noc_error(log, NOC_ERR_ARGUMENT, "%s: %d planes of %d angles are too few or too many", what,
                         params->planes, params->gammas);
    size_t count = (size_t)params->planes * (size_t)params->gammas;
    for (size_t i = 0; i < count; i++)
        if (!(params->cd[i] >= 0 && params->cd[i] < 1e12))
            return noc_error(log, NOC_ERR_ARGUMENT, "%s: an intensity is negative or not finite", what);
    if (!isfinite(params->street))
        return noc_error(log, NOC_ERR_ARGUMENT, "%s: street is not finite", what);
    photometry_grid g = { .type = 'C' };
    noc_profile *p = photometry_new(log, what, "numbers");
    noc_status status = p ? NOC_OK : NOC_ERR_MEMORY;
    if (p && params->name && !(p->info.name = arena_strdup(&p->texts, params->name)))
        status = noc_no_memory(log, what);
    if (!status &&
        (!array_append(&g.c, params->c, (size_t)params->planes) ||
         !array_append(&g.gamma, params->gamma, (size_t)params->gammas) || !array_append(&g.cd, params->cd, count)))
        status = noc_no_memory(log, what);
    if (!status)
        status = photometry_fill(p, &g, log, what, 0);
    if (!status)
        p->info.street = params->street - 360 * floor(params->street / 360);
    photometry_grid_free(&g);
    if (status) {
        noc_profile_destroy(p);
        return status == NOC_ERR_FORMAT ? NOC_ERR_ARGUMENT : status;
    }
    *profile = p;
    return NOC_OK;
}

/* ---- what is told ---- */

/* The first rating whose limits hold all values; 5: none. */
static int rating(const double *values, const double limits[][5], int count) {
    for (int r = 0; r < 5; r++) {
        bool holds = true;
        for (int i = 0; i < count; i++)
            holds = holds && values[i] <= limits[i][r];
        if (holds)
            return r;
    }
    return 5;
}

/* IES TM-15-11, addendum A: most lumens of each zone at ratings 0 to 4, of luminaires of types I to IV. */
static void rate(noc_profile_info *info) {
    static const double back[][5] = { { 110, 500, 1000, 2500, 5000 },
                                      { 220, 1000, 2500, 5000, 8500 },
                                      { 110, 500, 1000, 2500, 5000 } };
    static const double up[][5] = { { 0, 10, 50, 500, 1000 }, { 0, 10, 50, 500, 1000 } };
    static const double glare[][5] = { { 10, 100, 225, 500, 750 },
                                       { 10, 100, 225, 500, 750 },
                                       { 660, 1800, 5000, 7500, 12000 },
                                       { 110, 500, 1000, 2500, 5000 } };
    double b[] = { info->back.high, info->back.medium, info->back.low };
    double u[] = { floor(info->up_high), floor(info->up_low) }; /* a fraction of a lumen is rounding */
    double g[] = { info->forward.very_high, info->back.very_high, info->forward.high, info->back.high };
    info->bug[0] = rating(b, back, 3);
    info->bug[1] = rating(u, up, 2);
    info->bug[2] = rating(g, glare, 4);
}

static noc_profile_zones zones_of(const noc_profile *p, double c) {
    return (noc_profile_zones){ noc_profile_flux(p, 0, 30, c), noc_profile_flux(p, 30, 60, c),
                                noc_profile_flux(p, 60, 80, c), noc_profile_flux(p, 80, 90, c) };
}

void noc_profile_get_info(const noc_profile *p, noc_profile_info *info) {
    if (!info)
        return;
    if (!p) {
        *info = (noc_profile_info){ .format = "", .name = "", .manufacturer = "", .lamp = "", .symmetry = "" };
        return;
    }
    *info = p->info;
    info->forward = zones_of(p, info->street);
    info->back = zones_of(p, info->street + 180);
    info->up_low = noc_profile_flux(p, 90, 100, NAN);
    info->up_high = noc_profile_flux(p, 100, 180, NAN);
    info->upward = (info->up_low + info->up_high) / noc_profile_flux(p, 0, 180, NAN);
    rate(info);
    info->c = p->c.data;
    info->gamma = p->gamma.data;
    info->cd = p->cd.data;
    info->c_count = (int)p->c.len;
    info->gamma_count = (int)p->gamma.len;
}
