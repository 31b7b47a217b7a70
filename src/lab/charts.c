/* Charts over all cameras of an experiment: frame times as bars, and errors as dots, a panel for each camera and frame.
 */
#include "lab/charts.h"
#include "lab/file.h"
#include "lab/series.h"
#include "lab/svg.h"

#include <math.h>

enum {
    BAR_MOST = 24,
    NAME_MAX_CHARS = 40,
    CHAR = 7,
    LINE = 20,
    TOP = 44,
    GAP = 26,
    BARS_WIDTH = 480,
    PANEL_WIDTH = 220,
    PANEL_GAP = 36,
    BOTTOM = 34,
    DOT_MOST = 60
};

static int name_width(const lab_session *lab, bool rows) {
    size_t most = 4;
    for (size_t i = 0; i < lab->spec->config_count; i++) {
        char row[LAB_TEXT];
        const char *name = rows ? lab_row_name(lab->spec, i, row) : lab->spec->configs[i].name;
        most = NOC_MAX(strlen(name), most);
    }
    return (int)(most > NAME_MAX_CHARS ? NAME_MAX_CHARS : most) * CHAR + 18;
}

static void words(FILE *out, double x, double y, const char *anchor, const char *style, const char *text) {
    noc_fprintf(out, "<text class=\"ink\" fill=\"#222222\" x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\"%s>", x, y, anchor,
                style);
    svg_text(out, text, 100);
    noc_fprintf(out, "</text>\n");
}

static void view_name(FILE *out, const lab_session *lab, size_t camera, double x, double y) {
    char name[LAB_TEXT];
    words(out, x, y, "start", " font-weight=\"bold\"", lab_view_name(lab->spec, camera, name));
}

/* The next of 1, 2, 5, 10, ... from v on. */
static double round_up(double v) {
    double decade = pow(10, floor(log10(v)));
    return v <= decade * 1.0001 ? decade : v <= 2 * decade ? 2 * decade : v <= 5 * decade ? 5 * decade : 10 * decade;
}

bool lab_has_bars(const lab_spec *spec) { return spec->config_count <= BAR_MOST; }

static double bar_of(const lab_session *lab, size_t camera, size_t config, double *error) {
    lab_series s = lab_timed(lab, camera, config);
    *error = lab_error_of(&s, lab_frame_time, 0, 0);
    return lab_frame_time(&s, 0, 0);
}

noc_status lab_bars(const lab_session *lab, const char *name) {
    const lab_spec *spec = lab->spec;
    int left = name_width(lab, false), rows = (int)spec->config_count;
    int width = left + BARS_WIDTH + 130, height = TOP + (int)spec->camera_count * (rows * LINE + GAP) + BOTTOM;
    double most = 0, error;
    for (size_t camera = 0; camera < spec->camera_count; camera++)
        for (size_t i = 0; i < spec->config_count; i++)
            most = fmax(most, bar_of(lab, camera, i, &error) * 1e3 + (isfinite(error) ? 1e3 * error : 0));
    double step = most > 0 ? round_up(most / 8) : 1, end = most > 0 ? ceil(most / step) * step : 1;
    output file;
    noc_status status = lab_create_file(lab->folder, name, lab->log, &file);
    if (status)
        return status;
    FILE *out = file.file;
    svg_head(out, width, height);
    words(out, left, 26, "start", " font-size=\"15\" font-weight=\"bold\"", "CPU time of a frame, ms");
    for (double v = 0; v <= end * 1.0001; v += step) {
        double x = left + BARS_WIDTH * v / end;
        char text[32];
        noc_snprintf(text, sizeof(text), "%.6g", v);
        noc_fprintf(out, "<path class=\"grid\" stroke=\"#dcdcdc\" d=\"M%.1f %dV%d\"/>\n", x, TOP, height - BOTTOM);
        words(out, x, height - BOTTOM + 18, "middle", "", text);
    }
    for (size_t camera = 0; camera < spec->camera_count; camera++) {
        int top = TOP + (int)camera * (rows * LINE + GAP) + GAP;
        view_name(out, lab, camera, left, top - 8);
        for (int i = 0; i < rows; i++) {
            double ms = bar_of(lab, camera, (size_t)i, &error) * 1e3, y = top + i * LINE;
            svg_style style = svg_style_of(spec, (size_t)i);
            words(out, left - 8, y + 13, "end", "", spec->configs[i].name);
            if (!isfinite(ms))
                continue;
            char text[64], spread[32] = "";
            double off = isfinite(error) ? 1e3 * error : 0;
            if (off > 0)
                noc_snprintf(spread, sizeof(spread), " \302\261 %.2g", off);
            noc_snprintf(text, sizeof(text), "%.3g%s", ms, spread);
            noc_fprintf(out, "<rect class=\"m%d\" fill=\"%s\" x=\"%d\" y=\"%.1f\" width=\"%.1f\" height=\"%d\"/>\n",
                        style.colour, svg_colours[style.colour], left, y + 2, BARS_WIDTH * ms / end, LINE - 5);
            if (off > 0)
                noc_fprintf(out, "<path class=\"frame\" fill=\"none\" stroke=\"#555555\" d=\"M%.1f %.1fH%.1f\"/>\n",
                            left + BARS_WIDTH * fmax(ms - off, 0) / end, y + 0.5 * LINE - 0.5,
                            left + BARS_WIDTH * (ms + off) / end);
            words(out, left + BARS_WIDTH * (ms + off) / end + 5, y + 13, "start", "", text);
        }
    }
    noc_fprintf(out, "</svg>\n");
    return output_close(&file, NOC_OK, lab->log);
}

