/* From tags or a table's row to a geo_lamp. */
#include "import/lamps/tags.h"

#include <math.h>

#define LETTERS "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"

typedef struct said {
    lamp_meaning meaning;
    const lamp_tag *tag;
    const char *value;
} said;

typedef struct reading {
    geo_lamp *lamp;
    lamp_keys *keys; /* NULL: none */
    geo_issues *issues;
    bool type_known;
    int times;    /* the factor of "2x70 W" */
    int terms;    /* of the sum that the watts are */
    double scale; /* of the value that is read, where it names no unit */
    char decimal; /* the file's decimal sign */
} reading;

static bool misread(const reading *r, const char *reason) {
    if (r->issues)
        geo_issue(r->issues, GEO_GUESSED, reason, r->lamp->id);
    return false;
}

/* The same of a text, whose values are counted. column: which may turn out to have ids; NULL: any. */
static bool unread_in(const reading *r, const char *reason, const char *text, const lamp_tag *column) {
    lamp_keys_unread(r->keys, reason, text, column, r->lamp->id, r->issues);
    return false;
}

static bool unread(const reading *r, const char *reason, const char *text) { return unread_in(r, reason, text, NULL); }

/* What is counted of a quantity: it is not understood, it is 0, and one of its numbers was taken (lamp_choice). */
typedef struct reasons {
    const char *wrong, *zero, *choice[LAMP_HEADS_EACH + 1];
} reasons;
#define REASONS(what)                                                                                                  \
    {                                                                                                                  \
        what " not understood or implausible", what " of 0, taken as not told", {                                      \
            NULL, what " of several numbers, the first taken", what " that is a range, its middle taken",              \
                what " of two numbers, taken as lamps of so much each"                                                 \
        }                                                                                                              \
    }
static const reasons height_reasons = REASONS("height of a lamp");
static const reasons lumens_reasons = REASONS("luminous flux");
static const reasons watts_reasons = REASONS("wattage");
static const reasons kelvin_reasons = REASONS("colour temperature");

/* A guess that is made of a text of several numbers is counted. */
static void doubt(const reading *r, const reasons *of, lamp_choice choice, const char *text) {
    if (choice)
        unread(r, of->choice[choice], text);
}

static const char dimming_reason[] = "dimming or share of a lamp not taken: it is at its full flux";

/* A quantity in its plausible range; 0 stands for "not known" in many tables, and is counted. True if *out was set. */
static bool read_quantity(reading *r, const char *text, lamp_unit unit, double lo, double hi, const reasons *of,
                          double *out) {
    lamp_number n;
    if (!lamp_read_quantity(text, unit, r->scale, r->decimal, &n))
        return unread(r, of->wrong, text);
    if (n.value == 0)
        return misread(r, of->zero);
    if (n.value < lo || n.value > hi)
        return misread(r, of->wrong);
    const char *point = strchr(text, '.');
    if (unit == LAMP_LUMENS && n.value < 100 && !r->decimal && point && strspn(point + 1, "0123456789") == 3)
        misread(r, "luminous flux below 100 lm with three decimals: is the point one of thousands?");
    doubt(r, of, n.choice, text);
    if (n.times > 1)
        r->times = n.times;
    if (unit == LAMP_WATTS)
        r->terms = n.terms;
    *out = n.value;
    return true;
}

/* Of a number without a unit, who loads it asks which one it may be. */
static bool read_height(reading *r, const lamp_meaning *c, const char *text) {
    lamp_number n;
    bool unit = c->unit_named || *(text + strcspn(text, LETTERS));
    if (!unit && lamp_read_quantity(text, LAMP_METRES, 1, r->decimal, &n) && !n.unit)
        r->lamp->bare_height = n.value;
    return read_quantity(r, text, LAMP_METRES, .5, LAMP_MOST_METRES, &height_reasons, &r->lamp->height);
}

