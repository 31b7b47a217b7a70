/* What nocturne bench measures: a function a section. */
#include "bench.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

const char *const bench_method_names[BENCH_METHODS] = {
    "still", "interactive", "restir-uniform", "restir-influence", "restir-bias-rays", "restir-lists"
};

static noc_render_params params_of(const bench_args *args, int method) {
    noc_render_params p = noc_render_default_params();
    noc_render_use_preset(&p, method == BENCH_INTERACTIVE ? NOC_PRESET_INTERACTIVE : NOC_PRESET_STILL);
    if (method > BENCH_INTERACTIVE) {
        p.method = NOC_METHOD_RESTIR;
        p.candidates = method == BENCH_INFLUENCE ? NOC_CANDIDATES_INFLUENCE
                       : method == BENCH_LISTS   ? NOC_CANDIDATES_LISTS
                                                 : NOC_CANDIDATES_UNIFORM;
        p.bias_rays = method > BENCH_INFLUENCE;
    }
    p.width = args->width;
    p.height = args->height;
    p.sky = 0;
    return p;
}

/* Candidates and nothing else: no ray is sent to the lights. */
static noc_render_params params_of_candidates(const bench_args *args, noc_candidates candidates) {
    noc_render_params p = params_of(args, BENCH_UNIFORM);
    p.method = NOC_METHOD_RIS;
    p.candidates = candidates;
    p.visibility_reuse = p.final_ray = false;
    return p;
}

double bench_ratio(double a, double b) { return b > 0 ? a / b : NAN; }

size_t bench_rows_of(const bench *b, bench_section section) {
    size_t count = 0;
    for (size_t i = 0; i < b->row_count; i++)
        count += b->rows[i].section == section;
    return count;
}

double bench_pass_sum(const noc_lab_times *times) {
    double sum = 0;
    for (int p = 0; p < NOC_PASS_COUNT; p++)
        sum += times->pass_seconds[p];
    return sum;
}

const bench_row *bench_find(const bench *b, bench_section section, const char *view, const char *name) {
    for (size_t i = 0; i < b->row_count; i++)
        if (b->rows[i].section == section && (!view || !strcmp(b->rows[i].view, view)) &&
            !strcmp(b->rows[i].name, name))
            return &b->rows[i];
    return NULL;
}

/* ---- cases that are measured in turn ---- */

/* The cases of a table. Its scenes and devices are its own, and go after the timer. */
enum { SCENES = 8, DEVICES = 16 };
typedef struct turn {
    bench *b;
    bench_section section;
    char what[48];   /* that is at work, for the progress */
    double deadline; /* wall clock */
    noc_lab_timer *timer;
    size_t first; /* its first row */
    noc_scene *scenes[SCENES];
    noc_device *devices[DEVICES];
    size_t scene_count, device_count;
    double made, frame, round; /* s: what the last case took to be made, a frame of it, and a whole round */
} turn;

static void at_work(turn *t, const char *what) { snprintf(t->what, sizeof(t->what), "%s", what); }

/* Frames of a round that one is, with its trace floor: that is of a frame more. */
static double frames_of(bool floor) { return floor ? 2.7 : 1; }

/* When all is over. */
static double last_moment(const bench *b) { return b->args->time > 0 ? b->begun + b->args->time : INFINITY; }

/* Of the time that is left, by what the sections that are still to come are worth. */
static double deadline(const bench *b, bench_section section) {
    static const double worth[BENCH_SECTIONS] = {
        [BENCH_FLOOR] = 12,     [BENCH_CANDIDATES] = 2, [BENCH_LIGHTS] = 8,  [BENCH_WINDOWS] = 4,
        [BENCH_TRIANGLES] = 12, [BENCH_RESOLUTION] = 8, [BENCH_THREADS] = 4, [BENCH_ISA] = 6
    };
    double now = cli_now(), end = last_moment(b), sum = 0;
    if (!(b->args->time > 0))
        return INFINITY;
    for (int s = (int)section; s < BENCH_SECTIONS; s++)
        sum += b->args->sections[s] || s == (int)section ? worth[s] : 0;
    return sum > 0 && end > now ? now + (end - now) * worth[section] / sum : now;
}

