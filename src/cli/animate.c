/* nocturne render --animate: a picture for each step along a camera path, each whole on the disk before the next
 * begins.
 *
 * Pictures come in segments. A segment knows nothing of those before it: its random numbers are its own, and its
 * history begins with frames that are not kept, of the pictures just before it. So a picture is the same whether the
 * run that made it began with the first one or with its segment, and a run that was interrupted goes on as if it had
 * not been. */
#include "render.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#define GROUP "Animation"
#define MOST_PICTURES 1000000
#define PICTURES 240      /* where neither the path nor the user says */
#define SEGMENT 48        /* pictures that reuse samples of each other */
#define MOST_WARM_UP 32   /* frames */
#define WARM_UP 8         /* of what is learned alone */
#define SMOOTH_WARM_UP 24 /* of what is accumulated by --smooth */
#define METERED 8         /* places of the path that the exposure is measured at, */
#define METERED_FRAMES 4  /* each by so many frames */
#define METERED_SIDE 192  /* of so many pixels at most */
#define KEY_SAMPLES 256   /* places of the path that its key is made of */

#define A animation_args
static const noc_option animation_options[] = {
    { "animate", GROUP, NOC_OPTION_BOOL, offsetof(A, on), 0, 1, NULL, "",
      "a picture for each step along a camera path: -o frame-%04d.png" },
    { "path", GROUP, NOC_OPTION_TEXT, offsetof(A, path), 0, 0, NULL, "NAME",
      "orbit or pan about the camera, or a path of the recipe; else its first one, or orbit" },
    { "fps", GROUP, NOC_OPTION_REAL, offsetof(A, fps), 0.01, 1000, NULL, "", "pictures a second" },
    { "duration", GROUP, NOC_OPTION_REAL, offsetof(A, duration), 0, NOC_PATH_MOST_SECONDS, NULL, "s",
      "time that the path takes; 0 = what its keys say, else what --frames take" },
    { "samples", GROUP, NOC_OPTION_INT, offsetof(A, samples), 1, 1e6, NULL, "", "frames averaged in each picture" },
    { "segment", GROUP, NOC_OPTION_INT, offsetof(A, segment), 0, MOST_PICTURES, NULL, "",
      "pictures that learn from those before them; 1 = none does; 0 = 1, or 48 with reuse or --smooth" },
    { "mp4", GROUP, NOC_OPTION_SWITCH, offsetof(A, film), 0, 2, NULL, "",
      "a film by ffmpeg, too; auto: where there is one" },
    { "overwrite", GROUP, NOC_OPTION_BOOL, offsetof(A, overwrite), 0, 1, NULL, "",
      "render pictures that are there, too, and replace files that are none of this animation" },
    CLI_OPTION_PART(A, GROUP, part_text),
    { NULL },
};
#undef A
const noc_option *cli_animation_options(void) { return animation_options; }

/* One run. */
typedef struct animation {
    render_job *job;
    const animation_args *args;
    noc_camera_path *path;
    cli_series series;
    char key[17]; /* of all that decides its pictures */
    int pictures, segment, warm_up;
    char *film, *ffmpeg; /* NULL: none is made */
    bool filmed;         /* it is there */
    char *folder;        /* of the film's pictures, that was made; NULL: none was */
    bool *kept;          /* by picture of this part: it is there already */
    int mine;            /* pictures of this part */
    int kept_count, made;
    double frames, done; /* to render, and rendered */
    double began;        /* wall clock */
    double hour;         /* that windows are switched for; < 0: as loaded */
} animation;

/* ---- before anything is read ---- */

static const noc_recipe_path *recipe_path(const render_args *args, const char *name) {
    const noc_recipe_info *recipe = noc_recipe_get_info(args->common.recipe);
    for (size_t i = 0; i < recipe->path_count; i++)
        if (!name || !strcmp(recipe->paths[i].name, name))
            return &recipe->paths[i];
    return NULL;
}