/* "1-2" and "1 or 2" tell no number. */
static bool read_count(reading *r, const char *text) {
    lamp_number n;
    bool read = lamp_read_quantity(text, LAMP_PLAIN, 1, r->decimal, &n) && !n.choice;
    double count = read ? n.value * n.times : -1;
    if (count == 0)
        return misread(r, "number of lamps on a pole of 0, taken as not told");
    if (!(count >= 1 && count <= GEO_MAX_HEADS) || count != floor(count))
        return unread(r, "number of lamps on a pole not understood", text);
    r->lamp->count = (int)count;
    return true;
}

/* Kelvin; also the lamp trade's colour codes: 830 is a colour rendering over 80 and 3000 K. */
static bool read_kelvin(reading *r, const char *text) {
    lamp_number n;
    if (!lamp_read_quantity(text, LAMP_KELVIN, r->scale, r->decimal, &n))
        return false;
    double value = n.value, code = fmod(value, 100);
    if (value >= 600 && value < 1000 && code >= 18 && code <= 65)
        value = code * 100;
    if (!(value >= 1000 && value <= 20000))
        return false;
    doubt(r, &kelvin_reasons, n.choice, text);
    r->lamp->kelvin = value;
    return true;
}

static bool read_temperature(reading *r, const char *text) {
    lamp_number n;
    if (read_kelvin(r, text))
        return true;
    bool zero = lamp_read_quantity(text, LAMP_KELVIN, r->scale, r->decimal, &n) && n.value == 0;
    return zero ? misread(r, kelvin_reasons.zero) : unread(r, kelvin_reasons.wrong, text);
}

static bool read_colour(reading *r, const char *text, bool of_the_light) {
    char folded[128];
    float rgb[3];
    double kelvin = 0;
    if (read_kelvin(r, text) || !of_the_light)
        return r->lamp->kelvin > 0;
    lamp_fold(text, true, folded, sizeof(folded));
    if (!lamp_hex_colour(text, rgb) && !lamp_colour_word(folded, &kelvin, rgb))
        return unread(r, "colour of a lamp not understood", text);
    if (kelvin > 0)
        r->lamp->kelvin = kelvin;
    else if (rgb[0] + rgb[1] + rgb[2] > 0)
        memcpy(r->lamp->rgb, rgb, sizeof(rgb));
    return true;
}

/* A description may name the source, the fixture or both ("Standard LED", "gaslight"): done when both are known. */
static bool read_type(reading *r, const char *text, bool of_the_lamp) {
    char folded[256], present[LAMP_PRESENT];
    lamp_fold(lamp_present(text, present) ? present : text, true, folded, sizeof(folded));
    int source = lamp_source_word(folded), type = lamp_type_word(folded);
    if (source >= 0 && r->lamp->source == GEO_SOURCE_UNKNOWN)
        r->lamp->source = source;
    if (type >= 0 && !r->type_known && of_the_lamp) {
        r->lamp->type = type;
        r->type_known = true;
    }
    return r->lamp->source != GEO_SOURCE_UNKNOWN && r->type_known;
}

/* A list ("45;225") has as many heads, each with its own. */
static bool read_directions(reading *r, const char *text) {
    geo_lamp *lamp = r->lamp;
    int count = lamp_directions(text, r->decimal, lamp->heading);
    lamp->heading_count = count > 1 ? count : 0;
    if (count < 2)
        return lamp_direction(text, &lamp->direction) || unread(r, "direction of a lamp not understood", text);
    lamp->direction = (double)lamp->heading[0];
    return true;
}

/* "LED, 38 WATT" says more than watts, and read_models reads it. */
static bool read_watts(reading *r, const char *text) {
    lamp_number n;
    char present[LAMP_PRESENT];
    bool words = *(text + strcspn(text, LETTERS)) || strchr(text, '>');
    lamp_model m = { .watts = NAN };
    if ((words && lamp_present(text, present)) || !lamp_read_quantity(text, LAMP_WATTS, r->scale, r->decimal, &n))
        m = lamp_keys_model(r->keys, text, true);
    if (!isfinite(m.watts) && words && lamp_present(text, present))
        return unread(r, watts_reasons.wrong, text);
    return !isfinite(m.watts) &&
           read_quantity(r, text, LAMP_WATTS, .5, LAMP_MOST_WATTS, &watts_reasons, &r->lamp->watts);
}

