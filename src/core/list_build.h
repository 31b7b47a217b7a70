/* core/list_build.h: a tile's light list. From the top levels of the clusters down, the nodes with the highest scores
 * are opened: their 16 children, and in the end the lights of clusters, take their place. The strongest lights are
 * listed; what is left, closed nodes and lights, is what the tail is drawn from. So the work does not grow with the
 * number of lights, only with the number of levels.
 *
 * There may be two hierarchies, of lights that stand and of lights that move (`part` 0 and 1). Nodes of both are chosen
 * among together. */
#ifndef CORE_LIST_BUILD_H
#define CORE_LIST_BUILD_H

#include "core/list_scores.h"

/* A hierarchy of clusters: how many levels it has, and how many nodes its highest one. */
struct list_top {
    u1 levels;
    u1 nodes;
};

/* What a group of 16 scores is of: children of node `block`, or block `block` of the highest level. They are nodes so
 * many levels above lights; 0: lights. */
struct list_group {
    u1 part;
    u1 level;
    u1 block;
};

/* One light of a list. */
struct list_entry {
    u1 light;
    f1 weight;
};

struct list_size {
    u1 count;
    u1 copies; /* of every light: count / copies are told apart */
};

/* Groups from `first` to `count` are of lights. */
struct list_opened {
    u1 first;
    u1 count;
};

/* A place among 16, and where in it: 0 to 1. 16: none. */
struct list_place {
    u1 place;
    f1 at;
};

/* A light, and the probability of having been found; 0: none was. */
struct list_found {
    u1 light;
    f1 share;
};

#ifndef CORE_GLSL
typedef struct list_top list_top;
typedef struct list_group list_group;
typedef struct list_entry list_entry;
typedef struct list_size list_size;
typedef struct list_opened list_opened;
typedef struct list_place list_place;
typedef struct list_found list_found;
#endif

FN list_top top_load(CTX u1 part);
FN u1 cluster_light(CTX u1 part, u1 cluster, u1 place);
FN void list_group_store(CTX u1 group, list_group g);
FN list_group list_group_load(CTX u1 group);
FN void group_sum_store(CTX u1 group, f1 sum);
FN f1 group_sum(CTX u1 group);
FN void entry_store(CTX u1 i, list_entry e); /* of the tile's list: LIST_ROOM of them */
FN list_entry entry_load(CTX u1 i);

/* Scores what the children of a node, or a block of the highest level, could give. score: of the node. */
FN1 void score_group(CTX list_group g, u1 patches, f1 score, u1 group) {
    if (g.level > 0u)
        score_nodes(PASS g.part, g.level - 1u, g.block, patches, group);
    else
        score_lights(PASS g.part, g.block, patches, score, group);
}

/* How many nodes of the lowest level reached are to be opened: all, where they are few, for then their lights may all
 * be listed; else those that hold more than a 3,000th of all scores; never more than `most`. */
FN1 u1 worth_opening(CTX u1 begin, u1 end, u1 most) {
    f1 all = 0.0f;
    for (u1 g = 0u; g < end; g++)
        all = all + score_sum(PASS g);
    if (scores_over(PASS begin, end, 1.17549435e-38f) <= U32(FEW_NODES))
        return U32(FEW_NODES);
    return minu1(most, scores_over(PASS begin, end, max1(all * (1.0f / 3000.0f), 1.17549435e-38f)));
}

/* Groups from the top levels down to lights. */
FN1 list_opened open_nodes(CTX u1 patches) {
    list_top still = top_load(PASS 0u);
    list_top moving = top_load(PASS 1u);
    list_opened o;
    o.first = 0u;
    o.count = 0u;
    u1 level = still.levels;
    if (moving.levels > level)
        level = moving.levels;
    for (; level > 0u; level--) {
        for (u1 k = 0u; k < 2u; k++) {
            list_top top = still;
            if (k == 1u)
                top = moving;
            for (u1 b = 0u; top.levels == level && b < (top.nodes + 15u) / 16u; b++) {
                list_group g;
                g.part = k;
                g.level = level;
                g.block = b;
                list_group_store(PASS o.count, g);
                score_group(PASS g, patches, 0.0f, o.count);
                o.count++;
            }
        }
        u1 most = U32(OPENED_CLUSTERS);
        if (level > 1u)
            most = U32(OPENED_NODES);
        u1 open = choose_largest(PASS o.first, o.count, worth_opening(PASS o.first, o.count, most));
        o.first = o.count;
        for (u1 i = 0u; i < open; i++) {
            u1 chosen = chosen_load(PASS i);
            list_group g = list_group_load(PASS chosen / 16u);
            g.level--;
            g.block = 16u * g.block + chosen % 16u;
            list_group_store(PASS o.count, g);
            score_group(PASS g, patches, score_at(PASS chosen / 16u, chosen % 16u), o.count);
            score_clear(PASS chosen / 16u, chosen % 16u);
            o.count++;
        }
    }
    return o;
}

/* The place that holds the share `at` (0..1) of a group's scores, and what is left of that there, as a share of the
 * place's own. */
FN1 list_place place_at(CTX u1 group, f1 total, f1 at) {
    f1 sum = 0.0f;
    EXACT f1 goal = at * total;
    f1 last = 0.0f;
    list_place p;
    p.place = 16u;
    p.at = at;
    b1 on = true;
    for (u1 i = 0u; i < 16u && on; i++) {
        f1 score = score_at(PASS group, i);
        if (score > 0.0f) {
            p.place = i;
            last = score;
            on = sum + score <= goal;
            if (on)
                sum = sum + score;
        }
    }
    if (p.place < 16u) {
        EXACT f1 rest = (goal - sum) / last;
        p.at = min1(max1(rest, 0.0f), 1.0f);
    }
    return p;
}

