/* roads: centre lines of roads by place (roads.c), and lamps along them (road_lamps.c). Local metres. */
#ifndef NOC_CITY_ROADS_H
#define NOC_CITY_ROADS_H

#include "city/city.h"

typedef struct road_piece {
    double a[2], b[2];
    uint32_t road;
} road_piece;

#define ROADS_REACH 32.0 /* m around a point in which its pieces are found */

#define ROADS_BESIDE 25.0 /* m from the middle of a road to a lamp that lights it */

#define ROADS_FARTHEST 9e6 /* m; a scene ends at 1e7 */

struct city_roads {
    const geo_road *roads;
    size_t count;
    NOC_ARRAY(road_piece) pieces; /* of ROADS_REACH at most */
    geo_cells cells;              /* of their middles */
};

/* Distance of a point to a piece; nearest[2], which may be NULL: the place on it. */
double road_distance(const road_piece *piece, const double xy[2], double nearest[2]);

/* Pieces near a point: for (road_walk w = road_walk_start(roads, xy); road_walk_next(&w);) ... w.piece. Where so many
 * lie that no street map has them, some are left out. */
typedef struct road_walk {
    const city_roads *roads;
    const double *xy;
    const road_piece *piece;
    uint32_t next;
    int cell;
    size_t seen;
} road_walk;
road_walk road_walk_start(const city_roads *roads, const double xy[2]);
bool road_walk_next(road_walk *w);

/* How far a place at that distance from a road's middle is off its edge: a path counts as 3 m farther away. */
double road_off(const geo_road *road, double distance);

/* ---- streets (road_streets.c) ---- */

/* By the roads' numbers. A street is all ways of one name that meet, or one way without a name. */
typedef struct road_streets {
    uint32_t *of;  /* which street: the number of one of its roads */
    bool *counted; /* road_streets_count has met it */
} road_streets;
#define ROAD_NO_STREET UINT32_MAX

/* false: memory was refused, and *s is to be freed all the same. */
bool road_streets_create(const city_roads *roads, road_streets *s) NOC_MUST_USE;
void road_streets_free(road_streets *s);
/* The street whose lit road (lit: of each road) is the nearest to a lamp there, as city_roads_beside has it. */
uint32_t road_streets_beside(const city_roads *roads, const road_streets *s, const bool *lit, const double xy[2]);
/* Along how many streets lamps stand; asked once. */
size_t road_streets_count(const city_roads *roads, road_streets *s, const city_road_lamp *lamps, size_t count);

#endif
