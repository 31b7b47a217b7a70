/* Light lists on the device: clusters of lights, the visibility cache, and what a frame observes for it
 * (list_memory.h). The cache has as many cells as that of the CPU backend (light/learned.h). */
#include "backend/vulkan/list_memory.h"
#include "backend/vulkan/vulkan.h"
#include "core/learned.h"
#include "light/learned.h"

/* ---- clusters ---- */

enum { HEAD_WORDS = 16 }; /* of a hierarchy: levels, highest nodes, where its lights and its levels are */
_Static_assert(3 + LIST_LEVELS <= HEAD_WORDS, "a head has room for all levels");

static size_t level_bytes(const noc_clusters *c, int level) { return (c->nodes[level] + 15) / 16 * sizeof(**c->level); }

static size_t cluster_bytes(const noc_clusters *c) {
    size_t bytes = 0;
    for (int i = 0; c && i < c->levels; i++)
        bytes += level_bytes(c, i);
    return c ? bytes + c->count * sizeof(*c->lights) : 0;
}

/* Copies into `to` what begins at byte `at` there. Returns where it ends. */
static size_t put(char *to, size_t at, const void *data, size_t bytes, uint32_t *place) {
    *place = (uint32_t)(at / 4);
    memcpy(to + at, data, bytes);
    return at + bytes;
}

static size_t put_clusters(char *to, size_t at, const noc_clusters *c, uint32_t head[HEAD_WORDS]) {
    if (!c || !c->count)
        return at;
    head[0] = (uint32_t)c->levels;
    head[1] = (uint32_t)c->nodes[c->levels - 1];
    at = put(to, at, c->lights, c->count * sizeof(*c->lights), &head[2]);
    for (int i = 0; i < c->levels; i++)
        at = put(to, at, c->level[i], level_bytes(c, i), &head[3 + i]);
    return at;
}

void *noc_vk_pack_clusters(const noc_clusters *const clusters[NOC_HALVES], size_t *bytes) {
    size_t at = NOC_HALVES * HEAD_WORDS * 4;
    *bytes = at + cluster_bytes(clusters[0]) + cluster_bytes(clusters[1]);
    char *words = noc_calloc(1, *bytes);
    for (int i = 0; words && i < NOC_HALVES; i++)
        at = put_clusters(words, at, clusters[i], (uint32_t *)(void *)words + i * HEAD_WORDS);
    return words;
}

/* ---- the visibility cache ---- */

static size_t tiles_of(const vk_view *v) { return (size_t)noc_vk_tiles(v->b.blocks_x) * noc_vk_tiles(v->b.blocks_y); }

static noc_status make_cache(vk_view *v, size_t cells, vk_buffer *cache) {
    VkCommandBuffer commands;
    size_t words = CACHE_HEAD + cells * CELL_WORDS + cells / CELL_RUN;
    noc_status status = noc_vk_make_buffer(v->device, 4 * words, 0, VK_PLACE_DEVICE, "learned visibility", cache);
    if (status == NOC_OK)
        status = noc_vk_open_upload(v->device, &commands);
    if (status != NOC_OK)
        return status;
    vkCmdFillBuffer(commands, cache->buffer, 0, VK_WHOLE_SIZE, 0);
    noc_vk_barrier(commands);
    return NOC_OK;
}

/* Moves what is known into a cache of more cells. */
static noc_status move_cache(vk_view *v, size_t tiles, vk_buffer *cache) {
    vk_learning *l = &v->learning;
    noc_learned *known = noc_learned_create(l->tiles, v->log);
    if (!known)
        return NOC_ERR_MEMORY;
    noc_status status = noc_vk_read(v->device, &l->cache, 0, l->head, sizeof(l->head));
    if (status == NOC_OK)
        status = noc_vk_read(v->device, &l->cache, sizeof(l->head), known->cells, l->cells * sizeof(*known->cells));
    if (status == NOC_OK)
        status = noc_learned_fit(known, tiles, v->log);
    if (status == NOC_OK)
        status = noc_vk_write(v->device, cache, 0, l->head, sizeof(l->head));
    if (status == NOC_OK)
        status = noc_vk_write(v->device, cache, sizeof(l->head), known->cells, known->count * sizeof(*known->cells));
    noc_learned_destroy(known);
    return status;
}

/* Room for the cells of a picture of so many tiles, with all that is known. */
static noc_status fit_cache(vk_view *v, size_t tiles) {
    vk_learning *l = &v->learning;
    size_t cells = noc_learned_cells(tiles);
    vk_buffer cache = { 0 };
    if (cells <= l->cells)
        return NOC_OK;
    noc_status status = make_cache(v, cells, &cache);
    if (status == NOC_OK && l->cells)
        status = move_cache(v, tiles, &cache);
    if (status == NOC_OK)
        status = noc_vk_wait_idle(v->device); /* frames in flight read the old one */
    noc_vk_free_buffer(v->device, status == NOC_OK ? &l->cache : &cache);
    if (status != NOC_OK)
        return status;
    l->cache = cache;
    l->cells = (uint32_t)cells;
    l->tiles = tiles;
    return NOC_OK;
}

noc_status noc_vk_view_fit_learning(vk_view *v, const frame_constants *c) {
    enum { MANY_ROWS = 1 << 16, A_TILE = 4 }; /* few tiles have as many cells as blocks */
    vk_learning *l = &v->learning;
    size_t tiles = tiles_of(v), rows = NOC_MIN(TILE_CELLS * tiles, NOC_MAX((size_t)MANY_ROWS, A_TILE * tiles));
    l->room = NOC_MIN(c->list + c->tail, (uint32_t)LIST_ROOM);
    l->rows = (uint32_t)rows;
    noc_status status = fit_cache(v, tiles);
    if (status == NOC_OK)
        status = noc_vk_fit_buffer(v, 4 * (SEEN_HEAD + tiles * (l->room + 1) + rows * (ROW_COUNTS + l->room)),
                                   "what lights are seen", &l->observed);
    if (status == NOC_OK)
        status = noc_vk_fit_buffer(v, (size_t)v->b.blocks_x * v->b.blocks_y * 4, "what lights are seen", &l->bright);
    return status;
}

void noc_vk_begin_learning(vk_view *v, uint32_t epoch, VkCommandBuffer commands) {
    vk_learning *l = &v->learning;
    bool forget = l->epoch != epoch;
    l->next_epoch = epoch;
    l->next_time = forget ? 1 : l->time + 1;
    if (forget)
        vkCmdFillBuffer(commands, l->cache.buffer, 0, VK_WHOLE_SIZE, 0);
    else
        vkCmdFillBuffer(commands, l->cache.buffer, 4 * (CACHE_HEAD + (VkDeviceSize)l->cells * CELL_WORDS),
                        VK_WHOLE_SIZE, 0); /* where runs begin their lists of observations */
    vkCmdFillBuffer(commands, l->observed.buffer, 0, 4 * SEEN_HEAD, 0);
    vkCmdFillBuffer(commands, l->bright.buffer, 0, VK_WHOLE_SIZE, 0);
}

void noc_vk_end_learning(vk_view *v) {
    v->learning.time = v->learning.next_time;
    v->learning.epoch = v->learning.next_epoch;
}

void noc_vk_free_learning(vk_view *v) {
    noc_vk_free_buffer(v->device, &v->learning.cache);
    noc_vk_free_buffer(v->device, &v->learning.observed);
    noc_vk_free_buffer(v->device, &v->learning.bright);
}
