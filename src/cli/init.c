/* nocturne init: a recipe with remarks, from what files hold. */
#include "cli.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

typedef struct init_args {
    cli_args common;
    noc_import_params import;
} init_args;
#define A init_args

static int run(void *arguments);
static const init_args defaults = { .import = noc_import_default_params() };

const cli_command cli_init = {
    "init",
    "FOLDER FILE...",
    "Writes a recipe, FOLDER/city.yaml, from what files hold: inputs, CRS, cameras, and every rule with its default.",
    "Examples\n"
    "  nocturne init town city.gml lamps.geojson\n"
    "  nocturne render town/city.yaml -o town.png\n",
    { { noc_import_options, offsetof(A, import), NULL }, { cli_common_options, 0, NULL } },
    sizeof(init_args),
    &defaults,
    run,
};

/* What the files hold together. */
typedef struct found {
    bool builtin, models; /* models: of buildings, or meshes */
    size_t outlines;      /* of buildings in maps */
    size_t lamps, polygons[NOC_CLASS_COUNT], without_crs;
    size_t lamps_assumed[NOC_LAMP_DEFAULT_COUNT];
} found;

/* ---- paths ---- */

/* As seen from a folder, unless they have nothing but the root in common; both are absolute. What a recipe takes for a
 * built-in scene or for a list of inputs is told from those by its "./". free() it. */
static char *relative(const char *folder, const char *path) {
    size_t common = 0, n = 0;
    for (; folder[n] && folder[n] == path[n]; n++)
        if (folder[n] == '/')
            common = n + 1;
    if (!folder[n] && !path[n])
        return cli_format(".");
    if (!folder[n] && path[n] == '/') {
        const char *below = path + n + 1;
        return cli_format("%s%s", *below == '@' || cli_builtin(below) ? "./" : "", below);
    }
    if (common <= 1)
        return cli_format("%s", path);
    char *text = cli_format("%s", path + common);
    for (const char *c = folder + common; c; c = strchr(c, '/') ? strchr(c, '/') + 1 : NULL) {
        char *more = cli_format("../%s", text);
        free(text);
        text = more;
    }
    return text;
}

/* ---- what it says ---- */

/* Is what it holds of buildings outlines of a map? */
static bool has_outlines(const noc_report_file *file) { return file->buildings && !file->polygons && !file->triangles; }

/* What an input holds, which may be a folder of files. */
static void print_remark(FILE *out, const noc_report *report) {
    const noc_report_file *first = noc_report_get_file(report, 0);
    size_t files = noc_report_file_count(report), buildings = 0, polygons = 0, triangles = 0, lamps = 0;
    size_t outlines = 0, roads = 0;
    double metres = 0;
    char a[64], crs[100];
    for (size_t i = 0; i < files; i++) {
        const noc_report_file *file = noc_report_get_file(report, i);
        *(has_outlines(file) ? &outlines : &buildings) += file->buildings;
        roads += file->roads;
        metres += file->road_metres;
        polygons += file->polygons;
        triangles += file->triangles;
        lamps += file->lamps;
    }
    if (files > 1)
        fprintf(out, " # %s, the first", noc_text_many(a, files, "file"));
    fprintf(out, " %s%s", files > 1 ? "" : "# ", first->format && *first->format ? first->format : "unknown format");
    if (first->crs && *first->crs)
        fprintf(out, ", %s", noc_text_clean(crs, sizeof(crs), first->crs));
    if (buildings)
        fprintf(out, ", %s", noc_text_many(a, buildings, "building"));
    if (polygons)
        fprintf(out, ", %s", noc_text_many(a, polygons, "polygon"));
    else if (triangles)
        fprintf(out, ", %s", noc_text_many(a, triangles, "triangle"));
    if (lamps)
        fprintf(out, ", %s", noc_text_many(a, lamps, "lamp"));
    if (outlines)
        fprintf(out, ", %s of buildings", noc_text_many(a, outlines, "outline"));
    if (roads)
        fprintf(out, ", %s (%.1f km)", noc_text_many(a, roads, "road"), metres / 1000);
    fputc('\n', out);
}

static void add_found(found *all, const noc_report *report) {
    for (size_t k = 0; k < noc_report_file_count(report); k++) {
        const noc_report_file *file = noc_report_get_file(report, k);
        all->lamps += file->lamps;
        all->outlines += has_outlines(file) ? file->buildings : 0;
        /* terrain is no model, whose place an outline would leave */
        bool terrain = file->polygons || (file->format && !strncmp(file->format, "GeoTIFF", 7));
        all->models = all->models || (file->triangles && !terrain) || (file->buildings && !has_outlines(file));
        all->without_crs += file->has_extent && !(file->crs && *file->crs);
        for (int c = 0; c < NOC_CLASS_COUNT; c++)
            all->polygons[c] += file->polygons_by_class[c];
        for (int i = 0; i < NOC_LAMP_DEFAULT_COUNT; i++)
            all->lamps_assumed[i] += file->lamps_assumed[i];
    }
}