/* Where all entries stand for values of the same option, an entry is one row of dots; else each configuration. */
static bool shares_rows(const lab_spec *spec) {
    const noc_option *option = spec->configs[0].option;
    for (size_t i = 0; i < spec->config_count; i++)
        if (spec->configs[i].option && option && spec->configs[i].option != option)
            return false;
        else
            option = spec->configs[i].option ? spec->configs[i].option : option;
    return option != NULL;
}

static int row_of(const lab_spec *spec, size_t config) {
    return shares_rows(spec) ? (int)spec->configs[config].entry : (int)config;
}

static int row_count(const lab_spec *spec) { return row_of(spec, spec->config_count - 1) + 1; }

/* One camera's errors are all on one scale, so that its frames compare. */
static svg_axis errors_of(const lab_session *lab, size_t camera) {
    svg_axis axis = { INFINITY, 0, 0, PANEL_WIDTH };
    lab_point points[LAB_POINTS];
    int count = lab_points(lab->spec, camera, points);
    for (int p = 0; p < count; p++) {
        for (size_t i = 0; i < lab->spec->config_count; i++) {
            double error, v = lab_at_point(lab, camera, i, points[p], lab_column(lab->spec), &error);
            if (v > 0 && isfinite(v)) {
                axis.lo = fmin(axis.lo, v);
                axis.hi = fmax(axis.hi, v);
            }
        }
    }
    if (!(axis.hi > 0)) {
        axis.lo = 0.1;
        axis.hi = 1;
    }
    svg_widen(&axis);
    return axis;
}

static void panel(FILE *out, const lab_session *lab, size_t camera, lab_point point, int left, int top) {
    char name[48];
    const lab_spec *spec = lab->spec;
    int rows = row_count(spec);
    svg_axis x = errors_of(lab, camera), y = { 1, 10, top + rows * LINE, top };
    x.from = left;
    x.to = left + PANEL_WIDTH;
    svg_grid(out, &x, true, &y);
    for (int r = 0; r < rows; r++)
        noc_fprintf(out, "<path class=\"grid\" stroke=\"#dcdcdc\" d=\"M%d %dh%d\"/>\n", left, top + r * LINE + LINE / 2,
                    PANEL_WIDTH);
    noc_fprintf(
        out, "<rect class=\"frame\" fill=\"none\" stroke=\"#555555\" x=\"%d\" y=\"%d\" width=\"%d\" height=\"%d\"/>\n",
        left, top, PANEL_WIDTH, rows * LINE);
    words(out, left + PANEL_WIDTH / 2, top - 7, "middle", "", lab_point_name(spec, camera, point, name));
    for (size_t i = 0; i < spec->config_count; i++) {
        double error, v = lab_at_point(lab, camera, i, point, lab_column(spec), &error),
                      at = top + row_of(spec, i) * LINE + LINE / 2;
        svg_style style = svg_style_of(spec, i);
        if (shares_rows(spec))
            style.marker = style.dot;
        if (!(v > 0 && isfinite(v)))
            continue;
        if (isfinite(error))
            svg_whisker(out, style.colour, svg_inside(&x, v - error), svg_inside(&x, v + error), at);
        svg_marker(out, &style, svg_place(&x, v), at);
    }
}