/* What a description adds to what is known. Watts of a column may be those of all of its heads. */
static void take_model(reading *r, const char *text, const lamp_model *m) {
    geo_lamp *lamp = r->lamp;
    bool watts = isfinite(lamp->watts), same = isfinite(m->watts) && fabs(lamp->watts - m->watts) <= .1 * m->watts;
    if (lamp->source == GEO_SOURCE_UNKNOWN)
        lamp->source = m->source;
    if (m->heads > 1 && r->times <= 1 && (!watts || !isfinite(m->watts) || same))
        r->times = m->heads;
    if (!watts && isfinite(m->watts)) {
        doubt(r, &watts_reasons, m->choice, text);
        if (m->bare)
            unread(r, "number beside LED without a unit, taken as watts", text);
        r->terms = m->terms;
        lamp->watts = m->watts;
    }
    if (!isfinite(lamp->lumens) && isfinite(m->lumens)) {
        doubt(r, &lumens_reasons, m->lumens_choice, text);
        lamp->lumens = m->lumens;
    }
    if (!isfinite(lamp->kelvin) && isfinite(m->kelvin)) {
        doubt(r, &kelvin_reasons, m->kelvin_choice, text);
        lamp->kelvin = m->kelvin;
    }
}

/* What a description says of the flux and is not taken. share: a number of % in it is no watts' that is counted. */
static void doubt_flux(const reading *r, const char *text, const lamp_model *m, bool share) {
    const geo_lamp *lamp = r->lamp;
    if (m->dimmed || (m->share && share))
        unread(r, dimming_reason, text);
    if (m->diodes && !isfinite(lamp->watts) && !isfinite(lamp->lumens))
        unread(r, "LEDs by their number or current, without watts: flux not understood", text);
}

static bool lacks(const geo_lamp *lamp) { return lamp->source == GEO_SOURCE_UNKNOWN || !isfinite(lamp->watts); }

/* Is a text of a column of sources and fixtures one that says something? */
static bool says_something(const char *text, const lamp_model *m) {
    static const char *const plain[] = {
        "electric", "street lamp", "street light", "streetlight", "standard", "other"
    };
    char folded[128];
    lamp_fold(text, true, folded, sizeof(folded));
    lamp_text t = lamp_text_of(folded);
    bool does = m->source != GEO_SOURCE_UNKNOWN || isfinite(m->watts) || m->heads || lamp_type_word(folded) >= 0 ||
                lamp_mount_word(folded) >= 0;
    for (size_t i = 0; i < NOC_COUNT(plain); i++)
        does = does || lamp_has_word(&t, plain[i]);
    return does;
}

/* Is its source one that is not understood, and what is taken of it not enough to tell the flux? */
static bool is_strange(const reading *r, const said *s, const lamp_model *m) {
    bool type = s->meaning.field == LAMP_FIELD_TYPE;
    if (m->unclear || (m->strange && isfinite(m->watts) && !isfinite(r->lamp->lumens)))
        return true;
    return type && s->meaning.rank < 4 && !says_something(s->value, m);
}

/* Descriptions in columns that say nothing of lamps, where one stands alone. */
static void read_free_text(reading *r, const lamp_tag *tags, size_t count) {
    for (size_t i = 0; i < count && lacks(r->lamp); i++) {
        const char *text = tags[i].value;
        if (!text || !*(text + strcspn(text, LETTERS)) || !lamp_tag_meaning(r->keys, &tags[i]).free_text)
            continue;
        const lamp_model model = lamp_keys_model(r->keys, text, false);
        if (!lamp_model_stands_alone(&model))
            continue;
        bool doubtful = (model.strange || model.unclear) && r->lamp->source == GEO_SOURCE_UNKNOWN &&
                        !isfinite(r->lamp->watts) && !isfinite(r->lamp->lumens);
        take_model(r, text, &model);
        doubt_flux(r, text, &model, true);
        if (doubtful)
            unread(r, "source of a lamp not understood", text);
        lamp_keys_described(r->keys, &tags[i]);
    }
}

