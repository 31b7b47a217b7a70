/* Readings: frames of a block's receivers are its samples. */
#include "measure/readings.h"

#include <math.h>
#include <nocturne/option.h>

enum { LEAST_SAMPLES = 8, ENOUGH = 4 }; /* one in so many readings may fall short of the error */
uint32_t mix(uint32_t a, uint32_t b) {
    uint32_t x = a * 0x9e3779b9u + b;
    x = (x ^ x >> 16) * 0x7feb352du;
    x = (x ^ x >> 15) * 0x846ca68bu;
    return x ^ x >> 16;
}

void spread_2d(uint32_t key, uint32_t i, double out[2]) {
    static const double step[2] = { 0.75487766624669276, 0.56984029099805327 };
    for (uint32_t k = 0; k < 2; k++)
        out[k] = fmod(mix(key, k) * 0x1p-32 + i * step[k], 1.0);
}

noc_receiver meter_receiver(const measuring *m, const double place[3], const double normal[3]) {
    noc_receiver r = { .material = m->material };
    for (int k = 0; k < 3; k++) {
        r.p[k] = (float)place[k];
        r.n[k] = (float)normal[k];
    }
    return r;
}

/* What a luxmeter is lit by does not depend on what lies under it, but what is black has no light to be found. So all
 * receivers are of the scene's material that is lightest in its darkest colour. */
static noc_status find_material(measuring *m) {
    const noc_scene *scene = m->view->scene;
    float most = 0.01f;
    noc_scene_lock_read(scene);
    for (size_t i = 0; i < scene->materials.len; i++) {
        const float *a = scene->materials.data[i].albedo;
        float darkest = fminf(a[0], fminf(a[1], a[2]));
        if (darkest > most) {
            most = darkest;
            m->material = (uint32_t)i;
        }
    }
    noc_scene_unlock_read(scene);
    return m->material != NO_SURFACE ? NOC_OK
                                     : noc_error(m->view->log, NOC_ERR_ARGUMENT,
                                                 "measure: all of the scene's materials are black in some colour");
}

static noc_status check(const noc_measure_params *p, noc_log *log) {
    if (!(p->error > 0 && p->error <= 1))
        return noc_error(log, NOC_ERR_ARGUMENT, "measure: the error is %g, must be over 0 and at most 1", p->error);
    if (!(p->least > 0 && p->least < 1e6))
        return noc_error(log, NOC_ERR_ARGUMENT, "measure: the least illuminance is %g lx, must be over 0 and below 1e6",
                         p->least);
    if (p->samples < LEAST_SAMPLES || p->samples > 1 << 24)
        return noc_error(log, NOC_ERR_ARGUMENT, "measure: %d samples at most, must be %d to %d", p->samples,
                         LEAST_SAMPLES, 1 << 24);
    return NOC_OK;
}

/* What a luxmeter wants of a frame: the light alone, of that frame alone. Lists choose lights for 16 x 16 receivers
 * together, and what rays found steers where the next frames send theirs. */
static noc_render_params render_of(const noc_render_params *given) {
    noc_render_params p = *given;
    noc_render_use_preset(&p, NOC_PRESET_STILL);
    p.method = NOC_METHOD_RIS;
    p.candidates = NOC_CANDIDATES_LISTS;
    p.gloss = p.jitter = p.emitters = p.accumulate = false;
    p.final_ray = p.learn = true;
    p.aovs = 1u << NOC_AOV_ILLUMINANCE;
    return p;
}

noc_status measuring_begin(measuring *m, noc_view *view, const noc_measure_params *params,
                           const noc_progress *progress) {
    const noc_render_params defaults = noc_render_default_params();
    *m = (measuring){
        .view = view, .progress = progress, .params = noc_measure_default_params(), .to = 1, .material = NO_SURFACE
    };
    m->params = params ? *params : m->params;
    m->began = noc_wall_seconds();
    m->render = render_of(m->params.render ? m->params.render : &defaults);
    noc_status status = check(&m->params, view->log);
    status = status ? status : noc_render_check(&m->render, view->log);
    status = status ? status : find_material(m);
    m->receivers = status ? NULL : noc_alloc(BLOCK_AREA * sizeof(*m->receivers));
    return status || m->receivers ? status : noc_no_memory(view->log, "measure");
}

static int by_size(const void *a, const void *b) {
    float x = *(const float *)a, y = *(const float *)b;
    return x < y ? -1 : x > y;
}

void measuring_end(measuring *m, noc_measure_info *info) {
    if (m->errors.len) {
        qsort(m->errors.data, m->errors.len, sizeof(*m->errors.data), by_size);
        m->info.error = m->errors.data[m->errors.len / 2];
    }
    m->info.mean_error = m->weight > 0 ? sqrt(m->variance) / m->weight : 0;
    m->info.seconds = noc_wall_seconds() - m->began;
    if (info)
        *info = m->info;
    array_free(&m->errors);
    free(m->receivers);
    m->receivers = NULL;
}

