/* object.c: CityObjects, which name each other as parents and children, to objects with their parts. */
#include "import/cityjson/cityjson.h"

#define MOST_NESTED 32 /* parts in parts */

typedef struct node {
    const char *id;
    json_t *object;
    const cg_feature_type *type;
    uint32_t parent, first, last, next; /* CG_NONE: none; children in the file's order */
    bool done;
} node;

typedef struct tree {
    cj_reading *r;
    node *nodes;
    size_t count;
    noc_map ids;
} tree;

static void issue(const tree *t, geo_issue_kind kind, const char *reason, const char *id) {
    geo_issue(t->r->parser->sink->issues, kind, reason, id);
}

/* ---- types ---- */

/* Objects of extensions, and what has no type, are drawn as what they look like. */
static const cg_feature_type *type_of(const tree *t, const json_t *object, const char *id) {
    static const char *const otherwise[][2] = { { "BuildingStorey", "Storey" },
                                                { "TransportSquare", "Square" },
                                                { "TunnelHollowSpace", "HollowSpace" } };
    const char *name = cj_text(object, "type");
    for (size_t i = 0; i < NOC_COUNT(otherwise); i++)
        if (!strcmp(name, otherwise[i][0]))
            name = otherwise[i][1];
    const cg_feature_type *type = cg_feature_type_of(name);
    bool object_type = type && type->part != CG_PART_BOUNDARY && type->part != CG_PART_OPENING;
    if (object_type)
        return type;
    issue(t, GEO_GUESSED,
          *name == '+' ? "object of an extension, drawn as a generic one"
          : *name      ? "object of a type that is not known, drawn as a generic one"
                       : "object without a type, drawn as a generic one",
          id);
    return cg_feature_type_of("GenericCityObject");
}

/* ---- who belongs to whom ---- */

static void adopt(tree *t, uint32_t parent, uint32_t child) {
    node *p = &t->nodes[parent], *c = &t->nodes[child];
    if (c->parent != CG_NONE || parent == child || p->type->part == CG_PART_GROUP)
        return;
    c->parent = parent;
    if (p->last == CG_NONE)
        p->first = child;
    else
        t->nodes[p->last].next = child;
    p->last = child;
}

/* Those that a list of ids names. Returns how many of them are not there. */
static size_t adopt_all(tree *t, uint32_t of, const char *key, bool parents) {
    const json_t *list = json_object_get(t->nodes[of].object, key);
    size_t missing = 0;
    for (size_t i = 0; i < json_array_size(list); i++) {
        const char *id = json_string_value(json_array_get(list, i));
        uint64_t other;
        if (!id || !map_get(&t->ids, id, &other))
            missing++;
        else
            adopt(t, parents ? (uint32_t)other : of, parents ? of : (uint32_t)other);
    }
    return missing;
}

static void link_nodes(tree *t) {
    for (uint32_t i = 0; i < t->count; i++)
        if (adopt_all(t, i, "parents", true) && t->nodes[i].parent == CG_NONE)
            issue(t, GEO_GUESSED, "object whose parent is not in the file, drawn by itself", t->nodes[i].id);
    for (uint32_t i = 0; i < t->count; i++) /* where the children do not say so */
        if (t->nodes[i].type->part != CG_PART_GROUP && adopt_all(t, i, "children", false))
            issue(t, GEO_SKIPPED, "child that is not in the file", t->nodes[i].id);
}

static bool build(tree *t, json_t *objects) {
    size_t count = json_object_size(objects);
    t->nodes = noc_calloc(count + 1, sizeof(*t->nodes));
    if (!t->nodes)
        return false;
    const char *id;
    json_t *object;
    json_object_foreach(objects, id, object) {
        if (!json_is_object(object)) {
            issue(t, GEO_SKIPPED, "object that is none", id);
            continue;
        }
        t->nodes[t->count] = (node){ id, object, type_of(t, object, id), CG_NONE, CG_NONE, CG_NONE, CG_NONE, false };
        if (!map_put(&t->ids, id, t->count, NULL))
            return false;
        t->count++;
    }
    link_nodes(t);
    return true;
}

/* ---- attributes ---- */