static noc_status begin(bench *b, bench_section section, turn *t) {
    *t = (turn){
        .b = b, .section = section, .deadline = deadline(b, section), .first = b->row_count, .frame = b->frame
    };
    t->timer = noc_lab_timer_create(b->log);
    return t->timer ? NOC_OK : NOC_ERR_MEMORY;
}

static void end(turn *t) {
    noc_lab_timer_destroy(t->timer);
    for (size_t i = 0; i < t->scene_count; i++)
        noc_scene_destroy(t->scenes[i]);
    for (size_t i = 0; i < t->device_count; i++)
        noc_device_destroy(t->devices[i]);
}

static bool show(void *user, const char *what, double done) {
    const turn *t = user;
    const bench *b = t->b;
    double spent = cli_now() - b->begun, whole = b->args->time;
    (void)what, (void)done;
    bool over = whole > 0 && spent >= whole;
    cli_progress_show(over        ? 0.99
                      : whole > 0 ? spent / whole
                                  : (double)t->section / BENCH_SECTIONS,
                      whole > 0 && !over ? whole - spent : -1, over ? "%s: %s, the last of it" : "%s: %s",
                      bench_section_names[t->section], t->what);
    return !cli_interrupted();
}

static void leave_out(bench *b, bench_section section, const char *what, const char *why) {
    if (b->left_count == BENCH_LEFT)
        return;
    bench_left *left = &b->left[b->left_count++];
    left->section = section;
    snprintf(left->what, sizeof(left->what), "%s", what);
    snprintf(left->why, sizeof(left->why), "%s", why);
}

/* Is there time and memory for a case that takes so many seconds to be made, and for a frame? Two rounds must be
 * possible with it; of the first case of a table one, in all the time that is left. */
static bool fits(turn *t, const char *what, double made, double frame, bool floor, double bytes) {
    bool first = t->b->row_count == t->first;
    double seconds = made + frame * (2 + (first ? 1 : 2) * frames_of(floor)) + 2 * t->round;
    double left = (first ? last_moment(t->b) : t->deadline) - cli_now(), room = bench_room(&t->b->args->import);
    char why[160], a[32], c[32];
    if (bytes > 0.8 * room) {
        snprintf(why, sizeof(why), "needs about %s of memory, and %s are free", noc_text_bytes(a, (uint64_t)bytes),
                 noc_text_bytes(c, (uint64_t)room));
        leave_out(t->b, t->section, what, why);
        return false;
    }
    if (seconds > left) {
        snprintf(why, sizeof(why), "would take about %s, and %s of --time are left for these",
                 noc_text_seconds(a, seconds), noc_text_seconds(c, left > 0 ? left : 0));
        leave_out(t->b, t->section, what, why);
        return false;
    }
    return true;
}

/* Returns the seconds of a frame without those that it waited for shaders to be compiled: others do not wait again. */
static double seconds_of(const noc_frame_stats *frame, const noc_frame_stats *before) {
    return fmax(frame->wall_seconds - (frame->compile_seconds - before->compile_seconds), 0);
}

/* A case more, and the row that it fills. */
static noc_status add(turn *t, const noc_lab_case *of, const bench_row *row) {
    bench *b = t->b;
    noc_progress progress = { show, t };
    noc_lab_times times;
    at_work(t, row->name);
    if (b->row_count == BENCH_ROWS)
        return NOC_OK;
    noc_status status = noc_lab_timer_add(t->timer, of, &progress);
    status = status ? status : noc_lab_timer_get(t->timer, b->row_count - t->first, &times);
    if (status)
        return status;
    noc_scene_info info;
    noc_scene_get_info(of->scene, &info);
    bench_row *into = &b->rows[b->row_count++];
    *into = *row;
    into->section = t->section;
    into->width = of->render.width;
    into->height = of->render.height;
    into->triangles = info.triangles;
    into->lights = info.lights;
    t->made = row->load_seconds + times.first.build_seconds + times.lights.build_seconds;
    t->frame = seconds_of(&times.last, &times.first);
    t->round += t->frame * frames_of(of->floor);
    return NOC_OK;
}

