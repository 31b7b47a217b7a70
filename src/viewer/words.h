/* words: a list of words of a command line that grows. */
#ifndef NOC_VIEWER_WORDS_H
#define NOC_VIEWER_WORDS_H

#include <nocturne/nocturne.h>

typedef struct words {
    char **word;
    size_t count, room;
    bool refused; /* memory */
} words;

void words_add(words *list, const char *text); /* copied */
/* What says the option as params have it: "--name" and its value, "--no-name". Nothing where `before` has the same;
 * NULL: always. */
void words_option(words *list, const noc_option *o, const void *params, const void *before);
/* The list, which is the caller's with each of its words. NULL: memory was refused. */
char **words_take(words *list, size_t *count);
void words_free(char **list, size_t count);
/* One line for a POSIX shell, which the caller frees: words are quoted where they need it. NULL: no memory. */
char *words_line(char *const *list, size_t count);

#endif
