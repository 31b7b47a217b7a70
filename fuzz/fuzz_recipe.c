/* Recipes. */
#include "fuzz.h"

#include <math.h>
#include <nocturne/recipe.h>
#include <nocturne/text.h>

/* A path whose keys say places in local metres can be gone along. */
static void walk(const noc_recipe_path *path) {
    enum { KEYS = 16, STEPS = 20 };
    noc_camera_key keys[KEYS];
    noc_camera_path *made;
    size_t n = path->key_count;
    for (size_t i = 0; i < n; i++) {
        const noc_path_key *k = &path->keys[i];
        FUZZ_REQUIRE(!k->camera.eye == !k->camera.target && k->hour <= 24 && k->seconds <= NOC_PATH_MOST_SECONDS);
        FUZZ_REQUIRE(!i || k->seconds < 0 || k->seconds > k[-1].seconds);
        if (i >= KEYS || !k->camera.eye || k->camera.crs)
            return;
        keys[i] = (noc_camera_key){ noc_camera_default(), k->seconds, k->hour };
        if (!noc_text_numbers(k->camera.eye, ',', 3, keys[i].camera.eye) ||
            !noc_text_numbers(k->camera.target, ',', 3, keys[i].camera.target))
            return;
    }
    if (noc_camera_path_create(keys, n, path->loop, 0, NULL, &made))
        return;
    for (int i = -1; i <= STEPS; i++) {
        noc_camera c;
        double t = noc_camera_path_seconds(made) * i / STEPS;
        FUZZ_REQUIRE(noc_camera_path_at(made, t, &c) == NOC_OK && noc_camera_path_hour(made, t) <= 24);
        for (int k = 0; k < 3; k++)
            FUZZ_REQUIRE(isfinite(c.eye[k]) && isfinite(c.target[k]) && isfinite(c.up[k]));
        FUZZ_REQUIRE(c.fov_deg > 0 && c.fov_deg < 180);
    }
    noc_camera_path_destroy(made);
}

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
    for (size_t i = 0; i < info->path_count; i++) {
        FUZZ_REQUIRE(*info->paths[i].name && info->paths[i].key_count);
        walk(&info->paths[i]);
    }
    for (size_t i = 0; i < info->input_count; i++)
        FUZZ_REQUIRE(*info->inputs[i]);
    for (size_t i = 0; noc_recipe_option(recipe, i); i++)
        FUZZ_REQUIRE(*noc_recipe_option(recipe, i)->name);
    noc_recipe_destroy(recipe);
    noc_log_destroy(log);
    free(path);
    return 0;
}
