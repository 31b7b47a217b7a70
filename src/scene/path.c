/* Camera paths: a curve through keys, and where on it one is at a time. */
#include "scene/camera.h"

#include <math.h>

/* Numbers of a place on a path. The first MEASURED of them are metres, and say how long a way is: zoom is the logarithm
 * of the picture's half height at distance 1, times the mean distance of targets. */
enum { EYE = 0, TARGET = 3, ZOOM = 6, MEASURED = 7, UP = 7, NUMBERS = 10, STEPS = 64 };

typedef struct place {
    double v[NUMBERS];
} place;

typedef struct path_key {
    place at;
    place tangent;         /* of the curve's parameter at this key, for the leg before it and that after it */
    double knot;           /* parameter's length of the leg after it; 0: the camera rests */
    double start;          /* length of the way up to here, m */
    double seconds;        /* when */
    double speed;          /* m/s */
    double lengths[STEPS]; /* of the way up to the ends of the leg's steps, from the leg's start */
    double hour;           /* < 0: not told; grows beyond 24 from day to day */
} path_key;

struct noc_camera_path {
    bool loop;
    size_t legs; /* keys: one more */
    double zoom_scale;
    path_key *keys;
};

static double distance(const place *a, const place *b) {
    double sum = 0;
    for (int k = 0; k < MEASURED; k++)
        sum += (a->v[k] - b->v[k]) * (a->v[k] - b->v[k]);
    return sqrt(sum);
}

/* ---- the curve ---- */

/* Cubic Hermite at share u of leg i. */
static place on_leg(const noc_camera_path *path, size_t i, double u) {
    const path_key *a = &path->keys[i], *b = a + 1;
    double u2 = u * u, u3 = u2 * u, from = 2 * u3 - 3 * u2 + 1, to = 3 * u2 - 2 * u3;
    double out = a->knot * (u3 - 2 * u2 + u), in = a->knot * (u3 - u2);
    place p;
    for (int k = 0; k < NUMBERS; k++)
        p.v[k] = from * a->at.v[k] + to * b->at.v[k] + out * a->tangent.v[k] + in * b->tangent.v[k];
    return p;
}

/* Catmull-Rom over knots whose lengths are the roots of the legs'. At an open end, and beside a rest, the camera starts
 * and stops straight along its leg, or not at all. */
static void make_tangents(noc_camera_path *path) {
    size_t n = path->legs;
    if (!n)
        return; /* a camera that stands */
    for (size_t i = 0; i < n; i++)
        path->keys[i].knot = sqrt(distance(&path->keys[i].at, &path->keys[i + 1].at));
    for (size_t i = 0; i <= n; i++) {
        bool inside = path->loop || (i > 0 && i < n);
        const path_key *before = &path->keys[i > 0 ? i - 1 : n - 1], *at = &path->keys[i];
        const path_key *leg = &path->keys[i < n ? i : 0], *after = leg + 1;
        if (!inside) {
            before = i ? before : at;
            after = i ? at : after;
        }
        double d0 = before->knot, d1 = leg->knot;
        for (int k = 0; k < NUMBERS; k++) {
            double a = before->at.v[k], b = at->at.v[k], c = after->at.v[k], *tangent = &path->keys[i].tangent.v[k];
            if (!inside)
                *tangent = before->knot > 0 ? (c - a) / before->knot : 0;
            else
                *tangent = d0 > 0 && d1 > 0 ? (b - a) / d0 - (c - a) / (d0 + d1) + (c - b) / d1 : 0;
        }
    }
}

static void measure(noc_camera_path *path) {
    for (size_t i = 0; i < path->legs; i++) {
        path_key *key = &path->keys[i];
        place before = key->at;
        double length = 0;
        for (int s = 0; s < STEPS; s++) {
            place next = on_leg(path, i, (s + 1.0) / STEPS);
            key->lengths[s] = length += distance(&before, &next);
            before = next;
        }
        path->keys[i + 1].start = key->start + length;
    }
}

/* ---- time ---- */

/* Derivative of the monotone cubic between two legs of h0 and h1 seconds at mean speeds s0 and s1. */
static double speed_between(double h0, double s0, double h1, double s1) {
    if (!(s0 > 0 && s1 > 0))
        return 0;
    double w0 = h0 + 2 * h1, w1 = 2 * h0 + h1;
    return (w0 + w1) / (w0 / s0 + w1 / s1);
}

