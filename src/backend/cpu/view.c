/* A view: its buffers, the scratch of its threads, the picture that is read from it. */
#include "backend/cpu/cpu.h"
#include "core/presample_limits.h"

/* Buffers of a picture are pages of their own: what a frame never touches (surfaces before the first one, reservoirs
 * that nothing reads) costs none, and fresh ones need not be cleared. */
#define MAKE(p, blocks) (((p) = noc_alloc_pages((blocks) * sizeof(*(p)))) != NULL)
#define FREE(p, blocks) noc_free_pages(p, (blocks) * sizeof(*(p)))

static void free_buffers(frame_buffers *b) {
    size_t blocks = (size_t)b->blocks_x * b->blocks_y;
    for (int i = 0; i < 2; i++)
        FREE(b->g[i], blocks);
    for (int i = 0; i < NOC_RESERVOIR_SETS; i++) {
        FREE(b->r[i], blocks);
        FREE(b->visible[i], blocks);
    }
    FREE(b->colour, blocks);
    FREE(b->picture, blocks);
    FREE(b->emitter, blocks);
    free(b->instance);
    noc_coverage_free(&b->coverage);
    noc_views_free(&b->views);
    *b = (frame_buffers){ 0 };
}

static noc_status create_workers(cpu_view *s) {
    s->worker_count = noc_pool_threads(s->pool);
    s->workers = noc_alloc_large((size_t)s->worker_count, sizeof(worker));
    if (s->workers)
        return NOC_OK;
    s->worker_count = 0;
    return noc_no_memory(s->log, "view");
}

noc_status noc_cpu_fit_scene(cpu_view *s) {
    frame_buffers *b = &s->b;
    if (!s->scene->instances.len || b->instance)
        return NOC_OK;
    b->instance = noc_alloc_large((size_t)b->blocks_x * b->blocks_y, sizeof(*b->instance));
    if (!b->instance)
        return noc_error(s->log, NOC_ERR_MEMORY, "render: no memory for the instances of a picture of %d x %d",
                         b->width, b->height);
    memset(b->instance, 0xff, (size_t)b->blocks_x * b->blocks_y * sizeof(*b->instance));
    return NOC_OK;
}

void noc_cpu_view_destroy(void *state) {
    cpu_view *s = state;
    if (!s)
        return;
    noc_cpu_release_lights(s);
    noc_cpu_release_learning(s);
    free_buffers(&s->b);
    noc_cpu_free_scratch(s);
    free(s);
}

noc_status noc_cpu_view_create(void *world, void **state) {
    cpu_world *of = world;
    cpu_view *s = noc_calloc(1, sizeof(*s));
    if (!s)
        return noc_no_memory(of->log, "view");
    s->world = of;
    s->scene = of->scene;
    s->log = of->log;
    s->pool = of->device->pool;
    s->kernels = noc_pick_kernels(NOC_ISA_AUTO);
    noc_status status = create_workers(s);
    if (status != NOC_OK) {
        noc_cpu_view_destroy(s);
        return status;
    }
    *state = s;
    return NOC_OK;
}

static size_t bytes_a_block(int sets) {
    return 2 * sizeof(gblock) + (size_t)sets * (sizeof(rblock) + sizeof(uint16_t)) + 2 * sizeof(cblock) +
           sizeof(uint16_t);
}

static bool allocate_sets(frame_buffers *b, int sets) {
    size_t blocks = (size_t)b->blocks_x * b->blocks_y;
    for (; b->sets < sets; b->sets++)
        if (!MAKE(b->r[b->sets], blocks) || !MAKE(b->visible[b->sets], blocks))
            return false;
    return true;
}

static bool allocate_picture(frame_buffers *b) {
    size_t blocks = (size_t)b->blocks_x * b->blocks_y;
    return MAKE(b->g[0], blocks) && MAKE(b->g[1], blocks) && MAKE(b->colour, blocks) && MAKE(b->picture, blocks) &&
           MAKE(b->emitter, blocks);
}

noc_status noc_cpu_view_resize(void *state, int width, int height, int sets) {
    cpu_view *s = state;
    frame_buffers *b = &s->b;
    bool ok = true;
    if (b->width != width || b->height != height) {
        free_buffers(b);
        noc_cpu_release_tiles(s);
        b->blocks_x = (width + BLOCK_SIDE - 1) / BLOCK_SIDE;
        b->blocks_y = (height + BLOCK_SIDE - 1) / BLOCK_SIDE;
        b->tiles_x = (b->blocks_x + TILE_BLOCKS - 1) / TILE_BLOCKS;
        b->tiles_y = (b->blocks_y + TILE_BLOCKS - 1) / TILE_BLOCKS;
        b->width = width;
        b->height = height;
        ok = allocate_picture(b);
    }
    size_t bytes = (size_t)b->blocks_x * b->blocks_y * bytes_a_block(sets);
    if (!ok || !allocate_sets(b, sets)) {
        free_buffers(b);
        return noc_error(s->log, NOC_ERR_MEMORY, "render: no memory for a picture of %d x %d (%zu MB)", width, height,
                         bytes >> 20);
    }
    b->bytes = bytes;
    return NOC_OK;
}

