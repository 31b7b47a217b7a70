/* Smoothing for display (nocturne/smooth.h). */
#include "views.h"

#include <nocturne/smooth.h>
#include <string.h>

/* Pixels of a picture, and its mean luminance without emitters. */
static double mean_of(const noc_image *image) {
    double sum = 0;
    for (int i = 0; i < image->width * image->height; i++)
        sum += luma(image->rgb + 3 * i) - luma(image->coverage + 4 * i);
    return sum / (image->width * image->height);
}

static noc_render_params moving(noc_method method) {
    noc_render_params p = with(method, NOC_CANDIDATES_LISTS, NOC_SMOOTH_AOVS);
    p.jitter = true;
    return p;
}

static void check_picture(const noc_image *image, int width, int height) {
    assert_non_null(image);
    assert_true(image->smoothed && image->width == width && image->height == height && image->coverage);
    for (int i = 0; i < 3 * width * height; i++)
        assert_true(isfinite(image->rgb[i]) && image->rgb[i] >= 0);
    for (int i = 0; i < 4 * width * height; i++)
        assert_true(isfinite(image->coverage[i]) && image->coverage[i] >= 0);
    for (int i = 0; i < width * height; i++)
        assert_true(image->coverage[4 * i + 3] <= 1.0001f);
}

/* While nothing moves the picture comes to the mean of frames, and no light is lost or made. Jitter makes edges of
 * several surfaces, which is most of so small a picture. */
static void rests_on_the_mean(void **state) {
    noc_scene *s = street(60);
    noc_camera c = along();
    for (int jitter = 0; jitter < 2; jitter++) {
        noc_render_params p = moving(NOC_METHOD_RIS);
        p.jitter = jitter;
        noc_view *v = rendered(s, &c, &p, 0, 1);
        noc_smoother *smoother = noc_smoother_create(noc_view_device(v));
        const noc_image *image = NULL;
        for (int i = 0; i < 300; i++) {
            assert_int_equal(noc_view_render(v, &c, &p, NULL), NOC_OK);
            image = noc_smoother_step(smoother, v, NULL);
        }
        check_picture(image, W, H);
        noc_image *mean = noc_view_image(v);
        double off = 0, all = 0;
        for (int i = 0; i < N; i++) {
            double x = luma(image->rgb + 3 * i) - luma(image->coverage + 4 * i);
            double r = luma(mean->rgb + 3 * i) - luma(mean->coverage + 4 * i);
            off += fabs(x - r);
            all += r;
        }
        double energy = mean_of(image) * N / all;
        print_message("# at rest%s: off by %.2f%% of the mean, energy %.4f\n", jitter ? ", jitter" : "",
                      100 * off / all, energy);
        assert_true(off < (jitter ? .04 : .003) * all && fabs(energy - 1) < (jitter ? .02 : .001));
        noc_image_destroy(mean);
        noc_smoother_destroy(smoother);
        close_view(v);
    }
    noc_scene_destroy(s);
}

/* Exposure is metered beside emitters, so they are told as in the picture that is not smoothed. */
static void marks_emitters(void **state) {
    noc_scene *s = street(60);
    noc_camera c = along();
    noc_render_params p = moving(NOC_METHOD_RIS);
    p.jitter = false;
    noc_view *v = rendered(s, &c, &p, 0, 1);
    noc_smoother *smoother = noc_smoother_create(noc_view_device(v));
    assert_int_equal(noc_view_render(v, &c, &p, NULL), NOC_OK);
    const noc_image *image = noc_smoother_step(smoother, v, NULL);
    noc_image *own = noc_view_image(v);
    check_picture(image, W, H);
    assert_non_null(image->emitter);
    assert_memory_equal(image->emitter, own->emitter, N);
    assert_non_null(memchr(own->emitter, 1, N));
    assert_non_null(memchr(own->emitter, 0, N));
    noc_image_destroy(own);
    for (int frame = 0; frame < 6; frame++) { /* what they added before is seen for a while */
        c.target[2] += .3;
        assert_int_equal(noc_view_render(v, &c, &p, NULL), NOC_OK);
        image = noc_smoother_step(smoother, v, NULL);
        own = noc_view_image(v);
        for (int i = 0; i < N; i++)
            assert_int_equal(image->emitter[i], own->emitter[i] || image->coverage[4 * i + 3] > 0);
        noc_image_destroy(own);
    }
    noc_smoother_destroy(smoother);
    close_view(v);
    noc_scene_destroy(s);
}

