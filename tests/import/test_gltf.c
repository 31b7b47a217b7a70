/* glTF and GLB: containers, accessors, nodes, materials, lights, cameras. Expected values are from the
 * specifications: glTF 2.0, KHR_lights_punctual, KHR_materials_emissive_strength. */
#include "gltf_file.h"

#include <math.h>

/* ---- nodes and meshes ---- */

/* y up becomes z up: (x, y, z) is at (x, -z, y). A parent's rotation by 90 degrees about y takes x to -z and z to x. */
static void test_nodes(void **state) {
    loaded l;
    load_text(
        &l,
        file_text(PLAIN,
                  "\"scene\": 1, \"scenes\": [{\"nodes\": [2]}, {\"nodes\": [0, 3]}],"
                  "\"nodes\": [{\"children\": [1], \"translation\": [10, 20, 30], \"rotation\": [0, 0.70710678118, 0, "
                  "0.70710678118]}, {\"mesh\": 0, \"scale\": [2, 3, 1], \"name\": \"window\"}, {\"mesh\": 0},"
                  " {\"mesh\": 0, \"matrix\": [1,0,0,0, 0,1,0,0, 0,0,-1,0, 5,6,7,1]}],"));
    assert_string_equal(l.error, "");
    assert_int_equal(l.status, NOC_OK);
    assert_string_equal(l.format, "glTF");
    assert_int_equal(l.scene->meshes.len, 2); /* node 2 is in a scene that is not shown */
    assert_int_equal(l.scene->indices.len, 12);
    assert_string_equal(l.scene->meshes.data[0].name, "window");
    assert_place(&l, 0, 10, -30, 20);
    assert_place(&l, 1, 10, -28, 20); /* (2, 0, 0) turned to (0, 0, -2) */
    assert_place(&l, 2, 10, -28, 23);
    assert_place(&l, 4, 5, -7, 6);
    assert_place(&l, 5, 6, -7, 6);
    /* the second is mirrored: its winding is turned, so that it looks along -z still as its matrix says */
    const uint32_t *t = &l.scene->indices.data[6];
    const float *a = &l.scene->positions.data[3 * t[0]], *b = &l.scene->positions.data[3 * t[1]],
                *c = &l.scene->positions.data[3 * t[2]];
    double ny = (double)((b[2] - a[2]) * (c[0] - a[0]) - (b[0] - a[0]) * (c[2] - a[2]));
    assert_true(ny > 0); /* glTF's -z is our +y */
    unload(&l);
}

