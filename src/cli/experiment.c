/* nocturne experiment: configurations over frames against one reference, as a spec says. */
#include "lab/lab.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#define A lab_args
static const noc_option own_options[] = {
    { "output", "Output", NOC_OPTION_TEXT, offsetof(A, output), 0, 0, NULL, "FOLDER",
      "folder for rows, plots, crops and report; else the spec's name without .json" },
    { "cache", "Output", NOC_OPTION_TEXT, offsetof(A, cache), 0, 0, NULL, "FOLDER",
      "folder that references are kept in; else nocturne in the user's cache folder" },
    { "threads", "Output", NOC_OPTION_INT, offsetof(A, threads), 0, 1024, NULL, "", "threads; 0 = one a core" },
    { NULL },
};
static const noc_option *options(void) { return own_options; }
static int run(void *arguments);

static const lab_args defaults = { .threads = 0 };

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
    { { options, 0, NULL }, { cli_common_options, 0, NULL } },
    sizeof(lab_args),
    &defaults,
    run,
};

/* Makes a folder and those above it. */
static int make_folder(const char *path) {
    char *part = cli_format("%s", path);
    bool failed = false;
    for (char *c = part + 1; !failed; c++) {
        char end = *c;
        if (end && end != '/')
            continue;
        *c = 0;
        failed = mkdir(part, 0777) && errno != EEXIST && errno != EISDIR;
        *c = end;
        if (!end)
            break;
    }
    struct stat st;
    if (!failed && !stat(path, &st) && !S_ISDIR(st.st_mode)) {
        failed = true;
        errno = ENOTDIR;
    }
    if (!failed && access(path, W_OK | X_OK))
        failed = true;
    if (failed)
        cli_error("%s: this folder cannot be used: %s", path, strerror(errno));
    free(part);
    return failed ? CLI_FAILURE : CLI_OK;
}

static char *output_folder(const lab_args *args) {
    if (args->output)
        return cli_format("%s", args->output);
    const char *spec = args->common.inputs[0], *slash = strrchr(spec, '/');
    char *name = lab_spec_name(spec);
    if (strcmp(name, slash ? slash + 1 : spec))
        return name;
    char *folder = cli_format("%s.results", name); /* the spec has that name itself */
    free(name);
    return folder;
}

static char *cache_folder(const lab_session *lab) {
    const char *cache = getenv("XDG_CACHE_HOME"), *home = getenv("HOME");
    if (lab->args->cache)
        return cli_format("%s", lab->args->cache);
    if (cache && *cache == '/')
        return cli_format("%s/nocturne", cache);
    return home && *home == '/' ? cli_format("%s/.cache/nocturne", home) : cli_format("%s/cache", lab->folder);
}

