/* What the keys of a recipe mean. Most of them are rows of the option tables, under their own names or, in a section,
 * without the word that they begin with. */
#include "recipe/recipe.h"

#define VERSION "1"

/* Rows that a recipe may say, by their tables. Those of cameras are keys of a camera. */
static const noc_option *(*const tables[])(void) = { noc_import_options, noc_city_options, noc_builtin_options,
                                                     noc_render_options, noc_display_options };
/* Who uses a file decides what may be read, and at what cost, not who wrote it. */
#define HOSTS "Reading"

enum { OWN_KEYS = 2 };
typedef struct section {
    const char *name, *prefix; /* "windows" and "window-": its keys are the rest of the names, */
    const char *group;         /* and whole names of this group; NULL: none */
    bool scalar;               /* one value in its place is that of the option of its name */
    struct {
        const char *key, *option;
    } own[OWN_KEYS]; /* keys for options without the prefix; key NULL: none */
} section;
static const section sections[] = {
    { "lamps", "lamp-", NULL, false, { { "files", "lamps" } } },
    { "windows", "window-", "Windows", true, { { NULL } } },
    { "traffic", "traffic-", "Traffic", true, { { NULL } } },
    { "sky", "environment-", NULL, true, { { "zenith", "sky" }, { "environment", "environment" } } },
};

typedef struct taken {
    recipe_file *file;
    const section *section;    /* NULL: the top */
    noc_recipe_camera *camera; /* that is read */
    noc_named_material *material;
    yaml_node_t *paths; /* taken last: they name cameras */
} taken;

/* ---- options ---- */

static const noc_option *find_in(const noc_option *table, const char *name) {
    for (const noc_option *o = table; o->name; o++)
        if (!strcmp(o->name, name))
            return o;
    return NULL;
}

static const noc_option *find_option(const char *name) {
    const noc_option *found = NULL;
    for (size_t i = 0; i < NOC_COUNT(tables) && !found; i++)
        found = find_in(tables[i](), name);
    return found;
}

noc_status recipe_unknown(const recipe_file *f, const yaml_node_t *key, const char *where, const char *const *words,
                          size_t count) {
    const char *text = recipe_text(key), *nearest = noc_text_nearest(text, words, count);
    char shown[64];
    noc_text_clean(shown, sizeof(shown), text);
    if (!strcmp(text, "<<"))
        return recipe_wrong(f, key, "merge keys (<<) are not read: write the keys out in %s", where);
    return nearest ? recipe_wrong(f, key, "no key %s in %s; is it %s?", shown, where, nearest)
                   : recipe_wrong(f, key, "no key %s in %s", shown, where);
}

static noc_status unknown_option(const taken *t, const yaml_node_t *key) {
    if (find_in(noc_device_options(), recipe_text(key)))
        return recipe_wrong(t->file, key, "%s is the machine's and not a city's: pass --%s to the command",
                            recipe_text(key), recipe_text(key));
    static const char *const others[] = { "nocturne",          "name",    "inputs", "preset",     "materials",
                                          "materials-by-name", "cameras", "paths",  "luminaires", "groups" };
    const char *words[256];
    size_t count = 0, prefix = t->section ? strlen(t->section->prefix) : 0;
    for (size_t i = 0; i < NOC_COUNT(tables); i++)
        for (const noc_option *o = tables[i](); o->name && count < NOC_COUNT(words); o++)
            if (!t->section || !strncmp(o->name, t->section->prefix, prefix))
                words[count++] = o->name + prefix;
            else if (t->section->group && !strcmp(o->group, t->section->group))
                words[count++] = o->name;
    for (size_t i = 0; !t->section && i < NOC_COUNT(others) && count < NOC_COUNT(words); i++)
        words[count++] = others[i];
    for (size_t i = 0; !t->section && i < NOC_COUNT(sections) && count < NOC_COUNT(words); i++)
        words[count++] = sections[i].name;
    for (int i = 0; t->section && i < OWN_KEYS && t->section->own[i].key && count < NOC_COUNT(words); i++)
        words[count++] = t->section->own[i].key;
    return recipe_unknown(t->file, key, t->section ? t->section->name : "a recipe", words, count);
}

