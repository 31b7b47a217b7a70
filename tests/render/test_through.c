/* Surfaces that let light through: what arrives behind them, and what is seen of them and behind them. */
#include "views.h"

#include "asking.h"
#include "scene/scene.h"

#include <nocturne/photometry.h>

enum { LUX = 1u << NOC_AOV_ILLUMINANCE };

static int pane(noc_scene *s, float transmittance, float albedo) {
    noc_material m = {
        .albedo = { albedo, albedo, albedo }, .roughness = 1, .cls = NOC_CLASS_OTHER, .transmittance = transmittance
    };
    return noc_scene_add_material(s, &m);
}

/* Four walls and a roof. */
static void box(noc_scene *s, int material, double half, double height) {
    double l = 2 * half;
    QUAD(s, material, -half, -half, 0, l, 0, 0, 0, 0, height);
    QUAD(s, material, -half, half, 0, l, 0, 0, 0, 0, height);
    QUAD(s, material, -half, -half, 0, 0, l, 0, 0, 0, height);
    QUAD(s, material, half, -half, 0, 0, l, 0, 0, 0, height);
    QUAD(s, material, -half, -half, height, l, 0, 0, 0, l, 0);
}

/* A floor and a wall under lights of all kinds, in two boxes of that transmittance; negative: in none. */
static noc_scene *greenhouse(int lights, float outer, float inner) {
    noc_scene *s = noc_scene_create(NULL);
    add_floor(s, matte(s, 0.5f), 0, 0, 0, 24);
    QUAD(s, 0, -6, 5, 0, 5, 0, 0, 0, 0, 3);
    for (int i = 0; i < lights; i++) {
        noc_light l = crowd_light(i, 5.7);
        l.position[2] += 5;
        l.direction[2] = -3;
        assert_true(noc_scene_add_light(s, &l) >= 0);
    }
    if (outer >= 0) {
        box(s, pane(s, outer, 0.5f), 24, 4.8);
        box(s, pane(s, inner, 0.9f), 22, 4.5);
    }
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    return s;
}

/* It sees the floor alone. */
static noc_camera inside(void) { return look(1, -12, 4, 0, -8, 0, 50); }

static noc_view *third_frame(noc_device *device, const noc_scene *s, const noc_render_params *p) {
    noc_camera c = inside();
    noc_view *v = noc_view_create(device, s);
    assert_non_null(v);
    for (int i = 0; i < 3; i++)
        assert_int_equal(noc_view_render(v, &c, p, NULL), NOC_OK);
    return v;
}

/* Illuminance of the floor in the closed scene is .15 of that in the open one, pixel by pixel. */
static void hold(noc_device *device, const noc_scene *open, const noc_scene *closed, const noc_render_params *p,
                 size_t way) {
    noc_view *a = third_frame(device, open, p), *b = third_frame(device, closed, p);
    noc_channel *all = view(a, NOC_AOV_ILLUMINANCE), *rest = view(b, NOC_AOV_ILLUMINANCE);
    int lit = 0;
    double sum = 0, rest_sum = 0;
    bool influence = p->candidates == NOC_CANDIDATES_INFLUENCE; /* it is tuned by the scene's surfaces: other numbers */
    for (int i = 0; i < N; i++) {
        lit += all->value[i] > 0;
        sum += all->value[i];
        rest_sum += rest->value[i];
        if (!influence && fabs(rest->value[i] - 0.15 * all->value[i]) > 1e-5 * (all->value[i] + 1e-3))
            fail_msg("way %zu, pixel %d: %g of %g lx", way, i, rest->value[i], all->value[i]);
    }
    assert_true(lit > N / 2 && fabs(rest_sum / sum / 0.15 - 1) < 0.05);
    noc_channel_destroy(all);
    noc_channel_destroy(rest);
    noc_view_destroy(a);
    noc_view_destroy(b);
}

/* Panes weaken what arrives, and change nothing of how it is found: each estimate is that of the scene without them,
 * times the product of their transmittances. */
