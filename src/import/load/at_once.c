/* Several city files are read at once, each by a thread of its own, and taken into the scene in their order by the one
 * that called, which also tells what they have to say and asks whether to go on. So scene, report and messages are the
 * same for any number of threads. Files wait with what they read: for the scene's place, which the first of them that
 * has one settles, and for their turn, where too much is waiting. */
#include "import/load/load.h"

#include <pthread.h>
#include <time.h>

#define BATCH_BYTES (1 << 20)
#define BATCH_PARTS 4096
#define QUEUE_BYTES 64e6         /* that wait for a file's turn at most, but for the last batch */
#define ASK_NANOSECONDS 50000000 /* between two questions of progress, where nothing comes */

typedef struct batch {
    struct batch *next;
    noc_arena arena; /* of texts and arrays */
    NOC_ARRAY(load_part) parts;
} batch;

/* One file. */
struct load_queue {
    struct at_once *all;
    size_t item;
    /* the reader's own */
    batch *filling;
    bool error_kept, refused; /* an error is among the messages; memory was refused to what should wait */
    bool placed;              /* it knows that the scene is */
    /* under the lock */
    batch *first, **last;
    double bytes;   /* in them */
    double share;   /* of the file that is read */
    double claimed; /* bytes that its reader holds */
    bool done;
    noc_status status;
};

typedef struct at_once {
    importer *im;
    const size_t *inputs;
    size_t count;
    load_queue *queues;
    double most_waiting, most_claimed; /* bytes: of a queue; of all readers before their turn */
    pthread_mutex_t lock;
    pthread_cond_t changed;
    size_t turn;
    bool placed, stop;
} at_once;

/* ---- the reader's side ---- */

static void free_batch(batch *b) {
    if (!b)
        return;
    arena_free(&b->arena);
    array_free(&b->parts);
    free(b);
}

/* Puts the batch that is filled behind the others. Where too much waits it waits, too; false: all is stopped. */
static bool pass_on(load_queue *q) {
    at_once *a = q->all;
    batch *b = q->filling;
    q->filling = NULL;
    pthread_mutex_lock(&a->lock);
    while (b && !a->stop && q->bytes >= a->most_waiting)
        pthread_cond_wait(&a->changed, &a->lock);
    bool go_on = !a->stop;
    if (b && go_on) {
        *q->last = b;
        q->last = &b->next;
        q->bytes += (double)b->arena.bytes;
        b = NULL;
        pthread_cond_broadcast(&a->changed);
    }
    pthread_mutex_unlock(&a->lock);
    free_batch(b);
    return go_on;
}

static void *copied(noc_arena *arena, const void *data, size_t size) {
    void *copy = arena_alloc(arena, size);
    return copy ? memcpy(copy, data, size) : NULL;
}

load_part part_copied(noc_arena *arena, load_part p) {
    switch (p.kind) {
    case PART_OBJECT: {
        part_surface *s = copied(arena, p.u.object.surfaces, p.u.object.surface_count * sizeof(*s));
        for (size_t i = 0; s && i < p.u.object.surface_count; i++) {
            s[i].xyz = copied(arena, s[i].xyz, 3 * s[i].vertex_count * sizeof(*s[i].xyz));
            s[i].indices = copied(arena, s[i].indices, 3 * s[i].triangle_count * sizeof(*s[i].indices));
            s[i].uv = s[i].uv ? copied(arena, s[i].uv, 2 * s[i].vertex_count * sizeof(*s[i].uv)) : NULL;
            surface_look *look = s[i].look ? copied(arena, s[i].look, sizeof(*look)) : NULL;
            if (look) {
                look->image = arena_strdup(arena, look->image);
                look->as.name = arena_strdup(arena, look->as.name);
            }
            s[i].look = look;
        }
        p.u.object.surfaces = s;
        p.u.object.id = arena_strdup(arena, p.u.object.id);
        break;
    }
    case PART_LAMP:
        p.u.lamp.lamp.id = arena_strdup(arena, p.u.lamp.lamp.id);
        p.u.lamp.lamp.ref = arena_strdup(arena, p.u.lamp.lamp.ref);
        p.u.lamp.lamp.tags = arena_strdup(arena, p.u.lamp.lamp.tags);
        break;
    case PART_MESSAGE: p.u.message.text = arena_strdup(arena, p.u.message.text); break;
    case PART_LOST:
    case PART_QUIET: break;
    }
    return p;
}