static void keep(void *user, noc_log_level level, const char *text) {
    recipe_file *f = user;
    if (level == NOC_LOG_ERROR)
        noc_snprintf(f->told, sizeof(f->told), "%s", text);
}

noc_status recipe_said(const recipe_file *f, const yaml_node_t *node, noc_status status) {
    return !status                    ? NOC_OK
           : status == NOC_ERR_MEMORY ? noc_no_memory(f->log, f->path)
                                      : recipe_wrong(f, node, "%s", f->told);
}

noc_status recipe_set(const recipe_file *f, const yaml_node_t *node, const noc_option *o, void *params,
                      const char *text) {
    return recipe_said(f, node, noc_option_set(o, params, text, f->listener));
}

noc_status recipe_option(recipe_file *f, const noc_option *o, yaml_node_t *value, void *params) {
    const char *text = recipe_text(value), *kept = text ? arena_strdup(&f->recipe->arena, text) : NULL;
    if (!text)
        return recipe_wrong(f, value, value->type == YAML_SCALAR_NODE ? "%s has no value" : "%s is one value", o->name);
    return kept ? recipe_set(f, value, o, params, kept) : noc_no_memory(f->log, f->path);
}

static noc_status set_all(const recipe_setting *s, void *params, noc_log *log) {
    noc_status status = NOC_OK;
    if (s->option->kind == NOC_OPTION_TEXTS)
        memset((char *)params + s->option->offset, 0, sizeof(noc_texts));
    for (size_t i = 0; i < s->count && !status; i++)
        status = noc_option_set(s->option, params, s->texts[i], log);
    return status;
}

static noc_status take_option(recipe_file *f, const noc_option *o, const yaml_node_t *key, yaml_node_t *value) {
    union { /* any of the structs that rows are of */
        noc_render_params render;
        noc_display_params display;
        noc_import_params import;
        noc_builtin_params builtin;
    } scratch;
    noc_recipe *r = f->recipe;
    if (!strcmp(o->group, HOSTS))
        return recipe_wrong(f, key, "%s is for who reads the files to say: --%s on the command line", o->name, o->name);
    for (size_t i = 0; i < r->settings.len; i++)
        if (r->settings.data[i].option == o)
            return recipe_wrong(f, key, "%s is given twice", o->name);
    recipe_setting s = { .option = o };
    if (value->type == YAML_MAPPING_NODE || (value->type == YAML_SEQUENCE_NODE && o->kind != NOC_OPTION_TEXTS))
        return recipe_wrong(f, value, "%s is one value", o->name);
    noc_status status = recipe_texts(f, value, o->name, &s.texts, &s.count);
    memset(&scratch, 0, sizeof(scratch));
    for (size_t i = 0; i < s.count && !status; i++) {
        if (!strcmp(o->unit, "FILE"))
            s.texts[i] = recipe_path(f, s.texts[i]);
        status = s.texts[i] ? recipe_set(f, value, o, &scratch, s.texts[i]) : noc_no_memory(f->log, f->path);
    }
    if (!status && !array_push(&r->settings, s))
        status = noc_no_memory(f->log, f->path);
    return status;
}

static noc_status take_section_key(void *ctx, const yaml_node_t *key, yaml_node_t *value) {
    taken *t = ctx;
    const section *s = t->section;
    const char *name = recipe_text(key);
    char whole[100];
    noc_snprintf(whole, sizeof(whole), "%s%s", s->prefix, name);
    for (int i = 0; i < OWN_KEYS && s->own[i].key; i++)
        if (!strcmp(name, s->own[i].key))
            noc_snprintf(whole, sizeof(whole), "%s", s->own[i].option);
    const noc_option *o = find_option(whole);
    if (!o && s->group && (o = find_option(name)) && strcmp(o->group, s->group))
        o = NULL;
    return o ? take_option(t->file, o, key, value) : unknown_option(t, key);
}

/* ---- cameras ---- */

