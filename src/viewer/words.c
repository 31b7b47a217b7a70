/* Words of a command line, and a line of them that a shell takes apart again. */
#include "viewer/words.h"

#include <stdlib.h>
#include <string.h>

void words_add(words *list, const char *text) {
    if (list->count == list->room) {
        size_t room = list->room ? 2 * list->room : 32;
        char **more = realloc(list->word, room * sizeof(*more));
        list->refused = list->refused || !more;
        if (!more)
            return;
        list->word = more;
        list->room = room;
    }
    char *copy = strdup(text);
    list->refused = list->refused || !copy;
    if (copy)
        list->word[list->count++] = copy;
}

static char *value_of(const noc_option *o, const void *params) {
    int length = noc_option_get(o, params, NULL, 0);
    char *text = length >= 0 ? malloc((size_t)length + 1) : NULL;
    if (text)
        noc_option_get(o, params, text, (size_t)length + 1);
    return text;
}

static void add_pair(words *list, const char *name, const char *value) {
    char flag[120] = "--";
    strncat(flag, name, sizeof(flag) - 3);
    words_add(list, flag);
    if (value)
        words_add(list, value);
}

void words_option(words *list, const noc_option *o, const void *params, const void *before) {
    if (o->kind == NOC_OPTION_TEXTS) {
        const noc_texts *texts = (const noc_texts *)(const void *)((const char *)params + o->offset);
        for (size_t i = 0; i < texts->count; i++)
            add_pair(list, o->name, texts->text[i]);
        return;
    }
    char *now = value_of(o, params), *was = before ? value_of(o, before) : NULL, no[100] = "no-";
    list->refused = list->refused || !now || (before && !was);
    bool is_switch = o->kind == NOC_OPTION_BOOL || o->kind == NOC_OPTION_SWITCH;
    if (now && (!before || (was && strcmp(now, was)))) {
        strncat(no, o->name, sizeof(no) - 4);
        if (is_switch && strcmp(now, "auto"))
            add_pair(list, strcmp(now, "true") ? no : o->name, NULL);
        else if (*now)
            add_pair(list, o->name, now);
    }
    free(now);
    free(was);
}

char **words_take(words *list, size_t *count) {
    if (list->refused || (!list->word && !(list->word = calloc(1, sizeof(*list->word))))) {
        words_free(list->word, list->count);
        list->count = 0;
        *count = 0;
        return NULL;
    }
    *count = list->count;
    return list->word;
}

void words_free(char **list, size_t count) {
    for (size_t i = 0; i < count; i++)
        free(list[i]);
    free(list);
}

static bool is_plain(const char *word) {
    return *word &&
           strspn(word, "0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ-_./:,=+@%") == strlen(word);
}

char *words_line(char *const *list, size_t count) {
    size_t size = 1;
    for (size_t i = 0; i < count; i++)
        size += 4 * strlen(list[i]) + 3;
    char *line = malloc(size), *at = line;
    if (!line)
        return NULL;
    for (size_t i = 0; i < count; i++) {
        bool plain = is_plain(list[i]);
        if (i)
            *at++ = ' ';
        if (!plain)
            *at++ = '\'';
        for (const char *c = list[i]; *c; c++) {
            if (!plain && *c == '\'') {
                memcpy(at, "'\\''", 4);
                at += 4;
            } else {
                *at++ = *c;
            }
        }
        if (!plain)
            *at++ = '\'';
    }
    *at = 0;
    return line;
}
