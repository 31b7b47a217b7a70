/* The public renderer: checks, drives a backend through the schedule of a frame, keeps history. */
#include "image/internal.h"
#include "light/influence.h"
#include "render/backend.h"

#include <stdio.h>
#include <unistd.h>

struct noc_renderer {
    const noc_scene *scene;
    noc_log *log;
    const noc_backend *backend;
    void *state;
    noc_history history;
    int width, height, sets; /* of the backend's buffers; 0: none */
    noc_frame_stats stats;
};

static const noc_backend *const backends[] = { &noc_backend_embree };

noc_renderer *noc_renderer_create(const noc_scene *scene, const noc_renderer_params *params, noc_log *log) {
    noc_renderer_params defaults = noc_renderer_default_params();
    params = params ? params : &defaults;
    if (!scene || !scene->committed) {
        noc_error(log, NOC_ERR_ARGUMENT, "renderer: the scene is not committed");
        return NULL;
    }
    if (params->threads < 0 || params->threads > 1024) {
        noc_error(log, NOC_ERR_ARGUMENT, "renderer: threads is %d, must be in 0..1024", params->threads);
        return NULL;
    }
    const char *name = params->backend ? params->backend : backends[0]->name;
    const noc_backend *backend = NULL;
    for (size_t i = 0; i < NOC_COUNT(backends); i++)
        if (noc_ieq(name, backends[i]->name))
            backend = backends[i];
    if (!backend) {
        noc_error(log, NOC_ERR_UNSUPPORTED, "renderer: no backend \"%s\" in this build (there is: embree)", name);
        return NULL;
    }
    noc_renderer *r = noc_alloc(sizeof(*r));
    if (!r) {
        noc_no_memory(log, "renderer");
        return NULL;
    }
    *r = (noc_renderer){ .scene = scene, .log = log, .backend = backend };
    noc_history_reset(&r->history);
    if (backend->create(scene, params, log, &r->state) != NOC_OK) {
        free(r);
        return NULL;
    }
    backend->stats(r->state, &r->stats);
    return r;
}

void noc_renderer_destroy(noc_renderer *r) {
    if (!r)
        return;
    r->backend->destroy(r->state);
    free(r);
}

