/* summary.md: an experiment in a few tables. Where entries of the spec stand for several values of an option, they are
 * the rows and the values the columns; other configurations are rows with a column a camera. */
#include "lab/summary.h"
#include "lab/file.h"
#include "lab/markdown.h"
#include "lab/series.h"

#include <math.h>

static void print_errors(FILE *out, const lab_session *lab, size_t camera, size_t config) {
    lab_point points[LAB_POINTS];
    int count = lab_points(lab->spec, camera, points);
    for (int i = 0; i < count; i++) {
        double error, v = lab_at_point(lab, camera, config, points[i], lab_column(lab->spec), &error);
        fputs(i ? " / " : " ", out);
        lab_print_spread(out, v, error, "%.2g");
    }
    lab_series s = lab_timed(lab, camera, config);
    double ms = 1e3 * lab_frame_time(&s, 0, 0);
    if (isfinite(ms)) {
        fputs(" \302\267 ", out);
        lab_print_spread(out, ms, 1e3 * lab_error_of(&s, lab_frame_time, 0, 0), "%.3g");
        fputs(" ms", out);
    }
    fputs(" |", out);
}

static void print_what(FILE *out, const lab_session *lab, size_t camera) {
    lab_point points[LAB_POINTS];
    char name[48];
    int count = lab_points(lab->spec, camera, points);
    for (int i = 0; i < count; i++)
        noc_fprintf(out, "%s%s", i ? " / " : "", lab_point_name(lab->spec, camera, points[i], name));
    fputs(" \302\267 CPU time of a frame", out);
}

/* Entries of one option, under one camera. */
static void print_matrix(FILE *out, const lab_session *lab, size_t camera, const noc_option *option) {
    const lab_spec *spec = lab->spec;
    const char *values[LAB_VALUES];
    char text[LAB_TEXT];
    size_t count = 0;
    for (size_t i = 0; i < spec->config_count; i++) {
        size_t k = 0;
        while (k < count && (spec->configs[i].option != option || strcmp(values[k], spec->configs[i].value)))
            k++;
        if (k == count && count < LAB_VALUES && spec->configs[i].option == option)
            values[count++] = spec->configs[i].value;
    }
    fputs("\n**", out);
    lab_text(out, lab_view_name(spec, camera, text));
    fputs("**: ", out);
    print_what(out, lab, camera);
    noc_fprintf(out, ".\n\n| `%s` |", option->name);
    for (size_t k = 0; k < count; k++)
        lab_cell(out, values[k]);
    lab_table_rule(out, count);
    for (size_t i = 0; i < spec->config_count; i++) {
        if (spec->configs[i].option != option || spec->configs[i].choice > 0)
            continue;
        fputc('|', out);
        lab_cell(out, lab_row_name(spec, i, text));
        for (size_t k = 0; k < count; k++) {
            size_t j = i;
            while (j < spec->config_count &&
                   (spec->configs[j].entry != spec->configs[i].entry || strcmp(spec->configs[j].value, values[k])))
                j++;
            if (j < spec->config_count)
                print_errors(out, lab, camera, j);
            else
                fputs(" |", out);
        }
        fputc('\n', out);
    }
}

static void print_plain(FILE *out, const lab_session *lab) {
    const lab_spec *spec = lab->spec;
    char text[LAB_TEXT];
    fputs("\n", out);
    for (size_t camera = 0; camera < spec->camera_count; camera++) {
        fputs("- **", out);
        lab_text(out, lab_view_name(spec, camera, text));
        fputs("**: ", out);
        print_what(out, lab, camera);
        fputs("\n", out);
    }
    fputs("\n| |", out);
    for (size_t camera = 0; camera < spec->camera_count; camera++)
        lab_cell(out, lab_view_name(spec, camera, text));
    lab_table_rule(out, spec->camera_count);
    for (size_t i = 0; i < spec->config_count; i++) {
        if (spec->configs[i].option)
            continue;
        fputc('|', out);
        lab_cell(out, spec->configs[i].name);
        for (size_t camera = 0; camera < spec->camera_count; camera++)
            print_errors(out, lab, camera, i);
        fputc('\n', out);
    }
}

/* Any row of a run will do: its structure is built once. */
static double structure(const lab_session *lab, size_t camera, size_t config, int column) {
    lab_series s = lab_timed(lab, camera, config);
    return lab_median(&s, column);
}

