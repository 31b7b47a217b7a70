#include "import/lamps/conditions.h"

#include <ctype.h>
#include <math.h>
#include <nocturne/text.h>

#define MOST_TEXT 400 /* bytes of a test */
#define MOST_RULES 10000

/* ---- tests ---- */

typedef struct test {
    enum { TEST_ABSENT, TEST_PATTERN, TEST_NUMBER } kind;
    bool none;                /* of patterns: what matches none of them */
    const char *pattern;      /* "a*|b" */
    char low[40], high[40];   /* numbers with their units; "" : no bound */
    lamp_unit unit;           /* that the bounds name; LAMP_PLAIN: none */
    bool low_open, high_open; /* the bound itself is outside */
} test;

static const char *after_blanks(const char *s) { return s + strspn(s, " \t"); }

/* The end of the set that begins behind a '[', NULL if it has none. */
static const char *set_end(const char *p, const char *end) {
    p += p < end && (*p == '!' || *p == '^');
    for (const char *q = p; q < end; q++)
        if (*q == ']' && q > p)
            return q;
    return NULL;
}

static bool in_set(const char *p, const char *end, unsigned char c) {
    bool not = *p == '!' || *p == '^', in = false;
    for (p += not ; p < end; p++) {
        bool range = p + 2 < end && p[1] == '-';
        unsigned char lo = (unsigned char)tolower((unsigned char)*p),
                      hi = range ? (unsigned char)tolower((unsigned char)p[2]) : lo;
        in = in || (c >= lo && c <= hi);
        p += range ? 2 : 0;
    }
    return in != not ;
}

/* One pattern, [p, end), against all of text; a star that fails takes a byte more, and only the last star may. */
static bool matches_one(const char *p, const char *end, const char *s) {
    const char *star = NULL, *from = NULL;
    while (*s) {
        unsigned char c = (unsigned char)tolower((unsigned char)*s);
        if (p < end && *p == '*') {
            star = ++p;
            from = s;
            continue;
        }
        const char *set = p < end && *p == '[' ? set_end(p + 1, end) : NULL;
        if (set ? in_set(p + 1, set, c) : p < end && (*p == '?' || tolower((unsigned char)*p) == c)) {
            p = set ? set + 1 : p + 1;
            s++;
            continue;
        }
        if (!star)
            return false;
        p = star;
        s = ++from;
    }
    while (p < end && *p == '*')
        p++;
    return p == end;
}

static bool matches(const test *t, const char *text) {
    bool any = false;
    for (const char *p = t->pattern; !any; p++) {
        size_t n = strcspn(p, "|");
        any = matches_one(p, p + n, text);
        p += n;
        if (!*p)
            break;
    }
    return any != t->none;
}

/* In which unit text is a number; -1: it is none. */
static int unit_named(const char *text) {
    double value;
    int times;
    if (lamp_quantity(text, LAMP_PLAIN, 1, '.', &value, &times))
        return LAMP_PLAIN;
    for (int unit = LAMP_METRES; unit < LAMP_PLAIN; unit++)
        if (lamp_quantity(text, (lamp_unit)unit, 1, '.', &value, &times))
            return unit;
    return -1;
}

static bool within(const test *t, const char *text, lamp_unit unit, double scale, char decimal) {
    double value, bound;
    int times;
    unit = unit == LAMP_PLAIN ? t->unit : unit;
    if (unit == LAMP_PLAIN && unit_named(text) >= 0) /* a unit that only the value names */
        unit = (lamp_unit)unit_named(text);
    if (!lamp_quantity(text, unit, scale, decimal, &value, &times))
        return false;
    bool in = true;
    if (*t->low)
        in = lamp_quantity(t->low, unit, scale, '.', &bound, &times) && (t->low_open ? value > bound : value >= bound);
    if (*t->high && in)
        in =
            lamp_quantity(t->high, unit, scale, '.', &bound, &times) && (t->high_open ? value < bound : value <= bound);
    return in;
}

