/* A view: checks, drives a backend through the plan of a frame, keeps history. */
#include "image/internal.h"
#include "light/influence.h"
#include "render/view.h"

#include <math.h>
#include <nocturne/option.h>
#include <stdio.h>
#include <unistd.h>

noc_view *noc_view_create(noc_device *device, const noc_scene *scene) {
    if (!device)
        return NULL;
    if (!scene || !scene->committed) {
        noc_error(device->log, NOC_ERR_ARGUMENT, "view: the scene is not committed");
        return NULL;
    }
    noc_view *v = noc_alloc(sizeof(*v));
    if (!v) {
        noc_no_memory(device->log, "view");
        return NULL;
    }
    *v = (noc_view){ .device = device, .scene = scene, .log = device->log, .backend = device->backend };
    noc_history_reset(&v->history);
    noc_scene_lock_read(scene);
    v->world = noc_world_enter(device, scene);
    bool made = v->world && v->backend->view_create(v->world->state, &v->state) == NOC_OK;
    noc_scene_unlock_read(scene);
    if (!made) {
        if (v->world)
            noc_world_leave(device, v->world);
        free(v);
        return NULL;
    }
    v->backend->stats(v->state, &v->stats);
    return v;
}

void noc_view_destroy(noc_view *v) {
    if (!v)
        return;
    v->backend->view_destroy(v->state);
    noc_world_leave(v->device, v->world);
    free(v);
}

noc_device *noc_view_device(const noc_view *v) { return v ? v->device : NULL; }

void noc_view_reset(noc_view *v) {
    if (!v)
        return;
    noc_history_reset(&v->history);
    v->stats.dropped = 0;
    v->stats.frames = 0;
}

void noc_view_restart(noc_view *v) {
    if (v)
        noc_history_forget(&v->history, NOC_RESETS_MEAN);
}

static uint64_t read_number(const char *path) {
    FILE *f = fopen(path, "r");
    unsigned long long n = UINT64_MAX;
    if (!f)
        return UINT64_MAX;
    if (fscanf(f, "%llu", &n) != 1)
        n = UINT64_MAX;
    fclose(f);
    return n;
}

/* Memory of this machine, or of the container it is: the kernel grants more than there is, and kills later. */
static uint64_t machine_memory(void) {
    long pages = sysconf(_SC_PHYS_PAGES), size = sysconf(_SC_PAGESIZE);
    uint64_t bytes = pages > 0 && size > 0 ? (uint64_t)pages * (uint64_t)size : UINT64_MAX;
    bytes = NOC_MIN(bytes, read_number("/sys/fs/cgroup/memory.max"));
    return NOC_MIN(bytes, read_number("/sys/fs/cgroup/memory/memory.limit_in_bytes"));
}

static noc_status fit(noc_view *v, const noc_render_params *p, int sets) {
    if (v->width == p->width && v->height == p->height && v->sets >= sets)
        return NOC_OK;
    uint64_t pixels = ((uint64_t)p->width + 3) * ((uint64_t)p->height + 3);
    uint64_t need = pixels * v->backend->bytes_a_pixel(sets, p->aovs), have = machine_memory();
    double scale = sqrt((double)(have - have / 8) / (double)need);
    if (need > have - have / 8)
        return noc_error(
            v->log, NOC_ERR_MEMORY,
            "render: a picture of %d x %d (%d x %d would fit) needs %.1f GB of memory, this machine has %.1f", p->width,
            p->height, (int)(p->width * scale) & ~3, (int)(p->height * scale) & ~3, (double)need * 1e-9,
            (double)have * 1e-9);
    if (v->width != p->width || v->height != p->height)
        noc_history_forget(&v->history, NOC_RESETS_MEAN | NOC_RESETS_RESERVOIRS);
    noc_status status = v->backend->resize(v->state, p->width, p->height, sets);
    bool there = status == NOC_OK;
    v->width = there ? p->width : 0;
    v->height = there ? p->height : 0;
    v->sets = there ? sets : 0;
    if (!there)
        noc_history_forget(&v->history, NOC_RESETS_MEAN | NOC_RESETS_RESERVOIRS);
    return status;
}

static bool same_place(const frame_camera *a, const frame_camera *b) {
    frame_camera c = *b;
    memcpy(c.jitter, a->jitter, sizeof(c.jitter));
    return !memcmp(a, &c, sizeof(c));
}

static void remember(noc_view *v, const noc_frame *frame) {
    const noc_scene_versions *now = &v->scene->versions, *then = &v->last.seen;
    const frame_constants *c = &frame->constants;
    bool connected = frame->seen_before;
    v->last = (noc_last_frame){
        .number = v->last.number + 1,
        .there = true,
        .motion = frame->params->aovs >> NOC_AOV_MOTION & 1,
        .connected = connected,
        .still = connected && now->commits == then->commits && same_place(&c->camera, &c->previous),
        .isa = frame->params->isa,
        .camera = c->camera,
        .seen = *now,
    };
}

