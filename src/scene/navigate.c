/* Moving about: what keys, pointer and time make of a camera. */
#include "scene/navigate.h"

#include <math.h>

#define STEEPEST (89 * M_PI / 180)
#define SOFT 0.1       /* s: time constant of speeds */
#define ZOOM_SOFT 0.07 /* s: of zooming */
#define ZOOM_STEP 0.85 /* of the distance that is left after a step */
#define FOV_STEP 0.93  /* of the field of view */
#define NEAREST 0.5    /* m to what is zoomed to, and to the ground */
#define MOST_EXTENTS 5 /* that the eye may be away from the scene's middle */
#define WALK_SPEED 2.0 /* m/s */
#define WALK_MOST 50.0 /* m/s */

const char *noc_navigate_mode_name(noc_navigate_mode mode) {
    static const char *const names[NOC_NAVIGATE_COUNT] = { "orbit", "fly", "walk" };
    return (unsigned)mode < NOC_NAVIGATE_COUNT ? names[mode] : "unknown";
}

/* ---- poses ---- */

void nav_forward(const nav_pose *p, double out[3]) {
    out[0] = cos(p->yaw) * cos(p->pitch);
    out[1] = sin(p->yaw) * cos(p->pitch);
    out[2] = sin(p->pitch);
}

bool nav_pose_of(const noc_camera *c, nav_pose *out) {
    double way[3], level;
    nav_pose p = { .fov = c->fov_deg };
    for (int k = 0; k < 3; k++) {
        way[k] = c->target[k] - c->eye[k];
        p.eye[k] = c->eye[k];
    }
    p.distance = sqrt(nav_dot(way, way));
    if (!(p.distance > 1e-9 && p.distance < 1e7 && sqrt(nav_dot(c->eye, c->eye)) < 1e7 && c->fov_deg >= 1 &&
          c->fov_deg <= 170))
        return false;
    level = hypot(way[0], way[1]);
    double flip = way[2] > 0 ? -1 : 1; /* seen from straight above, what is up in the picture lies ahead */
    p.yaw = level > 1e-6 * p.distance ? atan2(way[1], way[0]) : atan2(flip * c->up[1], flip * c->up[0]);
    p.pitch = NOC_CLAMP(atan2(way[2], level), -STEEPEST, STEEPEST);
    *out = p;
    return isfinite(p.yaw);
}

void nav_camera_of(const nav_pose *p, noc_camera *out) {
    double forward[3];
    nav_forward(p, forward);
    *out = (noc_camera){ .up = { 0, 0, 1 }, .fov_deg = p->fov };
    for (int k = 0; k < 3; k++) {
        out->eye[k] = p->eye[k];
        out->target[k] = p->eye[k] + p->distance * forward[k];
    }
}

/* What is shown: between the last two steps. */
static nav_pose shown(const noc_navigator *n) {
    double u = n->leftover / NAV_STEP;
    nav_pose p = n->before;
    for (int k = 0; k < 3; k++)
        p.eye[k] += u * (n->now.eye[k] - p.eye[k]);
    p.yaw += u * (n->now.yaw - p.yaw);
    p.pitch += u * (n->now.pitch - p.pitch);
    p.distance += u * (n->now.distance - p.distance);
    p.fov += u * (n->now.fov - p.fov);
    return memcmp(&n->before, &n->now, sizeof(p)) ? p : n->now;
}

void nav_rest(noc_navigator *n) {
    memset(n->velocity, 0, sizeof(n->velocity));
    n->zoom = 0;
    n->before = n->now;
    n->walker.fall = n->walker.lag = n->walker.aside[0] = n->walker.aside[1] = 0;
}

/* ---- rays ---- */

void nav_cast(noc_navigator *n, const noc_ray *rays, size_t count, noc_hit *hits) {
    noc_status status = n->cast(n->user, rays, count, hits);
    if (!status)
        return;
    n->failed = status;
    memset(hits, 0, count * sizeof(*hits));
}

