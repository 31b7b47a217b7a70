/* Coordinates as people write them: decimal numbers, with a degree sign or a hemisphere or without, and degrees,
 * minutes and seconds. */
#include "import/lamps/tags.h"

#include <ctype.h>
#include <math.h>

/* In UTF-8 and in Latin-1; what begins like another comes before it. */
static const char *const degree_signs[] = { "\xc2\xb0", "\xc2\xba", "\xcb\x9a", "\xb0", "\xba", "deg", "d", ":" };
static const char *const minute_signs[] = { "\xe2\x80\xb2", "\xe2\x80\x99", "\xc2\xb4", "\xb4", "min", "m", "'", ":" };
static const char *const second_signs[] = {
    "\xe2\x80\xb3", "\xe2\x80\x9d", "\xe2\x80\xb2\xe2\x80\xb2", "''", "\"", "sec", "s"
};

static const char *skip_blanks(const char *s) { return s + strspn(s, " \t"); }

/* Behind one of the signs; NULL: there is none. */
static const char *after_sign(const char *p, const char *const *signs, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (!strncmp(p, signs[i], strlen(signs[i])))
            return skip_blanks(p + strlen(signs[i]));
    return NULL;
}
#define AFTER(p, signs) after_sign(p, signs, NOC_COUNT(signs))

static bool is_hemisphere(char c) { return c && strchr("NSEWnsew", c); }

/* Minutes or seconds, below 60, behind what is before them; NULL: there are none. */
static const char *sixtieths(const char *p, double *value) {
    p = isdigit((unsigned char)*p) ? lamp_scan_number(p, false, 0, value) : NULL;
    return p && *value < 60 ? p : NULL;
}

/* Behind minutes and seconds, which are added. Without signs blanks part them, and then whole numbers are before them.
 */
static const char *add_sixtieths(const char *p, double degrees, double *value) {
    const char *after = AFTER(skip_blanks(p), degree_signs), *next;
    double minutes, seconds;
    bool blanks = !after && *p == ' ' && degrees == floor(degrees);
    if (!after && !blanks)
        return skip_blanks(p);
    after = after ? after : skip_blanks(p);
    if (!(next = sixtieths(after, &minutes)))
        return after;
    *value += minutes / 60;
    next = skip_blanks(next);
    after = AFTER(next, minute_signs);
    after = after ? after : next;
    if (minutes != floor(minutes) || !(next = sixtieths(after, &seconds)))
        return after;
    *value += seconds / 3600;
    next = skip_blanks(next);
    after = AFTER(next, second_signs);
    return after ? after : next;
}

/* Behind a coordinate that begins at p; NULL: there is none. hemisphere: in capitals; 0: it names none. */
static const char *scan(const char *p, double *value, char *hemisphere) {
    p = skip_blanks(p);
    *hemisphere = is_hemisphere(*p) ? *p : 0;
    p = skip_blanks(p + (*hemisphere != 0));
    bool negative = *p == '-';
    p = skip_blanks(p + (*p == '-' || *p == '+'));
    if (!(p = lamp_scan_number(p, false, 0, value)))
        return NULL;
    p = add_sixtieths(p, *value, value);
    if (!*hemisphere && is_hemisphere(*p))
        *hemisphere = *p++;
    *hemisphere = (char)toupper((unsigned char)*hemisphere);
    bool flip = *hemisphere == 'S' || *hemisphere == 'W';
    *value = negative != flip ? -*value : *value;
    return skip_blanks(p);
}

bool lamp_coordinate(const char *text, double *value) {
    char hemisphere;
    if (!text)
        return false;
    const char *p = scan(text, value, &hemisphere);
    if (p && (!*p || *p == '\r'))
        return true;
    return noc_parse_double(text, value); /* exponents and the like */
}

bool lamp_coordinates(const char *text, double *lat, double *lon) {
    char first, second;
    const char *p = text ? scan(text + strspn(text, " \t(["), lat, &first) : NULL;
    bool signs = p && (first || strpbrk(text, "'\xb0\xba:"));
    p = signs ? scan(p + strspn(p, ",;/ \t"), lon, &second) : NULL;
    if (!p || (*p && !strchr(")]\r", *p)))
        return false;
    if (first == 'E' || first == 'W' || second == 'N' || second == 'S') {
        double swap = *lat;
        *lat = *lon;
        *lon = swap;
    }
    return true;
}
