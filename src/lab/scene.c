/* Scenes, cameras and the reference of an experiment. A reference is kept in the cache folder under a hash of all that
 * it depends on; the files there may be deleted at any time. */
#include "lab/lab.h"

#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>
#include <unistd.h>

#define LONG_WAIT 10 /* s */

/* FNV-1a of 128 bits: no guard against malice, but no two experiments meet by chance. */
typedef struct hash_state {
    unsigned __int128 h;
} hash_state;

static hash_state hash_start(void) {
    return (hash_state){ ((unsigned __int128)0x6c62272e07bb0142u << 64) | 0x62b821756295c58du };
}

static void hash_bytes(hash_state *hash, const void *data, size_t size) {
    const unsigned __int128 prime = ((unsigned __int128)1 << 88) | 0x13b;
    const unsigned char *p = data;
    for (size_t i = 0; i < size; i++)
        hash->h = (hash->h ^ p[i]) * prime;
}

static void hash_text(hash_state *hash, const char *text) { hash_bytes(hash, text, strlen(text) + 1); }

static void hash_finish(const hash_state *hash, char key[LAB_KEY]) {
    snprintf(key, LAB_KEY, "%016llx%016llx", (unsigned long long)(hash->h >> 64), (unsigned long long)hash->h);
}

/* Each option by name and value: an option that is new to the tables is part of the hash without a word here.
 * effective: those that change nothing beside the others are left out. */
static void hash_options(hash_state *hash, const noc_render_params *params, bool effective) {
    char why[160];
    for (const noc_option *o = noc_render_options(); o->name; o++) {
        if (effective && noc_option_idle(o, noc_render_options(), params, why, sizeof(why)))
            continue;
        int n = noc_option_get(o, params, NULL, 0);
        char *value = cli_alloc((size_t)n + 1);
        noc_option_get(o, params, value, (size_t)n + 1);
        hash_text(hash, o->name);
        hash_text(hash, value);
        free(value);
    }
}

static int hash_file(hash_state *hash, const char *path) {
    FILE *file = cli_open(path);
    if (!file)
        return CLI_FAILURE;
    enum { SIZE = 1 << 16 };
    unsigned char *buffer = cli_alloc(SIZE);
    for (size_t n; (n = fread(buffer, 1, SIZE, file)) > 0;)
        hash_bytes(hash, buffer, n);
    bool failed = ferror(file);
    if (failed)
        cli_error("%s: cannot be read", path);
    free(buffer);
    fclose(file);
    return failed ? CLI_FAILURE : CLI_OK;
}

int lab_load_scene(lab_session *lab, size_t index) {
    lab_scene *scene = &lab->spec.scenes[index];
    lab->scene = noc_scene_create(lab->log);
    scene->import.progress = (noc_progress){ cli_load_progress, NULL };
    scene->import.builtin = &scene->builtin;
    cli_nothing_to_keep(true);
    noc_status status = lab->scene ? noc_scene_load(lab->scene, scene->inputs, scene->input_count, &scene->import, NULL)
                                   : NOC_ERR_MEMORY;
    cli_nothing_to_keep(false);
    cli_progress_clear();
    if (!lab->scene || status)
        return cli_interrupted() ? CLI_INTERRUPTED + cli_interrupted() : CLI_FAILURE;
    noc_scene_get_info(lab->scene, &lab->scene_infos[index]);
    noc_scene_content(lab->scene, lab->content);
    if (!lab->scene_infos[index].triangles) {
        cli_error("%s: its inputs hold no surface that can be drawn", scene->name);
        return CLI_FAILURE;
    }
    return CLI_OK;
}

static void hash_camera(hash_state *hash, const noc_camera *c) {
    hash_bytes(hash, c->eye, sizeof(c->eye));
    hash_bytes(hash, c->target, sizeof(c->target));
    hash_bytes(hash, c->up, sizeof(c->up));
    hash_bytes(hash, &c->fov_deg, sizeof(c->fov_deg));
}

/* A reference is named by what the scene holds, not by the files it was read from: an OBJ's materials lie in another
 * file than it, and what code makes of a file may change. So specs that show the same share it, whatever they call
 * their inputs. */
