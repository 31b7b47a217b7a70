/* Names for all that a figure depends on, by hashes. */
#include "lab/keys.h"
#include "lab/file.h"
#include "lab/motion.h"

#include <dlfcn.h>
#include <nocturne/nocturne.h>
#include <sys/utsname.h>
#include <unistd.h>

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
    noc_snprintf(key, LAB_KEY, "%016llx%016llx", (unsigned long long)(hash->h >> 64), (unsigned long long)hash->h);
}

/* Each option by name and value: an option that is new to the tables is part of the hash without a word here.
 * effective: those that change nothing beside the others are left out. */
static void hash_options(hash_state *hash, const noc_render_params *params, bool effective) {
    char why[160];
    for (const noc_option *o = noc_render_options(); o->name; o++) {
        if (effective && noc_option_idle(o, noc_render_options(), params, why, sizeof(why)))
            continue;
        char value[200]; /* they are numbers and choices */
        noc_option_get(o, params, value, sizeof(value));
        hash_text(hash, o->name);
        hash_text(hash, value);
    }
}

static void hash_file(hash_state *hash, const char *path, noc_log *log) {
    FILE *file = lab_open_file(path, log);
    if (!file)
        return;
    unsigned char buffer[1 << 14];
    for (size_t n; (n = fread(buffer, 1, sizeof(buffer), file)) > 0;)
        hash_bytes(hash, buffer, n);
    if (ferror(file))
        lab_io_error(log, path);
    fclose(file);
}

static void hash_camera(hash_state *hash, const noc_camera *c) {
    hash_bytes(hash, c->eye, sizeof(c->eye));
    hash_bytes(hash, c->target, sizeof(c->target));
    hash_bytes(hash, c->up, sizeof(c->up));
    hash_bytes(hash, &c->fov_deg, sizeof(c->fov_deg));
}

/* A reference is named by what the scene holds, not by the files it was read from: an OBJ's materials lie in another
 * file than it, and what code makes of a file may change. So specs that show the same share it, whatever they call
 * their inputs. Backends share it, too: both estimate the same picture without bias, and one truth for both is what
 * compares them; which of them made it is kept beside it. */
void lab_name_reference(lab_session *lab) {
    const lab_spec *spec = lab->spec;
    hash_state hash = hash_start();
    hash_text(&hash, noc_version());
    hash_text(&hash, lab->content);
    hash_camera(&hash, &lab->camera);
    hash_options(&hash, &spec->reference.params, true);
    hash_bytes(&hash, &spec->reference.frames, sizeof(spec->reference.frames));
    hash_bytes(&hash, &spec->ceiling, sizeof(spec->ceiling)); /* of the noise that is kept beside it */
    hash_finish(&hash, lab->reference_key);
}

/* The library by its content: between two releases the version stays while estimators change. */
static void name_build(lab_session *lab) {
    hash_state hash = hash_start();
    Dl_info info;
    hash_text(&hash, noc_version());
    if (dladdr((void *)(uintptr_t)noc_version, &info) && info.dli_fname && !access(info.dli_fname, R_OK))
        hash_file(&hash, info.dli_fname, lab->log);
    hash_finish(&hash, lab->build);
}

void lab_name_device(const lab_session *lab, char text[LAB_DEVICE]) {
    const noc_device_info *d = &lab->device;
    noc_snprintf(text, LAB_DEVICE, "%s, %s%s%s", noc_backend_name(d->backend), d->name, *d->driver ? ", " : "",
                 d->driver);
}

/* Settings of the environment that change times, or bits of pictures: ", NOCTURNE_ISA=scalar". */
static void name_settings(noc_backend_id backend, char *text, size_t size) {
    static const struct {
        noc_backend_id backend;
        const char *name;
    } settings[] = { { NOC_BACKEND_EMBREE, "NOCTURNE_ISA" },
                     { NOC_BACKEND_VULKAN, "NOCTURNE_VULKAN_ROUNDING" },
                     { NOC_BACKEND_VULKAN, "NOCTURNE_VULKAN_VALIDATION" } };
    size_t at = 0;
    *text = 0;
    for (size_t i = 0; i < NOC_COUNT(settings); i++) {
        const char *value = getenv(settings[i].name);
        char clean[41];
        if (settings[i].backend == backend && value && at < size)
            at += (size_t)noc_snprintf(text + at, size - at, ", %s=%s", settings[i].name,
                                       noc_text_clean(clean, sizeof(clean), value));
    }
}

void lab_name_machine(lab_session *lab) {
    char model[121], device[LAB_DEVICE], settings[200];
    noc_processor_name(model, sizeof(model));
    struct utsname name = { .sysname = "" };
    uname(&name);
    lab_name_device(lab, device);
    name_settings(lab->device.backend, settings, sizeof(settings));
    noc_snprintf(lab->machine, sizeof(lab->machine), "%s, %ld processors, %.20s %.40s; rendered by %s%s", model,
                 sysconf(_SC_NPROCESSORS_ONLN), name.sysname, name.machine, device, settings);
    name_build(lab);
}

void lab_name_run(const lab_session *lab, lab_run *run) {
    const lab_spec *spec = lab->spec;
    noc_render_params params = lab_params_of(lab, run);
    hash_state hash = hash_start();
    hash_text(&hash, lab->reference_key);
    hash_text(&hash, spec->scenes[spec->cameras[run->camera].scene].name);
    hash_text(&hash, spec->cameras[run->camera].name);
    hash_text(&hash, spec->configs[run->config].name);
    hash_text(&hash, lab->machine); /* rows of two machines do not mix, nor of two devices */
    hash_text(&hash, lab->build);
    hash_options(&hash, &params, false);
    for (int frame = 1; frame <= spec->cameras[run->camera].frames; frame++) {
        noc_camera camera = lab_camera_at(lab, run->camera, frame);
        hash_camera(&hash, &camera);
    }
    double fps = spec->cameras[run->camera].fps;
    if (fps > 0)
        hash_bytes(&hash, &fps, sizeof(fps));
    hash_bytes(&hash, &run->repetition, sizeof(run->repetition));
    hash_bytes(&hash, &lab->params.device.threads, sizeof(lab->params.device.threads));
    hash_bytes(&hash, &spec->ceiling, sizeof(spec->ceiling));
    hash_finish(&hash, run->key);
}
