/* core/profile.h: luminous intensity distributions: which way a light sends how much, in the angles C and gamma of CIE
 * 121. A light's flags tell the number of its profile, 0 for none.
 *
 * Its frame lies in a and b: C 0 is a, C 90 is -b, and gamma is the angle from the axis a x b, so that C turns
 * counter-clockwise as seen from behind the luminaire. A profile is a table at even steps of both angles, bilinear
 * between them, in candela for each lumen; nothing goes beyond its last gamma.
 *
 * Tables lie in one array of cells of four floats. The first ones are the profiles' heads, then each table's cells: the
 * four corners of a step of gamma and of C, so that one look at memory is enough. Includers supply profile_load.
 *
 * Files of types A and B are looked up in their own angles: rows are then angles from another pole, columns angles
 * around it (photometry/photometry.h), and the cell before the table's first has the window that they cover, in turns:
 * near_ is the first row's angle, next the first column's, at least 0, far_ has the columns of a full turn. */
#ifndef CORE_PROFILE_H
#define CORE_PROFILE_H

#include "core/records.h"
#include "core/warp.h"

/* A head: place of the table's first cell and its steps, gamma's from bit 16 on and its pole, as bits; steps of rows a
 * turn; the last gamma, in turns. */
struct profile_cell {
    real near_; /* at the lower gamma and C */
    real next;  /* at the lower gamma, the higher C */
    real far_;
    real last;
};

#ifndef CORE_GLSL
typedef struct profile_cell profile_cell;
FN profile_cell profile_load(CTX u32 place);
#else
profile_cell profile_load(uint place);
#endif

/* Candela a lumen: towards a direction, and the largest at the corners of the step of the table that it lies in; and by
 * how much the direction is beyond the last gamma, in turns. */
struct profile_value {
    real here;
    real most;
    real beyond;
};

#ifndef CORE_GLSL
typedef struct profile_value profile_value;
#endif

/* Row and column of a table, and whether it covers the direction. */
struct profile_place {
    real row;
    real column;
    mask within;
};

#ifndef CORE_GLSL
typedef struct profile_place profile_place;
#endif

/* Of types A and B. (x, y, z): the direction in the frame, where -y is up. */
FN profile_place profile_turned(profile_cell head, profile_cell window, v3 d) {
    u32 steps = bits_of_real(head.next);
    mask down = shr(steps, PROFILE_POLE) == KU(PROFILE_DOWN);
    real rows = to_real(shr(steps, 16) & KU(PROFILE_ROWS));
    real columns = to_real(steps & KU(0xffffu));
    real along = sel(down, d.y, K(0.0f) - d.x);
    real side = sel(down, K(0.0f) - d.x, d.y);
    EXACT real across2 = d.z * d.z + side * side;
    real c = turn_of(d.z, abs_(side));
    c = sel(side > K(0.0f), K(1.0f) - c, c) - window.next;
    c = sel(c < K(0.0f), c + K(1.0f), c);
    EXACT real row = (turn_of(along, sqrt_(across2)) - window.near_) * head.far_;
    EXACT real column = c * window.far_;
    profile_place at;
    at.within = and_(and_(row >= K(0.0f), row <= rows), column <= columns);
    at.row = min_(max_(row, K(0.0f)), rows);
    at.column = min_(column, columns);
    return at;
}

/* Of profile `number`, in the frame a, b, towards d, which need not be unit. */
FN profile_value profile_look(CTX u32 number, v3 a, v3 b, v3 d) {
    EXACT real scale = K(1.0f) / sqrt_(max_(dot3(a, a), K(1e-30f)));
    EXACT real x = dot3(a, d) * scale;
    EXACT real y = dot3(b, d) * scale;
    EXACT real z = dot3(cross3(a, b), d) * (scale * scale);
    EXACT real across2 = x * x + y * y;
    real gamma = turn_of(z, sqrt_(across2));
    real c = turn_of(x, abs_(y));
    c = sel(y > K(0.0f), K(1.0f) - c, c); /* -b is C 90 */
    profile_cell head = profile_load(PASS number - KU(1u));
    u32 steps = bits_of_real(head.next);
    u32 columns = steps & KU(0xffffu);
    u32 first = bits_of_real(head.near_);
    real rows = to_real(shr(steps, 16) & KU(PROFILE_ROWS));
    EXACT real at_row = min_(gamma * head.far_, rows);
    EXACT real at_column = c * to_real(columns);
    mask within = gamma <= head.last;
    mask turned = shr(steps, PROFILE_POLE) != KU(0u);
    if (SELDOM(ANY(turned))) {
        profile_cell window = profile_load(PASS selu(turned, first, number) - KU(1u));
        profile_place own = profile_turned(head, window, V3(x, y, z));
        at_row = sel(turned, own.row, at_row);
        at_column = sel(turned, own.column, at_column);
        within = and_(within, or_(own.within, not_(turned)));
    }
    real row = to_real(to_u32(min_(at_row, rows - K(1.0f))));
    u32 column = to_u32(at_column);
    column = selu(column < columns, column, columns - KU(1u));
    real s = at_row - row;
    real t = at_column - to_real(column);
    profile_cell v = profile_load(PASS first + to_u32(row) * columns + column);
    EXACT real low = v.near_ + (v.next - v.near_) * t;
    EXACT real high = v.far_ + (v.last - v.far_) * t;
    EXACT real value = low + (high - low) * s;
    profile_value at;
    at.here = sel(within, max_(value, K(0.0f)), K(0.0f));
    at.most = max_(max_(v.near_, v.next), max_(v.far_, v.last));
    EXACT real beyond = gamma - head.last;
    at.beyond = beyond;
    return at;
}

FN real profile_towards(CTX u32 number, v3 a, v3 b, v3 d) { return profile_look(PASS number, a, b, d).here; }

/* About that of directions no farther than PROFILE_AROUND turns from one, but at least so much where any of them may
 * get some. */
#define PROFILE_AROUND 0.0102f
FN real profile_about(CTX u32 number, v3 a, v3 b, v3 d, real least) {
    profile_value at = profile_look(PASS number, a, b, d);
    return sel(at.beyond <= K(PROFILE_AROUND), max_(max_(at.here, K(0.25f) * at.most), least), K(0.0f));
}

#endif
