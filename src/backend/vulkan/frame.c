/* A frame as one command buffer: stages are recorded as their steps (schedule.h), and the frame is submitted when it is
 * complete. A frame that is dropped before that leaves nothing behind but what followed the scene. Two frames of a view
 * may be in flight; figures are those of the last finished one. */
#include "backend/vulkan/influence_memory.h"
#include "backend/vulkan/list_memory.h"
#include "backend/vulkan/vulkan.h"

/* ---- flights ---- */

static void take_counts(vk_view *v, vk_flight *f) {
    const uint32_t(*counts)[VK_COUNTERS] = f->counts.mapped;
    uint64_t sums[VK_COUNT_KINDS] = { 0 };
    for (int kind = 0; kind < VK_COUNT_KINDS; kind++)
        for (int i = 0; i < VK_COUNTERS; i++)
            sums[kind] += counts[kind][i];
    f->found.rays_shadow = sums[VK_COUNT_RAYS];
    f->found.dropped = v->stats.dropped + sums[VK_COUNT_DROPPED];
    v->stats = f->found;
    if (sums[VK_COUNT_UNLISTED] && !v->crowded) {
        v->crowded = true;
        noc_warn(v->log,
                 "vulkan: there is no room for the lights that reach %llu places of a picture of %d x %d: there "
                 "candidates come from all lights, and it is noisier than it could be",
                 (unsigned long long)sums[VK_COUNT_UNLISTED], v->b.width, v->b.height);
    }
    if (sums[VK_COUNT_UNLEARNED] && !v->learning.told) {
        v->learning.told = true;
        noc_warn(v->log,
                 "vulkan: there is no room to learn the lights' visibility in all of a picture of %d x %d: it is "
                 "noisier than it could be",
                 v->b.width, v->b.height);
    }
}

/* Waits for a frame, and adds up what it counted. */
static noc_status finish(vk_view *v, vk_flight *f) {
    if (!f->pending)
        return NOC_OK;
    f->pending = false;
    VkResult result = vkWaitForFences(v->device->device, 1, &f->fence, VK_TRUE, UINT64_MAX);
    if (result != VK_SUCCESS)
        return noc_vk_failed(v->device, result, "rendering");
    noc_vk_note_frame(v, noc_vk_take_times(v, f));
    take_counts(v, f);
    return NOC_OK;
}

noc_status noc_vk_finish_flights(vk_view *v) {
    noc_status status = NOC_OK;
    for (int i = 0; i < VK_FRAMES; i++) { /* the older one first */
        noc_status one = finish(v, &v->flights[(v->flight + i) % VK_FRAMES]);
        status = status == NOC_OK ? one : status;
    }
    return status;
}

/* ---- what steps read ---- */

/* Levels of the deeper hierarchy of clusters. */
static int cluster_levels(const noc_light_sources *s) {
    int levels = 0;
    for (int i = 0; i < NOC_HALVES; i++)
        levels = NOC_MAX(levels, s->clusters[i] ? s->clusters[i]->levels : 0);
    return levels;
}

static uint32_t tile_words(const vk_view *v, const noc_plan *plan) {
    return plan->candidates == NOC_CANDIDATES_INFLUENCE ? FOUND_WORDS : noc_vk_tile_words(cluster_levels(&v->sources));
}

static vk_facts facts_of(const vk_view *v, const noc_frame *frame) {
    return (vk_facts){ .constants = &frame->constants,
                       .history = frame->constants.flags & FRAME_HISTORY && !v->past.lost,
                       .past = noc_past_other_shape(&v->past, v->scene),
                       .given = frame->receivers != NULL,
                       .views = v->views.bits != 0,
                       .panes = v->scene->lets_through,
                       .lights = (uint32_t)v->scene->lights.len,
                       .blocks_x = v->b.blocks_x,
                       .blocks_y = v->b.blocks_y,
                       .tile_words = tile_words(v, frame->plan),
                       .band_bytes = v->device->band_bytes,
                       .sky = frame->params->sky > 0 || frame->constants.flags & FRAME_MAP_LIGHTS };
}

