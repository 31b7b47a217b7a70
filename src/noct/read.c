/* Reading: the head is looked at first, then all sections are read and summed at once. */
#include "noct/inside.h"

#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

noc_status noct_wrong(noct_file *f, const char *fmt, ...) {
    char text[300];
    va_list ap;
    va_start(ap, fmt);
    noc_vsnprintf(text, sizeof(text), fmt, ap);
    va_end(ap);
    if (!f->status)
        f->status = noc_error(f->log, NOC_ERR_FORMAT, "%.400s: is damaged: %s", f->path, text);
    return f->status;
}

noc_status noct_no_memory(noct_file *f) {
    if (!f->status)
        f->status = noc_no_memory(f->log, f->path);
    return f->status;
}

static noc_status io_error(noct_file *f) {
    return f->status = noc_error(f->log, NOC_ERR_IO, "%.400s: cannot be read: %s", f->path, strerror(errno));
}

static noc_status refuse(noct_file *f, const char *fmt, ...) NOC_PRINTF(2, 3);
static noc_status refuse(noct_file *f, const char *fmt, ...) {
    char text[300];
    va_list ap;
    va_start(ap, fmt);
    noc_vsnprintf(text, sizeof(text), fmt, ap);
    va_end(ap);
    return f->status = noc_error(f->log, NOC_ERR_FORMAT, "%.400s: %s", f->path, text);
}

/* All of so many bytes; false where they end before. */
static bool read_at(int fd, void *to, size_t bytes, uint64_t offset) {
    uint8_t *at = to;
    while (bytes) {
        ssize_t n = pread(fd, at, bytes, (off_t)offset);
        if (n < 0 && errno == EINTR)
            continue;
        if (n <= 0)
            return false;
        at += n;
        offset += (uint64_t)n;
        bytes -= (size_t)n;
    }
    return true;
}

bool noct_is_head(const void *head, size_t size) {
    return size >= sizeof(noct_magic) && !memcmp(head, noct_magic, sizeof(noct_magic));
}

/* A regular file; a pipe is not waited for. */
static int open_regular(const char *path, struct stat *st) {
    int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (fd < 0 || (!fstat(fd, st) && S_ISREG(st->st_mode)))
        return fd;
    close(fd);
    errno = EINVAL; /* "cannot be read: Invalid argument", as of a folder */
    return -1;
}

bool noct_is(const char *path) {
    struct stat st;
    char head[sizeof(noct_magic)];
    int fd = open_regular(path, &st);
    bool is = fd >= 0 && read_at(fd, head, sizeof(head), 0) && noct_is_head(head, sizeof(head));
    if (fd >= 0)
        close(fd);
    return is;
}

/* Sections lie behind the head, in order, none over another. */
static noc_status check_entries(noct_file *f) {
    uint64_t end = NOCT_HEAD;
    for (uint32_t i = 0; i < f->head->sections; i++) {
        const noct_entry *e = &f->entries[i];
        if (e->offset < end || e->offset % NOCT_ALIGN || e->offset > f->head->size ||
            e->bytes > f->head->size - e->offset)
            return noct_wrong(f, "its table of sections says what cannot be");
        end = e->offset + e->bytes;
    }
    return NOC_OK;
}

static noc_status check_head(noct_file *f, uint64_t size, uint64_t layout, uint8_t page[NOCT_HEAD]) {
    noct_head head;
    memcpy(&head, page, sizeof(head));
    f->head = (const noct_head *)page;
    f->entries = (const noct_entry *)(page + sizeof(head));
    if (!noct_is_head(page, NOCT_HEAD))
        return refuse(f, "is no built city");
    if (head.order != NOCT_ORDER)
        return refuse(f, "was built on a machine with another order of bytes: build it again on this one");
    if (head.version != NOCT_VERSION)
        return refuse(f, "is a built city of version %u, and nocturne %s reads version %d: build it again",
                      head.version, NOC_VERSION, NOCT_VERSION);
    memset(page + offsetof(noct_head, sum), 0, sizeof(head.sum));
    bool same = noct_sum(page, NOCT_HEAD) == head.sum;
    memcpy(page, &head, sizeof(head));
    if (!same)
        return noct_wrong(f, "the checksum of its head is another");
    if (layout && head.layout != layout)
        return refuse(f, "was built by nocturne %.*s, which keeps cities in another way: build it again",
                      (int)sizeof(head.writer), head.writer);
    if (size != head.size)
        return noct_wrong(f, "it has %llu bytes of %llu", (unsigned long long)size, (unsigned long long)head.size);
    return head.sections > NOCT_SECTIONS ? noct_wrong(f, "it has too many sections") : check_entries(f);
}

