/* Rays that programs cast: what they meet, before any frame, after edits, and without a trace in the picture. */
#include "rooms.h"

#include <math.h>

enum { FLOOR, WALL, GLOW, CAR = 1 };

static int tell(noc_scene *s, noc_class cls, float emission) {
    int index = noc_scene_add_material(s, &(noc_material){ .albedo = { .5f, .5f, .5f },
                                                           .roughness = 1,
                                                           .emission = { emission, emission, emission },
                                                           .cls = cls });
    assert_true(index >= 0);
    return index;
}

/* A floor, a wall at y = 5, a lamp at (0, 0, 4) that shines down, a dark lamp beside it, a box that is an instance. */
static noc_scene *street(void) {
    noc_scene *s = noc_scene_create(NULL);
    assert_int_equal(tell(s, NOC_CLASS_ROAD, 0), FLOOR);
    assert_int_equal(tell(s, NOC_CLASS_WALL, 0), WALL);
    assert_int_equal(tell(s, NOC_CLASS_OTHER, 10), GLOW);
    add_floor(s, FLOOR, 0, 0, 0, 20);
    double wall[] = { -5, 5, 0, 5, 5, 0, 5, 5, 6, -5, 5, 6 };
    noc_mesh mesh = { .vertex_count = 4,
                      .positions = wall,
                      .triangle_count = 2,
                      .indices = (uint32_t[]){ 0, 1, 2, 0, 2, 3 },
                      .material = WALL,
                      .name = "house" };
    assert_true(noc_scene_add_mesh(s, &mesh) >= 0);
    for (int i = 0; i < 2; i++)
        assert_int_equal(noc_scene_add_light(s, &(noc_light){ .kind = NOC_LIGHT_DISC,
                                                              .position = { 2.0 * i, 0, 4 },
                                                              .direction = { 0, 0, -1 },
                                                              .radius = .5,
                                                              .emission = { i ? 0 : 100, i ? 0 : 100, i ? 0 : 100 } }),
                         i);
    assert_int_equal(noc_scene_add_model(s, "car"), CAR);
    double side[] = { 0, -1, 0, 0, 1, 0, 0, 1, 1.5, 0, -1, 1.5 };
    mesh = (noc_mesh){ .vertex_count = 4,
                       .positions = side,
                       .triangle_count = 2,
                       .indices = (uint32_t[]){ 0, 1, 2, 0, 2, 3 },
                       .material = GLOW,
                       .model = CAR,
                       .name = "door" };
    assert_true(noc_scene_add_mesh(s, &mesh) >= 0);
    noc_instance car = { CAR, { 1, 0, 0, 8, 0, 1, 0, 0, 0, 0, 1, 0 } };
    assert_int_equal(noc_scene_add_instance(s, &car), 0);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    return s;
}

#define RAY(ox, oy, oz, dx, dy, dz) ((noc_ray){ { ox, oy, oz }, { dx, dy, dz }, INFINITY })

static noc_hit one(noc_view *view, noc_ray ray) {
    noc_hit hit;
    assert_int_equal(noc_view_cast(view, &ray, 1, &hit), NOC_OK);
    return hit;
}

static void assert_at(const noc_hit *h, double x, double y, double z) {
    const double want[3] = { x, y, z };
    assert_true(h->hit);
    for (int k = 0; k < 3; k++)
        assert_true(fabs(h->place[k] - want[k]) < 1e-4);
}

static void meets_the_nearest_and_tells_what_it_is(void **state) {
    (void)state;
    noc_scene *s = street();
    noc_view *view = own_view(s, 1, NULL);
    noc_hit h = one(view, RAY(1, -3, 2, 0, 7, 0)); /* before any frame; directions have any length */
    assert_at(&h, 1, 5, 2);
    assert_true(fabs(h.distance - 8) < 1e-4);
    assert_true(h.front && fabs(h.normal[1] + 1) < 1e-6);
    assert_int_equal(h.cls, NOC_CLASS_WALL);
    assert_int_equal(h.material, WALL);
    assert_string_equal(noc_scene_object_name(s, (size_t)h.object), "house");
    assert_true(h.light == -1 && h.instance == -1 && !h.shines);
    h = one(view, RAY(1, 9, 2, 0, -1, 0)); /* the same from behind: its normal is turned */
    assert_at(&h, 1, 5, 2);
    assert_true(!h.front && fabs(h.normal[1] - 1) < 1e-6);
    h = one(view, RAY(.1, .1, 1, 0, 0, 1));
    assert_at(&h, .1, .1, 4);
    assert_true(h.light == 0 && h.shines && fabs(h.normal[2] + 1) < 1e-6);
    h = one(view, RAY(.1, .1, 9, 0, 0, -1)); /* its back is its own and dark */
    assert_true(h.hit && h.light == 0 && !h.shines && fabs(h.normal[2] - 1) < 1e-6);
    h = one(view, RAY(2.1, .1, 1, 0, 0, 1)); /* out */
    assert_true(h.hit && h.light == 1 && !h.shines);
    h = one(view, RAY(1, -3, 2, 0, -1, 0));
    assert_true(!h.hit && h.light == -1 && h.object == -1 && h.material == -1 && h.instance == -1);
    close_view(view);
    noc_scene_destroy(s);
}

