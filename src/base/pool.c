#include "base/base.h"

#include <pthread.h>
#include <stdatomic.h>

struct worker {
    noc_pool *pool;
    pthread_t thread;
    int index;
};

/* A run: on the stack of the thread that asked for it. */
struct run {
    void (*fn)(void *, size_t, int);
    void *ctx;
    size_t items;
    atomic_size_t next;
    int busy; /* workers at it, besides its caller */
    struct run *later;
};

struct noc_pool {
    int threads;
    struct worker *workers; /* threads - 1 of them: a run's caller is its worker 0 */
    pthread_mutex_t lock;
    pthread_cond_t start, done;
    bool stop;
    struct run *runs; /* that may still have items to give, in turn */
};

static void work(struct run *run, int index) {
    for (size_t i; (i = atomic_fetch_add(&run->next, 1)) < run->items;)
        run->fn(run->ctx, i, index);
}

static void unlink_run(noc_pool *pool, struct run *run) {
    struct run **at = &pool->runs;
    while (*at && *at != run)
        at = &(*at)->later;
    if (*at)
        *at = run->later;
}

/* The run that a worker helps next. It goes to the end of the line, so that runs share the workers. */
static struct run *next_run(noc_pool *pool) {
    struct run *run;
    while ((run = pool->runs) && atomic_load(&run->next) >= run->items)
        pool->runs = run->later;
    if (!run || !run->later)
        return run;
    struct run *last = run;
    while (last->later)
        last = last->later;
    pool->runs = run->later;
    last->later = run;
    run->later = NULL;
    return run;
}

static void *worker_main(void *arg) {
    struct worker *w = arg;
    noc_pool *pool = w->pool;
    struct run *run = NULL;
    pthread_mutex_lock(&pool->lock);
    for (;;) {
        while (!pool->stop && !(run = next_run(pool)))
            pthread_cond_wait(&pool->start, &pool->lock);
        if (pool->stop)
            break;
        run->busy++;
        pthread_mutex_unlock(&pool->lock);
        work(run, w->index);
        pthread_mutex_lock(&pool->lock);
        if (!--run->busy)
            pthread_cond_broadcast(&pool->done);
    }
    pthread_mutex_unlock(&pool->lock);
    return NULL;
}

/* At least LEAST of stack, whatever the limit of the process is (ulimit -s), which is the default of its threads. */
static bool start_thread(struct worker *w) {
    enum { LEAST = 2 << 20 };
    pthread_attr_t attr;
    size_t size = 0;
    if (pthread_attr_init(&attr))
        return false;
    bool fine = !pthread_attr_getstacksize(&attr, &size) &&
                (size >= LEAST || !pthread_attr_setstacksize(&attr, LEAST)) &&
                !pthread_create(&w->thread, &attr, worker_main, w);
    pthread_attr_destroy(&attr);
    return fine;
}

noc_pool *noc_pool_create(int threads) {
    if (threads <= 0)
        threads = noc_processors();
    threads = NOC_CLAMP(threads, 1, 1024);
    noc_pool *pool = noc_calloc(1, sizeof(*pool));
    struct worker *workers = pool ? noc_calloc((size_t)threads, sizeof(*workers)) : NULL;
    if (!workers) {
        free(pool);
        return NULL;
    }
    pthread_mutex_init(&pool->lock, NULL);
    pthread_cond_init(&pool->start, NULL);
    pthread_cond_init(&pool->done, NULL);
    pool->workers = workers;
    pool->threads = 1;
    for (int i = 1; i < threads; i++) {
        struct worker *w = &pool->workers[i - 1];
        *w = (struct worker){ .pool = pool, .index = i };
        if (noc_allocation_refused() || !start_thread(w))
            break;
        pool->threads++;
    }
    return pool;
}

void noc_pool_destroy(noc_pool *pool) {
    if (!pool)
        return;
    pthread_mutex_lock(&pool->lock);
    pool->stop = true;
    pthread_cond_broadcast(&pool->start);
    pthread_mutex_unlock(&pool->lock);
    for (int i = 1; i < pool->threads; i++)
        pthread_join(pool->workers[i - 1].thread, NULL);
    pthread_cond_destroy(&pool->start);
    pthread_cond_destroy(&pool->done);
    pthread_mutex_destroy(&pool->lock);
    free(pool->workers);
    free(pool);
}

int noc_pool_threads(const noc_pool *pool) { return pool->threads; }

static void link_run(noc_pool *pool, struct run *run) {
    pthread_mutex_lock(&pool->lock);
    struct run **end = &pool->runs;
    while (*end)
        end = &(*end)->later;
    *end = run;
    pthread_cond_broadcast(&pool->start);
    pthread_mutex_unlock(&pool->lock);
}

void noc_pool_run(noc_pool *pool, size_t items, void (*fn)(void *, size_t, int), void *ctx) {
    struct run run = { .fn = fn, .ctx = ctx, .items = items };
    link_run(pool, &run);
    work(&run, 0);
    pthread_mutex_lock(&pool->lock);
    unlink_run(pool, &run);
    while (run.busy)
        pthread_cond_wait(&pool->done, &pool->lock);
    pthread_mutex_unlock(&pool->lock);
}

struct noc_pool_task {
    struct run run;
};

noc_pool_task *noc_pool_start(noc_pool *pool, size_t items, void (*fn)(void *, size_t, int), void *ctx) {
    noc_pool_task *task = noc_calloc(1, sizeof(*task));
    if (!task)
        return NULL;
    task->run.fn = fn;
    task->run.ctx = ctx;
    task->run.items = items;
    link_run(pool, &task->run);
    return task;
}

void noc_pool_wait(noc_pool *pool, noc_pool_task *task) {
    pthread_mutex_lock(&pool->lock);
    while (task->run.busy || atomic_load(&task->run.next) < task->run.items)
        pthread_cond_wait(&pool->done, &pool->lock);
    unlink_run(pool, &task->run);
    pthread_mutex_unlock(&pool->lock);
    free(task);
}
