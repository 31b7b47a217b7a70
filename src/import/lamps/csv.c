/* Tables of lamps with a header line: commas, semicolons, tabs or bars, quotes as in RFC 4180, UTF-8 or Latin-1. */
#include "import/lamps/tags.h"
#include "import/tracks/tracks.h"

#include <math.h>
#include <stdio.h>

#define MAX_FIELD (1 << 20)
#define MAX_FIELDS 4096

typedef struct csv {
    noc_stream *stream;
    noc_log *log;
    char separator;
    bool special[2][256]; /* bytes that are not just part of a field's text, outside quotes and within */
    char chunk[1 << 16];
    size_t len, pos;
    size_t line; /* where the present record began, from 1 */
    size_t next_line;
    NOC_ARRAY(char) text; /* fields of the record, each ended by a 0 */
    NOC_ARRAY(size_t) start;
    bool ended;
} csv;

/* Next byte, -1 at the end, -2 on an error that was reported. */
static int next_byte(csv *c, noc_status *status) {
    if (c->pos == c->len) {
        c->pos = 0;
        *status = noc_stream_read(c->stream, c->chunk, sizeof(c->chunk), &c->len);
        if (*status || !c->len) {
            c->len = 0;
            return *status ? -2 : -1;
        }
    }
    return (unsigned char)c->chunk[c->pos++];
}

/* How many of the next bytes are a field's text and nothing else; 0 where the next one must be looked at, or read. */
static size_t plain_run(const csv *c, bool quoted) {
    const bool *special = c->special[quoted];
    size_t end = c->pos;
    while (end < c->len && !special[(unsigned char)c->chunk[end]])
        end++;
    return end - c->pos;
}

static noc_status bad(csv *c, const char *cause) {
    return noc_error(c->log, NOC_ERR_FORMAT, "%s:%zu: %s", noc_stream_name(c->stream), c->line, cause);
}

static noc_status no_memory(csv *c) { return noc_no_memory(c->log, noc_stream_name(c->stream)); }

/* Reads a record; at the end of the table leaves no fields. */
static noc_status read_record(csv *c) {
    noc_status status = NOC_OK;
    c->text.len = c->start.len = 0;
    c->line = c->next_line;
    bool quoted = false, was_quoted = false;
    for (size_t field = 0;;) {
        size_t run = plain_run(c, quoted);
        if (run) {
            if (c->text.len - field + run > MAX_FIELD + 1)
                return bad(c, "a field longer than 1 MB");
            if (!array_append(&c->text, c->chunk + c->pos, run))
                return no_memory(c);
            c->pos += run;
            was_quoted = false;
            continue;
        }
        int ch = next_byte(c, &status);
        if (ch == -2)
            return status;
        if (ch == -1 && quoted)
            return bad(c, "a quote is not closed before the end of the file");
        if (ch == -1 && !c->start.len && c->text.len == 0)
            return NOC_OK;
        if (ch == 0)
            return bad(c, "a zero byte: this is no text");
        if (ch == '\n')
            c->next_line++;
        bool end_record = ch == -1 || (ch == '\n' && !quoted);
        if (quoted && ch == '"') {
            quoted = false; /* a second one, at once, is a quote in the text */
            was_quoted = true;
            continue;
        }
        if (!quoted && ch == '"' && (c->text.len == field || was_quoted)) {
            if (was_quoted && !array_push(&c->text, '"'))
                return no_memory(c);
            quoted = true;
            was_quoted = false;
            continue;
        }
        was_quoted = false;
        if (!end_record && (quoted || ch != c->separator)) {
            if (c->text.len - field > MAX_FIELD)
                return bad(c, "a field longer than 1 MB");
            if (!array_push(&c->text, (char)ch))
                return no_memory(c);
            continue;
        }
        if (end_record && c->text.len > field && c->text.data[c->text.len - 1] == '\r')
            c->text.len--;
        if (c->start.len == MAX_FIELDS)
            return bad(c, "more than 4096 columns");
        if (!array_push(&c->text, '\0') || !array_push(&c->start, field))
            return no_memory(c);
        field = c->text.len;
        if (end_record)
            return NOC_OK;
    }
}

static const char *field(const csv *c, size_t i) { return c->text.data + c->start.data[i]; }

/* The separator that is found most often in the first line, outside quotes; 0 if there is none. */
static char find_separator(const char *head, size_t size) {
    static const char separators[] = ",;\t|";
    size_t count[4] = { 0 };
    bool quoted = false;
    for (size_t i = 0; i < size && head[i] && (quoted || head[i] != '\n'); i++) {
        const char *s = strchr(separators, head[i]);
        quoted ^= head[i] == '"';
        if (s && !quoted)
            count[s - separators]++;
    }
    int best = 0;
    for (int i = 1; i < 4; i++)
        if (count[i] > count[best])
            best = i;
    return count[best] ? separators[best] : 0;
}

