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

static const char *find_among(const char *const *files, size_t count, const char *path) {
    for (size_t i = 0; i < count; i++)
        if (cli_same_file(files[i], path))
            return files[i];
    return NULL;
}

/* Options whose file is written. */
static bool is_output(const noc_option *o) {
    return !strcmp(o->name, "output") || !strcmp(o->name, "csv") || !strcmp(o->name, "influence-obj");
}

/* Returns the file that an option names to be read and that path names, too; NULL: it names none. */
static const char *find_in_option(const noc_option *o, const void *value, const char *path) {
    static const char polygon[] = "polygon:"; /* of a region */
    const noc_texts *texts = o->kind == NOC_OPTION_TEXTS ? value : NULL;
    bool file = !strcmp(o->unit, "FILE") && !is_output(o), region = !strcmp(o->unit, "REGION");
    for (size_t i = 0; i < (texts ? texts->count : 1) && (file || region); i++) {
        const char *text = texts ? texts->text[i] : *(const char *const *)value;
        bool prefixed = region && text && !strncmp(text, polygon, strlen(polygon));
        if (text && (file || prefixed) && cli_same_file(text + (prefixed ? strlen(polygon) : 0), path))
            return text;
    }
    return NULL;
}

/* Returns the file that path names among those that are read: inputs, recipes, and files of options; NULL: none. */
static const char *find_read(const cli_command *command, const cli_args *args, const char *path) {
    const char *found = find_among(args->inputs, args->input_count, path);
    found = found ? found : find_among(args->said, args->said_count, path);
    for (const cli_set *set = command->sets; set->table; set++)
        for (const noc_option *o = set->table(); o->name && !found; o++)
            if (o->kind == NOC_OPTION_TEXT || o->kind == NOC_OPTION_TEXTS)
                found = find_in_option(o, (const char *)args + set->offset + o->offset, path);
    return found;
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
    const char *read = exists ? find_read(command, args, path) : NULL;
    if (read) {
        char named[120];
        cli_error("%s is an input too (%s); it would be overwritten", shown,
                  noc_text_clean(named, sizeof(named), read));
        return CLI_FAILURE;
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

int cli_check_sources(const noc_scene *scene, const char *path) {
    char shown[120], named[120], namer[120];
    const char *by, *source = path ? noc_scene_find_source(scene, path, &by) : NULL;
    if (!source)
        return CLI_OK;
    noc_text_clean(shown, sizeof(shown), path);
    noc_text_clean(named, sizeof(named), source);
    if (by)
        cli_error("%s would overwrite %s, which %s names; name another file", shown, named,
                  noc_text_clean(namer, sizeof(namer), by));
    else
        cli_error("%s would overwrite %s, which the city is made of; name another file", shown, named);
    return CLI_FAILURE;
}
