/* Recipes as text: what noc_recipe_load reads back to the same. */
#include "recipe/recipe.h"

#include <math.h>

typedef struct writing {
    NOC_ARRAY(char) text;
    noc_log *log;
    noc_status status;
} writing;

static void put(writing *w, const char *fmt, ...) NOC_PRINTF(2, 3);
static void put(writing *w, const char *fmt, ...) {
    va_list ap;
    va_start(ap, fmt);
    int length = noc_vsnprintf(NULL, 0, fmt, ap);
    va_end(ap);
    if (w->status)
        return;
    if (length < 0 || !array_reserve(&w->text, w->text.len + (size_t)length + 1)) {
        w->status = noc_no_memory(w->log, "recipe");
        return;
    }
    va_start(ap, fmt);
    noc_vsnprintf(w->text.data + w->text.len, (size_t)length + 1, fmt, ap);
    va_end(ap);
    w->text.len += (size_t)length;
}

/* In double quotes. */
static void put_text(writing *w, const char *text) {
    const char *s = text;
    while (*s && noc_text_utf8(s))
        s += noc_text_utf8(s);
    char shown[80];
    if (*s && !w->status)
        w->status = noc_error(w->log, NOC_ERR_FORMAT, "a recipe is UTF-8, and this is not: %s",
                              noc_text_clean(shown, sizeof(shown), text));
    size_t length = (size_t)noc_text_yaml(NULL, 0, text);
    if (w->status)
        return;
    if (!array_reserve(&w->text, w->text.len + length + 1)) {
        w->status = noc_no_memory(w->log, "recipe");
        return;
    }
    noc_text_yaml(w->text.data + w->text.len, length + 1, text);
    w->text.len += length;
}

/* key: "text" */
static void put_pair(writing *w, const char *before, const char *key, const char *text) {
    put(w, "%s%s: ", before, key);
    put_text(w, text);
}

/* An option's value as text; NULL after noting that there is no memory. free() it. */
static char *value_of(writing *w, const noc_option *o, const void *params) {
    int length = noc_option_get(o, params, NULL, 0);
    char *text = noc_alloc((size_t)length + 1);
    if (text)
        noc_option_get(o, params, text, (size_t)length + 1);
    else if (!w->status)
        w->status = noc_no_memory(w->log, "recipe");
    return text;
}

static void put_options(writing *w, const noc_recipe_value *values, size_t count) {
    for (size_t i = 0; i < count; i++) {
        const noc_recipe_value *v = &values[i];
        if (v->option->kind != NOC_OPTION_TEXTS) {
            put_pair(w, "", v->option->name, v->count ? v->texts[0] : "");
            put(w, "\n");
            continue;
        }
        /* `lamps` is a section, in which files are called so */
        put(w, strcmp(v->option->name, "lamps") ? "%s: [" : "%s: { files: [", v->option->name);
        for (size_t k = 0; k < v->count; k++) {
            put(w, "%s", k ? ", " : "");
            put_text(w, v->texts[k]);
        }
        put(w, strcmp(v->option->name, "lamps") ? "]\n" : "] }\n");
    }
}

/* "view: aerial" or "eye: ..., target: ...", with commas between. */
static void put_place(writing *w, const noc_camera_params *camera) {
    const char *before = "";
    for (const noc_option *o = noc_camera_options(); o->name; o++) {
        char *value = value_of(w, o, camera);
        bool said = value && (strcmp(o->name, "fov") ? *value != 0 : camera->fov > 0);
        if (said && (strcmp(o->name, "view") || !camera->eye)) {
            put_pair(w, before, strcmp(o->name, "camera-crs") ? o->name : "crs", value);
            before = ", ";
        }
        free(value);
    }
}

static void put_cameras(writing *w, const noc_recipe_info *info) {
    put(w, "%s", info->camera_count ? "cameras:\n" : "");
    for (size_t i = 0; i < info->camera_count; i++) {
        put(w, "  ");
        put_text(w, info->cameras[i].name);
        put(w, ": { ");
        put_place(w, &info->cameras[i].params);
        put(w, " }\n");
    }
}

static void put_paths(writing *w, const noc_recipe_info *info) {
    put(w, "%s", info->path_count ? "paths:\n" : "");
    for (size_t i = 0; i < info->path_count; i++) {
        const noc_recipe_path *path = &info->paths[i];
        put(w, "  ");
        put_text(w, path->name);
        put(w, ":\n    loop: %s\n    keys:\n", path->loop ? "on" : "off");
        for (size_t k = 0; k < path->key_count; k++) {
            put(w, "      - { ");
            put_place(w, &path->keys[k].camera);
            if (path->keys[k].seconds >= 0)
                put(w, ", seconds: %.17g", path->keys[k].seconds);
            if (path->keys[k].hour >= 0)
                put(w, ", hour: %.17g", path->keys[k].hour);
            put(w, " }\n");
        }
    }
}