/* The addresses that are the same for all steps of a frame. */
static vk_binding common_binding(const vk_view *v, const noc_frame *frame) {
    const vk_world *w = v->world;
    const vk_picture *b = &v->b;
    const vk_learning *l = &v->learning;
    bool all = frame->accumulated == 0;
    return (vk_binding){
        .frame = v->flights[v->flight].constants.address,
        .lights = w->lights.buffer.address,
        .past_lights = noc_past_other_lights(&v->past, v->scene) ? v->past_lights.address : w->lights.buffer.address,
        .materials = w->materials.buffer.address,
        .profiles = w->profiles.buffer.address,
        .texels = w->texels.buffer.address,
        .indices = w->indices.buffer.address,
        .positions = w->positions.buffer.address,
        .triangle_material = w->triangle_material.buffer.address,
        .triangle_light = w->triangle_light.buffer.address,
        .triangle_facade = w->triangle_facade.buffer.address,
        .facades = w->facades.buffer.address,
        .facade_cells = w->facade_cells.buffer.address,
        .image_places = w->image_places.buffer.address,
        .image_corners = w->image_corners.buffer.address,
        .panes = w->panes.buffer.address,
        .instances = w->instances.buffer.address,
        .backs = w->backs.buffer.address,
        .instance_lights = w->instance_lights.buffer.address,
        .entries = w->structure.entries.address,
        .alias = w->alias.buffer.address,
        .tree = w->tree.buffer.address,
        .environment = w->environment.buffer.address,
        .backdrop = w->backdrop.buffer.address,
        .environment_slots = w->environment_slots.buffer.address,
        .environment_sines = w->environment_sines.buffer.address,
        .given = v->given.address,
        .surfaces = b->surfaces[frame->gbuffer].address,
        .previous = b->surfaces[frame->previous_gbuffer].address,
        .instance = b->instance.address,
        .colour = b->colour.address,
        .picture = b->picture.address,
        .coverage = b->coverage.address,
        .rays = b->rays.address,
        .answers = b->answers.address,
        .through = b->through.address,
        .hits = b->hits.address,
        .samples = v->samples.address,
        .scratch = v->scratch.address,
        .clusters = w->clusters.buffer.address,
        .volumes = w->volumes.buffer.address,
        .found = v->found.address,
        .learned = l->cache.address,
        .observed = l->observed.address,
        .block_bright = l->bright.address,
        .counters = v->counters.address,
        .view_rays = v->views.gathered[NOC_AOV_RAYS].address,
        .view_lights = v->views.gathered[NOC_AOV_LIGHTS].address,
        .view_density = v->views.gathered[NOC_AOV_DENSITY].address,
        .view_lux = v->views.gathered[NOC_AOV_ILLUMINANCE].address,
        .view_group = v->views.gathered[NOC_AOV_GROUP].address,
        .view_placed = v->views.gathered[NOC_AOV_PLACED].address,
        .view_expected = v->views.gathered[NOC_AOV_EXPECTED].address,
        .view_emitters = v->views.gathered[NOC_AOV_INFLUENTIAL].address,
        .emitter_labels = v->views.labels.address,
        .view_triangles = v->views.triangles.address,
        .views = v->views.bits,
        .light_colours = v->views.of.light_colours,
        .by_power = frame->plan->candidates == NOC_CANDIDATES_POWER,
        .light_count = (uint32_t)v->scene->lights.len,
        .triangle_count = (uint32_t)v->scene->triangle_light.len,
        .facade_triangles = (uint32_t)v->scene->triangle_facade.len,
        .textured = v->scene->texels.len > 0 && v->scene->uv.len > 0,
        .weakens = v->scene->lets_through,
        .instanced = b->instance.bytes > 0,
        .moved = b->instance.bytes > 0 && noc_past_other_shape(&v->past, v->scene),
        .blocks_y = b->blocks_y,
        .draws = (uint32_t)frame->plan->candidate_count,
        .subsets = v->subsets,
        .subset_rows = v->subset_rows,
        .tree_root = v->sources.tree ? v->sources.tree->root : 0,
        .tree_depth = v->sources.tree ? (uint32_t)v->sources.tree->depth : 0,
        .sky_turns = facts_of(v, frame).sky ? SKY_RAYS : 0,
        .alias_count = v->sources.alias ? v->sources.alias->count : 0,
        .fresh = all,
        .share = all ? 1 : (float)(1.0 / (double)(frame->accumulated + 1)),
        .ray_offset = w->scale.offset,
        .tiles_x = noc_vk_tiles(b->blocks_x),
        .tile_words = facts_of(v, frame).tile_words,
        .list_flags = (frame->plan->learns ? LIST_LEARNS : 0) | (frame->plan->mixes ? LIST_MIXES : 0) |
                      (frame->plan->shares_rays ? LIST_SHARES : 0) |
                      (noc_stage_has(&frame->plan->stages[0], NOC_PASS_SEEN_BEFORE) ? LIST_FRESH : 0),
        .found_bins = v->found_bins,
        .list_room = l->room,
        .observed_rows = l->rows,
        .cells = l->cells,
        .learn_time = l->next_time,
    };
}

