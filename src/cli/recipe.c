/* An input that is a recipe: its inputs in its place, and its options where the command line says nothing else. */
#include "cli.h"

#include <stdlib.h>
#include <string.h>

static bool reads_cities(const cli_command *command) {
    bool reads = false;
    for (const cli_set *set = command->sets; set->table; set++)
        reads = reads || set->table == noc_import_options;
    return reads;
}

/* Inputs of the recipe where it stood, the others around it. */
static void replace_input(cli_args *args, size_t index, const noc_recipe_info *recipe) {
    size_t count = args->input_count - 1 + recipe->input_count, n = 0;
    const char **inputs = cli_alloc(sizeof(char *) * (count + 1));
    for (size_t i = 0; i < args->input_count; i++) {
        for (size_t k = 0; i == index && k < recipe->input_count; k++)
            inputs[n++] = recipe->inputs[k];
        if (i != index)
            inputs[n++] = args->inputs[i];
    }
    free(args->inputs);
    args->inputs = inputs;
    args->input_count = n;
}

/* Has the command line said it, or what excludes it? */
static bool said(const cli_args *args, const char *name) {
    bool side = !strcmp(name, "width") || !strcmp(name, "height");
    bool exposure = !strcmp(name, "ev100") || !strcmp(name, "auto-exposure");
    return cli_given(args, name) || (side && cli_given(args, "size")) || (exposure && cli_given(args, "exposure"));
}

static int take_options(const cli_command *command, cli_args *args) {
    const noc_option *option;
    for (size_t i = 0; (option = noc_recipe_option(args->recipe, i)); i++) {
        for (const cli_set *set = command->sets; set->table && !said(args, option->name); set++)
            for (const noc_option *o = set->table(); o->name; o++) {
                if (o != option)
                    continue;
                if (noc_recipe_set(args->recipe, o, (char *)args + set->offset, NULL))
                    return CLI_FAILURE; /* it was checked when it was read */
                if (args->given_count < CLI_GIVEN)
                    args->given[args->given_count++] = o;
            }
    }
    return CLI_OK;
}

static noc_import_params *import_of(const cli_command *command, void *arguments) {
    for (const cli_set *set = command->sets; set->table; set++)
        if (set->table == noc_import_options)
            return (noc_import_params *)(void *)((char *)arguments + set->offset);
    return NULL;
}

/* The box has done its work: what is built does not ask for it. */
static void forget_box(cli_args *args, noc_import_params *import) {
    size_t kept = 0;
    for (size_t i = 0; i < args->given_count; i++)
        if (strcmp(args->given[i]->name, "bbox"))
            args->given[kept++] = args->given[i];
    args->given_count = kept;
    import->bbox = NULL;
}

/* Tiles in the place of an index that is an input, those that meet --bbox. */
static int open_index(const cli_command *command, void *arguments) {
    cli_args *args = arguments;
    noc_import_params *import = import_of(command, arguments);
    bool any = false;
    int status = CLI_OK;
    for (size_t i = 0; i < args->input_count && import && !status; i++) {
        char **tiles;
        size_t count;
        if (!noc_tiles_is(args->inputs[i]))
            continue;
        if (any)
            return cli_usage(command, "%.200s: is a second index of tiles; one is opened", args->inputs[i]);
        noc_log *log = cli_log_create(args);
        status = noc_tiles_find(args->inputs[i], import->bbox, log, &tiles, &count) ? CLI_FAILURE : CLI_OK;
        noc_log_destroy(log);
        if (status)
            break;
        args->opened = tiles;
        replace_input(args, i, &(noc_recipe_info){ .input_count = count, .inputs = (const char *const *)tiles });
        any = true;
        i += count - 1;
    }
    if (any)
        forget_box(args, import);
    return status;
}

int cli_use_recipe(const cli_command *command, void *arguments) {
    cli_args *args = arguments;
    int opened = open_index(command, arguments);
    if (opened)
        return opened;
    size_t index = args->input_count;
    args->given_by_words = args->given_count;
    args->said = cli_alloc(sizeof(char *) * (args->input_count + 1));
    memcpy(args->said, args->inputs, sizeof(char *) * args->input_count);
    args->said_count = args->input_count;
    for (size_t i = 0; i < args->input_count && reads_cities(command); i++) {
        if (!noc_recipe_is(args->inputs[i]))
            continue;
        if (index < args->input_count && noc_built_is(args->inputs[index]) && noc_built_is(args->inputs[i]))
            continue; /* built cities are joined, and the first one's recipe counts */
        if (index < args->input_count)
            return cli_usage(command, "%.200s and %.200s are both recipes, or built; one makes a city",
                             args->inputs[index], args->inputs[i]);
        index = i;
    }
    if (index == args->input_count)
        return CLI_OK;
    noc_log *log = cli_log_create(args);
    noc_status status = noc_recipe_load(args->inputs[index], log, &args->recipe);
    noc_log_destroy(log);
    if (status)
        return CLI_FAILURE;
    bool built = noc_built_is(args->inputs[index]);
    replace_input(args, index, noc_recipe_get_info(args->recipe));
    int taken = take_options(command, args);
    args->said_anew = built ? args->given_by_words : args->given_count;
    return taken;
}

const noc_recipe_camera *cli_recipe_camera(const cli_args *args, const char *name) {
    const noc_recipe_info *info = noc_recipe_get_info(args->recipe);
    for (size_t i = 0; i < info->camera_count; i++)
        if (!name || !strcmp(info->cameras[i].name, name))
            return &info->cameras[i];
    return NULL;
}
