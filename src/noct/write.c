/* Writing: sections one after the other, the head last. */
#include "noct/inside.h"

#include "base/output.h"

#include <errno.h>

struct noct_writer {
    noc_log *log;
    output out;
    noc_status status; /* the first thing that went wrong, reported */
    noc_progress progress;
    double done;
    noct_head head;
    noct_entry entries[NOCT_SECTIONS];
    uint64_t at;    /* bytes of the file so far */
    uint8_t *block; /* of the section at work */
    size_t filled;
    NOC_ARRAY(uint64_t) sums; /* of its blocks */
    noc_map names;
    NOC_ARRAY(char) name_table;
    const char *last_name; /* what comes twice comes one after the other, mostly */
    uint32_t last_number;
};

static void emit(noct_writer *w, const void *data, size_t bytes) {
    if (!w->status && bytes && fwrite(data, 1, bytes, w->out.file) != bytes)
        w->status = output_failed(&w->out, w->log);
    w->at += bytes;
}

noct_writer *noct_create(const char *path, uint64_t layout, noc_log *log, noc_status *status) {
    static const uint8_t page[NOCT_HEAD];
    noct_writer *w = noc_calloc(1, sizeof(*w));
    if (!w || !(w->block = noc_alloc(NOCT_BLOCK))) {
        free(w);
        *status = noc_no_memory(log, path);
        return NULL;
    }
    *status = output_open(&w->out, path, log);
    if (*status) {
        free(w->block);
        free(w);
        return NULL;
    }
    w->log = log;
    w->head = (noct_head){ .order = NOCT_ORDER, .version = NOCT_VERSION, .layout = layout };
    memcpy(w->head.magic, noct_magic, sizeof(w->head.magic));
    noc_snprintf(w->head.writer, sizeof(w->head.writer), "%s", NOC_VERSION);
    if (!array_push(&w->name_table, 0)) /* no name is at 0 */
        w->status = noc_no_memory(log, path);
    emit(w, page, sizeof(page));
    return w;
}

void noct_begin(noct_writer *w, const char *name) {
    static const uint8_t zeros[NOCT_ALIGN];
    emit(w, zeros, -w->at & (NOCT_ALIGN - 1));
    noct_entry *e = &w->entries[w->head.sections];
    *e = (noct_entry){ .offset = w->at };
    memcpy(e->name, name, strnlen(name, sizeof(e->name)));
}

void noct_watch(noct_writer *w, const noc_progress *progress, double done) {
    w->progress = *progress;
    w->done = done;
}

static void flush_block(noct_writer *w) {
    if (!w->status && w->progress.update && !w->progress.update(w->progress.user, "saving", w->done))
        w->status = noc_cancelled(w->log, "%.400s: saving was cancelled", w->out.path);
    if (!w->status && !array_push(&w->sums, noct_sum(w->block, w->filled)))
        w->status = noc_no_memory(w->log, w->out.path);
    emit(w, w->block, w->filled);
    w->filled = 0;
}

void noct_put(noct_writer *w, const void *data, size_t bytes) {
    const uint8_t *from = data;
    while (bytes && !w->status) {
        size_t n = NOC_MIN(bytes, NOCT_BLOCK - w->filled);
        memcpy(w->block + w->filled, from, n);
        w->filled += n;
        from += n;
        bytes -= n;
        if (w->filled == NOCT_BLOCK)
            flush_block(w);
    }
}

void noct_end(noct_writer *w) {
    noct_entry *e = &w->entries[w->head.sections];
    if (w->filled)
        flush_block(w);
    e->bytes = w->at - e->offset;
    e->sum = noct_sum(w->sums.data, w->sums.len * sizeof(*w->sums.data));
    w->sums.len = 0;
    w->head.sections++;
}

void noct_put_u32(noct_writer *w, uint32_t value) { noct_put(w, &value, sizeof(value)); }
void noct_put_u64(noct_writer *w, uint64_t value) { noct_put(w, &value, sizeof(value)); }
void noct_put_f64(noct_writer *w, double value) { noct_put(w, &value, sizeof(value)); }

void noct_put_text(noct_writer *w, const char *text) {
    noct_put(w, text ? "+" : "-", 1);
    noct_put(w, text ? text : "", text ? strlen(text) + 1 : 1);
}

void noct_put_array(noct_writer *w, const char *name, const void *data, size_t count, size_t size) {
    noct_begin(w, name);
    noct_put(w, data, count * size);
    noct_end(w);
}

uint32_t noct_name(noct_writer *w, const char *text) {
    uint64_t number = 0;
    if (!text || w->status)
        return 0;
    if (w->last_name == text)
        return w->last_number;
    if (!map_get(&w->names, text, &number)) {
        number = w->name_table.len;
        size_t bytes = strlen(text) + 1;
        if (number + bytes > UINT32_MAX)
            w->status = noc_error(w->log, NOC_ERR_UNSUPPORTED, "%s: the city's names have more than 4 GB", w->out.path);
        else if (!array_append(&w->name_table, text, bytes) || !map_put(&w->names, text, number, NULL))
            w->status = noc_no_memory(w->log, w->out.path);
    }
    w->last_name = text;
    return w->last_number = (uint32_t)number;
}

/* Sums and the head, which make a file of it. */
static void finish(noct_writer *w) {
    uint8_t page[NOCT_HEAD] = { 0 };
    noct_put_array(w, NOCT_NAMES, w->name_table.data, w->name_table.len, 1);
    w->head.size = w->at;
    memcpy(page, &w->head, sizeof(w->head));
    memcpy(page + sizeof(w->head), w->entries, w->head.sections * sizeof(*w->entries));
    w->head.sum = noct_sum(page, sizeof(page));
    memcpy(page, &w->head, sizeof(w->head));
    if (!w->status && fseeko(w->out.file, 0, SEEK_SET))
        w->status = output_failed(&w->out, w->log);
    emit(w, page, sizeof(page));
}

noc_status noct_close(noct_writer *w, noc_status status) {
    if (!status && !w->status)
        finish(w);
    status = output_close(&w->out, status ? status : w->status, w->log);
    array_free(&w->sums);
    array_free(&w->name_table);
    map_free(&w->names);
    free(w->block);
    free(w);
    return status;
}
