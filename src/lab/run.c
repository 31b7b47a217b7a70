/* One configuration over its frames against the reference. */
#include "lab/run.h"
#include "lab/measure.h"
#include "lab/motion.h"
#include "lab/table.h"

#include <math.h>
#include <unistd.h>

typedef struct measuring {
    lab_session *lab;
    lab_run *run;
    int frames;       /* at most */
    double cpu, wall; /* seconds of all frames so far; where a row of an earlier session tells them, as told there */
    /* of the present frame */
    bool rows; /* it is measured */
    noc_frame_stats stats;
    noc_light_stats lights;
} measuring;

static bool frame_progress(void *user, int frame, double done) {
    const measuring *m = user;
    lab_session *lab = m->lab;
    const lab_config *config = &lab->spec->configs[m->run->config];
    double share = config->seconds > 0 ? m->cpu / config->seconds : (frame - 1 + done) / m->frames;
    share = ((double)lab->runs_done + share) / (double)lab->runs_mine;
    double spent = noc_wall_seconds() - lab->started - lab->reference_seconds, left = spent / share - spent;
    if (lab->references_made) /* those to come, as if none were there */
        left += lab->reference_seconds / (double)lab->references_made *
                (double)(lab->spec->camera_count - lab->cameras_done - 1);
    /* What earlier sessions made passes in no time, so time left is told where there was nothing. */
    left = !lab->rows_old && spent > 2 ? left : -1;
    return lab_go_on(lab, &(noc_lab_progress){ NOC_LAB_MEASURING, share, left, config->name, frame, m->frames });
}

static void keep_figures(double *values, const noc_metrics *raw, const noc_metrics *clamped) {
    values[0] = raw->rmse8;
    values[1] = raw->relmse;
    values[2] = clamped->relmse;
    values[3] = raw->bias;
    values[4] = (double)raw->unlit;
    values[5] = raw->relmse_unlit;
}

/* Figures of one picture, and the row they make. */
static noc_status add_row(const measuring *m, int mode, int frame, const noc_image *image) {
    lab_session *lab = m->lab;
    const noc_frame_stats *stats = &m->stats;
    const noc_light_stats *lights = &m->lights;
    if (!lab_has_mode(lab->spec, m->run->camera, mode))
        return NOC_OK;
    lab_row *row = lab_row_of(lab, m->run, mode, frame);
    if (!row || row->done)
        return row ? NOC_OK : NOC_ERR_MEMORY;
    noc_compare_params params = noc_compare_default_params();
    params.ceiling = lab->spec->ceiling;
    noc_comparison figures;
    noc_status status = noc_image_compare(image, lab->reference, &params, &figures, lab->log);
    if (status)
        return status;
    double *v = row->values;
    v[COL_WALL] = stats->wall_seconds;
    v[COL_CPU] = stats->cpu_seconds;
    v[COL_WALL_TOTAL] = m->wall;
    v[COL_CPU_TOTAL] = m->cpu;
    keep_figures(v + COL_RMSE8, &figures.dark, &figures.dark_clamped);
    keep_figures(v + COL_RMSE8_ALL, &figures.all, &figures.all_clamped);
    v[COL_BUILD] = stats->build_seconds;
    v[COL_MEMORY] = (double)stats->memory_bytes;
    v[COL_RAYS] = (double)stats->rays_shadow;
    v[COL_DROPPED] = (double)stats->dropped;
    v[COL_LIGHT_BUILD] = lights->build_seconds;
    v[COL_VOLUMES] = lights->volumes_seconds;
    v[COL_TUNING] = lights->tuning_seconds;
    v[COL_HIERARCHY] = lights->hierarchy_seconds;
    v[COL_BOXES] = lights->boxes_seconds;
    v[COL_LIGHT_BYTES] = (double)lights->bytes;
    v[COL_SCENE_BYTES] = (double)lights->scene_bytes;
    v[COL_INFLUENCE] = lights->influence;
    bool nobody = lights->influence > 0 && !lights->surfaces; /* no pixel saw a surface, and asked for lights */
    v[COL_FOUND_NONE] = nobody ? NAN : lights->found_none;
    v[COL_FOUND_MEDIAN] = nobody ? NAN : lights->found_median;
    v[COL_FOUND_99] = nobody ? NAN : lights->found_99;
    row->done = true;
    row->reference = lab_backend_of(lab->truths[m->run->camera].device);
    lab->rows_done++;
    return lab_append(lab, m->run, mode, frame);
}