static int check_path(const render_args *args) {
    enum { NAMES = 64 };
    const noc_recipe_info *recipe = noc_recipe_get_info(args->common.recipe);
    const char *name = args->animation.path, *names[NAMES] = { "orbit", "pan" };
    size_t count = 2;
    for (size_t i = 0; i < recipe->path_count && count < NAMES; i++)
        names[count++] = recipe->paths[i].name;
    if (!name || recipe_path(args, name) || !strcmp(name, names[0]) || !strcmp(name, names[1]))
        return CLI_OK;
    const char *nearest = noc_text_nearest(name, names, count);
    return cli_usage(&cli_render, "--path: no path \"%.60s\"%s%.60s%s", name, nearest ? "; is it " : "",
                     nearest               ? nearest
                     : args->common.recipe ? ""
                                           : "; paths besides orbit and pan are of recipes",
                     nearest ? "?" : "");
}

static bool is_png(const cli_series *series) {
    size_t n = strlen(series->suffix);
    return n >= 4 && !strcasecmp(series->suffix + n - 4, ".png");
}

/* auto: of pictures as they are seen. */
static bool wants_film(const render_args *args, const cli_series *series) {
    bool likely = is_png(series) && !args->show;
    return args->animation.film == NOC_SWITCH_AUTO ? likely : args->animation.film == NOC_SWITCH_ON;
}

static int check_film(const render_args *args, const cli_series *series) {
    bool only = cli_is_film(args->output);
    if (only && args->animation.film == NOC_SWITCH_OFF)
        return cli_usage(&cli_render, "--no-mp4: -o %.80s is a film; frame-%%04d.png makes pictures", args->output);
    if (!wants_film(args, series) && !only)
        return CLI_OK;
    if (!is_png(series))
        return cli_usage(&cli_render, "--mp4 is for .png: a film of linear pictures would be dark");
    char *ffmpeg = cli_find_ffmpeg(), *film = only ? cli_format("%s", args->output) : cli_series_film(series);
    bool asked = only || args->animation.film == NOC_SWITCH_ON;
    struct stat st;
    bool in_its_way = !stat(film, &st) && !S_ISREG(st.st_mode); /* plan_film() leaves it alone */
    int status = asked || !in_its_way ? cli_check_output(&cli_render, film, CLI_MP4, &args->common) : CLI_OK;
    if (!status && !ffmpeg && asked) {
        cli_error("%s: films are made by the program ffmpeg, which is not on PATH; -o frame-%%04d.png makes pictures",
                  film);
        status = CLI_FAILURE;
    }
    free(ffmpeg);
    free(film);
    return status;
}

static int check_files(const render_args *args) {
    cli_series series;
    int status = cli_series_parse(args->output, &series);
    if (status)
        return status;
    char *first = cli_series_file(&series, 1);
    if (!cli_is_film(args->output)) /* whose pictures lie in a folder that is made when they are */
        status = cli_check_output(&cli_render, first, CLI_PNG | CLI_EXR, &args->common);
    status = status ? status : check_film(args, &series);
    free(first);
    cli_series_free(&series);
    return status;
}

int cli_check_animation(render_args *args) {
    animation_args *a = &args->animation;
    for (const noc_option *o = animation_options; o->name && !a->on; o++)
        if (cli_given(&args->common, o->name) && strcmp(o->name, "animate"))
            return cli_usage(&cli_render, "--%s is for --animate", o->name);
    if (!a->on)
        return CLI_OK;
    static const char *const others[] = { "time", "influence-obj" };
    for (size_t i = 0; i < sizeof(others) / sizeof(*others); i++)
        if (cli_given(&args->common, others[i]))
            return cli_usage(&cli_render, "--animate and --%s exclude each other", others[i]);
    if (!args->render.accumulate)
        return cli_usage(&cli_render, "--animate and --no-accumulate exclude each other; --samples 1 averages nothing");
    if (args->frames > MOST_PICTURES)
        return cli_usage(&cli_render, "--frames: an animation has %d pictures at most", MOST_PICTURES);
    int status = check_path(args);
    status = status ? status : check_files(args);
    return status ? status : cli_choose_part(&cli_render, &args->common, a->part_text, &a->part);
}

/* ---- the path ---- */

/* Pictures at even times: of an open path the last one lies at its end, of a loop a step before it. */
static double pictures_in(double seconds, double fps, bool loop) {
    return loop ? fmax(1, round(seconds * fps)) : floor(seconds * fps + 1e-6) + 1;
}

