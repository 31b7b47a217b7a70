/* Materials by the names that files give them: found, set as params and recipes say, and kept by a built city. */
#include "looks.h"

#include <nocturne/built.h>
#include <nocturne/recipe.h>

#define QUAD "v 0 0 0\nv 5 0 0\nv 5 5 0\nv 0 5 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"

static const char gltf[] =
    "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":{"
    "\"POSITION\":0},\"material\":0,\"mode\":6}]}],\"materials\":[{\"name\":\"brick\",\"pbrMetallicRoughness\":{"
    "\"metallicFactor\":0,\"roughnessFactor\":0.5}}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,"
    "\"count\":4,\"type\":\"VEC3\"}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":48}],\"buffers\":[{"
    "\"byteLength\":48,\"uri\":\"quad.bin\"}]}";
static const char json[] =
    "{\"type\":\"CityJSON\",\"version\":\"2.0\",\"transform\":{\"scale\":[1,1,1],\"translate\":[0,0,0]},"
    "\"appearance\":{\"materials\":[{\"name\":\"brick\",\"diffuseColor\":[1,0,0]},{\"name\":\"plain\"}]},"
    "\"CityObjects\":{\"b\":{\"type\":\"Building\",\"geometry\":[{\"type\":\"MultiSurface\",\"lod\":\"2\","
    "\"boundaries\":[[[0,1,2,3]],[[4,5,6,7]],[[0,4,5]]],\"semantics\":{\"surfaces\":[{\"type\":\"WallSurface\"},"
    "{\"type\":\"RoofSurface\"}],\"values\":[0,0,1]},\"material\":{\"t\":{\"values\":[0,1,0]}}}]}},"
    "\"vertices\":[[0,0,0],[0,5,0],[0,5,5],[0,0,5],[3,0,0],[3,5,0],[3,5,5],[3,0,5]]}";
static const char gml[] = GML_WALL("<app:X3DMaterial gml:id='brick'><app:diffuseColor>1 0 0</app:diffuseColor>"
                                   "<app:target>#p</app:target></app:X3DMaterial>");

static void write_files(void) {
    static const float quad[12] = { 0, 0, 0, 5, 0, 0, 5, 5, 0, 0, 5, 0 };
    write_image("one.png");
    write_bytes("quad.bin", quad, sizeof(quad));
    write_file("one.gltf", gltf);
    write_file("one.json", json);
    write_file("one.gml", gml);
    write_file("one.mtl", "newmtl brick\nKd .5 .5 .5\nmap_Kd one.png\nnewmtl other\n");
    write_file("one.obj", "mtllib one.mtl\n" QUAD "usemtl brick\nf 1/1 2/2 3/3 4/4\n");
}

static size_t count_named(const noc_scene *s, const char *name) {
    size_t count = 0;
    for (int i = -1; (i = noc_scene_find_material(s, name, i + 1)) >= 0; count++)
        ;
    return count;
}

static void test_formats(void **state) {
    (void)state;
    static const char *const files[] = { "one.gml", "one.json", "one.gltf", "one.obj" };
    write_files();
    for (size_t i = 0; i < 2 * NOC_COUNT(files); i++) {
        noc_import_params p = looks_params(true);
        const noc_named_material named[] = { { "brick", { .1f, .2f, .3f }, -1, .25f, -1 },
                                             { "nobody", { -1, -1, -1 }, -1, -1, -1 } };
        p.isolate = i % 2;
        noc_scene *plain = load_by(files[i / 2], &p, NULL);
        size_t count = i / 2 == 1 ? 2 : 1; /* of a wall and of a roof */
        assert_int_equal(count_named(plain, "brick"), count);
        const char *name;
        noc_material was, is;
        int at = noc_scene_find_material(plain, "brick", 0);
        assert_int_equal(noc_scene_get_material(plain, at, &was, &name), NOC_OK);
        assert_string_equal(name, "brick");
        assert_int_equal(was.texture, i / 2 == 3);
        noc_scene_destroy(plain);
        p.named_materials = named;
        p.named_material_count = 2;
        noc_scene *s = load_by(files[i / 2], &p, NULL);
        for (at = -1; (at = noc_scene_find_material(s, "brick", at + 1)) >= 0;) {
            assert_int_equal(noc_scene_get_material(s, at, &is, NULL), NOC_OK);
            assert_true(is.albedo[1] == .2f && is.roughness == .25f && !is.texture && (count > 1 || is.f0 == was.f0));
        }
        /* at run time */
        at = noc_scene_find_material(s, "brick", 0);
        assert_int_equal(noc_scene_get_material(s, at, &is, NULL), NOC_OK);
        is = noc_material_metal(&is, 1);
        assert_int_equal(noc_scene_set_material(s, at, &is), NOC_OK);
        assert_int_equal(noc_scene_commit(s), NOC_OK);
        assert_int_equal(noc_scene_get_material(s, at, &is, NULL), NOC_OK);
        assert_true(fabsf(is.f0 - (.2126f * .1f + .7152f * .2f + .0722f * .3f)) < 1e-6f && is.albedo[2] == 0);
        assert_int_equal(noc_scene_name_material(s, at, "other"), NOC_OK);
        assert_true(noc_scene_find_material(s, "other", 0) == at && count_named(s, "brick") == count - 1);
        assert_true(noc_scene_name_material(s, -1, "x") != NOC_OK && noc_scene_name_material(s, 99999, "x") != NOC_OK);
        assert_true(noc_scene_get_material(s, 99999, &is, NULL) != NOC_OK && noc_scene_find_material(s, "", 0) == -1);
        noc_scene_destroy(s);
    }
}

