/* Specs of experiments, as the program reads them. */
#include "fuzz.h"

#include "lab/lab.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char *path = fuzz_file("spec.json", (fuzz_part){ data, size });
    lab_spec spec;
    fuzz_memory(data, size);
    int status = lab_read_spec(&spec, path, true);
    fuzz_memory_back();
    FUZZ_REQUIRE(status == CLI_OK || status == CLI_USAGE || status == CLI_FAILURE);
    if (!status) {
        FUZZ_REQUIRE(spec.scene_count && spec.camera_count && spec.config_count && spec.width > 0 && spec.height > 0);
        for (size_t i = 0; i < spec.config_count; i++)
            FUZZ_REQUIRE(noc_render_check(&spec.configs[i].params, NULL) == NOC_OK && *spec.configs[i].name);
    }
    lab_free_spec(&spec);
    free(path);
    return 0;
}
