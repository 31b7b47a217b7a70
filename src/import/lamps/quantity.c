/* Quantities as people write them: a number with its unit, products of heads, sums, alternatives and ranges. */
#include "import/lamps/tags.h"

#include <ctype.h>
#include <math.h>

enum { MOST_TERMS = 8, MOST_TIMES = 99, FEW_HEADS = 4, WORD = 16 };

typedef enum joint { JOINT_NONE, JOINT_SUM, JOINT_OR, JOINT_RANGE } joint;

typedef struct term {
    double value, factor; /* of the unit that it names */
    int times;
    bool unit;
    const char *end;
} term;

typedef struct length_mark {
    const char *text;
    double metres;
} length_mark;

/* Blanks, those of typesetters too: no-break, thin, narrow no-break. */
static const char *skip_blanks(const char *s) {
    static const char *const blanks[] = { " ", "\t", "~", "\xc2\xa0", "\xe2\x80\x89", "\xe2\x80\xaf" };
    for (size_t i = 0; i < NOC_COUNT(blanks); i++)
        if (!strncmp(s, blanks[i], strlen(blanks[i]))) {
            s += strlen(blanks[i]);
            i = (size_t)-1; /* again from the first */
        }
    return s;
}

static bool is_digit(char c) { return isdigit((unsigned char)c); }

/* The word of ASCII letters at s in lower case; returns its length, whatever of it fits. */
static size_t read_word(const char *s, char word[WORD]) {
    size_t n = 0;
    for (; isalpha((unsigned char)s[n]); n++)
        word[NOC_MIN(n, WORD - 2)] = (char)tolower((unsigned char)s[n]);
    word[NOC_MIN(n, WORD - 1)] = 0;
    return n;
}

/* Units of other quantities: what has one is no number of this. */
static bool is_other_unit(const char *word, lamp_unit unit) {
    static const char *const others[] = { "v", "kv", "volt", "volts", "vac", "hz", "a", "ma", "amp", "amps", "va" };
    double scale;
    const char *name;
    for (size_t i = 0; i < NOC_COUNT(others); i++)
        if (!strcmp(word, others[i]))
            return true;
    for (int other = LAMP_METRES; other < LAMP_PLAIN; other++)
        if ((lamp_unit)other != unit && lamp_unit_word(word, (lamp_unit)other, &scale, &name))
            return true;
    return false;
}

/* NULL where no number begins at p, or a malformed one. */
static const char *scan_one(const char *p, lamp_unit unit, char decimal, double *value) {
    bool thousands = unit == LAMP_WATTS || unit == LAMP_LUMENS || unit == LAMP_KELVIN;
    const char *end = lamp_scan_number(p, thousands, decimal, value);
    return end && !((*end == '.' || *end == ',') && is_digit(end[1])) ? end : NULL;
}

static size_t times_sign(const char *p) {
    bool x = (*p == 'x' || *p == 'X') && !isalpha((unsigned char)p[1]);
    return x || *p == '*' || *p == '@' ? 1 : !strncmp(p, "\xc3\x97", 2) ? 2 : 0;
}

/* The sign of feet or inches at p, as keyboards, typographers and prime signs have it; NULL: none. */
static const length_mark *length_sign(const char *p) {
    static const length_mark signs[] = { { "''", .0254 },           { "'", .3048 },
                                         { "\"", .0254 },           { "\xc2\xb4", .3048 },
                                         { "\xe2\x80\x99", .3048 }, { "\xe2\x80\x9d", .0254 },
                                         { "\xe2\x80\xb2", .3048 }, { "\xe2\x80\xb3", .0254 } };
    for (size_t i = 0; i < NOC_COUNT(signs); i++)
        if (!strncmp(p, signs[i].text, strlen(signs[i].text)))
            return &signs[i];
    return NULL;
}

