/* What can be set of the world: rows of the import options that cost no new load, the cars' clock, groups of lights,
 * and what classes of surfaces are made of. */
#include "viewer/world_parts.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Rows of noc_import_options, and what they make dirty. */
static const struct {
    const char *name;
    unsigned dirty;
} rows[] = { { "hour", DIRTY_WINDOWS },
             { "window-lit", DIRTY_WINDOWS },
             { "window-seed", DIRTY_WINDOWS },
             { "wet", DIRTY_OTHERS },
             { "traffic-time", DIRTY_TIME } };
enum { ROWS = sizeof(rows) / sizeof(*rows) };

static const noc_option own_options[] = {
    { "traffic", "Traffic", NOC_OPTION_BOOL, offsetof(world_own, traffic), 0, 1, NULL, "",
      "cars are on the roads; off: out of sight, with their light" },
    { "traffic-drive", "Traffic", NOC_OPTION_BOOL, offsetof(world_own, drive), 0, 1, NULL, "",
      "cars drive; off: they stand where traffic-time says" },
    { "traffic-pace", "Traffic", NOC_OPTION_REAL, offsetof(world_own, pace), 0, 100, NULL, "",
      "how much faster than the clock they drive" },
    { NULL },
};
static const world_own own_defaults = { .traffic = true, .pace = 1 };

static const noc_option *row_option(size_t row) {
    for (const noc_option *o = noc_import_options(); o->name; o++)
        if (!strcmp(o->name, rows[row].name))
            return o;
    return NULL;
}

bool world_drives(const viewer_world *w) { return w->own.drive && w->own.traffic && w->own.pace > 0 && w->info.cars; }

/* ---- groups: group.NAME ---- */

/* Linear Rec.709, of any luminance, as "#rrggbb". */
static void hex_colour(const float rgb[3], char *text, size_t size) {
    double most = fmax(fmax((double)rgb[0], (double)rgb[1]), fmax((double)rgb[2], 1e-30));
    unsigned code[3];
    for (int k = 0; k < 3; k++) {
        double v = (double)rgb[k] / most;
        code[k] = (unsigned)lrint(255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1 / 2.4) - 0.055));
    }
    snprintf(text, size, "#%02x%02x%02x", code[0], code[1], code[2]);
}

/* Takes what a text says that was looked at before. */
static void take_state(world_group *g, const char *text) {
    for (const char *s = text; *s; s += strcspn(s, ","), s += *s == ',') {
        char word[40];
        double scale;
        snprintf(word, sizeof(word), "%.*s", (int)strcspn(s, ","), s);
        if (!strcasecmp(word, "on") || !strcasecmp(word, "off")) {
            g->on = !strcasecmp(word, "on");
            g->scale = 1;
        } else if (noc_text_numbers(word, 0, 1, &scale)) {
            g->on = scale > 0;
            g->scale = g->on ? scale : 1;
        } else {
            snprintf(g->colour, sizeof(g->colour), "%.15s", word);
        }
    }
}

/* As a rule, or the words of --group, have it. A built city's are in its scene. */
static void begin_group(const viewer_world *w, group *g, const noc_group_info *info) {
    g->was = g->is = (world_group){ .name = info->name, .on = true, .scale = 1, .colour = "own" };
    g->is.on = info->scale[0] > 0;
    g->is.scale = g->is.on ? (double)info->scale[0] : 1;
    if (info->colour[0] > 0 || info->colour[1] > 0 || info->colour[2] > 0)
        hex_colour(info->colour, g->is.colour, sizeof(g->is.colour));
    if (w->built)
        g->was = g->is;
    for (size_t i = 0; i < w->source->import->group_count; i++) {
        const noc_group_rule *rule = &w->source->import->groups[i];
        if (strcmp(rule->name, info->name))
            continue;
        g->was = (world_group){ .name = info->name, .on = rule->on, .scale = rule->scale, .colour = "own" };
        if (rule->colour)
            snprintf(g->was.colour, sizeof(g->was.colour), "%.15s", rule->colour);
        else if (isfinite(rule->kelvin))
            snprintf(g->was.colour, sizeof(g->was.colour), "%gK", rule->kelvin);
        g->is = g->was;
    }
    for (size_t i = 0; i < w->source->import->group_states.count; i++) {
        const char *text = w->source->import->group_states.text[i], *equals = strchr(text, '=');
        size_t length = equals ? (size_t)(equals - text) : 0;
        if (length && strlen(info->name) == length && !strncmp(info->name, text, length)) {
            take_state(&g->is, equals + 1);
            g->said = true;
        }
    }
}

