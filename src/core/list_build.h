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
#include "core/list_tail.h"

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

/* What is chosen before the tail: so many groups, entries, and draws that are left to the tail. */
struct list_chosen {
    u1 groups;
    u1 entries;
    u1 draws;
};

#ifndef CORE_GLSL
typedef struct list_top list_top;
typedef struct list_group list_group;
typedef struct list_entry list_entry;
typedef struct list_size list_size;
typedef struct list_chosen list_chosen;
#endif

/* A place of a group that a draw of the tail has come to, its score, and the probability with which it came there from
 * where it fell on the line. p.place 16: nowhere. */
struct list_way {
    list_group group;
    list_place p;
    f1 score;
    f1 share;
};

#ifndef CORE_GLSL
typedef struct list_way list_way;
#endif

FN list_top top_load(CTX u1 part);
FN u1 cluster_light(CTX u1 part, u1 cluster, u1 place);
FN void list_group_store(CTX u1 group, list_group g);
FN list_group list_group_load(CTX u1 group);
FN void parent_store(CTX u1 i, f1 score); /* of the node whose children are group i of the level at hand */
FN f1 parent_load(CTX u1 i);
FN void line_store(CTX u1 group, u1 before); /* parts of the tail's line that lie before the group's */
FN u1 line_load(CTX u1 group);
FN void entry_store(CTX u1 i, list_entry e); /* of the tile's list: LIST_ROOM of them */
FN list_entry entry_load(CTX u1 i);

/* Scores what the children of a node, or a block of the highest level, could give. score: of the node. */
FN1 void score_group(CTX list_group g, u1 patches, f1 score, u1 group) {
    if (g.level > 0u)
        score_nodes(PASS g.part, g.level - 1u, g.block, patches, group);
    else
        score_lights(PASS g.part, g.block, patches, score, group);
}

/* ---- the strongest ---- */

/* Stores the groups of a hierarchy's highest level, from number `group` on. Returns how many. */
FN1 u1 top_groups(CTX u1 part, u1 group) {
    list_top top = top_load(PASS part);
    u1 blocks = (top.nodes + 15u) / 16u;
    EACH_INDEX(b, blocks) {
        list_group g;
        g.part = part;
        g.level = top.levels;
        g.block = b;
        list_group_store(PASS group + b, g);
    }
    return blocks;
}

/* How many of the nodes that were reached last, of which `some` have a score, are to be opened: all where they are few,
 * for then their lights may all be listed; else those that hold more than a 3,000th of all scores, up to a limit. */
FN1 u1 worth_opening(CTX u1 begin, u1 end, u1 level, u1 some) {
    u1 most = U32(FEW_NODES);
    if (some > U32(FEW_NODES)) {
        most = U32(OPENED_CLUSTERS);
        if (level > 1u)
            most = U32(OPENED_NODES);
        f1 all = groups_sum(PASS end);
        most = minu1(most, scores_over(PASS begin, end, max1(all * (1.0f / 3000.0f), 1.17549435e-38f)));
    }
    return most;
}

/* Place `place` of a group is chosen, as number i of its level: a node's children become a group, number `to`, and a
 * light becomes an entry. */
FN1 void take_place(CTX u1 group, u1 place, u1 i, u1 to) {
    list_group g = list_group_load(PASS group);
    if (g.level > 0u) {
        parent_store(PASS i, score_at(PASS group, place));
        g.level--;
        g.block = 16u * g.block + place;
        list_group_store(PASS to, g);
    } else {
        list_entry e;
        e.light = cluster_light(PASS g.part, g.block, place);
        e.weight = 1.0f;
        entry_store(PASS i, e);
    }
    score_clear(PASS group, place);
}

