/* Tables of lamps, with a header line unless the user says which columns hold their places: commas, semicolons, tabs or
 * bars, quotes as in RFC 4180, UTF-8, UTF-16 or Latin-1. */
#include "import/lamps/records.h"
#include "import/lamps/tags.h"
#include "import/tracks/tracks.h"

#include <math.h>
#include <stdio.h>

static noc_status no_memory(csv *c) { return noc_no_memory(c->log, noc_stream_name(c->stream)); }

typedef struct columns {
    lamp_keys *keys; /* NULL: by the words alone */
    char **names;    /* owned */
    size_t count;
    int lon, lat, x, y, wkt, lat_lon, z; /* -1: none */
    double z_scale;
    bool tags, inventory, asked;
    bool headless; /* the first line is a row */
    bool placed;   /* a row has a place */
} columns;

static int find_column(const columns *cols, lamp_field wanted) {
    int best = -1, best_rank = 0;
    for (size_t i = 0; i < cols->count; i++) {
        lamp_meaning m = lamp_keys_meaning(cols->keys, cols->names[i]);
        if (m.field == wanted && (best < 0 || m.rank < best_rank)) {
            best = (int)i;
            best_rank = m.rank;
        }
    }
    return best;
}

static bool have_place(const bool has[LAMP_FIELD_TOTAL]) {
    return (has[LAMP_FIELD_LON] && has[LAMP_FIELD_LAT]) || (has[LAMP_FIELD_X] && has[LAMP_FIELD_Y]) ||
           has[LAMP_FIELD_WKT] || has[LAMP_FIELD_LAT_LON];
}

static void understand(columns *cols) {
    cols->lon = find_column(cols, LAMP_FIELD_LON);
    cols->lat = find_column(cols, LAMP_FIELD_LAT);
    cols->x = find_column(cols, LAMP_FIELD_X);
    cols->y = find_column(cols, LAMP_FIELD_Y);
    cols->wkt = find_column(cols, LAMP_FIELD_WKT);
    cols->lat_lon = find_column(cols, LAMP_FIELD_LAT_LON);
    cols->z = find_column(cols, LAMP_FIELD_ELEVATION);
    cols->z_scale = cols->z >= 0 ? lamp_keys_meaning(cols->keys, cols->names[cols->z]).scale : 1;
    for (size_t i = 0; i < cols->count; i++)
        cols->tags |= lamp_key_tells(cols->names[i]);
    const char *const *names = (const char *const *)cols->names;
    cols->inventory = !cols->tags && lamp_columns_tell(cols->keys, names, cols->count);
    cols->asked = !cols->tags && !cols->inventory && lamp_columns_ask(cols->keys, names, cols->count);
}

static void free_columns(columns *cols) {
    for (size_t i = 0; i < cols->count; i++)
        free(cols->names[i]);
    free(cols->names);
}

enum { PROBED = 8192 }; /* bytes of UTF-16 that are looked at */

/* Of UTF-16 the beginning as UTF-8, in `decoded`. Returns its size. */
static size_t decode_head(const char **head, size_t size, char *decoded) {
    utf16 units = { .order = utf16_order_of(*head, size) };
    if (!units.order)
        return size;
    size = utf16_decode(&units, *head, NOC_MIN(size, PROBED), decoded);
    *head = decoded;
    return size;
}

/* What the columns of a table's first line are, and how many; 0 if it is none. Probes take no memory, so that none is
 * refused. */
static size_t probe_columns(const char *head, size_t size, bool has[LAMP_FIELD_TOTAL]) {
    char decoded[PROBED * 3 / 2 + 6];
    size = decode_head(&head, size, decoded);
    if (size >= 3 && !memcmp(head, "\xef\xbb\xbf", 3)) {
        head += 3;
        size -= 3;
    }
    size_t line = 0;
    while (line < size && head[line] && head[line] != '\n')
        line++;
    char separator = csv_separator(head, size);
    if (!separator || (line < size && !head[line]) || *head == '{' || *head == '<')
        return 0;
    size_t count = 0;
    for (size_t from = 0, to; from < line; from = to + 1) {
        for (to = from; to < line && head[to] != separator && head[to] != '\r';)
            to++;
        char name[256]; /* folding drops the quotes, and looks at the beginning */
        noc_snprintf(name, sizeof(name), "%.*s", (int)NOC_MIN(to - from, sizeof(name) - 1), head + from);
        count += to > from;
        has[to > from ? lamp_meaning_of(name).field : LAMP_FIELD_NONE] = true;
    }
    return count;
}

