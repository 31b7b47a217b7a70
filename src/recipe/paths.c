/* Paths of cameras: keys in a list, each a camera of the recipe by name, or one of its own. */
#include "recipe/recipe.h"

typedef struct taken_path {
    recipe_file *file;
    noc_recipe_path *path;
    noc_path_key *keys; /* of the path */
    noc_path_key *key;  /* that is read */
    const char *camera; /* that it names */
} taken_path;

static const noc_option key_options[] = {
    { "seconds", "", NOC_OPTION_REAL, offsetof(noc_path_key, seconds), 0, NOC_PATH_MOST_SECONDS, NULL, "s", "" },
    { "hour", "", NOC_OPTION_REAL, offsetof(noc_path_key, hour), 0, 24, NULL, "h", "" },
};
static const noc_option loop_option = {
    "loop", "", NOC_OPTION_BOOL, offsetof(noc_recipe_path, loop), 0, 1, NULL, "", ""
};

static noc_status take_value(const recipe_file *f, const yaml_node_t *node, const noc_option *o, void *params) {
    const char *text = recipe_text(node);
    return text ? recipe_set(f, node, o, params, text) : recipe_wrong(f, node, "%s has no value", o->name);
}

static noc_status take_camera(taken_path *t, yaml_node_t *value) {
    const noc_recipe *r = t->file->recipe;
    const char *name = recipe_text(value);
    for (size_t i = 0; name && i < r->cameras.len; i++) {
        if (strcmp(r->cameras.data[i].name, name))
            continue;
        double fov = t->key->camera.fov; /* said before */
        t->key->camera = r->cameras.data[i].params;
        t->key->camera.fov = fov > 0 ? fov : t->key->camera.fov;
        t->camera = r->cameras.data[i].name;
        return NOC_OK;
    }
    char shown[64];
    return recipe_wrong(t->file, value, "the recipe has no camera %s", noc_text_clean(shown, sizeof(shown), name));
}

static noc_status take_key_part(void *ctx, const yaml_node_t *key, yaml_node_t *value) {
    static const char *const words[] = { "camera", "view", "eye", "target", "crs", "fov", "seconds", "hour" };
    taken_path *t = ctx;
    const char *name = recipe_text(key);
    for (size_t i = 0; i < NOC_COUNT(key_options); i++)
        if (!strcmp(name, key_options[i].name))
            return take_value(t->file, value, &key_options[i], t->key);
    if (!strcmp(name, "camera"))
        return take_camera(t, value);
    return recipe_camera_key(t->file, &t->key->camera, key, value, "a key of a path", words, NOC_COUNT(words));
}

/* Where a camera is named, it alone says the place; fov may be another. */
static noc_status take_key(taken_path *t, yaml_node_t *node, size_t index) {
    noc_path_key *key = t->key = &t->keys[index];
    *key = noc_path_key_default();
    t->camera = NULL;
    noc_status status = recipe_each(t->file, node, "a key of a path", take_key_part, t);
    bool own = false, view = false;
    for (const yaml_node_pair_t *p = node->data.mapping.pairs.start; !status && p < node->data.mapping.pairs.top; p++) {
        const char *name = recipe_text(recipe_node(t->file, p->key));
        own = own || !strcmp(name, "eye") || !strcmp(name, "target") || !strcmp(name, "crs");
        view = view || !strcmp(name, "view");
    }
    if (!status && (t->camera ? 1 : 0) + own + view != 1)
        status = recipe_wrong(t->file, node, "a key of a path is where a camera, a view, or an eye and a target say");
    const char *misplaced = status ? NULL : recipe_misplaced(&key->camera);
    if (misplaced)
        status = recipe_wrong(t->file, node, "%s", misplaced);
    const noc_path_key *before = index ? key - 1 : NULL;
    bool told = key->seconds >= 0, told_before = before && before->seconds >= 0;
    if (!status && before && told != told_before && !(told && index == 1)) /* the first is at 0 s without a word */
        status = recipe_wrong(t->file, node, "all keys of a path tell their seconds, or none does");
    if (!status && before && told && key->seconds <= NOC_MAX(before->seconds, 0))
        status = recipe_wrong(t->file, node, "seconds must grow from key to key");
    return status;
}

static noc_status take_keys(taken_path *t, yaml_node_t *node) {
    if (node->type != YAML_SEQUENCE_NODE)
        return recipe_wrong(t->file, node, "keys is a list of cameras");
    size_t count = (size_t)(node->data.sequence.items.top - node->data.sequence.items.start);
    if (!count || count > NOC_PATH_MOST_KEYS)
        return recipe_wrong(t->file, node, "a path has 1 to %d keys, not %zu", NOC_PATH_MOST_KEYS, count);
    t->path->key_count = count;
    t->path->keys = t->keys = arena_alloc(&t->file->recipe->arena, count * sizeof(*t->keys));
    noc_status status = t->keys ? NOC_OK : noc_no_memory(t->file->log, t->file->path);
    for (size_t i = 0; i < count && !status; i++)
        status = take_key(t, recipe_node(t->file, node->data.sequence.items.start[i]), i);
    return status;
}

static noc_status take_path_part(void *ctx, const yaml_node_t *key, yaml_node_t *value) {
    static const char *const words[] = { "loop", "keys" };
    taken_path *t = ctx;
    const char *name = recipe_text(key);
    if (!strcmp(name, "keys"))
        return take_keys(t, value);
    if (strcmp(name, "loop"))
        return recipe_unknown(t->file, key, "a path", words, NOC_COUNT(words));
    return take_value(t->file, value, &loop_option, t->path);
}

static noc_status take_path(void *ctx, const yaml_node_t *key, yaml_node_t *value) {
    recipe_file *f = ctx;
    noc_recipe *r = f->recipe;
    noc_recipe_path path = { .name = arena_strdup(&r->arena, recipe_text(key)) };
    taken_path t = { .file = f, .path = &path };
    noc_status status = recipe_each(f, value, "a path", take_path_part, &t);
    if (!status && !path.key_count)
        status = recipe_wrong(f, key, "path %.60s has no keys", path.name ? path.name : "");
    if (!status && !(path.name && array_push(&r->paths, path)))
        status = noc_no_memory(f->log, f->path);
    return status;
}

noc_status recipe_take_paths(recipe_file *f, yaml_node_t *value) {
    return recipe_each(f, value, "paths", take_path, f);
}
