/* city/windows: windows on the walls of buildings.
 *
 * The walls of one building are merged into facades, whatever pieces they come in (facet.c, strip.c). A grid of cells,
 * centred on a facade, storey upon storey from its foot, gives a window wherever one fits wholly into the wall
 * (cells.c), and no other wall stands close before it (cover.c). What is behind it (a flat, an office, a shop), how
 * bright and at which share of lit windows it shines are drawn from a hash of the building's id and the window's place
 * in the building (shine.c): so windows stay what they are, whatever is loaded beside them and in which order. */
#ifndef NOC_CITY_WINDOWS_H
#define NOC_CITY_WINDOWS_H

#include "base/base.h"
#include "scene/scene.h"

/* Pieces of a wall are one facade where all of a piece lies this near the plane of the largest, turned by no more than
 * this from it, and where they touch or leave a gap no wider than this. */
#define WINDOW_MERGE_MM 50.0
#define WINDOW_MERGE_DEG 2.0
#define WINDOW_GAP_MM 30.0
/* Before a curved wall a window is flat, and stands so far before it. */
#define WINDOW_OFFSET_MM 30.0
/* Pieces side by side, each narrower than so many cells, are a curved wall where they turn by no more than this. */
#define WINDOW_CURVE_CELLS 1.5
#define WINDOW_CURVE_DEG 25.0
/* A wall that stands so near before a window hides it; one with its back to it, also a little behind it. */
#define WINDOW_PARTY_M 1.0
#define WINDOW_PARTY_BEHIND_M 0.3

typedef struct wall_triangle {
    double p[3][3]; /* local metres, counter-clockwise seen from outside */
} wall_triangle;

/* It stands WINDOW_OFFSET_MM before the wall; in a flat one it belongs `back` m behind that: in the wall's plane, or so
 * far before it as pieces of the wall stick out. */
typedef struct city_window {
    double corner[3], edge_u[3], edge_v[3]; /* faces edge_u x edge_v */
    double back;
    uint32_t facade;    /* of the building, from 0 */
    int storey, column; /* from 0, of its facade */
    noc_window_kind kind;
    uint64_t hash;     /* of the building's id and the window's place in it */
    float level;       /* lit where the share of lit windows of its kind is above it, 0..1 */
    float emission[3]; /* cd/m2, where it is lit */
} city_window;

typedef NOC_ARRAY(city_window) city_window_list;

/* A facade: what became of it, and the area of its pieces, m2. */
typedef struct city_facade {
    noc_wall_verdict verdict;
    double area;
    size_t windows;
    /* Of a flat wall: the grid that its windows are in, from its corner a column and a row on; else no columns. A
     * window may reach over several of them. */
    double origin[3], along[3], up[3];
    uint32_t columns, rows;
} city_facade;

#define CITY_NO_FACADE UINT32_MAX
typedef struct city_windows {
    city_window_list list;
    NOC_ARRAY(city_facade) facades;
    NOC_ARRAY(uint8_t) verdicts; /* noc_wall_verdict of each triangle, in the order they were given */
    NOC_ARRAY(uint32_t) of;      /* the facade of each triangle, or CITY_NO_FACADE */
    size_t crowded;              /* facades that have no windows, or not all: more looks would have been needed */
} city_windows;

/* Walls of all buildings, to ask what stands before a window. NULL is allowed where there are no others. */
typedef struct city_cover city_cover;
/* Copies nothing but corners, as floats. Triangles that are no walls (flatter than 45 degrees) are left out. ground:
 * the scene whose ground hides what lies under it; NULL: none does. NULL: memory was refused. */
city_cover *city_cover_create(const float *xyz, size_t triangles, const noc_scene *ground) NOC_MUST_USE;
void city_cover_destroy(city_cover *cover);
/* Does a wall stand close before any of the window's corners or its middle, or the ground before its foot? Adds to
 * *looks the walls that were looked at. */
bool city_cover_hides(const city_cover *cover, const city_window *w, size_t *looks);
/* Does a ray from o along the unit vector d meet one of them between these distances, m? */
bool city_cover_meets(const city_cover *cover, const double o[3], const double d[3], double from, double to);

/* The windows of a building. What is in `out` is replaced; zeroed it is empty. The result does not depend on the order
 * of the triangles. looks: at walls that may hide windows, after which the others are left out; SIZE_MAX: all are
 * looked at; 0: there are no windows. NOC_ERR_MEMORY, not reported: memory was refused. */
noc_status city_windows_make(const char *id, noc_building_use told, const wall_triangle *walls, size_t count,
                             const noc_window_params *params, const city_cover *cover, size_t looks, city_windows *out);
void city_windows_free(city_windows *w);

/* Windows that a model has itself (own.c). A pane is a light of its window: a rectangle, or a
 * triangle of a piece of glass that is none. */
typedef struct city_own_pane {
    uint32_t first, count; /* of city_own_windows.triangles, which show it */
    bool whole;            /* a rectangle */
    bool leads;            /* the first of its window */
    bool part;             /* of the same glass as the one before it */
    city_window window;    /* its edges are those of the rectangle or triangle */
} city_own_pane;

typedef struct city_own_windows {
    NOC_ARRAY(city_own_pane) panes;
    NOC_ARRAY(uint32_t) triangles; /* indices among those given */
} city_own_windows;

/* Panes among the surfaces of a building's windows that are seen from outside; frames, reveals and backs are none.
 * What is in `out` is replaced; zeroed it is empty. NOC_ERR_MEMORY, not reported: memory was refused. */
noc_status city_own_windows_find(const char *id, noc_building_use told, const wall_triangle *panes, size_t count,
                                 const wall_triangle *walls, size_t wall_count, const noc_window_params *params,
                                 city_own_windows *out);
void city_own_windows_free(city_own_windows *w);

/* ---- shine.c ---- */

typedef struct building_use {
    bool shops;   /* at street level */
    bool offices; /* above */
    bool dark;    /* no window is ever lit */
    bool bare;    /* there are none */
    uint64_t hash;
} building_use;
/* told: what its file says; height, m, and width of its widest facade, m */
building_use city_building_use(const char *id, noc_building_use told, double height, double width);
uint64_t city_window_hash(uint64_t a, uint64_t b);
/* In which step a length along a building lies, for hashes. */
uint64_t city_window_step(double length);
/* A number of 0..1 that hash and salt decide. */
double city_window_number(uint64_t hash, uint64_t salt);
/* cd/m2 of a lit room behind panes of that kind, of a screen alone, and the share that a drawn curtain lets through, by
 * a number of 0 to under 1. */
double city_window_luminance(noc_window_kind kind, double u);
double city_window_screen(double u);
double city_window_curtain(double u);
/* Level and emission of a window by its kind and hash. floor: a number that the windows of its storey share; pair: one
 * that its neighbour may share. */
void city_window_shine(city_window *w, const building_use *use, uint64_t floor, uint64_t pair,
                       const noc_window_params *params);

#endif
