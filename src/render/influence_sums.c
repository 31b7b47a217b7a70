/* What a ranking has found: sums of batches, and the estimates and errors that follow from them. */
#include "render/influence.h"

#include <math.h>

/* ---- sums ---- */

static size_t slot_of(const ranking_sums *s, uint32_t emitter) {
    size_t at = (emitter * (size_t)0x9e3779b97f4a7c15u >> 32) & (s->cap - 1);
    while (s->emitter[at] != NOC_NO_EMITTER && s->emitter[at] != emitter)
        at = (at + 1) & (s->cap - 1);
    return at;
}

static bool grow(ranking_sums *s) {
    size_t cap = s->cap ? s->cap * 2 : 64;
    ranking_sums more = { noc_alloc(cap * sizeof(*more.emitter)), noc_alloc(cap * sizeof(*more.value)), s->len, cap };
    if (!more.emitter || !more.value) {
        noc_sums_free(&more);
        return false;
    }
    memset(more.emitter, 0xff, cap * sizeof(*more.emitter));
    for (size_t i = 0; i < s->cap; i++)
        if (s->emitter[i] != NOC_NO_EMITTER) {
            size_t to = slot_of(&more, s->emitter[i]);
            more.emitter[to] = s->emitter[i];
            more.value[to] = s->value[i];
        }
    noc_sums_free(s);
    *s = more;
    return true;
}

bool noc_sums_add(ranking_sums *s, uint32_t emitter, double value) {
    if (4 * (s->len + 1) > 3 * s->cap && !grow(s))
        return false;
    size_t at = slot_of(s, emitter);
    if (s->emitter[at] == NOC_NO_EMITTER) {
        s->emitter[at] = emitter;
        s->value[at] = 0;
        s->len++;
    }
    s->value[at] += value;
    return true;
}

double noc_sums_get(const ranking_sums *s, uint32_t emitter) {
    size_t at = s->cap ? slot_of(s, emitter) : 0;
    return s->cap && s->emitter[at] == emitter ? s->value[at] : 0;
}

void noc_sums_free(ranking_sums *s) {
    free(s->emitter);
    free(s->value);
    *s = (ranking_sums){ 0 };
}

/* ---- estimates ---- */

/* Means over a batch's samples. */
typedef struct spread {
    double part[RANKING_BATCHES];
} spread;

static double samples_of(const noc_ranking *r) { return (double)r->rounds * (r->point ? 1 : RANKING_POINTS); }

static noc_estimate mean_of(const spread *s) {
    double mean = 0, squares = 0;
    for (int b = 0; b < RANKING_BATCHES; b++)
        mean += s->part[b] / RANKING_BATCHES;
    for (int b = 0; b < RANKING_BATCHES; b++)
        squares += (s->part[b] - mean) * (s->part[b] - mean);
    return (noc_estimate){ mean, sqrt(squares / (RANKING_BATCHES * (RANKING_BATCHES - 1.0))) };
}

/* The ratio of two means, NaN of nothing, and its error by the differences from it: batches that are bright in both say
 * nothing. */
static noc_estimate ratio_of(const spread *s, const spread *of) {
    double whole = mean_of(of).value;
    if (!(whole > 0))
        return (noc_estimate){ NAN, NAN };
    noc_estimate share = { mean_of(s).value / whole, 0 };
    spread rest;
    for (int b = 0; b < RANKING_BATCHES; b++)
        rest.part[b] = s->part[b] - share.value * of->part[b];
    share.error = mean_of(&rest).error / whole;
    return share;
}

static spread spread_of(const noc_ranking *r, uint32_t emitter) {
    spread s;
    for (int b = 0; b < RANKING_BATCHES; b++)
        s.part[b] = noc_sums_get(&r->batch[b].sums, emitter) / samples_of(r);
    return s;
}

/* Returns true if light of this kind, or of RANKING_SKY, is part of the sums. */
static bool counts(const noc_ranking *r, int part) { return part != NOC_EMITTER_WINDOW || r->count_windows; }

typedef struct totals {
    spread all, luminance, parts[RANKING_PARTS]; /* all: of what counts */
} totals;

