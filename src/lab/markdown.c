/* Text, numbers and tables in Markdown. */
#include "lab/markdown.h"

#include <math.h>

void lab_text(FILE *out, const char *text) {
    for (const char *c = text; *c; c++)
        switch (*c) {
        case '&': fputs("&amp;", out); break;
        case '<': fputs("&lt;", out); break;
        case '>': fputs("&gt;", out); break;
        default:
            if (strchr("|\\`*_[]~", *c))
                fputc('\\', out);
            fputc(*c, out);
        }
}

void lab_cell(FILE *out, const char *text) {
    fputc(' ', out);
    lab_text(out, text);
    fputs(" |", out);
}

void lab_number(FILE *out, double v, const char *fmt) {
    char text[40] = "-";
    if (isfinite(v))
        noc_snprintf(text, sizeof(text), fmt, v);
    noc_fprintf(out, " %s |", text);
}

/* A few digits, but no power of ten where whole numbers read better. */
static const char *readable(double v, const char *fmt) {
    return fabs(v) >= 100 && fabs(v) < 1e6 && strchr(fmt, 'g') ? "%.0f" : fmt;
}

void lab_print_spread(FILE *out, double v, double error, const char *fmt) {
    char text[40] = "-";
    if (isfinite(v))
        noc_snprintf(text, sizeof(text), readable(v, fmt), v);
    fputs(text, out);
    if (isfinite(v) && isfinite(error)) {
        noc_snprintf(text, sizeof(text), readable(error, "%.2g"), error);
        noc_fprintf(out, " \302\261 %s", text);
    }
}

void lab_spread(FILE *out, double v, double error, const char *fmt, const char *after) {
    fputc(' ', out);
    lab_print_spread(out, v, error, fmt);
    noc_fprintf(out, "%s |", after);
}

void lab_table_rule(FILE *out, size_t columns) {
    fputs("\n|---|", out);
    for (size_t i = 0; i < columns; i++)
        fputs("--:|", out);
    fputc('\n', out);
}

void lab_table_head(FILE *out, const char *first, size_t columns) {
    noc_fprintf(out, "\n%s", first);
    lab_table_rule(out, columns);
}
