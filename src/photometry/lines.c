#include "photometry/photometry.h"

#include <limits.h>
#include <math.h>
#include <stdarg.h>

static bool blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

noc_status photometry_bad(const photometry_text *t, int line, const char *fmt, ...) {
    char text[256];
    va_list ap;
    va_start(ap, fmt);
    noc_vsnprintf(text, sizeof(text), fmt, ap);
    va_end(ap);
    return noc_error(t->log, NOC_ERR_FORMAT, "%s:%d: %s", t->name, line, text);
}

bool photometry_line(photometry_text *t, const char **line, size_t *length) {
    if (t->at >= t->end)
        return false;
    const char *s = t->at, *e = s;
    while (e < t->end && *e != '\n' && *e != '\r')
        e++;
    t->at = e;
    if (t->at < t->end)
        t->at += *e == '\r' && e + 1 < t->end && e[1] == '\n' ? 2 : 1;
    t->line++;
    while (s < e && blank(*s))
        s++;
    while (e > s && blank(e[-1]))
        e--;
    *line = s;
    *length = (size_t)(e - s);
    return true;
}

/* To the next thing that is no blank; counts lines. */
static void skip_blanks(photometry_text *t) {
    for (; t->at < t->end && (blank(*t->at) || *t->at == '\n' || *t->at == ','); t->at++) {
        bool end = *t->at == '\n' || (*t->at == '\r' && !(t->at + 1 < t->end && t->at[1] == '\n'));
        t->line += end;
    }
}

bool photometry_more(photometry_text *t) {
    skip_blanks(t);
    return t->at < t->end && *t->at && *t->at != 0x1a; /* DOS ended texts by it */
}

noc_status photometry_number(photometry_text *t, const char *what, double *out) {
    char text[64];
    if (!photometry_more(t))
        return photometry_bad(t, t->line, "ends before %s", what);
    const char *s = t->at;
    while (t->at < t->end && !blank(*t->at) && *t->at != '\n' && *t->at != ',')
        t->at++;
    size_t n = (size_t)(t->at - s);
    if (n < sizeof(text)) {
        memcpy(text, s, n);
        text[n] = 0;
        if (noc_parse_double(text, out) && fabs(*out) < 1e12)
            return NOC_OK;
    }
    return photometry_bad(t, t->line, "%s is no number: \"%.*s\"", what, (int)NOC_MIN(n, 24), s);
}

noc_status photometry_whole(photometry_text *t, const char *what, long least, long most, long *out) {
    double x;
    noc_status status = photometry_number(t, what, &x);
    return status ? status : photometry_as_whole(t, what, x, least, most, out);
}

noc_status photometry_as_whole(const photometry_text *t, const char *what, double x, long least, long most, long *out) {
    if (x < (double)least || x > (double)most || x != floor(x))
        return photometry_bad(t, t->line, "%s must be a whole number in %ld..%ld, not %g", what, least, most, x);
    *out = (long)x;
    return NOC_OK;
}

bool photometry_line_number(const char *line, size_t length, double *out) {
    char text[64];
    if (!length || length >= sizeof(text))
        return false;
    memcpy(text, line, length);
    text[length] = 0;
    char *comma = strchr(text, ',');
    if (comma && !strchr(text, '.'))
        *comma = '.';
    return noc_parse_double(text, out) && fabs(*out) < 1e12;
}

noc_status photometry_reserve(photometry_text *t, photometry_grid *g, long planes, long gammas) {
    if (planes < 1 || gammas < 2 || planes > PHOTOMETRY_MOST_ANGLES || gammas > PHOTOMETRY_MOST_ANGLES ||
        planes * gammas > PHOTOMETRY_MOST_VALUES)
        return photometry_bad(t, t->line,
                              "%ld planes of %ld angles: at least 1 of 2 are needed, at most %d of %d read, and %d "
                              "values",
                              planes, gammas, PHOTOMETRY_MOST_ANGLES, PHOTOMETRY_MOST_ANGLES, PHOTOMETRY_MOST_VALUES);
    /* every value takes two bytes at least, so a short file cannot ask for much memory */
    if ((size_t)(planes + gammas) > (size_t)(t->end - t->at))
        return photometry_bad(t, t->line, "ends before its %ld planes of %ld angles", planes, gammas);
    if (!array_reserve(&g->c, (size_t)planes) || !array_reserve(&g->gamma, (size_t)gammas))
        return noc_no_memory(t->log, t->name);
    return NOC_OK;
}
