/* core/learned.h: what is learned of the lights' visibility, in cells of world space: which cell a surface lies in, and
 * what counts of rays say. Counts are whole numbers. */
#ifndef CORE_LEARNED_H
#define CORE_LEARNED_H

#include "core/frame.h"
#include "core/random.h"

#define LEARNED_UNKNOWN 0.5f /* the visibility of a light that nothing is known of */
#define LEARNED_PIXELS 32.0f /* side of a cell, in pixels of the picture, about */
#define LEARNED_WORTH 2.0f   /* the prior counts as the rays of so many lights */

/* A cell's words: its key (check 0: it is free), when it was last used, counts of all lights; then CELL_LIGHTS places
 * of a light's number each, set by set, and as many of its counts: asked, from bit 16 on seen. A place is free where
 * none asked. */
#define CELL_PLACE 0u
#define CELL_CHECK 1u
#define CELL_USED 2u
#define CELL_ASKED 3u
#define CELL_SEEN 4u
#define CELL_LIGHT 5u
#define CELL_COUNTS 69u
#define CELL_WORDS 133u
#define CELL_LIGHTS 64u
#define CELL_WAYS 4u /* a set */
#define CELL_RUN 8u

/* How strongly rays are drawn to a light: the root of its expected square, and something for those thought to be
 * hidden. */
FN1 f1 learned_pull(f1 visibility) { return sqrt1(visibility) + 0.1f; }

/* Visibility expected of a light: of one that so many rays asked for, seen by some of them, where all of the cell's
 * lights come to `all`; of those, a half beforehand. */
FN1 f1 learned_visibility(f1 asked, f1 seen, f1 all) {
    EXACT f1 v = (seen + LEARNED_WORTH * all) / (asked + LEARNED_WORTH);
    return v;
}

/* The prior of an entry of a list: how strongly rays are drawn to it, and what of its light is expected to
 * arrive. */
struct list_prior {
    f1 share;  /* weight * pull */
    f1 expect; /* weight * visibility */
};

/* Two hashes of a cell's side, place and turn. check is never 0. */
struct cell_key {
    u1 place; /* says where the cell is looked for */
    u1 check;
};

#ifndef CORE_GLSL
typedef struct list_prior list_prior;
typedef struct cell_key cell_key;
#endif

FN1 list_prior list_prior_of(f1 weight, f1 visibility) {
    list_prior b;
    EXACT f1 share = weight * learned_pull(visibility);
    EXACT f1 expect = weight * visibility;
    b.share = share;
    b.expect = expect;
    return b;
}

/* ---- cells ---- */

/* The pixel of a block that asks for all that see a surface: one in the middle. */
FN1 u1 cell_lane(u1 lanes) {
    u1 lane = 5u;
    if ((lanes & 32u) == 0u)
        lane = low_bit(lanes);
    return lane;
}

/* The side that suits a surface at that depth, m. */
FN1 f1 cell_side(frame_camera c, f1 depth) {
    f3 right = F3(c.right[0], c.right[1], c.right[2]);
    EXACT f1 half_width = sqrt1(dot1(right, right));
    EXACT f1 side = LEARNED_PIXELS * depth * 2.0f * half_width / c.width;
    return side;
}

/* Sides are powers of two: the one nearest to that, as the exponent's bits of a float. */
FN1 u1 cell_level(f1 side) {
    EXACT f1 above = min1(max1(side, 1e-6f), 1e9f) * 1.41421356f;
    return shr(bits_of_f1(above), 23);
}

/* Which of six ways a surface faces. */
FN1 u1 cell_turn(f3 n) {
    f1 x = max1(n.x, -n.x);
    f1 y = max1(n.y, -n.y);
    f1 z = max1(n.z, -n.z);
    f1 along = n.x;
    u1 turn = 0u;
    if (z >= x && z >= y) {
        along = n.z;
        turn = 4u;
    } else if (y > x) {
        along = n.y;
        turn = 2u;
    }
    if (along < 0.0f)
        turn++;
    return turn;
}

/* Number of the cell along one axis, of 2^22 that come again and again. Borders are moved, for walls and floors like to
 * lie at round numbers. No step rounds but that behind the border. */
FN1 f1 cell_number(f1 x, f1 inverse_side) {
    EXACT f1 at = x * inverse_side;
    EXACT f1 whole = floor1(at);
    EXACT f1 part = at - whole;
    if (part >= 0.63f)
        whole = whole + 1.0f;
    EXACT f1 turns = floor1(whole * 2.384185791015625e-7f);
    EXACT f1 number = whole - 4194304.0f * turns;
    return number;
}

FN1 u1 cell_hash(u1 x, u1 y, u1 z, u1 what) { return hash_u1(x + hash_u1(y + hash_u1(z + hash_u1(what)))); }

/* Key of the cell that holds p, on a surface of normal n. */
FN1 cell_key cell_key_of(f3 p, f3 n, u1 level) {
    f1 inverse = f1_of_bits(shl(254u - level, 23));
    u1 x = bits_of_f1(cell_number(p.x, inverse));
    u1 y = bits_of_f1(cell_number(p.y, inverse));
    u1 z = bits_of_f1(cell_number(p.z, inverse));
    u1 what = shl(level, 3) | cell_turn(n);
    cell_key k;
    k.place = cell_hash(x, y, z, what);
    k.check = cell_hash(x, y, z, what | 0x8000u) | 1u;
    return k;
}

/* Key of the cell of a block of the picture, by the surface that one of its pixels sees. */
FN1 cell_key cell_key_at(frame_camera c, f3 p, f3 n, f1 depth) {
    return cell_key_of(p, n, cell_level(cell_side(c, depth)));
}

/* The first cell of a key's run; a table has so many cells, a power of two. */
FN1 u1 cell_run(cell_key k, u1 cells) { return (k.place * CELL_RUN) & (cells - 1u); }

FN1 b1 cell_same(cell_key a, cell_key b) { return a.place == b.place && a.check == b.check; }

#endif