bool lamp_csv_probe(const char *head, size_t size) {
    bool has[LAMP_FIELD_TOTAL] = { false };
    return probe_columns(head, size, has) && have_place(has);
}

/* Text in lines, of which the first is cut by a separator. */
bool lamp_csv_probe_table(const char *head, size_t size) {
    char decoded[PROBED * 3 / 2 + 6];
    size = decode_head(&head, size, decoded);
    for (size_t i = 0; i < size; i++)
        if ((unsigned char)head[i] < ' ' && !strchr("\t\r\n", head[i]))
            return false;
    bool has[LAMP_FIELD_TOTAL];
    return memchr(head, '\n', size) && probe_columns(head, size, has) > 1;
}

/* Numbers in "POINT (x y)" (any dimension) or "(lat, lon)". */
static bool two_numbers(const char *text, double *a, double *b) {
    char copy[128];
    size_t n = 0;
    const char *p = text;
    while (*p && n + 1 < sizeof(copy)) {
        if (strchr("0123456789.-+eE", *p))
            copy[n++] = *p;
        else if (n && copy[n - 1] != ' ')
            copy[n++] = ' ';
        p++;
    }
    copy[n] = 0;
    const char *q = noc_scan_double(copy, copy + n, a);
    return q && noc_scan_double(q, copy + n, b);
}

static bool read_wkt(const char *text, double *x, double *y) {
    const char *p = strstr(text, "POINT");
    if (!p)
        p = strstr(text, "Point");
    p = p ? strchr(p, '(') : NULL;
    return p && two_numbers(p, x, y);
}

static bool read_place(const csv *c, const columns *cols, double *x, double *y) {
    *x = *y = NAN;
    if (cols->lon < 0 && cols->lat_lon >= 0 && lamp_coordinates(csv_field(c, (size_t)cols->lat_lon), y, x))
        return true;
    if (cols->lon >= 0 && cols->lat >= 0)
        return lamp_coordinate(csv_field(c, (size_t)cols->lon), x) &&
               lamp_coordinate(csv_field(c, (size_t)cols->lat), y);
    if (cols->lat_lon >= 0)
        return two_numbers(csv_field(c, (size_t)cols->lat_lon), y, x);
    if (cols->wkt >= 0)
        return read_wkt(csv_field(c, (size_t)cols->wkt), x, y);
    return lamp_coordinate(csv_field(c, (size_t)cols->x), x) && lamp_coordinate(csv_field(c, (size_t)cols->y), y);
}

static noc_status no_place(csv *c, const columns *cols) {
    char names[300] = ""; /* as many as fit on a line */
    size_t n = 0, i = 0;
    for (; i < cols->count && n < 200; i++)
        n += (size_t)noc_snprintf(names + n, sizeof(names) - n, "%s%.40s", i ? ", " : "", cols->names[i]);
    return noc_error(c->log, NOC_ERR_FORMAT,
                     "%s:%zu: no columns with coordinates (longitude and latitude, or x and y) in the header: it "
                     "has %s%s. Say which they are: --lamp-columns lon=A,lat=B or x=A,y=B, by name or number (#1)",
                     noc_stream_name(c->stream), c->line, names, i < cols->count ? ", ..." : "");
}

/* A column is called as the header has it, or by its number where the user calls it so ("#2"). To be freed. */
static char *column_name(const csv *c, const columns *cols, size_t i) {
    return lamp_keys_number(cols->keys, i + 1) ? noc_format("#%zu", i + 1) : noc_strdup(csv_field(c, i));
}

/* A decimal number, one of metres, or one with signs: no name of a column, as 1, 2, 3 may be. */
static bool is_place(const char *text) {
    double value;
    return lamp_coordinate(text, &value) && (strpbrk(text, ".,'\xb0\xba") || fabs(value) >= 1000);
}

