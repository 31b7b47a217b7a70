/* What a log was told, as lines of one text: `keep` is its message. */
#ifndef NOC_TEST_TOLD_H
#define NOC_TEST_TOLD_H

#include "test.h"

#include <nocturne/nocturne.h>

static char told[4000];

/* Errors and warnings. */
static inline void keep(void *user, noc_log_level level, const char *text) {
    size_t n = strlen(told);
    (void)user;
    if (level <= NOC_LOG_WARN)
        snprintf(told + n, sizeof(told) - n, "%s\n", text);
}

#endif
