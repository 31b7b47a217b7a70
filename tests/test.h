/* What every test includes. */
#ifndef NOC_TEST_H
#define NOC_TEST_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
/* after the standard headers */
#include <cmocka.h>

/* One program a room holds the suites of its files (tests/main.c). There `int main(void)` of a file is no program's,
 * and enters the suite. Files of one program must not share names that are not static. */
#ifdef TEST_ROOM
typedef struct test_suite {
    const char *file;
    int (*run)(void);
    struct test_suite *next;
} test_suite;
extern test_suite *test_suites;

/* What stands before it, `int`, declares a function that is nowhere. */
#define main(none)                                                                                                     \
    test_no_main(none);                                                                                                \
    static int test_suite_main(none);                                                                                  \
    __attribute__((constructor)) static void test_suite_enter(void) {                                                  \
        static test_suite suite = { __FILE__, test_suite_main, NULL };                                                 \
        suite.next = test_suites;                                                                                      \
        test_suites = &suite;                                                                                          \
    }                                                                                                                  \
    static int test_suite_main(none)
#endif

/* cmocka 1.1 reports a skipped test as "not ok # SKIP", which Meson counts as failed. All uses are in the test's own
 * function. */
#undef skip
#define skip() return

/* Sanitizers look for faults that a few samples show as well, and `make coverage` for lines; what many samples have for
 * a mean, the build without them says. */
#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define ADDRESS_SANITIZED 1
#elif __has_feature(thread_sanitizer)
#define SANITIZED 1
#endif
#elif defined(__SANITIZE_ADDRESS__)
#define ADDRESS_SANITIZED 1
#elif defined(__SANITIZE_THREAD__)
#define SANITIZED 1
#endif
#ifndef ADDRESS_SANITIZED
#define ADDRESS_SANITIZED 0
#endif
#if !defined(SANITIZED) && (ADDRESS_SANITIZED || defined(FEW_SAMPLES))
#define SANITIZED 1
#endif
#ifndef SANITIZED
#define SANITIZED 0
#endif

/* The quick suite takes an eighth of the samples, and judges by the same number of standard errors. NOC_SUITE=quick:N
 * is the Nth of several runs, of which one in SUITE_TURNS takes all samples of this file. */
enum { QUICK_SHARE = 8, SUITE_TURNS = 3 };
static inline bool is_quick(void) {
    const char *suite = getenv("NOC_SUITE"), *slash = strrchr(__BASE_FILE__, '/');
    unsigned long mine = 0;
    if (!suite || strncmp(suite, "quick", 5))
        return false;
    for (const char *c = slash ? slash + 1 : __BASE_FILE__; *c; c++)
        mine = 31 * mine + (unsigned char)*c;
    return suite[5] != ':' || mine % SUITE_TURNS != strtoul(suite + 6, NULL, 10) % SUITE_TURNS;
}

/* How many of `n` samples to take where an eighth would miss what is rare; under sanitizers their mean is not judged.
 */
static inline int all_samples(int n) { return SANITIZED ? (n + 49) / 50 : n; }
static inline int samples(int n) {
    return SANITIZED || !is_quick() ? all_samples(n) : (n + QUICK_SHARE - 1) / QUICK_SHARE;
}

/* How far a mean may lie from what it should be, `e` for all samples, where samples() were taken. */
static inline double slack(double e) { return is_quick() ? e * sqrt(QUICK_SHARE) : e; }

/* Path of a file below shared/ (real data), or NULL where it is absent: then the test skips, saying so. */
static inline const char *shared_path(const char *relative) {
    static char path[4096];
    const char *shared = getenv("NOC_SHARED");
    if (!shared)
        return NULL;
    snprintf(path, sizeof(path), "%s/%s", shared, relative);
    return access(path, R_OK) ? NULL : path;
}

#define REQUIRE_SHARED(var, relative)                                                                                  \
    const char *var = shared_path(relative);                                                                           \
    if (!var) {                                                                                                        \
        print_message("# skipped: shared/%s is not here\n", relative);                                                 \
        skip();                                                                                                        \
    }

#endif