noc_status recipe_camera_key(recipe_file *f, noc_camera_params *params, const yaml_node_t *key, yaml_node_t *value,
                             const char *what, const char *const *words, size_t word_count) {
    const char *name = recipe_text(key), *row = !strcmp(name, "crs") ? "camera-crs" : name, **texts = NULL;
    const noc_option *o = find_in(noc_camera_options(), row);
    if (!o || !strcmp(name, "camera-crs"))
        return recipe_unknown(f, key, what, words, word_count);
    bool place = !strcmp(name, "eye") || !strcmp(name, "target");
    size_t count;
    if (value->type == YAML_MAPPING_NODE || (value->type == YAML_SEQUENCE_NODE && !place))
        return recipe_wrong(f, value, "%s is one value", name);
    noc_status status = recipe_texts(f, value, name, &texts, &count);
    if (!status && place && count == 3) /* [x, y, z] is as good as "x,y,z" */
        texts[0] = arena_format(&f->recipe->arena, "%s,%s,%s", texts[0], texts[1], texts[2]);
    double xyz[3];
    if (!status && !(count && texts[0]))
        status = count ? noc_no_memory(f->log, f->path) : recipe_wrong(f, value, "%s has no value", name);
    if (!status && place && !noc_text_numbers(texts[0], ',', 3, xyz))
        status = recipe_wrong(f, value, "%s: \"%.60s\" is not X, Y, Z", name, texts[0]);
    return status ? status : recipe_set(f, value, o, params, texts[0]);
}

const char *recipe_misplaced(const noc_camera_params *params) {
    double eye[3], target[3];
    if (!params->eye != !params->target || (!params->eye && params->crs))
        return "eye and target go together, and crs with them";
    bool same = params->eye && noc_text_numbers(params->eye, ',', 3, eye) &&
                noc_text_numbers(params->target, ',', 3, target) && !memcmp(eye, target, sizeof(eye));
    return same ? "eye and target are the same place" : NULL;
}

static noc_status take_camera_key(void *ctx, const yaml_node_t *key, yaml_node_t *value) {
    static const char *const words[] = { "view", "eye", "target", "crs", "fov" };
    taken *t = ctx;
    return recipe_camera_key(t->file, &t->camera->params, key, value, "a camera", words, NOC_COUNT(words));
}

static noc_status take_camera(void *ctx, const yaml_node_t *key, yaml_node_t *value) {
    taken *t = ctx;
    noc_recipe *r = t->file->recipe;
    noc_recipe_camera camera = { arena_strdup(&r->arena, recipe_text(key)), noc_camera_default_params() };
    t->camera = &camera;
    noc_status status = recipe_each(t->file, value, "a camera", take_camera_key, t);
    const char *misplaced = status ? NULL : recipe_misplaced(&camera.params);
    if (misplaced)
        status = recipe_wrong(t->file, key, "camera %.60s: %s", recipe_text(key), misplaced);
    if (!status && !(camera.name && array_push(&r->cameras, camera)))
        status = noc_no_memory(t->file->log, t->file->path);
    return status;
}

/* ---- materials ---- */

static noc_status take_number(recipe_file *f, yaml_node_t *node, const char *key, float *out) {
    double v;
    const char *text = recipe_text(node);
    if (!text || !noc_parse_double(text, &v))
        return recipe_wrong(f, node, "%s must be a number", key);
    *out = (float)v;
    return NOC_OK;
}

#define UNTOLD (-1e30f) /* noc_named_material: a negative number that nobody writes */

