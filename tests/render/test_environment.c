/* A map around the scene, as background and as light, against what can be computed by hand. */
#include "rooms.h"

#include "../core/no_profiles.h"
#include "core/surface.h"
#include "render/backend.h"

enum { SIDE = 64, PIXELS = SIDE * SIDE };

/* A map of which every texel is what f says for its place, 0 to 1 from the left and from the top. */
static noc_image *make_map(int height, double (*f)(int x, int y)) {
    noc_image *map = noc_image_create(2 * height, height, NULL);
    assert_non_null(map);
    for (int y = 0; y < height; y++)
        for (int x = 0; x < 2 * height; x++)
            for (int k = 0; k < 3; k++)
                map->rgb[3 * (y * 2 * height + x) + k] = (float)f(x, y);
    return map;
}

static void set_map(noc_scene *s, noc_image *map) {
    assert_int_equal(noc_scene_set_environment(s, map), NOC_OK);
    noc_image_destroy(map);
}

static noc_render_params lit(void) {
    noc_render_params p = measure(SIDE, SIDE, NOC_METHOD_RIS);
    p.environment_light = true;
    return p;
}

/* Mean of the picture, and the standard error of it where pixels are independent and see the same. */
static double mean_of(const noc_image *image, double *error) {
    double sum = 0, square = 0;
    for (int i = 0; i < PIXELS; i++) {
        double v = luma(image->rgb + 3 * i);
        sum += v;
        square += v * v;
    }
    double mean = sum / PIXELS;
    *error = sqrt(fmax(square / PIXELS - mean * mean, 0) / PIXELS);
    return mean;
}

static void expect(const noc_scene *s, const noc_camera *c, const noc_render_params *p, int frames, double want,
                   const char *what) {
    double error;
    noc_image *image = render(s, c, p, frames);
    double mean = mean_of(image, &error);
    print_message("# %s: %.6g of %.6g, standard error %.2g\n", what, mean, want, error);
    assert_true(fabs(mean - want) < 4.5 * error + 2e-4 * want);
    assert_true(error < 0.02 * want); /* else this says nothing */
    noc_image_destroy(image);
}

/* A floor seen from above, or a wall that faces `bearing` degrees from north, seen from its front; so narrowly that all
 * pixels see the same. */
static noc_scene *surface(double bearing, bool wall, const noc_material *m, double height, noc_camera *c) {
    noc_scene *s = noc_scene_create(NULL);
    int material = noc_scene_add_material(s, m);
    double n[2] = { sin(bearing * M_PI / 180), cos(bearing * M_PI / 180) };
    if (wall)
        QUAD(s, material, 50 * n[1], -50 * n[0], -50, -100 * n[1], 100 * n[0], 0, 0, 0, 100);
    else
        add_floor(s, material, 0, 0, 0, 50);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    *c = wall ? look(10 * n[0], 10 * n[1], 0, 0, 0, 0, 0.05) : look(0, -10, height, 0, 0, 0, 0.05);
    return s;
}

static const noc_material grey = { .albedo = { 0.5f, 0.5f, 0.5f }, .roughness = 1 };

static double even(int x, int y) {
    (void)x;
    (void)y;
    return 2;
}

/* E = pi L, and half of that on a wall whose ground shines, too: L' = albedo L. */
static void even_map(void **state) {
    (void)state;
    noc_camera c;
    noc_render_params p = lit();
    for (int wall = 0; wall < 2; wall++) {
        noc_scene *s = surface(30, wall, &grey, 9, &c);
        set_map(s, make_map(16, even));
        noc_scene_info info;
        noc_scene_get_info(s, &info);
        assert_int_equal(info.environment_width, 32);
        assert_true(fabs(info.environment_lux - 2 * M_PI) < 1e-5);
        expect(s, &c, &p, 1, 0.5 * 2, "even map");
        p.environment_scale = 3;
        expect(s, &c, &p, 5, 0.5 * 6, "times 3");
        p.environment_lux = 10;
        p.environment_scale = 1;
        expect(s, &c, &p, 5, 0.5 * 10 / M_PI, "10 lx");
        p.environment_lux = 0;
        noc_scene_destroy(s);
    }
}