/* Does an earlier configuration draw from the same structure? Its kind, bytes and S_r tell. */
static bool is_repeated(const lab_session *lab, size_t config) {
    const lab_spec *spec = lab->spec;
    for (size_t i = 0; i < config; i++) {
        bool same = spec->configs[i].params.candidates == spec->configs[config].params.candidates;
        for (size_t camera = 0; same && camera < spec->camera_count; camera++)
            same = structure(lab, camera, i, COL_LIGHT_BYTES) == structure(lab, camera, config, COL_LIGHT_BYTES) &&
                   structure(lab, camera, i, COL_INFLUENCE) == structure(lab, camera, config, COL_INFLUENCE);
        if (same)
            return true;
    }
    return false;
}

/* A camera that moves finds what one at rest in its scene does, about: it has a row only where there is none. */
static bool has_structure_row(const lab_spec *spec, size_t camera) {
    bool rests = false;
    for (size_t i = 0; i < spec->camera_count; i++)
        rests |= spec->cameras[i].scene == spec->cameras[camera].scene && !spec->cameras[i].frames;
    return !spec->cameras[camera].frames || !rests;
}

/* What candidates are drawn from: time to build it, memory, and what influence volumes find. */
static void print_structures(FILE *out, const lab_session *lab) {
    const lab_spec *spec = lab->spec;
    bool any = false;
    for (size_t i = 0; i < spec->config_count; i++) {
        bool built = false;
        for (size_t camera = 0; camera < spec->camera_count; camera++)
            built |= structure(lab, camera, i, COL_LIGHT_BYTES) > 0;
        if (!built || is_repeated(lab, i))
            continue;
        if (!any) {
            fputs("\n| Light structure | Scene, camera | build, ms | volumes | tuning of S_r | hierarchy | boxes | "
                  "memory, kB | of the scene's, % | S_r, m | pixels that find none, % | "
                  "lights found, median | 99th percentile |",
                  out);
            lab_table_rule(out, 12);
        }
        any = true;
        for (size_t camera = 0; camera < spec->camera_count; camera++) {
            if (!has_structure_row(spec, camera))
                continue;
            char view[LAB_TEXT];
            bool volumes = structure(lab, camera, i, COL_INFLUENCE) > 0;
            fputc('|', out);
            lab_cell(out, spec->configs[i].name);
            lab_cell(out, lab_view_name(spec, camera, view));
            lab_number(out, 1e3 * structure(lab, camera, i, COL_LIGHT_BUILD), "%.3g");
            for (int step = COL_VOLUMES; step <= COL_BOXES; step++)
                lab_number(out, volumes ? 1e3 * structure(lab, camera, i, step) : NAN, "%.3g");
            lab_number(out, 1e-3 * structure(lab, camera, i, COL_LIGHT_BYTES), "%.1f");
            lab_number(out,
                       100 * structure(lab, camera, i, COL_LIGHT_BYTES) / structure(lab, camera, i, COL_SCENE_BYTES),
                       "%.2f");
            lab_number(out, volumes ? structure(lab, camera, i, COL_INFLUENCE) : NAN, "%.3g");
            lab_number(out, volumes ? 100 * structure(lab, camera, i, COL_FOUND_NONE) : NAN, "%.1f");
            lab_number(out, volumes ? structure(lab, camera, i, COL_FOUND_MEDIAN) : NAN, "%.0f");
            lab_number(out, volumes ? structure(lab, camera, i, COL_FOUND_99) : NAN, "%.0f");
            fputc('\n', out);
        }
    }
}

noc_status lab_write_summary(const lab_session *lab) {
    const lab_spec *spec = lab->spec;
    output file;
    noc_status status = lab_create_file(lab->folder, "summary.md", lab->log, &file);
    if (status)
        return status;
    FILE *out = file.file;
    char figure[LAB_TEXT];
    fputs("# ", out);
    lab_text(out, spec->title);
    fputs("\n\n", out);
    if (spec->note)
        noc_fprintf(out, "%s\n\n", spec->note);
    noc_fprintf(out, "%s; %d x %d px, ", lab_figure(spec, figure), spec->width, spec->height);
    if (spec->repetitions > 1)
        noc_fprintf(out, "means of %d repetitions with different seeds, \302\261 their standard error.\n",
                    spec->repetitions);
    else
        fputs("one run: its spread is not known.\n", out);
    bool plain = false;
    const noc_option *done = NULL;
    for (size_t i = 0; i < spec->config_count; i++) {
        const noc_option *option = spec->configs[i].option;
        plain |= !option;
        bool first = option && option != done;
        for (size_t j = 0; j < i && first; j++)
            first = spec->configs[j].option != option;
        for (size_t camera = 0; first && camera < spec->camera_count; camera++)
            print_matrix(out, lab, camera, option);
        done = option ? option : done;
    }
    if (plain)
        print_plain(out, lab);
    print_structures(out, lab);
    return output_close(&file, NOC_OK, lab->log);
}
