/* The report of the load that a built city comes from. A table has the fields of its files. */
#include "import/built/built.h"

typedef enum field_kind { FIELD_SIZE, FIELD_U64, FIELD_DOUBLE, FIELD_BOOL, FIELD_CHAR, FIELD_TEXT } field_kind;

typedef struct field {
    field_kind kind;
    size_t offset, count, size;
} field;
#define FIELD(kind, name, n)                                                                                           \
    { FIELD_##kind, offsetof(noc_report_file, name), n, sizeof(((noc_report_file *)0)->name) }

/* All but lines, columns, and the seconds of the load: the same inputs make the same bytes.
 * tests/import/test_built.c finds what is missing here. */
static const field fields[] = {
    FIELD(TEXT, path, 1),
    FIELD(TEXT, format, 1),
    FIELD(TEXT, crs, 1),
    FIELD(TEXT, crs_given, 1),
    FIELD(BOOL, crs_taken, 1),
    FIELD(BOOL, crs_overridden, 1),
    FIELD(DOUBLE, height_unit, 1),
    FIELD(TEXT, height_unit_by, 1),
    FIELD(U64, bytes, 1),
    FIELD(U64, bytes_read, 1),
    FIELD(BOOL, has_extent, 1),
    FIELD(BOOL, degrees, 1),
    FIELD(DOUBLE, extent_min, 3),
    FIELD(DOUBLE, extent_max, 3),
    FIELD(SIZE, objects, 1),
    FIELD(SIZE, buildings, 1),
    FIELD(SIZE, polygons, 1),
    FIELD(SIZE, polygons_by_class, NOC_CLASS_COUNT),
    FIELD(SIZE, lod_used, 5),
    FIELD(SIZE, triangles, 1),
    FIELD(SIZE, lamps, 1),
    FIELD(SIZE, lights, 1),
    FIELD(SIZE, tracks, 1),
    FIELD(SIZE, cars, 1),
    FIELD(SIZE, images, 1),
    FIELD(SIZE, windows.windows, 1),
    FIELD(SIZE, windows.own, 1),
    FIELD(SIZE, windows.lit, 1),
    FIELD(SIZE, windows.buildings, NOC_USE_COUNT),
    FIELD(SIZE, windows.walls, NOC_WALL_VERDICT_COUNT),
    FIELD(DOUBLE, windows.area, NOC_WALL_VERDICT_COUNT),
    FIELD(SIZE, points, 1),
    FIELD(SIZE, lamp_heads, 1),
    FIELD(SIZE, lamps_with_height, 1),
    FIELD(SIZE, lamps_with_lumens, 1),
    FIELD(SIZE, lamps_with_watts, 1),
    FIELD(SIZE, lamps_with_colour, 1),
    FIELD(SIZE, lamps_with_direction, 1),
    FIELD(SIZE, lamps_with_kelvin, 1),
    FIELD(DOUBLE, lamp_height_min, 1),
    FIELD(DOUBLE, lamp_height_max, 1),
    FIELD(DOUBLE, lamp_lumens_min, 1),
    FIELD(DOUBLE, lamp_lumens_max, 1),
    FIELD(DOUBLE, lamp_watts_min, 1),
    FIELD(DOUBLE, lamp_watts_max, 1),
    FIELD(DOUBLE, lamp_kelvin_min, 1),
    FIELD(DOUBLE, lamp_kelvin_max, 1),
    FIELD(CHAR, decimal_sign, 1),
    FIELD(SIZE, lamps_by_source, NOC_SOURCE_COUNT),
    FIELD(SIZE, lamps_assumed, NOC_LAMP_DEFAULT_COUNT),
    FIELD(SIZE, lamps_mapped, 1),
    FIELD(SIZE, lamps_moved, 1),
    FIELD(SIZE, lamps_dropped, 1),
    FIELD(SIZE, lamps_repeated, 1),
    FIELD(SIZE, objects_repeated, 1),
    FIELD(SIZE, map_points, 1),
    FIELD(SIZE, map_lines, 1),
    FIELD(SIZE, map_areas, 1),
    FIELD(SIZE, buildings_unread, 1),
    FIELD(SIZE, streets_unread, 1),
    FIELD(SIZE, roads, 1),
    FIELD(SIZE, roads_lit, 1),
    FIELD(SIZE, railways, 1),
    FIELD(DOUBLE, road_metres, 1),
    FIELD(DOUBLE, road_metres_lit, 1),
};

uint64_t built_report_layout(void) {
    return noct_sum(fields, sizeof(fields)) + sizeof(noc_report_file) + sizeof(report_panes);
}

/* Of a field's values; items of an array lie side by side. */
static size_t item_size(const field *f) { return f->size / f->count; }

/* A file's name: where its user keeps it is nobody else's business. */
static const char *last_name(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash && slash[1] ? slash + 1 : path;
}

static void put_field(noct_writer *w, const field *f, const noc_report_file *file) {
    const char *at = (const char *)file + f->offset;
    for (size_t i = 0; i < f->count; i++, at += item_size(f)) {
        const char *text;
        switch (f->kind) {
        case FIELD_SIZE: noct_put_u64(w, *(const size_t *)(const void *)at); break;
        case FIELD_U64: noct_put_u64(w, *(const uint64_t *)(const void *)at); break;
        case FIELD_DOUBLE: noct_put_f64(w, *(const double *)(const void *)at); break;
        case FIELD_BOOL: noct_put_u32(w, *(const bool *)(const void *)at); break;
        case FIELD_CHAR: noct_put_u32(w, (unsigned char)*at); break;
        case FIELD_TEXT:
            memcpy(&text, at, sizeof(text));
            noct_put_text(w, text && f->offset == offsetof(noc_report_file, path) ? last_name(text) : text);
            break;
        }
    }
}

static void put_columns(noct_writer *w, const noc_report_file *file) {
    noct_put_u64(w, file->column_count);
    for (size_t i = 0; i < file->column_count; i++) {
        const noc_report_column *c = &file->columns[i];
        noct_put_text(w, c->name);
        noct_put_text(w, c->field);
        noct_put_text(w, c->unit);
        noct_put_text(w, c->example);
        noct_put_u64(w, c->values);
        noct_put_u32(w, c->mapped);
    }
}

static void put_lines(noct_writer *w, const noc_report_file *file) {
    noct_put_u64(w, file->line_count);
    for (size_t i = 0; i < file->line_count; i++) {
        const noc_report_line *l = &file->lines[i];
        noct_put_text(w, l->reason);
        noct_put_text(w, l->examples);
        noct_put_u64(w, l->count);
        noct_put_u32(w, l->repaired);
        noct_put_u32(w, l->lossless);
    }
}

_Static_assert(offsetof(noc_report, profiles) - offsetof(noc_report, lamps_inferred) == 4 * sizeof(size_t),
               "each number of a report is written and read below");

void built_write_report(noct_writer *w, const noc_report *report) {
    if (!report)
        return;
    noct_begin(w, "report");
    noct_put_u64(w, report->lamps_inferred);
    noct_put_u64(w, report->road_cars);
    noct_put_u64(w, report->roads_drawn);
    noct_put_u64(w, report->images_reduced);
    noct_put_text(w, report->profiles);
    noct_put_u64(w, report->rule_count);
    for (size_t i = 0; i < report->rule_count; i++) {
        noct_put_text(w, last_name(report->rules[i].place));
        noct_put_u64(w, report->rules[i].lamps);
    }
    noct_put_u64(w, report->files.len);
    for (size_t i = 0; i < report->files.len; i++) {
        for (size_t k = 0; k < NOC_COUNT(fields); k++)
            put_field(w, &fields[k], &report->files.data[i]);
        put_columns(w, &report->files.data[i]);
        put_lines(w, &report->files.data[i]);
    }
    noct_end(w);
    noct_put_array(w, "panes", report->panes.data, report->panes.len, sizeof(*report->panes.data));
}

/* ---- reading ---- */

/* In the report's own memory, as the file's goes with the scene. */
static const char *get_text(noct_cursor *c, noc_report *report) {
    return arena_strdup(&report->arena, noct_get_text(c));
}

static void get_field(noct_cursor *c, const field *f, noc_report *report, noc_report_file *file) {
    char *at = (char *)file + f->offset;
    for (size_t i = 0; i < f->count; i++, at += item_size(f)) {
        const char *text;
        switch (f->kind) {
        case FIELD_SIZE: *(size_t *)(void *)at = (size_t)noct_get_u64(c); break;
        case FIELD_U64: *(uint64_t *)(void *)at = noct_get_u64(c); break;
        case FIELD_DOUBLE: *(double *)(void *)at = noct_get_f64(c); break;
        case FIELD_BOOL: *(bool *)(void *)at = noct_get_u32(c) != 0; break;
        case FIELD_CHAR: *at = (char)noct_get_u32(c); break;
        case FIELD_TEXT:
            text = get_text(c, report);
            memcpy(at, &text, sizeof(text));
            break;
        }
    }
}

/* How many follow, each of so many bytes or more. */
static size_t get_count(noct_cursor *c, size_t least) {
    uint64_t count = noct_get_u64(c);
    c->bad = c->bad || count > (size_t)(c->end - c->at) / least;
    return c->bad ? 0 : (size_t)count;
}

static void get_columns(noct_cursor *c, noc_report *report, noc_report_file *file) {
    file->column_count = get_count(c, 20);
    noc_report_column *columns = arena_alloc(&report->arena, file->column_count * sizeof(*columns));
    for (size_t i = 0; i < file->column_count && columns; i++) {
        columns[i].name = get_text(c, report);
        columns[i].field = get_text(c, report);
        columns[i].unit = get_text(c, report);
        columns[i].example = get_text(c, report);
        columns[i].values = (size_t)noct_get_u64(c);
        columns[i].mapped = noct_get_u32(c) != 0;
        c->bad = c->bad || !columns[i].name || !columns[i].field || !columns[i].unit || !columns[i].example;
    }
    file->columns = columns;
}

static void get_lines(noct_cursor *c, noc_report *report, noc_report_file *file) {
    file->line_count = get_count(c, 20);
    noc_report_line *lines = arena_alloc(&report->arena, file->line_count * sizeof(*lines));
    for (size_t i = 0; i < file->line_count && lines; i++) {
        lines[i].reason = get_text(c, report);
        lines[i].examples = get_text(c, report);
        lines[i].count = (size_t)noct_get_u64(c);
        lines[i].repaired = noct_get_u32(c) != 0;
        lines[i].lossless = noct_get_u32(c) != 0;
        c->bad = c->bad || !lines[i].reason || !lines[i].examples;
    }
    file->lines = lines;
}

static void get_rules(noct_cursor *c, noc_report *report) {
    report->rule_count = get_count(c, 10);
    noc_report_rule *rules = arena_alloc(&report->arena, report->rule_count * sizeof(*rules));
    for (size_t i = 0; i < report->rule_count && rules; i++) {
        rules[i].place = get_text(c, report);
        rules[i].lamps = (size_t)noct_get_u64(c);
        c->bad = c->bad || !rules[i].place;
    }
    report->rules = rules;
}

noc_status built_read_report(noct_file *f, noc_report *report) {
    noct_cursor c = noct_section(f, "report");
    if (!c.at)
        return NOC_OK; /* it was saved without */
    report->lamps_inferred = (size_t)noct_get_u64(&c);
    report->road_cars = (size_t)noct_get_u64(&c);
    report->roads_drawn = (size_t)noct_get_u64(&c);
    report->images_reduced = (size_t)noct_get_u64(&c);
    const char *profiles = noct_get_text(&c);
    noc_snprintf(report->profiles, sizeof(report->profiles), "%s", profiles ? profiles : "");
    get_rules(&c, report);
    size_t files = get_count(&c, NOC_COUNT(fields));
    for (size_t i = 0; i < files && !c.bad; i++) {
        noc_report_file file = { 0 };
        for (size_t k = 0; k < NOC_COUNT(fields); k++)
            get_field(&c, &fields[k], report, &file);
        get_columns(&c, report, &file);
        get_lines(&c, report, &file);
        c.bad = c.bad || !file.path || !file.format || !file.crs || !file.crs_given || !file.height_unit_by;
        if (report->arena.refused || (!c.bad && !array_push(&report->files, file)))
            return noct_no_memory(f);
    }
    if (report->arena.refused)
        return noct_no_memory(f);
    noct_read_whole(f, &c, "report");
    size_t count;
    const report_panes *panes = noct_array(f, "panes", sizeof(*panes), &count);
    for (size_t i = 0; i < count; i++)
        if (panes[i].file >= report->files.len || panes[i].counts > 1)
            return noct_wrong(f, "windows %zu are of no file", i);
    return f->status || array_append(&report->panes, panes, count) ? f->status : noct_no_memory(f);
}

/* ---- joining ---- */

static const char *copy(noc_report *to, const char *text) { return arena_strdup(&to->arena, text ? text : ""); }

static void copy_texts(noc_report *to, noc_report_file *file) {
    for (size_t k = 0; k < NOC_COUNT(fields); k++) {
        char *at = (char *)file + fields[k].offset;
        const char *text;
        if (fields[k].kind != FIELD_TEXT)
            continue;
        memcpy(&text, at, sizeof(text));
        text = copy(to, text);
        memcpy(at, &text, sizeof(text));
    }
}

static void copy_lists(noc_report *to, noc_report_file *file) {
    noc_report_column *columns = arena_alloc(&to->arena, file->column_count * sizeof(*columns));
    for (size_t i = 0; i < file->column_count && columns; i++) {
        columns[i] = file->columns[i];
        columns[i].name = copy(to, columns[i].name);
        columns[i].field = copy(to, columns[i].field);
        columns[i].unit = copy(to, columns[i].unit);
        columns[i].example = copy(to, columns[i].example);
    }
    file->columns = columns;
    noc_report_line *lines = arena_alloc(&to->arena, file->line_count * sizeof(*lines));
    for (size_t i = 0; i < file->line_count && lines; i++) {
        lines[i] = file->lines[i];
        lines[i].reason = copy(to, lines[i].reason);
        lines[i].examples = copy(to, lines[i].examples);
    }
    file->lines = lines;
}

/* Lamps of a rule that both have are counted together. */
static void join_rules(noc_report *to, const noc_report *from) {
    noc_report_rule *rules = arena_alloc(&to->arena, (to->rule_count + from->rule_count) * sizeof(*rules));
    size_t count = to->rule_count;
    if (!rules)
        return;
    if (count)
        memcpy(rules, to->rules, count * sizeof(*rules));
    for (size_t i = 0; i < from->rule_count; i++) {
        size_t k = 0;
        while (k < to->rule_count && strcmp(rules[k].place, from->rules[i].place))
            k++;
        if (k < to->rule_count)
            rules[k].lamps += from->rules[i].lamps;
        else
            rules[count++] =
                (noc_report_rule){ .place = copy(to, from->rules[i].place), .lamps = from->rules[i].lamps };
    }
    to->rules = rules;
    to->rule_count = count;
}

bool built_join_report(noc_report *to, const noc_report *from, const bool *taken, size_t windows) {
    size_t first = to->files.len;
    to->lamps_inferred += from->lamps_inferred;
    to->road_cars += from->road_cars;
    to->roads_drawn += from->roads_drawn;
    to->images_reduced += from->images_reduced;
    if (!*to->profiles)
        memcpy(to->profiles, from->profiles, sizeof(to->profiles));
    join_rules(to, from);
    for (size_t i = 0; i < from->files.len; i++) {
        noc_report_file file = from->files.data[i];
        copy_texts(to, &file);
        copy_lists(to, &file);
        if (to->arena.refused || !array_push(&to->files, file))
            return false;
    }
    for (size_t i = 0, w = 0; i < from->panes.len; i++) {
        const report_panes *p = &from->panes.data[i];
        for (size_t end = w + p->panes; w < end && w < windows; w++)
            if (taken[w] && !report_pane(to, first + p->file, p->counts))
                return false;
    }
    return !to->arena.refused;
}