static noc_status make_path(animation *a) {
    render_args *args = a->job->args;
    const noc_recipe_path *recipe = recipe_path(args, a->args->path);
    bool pan = a->args->path && !strcmp(a->args->path, "pan"), orbit = a->args->path && !pan && !recipe;
    if (orbit || pan)
        recipe = recipe_path(args, a->args->path);
    bool loop = !recipe || recipe->loop, told = recipe && recipe->keys[recipe->key_count - 1].seconds >= 0;
    bool counted = cli_given(&args->common, "frames");
    double fps = a->args->fps, seconds = a->args->duration, aspect = (double)args->render.width / args->render.height;
    double pictures = counted ? args->frames : PICTURES;
    if (!(seconds > 0) && !told)
        seconds = fmax(pictures - !loop, 1) / fps;
    noc_status status;
    if (recipe) {
        status = noc_scene_place_path(a->job->scene, recipe->keys, recipe->key_count, loop, seconds, aspect, &a->path);
    } else {
        noc_camera_params base = args->camera;
        if (!pan && !base.eye && !cli_given(&args->common, "view") && !args->common.recipe)
            base.viewpoint = NOC_VIEWPOINT_AERIAL;
        status = noc_scene_place_camera(a->job->scene, &base, aspect, &a->job->camera, &a->job->far_away);
        if (!status)
            status = pan ? noc_camera_path_pan(&a->job->camera, seconds, a->job->log, &a->path)
                         : noc_scene_orbit(a->job->scene, &a->job->camera, seconds, &a->path);
    }
    if (status)
        return status;
    if (!counted && (told || a->args->duration > 0))
        pictures = pictures_in(noc_camera_path_seconds(a->path), fps, loop);
    if (pictures > MOST_PICTURES) {
        cli_error("--animate: %.0f pictures are more than %d", pictures, MOST_PICTURES);
        return NOC_ERR_ARGUMENT;
    }
    a->pictures = (int)pictures;
    return NOC_OK;
}

/* A name for all that decides the pictures: options, the scene, the path. */
static void make_key(animation *a) {
    uint64_t h = 0;
    char *options = cli_options_text(a->job->args), content[NOC_CONTENT_KEY];
    noc_scene_content(a->job->scene, content);
    h = cli_sum(h, options, strlen(options));
    h = cli_sum(h, content, strlen(content));
    double seconds = noc_camera_path_seconds(a->path);
    h = cli_sum(h, &seconds, sizeof(seconds));
    for (int i = 0; i < KEY_SAMPLES; i++) {
        double t = seconds * (i + 0.5) / KEY_SAMPLES, hour = noc_camera_path_hour(a->path, t);
        noc_camera c;
        noc_camera_path_at(a->path, t, &c);
        h = cli_sum(h, &c, sizeof(c));
        h = cli_sum(h, &hour, sizeof(hour));
    }
    free(options);
    snprintf(a->key, sizeof(a->key), "%016llx", (unsigned long long)h);
}

/* ---- what is there ---- */

static char *tag_of(const animation *a, int picture) { return cli_format("%s/%d", a->key, picture + 1); }

/* Segments are the items that parts share. */
static bool is_mine(const animation *a, int picture) {
    const cli_part *part = &a->args->part;
    return picture / a->segment % part->count == part->number - 1;
}

/* Returns true if the file is this picture. *told, which the caller frees, is what it says it is. */
static bool is_picture(const animation *a, int picture, const char *file, char **told) {
    char *tag = tag_of(a, picture);
    *told = NULL;
    bool is = !noc_image_read_text(file, "animation", told, NULL) && *told && !strcmp(*told, tag);
    free(tag);
    return is;
}

/* A file that is there is this animation's picture, or in the way. */
static noc_status look_at_picture(animation *a, int picture) {
    char *file = cli_series_file(&a->series, picture + 1), *told = NULL;
    struct stat st;
    noc_status status = NOC_OK;
    if (!lstat(file, &st)) {
        if (!is_picture(a, picture, file, &told)) {
            cli_error("%s is there, and is %s: --overwrite replaces it", file,
                      told ? "of other options, another path or another scene" : "no picture of an animation");
            status = NOC_ERR_ARGUMENT;
        } else {
            a->kept[picture] = true;
            a->kept_count++;
        }
    }
    free(told);
    free(file);
    return status;
}

