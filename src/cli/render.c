/* nocturne render: inputs to a picture. */
#include "render.h"

#include <stdlib.h>
#include <string.h>

#define A render_args
#define QUICK_FRAMES 2
#define TEXT(n, g, f, u, h)                                                                                            \
    { n, g, NOC_OPTION_TEXT, offsetof(A, f), 0, 0, NULL, u, h }
static const noc_option own_options[] = {
    TEXT("output", "Output", output, "FILE", "picture to write: .png as displayed, .exr linear in cd/m2"),
    TEXT("influence-obj", "Output", influence_obj, "FILE",
         "write the influence volumes of --candidates influence as OBJ too"),
    NOC_OPTION_PRESET(A, "Estimator"),
    { "frames", "Output", NOC_OPTION_INT, offsetof(A, frames), 1, 1e9, NULL, "",
      "frames that are rendered and averaged; pictures of an animation" },
    { "smooth", "Output", NOC_OPTION_BOOL, offsetof(A, smooth), 0, 1, NULL, "",
      "with less noise, for the eye: for display alone" },
    { "time", "Output", NOC_OPTION_REAL, offsetof(A, time), 0, 1e9, NULL, "s",
      "render for about so long instead; 0 = no limit" },
    { "stats", "Output", NOC_OPTION_BOOL, offsetof(A, stats), 0, 1, NULL, "",
      "print times by pass, rays and the trace floor" },
    { NULL },
};
static const noc_option *options(void) { return own_options; }

static const noc_option picture_options[] = {
    TEXT("size", "Picture", size, "WxH", "width and height at once, such as 1920x1080"),
    { NULL },
};
static const noc_option *of_picture(void) { return picture_options; }

static int run(void *arguments);

static const render_args defaults = {
    .command = &cli_render,
    .frames = 32,
    .camera = noc_camera_default_params(),
    .exposure = "auto",
    .device = CLI_DEVICE,
    .render = noc_render_default_params(),
    .display = noc_display_default_params(),
    .import = noc_import_default_params(),
    .builtin = noc_builtin_default_params(),
    .animation = { .fps = 30, .samples = 16, .film = NOC_SWITCH_AUTO },
};
static const char *const by_exposure[] = { "auto-exposure", "ev100", NULL }; /* --exposure says both */

const cli_command cli_render = {
    "render",
    "INPUT... -o FILE",
    "Draws a city at night. Inputs (cities, meshes, lamps, builtin:NAME) make one scene.",
    "Examples\n"
    "  nocturne render builtin:city -o night.png\n"
    "  nocturne render builtin:mess --lights 100000 -o mess.png\n"
    "  nocturne render city.gml lamps.geojson --view aerial -o city.png\n"
    "  nocturne render builtin:city --candidates influence --show lights -o a.png\n"
    "  nocturne render city.gml --method reference --frames 64 -o reference.exr\n"
    "  nocturne render builtin:city --animate --frames 240 -o frame-%04d.png\n"
    "Built-in scenes are builtin:city, cityscape, mess, single and atrium.\n"
    "Ctrl-C saves the picture so far and ends with status 130; a second one ends at\n"
    "once.\n",
    { { options, 0, NULL },
      { cli_show_options, 0, NULL },
      { cli_animation_options, offsetof(A, animation), NULL },
      { cli_camera_options, 0, NULL },
      { noc_camera_options, offsetof(A, camera), NULL },
      { of_picture, 0, NULL },
      { cli_exposure_options, 0, NULL },
      { noc_render_options, offsetof(A, render), NULL },
      { noc_device_options, offsetof(A, device), NULL },
      { noc_display_options, offsetof(A, display), by_exposure },
      { noc_import_options, offsetof(A, import), NULL },
      { noc_city_options, offsetof(A, builtin.city), NULL },
      { noc_builtin_options, offsetof(A, builtin), NULL },
      { cli_common_options, 0, NULL } },
    sizeof(render_args),
    &defaults,
    run,
};

static int parse_size(render_args *args) {
    double size[2];
    if (!args->size)
        return CLI_OK;
    if (!noc_text_numbers(args->size, 'x', 2, size) || size[0] != (int)size[0] || size[1] != (int)size[1])
        return cli_usage(&cli_render, "--size: \"%.60s\" is not WIDTHxHEIGHT", args->size);
    if (!(size[0] >= 1 && size[0] <= NOC_IMAGE_MAX_SIDE && size[1] >= 1 && size[1] <= NOC_IMAGE_MAX_SIDE))
        return cli_usage(&cli_render, "--size: a side is 1 to %d px, not %.60s", NOC_IMAGE_MAX_SIDE, args->size);
    if (cli_given(&args->common, "width") || cli_given(&args->common, "height"))
        return cli_usage(&cli_render, "--size and --width or --height exclude each other");
    args->render.width = (int)size[0];
    args->render.height = (int)size[1];
    return CLI_OK;
}

