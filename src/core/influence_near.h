/* core/influence_near.h: searching the hierarchies of influence volumes (light/influence.h) for all volumes that could
 * hold a point of a region, and some more, always in the same order: those of lights that stand, then of lights that
 * move. Nodes have 16 children, and leaves 16 volumes.
 *
 * A backend has a list for what is near a tile, and one for what is near a group of its points, each with as much room
 * as it likes. A search that finds more than `most` volumes or no room ends, and tells: then the points of a tile look
 * for themselves, group by group, and points that find no room so list nothing and draw from all lights.
 *
 * 16 volumes of a list after the other are a pack, with a box around it, so that a group of points passes by packs that
 * are too far away for it. */
#ifndef CORE_INFLUENCE_NEAR_H
#define CORE_INFLUENCE_NEAR_H

#include "core/influence_points.h"

#define NEAR_HALVES 2u
#define NEAR_STACK 128 /* of 8 levels: 15 nodes wait on each, and one more is looked at */

/* A hierarchy of so many levels over volumes [first, end). */
struct near_half {
    u1 levels;
    u1 first;
    u1 end;
};

/* LANES children of a node. Those that are not there have root = 0. */
struct near_children {
    v3 lo;
    v3 hi;
    real root; /* the largest under it */
};

#ifndef CORE_GLSL
typedef struct near_half near_half;
typedef struct near_children near_children;
#endif

FN near_half near_half_load(CTX u1 k);
/* Places l, l + 1, ... of the 16 below a node of that level, counted from 0 at the volumes. */
FN near_children near_children_load(CTX u1 k, u1 level, u1 node, u1 l);
/* Volumes from `first` on; those from `end` on hold nothing. */
FN influence near_volumes_load(CTX u1 first, u1 end);
FN void near_ask_ahead(CTX u1 first); /* that 16 volumes from there on will be loaded */
FN void near_clear(CTX u1 list);
/* Of volumes first, first + 1, ..., which are v, with their influence_turn, those of the bits. False: no room. */
FN b1 near_add(CTX u1 list, u1 first, u1 bits, influence v, real turn);
FN u1 near_count(CTX u1 list);
FN influence near_load(CTX u1 list, u1 first); /* those at places first, first + 1, ...; behind its end: nothing */
FN void near_pack_store(CTX u1 list, u1 pack, f3 lo, f3 hi, f1 root);
FN near_children near_packs_load(CTX u1 list, u1 first); /* packs first, first + 1, ...; behind its end: root = 0 */

/* Is lo..hi within reach of the region, and not wholly behind its surfaces? Their normals are the same to 1e-5, and the
 * coordinates have their own precision, hence the 2 cm. */
FN mask box_near(v3 lo, v3 hi, influence_region r, real reach) {
    v3 a = sub3(lo, r.hi);
    v3 b = sub3(r.lo, hi);
    v3 d = V3(max_(max_(a.x, b.x), K(0.0f)), max_(max_(a.y, b.y), K(0.0f)), max_(max_(a.z, b.z), K(0.0f)));
    EXACT real front =
        max_(r.n.x * lo.x, r.n.x * hi.x) + max_(r.n.y * lo.y, r.n.y * hi.y) + max_(r.n.z * lo.z, r.n.z * hi.z);
    EXACT real back = r.back - K(0.02f) - K(1e-4f) * reach;
    return and_(and_(reach > K(0.0f), dot3(d, d) <= reach * reach), front >= back);
}

/* Could the volume hold a point? Those that face away from the whole box cannot. */
FN mask volume_near(influence a, influence_region r, real scale) {
    v3 size = fill3(a.size);
    return and_(box_near(sub3(a.c, size), add3(a.c, size), r, a.root * scale), influence_shines(a, r));
}

/* Bits of the children of a node that could hold a point. */
FN u1 children_near(CTX u1 k, u1 level, u1 node, influence_region r, real scale) {
    u1 bits = 0u;
    EACH16(l) {
        near_children c = near_children_load(PASS k, level, node, l);
        bits = bits | shl(lane_bits(box_near(c.lo, c.hi, r, c.root * scale)), l);
    }
    return bits;
}

