/* What is written into files as text, and whether one can be written at all. */
#include "image/internal.h"

noc_status noc_image_check_path(const char *path, noc_log *log) {
    if (!path)
        return noc_null(log, __func__);
    output o;
    noc_status status = output_open(&o, path, log);
    if (status != NOC_OK)
        return status;
    output_close(&o, NOC_ERR_CANCELLED, log); /* which leaves nothing */
    return NOC_OK;
}

void meta_add(meta_list *list, const char *key, const char *fmt, ...) {
    char text[256];
    va_list ap;
    va_start(ap, fmt);
    noc_vsnprintf(text, sizeof(text), fmt, ap);
    va_end(ap);
    meta_entry entry = { arena_strdup(&list->text, key), arena_strdup(&list->text, text) };
    if (!list->text.refused && !array_push(&list->entries, entry))
        list->text.refused = true; /* told by meta_add_all */
}

void meta_add_long(meta_list *list, const char *key, const char *value) {
    if (!value || !array_push(&list->entries, ((meta_entry){ key, value })))
        list->text.refused = true;
}

static meta_entry *find(meta_list *list, const char *key) {
    for (size_t i = 0; i < list->entries.len; i++)
        if (strcmp(list->entries.data[i].key, key) == 0)
            return &list->entries.data[i];
    return NULL;
}

/* The stricter of the two formats decides: a PNG keyword has 1 to 79 characters and single spaces inside only. */
static bool good_key(const char *key) {
    size_t n = key ? strlen(key) : 0;
    if (n < 1 || n > 79 || key[0] == ' ' || key[n - 1] == ' ' || strstr(key, "  "))
        return false;
    for (size_t i = 0; i < n; i++)
        if (key[i] < 32 || key[i] > 126)
            return false;
    return true;
}

noc_status meta_add_all(meta_list *list, const noc_image_meta *meta, const char *path, noc_log *log) {
    for (size_t i = 0; meta && i < meta->count; i++) {
        if (!good_key(meta->keys[i]) || !meta->values[i])
            return noc_error(log, NOC_ERR_ARGUMENT,
                             "%s: metadata entry %zu: a key has 1 to 79 printable ASCII characters, single "
                             "spaces inside, and a value",
                             path, i);
        meta_entry entry = { meta->keys[i], meta->values[i] }; /* outlive the list */
        meta_entry *old = find(list, entry.key);
        if (old)
            *old = entry;
        else if (!array_push(&list->entries, entry))
            list->text.refused = true;
    }
    return list->text.refused ? noc_no_memory(log, path) : NOC_OK;
}

void meta_free(meta_list *list) {
    array_free(&list->entries);
    arena_free(&list->text);
}
