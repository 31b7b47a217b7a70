/* What can be set of the world: each row, what is wrong, and that the scene is then the one that a load with the same
 * options makes. */
#include "state_city.h"

#include <math.h>
#include <pthread.h>

static void key_of(viewer_world *w, char key[NOC_CONTENT_KEY]) {
    world_settle(w);
    noc_scene_content(world_scene(w), key);
}

/* The name of the scene that a load with these makes. */
static void loaded_key(const state_city *c, const noc_import_params *params, char key[NOC_CONTENT_KEY]) {
    noc_scene *scene = noc_scene_create(c->log);
    if (noc_scene_load(scene, c->inputs, c->source.said_count, params, NULL))
        fail_msg("%s", noc_log_last_error(c->log));
    noc_scene_content(scene, key);
    noc_scene_destroy(scene);
}

static const struct {
    const char *name, *value, *back;
} edits[] = {
    { "hour", "3", "21" },
    { "window-lit", "0.9", "0.35" },
    { "window-seed", "12", "1" },
    { "wet", "on", "off" },
    { "traffic-time", "6.5", "0" },
    { "group.lamps", "0.5,2200K", "on,own" },
    { "group.windows", "off", "on" },
    { "group.cars", "3,#ff2000", "on,own" },
    { "material.terrain.albedo", "#406080", "" },
    { "material.wall.roughness", "0.3", "" },
    { "material.roof.f0", "0.5", "" },
};
enum { EDITS = sizeof(edits) / sizeof(*edits) };

/* The same, said to a load. */
static void say(noc_import_params *p, size_t edit, noc_material *material) {
    static const noc_class classes[] = { NOC_CLASS_TERRAIN, NOC_CLASS_WALL, NOC_CLASS_ROOF };
    static char text[100];
    const char *name = edits[edit].name;
    if (!strncmp(name, "group.", 6)) {
        snprintf(text, sizeof(text), "%s=%s", name + 6, edits[edit].value);
        p->group_states.text[p->group_states.count++] = text;
        return;
    }
    for (const noc_option *o = noc_import_options(); o->name; o++)
        if (!strcmp(o->name, name))
            assert_int_equal(noc_option_set(o, p, edits[edit].value, NULL), NOC_OK);
    if (strncmp(name, "material.", 9))
        return;
    *material = noc_class_material(classes[edit - 8]);
    for (int k = 0; k < 3 && edit == 8; k++)
        material->albedo[k] = (float)pow(((k + 2) * 32 / 255. + 0.055) / 1.055, 2.4);
    material->roughness = edit == 9 ? .3f : material->roughness;
    material->f0 = edit == 10 ? .5f : material->f0;
    p->materials = material;
    p->material_count = 1;
}

static void edits_are_what_a_load_makes(void **state) {
    state_city c;
    set_city(&c, false);
    start_city(&c);
    char before[NOC_CONTENT_KEY], now[NOC_CONTENT_KEY], loaded[NOC_CONTENT_KEY], why[300];
    key_of(c.world, before);
    loaded_key(&c, &c.import, loaded);
    assert_string_equal(before, loaded);
    json_t *schema = world_schema(c.world);
    for (size_t i = 0; i < EDITS; i++) {
        noc_import_params p = c.import;
        noc_material material;
        const char *back = edits[i].back;
        for (size_t k = 0; k < json_array_size(schema) && !*back; k++)
            if (!strcmp(json_string_value(json_object_get(json_array_get(schema, k), "name")), edits[i].name))
                back = json_string_value(json_object_get(json_array_get(schema, k), "value"));
        uint64_t version = world_version(c.world);
        say(&p, i, &material);
        loaded_key(&c, &p, loaded);
        set_world(&c, edits[i].name, edits[i].value);
        key_of(c.world, now);
        if (strcmp(now, loaded) || !strcmp(now, before))
            fail_msg("%s %s: the scene is %s, a load makes %s, before it was %s", edits[i].name, edits[i].value, now,
                     loaded, before);
        assert_true(world_version(c.world) > version);
        assert_false(world_set(c.world, edits[i].name, "what", why, sizeof(why)));
        set_world(&c, edits[i].name, back);
        key_of(c.world, now);
        if (strcmp(now, before))
            fail_msg("%s %s: the scene is not as it was", edits[i].name, back);
    }
    json_decref(schema);
    end_city(&c);
}