/* Opens it and looks at its head, which is read to page. -1 after reporting. */
static int open_head(noct_file *f, uint64_t layout, uint8_t page[NOCT_HEAD]) {
    struct stat st;
    int fd = open_regular(f->path, &st);
    if (fd < 0) {
        io_error(f);
        return -1;
    }
    errno = 0;
    if ((uint64_t)st.st_size < NOCT_HEAD)
        noct_wrong(f, "it has %llu bytes, less than its head", (unsigned long long)st.st_size);
    else if (!read_at(fd, page, NOCT_HEAD, 0))
        io_error(f);
    else
        check_head(f, (uint64_t)st.st_size, layout, page);
    if (!f->status)
        return fd;
    close(fd);
    return -1;
}

/* ---- sections ---- */

typedef struct block {
    uint64_t offset;
    size_t bytes;
} block;

typedef struct reading {
    int fd;
    uint8_t *bytes;
    const block *blocks;
    uint64_t *sums;
    bool failed; /* atomic */
} reading;

/* A large block's pages at once cost less than a fault each. A system that knows no such call, or has larger pages,
 * refuses it, and they come as they are written to. */
static void make_pages(uint8_t *bytes, size_t size) {
#ifdef MADV_POPULATE_WRITE
    enum { PAGE = 4096 };
    uint8_t *page = bytes - (uintptr_t)bytes % PAGE;
    if (size >= 16 * (size_t)PAGE)
        (void)!madvise(page, size + (size_t)(bytes - page), MADV_POPULATE_WRITE);
#endif
}

static void read_block(void *ctx, size_t item, int worker) {
    reading *r = ctx;
    const block *b = &r->blocks[item];
    make_pages(r->bytes + b->offset, b->bytes);
    if (!read_at(r->fd, r->bytes + b->offset, b->bytes, b->offset))
        __atomic_store_n(&r->failed, true, __ATOMIC_RELAXED);
    r->sums[item] = noct_sum(r->bytes + b->offset, b->bytes);
}

static size_t blocks_of(const noct_entry *e) { return (size_t)((e->bytes + NOCT_BLOCK - 1) / NOCT_BLOCK); }

/* Of all sections; blocks may be NULL. */
static size_t list_blocks(const noct_file *f, block *blocks) {
    size_t count = 0;
    for (uint32_t i = 0; i < f->head->sections; i++)
        for (size_t k = 0; k < blocks_of(&f->entries[i]); k++, count++)
            if (blocks) {
                uint64_t at = k * NOCT_BLOCK, left = f->entries[i].bytes - at;
                blocks[count] = (block){ f->entries[i].offset + at, (size_t)NOC_MIN(left, (uint64_t)NOCT_BLOCK) };
            }
    return count;
}

/* In portions, so that who waits can stop it. */
static noc_status read_blocks(noct_file *f, reading r, size_t count, const noc_progress *progress) {
    enum { PORTION = 256 };
    for (size_t first = 0; first < count && !r.failed; first += PORTION) {
        if (progress && progress->update && !progress->update(progress->user, f->path, (double)first / (double)count))
            return f->status = NOC_ERR_CANCELLED;
        size_t portion = NOC_MIN(count - first, (size_t)PORTION);
        noc_pool_run(f->pool, portion, read_block, &r);
        r.blocks += portion;
        r.sums += portion;
    }
    if (r.failed)
        f->status = noc_error(f->log, NOC_ERR_IO, "%.400s: cannot be read, or changes meanwhile", f->path);
    return f->status;
}

