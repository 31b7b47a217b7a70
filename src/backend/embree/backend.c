/* The Embree backend: buffers, stages over tiles, the picture. */
#include "backend/embree/embree.h"

#include <stdio.h>

static void free_buffers(frame_buffers *b) {
    for (int i = 0; i < 2; i++)
        free(b->g[i]);
    for (int i = 0; i < NOC_RESERVOIR_SETS; i++) {
        free(b->r[i]);
        free(b->visible[i]);
    }
    free(b->colour);
    free(b->picture);
    free(b->emitter);
    noc_embree_free_coverage(&b->coverage);
    noc_embree_free_views(&b->views);
    *b = (frame_buffers){ 0 };
}

static void free_workers(embree_state *s) {
    for (int i = 0; i < s->worker_count; i++) {
        worker *w = &s->workers[i];
        free(w->combining);
        free(w->reference.sums);
        free(w->reference.light);
        free(w->reference.w);
        free(w->packets);
    }
    free(s->workers);
}

static void destroy(void *state) {
    embree_state *s = state;
    if (!s)
        return;
    noc_embree_release(s);
    noc_embree_release_lights(s);
    noc_embree_release_learning(s);
    free_buffers(&s->b);
    free_workers(s);
    noc_pool_destroy(s->pool);
    free(s);
}

static noc_status create_workers(embree_state *s) {
    s->worker_count = noc_pool_threads(s->pool);
    s->workers = noc_alloc_large((size_t)s->worker_count, sizeof(worker));
    bool ok = s->workers != NULL;
    if (!ok)
        s->worker_count = 0;
    size_t chunks = s->scene->lights.len / REFERENCE_CHUNK + 1;
    for (int i = 0; i < s->worker_count; i++) {
        worker *w = &s->workers[i];
        w->combining = noc_alloc_large(TILE_BLOCKS * TILE_BLOCKS, sizeof(*w->combining));
        w->reference.sums = noc_alloc_large(chunks, sizeof(*w->reference.sums));
        w->reference.light = noc_alloc_large(1024, sizeof(*w->reference.light));
        w->reference.w = noc_alloc_large(1024, sizeof(*w->reference.w));
        ok = ok && w->combining && w->reference.sums && w->reference.light && w->reference.w;
    }
    return ok ? NOC_OK : noc_error(s->log, NOC_ERR_MEMORY, "embree: no memory for %zu lights", s->scene->lights.len);
}

static noc_status create(const noc_scene *scene, const noc_renderer_params *params, noc_log *log, void **state) {
    embree_state *s = noc_calloc(1, sizeof(*s));
    if (!s || !(s->pool = noc_pool_create(params->threads))) {
        free(s);
        return noc_error(log, NOC_ERR_MEMORY, "embree: no memory for a renderer");
    }
    s->scene = scene;
    s->log = log;
    s->kernels = noc_pick_kernels(NOC_ISA_AUTO);
    noc_status status = create_workers(s);
    if (status == NOC_OK)
        status = noc_embree_build(s);
    if (status != NOC_OK) {
        destroy(s);
        return status;
    }
    *state = s;
    return NOC_OK;
}

static noc_status resize(void *state, int width, int height, int sets) {
    embree_state *s = state;
    frame_buffers *b = &s->b;
    free_buffers(b);
    noc_embree_release_learning(s);
    b->blocks_x = (width + BLOCK_SIDE - 1) / BLOCK_SIDE;
    b->blocks_y = (height + BLOCK_SIDE - 1) / BLOCK_SIDE;
    size_t blocks = (size_t)b->blocks_x * b->blocks_y;
    bool ok = true;
    for (int i = 0; i < 2 && ok; i++)
        ok = (b->g[i] = noc_alloc_large(blocks, sizeof(gblock))) != NULL;
    for (int i = 0; i < sets && ok; i++) {
        b->r[i] = noc_alloc_large(blocks, sizeof(rblock));
        b->visible[i] = noc_alloc_large(blocks, sizeof(uint16_t));
        ok = b->r[i] && b->visible[i];
    }
    ok = ok && (b->colour = noc_alloc_large(blocks, sizeof(cblock))) != NULL;
    ok = ok && (b->picture = noc_alloc_large(blocks, sizeof(cblock))) != NULL;
    ok = ok && (b->emitter = noc_alloc_large(blocks, sizeof(uint16_t))) != NULL;
    size_t bytes = blocks * (2 * sizeof(gblock) + (size_t)sets * (sizeof(rblock) + 2) + 2 * sizeof(cblock) + 2);
    if (!ok) {
        free_buffers(b);
        return noc_error(s->log, NOC_ERR_MEMORY, "render: no memory for a picture of %d x %d (%zu MB)", width, height,
                         bytes >> 20);
    }
    b->width = width;
    b->height = height;
    b->sets = sets;
    b->tiles_x = (b->blocks_x + TILE_BLOCKS - 1) / TILE_BLOCKS;
    b->tiles_y = (b->blocks_y + TILE_BLOCKS - 1) / TILE_BLOCKS;
    b->bytes = bytes;
    return NOC_OK;
}

