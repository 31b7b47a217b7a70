/* The words of lamps in values: light sources, fixtures, mounts, status, colours, in the languages of columns.c. */
#include "import/lamps/tags.h"

typedef struct word {
    const char *text;
    int value;
} word;

lamp_text lamp_text_of(const char *folded) {
    lamp_text t = { .folded = folded };
    for (const char *p = folded; *p; p++) {
        t.any |= lamp_bit(*p);
        t.first |= p == folded || p[-1] == ' ' ? lamp_bit(*p) : 0;
    }
    return t;
}

bool lamp_find_word(const lamp_text *text, const char *wanted) {
    bool suffix = *wanted == '*';
    wanted += suffix;
    size_t n = strlen(wanted);
    bool prefix = wanted[n - 1] == '*';
    n -= prefix;
    for (const char *p = text->folded; *p; p++)
        if (*p == *wanted && (suffix || p == text->folded || p[-1] == ' ') && !strncmp(p, wanted, n) &&
            (prefix || !p[n] || p[n] == ' '))
            return true;
    return false;
}

static int find_word(const char *folded, const word *words, size_t count) {
    lamp_text text = lamp_text_of(folded);
    for (size_t i = 0; i < count; i++)
        if (lamp_has_word(&text, words[i].text))
            return words[i].value;
    return -1;
}

/* "son70" as "son 70": watts are written behind codes, and no code has a number of two digits or more in it. */
static const char *part_watts(const char *folded, char *to, size_t size) {
    size_t n = 0;
    for (const char *p = folded; *p && n + 2 < size; p++) {
        bool begins =
            p > folded && *p >= '1' && *p <= '9' && p[1] >= '0' && p[1] <= '9' && p[-1] >= 'a' && p[-1] <= 'z';
        if (begins)
            to[n++] = ' ';
        to[n++] = *p;
    }
    to[n] = 0;
    return to;
}

/* Names of sources. Beside plain words: by Philips and Osram (SON, PL, CDM, CPO, HPL, QL, HQL, NAV, HQI), codes of
 * ZVEI's LBS (HST, HIT, TC). Of those that begin with the same word the first counts. */
