#include "info.h"

#include <stdlib.h>
#include <string.h>

static void key(const char *name) { printf(",\n    \"%s\": ", name); }

static void text(const char *name, const char *value) {
    key(name);
    cli_json_text(stdout, value);
}

static void number(const char *name, double value) {
    key(name);
    cli_json_number(stdout, value);
}

static void triple(const char *name, const double v[3]) {
    key(name);
    for (int i = 0; i < 3; i++) {
        fputs(i ? ", " : "[", stdout);
        cli_json_number(stdout, v[i]);
    }
    putchar(']');
}

static void classes(const char *name, const size_t counts[NOC_CLASS_COUNT]) {
    key(name);
    const char *before = "{";
    for (int i = 0; i < NOC_CLASS_COUNT; i++) {
        if (counts[i]) {
            printf("%s\"%s\": %zu", before, noc_class_name((noc_class)i), counts[i]);
            before = ", ";
        }
    }
    printf("%s}", *before == '{' ? "{" : "");
}

/* Example ids come as one comma-separated text. */
static void examples(const char *list) {
    putchar('[');
    for (const char *at = list ? list : ""; *at;) {
        size_t n = strcspn(at, ",");
        char *one = cli_format("%.*s", (int)n, at);
        cli_json_text(stdout, one + strspn(one, " "));
        free(one);
        at += n + (at[n] == ',');
        if (*at)
            fputs(", ", stdout);
    }
    putchar(']');
}

static void lines(const noc_report_line *all, size_t count) {
    key("issues");
    putchar('[');
    for (size_t i = 0; i < count; i++) {
        const noc_report_line *line = &all[i];
        printf("%s\n      {\"action\": \"%s\", \"lossless\": %s, \"count\": %zu, \"reason\": ", i ? "," : "",
               info_action(line), line->lossless ? "true" : "false", line->count);
        cli_json_text(stdout, line->reason);
        fputs(", \"examples\": ", stdout);
        examples(line->examples);
        putchar('}');
    }
    putchar(']');
}

static void range(const char *min_name, const char *max_name, size_t count, double min, double max) {
    if (!count)
        return;
    number(min_name, min);
    number(max_name, max);
}

static void lamp_details(const noc_report_file *file) {
    number("lamp_heads", (double)file->lamp_heads);
    number("lamps_with_height", (double)file->lamps_with_height);
    number("lamps_with_lumens", (double)file->lamps_with_lumens);
    number("lamps_with_watts", (double)file->lamps_with_watts);
    number("lamps_with_colour", (double)file->lamps_with_colour);
    number("lamps_with_direction", (double)file->lamps_with_direction);
    number("lamps_with_kelvin", (double)file->lamps_with_kelvin);
    range("lamp_height_min", "lamp_height_max", file->lamps_with_height, file->lamp_height_min, file->lamp_height_max);
    range("lamp_lumens_min", "lamp_lumens_max", file->lamps_with_lumens, file->lamp_lumens_min, file->lamp_lumens_max);
    range("lamp_watts_min", "lamp_watts_max", file->lamps_with_watts, file->lamp_watts_min, file->lamp_watts_max);
    range("lamp_kelvin_min", "lamp_kelvin_max", file->lamps_with_kelvin, file->lamp_kelvin_min, file->lamp_kelvin_max);
    number("lamps_height_assumed", (double)file->lamps_assumed[NOC_LAMP_HEIGHT]);
    number("lamps_flux_assumed", (double)file->lamps_assumed[NOC_LAMP_FLUX]);
    number("lamps_colour_assumed", (double)file->lamps_assumed[NOC_LAMP_COLOUR]);
    number("lamps_direction_assumed", (double)file->lamps_assumed[NOC_LAMP_DIRECTION]);
    number("lamps_efficacy_assumed", (double)file->lamps_assumed[NOC_LAMP_EFFICACY]);
    key("lamps_by_source");
    const char *before = "{";
    for (int s = 0; s < NOC_SOURCE_COUNT; s++) {
        if (file->lamps_by_source[s]) {
            printf("%s\"%s\": %zu", before, noc_lamp_source_name((noc_lamp_source)s), file->lamps_by_source[s]);
            before = ", ";
        }
    }
    putchar('}');
}

