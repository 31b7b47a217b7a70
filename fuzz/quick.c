/* What makes runs under libFuzzer quick, where other people's libraries are slow under sanitizers. Their code is not
 * instrumented; what they allocate for themselves need not be looked at, and what they prepare and never use need not
 * be made. */
#include "fuzz.h"

#include <dlfcn.h>
#include <sanitizer/lsan_interface.h>
#include <sys/mman.h>

int LLVMFuzzerInitialize(int *argc, char ***argv);

/* ---- SQLite, with which GDAL and PROJ read maps and their own databases: thousands of small blocks a run ---- */

/* Blocks of 32 bytes to 64 KiB by powers of two, in lists of free ones; larger ones are the system's, beside
 * AddressSanitizer's. LeakSanitizer looks for pointers in them: what PROJ hands to SQLite is no leak. */
void *__libc_malloc(size_t size);
void __libc_free(void *p);

enum { BEFORE = 16, SMALLEST = 5, LARGEST = 16, POOL = 1 << 20 }; /* BEFORE: bytes that hold the size */
static struct free_block { struct free_block *next; } *free_blocks[LARGEST + 1];
static char *pool, *pool_end;

static int class_of(size_t size) {
    int n = SMALLEST;
    while ((size_t)1 << n < size + BEFORE)
        n++;
    return n;
}

static int size_of(void *p) {
    int size = 0;
    if (p)
        memcpy(&size, (char *)p - BEFORE, sizeof(size));
    return size;
}

static void *take(int size) {
    int n = class_of((size_t)size);
    char *p;
    if (n > LARGEST) {
        p = __libc_malloc(BEFORE + (size_t)size);
        if (p)
            __lsan_register_root_region(p, BEFORE + (size_t)size);
    } else if (free_blocks[n]) {
        p = (char *)free_blocks[n];
        free_blocks[n] = free_blocks[n]->next;
    } else {
        if (pool_end - pool < (ptrdiff_t)1 << n) {
            pool = __libc_malloc(POOL);
            FUZZ_REQUIRE(pool);
            __lsan_register_root_region(pool, POOL);
            pool_end = pool + POOL;
        }
        p = pool;
        pool += (size_t)1 << n;
    }
    return p ? memcpy(p, &size, sizeof(size)), p + BEFORE : NULL;
}

static void give(void *p) {
    int n = class_of((size_t)size_of(p));
    struct free_block *block = (struct free_block *)(void *)((char *)p - BEFORE);
    if (n > LARGEST) {
        __lsan_unregister_root_region(block, BEFORE + (size_t)size_of(p));
        __libc_free(block);
        return;
    }
    block->next = free_blocks[n];
    free_blocks[n] = block;
}

static void *change(void *p, int size) {
    if (class_of((size_t)size) == class_of((size_t)size_of(p)) && class_of((size_t)size) <= LARGEST)
        return memcpy((char *)p - BEFORE, &size, sizeof(size)), p;
    void *now = take(size);
    if (now) {
        memcpy(now, p, (size_t)NOC_MIN(size, size_of(p)));
        give(p);
    }
    return now;
}

static int round_up(int size) { return (size + 7) & ~7; }
static int start(void *data) { return 0; }
static void stop(void *data) {}

/* By SQLite's own names and numbers: GDAL and PROJ load it, and it need not be linked. */
static struct sqlite3_mem_methods {
    void *(*xMalloc)(int);
    void (*xFree)(void *);
    void *(*xRealloc)(void *, int);
    int (*xSize)(void *);
    int (*xRoundup)(int);
    int (*xInit)(void *);
    void (*xShutdown)(void *);
    void *pAppData;
} memory = { take, give, change, size_of, round_up, start, stop, NULL };
enum { SQLITE_CONFIG_SINGLETHREAD = 1, SQLITE_CONFIG_MALLOC = 4, SQLITE_CONFIG_MEMSTATUS = 9 };

/* For every OpenStreetMap file GDAL prepares 400 queries for nodes of ways, which we never read: points alone. */
int sqlite3_prepare_v2(void *db, const char *sql, int size, void **statement, const char **tail);
int sqlite3_prepare_v2(void *db, const char *sql, int size, void **statement, const char **tail) {
    static int (*real)(void *, const char *, int, void **, const char **);
    if (!real)
        real = (int (*)(void *, const char *, int, void **, const char **))dlsym(RTLD_NEXT, "sqlite3_prepare_v2");
    if (!strncmp(sql, "SELECT id, coords FROM nodes WHERE id IN (", 42) ||
        !strncmp(sql, "SELECT id, data FROM ways WHERE id IN (", 39)) {
        *statement = NULL;
        return 0;
    }
    return real(db, sql, size, statement, tail);
}

/* ---- Assimp, which has two buffers of 16 MiB for every OBJ: the same pages each time ---- */

void *_Znwm(size_t size); /* operator new and delete of C++ */
void _ZdlPv(void *p);
void _ZdlPvm(void *p, size_t size);

enum { BUFFERS = 2, BUFFER = 17 << 20, LARGE = 8 << 20 };
static struct { void *pages; bool taken; } buffers[BUFFERS];

void *_Znwm(size_t size) {
    for (int i = 0; size >= LARGE && size <= BUFFER && i < BUFFERS; i++) {
        if (buffers[i].taken)
            continue;
        if (!buffers[i].pages) {
            buffers[i].pages = mmap(NULL, BUFFER, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
            FUZZ_REQUIRE(buffers[i].pages != MAP_FAILED);
        }
        buffers[i].taken = true;
        return buffers[i].pages;
    }
    static void *(*real)(size_t);
    if (!real)
        real = (void *(*)(size_t))dlsym(RTLD_NEXT, "_Znwm");
    return real(size); /* or it throws */
}

void _ZdlPv(void *p) {
    for (int i = 0; p && i < BUFFERS; i++) {
        if (buffers[i].pages == p) {
            buffers[i].taken = false;
            return;
        }
    }
    free(p);
}

void _ZdlPvm(void *p, size_t size) { _ZdlPv(p); }

int LLVMFuzzerInitialize(int *argc, char ***argv) {
    int (*configure)(int, ...) = (int (*)(int, ...))dlsym(RTLD_DEFAULT, "sqlite3_config");
    if (configure)
        FUZZ_REQUIRE(!configure(SQLITE_CONFIG_SINGLETHREAD) && !configure(SQLITE_CONFIG_MALLOC, &memory) &&
                     !configure(SQLITE_CONFIG_MEMSTATUS, 0));
    return 0;
}