/* The windows of the built-in city, too, and they are those that a load makes. */
static void windows_of_the_builtin_city(void **state) {
    state_city c;
    set_city(&c, true);
    start_city(&c);
    char before[NOC_CONTENT_KEY], now[NOC_CONTENT_KEY], loaded[NOC_CONTENT_KEY];
    key_of(c.world, before);
    for (size_t i = 0; i < 3; i++) {
        noc_import_params p = c.import;
        say(&p, i, NULL);
        loaded_key(&c, &p, loaded);
        set_world(&c, edits[i].name, edits[i].value);
        key_of(c.world, now);
        assert_string_equal(now, loaded);
        assert_string_not_equal(now, before);
        set_world(&c, edits[i].name, edits[i].back);
        key_of(c.world, now);
        assert_string_equal(now, before);
    }
    end_city(&c);
}

/* Rain over a material that was set, and a load that is wet from the beginning. */
static void rain_over_materials(void **state) {
    state_city c;
    set_city(&c, false);
    c.import.wet = true;
    start_city(&c);
    char now[NOC_CONTENT_KEY], loaded[NOC_CONTENT_KEY];
    loaded_key(&c, &c.import, loaded);
    key_of(c.world, now);
    assert_string_equal(now, loaded);
    set_world(&c, "material.terrain.albedo", "#406080");
    noc_import_params p = c.import;
    noc_material material;
    say(&p, 8, &material);
    loaded_key(&c, &p, loaded);
    key_of(c.world, now);
    assert_string_equal(now, loaded);
    set_world(&c, "wet", "off");
    p.wet = false;
    loaded_key(&c, &p, loaded);
    key_of(c.world, now);
    assert_string_equal(now, loaded);
    end_city(&c);
}

static void traffic_goes_and_drives(void **state) {
    state_city c;
    set_city(&c, false);
    start_city(&c);
    char before[NOC_CONTENT_KEY], now[NOC_CONTENT_KEY];
    noc_scene_info info;
    noc_scene_get_info(world_scene(c.world), &info);
    assert_int_equal(info.cars, 1);
    key_of(c.world, before);
    set_world(&c, "traffic", "off");
    key_of(c.world, now);
    assert_string_not_equal(before, now);
    set_world(&c, "traffic", "on");
    key_of(c.world, now);
    assert_string_equal(before, now);
    set_world(&c, "traffic-pace", "20");
    set_world(&c, "traffic-drive", "on");
    uint64_t told = world_told(c.world), version = world_version(c.world);
    nanosleep(&(struct timespec){ .tv_nsec = 300000000 }, NULL);
    assert_true(world_version(c.world) == version); /* nobody looks */
    /* so often against hangs alone */
    for (int i = 0; i < 12000 && world_version(c.world) < version + 3; i++) {
        world_look(c.world);
        nanosleep(&(struct timespec){ .tv_nsec = 10000000 }, NULL);
    }
    assert_true(world_version(c.world) >= version + 3);
    assert_true(world_told(c.world) == told); /* that they drive is no news */
    set_world(&c, "traffic-drive", "off");
    world_settle(c.world);
    noc_scene_get_info(world_scene(c.world), &info);
    assert_true(info.time > 0);
    set_world(&c, "traffic-time", "0");
    key_of(c.world, now);
    assert_string_equal(before, now);
    end_city(&c);
}

static void what_is_wrong_is_told(void **state) {
    static const struct {
        const char *name, *value, *says;
    } wrong[] = {
        { "hours", "3", "there is no option \"hours\"" },
        { "", "", "there is no option" },
        { "hour", "25", "hour: \"25\" is outside 0 to 24 h" },
        { "hour", "", "hour: needs a value" },
        { "window-lit", "nan", "is" },
        { "wet", "maybe", "wet: \"maybe\" is neither true nor false" },
        { "traffic", "2", "neither true nor false" },
        { "traffic-pace", "-1", "outside 0 to 100" },
        { "group.lamp", "off", "there is no group of lights \"lamp\"" },
        { "group.", "off", "there is no group" },
        { "group.lamps", "red", "is no state" },
        { "group.lamps", "", "is no state" },
        { "group.lamps", "1e7", "is no state" },
        { "material.wall", "1", "no surface of the class" },
        { "material.wall.shine", "1", "no such field" },
        { "material.water.f0", "1", "no surface of the class" },
        { "material.wall.albedo", "#12345", "no colour" },
        { "material.wall.albedo", "#12345g", "no colour" },
        { "material.wall.roughness", "0.01", "not a number of 0.05 to 1" },
        { "material.wall.f0", "inf", "not a number" },
    };
    state_city c;
    set_city(&c, false);
    start_city(&c);
    uint64_t version = world_version(c.world);
    for (size_t i = 0; i < sizeof(wrong) / sizeof(*wrong); i++) {
        char why[300] = "";
        if (world_set(c.world, wrong[i].name, wrong[i].value, why, sizeof(why)) || !strstr(why, wrong[i].says))
            fail_msg("%s %s: \"%s\"", wrong[i].name, wrong[i].value, why);
    }
    assert_true(world_version(c.world) == version);
    end_city(&c);
}

