/* The library's side: starts the helper, listens to it, and ends it. */
#include "import/remote/remote.h"
#include "import/scratch.h"

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdatomic.h>
#include <stdio.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#define HELPER "nocturne-reader"
#define HELPER_VARIABLE "NOCTURNE_READER"
#define TICK 0.05 /* s between looks at the clock */
#define GRACE 3   /* s that the helper has to end once it has hung up */

extern char **environ;

typedef struct remote {
    const noc_reader *reader;
    const char *path;
    const noc_import_params *params;
    geo_sink *sink;
    remote_taker from;
    char *program;
    scratch_folder scratch;
    int fd;
    pid_t pid;
    uint64_t received;
    double memory; /* bytes that the file may take */
    double started, ticked;
} remote;

/* ---- starting it ---- */

/* Where NOCTURNE_READER says; else beside the library, or in a folder nocturne there. */
static noc_status find_program(remote *r) {
    static const char *const below[] = { "/nocturne/" HELPER, "/" HELPER };
    const char *given = secure_getenv(HELPER_VARIABLE);
    Dl_info info;
    if (given && *given) {
        if (access(given, X_OK))
            return noc_error(r->sink->log, NOC_ERR_UNSUPPORTED,
                             "%s: %s is read by a helper program, and " HELPER_VARIABLE " names none (%s)", r->path,
                             r->reader->name, given);
        r->program = noc_strdup(given);
        return r->program ? NOC_OK : noc_no_memory(r->sink->log, r->path);
    }
    char *real = dladdr((void *)&remote_read, &info) && info.dli_fname ? realpath(info.dli_fname, NULL) : NULL;
    char *slash = real ? strrchr(real, '/') : NULL;
    noc_status status = NOC_OK;
    if (slash)
        *slash = 0;
    for (size_t i = 0; i < NOC_COUNT(below) && slash && !status && !r->program; i++) {
        if (!(r->program = noc_format("%s%s", real, below[i]))) {
            status = noc_no_memory(r->sink->log, r->path);
        } else if (access(r->program, X_OK)) {
            free(r->program);
            r->program = NULL;
        }
    }
    const char *folder = slash ? real : "?";
    if (!status && !r->program)
        status = noc_error(r->sink->log, NOC_ERR_UNSUPPORTED,
                           "%s: %s is read by the helper program " HELPER
                           ", which is not in %s or %s/nocturne: install it, name it in " HELPER_VARIABLE
                           ", or read in this process (--no-isolate)",
                           r->path, r->reader->name, folder, folder);
    free(real);
    return status;
}

/* What the helper's libraries are found by, and read by; nothing else, as there may be secrets. A name that ends in *
 * is the beginning of some. */
static const char *const kept_variables[] = { "GDAL_DATA",
                                              "GDAL_DRIVER_PATH",
                                              "GLIBC_TUNABLES",
                                              "LANG",
                                              "LC_*",
                                              "LD_*",
                                              "LOCPATH",
                                              "OGR_DRIVER_PATH",
                                              "OGR_GEOJSON_MAX_OBJ_SIZE",
                                              "OSM_MAX_TMPFILE_SIZE",
                                              "PROJ_DATA",
                                              "PROJ_LIB",
                                              "SHAPE_ENCODING",
                                              "TZ",
                                              "TZDIR",
                                              "ASAN_OPTIONS",
                                              "LSAN_OPTIONS",
                                              "TSAN_OPTIONS",
                                              "UBSAN_OPTIONS" };

static bool is_kept(const char *variable) {
    for (size_t i = 0; i < NOC_COUNT(kept_variables); i++) {
        const char *name = kept_variables[i];
        size_t n = strcspn(name, "*");
        if (!strncmp(variable, name, n) && (name[n] || variable[n] == '='))
            return true;
    }
    return false;
}

/* With TMPDIR in the scratch folder, so that whatever the helper leaves goes with it, and libraries kept from starting
 * threads as they are loaded. NULL: memory was refused. */
