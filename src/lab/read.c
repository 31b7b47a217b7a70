/* The spec of an experiment: JSON to structs. All that can be wrong with it is found here, before the long work. */
#include "lab/cameras.h"
#include "lab/config.h"
#include "lab/file.h"

#include <errno.h>
#include <math.h>
#include <sys/stat.h>
#include <unistd.h>

#define S lab_spec
#define TEXT(n, f)                                                                                                     \
    { n, "Spec", NOC_OPTION_TEXT, offsetof(S, f), 0, 0, NULL, "", "" }
static const noc_option spec_rows[] = {
    TEXT("title", title),
    TEXT("note", note),
    TEXT("size", size),
    TEXT("crop", crop),
    { "frames", "Spec", NOC_OPTION_INT, offsetof(S, frames), 1, LAB_FRAMES, NULL, "", "" },
    { "seconds", "Spec", NOC_OPTION_REAL, offsetof(S, seconds), 0, 1e6, NULL, "s", "" },
    { "repetitions", "Spec", NOC_OPTION_INT, offsetof(S, repetitions), 1, 1000, NULL, "", "" },
    { "accumulate", "Spec", NOC_OPTION_CHOICE, offsetof(S, accumulate), 0, 0, "false|true|both", "", "" },
    { "seed", "Spec", NOC_OPTION_UINT, offsetof(S, seed), 0, 4294960000.0, NULL, "", "" },
    { "light-view", "Spec", NOC_OPTION_BOOL, offsetof(S, light_view), 0, 1, NULL, "", "" },
    { "figure", "Spec", NOC_OPTION_CHOICE, offsetof(S, figure), 0, 0, "relmse-clamped|relmse|rmse8", "", "" },
    { "all-pixels", "Spec", NOC_OPTION_BOOL, offsetof(S, all_pixels), 0, 1, NULL, "", "" },
    { "ceiling", "Spec", NOC_OPTION_REAL, offsetof(S, ceiling), 1e-6, 1e9, NULL, "cd/m2", "" },
    { NULL },
};
static const noc_option *spec_table(void) { return spec_rows; }

static const noc_option reference_rows[] = {
    { "frames", "Reference", NOC_OPTION_INT, offsetof(S, reference.frames), 1, LAB_FRAMES, NULL, "", "" },
    { NULL },
};
static const noc_option *reference_table(void) { return reference_rows; }

/* What the spec says once for all pictures. */
static const char *const by_spec[] = { "width", "height", "accumulate", NULL };

static const lab_options spec_options[] = { { spec_table, 0, NULL },
                                            { noc_device_options, offsetof(S, device), NULL },
                                            { NULL } };
static const lab_options reference_options[] = { { reference_table, 0, NULL },
                                                 { noc_render_options, offsetof(S, reference.params), by_spec },
                                                 { NULL } };
static const noc_option scene_rows[] = {
    { "optional", "Scene", NOC_OPTION_BOOL, offsetof(lab_scene, optional), 0, 1, NULL, "", "" },
    { NULL },
};
static const noc_option *scene_table(void) { return scene_rows; }

static const lab_options scene_options[] = { { scene_table, 0, NULL },
                                             { noc_import_options, offsetof(lab_scene, import), NULL },
                                             { noc_city_options, offsetof(lab_scene, builtin.city), NULL },
                                             { noc_builtin_options, offsetof(lab_scene, builtin), NULL },
                                             { NULL } };
static const char *const objects[] = { "scene",          "scenes",     "cameras",  "options", "reference",
                                       "configurations", "equal-time", "measured", "shown",   NULL };
static const char *const scene_others[] = { "name", "inputs", "cameras", NULL };

#define BUILTIN "builtin:"

/* Files are named as seen from the spec's folder. NULL where memory is refused. */
static const char *resolve(S *spec, const char *input) {
    const char *slash = strrchr(spec->path, '/');
    if (*input == '/' || !slash || !strncmp(input, BUILTIN, strlen(BUILTIN)))
        return arena_strdup(&spec->arena, input);
    return arena_format(&spec->arena, "%.*s/%s", (int)(slash - spec->path), spec->path, input);
}

static bool is_builtin(const char *name) {
    for (const char *const *n = noc_builtin_names(); *n; n++)
        if (!strcmp(*n, name))
            return true;
    return false;
}

