/* glTF files that tests write into a folder of their own, and what the reader makes of them. */
#ifndef NOC_TEST_GLTF_FILE_H
#define NOC_TEST_GLTF_FILE_H

#include "import/import.h"
#include "scene/scene.h"

#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

#include "../test.h"

typedef struct loaded {
    noc_log *log;
    noc_scene *scene;
    geo_issues *issues;
    noc_status status;
    char error[1024];
    int errors, warnings;
    const char *format;
} loaded;

static char folder[200];

static inline void on_message(void *user, noc_log_level level, const char *text) {
    loaded *l = user;
    if (level == NOC_LOG_ERROR)
        snprintf(l->error, sizeof(l->error), "%s", text);
    *(level == NOC_LOG_ERROR ? &l->errors : &l->warnings) += 1;
}

static inline noc_status as_it_is(void *ctx, double *xyz, size_t count) { return NOC_OK; }

static inline void write_file(const char *name, const void *data, size_t size) {
    char path[300];
    snprintf(path, sizeof(path), "%s/%s", folder, name);
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    assert_int_equal(fwrite(data, 1, size, f), size);
    fclose(f);
}

static inline void load(loaded *l, const char *name) {
    *l = (loaded){ 0 };
    char path[300];
    snprintf(path, sizeof(path), "%s/%s", folder, name);
    l->log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_WARN, .message = on_message, .user = l });
    l->scene = noc_scene_create(l->log);
    l->issues = geo_issues_create();
    noc_import_params params = noc_import_default_params();
    noc_stream *stream = noc_stream_open(path, l->log, NULL);
    l->status = stream ? noc_reader_gltf.read_mesh(path, stream, &params, l->scene, &(mesh_place){ NULL, as_it_is },
                                                   l->issues, &l->format)
                       : NOC_ERR_IO;
    noc_stream_close(stream);
}

static inline void unload(loaded *l) {
    noc_scene_destroy(l->scene);
    geo_issues_destroy(l->issues);
    noc_log_destroy(l->log);
}

static inline void load_text(loaded *l, const char *text) {
    write_file("a.gltf", text, strlen(text));
    load(l, "a.gltf");
}

static inline size_t skipped_count(const loaded *l, const char *reason) {
    for (size_t i = 0; i < geo_issues_count(l->issues); i++) {
        const char *r, *examples;
        bool repaired;
        size_t n;
        assert_true(geo_issues_get(l->issues, i, &r, &repaired, &n, &examples));
        if (strstr(r, reason))
            return n;
    }
    return 0;
}

/* ---- a small file ---- */

/* A unit square in x and y that looks along z: four places, then six indices. */
static const float square[12] = { 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0 };
static const uint16_t corners[6] = { 0, 1, 2, 0, 2, 3 };
enum { BUFFER = sizeof(square) + sizeof(corners) };
static unsigned char bytes[BUFFER];

static const char *base64(const unsigned char *data, size_t n) {
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    static char text[4000];
    char *to = text;
    for (size_t i = 0; i < n; i += 3) {
        uint32_t u =
            (uint32_t)data[i] << 16 | (i + 1 < n ? (uint32_t)data[i + 1] << 8 : 0) | (i + 2 < n ? data[i + 2] : 0);
        for (int k = 0; k < 4; k++)
            *to++ = i + (size_t)k > n ? '=' : digits[u >> (18 - 6 * k) & 63];
    }
    *to = 0;
    return text;
}

#define VIEWS                                                                                                          \
    "\"bufferViews\": [{\"buffer\": 0, \"byteLength\": 48}, {\"buffer\": 0, \"byteOffset\": 48, \"byteLength\": 12}],"
#define ACCESSORS                                                                                                      \
    "\"accessors\": [{\"bufferView\": 0, \"componentType\": 5126, \"count\": 4, \"type\": \"VEC3\"},"                  \
    " {\"bufferView\": 1, \"componentType\": 5123, \"count\": 6, \"type\": \"SCALAR\"}],"
#define MESHES "\"meshes\": [{\"primitives\": [{\"attributes\": {\"POSITION\": 0}, \"indices\": 1, \"material\": 0}]}],"
#define ASSET "{\"asset\": {\"version\": \"2.0\"}, "

/* rest: nodes and what else there is, ended by a comma. */
static inline char *file_text(const char *before, const char *rest) {
    static char text[8000];
    memcpy(bytes, square, sizeof(square));
    memcpy(bytes + sizeof(square), corners, sizeof(corners));
    int n = snprintf(text, sizeof(text),
                     ASSET
                     "%s %s \"buffers\": [{\"byteLength\": %d, \"uri\": \"data:application/octet-stream;base64,%s\"}]}",
                     before, rest, BUFFER, base64(bytes, BUFFER));
    assert_in_range(n, 1, sizeof(text) - 1);
    return text;
}

#define PLAIN VIEWS ACCESSORS MESHES

static inline void assert_place(const loaded *l, size_t vertex, double x, double y, double z) {
    assert_true(3 * vertex + 2 < l->scene->positions.len);
    const float *p = &l->scene->positions.data[3 * vertex];
    assert_float_equal(p[0], x, 1e-5);
    assert_float_equal(p[1], y, 1e-5);
    assert_float_equal(p[2], z, 1e-5);
}

static inline int set_up(void **state) {
    const char *tmp = getenv("TMPDIR");
    snprintf(folder, sizeof(folder), "%s/nocturne-gltf-%d", tmp && *tmp ? tmp : "/tmp", (int)getpid());
    return mkdir(folder, 0700);
}

static inline int tear_down(void **state) {
    static const char *const files[] = { "a.gltf", "a.glb", "b c.bin" };
    for (size_t i = 0; i < NOC_COUNT(files); i++) {
        char path[300];
        snprintf(path, sizeof(path), "%s/%s", folder, files[i]);
        unlink(path);
    }
    return rmdir(folder);
}

#endif