static void weakened_in_every_method(void **state) {
    (void)state;
    static const struct {
        noc_method method;
        noc_candidates candidates;
        noc_bias bias;
        bool rays;
    } ways[] = {
        { NOC_METHOD_REFERENCE, NOC_CANDIDATES_LISTS, NOC_BIAS_MIS, false },
        { NOC_METHOD_IS, NOC_CANDIDATES_UNIFORM, NOC_BIAS_MIS, false },
        { NOC_METHOD_RIS, NOC_CANDIDATES_INFLUENCE, NOC_BIAS_MIS, false },
        { NOC_METHOD_RIS, NOC_CANDIDATES_LISTS, NOC_BIAS_MIS, false },
        { NOC_METHOD_RESTIR, NOC_CANDIDATES_LISTS, NOC_BIAS_PAIRWISE, false },
        { NOC_METHOD_RESTIR, NOC_CANDIDATES_UNIFORM, NOC_BIAS_PAIRWISE, true },
        { NOC_METHOD_RESTIR, NOC_CANDIDATES_POWER, NOC_BIAS_MIS, true },
        { NOC_METHOD_RESTIR, NOC_CANDIDATES_LIGHT_BVH, NOC_BIAS_COUNTED, true },
        { NOC_METHOD_RESTIR, NOC_CANDIDATES_INFLUENCE, NOC_BIAS_BIASED, false },
    };
    noc_device *device = own_device(2, NULL);
    noc_scene *open = greenhouse(24, -1, -1), *closed = greenhouse(24, 0.5f, 0.3f);
    for (size_t k = 0; k < NOC_COUNT(ways); k++) {
        noc_render_params p = with(ways[k].method, ways[k].candidates, LUX);
        p.bias = ways[k].bias;
        p.bias_rays = ways[k].rays;
        p.sky = 0;
        hold(device, open, closed, &p, k);
    }
    noc_device_destroy(device);
    answer before = ask_point(open, point_at(2, 1, 0), 1, 20000),
           behind = ask_point(closed, point_at(2, 1, 0), 1, 20000);
    assert_true(before.sum.lux.value > 1 && fabs(behind.sum.lux.value / before.sum.lux.value - 0.15) < 1e-6);
    noc_scene_destroy(open);
    noc_scene_destroy(closed);
}

static void weakened_sky(void **state) {
    (void)state;
    noc_scene *open = greenhouse(0, -1, -1), *closed = greenhouse(0, 0.5f, 0.3f);
    noc_render_params p = with(NOC_METHOD_RIS, NOC_CANDIDATES_LISTS, LUX);
    p.sky = 0.5;
    noc_device *device = own_device(2, NULL);
    hold(device, open, closed, &p, 0);
    noc_device_destroy(device);
    noc_scene_destroy(open);
    noc_scene_destroy(closed);
}

/* A panel of 1000 cd/m2 behind two black panes, and a grey pane before nothing, which a lamp beside the eye lights. */
static void seen_through(void **state) {
    (void)state;
    noc_camera c = look(0, -10, 2, 0, 0, 2, 20);
    enum { FRAMES = 64 };
    for (int jitter = 0; jitter < 2; jitter++) {
        noc_scene *s = noc_scene_create(NULL);
        noc_material panel = { .emission = { 1000, 1000, 1000 }, .roughness = 1 };
        QUAD(s, noc_scene_add_material(s, &panel), -9, 5, -5, 18, 0, 0, 0, 0, 14);
        QUAD(s, pane(s, 0.5f, 0), -9, 3, -5, 18, 0, 0, 0, 0, 14);
        QUAD(s, pane(s, 0.3f, 0), -9, 2, -5, 18, 0, 0, 0, 0, 14);
        assert_int_equal(noc_scene_commit(s), NOC_OK);
        noc_render_params p = with(NOC_METHOD_RIS, NOC_CANDIDATES_LISTS, 0);
        p.sky = 0;
        p.accumulate = true;
        p.jitter = jitter;
        noc_view *v = rendered(s, &c, &p, FRAMES, 2);
        noc_image *image = noc_view_image(v);
        double mean = 0, square = 0;
        for (size_t i = 0; i < N; i++) {
            mean += image->rgb[3 * i] / 1000 / N;
            square += image->rgb[3 * i] / 1000 * image->rgb[3 * i] / 1000 / N;
        }
        double sigma = sqrt(0.15 * 0.85 / FRAMES); /* of a pixel: each frame sees the panel or a pane */
        assert_true(fabs(mean - 0.15) < 4 * sigma / sqrt(N));
        assert_true(fabs(sqrt(square - mean * mean) / sigma - 1) < 0.1);
        noc_image_destroy(image);
        close_view(v);
        noc_scene_destroy(s);
    }
}

