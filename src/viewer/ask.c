#include "viewer/ask_parts.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- answers ---- */

json_t *ask_begin(const question *q, double done) {
    json_t *m = wire_begin("answer");
    json_object_set_new(m, "id", json_integer((json_int_t)q->id));
    json_object_set_new(m, "done", json_real(done));
    return m;
}

void ask_send(asker *a, const question *q, json_t *answer) {
    outbox_text(a->box, OUTBOX_ANSWER, q->id, wire_end(answer));
}

void ask_refuse(asker *a, const question *q, const char *why) {
    json_t *m = ask_begin(q, 1);
    json_object_set_new(m, "refused", wire_text(why));
    ask_send(a, q, m);
}

bool ask_stopped(const asker *a) { return atomic_load(&a->stopped); }

json_t *ask_number(double value) { return isfinite(value) ? json_real(value) : json_null(); }

json_t *ask_place(const double place[3]) { return json_pack("[fff]", place[0], place[1], place[2]); }

json_t *ask_crs(const asker *a, const double place[3]) {
    noc_scene_info info;
    double there[3] = { place[0], place[1], place[2] };
    noc_scene_get_info(world_scene(a->world), &info);
    if (!*info.given_crs || noc_scene_from_local(world_scene(a->world), NULL, there))
        return NULL;
    json_t *crs = json_object();
    json_object_set_new(crs, "name", wire_text(info.given_crs));
    json_object_set_new(crs, "place", ask_place(there));
    return crs;
}

void ask_keep(asker *a, uint32_t id, char *csv) {
    pthread_mutex_lock(&a->mutex);
    int at = a->next;
    for (int i = 0; i < ASK_KEPT; i++)
        if (a->kept[i].csv && a->kept[i].id == id)
            at = i;
    a->next = at == a->next ? (a->next + 1) % ASK_KEPT : a->next;
    free(a->kept[at].csv);
    a->kept[at].id = id;
    a->kept[at].csv = csv;
    pthread_mutex_unlock(&a->mutex);
}

char *asker_csv(asker *a, uint32_t id) {
    char *csv = NULL;
    pthread_mutex_lock(&a->mutex);
    for (int i = 0; i < ASK_KEPT && !csv; i++)
        if (a->kept[i].csv && a->kept[i].id == id)
            csv = strdup(a->kept[i].csv);
    pthread_mutex_unlock(&a->mutex);
    return csv;
}

/* ---- the thread ---- */

static void on_log(void *user, noc_log_level level, const char *text) {
    asker *a = user;
    if (level == NOC_LOG_ERROR)
        snprintf(a->wrong, sizeof(a->wrong), "%s", text);
}

static void answer(asker *a, const question *q) {
    *a->wrong = 0;
    world_settle(a->world); /* its command says all that was set */
    if (!a->ask_view && !(a->ask_view = noc_view_create(world_device(a->world), world_scene(a->world)))) {
        ask_refuse(a, q, "there is no memory for it");
        return;
    }
    switch (q->ask.what) {
    case WIRE_PIXEL: ask_pixel(a, q); break;
    case WIRE_REGION: ask_region(a, q); break;
    case WIRE_LAMP: ask_lamp(a, q); break;
    case WIRE_LIGHTS: ask_lights(a, q); break;
    case WIRE_ALIGN: ask_align(a, q); break;
    case WIRE_FIND: ask_find(a, q); break;
    case WIRE_NAME: ask_name(a, q); break;
    }
}

/* The next question; NULL: it is to end. */
static question *wait_for_question(asker *a) {
    pthread_mutex_lock(&a->mutex);
    a->busy = false;
    while (!a->count && !a->ended)
        pthread_cond_wait(&a->changed, &a->mutex);
    question *q = a->ended ? NULL : a->waiting[0];
    if (q) {
        memmove(a->waiting, a->waiting + 1, sizeof(*a->waiting) * (size_t)--a->count);
        a->busy = true;
        a->now = q->id;
        atomic_store(&a->stopped, false);
    }
    pthread_mutex_unlock(&a->mutex);
    return q;
}

static void *run(void *user) {
    asker *a = user;
    for (question *q; (q = wait_for_question(a)); free(q))
        answer(a, q);
    noc_view_destroy(a->ask_view);
    return NULL;
}

asker *asker_create(const viewer_source *source, viewer_world *world, outbox *box, inbox *in) {
    asker *a = calloc(1, sizeof(*a));
    if (!a)
        return NULL;
    a->source = source;
    a->world = world;
    a->box = box;
    a->in = in;
    a->log = noc_log_create(&(noc_log_params){ NOC_LOG_ERROR, on_log, a });
    pthread_mutex_init(&a->mutex, NULL);
    pthread_cond_init(&a->changed, NULL);
    if (a->log && !pthread_create(&a->thread, NULL, run, a))
        return a;
    noc_log_destroy(a->log);
    pthread_cond_destroy(&a->changed);
    pthread_mutex_destroy(&a->mutex);
    free(a);
    return NULL;
}

void asker_destroy(asker *a) {
    if (!a)
        return;
    pthread_mutex_lock(&a->mutex);
    a->ended = true;
    atomic_store(&a->stopped, true);
    pthread_cond_signal(&a->changed);
    pthread_mutex_unlock(&a->mutex);
    pthread_join(a->thread, NULL);
    for (int i = 0; i < a->count; i++)
        free(a->waiting[i]);
    for (int i = 0; i < ASK_KEPT; i++)
        free(a->kept[i].csv);
    noc_log_destroy(a->log);
    pthread_cond_destroy(&a->changed);
    pthread_mutex_destroy(&a->mutex);
    free(a);
}

void asker_ask(asker *a, const wire_ask *ask, const ask_view *view) {
    const char *text = ask->object ? ask->object : ask->street ? ask->street : ask->text ? ask->text : "";
    size_t size = strlen(text) + 1;
    question *q = calloc(1, sizeof(*q) + size), *gone = NULL;
    if (!q)
        return;
    q->id = ask->id;
    q->ask = *ask;
    q->view = *view;
    memcpy(q->text, text, size);
    q->ask.object = ask->object ? q->text : NULL;
    q->ask.street = ask->street ? q->text : NULL;
    q->ask.text = ask->text ? q->text : NULL;
    pthread_mutex_lock(&a->mutex);
    if (a->count == ASK_WAITING) {
        gone = a->waiting[0];
        memmove(a->waiting, a->waiting + 1, sizeof(*a->waiting) * (size_t)--a->count);
    }
    a->waiting[a->count++] = q;
    pthread_cond_signal(&a->changed);
    pthread_mutex_unlock(&a->mutex);
    if (gone)
        ask_refuse(a, gone, "too many questions wait");
    free(gone);
}

void asker_cancel(asker *a, uint32_t id) {
    question *gone = NULL;
    pthread_mutex_lock(&a->mutex);
    if (a->busy && a->now == id)
        atomic_store(&a->stopped, true);
    for (int i = 0; i < a->count && !gone; i++)
        if (a->waiting[i]->id == id) {
            gone = a->waiting[i];
            memmove(a->waiting + i, a->waiting + i + 1, sizeof(*a->waiting) * (size_t)(--a->count - i));
        }
    pthread_mutex_unlock(&a->mutex);
    free(gone);
}
