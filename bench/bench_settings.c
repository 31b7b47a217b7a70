/* What a change of the world costs whoever looks at it: processor time from world_set to the end of the first frame
 * that shows it, beside that of a frame without changes; ms of all threads, medians over the rounds.
 *
 *   bench_settings [RECIPE [CAMERA [WIDTH HEIGHT [ROUNDS]]]]     default: builtin:city street 1280 720 5 */
#include "viewer/world.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

typedef struct bench {
    const char *input;
    noc_recipe *recipe;
    noc_import_params import;
    viewer_world *world;
    noc_view *view;
    noc_camera camera;
    noc_render_params params;
} bench;

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return 1e3 * (double)t.tv_sec + 1e-6 * (double)t.tv_nsec;
}

static noc_status load(void *user, noc_scene *scene, const noc_progress *progress, noc_report **report) {
    bench *b = user;
    const noc_recipe_info *info = noc_recipe_get_info(b->recipe);
    for (size_t i = 0; noc_recipe_option(b->recipe, i); i++)
        for (const noc_option *o = noc_import_options(); o->name; o++)
            if (o == noc_recipe_option(b->recipe, i))
                noc_recipe_set(b->recipe, o, &b->import, NULL);
    noc_recipe_lists(b->recipe, &b->import);
    return noc_scene_load(scene, b->recipe ? info->inputs : &b->input, b->recipe ? info->input_count : 1, &b->import,
                          report);
}

static int compare(const void *a, const void *b) { return (*(const double *)a > *(const double *)b) * 2 - 1; }

static double median(double *ms, int count) {
    qsort(ms, (size_t)count, sizeof(*ms), compare);
    return ms[count / 2];
}

/* Frames with and without the change in turn, for frames become cheaper as views learn. false: it changes nothing here.
 */
static bool measure(bench *b, const char *const setting[3], int rounds) {
    double without[64], with[64];
    char why[300];
    json_t *state = world_state(b->world);
    bool idle = json_object_get(json_object_get(state, "idle"), setting[0]);
    json_decref(state);
    for (int i = 0; i < 2 * rounds && !idle; i++) {
        double start = now();
        if (i % 2 && !world_set(b->world, setting[0], setting[1 + i / 2 % 2], why, sizeof(why)))
            return false;
        world_settle(b->world);
        noc_view_render(b->view, &b->camera, &b->params, NULL);
        (i % 2 ? with : without)[i / 2] = now() - start;
    }
    if (idle)
        return false;
    double frame = median(without, rounds), changed = median(with, rounds);
    printf("%-26s %8.1f ms, a frame %8.1f, %+8.1f\n", setting[0], changed, frame, changed - frame);
    fflush(stdout);
    return true;
}

static bool start(bench *b, viewer_source *source, const char *view, noc_log *log) {
    char what[128];
    double done;
    *source = (viewer_source){
        .said = &b->input, .said_count = 1, .recipe = b->recipe, .load = load, .user = b, .import = &b->import
    };
    b->world = world_create(source, log);
    while (b->world && world_loading(b->world, what, sizeof(what), &done))
        nanosleep(&(struct timespec){ .tv_nsec = 20000000 }, NULL);
    if (!b->world || !world_scene(b->world))
        return false;
    noc_camera_params camera = noc_camera_default_params();
    for (const noc_option *o = noc_camera_options(); o->name; o++)
        if (!strcmp(o->name, "view") && noc_option_set(o, &camera, view, log))
            return false;
    b->view = noc_view_create(world_device(b->world), world_scene(b->world));
    return b->view && !noc_scene_place_camera(world_scene(b->world), &camera,
                                              (double)b->params.width / b->params.height, &b->camera, NULL);
}

static void print_all(bench *b, int rounds) {
    static const char *const settings[][3] = {
        { "hour", "3", "19" },
        { "window-lit", "0.9", "0.2" },
        { "window-seed", "2", "3" },
        { "group.lamps", "0.5,2000K", "1,4000K" },
        { "group.windows", "off", "on" },
        { "group.cars", "off", "on" },
        { "wet", "on", "off" },
        { "material.wall.albedo", "#804020", "#406080" },
        { "material.road.roughness", "0.2", "0.4" },
        { "traffic-time", "3", "4" },
        { "traffic", "off", "on" },
    };
    for (int i = 0; i < 3; i++) /* structures are built, and something is learned */
        noc_view_render(b->view, &b->camera, &b->params, NULL);
    for (size_t i = 0; i < sizeof(settings) / sizeof(*settings); i++)
        measure(b, settings[i], rounds);
}

int main(int argc, char **argv) {
    bench b = { .input = argc > 1 ? argv[1] : "builtin:city",
                .import = noc_import_default_params(),
                .params = noc_render_default_params() };
    viewer_source source;
    int rounds = argc > 5 ? atoi(argv[5]) : 5;
    noc_log *log = noc_log_create(NULL);
    noc_render_use_preset(&b.params, NOC_PRESET_INTERACTIVE);
    b.params.width = argc > 4 ? atoi(argv[3]) : 1280;
    b.params.height = argc > 4 ? atoi(argv[4]) : 720;
    if (rounds < 1 || rounds > 64 || noc_render_check(&b.params, log))
        return 2;
    bool ok = !noc_recipe_is(b.input) || !noc_recipe_load(b.input, log, &b.recipe);
    ok = ok && start(&b, &source, argc > 2 ? argv[2] : "street", log);
    if (ok)
        print_all(&b, rounds);
    else
        fprintf(stderr, "%s\n", noc_log_last_error(log));
    noc_view_destroy(b.view);
    world_destroy(b.world);
    noc_recipe_destroy(b.recipe);
    noc_log_destroy(log);
    return !ok;
}
