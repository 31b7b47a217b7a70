/* IES LM-63, of 1986 (without a first line), 1991, 1995, 2002 and 2019. First lines that are spelled otherwise are read
 * as the nearest edition. */
#include "photometry/photometry.h"

#include <ctype.h>
#include <math.h>

static bool starts(const char *s, size_t n, const char *with) {
    size_t k = strlen(with);
    if (n < k)
        return false;
    for (size_t i = 0; i < k; i++)
        if (toupper((unsigned char)s[i]) != with[i])
            return false;
    return true;
}

/* Where the line after "TILT=" goes on, NULL if the line is no such one. */
static const char *tilt_of(const char *line, size_t n) {
    if (!starts(line, n, "TILT"))
        return NULL;
    const char *s = line + 4, *end = line + n;
    while (s < end && *s == ' ')
        s++;
    if (s == end || *s != '=')
        return NULL;
    for (s++; s < end && *s == ' ';)
        s++;
    return s;
}

static const struct {
    const char *begins, *name;
    int year;
} editions[] = { { "IESNA91", "IES LM-63-1991", 1991 },          { "IESNA:LM-63-1991", "IES LM-63-1991", 1991 },
                 { "IESNA95", "IES LM-63-1995", 1995 }, /* as some tools spell it */
                 { "IESNA:LM-63-1995", "IES LM-63-1995", 1995 }, { "IESNA:LM-63-2002", "IES LM-63-2002", 2002 },
                 { "IESNA:LM-63-2019", "IES LM-63-2019", 2019 }, { "IES:LM-63-2019", "IES LM-63-2019", 2019 },
                 { "IESNA86", "IES LM-63-1986", 1986 },          { "IESNA:LM-63-1986", "IES LM-63-1986", 1986 } };

enum { USUAL_YEAR = 2002 }; /* where a first line names no year */

static bool skip_word(const char **s, const char *word) {
    size_t n = strlen(word);
    bool there = !strncmp(*s, word, n);
    *s += there ? n : 0;
    return there;
}

/* The year that a first line means whose letters and digits begin as those of LM-63 do ("IESNA: LM-63-2002", "IES
 * LM-63-02", "ANSI/IES LM63", "IESNA 91"): 0 where it names none. Returns false for other lines: they are labels. */
static bool header_year(const char *line, size_t n, int *year) {
    char text[32] = "";
    size_t length = 0;
    for (size_t i = 0; i < n && length < sizeof(text) - 1; i++)
        if (isalnum((unsigned char)line[i]))
            text[length++] = (char)toupper((unsigned char)line[i]);
    const char *s = text;
    (void)skip_word(&s, "ANSI");
    bool society = skip_word(&s, "IESNA"), sure = society || !skip_word(&s, "IES");
    if (!skip_word(&s, "LM63") && !(society && sure))
        return false;
    size_t digits = strspn(s, "0123456789");
    *year = digits == 4 || digits == 2 ? atoi(s) : 0;
    if (digits == 2)
        *year += *year < 80 ? 2000 : 1900;
    return true;
}

static int nearest_edition(int year) {
    int nearest = 0;
    for (int k = 1; k < (int)NOC_COUNT(editions); k++)
        if (abs(editions[k].year - year) < abs(editions[nearest].year - year))
            nearest = k;
    return nearest;
}

/* An index of editions, -1: the line is a label of 1986. Reports a line that is spelled otherwise. */
static int edition_of(const photometry_text *t, const char *line, size_t n) {
    int year, shown = (int)NOC_MIN(n, 40);
    for (size_t k = 0; k < NOC_COUNT(editions); k++)
        if (starts(line, n, editions[k].begins))
            return (int)k;
    if (!header_year(line, n, &year))
        return -1;
    int edition = nearest_edition(year ? year : USUAL_YEAR);
    noc_warn(t->log, "%s:%d: \"%.*s\" is %s, read as %s", t->name, t->line, shown, line,
             editions[edition].year == year ? "spelled otherwise than LM-63 does" : "no edition of LM-63 that is known",
             editions[edition].name);
    return edition;
}

static bool probe(const char *head, size_t size) {
    photometry_text t = { head, head + size, "", NULL, 0 };
    const char *line;
    size_t n;
    int year;
    for (int i = 0; i < 60 && photometry_line(&t, &line, &n); i++) {
        if (i == 0 && starts(line, n, "\xef\xbb\xbf")) {
            line += 3;
            n -= 3;
        }
        if (i == 0 && header_year(line, n, &year))
            return true;
        if (tilt_of(line, n)) /* 1986 */
            return true;
        if (memchr(line, 0, n))
            return false;
    }
    return false;
}

