/* Memory that is refused while a scene is made: every allocation of what adds to it, commits it, and looks at it, alone
 * and with all later ones. The scene is out of memory then, says so once, and is destroyed as any other. */
#include "../memory.h"

#include "city/city.h"
#include "scene/scene.h"

#include <math.h>

static bool same(const noc_scene *a, const noc_scene *b) {
    return a->positions.len == b->positions.len && a->indices.len == b->indices.len && a->lights.len == b->lights.len &&
           !memcmp(a->positions.data, b->positions.data, a->positions.len * sizeof(float)) &&
           !memcmp(a->indices.data, b->indices.data, a->indices.len * sizeof(uint32_t)) &&
           !memcmp(a->lights.data, b->lights.data, a->lights.len * sizeof(noc_light_record));
}

typedef noc_status work_fn(noc_scene *scene);

/* Creates a scene, has it filled, commits it. */
static noc_status build(noc_log *log, work_fn *work, noc_scene **scene) {
    *scene = noc_scene_create(log);
    noc_status status = *scene ? work(*scene) : NOC_ERR_MEMORY;
    noc_status committed = *scene ? noc_scene_commit(*scene) : NOC_ERR_MEMORY;
    if (status == NOC_ERR_MEMORY)
        assert_int_equal(committed, NOC_ERR_MEMORY);
    return committed;
}

static void refuse_each(const char *what, work_fn *work) {
    noc_log *log = counting_log();
    noc_scene *whole, *scene;
    bool reached;
    assert_int_equal(build(NULL, work, &whole), NOC_OK);
    FOR_EACH_REFUSAL(reached) {
        begin_refusal(n, later);
        noc_status status = build(log, work, &scene);
        reached = end_refusal();
        if (status == NOC_OK)
            assert_unharmed(same(scene, whole), what);
        else
            assert_refused(status, what);
        assert_true(status == NOC_OK || reached);
        noc_scene_destroy(scene);
    }
    noc_scene_destroy(whole);
    noc_log_destroy(log);
}

static int material(noc_scene *s, noc_class cls) {
    noc_material m = noc_class_material(cls);
    return noc_scene_add_material(s, &m);
}

static bool add_quad(noc_scene *s, int material, double x, double y, double z, const double a[3], const double b[3]) {
    double xyz[12];
    const double p[3] = { x, y, z };
    for (int k = 0; k < 3; k++) {
        xyz[k] = p[k];
        xyz[3 + k] = p[k] + a[k];
        xyz[6 + k] = p[k] + a[k] + b[k];
        xyz[9 + k] = p[k] + b[k];
    }
    return noc_scene_add_mesh(s, &(noc_mesh){ .vertex_count = 4,
                                              .positions = xyz,
                                              .triangle_count = 2,
                                              .name = "quad",
                                              .indices = (uint32_t[]){ 0, 1, 2, 0, 2, 3 },
                                              .material = material }) >= 0;
}

static noc_status or_memory(noc_scene *s, bool ok) {
    return ok ? NOC_OK : s->no_memory ? NOC_ERR_MEMORY : NOC_ERR_ARGUMENT;
}

/* What the public functions add. */
static noc_status by_hand(noc_scene *s) {
    noc_material glow = { .emission = { 5, 5, 5 }, .roughness = 1 };
    bool ok = noc_scene_set_crs(s, "EPSG:25832", (double[3]){ 1, 2, 3 }) == NOC_OK;
    ok = ok && add_quad(s, material(s, NOC_CLASS_ROAD), 0, 0, 0, (double[3]){ 9, 0, 0 }, (double[3]){ 0, 9, 0 });
    ok = ok && add_quad(s, noc_scene_add_material(s, &glow), 0, 9, 0, (double[3]){ 9, 0, 0 }, (double[3]){ 0, 0, 9 });
    for (int i = 0; ok && i < 15; i++) {
        noc_light l = { .kind = (noc_light_kind)(i % NOC_LIGHT_KIND_COUNT),
                        .inner_deg = 30,
                        .outer_deg = 60,
                        .position = { i, 4, 4 },
                        .direction = { 0, 0, -1 },
                        .radius = 0.1,
                        .edge_u = { 1, 0, 0 },
                        .edge_v = { 0, 1, 0 },
                        .emission = { 9, 9, (float)i },
                        .name = "lamp",
                        .moving = i > 10 };
        ok = noc_scene_add_light(s, &l) >= 0;
    }
    return or_memory(s, ok);
}

static void test_by_hand(void **state) { refuse_each("by hand", by_hand); }

/* Groups, models with lights that have shapes, and instances of them. */
static noc_status by_models(noc_scene *s) {
    noc_material glow = { .emission = { 5, 5, 5 }, .roughness = 1 };
    bool ok = true;
    for (int i = 0; ok && i < 9; i++) {
        int group = noc_scene_add_group(s, "tail lamps"), model = group > 0 ? noc_scene_add_model(s, "car") : -1;
        noc_mesh body = { .vertex_count = 3,
                          .positions = (double[]){ 0, 0, 0, 1, 0, 0, 0, 1, 0 },
                          .triangle_count = 1,
                          .indices = (uint32_t[]){ 0, 1, 2 },
                          .material = model > 0 ? noc_scene_add_material(s, &glow) : -1,
                          .model = model,
                          .group = group };
        noc_light lamp = { .kind = NOC_LIGHT_DISC,
                           .direction = { 1, 0, 0 },
                           .radius = 0.1,
                           .emission = { 9, 9, (float)i },
                           .name = "lamp",
                           .model = model,
                           .group = group };
        noc_light dot = { .kind = NOC_LIGHT_POINT, .emission = { 1, 1, 1 }, .model = model };
        noc_instance car = { .model = model, .transform = { 1, 0, 0, 3 * i, 0, 1, 0, 0, 0, 0, 1, 0 } };
        ok = body.material >= 0 && noc_scene_add_mesh(s, &body) >= 0 && noc_scene_add_light(s, &lamp) >= 0 &&
             noc_scene_add_light(s, &dot) >= 0 && noc_scene_add_instance(s, &car) == i;
    }
    return or_memory(s, ok);
}

