/* stream.c: sequential bytes of a plain, gzip or zip file, told apart by their first bytes. */
#include "import/import.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zip.h>
#include <zlib.h>

#define INPUT_SIZE (64 * 1024)
/* gzip data that has grown to so much, and to so many times its size, is measured before more of it is read. */
#define STRANGE_SIZE ((uint64_t)16 << 20)
#define STRANGE_GROWTH 100

struct noc_stream {
    noc_log *log;
    char *path, *name;
    enum { STREAM_PLAIN, STREAM_GZIP, STREAM_ZIP } kind;
    uint64_t stored;    /* size of the file */
    uint64_t delivered; /* bytes handed out since open or rewind */
    uint64_t furthest;  /* the most that it was before a rewind */
    noc_status failed;  /* a stream that failed once stays failed, and reports it once */
    bool ended;
    bool measured; /* that all of it is not too much is known, as far as it is told ahead */
    import_budget budget;
    import_listener listener;
    /* plain and gzip */
    int fd;
    uint64_t consumed; /* bytes taken from fd */
    z_stream z;
    bool z_open, z_member_done;
    bool trailing; /* bytes follow that are not gzip's */
    unsigned char *input;
    /* zip */
    zip_t *zip;
    zip_file_t *member;
    zip_uint64_t member_index;
    uint64_t member_size;
    size_t unread; /* other members that look as if they should be read, too */
};

static noc_status fail(noc_stream *s, noc_status status, const char *cause) {
    s->failed = status;
    return noc_error(s->log, status, "%s: %s", s->name, cause);
}

static noc_status no_memory(noc_stream *s) { return s->failed = noc_no_memory(s->log, s->name); }

/* ---- plain ---- */

static noc_status read_fd(noc_stream *s, void *data, size_t size, size_t *got) {
    ssize_t n;
    do
        n = read(s->fd, data, size);
    while (n < 0 && errno == EINTR);
    *got = n < 0 ? 0 : (size_t)n;
    s->consumed += *got;
    return n < 0 ? fail(s, NOC_ERR_IO, strerror(errno)) : NOC_OK;
}

/* ---- gzip ---- */

static void *zlib_alloc(void *unused, unsigned items, unsigned size) { return noc_calloc(items, size); }
static void zlib_free(void *unused, void *p) { free(p); }

static noc_status gzip_start(noc_stream *s) {
    if (!s->input && !(s->input = noc_alloc(INPUT_SIZE)))
        return no_memory(s);
    s->z = (z_stream){ .zalloc = zlib_alloc, .zfree = zlib_free };
    s->z_member_done = false;
    if (inflateInit2(&s->z, 15 + 16) != Z_OK)
        return no_memory(s);
    s->z_open = true;
    return NOC_OK;
}

/* Moves what is left of the input to the front and fills up behind it. */
static noc_status gzip_fill(noc_stream *s, bool *at_end) {
    memmove(s->input, s->z.next_in ? s->z.next_in : s->input, s->z.avail_in);
    s->z.next_in = s->input;
    size_t got;
    noc_status status = read_fd(s, s->input + s->z.avail_in, INPUT_SIZE - s->z.avail_in, &got);
    s->z.avail_in += (uInt)got;
    *at_end = got == 0;
    return status;
}

/* After a member: another one may follow directly (gzip files may be concatenated); anything else is not ours. */
static noc_status gzip_next_member(noc_stream *s) {
    bool at_end = false;
    while (s->z.avail_in < 2 && !at_end) {
        noc_status status = gzip_fill(s, &at_end);
        if (status)
            return status;
    }
    if (s->z.avail_in >= 2 && s->z.next_in[0] == 0x1f && s->z.next_in[1] == 0x8b) {
        inflateReset(&s->z);
        s->z_member_done = false;
        return NOC_OK;
    }
    s->trailing = s->z.avail_in > 0;
    s->ended = true;
    return NOC_OK;
}

static noc_status read_gzip(noc_stream *s, void *data, size_t size, size_t *got) {
    s->z.next_out = data;
    s->z.avail_out = (uInt)NOC_MIN(size, (size_t)1 << 30);
    uInt room = s->z.avail_out;
    noc_status status = NOC_OK;
    while (s->z.avail_out == room && !s->ended) {
        if (s->z_member_done) {
            if ((status = gzip_next_member(s)))
                return status;
            continue;
        }
        bool at_end = false;
        if (s->z.avail_in == 0 && (status = gzip_fill(s, &at_end)))
            return status;
        if (at_end)
            return fail(s, NOC_ERR_FORMAT, "truncated gzip data");
        int z = inflate(&s->z, Z_NO_FLUSH);
        if (z == Z_STREAM_END)
            s->z_member_done = true;
        else if (z == Z_MEM_ERROR)
            return no_memory(s);
        else if (z != Z_OK && z != Z_BUF_ERROR)
            return fail(s, NOC_ERR_FORMAT, s->z.msg ? s->z.msg : "damaged gzip data");
    }
    *got = room - s->z.avail_out;
    return NOC_OK;
}

