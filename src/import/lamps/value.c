/* Numbers with units, directions and colours as people write them in tags and tables. */
#include "import/lamps/tags.h"

#include <ctype.h>
#include <math.h>

static const char *skip_blanks(const char *s) {
    while (*s == ' ' || *s == '\t' || *s == '~')
        s++;
    return s;
}

bool lamp_blank(const char *text) {
    static const char *const none[] = { "na",       "n a",       "null",    "none", "unknown",        "nan",
                                        "onbekend", "unbekannt", "inconnu", "nil",  "not applicable", "not known" };
    if (!text)
        return true;
    char c = *text;
    if ((c >= '0' && c <= '9') || (((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z')) && !strchr("nuoiNUOI", c)))
        return false; /* begins like none of them */
    char folded[32];
    if (!lamp_fold(text, true, folded, sizeof(folded)))
        return true; /* "", "-", "?" */
    for (size_t i = 0; i < NOC_COUNT(none); i++)
        if (!strcmp(folded, none[i]))
            return true;
    return false;
}

static bool three_digits(const char *s) {
    return isdigit((unsigned char)s[0]) && isdigit((unsigned char)s[1]) && isdigit((unsigned char)s[2]) &&
           !isdigit((unsigned char)s[3]);
}

const char *lamp_scan_number(const char *s, bool thousands, char decimal, double *out) {
    char text[48], parts = decimal ? ".,"[decimal == '.'] : thousands ? ',' : 0;
    size_t n = 0;
    bool dot = false;
    const char *p = s;
    for (; n + 1 < sizeof(text); p++) {
        if (isdigit((unsigned char)*p)) {
            text[n++] = *p;
        } else if (parts && *p == parts && !dot && n && text[0] != '0' && three_digits(p + 1)) {
            continue;
        } else if ((*p == '.' || *p == ',') && !dot && isdigit((unsigned char)p[1])) {
            text[n++] = '.';
            dot = true;
        } else {
            break;
        }
    }
    text[n] = 0;
    return n && noc_parse_double(text, out) ? p : NULL;
}

static const struct unit {
    lamp_unit unit;
    const char *name;
    double factor;
    const char *shown;
} units[] = {
    { LAMP_METRES, "m", 1, "m" },
    { LAMP_METRES, "mtr", 1, "m" },
    { LAMP_METRES, "meter", 1, "m" },
    { LAMP_METRES, "meters", 1, "m" },
    { LAMP_METRES, "metre", 1, "m" },
    { LAMP_METRES, "metres", 1, "m" },
    { LAMP_METRES, "dm", .1, "dm" },
    { LAMP_METRES, "cm", .01, "cm" },
    { LAMP_METRES, "mm", .001, "mm" },
    { LAMP_METRES, "ft", .3048, "ft" },
    { LAMP_METRES, "feet", .3048, "ft" },
    { LAMP_METRES, "foot", .3048, "ft" },
    { LAMP_METRES, "fuss", .3048, "ft" },
    { LAMP_METRES, "in", .0254, "in" },
    { LAMP_METRES, "inches", .0254, "in" },
    { LAMP_WATTS, "w", 1, "W" },
    { LAMP_WATTS, "watt", 1, "W" },
    { LAMP_WATTS, "watts", 1, "W" },
    { LAMP_WATTS, "kw", 1000, "kW" },
    { LAMP_WATTS, "kilowatt", 1000, "kW" },
    { LAMP_WATTS, "kilowatts", 1000, "kW" },
    { LAMP_LUMENS, "lm", 1, "lm" },
    { LAMP_LUMENS, "lumen", 1, "lm" },
    { LAMP_LUMENS, "lumens", 1, "lm" },
    { LAMP_LUMENS, "klm", 1000, "klm" },
    { LAMP_LUMENS, "kilolumen", 1000, "klm" },
    { LAMP_LUMENS, "kilolumens", 1000, "klm" },
    { LAMP_KELVIN, "k", 1, "K" },
    { LAMP_KELVIN, "kelvin", 1, "K" },
    { LAMP_KELVIN, "kk", 1000, "kK" },
};

bool lamp_unit_word(const char *word, lamp_unit unit, double *scale, const char **name) {
    for (size_t i = 0; i < NOC_COUNT(units); i++)
        if (units[i].unit == unit && !strcmp(units[i].name, word)) {
            *scale = units[i].factor;
            *name = units[i].shown;
            return true;
        }
    return false;
}

/* The longest unit that fits: "klm" before "lm". */
size_t lamp_unit_tail(const char *folded, lamp_unit unit, double *scale, const char **name) {
    size_t n = strlen(folded), best = 0;
    for (size_t i = 0; i < NOC_COUNT(units); i++) {
        size_t m = strlen(units[i].name);
        if (units[i].unit != unit || m <= best || m >= n || strcmp(folded + n - m, units[i].name))
            continue;
        best = m;
        *scale = units[i].factor;
        *name = units[i].shown;
    }
    if (best && best + 2 < n && !strncmp(folded + n - best - 2, "in", 2))
        best += 2; /* "pole height in feet" */
    return best;
}

char lamp_decimal_sign(const char *text) {
    const char *p = skip_blanks(text);
    p += *p == '-';
    size_t before = strspn(p, "0123456789"), after = before && p[before] ? strspn(p + before + 1, "0123456789") : 0;
    const char *end = skip_blanks(p + before + 1 * (after > 0) + after);
    bool decimal = before && after && (after != 3 || *p == '0') && (p[before] == '.' || p[before] == ',');
    return decimal && (!*end || isalpha((unsigned char)*end)) ? p[before] : 0;
}

/* Is what stands behind the number of a direction nothing, or the unit of degrees? "50 gon", "0.5 rad" and "12:30" are
 * none in degrees. */
static bool is_degrees(const char *rest) {
    static const char *const words[] = { "", "deg", "degs", "degree", "degrees", "grad", "graden", "grados", "gradi" };
    static const char *const signs[] = { "\xc2\xb0", "\xc2\xba", "\xcb\x9a" };
    char folded[16];
    for (size_t i = 0; i < NOC_COUNT(signs); i++)
        rest += !strncmp(rest, signs[i], 2) ? 2 : 0;
    if (*rest && !isalpha((unsigned char)*rest) && *skip_blanks(rest) != 0)
        return *skip_blanks(rest) == '(';
    lamp_fold(rest, false, folded, sizeof(folded));
    for (size_t i = 0; i < NOC_COUNT(words); i++)
        if (!strcmp(folded, words[i]))
            return true;
    return false;
}

bool lamp_direction(const char *text, double *degrees) {
    static const struct {
        const char *name;
        double degrees;
    } points[] = {
        { "n", 0 },       { "nne", 22.5 },      { "ne", 45 },        { "ene", 67.5 },      { "e", 90 },
        { "ese", 112.5 }, { "se", 135 },        { "sse", 157.5 },    { "s", 180 },         { "ssw", 202.5 },
        { "sw", 225 },    { "wsw", 247.5 },     { "w", 270 },        { "wnw", 292.5 },     { "nw", 315 },
        { "nnw", 337.5 }, { "north", 0 },       { "northeast", 45 }, { "east", 90 },       { "southeast", 135 },
        { "south", 180 }, { "southwest", 225 }, { "west", 270 },     { "northwest", 315 },
    };
    if (lamp_blank(text))
        return false;
    char folded[16];
    lamp_fold(text, false, folded, sizeof(folded));
    for (size_t i = 0; i < NOC_COUNT(points); i++)
        if (!strcmp(folded, points[i].name)) {
            *degrees = points[i].degrees;
            return true;
        }
    const char *p = skip_blanks(text);
    bool negative = *p == '-';
    double x;
    p = lamp_scan_number(p + negative, false, 0, &x);
    if (!p || x > 360)
        return false;
    if (!is_degrees(skip_blanks(p))) /* a range or a list ("90-180", "90;270") names no one direction, either */
        return false;
    *degrees = fmod(negative ? 360 - x : x, 360);
    return true;
}

/* Where one item of a list ends. A comma parts items before a blank, or before three digits where it is no decimal
 * sign: "45,225". */
static size_t item_length(const char *p, char decimal) {
    size_t n = strcspn(p, ";/|&+,");
    while (p[n] == ',' && !(p[n + 1] == ' ' || (decimal != ',' && three_digits(p + n + 1))))
        n += 1 + strcspn(p + n + 1, ";/|&+,");
    return n;
}

int lamp_directions(const char *text, char decimal, float degrees[GEO_HEADINGS]) {
    int count = 0;
    for (const char *p = text; count < GEO_HEADINGS; p++) {
        char item[32];
        double one;
        size_t n = item_length(p, decimal);
        noc_snprintf(item, sizeof(item), "%.*s", (int)NOC_MIN(n, sizeof(item) - 1), skip_blanks(p));
        item[NOC_MIN(n - NOC_MIN((size_t)(skip_blanks(p) - p), n), sizeof(item) - 1)] = 0;
        if (!lamp_direction(item, &one))
            return 0;
        degrees[count++] = (float)one;
        p += n;
        if (!*p)
            return count;
    }
    return 0;
}

static float srgb_to_linear(int v) {
    double x = v / 255.0;
    return (float)(x <= 0.04045 ? x / 12.92 : pow((x + 0.055) / 1.055, 2.4));
}

bool lamp_hex_colour(const char *text, float rgb[3]) {
    text = skip_blanks(text);
    if (*text++ != '#')
        return false;
    int digit[6], n = 0;
    for (; isxdigit((unsigned char)text[n]) && n < 6; n++)
        digit[n] = isdigit((unsigned char)text[n]) ? text[n] - '0' : tolower((unsigned char)text[n]) - 'a' + 10;
    if ((n != 3 && n != 6) || isxdigit((unsigned char)text[n]))
        return false;
    for (int i = 0; i < 3; i++)
        rgb[i] = srgb_to_linear(n == 3 ? digit[i] * 17 : digit[2 * i] * 16 + digit[2 * i + 1]);
    return true;
}