/* Rounds until there are enough, or the time is over, one at least; then the rows are filled. */
static noc_status go(turn *t, int frames) {
    bench *b = t->b;
    noc_progress progress = { show, t };
    noc_status status = NOC_OK;
    double longest = 0;
    at_work(t, "frames in turn");
    for (int i = 0; !status && i < frames && (!i || cli_now() + longest <= t->deadline); i++) {
        double start = cli_now();
        status = noc_lab_timer_round(t->timer, &progress);
        longest = cli_now() - start;
    }
    for (size_t i = t->first; i < b->row_count; i++) {
        noc_status got = noc_lab_timer_get(t->timer, i - t->first, &b->rows[i].times);
        status = status ? status : got;
    }
    /* Half a table would compare what was not measured alike. */
    if (status)
        b->row_count = t->first;
    return status;
}

/* Memory that is refused to a case ends the table, not the run. */
static noc_status without(turn *t, noc_status status, const char *what) {
    if (status != NOC_ERR_MEMORY)
        return status;
    leave_out(t->b, t->section, what, "memory was refused");
    return NOC_OK;
}

/* ---- the inputs' own ---- */

static noc_status camera_of(const noc_scene *scene, noc_viewpoint view, int width, int height, noc_camera *camera) {
    return noc_scene_camera(scene, view, (double)width / height, camera);
}

static noc_status measure_floor(bench *b) {
    static const noc_viewpoint views[] = { NOC_VIEWPOINT_STREET, NOC_VIEWPOINT_AERIAL };
    static const char *const names[] = { "street", "aerial" };
    const bench_args *args = b->args;
    bool timed = args->sections[BENCH_FLOOR] || args->sections[BENCH_PASSES];
    noc_status status = NOC_OK;
    double last = deadline(b, BENCH_FLOOR), now = cli_now();
    for (int v = 0; !status && v < 2; v++) {
        turn t;
        noc_lab_case of = { .device = b->device, .scene = b->scene, .floor = timed };
        status = begin(b, BENCH_FLOOR, &t);
        t.deadline = v ? last : now + 0.5 * (last - now);
        status = status ? status : camera_of(b->scene, views[v], args->width, args->height, &of.camera);
        for (int m = 0; !status && m < BENCH_METHODS; m++) {
            bench_row row = { .view = names[v] };
            snprintf(row.name, sizeof(row.name), "%s", bench_method_names[m]);
            of.render = params_of(args, m);
            char what[48];
            snprintf(what, sizeof(what), "%s, %s", names[v], row.name);
            if (!timed || fits(&t, what, 0, t.frame, true, 0))
                status = add(&t, &of, &row);
        }
        status = status ? status : go(&t, timed ? args->frames : 0);
        end(&t);
    }
    return status;
}

/* Pixels that see a surface: candidates are drawn for them. */
static noc_status count_surfaces(const bench *b, const noc_camera *camera, size_t *count) {
    noc_render_params p = noc_render_default_params();
    p.width = b->args->width;
    p.height = b->args->height;
    p.method = NOC_METHOD_HEADLIGHT;
    p.sky = 0;
    p.aovs = 1u << NOC_AOV_DEPTH;
    noc_view *view = noc_view_create(b->device, b->scene);
    const noc_progress progress = { cli_goes_on, NULL };
    noc_status status = view ? noc_view_render(view, camera, &p, &progress) : NOC_ERR_MEMORY;
    noc_channel *depth = status ? NULL : noc_view_aov(view, NOC_AOV_DEPTH);
    *count = 0;
    for (size_t i = 0; depth && i < (size_t)depth->width * (size_t)depth->height; i++)
        *count += depth->value[i] > 0;
    status = status || depth ? status : NOC_ERR_MEMORY;
    noc_channel_destroy(depth);
    noc_view_destroy(view);
    return status;
}

