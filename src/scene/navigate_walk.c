/* The walker: a body with feet, which slides along walls, steps on kerbs and stairs, and falls. It knows its
 * surroundings by rays alone: a fan of 16 directions at 5 heights for walls, 5 rays down for what it stands on. */
#include "scene/navigate.h"

#include <math.h>

enum { DIRECTIONS = 16, HEIGHTS = 5, FAN = DIRECTIONS * HEIGHTS, FEET = 5 };
#define SHORT_STEP 0.12 /* m: what is longer is made in several */
#define PUSH 0.02       /* m: that a wall pushes back in a step */
#define MARGIN 0.05     /* m */
#define DROP 0.5        /* m: what is lower is fallen to */
#define GRAVITY 9.81
#define FASTEST_FALL 6.0 /* m/s */
#define HEAD 1.8         /* m */

/* Over the feet. The lowest is over what is stepped on. */
static const double heights[HEIGHTS] = { NAV_KERB + .01, .75, 1.1, 1.45, HEAD - .02 };

bool nav_is_wall(const noc_hit *h) { return h->hit && (h->normal[2] < NAV_LEVEL || h->cls == NOC_CLASS_VEHICLE); }

static bool is_other_s(const noc_hit *h, bool through_trees) {
    return h->cls == NOC_CLASS_VEHICLE || (through_trees && h->cls == NOC_CLASS_TREE);
}

bool nav_drop(noc_navigator *n, const double from[3], bool through_trees, noc_hit *hit) {
    static const double down[3] = { 0, 0, -1 };
    double at[3] = { from[0], from[1], from[2] };
    for (int i = 0; i < 16; i++) {
        *hit = nav_cast_one(n, at, down, NAV_FAR_BELOW);
        if (!hit->hit || !is_other_s(hit, through_trees))
            return hit->hit;
        at[2] = hit->place[2] - .01;
    }
    return false;
}

static noc_ray fan_ray(const double foot[3], int i, double far) {
    double angle = i % DIRECTIONS * 2 * M_PI / DIRECTIONS;
    return (noc_ray){ { foot[0], foot[1], foot[2] + heights[i / DIRECTIONS] }, { cos(angle), sin(angle), 0 }, far };
}

static noc_hit ceiling(noc_navigator *n, const double foot[3]) {
    const double from[3] = { foot[0], foot[1], foot[2] + NAV_KERB };
    return nav_cast_one(n, from, (const double[3]){ 0, 0, 1 }, HEAD - NAV_KERB);
}

bool nav_has_room(noc_navigator *n, const double foot[3]) {
    noc_ray rays[FAN];
    noc_hit hits[FAN];
    for (int i = 0; i < FAN; i++)
        rays[i] = fan_ray(foot, i, NAV_BODY);
    nav_cast(n, rays, FAN, hits);
    for (int i = 0; i < FAN; i++)
        if (nav_is_wall(&hits[i]))
            return false;
    return !ceiling(n, foot).hit;
}

/* Something that the body keeps its radius from: so far away in that direction. */
typedef struct contact {
    double u[2], t;
    bool car;
} contact;

/* A wall that a ray of the fan met is nearest along its normal, if it goes on to there; an edge where the ray met it.
 */
static int find_contacts(noc_navigator *n, const double foot[3], double far, contact out[FAN]) {
    noc_ray rays[FAN], square[FAN];
    noc_hit hits[FAN], nearest[FAN];
    int met[FAN], count = 0;
    for (int i = 0; i < FAN; i++)
        rays[i] = fan_ray(foot, i, far);
    nav_cast(n, rays, FAN, hits);
    for (int i = 0; i < FAN; i++) {
        double level = hypot(hits[i].normal[0], hits[i].normal[1]);
        if (!nav_is_wall(&hits[i]) || (hits[i].cls == NOC_CLASS_VEHICLE && !hits[i].front))
            continue;
        square[count] = rays[i];
        for (int k = 0; k < 2 && level > .1; k++)
            square[count].direction[k] = -hits[i].normal[k] / level;
        met[count++] = i;
    }
    if (count)
        nav_cast(n, square, (size_t)count, nearest);
    for (int c = 0; c < count; c++) {
        const noc_hit *fan = &hits[met[c]];
        bool goes_on = nav_is_wall(&nearest[c]) && nearest[c].distance <= fan->distance;
        const noc_ray *ray = goes_on ? &square[c] : &rays[met[c]];
        out[c] = (contact){ { ray->direction[0], ray->direction[1] },
                            goes_on ? nearest[c].distance : fan->distance,
                            fan->cls == NOC_CLASS_VEHICLE };
    }
    return count;
}

/* Is the way d free of walls, with a margin? */
static bool is_free(noc_navigator *n, const double foot[3], const double d[2]) {
    double length = hypot(d[0], d[1]);
    noc_ray rays[HEIGHTS];
    noc_hit hits[HEIGHTS];
    for (int i = 0; i < HEIGHTS; i++)
        rays[i] = (noc_ray){ { foot[0], foot[1], foot[2] + heights[i] }, { d[0], d[1], 0 }, length + 2 * MARGIN };
    nav_cast(n, rays, HEIGHTS, hits);
    for (int i = 0; i < HEIGHTS; i++)
        if (nav_is_wall(&hits[i]) && !(hits[i].cls == NOC_CLASS_VEHICLE && !hits[i].front))
            return false;
    return true;
}

