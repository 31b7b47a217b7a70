#include "import/mesh/obj_chunks.h"

#define CHUNK ((size_t)64 << 10) /* bytes */
#define SLOTS 4                  /* a thread */

/* Does a backslash join the line that ends here to the next? */
static bool goes_on(const char *begin, const char *newline) {
    while (newline > begin && newline[-1] == '\r')
        newline--;
    return newline > begin && newline[-1] == '\\';
}

bool obj_chunks_cut(obj_chunks *c, char *data, size_t size, int threads) {
    char *p = data;
    c->stop = data + size;
    while (p < c->stop) {
        obj_chunk chunk = { .begin = p, .end = c->stop };
        char *newline = (size_t)(c->stop - p) > CHUNK ? p + CHUNK - 1 : NULL;
        while (newline && (newline = memchr(newline, '\n', (size_t)(c->stop - newline))) && goes_on(p, newline))
            newline++;
        p = chunk.end = newline ? newline + 1 : c->stop;
        if (!array_push(&c->list, chunk))
            return false;
    }
    c->pool = noc_pool_create((int)NOC_MIN((size_t)threads, NOC_MAX(c->list.len, (size_t)1)));
    c->slots = c->pool ? (size_t)noc_pool_threads(c->pool) * SLOTS : 0;
    return c->pool != NULL;
}

typedef struct window {
    const obj_chunk *first;
    void (*read)(void *ctx, const obj_chunk *chunk, size_t slot);
    void *ctx;
} window;

static void read_one(void *ctx, size_t item, int worker) {
    const window *w = ctx;
    w->read(w->ctx, w->first + item, item);
}

bool obj_chunks_each(obj_chunks *c, void (*read)(void *ctx, const obj_chunk *chunk, size_t slot),
                     bool (*take)(void *ctx, obj_chunk *chunk, size_t slot), void *ctx) {
    for (size_t first = 0, count; first < c->list.len; first += count) {
        window w = { c->list.data + first, read, ctx };
        count = NOC_MIN(c->slots, c->list.len - first);
        noc_pool_run(c->pool, count, read_one, &w);
        for (size_t i = 0; i < count; i++)
            if (!take(ctx, c->list.data + first + i, i))
                return false;
    }
    return true;
}

void obj_chunks_free(obj_chunks *c) {
    noc_pool_destroy(c->pool);
    array_free(&c->list);
    array_free(&c->asked);
}