int cli_parse_exposure(const cli_command *command, const char *text, noc_display_params *display) {
    if (!strcmp(text, "auto"))
        return CLI_OK;
    display->auto_exposure = false;
    const char *wrong = noc_exposure_read(text, &display->ev100);
    return wrong ? cli_usage(command, "--exposure: \"%.60s\" %s nor auto", text, wrong) : CLI_OK;
}

/* What was given and changes nothing is no error, but hardly what was meant. */
static void warn_of_idle(const render_args *args) {
    char why[160], value[8];
    bool map = cli_has_map(&args->common, &args->import);
    for (size_t i = 0; i < args->common.given_count && !args->common.quiet; i++) {
        const noc_option *o = args->common.given[i];
        bool display = !strcmp(o->group, "Display");
        if (!map && !strncmp(o->name, "environment-", 12))
            snprintf(why, sizeof(why), "there is no map around the city (--environment FILE)");
        else if (!noc_option_idle(o, display ? noc_display_options() : noc_render_options(),
                                  display ? (const void *)&args->display : &args->render, why, sizeof(why)))
            continue;
        bool off =
            o->kind == NOC_OPTION_BOOL && (noc_option_get(o, &args->render, value, sizeof(value)), *value == 'f');
        cli_error("warning: --%s%s has no effect: %s", off ? "no-" : "", o->name, why);
    }
}

static int check_influence(const render_args *args) {
    if (!args->influence_obj)
        return CLI_OK;
    bool draws = args->render.method == NOC_METHOD_RIS || args->render.method == NOC_METHOD_RESTIR;
    if (args->render.candidates != NOC_CANDIDATES_INFLUENCE || !draws)
        return cli_usage(
            &cli_render,
            "--influence-obj needs --candidates influence, with the method ris or restir: others have no influence "
            "volumes");
    return cli_check_output(&cli_render, args->influence_obj, CLI_OBJ, &args->common);
}

/* Of a still the preset quick is few frames, smoothed. */
static void use_quick(render_args *args) {
    if (args->preset != NOC_PRESET_QUICK || args->animation.on)
        return;
    if (!cli_given(&args->common, "frames"))
        args->frames = QUICK_FRAMES;
    args->smooth =
        args->smooth || !(cli_given(&args->common, "smooth") || args->show || !noc_still_aovs(&args->render));
}

/* All that can be wrong with the arguments is found before any file is read. */
static int check(render_job *job) {
    render_args *args = job->args;
    int status = cli_choose_camera(args);
    if (status)
        return status;
    cli_add_named(&args->common, &args->import);
    if (!args->common.input_count)
        return cli_usage(&cli_render, "nothing to draw: name a city model, or builtin:city");
    if (!args->output)
        return cli_usage(&cli_render, "where to? -o night.png");
    status = cli_check_city(args);
    status = status ? status : parse_size(args);
    status = status ? status : cli_parse_show(args);
    use_quick(args);
    if (!status && args->smooth && args->show)
        status = cli_usage(&cli_render, "--smooth and --show exclude each other: views are not smoothed");
    if (!status && args->smooth && !args->animation.on && !noc_still_aovs(&args->render))
        status = cli_usage(&cli_render, "--smooth and --method headlight exclude each other: it has no noise");
    if (args->smooth)
        args->render.aovs |= args->animation.on ? NOC_SMOOTH_AOVS : noc_still_aovs(&args->render);
    status = status ? status : cli_check_animation(args);
    if (!status && !args->animation.on)
        status = cli_check_output(&cli_render, args->output, CLI_PNG | CLI_EXR, &args->common);
    status = status ? status : check_influence(args);
    if (!status)
        warn_of_idle(args);
    return status;
}

static noc_status load(render_job *job) {
    render_args *args = job->args;
    char triangles[64], lights[64];
    /* what a frame would refuse, before a city is read */
    noc_status status = noc_render_check(&args->render, job->log);
    if (status)
        return status;
    cli_nothing_to_keep(true);
    status = cli_load_city(args, job->scene, &(noc_progress){ cli_load_progress, NULL }, &job->report);
    cli_nothing_to_keep(false);
    cli_progress_clear();
    noc_scene_get_info(job->scene, &job->scene_info);
    job->loaded = cli_now();
    if (!status && args->common.verbose)
        cli_error("%s, %s, loaded in %.2f s", noc_text_many(triangles, job->scene_info.triangles, "triangle"),
                  noc_text_many(lights, job->scene_info.lights, "light"), job->loaded - job->started);
    return status;
}