/* A file that is not there is told before the scenes before it have been measured for an hour. */
static noc_status check_input(const S *spec, const char *place, const char *input) {
    struct stat st;
    bool builtin = !strncmp(input, BUILTIN, strlen(BUILTIN));
    if (builtin && !is_builtin(input + strlen(BUILTIN)))
        return lab_wrong(spec, place, "%.80s: no such built-in scene", input);
    bool folder = !builtin && !stat(input, &st) && S_ISDIR(st.st_mode);
    if (builtin || (!folder && !access(input, R_OK)))
        return NOC_OK;
    errno = folder ? EISDIR : errno;
    return lab_io_error(spec->log, input);
}

/* Returns the i-th of all files that the scene names: inputs, lamps, tracks, environment. NULL: there are no more. */
static const char *file_of(const lab_scene *scene, size_t i) {
    const noc_import_params *import = &scene->import;
    if (i < scene->input_count)
        return scene->inputs[i];
    i -= scene->input_count;
    if (i < import->lamps.count)
        return import->lamps.text[i];
    i -= import->lamps.count;
    if (i < import->tracks.count)
        return import->tracks.text[i];
    return i == import->tracks.count ? import->environment : NULL;
}

/* Returns the first file of an optional scene that does not exist. NULL: the scene is not left out. */
static const char *absent_file(const lab_scene *scene) {
    const char *file;
    for (size_t i = 0; scene->optional && (file = file_of(scene, i)); i++)
        if (strncmp(file, BUILTIN, strlen(BUILTIN)) && access(file, F_OK) && (errno == ENOENT || errno == ENOTDIR))
            return file;
    return NULL;
}

static noc_status check_inputs(const S *spec, const char *place, json_t *object, const lab_scene *scene) {
    const noc_option *const tables[] = { noc_city_options(), noc_builtin_options() };
    for (size_t k = 0; k < 2; k++)
        for (const noc_option *o = tables[k]; o->name; o++) {
            const char *needed =
                json_object_get(object, o->name) ? noc_option_needs_input(o, scene->inputs, scene->input_count) : NULL;
            if (needed)
                return lab_wrong(spec, place, "%s is for the input %s", o->name, needed);
        }
    noc_status status = NOC_OK;
    const char *file;
    for (size_t i = 0; !status && (file = file_of(scene, i)); i++)
        status = check_input(spec, place, file);
    return status;
}

/* Which defaults of lamps the spec has said, for strict. */
static void note_chosen(json_t *object, lab_scene *scene) {
    static const char *const names[NOC_LAMP_DEFAULT_COUNT] = {
        [NOC_LAMP_HEIGHT] = "lamp-height", [NOC_LAMP_FLUX] = "lamp-lumens", [NOC_LAMP_COLOUR] = "lamp-kelvin"
    };
    for (int i = 0; i < NOC_LAMP_DEFAULT_COUNT && names[i]; i++) {
        const noc_option *o;
        bool said = json_object_get(object, names[i]) != NULL;
        for (size_t k = 0; (o = noc_recipe_option(scene->recipe, k)); k++)
            said = said || !strcmp(o->name, names[i]);
        scene->import.lamp_chosen |= said ? 1u << i : 0;
    }
}

/* A recipe's inputs stand in its place. What it says of reading holds where the scene says nothing else; of pictures
 * the spec says all. */
static noc_status take_recipe(S *spec, const char *place, const char *path, size_t others, lab_scene *scene) {
    if (scene->recipe)
        return lab_wrong(spec, place, "%.80s is a second recipe; one makes a city", path);
    noc_status status = noc_recipe_load(path, spec->log, &scene->recipe);
    const noc_recipe_info *info = noc_recipe_get_info(scene->recipe);
    status = status ? status : lab_too_many(spec, place, scene->input_count + info->input_count, LAB_INPUTS, "inputs");
    const char **inputs = arena_alloc(&spec->arena, sizeof(char *) * (info->input_count + others + 1));
    if (inputs && scene->input_count)
        memcpy(inputs, scene->inputs, sizeof(char *) * scene->input_count);
    scene->inputs = inputs ? inputs : scene->inputs;
    for (size_t i = 0; inputs && i < info->input_count && !status; i++)
        scene->inputs[scene->input_count++] = info->inputs[i];
    noc_recipe_lists(scene->recipe, &scene->import);
    return status;
}

static noc_status use_recipe(S *spec, json_t *object, lab_scene *scene) {
    const noc_option *option;
    noc_status status = NOC_OK;
    for (size_t i = 0; !status && (option = noc_recipe_option(scene->recipe, i)); i++)
        for (const lab_options *set = scene_options; set->table && !status; set++)
            for (const noc_option *o = set->table(); o->name && !status; o++)
                if (o == option && !json_object_get(object, o->name))
                    status = noc_recipe_set(scene->recipe, o, (char *)scene + set->offset, spec->log);
    return status;
}

