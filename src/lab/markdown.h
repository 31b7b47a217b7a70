/* lab: what reports are written with. */
#ifndef NOC_LAB_MARKDOWN_H
#define NOC_LAB_MARKDOWN_H

#include "lab/spec.h"

/* as it reads: what would be markup of Markdown or of HTML is escaped */
void lab_text(FILE *out, const char *text);
void lab_cell(FILE *out, const char *text); /* text, and a number, in a cell of a table */
void lab_number(FILE *out, double v, const char *fmt);
/* With its standard error behind it, "1.23 \302\261 0.04": two digits of it, and none where there is none. */
void lab_print_spread(FILE *out, double v, double error, const char *fmt);
void lab_spread(FILE *out, double v, double error, const char *fmt, const char *after); /* in a cell; after may be "" */
/* ends the line of the head: one column to the left, others to the right */
void lab_table_rule(FILE *out, size_t columns);
void lab_table_head(FILE *out, const char *first, size_t columns); /* a table begins */

#endif
