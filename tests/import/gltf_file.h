/* glTF files that tests write into a folder of their own, and what the reader makes of them. */
#ifndef NOC_TEST_GLTF_FILE_H
#define NOC_TEST_GLTF_FILE_H

#include "mesh_file.h"

static inline void load(loaded *l, const char *name) {
    noc_import_params params = noc_import_default_params();
    load_with(l, &noc_reader_gltf, name, &params, &(mesh_place){ NULL, as_it_is });
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

static inline int set_up(void **state) { return make_mesh_folder(); }

static inline int tear_down(void **state) {
    static const char *const files[] = { "a.gltf", "a.glb", "b c.bin" };
    return remove_mesh_folder(files, NOC_COUNT(files));
}

#endif