static noc_status read_inputs(S *spec, const char *place, json_t *inputs, lab_scene *scene) {
    size_t i;
    json_t *input;
    noc_texts *lamps = &scene->import.lamps, *tracks = &scene->import.tracks;
    if (!json_array_size(inputs) && !lamps->count)
        return lab_wrong(spec, place, "inputs must be an array of files or builtin:NAME");
    noc_status status = lab_too_many(spec, place, json_array_size(inputs) + lamps->count, LAB_INPUTS, "inputs");
    if (status)
        return status;
    scene->inputs = arena_alloc(&spec->arena, sizeof(char *) * (json_array_size(inputs) + 1));
    json_array_foreach(inputs, i, input) {
        const char *text = json_string_value(input);
        if (!text || !*text)
            return lab_wrong(spec, place, "inputs must be an array of files or builtin:NAME");
        const char *path = scene->inputs ? resolve(spec, text) : NULL;
        if (path && noc_recipe_is(path))
            status = take_recipe(spec, place, path, json_array_size(inputs), scene);
        else if (path)
            scene->inputs[scene->input_count++] = path;
        if (status)
            return status;
    }
    for (i = 0; i < lamps->count; i++)
        lamps->text[i] = resolve(spec, lamps->text[i]);
    for (i = 0; i < tracks->count; i++)
        tracks->text[i] = resolve(spec, tracks->text[i]);
    if (scene->import.environment)
        scene->import.environment = resolve(spec, scene->import.environment);
    return spec->arena.refused ? lab_spec_no_memory(spec) : NOC_OK;
}

static noc_status read_scene(S *spec, const char *place, json_t *object, lab_scene *scene) {
    *scene = (lab_scene){ .import = noc_import_default_params(), .builtin = noc_builtin_default_params() };
    noc_status status = lab_set_all(spec, place, object, scene_options, scene_others, scene);
    status = status ? status : lab_read_name(spec, place, object, &scene->name);
    status = status ? status : read_inputs(spec, place, json_object_get(object, "inputs"), scene);
    if (status)
        return status;
    status = use_recipe(spec, object, scene);
    if (status)
        return status;
    note_chosen(object, scene);
    return absent_file(scene) ? NOC_OK : check_inputs(spec, place, object, scene);
}

static noc_status check_twice(S *spec, const char *what, const char *const *name, size_t stride, size_t count) {
    for (size_t i = 0; i < count; i++) {
        const char *a = *(const char *const *)((const char *)name + i * stride);
        for (size_t j = 0; j < i; j++)
            if (!strcmp(a, *(const char *const *)((const char *)name + j * stride)))
                return lab_wrong(spec, what, "the name \"%s\" is given twice", a);
    }
    return NOC_OK;
}

/* The next of the spec's scenes. One that is left out gives its slot back. */
static noc_status add_scene(S *spec, const char *place, json_t *object, json_t *cameras) {
    lab_scene *scene = &spec->scenes[spec->scene_count++];
    noc_status status = read_scene(spec, place, object, scene);
    const char *absent = status ? NULL : absent_file(scene);
    if (absent) {
        noc_warn(spec->log, "%.200s: %s: \"%s\" is left out: %s: %s", spec->path, place, scene->name, absent,
                 strerror(ENOENT));
        spec->absent[spec->absent_count++] = (lab_absent){ scene->name, arena_strdup(&spec->arena, absent) };
        noc_recipe_destroy(scene->recipe);
        spec->scene_count--;
        return spec->arena.refused ? lab_spec_no_memory(spec) : NOC_OK;
    }
    json_t *own = status ? NULL : json_object_get(object, "cameras");
    return status ? status : lab_read_cameras(spec, own ? place : "", own ? own : cameras, spec->scene_count - 1);
}

/* scenes: the array; NULL: `scene` is the only one. */
static noc_status read_scenes(S *spec, json_t *scene, json_t *scenes, json_t *cameras) {
    size_t count = scenes ? json_array_size(scenes) : 1;
    noc_status status = lab_too_many(spec, "", count, LAB_ENTRIES, "scenes");
    if (status)
        return status;
    spec->scenes = noc_calloc(count, sizeof(*spec->scenes));
    spec->absent = noc_calloc(count, sizeof(*spec->absent));
    if (!spec->scenes || !spec->absent)
        return lab_spec_no_memory(spec);
    char place[64];
    for (size_t i = 0; !status && i < count; i++) {
        noc_snprintf(place, sizeof(place), scenes ? "scenes[%zu]" : "scene", i);
        status = add_scene(spec, place, scenes ? json_array_get(scenes, i) : scene, cameras);
    }
    if (!status && !spec->scene_count)
        return noc_error(spec->log, NOC_ERR_IO, "%.200s: inputs of all its scenes are absent", spec->path);
    return status;
}

