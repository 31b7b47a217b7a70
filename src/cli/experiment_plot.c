/* Plots as SVG: logarithmic axes, one curve a configuration. Colours keep apart for the colour-blind (after Okabe and Ito),
 * and each curve has its own marker too; a style sheet in the file swaps them where the reader's system is dark. */
#include "experiment.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    COLOURS = 7, LEFT = 74, TOP = 44, BOTTOM = 56, PLOT_WIDTH = 560, LEAST_HEIGHT = 340, MOST_HEIGHT = 600, LEGEND_ROW = 20,
    NAME_MAX_CHARS = 44
};
static const char *const light[COLOURS] = { "#0072b2", "#d55e00", "#009e73", "#b8568f", "#c98600", "#3a9bd6", "#666666" };
static const char *const dark[COLOURS] = { "#4aa8e8", "#f2833a", "#2fc79a", "#e49ac4", "#f0b93a", "#9bd8fa", "#bbbbbb" };
static const char *const dashes[] = { "", " stroke-dasharray=\"7 4\"", " stroke-dasharray=\"2 3\"" };

typedef struct axis { double lo, hi, from, to; /* values, and where they lie in px */ } axis;

/* Configurations of one entry of the spec share marker and dashes, those of one choice the colour; without choices each has
 * all of its own. */
typedef struct curve_style { int colour, marker; const char *dash; } curve_style;

static curve_style style_of(const experiment_spec *spec, size_t config) {
    int choices = 0, alone = 0;
    for (size_t i = 0; i < spec->config_count; i++) {
        choices = spec->configs[i].choice >= choices ? spec->configs[i].choice + 1 : choices;
        alone += i < config && spec->configs[i].choice < 0;
    }
    const experiment_config *c = &spec->configs[config];
    int colour = c->choice < 0 ? choices + alone : c->choice;
    int line = choices ? c->entry : alone / COLOURS;
    return (curve_style){ colour % COLOURS, (choices ? c->entry : alone) % 8, dashes[line % 3] };
}

static double place(const axis *a, double v) { return a->from + (a->to - a->from) * log(v / a->lo) / log(a->hi / a->lo); }

/* The i-th of ..., 0.1, 0.2, 0.5, 1, 2, 5, 10, ...; 0 is 1. */
static double round_number(int i) {
    static const double steps[] = { 1, 2, 5 };
    int decade = (int)floor(i / 3.0);
    return steps[i - 3 * decade] * pow(10, decade);
}

/* Out to round numbers, so that at least two ticks are there. */
static void widen(axis *a) {
    int i = -45, j;
    while (i < 45 && round_number(i + 1) <= a->lo * 1.000001)
        i++;
    for (j = i + 1; j < 45 && round_number(j) < a->hi * 0.999999;)
        j++;
    a->lo = round_number(i);
    a->hi = round_number(j);
}

static void escape(FILE *out, const char *text, int limit) {
    int n = 0;
    for (const char *c = text; *c; c++) {
        bool starts = ((unsigned char)*c & 0xc0) != 0x80;
        if (starts && n++ == limit) {
            fputs("\342\200\246", out);
            return;
        }
        switch (*c) {
        case '&': fputs("&amp;", out); break;
        case '<': fputs("&lt;", out); break;
        case '>': fputs("&gt;", out); break;
        case '"': fputs("&quot;", out); break;
        default: fputc(*c, out);
        }
    }
}

static void head(FILE *out, int width, int height) {
    fprintf(out, "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" viewBox=\"0 0 %d %d\" "
                 "font-family=\"sans-serif\" font-size=\"13\">\n<style>\n"
                 "@media (prefers-color-scheme: dark) {\n.paper { fill: #14171c } .ink { fill: #e6e6e6 } .grid { stroke: #343a44 } "
                 ".frame { stroke: #8a93a0 }\n", width, height, width, height);
    for (int i = 0; i < COLOURS; i++)
        fprintf(out, ".l%d { stroke: %s } .m%d { fill: %s }\n", i, dark[i], i, dark[i]);
    fprintf(out, "}\n</style>\n<rect class=\"paper\" width=\"%d\" height=\"%d\" fill=\"#ffffff\"/>\n", width, height);
}

