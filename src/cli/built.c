/* Inputs that are built cities: what is decided in it, and what may still be switched. */
#include "cli.h"

#include <stdlib.h>
#include <string.h>

bool cli_is_built(const cli_args *args) {
    bool built = args->input_count > 0;
    for (size_t i = 0; built && i < args->input_count; i++)
        built = !cli_builtin(args->inputs[i]) && noc_built_is(args->inputs[i]);
    return built;
}

bool cli_has_map(const cli_args *args, const noc_import_params *import) {
    noc_built_info info;
    if (import->environment)
        return true;
    bool built = cli_is_built(args), map = false;
    for (size_t k = 0; built && k < args->input_count && !map; k++) {
        if (noc_built_get_info(args->inputs[k], NULL, &info))
            return false;
        for (size_t i = 0; i < info.section_count; i++)
            map = map || !strcmp(info.sections[i].name, "sky");
    }
    return map;
}

/* What costs little to switch, and so may be another than it was built with. */
static bool of_windows(const noc_option *o) {
    return !strcmp(o->name, "window-lit") || !strcmp(o->name, "hour") || !strcmp(o->name, "window-seed");
}
static bool of_groups(const noc_option *o) { return !strcmp(o->name, "group"); }
static bool of_cars(const noc_option *o) { return !strcmp(o->name, "traffic-time"); }
static bool of_rain(const noc_option *o, const noc_import_params *import) {
    return !strcmp(o->name, "wet") && import->wet;
}

static bool of_import(const noc_option *option) {
    for (const noc_option *o = noc_import_options(); o->name; o++)
        if (o == option)
            return strcmp(o->group, "Reading") && strcmp(o->name, "strict") && strcmp(o->name, "environment");
    return false;
}

/* What its build has decided may be said again. Lists and files are not in its recipe. */
static bool as_built(const noc_recipe *built, const noc_option *o, const noc_import_params *import) {
    noc_import_params then = noc_import_default_params();
    if (o->kind == NOC_OPTION_TEXTS || !strcmp(o->unit, "FILE"))
        return false;
    for (size_t i = 0; noc_recipe_option(built, i); i++)
        if (noc_recipe_option(built, i) == o && noc_recipe_set(built, o, &then, NULL))
            return false;
    char *a = cli_option_value(o, &then), *b = cli_option_value(o, import);
    bool same = a && b ? !strcmp(a, b) : a == b;
    free(a);
    free(b);
    return same;
}

/* What has the same effect on a city that is built, where anything has. */
static const char *instead(const noc_option *o) {
    return strcmp(o->name, "maintenance") ? "" : ", or dim its lamps, as --group lamps=0.8 does";
}

static int check_options(const cli_command *command, const cli_args *args, const noc_import_params *import,
                         const noc_recipe *built) {
    for (size_t i = 0; i < args->said_anew; i++) {
        const noc_option *o = args->given[i];
        bool may = !of_import(o) || of_windows(o) || of_groups(o) || of_cars(o) || of_rain(o, import);
        if (!may && !as_built(built, o, import))
            return cli_usage(command,
                             "%s: %.200s is built already, and that has decided it: build it again with this%s",
                             o->name, args->inputs[0], instead(o));
    }
    return CLI_OK;
}

int cli_check_built(const cli_command *command, const cli_args *args, const noc_import_params *import) {
    noc_recipe *built = NULL;
    if (!cli_is_built(args))
        return CLI_OK;
    const noc_recipe_info *recipe = noc_recipe_get_info(args->recipe);
    if (recipe->luminaire_count || recipe->group_count)
        return cli_usage(command,
                         "%s of a recipe: %.200s is built already, and that has decided them: build it again with them",
                         recipe->luminaire_count ? "luminaires" : "groups", args->inputs[0]);
    noc_log *log = cli_log_create(args);
    int status =
        noc_recipe_load(args->inputs[0], log, &built) ? CLI_FAILURE : check_options(command, args, import, built);
    noc_recipe_destroy(built);
    noc_log_destroy(log);
    return status;
}

noc_status cli_switch_built(const cli_args *args, noc_scene *scene, const noc_import_params *import,
                            noc_report *report) {
    bool windows = false, cars = false;
    for (size_t i = 0; i < args->said_anew; i++) {
        windows = windows || of_windows(args->given[i]);
        cars = cars || of_cars(args->given[i]);
    }
    if (!(windows || cars) || !cli_is_built(args))
        return NOC_OK;
    noc_status status = windows ? noc_scene_set_windows(scene, &import->window) : NOC_OK;
    if (!status && cars)
        status = noc_scene_set_time(scene, import->cars.time);
    status = status ? status : noc_scene_commit(scene);
    return status || !windows || !report ? status : noc_report_follow(report, scene);
}