static const word source_words[] = {
    { "led*", GEO_SOURCE_LED },
    { "light emitting diode", GEO_SOURCE_LED },
    { "diode*", GEO_SOURCE_LED },
    { "metal halide", GEO_SOURCE_METAL_HALIDE },
    { "metal hal*", GEO_SOURCE_METAL_HALIDE },
    { "mh", GEO_SOURCE_METAL_HALIDE },
    { "hqi*", GEO_SOURCE_METAL_HALIDE },
    { "cdm*", GEO_SOURCE_METAL_HALIDE },
    { "cdo*", GEO_SOURCE_METAL_HALIDE },
    { "cpo*", GEO_SOURCE_METAL_HALIDE },
    { "hci*", GEO_SOURCE_METAL_HALIDE },
    { "cmh*", GEO_SOURCE_METAL_HALIDE },
    { "mhn*", GEO_SOURCE_METAL_HALIDE },
    { "mbi", GEO_SOURCE_METAL_HALIDE },
    { "cosmopolis", GEO_SOURCE_METAL_HALIDE },
    { "halogenmetall*", GEO_SOURCE_METAL_HALIDE },
    { "metallhalogen*", GEO_SOURCE_METAL_HALIDE },
    { "metaalhalogen*", GEO_SOURCE_METAL_HALIDE },
    { "ioduri", GEO_SOURCE_METAL_HALIDE },
    { "monimetall*", GEO_SOURCE_METAL_HALIDE },
    { "metalhalogen*", GEO_SOURCE_METAL_HALIDE },
    { "multivapor*", GEO_SOURCE_METAL_HALIDE },
    { "vapores metalicos", GEO_SOURCE_METAL_HALIDE },
    { "metalldampf*", GEO_SOURCE_METAL_HALIDE },
    { "halogen metall*", GEO_SOURCE_METAL_HALIDE },
    { "metalohalogen*", GEO_SOURCE_METAL_HALIDE },
    { "halogenur*", GEO_SOURCE_METAL_HALIDE },
    { "iodure*", GEO_SOURCE_METAL_HALIDE },
    { "alogenuri", GEO_SOURCE_METAL_HALIDE },
    { "hit", GEO_SOURCE_METAL_HALIDE },
    { "hie", GEO_SOURCE_METAL_HALIDE },
    { "halogenuros", GEO_SOURCE_METAL_HALIDE },
    { "halogenid*", GEO_SOURCE_METAL_HALIDE },
    { "hpi*", GEO_SOURCE_METAL_HALIDE },
    { "hps*", GEO_SOURCE_SODIUM },
    { "lps*", GEO_SOURCE_SODIUM },
    { "sodium", GEO_SOURCE_SODIUM },
    { "sodio", GEO_SOURCE_SODIUM },
    { "sod", GEO_SOURCE_SODIUM },
    { "natrium*", GEO_SOURCE_SODIUM },
    { "son", GEO_SOURCE_SODIUM },
    { "sont", GEO_SOURCE_SODIUM },
    { "sox*", GEO_SOURCE_SODIUM },
    { "nav", GEO_SOURCE_SODIUM },
    { "shp", GEO_SOURCE_SODIUM },
    { "sbp", GEO_SOURCE_SODIUM },
    { "vsbp", GEO_SOURCE_SODIUM },
    { "sap", GEO_SOURCE_SODIUM },
    { "vsap", GEO_SOURCE_SODIUM },
    { "sodik*", GEO_SOURCE_SODIUM },
    { "sodov*", GEO_SOURCE_SODIUM },
    { "sodow*", GEO_SOURCE_SODIUM },
    { "suurpainenatrium*", GEO_SOURCE_SODIUM },
    { "pienpainenatrium*", GEO_SOURCE_SODIUM },
    { "hogtrycksnatrium*", GEO_SOURCE_SODIUM },
    { "lagtrycksnatrium*", GEO_SOURCE_SODIUM },
    { "hoytrykknatrium*", GEO_SOURCE_SODIUM },
    { "hoytrykksnatrium*", GEO_SOURCE_SODIUM },
    { "lavtrykksnatrium*", GEO_SOURCE_SODIUM },
    { "hojtryksnatrium*", GEO_SOURCE_SODIUM },
    { "hogedruknatrium*", GEO_SOURCE_SODIUM },
    { "lagedruknatrium*", GEO_SOURCE_SODIUM },
    { "hst", GEO_SOURCE_SODIUM },
    { "hse", GEO_SOURCE_SODIUM },
    { "lst", GEO_SOURCE_SODIUM },
    { "ballon fluo*", GEO_SOURCE_MERCURY },
    { "mercury", GEO_SOURCE_MERCURY },
    { "merc", GEO_SOURCE_MERCURY },
    { "mbf*", GEO_SOURCE_MERCURY },
    { "mv", GEO_SOURCE_MERCURY },
    { "hme", GEO_SOURCE_MERCURY },
    { "hpl*", GEO_SOURCE_MERCURY },
    { "hql*", GEO_SOURCE_MERCURY },
    { "quecksilber*", GEO_SOURCE_MERCURY },
    { "elohope*", GEO_SOURCE_MERCURY },
    { "kvicksilv*", GEO_SOURCE_MERCURY },
    { "kvikksolv*", GEO_SOURCE_MERCURY },
    { "kviksolv*", GEO_SOURCE_MERCURY },
    { "kwik*", GEO_SOURCE_MERCURY },
    { "mercure", GEO_SOURCE_MERCURY },
    { "mercurio", GEO_SOURCE_MERCURY },
    { "vmcc", GEO_SOURCE_MERCURY },
    { "rtec*", GEO_SOURCE_MERCURY },
    { "rtut*", GEO_SOURCE_MERCURY },
    { "fluo*", GEO_SOURCE_FLUORESCENT },
    { "leuchtstoff*", GEO_SOURCE_FLUORESCENT },
    { "cfl", GEO_SOURCE_FLUORESCENT },
    { "pll", GEO_SOURCE_FLUORESCENT },
    { "tl", GEO_SOURCE_FLUORESCENT },
    { "pl", GEO_SOURCE_FLUORESCENT },
    { "plc", GEO_SOURCE_FLUORESCENT },
    { "pls", GEO_SOURCE_FLUORESCENT },
    { "plt", GEO_SOURCE_FLUORESCENT },
    { "tld", GEO_SOURCE_FLUORESCENT },
    { "tl5", GEO_SOURCE_FLUORESCENT },
    { "tl8", GEO_SOURCE_FLUORESCENT },
    { "tc", GEO_SOURCE_FLUORESCENT },
    { "ql", GEO_SOURCE_FLUORESCENT },
    { "induction", GEO_SOURCE_FLUORESCENT },
    { "inductie", GEO_SOURCE_FLUORESCENT },
    { "zarivk*", GEO_SOURCE_FLUORESCENT },
    { "incandescen*", GEO_SOURCE_INCANDESCENT },
    { "inc", GEO_SOURCE_INCANDESCENT },
    { "halogen*", GEO_SOURCE_INCANDESCENT },
    { "gluh*", GEO_SOURCE_INCANDESCENT },
    { "gloei*", GEO_SOURCE_INCANDESCENT },
    { "tungsten", GEO_SOURCE_INCANDESCENT },
    { "gas", GEO_SOURCE_GAS },
    { "gaslight*", GEO_SOURCE_GAS },
    { "gaslamp*", GEO_SOURCE_GAS },
    { "gasleucht*", GEO_SOURCE_GAS },
    { "gaslatern*", GEO_SOURCE_GAS },
    { "gaslantern*", GEO_SOURCE_GAS },
    { "gaz", GEO_SOURCE_GAS },
};

