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
        { "meter-height", "Measure", NOC_OPTION_REAL, offsetof(A, meter_height), -1000, 1000, NULL, "m",
          "of the luxmeter over the ground, of the raster and of regions" },
        { "points", "Measure", NOC_OPTION_TEXT, offsetof(A, points), 0, 0, NULL, "FILE",
          "measure at these: x y z nx ny nz a line, as rtrace -I has them; - = standard input" },
        { "response", "Measure", NOC_OPTION_CHOICE, offsetof(A, response), 0, 0,
          "plane|semicylinder|cylinder|hemisphere", "",
          "of --points: a plane's illuminance, or semicylindrical, cylindrical, hemispherical" },
        { "region", "Measure", NOC_OPTION_TEXTS, offsetof(A, regions), 0, 0, NULL, "REGION",
          "figures of a place, as nocturne influence has it: street:NAME or polygon:FILE|WKT; repeatable" },
        { "streets", "Measure", NOC_OPTION_TEXT, offsetof(A, streets), 0, 0, NULL, "FILE",
          "figures of each street that has a name, as lines of GeoJSON (streets.geojson); - = standard output" },
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
    .render = CLI_SITE_DEFAULTS(cli_measure),
    .grid = 1,
    .meter_height = 0.003,
    .error = 0.05,
    .samples = 1024,
};

const cli_command cli_measure = {
    "measure",
    "INPUT... -o LUX.tif | --points FILE | --region REGION | --streets FILE",
    "Measures illuminance as a luxmeter does: of the ground as a raster for QGIS, at points, or of a street.",
    "Examples\n"
    "  nocturne measure town.yaml --grid 1 -o lux.tif\n"
    "  nocturne measure city.gml lamps.geojson --on road,sidewalk --te 678000,5403300,678200,5403500 -o lux.tif\n"
    "  nocturne measure town.yaml --region \"street:Am Stein\"\n"
    "  nocturne measure town.yaml --streets streets.geojson\n"
    "  nocturne measure town.yaml --points points.txt -o lux.csv\n"
    "Lamps and the sky count (--sky 0: lamps alone), direct light alone. Coordinates are in the scene's CRS, of scenes "
    "that have none local metres.\n",
    { { options, 0, NULL }, CLI_SITE_SETS(measure_args) },
    sizeof(measure_args),
    &defaults,
    run,
};

/* ---- what is asked for ---- */

static bool to_stdout(const measure_args *args) { return args->render.output && !strcmp(args->render.output, "-"); }

/* Refuses options of a raster that is not asked for, and of meters on the ground beside those of --points. */
static int check_use(const measure_args *args) {
    static const char *const of_raster[] = { "grid", "te", "on" };
    bool raster = args->render.output && !args->points;
    for (size_t i = 0; i < sizeof(of_raster) / sizeof(*of_raster) && !raster; i++)
        if (cli_given(&args->render.common, of_raster[i]))
            return cli_usage(&cli_measure, "--%s is for a raster: -o LUX.tif without --points", of_raster[i]);
    if (args->points && cli_given(&args->render.common, "meter-height"))
        return cli_usage(&cli_measure, "--meter-height is for a raster and --region: --points has heights of its own");
    if (!args->points && args->response)
        return cli_usage(&cli_measure, "--response is for --points");
    return CLI_OK;
}

static int check_file(const measure_args *args) {
    const char *output = args->render.output;
    if (to_stdout(args) && !args->points)
        return cli_usage(&cli_measure, "-o - is for --points: a GeoTIFF is a file");
    const char *dot = output && !args->points ? strrchr(output, '.') : NULL;
    if (output && !args->points && (!dot || (strcasecmp(dot, ".tif") && strcasecmp(dot, ".tiff"))))
        return cli_usage(&cli_measure, "%.100s must end in .tif: the raster is a GeoTIFF", output);
    if (output && args->points && !to_stdout(args) && cli_same_file(output, args->points)) {
        cli_error("%.100s has the points of --points; it would be overwritten", output);
        return CLI_FAILURE;
    }
    return CLI_OK;
}

static int check_what(const measure_args *args) {
    if (!args->render.common.input_count)
        return cli_usage(&cli_measure, CLI_SITE_NEEDED);
    if (!args->render.output && !args->points && !args->regions.count && !args->streets)
        return cli_usage(&cli_measure, "what is to be measured? -o lux.tif, --points FILE, --region street:NAME, or "
                                       "--streets streets.geojson");
    if (args->points && (args->regions.count || args->streets))
        return cli_usage(&cli_measure, "--points and --%s exclude each other", args->streets ? "streets" : "region");
    if (args->streets && !strcmp(args->streets, "-") && (args->regions.count || args->render.output))
        return cli_usage(&cli_measure, "--streets - writes to standard output, and nothing beside it may");
    for (size_t i = 0; i < args->regions.count; i++)
        if (!strncmp(args->regions.text[i], "object:", 7))
            return cli_usage(&cli_measure, "--region object:ID has surfaces, not points: nocturne influence has their "
                                           "mean");
    int status = check_use(args);
    return status ? status : check_file(args);
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
    status = status ? status : cli_site_check(render);
    if (!status && args->streets && strcmp(args->streets, "-"))
        status = cli_check_output(&cli_measure, args->streets, CLI_ANY, &render->common);
    return status || !render->output || to_stdout(args)
               ? status
               : cli_check_output(&cli_measure, render->output, CLI_ANY, &render->common);
}

/* ---- the work ---- */

static noc_status work(void *user) {
    measure_job *job = user;
    measure_args *args = job->args;
    point_list points = { 0 };
    noc_status status = args->points ? measure_read_points(args, &points) : NOC_OK;
    /* A plan of street lighting may not rely on windows. */
    status = status ? status : cli_site_open(&job->site, &args->render, !args->count_windows, args->render.output);
    if (!status && args->streets && cli_check_sources(job->site.scene, args->streets))
        status = NOC_ERR_ARGUMENT;
    job->params = (noc_measure_params){ &args->render.render, args->error, 0.1, args->samples };
    job->raster.crs = args->crs;
    job->raster.step = args->grid;
    job->raster.height = args->meter_height;
    job->progress = (noc_progress){ cli_load_progress, NULL };
    if (!status && args->points)
        status = measure_points(job, &points);
    measure_free_points(&points);
    status = status || !args->regions.count ? status : measure_regions(job);
    status = status || !args->streets ? status : measure_streets(job);
    return status || !args->render.output || args->points ? status : measure_raster(job);
}

static int run(void *arguments) {
    measure_args *args = arguments;
    measure_job job = { .args = args };
    int status = check(&job);
    return status ? status : cli_site_run(&job.site, &args->render, work, &job);
}