noc_hit nav_cast_one(noc_navigator *n, const double from[3], const double way[3], double far) {
    noc_ray ray = { { from[0], from[1], from[2] }, { way[0], way[1], way[2] }, far };
    noc_hit hit;
    nav_cast(n, &ray, 1, &hit);
    return hit;
}

void nav_find_middle(noc_navigator *n) {
    double forward[3];
    nav_forward(&n->now, forward);
    noc_hit hit = nav_cast_one(n, n->now.eye, forward, INFINITY);
    n->now.distance = NOC_CLAMP(hit.hit ? hit.distance : n->now.distance, NEAREST, n->reach);
    n->before = n->now;
}

static noc_hit see(noc_navigator *n, const double at[2], double aspect, noc_ray *ray) {
    noc_camera camera;
    noc_hit hit = { 0 };
    nav_camera_of(&n->now, &camera);
    double pixel[2] = { 1000 * aspect * at[0], 1000 * at[1] };
    if (!noc_camera_ray(&camera, (int)(1000 * aspect), 1000, pixel, ray))
        nav_cast(n, ray, 1, &hit);
    return hit;
}

/* ---- bounds ---- */

/* Heights of the ground: under the eye, or over one that got under it. */
static bool is_ground(const noc_hit *h) {
    return h->hit && (h->cls == NOC_CLASS_TERRAIN || h->cls == NOC_CLASS_ROAD || h->cls == NOC_CLASS_SIDEWALK ||
                      h->cls == NOC_CLASS_GREEN || h->cls == NOC_CLASS_WATER);
}

/* Keeps the eye over the ground; *below: how far what is below it is. */
static void keep_above(noc_navigator *n, double *below) {
    double *eye = n->now.eye;
    const noc_ray rays[2] = { { { eye[0], eye[1], eye[2] }, { 0, 0, -1 }, NAV_FAR_BELOW },
                              { { eye[0], eye[1], eye[2] }, { 0, 0, 1 }, NAV_FAR_BELOW } };
    noc_hit hits[2];
    nav_cast(n, rays, 2, hits);
    *below = hits[0].hit ? hits[0].distance : NOC_MAX(eye[2] - n->middle[2], 0.2 * n->reach / MOST_EXTENTS);
    if (is_ground(&hits[0]) && hits[0].distance < NEAREST)
        eye[2] = hits[0].place[2] + NEAREST;
    else if (!hits[0].hit && is_ground(&hits[1]) && !hits[1].front)
        eye[2] = hits[1].place[2] + NEAREST;
}

static void keep_in_reach(noc_navigator *n) {
    double away = 0;
    for (int k = 0; k < 3; k++)
        away = hypot(away, n->now.eye[k] - n->middle[k]);
    for (int k = 0; k < 3 && away > n->reach; k++)
        n->now.eye[k] = n->middle[k] + (n->now.eye[k] - n->middle[k]) * n->reach / away;
}

/* ---- what the hand does ---- */

static void turn(noc_navigator *n, double x, double y) {
    double rate = n->mode == NOC_NAVIGATE_ORBIT ? M_PI : M_PI / 2 * n->now.fov / 50, before[3], after[3];
    nav_forward(&n->now, before);
    n->now.yaw -= rate * x;
    n->now.pitch = NOC_CLAMP(n->now.pitch - rate * y, -STEEPEST, STEEPEST);
    nav_forward(&n->now, after);
    for (int k = 0; k < 3 && n->mode == NOC_NAVIGATE_ORBIT; k++)
        n->now.eye[k] += n->now.distance * (before[k] - after[k]);
}

static void pan(noc_navigator *n, double x, double y, const noc_navigate_input *in) {
    double height = 2 * tan(n->now.fov * M_PI / 360), forward[3], right[3] = { sin(n->now.yaw), -cos(n->now.yaw), 0 };
    if (n->mode == NOC_NAVIGATE_WALK) {
        n->walker.aside[0] -= 4 * x;
        n->walker.aside[1] += 4 * y;
        return;
    }
    nav_forward(&n->now, forward);
    double distance = n->now.distance;
    noc_ray ray;
    if (n->mode == NOC_NAVIGATE_FLY) {
        noc_hit hit = see(n, in->at, in->aspect, &ray);
        distance = NOC_CLAMP(hit.hit ? hit.distance : n->pace, 2, n->reach);
    }
    const double up[3] = { -forward[2] * cos(n->now.yaw), -forward[2] * sin(n->now.yaw), cos(n->now.pitch) };
    for (int k = 0; k < 3; k++)
        n->now.eye[k] += height * distance * (y * up[k] - x * right[k]);
}

