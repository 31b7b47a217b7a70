/* Error over frames or CPU seconds as SVG: logarithmic axes, one curve a configuration. */
#include "lab/plot.h"
#include "lab/file.h"
#include "lab/series.h"
#include "lab/svg.h"

#include <math.h>

enum {
    LEFT = 74,
    TOP = 44,
    BOTTOM = 56,
    PLOT_WIDTH = 560,
    LEAST_HEIGHT = 340,
    MOST_HEIGHT = 600,
    LEGEND_ROW = 20,
    NAME_MAX_CHARS = 44
};

/* What lies within a standard error of the mean over the repetitions. */
static void band(FILE *out, const lab_series *s, bool over_time, const svg_axis *x, const svg_axis *y) {
    int column = lab_column(s->lab->spec), frames = lab_last(s), colour = svg_style_of(s->lab->spec, s->config).colour;
    if (s->lab->spec->repetitions < 2)
        return;
    noc_fprintf(out, "<polygon class=\"m%d\" fill=\"%s\" fill-opacity=\"0.2\" points=\"", colour, svg_colours[colour]);
    for (int side = 0; side < 2; side++) /* there above the curve, back below it */
        for (int i = 1; i <= frames; i++) {
            int f = side ? frames + 1 - i : i;
            double e = lab_at(s, column, f), t = over_time ? lab_at(s, COL_CPU_TOTAL, f) : f;
            double off = lab_error_at(s, column, f);
            if (e > 0 && t > 0 && isfinite(e) && isfinite(off))
                noc_fprintf(out, "%.1f,%.1f ", svg_place(x, t), svg_inside(y, side ? e - off : e + off));
        }
    noc_fprintf(out, "\"/>\n");
}

static void curve(FILE *out, const lab_series *s, bool over_time, const svg_axis *x, const svg_axis *y) {
    int column = lab_column(s->lab->spec);
    svg_style style = svg_style_of(s->lab->spec, s->config);
    int frames = lab_last(s);
    noc_fprintf(
        out,
        "<g>\n<polyline class=\"l%d\" fill=\"none\" stroke=\"%s\" stroke-width=\"2\" stroke-linejoin=\"round\"%s "
        "points=\"",
        style.colour, svg_colours[style.colour], style.dash);
    for (int pass = 0; pass < 2; pass++) {
        double last = -1e9;
        for (int f = 1; f <= frames; f++) {
            double e = lab_at(s, column, f), t = over_time ? lab_at(s, COL_CPU_TOTAL, f) : f;
            if (!(e > 0 && t > 0 && isfinite(e)))
                continue;
            double px = svg_place(x, t), py = svg_place(y, e);
            if (!pass) {
                noc_fprintf(out, "%.1f,%.1f ", px, py);
            } else if (px - last >= 12) { /* markers only where they do not run together */
                svg_marker(out, &style, px, py);
                last = px;
            }
        }
        if (!pass)
            noc_fprintf(out, "\"/>\n");
    }
    noc_fprintf(out, "</g>\n");
}

static void legend(FILE *out, const lab_session *lab) {
    for (size_t i = 0; i < lab->spec->config_count; i++) {
        int x = LEFT + PLOT_WIDTH + 20, y = TOP + 10 + LEGEND_ROW * (int)i;
        svg_style style = svg_style_of(lab->spec, i);
        noc_fprintf(out, "<path class=\"l%d\" stroke=\"%s\" stroke-width=\"2\"%s d=\"M%d %dh26\"/>\n", style.colour,
                    svg_colours[style.colour], style.dash, x, y);
        svg_marker(out, &style, x + 13, y);
        noc_fprintf(out, "<text class=\"ink\" fill=\"#222222\" x=\"%d\" y=\"%.1f\">", x + 34, y + 4.5);
        svg_text(out, lab->spec->configs[i].name, NAME_MAX_CHARS);
        noc_fprintf(out, "</text>\n");
    }
}