/* text NULL: there is no value. */
static bool passes(const test *t, const char *text, lamp_unit unit, double scale, char decimal) {
    bool absent = lamp_blank(text);
    if (absent || t->kind == TEST_ABSENT)
        return absent && t->kind == TEST_ABSENT;
    return t->kind == TEST_PATTERN ? matches(t, text) : within(t, text, unit, scale, decimal);
}

/* A number of a test, of so many bytes, as one bound of it. What is wrong with it; NULL: nothing. */
static const char *take_bound(test *t, const char *from, size_t n, char to[40]) {
    while (n && (from[n - 1] == ' ' || from[n - 1] == '\t'))
        n--;
    noc_snprintf(to, 40, "%.*s", (int)NOC_MIN(n, 39u), from);
    int unit = n < 40 ? unit_named(to) : -1;
    if (unit < 0)
        return "is no number, with a unit or without";
    t->unit = unit == LAMP_PLAIN ? t->unit : (lamp_unit)unit;
    return NULL;
}

/* "16..20 ft": the first number is in feet, too. */
static void share_unit(const char *from, char to[40]) {
    const char *unit = from + strspn(from, "0123456789., ");
    size_t n = strlen(to);
    if (unit_named(to) == LAMP_PLAIN && *unit)
        noc_snprintf(to + n, 40 - n, " %s", unit);
}

static const char *read_number(const char *text, test *t) {
    const char *dots = strstr(text, "..");
    t->kind = TEST_NUMBER;
    t->unit = LAMP_PLAIN;
    if (dots) {
        const char *wrong = take_bound(t, text, (size_t)(dots - text), t->low), *to = after_blanks(dots + 2);
        wrong = wrong ? wrong : take_bound(t, to, strlen(to), t->high);
        if (!wrong)
            share_unit(t->high, t->low);
        return wrong;
    }
    bool equal = text[1] == '=', low = *text != '<', high = *text != '>';
    const char *number = after_blanks(text + 1 + (equal && *text != '='));
    const char *wrong = take_bound(t, number, strlen(number), low ? t->low : t->high);
    if (low && high)
        memcpy(t->high, t->low, sizeof(t->high));
    t->low_open = low && !high && !equal;
    t->high_open = high && !low && !equal;
    return wrong;
}

/* What is wrong with it; NULL: nothing. */
static const char *read_test(const char *text, test *t) {
    *t = (test){ .kind = TEST_PATTERN };
    if (!text || !*(text = after_blanks(text)))
        return "is empty; \"absent\" is what has no value";
    if (strlen(text) > MOST_TEXT)
        return "is too long";
    const char *dots = strstr(text, "..");
    if (noc_ieq(text, "absent")) {
        t->kind = TEST_ABSENT;
        return NULL;
    }
    if (strchr("<>=", *text) || (dots && dots > text && isdigit((unsigned char)*text)))
        return read_number(text, t);
    t->none = *text == '!';
    t->pattern = after_blanks(text + t->none);
    for (const char *p = t->pattern;; p++) {
        size_t n = strcspn(p, "|");
        if (!n)
            return "has a pattern of no characters";
        for (const char *q = p; q < p + n; q++) {
            const char *end = *q == '[' ? set_end(q + 1, p + n) : q;
            if (!end)
                return "has a [ without its ]";
            q = end;
        }
        p += n;
        if (!*p)
            return NULL;
    }
}

/* ---- keys ---- */

typedef enum subject {
    OF_TAG,
    OF_STREET, /* by tags, else by where it stands */
    OF_ROAD,   /* by where it stands alone */
    OF_FILE,
    OF_CLASS,
    OF_INFERRED,
    OF_ID,
    OF_SOURCE,
    OF_MOUNT,
    OF_HEIGHT, /* numbers from here on */
    OF_WATTS,
    OF_LUMENS,
    OF_KELVIN,
    OF_HEADS
} subject;

