/* Steps (schedule.h) as commands of a frame, and what is run of them before the frame is complete: what a command
 * buffer has no room for, what the host answers in a test, and pieces of frames that take long (pace.c). */
#include "backend/vulkan/influence_memory.h"
#include "backend/vulkan/vulkan.h"
#include "core/learned.h"

enum { GROUP = 64 }; /* invocations of a work group over pixels: four blocks in a row */

/* Rows of blocks of a step's band. */
typedef struct row_range {
    uint32_t first, count;
} row_range;

/* ---- times ---- */

double noc_vk_take_times(vk_view *v, vk_flight *f) {
    uint64_t times[VK_STEPS + 1];
    double sum = 0;
    if (!f->times_count ||
        vkGetQueryPoolResults(v->device->device, f->times, 0, (uint32_t)f->times_count + 1, sizeof(times), times,
                              sizeof(*times), VK_QUERY_RESULT_64_BIT) != VK_SUCCESS)
        return 0;
    for (int i = 0; i < f->times_count; i++) {
        double seconds = (double)((times[i + 1] - times[i]) & v->device->tick_mask) * v->device->tick;
        sum += seconds;
        if (f->timed[i] < NOC_PASS_COUNT)
            f->found.pass_seconds[f->timed[i]] += seconds;
    }
    return sum;
}

void noc_vk_start_times(const vk_device *d, vk_flight *f) {
    f->times_count = 0;
    if (!d->tick_mask)
        return;
    vkCmdResetQueryPool(f->commands, f->times, 0, VK_STEPS + 1);
    vkCmdWriteTimestamp(f->commands, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, f->times, 0);
}

static void mark_time(vk_view *v, noc_pass pass) {
    vk_flight *f = &v->flights[v->flight];
    if (!v->device->tick_mask || f->times_count >= VK_STEPS)
        return;
    f->timed[f->times_count++] = pass;
    vkCmdWriteTimestamp(f->commands, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, f->times, (uint32_t)f->times_count);
}

/* ---- a step ---- */

/* So many invocations, in a plane of work groups: a row has room for 65,535 of these at least. */
static void dispatch_many(VkCommandBuffer commands, uint32_t invocations) {
    uint32_t groups = (invocations + GROUP - 1) / GROUP, wide = NOC_MIN(groups, 1024u);
    vkCmdDispatch(commands, wide, (groups + wide - 1) / wide, 1);
}

static void dispatch(vk_view *v, const vk_step *step, row_range rows, const vk_pipeline *p) {
    const vk_picture *b = &v->b;
    uint32_t wide = (b->blocks_x * BLOCK + GROUP - 1) / GROUP;
    VkCommandBuffer commands = v->flights[v->flight].commands;
    static const VkStridedDeviceAddressRegionKHR none = { 0 };
    switch (step->domain) {
    case VK_DOMAIN_PIXELS: vkCmdDispatchBase(commands, 0, rows.first, 0, wide, rows.count, 1); break;
    case VK_DOMAIN_LAYERS:
        vkCmdDispatchBase(commands, 0, rows.first, 0, wide, rows.count, (uint32_t)step->slots);
        break;
    case VK_DOMAIN_TILES:
        vkCmdDispatchBase(commands, 0, rows.first / 4, 0, noc_vk_tiles(b->blocks_x), noc_vk_tiles(rows.count), 1);
        break;
    case VK_DOMAIN_BLOCKS: {
        uint32_t blocks = v->device->constants.share_workers / BLOCK;
        vkCmdDispatchBase(commands, 0, rows.first, 0, (b->blocks_x + blocks - 1) / blocks, rows.count, 1);
        break;
    }
    case VK_DOMAIN_ROWS: dispatch_many(commands, v->learning.rows); break;
    case VK_DOMAIN_RUNS: dispatch_many(commands, v->learning.cells / CELL_RUN * 16); break;
    case VK_DOMAIN_ONE: vkCmdDispatch(commands, 1, 1, 1); break;
    case VK_DOMAIN_SUBSETS: vkCmdDispatch(commands, v->subsets, 1, 1); break;
    case VK_DOMAIN_RAYS:
        vkCmdTraceRaysKHR(commands, &p->raygen, &p->miss, &p->hit, &none, b->blocks_x * BLOCK, rows.count,
                          (uint32_t)step->slots);
        break;
    }
}

