/* report.md: what was measured, on what, and how to make it again. */
#include "lab/report.h"
#include "lab/charts.h"
#include "lab/file.h"
#include "lab/markdown.h"
#include "lab/noise.h"
#include "lab/plot.h"
#include "lab/series.h"
#include "lab/sheet.h"
#include "lab/summary.h"

#include <limits.h>
#include <math.h>
#include <nocturne/nocturne.h>
#include <time.h>

static const int shown_frames[] = { 1, 2, 4, 8, 16, 20, 32, 64, 128, 256, 1024, 4096 };
enum { SHOWN = sizeof(shown_frames) / sizeof(*shown_frames) };
static const double targets[] = { 1, 0.3, 0.1 };
static const char *const mode_names[] = { "Each frame alone", "Mean of the frames so far" };

/* The command line as a shell would read it. */
static void print_command(FILE *out) {
    char text[8192];
    FILE *file = fopen("/proc/self/cmdline", "rb");
    size_t n = file ? fread(text, 1, sizeof(text), file) : 0;
    if (file)
        fclose(file);
    for (size_t i = 0; i < n;) {
        size_t length = strnlen(text + i, n - i);
        bool plain =
            length &&
            strspn(text + i, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=./:,@%") == length;
        fputs(i ? plain ? " " : " '" : plain ? "" : "'", out);
        for (size_t j = i; j < i + length; j++) {
            if (text[j] == '\'')
                fputs("'\\''", out);
            else
                fputc((unsigned char)text[j] < 32 ? '?' : text[j], out);
        }
        fputs(plain ? "" : "'", out);
        i += length + 1;
    }
}

static bool draws_candidates(const noc_render_params *p) {
    return p->method == NOC_METHOD_RIS || p->method == NOC_METHOD_RESTIR;
}

/* The method, where its candidates come from, and options of a configuration that count and are no defaults. */
static void print_options(FILE *out, const noc_render_params *params) {
    static const char *const above[] = { "width", "height", "seed", "accumulate", NULL };
    noc_render_params usual = noc_render_default_params();
    bool any = false;
    for (const noc_option *o = noc_render_options(); o->name; o++) {
        char mine[80], theirs[80], why[160];
        noc_option_get(o, params, mine, sizeof(mine));
        noc_option_get(o, &usual, theirs, sizeof(theirs));
        bool always = !strcmp(o->name, "method") || (!strcmp(o->name, "candidates") && draws_candidates(params));
        if (lab_among(above, o->name) || (!strcmp(mine, theirs) && !always) ||
            noc_option_idle(o, noc_render_options(), params, why, sizeof(why)))
            continue;
        noc_fprintf(out, "%s`%s %s`", any ? ", " : "", o->name, mine);
        any = true;
    }
}

/* Few repetitions know their own spread badly: two-sided 95 % quantiles of Student's t with n - 1 degrees of freedom.
 */
static void print_confidence(FILE *out, int n) {
    static const double t[] = { [2] = 12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262 };
    if (n < (int)(sizeof(t) / sizeof(*t)))
        noc_fprintf(out, "With n = %d, 95 %% of such means lie within %.1f standard errors (Student's t)%s.\n", n, t[n],
                    n < 4 ? ": differences smaller than that are not shown by so few repetitions" : "");
}

static void print_count(FILE *out, size_t count) {
    char text[32];
    noc_fprintf(out, " %s |", noc_text_count(text, count));
}

static void print_scenes(FILE *out, const lab_session *lab) {
    const lab_spec *spec = lab->spec;
    char memory[32];
    lab_table_head(out, "| Scene | Buildings | Triangles | Windows | lit | Lamps | Cars | Lights | Memory |", 8);
    for (size_t i = 0; i < spec->scene_count; i++) {
        const lab_holdings *held = &lab->holdings[i];
        const noc_scene_info *info = &held->info;
        const size_t counts[] = { held->buildings, info->triangles + info->instance_triangles,
                                  info->windows,   info->windows_lit,
                                  held->lamps,     info->cars,
                                  info->lights };
        fputc('|', out);
        lab_cell(out, spec->scenes[i].name);
        for (size_t k = 0; k < NOC_COUNT(counts); k++)
            print_count(out, counts[k]);
        noc_fprintf(out, " %s |\n", noc_text_bytes(memory, info->memory_bytes));
    }
    for (size_t i = 0; i < spec->absent_count; i++) {
        fputs(i ? ", " : "\nLeft out, because an input is absent: ", out);
        lab_text(out, spec->absent[i].name);
        fputs(" (", out);
        lab_text(out, spec->absent[i].input);
        fputs(i + 1 < spec->absent_count ? ")" : ").\n", out);
    }
}

static void print_setting(FILE *out, const lab_session *lab) {
    const lab_spec *spec = lab->spec;
    char date[40] = "";
    time_t now = time(NULL);
    struct tm utc;
    if (gmtime_r(&now, &utc))
        strftime(date, sizeof(date), "%Y-%m-%d %H:%M UTC", &utc);
    fputs("# ", out);
    lab_text(out, spec->title);
    fputs("\n\n", out);
    if (spec->note)
        noc_fprintf(out, "%s\n\n", spec->note);
    noc_fprintf(out, "Made by nocturne %s (%s) on %s, on %s; the code that ran: %s.\n\n    ", noc_version(),
                noc_features(), date, lab->machine, *lab->path ? lab->path : "none, all rows were there");
    print_command(out);
    if (lab->device.kind > NOC_DEVICE_SOFTWARE)
        fputs("\n\nCPU seconds are the host's alone: what the device takes is in the seconds by the clock.", out);
    char extent[64];
    if (spec->seconds > 0)
        noc_snprintf(extent, sizeof(extent), "%.3g s of CPU time", spec->seconds);
    else
        noc_text_many(extent, (uint64_t)spec->frames, "frame");
    noc_fprintf(out, "\n\nPictures of %d x %d px, %s, ", spec->width, spec->height, extent);
    if (spec->repetitions > 1) {
        noc_fprintf(
            out,
            "%d repetitions with different seeds. Figures are their means, \302\261 the standard error of the mean.\n",
            spec->repetitions);
        print_confidence(out, spec->repetitions);
    } else {
        noc_fprintf(out, "1 repetition: how far another seed's figures would be off is not known.\n");
    }
    noc_fprintf(out, "Reference: %s of ", noc_text_many(extent, (uint64_t)spec->reference.frames, "frame"));
    if (spec->reference.params.method == NOC_METHOD_REFERENCE)
        noc_fprintf(out, "%s a pixel", noc_text_many(extent, (uint64_t)spec->reference.params.rays, "shadow ray"));
    else
        print_options(out, &spec->reference.params);
    noc_fprintf(out, ", %s.\n", spec->reference.params.jitter ? "jittered" : "through the centres of pixels");
    noc_fprintf(
        out,
        "All rows: [results.csv](results.csv). Definitions of the figures: docs/estimator.md, \"Error figures\".\n");
    print_scenes(out, lab);
    noc_fprintf(out, "\n| Configuration | Method, candidates, and options that are not the defaults |\n|---|---|\n");
    for (size_t i = 0; i < spec->config_count; i++) {
        fputc('|', out);
        lab_cell(out, spec->configs[i].name);
        fputc(' ', out);
        print_options(out, &spec->configs[i].params);
        fputs(" |\n", out);
    }
}

static void print_crops(FILE *out, const lab_session *lab, size_t camera) {
    const lab_spec *spec = lab->spec;
    const lab_crop *crop = &lab->crops[camera];
    int motion = spec->cameras[camera].frames, mode = lab_shown_mode(spec, camera);
    size_t frames = motion ? 1 : spec->shown_count;
    if (!frames)
        return;
    for (size_t i = 0; i < frames; i++) {
        int frame = motion ? motion : spec->shown[i];
        char many[64], name[LAB_TEXT];
        lab_sheet_name(spec, camera, frame, false, name);
        if (mode == LAB_ACCUMULATED)
            noc_fprintf(out, "\n![Mean of %s](%s)\n", noc_text_many(many, (uint64_t)frame, "frame"), name);
        else
            noc_fprintf(out, "\n![Frame %d](%s)\n", frame, name);
        if (spec->light_view)
            noc_fprintf(out, "\n![Lights of frame %d](%s)\n", frame, lab_sheet_name(spec, camera, frame, true, name));
    }
    bool mean = mode == LAB_ACCUMULATED;
    noc_fprintf(out, "\nShown %s ", frames > 1 ? "are" : "is");
    if (motion)
        noc_fprintf(out, "the last frame");
    else
        noc_fprintf(out, "%s%s",
                    !mean        ? "frame"
                    : frames > 1 ? "the means of frame"
                                 : "the mean of frame",
                    mean || frames > 1 ? "s " : " ");
    for (size_t i = 0; i < frames && !motion; i++)
        noc_fprintf(out, mean ? "%s1 to %d" : "%s%d", i ? ", " : "", spec->shown[i]);
    fputs(" of each configuration, row by row (\"reference\"", out);
    for (size_t i = 1; i <= spec->config_count; i++) {
        fputs(i % (size_t)crop->columns ? ", \"" : "; \"", out);
        lab_text(out, spec->configs[i - 1].name);
        fputc('"', out);
    }
    fputs("): ", out);
    const lab_camera *c = &spec->cameras[camera];
    if (!c->inset_count)
        noc_fprintf(out, "the part of %d x %d px at (%d, %d), enlarged %d times", crop->width, crop->height, crop->x,
                    crop->y, crop->scale);
    for (int i = 0; i < c->inset_count; i++) {
        const int *box = c->insets[i].box;
        noc_fprintf(out, "%s%s is ", i ? "; " : "", lab_inset_colour(i));
        lab_text(out, c->insets[i].name);
        noc_fprintf(out, ", %d x %d px at (%d, %d)", box[2], box[3], box[0], box[1]);
    }
    fputs(". All have the reference's exposure.\n", out);
    if (spec->light_view)
        fputs("\nLights are those that the pixels' reservoirs hold, each in its own colour; grey: none. The reference, "
              "which has no reservoirs, is shown as it is seen.\n",
              out);
}

/* Frames that a table of errors shows: some of those that were measured, and each configuration's last, which differ
 * where CPU seconds end the runs. */
typedef struct table_frames {
    int frames[SHOWN + 1], count;
    bool own_last;
} table_frames;

static bool is_there(lab_series s, int frame) {
    bool any = false;
    for (s.config = 0; s.config < s.lab->spec->config_count && !any; s.config++)
        any = !isnan(lab_at(&s, 0, frame));
    return any;
}

static table_frames frames_of(lab_series s) {
    const lab_spec *spec = s.lab->spec;
    table_frames t = { .count = 0 };
    int most = 0, least = INT_MAX;
    for (s.config = 0; s.config < spec->config_count; s.config++) {
        int last = lab_last(&s);
        most = last > most ? last : most;
        least = last < least ? last : least;
    }
    t.own_last = least != most;
    bool listed = spec->measured_count && spec->measured_count <= SHOWN;
    for (size_t i = 0; i < (listed ? spec->measured_count : SHOWN); i++) {
        int frame = listed ? spec->measured[i] : shown_frames[i];
        if (frame <= most && is_there(s, frame))
            t.frames[t.count++] = frame;
    }
    if (most && !t.own_last && (!t.count || t.frames[t.count - 1] != most))
        t.frames[t.count++] = most;
    return t;
}

/* What `-` in the columns means, and whose frame the last is. */
static void print_legend(FILE *out, lab_series s) {
    table_frames t = frames_of(s);
    bool missing = false;
    for (s.config = 0; s.config < s.lab->spec->config_count; s.config++)
        for (int i = 0; i < t.count; i++)
            missing |= isnan(lab_at(&s, 0, t.frames[i]));
    if (t.own_last)
        noc_fprintf(out, "\nlast: each configuration's own last frame%s, its number in brackets.",
                    s.lab->spec->repetitions > 1 ? " of those that all repetitions measured" : "");
    if (missing)
        noc_fprintf(out, "%s-: the run had ended before that frame, or did not measure it.", t.own_last ? " " : "\n");
    fputs(t.own_last || missing ? "\n" : "", out);
}

/* A cell: an error, or a bias in %, with its standard error. */
static void print_figure(FILE *out, const lab_series *s, int column, int frame, const char *fmt, const char *after) {
    bool bias = column == COL_BIAS || column == COL_BIAS_ALL;
    double v = lab_at(s, column, frame), error = lab_error_at(s, column, frame);
    lab_spread(out, bias ? 100 * (v - 1) : v, bias ? 100 * error : error, fmt, after);
}

static void print_errors(FILE *out, lab_series s, const char *what, int column, const char *fmt) {
    table_frames t = frames_of(s);
    char head[400];
    int at = noc_snprintf(head, sizeof(head), "| %s, frame |", what);
    for (int i = 0; i < t.count; i++)
        at += noc_snprintf(head + at, sizeof(head) - (size_t)at, " %d |", t.frames[i]);
    noc_snprintf(head + at, sizeof(head) - (size_t)at, "%s", t.own_last ? " last |" : "");
    lab_table_head(out, head, (size_t)(t.count + t.own_last));
    for (s.config = 0; s.config < s.lab->spec->config_count; s.config++) {
        fputc('|', out);
        lab_cell(out, s.lab->spec->configs[s.config].name);
        for (int i = 0; i < t.count; i++)
            print_figure(out, &s, column, t.frames[i], fmt, "");
        if (t.own_last) {
            int last = lab_last(&s);
            char text[24];
            noc_snprintf(text, sizeof(text), " (%d)", last);
            print_figure(out, &s, column, last, fmt, text);
        }
        fputc('\n', out);
    }
}

static void print_all_frames(FILE *out, lab_series s, const char *clamped, int first) {
    print_errors(out, s, clamped, first + 2, "%.3g");
    print_errors(out, s, "relMSE", first + 1, "%.3g");
    print_errors(out, s, "RMSE-8", first, "%.2f");
    print_errors(out, s, "Bias, %", first + 3, "%+.2f");
    print_legend(out, s);
}

/* Of a camera that moves. */
static void print_one_frame(FILE *out, lab_series s, const char *clamped, int first) {
    char head[200];
    noc_snprintf(head, sizeof(head), "| | %s | relMSE | RMSE-8 | Bias, %% | CPU seconds of this frame | of all |",
                 clamped);
    lab_table_head(out, head, 6);
    for (s.config = 0; s.config < s.lab->spec->config_count; s.config++) {
        int frame = lab_last(&s);
        fputc('|', out);
        lab_cell(out, s.lab->spec->configs[s.config].name);
        print_figure(out, &s, first + 2, frame, "%.3g", "");
        print_figure(out, &s, first + 1, frame, "%.3g", "");
        print_figure(out, &s, first, frame, "%.2f", "");
        print_figure(out, &s, first + 3, frame, "%+.2f", "");
        print_figure(out, &s, COL_CPU, frame, "%.3g", "");
        print_figure(out, &s, COL_CPU_TOTAL, frame, "%.3g", "");
        fputc('\n', out);
    }
}

static void print_times(FILE *out, lab_series s) {
    const lab_spec *spec = s.lab->spec;
    lab_table_head(out,
                   "| Frame times | first, CPU ms | median, CPU ms | median, wall ms | shadow rays, millions | "
                   "ray tracing structure, ms | renderer's memory |",
                   6);
    for (s.config = 0; s.config < spec->config_count; s.config++) {
        char memory[32];
        fputc('|', out);
        lab_cell(out, spec->configs[s.config].name);
        lab_number(out, 1e3 * lab_at(&s, COL_CPU, 1), "%.1f");
        lab_number(out, 1e3 * lab_median(&s, COL_CPU), "%.1f");
        lab_number(out, 1e3 * lab_median(&s, COL_WALL), "%.1f");
        lab_number(out, 1e-6 * lab_median(&s, COL_RAYS), "%.2f");
        lab_number(out, 1e3 * lab_median(&s, COL_BUILD), "%.1f");
        double bytes = lab_median(&s, COL_MEMORY);
        noc_fprintf(out, " %s |\n", bytes >= 0 ? noc_text_bytes(memory, (uint64_t)bytes) : "-");
    }
}

/* Of a repetition that is there with its first frame, the time of that. */
static double first_time_to(const lab_series *s, int column, double error) {
    double seconds = lab_time_to(s, column, error);
    return seconds == 0 ? lab_at(s, COL_CPU_TOTAL, 1) : seconds;
}

/* CPU seconds to an error, and errors after CPU seconds. */
static void print_equal_time(FILE *out, lab_series s) {
    const lab_spec *spec = s.lab->spec;
    int column = spec->figure == LAB_RMSE8 ? spec->all_pixels ? COL_CLAMPED_ALL : COL_CLAMPED : lab_column(spec);
    char head[400];
    int at = noc_snprintf(head, sizeof(head), "| CPU seconds to relMSE |");
    for (size_t i = 0; i < 3; i++)
        at += noc_snprintf(head + at, sizeof(head) - (size_t)at, " %g |", targets[i]);
    for (size_t i = 0; i < spec->time_count; i++)
        at += noc_snprintf(head + at, sizeof(head) - (size_t)at, " relMSE after %g s |", spec->times[i]);
    lab_table_head(out, head, 3 + spec->time_count);
    for (s.config = 0; s.config < spec->config_count; s.config++) {
        fputc('|', out);
        lab_cell(out, spec->configs[s.config].name);
        for (size_t i = 0; i < 3; i++) {
            double seconds = lab_time_to(&s, column, targets[i]);
            if (seconds > 0 || isnan(seconds))
                lab_spread(out, seconds, lab_error_of(&s, first_time_to, column, targets[i]), "%.3g", "");
            else
                lab_number(out, lab_at(&s, COL_CPU_TOTAL, 1), "under %.3g");
        }
        for (size_t i = 0; i < spec->time_count; i++)
            lab_spread(out, lab_error_after(&s, column, spec->times[i]),
                       lab_error_of(&s, lab_error_after, column, spec->times[i]), "%.3g", "");
        fputc('\n', out);
    }
    noc_fprintf(out, "\nBetween frames by interpolation in logarithms; \"under\": the first frame is better already; "
                     "-: not reached in the frames rendered, or before the first frame is done.\n");
}

static void print_truth(FILE *out, const lab_session *lab, size_t index) {
    const lab_truth *truth = &lab->truths[index];
    const noc_lab_noise *n = &truth->noise;
    bool all = lab->spec->all_pixels;
    fputs("\nThe reference was rendered by ", out);
    lab_text(out, truth->device);
    fputs(".\n", out);
    if (isfinite(n->relmse))
        noc_fprintf(
            out, "\nThe reference's own noise is a relMSE of about %.2g, clamped %.2g: errors near it say nothing.\n",
            all ? n->relmse_all : n->relmse, all ? n->relmse_clamped_all : n->relmse_clamped);
    if (isfinite(all ? n->mean_all : n->mean))
        noc_fprintf(out, "\nIts mean has a standard error of %.2g %%, which any bias is off by too.\n",
                    100 * (all ? n->mean_all : n->mean));
    char unlit[2 * LAB_TEXT];
    if (lab_tell_unlit(lab, index, unlit)) {
        *unlit = 'U';
        fputc('\n', out);
        lab_text(out, unlit);
        fputc('\n', out);
    }
}

/* Plots and tables of one mode. */
static noc_status print_mode(FILE *out, const lab_session *lab, size_t camera, int mode) {
    const lab_spec *spec = lab->spec;
    noc_status status = NOC_OK;
    int first = spec->all_pixels ? COL_RMSE8_ALL : COL_RMSE8, motion = spec->cameras[camera].frames;
    lab_series s = { lab, camera, 0, mode, 0 };
    char slug[LAB_TEXT], clamped[48], before[64];
    lab_slug(spec, camera, slug);
    if (motion)
        noc_fprintf(out, "\n### Frame %d, after %s %s\n", motion, noc_text_many(before, (uint64_t)motion - 1, "frame"),
                    spec->cameras[camera].cut ? "and a cut" : "of motion");
    else
        noc_fprintf(out, "\n### %s\n", mode_names[mode]);
    for (int over_time = 0; !status && !motion && over_time <= (mode == LAB_ACCUMULATED); over_time++) {
        char name[LAB_TEXT + 20];
        noc_snprintf(name, sizeof(name), "%s-%s-%s.svg", slug, mode ? "mean" : "alone", over_time ? "cpu" : "frames");
        status = lab_plot(lab, camera, mode, over_time, name);
        noc_fprintf(out, "\n![Error over %s](%s)\n", over_time ? "CPU time" : "frames", name);
    }
    noc_fprintf(out, "\nOn %s:\n", spec->all_pixels ? "all pixels" : "pixels that see no emitter");
    noc_snprintf(clamped, sizeof(clamped), "relMSE clamped to %g cd/m2", spec->ceiling);
    if (motion)
        print_one_frame(out, s, clamped, first);
    else
        print_all_frames(out, s, clamped, first);
    if (mode == LAB_ACCUMULATED || (spec->accumulate == LAB_ALONE && !motion))
        print_equal_time(out, s);
    if (mode == LAB_ACCUMULATED || spec->accumulate == LAB_ALONE || motion)
        print_times(out, s);
    return status;
}

static noc_status print_view(FILE *out, const lab_session *lab, size_t camera) {
    const lab_spec *spec = lab->spec;
    noc_status status = NOC_OK;
    char view[LAB_TEXT];
    fputs("\n## ", out);
    lab_text(out, lab_view_name(spec, camera, view));
    fputc('\n', out);
    print_truth(out, lab, camera);
    print_crops(out, lab, camera);
    for (int mode = LAB_MODES - 1; !status && mode >= 0; mode--)
        if (lab_has_mode(spec, camera, mode))
            status = print_mode(out, lab, camera, mode);
    return status;
}

/* Over all cameras. */
static noc_status print_charts(FILE *out, const lab_session *lab) {
    noc_status status = lab_write_summary(lab);
    noc_fprintf(out, "\nIn short: [summary.md](summary.md).\n");
    if (!status && lab_has_dots(lab->spec)) {
        status = lab_dots(lab, "errors.svg");
        noc_fprintf(out, "\n![Errors](errors.svg)\n");
    }
    if (!status && lab_has_bars(lab->spec)) {
        status = lab_bars(lab, "frame-times.svg");
        noc_fprintf(out, "\n![Frame times](frame-times.svg)\n");
    }
    return status;
}

noc_status lab_write_report(const lab_session *lab) {
    output file;
    noc_status status = lab_create_file(lab->folder, "report.md", lab->log, &file);
    if (status)
        return status;
    print_setting(file.file, lab);
    status = print_charts(file.file, lab);
    for (size_t camera = 0; !status && camera < lab->spec->camera_count; camera++)
        status = print_view(file.file, lab, camera);
    return output_close(&file, status, lab->log);
}
