/* The scene that is measured, and its reference. That is kept in the cache folder under a hash of all that it depends
 * on; the files there may be deleted at any time. */
#include "lab/reference.h"
#include "lab/keys.h"
#include "lab/measure.h"
#include "lab/motion.h"
#include "lab/noise.h"
#include "lab/parts.h"

#include <nocturne/nocturne.h>
#include <unistd.h>

#define LONG_WAIT 10 /* s */

static bool loading(void *user, const char *what, double done) {
    return lab_go_on(user, &(noc_lab_progress){ NOC_LAB_LOADING, done, -1, what, 0, 0 });
}

static void take_holdings(const noc_scene *scene, const noc_report *report, lab_holdings *held) {
    noc_report_totals totals;
    noc_scene_get_info(scene, &held->info);
    noc_report_get_totals(report, &totals);
    held->buildings = totals.buildings;
    held->lamps = totals.lamps_mapped + totals.lamps_inferred;
}

noc_status lab_load_scene(lab_session *lab, size_t index) {
    const lab_scene *scene = &lab->spec->scenes[index];
    noc_import_params import = scene->import;
    import.progress = (noc_progress){ loading, lab };
    import.builtin = &scene->builtin;
    import.threads = lab->params.device.threads;
    lab->scene = noc_scene_create(lab->log);
    if (!lab->scene)
        return NOC_ERR_MEMORY;
    noc_report *report = NULL;
    noc_status status = loading(lab, scene->name, 0)
                            ? noc_scene_load(lab->scene, scene->inputs, scene->input_count, &import, &report)
                            : NOC_ERR_CANCELLED;
    loading(lab, NULL, 1);
    if (!status)
        take_holdings(lab->scene, report, &lab->holdings[index]);
    noc_report_destroy(report);
    if (status)
        return status;
    if ((status = lab_check_sources(lab)))
        return status;
    noc_scene_content(lab->scene, lab->content);
    if (!lab->holdings[index].info.triangles)
        return noc_error(lab->log, NOC_ERR_FORMAT, "%s: its inputs hold no surface that can be drawn", scene->name);
    return NOC_OK;
}

typedef struct making {
    lab_session *lab;
    const char *view;
    int done; /* frames */
    double started;
} making;

static bool frame_progress(void *user, int frame, double done) {
    const making *m = user;
    int frames = m->lab->spec->reference.frames;
    double share = (frame - 1 + done) / frames, spent = noc_wall_seconds() - m->started;
    double left = spent > 2 && share > 0 ? spent / share - spent : -1;
    return lab_go_on(m->lab, &(noc_lab_progress){ NOC_LAB_REFERENCE, share, left, m->view, frame, frames });
}

/* What is waited for is said ahead, and how long as soon as that shows: the first frames build what they need and
 * learn.
 */
static void tell_estimate(void *user, int frame) {
    making *m = user;
    int frames = m->lab->spec->reference.frames;
    char took[32];
    m->done = frame;
    double left = (noc_wall_seconds() - m->started) / frame * (frames - frame);
    if (frame == (frames > 16 ? 3 : 1) && left >= LONG_WAIT)
        lab_note(m->lab, "%s: reference, about %s to go", m->view, noc_text_seconds(took, left));
}

/* NULL where there is none, or none that is whole. */
static noc_image *read_cached(const lab_session *lab, const char *path) {
    if (access(path, R_OK))
        return NULL;
    bool linear = false;
    noc_image *image = noc_image_read(path, NULL, &linear);
    if (image && linear && image->width == lab->spec->width && image->height == lab->spec->height)
        return image;
    noc_image_destroy(image);
    return NULL;
}

/* A cache that takes nothing must not cost the work that went into the picture. */
static void keep(const lab_session *lab, const char *path, const lab_truth *truth) {
    noc_display_params display = noc_display_default_params();
    const char *keys[] = { "content", "made-by", "backend", "device" };
    const char *values[] = { lab->reference_key, noc_version(), noc_backend_name(lab->device.backend),
                             lab->device.name };
    noc_log *why = noc_log_create(NULL);
    if (noc_image_write(lab->reference, path, &display, &(noc_image_meta){ 4, keys, values }, why))
        noc_warn(lab->log, "the reference is not kept; another run makes it again: %s", noc_log_last_error(why));
    else
        lab_keep_truth(path, truth);
    noc_log_destroy(why);
}