static void test_containers(void **state) {
    loaded l;
    char json[3000];
    unsigned char glb[4000] = "glTF\2\0\0\0";
    file_text("", "");
    int n =
        snprintf(json, sizeof(json),
                 ASSET PLAIN
                 "\"scenes\": [{\"nodes\": [0]}], \"nodes\": [{\"mesh\": 0}], \"buffers\": [{\"byteLength\": 60}]}");
    while (n % 4)
        json[n++] = ' ';
    uint32_t total = 12 + 8 + (uint32_t)n + 8 + BUFFER, length = (uint32_t)n, binary = BUFFER;
    memcpy(glb + 8, &total, 4); /* little-endian, as the machines that tests run on */
    memcpy(glb + 12, &length, 4);
    memcpy(glb + 16, "JSON", 4);
    memcpy(glb + 20, json, length);
    memcpy(glb + 20 + length, &binary, 4);
    memcpy(glb + 24 + length, "BIN", 4);
    memcpy(glb + 28 + length, bytes, BUFFER);
    write_file("a.glb", glb, total);
    load(&l, "a.glb");
    assert_string_equal(l.error, "");
    assert_string_equal(l.format, "GLB");
    assert_int_equal(l.scene->indices.len, 6);
    unload(&l);
    for (uint32_t cut = 4; cut < total; cut += 3) {
        write_file("a.glb", glb, cut);
        load(&l, "a.glb");
        assert_int_equal(l.status, NOC_ERR_FORMAT);
        assert_int_equal(l.errors, 1);
        assert_non_null(strstr(l.error, "a.glb"));
        unload(&l);
    }
    /* lengths that lie: of the file (more, then less than there is), and of its chunks */
    const struct {
        size_t at;
        uint32_t value;
    } lies[] = { { 8, total + 1 },
                 { 8, UINT32_MAX },
                 { 8, 0 },
                 { 8, total - 8 },
                 { 12, 0 },
                 { 12, length + 4 },
                 { 12, UINT32_MAX },
                 { 20 + length, BUFFER + 1 },
                 { 20 + length, UINT32_MAX - 2 } };
    for (size_t i = 0; i < NOC_COUNT(lies); i++) {
        unsigned char lying[sizeof(glb)];
        memcpy(lying, glb, sizeof(glb));
        memcpy(lying + lies[i].at, &lies[i].value, 4);
        write_file("a.glb", lying, total);
        load(&l, "a.glb");
        assert_int_equal(l.status, NOC_ERR_FORMAT);
        assert_int_equal(l.errors, 1);
        unload(&l);
    }
    glb[total] = 77; /* a byte behind the model is not the model's */
    write_file("a.glb", glb, total + 1);
    load(&l, "a.glb");
    assert_int_equal(l.scene->indices.len, 6);
    unload(&l);
    /* beside it, under a name with a blank */
    const char *text =
        ASSET PLAIN "\"scenes\": [{\"nodes\": [0]}], \"nodes\": [{\"mesh\": 0}], \"buffers\": [{\"byteLength\": 60, "
                    "\"uri\": \"b%20c.bin\"}]}";
    write_file("b c.bin", bytes, BUFFER);
    load_text(&l, text);
    assert_int_equal(l.scene->indices.len, 6);
    unload(&l);
    write_file("b c.bin", bytes, BUFFER - 1);
    load_text(&l, text);
    assert_int_equal(l.status, NOC_ERR_FORMAT);
    unload(&l);
    char path[300];
    snprintf(path, sizeof(path), "%s/b c.bin", folder);
    unlink(path);
    load_text(&l, text);
    assert_int_equal(l.status, NOC_ERR_IO);
    assert_int_equal(l.errors, 1);
    assert_non_null(strstr(l.error, "b c.bin"));
    unload(&l);
}

/* Normalised short integers 8 bytes apart, with one place put right by a sparse part; strips and fans turn the same
 * way. */
static void test_accessors(void **state) {
    static const int16_t places[4][4] = { { 0, 0, 0, 77 }, { 32767, 0, 0, 77 }, { 0, 32767, 0, 77 }, { 5, 5, 5, 77 } };
    static const int16_t right[3] = { 32767, 32767, 0 };
    unsigned char data[48] = { 0 };
    memcpy(data, places, 32);
    data[32] = 3; /* the sparse index, a byte */
    memcpy(data + 36, right, 6);
    memcpy(data + 44, (uint8_t[]){ 0, 1, 3, 2 }, 4);
    char text[2000];
    for (int mode = 5; mode <= 6; mode++) {
        loaded l;
        snprintf(text, sizeof(text),
                 ASSET
                 "\"bufferViews\": [{\"buffer\": 0, \"byteLength\": 32, \"byteStride\": 8}, {\"buffer\": 0, "
                 "\"byteOffset\": 32, \"byteLength\": 1}, {\"buffer\": 0, \"byteOffset\": 36, \"byteLength\": 6}, "
                 "{\"buffer\": 0, \"byteOffset\": 44, \"byteLength\": 4}],\"accessors\": [{\"bufferView\": 0, "
                 "\"componentType\": 5122, \"normalized\": true, \"count\": 4, \"type\": \"VEC3\","
                 " \"sparse\": {\"count\": 1, \"indices\": {\"bufferView\": 1, \"componentType\": 5121}, "
                 "\"values\": {\"bufferView\": 2}}}, {\"bufferView\": 3, \"componentType\": 5121, \"count\": 4, "
                 "\"type\": \"SCALAR\"}],\"meshes\": [{\"primitives\": [{\"attributes\": {\"POSITION\": 0}%s, "
                 "\"mode\": %d}]}],\"scenes\": [{\"nodes\": [0]}], \"nodes\": [{\"mesh\": 0}],"
                 "\"buffers\": [{\"byteLength\": 48, \"uri\": \"data:;base64,%s\"}]}",
                 mode == 6 ? ", \"indices\": 1" : "", mode, base64(data, 48));
        load_text(&l, text);
        assert_string_equal(l.error, "");
        assert_place(&l, 3, 1, 0, 1);
        assert_int_equal(l.scene->indices.len, 6);
        for (int t = 0; t < 2; t++) { /* all look along z, our -y */
            const uint32_t *v = &l.scene->indices.data[3 * t];
            const float *a = &l.scene->positions.data[3 * v[0]], *b = &l.scene->positions.data[3 * v[1]],
                        *c = &l.scene->positions.data[3 * v[2]];
            assert_float_equal((b[2] - a[2]) * (c[0] - a[0]) - (b[0] - a[0]) * (c[2] - a[2]), -1, 1e-4);
        }
        unload(&l);
    }
}

