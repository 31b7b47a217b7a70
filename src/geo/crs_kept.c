#include "geo/crs_kept.h"
#include "geo/crs_files.h"

#include <pthread.h>
#include <stdatomic.h>

/* Nothing here is allocated by ourselves, so that a test that refuses the n-th allocation finds the same one whatever
 * is kept. */
enum { CONTEXTS = 8, COPIES = 32 };

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static PJ_CONTEXT *idle[2][CONTEXTS]; /* [strict] */
static int idle_count[2];
static PJ_CONTEXT *keeper; /* of what is kept; used under the lock alone */
static struct kept {
    PJ *pj;
    uint64_t used;
    char from[CRS_KEY], to[CRS_KEY];
} kept[COPIES];
static uint64_t uses;
static atomic_size_t keeps;

PJ_CONTEXT *crs_context_take(bool strict) {
    if (noc_allocation_refused())
        return NULL;
    pthread_mutex_lock(&lock);
    PJ_CONTEXT *context = idle_count[strict] ? idle[strict][--idle_count[strict]] : NULL;
    pthread_mutex_unlock(&lock);
    return context ? context : crs_context_create(strict);
}

void crs_context_give(PJ_CONTEXT *context, bool strict) {
    if (!context)
        return;
    pthread_mutex_lock(&lock);
    bool taken = idle_count[strict] < CONTEXTS;
    if (taken)
        idle[strict][idle_count[strict]++] = context;
    pthread_mutex_unlock(&lock);
    if (!taken)
        proj.proj_context_destroy(context);
}

/* Under the lock: the one of these keys, or NULL. */
static struct kept *find(const char *from, const char *to) {
    for (int i = 0; i < COPIES; i++)
        if (kept[i].pj && !strcmp(kept[i].from, from) && !strcmp(kept[i].to, to))
            return &kept[i];
    return NULL;
}

PJ *crs_kept(PJ_CONTEXT *context, const char *from, const char *to) {
    pthread_mutex_lock(&lock);
    struct kept *k = find(from, to);
    PJ *copy = k ? proj.proj_clone(context, k->pj) : NULL;
    if (k)
        k->used = ++uses;
    pthread_mutex_unlock(&lock);
    return copy;
}

void crs_keep(const PJ *pj, const char *from, const char *to) {
    if (!pj || !*from || !*to || strlen(from) >= CRS_KEY || strlen(to) >= CRS_KEY)
        return;
    pthread_mutex_lock(&lock);
    if (!keeper)
        keeper = crs_context_create(false);
    struct kept *k = &kept[0]; /* the one that was not used for longest goes */
    for (int i = 1; i < COPIES; i++)
        if (kept[i].used < k->used)
            k = &kept[i];
    PJ *copy = keeper && !find(from, to) ? proj.proj_clone(keeper, pj) : NULL;
    if (copy) {
        proj.proj_destroy(k->pj);
        k->pj = copy;
        k->used = ++uses;
        strcpy(k->from, from);
        strcpy(k->to, to);
        keeps++;
    }
    pthread_mutex_unlock(&lock);
}

size_t crs_kept_count(void) { return keeps; }
