/* Files that another file names: materials of an OBJ, buffers of a glTF, the parts of a Shapefile. A file's author
 * decides these names, so they are looked at before anything is opened: no pipe may hang us, no link lead out of the
 * folder. */
#include "import/import.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <sys/stat.h>
#include <unistd.h>

/* Does path, with its links followed, lie in the folder (with a slash at its end, or "") or below it? */
static bool lies_below(const char *folder, const char *path) {
    char *in = realpath(*folder ? folder : ".", NULL), *real = realpath(path, NULL);
    size_t n = in ? strlen(in) : 0;
    n -= n == 1; /* "/" */
    bool below = in && real && !strncmp(real, in, n) && real[n] == '/';
    free(in);
    free(real);
    return below;
}

const char *import_named_trouble(const char *folder, const char *path, bool anywhere) {
    struct stat st;
    if (stat(path, &st))
        return strerror(errno);
    if (!S_ISREG(st.st_mode))
        return "is not a regular file";
    return anywhere || lies_below(folder, path)
               ? NULL
               : "lies outside the folder of the file that names it (--allow-outside lets it)";
}

static char *path_of(const char *folder, const char *name) {
    return noc_format("%s%s", *name == '/' ? "" : folder, name);
}

FILE *import_open_named(const char *folder, const char *name, bool anywhere, size_t *size, const char **why) {
    char *path = path_of(folder, name);
    struct stat st;
    int fd = -1;
    *why = NULL;
    if (!path)
        return NULL;
    *why = import_named_trouble(folder, path, anywhere);
    if (!*why && ((fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK)) < 0 || fstat(fd, &st)))
        *why = strerror(errno);
    else if (!*why && !S_ISREG(st.st_mode)) /* it was another file a moment ago */
        *why = "is not a regular file";
    free(path);
    FILE *f = *why ? NULL : fdopen(fd, "rb");
    if (f)
        *size = (size_t)st.st_size;
    else if (fd >= 0)
        close(fd);
    return f;
}

bool import_note_named(const import_listener *listener, const char *folder, const char *name) {
    struct stat st;
    if (!listener || !listener->on_named)
        return true;
    char *path = path_of(folder, name);
    if (path && !stat(path, &st) && S_ISREG(st.st_mode))
        listener->on_named(listener->user, path);
    free(path);
    return path != NULL;
}

void *import_read_named(const char *folder, const char *name, bool anywhere, size_t most,
                        const import_listener *listener, size_t *size, const char **why) {
    *why = NULL;
    if (!import_note_named(listener, folder, name))
        return NULL;
    FILE *f = import_open_named(folder, name, anywhere, size, why);
    void *data = NULL;
    if (f && *size > most) /* IMPORT_NAMED, for there is no other limit */
        *why = "is larger than 256 MB";
    else if (f)
        data = noc_alloc_large(*size + IMPORT_TAIL, 1);
    if (data && fread(data, 1, *size, f) != *size) {
        *why = ferror(f) ? strerror(errno) : "it got shorter while it was read";
        free(data);
        data = NULL;
    }
    if (f)
        fclose(f);
    return data;
}