static void ranges(const lab_session *lab, lab_series s, bool over_time, int bottom, svg_axis *x, svg_axis *y) {
    int column = lab_column(lab->spec), most = 1;
    *x = (svg_axis){ INFINITY, 0, LEFT, LEFT + PLOT_WIDTH };
    *y = (svg_axis){ INFINITY, 0, bottom, TOP };
    for (s.config = 0; s.config < lab->spec->config_count; s.config++) {
        int frames = lab_last(&s);
        most = frames > most ? frames : most;
        for (int f = 1; f <= frames; f++) {
            double e = lab_at(&s, column, f), t = over_time ? lab_at(&s, COL_CPU_TOTAL, f) : f;
            if (!(e > 0 && t > 0 && isfinite(e)))
                continue;
            x->lo = fmin(x->lo, t);
            x->hi = fmax(x->hi, t);
            y->lo = fmin(y->lo, e);
            y->hi = fmax(y->hi, e);
        }
    }
    if (!(y->hi > 0)) { /* nothing to show: all errors are zero */
        x->lo = y->lo = 0.1;
        x->hi = y->hi = 1;
    }
    svg_widen(y);
    if (over_time) {
        svg_widen(x);
    } else {
        x->lo = 1;
        x->hi = most > 1 ? most : 2;
    }
}

static int name_length(const lab_session *lab) {
    size_t most = 0;
    for (size_t i = 0; i < lab->spec->config_count; i++)
        most = strlen(lab->spec->configs[i].name) > most ? strlen(lab->spec->configs[i].name) : most;
    return most > NAME_MAX_CHARS ? NAME_MAX_CHARS : (int)most;
}

noc_status lab_plot(const lab_session *lab, size_t camera, int mode, bool over_time, const char *name) {
    const lab_spec *spec = lab->spec;
    lab_series s = { lab, camera, 0, mode, 0 };
    svg_axis x, y;
    int rows = LEGEND_ROW * (int)spec->config_count;
    int plot = rows < LEAST_HEIGHT ? LEAST_HEIGHT : rows > MOST_HEIGHT ? MOST_HEIGHT : rows;
    int width = LEFT + PLOT_WIDTH + 64 + (name_length(lab) + 2) * 7, bottom = TOP + plot;
    int height = TOP + (rows > plot ? rows : plot) + BOTTOM;
    ranges(lab, s, over_time, bottom, &x, &y);
    output file;
    noc_status status = lab_create_file(lab->folder, name, lab->log, &file);
    if (status)
        return status;
    FILE *out = file.file;
    char text[LAB_TEXT];
    svg_head(out, width, height);
    noc_fprintf(out, "<text class=\"ink\" fill=\"#222222\" x=\"%d\" y=\"26\" font-size=\"15\" font-weight=\"bold\">",
                LEFT);
    svg_text(out, spec->scenes[spec->cameras[camera].scene].name, 60);
    fputs(", ", out);
    svg_text(out, spec->cameras[camera].name, 60);
    noc_fprintf(out, "%s</text>\n", mode == LAB_ALONE ? ": each frame alone" : ": mean of the frames so far");
    svg_grid(out, &x, true, &y);
    svg_grid(out, &y, false, &x);
    noc_fprintf(
        out, "<rect class=\"frame\" fill=\"none\" stroke=\"#555555\" x=\"%d\" y=\"%d\" width=\"%d\" height=\"%d\"/>\n",
        LEFT, TOP, PLOT_WIDTH, plot);
    for (s.config = 0; s.config < spec->config_count; s.config++)
        band(out, &s, over_time, &x, &y);
    for (s.config = 0; s.config < spec->config_count; s.config++)
        curve(out, &s, over_time, &x, &y);
    legend(out, lab);
    noc_fprintf(out, "<text class=\"ink\" fill=\"#222222\" x=\"%d\" y=\"%d\" text-anchor=\"middle\">%s</text>\n",
                LEFT + PLOT_WIDTH / 2, bottom + 42, over_time ? "process CPU time, seconds" : "frame");
    noc_fprintf(
        out, "<text class=\"ink\" fill=\"#222222\" transform=\"translate(20 %d) rotate(-90)\" text-anchor=\"middle\">",
        TOP + plot / 2);
    svg_text(out, lab_figure(spec, text), 100);
    fputs("</text>\n", out);
    if (spec->repetitions > 1)
        noc_fprintf(out,
                    "<text class=\"ink\" fill=\"#222222\" x=\"%d\" y=\"%d\" text-anchor=\"end\" "
                    "font-size=\"11\">bands: \302\261 standard error of %d repetitions</text>\n",
                    LEFT + PLOT_WIDTH, bottom + 42, spec->repetitions);
    fputs("</svg>\n", out);
    return output_close(&file, NOC_OK, lab->log);
}
