/* What nocturne render says and writes at the end. */
#include "render.h"

#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

typedef struct meta_text {
    char *keys[192], *values[192];
    size_t count;
} meta_text;

static void add(meta_text *meta, const char *key, char *value) {
    if (meta->count == sizeof(meta->keys) / sizeof(*meta->keys))
        abort(); /* a fixed set of keys: only a change of the tables can bring this about */
    meta->keys[meta->count] = cli_format("%s", key);
    meta->values[meta->count++] = value;
}

/* Has the option a say in this picture? That of a built-in scene has none in a city, nor the tone map in a view. */
static bool counts(const render_args *args, const noc_option *o) {
    if (!strcmp(o->name, "view"))
        return !args->camera.eye;
    if (!strcmp(o->group, "Display"))
        return !args->show;
    if (!strcmp(o->group, "Animation"))
        return args->animation.on;
    return !noc_option_needs_input(o, args->common.inputs, args->common.input_count);
}

/* Everything needed to make the picture again, besides what the writer adds (units, exposure): each option by name. */
static void add_options(meta_text *meta, const render_args *args) {
    for (const cli_set *set = cli_render.sets; set->table; set++) {
        for (const noc_option *o = set->table(); o->name; o++) {
            static const char *const told_otherwise[] = { "output",  "eye",    "target",     "camera-crs", "fov",
                                                          "stats",   "frames", "size",       "exposure",   "time",
                                                          "threads", "show",   "show-range", "quiet",      "verbose",
                                                          "help",    "lamps",  "animate",    "overwrite",  "mp4",
                                                          "path",    "tracks", "show-scale", "isolines",   "backend",
                                                          "device",  "part",   NULL };
            if (cli_hidden(set, o) || cli_hidden(&(cli_set){ .hidden = told_otherwise }, o) || !counts(args, o))
                continue;
            add(meta, o->name, cli_option_value(o, (const char *)args + set->offset));
        }
    }
}

static void forget(meta_text *meta) {
    for (size_t i = 0; i < meta->count; i++) {
        free(meta->keys[i]);
        free(meta->values[i]);
    }
}

char *cli_options_text(const render_args *args) {
    meta_text meta = { .count = 0 };
    size_t size = 1, at = 0;
    add(&meta, "version", cli_format("%s", noc_version()));
    add(&meta, "exposure", cli_format("%s", args->exposure));
    add_options(&meta, args);
    for (size_t i = 0; i < meta.count; i++)
        size += strlen(meta.keys[i]) + strlen(meta.values[i]) + 2;
    char *text = cli_alloc(size);
    for (size_t i = 0; i < meta.count; i++)
        if (strcmp(meta.keys[i], "isa")) /* all of them give the same bits */
            at += (size_t)sprintf(text + at, "%s=%s\n", meta.keys[i], meta.values[i]);
    forget(&meta);
    return text;
}

/* What became of the inputs' lamps and features. */
static void add_totals(meta_text *meta, const noc_report *report) {
    noc_report_totals t;
    noc_report_get_totals(report, &t);
    const struct {
        const char *key;
        size_t count;
    } rows[] = { { "lamps-mapped", t.lamps_mapped },
                 { "lamps-inferred", t.lamps_inferred },
                 { "roads-drawn", t.roads_drawn },
                 { "images", t.images },
                 { "images-reduced", t.images_reduced },
                 { "lamps-dropped", t.lamps_dropped },
                 { "lamps-moved", t.lamps_moved },
                 { "lamps-repeated", t.lamps_repeated },
                 { "objects-repeated", t.objects_repeated },
                 { "windows-made", t.windows.windows - t.windows.own },
                 { "windows-own", t.windows.own },
                 { "windows-lit", t.windows.lit },
                 { "buildings-flats", t.windows.buildings[NOC_USE_FLATS] },
                 { "buildings-mixed", t.windows.buildings[NOC_USE_MIXED] },
                 { "buildings-offices", t.windows.buildings[NOC_USE_OFFICES] },
                 { "buildings-shops", t.windows.buildings[NOC_USE_SHOPS] },
                 { "buildings-dark", t.windows.buildings[NOC_USE_DARK] },
                 { "buildings-bare", t.windows.buildings[NOC_USE_BARE] },
                 { "walls-taken", t.windows.walls[NOC_WALL_TAKEN] },
                 { "walls-small", t.windows.walls[NOC_WALL_SMALL] },
                 { "walls-tilted", t.windows.walls[NOC_WALL_TILTED] },
                 { "walls-party", t.windows.walls[NOC_WALL_PARTY] },
                 { "walls-bare", t.windows.walls[NOC_WALL_BARE] },
                 { "walls-own", t.windows.walls[NOC_WALL_OWN] },
                 { "lamps-height-assumed", t.lamps_assumed[NOC_LAMP_HEIGHT] },
                 { "lamps-flux-assumed", t.lamps_assumed[NOC_LAMP_FLUX] },
                 { "lamps-colour-assumed", t.lamps_assumed[NOC_LAMP_COLOUR] },
                 { "lamps-direction-assumed", t.lamps_assumed[NOC_LAMP_DIRECTION] },
                 { "lamps-efficacy-assumed", t.lamps_assumed[NOC_LAMP_EFFICACY] },
                 { "tracks-of-cars", t.tracks },
                 { "cars", t.cars },
                 { "cars-on-roads", t.road_cars },
                 { "features-skipped", t.skipped },
                 { "features-repaired", t.repaired },
                 { "features-guessed", t.guessed } };
    for (size_t i = 0; i < sizeof(rows) / sizeof(*rows); i++)
        add(meta, rows[i].key, cli_format("%zu", rows[i].count));
    add(meta, "lamp-profiles", cli_format("%s", *t.profiles ? t.profiles : "none"));
    add(meta, "lamp-rules", cli_rules(report));
    add(meta, "light-groups", cli_groups(report));
}

