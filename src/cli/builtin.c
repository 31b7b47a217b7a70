/* Built-in scenes as inputs: "builtin:" and a name. They take options, so the program adds them; the library loads the
 * rest. */
#include "cli.h"

#include <stdlib.h>
#include <string.h>

#define BUILTIN "builtin:"

const char *cli_builtin(const char *input) {
    return strncmp(input, BUILTIN, strlen(BUILTIN)) ? NULL : input + strlen(BUILTIN);
}

static bool among(const char *const *inputs, size_t count, const char *scene) {
    for (size_t i = 0; i < count; i++)
        if (cli_builtin(inputs[i]) && !strcmp(cli_builtin(inputs[i]), scene))
            return true;
    return false;
}

const char *cli_builtin_needed(const noc_option *option, const char *const *inputs, size_t count) {
    for (const noc_option *o = noc_city_options(); o->name; o++)
        if (o == option)
            return among(inputs, count, "city") ? NULL : "builtin:city";
    for (const noc_option *o = noc_builtin_options(); o->name; o++)
        if (o == option && !among(inputs, count, "mess"))
            return !strcmp(o->name, "lights")          ? "builtin:mess"
                   : among(inputs, count, "cityscape") ? NULL
                                                       : "builtin:cityscape or builtin:mess";
    return NULL;
}

static bool among_lamps(const noc_import_params *import, const char *input) {
    for (size_t i = 0; i < import->lamps.count; i++)
        if (!strcmp(import->lamps.text[i], input))
            return true;
    return false;
}

void cli_add_lamps(cli_args *args, const noc_import_params *import) {
    for (size_t i = 0; i < import->lamps.count; i++) {
        bool there = false;
        for (size_t k = 0; k < args->input_count && !there; k++)
            there = !strcmp(args->inputs[k], import->lamps.text[i]);
        if (!there)
            /* there is room for every word of the command line */
            args->inputs[args->input_count++] = import->lamps.text[i];
    }
}

/* By noc_lamp_default. */
static const struct {
    const char *option, *what, *unit;
} lamp_defaults[NOC_LAMP_DEFAULT_COUNT] = {
    [NOC_LAMP_HEIGHT] = { "lamp-height", "height", "m" },
    [NOC_LAMP_FLUX] = { "lamp-lumens", "flux", "lm each" },
    [NOC_LAMP_COLOUR] = { "lamp-kelvin", "colour", "K" },
};

void cli_note_chosen(const cli_args *args, noc_import_params *import) {
    for (int i = 0; i < NOC_LAMP_DEFAULT_COUNT; i++)
        import->lamp_chosen |= cli_given(args, lamp_defaults[i].option) ? 1u << i : 0;
}

void cli_print_assumed(const char *heading, const size_t assumed[NOC_LAMP_DEFAULT_COUNT],
                       const noc_import_params *import) {
    const double values[] = { import->lamp_height, import->lamp_lumens, import->lamp_kelvin };
    char a[32];
    const char *before = heading;
    for (int i = 0; i < NOC_LAMP_DEFAULT_COUNT; i++) {
        if (!assumed[i])
            continue;
        printf("%s%s without %s: %.10g %s (--%s)", before, cli_count(a, assumed[i]), lamp_defaults[i].what, values[i],
               lamp_defaults[i].unit, lamp_defaults[i].option);
        before = ", ";
    }
    if (before != heading)
        putchar('\n');
}

noc_status cli_load_scene(noc_scene *scene, const char *const *inputs, size_t count, const noc_builtin_params *builtin,
                          const noc_import_params *import, noc_report **report) {
    const char **files = cli_alloc(sizeof(char *) * count);
    size_t file_count = 0;
    noc_status status = NOC_OK;
    cli_nothing_to_keep(true);
    for (size_t i = 0; i < count && !status; i++) {
        /* no file of lamps: an error */
        const char *name = among_lamps(import, inputs[i]) ? NULL : cli_builtin(inputs[i]);
        if (!name) {
            files[file_count++] = inputs[i];
        } else if (!among(inputs, i, name)) { /* once is enough */
            cli_progress_show(0, -1, "building %.40s", name);
            status = noc_scene_add_builtin(scene, name, builtin);
        }
    }
    if (!status)
        status = file_count ? noc_scene_load(scene, files, file_count, import, report) : noc_scene_commit(scene);
    free(files);
    cli_nothing_to_keep(false);
    cli_progress_clear();
    return status;
}