/* Inches behind feet: "16'6\"", "16 ft 6 in". Returns the position behind them. */
static const char *add_inches(const char *p, char decimal, bool signed_feet, double *feet) {
    double inches;
    const char *q = scan_one(skip_blanks(p), LAMP_METRES, decimal, &inches), *r = q ? skip_blanks(q) : NULL;
    char word[WORD];
    size_t n = r ? read_word(r, word) : 0;
    const length_mark *mark = r ? length_sign(r) : NULL;
    bool word_named = n && (!strcmp(word, "in") || !strcmp(word, "inch") || !strcmp(word, "inches"));
    bool named = (mark && mark->metres == .0254) || word_named;
    if (!r || (!named && !signed_feet))
        return p;
    *feet += inches / 12;
    return !named ? q : word_named ? r + n : r + strlen(mark->text);
}

/* "110 lm/W", "20 W/m", "60 %": a ratio is no quantity of its own. */
static bool is_ratio(const char *p, bool unit) {
    char word[WORD];
    double scale;
    const char *name;
    if (*p == '%' || !strncmp(p, "\xe2\x80\xb0", 3))
        return true;
    size_t per = *p == '/' ? 1 : !strncmp(p, "per ", 4) || !strncmp(p, "pro ", 4) ? 4 : 0;
    if (!unit || !per || !read_word(skip_blanks(p + per), word))
        return false;
    bool is = false;
    for (int of = LAMP_METRES; of < LAMP_PLAIN; of++)
        is = is || lamp_unit_word(word, (lamp_unit)of, &scale, &name);
    return is;
}

/* The unit behind a number. False where it is one of something else. */
static bool read_unit(term *t, lamp_unit unit, char decimal) {
    const char *q = skip_blanks(t->end), *name;
    const length_mark *mark = unit == LAMP_METRES ? length_sign(q) : NULL;
    if (mark) {
        bool feet = mark->metres == .3048;
        t->factor = mark->metres;
        t->unit = true;
        q += strlen(mark->text);
        t->end = feet ? add_inches(q, decimal, true, &t->value) : q;
        return true;
    }
    char word[WORD];
    size_t n = times_sign(q) ? 0 : read_word(q, word);
    if (!n)
        return !is_ratio(q, false);
    if (!lamp_unit_word(word, unit, &t->factor, &name))
        return q > t->end && !is_other_unit(word, unit);
    t->unit = true;
    t->end = q + n;
    if (unit == LAMP_METRES && t->factor == .3048)
        t->end = add_inches(t->end, decimal, false, &t->value);
    return !is_ratio(skip_blanks(t->end), true);
}

static bool is_times(const term *t) {
    return !t->unit && t->value >= 1 && t->value <= MOST_TIMES && t->value == floor(t->value);
}

/* A number, or a product of heads and what each has: the number without a unit tells the heads; of two such the
 * smaller one. */
static bool read_term(const char *p, lamp_unit unit, char decimal, term *t) {
    *t = (term){ .times = 1 };
    if (!(t->end = scan_one(p, unit, decimal, &t->value)) || !read_unit(t, unit, decimal))
        return false;
    const char *q = skip_blanks(t->end);
    term other = { .times = 1 };
    size_t sign = times_sign(q);
    if (!sign || !is_digit(*skip_blanks(q + sign)))
        return true;
    if (!(other.end = scan_one(skip_blanks(q + sign), unit, decimal, &other.value)) ||
        !read_unit(&other, unit, decimal))
        return false;
    q = skip_blanks(other.end);
    if (times_sign(q) && is_digit(*skip_blanks(q + times_sign(q)))) /* "2x2x36" */
        return false;
    bool first = is_times(t) && (other.unit || !is_times(&other) || t->value <= other.value);
    if (!first && !is_times(&other))
        return false;
    const term *each = first ? &other : t, *heads = first ? t : &other;
    *t = (term){ each->value, each->factor, (int)heads->value, each->unit, other.end };
    return true;
}

