/* Slots of lights, and models with their instances. */
#include "edits.h"

/* A light that is removed leaves a dark slot; the indices of others stay. The next one takes it where it was not of
 * those that stand from the start, which are settled later. */
static void slots_are_stable(void **unused) {
    noc_scene *s = made(NULL, NOTHING);
    size_t slots = s->lights.len, moving = s->moving.len;
    noc_light lamp = lamp_at(30), more = lamp_at(40), spot = spot_at(50);
    noc_light_info info;
    noc_light_record globe = s->lights.data[GLOBE];
    assert_int_equal(noc_scene_remove_light(s, LAMP), NOC_OK);
    assert_int_equal(noc_scene_add_light(s, &more), (int)slots); /* its slot is not free before the commit */
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    assert_int_equal(s->lights.len, slots + 1);
    assert_true(s->lights.data[LAMP].e[0] == 0 && s->lights.data[LAMP].area == 0);
    assert_int_equal(noc_scene_get_light(s, LAMP, &info), NOC_OK);
    assert_true(info.removed && info.lumens == 0);
    assert_int_equal(noc_scene_remove_light(s, (int)slots), NOC_OK);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    assert_int_equal(noc_scene_add_light(s, &spot), slots);
    assert_int_equal(noc_scene_add_light(s, &lamp), (int)slots + 1);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    assert_int_equal(noc_scene_get_light(s, slots, &info), NOC_OK);
    assert_true(!info.removed && info.light.kind == NOC_LIGHT_SPOT && info.light.position[0] == 50);
    assert_int_equal(noc_scene_get_light(s, slots + 1, &info), NOC_OK);
    assert_true(!info.removed && info.light.kind == NOC_LIGHT_DISC && !info.light.moving);
    assert_int_equal(s->moving.len, moving + 2);
    assert_memory_equal(&s->lights.data[GLOBE], &globe, sizeof(globe));
    assert_int_equal(s->dirty_lights.first, slots);
    assert_int_equal(s->dirty_lights.end, slots + 2);
    /* an instance's lights take the slots of another's */
    noc_scene_info before, after;
    noc_scene_get_info(s, &before);
    for (int i = 0; i < 5; i++) {
        noc_instance in = { .model = CAR };
        place(i, 1, i, in.transform);
        assert_int_equal(noc_scene_remove_instance(s, 1), NOC_OK);
        assert_int_equal(noc_scene_commit(s), NOC_OK);
        assert_int_equal(noc_scene_add_instance(s, &in), 1);
        assert_int_equal(noc_scene_commit(s), NOC_OK);
    }
    noc_scene_get_info(s, &after);
    assert_int_equal(after.light_slots, before.light_slots);
    assert_int_equal(s->moving.len, moving + 2);
    for (size_t i = 0; i < s->moving.len; i++) {
        assert_false(noc_light_stands(s->lights.data[s->moving.data[i]].flags));
        assert_true(!i || s->moving.data[i - 1] < s->moving.data[i]);
    }
    noc_scene_destroy(s);
    (void)unused;
}

static void add_points(noc_scene *s, int count) {
    noc_light point = { .kind = NOC_LIGHT_POINT, .position = { 3, 4, 5 }, .emission = { 7, 7, 7 } };
    for (int i = 0; i < count; i++)
        assert_true(noc_scene_add_light(s, &point) >= 0);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
}

/* What was added stays apart from what stands until it is much: then it joins that, and slots of what went are free. */
static void many_are_settled(void **unused) {
    noc_scene *s = made(NULL, NOTHING);
    size_t moving = s->moving.len;
    assert_int_equal(noc_scene_remove_light(s, LAMP), NOC_OK);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    add_points(s, 1000);
    assert_int_equal(s->versions.settled, 0);
    assert_int_equal(s->moving.len, moving + 1000);
    add_points(s, 100);
    assert_int_equal(s->versions.settled, 1);
    assert_int_equal(s->moving.len, moving);
    for (size_t i = 0; i < s->lights.len; i++)
        assert_false(s->lights.data[i].flags & NOC_LIGHT_LATER);
    noc_light spot = spot_at(50);
    assert_int_equal(noc_scene_add_light(s, &spot), LAMP);
    add_points(s, 1);
    assert_int_equal(s->versions.settled, 1);
    assert_int_equal(s->moving.len, moving + 2);
    noc_scene_destroy(s);
    (void)unused;
}