static char **make_environment(const char *scratch, char **own) {
    static const char *const single[] = { "OMP_NUM_THREADS=1", "OPENBLAS_NUM_THREADS=1" };
    size_t n = 0, kept = 0;
    while (environ[n])
        n++;
    char **list = noc_calloc(n + NOC_COUNT(single) + 2, sizeof(*list));
    *own = noc_format("TMPDIR=%s", scratch);
    if (!list || !*own) {
        free(list);
        free(*own);
        return NULL;
    }
    for (size_t i = 0; i < n; i++)
        if (is_kept(environ[i]))
            list[kept++] = environ[i];
    for (size_t i = 0; i < NOC_COUNT(single); i++)
        list[kept++] = (char *)single[i];
    list[kept] = *own;
    return list;
}

/* No code of ours runs between fork and exec: the host may have threads. Signals of its terminal do not reach the
 * helper. */
static int spawn(remote *r, int end) {
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    sigset_t none, all;
    char *own, **environment = make_environment(r->scratch.path, &own), *arguments[] = { (char *)HELPER, NULL };
    if (!environment)
        return ENOMEM;
    sigemptyset(&none);
    sigfillset(&all);
    posix_spawn_file_actions_init(&actions);
    posix_spawnattr_init(&attributes);
    posix_spawn_file_actions_adddup2(&actions, end, REMOTE_FD);
    posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
#ifndef REMOTE_SANITIZED /* whose reports go to stderr */
    posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", O_WRONLY, 0);
#endif
    posix_spawn_file_actions_addclosefrom_np(&actions, REMOTE_FD + 1);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
    posix_spawnattr_setpgroup(&attributes, 0);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setsigdefault(&attributes, &all);
    int error = posix_spawn(&r->pid, r->program, &actions, &attributes, arguments, environment);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    free(own);
    free(environment);
    return error;
}

static noc_status ended_early(remote *r);

static noc_status start(remote *r) {
    int ends[2];
    noc_status status = find_program(r);
    if (status)
        return status;
    if ((status = scratch_make(&r->scratch, r->path, r->sink->log)))
        return status;
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends))
        return noc_error(r->sink->log, NOC_ERR_IO, "%s: no socket to read it by: %s", r->path, strerror(errno));
    r->fd = ends[0];
    int error = spawn(r, ends[1]);
    close(ends[1]);
    if (error == ENOMEM)
        return noc_no_memory(r->sink->log, r->path);
    if (error)
        return noc_error(r->sink->log, NOC_ERR_IO, "%s: %s cannot be started: %s", r->path, r->program,
                         strerror(error));
    remote_record request = { 0 };
    remote_ask(&request, r->reader, r->path, r->params, r->sink);
    bool sent = !request.refused && remote_send(r->fd, &request);
    array_free(&request.bytes);
    if (request.refused)
        return noc_no_memory(r->sink->log, r->path);
    if (sent)
        return NOC_OK;
    kill(r->pid, SIGTERM); /* it does not listen; why it ended, if it did, is told */
    return ended_early(r);
}

/* ---- until the end ---- */

static noc_status out_of_time(const remote *r) {
    return noc_error(r->sink->log, NOC_ERR_UNSUPPORTED,
                     "%s: it is still being read after %g s, which is the limit --reader-time", r->path,
                     r->params->reader_time);
}

static noc_status look_at_clock(remote *r) {
    double now = noc_wall_seconds();
    if (now - r->ticked < TICK)
        return NOC_OK;
    r->ticked = now;
    if (r->sink->progress && !r->sink->progress(r->sink->ctx, r->from.done))
        return NOC_ERR_CANCELLED;
    return now - r->started > r->params->reader_time ? out_of_time(r) : NOC_OK;
}

/* Until it has ended, whose way is then told in *how (-1: unknown). One that hangs up and stays is an error, as is one
 * that outlives its time; finish() ends it. */
static noc_status wait_for_end(remote *r, int *how) {
    double until = noc_wall_seconds() + GRACE;
    noc_status status = NOC_OK;
    *how = -1;
    while (!status) {
        pid_t got = waitpid(r->pid, how, WNOHANG);
        if (got == r->pid || (got < 0 && errno != EINTR)) {
            r->pid = 0;
            return NOC_OK;
        }
        status = look_at_clock(r);
        if (!status && noc_wall_seconds() > until)
            status = noc_error(r->sink->log, NOC_ERR_IO, "%s: the process that reads it hung up and did not end (%s)",
                               r->path, r->program);
        if (!status)
            poll(NULL, 0, 1);
    }
    return status;
}