static double rate_of(const noc_lab_times *times, noc_pass pass, int draws, size_t pixels) {
    double seconds = times->pass_seconds[pass];
    return seconds > 0 ? draws * (double)pixels / seconds : 0;
}

static noc_status measure_candidates(bench *b) {
    static const struct {
        noc_candidates candidates;
        noc_pass pass;
        const char *name;
    } pickers[] = { { NOC_CANDIDATES_UNIFORM, NOC_PASS_CANDIDATES_UNIFORM, "uniform" },
                    { NOC_CANDIDATES_POWER, NOC_PASS_CANDIDATES_POWER, "power" },
                    { NOC_CANDIDATES_INFLUENCE, NOC_PASS_CANDIDATES_INFLUENCE, "influence" },
                    { NOC_CANDIDATES_LIGHT_BVH, NOC_PASS_CANDIDATES_LIGHT_BVH, "light-bvh" } };
    enum { PICKERS = sizeof(pickers) / sizeof(*pickers) };
    const bench_args *args = b->args;
    noc_lab_case of = { .device = b->device, .scene = b->scene };
    noc_pass passes[PICKERS];
    bool timed = args->sections[BENCH_CANDIDATES];
    size_t pixels = 0;
    turn t;
    noc_status status = begin(b, BENCH_CANDIDATES, &t);
    status = status ? status : camera_of(b->scene, NOC_VIEWPOINT_STREET, args->width, args->height, &of.camera);
    status = status ? status : count_surfaces(b, &of.camera, &pixels);
    for (int i = 0; !status && i < PICKERS; i++) {
        bench_row row = { .surface_pixels = pixels };
        snprintf(row.name, sizeof(row.name), "%s", pickers[i].name);
        of.render = params_of_candidates(args, pickers[i].candidates);
        if (timed && !fits(&t, row.name, 0, t.frame, false, 0))
            continue;
        passes[b->row_count - t.first] = pickers[i].pass;
        status = add(&t, &of, &row);
    }
    status = status ? status : go(&t, timed ? args->frames : 0);
    for (size_t i = t.first; !status && i < b->row_count; i++)
        b->rows[i].candidates = rate_of(&b->rows[i].times, passes[i - t.first], of.render.draws, pixels);
    end(&t);
    return status;
}

static noc_status measure_windows(bench *b) {
    const bench_args *args = b->args;
    if (!b->info.windows || cli_is_built(&args->common)) {
        leave_out(b, BENCH_WINDOWS, "windows", b->info.windows ? "they are part of the built city" : "there are none");
        return NOC_OK;
    }
    noc_lab_case of = {
        .device = b->device, .scene = b->scene, .render = params_of(args, args->method), .floor = true
    };
    turn t;
    noc_status status = begin(b, BENCH_WINDOWS, &t);
    status = status ? status : camera_of(b->scene, NOC_VIEWPOINT_STREET, args->width, args->height, &of.camera);
    at_work(&t, "windows off");
    cli_nothing_to_keep(false);
    double start = cli_now();
    if (!status && fits(&t, "windows", b->load_seconds, 2 * t.frame, true, (double)b->info.memory_bytes)) {
        status = bench_load(b, false, &t.scenes[0]);
        t.scene_count = !status;
        bench_row off = { .name = "windows off", .load_seconds = cli_now() - start }, on = { .name = "windows on" };
        noc_lab_case dark = of;
        dark.scene = t.scenes[0];
        status = status ? status : add(&t, &dark, &off);
        status = status ? status : add(&t, &of, &on);
        status = status ? status : go(&t, args->frames);
    }
    end(&t);
    return status;
}

