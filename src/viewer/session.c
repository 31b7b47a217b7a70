#include "viewer/session_parts.h"

#include <stdlib.h>
#include <time.h>

#define MOST_DOING 0.1 /* s of messages before the next picture */

double session_now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void tell_loading(session *s, const char *what, double done) {
    json_t *m = wire_begin("loading");
    json_object_set_new(m, "what", wire_text(what));
    json_object_set_new(m, "done", json_real(done));
    outbox_text(s->box, OUTBOX_LOADING, 0, wire_end(m));
}

/* Until the scene is there. false: it will not be. */
static bool wait_for_world(session *s) {
    unsigned wakes = 0;
    char what[128];
    double done;
    while (!inbox_ended(&s->in) && world_loading(s->setup->world, what, sizeof(what), &done)) {
        tell_loading(s, what, done);
        wakes = inbox_wait(&s->in, wakes, 0.25);
    }
    return !inbox_ended(&s->in) && !world_failed(s->setup->world);
}

/* Those of a client that has left, and of a program that ends, are not done any more. */
static void do_all(session *s) {
    double start = session_now();
    s->behind = false;
    for (wire_message *message; !inbox_ended(&s->in) && !s->behind && (message = inbox_get(&s->in));) {
        session_do(s, message);
        wire_free(message);
        free(message);
        s->behind = session_now() - start > MOST_DOING;
    }
}

static void serve(session *s) {
    look first = look_default(s->setup->source);
    unsigned wakes = 0;
    tell_loading(s, "looking for the first view", 0);
    if (panes_init(&s->panes, s->setup->world, s->box, s->setup->log, &first) ||
        mover_init(&s->mover, s->setup->world, s->setup->source, 16.0 / 9)) {
        session_note(s, "error", "there is no memory for a view");
        panes_finish(&s->panes);
        return;
    }
    s->version = world_version(s->setup->world);
    s->told = world_told(s->setup->world);
    session_tell_welcome(s);
    while (!inbox_ended(&s->in)) {
        do_all(s);
        if (s->told_less)
            session_tell_state(s);
        s->told_less = false;
        double wait = session_step(s);
        wakes = wait > 0 ? inbox_wait(&s->in, wakes, wait) : wakes;
    }
    asker_destroy(s->asker);
    asker_destroy(s->namer);
    mover_finish(&s->mover);
    panes_finish(&s->panes);
}

static void *run(void *user) {
    session *s = user;
    if (wait_for_world(s))
        serve(s);
    else if (world_failed(s->setup->world))
        session_note(s, "error", "the city could not be loaded");
    atomic_store(&s->over, true);
    return NULL;
}

session *session_create(const session_setup *setup, outbox *box) {
    session *s = calloc(1, sizeof(*s));
    if (!s)
        return NULL;
    s->setup = setup;
    s->box = box;
    s->pace.level = PACE_START;
    inbox_init(&s->in);
    s->started = !pthread_create(&s->thread, NULL, run, s);
    if (s->started)
        return s;
    inbox_finish(&s->in);
    free(s);
    return NULL;
}

bool session_take(session *s, wire_message *message) {
    if (message->kind == WIRE_ACK)
        outbox_shown(s->box, message->ack.pane, message->ack.n);
    return inbox_put(&s->in, message);
}

void session_end(session *s) { inbox_end(&s->in); }
bool session_ended(const session *s) { return atomic_load(&s->over); }

void session_join(session *s) {
    session_end(s);
    if (!s->joined)
        pthread_join(s->thread, NULL);
    s->joined = true;
}

void session_destroy(session *s) {
    if (!s)
        return;
    session_join(s);
    inbox_finish(&s->in);
    free(s);
}
