/* nocturne info: what files hold, and what of it is usable. */
#include "info.h"

#include <stdlib.h>
#include <string.h>

#define A info_args
static const noc_option own_options[] = {
    { "json", "Output", NOC_OPTION_BOOL, offsetof(A, json), 0, 1, NULL, "", "print JSON instead of text" },
    { "scene", "Output", NOC_OPTION_SWITCH, offsetof(A, scene), 0, 2, NULL, "",
      "tell of all inputs as one scene, too, as render loads them: buildings, triangles, windows, lamps, what was "
      "skipped; where neither is said, of recipes" },
    { "each-lamp", "Output", NOC_OPTION_BOOL, offsetof(A, each_lamp), 0, 1, NULL, "",
      "a line of CSV for each lamp of the scene, instead of all else: its place, flux, colour, height, profile, road, "
      "the rules that matched it, and whether it is mapped or inferred; with --json beside the rest" },
    { "timing", "Output", NOC_OPTION_BOOL, offsetof(A, timing), 0, 1, NULL, "",
      "tell how long reading took, and with a scene the peak memory" },
    { NULL },
};
static const noc_option *options(void) { return own_options; }
static int run(void *arguments);

static const info_args defaults = { .scene = NOC_SWITCH_AUTO,
                                    .import = noc_import_default_params(),
                                    .builtin = noc_builtin_default_params() };

const cli_command cli_info = {
    "info",
    "INPUT...",
    "Tells what files hold: format, CRS, extent, objects, lamps, and what was skipped or repaired; what the scene of a "
    "recipe or of all inputs holds; of luminaires (IES, EULUMDAT) their flux, peak and zones.",
    "Examples\n"
    "  nocturne info city.gml lamps.geojson\n"
    "  nocturne info --json city.gml.gz\n"
    "  nocturne info --scene --timing city.gml lamps.geojson\n"
    "  nocturne info --each-lamp --infer-lamps map.osm.pbf >lamps.csv\n",
    { { options, 0, NULL },
      { noc_import_options, offsetof(A, import), NULL },
      { noc_city_options, offsetof(A, builtin.city), NULL },
      { noc_builtin_options, offsetof(A, builtin), NULL },
      { cli_common_options, 0, NULL } },
    sizeof(info_args),
    &defaults,
    run,
};

void info_print_counts(const size_t counts[NOC_CLASS_COUNT]) {
    char a[32];
    for (int i = 0; i < NOC_CLASS_COUNT; i++)
        if (counts[i])
            printf("    %-13s %10s\n", noc_class_name((noc_class)i), noc_text_count(a, counts[i]));
}

const char *info_action(const noc_report_line *line) {
    return !line->repaired ? "skipped" : line->lossless ? "repaired" : "guessed";
}

void info_print_lines(const noc_report_line *lines, size_t count, const char *action) {
    char a[32], reason[160]; /* a line holds an id or two; JSON has five */
    bool first = true;
    for (size_t i = 0; i < count; i++) {
        const noc_report_line *line = &lines[i];
        if (strcmp(info_action(line), action))
            continue;
        printf("  %-11s %s x %s", first ? action : "", noc_text_count(a, line->count),
               noc_text_clean(reason, sizeof(reason), line->reason));
        char *ids = cli_ids(line->examples, line->count, CLI_IDS_WIDTH);
        printf("%s%s\n", *ids ? ": " : "", ids);
        free(ids);
        first = false;
    }
}

static void print_source(const noc_report_file *file, bool timing) {
    char a[32], b[32], c[32], text[240];
    printf("  %-11s %s\n", "format",
           noc_text_clean(text, sizeof(text), file->format && *file->format ? file->format : "unknown"));
    printf("  %-11s %s", "size", noc_text_bytes(a, file->bytes));
    if (file->bytes_read > file->bytes)
        printf(", %s unpacked", noc_text_bytes(b, file->bytes_read));
    if (timing)
        printf("; read in %s", noc_text_seconds(c, file->seconds));
    if (timing && file->bytes_read > 1000000 && file->seconds > 0)
        printf(" (%.0f MB/s)", 1e-6 * (double)file->bytes_read / file->seconds);
    bool known = file->crs && *file->crs;
    printf("\n  %-11s %s", "CRS", known ? noc_text_clean(text, sizeof(text), file->crs) : "none");
    const char *how = file->crs_overridden ? "by option, in place of" : "given as";
    if (file->crs_given && *file->crs_given)
        printf(", %s \"%s\"", how, noc_text_clean(text, sizeof(text), file->crs_given));
    else if (file->crs_overridden)
        fputs(", by --file-crs", stdout);
    else if (known)
        printf(", %s", file->crs_taken ? "taken as such: the file names none" : "by --crs");
    else if (file->has_extent)
        printf(" (to put it in place: --crs EPSG:n)");
    putchar('\n');
}