enum { MOST_NAMES = 8 };

/* A source that a text names. */
typedef struct source_name {
    int source;
    const char *at, *end; /* in the text */
} source_name;

/* Behind the pattern where it stands at p, the beginning of a word; NULL: it does not. */
static const char *behind_pattern(const char *p, const char *pattern) {
    size_t n = strlen(pattern);
    bool prefix = pattern[n - 1] == '*';
    n -= prefix;
    if (strncmp(p, pattern, n) != 0 || (!prefix && p[n] && p[n] != ' '))
        return NULL;
    return p + n + strcspn(p + n, " ");
}

/* The names in their order; returns how many, MOST_NAMES at most. */
static size_t find_names(const char *folded, source_name names[MOST_NAMES]) {
    size_t count = 0;
    for (const char *p = folded, *end; *p && count < MOST_NAMES; p = end + (*end == ' ')) {
        end = NULL;
        for (size_t i = 0; i < NOC_COUNT(source_words) && !end; i++)
            if ((end = *p == *source_words[i].text ? behind_pattern(p, source_words[i].text) : NULL))
                names[count++] = (source_name){ source_words[i].value, p, end };
        end = end ? end : p + strcspn(p, " ");
    }
    return count;
}

/* Is the word that ends at `end` one of these? *from: its beginning. */
static bool ends_with_word(const char *folded, const char *end, const char *const *words, size_t count,
                           const char **from) {
    const char *p = end;
    while (p > folded && p[-1] != ' ')
        p--;
    *from = p;
    for (size_t i = 0; i < count && p < end; i++)
        if (strlen(words[i]) == (size_t)(end - p) && !strncmp(p, words[i], (size_t)(end - p)))
            return true;
    return false;
}

