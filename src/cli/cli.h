/* cli: the program on top of the library. Public headers only. One file a subcommand; what they share is here. */
#ifndef NOC_CLI_H
#define NOC_CLI_H

#include <nocturne/nocturne.h>
#include <stdio.h>

/* Exit statuses. An interruption by signal n ends with 128 + n, as shells do: 130 after Ctrl-C. */
enum { CLI_OK = 0, CLI_FAILURE = 1, CLI_USAGE = 2, CLI_INTERRUPTED = 128 };

#define CLI_SETS 15
#define CLI_GIVEN 256

/* What every command's arguments begin with. */
typedef struct cli_args {
    const char **inputs; /* those that are no options; point into argv */
    size_t input_count;
    const char **said; /* the same as they were said, before a recipe stood for its inputs; said_count of them */
    size_t said_count;
    bool help, quiet, verbose;
    const noc_option *given[CLI_GIVEN]; /* options that were set, in order: by the words, then by the recipe */
    size_t given_count, given_by_words; /* those of the words are the first ones */
    size_t said_anew;   /* so many of the first are said beside a built city, whose own recipe says the others */
    char **opened;      /* files of an index among the inputs, which they point into */
    noc_recipe *recipe; /* among the inputs; NULL: none */
} cli_args;

/* Of commands that render; the library's default is embree. */
#define CLI_DEVICE                                                                                                     \
    { .backend = NOC_BACKEND_AUTO }

/* An option table and where its params struct lies in the command's arguments. */
typedef struct cli_set {
    const noc_option *(*table)(void);
    size_t offset;
    const char *const *hidden; /* names of rows that this command does not offer, NULL-ended; may be NULL */
} cli_set;

typedef struct cli_command {
    const char *name, *arguments, *summary; /* "render", "INPUT... -o FILE", "..." */
    const char *notes;                      /* end of the help: examples */
    cli_set sets[CLI_SETS];                 /* ended by a NULL table */
    size_t args_size;
    const void *defaults;   /* args_size bytes; the first member is a cli_args */
    int (*run)(void *args); /* returns the exit status */
} cli_command;

extern const cli_command cli_render, cli_view, cli_influence, cli_measure, cli_build, cli_info, cli_init, cli_compare,
    cli_experiment, cli_bench, cli_devices;
extern const cli_command *const cli_commands[]; /* NULL-ended */
const cli_command *cli_find_command(const char *name);

/* args.c */
const noc_option *cli_common_options(void);   /* quiet, verbose, help: fields of cli_args */
bool cli_is_switch(const noc_option *option); /* --name and --no-name, without a value */
bool cli_hidden(const cli_set *set, const noc_option *option);
int cli_parse(const cli_command *command, int argc, char **argv, void *args); /* CLI_OK or CLI_USAGE, reported */
bool cli_given(const cli_args *args, const char *name);
char cli_short_name(const noc_option *option); /* 'o' of output, 0 if none */

/* help.c */
void cli_help(const cli_command *command, FILE *out); /* NULL: of the program */
void cli_help_markdown(FILE *out);                    /* docs/options.md */
/* Texts for people; free() them. */
char *cli_spell(const noc_option *o, const void *defaults); /* "--width N", "--[no-]jitter", "-o, --output FILE" */
char *cli_spell_default(const noc_option *o, const void *defaults); /* "[10 px]", "[on]", "": absent by default */
char *cli_option_value(const noc_option *o, const void *params);    /* as noc_option_get tells it */
typedef void cli_visit(FILE *out, const noc_option *o, const void *defaults, int columns);
/* Options of all the command's tables by group, groups in the order in which they first appear. heading is a format for
 * the group's name; NULL: no heading. */
void cli_each_option(const cli_command *command, FILE *out, const char *heading, cli_visit *visit, int columns);

/* pages.c and completion.c: made from the option tables too */
void cli_man(FILE *out);                           /* nocturne.1 */
bool cli_completion(FILE *out, const char *shell); /* for bash, zsh or fish; false: for none of them */