static totals totals_of(const noc_ranking *r) {
    totals t = { 0 };
    for (int b = 0; b < RANKING_BATCHES; b++) {
        const ranking_batch *batch = &r->batch[b];
        for (int part = 0; part < RANKING_PARTS; part++) {
            for (int c = 0; c < NOC_CLASS_COUNT; c++)
                t.parts[part].part[b] += batch->lux[part][c] / samples_of(r);
            t.all.part[b] += counts(r, part) ? t.parts[part].part[b] : 0;
        }
        t.luminance.part[b] = (batch->luminance[0] + (r->count_windows ? batch->luminance[1] : 0)) / samples_of(r);
    }
    return t;
}

static noc_emitter_kind kind_of(const noc_ranking *r, size_t emitter) { return r->emitters.all.data[emitter].kind; }

/* What each emitter brought in all; NULL: no memory. found[kind]: how many of that kind brought anything. */
static double *sum_emitters(const noc_ranking *r, size_t found[NOC_EMITTER_KIND_COUNT]) {
    double *sum = noc_calloc(NOC_MAX(r->emitters.all.len, 1), sizeof(*sum));
    memset(found, 0, NOC_EMITTER_KIND_COUNT * sizeof(*found));
    for (int b = 0; b < RANKING_BATCHES && sum; b++) {
        const ranking_sums *s = &r->batch[b].sums;
        for (size_t i = 0; i < s->cap; i++)
            if (s->emitter[i] != NOC_NO_EMITTER) {
                found[kind_of(r, s->emitter[i])] += sum[s->emitter[i]] == 0;
                sum[s->emitter[i]] += s->value[i];
            }
    }
    return sum;
}

noc_status noc_ranking_error(const noc_ranking *r, double *error) {
    size_t found[NOC_EMITTER_KIND_COUNT], best = SIZE_MAX;
    double *sum = sum_emitters(r, found);
    *error = 0;
    if (!sum)
        return noc_no_memory(r->view->log, "influence");
    for (size_t i = 0; i < r->emitters.all.len; i++)
        if (sum[i] > 0 && counts(r, (int)kind_of(r, i)) && (best == SIZE_MAX || sum[i] > sum[best]))
            best = i;
    if (best != SIZE_MAX) {
        totals t = totals_of(r);
        spread s = spread_of(r, (uint32_t)best);
        noc_estimate share = ratio_of(&s, &t.all), lux = mean_of(&t.all);
        *error = fmax(share.error / share.value, lux.error / lux.value);
    }
    free(sum);
    return NOC_OK;
}

/* ---- what is told ---- */

typedef struct order {
    double value;
    uint32_t emitter;
} order;

static int strongest_first(const void *a, const void *b) {
    const order *x = a, *y = b;
    if (x->value != y->value)
        return x->value > y->value ? -1 : 1;
    return x->emitter < y->emitter ? -1 : x->emitter > y->emitter;
}

/* The emitters that count and brought anything, the strongest first, and their number; NULL: no memory. */
static order *order_emitters(const noc_ranking *r, size_t found[NOC_EMITTER_KIND_COUNT], size_t *count) {
    double *sum = sum_emitters(r, found);
    size_t all = 0;
    for (int k = 0; k < NOC_EMITTER_KIND_COUNT; k++)
        all += counts(r, k) ? found[k] : 0;
    order *o = sum ? noc_alloc(NOC_MAX(all, 1) * sizeof(*o)) : NULL;
    *count = 0;
    for (size_t i = 0; i < r->emitters.all.len && o; i++)
        if (sum[i] > 0 && counts(r, (int)kind_of(r, i)))
            o[(*count)++] = (order){ sum[i], (uint32_t)i };
    free(sum);
    if (o)
        qsort(o, *count, sizeof(*o), strongest_first);
    return o;
}

static void fill_sum(const noc_ranking *r, const totals *t, const spread *rest,
                     const size_t found[NOC_EMITTER_KIND_COUNT], size_t emitters, noc_influence_sum *sum) {
    *sum = (noc_influence_sum){ .lux = mean_of(&t->all),
                                .windows_counted = r->count_windows,
                                .sky = mean_of(&t->parts[RANKING_SKY]),
                                .sky_share = ratio_of(&t->parts[RANKING_SKY], &t->all),
                                .rest = mean_of(rest),
                                .rest_share = ratio_of(rest, &t->all),
                                .luminance = mean_of(&t->luminance),
                                .emitters = emitters,
                                .samples = (uint64_t)samples_of(r) * RANKING_BATCHES,
                                .seconds = r->seconds,
                                .restarts = r->restarts };
    for (int k = 0; k < NOC_EMITTER_KIND_COUNT; k++) {
        noc_estimate share = counts(r, k) ? ratio_of(&t->parts[k], &t->all) : (noc_estimate){ NAN, NAN };
        sum->kinds[k] = (noc_influence_kind){ mean_of(&t->parts[k]), share, found[k] };
    }
    for (int b = 0; b < RANKING_BATCHES; b++)
        sum->rays += r->batch[b].rays;
}