/* What a pane reflects is seen by what it does not let through. */
static void seen_upon(void **state) {
    (void)state;
    noc_camera c = look(0, -10, 2, 0, 0, 2, 20);
    double mean[2] = { 0 };
    for (int clear = 0; clear < 2; clear++) {
        noc_scene *s = noc_scene_create(NULL);
        QUAD(s, pane(s, clear ? 0.4f : 0, 0.5f), -9, 2, -5, 18, 0, 0, 0, 0, 14);
        point_light(s, 0, -9, 3, 500);
        assert_int_equal(noc_scene_commit(s), NOC_OK);
        noc_render_params p = with(NOC_METHOD_RESTIR, NOC_CANDIDATES_LISTS, 0);
        p.sky = 0;
        p.accumulate = true;
        noc_view *v = rendered(s, &c, &p, 100, 2);
        noc_image *image = noc_view_image(v);
        for (size_t i = 0; i < N; i++)
            mean[clear] += image->rgb[3 * i] / N;
        noc_image_destroy(image);
        close_view(v);
        noc_scene_destroy(s);
    }
    assert_true(mean[0] > 0.1 && fabs(mean[1] / mean[0] - 0.6) < 0.01);
}

/* An image with a hole in its right half over a floor, seen from below and from above. */
static void holes(void **state) {
    (void)state;
    static const unsigned char rgb[12] = { 128, 128, 128, 128, 128, 128, 128, 128, 128, 128, 128, 128 },
                               hole[4] = { 0, 1, 0, 1 };
    noc_camera c = look(0, -12, 3, 0, 0, 0, 50);
    noc_scene *s = noc_scene_create(NULL);
    add_floor(s, matte(s, 0.5f), 0, 0, 0, 60);
    noc_material m = { .albedo = { 1, 1, 1 }, .roughness = 1, .cutout = true };
    m.texture =
        noc_scene_add_texture(s, &(noc_texture){
                                     .width = 2, .height = 2, .rgb = rgb, .holes = hole, .wrap = NOC_WRAP_CLAMP });
    double xyz[] = { -50, -50, 4, 50, -50, 4, 50, 50, 4, -50, 50, 4 };
    noc_mesh leaf = { .vertex_count = 4,
                      .positions = xyz,
                      .triangle_count = 2,
                      .indices = (uint32_t[]){ 0, 1, 2, 0, 2, 3 },
                      .material = noc_scene_add_material(s, &m),
                      .uv = (float[]){ 0, 0, 1, 0, 1, 1, 0, 1 } };
    assert_true(noc_scene_add_mesh(s, &leaf) >= 0);
    point_light(s, 0, 2, 8, 900);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_render_params p = with(NOC_METHOD_RIS, NOC_CANDIDATES_LISTS, LUX);
    p.sky = 0;
    noc_view *v = rendered(s, &c, &p, 1, 2);
    noc_channel *e = view(v, NOC_AOV_ILLUMINANCE);
    for (int i = N / 2; i < N; i++) {
        double q[3];
        floor_point(&c, &p, i % W, i / W, 0, q);
        double d2 = q[0] * q[0] + (q[1] - 2) * (q[1] - 2) + 64, lux = 900 * 8 / (d2 * sqrt(d2));
        if (fabs(q[0]) > 1e-3) /* the light is over the edge */
            assert_true(fabs(e->value[i] - (q[0] > 0 ? lux : 0)) < 1e-4 * lux);
    }
    noc_channel_destroy(e);
    noc_ray down[] = { { .origin = { -5, 0, 9 }, .direction = { 0, 0, -1 }, .far = 20 },
                       { .origin = { 5, 0, 9 }, .direction = { 0, 0, -1 }, .far = 20 } };
    noc_hit hits[2];
    assert_int_equal(noc_view_cast(v, down, 2, hits), NOC_OK);
    assert_true(fabs(hits[0].distance - 5) < 1e-4 && fabs(hits[1].distance - 9) < 1e-4);
    close_view(v);
    noc_scene_destroy(s);
}

