/* base: memory, arrays, strings, errors, threads. Knows nothing of the rest. */
#ifndef NOC_BASE_H
#define NOC_BASE_H

#include <nocturne/log.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NOC_COUNT(a) (sizeof(a) / sizeof((a)[0]))
#define NOC_MIN(a, b) ((a) < (b) ? (a) : (b))
#define NOC_MAX(a, b) ((a) > (b) ? (a) : (b))
#define NOC_CLAMP(x, lo, hi) NOC_MIN(NOC_MAX(x, lo), hi)

/* The result says whether it was done: the compiler tells who does not look. */
#define NOC_MUST_USE __attribute__((warn_unused_result))
static inline bool NOC_MUST_USE noc_must_use(bool done) { return done; }

/* Memory. Where it is refused these give NULL or false, and what they should have changed is as it was: the caller
 * frees what it has made and returns NOC_ERR_MEMORY, after reporting it once (noc_no_memory). Nothing here ends the
 * program. free() them. */
void *noc_alloc(size_t size) NOC_MUST_USE;                /* uninitialised */
void *noc_calloc(size_t count, size_t size) NOC_MUST_USE; /* zeroed; NULL when count * size overflows, too */
void *noc_realloc(void *p, size_t size) NOC_MUST_USE;     /* p lives on where the result is NULL */
char *noc_strdup(const char *s) NOC_MUST_USE;             /* NULL stays NULL */
char *noc_strndup(const char *s, size_t n) NOC_MUST_USE;
char *noc_format(const char *fmt, ...) NOC_PRINTF(1, 2) NOC_MUST_USE;

/* For tests: of all allocations of the library from now on, the one numbered `number` (from 1) is refused, and with
 * and_later all that follow. 0: none is. Every allocation of src/ passes here, and so does every start of a thread of a
 * pool. */
void noc_refuse_allocation(uint64_t number, bool and_later);
uint64_t noc_allocations(void);    /* allocations since noc_refuse_allocation(number > 0, ...) */
bool noc_allocation_refused(void); /* whether the one that comes now is refused; for what allocates by other means */

/* Large allocations whose size a user decides: 64-byte aligned, zeroed; NULL when refused or when count * size
 * overflows. */
void *noc_alloc_large(size_t count, size_t size) NOC_MUST_USE;
/* Room for `count` records in such an allocation, with the first `have` of those that it has. array: address of its
 * pointer, which is as it was when memory is refused. */
bool noc_resize_large(void *array, size_t have, size_t count, size_t size) NOC_MUST_USE;

/* Whole pages, zeroed and writable, which cost nothing before they are touched; NULL where they are refused. */
void *noc_alloc_pages(size_t size) NOC_MUST_USE;
void noc_free_pages(void *pages, size_t size); /* NULL is nothing */

/* FNV-1a of a text, 64 bits: the same in every process. Its high bits say little of its last letters: who takes some
 * of them mixes it first. */
static inline uint64_t noc_hash_text(const char *text) {
    uint64_t h = 0xcbf29ce484222325u;
    for (; *text; text++)
        h = (h ^ (unsigned char)*text) * 0x100000001b3u;
    return h;
}

/* Growable array: NOC_ARRAY(float) a = { 0 }; if (!array_push(&a, 1.f)) ...; array_free(&a). False, and the array is as
 * it was, when memory is refused.
 *
 * One with data and a cap of 0 borrows what it has: its items may be written, and as it grows it gets memory of its own
 * (array_borrow). */
#define NOC_ARRAY(T)                                                                                                   \
    struct {                                                                                                           \
        T *data;                                                                                                       \
        size_t len, cap;                                                                                               \
    }
#define array_reserve(a, n)                                                                                            \
    noc_must_use((n) <= ((a)->cap || !(a)->data ? (a)->cap : (a)->len) ||                                              \
                 noc_array_grow(&(a)->data, (a)->len, &(a)->cap, (n), sizeof(*(a)->data)))
#define array_push(a, ...)                                                                                             \
    noc_must_use(                                                                                                      \
        ((a)->len < (a)->cap || noc_array_grow(&(a)->data, (a)->len, &(a)->cap, (a)->len + 1, sizeof(*(a)->data))) &&  \
        ((a)->data[(a)->len++] = (__VA_ARGS__), true))
#define array_append(a, src, n)                                                                                        \
    noc_must_use(                                                                                                      \
        (((a)->len <= (a)->cap && (n) <= (a)->cap - (a)->len) ||                                                       \
         noc_array_grow(&(a)->data, (a)->len, &(a)->cap, (a)->len + (n), sizeof(*(a)->data))) &&                       \
        ((n) ? (void)memcpy((a)->data + (a)->len, (src), (n) * sizeof(*(a)->data)) : (void)0, (a)->len += (n), true))
#define array_free(a) (free((a)->cap ? (a)->data : NULL), (a)->data = NULL, (a)->len = (a)->cap = 0, (void)0)
/* of an empty array; what it borrows is there as long as it */
#define array_borrow(a, items, n) ((a)->data = (items), (a)->len = (n), (a)->cap = 0, (void)0)
/* data: address of the array's pointer; len: items that a borrowing one has */
bool noc_array_grow(void *data, size_t len, size_t *cap, size_t need, size_t item) NOC_MUST_USE;

/* Arena: everything in it is freed at once. Zero-initialise; not thread-safe. What is refused is NULL, and `refused`
 * stays set, so that who fills a record with many texts looks once, at its end. */