typedef struct columns {
    lamp_keys *keys; /* NULL: by the words alone */
    char **names;    /* owned */
    size_t count;
    int lon, lat, x, y, wkt, lat_lon, z; /* -1: none */
    double z_scale;
    bool tags, inventory, asked;
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

/* What the columns of a table's first line are, and how many; 0 if it is none. Probes take no memory, so that none is
 * refused. */
static size_t probe_columns(const char *head, size_t size, bool has[LAMP_FIELD_TOTAL]) {
    if (size >= 3 && !memcmp(head, "\xef\xbb\xbf", 3)) {
        head += 3;
        size -= 3;
    }
    size_t line = 0;
    while (line < size && head[line] && head[line] != '\n')
        line++;
    char separator = find_separator(head, size);
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
    if (cols->lon >= 0 && cols->lat >= 0)
        return lamp_coordinate(field(c, (size_t)cols->lon), x) && lamp_coordinate(field(c, (size_t)cols->lat), y);
    if (cols->lat_lon >= 0)
        return two_numbers(field(c, (size_t)cols->lat_lon), y, x);
    if (cols->wkt >= 0)
        return read_wkt(field(c, (size_t)cols->wkt), x, y);
    return lamp_coordinate(field(c, (size_t)cols->x), x) && lamp_coordinate(field(c, (size_t)cols->y), y);
}

static noc_status no_place(csv *c, const columns *cols) {
    char names[300] = ""; /* as many as fit on a line */
    size_t n = 0, i = 0;
    for (; i < cols->count && n < 200; i++)
        n += (size_t)noc_snprintf(names + n, sizeof(names) - n, "%s%.40s", i ? ", " : "", cols->names[i]);
    return noc_error(c->log, NOC_ERR_FORMAT,
                     "%s:%zu: no columns with coordinates (longitude and latitude, or x and y) in the header: it "
                     "has %s%s. Say which they are: --lamp-columns lon=A,lat=B or x=A,y=B",
                     noc_stream_name(c->stream), c->line, names, i < cols->count ? ", ..." : "");
}

/* Opens the table: header read, the next record is the first row. */
static noc_status read_header(csv *c, columns *cols) {
    noc_status status = noc_stream_rewind(c->stream);
    if (status)
        return status;
    c->pos = c->len = 0;
    c->next_line = 1;
    status = noc_stream_read(c->stream, c->chunk, sizeof(c->chunk), &c->len);
    if (status)
        return status;
    if (c->len >= 3 && !memcmp(c->chunk, "\xef\xbb\xbf", 3))
        c->pos = 3;
    c->separator = find_separator(c->chunk + c->pos, c->len - c->pos);
    for (int quoted = 0; quoted < 2; quoted++) {
        memset(c->special[quoted], 0, sizeof(c->special[quoted]));
        c->special[quoted][0] = c->special[quoted]['\n'] = c->special[quoted]['"'] = true;
    }
    c->special[0][(unsigned char)c->separator] = true;
    status = read_record(c);
    if (status || cols->count)
        return status;
    cols->names = noc_calloc(c->start.len + 1, sizeof(*cols->names));
    for (; cols->names && cols->count < c->start.len; cols->count++)
        if (!(cols->names[cols->count] = noc_strdup(field(c, cols->count))))
            break;
    if (!cols->names || cols->count < c->start.len)
        return no_memory(c);
    understand(cols);
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
    while (!outside && !(status = read_record(c)) && c->start.len) {
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
    if (c->start.len == 1 && !*field(c, 0))
        return false; /* an empty line */
    if (c->start.len != cols->count) {
        geo_issue(w->sink->issues, GEO_SKIPPED, "row with too few or too many columns", row);
        return false;
    }
    for (size_t i = 0; i < cols->count; i++)
        tags[i].value = field(c, i);
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
    for (size_t row = 0; row < ROWS && !(status = read_record(c)) && c->start.len; row++)
        for (size_t i = 0; i < cols->count && c->start.len == cols->count; i++) {
            tags[i].value = field(c, i);
            lamp_keys_weigh(cols->keys, &tags[i]);
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
    while (!status && !(status = read_record(c)) && c->start.len) {
        for (size_t i = 0; i < cols->count && c->start.len == cols->count; i++)
            tags[i].value = field(c, i);
        if (c->start.len == cols->count && !lamp_kinds_count(kinds, tags, cols->count))
            status = no_memory(c);
    }
    free(tags);
    lamp_kinds_decide(kinds);
    return status ? status : read_header(c, cols);
}

static noc_status read_rows(csv *c, const columns *cols, lamp_writer *w) {
    lamp_tag *tags = column_tags(cols);
    if (!tags)
        return no_memory(c);
    noc_status status;
    while (!(status = read_record(c)) && c->start.len) {
        char row[32];
        name_row(row, c->line);
        if (!row_tags(c, cols, w, row, tags))
            continue;
        double xyz[3];
        if (!read_place(c, cols, &xyz[0], &xyz[1]))
            xyz[0] = xyz[1] = NAN;
        if (cols->z < 0 || !lamp_coordinate(field(c, (size_t)cols->z), &xyz[2]))
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
    return status;
}

/* A table that the user names as tracks: a row is a point of one. */
static noc_status read_track_rows(csv *c, const columns *cols, geo_sink *sink, track_rows *rows) {
    const track_columns of = track_columns_of((const char *const *)cols->names, cols->count);
    noc_status status;
    while (!(status = read_record(c)) && c->start.len) {
        char row[32];
        double x, y;
        name_row(row, c->line);
        if (c->start.len == 1 && !*field(c, 0))
            continue;
        if (c->start.len != cols->count) {
            geo_issue(sink->issues, GEO_SKIPPED, "row with too few or too many columns", row);
            continue;
        }
        if (!read_place(c, cols, &x, &y)) {
            geo_issue(sink->issues, GEO_SKIPPED, "point of a track without a place", row);
            continue;
        }
        const char *track = of.track >= 0 ? field(c, (size_t)of.track) : "";
        if (!track_rows_add(rows, track, x, y, of.time >= 0 ? track_time(field(c, (size_t)of.time)) : NAN))
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
        w->inventory = w->kinds.any;
        w->strange = !w->kinds.any;
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
    array_free(&c->text);
    array_free(&c->start);
    free(c);
    return status;
}
