/* Built cities, whose sums are made right first: the input is a file, of which any number may be any other. */
#include "fuzz.h"

#include "import/built/built.h"
#include "noct/inside.h"

#include <nocturne/built.h>
#include <nocturne/import.h>
#include <nocturne/recipe.h>

enum { MOST_BLOCKS = 64 };

/* Sums, sizes and the layout of this build, where there is a head at all. */
static uint8_t *mended(const uint8_t *data, size_t size) {
    uint8_t *bytes = noc_alloc(size);
    noct_head head;
    FUZZ_REQUIRE(bytes);
    if (size)
        memcpy(bytes, data, size);
    if (size < NOCT_HEAD || !noct_is_head(bytes, size))
        return bytes;
    memcpy(&head, bytes, sizeof(head));
    head.size = size;
    head.layout = built_layout();
    for (uint32_t i = 0; i < NOC_MIN(head.sections, (uint32_t)NOCT_SECTIONS); i++) {
        uint64_t sums[MOST_BLOCKS] = { 0 };
        size_t count = 0;
        noct_entry e;
        uint8_t *at = bytes + sizeof(head) + i * sizeof(e);
        memcpy(&e, at, sizeof(e));
        bool inside = e.offset <= size && e.bytes <= size - e.offset && e.bytes <= MOST_BLOCKS * NOCT_BLOCK;
        for (uint64_t k = 0; inside && k < e.bytes; k += NOCT_BLOCK)
            sums[count++] = noct_sum(bytes + e.offset + k, (size_t)NOC_MIN(e.bytes - k, (uint64_t)NOCT_BLOCK));
        e.sum = noct_sum(sums, count * sizeof(*sums));
        memcpy(at, &e, sizeof(e));
    }
    head.sum = 0;
    memcpy(bytes, &head, sizeof(head));
    head.sum = noct_sum(bytes, NOCT_HEAD);
    memcpy(bytes, &head, sizeof(head));
    return bytes;
}

/* Whoever has it edits it as any scene. */
static void edit(noc_scene *scene) {
    const noc_window_params windows = noc_window_default_params();
    const noc_material wall = noc_class_material(NOC_CLASS_WALL);
    noc_scene_info info;
    noc_scene_get_info(scene, &info);
    FUZZ_REQUIRE(!noc_scene_set_windows(scene, &windows));
    FUZZ_REQUIRE(!noc_scene_set_class_material(scene, NOC_CLASS_WALL, &wall));
    noc_scene_set_time(scene, 3); /* cars may be where none can stand */
    if (scene->groups.len)
        FUZZ_REQUIRE(!noc_scene_set_group(scene, 1, (float[]){ 0, 1, 2 }));
    for (int i = 0; i < 4; i++) {
        noc_scene_remove_mesh(scene, i);
        noc_scene_remove_light(scene, i);
        noc_scene_remove_instance(scene, i);
        noc_scene_set_material(scene, i, &(noc_material){ .roughness = 1, .emission = { 1, 1, 1 } });
    }
    FUZZ_REQUIRE(!noc_scene_commit(scene));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    int errors = 0;
    uint8_t *bytes = mended(data, size);
    char *path = fuzz_file("city.noct", (fuzz_part){ bytes, size });
    const char *inputs[] = { path };
    noc_log *log = fuzz_log(&errors);
    noc_scene *scene = noc_scene_create(log);
    noc_import_params params = noc_import_default_params();
    noc_report *report;
    params.threads = 1;
    noc_recipe *recipe;
    if (noc_built_is(path) && !noc_recipe_load(path, NULL, &recipe))
        noc_recipe_destroy(recipe);
    fuzz_memory(data, size);
    noc_status status = noc_scene_load(scene, inputs, 1, &params, &report);
    fuzz_memory_back();
    FUZZ_REQUIRE(errors == (status != NOC_OK));
    if (!status && noc_built_is(path)) {
        noc_report_totals totals;
        noc_report_get_totals(report, &totals);
        fuzz_check_scene(scene, fuzz_seldom(data, size, 8));
        edit(scene);
        fuzz_check_scene(scene, false);
    }
    noc_report_destroy(report);
    noc_scene_destroy(scene);
    noc_log_destroy(log);
    free(path);
    free(bytes);
    return 0;
}