/* Descriptions: in columns of lamps first, by rank, then wherever one stands alone. */
static void read_models(reading *r, const said *all, size_t count, int ranks, const lamp_tag *tags, size_t tag_count) {
    const said *strange = NULL;
    for (int rank = -1; rank < ranks; rank++)
        for (size_t i = 0; i < count; i++) {
            const lamp_meaning *m = &all[i].meaning;
            bool watts = m->field == LAMP_FIELD_WATTS;
            if (m->rank != rank || (!watts && m->field != LAMP_FIELD_TYPE))
                continue;
            const lamp_model model = lamp_keys_model(r->keys, all[i].value, watts && rank < 2);
            take_model(r, all[i].value, &model);
            doubt_flux(r, all[i].value, &model, !watts);
            if (!watts && (model.unclear || says_something(all[i].value, &model)))
                lamp_keys_understood(r->keys, all[i].tag);
            if (!strange && is_strange(r, &all[i], &model))
                strange = &all[i];
        }
    read_free_text(r, tags, tag_count);
    if (strange && r->lamp->source == GEO_SOURCE_UNKNOWN)
        unread_in(r, "source of a lamp not understood", strange->value,
                  strange->meaning.field == LAMP_FIELD_TYPE ? strange->tag : NULL);
}

/* Of columns that say how far a lamp is dimmed: full light and "no" are none. */
static void read_dimming(const reading *r, const lamp_tag *tags, size_t count) {
    for (size_t i = 0; i < count; i++) {
        double number;
        if (!lamp_tag_meaning(r->keys, &tags[i]).dims || lamp_blank(tags[i].value) ||
            lamp_yes_or_no(tags[i].value) < 0 || (lamp_scan_number(tags[i].value, false, 0, &number) && number == 100))
            continue;
        unread(r, dimming_reason, tags[i].value);
        return;
    }
}

/* A status that says neither that the lamp is in use nor that it is not. */
static void read_status(const reading *r, const lamp_meaning *m, const char *text) {
    double number;
    if (m->role == LAMP_ROLE_GONE)
        return;
    if (lamp_status_of(m, text) == LAMP_STATUS_UNTOLD)
        unread(r, "status of a lamp not understood, taken as in use", text);
    else if (m->flags && m->rank >= 0 && noc_parse_double(text, &number))
        unread(r, "status of a lamp by 0 and 1, where 0 is taken as not in use", text);
}

/* A column of yes and no that says neither, nor anything of a lamp, is told of: there is taken to be one. */
static void read_doubts(const reading *r, const lamp_tag *tags, size_t count) {
    for (size_t i = 0; i < count; i++) {
        if (lamp_tag_meaning(r->keys, &tags[i]).asks < LAMP_ASKS || lamp_blank(tags[i].value) ||
            lamp_yes_or_no(tags[i].value))
            continue;
        const lamp_model model = lamp_keys_model(r->keys, tags[i].value, false);
        if (!says_something(tags[i].value, &model))
            unread(r, "neither yes nor no to whether there is a lamp", tags[i].value);
    }
}

static bool read_mount(reading *r, const char *text) {
    char folded[128];
    lamp_fold(text, true, folded, sizeof(folded));
    int mount = lamp_mount_word(folded);
    if (mount >= 0)
        r->lamp->mount = mount;
    return mount >= 0;
}