/* ---- zip ---- */

static bool ends_with(const char *text, const char *end) {
    size_t n = strlen(text), m = strlen(end);
    return n >= m && noc_ieq(text + n - m, end);
}

/* 3: a model's ending, 2: a model's or a map's, 1: another (metadata is often XML or JSON, beside the model), 0: any
 * file; -1: no file. */
static int zip_rank(const char *name) {
    static const char *const endings[][8] = { { ".xml", ".json" },
                                              { ".geojson", ".osm", ".pbf", ".csv", ".shp", ".gpkg", ".fgb", ".tif" },
                                              { ".gml", ".citygml", ".obj", ".ply", ".city.json", ".cityjson",
                                                ".jsonl" } };
    /* macOS archives hold a shadow file of the same ending beside every file. */
    if (!name || !*name || ends_with(name, "/") || !strncmp(name, "__MACOSX/", 9))
        return -1;
    for (size_t rank = 0; rank < NOC_COUNT(endings); rank++)
        for (size_t k = 0; k < NOC_COUNT(endings[rank]) && endings[rank][k]; k++)
            if (ends_with(name, endings[rank][k]))
                return (int)rank + 1;
    return 0;
}

/* The first of the members whose names say most clearly that they are a model or a map; -1: there is no file. *alike is
 * how many others rank as high. */
static zip_int64_t zip_choose(zip_t *zip, size_t *alike) {
    zip_int64_t best = -1, count = zip_get_num_entries(zip, 0);
    int best_rank = -1;
    *alike = 0;
    for (zip_int64_t i = 0; i < count; i++) {
        int rank = zip_rank(zip_get_name(zip, (zip_uint64_t)i, ZIP_FL_ENC_GUESS));
        if (rank > best_rank) {
            best = i;
            best_rank = rank;
            *alike = 0;
        } else if (rank > 0 && rank == best_rank) {
            ++*alike;
        }
    }
    return best;
}

static noc_status zip_fail(noc_stream *s, const char *what, zip_error_t *error) {
    if (zip_error_code_zip(error) == ZIP_ER_MEMORY)
        return no_memory(s);
    char text[256];
    noc_snprintf(text, sizeof(text), "%s: %s", what, zip_error_strerror(error));
    return fail(s, NOC_ERR_FORMAT, text);
}

static noc_status zip_start(noc_stream *s) {
    s->member = zip_fopen_index(s->zip, s->member_index, 0);
    return s->member ? NOC_OK : zip_fail(s, "damaged or unreadable zip member", zip_get_error(s->zip));
}

static noc_status zip_open_archive(noc_stream *s) {
    int code;
    s->zip = zip_open(s->path, ZIP_RDONLY, &code);
    if (!s->zip) {
        zip_error_t error;
        zip_error_init_with_code(&error, code);
        noc_status status = zip_fail(s, "damaged or truncated zip archive", &error);
        zip_error_fini(&error);
        return status;
    }
    zip_int64_t index = zip_choose(s->zip, &s->unread);
    if (index < 0)
        return fail(s, NOC_ERR_FORMAT, "zip archive without a file in it");
    s->member_index = (zip_uint64_t)index;
    char *name = noc_format("%s!%s", s->path, zip_get_name(s->zip, s->member_index, ZIP_FL_ENC_GUESS));
    if (!name)
        return no_memory(s);
    free(s->name);
    s->name = name;
    zip_stat_t stat;
    zip_stat_init(&stat);
    if (!zip_stat_index(s->zip, s->member_index, 0, &stat)) {
        if (stat.valid & ZIP_STAT_SIZE)
            s->member_size = stat.size;
        if ((stat.valid & ZIP_STAT_ENCRYPTION_METHOD) && stat.encryption_method != ZIP_EM_NONE)
            return fail(s, NOC_ERR_UNSUPPORTED, "encrypted zip member");
    }
    return zip_start(s);
}

