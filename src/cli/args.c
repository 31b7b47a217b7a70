/* Parsing of a command's arguments by its option tables. */
#include "cli.h"

#include <ctype.h>
#include <locale.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#define ROW(n, f, h)                                                                                                   \
    { n, "General", NOC_OPTION_BOOL, offsetof(cli_args, f), 0, 1, NULL, "", h }
static const noc_option common_options[] = {
    ROW("quiet", quiet, "no summary, progress, notes or warnings: what was asked for, and errors"),
    ROW("verbose", verbose, "say more about what is read and done"),
    ROW("help", help, "this text"),
    { NULL },
};
const noc_option *cli_common_options(void) { return common_options; }

bool cli_is_switch(const noc_option *option) {
    return option->kind == NOC_OPTION_BOOL || option->kind == NOC_OPTION_SWITCH;
}

bool cli_hidden(const cli_set *set, const noc_option *option) {
    for (const char *const *name = set->hidden; name && *name; name++)
        if (!strcmp(*name, option->name))
            return true;
    return false;
}

char cli_short_name(const noc_option *option) {
    static const char *const names[] = { "output", "quiet", "verbose", "help" };
    for (size_t i = 0; i < sizeof(names) / sizeof(*names); i++)
        if (!strcmp(option->name, names[i]))
            return *names[i];
    return 0;
}

bool cli_given(const cli_args *args, const char *name) {
    for (size_t i = 0; i < args->given_count; i++)
        if (!strcmp(args->given[i]->name, name))
            return true;
    return false;
}

/* One option of the command by its long (short_name 0) or short name. */
static const noc_option *find(const cli_command *command, const char *name, size_t length, char short_name,
                              size_t *offset) {
    for (const cli_set *set = command->sets; set->table; set++) {
        for (const noc_option *o = set->table(); o->name; o++) {
            bool match = short_name ? cli_short_name(o) == short_name
                                    : strlen(o->name) == length && !strncmp(o->name, name, length);
            if (match && !cli_hidden(set, o)) {
                *offset = set->offset;
                return o;
            }
        }
    }
    return NULL;
}

static int unknown(const cli_command *command, const char *given) {
    const char *words[2 * CLI_GIVEN];
    char negated[CLI_GIVEN][40], name[64];
    size_t count = 0, negations = 0;
    for (const cli_set *set = command->sets; set->table; set++) {
        for (const noc_option *o = set->table(); o->name && count + 2 < 2 * CLI_GIVEN; o++) {
            if (cli_hidden(set, o))
                continue;
            words[count++] = o->name;
            if (cli_is_switch(o) && negations < CLI_GIVEN) {
                snprintf(negated[negations], sizeof(*negated), "no-%s", o->name);
                words[count++] = negated[negations++];
            }
        }
    }
    snprintf(name, sizeof(name), "%.*s", (int)strcspn(given, "="), given);
    const char *nearest = noc_text_nearest(name + strspn(name, "-"), words, count);
    char shown[80];
    noc_text_clean(shown, sizeof(shown), given);
    return nearest ? cli_usage(command, "no option %s; is it --%s?", shown, nearest)
                   : cli_usage(command, "no option %s", shown);
}

static void keep_message(void *user, noc_log_level level, const char *text) { snprintf(user, 256, "%s", text); }

static int set_option(const cli_command *command, const noc_option *o, void *params, const char *value,
                      cli_args *args) {
    char message[256] = "";
    /* Which of two outputs is meant nobody can know; for the rest the last one wins, as scripts expect. */
    if (!strcmp(o->name, "output") && cli_given(args, "output"))
        return cli_usage(command, "-o is given twice; one picture, one file");
    noc_log *log = noc_log_create(&(noc_log_params){ .message = keep_message, .user = message });
    noc_status status = noc_option_set(o, params, value, log);
    noc_log_destroy(log);
    if (status && cli_is_switch(o))
        return cli_usage(command, "--%s: --%s turns it on, --no-%s off", message, o->name, o->name);
    if (status)
        return cli_usage(command, "--%s", message);
    if (!cli_given(args, o->name) && args->given_count < CLI_GIVEN)
        args->given[args->given_count++] = o;
    return CLI_OK;
}

/* A following word is a value unless it looks like an option; "-3,4,5" is a value. */
static bool is_value(const char *word) {
    return word && !(word[0] == '-' && (word[1] == '-' || isalpha((unsigned char)word[1])));
}

/* One word that begins with a dash; *index moves on when the next word is its value. */
static int parse_option(const cli_command *command, int argc, char **argv, int *index, void *args) {
    const char *word = argv[*index], *value = NULL;
    size_t offset = 0;
    bool is_short = word[1] != '-', off = false;
    const char *name = word + (is_short ? 1 : 2);
    size_t length = strcspn(name, "=");
    const noc_option *o = find(command, name, length, is_short ? *name : 0, &offset);
    size_t ignored;
    if (is_short && o && name[1] && (cli_is_switch(o) || find(command, name, length, 0, &ignored)))
        o = NULL; /* neither -qv nor -output is a thing here */
    if (!o && !is_short && length > 3 && !strncmp(name, "no-", 3)) {
        o = find(command, name + 3, length - 3, 0, &offset);
        off = o && cli_is_switch(o);
        o = off ? o : NULL;
    }
    if (!o)
        return unknown(command, word);
    if (is_short && name[1])
        value = name + 1 + (name[1] == '='); /* -oFILE, -o=FILE */
    else if (!is_short && name[length] == '=')
        value = name + length + 1;
    if (off) {
        if (value)
            return cli_usage(command, "--no-%s takes no value", o->name);
        value = "false";
    }
    if (!cli_is_switch(o) && !value) {
        if (*index + 1 >= argc || !is_value(argv[*index + 1]))
            return cli_usage(command, "%.*s needs a value", 60, word);
        value = argv[++*index];
    }
    return set_option(command, o, (char *)args + offset, value, args);
}

/* Is the word meant as the value of the switch before it? A number, or a word for on and off, that is no file. */
static bool is_meant_for_switch(const char *word) {
    static const char *const words[] = { "true", "false", "on", "off", "yes", "no", "auto" };
    double number;
    bool like = noc_text_numbers(word, ',', 1, &number);
    for (size_t i = 0; i < sizeof(words) / sizeof(*words); i++)
        like = like || !strcasecmp(word, words[i]);
    return like && access(word, F_OK);
}

int cli_parse(const cli_command *command, int argc, char **argv, void *args) {
    cli_args *common = args;
    memcpy(args, command->defaults, command->args_size);
    common->inputs = cli_alloc(sizeof(char *) * (size_t)(argc + 1));
    bool options = true;
    const char *before = NULL; /* the word before, where it is a switch */
    for (int i = 0; i < argc; i++) {
        const char *word = argv[i];
        if (options && !strcmp(word, "--")) {
            options = false;
        } else if (options && word[0] == '-' && word[1]) {
            int at = i, status = parse_option(command, argc, argv, &i, args);
            if (status)
                return status;
            before = i == at && !strchr(word, '=') && (word[1] == '-' || !word[2]) ? word : NULL;
            continue;
        } else if (!*word) {
            return cli_usage(command, "an argument is empty");
        } else if (before && is_meant_for_switch(word)) {
            return cli_usage(command, "%.60s is a switch and takes no value, and no file is called \"%.60s\"", before,
                             word);
        } else {
            common->inputs[common->input_count++] = word;
        }
        before = NULL;
    }
    return CLI_OK;
}
