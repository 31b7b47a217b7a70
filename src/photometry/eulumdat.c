/* EULUMDAT (.ldt), Axel Stockmar's format of 1990: one value a line, in a fixed order. */
#include "photometry/photometry.h"

#include <math.h>

typedef struct ldt {
    long kind, symmetry, planes, gammas, sets;
    double lor, factor, lumens, watts;
    bool absolute;
} ldt;

/* Of the first lines: names, then numbers that are small and whole. */
static bool probe(const char *head, size_t size) {
    static const double most[] = { 3, 4, 721, 360, 361, 180 };
    photometry_text t = { head, head + size, "", NULL, 0 };
    const char *line;
    size_t n;
    double x;
    if (!photometry_line(&t, &line, &n) || memchr(line, 0, n))
        return false;
    for (size_t i = 0; i < NOC_COUNT(most); i++)
        if (!photometry_line(&t, &line, &n) || !photometry_line_number(line, n, &x) || x < 0 || x > most[i])
            return false;
    return true;
}

static noc_status next_line(photometry_text *t, const char *what, const char **line, size_t *n) {
    return photometry_line(t, line, n) ? NOC_OK : photometry_bad(t, t->line, "ends before %s", what);
}

static noc_status number_line(photometry_text *t, const char *what, double *out) {
    const char *line;
    size_t n;
    noc_status status = next_line(t, what, &line, &n);
    if (!status && !photometry_line_number(line, n, out))
        return photometry_bad(t, t->line, "%s is no number: \"%.*s\"", what, (int)NOC_MIN(n, 24), line);
    return status;
}

static noc_status whole_line(photometry_text *t, const char *what, long least, long most, long *out) {
    double x;
    noc_status status = number_line(t, what, &x);
    return status ? status : photometry_as_whole(t, what, x, least, most, out);
}

static noc_status text_line(photometry_text *t, noc_profile *p, const char *what, const char **to) {
    const char *line;
    size_t n;
    noc_status status = next_line(t, what, &line, &n);
    if (!status && to) {
        char *text = arena_strndup(&p->texts, line, n);
        *to = text ? text : "";
    }
    return status;
}

/* Numbers that nothing here needs are often left blank. */
static noc_status skip_lines(photometry_text *t, noc_profile *p, int count) {
    noc_status status = NOC_OK;
    for (int i = 0; i < count && !status; i++)
        status = text_line(t, p, "its last line", NULL);
    return status;
}

/* The colour appearance, often a colour temperature; else the lamps' type may name one. */
static noc_status read_colour(photometry_text *t, noc_profile *p, bool counts) {
    const char *line;
    size_t n;
    noc_status status = next_line(t, "the colour appearance", &line, &n);
    if (!status && counts) {
        p->info.kelvin = photometry_kelvin_field(line, n);
        if (p->info.kelvin == 0)
            p->info.kelvin = photometry_kelvin(p->info.lamp, strlen(p->info.lamp));
    }
    return status;
}

static noc_status read_sets(photometry_text *t, noc_profile *p, ldt *h) {
    noc_status status = whole_line(t, "the number of lamp sets", 1, 100, &h->sets);
    for (long i = 0; i < h->sets && !status; i++) {
        double lamps = 0, lumens = 0, watts = 0;
        status = number_line(t, "the number of lamps", &lamps);
        if (!status)
            status = text_line(t, p, "the type of lamps", i ? NULL : &p->info.lamp);
        if (!status)
            status = number_line(t, "the lumens of the lamps", &lumens);
        if (!status)
            status = read_colour(t, p, i == 0);
        if (!status)
            status = skip_lines(t, p, 1); /* colour rendering */
        if (!status && i == 0) {
            status = number_line(t, "the watts", &watts);
            h->absolute = lamps < 0;
            h->lumens = lumens;
            h->watts = watts;
        } else if (!status) {
            status = skip_lines(t, p, 1);
        }
    }
    return status;
}

static noc_status read_header(photometry_text *t, noc_profile *p, ldt *h) {
    noc_profile_info *info = &p->info;
    double mm[3] = { 0 };
    noc_status status = text_line(t, p, "the manufacturer", &info->manufacturer);
    if (!status)
        status = whole_line(t, "the type indicator (Ityp)", 0, 3, &h->kind);
    if (!status)
        status = whole_line(t, "the symmetry indicator (Isym)", 0, 4, &h->symmetry);
    if (!status)
        status = whole_line(t, "the number of C-planes (Mc)", 1, PHOTOMETRY_MOST_ANGLES, &h->planes);
    if (!status)
        status = skip_lines(t, p, 1); /* Dc: the angles are listed */
    if (!status)
        status = whole_line(t, "the number of angles (Ng)", 2, PHOTOMETRY_MOST_ANGLES, &h->gammas);
    if (!status)
        status = skip_lines(t, p, 2); /* Dg, the report's number */
    if (!status)
        status = text_line(t, p, "the luminaire's name", &info->name);
    if (!status)
        status = skip_lines(t, p, 6); /* number, file, date; length, width and height of the luminaire */
    static const char *const sizes[] = { "the length of the luminous area", "its width", "its height" };
    for (int i = 0; i < 3 && !status; i++) {
        const char *line;
        size_t n;
        status = next_line(t, sizes[i], &line, &n);
        if (!status && n && !photometry_line_number(line, n, &mm[i]))
            return photometry_bad(t, t->line, "%s is no number: \"%.*s\"", sizes[i], (int)NOC_MIN(n, 24), line);
    }
    info->size[0] = mm[1] / 1000;
    info->size[1] = mm[0] / 1000;
    info->size[2] = mm[2] / 1000;
    if (!status)
        status = skip_lines(t, p, 4); /* heights at the other sides, and the downward flux fraction */
    if (!status)
        status = number_line(t, "the light output ratio", &h->lor);
    if (!status)
        status = number_line(t, "the conversion factor", &h->factor);
    if (!status)
        status = skip_lines(t, p, 1); /* tilt while it was measured: the angles are the luminaire's own */
    if (!status)
        status = read_sets(t, p, h);
    return status ? status : skip_lines(t, p, 10); /* direct ratios */
}

