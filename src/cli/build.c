/* nocturne build: inputs to one file, a built city. */
#include "each.h"

#include <errno.h>
#include <glob.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

typedef struct build_args {
    cli_args common;
    const char *output, *part;
    int threads;
    bool each;
    double halo;
    int preset; /* of the recipe; not an option here */
    noc_import_params import;
    noc_builtin_params builtin;
} build_args;
#define A build_args

static const noc_option own_options[] = {
    { "output", "Output", NOC_OPTION_TEXT, offsetof(A, output), 0, 0, NULL, "FILE",
      "built city to write: .noct; with --each a folder" },
    { "each", "Tiles", NOC_OPTION_BOOL, offsetof(A, each), 0, 0, NULL, "",
      "a built city of each city model, with an index; maps, terrain and lamps are common to all" },
    { "halo", "Tiles", NOC_OPTION_REAL, offsetof(A, halo), 0, 1e5, NULL, "m",
      "what a tile is built with around it, and not saved" },
    CLI_OPTION_PART(A, "Tiles", part),
    { "threads", "Output", NOC_OPTION_INT, offsetof(A, threads), 0, 1024, NULL, "", "threads; 0 = one a core" },
    { NULL },
};
static const noc_option *options(void) { return own_options; }
static int run(void *arguments);
static const build_args defaults = { .halo = 200,
                                     .import = noc_import_default_params(),
                                     .builtin = noc_builtin_default_params() };

const cli_command cli_build = {
    "build",
    "INPUT... -o FILE",
    "Makes one file of a city, which every command that takes inputs reads many times faster, and draws alike.",
    "Examples\n"
    "  nocturne build city.yaml -o city.noct\n"
    "  nocturne build city.gml lamps.geojson -o city.noct\n"
    "  nocturne render city.noct --hour 23 -o night.png\n"
    "  nocturne build --each tiles/*.gml lamps.geojson -o built\n"
    "  nocturne render built --bbox 691000,5335000,692000,5336000 -o night.png\n"
    "The file holds the recipe's cameras and options, too. It is made again where an\n"
    "input changes, or nocturne: it is no format to keep a city in.\n",
    { { options, 0, NULL },
      { noc_import_options, offsetof(A, import), NULL },
      { noc_city_options, offsetof(A, builtin.city), NULL },
      { noc_builtin_options, offsetof(A, builtin), NULL },
      { cli_common_options, 0, NULL } },
    sizeof(build_args),
    &defaults,
    run,
};

/* ---- the recipe in it ---- */

static bool in_table(const noc_option *table, const noc_option *o) {
    while (table->name && table != o)
        table++;
    return table->name != NULL;
}

static void add_value(noc_recipe_value *values, size_t *count, const noc_option *o, const void *params) {
    const char **text = cli_alloc(sizeof(*text));
    *text = cli_option_value(o, params);
    values[(*count)++] = (noc_recipe_value){ o, text, 1 };
}

/* What a build decides and pictures tell, as it was given; then what the recipe says of pictures. */
static noc_recipe_value *list_values(const build_args *args, size_t *count) {
    union {
        noc_render_params render;
        noc_display_params display;
    } params;
    const noc_option *o;
    size_t said = 0;
    while (noc_recipe_option(args->common.recipe, said))
        said++;
    noc_recipe_value *values = cli_alloc((args->common.given_count + said + 1) * sizeof(*values));
    for (size_t i = 0; i < args->common.given_count; i++) {
        o = args->common.given[i];
        if (in_table(noc_import_options(), o) && o->kind != NOC_OPTION_TEXTS && strcmp(o->unit, "FILE") &&
            strcmp(o->group, "Reading"))
            add_value(values, count, o, &args->import);
    }
    for (size_t i = 0; i < said; i++) {
        o = noc_recipe_option(args->common.recipe, i);
        if (in_table(noc_render_options(), o) || in_table(noc_display_options(), o))
            if (!noc_recipe_set(args->common.recipe, o, &params, NULL))
                add_value(values, count, o, &params);
    }
    return values;
}

/* Of its inputs, and what they are made of, nothing: that is built. free() it; NULL after reporting. */
static char *make_recipe(const build_args *args, noc_log *log) {
    const noc_recipe_info *recipe = noc_recipe_get_info(args->common.recipe);
    noc_recipe_info kept = { .name = recipe->name,
                             .has_preset = recipe->has_preset,
                             .preset = recipe->preset,
                             .camera_count = recipe->camera_count,
                             .cameras = recipe->cameras,
                             .path_count = recipe->path_count,
                             .paths = recipe->paths };
    size_t count = 0;
    noc_recipe_value *values = list_values(args, &count);
    char *text;
    noc_recipe_write(&kept, values, count, log, &text);
    for (size_t i = 0; i < count; i++) {
        free((char *)values[i].texts[0]);
        free((void *)values[i].texts);
    }
    free(values);
    return text;
}

