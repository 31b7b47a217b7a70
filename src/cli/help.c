/* Help for people and docs/options.md, both from the option tables. */
#include "cli.h"

#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

static const char *placeholder(const noc_option *o) {
    switch (o->kind) {
    case NOC_OPTION_BOOL:
    case NOC_OPTION_SWITCH: return "";
    case NOC_OPTION_TEXT:
    case NOC_OPTION_TEXTS: return o->unit;
    case NOC_OPTION_CHOICE: return "NAME";
    case NOC_OPTION_REAL: return "X";
    default: return "N";
    }
}

char *cli_spell(const noc_option *o, const void *defaults) {
    char dash[8] = "";
    if (cli_short_name(o))
        snprintf(dash, sizeof(dash), "-%c, ", cli_short_name(o));
    bool on = cli_is_switch(o) && *((const char *)defaults + o->offset); /* or automatic */
    return cli_format("%s--%s%s%s%s", dash, on ? "[no-]" : "", o->name, *placeholder(o) ? " " : "", placeholder(o));
}

char *cli_option_value(const noc_option *o, const void *params) {
    size_t size = (size_t)noc_option_get(o, params, NULL, 0) + 1;
    char *value = cli_alloc(size);
    noc_option_get(o, params, value, size);
    return value;
}

/* A default out of the option's range stands for its absence. */
static bool is_absent(const noc_option *o, const void *defaults) {
    double value;
    if (o->kind != NOC_OPTION_REAL)
        return false;
    memcpy(&value, (const char *)defaults + o->offset, sizeof(value));
    return !(value >= o->min && value <= o->max);
}

char *cli_spell_default(const noc_option *o, const void *defaults) {
    bool text = o->kind == NOC_OPTION_TEXT;
    char *value = cli_option_value(o, defaults), *spelled;
    if (o->kind == NOC_OPTION_BOOL)
        spelled = cli_format("%s", *((const char *)defaults + o->offset) ? "[on]" : "");
    else if (!*value || is_absent(o, defaults))
        spelled = cli_format("%s", "");
    else
        spelled = cli_format("[%s%s%s]", value, !text && *o->unit ? " " : "", text ? "" : o->unit);
    free(value);
    return spelled;
}

static int width(FILE *out) {
    struct winsize size;
    if (!isatty(fileno(out)) || ioctl(fileno(out), TIOCGWINSZ, &size) || size.ws_col < 60)
        return 80;
    return size.ws_col < 120 ? size.ws_col : 120;
}

/* Length of what must stay on one line: a word, or one of the choices "a|b|c" with the bar behind it. */
static int unbroken(const char *text) {
    int n = (int)strcspn(text, " |");
    return n + (text[n] == '|');
}

/* Words of text, wrapped, the first line at the present column. */
static void wrap(FILE *out, const char *text, int column, int columns) {
    int at = column;
    while (*text) {
        int n = unbroken(text);
        if (at + n > columns && at > column) {
            fprintf(out, "\n%*s", column, "");
            at = column;
        }
        fprintf(out, "%.*s", n, text);
        at += n;
        text += n;
        if (*text == ' ') {
            text++;
            if (at + 1 + unbroken(text) <= columns) {
                fputc(' ', out);
                at++;
            } else {
                fprintf(out, "\n%*s", column, "");
                at = column;
            }
        }
    }
    fputc('\n', out);
}

static void print_option(FILE *out, const noc_option *o, const void *defaults, int columns) {
    enum { COLUMN = 28 };
    char *left = cli_spell(o, defaults), *value = cli_spell_default(o, defaults);
    char *right = cli_format("%s%s%s%s%s", o->help, o->kind == NOC_OPTION_CHOICE ? ": " : "",
                             o->kind == NOC_OPTION_CHOICE ? o->choices : "", *value ? " " : "", value);
    fprintf(out, "  %-*s", COLUMN - 2, left);
    if (strlen(left) > COLUMN - 4)
        fprintf(out, "\n%*s", COLUMN, "");
    wrap(out, right, COLUMN, columns);
    free(left);
    free(value);
    free(right);
}