/* "height: 8 # m: of lamps ..."; one that the words say is a key in use, others wait. */
static void print_key(FILE *out, const init_args *args, const noc_option *o, const char *key, const char *indent) {
    bool said = cli_given(&args->common, o->name);
    char *value = cli_option_value(o, &args->import), *path = strcmp(o->unit, "FILE") ? NULL : realpath(value, NULL);
    int room = 22 + said - (int)(strlen(indent) + strlen(key) + strlen(value));
    fprintf(out, "%s%s%s: ", said ? "" : "#", indent, key);
    if (o->kind == NOC_OPTION_TEXT && *value)
        cli_yaml_text(out, path ? path : value); /* as seen from here; a recipe sees files from its folder */
    else
        fputs(*value ? value : "...", out);
    fprintf(out, "%*s # %s%s%s\n", room > 0 ? room : 0, "", o->unit, *o->unit ? ": " : "", o->help);
    free(path);
    free(value);
}

static bool in_section(const noc_option *o, const char *prefix, const char *group) {
    return o->kind != NOC_OPTION_TEXTS &&
           (!strncmp(o->name, prefix, strlen(prefix)) || (group && !strcmp(o->group, group)));
}

/* Rows whose names begin with the prefix, and all others of the group. used: it has keys beside these. */
static void print_section(FILE *out, const init_args *args, const char *section, const char *prefix, const char *group,
                          bool used) {
    for (const noc_option *o = noc_import_options(); o->name; o++)
        used = used || (in_section(o, prefix, group) && cli_given(&args->common, o->name));
    fprintf(out, "\n%s%s:\n", used ? "" : "#", section);
    for (const noc_option *o = noc_import_options(); o->name; o++)
        if (in_section(o, prefix, group))
            print_key(out, args, o, o->name + (strncmp(o->name, prefix, strlen(prefix)) ? 0 : strlen(prefix)), "  ");
}

/* What stands in no section, but for what protects who reads. */
static void print_others(FILE *out, const init_args *args, const found *all) {
    bool blocks = all->outlines && !all->models && !all->builtin && !cli_given(&args->common, "footprints");
    char a[64];
    fputc('\n', out);
    for (const noc_option *o = noc_import_options(); o->name; o++)
        if (blocks && !strcmp(o->name, "footprints"))
            fprintf(out, "footprints: true         # no input is a city model: %s of buildings become blocks\n",
                    noc_text_many(a, all->outlines, "outline"));
        else if (!in_section(o, "lamp-", NULL) && !in_section(o, "window-", "Windows") &&
                 !in_section(o, "traffic-", "Traffic") && o->kind != NOC_OPTION_TEXTS && strcmp(o->group, "Reading"))
            print_key(out, args, o, o->name, "");
}

/* Those of files that name a wrong one. */
static void print_file_crs(FILE *out, const noc_texts *texts) {
    for (size_t i = 0; i < texts->count; i++) {
        fputs(i ? "  - " : "\nfile-crs:\n  - ", out);
        cli_yaml_text(out, texts->text[i]);
        fputc('\n', out);
    }
}

/* Files that are told of with --lamps, and what columns are read as. */
static void print_texts(FILE *out, const noc_texts *texts, const char *key, const char *remark) {
    fprintf(out, "%s  %s: [", texts->count ? "" : "#", key);
    for (size_t i = 0; i < texts->count; i++) {
        char *path = !strcmp(key, "columns") ? NULL : realpath(texts->text[i], NULL);
        fputs(i ? ", " : "", out);
        cli_yaml_text(out, path ? path : texts->text[i]);
        free(path);
    }
    fprintf(out, "]%*s # %s\n", texts->count ? 0 : 12, "", remark);
}

static void print_lamps(FILE *out, const init_args *args, const found *all) {
    static const char *const what[NOC_LAMP_DEFAULT_COUNT] = { "height", "flux", "colour" }; /* that have an option */
    char a[32], b[32];
    if (!all->lamps && !all->builtin)
        fputs("\n# No file holds lamps: some are placed by a rule, unless infer-lamps is off.\n", out);
    const char *before = "\n";
    for (int i = 0; i < NOC_LAMP_DEFAULT_COUNT; i++) {
        if (!all->lamps_assumed[i] || !what[i])
            continue;
        fprintf(out, "%s# %s of %s lamps tell no %s: what stands below is taken.\n", before,
                noc_text_count(a, all->lamps_assumed[i]), noc_text_count(b, all->lamps), what[i]);
        before = "";
    }
    print_section(out, args, "lamps", "lamp-", NULL, args->import.lamps.count || args->import.lamp_columns.count);
    print_texts(out, &args->import.lamps, "files", "tables whose points are lamps whatever their words say");
    print_texts(out, &args->import.lamp_columns, "columns", "what columns are read as: \"height=H,watts=P\"");
}

