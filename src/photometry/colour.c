/* Colour temperatures as files of luminaires name them. */
#include "photometry/photometry.h"

#include <ctype.h>

enum { LEAST_KELVIN = 1500, MOST_KELVIN = 20000 };

static bool is_kelvin(long x) { return x >= LEAST_KELVIN && x <= MOST_KELVIN; }

/* The digits at text[i]; *end is behind them. -1: more than a colour temperature has. */
static long digits_at(const char *text, size_t length, size_t i, size_t *end) {
    long x = 0;
    size_t first = i;
    for (; i < length && isdigit((unsigned char)text[i]); i++)
        x = i - first < 6 ? x * 10 + (text[i] - '0') : -1;
    *end = i;
    return i - first < 6 ? x : -1;
}

double photometry_kelvin(const char *text, size_t length) {
    long found = 0;
    for (size_t i = 0, end; i < length; i = end) {
        end = i + 1;
        if (!isdigit((unsigned char)text[i]))
            continue;
        long x = digits_at(text, length, i, &end);
        bool word = (i > 0 && (isalnum((unsigned char)text[i - 1]) || text[i - 1] == '.'));
        size_t unit = end < length && text[end] == ' ' ? end + 1 : end;
        bool kelvin = unit < length && (text[unit] == 'K' || text[unit] == 'k') &&
                      !(unit + 1 < length && isalnum((unsigned char)text[unit + 1]));
        if (!kelvin || word || !is_kelvin(x))
            continue;
        if (found && found != x)
            return 0;
        found = x;
    }
    return (double)found;
}

double photometry_kelvin_field(const char *text, size_t length) {
    double named = photometry_kelvin(text, length);
    size_t end;
    if (named > 0 || !length || !isdigit((unsigned char)*text))
        return named;
    long x = digits_at(text, length, 0, &end);
    if (end == 3 && x >= 600 && x % 100 >= 18 && x % 100 <= 65) /* tens of its rendering index, hundreds of kelvins */
        return (double)(x % 100 * 100);
    return end == length && is_kelvin(x) ? (double)x : 0;
}
