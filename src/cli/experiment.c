/* nocturne experiment: configurations over frames against one reference, as a spec says. */
#include "cli.h"

#include <nocturne/lab.h>
#include <stdlib.h>
#include <string.h>

typedef struct experiment_args {
    cli_args common;
    const char *output, *cache, *part_text;
    noc_device_params device;
    cli_part part;
} experiment_args;

#define A experiment_args
static const noc_option own_options[] = {
    { "output", "Output", NOC_OPTION_TEXT, offsetof(A, output), 0, 0, NULL, "FOLDER",
      "folder for rows, plots, crops and report; else the spec's name without .json" },
    { "cache", "Output", NOC_OPTION_TEXT, offsetof(A, cache), 0, 0, NULL, "FOLDER",
      "folder that references are kept in; else nocturne in the user's cache folder" },
    CLI_OPTION_PART(A, "Output", part_text),
    { NULL },
};
static const noc_option *options(void) { return own_options; }
static int run(void *arguments);

static const experiment_args defaults = { .device = CLI_DEVICE };

const cli_command cli_experiment = {
    "experiment",
    "SPEC [-o FOLDER]",
    "Measures error and time of methods and settings against a reference, as a JSON file says.",
    "FOLDER gets results.csv, plots (SVG), first frames side by side (PNG) and\n"
    "report.md. What a spec may hold is told in docs/experiments.md; some are ready\n"
    "in experiments/.\n"
    "Examples\n"
    "  nocturne experiment experiments/methods-and-bias.json -o methods\n"
    "Ctrl-C ends with status 130; the same command goes on where it stopped.\n",
    { { options, 0, NULL }, { noc_device_options, offsetof(A, device), NULL }, { cli_common_options, 0, NULL } },
    sizeof(experiment_args),
    &defaults,
    run,
};

/* The spec's name; ".results" behind it where that is the spec itself. */
static char *output_folder(const experiment_args *args, const noc_lab_spec *spec) {
    if (args->output)
        return cli_format("%s", args->output);
    const char *path = args->common.inputs[0], *slash = strrchr(path, '/');
    noc_lab_spec_info info;
    noc_lab_spec_get_info(spec, &info);
    return cli_format("%s%s", info.name, strcmp(info.name, slash ? slash + 1 : path) ? "" : ".results");
}

static bool progress(void *user, const noc_lab_progress *p) {
    bool loading = p->stage == NOC_LAB_LOADING;
    cli_nothing_to_keep(loading && p->what);
    if (p->stage == NOC_LAB_REFERENCE)
        cli_progress_show(p->done, p->left, "%s: reference, frame %d of %d", p->what, p->frame, p->frames);
    else if (p->stage == NOC_LAB_MEASURING)
        cli_progress_show(p->done, p->left, "%s, frame %d", p->what, p->frame);
    else if (p->what)
        return cli_load_progress(NULL, p->what, p->done);
    else
        cli_progress_clear();
    return !cli_interrupted();
}

static void note(void *user, const char *text) {
    cli_progress_clear();
    printf("%s\n", text);
    fflush(stdout);
}

static void tell_part(const char *why, const noc_lab_state *state) {
    char rows[64], frames[64];
    noc_text_many(rows, state->rows, "row");
    noc_text_many(frames, (uint64_t)state->reference_lost, "frame");
    if (state->reference_lost)
        cli_error(
            "%s: %s in %s/results.csv; the same command goes on there, but begins this reference anew: the %s of %d "
            "that were there are lost",
            why, rows, state->folder, frames, state->reference_frames);
    else
        cli_error("%s: %s in %s/results.csv; the same command goes on there", why, rows, state->folder);
}

