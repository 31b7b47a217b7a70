/* The manual page and the shells' completions, from the option tables. */
#include "cli.h"

#include <string.h>

/* Manual page */

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
    char left[64], value[80];
    cli_spell(left, sizeof(left), o, defaults);
    cli_spell_default(value, sizeof(value), o, defaults);
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
}

void cli_man(FILE *out) {
    fprintf(out, ".TH NOCTURNE 1 \"\" \"Nocturne %s\" \"User Commands\"\n.SH NAME\nnocturne \\- pictures and figures of cities at night\n"
                 ".SH SYNOPSIS\n", noc_version());
    for (const cli_command *const *c = cli_commands; *c; c++) {
        fprintf(out, "%s.B nocturne %s\n[\\fIOPTION\\fR]...\n.I ", c == cli_commands ? "" : ".br\n", (*c)->name);
        roff(out, (*c)->arguments);
        fputc('\n', out);
    }
    fputs(".br\n.B nocturne help\n.RI [ COMMAND ]\n.SH DESCRIPTION\n"
          "City models and the street lamps of a map go in. Pictures with true light come out, and figures in cd/m2.\n"
          "An option is written as \\fB\\-\\-option\\fR \\fIvalue\\fR or \\fB\\-\\-option=\\fR\\fIvalue\\fR; its default stands in brackets.\n", out);
    for (const cli_command *const *c = cli_commands; *c; c++) {
        fprintf(out, ".SH NOCTURNE %s\n", (*c)->name);
        roff(out, (*c)->summary);
        cli_each_option(*c, out, "\n.SS %s\n", man_option, 0);
        fputs(".PP\n.nf\n", out);
        roff(out, (*c)->notes);
        fputs(".fi\n", out);
    }
    fprintf(out, ".SH EXIT STATUS\n0 after success, %d after a failure that was reported, %d for wrong arguments, %d plus the signal's number after\n"
                 "an interruption (130 after Ctrl\\-C).\n", CLI_FAILURE, CLI_USAGE, CLI_INTERRUPTED);
}

/* Completions. Files are offered wherever nothing better is known. */

/* "a|b|c" with other separators. */
static void choices(FILE *out, const noc_option *o, char separator) {
    for (const char *c = o->choices; *c; c++)
        fputc(*c == '|' ? separator : *c, out);
}

static void commands(FILE *out) {
    for (const cli_command *const *c = cli_commands; *c; c++)
        fprintf(out, "%s ", (*c)->name);
    fputs("help", out);
}

static bool negatable(const noc_option *o, const void *defaults) {
    return cli_is_switch(o) && *((const char *)defaults + o->offset);
}

static void bash_word(FILE *out, const noc_option *o, const void *defaults, int columns) {
    if (negatable(o, defaults))
        fprintf(out, " --no-%s", o->name);
    if (!negatable(o, defaults) || o->kind == NOC_OPTION_SWITCH) /* of a switch that is automatic, either says something */
        fprintf(out, " --%s", o->name);
}

static void bash_choices(FILE *out, const noc_option *o, const void *defaults, int columns) {
    if (o->kind != NOC_OPTION_CHOICE)
        return;
    fprintf(out, "            --%s) words='", o->name);
    choices(out, o, ' ');
    fputs("' ;;\n", out);
}

static void bash(FILE *out) {
    /* Bash divides words at = and colons. */
    fputs("_nocturne() {\n    local at=$COMP_CWORD\n    local word=${COMP_WORDS[at]} before=${COMP_WORDS[at-1]} words=\n"
          "    case $word in =|:) before=$word word= at=$((at + 1)) ;; esac\n"
          "    [ \"$before\" = = ] && before=${COMP_WORDS[at-2]}\n"
          "    if [ \"$before\" = : ] && [ \"${COMP_WORDS[at-2]}\" = builtin ]; then\n        words='", out);
    const char *const *names = noc_builtin_names();
    for (size_t i = 0; names[i]; i++)
        fprintf(out, "%s%s", i ? " " : "", names[i]);
    fputs("'\n    elif [ \"$COMP_CWORD\" = 1 ] || [ \"${COMP_WORDS[1]}:$COMP_CWORD\" = help:2 ]; then\n        words='", out);
    commands(out);
    fputs("'\n    else\n        case ${COMP_WORDS[1]} in\n", out);
    for (const cli_command *const *c = cli_commands; *c; c++) {
        fprintf(out, "        %s)\n            case $before in\n", (*c)->name);
        cli_each_option(*c, out, NULL, bash_choices, 0);
        fputs("            *) case $word in builtin*) words=builtin:; compopt -o nospace 2>/dev/null ;; -*) words='", out);
        cli_each_option(*c, out, NULL, bash_word, 0);
        fputs("' ;; esac ;;\n            esac ;;\n", out);
    }
    fputs("        esac\n    fi\n    mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$word\")\n}\n"
          "complete -o default -F _nocturne nocturne\n", out);
}