static noc_status look_at_pictures(animation *a) {
    int taken = cli_check_sources(a->job->scene, a->film);
    taken = taken ? taken : cli_series_check(&a->series, a->pictures, a->job->scene);
    noc_status status = taken ? NOC_ERR_ARGUMENT : NOC_OK;
    a->kept = cli_alloc((size_t)a->pictures * sizeof(*a->kept));
    for (int i = 0; i < a->pictures && !status; i++) {
        if (is_mine(a, i) && !a->args->overwrite)
            status = cli_interrupted() ? NOC_ERR_CANCELLED : look_at_picture(a, i);
    }
    return status;
}

/* Returns true if the pictures of all other parts are there. */
static bool others_are_there(const animation *a) {
    bool there = true;
    for (int i = 0; i < a->pictures && there; i++) {
        if (is_mine(a, i))
            continue;
        char *file = cli_series_file(&a->series, i + 1), *told;
        there = is_picture(a, i, file, &told);
        free(told);
        free(file);
    }
    return there;
}

/* ---- the film ---- */

#define FILM_COMMENT "Nocturne animation "
static char *film_comment(const animation *a) { return cli_format(FILM_COMMENT "%s/%d", a->key, a->pictures); }

static bool film_is_there(const animation *a) {
    char *comment = film_comment(a);
    bool there = cli_file_holds(a->film, comment);
    free(comment);
    return there;
}

/* One that is there and was not asked for by its name is replaced where it is such a film. */
static void plan_film(animation *a) {
    const render_args *args = a->job->args;
    bool only = cli_is_film(args->output);
    struct stat st;
    if (!only && !wants_film(args, &a->series))
        return;
    a->film = only ? cli_format("%s", args->output) : cli_series_film(&a->series);
    a->ffmpeg = cli_find_ffmpeg();
    a->filmed = !a->args->overwrite && film_is_there(a);
    if (only || a->args->film == NOC_SWITCH_ON || stat(a->film, &st) || cli_file_holds(a->film, FILM_COMMENT))
        return;
    if (!args->common.quiet)
        cli_error("warning: %s is there, and is no film of an animation: it is left alone%s", a->film,
                  S_ISREG(st.st_mode) ? "; --mp4 replaces it" : "");
    free(a->film);
    a->film = NULL;
}

/* Of several parts the one that ends last makes it. Two that end at once may both make it, of the same pictures. */
static noc_status make_film(animation *a) {
    if (!a->film || !a->ffmpeg || (a->filmed && !a->made))
        return NOC_OK;
    bool shared = a->args->part.count > 1;
    if (shared && (!others_are_there(a) || (!a->args->overwrite && film_is_there(a)))) {
        a->filmed = film_is_there(a);
        if (a->filmed && cli_is_film(a->job->args->output))
            cli_series_remove(&a->series, a->pictures);
        return NOC_OK;
    }
    char *comment = film_comment(a);
    noc_status status = cli_make_film(a->ffmpeg, &a->series, a->pictures, a->args->fps, a->film, comment);
    free(comment);
    if (!status && cli_is_film(a->job->args->output))
        cli_series_remove(&a->series, a->pictures);
    a->filmed = !status;
    return status;
}

/* ---- frames ---- */

/* The scene and the camera as they are at that time, in seconds; before the first picture, too. */
static noc_status go_to(animation *a, double t) {
    render_job *job = a->job;
    const noc_import_params *import = &job->args->import;
    double hour = noc_camera_path_hour(a->path, t);
    bool switches = hour >= 0 && hour != a->hour;
    noc_status status = noc_camera_path_at(a->path, t, &job->camera);
    if (!status && switches) {
        noc_window_params windows = import->window;
        windows.hour = a->hour = hour;
        status = noc_scene_set_windows(job->scene, &windows);
    }
    if (!status && job->scene_info.cars)
        status = noc_scene_set_time(job->scene, import->cars.time + t);
    return status || !(switches || job->scene_info.cars) ? status : noc_scene_commit(job->scene);
}

static bool progress(void *user, const char *what, double done) {
    const animation *a = user;
    double share = (a->done + done) / a->frames, spent = cli_now() - a->began;
    cli_progress_show(share, share > 0 && spent > 0.5 ? spent / share - spent : -1, "picture %d of %d",
                      a->kept_count + a->made + 1, a->mine);
    return !cli_interrupted();
}

