/* The runs of a spec, from the first scene to the report. */
#include "lab/crops.h"
#include "lab/file.h"
#include "lab/keys.h"
#include "lab/noise.h"
#include "lab/parts.h"
#include "lab/reference.h"
#include "lab/report.h"
#include "lab/run.h"
#include "lab/table.h"

#include <errno.h>
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

/* Of the user, or in the folder itself where there is no user. */
static char *cache_folder(const noc_lab_params *params) {
    const char *cache = getenv("XDG_CACHE_HOME"), *home = getenv("HOME");
    if (params->cache)
        return noc_strdup(params->cache);
    if (cache && *cache == '/')
        return noc_format("%s/nocturne", cache);
    return home && *home == '/' ? noc_format("%s/.cache/nocturne", home) : noc_format("%s/cache", params->folder);
}

/* Locks the folder: parts share it, any other session has it alone. */
static bool lock_folder(lab_session *lab, bool shared) {
    lab->lock = open(lab->folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    return lab->lock < 0 || !flock(lab->lock, (shared ? LOCK_SH : LOCK_EX) | LOCK_NB) || errno != EWOULDBLOCK;
}

/* Parts that begin or join do so one after the other. */
static noc_status open_shared(lab_session *lab) {
    char *path = noc_format("%s/.lock", lab->folder);
    if (!path)
        return noc_no_memory(lab->log, lab->folder);
    lab->guard = lab_wait_for(lab, path, NULL);
    free(path);
    if (lab->cancelled)
        return noc_cancelled(lab->log, "lab: cancelled");
    bool locked = lock_folder(lab, !lab->joining);
    if (!locked && lab->joining) {
        lab->busy = true;
        return NOC_OK;
    }
    if (!locked)
        return noc_error(lab->log, NOC_ERR_IO, "%s: another experiment is writing there", lab->folder);
    return lab->joining ? lab_open_table(lab) : lab_open_part(lab);
}

static noc_status open_alone(lab_session *lab) {
    if (!lock_folder(lab, false))
        return noc_error(lab->log, NOC_ERR_IO, "%s: another experiment is writing there", lab->folder);
    return lab_open_table(lab);
}

static noc_status open_folders(lab_session *lab) {
    char *pictures = noc_format("%s/pictures", lab->folder);
    bool shared = lab->params.parts > 1, part = shared && !lab->joining;
    noc_status status = pictures ? lab_make_folder(lab->folder, lab->log) : noc_no_memory(lab->log, lab->folder);
    status = status ? status : lab_make_folder(pictures, lab->log);
    status = status ? status : lab_make_folder(lab->cache, lab->log);
    free(pictures);
    status = status ? status : shared ? open_shared(lab) : open_alone(lab);
    if (!status && !part && !lab->busy)
        status = lab_take_parts(lab, &lab->busy);
    if (!status && lab->busy && !shared)
        return noc_error(lab->log, NOC_ERR_IO, "%s: another experiment is writing there", lab->folder);
    lab->joined = lab->joining && !lab->busy && !lab->taken.len;
    if (part && lab->guard >= 0) {
        close(lab->guard);
        lab->guard = -1;
    }
    return status;
}

/* What pictures take is asked for before the work: the reference, one frame, their mean, and the file of one. It is not
 * touched yet, so it costs addresses only. */
static noc_status reserve(lab_session *lab) {
    size_t pixels = (size_t)lab->spec->width * (size_t)lab->spec->height, others = pixels * 4 * 20;
    lab->sum = noc_alloc(sizeof(double) * 3 * pixels);
    void *room = lab->sum ? noc_alloc(others) : NULL;
    free(room);
    if (room)
        return NOC_OK;
    char text[32];
    return noc_error(lab->log, NOC_ERR_MEMORY, "no memory for pictures of %d x %d (%s)", lab->spec->width,
                     lab->spec->height, noc_text_bytes(text, sizeof(double) * 3 * pixels + others));
}

static noc_status plan(lab_session *lab) {
    const lab_spec *spec = lab->spec;
    lab->run_count = spec->camera_count * (size_t)spec->repetitions * spec->config_count;
    lab->runs = noc_calloc(lab->run_count, sizeof(*lab->runs));
    lab->holdings = noc_calloc(spec->scene_count, sizeof(*lab->holdings));
    lab->crops = noc_calloc(spec->camera_count, sizeof(*lab->crops));
    lab->truths = noc_calloc(spec->camera_count, sizeof(*lab->truths));
    if (!lab->runs || !lab->holdings || !lab->crops || !lab->truths) {
        lab->run_count = lab->runs ? lab->run_count : 0;
        return noc_no_memory(lab->log, "runs");
    }
    for (size_t i = 0; i < lab->run_count; i++) {
        lab_run *run = &lab->runs[i];
        size_t rest = i / spec->config_count;
        run->config = i % spec->config_count;
        run->repetition = (int)(rest % (size_t)spec->repetitions);
        run->camera = rest / (size_t)spec->repetitions;
        lab->runs_mine += lab->joining || lab_is_mine(lab, run);
    }
    return NOC_OK;
}

static noc_status create(const noc_lab_spec *spec, const noc_lab_params *params, bool joining, noc_lab **out,
                         noc_log *log) {
    noc_lab *lab = noc_calloc(1, sizeof(*lab));
    if (!lab)
        return noc_no_memory(log, "noc_lab_create");
    lab->spec = spec;
    lab->params = *params;
    lab->log = log;
    lab->joining = joining;
    lab->lock = lab->guard = lab->part_lock = -1;
    lab->folder = noc_strdup(params->folder);
    lab->cache = cache_folder(params);
    lab->params.folder = lab->params.cache = NULL;
    noc_status status = lab->folder && lab->cache ? plan(lab) : noc_no_memory(log, params->folder);
    status = status ? status : noc_device_find(&params->device, &lab->device, log);
    status = status ? status : reserve(lab);
    status = status ? status : open_folders(lab);
    if (status) {
        noc_lab_destroy(lab);
        return status;
    }
    lab_name_machine(lab);
    *out = lab;
    return NOC_OK;
}

noc_status noc_lab_create(const noc_lab_spec *spec, const noc_lab_params *params, noc_lab **out, noc_log *log) {
    if (out)
        *out = NULL;
    if (!spec || !params || !params->folder || !out)
        return noc_null(log, "noc_lab_create");
    bool parts = params->part || params->parts;
    if (parts && (params->part < 1 || params->part > params->parts))
        return noc_error(log, NOC_ERR_ARGUMENT, "noc_lab_create: part %d of %d does not exist", params->part,
                         params->parts);
    return create(spec, params, false, out, log);
}

void noc_lab_destroy(noc_lab *lab) {
    if (!lab)
        return;
    if (lab->csv && fclose(lab->csv))
        noc_error(lab->log, NOC_ERR_IO, "%s/results.csv: %s", lab->folder, strerror(errno));
    for (size_t i = 0; i < lab->run_count; i++)
        for (int mode = 0; mode < LAB_MODES; mode++)
            free(lab->runs[i].rows[mode]);
    free(lab->runs);
    free(lab->holdings);
    free(lab->crops);
    free(lab->truths);
    array_free(&lab->stored);
    free(lab->sum);
    free(lab->folder);
    free(lab->cache);
    lab_release_parts(lab);
    const int locks[] = { lab->part_lock, lab->lock, lab->guard };
    for (size_t i = 0; i < NOC_COUNT(locks); i++)
        if (locks[i] >= 0)
            close(locks[i]);
    free(lab);
}

static void tell_unlit(const lab_session *lab, size_t camera) {
    char told[2 * LAB_TEXT], view[LAB_TEXT];
    if (lab_tell_unlit(lab, camera, told))
        lab_note(lab, "%s: %s", lab_view_name(lab->spec, camera, view), told);
}

/* Rows of earlier sessions become those of the camera's runs. */
static noc_status claim_runs(lab_session *lab, lab_run *runs, size_t count) {
    noc_status status = NOC_OK;
    for (size_t i = 0; !status && i < count; i++) {
        if (!lab->joining && !lab_is_mine(lab, &runs[i]))
            continue;
        lab_name_run(lab, &runs[i]);
        status = lab_claim(lab, &runs[i]);
        if (!status && lab->joining)
            status = lab_run_misses(lab, &runs[i], &lab->missing);
    }
    return status;
}

/* All runs of this part under one camera of the present scene. */
static noc_status work_camera(lab_session *lab, size_t camera) {
    const lab_spec *spec = lab->spec;
    lab_run *runs = lab_find_run(lab, camera, 0, 0);
    size_t count = (size_t)spec->repetitions * spec->config_count;
    bool part = lab->params.parts > 1 && !lab->joining;
    noc_status status = lab_place_camera(lab, camera);
    status = status ? status : claim_runs(lab, runs, count);
    if (status || lab->missing)
        return status;
    status = lab_make_reference(lab, camera);
    for (size_t i = 0; !status && i < count; i++) {
        if (!part || lab_is_mine(lab, &runs[i])) {
            status = lab_measure_run(lab, &runs[i]);
            lab->runs_done++;
        }
    }
    if (!status && !part)
        tell_unlit(lab, camera);
    lab->cameras_done++;
    status = status || part ? status : lab_make_crops(lab, camera);
    noc_image_destroy(lab->reference);
    lab->reference = NULL;
    return status;
}

/* Has this part runs under the camera? */
static bool has_work(const lab_session *lab, size_t camera) {
    const lab_run *runs = lab_find_run(lab, camera, 0, 0);
    size_t count = (size_t)lab->spec->repetitions * lab->spec->config_count;
    bool mine = lab->joining;
    for (size_t i = 0; i < count && !mine; i++)
        mine = lab_is_mine(lab, &runs[i]);
    return mine;
}

noc_status noc_lab_run(noc_lab *lab) {
    if (!lab)
        return NOC_ERR_ARGUMENT;
    const lab_spec *spec = lab->spec;
    noc_status status = NOC_OK;
    lab->cancelled = lab->finished = false;
    for (size_t i = 0; i < spec->config_count; i++)
        if (spec->configs[i].seconds > 0 && lab->device.kind > NOC_DEVICE_SOFTWARE) {
            noc_warn(lab->log, "seconds: they are CPU time, and %s renders: a run is longer by the clock",
                     lab->device.name);
            break;
        }
    lab->runs_done = lab->cameras_done = lab->references_made = 0;
    lab->reference_seconds = lab->reference_lost = 0;
    lab->started = noc_wall_seconds();
    for (size_t camera = 0; !status && !lab->missing && camera < spec->camera_count; camera++) {
        size_t scene = spec->cameras[camera].scene;
        bool work = has_work(lab, camera);
        if (work && !lab->scene)
            status = lab_load_scene(lab, scene);
        if (work && !status)
            status = lab->cancelled ? noc_cancelled(lab->log, "lab: cancelled") : work_camera(lab, camera);
        if (status || camera + 1 == spec->camera_count || spec->cameras[camera + 1].scene != scene) {
            noc_scene_destroy(lab->scene);
            lab->scene = NULL;
        }
    }
    noc_scene_destroy(lab->scene);
    lab->scene = NULL;
    if (lab->params.parts > 1 && (!lab->joining || lab->missing)) /* the table of all comes later */
        return status;
    bool left_out = false;
    status = status ? status : lab_tidy_table(lab, &left_out);
    status = status ? status : lab_remove_parts(lab, left_out);
    lab->finished = !status;
    return status;
}

noc_status noc_lab_join(const noc_lab_spec *spec, const noc_lab_params *params, bool *joined, noc_log *log) {
    if (joined)
        *joined = false;
    if (!spec || !params || !params->folder || !joined)
        return noc_null(log, "noc_lab_join");
    noc_lab *lab = NULL;
    noc_status status = create(spec, params, true, &lab, log);
    if (!status && !lab->busy && !lab->joined)
        status = noc_lab_run(lab);
    if (!status && lab->finished)
        status = noc_lab_write_report(lab);
    *joined = !status && (lab->finished || lab->joined);
    noc_lab_destroy(lab);
    return status;
}

noc_status noc_lab_write_report(noc_lab *lab) {
    if (!lab)
        return NOC_ERR_ARGUMENT;
    if (!lab->finished)
        return noc_error(lab->log, NOC_ERR_ARGUMENT, "%s: a report is written when all is measured", lab->folder);
    size_t most = 0;
    for (size_t i = 0; i < lab->run_count; i++)
        most = NOC_MAX(most, (size_t)lab->runs[i].count);
    lab->values = noc_calloc(most * (size_t)lab->spec->repetitions, sizeof(double));
    noc_status status = lab->values ? lab_write_report(lab) : noc_no_memory(lab->log, "report");
    free(lab->values);
    lab->values = NULL;
    return status;
}

void noc_lab_get_state(const noc_lab *lab, noc_lab_state *state) {
    if (!state)
        return;
    *state = (noc_lab_state){ .folder = "" };
    if (lab)
        *state = (noc_lab_state){ lab->folder, lab->rows_done, lab->rows_done - lab->rows_old, lab->reference_lost,
                                  lab->spec->reference.frames };
}

bool noc_lab_get_row(const noc_lab *lab, size_t index, noc_lab_row *row) {
    for (size_t i = 0; lab && row && i < lab->run_count; i++) {
        const lab_run *run = &lab->runs[i];
        for (int frame = 1; frame <= run->count; frame++)
            for (int mode = 0; mode < LAB_MODES; mode++) {
                if (!run->rows[mode][frame - 1].done || index--)
                    continue;
                const lab_camera *camera = &lab->spec->cameras[run->camera];
                *row = (noc_lab_row){ lab->spec->scenes[camera->scene].name,
                                      camera->name,
                                      lab->spec->configs[run->config].name,
                                      run->repetition + 1,
                                      frame,
                                      mode == LAB_ACCUMULATED,
                                      run->rows[mode][frame - 1].values };
                return true;
            }
    }
    return false;
}
