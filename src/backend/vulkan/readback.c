/* Views (render/frame_views.h): buffers that shaders gather into, and what is read back of a complete frame, of which
 * the host keeps views and rows. A frame without views has none of this. */
#include "backend/vulkan/vulkan.h"

/* What shaders gather: bits of a dispatch's record. */
static const struct {
    noc_aov aov;
    uint32_t bit;
} gathered[] = { { NOC_AOV_LIGHTS, VK_VIEW_LIGHTS },        { NOC_AOV_RAYS, VK_VIEW_RAYS },
                 { NOC_AOV_DENSITY, VK_VIEW_DENSITY },      { NOC_AOV_ILLUMINANCE, VK_VIEW_LUX },
                 { NOC_AOV_GROUP, VK_VIEW_GROUP },          { NOC_AOV_PLACED, VK_VIEW_PLACED },
                 { NOC_AOV_INFLUENTIAL, VK_VIEW_EMITTERS }, { NOC_AOV_EXPECTED, VK_VIEW_EXPECTED } };

static bool needs_triangles(uint32_t aovs) { return aovs & (NOC_AOV_BIT(OBJECT) | NOC_AOV_BIT(CLASS)); }

static size_t blocks_of(const vk_picture *b) { return (size_t)b->blocks_x * b->blocks_y; }

size_t noc_vk_views_bytes(uint32_t aovs) {
    size_t bytes = noc_views_bytes(aovs) + (needs_triangles(aovs) ? 8 : 0);
    for (size_t i = 0; i < NOC_COUNT(gathered); i++)
        if (noc_views_gathered(aovs) >> gathered[i].aov & 1)
            bytes += noc_views_made_entries(gathered[i].aov) * sizeof(float);
    if (noc_views_need_surfaces(aovs))
        bytes += sizeof(gblock) / BLOCK + 4;
    if (noc_views_need_reservoirs(aovs))
        bytes += sizeof(rblock) / BLOCK;
    return bytes + (aovs ? sizeof(cblock) / BLOCK : 0);
}

void noc_vk_views_free(vk_view *v) {
    vk_views *w = &v->views;
    for (size_t i = 0; i < NOC_COUNT(w->gathered); i++)
        noc_vk_free_buffer(v->device, &w->gathered[i]);
    noc_vk_free_buffer(v->device, &w->triangles);
    noc_vk_free_buffer(v->device, &w->labels);
    noc_views_free(&w->of);
    free(w->g);
    free(w->r);
    free(w->colour);
    free(w->instance);
    free(w->triangle);
    free(w->emitter);
    *w = (vk_views){ 0 };
}

static noc_frame_blocks frame_blocks(const vk_view *v) {
    const vk_views *w = &v->views;
    return (noc_frame_blocks){ .scene = v->scene,
                               .pool = v->device->pool,
                               .width = v->b.width,
                               .height = v->b.height,
                               .blocks_x = (int)v->b.blocks_x,
                               .blocks_y = (int)v->b.blocks_y,
                               .g = w->g,
                               .r = w->r,
                               .colour = w->colour,
                               .picture = v->mean.colour,
                               .instance = v->b.instance.bytes ? (const uint32_t(*)[BLOCK])w->instance : NULL,
                               .emitter = w->emitter,
                               .past = &w->past,
                               .placings = &v->world->placings };
}

/* ---- before a frame ---- */

#define MAKE(p) ((p) || ((p) = noc_alloc_large(blocks, sizeof(*(p)))))

/* Room for what the frame leaves, on the host. */
static bool make_host(vk_views *w, uint32_t aovs, size_t blocks) {
    return (!noc_views_need_surfaces(aovs) || (MAKE(w->g) && MAKE(w->instance))) &&
           (!noc_views_need_reservoirs(aovs) || MAKE(w->r)) && MAKE(w->colour) && MAKE(w->emitter) &&
           (!needs_triangles(aovs) || MAKE(w->triangle));
}

static noc_status make_buffer(vk_view *v, size_t bytes, vk_buffer *out) {
    return noc_vk_fit_buffer(v, bytes, "views of a picture", out);
}