static void print_extent(const noc_report_file *file) {
    const double *lo = file->extent_min, *hi = file->extent_max;
    if (!file->has_extent)
        return;
    int decimals = file->degrees ? 6 : 2;
    printf("  %-11s x %.*f to %.*f, y %.*f to %.*f", "extent", decimals, cli_shown(lo[0], decimals), decimals,
           cli_shown(hi[0], decimals), decimals, cli_shown(lo[1], decimals), decimals, cli_shown(hi[1], decimals));
    if (lo[2] != 0 || hi[2] != 0)
        printf(", z %.2f to %.2f", cli_shown(lo[2], 2), cli_shown(hi[2], 2));
    putchar('\n');
}

/* A unit without a name is told by its metres. */
static void print_heights(const noc_report_file *file) {
    static const struct {
        double metres;
        const char *name;
    } units[] = { { 1, "metres" }, { .3048, "feet" }, { 1200. / 3937, "US survey feet" } };
    const double *lo = file->extent_min, *hi = file->extent_max;
    if (!(file->height_unit > 0) || !file->has_extent || (lo[2] == 0 && hi[2] == 0))
        return;
    printf("  %-11s ", "heights");
    const char *name = NULL;
    for (size_t i = 0; i < sizeof(units) / sizeof(*units); i++)
        if (fabs(file->height_unit / units[i].metres - 1) < 1e-7)
            name = units[i].name;
    if (name)
        printf("in %s, %s\n", name, file->height_unit_by);
    else
        printf("in units of %.7g m, %s\n", file->height_unit, file->height_unit_by);
}

static void print_objects(const noc_report_file *file) {
    char a[32], b[32];
    printf("  %-11s %s", "objects", noc_text_count(a, file->objects));
    if (file->buildings)
        printf(", %s of them buildings", noc_text_count(b, file->buildings));
    const char *before = " (";
    for (int i = 0; i < 5; i++) {
        if (file->lod_used[i]) {
            printf("%s%s in LOD%d", before, noc_text_count(a, file->lod_used[i]), i);
            before = ", ";
        }
    }
    printf("%s\n", *before == ',' ? ")" : "");
}

static void print_lamps(const noc_report_file *file, const noc_import_params *import) {
    char a[32], b[64];
    printf("  %-11s %s", "lamps", noc_text_count(a, file->lamps));
    if (file->lamp_heads != file->lamps)
        printf(" with %s, each a light", noc_text_many(b, file->lamp_heads, "head"));
    putchar('\n');
    const struct {
        const char *name;
        size_t count;
        const char *unit;
        double min, max;
    } known[] = {
        { "height", file->lamps_with_height, "m", file->lamp_height_min, file->lamp_height_max },
        { "lumens", file->lamps_with_lumens, "lm", file->lamp_lumens_min, file->lamp_lumens_max },
        { "watts", file->lamps_with_watts, "W", file->lamp_watts_min, file->lamp_watts_max },
        { "colour", file->lamps_with_colour, file->lamps_with_kelvin ? "K" : NULL, file->lamp_kelvin_min,
          file->lamp_kelvin_max },
        { "direction", file->lamps_with_direction, NULL, 0, 0 },
    };
    for (size_t i = 0; i < sizeof(known) / sizeof(*known); i++) {
        if (!known[i].count)
            continue;
        printf("    %-13s %10s, %.1f%%", known[i].name, noc_text_count(a, known[i].count),
               100.0 * (double)known[i].count / (double)file->lamps);
        if (known[i].unit)
            printf(": %.6g to %.6g %s", known[i].min, known[i].max, known[i].unit);
        putchar('\n');
    }
    for (int s = 0; s < NOC_SOURCE_COUNT; s++)
        if (file->lamps_by_source[s] && (s != NOC_SOURCE_UNKNOWN || file->lamps_by_source[s] != file->lamps))
            printf("    %-13s %10s, %.1f%%\n",
                   s == NOC_SOURCE_UNKNOWN ? "source?" : noc_lamp_source_name((noc_lamp_source)s),
                   noc_text_count(a, file->lamps_by_source[s]),
                   100.0 * (double)file->lamps_by_source[s] / (double)file->lamps);
    cli_print_assumed("  assumed     ", file->lamps_assumed, import);
}