/* Keeps the rest of "[KEY] text" as *to, once. */
static void keep(noc_profile *p, const char *line, size_t n, const char *key, const char **to) {
    size_t k = strlen(key);
    if (**to || !starts(line, n, key))
        return;
    for (line += k, n -= k; n && *line == ' '; n--)
        line++;
    char *text = arena_strndup(&p->texts, line, n);
    *to = text ? text : "";
}

typedef struct header {
    long lamps, type;
    double lumens, multiplier, width, length, height, ballast, photometric, watts;
    int edition; /* index of editions; -1: 1986 */
} header;

/* Keywords of the colour temperature itself are the user's: [_CCT], [COLORTEMP], ... */
static double label_kelvin(const char *line, size_t n) {
    const char *close = *line == '[' ? memchr(line, ']', n) : NULL;
    char key[24] = "";
    if (close && (size_t)(close - line) < sizeof(key))
        for (size_t i = 0; line + i < close; i++)
            key[i] = (char)toupper((unsigned char)line[i]);
    if (!strstr(key, "CCT") && !strstr(key, "COLORTEMP") && !strstr(key, "KELVIN"))
        return photometry_kelvin(line, n);
    const char *value = close + 1;
    while (value < line + n && *value == ' ')
        value++;
    return photometry_kelvin_field(value, (size_t)(line + n - value));
}

/* Up to the line of TILT. */
static noc_status read_labels(photometry_text *t, noc_profile *p, header *h, const char **tilt, size_t *tilt_length) {
    const char *line, *first = NULL;
    size_t n;
    h->edition = -1;
    for (int i = 0; photometry_line(t, &line, &n); i++) {
        if (i == 0 && starts(line, n, "\xef\xbb\xbf")) {
            line += 3;
            n -= 3;
        }
        if (i == 0)
            h->edition = edition_of(t, line, n);
        *tilt = tilt_of(line, n);
        if (*tilt) {
            *tilt_length = (size_t)(line + n - *tilt);
            if (h->edition < 0 && first && !*p->info.name) { /* the first label of 1986 is the luminaire's, mostly */
                const char *end = memchr(first, '\n', (size_t)(t->end - first));
                keep(p, first, end ? (size_t)(end - first) : 0, "", &p->info.name);
            }
            return NOC_OK;
        }
        if (!first && n)
            first = line;
        if (p->info.kelvin == 0)
            p->info.kelvin = label_kelvin(line, n);
        keep(p, line, n, "[LUMINAIRE]", &p->info.name);
        keep(p, line, n, "[MANUFAC]", &p->info.manufacturer);
        keep(p, line, n, "[LAMP]", &p->info.lamp);
    }
    return photometry_bad(t, t->line, "no line of TILT=");
}

/* Factors by which a lamp's light changes as it is tilted. The luminaire as measured is at 0 degrees: that factor is 1,
 * or all intensities are off by it. */
static noc_status read_tilt(photometry_text *t, double *factor) {
    long geometry, pairs = 0;
    double angle, value, nearest = INFINITY;
    noc_status status = photometry_whole(t, "the lamp-to-luminaire geometry", 1, 3, &geometry);
    if (!status)
        status = photometry_whole(t, "the number of tilt angles", 1, 1000, &pairs);
    long at = 0;
    for (long i = 0; i < pairs && !status; i++) {
        status = photometry_number(t, "a tilt angle", &angle);
        if (!status && fabs(angle) < nearest) {
            nearest = fabs(angle);
            at = i;
        }
    }
    for (long i = 0; i < pairs && !status; i++) {
        status = photometry_number(t, "a tilt factor", &value);
        if (!status && !(value >= 0 && value < 100))
            return photometry_bad(t, t->line, "a tilt factor of %g", value);
        if (i == at)
            *factor = value;
    }
    return status;
}

