/* The spec of an experiment: JSON to structs. All that can be wrong with it is found here, before the long work. */
#include "lab/lab.h"

#include <errno.h>
#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define S lab_spec
#define TEXT(n, f)                                                                                                     \
    { n, "Spec", NOC_OPTION_TEXT, offsetof(S, f), 0, 0, NULL, "", "" }
static const noc_option spec_options[] = {
    TEXT("title", title),
    TEXT("note", note),
    TEXT("size", size),
    TEXT("crop", crop),
    { "frames", "Spec", NOC_OPTION_INT, offsetof(S, frames), 1, LAB_FRAMES, NULL, "", "" },
    { "seconds", "Spec", NOC_OPTION_REAL, offsetof(S, seconds), 0, 1e6, NULL, "s", "" },
    { "repetitions", "Spec", NOC_OPTION_INT, offsetof(S, repetitions), 1, 1000, NULL, "", "" },
    { "accumulate", "Spec", NOC_OPTION_CHOICE, offsetof(S, accumulate), 0, 0, "false|true|both", "", "" },
    { "seed", "Spec", NOC_OPTION_UINT, offsetof(S, seed), 0, 4294960000.0, NULL, "", "" },
    { "figure", "Spec", NOC_OPTION_CHOICE, offsetof(S, figure), 0, 0, "relmse-clamped|relmse|rmse8", "", "" },
    { "all-pixels", "Spec", NOC_OPTION_BOOL, offsetof(S, all_pixels), 0, 1, NULL, "", "" },
    { "ceiling", "Spec", NOC_OPTION_REAL, offsetof(S, ceiling), 1e-6, 1e9, NULL, "cd/m2", "" },
    { NULL },
};
static const noc_option *spec_table(void) { return spec_options; }

static const noc_option reference_options[] = {
    { "frames", "Reference", NOC_OPTION_INT, offsetof(S, reference.frames), 1, LAB_FRAMES, NULL, "", "" },
    { NULL },
};
static const noc_option *reference_table(void) { return reference_options; }

/* What the spec says once for all pictures. */
static const char *const by_spec[] = { "width", "height", "accumulate", NULL };

static const cli_set spec_sets[] = { { spec_table, 0, NULL }, { NULL } };
static const cli_set reference_sets[] = { { reference_table, 0, NULL },
                                          { noc_render_options, offsetof(S, reference.params), by_spec },
                                          { NULL } };
static const cli_set scene_sets[] = { { noc_import_options, offsetof(lab_scene, import), NULL },
                                      { noc_city_options, offsetof(lab_scene, builtin.city), NULL },
                                      { noc_builtin_options, offsetof(lab_scene, builtin), NULL },
                                      { NULL } };
static const char *const objects[] = { "scene",          "scenes",     "cameras",  "options", "reference",
                                       "configurations", "equal-time", "measured", "shown",   NULL };
static const char *const scene_others[] = { "name", "inputs", "cameras", NULL };

/* Files are named as seen from the spec's folder. */
static const char *resolve(S *spec, const char *input) {
    const char *slash = strrchr(spec->path, '/');
    if (*input == '/' || !slash || !strncmp(input, "builtin:", 8))
        return lab_keep(spec, cli_format("%s", input));
    return lab_keep(spec, cli_format("%.*s/%s", (int)(slash - spec->path), spec->path, input));
}

static bool is_builtin(const char *name) {
    for (const char *const *n = noc_builtin_names(); *n; n++)
        if (!strcmp(*n, name))
            return true;
    return false;
}

/* A file that is not there is told before the scenes before it have been measured for an hour. */
static int check_inputs(const S *spec, const char *place, json_t *object, const lab_scene *scene) {
    const noc_option *const tables[] = { noc_city_options(), noc_builtin_options() };
    for (size_t k = 0; k < 2; k++)
        for (const noc_option *o = tables[k]; o->name; o++) {
            const char *needed =
                json_object_get(object, o->name) ? noc_option_needs_input(o, scene->inputs, scene->input_count) : NULL;
            if (needed)
                return lab_wrong(spec, place, "%s is for the input %s", o->name, needed);
        }
    for (size_t i = 0; i < scene->input_count; i++) {
        const char *input = scene->inputs[i], *name = cli_builtin(input);
        struct stat st;
        if (name && !is_builtin(name))
            return lab_wrong(spec, place, "%.80s: no such built-in scene", input);
        bool folder = !name && !stat(input, &st) && S_ISDIR(st.st_mode);
        if (name || (!folder && !access(input, R_OK)))
            continue;
        cli_error("%s: %s", input, strerror(folder ? EISDIR : errno));
        return CLI_FAILURE;
    }
    return CLI_OK;
}