static void test_by_models(void **state) { refuse_each("models", by_models); }

static noc_status builtin(noc_scene *s, const char *name) {
    noc_builtin_params params = noc_builtin_default_params();
    params.lights = 50;
    params.city.size = 150;
    return noc_scene_add_builtin(s, name, &params);
}

static noc_status builtin_city(noc_scene *s) { return builtin(s, "city"); }
static noc_status builtin_mess(noc_scene *s) { return builtin(s, "mess"); }
static noc_status builtin_atrium(noc_scene *s) { return builtin(s, "atrium"); }

static void test_builtin(void **state) {
    refuse_each("builtin:city", builtin_city);
    refuse_each("builtin:mess", builtin_mess);
    refuse_each("builtin:atrium", builtin_atrium);
}

/* Four houses on a slope, which get a ground, skirts, the country around them, and lamps. */
static noc_status village(noc_scene *s) {
    double lamps[9] = { -20, -20, 1, 25, 30, 4, 60, 5, NAN };
    int wall = material(s, NOC_CLASS_WALL);
    bool ok = wall >= 0;
    for (int i = 0; ok && i < 4; i++) {
        double x = 40 * (i % 2), y = 40 * (i / 2), z = 0.05 * (x + y);
        ok = add_quad(s, wall, x, y, z, (double[3]){ 12, 0, 0.4 }, (double[3]){ 0, 0, 6 }) &&
             add_quad(s, wall, x + 12, y, z, (double[3]){ 0, 12, 0.4 }, (double[3]){ 0, 0, 6 });
    }
    city_add_ground(s, lamps, 3);
    int lights = 0;
    city_lamp_params params = { .height = 6, .lumens = 5000, .kelvin = 3000 };
    noc_status status = or_memory(s, ok);
    return status ? status : city_infer_lamps(s, &params, NULL, NULL, &lights);
}

static void test_village(void **state) { refuse_each("village", village); }

/* Looking at a committed scene. */
static void test_cameras(void **state) {
    noc_log *log = counting_log();
    for (int view = NOC_VIEWPOINT_STREET; view <= NOC_VIEWPOINT_OWN; view++) {
        noc_camera want, have;
        bool reached;
        FOR_EACH_REFUSAL(reached) {
            noc_scene *s = noc_scene_create(log);
            assert_int_equal(village(s), NOC_OK);
            assert_int_equal(noc_scene_commit(s), NOC_OK);
            begin_refusal(n, later);
            noc_status status = noc_scene_camera(s, (noc_viewpoint)view, 1.5, &have);
            reached = end_refusal();
            assert_int_equal(noc_scene_camera(s, (noc_viewpoint)view, 1.5, &want), NOC_OK);
            if (status == NOC_OK)
                assert_unharmed(!memcmp(&have, &want, sizeof(have)), "camera");
            else
                assert_refused(status, "camera");
            noc_scene_destroy(s);
        }
    }
    noc_log_destroy(log);
}

/* A vertical ray that there is no memory for hits nothing, and says so; the next one hits. */
static void test_ground(void **state) {
    noc_log *log = counting_log();
    bool reached;
    FOR_EACH_REFUSAL(reached) {
        noc_scene *s = noc_scene_create(log);
        double z = 0;
        assert_int_equal(by_hand(s), NOC_OK);
        assert_int_equal(noc_scene_commit(s), NOC_OK);
        begin_refusal(n, later);
        bool hit = noc_scene_ground(s, 4, 4, &z);
        reached = end_refusal();
        if (!hit)
            assert_refused(NOC_ERR_MEMORY, "ground");
        assert_int_equal(!hit, reached);
        assert_true(noc_scene_ground(s, 4, 4, &z));
        noc_scene_destroy(s);
    }
    noc_log_destroy(log);
}

/* A map that there is no memory for leaves the one before. */
static void test_map(void **state) {
    noc_log *log = counting_log();
    noc_image *map = noc_image_create(4096, 2048, NULL), *before = noc_image_create(4, 2, NULL);
    noc_scene_info info;
    bool reached;
    assert_non_null(map);
    map->rgb[0] = 1;
    FOR_EACH_REFUSAL(reached) {
        noc_scene *s = noc_scene_create(log);
        assert_int_equal(noc_scene_set_environment(s, before), NOC_OK);
        begin_refusal(n, later);
        noc_status status = noc_scene_set_environment(s, map);
        reached = end_refusal();
        if (reached)
            assert_refused(status, "map");
        else
            assert_int_equal(status, NOC_OK);
        noc_scene_get_info(s, &info);
        assert_int_equal(info.environment_width, reached ? 4 : 4096);
        noc_scene_destroy(s);
    }
    noc_image_destroy(map);
    noc_image_destroy(before);
    noc_log_destroy(log);
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(test_by_hand), cmocka_unit_test(test_by_models),
                                        cmocka_unit_test(test_builtin), cmocka_unit_test(test_village),
                                        cmocka_unit_test(test_cameras), cmocka_unit_test(test_ground),
                                        cmocka_unit_test(test_map) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
