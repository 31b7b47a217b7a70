/* Tables whose values, not whose columns, say that their rows are lamps: "Lichtmast mit Auslegerleuchte" in a column
 * called "bezeichnung". A column says what the rows are where at least half of its values name street lamps, or where
 * it is called like one that says such things ("type", "Objektart") and a value names a street lamp beyond doubt. So an
 * inn called "Zur Laterne" among other places stays an inn. Where half of the rows have a description with a source and
 * its watts in one column ("HPS 250W"), all rows are lamps. */
#include "import/lamps/tags.h"

/* Values of such columns come again and again: what was found of some of them. */
enum { REMEMBERED = 16, REMEMBERED_SIZE = 48 };
struct lamp_kind {
    char remembered[REMEMBERED][REMEMBERED_SIZE];
    signed char word[REMEMBERED];
    char *name;
    bool of_kinds;             /* called like a column of kinds */
    size_t given, words, sure; /* values; those with a word; those beyond doubt */
    size_t models;             /* those that name a source and its watts: "HPS 250W AERO" */
    bool tells;
};

int lamp_object_word(const char *text) {
    static const char *const sure[] = {
        "lichtmast*",
        "beleuchtungsmast*",
        "leuchtenmast*",
        "lampenmast*",
        "strassenlatern*",
        "strassenleucht*",
        "strassenlamp*",
        "strassenbeleucht*",
        "*auslegerleuchte",
        "*auslegerleuchten",
        "*mastleuchte",
        "*mastleuchten",
        "*ansatzleuchte",
        "*aufsatzleuchte",
        "*pollerleuchte",
        "*seilleuchte",
        "street light*",
        "streetlight*",
        "street lamp*",
        "streetlamp*",
        "street lantern*",
        "lamp post*",
        "lamppost*",
        "lamp pole*",
        "light pole*",
        "lightpole*",
        "lighting pole*",
        "lighting column*",
        "light column*",
        "light standard*",
        "lighting standard*",
        "public lighting",
        "lantaarnpa*",
        "straatlantaarn*",
        "straatverlichting*",
        "lampadaire*",
        "candelabre*",
        "reverbere*",
        "point lumineux",
        "points lumineux",
        "eclairage public",
        "farola*",
        "luminaria*",
        "alumbrado publico",
        "punto de luz",
        "lampione",
        "lampioni",
        "punto luce",
        "illuminazione pubblica",
        "iluminacao publica",
        "verejne osvetleni",
        "svetelne misto",
        "svitidlo",
        "latarnia*",
        "latarnie",
        "oswietlenie uliczne",
        "gatubelysning",
        "gatlykt*",
        "lyktstolp*",
        "gadelampe*",
        "gadebelysning",
        "veilys",
        "gatelys*",
        "katuvalo*",
    };
    static const char *const some[] = {
        "latern*",   "*laterne", "*laternen",   "leuchte",      "leuchten", "*leuchte",  "*leuchten",
        "lamp",      "lamps",    "lampe",       "lampen",       "*lampe",   "lantern*",  "luminaire*",
        "lantaarn*", "lighting", "floodlight*", "flood light*", "strahler", "*strahler", "verlichting",
        "eclairage", "farol",    "lampara*",    "lampa",        "armatuur",
    };
    /* street lamp, road lighting, security light, in Japanese and Chinese; folding drops what is not Latin */
    static const char *const as_written[] = {
        "街灯", "街路灯", "照明灯", "道路照明", "防犯灯", "路灯", "街路燈", "路燈"
    };
    char folded[256];
    bool letters = false, foreign = false;
    for (const char *p = text ? text : ""; *p; p++) {
        foreign |= (unsigned char)*p >= 0x80;
        letters |= (*p >= 'a' && *p <= 'z') || (*p >= 'A' && *p <= 'Z');
    }
    for (size_t i = 0; foreign && i < NOC_COUNT(as_written); i++)
        if (strstr(text, as_written[i]))
            return 2;
    if (!letters)
        return 0; /* no word is without one, whatever accents it has */
    lamp_fold(text, true, folded, sizeof(folded));
    lamp_text t = lamp_text_of(folded);
    for (size_t i = 0; i < NOC_COUNT(sure); i++)
        if (lamp_has_word(&t, sure[i]))
            return 2;
    for (size_t i = 0; i < NOC_COUNT(some); i++)
        if (lamp_has_word(&t, some[i]))
            return 1;
    return 0;
}

