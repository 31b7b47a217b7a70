/* One configuration over its frames against the reference. */
#include "experiment.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct measuring {
    experiment_lab *lab;
    experiment_run *run;
    int frame, frames;
    double *sum; /* of all frames so far */
} measuring;

char *experiment_picture(const experiment_lab *lab, const experiment_run *run) {
    return cli_format("%s/pictures/%s.exr", lab->folder, run->key);
}

static bool frame_progress(void *user, const char *what, double done) {
    const measuring *m = user;
    const experiment_lab *lab = m->lab;
    double made = (double)(lab->rows_done - lab->rows_old), left = (double)(lab->rows_total - lab->rows_done);
    double spent = cli_now() - lab->started;
    cli_progress_show((double)lab->rows_done / (double)lab->rows_total, made > 0 && spent > 2 ? spent / made * left : -1,
                      "%s, frame %d of %d", lab->spec.configs[m->run->config].name, m->frame, m->frames);
    return !cli_interrupted();
}

static void keep_figures(double *values, const noc_metrics *raw, const noc_metrics *clamped) {
    values[0] = raw->rmse8;
    values[1] = raw->relmse;
    values[2] = clamped->relmse;
    values[3] = raw->bias;
}

/* Figures of one picture, and the row they make. Times of a frame whose other row is there already are that row's. */
static int add_row(measuring *m, int mode, const noc_image *image, const noc_frame_stats *stats) {
    experiment_lab *lab = m->lab;
    experiment_row *rows = m->run->rows[mode], *row = &rows[m->frame - 1];
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
    v[COL_WALL_TOTAL] = v[COL_WALL] + (m->frame > 1 ? row[-1].values[COL_WALL_TOTAL] : 0);
    v[COL_CPU_TOTAL] = v[COL_CPU] + (m->frame > 1 ? row[-1].values[COL_CPU_TOTAL] : 0);
    keep_figures(v + COL_RMSE8, &figures.dark, &figures.dark_clamped);
    keep_figures(v + COL_RMSE8_ALL, &figures.all, &figures.all_clamped);
    v[COL_BUILD] = stats->build_seconds;
    v[COL_MEMORY] = (double)stats->memory_bytes;
    v[COL_RAYS] = (double)stats->rays_shadow;
    v[COL_DROPPED] = (double)stats->dropped;
    row->done = true;
    lab->rows_done++;
    return experiment_append(lab, m->run, mode, m->frame);
}

/* The image becomes the mean of the frames so far. */
static void average(measuring *m, noc_image *image) {
    size_t n = (size_t)image->width * (size_t)image->height * 3;
    for (size_t i = 0; i < n; i++) {
        m->sum[i] += image->rgb[i];
        image->rgb[i] = (float)(m->sum[i] / m->frame);
    }
}

static int keep_first(const measuring *m, const noc_image *image) {
    char *path = experiment_picture(m->lab, m->run);
    noc_display_params display = noc_display_default_params();
    const char *keys[] = { "configuration" }, *values[] = { m->lab->spec.configs[m->run->config].name };
    noc_status status = noc_image_write(image, path, &display, &(noc_image_meta){ 1, keys, values }, m->lab->log);
    free(path);
    return status ? CLI_FAILURE : CLI_OK;
}

static int take_frame(measuring *m, noc_renderer *renderer) {
    noc_frame_stats stats;
    noc_renderer_get_stats(renderer, &stats);
    snprintf(m->lab->path, sizeof(m->lab->path), "%s", stats.path ? stats.path : "");
    noc_image *image = noc_renderer_image(renderer);
    if (!image)
        return CLI_FAILURE;
    int status = m->frame == 1 && !m->run->repetition ? keep_first(m, image) : CLI_OK;
    if (!status && m->run->rows[EXPERIMENT_ALONE])
        status = add_row(m, EXPERIMENT_ALONE, image, &stats);
    if (!status && m->run->rows[EXPERIMENT_ACCUMULATED]) {
        average(m, image);
        status = add_row(m, EXPERIMENT_ACCUMULATED, image, &stats);
    }
    noc_image_destroy(image);
    return status;
}

/* Frames that must be rendered: up to the last row that misses. Earlier ones are made again without new rows, because a
 * frame needs those before it. */
static int frames_missing(const experiment_lab *lab, const experiment_run *run) {
    int last = 0;
    for (int mode = 0; mode < EXPERIMENT_MODES; mode++)
        for (int i = 0; run->rows[mode] && i < lab->spec.configs[run->config].frames; i++)
            if (!run->rows[mode][i].done && i + 1 > last)
                last = i + 1;
    char *picture = experiment_picture(lab, run);
    if (!last && !run->repetition && access(picture, R_OK))
        last = 1;
    free(picture);
    return last;
}

int experiment_measure(experiment_lab *lab, experiment_run *run) {
    measuring m = { lab, run, 1, frames_missing(lab, run), NULL };
    if (!m.frames)
        return CLI_OK;
    noc_renderer *renderer = noc_renderer_create(lab->scene, &(noc_renderer_params){ .threads = lab->args->threads }, lab->log);
    int status = renderer ? CLI_OK : CLI_FAILURE;
    m.sum = cli_alloc(sizeof(double) * 3 * (size_t)lab->spec.width * (size_t)lab->spec.height);
    noc_render_params params = experiment_params(lab, run);
    for (; !status && m.frame <= m.frames; m.frame++) {
        noc_status rendered = cli_interrupted() ? NOC_ERR_CANCELLED
            : noc_renderer_frame(renderer, &lab->camera, &params, &(noc_progress){ frame_progress, &m });
        if (rendered)
            status = cli_interrupted() ? CLI_INTERRUPTED + cli_interrupted() : CLI_FAILURE;
        else
            status = take_frame(&m, renderer);
    }
    free(m.sum);
    noc_renderer_destroy(renderer);
    return status;
}
