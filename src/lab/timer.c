/* Frames of several settings by the clock and by processor time, in turn. */
#include "base/base.h"

#include <nocturne/lab.h>

/* What was measured of one frame. */
typedef struct sample {
    double wall, cpu, pass[NOC_PASS_COUNT];
} sample;

typedef struct timed {
    noc_lab_case of;
    noc_view *view;
    noc_frame_stats first, last;
    NOC_ARRAY(sample) frames;
    NOC_ARRAY(noc_trace_floor) floors;
} timed;

struct noc_lab_timer {
    noc_log *log;
    NOC_ARRAY(timed) cases;
    size_t rounds;
};

noc_lab_timer *noc_lab_timer_create(noc_log *log) {
    noc_lab_timer *t = noc_calloc(1, sizeof(*t));
    if (!t) {
        noc_no_memory(log, "noc_lab_timer");
        return NULL;
    }
    t->log = log;
    return t;
}

void noc_lab_timer_destroy(noc_lab_timer *t) {
    for (size_t i = 0; t && i < t->cases.len; i++) {
        noc_view_destroy(t->cases.data[i].view);
        array_free(&t->cases.data[i].frames);
        array_free(&t->cases.data[i].floors);
    }
    if (t)
        array_free(&t->cases);
    free(t);
}

noc_status noc_lab_timer_add(noc_lab_timer *t, const noc_lab_case *of, const noc_progress *progress) {
    if (!t || !of || !of->device || !of->scene)
        return noc_null(t ? t->log : NULL, __func__);
    timed one = { .of = *of, .view = noc_view_create(of->device, of->scene) };
    noc_status status = one.view ? NOC_OK : NOC_ERR_MEMORY; /* reported by the view */
    for (int frame = 0; !status && frame < 2; frame++) {
        status = noc_view_render(one.view, &of->camera, &of->render, progress);
        noc_view_get_stats(one.view, frame ? &one.last : &one.first);
    }
    if (!status && !array_push(&t->cases, one))
        status = noc_no_memory(t->log, __func__);
    if (status)
        noc_view_destroy(one.view);
    return status;
}

static noc_status measure(noc_lab_timer *t, timed *one, const noc_progress *progress) {
    const noc_lab_case *of = &one->of;
    noc_trace_floor floor;
    noc_status status = noc_view_render(one->view, &of->camera, &of->render, progress);
    if (status)
        return status;
    noc_view_get_stats(one->view, &one->last);
    sample frame = { .wall = one->last.wall_seconds, .cpu = one->last.cpu_seconds };
    memcpy(frame.pass, one->last.pass_seconds, sizeof(frame.pass));
    if (!array_push(&one->frames, frame))
        return noc_no_memory(t->log, __func__);
    status = of->floor ? noc_view_trace_floor(one->view, &of->camera, &of->render, progress, &floor) : NOC_OK;
    if (!status && of->floor && !array_push(&one->floors, floor))
        status = noc_no_memory(t->log, __func__);
    return status;
}

noc_status noc_lab_timer_round(noc_lab_timer *t, const noc_progress *progress) {
    if (!t)
        return noc_null(NULL, __func__);
    noc_status status = NOC_OK;
    size_t count = t->cases.len;
    for (size_t i = 0; !status && i < count; i++) /* back and forth: what drifts falls on all of them alike */
        status = measure(t, &t->cases.data[t->rounds % 2 ? count - 1 - i : i], progress);
    t->rounds += !status;
    return status;
}

static int by_size(const void *a, const void *b) {
    double d = *(const double *)a - *(const double *)b;
    return (d > 0) - (d < 0);
}

/* Of a field of each of the records; 0 of none. scratch: room for count numbers. */
static double median(const void *records, size_t count, size_t size, size_t offset, double *scratch) {
    for (size_t i = 0; i < count; i++)
        memcpy(&scratch[i], (const char *)records + i * size + offset, sizeof(double));
    qsort(scratch, count, sizeof(double), by_size);
    return count ? 0.5 * (scratch[(count - 1) / 2] + scratch[count / 2]) : 0;
}

#define MEDIAN(of, T, field, scratch) median((of).data, (of).len, sizeof(T), offsetof(T, field), scratch)

noc_status noc_lab_timer_get(const noc_lab_timer *t, size_t index, noc_lab_times *times) {
    if (!t || !times)
        return noc_null(t ? t->log : NULL, __func__);
    if (index >= t->cases.len)
        return noc_error(t->log, NOC_ERR_ARGUMENT, "%s: index is %zu of %zu", __func__, index, t->cases.len);
    const timed *one = &t->cases.data[index];
    double *scratch = noc_alloc((NOC_MAX(one->frames.len, one->floors.len) + 1) * sizeof(double));
    if (!scratch)
        return noc_no_memory(t->log, __func__);
    *times = (noc_lab_times){
        .frames = one->frames.len,
        .wall_seconds = MEDIAN(one->frames, sample, wall, scratch),
        .cpu_seconds = MEDIAN(one->frames, sample, cpu, scratch),
        .floors = one->floors.len,
        .floor = { MEDIAN(one->floors, noc_trace_floor, wall_seconds, scratch),
                   MEDIAN(one->floors, noc_trace_floor, cpu_seconds, scratch) },
        .first = one->first,
        .last = one->last,
    };
    for (int p = 0; p < NOC_PASS_COUNT; p++)
        times->pass_seconds[p] = median(one->frames.data, one->frames.len, sizeof(sample),
                                        offsetof(sample, pass) + (size_t)p * sizeof(double), scratch);
    noc_view_light_stats(one->view, &times->lights);
    free(scratch);
    return NOC_OK;
}