/* Alpha is what a surface takes of the light; glass of a transmission lets that share of what it does not reflect
 * through in its colour. */
static void test_transparency(void **state) {
    static const struct {
        const char *material;
        float transmittance;
        bool clamped;
    } rows[] = {
        { "\"alphaMode\": \"BLEND\", \"pbrMetallicRoughness\": {\"baseColorFactor\": [1, 1, 1, -1]}", 1, true },
        { "\"alphaMode\": \"MASK\", \"alphaCutoff\": 2", 0, true },
        { "\"pbrMetallicRoughness\": {\"baseColorFactor\": [1, 1, 1, 7]}", 0 },
        { "\"alphaMode\": \"BLEND\", \"pbrMetallicRoughness\": {\"baseColorFactor\": [1, 1, 1, 0.25]}", 0.75f },
        { "\"alphaMode\": \"OPAQUE\", \"pbrMetallicRoughness\": {\"baseColorFactor\": [1, 1, 1, 0.25]}", 0 },
        { "\"pbrMetallicRoughness\": {\"baseColorFactor\": [1, 1, 1, 0.25]}", 0 },
        { "\"alphaMode\": \"MASK\", \"pbrMetallicRoughness\": {\"baseColorFactor\": [1, 1, 1, 0.25]}", 1 },
        { "\"alphaMode\": \"MASK\", \"alphaCutoff\": 0.2, \"pbrMetallicRoughness\": {\"baseColorFactor\": "
          "[1, 1, 1, 0.25]}",
          0 },
        { "\"pbrMetallicRoughness\": {\"baseColorFactor\": [0.5, 0.5, 0.5, 1], \"metallicFactor\": 0}, "
          "\"extensions\": {\"KHR_materials_transmission\": {\"transmissionFactor\": 0.8}}",
          0.8f * 0.5f * 0.96f },
        { "\"pbrMetallicRoughness\": {\"baseColorFactor\": [1, 0.5, 0, 1], \"metallicFactor\": 0}, "
          "\"extensions\": {\"KHR_materials_transmission\": {\"transmissionFactor\": 1}}",
          (0.2126f + 0.5f * 0.7152f) * 0.96f },
        { "\"pbrMetallicRoughness\": {\"baseColorFactor\": [0.5, 0.5, 0.5, 1]}, "
          "\"extensions\": {\"KHR_materials_transmission\": {\"transmissionFactor\": 1}}",
          0 }, /* metallicFactor is 1 */
        { "\"pbrMetallicRoughness\": {\"baseColorFactor\": [0.5, 0.5, 0.5, 1], \"metallicFactor\": 0.25}, "
          "\"extensions\": {\"KHR_materials_transmission\": {\"transmissionFactor\": 1}}",
          0.75f * 0.5f * 0.96f },
        { "\"alphaMode\": 7, \"pbrMetallicRoughness\": {\"baseColorFactor\": [1, 1, 1, 0.25]}", 0 },
        { "\"alphaMode\": \"BLEND\", \"emissiveFactor\": [1, 1, 1], \"pbrMetallicRoughness\": "
          "{\"baseColorFactor\": [1, 1, 1, 0.25]}",
          0 },
    };
    for (size_t i = 0; i < NOC_COUNT(rows); i++) {
        loaded l;
        char *text = noc_format(
            "\"meshes\": [{\"primitives\": [{\"attributes\": {\"POSITION\": 0}, \"indices\": 1, \"material\": 0}]}], "
            "\"materials\": [{%s}],\"scenes\": [{\"nodes\": [0]}], \"nodes\": [{\"mesh\": 0}],",
            rows[i].material);
        load_text(&l, file_text(VIEWS ACCESSORS, text));
        assert_string_equal(l.error, "");
        assert_float_equal(l.scene->materials.data[0].transmittance, rows[i].transmittance, 1e-6);
        assert_false(l.scene->materials.data[0].cutout);
        assert_int_equal(skipped_count(&l, "alpha mode that is not known"), strstr(rows[i].material, "7,") != NULL);
        assert_int_equal(skipped_count(&l, "out of range, clamped"), rows[i].clamped);
        assert_int_equal(skipped_count(&l, "transparent material that emits"), i + 1 == NOC_COUNT(rows));
        assert_int_equal(skipped_count(&l, "glass that is a metal by its metallicFactor"),
                         strstr(rows[i].material, "0.25}, \"ext") || strstr(rows[i].material, "1]}, \"ext"));
        assert_int_equal(skipped_count(&l, "coloured glass"), strstr(rows[i].material, "0.5, 0, 1") != NULL);
        unload(&l);
        free(text);
    }
}

