/* What a text says of the lamp that is there, where it speaks of another one, too: "HPS 70W replaced by LED 30W", "LED
 * ersetzt HQL 125W", "LED 30W (ex NAV 70)", "LED 40W (250W equivalent)". */
#include "import/lamps/tags.h"

#include <ctype.h>

enum { MOST_WORDS = 48, WORD = 24 };

typedef enum marker {
    NO_MARKER,
    FORMER_BEFORE, /* what is before it was */
    FORMER_BEHIND, /* what is behind it was, or will be, as far as the next bracket or comma */
    EQUIVALENT     /* the numbers beside it are of another lamp */
} marker;

typedef struct span {
    size_t from, end; /* in the text */
    char word[WORD];  /* folded */
} span;

typedef struct phrase {
    const char *text; /* folded */
    marker is;
    bool source; /* only where a source is named behind it: "was" */
} phrase;

/* The first that fits counts, so longer ones stand before what they begin with. */
static const phrase phrases[] = {
    { "to be replaced", FORMER_BEHIND, false },
    { "will be replaced", FORMER_BEHIND, false },
    { "wird ersetzt", FORMER_BEHIND, false },
    { "replaced by", FORMER_BEFORE, false },
    { "replaced with", FORMER_BEFORE, false },
    { "replaced", FORMER_BEFORE, false },
    { "converted to", FORMER_BEFORE, false },
    { "changed to", FORMER_BEFORE, false },
    { "upgraded to", FORMER_BEFORE, false },
    { "retrofitted to", FORMER_BEFORE, false },
    { "retrofitted with", FORMER_BEFORE, false },
    { "ersetzt durch", FORMER_BEFORE, false },
    { "ersetzt mit", FORMER_BEFORE, false },
    { "getauscht gegen", FORMER_BEFORE, false },
    { "ausgetauscht gegen", FORMER_BEFORE, false },
    { "umgerustet auf", FORMER_BEFORE, false },
    { "umgebaut auf", FORMER_BEFORE, false },
    { "umgestellt auf", FORMER_BEFORE, false },
    { "vervangen door", FORMER_BEFORE, false },
    { "remplace par", FORMER_BEFORE, false },
    { "remplacee par", FORMER_BEFORE, false },
    { "reemplazado por", FORMER_BEFORE, false },
    { "reemplazada por", FORMER_BEFORE, false },
    { "sustituido por", FORMER_BEFORE, false },
    { "sustituida por", FORMER_BEFORE, false },
    { "substituido por", FORMER_BEFORE, false },
    { "sostituito da", FORMER_BEFORE, false },
    { "sostituito con", FORMER_BEFORE, false },
    { "sostituita da", FORMER_BEFORE, false },
    { "now", FORMER_BEFORE, true },
    { "jetzt", FORMER_BEFORE, true },
    { "maintenant", FORMER_BEFORE, true },
    { "ahora", FORMER_BEFORE, true },
    { "adesso", FORMER_BEFORE, true },
    { "replaces", FORMER_BEHIND, false },
    { "replacing", FORMER_BEHIND, false },
    { "replacement for", FORMER_BEHIND, false },
    { "replacement of", FORMER_BEHIND, false },
    { "in place of", FORMER_BEHIND, false },
    { "instead of", FORMER_BEHIND, false },
    { "ersetzt", FORMER_BEHIND, false },
    { "ersatz fur", FORMER_BEHIND, false },
    { "anstelle", FORMER_BEHIND, false },
    { "anstatt", FORMER_BEHIND, false },
    { "statt", FORMER_BEHIND, false },
    { "vervangt", FORMER_BEHIND, false },
    { "in plaats van", FORMER_BEHIND, false },
    { "remplace", FORMER_BEHIND, false },
    { "remplacant", FORMER_BEHIND, false },
    { "au lieu de", FORMER_BEHIND, false },
    { "reemplaza", FORMER_BEHIND, false },
    { "sustituye", FORMER_BEHIND, false },
    { "en lugar de", FORMER_BEHIND, false },
    { "sostituisce", FORMER_BEHIND, false },
    { "al posto di", FORMER_BEHIND, false },
    { "formerly", FORMER_BEHIND, false },
    { "former", FORMER_BEHIND, false },
    { "previously", FORMER_BEHIND, false },
    { "fruher", FORMER_BEHIND, false },
    { "vorher", FORMER_BEHIND, false },
    { "ehemals", FORMER_BEHIND, false },
    { "ehem", FORMER_BEHIND, false },
    { "zuvor", FORMER_BEHIND, false },
    { "bisher", FORMER_BEHIND, false },
    { "vormals", FORMER_BEHIND, false },
    { "anciennement", FORMER_BEHIND, false },
    { "ancien", FORMER_BEHIND, false },
    { "ancienne", FORMER_BEHIND, false },
    { "voorheen", FORMER_BEHIND, false },
    { "anteriormente", FORMER_BEHIND, false },
    { "ex", FORMER_BEHIND, true },
    { "was", FORMER_BEHIND, true },
    { "before", FORMER_BEHIND, true },
    { "prima", FORMER_BEHIND, true },
    { "antes", FORMER_BEHIND, true },
    { "equivalent to", FORMER_BEHIND, false },
    { "equivalent a", FORMER_BEHIND, false },
    { "equivalente a", FORMER_BEHIND, false },
    { "aquivalent zu", FORMER_BEHIND, false },
    { "entspricht", FORMER_BEHIND, false },
    { "equivalent", EQUIVALENT, false },
    { "equivalents", EQUIVALENT, false },
    { "equivalente", EQUIVALENT, false },
    { "equiv", EQUIVALENT, false },
    { "aquivalent", EQUIVALENT, false },
    { "aequivalent", EQUIVALENT, false },
};

