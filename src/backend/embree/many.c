/* Many shadow rays at once. What a ray costs is decided by its company: neighbours' rays to one light visit the same
 * nodes and make a packet; rays to sixteen lights do not, and as a packet are hardly faster than one by one.
 * bench/bench_rays has the figures. */
#include "backend/embree/embree.h"

enum { RAYS = MANY_BLOCKS * BLOCK, SLOTS = 2 * RAYS };

/* Rays (block * BLOCK + lane) by group; group g is at[start[g]] to at[start[g + 1]]. A group leads to one light, in one
 * octant of directions: packets of more than one octant are taken apart by Embree. */
typedef struct grouping {
    uint16_t at[RAYS], start[RAYS + 1];
    int groups, count;
} grouping;

static uint64_t group_key(const shadow_block *b, int l) {
    uint32_t octant = (b->rays.d[0][l] < 0) | (b->rays.d[1][l] < 0) << 1 | (b->rays.d[2][l] < 0) << 2;
    return (uint64_t)b->light[l] << 3 | octant;
}

/* Groups are numbered as they come, so the result is the same everywhere. */
static void group_rays(const shadow_block *blocks, int count, grouping *g) {
    uint64_t keys[RAYS];
    uint16_t slots[SLOTS], ray[RAYS], group[RAYS];
    memset(slots, 0xff, sizeof(slots));
    g->groups = g->count = 0;
    for (int i = 0; i < count; i++)
        for (uint32_t bits = blocks[i].valid; bits; bits &= bits - 1) {
            int l = __builtin_ctz(bits);
            uint64_t key = group_key(&blocks[i], l);
            uint32_t slot = (uint32_t)(key * 0x9e3779b97f4a7c15u >> 40) % SLOTS;
            while (slots[slot] != UINT16_MAX && keys[slots[slot]] != key)
                slot = (slot + 1) % SLOTS;
            if (slots[slot] == UINT16_MAX) {
                slots[slot] = (uint16_t)g->groups;
                keys[g->groups] = key;
                g->start[++g->groups] = 0;
            }
            ray[g->count] = (uint16_t)(i * BLOCK + l);
            group[g->count++] = slots[slot];
            g->start[slots[slot] + 1]++;
        }
    uint16_t next[RAYS];
    g->start[0] = 0;
    for (int i = 0; i < g->groups; i++) {
        next[i] = g->start[i];
        g->start[i + 1] = (uint16_t)(g->start[i + 1] + g->start[i]);
    }
    for (int i = 0; i < g->count; i++)
        g->at[next[group[i]]++] = ray[i];
}

static void mark_clear(shadow_block *blocks, uint16_t ray) { blocks[ray / BLOCK].unoccluded |= 1u << ray % BLOCK; }

/* Up to 16 rays. */
static void trace_packet(RTCScene scene, shadow_block *blocks, const uint16_t *at, int n) {
    ALIGNED int lanes[BLOCK];
    ALIGNED struct RTCRay16 r;
    for (int l = 0; l < BLOCK; l++) {
        const rayblock *b = &blocks[at[l < n ? l : 0] / BLOCK].rays;
        int from = at[l < n ? l : 0] % BLOCK;
        lanes[l] = -(l < n);
        r.org_x[l] = b->o[0][from];
        r.org_y[l] = b->o[1][from];
        r.org_z[l] = b->o[2][from];
        r.dir_x[l] = b->d[0][from];
        r.dir_y[l] = b->d[1][from];
        r.dir_z[l] = b->d[2][from];
        r.tnear[l] = r.time[l] = 0;
        r.tfar[l] = 1;
        r.mask[l] = UINT32_MAX;
        r.id[l] = r.flags[l] = 0;
    }
    rt_occluded16(lanes, scene, &r);
    for (int l = 0; l < n; l++)
        if (r.tfar[l] >= 0)
            mark_clear(blocks, at[l]);
}

/* Rays without company. */
static void trace_rest(RTCScene scene, shadow_block *blocks, const uint16_t *at, int n) {
#ifdef RT_STREAMS
    struct RTCRay r[RAYS];
    for (int i = 0; i < n; i++) {
        const rayblock *b = &blocks[at[i] / BLOCK].rays;
        int l = at[i] % BLOCK;
        r[i] = (struct RTCRay){ .org_x = b->o[0][l],
                                .org_y = b->o[1][l],
                                .org_z = b->o[2][l],
                                .dir_x = b->d[0][l],
                                .dir_y = b->d[1][l],
                                .dir_z = b->d[2][l],
                                .tfar = 1,
                                .mask = UINT32_MAX };
    }
    if (n)
        rt_occluded_stream(scene, r, (unsigned)n);
    for (int i = 0; i < n; i++)
        if (r[i].tfar >= 0)
            mark_clear(blocks, at[i]);
#else
    for (int i = 0; i < n; i += BLOCK)
        trace_packet(scene, blocks, at + i, NOC_MIN(BLOCK, n - i));
#endif
}

void noc_embree_trace_many(RTCScene scene, shadow_block *blocks, int count) {
    grouping g;
    uint16_t rest[RAYS];
    int left = 0;
    for (int i = 0; i < count; i++)
        blocks[i].unoccluded = 0;
    group_rays(blocks, count, &g);
    for (int i = 0; i < g.groups; i++) {
        int from = g.start[i], to = g.start[i + 1];
        for (; to - from >= BLOCK; from += BLOCK)
            trace_packet(scene, blocks, g.at + from, BLOCK);
        while (from < to)
            rest[left++] = g.at[from++];
    }
    trace_rest(scene, blocks, rest, left);
}
