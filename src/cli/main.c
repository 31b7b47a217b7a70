/* nocturne: pictures and figures of cities at night. */
#include "cli.h"
#include "viewer/viewer.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

const cli_command *const cli_commands[] = { &cli_render,     &cli_view,  &cli_influence, &cli_measure,
                                            &cli_build,      &cli_info,  &cli_init,      &cli_compare,
                                            &cli_experiment, &cli_bench, &cli_devices,   NULL };

const cli_command *cli_find_command(const char *name) {
    for (const cli_command *const *c = cli_commands; *c; c++)
        if (!strcmp((*c)->name, name))
            return *c;
    return NULL;
}

static int unknown_command(const char *name) {
    const char *words[12];
    size_t count = 0;
    for (const cli_command *const *c = cli_commands; *c; c++)
        words[count++] = (*c)->name;
    words[count++] = "help";
    const char *nearest = noc_text_nearest(name, words, count);
    char shown[80];
    noc_text_clean(shown, sizeof(shown), name);
    if (nearest)
        return cli_usage(NULL, "no command \"%s\"; is it %s?", shown, nearest);
    return !access(name, R_OK) || !strncmp(name, "builtin:", 8)
               ? cli_usage(NULL, "\"%s\" is no command; to draw it: %s render %s -o night.png", shown, cli_program(),
                           shown)
               : cli_usage(NULL, "no command \"%s\"", shown);
}

static int help(int argc, char **argv) {
    const cli_command *command = NULL;
    if (argc == 2 && !strcmp(argv[0], "--completion")) {
        if (!cli_completion(stdout, argv[1]))
            return cli_usage(NULL, "completion is there for bash, zsh and fish");
        return cli_flush(stdout) ? CLI_OK : CLI_FAILURE;
    }
    if (argc > 1)
        return cli_usage(NULL, "help takes one command");
    /* how docs/options.md and nocturne.1 are made */
    if (argc && (!strcmp(argv[0], "--markdown") || !strcmp(argv[0], "--man"))) {
        (strcmp(argv[0], "--man") ? cli_help_markdown : cli_man)(stdout);
        return cli_flush(stdout) ? CLI_OK : CLI_FAILURE;
    }
    if (argc && strcmp(argv[0], "help") && !(command = cli_find_command(argv[0])))
        return unknown_command(argv[0]);
    cli_help(command, stdout);
    return cli_flush(stdout) ? CLI_OK : CLI_FAILURE;
}

static int run(const cli_command *command, int argc, char **argv) {
    cli_args *args = cli_alloc(command->args_size);
    int status = cli_parse(command, argc, argv, args);
    if (!status && args->help) {
        cli_help(command, stdout);
        status = cli_flush(stdout) ? CLI_OK : CLI_FAILURE;
    } else if (!status) {
        status = cli_use_recipe(command, args);
        status = status ? status : command->run(args);
    }
    noc_recipe_destroy(args->recipe);
    free(args->opened);
    free(args->inputs);
    free(args->said);
    free(args);
    return status;
}

/* A stack that is too small would end the program without a word. It grows to the limit that there is by then, so this
 * may be raised. */
static bool enough_stack(void) {
    enum { NEEDED = 1 << 20, USUAL = 8 << 20 };
    struct rlimit stack;
    if (getrlimit(RLIMIT_STACK, &stack) || stack.rlim_cur >= NEEDED)
        return true;
    rlim_t had = stack.rlim_cur;
    stack.rlim_cur = stack.rlim_max < USUAL ? stack.rlim_max : USUAL;
    if (stack.rlim_cur >= NEEDED && !setrlimit(RLIMIT_STACK, &stack))
        return true;
    cli_error("the limit of the stack is %llu kB, and %d kB are needed: ulimit -s %d", (unsigned long long)had / 1024,
              NEEDED / 1024, NEEDED / 1024);
    return false;
}

/* Where the caller has closed a standard descriptor, the next file that is opened would get its number, and what is
 * printed would go into it. It is opened so that to use it fails. */
static void keep_standard_descriptors(void) {
    for (int fd = STDIN_FILENO; fd <= STDERR_FILENO; fd++)
        while (fcntl(fd, F_GETFD) < 0 && errno == EBADF)
            if (open("/dev/null", fd == STDIN_FILENO ? O_WRONLY : O_RDONLY) < 0)
                return;
}

int main(int argc, char **argv) {
    keep_standard_descriptors();
    cli_called(argv[0]);
    if (!enough_stack())
        return CLI_FAILURE;
    signal(SIGXFSZ, SIG_IGN); /* a file over the size limit is a failed write: said, and nothing is left behind */
    if (argc < 2) {
        cli_help(NULL, stderr);
        return CLI_USAGE;
    }
    const char *name = argv[1];
    if (!strcmp(name, "--version")) {
        printf("nocturne %s (%s, %s)\nisolation of foreign readers: %s\n", noc_version(), noc_features(),
               viewer_features(), noc_isolation());
        return cli_flush(stdout) ? CLI_OK : CLI_FAILURE;
    }
    if (!strcmp(name, "help") || !strcmp(name, "--help") || !strcmp(name, "-h"))
        return help(argc - 2, argv + 2);
    const cli_command *command = cli_find_command(name);
    if (command)
        return run(command, argc - 2, argv + 2);
    if (*name == '-')
        return cli_usage(NULL, "the command comes first: nocturne render INPUT... -o night.png");
    return unknown_command(name);
}
