/* Many frames and other readers, or one commit. */
#include "scene/scene.h"

#include <pthread.h>

struct noc_scene_lock {
    pthread_mutex_t mutex;
    pthread_cond_t changed;
    size_t readers, waiting; /* commits that wait */
    bool commits;            /* one is at work */
};

struct noc_scene_lock *noc_scene_lock_create(void) {
    struct noc_scene_lock *l = noc_calloc(1, sizeof(*l));
    if (l) {
        pthread_mutex_init(&l->mutex, NULL);
        pthread_cond_init(&l->changed, NULL);
    }
    return l;
}

void noc_scene_lock_destroy(struct noc_scene_lock *l) {
    if (!l)
        return;
    pthread_cond_destroy(&l->changed);
    pthread_mutex_destroy(&l->mutex);
    free(l);
}

static void begin_read(struct noc_scene_lock *l, bool after_waiting) {
    pthread_mutex_lock(&l->mutex);
    while (l->commits || (after_waiting && l->waiting))
        pthread_cond_wait(&l->changed, &l->mutex);
    l->readers++;
    pthread_mutex_unlock(&l->mutex);
}

static void end_read(struct noc_scene_lock *l) {
    pthread_mutex_lock(&l->mutex);
    if (!--l->readers)
        pthread_cond_broadcast(&l->changed);
    pthread_mutex_unlock(&l->mutex);
}

void noc_scene_lock_frame(const noc_scene *s) { begin_read(s->lock, true); }
void noc_scene_unlock_frame(const noc_scene *s) { end_read(s->lock); }
void noc_scene_lock_read(const noc_scene *s) { begin_read(s->lock, false); }
void noc_scene_unlock_read(const noc_scene *s) { end_read(s->lock); }

void noc_scene_lock_commit(noc_scene *s) {
    struct noc_scene_lock *l = s->lock;
    pthread_mutex_lock(&l->mutex);
    l->waiting++;
    while (l->commits || l->readers)
        pthread_cond_wait(&l->changed, &l->mutex);
    l->waiting--;
    l->commits = true;
    pthread_mutex_unlock(&l->mutex);
}

void noc_scene_unlock_commit(noc_scene *s) {
    struct noc_scene_lock *l = s->lock;
    pthread_mutex_lock(&l->mutex);
    l->commits = false;
    pthread_cond_broadcast(&l->changed);
    pthread_mutex_unlock(&l->mutex);
}