static const struct {
    const char *name;
    subject of;
    lamp_unit unit;
} subjects[] = {
    { "street", OF_STREET, LAMP_PLAIN }, { "road", OF_ROAD, LAMP_PLAIN },         { "file", OF_FILE, LAMP_PLAIN },
    { "class", OF_CLASS, LAMP_PLAIN },   { "inferred", OF_INFERRED, LAMP_PLAIN }, { "id", OF_ID, LAMP_PLAIN },
    { "source", OF_SOURCE, LAMP_PLAIN }, { "mount", OF_MOUNT, LAMP_PLAIN },       { "height", OF_HEIGHT, LAMP_METRES },
    { "watts", OF_WATTS, LAMP_WATTS },   { "lumens", OF_LUMENS, LAMP_LUMENS },    { "kelvin", OF_KELVIN, LAMP_KELVIN },
    { "heads", OF_HEADS, LAMP_PLAIN },
};

/* Tags and columns that name the street, folded: OSM's, and those of inventories in the languages of columns.c. */
static const char *const street_keys[] = {
    "addrstreet", "street",     "streetname", "stname",    "onstreet",     "road",
    "roadname",   "strasse",    "strasze",    "strae",     "strassenname", "strassenbezeichnung",
    "straat",     "straatnaam", "rue",        "nomrue",    "nomvoie",      "voie",
    "via",        "nomevia",    "calle",      "nombrevia", "ulice",        "ulica",
    "gata",       "gate",       "katu",
};

static lamp_unit unit_of(subject of) {
    for (size_t i = 0; i < NOC_COUNT(subjects); i++)
        if (subjects[i].of == of)
            return subjects[i].unit;
    return LAMP_PLAIN;
}

static subject subject_of(const char *key, const char **tag) {
    *tag = key;
    for (size_t i = 0; i < NOC_COUNT(subjects); i++)
        if (!strcmp(key, subjects[i].name))
            return subjects[i].of;
    *tag += strncmp(key, "tag:", 4) ? 0 : 4;
    return OF_TAG;
}

static bool names_street(const char *key) {
    char folded[64];
    lamp_fold(key, false, folded, sizeof(folded));
    for (size_t i = 0; i < NOC_COUNT(street_keys); i++)
        if (!strcmp(folded, street_keys[i]))
            return true;
    return false;
}

/* ---- conditions ---- */

typedef struct condition {
    subject of;
    const char *tag; /* OF_TAG */
    test test;
    unsigned bit; /* of geo_lamp.holds: OF_TAG, OF_STREET */
} condition;

struct lamp_conditions {
    NOC_ARRAY(condition) all;
    NOC_ARRAY(size_t) ends; /* of each rule's, then of each group's, in `all` */
    size_t rules;
    unsigned bits;
    bool street; /* any of them asks for it */
    bool roads;  /* or for roads beside a lamp */
};

static const char *read_condition(const noc_condition *from, condition *to) {
    *to = (condition){ 0 };
    if (!from->key || !*from->key)
        return "has no key";
    to->of = subject_of(from->key, &to->tag);
    const char *wrong = *to->tag ? read_test(from->test, &to->test) : "has no key";
    if (!wrong && to->test.kind == TEST_NUMBER && to->of != OF_TAG && to->of < OF_HEIGHT && to->of != OF_ID)
        wrong = "is asked for a number, and has none";
    return wrong;
}

static noc_status say_wrong(const noc_condition *c, const char *place, const char *wrong, noc_log *log) {
    char key[64], shown[100];
    noc_text_clean(key, sizeof(key), c->key ? c->key : "");
    noc_text_clean(shown, sizeof(shown), c->test ? c->test : "");
    return noc_error(log, NOC_ERR_ARGUMENT, "%s%smatch %s: \"%s\" %s", place, *place ? ": " : "", key, shown, wrong);
}

noc_status noc_condition_check(const noc_condition *c, noc_log *log) {
    condition made;
    if (!c)
        return noc_null(log, __func__);
    const char *wrong = read_condition(c, &made);
    return wrong ? say_wrong(c, "", wrong, log) : NOC_OK;
}

const char *lamp_rule_place(const char *place, const char *what, size_t index, char text[40]) {
    if (place)
        return place;
    noc_snprintf(text, 40, "%s %zu", what, index + 1);
    return text;
}