/* A share of what the hand did. */
static void hand(noc_navigator *n, const noc_navigate_input *in, double share) {
    if (in->turn[0] != 0 || in->turn[1] != 0)
        turn(n, share * in->turn[0], share * in->turn[1]);
    if (in->pan[0] != 0 || in->pan[1] != 0)
        pan(n, share * in->pan[0], share * in->pan[1], in);
}

static void begin_zoom(noc_navigator *n, const noc_navigate_input *in) {
    noc_ray ray;
    n->zoom = NOC_CLAMP(n->zoom + in->zoom, -40, 40);
    if (n->mode == NOC_NAVIGATE_WALK)
        return;
    noc_hit hit = see(n, in->at, in->aspect, &ray);
    double forward[3], ahead = n->mode == NOC_NAVIGATE_ORBIT ? n->now.distance : 4 * n->pace;
    nav_forward(&n->now, forward);
    for (int k = 0; k < 3; k++)
        n->pivot[k] = hit.hit ? hit.place[k] : n->now.eye[k] + ahead * forward[k];
}

static void zoom_step(noc_navigator *n) {
    double steps = n->zoom * (1 - exp(-NAV_STEP / ZOOM_SOFT)), to[3];
    if (fabs(n->zoom) < 2e-3)
        steps = n->zoom;
    n->zoom -= steps;
    if (n->mode == NOC_NAVIGATE_WALK) {
        n->now.fov = NOC_CLAMP(n->now.fov * pow(FOV_STEP, steps), 15, 90);
        return;
    }
    for (int k = 0; k < 3; k++)
        to[k] = n->now.eye[k] - n->pivot[k];
    double distance = NOC_MAX(sqrt(nav_dot(to, to)), 1e-6), scale = pow(ZOOM_STEP, steps);
    scale = scale < 1 ? NOC_MIN(NOC_MAX(scale, NEAREST / distance), 1) : scale;
    for (int k = 0; k < 3; k++)
        n->now.eye[k] = n->pivot[k] + scale * to[k];
    n->now.distance = NOC_CLAMP(n->now.distance * scale, NEAREST, n->reach);
}

/* ---- what keys do ---- */

static double pressed(uint32_t keys, noc_navigate_key more, noc_navigate_key less) {
    return (double)((keys & more) != 0) - (double)((keys & less) != 0);
}

/* Where keys want to go, m/s. */
static void wanted(const noc_navigator *n, uint32_t keys, double out[3]) {
    double ahead = pressed(keys, NOC_KEY_FORWARD, NOC_KEY_BACK), aside = pressed(keys, NOC_KEY_RIGHT, NOC_KEY_LEFT),
           up = n->mode == NOC_NAVIGATE_WALK ? 0 : pressed(keys, NOC_KEY_UP, NOC_KEY_DOWN);
    double forward[3] = { cos(n->now.yaw), sin(n->now.yaw), 0 };
    if (n->mode == NOC_NAVIGATE_FLY)
        nav_forward(&n->now, forward);
    double speed = n->speed > 0 ? n->speed : n->pace;
    speed *= (keys & NOC_KEY_FAST ? 4 : 1) * (keys & NOC_KEY_SLOW ? .25 : 1);
    speed = NOC_MIN(speed, n->mode == NOC_NAVIGATE_WALK ? WALK_MOST : n->reach);
    out[0] = ahead * forward[0] + aside * sin(n->now.yaw);
    out[1] = ahead * forward[1] - aside * cos(n->now.yaw);
    out[2] = ahead * forward[2] + up;
    double length = sqrt(nav_dot(out, out));
    for (int k = 0; k < 3; k++)
        out[k] *= length > 0 ? speed / length : 0;
}

