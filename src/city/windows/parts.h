/* city/windows/parts: what the walls of a building become on the way to windows. */
#ifndef NOC_CITY_WINDOWS_PARTS_H
#define NOC_CITY_WINDOWS_PARTS_H

#include "city/windows/windows.h"

#include <math.h>

static inline double dot3(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
static inline void sub3(const double a[3], const double b[3], double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = a[k] - b[k];
}
static inline void cross3(const double a[3], const double b[3], double out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* A plane with axes: u is level, v goes up, u x v = n. */
typedef struct wall_plane {
    double c[3], n[3], u[3], v[3];
} wall_plane;

/* Through c across the vector n, of any length. A level plane's u is the x axis. */
wall_plane wall_plane_make(const double c[3], const double n[3]);
/* Where p lies in it; the height over it is the result. */
double wall_plane_at(const wall_plane *plane, const double p[3], double uv[2]);

/* A triangle of a wall, in an order that does not depend on the one given. */
typedef struct wall_piece {
    wall_triangle t;
    double area, n[3]; /* unit */
    double thin;       /* m: its least height */
    double lo[3], hi[3];
    uint32_t given; /* index among those given */
    uint32_t facet;
} wall_piece;

/* Pieces of one plane that hang together. */
typedef struct facet {
    wall_plane plane;
    double area, lo[2], hi[2]; /* extent in u and v */
    uint32_t first, count;     /* of wall_pieces.by_facet */
} facet;

typedef struct wall_facets {
    NOC_ARRAY(wall_piece) pieces;
    NOC_ARRAY(facet) facets;
    NOC_ARRAY(uint32_t) by_facet; /* indices of pieces, facet after facet */
    size_t looked_at;             /* pieces and groups of them, until the facets were found */
    size_t most_looks;            /* 0: any number */
    bool cut;                     /* more would have been needed: facets are not all there is of them */
} wall_facets;

/* Around the walls of a building; width: of its widest facet. */
typedef struct building_box {
    double lo[3], hi[3], width;
} building_box;
building_box building_box_of(const wall_facets *f);

/* facet.c. Triangles without area are in none: their facet is NO_FACET. */
#define NO_FACET UINT32_MAX
bool wall_facets_find(const wall_triangle *walls, size_t count, wall_facets *out) NOC_MUST_USE; /* false: no memory */
void wall_facets_free(wall_facets *f);

/* near.c. Of pieces, which stay the caller's and where they are: at first all, none of which has a facet. NULL: no
 * memory. */
typedef struct near_pieces near_pieces;
typedef NOC_ARRAY(uint32_t) near_found;
near_pieces *near_pieces_make(const wall_piece *pieces, size_t count) NOC_MUST_USE;
void near_pieces_free(near_pieces *t);
/* Takes one out, once: it has a facet. */
void near_pieces_take(near_pieces *t, uint32_t piece);
/* Those left that may lie in the plane and touch `from`, and some more, in any order. Adds to *looks how many pieces
 * and groups of them were looked at. False: no memory. */
bool near_pieces_find(const near_pieces *t, const wall_piece *from, const wall_plane *plane, near_found *found,
                      size_t *looks) NOC_MUST_USE;

/* Facets side by side, unrolled: s runs along them, t up. */
typedef struct strip_part {
    uint32_t facet;
    double s; /* where the facet begins */
} strip_part;

typedef struct strip {
    const strip_part *parts;
    size_t count;
    double length, lo, hi; /* s is 0..length, t lo..hi */
} strip;

typedef struct wall_strips {
    NOC_ARRAY(strip_part) parts;
    NOC_ARRAY(uint32_t) first; /* of the parts, strip after strip, and the end */
} wall_strips;

/* strip.c. cell: width of a window's cell, m. Strips come in the order of their first facet. */
bool wall_strips_find(const wall_facets *f, double cell, wall_strips *out) NOC_MUST_USE;
void wall_strips_free(wall_strips *s);
strip wall_strip_get(const wall_facets *f, const wall_strips *s, size_t index);
/* The place of (s, t) on the wall, and the way the wall faces there. */
void wall_strip_place(const wall_facets *f, const strip *s, double along, double t, double p[3], const wall_plane **at);

/* cells.c. Adds the windows of a strip: corners, back, storey, column, kind; and the grid of a flat facade. foot:
 * height of the building's lowest wall. *tests: of triangles under cells, so far; from most_tests on no further windows
 * are found. */
bool wall_cells_find(const wall_facets *f, const strip *s, const noc_window_params *params, const building_use *use,
                     double foot, size_t *tests, size_t most_tests, city_facade *facade,
                     city_window_list *out) NOC_MUST_USE;

#endif