/* Paths as they read from their ends: files of one name lie side by side, then those in folders of one name, and so on.
 */
static int compare_ends(const void *a, const void *b) {
    const char *x = **(const char *const *const *)a, *y = **(const char *const *const *)b;
    const char *p = x + strlen(x), *q = y + strlen(y);
    while (p > x && q > y && p[-1] == q[-1])
        p--, q--;
    int next[2] = { p > x ? (unsigned char)p[-1] : 0, q > y ? (unsigned char)q[-1] : 0 };
    for (int i = 0; i < 2; i++) /* a folder's end before all letters */
        next[i] = next[i] == '/' ? 1 : next[i] ? next[i] + 1 : 0;
    return next[0] - next[1];
}

/* How many names two paths have in common at their ends: of the file, of its folder, ... */
static size_t common_names(const char *x, const char *y) {
    const char *p = x + strlen(x), *q = y + strlen(y);
    for (size_t n = 0;; p--, q--) {
        n += (p == x || p[-1] == '/') && (q == y || q[-1] == '/');
        if (p == x || q == y || p[-1] != q[-1])
            return n;
    }
}

static const char *last_names(const char *path, size_t n) {
    const char *p = path + strlen(path);
    while (p > path && !(p[-1] == '/' && !--n))
        p--;
    return p;
}

/* File names with commas between them. A folder is nobody else's business: where several files have one name, each is
 * told with as many of its folders as no other has. Only what was given twice in the same words is told twice alike. */
static char *join_names(const char *const *paths, size_t count) {
    const char *const **order = cli_alloc((count + 1) * sizeof(*order));
    const char **told = cli_alloc((count + 1) * sizeof(*told));
    size_t length = 1, common_before = 0;
    for (size_t i = 0; i < count; i++)
        order[i] = &paths[i];
    qsort(order, count, sizeof(*order), compare_ends);
    for (size_t first = 0, end; first < count; first = end) {
        for (end = first + 1; end < count && !strcmp(*order[end], *order[first]);)
            end++;
        size_t common = end < count ? common_names(*order[first], *order[end]) : 0;
        const char *name = last_names(*order[first], 1 + (common > common_before ? common : common_before));
        for (size_t i = first; i < end; i++)
            told[order[i] - paths] = name;
        length += (end - first) * (strlen(name) + 2);
        common_before = common;
    }
    char *text = cli_alloc(length), *at = text;
    *text = 0;
    for (size_t i = 0; i < count; i++)
        at += sprintf(at, "%s%s", i ? ", " : "", told[i]);
    free(order);
    free(told);
    return text;
}

/* The files that a built city is built from. */
static void add_sources(meta_text *meta, const render_job *job) {
    size_t count = noc_report_file_count(job->report);
    if (!cli_is_built(&job->args->common))
        return;
    const char **paths = cli_alloc((count + 1) * sizeof(*paths));
    for (size_t i = 0; i < count; i++)
        paths[i] = noc_report_get_file(job->report, i)->path;
    add(meta, "built-from", join_names(paths, count));
    free(paths);
}