/* A floor that a lamp lights, which belongs to a group, and a box before it that is an instance. */
static noc_scene *stage(int *box) {
    noc_scene *s = noc_scene_create(NULL);
    int grey = matte(s, .5f), dark = matte(s, .05f), model = noc_scene_add_model(s, "box");
    add_floor(s, grey, 0, 0, 0, 20);
    noc_mesh side = { .vertex_count = 4,
                      .positions = (double[]){ -1.5, 0, 0, 1.5, 0, 0, 1.5, 0, 2, -1.5, 0, 2 },
                      .triangle_count = 2,
                      .indices = (uint32_t[]){ 0, 1, 2, 0, 2, 3 },
                      .material = dark,
                      .model = model };
    assert_true(noc_scene_add_mesh(s, &side) >= 0);
    *box = noc_scene_add_instance(s, &(noc_instance){ .model = model,
                                                      .transform = { 1, 0, 0, -1, 0, 1, 0, 0, 0, 0, 1, 0 } });
    int group = noc_scene_add_group(s, "lamps");
    for (int i = 0; i < 12; i++) {
        noc_light l = { .kind = NOC_LIGHT_SPHERE,
                        .position = { -6 + i, 3, 4 + i % 3 },
                        .radius = .1,
                        .emission = { 900, 900, 900 },
                        .group = i ? group : 0 };
        assert_true(noc_scene_add_light(s, &l) >= 0);
    }
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    return s;
}

/* The mean light of the picture without emitters, after so many frames, beside what frames have themselves. */
static double ratio_after(noc_view *v, noc_smoother *smoother, const noc_camera *c, const noc_render_params *p,
                          int frames) {
    const noc_image *image = NULL;
    double have, want = 0;
    for (int i = 0; i < frames; i++) {
        assert_int_equal(noc_view_render(v, c, p, NULL), NOC_OK);
        image = noc_smoother_step(smoother, v, NULL);
        check_picture(image, W, H);
    }
    have = mean_of(image);
    noc_view_restart(v);
    for (int i = 0; i < 32; i++)
        assert_int_equal(noc_view_render(v, c, p, NULL), NOC_OK);
    noc_image *mean = noc_view_image(v);
    want = mean_of(mean);
    noc_image_destroy(mean);
    return have / want;
}

/* Lamps that are switched off after a long rest are forgotten within frames, and so is a box that has gone. */
static void forgets_what_changed(void **state) {
    for (int switched = 0; switched < 2; switched++) {
        int box;
        noc_scene *s = stage(&box);
        noc_camera c = look(0, -9, 5, 0, 0, 1, 50);
        noc_render_params p = moving(NOC_METHOD_RIS);
        p.jitter = false;
        noc_view *v = rendered(s, &c, &p, 0, 1);
        noc_smoother *smoother = noc_smoother_create(noc_view_device(v));
        ratio_after(v, smoother, &c, &p, 40);
        noc_smoother_reset(smoother);
        for (int i = 0; i < 40; i++) {
            assert_int_equal(noc_view_render(v, &c, &p, NULL), NOC_OK);
            assert_non_null(noc_smoother_step(smoother, v, NULL));
        }
        if (switched)
            assert_int_equal(noc_scene_set_group(s, 1, (const float[]){ .1f, .1f, .1f }), NOC_OK);
        else
            assert_int_equal(noc_scene_remove_instance(s, box), NOC_OK);
        assert_int_equal(noc_scene_commit(s), NOC_OK);
        double ratio = ratio_after(v, smoother, &c, &p, 8);
        print_message("# 8 frames after %s: %.3f of the light\n", switched ? "lamps were dimmed" : "a box went", ratio);
        assert_true(fabs(ratio - 1) < (switched ? .1 : .05)); /* a tenth of a tenth of the light that was */
        noc_smoother_destroy(smoother);
        close_view(v);
        noc_scene_destroy(s);
    }
}

