/* Built-in scenes as inputs: "builtin:" and a name. They take options, so the program adds them; the library loads the rest. */
#include "cli.h"

#include <stdlib.h>
#include <string.h>

#define BUILTIN "builtin:"

const char *cli_builtin(const char *input) { return strncmp(input, BUILTIN, strlen(BUILTIN)) ? NULL : input + strlen(BUILTIN); }

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
            return !strcmp(o->name, "lights") ? "builtin:mess" : among(inputs, count, "cityscape") ? NULL : "builtin:cityscape or builtin:mess";
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
            args->inputs[args->input_count++] = import->lamps.text[i]; /* there is room for every word of the command line */
    }
}

noc_status cli_load_scene(noc_scene *scene, const char *const *inputs, size_t count, const noc_builtin_params *builtin,
                          const noc_import_params *import, noc_report **report) {
    const char **files = cli_alloc(sizeof(char *) * count);
    size_t file_count = 0;
    noc_status status = NOC_OK;
    cli_nothing_to_keep(true);
    for (size_t i = 0; i < count && !status; i++) {
        const char *name = among_lamps(import, inputs[i]) ? NULL : cli_builtin(inputs[i]); /* no file of lamps: an error */
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
