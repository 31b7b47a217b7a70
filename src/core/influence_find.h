/* core/influence_find.h: what the points of a tile find among the influence volumes.
 *
 * Points that lie close together ask as one, 16 volumes against the box around them, and share a list of lights: a
 * hundredth of the tests, and lights that stay in the cache. Of the lights whose volumes hold them they list the
 * strongest, as many as draw best there (core/influence_rule.h). With an S_r that the user gave they list all. Volumes
 * are looked for once, near all points of a tile; where that is too many, for each group.
 *
 * Group 0 is that of points that did not ask. Lists of volumes are those of core/influence_near.h: 0 is near all
 * points, 1 near a group. Includers supply the bridges. */
#ifndef CORE_INFLUENCE_FIND_H
#define CORE_INFLUENCE_FIND_H

#include "core/influence_draw.h"
#include "core/influence_near.h"
#include "core/influence_rule.h"

/* The points of a block of the tile that have not asked yet, as bits; those that ask now, with that group. */
FN u1 points_pending(CTX u1 block);
FN void points_ask(CTX u1 block, u1 bits, u1 group);
FN f3 point_place(CTX u1 block, u1 lane);
FN f3 point_normal(CTX u1 block, u1 lane);
FN v3 point_places(CTX u1 block, u1 l); /* l, l + 1, ... */
FN v3 point_normals(CTX u1 block, u1 l);

FN near_query group_load(CTX u1 group);
/* What it asks with, and what it lists: so many lights, from place `from` of the found ones on. */
FN void group_store(CTX u1 group, near_query q, u1 from, u1 count);

FN b1 near_lost(CTX u1 list);                  /* there was no room for it */
FN u32 near_ids(CTX u1 list, u1 first);        /* the volumes at places first, first + 1, ... of a list */
FN influence near_load(CTX u1 list, u1 first); /* behind its end they hold nothing */
FN real near_turn(CTX u1 list, u1 first);      /* influence_turn of each */
FN void near_turn_store(CTX u1 list, u1 first, real turn);
FN u1 near_id(CTX u1 list, u1 place);
FN f1 near_lights(CTX u1 list, u1 place); /* that share the volume */

FN b1 gives_room(CTX u1 list); /* makes room for a number a volume of the list; false: there is none */
FN void gives_store(CTX u1 first, real gives);
FN real gives_load(CTX u1 first);
FN f1 gives_at(CTX u1 place);

FN u1 found_next(CTX u1 group); /* the place where the group's next light goes */
FN b1 found_add(CTX u1 volume); /* its lights; false: no room */

/* ---- which points ask as one ---- */

/* Those that ask with the first of those pending in block `first`, in that one and those after it. */
CALL near_query points_together(CTX u1 group, u1 first, u1 blocks, near_query none, f1 close) {
    u1 lane = low_bit(points_pending(PASS first));
    v3 p = spread3(point_place(PASS first, lane));
    v3 n = spread3(point_normal(PASS first, lane));
    near_query q = none;
    for (u1 b = first; b < blocks; b++) {
        u1 part = 0u;
        if (points_pending(PASS b) != 0u)
            EACH16(l)
        part =
            part |
            shl(lane_bits(points_close(p, n, point_places(PASS b, U32(l)), point_normals(PASS b, U32(l)), close)), l);
        if (b == first)
            part = part | shl(1u, lane);
        part = part & points_pending(PASS b);
        for (u1 bits = part; bits != 0u; bits = bits & (bits - 1u))
            q = near_add_point(q, point_place(PASS b, low_bit(bits)), point_normal(PASS b, low_bit(bits)));
        if (part != 0u)
            points_ask(PASS b, part, group);
    }
    return q;
}

/* Returns how many groups there are, and sets the query that is near all of them. */
FN u1 influence_groups(CTX u1 blocks, near_query none, f1 close) {
    u1 groups = 1u;
    group_store(PASS 0u, none, 0u, 0u);
    for (u1 b = 0u; b < blocks; b++)
        while (points_pending(PASS b) != 0u) {
            group_store(PASS groups, points_together(PASS groups, b, blocks, none, close), 0u, 0u);
            groups++;
        }
    return groups;
}

/* ---- what a group finds ---- */