/* A light below a place of a group, by the scores on the way down from it. */
FN1 list_found descend(CTX u1 patches, list_group g, list_place from, f1 score) {
    list_found f;
    f1 share = 1.0f;
    list_place p = from;
    while (g.level > 0u && p.place < 16u) {
        g.level--;
        g.block = 16u * g.block + p.place;
        score_group(PASS g, patches, score, U32(LIST_SPARE));
        f1 total = score_sum(PASS U32(LIST_SPARE));
        p = place_at(PASS U32(LIST_SPARE), total, p.at);
        if (p.place < 16u) {
            score = score_at(PASS U32(LIST_SPARE), p.place);
            share = share * (score / total);
        }
    }
    f.light = 0u;
    f.share = 0.0f;
    if (p.place < 16u) {
        f.light = cluster_light(PASS g.part, g.block, p.place);
        f.share = share;
    }
    return f;
}

/* `draws` systematic draws over the nodes that stayed closed and the lights that were not listed. Returns the entries
 * that there are then. */
FN1 u1 draw_tail(CTX u1 patches, u1 groups, u1 draws, f1 rotation, u1 count) {
    long_sum total;
    total.high = 0.0f;
    total.low = 0.0f;
    for (u1 g = 0u; g < groups; g++) {
        f1 one = score_sum(PASS g);
        group_sum_store(PASS g, one);
        if (one > 0.0f)
            total = long_add(total, one);
    }
    if (!(total.high > 0.0f) || draws == 0u)
        return count;
    EXACT f1 step = total.high / F32(draws);
    EXACT f1 first = step * rotation;
    long_sum next;
    next.high = first;
    next.low = 0.0f;
    long_sum before;
    before.high = 0.0f;
    before.low = 0.0f;
    u1 drawn = 0u;
    u1 most = minu1(draws, U32(LIST_ROOM) - count);
    for (u1 g = 0u; g < groups && drawn < most; g++) {
        f1 sum = group_sum(PASS g);
        if (sum > 0.0f) {
            long_sum after = long_add(before, sum);
            for (; drawn < most && long_difference(next, after) < 0.0f; drawn++) {
                EXACT f1 at = long_difference(next, before) / sum;
                next = long_add(next, step);
                list_place p = place_at(PASS g, sum, at);
                if (p.place < 16u) {
                    f1 score = score_at(PASS g, p.place);
                    list_found f = descend(PASS patches, list_group_load(PASS g), p, score);
                    if (f.share > 0.0f) {
                        EXACT f1 weight = step / score / f.share;
                        list_entry e;
                        e.light = f.light;
                        e.weight = weight;
                        entry_store(PASS count, e);
                        count++;
                    }
                }
            }
            before = after;
        }
    }
    return count;
}

/* The list of a tile of so many blocks, seen from eye: `listed` lights and a tail of `drawn`. rotation (core/random.h,
 * tail_start) does not depend on what the tile sees. */
FN1 list_size list_build(CTX u1 blocks, f3 eye, u1 listed, u1 drawn, f1 rotation) {
    list_size size;
    size.count = 0u;
    size.copies = 1u;
    u1 patches = make_patches(PASS blocks, eye);
    if (patches == 0u)
        return size;
    list_opened o = open_nodes(PASS patches);
    u1 most = minu1(listed, U32(LIST_ENTRIES));
    u1 tail = minu1(drawn, U32(LIST_ENTRIES));
    /* A list without a tail where that holds all lights. */
    if (scores_over(PASS 0u, o.first, 1.17549435e-38f) == 0u &&
        scores_over(PASS o.first, o.count, 1.17549435e-38f) <= most + tail)
        most = most + tail;
    u1 chosen = choose_largest(PASS o.first, o.count, most);
    for (u1 i = 0u; i < chosen; i++) {
        u1 at = chosen_load(PASS i);
        list_group g = list_group_load(PASS at / 16u);
        list_entry e;
        e.light = cluster_light(PASS g.part, g.block, at % 16u);
        e.weight = 1.0f;
        entry_store(PASS i, e);
        score_clear(PASS at / 16u, at % 16u);
    }
    size.count = draw_tail(PASS patches, o.count, tail, rotation, chosen);
    return size;
}

/* A list with room to spare holds its lights several times, each time to be looked at in another point: up to a ray's
 * worth, and in all not in fewer points than the pixel's draws would be (a large light close by differs more from place
 * to place than from light to light). room: entries that there may be; rays, draws: of a pixel. */
FN1 list_size list_fill(CTX list_size size, u1 room, u1 rays, u1 draws) {
    u1 once = size.count;
    if (once == 0u)
        return size;
    u1 wanted = draws / once;
    if (wanted < rays)
        wanted = rays;
    u1 copies = minu1(minu1(room, U32(LIST_ROOM)) / once, wanted);
    if (copies < 2u)
        return size;
    /* Side by side: rays that are an equal distance apart would find the same light again in each round of all of them.
     */
    for (u1 i = once * copies; i-- > 0u;) {
        list_entry e = entry_load(PASS i / copies);
        EXACT f1 weight = e.weight / F32(copies);
        e.weight = weight;
        entry_store(PASS i, e);
    }
    size.count = once * copies;
    size.copies = copies;
    return size;
}

#endif