/* "not LED", "kein LED", "LED: no". */
static bool is_denied(const char *folded, const source_name *name) {
    static const char *const nots[] = { "not",  "no",  "non", "kein", "keine", "keinen", "nicht",  "geen",   "niet",
                                        "pas",  "sin", "bez", "ohne", "sans",  "zonder", "senza",  "sem",    "ikke",
                                        "inte", "ej",  "ei",  "nie",  "nao",   "never",  "except", "without" };
    static const char *const articles[] = { "a",     "an",  "the", "yet", "ein", "eine",
                                            "einen", "een", "un",  "une", "de",  "d" };
    static const char *const noes[] = { "no", "nein", "nee", "non", "nej", "nie", "ne", "false" };
    const char *from, *end = name->at > folded ? name->at - 1 : folded;
    while (ends_with_word(folded, end, articles, NOC_COUNT(articles), &from))
        end = from > folded ? from - 1 : folded;
    if (ends_with_word(folded, end, nots, NOC_COUNT(nots), &from))
        return true;
    for (size_t i = 0; i < NOC_COUNT(noes) && *name->end; i++)
        if (!strcmp(name->end + 1, noes[i]))
            return true;
    return false;
}

static bool holds_any(const lamp_text *text, const char *const *words, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (lamp_has_word(text, words[i]))
            return true;
    return false;
}

/* Sodium at low pressure or at high, by the words beside it. */
static int sodium_of(const char *folded) {
    static const char *const low[] = { "low pressure", "lps*",         "sox*",      "lst",       "sbp",
                                       "vsbp",         "niederdruck*", "lagedruk*", "lage druk", "basse pression",
                                       "baja presion", "pienpaine*",   "lagtryck*", "lavtrykk*", "bassa pressione" };
    static const char *const high[] = {
        "high pressure", "hps*",       "son",       "sont",       "nav",       "shp",           "sap",
        "vsap",          "hst",        "hse",       "hochdruck*", "hogedruk*", "hoge druk",     "haute pression",
        "alta presion",  "suurpaine*", "hogtryck*", "hoytrykk*",  "hojtryk*",  "alta pressione"
    };
    lamp_text text = lamp_text_of(folded);
    bool is_low = holds_any(&text, low, NOC_COUNT(low)), is_high = holds_any(&text, high, NOC_COUNT(high));
    return is_low && is_high ? LAMP_SOURCES_DIFFER : is_low ? GEO_SOURCE_LOW_SODIUM : GEO_SOURCE_SODIUM;
}

/* All discharge is in gas, and mercury lamps are fluorescent, too: the more exact of two words; -1: they differ. */
static int more_exact(int a, int b) {
    bool discharge = b == GEO_SOURCE_SODIUM || b == GEO_SOURCE_MERCURY || b == GEO_SOURCE_METAL_HALIDE;
    if (a == b || (b == GEO_SOURCE_MERCURY && a == GEO_SOURCE_FLUORESCENT))
        return b;
    return a == GEO_SOURCE_GAS && (discharge || b == GEO_SOURCE_FLUORESCENT) ? b : -1;
}

/* The one source that these names mean together. */
static int one_source(const source_name *names, size_t count) {
    int source = names[0].source;
    for (size_t i = 1; i < count && source >= 0; i++) {
        int a = source, b = names[i].source;
        source = NOC_MAX(more_exact(a, b), more_exact(b, a));
    }
    return source < 0 ? LAMP_SOURCES_DIFFER : source;
}

int lamp_source_word(const char *folded) {
    static const char *const later[] = { "planned", "proposed", "geplant*", "vorgesehen*", "gepland*" };
    char parted[300];
    source_name names[MOST_NAMES];
    folded = part_watts(folded, parted, sizeof(parted));
    size_t count = find_names(folded, names);
    if (!count)
        return -1;
    for (size_t i = 0; i < count; i++)
        if (is_denied(folded, &names[i]))
            return LAMP_SOURCES_DIFFER;
    lamp_text text = lamp_text_of(folded);
    if (holds_any(&text, later, NOC_COUNT(later)))
        return LAMP_SOURCES_DIFFER;
    int source = one_source(names, count);
    return source == GEO_SOURCE_SODIUM ? sodium_of(folded) : source;
}

