/* Where lamps can stand: vertical queries around a spot, in rings. */
#include "city/lamp.h"

#include <math.h>

#define BIT(cls) (1u << NOC_CLASS_##cls)
#define BUILDING (BIT(ROOF) | BIT(WALL) | BIT(WINDOW) | BIT(DOOR) | BIT(INSTALLATION))

enum { DIRECTIONS = 16, FINE_DIRECTIONS = 256 };

static void direction(int i, double d[2]) {
    d[0] = sin(2 * M_PI * i / DIRECTIONS);
    d[1] = cos(2 * M_PI * i / DIRECTIONS);
}

/* Ground at one of the directions at distance r; false where there is none. */
static bool ground_on_ring(const noc_scene *scene, double x, double y, double r, double *z) {
    for (int i = 0; i < DIRECTIONS; i++) {
        double d[2];
        direction(i, d);
        if (noc_scene_ground(scene, x + r * d[0], y + r * d[1], z))
            return true;
    }
    return false;
}

bool site_ground(const noc_scene *scene, double x, double y, double *z) {
    bool found = noc_scene_ground(scene, x, y, z);
    for (double r = .5; r <= 4 && !found; r += .5)
        found = ground_on_ring(scene, x, y, r, z);
    return found;
}

bool site_ground_far(const noc_scene *scene, double x, double y, double *z) {
    bool found = false;
    for (double r = 4; r < 600 && !found; r *= 1.2)
        found = ground_on_ring(scene, x, y, r, z);
    return found;
}

bool site_raised(const noc_scene *scene, double x, double y, double z) {
    for (double r = 2; r <= 12; r += 2)
        for (int i = 0; i < DIRECTIONS; i++) {
            double d[2], top;
            direction(i, d);
            if (noc_scene_highest(scene, ~BIT(LAMP), x + r * d[0], y + r * d[1], &top) && top <= z - 2)
                return true;
        }
    return false;
}

bool site_covered(const noc_scene *scene, double x, double y, double z) {
    double top;
    return noc_scene_highest(scene, BUILDING, x, y, &top) && top > z + .5;
}

bool site_under(const noc_scene *scene, double x, double y, double z, double head) {
    enum { MOST = 64 };
    const uint32_t bottom = BIT(OTHER) | BIT(INSTALLATION), solid = BUILDING | BIT(GROUND) | bottom;
    double above = HUGE_VAL, low = HUGE_VAL, at;
    int met = 0;
    for (; met < MOST && noc_scene_highest_below(scene, solid, x, y, low, &at) && at > z + .5; met++) {
        above = low;
        low = at;
    }
    return met && met % 2 == 0 && low > head && noc_scene_highest_below(scene, bottom, x, y, above, &at) && at == low;
}

bool site_free_spot(const noc_scene *scene, double *x, double *y, double z, double reach, double away[2]) {
    for (double r = .25; r <= reach; r += .25)
        for (int i = 0; i < DIRECTIONS; i++) {
            double d[2];
            direction(i, d);
            if (site_covered(scene, *x + r * d[0], *y + r * d[1], z))
                continue;
            /* a hand's breadth from the wall, where there is room */
            double step = site_covered(scene, *x + (r + .3) * d[0], *y + (r + .3) * d[1], z) ? r : r + .3;
            *x += step * d[0];
            *y += step * d[1];
            memcpy(away, d, sizeof(d));
            return true;
        }
    return false;
}

static void directions(int count, double d[][2]) {
    for (int i = 0; i < count; i++) {
        d[i][0] = sin(2 * M_PI * i / count);
        d[i][1] = cos(2 * M_PI * i / count);
    }
}

/* Sum of the directions on a ring in which something of the classes lies higher than min_z. */
static double lies_there(const noc_scene *scene, uint32_t classes, double x, double y, double min_z, double r,
                         int count, double directions[][2], double sum[2]) {
    sum[0] = sum[1] = 0;
    for (int i = 0; i < count; i++) {
        const double *d = directions[i];
        double top;
        if (noc_scene_highest(scene, classes, x + r * d[0], y + r * d[1], &top) && top > min_z) {
            sum[0] += d[0];
            sum[1] += d[1];
        }
    }
    return hypot(sum[0], sum[1]);
}

/* Mean direction of what lies on the nearest ring where any does, to a degree: lamps shine that way. */
static bool nearest(const noc_scene *scene, uint32_t classes, double x, double y, double min_z, double reach,
                    double mean[2]) {
    double sum[2], few[DIRECTIONS][2], many[FINE_DIRECTIONS][2];
    if (!noc_scene_has_classes(scene, classes)) /* lamps of a map without a city: no rays */
        return false;
    directions(DIRECTIONS, few);
    for (double r = 1; r <= reach; r += 1) {
        if (!(lies_there(scene, classes, x, y, min_z, r, DIRECTIONS, few, sum) > .1))
            continue; /* it lies all around, or nowhere */
        directions(FINE_DIRECTIONS, many);
        double fine[2], l = lies_there(scene, classes, x, y, min_z, r + .5, FINE_DIRECTIONS, many, fine);
        bool found = l > 1; /* a thin edge may lie between the two rings */
        if (!found)
            l = hypot(sum[0], sum[1]);
        for (int k = 0; k < 2; k++)
            mean[k] = (found ? fine[k] : sum[k]) / l;
        return true;
    }
    return false;
}

bool site_facing(const noc_scene *scene, double x, double y, double z, double facing[2]) {
    double top;
    bool on_road = noc_scene_highest(scene, BIT(ROAD), x, y, &top);
    if (!on_road && nearest(scene, BIT(ROAD), x, y, z - 3, 8, facing))
        return true;
    if (!nearest(scene, BUILDING, x, y, z + 1, 12, facing))
        return false;
    facing[0] = -facing[0];
    facing[1] = -facing[1];
    return true;
}

bool site_taken(const noc_scene *scene, double x, double y, double z) {
    double top;
    return noc_scene_highest(scene, BIT(LAMP), x, y, &top) && top > z + .2;
}
