/* The view as a recipe: all that its inputs' own recipe says, what was said beside it, and what was set. */
#include "viewer/option.h"
#include "viewer/out.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_VALUES = 200, MOST_NAME = 160 };

/* A recipe that is put together; `text` holds what it needs of memory. */
typedef struct made {
    noc_recipe_info info;
    noc_recipe_value values[MOST_VALUES];
    void *kept[2 * MOST_VALUES + 64];
    size_t count, kept_count;
    bool refused;
} made;

static void *keep(made *m, void *p) {
    if (!p || m->kept_count == sizeof(m->kept) / sizeof(*m->kept)) {
        m->refused = true;
        free(p);
        return NULL;
    }
    return m->kept[m->kept_count++] = p;
}

static char *keep_text(made *m, const char *text) { return keep(m, strdup(text)); }

/* The file as it is found from anywhere. */
static const char *whole_path(made *m, const char *path) {
    char *whole = strncmp(path, "builtin:", 8) ? realpath(path, NULL) : NULL;
    return whole ? keep(m, whole) : path;
}

/* ---- options ---- */

/* The later word of an option counts. */
static noc_recipe_value *value_for(made *m, const noc_option *o) {
    for (size_t i = 0; i < m->count; i++)
        if (m->values[i].option == o)
            return &m->values[i];
    if (m->count == MOST_VALUES) {
        m->refused = true;
        return NULL;
    }
    m->values[m->count].option = o;
    return &m->values[m->count++];
}

static void say(made *m, const noc_option *o, const char *text) {
    noc_recipe_value *v = value_for(m, o);
    const char **texts = v ? keep(m, malloc(sizeof(*texts))) : NULL;
    if (!texts)
        return;
    texts[0] = !strcmp(o->unit, "FILE") ? whole_path(m, text) : keep_text(m, text);
    v->texts = texts;
    v->count = 1;
}

static void say_texts(made *m, const noc_option *o, const noc_texts *said) {
    noc_recipe_value *v = value_for(m, o);
    const char **texts = v ? keep(m, calloc(NOC_TEXTS, sizeof(*texts))) : NULL;
    for (size_t i = 0; texts && i < said->count; i++)
        texts[i] = !strcmp(o->unit, "FILE") ? whole_path(m, said->text[i]) : said->text[i];
    if (texts) {
        v->texts = texts;
        v->count = said->count;
    }
}

/* The option as params have it. */
static void say_field(made *m, const noc_option *o, const void *params) {
    char text[1000];
    if (o->kind == NOC_OPTION_TEXTS)
        say_texts(m, o, (const noc_texts *)(const void *)((const char *)params + o->offset));
    else if (noc_option_get(o, params, text, sizeof(text)) < (int)sizeof(text) && *text)
        say(m, o, text);
}

static bool of_table(const noc_option *table, const noc_option *option) {
    for (const noc_option *o = table; o->name; o++)
        if (o == option)
            return true;
    return false;
}

/* What says of a city how it is read; who reads files says what is of the group Reading. What is set comes later. */
static bool is_input(const noc_option *o) {
    static const noc_option *(*const tables[])(void) = { noc_import_options, noc_city_options, noc_builtin_options };
    bool known = false;
    for (size_t i = 0; i < sizeof(tables) / sizeof(*tables); i++)
        known = known || of_table(tables[i](), o);
    return known && strcmp(o->group, "Reading") && strcmp(o->name, "group");
}

static void say_source(made *m, const viewer_source *source) {
    union {
        noc_import_params import;
        noc_builtin_params builtin;
        noc_city_params city;
    } params;
    const noc_option *o;
    for (size_t i = 0; (o = noc_recipe_option(source->recipe, i)); i++) {
        memset(&params, 0, sizeof(params));
        if (is_input(o) && !noc_recipe_set(source->recipe, o, &params, NULL))
            say_field(m, o, &params);
    }
    for (size_t i = 0; i < source->given_count; i++)
        if (is_input(source->given[i].option))
            say_field(m, source->given[i].option, source->given[i].params);
}