int lamp_type_word(const char *folded) {
    static const word words[] = {
        { "flood*", GEO_LAMP_FLOOD },       { "spotlight*", GEO_LAMP_FLOOD },   { "projector", GEO_LAMP_FLOOD },
        { "projecteur", GEO_LAMP_FLOOD },   { "proyector", GEO_LAMP_FLOOD },    { "fluter", GEO_LAMP_FLOOD },
        { "strahler", GEO_LAMP_FLOOD },     { "schijnwerper", GEO_LAMP_FLOOD }, { "proiettore", GEO_LAMP_FLOOD },
        { "lantern*", GEO_LAMP_LANTERN },   { "posttop*", GEO_LAMP_LANTERN },   { "post top*", GEO_LAMP_LANTERN },
        { "globe*", GEO_LAMP_LANTERN },     { "acorn*", GEO_LAMP_LANTERN },     { "bollard*", GEO_LAMP_LANTERN },
        { "kugel*", GEO_LAMP_LANTERN },     { "kegel*", GEO_LAMP_LANTERN },     { "gaslight*", GEO_LAMP_LANTERN },
        { "gaslamp*", GEO_LAMP_LANTERN },   { "gas", GEO_LAMP_LANTERN },        { "gaslatern*", GEO_LAMP_LANTERN },
        { "gasleucht*", GEO_LAMP_LANTERN }, { "laterne*", GEO_LAMP_LANTERN },   { "aufsatz*", GEO_LAMP_LANTERN },
        { "lanterne*", GEO_LAMP_LANTERN },  { "boule", GEO_LAMP_LANTERN },      { "globo", GEO_LAMP_LANTERN },
        { "farol", GEO_LAMP_LANTERN },      { "fernandino", GEO_LAMP_LANTERN }, { "villa", GEO_LAMP_LANTERN },
        { "cobra*", GEO_LAMP_STREET },      { "shoebox", GEO_LAMP_STREET },     { "teardrop", GEO_LAMP_STREET },
        { "street", GEO_LAMP_STREET },
    };
    return find_word(folded, words, NOC_COUNT(words));
}

int lamp_mount_word(const char *folded) {
    static const word words[] = {
        { "suspended", GEO_MOUNT_SUSPENDED },
        { "suspension", GEO_MOUNT_SUSPENDED },
        { "ceiling", GEO_MOUNT_SUSPENDED },
        { "catenary", GEO_MOUNT_SUSPENDED },
        { "wire", GEO_MOUNT_SUSPENDED },
        { "cable", GEO_MOUNT_SUSPENDED },
        { "power lines", GEO_MOUNT_SUSPENDED },
        { "seil*", GEO_MOUNT_SUSPENDED },
        { "uberspann*", GEO_MOUNT_SUSPENDED },
        { "hang*", GEO_MOUNT_SUSPENDED },
        { "span*", GEO_MOUNT_SUSPENDED },
        { "overspann*", GEO_MOUNT_SUSPENDED },
        { "wall*", GEO_MOUNT_WALL },
        { "wand*", GEO_MOUNT_WALL },
        { "gevel*", GEO_MOUNT_WALL },
        { "facade", GEO_MOUNT_WALL },
        { "fassade*", GEO_MOUNT_WALL },
        { "mur", GEO_MOUNT_WALL },
        { "pared", GEO_MOUNT_WALL },
        { "parete", GEO_MOUNT_WALL },
        { "building", GEO_MOUNT_WALL },
        { "muur*", GEO_MOUNT_WALL },
        { "bracket", GEO_MOUNT_WALL },
        { "pole*", GEO_MOUNT_POLE },
        { "mast*", GEO_MOUNT_POLE },
        { "straight mast", GEO_MOUNT_POLE },
        { "bent mast", GEO_MOUNT_POLE },
        { "bent pole", GEO_MOUNT_POLE },
        { "candelabre", GEO_MOUNT_POLE },
        { "mat", GEO_MOUNT_POLE },
        { "upright", GEO_MOUNT_POLE },
        { "baculo", GEO_MOUNT_POLE },
        { "columna", GEO_MOUNT_POLE },
        { "palo", GEO_MOUNT_POLE },
        { "pedestal", GEO_MOUNT_POLE },
        { "ground", GEO_MOUNT_POLE },
        { "stozar", GEO_MOUNT_POLE },
    };
    return find_word(folded, words, NOC_COUNT(words));
}