/* How wide printf must make the text to fill that many columns of a terminal: it counts bytes, and of a character of
 * UTF-8 one fills one. */
static int padded(const char *text, int columns) {
    for (; *text; text++)
        columns += ((unsigned char)*text & 0xc0) == 0x80;
    return columns;
}

/* Columns that are used come first. */
static void print_columns(const noc_report_file *file) {
    enum { MOST = 100 }; /* lines of what is not used; JSON has all */
    char name[64], example[64], field[64];
    size_t unused = 0;
    if (file->column_count)
        printf("  %-11s %-24s %-14s %s\n", "columns", "name", "read as", "example");
    for (int used = 1; used >= 0; used--)
        for (size_t i = 0; i < file->column_count; i++) {
            const noc_report_column *c = &file->columns[i];
            if ((*c->field != 0) != used || (!used && unused++ >= MOST))
                continue;
            snprintf(field, sizeof(field), "%s%s%s%s", used ? c->field : "not used", *c->unit ? ", " : "", c->unit,
                     c->mapped ? " *" : "");
            noc_text_clean(name, sizeof(name), c->name);
            printf("    %-9s %-*s %-14s %s\n", "", padded(name, 24), name, field,
                   c->values ? noc_text_clean(example, sizeof(example), c->example) : "(blank)");
        }
    if (unused > MOST)
        printf("    %-9s and %zu more that are not used; --json lists them\n", "", unused - MOST);
}

static void print_points(const noc_report_file *file) {
    char a[32];
    if (file->points && !file->lamps && file->lamps_dropped)
        printf("  %-11s %s, lamps whose places are not understood or lie nowhere\n", "points",
               noc_text_count(a, file->points));
    else if (file->points && !file->lamps)
        printf("  %-11s %s, and nothing tells that they are lamps in use: --lamps FILE says so\n", "points",
               noc_text_count(a, file->points));
    print_columns(file);
    if (file->decimal_sign == '?')
        printf("  %-11s not told by the numbers: 12.000 is read as 12\n", "decimals");
    else if (file->decimal_sign)
        printf("  %-11s behind '%c'; a '%c' before three digits parts thousands\n", "decimals", file->decimal_sign,
               file->decimal_sign == ',' ? '.' : ',');
}

/* What a map holds, read or not. */
static void print_features(const noc_report_file *file) {
    const struct {
        size_t count;
        const char *noun;
    } kinds[] = { { file->map_points, "point" },
                  { file->map_lines, "line" },
                  { file->map_areas, "polygon" },
                  { file->buildings_unread, "building" },
                  { file->streets_unread, "street or path" } };
    const char *before = "  features    ";
    char a[64];
    for (size_t i = 0; i < sizeof(kinds) / sizeof(*kinds); i++)
        if (kinds[i].count) {
            bool streets = i == 4 && kinds[i].count > 1;
            printf("%s%s%s", before,
                   streets ? noc_text_count(a, kinds[i].count) : noc_text_many(a, kinds[i].count, kinds[i].noun),
                   streets ? " streets and paths" : "");
            before = ", ";
        }
    if (*before == ',')
        putchar('\n');
}

static void print_roads(const noc_report_file *file) {
    char a[64], b[64], c[64];
    if (!file->roads && !file->railways)
        return;
    printf("  %-11s %s, %.1f km, %s of them lit, %.1f km; %s\n", "roads", noc_text_count(a, file->roads),
           file->road_metres / 1000, noc_text_count(b, file->roads_lit), file->road_metres_lit / 1000,
           noc_text_many(c, file->railways, "railway"));
}

void info_print_file(const noc_report_file *file, const info_args *args) {
    char a[32], b[64], path[400];
    printf("%s\n", noc_text_clean(path, sizeof(path), file->path));
    print_source(file, args->timing);
    print_extent(file);
    print_heights(file);
    print_features(file);
    print_roads(file);
    bool map = file->roads || file->railways || file->map_points || file->map_lines || file->map_areas ||
               file->buildings_unread || file->streets_unread || file->tracks;
    if (file->objects || (!file->lamps && !map))
        print_objects(file);
    if (file->polygons) {
        printf("  %-11s %s, %s\n", "surfaces", noc_text_count(a, file->polygons),
               noc_text_many(b, file->triangles, "triangle"));
        info_print_counts(file->polygons_by_class);
    } else if (file->triangles) {
        printf("  %-11s %s\n", "triangles", noc_text_count(a, file->triangles));
    }
    cli_print_windows("  windows     ", &file->windows);
    if (file->lamps)
        print_lamps(file, &args->import);
    print_points(file);
    if (file->tracks)
        printf("  %-11s %s of cars\n", "tracks", noc_text_count(a, file->tracks));
    if (file->lights)
        printf("  %-11s %s\n", "lights", noc_text_count(a, file->lights));
    info_print_lines(file->lines, file->line_count, "skipped");
    info_print_lines(file->lines, file->line_count, "repaired");
    info_print_lines(file->lines, file->line_count, "guessed");
}