/* What is not told stays as the file has it: its image, too, which comes after all surfaces. */
static void test_some(void **state) {
    (void)state;
    const noc_named_material named[] = { { "brick", { -1, -1, -1 }, -1, .25f, -1 },
                                         { "brick", { -1, -1, -1 }, .1f, -1, -1 } };
    noc_import_params p = looks_params(true);
    write_files();
    noc_scene *plain = load_by("one.obj", &p, NULL);
    p.named_materials = named;
    p.named_material_count = 2;
    noc_scene *s = load_by("one.obj", &p, NULL);
    noc_material was, is;
    assert_int_equal(noc_scene_get_material(plain, noc_scene_find_material(plain, "brick", 0), &was, NULL), NOC_OK);
    assert_int_equal(noc_scene_get_material(s, noc_scene_find_material(s, "brick", 0), &is, NULL), NOC_OK);
    assert_true(was.texture && is.texture == was.texture && is.albedo[0] == .5f && was.albedo[0] == .5f);
    assert_true(is.roughness == .25f && is.f0 == .1f && was.roughness != .25f);
    noc_scene_destroy(plain);
    noc_scene_destroy(s);
}

/* A name that no input gives is told, with those that there are. */
static void warn(void *user, noc_log_level level, const char *text) {
    if (level == NOC_LOG_WARN && strstr(text, "\"nobody\"; there are \"brick\", \"plain\""))
        ++*(int *)user;
}

static void test_unknown(void **state) {
    (void)state;
    int told_ = 0;
    const noc_named_material named = { "nobody", { -1, -1, -1 }, -1, -1, -1 };
    noc_import_params p = looks_params(true);
    noc_log *log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_WARN, .message = warn, .user = &told_ });
    noc_scene *s = noc_scene_create(log);
    p.named_materials = &named;
    p.named_material_count = 1;
    write_files();
    assert_int_equal(noc_scene_load(s, (const char *[]){ in_folder("one.json") }, 1, &p, NULL), NOC_OK);
    assert_int_equal(told_, 1);
    noc_scene_destroy(s);
    noc_log_destroy(log);
}

static void test_built(void **state) {
    (void)state;
    write_files();
    noc_scene *s = load("one.json", true, NULL);
    assert_int_equal(noc_scene_save(s, in_folder("one.noct"), NULL), NOC_OK);
    noc_scene *again = load("one.noct", true, NULL);
    assert_int_equal(noc_scene_find_material(again, "brick", 0), noc_scene_find_material(s, "brick", 0));
    assert_int_equal(count_named(again, "brick"), 2);
    assert_int_equal(count_named(again, "plain"), 1);
    noc_scene_destroy(s);
    noc_scene_destroy(again);
}

static void test_recipe(void **state) {
    (void)state;
    static const struct {
        const char *text, *error;
    } wrong[] = { { "a: { roughness: 2 }", "roughness .05 to 1" },
                  { "a: { albedo: -0.5 }", "0 to 1" },
                  { "a: { metalness: 1, f0: .5 }", "the same thing" },
                  { "a: { glow: 1 }", "no key glow" } };
    noc_recipe *recipe;
    noc_import_params p = looks_params(true);
    write_files();
    write_file("r.yaml", "nocturne: 1\ninputs: one.json\nmaterials-by-name:\n  brick: { albedo: .5, metalness: .25 }\n"
                         "  'a b': { roughness: .5 }\nmaterials: { water: { metalness: 1 } }\n");
    assert_int_equal(noc_recipe_load(in_folder("r.yaml"), NULL, &recipe), NOC_OK);
    const noc_recipe_info *info = noc_recipe_get_info(recipe);
    assert_int_equal(info->named_material_count, 2);
    const noc_named_material *m = info->named_materials;
    assert_true(!strcmp(m[0].name, "brick") && m[0].albedo[2] == .5f && m[0].f0 < 0 && m[0].metalness == .25f);
    assert_true(!strcmp(m[1].name, "a b") && m[1].albedo[0] < 0 && m[1].roughness == .5f && m[1].metalness < 0);
    assert_true(info->materials[0].albedo[0] == 0 && info->materials[0].f0 > 0.02f);
    noc_recipe_lists(recipe, &p);
    noc_scene *s = load_by("one.json", &p, NULL);
    noc_material is;
    assert_int_equal(noc_scene_get_material(s, noc_scene_find_material(s, "brick", 0), &is, NULL), NOC_OK);
    assert_true(fabsf(is.albedo[0] - .375f) < 1e-6f && fabsf(is.f0 - (.04f + .25f * .46f)) < 1e-6f);
    noc_scene_destroy(s);
    noc_recipe_destroy(recipe);
    for (size_t i = 0; i < NOC_COUNT(wrong); i++) {
        noc_log *log = noc_log_create(NULL);
        char *text = noc_format("nocturne: 1\ninputs: one.json\nmaterials-by-name:\n  %s\n", wrong[i].text);
        write_file("r.yaml", text);
        free(text);
        assert_int_equal(noc_recipe_load(in_folder("r.yaml"), log, &recipe), NOC_ERR_FORMAT);
        if (!strstr(noc_log_last_error(log), wrong[i].error) || !strstr(noc_log_last_error(log), "r.yaml:4"))
            fail_msg("%s", noc_log_last_error(log));
        noc_log_destroy(log);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_formats), cmocka_unit_test(test_some),   cmocka_unit_test(test_unknown),
        cmocka_unit_test(test_built),   cmocka_unit_test(test_recipe),
    };
    return run_looks(tests, NOC_COUNT(tests));
}
