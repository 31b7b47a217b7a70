/* YAML into nodes, by libyaml. It was chosen over libcyaml, which reads into structs that are described in C: the
 * option tables describe them already, and their ranges are checked after its load, when it knows no line any more. */
#include "recipe/recipe.h"

#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <sys/stat.h>
#include <unistd.h>

#define MOST_BYTES (1u << 20)      /* of a recipe */
#define MOST_READ (4 * MOST_BYTES) /* with what aliases repeat */
#define MOST_DEPTH 32              /* of lists in lists: libyaml's time grows with its square */
#define MOST_TEXTS 100000          /* of a list */
#define MOST_ANCHORS 1000          /* libyaml compares each name with all others */

noc_status recipe_wrong(const recipe_file *f, const yaml_node_t *node, const char *fmt, ...) {
    char text[400];
    va_list ap;
    va_start(ap, fmt);
    noc_vsnprintf(text, sizeof(text), fmt, ap);
    va_end(ap);
    if (!node)
        return noc_error(f->log, NOC_ERR_FORMAT, "%.400s: %s", f->path, text);
    return noc_error(f->log, NOC_ERR_FORMAT, "%.400s:%zu: %s", f->path, node->start_mark.line + 1, text);
}

static noc_status io_error(const recipe_file *f) {
    return noc_error(f->log, NOC_ERR_IO, "%.400s: %s", f->path, strerror(errno));
}

