/* Completions for bash, zsh and fish, from the option tables. All three offer the same: commands, options, values of
 * those that have choices, built-in scenes and files, and nothing where a number or another text is asked for. */
#include "cli.h"

#include <string.h>

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

static void builtins(FILE *out, const char *before) {
    const char *const *names = noc_builtin_names();
    for (size_t i = 0; names[i]; i++)
        fprintf(out, "%s%s%s", i ? " " : "", before, names[i]);
}

static bool takes_builtins(const cli_command *command) {
    for (const cli_set *set = command->sets; set->table; set++)
        if (set->table == noc_builtin_options)
            return true;
    return false;
}

static bool takes_files(const noc_option *o) {
    bool text = o->kind == NOC_OPTION_TEXT || o->kind == NOC_OPTION_TEXTS;
    return text && (!strcmp(o->unit, "FILE") || !strcmp(o->unit, "FOLDER"));
}

/* The forms of an option that say something: of a switch that is on, --no-name; of one that is automatic, either. */
typedef struct forms {
    bool name, negated;
} forms;
static forms forms_of(const noc_option *o, const void *defaults) {
    bool on = cli_is_switch(o) && *((const char *)defaults + o->offset);
    return (forms){ !on || o->kind == NOC_OPTION_SWITCH, on };
}

static void bash_word(FILE *out, const noc_option *o, const void *defaults, int columns) {
    forms f = forms_of(o, defaults);
    if (f.negated)
        fprintf(out, " --no-%s", o->name);
    if (f.name)
        fprintf(out, " --%s", o->name);
    if (cli_short_name(o))
        fprintf(out, " -%c", cli_short_name(o));
}

static void bash_value(FILE *out, const noc_option *o, const void *defaults, int columns) {
    if (cli_is_switch(o))
        return;
    fprintf(out, "            --%s", o->name);
    if (cli_short_name(o))
        fprintf(out, "|-%c", cli_short_name(o));
    if (o->kind == NOC_OPTION_CHOICE) {
        fputs(") files= words='", out);
        choices(out, o, ' ');
        fputs("' ;;\n", out);
    } else {
        fprintf(out, ") %s ;;\n", takes_files(o) ? ":" : "files=");
    }
}