/* ---- the build ---- */

static bool given(const build_args *args, const char *name) { return cli_given(&args->common, name); }

/* Of tiles: what makes no sense without them, or with them. */
static int check_each(const build_args *args) {
    struct stat st;
    if (!args->each)
        return given(args, "halo") || given(args, "part")
                   ? cli_usage(&cli_build, "--%s is for --each", given(args, "halo") ? "halo" : "part")
                   : CLI_OK;
    if (cli_is_built(&args->common))
        return cli_usage(&cli_build, "--each builds tiles of city models, and %.200s is built", args->common.inputs[0]);
    if (args->import.bbox)
        return cli_usage(&cli_build, "--bbox is not for --each: name the tiles that are wanted");
    if (mkdir(args->output, 0777) && (errno != EEXIST || stat(args->output, &st) || !S_ISDIR(st.st_mode))) {
        cli_error("%.200s: cannot be a folder: %s", args->output, strerror(errno == EEXIST ? ENOTDIR : errno));
        return CLI_FAILURE;
    }
    return CLI_OK;
}

static int check(build_args *args) {
    cli_add_named(&args->common, &args->import);
    cli_note_chosen(&args->common, &args->import);
    if (!args->common.input_count)
        return cli_usage(&cli_build, "nothing to build: name a recipe, or a city model");
    if (!args->output)
        return cli_usage(&cli_build, "where to? -o city.noct");
    for (size_t i = 0; i < args->common.given_count; i++) {
        const noc_option *o = args->common.given[i];
        const char *needed = noc_option_needs_input(o, args->common.inputs, args->common.input_count);
        if (needed)
            return cli_usage(&cli_build, "--%s is for the input %s", o->name, needed);
    }
    int status = check_each(args);
    status = status ? status : cli_check_built(&cli_build, &args->common, &args->import);
    return status || args->each ? status : cli_check_output(&cli_build, args->output, CLI_NOCT, &args->common);
}

static void print_summary(const build_args *args, const noc_scene *scene, const noc_report *report, double seconds) {
    noc_built_info file = { 0 };
    noc_scene_info info;
    noc_report_totals totals;
    char a[64], b[64], path[240];
    noc_scene_get_info(scene, &info);
    noc_report_get_totals(report, &totals);
    printf("%s\n  built     ", noc_text_clean(path, sizeof(path), args->output));
    if (noc_built_get_info(args->output, NULL, &file) == NOC_OK)
        printf("%s in ", noc_text_bytes(a, file.bytes));
    printf("%s\n", noc_text_seconds(b, seconds));
    printf("  scene     %s, %s", noc_text_many(a, info.triangles, "triangle"), noc_text_many(b, info.lights, "light"));
    if (info.windows)
        printf(", %s", noc_text_many(a, info.windows, "window"));
    printf("\n  inputs    features skipped: %zu, repaired: %zu, guessed at: %zu\n", totals.skipped, totals.repaired,
           totals.guessed);
    printf("  draw it: %s render %s -o night.png\n", cli_program(), path);
}

/* From here on an interrupt waits for the file to go, or to be whole. */
static noc_status save(const build_args *args, const noc_scene *scene, const noc_report *report, noc_log *log) {
    char *recipe = make_recipe(args, log);
    if (!recipe)
        return NOC_ERR_FORMAT;
    cli_nothing_to_keep(false);
    noc_status status =
        noc_scene_save(scene, args->output, &(noc_save_params){ report, recipe, { cli_load_progress, NULL } });
    cli_progress_clear();
    free(recipe);
    return status;
}

static noc_status build(build_args *args, noc_log *log, noc_scene *scene) {
    double started = cli_now();
    noc_report *report = NULL;
    args->import.progress = (noc_progress){ cli_load_progress, NULL };
    args->import.builtin = &args->builtin;
    noc_recipe_lists(args->common.recipe, &args->import);
    args->import.threads = args->threads;
    noc_status status = noc_scene_load(scene, args->common.inputs, args->common.input_count, &args->import, &report);
    status = status ? status : cli_switch_built(&args->common, scene, &args->import, report);
    cli_progress_clear();
    if (!status && cli_interrupted())
        status = NOC_ERR_CANCELLED;
    if (!status && cli_check_sources(scene, args->output))
        status = NOC_ERR_ARGUMENT;
    status = status ? status : save(args, scene, report, log);
    if (!status && !args->common.quiet)
        print_summary(args, scene, report, cli_now() - started);
    noc_report_destroy(report);
    return status;
}

