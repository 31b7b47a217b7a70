/* nocturne/map.h: what a map beside a picture shows: the scene as seen from above, its cars and their tracks. Lights
 * are in noc_scene_get_light. All of it may be asked for at any time from any thread, as what else only reads a scene.
 */
#ifndef NOCTURNE_MAP_H
#define NOCTURNE_MAP_H

#include <nocturne/scene.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A rectangle as seen straight from above, north (y) up. */
typedef struct noc_map_params {
    double min[2], max[2]; /* its corners, local metres */
    int width, height;     /* cells, 1..16384 each */
    double from;           /* m: height that one looks down from, as under a bridge; INFINITY: from over everything */
} noc_map_params;

#define NOC_MAP_NOTHING 255 /* class where nothing is below */

/* Casts a ray down the middle of each cell, row by row from the north, and tells what it meets: its height (local
 * metres; NAN: nothing), its class, and its object (for noc_scene_object_name; -1: nothing). Each array has width x
 * height entries, or is NULL. Where neighbours are of two objects, or of two classes, is an outline: that of a
 * building, of a road. cast is noc_view_cast, or what does the same. progress may be NULL; NOC_ERR_CANCELLED when it
 * cancels. NOC_ERR_ARGUMENT after reporting a rectangle that is none. */
NOC_API noc_status noc_scene_map(const noc_scene *scene, const noc_map_params *params, noc_cast_fn cast, void *user,
                                 const noc_progress *progress, float *height, uint8_t *cls, int *object);

typedef struct noc_car_info {
    int instance;    /* for noc_scene_set_transform */
    int track;       /* that it is on */
    double place[3]; /* on the ground between its axles, local metres, as published last */
    double heading;  /* radians from x (east) to y: where its front is */
} noc_car_info;

/* index is below noc_scene_info.cars; else NOC_ERR_ARGUMENT. Cars out of sight have their places all the same. */
NOC_API noc_status noc_scene_get_car(const noc_scene *scene, size_t index, noc_car_info *car);

/* A stop of a track: the line through a track's stops is what its cars drive. */
typedef struct noc_track_stop {
    double place[3]; /* local metres */
    double seconds;  /* from the track's beginning */
    bool begins;     /* a part begins here: no line leads to it from the stop before */
} noc_track_stop;

NOC_API size_t noc_scene_track_count(const noc_scene *scene);
/* The first `most` stops of a track; returns how many it has, 0 where there is no such track. */
NOC_API size_t noc_scene_get_track(const noc_scene *scene, size_t track, noc_track_stop *stops, size_t most);

#ifdef __cplusplus
}
#endif
#endif
