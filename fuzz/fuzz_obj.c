/* Fuzzer of the OBJ reader: the passes that make its text plain, and Assimp behind them.
 *
 *   clang -g -O1 -fsanitize=fuzzer,address,undefined -D_GNU_SOURCE -Iinclude -Isrc -IBUILD fuzz/fuzz_obj.c src/import/obj_*.c \
 *       src/import/{mesh,polygons,stream,triangles}.c src/scene/{camera,camera_room,ground,light,scene}.c \
 *       src/geo/{issues,polygon,tessellate}.c src/base/{log,memory,text}.c -lassimp -lGLU -lzip -lz -lm -lpthread -o fuzz_obj
 *   ./fuzz_obj -max_len=4000 -rss_limit_mb=4000 CORPUS
 *
 * BUILD holds noc_config.h. Text up to a byte of 0 is the OBJ, the rest its material library. */
#include "fuzz_mesh.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    const uint8_t *zero = size ? memchr(data, 0, size) : NULL;
    size_t text = zero ? (size_t)(zero - data) : size;
    int errors = 0, library = file_of("", zero ? zero + 1 : data, zero ? size - text - 1 : 0);
    char *head = noc_format("mtllib /proc/self/fd/%d\n", library);
    int fd = file_of(head, data, text);
    char *path = noc_format("/proc/self/fd/%d", fd);
    noc_log *log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_ERROR, .message = on_message, .user = &errors });
    noc_scene *scene = noc_scene_create(log);
    geo_issues *issues = geo_issues_create();
    noc_import_params params = noc_import_default_params();
    double sum = 0;
    noc_stream *stream = noc_stream_open(path, NULL);
    const char *format;
    noc_status status = noc_reader_mesh.read_mesh(path, stream, &params, scene, &(mesh_place){ &sum, as_it_is }, issues, &format);
    if (errors != (status != NOC_OK) || (!status && noc_scene_commit(scene)))
        abort();
    noc_stream_close(stream);
    geo_issues_destroy(issues);
    noc_scene_destroy(scene);
    noc_log_destroy(log);
    free(head);
    free(path);
    close(fd);
    close(library);
    volatile double keep = sum;
    (void)keep;
    return 0;
}