static void put_material(writing *w, const float albedo[3], float f0, float roughness, float metalness) {
    const char *before = " ";
    put(w, ": {");
    if (albedo[0] >= 0) {
        put(w, " albedo: [%.9g, %.9g, %.9g]", (double)albedo[0], (double)albedo[1], (double)albedo[2]);
        before = ", ";
    }
    const struct {
        const char *key;
        float value;
    } rest[] = { { "f0", f0 }, { "roughness", roughness }, { "metalness", metalness } };
    for (size_t i = 0; i < NOC_COUNT(rest); i++)
        if (rest[i].value >= 0) {
            put(w, "%s%s: %.9g", before, rest[i].key, (double)rest[i].value);
            before = ", ";
        }
    put(w, " }\n");
}

static void put_materials(writing *w, const noc_recipe_info *info) {
    put(w, "%s", info->material_count ? "materials:\n" : "");
    for (size_t i = 0; i < info->material_count; i++) {
        const noc_material *m = &info->materials[i];
        put(w, "  %s", noc_class_name(m->cls));
        put_material(w, m->albedo, m->f0, m->roughness, -1);
    }
    put(w, "%s", info->named_material_count ? "materials-by-name:\n" : "");
    for (size_t i = 0; i < info->named_material_count; i++) {
        const noc_named_material *m = &info->named_materials[i];
        put(w, "  ");
        put_text(w, m->name);
        put_material(w, m->albedo, m->f0, m->roughness, m->metalness);
    }
}

static bool says(const noc_option *o, const void *params) {
    union {
        double real;
        int whole;
        const char *text;
        bool on;
    } v;
    memcpy(&v, (const char *)params + o->offset, noc_option_size(o));
    switch (o->kind) {
    case NOC_OPTION_REAL: return !isnan(v.real);
    case NOC_OPTION_TEXT: return v.text;
    case NOC_OPTION_BOOL: return true;
    default: return v.whole != 0;
    }
}

/* "{ match: { ... }, rows }" */
static void put_rule(writing *w, const noc_condition *conditions, size_t count, const noc_option *rows,
                     const void *params) {
    const char *before = " ";
    put(w, "{");
    for (size_t i = 0; i < count; i++) {
        put(w, "%s", i ? ", " : " match: { ");
        put_text(w, conditions[i].key);
        put(w, ": ");
        put_text(w, conditions[i].test);
    }
    if (count) {
        put(w, " }");
        before = ", ";
    }
    for (const noc_option *o = rows; o->name; o++) {
        char *value = says(o, params) ? value_of(w, o, params) : NULL;
        if (value) {
            put_pair(w, before, o->name, value);
            before = ", ";
        }
        free(value);
    }
    put(w, " }\n");
}

/* A file is named as it is found from anywhere. */
static void put_luminaire(writing *w, const noc_luminaire_rule *rule) {
    noc_luminaire_rule r = *rule;
    bool file = r.profile && r.profile_base && *r.profile != '/' && strpbrk(r.profile, "/.");
    char *path = file ? noc_format("%s%s", r.profile_base, r.profile) : NULL;
    if (file && !path && !w->status)
        w->status = noc_no_memory(w->log, "recipe");
    r.profile = path ? path : r.profile;
    put(w, "  - ");
    put_rule(w, r.conditions, r.condition_count, noc_luminaire_options(), &r);
    free(path);
}

static void put_lights(writing *w, const noc_recipe_info *info) {
    put(w, "%s", info->luminaire_count ? "luminaires:\n" : "");
    for (size_t i = 0; i < info->luminaire_count; i++)
        put_luminaire(w, &info->luminaires[i]);
    put(w, "%s", info->group_count ? "groups:\n" : "");
    for (size_t i = 0; i < info->group_count; i++) {
        const noc_group_rule *g = &info->groups[i];
        put(w, "  ");
        put_text(w, g->name);
        put(w, ": ");
        put_rule(w, g->conditions, g->condition_count, noc_group_options(), g);
    }
}

noc_status noc_recipe_write(const noc_recipe_info *info, const noc_recipe_value *values, size_t count, noc_log *log,
                            char **text) {
    static const noc_option preset[] = { NOC_OPTION_PRESET(noc_recipe_info, "") };
    writing w = { .log = log };
    if (text)
        *text = NULL;
    if (!info || (count && !values) || !text)
        return noc_null(log, __func__);
    put(&w, "nocturne: 1\n");
    put_pair(&w, "", "name", info->name && *info->name ? info->name : "city");
    put(&w, "\n%s", info->input_count ? "inputs:\n" : "");
    for (size_t i = 0; i < info->input_count; i++) {
        put(&w, "  - ");
        put_text(&w, info->inputs[i]);
        put(&w, "\n");
    }
    if (info->has_preset) {
        char *value = value_of(&w, preset, info);
        put_pair(&w, "", "preset", value ? value : "");
        put(&w, "\n");
        free(value);
    }
    put_options(&w, values, count);
    put_materials(&w, info);
    put_lights(&w, info);
    put_cameras(&w, info);
    put_paths(&w, info);
    if (w.status)
        array_free(&w.text);
    *text = w.text.data;
    return w.status;
}