/* Records some rows of a step over rays that common->rays and common->answers lead to. */
static noc_status record_rows(vk_view *v, const vk_step *step, row_range rows, const vk_binding *common) {
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
    b->first_row = traces ? (step->band ? 0 : step->first_row) + rows.first : step->first_row;
    b->rows = step->rows ? step->rows : v->b.blocks_y;
    b->slots = v->b.blocks_x * (step->band ? step->rows : v->b.blocks_y) * BLOCK;
    uint32_t tiles = noc_vk_tiles(v->b.blocks_x) * noc_vk_tiles(b->rows);
    b->pixels_at = tiles * b->tile_words;
    b->pool_room = NOC_MIN(tiles * FOUND_POOL + FOUND_SPARE, v->device->pool_most);
    VkPipelineBindPoint point = traces ? VK_PIPELINE_BIND_POINT_RAY_TRACING_KHR : VK_PIPELINE_BIND_POINT_COMPUTE;
    VkDeviceAddress address = f->constants.address + at;
    if (step->wait && !rows.first)
        noc_vk_barrier(f->commands);
    vkCmdBindPipeline(f->commands, point, p->pipeline);
    if (traces)
        vkCmdBindDescriptorSets(f->commands, point, v->device->layout, 0, 1,
                                &s->tlas[step->past ? 1 - s->now : s->now].set, 0, NULL);
    vkCmdPushConstants(f->commands, v->device->layout, VK_PUSH_STAGES, 0, sizeof(address), &address);
    dispatch(v, step, rows, p);
    return NOC_OK;
}

/* ---- what is submitted ---- */

/* A frame that was dropped may have left them half recorded. */
VkResult noc_vk_begin_commands(const vk_flight *f) {
    VkCommandBufferBeginInfo info = { .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                      .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT };
    VkResult result = vkResetCommandBuffer(f->commands, 0);
    return result == VK_SUCCESS ? vkBeginCommandBuffer(f->commands, &info) : result;
}

/* Submits what is recorded. */
VkResult noc_vk_submit_commands(const vk_device *d, const vk_flight *f) {
    VkSubmitInfo info = { .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
                          .commandBufferCount = 1,
                          .pCommandBuffers = &f->commands };
    noc_vk_barrier(f->commands);
    VkResult result = vkEndCommandBuffer(f->commands);
    if (result == VK_SUCCESS)
        result = vkResetFences(d->device, 1, &f->fence);
    return result == VK_SUCCESS ? vkQueueSubmit(d->queue, 1, &info, f->fence) : result;
}

/* Runs what is recorded so far, and goes on recording. between: NULL, or a step that the host answers in between. */
static noc_status run_recorded(vk_view *v, const vk_step *between) {
    vk_flight *f = &v->flights[v->flight];
    VkResult result = noc_vk_submit_commands(v->device, f);
    if (result != VK_SUCCESS)
        return noc_vk_failed(v->device, result, "rendering");
    noc_status status = noc_vk_wait_idle(v->device);
    if (status == NOC_OK)
        noc_vk_take_times(v, f);
    if (status == NOC_OK && between)
        status = v->answerer->answer(v->answerer->user, between);
    if (status == NOC_OK)
        status = noc_vk_submit_upload(v->device);
    if (status != NOC_OK)
        return status;
    result = noc_vk_begin_commands(f);
    f->steps = 0;
    noc_vk_start_times(v->device, f);
    return result == VK_SUCCESS ? NOC_OK : noc_vk_failed(v->device, result, "recording a frame");
}

/* Runs what is recorded of a pass that is at work, and lets the caller break the frame off. */
static noc_status run_piece(vk_view *v, noc_pass pass) {
    double start = noc_wall_seconds();
    mark_time(v, pass);
    noc_status status = run_recorded(v, NULL);
    if (status != NOC_OK)
        return status;
    noc_vk_note_piece(v, noc_wall_seconds() - start);
    return noc_vk_may_go_on(v) ? NOC_OK : NOC_ERR_CANCELLED;
}

