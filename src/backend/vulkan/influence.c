/* Influence volumes on the device (influence_memory.h). They are the CPU backend's: what they are fitted to is found by
 * rays, which it traces, so that both machines find the same lights. */
#include "backend/vulkan/influence_memory.h"
#include "backend/vulkan/vulkan.h"

_Static_assert(sizeof(noc_influence_volume) == 4 * VOLUME_WORDS && sizeof(noc_influence_node) == 4 * NODE_WORDS &&
                   sizeof(noc_influence_box) == 24 && sizeof(noc_influence_rule) == 20,
               "records are those that shaders read");
_Static_assert((int)NOC_RULE_BINS *BIN_WORDS *(FOUND_MOST_GROUPS - 1) == FOUND_POOL &&
                   FOUND_MOST_GROUPS == 1 + NOC_QUERY_BLOCKS * NOC_QUERY_POINTS,
               "the pool has room for the bins of all groups");

/* ---- the volumes as shaders read them ---- */

/* What is being packed: words, or their number where there are none yet. */
typedef struct packing {
    char *words;
    size_t bytes;
} packing;

/* Appends an array; returns the word where it begins, 0: it is empty. */
static uint32_t put(packing *p, const void *data, size_t bytes) {
    uint32_t at = (uint32_t)(p->bytes / 4);
    if (!data || !bytes)
        return 0;
    if (p->words)
        memcpy(p->words + p->bytes, data, bytes);
    p->bytes += bytes;
    return at;
}

static uint32_t word_of(float x) {
    uint32_t word;
    memcpy(&word, &x, sizeof(word));
    return word;
}

static void put_half(packing *p, const noc_influence_half *h, uint32_t head[HALF_WORDS]) {
    uint32_t nodes = (h->count + 255) / 256;
    head[HALF_FIRST] = h->first;
    head[HALF_END] = h->first + h->count;
    head[HALF_NODES] = nodes;
    if (h->levels)
        head[HALF_CHILDREN] = put(p, h->nodes + h->level_at[0], nodes * sizeof(*h->nodes));
    if (h->levels > 1)
        head[HALF_PARENTS] = put(p, h->nodes + h->level_at[1], (nodes + 15) / 16 * sizeof(*h->nodes));
}

static void put_volumes(packing *p, const noc_influence *v) {
    uint32_t head[VOLUMES_HEAD] = {
        [VOLUMES_COUNT] = v->count, [VOLUMES_SCALE] = word_of(v->scale), [VOLUMES_USUAL] = word_of(v->usual)
    };
    size_t volumes = v->volume_count;
    memcpy(head + VOLUMES_RULE, &v->rule, sizeof(v->rule));
    p->bytes = sizeof(head);
    head[VOLUMES_RECORDS] = put(p, v->volumes, (volumes + 1) * sizeof(*v->volumes));
    head[VOLUMES_OF_LIGHT] = put(p, v->volume_of, v->count * sizeof(*v->volume_of));
    head[VOLUMES_IDS] = put(p, v->ids, v->listed * sizeof(*v->ids));
    head[VOLUMES_FIRST] = put(p, v->first, (volumes + 1) * sizeof(*v->first));
    if (v->boxes) {
        head[VOLUMES_BOX_OF] = put(p, v->box_of, (volumes + 1) * sizeof(*v->box_of));
        head[VOLUMES_BOXES] = put(p, v->boxes, ((size_t)v->box_count + 1) * sizeof(*v->boxes));
    }
    for (uint32_t k = 0; k < NOC_HALVES; k++)
        put_half(p, &v->half[k], head + VOLUMES_HALF + k * HALF_WORDS);
    if (p->words)
        memcpy(p->words, head, sizeof(head));
}

void *noc_vk_pack_influence(const noc_influence *influence, size_t *bytes) {
    packing p = { NULL, 0 };
    put_volumes(&p, influence);
    *bytes = p.bytes;
    p.words = noc_alloc_large(p.bytes, 1);
    if (p.words)
        put_volumes(&p, influence);
    return p.words;
}

/* ---- what a frame draws from ---- */

noc_status noc_vk_get_influence(vk_view *v, const noc_frame *frame) {
    noc_light_set_release(v->world->lights_set, &v->sources);
    noc_status status = noc_vk_influence(v, frame->params, &v->sources.influence);
    if (status != NOC_OK)
        return status;
    const noc_influence *volumes = v->sources.influence;
    noc_light_set_note(volumes, frame->params, &v->drawn);
    v->drawn.bytes = volumes->bytes;
    for (int i = 0; i < NOC_INFLUENCE_STEPS; i++)
        v->drawn.build_seconds += volumes->seconds[i];
    v->found_bins = noc_found_bins(v->scene->lights.len);
    return noc_vk_fit_buffer(v, 4 * (size_t)v->found_bins, "influence", &v->found);
}

void noc_vk_clear_found(vk_view *v, VkCommandBuffer commands) {
    if (v->sources.influence)
        vkCmdFillBuffer(commands, v->found.buffer, 0, VK_WHOLE_SIZE, 0);
}

static uint64_t surfaces_finding(const void *counts, uint32_t lights) { return ((const uint32_t *)counts)[lights]; }

void noc_vk_note_found(vk_view *v, noc_light_stats *out) {
    uint32_t bins = v->found_bins, *counts = noc_alloc_large(bins, sizeof(*counts));
    pthread_mutex_lock(&v->device->lock);
    if (counts && bins && v->found.bytes &&
        noc_vk_read(v->device, &v->found, 0, counts, bins * sizeof(*counts)) == NOC_OK)
        noc_light_set_note_found(surfaces_finding, counts, bins, out);
    pthread_mutex_unlock(&v->device->lock);
    free(counts);
}