/* The first light of each light's emitter. */
static noc_status upload_labels(vk_view *v) {
    vk_views *w = &v->views;
    size_t bytes = (w->of.emitter_label_count + 1) * sizeof(float);
    if (w->labels.bytes >= bytes && !memcmp(w->labelled, w->of.labelled, sizeof(w->labelled)))
        return NOC_OK;
    noc_status status = make_buffer(v, bytes, &w->labels);
    if (status == NOC_OK)
        status = noc_vk_write(v->device, &w->labels, 0, w->of.emitter_labels, bytes);
    if (status == NOC_OK)
        status = noc_vk_submit_upload(v->device);
    if (status == NOC_OK)
        memcpy(w->labelled, w->of.labelled, sizeof(w->labelled));
    return status;
}

/* Buffers that shaders gather into. */
static noc_status make_gathered(vk_view *v) {
    vk_views *w = &v->views;
    size_t blocks = blocks_of(&v->b);
    noc_status status = NOC_OK;
    w->bits = 0;
    for (size_t i = 0; i < NOC_COUNT(gathered) && status == NOC_OK; i++) {
        if (!w->of.made[gathered[i].aov])
            continue;
        w->bits |= gathered[i].bit;
        status = make_buffer(v, noc_views_made_entries(gathered[i].aov) * blocks * BLOCK * sizeof(float),
                             &w->gathered[gathered[i].aov]);
    }
    if (needs_triangles(w->of.asked)) {
        w->bits |= VK_VIEW_TRIANGLES;
        status = status == NOC_OK ? make_buffer(v, blocks * BLOCK * 4, &w->triangles) : status;
    }
    return status == NOC_OK && w->bits & VK_VIEW_EMITTERS ? upload_labels(v) : status;
}

noc_status noc_vk_begin_views(vk_view *v, uint32_t aovs) {
    vk_views *w = &v->views;
    noc_frame_blocks b = frame_blocks(v);
    w->bits = 0;
    if (!aovs && !w->of.held)
        return NOC_OK;
    noc_status status = noc_views_begin(&w->of, v->scene, &b, aovs, v->log);
    if (status != NOC_OK || !aovs)
        return status;
    if (!make_host(w, aovs, blocks_of(&v->b)))
        return noc_error(v->log, NOC_ERR_MEMORY, "render: no memory for views of %d x %d", v->b.width, v->b.height);
    return make_gathered(v);
}

void noc_vk_clear_views(vk_view *v, VkCommandBuffer commands) {
    const vk_views *w = &v->views;
    for (size_t i = 0; i < NOC_COUNT(gathered); i++) {
        float start = noc_views_start(gathered[i].aov);
        uint32_t word;
        memcpy(&word, &start, sizeof(word));
        if (w->bits & gathered[i].bit)
            vkCmdFillBuffer(commands, w->gathered[gathered[i].aov].buffer, 0, VK_WHOLE_SIZE, word);
    }
}

/* ---- a complete frame ---- */

static noc_status read_blocks(vk_view *v, const vk_buffer *from, void *to, size_t bytes) {
    return noc_vk_read(v->device, from, 0, to, blocks_of(&v->b) * bytes);
}

/* Shaders count in whole numbers. */
static void count_in_floats(float (*rays)[BLOCK], size_t blocks) {
    for (size_t i = 0; i < blocks; i++)
        for (int l = 0; l < BLOCK; l++) {
            uint32_t count;
            memcpy(&count, &rays[i][l], sizeof(count));
            rays[i][l] = (float)count;
        }
}

/* Triangles of bodies come as the bodies' numbers behind those of all triangles. */
static void note_triangle(const vk_view *v, uint32_t seen, size_t block, int lane) {
    uint32_t triangles = (uint32_t)v->scene->triangle_light.len, body = seen - triangles;
    bool world = seen < triangles;
    noc_views_note_triangle(&v->views.of, v->scene, world ? seen : 0, world ? NO_INSTANCE : NOC_BODIES + body, block,
                            lane);
}

