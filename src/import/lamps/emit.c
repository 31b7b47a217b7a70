/* What all readers of lamps do with a feature once they have its tags and its place. */
#include "import/lamps/tags.h"

#include <math.h>

noc_status lamp_writer_start(lamp_writer *w, geo_sink *sink, const char *place, const noc_import_params *params) {
    *w = (lamp_writer){ .sink = sink, .place = place, .keys = lamp_keys_create(params) };
    if (w->keys && lamp_keys_count_unread(w->keys))
        return NOC_OK;
    lamp_writer_free(w);
    return noc_no_memory(sink->log, place);
}

void lamp_writer_free(lamp_writer *w) {
    lamp_keys_destroy(w->keys);
    lamp_kinds_free(&w->kinds);
    w->keys = NULL;
}

noc_status lamp_writer_crs(lamp_writer *w, const char *crs) {
    /* tuples come to us in easting northing order already: traditional GIS order, whatever the authority says */
    bool lat_first = false;
    return w->sink->crs(w->sink->ctx, crs ? crs : "", w->place, &lat_first);
}

static bool on_earth(double lon, double lat) { return fabs(lon) <= 180 && fabs(lat) <= 90; }

/* A lamp in use whose place is none. */
static noc_status lose(lamp_writer *w, const char *reason, const char *id) {
    geo_issue(w->sink->issues, GEO_SKIPPED, reason, id);
    if (w->sink->lamps_lost)
        ++*w->sink->lamps_lost;
    w->lost++;
    return NOC_OK;
}

/* One that has something else where its coordinates should be: counted with that. */
static noc_status lose_broken(lamp_writer *w, const char *id) {
    char *told = noc_format("%.60s %.60s", id ? id : "", w->broken);
    if (!told)
        return noc_no_memory(w->sink->log, w->place);
    noc_status status = lose(w, "lamp whose coordinates are not numbers", told);
    free(told);
    return status;
}

/* Of a table every row is noted, of tagged maps the lamps. Names with an @ are ours. */
static void note(lamp_writer *w, const lamp_tag *tags, size_t count, bool lamp) {
    if (!lamp && !w->inventory && !w->strange)
        return;
    for (size_t i = 0; i < count; i++)
        if (tags[i].key[0] != '@')
            lamp_keys_note(w->keys, &tags[i]);
}

noc_status lamp_writer_point(lamp_writer *w, const lamp_tag *tags, size_t count, const char *id, const double xyz[3]) {
    w->features++;
    double x = xyz[0], y = xyz[1], z = xyz[2];
    lamp_verdict verdict = w->strange ? LAMP_NONE : lamp_verdict_of(w->keys, tags, count, w->inventory);
    if (verdict == LAMP_ACTIVE && w->asked && !lamp_is_told(w->keys, tags, count))
        verdict = LAMP_ABSENT;
    w->points += verdict != LAMP_NONE || w->strange;
    w->strange_points += w->strange;
    note(w, tags, count, verdict != LAMP_NONE);
    if (verdict == LAMP_NONE)
        return NOC_OK;
    /* 0: written for want of a height */
    geo_lamp lamp = { .xyz = { x, y, isfinite(z) && z != 0 ? z : NAN }, .id = id };
    if (!lamp_read(w->keys, tags, count, &lamp, verdict == LAMP_ACTIVE ? w->sink->issues : NULL))
        return noc_no_memory(w->sink->log, w->place);
    if (!lamp_accept(verdict, lamp.id, w->sink->issues))
        return NOC_OK;
    if (lamp_unnamed_status(w->keys, tags, count)) {
        geo_issue(w->sink->issues, GEO_SKIPPED,
                  "lamp not in use by a column without a name: --lamp-columns status=#N says which it is", lamp.id);
        return NOC_OK;
    }
    if (w->kinds.any && !lamp_kinds_tell(&w->kinds, tags, count)) {
        geo_issue(w->sink->issues, GEO_SKIPPED, "point that is called something other than a lamp", lamp.id);
        return NOC_OK;
    }
    if (w->broken)
        return lose_broken(w, lamp.id);
    if (!isfinite(x) || !isfinite(y))
        return lose(w, "lamp without a place", lamp.id);
    if (w->no_crs)
        return lose(w, "lamp without a CRS, in a file that names several", lamp.id);
    if (w->geographic && !on_earth(x, y)) {
        w->off_earth++;
        w->exchangeable += on_earth(y, x);
        return lose(w, "lamp whose longitude or latitude is out of range", lamp.id);
    }
    if (x == 0 && y == 0)
        return lose(w, "lamp at 0, 0: no place given", lamp.id);
    w->lamps++;
    return w->sink->lamp(w->sink->ctx, &lamp);
}

/* ---- what is not read ---- */

/* By geometry, then of OpenStreetMap. What is left of buildings and streets where they are read has causes of its own.
 */
enum { BUILDINGS = GEO_DIMENSIONS, STREETS, PARTS, OUTLINES, STREETS_LEFT, UNREAD };
static const struct {
    const char *one, *many, *reason, *reason_with_roads;
} unread[UNREAD] = {
    [GEO_POINTS] = { "set of points", "sets of points", "set of points that is not read: a lamp is a single one" },
    [GEO_LINES] = { "line", "lines", "line that is not read: of maps only lamps are read",
                    "line that is not read: of maps only lamps and roads are read" },
    [GEO_AREAS] = { "polygon", "polygons",
                    "polygon that is not read: of maps only lamps are, and with --footprints buildings" },
    [BUILDINGS] = { "building", "buildings", "building that is not read: --footprints does" },
    [STREETS] = { "street or path", "streets and paths",
                  "street or path that is not read: of maps only lamps are read" },
    [PARTS] = { "part of a building, which lies in its outline", "parts of buildings, which lie in outlines",
                "part of a building, which lies in its outline, not read" },
    [OUTLINES] = { "outline that is not whole or underground", "outlines that are not whole or underground",
                   "outline of a building that is not whole or underground, not read" },
    [STREETS_LEFT] = { "street or path that is an area or not in use", "streets and paths that are areas or not in use",
                       "street or path that is an area or not in use, not read" },
};

