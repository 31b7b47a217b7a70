/* Going to places: cameras that are named, and what is clicked on. */
#include "scene/navigate.h"

#include <math.h>

#define LOW 30.0 /* m: who is higher and wants to walk goes to what it looks at */

static void look(nav_pose *p, const double at[3]) {
    double way[3];
    for (int k = 0; k < 3; k++)
        way[k] = at[k] - p->eye[k];
    p->yaw = atan2(way[1], way[0]);
    p->pitch = atan2(way[2], hypot(way[0], way[1]));
    p->distance = NOC_MAX(sqrt(nav_dot(way, way)), 1e-3);
}

static bool clear_between(noc_navigator *n, const double a[3], const double b[3]) {
    double way[3];
    for (int k = 0; k < 3; k++)
        way[k] = b[k] - a[k];
    double length = sqrt(nav_dot(way, way));
    return length < 1e-3 || !nav_cast_one(n, a, way, length).hit;
}

/* ---- flights ---- */

/* A camera whose target is so far away: what keys of one path have in common. */
static noc_camera key_camera(const nav_pose *p, double distance) {
    nav_pose q = *p;
    noc_camera c;
    q.distance = distance;
    nav_camera_of(&q, &c);
    return c;
}

static double turned(double from, double to) { return remainder(to - from, 2 * M_PI); }

/* Half way: over what stands between, and turned half. */
static bool find_between(noc_navigator *n, const nav_pose *to, nav_pose *out) {
    double way = 0;
    *out = n->now;
    for (int k = 0; k < 3; k++) {
        out->eye[k] = (n->now.eye[k] + to->eye[k]) / 2;
        way = hypot(way, to->eye[k] - n->now.eye[k]);
    }
    out->yaw = n->now.yaw + turned(n->now.yaw, to->yaw) / 2;
    out->pitch = (n->now.pitch + to->pitch) / 2;
    out->fov = (n->now.fov + to->fov) / 2;
    bool turns = fabs(turned(n->now.yaw, to->yaw)) > M_PI / 2, over = !clear_between(n, n->now.eye, to->eye);
    for (int i = 0; i < 5 && over && way > 1; i++) {
        out->eye[2] += NOC_MAX(.2 * way, 3);
        if (clear_between(n, n->now.eye, out->eye) && clear_between(n, out->eye, to->eye))
            break;
    }
    return turns || over;
}

noc_status nav_go_to(noc_navigator *n, const nav_pose *there) {
    nav_pose between;
    double way = 0, look_ahead = NOC_MAX(NOC_MIN(n->now.distance, there->distance), 1);
    n->now = n->before; /* of what was shown last */
    nav_end_flight(n);
    for (int k = 0; k < 3; k++)
        way = hypot(way, there->eye[k] - n->now.eye[k]);
    noc_camera_key keys[3];
    size_t count = 0;
    keys[count++] = (noc_camera_key){ .camera = key_camera(&n->now, look_ahead), .seconds = -1, .hour = -1 };
    if (find_between(n, there, &between))
        keys[count++] = (noc_camera_key){ .camera = key_camera(&between, look_ahead), .seconds = -1, .hour = -1 };
    keys[count++] = (noc_camera_key){ .camera = key_camera(there, look_ahead), .seconds = -1, .hour = -1 };
    n->lasts = NOC_CLAMP(.5 + .22 * log2(1 + way / 5), .5, 2.5);
    n->flown = 0;
    n->there = *there;
    return noc_camera_path_create(keys, count, false, n->lasts, n->scene->log, &n->flight);
}

static void arrive(noc_navigator *n) {
    noc_camera_path_destroy(n->flight);
    n->flight = NULL;
    n->now = n->there;
    n->walker = (nav_walker){ .foot = n->now.eye[2] - NAV_EYE };
}

void nav_fly_on(noc_navigator *n) {
    noc_camera camera;
    nav_pose p;
    n->flown += NAV_STEP;
    double u = n->flown / n->lasts;
    if (u >= 1 || noc_camera_path_at(n->flight, n->lasts * u * u * (3 - 2 * u), &camera) || !nav_pose_of(&camera, &p)) {
        arrive(n);
        n->now.yaw = n->before.yaw + turned(n->before.yaw, n->now.yaw);
        return;
    }
    p.yaw = n->now.yaw + turned(n->now.yaw, p.yaw); /* what is shown lies between the two */
    p.distance = n->now.distance + (n->there.distance - n->now.distance) * NOC_MIN(8 * NAV_STEP / n->lasts, 1);
    n->now = p;
}

void nav_end_flight(noc_navigator *n) {
    noc_camera_path_destroy(n->flight);
    n->flight = NULL;
    nav_rest(n);
}

/* ---- modes and cameras ---- */

static noc_status nowhere(const noc_navigator *n) {
    return noc_error(n->scene->log, NOC_ERR_ARGUMENT, "navigator: there is no place to stand near here");
}