static int read_scene(S *spec, const char *place, json_t *object, lab_scene *scene) {
    *scene = (lab_scene){ .import = noc_import_default_params(), .builtin = noc_builtin_default_params() };
    int status = lab_set_all(spec, place, object, scene_sets, scene_others, scene);
    status = status ? status : lab_read_name(spec, place, object, &scene->name);
    if (status)
        return status;
    json_t *inputs = json_object_get(object, "inputs"), *input;
    size_t count = json_array_size(inputs), i;
    noc_texts *lamps = &scene->import.lamps;
    if (!count && !lamps->count)
        return lab_wrong(spec, place, "inputs must be an array of files or builtin:NAME");
    status = lab_too_many(spec, place, count + lamps->count, LAB_INPUTS, "inputs");
    if (status)
        return status;
    scene->inputs = cli_alloc(sizeof(char *) * (count + lamps->count));
    lab_keep(spec, scene->inputs);
    json_array_foreach(inputs, i, input) {
        const char *text = json_string_value(input);
        if (!text || !*text)
            return lab_wrong(spec, place, "inputs must be an array of files or builtin:NAME");
        scene->inputs[scene->input_count++] = resolve(spec, text);
    }
    for (i = 0; i < lamps->count; i++)
        lamps->text[i] = resolve(spec, lamps->text[i]);
    cli_args all = { .inputs = scene->inputs, .input_count = scene->input_count };
    cli_add_lamps(&all, &scene->import);
    for (const noc_option *o = noc_import_options(); o->name && all.given_count < CLI_GIVEN; o++)
        if (json_object_get(object, o->name))
            all.given[all.given_count++] = o;
    cli_note_chosen(&all, &scene->import);
    scene->input_count = all.input_count;
    return check_inputs(spec, place, object, scene);
}

static int check_twice(S *spec, const char *what, const char *const *name, size_t stride, size_t count) {
    for (size_t i = 0; i < count; i++) {
        const char *a = *(const char *const *)((const char *)name + i * stride);
        for (size_t j = 0; j < i; j++)
            if (!strcmp(a, *(const char *const *)((const char *)name + j * stride)))
                return lab_wrong(spec, what, "the name \"%s\" is given twice", a);
    }
    return CLI_OK;
}

static int read_lists(S *spec, json_t *root, const lab_config *shared) {
    json_t *scenes = json_object_get(root, "scenes"), *scene = json_object_get(root, "scene");
    json_t *cameras = json_object_get(root, "cameras"), *configs = json_object_get(root, "configurations");
    if (!scene == !scenes)
        return lab_wrong(spec, "", "it needs one of scene, {...}, and scenes, [{...}, ...]");
    if ((scenes && !json_array_size(scenes)) || !json_array_size(configs))
        return lab_wrong(spec, "", "it needs scenes and configurations, arrays that are not empty");
    size_t scene_count = scenes ? json_array_size(scenes) : 1;
    int status = lab_too_many(spec, "", scene_count, LAB_ENTRIES, "scenes");
    if (status)
        return status;
    spec->scenes = cli_alloc(sizeof(*spec->scenes) * scene_count);
    char place[64];
    for (; !status && spec->scene_count < scene_count; spec->scene_count++) {
        snprintf(place, sizeof(place), scenes ? "scenes[%zu]" : "scene", spec->scene_count);
        json_t *object = scenes ? json_array_get(scenes, spec->scene_count) : scene;
        status = read_scene(spec, place, object, &spec->scenes[spec->scene_count]);
        json_t *own = status ? NULL : json_object_get(object, "cameras");
        status = status ? status : lab_read_cameras(spec, own ? place : "", own ? own : cameras, spec->scene_count);
    }
    for (size_t i = 0; !status && i < json_array_size(configs); i++) {
        snprintf(place, sizeof(place), "configurations[%zu]", i);
        status = lab_read_config(spec, place, json_array_get(configs, i), shared, i);
    }
    status =
        status ? status : check_twice(spec, "scenes", &spec->scenes->name, sizeof(*spec->scenes), spec->scene_count);
    return status
               ? status
               : check_twice(spec, "configurations", &spec->configs->name, sizeof(*spec->configs), spec->config_count);
}

