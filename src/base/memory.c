#include "base/base.h"

#include <pthread.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <sys/mman.h>
#include <sys/random.h>
#include <time.h>
#include <unistd.h>

/* Under AddressSanitizer what lies behind an item of an arena may not be touched, and small arrays have no room to
 * spare, so that it sees who reads or writes beyond them. */
#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define SANITIZED 1
#endif
#elif defined(__SANITIZE_ADDRESS__)
#define SANITIZED 1
#endif
#ifdef SANITIZED
#include <sanitizer/asan_interface.h>
#define FORBID(p, size) ASAN_POISON_MEMORY_REGION(p, size)
#define ALLOW(p, size) ASAN_UNPOISON_MEMORY_REGION(p, size)
enum { ARENA_GAP = 16, EXACT_ITEMS = 64 };
#else
#define FORBID(p, size) ((void)0)
#define ALLOW(p, size) ((void)0)
enum { ARENA_GAP = 0, EXACT_ITEMS = 0 };
#endif

/* The numbers of allocations to refuse, [first, last]; both 0 where none is, which is all that is looked at then. */
static _Atomic uint64_t refuse_first, refuse_last, allocations;

void noc_refuse_allocation(uint64_t number, bool and_later) {
    atomic_store(&refuse_first, 0);
    atomic_store(&allocations, 0);
    atomic_store(&refuse_last, and_later ? UINT64_MAX : number);
    atomic_store(&refuse_first, number);
}

uint64_t noc_allocations(void) { return atomic_load(&allocations); }

bool noc_allocation_refused(void) {
    uint64_t first = atomic_load_explicit(&refuse_first, memory_order_relaxed);
    if (__builtin_expect(!first, 1))
        return false;
    uint64_t number = atomic_fetch_add(&allocations, 1) + 1;
    return number >= first && number <= atomic_load(&refuse_last);
}

void *noc_alloc(size_t size) { return noc_allocation_refused() ? NULL : malloc(size ? size : 1); }

void *noc_calloc(size_t count, size_t size) {
    return noc_allocation_refused() ? NULL : calloc(count ? count : 1, size ? size : 1);
}

void *noc_realloc(void *p, size_t size) { return noc_allocation_refused() ? NULL : realloc(p, size ? size : 1); }

char *noc_strndup(const char *s, size_t n) {
    char *copy = noc_alloc(n + 1);
    if (copy) {
        memcpy(copy, s, n);
        copy[n] = 0;
    }
    return copy;
}

char *noc_strdup(const char *s) { return s ? noc_strndup(s, strlen(s)) : NULL; }

void *noc_alloc_large(size_t count, size_t size) {
    size_t bytes;
    if (__builtin_mul_overflow(count, size, &bytes) || bytes > SIZE_MAX - 63 || noc_allocation_refused())
        return NULL;
    size_t asked = bytes;
    bytes = (bytes + 63) & ~(size_t)63;
    void *p = aligned_alloc(64, bytes ? bytes : 64);
    if (p)
        memset(p, 0, bytes);
#ifdef NOC_FUZZ /* elsewhere whole vectors may be read */
    if (p)
        FORBID((char *)p + asked, bytes - asked);
#else
    (void)asked;
#endif
    return p;
}

bool noc_resize_large(void *array, size_t have, size_t count, size_t size) {
    void **data = array, *more = noc_alloc_large(count, size);
    if (!more)
        return false;
    if (*data)
        memcpy(more, *data, NOC_MIN(have, count) * size);
    free(*data);
    *data = more;
    return true;
}