/* Is the header a row, by what the user says of its columns? */
static bool is_row(const csv *c, const columns *cols) {
    double a, b;
    int x = cols->lon >= 0 ? cols->lon : cols->x, y = cols->lat >= 0 ? cols->lat : cols->y;
    if (x >= 0 && y >= 0)
        return lamp_coordinate(csv_field(c, (size_t)x), &a) && lamp_coordinate(csv_field(c, (size_t)y), &b) &&
               (is_place(csv_field(c, (size_t)x)) || is_place(csv_field(c, (size_t)y)));
    if (cols->wkt >= 0)
        return read_wkt(csv_field(c, (size_t)cols->wkt), &a, &b);
    return cols->lat_lon >= 0 && two_numbers(csv_field(c, (size_t)cols->lat_lon), &a, &b);
}

/* Opens the table: header read, the next record is the first row. */
static noc_status read_header(csv *c, columns *cols) {
    noc_status status = csv_start(c);
    if (status)
        return status;
    status = csv_read(c);
    c->again = cols->headless;
    if (status || cols->count)
        return status;
    cols->names = noc_calloc(c->start.len + 1, sizeof(*cols->names));
    for (; cols->names && cols->count < c->start.len; cols->count++)
        if (!(cols->names[cols->count] = column_name(c, cols, cols->count)))
            break;
    if (!cols->names || cols->count < c->start.len)
        return no_memory(c);
    understand(cols);
    cols->headless = c->again = is_row(c, cols);
    if (cols->headless) {
        noc_info(c->log, "%s: it has no header: its first line is a row", noc_stream_name(c->stream));
        lamp_keys_headless(cols->keys);
        cols->tags = false;
        understand(cols);
    }
    bool has[LAMP_FIELD_TOTAL] = { false };
    for (size_t i = 0; i < cols->count; i++)
        has[lamp_keys_meaning(cols->keys, cols->names[i]).field] = true;
    return have_place(has) ? NOC_OK : no_place(c, cols);
}

/* Columns called x and y without a CRS: degrees if every one of them could be, and none of them lies where `given`
 * (NULL if there is none) is for. --crs is often meant for the city beside the table. One that cannot be is enough to
 * know. */
static noc_status looks_like_degrees(csv *c, columns *cols, geo_crs *given, bool *degrees) {
    size_t inside = 0, outside = 0;
    noc_status status = NOC_OK;
    while (!outside && !(status = csv_read(c)) && c->start.len) {
        double x, y;
        if (c->start.len != cols->count || !read_place(c, cols, &x, &y))
            continue;
        if (fabs(x) <= 180 && fabs(y) <= 90 && !(given && geo_crs_outside(given, x, y) == 0))
            inside++;
        else
            outside++;
    }
    *degrees = inside > 0 && outside == 0;
    return status ? status : read_header(c, cols);
}

static noc_status settle_crs(csv *c, columns *cols, lamp_writer *w, const noc_import_params *params) {
    bool degrees = (cols->lon >= 0 && cols->lat >= 0) || cols->lat_lon >= 0;
    noc_status status = NOC_OK;
    geo_crs *given = params && params->crs && *params->crs ? geo_crs_create(params->crs, "--crs", NULL, &status) : NULL;
    if (status == NOC_ERR_MEMORY)
        return no_memory(c);
    status = NOC_OK; /* who uses it says what is wrong with it */
    if (!degrees && !(given && geo_crs_is_geographic(given))) {
        status = looks_like_degrees(c, cols, given, &degrees);
        if (!status && degrees)
            noc_info(c->log, "%s: its coordinates name no CRS and lie within 180 by 90: taken as WGS 84 degrees",
                     w->place);
    }
    geo_crs_destroy(given);
    if (status)
        return status;
    w->geographic = degrees;
    return lamp_writer_crs(w, degrees ? LAMP_WGS84 : NULL);
}