static void bash(FILE *out) {
    /* Bash divides words at = and colons. */
    fputs("_nocturne() {\n    local at=$COMP_CWORD files=yes\n"
          "    local word=${COMP_WORDS[at]} before=${COMP_WORDS[at-1]} words=\n"
          "    case $word in =|:) before=$word word= at=$((at + 1)) ;; esac\n"
          "    [ \"$before\" = = ] && before=${COMP_WORDS[at-2]}\n"
          "    if [ \"$before\" = : ] && [ \"${COMP_WORDS[at-2]}\" = builtin ]; then\n        files= words='",
          out);
    builtins(out, "");
    fputs("'\n    elif [ \"$COMP_CWORD\" = 1 ] || [ \"${COMP_WORDS[1]}:$COMP_CWORD\" = help:2 ]; then\n"
          "        files= words='",
          out);
    commands(out);
    fputs("'\n    else\n        case ${COMP_WORDS[1]} in\n", out);
    for (const cli_command *const *c = cli_commands; *c; c++) {
        fprintf(out, "        %s)\n            case $before in\n", (*c)->name);
        cli_each_option(*c, out, NULL, bash_value, 0);
        fputs("            *) case $word in\n", out);
        if (takes_builtins(*c))
            fputs("                b|bu*) [[ builtin: = \"$word\"* ]] && words=builtin: && "
                  "compopt -o nospace 2>/dev/null ;;\n",
                  out);
        fputs("                -*) files= words='", out);
        cli_each_option(*c, out, NULL, bash_word, 0);
        fputs("' ;;\n                esac ;;\n            esac ;;\n", out);
    }
    fputs("        esac\n    fi\n    mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$word\"\n"
          "        [ \"$words\" = builtin: ] && compgen -f -- \"$word\")\n"
          "    [ \"$files\" ] || compopt +o default 2>/dev/null\n}\n"
          "complete -o default -F _nocturne nocturne\n",
          out);
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

/* after: "=" behind a long name and "+" behind a letter say that a value may follow in the same word or in the next. */
static void zsh_form(FILE *out, const noc_option *o, const char *dashes, const char *name, const char *after) {
    const char *often = o->kind == NOC_OPTION_TEXTS ? "*" : ""; /* may be given several times */
    fprintf(out, "            '%s%s%s%s[", often, dashes, name, cli_is_switch(o) ? "" : after);
    quoted(out, o->help, "[]\\:");
    fputc(']', out);
    if (o->kind == NOC_OPTION_CHOICE) {
        fputs(":name:(", out);
        choices(out, o, ' ');
        fputc(')', out);
    } else if (!cli_is_switch(o)) {
        fprintf(out, ":value:%s", takes_files(o) ? "_files" : "");
    }
    fputs("' \\\n", out);
}

static void zsh_option(FILE *out, const noc_option *o, const void *defaults, int columns) {
    forms f = forms_of(o, defaults);
    char letter[2] = { cli_short_name(o), 0 };
    if (f.negated)
        zsh_form(out, o, "--no-", o->name, "=");
    if (f.name)
        zsh_form(out, o, "--", o->name, "=");
    if (*letter)
        zsh_form(out, o, "-", letter, "+");
}

static void zsh(FILE *out) {
    fputs("#compdef nocturne\n_nocturne() {\n    if (( CURRENT == 2 )) || [[ $words[2]:$CURRENT == help:3 ]]; then\n"
          "        compadd ",
          out);
    commands(out);
    fputs("\n        return\n    fi\n    local command=$words[2] inputs=_files\n"
          "    [[ $PREFIX == b* ]] && inputs='_alternative \"scene:scene:(",
          out);
    builtins(out, "builtin\\:");
    fputs(")\" \"file:file:_files\"'\n    shift words\n    (( CURRENT-- ))\n    case $command in\n", out);
    for (const cli_command *const *c = cli_commands; *c; c++) {
        fprintf(out, "    %s)\n        _arguments \\\n", (*c)->name);
        cli_each_option(*c, out, NULL, zsh_option, 0);
        fprintf(out, "            \"*:input:%s\" ;;\n", takes_builtins(*c) ? "{$inputs}" : "_files");
    }
    fputs("    esac\n}\n_nocturne \"$@\"\n", out);
}

static const char *fish_command; /* whose options are written */

static void fish_form(FILE *out, const noc_option *o, const char *before, const char *after) {
    fprintf(out, "complete -c nocturne -n '__nocturne_at %s' %s%s%s", fish_command, before, o->name, after);
    if (o->kind == NOC_OPTION_CHOICE) {
        fputs(" -x -a '", out);
        choices(out, o, ' ');
        fputc('\'', out);
    } else if (!cli_is_switch(o)) {
        fputs(takes_files(o) ? " -r" : " -x", out);
    }
    fputs(" -d '", out);
    for (const char *c = o->help; *c; c++) {
        if (*c == '\'' || *c == '\\')
            fputc('\\', out);
        fputc(*c, out);
    }
    fputs("'\n", out);
}

static void fish_option(FILE *out, const noc_option *o, const void *defaults, int columns) {
    forms f = forms_of(o, defaults);
    if (f.negated)
        fish_form(out, o, "-l no-", "");
    char letter[8] = "";
    if (cli_short_name(o))
        snprintf(letter, sizeof(letter), " -s %c", cli_short_name(o));
    if (f.name)
        fish_form(out, o, "-l ", letter);
}

static void fish(FILE *out) {
    fputs("function __nocturne_at\n    set -l words (commandline -opc)\n    test \"$words[2]\" = $argv[1]\nend\n"
          "function __nocturne_command\n    set -l words (commandline -opc)\n"
          "    test (count $words) = 1; or test \"$words[2]\" = help -a (count $words) = 2\nend\n"
          "complete -c nocturne -n __nocturne_command -f -a '",
          out);
    commands(out);
    fputs("'\n", out);
    for (const cli_command *const *c = cli_commands; *c; c++) {
        fish_command = (*c)->name;
        cli_each_option(*c, out, NULL, fish_option, 0);
        if (!takes_builtins(*c))
            continue;
        static const char where[] = "complete -c nocturne -n '__nocturne_at %s; and "
                                    "string match -q \"%s*\" -- (commandline -ct)'";
        fprintf(out, where, (*c)->name, "b");
        fputs(" -a '", out);
        builtins(out, "builtin:");
        fputs("'\n", out);
        fprintf(out, where, (*c)->name, "builtin:"); /* no files after the colon */
        fputs(" -f\n", out);
    }
}

bool cli_completion(FILE *out, const char *shell) {
    static const struct {
        const char *name;
        void (*write)(FILE *out);
    } shells[] = { { "bash", bash }, { "zsh", zsh }, { "fish", fish } };
    for (size_t i = 0; i < sizeof(shells) / sizeof(*shells); i++)
        if (!strcmp(shells[i].name, shell)) {
            shells[i].write(out);
            return true;
        }
    return false;
}
