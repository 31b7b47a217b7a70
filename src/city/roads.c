#include "city/roads.h"

#include <math.h>

#define LONGEST 20e3  /* m between two points of a road, more than any has */
#define MOST 4096     /* pieces of a cell that are looked at */
#define PATH_AWAY 3.0 /* m by which a path counts as farther than a road */

static bool add_pieces(city_roads *r, uint32_t road, const double *from, const double *to) {
    double length = hypot(to[0] - from[0], to[1] - from[1]);
    bool here = fabs(from[0]) < ROADS_FARTHEST && fabs(from[1]) < ROADS_FARTHEST;
    if (!here || !(length > 0) || length > LONGEST)
        return true;
    int parts = (int)ceil(length / ROADS_REACH);
    for (int i = 0; i < parts; i++) {
        road_piece piece = { .road = road };
        for (int k = 0; k < 2; k++) {
            piece.a[k] = from[k] + (to[k] - from[k]) * i / parts;
            piece.b[k] = from[k] + (to[k] - from[k]) * (i + 1) / parts;
        }
        if (!array_push(&r->pieces, piece))
            return false;
    }
    return true;
}

city_roads *city_roads_create(const geo_road *roads, size_t count) {
    city_roads *r = noc_calloc(1, sizeof(*r));
    if (!r)
        return NULL;
    r->roads = roads;
    r->count = count;
    bool kept = true;
    for (size_t i = 0; i < count && kept; i++)
        for (size_t k = 0; k + 1 < roads[i].point_count && kept; k++)
            kept = add_pieces(r, (uint32_t)i, roads[i].xyz + 3 * k, roads[i].xyz + 3 * k + 3);
    /* a middle lies half a piece from what is nearest of it */
    kept = kept && geo_cells_create(&r->cells, r->pieces.len + 1, 1.5 * ROADS_REACH);
    for (size_t i = 0; i < r->pieces.len && kept; i++) {
        const road_piece *p = &r->pieces.data[i];
        geo_cells_add(&r->cells, (double[]){ (p->a[0] + p->b[0]) / 2, (p->a[1] + p->b[1]) / 2 }, i);
    }
    if (kept)
        return r;
    city_roads_destroy(r);
    return NULL;
}

void city_roads_destroy(city_roads *r) {
    if (!r)
        return;
    array_free(&r->pieces);
    geo_cells_free(&r->cells);
    free(r);
}

double road_distance(const road_piece *piece, const double xy[2], double nearest[2]) {
    double d[2] = { piece->b[0] - piece->a[0], piece->b[1] - piece->a[1] }, l2 = d[0] * d[0] + d[1] * d[1];
    double t = NOC_CLAMP(((xy[0] - piece->a[0]) * d[0] + (xy[1] - piece->a[1]) * d[1]) / l2, 0, 1);
    double at[2] = { piece->a[0] + t * d[0], piece->a[1] + t * d[1] };
    if (nearest)
        memcpy(nearest, at, sizeof(at));
    return hypot(xy[0] - at[0], xy[1] - at[1]);
}

road_walk road_walk_start(const city_roads *roads, const double xy[2]) {
    return (road_walk){ .roads = roads, .xy = xy, .cell = -1 };
}

bool road_walk_next(road_walk *w) {
    while (!w->next || w->seen >= MOST) {
        if (++w->cell == 9)
            return false;
        w->next = *geo_cells_at(&w->roads->cells, w->xy, w->cell);
        w->seen = 0;
    }
    w->piece = &w->roads->pieces.data[w->next - 1];
    w->next = w->roads->cells.next[w->next - 1];
    w->seen++;
    return true;
}

double road_off(const geo_road *road, double distance) {
    return distance - geo_road_width(road) / 2 + (road->cls == GEO_ROAD_PATH ? PATH_AWAY : 0);
}

const geo_road *city_roads_street(const city_roads *roads, const double xy[2]) {
    const geo_road *found = NULL;
    double best = INFINITY;
    for (road_walk w = road_walk_start(roads, xy); road_walk_next(&w);) {
        const geo_road *road = &roads->roads[w.piece->road];
        double d = road_distance(w.piece, xy, NULL), off = d - geo_road_width(road) / 2;
        bool nearer = off < best || (off == best && found && strcmp(road->id, found->id) < 0);
        if (!*road->name || road->cls == GEO_ROAD_RAIL || road->tunnel || d > ROADS_BESIDE || !nearer)
            continue;
        best = off;
        found = road;
    }
    return found;
}

enum { ANY_ROAD = 3, NO_BRIDGES = 1, BRIDGES = 2 };

/* facing NULL: that is not asked, and the place may be the middle of the road. */
static const geo_road *beside(const city_roads *roads, const double xy[2], unsigned which, double facing[2]) {
    const geo_road *found = NULL;
    double best = INFINITY, to[2] = { 0 };
    for (road_walk w = road_walk_start(roads, xy); road_walk_next(&w);) {
        const geo_road *road = &roads->roads[w.piece->road];
        double nearest[2], d = road_distance(w.piece, xy, nearest);
        double off = road_off(road, d);
        bool nearer = off < best || (off == best && found && strcmp(road->id, found->id) < 0);
        if (road->cls == GEO_ROAD_RAIL || road->tunnel || d > ROADS_BESIDE || (facing && d < .1) || !nearer ||
            !(which & (road->bridge ? BRIDGES : NO_BRIDGES)))
            continue;
        best = off;
        found = road;
        for (int k = 0; k < 2 && facing; k++)
            to[k] = (nearest[k] - xy[k]) / d;
    }
    if (found && facing)
        memcpy(facing, to, sizeof(to));
    return found;
}

const geo_road *city_roads_beside(const city_roads *roads, const double xy[2], double facing[2]) {
    return beside(roads, xy, ANY_ROAD, facing);
}

const geo_road *city_roads_by_bridge(const city_roads *roads, const double xy[2], bool bridge, double *off,
                                     double facing[2]) {
    const geo_road *road = beside(roads, xy, bridge ? BRIDGES : NO_BRIDGES, facing);
    *off = INFINITY;
    if (road)
        geo_road_deck(road, xy, off);
    *off -= road ? geo_road_width(road) / 2 : 0;
    return road;
}
