/* nocturne measure: lux at points, of regions, and as a raster of the ground. */
#include "measure.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define A measure_args
static const noc_option *options(void) {
    static const noc_option rows[] = {
        { "output", "Output", NOC_OPTION_TEXT, offsetof(A, render.output), 0, 0, NULL, "FILE",
          "GeoTIFF of the ground's lux (lux.tif), or with --points their readings as CSV; - = standard output" },
        { "grid", "Measure", NOC_OPTION_REAL, offsetof(A, grid), 1e-6, 1e6, NULL, "",
          "width of a pixel of the raster, in units of its CRS" },
        { "te", "Measure", NOC_OPTION_TEXT, offsetof(A, extent), 0, 0, NULL, "W,S,E,N",
          "extent of the raster in its CRS, widened to whole pixels; else the scene's" },
        { "t-srs", "Measure", NOC_OPTION_TEXT, offsetof(A, crs), 0, 0, NULL, "CRS",
          "CRS of the raster, of --te and --points; else the scene's" },
        { "on", "Measure", NOC_OPTION_TEXT, offsetof(A, on), 0, 0, NULL, "NAMES",
          "surfaces of these classes alone, such as road,sidewalk; else all ground" },
        { "height", "Measure", NOC_OPTION_REAL, offsetof(A, height), -1000, 1000, NULL, "m",
          "over the ground, where the luxmeter is held, of the raster and of regions" },
        { "points", "Measure", NOC_OPTION_TEXT, offsetof(A, points), 0, 0, NULL, "FILE",
          "measure at these: x y z nx ny nz a line, as rtrace -I has them; - = standard input" },
        { "response", "Measure", NOC_OPTION_CHOICE, offsetof(A, response), 0, 0,
          "plane|semicylinder|cylinder|hemisphere", "",
          "of --points: a plane's illuminance, or semicylindrical, cylindrical, hemispherical" },
        { "region", "Measure", NOC_OPTION_TEXTS, offsetof(A, regions), 0, 0, NULL, "REGION",
          "figures of a place, as nocturne influence has it: street:NAME or polygon:FILE|WKT; repeatable" },
        { "error", "Measure", NOC_OPTION_REAL, offsetof(A, error), 1e-4, 1, NULL, "",
          "relative standard error that 3 of 4 readings are to have; of what is darker than 0.1 lx, of that" },
        { "samples", "Measure", NOC_OPTION_INT, offsetof(A, samples), 8, 1 << 24, NULL, "",
          "of a reading at most, whatever its error is" },
        { "count-windows", "Measure", NOC_OPTION_BOOL, offsetof(A, count_windows), 0, 1, NULL, "",
          "lit windows count; else they are dark" },
        { "json", "Measure", NOC_OPTION_BOOL, offsetof(A, json), 0, 1, NULL, "", "print figures as JSON" },
        { NULL },
    };
    return rows;
}

static int run(void *arguments);

static const measure_args defaults = {
    .render = { .command = &cli_measure,
                .camera = noc_camera_default_params(),
                .exposure = "auto",
                .device = CLI_DEVICE,
                .render = noc_render_default_params(),
                .display = noc_display_default_params(),
                .import = noc_import_default_params(),
                .builtin = noc_builtin_default_params() },
    .grid = 1,
    .height = 0.003,
    .error = 0.05,
    .samples = 1024,
};

const cli_command cli_measure = {
    "measure",
    "INPUT... -o LUX.tif | --points FILE | --region REGION",
    "Measures illuminance as a luxmeter does: of the ground as a raster for QGIS, at points, or of a street.",
    "Examples\n"
    "  nocturne measure town.yaml --grid 1 -o lux.tif\n"
    "  nocturne measure city.gml lamps.geojson --on road,sidewalk --te 678000,5403300,678200,5403500 -o lux.tif\n"
    "  nocturne measure town.yaml --region \"street:Am Stein\"\n"
    "  nocturne measure town.yaml --points points.txt -o lux.csv\n"
    "Lamps and the sky count (--sky 0: lamps alone), direct light alone. Coordinates are in the scene's CRS, of scenes "
    "that have none local metres.\n",
    { { options, 0, NULL },
      { noc_device_options, offsetof(A, render.device), NULL },
      { cli_camera_options, offsetof(A, render), NULL },
      { noc_camera_options, offsetof(A, render.camera), NULL },
      { noc_render_options, offsetof(A, render.render), cli_of_pictures },
      { noc_import_options, offsetof(A, render.import), NULL },
      { noc_city_options, offsetof(A, render.builtin.city), NULL },
      { noc_builtin_options, offsetof(A, render.builtin), NULL },
      { cli_common_options, 0, NULL } },
    sizeof(measure_args),
    &defaults,
    run,
};

/* ---- what is asked for ---- */

static bool to_stdout(const measure_args *args) { return args->render.output && !strcmp(args->render.output, "-"); }