/* The present record as tags, if it fits the header; false after counting why not. */
static bool row_tags(csv *c, const columns *cols, lamp_writer *w, const char *row, lamp_tag *tags) {
    if (c->start.len == 1 && !*csv_field(c, 0))
        return false; /* an empty line */
    if (c->start.len != cols->count) {
        geo_issue(w->sink->issues, GEO_SKIPPED, "row with too few or too many columns", row);
        return false;
    }
    for (size_t i = 0; i < cols->count; i++)
        tags[i].value = csv_field(c, i);
    return true;
}

/* Tags of the columns, their values open; free() them. NULL where memory is refused. */
static lamp_tag *column_tags(const columns *cols) {
    lamp_tag *tags = noc_calloc(cols->count + 1, sizeof(*tags));
    for (size_t i = 0; i < cols->count && tags; i++)
        tags[i] = (lamp_tag){ .key = cols->names[i], .known = lamp_keys_know(cols->keys, cols->names[i]) };
    return tags;
}

/* "line 123". */
static void name_row(char name[32], size_t line) {
    char digits[24];
    size_t n = 0;
    for (; !n || line; line /= 10)
        digits[n++] = (char)('0' + line % 10);
    char *p = stpcpy(name, "line ");
    while (n)
        *p++ = digits[--n];
    *p = 0;
}

/* By the first rows: which is the decimal sign? Leaves the table at its first row. */
static noc_status find_decimal_sign(csv *c, columns *cols) {
    enum { ROWS = 1000 };
    lamp_tag *tags = column_tags(cols);
    if (!tags)
        return no_memory(c);
    noc_status status = NOC_OK;
    for (size_t row = 0; row < ROWS && !(status = csv_read(c)) && c->start.len; row++)
        for (size_t i = 0; i < cols->count && c->start.len == cols->count; i++) {
            tags[i].value = csv_field(c, i);
            lamp_keys_weigh(cols->keys, &tags[i]);
            lamp_keys_flag(cols->keys, &tags[i]);
        }
    free(tags);
    return status ? status : read_header(c, cols);
}

/* Do the values say what the rows are? Leaves the table at its first row. */
static noc_status read_kinds(csv *c, columns *cols, lamp_kinds *kinds) {
    lamp_tag *tags = column_tags(cols);
    if (!tags)
        return no_memory(c);
    noc_status status = NOC_OK;
    while (!status && !(status = csv_read(c)) && c->start.len) {
        for (size_t i = 0; i < cols->count && c->start.len == cols->count; i++)
            tags[i].value = csv_field(c, i);
        if (c->start.len == cols->count && !lamp_kinds_count(kinds, tags, cols->count))
            status = no_memory(c);
    }
    free(tags);
    lamp_kinds_decide(kinds);
    return status ? status : read_header(c, cols);
}

/* Columns that places were read from. */
static void note_placed(const columns *cols) {
    bool degrees = cols->lon >= 0 && cols->lat >= 0, pair = cols->lat_lon >= 0, wkt = cols->wkt >= 0;
    const int used[] = { degrees ? cols->lon
                         : pair  ? cols->lat_lon
                         : wkt   ? cols->wkt
                                 : cols->x,
                         degrees ? cols->lat
                         : pair  ? cols->lat_lon
                         : wkt   ? cols->wkt
                                 : cols->y };
    for (size_t i = 0; i < NOC_COUNT(used) && cols->placed; i++)
        lamp_keys_placed(cols->keys, cols->names[used[i]]);
}

static noc_status read_rows(csv *c, columns *cols, lamp_writer *w) {
    lamp_tag *tags = column_tags(cols);
    if (!tags)
        return no_memory(c);
    noc_status status;
    while (!(status = csv_read(c)) && c->start.len) {
        char row[32];
        name_row(row, c->line);
        if (!row_tags(c, cols, w, row, tags))
            continue;
        double xyz[3];
        bool placed = read_place(c, cols, &xyz[0], &xyz[1]);
        cols->placed = cols->placed || placed;
        if (!placed)
            xyz[0] = xyz[1] = NAN;
        if (cols->z < 0 || !lamp_coordinate(csv_field(c, (size_t)cols->z), &xyz[2]))
            xyz[2] = NAN;
        xyz[2] *= cols->z_scale;
        status = lamp_writer_point(w, tags, cols->count, row, xyz);
        if (!status && w->features % 1024 == 0 && w->sink->progress &&
            !w->sink->progress(w->sink->ctx, noc_stream_progress(c->stream)))
            status = NOC_ERR_CANCELLED;
        if (status)
            break;
    }
    free(tags);
    note_placed(cols);
    return status;
}