static noc_status read_zip(noc_stream *s, void *data, size_t size, size_t *got) {
    zip_int64_t n = zip_fread(s->member, data, size);
    if (n < 0)
        return zip_fail(s, "damaged or truncated zip member", zip_file_get_error(s->member));
    *got = (size_t)n;
    s->ended = n == 0;
    return NOC_OK;
}

/* ---- the stream ---- */

/* Opens the file itself, before anything is known of its content. */
static noc_status open_file(noc_stream *s) {
    s->fd = open(s->path, O_RDONLY | O_CLOEXEC | O_NONBLOCK); /* a pipe without a writer must not block */
    struct stat stat;
    if (s->fd < 0 || fstat(s->fd, &stat))
        return fail(s, NOC_ERR_IO, strerror(errno));
    if (S_ISDIR(stat.st_mode))
        return fail(s, NOC_ERR_IO, "is a directory");
    if (!S_ISREG(stat.st_mode))
        return fail(s, NOC_ERR_IO, "is not a regular file");
    if (stat.st_size == 0)
        return fail(s, NOC_ERR_FORMAT, "empty file");
    s->stored = (uint64_t)stat.st_size;
    s->budget.stored = (double)s->stored;
    return NOC_OK;
}

static noc_status start(noc_stream *s) {
    unsigned char magic[4] = { 0 };
    size_t got = 0;
    noc_status status = read_fd(s, magic, sizeof(magic), &got);
    if (status)
        return status;
    if (got >= 2 && magic[0] == 0x1f && magic[1] == 0x8b)
        s->kind = STREAM_GZIP;
    else if (got == 4 && (!memcmp(magic, "PK\3\4", 4) || !memcmp(magic, "PK\5\6", 4)))
        s->kind = STREAM_ZIP;
    return s->kind == STREAM_ZIP ? zip_open_archive(s) : noc_stream_rewind(s);
}

noc_stream *noc_stream_open(const char *path, noc_log *log, noc_status *status) {
    noc_stream *s = noc_calloc(1, sizeof(*s));
    noc_status why = NOC_OK;
    if (s) {
        s->log = log;
        s->path = noc_strdup(path);
        s->name = noc_strdup(path);
        s->fd = -1;
        s->budget = import_budget_of(&noc_import_default_params());
    }
    if (!s || !s->path || !s->name)
        why = noc_no_memory(log, path);
    else if (!(why = open_file(s)))
        why = start(s);
    if (status)
        *status = why;
    if (!why)
        return s;
    noc_stream_close(s);
    return NULL;
}

void noc_stream_close(noc_stream *s) {
    if (!s)
        return;
    if (s->member)
        zip_fclose(s->member);
    if (s->zip)
        zip_discard(s->zip);
    if (s->z_open)
        inflateEnd(&s->z);
    if (s->fd >= 0)
        close(s->fd);
    free(s->input);
    free(s->path);
    free(s->name);
    free(s);
}

/* What is read piece by piece need not fit in memory. */
static import_budget growth_of(const noc_stream *s) {
    import_budget growth = s->budget;
    growth.memory = INFINITY;
    return growth;
}

/* How large gzip data is, or, where that is more than it may be, so much of it as tells: inflating alone is faster by
 * far than reading. 0 where that cannot be told. */
static uint64_t measure_gzip(const noc_stream *s) {
    const import_budget growth = growth_of(s);
    noc_stream *again = noc_stream_open(s->path, NULL, NULL);
    unsigned char *sink = noc_alloc(INPUT_SIZE);
    uint64_t size = 0;
    size_t got = again && sink ? 1 : 0;
    if (again)
        again->measured = true, again->budget.expansion = 0;
    while (got && import_fits(&growth, (double)size) && !noc_stream_read(again, sink, INPUT_SIZE, &got))
        size += got;
    free(sink);
    noc_stream_close(again);
    return size;
}

/* An archive that grows to too much is refused before what it holds is read, as far as it tells. */
static noc_status foresee(noc_stream *s) {
    bool strange = s->delivered > STRANGE_SIZE && s->delivered > STRANGE_GROWTH * s->consumed;
    if (s->measured || !(s->budget.expansion > 0) || s->kind == STREAM_PLAIN || (s->kind == STREAM_GZIP && !strange))
        return NOC_OK;
    s->measured = true;
    const import_budget growth = growth_of(s);
    double size = (double)(s->kind == STREAM_ZIP ? s->member_size : measure_gzip(s));
    return s->failed = import_affords(&growth, size, s->name, "its content", s->log);
}