static bool is_exr(const char *path) {
    size_t n = strlen(path);
    return n >= 4 && (path[n - 1] | 32) == 'r';
}

static double auto_ev100(const render_job *job) { return cli_auto_ev100(job->image) - job->args->display.compensation; }

static double ev100(const render_job *job) {
    const noc_display_params *display = &job->args->display;
    return display->auto_exposure ? auto_ev100(job) : display->ev100;
}

noc_status cli_write_picture(render_job *job) {
    const render_args *args = job->args;
    const noc_camera *c = &job->camera;
    const noc_device_info *device = noc_device_get_info(noc_view_device(job->view));
    free(job->room);
    job->room = NULL;
    noc_image_destroy(job->image); /* of an animation's picture before */
    job->image = job->still ? noc_view_smoothed(job->view) : noc_view_image(job->view);
    if (!job->image)
        return NOC_ERR_MEMORY;
    meta_text meta = { .count = 0 };
    add(&meta, "inputs", join_names(args->common.inputs, args->common.input_count));
    add_sources(&meta, job);
    add(&meta, "lamps", join_names(args->import.lamps.text, args->import.lamps.count));
    add(&meta, "tracks", join_names(args->import.tracks.text, args->import.tracks.count));
    add(&meta, "frames", cli_format("%d", job->averaged));
    add(&meta, "backend", cli_format("%s", noc_backend_name(device->backend)));
    add(&meta, "device", cli_format("%s", device->name));
    if (job->animation)
        add(&meta, "animation", cli_format("%s", job->animation));
    add(&meta, "camera-eye", cli_format("%.17g %.17g %.17g", c->eye[0], c->eye[1], c->eye[2]));
    add(&meta, "camera-target", cli_format("%.17g %.17g %.17g", c->target[0], c->target[1], c->target[2]));
    add(&meta, "camera-up", cli_format("%.17g %.17g %.17g", c->up[0], c->up[1], c->up[2]));
    add(&meta, "camera-fov", cli_format("%.17g", c->fov_deg));
    add(&meta, "scene-triangles", cli_format("%zu", job->scene_info.triangles));
    add(&meta, "scene-lights", cli_format("%zu", job->scene_info.lights));
    add(&meta, "lamps-maintenance", cli_format("%g", job->scene_info.maintenance));
    add_totals(&meta, job->report);
    add(&meta, "given-crs-name", cli_format("%s", job->scene_info.given_crs));
    add(&meta, "given-origin",
        cli_format("%.12g %.12g %.12g", job->scene_info.given_origin[0], job->scene_info.given_origin[1],
                   job->scene_info.given_origin[2]));
    add(&meta, "scene-crs-name", cli_format("%s", job->scene_info.crs));
    add(&meta, "scene-origin",
        cli_format("%.12g %.12g %.12g", job->scene_info.origin[0], job->scene_info.origin[1],
                   job->scene_info.origin[2]));
    add_options(&meta, args);
    if (args->render.sky > 0 && !(args->render.environment_light && job->scene_info.environment_width))
        add(&meta, "sky-sqm", cli_format("%.2f", noc_sky_sqm(args->render.sky)));
    if (!args->show && is_exr(job->file))
        add(&meta, "auto-ev100", cli_format("%.4f", auto_ev100(job)));
    if (args->show)
        add(&meta, "show", cli_format("%s", noc_aov_name((noc_aov)(args->show - 1))));
    noc_image_meta texts = { meta.count, (const char *const *)meta.keys, (const char *const *)meta.values };
    noc_status status = args->show ? cli_write_view(job, &texts)
                                   : noc_image_write(job->smoothed ? job->smoothed : job->image, job->file,
                                                     &args->display, &texts, job->log);
    forget(&meta);
    return status;
}

/* Pictures that are no failure of the program, but hardly what was wanted. */
void cli_warn_of_picture(const render_job *job) {
    const noc_render_params *p = &job->args->render;
    if (job->args->common.quiet || job->far_away || !job->scene_info.lights || p->method == NOC_METHOD_HEADLIGHT)
        return;
    bool black = noc_image_is_black(job->image);
    /* of a model, which may be wound the other way */
    bool surfaces = job->scene_info.lights_by_kind[NOC_LIGHT_TRIANGLE];
    if (p->final_ray && !job->last.rays_shadow && black)
        cli_error("warning: the picture is black: the camera sees nothing that a lamp could light%s",
                  surfaces ? "; surfaces shine from one side" : "");
    else if (p->final_ray && !job->last.rays_shadow)
        cli_error("warning: the camera sees nothing that a lamp could light: only the sky, or lamps themselves");
    else if (black)
        cli_error("warning: the picture is black, no light reaches what the camera sees: is it inside a building%s?",
                  surfaces ? ", or do the surfaces that shine look away" : "");
}

