/* JSON by jansson, whose allocations are refused with a status.
 *
 * jansson 2.14 does not look whether a text that it reads could grow (lex_save), and reads beyond its end then. So memory is set
 * aside before it begins: where an allocation is refused, that is given back, the allocation tried once more, and the reading ended
 * at the next piece of the file. */
#include "import/import.h"

#include <pthread.h>

typedef struct json_reading {
    size_t (*pull)(void *buffer, size_t size, void *user);
    void *user;
    void *aside;  /* NULL once it was given back */
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

static size_t pull(void *buffer, size_t size, void *user) {
    const json_reading *r = user;
    return r->refused ? (size_t)-1 : r->pull(buffer, size, r->user);
}

json_t *import_json_load(size_t (*from)(void *buffer, size_t size, void *user), void *user, size_t bytes, size_t flags, json_error_t *error) {
    enum { PIECE = 1 << 20 }; /* what the rest of a piece of 1 KiB can take, and more */
    json_reading r = { .pull = from, .user = user, .aside = noc_alloc(2 * bytes + PIECE) };
    *error = (json_error_t){ 0 };
    if (!r.aside)
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