/* Takes what a cut leaves of the groups, in the order of their places. Returns how many. */
#ifdef CORE_WORKERS
u1 take_places(u1 begin, u1 end, score_cut c);
#else
FN1 u1 take_places(CTX u1 begin, u1 end, score_cut c) {
    f1 sure = score_step(c.sure);
    f1 tie = score_step(c.sure - U32(c.sure > 1u));
    u1 room = c.room;
    u1 n = 0u;
    for (u1 g = begin; g < end; g++) {
        u1 over = places_over(PASS g, sure);
        for (u1 bits = places_over(PASS g, tie); bits != 0u; bits = bits & (bits - 1u)) {
            u1 place = low_bit(bits);
            b1 sharing = (over >> place & 1u) == 0u;
            if (!sharing || room > 0u) {
                take_place(PASS g, place, n, end + n);
                n++;
                if (sharing)
                    room--;
            }
        }
    }
    return n;
}
#endif

/* Opens nodes level by level, and lists the strongest lights: `listed` of them, or, where nothing is left for a tail of
 * `drawn`, all. */
FN1 list_chosen list_strongest(CTX u1 patches, u1 listed, u1 drawn) {
    list_chosen c;
    c.groups = 0u;
    c.entries = 0u;
    c.draws = drawn;
    u1 level = top_load(PASS 0u).levels;
    if (top_load(PASS 1u).levels > level)
        level = top_load(PASS 1u).levels;
    u1 first = 0u;
    u1 closed = 0u; /* nodes with a score that were not opened */
    b1 on = level > 0u;
    while (on) {
        for (u1 part = 0u; part < 2u; part++)
            if (level > 0u && top_load(PASS part).levels == level)
                c.groups = c.groups + top_groups(PASS part, c.groups);
        SETTLE;
        EACH_GROUP(g, first, c.groups)
        score_group(PASS list_group_load(PASS g), patches, parent_load(PASS g - first), g);
        u1 some = some_scores(PASS first, c.groups);
        u1 most = listed;
        if (level > 0u)
            most = worth_opening(PASS first, c.groups, level, some);
        else if (closed == 0u && some <= listed + drawn)
            most = listed + drawn;
        u1 taken = take_places(PASS first, c.groups, cut_scores(PASS first, c.groups, most));
        closed = closed + some - minu1(some, taken);
        on = level > 0u;
        if (on) {
            first = c.groups;
            c.groups = c.groups + taken;
            level--;
        } else
            c.entries = taken;
    }
    return c;
}

/* ---- the tail ---- */

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

FN1 b1 goes_down(list_way w) { return w.group.level > 0u && w.p.place < 16u; }

FN1 list_group group_below(list_way w) {
    list_group g = w.group;
    g.level--;
    g.block = 16u * g.block + w.p.place;
    return g;
}

/* On to a child of the place, by the children's scores in a group. */
FN1 list_way way_down(CTX list_way from, u1 scores) {
    list_way w;
    f1 total = score_sum(PASS scores);
    w.group = group_below(from);
    w.p = place_at(PASS scores, total, from.p.at);
    w.score = 0.0f;
    w.share = 0.0f;
    if (w.p.place < 16u) {
        w.score = score_at(PASS scores, w.p.place);
        w.share = from.share * (w.score / total);
    }
    return w;
}

/* Lays the groups' parts on a line. Returns its length. */
#ifdef CORE_WORKERS
u1 lay_line(u1 groups, f1 scale);
u1 find_tail(u1 patches, list_chosen c, f1 scale, tail_line line, u1 all);
#else
FN1 u1 lay_line(CTX u1 groups, f1 scale) {
    u1 all = 0u;
    for (u1 g = 0u; g < groups; g++) {
        u32 parts = KU(0u);
        line_store(PASS g, all);
        EACH16(l)
        parts = parts + tail_parts(score_load(PASS g, l), scale);
        all = all + EACH16_SUM(lane_sum(parts));
    }
    line_store(PASS groups, all);
    return all;
}