uint64_t cli_peak_memory(void) {
    struct rusage usage;
    return getrusage(RUSAGE_SELF, &usage) ? 0 : (uint64_t)usage.ru_maxrss * 1024;
}

static const char *choice_name(const char *option, const void *params, char *text, size_t size) {
    for (const noc_option *o = noc_render_options(); o->name; o++)
        if (!strcmp(o->name, option))
            noc_option_get(o, params, text, size);
    return text;
}

/* Is it about a lamp, or a value of one? */
static bool is_of_lamps(const char *reason) {
    static const char *const parts[] = { " of a lamp", "lamps on a pole", "luminous flux", "wattage",
                                         "colour temperature" };
    bool found = !strncmp(reason, "lamp ", 5);
    for (size_t i = 0; i < sizeof(parts) / sizeof(*parts); i++)
        found = found || strstr(reason, parts[i]);
    return found;
}

/* Lamps before surfaces, what is lost or guessed at before what is not, what was skipped before what was repaired, then
 * the most frequent; the order of the files decides between equals. */
static int compare_issues(const void *a, const void *b) {
    const noc_report_line *x = a, *y = b;
    bool lamps[2] = { is_of_lamps(x->reason), is_of_lamps(y->reason) };
    if (lamps[0] != lamps[1])
        return lamps[0] ? -1 : 1;
    if (x->lossless != y->lossless)
        return x->lossless ? 1 : -1;
    if (x->repaired != y->repaired)
        return x->repaired ? 1 : -1;
    return x->count != y->count ? (x->count < y->count ? 1 : -1) : (x->reason > y->reason) - (x->reason < y->reason);
}

noc_report_line *cli_issues(const noc_report *report, size_t *count) {
    size_t lines = 0, n = 0;
    for (size_t i = 0; i < noc_report_file_count(report); i++)
        lines += noc_report_get_file(report, i)->line_count;
    noc_report_line *issues = cli_alloc((lines + 1) * sizeof(*issues));
    for (size_t i = 0; i < noc_report_file_count(report); i++) {
        const noc_report_file *file = noc_report_get_file(report, i);
        for (size_t j = 0; j < file->line_count; j++) {
            const noc_report_line *line = &file->lines[j];
            size_t k = 0;
            while (k < n && (issues[k].repaired != line->repaired || strcmp(issues[k].reason, line->reason)))
                k++;
            if (k == n)
                issues[n++] = *line;
            else
                issues[k].count += line->count;
        }
    }
    qsort(issues, n, sizeof(*issues), compare_issues);
    *count = n;
    return issues;
}

char *cli_doubts(const noc_report *report) {
    enum { SHOWN = 3 };
    size_t n, left = 0, guessed = 0, reasons = 0;
    noc_report_line *issues = cli_issues(report, &n);
    char a[64], b[32], reason[160];
    char *list = cli_format("%s", "");
    for (size_t i = 0; i < n; i++) {
        if (issues[i].lossless)
            continue;
        *(issues[i].repaired ? &guessed : &left) += issues[i].count;
        if (reasons++ >= SHOWN)
            continue;
        char *before = list;
        list = cli_format("%s%s%s x %s", before, *before ? ", " : "", noc_text_count(a, issues[i].count),
                          noc_text_clean(reason, sizeof(reason), issues[i].reason));
        free(before);
    }
    char *more = reasons > SHOWN ? cli_format(", and for %s (nocturne info --scene tells all)",
                                              noc_text_many(a, reasons - SHOWN, "other reason"))
                                 : cli_format("%s", "");
    char *text = !reasons ? cli_format("%s", "")
                          : cli_format("left out: %s, guessed at: %s: %s%s", noc_text_count(a, left),
                                       noc_text_count(b, guessed), list, more);
    free(list);
    free(more);
    free(issues);
    return text;
}

