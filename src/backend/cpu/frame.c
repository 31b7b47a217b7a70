/* The stages of a frame over tiles, and the mean over frames. */
#include "backend/cpu/cpu.h"
#include "core/moments.h"

static void run_tile(void *arg, size_t item, int index) {
    stage_run *run = arg;
    cpu_view *s = run->s;
    if (atomic_load_explicit(&run->cancelled, memory_order_relaxed))
        return;
    worker *w = &s->workers[index];
    const frame_buffers *b = &s->b;
    int tx = (int)(item % (size_t)b->tiles_x) * TILE_BLOCKS, ty = (int)(item / (size_t)b->tiles_x) * TILE_BLOCKS;
    tile t = { tx, ty, NOC_MIN(tx + TILE_BLOCKS, b->blocks_x), NOC_MIN(ty + TILE_BLOCKS, b->blocks_y) };
    double start = noc_wall_seconds();
    for (int i = 0; i < run->stage->count; i++) {
        noc_pass pass = run->stage->passes[i];
        noc_cpu_pass(run, w, pass, t);
        double now = noc_wall_seconds();
        w->seconds[pass] += now - start;
        start = now;
    }
    size_t done = atomic_fetch_add(&run->done, 1) + 1;
    if (index == 0 && run->progress && run->progress->update &&
        !run->progress->update(run->progress->user, run->what, run->from + (run->to - run->from) * done / run->tiles))
        atomic_store(&run->cancelled, true);
}

static struct core_context context_of(const cpu_view *s, const noc_frame *frame) {
    const noc_scene *scene = s->scene;
    const noc_light_sources *from = &s->sources;
    return (struct core_context){ .lights = scene->lights.data,
                                  .light_count = (uint32_t)scene->lights.len,
                                  .profiles = scene->profile_cells.data,
                                  .materials = scene->material_records.len ? scene->material_records.data
                                                                           : &s->world->no_material,
                                  .texels = scene->texels.len ? scene->texels.data : NULL,
                                  .frame = &frame->constants,
                                  .clusters = { from->clusters[NOC_STANDING], from->clusters[NOC_MOVING] },
                                  .alias = from->alias,
                                  .tree = from->tree,
                                  .influence = from->influence,
                                  .environment = scene->environment,
                                  .map_light = s->map_light,
                                  .ray_offset = s->world->scale.offset };
}

/* What the passes of all stages find ready; the scene does not change until the frame is through. */
static noc_status begin_frame(cpu_view *s, const noc_frame *frame) {
    s->kernels = noc_pick_kernels(frame->params->isa);
    noc_status status = noc_cpu_follow(s->world);
    if (status == NOC_OK)
        status = noc_cpu_begin_past(s, frame->plan);
    if (status == NOC_OK)
        status = noc_cpu_fit_scene(s);
    if (status == NOC_OK)
        status = noc_cpu_prepare_scratch(s, frame->plan);
    if (status == NOC_OK)
        status = noc_cpu_prepare_lights(s, frame->plan, frame->params);
    if (status == NOC_OK && frame->constants.flags & FRAME_MAP_LIGHTS)
        status = noc_light_set_map(s->world->lights, &s->map_light);
    if (status == NOC_OK) {
        noc_frame_blocks b = noc_cpu_blocks(s, frame->gbuffer);
        status = noc_views_begin(&s->b.views, s->scene, &b, frame->params->aovs, s->log);
    }
    if (status == NOC_OK)
        noc_cpu_forget_found(s);
    return status == NOC_OK ? noc_cpu_begin_learning(s, frame) : status;
}

noc_status noc_cpu_stage(void *state, const noc_frame *frame, const noc_stage *st, const noc_progress *progress,
                         double from, double to) {
    cpu_view *s = state;
    noc_status status = st == &frame->plan->stages[0] ? begin_frame(s, frame) : NOC_OK;
    if (status != NOC_OK)
        return status;
    stage_run run = { .s = s,
                      .frame = frame,
                      .ctx = context_of(s, frame),
                      .stage = st,
                      .k = s->kernels,
                      .progress = progress,
                      .what = "rendering",
                      .from = from,
                      .to = to,
                      .tiles = (size_t)s->b.tiles_x * s->b.tiles_y };
    s->shaded_set = st->target;
    /* Asked before too: the calling thread may get no tile of a small picture. */
    if (progress && progress->update && !progress->update(progress->user, run.what, from))
        return NOC_ERR_CANCELLED;
    for (int i = 0; i < s->worker_count; i++)
        s->workers[i].no_memory = false;
    if (st == &frame->plan->stages[0])
        noc_cpu_presample(&run);
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
            mean[k] = mean_add(mean[k], colour[k], run->share);
    }
}

noc_status noc_cpu_accumulate(void *state, const noc_frame *frame) {
    cpu_view *s = state;
    frame_buffers *b = &s->b;
    size_t count = (size_t)b->blocks_x * (size_t)b->blocks_y;
    if (!noc_coverage_reserve(&b->coverage, b->emitter, count, frame->accumulated))
        return noc_error(s->log, NOC_ERR_MEMORY, "render: no memory for the emitters in a picture of %d x %d", b->width,
                         b->height);
    noc_frame_blocks blocks = noc_cpu_blocks(s, frame->gbuffer);
    noc_views_keep(&b->views, &blocks, frame);
    noc_coverage_keep(&b->coverage, b->emitter, blocks.g, b->colour, count, frame->accumulated);
    b->kept = frame->gbuffer;
    noc_cpu_keep_past(s);
    noc_cpu_end_learning(s, frame);
    if (!frame->accumulated) {
        memcpy(s->b.picture, s->b.colour, (size_t)s->b.blocks_x * s->b.blocks_y * sizeof(cblock));
        return NOC_OK;
    }
    struct mean_run run = { &s->b, (float)(1.0 / (double)(frame->accumulated + 1)) };
    noc_pool_run(s->pool, (size_t)s->b.blocks_y, mean_row, &run);
    return NOC_OK;
}