static void test_materials(void **state) {
    loaded l;
    load_text(
        &l,
        file_text(
            VIEWS ACCESSORS,
            "\"meshes\": [{\"primitives\": [{\"attributes\": {\"POSITION\": 0}, \"indices\": 1, \"material\": 0},"
            " {\"attributes\": {\"POSITION\": 0}, \"indices\": 1, \"material\": 1}, "
            "{\"attributes\": {\"POSITION\": 0}, \"indices\": 1, \"material\": 2},"
            " {\"attributes\": {\"POSITION\": 0}, \"mode\": 1}]}],"
            "\"materials\": [{\"emissiveFactor\": [1, 0.5, 0.25], "
            "\"extensions\": {\"KHR_materials_emissive_strength\": {\"emissiveStrength\": 800}},"
            " \"doubleSided\": true, \"pbrMetallicRoughness\": {\"baseColorFactor\": [0.2, 0.4, 0.6, 1], "
            "\"metallicFactor\": 0, \"roughnessFactor\": 0.3}}, {\"pbrMetallicRoughness\": {\"baseColorFactor\": [0.5, "
            "0.5, 0.5, 1]}}, {\"emissiveFactor\": [1, 1, 1], \"emissiveTexture\": {\"index\": 0}, "
            "\"alphaMode\": \"BLEND\"}],\"scenes\": [{\"nodes\": [0]}], \"nodes\": [{\"mesh\": 0}],"));
    assert_string_equal(l.error, "");
    assert_int_equal(l.scene->meshes.len, 3); /* lines are left out */
    const noc_material *m = l.scene->materials.data;
    assert_float_equal(m[0].emission[0], 800, 1e-3);
    assert_float_equal(m[0].emission[2], 200, 1e-3);
    assert_true(m[0].two_sided);
    assert_float_equal(m[0].albedo[1], .4, 1e-6);
    assert_float_equal(m[0].roughness, .3, 1e-6);
    assert_float_equal(m[0].f0, .04, 1e-6);
    /* a metal by default: no diffuse part, and its colour in the lobe */
    assert_float_equal(m[1].albedo[0], 0, 1e-6);
    assert_float_equal(m[1].f0, .5, 1e-6);
    assert_false(m[1].two_sided);
    assert_float_equal(m[2].emission[0], 0, 0);
    assert_int_equal(skipped_count(&l, "emission by a texture"), 1);
    assert_true(m[2].transmittance == 0 && !m[2].cutout); /* its alpha is 1 */
    assert_int_equal(noc_scene_commit(l.scene), NOC_OK);
    assert_int_equal(l.scene->lights.len, 2);
    for (int i = 0; i < 2; i++)
        assert_int_equal(l.scene->lights.data[i].flags & LIGHT_TWO_SIDED,
                         LIGHT_TWO_SIDED); /* double-sided: both sides shine */
    unload(&l);
}

/* ---- lights ---- */