/* ---- a frame ---- */

/* Rows of candidates that are drawn before the frame, from all lights. */
static uint32_t shared_rows(const noc_frame *frame) {
    const noc_plan *plan = frame->plan;
    uint32_t m = plan->draws ? (uint32_t)plan->candidate_count : 0;
    switch (plan->candidates) {
    case NOC_CANDIDATES_UNIFORM:
    case NOC_CANDIDATES_POWER: return m;
    case NOC_CANDIDATES_INFLUENCE: return m - influence_listed(m, frame->constants.uniform_every);
    default: return 0;
    }
}

/* What the frame's candidates are drawn from. */
static noc_status get_sources(vk_view *v, const noc_frame *frame) {
    v->draws = frame->plan->draws;
    v->drawn = (noc_light_stats){ .candidates = v->draws ? frame->plan->candidates : (noc_candidates)0 };
    if (!v->draws) {
        noc_light_set_release(v->world->lights_set, &v->sources);
        return NOC_OK;
    }
    return frame->plan->candidates == NOC_CANDIDATES_INFLUENCE
               ? noc_vk_get_influence(v, frame)
               : noc_light_set_get(v->world->lights_set, frame->plan->candidates, frame->params, &v->sources);
}

/* Room for the rays of the plan's steps, and for scratch. Adds the seconds that they will take to *expected. */
static noc_status fit_buffers(vk_view *v, const noc_frame *frame, double *expected) {
    vk_facts facts = facts_of(v, frame);
    size_t rays = 0;
    for (int i = 0; i < frame->plan->count; i++) {
        v->steps.len = 0;
        if (!noc_vk_schedule(frame->plan, &frame->plan->stages[i], &facts, &v->steps))
            return noc_no_memory(v->log, "render");
        rays = NOC_MAX(rays, noc_vk_ray_room(&v->steps, &facts));
        for (size_t k = 0; k < v->steps.len; k++)
            *expected += noc_vk_expected_seconds(v, &v->steps.data[k]);
    }
    noc_status status = noc_vk_view_fit(v, rays, noc_vk_scratch_bytes(frame->plan, &facts));
    return status == NOC_OK && frame->plan->learns ? noc_vk_view_fit_learning(v, &frame->constants) : status;
}

static noc_status upload_receivers(vk_view *v, const noc_frame *frame) {
    size_t bytes = (size_t)v->b.width * (size_t)v->b.height * sizeof(*frame->receivers);
    noc_status status = NOC_OK;
    if (v->given.bytes < bytes) {
        status = noc_vk_finish_flights(v);
        noc_vk_free_buffer(v->device, &v->given);
        if (status == NOC_OK)
            status = noc_vk_make_buffer(v->device, bytes, 0, VK_PLACE_DEVICE, "receivers", &v->given);
    }
    if (status == NOC_OK)
        status = noc_vk_write(v->device, &v->given, 0, frame->receivers, bytes);
    return status == NOC_OK ? noc_vk_submit_upload(v->device) : status;
}