static noc_status read_numbers(photometry_text *t, header *h, long *gammas, long *planes) {
    long units = 2;
    noc_status status = photometry_whole(t, "the number of lamps", 0, 100000, &h->lamps);
    const struct {
        const char *what;
        double *to;
    } later[] = { { "the width", &h->width },
                  { "the length", &h->length },
                  { "the height", &h->height },
                  { "the ballast factor", &h->ballast },
                  { "the ballast-lamp factor", &h->photometric },
                  { "the watts", &h->watts } };
    if (!status)
        status = photometry_number(t, "the lumens of a lamp", &h->lumens);
    if (!status)
        status = photometry_number(t, "the multiplier", &h->multiplier);
    if (!status)
        status = photometry_whole(t, "the number of vertical angles", 1, 1000000, gammas);
    if (!status)
        status = photometry_whole(t, "the number of horizontal angles", 1, 1000000, planes);
    if (!status)
        status = photometry_whole(t, "the photometric type", 1, 3, &h->type);
    if (!status)
        status = photometry_whole(t, "the units", 1, 2, &units);
    for (size_t i = 0; i < NOC_COUNT(later) && !status; i++)
        status = photometry_number(t, later[i].what, later[i].to);
    if (status)
        return status;
    if (!(h->multiplier > 0))
        return photometry_bad(t, t->line, "a multiplier of %g", h->multiplier);
    if (!(h->ballast > 0))
        return photometry_bad(t, t->line, "a ballast factor of %g", h->ballast);
    double metres = units == 1 ? .3048 : 1;
    h->width *= metres;
    h->length *= metres;
    h->height *= metres;
    return NOC_OK;
}

static noc_status read_grid(photometry_text *t, photometry_grid *g, long planes, long gammas, double factor,
                            int *line) {
    noc_status status = photometry_reserve(t, g, planes, gammas);
    for (long i = 0; i < gammas && !status; i++) {
        status = photometry_number(t, "a vertical angle", &g->gamma.data[i]);
        g->gamma.len += !status;
    }
    *line = t->line;
    for (long i = 0; i < planes && !status; i++) {
        status = photometry_number(t, "a horizontal angle", &g->c.data[i]);
        g->c.len += !status;
    }
    for (long i = 0; i < planes * gammas && !status; i++) {
        double cd;
        status = photometry_number(t, "an intensity", &cd);
        if (!status && cd < 0)
            return photometry_bad(t, t->line, "an intensity is negative: %g", cd);
        if (!status && !array_push(&g->cd, cd * factor))
            return noc_no_memory(t->log, t->name);
    }
    return status;
}

static noc_status read_body(photometry_text *t, noc_profile *p) {
    header h = { 0 };
    const char *tilt = NULL;
    size_t tilt_length = 0;
    long gammas, planes;
    double tilted = 1;
    int line = 0;
    noc_status status = read_labels(t, p, &h, &tilt, &tilt_length);
    if (status)
        return status;
    bool inside = starts(tilt, tilt_length, "INCLUDE");
    if (!inside && !starts(tilt, tilt_length, "NONE"))
        return noc_error(t->log, NOC_ERR_UNSUPPORTED,
                         "%s:%d: its tilt factors are in a file of their own, which is not read: \"%.*s\" (the file"
                         " may hold them by TILT=INCLUDE)",
                         t->name, t->line, (int)NOC_MIN(tilt_length, 60), tilt);
    t->line++; /* numbers follow, from the next line on */
    if (inside)
        status = read_tilt(t, &tilted);
    if (!status)
        status = read_numbers(t, &h, &gammas, &planes);
    if (status)
        return status;
    int year = h.edition < 0 ? 1986 : editions[h.edition].year;
    double drive = h.ballast * (year <= 1991 && h.photometric > 0 ? h.photometric : 1);
    photometry_grid g = { .type = h.type == 1 ? 'C' : h.type == 2 ? 'B' : 'A' };
    status = read_grid(t, &g, planes, gammas, h.multiplier * drive * tilted, &line);
    if (!status)
        status = photometry_fill(p, &g, t->log, t->name, line);
    if (!status) {
        noc_profile_info *info = &p->info;
        if (photometry_more(t))
            noc_warn(t->log, "%s:%d: more follows its last intensity, which is not read", t->name, t->line);
        char *format =
            arena_format(&p->texts, "%s, type %c", h.edition < 0 ? "IES LM-63-1986" : editions[h.edition].name, g.type);
        info->format = format ? format : "";
        info->lamp_lumens = h.lumens >= 0 ? h.lumens * (double)NOC_MAX(h.lamps, 1) * drive * tilted : NAN;
        info->watts = fmax(h.watts, 0);
        info->size[0] = h.width;
        info->size[1] = h.length;
        info->size[2] = h.height;
        photometry_judge(p, t->log, t->name);
    }
    photometry_grid_free(&g);
    return status;
}

const photometry_format photometry_ies = { probe, read_body };
