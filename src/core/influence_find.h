/* core/influence_find.h: what the points of a tile find among the influence volumes.
 *
 * Points that lie close together ask as one, 16 volumes against the box around them, and share a list of lights: a
 * hundredth of the tests, and lights that stay in the cache. Packs that do not reach them are passed by. Of the lights
 * whose volumes hold them they list the strongest, as many as draw best there (core/influence_rule.h). With an S_r that
 * the user gave they list all. Volumes are looked for once, near all points of a tile; where that is too many, for each
 * group.
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

FN b1 near_lost(CTX u1 list);             /* there was no room for it */
FN u32 near_ids(CTX u1 list, u1 first);   /* the volumes at places first, first + 1, ... of a list */
FN real near_turn(CTX u1 list, u1 first); /* influence_turn of each */
FN f1 near_lights(CTX u1 list, u1 place); /* that share the volume */

/* What a group looks at: packs of the list, and what each of their volumes gives. */
FN b1 gives_room(CTX u1 list); /* makes room for all of the list; false: there is none */
FN void looked_store(CTX u1 i, u1 pack);
FN u1 looked_load(CTX u1 i);
FN void gives_store(CTX u1 first, real gives);
FN real gives_load(CTX u1 first);
FN f1 gives_at(CTX u1 place);

FN u1 found_next(CTX u1 group); /* the place where the group's next light goes */
/* The lights of those volumes of the list at places first, first + 1, ... that the bits name; false: no room. */
FN b1 found_add(CTX u1 list, u1 first, u1 bits);

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

/* The same of a pack, which is the i-th that is looked at; where lights are left out, what is given is added to the
 * rule's bins. */
FN void near_look_at(CTX u1 list, u1 pack, u1 i, influence_region r, f1 scale, rule_range range, b1 strongest) {
    looked_store(PASS i, pack);
    EACH16(l) {
        u1 from = pack * 16u + U32(l);
        u1 to = i * 16u + U32(l);
        f1 least = 0.0f;
        if (strongest)
            least = range.least;
        real gives = near_gives(PASS near_ids(PASS list, from), near_load(PASS list, from), near_turn(PASS list, from),
                                r, scale, least);
        u1 bits = 0u;
        gives_store(PASS to, gives);
        if (strongest)
            bits = lane_bits(gives > K(0.0f));
        for (; bits != 0u; bits = bits & (bits - 1u))
            rule_add(PASS range, near_lights(PASS list, from + low_bit(bits)), gives_at(PASS to + low_bit(bits)));
    }
}

/* Returns how many packs were looked at. */
FN u1 near_look(CTX u1 list, near_query q, rule_range range) {
    influence_region r = near_region(q);
    u1 packs = shr(near_count(PASS list) + 15u, 4);
    u1 looked = 0u;
    for (u1 first = 0u; first < packs; first = first + 16u)
        for (u1 bits = packs_near(PASS list, first, r, near_scale(q)); bits != 0u; bits = bits & (bits - 1u)) {
            near_look_at(PASS list, first + low_bit(bits), looked, r, q.scale, range, q.least > 0.0f);
            looked++;
        }
    return looked;
}

/* Finds the lights of volumes that give at least `least`. False: no room. */
FN b1 near_take(CTX u1 list, u1 looked, f1 least) {
    b1 room = true;
    for (u1 i = 0u; i < looked && room; i++)
        EACH16(l) {
            u1 bits = lane_bits(gives_load(PASS i * 16u + U32(l)) >= K(least));
            if (bits != 0u && room)
                room = found_add(PASS list, looked_load(PASS i) * 16u + U32(l), bits);
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
        u1 looked = near_look(PASS list, q, range);
        if (q.least > 0.0f) {
            q.least = max1(rule_best(PASS range, rule, n_l, every), q.least);
            least = q.least;
        }
        room = near_take(PASS list, looked, least);
        u1 count = found_next(PASS group) - from;
        if (count == 0u)
            from = 0u;
        group_store(PASS group, q, from, count);
    }
    return room;
}

/* ---- a tile ---- */

/* What the points of a tile of so many blocks find: `none` is near_asks, usual the root of the median light, n_l the
 * lights of the scene, of draws every `every`th is from all of them. Returns the number of groups, or 0: no room. */
FN u1 influence_find(CTX u1 blocks, near_query none, f1 usual, influence_rule rule, f1 n_l, f1 every) {
    u1 groups = influence_groups(PASS blocks, none, INFLUENCE_CLOSE * none.scale * usual);
    near_query all = near_none(none.scale, 0.0f, INFLUENCE_TILE);
    for (u1 i = 1u; i < groups; i++)
        all = near_join(all, group_load(PASS i));
    b1 together = influence_near(PASS 0u, all);
    b1 room = !near_lost(PASS 0u);
    u1 list = 1u;
    if (together)
        list = 0u;
    for (u1 i = 1u; i < groups && room; i++) {
        if (!together)
            influence_near(PASS 1u, group_load(PASS i));
        room = !near_lost(PASS list) && group_finds(PASS list, i, rule, n_l, every);
    }
    if (!room)
        groups = 0u;
    return groups;
}

#endif