/* Each instance has lights of its own where its model has them; one of them alone may be put out, and stays so. */
static void instances_have_lights(void **unused) {
    noc_scene *s = made(NULL, NOTHING);
    double there[12], turned = M_PI / 2;
    int disc = noc_scene_instance_light(s, 0, 0), point = noc_scene_instance_light(s, 0, 1),
        strip = noc_scene_instance_light(s, 0, 3), other = noc_scene_instance_light(s, 1, 0);
    assert_true(disc >= 0 && point >= 0 && strip >= 0 && other >= 0 && other != disc);
    assert_int_equal(noc_scene_instance_light(s, 0, 4), -1);
    assert_int_equal(noc_scene_instance_light(s, 7, 0), -1);
    assert_int_equal(noc_scene_set_emission(s, point, (float[3]){ 1, 2, 3 }), NOC_OK);
    place(turned, 2, 100, there);
    assert_int_equal(noc_scene_set_transform(s, 0, there), NOC_OK);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_light_record still = s->lights.data[other];
    noc_light_info info;
    assert_int_equal(noc_scene_get_light(s, (size_t)point, &info), NOC_OK);
    assert_float_equal(info.light.position[0], 100 - 2, 1e-5); /* (1, 1, 1) turned, twice as large, moved */
    assert_float_equal(info.light.position[1], 3 + 2, 1e-5);
    assert_float_equal(info.light.position[2], 2.5, 1e-5);
    assert_true(info.light.emission[2] == 3 && info.light.moving);
    assert_int_equal(noc_scene_get_light(s, (size_t)disc, &info), NOC_OK);
    assert_float_equal(info.light.radius, .2, 1e-6);
    assert_float_equal(info.area, M_PI * .04, 1e-6);
    assert_float_equal(info.light.direction[2], -1, 1e-6);
    assert_float_equal(info.light.emission[0], 90, 0);
    assert_int_equal(info.light.group, CARS);
    assert_string_equal(info.light.name, "lamp");
    assert_int_equal(noc_scene_get_light(s, (size_t)strip, &info), NOC_OK);
    assert_float_equal(info.area, .5 * .5 * .5 * 4, 1e-5);
    assert_float_equal(info.light.direction[0], 1, 1e-5); /* of the model's (0, -1, 0) */
    assert_true(info.two_sided);
    assert_memory_equal(&s->lights.data[other], &still, sizeof(still));
    noc_scene_destroy(s);
    (void)unused;
}

/* Models lie in the arrays, and are no part of the city: not of its triangles, its ground, its classes. */
static void models_are_no_city(void **unused) {
    noc_scene *s = noc_scene_create(NULL), *bare = noc_scene_create(NULL);
    double at[12], z;
    for (int i = 0; i < 2; i++) {
        noc_scene *to = i ? s : bare;
        materials(to, NOTHING);
        assert_int_equal(noc_scene_add_group(to, "street") + noc_scene_add_group(to, "cars"), STREET + CARS);
        if (i)
            car(to); /* before the city */
        piece(to, DARK, 0, 0, "ground", -20, 40);
    }
    noc_instance in = { .model = CAR };
    place(0, 1, 500, in.transform);
    assert_int_equal(noc_scene_add_instance(s, &in), 0);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    assert_int_equal(noc_scene_commit(bare), NOC_OK);
    assert_int_equal(noc_scene_city_triangles(s), noc_scene_city_triangles(bare));
    assert_int_equal(noc_scene_city_triangle(s, 0), s->meshes.data[s->meshes.len - 1].first_triangle);
    assert_false(noc_scene_top(s, 501, 3.5, &z));
    assert_false(noc_scene_top(s, 1, .5, &z) && z > 0); /* the car's body as it is in the model */
    assert_true(noc_scene_ground(s, 1, .5, &z));
    noc_camera a, b;
    for (int view = NOC_VIEWPOINT_STREET; view <= NOC_VIEWPOINT_OVERVIEW; view++) {
        s->lit_elsewhere = bare->lit_elsewhere = true; /* lights decide, too */
        assert_int_equal(noc_scene_camera(s, (noc_viewpoint)view, 1.5, &a), NOC_OK);
        assert_int_equal(noc_scene_camera(bare, (noc_viewpoint)view, 1.5, &b), NOC_OK);
        assert_memory_equal(&a, &b, sizeof(a));
    }
    noc_scene_info info;
    noc_scene_get_info(s, &info);
    assert_float_equal(info.bounds_max[0], 502.5, 1e-3);
    assert_int_equal(info.models, 1);
    assert_int_equal(info.instances, 1);
    assert_int_equal(info.instance_triangles, info.triangles - 2); /* all but the ground's */
    assert_string_equal(noc_scene_object_name(s, noc_scene_object_of(s, 0, NO_INSTANCE)), "body");
    place(0, 1, 0, at);
    noc_scene_destroy(s);
    noc_scene_destroy(bare);
    (void)unused;
}