static void turn(noc_camera *c, int frame) {
    c->target[0] = .15 * frame;
    c->eye[1] = -10 + .1 * frame;
}

/* Any number of threads and of lanes, sizes that are no multiple of anything, and changes of size on the way. */
static void the_same_for_any_threads(void **state) {
    static const int sizes[][2] = { { 1, 1 }, { 37, 23 }, { 37, 23 }, { 64, 5 }, { 1, 40 }, { 133, 21 }, { 131, 20 } };
    noc_scene *s = street(60);
    noc_image *first[NOC_COUNT(sizes)] = { 0 };
    for (int round = 0; round < 3; round++) {
        noc_camera c = along();
        noc_render_params p = moving(NOC_METHOD_RESTIR);
        int threads = 1 + 2 * (round & 1);
        p.isa = round < 2 ? NOC_ISA_AUTO : NOC_ISA_BASELINE;
        noc_view *v = rendered(s, &c, &p, 0, threads);
        noc_smoother *smoother = noc_smoother_create(noc_view_device(v));
        for (size_t i = 0; i < NOC_COUNT(sizes); i++) {
            p.width = sizes[i][0];
            p.height = sizes[i][1];
            turn(&c, (int)i);
            assert_int_equal(noc_view_render(v, &c, &p, NULL), NOC_OK);
            const noc_image *image = noc_smoother_step(smoother, v, NULL);
            check_picture(image, p.width, p.height);
            assert_ptr_equal(noc_smoother_step(smoother, v, NULL), image);
            size_t bytes = (size_t)p.width * (size_t)p.height * 3 * sizeof(float);
            if (first[i]) {
                assert_memory_equal(first[i]->rgb, image->rgb, bytes);
            } else {
                first[i] = noc_image_create(p.width, p.height, NULL);
                memcpy(first[i]->rgb, image->rgb, bytes);
            }
        }
        noc_smoother_destroy(smoother);
        close_view(v);
    }
    for (size_t i = 0; i < NOC_COUNT(sizes); i++)
        noc_image_destroy(first[i]);
    noc_scene_destroy(s);
}

/* What is off in the last picture of a walk, and what in the frame that it is made of, beside the mean of frames. */
typedef struct walk {
    double relmse, frame; /* of luminance, where no emitter is seen */
    double ratio;         /* of the means */
    double cover, covers; /* of the share of emitters: mean square error of the picture, of the frame */
} walk;

static double relative_error(const float *x, const float *r, double floor) {
    double a = luma(x), b = luma(r);
    return (a - b) * (a - b) / (b * b + floor * floor);
}

