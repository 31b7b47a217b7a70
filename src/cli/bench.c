/* nocturne bench: what this machine does with a city. */
#include "bench.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const bench_section_names[BENCH_SECTIONS] = { "floor",     "passes",     "candidates", "lights", "windows",
                                                          "triangles", "resolution", "threads",    "isa",    "memory" };

#define A bench_args
#define TEXT(n, f, u, h)                                                                                               \
    { n, "Bench", NOC_OPTION_TEXT, offsetof(A, f), 0, 0, NULL, u, h }
static const noc_option own_options[] = {
    { "output", "Output", NOC_OPTION_TEXT, offsetof(A, output), 0, 0, NULL, "FILE", "write all figures as JSON, too" },
    { "json", "Output", NOC_OPTION_BOOL, offsetof(A, json), 0, 1, NULL, "", "print JSON instead of tables" },
    TEXT("only", only, "NAMES", "tables to measure, such as floor,passes; all are named at the end"),
    { "time", "Bench", NOC_OPTION_REAL, offsetof(A, time), 0, 1e6, NULL, "s",
      "about what it may take once the inputs are read; rows that do not fit are left out; 0 = none are" },
    { "frames", "Bench", NOC_OPTION_INT, offsetof(A, frames), 1, 1000, NULL, "",
      "frames of each row, of which the median is told; fewer where time is short" },
    { "size", "Bench", NOC_OPTION_TEXT, offsetof(A, size), 0, 0, NULL, "WxH",
      "of all pictures but those of the table resolution; smaller if time is short and none is given" },
    { "method", "Bench", NOC_OPTION_CHOICE, offsetof(A, method), 0, 0,
      "still|interactive|restir-uniform|restir-influence|restir-bias-rays|restir-lists", "",
      "what is timed as lights, triangles, pixels and threads grow" },
    { "quick", "Bench", NOC_OPTION_BOOL, offsetof(A, quick), 0, 1, NULL, "",
      "small pictures and scenes, one frame each: to see that all of it works" },
    { NULL },
};
static const noc_option *options(void) { return own_options; }
static int run(void *arguments);

static const bench_args defaults = { .size = "480x270",
                                     .frames = 5,
                                     .time = 60,
                                     .method = BENCH_INTERACTIVE,
                                     .device = CLI_DEVICE,
                                     .import = noc_import_default_params(),
                                     .builtin = noc_builtin_default_params() };

const cli_command cli_bench = {
    "bench",
    "[INPUT...]",
    "Measures what this machine does with a city: frames by pass, against their trace floor, and as lights, triangles, "
    "pixels and threads grow; memory.",
    "Tables are floor, passes, candidates, lights, windows, triangles, resolution,\n"
    "threads, isa and memory.\n"
    "Without inputs the city is builtin:city. Lights grow in builtin:mess, triangles in\n"
    "builtin:city, whatever the inputs are. Pictures have no light of the sky. What does\n"
    "not fit into time or memory is left out, and that is told. docs/measurements.md\n"
    "tells what the figures mean.\n"
    "Examples\n"
    "  nocturne bench\n"
    "  nocturne bench city.gml lamps.geojson --only floor,passes --size 1920x1080\n"
    "  nocturne bench --time 0 --frames 9 -o bench.json\n"
    "Ctrl-C ends it with status 130; tables that were complete are there.\n",
    { { options, 0, NULL },
      { noc_device_options, offsetof(A, device), NULL },
      { noc_import_options, offsetof(A, import), NULL },
      { noc_city_options, offsetof(A, builtin.city), NULL },
      { noc_builtin_options, offsetof(A, builtin), NULL },
      { cli_common_options, 0, NULL } },
    sizeof(bench_args),
    &defaults,
    run,
};

static int parse_only(bench_args *args) {
    for (int s = 0; s < BENCH_SECTIONS; s++)
        args->sections[s] = !args->only;
    for (const char *p = args->only; p; p = *p ? p + 1 : NULL) {
        char word[40];
        size_t n = strcspn(p, ",");
        int s = 0;
        snprintf(word, sizeof(word), "%.*s", (int)(n < 39 ? n : 39), p);
        while (s < BENCH_SECTIONS && strcmp(word, bench_section_names[s]))
            s++;
        const char *nearest = s < BENCH_SECTIONS ? NULL : noc_text_nearest(word, bench_section_names, BENCH_SECTIONS);
        if (s == BENCH_SECTIONS)
            return cli_usage(&cli_bench, "--only: no table \"%s\"%s%s%s", word, nearest ? "; is it " : "",
                             nearest ? nearest : "", nearest ? "?" : "");
        args->sections[s] = true;
        p += n;
    }
    return CLI_OK;
}

static int parse_size(bench_args *args) {
    double size[2];
    if (!noc_text_numbers(args->size, 'x', 2, size) || size[0] != (int)size[0] || size[1] != (int)size[1])
        return cli_usage(&cli_bench, "--size: \"%.60s\" is not WIDTHxHEIGHT", args->size);
    if (!(size[0] >= 1 && size[0] <= NOC_IMAGE_MAX_SIDE && size[1] >= 1 && size[1] <= NOC_IMAGE_MAX_SIDE))
        return cli_usage(&cli_bench, "--size: a side is 1 to %d px, not %.60s", NOC_IMAGE_MAX_SIDE, args->size);
    args->width = (int)size[0];
    args->height = (int)size[1];
    bool given = cli_given(&args->common, "size");
    args->base_width = !given ? args->width : args->quick ? 96 : 480;
    args->base_height = !given ? args->height : args->quick ? 54 : 270;
    return CLI_OK;
}

