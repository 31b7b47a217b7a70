/* A frame as one command buffer: stages are recorded as their steps (schedule.h), and the frame is submitted when it is
 * complete. A frame that is dropped before that leaves nothing behind but what followed the scene. Two frames of a view
 * may be in flight; figures are those of the last finished one. */
#include "backend/vulkan/influence_memory.h"
#include "backend/vulkan/list_memory.h"
#include "backend/vulkan/schedule.h"
#include "backend/vulkan/vulkan.h"
#include "core/learned.h"

enum { GROUP = 64 }; /* invocations of a work group over pixels: four blocks in a row */

/* ---- flights ---- */

static void take_times(vk_view *v, vk_flight *f) {
    uint64_t times[VK_STEPS + 1];
    if (!f->times_count ||
        vkGetQueryPoolResults(v->device->device, f->times, 0, (uint32_t)f->times_count + 1, sizeof(times), times,
                              sizeof(*times), VK_QUERY_RESULT_64_BIT) != VK_SUCCESS)
        return;
    for (int i = 0; i < f->times_count; i++)
        if (f->timed[i] < NOC_PASS_COUNT)
            f->found.pass_seconds[f->timed[i]] +=
                (double)((times[i + 1] - times[i]) & v->device->tick_mask) * v->device->tick;
}

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
    take_times(v, f);
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

/* ---- recording ---- */

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
                       .list_bytes = v->device->list_bytes,
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
        .view_emitters = v->views.gathered[NOC_AOV_INFLUENTIAL].address,
        .emitter_labels = v->views.labels.address,
        .view_triangles = v->views.triangles.address,
        .views = v->views.bits,
        .light_colours = v->views.of.light_colours,
        .by_power = frame->plan->candidates == NOC_CANDIDATES_POWER,
        .light_count = (uint32_t)v->scene->lights.len,
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

static void mark_time(vk_view *v, noc_pass pass) {
    vk_flight *f = &v->flights[v->flight];
    if (!v->device->tick_mask || f->times_count >= VK_STEPS)
        return;
    f->timed[f->times_count++] = pass;
    vkCmdWriteTimestamp(f->commands, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, f->times, (uint32_t)f->times_count);
}

/* So many invocations, in a plane of work groups: a row has room for 65,535 of these at least. */
static void dispatch_many(VkCommandBuffer commands, uint32_t invocations) {
    uint32_t groups = (invocations + GROUP - 1) / GROUP, wide = NOC_MIN(groups, 1024u);
    vkCmdDispatch(commands, wide, (groups + wide - 1) / wide, 1);
}

static void dispatch(vk_view *v, const vk_step *step, const vk_pipeline *p) {
    const vk_picture *b = &v->b;
    uint32_t rows = step->rows ? step->rows : b->blocks_y;
    VkCommandBuffer commands = v->flights[v->flight].commands;
    static const VkStridedDeviceAddressRegionKHR none = { 0 };
    switch (step->domain) {
    case VK_DOMAIN_PIXELS: vkCmdDispatch(commands, (b->blocks_x * BLOCK + GROUP - 1) / GROUP, rows, 1); break;
    case VK_DOMAIN_LAYERS:
        vkCmdDispatch(commands, (b->blocks_x * BLOCK + GROUP - 1) / GROUP, rows, (uint32_t)step->slots);
        break;
    case VK_DOMAIN_TILES: vkCmdDispatch(commands, noc_vk_tiles(b->blocks_x), noc_vk_tiles(rows), 1); break;
    case VK_DOMAIN_BLOCKS: {
        uint32_t blocks = v->device->constants.share_workers / BLOCK;
        vkCmdDispatch(commands, (b->blocks_x + blocks - 1) / blocks, rows, 1);
        break;
    }
    case VK_DOMAIN_ROWS: dispatch_many(commands, v->learning.rows); break;
    case VK_DOMAIN_RUNS: dispatch_many(commands, v->learning.cells / CELL_RUN * 16); break;
    case VK_DOMAIN_ONE: vkCmdDispatch(commands, 1, 1, 1); break;
    case VK_DOMAIN_SUBSETS: vkCmdDispatch(commands, v->subsets, 1, 1); break;
    case VK_DOMAIN_RAYS:
        vkCmdTraceRaysKHR(commands, &p->raygen, &p->miss, &p->hit, &none, b->blocks_x * BLOCK, rows,
                          (uint32_t)step->slots);
        break;
    }
}