size_t noc_cpu_bytes_a_pixel(int sets, uint32_t aovs) { return bytes_a_block(sets) / BLOCK + noc_views_bytes(aovs); }

noc_status noc_cpu_read(void *state, noc_image *image) {
    const frame_buffers *b = &((cpu_view *)state)->b;
    for (int y = 0; y < b->height; y++)
        for (int x = 0; x < b->width; x++) {
            size_t at = (size_t)(y / BLOCK_SIDE) * b->blocks_x + x / BLOCK_SIDE, to = (size_t)y * b->width + x;
            int l = (y & 3) * 4 + (x & 3);
            for (int k = 0; k < 3; k++)
                image->rgb[3 * to + k] = b->picture[at].rgb[k][l];
            if (image->emitter)
                image->emitter[to] = noc_coverage_saw(&b->coverage, at, l);
            if (image->coverage)
                noc_coverage_read(&b->coverage, at, l, image->coverage + 4 * to);
        }
    return NOC_OK;
}

noc_frame_blocks noc_cpu_blocks(const cpu_view *s, int gbuffer) {
    const frame_buffers *b = &s->b;
    return (noc_frame_blocks){ .scene = s->scene,
                               .pool = s->pool,
                               .width = b->width,
                               .height = b->height,
                               .blocks_x = b->blocks_x,
                               .blocks_y = b->blocks_y,
                               .g = b->g[gbuffer],
                               .r = b->r[s->shaded_set],
                               .colour = b->colour,
                               .picture = b->picture,
                               .instance = (const uint32_t(*)[BLOCK])b->instance,
                               .emitter = b->coverage.seen,
                               .past = &s->past,
                               .placings = &s->world->placings };
}

noc_status noc_cpu_read_aov(void *state, noc_aov aov, float *value) {
    const cpu_view *s = state;
    noc_frame_blocks b = noc_cpu_blocks(s, s->b.kept);
    return noc_views_read(&s->b.views, &b, aov, value) ? NOC_OK : NOC_ERR_ARGUMENT;
}

void noc_cpu_rows(void *state, const frame_camera *camera, const noc_frame_rows *rows) {
    const cpu_view *s = state;
    noc_frame_blocks b = noc_cpu_blocks(s, s->b.kept);
    noc_views_rows(&s->b.views, &b, camera, rows);
}

void noc_cpu_stats(void *state, noc_frame_stats *out) {
    cpu_view *s = state;
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
    out->build_seconds = s->world->build_seconds;
    size_t blocks = (size_t)s->b.blocks_x * s->b.blocks_y;
    out->picture_bytes = s->b.bytes + (s->b.instance ? blocks * sizeof(*s->b.instance) : 0) +
                         blocks * BLOCK * noc_views_bytes(s->b.views.asked | s->b.views.held);
    out->structure_bytes = noc_cpu_rays_bytes(s->world);
    out->learned_bytes = s->learned ? s->learned->count * sizeof(*s->learned->cells) : 0;
    out->memory_bytes = out->picture_bytes + out->structure_bytes + out->learned_bytes + noc_cpu_light_bytes(s->world) +
                        noc_cpu_past_bytes(s) + s->b.views.emitter_label_count * sizeof(*s->b.views.emitter_labels) +
                        (s->samples ? PRESAMPLES / BLOCK * sizeof(*s->samples) : 0) +
                        (s->sample_volumes ? PRESAMPLES / BLOCK * sizeof(*s->sample_volumes) : 0);
    out->path = s->kernels->name;
}

static void forget_packets(cpu_view *s) {
    for (int i = 0; i < s->worker_count; i++) {
        worker *w = &s->workers[i];
        free(w->record.packets);
        w->record.packets = NULL;
        w->record.count = w->record.room = 0;
        w->record.lost = false;
    }
}

void noc_cpu_record(void *state, bool on) {
    cpu_view *s = state;
    s->recording = on;
    if (on)
        forget_packets(s);
}

noc_status noc_cpu_replay(void *state, const noc_progress *progress, noc_trace_floor *floor) {
    cpu_view *s = state;
    noc_status status = floor ? noc_cpu_replay_rays(s, progress, floor) : NOC_OK;
    forget_packets(s);
    return status;
}