bool lamp_absent_word(const char *folded) {
    static const word words[] = {
        { "no light", 1 },      { "no lights", 1 },      { "no lamp", 1 },           { "no luminaire", 1 },
        { "no fixture", 1 },    { "no streetlight", 1 }, { "no street light", 1 },   { "no lighting", 1 },
        { "pole only", 1 },     { "without light", 1 },  { "without lamp", 1 },      { "light removed", 1 },
        { "ohne leuchte", 1 },  { "keine leuchte", 1 },  { "ohne lampe", 1 },        { "sans luminaire", 1 },
        { "sans lanterne", 1 }, { "sin luminaria", 1 },  { "senza apparecchio", 1 }, { "zonder armatuur", 1 },
        { "geen armatuur", 1 }, { "bez svitidla", 1 },   { "bez oprawy", 1 },        { "sem luminaria", 1 },
    };
    return find_word(folded, words, NOC_COUNT(words)) > 0;
}

bool lamp_inactive_word(const char *folded) {
    static const word words[] = {
        { "inactive", 1 },
        { "removed", 1 },
        { "retired", 1 },
        { "abandoned", 1 },
        { "disused", 1 },
        { "decommissioned", 1 },
        { "demolished", 1 },
        { "proposed", 1 },
        { "planned", 1 },
        { "out of service", 1 },
        { "out of order", 1 },
        { "not in service", 1 },
        { "not active", 1 },
        { "non operational", 1 },
        { "closed", 1 },
        { "dismantled", 1 },
        { "deleted", 1 },
        { "cancelled", 1 },
        { "canceled", 1 },
        { "missing", 1 },
        { "not installed", 1 },
        { "not built", 1 },
        { "not working", 1 },
        { "switched off", 1 },
        { "turned off", 1 },
        { "powered off", 1 },
        { "disconnected", 1 },
        { "knocked down", 1 },
        { "knocked over", 1 },
        { "burned out", 1 },
        { "burnt out", 1 },
        { "destroyed", 1 },
        { "stolen", 1 },
        { "in storage", 1 },
        { "unlit", 1 },
        { "not lit", 1 },
        { "deenergized", 1 },
        { "de energized", 1 },
        { "under construction", 1 },
        { "ausser betrieb", 1 },
        { "ausser dienst", 1 },
        { "ausgefallen*", 1 },
        { "defekt", 1 },
        { "nicht in betrieb", 1 },
        { "nicht aktiv", 1 },
        { "inaktiv*", 1 },
        { "stillgelegt*", 1 },
        { "demontiert*", 1 },
        { "ruckgebaut*", 1 },
        { "zuruckgebaut*", 1 },
        { "rueckgebaut*", 1 },
        { "ruckbau", 1 },
        { "abgebaut*", 1 },
        { "abgeschaltet*", 1 },
        { "abgerissen*", 1 },
        { "entfernt*", 1 },
        { "geplant*", 1 },
        { "in planung", 1 },
        { "im bau", 1 },
        { "buiten gebruik", 1 },
        { "buiten bedrijf", 1 },
        { "niet in gebruik", 1 },
        { "inactief", 1 },
        { "verwijderd*", 1 },
        { "vervallen", 1 },
        { "gesloopt*", 1 },
        { "ontmanteld*", 1 },
        { "gepland*", 1 },
        { "hors service", 1 },
        { "hors usage", 1 },
        { "hors d usage", 1 },
        { "en panne", 1 },
        { "eteint*", 1 },
        { "hors exploitation", 1 },
        { "inactif*", 1 },
        { "supprime*", 1 },
        { "depose*", 1 },
        { "demonte*", 1 },
        { "abandonne*", 1 },
        { "en projet", 1 },
        { "projete*", 1 },
        { "fuera de servicio", 1 },
        { "fuera de uso", 1 },
        { "retirad*", 1 },
        { "baja", 1 },
        { "inactiv*", 1 },
        { "desmontad*", 1 },
        { "eliminad*", 1 },
        { "proyectad*", 1 },
        { "planificad*", 1 },
        { "fuori servizio", 1 },
        { "fuori uso", 1 },
        { "dismess*", 1 },
        { "rimoss*", 1 },
        { "demolit*", 1 },
        { "smontat*", 1 },
        { "inattiv*", 1 },
        { "non attiv*", 1 },
        { "in progetto", 1 },
        { "fora de servico", 1 },
        { "fora de uso", 1 },
        { "desativad*", 1 },
        { "desactivad*", 1 },
        { "inativ*", 1 },
        { "removid*", 1 },
        { "planead*", 1 },
        { "planejad*", 1 },
        { "mimo provoz", 1 },
        { "zrusen*", 1 },
        { "demontovan*", 1 },
        { "odstranen*", 1 },
        { "planovan*", 1 },
        { "neaktivni", 1 },
        { "nieczynn*", 1 },
        { "nieaktywn*", 1 },
        { "wylaczon*", 1 },
        { "zdemontowan*", 1 },
        { "usuniet*", 1 },
        { "planowan*", 1 },
        { "ur drift", 1 },
        { "ute av drift", 1 },
        { "ude af drift", 1 },
        { "nedlagt", 1 },
        { "fjernet", 1 },
        { "borttag*", 1 },
        { "avvecklad*", 1 },
        { "planlagt", 1 },
        { "planerad*", 1 },
        { "poistettu", 1 },
        { "purettu", 1 },
        { "suunniteltu", 1 },
    };
    return find_word(folded, words, NOC_COUNT(words)) > 0;
}

