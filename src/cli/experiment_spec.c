/* The spec of an experiment: JSON to structs. All that can be wrong with it is found here, before the long work. */
#include "experiment.h"

#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define S experiment_spec
#define TEXT(n, f) { n, "Spec", NOC_OPTION_TEXT, offsetof(S, f), 0, 0, NULL, "", "" }
static const noc_option spec_options[] = {
    TEXT("title", title), TEXT("note", note), TEXT("size", size), TEXT("crop", crop),
    { "frames", "Spec", NOC_OPTION_INT, offsetof(S, frames), 1, 100000, NULL, "", "" },
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
    { "frames", "Reference", NOC_OPTION_INT, offsetof(S, reference.frames), 1, 100000, NULL, "", "" },
    { NULL },
};
static const noc_option *reference_table(void) { return reference_options; }

static const noc_option config_options[] = {
    { "frames", "Configuration", NOC_OPTION_INT, offsetof(experiment_config, frames), 1, 100000, NULL, "", "" },
    { NULL },
};
static const noc_option *config_table(void) { return config_options; }

/* Of render's own options, those that place a camera. */
static const noc_option *camera_table(void) {
    static noc_option rows[6];
    static const char *const names[] = { "view", "eye", "target", "camera-crs", "fov" };
    size_t offset;
    for (size_t i = 0; i < 5; i++)
        rows[i] = *experiment_option(cli_render.sets, names[i], &offset);
    return rows;
}

/* What the spec says once for all configurations. */
static const char *const said_above[] = { "width", "height", "seed", "accumulate", NULL };
static const char *const by_spec[] = { "width", "height", "accumulate", NULL };

static const cli_set spec_sets[] = { { spec_table, 0, NULL }, { NULL } };
static const cli_set shared_sets[] = { { noc_render_options, 0, said_above }, { NULL } };
static const cli_set reference_sets[] = {
    { reference_table, 0, NULL }, { noc_render_options, offsetof(S, reference.params), by_spec }, { NULL }
};
static const cli_set scene_sets[] = {
    { noc_import_options, offsetof(experiment_scene, import), NULL },
    { noc_city_options, offsetof(experiment_scene, builtin.city), NULL },
    { noc_builtin_options, offsetof(experiment_scene, builtin), NULL },
    { NULL }
};
static const cli_set camera_sets[] = { { camera_table, offsetof(experiment_camera, args), NULL }, { NULL } };
static const cli_set config_sets[] = {
    { config_table, 0, NULL }, { noc_render_options, offsetof(experiment_config, params), said_above }, { NULL }
};
static const char *const objects[] = { "scene", "scenes", "cameras", "options", "reference", "configurations", "equal-time", NULL };
static const char *const scene_others[] = { "name", "inputs", NULL }, *const named[] = { "name", NULL };

/* All members of an object. */
static int set_all(S *spec, const char *place, json_t *object, const cli_set *sets, const char *const *others, void *params) {
    if (!object)
        return CLI_OK;
    if (!json_is_object(object))
        return experiment_wrong(spec, place, "this must be an object, {...}");
    const char *name;
    json_t *value;
    json_object_foreach(object, name, value) {
        int status = experiment_set(spec, place, sets, others, params, name, value);
        if (status)
            return status;
    }
    return CLI_OK;
}

static int read_name(S *spec, const char *place, json_t *object, const char **name) {
    const char *text = json_string_value(json_object_get(object, "name"));
    if (!text || !*text)
        return experiment_wrong(spec, place, "it needs a name");
    if (strlen(text) > 80)
        return experiment_wrong(spec, place, "its name is longer than 80 bytes");
    for (const char *c = text; *c; c++)
        if ((unsigned char)*c < 32 || *c == 127)
            return experiment_wrong(spec, place, "its name holds a control character");
    *name = experiment_keep(spec, cli_format("%s", text));
    return CLI_OK;
}

/* Files are named as seen from the spec's folder. */
static const char *resolve(S *spec, const char *input) {
    const char *slash = strrchr(spec->path, '/');
    if (*input == '/' || !slash || !strncmp(input, "builtin:", 8))
        return experiment_keep(spec, cli_format("%s", input));
    return experiment_keep(spec, cli_format("%.*s/%s", (int)(slash - spec->path), spec->path, input));
}

