/* The manual page, from the option tables. */
#include "cli.h"

#include <stdlib.h>
#include <string.h>

/* Text of a manual page: a backslash and a dash are written, a dot or a quote at the start of a line is no request. */
static void roff(FILE *out, const char *text) {
    bool start = true;
    for (const char *c = text; *c; c++) {
        if (start && (*c == '.' || *c == '\''))
            fputs("\\&", out);
        if (*c == '\\')
            fputs("\\e", out);
        else if (*c == '-')
            fputs("\\-", out);
        else
            fputc(*c, out);
        start = *c == '\n';
    }
}

static void man_option(FILE *out, const noc_option *o, const void *defaults, int columns) {
    char *left = cli_spell(o, defaults), *value = cli_spell_default(o, defaults);
    fputs(".TP\n.B ", out);
    roff(out, left);
    fputc('\n', out);
    roff(out, o->help);
    if (o->kind == NOC_OPTION_CHOICE) {
        fputs(": ", out);
        for (const char *c = o->choices; *c; c++)
            *c == '|' ? fputs(", ", out) : fputc(*c, out);
    }
    if (*value) {
        fputc(' ', out);
        roff(out, value);
    }
    fputc('\n', out);
    free(left);
    free(value);
}

void cli_man(FILE *out) {
    fprintf(out,
            ".TH NOCTURNE 1 \"\" \"Nocturne %s\" \"User Commands\"\n.SH NAME\n"
            "nocturne \\- pictures and figures of cities at night\n"
            ".SH SYNOPSIS\n",
            noc_version());
    for (const cli_command *const *c = cli_commands; *c; c++) {
        fprintf(out, "%s.B nocturne %s\n[\\fIOPTION\\fR]...\n.I ", c == cli_commands ? "" : ".br\n", (*c)->name);
        roff(out, (*c)->arguments);
        fputc('\n', out);
    }
    fputs(".br\n.B nocturne help\n.RI [ COMMAND ]\n.SH DESCRIPTION\n"
          "City models and the street lamps of a map go in. Pictures with true light come out, and figures in cd/m2.\n"
          "An option is written as \\fB\\-\\-option\\fR \\fIvalue\\fR or \\fB\\-\\-option=\\fR\\fIvalue\\fR; "
          "its default stands in brackets.\n",
          out);
    for (const cli_command *const *c = cli_commands; *c; c++) {
        fprintf(out, ".SH NOCTURNE %s\n", (*c)->name);
        roff(out, (*c)->summary);
        cli_each_option(*c, out, "\n.SS %s\n", man_option, 0);
        fputs(".PP\n.nf\n", out);
        roff(out, (*c)->notes);
        fputs(".fi\n", out);
    }
    fprintf(out,
            ".SH EXIT STATUS\n0 after success, %d after a failure that was reported, %d for wrong arguments, "
            "%d plus the signal's number after\n"
            "an interruption (130 after Ctrl\\-C).\n",
            CLI_FAILURE, CLI_USAGE, CLI_INTERRUPTED);
}
