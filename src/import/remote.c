/* The library's side: starts the helper, listens to it, and ends it. */
#include "import/remote.h"
#include "import/map_parts.h"

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <math.h>
#include <nocturne/option.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <sys/stat.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#define HELPER "nocturne-reader"
#define HELPER_VARIABLE "NOCTURNE_READER"
#define TICK 0.05 /* s between looks at the clock */

extern char **environ;

typedef struct remote {
    const noc_reader *reader;
    const char *path;
    const noc_import_params *params;
    geo_sink *sink;
    const mesh_parts *parts;
    remote_result *result;
    char *program, *scratch;
    int fd;
    pid_t pid;
    NOC_ARRAY(char) bytes;   /* that came and are not taken apart yet, from pos on */
    size_t pos;
    uint64_t received;
    double started, ticked, done;
    bool ended;
    NOC_ARRAY(int) materials; /* as the scene numbers them */
} remote;

/* ---- starting it ---- */

static bool is_program(char *path) {
    bool yes = !access(path, X_OK);
    if (!yes)
        free(path);
    return yes;
}

/* Where NOCTURNE_READER says; else beside the library, or in a folder nocturne there. NULL after reporting. */
static char *find_program(const remote *r) {
    const char *given = secure_getenv(HELPER_VARIABLE);
    Dl_info info;
    char *folder = NULL, *found = NULL;
    if (given && *given) {
        found = noc_strdup(given);
        return is_program(found) ? found
                                 : (noc_error(r->sink->log, NOC_ERR_UNSUPPORTED, "%s: %s is read by a helper program, and " HELPER_VARIABLE
                                              " names none (%s)", r->path, r->reader->name, given), NULL);
    }
    if (dladdr((void *)&remote_read, &info) && info.dli_fname) {
        char *real = realpath(info.dli_fname, NULL), *slash = real ? strrchr(real, '/') : NULL;
        folder = slash ? noc_format("%.*s", (int)(slash - real), real) : NULL;
        free(real);
    }
    if (folder && !is_program(found = noc_format("%s/nocturne/" HELPER, folder)) && !is_program(found = noc_format("%s/" HELPER, folder)))
        found = NULL;
    if (!found)
        noc_error(r->sink->log, NOC_ERR_UNSUPPORTED,
                  "%s: %s is read by the helper program " HELPER ", which is not in %s or %s/nocturne: install it, name it in "
                  HELPER_VARIABLE ", or read in this process (--no-isolate)", r->path, r->reader->name, folder ? folder : "?",
                  folder ? folder : "?");
    free(folder);
    return found;
}

/* The environment with TMPDIR in the scratch folder: whatever the helper leaves goes with it. */
static char **make_environment(const char *scratch, char **own) {
    size_t n = 0, kept = 0;
    while (environ[n])
        n++;
    char **list = noc_calloc(n + 2, sizeof(*list));
    for (size_t i = 0; i < n; i++)
        if (strncmp(environ[i], "TMPDIR=", 7))
            list[kept++] = environ[i];
    list[kept] = *own = noc_format("TMPDIR=%s", scratch);
    return list;
}