static void test_lights(void **state) {
    loaded l;
    load_text(
        &l,
        file_text(
            PLAIN,
            "\"extensions\": {\"KHR_lights_punctual\": {\"lights\": ["
            "{\"type\": \"spot\", \"intensity\": 300, \"color\": [1, 0.5, 0.25], \"spot\": {\"innerConeAngle\": 0.3, "
            "\"outerConeAngle\": 0.6}},{\"type\": \"point\", \"intensity\": 40}, {\"type\": \"directional\", "
            "\"intensity\": 9}, {\"type\": \"blob\"}]}},\"scenes\": [{\"nodes\": [0, 1, 2, 3, 4, 5]}], \"nodes\": ["
            "{\"translation\": [1, 5, 2], \"rotation\": [-0.70710678118, 0, 0, 0.70710678118], "
            "\"extensions\": {\"KHR_lights_punctual\": {\"light\": 0}}},"
            "{\"translation\": [9, 5, 2], \"scale\": [3, 3, 3], "
            "\"extensions\": {\"KHR_lights_punctual\": {\"light\": 0}}},"
            "{\"translation\": [0, 7, -1], \"extensions\": {\"KHR_lights_punctual\": {\"light\": 1}}},"
            "{\"name\": \"sun\", \"extensions\": {\"KHR_lights_punctual\": {\"light\": 2}}},"
            "{\"extensions\": {\"KHR_lights_punctual\": {\"light\": 3}}}, "
            "{\"extensions\": {\"KHR_lights_punctual\": {\"light\": 77}}}],"));
    assert_string_equal(l.error, "");
    assert_int_equal(l.scene->lights.len, 3); /* two nodes share the first: it shines twice */
    assert_int_equal(skipped_count(&l, "directional light"), 1);
    assert_int_equal(skipped_count(&l, "unknown type"), 1);
    assert_int_equal(skipped_count(&l, "not there"), 1);
    assert_int_equal(l.scene->indices.len, 0); /* punctual: nothing of them is seen */
    /* -z of glTF is our +y; the first is turned to look down */
    const double axes[2][3] = { { 0, 0, -1 }, { 0, 1, 0 } };
    int spots = 0, points = 0;
    for (size_t i = 0; i < 3; i++) {
        noc_light_info info;
        assert_int_equal(noc_scene_get_light(l.scene, i, &info), NOC_OK);
        if (info.light.kind == NOC_LIGHT_POINT) {
            points++;
            assert_float_equal(info.light.emission[1], 40, 1e-4); /* cd */
            assert_float_equal(info.centre[1], 1, 1e-5);
            assert_float_equal(info.centre[2], 7, 1e-5);
            continue;
        }
        spots++;
        assert_int_equal(info.light.kind, NOC_LIGHT_SPOT);
        assert_float_equal(info.light.emission[0], 300, 1e-3); /* cd, whatever the node's scale */
        assert_float_equal(info.light.emission[2], 75, 1e-3);
        assert_float_equal(info.light.inner_deg, .3 * 180 / M_PI, 1e-4);
        assert_float_equal(info.light.outer_deg, .6 * 180 / M_PI, 1e-4);
        for (int k = 0; k < 3; k++)
            assert_float_equal(info.light.direction[k], axes[info.centre[0] > 5][k], 1e-6);
    }
    assert_int_equal(points, 1);
    assert_int_equal(spots, 2);
    unload(&l);
}

/* What the extension's numbers do not allow is limited and counted; what it leaves out has its defaults, 0 and 45
 * degrees. */
static void test_cones(void **state) {
    static const struct {
        const char *spot;
        double inner, outer;
        size_t limited;
    } cases[] = {
        { "", 0, 45, 0 },
        { ", \"spot\": {\"outerConeAngle\": 1.5707963267948966}", 0, 90, 0 },
        { ", \"spot\": {\"innerConeAngle\": 0.5, \"outerConeAngle\": 0.4}", .4 * 180 / M_PI, .4 * 180 / M_PI, 1 },
        { ", \"spot\": {\"innerConeAngle\": -1, \"outerConeAngle\": 3}", 0, 90, 1 },
        { ", \"spot\": {\"outerConeAngle\": 0.001}", 0, 1, 0 },
    };
    for (size_t i = 0; i < NOC_COUNT(cases); i++) {
        loaded l;
        char *text = noc_format("\"extensions\": {\"KHR_lights_punctual\": {\"lights\": [{\"type\": \"spot\"%s}]}},"
                                "\"scenes\": [{\"nodes\": [0]}],"
                                "\"nodes\": [{\"extensions\": {\"KHR_lights_punctual\": {\"light\": 0}}}],",
                                cases[i].spot);
        load_text(&l, file_text(PLAIN, text));
        assert_string_equal(l.error, "");
        noc_light_info info;
        assert_int_equal(noc_scene_get_light(l.scene, 0, &info), NOC_OK);
        assert_float_equal(info.light.inner_deg, cases[i].inner, 1e-4);
        assert_float_equal(info.light.outer_deg, cases[i].outer, 1e-4);
        assert_int_equal(skipped_count(&l, "cones of a spot light"), cases[i].limited);
        unload(&l);
        free(text);
    }
}