/* Values that colours stand for, whichever entry has them first, and configurations that stand alone. Returns the
 * lines that it takes. out NULL: that alone. */
static int values_legend(FILE *out, const lab_spec *spec, int left, int right, int y) {
    int x = left, lines = 1;
    for (size_t i = 0; i < spec->config_count; i++) {
        const lab_config *c = &spec->configs[i];
        if (c->option && !svg_is_new_value(spec, i))
            continue;
        const char *text = c->option ? c->value : c->name;
        int width = 40 + (int)strlen(text) * CHAR;
        if (x > left && x + width > right) {
            x = left;
            lines++;
        }
        svg_style style = svg_style_of(spec, i);
        style.marker = style.dot;
        if (out) {
            svg_marker(out, &style, x + 6, y + (lines - 1) * LINE - 4);
            words(out, x + 16, y + (lines - 1) * LINE, "start", "", text);
        }
        x += width;
    }
    return lines;
}

bool lab_has_dots(const lab_spec *spec) { return row_count(spec) <= DOT_MOST && spec->config_count > 1; }

/* Cameras with one frame to show stand side by side, up to four; true where this one starts a line of panels. */
static bool starts_line(const lab_spec *spec, size_t camera, int *column) {
    lab_point points[LAB_POINTS];
    bool beside =
        camera && *column < 4 && lab_points(spec, camera, points) == 1 && lab_points(spec, camera - 1, points) == 1;
    *column = beside ? *column + 1 : 1;
    return !beside;
}

static void row_names(FILE *out, const lab_session *lab, int left, int top) {
    bool shared = shares_rows(lab->spec);
    for (size_t i = 0; i < lab->spec->config_count; i++) {
        char text[LAB_TEXT];
        const char *row = shared ? lab_row_name(lab->spec, i, text) : lab->spec->configs[i].name;
        if (!shared || lab->spec->configs[i].choice <= 0)
            words(out, left - 8, top + row_of(lab->spec, i) * LINE + 14, "end", "", row);
    }
}

noc_status lab_dots(const lab_session *lab, const char *name) {
    const lab_spec *spec = lab->spec;
    lab_point points[LAB_POINTS];
    int left = name_width(lab, shares_rows(spec)), high = row_count(spec) * LINE + BOTTOM + GAP + 24;
    int columns = 1, lines = 0, column = 0;
    for (size_t camera = 0; camera < spec->camera_count; camera++) {
        int count = lab_points(spec, camera, points);
        lines += starts_line(spec, camera, &column);
        columns = count > columns ? count : columns;
        columns = column > columns ? column : columns;
    }
    output file;
    noc_status status = lab_create_file(lab->folder, name, lab->log, &file);
    if (status)
        return status;
    FILE *out = file.file;
    int width = left + columns * (PANEL_WIDTH + PANEL_GAP);
    int head = TOP + (shares_rows(spec) ? values_legend(NULL, spec, left, width, 0) : 1) * LINE;
    svg_head(out, width, head + lines * high);
    char figure[LAB_TEXT];
    words(out, left, 26, "start", " font-size=\"15\" font-weight=\"bold\"", lab_figure(spec, figure));
    if (shares_rows(spec))
        values_legend(out, spec, left, width, TOP + 8);
    int line = -1;
    column = 0;
    for (size_t camera = 0; camera < spec->camera_count; camera++) {
        bool starts = starts_line(spec, camera, &column);
        line += starts;
        int top = head + line * high + GAP + 20, from = left + (column - 1) * (PANEL_WIDTH + PANEL_GAP);
        int count = lab_points(spec, camera, points);
        view_name(out, lab, camera, from, top - 28);
        if (starts)
            row_names(out, lab, left, top);
        for (int p = 0; p < count; p++)
            panel(out, lab, camera, points[p], from + p * (PANEL_WIDTH + PANEL_GAP), top);
    }
    noc_fprintf(out, "</svg>\n");
    return output_close(&file, NOC_OK, lab->log);
}