static noc_status render_frame(animation *a, const noc_render_params *params) {
    noc_status status = noc_view_render(a->job->view, &a->job->camera, params, &(noc_progress){ progress, a });
    if (!status) {
        cli_add_stats(a->job);
        a->done++;
    }
    return status;
}

/* One exposure for all pictures: the mean, in stops, of what places along the path would have. */
static noc_status meter(animation *a) {
    render_job *job = a->job;
    render_args *args = job->args;
    noc_render_params p = args->render;
    double sum = 0, scale = fmin(1, (double)METERED_SIDE / fmax(p.width, p.height));
    noc_render_use_preset(&p, NOC_PRESET_STILL);
    p.aovs = 0;
    p.width = (int)fmax(1, p.width * scale);
    p.height = (int)fmax(1, p.height * scale);
    noc_view *view = noc_view_create(job->device, job->scene);
    noc_status status = view ? NOC_OK : NOC_ERR_MEMORY;
    for (int i = 0; i < METERED && !status; i++) {
        status = go_to(a, noc_camera_path_seconds(a->path) * (i + 0.5) / METERED);
        for (int k = 0; k < METERED_FRAMES && !status; k++) {
            cli_progress_show((double)i / METERED, -1, "exposure");
            status = noc_view_render(view, &job->camera, &p, &(noc_progress){ cli_goes_on, NULL });
        }
        noc_image *image = status ? NULL : noc_view_image(view);
        if (!status && !image)
            status = NOC_ERR_MEMORY;
        if (image)
            sum += cli_auto_ev100(image);
        noc_image_destroy(image);
    }
    noc_view_destroy(view);
    args->display.auto_exposure = false;
    args->display.ev100 = sum / METERED - args->display.compensation;
    return status;
}

static noc_status write_picture(animation *a, int picture) {
    render_job *job = a->job;
    char *file = cli_series_file(&a->series, picture + 1);
    free(job->animation);
    job->animation = tag_of(a, picture);
    job->file = file;
    job->averaged = a->args->samples;
    noc_status status = cli_write_picture(job);
    if (!status && job->args->common.verbose)
        cli_error("%s", file);
    a->made += !status;
    job->file = NULL;
    free(file);
    return status;
}

/* Pictures of a segment up to the last that is not there. Those that are there between them are rendered again: others
 * learn from them. */
static noc_status render_segment(animation *a, int first, int last) {
    noc_render_params p = a->job->args->render;
    noc_status status = NOC_OK;
    int64_t samples = a->args->samples, from = first * samples - a->warm_up;
    p.seed += (uint32_t)(first / a->segment) * 2654435769u; /* by the golden ratio: other numbers, no history */
    for (int64_t frame = from; frame < last * samples && !status; frame++) {
        int picture = (int)(frame >= 0 ? frame / samples : -((samples - 1 - frame) / samples));
        if (frame == from || frame == picture * samples) {
            status = go_to(a, picture / a->args->fps);
            noc_view_restart(a->job->view);
        }
        status = status ? status : render_frame(a, &p);
        status = status ? status : cli_smooth(a->job);
        bool ends = !status && frame >= first * samples && frame == (picture + 1) * samples - 1;
        if (ends && !a->kept[picture])
            status = write_picture(a, picture);
        if (!status && cli_interrupted())
            status = NOC_ERR_CANCELLED;
    }
    return status;
}

/* How far the segment that begins there is to be rendered; first: not at all. */
static int segment_end(const animation *a, int first) {
    int end = first;
    for (int i = first; is_mine(a, first) && i < a->pictures && i < first + a->segment; i++)
        end = a->kept[i] ? end : i + 1;
    return end;
}

static noc_status render_all(animation *a) {
    noc_status status = NOC_OK;
    for (int i = 0; i < a->pictures; i += a->segment) {
        int end = segment_end(a, i);
        a->frames += end > i ? a->warm_up + (double)(end - i) * a->args->samples : 0;
    }
    a->began = a->job->ready = cli_now();
    for (int i = 0; i < a->pictures && !status; i += a->segment) {
        int end = segment_end(a, i);
        status = end > i ? render_segment(a, i, end) : NOC_OK;
    }
    cli_progress_clear();
    a->job->rendered = cli_now();
    return status;
}

/* ---- the run ---- */

