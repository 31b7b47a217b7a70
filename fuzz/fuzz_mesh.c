/* Meshes to a committed scene: glTF and GLB (FUZZ_MESH 1), PLY (2), or OBJ (0). A second part is the buffer or material
 * library beside it. */
#include "fuzz.h"

#include "import/import.h"

static noc_status as_it_is(void *ctx, double *xyz, size_t count) {
    double *sum = ctx;
    for (size_t i = 0; i < 3 * count; i++)
        *sum += xyz[i];
    return NOC_OK;
}

static noc_status look_at(void *ctx, int material, const mesh_image *image) {
    double *sum = ctx;
    FUZZ_REQUIRE(material >= 0 && image->name && (unsigned)image->wrap <= NOC_WRAP_CLAMP);
    for (int k = 0; k < 3; k++)
        FUZZ_REQUIRE(image->albedo[k] >= 0 && image->albedo[k] <= 1);
    for (size_t i = 0; i < image->size; i++)
        *sum += image->data[i];
    *sum += (double)strlen(image->name);
    return NOC_OK;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    fuzz_part part[FUZZ_PARTS];
    int n = fuzz_parts(data, size, part), errors = 0;
    const noc_reader *reader = FUZZ_MESH == 1 ? &noc_reader_gltf : FUZZ_MESH ? &noc_reader_ply : &noc_reader_mesh;
    noc_log *log = fuzz_log(&errors);
    noc_scene *scene = noc_scene_create(log);
    geo_issues *issues = geo_issues_create();
    noc_import_params params = noc_import_default_params();
    double sum = 0;
    char *beside = fuzz_file(FUZZ_MESH == 1 ? "side.bin" : "side.mtl", n > 1 ? part[1] : (fuzz_part){ data, 0 });
    char *path = fuzz_file(FUZZ_MESH == 1 ? "mesh.gltf" : FUZZ_MESH ? "mesh.ply" : "mesh.obj", part[0]);
    const char *format;
    fuzz_memory(data, size);
    noc_stream *stream = noc_stream_open(path, log, NULL);
    noc_status status = NOC_ERR_IO;
    if (stream)
        status =
            reader->read_mesh(path, stream, &params, scene, &(mesh_place){ &sum, as_it_is, look_at }, issues, &format);
    if (!status)
        status = noc_scene_commit(scene);
    fuzz_memory_back();
    FUZZ_REQUIRE(errors == (status != NOC_OK));
    if (!status)
        fuzz_check_scene(scene, fuzz_seldom(data, size, 256));
    noc_stream_close(stream);
    geo_issues_destroy(issues);
    noc_scene_destroy(scene);
    noc_log_destroy(log);
    free(beside);
    free(path);
    volatile double keep = sum;
    (void)keep;
    return 0;
}
