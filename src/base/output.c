/* Files that appear under their name only when they are complete. */
#include "base/output.h"
#include <nocturne/text.h>

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

static noc_status fail(const char *path, const char *what, noc_log *log) {
    return noc_error(log, NOC_ERR_IO, "%s: %s: %s", path, what, strerror(errno));
}

/* The target itself: what a symbolic link points to is replaced (or made, where it is not there yet), not the link.
 * NULL: memory was refused. */
static char *resolve(const char *path) {
    char *real = realpath(path, NULL);
    if (real)
        return real;
    char *at = noc_strdup(path), to[PATH_MAX];
    for (int links = 0; at && links < 40; links++) { /* as many as the kernel follows */
        ssize_t n = readlink(at, to, sizeof(to));
        if (n < 0 || n == sizeof(to))
            break;
        const char *slash = strrchr(at, '/');
        char *next = noc_format("%.*s%.*s", slash && to[0] != '/' ? (int)(slash + 1 - at) : 0, at, (int)n, to);
        free(at);
        at = next;
    }
    return at;
}

#define NAME_KEPT 200 /* A name may be 255 bytes at most: of a long one only the beginning is kept. */

/* Bytes of the target's folder, with its slash. */
static int folder_length(const char *target) {
    const char *slash = strrchr(target, '/');
    return slash ? (int)(slash + 1 - target) : 0;
}

/* ".name.pid-n.part" in the target's folder: renaming works only within a file system. */
static char *temporary_name(const char *target, int attempt) {
    int folder = folder_length(target);
    return noc_format("%.*s.%.*s.%ld-%d.part", folder, target, NAME_KEPT, target + folder, (long)getpid(), attempt);
}

/* Is it what temporary_name() makes of the target, for any process and attempt? */
static bool is_temporary(const char *name, const char *target) {
    const char *base = target + folder_length(target);
    size_t kept = strnlen(base, NAME_KEPT);
    if (name[0] != '.' || strncmp(name + 1, base, kept) || name[1 + kept] != '.')
        return false;
    const char *p = name + 2 + kept;
    size_t pid = strspn(p, "0123456789");
    if (!pid || p[pid] != '-')
        return false;
    p += pid + 1;
    size_t attempt = strspn(p, "0123456789");
    return attempt && !strcmp(p + attempt, ".part");
}

/* Removes what killed runs left of this target. A writer that lives holds a lock on its file. What is not removed now,
 * as memory is refused, is by the next writer. */
static void sweep(const char *target) {
    int length = folder_length(target);
    char *folder = noc_format("%.*s", length ? length : 1, length ? target : ".");
    DIR *dir = folder ? opendir(folder) : NULL;
    free(folder);
    for (struct dirent *e; dir && (e = readdir(dir));) {
        if (!is_temporary(e->d_name, target))
            continue;
        int fd = openat(dirfd(dir), e->d_name, O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
        struct stat st, named; /* the name may be that of its writer's next file by now */
        if (fd >= 0 && !fstat(fd, &st) && S_ISREG(st.st_mode) && !flock(fd, LOCK_EX | LOCK_NB) &&
            !fstatat(dirfd(dir), e->d_name, &named, AT_SYMLINK_NOFOLLOW) && named.st_dev == st.st_dev &&
            named.st_ino == st.st_ino)
            unlinkat(dirfd(dir), e->d_name, 0);
        if (fd >= 0)
            close(fd);
    }
    if (dir)
        closedir(dir);
}

/* Locks a new file; false where a sweep of another process took it in between. File systems without locks do without.
 */
static bool claim(int fd) {
    struct stat st;
    return (!flock(fd, LOCK_EX | LOCK_NB) || errno != EWOULDBLOCK) && !fstat(fd, &st) && st.st_nlink;
}

static void output_free(output *o) {
    free(o->path);
    free(o->target);
    free(o->temporary);
    memset(o, 0, sizeof(*o));
}

noc_status output_open(output *o, const char *path, noc_log *log) {
    *o = (output){ .path = noc_strdup(path), .target = resolve(path) };
    noc_status status;
    struct stat st;
    mode_t mode = 0666;
    int fd = -1;
    if (!o->path || !o->target) {
        status = noc_no_memory(log, path);
        goto fail;
    }
    /* A name that is too long, a ring of links: found now, not when the file is renamed. */
    if (lstat(o->target, &st) != 0 ? errno != ENOENT : S_ISLNK(st.st_mode) && (errno = ELOOP)) {
        status = fail(path, "cannot be written", log);
        goto fail;
    }
    /* Renaming would replace a device or a pipe by a plain file. */
    bool replaces = stat(o->target, &st) == 0;
    if (replaces && !S_ISREG(st.st_mode)) {
        status = noc_error(log, NOC_ERR_IO, "%s: cannot be written: %s", path,
                           S_ISDIR(st.st_mode) ? "it is a directory" : "it is not a regular file");
        goto fail;
    }
    if (replaces)
        mode = st.st_mode & 0777;
    sweep(o->target);
    for (int attempt = 0; fd < 0 && attempt < 1000; attempt++) {
        free(o->temporary);
        o->temporary = temporary_name(o->target, attempt);
        if (!o->temporary) {
            status = noc_no_memory(log, path);
            goto fail;
        }
        fd = open(o->temporary, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, mode);
        if (fd < 0 && errno != EEXIST)
            break;
        if (fd >= 0 && !claim(fd)) {
            close(fd);
            fd = -1;
        }
    }
    o->file = fd >= 0 ? fdopen(fd, "w+b") : NULL;
    if (o->file) {
        if (replaces) /* the umask may have taken some of it; a file system without modes keeps none */
            fchmod(fd, mode);
        return NOC_OK;
    }
    status = fail(path, "cannot be written", log);
    if (fd >= 0) {
        close(fd);
        unlink(o->temporary);
    }
fail:
    output_free(o);
    return status;
}

noc_status output_failed(output *o, noc_log *log) { return fail(o->path, "writing failed", log); }

noc_status output_close(output *o, noc_status status, noc_log *log) {
    /* It holds the lock until the file has its name: another writer of this target would sweep it away between. */
    int lock = fcntl(fileno(o->file), F_DUPFD_CLOEXEC, 0);
    /* What is still buffered may be what no longer fits on the disk. A name that is on the disk before the content is
     * would be an empty file after a power cut. EINVAL: the file system has nothing to write through. */
    if (status == NOC_OK &&
        (ferror(o->file) || fflush(o->file) != 0 || (fsync(fileno(o->file)) != 0 && errno != EINVAL)))
        status = output_failed(o, log);
    if (fclose(o->file) != 0 && status == NOC_OK)
        status = output_failed(o, log);
    if (status == NOC_OK && rename(o->temporary, o->target) != 0)
        status = fail(o->path, "cannot be written", log);
    if (status != NOC_OK)
        unlink(o->temporary);
    if (lock >= 0)
        close(lock);
    output_free(o);
    return status;
}

noc_status noc_text_save(const char *path, const char *text, size_t size, noc_log *log) {
    output o;
    if (!path || (size && !text))
        return noc_null(log, __func__);
    noc_status status = output_open(&o, path, log);
    if (status)
        return status;
    return output_close(&o, fwrite(text, 1, size, o.file) == size ? NOC_OK : output_failed(&o, log), log);
}
