/* What the keys of a file mean: by the words, and by what the user maps with --lamp-columns; and which values they had,
 * so that a person can see what was read as what. */
#include "import/lamps/conditions.h"

#define MAX_KEYS 4096 /* of one file: tags may be anything, columns end there as well */
#define EXAMPLE 32    /* bytes of an example that are kept */

/* The names that --lamp-columns and reports use; the first one of a field is reported. */
static const struct {
    const char *name;
    lamp_field field;
} fields[] = {
    { "height", LAMP_FIELD_HEIGHT },
    { "lumens", LAMP_FIELD_LUMENS },
    { "lumen", LAMP_FIELD_LUMENS },
    { "flux", LAMP_FIELD_LUMENS },
    { "watts", LAMP_FIELD_WATTS },
    { "watt", LAMP_FIELD_WATTS },
    { "wattage", LAMP_FIELD_WATTS },
    { "power", LAMP_FIELD_WATTS },
    { "kelvin", LAMP_FIELD_KELVIN },
    { "cct", LAMP_FIELD_KELVIN },
    { "colour", LAMP_FIELD_COLOUR },
    { "color", LAMP_FIELD_COLOUR },
    { "source", LAMP_FIELD_TYPE },
    { "type", LAMP_FIELD_TYPE },
    { "direction", LAMP_FIELD_DIRECTION },
    { "count", LAMP_FIELD_COUNT },
    { "mount", LAMP_FIELD_MOUNT },
    { "status", LAMP_FIELD_STATUS },
    { "id", LAMP_FIELD_ID },
    { "ele", LAMP_FIELD_ELEVATION },
    { "lon", LAMP_FIELD_LON },
    { "lat", LAMP_FIELD_LAT },
    { "x", LAMP_FIELD_X },
    { "y", LAMP_FIELD_Y },
    { "wkt", LAMP_FIELD_WKT },
    { "latlon", LAMP_FIELD_LAT_LON },
};
#define FIELD_NAMES                                                                                                    \
    "height, lumens, watts, kelvin, colour, source, direction, count, mount, status, id, ele, lon, lat, x, y, "        \
    "wkt, latlon"

static const char *field_name(lamp_field field) {
    for (size_t i = 0; i < NOC_COUNT(fields); i++)
        if (fields[i].field == field)
            return fields[i].name;
    return "";
}

lamp_unit lamp_field_unit(lamp_field field) {
    switch (field) {
    case LAMP_FIELD_HEIGHT:
    case LAMP_FIELD_ELEVATION: return LAMP_METRES;
    case LAMP_FIELD_LUMENS: return LAMP_LUMENS;
    case LAMP_FIELD_WATTS: return LAMP_WATTS;
    case LAMP_FIELD_KELVIN: return LAMP_KELVIN;
    default: return LAMP_PLAIN;
    }
}

static const char *default_unit(lamp_unit unit) {
    static const char *const names[] = {
        [LAMP_METRES] = "m", [LAMP_WATTS] = "W", [LAMP_LUMENS] = "lm", [LAMP_KELVIN] = "K", [LAMP_PLAIN] = ""
    };
    return names[unit];
}

/* Finds what a folded name means, as it is or without a unit at its end; the unit must be one of the field's. */
static lamp_field find_with_unit(const char *folded, lamp_field (*find)(const char *, lamp_meaning *),
                                 lamp_meaning *m) {
    *m = (lamp_meaning){ .scale = 1, .unit = "" };
    m->field = find(folded, m);
    if (m->field) {
        m->unit = default_unit(lamp_field_unit(m->field));
        return m->field;
    }
    char stem[64];
    for (int kind = LAMP_METRES; kind < LAMP_PLAIN; kind++) {
        size_t tail = lamp_unit_tail(folded, (lamp_unit)kind, &m->scale, &m->unit);
        size_t length = strlen(folded) - tail;
        if (!tail || !length || length >= sizeof(stem))
            continue;
        memcpy(stem, folded, length);
        stem[length] = 0;
        m->field = find(stem, m);
        m->unit_named = m->field && lamp_field_unit(m->field) == (lamp_unit)kind;
        if (m->unit_named)
            return m->field;
    }
    return LAMP_FIELD_NONE;
}