/* Adds the volumes of a leaf that could hold a point. False: no room. */
FN b1 leaf_near(CTX u1 list, near_half h, u1 leaf, influence_region r, real scale) {
    b1 room = true;
    EACH16(l) {
        u1 first = h.first + leaf * 16u + U32(l);
        influence v = near_volumes_load(PASS first, h.end);
        u1 bits = lane_bits(volume_near(v, r, scale));
        if (bits != 0u && room)
            room = near_add(PASS list, first, bits, v, influence_turn(v));
    }
    return room;
}

/* What the packs of a list lie in. */
FN void near_bound_packs(CTX u1 list) {
    f1 none = -f1_of_bits(NEAR_INFINITY);
    for (u1 i = 0u; i < near_count(PASS list); i = i + 16u) {
        f3 lo = F3(none, none, none); /* signs turned */
        f3 hi = lo;
        f1 root = 0.0f;
        EACH16(l) {
            influence v = near_load(PASS list, i + U32(l));
            mask there = v.root > K(0.0f);
            lo = F3(max1(lo.x, lane_max(sel(there, v.size - v.c.x, K(none)))),
                    max1(lo.y, lane_max(sel(there, v.size - v.c.y, K(none)))),
                    max1(lo.z, lane_max(sel(there, v.size - v.c.z, K(none)))));
            hi = F3(max1(hi.x, lane_max(sel(there, v.c.x + v.size, K(none)))),
                    max1(hi.y, lane_max(sel(there, v.c.y + v.size, K(none)))),
                    max1(hi.z, lane_max(sel(there, v.c.z + v.size, K(none)))));
            root = max1(root, lane_max(v.root));
        }
        near_pack_store(PASS list, shr(i, 4), F3(-EACH16_MAX(lo.x), -EACH16_MAX(lo.y), -EACH16_MAX(lo.z)),
                        F3(EACH16_MAX(hi.x), EACH16_MAX(hi.y), EACH16_MAX(hi.z)), EACH16_MAX(root));
    }
}

/* Bits of the 16 packs from `first` on that could hold a point. */
FN u1 packs_near(CTX u1 list, u1 first, influence_region r, real scale) {
    u1 bits = 0u;
    EACH16(l) {
        near_children c = near_packs_load(PASS list, first + U32(l));
        bits = bits | shl(lane_bits(box_near(c.lo, c.hi, r, c.root * scale)), l);
    }
    return bits;
}

/* Rounding must not lose what the exact test would take. */
FN real near_scale(near_query q) { return K(q.scale * 1.00001f); }

/* Fills the list. False: it has not all that there is. */
CALL b1 influence_near(CTX u1 list, near_query q) {
    influence_region r = near_region(q);
    real scale = near_scale(q);
    u1 stack[NEAR_STACK]; /* level from bit 28 on, node */
    b1 fits = true;
    near_clear(PASS list);
    for (u1 k = 0u; k < NEAR_HALVES; k++) {
        near_half h = near_half_load(PASS k);
        u1 depth = 0u;
        if (h.levels > 0u && q.lo.x <= q.hi.x) {
            stack[0] = shl(h.levels - 1u, 28);
            depth = 1u;
        }
        while (depth > 0u && fits) {
            depth--;
            u1 level = shr(stack[depth], 28);
            u1 node = stack[depth] & 0x0fffffffu;
            u1 near = children_near(PASS k, level, node, r, scale);
            if (level == 0u)
                for (u1 bits = near; bits != 0u; bits = bits & (bits - 1u))
                    near_ask_ahead(PASS h.first + (node * 16u + low_bit(bits)) * 16u);
            for (u1 bits = near; bits != 0u && fits; bits = bits & (bits - 1u)) {
                u1 child = node * 16u + low_bit(bits);
                if (level > 0u) {
                    stack[depth] = shl(level - 1u, 28) | child;
                    depth++;
                } else {
                    fits = leaf_near(PASS list, h, child, r, scale) && near_count(PASS list) <= q.most;
                }
            }
        }
    }
    near_bound_packs(PASS list);
    return fits;
}

#endif
