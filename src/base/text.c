#include "base/base.h"

#include <errno.h>
#include <locale.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <time.h>

static locale_t c_locale;
static pthread_once_t c_locale_once = PTHREAD_ONCE_INIT;

static void make_c_locale(void) { c_locale = newlocale(LC_ALL_MASK, "C", (locale_t)0); }

int noc_vsnprintf(char *text, size_t size, const char *fmt, va_list ap) {
    pthread_once(&c_locale_once, make_c_locale);
    locale_t hosts = uselocale(c_locale); /* of this thread alone */
    int n = vsnprintf(text, size, fmt, ap);
    uselocale(hosts);
    return n;
}

int noc_snprintf(char *text, size_t size, const char *fmt, ...) {
    va_list ap;
    va_start(ap, fmt);
    int n = noc_vsnprintf(text, size, fmt, ap);
    va_end(ap);
    return n;
}

int noc_fprintf(FILE *file, const char *fmt, ...) {
    va_list ap;
    pthread_once(&c_locale_once, make_c_locale);
    locale_t hosts = uselocale(c_locale);
    va_start(ap, fmt);
    int n = vfprintf(file, fmt, ap);
    va_end(ap);
    uselocale(hosts);
    return n;
}

static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

/* Plain decimals with up to 15 digits convert exactly with one division; the rest goes to strtod. Returns where the
 * number ends, NULL where it is none of those. end: NULL where a 0 is behind the text. */
static const char *scan_plain(const char *s, const char *end, double *out) {
    static const double pow10[] = {
        1, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15
    };
    enum { MOST_DIGITS = 15 };
    bool negative = s != end && *s == '-';
    s += negative || (s != end && *s == '+');
    uint64_t v = 0;
    const char *first = s, *dot = NULL;
    for (; s != end; s++) {
        unsigned digit = (unsigned)(unsigned char)*s - '0';
        if (digit <= 9 && s - first <= MOST_DIGITS)
            v = v * 10 + digit;
        else if (*s == '.' && !dot)
            dot = s;
        else
            break;
    }
    ptrdiff_t digits = s - first - (dot != NULL);
    if (digits < 1 || digits > MOST_DIGITS)
        return NULL;
    double d = (double)v / pow10[dot ? s - dot - 1 : 0];
    *out = negative ? -d : d;
    return s;
}

const char *noc_scan_double(const char *s, const char *end, double *out) {
    while (s < end && is_blank(*s))
        s++;
    const char *stop = scan_plain(s, end, out);
    if (stop && (stop == end || is_blank(*stop)))
        return stop;
    for (stop = s; stop < end && !is_blank(*stop);)
        stop++;
    char text[64];
    size_t n = (size_t)(stop - s);
    if (!n || n >= sizeof(text))
        return NULL;
    memcpy(text, s, n);
    text[n] = 0;
    return noc_parse_double(text, out) ? stop : NULL;
}

bool noc_parse_double(const char *s, double *out) {
    if (!s)
        return false;
    while (is_blank(*s))
        s++;
    const char *stop = scan_plain(s, NULL, out);
    if (stop && !*stop)
        return true;
    if (!*s || *s == 'n' || *s == 'N' || strpbrk(s, "xX")) /* no hexadecimal, no "nan" */
        return false;
    pthread_once(&c_locale_once, make_c_locale);
    char *end;
    double d = strtod_l(s, &end, c_locale);
    if (end == s)
        return false;
    while (is_blank(*end))
        end++;
    if (*end || !isfinite(d))
        return false;
    *out = d;
    return true;
}

bool noc_parse_int(const char *s, long long *out) {
    if (!s)
        return false;
    while (is_blank(*s))
        s++;
    char *end;
    errno = 0;
    long long v = strtoll(s, &end, 10);
    if (end == s || errno)
        return false;
    while (is_blank(*end))
        end++;
    if (*end)
        return false;
    *out = v;
    return true;
}

static char lower(char c) { return c >= 'A' && c <= 'Z' ? (char)(c + 32) : c; }

bool noc_ieq(const char *a, const char *b) {
    if (!a || !b)
        return false;
    for (; *a && lower(*a) == lower(*b); a++, b++)
        ;
    return lower(*a) == lower(*b);
}

static double seconds(clockid_t clock) {
    struct timespec t;
    clock_gettime(clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

double noc_wall_seconds(void) { return seconds(CLOCK_MONOTONIC); }
double noc_cpu_seconds(void) { return seconds(CLOCK_PROCESS_CPUTIME_ID); }