static int open_folders(lab_session *lab) {
    lab->folder = output_folder(lab->args);
    lab->cache = cache_folder(lab);
    char *pictures = cli_format("%s/pictures", lab->folder);
    int status = make_folder(lab->folder);
    status = status ? status : make_folder(pictures);
    status = status ? status : make_folder(lab->cache);
    free(pictures);
    if (status)
        return status;
    lab->lock = open(lab->folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (lab->lock >= 0 && flock(lab->lock, LOCK_EX | LOCK_NB) && errno == EWOULDBLOCK) {
        cli_error("%s: another experiment is writing there", lab->folder);
        return CLI_FAILURE;
    }
    return lab_open_table(lab);
}

/* What pictures take is asked for before the work: the reference, one frame, their mean, and the file of one. It is not
 * touched yet, so it costs addresses only. */
static int reserve(lab_session *lab) {
    size_t pixels = (size_t)lab->spec.width * (size_t)lab->spec.height, others = pixels * 4 * 20;
    lab->sum = malloc(sizeof(double) * 3 * pixels);
    void *room = lab->sum ? malloc(others) : NULL;
    free(room);
    if (room)
        return CLI_OK;
    char text[32];
    cli_error("no memory for pictures of %d x %d (%s)", lab->spec.width, lab->spec.height,
              noc_text_bytes(text, sizeof(double) * 3 * pixels + others));
    return CLI_FAILURE;
}

static void plan(lab_session *lab) {
    const lab_spec *spec = &lab->spec;
    lab->run_count = spec->camera_count * (size_t)spec->repetitions * spec->config_count;
    lab->runs = cli_alloc(sizeof(*lab->runs) * lab->run_count);
    lab->scene_infos = cli_alloc(sizeof(*lab->scene_infos) * spec->scene_count);
    lab->crops = cli_alloc(sizeof(*lab->crops) * spec->camera_count);
    lab->noises = cli_alloc(sizeof(*lab->noises) * spec->camera_count);
    for (size_t i = 0; i < lab->run_count; i++) {
        lab_run *run = &lab->runs[i];
        size_t rest = i / spec->config_count;
        run->config = i % spec->config_count;
        run->repetition = (int)(rest % (size_t)spec->repetitions);
        run->camera = rest / (size_t)spec->repetitions;
    }
}

static void tell_unlit(const lab_session *lab, size_t camera, int status) {
    char *told = status || lab->args->common.quiet ? NULL : lab_unlit(lab, camera);
    const lab_camera *c = &lab->spec.cameras[camera];
    if (told)
        printf("%s, %s: %s\n", lab->spec.scenes[c->scene].name, c->name, told);
    free(told);
}

/* All runs under one camera of the present scene. */
static int work_camera(lab_session *lab, size_t camera) {
    const lab_spec *spec = &lab->spec;
    int status = lab_make_reference(lab, camera);
    lab_run *runs = lab_find_run(lab, camera, 0, 0);
    size_t count = (size_t)spec->repetitions * spec->config_count;
    for (size_t i = 0; !status && i < count; i++) {
        lab_run_key(lab, &runs[i]);
        lab_claim(lab, &runs[i]);
    }
    for (size_t i = 0; !status && i < count; i++, lab->runs_done++)
        status = lab_measure(lab, &runs[i]);
    cli_progress_clear();
    tell_unlit(lab, camera, status);
    lab->cameras_done++;
    status = status ? status : lab_make_crops(lab, camera);
    noc_image_destroy(lab->reference);
    lab->reference = NULL;
    return status;
}

static int work(lab_session *lab) {
    const lab_spec *spec = &lab->spec;
    int status = CLI_OK;
    char rows[64], frames[64];
    lab->started = cli_now();
    for (size_t camera = 0; !status && camera < spec->camera_count; camera++) {
        size_t scene = spec->cameras[camera].scene;
        if (!lab->scene)
            status = lab_load_scene(lab, scene);
        if (!status)
            status = cli_interrupted() ? CLI_INTERRUPTED + cli_interrupted() : work_camera(lab, camera);
        if (status || camera + 1 == spec->camera_count || spec->cameras[camera + 1].scene != scene) {
            noc_scene_destroy(lab->scene);
            lab->scene = NULL;
        }
    }
    if (status > CLI_INTERRUPTED && lab->reference_lost)
        cli_error(
            "interrupted: %s in %s/results.csv; the same command goes on there, but begins this reference anew: the %s "
            "of %d that were there are lost",
            noc_text_many(rows, lab->rows_done, "row"), lab->folder,
            noc_text_many(frames, (uint64_t)lab->reference_lost, "frame"), spec->reference.frames);
    else if (status > CLI_INTERRUPTED)
        cli_error("interrupted: %s in %s/results.csv; the same command goes on there",
                  noc_text_many(rows, lab->rows_done, "row"), lab->folder);
    status = status ? status : lab_tidy_table(lab);
    status = status ? status : lab_write_report(lab);
    if (!status && !lab->args->common.quiet)
        printf("%s/report.md: %s, %zu of them made now\n", lab->folder, noc_text_many(rows, lab->rows_done, "row"),
               lab->rows_done - lab->rows_old);
    return status;
}

static int finish(lab_session *lab, int status) {
    cli_progress_clear();
    if (lab->csv && fclose(lab->csv) && !status) {
        cli_error("%s/results.csv: %s", lab->folder, strerror(errno));
        status = CLI_FAILURE;
    }
    for (size_t i = 0; i < lab->run_count; i++)
        for (int mode = 0; mode < LAB_MODES; mode++)
            free(lab->runs[i].rows[mode]);
    free(lab->runs);
    free(lab->scene_infos);
    free(lab->crops);
    free(lab->noises);
    free(lab->stored);
    free(lab->sum);
    free(lab->folder);
    free(lab->cache);
    if (lab->lock >= 0)
        close(lab->lock);
    return status;
}

static int run(void *arguments) {
    lab_session lab = { .args = arguments, .lock = -1 };
    if (lab.args->common.input_count != 1)
        return cli_usage(&cli_experiment, "one spec, a JSON file: docs/experiments.md tells what it holds");
    int status = lab_read_spec(&lab.spec, lab.args->common.inputs[0], lab.args->common.quiet);
    if (!status) {
        cli_catch_signals();
        cli_progress_start(lab.args->common.quiet);
        lab.log = cli_log_create(&lab.args->common);
        plan(&lab);
        status = reserve(&lab);
        status = status ? status : open_folders(&lab);
        status = finish(&lab, status ? status : work(&lab));
        noc_log_destroy(lab.log);
    }
    lab_free_spec(&lab.spec);
    return cli_flush(stdout) ? status : CLI_FAILURE;
}
