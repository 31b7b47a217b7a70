/* nocturne view: the city in a browser. */
#include "render.h"
#include "viewer/viewer.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <math.h>
#include <spawn.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { SHORTEST_TOKEN = 16, LONGEST_TOKEN = 128 };

/* What clients can make it say: so many lines at once and a minute. While the city is read there is no such limit. */
#define LINES 20
typedef struct view_lines {
    atomic_bool loaded;
    double left, since; /* lines; when they were counted, s */
    bool told;          /* that more was left out */
} view_lines;

/* Arguments of render that view takes too, and its own. */
typedef struct view_args {
    render_args render;
    const char *address, *token, *token_file;
    int port, clients;
    bool open;
    bool unsaid;                       /* the link could not be written */
    char own_token[LONGEST_TOKEN + 1]; /* token_file's */
    char *page;                        /* of --open, which leads to the link; NULL: none */
    view_lines *lines;
} view_args;

#define A view_args
static const noc_option own_options[] = {
    { "port", "Viewer", NOC_OPTION_INT, offsetof(A, port), 0, 65535, NULL, "",
      "port to listen at; 0 = any that is free" },
    { "address", "Viewer", NOC_OPTION_TEXT, offsetof(A, address), 0, 0, NULL, "ADDRESS",
      "address to listen at; 127.0.0.1 is reached from this machine alone" },
    { "clients", "Viewer", NOC_OPTION_INT, offsetof(A, clients), 1, 64, NULL, "", "browsers at once, at most" },
    { "token", "Viewer", NOC_OPTION_TEXT, offsetof(A, token), 0, 0, NULL, "TEXT",
      "secret that the link has, 16 or more letters and digits; else a random one" },
    { "token-file", "Viewer", NOC_OPTION_TEXT, offsetof(A, token_file), 0, 0, NULL, "FILE",
      "the same, from the first line of a file: arguments are seen by other users" },
    { "open", "Viewer", NOC_OPTION_BOOL, offsetof(A, open), 0, 1, NULL, "",
      "open the link in a browser of this machine" },
    { NULL },
};
static const noc_option *options(void) { return own_options; }

static const noc_option estimator_options[] = {
    NOC_OPTION_PRESET(render_args, "Estimator"),
    { NULL },
};
static const noc_option *of_estimator(void) { return estimator_options; }

static int run(void *arguments);

static const view_args defaults = {
    .render = { .command = &cli_view,
                .preset = NOC_PRESET_INTERACTIVE,
                .camera = noc_camera_default_params(),
                .exposure = "auto",
                .device = CLI_DEVICE,
                .render = noc_render_default_params(),
                .display = noc_display_default_params(),
                .import = noc_import_default_params(),
                .builtin = noc_builtin_default_params() },
    .address = "127.0.0.1",
    .port = 8017,
    .clients = 8,
};
/* --exposure says both; the page says how large its picture is */
static const char *const by_exposure[] = { "auto-exposure", "ev100", NULL };
static const char *const by_page[] = { "width", "height", NULL };

const cli_command cli_view = {
    "view",
    "[INPUT...]",
    "Shows a city in a browser, to walk through it and to see who lights what. Without inputs the built-in city.",
    "Examples\n"
    "  nocturne view\n"
    "  nocturne view city.yaml --open\n"
    "  nocturne view city.yaml --show illuminance --isolines 5,7.5,10,20\n"
    "  nocturne view city.gml lamps.geojson --view aerial --port 0\n"
    "It prints a link for the browser. From another machine:\n"
    "  ssh -L 8017:127.0.0.1:8017 SERVER nocturne view\n"
    "Ctrl-C ends it.\n",
    { { options, 0, NULL },
      { cli_show_options, offsetof(A, render), NULL },
      { of_estimator, offsetof(A, render), NULL },
      { cli_camera_options, offsetof(A, render), NULL },
      { noc_camera_options, offsetof(A, render.camera), NULL },
      { noc_render_options, offsetof(A, render.render), by_page },
      { noc_device_options, offsetof(A, render.device), NULL },
      { cli_exposure_options, offsetof(A, render), NULL },
      { noc_display_options, offsetof(A, render.display), by_exposure },
      { noc_import_options, offsetof(A, render.import), NULL },
      { noc_city_options, offsetof(A, render.builtin.city), NULL },
      { noc_builtin_options, offsetof(A, render.builtin), NULL },
      { cli_common_options, 0, NULL } },
    sizeof(view_args),
    &defaults,
    run,
};

