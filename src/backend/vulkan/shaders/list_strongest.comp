#version 460
/* The strongest lights of a tile's list: patches of its surfaces, then nodes level by level, then lights. 4
 * barriers, 8 a level of nodes, and 5 for the lights. */
#extension GL_GOOGLE_include_directive : require
#include "list_group.glsl"
#include "bridge.glsl"
#include "list_tile.glsl"

/* The pool: 256 points of 8 words; then what is counted of a level. */
#define POOL_WORDS 2113
#define POOL_BINS 0
#define POOL_COARSE 1024
#define POOL_OVER 1056 /* how many scores are above a threshold */
#define POOL_SIXTEEN 1057
#define POOL_MARKS 1073  /* of each group: bits that are chosen, and of those that share the last step; by turns */
#define POOL_BEFORE 1585 /* counts of both in the groups before */
#define POOL_PARENTS 1841
#define POOL_SPARE 2097
#define MOST_GROUPS 256 /* of a level */

#include "list_score.glsl"

/* ---- surfaces ---- */

uint tile_pixels(uint block) {
    uint bits = 0u;
    for (uint i = 0u; i < 16u; i++)
        bits |= (pool_[8u * (16u * block + i) + 7u] != NO_SURFACE ? 1u : 0u) << i;
    return bits;
}
list_point tile_point(uint block, uint place) {
    uint at = 8u * (16u * block + place);
    return list_point(vec3(pool_real(at), pool_real(at + 1u), pool_real(at + 2u)),
                      vec3(pool_real(at + 3u), pool_real(at + 4u), pool_real(at + 5u)), pool_real(at + 6u),
                      pool_[at + 7u]);
}
void piece_store(uint i, uint pixels) { part_[i] = pixels; }
uint piece_load(uint i) { return part_[i]; }

void load_points() {
    EACH_INDEX(i, 16u * tile_blocks_) {
        receiver r = receiver_at(HERE.surfaces, block_of_tile(i / 16u), i % 16u);
        for (uint k = 0u; k < 3u; k++) {
            pool_store(8u * i + k, r.p[k]);
            pool_store(8u * i + 3u + k, r.n[k]);
        }
        pool_store(8u * i + 6u, r.depth);
        pool_[8u * i + 7u] = r.material;
    }
    settle();
}

/* ---- counts of a level ---- */

void score_store(uint group, int l, float score) {
    tile_store(TILE_SCORES + 16u * group + uint(l), score);
    uint step = floatBitsToUint(score) >> 21;
    if (step > 0u) {
        atomicAdd(pool_[POOL_BINS + step], 1u);
        atomicAdd(pool_[POOL_COARSE + step / 32u], 1u);
    }
}
void parent_store(uint i, float score) { pool_store(POOL_PARENTS + i, score); }
float parent_load(uint i) { return pool_real(POOL_PARENTS + i); }

uint marks_ = POOL_MARKS; /* of the level at hand */
uint other_marks() { return 2u * POOL_MARKS + MOST_GROUPS - marks_; }

void clear_bins() { EACH_INDEX(i, 1056u) pool_[POOL_BINS + i] = 0u; }

/* The least normal number is of step 4. */
uint some_scores(uint begin, uint end) {
    settle();
    EACH_INDEX(i, MOST_GROUPS) pool_[other_marks() + i] = 0u;
    if (FIRST_WORKER)
        pool_[POOL_OVER] = 0u;
    uint n = 0u;
    for (uint i = 0u; i < 32u; i++)
        n += pool_[POOL_COARSE + i];
    return n - pool_[POOL_BINS + 1] - pool_[POOL_BINS + 2] - pool_[POOL_BINS + 3];
}

uint scores_over(uint begin, uint end, float t) {
    uint n = 0u;
    EACH_GROUP(g, begin, end) n += score_load(g, int(worker % 16u)) >= t ? 1u : 0u;
    if (n > 0u)
        atomicAdd(pool_[POOL_OVER], n);
    settle();
    return pool_[POOL_OVER];
}