static int read_size(S *spec) {
    double size[2];
    if (!noc_text_numbers(spec->size, 'x', 2, size) || size[0] != floor(size[0]) || size[1] != floor(size[1]) ||
        !(size[0] >= 1 && size[0] <= NOC_IMAGE_MAX_SIDE && size[1] >= 1 && size[1] <= NOC_IMAGE_MAX_SIDE))
        return lab_wrong(spec, "size", "\"%.60s\" is not WIDTHxHEIGHT, 1 to %d px a side", spec->size,
                         NOC_IMAGE_MAX_SIDE);
    spec->width = (int)size[0];
    spec->height = (int)size[1];
    if (!spec->crop)
        return CLI_OK;
    if (!lab_read_box(spec->crop, spec->width, spec->height, spec->crop_box))
        return lab_wrong(spec, "crop", "\"%.60s\" is no [x, y, width, height] inside the picture", spec->crop);
    return CLI_OK;
}

/* Numbers of frames, rising; an array of the spec, or none. */
static int read_frames(S *spec, const char *name, json_t *array, int **frames, size_t *count) {
    size_t i;
    json_t *item;
    if (array && !json_is_array(array))
        return lab_wrong(spec, name, "this must be an array of frames, such as [1, 8, 32]");
    *frames = lab_keep(spec, cli_alloc(sizeof(int) * (json_array_size(array) + 1)));
    json_array_foreach(array, i, item) {
        json_int_t frame = json_integer_value(item);
        if (frame < 1 || frame > LAB_FRAMES || (*count && frame <= (*frames)[*count - 1]))
            return lab_wrong(spec, name, "frames are whole numbers from 1 on, each above the one before it");
        (*frames)[(*count)++] = (int)frame;
    }
    return CLI_OK;
}

static int read_times(S *spec, json_t *times) {
    size_t i;
    json_t *time;
    if (times && !json_is_array(times))
        return lab_wrong(spec, "equal-time", "this must be an array of CPU seconds, such as [1, 3, 10]");
    json_array_foreach(times, i, time) {
        if (i == LAB_TIMES || !json_is_number(time) || !(json_number_value(time) > 0))
            return lab_wrong(spec, "equal-time", "this must be up to %d CPU seconds, each above 0, such as [1, 3, 10]",
                             LAB_TIMES);
        spec->times[spec->time_count++] = json_number_value(time);
    }
    return CLI_OK;
}

/* Frames that no configuration comes to would be columns of nothing. Of cameras with a path they say nothing anyway. */
static int check_frames(const S *spec, const char *name, const int *frames, size_t count) {
    int most = 0;
    for (size_t c = 0; c < spec->camera_count; c++)
        for (size_t i = 0; i < spec->config_count && !spec->cameras[c].frames; i++)
            most = spec->configs[i].frames > most ? spec->configs[i].frames : most;
    return !most || !count || frames[count - 1] <= most
               ? CLI_OK
               : lab_wrong(spec, name, "frame %d is after the last, %d", frames[count - 1], most);
}

static int check_times(const S *spec) {
    size_t resting = 0;
    for (size_t c = 0; c < spec->camera_count; c++)
        resting += !spec->cameras[c].frames;
    return !spec->time_count || resting
               ? CLI_OK
               : lab_wrong(spec, "equal-time",
                           "this needs a camera at rest: of one with a path the last frame alone is measured");
}