/* ---- tiles ---- */

/* A number for all options that a tile is built with, and the files that they name. */
static uint64_t sum_options(const build_args *args, const char *recipe) {
    const noc_recipe_info *info = noc_recipe_get_info(args->common.recipe);
    uint64_t sum = each_sum_text(each_sum_text(0, noc_version()), recipe);
    sum = cli_sum(sum, &args->halo, sizeof(args->halo));
    for (size_t i = 0; i < args->common.given_count; i++) {
        const noc_option *o = args->common.given[i];
        bool import = in_table(noc_import_options(), o), city = in_table(noc_city_options(), o);
        if ((!import && !city) || !strcmp(o->group, "Reading"))
            continue;
        char *text = cli_option_value(o, import ? (const void *)&args->import : (const void *)&args->builtin.city);
        sum = each_sum_text(each_sum_text(sum, o->name), text);
        if (text && !strcmp(o->unit, "FILE"))
            sum = each_sum_file(sum, text);
        free(text);
    }
    return info->path && args->common.recipe ? each_sum_file(sum, info->path) : sum;
}

/* Patterns that no file is called by, in quotes, are the shell's. The caller frees the array, and each text. */
static char **find_inputs(const build_args *args, size_t *count) {
    char **all = NULL;
    *count = 0;
    for (size_t i = 0; i < args->common.input_count; i++) {
        const char *input = args->common.inputs[i];
        glob_t found = { 0 };
        struct stat st;
        bool pattern = stat(input, &st) && strpbrk(input, "*?[") && !glob(input, 0, NULL, &found);
        size_t more = pattern ? found.gl_pathc : 1;
        char **wider = cli_alloc((*count + more + 1) * sizeof(*all));
        if (all)
            memcpy(wider, all, *count * sizeof(*all));
        for (size_t k = 0; k < more; k++)
            wider[(*count)++] = cli_format("%s", pattern ? found.gl_pathv[k] : input);
        globfree(&found);
        free(all);
        all = wider;
    }
    return all;
}

static int build_each(build_args *args, noc_log *log) {
    char *recipe = make_recipe(args, log);
    if (!recipe)
        return CLI_FAILURE;
    size_t count;
    char **inputs = find_inputs(args, &count);
    noc_recipe_lists(args->common.recipe, &args->import);
    args->import.threads = args->threads;
    args->import.builtin = &args->builtin;
    each_build b = { .args = &args->common,
                     .import = &args->import,
                     .log = log,
                     .folder = args->output,
                     .recipe = recipe,
                     .options = sum_options(args, recipe),
                     .halo = args->halo };
    int status = cli_choose_part(&cli_build, &args->common, args->part, &b.part);
    status = status ? status : each_look(&b, (const char *const *)inputs, count);
    status = status ? status : each_run(&b);
    noc_scene_destroy(b.place.scene);
    for (size_t i = 0; i < b.tiles; i++)
        free((char *)b.inputs[i].name);
    free((char *)b.place.crs);
    free(b.inputs);
    for (size_t i = 0; i < count; i++)
        free(inputs[i]);
    free(inputs);
    free(recipe);
    return status;
}

static int run(void *arguments) {
    build_args *args = arguments;
    int status = check(args);
    if (status)
        return status;
    cli_catch_signals();
    cli_nothing_to_keep(true);
    cli_progress_start(args->common.quiet);
    noc_log *log = cli_log_create(&args->common);
    if (args->each) {
        status = build_each(args, log);
        noc_log_destroy(log);
        return cli_flush(stdout) ? status : CLI_FAILURE;
    }
    noc_scene *scene = noc_scene_create(log);
    status = scene && !build(args, log, scene) ? CLI_OK : CLI_FAILURE;
    noc_scene_destroy(scene);
    noc_log_destroy(log);
    if (status && cli_interrupted()) { /* a file that is whole is no interrupted one */
        cli_error("interrupted: nothing was saved");
        return CLI_INTERRUPTED + cli_interrupted();
    }
    return cli_flush(stdout) ? status : CLI_FAILURE;
}