static double error_of(const tally *t) {
    double n = t->samples;
    return n > 1 ? sqrt(t->squares / (n * (n - 1))) : t->mean;
}

noc_reading reading_of(const tally *t, uint32_t frames) {
    if (!t->samples)
        return (noc_reading){ NAN, NAN, 0, 0 };
    return (noc_reading){ t->mean, error_of(t), (double)t->samples / frames, t->samples };
}

static bool falls_short(const measuring *m, const noc_reading *r) {
    return r->samples && !(r->error <= m->params.error * fmax(r->lux, m->params.least));
}

noc_status note_reading(measuring *m, const noc_reading *r) {
    if (!r->samples)
        return NOC_OK;
    m->info.readings++;
    m->info.short_of_it += falls_short(m, r);
    bool told = r->lux < m->params.least || array_push(&m->errors, (float)(r->error / r->lux));
    return told ? NOC_OK : noc_no_memory(m->view->log, "measure");
}

static void add_sample(tally *t, double x) {
    double d = x - t->mean;
    t->mean += d / ++t->samples;
    t->squares += d * (x - t->mean);
}

/* What the frames of a block are added up in. */
typedef struct scratch {
    double *sum; /* of a reading's pixels in this frame, so many */
    uint32_t *pixels;
    tally mean;     /* of all readings that count */
    double counted; /* so many of them, over all frames */
} scratch;

/* A reading's sample is the mean over its pixels of this frame. */
static void add_frame(measuring *m, block *b, const float *lux, scratch *s) {
    double *sum = s->sum, all = 0, counted = 0;
    uint32_t *pixels = s->pixels;
    size_t area = (size_t)b->width * (size_t)b->height;
    memset(sum, 0, b->count * sizeof(*sum));
    memset(pixels, 0, b->count * sizeof(*pixels));
    for (size_t i = 0; i < area; i++)
        if (b->of[i] != NO_READING && lux[i] >= 0) {
            sum[b->of[i]] += lux[i];
            pixels[b->of[i]]++;
            m->info.samples++;
        }
    for (size_t k = 0; k < b->count; k++) {
        if (!pixels[k])
            continue;
        add_sample(&b->tallies[k], sum[k] / pixels[k]);
        bool counts = !b->counts || b->counts[k];
        all += counts ? sum[k] / pixels[k] : 0;
        counted += counts;
    }
    s->counted += counted;
    if (counted > 0)
        add_sample(&s->mean, all / counted);
}

static bool well_known(const measuring *m, const block *b) {
    size_t readings = 0, few = 0;
    if (m->whole)
        return false;
    for (size_t k = 0; k < b->count; k++) {
        noc_reading r = reading_of(&b->tallies[k], b->frames);
        readings += r.samples > 0;
        few += falls_short(m, &r);
    }
    return few * ENOUGH <= readings;
}

static noc_status read_frame(measuring *m, block *b, scratch *s) {
    noc_status status = noc_view_receive(m->view, m->receivers, &m->render, NULL);
    noc_channel *lux = status ? NULL : noc_view_aov(m->view, NOC_AOV_ILLUMINANCE);
    if (!status && !lux)
        return NOC_ERR_MEMORY;
    if (lux)
        add_frame(m, b, lux->value, s);
    noc_channel_destroy(lux);
    return status;
}

static bool goes_on(const measuring *m, double done) {
    const noc_progress *p = m->progress;
    return !p || !p->update || p->update(p->user, "measuring", m->from + (m->to - m->from) * done);
}

static noc_status make_frames(measuring *m, block *b, scratch *s) {
    uint32_t most = (uint32_t)m->params.samples, look = LEAST_SAMPLES;
    noc_status status = NOC_OK;
    for (b->frames = 0; b->frames < most && !status; b->frames++) {
        if (b->frames == look) {
            if (well_known(m, b))
                break;
            look += NOC_MAX(1u, look / 4);
        }
        bool some = false;
        status = goes_on(m, (double)b->frames / most) ? b->place(b->user, b->frames, m->receivers, &some)
                                                      : noc_cancelled(m->view->log, "measure: cancelled");
        if (!status && some)
            status = read_frame(m, b, s);
    }
    return status;
}

noc_status measure_block(measuring *m, block *b) {
    scratch s = { noc_alloc(b->count * sizeof(*s.sum)), noc_alloc(b->count * sizeof(*s.pixels)), { 0 }, 0 };
    noc_status status = s.sum && s.pixels ? NOC_OK : noc_no_memory(m->view->log, "measure");
    memset(b->tallies, 0, b->count * sizeof(*b->tallies));
    noc_view_reset(m->view); /* what one block learned steers no other one */
    m->render.width = b->width;
    m->render.height = b->height;
    m->render.seed = b->seed;
    status = status ? status : make_frames(m, b, &s);
    double weight = s.counted / NOC_MAX(b->frames, 1u), error = weight * error_of(&s.mean);
    m->weight += weight;
    m->variance += error * error;
    free(s.sum);
    free(s.pixels);
    return status;
}