/* Records a step over rays that common->rays and common->answers lead to. */
static noc_status record_step(vk_view *v, const vk_step *step, const vk_binding *common) {
    vk_flight *f = &v->flights[v->flight];
    const vk_structure *s = &v->world->structure;
    const vk_pipeline *p;
    noc_status status = noc_vk_pipeline(v->device, step->shader, &p);
    if (status != NOC_OK)
        return status;
    VkDeviceSize at = VK_CONSTANTS_BYTES + (VkDeviceSize)f->steps++ * sizeof(vk_binding);
    vk_binding *b = (vk_binding *)(void *)((char *)f->constants.mapped + at);
    *b = *common;
    b->source = v->b.reservoirs[step->source].address;
    b->target = v->b.reservoirs[step->target].address;
    b->source_visible = v->b.visible[step->source].address;
    b->target_visible = v->b.visible[step->target].address;
    b->dimension = step->dimension;
    b->first = step->first;
    bool traces = step->domain == VK_DOMAIN_RAYS;
    b->first_row = traces && step->band ? 0 : step->first_row;
    b->rows = step->rows ? step->rows : v->b.blocks_y;
    b->slots = v->b.blocks_x * (step->band ? step->rows : v->b.blocks_y) * BLOCK;
    uint32_t tiles = noc_vk_tiles(v->b.blocks_x) * noc_vk_tiles(b->rows);
    b->pixels_at = tiles * b->tile_words;
    b->pool_room = NOC_MIN(tiles * FOUND_POOL + FOUND_SPARE, v->device->pool_most);
    VkPipelineBindPoint point = traces ? VK_PIPELINE_BIND_POINT_RAY_TRACING_KHR : VK_PIPELINE_BIND_POINT_COMPUTE;
    VkDeviceAddress address = f->constants.address + at;
    if (step->wait)
        noc_vk_barrier(f->commands);
    vkCmdBindPipeline(f->commands, point, p->pipeline);
    if (traces)
        vkCmdBindDescriptorSets(f->commands, point, v->device->layout, 0, 1,
                                &s->tlas[step->past ? 1 - s->now : s->now].set, 0, NULL);
    vkCmdPushConstants(f->commands, v->device->layout, VK_PUSH_STAGES, 0, sizeof(address), &address);
    dispatch(v, step, p);
    return NOC_OK;
}

/* A frame that was dropped may have left them half recorded. */
static VkResult begin_commands(const vk_flight *f) {
    VkCommandBufferBeginInfo info = { .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                      .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT };
    VkResult result = vkResetCommandBuffer(f->commands, 0);
    return result == VK_SUCCESS ? vkBeginCommandBuffer(f->commands, &info) : result;
}

/* Submits what is recorded. */
static VkResult submit_commands(const vk_device *d, const vk_flight *f) {
    VkSubmitInfo info = { .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
                          .commandBufferCount = 1,
                          .pCommandBuffers = &f->commands };
    noc_vk_barrier(f->commands);
    VkResult result = vkEndCommandBuffer(f->commands);
    if (result == VK_SUCCESS)
        result = vkResetFences(d->device, 1, &f->fence);
    return result == VK_SUCCESS ? vkQueueSubmit(d->queue, 1, &info, f->fence) : result;
}

static void start_times(const vk_device *d, vk_flight *f) {
    f->times_count = 0;
    if (!d->tick_mask)
        return;
    vkCmdResetQueryPool(f->commands, f->times, 0, VK_STEPS + 1);
    vkCmdWriteTimestamp(f->commands, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, f->times, 0);
}

/* Runs what is recorded so far, and goes on recording. between: NULL, or a step that the host answers in between. */
static noc_status run_recorded(vk_view *v, const vk_step *between) {
    vk_flight *f = &v->flights[v->flight];
    VkResult result = submit_commands(v->device, f);
    if (result != VK_SUCCESS)
        return noc_vk_failed(v->device, result, "rendering");
    noc_status status = noc_vk_wait_idle(v->device);
    if (status == NOC_OK)
        take_times(v, f);
    if (status == NOC_OK && between)
        status = v->answerer->answer(v->answerer->user, between);
    if (status == NOC_OK)
        status = noc_vk_submit_upload(v->device);
    if (status != NOC_OK)
        return status;
    result = begin_commands(f);
    f->steps = 0;
    start_times(v->device, f);
    return result == VK_SUCCESS ? NOC_OK : noc_vk_failed(v->device, result, "recording a frame");
}

/* Records a step, or has it answered by the host. What a command buffer has no room for goes into the next one. */
static noc_status take_step(vk_view *v, vk_step *step, const vk_binding *common) {
    noc_status status = v->flights[v->flight].steps == VK_STEPS ? run_recorded(v, NULL) : NOC_OK;
    noc_vk_find_wait(&v->hazards, step);
    if (status == NOC_OK && v->recording && step->domain == VK_DOMAIN_RAYS)
        status = noc_vk_keep_rays(v, step);
    if (status != NOC_OK)
        return status;
    return v->answerer && step->domain == VK_DOMAIN_RAYS ? run_recorded(v, step) : record_step(v, step, common);
}

