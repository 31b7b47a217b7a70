/* nocturne influence: who lights this? */
#include "influence.h"

#include <stdlib.h>
#include <string.h>

#define A influence_args
static const noc_option own_options[] = {
    { "region", "Influence", NOC_OPTION_TEXTS, offsetof(A, regions), 0, 0, NULL, "REGION",
      "a place: point:X,Y[,CRS], pixel:X,Y, rect:X0,Y0,X1,Y1, object:ID, street:NAME or polygon:FILE|WKT; repeatable" },
    { "class", "Influence", NOC_OPTION_TEXT, offsetof(A, classes), 0, 0, NULL, "NAMES",
      "of an object: surfaces of these classes alone, such as wall,roof" },
    { "lamp", "Influence", NOC_OPTION_TEXT, offsetof(A, lamp), 0, 0, NULL, "ID",
      "instead of a region: a lamp, what is known of it, and what it lights" },
    { "count-windows", "Influence", NOC_OPTION_BOOL, offsetof(A, count_windows), 0, 1, NULL, "",
      "windows count in sums, shares and rows; their lux is told in any case" },
    { "top", "Influence", NOC_OPTION_INT, offsetof(A, top), 1, 1000000, NULL, "", "rows: the strongest so many" },
    { "csv", "Influence", NOC_OPTION_TEXT, offsetof(A, csv), 0, 0, NULL, "FILE",
      "write all rows as CSV, too; - = instead of the table" },
    { "json", "Influence", NOC_OPTION_BOOL, offsetof(A, json), 0, 1, NULL, "", "print JSON instead of a table" },
    { "error", "Influence", NOC_OPTION_REAL, offsetof(A, error), 1e-6, 1, NULL, "",
      "relative standard error of the lux and of the greatest share to end at" },
    { "time", "Influence", NOC_OPTION_REAL, offsetof(A, time), 0, 1e6, NULL, "s",
      "time to end after, whatever the error is; 0 = any" },
    { NULL },
};
static const noc_option *options(void) { return own_options; }

static int run(void *arguments);

static const influence_args defaults = {
    .render = CLI_SITE_DEFAULTS(cli_influence),
    .top = 20,
    .time = 10,
    .error = 0.01,
};
const cli_command cli_influence = {
    "influence",
    "INPUT... --region REGION | --lamp ID",
    "Tells who lights a place: the lights that reach it, ranked, in lux and shares with their standard errors.",
    "Examples\n"
    "  nocturne influence city.gml lamps.geojson --region point:678120,5403410\n"
    "  nocturne influence builtin:city --region pixel:640,500 --top 10\n"
    "  nocturne influence city.yaml --camera square --region rect:300,400,500,600 --csv square.csv\n"
    "  nocturne influence city.gml lamps.geojson --lamp node/3116871579\n"
    "Coordinates are in the scene's CRS, of scenes that have none local metres; pixels are those of the camera's "
    "picture of --width by --height.\n",
    { { options, 0, NULL }, CLI_SITE_SETS(influence_args) },
    sizeof(influence_args),
    &defaults,
    run,
};

static int check_regions(const influence_args *args) {
    size_t count = args->regions.count;
    if (!count == !args->lamp)
        return args->lamp ? cli_usage(&cli_influence, "--region and --lamp exclude each other")
                          : cli_usage(&cli_influence, "--region is needed, point:X,Y, for one; or --lamp");
    if (args->csv && args->lamp)
        return cli_usage(&cli_influence, "--csv is for --region");
    for (size_t i = 0; args->classes && i < count + !count; i++)
        if (args->lamp || strncmp(args->regions.text[i], "object:", 7) != 0)
            return cli_usage(&cli_influence, "--class is for --region object:ID");
    return CLI_OK;
}

static int check(influence_args *args) {
    render_args *render = &args->render;
    if (!render->common.input_count)
        return cli_usage(&cli_influence, CLI_SITE_NEEDED);
    int status = check_regions(args);
    if (status)
        return status;
    if (args->json && influence_csv_alone(args))
        return cli_usage(&cli_influence, "--json and --csv - exclude each other: both write to standard output");
    status = cli_parse_classes(&cli_influence, "--class", args->classes, &args->class_bits);
    status = status ? status : cli_site_check(render);
    return status || !args->csv || influence_csv_alone(args)
               ? status
               : cli_check_output(&cli_influence, args->csv, CLI_ANY, &render->common);
}