static noc_status measure_resolution(bench *b) {
    const bench_args *args = b->args;
    int count = args->quick ? 2 : 4;
    turn t;
    noc_status status = begin(b, BENCH_RESOLUTION, &t);
    for (int i = 0; !status && i < count; i++) {
        int size[2] = { args->base_width << i, args->base_height << i };
        noc_lab_case of = { .device = b->device, .scene = b->scene, .render = params_of(args, args->method) };
        bench_row row = { .name = "" };
        snprintf(row.name, sizeof(row.name), "%d x %d", size[0], size[1]);
        of.render.width = size[0];
        of.render.height = size[1];
        if (!fits(&t, row.name, 0, (i ? 4 : 1) * t.frame, false, 400.0 * size[0] * size[1]))
            break;
        status = camera_of(b->scene, NOC_VIEWPOINT_STREET, size[0], size[1], &of.camera);
        status = status ? status : add(&t, &of, &row);
    }
    status = without(&t, status, "larger ones");
    status = status ? status : go(&t, args->frames);
    end(&t);
    return status;
}

static noc_status measure_threads(bench *b) {
    const bench_args *args = b->args;
    int most = args->device.threads > 0 ? args->device.threads : (int)sysconf(_SC_NPROCESSORS_ONLN);
    noc_lab_case of = { .scene = b->scene, .render = params_of(args, args->method) };
    turn t;
    noc_status status = begin(b, BENCH_THREADS, &t);
    status = status ? status : camera_of(b->scene, NOC_VIEWPOINT_STREET, args->width, args->height, &of.camera);
    for (int n = 1; !status && n <= most && t.device_count < DEVICES; n = n < most && 2 * n > most ? most : 2 * n) {
        bench_row row = { .threads = n };
        snprintf(row.name, sizeof(row.name), "%d", n);
        /* a ray tracing structure a device; more threads cost less time than fewer */
        double frame = (n == 1 ? most : 1) * t.frame;
        if (!fits(&t, row.name, t.made, frame, false, 300.0 * (double)b->info.triangles))
            break;
        of.device = t.devices[t.device_count] = noc_device_create(&(noc_device_params){ .threads = n }, b->log);
        t.device_count += of.device != NULL;
        status = of.device ? add(&t, &of, &row) : NOC_ERR_MEMORY;
    }
    status = without(&t, status, "more threads");
    status = status ? status : go(&t, args->frames);
    end(&t);
    return status;
}

static noc_status measure_isa(bench *b) {
    const bench_args *args = b->args;
    noc_lab_case of = { .device = b->device, .scene = b->scene };
    size_t pixels = 0;
    turn t;
    noc_status status = begin(b, BENCH_ISA, &t);
    status = status ? status : camera_of(b->scene, NOC_VIEWPOINT_STREET, args->width, args->height, &of.camera);
    status = status ? status : count_surfaces(b, &of.camera, &pixels);
    /* two cases each, which become one row: a frame, and candidates alone */
    for (int isa = NOC_ISA_SCALAR; !status && isa < NOC_ISA_COUNT; isa++) {
        bench_row row = { .surface_pixels = pixels };
        snprintf(row.name, sizeof(row.name), "%s", noc_isa_name((noc_isa)isa));
        bool runs = noc_isa_runs((noc_isa)isa);
        /* scalar code takes some five times as long */
        bool fit = runs && fits(&t, row.name, 0, (isa == NOC_ISA_SCALAR ? 10 : 4) * b->frame, false, 0);
        for (int alone = 0; !status && alone < 2 && fit; alone++) {
            of.render = alone ? params_of_candidates(args, NOC_CANDIDATES_UNIFORM) : params_of(args, args->method);
            of.render.isa = (noc_isa)isa;
            status = add(&t, &of, &row);
        }
        if (!runs)
            leave_out(b, BENCH_ISA, row.name, "this processor, or this build, does not have it");
    }
    status = status ? status : go(&t, args->frames);
    for (size_t i = t.first, to = i; !status && i < b->row_count; i += 2) {
        double rate = rate_of(&b->rows[i + 1].times, NOC_PASS_CANDIDATES_UNIFORM, of.render.draws, pixels);
        b->rows[to] = b->rows[i];
        b->rows[to++].candidates = rate;
        if (i + 2 >= b->row_count) {
            b->row_count = to;
            break;
        }
    }
    end(&t);
    return status;
}

