/* map_columns: counts the columns of a map before GDAL reads it, which compares each new one with all others: 120,000
 * names in 1.7 MB take it minutes. */
#ifndef NOC_IMPORT_MAP_COLUMNS_H
#define NOC_IMPORT_MAP_COLUMNS_H

#include "base/base.h"

enum { MAP_MOST_COLUMNS = 4096, MAP_COLUMN_SLOTS = 4 * MAP_MOST_COLUMNS };

#define MAP_COLUMN_SEED 0xcbf29ce484222325u

/* Names by their hashes: with 4,096 of 64 bits two are alike once in 10^12 files, which then have one fewer. */
typedef struct map_columns {
    uint64_t slot[MAP_COLUMN_SLOTS]; /* 0: free */
    size_t count;
} map_columns;

/* FNV-1a (Fowler, Noll, Vo). */
static inline uint64_t map_column_hash(uint64_t hash, char c) { return (hash ^ (unsigned char)c) * 0x100000001b3u; }

/* Returns false if that makes more than MAP_MOST_COLUMNS. */
static inline bool map_columns_add(map_columns *c, uint64_t hash) {
    hash += !hash;
    size_t at = (hash ^ hash >> 32) % MAP_COLUMN_SLOTS;
    while (c->slot[at] && c->slot[at] != hash)
        at = (at + 1) % MAP_COLUMN_SLOTS;
    if (c->slot[at])
        return true;
    if (c->count == MAP_MOST_COLUMNS)
        return false;
    c->slot[at] = hash;
    c->count++;
    return true;
}

static inline noc_status map_columns_refuse(const char *name, const char *format, noc_log *log) {
    return noc_error(log, NOC_ERR_FORMAT, "%s: %s: more than %d columns", name, format, MAP_MOST_COLUMNS);
}

#endif