/* A regular file; a pipe is not waited for. */
static noc_status open_regular(const recipe_file *f, int *fd, size_t *size) {
    struct stat st;
    noc_status status = NOC_OK;
    *fd = open(f->path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (*fd < 0 || fstat(*fd, &st))
        status = io_error(f);
    else if (!S_ISREG(st.st_mode))
        status = noc_error(f->log, NOC_ERR_IO, "%.400s: is not a regular file", f->path);
    else if (st.st_size > (off_t)MOST_BYTES)
        status = noc_error(f->log, NOC_ERR_FORMAT, "%.400s: has more than %u bytes, which no recipe has", f->path,
                           MOST_BYTES);
    else
        *size = (size_t)st.st_size;
    if (status && *fd >= 0)
        close(*fd);
    return status;
}

static noc_status read_text(const recipe_file *f, char **text, size_t *size) {
    int fd;
    noc_status status = open_regular(f, &fd, size);
    if (status)
        return status;
    size_t got = 0;
    *text = noc_alloc(*size + 1);
    if (!*text)
        status = noc_no_memory(f->log, f->path);
    while (!status && got < *size) {
        ssize_t n = read(fd, *text + got, *size - got);
        if (n < 0 && errno != EINTR)
            status = io_error(f);
        else if (n == 0)
            *size = got; /* it became shorter */
        else
            got += n > 0 ? (size_t)n : 0;
    }
    close(fd);
    if (status) {
        free(*text);
        *text = NULL;
    }
    return status;
}

static noc_status no_yaml(const recipe_file *f, const yaml_parser_t *parser) {
    if (parser->error == YAML_MEMORY_ERROR)
        return noc_no_memory(f->log, f->path);
    return noc_error(f->log, NOC_ERR_FORMAT, "%.400s:%zu: is no YAML: %s", f->path, parser->problem_mark.line + 1,
                     parser->problem ? parser->problem : "cannot be read");
}

/* Returns true if the event names an anchor; *tag gets its explicit tag, NULL: none. */
static bool has_anchor(const yaml_event_t *event, const char **tag) {
    const yaml_char_t *anchor = NULL, *of = NULL;
    if (event->type == YAML_SCALAR_EVENT) {
        anchor = event->data.scalar.anchor;
        of = event->data.scalar.tag;
    } else if (event->type == YAML_SEQUENCE_START_EVENT) {
        anchor = event->data.sequence_start.anchor;
        of = event->data.sequence_start.tag;
    } else if (event->type == YAML_MAPPING_START_EVENT) {
        anchor = event->data.mapping_start.anchor;
        of = event->data.mapping_start.tag;
    }
    *tag = (const char *)of;
    return anchor != NULL;
}

/* The types of YAML's core schema: values are read by their options in any case. */
static bool is_core_tag(const char *tag) {
    static const char *const core[] = { "str", "int", "float", "bool", "null", "seq", "map" };
    static const char prefix[] = "tag:yaml.org,2002:";
    bool is = !strcmp(tag, "!");
    for (size_t i = 0; i < NOC_COUNT(core); i++)
        is = is || (!strncmp(tag, prefix, strlen(prefix)) && !strcmp(tag + strlen(prefix), core[i]));
    return is;
}

static noc_status check_event(const recipe_file *f, const yaml_event_t *event, int depth, int *anchors) {
    const char *tag;
    size_t line = event->start_mark.line + 1;
    *anchors += has_anchor(event, &tag);
    if (depth > MOST_DEPTH)
        return noc_error(f->log, NOC_ERR_FORMAT, "%.400s:%zu: lists in lists, more than %d deep", f->path, line,
                         MOST_DEPTH);
    if (*anchors > MOST_ANCHORS)
        return noc_error(f->log, NOC_ERR_FORMAT, "%.400s:%zu: more than %d anchors (&), which no recipe has", f->path,
                         line, MOST_ANCHORS);
    if (tag && !is_core_tag(tag))
        return noc_error(f->log, NOC_ERR_FORMAT, "%.400s:%zu: the tag %.100s is not read: write the value without it",
                         f->path, line, tag);
    return NOC_OK;
}

/* Goes through all of it, and stops at what would take long or be misread. */
static noc_status check_events(const recipe_file *f, yaml_parser_t *parser) {
    for (int depth = 0, anchors = 0, done = 0; !done;) {
        yaml_event_t event;
        if (!yaml_parser_parse(parser, &event))
            return no_yaml(f, parser);
        depth += event.type == YAML_SEQUENCE_START_EVENT || event.type == YAML_MAPPING_START_EVENT;
        depth -= event.type == YAML_SEQUENCE_END_EVENT || event.type == YAML_MAPPING_END_EVENT;
        done = event.type == YAML_STREAM_END_EVENT;
        noc_status status = check_event(f, &event, depth, &anchors);
        yaml_event_delete(&event);
        if (status)
            return status;
    }
    return NOC_OK;
}

/* The nodes of the first document; a second one is an error. */
static noc_status read_nodes(recipe_file *f, yaml_parser_t *parser) {
    yaml_document_t next;
    if (yaml_parser_load(parser, &f->yaml)) {
        bool more = yaml_parser_load(parser, &next) && yaml_document_get_root_node(&next);
        if (!parser->error)
            yaml_document_delete(&next);
        if (!parser->error && !more)
            return NOC_OK;
        yaml_document_delete(&f->yaml);
        if (more)
            return noc_error(f->log, NOC_ERR_FORMAT, "%.400s: holds a second document", f->path);
    }
    return no_yaml(f, parser);
}

static noc_status with_parser(recipe_file *f, const char *text, size_t size, bool nodes) {
    yaml_parser_t parser;
    if (noc_allocation_refused() || !yaml_parser_initialize(&parser))
        return noc_no_memory(f->log, f->path);
    yaml_parser_set_input_string(&parser, (const unsigned char *)text, size);
    noc_status status = nodes ? read_nodes(f, &parser) : check_events(f, &parser);
    yaml_parser_delete(&parser);
    return status;
}

noc_status recipe_open(recipe_file *f) {
    static const char none[] = "nocturne: 1\n"; /* of a built city without a recipe */
    char *text = NULL;
    size_t size = 0;
    noc_status status = f->built ? noc_built_get_recipe(f->path, f->log, &text) : read_text(f, &text, &size);
    if (!status && f->built) {
        text = text ? text : noc_strdup(none);
        size = text ? strlen(text) : 0;
        status = text ? NOC_OK : noc_no_memory(f->log, f->path);
    }
    if (!status)
        status = with_parser(f, text, size, false);
    if (!status)
        status = with_parser(f, text, size, true);
    free(text);
    return status;
}

yaml_node_t *recipe_node(recipe_file *f, int index) {
    yaml_node_t *node = yaml_document_get_node(&f->yaml, index);
    f->read += 1 + (node && node->type == YAML_SCALAR_NODE ? node->data.scalar.length : 0);
    return node;
}

/* An anchor may be repeated any number of times, and a few bytes each. */
static noc_status check_read(const recipe_file *f, const yaml_node_t *node) {
    return f->read <= MOST_READ
               ? NOC_OK
               : recipe_wrong(f, node, "its aliases (*) repeat more than %u bytes, which no recipe does", MOST_READ);
}

const char *recipe_text(const yaml_node_t *node) {
    if (!node || node->type != YAML_SCALAR_NODE || !node->data.scalar.length)
        return NULL;
    const char *text = (const char *)node->data.scalar.value;
    return strlen(text) == node->data.scalar.length ? text : NULL;
}

noc_status recipe_each(recipe_file *f, yaml_node_t *map, const char *what,
                       noc_status (*take)(void *ctx, const yaml_node_t *key, yaml_node_t *value), void *ctx) {
    if (!map || map->type != YAML_MAPPING_NODE)
        return recipe_wrong(f, map, "%s must be keys and their values", what);
    noc_map keys = { 0 };
    noc_status status = NOC_OK;
    for (const yaml_node_pair_t *p = map->data.mapping.pairs.start; p < map->data.mapping.pairs.top && !status; p++) {
        const yaml_node_t *key = recipe_node(f, p->key);
        const char *text = recipe_text(key);
        bool fresh = true;
        status = check_read(f, key);
        if (status)
            break;
        if (!text)
            status = recipe_wrong(f, key ? key : map, "a key of %s is no text", what);
        else if (!map_put(&keys, text, 0, &fresh))
            status = noc_no_memory(f->log, f->path);
        else if (!fresh)
            status = recipe_wrong(f, key, "%.60s is given twice", text);
        status = status ? status : take(ctx, key, recipe_node(f, p->value));
    }
    map_free(&keys);
    return status;
}

noc_status recipe_texts(recipe_file *f, yaml_node_t *node, const char *key, const char ***texts, size_t *count) {
    bool list = node->type == YAML_SEQUENCE_NODE;
    size_t n = list ? (size_t)(node->data.sequence.items.top - node->data.sequence.items.start) : 1;
    if (n > MOST_TEXTS)
        return recipe_wrong(f, node, "%s has more than %d entries", key, MOST_TEXTS);
    *count = n;
    *texts = arena_alloc(&f->recipe->arena, (n + 1) * sizeof(**texts));
    for (size_t i = 0; i < n && *texts; i++) {
        const yaml_node_t *item = list ? recipe_node(f, node->data.sequence.items.start[i]) : node;
        const char *text = recipe_text(item);
        noc_status status = check_read(f, item);
        if (status)
            return status;
        if (!text)
            return recipe_wrong(f, item ? item : node, list ? "%s: entry %zu is no text" : "%s has no value", key,
                                i + 1);
        (*texts)[i] = arena_strdup(&f->recipe->arena, text);
    }
    return f->recipe->arena.refused ? noc_no_memory(f->log, f->path) : NOC_OK;
}

noc_status recipe_numbers(recipe_file *f, yaml_node_t *node, const char *key, size_t count, double *out) {
    bool list = node->type == YAML_SEQUENCE_NODE;
    if (!list || (size_t)(node->data.sequence.items.top - node->data.sequence.items.start) != count)
        return recipe_wrong(f, node, "%s must be a list of %zu numbers, such as [1, 2, 3]", key, count);
    for (size_t i = 0; i < count; i++) {
        const char *text = recipe_text(recipe_node(f, node->data.sequence.items.start[i]));
        if (!text || !noc_parse_double(text, &out[i]))
            return recipe_wrong(f, node, "%s: entry %zu is no number", key, i + 1);
    }
    return NOC_OK;
}

const char *recipe_path(recipe_file *f, const char *path) {
    const char *slash = strrchr(f->path, '/'), *at = *path == '@' ? "@" : ""; /* @LIST is a list of inputs */
    if (path[*at == '@'] == '/' || !slash || !strncmp(path, "builtin:", strlen("builtin:")))
        return arena_strdup(&f->recipe->arena, path);
    return arena_format(&f->recipe->arena, "%s%.*s/%s", at, (int)(slash - f->path), f->path, path + strlen(at));
}

/* A built city, or the first line that is neither blank nor a comment begins with the key. */
bool noc_recipe_is(const char *path) {
    char head[4096];
    struct stat st;
    if (noc_built_is(path))
        return true;
    int fd = path ? open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK) : -1;
    ssize_t n = fd >= 0 && !fstat(fd, &st) && S_ISREG(st.st_mode) ? read(fd, head, sizeof(head) - 1) : 0;
    if (fd >= 0)
        close(fd);
    head[n > 0 ? n : 0] = 0;
    const char *s = head + (strncmp(head, "\xef\xbb\xbf", 3) ? 0 : 3);
    while (*s == '#' || *s == '%' || *s == '\n' || *s == '\r' || !strncmp(s, "---", 3))
        for (s += strcspn(s, "\n"); *s == '\n';)
            s++;
    size_t key = strlen("nocturne");
    return !strncmp(s, "nocturne", key) && s[key + strspn(s + key, " ")] == ':';
}