noc_status noc_stream_read(noc_stream *s, void *data, size_t size, size_t *got) {
    *got = 0;
    if (s->failed || foresee(s))
        return s->failed;
    if (s->ended || !size)
        return NOC_OK;
    noc_status status;
    if (s->kind == STREAM_GZIP) {
        status = read_gzip(s, data, size, got);
    } else if (s->kind == STREAM_ZIP) {
        status = read_zip(s, data, size, got);
    } else {
        status = read_fd(s, data, size, got);
        s->ended = !*got;
    }
    s->delivered += *got;
    const import_budget growth = growth_of(s);
    if (!status && s->kind != STREAM_PLAIN)
        status = s->failed = import_affords(&growth, (double)s->delivered, s->name, "its content", s->log);
    return status;
}

noc_status noc_stream_read_all(noc_stream *stream, noc_log *log, char **data, size_t *size) {
    *data = NULL;
    *size = 0;
    size_t cap = 0;
    for (;;) {
        if (cap - *size < (1 << 16)) {
            cap = cap ? cap * 2 : NOC_MIN((size_t)noc_stream_size(stream) + (1 << 17), (size_t)1 << 30);
            noc_status status =
                import_affords(&stream->budget, (double)cap, noc_stream_name(stream), "its content", log);
            char *grown = status ? NULL : noc_realloc(*data, cap);
            if (!grown) {
                free(*data);
                *data = NULL;
                return status ? status : noc_no_memory(log, noc_stream_name(stream));
            }
            *data = grown;
        }
        size_t got;
        noc_status status = noc_stream_read(stream, *data + *size, cap - *size - 1, &got);
        if (status) {
            free(*data);
            *data = NULL;
            return status;
        }
        if (!got)
            break;
        *size += got;
    }
    (*data)[*size] = 0;
    char *exact = noc_realloc(*data, *size + 1); /* it may have room for as much again */
    if (!exact) {
        free(*data);
        *data = NULL;
        return noc_no_memory(log, noc_stream_name(stream));
    }
    *data = exact;
    return NOC_OK;
}

noc_status noc_stream_rewind(noc_stream *s) {
    s->furthest = NOC_MAX(s->furthest, s->delivered);
    s->delivered = s->consumed = 0;
    s->ended = false;
    s->failed = NOC_OK;
    if (s->kind == STREAM_ZIP) {
        if (s->member)
            zip_fclose(s->member);
        return zip_start(s);
    }
    if (lseek(s->fd, 0, SEEK_SET) < 0)
        return fail(s, NOC_ERR_IO, strerror(errno));
    if (s->kind == STREAM_PLAIN)
        return NOC_OK;
    if (s->z_open)
        inflateEnd(&s->z);
    s->z_open = false;
    return gzip_start(s);
}

const char *noc_stream_name(const noc_stream *s) { return s->name; }
uint64_t noc_stream_size(const noc_stream *s) { return s->stored; }
uint64_t noc_stream_read_bytes(const noc_stream *s) { return NOC_MAX(s->furthest, s->delivered); }

bool noc_stream_trailing(const noc_stream *s) { return s->trailing; }
void noc_stream_listen(noc_stream *s, import_listener listener) { s->listener = listener; }

const import_listener *noc_stream_listener(const noc_stream *s) { return &s->listener; }

bool noc_stream_note_named(const noc_stream *s, const char *name) {
    if (!s->listener.on_named)
        return true;
    const char *slash = strrchr(s->path, '/');
    char *folder = noc_strndup(s->path, slash ? (size_t)(slash + 1 - s->path) : 0), *turned = noc_strdup(name);
    for (char *c = turned; c && *c; c++)
        *c = *c == '\\' ? '/' : *c; /* as whoever opens it reads the name */
    bool done = folder && turned && import_note_named(&s->listener, folder, turned);
    free(folder);
    free(turned);
    return done;
}

import_budget *noc_stream_budget(noc_stream *s) { return &s->budget; }

void noc_stream_limit(noc_stream *s, const noc_import_params *params) {
    s->measured = false;
    s->budget = import_budget_of(params);
    s->budget.stored = (double)s->stored;
}

size_t noc_stream_unread(const noc_stream *s) { return s->unread; }

double noc_stream_progress(const noc_stream *s) {
    uint64_t done = s->kind == STREAM_ZIP ? s->delivered : s->consumed;
    uint64_t all = s->kind == STREAM_ZIP ? s->member_size : s->stored;
    return all ? NOC_MIN((double)done / (double)all, 1) : 1;
}