/* What was not read of a device before it was lost is no part of the mean any more. */
static void note_loss(noc_view *v) {
    uint64_t left;
    if (v->backend->lost && v->backend->lost(v->state, &left))
        v->stats.frames = v->history.accumulated = NOC_MIN(v->history.accumulated, left);
}

static void note_times(noc_view *v) {
    v->stats.wall_seconds = noc_wall_seconds() - v->began_wall;
    v->stats.cpu_seconds = noc_cpu_seconds() - v->began_cpu;
}

/* receivers: as in noc_frame. */
static noc_status make_frame(noc_view *v, const noc_camera *camera, const noc_receiver *receivers,
                             const noc_render_params *p, const noc_progress *progress) {
    noc_plan plan;
    noc_frame frame;
    bool map = v->scene->environment != NULL;
    v->last.there = false;
    v->began_wall = noc_wall_seconds();
    v->began_cpu = noc_cpu_seconds();
    noc_plan_make(p, map, -1, false, &plan);
    noc_status status = fit(v, p, plan.sets);
    if (status != NOC_OK)
        return status;
    v->history.surfaces &= !v->scene->lets_through && !receivers; /* each frame meets other surfaces */
    noc_history_begin(&v->history, camera, p, v->scene->versions.commits, &frame);
    frame.receivers = receivers;
    noc_make_frame_environment(v->scene, p, &frame.constants);
    noc_plan_make(p, map, frame.history_set, frame.gbuffer == frame.previous_gbuffer, &plan);
    frame.plan = &plan;
    int stage = 0;
    for (; stage < plan.count && status == NOC_OK; stage++)
        status = v->backend->stage(v->state, &frame, &plan.stages[stage], progress, (double)stage / plan.count,
                                   (double)(stage + 1) / plan.count);
    noc_frame_stats stats = { .dropped = frame.constants.index ? v->stats.dropped : 0 };
    if (status == NOC_OK)
        status = v->backend->accumulate(v->state, &frame);
    if (status == NOC_OK) {
        noc_history_end(&v->history, &frame, plan.next_history);
        remember(v, &frame);
    } else {
        noc_history_drop(&v->history, &frame, stage == 1);
    }
    v->backend->stats(v->state, &stats);
    stats.frames = v->history.accumulated;
    v->stats = stats;
    if (status != NOC_OK)
        note_loss(v);
    note_times(v);
    return status;
}

/* No edit of the scene is published meanwhile. */
static noc_status run_frame(noc_view *v, const noc_camera *camera, const noc_receiver *receivers,
                            const noc_render_params *p, const noc_progress *progress) {
    noc_scene_lock_frame(v->scene);
    noc_status status = make_frame(v, camera, receivers, p, progress);
    noc_scene_unlock_frame(v->scene);
    return status;
}

static noc_status check(noc_view *v, const noc_camera *camera, const noc_render_params *params) {
    noc_status status = noc_render_check(params, v->log);
    return status == NOC_OK ? noc_check_camera(camera, v->log) : status;
}

noc_status noc_view_render(noc_view *v, const noc_camera *camera, const noc_render_params *params,
                           const noc_progress *progress) {
    if (!v || !camera)
        return noc_null(v ? v->log : NULL, __func__);
    const noc_render_params defaults = noc_render_default_params();
    params = params ? params : &defaults;
    noc_status status = check(v, camera, params);
    if (status == NOC_OK)
        status = run_frame(v, camera, NULL, params, progress);
    return status == NOC_ERR_CANCELLED ? noc_cancelled(v->log, "render: cancelled") : status;
}

/* What is matte looks the same from anywhere, so any camera will do. */
noc_status noc_view_receive(noc_view *v, const noc_receiver *receivers, const noc_render_params *params,
                            const noc_progress *progress) {
    const noc_camera above = { .eye = { 0, 0, 1e5 }, .up = { 0, 1, 0 }, .fov_deg = 60 };
    noc_status status = check(v, &above, params);
    status = status ? status : run_frame(v, &above, receivers, params, progress);
    v->history.surfaces = false; /* no camera has seen them */
    return status;
}