/* Where a walker would be that comes from here. */
static bool find_walker(noc_navigator *n, nav_pose *out) {
    double from[3], foot[3], forward[3];
    noc_hit hit;
    memcpy(from, n->now.eye, sizeof(from));
    bool low = nav_drop(n, from, false, &hit) && hit.distance <= LOW;
    nav_forward(&n->now, forward);
    hit = low ? (noc_hit){ 0 } : nav_cast_one(n, from, forward, INFINITY);
    for (int k = 0; k < 3 && hit.hit; k++)
        from[k] = hit.place[k] + (k == 2 ? NAV_EYE : 0);
    if (!nav_find_stand(n, from, foot))
        return false;
    *out = n->now;
    memcpy(out->eye, foot, sizeof(foot));
    out->eye[2] += NAV_EYE;
    out->pitch = NOC_CLAMP(out->pitch, -.35, .35);
    return true;
}

noc_status noc_navigator_set_mode(noc_navigator *n, noc_navigate_mode mode) {
    if (!n)
        return noc_null(NULL, __func__);
    if ((unsigned)mode >= NOC_NAVIGATE_COUNT)
        return noc_error(n->scene->log, NOC_ERR_ARGUMENT, "navigator: mode is %d, must be a noc_navigate_mode",
                         (int)mode);
    nav_pose there;
    if (mode == n->mode)
        return NOC_OK;
    if (n->flight)
        n->now = n->mode == NOC_NAVIGATE_WALK ? n->there : n->now;
    nav_end_flight(n);
    bool walk = mode == NOC_NAVIGATE_WALK;
    if (walk && !find_walker(n, &there))
        return nowhere(n);
    n->mode = mode;
    if (mode == NOC_NAVIGATE_ORBIT)
        nav_find_middle(n);
    return walk ? nav_go_to(n, &there) : NOC_OK;
}

/* A walker stands on its feet; another camera is no walker's. */
static void settle_mode(noc_navigator *n, nav_pose *p) {
    noc_hit hit;
    if (n->mode != NOC_NAVIGATE_WALK)
        return;
    bool stands = nav_drop(n, p->eye, false, &hit) && hit.distance > 1 && hit.distance < 3 &&
                  hit.normal[2] >= NAV_LEVEL && nav_has_room(n, hit.place);
    if (stands)
        p->eye[2] = hit.place[2] + NAV_EYE;
    else
        n->mode = NOC_NAVIGATE_FLY;
}

static noc_status taken(noc_navigator *n, const noc_camera *camera, nav_pose *p) {
    if (!n || !camera)
        return noc_null(n ? n->scene->log : NULL, "noc_navigator_set_camera");
    if (!nav_pose_of(camera, p))
        return noc_error(n->scene->log, NOC_ERR_ARGUMENT,
                         "navigator: the camera must look somewhere, by a field of view of 1..170 degrees");
    settle_mode(n, p);
    double away = 0;
    for (int k = 0; k < 3; k++)
        away = hypot(away, p->eye[k] - n->middle[k]);
    n->reach = NOC_MAX(n->reach, 1.2 * away);
    return NOC_OK;
}

noc_status noc_navigator_set_camera(noc_navigator *n, const noc_camera *camera) {
    nav_pose p;
    noc_status status = taken(n, camera, &p);
    if (status)
        return status;
    n->now = p;
    nav_end_flight(n);
    n->walker.foot = p.eye[2] - NAV_EYE;
    if (n->mode == NOC_NAVIGATE_ORBIT)
        nav_find_middle(n);
    return NOC_OK;
}

noc_status noc_navigator_go(noc_navigator *n, const noc_camera *camera) {
    nav_pose p;
    noc_status status = taken(n, camera, &p);
    return status ? status : nav_go_to(n, &p);
}

/* ---- clicked points ---- */

/* Eye at that distance from what was hit, in that direction of it, or nearer where something is in between. */
static void stand_off(noc_navigator *n, const noc_hit *hit, const double way[3], double distance, double eye[3]) {
    double from[3];
    for (int k = 0; k < 3; k++)
        from[k] = hit->place[k] + .05 * hit->normal[k];
    noc_hit stop = nav_cast_one(n, from, way, distance * 1.25);
    distance = stop.hit ? .8 * stop.distance : distance;
    for (int k = 0; k < 3; k++)
        eye[k] = from[k] + distance * way[k];
}

/* Before a wall, over what lies. */
static void place_flyer(noc_navigator *n, const noc_hit *hit, nav_pose *p) {
    double level = hypot(hit->normal[0], hit->normal[1]), distance = NOC_CLAMP(.3 * hit->distance, 6, 40), way[3];
    bool wall = hit->normal[2] < NAV_LEVEL && level > .1;
    for (int k = 0; k < 2; k++)
        way[k] = wall ? hit->normal[k] / level : -.8 * (k ? sin(n->now.yaw) : cos(n->now.yaw));
    way[2] = wall ? .15 : .6;
    stand_off(n, hit, way, distance, p->eye);
    look(p, hit->place);
}