static int read_scene(S *spec, const char *place, json_t *object, experiment_scene *scene) {
    *scene = (experiment_scene){ .import = noc_import_default_params(), .builtin = noc_builtin_default_params() };
    int status = set_all(spec, place, object, scene_sets, scene_others, scene);
    status = status ? status : read_name(spec, place, object, &scene->name);
    if (status)
        return status;
    json_t *inputs = json_object_get(object, "inputs"), *input;
    size_t count = json_array_size(inputs), i;
    if (!count)
        return experiment_wrong(spec, place, "inputs must be an array of files or builtin:NAME");
    scene->inputs = cli_alloc(sizeof(char *) * count);
    experiment_keep(spec, (char *)scene->inputs);
    json_array_foreach(inputs, i, input) {
        const char *text = json_string_value(input);
        if (!text || !*text)
            return experiment_wrong(spec, place, "inputs must be an array of files or builtin:NAME");
        scene->inputs[scene->input_count++] = resolve(spec, text);
    }
    const noc_option *const tables[] = { noc_city_options(), noc_builtin_options() };
    for (size_t k = 0; k < 2; k++)
        for (const noc_option *o = tables[k]; o->name; o++) {
            const char *needed = json_object_get(object, o->name) ? cli_builtin_needed(o, scene->inputs, scene->input_count) : NULL;
            if (needed)
                return experiment_wrong(spec, place, "%s is for the input %s", o->name, needed);
        }
    return CLI_OK;
}

static int read_camera(S *spec, const char *place, json_t *object, experiment_camera *camera) {
    render_args *args = &camera->args;
    *args = *(const render_args *)cli_render.defaults;
    int status = set_all(spec, place, object, camera_sets, named, camera);
    status = status ? status : read_name(spec, place, object, &camera->name);
    if (status)
        return status;
    if (!args->eye != !args->target)
        return experiment_wrong(spec, place, "eye and target come together");
    if (args->eye && json_object_get(object, "view"))
        return experiment_wrong(spec, place, "view and eye exclude each other");
    if (args->camera_crs && !args->eye)
        return experiment_wrong(spec, place, "camera-crs is for eye and target");
    if (args->eye && (!cli_parse_numbers(args->eye, ',', 3, camera->eye) || !cli_parse_numbers(args->target, ',', 3, camera->target)))
        return experiment_wrong(spec, place, "eye and target are three numbers each, [x, y, z]");
    if (args->eye && !memcmp(camera->eye, camera->target, sizeof(camera->eye)))
        return experiment_wrong(spec, place, "eye and target are the same place");
    size_t offset;
    if (json_object_get(object, "fov"))
        args->common.given[args->common.given_count++] = experiment_option(cli_render.sets, "fov", &offset);
    return CLI_OK;
}

/* The option of a configuration that stands for several of its choices: "*" for all, or an array of them. *status where more
 * than one does. */
static const noc_option *starred(S *spec, const char *place, json_t *object, int *status) {
    const noc_option *found = NULL;
    const char *name;
    json_t *value;
    json_object_foreach(object, name, value) {
        size_t offset;
        const noc_option *o = experiment_option(config_sets, name, &offset);
        bool star = json_is_string(value) && !strcmp(json_string_value(value), "*");
        if (!o || o->kind != NOC_OPTION_CHOICE || !(star || json_array_size(value)))
            continue;
        if (found)
            *status = experiment_wrong(spec, place, "one option may have several choices, not two");
        found = o;
    }
    return found;
}

/* The choices meant by a value of starred: a new array. */
static json_t *choices_of(const noc_option *option, json_t *value) {
    if (json_is_array(value))
        return json_incref(value);
    json_t *all = json_array();
    for (const char *c = option->choices; *c;) {
        size_t length = strcspn(c, "|");
        json_array_append_new(all, json_stringn(c, length));
        c += length + (c[length] == '|');
    }
    return all;
}

/* "ris, *" and lists -> "ris, lists" */
static char *star_name(const char *name, const char *choice) {
    const char *star = strchr(name, '*');
    return star ? cli_format("%.*s%s%s", (int)(star - name), name, choice, star + 1) : cli_format("%s, %s", name, choice);
}