bool lamp_colour_word(const char *folded, double *kelvin, float rgb[3]) {
    /* "orange" and "yellow" street light is sodium light; whites are the lamp trade's */
    static const word whites[] = {
        { "warm white", 3000 },
        { "warmwhite", 3000 },
        { "warmweiss", 3000 },
        { "warm wit", 3000 },
        { "blanc chaud", 3000 },
        { "warm", 3000 },
        { "neutral white", 4000 },
        { "neutralweiss", 4000 },
        { "neutral", 4000 },
        { "cool white", 5000 },
        { "cold white", 5000 },
        { "kaltweiss", 5000 },
        { "tageslichtweiss", 6000 },
        { "daylight", 6000 },
        { "blanc froid", 5000 },
        { "cool", 5000 },
        { "cold", 5000 },
        { "white", 4000 },
        { "weiss", 4000 },
        { "wit", 4000 },
        { "blanc", 4000 },
        { "yellow", 2000 },
        { "orange", 2000 },
        { "amber", 2000 },
        { "gelb", 2000 },
        { "geel", 2000 },
        { "jaune", 2000 },
    };
    static const struct {
        const char *text, *hex;
    } colours[] = { { "red", "#ff0000" },    { "green", "#00ff00" },   { "blue", "#0000ff" },
                    { "cyan", "#00ffff" },   { "magenta", "#ff00ff" }, { "purple", "#8000ff" },
                    { "violet", "#8000ff" }, { "pink", "#ff6080" },    { "turquoise", "#40e0d0" } };
    int white = find_word(folded, whites, NOC_COUNT(whites));
    if (white > 0) {
        *kelvin = white;
        return true;
    }
    lamp_text text = lamp_text_of(folded);
    for (size_t i = 0; i < NOC_COUNT(colours); i++)
        if (lamp_has_word(&text, colours[i].text))
            return lamp_hex_colour(colours[i].hex, rgb);
    return false;
}
