/* Inputs that stand for several files: folders, patterns ("city/tile*.gml") and lists (@tiles.txt). The order is that
 * of the command line, and by name within a folder and a pattern, so that a scene is the same everywhere. A file that
 * is called so is that file, whatever signs are in its name. */
#include "import/load/load.h"

#include <dirent.h>
#include <errno.h>
#include <glob.h>
#include <sys/stat.h>

#define MOST_FOLDERS 32 /* in folders */

typedef struct expansion {
    noc_log *log;
    expanded *out;
    const char *folder; /* the input that is one, while its files are found */
} expansion;

static noc_status no_memory(expansion *x, const char *path) { return noc_no_memory(x->log, path); }

size_t expand_most_files = 1000000;

static noc_status too_many(expansion *x, const char *path) {
    return noc_error(x->log, NOC_ERR_ARGUMENT, "%s: more than %zu inputs", path, expand_most_files);
}

static noc_status add(expansion *x, const char *path) {
    if (x->out->files.len == expand_most_files)
        return too_many(x, path);
    expanded_file file = { arena_strdup(&x->out->arena, path), x->folder };
    return file.path && array_push(&x->out->files, file) ? NOC_OK : no_memory(x, path);
}

static int by_name(const void *a, const void *b) { return strcmp(*(const char *const *)a, *(const char *const *)b); }

/* ---- folders ---- */

typedef NOC_ARRAY(char *) names;

static void free_names(names *list) {
    for (size_t i = 0; i < list->len; i++)
        free(list->data[i]);
    array_free(list);
}

/* What is in a folder, but for what is hidden. */
static noc_status list_folder(expansion *x, const char *path, names *list) {
    DIR *dir = opendir(path);
    if (!dir)
        return noc_error(x->log, NOC_ERR_IO, "%s: %s", path, strerror(errno));
    noc_status status = NOC_OK;
    for (struct dirent *entry; !status && (entry = readdir(dir));) {
        if (*entry->d_name == '.')
            continue;
        char *name = noc_strdup(entry->d_name);
        bool full = list->len == expand_most_files;
        if (!name || full || !array_push(list, name)) {
            free(name);
            status = full ? too_many(x, path) : no_memory(x, path);
        }
    }
    closedir(dir);
    if (list->len)
        qsort(list->data, list->len, sizeof(*list->data), by_name);
    return status;
}

static noc_status add_folder(expansion *x, const char *path, int depth) {
    names list = { 0 };
    noc_status status = list_folder(x, path, &list);
    size_t n = strlen(path);
    for (size_t i = 0; i < list.len && !status; i++) {
        char *inside = noc_format("%s%s%s", path, n && path[n - 1] == '/' ? "" : "/", list.data[i]);
        struct stat st, real;
        if (!inside)
            status = no_memory(x, path);
        else if (lstat(inside, &st) || stat(inside, &real))
            ; /* it has gone, or is a link to what is not there */
        else if (S_ISREG(real.st_mode))
            status = add(x, inside);
        else if (S_ISDIR(st.st_mode) && depth < MOST_FOLDERS) /* not a link: it may lead around */
            status = add_folder(x, inside, depth + 1);
        free(inside);
    }
    free_names(&list);
    return status;
}

/* ---- anything ---- */

static bool is_folder(const char *path) {
    struct stat st;
    return !stat(path, &st) && S_ISDIR(st.st_mode);
}

static noc_status add_found(expansion *x, const char *path) {
    if (!is_folder(path))
        return add(x, path);
    size_t before = x->out->files.len;
    if (!(x->folder = arena_strdup(&x->out->arena, path)))
        return no_memory(x, path);
    noc_status status = add_folder(x, path, 0);
    x->folder = NULL;
    return status || x->out->files.len > before ? status
                                                : noc_error(x->log, NOC_ERR_IO, "%s: no file is in this folder", path);
}

/* `place`: where a list names it, "" of the command line. */
static noc_status add_pattern(expansion *x, const char *pattern, const char *place) {
    glob_t found = { 0 };
    int code = glob(pattern, GLOB_NOSORT, NULL, &found);
    noc_status status = NOC_OK;
    if (code == GLOB_NOSPACE)
        status = no_memory(x, pattern);
    else if (code)
        status = noc_error(x->log, NOC_ERR_IO, "%s%s: no file is called so", place, pattern);
    else
        qsort(found.gl_pathv, found.gl_pathc, sizeof(*found.gl_pathv), by_name);
    for (size_t i = 0; i < found.gl_pathc && !status; i++)
        status = add_found(x, found.gl_pathv[i]);
    globfree(&found);
    return status;
}

static noc_status add_one(expansion *x, const char *path, const char *place) {
    struct stat st;
    bool builtin = !strncmp(path, BUILTIN, strlen(BUILTIN));
    return builtin || !stat(path, &st) || !strpbrk(path, "*?[") ? add_found(x, path) : add_pattern(x, path, place);
}

/* ---- lists ---- */

/* One input a line, from the list's folder on; blank lines and those that begin with # are none. */
static noc_status add_lines(expansion *x, const char *path, char *text) {
    const char *slash = strrchr(path, '/');
    int folder = slash ? (int)(slash + 1 - path) : 0;
    size_t before = x->out->files.len;
    noc_status status = NOC_OK;
    unsigned long line = 0;
    for (char *at = text, *next; at && !status; at = next) {
        char *end = at + strcspn(at, "\n");
        next = *end ? end + 1 : NULL;
        *end = 0;
        line++;
        at += strspn(at, " \t\r");
        while (end > at && strchr(" \t\r", end[-1]))
            *--end = 0;
        if (!*at || *at == '#')
            continue;
        bool whole = *at == '/' || !strncmp(at, BUILTIN, strlen(BUILTIN));
        char *named = noc_format("%.*s%s", whole ? 0 : folder, path, at), *place = noc_format("%s:%lu: ", path, line);
        struct stat st;
        if (!named || !place)
            status = no_memory(x, path);
        else if (*at != '/' && !strpbrk(at, "*?[") && !whole && stat(named, &st))
            status = noc_error(x->log, NOC_ERR_IO, "%s%s: %s", place, named, strerror(errno));
        else
            status = add_one(x, named, place);
        free(named);
        free(place);
    }
    return status || x->out->files.len > before ? status
                                                : noc_error(x->log, NOC_ERR_FORMAT, "%s: the list is empty", path);
}

static noc_status add_list(expansion *x, const char *path) {
    noc_status status;
    char *text;
    size_t size;
    noc_stream *stream = noc_stream_open(path, x->log, &status);
    if (!stream)
        return status;
    status = noc_stream_read_all(stream, x->log, &text, &size);
    if (!status && memchr(text, 0, size))
        status = noc_error(x->log, NOC_ERR_FORMAT, "%s: no list of files: it holds bytes that are no text", path);
    if (!status)
        status = add_lines(x, path, text + (size >= 3 && !memcmp(text, "\xef\xbb\xbf", 3) ? 3 : 0));
    free(text);
    noc_stream_close(stream);
    return status;
}

noc_status expand_inputs(const char *const *paths, size_t count, noc_log *log, expanded *out) {
    expansion x = { .log = log, .out = out };
    noc_status status = NOC_OK;
    struct stat st;
    for (size_t i = 0; i < count && !status; i++)
        status = paths[i][0] == '@' && paths[i][1] && stat(paths[i], &st) ? add_list(&x, paths[i] + 1)
                                                                          : add_one(&x, paths[i], "");
    return status;
}

void expanded_free(expanded *e) {
    array_free(&e->files);
    arena_free(&e->arena);
}