static void make_speeds(noc_camera_path *path) {
    size_t n = path->legs;
    path_key *keys = path->keys;
    for (size_t i = 0; i <= n && n; i++) {
        size_t before = i ? i - 1 : path->loop ? n - 1 : 0, after = i < n ? i : path->loop ? 0 : n - 1;
        double h0 = keys[before + 1].seconds - keys[before].seconds, h1 = keys[after + 1].seconds - keys[after].seconds;
        double l0 = keys[before + 1].start - keys[before].start, l1 = keys[after + 1].start - keys[after].start;
        keys[i].speed = speed_between(h0, l0 / h0, h1, l1 / h1);
    }
}

/* Seconds of all keys. What takes no time anywhere is spread evenly. */
static void make_times(noc_camera_path *path, bool told, double seconds) {
    size_t n = path->legs;
    path_key *keys = path->keys;
    double length = keys[n].start;
    if (told && path->loop) {
        double way = keys[n - 1].start, spent = keys[n - 1].seconds - keys[0].seconds, back = length - way;
        keys[n].seconds = keys[n - 1].seconds + (way > 0 && back > 0 ? back * spent / way : spent / (double)(n - 1));
    }
    double scale = told && seconds > 0 ? seconds / keys[n].seconds : 1, all = seconds > 0 ? seconds : 1;
    for (size_t i = 0; i <= n && n; i++) {
        double share = length > 0 ? keys[i].start / length : (double)i / (double)n;
        keys[i].seconds = told ? scale * keys[i].seconds : all * share;
    }
    if (!n)
        keys[0].seconds = told && !(seconds > 0) && keys[0].seconds > 0 ? keys[0].seconds : all;
    make_speeds(path);
}

/* ---- making one ---- */

static noc_status check_key(const noc_camera_key *key, size_t i, noc_log *log) {
    const noc_camera *c = &key->camera;
    double along = 0, up = 0;
    bool near = true;
    for (int k = 0; k < 3; k++) {
        along += fabs(c->target[k] - c->eye[k]);
        up += fabs(c->up[k]);
        near = near && fabs(c->eye[k]) < 1e7 && fabs(c->target[k]) < 1e7;
    }
    if (!(near && along > 1e-9 && up > 1e-30 && up < 1e30 && c->fov_deg >= 0.01 && c->fov_deg <= 179))
        return noc_error(log, NOC_ERR_ARGUMENT,
                         "camera path: key %zu looks nowhere, is more than 10 000 km away, or its field of view is not "
                         "within 0.01 to 179 degrees",
                         i + 1);
    if (!(key->seconds <= NOC_PATH_MOST_SECONDS && key->hour <= 24))
        return noc_error(log, NOC_ERR_ARGUMENT, "camera path: key %zu is later than %g s, or than hour 24", i + 1,
                         NOC_PATH_MOST_SECONDS);
    return NOC_OK;
}

static noc_status check(const noc_camera_key *keys, size_t count, double seconds, bool *told, noc_log *log) {
    if (!count || count > NOC_PATH_MOST_KEYS)
        return noc_error(log, NOC_ERR_ARGUMENT, "camera path: it has %zu keys, must have 1 to %d", count,
                         NOC_PATH_MOST_KEYS);
    if (!(seconds >= 0 && seconds <= NOC_PATH_MOST_SECONDS))
        return noc_error(log, NOC_ERR_ARGUMENT, "camera path: it takes %g s, must take 0 to %g", seconds,
                         NOC_PATH_MOST_SECONDS);
    *told = keys[count - 1].seconds >= 0;
    double before = -1;
    for (size_t i = 0; i < count; i++) {
        double at = *told && !i ? NOC_MAX(keys[i].seconds, 0) : keys[i].seconds;
        noc_status status = check_key(&keys[i], i, log);
        if (status)
            return status;
        if (*told != (at >= 0))
            return noc_error(log, NOC_ERR_ARGUMENT,
                             "camera path: key %zu %s its seconds: all keys tell theirs (but the first, which may "
                             "leave them out), or none does",
                             i + 1, *told ? "does not tell" : "tells");
        if (*told && !(at > before))
            return noc_error(log, NOC_ERR_ARGUMENT, "camera path: key %zu is not later than the one before it", i + 1);
        before = at;
    }
    return NOC_OK;
}