enum { ROWS = 64, LIT_X = 80, LIT_Y = 20 }; /* a texel some 44 degrees east of north */
static double one(int x, int y) { return x == LIT_X && y == LIT_Y ? 500 : 0; }

static double bearing_of(double x) { return (x / (2 * ROWS) - 0.5) * 2 * M_PI; }

/* E of a floor and of a wall that faces `wall` (rad) by the one texel, its middle turned by `turn`: the integral of the
 * cosine over a rectangle of bearings and elevations. */
static double on_floor(void) {
    double z0 = cos(M_PI * LIT_Y / ROWS), z1 = cos(M_PI * (LIT_Y + 1) / ROWS);
    return 500 * 2 * M_PI / (2 * ROWS) * (z0 * z0 - z1 * z1) / 2;
}
static double on_wall(double wall, double turn) {
    double e1 = M_PI / 2 - M_PI * LIT_Y / ROWS, e0 = M_PI / 2 - M_PI * (LIT_Y + 1) / ROWS;
    double a0 = bearing_of(LIT_X) + turn - wall, a1 = bearing_of(LIT_X + 1) + turn - wall;
    return 500 * (sin(a1) - sin(a0)) * ((e1 - e0) / 2 + (sin(2 * e1) - sin(2 * e0)) / 4);
}

static void one_texel(void **state) {
    (void)state;
    noc_camera c;
    noc_render_params p = lit();
    noc_scene *s = surface(0, false, &grey, 9, &c);
    set_map(s, make_map(ROWS, one));
    expect(s, &c, &p, 20, 0.5 * on_floor() / M_PI, "one texel on a floor");
    noc_scene_destroy(s);
    static const double walls[][2] = { { 0, 0 }, { 90, 0 }, { 90, 90 }, { -60, -100 }, { 200, 180 }, { 0, 315 } };
    for (size_t i = 0; i < NOC_COUNT(walls); i++) {
        char what[60];
        snprintf(what, sizeof(what), "wall that faces %g, map turned to %g", walls[i][0], walls[i][1]);
        s = surface(walls[i][0], true, &grey, 0, &c);
        set_map(s, make_map(ROWS, one));
        p.environment_rotation = walls[i][1];
        double want = on_wall(walls[i][0] * M_PI / 180, walls[i][1] * M_PI / 180);
        assert_true(want > 0);
        expect(s, &c, &p, 20, 0.5 * want / M_PI, what);
        noc_scene_destroy(s);
    }
    /* turned behind the wall it brings nothing */
    s = surface(0, true, &grey, 0, &c);
    set_map(s, make_map(ROWS, one));
    p.environment_rotation = 100;
    noc_image *image = render(s, &c, &p, 20);
    double error;
    assert_true(mean_of(image, &error) == 0);
    noc_image_destroy(image);
    noc_scene_destroy(s);
}

/* Bright spots, dim bands and black: all that draws have to tell apart. */
static double rough(int x, int y) {
    uint32_t h = ((uint32_t)x * 73856093u ^ (uint32_t)y * 19349663u) * 2654435761u;
    return h >> 24 == 7 ? 40 : (h >> 22) % 3 ? 0.1 * (h >> 28) : 0;
}

/* What the map sends towards wo by way of s: the midpoint rule, texel by texel. */
static double integral(surf s, int rows) {
    enum { PARTS = 12 };
    double total = 0;
    for (int y = 0; y < rows / 2 * PARTS; y++)
        for (int x = 0; x < 2 * rows * PARTS; x++) {
            double e = M_PI / 2 - M_PI * (y + 0.5) / (rows * PARTS), b = (double)(x + 0.5) / (2 * rows * PARTS);
            double a = (b - 0.5) * 2 * M_PI, l = rough(x / PARTS, y / PARTS);
            v3 d = { (float)(cos(e) * sin(a)), (float)(cos(e) * cos(a)), (float)sin(e) };
            if (l > 0)
                total += luminance(reflect(s, d)) * l * cos(e);
        }
    return total * M_PI / (rows * PARTS) * M_PI / (rows * PARTS);
}