static walk walked(noc_scene *s, noc_camera c, double step, int steps) {
    noc_render_params p = moving(NOC_METHOD_RIS);
    noc_view *v = rendered(s, &c, &p, 0, 1);
    noc_smoother *smoother = noc_smoother_create(noc_view_device(v));
    const noc_image *image = NULL;
    walk w = { 0 };
    for (int i = 0; i < steps; i++) {
        c.eye[1] += step;
        c.target[1] += step;
        noc_view_restart(v);
        assert_int_equal(noc_view_render(v, &c, &p, NULL), NOC_OK);
        image = noc_smoother_step(smoother, v, NULL);
        check_picture(image, W, H);
    }
    noc_image *frame = noc_view_image(v);
    noc_view_restart(v);
    for (int i = 0; i < 128; i++)
        assert_int_equal(noc_view_render(v, &c, &p, NULL), NOC_OK);
    noc_image *mean = noc_view_image(v);
    double dark = 0, of[2] = { 0 };
    int n = 0;
    for (int i = 0; i < N; i++)
        dark += mean->emitter[i] ? 0 : .01 * luma(mean->rgb + 3 * i) / N;
    for (int i = 0; i < N; i++) {
        double share = mean->coverage[4 * i + 3];
        w.cover += pow(image->coverage[4 * i + 3] - share, 2) / N;
        w.covers += pow(frame->coverage[4 * i + 3] - share, 2) / N;
        if (mean->emitter[i])
            continue;
        w.relmse += relative_error(image->rgb + 3 * i, mean->rgb + 3 * i, dark);
        w.frame += relative_error(frame->rgb + 3 * i, mean->rgb + 3 * i, dark);
        of[0] += luma(image->rgb + 3 * i);
        of[1] += luma(mean->rgb + 3 * i);
        n++;
    }
    w.relmse /= NOC_MAX(n, 1);
    w.frame /= NOC_MAX(n, 1);
    w.ratio = of[1] > 0 ? of[0] / of[1] : 1;
    noc_image_destroy(frame);
    noc_image_destroy(mean);
    noc_smoother_destroy(smoother);
    close_view(v);
    return w;
}

static void add_lamp(noc_scene *s, double x, double y, double z, float emission) {
    noc_light l = {
        .kind = NOC_LIGHT_SPHERE, .position = { x, y, z }, .radius = .1, .emission = { emission, emission, emission }
    };
    assert_true(noc_scene_add_light(s, &l) >= 0);
}

/* A wet road mirrors lamps ahead, and stripes of paint on it do not: what one mirrors is not given to the other, though
 * they lie in a plane, and it stays before the eye. */
static void walks_on_a_wet_road(void **state) {
    noc_scene *s = noc_scene_create(NULL);
    int road =
        noc_scene_add_material(s, &(noc_material){ .albedo = { .03f, .03f, .03f }, .f0 = .05f, .roughness = .5f });
    int paint = matte(s, .6f);
    for (int i = 0; i < 24; i++)
        QUAD(s, i & 1 ? paint : road, -20, -12 + i, 0, 40, 0, 0, 0, 1, 0);
    for (int i = -2; i <= 2; i++)
        add_lamp(s, 3 * i, 14, 2.5, 4000);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    walk w = walked(s, look(0, -14, 1.6, 0, -4, .3, 60), .08, 40);
    print_message("# wet road: relMSE %.4f, of the frame %.4f, mean %.4f\n", w.relmse, w.frame, w.ratio);
    assert_true(w.relmse < .5 && w.ratio < 1.1);
    noc_scene_destroy(s);
}

/* Lamps in a window beside the way: their images lie behind it, and the glass around them is dark. */
static void walks_past_a_window(void **state) {
    noc_scene *s = noc_scene_create(NULL);
    int glass =
        noc_scene_add_material(s, &(noc_material){ .albedo = { .01f, .01f, .01f }, .f0 = .04f, .roughness = .1f });
    add_floor(s, matte(s, .3f), 0, 0, 0, 30);
    QUAD(s, glass, 2, -30, 0, 0, 60, 0, 0, 0, 6);
    for (int i = 0; i < 6; i++)
        add_lamp(s, -6, -10 + 6 * i, 3, 4000);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    walk w = walked(s, look(0, -12, 1.6, 6, 0, 2, 60), .08, 40);
    print_message("# window: relMSE %.4f, of the frame %.4f, mean %.4f\n", w.relmse, w.frame, w.ratio);
    assert_true(w.relmse < .1 && fabs(w.ratio - 1) < .1);
    noc_scene_destroy(s);
}

