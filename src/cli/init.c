/* nocturne init: a recipe with remarks, from what files hold. */
#include "cli.h"

#include <errno.h>
#include <limits.h>
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
/* What is no matter of looking at files: it is the recipe's to say. */
static const char *const placing[] = { "scene-crs", "infer-lamps", "strict", NULL };

const cli_command cli_init = {
    "init",
    "FOLDER FILE...",
    "Writes a recipe, FOLDER/city.yaml, from what files hold: inputs, CRS, cameras, and every rule with its default.",
    "Examples\n"
    "  nocturne init town city.gml lamps.geojson\n"
    "  nocturne render town/city.yaml -o town.png\n",
    { { noc_import_options, offsetof(A, import), placing }, { cli_common_options, 0, NULL } },
    sizeof(init_args),
    &defaults,
    run,
};

/* What the files hold together. */
typedef struct found {
    size_t lamps, lamp_files, polygons[NOC_CLASS_COUNT], without_crs;
    size_t lamps_assumed[NOC_LAMP_DEFAULT_COUNT];
} found;

/* ---- paths ---- */

/* As seen from a folder, unless they have nothing but the root in common; both are absolute. free() it. */
static char *relative(const char *folder, const char *path) {
    size_t common = 0, up = 0, n = 0;
    while (folder[n] && folder[n] == path[n])
        if (folder[n++] == '/')
            common = n;
    if (!folder[n] && path[n] == '/')
        common = n + 1;
    else if (!folder[n] && !path[n])
        common = n;
    if (common <= 1)
        return cli_format("%s", path);
    for (const char *c = folder + common; *c; c++)
        up += *c == '/' || c == folder + common;
    char *text = cli_format("%s", "");
    for (size_t i = 0; i < up; i++) {
        char *more = cli_format("../%s", text);
        free(text);
        text = more;
    }
    char *whole = cli_format("%s%s", text, path + common);
    free(text);
    return whole;
}

/* A text in double quotes, as YAML reads it. */
static void print_text(FILE *out, const char *text) {
    fputc('"', out);
    for (const char *c = text; *c; c++)
        if (*c == '"' || *c == '\\')
            fprintf(out, "\\%c", *c);
        else if ((unsigned char)*c < 32)
            fprintf(out, "\\x%02x", (unsigned char)*c);
        else
            fputc(*c, out);
    fputc('"', out);
}

/* ---- what it says ---- */

static void print_remark(FILE *out, const noc_report_file *file) {
    char a[64], b[64], crs[100];
    fprintf(out, " # %s", file->format && *file->format ? file->format : "unknown format");
    if (file->crs && *file->crs)
        fprintf(out, ", %s", noc_text_clean(crs, sizeof(crs), file->crs));
    else
        fputs(", names no CRS", out);
    if (file->buildings)
        fprintf(out, ", %s", noc_text_many(a, file->buildings, "building"));
    if (file->polygons)
        fprintf(out, ", %s", noc_text_many(a, file->polygons, "polygon"));
    else if (file->triangles)
        fprintf(out, ", %s", noc_text_many(a, file->triangles, "triangle"));
    if (file->lamps)
        fprintf(out, ", %s", noc_text_many(b, file->lamps, "lamp"));
    fputc('\n', out);
}

static void add_found(found *all, const noc_report_file *file) {
    all->lamps += file->lamps;
    all->lamp_files += file->lamps > 0;
    all->without_crs += !(file->crs && *file->crs);
    for (int c = 0; c < NOC_CLASS_COUNT; c++)
        all->polygons[c] += file->polygons_by_class[c];
    for (int i = 0; i < NOC_LAMP_DEFAULT_COUNT; i++)
        all->lamps_assumed[i] += file->lamps_assumed[i];
}

/* Rows whose names begin with prefix, as keys of a section that waits to be used; their values are the defaults. */
static void print_section(FILE *out, const char *section, const char *prefix) {
    noc_import_params params = noc_import_default_params();
    bool any = false;
    for (const noc_option *o = noc_import_options(); o->name; o++) {
        if (strncmp(o->name, prefix, strlen(prefix)) || o->kind == NOC_OPTION_TEXTS)
            continue;
        if (!any)
            fprintf(out, "\n#%s:\n", section);
        any = true;
        char *value = cli_option_value(o, &params);
        fprintf(out, "#  %s: %s%*s # %s%s%s\n", o->name + strlen(prefix), *value ? value : "...",
                (int)(18 - strlen(o->name + strlen(prefix)) - strlen(value)) > 0
                    ? (int)(18 - strlen(o->name + strlen(prefix)) - strlen(value))
                    : 0,
                "", *o->unit ? o->unit : "", *o->unit ? ": " : "", o->help);
        free(value);
    }
}

static void print_lamps(FILE *out, const found *all) {
    static const char *const what[NOC_LAMP_DEFAULT_COUNT] = { "height", "flux", "colour" };
    char a[32], b[32];
    if (!all->lamp_files) {
        fputs("\n# No file holds lamps: some are placed by a rule. infer-lamps: off leaves the city dark.\n"
              "#infer-lamps: on\n",
              out);
    }
    const char *before = "\n";
    for (int i = 0; i < NOC_LAMP_DEFAULT_COUNT; i++) {
        if (!all->lamps_assumed[i])
            continue;
        fprintf(out, "%s# %s of %s lamps tell no %s: what stands below is taken.\n", before,
                noc_text_count(a, all->lamps_assumed[i]), noc_text_count(b, all->lamps), what[i]);
        before = "";
    }
    print_section(out, "lamps", "lamp-");
    fputs("#  files: []            # tables whose points are lamps whatever their words say\n", out);
}

