/* glTF 2.0, as JSON or GLB, read here rather than through Assimp: version 5.2 of that knows no
 * KHR_materials_emissive_strength, gives a light that several nodes share to the last of them, and keeps floats; a
 * street of lamps that are copies of one would have one lamp.
 *
 * glTF is in metres, y up, and says so: turned to z up. Nodes' transforms are applied, each use of a mesh is a mesh of
 * its own. */
#include "import/mesh/gltf.h"

#include <math.h>
#include <stdio.h>

static const char *skip_blanks(const char *p) {
    if (!strncmp(p, "\xef\xbb\xbf", 3))
        p += 3;
    while (*p == ' ' || *p == '\n' || *p == '\r' || *p == '\t')
        p++;
    return p;
}

static bool probe(const char *head, size_t size) {
    if (size >= 12 && !memcmp(head, "glTF", 4))
        return true;
    const char *p = skip_blanks(head);
    if (*p != '{' || strstr(p, "\"CityJSON\"") || strstr(p, "\"FeatureCollection\""))
        return false;
    return strstr(p, "\"asset\"") || (strstr(p, "\"accessors\"") && strstr(p, "\"bufferViews\"")) ||
           (strstr(p, "\"nodes\"") && strstr(p, "\"scenes\""));
}

/* ---- the container ---- */