/* What the frame needs of the world and of the view, before anything is recorded. */
static noc_status prepare(vk_view *v, const noc_frame *frame, double *expected) {
    noc_status status = finish(v, &v->flights[v->flight]);
    if (status == NOC_OK)
        status = noc_vk_world_follow(v->world, v->pace.progress);
    if (status == NOC_OK)
        status = noc_vk_view_begin_past(v, frame->plan);
    if (status == NOC_OK)
        status = get_sources(v, frame);
    v->map_light = NULL;
    if (status == NOC_OK && frame->constants.flags & FRAME_MAP_LIGHTS)
        status = noc_light_set_map(v->world->lights_set, &v->map_light);
    if (status == NOC_OK)
        status = noc_vk_world_fill_sources(v->world, &v->sources, v->map_light);
    if (status == NOC_OK)
        status = fit_buffers(v, frame, expected);
    if (status == NOC_OK && frame->receivers)
        status = upload_receivers(v, frame);
    if (status == NOC_OK)
        status = noc_vk_begin_views(v, frame->params->aovs);
    uint32_t rows = shared_rows(frame);
    return status == NOC_OK && rows ? noc_vk_view_fit_samples(v, rows) : status;
}

static noc_status begin(vk_view *v, const noc_frame *frame) {
    vk_flight *f = &v->flights[v->flight];
    double expected = 0;
    noc_status status = prepare(v, frame, &expected);
    if (status != NOC_OK)
        return status;
    noc_vk_begin_pace(v, expected);
    if (v->pace.on && (status = noc_vk_wait_idle(v->device)) != NOC_OK) /* pieces are timed */
        return status;
    VkResult result = noc_vk_begin_commands(f);
    if (result != VK_SUCCESS)
        return noc_vk_failed(v->device, result, "recording a frame");
    memcpy(f->constants.mapped, &frame->constants, sizeof(frame->constants));
    f->steps = 0;
    f->found =
        (noc_frame_stats){ .rays_primary = frame->receivers || !noc_stage_has(&frame->plan->stages[0], NOC_PASS_PRIMARY)
                                               ? 0
                                               : (uint64_t)v->b.width * (uint64_t)v->b.height };
    v->hazards = (vk_hazards){ 0 };
    vkCmdFillBuffer(f->commands, v->counters.buffer, 0, VK_WHOLE_SIZE, 0);
    noc_vk_clear_views(v, f->commands);
    noc_vk_clear_found(v, f->commands);
    if (frame->plan->learns)
        noc_vk_begin_learning(v, frame->epoch, f->commands);
    noc_vk_barrier(f->commands);
    noc_vk_start_times(v->device, f);
    return NOC_OK;
}

/* Drops the frame that is being recorded. */
static noc_status drop(vk_view *v, noc_status status) {
    v->open = false;
    pthread_mutex_unlock(&v->device->lock);
    return status;
}

noc_status noc_vk_stage(void *view, const noc_frame *frame, const noc_stage *stage, const noc_progress *progress,
                        double from, double to) {
    vk_view *v = view;
    noc_status status = NOC_OK;
    v->pace.progress = progress;
    v->pace.done = from;
    if (stage == &frame->plan->stages[0]) {
        if ((status = noc_vk_enter(v->device)) != NOC_OK)
            return status;
        v->open = true;
        status = begin(v, frame);
    }
    if (status == NOC_OK && !noc_vk_may_go_on(v))
        status = NOC_ERR_CANCELLED;
    if (status == NOC_OK) {
        vk_facts facts = facts_of(v, frame);
        vk_binding common = common_binding(v, frame);
        v->steps.len = 0;
        status = noc_vk_schedule(frame->plan, stage, &facts, &v->steps) ? noc_vk_record_steps(v, &common, from, to)
                                                                        : noc_no_memory(v->log, "render");
    }
    return status == NOC_OK ? status : drop(v, status);
}