/* The mean colour of each group's lights, as inputs have them. */
static void find_colours(viewer_world *w, size_t groups) {
    double(*sum)[3] = calloc(groups, sizeof(*sum));
    noc_scene_info info;
    noc_scene_get_info(w->scene, &info);
    for (size_t i = 0; sum && i < info.light_slots; i++) {
        noc_light_info l;
        bool there = !noc_scene_get_light(w->scene, i, &l) && !l.removed && l.light.group >= 0;
        const float *e = l.light.emission;
        double most = there ? fmax((double)e[0], fmax((double)e[1], (double)e[2])) : 0;
        for (int k = 0; k < 3 && most > 0 && (size_t)l.light.group < groups; k++)
            sum[l.light.group][k] += e[k] / most;
    }
    for (size_t i = 0; sum && i < w->group_count; i++) {
        unsigned char c[3];
        viewer_colour(sum[w->groups[i].index], c);
        if (c[0] + c[1] + c[2])
            snprintf(w->groups[i].own, sizeof(w->groups[i].own), "#%02x%02x%02x", c[0], c[1], c[2]);
    }
    free(sum);
}

static noc_status begin_groups(viewer_world *w) {
    enum { MOST = 200 };
    size_t count = noc_scene_groups(w->scene, NULL, 0);
    noc_group_info *all = calloc(count, sizeof(*all));
    w->groups = calloc(count, sizeof(*w->groups));
    if (!all || !w->groups) {
        free(all);
        return NOC_ERR_MEMORY;
    }
    noc_scene_groups(w->scene, all, count);
    for (size_t i = 1; i < count && w->group_count < MOST; i++) {
        json_t *name = json_string(all[i].name); /* NULL where it is not UTF-8 */
        if (name && *all[i].name && all[i].lights) {
            w->groups[w->group_count].index = (int)i;
            begin_group(w, &w->groups[w->group_count++], &all[i]);
        }
        json_decref(name);
    }
    free(all);
    find_colours(w, count);
    return NOC_OK;
}

const char *world_group_name(const viewer_world *w, int index) {
    for (size_t i = 0; i < w->group_count; i++)
        if (w->groups[i].index == index)
            return w->groups[i].is.name;
    return "";
}

static bool set_group(viewer_world *w, const char *name, const char *value, char *why, size_t size) {
    viewer_ear ear = { why, size };
    for (size_t i = 0; i < w->group_count; i++) {
        group *g = &w->groups[i];
        if (strcmp(g->is.name, name))
            continue;
        noc_log *log = viewer_listen(&ear);
        noc_status status = noc_group_state_check(value, log);
        noc_log_destroy(log);
        if (status)
            return false;
        world_group before = g->is;
        take_state(&g->is, value);
        g->recoloured = g->recoloured || strcmp(before.colour, g->is.colour);
        g->dirty = true;
        w->dirty |= DIRTY_OTHERS;
        return true;
    }
    return viewer_wrong(why, size, "there is no group of lights \"%.60s\"", name);
}

/* ---- materials: material.CLASS.FIELD ---- */

typedef enum field { FIELD_ALBEDO, FIELD_ROUGHNESS, FIELD_F0, FIELD_COUNT } field;
static const struct {
    const char *name, *kind, *help;
    double min, max;
} fields[FIELD_COUNT] = {
    [FIELD_ALBEDO] = { "albedo", "colour", "diffuse reflectance, as an sRGB colour", 0, 0 },
    [FIELD_ROUGHNESS] = { "roughness", "real", "of the glossy reflection: .05 mirrors, 1 is dull", .05, 1 },
    [FIELD_F0] = { "f0", "real", "share that is reflected at right angles; 0: no gloss, water .02", 0, 1 },
};