static uint32_t le32(const unsigned char *p) {
    return (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

/* Finds the JSON of a GLB, and its binary chunk. */
static noc_status open_glb(gltf *g, const unsigned char *data, size_t size, const char **json, size_t *json_size) {
    if (size < 20 || le32(data + 4) != 2)
        return gltf_error(g, size < 20 ? "the file is cut short" : "version %u of GLB, not 2",
                          size < 20 ? 0 : le32(data + 4));
    if (le32(data + 8) > size)
        return gltf_error(g, "the file is cut short: %zu bytes of %u", size, le32(data + 8));
    size = NOC_MAX(le32(data + 8), 20u); /* what follows is not the model's */
    *json = NULL;
    for (size_t at = 12; size - at >= 8;) {
        size_t length = le32(data + at), type = le32(data + at + 4);
        at += 8;
        if (length > size - at)
            return gltf_error(g, "a chunk of %zu bytes where %zu are left", length, size - at);
        if (type == 0x4e4f534a && !*json) {
            *json = (const char *)data + at;
            *json_size = length;
        } else if (type == 0x004e4942 && !g->chunk) {
            g->chunk = data + at;
            g->chunk_size = length;
        }
        at += NOC_MIN((length + 3) & ~(size_t)3, size - at);
    }
    return *json ? NOC_OK : gltf_error(g, "a GLB without JSON");
}

static bool is_read(const char *extension) {
    static const char *const known[] = { "KHR_lights_punctual", "KHR_mesh_quantization", "KHR_texture_",
                                         "KHR_materials_",      "EXT_texture_",          "KHR_xmp" };
    for (size_t i = 0; i < NOC_COUNT(known); i++)
        if (!strncmp(extension, known[i], strlen(known[i])))
            return true;
    return false;
}

typedef struct text {
    const char *at, *end;
} text;

static size_t pull(void *buffer, size_t size, void *user) {
    text *t = user;
    size = NOC_MIN(size, (size_t)(t->end - t->at));
    memcpy(buffer, t->at, size);
    t->at += size;
    return size;
}

static noc_status parse(gltf *g, const char *json, size_t size) {
    json_error_t error;
    text from = { size >= 3 && !strncmp(json, "\xef\xbb\xbf", 3) ? json + 3 : json, json + size };
    noc_status status = import_affords(g->budget, import_json_cost(json, size), g->name, "its JSON", g->log);
    if (status)
        return status;
    g->root = import_json_load(pull, &from, JSON_DISABLE_EOF_CHECK, &error);
    if (!g->root)
        return import_json_error(&error, g->name, g->log);
    const char *version = json_string_value(json_object_get(json_object_get(g->root, "asset"), "version"));
    if (!version || strncmp(version, "2.", 2))
        return gltf_error(g, "version %.20s, not 2", version ? version : "none");
    const json_t *required = json_object_get(g->root, "extensionsRequired"), *item;
    size_t i;
    json_array_foreach(required, i, item) {
        const char *extension = json_string_value(item);
        if (extension && !is_read(extension))
            return noc_error(g->log, NOC_ERR_UNSUPPORTED, "%s: glTF: it needs %.80s, which is not read", g->name,
                             extension);
    }
    return NOC_OK;
}

/* ---- meshes ---- */

typedef struct corners {
    uint32_t *v;
    size_t count;
} corners; /* of triangles */

/* Triangles of a list, a strip or a fan, less those whose corners are not there. index: NULL counts up. */
static corners triangulate(const gltf *g, const double *index, size_t count, size_t vertices, size_t mode,
                           bool mirrored, const char *name) {
    size_t most = mode == 4 ? count / 3 : count >= 3 ? count - 2 : 0;
    corners out = { noc_alloc_large(most * 3 + 1, sizeof(*out.v)), 0 };
    for (size_t t = 0; t < most && out.v; t++) {
        size_t at[3] = { mode == 4   ? 3 * t
                         : mode == 6 ? 0
                                     : t,
                         mode == 4 ? 3 * t + 1 : t + 1, mode == 4 ? 3 * t + 2 : t + 2 };
        if ((mode == 5 && t % 2) != mirrored) {
            size_t swap = at[1];
            at[1] = at[2];
            at[2] = swap;
        }
        bool there = true;
        for (int k = 0; k < 3; k++) {
            double v = index ? index[at[k]] : (double)at[k];
            there = there && v >= 0 && v < (double)vertices;
            out.v[out.count + (size_t)k] = there ? (uint32_t)v : 0;
        }
        if (there)
            out.count += 3;
        else
            geo_issue(g->issues, GEO_SKIPPED, "triangle with a vertex that is not there", name);
    }
    return out;
}

/* Does the primitive have a place in its material's image, and where are they? */
static bool has_places(const gltf *g, const json_t *primitive, gltf_texture *texture, size_t *accessor) {
    size_t index;
    const json_t *m = g->images ? gltf_material_of(g, primitive, &index) : NULL;
    return m && gltf_texture_of(g, m, texture) && gltf_texture_places(texture, primitive, accessor);
}

/* *uv: NULL where it has none. free() it. */
static noc_status read_places(const gltf *g, const json_t *primitive, size_t vertices, const char *name, float **uv) {
    gltf_texture texture;
    size_t accessor, count;
    double *places;
    *uv = NULL;
    if (!has_places(g, primitive, &texture, &accessor))
        return NOC_OK;
    noc_status status = gltf_read(g, accessor, "VEC2", 2, &places, &count);
    if (status)
        return status;
    if (count != vertices)
        geo_issue(g->issues, GEO_GUESSED, "texture coordinates that are not as many as the vertices", name);
    else if (!(*uv = gltf_texture_uv(g, &texture, places, count)))
        status = NOC_ERR_MEMORY;
    free(places);
    return status;
}

static noc_status add_primitive(gltf *g, const json_t *primitive, const gltf_frame *frame, const char *name) {
    size_t position, index_accessor, count, index_count = 0, mode = 4;
    if (json_object_get(primitive, "mode") && !gltf_index(primitive, "mode", &mode))
        return gltf_error(g, "mesh %.80s: the mode of a primitive is no whole number", name);
    if (mode < 4 || !gltf_index(json_object_get(primitive, "attributes"), "POSITION", &position))
        return NOC_OK; /* points, lines, nothing */
    if (mode > 6)
        return gltf_error(g, "mesh %.80s: a primitive of mode %zu", name, mode);
    double *xyz, *index = NULL;
    noc_status status = gltf_read(g, position, "VEC3", 3, &xyz, &count);
    if (status)
        return status;
    if (json_object_get(primitive, "indices")) {
        status = gltf_index(primitive, "indices", &index_accessor)
                     ? gltf_read(g, index_accessor, "SCALAR", 1, &index, &index_count)
                     : gltf_error(g, "mesh %.80s: its indices are not there", name);
    } else {
        index_count = count;
    }
    const double *m = frame->m;
    double turn =
        m[0] * (m[4] * m[8] - m[5] * m[7]) - m[3] * (m[1] * m[8] - m[2] * m[7]) + m[6] * (m[1] * m[5] - m[2] * m[4]);
    for (size_t i = 0; i < count; i++) {
        double p[3] = { xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2] }, q[3];
        for (int k = 0; k < 3; k++)
            q[k] = m[k] * p[0] + m[3 + k] * p[1] + m[6 + k] * p[2] + m[9 + k];
        xyz[3 * i] = q[0];
        xyz[3 * i + 1] = 0 - q[2];
        xyz[3 * i + 2] = q[1];
    }
    float *uv = NULL;
    int material = -1;
    if (!status)
        status = read_places(g, primitive, count, name, &uv);
    if (!status)
        status = gltf_material(g, primitive, uv != NULL, &material);
    corners c = { NULL, 0 };
    if (!status)
        status = g->place->points(g->place->ctx, xyz, count);
    if (!status) {
        c = triangulate(g, index, index_count, count, mode, turn < 0, name);
        if (!c.v)
            status = noc_no_memory(g->log, g->name);
    }
    noc_mesh mesh = { .vertex_count = count,
                      .positions = xyz,
                      .triangle_count = c.count / 3,
                      .indices = c.v,
                      .material = material,
                      .uv = uv,
                      .name = name };
    if (!status && c.count && !import_triangles(g->scene, &mesh, g->issues))
        status = NOC_ERR_UNSUPPORTED;
    free(c.v);
    free(uv);
    free(index);
    free(xyz);
    return status;
}

/* ---- nodes ---- */

static gltf_frame times(const gltf_frame *a, const gltf_frame *b) {
    gltf_frame out;
    for (int c = 0; c < 4; c++)
        for (int r = 0; r < 3; r++)
            out.m[3 * c + r] = a->m[r] * b->m[3 * c] + a->m[3 + r] * b->m[3 * c + 1] + a->m[6 + r] * b->m[3 * c + 2] +
                               (c == 3 ? a->m[9 + r] : 0);
    return out;
}

/* A node's own transform: a matrix by columns, or translation, rotation (a quaternion x y z w) and scale. */
static gltf_frame own_frame(const gltf *g, const json_t *node, const char *name) {
    double matrix[16], t[3] = { 0, 0, 0 }, q[4] = { 0, 0, 0, 1 }, s[3] = { 1, 1, 1 };
    gltf_frame out;
    if (gltf_numbers(node, "matrix", 16, matrix)) {
        for (int c = 0; c < 4; c++)
            memcpy(&out.m[3 * c], &matrix[4 * c], 3 * sizeof(double));
        return out;
    }
    bool bad = json_object_get(node, "matrix") != NULL;
    bad |= !gltf_numbers(node, "translation", 3, t) && json_object_get(node, "translation");
    bad |= !gltf_numbers(node, "rotation", 4, q) && json_object_get(node, "rotation");
    bad |= !gltf_numbers(node, "scale", 3, s) && json_object_get(node, "scale");
    if (bad)
        geo_issue(g->issues, GEO_GUESSED,
                  "part of a transform that is no list of as many numbers as it takes, left out", name);
    double n = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    double x = q[0] / n, y = q[1] / n, z = q[2] / n, w = q[3] / n;
    if (!(n > 0))
        x = y = z = 0, w = 1;
    const double rotation[9] = { 1 - 2 * (y * y + z * z), 2 * (x * y + z * w),     2 * (x * z - y * w),
                                 2 * (x * y - z * w),     1 - 2 * (x * x + z * z), 2 * (y * z + x * w),
                                 2 * (x * z + y * w),     2 * (y * z - x * w),     1 - 2 * (x * x + y * y) };
    for (int i = 0; i < 9; i++)
        out.m[i] = rotation[i] * s[i / 3];
    memcpy(&out.m[9], t, sizeof(t));
    return out;
}

#define NO_PARENT SIZE_MAX
/* parent: its place in the walk's list, before the node's own. */
typedef struct walked_node {
    size_t index, parent;
    gltf_frame frame;
} walked_node;
typedef struct walk {
    NOC_ARRAY(walked_node) stack, list;
    bool *seen;
    size_t count;
} walk;

static noc_status push_node(gltf *g, walk *w, size_t index, size_t parent) {
    w->seen[index] = true;
    bool pushed = array_push(&w->stack, (walked_node){ .index = index, .parent = parent });
    return pushed ? NOC_OK : noc_no_memory(g->log, g->name);
}

static noc_status push_nodes(gltf *g, walk *w, const json_t *list, size_t parent) {
    noc_status status = NOC_OK;
    for (size_t i = json_array_size(list); i-- > 0 && !status;) {
        const json_t *item = json_array_get(list, i);
        json_int_t index = json_is_integer(item) ? json_integer_value(item) : -1;
        char id[40];
        snprintf(id, sizeof(id), "node %lld", (long long)index);
        if (index < 0 || (uint64_t)index >= w->count) {
            geo_issue(g->issues, GEO_SKIPPED, "node that is not there", id);
        } else if (w->seen[index]) {
            /* a tree is asked for; a loop would not end */
            geo_issue(g->issues, GEO_SKIPPED, "node that is in two places", id);
        } else {
            status = push_node(g, w, (size_t)index, parent);
        }
    }
    return status;
}

/* A file without scenes is a library, but one may still ask to see it: all nodes that are no other's child. */
static noc_status push_roots(gltf *g, walk *w, const json_t *nodes) {
    size_t count = w->count, i, k;
    bool *child = noc_calloc(count + 1, sizeof(*child));
    if (!child)
        return noc_no_memory(g->log, g->name);
    const json_t *node, *item;
    json_array_foreach(nodes, i, node) {
        json_array_foreach(json_object_get(node, "children"), k, item) {
            json_int_t index = json_is_integer(item) ? json_integer_value(item) : -1;
            if (index >= 0 && (uint64_t)index < count)
                child[index] = true;
        }
    }
    noc_status status = NOC_OK;
    for (i = count; i-- > 0 && !status;)
        if (!child[i])
            status = push_node(g, w, i, NO_PARENT);
    free(child);
    return status;
}

/* The nodes of the scene that is to be shown. */
static noc_status push_shown(gltf *g, walk *w, const json_t *nodes) {
    size_t shown = 0;
    const json_t *scenes = json_object_get(g->root, "scenes");
    if (!json_array_size(scenes))
        return push_roots(g, w, nodes);
    bool told = !json_object_get(g->root, "scene") || gltf_index(g->root, "scene", &shown);
    const json_t *scene = told ? gltf_item(g, "scenes", shown) : NULL;
    if (!scene) {
        geo_issue(g->issues, GEO_GUESSED, "scene that is not there, the first one instead", "scene");
        scene = gltf_item(g, "scenes", 0);
    }
    return push_nodes(g, w, json_object_get(scene, "nodes"), NO_PARENT);
}

/* frame: the parent's, which becomes the node's own. */
static noc_status add_node(gltf *g, const json_t *node, size_t index, gltf_frame *frame) {
    const char *name = json_string_value(json_object_get(node, "name"));
    char number[32];
    snprintf(number, sizeof(number), "node %zu", index);
    name = name ? name : number;
    gltf_frame own = own_frame(g, node, name);
    *frame = times(frame, &own);
    noc_status status = gltf_light(g, node, frame, name);
    if (!status)
        status = gltf_camera(g, node, frame, name);
    size_t mesh;
    if (status || !json_object_get(node, "mesh"))
        return status;
    if (!gltf_index(node, "mesh", &mesh) || !gltf_item(g, "meshes", mesh)) {
        geo_issue(g->issues, GEO_SKIPPED, "mesh that is not there", name);
        return NOC_OK;
    }
    if (json_object_get(node, "skin"))
        geo_issue(g->issues, GEO_GUESSED, "skinned mesh, as it is at rest", name);
    if (gltf_extension(node, "EXT_mesh_gpu_instancing"))
        geo_issue(g->issues, GEO_SKIPPED, "copies of a mesh by EXT_mesh_gpu_instancing, all but one", name);
    const json_t *primitives = json_object_get(gltf_item(g, "meshes", mesh), "primitives"), *primitive;
    size_t i;
    json_array_foreach(primitives, i, primitive) {
        status = status ? status : add_primitive(g, primitive, frame, name);
    }
    return status;
}

/* Bytes that reading the meshes of a node takes. */
static double node_cost(const gltf *g, const json_t *node) {
    size_t mesh, accessor, i;
    double cost = 0;
    const json_t *primitive, *shown = gltf_index(node, "mesh", &mesh) ? gltf_item(g, "meshes", mesh) : NULL;
    json_array_foreach(json_object_get(shown, "primitives"), i, primitive) {
        if (gltf_index(json_object_get(primitive, "attributes"), "POSITION", &accessor))
            cost += gltf_cost(g, accessor, 3);
        if (gltf_index(primitive, "indices", &accessor))
            cost += gltf_cost(g, accessor, 1);
        gltf_texture texture;
        if (has_places(g, primitive, &texture, &accessor))
            cost += gltf_cost(g, accessor, 2) * 1.5; /* as floats, too */
    }
    return cost;
}

/* The nodes that are shown, each after its parent. */
static noc_status list_nodes(gltf *g, walk *w) {
    const json_t *nodes = json_object_get(g->root, "nodes");
    w->count = json_array_size(nodes);
    w->seen = noc_calloc(w->count + 1, sizeof(*w->seen));
    noc_status status = w->seen ? push_shown(g, w, nodes) : noc_no_memory(g->log, g->name);
    while (w->stack.len && !status) {
        walked_node at = w->stack.data[--w->stack.len];
        if (!array_push(&w->list, at))
            return noc_no_memory(g->log, g->name);
        status = push_nodes(g, w, json_object_get(json_array_get(nodes, at.index), "children"), w->list.len - 1);
    }
    return status;
}

/* What all nodes ask for is added up before the first of them is read. */
static noc_status add_scene(gltf *g) {
    static const gltf_frame whole = { { 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0 } };
    const json_t *nodes = json_object_get(g->root, "nodes");
    walk w = { .count = 0 };
    double cost = 0;
    noc_status status = list_nodes(g, &w);
    for (size_t i = 0; i < w.list.len; i++)
        cost += node_cost(g, json_array_get(nodes, w.list.data[i].index));
    status = status ? status : import_affords(g->budget, cost, g->name, "what its nodes and meshes ask for", g->log);
    for (size_t i = 0; i < w.list.len && !status; i++) {
        walked_node *at = &w.list.data[i];
        at->frame = at->parent == NO_PARENT ? whole : w.list.data[at->parent].frame;
        status = add_node(g, json_array_get(nodes, at->index), at->index, &at->frame);
    }
    array_free(&w.stack);
    array_free(&w.list);
    free(w.seen);
    return status;
}

static noc_status read_gltf(const char *path, noc_stream *stream, const noc_import_params *params, noc_scene *scene,
                            const mesh_place *place, geo_issues *issues, const char **format) {
    gltf g = { .name = noc_stream_name(stream),
               .budget = noc_stream_budget(stream),
               .listener = noc_stream_listener(stream),
               .log = scene->log,
               .scene = scene,
               .place = place,
               .issues = issues,
               .images = params && params->textures && place->image,
               .told = params && params->textures,
               .anywhere = params && params->allow_outside };
    char *data;
    size_t size, json_size = 0;
    noc_status status = noc_stream_read_all(stream, scene->log, &data, &size);
    if (status)
        return status;
    bool binary = size >= 4 && !memcmp(data, "glTF", 4);
    const char *json = data, *slash = strrchr(path, '/');
    *format = binary ? "GLB" : "glTF";
    g.folder = noc_strndup(path, slash ? (size_t)(slash + 1 - path) : 0);
    json_size = size;
    if (!g.folder)
        status = noc_no_memory(g.log, g.name);
    else if (binary)
        status = open_glb(&g, (const unsigned char *)data, size, &json, &json_size);
    status = status ? status : parse(&g, json, json_size);
    status = status ? status : gltf_open_buffers(&g);
    status = status ? status : gltf_note_images(&g, stream);
    size_t images = json_array_size(json_object_get(g.root, "images"));
    if (!status) {
        g.materials = noc_calloc(2 * json_array_size(json_object_get(g.root, "materials")) + 2, sizeof(*g.materials));
        g.decoded = noc_calloc(images, sizeof(*g.decoded));
        status = g.materials && g.decoded ? add_scene(&g) : noc_no_memory(g.log, g.name);
    }
    for (size_t i = 0; i < images && g.decoded; i++)
        free(g.decoded[i].data);
    free(g.decoded);
    gltf_close_buffers(&g);
    json_decref(g.root);
    free(g.materials);
    free(g.folder);
    free(data);
    return status;
}

const noc_reader noc_reader_gltf = { .name = "glTF", .reads = NOC_READS_MESH, .probe = probe, .read_mesh = read_gltf };
