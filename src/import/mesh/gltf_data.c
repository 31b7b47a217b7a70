#include "import/mesh/gltf.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>

#define MOST_ELEMENTS ((size_t)1 << 31)
#define MOST_ZEROS                                                                                                     \
    ((size_t)1                                                                                                         \
     << 22) /* elements of an accessor without data but its sparse part: some bytes may not ask for gigabytes */

noc_status gltf_error(const gltf *g, const char *fmt, ...) {
    char text[400];
    va_list ap;
    va_start(ap, fmt);
    noc_vsnprintf(text, sizeof(text), fmt, ap);
    va_end(ap);
    return noc_error(g->log, NOC_ERR_FORMAT, "%s: glTF: %s", g->name, text);
}

/* ---- JSON ---- */

json_t *gltf_item(const gltf *g, const char *list, size_t index) {
    json_t *item = json_array_get(json_object_get(g->root, list), index);
    return json_is_object(item) ? item : NULL;
}

bool gltf_index(const json_t *object, const char *key, size_t *index) {
    const json_t *value = json_object_get(object, key);
    double x = json_number_value(value);
    if (!json_is_number(value) || !(x >= 0 && x <= 9e15) || x != floor(x))
        return false;
    *index = (size_t)x;
    return true;
}

double gltf_number(const json_t *object, const char *key, double otherwise) {
    const json_t *value = json_object_get(object, key);
    return json_is_number(value) ? json_number_value(value) : otherwise;
}

bool gltf_numbers(const json_t *object, const char *key, size_t count, double *out) {
    const json_t *list = json_object_get(object, key);
    if (json_array_size(list) != count)
        return false;
    for (size_t i = 0; i < count; i++)
        if (!json_is_number(json_array_get(list, i)))
            return false;
    for (size_t i = 0; i < count; i++)
        out[i] = json_number_value(json_array_get(list, i));
    return true;
}

json_t *gltf_extension(const json_t *object, const char *name) {
    return json_object_get(json_object_get(object, "extensions"), name);
}

/* ---- buffers: the GLB's own, data URIs, files beside it ---- */

static int base64_digit(char c) {
    if (c >= 'A' && c <= 'Z')
        return c - 'A';
    if (c >= 'a' && c <= 'z')
        return c - 'a' + 26;
    if (c >= '0' && c <= '9')
        return c - '0' + 52;
    return c == '+' || c == '-' ? 62 : c == '/' || c == '_' ? 63 : -1;
}

/* false where a byte is no digit. */
static bool decode_base64(const char *text, unsigned char *out, size_t *size) {
    uint32_t bits = 0;
    int held = 0;
    *size = 0;
    for (; *text && *text != '='; text++) {
        int digit = base64_digit(*text);
        if (digit < 0)
            return false;
        bits = bits << 6 | (uint32_t)digit;
        held += 6;
        if (held >= 8)
            out[(*size)++] = (unsigned char)(bits >> (held -= 8));
    }
    return true;
}

static int hex(char c) {
    return c >= '0' && c <= '9' ? c - '0' : (c | 32) >= 'a' && (c | 32) <= 'f' ? (c | 32) - 'a' + 10 : -1;
}

void gltf_decode_percent(char *text) {
    char *to = text;
    for (const char *p = text; *p; p++) {
        bool coded = *p == '%' && hex(p[1]) >= 0 && hex(p[2]) >= 0;
        *to++ = coded ? (char)(hex(p[1]) * 16 + hex(p[2])) : *p;
        p += coded ? 2 : 0;
    }
    *to = 0;
}

static noc_status open_file(const gltf *g, const char *uri, gltf_buffer *b) {
    char *name = noc_strdup(uri);
    const char *why;
    size_t size;
    if (!name)
        return noc_no_memory(g->log, g->name);
    gltf_decode_percent(name);
    noc_status status = NOC_OK;
    b->data = b->owned = import_read_named(g->folder, name, g->anywhere, SIZE_MAX, g->listener, &size, &why);
    if (b->owned) {
        b->size = size;
        g->budget->stored += (double)size;
    } else {
        status = why ? noc_error(g->log, NOC_ERR_IO, "%s: glTF: its buffer \"%.200s\" cannot be read: %s", g->name,
                                 name, why)
                     : noc_no_memory(g->log, g->name);
    }
    free(name);
    return status;
}