/* A model with its instances may be added to a committed scene, with what is made of it in the same transaction. */
static void models_are_added_later(void **unused) {
    noc_scene *s = made(NULL, NOTHING), *want = made(NULL, INSTANCE_ADDED);
    noc_scene *late = noc_scene_create(NULL);
    materials(late, NOTHING);
    assert_int_equal(noc_scene_add_group(late, "street") + noc_scene_add_group(late, "cars"), STREET + CARS);
    assert_int_equal(noc_scene_commit(late), NOC_OK);
    noc_light globe = { .kind = NOC_LIGHT_SPHERE,
                        .position = { 5, 5, 5 },
                        .radius = .3,
                        .emission = { 20, 20, 20 },
                        .group = STREET,
                        .name = "globe" },
              spot = spot_at(0), lamp = lamp_at(0);
    piece(late, DARK, 0, 0, "ground", -20, 40);
    piece(late, SIGN, 0, 0, "shop", 3, 2);
    piece(late, WALL, 0, 0, "tower", 20, 60);
    piece(late, SIGN, 0, 0, "front", 6, 2);
    assert_int_equal(noc_scene_add_light(late, &globe), GLOBE);
    assert_int_equal(noc_scene_add_light(late, &spot), SPOT);
    assert_int_equal(noc_scene_add_light(late, &lamp), LAMP);
    car(late);
    instance(late, 0, 1, 0);
    instance(late, 1, 1, 10);
    instance(late, 2, .5, -100);
    assert_int_equal(noc_scene_commit(late), NOC_OK);
    assert_alike(late, want);
    noc_scene_destroy(s);
    noc_scene_destroy(late);
    noc_scene_destroy(want);
    (void)unused;
}

static int refused; /* errors told */
static char last[200];

static void count(void *user, noc_log_level level, const char *text) {
    refused += level == NOC_LOG_ERROR;
    snprintf(last, sizeof(last), "%s", text);
    (void)user;
}

/* Indices of groups and models have sixteen bits. One more is refused, and what is there stays. */
static void there_are_65535_at_most(void **unused) {
    enum { MOST = 65535, EARLY = 40000 };
    noc_log_params p = noc_log_default_params();
    p.message = count;
    noc_log *log = noc_log_create(&p);
    noc_scene *s = noc_scene_create(log);
    noc_mesh mesh = { .vertex_count = 3,
                      .positions = (double[]){ 0, 0, 0, 1, 0, 0, 0, 1, 0 },
                      .triangle_count = 1,
                      .indices = (uint32_t[]){ 0, 1, 2 },
                      .material = noc_scene_add_material(s, &(noc_material){ .roughness = 1 }) };
    assert_int_equal(noc_scene_add_mesh(s, &mesh), 0);
    refused = 0;
    for (int i = 1; i <= MOST; i++) {
        if (i == EARLY)
            assert_int_equal(noc_scene_commit(s), NOC_OK); /* later ones are staged */
        assert_int_equal(noc_scene_add_group(s, NULL), i);
        assert_int_equal(noc_scene_add_model(s, NULL), i);
    }
    assert_int_equal(refused, 0);
    assert_int_equal(noc_scene_add_group(s, "street"), -1);
    assert_non_null(strstr(last, "street"));
    assert_int_equal(noc_scene_add_model(s, "bus"), -1);
    assert_non_null(strstr(last, "bus"));
    assert_int_equal(refused, 2);
    mesh.model = MOST;
    noc_light lamp = lamp_at(0);
    lamp.model = MOST;
    lamp.group = MOST;
    noc_instance in = { .model = MOST, .transform = { 1, 0, 0, 5, 0, 1, 0, 0, 0, 0, 1, 0 } };
    assert_int_equal(noc_scene_add_mesh(s, &mesh), 1);
    assert_int_equal(noc_scene_add_light(s, &lamp), 0);
    assert_int_equal(noc_scene_add_instance(s, &in), 0);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    assert_int_equal(noc_scene_set_group(s, MOST, (float[3]){ 0.5f, 0.5f, 0.5f }), NOC_OK);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_light_info info;
    assert_int_equal(noc_scene_get_light(s, noc_scene_instance_light(s, 0, 0), &info), NOC_OK);
    assert_true(info.light.group == MOST && info.light.position[0] == 5);
    assert_int_equal(refused, 2);
    noc_scene_destroy(s);
    noc_log_destroy(log);
    (void)unused;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(many_are_settled),       cmocka_unit_test(slots_are_stable),
        cmocka_unit_test(instances_have_lights),  cmocka_unit_test(models_are_no_city),
        cmocka_unit_test(models_are_added_later), cmocka_unit_test(there_are_65535_at_most)
    };
    return cmocka_run_group_tests_name("scene instances", tests, NULL, NULL);
}