static void take_keys(noc_camera_path *path, const noc_camera_key *keys, size_t count, bool told) {
    double day = 0, before = -1;
    path->zoom_scale = 0;
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++)
            path->zoom_scale += fabs(keys[i].camera.target[k] - keys[i].camera.eye[k]) / (double)count;
    for (size_t i = 0; i < count; i++) {
        const noc_camera *c = &keys[i].camera;
        path_key *key = &path->keys[i];
        memcpy(key->at.v + EYE, c->eye, sizeof(c->eye));
        memcpy(key->at.v + TARGET, c->target, sizeof(c->target));
        memcpy(key->at.v + UP, c->up, sizeof(c->up));
        double up = sqrt(c->up[0] * c->up[0] + c->up[1] * c->up[1] + c->up[2] * c->up[2]);
        for (int k = 0; k < 3; k++)
            key->at.v[UP + k] /= up;
        key->at.v[ZOOM] = path->zoom_scale * log(tan(c->fov_deg * M_PI / 360));
        key->seconds = told ? NOC_MAX(keys[i].seconds, 0) : 0;
        day += keys[i].hour >= 0 && keys[i].hour < before ? 24 : 0;
        before = keys[i].hour >= 0 ? keys[i].hour : before;
        key->hour = keys[i].hour >= 0 ? keys[i].hour + day : -1;
    }
    if (path->legs == count) {
        path->keys[count] = path->keys[0];
        path->keys[count].hour = -1;
    }
}

noc_status noc_camera_path_create(const noc_camera_key *keys, size_t count, bool loop, double seconds, noc_log *log,
                                  noc_camera_path **path) {
    bool told = false;
    if (!keys || !path)
        return noc_null(log, __func__);
    *path = NULL;
    noc_status status = check(keys, count, seconds, &told, log);
    if (status)
        return status;
    noc_camera_path *made = noc_calloc(1, sizeof(*made));
    if (made) {
        made->loop = loop && count > 1;
        made->legs = made->loop ? count : count - 1;
        made->keys = noc_calloc(made->legs + 1, sizeof(*made->keys));
    }
    if (!made || !made->keys) {
        free(made);
        return noc_no_memory(log, "camera path");
    }
    take_keys(made, keys, count, told);
    make_tangents(made);
    measure(made);
    make_times(made, told, seconds);
    *path = made;
    return NOC_OK;
}

void noc_camera_path_destroy(noc_camera_path *path) {
    if (path)
        free(path->keys);
    free(path);
}

void noc_turn_keys(const noc_camera *camera, bool about_eye, noc_camera_key keys[NOC_TURN_KEYS]) {
    const double *centre = about_eye ? camera->eye : camera->target;
    for (int i = 0; i < NOC_TURN_KEYS; i++) {
        double c = cos(2 * M_PI * i / NOC_TURN_KEYS), s = sin(2 * M_PI * i / NOC_TURN_KEYS);
        keys[i] = (noc_camera_key){ .camera = *camera, .seconds = -1, .hour = -1 };
        double *turned = about_eye ? keys[i].camera.target : keys[i].camera.eye, *up = keys[i].camera.up;
        double x = turned[0] - centre[0], y = turned[1] - centre[1], ux = up[0], uy = up[1];
        turned[0] = centre[0] + c * x - s * y;
        turned[1] = centre[1] + s * x + c * y;
        up[0] = c * ux - s * uy;
        up[1] = s * ux + c * uy;
    }
}

static noc_status turn(const noc_camera *camera, bool about_eye, double seconds, noc_log *log, noc_camera_path **path) {
    noc_camera_key keys[NOC_TURN_KEYS];
    noc_turn_keys(camera, about_eye, keys);
    return noc_camera_path_create(keys, NOC_TURN_KEYS, true, seconds, log, path);
}

noc_status noc_camera_path_orbit(const noc_camera *camera, double seconds, noc_log *log, noc_camera_path **path) {
    return camera && path ? turn(camera, false, seconds, log, path) : noc_null(log, __func__);
}

noc_status noc_camera_path_pan(const noc_camera *camera, double seconds, noc_log *log, noc_camera_path **path) {
    return camera && path ? turn(camera, true, seconds, log, path) : noc_null(log, __func__);
}

/* ---- asking one ---- */

double noc_camera_path_seconds(const noc_camera_path *path) { return path ? path->keys[path->legs].seconds : 0; }

bool noc_camera_path_loops(const noc_camera_path *path) { return path && path->loop; }

