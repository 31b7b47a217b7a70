#version 460
/* The tail of a tile's list: draws on a line of parts, then all draws down together, level by level. 11 barriers, and 2
 * a level. */
#extension GL_GOOGLE_include_directive : require
#include "list_group.glsl"
#include "bridge.glsl"
#include "list_tile.glsl"

/* The pool: the line, and then, in its place, 16 scores a draw; the state of each draw. */
#define POOL_LINE 0
#define POOL_SPARE 0
#define POOL_STATE (16 * LIST_ENTRIES)
#define STATE_GROUP 0 /* where the draw is: struct list_way */
#define STATE_PLACE 1
#define STATE_AT 2
#define STATE_SCORE 3
#define STATE_SHARE 4
#define STATE_FROM 5 /* the score where it fell */
#define STATE_WORDS 6
#define POOL_WORDS (POOL_STATE + STATE_WORDS * LIST_ENTRIES)
#define LINE_GROUPS 1024 /* LIST_GROUPS at most */

#include "list_score.glsl"

shared uint sixteen_[16];
shared uint found_[LIST_ENTRIES / 32];

void score_store(uint group, int l, float score) {
    pool_store(POOL_SPARE + 16u * (group - LIST_SPARE) + uint(l), score);
}

uint lay_line(uint groups, float scale) {
    settle(); /* the spare group is in its place */
    EACH_INDEX(i, LINE_GROUPS) pool_[POOL_LINE + i] = 0u;
    settle();
    EACH_GROUP(g, 0u, groups) {
        uint part = tail_parts(score_load(g, int(worker % 16u)), scale);
        if (part > 0u)
            atomicAdd(pool_[POOL_LINE + g], part);
    }
    settle();
    EACH_INDEX(i, 256u) {
        uint at = POOL_LINE + 4u * i;
        part_[i] = pool_[at] + pool_[at + 1u] + pool_[at + 2u] + pool_[at + 3u];
    }
    settle();
    if (worker < 16u) {
        uint sum = 0u;
        for (uint k = 0u; k < 16u; k++)
            sum += part_[16u * worker + k];
        sixteen_[worker] = sum;
    }
    settle();
    EACH_INDEX(i, 256u) {
        uint sum = 0u;
        for (uint k = 0u; k < i / 16u; k++)
            sum += sixteen_[k];
        for (uint k = i / 16u * 16u; k < i; k++)
            sum += part_[k];
        for (uint k = POOL_LINE + 4u * i; k < POOL_LINE + 4u * i + 4u; k++) {
            uint part = pool_[k];
            pool_[k] = sum;
            sum += part;
        }
    }
    uint all = 0u;
    for (uint k = 0u; k < 16u; k++)
        all += sixteen_[k];
    settle();
    return all;
}

/* ---- draws ---- */

void way_store(uint k, list_way w) {
    uint at = POOL_STATE + STATE_WORDS * k;
    pool_[at + STATE_GROUP] = word_of(w.group);
    pool_[at + STATE_PLACE] = w.p.place;
    pool_store(at + STATE_AT, w.p.at);
    pool_store(at + STATE_SCORE, w.score);
    pool_store(at + STATE_SHARE, w.share);
}
list_way way_load(uint k) {
    uint at = POOL_STATE + STATE_WORDS * k;
    return list_way(group_of(pool_[at + STATE_GROUP]), list_place(pool_[at + STATE_PLACE], pool_real(at + STATE_AT)),
                    pool_real(at + STATE_SCORE), pool_real(at + STATE_SHARE));
}
bool arrived(list_way w) { return w.p.place < 16u && w.share > 0.0; }

/* The last group that no part beyond goal lies before. */
uint group_at(uint groups, uint goal) {
    uint g = 0u;
    for (uint step = LINE_GROUPS / 2u; step > 0u; step /= 2u)
        if (g + step < groups && pool_[POOL_LINE + g + step] <= goal)
            g += step;
    return g;
}

void begin_draws(list_chosen c, float scale, tail_line line, uint all, uint most) {
    EACH_INDEX(i, uint(LIST_ENTRIES / 32)) found_[i] = 0u;
    EACH_INDEX(k, most) {
        uint goal = line.first + k * line.step;
        list_way w = list_way(list_group(0u, 0u, 0u), list_place(16u, 0.0), 0.0, 1.0);
        if (goal < all) {
            uint g = group_at(c.groups, goal);
            w.group = list_group_load(g);
            w.p = tail_place(g, scale, goal - pool_[POOL_LINE + g], line.rest);
            w.score = score_at(g, w.p.place);
            pool_store(POOL_STATE + STATE_WORDS * k + STATE_FROM, w.score);
        }
        way_store(k, w);
    }
    settle();
}

void go_down(uint patches, uint most) {
    uint levels = top_load(0u).levels;
    if (top_load(1u).levels > levels)
        levels = top_load(1u).levels;
    for (uint down = 0u; down < levels; down++) {
        EACH_GROUP(k, 0u, most) {
            list_way w = way_load(k);
            if (goes_down(w))
                score_group(group_below(w), patches, w.score, LIST_SPARE + k);
        }
        settle();
        EACH_INDEX(k, most) {
            list_way w = way_load(k);
            if (goes_down(w))
                way_store(k, way_down(w, LIST_SPARE + k));
        }
        settle();
    }
}

/* Numbers what the draws have found. */
uint keep_found(list_chosen c, float scale, tail_line line, uint most) {
    EACH_INDEX(k, most) if (arrived(way_load(k))) atomicOr(found_[k / 32u], 1u << k % 32u);
    settle();
    EACH_INDEX(k, most) {
        list_way w = way_load(k);
        if (arrived(w)) {
            uint i = c.entries + uint(bitCount(found_[k / 32u] & ((1u << k % 32u) - 1u)));
            for (uint word = 0u; word < k / 32u; word++)
                i += uint(bitCount(found_[word]));
            float from = pool_real(POOL_STATE + STATE_WORDS * k + STATE_FROM);
            entry_store(i, list_entry(cluster_light(w.group.part, w.group.block, w.p.place),
                                      tail_weight(line, from, scale, w.share)));
        }
    }
    uint count = c.entries;
    for (uint word = 0u; word < LIST_ENTRIES / 32u; word++)
        count += uint(bitCount(found_[word]));
    return count;
}

uint find_tail(uint patches, list_chosen c, float scale, tail_line line, uint all) {
    uint most = minu1(c.draws, LIST_ROOM - c.entries);
    begin_draws(c, scale, line, all, most);
    go_down(patches, most);
    return keep_found(c, scale, line, most);
}

void main() {
    uint patches = tile_load(TILE_PATCHES);
    list_chosen c = list_chosen(tile_load(TILE_GROUPS), tile_load(TILE_ENTRIES), tile_load(TILE_DRAWS));
    EACH_INDEX(i, 15u * patches) patch_[i] = tile_real(TILE_PATCH + i);
    EACH_INDEX(i, c.groups) group_[i] = tile_load(TILE_GROUP + i);
    settle();
    uint start = tail_start(FRAME.seed, tile_number_, FRAME.index);
    uint count = draw_tail(patches, c, start);
    if (FIRST_WORKER)
        tile_store(TILE_ENTRIES, count);
}
