/* One configuration over its frames against the reference. */
#include "lab/lab.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct measuring {
    lab_session *lab;
    lab_run *run;
    int frame, frames; /* frames: at most */
    double cpu, wall;  /* seconds of all frames so far; where a row of an earlier session tells them, as told there */
} measuring;

int lab_shown_mode(const lab_spec *spec, size_t camera) {
    return !spec->cameras[camera].frames && spec->accumulate == LAB_ACCUMULATED ? LAB_ACCUMULATED : LAB_ALONE;
}

char *lab_picture(const lab_session *lab, const char *key, int mode, int frame) {
    return cli_format("%s/pictures/%s-%s%d.exr", lab->folder, key, mode == LAB_ACCUMULATED ? "mean" : "frame", frame);
}

static bool frame_progress(void *user, const char *what, double done) {
    const measuring *m = user;
    const lab_session *lab = m->lab;
    const lab_config *config = &lab->spec.configs[m->run->config];
    double share = config->seconds > 0 ? m->cpu / config->seconds : (m->frame - 1 + done) / m->frames;
    share = ((double)lab->runs_done + share) / (double)lab->run_count;
    double spent = cli_now() - lab->started - lab->reference_seconds, left = spent / share - spent;
    if (lab->references_made) /* those to come, as if none were there */
        left += lab->reference_seconds / (double)lab->references_made *
                (double)(lab->spec.camera_count - lab->cameras_done - 1);
    /* What earlier sessions made passes in no time, so time left is told where there was nothing. */
    cli_progress_show(share, !lab->rows_old && spent > 2 ? left : -1, "%s, frame %d", config->name, m->frame);
    return !cli_interrupted();
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
static int add_row(const measuring *m, int mode, const noc_image *image, const noc_frame_stats *stats,
                   const noc_light_stats *lights) {
    lab_session *lab = m->lab;
    if (!lab_has_mode(&lab->spec, m->run->camera, mode))
        return CLI_OK;
    lab_row *row = lab_row_of(m->run, mode, m->frame);
    if (row->done)
        return CLI_OK;
    noc_compare_params params = noc_compare_default_params();
    params.ceiling = lab->spec.ceiling;
    noc_comparison figures;
    if (noc_image_compare(image, lab->reference, &params, &figures, lab->log))
        return CLI_FAILURE;
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
    lab->rows_done++;
    return lab_append(lab, m->run, mode, m->frame);
}

/* The image becomes the mean of the frames so far. */
static void average(const measuring *m, noc_image *image) {
    size_t n = (size_t)image->width * (size_t)image->height * 3;
    double *sum = m->lab->sum;
    for (size_t i = 0; i < n; i++) {
        sum[i] = m->frame > 1 ? sum[i] + image->rgb[i] : image->rgb[i];
        image->rgb[i] = (float)(sum[i] / m->frame);
    }
}

static int keep_picture(const measuring *m, int mode, const noc_image *image) {
    const lab_spec *spec = &m->lab->spec;
    if (m->run->repetition || mode != lab_shown_mode(spec, m->run->camera) ||
        !lab_shows(spec, m->run->camera, m->frame))
        return CLI_OK;
    char *path = lab_picture(m->lab, m->run->key, mode, m->frame);
    noc_display_params display = noc_display_default_params();
    const char *keys[] = { "configuration" }, *values[] = { spec->configs[m->run->config].name };
    noc_status status = noc_image_write(image, path, &display, &(noc_image_meta){ 1, keys, values }, m->lab->log);
    free(path);
    return status ? CLI_FAILURE : CLI_OK;
}

/* Time so far. A row that is there already tells it better: those after it were measured on from there. */
static void add_times(measuring *m, const noc_frame_stats *stats) {
    m->cpu += stats->cpu_seconds;
    m->wall += stats->wall_seconds;
    for (int mode = 0; mode < LAB_MODES && m->frame <= m->run->count; mode++) {
        const lab_row *row = &m->run->rows[mode][m->frame - 1];
        if (!row->done)
            continue;
        m->cpu = row->values[COL_CPU_TOTAL];
        m->wall = row->values[COL_WALL_TOTAL];
    }
}

static bool is_measured(const lab_session *lab, const lab_run *run, int frame) {
    return lab_measures(&lab->spec, run->camera, run->config, frame);
}

/* Is any row there of this frame? */
static bool has_row(const lab_run *run, int frame) {
    return frame <= run->count && (run->rows[LAB_ALONE][frame - 1].done || run->rows[LAB_ACCUMULATED][frame - 1].done);
}

/* One frame is there: its rows and picture, if it is one of those that are measured, or the last. */
static int take_frame(measuring *m, noc_view *view, bool *last) {
    lab_session *lab = m->lab;
    noc_frame_stats stats;
    noc_light_stats lights;
    noc_view_get_stats(view, &stats);
    noc_view_light_stats(view, &lights);
    add_times(m, &stats);
    double seconds = lab->spec.configs[m->run->config].seconds;
    bool spent =
        seconds > 0 && m->cpu >= seconds && m->frame >= m->run->count && !lab->spec.cameras[m->run->camera].frames;
    *last = spent || m->frame == m->frames;
    snprintf(lab->path, sizeof(lab->path), "%s", stats.path ? stats.path : "");
    bool rows = is_measured(lab, m->run, m->frame) || spent || has_row(m->run, m->frame);
    bool mean = lab_has_mode(&lab->spec, m->run->camera, LAB_ACCUMULATED);
    if (!rows && !mean && !lab_shows(&lab->spec, m->run->camera, m->frame))
        return CLI_OK;
    noc_image *image = noc_view_image(view);
    int status = image ? keep_picture(m, LAB_ALONE, image) : CLI_FAILURE;
    if (!status && rows)
        status = add_row(m, LAB_ALONE, image, &stats, &lights);
    if (!status && mean) {
        average(m, image);
        status = rows ? add_row(m, LAB_ACCUMULATED, image, &stats, &lights) : CLI_OK;
        status = status ? status : keep_picture(m, LAB_ACCUMULATED, image);
    }
    noc_image_destroy(image);
    return status;
}

/* The last frame whose row misses; 0: none. */
static int row_missing(const lab_session *lab, const lab_run *run) {
    double seconds = lab->spec.configs[run->config].seconds;
    int frames = lab_frames(&lab->spec, run->camera, run->config), last = 0;
    for (int frame = 1; frame <= frames; frame++) {
        bool there = has_row(run, frame);
        for (int mode = 0; mode < LAB_MODES && (there || is_measured(lab, run, frame)); mode++)
            if (lab_has_mode(&lab->spec, run->camera, mode) && !(there && run->rows[mode][frame - 1].done))
                last = frame;
        if (!(seconds > 0) || lab->spec.cameras[run->camera].frames)
            continue;
        if (!last && there &&
            run->rows[lab_shown_mode(&lab->spec, run->camera)][frame - 1].values[COL_CPU_TOTAL] >= seconds)
            return 0;
        if (last)
            return frames; /* time decides which is the last */
    }
    return last;
}

/* Frames that must be rendered: up to the last whose row or picture misses. Earlier ones are made again without new
 * rows, because a frame needs those before it. */
static int frames_missing(const lab_session *lab, const lab_run *run) {
    const lab_spec *spec = &lab->spec;
    int last = row_missing(lab, run), mode = lab_shown_mode(spec, run->camera);
    int frames = spec->configs[run->config].seconds > 0 ? run->count : lab_frames(spec, run->camera, run->config);
    for (int frame = last + 1; !run->repetition && frame <= frames; frame++) {
        char *picture = lab_shows(spec, run->camera, frame) ? lab_picture(lab, run->key, mode, frame) : NULL;
        if (picture && access(picture, R_OK))
            last = frame;
        free(picture);
    }
    return last;
}

int lab_measure(lab_session *lab, lab_run *run) {
    measuring m = { .lab = lab, .run = run, .frame = 1, .frames = frames_missing(lab, run) };
    if (!m.frames)
        return CLI_OK;
    noc_device *device = noc_device_create(&(noc_device_params){ .threads = lab->args->threads }, lab->log);
    noc_view *view = noc_view_create(device, lab->scene);
    int status = view ? CLI_OK : CLI_FAILURE;
    noc_render_params params = lab_params(lab, run);
    for (bool last = false; !status && !last; m.frame++) {
        noc_camera camera = lab_camera_at(lab, run->camera, m.frame);
        noc_status rendered = cli_interrupted()
                                  ? NOC_ERR_CANCELLED
                                  : noc_view_render(view, &camera, &params, &(noc_progress){ frame_progress, &m });
        if (rendered)
            status = cli_interrupted() ? CLI_INTERRUPTED + cli_interrupted() : CLI_FAILURE;
        else
            status = take_frame(&m, view, &last);
    }
    noc_view_destroy(view);
    noc_device_destroy(device);
    return status;
}
