/* What the laboratory's plots are drawn with. Colours keep apart for the colour-blind (after Okabe and Ito), and each
 * curve has its own marker too; a style sheet in the file swaps them where the reader's system is dark. */
#include "lab/svg.h"

#include <math.h>

const char *const svg_colours[SVG_COLOURS] = { "#0072b2", "#d55e00", "#009e73", "#b8568f",
                                               "#c98600", "#3a9bd6", "#666666" };
static const char *const dark[SVG_COLOURS] = { "#4aa8e8", "#f2833a", "#2fc79a", "#e49ac4",
                                               "#f0b93a", "#9bd8fa", "#bbbbbb" };
static const char *const dashes[] = { "", " stroke-dasharray=\"7 4\"", " stroke-dasharray=\"2 3\"" };

/* The first configuration that has this one's value of the same option. Where in its array a value stands says nothing:
 * entries of one spec may list different ones. */
static size_t first_like(const lab_spec *spec, size_t config) {
    const lab_config *c = &spec->configs[config];
    size_t i = 0;
    while (i < config &&
           (!c->option || spec->configs[i].option != c->option || strcmp(spec->configs[i].value, c->value)))
        i++;
    return i;
}

bool svg_is_new_value(const lab_spec *spec, size_t config) {
    return spec->configs[config].option && first_like(spec, config) == config;
}

svg_style svg_style_of(const lab_spec *spec, size_t config) {
    int values = 0, alone = 0, value = 0;
    const lab_config *c = &spec->configs[config];
    size_t first = first_like(spec, config);
    for (size_t i = 0; i < spec->config_count; i++) {
        bool is_new = svg_is_new_value(spec, i);
        values += is_new;
        value += is_new && i < first;
        alone += i < config && !spec->configs[i].option;
    }
    /* colours come again: other markers tell them apart */
    int colour = c->option ? value : values + alone, around = colour / SVG_COLOURS;
    int line = values ? (int)c->entry : around;
    return (svg_style){ colour % SVG_COLOURS, ((values ? (int)c->entry + around : alone)) % SVG_MARKERS,
                        colour % SVG_MARKERS, dashes[line % 3] };
}

double svg_place(const svg_axis *a, double v) {
    return a->from + (a->to - a->from) * log(v / a->lo) / log(a->hi / a->lo);
}

double svg_inside(const svg_axis *a, double v) { return svg_place(a, v > a->lo ? v < a->hi ? v : a->hi : a->lo); }

void svg_whisker(FILE *out, int colour, double from, double to, double y) {
    noc_fprintf(
        out,
        "<path class=\"l%d whisker\" fill=\"none\" stroke=\"%s\" d=\"M%.1f %.1fH%.1fM%.1f %.1fv6M%.1f %.1fv6\"/>\n",
        colour, svg_colours[colour], from, y, to, from, y - 3, to, y - 3);
}

/* The i-th of ..., 0.1, 0.2, 0.5, 1, 2, 5, 10, ...; 0 is 1. */
static double round_number(int i) {
    static const double steps[] = { 1, 2, 5 };
    int decade = (int)floor(i / 3.0);
    return steps[i - 3 * decade] * pow(10, decade);
}

/* Room that a number takes along its axis. */
static double room_of(double v, bool vertical) {
    char text[32];
    return vertical ? 7.5 * noc_snprintf(text, sizeof(text), "%.10g", v) + 6 : 15;
}

static bool is_free(const svg_axis *a, bool vertical, double v, double other) {
    return fabs(svg_place(a, v) - svg_place(a, other)) >= 0.5 * (room_of(v, vertical) + room_of(other, vertical));
}

static bool is_on(const svg_axis *a, double v) { return v >= a->lo * 0.999999 && v <= a->hi * 1.000001; }

/* Do the numbers of every step-th round value, from 1 on, stand apart? */
static bool fits(const svg_axis *a, bool vertical, int step) {
    double last = 0;
    for (int i = -45; i <= 45; i++) {
        double v = round_number(i);
        if (i % step || !is_on(a, v))
            continue;
        if (last > 0 && !is_free(a, vertical, v, last))
            return false;
        last = v;
    }
    return true;
}

