/* The whole way from several inputs of any format to a committed scene, with what can be asked of it. */
#include "fuzz.h"

#include <math.h>
#include <nocturne/import.h>
#include <stdio.h>

static void check_report(const noc_report *report) {
    size_t sum = 0;
    for (size_t i = 0; report && i < noc_report_file_count(report); i++) {
        const noc_report_file *f = noc_report_get_file(report, i);
        sum += strlen(f->path) + strlen(f->crs) + strlen(f->crs_given) + (f->format ? strlen(f->format) : 0);
        for (size_t k = 0; k < f->line_count; k++)
            sum += strlen(f->lines[k].reason) + strlen(f->lines[k].examples) + f->lines[k].count;
    }
    volatile size_t keep = sum;
    (void)keep;
}

static void inspect(const char *path, const noc_import_params *params, noc_log *log, int *errors) {
    noc_report *report = NULL;
    *errors = 0;
    noc_status status = noc_inspect(log, path, params, &report);
    FUZZ_REQUIRE(*errors == (status != NOC_OK));
    check_report(report);
    noc_report_destroy(report);
}

/* The size chooses what is asked besides: a CRS for files that name none, lamps by a rule, a look at the first file
 * alone. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    fuzz_part part[FUZZ_PARTS];
    int n = fuzz_parts(data, size, part), errors = 0;
    char *paths[FUZZ_PARTS];
    noc_log *log = fuzz_log(&errors);
    noc_import_params params = noc_import_default_params();
    params.isolate = false; /* it is the readers that are tried */
    params.crs = size & 1 ? "EPSG:25832" : NULL;
    params.infer_lamps = size & 2;
    for (int i = 0; i < n; i++) {
        char name[24];
        snprintf(name, sizeof(name), "input%d", i);
        paths[i] = fuzz_file(name, part[i]);
    }
    noc_scene *scene = noc_scene_create(log);
    noc_report *report = NULL;
    fuzz_memory(data, size);
    noc_status status = noc_scene_load(scene, (const char *const *)paths, (size_t)n, &params, &report);
    fuzz_memory_back();
    FUZZ_REQUIRE(errors == (status != NOC_OK));
    check_report(report);
    if (!status) {
        fuzz_check_scene(scene, fuzz_seldom(data, size, 256));
        double xyz[3] = { 11.5, 48.1, 500 };
        noc_scene_info info;
        noc_scene_get_info(scene, &info);
        if (noc_scene_to_local(scene, "EPSG:4326", xyz) == NOC_OK)
            FUZZ_REQUIRE(!isnan(xyz[0] + xyz[1]));
    }
    noc_report_destroy(report);
    noc_scene_destroy(scene);
    if (size & 4)
        inspect(paths[0], &params, log, &errors);
    for (int i = 0; i < n; i++)
        free(paths[i]);
    noc_log_destroy(log);
    return 0;
}
