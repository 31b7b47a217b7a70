/* What is wrong in glTF files: errors, what is left out and told, files that are cut or changed. */
#include "gltf_file.h"

static void test_bad(void **state) {
    static const struct {
        const char *text;
        const char *says;
    } bad[] = {
        { "{\"asset\": {\"version\": \"1.0\"}}", "version 1.0" },
        { "{\"asset\": 3}", "version none" },
        { "{\"asset\": {\"version\": \"2.0\"}, \"extensionsRequired\": [\"KHR_draco_mesh_compression\"]}",
          "KHR_draco_mesh_compression" },
        { "{\"asset\": {\"version\": \"2.0\"},\n \"meshes\": [}", "a.gltf:2" },
        { ASSET "\"buffers\": [{\"byteLength\": 4, \"uri\": \"data:;base64,AA==\"}]}", "fewer than it says" },
        { ASSET "\"buffers\": [{\"byteLength\": 4, \"uri\": \"data:;base64,*!AAAA\"}]}", "not base64" },
        { ASSET "\"buffers\": [{\"byteLength\": 4, \"uri\": \"data:text/plain,AAAA\"}]}", "not base64" },
        { ASSET "\"buffers\": [{\"byteLength\": 4, \"uri\": \"https://example.org/a.bin\"}]}", "network" },
        { ASSET
          "\"meshes\": [{\"primitives\": [{\"attributes\": {\"POSITION\": 9}}]}], \"scenes\": [{\"nodes\": [0]}], "
          "\"nodes\": [{\"mesh\": 0}]}",
          "accessor 9" },
        { ASSET
          "\"accessors\": [{\"componentType\": 5126, \"count\": 4000000000, \"type\": \"VEC3\"}],"
          "\"meshes\": [{\"primitives\": [{\"attributes\": {\"POSITION\": 0}}]}], \"scenes\": [{\"nodes\": [0]}], "
          "\"nodes\": [{\"mesh\": 0}]}",
          "accessor 0" },
        /* some bytes that ask for 24 GB of zeros */
        { ASSET
          "\"accessors\": [{\"componentType\": 5126, \"count\": 1000000000, \"type\": \"VEC3\", "
          "\"sparse\": {\"count\": 1, \"indices\": {\"bufferView\": 0, \"componentType\": 5121}, "
          "\"values\": {\"bufferView\": 0}}}],\"meshes\": [{\"primitives\": [{\"attributes\": {\"POSITION\": 0}}]}], "
          "\"scenes\": [{\"nodes\": [0]}], \"nodes\": [{\"mesh\": 0}]}",
          "without data" },
        { ASSET "\"buffers\": [{\"uri\": \"data:;base64,AAAA\"}]}", "does not say its byteLength" },
        { ASSET "\"buffers\": [{\"byteLength\": 4, \"uri\": \"none.bin\"}]}",
          "none.bin\" cannot be read: No such file" },
        { ASSET "\"buffers\": [{\"byteLength\": 4, \"uri\": \".\"}]}", "not a regular file" },
        { ASSET "\"buffers\": [{\"byteLength\": 4, \"uri\": \"\"}]}", "\" cannot be read" },
        { ASSET "\"meshes\": [{\"primitives\": [{\"attributes\": {\"POSITION\": 0}, \"mode\": -1}]}], "
                "\"scenes\": [{\"nodes\": [0]}], \"nodes\": [{\"mesh\": 0}]}",
          "mode" },
    };
    for (size_t i = 0; i < NOC_COUNT(bad); i++) {
        loaded l;
        load_text(&l, bad[i].text);
        assert_int_not_equal(l.status, NOC_OK);
        assert_int_equal(l.errors, 1);
        assert_non_null(strstr(l.error, bad[i].says));
        assert_non_null(strstr(l.error, "a.gltf"));
        unload(&l);
    }
    loaded l; /* one element too many for the view */
    char *text = file_text(PLAIN, "\"scenes\": [{\"nodes\": [0]}], \"nodes\": [{\"mesh\": 0}],");
    *strstr(text, "6, \"type\": \"SCALAR\"") = '7';
    load_text(&l, text);
    assert_int_equal(l.status, NOC_ERR_FORMAT);
    assert_non_null(strstr(l.error, "beyond"));
    unload(&l);
}

/* Bad faces, and nodes in a ring, cost themselves alone. */
static void test_skipped(void **state) {
    loaded l;
    file_text(PLAIN, "");
    char *text =
        file_text(PLAIN,
                  "\"scenes\": [{\"nodes\": [0, 0, 99]}], \"nodes\": [{\"mesh\": 0, \"children\": [1]}, {\"mesh\": 0, "
                  "\"children\": [0, 1]}],");
    uint16_t wrong = 4;
    memcpy(bytes + sizeof(square) + 2 * 5, &wrong, 2); /* the last corner of the second triangle */
    char *payload = strstr(text, "base64,") + 7;
    memcpy(payload, base64(bytes, BUFFER), strlen(base64(bytes, BUFFER)));
    load_text(&l, text);
    assert_string_equal(l.error, "");
    assert_int_equal(l.status, NOC_OK);
    assert_int_equal(l.scene->indices.len, 6);
    assert_int_equal(skipped_count(&l, "vertex that is not there"), 2);
    assert_int_equal(skipped_count(&l, "two places"), 3);
    assert_int_equal(skipped_count(&l, "node that is not there"), 1);
    unload(&l);
}