static noc_status take_material_key(void *ctx, const yaml_node_t *key, yaml_node_t *value) {
    taken *t = ctx;
    recipe_file *f = t->file;
    const char *name = recipe_text(key);
    noc_named_material *m = t->material;
    noc_status status = NOC_OK;
    if (!strcmp(name, "albedo") && value->type == YAML_SCALAR_NODE) {
        status = take_number(f, value, name, &m->albedo[0]);
        m->albedo[1] = m->albedo[2] = m->albedo[0];
    } else if (!strcmp(name, "albedo")) {
        double rgb[3];
        status = recipe_numbers(f, value, name, 3, rgb);
        for (int i = 0; i < 3 && !status; i++)
            m->albedo[i] = (float)rgb[i];
    } else if (!strcmp(name, "f0")) {
        status = take_number(f, value, name, &m->f0);
    } else if (!strcmp(name, "roughness")) {
        status = take_number(f, value, name, &m->roughness);
    } else if (!strcmp(name, "metalness")) {
        status = take_number(f, value, name, &m->metalness);
    } else {
        static const char *const words[] = { "albedo", "f0", "roughness", "metalness" };
        return recipe_unknown(f, key, "a material", words, NOC_COUNT(words));
    }
    const float told[] = { m->albedo[0], m->albedo[1], m->albedo[2], m->f0, m->metalness, m->roughness };
    bool ok = true;
    for (size_t i = 0; i < NOC_COUNT(told); i++)
        ok = ok && (told[i] == UNTOLD || (told[i] >= (i == 5 ? .05f : 0) && told[i] <= 1));
    if (!status && !ok)
        return recipe_wrong(f, value, "%s: albedo, f0 and metalness are 0 to 1, roughness .05 to 1", name);
    if (!status && m->f0 != UNTOLD && m->metalness != UNTOLD)
        return recipe_wrong(f, value, "%s: f0 and metalness tell the same thing", name);
    return status;
}

static const noc_named_material untold_material = {
    .albedo = { UNTOLD, UNTOLD, UNTOLD }, .f0 = UNTOLD, .roughness = UNTOLD, .metalness = UNTOLD
};

/* A surface: its keys, or the name of a road class. */
static noc_status take_surface(taken *t, yaml_node_t *value, noc_named_material *told) {
    *told = untold_material;
    t->material = told;
    if (value->type != YAML_SCALAR_NODE)
        return recipe_each(t->file, value, "a material", take_material_key, t);
    char names[80] = "", said[64];
    size_t n = 0;
    const char *text = recipe_text(value) ? recipe_text(value) : "";
    for (const noc_road_class *c = noc_road_classes(); c->name; c++) {
        if (noc_ieq(c->name, text)) {
            told->albedo[0] = told->albedo[1] = told->albedo[2] = c->albedo;
            told->f0 = c->f0;
            told->roughness = c->roughness;
            return NOC_OK;
        }
        n += (size_t)noc_snprintf(names + n, sizeof(names) - n, "%s%s", n ? ", " : "", c->name);
    }
    return recipe_wrong(t->file, value, "a material is a mapping or a class of road surfaces (%s), not \"%s\"", names,
                        noc_text_clean(said, sizeof(said), text));
}

static noc_status take_material(void *ctx, const yaml_node_t *key, yaml_node_t *value) {
    taken *t = ctx;
    noc_recipe *r = t->file->recipe;
    const char *words[NOC_CLASS_COUNT];
    int cls = -1;
    for (int i = 0; i < NOC_CLASS_COUNT; i++) {
        words[i] = noc_class_name((noc_class)i);
        cls = !strcmp(words[i], recipe_text(key)) ? i : cls;
    }
    if (cls < 0)
        return recipe_unknown(t->file, key, "materials, whose keys are classes", words, NOC_CLASS_COUNT);
    noc_material material = noc_class_material((noc_class)cls);
    noc_named_material told;
    noc_status status = take_surface(t, value, &told);
    if (told.albedo[0] != UNTOLD)
        memcpy(material.albedo, told.albedo, sizeof(material.albedo));
    material.f0 = told.f0 != UNTOLD ? told.f0 : material.f0;
    material.roughness = told.roughness != UNTOLD ? told.roughness : material.roughness;
    if (told.metalness != UNTOLD)
        material = noc_material_metal(&material, told.metalness);
    return status || array_push(&r->materials, material) ? status : noc_no_memory(t->file->log, t->file->path);
}

static noc_status take_named_material(void *ctx, const yaml_node_t *key, yaml_node_t *value) {
    taken *t = ctx;
    noc_recipe *r = t->file->recipe;
    noc_named_material told;
    noc_status status = take_surface(t, value, &told);
    if (status)
        return status;
    told.name = arena_strdup(&r->arena, recipe_text(key));
    return told.name && array_push(&r->named_materials, told) ? NOC_OK : noc_no_memory(t->file->log, t->file->path);
}

