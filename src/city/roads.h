/* roads: centre lines of roads by place (roads.c), and lamps along them (road_lamps.c). Local metres. */
#ifndef NOC_CITY_ROADS_H
#define NOC_CITY_ROADS_H

#include "city/city.h"

typedef struct road_piece {
    double a[2], b[2];
    uint32_t road;
} road_piece;

#define ROADS_REACH 32.0 /* m around a point in which its pieces are found */

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

#endif