static void say_inputs(made *m, const viewer_source *source) {
    const noc_recipe_info *recipe = noc_recipe_get_info(source->recipe);
    const char **inputs = keep(m, calloc(source->said_count + recipe->input_count + 1, sizeof(*inputs)));
    size_t count = 0;
    for (size_t i = 0; inputs && i < source->said_count; i++) {
        bool is = source->recipe && noc_recipe_is(source->said[i]);
        for (size_t k = 0; is && k < recipe->input_count; k++)
            inputs[count++] = whole_path(m, recipe->inputs[k]);
        if (!is)
            inputs[count++] = whole_path(m, source->said[i]);
    }
    m->info.inputs = inputs;
    m->info.input_count = count;
}

/* Files of profiles are found from anywhere. */
static void say_luminaires(made *m) {
    noc_luminaire_rule *rules = keep(m, calloc(m->info.luminaire_count + 1, sizeof(*rules)));
    const char *base = NULL, *whole = NULL;
    for (size_t i = 0; rules && i < m->info.luminaire_count; i++) {
        rules[i] = m->info.luminaires[i];
        if (!rules[i].profile_base)
            continue;
        if (!whole || strcmp(base, rules[i].profile_base)) {
            base = rules[i].profile_base;
            const char *folder = whole_path(m, *base ? base : ".");
            char *slashed = keep(m, malloc(strlen(folder) + 2));
            whole = slashed;
            if (slashed)
                sprintf(slashed, "%s/", folder);
        }
        rules[i].profile_base = whole;
    }
    m->info.luminaires = rules;
}

/* ---- what is set ---- */

static bool differs(const noc_option *o, const void *a, const void *b) {
    return memcmp((const char *)a + o->offset, (const char *)b + o->offset, noc_option_size(o)) != 0;
}

/* Beside the program's defaults and the preset. A recipe has no mode. */
static void say_look(made *m, const out_view *v, bool has_map) {
    noc_render_params begin = noc_render_default_params(), now = look_params(v->look, v->width, v->height);
    noc_display_params shown = noc_display_default_params();
    m->info.has_preset = true;
    m->info.preset = (noc_preset)v->look->preset;
    noc_render_use_preset(&begin, m->info.preset);
    for (const noc_option *o = noc_render_options(); o->name; o++)
        if (differs(o, &now, &begin) && (has_map || strncmp(o->name, "environment-", 12)))
            say_field(m, o, &now);
    for (const noc_option *o = noc_display_options(); o->name; o++)
        if (differs(o, &v->look->display, &shown))
            say_field(m, o, &v->look->display);
}

static const noc_option *import_option(const char *name) {
    for (const noc_option *o = noc_import_options(); o->name; o++)
        if (!strcmp(o->name, name))
            return o;
    return NULL;
}

/* Materials of the recipe, and in their place those that were set. */
static void say_materials(made *m, const world_made *world) {
    noc_material *all = keep(m, calloc(m->info.material_count + world->material_count + 1, sizeof(*all)));
    size_t count = 0;
    for (size_t i = 0; all && i < m->info.material_count; i++) {
        bool set = false;
        for (size_t k = 0; k < world->material_count; k++)
            set = set || world->materials[k].cls == m->info.materials[i].cls;
        if (!set)
            all[count++] = m->info.materials[i];
    }
    for (size_t k = 0; all && k < world->material_count; k++)
        all[count++] = world->materials[k];
    m->info.materials = all;
    m->info.material_count = count;
}

static void say_world(made *m, const world_made *world) {
    noc_texts states = { .count = 0 };
    char text[200];
    for (size_t i = 0; i < world->setting_count; i++)
        say(m, world->settings[i].option, world->settings[i].value);
    for (size_t i = 0; i < world->group_count && states.count < NOC_TEXTS; i++) {
        snprintf(text, sizeof(text), "%.80s=", world->groups[i].name);
        world_group_text(&world->groups[i], text + strlen(text), sizeof(text) - strlen(text));
        states.text[states.count] = keep_text(m, text);
        states.count += states.text[states.count] != NULL;
    }
    if (states.count)
        say_texts(m, import_option("group"), &states);
    if (world->no_traffic)
        say(m, import_option("traffic"), "off");
    say_materials(m, world);
}

/* ---- cameras ---- */

static const noc_option number = { "", "", NOC_OPTION_REAL, 0, -1e30, 1e30, NULL, "", "" };

static const char *place_text(made *m, const noc_scene *scene, bool crs, const double local[3]) {
    char text[200] = "";
    double p[3] = { local[0], local[1], local[2] };
    size_t n = 0;
    if (crs && noc_scene_from_local(scene, NULL, p))
        m->refused = true;
    for (int i = 0; i < 3; i++) {
        n += (size_t)snprintf(text + n, sizeof(text) - n, "%s", i ? "," : "");
        n += (size_t)noc_option_get(&number, &p[i], text + n, sizeof(text) - n);
    }
    return keep_text(m, text);
}