/* ---- the top ---- */

static noc_status take_inputs(recipe_file *f, yaml_node_t *value) {
    const char **texts;
    size_t count;
    if (f->built)
        return recipe_wrong(f, value, "the recipe of a built city names no inputs");
    if (value->type == YAML_MAPPING_NODE)
        return recipe_wrong(f, value, "inputs is a list of files");
    noc_status status = recipe_texts(f, value, "inputs", &texts, &count);
    for (size_t i = 0; i < count && !status; i++) {
        const char *path = recipe_path(f, texts[i]);
        status = path && array_push(&f->recipe->inputs, path) ? NOC_OK : noc_no_memory(f->log, f->path);
    }
    return status;
}

static noc_status take_preset(recipe_file *f, yaml_node_t *value) {
    static const noc_option row[] = { NOC_OPTION_PRESET(noc_recipe_info, "") };
    f->recipe->info.has_preset = true;
    int preset = 0; /* the row's field, whatever the enum is stored as */
    noc_option o = row[0];
    o.offset = 0;
    noc_status status = recipe_text(value) ? recipe_set(f, value, &o, &preset, recipe_text(value))
                                           : recipe_wrong(f, value, "preset has no value");
    f->recipe->info.preset = (noc_preset)preset;
    return status;
}

static noc_status take_top(void *ctx, const yaml_node_t *key, yaml_node_t *value) {
    taken *t = ctx;
    recipe_file *f = t->file;
    const char *name = recipe_text(key), *text = recipe_text(value);
    if (!strcmp(name, "nocturne")) {
        if (!text || strcmp(text, VERSION))
            return recipe_wrong(f, value, "this version of nocturne reads recipes of version " VERSION);
        return NOC_OK;
    }
    if (!strcmp(name, "name")) {
        f->recipe->info.name = text ? arena_strdup(&f->recipe->arena, text) : NULL;
        if (!text)
            return recipe_wrong(f, value, "name must be a text");
        return f->recipe->info.name ? NOC_OK : noc_no_memory(f->log, f->path);
    }
    if (!strcmp(name, "inputs"))
        return take_inputs(f, value);
    if (!strcmp(name, "preset"))
        return take_preset(f, value);
    if (!strcmp(name, "materials"))
        return recipe_each(f, value, "materials", take_material, t);
    if (!strcmp(name, "materials-by-name"))
        return recipe_each(f, value, "materials-by-name", take_named_material, t);
    if (!strcmp(name, "cameras"))
        return recipe_each(f, value, "cameras", take_camera, t);
    if (!strcmp(name, "paths")) {
        t->paths = value;
        return NOC_OK;
    }
    if (!strcmp(name, "luminaires"))
        return recipe_take_luminaires(f, value);
    if (!strcmp(name, "groups"))
        return recipe_take_groups(f, value);
    for (size_t i = 0; i < NOC_COUNT(sections); i++)
        /* a scalar switches the whole: windows: off */
        if (!strcmp(name, sections[i].name) && (value->type != YAML_SCALAR_NODE || !sections[i].scalar)) {
            t->section = &sections[i];
            noc_status status = recipe_each(f, value, name, take_section_key, t);
            t->section = NULL;
            return status;
        }
    const noc_option *o = find_option(name);
    return o ? take_option(f, o, key, value) : unknown_option(t, key);
}

static noc_status take_all(recipe_file *f) {
    taken t = { .file = f };
    yaml_node_t *root = yaml_document_get_root_node(&f->yaml);
    bool ours = root && root->type == YAML_MAPPING_NODE;
    yaml_node_pair_t *first = ours ? root->data.mapping.pairs.start : NULL;
    const char *key = ours && first < root->data.mapping.pairs.top ? recipe_text(recipe_node(f, first->key)) : NULL;
    if (!key || strcmp(key, "nocturne"))
        return recipe_wrong(f, root, "a recipe begins with \"nocturne: " VERSION "\"");
    noc_status status = recipe_each(f, root, "a recipe", take_top, &t);
    if (!status && t.paths)
        status = recipe_take_paths(f, t.paths);
    bool any = f->recipe->inputs.len > 0 || f->built;
    for (size_t i = 0; i < f->recipe->settings.len; i++)
        any = any || !strcmp(f->recipe->settings.data[i].option->name, "lamps");
    return status || any ? status : recipe_wrong(f, NULL, "names no inputs");
}

