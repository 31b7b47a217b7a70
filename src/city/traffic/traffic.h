/* traffic: cars along tracks. A car is an instance of a model (body.c, own_body.c), which takes a route (route.c).
 * Which model it is, and where on its way, is drawn from a hash of ids. */
#ifndef NOC_CITY_TRAFFIC_H
#define NOC_CITY_TRAFFIC_H

#include "geo/geo.h"
#include "scene/scene.h"
#include <nocturne/import.h>

typedef struct city_traffic city_traffic;
/* scene: with all that cars stand on, not committed yet. NULL after reporting: no memory. */
city_traffic *city_traffic_create(noc_scene *scene, const noc_traffic_params *params);
void city_traffic_destroy(city_traffic *traffic);
/* A body of the user's for cars, in place of ours or beside others of theirs: what its file holds, z up, its front
 * along -y. Before the first car. */
noc_status city_traffic_body(city_traffic *traffic, const noc_scene *from, const char *name);
/* A car along the track, whose points are local metres, from its beginning on at time 0. *cars: 0 where the track
 * cannot be driven, which goes to issues. */
noc_status city_traffic_follow(city_traffic *traffic, const geo_track *track, geo_issues *issues, size_t *cars);

/* Cars along those of the roads that cars drive on; tunnels are left out. Coordinates are local metres. */
noc_status city_traffic_roads(city_traffic *traffic, const geo_road *roads, size_t count, const noc_progress *progress,
                              size_t *cars);

/* ---- traffic.c, for lanes.c ---- */

noc_scene *traffic_scene(const city_traffic *traffic);
const noc_traffic_params *traffic_params(const city_traffic *traffic);
uint64_t traffic_hash(const char *id, uint32_t seed);
/* Its model is drawn from the hash. false after reporting. */
bool traffic_add_car(city_traffic *traffic, int route, uint64_t hash, double start);
noc_status traffic_failed(const city_traffic *traffic); /* the status of that */

/* ---- route.c ---- */

typedef struct route_maker {
    const noc_scene *scene;
    NOC_ARRAY(noc_scene_stop) stops;
    size_t made;       /* stops of all routes */
    size_t leg;        /* first stop of the leg that is being made */
    double seconds;    /* when its last stop is reached */
    double xy[2];      /* of its last point, not rounded */
    double along;      /* m of it */
    bool bridge;       /* what comes does not lie on the ground: on a deck, or straight from where it left it */
    size_t groundless; /* legs that were dropped, for there is no ground under them */
    bool too_long;     /* it has more stops than are kept, and some are missing */
    bool refused;      /* memory was; stays set */
} route_maker;

void route_clear(route_maker *m);
/* On to the next point of the leg, which is reached so many seconds after the last one; or its first. Stops between lie
 * on the ground. */
void route_point(route_maker *m, const double xy[2], double seconds);
/* Ends the leg: what is too short to drive, or without a ground, is dropped, and takes no time. */
void route_end_leg(route_maker *m);
bool route_inside(const route_maker *m, const double xy[2]); /* the city's extent? */
void route_free(route_maker *m);

/* ---- models of cars ---- */

typedef struct traffic_model {
    int model;    /* of the scene */
    double share; /* of the cars; those of all models together need not be 1 */
    double axles; /* m between them */
} traffic_model;

typedef struct traffic_models {
    NOC_ARRAY(traffic_model) of;
} traffic_models;

/* Bodies of ours (body.c), behind those that are there. false after reporting. */
bool traffic_our_models(noc_scene *scene, const noc_traffic_params *params, traffic_models *models);
/* The user's (own_body.c), from a scene whose z is up and whose front looks along -y. name is of messages. */
noc_status traffic_own_models(noc_scene *scene, const noc_scene *from, const char *name,
                              const noc_traffic_params *params, traffic_models *models);

/* ---- lamps.c ---- */

#define TRAFFIC_LAMP_RADIUS 0.06 /* m */
#define TRAFFIC_HALOGEN 3200.0   /* K */
#define TRAFFIC_LED 5600.0       /* K */

/* Where the body's surface lies behind the middle of each lamp. */
typedef struct traffic_lamp_places {
    double head[2][3], tail[2][3];
} traffic_lamp_places;

int traffic_beam(noc_scene *scene, noc_driving_side side); /* its profile's number, 0 after reporting */
/* Two headlamps, two tail lamps. false after reporting. */
bool traffic_lamps(noc_scene *scene, int model, const traffic_lamp_places *at, const noc_traffic_params *params,
                   int beam, double kelvin);

#endif