noc_image *noc_view_image(noc_view *v) {
    if (!v)
        return NULL;
    if (!v->width || !v->history.accumulated)
        return NULL;
    noc_image *image = noc_image_create(v->width, v->height, v->log);
    if (!image)
        return NULL;
    size_t n = (size_t)image->width * image->height;
    image->emitter = noc_alloc(n);
    image->coverage = noc_alloc_large(n, 4 * sizeof(float));
    uint8_t *wide = noc_alloc(n);
    if (!image->emitter || !image->coverage || !wide) {
        free(wide);
        noc_image_destroy(image);
        noc_error(v->log, NOC_ERR_MEMORY, "render: no memory for the picture's emitter mask");
        return NULL;
    }
    if (v->backend->read(v->state, image) != NOC_OK) {
        note_loss(v);
        free(wide);
        noc_image_destroy(image);
        return NULL;
    }
    /* grown by one pixel, along rows and then along columns */
    for (size_t i = 0; i < n; i++) {
        int x = (int)(i % (size_t)image->width);
        wide[i] =
            image->emitter[i] | (x > 0 && image->emitter[i - 1]) | (x + 1 < image->width && image->emitter[i + 1]);
    }
    size_t row = (size_t)image->width;
    for (size_t i = 0; i < n; i++)
        image->emitter[i] = wide[i] | (i >= row && wide[i - row]) | (i + row < n && wide[i + row]);
    free(wide);
    return image;
}

noc_channel *noc_view_aov(noc_view *v, noc_aov aov) {
    if (!v)
        return NULL;
    if ((unsigned)aov >= NOC_AOV_COUNT) {
        noc_error(v->log, NOC_ERR_ARGUMENT, "render: aov is %d, must be a noc_aov", (int)aov);
        return NULL;
    }
    if (!v->width || !v->history.accumulated)
        return NULL;
    noc_channel *channel = noc_channel_create(v->width, v->height, noc_aov_components(aov), v->log);
    if (!channel)
        return NULL;
    noc_describe_aov(&v->history.params, aov, channel);
    noc_status status = v->backend->aov(v->state, aov, channel->value);
    if (status == NOC_OK)
        return channel;
    note_loss(v);
    noc_channel_destroy(channel);
    if (status == NOC_ERR_ARGUMENT)
        noc_error(v->log, status, "render: the last frame did not keep the view \"%s\": name it in aovs",
                  noc_aov_name(aov));
    return NULL;
}

void noc_view_rows(noc_view *v, const noc_frame_rows *rows) {
    noc_scene_lock_read(v->scene);
    v->backend->rows(v->state, &v->last.camera, rows);
    noc_scene_unlock_read(v->scene);
}

void noc_view_get_stats(noc_view *v, noc_frame_stats *stats) {
    if (!stats)
        return;
    if (v && v->backend->finish && v->backend->finish(v->state)) {
        noc_frame_stats of_last = { .dropped = v->stats.dropped, .frames = v->stats.frames };
        v->backend->stats(v->state, &of_last);
        v->stats = of_last;
        note_loss(v);
        note_times(v);
    }
    *stats = v ? v->stats : (noc_frame_stats){ 0 };
}

void noc_view_light_stats(const noc_view *v, noc_light_stats *stats) {
    if (!stats)
        return;
    *stats = (noc_light_stats){ 0 };
    if (!v)
        return;
    noc_scene_lock_read(v->scene);
    v->backend->light_stats(v->state, stats);
    noc_scene_unlock_read(v->scene);
    if (!v->history.started)
        *stats = (noc_light_stats){ .lights = stats->lights, .scene_bytes = stats->scene_bytes };
}

noc_status noc_view_write_influence(noc_view *v, const noc_render_params *params, const char *path) {
    if (!v || !path)
        return noc_null(v ? v->log : NULL, __func__);
    const noc_render_params defaults = noc_render_default_params();
    const noc_influence *volumes;
    output o;
    params = params ? params : &defaults;
    noc_status status = noc_render_check(params, v->log);
    if (status)
        return status;
    noc_scene_lock_read(v->scene);
    status = v->backend->influence(v->state, params, &volumes);
    bool opened = status == NOC_OK && (status = output_open(&o, path, v->log)) == NOC_OK;
    if (opened)
        noc_influence_write(volumes, v->scene, params->influence, o.file);
    noc_scene_unlock_read(v->scene);
    if (!opened)
        return status;
    return output_close(&o, ferror(o.file) ? output_failed(&o, v->log) : NOC_OK, v->log);
}

noc_status noc_view_trace_floor(noc_view *v, const noc_camera *camera, const noc_render_params *params,
                                const noc_progress *progress, noc_trace_floor *floor) {
    if (!v || !camera || !floor)
        return noc_null(v ? v->log : NULL, __func__);
    const noc_render_params defaults = noc_render_default_params();
    params = params ? params : &defaults;
    noc_status status = check(v, camera, params);
    if (status != NOC_OK)
        return status;
    noc_scene_lock_frame(v->scene); /* until its rays are traced again: the structure stays as it is */
    v->backend->record(v->state, true);
    status = make_frame(v, camera, NULL, params, progress);
    v->backend->record(v->state, false);
    noc_status traced = v->backend->replay(v->state, progress, status == NOC_OK ? floor : NULL);
    noc_scene_unlock_frame(v->scene);
    status = status != NOC_OK ? status : traced;
    return status == NOC_ERR_CANCELLED ? noc_cancelled(v->log, "render: cancelled") : status;
}