static void field_text(const noc_material *m, field f, char *text, size_t size) {
    unsigned code[3];
    for (int k = 0; k < 3 && f == FIELD_ALBEDO; k++) {
        double v = (double)m->albedo[k];
        code[k] = (unsigned)lrint(255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1 / 2.4) - 0.055));
    }
    if (f == FIELD_ALBEDO)
        snprintf(text, size, "#%02x%02x%02x", code[0], code[1], code[2]);
    else
        snprintf(text, size, "%.6g", (double)(f == FIELD_F0 ? m->f0 : m->roughness));
}

static bool set_albedo(noc_material *m, const char *value) {
    unsigned code[3];
    char after;
    if (strlen(value) != 7 || strspn(value + 1, "0123456789abcdefABCDEF") != 6 ||
        sscanf(value, "#%2x%2x%2x%c", &code[0], &code[1], &code[2], &after) != 3)
        return false;
    for (int k = 0; k < 3; k++) {
        double v = code[k] / 255.;
        m->albedo[k] = (float)(v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4));
    }
    return true;
}

static bool set_field(class_look *c, field f, const char *value, char *why, size_t size) {
    char was[40];
    double number;
    field_text(&c->was, f, was, sizeof(was));
    if (!strcmp(was, value)) { /* to the last bit, which the text does not tell */
        if (f == FIELD_ALBEDO)
            memcpy(c->is.albedo, c->was.albedo, sizeof(c->is.albedo));
        *(f == FIELD_F0 ? &c->is.f0 : &c->is.roughness) = f == FIELD_F0          ? c->was.f0
                                                          : f == FIELD_ROUGHNESS ? c->was.roughness
                                                                                 : c->is.roughness;
        return true;
    }
    if (f == FIELD_ALBEDO)
        return set_albedo(&c->is, value) || viewer_wrong(why, size, "\"%.60s\" is no colour #rrggbb", value);
    if (!noc_text_numbers(value, 0, 1, &number) || !(number >= fields[f].min && number <= fields[f].max))
        return viewer_wrong(why, size, "%s: \"%.60s\" is not a number of %g to %g", fields[f].name, value,
                            fields[f].min, fields[f].max);
    *(f == FIELD_F0 ? &c->is.f0 : &c->is.roughness) = (float)number;
    return true;
}

static bool set_material(viewer_world *w, const char *name, const char *value, char *why, size_t size) {
    const char *dot = strrchr(name, '.');
    for (int c = 0; dot && c < NOC_CLASS_COUNT; c++) {
        const char *cls = noc_class_name((noc_class)c);
        for (int f = 0; f < FIELD_COUNT; f++) {
            if (!w->classes[c].there || strlen(cls) != (size_t)(dot - name) || strncmp(cls, name, strlen(cls)) ||
                strcmp(fields[f].name, dot + 1))
                continue;
            if (!set_field(&w->classes[c], (field)f, value, why, size))
                return false;
            w->classes[c].dirty = true;
            w->dirty |= DIRTY_OTHERS;
            return true;
        }
    }
    return viewer_wrong(why, size, "there is no surface of the class, or no such field: \"%.60s\"", name);
}

static noc_status begin_materials(viewer_world *w) {
    const noc_import_params *import = w->source->import;
    w->materials = calloc(w->info.materials + 1, sizeof(*w->materials));
    w->named = calloc(w->info.materials + 1, sizeof(*w->named));
    if (!w->materials || !w->named)
        return NOC_ERR_MEMORY;
    for (size_t i = 0; i < w->info.materials; i++) {
        const char *name;
        if (noc_scene_get_material(w->scene, (int)i, &w->materials[i], &name))
            return NOC_ERR_ARGUMENT;
        for (size_t k = 0; k < import->named_material_count && name; k++)
            w->named[i] = w->named[i] || !strcmp(name, import->named_materials[k].name);
    }
    for (int c = 0; c < NOC_CLASS_COUNT; c++) {
        class_look *look = &w->classes[c];
        look->there = c != NOC_CLASS_CLOSURE && w->info.triangles_by_class[c];
        look->was = noc_class_material((noc_class)c);
        for (size_t i = 0; i < import->material_count; i++)
            if ((int)import->materials[i].cls == c)
                look->was = import->materials[i];
        look->is = look->was;
    }
    return NOC_OK;
}