/* Speeds follow smoothly; what is too slow to be seen stands. */
static void accelerate(noc_navigator *n, const double want[3]) {
    double share = 1 - exp(-NAV_STEP / SOFT), size = 0;
    for (int k = 0; k < 3; k++) {
        n->velocity[k] += share * (want[k] - n->velocity[k]);
        size = fmax(size, fabs(n->velocity[k]));
    }
    if (nav_dot(want, want) == 0 && size < 1e-3 * NOC_MAX(n->pace, 1))
        memset(n->velocity, 0, sizeof(n->velocity));
}

static void set_pace(noc_navigator *n, double below, bool at_once) {
    double extent = n->reach / MOST_EXTENTS;
    double goal = n->mode == NOC_NAVIGATE_WALK    ? WALK_SPEED
                  : n->mode == NOC_NAVIGATE_ORBIT ? NOC_CLAMP(.6 * n->now.distance, 1, extent)
                                                  : NOC_CLAMP(.7 * below, 3, NOC_MAX(extent / 2, 3));
    n->pace += (at_once ? 1 : 1 - exp(-NAV_STEP / .25)) * (goal - n->pace);
}

/* The first of a motion has the speed of the place at once. */
static void begin_keys(noc_navigator *n) {
    double below = 0;
    if (n->mode != NOC_NAVIGATE_WALK)
        keep_above(n, &below);
    set_pace(n, below, true);
}

/* A step of orbit and fly. */
static void move_freely(noc_navigator *n, const double want[3], bool moved) {
    double below;
    accelerate(n, want);
    for (int k = 0; k < 3; k++)
        n->now.eye[k] += NAV_STEP * n->velocity[k];
    if (!moved && nav_dot(n->velocity, n->velocity) == 0)
        return;
    keep_in_reach(n);
    keep_above(n, &below);
    set_pace(n, below, false);
}

static void step(noc_navigator *n, const noc_navigate_input *in, double share) {
    double want[3];
    n->before = n->now;
    if (n->flight) {
        nav_fly_on(n);
        return;
    }
    bool moved = n->zoom != 0 || in->pan[0] != 0 || in->pan[1] != 0 ||
                 (n->mode == NOC_NAVIGATE_ORBIT && (in->turn[0] != 0 || in->turn[1] != 0));
    hand(n, in, share);
    if (n->zoom != 0)
        zoom_step(n);
    if (in->keys & (NOC_KEY_FAST - 1) && nav_dot(n->velocity, n->velocity) == 0)
        begin_keys(n);
    wanted(n, in->keys, want);
    if (n->mode != NOC_NAVIGATE_WALK) {
        move_freely(n, want, moved);
        return;
    }
    accelerate(n, want);
    nav_walk(n, (double[2]){ NAV_STEP * n->velocity[0], NAV_STEP * n->velocity[1] });
}

static double sane(double x, double most) { return isfinite(x) ? NOC_CLAMP(x, -most, most) : 0; }

static noc_navigate_input sane_input(const noc_navigate_input *in) {
    noc_navigate_input out = { .seconds = NOC_MAX(sane(in->seconds, 1), 0),
                               .keys = in->keys,
                               .zoom = sane(in->zoom, 40),
                               .aspect = NOC_MAX(sane(in->aspect, 100), 0) };
    out.aspect = out.aspect > 0.01 ? out.aspect : 16.0 / 9;
    for (int k = 0; k < 2; k++) {
        out.turn[k] = sane(in->turn[k], 10);
        out.pan[k] = sane(in->pan[k], 10);
        out.at[k] = NOC_CLAMP(sane(in->at[k], 1), 0, 1);
    }
    return out;
}

static bool touches(const noc_navigate_input *in) {
    return in->keys & (NOC_KEY_FAST - 1) || in->turn[0] != 0 || in->turn[1] != 0 || in->pan[0] != 0 ||
           in->pan[1] != 0 || in->zoom != 0;
}