static noc_status check_sums(noct_file *f, const uint64_t *sums) {
    for (uint32_t i = 0; i < f->head->sections && !f->status; i++) {
        size_t count = blocks_of(&f->entries[i]);
        if (noct_sum(sums, count * sizeof(*sums)) != f->entries[i].sum)
            noct_wrong(f, "the checksum of its section %.8s is another", f->entries[i].name);
        sums += count;
    }
    return f->status;
}

static noc_status read_sections(noct_file *f, int fd, const noc_progress *progress) {
    size_t count = list_blocks(f, NULL);
    block *blocks = noc_calloc(count, sizeof(*blocks));
    uint64_t *sums = noc_calloc(count, sizeof(*sums));
    if (!blocks || !sums) {
        noct_no_memory(f);
    } else {
        list_blocks(f, blocks);
        if (!read_blocks(f, (reading){ fd, f->bytes, blocks, sums, false }, count, progress))
            check_sums(f, sums);
    }
    free(blocks);
    free(sums);
    return f->status;
}

noc_status noct_open(noct_file *f, const char *path, uint64_t layout, double max_bytes, int threads,
                     const noc_progress *progress, noc_log *log) {
    _Alignas(64) uint8_t page[NOCT_HEAD];
    *f = (noct_file){ .path = path, .log = log };
    int fd = open_head(f, layout, page);
    if (fd < 0)
        return f->status;
    if ((double)f->head->size > max_bytes) {
        f->status = noc_error(log, NOC_ERR_MEMORY, "%.400s: has %.1f GB, and reading it may take %.1f: --max-memory",
                              path, 1e-9 * (double)f->head->size, 1e-9 * max_bytes);
    } else {
        f->pages = (size_t)f->head->size + NOCT_ROOM;
        f->bytes = noc_alloc_pages(f->pages);
        f->pool = f->bytes ? noc_pool_create(threads) : NULL;
        if (!f->pool)
            noct_no_memory(f);
    }
    if (!f->status) {
        memcpy(f->bytes, page, sizeof(page));
        f->head = f->bytes;
        f->entries = (const noct_entry *)((const uint8_t *)f->bytes + sizeof(noct_head));
        read_sections(f, fd, progress);
    }
    close(fd);
    if (!f->status) {
        size_t count;
        f->names = noct_array(f, NOCT_NAMES, 1, &count);
        f->name_bytes = count;
        if (!count || f->names[0] || f->names[count - 1])
            noct_wrong(f, "its names do not end");
    }
    return f->status;
}

void noct_close_file(noct_file *f) {
    noc_pool_destroy(f->pool);
    noc_free_pages(f->bytes, f->pages);
    *f = (noct_file){ 0 };
}

static const noct_entry *find(const noct_file *f, const char *name) {
    for (uint32_t i = 0; i < f->head->sections; i++)
        if (!strncmp(f->entries[i].name, name, sizeof(f->entries[i].name)))
            return &f->entries[i];
    return NULL;
}

noc_status noct_read_head(noct_file *f, const char *path, uint8_t page[NOCT_HEAD], noc_log *log) {
    *f = (noct_file){ .path = path, .log = log };
    int fd = open_head(f, 0, page);
    if (fd >= 0)
        close(fd);
    return f->status;
}