static int heaviest_first(const void *a, const void *b) {
    const noc_influence_class *x = a, *y = b;
    if (x->weight != y->weight)
        return x->weight > y->weight ? -1 : 1;
    return (int)x->cls - (int)y->cls;
}

enum { ALL_PARTS = -1 }; /* that count */

/* Mean illuminance of a class by one part, or by all that count; NaN: no sample fell on the class. */
static noc_estimate lux_of_class(const noc_ranking *r, int cls, int part) {
    spread lux, points;
    for (int b = 0; b < RANKING_BATCHES; b++) {
        lux.part[b] = 0;
        for (int p = 0; p < RANKING_PARTS; p++)
            lux.part[b] += part == p || (part == ALL_PARTS && counts(r, p)) ? r->batch[b].lux[p][cls] : 0;
        points.part[b] = r->batch[b].points[cls];
    }
    return mean_of(&points).value > 0 ? ratio_of(&lux, &points) : (noc_estimate){ NAN, NAN };
}

noc_status noc_ranking_get_classes(noc_ranking *r, noc_influence_class *classes, size_t count, size_t *found) {
    if (!r || (count && !classes))
        return noc_null(r ? r->view->log : NULL, __func__);
    if (!r->rounds)
        return noc_error(r->view->log, NOC_ERR_ARGUMENT, "influence: nothing was estimated yet");
    noc_influence_class all[NOC_CLASS_COUNT];
    size_t n = 0;
    for (int c = 0; c < NOC_CLASS_COUNT; c++) {
        if (r->weight[c] > 0)
            all[n++] =
                (noc_influence_class){ (noc_class)c, r->weight[c], lux_of_class(r, c, ALL_PARTS),
                                       lux_of_class(r, c, NOC_EMITTER_LAMP), lux_of_class(r, c, NOC_EMITTER_WINDOW) };
    }
    qsort(all, n, sizeof(*all), heaviest_first);
    for (size_t i = 0; i < n && i < count; i++)
        classes[i] = all[i];
    if (found)
        *found = NOC_MIN(n, count);
    return NOC_OK;
}

noc_status noc_ranking_get(noc_ranking *r, noc_influence_row *rows, size_t count, size_t *found,
                           noc_influence_sum *sum) {
    if (!r || (count && !rows))
        return noc_null(r ? r->view->log : NULL, __func__);
    if (!r->rounds)
        return noc_error(r->view->log, NOC_ERR_ARGUMENT, "influence: nothing was estimated yet");
    size_t emitters, kinds[NOC_EMITTER_KIND_COUNT];
    order *o = order_emitters(r, kinds, &emitters);
    if (!o)
        return noc_no_memory(r->view->log, "influence");
    noc_region_info info;
    noc_region_get_info(r->region, &info);
    totals t = totals_of(r);
    spread rest;
    for (int b = 0; b < RANKING_BATCHES; b++)
        rest.part[b] = t.all.part[b] - t.parts[RANKING_SKY].part[b];
    count = NOC_MIN(count, emitters);
    noc_scene_lock_read(r->view->scene);
    const noc_scene *scene = r->lights == r->view->scene->versions.lights ? r->view->scene : NULL;
    for (size_t i = 0; i < count; i++) {
        spread s = spread_of(r, o[i].emitter);
        rows[i] = (noc_influence_row){ .lux = mean_of(&s), .share = ratio_of(&s, &t.all) };
        noc_emitter_describe(scene, &r->emitters, o[i].emitter, &rows[i].emitter);
        double d2 = 0;
        for (int k = 0; k < 3; k++)
            d2 += (rows[i].emitter.centre[k] - info.centre[k]) * (rows[i].emitter.centre[k] - info.centre[k]);
        rows[i].distance = scene ? sqrt(d2) : NAN;
        for (int b = 0; b < RANKING_BATCHES; b++)
            rest.part[b] -= s.part[b];
    }
    noc_scene_unlock_read(r->view->scene);
    if (found)
        *found = count;
    if (sum)
        fill_sum(r, &t, &rest, kinds, emitters, sum);
    free(o);
    return NOC_OK;
}