/* How many planes the file holds. */
static long stored_planes(const ldt *h) {
    switch (h->symmetry) {
    case 1: return 1;
    case 2:
    case 3: return h->planes / 2 + 1;
    case 4: return h->planes / 4 + 1;
    default: return h->planes;
    }
}

/* Which of them plane i is. Of symmetry 3 they begin at C 270. */
static long stored_plane(const ldt *h, long i) {
    long n = h->planes;
    if (h->symmetry == 1)
        return 0;
    if (h->symmetry == 2 || h->symmetry == 4)
        i = i > n / 2 ? n - i : i;
    if (h->symmetry == 4 && i > n / 4)
        i = n / 2 - i;
    if (h->symmetry == 3) {
        if (i > n / 4 && i < n - n / 4)
            i = n / 2 - i;
        i = (i + n - (n - n / 4)) % n;
    }
    return i;
}

static noc_status read_grid(photometry_text *t, const ldt *h, photometry_grid *whole, int *line) {
    noc_status status = photometry_reserve(t, whole, h->planes, h->gammas);
    NOC_ARRAY(double) stored = { 0 };
    for (long i = 0; i < h->planes && !status; i++) {
        status = number_line(t, "a C angle", &whole->c.data[i]);
        whole->c.len += !status;
    }
    *line = t->line;
    for (long i = 0; i < h->gammas && !status; i++) {
        status = number_line(t, "a gamma angle", &whole->gamma.data[i]);
        whole->gamma.len += !status;
    }
    double factor = (h->absolute ? 1 : h->lumens / 1000) * h->factor; /* absolute: for now (choose_reading) */
    for (long i = 0; i < stored_planes(h) * h->gammas && !status; i++) {
        double x;
        status = number_line(t, "an intensity", &x);
        if (!status && x < 0)
            status = photometry_bad(t, t->line, "an intensity is negative: %g", x);
        else if (!status && !array_push(&stored, x * factor))
            status = noc_no_memory(t->log, t->name);
    }
    if (h->symmetry == 1 && !status)
        whole->c.len = 1;
    for (size_t i = 0; i < whole->c.len && !status; i++)
        if (!array_append(&whole->cd, stored.data + stored_plane(h, (long)i) * h->gammas, (size_t)h->gammas))
            status = noc_no_memory(t->log, t->name);
    array_free(&stored);
    return status;
}

/* A negative number of lamps says that the photometry is absolute. Some tools write candela then, others cd/klm as
 * ever: the reading counts whose integral is nearer to the flux that the file states. */
static const char *choose_reading(noc_profile *p, const ldt *h) {
    double stated = h->lumens * (h->lor > 0 ? h->lor / 100 : 1), per_klm = h->lumens / 1000, made = p->info.lumens;
    if (!(stated > PHOTOMETRY_LEAST) || fabs(log(made * per_klm / stated)) >= fabs(log(made / stated)))
        return "EULUMDAT, absolute";
    photometry_scale(p, per_klm);
    return "EULUMDAT, absolute in cd/klm";
}

static noc_status read_body(photometry_text *t, noc_profile *p) {
    static const char *const symmetries[] = { "none", "about the axis", "C 0-180", "C 90-270", "C 0-90" };
    ldt h = { 0 };
    int line = 0;
    noc_status status = read_header(t, p, &h);
    if (status)
        return status;
    if (h.symmetry > 1 && h.planes % (h.symmetry == 2 ? 2 : 4) != 0)
        return photometry_bad(t, 4, "%ld C-planes cannot have symmetry %ld", h.planes, h.symmetry);
    if (!(h.factor > 0))
        return photometry_bad(t, t->line, "a conversion factor of %g", h.factor);
    if (!h.absolute && !(h.lumens > 0))
        return photometry_bad(t, t->line, "lamps of %g lm, but intensities are in cd/klm", h.lumens);
    photometry_grid g = { .type = 'C' };
    status = read_grid(t, &h, &g, &line);
    if (!status)
        status = photometry_fill(p, &g, t->log, t->name, line);
    if (!status) {
        noc_profile_info *info = &p->info;
        info->format = h.absolute ? choose_reading(p, &h) : "EULUMDAT";
        info->symmetry = symmetries[h.symmetry];
        info->planes = (int)stored_planes(&h);
        photometry_face_street(p, 90);
        info->lamp_lumens = h.lumens > 0 ? h.lumens : NAN;
        info->lor = h.lor / 100;
        info->watts = fmax(h.watts, 0);
        info->lamp_sets = (int)h.sets;
        photometry_judge(p, t->log, t->name);
    }
    photometry_grid_free(&g);
    return status;
}

const photometry_format photometry_eulumdat = { probe, read_body };
