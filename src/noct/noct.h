/* noct: the file that a built city is kept in: sections of bytes by name, each with a checksum. What lies in them is
 * their owners' business (scene/keep.h, import/built/built.h).
 *
 * The file is a head of 4096 bytes, with a table of the sections in it, and then the sections, each at a multiple of 64
 * bytes, so that arrays in them are used where they lie. It is read as a whole into pages of its own, and looked at
 * there: a file that changes or shrinks while it is in use changes nothing, and cannot end the process. Numbers are as
 * the machine has them, which the head tells; a checksum is XXH64 of the XXH64s of a section's blocks of 1 MiB, so that
 * they are made in parallel, while a block is in the cache. */
#ifndef NOC_NOCT_H
#define NOC_NOCT_H

#include "base/base.h"

enum { NOCT_VERSION = 1, NOCT_ROOM = 64 }; /* room: vectors are read beyond the last item */

/* XXH64 with seed 0, as its specification has it (github.com/Cyan4973/xxHash, doc/xxhash_spec.md). */
uint64_t noct_sum(const void *data, size_t size);

/* ---- writing (write.c) ---- */

typedef struct noct_writer noct_writer;

/* layout: a number for all that the reader must have in common with the writer beyond the version: sizes of records,
 * numbers of classes and kinds. NULL after reporting. */
noct_writer *noct_create(const char *path, uint64_t layout, noc_log *log, noc_status *status);
/* Asks progress between blocks whether to go on, from now on; done is what it is told. NOC_ERR_CANCELLED where not. */
void noct_watch(noct_writer *w, const noc_progress *progress, double done);
/* What goes wrong stays with the writer, and noct_close tells it: nobody else needs to ask. */
void noct_begin(noct_writer *w, const char *name); /* of at most 8 letters */
void noct_end(noct_writer *w);
void noct_put(noct_writer *w, const void *data, size_t bytes);
void noct_put_u32(noct_writer *w, uint32_t value);
void noct_put_u64(noct_writer *w, uint64_t value);
void noct_put_f64(noct_writer *w, double value);
void noct_put_text(noct_writer *w, const char *text); /* NULL is told from "" */
/* A section that is an array. */
void noct_put_array(noct_writer *w, const char *name, const void *data, size_t count, size_t size);
/* A name in the file's table of names, which is written at the end; the same for the same text. 0: NULL. */
uint32_t noct_name(noct_writer *w, const char *text);
/* The file appears, unless status is an error, which comes back then, or something went wrong. Frees w. */
noc_status noct_close(noct_writer *w, noc_status status);

/* ---- reading (read.c) ---- */

typedef struct noct_entry {
    char name[8];
    uint64_t offset, bytes, sum;
} noct_entry;

typedef struct noct_head {
    uint8_t magic[8];
    uint32_t order, version;
    uint64_t layout, size;
    uint32_t sections, zero;
    char writer[16]; /* noc_version of who wrote it */
    uint64_t sum;    /* of the head's page without it, as if it were 0 */
} noct_head;
enum { NOCT_HEAD = 4096, NOCT_SECTIONS = (NOCT_HEAD - sizeof(noct_head)) / sizeof(noct_entry) };

typedef struct noct_file {
    const char *path;
    noc_log *log;
    noc_pool *pool;
    void *bytes; /* all of it, and NOCT_ROOM zeros; noc_free_pages(bytes, pages), by who takes it out of here */
    size_t pages;
    noc_status status; /* the first thing that went wrong, reported */
    const noct_head *head;
    const noct_entry *entries;
    const char *names; /* table of names; what noct_name_at takes was looked at */
    size_t name_bytes;
} noct_file;

bool noct_is(const char *path);                   /* does it begin as one? */
bool noct_is_head(const void *head, size_t size); /* the same of its first bytes */
/* Reads and checks all. max_bytes: larger ones are refused (NOC_ERR_MEMORY). Progress is asked as it reads. f must be
 * closed after an error, too. */
noc_status noct_open(noct_file *f, const char *path, uint64_t layout, double max_bytes, int threads,
                     const noc_progress *progress, noc_log *log);
/* The head alone, into page: f->head and f->entries point there. */
noc_status noct_read_head(noct_file *f, const char *path, uint8_t page[NOCT_HEAD], noc_log *log);
/* The head and one section alone: *text is that section with a 0 behind it, to free(), NULL where there is none. */
noc_status noct_read_text(const char *path, const char *name, size_t most, noc_log *log, char **text);
void noct_close_file(noct_file *f);

/* "PATH: damaged: WHAT", once; NOC_ERR_FORMAT. */
noc_status noct_wrong(noct_file *f, const char *fmt, ...) NOC_PRINTF(2, 3);
noc_status noct_no_memory(noct_file *f);
/* An array's items where they lie, and their number. A section that is not there has none; one whose length is no
 * multiple of the size is wrong. */
void *noct_array(noct_file *f, const char *name, size_t size, size_t *count);
/* NULL for 0; a number that is none of the table's is wrong. */
const char *noct_name_at(noct_file *f, uint32_t name);

/* A look at numbers one after the other. What is not there is 0, and `bad`. */
typedef struct noct_cursor {
    const char *at, *end;
    bool bad;
} noct_cursor;
noct_cursor noct_section(noct_file *f, const char *name);
uint32_t noct_get_u32(noct_cursor *c);
uint64_t noct_get_u64(noct_cursor *c);
double noct_get_f64(noct_cursor *c);
const char *noct_get_text(noct_cursor *c); /* in the file's bytes */
/* All of it was there, and no more; else it is told as wrong. */
bool noct_read_whole(noct_file *f, const noct_cursor *c, const char *name);

/* Calls fn for parts of `count` items on all threads, which says whether they are all right. */
typedef bool noct_check(const void *ctx, size_t first, size_t end);
bool noct_each(noct_file *f, size_t count, noct_check *fn, const void *ctx);

#endif