static void print_scene(const char *name, const noc_scene_info *info) {
    char a[64], b[32];
    printf("%s\n  %-11s built-in scene\n", name, "format");
    printf("  %-11s x %.2f to %.2f, y %.2f to %.2f, z %.2f to %.2f\n", "extent", info->bounds_min[0],
           info->bounds_max[0], info->bounds_min[1], info->bounds_max[1], info->bounds_min[2], info->bounds_max[2]);
    printf("  %-11s %s in %s mesh%s\n", "triangles", noc_text_count(a, info->triangles),
           noc_text_count(b, info->meshes), info->meshes == 1 ? "" : "es");
    info_print_counts(info->triangles_by_class);
    if (info->windows)
        printf("  %-11s %s, %s lit\n", "windows", noc_text_many(a, info->windows, "window"),
               noc_text_count(b, info->windows_lit));
    printf("  %-11s %s\n", "lights", noc_text_count(a, info->lights));
    static const char *const kinds[] = { "sphere", "disc", "triangle", "parallelogram", "point", "spot" };
    _Static_assert(sizeof(kinds) / sizeof(*kinds) == NOC_LIGHT_KIND_COUNT, "every kind has its name");
    for (int i = 0; i < NOC_LIGHT_KIND_COUNT; i++)
        if (info->lights_by_kind[i])
            printf("    %-13s %10s\n", kinds[i], noc_text_count(a, info->lights_by_kind[i]));
}

static noc_status inspect_builtin(const info_args *args, const char *name, noc_log *log, noc_scene **scene) {
    *scene = noc_scene_create(log);
    noc_status status = *scene ? noc_scene_add_builtin(*scene, name, &args->builtin) : NOC_ERR_MEMORY;
    status = status ? status : noc_scene_set_windows(*scene, &args->import.window);
    return status ? status : noc_scene_commit(*scene);
}

/* A city that is built is loaded as a whole, so that its windows are told as they are switched. */
static noc_status inspect_built(const info_args *args, const char *path, noc_log *log, noc_report **report) {
    noc_scene *scene = noc_scene_create(log);
    noc_status status = scene ? noc_scene_load(scene, &path, 1, &args->import, report) : NOC_ERR_MEMORY;
    status = status ? status : cli_switch_built(&args->common, scene, &args->import, *report);
    noc_scene_destroy(scene);
    return status;
}

static noc_status inspect(const info_args *args, const char *path, noc_log *log, bool first) {
    noc_report *report = NULL;
    noc_scene *scene = NULL;
    noc_status status;
    if (!cli_builtin(path) && info_is_profile(path)) {
        if (args->json)
            fputs(first ? "\n" : ",\n", stdout);
        return info_profile(path, args->json, log);
    }
    if (!cli_builtin(path) && noc_built_is(path)) { /* its head, then what it is built from */
        if (args->json)
            fputs(first ? "\n" : ",\n", stdout);
        status = info_built(path, args->json, log);
        if (status)
            return status;
        first = false;
    }
    if (cli_builtin(path))
        status = inspect_builtin(args, cli_builtin(path), log, &scene);
    else if (noc_built_is(path))
        status = inspect_built(args, path, log, &report);
    else
        status = noc_inspect(log, path, &args->import, &report);
    cli_progress_clear();
    if (args->json && status != NOC_ERR_CANCELLED) {
        noc_scene_info info = { 0 };
        if (scene && !status)
            noc_scene_get_info(scene, &info);
        const char *error = status ? noc_log_last_error(log) : NULL;
        size_t count = (status && !args->import.strict) || scene ? 0 : noc_report_file_count(report);
        for (size_t i = 0; i < count || i == 0; i++) { /* a folder holds several files */
            const noc_report_file *file = count ? noc_report_get_file(report, i) : NULL;
            fputs(first && !i ? "\n" : ",\n", stdout);
            info_json_file(count > 1 ? file->path : path, error, file, scene && !status ? &info : NULL, args->timing);
        }
    } else if (!status && scene) {
        noc_scene_info info;
        noc_scene_get_info(scene, &info);
        print_scene(path, &info);
    } else if (!status || args->import.strict) { /* strictness does not hide what it found */
        for (size_t i = 0; i < noc_report_file_count(report); i++)
            info_print_file(noc_report_get_file(report, i), args);
        cli_print_lights("  rules       ", "  groups      ", report);
    }
    noc_report_destroy(report);
    noc_scene_destroy(scene);
    return status;
}