/* Each option of the schema has a value, and one that changes nothing here says why. */
static void the_schema_is_whole(void **state) {
    for (int builtin = 0; builtin < 2; builtin++) {
        state_city c;
        set_city(&c, builtin);
        start_city(&c);
        json_t *schema = world_schema(c.world), *told = world_state(c.world), *values = json_object_get(told, "values");
        size_t count = json_array_size(schema);
        assert_true(count > 10);
        assert_int_equal(json_object_size(values), count);
        for (size_t i = 0; i < count; i++) {
            json_t *row = json_array_get(schema, i);
            const char *name = json_string_value(json_object_get(row, "name"));
            char why[300];
            for (const char *const *k = (const char *const[]){ "group", "kind", "unit", "help", "value", NULL }; *k;
                 k++)
                assert_non_null(json_string_value(json_object_get(row, *k)));
            const char *value = json_string_value(json_object_get(values, name));
            assert_non_null(value);
            if (!world_set(c.world, name, value, why, sizeof(why)))
                fail_msg("%s %s: %s", name, value, why);
        }
        assert_null(json_object_get(json_object_get(told, "idle"), "hour"));
        assert_true(!json_object_get(json_object_get(told, "idle"), "traffic") == !builtin);
        json_decref(schema);
        json_decref(told);
        end_city(&c);
    }
}

typedef struct looker {
    state_city *city;
    int frames;
    noc_status status;
} looker;

static void *look_at(void *user) {
    looker *l = user;
    noc_view *view = noc_view_create(world_device(l->city->world), world_scene(l->city->world));
    noc_render_params p = l->city->source.render;
    p.width = 48;
    p.height = 32;
    for (int i = 0; i < l->frames && !l->status; i++)
        l->status = noc_view_render(view, &city_camera, &p, NULL);
    noc_view_destroy(view);
    return NULL;
}

static void edits_come_while_frames_are_rendered(void **state) {
    state_city c;
    set_city(&c, false);
    start_city(&c);
    set_world(&c, "traffic-drive", "on");
    looker lookers[2] = { { &c, 30, NOC_OK }, { &c, 30, NOC_OK } };
    pthread_t threads[2];
    for (int i = 0; i < 2; i++)
        assert_int_equal(pthread_create(&threads[i], NULL, look_at, &lookers[i]), 0);
    for (int round = 0; round < 6; round++)
        for (size_t i = 0; i < EDITS; i++) {
            world_look(c.world);
            set_world(&c, edits[i].name, round % 2 && *edits[i].back ? edits[i].back : edits[i].value);
            json_decref(world_state(c.world));
            nanosleep(&(struct timespec){ .tv_nsec = 2000000 }, NULL);
        }
    for (int i = 0; i < 2; i++) {
        pthread_join(threads[i], NULL);
        assert_int_equal(lookers[i].status, NOC_OK);
    }
    end_city(&c);
}

/* A load that is ended, and one that fails. */
static void loads_that_come_to_nothing(void **state) {
    state_city c;
    char what[128], why[300];
    double done;
    set_city(&c, false);
    c.world = world_create(&c.source, c.log);
    assert_false(world_set(c.world, "hour", "3", why, sizeof(why)) && !world_scene(c.world));
    end_city(&c);
    set_city(&c, false);
    c.inputs[0] = "/tmp/there is no such city.gml";
    c.world = world_create(&c.source, c.log);
    while (world_loading(c.world, what, sizeof(what), &done))
        nanosleep(&(struct timespec){ .tv_nsec = 5000000 }, NULL);
    assert_non_null(strstr(world_failed(c.world), "no such city"));
    assert_null(world_scene(c.world));
    assert_false(world_set(c.world, "hour", "3", why, sizeof(why)));
    json_t *schema = world_schema(c.world);
    assert_int_equal(json_array_size(schema), 0);
    json_decref(schema);
    end_city(&c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(edits_are_what_a_load_makes),
        cmocka_unit_test(rain_over_materials),
        cmocka_unit_test(windows_of_the_builtin_city),
        cmocka_unit_test(traffic_goes_and_drives),
        cmocka_unit_test(what_is_wrong_is_told),
        cmocka_unit_test(the_schema_is_whole),
        cmocka_unit_test(edits_come_while_frames_are_rendered),
        cmocka_unit_test(loads_that_come_to_nothing),
    };
    return make_folder() ? cmocka_run_group_tests(tests, NULL, NULL) : 1;
}