unsigned char *gltf_decode_data(const char *uri, size_t *size, bool *good) {
    const char *comma = strchr(uri, ',');
    *good = comma && comma - uri >= 7 && !strncmp(comma - 7, ";base64", 7);
    if (!*good)
        return NULL;
    size_t digits = strcspn(comma + 1, "=");
    unsigned char *data = noc_alloc_large(digits / 4 * 3 + digits % 4 * 3 / 4, 1);
    *good = !data || decode_base64(comma + 1, data, size);
    if (!*good) {
        free(data);
        return NULL;
    }
    return data;
}

static noc_status open_data(const gltf *g, const char *uri, size_t index, gltf_buffer *b) {
    bool good;
    b->data = b->owned = gltf_decode_data(uri, &b->size, &good);
    if (!good)
        return gltf_error(g, "buffer %zu is a data URI that is not base64", index);
    return b->data ? NOC_OK : noc_no_memory(g->log, g->name);
}

noc_status gltf_open_buffers(gltf *g) {
    json_t *list = json_object_get(g->root, "buffers");
    g->buffer_count = json_array_size(list);
    g->buffers = noc_calloc(g->buffer_count + 1, sizeof(*g->buffers));
    if (!g->buffers)
        return noc_no_memory(g->log, g->name);
    for (size_t i = 0; i < g->buffer_count; i++) {
        json_t *item = json_array_get(list, i);
        const char *uri = json_string_value(json_object_get(item, "uri"));
        gltf_buffer *b = &g->buffers[i];
        size_t length;
        noc_status status = NOC_OK;
        if (!uri)
            *b = i ? (gltf_buffer){ 0 } : (gltf_buffer){ .data = g->chunk, .size = g->chunk_size };
        else if (!strncmp(uri, "data:", 5))
            status = open_data(g, uri, i, b);
        else if (strstr(uri, "://"))
            status = gltf_error(g, "buffer %zu is on a network, which is not read: %.100s", i, uri);
        else
            status = open_file(g, uri, b);
        if (status)
            return status;
        if (!gltf_index(item, "byteLength", &length))
            return gltf_error(g, "buffer %zu does not say its byteLength", i);
        if (length > b->size)
            return gltf_error(g, "buffer %zu holds %zu bytes, fewer than it says (%zu)", i, b->size, length);
        b->size = length;
    }
    return NOC_OK;
}

void gltf_close_buffers(gltf *g) {
    for (size_t i = 0; i < g->buffer_count && g->buffers; i++)
        free(g->buffers[i].owned);
    free(g->buffers);
}

/* ---- accessors ---- */

typedef struct component {
    size_t size;
    bool sign, real;
} component;

static bool component_of(const json_t *object, component *c) {
    size_t type;
    if (!gltf_index(object, "componentType", &type))
        return false;
    switch (type) {
    case 5120: *c = (component){ 1, true, false }; return true;
    case 5121: *c = (component){ 1, false, false }; return true;
    case 5122: *c = (component){ 2, true, false }; return true;
    case 5123: *c = (component){ 2, false, false }; return true;
    case 5125: *c = (component){ 4, false, false }; return true;
    case 5126: *c = (component){ 4, true, true }; return true;
    default: return false;
    }
}

/* Little-endian, as the format has it. */
static double decode(const unsigned char *p, component c, bool normalised) {
    uint32_t u = 0;
    for (size_t i = 0; i < c.size; i++)
        u |= (uint32_t)p[i] << 8 * i;
    if (c.real) {
        float f;
        memcpy(&f, &u, sizeof(f));
        return (double)f;
    }
    uint32_t most = c.size == 4 ? UINT32_MAX : (1u << 8 * c.size) - 1;
    double x = c.sign && u > most / 2 ? (double)u - (double)most - 1 : (double)u;
    if (!normalised)
        return x;
    return c.sign ? NOC_MAX(x / (double)(most / 2), -1) : x / (double)most;
}

/* Where count elements of `element` bytes of a view begin, and how far they are apart; NULL where they are not all
 * there. */
static const unsigned char *view_data(const gltf *g, const json_t *from, size_t count, size_t element, size_t *stride) {
    size_t view_index, offset = 0, buffer, start = 0, length;
    const json_t *view = gltf_index(from, "bufferView", &view_index) ? gltf_item(g, "bufferViews", view_index) : NULL;
    *stride = element;
    if (!view || !gltf_index(view, "buffer", &buffer) || buffer >= g->buffer_count ||
        !gltf_index(view, "byteLength", &length))
        return NULL;
    if ((json_object_get(view, "byteOffset") && !gltf_index(view, "byteOffset", &start)) ||
        (json_object_get(from, "byteOffset") && !gltf_index(from, "byteOffset", &offset)) ||
        (json_object_get(view, "byteStride") && !gltf_index(view, "byteStride", stride)))
        return NULL;
    const gltf_buffer *b = &g->buffers[buffer];
    bool inside =
        *stride >= element && *stride <= 4096 && start <= b->size && length <= b->size - start && offset <= length;
    if (!inside || !b->data || length - offset < element || (length - offset - element) / *stride < count - 1)
        return NULL;
    return b->data + start + offset;
}