/* Four shapes, filled, then hollow. */
static void marker(FILE *out, const curve_style *style, double x, double y) {
    int c = style->colour;
    if (style->marker < 4)
        fprintf(out, "<path class=\"m%d\" fill=\"%s\" d=\"", c, light[c]);
    else
        fprintf(out, "<path class=\"l%d paper\" fill=\"#ffffff\" stroke=\"%s\" stroke-width=\"1.5\" d=\"", c, light[c]);
    switch (style->marker % 4) {
    case 0: fprintf(out, "M%.1f %.1fa3.5 3.5 0 1 0 7 0a3.5 3.5 0 1 0 -7 0z", x - 3.5, y); break;
    case 1: fprintf(out, "M%.1f %.1fh6v6h-6z", x - 3, y - 3); break;
    case 2: fprintf(out, "M%.1f %.1fl4 7h-8z", x, y - 4.5); break;
    default: fprintf(out, "M%.1f %.1fl4.5 4.5l-4.5 4.5l-4.5 -4.5z", x, y - 4.5);
    }
    fprintf(out, "\"/>\n");
}

/* Lines and numbers across the plot; every tick has a line, numbers thin out where they would touch. */
static void grid(FILE *out, const axis *a, bool vertical, int bottom) {
    double decades = log10(a->hi / a->lo), last = -1e9;
    for (int i = -45; i <= 45; i++) {
        double v = round_number(i), at;
        if (v < a->lo * 0.999999 || v > a->hi * 1.000001)
            continue;
        at = place(a, v);
        if (vertical)
            fprintf(out, "<path class=\"grid\" stroke=\"#dcdcdc\" d=\"M%.1f %dV%d\"/>\n", at, TOP, bottom);
        else
            fprintf(out, "<path class=\"grid\" stroke=\"#dcdcdc\" d=\"M%d %.1fH%d\"/>\n", LEFT, at, LEFT + PLOT_WIDTH);
        if (fabs(at - last) < (vertical ? 34 : 15) || (decades > 4 && i % 3))
            continue;
        last = at;
        fprintf(out, "<text class=\"ink\" fill=\"#222222\" x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">%.10g</text>\n",
                vertical ? at : LEFT - 8, vertical ? bottom + 18 : at + 4.5, vertical ? "middle" : "end", v);
    }
}

static void curve(FILE *out, const experiment_series *s, bool over_time, const axis *x, const axis *y) {
    int column = experiment_column(&s->lab->spec);
    curve_style style = style_of(&s->lab->spec, s->config);
    int frames = s->lab->spec.configs[s->config].frames;
    fprintf(out, "<g>\n<polyline class=\"l%d\" fill=\"none\" stroke=\"%s\" stroke-width=\"2\" stroke-linejoin=\"round\"%s points=\"",
            style.colour, light[style.colour], style.dash);
    for (int pass = 0; pass < 2; pass++) {
        double last = -1e9;
        for (int f = 1; f <= frames; f++) {
            double e = experiment_at(s, column, f), t = over_time ? experiment_at(s, COL_CPU_TOTAL, f) : f;
            if (!(e > 0 && t > 0 && isfinite(e)))
                continue;
            double px = place(x, t), py = place(y, e);
            if (!pass) {
                fprintf(out, "%.1f,%.1f ", px, py);
            } else if (px - last >= 12) { /* markers only where they do not run together */
                marker(out, &style, px, py);
                last = px;
            }
        }
        if (!pass)
            fprintf(out, "\"/>\n");
    }
    fprintf(out, "</g>\n");
}

static void legend(FILE *out, const experiment_lab *lab) {
    for (size_t i = 0; i < lab->spec.config_count; i++) {
        int x = LEFT + PLOT_WIDTH + 20, y = TOP + 10 + LEGEND_ROW * (int)i;
        curve_style style = style_of(&lab->spec, i);
        fprintf(out, "<path class=\"l%d\" stroke=\"%s\" stroke-width=\"2\"%s d=\"M%d %dh26\"/>\n", style.colour,
                light[style.colour], style.dash, x, y);
        marker(out, &style, x + 13, y);
        fprintf(out, "<text class=\"ink\" fill=\"#222222\" x=\"%d\" y=\"%.1f\">", x + 34, y + 4.5);
        escape(out, lab->spec.configs[i].name, NAME_MAX_CHARS);
        fprintf(out, "</text>\n");
    }
}

