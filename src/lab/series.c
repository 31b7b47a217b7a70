/* Curves of an experiment: means over its repetitions, and times between frames by interpolation. */
#include "lab/series.h"

#include <limits.h>
#include <math.h>

/* Repetitions that a series is about: from the first to before the end. */
static int first_of(const lab_series *s) { return s->only ? s->only - 1 : 0; }
static int end_of(const lab_series *s) { return s->only ? s->only : s->lab->spec->repetitions; }

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
    int n = s->lab->spec->repetitions;
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

static int by_size(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

double lab_median(const lab_series *s, int column) {
    const lab_spec *spec = s->lab->spec;
    size_t count = 0;
    double *values = s->lab->values, median = NAN;
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
    if (s->lab->spec->cameras[s->camera].frames)
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

/* Frames told in a table of cameras that stand still: those that the spec measures, if they are few, else the first and
 * the last. */
int lab_points(const lab_spec *spec, size_t camera, lab_point out[LAB_POINTS]) {
    if (spec->cameras[camera].frames) {
        out[0] = (lab_point){ LAB_ALONE, 0 };
        return 1;
    }
    bool alone = lab_has_mode(spec, camera, LAB_ALONE),
         listed = spec->measured_count && spec->measured_count < LAB_POINTS;
    bool one = true; /* frame is all there is */
    for (size_t i = 0; i < spec->config_count; i++)
        one &= lab_frames(spec, camera, i) == 1;
    int count = 0, mode = alone ? LAB_ALONE : LAB_ACCUMULATED;
    for (size_t i = 0; listed && i < spec->measured_count; i++)
        out[count++] = (lab_point){ mode, spec->measured[i] };
    if (!listed) {
        out[count++] = (lab_point){ mode, 1 };
        if (!one)
            out[count++] = (lab_point){ mode, 0 };
    }
    if (alone && !one && lab_has_mode(spec, camera, LAB_ACCUMULATED))
        out[count++] = (lab_point){ LAB_ACCUMULATED, 0 };
    return count;
}

double lab_at_point(const lab_session *lab, size_t camera, size_t config, lab_point point, int column, double *error) {
    lab_series s = { lab, camera, config, point.mode, 0 };
    int frame = point.frame ? point.frame : lab_last(&s);
    *error = lab_error_at(&s, column, frame);
    return lab_at(&s, column, frame);
}

const char *lab_point_name(const lab_spec *spec, size_t camera, lab_point point, char text[48]) {
    int motion = spec->cameras[camera].frames;
    if (motion)
        noc_snprintf(text, 48, "frame %d", motion);
    else if (point.frame)
        noc_snprintf(text, 48, point.mode == LAB_ALONE ? "frame %d" : "mean of %d", point.frame);
    else
        noc_snprintf(text, 48, "%s", point.mode == LAB_ALONE ? "last frame" : "mean of all");
    return text;
}

lab_series lab_timed(const lab_session *lab, size_t camera, size_t config) {
    int mode = lab_has_mode(lab->spec, camera, LAB_ALONE) ? LAB_ALONE : LAB_ACCUMULATED;
    return (lab_series){ lab, camera, config, mode, 0 };
}