/* ---- built-in scenes that grow ---- */

/* Scenes of a kind, each larger than the one before: name is a built-in scene's. */
typedef struct growth {
    bench_section section;
    const char *name;
    noc_viewpoint view;
    double amount[6]; /* lights of mess, metres of city; 0 ends them */
    double count[6];  /* lights, triangles: about so many */
    double bytes;     /* that each of them takes at most */
    const char *noun;
} growth;

static noc_status grow(bench *b, const growth *g) {
    const bench_args *args = b->args;
    noc_status status;
    turn t;
    char what[48];
    double before = 0;
    status = begin(b, g->section, &t);
    for (size_t i = 0; !status && i < 6 && g->amount[i] > 0; i++) {
        noc_builtin_params params = noc_builtin_default_params();
        noc_lab_case of = { .device = b->device, .render = params_of(args, args->method), .floor = true };
        double start = cli_now(), times = i ? g->count[i] / g->count[i - 1] : 1, made = t.made * times;
        if (i > 1) /* as it grew from the one before */
            made = t.made + (t.made - before) * (times - 1) / (1 - g->count[i - 2] / g->count[i - 1]);
        params.lights = (int)(g->section == BENCH_LIGHTS ? g->amount[i] : params.lights);
        params.city.size = g->section == BENCH_LIGHTS ? params.city.size : g->amount[i];
        char number[32];
        snprintf(what, sizeof(what), "%s %s", noc_text_count(number, (uint64_t)g->count[i]), g->noun);
        if (!fits(&t, what, made, (i ? 1.2 : 1) * t.frame, true, g->bytes * g->count[i]))
            break;
        at_work(&t, what);
        if (!show(&t, "", 0))
            status = NOC_ERR_CANCELLED;
        noc_scene *scene = status ? NULL : noc_scene_create(b->log);
        if (scene)
            t.scenes[t.scene_count++] = scene;
        status = status ? status : scene ? noc_scene_add_builtin(scene, g->name, &params) : NOC_ERR_MEMORY;
        status = status ? status : noc_scene_commit(scene);
        status = status ? status : camera_of(scene, g->view, args->width, args->height, &of.camera);
        bench_row row = { .load_seconds = cli_now() - start };
        noc_text_count(row.name, (uint64_t)g->count[i]);
        of.scene = scene;
        before = t.made;
        status = status ? status : add(&t, &of, &row);
    }
    status = without(&t, status, what);
    status = status ? status : go(&t, args->frames);
    end(&t);
    return status;
}

static noc_status measure_lights(bench *b) {
    growth g = {
        BENCH_LIGHTS, "mess", NOC_VIEWPOINT_OWN, { 1e3, 1e4, 1e5, 1e6 }, { 1e3, 1e4, 1e5, 1e6 }, 800, "lights"
    };
    if (b->args->quick)
        g.amount[2] = 0;
    return grow(b, &g);
}

static noc_status measure_triangles(bench *b) {
    growth g = {
        BENCH_TRIANGLES, "city", NOC_VIEWPOINT_STREET, { 240, 380, 665, 1140, 1990 }, { 1e5, 3e5, 1e6, 3e6, 1e7 }, 250,
        "triangles"
    };
    if (b->args->quick)
        g.amount[2] = 0;
    return grow(b, &g);
}

/* ---- all of it ---- */