/* A bad file does not keep the others from being told about. */
static int inspect_each(const info_args *args, const char *const *inputs, size_t count, noc_log *log) {
    int status = CLI_OK;
    for (size_t i = 0; i < count && !cli_interrupted(); i++)
        if (inspect(args, inputs[i], log, i == 0))
            status = CLI_FAILURE;
    return status;
}

/* Luminaires first, which are no part of a scene, then the files as the scene has them, then the scene. */
static int tell_scene(const info_args *args, noc_log *log) {
    const char **inputs = cli_alloc((args->common.input_count + 1) * sizeof(*inputs));
    size_t count = 0, profiles = 0;
    int status = CLI_OK;
    for (size_t i = 0; i < args->common.input_count; i++) {
        const char *path = args->common.inputs[i];
        if (!cli_builtin(path) && info_is_profile(path))
            status = inspect(args, path, log, !profiles++) ? CLI_FAILURE : status;
        else
            inputs[count++] = path;
    }
    info_city city;
    noc_status loaded = info_load(args, inputs, count, log, &city);
    bool table = args->each_lamp && !args->json; /* which a program reads: nothing stands before it */
    if (cli_is_built(&args->common) && !loaded && !table) {
        fputs(args->json ? "\n" : "", stdout);
        info_built(inputs[0], args->json, log);
        profiles++;
    }
    if (table) {
        loaded = loaded ? loaded : info_lamps(&city, false);
        info_city_end(&city);
        free(inputs);
        return loaded ? CLI_FAILURE : status;
    }
    for (size_t i = 0; i < noc_report_file_count(city.report); i++) {
        const noc_report_file *file = noc_report_get_file(city.report, i);
        if (!args->json) {
            info_print_file(file, args);
        } else {
            fputs(i || profiles ? ",\n" : "\n", stdout);
            info_json_file(file->path, NULL, file, NULL, args->timing);
        }
    }
    if (args->json)
        printf("\n]");
    if (args->json && loaded) {
        fputs(", \"error\": ", stdout);
        cli_json_text(stdout, noc_log_last_error(log));
    } else if (args->json) {
        fputs(", \"scene\": ", stdout);
        loaded = info_json_city(&city, args);
    } else if (!loaded) {
        info_print_city(&city, args);
    }
    info_city_end(&city);
    free(inputs);
    return loaded ? CLI_FAILURE : status;
}

static int run(void *arguments) {
    info_args *args = arguments;
    cli_add_named(&args->common, &args->import);
    cli_note_chosen(&args->common, &args->import);
    noc_recipe_lists(args->common.recipe, &args->import);
    if (!args->common.input_count)
        return cli_usage(&cli_info, "which file?");
    int built = cli_check_built(&cli_info, &args->common, &args->import);
    if (built)
        return built;
    cli_catch_signals();
    cli_nothing_to_keep(true);
    cli_progress_start(args->common.quiet);
    args->import.progress = (noc_progress){ cli_load_progress, NULL };
    args->import.builtin = &args->builtin;
    args->import.each_lamp = args->each_lamp;
    noc_log *log = cli_log_create(&args->common);
    if (args->json)
        printf("{\"nocturne\": \"%s\", \"files\": [", noc_version());
    bool scene =
        args->scene == NOC_SWITCH_AUTO ? args->common.recipe != NULL || args->each_lamp : args->scene == NOC_SWITCH_ON;
    int status = scene ? tell_scene(args, log) : inspect_each(args, args->common.inputs, args->common.input_count, log);
    if (args->json)
        printf(scene ? "}\n" : "\n]}\n");
    noc_log_destroy(log);
    if (cli_interrupted()) {
        cli_error("interrupted");
        status = CLI_INTERRUPTED + cli_interrupted();
    }
    return cli_flush(stdout) ? status : CLI_FAILURE;
}
