/* An input that is a built city: what is decided in it, and what may still be switched. */
#include "cli.h"

#include <string.h>

bool cli_is_built(const cli_args *args) {
    return args->input_count == 1 && !cli_builtin(args->inputs[0]) && noc_built_is(args->inputs[0]);
}

bool cli_has_map(const cli_args *args, const noc_import_params *import) {
    noc_built_info info;
    if (import->environment)
        return true;
    if (!cli_is_built(args) || noc_built_get_info(args->inputs[0], NULL, &info))
        return false;
    for (size_t i = 0; i < info.section_count; i++)
        if (!strcmp(info.sections[i].name, "sky"))
            return true;
    return false;
}

/* What costs nothing to switch. */
static bool of_windows(const noc_option *o) { return !strcmp(o->name, "window-lit") || !strcmp(o->name, "hour"); }
static bool of_groups(const noc_option *o) { return !strcmp(o->name, "group"); }
static bool of_cars(const noc_option *o) { return !strcmp(o->name, "traffic-time"); }

static bool of_import(const noc_option *option) {
    for (const noc_option *o = noc_import_options(); o->name; o++)
        if (o == option)
            return strcmp(o->group, "Reading") && strcmp(o->name, "strict") && strcmp(o->name, "environment");
    return false;
}

void cli_warn_of_built(const cli_args *args) {
    for (size_t i = 0; i < args->given_by_words && cli_is_built(args) && !args->quiet; i++)
        if (of_import(args->given[i]) && !of_windows(args->given[i]) && !of_groups(args->given[i]) &&
            !of_cars(args->given[i]))
            cli_error("warning: --%s has no effect: %.200s is built already", args->given[i]->name, args->inputs[0]);
}

noc_status cli_switch_built(const cli_args *args, noc_scene *scene, const noc_import_params *import) {
    bool windows = false, cars = false;
    for (size_t i = 0; i < args->given_by_words; i++) {
        windows = windows || of_windows(args->given[i]);
        cars = cars || of_cars(args->given[i]);
    }
    if (!(windows || cars) || !cli_is_built(args))
        return NOC_OK;
    noc_status status = windows ? noc_scene_set_windows(scene, &import->window) : NOC_OK;
    if (!status && cars)
        status = noc_scene_set_time(scene, import->cars.time);
    return status ? status : noc_scene_commit(scene);
}