noc_status queue_put(load_queue *q, const importer *im, const load_part *part) {
    if (!q->placed && im->placed) { /* by this file: the others may go on */
        q->placed = true;
        pthread_mutex_lock(&q->all->lock);
        q->all->placed = true;
        pthread_cond_broadcast(&q->all->changed);
        pthread_mutex_unlock(&q->all->lock);
    }
    if (!q->filling)
        q->filling = noc_calloc(1, sizeof(*q->filling));
    batch *b = q->filling;
    load_part copy = b ? part_copied(&b->arena, *part) : *part;
    if (!b || b->arena.refused || !array_push(&b->parts, copy)) {
        q->refused = true;
        return NOC_ERR_MEMORY; /* told where the file is taken */
    }
    bool full = b->arena.bytes >= BATCH_BYTES || b->parts.len >= BATCH_PARTS;
    return full && !pass_on(q) ? NOC_ERR_CANCELLED : NOC_OK;
}

static void keep_message(void *user, noc_log_level level, const char *text) {
    load_queue *q = user;
    load_part part = { .kind = PART_MESSAGE, .u.message = { level, text } };
    bool kept = !queue_put(q, q->all->im, &part);
    q->error_kept = q->error_kept || (kept && level == NOC_LOG_ERROR);
}

bool queue_progress(load_queue *q, double share) {
    pthread_mutex_lock(&q->all->lock);
    q->share = share;
    bool go_on = !q->all->stop;
    pthread_mutex_unlock(&q->all->lock);
    return go_on;
}

static double claimed_ahead(const at_once *a) {
    double sum = 0;
    for (size_t i = a->turn + 1; i < a->count; i++)
        sum += a->queues[i].claimed;
    return sum;
}

void queue_claim(void *ctx, double bytes) {
    load_queue *q = ctx;
    at_once *a = q->all;
    pthread_mutex_lock(&a->lock);
    q->claimed = NOC_MAX(q->claimed, bytes);
    while (!a->stop && a->turn != q->item && claimed_ahead(a) > a->most_claimed)
        pthread_cond_wait(&a->changed, &a->lock);
    pthread_mutex_unlock(&a->lock);
}

static void read_one(void *ctx, size_t item, int worker) {
    (void)worker;
    at_once *a = ctx;
    load_queue *q = &a->queues[item];
    pthread_mutex_lock(&a->lock);
    while (!a->stop && !a->placed && a->turn != item)
        pthread_cond_wait(&a->changed, &a->lock);
    bool stop = a->stop;
    q->placed = a->placed;
    pthread_mutex_unlock(&a->lock);
    noc_status status = NOC_ERR_CANCELLED;
    if (!stop) {
        noc_log *log = noc_log_create(&(noc_log_params){ NOC_LOG_DEBUG, keep_message, q });
        reading r = { a->im, &a->im->inputs[a->inputs[item]], a->inputs[item], .log = log, .queue = q };
        r.sides = sides_of((int)(import_threads(a->im->params, SIZE_MAX) / a->count));
        q->refused = !log;
        status = log ? read_file(&r) : NOC_ERR_MEMORY;
        reading_free(&r);
        noc_log_destroy(log);
        pass_on(q);
    }
    pthread_mutex_lock(&a->lock);
    /* a message that did not come through may be the one that says why */
    q->status = q->refused && !q->error_kept ? NOC_ERR_MEMORY : status;
    q->done = true;
    q->claimed = 0;
    a->placed = a->placed || (a->turn == item && a->im->placed);
    pthread_cond_broadcast(&a->changed);
    pthread_mutex_unlock(&a->lock);
}

/* ---- the scene's side ---- */

