/* From tags or a table's row to a geo_lamp. */
#include "import/lamps/tags.h"

#include <math.h>

#define LETTERS "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"

/* Tags that make a lamp, as OSM and its exports write them. */
static const struct {
    const char *key, *value;
} lamp_makers[] = {
    { "highway", "street_lamp" },    { "highway", "street_light" },    { "highway", "streetlamp" },
    { "man_made", "street_lamp" },   { "man_made", "streetlamp" },     { "man_made", "lamp" },
    { "man_made", "light_pole" },    { "man_made", "floodlight" },     { "amenity", "street_lamp" },
    { "light_source", "lantern" },   { "light_source", "floodlight" }, { "light_source", "street_lamp" },
    { "light_source", "spotlight" }, { "light_source", "bollard" },    { "light_source", "electric_lamp" },
    { "tower:type", "lighting" },    { "street_lamp", "yes" },
};

/* "a;b" holds b. */
static bool list_holds(const char *list, const char *item) {
    size_t n = strlen(item);
    for (const char *p = list; *p; p++) {
        while (*p == ' ')
            p++;
        size_t m = strcspn(p, ";");
        size_t len = m;
        while (len && p[len - 1] == ' ')
            len--;
        if (len == n && !memcmp(p, item, n))
            return true;
        p += m;
        if (!*p)
            break;
    }
    return false;
}

static bool makes_lamp(const char *key, const char *value) {
    for (size_t i = 0; i < NOC_COUNT(lamp_makers); i++)
        if (!strcmp(key, lamp_makers[i].key) && list_holds(value, lamp_makers[i].value))
            return true;
    return false;
}

bool lamp_key_tells(const char *key) {
    for (size_t i = 0; i < NOC_COUNT(lamp_makers); i++)
        if (!strcmp(key, lamp_makers[i].key))
            return true;
    return false;
}

bool lamp_columns_tell(lamp_keys *keys, const char *const *names, size_t count) {
    int strength[LAMP_FIELD_TOTAL] = { 0 }, sum = 0;
    for (size_t i = 0; i < count; i++) {
        lamp_meaning m = lamp_keys_meaning(keys, names[i]);
        strength[m.field] = NOC_MAX(strength[m.field], m.strength);
    }
    for (int f = LAMP_FIELD_NONE + 1; f < LAMP_FIELD_TOTAL; f++)
        sum += strength[f];
    return sum >= 2;
}

/* The part after a lifecycle prefix ("disused:highway" -> "highway"), NULL if there is none. */
static const char *after_lifecycle(const char *key) {
    static const char *const prefixes[] = { "disused:",    "abandoned:",    "removed:", "razed:",
                                            "demolished:", "destroyed:",    "was:",     "proposed:",
                                            "planned:",    "construction:", "historic:" };
    for (size_t i = 0; i < NOC_COUNT(prefixes); i++)
        if (!strncmp(key, prefixes[i], strlen(prefixes[i])))
            return key + strlen(prefixes[i]);
    return NULL;
}

static bool is_no(const char *value) { return noc_ieq(value, "no") || noc_ieq(value, "false") || !strcmp(value, "0"); }

static void makers_of(const char *key, lamp_meaning *m) {
    const char *rest = after_lifecycle(key);
    m->makes = lamp_key_tells(key);
    m->after = rest && lamp_key_tells(rest) ? (unsigned)(rest - key) : 0;
}

void lamp_roles_of(const char *key, lamp_meaning *m) {
    static const struct {
        const char *folded;
        lamp_role role;
    } roles[] = {
        { "disused", LAMP_ROLE_GONE },           { "abandoned", LAMP_ROLE_GONE },
        { "removed", LAMP_ROLE_GONE },           { "demolished", LAMP_ROLE_GONE },
        { "indoor", LAMP_ROLE_INDOORS },         { "tunnel", LAMP_ROLE_INDOORS },
        { "location", LAMP_ROLE_LOCATION },      { "whyinactive", LAMP_ROLE_WHY_NOT },
        { "inactivereason", LAMP_ROLE_WHY_NOT }, { "inoperation", LAMP_ROLE_WORKS },
        { "active", LAMP_ROLE_WORKS }, /* elsewhere a date since when it works */
    };
    char folded[128];
    makers_of(key, m);
    lamp_fold(key, false, folded, sizeof(folded));
    m->role = LAMP_ROLE_NONE;
    for (size_t i = 0; i < NOC_COUNT(roles); i++) {
        bool tag = roles[i].role <= LAMP_ROLE_LOCATION; /* of OpenStreetMap: as it is written */
        if (!strcmp(tag ? key : folded, roles[i].folded))
            m->role = roles[i].role;
    }
}

