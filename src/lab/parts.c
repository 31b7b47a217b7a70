/* Processes that share a spec: each has a table of its own, results.part-2-of-3.csv, and reads those of the others. Who
 * ends last makes results.csv of them. Locks are the system's: they end with the process that has them. */
#include "lab/parts.h"
#include "lab/file.h"
#include "lab/table.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#define PREFIX "results.part-"
#define TICK 50 /* ms between looks at a lock */

static bool is_part(const char *name) {
    size_t n = strlen(name), ending = strlen(".csv");
    return !strncmp(name, PREFIX, strlen(PREFIX)) && n > ending && !strcmp(name + n - ending, ".csv");
}

/* Opened and locked; -1 with errno set, EWOULDBLOCK where another process has it. */
static int open_locked(const char *path, int flags) {
    int fd = open(path, O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK | flags, 0666);
    if (fd < 0 || !flock(fd, LOCK_EX | LOCK_NB) || errno != EWOULDBLOCK)
        return fd;
    close(fd);
    errno = EWOULDBLOCK;
    return -1;
}

int lab_wait_for(lab_session *lab, const char *path, const char *what) {
    int fd = -1;
    bool going = true, waits = false;
    while (going && (fd = open_locked(path, O_CREAT)) < 0 && errno == EWOULDBLOCK) {
        if (!waits && what)
            lab_note(lab, "%s: waiting for another process, which makes it", what);
        waits = true;
        going = lab_go_on(lab, &(noc_lab_progress){ NOC_LAB_LOADING, 0, -1, "waiting for another process", 0, 0 });
        usleep(TICK * 1000);
    }
    if (waits)
        lab_go_on(lab, &(noc_lab_progress){ NOC_LAB_LOADING, 1, -1, NULL, 0, 0 });
    return fd;
}

bool lab_is_mine(const lab_session *lab, const lab_run *run) {
    size_t i = (size_t)(run - lab->runs), parts = (size_t)lab->params.parts;
    return parts < 2 || i * parts / lab->run_count == (size_t)lab->params.part - 1;
}

/* Tables of parts are few, and there are as many names. */
typedef struct names {
    NOC_ARRAY(char *) all;
} names;

static void free_names(names *n) {
    for (size_t i = 0; i < n->all.len; i++)
        free(n->all.data[i]);
    array_free(&n->all);
}

static int by_name(const void *a, const void *b) { return strcmp(*(char *const *)a, *(char *const *)b); }

/* Sorted, so that rows come in the same order on every file system. */
static noc_status list_parts(const lab_session *lab, names *n) {
    noc_status status = NOC_OK;
    *n = (names){ 0 };
    DIR *dir = opendir(lab->folder);
    for (struct dirent *e; dir && !status && (e = readdir(dir));) {
        char *path = is_part(e->d_name) ? noc_format("%s/%s", lab->folder, e->d_name) : NULL;
        if (is_part(e->d_name) && (!path || !array_push(&n->all, path))) {
            free(path);
            status = noc_no_memory(lab->log, lab->folder);
        }
    }
    if (!dir)
        return lab_io_error(lab->log, lab->folder);
    closedir(dir);
    if (n->all.len)
        qsort(n->all.data, n->all.len, sizeof(*n->all.data), by_name);
    return status;
}

static noc_status read_others(lab_session *lab, const char *mine) {
    names n;
    long whole;
    char *joined = noc_format("%s/results.csv", lab->folder);
    noc_status status = joined ? lab_read_table(lab, joined, &whole) : noc_no_memory(lab->log, lab->folder);
    free(joined);
    status = status ? status : list_parts(lab, &n);
    if (status)
        return status;
    for (size_t i = 0; i < n.all.len && !status; i++)
        if (strcmp(n.all.data[i], mine))
            status = lab_read_table(lab, n.all.data[i], &whole);
    free_names(&n);
    return status;
}

static noc_status open_mine(lab_session *lab, const char *path) {
    long whole = 0;
    int fd = open_locked(path, O_CREAT);
    if (fd < 0 && errno == EWOULDBLOCK)
        return noc_error(lab->log, NOC_ERR_IO, "%s: another process is part %d of %d there", lab->folder,
                         lab->params.part, lab->params.parts);
    if (fd < 0)
        return lab_io_error(lab->log, path);
    lab->part_lock = fd;
    noc_status status = lab_read_table(lab, path, &whole);
    if (!status && whole < 0)
        status = noc_error(lab->log, NOC_ERR_FORMAT, "%s is a table of another kind or version: remove it", path);
    return status ? status : lab_open_rows(lab, path, whole);
}

noc_status lab_open_part(lab_session *lab) {
    char *path = noc_format("%s/" PREFIX "%d-of-%d.csv", lab->folder, lab->params.part, lab->params.parts);
    noc_status status = path ? open_mine(lab, path) : noc_no_memory(lab->log, lab->folder);
    status = status ? status : read_others(lab, path);
    free(path);
    return status;
}

noc_status lab_take_parts(lab_session *lab, bool *busy) {
    names n;
    *busy = false;
    noc_status status = list_parts(lab, &n);
    for (size_t i = 0; i < n.all.len && !status && !*busy; i++) {
        long whole = 0;
        int fd = open_locked(n.all.data[i], 0);
        *busy = fd < 0 && errno == EWOULDBLOCK;
        lab_part part = { fd, n.all.data[i] };
        if (*busy)
            break;
        if (fd < 0)
            status = lab_io_error(lab->log, part.path);
        else if (!array_push(&lab->taken, part))
            status = noc_no_memory(lab->log, part.path);
        else
            n.all.data[i] = NULL; /* it is the session's */
        if (status && fd >= 0)
            close(fd);
        status = status ? status : lab_read_table(lab, part.path, &whole);
        if (!status && whole < 0)
            status =
                noc_error(lab->log, NOC_ERR_FORMAT, "%s is a table of another kind or version: remove it", part.path);
    }
    free_names(&n);
    if (*busy || status)
        lab_release_parts(lab);
    return status;
}

noc_status lab_remove_parts(lab_session *lab, bool keep) {
    noc_status status = NOC_OK;
    for (size_t i = 0; i < lab->taken.len && !status; i++) {
        const char *path = lab->taken.data[i].path;
        char *old = keep ? lab_old_name(lab) : NULL;
        if (keep && !old)
            status = NOC_ERR_MEMORY;
        else if (keep ? rename(path, old) : unlink(path))
            status = lab_io_error(lab->log, path);
        free(old);
    }
    lab_release_parts(lab);
    return status;
}

void lab_release_parts(lab_session *lab) {
    for (size_t i = 0; i < lab->taken.len; i++) {
        close(lab->taken.data[i].lock);
        free(lab->taken.data[i].path);
    }
    array_free(&lab->taken);
}