/* The first line of the file becomes the token. */
static int read_token(view_args *args) {
    char *to = args->own_token;
    int fd = open(args->token_file, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    ssize_t n = fd >= 0 ? read(fd, to, sizeof(args->own_token)) : -1; /* of a folder it is an error, too */
    int error = errno;
    if (fd >= 0)
        close(fd);
    if (n < 0) {
        cli_error("--token-file: %s: %s", args->token_file, strerror(error));
        return CLI_FAILURE;
    }
    size_t size = (size_t)n, line = 0;
    while (line < size && to[line] != '\n' && to[line] != '\r')
        line++;
    if (line > LONGEST_TOKEN)
        line = 0; /* no token is so long */
    to[line] = 0;
    args->token = to;
    return CLI_OK;
}

static int check_token(view_args *args) {
    if (args->token && args->token_file)
        return cli_usage(&cli_view, "--token and --token-file exclude each other");
    int status = args->token_file ? read_token(args) : CLI_OK;
    const char *token = args->token;
    size_t n = token ? strlen(token) : SHORTEST_TOKEN;
    bool plain = !token || strspn(token, "0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ-_") == n;
    if (status || (plain && n >= SHORTEST_TOKEN && n <= LONGEST_TOKEN))
        return status;
    return cli_usage(&cli_view, "%s: %d to %d letters, digits, - and _", args->token_file ? "--token-file" : "--token",
                     SHORTEST_TOKEN, LONGEST_TOKEN);
}

static int check(view_args *args) {
    render_args *render = &args->render;
    int status = check_token(args);
    status = status ? status : cli_choose_camera(render);
    if (status)
        return status;
    cli_add_named(&render->common, &render->import);
    if (!render->common.input_count)
        render->common.inputs[render->common.input_count++] = "builtin:city";
    status = cli_check_city(render);
    for (size_t i = 0; i < render->common.input_count && !status; i++) { /* before a link is told that leads nowhere */
        const char *path = render->common.inputs[i];
        if (strncmp(path, "builtin:", 8) != 0 && access(path, F_OK)) {
            cli_error("%s: %s", path, strerror(errno));
            status = CLI_FAILURE;
        }
    }
    return status ? status : cli_parse_show(render);
}

/* ---- what the viewer asks for ---- */

static noc_status load(void *user, noc_scene *scene, const noc_progress *progress, noc_report **report) {
    view_args *args = user;
    noc_import_params *import = &args->render.import;
    import->each_lamp = true; /* for the cards of lamps */
    bool wet = import->wet;   /* rain is the viewer's, who can end it */
    import->wet = false;
    cli_nothing_to_keep(true); /* what reads may not be asked to stop */
    noc_status status = cli_load_city(&args->render, scene, progress, report);
    cli_nothing_to_keep(false);
    import->wet = wet;
    atomic_store(&args->lines->loaded, true);
    return status;
}

/* As render does, of a picture that is there. */
static noc_status write_picture(void *user, const viewer_picture *p, const char *path, noc_log *log) {
    const view_args *args = user;
    render_args told = args->render;
    told.command = &cli_render;
    told.output = path;
    told.render = p->render;
    told.display = p->display;
    told.range = p->channel;
    told.show = p->show;
    told.preset = p->preset;
    told.import = *p->import;
    told.camera = (noc_camera_params){ .eye = "", .target = "" };
    render_job job = { .args = &told,
                       .log = log,
                       .scene = p->scene,
                       .view = p->view,
                       .report = (noc_report *)p->report,
                       .camera = p->camera,
                       .file = path,
                       .averaged = (int)(p->frames < INT_MAX ? p->frames : INT_MAX) };
    noc_scene_get_info(p->scene, &job.scene_info);
    noc_status status = cli_write_picture(&job);
    cli_drop_view(&job);
    noc_image_destroy(job.image);
    return status;
}

/* A message of the library's. By the log's lock one at a time. */
static void tell(void *user, noc_log_level level, const char *text) {
    view_lines *lines = user;
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    double now = (double)t.tv_sec;
    lines->left = fmin(LINES, lines->left + (now - lines->since) * LINES / 60);
    lines->since = now;
    if (atomic_load(&lines->loaded) && lines->left < 1) {
        if (!lines->told)
            cli_error("warning: more messages come than %d a minute: they are left out", LINES);
        lines->told = true;
        return;
    }
    lines->left -= atomic_load(&lines->loaded) ? 1 : 0;
    lines->told = false;
    cli_log_message(NULL, level, text);
}

static bool ended(void *user) {
    const view_args *args = user;
    return args->unsaid || cli_interrupted();
}

static void say(void *user, noc_log_level level, const char *text) {
    (void)user;
    cli_error("%s%s", level == NOC_LOG_WARN ? "warning: " : "", text);
}

/* A page of this user's alone that leads to the link: arguments of programs are seen by all users, and the link holds
 * the token. NULL after a warning. */
static char *write_page(const char *link) {
    const char *run = getenv("XDG_RUNTIME_DIR");
    struct stat st;
    bool own = run && *run == '/' && !stat(run, &st) && S_ISDIR(st.st_mode) && !access(run, W_OK);
    char *path = cli_format("%s/nocturne-XXXXXX.html", own ? run : "/tmp");
    int fd = mkostemps(path, 5, O_CLOEXEC); /* of mode 0600 */
    FILE *page = fd < 0 ? NULL : fdopen(fd, "w");
    bool ok = page && fprintf(page,
                              "<!doctype html><meta charset=\"utf-8\"><meta name=\"referrer\" content=\"no-referrer\">"
                              "<meta http-equiv=\"refresh\" content=\"0;url=%s\"><title>Nocturne</title>"
                              "<a href=\"%s\">Nocturne</a>\n",
                              link, link) > 0;
    ok = page && !fclose(page) && ok;
    if (ok)
        return path;
    cli_error("warning: --open: %s: %s; open the link by hand", path, strerror(errno));
    if (fd >= 0)
        unlink(path);
    free(path);
    return NULL;
}

static void open_browser(view_args *args, const char *link) {
    if (!(args->page = write_page(link)))
        return;
    cli_leave_nothing_at(args->page);
    char program[] = "xdg-open", *copy = cli_format("file://%s", args->page), *words[] = { program, copy, NULL };
    pid_t child;
    if (posix_spawnp(&child, program, NULL, NULL, words, environ))
        cli_error("warning: --open: xdg-open is not there; open the link by hand");
    free(copy);
}

static void listening(void *user, const char *link) {
    view_args *args = user;
    cli_progress_clear();
    printf("%s\n", link);
    args->unsaid = !cli_flush(stdout); /* nobody could come */
    if (args->open && !args->unsaid)
        open_browser(args, link);
}

/* Options of the words, each with the struct that it is a field of. */
static viewer_given *list_given(view_args *args, size_t *count) {
    const cli_args *common = &args->render.common;
    viewer_given *given = cli_alloc(sizeof(*given) * (common->given_by_words + 1));
    *count = 0;
    for (size_t i = 0; i < common->given_by_words; i++)
        for (const cli_set *set = cli_view.sets; set->table; set++)
            for (const noc_option *o = set->table(); o->name; o++)
                if (o == common->given[i])
                    given[(*count)++] = (viewer_given){ o, (const char *)args + set->offset };
    return given;
}

static int view(view_args *args, noc_log *log) {
    const render_args *render = &args->render;
    viewer_source source = {
        .said = render->common.said_count ? render->common.said : render->common.inputs,
        .said_count = render->common.said_count ? render->common.said_count : render->common.input_count,
        .recipe = render->common.recipe,
        .load = load,
        .write = write_picture,
        .user = args,
        .import = &render->import,
        .camera = render->camera,
        .render = render->render,
        .display = render->display,
        .show = render->show,
        .channel = render->range,
        .device = render->device,
    };
    source.given = list_given(args, &source.given_count);
    viewer_params params = { args->address, args->port, args->clients, args->token, ended, listening, say, args };
    noc_status status = viewer_run(&source, &params, log);
    free((void *)source.given);
    cli_leave_nothing_at(NULL);
    if (args->page)
        unlink(args->page);
    free(args->page);
    if (status == NOC_ERR_UNSUPPORTED)
        cli_error("this build has no viewer: %s; build it with the Meson option -Dviewer=enabled", viewer_features());
    return status || args->unsaid ? CLI_FAILURE : cli_interrupted() ? CLI_INTERRUPTED + cli_interrupted() : CLI_OK;
}

static int run(void *arguments) {
    view_args *args = arguments;
    int status = check(args);
    if (status)
        return status;
    cli_catch_signals();
    cli_progress_start(args->render.common.quiet);
    view_lines lines = { .left = LINES };
    noc_log *log = noc_log_create(&(noc_log_params){ cli_log_level(&args->render.common), tell, &lines });
    if (!log)
        cli_no_memory();
    args->lines = &lines;
    status = noc_render_check(&args->render.render, log) ? CLI_FAILURE : view(args, log);
    noc_log_destroy(log);
    return status;
}