/* One without a name, with that of another, or with one that is longer than a key of YAML may be (1024 characters, six
 * of which one may take), is left out. */
static void add_camera(noc_recipe_camera *all, size_t *count, const char *name, const noc_camera_params *params) {
    bool there = !*name || strlen(name) > MOST_NAME;
    for (size_t i = 0; i < *count; i++)
        there = there || !strcmp(all[i].name, name);
    if (there)
        return;
    all[(*count)++] = (noc_recipe_camera){ name, *params };
}

/* In the scene's CRS, which other inputs beside these do not move. */
static noc_camera_params place(made *m, const noc_scene *scene, const noc_camera *camera) {
    noc_scene_info info;
    noc_scene_get_info(scene, &info);
    bool crs = info.given_crs && *info.given_crs;
    noc_camera_params p = noc_camera_default_params();
    p.eye = place_text(m, scene, crs, camera->eye);
    p.target = place_text(m, scene, crs, camera->target);
    p.crs = crs ? "scene" : NULL;
    p.fov = camera->fov_deg;
    return p;
}

/* The view first, then bookmarks, then the recipe's; and a path through the bookmarks. */
static void say_cameras(made *m, const out_view *v, const out_bookmark *bookmarks, size_t bookmark_count) {
    const noc_recipe_info *recipe = noc_recipe_get_info(v->source->recipe);
    const noc_scene *scene = world_scene(v->world);
    noc_recipe_camera *all = keep(m, calloc(1 + bookmark_count + recipe->camera_count, sizeof(*all)));
    noc_recipe_path *paths = keep(m, calloc(1 + recipe->path_count, sizeof(*paths)));
    noc_path_key *keys = keep(m, calloc(bookmark_count + 1, sizeof(*keys)));
    noc_camera_params view = place(m, scene, v->camera);
    size_t path_count = 0;
    if (!all || !paths || !keys)
        return;
    m->info.camera_count = 0;
    m->info.cameras = all;
    add_camera(all, &m->info.camera_count, "view", &view);
    for (size_t i = 0; i < bookmark_count; i++) {
        noc_camera_params p = place(m, scene, &bookmarks[i].camera);
        keys[i] = noc_path_key_default();
        keys[i].camera = p;
        add_camera(all, &m->info.camera_count, bookmarks[i].name, &p);
    }
    for (size_t i = 0; i < recipe->camera_count; i++)
        add_camera(all, &m->info.camera_count, recipe->cameras[i].name, &recipe->cameras[i].params);
    if (bookmark_count > 1)
        paths[path_count++] = (noc_recipe_path){ .name = "bookmarks", .key_count = bookmark_count, .keys = keys };
    for (size_t i = 0; i < recipe->path_count; i++)
        if (bookmark_count < 2 || strcmp(recipe->paths[i].name, "bookmarks"))
            paths[path_count++] = recipe->paths[i];
    m->info.paths = paths;
    m->info.path_count = path_count;
}

char *out_recipe(const out_view *v, const out_bookmark *bookmarks, size_t bookmark_count, char *why, size_t size) {
    made *m = calloc(1, sizeof(*m));
    world_made world = { 0 };
    noc_scene_info info;
    char *text = NULL;
    viewer_ear ear = { why, size };
    snprintf(why, size, "there is no memory for a recipe");
    if (!m || !world_scene(v->world) || !world_get_made(v->world, &world)) {
        free(m);
        return NULL;
    }
    noc_scene_get_info(world_scene(v->world), &info);
    m->info = *noc_recipe_get_info(v->source->recipe);
    say_inputs(m, v->source);
    say_source(m, v->source);
    say_luminaires(m);
    say_look(m, v, info.environment_width > 0);
    say_world(m, &world);
    say_cameras(m, v, bookmarks, bookmark_count);
    noc_log *log = viewer_listen(&ear);
    if (!m->refused)
        noc_recipe_write(&m->info, m->values, m->count, log, &text);
    noc_log_destroy(log);
    for (size_t i = 0; i < m->kept_count; i++)
        free(m->kept[i]);
    free(world.groups);
    free(m);
    return text;
}
