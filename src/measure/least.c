/* The least of noisy readings. What has the least reading has it partly by its noise. So readings choose meters that
 * may be the least, samples of their own choose among these, and the last samples tell what the chosen one reads. */
#include "measure/readings.h"

#include <math.h>

enum {
    ROUNDS = 5,       /* that choose */
    FIRST_MOST = 128, /* candidates in the first; half as many a round later, by twice the samples */
    FIRST_SAMPLES = 64,
    LAST_SAMPLES = 16, /* at least */
    REACH = 16         /* ranks to either side that share an error */
};
#define FAR 3.0 /* standard errors */

/* What is known of a meter: by the samples that it was measured with last. */
typedef struct candidate {
    double lux, low, high;
    uint32_t of; /* the meter */
} candidate;

typedef struct least_work {
    measuring m;
    const noc_meter *meters;
    size_t count;
    candidate *all; /* by their meters */
    uint32_t seed;
    uint32_t chosen[FIRST_MOST]; /* meters that are measured again */
    size_t chosen_count;
} least_work;

static int by_lux(const void *a, const void *b) {
    const candidate *x = a, *y = b;
    return x->lux != y->lux ? (x->lux > y->lux) - (x->lux < y->lux) : (x->of > y->of) - (x->of < y->of);
}

static int by_meter(const void *a, const void *b) {
    const candidate *x = a, *y = b;
    return (x->of > y->of) - (x->of < y->of);
}