/* Edges of emitters: their share of pixels is nearer the mean than a frame's, which has one sample. */
static void walks_to_lit_windows(void **state) {
    noc_scene *s = noc_scene_create(NULL);
    int lit =
        noc_scene_add_material(s, &(noc_material){
                                      .albedo = { .5f, .5f, .5f }, .roughness = 1, .emission = { 300, 250, 200 } });
    QUAD(s, matte(s, .1f), -20, 10, 0, 40, 0, 0, 0, 0, 20);
    for (int i = 0; i < 30; i++)
        QUAD(s, lit, -8 + 3 * (i % 6), 9.9, 1 + 2.5 * (i / 6), 1.1, 0, 0, 0, 0, 1.3);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    walk w = walked(s, look(0, -12, 5, 0, 0, 5, 60), .08, 40);
    print_message("# lit windows: share off by %.5f, of the frame %.5f\n", w.cover, w.covers);
    assert_true(w.covers > .005 && w.cover < .3 * w.covers);
    noc_scene_destroy(s);
}

/* What a step refuses, and what it begins anew after. */
static void refuses(void **state) {
    noc_scene *s = street(8);
    noc_camera c = along();
    noc_render_params p = moving(NOC_METHOD_RIS);
    noc_view *v = rendered(s, &c, &p, 0, 1), *other = rendered(s, &c, &p, 1, 1);
    noc_smoother *smoother = noc_smoother_create(noc_view_device(v));
    assert_null(noc_smoother_step(smoother, v, NULL));
    assert_null(noc_smoother_step(smoother, other, NULL));
    assert_null(noc_smoother_step(smoother, NULL, NULL));
    assert_null(noc_smoother_step(NULL, v, NULL));
    assert_null(noc_smoother_create(NULL));
    noc_smoother_destroy(NULL);
    noc_smoother_reset(NULL);
    p.aovs = 0;
    assert_int_equal(noc_view_render(v, &c, &p, NULL), NOC_OK);
    assert_null(noc_smoother_step(smoother, v, NULL));
    p.aovs = NOC_SMOOTH_AOVS;
    assert_int_equal(noc_view_render(v, &c, &p, NULL), NOC_OK);
    assert_null(noc_smoother_step(smoother, v, &(noc_smooth_params){ 0, 5, true }));
    assert_null(noc_smoother_step(smoother, v, &(noc_smooth_params){ 32, 7, true }));
    check_picture(noc_smoother_step(smoother, v, &(noc_smooth_params){ 1, 0, false }), W, H);
    noc_smoother_destroy(smoother);
    close_view(v);
    close_view(other);
    noc_scene_destroy(s);
}

/* Figures are not made of smoothed pictures. */
static void is_in_no_figures(void **state) {
    noc_scene *s = street(8);
    noc_camera c = along();
    noc_render_params p = moving(NOC_METHOD_RIS);
    noc_view *v = rendered(s, &c, &p, 1, 1);
    noc_smoother *smoother = noc_smoother_create(noc_view_device(v));
    const noc_image *image = noc_smoother_step(smoother, v, NULL);
    noc_image *frame = noc_view_image(v);
    noc_comparison comparison;
    assert_int_equal(noc_image_compare(image, frame, NULL, &comparison, NULL), NOC_ERR_ARGUMENT);
    assert_int_equal(noc_image_compare(frame, image, NULL, &comparison, NULL), NOC_ERR_ARGUMENT);
    assert_int_equal(noc_image_compare(frame, frame, NULL, &comparison, NULL), NOC_OK);
    noc_image_destroy(frame);
    noc_smoother_destroy(smoother);
    close_view(v);
    noc_scene_destroy(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rests_on_the_mean),        cmocka_unit_test(marks_emitters),
        cmocka_unit_test(forgets_what_changed),     cmocka_unit_test(walks_on_a_wet_road),
        cmocka_unit_test(walks_past_a_window),      cmocka_unit_test(walks_to_lit_windows),
        cmocka_unit_test(the_same_for_any_threads), cmocka_unit_test(refuses),
        cmocka_unit_test(is_in_no_figures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
