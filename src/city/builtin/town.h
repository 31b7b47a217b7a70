/* town: the built-in city's own parts. Nothing outside procedural*.c uses this, but its random numbers and sines.
 *
 * The city is planned on a flat sheet: straight streets between convex blocks. Every point of the plan then goes
 * through a gentle warp, so that streets bend and no two blocks are alike. Walls stand on warped corners, so they stay
 * plane. Only +, -, *, / and sqrt decide anything (no libm functions whose last bit differs from one machine to the
 * next). */
#ifndef NOC_TOWN_H
#define NOC_TOWN_H

#include "scene/scene.h"

typedef struct vec2 {
    double x, y;
} vec2;

/* ---- random numbers: streams keyed by what they are for ---- */

typedef struct town_rng {
    uint32_t state;
} town_rng;

uint32_t town_hash(uint32_t a, uint32_t b);
double town_next(town_rng *rng); /* 0 <= x < 1 */
double town_range(town_rng *rng, double lo, double hi);
int town_below(town_rng *rng, int n);
bool town_chance(town_rng *rng, double p);
/* sin(2 pi turns) and cos(2 pi turns) to 1e-3, the same everywhere. */
double town_sin(double turns);
double town_cos(double turns);

/* ---- the plan ---- */

typedef enum town_way { WAY_NONE, WAY_SIDE, WAY_AVENUE, WAY_QUAY } town_way; /* what an edge of a block faces */

#define TOWN_POLY_MAX 20
typedef struct town_poly { /* convex, counter-clockwise */
    int n;
    vec2 p[TOWN_POLY_MAX];
    town_way way[TOWN_POLY_MAX]; /* of the edge from p[i] to p[i + 1] */
} town_poly;

double town_poly_area(const town_poly *poly);
vec2 town_poly_centre(const town_poly *poly);
/* Keeps the side left of the line from a along direction d; a new edge gets the given way. */
void town_poly_clip(town_poly *poly, vec2 a, vec2 d, town_way way);
/* Moves every edge inwards by distance[its way]. */
town_poly town_poly_inset(const town_poly *poly, const double distance[4]);

typedef struct town_gap {
    double lo, hi;
    town_way kind;
    bool river;
} town_gap;                      /* between two rows of blocks */
enum { TOWN_BLOCKS_MOST = 120 }; /* between two rims */
typedef struct town_axis {
    struct {
        size_t len;
        town_gap data[TOWN_BLOCKS_MOST + 1];
    } gaps; /* first and last are the rims of the city, of no width */
} town_axis;

#define TOWN_WATER -4.2 /* m, below the streets */
#define TOWN_KERB 0.12
#define TOWN_PROMENADE 4.5 /* width of the walk between quay street and river */
#define TOWN_QUAY_STREET 8.0

/* ---- surfaces ---- */

typedef enum town_mat {
    TM_WALL,
    TM_WALL_LAST = TM_WALL + 9,
    TM_TILES,
    TM_TILES_DARK,
    TM_SLATE,
    TM_COPPER,
    TM_FLAT_ROOF,
    TM_STONE,
    TM_CONCRETE,
    TM_METAL,
    TM_GLASS,
    TM_FRAME,
    TM_DOOR,
    TM_SHOP,
    TM_SHOP_DARK,
    TM_SHOP_FLOOR,
    TM_AWNING,
    TM_AWNING_LAST = TM_AWNING + 2,
    TM_ROAD,
    TM_MARKING,
    TM_SIDEWALK,
    TM_KERBSTONE,
    TM_PAVING,
    TM_GRAVEL,
    TM_LAWN,
    TM_WATER,
    TM_QUAY,
    TM_BRIDGE,
    TM_TRUNK,
    TM_LEAF,
    TM_LEAF_LAST = TM_LEAF + 3,
    TM_POLE,
    TM_WOOD,
    TM_CAR,
    TM_CAR_LAST = TM_CAR + 5,
    TM_CAR_GLASS,
    TM_TYRE,
    TM_COUNT
} town_mat;

typedef struct town_batch {
    NOC_ARRAY(double) xyz;
    NOC_ARRAY(uint32_t) indices;
} town_batch;

/* A pane of a window: two triangles of a batch. */
typedef struct town_pane {
    town_mat mat;
    uint32_t triangle; /* the first one in the batch */
    noc_light shape;
    noc_scene_window window;
} town_pane;

typedef struct town {
    noc_scene *scene;
    noc_city_params params;
    int material[TM_COUNT];
    bool switched;              /* windows are lights, which are switched; else they are dark glass */
    double often;               /* how much more often than elsewhere rooms are lit */
    int lamps, windows, cars;   /* groups of lights */
    town_batch batch[TM_COUNT]; /* waiting for town_flush, and */
    NOC_ARRAY(town_pane) panes; /* what of them shows windows */
    double half;                /* half the edge of the plan */
    town_axis axis[2];          /* streets across x, across y */
    float white[8][3];          /* colours of lamps and windows, luminance 1; indices below */
    bool failed;                /* the scene refused something (and reported it) */
} town;

enum { LIGHT_SODIUM, LIGHT_CANDLE, LIGHT_WARM, LIGHT_WHITE, LIGHT_NEUTRAL, LIGHT_COOL, LIGHT_SCREEN };

