/* Tables of track points: which columns say of which track a row is and when; rows may come in any order of tracks. */
#include "import/tracks/tracks.h"

#include <math.h>
#include <stdlib.h>

static bool is_name(const char *name, const char *const *words) {
    char folded[32];
    size_t n = 0;
    for (; *name && n + 1 < sizeof(folded); name++)
        if (*name != '_' && *name != ' ' && *name != '-')
            folded[n++] = *name;
    folded[n] = 0;
    for (; *words; words++)
        if (noc_ieq(folded, *words))
            return true;
    return false;
}

track_columns track_columns_of(const char *const *names, size_t count) {
    static const char *const tracks[] = { "track",     "trackid", "trackname", "trip", "tripid",  "vehicle",
                                          "vehicleid", "car",     "carid",     "tid",  "segment", NULL };
    static const char *const ids[] = { "id", "name", NULL };
    static const char *const times[] = { "time", "timestamp", "datetime", "t", "seconds", "gpstime", NULL };
    track_columns c = { -1, -1 };
    for (size_t i = 0; i < count; i++) {
        c.track = c.track < 0 && is_name(names[i], tracks) ? (int)i : c.track;
        c.time = c.time < 0 && is_name(names[i], times) ? (int)i : c.time;
    }
    for (size_t i = 0; i < count && c.track < 0; i++)
        c.track = is_name(names[i], ids) ? (int)i : -1;
    return c;
}

bool track_rows_add(track_rows *rows, const char *track, double x, double y, double seconds) {
    uint64_t number = rows->names.len;
    if (!map_get(&rows->tracks, track, &number)) {
        const char *name = arena_strdup(&rows->arena, track);
        if (!name || !map_put(&rows->tracks, track, number, NULL) || !array_push(&rows->names, name))
            return false;
    }
    return array_push(&rows->rows, (track_row){ x, y, seconds, (uint32_t)number, (uint32_t)rows->rows.len });
}

static int compare_rows(const void *a, const void *b) {
    const track_row *x = a, *y = b;
    if (x->track != y->track)
        return x->track < y->track ? -1 : 1;
    return (x->order > y->order) - (x->order < y->order);
}

noc_status track_rows_emit(track_rows *rows, geo_sink *sink, noc_stream *stream, bool geographic) {
    track_writer w;
    track_writer_start(&w, sink, stream);
    w.geographic = geographic;
    if (rows->rows.len > 1)
        qsort(rows->rows.data, rows->rows.len, sizeof(track_row), compare_rows);
    for (size_t i = 0; i < rows->rows.len && !w.status; i++) {
        const track_row *r = &rows->rows.data[i];
        if (!i || r->track != r[-1].track)
            track_begin(&w, rows->names.data[r->track]);
        track_point(&w, r->x, r->y, r->seconds);
    }
    track_end(&w);
    track_writer_free(&w);
    return w.status;
}

void track_rows_free(track_rows *rows) {
    array_free(&rows->rows);
    array_free(&rows->names);
    map_free(&rows->tracks);
    arena_free(&rows->arena);
}
