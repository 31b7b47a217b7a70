/* The world said again: as words of a command line, and for a recipe. */
#include "viewer/world_parts.h"

#include "viewer/words.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool of_table(const noc_option *table, const noc_option *option) {
    for (const noc_option *o = table; o->name; o++)
        if (o == option)
            return true;
    return false;
}

/* Is it of how cities are read, and not said by what is set? */
static bool is_input(const noc_option *o) {
    static const char *const told[] = { "hour", "window-lit", "window-seed", "wet", "traffic-time", "group" };
    bool reads =
        of_table(noc_import_options(), o) || of_table(noc_city_options(), o) || of_table(noc_builtin_options(), o);
    return reads && !viewer_among(o->name, told, sizeof(told) / sizeof(*told));
}

static bool is_set_row(const noc_option *o) {
    static const char *const names[] = { "hour", "window-lit", "window-seed", "wet", "traffic-time" };
    return viewer_among(o->name, names, sizeof(names) / sizeof(*names));
}

static bool as_before(const world_group *a, const world_group *b) {
    return a->on == b->on && a->scale == b->scale && !strcmp(a->colour, b->colour);
}

void world_group_text(const world_group *g, char *text, size_t size) {
    static const noc_option number = { "", "", NOC_OPTION_REAL, 0, -1e30, 1e30, NULL, "", "" };
    char scale[40] = "off";
    if (g->on)
        noc_option_get(&number, &g->scale, scale, sizeof(scale));
    snprintf(text, size, "%s,%s", scale, g->colour);
}

static bool covered(const class_look *c) {
    return c->there && (memcmp(c->is.albedo, c->was.albedo, sizeof(c->is.albedo)) || c->is.f0 != c->was.f0 ||
                        c->is.roughness != c->was.roughness);
}

char **world_words(viewer_world *w, size_t *count, bool *beyond) {
    words list = { 0 };
    char text[200];
    *beyond = false;
    pthread_mutex_lock(&w->mutex);
    for (size_t i = 0; i < w->source->given_count; i++)
        if (is_input(w->source->given[i].option))
            words_option(&list, w->source->given[i].option, w->source->given[i].params, NULL);
    for (const noc_option *o = noc_import_options(); o->name && w->loaded; o++)
        if (is_set_row(o))
            words_option(&list, o, &w->import, &w->before);
    if (w->loaded && w->info.cars && !w->own.traffic)
        words_add(&list, "--no-traffic");
    for (size_t i = 0; i < w->group_count; i++) {
        if (!w->groups[i].said && as_before(&w->groups[i].is, &w->groups[i].was))
            continue;
        snprintf(text, sizeof(text), "%.80s=", w->groups[i].is.name);
        world_group_text(&w->groups[i].is, text + strlen(text), sizeof(text) - strlen(text));
        words_add(&list, "--group");
        words_add(&list, text);
    }
    for (int c = 0; c < NOC_CLASS_COUNT; c++)
        *beyond = *beyond || covered(&w->classes[c]);
    pthread_mutex_unlock(&w->mutex);
    return words_take(&list, count);
}

bool world_get_made(viewer_world *w, world_made *made) {
    *made = (world_made){ 0 };
    pthread_mutex_lock(&w->mutex);
    made->groups = calloc(w->group_count + 1, sizeof(*made->groups));
    for (size_t i = 0; i < w->group_count && made->groups; i++)
        if (w->groups[i].said || !as_before(&w->groups[i].is, &w->groups[i].was))
            made->groups[made->group_count++] = w->groups[i].is;
    for (const noc_option *o = noc_import_options(); o->name && w->loaded; o++) {
        char now[64], before[64];
        noc_option_get(o, &w->import, now, sizeof(now));
        noc_option_get(o, &w->before, before, sizeof(before));
        if (!is_set_row(o) || !strcmp(now, before) || made->setting_count == WORLD_SETTINGS)
            continue;
        world_setting *s = &made->settings[made->setting_count++];
        s->option = o;
        snprintf(s->value, sizeof(s->value), "%s", now);
    }
    for (int c = 0; c < NOC_CLASS_COUNT; c++)
        if (covered(&w->classes[c]))
            made->materials[made->material_count++] = w->classes[c].is;
    made->no_traffic = w->loaded && w->info.cars && !w->own.traffic;
    pthread_mutex_unlock(&w->mutex);
    return made->groups;
}

void world_import(viewer_world *w, noc_import_params *import) {
    pthread_mutex_lock(&w->mutex);
    *import = w->loaded ? w->import : *w->source->import;
    pthread_mutex_unlock(&w->mutex);
}
