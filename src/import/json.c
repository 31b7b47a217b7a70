/* JSON by jansson, whose allocations are refused with a status.
 *
 * jansson 2.14 does not look whether a text that it reads could grow (lex_save), and reads beyond its end then. So
 * memory is set aside before each piece of the file: where an allocation is refused, that is given back, the allocation
 * tried once more, and the reading ended at the next piece. A text is doubled as it grows, so twice the bytes that came
 * so far are enough. */
#include "import/import.h"

#include <pthread.h>

typedef struct json_reading {
    size_t (*pull)(void *buffer, size_t size, void *user);
    void *user;
    void *aside; /* NULL once it was given back */
    size_t pulled, aside_size;
    bool refused;
} json_reading;

static _Thread_local json_reading *reading; /* of this thread, while one goes on */

static void *json_alloc(size_t size) {
    if (!reading)
        return malloc(size);
    void *p = reading->refused ? NULL : noc_alloc(size);
    if (p)
        return p;
    reading->refused = true;
    free(reading->aside);
    reading->aside = NULL;
    return malloc(size);
}

/* jansson has one allocator for all of the process: where the host gave it one of its own, that stays. */
static pthread_once_t allocator_once = PTHREAD_ONCE_INIT;
static void set_allocator(void) {
    json_malloc_t allocate;
    json_free_t release;
    json_get_alloc_funcs(&allocate, &release);
    if (allocate == malloc && release == free)
        json_set_alloc_funcs(json_alloc, free);
}

/* Sets aside what bytes that came can take. It grows by half and more, so that it seldom does. */
static bool set_aside(json_reading *r) {
    enum { PIECE = 1 << 20 }; /* what all else in a piece of 1 KiB can take, and more */
    size_t need = 2 * r->pulled + PIECE;
    if (need > r->aside_size) {
        free(r->aside);
        r->aside_size = need + need / 2;
        r->aside = noc_alloc(r->aside_size);
        r->refused = !r->aside;
    }
    return !r->refused;
}

static size_t pull(void *buffer, size_t size, void *user) {
    json_reading *r = user;
    size_t got = r->refused ? (size_t)-1 : r->pull(buffer, size, r->user);
    if (got == (size_t)-1)
        return got;
    r->pulled += got;
    return set_aside(r) ? got : (size_t)-1;
}

json_t *import_json_load(size_t (*from)(void *buffer, size_t size, void *user), void *user, size_t flags,
                         json_error_t *error) {
    json_reading r = { .pull = from, .user = user };
    *error = (json_error_t){ 0 };
    if (!set_aside(&r))
        return NULL;
    pthread_once(&allocator_once, set_allocator);
    reading = &r;
    json_t *root = json_load_callback(pull, &r, flags, error);
    reading = NULL;
    free(r.aside);
    if (!r.refused)
        return root;
    json_decref(root);
    *error = (json_error_t){ 0 };
    return NULL;
}

noc_status import_json_error(const json_error_t *error, const char *name, noc_log *log) {
    if (!*error->text || json_error_code(error) == json_error_out_of_memory)
        return noc_no_memory(log, name);
    return noc_error(log, NOC_ERR_FORMAT, "%s:%d: %s", name, error->line, error->text);
}
