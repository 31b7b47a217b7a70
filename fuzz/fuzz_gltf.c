/* Fuzzer of the glTF reader: containers, JSON, buffers, accessors, nodes, lights, cameras.
 *
 *   clang -g -O1 -fsanitize=fuzzer,address,undefined -D_GNU_SOURCE -Iinclude -Isrc fuzz/fuzz_gltf.c \
 *       src/import/gltf*.c src/import/{stream,triangles}.c src/scene/{camera,camera_room,ground,light,scene}.c \
 *       src/geo/issues.c src/base/{log,memory,text}.c -ljansson -lzip -lz -lm -lpthread -o fuzz_gltf
 *   ./fuzz_gltf -max_len=8000 -rss_limit_mb=4000 CORPUS
 *
 * Whatever the bytes are: no crash, exactly one error or none and a scene that can be committed and looked at. */
#include "fuzz_mesh.h"

#include <math.h>

/* What a renderer would rely on. */
static void check_scene(noc_scene *scene) {
    if (noc_scene_commit(scene))
        abort();
    for (size_t i = 0; i < scene->indices.len; i++) {
        const float *p = &scene->positions.data[3 * (size_t)scene->indices.data[i]];
        if (3 * (size_t)scene->indices.data[i] + 2 >= scene->positions.len || !isfinite(p[0] + p[1] + p[2]))
            abort();
    }
    for (size_t i = 0; i < scene->lights.len; i++) {
        const noc_light_record *r = &scene->lights.data[i];
        for (int k = 0; k < 3; k++)
            if (!isfinite(r->p[k]) || !isfinite(r->e[k]) || r->e[k] < 0)
                abort();
    }
    noc_camera camera;
    if (noc_scene_city_triangles(scene) && noc_scene_camera(scene, NOC_VIEW_OWN, 1.5, &camera))
        abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    int fd = file_of("", data, size), errors = 0;
    char *path = noc_format("/proc/self/fd/%d", fd);
    noc_log *log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_ERROR, .message = on_message, .user = &errors });
    noc_scene *scene = noc_scene_create(log);
    geo_issues *issues = geo_issues_create();
    noc_import_params params = noc_import_default_params();
    double sum = 0;
    noc_stream *stream = size ? noc_stream_open(path, NULL) : NULL;
    if (stream) {
        const char *format;
        noc_status status = noc_reader_gltf.read_mesh(path, stream, &params, scene, &(mesh_place){ &sum, as_it_is }, issues, &format);
        if (errors != (status != NOC_OK))
            abort();
        if (!status)
            check_scene(scene);
    }
    noc_stream_close(stream);
    geo_issues_destroy(issues);
    noc_scene_destroy(scene);
    noc_log_destroy(log);
    free(path);
    close(fd);
    volatile double keep = sum;
    (void)keep;
    return 0;
}