static void keeps_to_far(void **state) {
    (void)state;
    noc_scene *s = street();
    noc_view *view = own_view(s, 1, NULL);
    noc_ray ray[3] = { RAY(1, -3, 2, 0, .1, 0), RAY(1, -3, 2, 0, .1, 0), RAY(1, -3, 2, 0, .1, 0) };
    noc_hit hit[3];
    ray[0].far = 7.9;
    ray[1].far = 8.1;
    ray[2].far = -1;
    assert_int_equal(noc_view_cast(view, ray, 3, hit), NOC_OK);
    assert_true(!hit[0].hit && hit[1].hit && !hit[2].hit);
    close_view(view);
    noc_scene_destroy(s);
}

static void follows_instances_and_edits(void **state) {
    (void)state;
    noc_scene *s = street();
    noc_view *view = own_view(s, 1, NULL);
    noc_ray ray = RAY(12, 0, 1, -1, 0, 0);
    noc_hit h = one(view, ray);
    assert_at(&h, 8, 0, 1);
    assert_true(h.instance == 0 && h.shines && h.light == noc_scene_instance_light(s, 0, 1));
    assert_string_equal(noc_scene_object_name(s, (size_t)h.object), "door");
    assert_int_equal(noc_scene_set_transform(s, 0, (double[12]){ 1, 0, 0, 6, 0, 1, 0, 0, 0, 0, 1, .5 }), NOC_OK);
    h = one(view, ray);
    assert_at(&h, 8, 0, 1); /* staged is not published */
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    h = one(view, ray);
    assert_at(&h, 6, 0, 1);
    assert_int_equal(noc_scene_remove_instance(s, 0), NOC_OK);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    assert_false(one(view, ray).hit);
    close_view(view);
    noc_scene_destroy(s);
}

/* The same rays in any company and by any number of threads, as primary rays of a frame see it. */
static void many_are_as_one_and_as_a_frame(void **state) {
    (void)state;
    enum { W = 64, H = 48 };
    noc_scene *s = street();
    noc_view *alone = own_view(s, 1, NULL), *many = own_view(s, 4, NULL);
    noc_render_params p = noc_render_default_params();
    p.width = W;
    p.height = H;
    p.jitter = false;
    p.emitters = false;
    p.aovs = 1u << NOC_AOV_DEPTH | 1u << NOC_AOV_CLASS | 1u << NOC_AOV_NORMAL;
    noc_camera camera = look(3, -12, 3, 2, 0, 1.5, 60);
    static noc_ray rays[W * H];
    static noc_hit hits[W * H];
    for (int i = 0; i < W * H; i++)
        assert_int_equal(noc_camera_ray(&camera, W, H, (double[2]){ i % W + .5, i / W + .5 }, &rays[i]), NOC_OK);
    assert_int_equal(noc_view_cast(many, rays, W * H, hits), NOC_OK);
    assert_int_equal(noc_view_render(many, &camera, &p, NULL), NOC_OK);
    noc_channel *depth = noc_view_aov(many, NOC_AOV_DEPTH), *cls = noc_view_aov(many, NOC_AOV_CLASS);
    int met = 0, off = 0;
    for (int i = 0; i < W * H; i++) {
        noc_hit h = one(alone, rays[i]);
        assert_memory_equal(&h, &hits[i], sizeof(h));
        met += h.hit;
        off += h.hit ? fabs(h.distance - depth->value[i]) > 1e-3 * h.distance || (int)cls->value[i] != (int)h.cls
                     : depth->value[i] >= 0;
    }
    assert_true(met > W * H / 3 && met < W * H);
    assert_true(off <= 4); /* edges, where float directions decide */
    noc_channel_destroy(depth);
    noc_channel_destroy(cls);
    close_view(alone);
    close_view(many);
    noc_scene_destroy(s);
}