static noc_status render(lab_session *lab, const char *view, noc_lab_noise *noise) {
    const lab_spec *spec = lab->spec;
    making m = { lab, view, 0, noc_wall_seconds() };
    noc_device *device = noc_device_create(&lab->params.device, lab->log);
    if (!device)
        return NOC_ERR_MEMORY;
    noc_status status = lab_render_reference(&(lab_making){ .device = device,
                                                            .scene = lab->scene,
                                                            .camera = &lab->camera,
                                                            .params = spec->reference.params,
                                                            .frames = spec->reference.frames,
                                                            .ceiling = spec->ceiling,
                                                            .log = lab->log,
                                                            .user = &m,
                                                            .progress = frame_progress,
                                                            .rendered = tell_estimate },
                                             &lab->reference, noise);
    noc_device_destroy(device);
    if (status == NOC_ERR_CANCELLED)
        lab->reference_lost = m.done;
    return status;
}

static noc_status make(lab_session *lab, const char *view, const char *path, lab_truth *truth) {
    const lab_spec *spec = lab->spec;
    double start = noc_wall_seconds();
    char took[32], frames[64];
    lab_note(lab, "%s: making the reference, %s of %d x %d px", view,
             noc_text_many(frames, (uint64_t)spec->reference.frames, "frame"), spec->width, spec->height);
    noc_status status = render(lab, view, &truth->noise);
    lab_name_device(lab, truth->device);
    if (!status)
        keep(lab, path, truth);
    lab->reference_seconds += noc_wall_seconds() - start;
    lab->references_made++;
    if (!status)
        lab_note(lab, "%s: reference made in %s: %s", view, noc_text_seconds(took, noc_wall_seconds() - start), path);
    return status;
}

noc_status lab_place_camera(lab_session *lab, size_t camera) {
    noc_status status = lab_place_cameras(lab, camera);
    if (!status)
        lab_name_reference(lab);
    return status;
}

static void tell_cached(const lab_session *lab, const char *view, const char *path, lab_truth *truth) {
    lab_read_truth(path, truth);
    bool other = lab_backend_of(truth->device) != lab->device.backend;
    lab_note(lab, "%s: reference from %s%s%s", view, path, other ? ", rendered by " : "", other ? truth->device : "");
}

/* Processes that need the same reference make it once: the others wait. One that is killed holds no lock. */
static noc_status make_once(lab_session *lab, const char *view, const char *path, lab_truth *truth) {
    char what[LAB_TEXT + 20], *name = noc_format("%s.lock", path);
    if (!name)
        return noc_no_memory(lab->log, view);
    noc_snprintf(what, sizeof(what), "%s: reference", view);
    int lock = lab_wait_for(lab, name, what);
    noc_status status = lab->cancelled ? noc_cancelled(lab->log, "lab: cancelled") : NOC_OK;
    lab->reference = status ? NULL : read_cached(lab, path);
    if (lab->reference)
        tell_cached(lab, view, path, truth);
    else
        status = status ? status : make(lab, view, path, truth);
    if (lock >= 0) {
        unlink(name);
        close(lock);
    }
    free(name);
    return status;
}

noc_status lab_make_reference(lab_session *lab, size_t camera) {
    noc_status status = NOC_OK;
    char view[LAB_TEXT];
    lab_truth *truth = &lab->truths[camera];
    lab_view_name(lab->spec, camera, view);
    char *path = noc_format("%s/reference-%s.exr", lab->cache, lab->reference_key);
    if (!path)
        return noc_no_memory(lab->log, view);
    lab->reference = read_cached(lab, path);
    if (lab->reference)
        tell_cached(lab, view, path, truth);
    else
        status = make_once(lab, view, path, truth);
    if (!status && noc_image_is_black(lab->reference))
        noc_warn(lab->log, "%s: the reference is black, so errors say nothing", view);
    free(path);
    return status;
}