/* text.c: messages and numbers for people and for machines. */
void cli_error(const char *fmt, ...) NOC_PRINTF(1, 2); /* one line on stderr, after "nocturne: " */
/* the same, and where to read on; CLI_USAGE */
int cli_usage(const cli_command *command, const char *fmt, ...) NOC_PRINTF(2, 3);
int cli_read_on(const cli_command *command); /* where to read on alone, after an error that the library told */
noc_log *cli_log_create(const cli_args *args);
noc_log_level cli_log_level(const cli_args *args);
void cli_log_message(void *user, noc_log_level level, const char *text); /* a line on stderr; user is not looked at */
/* The program as it was called, for commands that are shown to be typed: a path where it is not on PATH. */
void cli_called(const char *name);
const char *cli_program(void);
_Noreturn void cli_no_memory(void); /* says so, and ends the program */
/* noc_image_auto_ev100; ends the program when memory is gone */
double cli_auto_ev100(const noc_image *image);
void *cli_alloc(size_t size);                    /* zeroed; ends the program when memory is gone */
const char *cli_number(char text[32], double v); /* "0.35", "16,990": four digits, or all that are whole */
char *cli_format(const char *fmt, ...) NOC_PRINTF(1, 2) __attribute__((nonnull(1))); /* free() it */
/* Ids of a report, comma separated, of which only whole ones are shown: the first, and as many more as fit; then how
 * many of the `count` features are left. free() it. */
#define CLI_IDS_WIDTH 72
char *cli_ids(const char *list, size_t count, size_t width);
/* FNV-1a of more bytes; begin with 0. Never 0. */
uint64_t cli_sum(uint64_t sum, const void *data, size_t size);
void cli_json_text(FILE *out, const char *text); /* quoted and escaped; valid UTF-8 whatever came in */
void cli_yaml_text(FILE *out, const char *text); /* in double quotes, as YAML reads it where it is UTF-8 */
const char *cli_not_utf8(const char *text);      /* where it is not UTF-8; NULL where all of it is */
void cli_json_number(FILE *out, double v);       /* null where it is not finite */
/* false after saying that stdout could not be written */
bool cli_flush(FILE *out);

/* progress.c: a bar on stderr where that is a terminal, else a line after ten seconds and then ever more rarely; and
 * the signals that end the work early. */
void cli_progress_start(bool quiet);
/* left: seconds, < 0 unknown */
void cli_progress_show(double done, double left, const char *fmt, ...) NOC_PRINTF(3, 4);
void cli_progress_clear(void);
bool cli_load_progress(void *user, const char *what, double done); /* for noc_progress; cancels when interrupted */
/* Shows nothing; false once a signal has come. A noc_progress.update, as the one above. */
bool cli_goes_on(void *user, const char *what, double done);
void cli_catch_signals(void); /* the first signal is remembered, the second ends the program */
/* While there is nothing, an interruption is not waited on: half a second later the program ends. False when it starts.
 */
void cli_nothing_to_keep(bool nothing);
/* A file, or an empty folder, that such an end removes; NULL: none. The path must last until it is another's turn. */
void cli_leave_nothing_at(const char *path);
int cli_interrupted(void); /* its number, 0 if there was none */
double cli_now(void);      /* wall clock, seconds */

/* devices.c */
/* Refuses a device that is not there or not usable, before the long work: CLI_OK, or an exit status after reporting. */
int cli_check_device(const cli_command *command, const noc_device_params *device);

/* part.c: processes that share a command's items. */
#define CLI_MOST_PARTS 1000000
#define CLI_OPTION_PART(s, g, f)                                                                                       \
    { "part", g, NOC_OPTION_TEXT, offsetof(s, f), 0, 0, NULL, "K/N", "part K of N alone; else as MPI or Slurm say" }
typedef struct cli_part {
    int number, count; /* this process does part `number`, from 1; 1 of 1: all */
    char by[64];       /* what gave them: --part, or names of variables */
} cli_part;
/* Fills *part by --part, whose value is text, or NULL: by the environment. Prints which, unless it is 1 of 1 or args
 * are quiet. CLI_OK, or CLI_USAGE after reporting. */
int cli_choose_part(const cli_command *command, const cli_args *args, const char *text, cli_part *part);

/* recipe.c */
/* Takes the recipe among the inputs of a command that reads cities, if there is one. CLI_OK, or an exit status after
 * reporting. */
int cli_use_recipe(const cli_command *command, void *args);
/* The recipe's camera of that name, with NULL its first one; NULL: there is none. */
const noc_recipe_camera *cli_recipe_camera(const cli_args *args, const char *name);