/* A table that the user names as tracks: a row is a point of one. */
static noc_status read_track_rows(csv *c, const columns *cols, geo_sink *sink, track_rows *rows) {
    const track_columns of = track_columns_of((const char *const *)cols->names, cols->count);
    noc_status status;
    while (!(status = csv_read(c)) && c->start.len) {
        char row[32];
        double x, y;
        name_row(row, c->line);
        if (c->start.len == 1 && !*csv_field(c, 0))
            continue;
        if (c->start.len != cols->count) {
            geo_issue(sink->issues, GEO_SKIPPED, "row with too few or too many columns", row);
            continue;
        }
        if (!read_place(c, cols, &x, &y)) {
            geo_issue(sink->issues, GEO_SKIPPED, "point of a track without a place", row);
            continue;
        }
        const char *track = of.track >= 0 ? csv_field(c, (size_t)of.track) : "";
        if (!track_rows_add(rows, track, x, y, of.time >= 0 ? track_time(csv_field(c, (size_t)of.time)) : NAN))
            return no_memory(c);
        size_t count = rows->rows.len;
        if (count % 4096)
            continue;
        status = import_affords(noc_stream_budget(c->stream), 128.0 * (double)count, noc_stream_name(c->stream),
                                "its tracks", c->log);
        if (!status && sink->progress && !sink->progress(sink->ctx, noc_stream_progress(c->stream)))
            status = NOC_ERR_CANCELLED;
        if (status)
            return status;
    }
    return status;
}

static noc_status read_tracks(csv *c, columns *cols, lamp_writer *w, const noc_import_params *params) {
    track_rows rows = { 0 };
    noc_status status = settle_crs(c, cols, w, params);
    if (!status)
        status = read_track_rows(c, cols, w->sink, &rows);
    if (!status)
        status = track_rows_emit(&rows, w->sink, c->stream, w->geographic);
    track_rows_free(&rows);
    return status;
}

/* What tells that the rows are lamps: the user, tags, columns, values, or nothing. */
static noc_status judge(csv *c, columns *cols, lamp_writer *w) {
    noc_status status = NOC_OK;
    w->asked = cols->asked && !w->sink->named_lamps;
    w->inventory = w->sink->named_lamps || cols->inventory || w->asked;
    if (!w->inventory && !cols->tags) {
        status = read_kinds(c, cols, &w->kinds);
        w->inventory = w->kinds.any || w->kinds.models;
        w->strange = !w->inventory;
    }
    return status;
}

noc_status lamp_csv_read(noc_stream *stream, const noc_import_params *params, geo_sink *sink, const char **format) {
    *format = "CSV";
    lamp_writer w;
    csv *c = noc_calloc(1, sizeof(*c));
    noc_status status = c ? lamp_writer_start(&w, sink, noc_stream_name(stream), params)
                          : noc_no_memory(sink->log, noc_stream_name(stream));
    if (status) {
        free(c);
        return status;
    }
    c->stream = stream;
    c->log = sink->log;
    columns cols = { .keys = w.keys };
    status = read_header(c, &cols);
    if (!status)
        status = find_decimal_sign(c, &cols);
    if (!status && sink->decimal_sign && !sink->named_tracks)
        *sink->decimal_sign = lamp_keys_decimal(w.keys) ? lamp_keys_decimal(w.keys) : '?';
    bool tracks = sink->named_tracks;
    if (!status && tracks)
        status = read_tracks(c, &cols, &w, params);
    if (!status && !tracks)
        status = judge(c, &cols, &w);
    if (!status && !tracks && !w.strange)
        status = settle_crs(c, &cols, &w, params);
    if (!status && !tracks)
        status = read_rows(c, &cols, &w);
    if (!status && !tracks)
        status = lamp_writer_end(&w);
    lamp_writer_free(&w);
    free_columns(&cols);
    csv_free(c);
    return status;
}