/* No code of ours runs between fork and exec: the host may have threads. Signals of its terminal do not reach the helper. */
static int spawn(remote *r, int end) {
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    sigset_t none, all;
    char *own, **environment = make_environment(r->scratch, &own), *arguments[] = { (char *)HELPER, NULL };
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

static void ask_options(const remote *r, remote_record *batch, remote_record *one) {
    for (const noc_option *o = noc_import_options(); o->name; o++) {
        if (o->kind == NOC_OPTION_TEXTS) {
            const noc_texts *texts = (const noc_texts *)((const char *)r->params + o->offset);
            for (size_t i = 0; i < texts->count; i++) {
                remote_put_text(one, o->name);
                remote_put_text(one, texts->text[i]);
                remote_add(batch, REMOTE_OPTION, one);
            }
            continue;
        }
        size_t n = (size_t)noc_option_get(o, r->params, NULL, 0);
        char *value = noc_alloc(n + 1);
        noc_option_get(o, r->params, value, n + 1);
        if (n) {
            remote_put_text(one, o->name);
            remote_put_text(one, value);
            remote_add(batch, REMOTE_OPTION, one);
        }
        free(value);
    }
}

static bool ask(remote *r) {
    remote_record batch = { 0 }, one = { 0 };
    remote_put_text(&one, r->reader->name);
    remote_add(&batch, REMOTE_READER, &one);
    remote_put_text(&one, r->path);
    remote_add(&batch, REMOTE_PATH, &one);
    ask_options(r, &batch, &one);
    remote_asked asked = { (int32_t)getpid(), r->sink->named_lamps, r->sink->inspect };
    remote_put(&one, &asked, sizeof(asked));
    remote_add(&batch, REMOTE_SINK, &one);
    remote_add(&batch, REMOTE_GO, &one);
    bool sent = remote_send(r->fd, &batch);
    array_free(&batch.bytes);
    array_free(&one.bytes);
    return sent;
}

static noc_status start(remote *r) {
    int ends[2];
    r->program = find_program(r);
    if (!r->program)
        return NOC_ERR_UNSUPPORTED;
    r->scratch = noc_format("%s/nocturne-XXXXXX", map_temporary_folder());
    if (!mkdtemp(r->scratch)) {
        noc_status status = noc_error(r->sink->log, NOC_ERR_IO, "%s: no temporary folder in %s: %s", r->path, map_temporary_folder(),
                                      strerror(errno));
        free(r->scratch);
        r->scratch = NULL;
        return status;
    }
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends))
        return noc_error(r->sink->log, NOC_ERR_IO, "%s: no socket to read it by: %s", r->path, strerror(errno));
    r->fd = ends[0];
    int error = spawn(r, ends[1]);
    close(ends[1]);
    if (error)
        return noc_error(r->sink->log, NOC_ERR_IO, "%s: %s cannot be started: %s", r->path, r->program, strerror(error));
    return ask(r) ? NOC_OK : noc_error(r->sink->log, NOC_ERR_IO, "%s: %s does not listen", r->path, r->program);
}

/* ---- what comes back ---- */

static noc_status garbled(const remote *r) {
    return noc_error(r->sink->log, NOC_ERR_FORMAT, "%s: what came back from the process that reads it makes no sense", r->path);
}

static noc_status take_log(remote *r, remote_record *one) {
    int32_t level;
    remote_get(one, &level, sizeof(level));
    const char *text = remote_get_text(one);
    if (one->bad)
        return garbled(r);
    if (level == NOC_LOG_ERROR)
        noc_error(r->sink->log, NOC_ERR_FORMAT, "%s", text);
    else if (level == NOC_LOG_WARN)
        noc_warn(r->sink->log, "%s", text);
    else if (level == NOC_LOG_INFO)
        noc_info(r->sink->log, "%s", text);
    else
        noc_debug(r->sink->log, "%s", text);
    return NOC_OK;
}

static noc_status take_lamp(remote *r, remote_record *one) {
    geo_lamp lamp;
    remote_get(one, &lamp, sizeof(lamp));
    lamp.id = remote_get_text(one);
    if (one->bad || (unsigned)lamp.type > GEO_LAMP_FLOOD || (unsigned)lamp.source >= NOC_SOURCE_COUNT || (unsigned)lamp.mount > GEO_MOUNT_SUSPENDED)
        return garbled(r);
    return r->sink->lamp(r->sink->ctx, &lamp);
}

static noc_status take_material(remote *r, remote_record *one) {
    noc_material material;
    unsigned char two_sided;
    remote_get(one, &material, sizeof(material));
    memcpy(&two_sided, (char *)&material + offsetof(noc_material, two_sided), 1);
    if (one->bad || !r->parts || two_sided > 1)
        return garbled(r);
    int index = r->parts->material(r->parts->ctx, &material);
    array_push(&r->materials, index);
    return index < 0 ? NOC_ERR_ARGUMENT : NOC_OK;
}