static int check_what(const measure_args *args) {
    const char *output = args->render.output;
    if (!args->render.common.input_count)
        return cli_usage(&cli_measure, "which city? builtin:city is the built-in one");
    if (!output && !args->points && !args->regions.count)
        return cli_usage(&cli_measure, "what is to be measured? -o lux.tif, --points FILE, or --region street:NAME");
    if (args->points && args->regions.count)
        return cli_usage(&cli_measure, "--points and --region exclude each other");
    if (!args->points && args->response)
        return cli_usage(&cli_measure, "--response is for --points");
    if (to_stdout(args) && !args->points)
        return cli_usage(&cli_measure, "-o - is for --points: a GeoTIFF is a file");
    const char *dot = output && !args->points ? strrchr(output, '.') : NULL;
    if (output && !args->points && (!dot || (strcasecmp(dot, ".tif") && strcasecmp(dot, ".tiff"))))
        return cli_usage(&cli_measure, "%.100s must end in .tif: the raster is a GeoTIFF", output);
    for (size_t i = 0; i < args->regions.count; i++)
        if (!strncmp(args->regions.text[i], "object:", 7))
            return cli_usage(&cli_measure, "--region object:ID has surfaces, not points: nocturne influence has their "
                                           "mean");
    return CLI_OK;
}

static int parse_extent(measure_job *job) {
    const char *text = job->args->extent;
    double *e = job->raster.extent;
    if (!text)
        return CLI_OK;
    if (!noc_text_numbers(text, ',', 4, e))
        return cli_usage(&cli_measure, "--te is \"%.60s\", must be west,south,east,north", text);
    return e[0] < e[2] && e[1] < e[3]
               ? CLI_OK
               : cli_usage(&cli_measure, "--te: %.60s: west is less than east, and south less than north", text);
}

static int check(measure_job *job) {
    measure_args *args = job->args;
    render_args *render = &args->render;
    int status = check_what(args);
    status = status ? status : parse_extent(job);
    status = status ? status : cli_parse_classes(&cli_measure, "--on", args->on, &job->raster.classes);
    status = status ? status : cli_choose_camera(render);
    if (status)
        return status;
    cli_add_named(&render->common, &render->import);
    status = cli_check_city(render);
    return status || !render->output || to_stdout(args)
               ? status
               : cli_check_output(&cli_measure, render->output, CLI_ANY, &render->common);
}

/* ---- the work ---- */

static bool show(void *user, const char *what, double done) {
    (void)user;
    cli_progress_show(done, -1, "%s", what);
    return !cli_interrupted();
}

/* A plan of street lighting may not rely on windows. */
static noc_status darken_windows(measure_job *job) {
    noc_window_params windows = job->args->render.import.window;
    windows.lit_windows = 0;
    noc_status status = job->args->count_windows ? NOC_OK : noc_scene_set_windows(job->scene, &windows);
    return status || job->args->count_windows ? status : noc_scene_commit(job->scene);
}

static noc_status open_city(measure_job *job) {
    render_args *render = &job->args->render;
    const noc_progress progress = { cli_load_progress, NULL };
    job->scene = noc_scene_create(job->log);
    noc_status status = cli_load_city(render, job->scene, &progress, &job->report);
    cli_progress_clear();
    status = status ? status : darken_windows(job);
    if (!status)
        status = noc_scene_place_camera(job->scene, &render->camera,
                                        (double)render->render.width / render->render.height, &job->camera, NULL);
    noc_scene_get_info(job->scene, &job->info);
    job->device = status ? NULL : noc_device_create(&render->device, job->log);
    job->view = job->device ? noc_view_create(job->device, job->scene) : NULL;
    return status || job->view ? status : NOC_ERR_MEMORY;
}

static noc_status work(measure_job *job) {
    measure_args *args = job->args;
    noc_status status = open_city(job);
    job->params = (noc_measure_params){ &args->render.render, args->error, 0.1, args->samples };
    job->raster.crs = args->crs;
    job->raster.step = args->grid;
    job->raster.height = args->height;
    job->progress = (noc_progress){ show, job };
    if (!status && args->points)
        return measure_points(job);
    status = status || !args->regions.count ? status : measure_regions(job);
    return status || !args->render.output ? status : measure_raster(job);
}

static int run(void *arguments) {
    measure_args *args = arguments;
    measure_job job = { .args = args };
    int status = check(&job);
    if (status)
        return status;
    cli_catch_signals();
    cli_nothing_to_keep(true);
    cli_progress_start(args->render.common.quiet);
    job.log = cli_log_create(&args->render.common);
    noc_status failed = work(&job);
    cli_nothing_to_keep(false);
    noc_view_destroy(job.view);
    noc_device_destroy(job.device);
    noc_report_destroy(job.report);
    noc_scene_destroy(job.scene);
    noc_log_destroy(job.log);
    if (cli_interrupted()) {
        cli_error("interrupted");
        return CLI_INTERRUPTED + cli_interrupted();
    }
    return failed ? CLI_FAILURE : cli_flush(stdout) ? CLI_OK : CLI_FAILURE;
}