static int glass_model(noc_scene *s) {
    double xyz[] = { -99, -99, 0, 99, -99, 0, 99, 99, 0, -99, 99, 0 };
    int model = noc_scene_add_model(s, "glass");
    noc_mesh m = { .vertex_count = 4,
                   .positions = xyz,
                   .triangle_count = 2,
                   .indices = (uint32_t[]){ 0, 1, 2, 0, 2, 3 },
                   .material = pane(s, 0.5f, 0.1f),
                   .model = model };
    assert_true(noc_scene_add_mesh(s, &m) >= 0);
    return model;
}

/* Panes of models, that are added, moved and removed while frames are rendered. */
static void moving_panes(void **state) {
    (void)state;
    noc_camera c = look(0, -12, 3, 0, 0, 0, 50);
    noc_scene *s = noc_scene_create(NULL);
    add_floor(s, matte(s, 0.5f), 0, 0, 0, 60);
    point_light(s, 1, 2, 8, 900);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_render_params p = with(NOC_METHOD_RIS, NOC_CANDIDATES_LISTS, LUX);
    p.sky = 0;
    noc_view *v = own_view(s, 2, NULL);
    int model = 0, instance[2] = { 0 };
    static const double expected[] = { 1, 0.5, 0.25, 0.25, 0.25, 0.5, 0.8, 1 };
    double one = 0;
    for (size_t step = 0; step < NOC_COUNT(expected); step++) {
        noc_instance at = { model, { [0] = 1, [5] = 1, [10] = 1, [11] = 4 + (double)step } };
        switch (step) {
        case 1:
            model = at.model = glass_model(s);
            instance[0] = noc_scene_add_instance(s, &at);
            break;
        case 2: instance[1] = noc_scene_add_instance(s, &at); break;
        case 3: noc_scene_set_transform(s, instance[1], at.transform); break; /* 7 m: under the light */
        case 4: noc_scene_set_material(s, 1, &(noc_material){ .roughness = 0.5f, .transmittance = 0.5f }); break;
        case 5: noc_scene_remove_instance(s, instance[0]); break;
        case 6: noc_scene_set_material(s, 1, &(noc_material){ .roughness = 1, .transmittance = 0.8f }); break;
        case 7:
            at.transform[11] = 12; /* over it */
            noc_scene_set_transform(s, instance[1], at.transform);
            break;
        default: break;
        }
        assert_int_equal(noc_scene_commit(s), NOC_OK);
        assert_int_equal(noc_view_render(v, &c, &p, NULL), NOC_OK);
        noc_channel *e = view(v, NOC_AOV_ILLUMINANCE);
        int at_floor = (H - 2) * W + W / 2;
        one = step ? one : e->value[at_floor];
        if (fabs(e->value[at_floor] / one - expected[step]) > 1e-5)
            fail_msg("step %zu: %g of %g lx", step, e->value[at_floor], one);
        noc_channel_destroy(e);
    }
    close_view(v);
    noc_scene_destroy(s);
}

static void refusals(void **state) {
    (void)state;
    noc_scene *s = noc_scene_create(NULL);
    noc_material clear = { .roughness = 1, .transmittance = 0.5f }, solid = { .roughness = 1 },
                 shining = { .roughness = 1, .transmittance = 0.5f, .emission = { 1, 1, 1 } },
                 wrong = { .roughness = 1, .transmittance = 1.5f };
    int a = noc_scene_add_material(s, &clear), b = noc_scene_add_material(s, &solid);
    assert_true(a >= 0 && b >= 0);
    assert_int_equal(noc_scene_add_material(s, &shining), -1);
    assert_int_equal(noc_scene_add_material(s, &wrong), -1);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    assert_int_equal(noc_scene_set_material(s, a, &solid), NOC_ERR_ARGUMENT);
    assert_int_equal(noc_scene_set_material(s, b, &clear), NOC_ERR_ARGUMENT);
    clear.transmittance = 0.9f;
    assert_int_equal(noc_scene_set_material(s, a, &clear), NOC_OK);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_scene_destroy(s);
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(weakened_in_every_method),
                                        cmocka_unit_test(weakened_sky),
                                        cmocka_unit_test(seen_through),
                                        cmocka_unit_test(seen_upon),
                                        cmocka_unit_test(holes),
                                        cmocka_unit_test(moving_panes),
                                        cmocka_unit_test(refusals) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