/* Returns true for "lamp1", "leuchte2": sensors have columns of such names, whose values are no sources. */
static bool is_numbered_thing(const char *folded) {
    static const char *const things[] = { "lamp",    "light",     "lampe",    "lampara", "lampada",  "luminaire",
                                          "leuchte", "luminaria", "svitidlo", "oprawa",  "armatuur", "valaisin" };
    size_t n = strlen(folded), word = strcspn(folded, "0123456789");
    for (size_t i = 0; i < NOC_COUNT(things) && word < n; i++)
        if (strlen(things[i]) == word && !strncmp(folded, things[i], word))
            return true;
    return false;
}

static lamp_field find_column(const char *folded, lamp_meaning *m) {
    const lamp_column *c = lamp_column_find(folded);
    m->rank = c ? c->rank : 0;
    m->strength = !c ? 0 : is_numbered_thing(folded) ? NOC_MIN(c->strength, 1) : c->strength;
    return c ? c->field : LAMP_FIELD_NONE;
}

static lamp_field find_field(const char *folded, lamp_meaning *m) {
    m->rank = -1;
    m->strength = 2;
    for (size_t i = 0; i < NOC_COUNT(fields); i++)
        if (!strcmp(folded, fields[i].name))
            return fields[i].field;
    return LAMP_FIELD_NONE;
}

lamp_meaning lamp_meaning_of(const char *key) {
    char folded[64];
    lamp_meaning m;
    lamp_fold(key, false, folded, sizeof(folded));
    if (!find_with_unit(folded, find_column, &m))
        m = (lamp_meaning){ .scale = 1, .unit = "" };
    lamp_roles_of(key, &m);
    return m;
}

/* A name without a letter that folding keeps (Japanese) is compared as it is. */
bool lamp_same_key(const char *a, const char *b) {
    char x[128], y[128];
    size_t n = lamp_fold(a, false, x, sizeof(x)), m = lamp_fold(b, false, y, sizeof(y));
    return n && m ? !strcmp(x, y) : !strcmp(a, b);
}

/* ---- what the user maps ---- */

typedef struct mapping {
    lamp_meaning meaning;
    char *column; /* as the user wrote it */
} mapping;

typedef NOC_ARRAY(mapping) mappings;

static void free_mappings(mappings *maps) {
    for (size_t i = 0; i < maps->len; i++)
        free(maps->data[i].column);
    array_free(maps);
}

static noc_status add_mapping(mappings *maps, char *item, noc_log *log) {
    char *equals = strchr(item, '='), field[64];
    if (!equals || equals == item || !equals[1])
        return noc_error(log, NOC_ERR_ARGUMENT, "lamp-columns: \"%.60s\" is not FIELD=COLUMN", item);
    *equals = 0;
    mapping map = { .column = equals + 1 };
    lamp_fold(item, false, field, sizeof(field));
    if (!find_with_unit(field, find_field, &map.meaning))
        return noc_error(log, NOC_ERR_ARGUMENT,
                         "lamp-columns: there is no field \"%.40s\"; the fields are " FIELD_NAMES, item);
    for (size_t i = 0; i < maps->len; i++)
        if (lamp_same_key(maps->data[i].column, map.column))
            return noc_error(log, NOC_ERR_ARGUMENT, "lamp-columns: the column \"%.40s\" is named twice", map.column);
    map.column = noc_strdup(map.column);
    if (map.column && array_push(maps, map))
        return NOC_OK;
    free(map.column);
    return noc_no_memory(log, "lamp-columns");
}

static noc_status parse_mappings(const noc_import_params *params, mappings *maps, noc_log *log) {
    noc_status status = NOC_OK;
    for (size_t i = 0; params && i < params->lamp_columns.count && !status; i++) {
        char *copy = noc_strdup(params->lamp_columns.text[i]), *rest = copy, *item;
        if (!copy)
            return noc_no_memory(log, "lamp-columns");
        while (!status && (item = strsep(&rest, ",")))
            status = add_mapping(maps, item, log);
        free(copy);
    }
    return status;
}

