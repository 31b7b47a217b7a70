#include "cli.h"

#include <errno.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>
#include <stdlib.h>

static bool has_ending(const char *path, const char *ending) {
    size_t n = strlen(path), m = strlen(ending);
    return n > m && path[n - m - 1] != '/' && !strcasecmp(path + n - m, ending);
}

/* The writer makes a new file beside the target and renames it: what counts is the folder, not the file. */
static int check_folder(const char *path, const char *shown) {
    const char *slash = strrchr(path, '/');
    char *folder = slash ? cli_format("%.*s", slash == path ? 1 : (int)(slash - path), path) : cli_format(".");
    struct stat st;
    int status = CLI_FAILURE;
    char named[120];
    noc_text_clean(named, sizeof(named), folder);
    if (stat(folder, &st) && errno == ENOENT)
        cli_error("%s: its folder %s is not there: make it first", shown, named);
    else if (stat(folder, &st))
        cli_error("%s: its folder %s cannot be used: %s", shown, named, strerror(errno));
    else if (!S_ISDIR(st.st_mode))
        cli_error("%s: what should be its folder is a file", shown);
    else if (access(folder, W_OK | X_OK))
        cli_error("%s: its folder cannot be written: %s", shown, strerror(errno));
    else
        status = CLI_OK;
    free(folder);
    return status;
}

bool cli_same_file(const char *a, const char *b) {
    struct stat x, y;
    return !stat(a, &x) && !stat(b, &y) && x.st_dev == y.st_dev && x.st_ino == y.st_ino;
}

int cli_check_output(const cli_command *command, const char *path, int endings, const cli_args *args) {
    char shown[120];
    noc_text_clean(shown, sizeof(shown), path);
    struct stat st;
    bool exists = !stat(path, &st), too_long = !exists && errno == ENAMETOOLONG;
    if (exists && S_ISDIR(st.st_mode)) {
        cli_error("%s is a folder; name a file in it", shown);
        return CLI_FAILURE;
    }
    bool png = has_ending(path, ".png"), exr = has_ending(path, ".exr");
    if ((endings & CLI_OBJ) && !has_ending(path, ".obj"))
        return cli_usage(command, "%s must end in .obj", shown);
    if ((endings & CLI_NOCT) && !has_ending(path, ".noct"))
        return cli_usage(command, "%s must end in .noct", shown);
    if (!((endings & CLI_PNG) && png) && !((endings & CLI_EXR) && exr) &&
        !(endings & (CLI_OBJ | CLI_NOCT | CLI_MP4 | CLI_ANY)))
        return cli_usage(command, "%s must end in .png%s: the ending decides the format", shown,
                         endings & CLI_EXR ? " or .exr" : "");
    if (exists && !S_ISREG(st.st_mode)) {
        cli_error("%s is no ordinary file and is left alone", shown);
        return CLI_FAILURE;
    }
    for (size_t i = 0; exists && i < args->input_count; i++) {
        if (cli_same_file(args->inputs[i], path)) {
            cli_error("%s is an input too; it would be overwritten", shown);
            return CLI_FAILURE;
        }
    }
    if (too_long) {
        cli_error("%s: cannot be written: %s", shown, strerror(ENAMETOOLONG));
        return CLI_FAILURE;
    }
    int status = check_folder(path, shown);
    if (status)
        return status;
    noc_log *log = cli_log_create(args);
    status = noc_image_check_path(path, log) ? CLI_FAILURE : CLI_OK;
    noc_log_destroy(log);
    return status;
}