static noc_status add(lamp_conditions *c, const noc_condition *from, size_t count, const char *place, noc_log *log) {
    for (size_t i = 0; i < count; i++) {
        condition made;
        if (!from)
            return noc_null(log, "noc_scene_load");
        const char *wrong = read_condition(&from[i], &made);
        if (wrong)
            return say_wrong(&from[i], place, wrong, log);
        bool bit = made.of == OF_TAG || made.of == OF_STREET;
        if (bit && c->bits == GEO_CONDITIONS)
            return noc_error(log, NOC_ERR_UNSUPPORTED, "%s: more than %d conditions on tags in all", place,
                             GEO_CONDITIONS);
        made.bit = bit ? c->bits++ : 0;
        c->street = c->street || made.of == OF_STREET;
        c->roads = c->roads || made.of == OF_STREET || made.of == OF_ROAD;
        if (!array_push(&c->all, made))
            return noc_no_memory(log, place);
    }
    return array_push(&c->ends, c->all.len) ? NOC_OK : noc_no_memory(log, place);
}

lamp_conditions *lamp_conditions_create(const noc_import_params *params, noc_log *log, noc_status *status) {
    *status = NOC_OK;
    if (!params || !(params->luminaire_count || params->group_count))
        return NULL;
    lamp_conditions *c = noc_calloc(1, sizeof(*c));
    char text[40];
    if (!c)
        *status = noc_no_memory(log, "rules");
    else if (params->luminaire_count > MOST_RULES || params->group_count > MOST_RULES)
        *status = noc_error(log, NOC_ERR_UNSUPPORTED, "more than %d rules or groups", MOST_RULES);
    for (size_t i = 0; i < params->luminaire_count && !*status; i++) {
        const noc_luminaire_rule *r = &params->luminaires[i];
        *status = add(c, r->conditions, r->condition_count, lamp_rule_place(r->place, "rule", i, text), log);
    }
    if (c)
        c->rules = params->luminaire_count;
    for (size_t i = 0; i < params->group_count && !*status; i++) {
        const noc_group_rule *g = &params->groups[i];
        *status = add(c, g->conditions, g->condition_count, lamp_rule_place(g->place, "group", i, text), log);
    }
    if (!*status)
        return c;
    lamp_conditions_destroy(c);
    return NULL;
}

void lamp_conditions_destroy(lamp_conditions *c) {
    if (!c)
        return;
    array_free(&c->all);
    array_free(&c->ends);
    free(c);
}

bool lamp_conditions_ask_roads(const lamp_conditions *c) { return c && c->roads; }

/* ---- of tags ---- */

static void set_bit(uint64_t *bits, unsigned bit, bool on) {
    bits[bit / 64] = (bits[bit / 64] & ~(1ull << bit % 64)) | (uint64_t)on << bit % 64;
}
static bool bit_of(const uint64_t *bits, unsigned bit) { return bits[bit / 64] >> bit % 64 & 1; }

bool lamp_conditions_of_key(const lamp_conditions *c, const char *key, uint64_t asked[GEO_CONDITIONS / 64]) {
    memset(asked, 0, GEO_CONDITIONS / 8);
    bool street = c && c->street && names_street(key), any = false;
    for (size_t i = 0; c && i < c->all.len; i++) {
        const condition *k = &c->all.data[i];
        if (!(k->of == OF_STREET ? street : k->of == OF_TAG && lamp_same_key(k->tag, key)))
            continue;
        set_bit(asked, k->bit, true);
        any = true;
    }
    return any;
}

void lamp_conditions_none(const lamp_conditions *c, geo_lamp *lamp) {
    memset(lamp->holds, 0, sizeof(lamp->holds));
    lamp->tells_street = false;
    for (size_t i = 0; c && i < c->all.len; i++)
        if (c->all.data[i].of <= OF_STREET && c->all.data[i].test.kind == TEST_ABSENT)
            set_bit(lamp->holds, c->all.data[i].bit, true);
}