static bool is_letter(char c) { return isalpha((unsigned char)c) || (unsigned char)c >= 0x80; }

static size_t find_words(const char *text, span words[MOST_WORDS]) {
    size_t n = 0;
    for (size_t i = 0; text[i] && n < MOST_WORDS;) {
        span *w = &words[n];
        char copy[2 * WORD];
        if (!is_letter(text[i])) {
            i++;
            continue;
        }
        w->from = i;
        while (is_letter(text[i]))
            i++;
        w->end = i;
        noc_snprintf(copy, sizeof(copy), "%.*s", (int)NOC_MIN(i - w->from, sizeof(copy) - 1), text + w->from);
        n += lamp_fold(copy, false, w->word, WORD) > 0;
    }
    return n;
}

/* How many words the text has, if it begins at the first of these; 0: it does not. */
static size_t fits(const char *text, const span *words, size_t count) {
    size_t n = 0;
    for (const char *p = text;; n++) {
        size_t length = strcspn(p, " ");
        if (n == count || strlen(words[n].word) != length || memcmp(words[n].word, p, length) != 0)
            return 0;
        if (!p[length])
            return n + 1;
        p += length + 1;
    }
}

static void blank(char *text, size_t from, size_t end) { memset(text + from, ' ', end - from); }

static size_t boundary(const char *text, size_t from) { return from + strcspn(text + from, ",;()[]"); }

/* Is a source named in that part? */
static bool names_source(const char *text, size_t from, size_t end) {
    char part[128], folded[128];
    noc_snprintf(part, sizeof(part), "%.*s", (int)NOC_MIN(end - from, sizeof(part) - 1), text + from);
    lamp_fold(part, true, folded, sizeof(folded));
    return lamp_source_word(folded) != -1;
}

static bool says_something(const char *text, size_t from, size_t end) {
    for (size_t i = from; i < end; i++)
        if (is_letter(text[i]) || isdigit((unsigned char)text[i]))
            return true;
    return false;
}

static void blank_numbers(char *text, size_t at) {
    size_t from = at, end = boundary(text, at);
    while (from && !strchr(",;()[]", text[from - 1]))
        from--;
    for (size_t i = from; i < end; i++)
        text[i] = isdigit((unsigned char)text[i]) ? ' ' : text[i];
}

static bool apply(char *text, const phrase *p, size_t from, size_t end) {
    size_t stop = boundary(text, end);
    size_t near = text[end] == '-' ? end + 1 + strcspn(text + end + 1, " -,;()[]") : stop; /* "Ex-Leuchte LED" */
    if (p->source && !names_source(text, end, near))
        return false;
    if (p->is == EQUIVALENT)
        blank_numbers(text, from);
    else if (p->is == FORMER_BEFORE || !says_something(text, end, stop)) /* "HQL ersetzt": it was */
        blank(text, 0, end);
    else
        blank(text, from, stop);
    return true;
}

static bool apply_arrows(char *text) {
    static const char *const arrows[] = { "->", "=>", "\xe2\x86\x92", "\xe2\x87\x92" };
    bool any = false;
    for (size_t i = 0; i < NOC_COUNT(arrows); i++)
        for (char *at; (at = strstr(text, arrows[i])); any = true)
            blank(text, 0, (size_t)(at - text) + strlen(arrows[i]));
    return any;
}

bool lamp_present(const char *text, char present[LAMP_PRESENT]) {
    span words[MOST_WORDS];
    size_t length = strlen(text);
    if (length >= LAMP_PRESENT)
        return false;
    memcpy(present, text, length + 1);
    bool any = apply_arrows(present);
    size_t n = find_words(present, words);
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < NOC_COUNT(phrases); k++) {
            size_t count = *words[i].word == *phrases[k].text ? fits(phrases[k].text, words + i, n - i) : 0;
            if (!count || present[words[i].from] == ' ') /* none, or blanked already */
                continue;
            any = apply(present, &phrases[k], words[i].from, words[i + count - 1].end) || any;
            break;
        }
    return any;
}
