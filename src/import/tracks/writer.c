#include "import/tracks/tracks.h"

#include <math.h>
#include <nocturne/text.h>

void track_writer_start(track_writer *w, geo_sink *sink, noc_stream *stream) {
    *w = (track_writer){ .sink = sink, .place = noc_stream_name(stream), .budget = noc_stream_budget(stream) };
}

void track_writer_free(track_writer *w) {
    array_free(&w->parts);
    array_free(&w->xyz);
    array_free(&w->seconds);
}

void track_begin(track_writer *w, const char *id) {
    track_end(w);
    w->tracks++;
    if (*id)
        noc_text_clean(w->id, sizeof(w->id), id);
    else
        noc_snprintf(w->id, sizeof(w->id), "track %zu", w->tracks);
}

static void refuse(track_writer *w) {
    if (!w->status)
        w->status = noc_no_memory(w->sink->log, w->place);
}

void track_point(track_writer *w, double x, double y, double seconds) {
    if (w->status)
        return;
    if (!isfinite(x) || !isfinite(y) || (w->geographic && (fabs(x) > 180 || fabs(y) > 90))) {
        geo_issue(w->sink->issues, GEO_SKIPPED, "point of a track without a place", w->id);
        return;
    }
    const double xyz[3] = { x, y, 0 };
    if (!array_append(&w->xyz, xyz, (size_t)3) || !array_push(&w->seconds, seconds)) {
        refuse(w);
        return;
    }
    w->part++;
    w->timed += isfinite(seconds) != 0;
    if (w->seconds.len % 65536 == 0)
        w->status = import_affords(w->budget, 64.0 * (double)w->seconds.len, w->place, "a track of it", w->sink->log);
}

void track_end_part(track_writer *w) {
    if (w->part >= 2 && !array_push(&w->parts, w->part))
        refuse(w);
    for (; w->part == 1; w->part = 0) { /* a point alone */
        w->timed -= isfinite(w->seconds.data[w->seconds.len - 1]) != 0;
        w->seconds.len--;
        w->xyz.len -= 3;
    }
    w->part = 0;
}

void track_end(track_writer *w) {
    track_end_part(w);
    if (*w->id && !w->status && !w->parts.len)
        geo_issue(w->sink->issues, GEO_SKIPPED, "track of fewer than two points", w->id);
    const geo_track track = { w->id, w->parts.len, w->parts.data, w->xyz.data,
                              w->timed == w->seconds.len ? w->seconds.data : NULL };
    if (*w->id && !w->status && w->parts.len) {
        if (w->timed && !track.seconds)
            geo_issue(w->sink->issues, GEO_GUESSED, "track with times at some of its points alone", w->id);
        w->status = w->sink->track(w->sink->ctx, &track);
    }
    w->parts.len = w->xyz.len = w->seconds.len = w->timed = 0;
    w->id[0] = 0;
}
