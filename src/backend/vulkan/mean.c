/* The mean of a view's frames, as the host reads it. The host's copy is kept: it is what is left of a picture when the
 * device is lost. So a mean that nobody asks for is read now and then, too. */
#include "backend/vulkan/vulkan.h"

void noc_vk_free_mean(vk_view *v) {
    free(v->mean.colour);
    free(v->mean.coverage);
    v->mean = (vk_mean){ 0 };
}

/* A copy of the device's mean takes the place of the host's, once it is whole; the device is locked. *room: the host
 * had memory for it, and every other failure is reported. */
static noc_status read_whole(vk_view *v, bool *room) {
    const vk_picture *b = &v->b;
    size_t blocks = (size_t)b->blocks_x * b->blocks_y;
    vk_mean now = { .colour = noc_alloc_large(blocks, sizeof(*now.colour)),
                    .coverage = noc_alloc_large(blocks, sizeof(*now.coverage)),
                    .frames = v->mean_frames,
                    .version = v->mean_version,
                    .read = noc_wall_seconds() };
    *room = now.colour && now.coverage;
    noc_status status = *room ? noc_vk_finish_flights(v) : NOC_ERR_MEMORY;
    if (status == NOC_OK)
        status = noc_vk_read(v->device, &b->picture, 0, now.colour, blocks * sizeof(*now.colour));
    if (status == NOC_OK)
        status = noc_vk_read(v->device, &b->coverage, 0, now.coverage, blocks * sizeof(*now.coverage));
    vk_mean gone = status == NOC_OK ? v->mean : now;
    free(gone.colour);
    free(gone.coverage);
    if (status == NOC_OK)
        v->mean = now;
    return status;
}

noc_status noc_vk_note_mean(vk_view *v, uint64_t frames) {
    v->mean_frames = frames;
    v->mean_version++;
    if (frames == 1) {
        v->mean.frames = 0;
        v->mean.read = noc_wall_seconds();
    }
    if (noc_wall_seconds() - v->mean.read < v->device->keep_seconds)
        return NOC_OK;
    bool room;
    v->mean.read = noc_wall_seconds();
    noc_status status = read_whole(v, &room);
    return status == NOC_ERR_MEMORY ? NOC_OK : status; /* the frame is there all the same */
}

bool noc_vk_lost(void *view, uint64_t *frames) {
    vk_view *v = view;
    pthread_mutex_lock(&v->device->lock);
    bool lost = v->device->lost;
    pthread_mutex_unlock(&v->device->lock);
    *frames = v->mean.frames;
    return lost;
}

noc_status noc_vk_read_mean(vk_view *v) {
    uint64_t frames;
    if (v->mean.frames && (v->mean.version == v->mean_version || noc_vk_lost(v, &frames)))
        return NOC_OK;
    noc_status status = noc_vk_enter(v->device);
    if (status != NOC_OK)
        return status;
    bool room;
    status = read_whole(v, &room);
    pthread_mutex_unlock(&v->device->lock);
    return room ? status : noc_no_memory(v->log, "render");
}

static void copy_block(const vk_view *v, size_t block, noc_image *image) {
    uint32_t bx = (uint32_t)(block % v->b.blocks_x), by = (uint32_t)(block / v->b.blocks_x);
    const cblock *c = &v->mean.colour[block];
    const float(*coverage)[4] = (const float(*)[4])v->mean.coverage[block];
    for (int l = 0; l < BLOCK; l++) {
        int x = (int)bx * BLOCK_SIDE + (l & 3), y = (int)by * BLOCK_SIDE + (l >> 2);
        if (x >= v->b.width || y >= v->b.height)
            continue;
        size_t to = (size_t)y * (size_t)v->b.width + (size_t)x;
        for (int k = 0; k < 3; k++)
            image->rgb[3 * to + (size_t)k] = c->rgb[k][l];
        if (image->emitter)
            image->emitter[to] = coverage[l][3] > 0;
        for (int k = 0; k < 4 && image->coverage; k++)
            image->coverage[4 * to + (size_t)k] = coverage[l][k] / (float)v->mean.frames;
    }
}

noc_status noc_vk_read_picture(void *view, noc_image *image) {
    vk_view *v = view;
    noc_status status = noc_vk_read_mean(v);
    for (size_t i = 0; i < (size_t)v->b.blocks_x * v->b.blocks_y && status == NOC_OK; i++)
        copy_block(v, i, image);
    return status;
}