/* Matte, satin, glossy and nearly mirroring floors: the mean is the integral, in one frame and over frames. */
static void glossy_floors(void **state) {
    (void)state;
    static const struct {
        double albedo, f0, roughness, height;
    } floors[] = { { 0.5, 0, 1, 6 }, { 0.8, 0.04, 0.4, 6 }, { 0, 0.5, 0.3, 4 }, { 0.05, 0.02, 0.3, 1.5 } };
    for (size_t i = 0; i < NOC_COUNT(floors); i++) {
        double h = floors[i].height, d = sqrt(100 + h * h);
        float albedo = (float)floors[i].albedo;
        noc_material m = { .albedo = { albedo, albedo, albedo },
                           .f0 = (float)floors[i].f0,
                           .roughness = (float)floors[i].roughness };
        surf on = { .n = { 0, 0, 1 },
                    .wo = { 0, (float)(-10 / d), (float)(h / d) },
                    .f0 = m.f0,
                    .albedo = { albedo, albedo, albedo },
                    .alpha = m.roughness * m.roughness };
        noc_camera c;
        noc_scene *s = surface(0, false, &m, h, &c);
        set_map(s, make_map(ROWS, rough));
        double want = integral(on, ROWS);
        noc_render_params p = lit();
        p.seed = (uint32_t)i + 5;
        expect(s, &c, &p, 2, want, "rough map, two frames");
        expect(s, &c, &p, 40, want, "rough map, 40 frames");
        noc_scene_destroy(s);
    }
}

/* It lights where it is told to alone, is shut out by a roof, and is seen where there is no surface: its middle in the
 * north, more to the right further east. */
static void background(void **state) {
    (void)state;
    noc_scene *s = noc_scene_create(NULL);
    add_floor(s, matte(s, 0.5f), 0, 0, 0, 5);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    set_map(s, make_map(ROWS, one));
    noc_render_params p = measure(SIDE, SIDE, NOC_METHOD_RIS);
    noc_camera c = look(0, -1, 4, 0, 0, 0, 10), up;
    double error, e = M_PI / 2 - M_PI * (LIT_Y + 0.5) / ROWS;
    noc_image *image = render(s, &c, &p, 2);
    assert_true(noc_image_is_black(image));
    noc_image_destroy(image);
    for (double turn = -170; turn < 360; turn += 85) {
        double a = bearing_of(LIT_X + 0.5) + turn * M_PI / 180;
        up = look(0, 0, 9, sin(a) * cos(e), cos(a) * cos(e), 9 + sin(e), 0.01);
        p.environment_rotation = turn;
        p.environment_scale = 0.5;
        image = render(s, &up, &p, 1);
        assert_true(fabs(mean_of(image, &error) - 250) < 3);
        noc_image_destroy(image);
    }
    add_floor(s, 0, 0, 0, 8, 50);
    for (int side = 0; side < 2; side++) {
        QUAD(s, 0, -5, -5 + 10 * side, -1, 10, 0, 0, 0, 0, 10);
        QUAD(s, 0, -5 + 10 * side, -5, -1, 0, 10, 0, 0, 0, 10);
    }
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    p.environment_light = true;
    image = render(s, &c, &p, 10);
    assert_true(noc_image_is_black(image));
    noc_image_destroy(image);
    noc_scene_destroy(s);
}

/* A large map is averaged down for light, and none of it is lost. */
static double spot(int x, int y) { return x == 3001 && y == 700 ? 4000 : 0.001; }
static void large_map(void **state) {
    (void)state;
    enum { HEIGHT = 2048 };
    noc_camera c;
    noc_scene *s = surface(0, false, &grey, 9, &c);
    set_map(s, make_map(HEIGHT, spot));
    noc_scene_info info;
    noc_scene_get_info(s, &info);
    double z0 = cos(M_PI * 700 / HEIGHT), z1 = cos(M_PI * 701 / HEIGHT);
    double want = 0.001 * M_PI + 3999.999 * M_PI / HEIGHT * (z0 * z0 - z1 * z1) / 2;
    assert_true(fabs(info.environment_lux / want - 1) < 1e-3); /* it lies a little elsewhere in its larger texel */
    noc_render_params p = lit();
    expect(s, &c, &p, 30, 0.5 * info.environment_lux / M_PI, "a spot in a large map");
    noc_scene_destroy(s);
}