static noc_status keep_picture(const measuring *m, int mode, int frame, const noc_image *image) {
    const lab_spec *spec = m->lab->spec;
    if (m->run->repetition || mode != lab_shown_mode(spec, m->run->camera) || !lab_shows(spec, m->run->camera, frame))
        return NOC_OK;
    char *path = lab_picture_path(m->lab, m->run->key, mode, frame);
    if (!path)
        return NOC_ERR_MEMORY;
    noc_display_params display = noc_display_default_params();
    const noc_device_info *device = &m->lab->device;
    const char *keys[] = { "configuration", "backend", "device" };
    const char *values[] = { spec->configs[m->run->config].name, noc_backend_name(device->backend), device->name };
    noc_status status = noc_image_write(image, path, &display, &(noc_image_meta){ 3, keys, values }, m->lab->log);
    free(path);
    return status;
}

/* The light that each pixel's reservoir holds, in the light's colour: of frames that are shown. */
static noc_status keep_light(void *user, int frame, noc_view *view) {
    const measuring *m = user;
    const lab_session *lab = m->lab;
    if (m->run->repetition || !lab_shows(lab->spec, m->run->camera, frame))
        return NOC_OK;
    const noc_channel_params params = { .part = NOC_CHANNEL_PICTURE };
    const char *keys[] = { "configuration" }, *values[] = { lab->spec->configs[m->run->config].name };
    uint8_t *rgb = NULL;
    int width, height;
    char *path = lab_light_path(lab, m->run->key, frame);
    noc_channel *light = path ? noc_view_aov(view, NOC_AOV_LIGHT) : NULL;
    noc_status status = light ? noc_channel_to_srgb8(light, &params, &rgb, &width, &height, lab->log) : NOC_ERR_MEMORY;
    if (!status)
        status = noc_image_write_srgb8(rgb, width, height, path, &(noc_image_meta){ 1, keys, values }, lab->log);
    noc_channel_destroy(light);
    free(rgb);
    free(path);
    return status;
}

/* Time so far. A row that is there already tells it better: those after it were measured on from there. */
static void add_times(measuring *m, int frame, const noc_frame_stats *stats) {
    m->cpu += stats->cpu_seconds;
    m->wall += stats->wall_seconds;
    for (int mode = 0; mode < LAB_MODES && frame <= m->run->count; mode++) {
        const lab_row *row = &m->run->rows[mode][frame - 1];
        if (!row->done)
            continue;
        m->cpu = row->values[COL_CPU_TOTAL];
        m->wall = row->values[COL_WALL_TOTAL];
    }
}

static bool is_measured(const lab_session *lab, const lab_run *run, int frame) {
    return lab_measures(lab->spec, run->camera, run->config, frame);
}

/* Is any row there of this frame? */
static bool has_row(const lab_run *run, int frame) {
    return frame <= run->count && (run->rows[LAB_ALONE][frame - 1].done || run->rows[LAB_ACCUMULATED][frame - 1].done);
}

/* One frame is there: is it one of those that are measured or shown, and is it the last? */
static bool rendered(void *user, int frame, const noc_frame_stats *stats, const noc_light_stats *lights, bool *last) {
    measuring *m = user;
    lab_session *lab = m->lab;
    m->stats = *stats;
    m->lights = *lights;
    add_times(m, frame, stats);
    double seconds = lab->spec->configs[m->run->config].seconds;
    bool spent =
        seconds > 0 && m->cpu >= seconds && frame >= m->run->count && !lab->spec->cameras[m->run->camera].frames;
    *last = spent || frame == m->frames;
    noc_snprintf(lab->path, sizeof(lab->path), "%s", stats->path ? stats->path : "");
    m->rows = is_measured(lab, m->run, frame) || spent || has_row(m->run, frame);
    return m->rows || lab_shows(lab->spec, m->run->camera, frame);
}

