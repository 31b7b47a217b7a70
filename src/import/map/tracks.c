/* Tracks with times in maps that the user names as tracks: lines that tell when each of their points was reached, as
 * togeojson writes them (https://github.com/placemark/togeojson: `coordTimes`, or `times` in `coordinateProperties`),
 * and points that tell when they were. */
#include "import/map/features.h"

#if NOC_HAVE_GDAL

#include <math.h>
#include <stdio.h>

static const char *const lists[] = { "times", "coordTimes", "coordinateProperties", "timestamps" };

/* ---- times ---- */

typedef struct unread_text {
    const char *text;
    size_t left;
} unread_text;

static size_t pull(void *buffer, size_t size, void *user) {
    unread_text *t = user;
    size_t n = NOC_MIN(size, t->left);
    memcpy(buffer, t->text, n);
    t->text += n;
    t->left -= n;
    return n;
}

/* Lists in lists are one. False: memory was refused. */
static bool take_values(map_reading *m, const json_t *value) {
    if (json_is_object(value))
        value = json_object_get(value, lists[0]);
    bool kept = true;
    if (!json_is_array(value)) {
        double seconds = json_is_number(value)   ? json_number_value(value)
                         : json_is_string(value) ? track_time(json_string_value(value))
                                                 : NAN;
        return !value || array_push(&m->times, seconds);
    }
    for (size_t i = 0; i < json_array_size(value) && kept; i++)
        kept = take_values(m, json_array_get(value, i));
    return kept;
}

static bool take_json(map_reading *m, const char *text) {
    unread_text from = { text, strlen(text) };
    json_error_t error;
    json_t *root = import_json_load(pull, &from, 0, &error);
    bool kept = root ? take_values(m, root) : *error.text && json_error_code(&error) != json_error_out_of_memory;
    json_decref(root);
    return kept;
}

/* Into m->times. False: memory was refused. */
static bool take_times(map_reading *m, OGRFeatureH feature, OGRFeatureDefnH defn) {
    bool kept = true;
    m->times.len = 0;
    for (size_t k = 0; k < NOC_COUNT(lists) && !m->times.len && kept; k++) {
        int i = gdal.OGR_FD_GetFieldIndex(defn, lists[k]), count = 0;
        if (i < 0 || !gdal.OGR_F_IsFieldSetAndNotNull(feature, i))
            continue;
        OGRFieldType type = gdal.OGR_Fld_GetType(gdal.OGR_FD_GetFieldDefn(defn, i));
        if (type == OFTStringList) {
            char **texts = gdal.OGR_F_GetFieldAsStringList(feature, i);
            for (; texts && *texts && kept; texts++)
                kept = array_push(&m->times, track_time(*texts));
        } else if (type == OFTIntegerList) {
            const int *numbers = gdal.OGR_F_GetFieldAsIntegerList(feature, i, &count);
            for (int n = 0; n < count && kept; n++)
                kept = array_push(&m->times, (double)numbers[n]);
        } else if (type == OFTInteger64List) {
            const GIntBig *numbers = gdal.OGR_F_GetFieldAsInteger64List(feature, i, &count);
            for (int n = 0; n < count && kept; n++)
                kept = array_push(&m->times, (double)numbers[n]);
        } else if (type == OFTRealList) {
            const double *numbers = gdal.OGR_F_GetFieldAsDoubleList(feature, i, &count);
            for (int n = 0; n < count && kept; n++)
                kept = array_push(&m->times, numbers[n]);
        } else if (type == OFTString) {
            kept = take_json(m, gdal.OGR_F_GetFieldAsString(feature, i));
        }
    }
    return kept;
}

/* Of a field of one time. GDAL makes a type of its own of what looks like one. */
static double time_of(OGRFeatureH feature, OGRFeatureDefnH defn, int i) {
    OGRFieldType type = gdal.OGR_Fld_GetType(gdal.OGR_FD_GetFieldDefn(defn, i));
    int year, month, day, hour, minute, zone;
    float second;
    char text[64];
    if (!gdal.OGR_F_IsFieldSetAndNotNull(feature, i))
        return NAN;
    if (type != OFTDateTime && type != OFTDate)
        return track_time(gdal.OGR_F_GetFieldAsString(feature, i));
    if (!gdal.OGR_F_GetFieldAsDateTimeEx(feature, i, &year, &month, &day, &hour, &minute, &second, &zone))
        return NAN;
    snprintf(text, sizeof(text), "%04d-%02d-%02dT%02d:%02d:%06.3f", year, month, day, hour, minute, (double)second);
    /* quarters of an hour, and 100 is UTC; below 2 it is not known */
    return track_time(text) - (zone < 2 ? 0 : 900.0 * (zone - 100));
}

