/* What free text says of a lamp: "HPS 250W AERO", "LED, 38 WATT", "NAV-T 70", "2x36W PL-L/830". Words and numbers in
 * their order: a number with a unit is one of that, and one beside the name of a source is its watts. */
#include "import/lamps/tags.h"

#include <ctype.h>
#include <math.h>

enum { MOST_TOKENS = 32, TOKEN_SIZE = 24 };

typedef struct token {
    const char *at;     /* in the text */
    bool number, glued; /* to what is before it */
    bool brackets;      /* a number alone in them */
    double value;
    char word[TOKEN_SIZE]; /* folded */
    bool source;           /* a word of a source, or of what belongs to its name */
} token;

typedef struct tokens {
    token list[MOST_TOKENS];
    size_t count;
    char folded[MOST_TOKENS * TOKEN_SIZE]; /* its words and numbers, with blanks */
} tokens;

static bool is_letter(const char *p) { return isalpha((unsigned char)*p) || (unsigned char)*p >= 0x80; }

static bool two_digits(const char *p) { return isdigit((unsigned char)p[0]) && isdigit((unsigned char)p[1]); }

/* How many bytes of a word begin at p: letters, and a digit that is alone ("TL5"). */
static size_t word_length(const char *p) {
    size_t n = 0;
    while (is_letter(p + n))
        n++;
    bool times = n == 1 && (*p == 'x' || *p == 'X');
    if (n && !times && isdigit((unsigned char)p[n]) && !two_digits(p + n) && p[n + 1] != '.' && p[n + 1] != ',')
        n++;
    return n;
}

/* The multiplication sign of Unicode, an asterisk, or an at. */
static size_t times_sign(const char *p) { return *p == '*' || *p == '@' ? 1 : !strncmp(p, "\xc3\x97", 2) ? 2 : 0; }

static void split(const char *text, char decimal, tokens *t) {
    bool glued = false;
    t->count = 0;
    for (const char *p = text; *p && t->count < MOST_TOKENS;) {
        token *one = &t->list[t->count];
        *one = (token){ .at = p, .glued = glued };
        const char *end = NULL;
        size_t times = times_sign(p), n = times ? 0 : word_length(p);
        glued = true;
        if (isdigit((unsigned char)*p) && (end = lamp_scan_number(p, true, decimal, &one->value))) {
            one->number = true;
            one->brackets = p > text && p[-1] == '(' && *end == ')';
            p = end;
        } else if (n || times) {
            char copy[2 * TOKEN_SIZE];
            noc_snprintf(copy, sizeof(copy), "%.*s", (int)NOC_MIN(n, sizeof(copy) - 1), p);
            p += n + times;
            if (times)
                noc_snprintf(one->word, sizeof(one->word), "x");
            else if (!lamp_fold(copy, false, one->word, sizeof(one->word)))
                continue;
        } else {
            glued = false;
            p++;
            continue;
        }
        t->count++;
    }
}

static bool is_word(const tokens *t, size_t i, const char *word) {
    return i < t->count && !t->list[i].number && !strcmp(t->list[i].word, word);
}

/* Which words name the source: each, with what belongs to a name, is asked by itself. */
static bool find_sources(tokens *t) {
    bool any = false;
    for (size_t i = 0; i < t->count; i++) {
        token *w = &t->list[i];
        w->source = !w->number && (lamp_source_word(w->word) >= 0 || !strncmp(w->word, "halide", 6));
        any = any || w->source;
    }
    return any;
}

/* Words that stand beside a source's and say nothing of their own. */
static bool goes_with_source(const char *word) {
    static const char *const words[] = { "high",  "low",   "pressure", "vapor",  "vapour", "vapeur",    "vapore",
                                         "haute", "basse", "pression", "alta",   "baja",   "bassa",     "presion",
                                         "lamp",  "lamps", "light",    "lights", "bulb",   "luminaire", "street",
                                         "de",    "a",     "di",       "hal",    "clear",  "coated",    "retrofit" };
    for (size_t i = 0; i < NOC_COUNT(words); i++)
        if (!strcmp(word, words[i]))
            return true;
    bool metal = !strncmp(word, "metal", 5) || !strncmp(word, "halid", 5);
    if (!strcmp(word, "x") || !strcmp(word, "no") || !strcmp(word, "nr"))
        return false;
    return metal || strlen(word) <= 2; /* letters of a code: the T of NAV-T */
}

/* How much a name means a source where a column says nothing of lamps: 2: nothing else, 1: with the watts of a lamp
 * behind it, 0: only in a column of lamps ("PL 36" may be a pole). */