/* True: the field is known now, and columns of higher rank are not asked. */
static bool read_field(reading *r, const lamp_meaning *c, const char *text) {
    geo_lamp *lamp = r->lamp;
    double x;
    r->scale = c->scale;
    switch (c->field) {
    case LAMP_FIELD_HEIGHT: return read_height(r, c, text);
    case LAMP_FIELD_DIRECTION: return read_directions(r, text);
    case LAMP_FIELD_COUNT: return read_count(r, text);
    case LAMP_FIELD_LUMENS:
        return read_quantity(r, text, LAMP_LUMENS, 5, LAMP_MOST_LUMENS, &lumens_reasons, &lamp->lumens);
    case LAMP_FIELD_WATTS:
        if (c->rank == 2 && !(text[0] >= '0' && text[0] <= '9')) /* power=pole and the like */
            return false;
        return read_watts(r, text);
    case LAMP_FIELD_KELVIN: return read_temperature(r, text);
    case LAMP_FIELD_COLOUR: return read_colour(r, text, c->rank <= 0);
    case LAMP_FIELD_TYPE:
        return read_type(r, text, c->rank < 4); /* a bare "type" may be the pole's: of it only a source is believed */
    case LAMP_FIELD_MOUNT: return read_mount(r, text);
    case LAMP_FIELD_STATUS: read_status(r, c, text); return false; /* each of several is asked */
    case LAMP_FIELD_ID: lamp->id = text; return true;
    case LAMP_FIELD_ELEVATION:
        if (!lamp_coordinate(text, &x) || !(fabs(x * c->scale) < 9000))
            return true;
        if (!isfinite(lamp->xyz[2]) || c->rank < 0)
            lamp->xyz[2] = x * c->scale;
        lamp->metres = c->unit_named && lamp->xyz[2] == x * c->scale;
        return true;
    default: return false;
    }
}

bool lamp_read(lamp_keys *keys, const lamp_tag *tags, size_t count, geo_lamp *lamp, geo_issues *issues) {
    *lamp = (geo_lamp){ .xyz = { lamp->xyz[0], lamp->xyz[1], lamp->xyz[2] },
                        .height = NAN,
                        .direction = NAN,
                        .lumens = NAN,
                        .watts = NAN,
                        .kelvin = NAN,
                        .rgb = { -1, -1, -1 },
                        .id = lamp->id ? lamp->id : "",
                        .ref = "" };
    reading r = { .lamp = lamp,
                  .keys = keys,
                  .issues = issues,
                  .times = 1,
                  .terms = 1,
                  .scale = 1,
                  .decimal = lamp_keys_decimal(keys) };
    said few[32], *all = count > NOC_COUNT(few) ? noc_alloc(count * sizeof(*all)) : few;
    if (!all)
        return false;
    size_t n = 0;
    int ranks = 0;
    for (size_t i = 0; i < count; i++) {
        lamp_meaning m = lamp_tag_meaning(keys, &tags[i]);
        if (m.field == LAMP_FIELD_NONE || lamp_blank(tags[i].value))
            continue;
        all[n++] = (said){ m, &tags[i], tags[i].value };
        ranks = NOC_MAX(ranks, m.rank + 1);
    }
    bool known[LAMP_FIELD_TOTAL] = { false };
    /* the id first, for the issues that the other fields raise */
    for (int pass = 0; pass < 2; pass++)
        for (int rank = -1; rank < ranks; rank++)
            for (size_t i = 0; i < n; i++) {
                const lamp_meaning *m = &all[i].meaning;
                if (m->rank != rank || known[m->field] || (m->field == LAMP_FIELD_ID) != (pass == 0))
                    continue;
                known[m->field] = read_field(&r, m, all[i].value);
            }
    for (int rank = -1; rank < ranks && !*lamp->ref; rank++)
        for (size_t i = 0; i < n && !*lamp->ref; i++)
            if (all[i].meaning.field == LAMP_FIELD_ID && all[i].meaning.rank == rank &&
                strcmp(all[i].value, lamp->id) != 0)
                lamp->ref = all[i].value;
    read_models(&r, all, n, ranks, tags, count);
    read_doubts(&r, tags, count);
    read_dimming(&r, tags, count);
    if (all != few)
        free(all);
    lamp_keys_ask(keys, tags, count, lamp);
    if (r.terms > 1 && lamp->count == r.terms) /* "150 W & 70 W" of two lamps */
        lamp->watts /= r.terms;
    if (!lamp->count)
        lamp->count = lamp->heading_count ? lamp->heading_count : r.times > 1 ? r.times : 0;
    if (lamp->source == GEO_SOURCE_GAS && !r.type_known)
        lamp->type = GEO_LAMP_LANTERN;
    return true;
}