/* ---- rows and the clock ---- */

static bool set_row(viewer_world *w, size_t row, const char *value, char *why, size_t size) {
    noc_import_params next = w->import;
    if (!viewer_option_set(row_option(row), &next, value, why, size))
        return false;
    if (!strcmp(rows[row].name, "wet") && w->rain_fixed)
        return viewer_wrong(why, size, "wet: the city was built so: build it again without");
    for (int i = 0; i < WORLD_RAINED && next.wet != w->import.wet; i++)
        w->classes[world_rained[i]].dirty = true;
    w->import = next;
    w->dirty |= rows[row].dirty;
    return true;
}

static bool set(viewer_world *w, const char *name, const char *value, char *why, size_t size) {
    for (size_t i = 0; i < ROWS; i++)
        if (!strcmp(rows[i].name, name))
            return set_row(w, i, value, why, size);
    for (const noc_option *o = own_options; o->name; o++)
        if (!strcmp(o->name, name)) {
            bool done = viewer_option_set(o, &w->own, value, why, size);
            w->dirty |= done && o == own_options ? DIRTY_TRAFFIC : 0;
            return done;
        }
    if (!strncmp(name, "group.", 6))
        return set_group(w, name + 6, value, why, size);
    if (!strncmp(name, "material.", 9))
        return set_material(w, name + 9, value, why, size);
    return viewer_wrong(why, size, "there is no option \"%.60s\" of the world", name);
}

bool world_set(viewer_world *w, const char *name, const char *value, char *why, size_t size) {
    pthread_mutex_lock(&w->mutex);
    bool done = w->loaded ? set(w, name, value, why, size) : viewer_wrong(why, size, "the city is not loaded yet");
    if (done) {
        w->version++;
        w->told++;
        pthread_cond_broadcast(&w->changed);
    }
    pthread_mutex_unlock(&w->mutex);
    return done;
}

/* ---- beginning ---- */

/* What `nocturne render` takes the same inputs with. */
static void find_before(viewer_world *w) {
    const noc_recipe *recipe = w->source->recipe;
    w->before = noc_import_default_params();
    for (size_t i = 0; i < ROWS; i++) {
        const noc_option *said;
        for (size_t k = 0; (said = noc_recipe_option(recipe, k)); k++)
            if (said == row_option(i))
                noc_recipe_set(recipe, said, &w->before, NULL);
    }
}

noc_status world_begin(viewer_world *w) {
    noc_scene_get_info(w->scene, &w->info);
    w->own = own_defaults;
    w->import = *w->source->import;
    find_before(w);
    for (size_t i = 0; i < w->source->said_count; i++)
        w->built = w->built || noc_built_is(w->source->said[i]);
    w->rain_fixed = w->built && w->before.wet;
    noc_status status = begin_materials(w);
    status = status ? status : begin_groups(w);
    for (int i = 0; i < WORLD_RAINED && w->import.wet && !w->rain_fixed; i++) {
        w->classes[world_rained[i]].dirty = true;
        w->dirty |= DIRTY_OTHERS;
    }
    if (status == NOC_ERR_MEMORY)
        snprintf(w->failed, sizeof(w->failed), "there is no memory for what can be set");
    return status;
}

void world_finish(viewer_world *w) {
    free(w->groups);
    free(w->materials);
    free(w->named);
}

/* ---- as JSON ---- */

