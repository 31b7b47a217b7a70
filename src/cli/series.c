/* Files of an animation: pictures by number, and their film. */
#include "render.h"

#include <ctype.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#define FILM ".mp4"
#define MOST_DIGITS 9

bool cli_is_film(const char *output) {
    size_t n = strlen(output), m = strlen(FILM);
    return n > m && output[n - m - 1] != '/' && !strcasecmp(output + n - m, FILM);
}

/* The number's place in a name: "%d", or "%04d". */
static const char *parse_number(const char *percent, int *digits) {
    const char *p = percent + 1;
    *digits = 1;
    if (*p == '0' && isdigit((unsigned char)p[1])) {
        char *end;
        *digits = (int)strtol(p, &end, 10);
        p = end;
    }
    return *p == 'd' && p - percent <= 4 && *digits >= 1 && *digits <= MOST_DIGITS ? p + 1 : NULL;
}

int cli_series_parse(const char *output, cli_series *series) {
    *series = (cli_series){ NULL, NULL, 6 };
    if (cli_is_film(output)) {
        series->prefix = cli_format("%.*s-frames/", (int)(strlen(output) - strlen(FILM)), output);
        series->suffix = cli_format(".png");
        return CLI_OK;
    }
    const char *slash = strrchr(output, '/'), *percent = strchr(slash ? slash : output, '%');
    if (!strchr(output, '%'))
        return cli_usage(&cli_render,
                         "--animate: \"%.80s\" names one picture; frame-%%04d.png names one for each number", output);
    const char *rest = percent ? parse_number(percent, &series->digits) : NULL;
    if (!rest || strchr(rest, '%'))
        return cli_usage(&cli_render,
                         "--animate: \"%.80s\": the file's name holds one %%d, or %%0Nd for N digits, and no other %%",
                         output);
    series->prefix = cli_format("%.*s", (int)(percent - output), output);
    series->suffix = cli_format("%s", rest);
    return CLI_OK;
}

void cli_series_free(cli_series *series) {
    free(series->prefix);
    free(series->suffix);
    *series = (cli_series){ NULL, NULL, 0 };
}

char *cli_series_file(const cli_series *series, int number) {
    return cli_format("%s%0*d%s", series->prefix, series->digits, number, series->suffix);
}

/* The pictures' name without their number, and without what parts that from it. */
char *cli_series_film(const cli_series *series) {
    const char *slash = strrchr(series->prefix, '/'), *name = slash ? slash + 1 : series->prefix;
    const char *ending = strrchr(series->suffix, '.');
    size_t n = strlen(name);
    while (n && strchr("-_. ", name[n - 1]))
        n--;
    char *stem = cli_format("%.*s%.*s", (int)n, name, (int)(ending ? ending - series->suffix : 0), series->suffix);
    char *film = cli_format("%.*s%s" FILM, (int)(name - series->prefix), series->prefix, *stem ? stem : "animation");
    free(stem);
    return film;
}

int cli_series_check(const cli_series *series, int pictures, const noc_scene *scene) {
    int status = CLI_OK;
    for (int i = 0; i < pictures && !status; i++) {
        char *file = cli_series_file(series, i + 1);
        status = cli_check_sources(scene, file);
        free(file);
    }
    return status;
}

noc_status cli_series_make_folder(const cli_series *series, bool alone, char **folder) {
    char *path = cli_format("%.*s", (int)strlen(series->prefix) - 1, series->prefix);
    bool made = !mkdir(path, 0777);
    noc_status status = !made && errno != EEXIST ? NOC_ERR_IO : NOC_OK;
    if (status)
        cli_error("%s: cannot be made: %s", path, strerror(errno));
    if (made && alone) {
        cli_leave_nothing_at(path);
        *folder = path;
    } else {
        free(path);
    }
    return status;
}

void cli_series_leave_folder(char *folder) {
    if (!folder)
        return;
    cli_leave_nothing_at(NULL);
    rmdir(folder); /* which fails where there are pictures in it */
    free(folder);
}

void cli_series_remove(const cli_series *series, int pictures) {
    for (int i = 0; i < pictures; i++) {
        char *file = cli_series_file(series, i + 1);
        unlink(file);
        free(file);
    }
    rmdir(series->prefix);
}
