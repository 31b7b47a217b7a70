/* Bodies of lamps: one mesh a kind, a few dozen bytes a lamp, and what rays, names and edits know of them. */
#include "../own_view.h"
#include "lamp_scene.h"

#include "../core/no_profiles.h"
#include "core/shadow.h"

#include <nocturne/nocturne.h>

#include <unistd.h>

enum { SIDE = 20, LAMPS = SIDE * SIDE };

static size_t models_bytes(const noc_scene *s) { return s->meshes.len * sizeof(noc_scene_mesh); }

/* Lamps of two heights and all directions on a plane. */
static noc_scene *many(int count) {
    noc_scene *s = noc_scene_create(NULL);
    add_plane(s, NOC_CLASS_TERRAIN, -100, -100, 20 * SIDE + 100, 20 * SIDE + 100, 0, 0);
    for (int i = 0; i < count; i++) {
        char id[24];
        snprintf(id, sizeof(id), "lamp %d", i);
        geo_lamp l = lamp_at(20 * (i % SIDE) + 1.5, 20 * (i / SIDE) + 1.5);
        l.height = i % 2 ? 6 : 8;
        l.direction = 17.3 * i;
        l.id = id;
        assert_int_equal(city_add_lamp(s, &l, &defaults, false, NULL), 1);
    }
    return s;
}

/* What lamps cost is counted: no triangle, no mesh and no material, whatever they emit, and few bytes. */
static void test_cost(void **state) {
    (void)state;
    noc_scene *few = many(4), *all = many(LAMPS);
    assert_int_equal(all->models.len, 2);
    assert_int_equal(all->bodies.len, LAMPS);
    assert_int_equal(all->triangle_light.len, few->triangle_light.len);
    assert_int_equal(all->meshes.len, few->meshes.len);
    assert_int_equal(all->materials.len, few->materials.len);
    assert_int_equal(models_bytes(all), models_bytes(few));
    assert_int_equal(all->triangle_light.len, 2 + 2 * (16 + 8 + 12 + 22)); /* post, arm, head, disc */
    size_t links = all->body_links.len * sizeof(noc_body_link) + all->body_cells.len * sizeof(uint32_t);
    assert_true(sizeof(noc_scene_body) + links / LAMPS <= 64);
    assert_int_equal(noc_scene_commit(all), NOC_OK);
    noc_scene_info info;
    noc_scene_get_info(all, &info);
    assert_int_equal(info.instances, LAMPS);
    assert_int_equal(info.instance_triangles, LAMPS * 58);
    noc_scene_destroy(few);
    noc_scene_destroy(all);
}

/* A kind is what a body looks like, to the centimetre of its height: its light hangs where it is told to. */
static void test_kinds(void **state) {
    (void)state;
    static const double heights[] = { 6, 6.004, 5.996, 6.01, 6 };
    noc_scene *s = noc_scene_create(NULL);
    add_plane(s, NOC_CLASS_TERRAIN, -100, -100, 200, 100, 0, 0);
    for (int i = 0; i < 5; i++) {
        geo_lamp l = lamp_at(20 * i, 0);
        l.height = heights[i];
        l.count = i == 4 ? 2 : 1;
        assert_int_equal(city_add_lamp(s, &l, &defaults, false, NULL), l.count);
        assert_float_equal(s->lights.data[i].p[2], heights[i], 1e-6);
        assert_float_equal(s->bodies.data[i].p[2], heights[i] - (i == 3 ? 6.01 : 6), 1e-6);
    }
    assert_int_equal(s->models.len, 3);
    assert_int_equal(s->bodies.data[0].model, s->bodies.data[1].model);
    assert_int_equal(s->bodies.data[0].model, s->bodies.data[2].model);
    assert_int_equal(s->models.data[s->bodies.data[4].model - 1].shown, 2);
    noc_scene_destroy(s);
}

/* Vertical rays meet a body where it stands, however it is turned: the arm of one that looks north is north of its
 * foot. Classes without lamps do not have it. */