/* Numbers so small that those beside them are no floats: the map is black, or finite. */
static double denormal(int x, int y) {
    (void)x;
    (void)y;
    return 1e-42;
}
static double dim(int x, int y) { return y < 8 ? 1e-20 : x % 3 ? 0 : 1e9; }
static void tiny_light(void **state) {
    (void)state;
    noc_camera c, up = look(0, 0, 9, 0, 1, 9, 40);
    for (int i = 0; i < 2; i++) {
        noc_scene *s = surface(0, false, &grey, 9, &c);
        set_map(s, make_map(16, i ? dim : denormal));
        noc_render_params p = lit();
        p.environment_lux = 1e6;
        p.environment_scale = i ? 1e9 : 1;
        frame_constants k = { 0 };
        noc_make_frame_environment(s, &p, &k);
        assert_true(isfinite(k.environment_scale) && isfinite(k.environment_inverse_power));
        assert_true(isfinite(k.environment_level) && isfinite(1e9f * k.environment_scale));
        assert_int_equal((k.flags & FRAME_MAP_LIGHTS) != 0, i);
        for (int seen = 0; seen < 2; seen++) {
            noc_image *image = render(s, seen ? &up : &c, &p, 2);
            for (int n = 0; n < 3 * PIXELS; n++)
                assert_true(isfinite(image->rgb[n]) && (i || image->rgb[n] < 1e-30f));
            noc_image_destroy(image);
        }
        noc_scene_destroy(s);
    }
}

/* The map's part of a scene: its name, its errors, and that another one begins the mean anew. */
static void edits(void **state) {
    (void)state;
    noc_camera c;
    char none[NOC_CONTENT_KEY], with[NOC_CONTENT_KEY], other[NOC_CONTENT_KEY];
    noc_scene *s = surface(0, false, &grey, 9, &c);
    noc_scene_content(s, none);
    noc_view *v = own_view(s, 2, NULL);
    noc_render_params p = lit();
    noc_frame_stats stats;
    set_map(s, make_map(16, even));
    noc_scene_content(s, with);
    for (int i = 0; i < 3; i++)
        assert_int_equal(noc_view_render(v, &c, &p, NULL), NOC_OK);
    noc_view_get_stats(v, &stats);
    assert_int_equal(stats.frames, 3);
    set_map(s, make_map(ROWS, one));
    noc_scene_content(s, other);
    assert_int_equal(noc_view_render(v, &c, &p, NULL), NOC_OK);
    noc_view_get_stats(v, &stats);
    assert_int_equal(stats.frames, 1);
    assert_string_not_equal(none, with);
    assert_string_not_equal(with, other);
    noc_image *odd = noc_image_create(10, 10, NULL);
    assert_int_equal(noc_scene_set_environment(s, odd), NOC_ERR_ARGUMENT);
    const int sizes[][2] = { { INT32_MIN, 1 << 30 }, { -2, INT32_MAX }, { INT32_MIN, INT32_MIN }, { 3, 1 }, { 0, 0 } };
    for (size_t i = 0; i < NOC_COUNT(sizes); i++) { /* none of them is looked into */
        noc_image huge = { .width = sizes[i][0], .height = sizes[i][1], .rgb = odd->rgb };
        assert_int_equal(noc_scene_set_environment(s, &huge), NOC_ERR_ARGUMENT);
    }
    noc_image_destroy(odd);
    assert_int_equal(noc_scene_set_environment(s, NULL), NOC_OK);
    noc_scene_content(s, other);
    assert_string_equal(none, other);
    assert_int_equal(noc_view_render(v, &c, &p, NULL), NOC_OK);
    noc_image *black = noc_view_image(v);
    assert_true(noc_image_is_black(black));
    noc_image_destroy(black);
    close_view(v);
    noc_image *bad = make_map(2, even);
    bad->rgb[0] = -1;
    bad->rgb[7] = NAN;
    bad->rgb[9] = INFINITY;
    set_map(s, bad);
    noc_scene_info info;
    noc_scene_get_info(s, &info);
    assert_true(isfinite(info.environment_lux) && info.environment_lux > 0 && info.environment_lux < 2 * M_PI);
    noc_scene_destroy(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(even_map),   cmocka_unit_test(one_texel), cmocka_unit_test(glossy_floors),
        cmocka_unit_test(background), cmocka_unit_test(large_map), cmocka_unit_test(edits),
        cmocka_unit_test(tiny_light),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