static void print_issues(const noc_report *report) {
    enum { SHOWN = 8 };
    size_t n;
    noc_report_totals t;
    noc_report_get_totals(report, &t);
    noc_report_line *issues = cli_issues(report, &n);
    char a[64], b[32], c[32], reason[160];
    if (n)
        printf("  inputs    features skipped: %s, repaired: %s, guessed at: %s\n", noc_text_count(a, t.skipped),
               noc_text_count(b, t.repaired), noc_text_count(c, t.guessed));
    for (size_t i = 0; i < n && i < SHOWN; i++) {
        const noc_report_line *line = &issues[i];
        printf("            %s x %s", noc_text_count(a, line->count),
               noc_text_clean(reason, sizeof(reason), line->reason));
        char *ids = cli_ids(line->examples, line->count, CLI_IDS_WIDTH);
        printf("%s%s\n", *ids ? ": " : "", ids);
        free(ids);
    }
    if (n > SHOWN)
        printf("            and for %s\n", noc_text_many(a, n - SHOWN, "other reason"));
    free(issues);
}

static void print_lamps(const noc_report *report, const noc_import_params *import) {
    noc_report_totals t;
    char a[32], b[64], c[32];
    noc_report_get_totals(report, &t);
    const struct {
        const char *what;
        size_t count;
    } rows[] = { { "mapped", t.lamps_mapped },
                 { "moved", t.lamps_moved },
                 { "inferred", t.lamps_inferred },
                 { "dropped", t.lamps_dropped },
                 { "repeated", t.lamps_repeated } };
    const char *before = "  lamps     ";
    for (size_t i = 0; i < sizeof(rows) / sizeof(*rows); i++)
        if (rows[i].count) {
            printf("%s%s %s", before, noc_text_count(a, rows[i].count), rows[i].what);
            before = i == 0 && rows[1].count ? ", of them " : ", ";
        }
    if (*before == ',')
        putchar('\n');
    cli_print_windows("  windows   ", &t.windows);
    if (t.tracks || t.cars)
        printf("  cars      %s along %s, %s along roads of maps\n", noc_text_count(a, t.cars - t.road_cars),
               noc_text_many(b, t.tracks, "track"), noc_text_count(c, t.road_cars));
    if (t.images)
        printf("  images    %s on surfaces, %s of them reduced to fit into --texture-memory\n",
               noc_text_count(a, t.images), noc_text_count(b, t.images_reduced));
    if (t.roads_drawn)
        printf("  roads     %s of maps\n", noc_text_count(a, t.roads_drawn));
    if (*t.profiles)
        printf("  profiles  %s\n", t.profiles);
    cli_print_lights("  rules     ", "  groups    ", report);
    cli_print_assumed("  assumed   ", t.lamps_assumed, import);
}

/* The map around the scene: its file, which a built city does not keep, and what it does. */
static void print_map(const render_job *job) {
    const noc_render_params *p = &job->args->render;
    const noc_scene_info *scene = &job->scene_info;
    const char *path = job->args->import.environment;
    char a[32], name[160];
    if (!scene->environment_width)
        return;
    double lux = scene->environment_lux;
    lux = (p->environment_lux > 0 && lux > 0 ? p->environment_lux : lux) * p->environment_scale;
    printf("  map       %s, %s pixels wide, ",
           noc_text_clean(name, sizeof(name), path ? last_names(path, 1) : "of the built city"),
           noc_text_count(a, (uint64_t)scene->environment_width));
    if (p->environment_light)
        printf("as background and light: %s lx on open ground\n", cli_number(a, lux));
    else
        puts("as background alone: --environment-light lights the city by it");
}

/* Seconds of a frame, without those that some waited for shaders to be compiled. */
static double frame_mean(const render_job *job) {
    return fmax(job->frame_seconds - job->last.compile_seconds, 0) / job->frames;
}

