/* Curves of an experiment: means over its repetitions, and times between frames by interpolation. */
#include "lab/lab.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>

lab_run *lab_find_run(const lab_session *lab, size_t camera, size_t config, int repetition) {
    const lab_spec *spec = &lab->spec;
    return &lab->runs[(camera * (size_t)spec->repetitions + (size_t)repetition) * spec->config_count + config];
}

/* Of a camera that moves the last frame alone is measured. */
bool lab_has_mode(const lab_spec *spec, size_t camera, int mode) {
    if (spec->cameras[camera].frames)
        return mode == LAB_ALONE;
    return spec->accumulate == mode || spec->accumulate == LAB_MODES;
}

int lab_frames(const lab_spec *spec, size_t camera, size_t config) {
    return spec->cameras[camera].frames ? spec->cameras[camera].frames : spec->configs[config].frames;
}

bool lab_measures(const lab_spec *spec, size_t camera, size_t config, int frame) {
    int last = lab_frames(spec, camera, config);
    if (spec->cameras[camera].frames || frame == last)
        return frame == last;
    for (size_t i = 0; i < spec->measured_count; i++)
        if (spec->measured[i] == frame)
            return true;
    if (spec->measured_count || !(spec->configs[config].seconds > 0))
        return !spec->measured_count;
    /* Thousands of frames fit into some seconds: their distance rises by an eighth. */
    int next = 1;
    while (next < frame)
        next += next < 16 ? 1 : next / 8;
    return next == frame;
}

/* Repetitions that a series is about: from the first to before the end. */
static int first_of(const lab_series *s) { return s->only ? s->only - 1 : 0; }
static int end_of(const lab_series *s) { return s->only ? s->only : s->lab->spec.repetitions; }

int lab_last(const lab_series *s) {
    int last = INT_MAX;
    for (int i = first_of(s); i < end_of(s); i++) {
        int count = lab_find_run(s->lab, s->camera, s->config, i)->count;
        last = count < last ? count : last;
    }
    while (last > 0 && isnan(lab_at(s, 0, last)))
        last--;
    return last;
}

double lab_at(const lab_series *s, int column, int frame) {
    double sum = 0;
    for (int i = first_of(s); i < end_of(s); i++) {
        const lab_run *run = lab_find_run(s->lab, s->camera, s->config, i);
        if (frame < 1 || frame > run->count || !run->rows[s->mode] || !run->rows[s->mode][frame - 1].done)
            return NAN;
        sum += run->rows[s->mode][frame - 1].values[column];
    }
    return sum / (end_of(s) - first_of(s));
}

double lab_error_of(const lab_series *s, lab_asked *asked, int column, double what) {
    double sum = 0, squares = 0;
    int n = s->lab->spec.repetitions;
    if (n < 2)
        return NAN;
    for (int pass = 0; pass < 2; pass++)
        for (int i = 0; i < n; i++) {
            lab_series one = *s;
            one.only = i + 1;
            double v = asked(&one, column, what);
            if (pass)
                squares += (v - sum / n) * (v - sum / n);
            else
                sum += v;
        }
    return sqrt(squares / (n - 1) / n);
}

static double at(const lab_series *s, int column, double frame) { return lab_at(s, column, (int)frame); }

double lab_error_at(const lab_series *s, int column, int frame) { return lab_error_of(s, at, column, frame); }

int lab_column(const lab_spec *spec) {
    int first = spec->all_pixels ? COL_RMSE8_ALL : COL_RMSE8;
    return first + (spec->figure == LAB_RMSE8 ? 0 : spec->figure == LAB_RELMSE ? 1 : 2);
}

const char *lab_figure(const lab_spec *spec) {
    static char text[120];
    const char *pixels = spec->all_pixels ? "all pixels" : "pixels that see no emitter";
    if (spec->figure == LAB_CLAMPED)
        snprintf(text, sizeof(text), "relMSE clamped to %g cd/m\302\262, %s", spec->ceiling, pixels);
    else
        snprintf(text, sizeof(text), "%s, %s", spec->figure == LAB_RELMSE ? "relMSE" : "RMSE-8 (0 to 255)", pixels);
    return text;
}

static int by_size(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

double lab_median(const lab_series *s, int column) {
    const lab_spec *spec = &s->lab->spec;
    size_t count = 0, room = 0;
    for (int i = 0; i < spec->repetitions; i++)
        room += (size_t)lab_find_run(s->lab, s->camera, s->config, i)->count;
    double *values = cli_alloc(sizeof(double) * (room + 1)), median = NAN;
    for (int first = 1; first >= 0 && !count; first--) { /* the first frame only where there is no other */
        for (int i = 0; i < spec->repetitions; i++) {
            const lab_run *run = lab_find_run(s->lab, s->camera, s->config, i);
            for (int f = first; run->rows[s->mode] && f < run->count; f++)
                if (run->rows[s->mode][f].done && !isnan(run->rows[s->mode][f].values[column]))
                    values[count++] = run->rows[s->mode][f].values[column];
        }
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

double lab_frame_time(const lab_series *s, int column, double what) {
    int last = lab_last(s);
    double first = lab_at(s, COL_CPU_TOTAL, 1), total = lab_at(s, COL_CPU_TOTAL, last);
    if (s->lab->spec.cameras[s->camera].frames)
        return lab_at(s, COL_CPU, last);
    if (last == 1)
        return total;
    return isnan(first) ? total / last : (total - first) / (last - 1);
}

double lab_time_to(const lab_series *s, int column, double error) {
    double time = 0, before = 0;
    for (int frame = 1, last = lab_last(s); frame <= last; frame++) {
        double now = lab_at(s, COL_CPU_TOTAL, frame), y = lab_at(s, column, frame);
        if (isnan(y))
            continue;
        if (y <= error)
            return time > 0 ? between(time, before, now, y, error) : 0;
        time = now;
        before = y;
    }
    return NAN;
}

double lab_error_after(const lab_series *s, int column, double seconds) {
    double time = 0, before = 0;
    for (int frame = 1, last = lab_last(s); frame <= last; frame++) {
        double now = lab_at(s, COL_CPU_TOTAL, frame), y = lab_at(s, column, frame);
        if (isnan(y))
            continue;
        if (now >= seconds)
            return time > 0 ? between(before, time, y, now, seconds) : NAN;
        time = now;
        before = y;
    }
    return NAN;
}