static void name_reference(lab_session *lab) {
    const lab_spec *spec = &lab->spec;
    hash_state hash = hash_start();
    hash_text(&hash, noc_version());
    hash_text(&hash, lab->content);
    hash_camera(&hash, &lab->camera);
    hash_options(&hash, &spec->reference.params, true);
    hash_bytes(&hash, &spec->reference.frames, sizeof(spec->reference.frames));
    hash_bytes(&hash, &spec->ceiling, sizeof(spec->ceiling)); /* of the noise that is kept beside it */
    hash_finish(&hash, lab->reference_key);
}

typedef struct making {
    const char *view;
    int frame, frames;
    double started;
} making;

static bool frame_progress(void *user, const char *what, double done) {
    const making *m = user;
    double share = (m->frame - 1 + done) / m->frames, spent = cli_now() - m->started;
    cli_progress_show(share, spent > 2 && share > 0 ? spent / share - spent : -1, "%s: reference, frame %d of %d",
                      m->view, m->frame, m->frames);
    return !cli_interrupted();
}

/* What is waited for is said ahead, and how long as soon as that shows. */
static void tell_estimate(const lab_session *lab, const making *m) {
    char took[32];
    double left = (cli_now() - m->started) / m->frame * (m->frames - m->frame);
    if (lab->args->common.quiet || left < LONG_WAIT)
        return;
    cli_progress_clear();
    printf("%s: reference, about %s to go\n", m->view, noc_text_seconds(took, left));
    fflush(stdout);
}

/* NULL where there is none, or none that is whole. */
static noc_image *read_cached(const lab_session *lab, const char *path) {
    if (access(path, R_OK))
        return NULL;
    bool linear = false;
    noc_image *image = noc_image_read(path, NULL, &linear);
    if (image && linear && image->width == lab->spec.width && image->height == lab->spec.height)
        return image;
    noc_image_destroy(image);
    return NULL;
}

static int render_reference(lab_session *lab, const char *view, const char *path, lab_noise *noise) {
    const lab_spec *spec = &lab->spec;
    noc_device *device = noc_device_create(&(noc_device_params){ .threads = lab->args->threads }, lab->log);
    noc_view *picture = noc_view_create(device, lab->scene);
    noc_status status = picture ? NOC_OK : NOC_ERR_MEMORY;
    making m = { view, 1, spec->reference.frames, cli_now() };
    int halfway = m.frames / 2, parts = m.frames < LAB_BATCHES ? m.frames : LAB_BATCHES;
    lab_batches batches = { .count = 0 };
    noc_image *half = NULL;
    for (; !status && m.frame <= m.frames; m.frame++) {
        status = noc_view_render(picture, &lab->camera, &spec->reference.params, &(noc_progress){ frame_progress, &m });
        if (!status && m.frame == (m.frames > 16 ? 3 : 1)) /* the first frames build what they need and learn */
            tell_estimate(lab, &m);
        bool part_ends = m.frame * parts / m.frames > batches.count;
        noc_image *image = !status && (part_ends || m.frame == halfway) ? noc_view_image(picture) : NULL;
        if (image && part_ends)
            lab_add_batch(&batches, image, m.frame);
        if (m.frame == halfway)
            half = image;
        else
            noc_image_destroy(image);
    }
    cli_progress_clear();
    lab->reference = status ? NULL : noc_view_image(picture);
    noc_view_destroy(picture);
    noc_device_destroy(device);
    if (lab->reference)
        *noise = lab_measure_noise(lab, half, halfway, &batches);
    noc_image_destroy(half);
    if (status && cli_interrupted()) { /* a whole one is kept, whatever comes then */
        lab->reference_lost = m.frame > 2 ? m.frame - 2 : 0;
        return CLI_INTERRUPTED + cli_interrupted();
    }
    noc_display_params display = noc_display_default_params();
    const char *keys[] = { "content", "made-by" }, *values[] = { lab->reference_key, noc_version() };
    if (!lab->reference)
        return CLI_FAILURE;
    /* A cache that takes nothing must not cost the work that went into the picture. */
    if (noc_image_write(lab->reference, path, &display, &(noc_image_meta){ 2, keys, values }, lab->log))
        cli_error("warning: the reference is not kept; another run makes it again");
    else
        lab_keep_noise(path, noise);
    return CLI_OK;
}