noc_status noc_recipe_load(const char *path, noc_log *log, noc_recipe **recipe) {
    if (!path || !recipe)
        return noc_null(log, __func__);
    *recipe = NULL;
    recipe_file f = {
        .path = path, .log = log, .built = noc_built_is(path), .recipe = noc_calloc(1, sizeof(*f.recipe))
    };
    f.listener = noc_log_create(&(noc_log_params){ .message = keep, .user = &f });
    noc_status status = f.recipe && f.listener ? recipe_open(&f) : noc_no_memory(log, path);
    if (!status) {
        status = take_all(&f);
        yaml_document_delete(&f.yaml);
    }
    noc_log_destroy(f.listener);
    const char *kept = status ? NULL : arena_strdup(&f.recipe->arena, path);
    if (!status && (!kept || (f.built && !array_push(&f.recipe->inputs, kept))))
        status = noc_no_memory(log, path);
    if (status) {
        noc_recipe_destroy(f.recipe);
        return status;
    }
    noc_recipe_info *info = &f.recipe->info;
    info->path = kept;
    info->name = info->name ? info->name : "";
    info->inputs = f.recipe->inputs.data;
    info->input_count = f.recipe->inputs.len;
    info->cameras = f.recipe->cameras.data;
    info->camera_count = f.recipe->cameras.len;
    info->paths = f.recipe->paths.data;
    info->path_count = f.recipe->paths.len;
    info->materials = f.recipe->materials.data;
    info->material_count = f.recipe->materials.len;
    info->named_materials = f.recipe->named_materials.data;
    info->named_material_count = f.recipe->named_materials.len;
    info->luminaires = f.recipe->luminaires.data;
    info->luminaire_count = f.recipe->luminaires.len;
    info->groups = f.recipe->groups.data;
    info->group_count = f.recipe->groups.len;
    *recipe = f.recipe;
    return NOC_OK;
}

void noc_recipe_destroy(noc_recipe *recipe) {
    if (!recipe)
        return;
    array_free(&recipe->settings);
    array_free(&recipe->inputs);
    array_free(&recipe->cameras);
    array_free(&recipe->paths);
    array_free(&recipe->materials);
    array_free(&recipe->named_materials);
    array_free(&recipe->luminaires);
    array_free(&recipe->groups);
    arena_free(&recipe->arena);
    free(recipe);
}

const noc_recipe_info *noc_recipe_get_info(const noc_recipe *recipe) {
    static const noc_recipe_info none = { .path = "", .name = "" };
    return recipe ? &recipe->info : &none;
}

void noc_recipe_lists(const noc_recipe *recipe, noc_import_params *params) {
    if (!recipe || !params)
        return;
    params->materials = recipe->info.materials;
    params->material_count = recipe->info.material_count;
    params->named_materials = recipe->info.named_materials;
    params->named_material_count = recipe->info.named_material_count;
    params->luminaires = recipe->info.luminaires;
    params->luminaire_count = recipe->info.luminaire_count;
    params->groups = recipe->info.groups;
    params->group_count = recipe->info.group_count;
}

const noc_option *noc_recipe_option(const noc_recipe *recipe, size_t index) {
    return recipe && index < recipe->settings.len ? recipe->settings.data[index].option : NULL;
}

noc_status noc_recipe_set(const noc_recipe *recipe, const noc_option *option, void *params, noc_log *log) {
    if (!recipe || !option || !params)
        return noc_null(log, __func__);
    for (size_t i = 0; i < recipe->settings.len; i++)
        if (recipe->settings.data[i].option == option)
            return set_all(&recipe->settings.data[i], params, log);
    return noc_error(log, NOC_ERR_ARGUMENT, "%.100s: the recipe does not say it", option->name);
}