/* What passes of the CPU backend note while they run. */
static noc_status read_gathered(vk_view *v) {
    vk_views *w = &v->views;
    noc_status status = NOC_OK;
    for (size_t i = 0; i < NOC_COUNT(gathered) && status == NOC_OK; i++)
        if (w->bits & gathered[i].bit)
            status = read_blocks(v, &w->gathered[gathered[i].aov], w->of.made[gathered[i].aov],
                                 noc_views_made_entries(gathered[i].aov) * sizeof(float[BLOCK]));
    if (status == NOC_OK && w->bits & VK_VIEW_RAYS)
        count_in_floats(w->of.made[NOC_AOV_RAYS], blocks_of(&v->b));
    if (status != NOC_OK || !(w->bits & VK_VIEW_TRIANGLES))
        return status;
    status = read_blocks(v, &w->triangles, w->triangle, sizeof(*w->triangle));
    for (size_t i = 0; i < blocks_of(&v->b) && status == NOC_OK; i++)
        for (int l = 0; l < BLOCK; l++)
            if (w->triangle[i][l] != VK_NO_TRIANGLE)
                note_triangle(v, w->triangle[i][l], i, l);
    return status;
}

noc_status noc_vk_keep_views(vk_view *v, const noc_frame *frame, const noc_past *past) {
    vk_views *w = &v->views;
    uint32_t aovs = w->of.asked;
    const noc_stage *last = &frame->plan->stages[frame->plan->count - 1];
    noc_status status = NOC_OK;
    if (!aovs && !w->of.held)
        return NOC_OK;
    w->past = *past;
    if (noc_views_need_surfaces(aovs))
        status = read_blocks(v, &v->b.surfaces[frame->gbuffer], w->g, sizeof(*w->g));
    if (status == NOC_OK && noc_views_need_surfaces(aovs) && v->b.instance.bytes)
        status = read_blocks(v, &v->b.instance, w->instance, sizeof(*w->instance));
    if (status == NOC_OK && noc_views_need_reservoirs(aovs))
        status = read_blocks(v, &v->b.reservoirs[last->target], w->r, sizeof(*w->r));
    if (status == NOC_OK && noc_views_need_colour(aovs))
        status = read_blocks(v, &v->b.colour, w->colour, sizeof(*w->colour));
    if (status == NOC_OK)
        status = read_gathered(v);
    noc_frame_blocks b = frame_blocks(v);
    if (status == NOC_OK)
        noc_views_keep(&w->of, &b, frame);
    return status;
}

/* ---- reading ---- */

/* The lanes of all blocks that saw an emitter in a frame of the mean. */
static void find_emitters(vk_view *v) {
    for (size_t i = 0; i < blocks_of(&v->b); i++) {
        uint16_t *lanes = &v->views.emitter[i];
        *lanes = 0;
        for (int l = 0; l < BLOCK; l++)
            *lanes |= (uint16_t)((v->mean.coverage[i][l][3] > 0) << l);
    }
}

noc_status noc_vk_read_aov(void *view, noc_aov aov, float *value) {
    vk_view *v = view;
    bool emitters = aov == NOC_AOV_VARIANCE || aov == NOC_AOV_ERROR;
    if (!(v->views.of.held >> aov & 1))
        return NOC_ERR_ARGUMENT;
    noc_status status = emitters || aov == NOC_AOV_LUMINANCE ? noc_vk_read_mean(v) : NOC_OK;
    if (status != NOC_OK)
        return status;
    if (emitters)
        find_emitters(v);
    noc_frame_blocks b = frame_blocks(v);
    return noc_views_read(&v->views.of, &b, aov, value) ? NOC_OK : NOC_ERR_ARGUMENT;
}

void noc_vk_rows(void *view, const frame_camera *camera, const noc_frame_rows *rows) {
    const vk_view *v = view;
    noc_frame_blocks b = frame_blocks(v);
    noc_views_rows(&v->views.of, &b, camera, rows);
}
