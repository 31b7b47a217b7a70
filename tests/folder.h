/* Files of a test, in a folder of its own. Includers say its name before this: static char folder[] = "/tmp/...XXXXXX",
 * which mkdtemp makes a folder of. */
#ifndef NOC_TEST_FOLDER_H
#define NOC_TEST_FOLDER_H

#include "test.h"

#include <stdio.h>

/* The last eight names hold. */
static inline const char *in_folder(const char *name) {
    static char paths[8][300];
    static int next;
    char *path = paths[next++ % 8];
    snprintf(path, sizeof(paths[0]), "%s/%s", folder, name);
    return path;
}

static inline const char *write_file(const char *name, const char *text) {
    const char *path = in_folder(name);
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    assert_true(fputs(text, f) >= 0 && !fclose(f));
    return path;
}

static inline int remove_folder(void) {
    char command[100];
    snprintf(command, sizeof(command), "rm -r %s", folder);
    return system(command);
}

#endif