/* The same direction, nearer; steeper where something is in between. */
static void place_orbiter(noc_navigator *n, const noc_hit *hit, nav_pose *p) {
    double distance = NOC_CLAMP(.4 * hit->distance, 8, 400), pitch = NOC_MIN(n->now.pitch, -.25), way[3], from[3];
    for (int i = 0; i < 5; i++, pitch = NOC_MAX(pitch - .3, -1.5)) {
        nav_pose q = { .yaw = n->now.yaw, .pitch = pitch };
        nav_forward(&q, way);
        for (int k = 0; k < 3; k++) {
            way[k] = -way[k];
            from[k] = hit->place[k] + .05 * hit->normal[k];
        }
        if (!nav_cast_one(n, from, way, 1.1 * distance).hit)
            break;
    }
    stand_off(n, hit, way, distance, p->eye);
    look(p, hit->place);
}

enum { ABOUT = 24, STEEP = 4, WAYS = ABOUT * STEEP };
static const double steep[STEEP] = { .35, .6, .95, 1.35 };  /* radians over the level */
static const double pleasant[STEEP] = { 1, .95, .75, .45 }; /* what each is worth */
#define BODY .8                                             /* m about a place that its own lamp fills */

/* Ways from a place to eyes that see it: first level ones, each ABOUT of them. */
static void ways_of(const noc_navigator *n, const double place[3], double distance, noc_ray *rays) {
    for (int i = 0; i < WAYS; i++) {
        double a = n->now.yaw + M_PI + 2 * M_PI * (i % ABOUT) / ABOUT, up = steep[i / ABOUT];
        noc_ray *r = &rays[i];
        *r = (noc_ray){ .direction = { cos(up) * cos(a), cos(up) * sin(a), sin(up) }, .far = 1.25 * distance };
        for (int k = 0; k < 3; k++)
            r->origin[k] = place[k] + NOC_MIN(BODY, .3 * distance) * r->direction[k];
    }
}

bool noc_navigator_look(noc_navigator *n, const double place[3], double distance) {
    noc_ray rays[WAYS];
    noc_hit hits[WAYS];
    double best = 0, away = 0;
    int way = -1;
    if (!n || !place || !(distance > 0 && distance < 1e6))
        return false;
    for (int k = 0; k < 3; k++)
        if (!(fabs(place[k]) < 1e7))
            return false;
    ways_of(n, place, distance, rays);
    nav_cast(n, rays, WAYS, hits);
    for (int i = 0; i < WAYS; i++) {
        double room = hits[i].hit ? NOC_MIN(distance, .8 * hits[i].distance) : distance;
        double turn = fabs(remainder(2 * M_PI * (i % ABOUT) / ABOUT, 2 * M_PI)) / M_PI;
        double score = room / distance * pleasant[i / ABOUT] * (1 - .25 * turn);
        if (score > best * 1.0001) {
            best = score;
            away = room;
            way = i;
        }
    }
    if (way < 0 || away < NOC_MIN(2, .5 * distance))
        return false;
    nav_pose there = n->now;
    for (int k = 0; k < 3; k++)
        there.eye[k] = rays[way].origin[k] + away * rays[way].direction[k];
    look(&there, place);
    if (n->mode == NOC_NAVIGATE_WALK)
        n->mode = NOC_NAVIGATE_FLY;
    return nav_go_to(n, &there) == NOC_OK;
}

static bool place_walker(noc_navigator *n, const noc_hit *hit, nav_pose *p) {
    double from[3], foot[3], level = hypot(hit->normal[0], hit->normal[1]);
    bool wall = nav_is_wall(hit);
    if (wall && level > .1) {
        const double way[3] = { hit->normal[0] / level, hit->normal[1] / level, 0 };
        stand_off(n, hit, way, 3, from);
    } else {
        memcpy(from, hit->place, sizeof(from));
        from[2] += NAV_EYE;
    }
    if (!nav_find_stand(n, from, foot))
        return false;
    memcpy(p->eye, foot, sizeof(foot));
    p->eye[2] += NAV_EYE;
    p->pitch = 0;
    if (wall)
        look(p, hit->place);
    p->pitch = NOC_CLAMP(p->pitch, -.6, .6);
    return true;
}

bool noc_navigator_jump(noc_navigator *n, const double at[2], double aspect) {
    if (!n || !at || !(at[0] >= 0 && at[0] <= 1 && at[1] >= 0 && at[1] <= 1))
        return false;
    noc_camera camera;
    noc_ray ray;
    aspect = aspect > .01 && aspect < 100 ? aspect : 16.0 / 9;
    noc_navigator_camera(n, &camera);
    if (noc_camera_ray(&camera, (int)(1000 * aspect), 1000, (double[2]){ 1000 * aspect * at[0], 1000 * at[1] }, &ray))
        return false;
    noc_hit hit = nav_cast_one(n, ray.origin, ray.direction, INFINITY);
    if (!hit.hit)
        return false;
    nav_pose there = n->now;
    if (n->mode == NOC_NAVIGATE_FLY)
        place_flyer(n, &hit, &there);
    else if (n->mode == NOC_NAVIGATE_ORBIT)
        place_orbiter(n, &hit, &there);
    else if (!place_walker(n, &hit, &there))
        return false;
    there.pitch = NOC_CLAMP(there.pitch, -1.5, 1.5);
    return nav_go_to(n, &there) == NOC_OK;
}
