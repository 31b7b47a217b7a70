/* summary.md: an experiment in a few tables. Where entries of the spec stand for several values of an option, they are
 * the rows and the values the columns; other configurations are rows with a column a camera. */
#include "lab/lab.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Frames told in a table of cameras that stand still: those that the spec measures, if they are few, else the first and
 * the last. */
int lab_points(const lab_spec *spec, size_t camera, lab_point out[LAB_POINTS]) {
    if (spec->cameras[camera].frames) {
        out[0] = (lab_point){ LAB_ALONE, 0 };
        return 1;
    }
    bool alone = lab_has_mode(spec, camera, LAB_ALONE),
         listed = spec->measured_count && spec->measured_count < LAB_POINTS;
    bool one = true; /* frame is all there is */
    for (size_t i = 0; i < spec->config_count; i++)
        one &= lab_frames(spec, camera, i) == 1;
    int count = 0, mode = alone ? LAB_ALONE : LAB_ACCUMULATED;
    for (size_t i = 0; listed && i < spec->measured_count; i++)
        out[count++] = (lab_point){ mode, spec->measured[i] };
    if (!listed) {
        out[count++] = (lab_point){ mode, 1 };
        if (!one)
            out[count++] = (lab_point){ mode, 0 };
    }
    if (alone && !one && lab_has_mode(spec, camera, LAB_ACCUMULATED))
        out[count++] = (lab_point){ LAB_ACCUMULATED, 0 };
    return count;
}

double lab_at_point(const lab_session *lab, size_t camera, size_t config, lab_point point, int column, double *error) {
    lab_series s = { lab, camera, config, point.mode, 0 };
    int frame = point.frame ? point.frame : lab_last(&s);
    *error = lab_error_at(&s, column, frame);
    return lab_at(&s, column, frame);
}

const char *lab_point_name(const lab_spec *spec, size_t camera, lab_point point) {
    static char text[48];
    int motion = spec->cameras[camera].frames;
    if (motion)
        snprintf(text, sizeof(text), "frame %d", motion);
    else if (point.frame)
        snprintf(text, sizeof(text), point.mode == LAB_ALONE ? "frame %d" : "mean of %d", point.frame);
    else
        snprintf(text, sizeof(text), "%s", point.mode == LAB_ALONE ? "last frame" : "mean of all");
    return text;
}

lab_series lab_timed(const lab_session *lab, size_t camera, size_t config) {
    int mode = lab_has_mode(&lab->spec, camera, LAB_ALONE) ? LAB_ALONE : LAB_ACCUMULATED;
    return (lab_series){ lab, camera, config, mode, 0 };
}

static void print_errors(FILE *out, const lab_session *lab, size_t camera, size_t config) {
    lab_point points[LAB_POINTS];
    int count = lab_points(&lab->spec, camera, points);
    for (int i = 0; i < count; i++) {
        double error, v = lab_at_point(lab, camera, config, points[i], lab_column(&lab->spec), &error);
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

void lab_view_name(FILE *out, const lab_spec *spec, size_t camera) {
    lab_text(out, spec->scenes[spec->cameras[camera].scene].name);
    fputs(", ", out);
    lab_text(out, spec->cameras[camera].name);
}

static void print_what(FILE *out, const lab_session *lab, size_t camera) {
    lab_point points[LAB_POINTS];
    int count = lab_points(&lab->spec, camera, points);
    for (int i = 0; i < count; i++)
        fprintf(out, "%s%s", i ? " / " : "", lab_point_name(&lab->spec, camera, points[i]));
    fputs(" \302\267 CPU time of a frame", out);
}

char *lab_row_name(const lab_session *lab, size_t config) {
    const lab_config *c = &lab->spec.configs[config];
    if (c->choice < 0)
        return cli_format("%s", c->name);
    /* The entry's name without the value's place and what joins it; with it in the middle, where the rest would not
     * read. */
    const char *name = c->pattern, *star = strchr(name, '*'), *after = star ? star + 1 : "";
    size_t before = star ? (size_t)(star - name) : strlen(name);
    while (before && strchr(", =", name[before - 1]))
        before--;
    if (before)
        return *after ? cli_format("%s", name) : cli_format("%.*s", (int)before, name);
    after += strspn(after, ", =");
    return cli_format("%s", *after ? after : c->option->name);
}

/* Entries of one option, under one camera. */
static void print_matrix(FILE *out, const lab_session *lab, size_t camera, const noc_option *option) {
    const lab_spec *spec = &lab->spec;
    const char *values[LAB_VALUES];
    size_t count = 0;
    for (size_t i = 0; i < spec->config_count; i++) {
        size_t k = 0;
        while (k < count && (spec->configs[i].option != option || strcmp(values[k], spec->configs[i].value)))
            k++;
        if (k == count && count < LAB_VALUES && spec->configs[i].option == option)
            values[count++] = spec->configs[i].value;
    }
    fputs("\n**", out);
    lab_view_name(out, spec, camera);
    fputs("**: ", out);
    print_what(out, lab, camera);
    fprintf(out, ".\n\n| `%s` |", option->name);
    for (size_t k = 0; k < count; k++)
        lab_cell(out, values[k]);
    lab_table_rule(out, count);
    for (size_t i = 0; i < spec->config_count; i++) {
        if (spec->configs[i].option != option || spec->configs[i].choice > 0)
            continue;
        char *name = lab_row_name(lab, i);
        fputc('|', out);
        lab_cell(out, name);
        free(name);
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
    const lab_spec *spec = &lab->spec;
    fputs("\n", out);
    for (size_t camera = 0; camera < spec->camera_count; camera++) {
        fputs("- **", out);
        lab_view_name(out, spec, camera);
        fputs("**: ", out);
        print_what(out, lab, camera);
        fputs("\n", out);
    }
    fputs("\n| |", out);
    for (size_t camera = 0; camera < spec->camera_count; camera++) {
        char *name = cli_format("%s, %s", spec->scenes[spec->cameras[camera].scene].name, spec->cameras[camera].name);
        lab_cell(out, name);
        free(name);
    }
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
    const lab_spec *spec = &lab->spec;
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
    const lab_spec *spec = &lab->spec;
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
            char *view =
                cli_format("%s, %s", spec->scenes[spec->cameras[camera].scene].name, spec->cameras[camera].name);
            bool volumes = structure(lab, camera, i, COL_INFLUENCE) > 0;
            fputc('|', out);
            lab_cell(out, spec->configs[i].name);
            lab_cell(out, view);
            free(view);
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

int lab_write_summary(lab_session *lab) {
    const lab_spec *spec = &lab->spec;
    char *temporary;
    FILE *out = lab_create(lab, "summary.md", &temporary);
    if (!out)
        return CLI_FAILURE;
    fputs("# ", out);
    lab_text(out, spec->title);
    fputs("\n\n", out);
    if (spec->note)
        fprintf(out, "%s\n\n", spec->note);
    fprintf(out, "%s; %d x %d px, ", lab_figure(spec), spec->width, spec->height);
    if (spec->repetitions > 1)
        fprintf(out, "means of %d repetitions with different seeds, \302\261 their standard error.\n",
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
    return lab_finish(lab, out, "summary.md", temporary);
}