/* Adds what the draws find to the entries. Returns how many there are then. all: length of the line. */
FN1 u1 find_tail(CTX u1 patches, list_chosen c, f1 scale, tail_line line, u1 all) {
    u1 count = c.entries;
    u1 goal = line.first;
    u1 most = minu1(c.draws, U32(LIST_ROOM) - count);
    u1 g = 0u;
    for (u1 k = 0u; k < most && goal < all; k++) {
        while (line_load(PASS g + 1u) <= goal)
            g++;
        list_way w;
        w.group = list_group_load(PASS g);
        w.p = tail_place(PASS g, scale, goal - line_load(PASS g), line.rest);
        w.score = score_at(PASS g, w.p.place);
        w.share = 1.0f;
        f1 fell = w.score;
        while (goes_down(w)) {
            score_group(PASS group_below(w), patches, w.score, U32(LIST_SPARE));
            w = way_down(PASS w, U32(LIST_SPARE));
        }
        if (w.share > 0.0f) {
            list_entry e;
            e.light = cluster_light(PASS w.group.part, w.group.block, w.p.place);
            e.weight = tail_weight(line, fell, scale, w.share);
            entry_store(PASS count, e);
            count++;
        }
        goal = goal + line.step;
    }
    return count;
}
#endif

/* Systematic draws over the nodes that stayed closed and the lights that were not listed. Returns the entries that
 * there are then. start: 32 bits (core/random.h, tail_start), which do not depend on what the tile sees. */
FN1 u1 draw_tail(CTX u1 patches, list_chosen c, u1 start) {
    f1 total = groups_sum(PASS c.groups);
    u1 count = c.entries;
    if (total > 0.0f && c.draws > 0u) {
        f1 scale = tail_scale(total);
        u1 all = lay_line(PASS c.groups, scale);
        count = find_tail(PASS patches, c, scale, tail_line_of(all, c.draws, start), all);
    }
    return count;
}

/* The list of a tile of so many blocks, seen from eye: `listed` lights and a tail of `drawn`. */
FN1 list_size list_build(CTX u1 blocks, f3 eye, u1 listed, u1 drawn, u1 start) {
    list_size size;
    size.count = 0u;
    size.copies = 1u;
    u1 patches = make_patches(PASS blocks, eye);
    if (patches > 0u) {
        list_chosen c = list_strongest(PASS patches, minu1(listed, U32(LIST_ENTRIES)), minu1(drawn, U32(LIST_ENTRIES)));
        size.count = draw_tail(PASS patches, c, start);
    }
    return size;
}

/* How many times a list with room to spare holds each of its lights, each time to be looked at in another point: up to
 * a ray's worth, and in all not in fewer points than the pixel's draws would be (a large light close by differs more
 * from place to place than from light to light). once: lights; room: entries that there may be; rays, draws: of a
 * pixel. */
FN1 u1 list_copies(u1 once, u1 room, u1 rays, u1 draws) {
    u1 copies = 1u;
    if (once > 0u) {
        u1 wanted = draws / once;
        if (wanted < rays)
            wanted = rays;
        copies = minu1(minu1(room, U32(LIST_ROOM)) / once, wanted);
        if (copies < 1u)
            copies = 1u;
    }
    return copies;
}

/* One of a light's copies. */
FN1 list_entry entry_copy(list_entry e, u1 copies) {
    if (copies > 1u) {
        EXACT f1 weight = e.weight / F32(copies);
        e.weight = weight;
    }
    return e;
}

/* Copies are side by side: rays that are an equal distance apart would find the same light again in each round of all
 * of them. */
FN1 list_size list_fill(CTX list_size size, u1 room, u1 rays, u1 draws) {
    u1 once = size.count;
    size.copies = list_copies(once, room, rays, draws);
    size.count = once * size.copies;
    if (size.copies > 1u)
        for (u1 i = size.count; i-- > 0u;)
            entry_store(PASS i, entry_copy(entry_load(PASS i / size.copies), size.copies));
    return size;
}

#endif