static int clearness(const char *word) {
    static const char *const clear[] = { "led", "leds", "hps", "hpsv", "lps", "sox", "hql", "hqi", "cfl" };
    static const char *const some[] = { "son", "sont", "nav", "hpl",  "cdm", "cdmt", "cpo", "cdo", "shp", "sap",
                                        "hst", "hse",  "hme", "vsap", "mh",  "mv",   "hci", "cmh", "sod", "merc" };
    for (size_t i = 0; i < NOC_COUNT(clear); i++)
        if (!strcmp(word, clear[i]))
            return 2;
    for (size_t i = 0; i < NOC_COUNT(some); i++)
        if (!strcmp(word, some[i]))
            return 1;
    return strlen(word) > 4 && strncmp(word, "halogen", 8) != 0 && strncmp(word, "gas", 3) != 0 ? 2 : 0;
}

static bool is_lamps_power(double watts) {
    static const short usual[] = { 18,  35,  36,  40,  50,  55,  60,  70,  75,  80,  90,  100, 125, 135, 150,
                                   175, 180, 200, 210, 250, 310, 320, 350, 360, 400, 600, 700, 750, 1000 };
    for (size_t i = 0; i < NOC_COUNT(usual); i++)
        if (watts == usual[i])
            return true;
    return false;
}

/* Are the numbers from i on, before `next`, beside a source's name, behind letters of its code at most? */
static bool beside_source(const tokens *t, size_t i, size_t next) {
    for (size_t k = i; k-- > 0 && !t->list[k].number;) {
        if (t->list[k].source)
            return !(t->list[i].glued && !strncmp(t->list[k].word, "led", 3)); /* LED36: of so many diodes */
        if (!goes_with_source(t->list[k].word))
            break;
    }
    return next < t->count && t->list[next].source;
}

static bool within(double value, double least, double most) { return value >= least && value <= most; }

static bool is_piece_word(const char *word) {
    static const char *const words[] = { "pc", "pcs", "pieces", "stk", "stck", "stuck", "stuk", "nos", "uds", "szt" };
    for (size_t i = 0; i < NOC_COUNT(words); i++)
        if (!strcmp(word, words[i]))
            return true;
    return false;
}

/* How many the number i tells; 0: none. */
static int heads_of(const tokens *t, size_t i) {
    double n = i < t->count && t->list[i].number ? t->list[i].value : 0;
    return within(n, 1, 99) && n == floor(n) ? (int)n : 0;
}

/* "50 x LED 1W", "24 LED x 3W", "2 pcs 70W", "(2) 70W": the number before what is between at most a source's name; 0:
 * none. */
static int times_before(const tokens *t, size_t i) {
    while (i && t->list[i - 1].source)
        i--;
    if (i && t->list[i - 1].brackets)
        return heads_of(t, i - 1);
    if (i < 2 || t->list[i - 1].number || !(is_word(t, i - 1, "x") || is_piece_word(t->list[i - 1].word)))
        return 0;
    i -= 2;
    while (i && t->list[i].source)
        i--;
    return heads_of(t, i);
}

/* "70W HPS x 2": the number behind, with a source's name between at most; 0: none. */
static int times_behind(const tokens *t, size_t next) {
    while (next < t->count && t->list[next].source)
        next++;
    bool last = next + 2 == t->count || (next + 2 < t->count && !t->list[next + 2].glued);
    return is_word(t, next, "x") && last ? heads_of(t, next + 1) : 0;
}

static bool is_head_word(const char *word) {
    static const char *const words[] = { "acorn",   "arm",      "arms",      "head",       "heads",
                                         "globe",   "globes",   "lantern",   "lamp",       "lamps",
                                         "light",   "lights",   "luminaire", "luminaires", "fixture",
                                         "leuchte", "leuchten", "lampen",    "armaturen",  "bracket" };
    for (size_t i = 0; i < NOC_COUNT(words); i++)
        if (!strcmp(word, words[i]))
            return true;
    return false;
}

/* "double acorn", "3 heads", "zweiflammig". */
static int heads_in_words(const tokens *t) {
    static const struct {
        const char *word;
        int heads;
        bool whole; /* needs no word behind it */
    } words[] = { { "double", 2, false },      { "twin", 2, false },       { "dual", 2, false },
                  { "triple", 3, false },      { "quad", 4, false },       { "doppel", 2, false },
                  { "dubbele", 2, false },     { "zweiflammig", 2, true }, { "dreiflammig", 3, true },
                  { "doppelleuchte", 2, true } };
    for (size_t i = 0; i < t->count; i++) {
        const token *w = &t->list[i];
        bool named = i + 1 < t->count && !t->list[i + 1].number && is_head_word(t->list[i + 1].word);
        if (w->number && named && !w->glued && within(w->value, 1, GEO_MAX_HEADS) && w->value == floor(w->value))
            return (int)w->value;
        for (size_t k = 0; k < NOC_COUNT(words) && !w->number; k++)
            if (!strcmp(w->word, words[k].word) && (named || words[k].whole))
                return words[k].heads;
    }
    return 0;
}