static noc_status read_lists(S *spec, json_t *root, const lab_config *shared) {
    json_t *scenes = json_object_get(root, "scenes"), *scene = json_object_get(root, "scene");
    json_t *cameras = json_object_get(root, "cameras"), *configs = json_object_get(root, "configurations");
    if (!scene == !scenes)
        return lab_wrong(spec, "", "it needs one of scene, {...}, and scenes, [{...}, ...]");
    if ((scenes && !json_array_size(scenes)) || !json_array_size(configs))
        return lab_wrong(spec, "", "it needs scenes and configurations, arrays that are not empty");
    noc_status status = read_scenes(spec, scene, scenes, cameras);
    char place[64];
    for (size_t i = 0; !status && i < json_array_size(configs); i++) {
        noc_snprintf(place, sizeof(place), "configurations[%zu]", i);
        status = lab_read_config(spec, place, json_array_get(configs, i), shared, i);
    }
    status =
        status ? status : check_twice(spec, "scenes", &spec->scenes->name, sizeof(*spec->scenes), spec->scene_count);
    return status
               ? status
               : check_twice(spec, "configurations", &spec->configs->name, sizeof(*spec->configs), spec->config_count);
}

static noc_status read_size(S *spec) {
    double size[2];
    if (!noc_text_numbers(spec->size, 'x', 2, size) || size[0] != floor(size[0]) || size[1] != floor(size[1]) ||
        !(size[0] >= 1 && size[0] <= NOC_IMAGE_MAX_SIDE && size[1] >= 1 && size[1] <= NOC_IMAGE_MAX_SIDE))
        return lab_wrong(spec, "size", "\"%.60s\" is not WIDTHxHEIGHT, 1 to %d px a side", spec->size,
                         NOC_IMAGE_MAX_SIDE);
    spec->width = (int)size[0];
    spec->height = (int)size[1];
    if (!spec->crop)
        return NOC_OK;
    if (!lab_read_box(spec->crop, spec->width, spec->height, spec->crop_box))
        return lab_wrong(spec, "crop", "\"%.60s\" is no [x, y, width, height] inside the picture", spec->crop);
    return NOC_OK;
}

/* Numbers of frames, rising; an array of the spec, or none. */
static noc_status read_frames(S *spec, const char *name, json_t *array, int **frames, size_t *count) {
    size_t i;
    json_t *item;
    if (array && !json_is_array(array))
        return lab_wrong(spec, name, "this must be an array of frames, such as [1, 8, 32]");
    *frames = arena_alloc(&spec->arena, sizeof(int) * (json_array_size(array) + 1));
    if (!*frames)
        return lab_spec_no_memory(spec);
    json_array_foreach(array, i, item) {
        json_int_t frame = json_integer_value(item);
        if (frame < 1 || frame > LAB_FRAMES || (*count && frame <= (*frames)[*count - 1]))
            return lab_wrong(spec, name, "frames are whole numbers from 1 on, each above the one before it");
        (*frames)[(*count)++] = (int)frame;
    }
    return NOC_OK;
}

static noc_status read_times(S *spec, json_t *times) {
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
    return NOC_OK;
}

/* Frames that no configuration comes to would be columns of nothing. Of cameras with a path they say nothing anyway. */
static noc_status check_frames(const S *spec, const char *name, const int *frames, size_t count) {
    int most = 0;
    for (size_t c = 0; c < spec->camera_count; c++)
        for (size_t i = 0; i < spec->config_count && !spec->cameras[c].frames; i++)
            most = spec->configs[i].frames > most ? spec->configs[i].frames : most;
    return !most || !count || frames[count - 1] <= most
               ? NOC_OK
               : lab_wrong(spec, name, "frame %d is after the last, %d", frames[count - 1], most);
}

static noc_status check_times(const S *spec) {
    size_t resting = 0;
    for (size_t c = 0; c < spec->camera_count; c++)
        resting += !spec->cameras[c].frames;
    return !spec->time_count || resting
               ? NOC_OK
               : lab_wrong(spec, "equal-time",
                           "this needs a camera at rest: of one with a path the last frame alone is measured");
}

static noc_status check_rows(const S *spec) {
    double rows = 0;
    for (size_t c = 0; c < spec->camera_count; c++)
        for (size_t i = 0; i < spec->config_count; i++)
            /* seconds: about so many are measured */
            rows += spec->configs[i].seconds > 0 ? 100 : lab_frames(spec, c, i);
    rows *= 2.0 * spec->repetitions;
    return rows > LAB_ROWS ? lab_wrong(spec, "", "it asks for more than %d rows", LAB_ROWS) : NOC_OK;
}