noc_status lamp_mapping_check(const noc_import_params *params, noc_log *log) {
    mappings maps = { 0 };
    noc_status status = parse_mappings(params, &maps, log);
    free_mappings(&maps);
    return status;
}

noc_status lamp_mapping_missing(const noc_import_params *params, bool (*found)(void *ctx, const char *name), void *ctx,
                                noc_log *log, char **missing) {
    mappings maps = { 0 };
    noc_status status = parse_mappings(params, &maps, log);
    *missing = NULL;
    for (size_t i = 0; i < maps.len && !status && !*missing; i++)
        if (!found(ctx, maps.data[i].column) && !(*missing = noc_strdup(maps.data[i].column)))
            status = noc_no_memory(log, "lamp-columns");
    free_mappings(&maps);
    return status;
}

/* ---- keys of a file ---- */

typedef struct key {
    const char *name;
    lamp_meaning meaning;
    size_t values;
    char *example;
    const char *ignored; /* the heading's unit, where a mapped field names another one; else NULL */
    bool tells;          /* what is a lamp */
    bool placed;         /* places were read from it */
    bool understood;     /* sources were */
    bool described;      /* descriptions were, though it is called otherwise */
    bool yes, no, other; /* values of a column of status: yes and no, and what is neither */
    bool asked;          /* by conditions: */
    uint64_t conditions[GEO_CONDITIONS / 64];
    bool noted; /* belongs into the table of columns; the others were only asked for */
} key;

/* Descriptions come again and again: what was read of some of them. */
enum { MODELS = 256, MODEL_SIZE = 48 };
typedef struct known_model {
    char text[MODEL_SIZE];
    lamp_model model;
} known_model;

struct lamp_keys {
    mappings maps;
    known_model *models; /* MODELS of them; NULL: none was asked for */
    lamp_unread *unread; /* NULL: not counted */
    noc_arena arena;
    noc_map index;
    NOC_ARRAY(key) keys;
    size_t commas, points;       /* values with such a decimal sign */
    lamp_conditions *conditions; /* NULL: none */
    bool told;                   /* lamps tell their tags */
    bool headless;               /* names are values */
    char tags[GEO_LAMP_TAGS];    /* of the last one */
};

lamp_keys *lamp_keys_create(const noc_import_params *params) {
    lamp_keys *keys = noc_calloc(1, sizeof(*keys));
    noc_status status = NOC_OK;
    if (keys) /* both are understood, as lamp_mapping_check was asked, and luminaires_start */
        keys->conditions = lamp_conditions_create(params, NULL, &status);
    if (keys)
        keys->told = params && params->each_lamp;
    if (!keys || (!status && !parse_mappings(params, &keys->maps, NULL)))
        return keys;
    lamp_keys_destroy(keys);
    return NULL;
}

void lamp_keys_destroy(lamp_keys *keys) {
    if (!keys)
        return;
    free_mappings(&keys->maps);
    array_free(&keys->keys);
    map_free(&keys->index);
    arena_free(&keys->arena);
    lamp_conditions_destroy(keys->conditions);
    lamp_unread_destroy(keys->unread);
    free(keys->models);
    free(keys);
}

bool lamp_keys_count_unread(lamp_keys *keys) {
    keys->unread = lamp_unread_create();
    return keys->unread != NULL;
}

lamp_model lamp_keys_model(lamp_keys *keys, const char *text, bool watts_column) {
    char decimal = lamp_keys_decimal(keys);
    size_t n = strnlen(text, MODEL_SIZE);
    if (keys && !watts_column && n < MODEL_SIZE && !keys->models)
        keys->models = noc_calloc(MODELS, sizeof(*keys->models));
    if (!keys || !keys->models || watts_column || !n || n == MODEL_SIZE)
        return lamp_model_of(text, watts_column, decimal);
    known_model *k = &keys->models[noc_hash_text(text) % MODELS];
    if (strcmp(k->text, text)) {
        memcpy(k->text, text, n + 1);
        k->model = lamp_model_of(text, false, decimal);
    }
    return k->model;
}