/* How what begins at p joins two numbers; *next: behind it. */
static joint read_joint(const char *p, const char **next) {
    static const struct {
        const char *text;
        joint is;
    } joints[] = { { "+", JOINT_SUM },
                   { "&", JOINT_SUM },
                   { "/", JOINT_OR },
                   { ";", JOINT_OR },
                   { "|", JOINT_OR },
                   { "\xe2\x80\x93", JOINT_RANGE },
                   { "-", JOINT_RANGE },
                   { "...", JOINT_RANGE },
                   { "..", JOINT_RANGE },
                   { "\xe2\x80\xa6", JOINT_RANGE },
                   { "\xe2\x80\x94", JOINT_RANGE } };
    static const struct {
        const char *text;
        joint is;
    } words[] = { { "and", JOINT_SUM },   { "und", JOINT_SUM },  { "et", JOINT_SUM }, { "plus", JOINT_SUM },
                  { "or", JOINT_OR },     { "oder", JOINT_OR },  { "ou", JOINT_OR },  { "to", JOINT_RANGE },
                  { "bis", JOINT_RANGE }, { "tot", JOINT_RANGE } };
    char word[WORD];
    for (size_t i = 0; i < NOC_COUNT(joints); i++)
        if (!strncmp(p, joints[i].text, strlen(joints[i].text))) {
            *next = skip_blanks(p + strlen(joints[i].text));
            return joints[i].is;
        }
    *next = p + read_word(p, word);
    for (size_t i = 0; i < NOC_COUNT(words) && *next > p; i++)
        if (!strcmp(word, words[i].text)) {
            *next = skip_blanks(*next);
            return words[i].is;
        }
    return JOINT_NONE;
}

/* A number without a unit has that of the next one that names one, else of the one before: "100-150 W". */
static void share_units(term *t, size_t count, double scale) {
    double factor = 0;
    for (size_t i = count; i-- > 0;)
        factor = t[i].factor = t[i].unit ? t[i].factor : factor;
    for (size_t i = 0; i < count; i++) {
        factor = t[i].factor = t[i].factor > 0 ? t[i].factor : factor > 0 ? factor : scale;
        t[i].value *= factor;
    }
}

/* heads: the first one may be how many. */
static void settle_range(const term *t, bool heads, lamp_number *n) {
    bool range = t[0].times == 1 && t[1].times == 1 && t[0].value < t[1].value;
    n->choice = range ? LAMP_MIDDLE : LAMP_FIRST;
    n->value = range ? (t[0].value + t[1].value) / 2 : t[0].value;
    if (!range || !heads || !is_times(&t[0]) || t[0].value > FEW_HEADS || t[1].value < 10 * t[0].value)
        return;
    *n = (lamp_number){ .value = t[1].value,
                        .times = (int)t[0].value,
                        .terms = 1,
                        .choice = LAMP_HEADS_EACH,
                        .unit = n->unit,
                        .end = n->end };
}

/* What several numbers say together. */
static bool settle(const term *t, const joint *joints, size_t count, lamp_unit unit, lamp_number *n) {
    bool sum = true, range = false;
    for (size_t i = 1; i < count; i++) {
        sum = sum && joints[i] == JOINT_SUM;
        range = range || joints[i] == JOINT_RANGE;
    }
    n->value = t[0].value;
    n->times = t[0].times;
    if (count > 1 && sum && unit != LAMP_KELVIN) { /* colours do not add up */
        n->value = 0;
        n->times = 1;
        n->terms = (int)count;
        for (size_t i = 0; i < count; i++)
            n->value += t[i].value * t[i].times;
    } else if (count == 2 && range) {
        settle_range(t, unit == LAMP_WATTS || unit == LAMP_LUMENS, n);
    } else if (count > 1) {
        n->choice = LAMP_FIRST;
    }
    if (n->times > GEO_MAX_HEADS) {
        n->value *= n->times;
        n->times = 1;
    }
    return isfinite(n->value) && !(range && count > 2); /* a date */
}

/* Is the number at p one of another unit, as the 240 of "120/240V" is, and so the one before it? */
static bool is_of_other(const char *p, lamp_unit unit, char decimal) {
    double value;
    char word[WORD];
    const char *end = scan_one(p, unit, decimal, &value);
    return end && read_word(skip_blanks(end), word) && is_other_unit(word, unit);
}