static experiment_config *add_config(S *spec, const noc_render_params *shared, size_t entry, int choice) {
    spec->configs = realloc(spec->configs, sizeof(experiment_config) * (spec->config_count + 1));
    if (!spec->configs) {
        cli_error("out of memory");
        exit(CLI_FAILURE);
    }
    experiment_config *config = &spec->configs[spec->config_count++];
    *config = (experiment_config){ .params = *shared, .frames = spec->frames, .entry = (int)entry, .choice = choice };
    return config;
}

static int read_config(S *spec, const char *place, json_t *object, const noc_render_params *shared, size_t entry) {
    int status = CLI_OK;
    const char *name = NULL;
    const noc_option *star = json_is_object(object) ? starred(spec, place, object, &status) : NULL;
    if (status || !star) {
        experiment_config *config = status ? NULL : add_config(spec, shared, entry, -1);
        status = status ? status : set_all(spec, place, object, config_sets, named, config);
        return status ? status : read_name(spec, place, object, &config->name);
    }
    status = read_name(spec, place, object, &name);
    json_t *choices = choices_of(star, json_object_get(object, star->name)), *choice;
    size_t i;
    json_array_foreach(choices, i, choice) {
        if (status)
            break;
        experiment_config *config = add_config(spec, shared, entry, (int)i);
        const char *text = json_string_value(choice);
        config->name = experiment_keep(spec, star_name(name, text ? text : ""));
        json_object_set(object, star->name, choice);
        status = set_all(spec, place, object, config_sets, named, config);
    }
    json_decref(choices);
    return status;
}

static int check_twice(S *spec, const char *what, const char *const *name, size_t stride, size_t count) {
    for (size_t i = 0; i < count; i++) {
        const char *a = *(const char *const *)((const char *)name + i * stride);
        for (size_t j = 0; j < i; j++)
            if (!strcmp(a, *(const char *const *)((const char *)name + j * stride)))
                return experiment_wrong(spec, what, "the name \"%s\" is given twice", a);
    }
    return CLI_OK;
}

static int read_lists(S *spec, json_t *root, const noc_render_params *shared) {
    json_t *scenes = json_object_get(root, "scenes"), *scene = json_object_get(root, "scene");
    json_t *cameras = json_object_get(root, "cameras"), *configs = json_object_get(root, "configurations");
    if (!scene == !scenes)
        return experiment_wrong(spec, "", "it needs one of scene, {...}, and scenes, [{...}, ...]");
    if ((scenes && !json_array_size(scenes)) || !json_array_size(cameras) || !json_array_size(configs))
        return experiment_wrong(spec, "", "it needs scenes, cameras and configurations, arrays that are not empty");
    size_t scene_count = scenes ? json_array_size(scenes) : 1, camera_count = json_array_size(cameras);
    spec->scenes = cli_alloc(sizeof(*spec->scenes) * scene_count);
    spec->cameras = cli_alloc(sizeof(*spec->cameras) * camera_count);
    int status = CLI_OK;
    char place[64];
    for (; !status && spec->scene_count < scene_count; spec->scene_count++) {
        snprintf(place, sizeof(place), scenes ? "scenes[%zu]" : "scene", spec->scene_count);
        status = read_scene(spec, place, scenes ? json_array_get(scenes, spec->scene_count) : scene, &spec->scenes[spec->scene_count]);
    }
    for (; !status && spec->camera_count < camera_count; spec->camera_count++) {
        snprintf(place, sizeof(place), "cameras[%zu]", spec->camera_count);
        status = read_camera(spec, place, json_array_get(cameras, spec->camera_count), &spec->cameras[spec->camera_count]);
    }
    for (size_t i = 0; !status && i < json_array_size(configs); i++) {
        snprintf(place, sizeof(place), "configurations[%zu]", i);
        status = read_config(spec, place, json_array_get(configs, i), shared, i);
    }
    status = status ? status : check_twice(spec, "scenes", &spec->scenes->name, sizeof(*spec->scenes), spec->scene_count);
    status = status ? status : check_twice(spec, "cameras", &spec->cameras->name, sizeof(*spec->cameras), spec->camera_count);
    return status ? status : check_twice(spec, "configurations", &spec->configs->name, sizeof(*spec->configs), spec->config_count);
}