static void leaves_picture_and_history_alone(void **state) {
    (void)state;
    noc_scene *s = street();
    noc_render_params p = noc_render_default_params();
    p.width = p.height = 40;
    p.method = NOC_METHOD_RESTIR;
    noc_camera camera = look(3, -12, 3, 2, 0, 1.5, 60);
    noc_image *image[2];
    for (int casts = 0; casts < 2; casts++) {
        noc_view *view = own_view(s, 2, NULL);
        for (int frame = 0; frame < 3; frame++) {
            if (casts)
                assert_true(one(view, RAY(1, -3, 2, 0, 7, 0)).hit);
            assert_int_equal(noc_view_render(view, &camera, &p, NULL), NOC_OK);
        }
        if (casts)
            assert_true(one(view, RAY(1, -3, 2, 0, 7, 0)).hit);
        image[casts] = noc_view_image(view);
        close_view(view);
    }
    assert_memory_equal(image[0]->rgb, image[1]->rgb, 40 * 40 * 3 * sizeof(float));
    noc_image_destroy(image[0]);
    noc_image_destroy(image[1]);
    noc_scene_destroy(s);
}

static void refuses_what_is_no_ray(void **state) {
    (void)state;
    noc_scene *s = street();
    noc_log *log = noc_log_create(NULL);
    noc_view *view = own_view(s, 1, log);
    noc_hit hit[2] = { { .material = 77 }, { .material = 77 } };
    const noc_ray wrong[] = { RAY(NAN, 0, 0, 1, 0, 0), RAY(0, 0, 0, 0, 0, 0),   RAY(0, 0, 0, INFINITY, 0, 0),
                              RAY(0, 1e8, 0, 1, 0, 0), RAY(0, 0, 0, NAN, 0, 1), { { 0 }, { 1, 0, 0 }, NAN } };
    for (size_t i = 0; i < NOC_COUNT(wrong); i++) {
        noc_ray rays[2] = { RAY(0, 0, 1, 0, 1, 0), wrong[i] };
        assert_int_equal(noc_view_cast(view, rays, 2, hit), NOC_ERR_ARGUMENT);
        assert_non_null(strstr(noc_log_last_error(log), "cast: ray 1"));
        assert_true(hit[0].material == 77 && hit[1].material == 77);
    }
    assert_int_equal(noc_view_cast(view, NULL, 0, NULL), NOC_OK);
    close_view(view);
    noc_log_destroy(log);
    noc_scene_destroy(s);
}

static void an_empty_scene_has_nothing_to_meet(void **state) {
    (void)state;
    noc_scene *s = noc_scene_create(NULL);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_view *view = own_view(s, 1, NULL);
    assert_false(one(view, RAY(0, 0, 0, 0, 0, -1)).hit);
    close_view(view);
    noc_scene_destroy(s);
}

static void a_pixel_s_ray_goes_where_the_pixel_shows(void **state) {
    (void)state;
    noc_camera camera = look(1, 2, 3, 10, -4, 5, 40);
    const double pixel[2] = { 13.25, 40.5 };
    double back[2], place[3];
    noc_ray ray;
    assert_int_equal(noc_camera_ray(&camera, 80, 60, pixel, &ray), NOC_OK);
    for (int k = 0; k < 3; k++)
        place[k] = ray.origin[k] + 17 * ray.direction[k];
    assert_true(noc_camera_project(&camera, 80, 60, place, back, NULL));
    assert_true(fabs(back[0] - pixel[0]) < 1e-9 && fabs(back[1] - pixel[1]) < 1e-9);
    camera.target[0] = 1, camera.target[1] = 2, camera.target[2] = 3;
    assert_int_equal(noc_camera_ray(&camera, 80, 60, pixel, &ray), NOC_ERR_ARGUMENT);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(meets_the_nearest_and_tells_what_it_is),
        cmocka_unit_test(keeps_to_far),
        cmocka_unit_test(follows_instances_and_edits),
        cmocka_unit_test(many_are_as_one_and_as_a_frame),
        cmocka_unit_test(leaves_picture_and_history_alone),
        cmocka_unit_test(refuses_what_is_no_ray),
        cmocka_unit_test(an_empty_scene_has_nothing_to_meet),
        cmocka_unit_test(a_pixel_s_ray_goes_where_the_pixel_shows),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
