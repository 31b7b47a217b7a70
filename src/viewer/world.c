/* The world's thread: it loads, then publishes what is set, and drives the cars. */
#include "viewer/world_parts.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define STEP (1. / 30) /* s between two moves of the cars, at least */
#define UNSEEN 1.0     /* s: cars stand when nobody has looked for so long */

static double now_seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* ---- loading ---- */

static bool progress(void *user, const char *what, double done) {
    viewer_world *w = user;
    pthread_mutex_lock(&w->mutex);
    snprintf(w->what, sizeof(w->what), "%s", what);
    w->done = done;
    bool ended = w->ended;
    pthread_mutex_unlock(&w->mutex);
    return !ended;
}

static noc_status load(viewer_world *w) {
    noc_progress told = { progress, w };
    w->device = noc_device_create(&w->source->device, w->log);
    noc_status status = w->device ? w->source->load(w->source->user, w->scene, &told, &w->report) : NOC_ERR_MEMORY;
    return status ? status : world_begin(w);
}

/* ---- edits ---- */

static void wait_until(viewer_world *w, double end) {
    struct timespec at = { (time_t)end, (long)(1e9 * (end - (double)(time_t)end)) };
    pthread_cond_timedwait(&w->changed, &w->mutex, &at);
}

/* Moves the clock of the cars on; seconds until it is to be done again. */
static double drive(viewer_world *w, double *last) {
    double now = now_seconds(), passed = now - *last;
    if (!world_drives(w) || now - w->looked > UNSEEN) {
        *last = now;
        return -1;
    }
    if (passed < STEP)
        return STEP - passed;
    double time = w->import.cars.time + passed * w->own.pace;
    *last = now;
    w->import.cars.time = time < 1e9 ? time : -1e9;
    w->dirty |= DIRTY_TIME;
    return STEP;
}

/* Frames that are being rendered are waited for without the mutex: what is set meanwhile waits for the next time. */
static void publish(viewer_world *w) {
    noc_status status = world_stage(w);
    w->busy = true;
    pthread_mutex_unlock(&w->mutex);
    status = status ? status : noc_scene_commit(w->scene);
    pthread_mutex_lock(&w->mutex);
    w->busy = false;
    w->published++;
    w->version += !status;
    pthread_cond_broadcast(&w->changed);
}

static void edit(viewer_world *w) {
    double last = now_seconds();
    while (!w->ended) {
        double wait = drive(w, &last);
        if (w->dirty)
            publish(w);
        else if (wait >= 0)
            wait_until(w, now_seconds() + wait);
        else
            pthread_cond_wait(&w->changed, &w->mutex);
    }
}

static void *run(void *user) {
    viewer_world *w = user;
    noc_status status = load(w);
    pthread_mutex_lock(&w->mutex);
    w->over = true;
    w->loaded = !status;
    if (status)
        snprintf(w->failed, sizeof(w->failed), "%s", noc_log_last_error(w->log));
    if (status && !*w->failed)
        snprintf(w->failed, sizeof(w->failed), "%s", noc_status_text(status));
    w->version++;
    pthread_cond_broadcast(&w->changed);
    if (w->loaded)
        edit(w);
    pthread_mutex_unlock(&w->mutex);
    return NULL;
}

/* ---- beginning and end ---- */

viewer_world *world_create(const viewer_source *source, noc_log *log) {
    viewer_world *w = calloc(1, sizeof(*w));
    if (!w)
        return NULL;
    pthread_condattr_t clock;
    pthread_condattr_init(&clock);
    pthread_condattr_setclock(&clock, CLOCK_MONOTONIC);
    pthread_mutex_init(&w->mutex, NULL);
    pthread_cond_init(&w->changed, &clock);
    pthread_condattr_destroy(&clock);
    w->source = source;
    w->log = log;
    w->scene = noc_scene_create(log);
    w->started = w->scene && !pthread_create(&w->thread, NULL, run, w);
    if (w->started)
        return w;
    world_destroy(w);
    return NULL;
}

void world_destroy(viewer_world *w) {
    if (!w)
        return;
    pthread_mutex_lock(&w->mutex);
    w->ended = true;
    pthread_cond_broadcast(&w->changed);
    pthread_mutex_unlock(&w->mutex);
    if (w->started)
        pthread_join(w->thread, NULL);
    world_finish(w);
    noc_report_destroy(w->report);
    noc_scene_destroy(w->scene);
    noc_device_destroy(w->device);
    pthread_cond_destroy(&w->changed);
    pthread_mutex_destroy(&w->mutex);
    free(w);
}

/* ---- what is asked ---- */

bool world_loading(viewer_world *w, char *what, size_t size, double *done) {
    pthread_mutex_lock(&w->mutex);
    snprintf(what, size, "%s", *w->what ? w->what : "loading");
    *done = w->done;
    bool loading = !w->over;
    pthread_mutex_unlock(&w->mutex);
    return loading;
}

static bool is_loaded(viewer_world *w) {
    pthread_mutex_lock(&w->mutex);
    bool loaded = w->loaded;
    pthread_mutex_unlock(&w->mutex);
    return loaded;
}

const char *world_failed(viewer_world *w) {
    pthread_mutex_lock(&w->mutex);
    const char *failed = w->over && !w->loaded ? w->failed : NULL;
    pthread_mutex_unlock(&w->mutex);
    return failed;
}

noc_scene *world_scene(viewer_world *w) { return is_loaded(w) ? w->scene : NULL; }
noc_device *world_device(viewer_world *w) { return is_loaded(w) ? w->device : NULL; }
const noc_report *world_report(viewer_world *w) { return is_loaded(w) ? w->report : NULL; }

void world_look(viewer_world *w) {
    double now = now_seconds();
    pthread_mutex_lock(&w->mutex);
    if (now - w->looked > UNSEEN)
        pthread_cond_broadcast(&w->changed);
    w->looked = now;
    pthread_mutex_unlock(&w->mutex);
}

uint64_t world_commits(const viewer_world *w) { return w->published + w->busy + (w->dirty != 0); }

void world_settle(viewer_world *w) {
    pthread_mutex_lock(&w->mutex);
    uint64_t last = world_commits(w); /* cars that drive set more meanwhile */
    while (w->loaded && !w->ended && w->published < last)
        pthread_cond_wait(&w->changed, &w->mutex);
    pthread_mutex_unlock(&w->mutex);
}

uint64_t world_version(viewer_world *w) {
    pthread_mutex_lock(&w->mutex);
    uint64_t version = w->version;
    pthread_mutex_unlock(&w->mutex);
    return version;
}

uint64_t world_published(viewer_world *w) {
    pthread_mutex_lock(&w->mutex);
    uint64_t published = w->published;
    pthread_mutex_unlock(&w->mutex);
    return published;
}

uint64_t world_told(viewer_world *w) {
    pthread_mutex_lock(&w->mutex);
    uint64_t told = w->told;
    pthread_mutex_unlock(&w->mutex);
    return told;
}
