/* test-ROOM SUITE: the program of a room's tests. Each of its files is a suite, which has the file's name, and runs in
 * a process of its own. Without an argument it lists them. */
#include "test.h"
#undef main

test_suite *test_suites;

static bool is_named(const test_suite *suite, const char *name) {
    const char *slash = strrchr(suite->file, '/');
    const char *base = slash ? slash + 1 : suite->file;
    size_t length = strcspn(base, ".");
    return strlen(name) == length && !strncmp(base, name, length);
}

int main(int argc, char **argv) {
    for (const test_suite *suite = test_suites; suite; suite = suite->next)
        if (argc < 2)
            puts(suite->file);
        else if (is_named(suite, argv[1]))
            return suite->run();
    if (argc < 2)
        return 0;
    fprintf(stderr, "%s: no suite is named %s\n", argv[0], argv[1]);
    return 2;
}