static bool is_of_kinds(const char *name) {
    static const char *const keys[] = { "art",       "typ",         "type",      "kind",      "class",     "klasse",
                                        "kategorie", "category",    "objekt",    "object",    "objektart", "objecttype",
                                        "objekttyp", "featuretype", "feature",   "assettype", "asset",     "gattung",
                                        "bauart",    "soort",       "tipo",      "categorie", "categoria", "clase",
                                        "classe",    "nature",      "typologie", "druh",      "rodzaj",    "subtype",
                                        "furniture", "mobiliar" };
    char folded[64];
    lamp_fold(name, false, folded, sizeof(folded));
    for (size_t i = 0; i < NOC_COUNT(keys); i++)
        if (!strcmp(folded, keys[i]))
            return true;
    return false;
}

static struct lamp_kind *find(const lamp_kinds *kinds, const char *name, size_t hint) {
    if (hint < kinds->columns.len && !strcmp(kinds->columns.data[hint].name, name))
        return &kinds->columns.data[hint];
    for (size_t i = 0; i < kinds->columns.len; i++)
        if (!strcmp(kinds->columns.data[i].name, name))
            return &kinds->columns.data[i];
    return NULL;
}

enum { OF_MODEL = 3 };

/* As lamp_object_word, or OF_MODEL. */
static int ask_word(const char *text) {
    int word = lamp_object_word(text);
    if (word || !*(text + strcspn(text, "0123456789")))
        return word;
    const lamp_model m = lamp_model_of(text, false, 0);
    return m.source != GEO_SOURCE_UNKNOWN && m.watts > 0 && m.clear && lamp_model_stands_alone(&m) ? OF_MODEL : 0;
}

static int word_of(struct lamp_kind *k, const char *text) {
    size_t n = strnlen(text, REMEMBERED_SIZE);
    if (!n || n == REMEMBERED_SIZE)
        return ask_word(text);
    const unsigned char *u = (const unsigned char *)text;
    unsigned slot = (u[0] + 3u * u[n / 2] + 5u * u[n - 1] + 7u * (unsigned)n) % REMEMBERED;
    if (strcmp(k->remembered[slot], text)) {
        memcpy(k->remembered[slot], text, n + 1);
        k->word[slot] = (signed char)ask_word(text);
    }
    return k->word[slot];
}

bool lamp_kinds_count(lamp_kinds *kinds, const lamp_tag *tags, size_t count) {
    enum { MOST = 4096 }; /* columns of a table */
    kinds->rows++;
    for (size_t i = 0; i < count; i++) {
        struct lamp_kind *k = find(kinds, tags[i].key, i);
        if (!k && kinds->columns.len < MOST) {
            struct lamp_kind fresh = { .name = noc_strdup(tags[i].key), .of_kinds = is_of_kinds(tags[i].key) };
            if (!fresh.name || !array_push(&kinds->columns, fresh)) {
                free(fresh.name);
                return false;
            }
            k = &kinds->columns.data[kinds->columns.len - 1];
        }
        if (!k || lamp_blank(tags[i].value))
            continue;
        int word = word_of(k, tags[i].value);
        k->given++;
        k->words += word == 1 || word == 2;
        k->sure += word == 2;
        k->models += word == OF_MODEL;
    }
    return true;
}

void lamp_kinds_decide(lamp_kinds *kinds) {
    for (size_t i = 0; i < kinds->columns.len; i++) {
        struct lamp_kind *k = &kinds->columns.data[i];
        k->tells = k->sure && (k->of_kinds || 2 * k->sure >= k->given);
        k->tells = k->tells || (k->of_kinds && k->words && 2 * k->words >= k->given);
        kinds->any |= k->tells;
        kinds->models |= k->models > 1 && 2 * k->models >= kinds->rows;
    }
}

bool lamp_kinds_tell(const lamp_kinds *kinds, const lamp_tag *tags, size_t count) {
    for (size_t i = 0; i < count; i++) {
        struct lamp_kind *k = find(kinds, tags[i].key, i);
        int word = k && k->tells && tags[i].value ? word_of(k, tags[i].value) : 0;
        if (word == 1 || word == 2)
            return true;
    }
    return false;
}

void lamp_kinds_note(const lamp_kinds *kinds, lamp_keys *keys) {
    for (size_t i = 0; i < kinds->columns.len; i++)
        if (kinds->columns.data[i].tells)
            lamp_keys_tell(keys, kinds->columns.data[i].name);
}

void lamp_kinds_free(lamp_kinds *kinds) {
    for (size_t i = 0; i < kinds->columns.len; i++)
        free(kinds->columns.data[i].name);
    array_free(&kinds->columns);
}