/* The seen luminance is told of pixels alone: a point is seen by nobody. */
bool influence_has_eye(const char *region) { return !strncmp(region, "pixel:", 6) || !strncmp(region, "rect:", 5); }

/* Parts of the others weigh as much as their areas. */
static bool has_area(const char *region) { return !influence_has_eye(region) && strncmp(region, "point:", 6) != 0; }

/* A place in a body or in the ground is dark, which its answer says, but for a CSV's. */
static void tell_buried(influence_job *job) {
    const noc_region_info *r = &job->region_info;
    *job->buried = 0;
    bool place = !strncmp(job->asked, "point:", 6);
    if (place && !noc_view_buried(job->site.view, job->site.scene, r->centre, job->buried, sizeof(job->buried)) &&
        *job->buried && job->args->csv) {
        char *text = cli_format("%.200s lies %s", job->asked, job->buried);
        cli_log_message(NULL, NOC_LOG_WARN, text);
        free(text);
    }
}

static noc_status ask_region(influence_job *job) {
    influence_args *args = job->args;
    const render_args *render = &args->render;
    noc_region_params of = { .camera = &job->site.camera,
                             .width = render->render.width,
                             .height = render->render.height,
                             .classes = args->class_bits,
                             .files = true };
    noc_ranking_params params = { &render->render, influence_has_eye(job->asked) ? job->site.camera.eye : NULL,
                                  args->count_windows };
    noc_ranking_target target = { .seconds = args->time, .error = args->error };
    noc_progress progress = { cli_load_progress, NULL };
    job->region = noc_region_find(job->site.view, job->site.scene, job->asked, &of, job->site.log);
    noc_ranking *ranking = job->region ? noc_ranking_create(job->site.view, job->region, &params) : NULL;
    if (!ranking)
        return NOC_ERR_ARGUMENT;
    noc_region_get_info(job->region, &job->region_info);
    tell_buried(job);
    noc_status status = noc_ranking_refine(ranking, &target, &progress);
    cli_progress_clear();
    job->rows = cli_alloc((size_t)args->top * sizeof(*job->rows));
    status = status ? status : noc_ranking_get(ranking, job->rows, (size_t)args->top, &job->count, &job->sum);
    if (!status && has_area(job->asked))
        status = noc_ranking_get_classes(ranking, job->classes, NOC_CLASS_COUNT, &job->class_count);
    if (!status && !influence_csv_alone(args)) {
        fputs(job->lead, stdout);
        job->lead = args->json ? ",\n" : "\n";
        status = influence_print(job);
    }
    if (!status && args->csv) { /* of all that was found */
        free(job->rows);
        job->rows = cli_alloc((job->sum.emitters + 1) * sizeof(*job->rows));
        status = noc_ranking_get(ranking, job->rows, job->sum.emitters, &job->count, &job->sum);
        status = status ? status : influence_add_csv(job);
    }
    noc_ranking_destroy(ranking);
    return status;
}

/* One after the other; several in JSON are an array, of those before the first one that cannot be answered. */
static noc_status ask(influence_job *job) {
    const influence_args *args = job->args;
    bool array = args->json && args->regions.count > 1;
    noc_status status = NOC_OK;
    job->lead = array ? "[\n" : "";
    for (size_t i = 0; i < args->regions.count && !status; i++) {
        job->asked = args->regions.text[i];
        job->class_count = 0;
        status = ask_region(job);
        free(job->rows);
        job->rows = NULL;
        noc_region_destroy(job->region);
        job->region = NULL;
    }
    if (array && *job->lead == ',')
        puts("]");
    status = status || !args->csv ? status : influence_write_csv(job);
    free(job->csv);
    return status;
}

static noc_status work(void *user) {
    influence_job *job = user;
    influence_args *args = job->args;
    args->render.import.each_lamp = true;
    noc_status status = cli_site_open(&job->site, &args->render, false, args->csv);
    return status ? status : args->lamp ? influence_tell_lamp(job) : ask(job);
}

static int run(void *arguments) {
    influence_args *args = arguments;
    influence_job job = { .args = args };
    int status = check(args);
    return status ? status : cli_site_run(&job.site, &args->render, work, &job);
}
