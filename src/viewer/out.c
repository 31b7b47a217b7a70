/* The equivalent command line. */
#include "viewer/out.h"

#include "viewer/words.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const noc_option number = { "", "", NOC_OPTION_REAL, 0, -1e30, 1e30, NULL, "", "" };

static void add_numbers(words *list, const char *flag, const double *v, int count) {
    char text[200] = "";
    size_t n = 0;
    for (int i = 0; i < count; i++) {
        n += (size_t)snprintf(text + n, sizeof(text) - n, "%s", i ? "," : "");
        n += (size_t)noc_option_get(&number, &v[i], text + n, sizeof(text) - n);
    }
    words_add(list, flag);
    words_add(list, text);
}

static void add_all(words *list, char **more, size_t count) {
    list->refused = list->refused || !more;
    for (size_t i = 0; more && i < count; i++)
        words_add(list, more[i]);
    words_free(more, more ? count : 0);
}

static void add_inputs(words *list, const viewer_source *source) {
    for (size_t i = 0; i < source->said_count; i++) {
        const char *said = source->said[i];
        char *beside = *said == '-' ? malloc(strlen(said) + 3) : NULL; /* no option */
        if (beside)
            sprintf(beside, "./%s", said);
        words_add(list, beside ? beside : said);
        free(beside);
    }
}

static void add_camera(words *list, const noc_camera *camera) {
    add_numbers(list, "--eye", camera->eye, 3);
    add_numbers(list, "--target", camera->target, 3);
    add_numbers(list, "--fov", &camera->fov_deg, 1);
}

static void add_picture(words *list, const out_view *v) {
    char text[40];
    int frames = v->look->frames ? v->look->frames : v->frames && v->frames < 1000000 ? (int)v->frames : 1;
    add_camera(list, v->camera);
    snprintf(text, sizeof(text), "%dx%d", v->width, v->height);
    words_add(list, "--size");
    words_add(list, text);
    snprintf(text, sizeof(text), "%d", frames);
    words_add(list, "--frames");
    words_add(list, text);
}

look out_look(const out_view *v) {
    look l = *v->look;
    if (v->bar && v->bar->high > v->bar->low && look_has_bar(&l) && l.channel.low == l.channel.high) {
        l.channel.low = v->bar->low;
        l.channel.high = v->bar->high;
    }
    return l;
}

/* The words as a line, and a remark where no word says what was set. */
static char *line_of(words *list, bool beyond) {
    size_t count;
    char **all = words_take(list, &count), *line = all ? words_line(all, count) : NULL;
    words_free(all, count);
    static const char materials[] = " # and materials that were set: save the recipe for these";
    char *longer = line && beyond ? realloc(line, strlen(line) + sizeof(materials)) : line;
    if (line && !longer)
        free(line);
    else if (beyond && longer)
        strcat(longer, materials);
    return longer;
}

char *out_command(const out_view *v) {
    words list = { 0 };
    size_t count = 0;
    bool beyond = false;
    noc_scene_info info = { 0 };
    if (world_scene(v->world))
        noc_scene_get_info(world_scene(v->world), &info);
    words_add(&list, "nocturne");
    words_add(&list, "render");
    add_inputs(&list, v->source);
    char **world = world_words(v->world, &count, &beyond);
    add_all(&list, world, count);
    add_picture(&list, v);
    look shown = out_look(v);
    char **own = look_words(&shown, v->source->recipe, info.environment_width > 0, &count);
    add_all(&list, own, count);
    words_add(&list, "-o");
    words_add(&list, "night.png");
    return line_of(&list, beyond);
}

char *out_influence(const viewer_source *source, viewer_world *world, const noc_render_params *render,
                    const char *region, const noc_camera *camera, int width, int height) {
    words list = { 0 };
    size_t count = 0;
    bool beyond = false;
    noc_scene_info info = { 0 };
    noc_scene_get_info(world_scene(world), &info);
    words_add(&list, "nocturne");
    words_add(&list, "influence");
    add_inputs(&list, source);
    char **set = world_words(world, &count, &beyond);
    add_all(&list, set, count);
    for (const noc_option *o = noc_render_options(); o->name; o++)
        if (!strcmp(o->name, "sky") || (info.environment_width > 0 && !strncmp(o->name, "environment-", 12)))
            words_option(&list, o, render, NULL);
    if (camera) {
        const double size[] = { width, height };
        add_camera(&list, camera);
        add_numbers(&list, "--width", &size[0], 1);
        add_numbers(&list, "--height", &size[1], 1);
    }
    words_add(&list, "--count-windows");
    words_add(&list, "--region");
    words_add(&list, region);
    return line_of(&list, beyond);
}