static int work(const experiment_args *args, noc_lab *lab) {
    noc_status status = noc_lab_run(lab);
    noc_lab_state state;
    char rows[64];
    const cli_part *part = &args->part;
    cli_progress_clear();
    noc_lab_get_state(lab, &state);
    if (status == NOC_ERR_CANCELLED && cli_interrupted()) {
        tell_part("interrupted", &state);
        return CLI_INTERRUPTED + cli_interrupted();
    }
    if (status && state.rows_made)
        tell_part("stopped", &state);
    noc_text_many(rows, state.rows, "row");
    if (part->count > 1 && !status && !args->common.quiet)
        printf("%s: %s in part %d of %d, %zu of them made now\n", state.folder, rows, part->number, part->count,
               state.rows_made);
    if (part->count > 1)
        return status ? CLI_FAILURE : CLI_OK;
    status = status ? status : noc_lab_write_report(lab);
    if (!status && !args->common.quiet)
        printf("%s/report.md: %s, %zu of them made now\n", state.folder, rows, state.rows_made);
    return status ? CLI_FAILURE : CLI_OK;
}

/* The part that ends last makes the table and the report of all. */
static int join(const experiment_args *args, const noc_lab_spec *spec, const noc_lab_params *params, noc_log *log) {
    bool joined;
    noc_status status = noc_lab_join(spec, params, &joined, log);
    cli_progress_clear();
    if (status == NOC_ERR_CANCELLED && cli_interrupted()) {
        cli_error("interrupted: all rows of this part are there; the same command joins them");
        return CLI_INTERRUPTED + cli_interrupted();
    }
    if (!status && !args->common.quiet && joined)
        printf("%s/report.md: of %d parts\n", params->folder, args->part.count);
    else if (!status && !args->common.quiet)
        printf("%s: no report yet: the part that ends last makes it, or the same command again\n", params->folder);
    return status ? CLI_FAILURE : CLI_OK;
}

/* The command line says what renders, else the spec. A spec's device is none of a backend that the command line names.
 */
static int take_device(experiment_args *args, const noc_lab_spec *spec) {
    noc_lab_spec_info info;
    noc_lab_spec_get_info(spec, &info);
    bool named = cli_given(&args->common, "backend") || cli_given(&args->common, "device");
    if (!cli_given(&args->common, "threads"))
        args->device.threads = info.device.threads;
    if (named)
        return CLI_OK;
    args->device.backend = info.device.backend;
    args->device.device = info.device.device;
    return cli_check_device(&cli_experiment, &args->device);
}

static int run_spec(const experiment_args *args, const noc_lab_spec *spec, noc_log *log) {
    char *folder = output_folder(args, spec);
    noc_lab_params params = { .folder = folder,
                              .cache = args->cache,
                              .device = args->device,
                              .part = args->part.number,
                              .parts = args->part.count,
                              .progress = progress,
                              .note = args->common.quiet ? NULL : note };
    noc_lab *lab;
    noc_status created = noc_lab_create(spec, &params, &lab, log);
    bool ended = created == NOC_ERR_CANCELLED && cli_interrupted(); /* while it waited for another part */
    int status = ended ? CLI_INTERRUPTED + cli_interrupted() : created ? CLI_FAILURE : work(args, lab);
    noc_lab_destroy(lab);
    if (!status && args->part.count > 1)
        status = join(args, spec, &params, log);
    free(folder);
    return status;
}

static int run(void *arguments) {
    experiment_args *args = arguments;
    if (args->common.input_count != 1)
        return cli_usage(&cli_experiment, "one spec, a JSON file: docs/experiments.md tells what it holds");
    int status = cli_check_device(&cli_experiment, &args->device);
    status = status ? status : cli_choose_part(&cli_experiment, &args->common, args->part_text, &args->part);
    if (status)
        return status;
    noc_log *log = cli_log_create(&args->common);
    noc_lab_spec *spec;
    noc_status read = noc_lab_spec_read(args->common.inputs[0], &spec, log);
    status = read == NOC_ERR_FORMAT ? cli_read_on(&cli_experiment) : read ? CLI_FAILURE : take_device(args, spec);
    if (!read && !status) {
        cli_catch_signals();
        cli_progress_start(args->common.quiet);
        status = run_spec(args, spec, log);
    }
    noc_lab_spec_destroy(spec);
    noc_log_destroy(log);
    return cli_flush(stdout) ? status : CLI_FAILURE;
}