/* The unit that a heading names for a field it is mapped to: where the words know it as that field, theirs; else its
 * last word, for "Shaft" ends in "ft" and is no unit. */
static bool heading_unit(const char *name, lamp_field field, double *scale, const char **unit) {
    char folded[128];
    lamp_meaning m = lamp_meaning_of(name);
    lamp_fold(name, true, folded, sizeof(folded));
    const char *word = strrchr(folded, ' ');
    if (word && lamp_unit_word(word + 1, lamp_field_unit(field), scale, unit))
        return true;
    *scale = m.scale;
    *unit = m.unit;
    return m.field == field && m.unit_named;
}

/* *ignored: as in key. */
static lamp_meaning find_meaning(const lamp_keys *keys, const char *name, const char **ignored) {
    const mapping *map = NULL;
    *ignored = NULL;
    for (size_t i = 0; i < keys->maps.len && !map; i++)
        if (lamp_same_key(keys->maps.data[i].column, name))
            map = &keys->maps.data[i];
    if (!map && keys->headless)
        return (lamp_meaning){ .scale = 1, .unit = "", .free_text = true, .unnamed = true };
    if (!map)
        return lamp_meaning_of(name);
    lamp_meaning m = map->meaning;
    if (keys->headless)
        return m;
    lamp_roles_of(name, &m);
    double scale;
    const char *unit;
    if (!heading_unit(name, m.field, &scale, &unit))
        return m;
    if (m.unit_named) {
        *ignored = scale != m.scale ? unit : NULL;
        return m;
    }
    m.scale = scale;
    m.unit = unit;
    m.unit_named = true;
    return m;
}

/* NULL where there are too many to remember, or memory is refused. */
static key *get(lamp_keys *keys, const char *name) {
    uint64_t i;
    if (!map_get(&keys->index, name, &i)) {
        i = keys->keys.len;
        if (i == MAX_KEYS)
            return NULL;
        key k = { .name = arena_strdup(&keys->arena, name) };
        k.meaning = find_meaning(keys, name, &k.ignored);
        k.asked = lamp_conditions_of_key(keys->conditions, name, k.conditions);
        if (!k.name || !array_push(&keys->keys, k)) {
            keys->arena.refused = true;
            return NULL;
        }
        if (!map_put(&keys->index, name, i, NULL)) {
            keys->keys.len--;
            keys->arena.refused = true;
            return NULL;
        }
    }
    return &keys->keys.data[i];
}

lamp_meaning lamp_keys_meaning(lamp_keys *keys, const char *name) {
    const key *k = keys ? get(keys, name) : NULL;
    const char *ignored;
    return k ? k->meaning : keys ? find_meaning(keys, name, &ignored) : lamp_meaning_of(name);
}

unsigned lamp_keys_know(lamp_keys *keys, const char *name) {
    const key *k = get(keys, name);
    return k ? (unsigned)(k - keys->keys.data) + 1 : 0;
}

void lamp_keys_weigh(lamp_keys *keys, const lamp_tag *tag) {
    lamp_field field = lamp_tag_meaning(keys, tag).field;
    bool number = field == LAMP_FIELD_LON || field == LAMP_FIELD_LAT || field == LAMP_FIELD_X ||
                  field == LAMP_FIELD_Y || (field && lamp_field_unit(field) != LAMP_PLAIN);
    char sign = number && tag->value ? lamp_decimal_sign(tag->value) : 0;
    keys->commas += sign == ',';
    keys->points += sign == '.';
}

char lamp_keys_decimal(const lamp_keys *keys) {
    return !keys || (keys->commas && keys->points) ? 0 : keys->commas ? ',' : keys->points ? '.' : 0;
}

static key *get_tag(lamp_keys *keys, const lamp_tag *tag) {
    return tag->known ? &keys->keys.data[tag->known - 1] : get(keys, tag->key);
}