static int check_rows(const S *spec) {
    double rows = 0;
    for (size_t c = 0; c < spec->camera_count; c++)
        for (size_t i = 0; i < spec->config_count; i++)
            /* seconds: about so many are measured */
            rows += spec->configs[i].seconds > 0 ? 100 : lab_frames(spec, c, i);
    rows *= 2.0 * spec->repetitions;
    return rows > LAB_ROWS ? lab_wrong(spec, "", "it asks for more than %d rows", LAB_ROWS) : CLI_OK;
}

static int read_root(S *spec, json_t *root) {
    if (!json_is_object(root))
        return lab_wrong(spec, "", "a spec is one object, {...}");
    /* What is judged is light sampling, not the edges of surfaces nor the sky: a spec says otherwise where it means it.
     */
    lab_config shared = { .params = noc_render_default_params() };
    shared.params.sky = 0;
    shared.params.jitter = false;
    int status = lab_set_all(spec, "", root, spec_sets, objects, spec);
    if (!status && spec->seconds > 0 && !json_object_get(root, "frames"))
        spec->frames = LAB_FRAMES;
    if (!status) {
        char *title = lab_keep(spec, spec->title ? cli_format("%s", spec->title) : lab_spec_name(spec->path));
        spec->title = noc_text_clean(title, strlen(title) + 1, title);
    }
    status = status ? status : read_size(spec);
    status = status ? status : read_times(spec, json_object_get(root, "equal-time"));
    status = status ? status
                    : read_frames(spec, "measured", json_object_get(root, "measured"), &spec->measured,
                                  &spec->measured_count);
    status =
        status ? status : read_frames(spec, "shown", json_object_get(root, "shown"), &spec->shown, &spec->shown_count);
    if (!status && !json_object_get(root, "shown"))
        spec->shown[spec->shown_count++] = 1;
    shared.params.width = spec->width;
    shared.params.height = spec->height;
    status = status ? status : lab_read_shared(spec, json_object_get(root, "options"), &shared);
    spec->reference.params = shared.params;
    spec->reference.params.method = NOC_METHOD_REFERENCE;
    spec->reference.params.seed = 4711;
    status = status ? status
                    : lab_set_all(spec, "reference", json_object_get(root, "reference"), reference_sets, NULL, spec);
    status = status ? status : read_lists(spec, root, &shared);
    status = status ? status : check_frames(spec, "measured", spec->measured, spec->measured_count);
    status = status ? status : check_frames(spec, "shown", spec->shown, spec->shown_count);
    status = status ? status : check_times(spec);
    status = status ? status : check_rows(spec);
    if (!status)
        lab_warn_of_idle(spec, root);
    return status;
}

char *lab_spec_name(const char *path) {
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path, *dot = strrchr(name, '.');
    return cli_format("%.*s", dot && dot > name ? (int)(dot - name) : (int)strlen(name), name);
}

int lab_read_spec(S *spec, const char *path, bool quiet) {
    *spec = (S){ .path = path,
                 .quiet = quiet,
                 .size = "480x270",
                 .frames = 20,
                 .repetitions = LAB_REPETITIONS,
                 .accumulate = LAB_MODES,
                 .seed = 1,
                 .ceiling = 10,
                 .reference = { .frames = 16 } };
    json_error_t error;
    FILE *file = cli_open(path);
    if (!file)
        return CLI_FAILURE;
    struct stat st;
    if (fstat(fileno(file), &st) || st.st_size > LAB_BYTES) {
        fclose(file);
        return lab_wrong(spec, "", "it is larger than %d bytes", LAB_BYTES);
    }
    json_t *root = json_loadf(file, JSON_REJECT_DUPLICATES, &error);
    fclose(file);
    if (!root)
        return cli_usage(&cli_experiment, "%.200s:%d:%d: %.*s", path, error.line, error.column, 120, error.text);
    int status = read_root(spec, root);
    json_decref(root);
    return status;
}

void lab_free_spec(S *spec) {
    for (size_t i = 0; i < spec->kept_count; i++)
        free(spec->kept[i]);
    free(spec->kept);
    free(spec->scenes);
    free(spec->cameras);
    free(spec->configs);
}