static void columns(const noc_report_file *file) {
    key("columns");
    putchar('[');
    for (size_t i = 0; i < file->column_count; i++) {
        const noc_report_column *c = &file->columns[i];
        const char *const texts[][2] = {
            { "name", c->name }, { "field", c->field }, { "unit", c->unit }, { "example", c->example }
        };
        for (size_t k = 0; k < sizeof(texts) / sizeof(*texts); k++) {
            printf("%s\"%s\": ", k ? ", " : i ? ",\n      {" : "\n      {", texts[k][0]);
            cli_json_text(stdout, texts[k][1]);
        }
        printf(", \"values\": %zu, \"mapped\": %s}", c->values, c->mapped ? "true" : "false");
    }
    putchar(']');
}

static void windows(const noc_window_counts *w) {
    double area = 0;
    number("windows", (double)w->windows);
    number("windows_own", (double)w->own);
    number("windows_lit", (double)w->lit);
    key("buildings_by_use");
    for (int u = 0; u < NOC_USE_COUNT; u++)
        printf("%s\"%s\": %zu", u ? ", " : "{", noc_building_use_name((noc_building_use)u), w->buildings[u]);
    putchar('}');
    for (int v = NOC_WALL_TAKEN; v < NOC_WALL_VERDICT_COUNT; v++) {
        static const char *const names[] = { "taken", "small", "tilted", "party", "bare", "own" };
        char name[40];
        snprintf(name, sizeof(name), "walls_%s", names[v - NOC_WALL_TAKEN]);
        number(name, (double)w->walls[v]);
        snprintf(name, sizeof(name), "wall_area_%s", names[v - NOC_WALL_TAKEN]);
        number(name, w->area[v]);
        area += w->area[v];
    }
    if (area > 0) {
        number("windows_per_100_m2", 100 * (double)w->windows / area);
        number("windows_lit_per_100_m2", 100 * (double)w->lit / area);
    }
}

static void report_file(const noc_report_file *file, bool timing) {
    text("format", file->format);
    text("crs", file->crs);
    text("crs_given", file->crs_given);
    if (file->height_unit > 0) {
        number("height_unit", file->height_unit);
        text("height_unit_by", file->height_unit_by);
    }
    const char *from = *file->crs_given ? "file" : file->crs_taken ? "format" : *file->crs ? "option" : "";
    text("crs_from", file->crs_overridden ? "option" : from);
    number("bytes", (double)file->bytes);
    number("bytes_unpacked", (double)file->bytes_read);
    if (timing)
        number("seconds", file->seconds);
    if (file->has_extent) {
        triple("extent_min", file->extent_min);
        triple("extent_max", file->extent_max);
    }
    number("objects", (double)file->objects);
    number("buildings", (double)file->buildings);
    key("buildings_by_lod");
    for (int i = 0; i < 5; i++)
        printf("%s%zu", i ? ", " : "[", file->lod_used[i]);
    putchar(']');
    number("polygons", (double)file->polygons);
    classes("polygons_by_class", file->polygons_by_class);
    number("triangles", (double)file->triangles);
    number("lamps", (double)file->lamps);
    if (file->lamps)
        lamp_details(file);
    if (file->column_count) {
        number("points", (double)file->points);
        columns(file);
        text("decimal_sign", (char[]){ file->decimal_sign == '?' ? 0 : file->decimal_sign, 0 });
    }
    number("tracks", (double)file->tracks);
    number("lights", (double)file->lights);
    windows(&file->windows);
    number("map_points", (double)file->map_points);
    number("map_lines", (double)file->map_lines);
    number("map_areas", (double)file->map_areas);
    number("buildings_unread", (double)file->buildings_unread);
    number("streets_unread", (double)file->streets_unread);
    number("roads", (double)file->roads);
    number("roads_lit", (double)file->roads_lit);
    number("road_metres", file->road_metres);
    number("road_metres_lit", file->road_metres_lit);
    number("railways", (double)file->railways);
    lines(file->lines, file->line_count);
}

