/* values.c: JSON values that follow each other in a stream, with or without lines between them. */
#include "import/cityjson/cityjson.h"

#define PIECE ((size_t)1 << 16)
#define CLAIM 16e6 /* bytes: how often more is claimed */

/* Is there another byte? Reads on where needed. */
static bool fill(cj_values *v) {
    if (v->at < v->len)
        return true;
    if (v->status)
        return false;
    if (!v->data && !(v->data = noc_alloc(PIECE))) {
        v->status = noc_no_memory(v->sink->log, noc_stream_name(v->stream));
        return false;
    }
    v->at = v->len = 0;
    v->status = noc_stream_read(v->stream, v->data, PIECE, &v->len);
    if (!v->status && !v->sink->progress(v->sink->ctx, noc_stream_progress(v->stream)))
        v->status = NOC_ERR_CANCELLED;
    return !v->status && v->len > 0;
}

/* To the first sign of a value. Before it may stand what JSON text sequences (RFC 7464) begin with, and the mark of
 * UTF-8. */
static bool find_value(cj_values *v) {
    for (; fill(v); v->at++) {
        char c = v->data[v->at];
        v->line += c == '\n';
        if (!strchr(" \t\r\n\x1e\xef\xbb\xbf", c) || !c)
            return true;
    }
    return false;
}

static void follow_text(cj_values *v, char c) {
    if (v->escaped) {
        v->escaped = false;
    } else if (c == '\\') {
        v->escaped = true;
    } else if (c == '"') {
        v->in_text = false;
        return;
    }
    if (v->depth == 1 && v->key_len < sizeof(v->key) - 1)
        v->key[v->key_len++] = c;
}

/* Follows the value's nesting, and counts the members of its CityObjects. */
static void follow(cj_values *v, char c) {
    if (v->in_text) {
        follow_text(v, c);
        return;
    }
    switch (c) {
    case '"':
        v->in_text = true;
        if (v->depth == 1)
            v->key_len = 0;
        break;
    case '{':
    case '[': v->depth++; break;
    case '}':
    case ']':
        v->depth -= v->depth > 0;
        v->ended = v->depth == 0;
        break;
    case ':':
        if (v->depth == 1)
            v->in_objects = v->key_len == 11 && !memcmp(v->key, "CityObjects", 11);
        v->objects += v->depth == 2 && v->in_objects;
        break;
    default: break;
    }
}

/* Hands out the bytes of one value. */
static size_t pull(void *buffer, size_t size, void *user) {
    cj_values *v = user;
    char *out = buffer;
    size_t n = 0;
    while (n < size && !v->ended && fill(v)) {
        char c = v->data[v->at++];
        v->line += c == '\n';
        follow(v, c);
        out[n++] = c;
    }
    if (v->status)
        return (size_t)-1;
    v->cost += import_json_cost(out, n);
    const import_budget *budget = noc_stream_budget(v->stream);
    if (v->cost > v->claimed) { /* where several files are read at once, others may have to end first */
        v->claimed = v->cost + CLAIM;
        (void)import_fits(budget, v->cost);
    }
    v->status = import_affords(budget, v->cost, noc_stream_name(v->stream), "the JSON of one value", v->sink->log);
    return v->status ? (size_t)-1 : n;
}

json_t *cj_values_next(cj_values *v) {
    if (!v->line)
        v->line = 1;
    if (!find_value(v))
        return NULL;
    v->first_line = v->line;
    v->ended = v->in_text = v->escaped = v->in_objects = false;
    v->depth = v->key_len = 0;
    v->cost = v->claimed = 0;
    v->objects = 0;
    json_error_t error;
    json_t *value = import_json_load(pull, v, 0, &error);
    if (value || v->status)
        return value;
    error.line += (int)v->first_line - 1;
    v->status = import_json_error(&error, noc_stream_name(v->stream), v->sink->log);
    return NULL;
}

void cj_values_free(cj_values *v) { free(v->data); }