static const char *reason_of(const lamp_writer *w, int what) {
    const char *with_roads = unread[what].reason_with_roads;
    return w->sink->road && with_roads ? with_roads : unread[what].reason;
}

void lamp_writer_unread(lamp_writer *w, int dimension, const char *id, const double box[4]) {
    w->seen.unread[dimension]++;
    geo_issue(w->sink->issues, GEO_SKIPPED, reason_of(w, dimension), id);
    for (int k = 0; k < 2 && box; k++) {
        w->seen.lo[k] = w->seen.any ? NOC_MIN(w->seen.lo[k], box[2 * k]) : box[2 * k];
        w->seen.hi[k] = w->seen.any ? NOC_MAX(w->seen.hi[k], box[2 * k + 1]) : box[2 * k + 1];
    }
    w->seen.any |= box != NULL;
}

/* "1,899" */
static void put_count(char text[32], uint64_t n) {
    char digits[24], *out = text;
    int size = noc_snprintf(digits, sizeof(digits), "%llu", (unsigned long long)n);
    for (int i = 0; i < size; i++) {
        if (i && (size - i) % 3 == 0)
            *out++ = ',';
        *out++ = digits[i];
    }
    *out = 0;
}

/* Says once what of the map is not read; the report of whoever inspects it tells the same. How many there are. */
static uint64_t tell_unread(lamp_writer *w) {
    const geo_features *f = &w->seen;
    const geo_sink *sink = w->sink;
    bool blocks = sink->footprint != NULL, roads = sink->road != NULL;
    uint64_t parts = NOC_MIN(f->parts, f->buildings);
    const uint64_t counts[UNREAD] = {
        f->unread[GEO_POINTS],
        f->unread[GEO_LINES],
        f->unread[GEO_AREAS],
        blocks ? 0 : f->buildings,
        roads ? 0 : f->streets,
        blocks ? parts : 0,
        blocks ? f->buildings - parts : 0,
        roads ? f->streets : 0,
    };
    char list[400] = "", kinds[80] = "", number[32];
    uint64_t sum = 0, strange = 0;
    for (int i = 0, n = 0; i < UNREAD; i++) {
        if (!counts[i])
            continue;
        put_count(number, counts[i]);
        n += noc_snprintf(list + n, sizeof(list) - (size_t)n, "%s%s %s",
                          !sum        ? ""
                          : i < PARTS ? ", "
                                      : "; ",
                          number, counts[i] == 1 ? unread[i].one : unread[i].many);
        sum += counts[i];
        strange += i < PARTS ? counts[i] : 0; /* kinds of which nothing is read */
        if (i >= GEO_DIMENSIONS)
            geo_issues_add(sink->issues, GEO_SKIPPED, reason_of(w, i), counts[i], "");
    }
    if (strange)
        noc_snprintf(kinds, sizeof(kinds), ": of maps only lamps%s%s are read%s", roads ? " and roads" : "",
                     blocks ? " and buildings" : "",
                     !blocks && (f->unread[GEO_AREAS] || f->buildings) ? ", and with --footprints buildings" : "");
    if (sum && !sink->inspect)
        noc_warn(sink->log, "%s: %s %s not read%s", w->place, list, sum == 1 ? "is" : "are", kinds);
    return sum;
}

noc_status lamp_writer_end(lamp_writer *w) {
    noc_log *log = w->sink->log;
    lamp_kinds_note(&w->kinds, w->keys);
    noc_status status = lamp_keys_report(w->keys, w->sink, w->place, w->points);
    uint64_t others = tell_unread(w);
    w->seen.any = w->seen.any && !w->lamps;
    if (!status && w->sink->features)
        status = w->sink->features(w->sink->ctx, &w->seen);
    if (status)
        return status;
    if (w->off_earth > w->lamps && w->exchangeable == w->off_earth)
        return noc_error(
            log, NOC_ERR_FORMAT,
            "%s: its coordinates are no longitudes and latitudes; with the two exchanged all %zu are: exchange them in "
            "the file",
            w->place, w->off_earth);
    if (w->off_earth > w->lamps)
        return noc_error(
            log, NOC_ERR_FORMAT,
            "%s: its coordinates are no longitudes and latitudes, and it names no other CRS; give one with --crs",
            w->place);
    if (w->lost && !w->lamps)
        return NOC_OK; /* the importer says that none of its lamps is of use */
    if (w->lamps || w->footprints || w->streets || w->rails)
        return NOC_OK;
    if (w->strange_points && !w->sink->inspect)
        return noc_error(
            log, NOC_ERR_FORMAT,
            "%s: nothing tells that its %zu points are lamps: if they are, say --lamps %s (nocturne info shows its "
            "columns, --lamp-columns says what they mean)",
            w->place, w->strange_points, w->place);
    if (w->sink->named_lamps && !w->features)
        return noc_error(log, NOC_ERR_FORMAT, "%s: named with --lamps, but it holds no points", w->place);
    if (w->features && !w->strange_points)
        noc_warn(log, "%s: none of its %zu %s is a street lamp in use", w->place, w->features,
                 others ? "points" : "features");
    else if (!w->features && !others)
        noc_warn(log, "%s: no tag and no column of it tells of street lamps", w->place);
    return NOC_OK;
}