static noc_status take_mesh(remote *r, remote_record *one) {
    remote_mesh m = { 0 };
    remote_get(one, &m, sizeof(m));
    const char *name = remote_get_text(one);
    const void *positions = remote_get_array(one, m.vertices, 3 * sizeof(double));
    const void *indices = remote_get_array(one, m.triangles, 3 * sizeof(uint32_t));
    if (one->bad || !r->parts || m.material < 0 || (size_t)m.material >= r->materials.len)
        return garbled(r);
    double *xyz = noc_alloc_large((size_t)m.vertices * 3, sizeof(*xyz)); /* aligned */
    uint32_t *corners = noc_alloc_large((size_t)m.triangles * 3, sizeof(*corners));
    noc_status status = NOC_OK;
    if (!xyz || !corners) {
        status = noc_error(r->sink->log, NOC_ERR_MEMORY, "%s: no memory for a mesh of %llu vertices", r->path, (unsigned long long)m.vertices);
    } else {
        memcpy(xyz, positions, (size_t)m.vertices * 3 * sizeof(*xyz));
        memcpy(corners, indices, (size_t)m.triangles * 3 * sizeof(*corners));
        noc_mesh mesh = { .vertex_count = (size_t)m.vertices, .positions = xyz, .triangle_count = (size_t)m.triangles, .indices = corners,
                          .material = r->materials.data[m.material], .name = *name ? name : NULL };
        status = r->parts->mesh(r->parts->ctx, &mesh, xyz);
    }
    free(xyz);
    free(corners);
    return status;
}

static noc_status take_issue(remote *r, remote_record *one) {
    unsigned char repaired;
    size_t count;
    remote_get(one, &repaired, sizeof(repaired));
    remote_get(one, &count, sizeof(count));
    const char *reason = remote_get_text(one), *examples = remote_get_text(one);
    if (one->bad)
        return garbled(r);
    geo_issues_add(r->sink->issues, repaired != 0, reason, count, examples);
    return NOC_OK;
}

static noc_status take_columns(remote *r, remote_record *one) {
    uint64_t points = 0, count = 0;
    NOC_ARRAY(geo_column) columns = { 0 };
    remote_get(one, &points, sizeof(points));
    remote_get(one, &count, sizeof(count));
    for (uint64_t i = 0; i < count && !one->bad; i++) {
        uint64_t values = 0;
        unsigned char mapped = 0;
        remote_get(one, &values, sizeof(values));
        remote_get(one, &mapped, sizeof(mapped));
        geo_column c = { .values = (size_t)values, .mapped = mapped != 0 };
        c.name = remote_get_text(one);
        c.field = remote_get_text(one);
        c.unit = remote_get_text(one);
        c.example = remote_get_text(one);
        array_push(&columns, c);
    }
    noc_status status = one->bad ? garbled(r) : NOC_OK;
    if (!status && r->sink->columns)
        r->sink->columns(r->sink->ctx, (size_t)points, columns.data, columns.len);
    array_free(&columns);
    return status;
}

static noc_status take_end(remote *r, remote_record *one) {
    remote_end end;
    remote_get(one, &end, sizeof(end));
    const char *format = remote_get_text(one);
    if (one->bad || end.status < NOC_OK || end.status > NOC_ERR_CANCELLED)
        return garbled(r);
    snprintf(r->result->format, sizeof(r->result->format), "%s", format);
    r->result->bytes_read = end.bytes_read;
    r->result->trailing = end.trailing;
    if (r->sink->lamps_lost)
        *r->sink->lamps_lost += (size_t)end.lamps_lost;
    r->ended = true;
    return (noc_status)end.status;
}

static noc_status take(remote *r, uint32_t kind, remote_record *one) {
    switch (kind) {
    case REMOTE_LOG: return take_log(r, one);
    case REMOTE_CRS: {
        const char *srs_name = remote_get_text(one), *place = remote_get_text(one);
        bool lat_first;
        return one->bad ? garbled(r) : r->sink->crs(r->sink->ctx, srs_name, place, &lat_first);
    }
    case REMOTE_LAMP: return take_lamp(r, one);
    case REMOTE_MATERIAL: return take_material(r, one);
    case REMOTE_MESH: return take_mesh(r, one);
    case REMOTE_ISSUE: return take_issue(r, one);
    case REMOTE_PROGRESS: return remote_get(one, &r->done, sizeof(r->done)) && isfinite(r->done) ? NOC_OK : garbled(r);
    case REMOTE_COLUMNS: return take_columns(r, one);
    case REMOTE_END: return take_end(r, one);
    default: return garbled(r);
    }
}

/* Takes apart the records that are there whole. */
static noc_status take_all(remote *r) {
    noc_status status = NOC_OK;
    while (!status && !r->ended) {
        remote_head head;
        if (r->bytes.len - r->pos < sizeof(head))
            break;
        memcpy(&head, r->bytes.data + r->pos, sizeof(head));
        uint64_t size = (uint64_t)head.size_high << 32 | head.size_low;
        if (r->bytes.len - r->pos - sizeof(head) < size)
            break;
        remote_record one = { .bytes = { .data = r->bytes.data + r->pos + sizeof(head), .len = (size_t)size } };
        r->pos += sizeof(head) + (size_t)size;
        status = take(r, head.kind, &one);
    }
    memmove(r->bytes.data, r->bytes.data + r->pos, r->bytes.len - r->pos);
    r->bytes.len -= r->pos;
    r->pos = 0;
    return status;
}