/* Of --time, so that each table asked for has at least its first rows at that size. */
static void choose_size(bench *b) {
    static const int sizes[][2] = { { 480, 270 }, { 384, 216 }, { 320, 180 }, { 240, 135 }, { 160, 90 } };
    /* frames, of each table's first rows with those that do not count */
    static const double frames[BENCH_SECTIONS] = {
        [BENCH_FLOOR] = 56,     [BENCH_CANDIDATES] = 12, [BENCH_LIGHTS] = 10, [BENCH_WINDOWS] = 10,
        [BENCH_TRIANGLES] = 10, [BENCH_RESOLUTION] = 15, [BENCH_THREADS] = 9, [BENCH_ISA] = 40
    };
    bench_args *args = b->args;
    double sum = 0, frame = b->frame, pixels = (double)args->width * args->height;
    for (int s = 0; s < BENCH_SECTIONS; s++)
        sum += args->sections[s] || (s == BENCH_FLOOR && args->sections[BENCH_PASSES]) ? frames[s] : 0;
    /* what is left is for scenes that are made, and for more rounds */
    for (size_t i = 1; i < sizeof(sizes) / sizeof(*sizes) && b->frame * sum > 0.6 * args->time; i++) {
        args->width = args->base_width = sizes[i][0];
        args->height = args->base_height = sizes[i][1];
        b->frame = frame * args->width * args->height / pixels;
        b->large = frame;
    }
}

static bool show_probe(void *user, const char *what, double done) {
    (void)user, (void)what;
    cli_progress_show(0, -1, done > 0 ? "the first picture" : "the ray tracing structure");
    return !cli_interrupted();
}

noc_status bench_probe(bench *b) {
    const bench_args *args = b->args;
    noc_progress progress = { show_probe, NULL };
    noc_render_params p = params_of(args, BENCH_STILL);
    noc_frame_stats stats[2];
    noc_camera camera;
    b->kept = noc_view_create(b->device, b->scene);
    noc_status status = b->kept ? NOC_OK : NOC_ERR_MEMORY;
    status = status ? status : camera_of(b->scene, NOC_VIEWPOINT_STREET, args->width, args->height, &camera);
    for (int i = 0; !status && i < 2; i++) {
        status = noc_view_render(b->kept, &camera, &p, &progress);
        noc_view_get_stats(b->kept, &stats[i]);
    }
    if (status)
        return status;
    b->frame = seconds_of(&stats[1], &stats[0]);
    if (args->time > 0 && !args->quick && !cli_given(&args->common, "size"))
        choose_size(b);
    return NOC_OK;
}

noc_status bench_measure(bench *b, void (*printed)(const bench *b, bench_section section)) {
    static noc_status (*const sections[BENCH_SECTIONS])(bench * b) = {
        [BENCH_FLOOR] = measure_floor,         [BENCH_CANDIDATES] = measure_candidates,
        [BENCH_LIGHTS] = measure_lights,       [BENCH_WINDOWS] = measure_windows,
        [BENCH_TRIANGLES] = measure_triangles, [BENCH_RESOLUTION] = measure_resolution,
        [BENCH_THREADS] = measure_threads,     [BENCH_ISA] = measure_isa,
    };
    const bool *wanted = b->args->sections;
    bool processor = noc_device_get_info(b->device)->kind == NOC_DEVICE_PROCESSOR;
    noc_status status = NOC_OK;
    for (int s = 0; !status && s < BENCH_SECTIONS; s++) {
        bool needed = wanted[s] || (s == BENCH_FLOOR && (wanted[BENCH_PASSES] || wanted[BENCH_MEMORY])) ||
                      (s == BENCH_CANDIDATES && wanted[BENCH_MEMORY]);
        bool empty = s == BENCH_PASSES && !bench_rows_of(b, BENCH_FLOOR);
        bool over = cli_now() >= last_moment(b) && s != BENCH_PASSES && s != BENCH_MEMORY;
        if (wanted[s] && (empty || over))
            leave_out(b, (bench_section)s, "all of it", "--time is over");
        else if (wanted[s] && !processor && (s == BENCH_THREADS || s == BENCH_ISA))
            leave_out(b, (bench_section)s, "all of it", "it is measured on the processor alone");
        else if (needed && sections[s])
            status = sections[s](b);
        cli_progress_clear();
        b->measured[s] = !status && wanted[s];
        if (b->measured[s])
            printed(b, (bench_section)s);
        cli_nothing_to_keep(false);
    }
    return status;
}