static int read_size(S *spec) {
    double size[2], crop[4];
    if (!cli_parse_numbers(spec->size, 'x', 2, size) || size[0] != floor(size[0]) || size[1] != floor(size[1]) ||
        !(size[0] >= 1 && size[0] <= NOC_IMAGE_MAX_SIDE && size[1] >= 1 && size[1] <= NOC_IMAGE_MAX_SIDE))
        return experiment_wrong(spec, "size", "\"%.60s\" is not WIDTHxHEIGHT, 1 to %d px a side", spec->size, NOC_IMAGE_MAX_SIDE);
    spec->width = (int)size[0];
    spec->height = (int)size[1];
    if (!spec->crop)
        return CLI_OK;
    bool right = cli_parse_numbers(spec->crop, ',', 4, crop);
    for (int i = 0; right && i < 4; i++)
        right = crop[i] == floor(crop[i]) && crop[i] >= (i > 1) && crop[i] <= NOC_IMAGE_MAX_SIDE;
    if (!right || crop[0] + crop[2] > size[0] || crop[1] + crop[3] > size[1])
        return experiment_wrong(spec, "crop", "\"%.60s\" is no [x, y, width, height] inside the picture", spec->crop);
    for (int i = 0; i < 4; i++)
        spec->crop_box[i] = (int)crop[i];
    return CLI_OK;
}

static int read_times(S *spec, json_t *times) {
    size_t i;
    json_t *time;
    if (times && !json_is_array(times))
        return experiment_wrong(spec, "equal-time", "this must be an array of CPU seconds");
    json_array_foreach(times, i, time) {
        if (i == EXPERIMENT_TIMES || !json_is_number(time) || !(json_number_value(time) > 0))
            return experiment_wrong(spec, "equal-time", "up to %d CPU seconds, each above 0", EXPERIMENT_TIMES);
        spec->times[spec->time_count++] = json_number_value(time);
    }
    return CLI_OK;
}

static int read_root(S *spec, json_t *root) {
    if (!json_is_object(root))
        return experiment_wrong(spec, "", "a spec is one object, {...}");
    /* What is judged is light sampling, not the edges of surfaces nor the sky: a spec says otherwise where it means it. */
    noc_render_params shared = noc_render_default_params();
    shared.sky = 0;
    shared.jitter = false;
    int status = set_all(spec, "", root, spec_sets, objects, spec);
    status = status ? status : read_size(spec);
    status = status ? status : read_times(spec, json_object_get(root, "equal-time"));
    shared.width = spec->width;
    shared.height = spec->height;
    status = status ? status : set_all(spec, "options", json_object_get(root, "options"), shared_sets, NULL, &shared);
    spec->reference.params = shared;
    spec->reference.params.method = NOC_METHOD_REFERENCE;
    spec->reference.params.seed = 4711;
    status = status ? status : set_all(spec, "reference", json_object_get(root, "reference"), reference_sets, NULL, spec);
    status = status ? status : read_lists(spec, root, &shared);
    if (status)
        return status;
    double rows = 0;
    for (size_t i = 0; i < spec->config_count; i++)
        rows += spec->configs[i].frames;
    rows *= (double)spec->scene_count * (double)spec->camera_count * spec->repetitions * 2;
    return rows > EXPERIMENT_ROWS ? experiment_wrong(spec, "", "it asks for more than %d rows", EXPERIMENT_ROWS) : CLI_OK;
}

int experiment_read_spec(S *spec, const char *path) {
    *spec = (S){ .path = path, .size = "480x270", .frames = 20, .repetitions = 1, .accumulate = EXPERIMENT_MODES, .seed = 1,
                 .ceiling = 10, .reference = { .frames = 16 } };
    json_error_t error;
    struct stat st;
    if (!stat(path, &st) && S_ISDIR(st.st_mode)) {
        cli_error("%.200s: this is a folder; a spec is a JSON file", path);
        return CLI_FAILURE;
    }
    json_t *root = json_load_file(path, JSON_REJECT_DUPLICATES, &error);
    if (!root && error.line > 0) {
        return cli_usage(&cli_experiment, "%.200s:%d:%d: %.*s", path, error.line, error.column, 120, error.text);
    } else if (!root) {
        cli_error("%.200s: %.*s", path, 160, error.text);
        return CLI_FAILURE;
    }
    int status = read_root(spec, root);
    json_decref(root);
    return status;
}

void experiment_free_spec(S *spec) {
    for (size_t i = 0; i < spec->text_count; i++)
        free(spec->texts[i]);
    free(spec->texts);
    free(spec->scenes);
    free(spec->cameras);
    free(spec->configs);
}
