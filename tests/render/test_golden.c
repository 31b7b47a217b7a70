/* Golden pictures of tiny scenes: what was looked at once and found right must stay so. They are EXR files beside this
 * file; NOC_GOLDEN=write makes them anew (then look at them before they are committed). A picture fails when it differs
 * by more than noise and rounding can explain; its mirror image must fail, so that the threshold is known to bite. */
#include "rooms.h"

#include <nocturne/import.h>

enum { W = 80, H = 60 };

/* A lit corner: every kind of light, a matte and a glossy box, a shadow. */
static noc_scene *corner(noc_camera *camera) {
    noc_scene *s = noc_scene_create(NULL);
    int grey = matte(s, 0.5f);
    int red = noc_scene_add_material(s, &(noc_material){ .albedo = { 0.6f, 0.2f, 0.1f }, .roughness = 1 });
    int gloss =
        noc_scene_add_material(s, &(noc_material){ .albedo = { 0.1f, 0.1f, 0.2f }, .f0 = 0.3f, .roughness = 0.3f });
    add_floor(s, gloss, 0, 0, 0, 4);
    QUAD(s, grey, -4, 4, 0, 8, 0, 0, 0, 0, 4);
    QUAD(s, red, -4, -4, 0, 0, 8, 0, 0, 0, 4);
    QUAD(s, grey, -1, 0, 0, 1, 0, 0, 0, 0, 1.5); /* a screen that throws shadows to both sides */
    const noc_light lights[] = {
        { .kind = NOC_LIGHT_SPHERE, .position = { 1.5, 1, 1 }, .radius = 0.25, .emission = { 30, 25, 15 } },
        { .kind = NOC_LIGHT_DISC,
          .position = { -2, 2, 3 },
          .radius = 0.3,
          .direction = { 0, 0, -1 },
          .emission = { 20, 30, 40 } },
        { .kind = NOC_LIGHT_TRIANGLE,
          .position = { -3.9, -1, 1 },
          .edge_u = { 0, 1, 0 },
          .edge_v = { 0, 0, 1 },
          .emission = { 10, 40, 10 } },
        { .kind = NOC_LIGHT_PARALLELOGRAM,
          .position = { 3, 3.9, 1 },
          .edge_u = { -1.5, 0, 0 },
          .edge_v = { 0, 0, -0.5 },
          .emission = { 40, 10, 30 } },
        { .kind = NOC_LIGHT_POINT, .position = { 2, -2, 2 }, .emission = { 3, 3, 3 } },
    };
    for (size_t i = 0; i < NOC_COUNT(lights); i++)
        assert_true(noc_scene_add_light(s, &lights[i]) >= 0);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    *camera = look(5, -5, 3, -0.8, 0.8, 0.8, 55);
    return s;
}

/* A house from CityGML, with the ground and the lamps that rules give it, without windows. */
static noc_scene *house(noc_camera *camera) {
    noc_scene *s = noc_scene_create(NULL);
    char *path = noc_format("%s/tests/cli/city.gml", getenv("NOC_SOURCE"));
    noc_import_params p = noc_import_default_params();
    p.windows = NOC_SWITCH_OFF;
    p.profiles = false; /* the picture is of Lambertian lamps */
    assert_int_equal(noc_scene_load(s, (const char *const[]){ path }, 1, &p, NULL), NOC_OK);
    free(path);
    assert_int_equal(noc_scene_camera(s, NOC_VIEWPOINT_OVERVIEW, (double)W / H, camera), NOC_OK);
    return s;
}

static noc_scene *city(noc_camera *camera) {
    noc_scene *s = noc_scene_create(NULL);
    noc_city_params p = noc_city_default_params();
    p.size = 150;
    assert_int_equal(noc_scene_add_city(s, &p), NOC_OK);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    assert_int_equal(noc_scene_camera(s, NOC_VIEWPOINT_AERIAL, (double)W / H, camera), NOC_OK);
    return s;
}

static void mirror(noc_image *image) {
    for (int y = 0; y < image->height; y++)
        for (int x = 0; x < image->width / 2; x++)
            for (int k = 0; k < 3; k++) {
                float *row = image->rgb + 3 * (size_t)y * image->width, *a = row + 3 * x + k;
                float *b = row + 3 * (image->width - 1 - x) + k, t = *a;
                *a = *b;
                *b = t;
            }
}

static void check(const char *name, noc_scene *(*make)(noc_camera *)) {
    noc_camera camera;
    noc_scene *s = make(&camera);
    noc_render_params p = measure(W, H, NOC_METHOD_REFERENCE);
    p.jitter = true;
    p.rays = 64;
    noc_image *image = render(s, &camera, &p, 8);
    char *path = noc_format("%s/tests/render/golden/%s.exr", getenv("NOC_SOURCE"), name);
    const char *mode = getenv("NOC_GOLDEN");
    if (mode && !strcmp(mode, "write"))
        assert_int_equal(noc_image_write(image, path, NULL, NULL, NULL), NOC_OK);
    bool linear = false;
    noc_image *golden = noc_image_read(path, NULL, &linear);
    assert_non_null(golden);
    assert_true(linear);
    noc_compare_params c = noc_compare_default_params();
    noc_comparison right, wrong;
    assert_int_equal(noc_image_compare(image, golden, &c, &right, NULL), NOC_OK);
    mirror(image);
    assert_int_equal(noc_image_compare(image, golden, &c, &wrong, NULL), NOC_OK);
    print_message("# %s: RMSE-8 %.3f, bias %.4f; mirrored %.1f\n", name, right.all.rmse8, right.all.bias,
                  wrong.all.rmse8);
    assert_true(right.all.rmse8 < 1.5);
    assert_true(fabs(right.all.bias - 1) < 0.01);
    assert_true(wrong.all.rmse8 > 15);
    noc_image_destroy(golden);
    noc_image_destroy(image);
    noc_scene_destroy(s);
    free(path);
}

static void golden_corner(void **state) {
    (void)state;
    check("corner", corner);
}
static void golden_house(void **state) {
    (void)state;
    check("house", house);
}
static void golden_city(void **state) {
    (void)state;
    check("city", city);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(golden_corner),
        cmocka_unit_test(golden_house),
        cmocka_unit_test(golden_city),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
