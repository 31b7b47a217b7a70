/* What makes runs under libFuzzer quick, where other people's libraries are slow under sanitizers. Their code is not
 * instrumented; what they allocate for themselves need not be looked at, and what they prepare and never use need not
 * be made. */
#include "fuzz.h"
#include "geo/crs_proj.h"
#include "noc_config.h"
#if NOC_HAVE_ASSIMP
#include "import/mesh/assimp.h"
#endif

#include <ctype.h>
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
static struct free_block { struct free_block *next; } * free_blocks[LARGEST + 1];
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

/* ---- large blocks, of which Assimp takes two of 16 MiB for every OBJ and GDAL many for every OpenStreetMap file: the
 * same pages each time ---- */

void *_Znwm(size_t size); /* operator new and delete of C++ */
void _ZdlPv(void *p);
void _ZdlPvm(void *p, size_t size);
void *VSIMalloc(size_t size); /* GDAL's, by which it finds memory for itself */
void *VSICalloc(size_t count, size_t size);
void *VSIRealloc(void *p, size_t size);
void VSIFree(void *p);

enum { BLOCKS = 64, LARGE = 1 << 17, ASSIMPS = 1 << 24 };
static struct large {
    char *pages;
    size_t size;
    bool taken;
} blocks[BLOCKS];
static char *first_block = (char *)UINTPTR_MAX, *last_block;

/* Zeroed pages; NULL where the block is small, or there are too many of them. */
static void *take_large(size_t size) {
    struct large *b = blocks, *end = blocks + BLOCKS;
    if (size < LARGE)
        return NULL;
    while (b < end && (b->taken || (b->pages && b->size != size)))
        b++;
    if (b == end)
        return NULL;
    if (!b->pages) {
        b->pages = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
        if (b->pages == MAP_FAILED)
            return b->pages = NULL;
        b->size = size;
        first_block = NOC_MIN(first_block, b->pages);
        last_block = NOC_MAX(last_block, b->pages);
    }
    b->taken = true;
    return b->pages;
}

static struct large *large_at(const void *p) {
    for (int i = 0; (const char *)p >= first_block && (const char *)p <= last_block && i < BLOCKS; i++)
        if (blocks[i].taken && blocks[i].pages == p)
            return &blocks[i];
    return NULL;
}

/* What was written to is given back to the system, which zeroes it. */
static bool give_large(void *p) {
    struct large *b = large_at(p);
    if (b) {
        madvise(b->pages, b->size, MADV_DONTNEED);
        b->taken = false;
    }
    return b != NULL;
}

void *_Znwm(size_t size) {
    static void *(*real)(size_t);
    if (!real)
        real = (void *(*)(size_t))dlsym(RTLD_NEXT, "_Znwm");
    void *p = size == ASSIMPS ? take_large(size) : NULL; /* libFuzzer has large blocks, too */
    return p ? p : real(size);                           /* or it throws */
}

void _ZdlPv(void *p) {
    if (!give_large(p))
        free(p);
}

void _ZdlPvm(void *p, size_t size) { _ZdlPv(p); }

void *VSIMalloc(size_t size) {
    void *p = take_large(size);
    return p ? p : malloc(size);
}

void *VSICalloc(size_t count, size_t size) {
    size_t bytes;
    void *p = __builtin_mul_overflow(count, size, &bytes) ? NULL : take_large(bytes);
    return p ? p : calloc(count, size);
}

void *VSIRealloc(void *p, size_t size) {
    struct large *b = large_at(p);
    if (!b)
        return realloc(p, size);
    void *now = VSIMalloc(size);
    if (now) {
        memcpy(now, p, NOC_MIN(size, b->size));
        give_large(p);
    }
    return now;
}

void VSIFree(void *p) { _ZdlPv(p); }

/* Assimp fills its 16 MiB, with zeroes (from the second byte on) or ends of lines, and reads files of some kilobytes
 * into them. */
void *__asan_memset(void *p, int value, size_t size);
void *memset(void *p, int value, size_t size) {
    enum { ENOUGH = 1 << 18 };
    bool assimps = size >= ASSIMPS - 1 && large_at((void *)((uintptr_t)p & ~(uintptr_t)1));
    return __asan_memset(p, value, assimps ? ENOUGH : size);
}

/* ---- Assimp leaks where it throws. What it allocates is not looked at. ---- */

#if NOC_HAVE_ASSIMP
static __typeof__(aiImportFileEx) *assimp_import;

static const struct aiScene *import_file(const char *name, unsigned flags, struct aiFileIO *io) {
    __lsan_disable();
    const struct aiScene *scene = assimp_import(name, flags, io);
    __lsan_enable();
    return scene;
}

static void quicken_assimp(void) {
    FUZZ_REQUIRE(!assimp_load());
    assimp_import = assimp.aiImportFileEx;
    assimp.aiImportFileEx = import_file;
}
#else
static void quicken_assimp(void) {}
#endif

/* ---- PROJ, which for a text that it does not know looks through all names of its database (proj.py): one name
 * in 16 is looked for ---- */

/* Said by PROJ to be a definition, or a name that it finds at once. */
static bool is_definition(const char *text) {
    static const char *const first[] = {
        "{",        "urn:",        "http",          "EPSG:",        "ESRI:",   "OGC:",    "GEOGCS",  "PROJCS",
        "COMPD_CS", "GEOCCS",      "VERT_CS",       "LOCAL_CS",     "GEOGCRS", "GEODCRS", "PROJCRS", "COMPOUNDCRS",
        "BOUNDCRS", "GEODETICCRS", "GEOGRAPHICCRS", "PROJECTEDCRS", "VERTCRS", "ENGCRS"
    };
    while (isspace((unsigned char)*text))
        text++;
    for (size_t i = 0; i < NOC_COUNT(first); i++)
        if (!strncasecmp(text, first[i], strlen(first[i])))
            return true;
    return strstr(text, "proj=") || strstr(text, "init=") || !*text;
}

static __typeof__(proj_create) *projs_create;

static PJ *create(PJ_CONTEXT *context, const char *text) {
    bool is = is_definition(text) || fuzz_seldom((const uint8_t *)text, strlen(text), 16);
    return is ? projs_create(context, text) : NULL;
}

int LLVMFuzzerInitialize(int *argc, char ***argv) {
    /* with what it needs, SQLite, where the functions above find it and it finds them */
    FUZZ_REQUIRE(dlopen(NOC_PROJ_LIBRARY, RTLD_NOW | RTLD_GLOBAL) && !proj_load());
    projs_create = proj.proj_create;
    proj.proj_create = create;
    quicken_assimp();
    int (*configure)(int, ...) = (int (*)(int, ...))dlsym(RTLD_DEFAULT, "sqlite3_config");
    if (configure)
        FUZZ_REQUIRE(!configure(SQLITE_CONFIG_SINGLETHREAD) && !configure(SQLITE_CONFIG_MALLOC, &memory) &&
                     !configure(SQLITE_CONFIG_MEMSTATUS, 0));
    return 0;
}