/* Examples that mean something of any lamp. */
static void print_rules(FILE *out) {
    fputs("\n# Rules for lamps, by tags and columns or by what was understood; the later one's word counts\n"
          "# (docs/luminaires.md).\n"
          "#luminaires:\n"
          "#  - { match: { source: sodium, watts: \">= 150\" }, profile: cobra-head, tilt: 5 }\n"
          "\n# Lights that are switched, dimmed and coloured together; --group NAME=STATE does it too.\n"
          "#groups:\n"
          "#  lamps: { scale: 0.5 }\n"
          "#  station: { match: { street: \"Station*\" }, kelvin: 2200 }\n",
          out);
}

static void print_materials(FILE *out, const found *all) {
    fputs("\n# By class; what is not said stays as the class has it.\n#materials:\n", out);
    for (int c = 0; c < NOC_CLASS_COUNT; c++) {
        if ((!all->polygons[c] && c != NOC_CLASS_TERRAIN) || c == NOC_CLASS_CLOSURE)
            continue;
        noc_material m = noc_class_material((noc_class)c);
        fprintf(out, "#  %s: { albedo: [%g, %g, %g], f0: %g, roughness: %g }%s\n", noc_class_name((noc_class)c),
                (double)m.albedo[0], (double)m.albedo[1], (double)m.albedo[2], (double)m.f0, (double)m.roughness,
                c == NOC_CLASS_ROAD ? " # that is R3, CIE's asphalt; or a word: R1 to R4 dry, W1 to W4 wet" : "");
    }
}

static noc_status inspect(const init_args *args, const char *path, noc_log *log, noc_report **report) {
    *report = NULL;
    if (cli_builtin(path))
        return NOC_OK;
    noc_import_params import = args->import;
    import.footprints = import.footprints || !cli_given(&args->common, "footprints"); /* to know of them */
    noc_status status = noc_inspect(log, path, &import, report);
    cli_progress_clear();
    if (!status && !noc_report_file_count(*report))
        status = NOC_ERR_FORMAT;
    return status;
}

static noc_status print_recipe(const init_args *args, const char *folder, noc_log *log, FILE *out) {
    found all = { 0 };
    noc_status status = NOC_OK;
    const char *name = strrchr(folder, '/') ? strrchr(folder, '/') + 1 : folder;
    fprintf(out, "# Made by nocturne init (%s). docs/recipes.md tells all keys; # begins what waits to be used.\n",
            noc_version());
    fputs("nocturne: 1\nname: ", out);
    cli_yaml_text(out, *name && !cli_not_utf8(name) ? name : "city");
    fputs("\n\ninputs:\n", out);
    for (size_t i = 1; i < args->common.input_count && !status && !cli_interrupted(); i++) {
        const char *input = args->common.inputs[i];
        noc_report *report;
        char *path = cli_builtin(input) ? cli_format("%s", input) : realpath(input, NULL);
        if (!path) {
            cli_error("%.400s: %s", input, strerror(errno));
            return NOC_ERR_IO;
        }
        all.builtin = all.builtin || cli_builtin(input);
        status = inspect(args, input, log, &report);
        char *shown = cli_builtin(input) ? cli_format("%s", input) : relative(folder, path);
        fputs("  - ", out);
        cli_yaml_text(out, shown);
        if (report && !status) {
            add_found(&all, report);
            print_remark(out, report);
        } else {
            fputc('\n', out);
        }
        free(shown);
        free(path);
        noc_report_destroy(report);
    }
    if (status)
        return status;
    if (all.without_crs && !args->import.crs)
        fputs("\n# Some inputs name no CRS: crs puts them in place.", out);
    print_file_crs(out, &args->import.file_crs);
    print_others(out, args, &all);
    print_lamps(out, args, &all);
    print_section(out, args, "windows", "window-", "Windows", false);
    print_section(out, args, "traffic", "traffic-", "Traffic",
                  args->import.tracks.count || args->import.cars.bodies.count);
    print_texts(out, &args->import.tracks, "tracks", "files whose lines are tracks of cars");
    print_texts(out, &args->import.cars.bodies, "car-body", "bodies of your own: OBJ, PLY or glTF");
    print_rules(out);
    print_materials(out, &all);
    fputs("\n# The first one is used unless --camera NAME, --view or --eye says another.\n"
          "cameras:\n"
          "  street: { view: street }\n"
          "  aerial: { view: aerial }\n"
          "  overview: { view: overview }\n"
          "#  mine: { eye: [0, -30, 1.7], target: [0, 0, 5], fov: 60 }  # the summary of render tells a camera so\n"
          "\n# Any option of nocturne render by its name.\n"
          "width: 1280\nheight: 720\n#sky: sqm:18.8\n",
          out);
    return NOC_OK;
}