static void test_vertical_rays(void **state) {
    (void)state;
    noc_scene *s = noc_scene_create(NULL);
    add_plane(s, NOC_CLASS_TERRAIN, -100, -100, 100, 100, 2, 0);
    geo_lamp l = lamp_at(10, 20);
    double z;
    l.direction = 0;
    l.height = 8;
    assert_int_equal(city_add_lamp(s, &l, &defaults, false, NULL), 1);
    assert_true(noc_scene_has_classes(s, 1u << NOC_CLASS_LAMP) && noc_scene_has_classes(s, 1u << NOC_CLASS_TERRAIN));
    assert_false(noc_scene_has_classes(s, 1u << NOC_CLASS_ROAD | 1u << NOC_CLASS_WALL));
    assert_true(noc_scene_top(s, 10, 20, &z));
    assert_float_equal(z, 2 + 8 + .08, 1e-5); /* the post's cap */
    assert_true(noc_scene_highest(s, 1u << NOC_CLASS_LAMP, 10, 21.2, &z));
    assert_float_equal(z, 2 + 8 + .01 + .12, 1e-4); /* the head's back */
    assert_false(noc_scene_highest(s, 1u << NOC_CLASS_LAMP, 10, 18.8, &z));
    assert_false(noc_scene_highest(s, 1u << NOC_CLASS_LAMP, 11.2, 20, &z));
    assert_true(noc_scene_highest(s, ~(1u << NOC_CLASS_LAMP), 10, 20, &z));
    assert_float_equal(z, 2, 1e-6);
    assert_float_equal(s->bounds_max[2], 100 * 0 + 2 + 8 + .01 + .12, 1e-4);
    noc_scene_destroy(s);
}

static noc_hit cast(noc_view *view, double x, double y, double z, double dx, double dy, double dz) {
    noc_ray ray = { { x, y, z }, { dx, dy, dz }, INFINITY };
    noc_hit hit;
    assert_int_equal(noc_view_cast(view, &ray, 1, &hit), NOC_OK);
    return hit;
}

/* A hit on a body names its lamp; one on its light's disc is that light; neither is of an instance. */
static void test_picking(void **state) {
    (void)state;
    noc_scene *s = many(LAMPS);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_view *view = own_view(s, 1, NULL);
    for (int i = 3; i < LAMPS; i += 97) {
        double x = 20 * (i % SIDE) + 1.5, y = 20 * (i / SIDE) + 1.5;
        char id[24];
        snprintf(id, sizeof(id), "lamp %d", i);
        noc_hit h = cast(view, x + 5, y, 3, -1, 0, 0);
        assert_true(h.hit && fabs(h.place[0] - x) < .2 && fabs(h.place[1] - y) < 1e-4);
        assert_int_equal(h.cls, NOC_CLASS_LAMP);
        assert_int_equal(h.instance, -1);
        assert_int_equal(h.light, -1);
        assert_true(h.object >= (int)s->meshes.len);
        assert_string_equal(noc_scene_object_name(s, (size_t)h.object), id);
        const noc_light_record *l = &s->lights.data[i];
        h = cast(view, l->p[0], l->p[1], 1, 0, 0, 1);
        assert_int_equal(h.light, i);
        assert_true(h.shines && fabs(h.place[2] - l->p[2]) < 1e-4);
        assert_string_equal(noc_scene_object_name(s, (size_t)h.object), id);
        noc_region *region = noc_region_create(NULL);
        noc_region_info info;
        assert_int_equal(noc_region_add_object(region, s, id, 0), NOC_OK);
        noc_region_get_info(region, &info);
        assert_int_equal(info.patches, 58);
        noc_region_destroy(region);
    }
    assert_int_equal(noc_scene_object_slots(s), s->meshes.len + LAMPS);
    close_view(view);
    noc_scene_destroy(s);
}

/* A lamp that is removed leaves its body, whose light is dark, and shows no light that comes later. */
static void test_removed_light(void **state) {
    (void)state;
    noc_scene *s = many(9);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_view *view = own_view(s, 1, NULL);
    const float p[3] = { s->lights.data[4].p[0], s->lights.data[4].p[1], s->lights.data[4].p[2] };
    assert_int_equal(noc_scene_remove_light(s, 4), NOC_OK);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    for (int i = 0; i < 3000; i++) { /* until what stands is settled, and slots are free again */
        noc_light l = { .kind = NOC_LIGHT_POINT, .position = { i, -50, 9 }, .emission = { 1, 1, 1 } };
        assert_int_not_equal(noc_scene_add_light(s, &l), 4);
    }
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_hit h = cast(view, p[0], p[1], 1, 0, 0, 1);
    assert_true(h.hit && fabs(h.place[2] - p[2]) < 1e-4);
    assert_false(h.shines);
    h = cast(view, p[0], p[1], 20, 0, 0, -1);
    assert_int_equal(h.cls, NOC_CLASS_LAMP);
    close_view(view);
    noc_scene_destroy(s);
}

