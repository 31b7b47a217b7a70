/* What lies in a folder, for tests of what is left behind. */
#ifndef NOC_TEST_FILES_H
#define NOC_TEST_FILES_H

#include "test.h"

#include <dirent.h>

static inline size_t files_in(const char *folder) {
    DIR *dir = opendir(folder);
    size_t count = 0;
    assert_non_null(dir);
    for (struct dirent *e; (e = readdir(dir));)
        count += strcmp(e->d_name, ".") && strcmp(e->d_name, "..");
    closedir(dir);
    return count;
}

#endif
