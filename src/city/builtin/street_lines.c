/* The centre lines of the built-in city's streets. */
#include "city/builtin/town.h"
#include "city/city.h"

#include <math.h>

#define PARKED 4.6 /* m of a street that parked cars take, on both sides */
#define STEP 12.0

/* From one place of the plan straight to another. */
static bool line(const town *t, vec2 from, vec2 to, double width, bool avenue, const char *id, noc_arena *arena,
                 geo_road *street) {
    double length = hypot(to.x - from.x, to.y - from.y);
    size_t steps = (size_t)NOC_MAX(ceil(length / STEP), 1);
    double *xyz = arena_alloc(arena, 3 * (steps + 1) * sizeof(*xyz));
    for (size_t i = 0; i <= steps && xyz; i++) {
        double f = (double)i / (double)steps;
        vec2 p = town_warp(t, (vec2){ from.x + f * (to.x - from.x), from.y + f * (to.y - from.y) });
        xyz[3 * i] = p.x;
        xyz[3 * i + 1] = p.y;
        xyz[3 * i + 2] = NAN;
    }
    *street = (geo_road){ .id = id,
                          .name = "",
                          .cls = avenue ? GEO_ROAD_PRIMARY : GEO_ROAD_MINOR,
                          .motor = true,
                          .width = width - PARKED,
                          .speed = NAN,
                          .point_count = steps + 1,
                          .xyz = xyz };
    return id && xyz;
}

/* The parts of the plan on both sides of the river, or all of it. */
static int banks(const town *t, double from[2], double to[2]) {
    from[0] = -t->half;
    to[0] = t->half;
    for (size_t i = 0; i < t->axis[1].gaps.len; i++)
        if (t->axis[1].gaps.data[i].river) {
            to[0] = t->axis[1].gaps.data[i].lo;
            from[1] = t->axis[1].gaps.data[i].hi;
            to[1] = t->half;
            return 2;
        }
    return 1;
}

bool city_builtin_street(const noc_city_params *params, size_t number, noc_arena *arena, geo_road *street) {
    town *t = noc_calloc(1, sizeof(*t));
    arena->refused = arena->refused || !t;
    if (!t)
        return false;
    town_plan(t, params);
    double from[2], to[2];
    int parts = banks(t, from, to);
    bool found = false;
    const char *id = arena_format(arena, "street %zu", number + 1);
    for (int axis = 0; axis < 2 && !found; axis++)
        for (size_t i = 1; i + 1 < t->axis[axis].gaps.len && !found; i++) {
            const town_gap *g = &t->axis[axis].gaps.data[i];
            size_t lines = axis == 0 ? (size_t)parts : g->river ? 2 : 1;
            if (number >= lines) {
                number -= lines;
                continue;
            }
            double middle = (g->lo + g->hi) / 2, width = g->hi - g->lo;
            if (g->river) { /* a street along each quay */
                middle = number ? g->hi - TOWN_QUAY_STREET / 2 : g->lo + TOWN_QUAY_STREET / 2;
                width = TOWN_QUAY_STREET;
            }
            vec2 a = axis == 0 ? (vec2){ middle, from[number] } : (vec2){ -t->half, middle };
            vec2 b = axis == 0 ? (vec2){ middle, to[number] } : (vec2){ t->half, middle };
            found = line(t, a, b, width, g->kind == WAY_AVENUE, id, arena, street);
            break;
        }
    free(t);
    return found;
}

bool city_builtin_ring(const noc_city_params *params, int side, noc_arena *arena, geo_road *street) {
    town *t = noc_calloc(1, sizeof(*t));
    arena->refused = arena->refused || !t;
    if (!t || side < 0 || side > 3) {
        free(t);
        return false;
    }
    town_plan(t, params);
    int axis = side % 2; /* west and east, south and north */
    const town_gap *g = &t->axis[axis].gaps.data[side < 2 ? 0 : t->axis[axis].gaps.len - 1];
    double middle = (g->lo + g->hi) / 2;
    vec2 a = axis == 0 ? (vec2){ middle, -t->half } : (vec2){ -t->half, middle };
    vec2 b = axis == 0 ? (vec2){ middle, t->half } : (vec2){ t->half, middle };
    bool found = line(t, a, b, g->hi - g->lo + PARKED, false, arena_format(arena, "ring %d", side + 1), arena, street);
    free(t);
    return found;
}