void lamp_conditions_tag(const lamp_conditions *c, const uint64_t asked[GEO_CONDITIONS / 64], const lamp_tag *tag,
                         const lamp_meaning *meaning, char decimal, geo_lamp *lamp) {
    if (lamp_blank(tag->value))
        return;
    lamp_unit unit = lamp_field_unit(meaning->field);
    for (size_t i = 0; i < c->all.len; i++) {
        const condition *k = &c->all.data[i];
        if (k->of > OF_STREET || !bit_of(asked, k->bit))
            continue;
        /* of two columns by one name, the first that matches counts; a value is there once one is */
        bool holds = passes(&k->test, tag->value, unit, meaning->scale, decimal);
        set_bit(lamp->holds, k->bit, k->test.kind == TEST_ABSENT ? false : bit_of(lamp->holds, k->bit) || holds);
        lamp->tells_street = lamp->tells_street || k->of == OF_STREET;
    }
}

/* ---- of what is known later ---- */

static const char *source_text(const geo_lamp *lamp) {
    return lamp->source == GEO_SOURCE_UNKNOWN ? NULL : noc_lamp_source_name((noc_lamp_source)lamp->source);
}

static const char *mount_text(const geo_lamp *lamp) {
    static const char *const names[] = { NULL, "pole", "wall", "suspended" };
    return names[lamp->mount];
}

static bool number_holds(const condition *k, double value) {
    char text[40];
    noc_snprintf(text, sizeof(text), "%.9g", value);
    return passes(&k->test, isfinite(value) && value > 0 ? text : NULL, unit_of(k->of), 1, '.');
}

static bool text_holds(const condition *k, const char *text) { return passes(&k->test, text, LAMP_PLAIN, 1, '.'); }

static bool file_holds(const condition *k, const char *file) {
    const char *name = file ? strrchr(file, '/') : NULL;
    return text_holds(k, file) || (name && text_holds(k, name + 1));
}

static bool lamp_holds(const condition *k, const lamp_subject *of) {
    const geo_lamp *lamp = of->lamp;
    switch (k->of) {
    case OF_STREET:
        if (!lamp->tells_street)
            return text_holds(k, of->street);
        return bit_of(lamp->holds, k->bit);
    case OF_ROAD: return text_holds(k, of->road);
    case OF_TAG: return bit_of(lamp->holds, k->bit);
    case OF_ID: return text_holds(k, lamp->id);
    case OF_SOURCE: return text_holds(k, source_text(lamp));
    case OF_MOUNT: return text_holds(k, mount_text(lamp));
    case OF_HEIGHT: return number_holds(k, lamp->height);
    case OF_WATTS: return number_holds(k, lamp->watts);
    case OF_LUMENS: return number_holds(k, lamp->lumens);
    case OF_KELVIN: return number_holds(k, lamp->kelvin);
    case OF_HEADS: return number_holds(k, NOC_MAX(lamp->count, 1));
    default: return false;
    }
}

static bool holds(const condition *k, const lamp_subject *of) {
    switch (k->of) {
    case OF_FILE: return file_holds(k, of->file);
    case OF_CLASS: return text_holds(k, of->cls);
    case OF_INFERRED: return text_holds(k, of->inferred ? "yes" : "no");
    default: return of->lamp ? lamp_holds(k, of) : k->test.kind == TEST_ABSENT;
    }
}

static bool all_hold(const lamp_conditions *c, size_t index, const lamp_subject *of) {
    bool hold = true;
    for (size_t i = index ? c->ends.data[index - 1] : 0; i < c->ends.data[index] && hold; i++)
        hold = holds(&c->all.data[i], of);
    return hold;
}

size_t lamp_rule_means_road(const lamp_conditions *c, size_t rule, const char *highway, bool tag) {
    size_t first = rule ? c->ends.data[rule - 1] : 0;
    for (size_t i = first; i < c->ends.data[rule]; i++) {
        const condition *k = &c->all.data[i];
        bool asks = tag ? k->of == OF_TAG && (lamp_same_key(k->tag, "highway") || lamp_same_key(k->tag, "fclass"))
                        : k->of == OF_ROAD;
        if (asks && text_holds(k, highway))
            return i - first + 1;
    }
    return 0;
}

bool lamp_rule_holds(const lamp_conditions *c, size_t rule, const lamp_subject *of) { return all_hold(c, rule, of); }
bool lamp_group_holds(const lamp_conditions *c, size_t group, const lamp_subject *of) {
    return all_hold(c, c->rules + group, of);
}