/* What was not said is small. */
static void be_quick(bench_args *args) {
    const cli_args *common = &args->common;
    args->size = cli_given(common, "size") ? args->size : "96x54";
    args->frames = cli_given(common, "frames") ? args->frames : 1;
    args->time = cli_given(common, "time") ? args->time : 0;
    args->builtin.city.size = cli_given(common, "city-size") ? args->builtin.city.size : 150;
}

static int check(bench_args *args) {
    cli_args *common = &args->common;
    if (!common->input_count)
        common->inputs[common->input_count++] = "builtin:city";
    if (args->quick)
        be_quick(args);
    for (size_t i = 0; i < common->given_count; i++) {
        const noc_option *o = common->given[i];
        const char *needed = noc_option_needs_input(o, common->inputs, common->input_count);
        if (needed)
            return cli_usage(&cli_bench, "--%s is for the input %s", o->name, needed);
    }
    int status = parse_only(args);
    status = status ? status : parse_size(args);
    if (status)
        return status;
    cli_add_named(common, &args->import);
    cli_note_chosen(common, &args->import);
    status = cli_check_built(&cli_bench, common, &args->import);
    status = status ? status : cli_check_device(&cli_bench, &args->device);
    return status || !args->output ? status : cli_check_output(&cli_bench, args->output, CLI_ANY, common);
}

noc_status bench_load(bench *b, bool windows, noc_scene **scene) {
    bench_args *args = b->args;
    noc_import_params import = args->import;
    import.builtin = &args->builtin;
    import.threads = args->device.threads;
    import.progress = (noc_progress){ cli_load_progress, NULL };
    import.windows = windows ? import.windows : NOC_SWITCH_OFF;
    noc_recipe_lists(args->common.recipe, &import);
    *scene = noc_scene_create(b->log);
    noc_status status =
        *scene ? noc_scene_load(*scene, args->common.inputs, args->common.input_count, &import, NULL) : NOC_ERR_MEMORY;
    status = status ? status : cli_switch_built(&args->common, *scene, &import, NULL);
    cli_progress_clear();
    if (!status)
        return NOC_OK;
    noc_scene_destroy(*scene);
    *scene = NULL;
    return status;
}

static void print_nothing(const bench *b, bench_section section) { (void)b, (void)section; }

static void print_section(const bench *b, bench_section section) {
    bench_print_section(b, section);
    fflush(stdout);
}

static bool write_json(const bench *b, bool complete) {
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    if (!out)
        cli_no_memory();
    bench_json(b, complete, out);
    if (fclose(out) || !text)
        cli_no_memory();
    bool saved = !noc_text_save(b->args->output, text, size, b->log);
    free(text);
    return saved;
}

static int work(bench *b) {
    const bench_args *args = b->args;
    double start = cli_now();
    cli_nothing_to_keep(true);
    noc_status status = bench_load(b, true, &b->scene);
    b->load_seconds = cli_now() - start;
    if (status)
        return cli_interrupted() ? CLI_INTERRUPTED + cli_interrupted() : CLI_FAILURE;
    if (cli_check_sources(b->scene, args->output))
        return CLI_FAILURE;
    noc_scene_get_info(b->scene, &b->info);
    if (!b->info.triangles) {
        cli_error("the inputs hold no surface that can be drawn; nocturne info tells what they hold");
        return CLI_FAILURE;
    }
    b->device = noc_device_create(&args->device, b->log);
    if (!b->device)
        return CLI_FAILURE;
    b->begun = cli_now();
    status = bench_probe(b);
    cli_progress_clear();
    if (!status && !args->json)
        bench_print_head(b);
    fflush(stdout);
    status = status ? status : bench_measure(b, args->json ? print_nothing : print_section);
    cli_nothing_to_keep(false);
    bool interrupted = status == NOC_ERR_CANCELLED && cli_interrupted();
    if (status && !interrupted)
        return CLI_FAILURE;
    bool any = false;
    for (int s = 0; s < BENCH_SECTIONS; s++)
        any = any || b->measured[s];
    if (args->json)
        bench_json(b, !interrupted, stdout);
    if (args->output && (any || !interrupted) && !write_json(b, !interrupted))
        return CLI_FAILURE;
    if (interrupted)
        cli_error(any ? "interrupted: tables that were not complete are left out"
                      : "interrupted: no table was complete");
    return interrupted ? CLI_INTERRUPTED + cli_interrupted() : CLI_OK;
}

static int run(void *arguments) {
    bench_args *args = arguments;
    int status = check(args);
    if (status)
        return status;
    cli_catch_signals();
    cli_progress_start(args->common.quiet);
    bench *b = cli_alloc(sizeof(*b));
    b->args = args;
    b->log = cli_log_create(&args->common);
    status = work(b);
    cli_progress_clear();
    noc_view_destroy(b->kept);
    noc_device_destroy(b->device);
    noc_scene_destroy(b->scene);
    noc_log_destroy(b->log);
    free(b);
    return cli_flush(stdout) ? status : CLI_FAILURE;
}
