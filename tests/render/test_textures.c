/* Textures in pictures: a wall of four colours the right way up, the same bits for all machines, far ones by their
 * mean. */
#include "../test.h"

#include "../own_view.h"
#include "base/base.h"
#include "scene/scene.h"

#include <math.h>

enum { WIDTH = 64, HEIGHT = 48 };

/* Top left red, top right green, bottom left blue, bottom right white: of albedo 0.5 and 0.02. */
static int four_colours(noc_scene *scene, int side) {
    static unsigned char rgb[3 * 64 * 64];
    for (int y = 0; y < side; y++)
        for (int x = 0; x < side; x++) {
            int right = 2 * x >= side, low = 2 * y >= side;
            for (int c = 0; c < 3; c++)
                rgb[3 * (y * side + x) + c] = (low && right) || (low ? c == 2 : c == right) ? 128 : 0;
        }
    return noc_scene_add_texture(scene, &(noc_texture){ side, side, rgb, .linear = true, .wrap = NOC_WRAP_CLAMP });
}

/* A wall of 4 m x 4 m at y = 0 that is seen from -y; placed: it has places in the texture. as_model: through
 * an instance that is twice as large. */
static void add_wall(noc_scene *scene, int texture, bool placed, bool as_model, double scale) {
    noc_material m = { .albedo = { 1, 1, 1 }, .roughness = 1, .cls = NOC_CLASS_WALL, .texture = texture };
    double s = scale * (as_model ? 1 : 2);
    const double xyz[] = { -s, 0, -s, s, 0, -s, s, 0, s, -s, 0, s };
    const float uv[] = { 0, 0, 1, 0, 1, 1, 0, 1 };
    noc_mesh mesh = { .vertex_count = 4,
                      .positions = xyz,
                      .triangle_count = 2,
                      .indices = (uint32_t[]){ 0, 1, 2, 0, 2, 3 },
                      .material = noc_scene_add_material(scene, &m),
                      .model = as_model ? noc_scene_add_model(scene, "wall") : 0,
                      .uv = placed ? uv : NULL };
    assert_true(noc_scene_add_mesh(scene, &mesh) >= 0);
    if (as_model) {
        noc_instance in = { mesh.model, { 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0 } };
        assert_true(noc_scene_add_instance(scene, &in) >= 0);
    }
}

static noc_scene *lit_wall(bool placed, bool as_model, double scale) {
    noc_scene *scene = noc_scene_create(NULL);
    add_wall(scene, four_colours(scene, 32), placed, as_model, scale);
    noc_light far = { .kind = NOC_LIGHT_POINT, .position = { 0, -1000, 0 }, .emission = { 1e7f, 1e7f, 1e7f } };
    assert_true(noc_scene_add_light(scene, &far) >= 0);
    assert_int_equal(noc_scene_commit(scene), NOC_OK);
    return scene;
}

static noc_scene *wall_scene(bool as_model, double scale) { return lit_wall(true, as_model, scale); }

/* Four frames of a view, from the first one on. */
static noc_image *frames_of(noc_view *view, noc_isa isa, double distance, noc_method method) {
    noc_camera camera = noc_camera_default();
    noc_render_params p = noc_render_default_params();
    camera.eye[1] = -distance;
    camera.fov_deg = 40;
    p.width = WIDTH;
    p.height = HEIGHT;
    p.isa = isa;
    p.method = method;
    p.sky = 0;
    noc_view_reset(view);
    for (int i = 0; i < 4; i++)
        assert_int_equal(noc_view_render(view, &camera, &p, NULL), NOC_OK);
    return noc_view_image(view);
}

static noc_image *picture(const noc_scene *scene, double distance) {
    noc_view *view = own_view(scene, 1, NULL);
    noc_image *image = frames_of(view, NOC_ISA_AUTO, distance, NOC_METHOD_RIS);
    close_view(view);
    return image;
}

static const float *pixel(const noc_image *image, int x, int y) { return image->rgb + 3 * (y * image->width + x); }

/* Light of 1e7 cd from 1000 m: 10 lx, of which albedo / pi is seen. */
static void assert_colour(const float *rgb, double r, double g, double b) {
    const double want[3] = { r, g, b };
    for (int c = 0; c < 3; c++)
        if (fabs(rgb[c] - want[c] * 10 / M_PI) > 0.01 * 10 / M_PI)
            fail_msg("%g %g %g is not %g %g %g", rgb[0] * M_PI / 10, rgb[1] * M_PI / 10, rgb[2] * M_PI / 10, r, g, b);
}