static json_t *schema_of(viewer_world *w) {
    json_t *list = json_array();
    char name[160], text[100];
    for (size_t i = 0; i < ROWS; i++)
        json_array_append_new(list, viewer_option_json(row_option(i), w->source->import));
    for (const noc_option *o = own_options; o->name; o++)
        json_array_append_new(list, viewer_option_json(o, &own_defaults));
    for (size_t i = 0; i < w->group_count; i++) {
        snprintf(name, sizeof(name), "group.%s", w->groups[i].is.name);
        world_group_text(&w->groups[i].was, text, sizeof(text));
        json_array_append_new(list,
                              json_pack("{ss ss ss ss ss ss ss}", "name", name, "group", "Lights", "kind", "group",
                                        "unit", "", "help", "lights of this group: on or off, a factor, a colour",
                                        "value", text, "colour", w->groups[i].own));
    }
    for (int c = 0; c < NOC_CLASS_COUNT; c++)
        for (int f = 0; f < FIELD_COUNT && w->classes[c].there; f++) {
            snprintf(name, sizeof(name), "material.%s.%s", noc_class_name((noc_class)c), fields[f].name);
            field_text(&w->classes[c].was, (field)f, text, sizeof(text));
            json_t *row = json_pack("{ss ss ss ss ss ss}", "name", name, "group", "Materials", "kind", fields[f].kind,
                                    "unit", "", "help", fields[f].help, "value", text);
            if (f != FIELD_ALBEDO) {
                json_object_set_new(row, "min", json_real(fields[f].min));
                json_object_set_new(row, "max", json_real(fields[f].max));
            }
            json_array_append_new(list, row);
        }
    return list;
}

static json_t *values_of(const viewer_world *w) {
    json_t *values = json_object();
    char name[160], text[100];
    for (size_t i = 0; i < ROWS; i++) {
        noc_option_get(row_option(i), &w->import, text, sizeof(text));
        json_object_set_new(values, rows[i].name, json_string(text));
    }
    for (const noc_option *o = own_options; o->name; o++) {
        noc_option_get(o, &w->own, text, sizeof(text));
        json_object_set_new(values, o->name, json_string(text));
    }
    for (size_t i = 0; i < w->group_count; i++) {
        snprintf(name, sizeof(name), "group.%s", w->groups[i].is.name);
        world_group_text(&w->groups[i].is, text, sizeof(text));
        json_object_set_new(values, name, json_string(text));
    }
    for (int c = 0; c < NOC_CLASS_COUNT; c++)
        for (int f = 0; f < FIELD_COUNT && w->classes[c].there; f++) {
            snprintf(name, sizeof(name), "material.%s.%s", noc_class_name((noc_class)c), fields[f].name);
            field_text(&w->classes[c].is, (field)f, text, sizeof(text));
            json_object_set_new(values, name, json_string(text));
        }
    return values;
}

static void idle_if(json_t *idle, const char *const *names, size_t count, const char *why) {
    for (size_t i = 0; i < count; i++)
        json_object_set_new(idle, names[i], json_string(why));
}

static json_t *idle_of(const viewer_world *w) {
    static const char *const windows[] = { "hour", "window-lit", "window-seed" };
    static const char *const cars[] = { "traffic-time", "traffic-drive", "traffic-pace", "traffic" };
    json_t *idle = json_object();
    bool rained = false;
    for (int i = 0; i < WORLD_RAINED; i++)
        rained = rained || w->classes[world_rained[i]].there;
    if (!w->info.windows)
        idle_if(idle, windows, 3, "no windows were made: no wall has any, or --no-windows was said");
    if (!w->info.cars)
        idle_if(idle, cars, 4,
                "there are no cars; they are chosen when a city is loaded: tracks among the inputs, or --traffic");
    else if (!w->own.traffic)
        idle_if(idle, cars, 3, "it needs traffic true, not false");
    else if (!w->own.drive)
        idle_if(idle, cars + 2, 1, "it needs traffic-drive true, not false");
    if (w->rain_fixed)
        json_object_set_new(idle, "wet", json_string("the city was built wet: build it again without"));
    else if (!rained)
        json_object_set_new(idle, "wet", json_string("no surface is a road, a pavement, terrain or ground"));
    return idle;
}

json_t *world_schema(viewer_world *w) {
    pthread_mutex_lock(&w->mutex);
    json_t *list = w->loaded ? schema_of(w) : json_array();
    pthread_mutex_unlock(&w->mutex);
    return list;
}

json_t *world_state(viewer_world *w) {
    pthread_mutex_lock(&w->mutex);
    json_t *state = json_object();
    json_object_set_new(state, "values", w->loaded ? values_of(w) : json_object());
    json_object_set_new(state, "idle", w->loaded ? idle_of(w) : json_object());
    json_object_set_new(state, "version", json_integer((json_int_t)world_commits(w)));
    pthread_mutex_unlock(&w->mutex);
    return state;
}