/* Help text within single quotes and, for zsh, within brackets. */
static void quoted(FILE *out, const char *text, const char *escape) {
    for (const char *c = text; *c; c++) {
        if (*c == '\'')
            fputs("'\\'", out);
        else if (strchr(escape, *c))
            fputc('\\', out);
        fputc(*c, out);
    }
}

static void zsh_option(FILE *out, const noc_option *o, const void *defaults, int columns) {
    fprintf(out, "            '--%s%s[", negatable(o, defaults) ? "no-" : "", o->name);
    quoted(out, o->help, "[]\\:");
    fputc(']', out);
    if (o->kind == NOC_OPTION_CHOICE) {
        fputs(":name:(", out);
        choices(out, o, ' ');
        fputc(')', out);
    } else if (!cli_is_switch(o)) {
        fprintf(out, ":value:%s", o->kind == NOC_OPTION_TEXT || o->kind == NOC_OPTION_TEXTS ? "_files" : "");
    }
    fputs("' \\\n", out);
}

static void zsh(FILE *out) {
    fputs("#compdef nocturne\n_nocturne() {\n    if (( CURRENT == 2 )) || [[ $words[2]:$CURRENT == help:3 ]]; then\n        compadd ", out);
    commands(out);
    fputs("\n        return\n    fi\n    case $words[2] in\n", out);
    for (const cli_command *const *c = cli_commands; *c; c++) {
        fprintf(out, "    %s)\n        shift words\n        (( CURRENT-- ))\n        _arguments \\\n", (*c)->name);
        cli_each_option(*c, out, NULL, zsh_option, 0);
        fputs("            '*:input:_files' ;;\n", out);
    }
    fputs("    esac\n}\n_nocturne \"$@\"\n", out);
}

static const char *fish_command; /* whose options are written */

static void fish_option(FILE *out, const noc_option *o, const void *defaults, int columns) {
    fprintf(out, "complete -c nocturne -n '__fish_seen_subcommand_from %s' -l %s%s", fish_command, negatable(o, defaults) ? "no-" : "",
            o->name);
    if (cli_short_name(o))
        fprintf(out, " -s %c", cli_short_name(o));
    if (o->kind == NOC_OPTION_CHOICE) {
        fputs(" -x -a '", out);
        choices(out, o, ' ');
        fputc('\'', out);
    } else if (!cli_is_switch(o)) {
        fputs(o->kind == NOC_OPTION_TEXT || o->kind == NOC_OPTION_TEXTS ? " -r" : " -x", out);
    }
    fputs(" -d '", out);
    for (const char *c = o->help; *c; c++) {
        if (*c == '\'' || *c == '\\')
            fputc('\\', out);
        fputc(*c, out);
    }
    fputs("'\n", out);
}

static void fish(FILE *out) {
    fputs("complete -c nocturne -n __fish_use_subcommand -f -a '", out);
    commands(out);
    fputs("'\n", out);
    for (const cli_command *const *c = cli_commands; *c; c++) {
        fish_command = (*c)->name;
        cli_each_option(*c, out, NULL, fish_option, 0);
    }
}

bool cli_completion(FILE *out, const char *shell) {
    static const struct { const char *name; void (*write)(FILE *out); } shells[] = { { "bash", bash }, { "zsh", zsh }, { "fish", fish } };
    for (size_t i = 0; i < sizeof(shells) / sizeof(*shells); i++)
        if (!strcmp(shells[i].name, shell)) {
            shells[i].write(out);
            return true;
        }
    return false;
}
