/* core/list_faces.h: pixels of a block that see alike weigh the far lights of their tile's list together, as one face.
 * What chooses a ray need not be exact (core/list_sketch.h): sixteen lights are weighed at a time, instead of one for
 * sixteen pixels. Lights that are near for a face each of its pixels weighs alone (core/list_rays.h).
 *
 * Entries lie in rows of 16 places, so that the order of the columns, each from its first row to its last, is that of
 * the entries: a list has list_rows(count) of them, and place c of row r holds entry c * rows + r. Sums go down the
 * columns first, and then along them. */
#ifndef CORE_LIST_FACES_H
#define CORE_LIST_FACES_H

#include "core/learned.h"
#include "core/list_sketch.h"

/* Pixels see alike where their normals and depths differ by less than that, and how a glossy surface mirrors by less
 * than that share of its lobe. */
#define FACE_TURN 0.1f
#define FACE_DEPTH 0.05f
#define FACE_LOBE 0.5f
#define FACE_ALBEDO 0.02f /* at least */

/* What pixels of the block see. */
struct face_pixels {
    surf s;
    real depth;
};

/* What one of them sees. */
struct face_pixel {
    f3 p;
    f3 n;
    f3 wo;
    f3 albedo;
    f1 f0;
    f1 alpha;
    f1 depth;
};

#ifndef CORE_GLSL
typedef struct face_pixels face_pixels;
typedef struct face_pixel face_pixel;
#endif

/* Pixels that see alike, about what one of them sees. */
struct list_face {
    u1 pixels;
    face_pixel one;
    f1 around; /* m: they are so near to it */
    f1 spread; /* sine of the angle to their farthest normal, at least */
};

/* Priors of several entries. */
struct list_priors {
    real share;
    real expect;
};

/* What a face's far entries add up to: list_sums, of all of them. */
struct face_sums {
    f1 all;
    f1 bright;
};

#ifndef CORE_GLSL
typedef struct list_face list_face;
typedef struct list_priors list_priors;
typedef struct face_sums face_sums;
#endif

FN face_pixels face_pixels_load(CTX int l); /* l to l + LANES - 1 */
FN face_pixel face_pixel_load(CTX u1 place);
FN mask face_lanes(CTX u1 pixels, int l);     /* are pixels l to l + LANES - 1 among them? */
FN list_sketch sketch_row(CTX u1 row, int l); /* of the entries in places l to l + LANES - 1 */
FN list_priors prior_row(CTX u1 row, int l);  /* 0 where there is no entry */
FN void far_store(CTX u1 face, u1 row, int l,
                  real sum); /* what the rows before have added up to; LIST_ROWS + 1: bright */
FN f1 far_sum(CTX u1 face, u1 row, u1 column);
FN void column_store(CTX u1 face, u1 column, f1 sum); /* what the columns before have added up to; 16: all */
FN void near_bits_store(CTX u1 face, u1 row, int l, mask near);
FN u1 near_bits_load(CTX u1 face, u1 row); /* bits of places */
FN void face_store(CTX u1 number, list_face f, face_sums sums);
FN u1 pixels_of_face(CTX u1 number);
FN void near_entry_store(CTX u1 i, u1 entry, u1 place, u1 pixels); /* place: of the list's rows, 16 a row */

/* ---- faces ---- */

/* One of those that are left, and all that see as it does. */
FN1 list_face face_of(CTX u1 rest) {
    list_face f;
    u1 first = low_bit(rest);
    if ((rest & 0x0660u) != 0u) /* the middle of the block */
        first = low_bit(rest & 0x0660u);
    face_pixel a = face_pixel_load(PASS first);
    f1 lobe = FACE_TURN * FACE_TURN;
    if (a.f0 > 0.0f)
        lobe = min1(lobe, FACE_LOBE * FACE_LOBE * a.alpha * a.alpha);
    EXACT f1 depth = FACE_DEPTH * a.depth;
    u1 bits = 0u;
    f1 far = 0.0f;
    f1 turned = 0.0f;
    EACH16(l) {
        face_pixels q = face_pixels_load(PASS l);
        v3 d = sub3(q.s.p, spread3(a.p));
        v3 dn = sub3(q.s.n, spread3(a.n));
        v3 dw = sub3(q.s.wo, spread3(a.wo));
        real turn = dot3(dn, dn);
        EXACT real mirrored = K(4.0f) * turn + dot3(dw, dw);
        mask same = and_(face_lanes(PASS rest, l), abs_(q.depth - K(a.depth)) <= K(depth));
        same = and_(same, and_(mirrored <= K(lobe), and_(q.s.f0 == K(a.f0), q.s.alpha == K(a.alpha))));
        bits = bits | lane_bits(same) << l;
        far = max1(lane_max(sel(same, dot3(d, d), K(0.0f))), far);
        turned = max1(lane_max(sel(same, turn, K(0.0f))), turned);
    }
    EXACT f1 around = sqrt1(EACH16_MAX(far)) * 1.0001f;
    EXACT f1 spread = sqrt1(EACH16_MAX(turned)) * 1.0001f;
    f.pixels = EACH16_SUM(bits) | 1u << first;
    f.one = a;
    f.around = around;
    f.spread = spread;
    return f;
}