void *noc_alloc_pages(size_t size) {
    if (noc_allocation_refused())
        return NULL;
#ifdef SANITIZED /* which looks at what lies beside blocks of its own */
    void *pages = NULL;
    return posix_memalign(&pages, (size_t)sysconf(_SC_PAGESIZE), size ? size : 1) ? NULL : memset(pages, 0, size);
#else
    void *pages = mmap(NULL, size ? size : 1, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    return pages == MAP_FAILED ? NULL : pages;
#endif
}

void noc_free_pages(void *pages, size_t size) {
#ifdef SANITIZED
    (void)size;
    free(pages);
#else
    if (pages)
        munmap(pages, size ? size : 1);
#endif
}

/* Items that an array has room for after growing. */
static size_t grown(size_t cap, size_t need) {
    return need <= EXACT_ITEMS ? need : NOC_MAX(cap ? cap + cap / 2 : 16, need);
}

bool noc_array_grow(void *data, size_t len, size_t *cap, size_t need, size_t item) {
    size_t n = grown(*cap, need), bytes;
    void *old, *now;
    memcpy(&old, data, sizeof(old)); /* a pointer of any type */
    bool borrows = old && !*cap;
    if (__builtin_mul_overflow(n, item, &bytes) || !(now = noc_realloc(borrows ? NULL : old, bytes)))
        return false;
    if (borrows)
        memcpy(now, old, NOC_MIN(len, n) * item);
    memcpy(data, &now, sizeof(now));
    *cap = n;
    return true;
}

struct noc_arena_block {
    struct noc_arena_block *next;
    size_t used, size;
    _Alignas(16) unsigned char data[];
};

void *arena_alloc(noc_arena *arena, size_t size) {
    struct noc_arena_block *b = arena->head;
    size_t asked = size;
    if (size <= SIZE_MAX / 2) {
        size = ((size + 15) & ~(size_t)15) + ARENA_GAP;
        if (!b || b->size - b->used < size) {
            size_t room = NOC_MAX(size, (size_t)64 * 1024 - sizeof(*b));
            if ((b = noc_alloc(sizeof(*b) + room))) {
                b->used = 0;
                b->size = room;
                FORBID(b->data, room);
                b->next = arena->head;
                arena->head = b;
                arena->bytes += sizeof(*b) + room;
            }
        }
    } else {
        b = NULL;
    }
    if (!b) {
        arena->refused = true;
        return NULL;
    }
    void *p = b->data + b->used;
    b->used += size;
    ALLOW(p, asked);
    return memset(p, 0, asked);
}

char *arena_strndup(noc_arena *arena, const char *s, size_t n) {
    char *p = arena_alloc(arena, n + 1);
    return p ? memcpy(p, s, n) : NULL;
}

char *arena_strdup(noc_arena *arena, const char *s) { return s ? arena_strndup(arena, s, strlen(s)) : NULL; }

/* In the arena; to be freed where that is NULL. A text that vsnprintf cannot measure (2 GB) is refused. */
static char *format_v(noc_arena *arena, const char *fmt, va_list ap) {
    va_list copy;
    va_copy(copy, ap);
    int n = noc_vsnprintf(NULL, 0, fmt, copy);
    va_end(copy);
    size_t size = n < 0 ? SIZE_MAX / 2 + 1 : (size_t)n + 1; /* which no allocator has */
    char *s = arena ? arena_alloc(arena, size) : noc_alloc(size);
    if (s)
        noc_vsnprintf(s, size, fmt, ap);
    return s;
}

char *noc_format(const char *fmt, ...) {
    va_list ap;
    va_start(ap, fmt);
    char *s = format_v(NULL, fmt, ap);
    va_end(ap);
    return s;
}

char *arena_format(noc_arena *arena, const char *fmt, ...) {
    va_list ap;
    va_start(ap, fmt);
    char *s = format_v(arena, fmt, ap);
    va_end(ap);
    return s;
}

void arena_free(noc_arena *arena) {
    for (struct noc_arena_block *b = arena->head, *next; b; b = next) {
        next = b->next;
        free(b);
    }
    *arena = (noc_arena){ 0 };
}

struct noc_map_slot {
    char *key;
    uint64_t value;
    uint32_t hash;
};

/* Ids come from files, whose author may choose ones that collide: the hash is keyed with what he cannot know.
 * SipHash-1-3 (Aumasson and Bernstein 2012; one round a word and three at the end, as hash tables commonly take it). No
 * result depends on the key, as no one walks through a map. */
static uint64_t hash_key[2];
static pthread_once_t hash_key_once = PTHREAD_ONCE_INIT;

static void make_hash_key(void) {
    if (getrandom(hash_key, sizeof(hash_key), GRND_NONBLOCK) == sizeof(hash_key))
        return;
    struct timespec now; /* early at boot: better than nothing */
    clock_gettime(CLOCK_REALTIME, &now);
    hash_key[0] = (uint64_t)now.tv_nsec << 32 ^ (uint64_t)now.tv_sec;
    hash_key[1] = (uint64_t)(uintptr_t)&now ^ (uint64_t)getpid() << 32;
}

static uint64_t rotate(uint64_t x, int bits) { return x << bits | x >> (64 - bits); }

static void sip_round(uint64_t v[4]) {
    v[0] += v[1], v[2] += v[3];
    v[1] = rotate(v[1], 13) ^ v[0], v[3] = rotate(v[3], 16) ^ v[2];
    v[0] = rotate(v[0], 32);
    v[2] += v[1], v[0] += v[3];
    v[1] = rotate(v[1], 17) ^ v[2], v[3] = rotate(v[3], 21) ^ v[0];
    v[2] = rotate(v[2], 32);
}

uint64_t base_siphash(const void *data, size_t size, const uint64_t key[2]) {
    uint64_t v[4] = { key[0] ^ 0x736f6d6570736575u, key[1] ^ 0x646f72616e646f6du, key[0] ^ 0x6c7967656e657261u,
                      key[1] ^ 0x7465646279746573u };
    const unsigned char *p = data;
    for (size_t left = size;; left -= 8, p += 8) {
        uint64_t word = left < 8 ? (uint64_t)size << 56 : 0;
        for (size_t i = 0; i < NOC_MIN(left, 8u); i++)
            word |= (uint64_t)p[i] << 8 * i;
        v[3] ^= word;
        sip_round(v);
        v[0] ^= word;
        if (left < 8)
            break;
    }
    v[2] ^= 0xff;
    for (int i = 0; i < 3; i++)
        sip_round(v);
    return v[0] ^ v[1] ^ v[2] ^ v[3];
}

uint64_t base_secret(void) {
    pthread_once(&hash_key_once, make_hash_key);
    return hash_key[0];
}

static uint32_t hash_text(const char *s) {
    pthread_once(&hash_key_once, make_hash_key);
    return (uint32_t)base_siphash(s, strlen(s), hash_key);
}

/* The slot of key, or the empty one where it would go. cap is a power of two and never full. */
static struct noc_map_slot *find_slot(const noc_map *map, const char *key, uint32_t hash) {
    for (size_t i = hash & (map->cap - 1);; i = (i + 1) & (map->cap - 1)) {
        struct noc_map_slot *s = &map->slots[i];
        if (!s->key || (s->hash == hash && !strcmp(s->key, key)))
            return s;
    }
}

bool map_get(const noc_map *map, const char *key, uint64_t *value) {
    if (!map->cap)
        return false;
    const struct noc_map_slot *s = find_slot(map, key, hash_text(key));
    if (s->key && value)
        *value = s->value;
    return s->key != NULL;
}

bool map_put(noc_map *map, const char *key, uint64_t value, bool *fresh) {
    if (map->len * 4 >= map->cap * 3) {
        size_t cap = map->cap ? map->cap * 2 : 64;
        noc_map bigger = {
            .slots = noc_calloc(cap, sizeof(*bigger.slots)), .cap = cap, .keys = map->keys, .len = map->len
        };
        if (!bigger.slots)
            return false;
        for (size_t i = 0; i < map->cap; i++)
            if (map->slots[i].key)
                *find_slot(&bigger, map->slots[i].key, map->slots[i].hash) = map->slots[i];
        free(map->slots);
        *map = bigger;
    }
    uint32_t hash = hash_text(key);
    struct noc_map_slot *s = find_slot(map, key, hash);
    if (fresh)
        *fresh = !s->key;
    if (!s->key) {
        if (!(s->key = arena_strdup(&map->keys, key)))
            return false;
        s->hash = hash;
        map->len++;
    }
    s->value = value;
    return true;
}

size_t map_longest_probe(const noc_map *map) {
    size_t longest = 0;
    for (size_t i = 0; i < map->cap; i++)
        if (map->slots[i].key)
            longest = NOC_MAX(longest, (i - map->slots[i].hash) & (map->cap - 1));
    return longest;
}

void map_free(noc_map *map) {
    free(map->slots);
    arena_free(&map->keys);
    *map = (noc_map){ 0 };
}
