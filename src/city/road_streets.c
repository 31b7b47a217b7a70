/* Streets of a map, and which of them a lamp is of: what a map of a dozen lamps says of the street that they stand in,
 * it does not say of all others. */
#include "city/roads.h"

#include <math.h>

static uint32_t root_of(uint32_t *parent, uint32_t i) {
    while (parent[i] != i)
        i = parent[i] = parent[parent[i]];
    return i;
}

/* Ways of one name that end in one place are one street. false: memory was refused. */
static bool join(const city_roads *roads, uint32_t *parent) {
    noc_map ends = { 0 };
    bool ok = true;
    for (size_t i = 0; i < roads->count && ok; i++) {
        const geo_road *road = &roads->roads[i];
        for (int end = 0; end < 2 && *road->name && ok; end++) {
            const double *p = road->xyz + (end ? 3 * (road->point_count - 1) : 0);
            uint64_t other;
            char *key = noc_format("%.0f %.0f %s", p[0], p[1], road->name);
            ok = key != NULL;
            if (ok && map_get(&ends, key, &other))
                parent[root_of(parent, (uint32_t)i)] = root_of(parent, (uint32_t)other);
            else if (ok)
                ok = map_put(&ends, key, i, NULL);
            free(key);
        }
    }
    map_free(&ends);
    for (uint32_t i = 0; i < roads->count && ok; i++)
        parent[i] = root_of(parent, i);
    return ok;
}

bool road_streets_create(const city_roads *roads, road_streets *s) {
    *s = (road_streets){ .of = noc_alloc((roads->count + 1) * sizeof(*s->of)),
                         .counted = noc_calloc(roads->count + 1, sizeof(*s->counted)) };
    for (uint32_t i = 0; i < roads->count && s->of; i++)
        s->of[i] = i;
    return s->of && s->counted && join(roads, s->of);
}

uint32_t road_streets_beside(const city_roads *roads, const road_streets *s, const bool *lit, const double xy[2]) {
    uint32_t found = ROAD_NO_STREET;
    double best = INFINITY;
    for (road_walk w = road_walk_start(roads, xy); road_walk_next(&w);) {
        double d = road_distance(w.piece, xy, NULL), off = road_off(&roads->roads[w.piece->road], d);
        if (!lit[w.piece->road] || d > ROADS_BESIDE || off >= best)
            continue;
        best = off;
        found = s->of[w.piece->road];
    }
    return found;
}

void road_streets_free(road_streets *s) {
    free(s->of);
    free(s->counted);
}

size_t road_streets_count(const city_roads *roads, road_streets *s, const city_road_lamp *lamps, size_t count) {
    size_t streets = 0;
    for (size_t i = 0; i < count; i++) {
        bool *seen = &s->counted[s->of[lamps[i].road - roads->roads]];
        streets += !*seen;
        *seen = true;
    }
    return streets;
}