static noc_status record(vk_view *v, const noc_frame *frame, vk_steps *steps) {
    vk_binding common = common_binding(v, frame);
    noc_status status = NOC_OK;
    for (size_t i = 0; i < steps->len && status == NOC_OK; i++) {
        status = take_step(v, &steps->data[i], &common);
        if (i + 1 == steps->len || steps->data[i + 1].pass != steps->data[i].pass)
            mark_time(v, steps->data[i].pass);
    }
    return status;
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

/* Room for the rays of the plan's steps, and for scratch. */
static noc_status fit_buffers(vk_view *v, const noc_frame *frame) {
    vk_facts facts = facts_of(v, frame);
    size_t rays = 0;
    for (int i = 0; i < frame->plan->count; i++) {
        v->steps.len = 0;
        if (!noc_vk_schedule(frame->plan, &frame->plan->stages[i], &facts, &v->steps))
            return noc_no_memory(v->log, "render");
        rays = NOC_MAX(rays, noc_vk_ray_room(&v->steps, &facts));
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
static noc_status prepare(vk_view *v, const noc_frame *frame) {
    noc_status status = finish(v, &v->flights[v->flight]);
    if (status == NOC_OK)
        status = noc_vk_world_follow(v->world);
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
        status = fit_buffers(v, frame);
    if (status == NOC_OK && frame->receivers)
        status = upload_receivers(v, frame);
    if (status == NOC_OK)
        status = noc_vk_begin_views(v, frame->params->aovs);
    uint32_t rows = shared_rows(frame);
    return status == NOC_OK && rows ? noc_vk_view_fit_samples(v, rows) : status;
}

static noc_status begin(vk_view *v, const noc_frame *frame) {
    vk_flight *f = &v->flights[v->flight];
    noc_status status = prepare(v, frame);
    if (status != NOC_OK)
        return status;
    VkResult result = begin_commands(f);
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
    start_times(v->device, f);
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
    (void)to;
    if (stage == &frame->plan->stages[0]) {
        if ((status = noc_vk_enter(v->device)) != NOC_OK)
            return status;
        v->open = true;
        status = begin(v, frame);
    }
    if (status == NOC_OK && progress && progress->update && !progress->update(progress->user, "rendering", from))
        status = NOC_ERR_CANCELLED;
    if (status == NOC_OK) {
        vk_facts facts = facts_of(v, frame);
        v->steps.len = 0;
        status = noc_vk_schedule(frame->plan, stage, &facts, &v->steps) ? record(v, frame, &v->steps)
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
    VkResult result = submit_commands(d, f);
    if (result != VK_SUCCESS)
        return noc_vk_failed(d, result, "rendering");
    f->pending = true;
    v->flight = (v->flight + 1) % VK_FRAMES;
    return NOC_OK;
}

noc_status noc_vk_accumulate(void *view, const noc_frame *frame) {
    vk_view *v = view;
    vk_facts facts = facts_of(v, frame);
    noc_past past = v->past;
    v->steps.len = 0;
    noc_status status = noc_vk_schedule_mean(frame->plan, &facts, &v->steps) ? record(v, frame, &v->steps)
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

noc_status noc_vk_trace_kept(vk_view *v, noc_trace_floor *floor) {
    vk_flight *f = &v->flights[v->flight];
    const vk_picture *b = &v->b;
    const vk_world *w = v->world;
    vk_binding common = { .frame = f->constants.address, /* of an earlier frame: by chance rays meet other panes */
                          .entries = w->structure.entries.address,
                          .indices = w->indices.buffer.address,
                          .triangle_material = w->triangle_material.buffer.address,
                          .texels = w->texels.buffer.address,
                          .image_corners = w->image_corners.buffer.address,
                          .panes = w->panes.buffer.address,
                          .through = b->through.address,
                          .hits = b->hits.address,
                          .counters = v->counters.address,
                          .blocks_y = b->blocks_y };
    VkResult result = begin_commands(f);
    noc_status status = result == VK_SUCCESS ? NOC_OK : noc_vk_failed(v->device, result, "recording a frame");
    f->steps = f->times_count = 0;
    for (size_t i = 0; i < v->kept.len && status == NOC_OK; i++) {
        common.rays = v->kept.data[i].rays.address;
        common.answers = v->kept.data[i].answers.address;
        status = record_step(v, &v->kept.data[i].step, &common);
    }
    double wall = noc_wall_seconds(), cpu = noc_cpu_seconds();
    if (status == NOC_OK && (result = submit_commands(v->device, f)) != VK_SUCCESS)
        status = noc_vk_failed(v->device, result, "tracing rays");
    if (status == NOC_OK)
        status = noc_vk_wait_idle(v->device);
    if (status == NOC_OK)
        *floor = (noc_trace_floor){ noc_wall_seconds() - wall, noc_cpu_seconds() - cpu };
    return status;
}