/* "LED -40W", "<100": a sign that is no dash. */
static bool is_signed(const char *text, const char *at) {
    const char *sign = at - 1;
    return at > text && strchr("-<>", *sign) && (*sign != '-' || sign == text || strchr(" \t(:=", sign[-1]));
}

/* Behind what a number that is not understood is a part of: "1000.5.2", "2019-05-01", "2x2x36". */
static const char *behind(const char *at) { return at + strspn(at, "0123456789.,/-:xX*@"); }

static size_t token_at(const tokens *t, size_t from, const char *end) {
    while (from < t->count && t->list[from].at < end)
        from++;
    return from;
}

/* "350mA", "0.35 A" of the LEDs. */
static bool is_current(const tokens *t, size_t i) {
    static const char *const words[] = { "ma", "milliamp", "milliamps", "milliampere" };
    bool is = false;
    for (size_t k = 0; k < NOC_COUNT(words) && i + 1 < t->count && t->list[i].number; k++)
        is = is || is_word(t, i + 1, words[k]);
    return is;
}

/* "48 LED 350mA", "64 LEDs", "LED 48 chips": how many diodes, which are no watts. next: the token behind the number. */
static bool is_diodes(const tokens *t, size_t next) {
    static const char *const words[] = { "leds", "chip", "chips", "diode", "diodes", "dioden", "module", "modules" };
    bool is = false, current = false;
    for (size_t i = 0; i < t->count; i++)
        current = current || is_current(t, i);
    for (size_t k = 0; k < NOC_COUNT(words); k++)
        is = is || is_word(t, next, words[k]);
    return is || (current && (next >= t->count || is_word(t, next, "led")));
}

/* "dimmed to 50%", "70 W, gedimmt". */
static bool is_dimmed_word(const char *word) {
    static const char *const words[] = { "dimmed", "dim",     "dimming",  "gedimmt",  "dimmt",
                                         "gedimd", "attenue", "atenuado", "dimmerato" };
    for (size_t i = 0; i < NOC_COUNT(words); i++)
        if (!strcmp(word, words[i]))
            return true;
    return false;
}

static bool is_share(const char *p) {
    p += strspn(p, "0123456789., ");
    return *p == '%' || !strncmp(p, "\xe2\x80\xb0", 3);
}

/* Watts of the numbers from i on. next: the token behind them. */
static void read_watts(const tokens *t, size_t i, size_t next, const lamp_number *n, bool watts_column, lamp_model *m) {
    const token *w = &t->list[i];
    int before = times_before(t, i);
    int times = n->times > 1 ? n->times : before ? before : n->unit ? times_behind(t, next) : 0;
    bool many = n->times > 1 || n->choice == LAMP_HEADS_EACH || within(w->value, 4, 1500);
    bool unit = n->unit && within(n->value, .5, LAMP_MOST_WATTS);
    bool diodes = !n->unit && m->source == GEO_SOURCE_LED && is_diodes(t, next);
    bool bare = !n->unit && !diodes && many && within(n->value, 4, 1500) && !is_word(t, next, "x") &&
                (watts_column || beside_source(t, i, next));
    m->diodes = m->diodes || diodes;
    if (unit && m->unit && !m->choice && fabs(n->value - m->watts) > .05 * m->watts)
        m->choice = LAMP_FIRST;
    if (!(unit && !m->unit) && !(bare && !isfinite(m->watts)))
        return;
    bool chips =
        times > GEO_MAX_HEADS || (m->source == GEO_SOURCE_LED && n->value < 4); /* "50 x LED 1W": of one head */
    m->watts = n->value * (chips && times ? times : 1);
    m->heads = chips ? 0 : times;
    m->terms = n->terms;
    m->bare = bare && m->source == GEO_SOURCE_LED && !watts_column;
    m->choice = n->choice;
    m->unit = unit;
    m->clear_unit = unit && (!strncmp(t->list[next - 1].word, "wat", 3) || next == t->count);
}