void cli_print_summary(const render_job *job) {
    const render_args *args = job->args;
    const noc_scene_info *scene = &job->scene_info;
    const noc_device_info *device = noc_device_get_info(job->device);
    char a[64], b[64], c[32], name[24] = "", path[240];
    if (!args->animation.on)
        printf("%s\n", noc_text_clean(path, sizeof(path), args->output));
    printf("  picture   %d x %d, %s of %s, ", args->render.width, args->render.height,
           noc_text_many(a, (uint64_t)job->averaged, "frame"),
           choice_name("method", &args->render, name, sizeof(name)));
    if (job->shown)
        cli_print_view_kind(job, is_exr(args->output));
    else if (is_exr(args->output))
        printf("linear cd/m2, automatic exposure would be %.2f EV100\n", auto_ev100(job));
    else
        printf("exposure %.2f EV100\n", ev100(job));
    if (job->shown)
        cli_print_view(job);
    printf("  scene     %s, %s", noc_text_many(a, scene->triangles, "triangle"),
           noc_text_many(b, scene->lights, "light"));
    if (scene->lights_inferred)
        printf(" (%s placed by a rule, not found in data)", noc_text_count(c, scene->lights_inferred));
    printf("%s%s", *scene->given_crs ? ", " : "", scene->given_crs);
    if (strcmp(scene->given_crs, scene->crs))
        printf(", computed in %s", scene->crs);
    putchar('\n');
    if (*scene->given_crs)
        printf("  origin    %.3f,%.3f,%.3f in %s is 0,0,0 of eye and target\n", scene->given_origin[0],
               scene->given_origin[1], scene->given_origin[2],
               strcmp(scene->given_crs, scene->crs) ? "the first" : "that CRS");
    print_map(job);
    if (!(args->render.environment_light && scene->environment_width))
        cli_print_sky("  sky       ", args->render.sky);
    print_lamps(job->report, &args->import);
    if (scene->maintenance != 1)
        printf("  upkeep    lamps give %g of their flux (--maintenance); meshes that shine, windows and cars all of "
               "theirs\n",
               scene->maintenance);
    print_issues(job->report);
    const double *eye = job->camera.eye, *target = job->camera.target;
    printf("  camera    eye %.2f,%.2f,%.2f target %.2f,%.2f,%.2f fov %.1f\n", cli_shown(eye[0], 2),
           cli_shown(eye[1], 2), cli_shown(eye[2], 2), cli_shown(target[0], 2), cli_shown(target[1], 2),
           cli_shown(target[2], 2), job->camera.fov_deg);
    printf("  device    %s, %s\n", noc_backend_name(device->backend), noc_text_clean(path, sizeof(path), device->name));
    printf("  time      %s: loading %s, ", noc_text_seconds(a, cli_now() - job->started),
           noc_text_seconds(b, job->loaded - job->started));
    printf("ray tracing structure %s, ", noc_text_seconds(a, job->last.build_seconds));
    if (job->last.compile_seconds > 0)
        printf("shaders %s, ", noc_text_seconds(a, job->last.compile_seconds));
    printf("%s a frame (%s)\n", noc_text_seconds(a, frame_mean(job)), job->last.path ? job->last.path : "");
    printf("  memory    %s at most, of this process\n", noc_text_bytes(a, cli_peak_memory()));
    if (job->last.dropped)
        printf("  dropped   %s, not finite\n", noc_text_many(a, job->last.dropped, "sample"));
}

void cli_print_stats(const render_job *job) {
    double sum = 0;
    for (int i = 0; i < NOC_PASS_COUNT; i++)
        sum += job->pass_seconds[i];
    bool gpu = noc_device_get_info(job->device)->backend == NOC_BACKEND_VULKAN;
    printf("\n  %-20s %10s %7s   %s, mean of %d\n", "pass", "ms", "share",
           gpu ? "the device's time of a frame" : "thread time of a frame (by the clock, all threads)", job->frames);
    for (int i = 0; i < NOC_PASS_COUNT; i++)
        if (job->pass_seconds[i] > 0)
            printf("  %-20s %10.2f %6.1f%%\n", noc_pass_name((noc_pass)i), 1e3 * job->pass_seconds[i] / job->frames,
                   sum > 0 ? 100 * job->pass_seconds[i] / sum : 0);
    double frame = frame_mean(job);
    char a[32], b[32];
    printf("  %-20s %10.2f           wall; %.2f processor\n", "frame", 1e3 * frame,
           1e3 * fmax(job->cpu_seconds - job->last.compile_cpu_seconds, 0) / job->frames);
    printf("  %-20s %s primary, %s shadow (last frame)\n", "rays", noc_text_count(a, job->last.rays_primary),
           noc_text_count(b, job->last.rays_shadow));
    if (job->floor.wall_seconds > 0)
        printf("  %-20s %10.2f           wall; the frame takes %.2f times as long\n", "trace floor",
               1e3 * job->floor.wall_seconds, frame / job->floor.wall_seconds);
    printf("  %-20s %s\n", "memory", noc_text_bytes(a, job->last.memory_bytes));
}
