/* Whether a feature is a lamp, and whether it shines on a street: by tags, by status, by yes and no. */
#include "import/lamps/tags.h"

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

bool lamp_columns_ask(lamp_keys *keys, const char *const *names, size_t count) {
    bool ask = false;
    for (size_t i = 0; i < count; i++)
        ask = ask || lamp_keys_meaning(keys, names[i]).asks == LAMP_ASKS_ALONE;
    return ask;
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

int lamp_yes_or_no(const char *value) {
    static const char *const yes[] = { "yes", "y",   "true", "t",  "ja", "j",     "oui",  "o",         "si",  "s",
                                       "sim", "ano", "tak",  "on", "x",  "kylla", "vrai", "verdadero", "vero" };
    static const char *const no[] = { "no", "n",   "false", "f",  "nein", "non",  "nee",   "nao",
                                      "ne", "nie", "nej",   "ei", "off",  "faux", "falso", "none" };
    char folded[16];
    double number;
    if (noc_parse_double(value, &number))
        return number > 0 ? 1 : -1;
    lamp_fold(value, false, folded, sizeof(folded));
    for (size_t i = 0; i < NOC_COUNT(yes); i++)
        if (!strcmp(folded, yes[i]))
            return 1;
    for (size_t i = 0; i < NOC_COUNT(no); i++)
        if (!strcmp(folded, no[i]))
            return -1;
    return 0;
}

static bool is_no(const char *value) { return lamp_yes_or_no(value) < 0; }

static void makers_of(const char *key, lamp_meaning *m) {
    const char *rest = after_lifecycle(key);
    m->makes = lamp_key_tells(key);
    m->after = rest && lamp_key_tells(rest) ? (unsigned)(rest - key) : 0;
}

static bool among(const char *text, const char *const *words, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (!strcmp(text, words[i]))
            return true;
    return false;
}

/* Columns that say by yes and no whether there is a lamp at all: IS_STREETLIGHT, has_light, lamp_present. */
static lamp_asks asks_of(const char *folded) {
    static const char *const before[] = { "is",    "has", "with", "have", "ist",   "hat", "mit",
                                          "heeft", "met", "avec", "con",  "tiene", "ha",  "ma" };
    static const char *const behind[] = { "yn",     "flag",   "ind",       "indicator", "present",
                                          "exists", "exist",  "existing",  "attached",  "installed",
                                          "fitted", "onpole", "vorhanden", "aanwezig" };
    static const char *const street[] = { "streetlight",       "streetlights",     "streetlamp",
                                          "streetlamps",       "streetlighting",   "strassenlampe",
                                          "strassenleuchte",   "strassenlaterne",  "strassenbeleuchtung",
                                          "straatverlichting", "publiclight",      "publiclighting",
                                          "eclairagepublic",   "alumbradopublico", "illuminazionepubblica",
                                          "verejneosvetleni" };
    static const char *const lamp[] = { "lamp",     "lamps",    "luminaire", "luminaires", "lamppost",   "leuchte",
                                        "leuchten", "lampe",    "lampen",    "armatuur",   "lampadaire", "luminaria",
                                        "farola",   "lampione", "svitidlo",  "oprawa",     "valaisin" };
    static const char *const light[] = { "light",       "lights",    "lighting",  "fixture",      "beleuchtung",
                                         "verlichting", "eclairage", "alumbrado", "illuminazione" };
    char stem[64];
    noc_snprintf(stem, sizeof(stem), "%s", folded);
    bool asking = false;
    for (size_t i = 0; i < NOC_COUNT(behind) && !asking; i++) {
        size_t n = strlen(stem), m = strlen(behind[i]);
        asking = n > m && !strcmp(stem + n - m, behind[i]);
        stem[n - (asking ? m : 0)] = 0;
    }
    const char *noun = stem;
    for (size_t i = 0; i < NOC_COUNT(before) && noun == stem; i++)
        noun += strncmp(stem, before[i], strlen(before[i])) ? 0 : strlen(before[i]);
    bool known = among(noun, street, NOC_COUNT(street)) || among(noun, lamp, NOC_COUNT(lamp)) ||
                 among(noun, light, NOC_COUNT(light));
    if (noun > stem && !known)
        noun = stem; /* "island" has no lamp */
    asking = asking || noun > stem;
    if (among(noun, street, NOC_COUNT(street)) || (asking && among(noun, lamp, NOC_COUNT(lamp))))
        return LAMP_ASKS_ALONE;
    if (among(noun, lamp, NOC_COUNT(lamp)) || among(noun, light, NOC_COUNT(light)))
        return asking ? LAMP_ASKS : LAMP_ASKS_WORDS;
    return LAMP_ASKS_NOT;
}

/* Columns of what was, what will be, and of other things than lamps, say nothing of the lamp that is there. */
static bool is_free(const char *folded) {
    static const char *const others[] = { "histor", "comment", "note",     "remark",    "plan",     "future",
                                          "propos", "former",  "previous", "generator", "solar",    "battery",
                                          "panel",  "addr",    "road",     "owner",     "operator", "manufactur",
                                          "maker",  "date",    "circuit",  "feeder",    "transform" };
    for (size_t i = 0; i < NOC_COUNT(others); i++)
        if (strstr(folded, others[i]))
            return false;
    return !strstr(folded, "street") || strstr(folded, "light") || strstr(folded, "lamp");
}

/* Columns of how far a lamp is dimmed; not of whether it could be. */
static bool is_dimming(const char *folded) {
    static const char *const parts[] = { "dimm",      "dimlevel", "dimpercent", "dimpct",   "dimprofi",
                                         "dimregime", "dimvalue", "dimstand",   "dimstufe", "dimfactor",
                                         "dimsched",  "dimcurve", "absenkung",  "gradatio", "abaissement" };
    static const char *const ability[] = { "able", "ability", "bar", "baar" };
    bool is = false;
    for (size_t i = 0; i < NOC_COUNT(parts); i++)
        is = is || strstr(folded, parts[i]);
    for (size_t i = 0; i < NOC_COUNT(ability); i++)
        is = is && !strstr(folded, ability[i]);
    return is;
}

void lamp_roles_of(const char *key, lamp_meaning *m) {
    static const struct {
        const char *folded;
        lamp_role role;
    } roles[] = {
        { "disused", LAMP_ROLE_GONE },
        { "abandoned", LAMP_ROLE_GONE },
        { "removed", LAMP_ROLE_GONE },
        { "demolished", LAMP_ROLE_GONE },
        { "indoor", LAMP_ROLE_INDOORS },
        { "tunnel", LAMP_ROLE_INDOORS },
        { "location", LAMP_ROLE_LOCATION },
        { "whyinactive", LAMP_ROLE_WHY_NOT },
        { "inactivereason", LAMP_ROLE_WHY_NOT },
        { "inoperation", LAMP_ROLE_WORKS },
        { "active", LAMP_ROLE_WORKS }, /* elsewhere a date since when it works */
        { "isactive", LAMP_ROLE_WORKS },
        { "inservice", LAMP_ROLE_WORKS },
        { "isinservice", LAMP_ROLE_WORKS },
        { "inuse", LAMP_ROLE_WORKS },
        { "isinuse", LAMP_ROLE_WORKS },
        { "operational", LAMP_ROLE_WORKS },
        { "isoperational", LAMP_ROLE_WORKS },
        { "working", LAMP_ROLE_WORKS },
        { "isworking", LAMP_ROLE_WORKS },
        { "functional", LAMP_ROLE_WORKS },
        { "enabled", LAMP_ROLE_WORKS },
        { "energized", LAMP_ROLE_WORKS },
        { "inbetrieb", LAMP_ROLE_WORKS },
        { "aktiv", LAMP_ROLE_WORKS },
        { "ingebruik", LAMP_ROLE_WORKS },
        { "actief", LAMP_ROLE_WORKS },
        { "enservice", LAMP_ROLE_WORKS },
        { "actif", LAMP_ROLE_WORKS },
        { "activo", LAMP_ROLE_WORKS },
        { "enservicio", LAMP_ROLE_WORKS },
        { "attivo", LAMP_ROLE_WORKS },
        { "ativo", LAMP_ROLE_WORKS },
        { "aktivni", LAMP_ROLE_WORKS },
        { "aktywny", LAMP_ROLE_WORKS },
        { "inactive", LAMP_ROLE_WORKS_NOT },
        { "isinactive", LAMP_ROLE_WORKS_NOT },
        { "isremoved", LAMP_ROLE_WORKS_NOT },
        { "isretired", LAMP_ROLE_WORKS_NOT },
        { "retired", LAMP_ROLE_WORKS_NOT },
        { "decommissioned", LAMP_ROLE_WORKS_NOT },
        { "outofservice", LAMP_ROLE_WORKS_NOT },
        { "outoforder", LAMP_ROLE_WORKS_NOT },
        { "isdeleted", LAMP_ROLE_WORKS_NOT },
        { "deleted", LAMP_ROLE_WORKS_NOT },
        { "ausserbetrieb", LAMP_ROLE_WORKS_NOT },
        { "horsservice", LAMP_ROLE_WORKS_NOT },
    };
    char folded[128];
    makers_of(key, m);
    lamp_fold(key, false, folded, sizeof(folded));
    m->role = LAMP_ROLE_NONE;
    m->asks = asks_of(folded);
    m->dims = !m->field && is_dimming(folded);
    m->free_text = !m->field && !m->makes && !m->after && is_free(folded);
    for (size_t i = 0; i < NOC_COUNT(roles); i++) {
        bool tag = roles[i].role <= LAMP_ROLE_LOCATION; /* of OpenStreetMap: as it is written */
        if (!strcmp(tag ? key : folded, roles[i].folded))
            m->role = roles[i].role;
    }
}

/* A column that may say more than yes and no does so in whole words: an F may be fluorescent. */
static int says_lamp(const lamp_meaning *m, const char *v) {
    bool word = strlen(v) > 1 || strchr("NnYy", *v);
    return m->asks == LAMP_ASKS_NOT || (m->asks == LAMP_ASKS_WORDS && (!word || strpbrk(v, "0123456789")))
               ? 0
               : lamp_yes_or_no(v);
}

/* What a tag of a lamp says about whether it shines on a street. */
static lamp_verdict tag_verdict(const lamp_meaning *m, const char *v) {
    char folded[128];
    if (says_lamp(m, v) < 0)
        return LAMP_ABSENT;
    if (m->field == LAMP_FIELD_STATUS || m->field == LAMP_FIELD_TYPE) {
        lamp_fold(v, true, folded, sizeof(folded));
        if (lamp_absent_word(folded))
            return LAMP_ABSENT;
    }
    if (m->field == LAMP_FIELD_STATUS && m->role != LAMP_ROLE_GONE)
        return lamp_status_of(m, v) == LAMP_STATUS_NOT ? LAMP_INACTIVE : LAMP_ACTIVE;
    switch (m->role) {
    case LAMP_ROLE_GONE: return is_no(v) ? LAMP_ACTIVE : LAMP_INACTIVE;
    case LAMP_ROLE_INDOORS: return is_no(v) ? LAMP_ACTIVE : LAMP_INDOORS;
    case LAMP_ROLE_LOCATION: return !strcmp(v, "underground") || !strcmp(v, "indoor") ? LAMP_INDOORS : LAMP_ACTIVE;
    case LAMP_ROLE_WHY_NOT: return lamp_blank(v) ? LAMP_ACTIVE : LAMP_INACTIVE;
    case LAMP_ROLE_WORKS_NOT: return lamp_blank(v) || is_no(v) ? LAMP_ACTIVE : LAMP_INACTIVE;
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

bool lamp_unnamed_status(lamp_keys *keys, const lamp_tag *tags, size_t count) {
    enum { MOST_BLANKS = 2 }; /* "nicht in Betrieb"; more words are a text about something */
    char folded[64];
    if (lamp_keys_maps(keys, LAMP_FIELD_STATUS))
        return false;
    for (size_t i = 0; i < count; i++) {
        if (!tags[i].value || strlen(tags[i].value) >= sizeof(folded) || !lamp_tag_meaning(keys, &tags[i]).unnamed)
            continue;
        size_t blanks = 0;
        lamp_fold(tags[i].value, true, folded, sizeof(folded));
        for (const char *p = folded; *p; p++)
            blanks += *p == ' ';
        if (blanks <= MOST_BLANKS && lamp_inactive_word(folded))
            return true;
    }
    return false;
}

bool lamp_is_told(lamp_keys *keys, const lamp_tag *tags, size_t count) {
    bool told = false;
    for (size_t i = 0; i < count && !told; i++)
        if (tags[i].value && *tags[i].value) {
            lamp_meaning m = lamp_tag_meaning(keys, &tags[i]);
            told = m.asks == LAMP_ASKS_ALONE && !lamp_blank(tags[i].value) && says_lamp(&m, tags[i].value) >= 0;
        }
    return told;
}

bool lamp_accept(lamp_verdict verdict, const char *id, geo_issues *issues) {
    if (issues && verdict == LAMP_INACTIVE)
        geo_issue(issues, GEO_SPARED, "lamp not in use (removed, disused or planned)", id);
    if (issues && verdict == LAMP_INDOORS)
        geo_issue(issues, GEO_SPARED, "lamp indoors or underground", id);
    if (issues && verdict == LAMP_ABSENT)
        geo_issue(issues, GEO_SPARED, "point that has no lamp by its own word", id);
    return verdict == LAMP_ACTIVE;
}