/* Its row, and its picture. */
static noc_status take(void *user, int frame, bool mean, const noc_image *image) {
    const measuring *m = user;
    int mode = mean ? LAB_ACCUMULATED : LAB_ALONE;
    noc_status status = keep_picture(m, mode, frame, image);
    return status || !m->rows ? status : add_row(m, mode, frame, image);
}

static noc_status prepare(void *user, int frame, noc_camera *camera) {
    const measuring *m = user;
    *camera = lab_camera_at(m->lab, m->run->camera, frame);
    return lab_place_cars(m->lab, m->run->camera, frame);
}

/* The last frame whose row misses; 0: none. */
static int row_missing(const lab_session *lab, const lab_run *run) {
    double seconds = lab->spec->configs[run->config].seconds;
    int frames = lab_frames(lab->spec, run->camera, run->config), last = 0;
    for (int frame = 1; frame <= frames; frame++) {
        bool there = has_row(run, frame);
        for (int mode = 0; mode < LAB_MODES && (there || is_measured(lab, run, frame)); mode++)
            if (lab_has_mode(lab->spec, run->camera, mode) && !(there && run->rows[mode][frame - 1].done))
                last = frame;
        if (!(seconds > 0) || lab->spec->cameras[run->camera].frames)
            continue;
        if (!last && there &&
            run->rows[lab_shown_mode(lab->spec, run->camera)][frame - 1].values[COL_CPU_TOTAL] >= seconds)
            return 0;
        if (last)
            return frames; /* time decides which is the last */
    }
    return last;
}

/* Frames that must be rendered: up to the last whose row or picture misses. Earlier ones are made again without new
 * rows, because a frame needs those before it. */
static noc_status frames_missing(const lab_session *lab, const lab_run *run, int *last) {
    const lab_spec *spec = lab->spec;
    int mode = lab_shown_mode(spec, run->camera);
    int frames = spec->configs[run->config].seconds > 0 ? run->count : lab_frames(spec, run->camera, run->config);
    *last = row_missing(lab, run);
    for (int frame = *last + 1; !run->repetition && frame <= frames; frame++) {
        if (!lab_shows(spec, run->camera, frame))
            continue;
        char *picture = lab_picture_path(lab, run->key, mode, frame);
        char *light = spec->light_view && picture ? lab_light_path(lab, run->key, frame) : NULL;
        if (!picture || (spec->light_view && !light)) {
            free(picture);
            return NOC_ERR_MEMORY;
        }
        if (access(picture, R_OK) || (light && access(light, R_OK)))
            *last = frame;
        free(light);
        free(picture);
    }
    return NOC_OK;
}

noc_status lab_run_misses(const lab_session *lab, const lab_run *run, bool *misses) {
    int last = 0;
    noc_status status = frames_missing(lab, run, &last);
    *misses = *misses || last;
    return status;
}

noc_status lab_measure_run(lab_session *lab, lab_run *run) {
    measuring m = { .lab = lab, .run = run };
    noc_status status = frames_missing(lab, run, &m.frames);
    if (status || !m.frames)
        return status;
    noc_device *device = noc_device_create(&lab->params.device, lab->log);
    if (!device)
        return NOC_ERR_MEMORY;
    bool mean = lab_has_mode(lab->spec, run->camera, LAB_ACCUMULATED);
    status = lab_run_loop(&(lab_loop){ .device = device,
                                       .scene = lab->scene,
                                       .params = lab_params_of(lab, run),
                                       .sum = mean ? lab->sum : NULL,
                                       .log = lab->log,
                                       .user = &m,
                                       .prepare = prepare,
                                       .progress = frame_progress,
                                       .rendered = rendered,
                                       .seen = lab->spec->light_view ? keep_light : NULL,
                                       .take = take });
    noc_device_destroy(device);
    return status;
}