/* What is left of the way d between walls. A wall that is too near pushes back; a car only lets nobody nearer. */
static void slide(noc_navigator *n, const double foot[3], double d[2]) {
    contact contacts[FAN];
    int count = find_contacts(n, foot, NAV_BODY + hypot(d[0], d[1]) + MARGIN, contacts);
    for (int round = 0; round < 8 && count; round++)
        for (int i = 0; i < count; i++) {
            const contact *c = &contacts[i];
            double toward = c->u[0] * d[0] + c->u[1] * d[1], room = NOC_MAX(c->t - NAV_BODY, c->car ? 0 : -PUSH);
            for (int k = 0; k < 2 && toward > room; k++)
                d[k] -= (toward - room) * c->u[k];
        }
    double length = hypot(d[0], d[1]);
    if (length > 0 && !is_free(n, foot, d))
        d[0] = d[1] = 0;
}

/* Highest thing under the feet that can be stepped on from here. */
static bool find_support(noc_navigator *n, const double foot[3], noc_hit *best) {
    noc_ray rays[FEET];
    noc_hit hits[FEET];
    bool found = false;
    for (int i = 0; i < FEET; i++)
        rays[i] = (noc_ray){ { foot[0] + (i == 1   ? .15
                                          : i == 2 ? -.15
                                                   : 0),
                               foot[1] + (i == 3   ? .15
                                          : i == 4 ? -.15
                                                   : 0),
                               foot[2] + NAV_KERB + .01 },
                             { 0, 0, -1 },
                             NAV_FAR_BELOW };
    nav_cast(n, rays, FEET, hits);
    for (int i = 0; i < FEET; i++) {
        bool there = hits[i].hit;
        if (there && is_other_s(&hits[i], false))
            there = nav_drop(n, hits[i].place, false, &hits[i]);
        if (there && (!found || hits[i].place[2] > best->place[2])) {
            *best = hits[i];
            found = true;
        }
    }
    return found;
}

/* Goes by d, or stays where nothing is below, it is too steep, or too low. */
static void go(noc_navigator *n, const double d[2]) {
    nav_walker *w = &n->walker;
    double foot[3] = { n->now.eye[0], n->now.eye[1], w->foot }, way[2] = { d[0], d[1] };
    slide(n, foot, way);
    if (way[0] == 0 && way[1] == 0)
        return;
    foot[0] += way[0];
    foot[1] += way[1];
    noc_hit ground;
    if (!find_support(n, foot, &ground) || (ground.normal[2] < NAV_LEVEL && ground.place[2] > w->foot))
        return;
    foot[2] = NOC_MAX(foot[2], ground.place[2]);
    if (ceiling(n, foot).hit)
        return;
    n->now.eye[0] = foot[0];
    n->now.eye[1] = foot[1];
    if (foot[2] > w->foot) {
        w->lag = NOC_MAX(w->lag - (foot[2] - w->foot), -.6);
        w->foot = foot[2];
    }
}

/* Down to what is below: at once where it is a step, else by falling. */
static void settle(noc_navigator *n) {
    nav_walker *w = &n->walker;
    const double foot[3] = { n->now.eye[0], n->now.eye[1], w->foot };
    noc_hit ground;
    if (!find_support(n, foot, &ground)) {
        w->fall = 0; /* at the edge of the world */
        return;
    }
    double drop = w->foot - ground.place[2];
    if (drop > DROP || (w->fall > 0 && drop > 0)) {
        w->fall = NOC_MIN(w->fall + GRAVITY * NAV_STEP, FASTEST_FALL);
        w->foot -= NOC_MIN(w->fall * NAV_STEP, drop);
        return;
    }
    w->fall = 0;
    w->lag = NOC_CLAMP(w->lag + drop, -.6, .6);
    w->foot = ground.place[2];
}

void nav_walk(noc_navigator *n, const double d[2]) {
    nav_walker *w = &n->walker;
    double share = 1 - exp(-NAV_STEP / .08), aside[2], way[2];
    for (int k = 0; k < 2; k++) {
        aside[k] = fabs(w->aside[k]) > 1e-3 ? share * w->aside[k] : w->aside[k];
        w->aside[k] -= aside[k];
    }
    way[0] = d[0] + aside[0] * sin(n->now.yaw) + aside[1] * cos(n->now.yaw);
    way[1] = d[1] - aside[0] * cos(n->now.yaw) + aside[1] * sin(n->now.yaw);
    int parts = (int)NOC_CLAMP(ceil(hypot(way[0], way[1]) / SHORT_STEP), 0, 40);
    for (int i = 0; i < parts; i++)
        go(n, (const double[2]){ way[0] / parts, way[1] / parts });
    settle(n);
    w->lag = fabs(w->lag) > 1e-4 ? w->lag * (1 - share) : 0;
    n->now.eye[2] = w->foot + NAV_EYE + w->lag;
}
