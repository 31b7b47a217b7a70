#include "viewer/inbox.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

void inbox_init(inbox *in) {
    pthread_condattr_t clock;
    *in = (inbox){ 0 };
    pthread_mutex_init(&in->mutex, NULL);
    pthread_condattr_init(&clock);
    pthread_condattr_setclock(&clock, CLOCK_MONOTONIC);
    pthread_cond_init(&in->changed, &clock);
    pthread_condattr_destroy(&clock);
}

static void drop(wire_message *message) {
    wire_free(message);
    free(message);
}

void inbox_finish(inbox *in) {
    for (int i = 0; i < in->count; i++)
        drop(in->waiting[i]);
    pthread_cond_destroy(&in->changed);
    pthread_mutex_destroy(&in->mutex);
}

/* Under the lock: into the last one, where both are inputs with the same keys. Of cameras the newest takes the place.
 */
static bool merge(inbox *in, wire_message *message) {
    wire_message *last = in->count ? in->waiting[in->count - 1] : NULL;
    if (last && last->kind == WIRE_CAMERA && message->kind == WIRE_CAMERA) {
        wire_message overtaken = *last;
        *last = *message;
        *message = overtaken;
        return true;
    }
    if (!last || last->kind != WIRE_INPUT || message->kind != WIRE_INPUT || last->input.keys != message->input.keys)
        return false;
    wire_input *to = &last->input;
    const wire_input *from = &message->input;
    to->n = from->n;
    to->seconds += from->seconds;
    for (int k = 0; k < 2; k++) {
        to->turn[k] += from->turn[k];
        to->pan[k] += from->pan[k];
    }
    to->zoom += from->zoom;
    to->has_at = to->has_at || from->has_at;
    if (from->has_at)
        memcpy(to->at, from->at, sizeof(to->at));
    return true;
}

bool inbox_put(inbox *in, wire_message *message) {
    pthread_mutex_lock(&in->mutex);
    if (message->kind == WIRE_WATCH)
        in->hidden = !message->watch;
    bool done = message->kind == WIRE_WATCH || message->kind == WIRE_ACK || merge(in, message);
    wire_message *kept = !done && in->count < INBOX_MOST ? malloc(sizeof(*kept)) : NULL;
    if (kept) {
        *kept = *message;
        in->waiting[in->count++] = kept;
    }
    in->wakes++;
    pthread_cond_broadcast(&in->changed);
    pthread_mutex_unlock(&in->mutex);
    if (!kept)
        wire_free(message);
    return done || kept;
}

wire_message *inbox_get(inbox *in) {
    pthread_mutex_lock(&in->mutex);
    wire_message *first = in->count ? in->waiting[0] : NULL;
    if (first)
        memmove(in->waiting, in->waiting + 1, sizeof(*in->waiting) * (size_t)--in->count);
    pthread_mutex_unlock(&in->mutex);
    return first;
}

bool inbox_hurries(inbox *in) {
    pthread_mutex_lock(&in->mutex);
    bool hurries = in->ended || in->hidden || in->count > 0;
    pthread_mutex_unlock(&in->mutex);
    return hurries;
}

void inbox_end(inbox *in) {
    pthread_mutex_lock(&in->mutex);
    in->ended = true;
    pthread_mutex_unlock(&in->mutex);
    inbox_wake(in);
}

bool inbox_ended(inbox *in) {
    pthread_mutex_lock(&in->mutex);
    bool ended = in->ended;
    pthread_mutex_unlock(&in->mutex);
    return ended;
}

bool inbox_hidden(inbox *in) {
    pthread_mutex_lock(&in->mutex);
    bool hidden = in->hidden;
    pthread_mutex_unlock(&in->mutex);
    return hidden;
}

void inbox_wake(inbox *in) {
    pthread_mutex_lock(&in->mutex);
    in->wakes++;
    pthread_cond_broadcast(&in->changed);
    pthread_mutex_unlock(&in->mutex);
}

unsigned inbox_wait(inbox *in, unsigned wakes, double seconds) {
    struct timespec until;
    clock_gettime(CLOCK_MONOTONIC, &until);
    double ns = (double)until.tv_nsec + 1e9 * seconds;
    until.tv_sec += (time_t)(ns / 1e9);
    until.tv_nsec = (long)(ns - 1e9 * (double)(time_t)(ns / 1e9));
    pthread_mutex_lock(&in->mutex);
    while (!in->count && !in->ended && in->wakes == wakes && !pthread_cond_timedwait(&in->changed, &in->mutex, &until))
        continue;
    unsigned now = in->wakes;
    pthread_mutex_unlock(&in->mutex);
    return now;
}
