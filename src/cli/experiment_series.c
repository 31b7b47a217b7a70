/* Curves of an experiment: means over its repetitions, and times between frames by interpolation. */
#include "experiment.h"

#include <math.h>
#include <stdlib.h>

experiment_run *experiment_find_run(const experiment_lab *lab, size_t scene, size_t camera, size_t config, int repetition) {
    const experiment_spec *spec = &lab->spec;
    return &lab->runs[((scene * spec->camera_count + camera) * (size_t)spec->repetitions + (size_t)repetition) * spec->config_count + config];
}

double experiment_at(const experiment_series *s, int column, int frame) {
    double sum = 0;
    const experiment_spec *spec = &s->lab->spec;
    if (frame < 1 || frame > spec->configs[s->config].frames)
        return NAN;
    for (int i = 0; i < spec->repetitions; i++) {
        const experiment_row *rows = experiment_find_run(s->lab, s->scene, s->camera, s->config, i)->rows[s->mode];
        if (!rows || !rows[frame - 1].done)
            return NAN;
        sum += rows[frame - 1].values[column];
    }
    return sum / spec->repetitions;
}

int experiment_column(const experiment_spec *spec) {
    int first = spec->all_pixels ? COL_RMSE8_ALL : COL_RMSE8;
    return first + (spec->figure == EXPERIMENT_RMSE8 ? 0 : spec->figure == EXPERIMENT_RELMSE ? 1 : 2);
}

const char *experiment_figure(const experiment_spec *spec) {
    static char text[120];
    const char *pixels = spec->all_pixels ? "all pixels" : "pixels that see no emitter";
    if (spec->figure == EXPERIMENT_CLAMPED)
        snprintf(text, sizeof(text), "relMSE clamped to %g cd/m\302\262, %s", spec->ceiling, pixels);
    else
        snprintf(text, sizeof(text), "%s, %s", spec->figure == EXPERIMENT_RELMSE ? "relMSE" : "RMSE-8 (0 to 255)", pixels);
    return text;
}

static int by_size(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

double experiment_median(const experiment_series *s, int column) {
    const experiment_spec *spec = &s->lab->spec;
    int frames = spec->configs[s->config].frames, first = frames > 1;
    size_t count = 0;
    double *values = cli_alloc(sizeof(double) * (size_t)frames * (size_t)spec->repetitions), median = NAN;
    for (int i = 0; i < spec->repetitions; i++) {
        const experiment_row *rows = experiment_find_run(s->lab, s->scene, s->camera, s->config, i)->rows[s->mode];
        for (int f = first; rows && f < frames; f++)
            if (rows[f].done)
                values[count++] = rows[f].values[column];
    }
    qsort(values, count, sizeof(double), by_size);
    if (count)
        median = 0.5 * (values[(count - 1) / 2] + values[count / 2]);
    free(values);
    return median;
}

/* Where on the straight line from (x0, y0) to (x1, y1) in logarithms y is reached. */
static double between(double x0, double y0, double x1, double y1, double y) {
    if (!(x0 > 0 && x1 > 0 && y0 > 0 && y1 > 0 && y > 0) || y0 == y1)
        return x1;
    return exp(log(x0) + (log(x1) - log(x0)) * (log(y) - log(y0)) / (log(y1) - log(y0)));
}

double experiment_time_to(const experiment_series *s, int column, double error) {
    double time = 0, before = 0;
    for (int frame = 1; frame <= s->lab->spec.configs[s->config].frames; frame++) {
        double now = experiment_at(s, COL_CPU_TOTAL, frame), y = experiment_at(s, column, frame);
        if (isnan(y))
            return NAN;
        if (y <= error)
            return frame == 1 ? 0 : between(time, before, now, y, error);
        time = now;
        before = y;
    }
    return NAN;
}

double experiment_error_after(const experiment_series *s, int column, double seconds) {
    double time = 0, before = 0;
    for (int frame = 1; frame <= s->lab->spec.configs[s->config].frames; frame++) {
        double now = experiment_at(s, COL_CPU_TOTAL, frame), y = experiment_at(s, column, frame);
        if (isnan(y))
            return NAN;
        if (now >= seconds)
            return frame == 1 ? NAN : between(before, time, y, now, seconds);
        time = now;
        before = y;
    }
    return NAN;
}