static noc_status read_title(S *spec) {
    char *title = arena_strdup(&spec->arena, spec->title ? spec->title : spec->name);
    if (!title)
        return lab_spec_no_memory(spec);
    spec->title = noc_text_clean(title, strlen(title) + 1, title);
    return NOC_OK;
}

static noc_status read_root(S *spec, json_t *root) {
    if (!json_is_object(root))
        return lab_wrong(spec, "", "a spec is one object, {...}");
    /* What is judged is light sampling, not the edges of surfaces nor the sky: a spec says otherwise where it means it.
     */
    lab_config shared = { .params = noc_lab_render_params(1, 1) };
    noc_status status = lab_set_all(spec, "", root, spec_options, objects, spec);
    if (!status && spec->seconds > 0 && !json_object_get(root, "frames"))
        spec->frames = LAB_FRAMES;
    if (!status)
        status = read_title(spec);
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
                    : lab_set_all(spec, "reference", json_object_get(root, "reference"), reference_options, NULL, spec);
    status = status ? status : read_lists(spec, root, &shared);
    status = status ? status : check_frames(spec, "measured", spec->measured, spec->measured_count);
    status = status ? status : check_frames(spec, "shown", spec->shown, spec->shown_count);
    status = status ? status : check_times(spec);
    status = status ? status : check_rows(spec);
    if (!status)
        lab_warn_of_idle(spec, root);
    return status;
}

/* "a/methods.json" is "methods" */
static void read_own_name(S *spec, const char *path) {
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path, *dot = strrchr(name, '.');
    spec->path = arena_strdup(&spec->arena, path);
    spec->name = arena_strndup(&spec->arena, name, dot && dot > name ? (size_t)(dot - name) : strlen(name));
}

static noc_status parse(S *spec, const char *text, size_t size) {
    /* jansson 2.14 reads beyond a text that could not grow. What the values of a spec can take is looked for before,
     * and is there a moment later. */
    void *room = noc_alloc(64 * size + LAB_BYTES);
    free(room);
    if (!room)
        return lab_spec_no_memory(spec);
    json_error_t error;
    json_t *root = json_loadb(text, size, JSON_REJECT_DUPLICATES, &error);
    if (!root)
        return noc_error(spec->log, NOC_ERR_FORMAT, "%.200s:%d:%d: %.*s", spec->path, error.line, error.column, 120,
                         error.text);
    noc_status status = read_root(spec, root);
    json_decref(root);
    return status;
}

static noc_status read_text(const char *text, size_t size, const char *path, noc_lab_spec **out, noc_log *log) {
    S *spec = noc_calloc(1, sizeof(*spec));
    if (!spec)
        return noc_no_memory(log, path);
    *spec = (S){ .log = log,
                 .size = "480x270",
                 .frames = 20,
                 .repetitions = LAB_REPETITIONS,
                 .device.backend = NOC_BACKEND_AUTO,
                 .accumulate = LAB_MODES,
                 .seed = 1,
                 .ceiling = 10,
                 .reference = { .frames = 16 } };
    read_own_name(spec, path);
    noc_status status = spec->arena.refused ? noc_no_memory(log, path)
                        : size > LAB_BYTES  ? lab_wrong(spec, "", "it is larger than %d bytes", LAB_BYTES)
                                            : parse(spec, text, size);
    spec->log = NULL;
    if (status)
        noc_lab_spec_destroy(spec);
    else
        *out = spec;
    return status;
}

noc_status noc_lab_spec_parse(const char *text, const char *path, noc_lab_spec **spec, noc_log *log) {
    if (!text || !path || !spec)
        return noc_null(log, "noc_lab_spec_parse");
    *spec = NULL;
    return read_text(text, strlen(text), path, spec, log);
}

noc_status noc_lab_spec_read(const char *path, noc_lab_spec **spec, noc_log *log) {
    if (!path || !spec)
        return noc_null(log, "noc_lab_spec_read");
    *spec = NULL;
    FILE *file = lab_open_file(path, log);
    if (!file)
        return NOC_ERR_IO;
    char *text = noc_alloc(LAB_BYTES + 1); /* one more than a spec may have */
    size_t size = text ? fread(text, 1, LAB_BYTES + 1, file) : 0;
    noc_status status = !text ? noc_no_memory(log, path) : ferror(file) ? lab_io_error(log, path) : NOC_OK;
    fclose(file);
    status = status ? status : read_text(text, size, path, spec, log);
    free(text);
    return status;
}
