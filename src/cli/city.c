/* From the arguments of render and view to a scene. */
#include "render.h"

#include <string.h>

#define TEXT(n, g, f, u, h)                                                                                            \
    { n, g, NOC_OPTION_TEXT, offsetof(render_args, f), 0, 0, NULL, u, h }

const noc_option *cli_camera_options(void) {
    static const noc_option rows[] = {
        TEXT("camera", "Camera", camera_name, "NAME", "a camera of the recipe among the inputs; else its first one"),
        { NULL },
    };
    return rows;
}

const noc_option *cli_exposure_options(void) {
    static const noc_option rows[] = {
        TEXT("exposure", "Display", exposure, "EV",
             "\"auto\" (noise moves it), EV100 (one more is half as bright), or f/2.8,1/30,iso1600"),
        { NULL },
    };
    return rows;
}

const char *const cli_of_pictures[] = { "jitter",
                                        "accumulate",
                                        "emitters",
                                        "method",
                                        "candidates",
                                        "draws",
                                        "list",
                                        "tail",
                                        "shadow-rays",
                                        "learn",
                                        "influence",
                                        "influence-boxes",
                                        "influence-cluster",
                                        "uniform-every",
                                        "rays",
                                        "final-ray",
                                        "temporal",
                                        "spatial",
                                        "neighbours",
                                        "radius",
                                        "passes",
                                        "history",
                                        "bias",
                                        "bias-rays",
                                        "visibility-reuse",
                                        "reject-depth",
                                        "reject-normal",
                                        "isa",
                                        NULL };

int cli_parse_classes(const cli_command *command, const char *option, const char *text, uint32_t *bits) {
    const char *names[NOC_CLASS_COUNT];
    for (int c = 0; c < NOC_CLASS_COUNT; c++)
        names[c] = noc_class_name((noc_class)c);
    for (const char *p = text; p && *p;) {
        char word[32];
        size_t n = strcspn(p, ",");
        int cls = 0;
        snprintf(word, sizeof(word), "%.*s", (int)(n < 31 ? n : 31), p);
        while (cls < NOC_CLASS_COUNT && strcmp(word, names[cls]))
            cls++;
        const char *nearest = cls < NOC_CLASS_COUNT ? NULL : noc_text_nearest(word, names, NOC_CLASS_COUNT);
        if (cls == NOC_CLASS_COUNT)
            return cli_usage(command, "%s: no class \"%s\"%s%s%s", option, word, nearest ? "; is it " : "",
                             nearest ? nearest : "", nearest ? "?" : "");
        *bits |= 1u << cls;
        p += n + (p[n] == ',');
    }
    return CLI_OK;
}

static int check_builtin(const render_args *args) {
    for (size_t i = 0; i < args->common.given_count; i++) {
        const noc_option *o = args->common.given[i];
        const char *needed = noc_option_needs_input(o, args->common.inputs, args->common.input_count);
        if (needed)
            return cli_usage(args->command, "--%s is for the input %s", o->name, needed);
    }
    return CLI_OK;
}

/* What the preset sets, but for options that were given themselves. */
static void use_preset(render_args *args) {
    noc_render_params given = args->render, *p = &args->render;
    const noc_recipe_info *recipe = noc_recipe_get_info(args->common.recipe);
    if (recipe->has_preset && !cli_given(&args->common, "preset"))
        args->preset = (int)recipe->preset;
    noc_render_use_preset(p, (noc_preset)args->preset);
    for (const noc_option *o = noc_render_options(); o->name; o++)
        for (size_t i = 0; i < args->common.given_count; i++)
            if (args->common.given[i] == o)
                memcpy((char *)p + o->offset, (const char *)&given + o->offset, noc_option_size(o));
}

static int check_map(const render_args *args) {
    bool may = !args->render.environment_light || cli_has_map(&args->common, &args->import);
    return may ? CLI_OK
               : cli_usage(args->command, "--environment-light needs a map around the city that lights it: "
                                          "--environment FILE");
}

int cli_check_city(render_args *args) {
    cli_note_chosen(&args->common, &args->import);
    int status = check_builtin(args);
    use_preset(args);
    status = status ? status : cli_parse_exposure(args->command, args->exposure, &args->display);
    status = status ? status : cli_check_camera(args);
    status = status ? status : check_map(args);
    status = status ? status : cli_check_device(args->command, &args->device);
    return status ? status : cli_check_built(args->command, &args->common, &args->import);
}

noc_status cli_load_city(render_args *args, noc_scene *scene, const noc_progress *progress, noc_report **report) {
    args->import.progress = *progress;
    args->import.builtin = &args->builtin;
    noc_recipe_lists(args->common.recipe, &args->import);
    args->import.threads = args->device.threads;
    noc_status status = noc_scene_load(scene, args->common.inputs, args->common.input_count, &args->import, report);
    return status ? status : cli_switch_built(&args->common, scene, &args->import, report ? *report : NULL);
}