/* What built-in scenes make of the city. */
typedef struct town_style {
    bool windows;           /* are switched; false: they are dark glass */
    double often;           /* of town */
    void (*dress)(town *t); /* adds to the city when all else is there; may be NULL */
} town_style;
noc_status town_build(noc_scene *scene, const noc_city_params *params, const town_style *style);

/* Streets and blocks, of an empty town. params are within their rows. */
void town_plan(town *t, const noc_city_params *params);
vec2 town_warp(const town *t, vec2 plan); /* plan to world */

/* Corners counter-clockwise seen from outside. */
void town_tri(town *t, town_mat mat, const double a[3], const double b[3], const double c[3]);
void town_quad(town *t, town_mat mat, const double a[3], const double b[3], const double c[3], const double d[3]);
/* Upright box on corners a b c d (world, counter-clockwise) from z0 to z1, without a bottom. */
void town_box(town *t, town_mat mat, const vec2 c[4], double z0, double z1);
/* Corners of a rectangle around a centre: half lengths along dir and across it. */
void town_rect(vec2 centre, vec2 dir, double along, double across, vec2 out[4]);
/* Flat polygon of world corners, counter-clockwise seen from above. */
void town_flat(town *t, town_mat mat, const vec2 *p, int n, double z);
/* Upright prism without a bottom: n sides, radius r0 below and r1 above. */
void town_pole(town *t, town_mat mat, vec2 centre, int sides, double r0, double r1, double z0, double z1);
void town_flush(town *t, const char *fmt, ...) NOC_PRINTF(2, 3); /* makes meshes of all batches, under one name */
void town_light(town *t, const noc_light *light, int colour, double luminance);

/* ---- walls (wall.c) ---- */

/* A wall from a to b, facing right of that direction. mitre0/1: how far an edge sticks out at each end for every metre
 * that it stands before the wall, so that cornices meet around corners. */
typedef struct town_wall {
    vec2 a, b, dir, out;
    double length, mitre0, mitre1;
} town_wall;

town_wall town_wall_make(vec2 a, vec2 b);
void town_wall_point(const town_wall *w, double s, double z, double before, double out[3]);
void town_wall_rect(town *t, town_mat mat, const town_wall *w, double s0, double s1, double z0, double z1,
                    double before);
/* A band along the whole wall that stands before it: cornices, plinths, slabs. */
void town_wall_band(town *t, town_mat mat, const town_wall *w, double z0, double z1, double before);
/* What is behind a pane, and how it shines when it is lit. */
typedef struct town_room {
    noc_window_kind kind;
    double level; /* noc_scene_window; below 1 */
    double often; /* noc_scene_window */
    int colour;
    double luminance;
} town_room;
/* Shops and churches are lit wherever a third of the rooms are. */
#define TOWN_SHOPS_OFTEN 3.0
/* A pane of that surface: the parallelogram at p, facing u x v. */
void town_pane_add(town *t, town_mat mat, const double p[3], const double u[3], const double v[3],
                   const town_room *room);
/* The same on a wall. */
void town_wall_pane(town *t, town_mat mat, const town_wall *w, double s0, double s1, double z0, double z1,
                    double before, const town_room *room);

typedef struct town_facade {
    town_mat wall;
    int storeys;                     /* above the ground floor */
    double base;                     /* z of the pavement at the wall */
    double ground, storey;           /* heights */
    double bay, width, height, sill; /* windows */
    bool deep;                       /* windows in recesses with frames; else panes on the wall */
    bool shops, door, balconies, office;
    uint32_t seed;
} town_facade;

double town_facade_height(const town_facade *f);
void town_facade_build(town *t, const town_wall *w, const town_facade *f);

/* ---- buildings, blocks, places ---- */

/* A row of buildings around a block; poly is the building line in plan, depth that of the houses. */
void town_perimeter(town *t, const town_poly *line, double depth, int block);
bool town_perimeter_fits(const town_poly *line, double depth);
/* One house on the whole polygon, with a tent roof or a flat one. */
void town_solid(town *t, const town_poly *line, int block);
void town_tower(town *t, const town_poly *line, int block, bool square);

void town_park(town *t, const town_poly *block, int id);
void town_square(town *t, const town_poly *block, int id);
void town_plaza(town *t, const town_poly *block, int id);
void town_courtyard(town *t, const town_poly *yard, int id);
void town_river(town *t);
void town_church(town *t, vec2 centre, vec2 dir);

/* ---- street furniture; positions in world coordinates, z of the ground they stand on ---- */

/* sprays: triangles of its crown */
void town_tree(town *t, vec2 p, double z, double height, int sprays, uint32_t seed);
void town_arm_lamp(town *t, vec2 p, double z, vec2 to_road);
void town_globe_lamp(town *t, vec2 p, double z, int colour);
void town_bench(town *t, vec2 p, vec2 dir, double z);
void town_car(town *t, vec2 p, vec2 dir, double z, bool lights, uint32_t seed);
/* What stands along the kerb of a block: lamps, trees, parked cars. */
void town_kerbside(town *t, const town_poly *block, int id);
void town_roads(town *t);                                                  /* carriageways and their markings */
void town_diagonal(const town *t, vec2 *a, vec2 *dir, double *half_width); /* the slanting avenue, in plan */

#endif