static size_t bytes_a_pixel(int sets, uint32_t aovs) {
    return (2 * sizeof(gblock) + (size_t)sets * (sizeof(rblock) + 2) + 2 * sizeof(cblock) + 2) / BLOCK +
           noc_embree_view_bytes(aovs);
}

static void run_tile(void *arg, size_t item, int index) {
    stage_run *run = arg;
    embree_state *s = run->s;
    if (atomic_load_explicit(&run->cancelled, memory_order_relaxed))
        return;
    worker *w = &s->workers[index];
    const frame_buffers *b = &s->b;
    int tx = (int)(item % (size_t)b->tiles_x) * TILE_BLOCKS, ty = (int)(item / (size_t)b->tiles_x) * TILE_BLOCKS;
    tile t = { tx, ty, NOC_MIN(tx + TILE_BLOCKS, b->blocks_x), NOC_MIN(ty + TILE_BLOCKS, b->blocks_y) };
    double start = noc_wall_seconds();
    for (int pass = 0; pass < NOC_PASS_COUNT; pass++) {
        if (!(run->stage->passes >> pass & 1))
            continue;
        noc_embree_pass(run, w, (noc_pass)pass, t);
        double now = noc_wall_seconds();
        w->seconds[pass] += now - start;
        start = now;
    }
    size_t done = atomic_fetch_add(&run->done, 1) + 1;
    if (index == 0 && run->progress && run->progress->update &&
        !run->progress->update(run->progress->user, run->what, run->from + (run->to - run->from) * done / run->tiles))
        atomic_store(&run->cancelled, true);
}

static noc_status stage(void *state, const noc_frame *frame, const noc_stage *st, const noc_progress *progress,
                        double from, double to) {
    embree_state *s = state;
    s->kernels = noc_pick_kernels(frame->params->isa);
    noc_status status = noc_embree_follow_lights(s, frame->params);
    if (status == NOC_OK)
        status = noc_embree_prepare_lights(s, frame->params);
    if (status == NOC_OK)
        status = noc_embree_begin_views(s, frame->params->aovs, st->passes >> NOC_PASS_PRIMARY & 1);
    if (status != NOC_OK)
        return status;
    if (st->passes >> NOC_PASS_CANDIDATES & 1)
        noc_embree_forget_found(s);
    const noc_scene *scene = s->scene;
    stage_run run = { .s = s,
                      .ctx = { scene->lights.data, (uint32_t)scene->lights.len,
                               scene->material_records.len ? scene->material_records.data : &s->no_material, frame,
                               s->clusters, NULL, s->alias, s->tree, NULL, 0 },
                      .stage = st,
                      .k = s->kernels,
                      .progress = progress,
                      .what = "rendering",
                      .from = from,
                      .to = to,
                      .tiles = (size_t)s->b.tiles_x * s->b.tiles_y };
    if (st->passes >> NOC_PASS_SHADE & 1)
        s->shaded_set = st->target;
    run.ctx.influence = s->influence;
    run.ctx.stand_off = s->stand_off;
    if (st->passes >> NOC_PASS_CANDIDATES & 1 && (status = noc_embree_begin_learning(s, frame)) != NOC_OK)
        return status;
    /* Asked before too: the calling thread may get no tile of a small picture. */
    if (progress && progress->update && !progress->update(progress->user, run.what, from))
        return NOC_ERR_CANCELLED;
    for (int i = 0; i < s->worker_count; i++)
        s->workers[i].no_memory = false;
    noc_pool_run(s->pool, run.tiles, run_tile, &run);
    for (int i = 0; i < s->worker_count; i++)
        if (s->workers[i].no_memory)
            return noc_error(s->log, NOC_ERR_MEMORY, "render: no memory for the lights of a picture of %d x %d",
                             s->b.width, s->b.height);
    return atomic_load(&run.cancelled) ? NOC_ERR_CANCELLED : NOC_OK;
}