void info_json_file(const char *path, const char *error, const noc_report_file *file, const noc_scene_info *scene,
                    bool timing) {
    fputs("  {\"path\": ", stdout);
    cli_json_text(stdout, path);
    if (error)
        text("error", error);
    if (file)
        report_file(file, timing);
    if (scene) {
        text("format", "built-in scene");
        triple("extent_min", scene->bounds_min);
        triple("extent_max", scene->bounds_max);
        number("triangles", (double)scene->triangles);
        classes("triangles_by_class", scene->triangles_by_class);
        number("transparent_triangles", (double)scene->transparent_triangles);
        number("lights", (double)scene->lights);
    }
    putchar('}');
}

static void rules(const noc_report *report) {
    const noc_report_rule *rule;
    key("rules");
    putchar('[');
    for (size_t i = 0; (rule = noc_report_get_rule(report, i)); i++) {
        printf("%s{\"place\": ", i ? ", " : "");
        cli_json_text(stdout, rule->place);
        printf(", \"lamps\": %zu}", rule->lamps);
    }
    putchar(']');
}

/* The first one has the lights of none. */
static void groups(const noc_report *report) {
    const noc_group_info *g;
    key("groups");
    putchar('[');
    for (size_t i = 0; (g = noc_report_get_group(report, i)); i++) {
        printf("%s{\"name\": ", i ? ", " : "");
        if (i)
            cli_json_text(stdout, g->name);
        else
            fputs("null", stdout);
        printf(", \"lights\": %zu, \"lumens\": ", g->lights);
        cli_json_number(stdout, g->lumens);
        putchar('}');
    }
    putchar(']');
}

noc_status info_json_city(const info_city *city, const info_args *args) {
    noc_status status = NOC_OK;
    const noc_scene_info *info = &city->info;
    const noc_report_totals *t = &city->totals;
    printf("{\"files\": %zu", noc_report_file_count(city->report));
    text("crs", info->given_crs);
    triple("extent_min", info->bounds_min);
    triple("extent_max", info->bounds_max);
    number("objects", (double)t->objects);
    number("buildings", (double)t->buildings);
    number("triangles", (double)info->triangles);
    classes("triangles_by_class", info->triangles_by_class);
    number("transparent_triangles", (double)info->transparent_triangles);
    number("instances", (double)info->instances);
    number("instance_triangles", (double)info->instance_triangles);
    windows(&t->windows);
    number("sky", info_sky(args));
    number("sky_sqm", noc_sky_sqm(info_sky(args)));
    number("lights", (double)info->lights);
    number("lamps_mapped", (double)t->lamps_mapped);
    number("lamps_moved", (double)t->lamps_moved);
    number("lamps_inferred", (double)t->lamps_inferred);
    number("lamps_dropped", (double)t->lamps_dropped);
    number("lamps_repeated", (double)t->lamps_repeated);
    number("maintenance", info->maintenance);
    rules(city->report);
    groups(city->report);
    number("tracks", (double)t->tracks);
    number("cars", (double)t->cars);
    number("cars_along_roads", (double)t->road_cars);
    number("features_skipped", (double)t->skipped);
    number("features_repaired", (double)t->repaired);
    number("features_guessed", (double)t->guessed);
    size_t count;
    noc_report_line *issues = cli_issues(city->report, &count);
    lines(issues, count);
    free(issues);
    number("scene_bytes", (double)info->memory_bytes);
    if (args->each_lamp) {
        fputs(", \"lamps\": ", stdout);
        status = info_lamps(city, true);
    }
    if (args->timing) {
        number("bytes_unpacked", (double)t->bytes_read);
        number("seconds", city->seconds);
        number("peak_bytes", (double)cli_peak_memory());
    }
    putchar('}');
    return status;
}
