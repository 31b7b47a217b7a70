/* Values that were not understood, counted one by one: the five most frequent are told. */
#include "import/lamps/tags.h"

enum { TOLD = 5, MOST_VALUES = 4096, VALUE_SIZE = 48, FEWEST_IDS = 3 };

typedef struct value {
    const char *reason, *column, *text, *id; /* id: of the first lamp that has it */
    size_t count;
    bool told;
} value;

struct lamp_unread {
    noc_map index;
    NOC_ARRAY(value) values;
    noc_arena arena;
};

lamp_unread *lamp_unread_create(void) { return noc_calloc(1, sizeof(lamp_unread)); }

void lamp_unread_destroy(lamp_unread *u) {
    if (!u)
        return;
    map_free(&u->index);
    array_free(&u->values);
    arena_free(&u->arena);
    free(u);
}

/* On one line, and with no comma, which parts examples; without cutting a character. */
static void shorten(const char *text, char out[VALUE_SIZE]) {
    size_t n = 0;
    for (; text[n] && n + 4 < VALUE_SIZE; n++)
        out[n] = (unsigned char)text[n] < ' ' || text[n] == '"' ? ' ' : text[n];
    while (text[n] && n && ((unsigned char)text[n] & 0xc0) == 0x80)
        n--;
    strcpy(out + n, text[n] ? "..." : "");
}

bool lamp_unread_add(lamp_unread *u, const char *reason, const char *column, const char *text, const char *id) {
    char shown[VALUE_SIZE], key[VALUE_SIZE + 200];
    shorten(text, shown);
    noc_snprintf(key, sizeof(key), "%s\n%.100s\n%s", reason, column, u->values.len < MOST_VALUES ? shown : "");
    uint64_t at;
    if (!map_get(&u->index, key, &at)) {
        const value v = { .reason = reason,
                          .column = column,
                          .text = arena_strdup(&u->arena, u->values.len < MOST_VALUES ? shown : "..."),
                          .id = arena_strdup(&u->arena, id) };
        at = u->values.len;
        if (!v.text || !v.id || !array_reserve(&u->values, at + 1) || !map_put(&u->index, key, at, NULL))
            return false;
        u->values.data[u->values.len++] = v; /* the index names no value that is not there */
    }
    u->values.data[at].count++;
    return true;
}

void lamp_unread_drop_ids(lamp_unread *u, const char *column) {
    size_t values = 0, once = 0;
    for (size_t i = 0; i < u->values.len; i++) {
        values += !strcmp(u->values.data[i].column, column);
        once += !strcmp(u->values.data[i].column, column) && u->values.data[i].count == 1;
    }
    bool ids = values >= FEWEST_IDS && 10 * once >= 9 * values;
    for (size_t i = 0; i < u->values.len && ids; i++)
        u->values.data[i].told = u->values.data[i].told || !strcmp(u->values.data[i].column, column);
}

/* The most frequent one of a reason that is not told; of as many the first. NULL: all are. */
static value *next(lamp_unread *u, const char *reason) {
    value *best = NULL;
    for (size_t i = 0; i < u->values.len; i++) {
        value *v = &u->values.data[i];
        if (!v->told && !strcmp(v->reason, reason) && (!best || v->count > best->count))
            best = v;
    }
    return best;
}

static void tell(lamp_unread *u, const char *reason, geo_issues *issues) {
    char line[VALUE_SIZE + 140];
    value *v;
    size_t others = 0;
    for (int told = 0; told < TOLD && (v = next(u, reason)); told++) {
        noc_snprintf(line, sizeof(line), "%s: \"%s\"", reason, v->text);
        geo_issues_add(issues, GEO_GUESSED, line, v->count, v->id);
        v->told = true;
    }
    for (size_t i = 0; i < u->values.len; i++) {
        v = &u->values.data[i];
        bool mine = !v->told && !strcmp(v->reason, reason);
        others += mine ? v->count : 0;
        v->told = v->told || mine;
    }
    noc_snprintf(line, sizeof(line), "%s: other values", reason);
    geo_issues_add(issues, GEO_GUESSED, line, others, "");
}

void lamp_unread_tell(lamp_unread *u, geo_issues *issues) {
    for (size_t i = 0; i < u->values.len; i++)
        if (!u->values.data[i].told)
            tell(u, u->values.data[i].reason, issues);
}