static void add_value(cg_parser *p, uint32_t feature, const char *key, const json_t *value, bool word) {
    char text[64];
    if (json_is_integer(value))
        snprintf(text, sizeof(text), "%" JSON_INTEGER_FORMAT, json_integer_value(value));
    else if (json_is_real(value))
        noc_snprintf(text, sizeof(text), "%.10g", json_real_value(value));
    else if (json_is_boolean(value))
        snprintf(text, sizeof(text), "%s", json_is_true(value) ? "yes" : "no");
    else if (!json_is_string(value))
        return;
    const char *of = json_is_string(value) ? json_string_value(value) : text;
    if (word)
        cg_word_add(p, feature, key, of);
    else
        cg_attribute_add(p, feature, key, of, true);
}

static void add_attributes(cg_parser *p, uint32_t feature, const json_t *object) {
    static const char *const words[] = { "class",   "function",           "usage",         "name", "terminationDate",
                                         "validTo", "storeysAboveGround", "measuredHeight" };
    bool generic = cg_may_be_lamp(p->object.features.data[feature].type);
    const char *key;
    json_t *value, *attributes = json_object_get(object, "attributes");
    json_object_foreach(attributes, key, value) {
        bool word = false;
        for (size_t i = 0; i < NOC_COUNT(words) && !word; i++)
            word = !strcmp(key, words[i]);
        if (p->status)
            return;
        for (size_t i = 0; word && i < json_array_size(value); i++)
            add_value(p, feature, key, json_array_get(value, i), true);
        if (word || generic)
            add_value(p, feature, key, value, word);
    }
}

/* ---- emission ---- */

/* A part with all below it, however deep. */
static void leave_out(tree *t, uint32_t top) {
    for (uint32_t i = top;;) {
        node *n = &t->nodes[i];
        uint32_t down = n->done && i != top ? CG_NONE : n->first;
        n->done = true;
        if (down != CG_NONE) {
            i = down;
            continue;
        }
        while (i != top && t->nodes[i].next == CG_NONE)
            i = t->nodes[i].parent;
        if (i == top)
            return;
        i = t->nodes[i].next;
    }
}

static void add_node(tree *t, uint32_t i, uint32_t parent, int depth) {
    cg_parser *p = t->r->parser;
    node *n = &t->nodes[i];
    n->done = true;
    if (depth > MOST_NESTED) {
        issue(t, GEO_SKIPPED, "parts nested too deep", n->id);
        leave_out(t, i);
        return;
    }
    uint32_t feature = cg_feature_add(p, n->type, n->id, parent);
    if (feature == CG_NONE) {
        leave_out(t, i);
        return;
    }
    add_attributes(p, feature, n->object);
    cj_geometries(t->r, feature, json_object_get(n->object, "geometry"));
    for (uint32_t c = n->first; c != CG_NONE && !p->status; c = t->nodes[c].next)
        if (!t->nodes[c].done)
            add_node(t, c, feature, depth + 1);
    p->object.features.data[feature].end_geometry = (uint32_t)p->object.geometries.len;
}

static void emit(tree *t, uint32_t i) {
    cg_parser *p = t->r->parser;
    if (t->nodes[i].type->part == CG_PART_GROUP) { /* its members are objects of their own */
        t->nodes[i].done = true;
        if (json_array_size(json_object_get(t->nodes[i].object, "geometry")))
            issue(t, GEO_SKIPPED, "geometry of a group", t->nodes[i].id);
        return;
    }
    cg_object_clear(&p->object);
    add_node(t, i, CG_NONE, 0);
    if (!p->status && p->object.features.len)
        cg_object_end(p);
    if (!p->status && !p->sink->progress(p->sink->ctx, noc_stream_progress(p->stream)))
        p->status = NOC_ERR_CANCELLED;
}

void cj_objects(cj_reading *r, json_t *objects) {
    tree t = { .r = r };
    if (!build(&t, objects))
        cg_no_memory(r->parser);
    for (uint32_t i = 0; i < t.count && !r->parser->status; i++)
        if (t.nodes[i].parent == CG_NONE)
            emit(&t, i);
    for (uint32_t i = 0; i < t.count && !r->parser->status; i++)
        if (!t.nodes[i].done) {
            issue(&t, GEO_GUESSED, "parents that lead in circles", t.nodes[i].id);
            emit(&t, i);
        }
    map_free(&t.ids);
    free(t.nodes);
}