struct mean_run {
    frame_buffers *b;
    float share; /* of the new frame */
};

static void mean_row(void *arg, size_t row, int index) {
    const struct mean_run *run = arg;
    (void)index;
    size_t first = row * run->b->blocks_x;
    for (size_t i = first; i < first + run->b->blocks_x; i++) {
        float *mean = run->b->picture[i].rgb[0];
        const float *colour = run->b->colour[i].rgb[0];
        for (int k = 0; k < 3 * BLOCK; k++)
            mean[k] += (colour[k] - mean[k]) * run->share;
    }
}

static noc_status accumulate(void *state, const noc_frame *frame) {
    embree_state *s = state;
    noc_status status = noc_embree_make_coverage(s, frame);
    if (status != NOC_OK)
        return status;
    noc_embree_keep_views(s, frame);
    noc_embree_keep_coverage(s, frame);
    noc_embree_keep_lights(s);
    noc_embree_end_learning(s, frame);
    if (!frame->accumulated) {
        memcpy(s->b.picture, s->b.colour, (size_t)s->b.blocks_x * s->b.blocks_y * sizeof(cblock));
        return NOC_OK;
    }
    struct mean_run run = { &s->b, (float)(1.0 / (double)(frame->accumulated + 1)) };
    noc_pool_run(s->pool, (size_t)s->b.blocks_y, mean_row, &run);
    return NOC_OK;
}

static void read_picture(void *state, noc_image *image) {
    const frame_buffers *b = &((embree_state *)state)->b;
    for (int y = 0; y < b->height; y++)
        for (int x = 0; x < b->width; x++) {
            size_t at = (size_t)(y / BLOCK_SIDE) * b->blocks_x + x / BLOCK_SIDE, to = (size_t)y * b->width + x;
            int l = (y & 3) * 4 + (x & 3);
            for (int k = 0; k < 3; k++)
                image->rgb[3 * to + k] = b->picture[at].rgb[k][l];
            if (image->emitter)
                image->emitter[to] = noc_embree_saw_emitter(b, at, l);
            if (image->coverage)
                noc_embree_read_coverage(b, at, l, image->coverage + 4 * to);
        }
}

static void stats(void *state, noc_frame_stats *out) {
    embree_state *s = state;
    for (int i = 0; i < s->worker_count; i++) {
        worker *w = &s->workers[i];
        for (int pass = 0; pass < NOC_PASS_COUNT; pass++) {
            out->pass_seconds[pass] += w->seconds[pass];
            w->seconds[pass] = 0;
        }
        out->rays_primary += w->rays_primary;
        out->rays_shadow += w->rays_shadow;
        out->dropped += w->dropped;
        w->rays_primary = w->rays_shadow = w->dropped = 0;
    }
    out->build_seconds = s->build_seconds;
    out->memory_bytes = s->b.bytes + noc_embree_build_bytes(s) + noc_embree_light_bytes(s) + noc_embree_past_bytes(s) +
                        (size_t)s->b.blocks_x * s->b.blocks_y * BLOCK * noc_embree_view_bytes(s->b.views.asked);
    out->path = s->kernels->name;
}

static void forget_packets(embree_state *s) {
    for (int i = 0; i < s->worker_count; i++) {
        worker *w = &s->workers[i];
        free(w->packets);
        w->packets = NULL;
        w->packet_count = w->packet_room = 0;
        w->packets_lost = false;
    }
}

static void record(void *state, bool on) {
    embree_state *s = state;
    s->recording = on;
    if (on)
        forget_packets(s);
}

static noc_status replay(void *state, double *seconds) {
    embree_state *s = state;
    noc_status status = noc_embree_replay(s, seconds);
    forget_packets(s);
    return status;
}

const noc_backend noc_backend_embree = {
    .name = "embree",
    .create = create,
    .destroy = destroy,
    .bytes_a_pixel = bytes_a_pixel,
    .resize = resize,
    .stage = stage,
    .accumulate = accumulate,
    .read = read_picture,
    .aov = noc_embree_read_view,
    .stats = stats,
    .light_stats = noc_embree_light_stats,
    .influence = noc_embree_influence,
    .record = record,
    .replay = replay,
};