void noc_renderer_reset(noc_renderer *r) {
    if (!r)
        return;
    noc_history_reset(&r->history);
    r->stats.dropped = 0;
    r->stats.frames = 0;
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

static noc_status fit(noc_renderer *r, const noc_render_params *p, int sets) {
    if (r->width == p->width && r->height == p->height && r->sets >= sets)
        return NOC_OK;
    uint64_t pixels = ((uint64_t)p->width + 3) * ((uint64_t)p->height + 3);
    uint64_t need = pixels * r->backend->bytes_a_pixel(sets, p->aovs), have = machine_memory();
    if (need > have - have / 8)
        return noc_error(r->log, NOC_ERR_MEMORY,
                         "render: a picture of %d x %d needs %.1f GB of memory, this machine has %.1f", p->width,
                         p->height, (double)need * 1e-9, (double)have * 1e-9);
    noc_history_reset(&r->history);
    r->width = r->height = r->sets = 0;
    noc_status status = r->backend->resize(r->state, p->width, p->height, sets);
    if (status == NOC_OK) {
        r->width = p->width;
        r->height = p->height;
        r->sets = sets;
    }
    return status;
}

static noc_status run_frame(noc_renderer *r, const noc_camera *camera, const noc_render_params *p,
                            const noc_progress *progress) {
    noc_schedule schedule;
    noc_frame frame;
    double wall = noc_wall_seconds(), cpu = noc_cpu_seconds();
    noc_make_schedule(p, -1, &schedule);
    noc_status status = fit(r, p, schedule.sets);
    if (status != NOC_OK)
        return status;
    noc_history_begin(&r->history, camera, p, r->scene->moves, &frame);
    noc_make_schedule(p, frame.history_set, &schedule);
    int stage = 0;
    for (; stage < schedule.count && status == NOC_OK; stage++)
        status = r->backend->stage(r->state, &frame, &schedule.stages[stage], progress, (double)stage / schedule.count,
                                   (double)(stage + 1) / schedule.count);
    noc_frame_stats stats = { .dropped = frame.index ? r->stats.dropped : 0 };
    if (status == NOC_OK)
        status = r->backend->accumulate(r->state, &frame);
    if (status == NOC_OK)
        noc_history_end(&r->history, &frame, schedule.next_history);
    else
        noc_history_drop(&r->history, &frame, stage == 1);
    r->backend->stats(r->state, &stats);
    stats.frames = r->history.accumulated;
    stats.wall_seconds = noc_wall_seconds() - wall;
    stats.cpu_seconds = noc_cpu_seconds() - cpu;
    r->stats = stats;
    return status;
}

static noc_status check(noc_renderer *r, const noc_camera *camera, const noc_render_params *params) {
    noc_status status = noc_render_check(params, r->log);
    return status == NOC_OK ? noc_check_camera(camera, r->log) : status;
}

noc_status noc_renderer_frame(noc_renderer *r, const noc_camera *camera, const noc_render_params *params,
                              const noc_progress *progress) {
    if (!r || !camera)
        return noc_null(r ? r->log : NULL, __func__);
    const noc_render_params defaults = noc_render_default_params();
    params = params ? params : &defaults;
    noc_status status = check(r, camera, params);
    if (status == NOC_OK)
        status = run_frame(r, camera, params, progress);
    return status == NOC_ERR_CANCELLED ? noc_cancelled(r->log, "render: cancelled") : status;
}

noc_image *noc_renderer_image(noc_renderer *r) {
    if (!r)
        return NULL;
    if (!r->width || !r->history.accumulated)
        return NULL;
    noc_image *image = noc_image_create(r->width, r->height, r->log);
    if (!image)
        return NULL;
    size_t n = (size_t)image->width * image->height;
    image->emitter = noc_alloc(n);
    image->coverage = noc_alloc_large(n, 4 * sizeof(float));
    uint8_t *wide = noc_alloc(n);
    if (!image->emitter || !image->coverage || !wide) {
        free(wide);
        noc_image_destroy(image);
        noc_error(r->log, NOC_ERR_MEMORY, "render: no memory for the picture's emitter mask");
        return NULL;
    }
    r->backend->read(r->state, image);
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

noc_channel *noc_renderer_aov(noc_renderer *r, noc_aov aov) {
    if (!r)
        return NULL;
    if ((unsigned)aov >= NOC_AOV_COUNT) {
        noc_error(r->log, NOC_ERR_ARGUMENT, "render: aov is %d, must be a noc_aov", (int)aov);
        return NULL;
    }
    if (!r->width || !r->history.accumulated)
        return NULL;
    noc_channel *channel = noc_channel_create(r->width, r->height, aov == NOC_AOV_NORMAL ? 3 : 1, r->log);
    if (!channel)
        return NULL;
    noc_describe_aov(&r->history.params, aov, channel);
    if (r->backend->aov(r->state, aov, channel->value))
        return channel;
    noc_channel_destroy(channel);
    noc_error(r->log, NOC_ERR_ARGUMENT, "render: the last frame did not keep the view \"%s\": name it in aovs",
              noc_aov_name(aov));
    return NULL;
}

const char *noc_pass_name(noc_pass pass) {
    static const char *const names[NOC_PASS_COUNT] = {
        [NOC_PASS_PRIMARY] = "primary",   [NOC_PASS_CANDIDATES] = "candidates", [NOC_PASS_VISIBILITY] = "visibility",
        [NOC_PASS_TEMPORAL] = "temporal", [NOC_PASS_SPATIAL] = "spatial",       [NOC_PASS_SHADE] = "shade",
        [NOC_PASS_SKY] = "sky",
    };
    return (unsigned)pass < NOC_PASS_COUNT ? names[pass] : "unknown";
}

void noc_renderer_get_stats(const noc_renderer *r, noc_frame_stats *stats) {
    if (stats)
        *stats = r ? r->stats : (noc_frame_stats){ 0 };
}

void noc_renderer_light_stats(const noc_renderer *r, noc_light_stats *stats) {
    if (!stats)
        return;
    *stats = (noc_light_stats){ 0 };
    if (r)
        r->backend->light_stats(r->state, r->history.started ? &r->history.params : NULL, stats);
}

noc_status noc_renderer_write_influence(noc_renderer *r, const noc_render_params *params, const char *path) {
    if (!r || !path)
        return noc_null(r ? r->log : NULL, __func__);
    const noc_render_params defaults = noc_render_default_params();
    const noc_influence *volumes;
    output o;
    params = params ? params : &defaults;
    noc_status status = noc_render_check(params, r->log);
    status = status ? status : r->backend->influence(r->state, params, &volumes);
    status = status ? status : output_open(&o, path, r->log);
    if (status)
        return status;
    noc_influence_write(volumes, r->scene, params->influence, o.file);
    return output_close(&o, ferror(o.file) ? output_failed(&o, r->log) : NOC_OK, r->log);
}

noc_status noc_renderer_trace_floor(noc_renderer *r, const noc_camera *camera, const noc_render_params *params,
                                    double *seconds) {
    if (!r || !camera || !seconds)
        return noc_null(r ? r->log : NULL, __func__);
    const noc_render_params defaults = noc_render_default_params();
    params = params ? params : &defaults;
    noc_status status = check(r, camera, params);
    if (status != NOC_OK)
        return status;
    r->backend->record(r->state, true);
    status = run_frame(r, camera, params, NULL);
    r->backend->record(r->state, false);
    noc_status traced = r->backend->replay(r->state, seconds);
    return status != NOC_OK ? status : traced;
}