/* Within 0 and its end. */
static double time_on(const noc_camera_path *path, double seconds) {
    double end = noc_camera_path_seconds(path);
    if (!path->loop)
        return NOC_CLAMP(seconds, 0, end);
    double t = fmod(seconds, end);
    return t < 0 ? t + end : t;
}

/* The leg that t lies on, and its share of the leg's time. */
static size_t leg_at(const noc_camera_path *path, double t, double *share) {
    size_t lo = 0, hi = path->legs;
    while (hi - lo > 1) {
        size_t mid = (lo + hi) / 2;
        *(path->keys[mid].seconds <= t ? &lo : &hi) = mid;
    }
    const path_key *a = &path->keys[lo];
    double h = path->legs ? a[1].seconds - a->seconds : 0;
    *share = h > 0 ? NOC_CLAMP((t - a->seconds) / h, 0, 1) : 0;
    return lo;
}

/* Share of leg i's parameter at which so much of its length is behind. */
static double parameter_at(const noc_camera_path *path, size_t i, double length) {
    const path_key *key = &path->keys[i];
    int lo = 0, hi = STEPS; /* the step that it ends in: the first whose end lies behind it */
    while (lo < hi) {
        int mid = (lo + hi) / 2;
        if (key->lengths[mid] < length)
            lo = mid + 1;
        else
            hi = mid;
    }
    if (lo == STEPS)
        return 1;
    double from = lo ? key->lengths[lo - 1] : 0, step = key->lengths[lo] - from, way = length - from;
    if (!(step > 0))
        return (double)lo / STEPS;
    /* speed changes within a step, too: once more by what that share of it really is */
    double share = way / step;
    place begin = on_leg(path, i, (double)lo / STEPS), there = on_leg(path, i, (lo + share) / STEPS);
    double gone = distance(&begin, &there);
    share = gone > 0 ? NOC_MIN(share * way / gone, 1) : share;
    return (lo + share) / STEPS;
}

static place place_at(const noc_camera_path *path, double t) {
    double share;
    size_t i = leg_at(path, t, &share);
    const path_key *a = &path->keys[i], *b = a + 1;
    if (!path->legs)
        return a->at;
    double h = b->seconds - a->seconds, u2 = share * share, u3 = u2 * share;
    double length =
        (b->start - a->start) * (3 * u2 - 2 * u3) + h * (a->speed * (u3 - 2 * u2 + share) + b->speed * (u3 - u2));
    return on_leg(path, i, parameter_at(path, i, length));
}

noc_status noc_camera_path_at(const noc_camera_path *path, double seconds, noc_camera *camera) {
    if (!path || !camera)
        return noc_null(NULL, __func__);
    place p = place_at(path, isfinite(seconds) ? time_on(path, seconds) : 0);
    noc_camera c = noc_camera_default();
    double sight = 0, up = 0;
    for (int k = 0; k < 3; k++) {
        c.eye[k] = p.v[EYE + k];
        c.target[k] = p.v[TARGET + k];
        c.up[k] = p.v[UP + k];
        sight += fabs(c.target[k] - c.eye[k]);
        up += fabs(c.up[k]);
    }
    if (!(up > 1e-6)) /* between opposite ones */
        memcpy(c.up, (double[3]){ 0, 0, 1 }, sizeof(c.up));
    for (int k = 0; k < 3 && !(sight > 1e-6); k++) /* where the eye meets its target */
        c.target[k] = c.eye[k] + path->keys[0].at.v[TARGET + k] - path->keys[0].at.v[EYE + k];
    c.fov_deg = NOC_CLAMP(2 * atan(exp(p.v[ZOOM] / path->zoom_scale)) * 180 / M_PI, 0.01, 179);
    *camera = c;
    return NOC_OK;
}

double noc_camera_path_hour(const noc_camera_path *path, double seconds) {
    const path_key *before = NULL, *after = NULL;
    if (!path)
        return -1;
    double t = isfinite(seconds) ? time_on(path, seconds) : 0;
    for (size_t i = 0; i <= path->legs && !after; i++) {
        const path_key *key = &path->keys[i];
        if (key->hour < 0)
            continue;
        if (key->seconds <= t)
            before = key;
        else
            after = key;
    }
    if (!before || !after)
        return before ? fmod(before->hour, 24) : after ? fmod(after->hour, 24) : -1;
    double share = (t - before->seconds) / (after->seconds - before->seconds);
    return fmod(before->hour + share * (after->hour - before->hour), 24);
}