/* The next batch of a file, NULL with *done where there is none and none will come, and with false where none came for
 * a while. *bytes gets how much of all files is read. */
static batch *next_batch(load_queue *q, bool *done, double *bytes) {
    at_once *a = q->all;
    struct timespec until;
    clock_gettime(CLOCK_REALTIME, &until);
    until.tv_nsec += ASK_NANOSECONDS;
    until.tv_sec += until.tv_nsec / 1000000000;
    until.tv_nsec %= 1000000000;
    pthread_mutex_lock(&a->lock);
    while (!q->first && !q->done && !pthread_cond_timedwait(&a->changed, &a->lock, &until))
        ;
    batch *b = q->first;
    if (b) {
        q->first = b->next;
        q->last = q->first ? q->last : &q->first;
        q->bytes -= (double)b->arena.bytes;
        pthread_cond_broadcast(&a->changed);
    }
    *done = !b && q->done;
    *bytes = a->im->bytes_before;
    for (size_t i = q->item; i < a->count; i++)
        *bytes += NOC_CLAMP(a->queues[i].share, 0, 1) * (double)a->im->inputs[a->inputs[i]].bytes;
    pthread_mutex_unlock(&a->lock);
    return b;
}

static noc_status take_queue(load_queue *q, input *in) {
    importer *im = q->all->im;
    noc_status status = NOC_OK;
    for (bool done = false; !done && !status;) {
        double bytes;
        batch *b = next_batch(q, &done, &bytes);
        if (!import_progress(im, in, bytes))
            status = NOC_ERR_CANCELLED;
        for (size_t i = 0; b && i < b->parts.len && !status; i++)
            status = take_part(im, in, &b->parts.data[i]);
        free_batch(b);
    }
    if (!status) {
        status = q->status;
        if (q->refused && !q->error_kept)
            noc_no_memory(im->log, in->path);
    }
    return status;
}

static noc_status take_all(at_once *a) {
    noc_status status = NOC_OK;
    for (size_t i = 0; i < a->count && !status; i++) {
        input *in = &a->im->inputs[a->inputs[i]];
        taking t = take_start(a->im, in);
        pthread_mutex_lock(&a->lock);
        a->turn = i;
        pthread_cond_broadcast(&a->changed);
        pthread_mutex_unlock(&a->lock);
        status = take_finish(&t, take_queue(&a->queues[i], in));
    }
    return status;
}

noc_status read_at_once(importer *im, const size_t *inputs, size_t count, noc_pool *pool) {
    double others = (double)NOC_MAX(noc_pool_threads(pool) - 1, 1);
    at_once a = { .im = im,
                  .inputs = inputs,
                  .count = count,
                  .most_waiting = NOC_MIN(QUEUE_BYTES, im->memory / 8 / others),
                  .most_claimed = im->memory / 4,
                  .turn = SIZE_MAX,
                  .placed = im->placed };
    a.queues = noc_calloc(count, sizeof(*a.queues));
    if (!a.queues)
        return noc_no_memory(im->log, "import");
    for (size_t i = 0; i < count; i++) {
        a.queues[i].all = &a;
        a.queues[i].item = i;
        a.queues[i].last = &a.queues[i].first;
    }
    pthread_mutex_init(&a.lock, NULL);
    pthread_cond_init(&a.changed, NULL);
    noc_pool_task *task = noc_pool_start(pool, count, read_one, &a);
    noc_status status = task ? take_all(&a) : noc_no_memory(im->log, "import");
    pthread_mutex_lock(&a.lock);
    a.stop = true;
    pthread_cond_broadcast(&a.changed);
    pthread_mutex_unlock(&a.lock);
    if (task)
        noc_pool_wait(pool, task);
    for (size_t i = 0; i < count; i++) {
        free_batch(a.queues[i].filling);
        for (batch *b = a.queues[i].first, *next; b; b = next) {
            next = b->next;
            free_batch(b);
        }
    }
    pthread_cond_destroy(&a.changed);
    pthread_mutex_destroy(&a.lock);
    free(a.queues);
    return status;
}