/* ---- the file ---- */

/* A recipe is UTF-8. Names of files need not be. */
static noc_status check_text(const char *path, const char *text) {
    const char *bad = cli_not_utf8(text), *line = bad;
    if (!bad)
        return NOC_OK;
    while (line > text && line[-1] != '\n')
        line--;
    line += strspn(line, " -");
    cli_error("%.400s: a recipe is UTF-8, and this name is not: %.*s", path, (int)strcspn(line, "\n"), line);
    return NOC_ERR_FORMAT;
}

/* Written beside its place and linked there when it is whole and on the disk: one that is there is never overwritten.
 * EINVAL: the file system has nothing to write through. */
static noc_status write_text(const char *folder, const char *path, const char *text) {
    char *temporary = cli_format("%s/.city.yaml.%ld", folder, (long)getpid());
    unlink(temporary);
    FILE *out = fopen(temporary, "wx");
    bool failed = !out || fputs(text, out) < 0 || fflush(out) || (fsync(fileno(out)) && errno != EINVAL);
    failed = (out && fclose(out)) || failed || link(temporary, path);
    if (failed)
        cli_error("%.400s: %s", path, strerror(errno));
    unlink(temporary);
    free(temporary);
    return failed ? NOC_ERR_IO : NOC_OK;
}

/* Nothing is on the disk before all of it is known: reading may take long, and may be interrupted. */
static int write_recipe(const init_args *args, const char *folder, const char *path, noc_log *log) {
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    if (!out)
        cli_no_memory();
    noc_status status = print_recipe(args, folder, log, out);
    if (fclose(out) || !text)
        cli_no_memory();
    if (!status && cli_interrupted())
        status = NOC_ERR_CANCELLED;
    status = status ? status : check_text(path, text);
    status = status ? status : write_text(folder, path, text);
    free(text);
    if (status && cli_interrupted()) {
        cli_error("interrupted: nothing was saved");
        return CLI_INTERRUPTED + cli_interrupted();
    }
    return status ? CLI_FAILURE : CLI_OK;
}

static int run(void *arguments) {
    init_args *args = arguments;
    struct stat st;
    if (!args->common.input_count)
        return cli_usage(&cli_init, "which folder?");
    const char *named = args->common.inputs[0];
    bool there = !stat(named, &st);
    if (there && !S_ISDIR(st.st_mode))
        return cli_usage(&cli_init, "%.200s is no folder; the folder comes first, then the files", named);
    if (args->common.input_count < 2)
        return cli_usage(&cli_init, "which files? nocturne init %.100s city.gml lamps.geojson", named);
    if (!there && mkdir(named, 0777)) {
        cli_error("%.400s: this folder cannot be made: %s", named, strerror(errno));
        return CLI_FAILURE;
    }
    char *folder = realpath(named, NULL);
    if (!folder) {
        cli_error("%.400s: %s", named, strerror(errno));
        return CLI_FAILURE;
    }
    char *path = cli_format("%s/city.yaml", folder);
    int status = CLI_OK;
    if (!access(path, F_OK)) {
        cli_error("%.400s is there already and is left alone: remove it for another, or name another folder", path);
        status = CLI_FAILURE;
    } else if (access(folder, W_OK | X_OK)) {
        cli_error("%.400s: this folder cannot be written: %s", named, strerror(errno));
        status = CLI_FAILURE;
    }
    if (!status) {
        cli_catch_signals();
        cli_leave_nothing_at(there ? NULL : folder);
        cli_nothing_to_keep(true);
        cli_progress_start(args->common.quiet);
        args->import.progress = (noc_progress){ cli_load_progress, NULL };
        noc_log *log = cli_log_create(&args->common);
        status = write_recipe(args, folder, path, log);
        noc_log_destroy(log);
        cli_nothing_to_keep(false);
        cli_leave_nothing_at(NULL);
    }
    if (status && !there)
        rmdir(folder);
    if (!status && !args->common.quiet) {
        char shown[400];
        noc_text_clean(shown, sizeof(shown), path);
        printf("%s\n  draw it: %s render %s -o night.png\n", shown, cli_program(), shown);
    }
    free(path);
    free(folder);
    return cli_flush(stdout) ? status : CLI_FAILURE;
}