/* Between two steps: what is shown goes by what the hand did, too. */
static void hand_between(noc_navigator *n, const noc_navigate_input *in) {
    nav_pose was = n->now;
    hand(n, in, 1);
    for (int k = 0; k < 3; k++)
        n->before.eye[k] += n->now.eye[k] - was.eye[k];
    n->before.yaw += n->now.yaw - was.yaw;
    n->before.pitch += n->now.pitch - was.pitch;
}

noc_status noc_navigator_input(noc_navigator *n, const noc_navigate_input *input, noc_camera *camera) {
    if (!n || !input)
        return noc_null(n ? n->scene->log : NULL, __func__);
    noc_navigate_input in = sane_input(input);
    n->failed = NOC_OK;
    if (n->flight && n->mode != NOC_NAVIGATE_WALK && touches(&in))
        nav_end_flight(n);
    double time = n->leftover + in.seconds;
    int steps = (int)floor(time / NAV_STEP + 1e-9);
    if (in.zoom != 0 && !n->flight)
        begin_zoom(n, &in);
    if (!steps && !n->flight)
        hand_between(n, &in);
    for (int i = 0; i < steps; i++)
        step(n, &in, 1.0 / steps);
    n->leftover = NOC_MAX(time - steps * NAV_STEP, 0);
    if (camera)
        noc_navigator_camera(n, camera);
    return n->failed;
}

/* ---- what programs ask and set ---- */

noc_navigator *noc_navigator_create(const noc_scene *scene, noc_cast_fn cast, void *user) {
    if (!scene || !cast || !scene->committed) {
        noc_error(scene ? scene->log : NULL, NOC_ERR_ARGUMENT, "navigator: no scene that is committed, or no rays");
        return NULL;
    }
    noc_scene_info info;
    noc_camera camera = noc_camera_default();
    noc_scene_get_info(scene, &info);
    camera.target[1] = 1;
    if (noc_scene_camera(scene, NOC_VIEWPOINT_OWN, 16.0 / 9, &camera) == NOC_ERR_MEMORY)
        return NULL;
    noc_navigator *n = noc_calloc(1, sizeof(*n));
    if (!n) {
        noc_no_memory(scene->log, "navigator");
        return NULL;
    }
    *n = (noc_navigator){ .scene = scene, .cast = cast, .user = user, .top = info.bounds_max[2] };
    double extent = 0;
    for (int k = 0; k < 3; k++) {
        n->middle[k] = (info.bounds_min[k] + info.bounds_max[k]) / 2;
        extent = hypot(extent, info.bounds_max[k] - info.bounds_min[k]);
    }
    n->reach = MOST_EXTENTS * NOC_MAX(extent, 1);
    if (noc_navigator_set_camera(n, &camera)) {
        noc_navigator_destroy(n);
        return NULL;
    }
    return n;
}

void noc_navigator_destroy(noc_navigator *n) {
    if (!n)
        return;
    noc_camera_path_destroy(n->flight);
    free(n);
}

bool noc_navigator_moves(const noc_navigator *n) {
    return n && (n->flight || nav_dot(n->velocity, n->velocity) > 0 || n->zoom != 0 || n->walker.fall > 0 ||
                 n->walker.lag != 0 || n->walker.aside[0] != 0 || n->walker.aside[1] != 0 ||
                 memcmp(&n->before, &n->now, sizeof(n->now)));
}

void noc_navigator_camera(const noc_navigator *n, noc_camera *camera) {
    if (!n || !camera)
        return;
    nav_pose p = shown(n);
    nav_camera_of(&p, camera);
}

noc_navigate_mode noc_navigator_mode(const noc_navigator *n) { return n ? n->mode : NOC_NAVIGATE_ORBIT; }

noc_status noc_navigator_set_speed(noc_navigator *n, double speed) {
    if (!n)
        return noc_null(NULL, __func__);
    if (!(speed >= 0 && speed <= 1e6))
        return noc_error(n->scene->log, NOC_ERR_ARGUMENT, "navigator: speed is %g m/s, must be in 0..1000000", speed);
    n->speed = speed;
    return NOC_OK;
}

double noc_navigator_speed(const noc_navigator *n) { return !n ? 0 : n->speed > 0 ? n->speed : n->pace; }