/* builtin.c */
const char *cli_builtin(const char *input); /* name of the built-in scene that an input is, NULL for a file */
/* Files named with --lamps and --tracks are inputs like the others: appended to those of the command line. */
void cli_add_named(cli_args *args, const noc_import_params *import);
/* Which defaults of lamps the user has said, for --strict. */
void cli_note_chosen(const cli_args *args, noc_import_params *import);
/* "50 windows, 17 lit, 8.4 on 100 m2 of wall, 2.9 lit; walls without: 3 too small"; nothing where there are no walls */
void cli_print_windows(const char *heading, const noc_window_counts *counts);
/* The sky's luminance [cd/m2] at the zenith and its SQM value; "dark" for 0. */
void cli_print_sky(const char *heading, double sky);
/* What lamps do not tell, and what is taken for it: "2 without height: 6 m (--lamp-height), ..."; "" where they tell
 * all. free() it. */
char *cli_assumed(const size_t assumed[NOC_LAMP_DEFAULT_COUNT], const noc_import_params *import);
/* That as a line; nothing where they tell all. */
void cli_print_assumed(const char *heading, const size_t assumed[NOC_LAMP_DEFAULT_COUNT],
                       const noc_import_params *import);

/* report.c */
/* The inputs' and the lamps' troubles, the same reason in several files as one, the gravest first. Texts are the
 * report's; free() the array. */
noc_report_line *cli_issues(const noc_report *report, size_t *count);
/* What of the inputs was left out or guessed at, so that figures may be wrong by it: "left out: 3, guessed at: 2: 2 x
 * REASON (IDS), ..." with the gravest few; "" where nothing was. free() it. */
char *cli_doubts(const noc_report *report);
uint64_t cli_peak_memory(void); /* of this process so far, bytes */

/* built.c: the inputs are built cities (nocturne/built.h). */
bool cli_is_built(const cli_args *args); /* each of them */
/* Is there a map around the city: one that is named, or that of the built city? */
bool cli_has_map(const cli_args *args, const noc_import_params *import);
/* Refuses what its build has decided otherwise, of options and of a recipe around it: CLI_OK or CLI_USAGE. */
int cli_check_built(const cli_command *command, const cli_args *args, const noc_import_params *import);
/* Its windows and cars, as the words say, and what the report tells of them; nothing where they say nothing of them. */
noc_status cli_switch_built(const cli_args *args, noc_scene *scene, const noc_import_params *import,
                            noc_report *report);

/* lights.c */
/* "city.yaml:12 3,963, city.yaml:14 40": how many lamps each rule matched; "none". free() it. */
char *cli_rules(const noc_report *report);
/* "lamps 40 (312 klm), windows 8,000 (out)": groups that have lights; "none". free() it. */
char *cli_groups(const noc_report *report);
void cli_print_lights(const char *rules, const char *groups, const noc_report *report); /* after these headings */

/* render.c */
/* compare takes it too */
int cli_parse_exposure(const cli_command *command, const char *text, noc_display_params *display);

/* output.c */
bool cli_same_file(const char *a, const char *b); /* both are there, and are one file */
typedef enum cli_ending { CLI_PNG = 1, CLI_EXR = 2, CLI_OBJ = 4, CLI_NOCT = 8, CLI_MP4 = 16, CLI_ANY = 32 } cli_ending;
/* Can path be written as one of these formats, and is it none of the files that args name to be read? Called before the
 * long work, with the command's own args. CLI_OK, or an exit status after reporting. */
int cli_check_output(const cli_command *command, const char *path, int endings, const cli_args *args);
/* Refuses to replace a file that the loaded scene is made of: one that an input names. Called when the scene is loaded,
 * before anything is made of it. path may be NULL. CLI_OK, or CLI_FAILURE after reporting. */
int cli_check_sources(const noc_scene *scene, const char *path);

/* Returns the number, or 0 where no digit of it is shown: "%.3f" makes -0.000 of -0.0002. */
static inline double cli_shown(double x, int decimals) {
    double half = .5;
    for (int i = 0; i < decimals; i++)
        half /= 10;
    return x < half && x > -half ? 0 : x;
}

#endif
