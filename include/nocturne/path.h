/* nocturne/path.h: cameras on their way: a smooth path through cameras that are given, for animations and for who looks
 * at a scene.
 *
 * A path is a centripetal Catmull-Rom curve (Yuksel, Schaefer and Keyser 2011, "Parameterization and applications of
 * Catmull-Rom curves") through its keys, in which eye, target and zoom are one point of seven numbers: it goes through
 * each key and has no cusps. Where a camera is on it at a time is a monotone cubic (Fritsch and Butland 1984, "A method
 * for constructing local monotone piecewise cubic interpolants") through the keys' seconds, so that it never turns
 * back. Where keys tell no seconds, eye and target together go at one speed. Two equal keys are a rest. */
#ifndef NOCTURNE_PATH_H
#define NOCTURNE_PATH_H

#include <nocturne/import.h>
#include <nocturne/scene.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct noc_camera_path noc_camera_path;

#define NOC_PATH_MOST_KEYS 10000
#define NOC_PATH_MOST_SECONDS 1e6

/* What a path goes through. */
typedef struct noc_camera_key {
    noc_camera camera;
    double seconds; /* when, from the path's start; rising from key to key; negative: not told */
    double hour;    /* of the day there, 0..24 (noc_window_params.hour); negative: not told */
} noc_camera_key;

/* A path through 1 to NOC_PATH_MOST_KEYS keys. All of them tell their seconds, or none does; the first may leave them
 * out, and is at 0 then. A loop comes back from its last key to its first, at the mean speed of the rest. seconds: what
 * all of it takes, to which seconds of keys are stretched; 0: what they say, and 1 where they say nothing.
 * NOC_ERR_ARGUMENT, NOC_ERR_MEMORY after reporting it: *path is NULL then, else the caller's. */
NOC_API noc_status noc_camera_path_create(const noc_camera_key *keys, size_t count, bool loop, double seconds,
                                          noc_log *log, noc_camera_path **path);
/* Loops of one turn, counter-clockwise as seen from above: an orbit turns the camera about the vertical through its
 * target, a pan about that through its eye. The rest as above. */
NOC_API noc_status noc_camera_path_orbit(const noc_camera *camera, double seconds, noc_log *log,
                                         noc_camera_path **path);
NOC_API noc_status noc_camera_path_pan(const noc_camera *camera, double seconds, noc_log *log, noc_camera_path **path);
/* The same orbit in a scene: where something stands up to its height, within 10 m of its way, the eye rises in time and
 * flies 8 m over it. */
NOC_API noc_status noc_scene_orbit(const noc_scene *scene, const noc_camera *camera, double seconds,
                                   noc_camera_path **path);
NOC_API void noc_camera_path_destroy(noc_camera_path *path); /* NULL is allowed */

NOC_API double noc_camera_path_seconds(const noc_camera_path *path); /* what it takes; 0 of NULL */
NOC_API bool noc_camera_path_loops(const noc_camera_path *path);
/* The camera at that time, which may be any number: a loop goes on for ever, another path rests at its ends. */
NOC_API noc_status noc_camera_path_at(const noc_camera_path *path, double seconds, noc_camera *camera);
/* The hour of the day, 0..24: even steps between keys that tell one, where the smaller of two that follow each other is
 * of the next day; before the first and after the last of them theirs. Negative where none does. */
NOC_API double noc_camera_path_hour(const noc_camera_path *path, double seconds);

/* A key as people say it. */
typedef struct noc_path_key {
    noc_camera_params camera;
    double seconds, hour; /* as in noc_camera_key */
} noc_path_key;

#define noc_path_key_default()                                                                                         \
    ((noc_path_key){ .camera = { NOC_CAMERA_DEFAULTS(NOC_DEFAULT_IN_C) }, .seconds = -1, .hour = -1 })

/* The path through these keys, each placed by noc_scene_place_camera; the rest as noc_camera_path_create has it. *path
 * is NULL after an error, else the caller's. */
NOC_API noc_status noc_scene_place_path(const noc_scene *scene, const noc_path_key *keys, size_t count, bool loop,
                                        double seconds, double aspect, noc_camera_path **path);

#ifdef __cplusplus
}
#endif
#endif