void lamp_keys_flag(lamp_keys *keys, const lamp_tag *tag) {
    key *k = keys && !lamp_blank(tag->value) ? get_tag(keys, tag) : NULL;
    if (!k || k->meaning.field != LAMP_FIELD_STATUS)
        return;
    bool flag = lamp_is_flag(tag->value);
    k->yes = k->yes || (flag && lamp_yes_or_no(tag->value) > 0);
    k->no = k->no || (flag && lamp_yes_or_no(tag->value) < 0);
    k->other = k->other || !flag;
    k->meaning.flags = k->yes && k->no && !k->other;
}

void lamp_keys_unread(lamp_keys *keys, const char *reason, const char *text, const lamp_tag *column, const char *id,
                      geo_issues *issues) {
    if (!issues)
        return;
    const key *k = keys && column ? get_tag(keys, column) : NULL;
    if (!keys || !keys->unread)
        geo_issue(issues, GEO_GUESSED, reason, id);
    else if (!lamp_unread_add(keys->unread, reason, k ? k->name : "", text, id))
        keys->arena.refused = true;
}

lamp_meaning lamp_tag_meaning(lamp_keys *keys, const lamp_tag *tag) {
    return keys && tag->known ? get_tag(keys, tag)->meaning : lamp_keys_meaning(keys, tag->key);
}

/* Whole tags, as many as there is room for, one a line. Those that are ours (@) are none, nor is what GDAL calls an id
 * of OpenStreetMap. */
static const char *tell_tags(lamp_keys *keys, const lamp_tag *tags, size_t count) {
    size_t n = 0;
    keys->tags[0] = 0;
    for (size_t i = 0; i < count; i++) {
        if (tags[i].key[0] == '@' || !strcmp(tags[i].key, "osm_id") || !tags[i].value || !*tags[i].value)
            continue;
        char *at = keys->tags + n;
        size_t room = sizeof(keys->tags) - n;
        int size = noc_snprintf(at, room, "%s%s=%s", n ? "\n" : "", tags[i].key, tags[i].value);
        if (size < 0 || (size_t)size >= room) {
            *at = 0;
            continue;
        }
        for (char *p = at + (n > 0); *p; p++)
            *p = (unsigned char)*p < ' ' || *p == 0x7f ? ' ' : *p;
        n += (size_t)size;
    }
    return keys->tags;
}

void lamp_keys_ask(lamp_keys *keys, const lamp_tag *tags, size_t count, geo_lamp *lamp) {
    if (keys && keys->told)
        lamp->tags = tell_tags(keys, tags, count);
    if (!keys || !keys->conditions)
        return;
    lamp_conditions_none(keys->conditions, lamp);
    for (size_t i = 0; i < count; i++) {
        const key *known = get_tag(keys, &tags[i]);
        key one = { 0 }; /* of too many to be known */
        if (!known) {
            one.meaning = lamp_tag_meaning(keys, &tags[i]);
            one.asked = lamp_conditions_of_key(keys->conditions, tags[i].key, one.conditions);
        }
        const key *k = known ? known : &one;
        if (k->asked)
            lamp_conditions_tag(keys->conditions, k->conditions, &tags[i], &k->meaning, lamp_keys_decimal(keys), lamp);
    }
}

/* The length of the first bytes of text that may be kept without cutting a character. */
static size_t cut(const char *text) {
    size_t n = strlen(text);
    if (n <= EXAMPLE)
        return n;
    for (n = EXAMPLE; n && ((unsigned char)text[n] & 0xc0) == 0x80;)
        n--;
    return n;
}

void lamp_keys_headless(lamp_keys *keys) {
    keys->headless = true;
    for (size_t i = 0; i < keys->keys.len; i++)
        keys->keys.data[i].meaning = find_meaning(keys, keys->keys.data[i].name, &keys->keys.data[i].ignored);
}

bool lamp_keys_maps(const lamp_keys *keys, lamp_field field) {
    for (size_t i = 0; i < keys->maps.len; i++)
        if (keys->maps.data[i].meaning.field == field)
            return true;
    return false;
}