/* What a tag of a lamp says about whether it shines on a street. */
static lamp_verdict tag_verdict(const lamp_meaning *m, const char *v) {
    char folded[128];
    if (m->field == LAMP_FIELD_STATUS && m->role != LAMP_ROLE_GONE) {
        lamp_fold(v, true, folded, sizeof(folded));
        return lamp_inactive_word(folded) ? LAMP_INACTIVE : LAMP_ACTIVE;
    }
    switch (m->role) {
    case LAMP_ROLE_GONE: return is_no(v) ? LAMP_ACTIVE : LAMP_INACTIVE;
    case LAMP_ROLE_INDOORS: return is_no(v) ? LAMP_ACTIVE : LAMP_INDOORS;
    case LAMP_ROLE_LOCATION: return !strcmp(v, "underground") || !strcmp(v, "indoor") ? LAMP_INDOORS : LAMP_ACTIVE;
    case LAMP_ROLE_WHY_NOT: return lamp_blank(v) ? LAMP_ACTIVE : LAMP_INACTIVE;
    case LAMP_ROLE_WORKS: return is_no(v) ? LAMP_INACTIVE : LAMP_ACTIVE;
    case LAMP_ROLE_NONE: break;
    }
    return LAMP_ACTIVE;
}

lamp_verdict lamp_verdict_of(lamp_keys *keys, const lamp_tag *tags, size_t count, bool inventory) {
    lamp_verdict verdict = inventory ? LAMP_ACTIVE : LAMP_NONE;
    for (size_t i = 0; i < count && verdict != LAMP_ACTIVE; i++) {
        if (!tags[i].value || !*tags[i].value)
            continue;
        lamp_meaning m;
        if (tags[i].known && keys)
            m = lamp_tag_meaning(keys, &tags[i]);
        else
            makers_of(tags[i].key, &m);
        if (m.makes && makes_lamp(tags[i].key, tags[i].value))
            verdict = LAMP_ACTIVE;
        if (m.after && makes_lamp(tags[i].key + m.after, tags[i].value))
            verdict = LAMP_INACTIVE;
    }
    for (size_t i = 0; i < count && verdict == LAMP_ACTIVE; i++)
        if (tags[i].value && *tags[i].value) {
            lamp_meaning m = lamp_tag_meaning(keys, &tags[i]);
            verdict = tag_verdict(&m, tags[i].value);
        }
    return verdict;
}

bool lamp_accept(lamp_verdict verdict, const char *id, geo_issues *issues) {
    if (issues && verdict == LAMP_INACTIVE)
        geo_issue(issues, GEO_SPARED, "lamp not in use (removed, disused or planned)", id);
    if (issues && verdict == LAMP_INDOORS)
        geo_issue(issues, GEO_SPARED, "lamp indoors or underground", id);
    return verdict == LAMP_ACTIVE;
}

typedef struct reading {
    geo_lamp *lamp;
    geo_issues *issues;
    bool type_known;
    int times;    /* the factor of "2x70 W" */
    double scale; /* of the value that is read, where it names no unit */
    char decimal; /* the file's decimal sign */
} reading;

static bool misread(const reading *r, const char *reason) {
    if (r->issues)
        geo_issue(r->issues, GEO_GUESSED, reason, r->lamp->id);
    return false;
}

/* A quantity in its plausible range; 0 stands for "not known" in many tables. True if *out was set. */
static bool read_quantity(reading *r, const char *text, lamp_unit unit, double lo, double hi, const char *reason,
                          double *out) {
    double value;
    int times;
    if (!lamp_quantity(text, unit, r->scale, r->decimal, &value, &times))
        return misread(r, reason);
    if (value == 0)
        return false;
    if (value < lo || value > hi)
        return misread(r, reason);
    const char *point = strchr(text, '.');
    if (unit == LAMP_LUMENS && value < 100 && !r->decimal && point && strspn(point + 1, "0123456789") == 3)
        misread(r, "luminous flux below 100 lm with three decimals: is the point one of thousands?");
    if (times > 1)
        r->times = times;
    *out = value;
    return true;
}

/* Of a number without a unit, who loads it asks which one it may be. */
static bool read_height(reading *r, const lamp_meaning *c, const char *text) {
    double value;
    int times;
    bool unit = c->unit_named || strpbrk(text, "'\"") || *(text + strcspn(text, LETTERS));
    if (!unit && lamp_quantity(text, LAMP_METRES, 1, r->decimal, &value, &times))
        r->lamp->bare_height = value;
    return read_quantity(r, text, LAMP_METRES, .5, LAMP_MOST_METRES, "height of a lamp not understood or implausible",
                         &r->lamp->height);
}

static bool read_count(reading *r, const char *text) {
    double value;
    int times;
    if (!lamp_quantity(text, LAMP_PLAIN, 1, r->decimal, &value, &times) || value != floor(value) || value > 24)
        return misread(r, "number of lamps on a pole not understood");
    if (value < 1)
        return false;
    r->lamp->count = (int)value;
    return true;
}

/* Kelvin; also the lamp trade's colour codes: 830 is a colour rendering over 80 and 3000 K. */
static bool read_kelvin(reading *r, const char *text) {
    double value;
    int times;
    if (!lamp_quantity(text, LAMP_KELVIN, r->scale, r->decimal, &value, &times))
        return false;
    double code = fmod(value, 100);
    if (value >= 600 && value < 1000 && code >= 18 && code <= 65)
        value = code * 100;
    if (!(value >= 1000 && value <= 20000))
        return false;
    r->lamp->kelvin = value;
    return true;
}