/* It hung up without a last word. */
static noc_status ended_early(remote *r) {
    int how;
    noc_status status = wait_for_end(r, &how);
    bool got = how != -1;
    if (status)
        return status;
    if (got && WIFSIGNALED(how) && WTERMSIG(how) == SIGXCPU)
        return out_of_time(r);
    if (got && WIFEXITED(how) && WEXITSTATUS(how) == REMOTE_NO_MEMORY)
        return noc_error(r->sink->log, NOC_ERR_MEMORY,
                         "%s: the process that reads it needs more than the limit --max-memory, %.3g GB", r->path,
                         r->memory / 1e9);
    if (got && WIFSIGNALED(how) && WTERMSIG(how) != SIGKILL)
        return noc_error(r->sink->log, NOC_ERR_FORMAT,
                         "%s: the process that reads it as %s ended by signal %d (%s): the file is broken, "
                         "or needs more than the limit --max-memory, %.3g GB",
                         r->path, r->reader->name, WTERMSIG(how), strsignal(WTERMSIG(how)), r->memory / 1e9);
    return noc_error(r->sink->log, NOC_ERR_IO,
                     "%s: the process that reads it was ended from outside, or could not run (%s)", r->path,
                     r->program);
}

static noc_status receive(remote *r) {
    enum { CHUNK = 1 << 18 };
    char *room = remote_room(&r->from, CHUNK);
    if (!room)
        return NOC_ERR_MEMORY;
    ssize_t n = recv(r->fd, room, CHUNK, MSG_DONTWAIT);
    if (n < 0 && (errno == EINTR || errno == EAGAIN))
        return NOC_OK;
    if (n <= 0)
        return ended_early(r);
    r->from.bytes.len += (size_t)n;
    r->received += (uint64_t)n;
    if ((double)r->received > r->memory)
        return noc_error(r->sink->log, NOC_ERR_MEMORY, "%s: it holds more than the limit --max-memory, %.3g GB",
                         r->path, r->memory / 1e9);
    noc_status status = NOC_OK;
    while (!status && remote_take(&r->from, &status)) /* a small record may take long: a coordinate system of its own */
        status = status ? status : look_at_clock(r);
    return status;
}

static noc_status listen_to(remote *r) {
    noc_status status = NOC_OK;
    while (!status && !r->from.ended) {
        struct pollfd p = { .fd = r->fd, .events = POLLIN };
        int ready = poll(&p, 1, (int)(1000 * TICK));
        status = look_at_clock(r);
        if (!status && ready > 0)
            status = receive(r);
    }
    return status;
}

/* After its last word, too: it need not go by itself. The keeper takes along what it has started; it is not asked
 * twice. */
static void end(remote *r) {
    double until = noc_wall_seconds() + GRACE;
    pid_t got = 0;
    kill(r->pid, SIGTERM);
    for (int pause = 0; (!got || (got < 0 && errno == EINTR)) && noc_wall_seconds() < until; pause = 1) {
        poll(NULL, 0, pause);
        got = waitpid(r->pid, NULL, WNOHANG);
    }
    if (got)
        return;
    kill(r->pid, SIGKILL);
    while (waitpid(r->pid, NULL, 0) < 0 && errno == EINTR)
        continue;
}

static void finish(remote *r) {
    if (r->pid > 0)
        end(r);
    if (r->fd >= 0)
        close(r->fd);
    scratch_remove(&r->scratch);
    free(r->program);
    remote_taker_free(&r->from);
}

noc_status remote_read(const noc_reader *reader, const char *path, const noc_import_params *params, geo_sink *sink,
                       const mesh_parts *parts, const import_listener *listener, remote_result *result) {
    remote r = { .reader = reader,
                 .path = path,
                 .params = params,
                 .sink = sink,
                 .fd = -1,
                 .memory = import_budget_of(params).memory,
                 .started = noc_wall_seconds(),
                 .from = { .path = path, .sink = sink, .parts = parts, .listener = listener, .result = result } };
    static atomic_bool told;
    *result = (remote_result){ 0 };
    if (!atomic_exchange(&told, true)) {
        noc_info(sink->log, "files of other people's formats are read in %s", noc_isolation());
        if (remote_short_of_fences())
            noc_warn(sink->log, "%s (docs/formats.md)", remote_short_of_fences());
    }
    noc_status status = start(&r);
    if (!status)
        status = listen_to(&r);
    finish(&r);
    return status;
}