/* ---- lines ---- */

static size_t count_points(OGRGeometryH g, bool one) {
    size_t points = one ? (size_t)gdal.OGR_G_GetPointCount(g) : 0;
    for (int i = 0; !one && i < gdal.OGR_G_GetGeometryCount(g); i++)
        points += (size_t)gdal.OGR_G_GetPointCount(gdal.OGR_G_GetGeometryRef(g, i));
    return points;
}

noc_status map_read_timed_line(map_reading *m, OGRFeatureH feature, OGRFeatureDefnH defn, bool *is) {
    OGRGeometryH g = gdal.OGR_F_GetGeometryRef(feature);
    bool one = gdal.OGR_GT_Flatten(gdal.OGR_G_GetGeometryType(g)) == wkbLineString;
    *is = false;
    if (!take_times(m, feature, defn))
        return map_no_memory(m);
    if (m->times.len && m->times.len != count_points(g, one))
        geo_issue(m->writer.sink->issues, GEO_GUESSED,
                  "track with more or fewer times than points, driven at one speed", m->tags.id);
    if (!m->times.len || m->times.len != count_points(g, one))
        return NOC_OK;
    *is = true;
    m->writer.streets++;
    track_writer w;
    track_writer_start(&w, m->writer.sink, m->stream);
    w.geographic = m->writer.geographic;
    track_begin(&w, m->tags.id);
    size_t at = 0;
    for (int i = 0; i < (one ? 1 : gdal.OGR_G_GetGeometryCount(g)); i++) {
        OGRGeometryH line = one ? g : gdal.OGR_G_GetGeometryRef(g, i);
        for (int k = 0; k < gdal.OGR_G_GetPointCount(line); k++)
            track_point(&w, gdal.OGR_G_GetX(line, k), gdal.OGR_G_GetY(line, k), m->times.data[at++]);
        track_end_part(&w);
    }
    track_end(&w);
    track_writer_free(&w);
    return w.status;
}

/* ---- points ---- */

static bool find_columns(map_reading *m, OGRFeatureDefnH defn) {
    int count = gdal.OGR_FD_GetFieldCount(defn);
    const char **names = noc_calloc((size_t)count + 1, sizeof(*names));
    for (int i = 0; i < count && names; i++)
        names[i] = gdal.OGR_Fld_GetNameRef(gdal.OGR_FD_GetFieldDefn(defn, i));
    if (names)
        m->track_columns = track_columns_of(names, (size_t)count);
    free(names);
    m->columns_of = names ? defn : NULL;
    return names;
}

noc_status map_read_track_point(map_reading *m, OGRFeatureH feature, OGRFeatureDefnH defn, const double xyz[3],
                                bool *is) {
    if (m->columns_of != defn && !find_columns(m, defn))
        return map_no_memory(m);
    const track_columns *of = &m->track_columns;
    *is = of->time >= 0;
    if (!*is)
        return NOC_OK;
    const char *track = of->track >= 0 ? gdal.OGR_F_GetFieldAsString(feature, of->track) : "";
    if (!track_rows_add(&m->rows, track, xyz[0], xyz[1], time_of(feature, defn, of->time)))
        return map_no_memory(m);
    return m->rows.rows.len % 65536 ? NOC_OK
                                    : import_affords(noc_stream_budget(m->stream), 128.0 * (double)m->rows.rows.len,
                                                     m->writer.place, "its tracks", m->writer.sink->log);
}

noc_status map_end_tracks(map_reading *m) {
    noc_status status = track_rows_emit(&m->rows, m->writer.sink, m->stream, m->writer.geographic);
    track_rows_free(&m->rows);
    m->rows = (track_rows){ 0 };
    return status;
}

#endif