/* decimal: as in lamp_quantity. */
static void read_numbers(const tokens *t, const char *text, bool watts_column, char decimal, lamp_model *m) {
    bool tubes = m->source == GEO_SOURCE_FLUORESCENT || m->source == GEO_SOURCE_LED;
    const char *done = text;
    for (size_t i = 0; i < t->count; i++) {
        const token *one = &t->list[i];
        lamp_number n, w;
        m->share = m->share || (one->number && is_share(one->at));
        m->diodes = m->diodes || (m->source == GEO_SOURCE_LED && is_current(t, i));
        if (!one->number || one->at < done)
            continue;
        bool watts = lamp_scan_quantity(one->at, LAMP_WATTS, 1, decimal, &w);
        if (lamp_scan_quantity(one->at, LAMP_LUMENS, 1, decimal, &n) && n.unit) {
            bool first = !isfinite(m->lumens) && within(n.value, 50, LAMP_MOST_LUMENS);
            m->lumens = first ? n.value : m->lumens;
            m->lumens_choice = first ? n.choice : m->lumens_choice;
        } else if (lamp_scan_quantity(one->at, LAMP_KELVIN, 1, decimal, &n) && n.unit) {
            bool is = within(n.value, 1000, 20000);
            m->kelvin = is ? n.value : m->kelvin;
            m->kelvin_choice = is ? n.choice : m->kelvin_choice;
        } else if (!(watts && w.unit) && tubes && lamp_colour_code(one->value) > 0 && !isfinite(m->kelvin)) {
            m->kelvin = lamp_colour_code(one->value);
            continue;
        } else if (watts && !is_signed(text, one->at)) {
            n = w;
            read_watts(t, i, token_at(t, i, w.end), &w, watts_column, m);
        } else {
            n.end = behind(one->at);
        }
        done = n.end;
    }
}

/* A word that says nothing of the source where no other one does. */
static bool is_plain_word(const char *word) {
    static const char *const words[] = { "max",   "min",  "nominal", "rated",      "ca",  "circa",    "approx",
                                         "about", "each", "total",   "per",        "je",  "and",      "und",
                                         "or",    "oder", "with",    "mit",        "x",   "standard", "other",
                                         "of",    "the",  "is",      "electric",   "v",   "volt",     "volts",
                                         "vac",   "hz",   "a",       "pcs",        "stk", "stuck",    "to",
                                         "bis",   "tot",  "plus",    "equivalent", "et",  "ou" };
    double scale;
    const char *name;
    for (size_t i = 0; i < NOC_COUNT(words); i++)
        if (!strcmp(word, words[i]))
            return true;
    for (int unit = LAMP_METRES; unit < LAMP_PLAIN; unit++)
        if (lamp_unit_word(word, (lamp_unit)unit, &scale, &name))
            return true;
    return (strlen(word) > 2 && goes_with_source(word)) || is_head_word(word) || lamp_type_word(word) >= 0 ||
           lamp_mount_word(word) >= 0;
}

lamp_model lamp_model_of(const char *text, bool watts_column, char decimal) {
    tokens t;
    char folded[256], present[LAMP_PRESENT];
    lamp_model m = { .source = GEO_SOURCE_UNKNOWN, .watts = NAN, .lumens = NAN, .kelvin = NAN };
    text = lamp_present(text, present) ? present : text;
    split(text, decimal, &t);
    bool named = find_sources(&t);
    lamp_fold(text, true, folded, sizeof(folded));
    int source = lamp_source_word(folded);
    m.source = source < 0 ? GEO_SOURCE_UNKNOWN : source;
    m.unclear = source == LAMP_SOURCES_DIFFER;
    read_numbers(&t, text, watts_column, decimal, &m);
    if (!m.heads)
        m.heads = heads_in_words(&t);
    m.plain = named;
    for (size_t i = 0; i < t.count; i++) {
        const token *w = &t.list[i];
        m.clear = w->source ? NOC_MAX(m.clear, clearness(w->word)) : m.clear;
        m.dimmed = m.dimmed || (!w->number && is_dimmed_word(w->word));
        m.plain = m.plain && (w->number || w->source || goes_with_source(w->word));
        m.strange = m.strange || (source == -1 && !w->number && !is_plain_word(w->word));
    }
    return m;
}

bool lamp_model_stands_alone(const lamp_model *m) {
    bool watts = isfinite(m->watts) && within(m->watts, 4, 2000), source = m->source != GEO_SOURCE_UNKNOWN;
    if (watts && m->unit) /* "100 W Main Street" is no lamp's */
        return source || m->clear_unit;
    return source && ((m->clear == 2 && (m->plain || watts)) || (m->clear && watts && is_lamps_power(m->watts)));
}