static bool read_colour(reading *r, const char *text, bool of_the_light) {
    char folded[128];
    float rgb[3];
    double kelvin = 0;
    if (read_kelvin(r, text) || !of_the_light)
        return r->lamp->kelvin > 0;
    lamp_fold(text, true, folded, sizeof(folded));
    if (!lamp_hex_colour(text, rgb) && !lamp_colour_word(folded, &kelvin, rgb))
        return misread(r, "colour of a lamp not understood");
    if (kelvin > 0)
        r->lamp->kelvin = kelvin;
    else if (rgb[0] + rgb[1] + rgb[2] > 0)
        memcpy(r->lamp->rgb, rgb, sizeof(rgb));
    return true;
}

/* A description may name the source, the fixture or both ("Standard LED", "gaslight"): done when both are known. */
static bool read_type(reading *r, const char *text, bool of_the_lamp) {
    char folded[256];
    lamp_fold(text, true, folded, sizeof(folded));
    int source = lamp_source_word(folded), type = lamp_type_word(folded);
    if (source >= 0 && r->lamp->source == GEO_SOURCE_UNKNOWN)
        r->lamp->source = source;
    if (type >= 0 && !r->type_known && of_the_lamp) {
        r->lamp->type = type;
        r->type_known = true;
    }
    return r->lamp->source != GEO_SOURCE_UNKNOWN && r->type_known;
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
    case LAMP_FIELD_DIRECTION:
        return lamp_direction(text, &lamp->direction) || misread(r, "direction of a lamp not understood");
    case LAMP_FIELD_COUNT: return read_count(r, text);
    case LAMP_FIELD_LUMENS:
        return read_quantity(r, text, LAMP_LUMENS, 5, LAMP_MOST_LUMENS, "luminous flux not understood or implausible",
                             &lamp->lumens);
    case LAMP_FIELD_WATTS:
        if (c->rank == 2 && !(text[0] >= '0' && text[0] <= '9')) /* power=pole and the like */
            return false;
        return read_quantity(r, text, LAMP_WATTS, .5, LAMP_MOST_WATTS, "wattage not understood or implausible",
                             &lamp->watts);
    case LAMP_FIELD_KELVIN:
        return read_kelvin(r, text) || misread(r, "colour temperature not understood or implausible");
    case LAMP_FIELD_COLOUR: return read_colour(r, text, c->rank <= 0);
    case LAMP_FIELD_TYPE:
        return read_type(r, text, c->rank < 4); /* a bare "type" may be the pole's: of it only a source is believed */
    case LAMP_FIELD_MOUNT: return read_mount(r, text);
    case LAMP_FIELD_ID: lamp->id = text; return true;
    case LAMP_FIELD_ELEVATION:
        if ((!isfinite(lamp->xyz[2]) || c->rank < 0) && lamp_coordinate(text, &x) && fabs(x * c->scale) < 9000)
            lamp->xyz[2] = x * c->scale;
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
    reading r = { .lamp = lamp, .issues = issues, .times = 1, .scale = 1, .decimal = lamp_keys_decimal(keys) };
    struct said {
        lamp_meaning meaning;
        const char *value;
    } few[32];
    struct said *said = count > NOC_COUNT(few) ? noc_alloc(count * sizeof(*said)) : few;
    if (!said)
        return false;
    size_t n = 0;
    int ranks = 0;
    for (size_t i = 0; i < count; i++) {
        lamp_meaning m = lamp_tag_meaning(keys, &tags[i]);
        if (m.field == LAMP_FIELD_NONE || lamp_blank(tags[i].value))
            continue;
        said[n++] = (struct said){ m, tags[i].value };
        ranks = NOC_MAX(ranks, m.rank + 1);
    }
    bool known[LAMP_FIELD_TOTAL] = { false };
    /* the id first, for the issues that the other fields raise */
    for (int pass = 0; pass < 2; pass++)
        for (int rank = -1; rank < ranks; rank++)
            for (size_t i = 0; i < n; i++) {
                const lamp_meaning *m = &said[i].meaning;
                if (m->rank != rank || known[m->field] || (m->field == LAMP_FIELD_ID) != (pass == 0))
                    continue;
                known[m->field] = read_field(&r, m, said[i].value);
            }
    for (int rank = -1; rank < ranks && !*lamp->ref; rank++)
        for (size_t i = 0; i < n && !*lamp->ref; i++)
            if (said[i].meaning.field == LAMP_FIELD_ID && said[i].meaning.rank == rank &&
                strcmp(said[i].value, lamp->id) != 0)
                lamp->ref = said[i].value;
    if (said != few)
        free(said);
    lamp_keys_ask(keys, tags, count, lamp);
    if (!lamp->count && r.times > 1)
        lamp->count = r.times;
    if (lamp->source == GEO_SOURCE_GAS && !r.type_known)
        lamp->type = GEO_LAMP_LANTERN;
    return true;
}
