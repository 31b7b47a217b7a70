/* Where one can stand: on one's feet where one is, else in the open beside it. */
#include "scene/navigate.h"

#include <math.h>

static bool is_building(const noc_hit *h) {
    return h->hit && (h->cls == NOC_CLASS_WALL || h->cls == NOC_CLASS_ROOF || h->cls == NOC_CLASS_GROUND ||
                      h->cls == NOC_CLASS_WINDOW || h->cls == NOC_CLASS_DOOR || h->cls == NOC_CLASS_INSTALLATION);
}

/* Models of cities have their walls' fronts outside: who sees a building's back all around, and above, is in it. A room
 * that was made to be looked at shows its fronts. */
static bool is_inside(noc_navigator *n, const double p[3]) {
    enum { SIDES = 8, RAYS = 2 * SIDES + 1 };
    noc_ray rays[RAYS];
    noc_hit hits[RAYS];
    int backs = 0;
    for (int i = 0; i < RAYS; i++) {
        double a = i * 2 * M_PI / SIDES, level = i < SIDES ? 1 : .7, up = i < SIDES ? 0 : .7;
        rays[i] = (noc_ray){ { p[0], p[1], p[2] }, { level * cos(a), level * sin(a), up }, NAV_FAR_BELOW };
    }
    rays[RAYS - 1] = (noc_ray){ { p[0], p[1], p[2] }, { 0, 0, 1 }, NAV_FAR_BELOW };
    nav_cast(n, rays, RAYS, hits);
    for (int i = 0; i < RAYS; i++)
        backs += is_building(&hits[i]) && !hits[i].front;
    return is_building(&hits[RAYS - 1]) && backs > RAYS / 2;
}

static bool can_stand(noc_navigator *n, const noc_hit *h) {
    return h->normal[2] >= NAV_LEVEL && h->cls != NOC_CLASS_WATER && nav_has_room(n, h->place);
}

static void take(const noc_hit *h, double foot[3]) { memcpy(foot, h->place, sizeof(h->place)); }

/* Below the eye, or some steps aside with nothing between. */
static bool stand_here(noc_navigator *n, const double eye[3], double foot[3]) {
    noc_hit hit;
    if (is_inside(n, eye))
        return false;
    if (nav_drop(n, eye, false, &hit) && can_stand(n, &hit)) {
        take(&hit, foot);
        return true;
    }
    for (int i = 0; i < 5 * 8; i++) {
        double a = i % 8 * M_PI / 4, r = .5 * (1 + i / 8), way[3] = { cos(a), sin(a), 0 };
        const double at[3] = { eye[0] + r * way[0], eye[1] + r * way[1], eye[2] };
        if (nav_cast_one(n, eye, way, r + NAV_BODY).hit || !nav_drop(n, at, false, &hit) || !can_stand(n, &hit))
            continue;
        take(&hit, foot);
        return true;
    }
    return false;
}

/* Seen from the sky: ground that is no building's. */
static bool stand_in_the_open(noc_navigator *n, const double near[3], double foot[3]) {
    for (double r = 0; r < 300; r = r < 4 ? r + 1 : 1.3 * r)
        for (int i = 0; i < (r > 0 ? 16 : 1); i++) {
            double a = i * M_PI / 8;
            const double sky[3] = { near[0] + r * cos(a), near[1] + r * sin(a), n->top + 10 };
            noc_hit hit = nav_cast_one(n, sky, (const double[3]){ 0, 0, -1 }, INFINITY);
            if (hit.hit && hit.cls == NOC_CLASS_TREE)
                nav_drop(n, hit.place, true, &hit);
            if (!hit.hit || is_building(&hit) || hit.cls == NOC_CLASS_VEHICLE || hit.cls == NOC_CLASS_LAMP ||
                !can_stand(n, &hit))
                continue;
            take(&hit, foot);
            return true;
        }
    return false;
}

bool nav_find_stand(noc_navigator *n, const double eye[3], double foot[3]) {
    return stand_here(n, eye, foot) || stand_in_the_open(n, eye, foot);
}