static void print_materials(FILE *out, const found *all) {
    fputs("\n# By class; what is not said stays as the class has it.\n#materials:\n", out);
    for (int c = 0; c < NOC_CLASS_COUNT; c++) {
        if ((!all->polygons[c] && c != NOC_CLASS_TERRAIN) || c == NOC_CLASS_CLOSURE)
            continue;
        noc_material m = noc_class_material((noc_class)c);
        fprintf(out, "#  %s: { albedo: [%g, %g, %g], f0: %g, roughness: %g }\n", noc_class_name((noc_class)c),
                (double)m.albedo[0], (double)m.albedo[1], (double)m.albedo[2], (double)m.f0, (double)m.roughness);
    }
}

static noc_status inspect(const init_args *args, const char *path, noc_log *log, noc_report **report) {
    *report = NULL;
    if (cli_builtin(path))
        return NOC_OK;
    noc_status status = noc_inspect(log, path, &args->import, report);
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
    print_text(out, *name ? name : "city");
    fputs("\n\ninputs:\n", out);
    for (size_t i = 1; i < args->common.input_count && !status && !cli_interrupted(); i++) {
        const char *input = args->common.inputs[i];
        noc_report *report;
        char *path = cli_builtin(input) ? cli_format("%s", input) : realpath(input, NULL);
        if (!path) {
            cli_error("%.400s: %s", input, strerror(errno));
            return NOC_ERR_IO;
        }
        status = inspect(args, input, log, &report);
        char *shown = cli_builtin(input) ? cli_format("%s", input) : relative(folder, path);
        fputs("  - ", out);
        print_text(out, shown);
        if (report && !status) {
            const noc_report_file *file = noc_report_get_file(report, 0);
            add_found(&all, file);
            print_remark(out, file);
        } else {
            fputc('\n', out);
        }
        free(shown);
        free(path);
        noc_report_destroy(report);
    }
    if (status)
        return status;
    if (args->import.crs)
        fprintf(out, "\ncrs: %s\n", args->import.crs);
    else
        fprintf(out, "\n%s#crs: EPSG:25832       # of inputs that name none\n",
                all.without_crs ? "# Some inputs name no CRS. To put them in place:\n" : "");
    fputs("#scene-crs: EPSG:25832 # of the scene; else the first input's, or UTM\n", out);
    print_lamps(out, &all);
    print_section(out, "windows", "window-");
    print_materials(out, &all);
    fputs("\n# The first one is used unless --camera NAME, --view or --eye says another.\n"
          "cameras:\n"
          "  street: { view: street }\n"
          "  aerial: { view: aerial }\n"
          "#  mine: { eye: [0, -30, 1.7], target: [0, 0, 5], fov: 60 }  # the summary of render tells a camera so\n"
          "\n# Any option of nocturne render by its name.\n"
          "width: 1280\nheight: 720\n#sky: 0.02\n",
          out);
    return NOC_OK;
}

/* ---- the file ---- */

/* Written beside its place and linked there when it is whole: one that is there is never overwritten. */
static int write_recipe(const init_args *args, const char *folder, const char *path, noc_log *log) {
    char *temporary = cli_format("%s/.city.yaml.%ld", folder, (long)getpid());
    unlink(temporary);
    FILE *out = fopen(temporary, "wx");
    noc_status status = out ? NOC_OK : NOC_ERR_IO;
    if (out) {
        status = print_recipe(args, folder, log, out);
        bool failed = ferror(out) != 0;
        failed = fclose(out) || failed;
        if (!status && !cli_interrupted() && (failed || link(temporary, path)))
            status = NOC_ERR_IO;
        else if (status == NOC_ERR_IO)
            status = NOC_ERR_FORMAT; /* it was told */
    }
    if (status == NOC_ERR_IO)
        cli_error("%.400s: %s", path, strerror(errno));
    unlink(temporary);
    free(temporary);
    if (cli_interrupted())
        return CLI_INTERRUPTED + cli_interrupted();
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
        cli_error("%.400s: %s", named, strerror(errno));
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
        cli_error("%.400s is there already and is left alone", path);
        status = CLI_FAILURE;
    }
    if (!status) {
        cli_catch_signals();
        cli_nothing_to_keep(true);
        cli_progress_start(args->common.quiet);
        args->import.progress = (noc_progress){ cli_load_progress, NULL };
        noc_log *log = cli_log_create(&args->common);
        status = write_recipe(args, folder, path, log);
        noc_log_destroy(log);
    }
    if (status && !there)
        rmdir(folder);
    if (!status && !args->common.quiet)
        printf("%s\n  draw it: nocturne render %s -o night.png\n", path, path);
    free(path);
    free(folder);
    return cli_flush(stdout) ? status : CLI_FAILURE;
}