/* What volumes give the query's points, lux, from its `least` on; where that is 0, 1 if they hold them. 0: nothing. */
FN real near_gives(CTX u32 volume, influence v, real turn, influence_region r, f1 scale, f1 least) {
    mask held = influence_holds(v, r, K(scale));
    if (ANY(held))
        held = and_(held, influence_seen(PASS volume, r));
    real gives = sel(held, K(1.0f), K(0.0f));
    if (least > 0.0f && ANY(held))
        gives = sel(held, influence_gives(v, turn, r), K(0.0f));
    return sel(gives >= K(least), gives, K(0.0f));
}

/* The same of all volumes of a list; where lights are left out, what is given is added to the rule's bins. */
FN void near_look(CTX u1 list, near_query q, rule_range range) {
    influence_region r = near_region(q);
    for (u1 i = 0u; i < near_count(PASS list); i = i + 16u)
        EACH16(l) {
            u1 first = i + U32(l);
            real gives = near_gives(PASS near_ids(PASS list, first), near_load(PASS list, first),
                                    near_turn(PASS list, first), r, q.scale, q.least);
            u1 bits = 0u;
            gives_store(PASS first, gives);
            if (q.least > 0.0f)
                bits = lane_bits(gives > K(0.0f));
            for (; bits != 0u; bits = bits & (bits - 1u)) {
                u1 place = first + low_bit(bits);
                rule_add(PASS range, near_lights(PASS list, place), gives_at(PASS place));
            }
        }
}

/* Finds the lights of volumes that give at least `least`. False: no room. */
FN b1 near_take(CTX u1 list, f1 least) {
    b1 room = true;
    for (u1 i = 0u; i < near_count(PASS list) && room; i = i + 16u) {
        u1 bits = 0u;
        EACH16(l) bits = bits | shl(lane_bits(gives_load(PASS i + U32(l)) >= K(least)), l);
        for (; bits != 0u && room; bits = bits & (bits - 1u))
            room = found_add(PASS near_id(PASS list, i + low_bit(bits)));
    }
    return room;
}

/* False: no room. */
CALL b1 group_finds(CTX u1 list, u1 group, influence_rule rule, f1 n_l, f1 every) {
    near_query q = group_load(PASS group);
    rule_range range = rule_from(q.least);
    b1 room = gives_room(PASS list);
    if (room) {
        u1 from = found_next(PASS group);
        f1 least = 1.0f;
        if (q.least > 0.0f)
            range = rule_begin(PASS q.least);
        near_look(PASS list, q, range);
        if (q.least > 0.0f) {
            q.least = max1(rule_best(PASS range, rule, n_l, every), q.least);
            least = q.least;
        }
        room = near_take(PASS list, least);
        u1 count = found_next(PASS group) - from;
        if (count == 0u)
            from = 0u;
        group_store(PASS group, q, from, count);
    }
    return room;
}

/* ---- a tile ---- */

/* What is near a query, into a list. False: not all of it. */
CALL b1 near_search(CTX u1 list, near_query q) {
    b1 all = influence_near(PASS list, q);
    for (u1 i = 0u; i < near_count(PASS list); i = i + 16u)
        EACH16(l) near_turn_store(PASS list, i + U32(l), influence_turn(near_load(PASS list, i + U32(l))));
    return all;
}

/* What the points of a tile of so many blocks find: `none` is near_asks, usual the root of the median light, n_l the
 * lights of the scene, of draws every `every`th is from all of them. Returns the number of groups, or 0: no room. */
FN u1 influence_find(CTX u1 blocks, near_query none, f1 usual, influence_rule rule, f1 n_l, f1 every) {
    u1 groups = influence_groups(PASS blocks, none, INFLUENCE_CLOSE * none.scale * usual);
    near_query all = near_none(none.scale, 0.0f, INFLUENCE_TILE);
    for (u1 i = 1u; i < groups; i++)
        all = near_join(all, group_load(PASS i));
    b1 together = near_search(PASS 0u, all);
    b1 room = !near_lost(PASS 0u);
    u1 list = 1u;
    if (together)
        list = 0u;
    for (u1 i = 1u; i < groups && room; i++) {
        if (!together)
            near_search(PASS 1u, group_load(PASS i));
        room = !near_lost(PASS list) && group_finds(PASS list, i, rule, n_l, every);
    }
    if (!room)
        groups = 0u;
    return groups;
}

#endif
