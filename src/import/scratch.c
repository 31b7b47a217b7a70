#include "import/scratch.h"

#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <stdio.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#define PREFIX "nocturne-scratch."
enum { RANDOM = 6 }; /* letters that mkdtemp chooses */

const char *scratch_place(void) {
    const char *folder = getenv("TMPDIR");
    return folder && *folder ? folder : "/tmp";
}

static int remove_one(const char *path, const struct stat *st, int kind, struct FTW *at) {
    remove(path);
    return 0;
}

static void remove_all(const char *path) { nftw(path, remove_one, 8, FTW_DEPTH | FTW_PHYS); }

/* Opens and locks a folder of this user; -1 where it is none, is gone, or another process holds it. */
static int lock_folder(const char *path) {
    int fd = open(path, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK);
    struct stat st;
    if (fd >= 0 && !fstat(fd, &st) && st.st_uid == geteuid() && !flock(fd, LOCK_EX | LOCK_NB) && !stat(path, &st))
        return fd;
    if (fd >= 0)
        close(fd);
    return -1;
}

static bool is_ours(const char *name) {
    size_t n = strlen(PREFIX);
    if (strncmp(name, PREFIX, n) || strlen(name) != n + RANDOM)
        return false;
    for (const char *p = name + n; *p; p++)
        if (!isalnum((unsigned char)*p))
            return false;
    return true;
}

/* What is not removed now, as memory is refused, is by the next run. */
static void sweep(void) {
    DIR *dir = opendir(scratch_place());
    for (struct dirent *e; dir && (e = readdir(dir));) {
        char *path = is_ours(e->d_name) ? noc_format("%s/%s", scratch_place(), e->d_name) : NULL;
        int fd = path ? lock_folder(path) : -1;
        if (fd >= 0) {
            remove_all(path);
            close(fd);
        }
        free(path);
    }
    if (dir)
        closedir(dir);
}

/* 0, or why it cannot be locked. File systems without locks do without. */
static int claim(scratch_folder *s) {
    struct stat st;
    s->lock = open(s->path, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    bool locked = s->lock >= 0 && (!flock(s->lock, LOCK_EX | LOCK_NB) || errno != EWOULDBLOCK);
    return locked && !stat(s->path, &st) ? 0 : errno;
}

/* A sweep took it between the making and the locking. */
static bool was_swept(int error) { return error == ENOENT || error == EWOULDBLOCK; }

noc_status scratch_make(scratch_folder *s, const char *name, noc_log *log) {
    *s = (scratch_folder){ .lock = -1 };
    sweep();
    for (int attempt = 0; attempt < 100; attempt++) {
        if (!(s->path = noc_format("%s/" PREFIX "XXXXXX", scratch_place())))
            return noc_no_memory(log, name);
        bool made = mkdtemp(s->path) != NULL;
        int error = made ? claim(s) : errno;
        if (!error)
            return NOC_OK;
        if (made)
            rmdir(s->path);
        if (s->lock >= 0)
            close(s->lock);
        free(s->path);
        *s = (scratch_folder){ .lock = -1 };
        if (!made || !was_swept(error))
            return noc_error(log, NOC_ERR_IO, "%s: no temporary folder in %s: %s", name, scratch_place(),
                             strerror(error));
    }
    return noc_error(log, NOC_ERR_IO, "%s: temporary folders in %s are taken away as they are made", name,
                     scratch_place());
}

void scratch_remove(scratch_folder *s) {
    if (!s->path)
        return;
    remove_all(s->path);
    if (s->lock >= 0)
        close(s->lock);
    free(s->path);
    *s = (scratch_folder){ .lock = -1 };
}