typedef struct noc_arena {
    struct noc_arena_block *head;
    size_t bytes;
    bool refused;
} noc_arena;
void *arena_alloc(noc_arena *arena, size_t size) NOC_MUST_USE;    /* zeroed, 16-byte aligned */
char *arena_strdup(noc_arena *arena, const char *s) NOC_MUST_USE; /* NULL stays NULL */
char *arena_strndup(noc_arena *arena, const char *s, size_t n) NOC_MUST_USE;
char *arena_format(noc_arena *arena, const char *fmt, ...) NOC_PRINTF(2, 3) NOC_MUST_USE;
void arena_free(noc_arena *arena);

/* Log. log may be NULL everywhere (then warnings and errors go nowhere). noc_error returns its status, so
 * `return noc_error(log, NOC_ERR_FORMAT, "%s:%d: ...", path, line, ...)`. */
noc_status noc_error(noc_log *log, noc_status status, const char *fmt, ...) NOC_PRINTF(3, 4);
/* Of the last error, for who called what reports a failure and returns NULL; NOC_ERR_IO where log is NULL. */
noc_status noc_log_last_status(const noc_log *log);
/* Of memory that was refused: NOC_ERR_MEMORY, with "WHERE: out of memory". */
noc_status noc_no_memory(noc_log *log, const char *where);
/* Of a call whose caller gave NULL for what is needed: NOC_ERR_ARGUMENT. */
noc_status noc_null(noc_log *log, const char *function);
/* Of a call that its caller cancelled: no message above NOC_LOG_INFO, but the last error. Returns NOC_ERR_CANCELLED. */
noc_status noc_cancelled(noc_log *log, const char *fmt, ...) NOC_PRINTF(2, 3);
void noc_warn(noc_log *log, const char *fmt, ...) NOC_PRINTF(2, 3);
void noc_info(noc_log *log, const char *fmt, ...) NOC_PRINTF(2, 3);
void noc_debug(noc_log *log, const char *fmt, ...) NOC_PRINTF(2, 3);

/* Numbers and text, independent of the locale, which belongs to the host: its decimal point may be a comma. All text
 * that leaves the library is formatted by these, or by what stands on them (noc_format, arena_format, messages). */
int noc_snprintf(char *text, size_t size, const char *fmt, ...) NOC_PRINTF(3, 4);
int noc_vsnprintf(char *text, size_t size, const char *fmt, va_list ap) NOC_PRINTF(3, 0);
int noc_fprintf(FILE *file, const char *fmt, ...) NOC_PRINTF(2, 3);
/* the whole string must be one finite number (blanks around it allowed) */
bool noc_parse_double(const char *s, double *out);
/* next number in [s, end): position after it, NULL if none */
const char *noc_scan_double(const char *s, const char *end, double *out);
bool noc_parse_int(const char *s, long long *out);
bool noc_ieq(const char *a, const char *b); /* ASCII case-insensitive equality; NULL equals nothing */

void noc_processor_name(char *text, size_t size); /* "AMD EPYC 7763 64-Core Processor" */
/* Returns the number of cores that the calling thread may run on: those that taskset, mpirun or Slurm leave it. */
int noc_processors(void);
double noc_wall_seconds(void);
double noc_cpu_seconds(void); /* of the process, all threads */

/* Thread pool. run() calls fn(ctx, item, worker) for item in [0, items), spread over the workers (0 <= worker <
 * threads); the caller is worker 0. Returns when all are done. Several threads may run at once, each with its own
 * items: they share the pool's threads, whose numbers stay the same, so scratch a run and worker is enough. An item may
 * not start a run. */
typedef struct noc_pool noc_pool;
/* 0: noc_processors(). Fewer where the system starts no more. NULL when memory is refused. */
noc_pool *noc_pool_create(int threads) NOC_MUST_USE;
void noc_pool_destroy(noc_pool *pool);
int noc_pool_threads(const noc_pool *pool);
void noc_pool_run(noc_pool *pool, size_t items, void (*fn)(void *ctx, size_t item, int worker), void *ctx);
/* A run whose caller takes no item and goes on: the pool's other threads do all, so there must be some. NULL when
 * memory is refused. wait() returns when all are done, and must be called. */
typedef struct noc_pool_task noc_pool_task;
noc_pool_task *noc_pool_start(noc_pool *pool, size_t items, void (*fn)(void *ctx, size_t item, int worker),
                              void *ctx) NOC_MUST_USE;
void noc_pool_wait(noc_pool *pool, noc_pool_task *task);

/* String interning / id -> index map: open addressing, keys are copied into the map's arena. The hash differs from
 * process to process, so a map has no order that a result could depend on. */
typedef struct noc_map {
    struct noc_map_slot *slots;
    size_t len, cap;
    noc_arena keys;
} noc_map;
bool map_get(const noc_map *map, const char *key, uint64_t *value);
/* fresh, which may be NULL: whether key was not there; if it was, its value is replaced. False, and the map is as it
 * was, when memory is refused. */
bool map_put(noc_map *map, const char *key, uint64_t value, bool *fresh) NOC_MUST_USE;
void map_free(noc_map *map);
size_t map_longest_probe(const noc_map *map); /* slots that the worst key is away from its own; for tests */
uint64_t base_siphash(const void *data, size_t size, const uint64_t key[2]);
uint64_t base_secret(void); /* a number that no file's author knows; the same for all of the process */

#endif