static void choose_segments(animation *a) {
    const noc_render_params *p = &a->job->args->render;
    bool reuse = p->method == NOC_METHOD_RESTIR && p->temporal;
    bool smooth = a->job->args->smooth;
    a->segment = a->args->segment ? a->args->segment : reuse || smooth ? SEGMENT : 1;
    int frames = smooth ? SMOOTH_WARM_UP : reuse ? (int)fmin(ceil(p->history), MOST_WARM_UP) : WARM_UP;
    a->warm_up = a->segment == 1 ? 0 : frames;
    for (int i = 0; i < a->pictures; i++)
        a->mine += is_mine(a, i);
}

static noc_status make_pictures(animation *a) {
    noc_status status = look_at_pictures(a);
    if (status || a->kept_count == a->mine || cli_interrupted())
        return status;
    /* another part may have made the film meanwhile, and removed its pictures */
    if (cli_is_film(a->job->args->output) && !a->args->overwrite && film_is_there(a)) {
        a->filmed = true;
        return NOC_OK;
    }
    status = cli_is_film(a->job->args->output)
                 ? cli_series_make_folder(&a->series, a->args->part.count == 1, &a->folder)
                 : NOC_OK;
    status = status ? status : cli_start_view(a->job);
    if (!status && a->job->args->display.auto_exposure && !a->job->args->show && is_png(&a->series))
        status = meter(a);
    status = status ? status : render_all(a);
    cli_nothing_to_keep(false);
    return status;
}

static noc_status make(animation *a) {
    noc_status status = make_path(a);
    if (status)
        return status;
    choose_segments(a);
    make_key(a);
    plan_film(a);
    if (a->filmed && cli_is_film(a->job->args->output))
        return NOC_OK;
    status = make_pictures(a);
    return status ? status : make_film(a);
}

static void tell(const animation *a) {
    char text[240], to[240], *first = cli_series_file(&a->series, 1), *last = cli_series_file(&a->series, a->pictures);
    if (cli_is_film(a->job->args->output))
        puts(noc_text_clean(text, sizeof(text), a->film));
    else
        printf("%s ... %s\n", noc_text_clean(text, sizeof(text), first), noc_text_clean(to, sizeof(to), last));
    printf("  animation %d pictures", a->pictures);
    if (a->args->part.count > 1)
        printf(", %d in part %d of %d", a->mine, a->args->part.number, a->args->part.count);
    if (a->kept_count)
        printf(", %d of them were there", a->kept_count);
    printf(", %.2f s at %g a second\n", a->pictures / a->args->fps, a->args->fps);
    if (a->filmed)
        printf("  film      %s%s\n", noc_text_clean(text, sizeof(text), a->film), a->made ? "" : ", was there");
    else if (a->film && a->ffmpeg)
        puts("  film      none yet: the part that ends last makes it, or the same command again");
    else if (a->film)
        puts("  film      none: the program ffmpeg is not on PATH");
    free(first);
    free(last);
}

int cli_animate(render_job *job) {
    animation a = { .job = job, .args = &job->args->animation, .hour = -1 };
    cli_series_parse(job->args->output, &a.series); /* it was checked */
    noc_status status = cli_interrupted() ? NOC_ERR_CANCELLED : make(&a);
    int ending = cli_interrupted() ? CLI_INTERRUPTED + cli_interrupted() : CLI_OK;
    if (cli_is_failure(status)) {
        ending = CLI_FAILURE;
        if (a.made && a.kept_count + a.made < a.mine)
            cli_error("stopped: %d of %d pictures are there; the same command goes on", a.kept_count + a.made, a.mine);
    } else if (ending && !(a.began > 0)) {
        cli_error("interrupted before a picture was rendered");
    } else if (ending) {
        cli_error("interrupted: %d of %d pictures are there; the same command goes on", a.kept_count + a.made, a.mine);
    } else {
        if (!job->args->common.quiet)
            tell(&a);
        if (!job->args->common.quiet && a.made)
            cli_print_summary(job);
        if (job->args->stats && a.made)
            cli_print_stats(job);
        ending = cli_flush(stdout) ? CLI_OK : CLI_FAILURE;
    }
    cli_series_leave_folder(a.folder);
    noc_camera_path_destroy(a.path);
    cli_series_free(&a.series);
    free(a.film);
    free(a.ffmpeg);
    free(a.kept);
    return ending;
}
