/* tracks: ways that cars have gone or are to go, point by point. */
#ifndef NOC_IMPORT_TRACKS_H
#define NOC_IMPORT_TRACKS_H

#include "import/import.h"

#define TRACK_WGS84 "=OGC:CRS84" /* with GEO_CRS_TAKEN: of files that name none */

/* ---- writer.c: puts points together to tracks, and hands those to a sink ---- */

typedef struct track_writer {
    geo_sink *sink;
    const char *place; /* of messages */
    const import_budget *budget;
    char id[64]; /* of the track that is written; "": none is */
    NOC_ARRAY(size_t) parts;
    NOC_ARRAY(double) xyz;
    NOC_ARRAY(double) seconds;
    size_t part;       /* points of the part that is written */
    size_t timed;      /* points of the track with a time */
    size_t tracks;     /* that were begun */
    bool geographic;   /* points are longitude and latitude, and are looked at as such */
    noc_status status; /* not NOC_OK: reported, and nothing more is taken */
} track_writer;

void track_writer_start(track_writer *w, geo_sink *sink, noc_stream *stream);
void track_writer_free(track_writer *w);
/* id: "" for a number of its own. Ends the track before. */
void track_begin(track_writer *w, const char *id);
void track_point(track_writer *w, double x, double y, double seconds); /* seconds: NaN: not told */
void track_end_part(track_writer *w);
void track_end(track_writer *w);

/* ---- table.c ---- */

typedef struct track_columns {
    int track, time; /* -1: none */
} track_columns;
track_columns track_columns_of(const char *const *names, size_t count);

typedef struct track_row {
    double x, y, seconds;
    uint32_t track, order;
} track_row;

typedef struct track_rows {
    NOC_ARRAY(track_row) rows;
    NOC_ARRAY(const char *) names; /* of tracks */
    noc_map tracks;                /* their numbers */
    noc_arena arena;
} track_rows;
/* seconds: NaN: it tells no time. false: memory was refused. */
bool track_rows_add(track_rows *rows, const char *track, double x, double y, double seconds) NOC_MUST_USE;
/* A track's points in the order of its rows. */
noc_status track_rows_emit(track_rows *rows, geo_sink *sink, noc_stream *stream, bool geographic);
void track_rows_free(track_rows *rows);

/* ---- time.c ---- */

/* Seconds since 1970 of a time as XML Schema and ISO 8601 write it ("2013-03-16T14:56:31.69Z", with an offset, or with
 * neither: UTC), or of a number alone. NaN where it is neither. */
double track_time(const char *text);

#endif