/* The arguments that the command begins with when nothing is said: its preset sets some of them. free() it. */
static void *make_defaults(const cli_command *command) {
    char *all = cli_alloc(command->args_size);
    int preset = -1;
    memcpy(all, command->defaults, command->args_size);
    for (const cli_set *set = command->sets; set->table; set++)
        for (const noc_option *o = set->table(); o->name; o++)
            if (!strcmp(o->name, "preset"))
                memcpy(&preset, all + set->offset + o->offset, sizeof(preset));
    for (const cli_set *set = command->sets; set->table && preset >= 0; set++)
        if (set->table == noc_render_options)
            noc_render_use_preset((noc_render_params *)(void *)(all + set->offset), (noc_preset)preset);
    return all;
}

void cli_each_option(const cli_command *command, FILE *out, const char *heading, cli_visit *visit, int columns) {
    char *defaults = make_defaults(command);
    const char *done[32];
    size_t done_count = 0;
    for (const cli_set *first = command->sets; first->table; first++) {
        for (const noc_option *f = first->table(); f->name; f++) {
            bool seen = cli_hidden(first, f) || done_count == 32;
            for (size_t i = 0; i < done_count; i++)
                seen |= !strcmp(done[i], f->group);
            if (seen)
                continue;
            done[done_count++] = f->group;
            if (heading)
                fprintf(out, heading, f->group);
            for (const cli_set *set = command->sets; set->table; set++)
                for (const noc_option *o = set->table(); o->name; o++)
                    if (!strcmp(o->group, f->group) && !cli_hidden(set, o))
                        visit(out, o, defaults + set->offset, columns);
        }
    }
    free(defaults);
}

void cli_help(const cli_command *command, FILE *out) {
    if (command) {
        fprintf(out, "nocturne %s %s\n\n", command->name, command->arguments);
        wrap(out, command->summary, 0, width(out));
        cli_each_option(command, out, "\n%s\n", print_option, width(out));
        fprintf(out, "\n%s", command->notes);
        return;
    }
    fprintf(out, "nocturne %s: pictures and figures of cities at night\n\n", noc_version());
    for (const cli_command *const *c = cli_commands; *c; c++) {
        fprintf(out, "  nocturne %-10s %s\n%22s", (*c)->name, (*c)->arguments, "");
        wrap(out, (*c)->summary, 22, width(out));
    }
    fprintf(out, "  nocturne help [COMMAND]\n  nocturne --version\n\n"
                 "Try: nocturne render builtin:city -o night.png\n");
}

static void markdown_row(FILE *out, const noc_option *o, const void *defaults, int columns) {
    bool on = o->kind == NOC_OPTION_BOOL && *((const char *)defaults + o->offset);
    char *left = cli_spell(o, defaults), *value = cli_option_value(o, defaults);
    fprintf(out, "| `%s` | %s | %s | ", left, o->help,
            o->kind == NOC_OPTION_BOOL ? on ? "on" : "off"
            : is_absent(o, defaults)   ? ""
                                       : value);
    if (o->kind == NOC_OPTION_INT || o->kind == NOC_OPTION_UINT || o->kind == NOC_OPTION_REAL)
        fprintf(out, "%.10g to %.10g%s%s", o->min, o->max, *o->unit ? " " : "", o->unit);
    for (const char *c = o->kind == NOC_OPTION_CHOICE ? o->choices : ""; *c; c++)
        fprintf(out, *c == '|' ? ", " : "%c", *c);
    fputs(" |\n", out);
    free(left);
    free(value);
}

void cli_help_markdown(FILE *out) {
    fprintf(out,
            "# Options\n\nMade by `tools/update-docs.sh` from the option tables (`src/render/options.c`, `src/cli/`); "
            "a test holds the\n"
            "two equal. Write `--option value` or `--option=value`.\n");
    for (const cli_command *const *c = cli_commands; *c; c++) {
        fprintf(out, "\n## nocturne %s %s\n\n%s\n", (*c)->name, (*c)->arguments, (*c)->summary);
        cli_each_option(*c, out, "\n### %s\n\n| Option | What it does | Default | Values |\n|---|---|---|---|\n",
                        markdown_row, 0);
        fprintf(out, "\n```\n%s```\n", (*c)->notes);
    }
}