int lab_make_reference(lab_session *lab, size_t camera) {
    lab_spec *spec = &lab->spec;
    size_t scene = spec->cameras[camera].scene;
    if (lab_place_cameras(lab, camera))
        return CLI_FAILURE;
    int status = CLI_OK;
    name_reference(lab);
    char *path = cli_format("%s/reference-%s.exr", lab->cache, lab->reference_key), took[32], frames[64];
    lab->reference = read_cached(lab, path);
    char *view = cli_format("%s, %s", spec->scenes[scene].name, spec->cameras[camera].name);
    bool quiet = lab->args->common.quiet;
    lab_noise *noise = &lab->noises[camera];
    if (lab->reference) {
        *noise = lab_read_noise(path);
        if (!quiet)
            printf("%s: reference from %s\n", view, path);
    } else {
        double start = cli_now();
        if (!quiet)
            printf("%s: making the reference, %s of %d x %d px\n", view,
                   noc_text_many(frames, (uint64_t)spec->reference.frames, "frame"), spec->width, spec->height);
        fflush(stdout);
        status = render_reference(lab, view, path, noise);
        lab->reference_seconds += cli_now() - start;
        lab->references_made++;
        if (!status && !quiet)
            printf("%s: reference made in %s: %s\n", view, noc_text_seconds(took, cli_now() - start), path);
    }
    if (!status && !quiet && noc_image_is_black(lab->reference))
        cli_error("warning: %s: the reference is black, so errors say nothing", view);
    fflush(stdout);
    free(view);
    free(path);
    return status;
}

noc_render_params lab_params(const lab_session *lab, const lab_run *run) {
    noc_render_params p = lab->spec.configs[run->config].params;
    p.seed = lab->spec.seed + (uint32_t)run->repetition;
    p.accumulate = false; /* the mean is made here, so that one run gives both curves */
    return p;
}

const char *lab_machine(void) {
    static char machine[256];
    if (*machine)
        return machine;
    char line[256], model[128] = "unknown processor";
    FILE *file = fopen("/proc/cpuinfo", "r");
    while (file && fgets(line, sizeof(line), file)) {
        char *colon = strchr(line, ':');
        if (!colon || strncmp(line, "model name", 10))
            continue;
        line[strcspn(line, "\n")] = 0;
        snprintf(model, sizeof(model), "%.120s", colon + 1 + strspn(colon + 1, " "));
        break;
    }
    if (file)
        fclose(file);
    struct utsname name = { .sysname = "" };
    uname(&name);
    snprintf(machine, sizeof(machine), "%s, %ld processors, %.20s %.40s", model, sysconf(_SC_NPROCESSORS_ONLN),
             name.sysname, name.machine);
    return machine;
}

/* The library by its content: between two releases the version stays while estimators change. */
static const char *build_key(void) {
    static char key[LAB_KEY];
    if (*key)
        return key;
    hash_state hash = hash_start();
    Dl_info info;
    hash_text(&hash, noc_version());
    if (dladdr((void *)(uintptr_t)noc_version, &info) && info.dli_fname && !access(info.dli_fname, R_OK))
        hash_file(&hash, info.dli_fname);
    hash_finish(&hash, key);
    return key;
}

void lab_run_key(const lab_session *lab, lab_run *run) {
    const lab_spec *spec = &lab->spec;
    noc_render_params params = lab_params(lab, run);
    hash_state hash = hash_start();
    hash_text(&hash, lab->reference_key);
    hash_text(&hash, spec->scenes[spec->cameras[run->camera].scene].name);
    hash_text(&hash, spec->cameras[run->camera].name);
    hash_text(&hash, spec->configs[run->config].name);
    hash_text(&hash, lab_machine()); /* times of two machines do not mix */
    hash_text(&hash, build_key());
    hash_options(&hash, &params, false);
    for (int frame = 1; frame <= spec->cameras[run->camera].frames; frame++) {
        noc_camera camera = lab_camera_at(lab, run->camera, frame);
        hash_camera(&hash, &camera);
    }
    hash_bytes(&hash, &run->repetition, sizeof(run->repetition));
    hash_bytes(&hash, &lab->args->threads, sizeof(lab->args->threads));
    hash_bytes(&hash, &spec->ceiling, sizeof(spec->ceiling));
    hash_finish(&hash, run->key);
}