static void ranges(const experiment_lab *lab, experiment_series s, bool over_time, int bottom, axis *x, axis *y) {
    int column = experiment_column(&lab->spec), most = 1;
    *x = (axis){ INFINITY, 0, LEFT, LEFT + PLOT_WIDTH };
    *y = (axis){ INFINITY, 0, bottom, TOP };
    for (s.config = 0; s.config < lab->spec.config_count; s.config++) {
        int frames = lab->spec.configs[s.config].frames;
        most = frames > most ? frames : most;
        for (int f = 1; f <= frames; f++) {
            double e = experiment_at(&s, column, f), t = over_time ? experiment_at(&s, COL_CPU_TOTAL, f) : f;
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
    widen(y);
    if (over_time) {
        widen(x);
    } else {
        x->lo = 1;
        x->hi = most > 1 ? most : 2;
    }
}

static int name_length(const experiment_lab *lab) {
    size_t most = 0;
    for (size_t i = 0; i < lab->spec.config_count; i++)
        most = strlen(lab->spec.configs[i].name) > most ? strlen(lab->spec.configs[i].name) : most;
    return most > NAME_MAX_CHARS ? NAME_MAX_CHARS : (int)most;
}

int experiment_plot(const experiment_lab *lab, size_t scene, size_t camera, int mode, bool over_time, const char *name) {
    const experiment_spec *spec = &lab->spec;
    experiment_series s = { lab, scene, camera, 0, mode };
    axis x, y;
    int rows = LEGEND_ROW * (int)spec->config_count;
    int plot = rows < LEAST_HEIGHT ? LEAST_HEIGHT : rows > MOST_HEIGHT ? MOST_HEIGHT : rows;
    int width = LEFT + PLOT_WIDTH + 64 + (name_length(lab) + 2) * 7, bottom = TOP + plot;
    int height = TOP + (rows > plot ? rows : plot) + BOTTOM;
    ranges(lab, s, over_time, bottom, &x, &y);
    char *temporary;
    FILE *out = experiment_create(lab, name, &temporary);
    if (!out)
        return CLI_FAILURE;
    head(out, width, height);
    fprintf(out, "<text class=\"ink\" fill=\"#222222\" x=\"%d\" y=\"26\" font-size=\"15\" font-weight=\"bold\">", LEFT);
    escape(out, spec->scenes[scene].name, 60);
    fputs(", ", out);
    escape(out, spec->cameras[camera].name, 60);
    fprintf(out, "%s</text>\n", mode == EXPERIMENT_ALONE ? ": each frame alone" : ": mean of the frames so far");
    grid(out, &x, true, bottom);
    grid(out, &y, false, bottom);
    fprintf(out, "<rect class=\"frame\" fill=\"none\" stroke=\"#555555\" x=\"%d\" y=\"%d\" width=\"%d\" height=\"%d\"/>\n", LEFT, TOP,
            PLOT_WIDTH, plot);
    for (s.config = 0; s.config < spec->config_count; s.config++)
        curve(out, &s, over_time, &x, &y);
    legend(out, lab);
    fprintf(out, "<text class=\"ink\" fill=\"#222222\" x=\"%d\" y=\"%d\" text-anchor=\"middle\">%s</text>\n", LEFT + PLOT_WIDTH / 2,
            bottom + 42, over_time ? "process CPU time, seconds" : "frame");
    fprintf(out, "<text class=\"ink\" fill=\"#222222\" transform=\"translate(20 %d) rotate(-90)\" text-anchor=\"middle\">",
            TOP + plot / 2);
    escape(out, experiment_figure(spec), 100);
    fprintf(out, "</text>\n</svg>\n");
    return experiment_finish(lab, out, name, temporary);
}