static bool frame_progress(void *user, const char *what, double done) {
    const render_job *job = user;
    const render_args *args = job->args;
    double spent = cli_now() - job->ready, share = (job->frames + done) / args->frames;
    if (args->time > 0) {
        cli_progress_show(spent / args->time, args->time > spent ? args->time - spent : 0, "frame %d", job->frames + 1);
    } else {
        double left = share > 0 && spent > 0.5 ? spent / share - spent : -1;
        cli_progress_show(share, left, "frame %d of %d", job->frames + 1, args->frames);
    }
    return !cli_interrupted();
}

void cli_add_stats(render_job *job) {
    noc_view_get_stats(job->view, &job->last);
    job->frame_seconds += job->last.wall_seconds;
    job->cpu_seconds += job->last.cpu_seconds;
    for (int i = 0; i < NOC_PASS_COUNT; i++)
        job->pass_seconds[i] += job->last.pass_seconds[i];
    job->frames++;
    cli_nothing_to_keep(false);
    if (job->args->common.verbose)
        cli_error("frame %d: %.3f s", job->frames, job->last.wall_seconds);
}

static noc_status render_frames(render_job *job) {
    const render_args *args = job->args;
    noc_progress progress = { frame_progress, job };
    /* With a time limit alone, time decides; with both, whichever comes first. */
    int limit = args->time > 0 && !cli_given(&args->common, "frames") ? 1000000000 : args->frames;
    noc_status status = NOC_OK;
    job->ready = cli_now();
    while (!status && job->frames < limit && !cli_interrupted()) {
        double spent = cli_now() - job->ready;
        if (args->time > 0 && job->frames && spent + 0.5 * job->frame_seconds / job->frames > args->time)
            break;
        status = noc_view_render(job->view, &job->camera, &args->render, &progress);
        if (!status)
            cli_add_stats(job);
    }
    cli_progress_clear();
    job->rendered = cli_now();
    return status;
}

/* Ctrl-C is no failure of the work: what is complete is kept. */
bool cli_is_failure(noc_status status) { return status && !(status == NOC_ERR_CANCELLED && cli_interrupted()); }

/* What the picture and its writing take is asked for before the frames: an hour's work must not fail at its end. It is
 * not touched, so it costs addresses only. */
static noc_status reserve(render_job *job) {
    const noc_render_params *p = &job->args->render;
    bool still = job->args->smooth && !job->args->animation.on;
    size_t pixel = job->args->show ? 32 : still ? 20 + NOC_STILL_BYTES : 20;
    size_t bytes = (size_t)p->width * (size_t)p->height * pixel + ((size_t)8 << 20);
    job->room = malloc(bytes);
    if (job->room)
        return NOC_OK;
    char text[32];
    cli_error("no memory for a picture of %d x %d (%s)", p->width, p->height, noc_text_bytes(text, bytes));
    return NOC_ERR_MEMORY;
}

noc_status cli_start_view(render_job *job) {
    noc_status status = reserve(job);
    if (status)
        return status;
    cli_nothing_to_keep(true); /* until a frame is complete */
    job->device = noc_device_create(&job->args->device, job->log);
    job->view = job->device ? noc_view_create(job->device, job->scene) : NULL;
    bool moves = job->args->smooth && job->args->animation.on;
    if (job->view && moves)
        job->smoother = noc_smoother_create(job->device);
    return job->view && (job->smoother || !moves) ? NOC_OK : NOC_ERR_MEMORY;
}

noc_status cli_smooth(render_job *job) {
    job->smoothed = job->smoother ? noc_smoother_step(job->smoother, job->view, NULL) : NULL;
    return job->smoothed || !job->smoother ? NOC_OK : NOC_ERR_MEMORY;
}

/* Frames in the mean that can be read: fewer than were rendered, where the device was lost. */
static int frames_left(const render_job *job) {
    noc_frame_stats stats = { 0 };
    if (job->frames)
        noc_view_get_stats(job->view, &stats);
    return stats.frames < (uint64_t)job->frames ? (int)stats.frames : job->frames;
}

/* Writes the picture of all frames that can be read. Where the device is lost over it, those that are left are written,
 * and *failed is set. */
static noc_status save(render_job *job, bool *failed) {
    job->averaged = *failed ? frames_left(job) : job->frames;
    if (!job->averaged)
        return NOC_OK;
    noc_status status = cli_write_picture(job);
    int left = status ? frames_left(job) : 0;
    if (!left || left == job->averaged)
        return status;
    *failed = true;
    job->averaged = left;
    return cli_write_picture(job);
}

