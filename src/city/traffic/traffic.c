/* Cars along tracks. */
#include "city/traffic/traffic.h"
#include "city/windows/windows.h"

#include <math.h>

#define TRACK_SPEED 40.0 /* km/h, of a track that tells no times, where the user says none */
#define LATEST 1e20      /* s: what says a later time says none */
#define FASTEST 300.0    /* km/h: what is faster between two points of a track is a jump */

struct city_traffic {
    noc_scene *scene;
    const noc_traffic_params *params;
    route_maker route;
    traffic_models models; /* empty: those of ours, once there is a car */
};

city_traffic *city_traffic_create(noc_scene *scene, const noc_traffic_params *params) {
    city_traffic *t = noc_calloc(1, sizeof(*t));
    if (!t) {
        noc_scene_out_of_memory(scene);
        return NULL;
    }
    *t = (city_traffic){ .scene = scene, .params = params, .route = { .scene = scene } };
    scene->time = params->time;
    return t;
}

void city_traffic_destroy(city_traffic *t) {
    if (t) {
        route_free(&t->route);
        array_free(&t->models.of);
    }
    free(t);
}

uint64_t traffic_hash(const char *id, uint32_t seed) { return city_window_hash(noc_hash_text(id), seed); }

noc_status city_traffic_body(city_traffic *t, const noc_scene *from, const char *name) {
    return traffic_own_models(t->scene, from, name, t->params, &t->models);
}

/* By a number of 0..1. */
static const traffic_model *choose(const traffic_models *models, double number) {
    double all = 0;
    size_t i = 0;
    for (size_t k = 0; k < models->of.len; k++)
        all += models->of.data[k].share;
    for (number *= all; i + 1 < models->of.len && number >= models->of.data[i].share; i++)
        number -= models->of.data[i].share;
    return &models->of.data[i];
}

bool traffic_add_car(city_traffic *t, int route, uint64_t hash, double start) {
    if (!t->models.of.len && !traffic_our_models(t->scene, t->params, &t->models))
        return false;
    const traffic_model *m = choose(&t->models, city_window_number(hash, 1));
    return noc_scene_add_car(t->scene, m->model, route, start, m->axles);
}

noc_status traffic_failed(const city_traffic *t) { return t->scene->no_memory ? NOC_ERR_MEMORY : NOC_ERR_ARGUMENT; }

noc_scene *traffic_scene(const city_traffic *t) { return t->scene; }

const noc_traffic_params *traffic_params(const city_traffic *t) { return t->params; }

/* ---- tracks ---- */

/* Seconds from point i - 1 to i of the track; negative: a jump. */
static double seconds_to(const geo_track *track, size_t i, bool timed, double speed) {
    const double *a = track->xyz + 3 * (i - 1), *b = a + 3;
    double length = hypot(b[0] - a[0], b[1] - a[1]);
    if (!timed)
        return length / (speed / 3.6);
    double seconds = track->seconds[i] - track->seconds[i - 1];
    return length > seconds * FASTEST / 3.6 ? -1 : seconds;
}

/* Do its times go forward everywhere? */
static bool is_timed(const geo_track *track) {
    bool timed = track->seconds != NULL;
    for (size_t part = 0, first = 0; timed && part < track->part_count; first += track->part_size[part++])
        for (size_t i = 0; i < track->part_size[part]; i++)
            timed = timed && fabs(track->seconds[first + i]) <= LATEST &&
                    (!i || track->seconds[first + i] >= track->seconds[first + i - 1]);
    return timed;
}

static void make_route(city_traffic *t, const geo_track *track, bool timed, size_t *jumps, size_t *outside) {
    double speed = t->params->speed > 0 ? t->params->speed : TRACK_SPEED;
    size_t first = 0;
    route_clear(&t->route);
    *jumps = *outside = 0;
    for (size_t part = 0; part < track->part_count; first += track->part_size[part++]) {
        for (size_t i = 0; i < track->part_size[part]; i++) {
            const double *p = track->xyz + 3 * (first + i);
            bool inside = route_inside(&t->route, p);
            double seconds = i ? seconds_to(track, first + i, timed, speed) : 0;
            *outside += !inside;
            *jumps += inside && seconds < 0;
            if (!inside || seconds < 0)
                route_end_leg(&t->route);
            if (inside)
                route_point(&t->route, p, NOC_MAX(seconds, 0));
        }
        route_end_leg(&t->route);
    }
}

noc_status city_traffic_follow(city_traffic *t, const geo_track *track, geo_issues *issues, size_t *cars) {
    size_t jumps, outside;
    bool timed = is_timed(track);
    *cars = 0;
    if (track->seconds && !timed)
        geo_issue(issues, GEO_GUESSED, "track whose times do not go forward, driven at one speed", track->id);
    make_route(t, track, timed, &jumps, &outside);
    if (t->route.refused)
        return noc_scene_out_of_memory(t->scene);
    if (t->route.too_long) {
        geo_issue(issues, GEO_SKIPPED, "track too long to drive, or one too many", track->id);
        return NOC_OK;
    }
    for (size_t i = 0; i < jumps; i++)
        geo_issue(issues, GEO_GUESSED, "points of a track too far apart for its times, where a car jumps", track->id);
    if (!t->route.stops.len) {
        geo_issue(issues, GEO_SKIPPED,
                  t->route.groundless ? "track with no ground under it"
                  : outside           ? "track outside of the city"
                                      : "track too short to drive",
                  track->id);
        return NOC_OK;
    }
    int route = noc_scene_add_route(t->scene, t->route.stops.data, t->route.stops.len);
    if (route < 0 || !traffic_add_car(t, route, traffic_hash(track->id, t->params->seed), 0))
        return traffic_failed(t);
    *cars = 1;
    return NOC_OK;
}
