/* Files and folders. */
#include "lab/file.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <sys/stat.h>
#include <unistd.h>

noc_status lab_io_error(noc_log *log, const char *path) {
    return noc_error(log, NOC_ERR_IO, "%.400s: %s", path, strerror(errno));
}

bool lab_parse_number(const char *text, double *out) {
    const char *word = text + (*text == '-');
    bool nan = !strcmp(word, "nan"), inf = !strcmp(word, "inf");
    if (nan || inf)
        *out = nan ? NAN : *text == '-' ? -INFINITY : INFINITY;
    return nan || inf || noc_parse_double(text, out);
}

FILE *lab_open_file(const char *path, noc_log *log) {
    struct stat st;
    int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK); /* a pipe is not waited for */
    FILE *file = fd >= 0 && !fstat(fd, &st) && S_ISREG(st.st_mode) ? fdopen(fd, "rb") : NULL;
    if (!file && fd >= 0)
        noc_error(log, NOC_ERR_IO, "%.400s: is not a regular file", path);
    else if (!file)
        lab_io_error(log, path);
    if (!file && fd >= 0)
        close(fd);
    return file;
}

noc_status lab_make_folder(const char *path, noc_log *log) {
    char *part = noc_strdup(path);
    if (!part)
        return noc_no_memory(log, path);
    bool failed = false;
    for (char *c = part + 1; *part && !failed; c++) {
        char end = *c;
        if (end && end != '/')
            continue;
        *c = 0;
        failed = mkdir(part, 0777) && errno != EEXIST && errno != EISDIR;
        *c = end;
        if (!end)
            break;
    }
    free(part);
    struct stat st;
    if (!failed && !stat(path, &st) && !S_ISDIR(st.st_mode)) {
        failed = true;
        errno = ENOTDIR;
    }
    if (failed || access(path, W_OK | X_OK))
        return noc_error(log, NOC_ERR_IO, "%.400s: this folder cannot be used: %s", path, strerror(errno));
    return NOC_OK;
}

noc_status lab_create_file(const char *folder, const char *name, noc_log *log, output *file) {
    char *path = noc_format("%s/%s", folder, name);
    noc_status status = path ? output_open(file, path, log) : noc_no_memory(log, name);
    free(path);
    return status;
}