void lamp_keys_note(lamp_keys *keys, const lamp_tag *tag) {
    key *k = get_tag(keys, tag);
    const char *value = tag->value;
    if (!k)
        return;
    k->noted = true;
    if (lamp_blank(value))
        return;
    size_t n = k->values++ ? 0 : cut(value);
    if (n)
        k->example = arena_format(&keys->arena, "%.*s%s", (int)n, value, value[n] ? "..." : "");
}

void lamp_keys_tell(lamp_keys *keys, const char *name) {
    key *k = get(keys, name);
    if (k)
        k->tells = true;
}

void lamp_keys_placed(lamp_keys *keys, const char *name) {
    key *k = get(keys, name);
    if (k)
        k->placed = true;
}

void lamp_keys_described(lamp_keys *keys, const lamp_tag *tag) {
    key *k = keys ? get_tag(keys, tag) : NULL;
    if (k)
        k->described = true;
}

void lamp_keys_understood(lamp_keys *keys, const lamp_tag *tag) {
    key *k = keys ? get_tag(keys, tag) : NULL;
    if (k)
        k->understood = true;
}

bool lamp_keys_number(const lamp_keys *keys, size_t number) {
    char name[24];
    noc_snprintf(name, sizeof(name), "#%zu", number);
    bool named = false;
    for (size_t i = 0; i < keys->maps.len; i++)
        named = named || !strcmp(keys->maps.data[i].column, name);
    return named;
}

/* What a column was read as: one of places only where any was read. */
static const char *field_read(const key *k) {
    const lamp_meaning *m = &k->meaning;
    bool place = m->field >= LAMP_FIELD_LON && m->field <= LAMP_FIELD_LAT_LON;
    if (m->unnamed)
        return k->described ? "description" : "";
    if (k->tells || (!m->field && (lamp_key_tells(k->name) || m->asks == LAMP_ASKS_ALONE)))
        return "kind";
    if (!m->field && (m->role >= LAMP_ROLE_WHY_NOT || m->asks == LAMP_ASKS))
        return "status";
    if (m->field == LAMP_FIELD_TYPE && k->values && !k->understood && m->rank >= 0)
        return ""; /* ids, or readings of a sensor */
    return k->described ? "description" : place && !k->placed ? "" : field_name(m->field);
}

static void warn_of_units(const lamp_keys *keys, noc_log *log, const char *place) {
    for (size_t i = 0; i < keys->keys.len; i++) {
        const key *k = &keys->keys.data[i];
        if (k->noted && k->ignored)
            noc_warn(log, "%s: the column \"%.60s\" says %s, and --lamp-columns says %s: taken as %s", place, k->name,
                     k->ignored, k->meaning.unit, k->meaning.unit);
    }
}

noc_status lamp_keys_report(lamp_keys *keys, geo_sink *sink, const char *place, size_t points) {
    warn_of_units(keys, sink->log, place);
    for (size_t i = 0; keys->unread && i < keys->keys.len; i++)
        if (!keys->keys.data[i].understood && *keys->keys.data[i].name)
            lamp_unread_drop_ids(keys->unread, keys->keys.data[i].name);
    if (keys->unread && sink->issues)
        lamp_unread_tell(keys->unread, sink->issues);
    if (!sink->columns)
        return NOC_OK;
    geo_column *columns = noc_calloc(keys->keys.len + 1, sizeof(*columns));
    if (!columns || keys->arena.refused) {
        free(columns);
        return noc_no_memory(sink->log, place);
    }
    size_t n = 0;
    for (size_t i = 0; i < keys->keys.len; i++) {
        const key *k = &keys->keys.data[i];
        if (!k->noted)
            continue;
        columns[n++] = (geo_column){ .name = k->name,
                                     .field = field_read(k),
                                     .unit = k->meaning.field == LAMP_FIELD_ELEVATION && !k->meaning.unit_named
                                                 ? "" /* the CRS's */
                                                 : k->meaning.unit,
                                     .example = k->example ? k->example : "",
                                     .values = k->values,
                                     .mapped = k->meaning.rank < 0 };
    }
    noc_status status = sink->columns(sink->ctx, points, columns, n);
    free(columns);
    return status;
}