/* ---- until the end ---- */

static noc_status out_of_time(const remote *r) {
    return noc_error(r->sink->log, NOC_ERR_UNSUPPORTED, "%s: it is still being read after %g s, which is the limit --reader-time", r->path,
                     r->params->reader_time);
}

/* It ended without a word. */
static noc_status ended_early(remote *r) {
    int how = 0;
    pid_t got = waitpid(r->pid, &how, 0);
    r->pid = 0;
    if (got > 0 && WIFSIGNALED(how) && WTERMSIG(how) != SIGKILL)
        return noc_error(r->sink->log, NOC_ERR_FORMAT,
                         "%s: the process that reads it as %s ended by signal %d (%s): the file is broken, or needs more than the limit "
                         "--max-memory, %.3g GB", r->path, r->reader->name, WTERMSIG(how), strsignal(WTERMSIG(how)),
                         import_budget_of(r->params).memory / 1e9);
    return noc_error(r->sink->log, NOC_ERR_IO, "%s: the process that reads it was ended from outside, or could not run (%s)", r->path, r->program);
}

static noc_status receive(remote *r) {
    enum { CHUNK = 1 << 18 };
    size_t room = r->bytes.len + CHUNK;
    if (room > r->bytes.cap && !array_try_reserve(&r->bytes, NOC_MAX(room, r->bytes.len * 2)))
        return noc_error(r->sink->log, NOC_ERR_MEMORY, "%s: no memory for what it holds", r->path);
    ssize_t n = recv(r->fd, r->bytes.data + r->bytes.len, CHUNK, MSG_DONTWAIT);
    if (n < 0 && (errno == EINTR || errno == EAGAIN))
        return NOC_OK;
    if (n <= 0)
        return ended_early(r);
    r->bytes.len += (size_t)n;
    r->received += (uint64_t)n;
    const import_budget budget = import_budget_of(r->params);
    if ((double)r->received > budget.memory)
        return noc_error(r->sink->log, NOC_ERR_MEMORY, "%s: it holds more than the limit --max-memory, %.3g GB", r->path,
                         budget.memory / 1e9);
    return take_all(r);
}

static noc_status listen_to(remote *r) {
    noc_status status = NOC_OK;
    while (!status && !r->ended) {
        struct pollfd p = { .fd = r->fd, .events = POLLIN };
        int ready = poll(&p, 1, (int)(1000 * TICK));
        double now = noc_wall_seconds();
        if (now - r->ticked >= TICK) {
            r->ticked = now;
            if (r->sink->progress && !r->sink->progress(r->sink->ctx, r->done))
                status = NOC_ERR_CANCELLED;
            else if (now - r->started > r->params->reader_time)
                status = out_of_time(r);
        }
        if (!status && ready > 0)
            status = receive(r);
    }
    return status;
}

static int remove_one(const char *path, const struct stat *st, int kind, struct FTW *at) {
    remove(path);
    return 0;
}

static void finish(remote *r) {
    if (r->pid > 0) {
        if (!r->ended)
            kill(r->pid, SIGKILL);
        while (waitpid(r->pid, NULL, 0) < 0 && errno == EINTR)
            continue;
    }
    if (r->fd >= 0)
        close(r->fd);
    if (r->scratch)
        nftw(r->scratch, remove_one, 8, FTW_DEPTH | FTW_PHYS);
    free(r->scratch);
    free(r->program);
    array_free(&r->bytes);
    array_free(&r->materials);
}

noc_status remote_read(const noc_reader *reader, const char *path, const noc_import_params *params, geo_sink *sink,
                       const mesh_parts *parts, remote_result *result) {
    remote r = { .reader = reader, .path = path, .params = params, .sink = sink, .parts = parts, .result = result, .fd = -1,
                 .started = noc_wall_seconds() };
    *result = (remote_result){ 0 };
    noc_status status = start(&r);
    if (!status)
        status = listen_to(&r);
    finish(&r);
    return status;
}
