/* core/facade.h: windows in a wall. Those of a facade have no triangles: a ray that meets the wall finds the cell of
 * the facade's grid, and there the light that the window is. Who traces the ray does so:
 *
 *     cell = facade_cell(facade, p);                          NO_CELL: the hit is on no cell
 *     light = cells[cell];                                    NO_LIGHT: there is no window
 *     if (window_covers(light.p, light.a, light.b, p)) the hit is on the window, which is of facade.material
 *
 * A window that reaches over several cells is in each of them. */
#ifndef CORE_FACADE_H
#define CORE_FACADE_H

#include "core/dialect.h"
#include "core/records.h"

#define NO_CELL 0xffffffffu

struct facade_grid {
    v3 origin;
    v3 along;
    v3 up;
    u32 first;
    u32 columns;
    u32 rows;
};

#ifndef CORE_GLSL
typedef struct facade_grid facade_grid;
#endif

/* From memory, the same facade in every lane. */
FN facade_grid facade_of_record(facade_record r) {
    facade_grid f;
    f.origin = splat3(r.origin);
    f.along = splat3(r.along);
    f.up = splat3(r.up);
    f.first = KU(r.first);
    f.columns = KU(r.columns);
    f.rows = KU(r.rows);
    return f;
}

/* The cell that a place on the wall is in, or NO_CELL. */
FN u32 facade_cell(facade_grid f, v3 p) {
    v3 d = sub3(p, f.origin);
    real x = dot3(d, f.along);
    real y = dot3(d, f.up);
    mask right = and_(x >= K(0.0f), x < to_real(f.columns));
    mask inside = and_(right, and_(y >= K(0.0f), y < to_real(f.rows)));
    u32 cell = f.first + to_u32(sel(inside, y, K(0.0f))) * f.columns + to_u32(sel(inside, x, K(0.0f)));
    return selu(inside, cell, KU(NO_CELL));
}

/* Is a place on the wall behind the rectangle from `corner` along a and b, which lies in the wall or some millimetres
 * before it? */
FN mask window_covers(v3 corner, v3 a, v3 b, v3 p) {
    v3 d = sub3(p, corner);
    real s = dot3(d, a);
    real t = dot3(d, b);
    mask across = and_(s >= K(0.0f), s < dot3(a, a));
    return and_(across, and_(t >= K(0.0f), t < dot3(b, b)));
}

#endif
