/* Scratch of passes, one a thread: made when a plan first has a pass that wants it, and kept with the view. */
#include "backend/cpu/cpu.h"
#include "core/presample_limits.h"

enum { MAX_DRAWS = MOST_DRAWS + PICK_AHEAD, MAX_RAYS = 1024 };

static bool has(const noc_plan *plan, noc_pass pass) {
    for (int i = 0; i < plan->count; i++)
        if (noc_stage_has(&plan->stages[i], pass))
            return true;
    return false;
}

/* Room for so many items where there is none yet. */
#define MAKE(p, n) ((p) || ((p) = noc_alloc_large(n, sizeof(*(p)))))

static bool make_lists(worker *w) { return MAKE(w->lists, 1); }

static bool make_set(worker *w) { return MAKE(w->picks, 1) && MAKE(w->picks->set, MOST_DRAWS); }

static bool make_items(worker *w) {
    bool ok = MAKE(w->picks, 1) && MAKE(w->picks->drawn.light, MAX_DRAWS) && MAKE(w->picks->drawn.inverse, MAX_DRAWS);
    for (int i = 0; i < 2 && ok; i++) {
        tree_items *t = &w->picks->items[i];
        ok = MAKE(t->pair, TREE_ITEMS) && MAKE(t->what, TREE_ITEMS) && MAKE(t->pmf, TREE_ITEMS);
    }
    return ok;
}

static bool make_reference(worker *w, size_t chunks, bool more) {
    if (!MAKE(w->reference, 1))
        return false;
    reference_scratch *r = w->reference;
    if (more) {
        free(r->sums);
        r->sums = NULL;
    }
    return MAKE(r->sums, chunks) && MAKE(r->light, MAX_RAYS) && MAKE(r->w, MAX_RAYS);
}

static bool make_counts(worker *w, size_t bins, bool more) {
    if (more) {
        free(w->picks->found_counts);
        w->picks->found_counts = NULL;
    }
    return MAKE(w->picks->found_counts, bins);
}

noc_status noc_cpu_prepare_scratch(cpu_view *s, const noc_plan *plan) {
    size_t lights = s->scene->lights.len, chunks = lights / REFERENCE_CHUNK + 1;
    uint32_t bins = noc_found_bins(lights);
    bool lists = plan->draws && plan->candidates == NOC_CANDIDATES_LISTS;
    bool found = has(plan, NOC_PASS_FIND_LIGHTS), items = has(plan, NOC_PASS_CANDIDATES_LIGHT_BVH);
    bool all = has(plan, NOC_PASS_SHADE_ALL);
    bool shared = has(plan, NOC_PASS_CANDIDATES_UNIFORM) || has(plan, NOC_PASS_CANDIDATES_POWER) || found;
    bool reuse = has(plan, NOC_PASS_TEMPORAL) || has(plan, NOC_PASS_SPATIAL), ok;
    bool more_bins = found && bins > s->found_bins, more_chunks = all && chunks > s->chunks;
    s->found_bins = more_bins ? bins : s->found_bins;
    s->chunks = more_chunks ? chunks : s->chunks;
    ok = (!shared || MAKE(s->samples, PRESAMPLES / BLOCK)) && (!found || MAKE(s->sample_volumes, PRESAMPLES / BLOCK));
    for (int i = 0; i < s->worker_count; i++) {
        worker *w = &s->workers[i];
        ok = ok && (!lists || make_lists(w)) && (!found || make_set(w)) && (!items || make_items(w));
        ok = ok && (!shared || MAKE(w->shares, 1));
        ok = ok && (!reuse || MAKE(w->combining, TILE_BLOCKS * TILE_BLOCKS));
        /* what grows goes first, for every thread: none is left with less than the others */
        bool counts = !found || !w->picks || make_counts(w, s->found_bins, more_bins);
        bool reference = !all || make_reference(w, s->chunks, more_chunks);
        ok = ok && counts && reference;
    }
    return ok ? NOC_OK
              : noc_error(s->log, NOC_ERR_MEMORY, "render: no memory for the scratch of %d threads among %zu lights",
                          s->worker_count, lights);
}

static void free_picks(pick_pass *p) {
    if (!p)
        return;
    free(p->drawn.light);
    free(p->drawn.inverse);
    free(p->set);
    noc_found_free(&p->found);
    free(p->found_counts);
    for (int i = 0; i < 2; i++) {
        free(p->items[i].pair);
        free(p->items[i].what);
        free(p->items[i].pmf);
    }
    free(p);
}

void noc_cpu_free_scratch(cpu_view *s) {
    for (int i = 0; i < s->worker_count; i++) {
        worker *w = &s->workers[i];
        free_picks(w->picks);
        free(w->lists); /* its observations went with the tiles */
        free(w->shares);
        free(w->combining);
        if (w->reference) {
            free(w->reference->sums);
            free(w->reference->light);
            free(w->reference->w);
        }
        free(w->reference);
        free(w->record.packets);
    }
    free(s->samples);
    s->samples = NULL;
    free(s->sample_volumes);
    s->sample_volumes = NULL;
    free(s->workers);
    s->workers = NULL;
    s->worker_count = 0;
}
