/* A small city for tests of the viewer's state: a house with windows, lamps by a rule, ground, and a car on a track. */
#ifndef NOC_TEST_STATE_CITY_H
#define NOC_TEST_STATE_CITY_H

#include "../test.h"

#include "viewer/out.h"

#include <time.h>

typedef struct state_city {
    char gml[400], track[400];
    const char *inputs[2];
    noc_import_params import;
    noc_builtin_params builtin;
    viewer_source source;
    viewer_world *world;
    noc_log *log;
} state_city;

static char city_folder[] = "/tmp/noc-viewer-XXXXXX";
static const char *city_source;

static noc_status load_city(void *user, noc_scene *scene, const noc_progress *progress, noc_report **report) {
    state_city *c = user;
    noc_import_params p = c->import;
    p.wet = false; /* rain is the world's */
    p.progress = *progress;
    return noc_scene_load(scene, c->inputs, c->source.said_count, &p, report);
}

static inline bool make_folder(void) {
    city_source = getenv("NOC_SOURCE");
    return city_source && mkdtemp(city_folder);
}

/* Where NOC_SOURCE is not told there is nothing to load. */
static inline void set_city(state_city *c, bool builtin) {
    static const char gpx[] =
        "<?xml version='1.0'?><gpx version='1.1' xmlns='http://www.topografix.com/GPX/1/1'><trk><name>a</name><trkseg>"
        "<trkpt lat='48.754461' lon='11.421681'><time>2026-11-22T22:00:00Z</time></trkpt>"
        "<trkpt lat='48.754450' lon='11.422224'><time>2026-11-22T22:00:10Z</time></trkpt></trkseg></trk></gpx>";
    *c = (state_city){ .import = noc_import_default_params() };
    c->log = noc_log_create(NULL);
    snprintf(c->gml, sizeof(c->gml), "%s/tests/cli/city.gml", city_source);
    snprintf(c->track, sizeof(c->track), "%s/a track's.gpx", city_folder);
    FILE *f = fopen(c->track, "w");
    assert_non_null(f);
    fputs(gpx, f);
    fclose(f);
    c->inputs[0] = builtin ? "builtin:city" : c->gml;
    c->inputs[1] = c->track;
    c->source = (viewer_source){ .said = c->inputs,
                                 .said_count = builtin ? 1 : 2,
                                 .load = load_city,
                                 .user = c,
                                 .import = &c->import,
                                 .camera = noc_camera_default_params(),
                                 .render = noc_render_default_params(),
                                 .display = noc_display_default_params(),
                                 .device.threads = 2 };
    noc_render_use_preset(&c->source.render, NOC_PRESET_INTERACTIVE);
}

static inline void start_city(state_city *c) {
    char what[128];
    double done;
    c->world = world_create(&c->source, c->log);
    assert_non_null(c->world);
    while (world_loading(c->world, what, sizeof(what), &done))
        nanosleep(&(struct timespec){ .tv_nsec = 5000000 }, NULL);
    if (world_failed(c->world))
        fail_msg("%s", world_failed(c->world));
}

static inline void end_city(state_city *c) {
    world_destroy(c->world);
    noc_log_destroy(c->log);
}

static inline void set_world(state_city *c, const char *name, const char *value) {
    char why[300] = "";
    if (!world_set(c->world, name, value, why, sizeof(why)))
        fail_msg("%s %s: %s", name, value, why);
}

static const noc_camera city_camera = {
    .eye = { -12.5, -17.25, 5.1 }, .target = { 6, 3, 2 }, .up = { 0, 0, 1 }, .fov_deg = 61
};

#endif