static int by_number(const void *a, const void *b) {
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

static candidate known(uint32_t of, double lux, double error) {
    return (candidate){ lux, fmax(lux - FAR * error, 0), lux + FAR * error, of };
}

/* Few samples may miss what is rare: then both the mean and its error are too small, which would choose such a meter,
 * and shut out others. So an error is at least that by the mean variance of readings of about the same lux. */
static void take_first(least_work *w, const noc_reading *readings) {
    size_t n = w->count;
    candidate *all = w->all;
    for (size_t i = 0; i < n; i++)
        all[i] = (candidate){ .lux = readings[i].lux, .of = (uint32_t)i };
    qsort(all, n, sizeof(*all), by_lux);
    for (size_t i = 0; i < n; i++) {
        const noc_reading *own = &readings[all[i].of];
        double variance = 0;
        size_t from = i < REACH ? 0 : i - REACH, to = NOC_MIN(i + REACH + 1, n);
        for (size_t k = from; k < to; k++) {
            const noc_reading *r = &readings[all[k].of];
            variance += r->error * r->error * r->samples / (double)(to - from);
        }
        all[i] = known(all[i].of, own->lux, fmax(own->error, sqrt(variance / own->samples)));
    }
    qsort(all, n, sizeof(*all), by_meter);
}

/* One of them is no more than this. */
static double least_high(const least_work *w) {
    double high = INFINITY;
    for (size_t i = 0; i < w->count; i++)
        high = fmin(high, w->all[i].high);
    return high;
}

/* Meters that may be the least, and the low end of all of them. */
static size_t count_candidates(const least_work *w, double *low) {
    double high = least_high(w);
    size_t n = 0;
    *low = INFINITY;
    for (size_t i = 0; i < w->count; i++)
        if (w->all[i].low <= high) {
            *low = fmin(*low, w->all[i].low);
            n++;
        }
    return n;
}

/* Chooses those of them that have the least lux, `most` at most. The meter that has the least of all. */
static uint32_t choose(least_work *w, size_t most) {
    candidate best[FIRST_MOST] = { 0 };
    double high = least_high(w);
    size_t n = 0;
    for (size_t i = 0; i < w->count; i++) {
        const candidate *c = &w->all[i];
        if (c->low > high || (n == most && by_lux(c, &best[n - 1]) >= 0))
            continue;
        size_t at = n < most ? n++ : n - 1;
        for (; at > 0 && by_lux(c, &best[at - 1]) < 0; at--)
            best[at] = best[at - 1];
        best[at] = *c;
    }
    uint32_t least = best[0].of;
    for (size_t i = 0; i < n; i++)
        w->chosen[i] = best[i].of;
    w->chosen_count = n;
    qsort(w->chosen, n, sizeof(*w->chosen), by_number); /* neighbours in the list share their lights */
    return least;
}

/* Measures the chosen ones by new samples. *of: that meter's reading. */
static noc_status measure_again(least_work *w, uint32_t round, int samples, uint32_t least, noc_reading *of) {
    noc_meter meters[FIRST_MOST];
    noc_reading readings[FIRST_MOST];
    for (size_t i = 0; i < w->chosen_count; i++)
        meters[i] = w->meters[w->chosen[i]];
    w->m.params.samples = samples;
    noc_status status = measure_meters(&w->m, meters, w->chosen_count, mix(w->seed, 0x6c656173u + round), readings);
    for (size_t i = 0; i < w->chosen_count && !status; i++) {
        w->all[w->chosen[i]] = known(w->chosen[i], readings[i].lux, readings[i].error);
        if (w->chosen[i] == least)
            *of = readings[i];
    }
    return status;
}

/* The last samples of several are a quarter of those that chose: so a wrong choice among near ones costs less than the
 * error that is told. */
static noc_status find(least_work *w, noc_lux_least *out) {
    int allowed = w->m.params.samples, samples = FIRST_SAMPLES;
    for (uint32_t round = 0;; round++) {
        double low, high = least_high(w);
        bool sure = count_candidates(w, &low) == 1;
        bool last = sure || high - low <= w->m.params.error * high || round == ROUNDS;
        uint32_t least = choose(w, (size_t)FIRST_MOST >> NOC_MIN(round, ROUNDS - 1u));
        int now = last && round && !sure ? samples / 8 : samples;
        noc_reading of = { 0 };
        noc_status status = measure_again(w, round, NOC_MAX(NOC_MIN(now, allowed), (int)LAST_SAMPLES), least, &of);
        if (status)
            return status;
        samples *= 2;
        if (!last)
            continue;
        out->meter = least;
        out->lux = of.lux;
        out->error = of.error;
        out->samples = of.samples;
        out->candidates = count_candidates(w, &out->low);
        out->high = least_high(w);
        return NOC_OK;
    }
}

static noc_status check(const noc_reading *readings, size_t count, noc_log *log) {
    if (!count || count > UINT32_MAX - 1)
        return noc_error(log, NOC_ERR_ARGUMENT, "measure: %zu readings have no least one", count);
    for (size_t i = 0; i < count; i++)
        if (!readings[i].samples || !isfinite(readings[i].lux) || !isfinite(readings[i].error))
            return noc_error(log, NOC_ERR_ARGUMENT, "measure: meter %zu has not been read", i);
    return NOC_OK;
}

static void relate(const noc_reading *readings, size_t count, double mean_error, noc_lux_least *out) {
    double mean = 0;
    for (size_t i = 0; i < count; i++)
        mean += readings[i].lux / (double)count;
    double uo = out->lux / mean;
    out->uniformity = mean > 0 ? uo : NAN;
    out->uniformity_error = mean > 0 ? hypot(out->error, uo * mean_error) / mean : NAN;
}

noc_status noc_measure_least(noc_view *view, const noc_meter *meters, size_t count, const noc_reading *readings,
                             const noc_measure_info *info, const noc_measure_params *params,
                             const noc_progress *progress, noc_lux_least *out) {
    if (!view || !info || !out || (count && (!meters || !readings)))
        return noc_null(view ? view->log : NULL, __func__);
    noc_status status = check(readings, count, view->log);
    status = status ? status : meters_check(meters, count, view->log);
    if (status)
        return status;
    least_work w = { .meters = meters, .count = count };
    status = measuring_begin(&w.m, view, params, progress);
    w.all = status ? NULL : noc_alloc_large(count, sizeof(*w.all));
    if (!status && !w.all)
        status = noc_no_memory(view->log, "measure");
    if (!status) {
        w.seed = w.m.render.seed;
        w.m.whole = true;
        take_first(&w, readings);
        status = find(&w, out);
    }
    if (!status)
        relate(readings, count, info->mean_error, out);
    free(w.all);
    measuring_end(&w.m, NULL);
    return status;
}