/* Both ends of an axis are ticks with numbers: 1, 2, 5, ... where there is room for all of them, else powers of ten. */
void svg_widen(svg_axis *a) {
    bool vertical = a->from < a->to;
    double lo = a->lo, hi = a->hi;
    for (int step = 1; step <= 3; step += 2) {
        int i = -45, j;
        while (i + step <= 45 && round_number(i + step) <= lo * 1.000001)
            i += step;
        for (j = i + step; j < 45 && round_number(j) < hi * 0.999999;)
            j += step;
        a->lo = round_number(i);
        a->hi = round_number(j);
        if (fits(a, vertical, 1))
            break;
    }
}

void svg_text(FILE *out, const char *text, int limit) {
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

void svg_head(FILE *out, int width, int height) {
    noc_fprintf(out,
                "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" viewBox=\"0 0 %d %d\" "
                "font-family=\"sans-serif\" font-size=\"13\">\n<style>\n"
                "@media (prefers-color-scheme: dark) {\n"
                ".paper { fill: #14171c } .ink { fill: #e6e6e6 } .grid { stroke: #343a44 } "
                ".frame { stroke: #8a93a0 }\n",
                width, height, width, height);
    for (int i = 0; i < SVG_COLOURS; i++)
        noc_fprintf(out, ".l%d { stroke: %s } .m%d { fill: %s }\n", i, dark[i], i, dark[i]);
    noc_fprintf(out, "}\n</style>\n<rect class=\"paper\" width=\"%d\" height=\"%d\" fill=\"#ffffff\"/>\n", width,
                height);
}

/* Four shapes, filled, then hollow. */
void svg_marker(FILE *out, const svg_style *style, double x, double y) {
    int c = style->colour;
    if (style->marker < 4)
        noc_fprintf(out, "<path class=\"m%d\" fill=\"%s\" d=\"", c, svg_colours[c]);
    else
        noc_fprintf(out, "<path class=\"l%d paper\" fill=\"#ffffff\" stroke=\"%s\" stroke-width=\"1.5\" d=\"", c,
                    svg_colours[c]);
    switch (style->marker % 4) {
    case 0: noc_fprintf(out, "M%.1f %.1fa3.5 3.5 0 1 0 7 0a3.5 3.5 0 1 0 -7 0z", x - 3.5, y); break;
    case 1: noc_fprintf(out, "M%.1f %.1fh6v6h-6z", x - 3, y - 3); break;
    case 2: noc_fprintf(out, "M%.1f %.1fl4 7h-8z", x, y - 4.5); break;
    default: noc_fprintf(out, "M%.1f %.1fl4.5 4.5l-4.5 4.5l-4.5 -4.5z", x, y - 4.5);
    }
    noc_fprintf(out, "\"/>\n");
}

/* A line across the plot, and its number. */
static void tick(FILE *out, const svg_axis *a, bool vertical, const svg_axis *other, double v, bool numbered) {
    double at = svg_place(a, v);
    if (vertical)
        noc_fprintf(out, "<path class=\"grid\" stroke=\"#dcdcdc\" d=\"M%.1f %gV%g\"/>\n", at, other->to, other->from);
    else
        noc_fprintf(out, "<path class=\"grid\" stroke=\"#dcdcdc\" d=\"M%g %.1fH%g\"/>\n", other->from, at, other->to);
    if (numbered)
        noc_fprintf(out, "<text class=\"ink\" fill=\"#222222\" x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">%.10g</text>\n",
                    vertical ? at : other->from - 8, vertical ? other->from + 18 : at + 4.5,
                    vertical ? "middle" : "end", v);
}

void svg_grid(FILE *out, const svg_axis *a, bool vertical, const svg_axis *other) {
    int step = 1;
    while (step < 45 && !fits(a, vertical, step))
        step = step == 1 ? 3 : step + 3;
    for (int i = -45; i <= 45; i++) {
        double v = round_number(i);
        if (is_on(a, v) && v < a->hi * 0.999999)
            tick(out, a, vertical, other, v, i % step == 0 && is_free(a, vertical, v, a->hi));
    }
    tick(out, a, vertical, other, a->hi, true);
}