/* How many of 500 shadow rays to a lamp's light, from points of a half sphere above it, meet its body. */
static int blocked(bool profile) {
    noc_scene *s = noc_scene_create(NULL);
    noc_status status = NOC_OK;
    city_lamp_params params = defaults;
    params.profiles = profile ? city_profiles_create(s, NULL, &status) : NULL;
    geo_lamp lamp = lamp_at(30, 40);
    lamp.xyz[2] = 0;
    lamp.direction = 63;
    assert_int_equal(city_add_lamp(s, &lamp, &params, false, NULL), 1);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_view *view = own_view(s, 1, NULL);
    light l = light_of_record(s->lights.data[0]);
    int count = 0;
    for (int i = 0; i < 500; i++) {
        double up = .4 + .6 * (i + .5) / 500, r = sqrt(1 - up * up), c = 2.399963 * i;
        v3 n = V3((float)(r * cos(c)), (float)(r * sin(c)), (float)up);
        segment w = shadow_segment(add3(l.p, mul3(n, 20)), mul3(n, -1), l, (float)fmod(.618034 * i, 1),
                                   (float)fmod(.754878 * i, 1), 1e-4f);
        noc_ray ray = { { w.o.x, w.o.y, w.o.z }, { w.d.x, w.d.y, w.d.z }, sqrtf(dot3(w.d, w.d)) };
        noc_hit hit;
        assert_int_equal(noc_view_cast(view, &ray, 1, &hit), NOC_OK);
        count += hit.hit;
    }
    close_view(view);
    city_profiles_destroy(params.profiles);
    noc_scene_destroy(s);
    return count;
}

/* A distribution holds its housing's shadow already: shadow rays end before the body, which is an instance. Of a light
 * without one the head hides all but little. */
static void test_own_body_does_not_shade(void **state) {
    (void)state;
    assert_true(blocked(true) <= 10); /* by the arm */
    assert_true(blocked(false) > 250);
}

/* A built city has the bodies, and what hits on them tell. */
static void test_built(void **state) {
    (void)state;
    char path[] = "/tmp/noc-bodies-XXXXXX";
    int file = mkstemp(path);
    assert_true(file >= 0);
    close(file);
    noc_scene *s = many(30), *again = noc_scene_create(NULL);
    char key[2][NOC_CONTENT_KEY];
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    assert_int_equal(noc_scene_remove_light(s, 4), NOC_OK);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    assert_int_equal(noc_scene_save(s, path, NULL), NOC_OK);
    assert_int_equal(noc_scene_load(again, (const char *[]){ path }, 1, NULL, NULL), NOC_OK);
    noc_scene_content(s, key[0]);
    noc_scene_content(again, key[1]);
    assert_string_equal(key[0], key[1]);
    noc_view *view = own_view(again, 1, NULL);
    noc_hit h = cast(view, 26.5, 21.5, 3, -1, 0, 0);
    assert_string_equal(noc_scene_object_name(again, (size_t)h.object), "lamp 21");
    double z;
    assert_true(noc_scene_highest(again, 1u << NOC_CLASS_LAMP, 21.5, 21.5, &z));
    for (int i = 0; i < 3000; i++)
        assert_int_not_equal(noc_scene_add_light(again,
                                                 &(noc_light){ .kind = NOC_LIGHT_POINT, .emission = { 1, 1, 1 } }),
                             4);
    close_view(view);
    noc_scene_destroy(again);
    noc_scene_destroy(s);
    unlink(path);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cost),          cmocka_unit_test(test_kinds),
        cmocka_unit_test(test_vertical_rays), cmocka_unit_test(test_picking),
        cmocka_unit_test(test_removed_light), cmocka_unit_test(test_own_body_does_not_shade),
        cmocka_unit_test(test_built),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