/* ---- what they weigh ---- */

/* Weighs the entries that are far from a face, and tells those that are not. A pixel's albedo, where its texture makes
 * it dark, must not hide lights from others. */
FN1 face_sums weigh_face(CTX u1 number, list_face f, u1 rows) {
    surf s;
    s.p = spread3(f.one.p);
    s.n = spread3(f.one.n);
    s.wo = spread3(f.one.wo);
    s.albedo = V3(K(max1(f.one.albedo.x, FACE_ALBEDO)), K(max1(f.one.albedo.y, FACE_ALBEDO)),
                  K(max1(f.one.albedo.z, FACE_ALBEDO)));
    s.f0 = K(f.one.f0);
    s.alpha = K(f.one.alpha);
    sketch_surf q = sketch_surf_of(s);
    face_sums sums;
    EACH16(l) {
        real all = K(0.0f);
        real bright = K(0.0f);
        for (u1 row = 0u; row < rows; row++) {
            list_sketch k = sketch_row(PASS row, l);
            list_priors b = prior_row(PASS row, l);
            real d2 = sketch_distance2(k, s.p);
            mask some = b.share > K(0.0f);
            mask near = sketch_near(s, q, k, d2, K(f.around));
            real p = sel(and_(some, not_(near)), sketch_target(PASS s, q, k, d2, K(f.around), K(f.spread)), K(0.0f));
            near_bits_store(PASS number, row, l, and_(some, near));
            far_store(PASS number, row, l, all);
            EXACT real more = all + p * b.share;
            EXACT real brighter = bright + p * b.expect;
            all = more;
            bright = brighter;
        }
        far_store(PASS number, rows, l, all);
        far_store(PASS number, U32(LIST_ROWS) + 1u, l, bright);
    }
    f1 all = 0.0f;
    f1 bright = 0.0f;
    for (u1 c = 0u; c < 16u; c++) {
        column_store(PASS number, c, all);
        EXACT f1 more = all + far_sum(PASS number, rows, c);
        EXACT f1 brighter = bright + far_sum(PASS number, U32(LIST_ROWS) + 1u, c);
        all = more;
        bright = brighter;
    }
    column_store(PASS number, 16u, all);
    sums.all = all;
    sums.bright = bright;
    return sums;
}

/* Collects the entries that pixels have to weigh alone, each with the pixels it is near for. Returns how many. */
FN1 u1 near_entries(CTX u1 faces, u1 rows) {
    u1 count = 0u;
    for (u1 row = 0u; row < rows; row++) {
        u1 places = 0u;
        for (u1 f = 0u; f < faces; f++)
            places = places | near_bits_load(PASS f, row);
        for (; places != 0u; places = places & (places - 1u)) {
            u1 place = low_bit(places);
            u1 pixels = 0u;
            for (u1 f = 0u; f < faces; f++)
                if ((near_bits_load(PASS f, row) >> place & 1u) != 0u)
                    pixels = pixels | pixels_of_face(PASS f);
            near_entry_store(PASS count, place * rows + row, 16u * row + place, pixels);
            count++;
        }
    }
    return count;
}

/* All faces of these pixels of a block, over a list of so many rows. Returns how many entries are near. */
FN1 u1 weigh_faces(CTX u1 pixels, u1 rows) {
    u1 faces = 0u;
    u1 rest = pixels;
    while (rest != 0u) {
        list_face f = face_of(PASS rest);
        face_store(PASS faces, f, weigh_face(PASS faces, f, rows));
        rest = rest & ~f.pixels;
        faces++;
    }
    return near_entries(PASS faces, rows);
}

#endif