score_cut cut_scores(uint begin, uint end, uint most) {
    uint step = 1024u, over = 0u;
    while (step > 32u && over + pool_[POOL_COARSE + step / 32u - 1u] <= most) {
        over += pool_[POOL_COARSE + step / 32u - 1u];
        step -= 32u;
    }
    while (step > 1u && over + pool_[POOL_BINS + step - 1u] <= most) {
        over += pool_[POOL_BINS + step - 1u];
        step--;
    }
    return score_cut(step, most - over);
}

/* ---- numbers of the chosen ---- */

uint counts_of(uint marks) { return uint(bitCount(marks & 0xffffu)) | uint(bitCount(marks >> 16)) << 16; }

/* Marks what is chosen, and counts what lies before each group. */
void mark_places(uint begin, uint end, score_cut c) {
    EACH_GROUP(g, begin, end) {
        uint step = floatBitsToUint(score_load(g, int(worker % 16u))) >> 21;
        uint bit = 1u << worker % 16u;
        if (step >= c.sure)
            atomicOr(pool_[marks_ + g - begin], bit);
        else if (c.sure > 1u && step == c.sure - 1u)
            atomicOr(pool_[marks_ + g - begin], bit << 16);
    }
    settle();
    clear_bins();
    if (worker < 16u) {
        uint sum = 0u;
        for (uint i = 0u; i < 16u; i++)
            sum += counts_of(pool_[marks_ + 16u * worker + i]);
        pool_[POOL_SIXTEEN + worker] = sum;
    }
    settle();
    EACH_INDEX(i, end - begin) {
        uint sum = 0u;
        for (uint k = 0u; k < i / 16u; k++)
            sum += pool_[POOL_SIXTEEN + k];
        for (uint k = i / 16u * 16u; k < i; k++)
            sum += counts_of(pool_[marks_ + k]);
        pool_[POOL_BEFORE + i] = sum;
    }
    settle();
}

uint take_places(uint begin, uint end, score_cut c) {
    mark_places(begin, end, c);
    uint bit = worker % 16u;
    EACH_GROUP(g, begin, end) {
        uint marks = pool_[marks_ + g - begin];
        uint before = pool_[POOL_BEFORE + g - begin] + counts_of(marks & 0x10001u * ((1u << bit) - 1u));
        uint ties = before >> 16;
        if ((marks >> bit & 1u) != 0u || ((marks >> bit >> 16 & 1u) != 0u && ties < c.room)) {
            uint i = (before & 0xffffu) + minu1(ties, c.room);
            take_place(g, bit, i, end + i);
        }
    }
    marks_ = other_marks();
    uint all = 0u;
    for (uint i = 0u; i < 16u; i++)
        all += pool_[POOL_SIXTEEN + i];
    return (all & 0xffffu) + minu1(all >> 16, c.room);
}

void main() {
    load_points();
    uint patches = make_patches(tile_blocks_, splat3(FRAME.camera.eye));
    list_chosen c = list_chosen(0u, 0u, 0u);
    if (patches > 0u) {
        clear_bins();
        EACH_INDEX(i, MOST_GROUPS) pool_[POOL_MARKS + i] = 0u;
        c = list_strongest(patches, minu1(FRAME.list, LIST_ENTRIES), minu1(FRAME.tail, LIST_ENTRIES));
        settle();
    }
    EACH_INDEX(i, 15u * patches) tile_store(TILE_PATCH + i, patch_[i]);
    EACH_INDEX(i, c.groups) tile_store(TILE_GROUP + i, group_[i]);
    if (FIRST_WORKER) {
        tile_store(TILE_PATCHES, patches);
        tile_store(TILE_GROUPS, c.groups);
        tile_store(TILE_ENTRIES, c.entries);
        tile_store(TILE_DRAWS, c.draws);
    }
}