/* Makes room for a dispatch; what must not wait for it is run before. */
static noc_status make_way(vk_view *v, const vk_step *step) {
    bool full = v->flights[v->flight].steps == VK_STEPS;
    noc_status status = full || noc_vk_piece_is_due(v, step) ? run_piece(v, step->pass) : NOC_OK;
    if (status == NOC_OK && v->pace.on && !v->device->pipelines[step->shader].pipeline && !noc_vk_may_go_on(v))
        status = NOC_ERR_CANCELLED; /* compiling takes time */
    return status;
}

/* Records a step in pieces, or whole where the frame is not cut. What a command buffer has no room for goes into the
 * next one. */
static noc_status record_pieces(vk_view *v, const vk_step *step, const vk_binding *common) {
    uint32_t all = step->rows ? step->rows : v->b.blocks_y;
    row_range rows = { 0, 0 };
    noc_status status = NOC_OK;
    for (uint32_t first = 0; first < all && status == NOC_OK; first += rows.count) {
        if ((status = make_way(v, step)) != NOC_OK)
            break;
        rows = (row_range){ first, noc_vk_next_piece(v, step, first, rows.count) };
        status = record_rows(v, step, rows, common);
    }
    return status;
}

/* Records a step, or has it answered by the host. */
static noc_status take_step(vk_view *v, vk_step *step, const vk_binding *common) {
    bool answered = v->answerer && step->domain == VK_DOMAIN_RAYS;
    noc_vk_find_wait(&v->hazards, step);
    noc_status status = v->recording && step->domain == VK_DOMAIN_RAYS ? noc_vk_keep_rays(v, step) : NOC_OK;
    if (status != NOC_OK)
        return status;
    return answered ? run_recorded(v, step) : record_pieces(v, step, common);
}

noc_status noc_vk_record_steps(vk_view *v, const vk_binding *common, double from, double to) {
    vk_steps *steps = &v->steps;
    noc_status status = NOC_OK;
    for (size_t i = 0; i < steps->len && status == NOC_OK; i++) {
        v->pace.done = from + (to - from) * (double)i / (double)steps->len;
        status = take_step(v, &steps->data[i], common);
        if (i + 1 == steps->len || steps->data[i + 1].pass != steps->data[i].pass)
            mark_time(v, steps->data[i].pass);
    }
    return status;
}

/* ---- the trace floor ---- */

/* What steps that trace read, but for their rays. */
static vk_binding tracing_binding(const vk_view *v) {
    const vk_flight *f = &v->flights[v->flight];
    const vk_picture *b = &v->b;
    const vk_world *w = v->world;
    return (vk_binding){ .frame = f->constants.address, /* of an earlier frame: by chance rays meet other panes */
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
}

static noc_status record_kept(vk_view *v) {
    vk_binding common = tracing_binding(v);
    noc_status status = NOC_OK;
    for (size_t i = 0; i < v->kept.len && status == NOC_OK; i++) {
        common.rays = v->kept.data[i].rays.address;
        common.answers = v->kept.data[i].answers.address;
        v->pace.done = (double)i / (double)v->kept.len;
        status = record_pieces(v, &v->kept.data[i].step, &common);
    }
    return status;
}

noc_status noc_vk_trace_kept(vk_view *v, const noc_progress *progress, noc_trace_floor *floor) {
    vk_flight *f = &v->flights[v->flight];
    double expected = 0;
    for (size_t i = 0; i < v->kept.len; i++)
        expected += noc_vk_expected_seconds(v, &v->kept.data[i].step);
    v->pace.progress = progress;
    noc_vk_begin_pace(v, expected);
    VkResult result = noc_vk_begin_commands(f);
    noc_status status = result == VK_SUCCESS ? NOC_OK : noc_vk_failed(v->device, result, "recording a frame");
    f->steps = 0;
    noc_vk_start_times(v->device, f);
    double wall = noc_wall_seconds(), cpu = noc_cpu_seconds();
    if (status == NOC_OK)
        status = record_kept(v);
    if (status == NOC_OK && (result = noc_vk_submit_commands(v->device, f)) != VK_SUCCESS)
        status = noc_vk_failed(v->device, result, "tracing rays");
    if (status == NOC_OK)
        status = noc_vk_wait_idle(v->device);
    if (status == NOC_OK)
        *floor = (noc_trace_floor){ noc_wall_seconds() - wall, noc_cpu_seconds() - cpu };
    v->pace.on = false;
    return status;
}