static void test_camera(void **state) {
    loaded l;
    load_text(
        &l, file_text(
                PLAIN,
                "\"cameras\": [{\"type\": \"perspective\", \"perspective\": {\"yfov\": 0.7853981634}}],"
                "\"scenes\": [{\"nodes\": [0, 1]}], \"nodes\": [{\"mesh\": 0}, {\"camera\": 0, \"translation\": [1, 2, "
                "3]}],"));
    noc_camera c;
    assert_int_equal(noc_scene_camera(l.scene, NOC_VIEWPOINT_OWN, 1.5, &c), NOC_OK);
    assert_float_equal(c.fov_deg, 45, 1e-6);
    assert_float_equal(c.eye[0], 1, 1e-9);
    assert_float_equal(c.eye[1], -3, 1e-9);
    assert_float_equal(c.eye[2], 2, 1e-9);
    assert_true(c.target[1] > c.eye[1]); /* along glTF's -z */
    assert_float_equal(c.up[2], 1, 1e-9);
    unload(&l);
}

/* Without scenes all is shown, each node once; a chain of 10,000 nodes is as good as one. */
static void test_roots(void **state) {
    enum { DEPTH = 10000 };
    loaded l;
    load_text(&l,
              file_text(PLAIN,
                        "\"nodes\": [{\"mesh\": 0}, {\"children\": [0], \"translation\": [1, 0, 0]}, {\"mesh\": 0}],"));
    assert_int_equal(l.scene->meshes.len, 2);
    /* the material that PLAIN names without having one; nothing else */
    assert_int_equal(geo_issues_count(l.issues), 1);
    unload(&l);
    char *nodes = malloc(64 * DEPTH), *text = malloc(64 * DEPTH + 8000), *to = nodes;
    if (!nodes || !text) {
        fail();
        return;
    }
    for (int i = 0; i < DEPTH; i++)
        to += sprintf(to, "{\"children\": [%d], \"translation\": [0.5, 0, 0]}, ", i + 1);
    const char *plain = file_text(PLAIN, ""), *rest = strstr(plain, VIEWS);
    sprintf(text, ASSET "\"scenes\": [{\"nodes\": [0]}], \"nodes\": [%s{\"mesh\": 0}], %s", nodes, rest);
    load_text(&l, text);
    assert_string_equal(l.error, "");
    assert_place(&l, 0, DEPTH / 2, 0, 0);
    unload(&l);
    free(nodes);
    free(text);
}

static void test_probe(void **state) {
    static const char *const yes[] = { "glTF\2\0\0\0........", " {\"asset\": {\"version\": \"2.0\"}}",
                                       "{\"scenes\": [], \"nodes\": [" };
    static const char *const no[] = { "", "glTF", "{\"type\": \"FeatureCollection\", \"asset\": 1}",
                                      "{\"type\": \"CityJSON\", \"asset\": 1}", "{\"elements\": []}" };
    for (size_t i = 0; i < NOC_COUNT(yes); i++)
        assert_true(noc_reader_gltf.probe(yes[i], i ? strlen(yes[i]) : 16));
    for (size_t i = 0; i < NOC_COUNT(no); i++)
        assert_false(noc_reader_gltf.probe(no[i], strlen(no[i])));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_nodes),        cmocka_unit_test(test_containers), cmocka_unit_test(test_accessors),
        cmocka_unit_test(test_transparency), cmocka_unit_test(test_materials),  cmocka_unit_test(test_lights),
        cmocka_unit_test(test_cones),        cmocka_unit_test(test_camera),     cmocka_unit_test(test_probe),
        cmocka_unit_test(test_roots),
    };
    return cmocka_run_group_tests_name("import/gltf", tests, set_up, tear_down);
}