noc_status noct_read_text(const char *path, const char *name, size_t most, noc_log *log, char **text) {
    _Alignas(64) uint8_t page[NOCT_HEAD];
    noct_file f = { .path = path, .log = log };
    *text = NULL;
    int fd = open_head(&f, 0, page);
    if (fd < 0)
        return f.status;
    const noct_entry *e = find(&f, name);
    if (e && e->bytes > NOC_MIN(most, NOCT_BLOCK))
        noct_wrong(&f, "its section %.8s has %llu bytes", e->name, (unsigned long long)e->bytes);
    if (e && !f.status && !(*text = noc_alloc((size_t)e->bytes + 1)))
        noct_no_memory(&f);
    if (*text && !read_at(fd, *text, (size_t)e->bytes, e->offset))
        io_error(&f);
    close(fd);
    if (*text && !f.status) {
        uint64_t sum = noct_sum(*text, (size_t)e->bytes);
        (*text)[e->bytes] = 0;
        if (noct_sum(&sum, e->bytes ? sizeof(sum) : 0) != e->sum)
            noct_wrong(&f, "the checksum of its section %.8s is another", e->name);
    }
    if (f.status) {
        free(*text);
        *text = NULL;
    }
    return f.status;
}

/* ---- what lies in them ---- */

void *noct_array(noct_file *f, const char *name, size_t size, size_t *count) {
    const noct_entry *e = find(f, name);
    *count = 0;
    if (!e || f->status)
        return NULL;
    if (e->bytes % size)
        noct_wrong(f, "its section %s has %llu bytes", name, (unsigned long long)e->bytes);
    else
        *count = (size_t)e->bytes / size;
    return *count ? (uint8_t *)f->bytes + e->offset : NULL;
}

const char *noct_name_at(noct_file *f, uint32_t name) {
    if (!name)
        return NULL;
    if (name < f->name_bytes)
        return f->names + name;
    noct_wrong(f, "it has a name beyond its names");
    return NULL;
}

noct_cursor noct_section(noct_file *f, const char *name) {
    const noct_entry *e = find(f, name);
    const char *at = e ? (const char *)f->bytes + e->offset : NULL;
    return (noct_cursor){ at, e ? at + e->bytes : NULL, !e };
}

static void get(noct_cursor *c, void *to, size_t bytes) {
    c->bad = c->bad || (size_t)(c->end - c->at) < bytes;
    memset(to, 0, bytes);
    if (c->bad)
        return;
    memcpy(to, c->at, bytes);
    c->at += bytes;
}

uint32_t noct_get_u32(noct_cursor *c) {
    uint32_t value;
    get(c, &value, sizeof(value));
    return value;
}

uint64_t noct_get_u64(noct_cursor *c) {
    uint64_t value;
    get(c, &value, sizeof(value));
    return value;
}

double noct_get_f64(noct_cursor *c) {
    double value;
    get(c, &value, sizeof(value));
    return value;
}

const char *noct_get_text(noct_cursor *c) {
    char there;
    get(c, &there, 1);
    const char *text = c->at, *end = c->bad ? NULL : memchr(c->at, 0, (size_t)(c->end - c->at));
    c->bad = c->bad || !end || (there != '+' && (there != '-' || *text));
    if (c->bad)
        return NULL;
    c->at = end + 1;
    return there == '+' ? text : NULL;
}

bool noct_read_whole(noct_file *f, const noct_cursor *c, const char *name) {
    if (c->bad || c->at != c->end)
        noct_wrong(f, "its section %s %s", name, c->bad ? "is not whole" : "holds more than it should");
    return !f->status;
}

typedef struct each {
    noct_check *fn;
    const void *ctx;
    size_t count, portion;
    bool wrong; /* atomic */
} each;

static void check_portion(void *ctx, size_t item, int worker) {
    each *e = ctx;
    size_t first = item * e->portion;
    if (!__atomic_load_n(&e->wrong, __ATOMIC_RELAXED) && !e->fn(e->ctx, first, NOC_MIN(first + e->portion, e->count)))
        __atomic_store_n(&e->wrong, true, __ATOMIC_RELAXED);
}

bool noct_each(noct_file *f, size_t count, noct_check *fn, const void *ctx) {
    each e = { .fn = fn, .ctx = ctx, .count = count, .portion = 65536 };
    if (count)
        noc_pool_run(f->pool, (count + e.portion - 1) / e.portion, check_portion, &e);
    return !e.wrong;
}
