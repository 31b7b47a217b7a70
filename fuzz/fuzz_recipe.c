/* Recipes. */
#include "fuzz.h"

#include <nocturne/recipe.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    int errors = 0;
    char *path = fuzz_file("city.yaml", (fuzz_part){ data, size });
    noc_log *log = fuzz_log(&errors);
    noc_recipe *recipe;
    noc_recipe_is(path);
    fuzz_memory(data, size);
    noc_status status = noc_recipe_load(path, log, &recipe);
    fuzz_memory_back();
    FUZZ_REQUIRE(errors == (status != NOC_OK) && !recipe == (status != NOC_OK));
    const noc_recipe_info *info = noc_recipe_get_info(recipe);
    for (size_t i = 0; i < info->camera_count; i++)
        FUZZ_REQUIRE(*info->cameras[i].name && !info->cameras[i].params.eye == !info->cameras[i].params.target);
    for (size_t i = 0; i < info->input_count; i++)
        FUZZ_REQUIRE(*info->inputs[i]);
    for (size_t i = 0; noc_recipe_option(recipe, i); i++)
        FUZZ_REQUIRE(*noc_recipe_option(recipe, i)->name);
    noc_recipe_destroy(recipe);
    noc_log_destroy(log);
    free(path);
    return 0;
}