/* What is not as it should be is told, and the rest is there. */
static void test_told(void **state) {
    loaded l;
    load_text(
        &l,
        file_text(
            PLAIN,
            "\"extensions\": {\"KHR_lights_punctual\": {\"lights\": ["
            "{\"type\": \"point\", \"intensity\": -40}, {\"type\": \"spot\", \"spot\": {\"innerConeAngle\": 0.6, "
            "\"outerConeAngle\": 0.3}},{\"type\": \"spot\", \"spot\": {\"outerConeAngle\": 3}}, {\"type\": \"point\", "
            "\"intensity\": 0}]}},\"cameras\": [{\"type\": \"orthographic\"}, {\"perspective\": {\"yfov\": 3.1}}, "
            "{\"perspective\": {\"yfov\": 0.5}}], \"scene\": 3,\"scenes\": [{\"nodes\": [0, \"a\", 0.5, 1, 2, 3, 4, 5, "
            "6, 7, 8, 9]}], \"nodes\": [{\"mesh\": 0, \"scale\": [2, 2]}, {\"mesh\": 5},"
            "{\"extensions\": {\"KHR_lights_punctual\": {\"light\": 0}}}, "
            "{\"extensions\": {\"KHR_lights_punctual\": {\"light\": 1}}},"
            "{\"extensions\": {\"KHR_lights_punctual\": {\"light\": 2}}}, "
            "{\"extensions\": {\"KHR_lights_punctual\": {\"light\": 3}}},"
            "{\"camera\": 0}, {\"camera\": 1}, {\"camera\": 2, \"scale\": [0, 0, 0]}, {\"camera\": 7}],"));
    assert_string_equal(l.error, "");
    assert_int_equal(l.scene->lights.len, 2); /* the spot lights; one that is off is none */
    assert_place(&l, 1, 1, 0, 0);
    assert_int_equal(skipped_count(&l, "scene that is not there"), 1);
    assert_int_equal(skipped_count(&l, "node that is not there"), 2);
    assert_int_equal(skipped_count(&l, "part of a transform"), 1);
    assert_int_equal(skipped_count(&l, "mesh that is not there"), 1);
    assert_int_equal(skipped_count(&l, "material that is not there"), 1);
    assert_int_equal(skipped_count(&l, "negative intensity"), 1);
    assert_int_equal(skipped_count(&l, "cones of a spot light"), 2);
    assert_int_equal(skipped_count(&l, "camera without perspective"), 1);
    assert_int_equal(skipped_count(&l, "camera that looks nowhere"), 2);
    assert_int_equal(skipped_count(&l, "camera that is not there"), 1);
    assert_true(l.scene->own_camera.fov_deg == 0);
    unload(&l);
}

/* Cut, and with bytes changed: an error, once, or a scene; never a crash. */
static void test_broken(void **state) {
    char whole[8000];
    snprintf(
        whole, sizeof(whole), "%s",
        file_text(
            PLAIN,
            "\"extensions\": {\"KHR_lights_punctual\": {\"lights\": [{\"type\": \"spot\", "
            "\"spot\": {\"innerConeAngle\": 0.3}}, {\"type\": \"point\"}]}},"
            "\"cameras\": [{\"perspective\": {\"yfov\": 0.8}}], \"materials\": [{\"emissiveFactor\": [9, 8, 7]}], "
            "\"scenes\": [{\"nodes\": [0, 2]}],\"nodes\": [{\"mesh\": 0, \"children\": [1], \"scale\": [2, 3, 4]}, "
            "{\"mesh\": 0, \"extensions\": {\"KHR_lights_punctual\": {\"light\": 0}}},"
            " {\"camera\": 0, \"rotation\": [0, 1, 0, 0], "
            "\"extensions\": {\"KHR_lights_punctual\": {\"light\": 1}}}],"));
    uint32_t seed = 7;
    int read = 0, refused = 0;
    for (int i = 0; i < 1500; i++) {
        static const char digits[] = "0123456789-.e\",[]{}";
        char text[8000];
        loaded l;
        memcpy(text, whole, sizeof(whole));
        size_t size = strlen(text);
        for (int k = 0; k < 1 + i % 4; k++) {
            seed = seed * 1664525u + 1013904223u;
            text[(seed >> 8) % size] = i % 3 ? digits[(seed >> 4) % (sizeof(digits) - 1)] : (char)(seed >> 3);
        }
        write_file("a.gltf", text, i % 10 ? size : size * (size_t)(i % 97) / 97 + 1);
        load(&l, "a.gltf");
        assert_int_equal(l.errors, l.status != NOC_OK);
        if (!l.status && l.scene->indices.len)
            assert_int_equal(noc_scene_commit(l.scene), NOC_OK);
        read += !l.status;
        refused += l.status != NOC_OK;
        unload(&l);
    }
    assert_true(read > 100 && refused > 100); /* both ways were gone */
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bad),
        cmocka_unit_test(test_skipped),
        cmocka_unit_test(test_told),
        cmocka_unit_test(test_broken),
    };
    return cmocka_run_group_tests_name("import/gltf_wrong", tests, set_up, tear_down);
}
