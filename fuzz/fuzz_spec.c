/* Specs of experiments, as the laboratory reads them. */
#include "fuzz.h"

#include <nocturne/lab.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    int errors = 0;
    char *path = fuzz_file("spec.json", (fuzz_part){ data, size });
    noc_log *log = fuzz_log(&errors);
    noc_lab_spec *spec;
    fuzz_memory(data, size);
    noc_status status = noc_lab_spec_read(path, &spec, log);
    fuzz_memory_back();
    FUZZ_REQUIRE(errors == (status != NOC_OK) && !spec == (status != NOC_OK));
    if (spec) {
        noc_lab_spec_info info;
        noc_lab_camera_info camera;
        noc_lab_config_info config;
        noc_lab_spec_get_info(spec, &info);
        FUZZ_REQUIRE(info.scenes && info.cameras && info.configurations && info.width > 0 && info.height > 0);
        FUZZ_REQUIRE(!noc_lab_spec_get_camera(spec, info.cameras - 1, &camera) && *camera.name && *camera.scene);
        for (size_t i = 0; i < info.configurations; i++) {
            FUZZ_REQUIRE(!noc_lab_spec_get_config(spec, i, &config) && *config.name);
            FUZZ_REQUIRE(noc_render_check(config.render, NULL) == NOC_OK);
        }
    }
    noc_lab_spec_destroy(spec);
    noc_log_destroy(log);
    free(path);
    return 0;
}