static void test_way_up(void **state) {
    (void)state;
    for (int as_model = 0; as_model < 2; as_model++) {
        noc_scene *scene = wall_scene(as_model, 1);
        noc_image *image = picture(scene, 6);
        const double a = 128 / 255.0, d = 0.02;
        assert_colour(pixel(image, 22, 14), a, d, d);
        assert_colour(pixel(image, 42, 14), d, a, d);
        assert_colour(pixel(image, 22, 34), d, d, a);
        assert_colour(pixel(image, 42, 34), a, a, a);
        noc_image_destroy(image);
        noc_scene_destroy(scene);
    }
}

/* A texture that no mesh has a place in is not seen. */
static void test_no_places(void **state) {
    (void)state;
    noc_scene *scene = lit_wall(false, false, 1);
    noc_image *image = picture(scene, 6);
    assert_colour(pixel(image, 22, 14), 1, 1, 1);
    assert_colour(pixel(image, 42, 34), 1, 1, 1);
    noc_image_destroy(image);
    noc_scene_destroy(scene);
}

/* Of a wall that is less than a pixel's width the mean is seen. */
static void test_far(void **state) {
    (void)state;
    noc_scene *scene = wall_scene(false, 1);
    noc_image *image = picture(scene, 285);
    int seen = 0;
    for (int i = 0; i < 4; i++) { /* the picture's middle lies between pixels: each has a quarter of the wall */
        const float *p = pixel(image, WIDTH / 2 - i % 2, HEIGHT / 2 - i / 2);
        seen += p[0] > 0;
        assert_true(fabsf(p[1] - p[0]) <= 0.01f * p[0] && fabsf(p[2] - p[0]) <= 0.01f * p[0]);
    }
    assert_true(seen > 1);
    noc_image_destroy(image);
    noc_scene_destroy(scene);
}

static void test_same_bits(void **state) {
    (void)state;
    noc_scene *scene = wall_scene(true, 1);
    noc_view *views[] = { own_view(scene, 1, NULL), own_view(scene, 3, NULL) }; /* of so many threads */
    const noc_method methods[] = { NOC_METHOD_RIS, NOC_METHOD_RESTIR, NOC_METHOD_REFERENCE };
    for (size_t m = 0; m < NOC_COUNT(methods); m++) {
        noc_image *want = frames_of(views[0], NOC_ISA_SCALAR, 9, methods[m]);
        for (noc_isa isa = NOC_ISA_SCALAR; isa < NOC_ISA_COUNT; isa++)
            for (size_t i = 0; i < NOC_COUNT(views) && noc_isa_runs(isa); i++) {
                noc_image *image = frames_of(views[i], isa, 9, methods[m]);
                assert_memory_equal(image->rgb, want->rgb, 3 * sizeof(float) * WIDTH * HEIGHT);
                noc_image_destroy(image);
            }
        noc_image_destroy(want);
    }
    for (size_t i = 0; i < NOC_COUNT(views); i++)
        close_view(views[i]);
    noc_scene_destroy(scene);
}

/* A texture that comes between two frames is seen in the next, and leaves nothing of itself when it goes. */
static void test_edit(void **state) {
    (void)state;
    noc_scene *scene = wall_scene(false, 1);
    noc_view *view = own_view(scene, 1, NULL);
    noc_camera camera = noc_camera_default();
    noc_render_params p = noc_render_default_params();
    camera.eye[1] = -6;
    camera.fov_deg = 40;
    p.width = WIDTH;
    p.height = HEIGHT;
    p.sky = 0;
    noc_material grey = { .albedo = { 0.3f, 0.3f, 0.3f }, .roughness = 1, .cls = NOC_CLASS_WALL };
    assert_int_equal(noc_view_render(view, &camera, &p, NULL), NOC_OK);
    noc_image *image = noc_view_image(view);
    assert_colour(pixel(image, 42, 14), 0.02, 128 / 255.0, 0.02);
    noc_image_destroy(image);
    assert_int_equal(noc_scene_set_material(scene, 0, &grey), NOC_OK);
    assert_int_equal(noc_scene_commit(scene), NOC_OK);
    assert_int_equal(noc_view_render(view, &camera, &p, NULL), NOC_OK);
    image = noc_view_image(view);
    assert_colour(pixel(image, 42, 14), 0.3, 0.3, 0.3);
    noc_image_destroy(image);
    close_view(view);
    noc_scene_destroy(scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_way_up),    cmocka_unit_test(test_no_places), cmocka_unit_test(test_far),
        cmocka_unit_test(test_same_bits), cmocka_unit_test(test_edit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