bool lamp_scan_quantity(const char *p, lamp_unit unit, double scale, char decimal, lamp_number *n) {
    term t[MOST_TERMS];
    joint joints[MOST_TERMS] = { JOINT_NONE };
    *n = (lamp_number){ .times = 1, .terms = 1 };
    if (!read_term(p, unit, decimal, &t[0]))
        return false;
    size_t count = 1;
    while (count < MOST_TERMS) {
        const char *next, *last = t[count - 1].end;
        joints[count] = read_joint(skip_blanks(last), &next);
        if (!joints[count] || !is_digit(*next))
            break;
        if (!t[count - 1].unit && next == last + 1 && is_of_other(next, unit, decimal))
            return false;
        if (!read_term(next, unit, decimal, &t[count]))
            break;
        bool code = unit == LAMP_WATTS && !t[count].unit && lamp_colour_code(t[count].value) > 0;
        if (code && joints[count] != JOINT_SUM) /* "36/830" */
            break;
        count++;
    }
    n->end = t[count - 1].end;
    for (size_t i = 0; i < count; i++)
        n->unit = n->unit || t[i].unit;
    share_units(t, count, scale);
    return settle(t, joints, count, unit, n);
}

/* Does another number of this kind stand in the rest of a text? One in brackets may be the same in another unit. */
static bool has_another(const char *rest, lamp_unit unit, char decimal, const lamp_number *n) {
    char before = ' ';
    bool brackets = false;
    for (const char *p = rest; *p; before = *p++) {
        brackets = *p == '(' ? true : *p == ')' ? false : brackets;
        if (!is_digit(*p) || isalnum((unsigned char)before)) /* T8 */
            continue;
        term t;
        bool read = read_term(p, unit, decimal, &t);
        double value = read ? t.value * (t.unit ? t.factor : 1) : NAN;
        bool year = (brackets || n->unit) && !t.unit && value == floor(value) && value >= 1950 && value <= 2050;
        bool same = brackets && t.unit && fabs(value - n->value) <= .05 * n->value;
        bool code = unit == LAMP_WATTS && !t.unit && lamp_colour_code(value) > 0;
        bool share = !read && p[strspn(p, "0123456789., ")] == '%'; /* "70W 50%" */
        if (share || (read && !year && !same && !code))
            return true;
        p += strspn(p, "0123456789.,") - 1;
    }
    return false;
}

bool lamp_read_quantity(const char *text, lamp_unit unit, double scale, char decimal, lamp_number *n) {
    char folded[128];
    if (lamp_blank(text) || !lamp_scan_quantity(skip_blanks(text), unit, scale, decimal, n))
        return false;
    const char *rest = skip_blanks(n->end);
    if (!*rest)
        return true;
    if (((*rest == '.' || *rest == ',') && is_digit(rest[1])) || (isalpha((unsigned char)*rest) && !n->unit))
        return false;
    lamp_fold(rest, true, folded, sizeof(folded));
    lamp_text words = lamp_text_of(folded);
    if (lamp_has_word(&words, "equiv*") || lamp_has_word(&words, "aquiv*") || lamp_has_word(&words, "aequiv*"))
        return false;
    if (n->choice == LAMP_ONE && has_another(rest, unit, decimal, n))
        n->choice = LAMP_FIRST;
    return true;
}

bool lamp_quantity(const char *text, lamp_unit unit, double scale, char decimal, double *value, int *times) {
    lamp_number n = { .times = 1 };
    bool read = lamp_read_quantity(text, unit, scale, decimal, &n);
    *value = read ? n.value : 0;
    *times = n.times;
    return read;
}

double lamp_colour_code(double value) {
    double code = fmod(value, 100);
    bool is =
        value >= 600 && value < 1000 &&
        (code == 22 || code == 27 || code == 30 || code == 35 || code == 40 || code == 50 || code == 57 || code == 65);
    return is ? code * 100 : 0;
}