/* The frame's reservoirs were made with the lights as they are. */
static void keep_lights(vk_view *v) {
    noc_range r = noc_past_keep(&v->past, v->scene);
    VkBufferCopy copy = { .srcOffset = r.first * sizeof(light_record),
                          .dstOffset = r.first * sizeof(light_record),
                          .size = (r.end - r.first) * sizeof(light_record) };
    if (r.first < r.end)
        vkCmdCopyBuffer(v->flights[v->flight].commands, v->world->lights.buffer.buffer, v->past_lights.buffer, 1,
                        &copy);
}

static noc_status submit(vk_view *v) {
    vk_device *d = v->device;
    vk_flight *f = &v->flights[v->flight];
    VkBufferCopy copy = { .size = f->counts.bytes };
    noc_vk_barrier(f->commands);
    keep_lights(v);
    vkCmdCopyBuffer(f->commands, v->counters.buffer, f->counts.buffer, 1, &copy);
    VkResult result = noc_vk_submit_commands(d, f);
    if (result != VK_SUCCESS)
        return noc_vk_failed(d, result, "rendering");
    f->pending = true;
    v->flight = (v->flight + 1) % VK_FRAMES;
    return NOC_OK;
}

noc_status noc_vk_accumulate(void *view, const noc_frame *frame) {
    vk_view *v = view;
    vk_facts facts = facts_of(v, frame);
    vk_binding common = common_binding(v, frame);
    noc_past past = v->past;
    noc_status status = NOC_OK;
    v->steps.len = 0;
    v->pace.on = false; /* what follows is short, and changes the mean */
    status = noc_vk_schedule_mean(frame->plan, &facts, &v->steps) ? noc_vk_record_steps(v, &common, 1, 1)
                                                                  : noc_no_memory(v->log, "render");
    if (status == NOC_OK && (status = submit(v)) != NOC_OK)
        v->past = past;
    if (status == NOC_OK)
        status = noc_vk_keep_views(v, frame, &past);
    if (status == NOC_OK && frame->plan->learns)
        noc_vk_end_learning(v);
    if (status == NOC_OK)
        status = noc_vk_note_mean(v, frame->accumulated + 1);
    return drop(v, status);
}

void noc_vk_light_stats(void *view, noc_light_stats *out) {
    const vk_view *v = view;
    *out = v->drawn;
    out->lights = v->scene->lights.len;
    out->scene_bytes = noc_vk_world_bytes(v->world);
    if (v->draws && out->candidates == NOC_CANDIDATES_INFLUENCE)
        noc_vk_note_found(view, out);
    if (!v->draws || out->candidates == NOC_CANDIDATES_INFLUENCE)
        return;
    out->build_seconds = noc_light_set_seconds(v->world->lights_set, out->candidates);
    out->bytes = noc_light_set_bytes(v->world->lights_set, out->candidates);
}

bool noc_vk_finish(void *view) {
    vk_view *v = view;
    bool pending = false;
    for (int i = 0; i < VK_FRAMES; i++)
        pending = pending || v->flights[i].pending;
    if (!pending)
        return false;
    pthread_mutex_lock(&v->device->lock);
    noc_vk_finish_flights(v);
    pthread_mutex_unlock(&v->device->lock);
    return true;
}

void noc_vk_stats(void *view, noc_frame_stats *out) {
    vk_view *v = view;
    const vk_device *d = v->device;
    for (int i = 0; i < NOC_PASS_COUNT; i++)
        out->pass_seconds[i] += v->stats.pass_seconds[i];
    out->rays_primary += v->stats.rays_primary;
    out->rays_shadow += v->stats.rays_shadow;
    out->dropped += v->stats.dropped;
    v->stats.dropped = 0;
    out->build_seconds = v->world->build_seconds;
    out->compile_seconds = d->compile_seconds;
    out->compile_cpu_seconds = d->compile_cpu_seconds;
    out->picture_bytes = v->b.bytes + (size_t)v->b.blocks_x * v->b.blocks_y * BLOCK *
                                          noc_vk_views_bytes(v->views.of.asked | v->views.of.held);
    out->structure_bytes = noc_vk_structure_bytes(v->world);
    out->memory_bytes = d->bytes;
    out->path = "vulkan";
}