const unsigned char *gltf_view(const gltf *g, const json_t *item, size_t *size) {
    size_t index, stride;
    const json_t *view = gltf_index(item, "bufferView", &index) ? gltf_item(g, "bufferViews", index) : NULL;
    return view && gltf_index(view, "byteLength", size) && *size ? view_data(g, item, *size, 1, &stride) : NULL;
}

static noc_status read_sparse(const gltf *g, const json_t *sparse, size_t accessor, component c, bool normalised,
                              size_t width, double *out, size_t count) {
    json_t *indices = json_object_get(sparse, "indices"), *values = json_object_get(sparse, "values");
    component ic;
    size_t n, index_stride, value_stride;
    if (!gltf_index(sparse, "count", &n) || !n || n > count || !component_of(indices, &ic) || ic.real)
        return gltf_error(g, "accessor %zu: its sparse part is not as it should be", accessor);
    const unsigned char *at = view_data(g, indices, n, ic.size, &index_stride),
                        *from = view_data(g, values, n, c.size * width, &value_stride);
    if (!at || !from)
        return gltf_error(g, "accessor %zu: its sparse part reaches beyond its buffer", accessor);
    for (size_t i = 0; i < n; i++) {
        double index = decode(at + i * index_stride, ic, false);
        if (!(index >= 0 && index < (double)count))
            return gltf_error(g, "accessor %zu: a sparse index of %.0f, of %zu", accessor, index, count);
        for (size_t k = 0; k < width; k++)
            out[(size_t)index * width + k] = decode(from + i * value_stride + k * c.size, c, normalised);
    }
    return NOC_OK;
}

double gltf_cost(const gltf *g, size_t accessor, size_t width) {
    const json_t *a = gltf_item(g, "accessors", accessor);
    component c;
    size_t count, stride;
    if (!gltf_index(a, "count", &count) || !count || count > MOST_ELEMENTS || !component_of(a, &c))
        return 0;
    bool viewed = json_object_get(a, "bufferView") != NULL;
    bool there = viewed ? view_data(g, a, count, c.size * width, &stride) != NULL : count <= MOST_ZEROS;
    return there ? (double)count * (double)(width * sizeof(double)) : 0;
}

noc_status gltf_read(const gltf *g, size_t accessor, const char *type, size_t width, double **out, size_t *count) {
    *out = NULL;
    const json_t *a = gltf_item(g, "accessors", accessor), *sparse = json_object_get(a, "sparse");
    const char *is = json_string_value(json_object_get(a, "type"));
    component c;
    size_t stride;
    if (!a || !is || strcmp(is, type) || !component_of(a, &c))
        return gltf_error(g, "accessor %zu is not there, or no list of %s", accessor, type);
    if (!gltf_index(a, "count", count) || !*count || *count > MOST_ELEMENTS)
        return gltf_error(g, "accessor %zu: its count is not within 1 to %zu", accessor, MOST_ELEMENTS);
    const unsigned char *from = NULL;
    if (json_object_get(a, "bufferView") && !(from = view_data(g, a, *count, c.size * width, &stride)))
        return gltf_error(g, "accessor %zu reaches beyond its buffer", accessor);
    if (!from && !sparse)
        return gltf_error(g, "accessor %zu has no data (compressed meshes are not read)", accessor);
    if (!from && *count > MOST_ZEROS)
        return gltf_error(g, "accessor %zu: %zu elements without data but its sparse part", accessor, *count);
    *out = noc_alloc_large(*count * width, sizeof(**out));
    if (!*out)
        return noc_no_memory(g->log, g->name);
    bool normalised = json_is_true(json_object_get(a, "normalized"));
    for (size_t i = 0; i < *count; i++)
        for (size_t k = 0; k < width; k++)
            (*out)[i * width + k] = from ? decode(from + i * stride + k * c.size, c, normalised) : 0;
    noc_status status = sparse ? read_sparse(g, sparse, accessor, c, normalised, width, *out, *count) : NOC_OK;
    if (status) {
        free(*out);
        *out = NULL;
    }
    return status;
}