/* Tells what there is of a picture that was not finished. */
static void tell_part(const render_job *job, const char *why) {
    const render_args *args = job->args;
    char text[64];
    if (!job->averaged && !job->frames)
        cli_error("%s: no frame was complete, nothing was saved", why);
    else if (!job->averaged)
        cli_error("%s: nothing is left of %s", why, noc_text_many(text, (uint64_t)job->frames, "frame"));
    else if (args->time > 0)
        cli_error("%s: saved %s to %s", why, noc_text_many(text, (uint64_t)job->averaged, "frame"), args->output);
    else
        cli_error("%s: saved %d of %d frames to %s", why, job->averaged, args->frames, args->output);
}

static bool floor_progress(void *user, const char *what, double done) {
    (void)user;
    cli_progress_show(done, -1, "%s", what);
    return !cli_interrupted();
}

static int measure_floor(render_job *job) {
    noc_progress progress = { floor_progress, NULL };
    noc_status status = noc_view_trace_floor(job->view, &job->camera, &job->args->render, &progress, &job->floor);
    cli_progress_clear();
    if (cli_is_failure(status))
        return CLI_FAILURE;
    return status ? CLI_INTERRUPTED + cli_interrupted() : CLI_OK;
}

/* One picture of all frames. */
static int draw(render_job *job) {
    render_args *args = job->args;
    noc_status status = NOC_OK;
    if (!cli_interrupted())
        status = noc_scene_place_camera(job->scene, &args->camera, (double)args->render.width / args->render.height,
                                        &job->camera, &job->far_away);
    if (!status && !cli_interrupted())
        status = cli_start_view(job);
    if (!status)
        cli_tell_photo(args, job->scene);
    if (!status && !cli_interrupted())
        status = render_frames(job);
    cli_nothing_to_keep(false);
    bool failed = cli_is_failure(status);
    if (failed && !job->frames)
        return CLI_FAILURE;
    job->file = args->output;
    job->still = args->smooth && !failed && !cli_interrupted();
    if (args->smooth && !job->still)
        cli_error("warning: the picture is not smoothed: its frames were broken off");
    if (save(job, &failed))
        return CLI_FAILURE;
    int ending = failed ? CLI_FAILURE : cli_interrupted() ? CLI_INTERRUPTED + cli_interrupted() : CLI_OK;
    if (!job->averaged) {
        tell_part(job, failed ? "stopped" : "interrupted");
        return ending;
    }
    if (!failed && args->influence_obj && noc_view_write_influence(job->view, &args->render, args->influence_obj))
        return CLI_FAILURE;
    cli_warn_of_picture(job);
    /* After the picture: the floor is measured on one more frame. */
    if (args->stats && !ending && (ending = measure_floor(job)) == CLI_FAILURE)
        return CLI_FAILURE;
    if (ending)
        tell_part(job, failed ? "stopped" : "interrupted");
    if (!args->common.quiet)
        cli_print_summary(job);
    if (args->stats)
        cli_print_stats(job);
    return cli_flush(stdout) ? ending : CLI_FAILURE;
}

/* Pictures of an animation are checked by their names (animate.c). */
static int check_sources(const render_job *job) {
    const render_args *args = job->args;
    int status = args->animation.on ? CLI_OK : cli_check_sources(job->scene, args->output);
    return status ? status : cli_check_sources(job->scene, args->influence_obj);
}

static int work(render_job *job) {
    noc_status status = load(job);
    if (!status && !job->scene_info.triangles) {
        cli_error("the inputs hold no surface that can be drawn; nocturne info tells what they hold");
        return CLI_FAILURE;
    }
    if (cli_is_failure(status) || check_sources(job))
        return CLI_FAILURE;
    return job->args->animation.on ? cli_animate(job) : draw(job);
}

static int run(void *arguments) {
    render_job job = { .args = arguments };
    int status = check(&job);
    if (status)
        return status;
    cli_catch_signals();
    cli_progress_start(job.args->common.quiet);
    job.started = cli_now();
    job.log = cli_log_create(&job.args->common);
    job.scene = noc_scene_create(job.log);
    status = job.scene ? work(&job) : CLI_FAILURE;
    cli_progress_clear();
    free(job.room);
    free(job.animation);
    noc_image_destroy(job.image);
    cli_drop_view(&job);
    noc_smoother_destroy(job.smoother);
    noc_view_destroy(job.view);
    noc_device_destroy(job.device);
    noc_report_destroy(job.report);
    noc_scene_destroy(job.scene);
    noc_log_destroy(job.log);
    return status;
}
