/* Camera presets: on the built-in city, on odd little scenes, and on none. */
#include "../test.h"

#include "scene/scene.h"

#include <math.h>

static void add_box(noc_scene *scene, noc_class cls, double x0, double y0, double x1, double y1, double z0, double z1) {
    noc_material m = noc_class_material(cls);
    double p[24];
    for (int i = 0; i < 8; i++) {
        p[3 * i] = i & 1 ? x1 : x0;
        p[3 * i + 1] = i & 2 ? y1 : y0;
        p[3 * i + 2] = i & 4 ? z1 : z0;
    }
    static const uint32_t faces[36] = { 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                        2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5 };
    noc_mesh mesh = { .vertex_count = 8,
                      .positions = p,
                      .triangle_count = 12,
                      .indices = faces,
                      .material = noc_scene_add_material(scene, &m) };
    assert_true(noc_scene_add_mesh(scene, &mesh) >= 0);
}

static void check_sane(const noc_camera *c) {
    double d = 0;
    for (int k = 0; k < 3; k++) {
        assert_true(isfinite(c->eye[k]) && isfinite(c->target[k]));
        d += (c->target[k] - c->eye[k]) * (c->target[k] - c->eye[k]);
    }
    assert_true(d > 1e-6);
    assert_true(c->fov_deg > 10 && c->fov_deg < 90);
    assert_true(c->up[2] == 1);
    /* not straight down or up: the picture's upright is defined */
    assert_true(hypot(c->target[0] - c->eye[0], c->target[1] - c->eye[1]) > 1e-3 * sqrt(d));
}

static void keep_warning(void *user, noc_log_level level, const char *text) {
    assert_int_equal(level, NOC_LOG_WARN);
    snprintf(user, 128, "%s", text);
}

static void all_views(const noc_scene *scene) {
    static const double aspects[] = { 0.5, 1, 16.0 / 9, 4 };
    for (int v = 0; v < 3; v++)
        for (size_t i = 0; i < NOC_COUNT(aspects); i++) {
            noc_camera a, b;
            assert_int_equal(noc_scene_camera(scene, (noc_viewpoint)v, aspects[i], &a), NOC_OK);
            check_sane(&a);
            if (i)
                continue;
            assert_int_equal(noc_scene_camera(scene, (noc_viewpoint)v, aspects[i], &b), NOC_OK);
            assert_memory_equal(&a, &b, sizeof(a)); /* found again */
        }
}

/* Coordinates in the picture, -1..1 from edge to edge; false behind the camera. */
static bool project(const noc_camera *c, double aspect, const double p[3], double *x, double *y) {
    double f[3], r[3], u[3], l = 0, lr = 0, d[3] = { 0 };
    for (int k = 0; k < 3; k++)
        f[k] = c->target[k] - c->eye[k], l += f[k] * f[k];
    for (int k = 0; k < 3; k++)
        f[k] /= sqrt(l);
    for (int k = 0; k < 3; k++)
        r[k] = f[(k + 1) % 3] * c->up[(k + 2) % 3] - f[(k + 2) % 3] * c->up[(k + 1) % 3], lr += r[k] * r[k];
    for (int k = 0; k < 3; k++)
        r[k] /= sqrt(lr);
    for (int k = 0; k < 3; k++)
        u[k] = r[(k + 1) % 3] * f[(k + 2) % 3] - r[(k + 2) % 3] * f[(k + 1) % 3];
    for (int k = 0; k < 3; k++)
        d[0] += (p[k] - c->eye[k]) * r[k], d[1] += (p[k] - c->eye[k]) * u[k], d[2] += (p[k] - c->eye[k]) * f[k];
    double t = tan(c->fov_deg * M_PI / 360);
    *x = d[0] / (d[2] * t * aspect);
    *y = d[1] / (d[2] * t);
    return d[2] > 0;
}

static void check_overview(const noc_scene *scene, double aspect) {
    noc_camera c;
    double lo[2] = { 9, 9 }, hi[2] = { -9, -9 };
    assert_int_equal(noc_scene_camera(scene, NOC_VIEWPOINT_OVERVIEW, aspect, &c), NOC_OK);
    for (size_t i = 0; i < 3 * noc_scene_city_triangles(scene); i++) {
        size_t triangle = noc_scene_city_triangle(scene, i / 3), index = 3 * triangle + i % 3;
        const noc_scene_mesh *mesh = &scene->meshes.data[noc_scene_mesh_of(scene, triangle)];
        noc_class cls = scene->materials.data[mesh->material].cls;
        if (cls == NOC_CLASS_TERRAIN || cls == NOC_CLASS_GREEN || cls == NOC_CLASS_WATER)
            continue;
        const float *v = scene->positions.data + 3 * (size_t)scene->indices.data[index];
        double p[3] = { v[0], v[1], v[2] }, x, y;
        assert_true(project(&c, aspect, p, &x, &y));
        lo[0] = fmin(lo[0], x), hi[0] = fmax(hi[0], x), lo[1] = fmin(lo[1], y), hi[1] = fmax(hi[1], y);
    }
    assert_true(lo[0] >= -1.001 && hi[0] <= 1.001 && lo[1] >= -1.001 && hi[1] <= 1.001); /* all that is built */
    assert_true(hi[0] - lo[0] > 1.6 || hi[1] - lo[1] > 1.6);                             /* and not from too far */
}

static void check_street(const noc_scene *scene) {
    noc_camera c;
    double ground, top, aspect = 16.0 / 9;
    assert_int_equal(noc_scene_camera(scene, NOC_VIEWPOINT_STREET, aspect, &c), NOC_OK);
    assert_true(noc_scene_ground(scene, c.eye[0], c.eye[1], &ground));
    assert_true(noc_scene_top(scene, c.eye[0], c.eye[1], &top));
    assert_true(fabs(c.eye[2] - ground - 1.7) < 1e-9);
    assert_true(top - ground < 0.3); /* under the open sky */
    double dx = c.target[0] - c.eye[0], dy = c.target[1] - c.eye[1], l = hypot(dx, dy);
    uint32_t solid = ~(1u << NOC_CLASS_LAMP | 1u << NOC_CLASS_TREE); /* arms and boughs may hang over the view */
    for (double d = 0; d < 12; d += 0.5) {                           /* nothing in front of the nose */
        double z;
        assert_true(noc_scene_highest(scene, solid, c.eye[0] + d * dx / l, c.eye[1] + d * dy / l, &z));
        assert_true(z < c.eye[2] + 0.5);
    }
    int lamps = 0;
    for (size_t i = 0; i < scene->lights.len; i++) {
        const noc_light_record *r = &scene->lights.data[i];
        double p[3] = { r->p[0], r->p[1], r->p[2] }, x, y;
        lamps += (r->kind == NOC_LIGHT_SPHERE || r->kind == NOC_LIGHT_DISC) && project(&c, aspect, p, &x, &y) &&
                 fabs(x) < 1 && fabs(y) < 1;
    }
    assert_true(lamps >= 3);
}

static void check_aerial(const noc_scene *scene) {
    noc_camera c;
    double z;
    assert_int_equal(noc_scene_camera(scene, NOC_VIEWPOINT_AERIAL, 16.0 / 9, &c), NOC_OK);
    if (noc_scene_top(scene, c.eye[0], c.eye[1], &z))
        assert_true(c.eye[2] > z + 3); /* over the roofs */
    assert_true(c.eye[2] > c.target[2]);
}

static void test_builtin_city(void **state) {
    for (uint32_t seed = 1; seed < 4; seed++) {
        noc_scene *scene = noc_scene_create(NULL);
        noc_city_params params = noc_city_default_params();
        params.seed = seed;
        params.size = 180 + 110 * seed;
        assert_int_equal(noc_scene_add_city(scene, &params), NOC_OK);
        assert_int_equal(noc_scene_commit(scene), NOC_OK);
        check_overview(scene, 16.0 / 9);
        check_overview(scene, 0.7);
        check_aerial(scene);
        check_street(scene);
        noc_scene_destroy(scene);
    }
}

/* Houses in rows and nothing else: no lights, no ground but what they stand on. */
static void test_without_lights(void **state) {
    for (int ground = 0; ground < 2; ground++) {
        noc_scene *scene = noc_scene_create(NULL);
        for (int j = 0; j < 5; j++)
            for (int i = 0; i < 5; i++)
                add_box(scene, NOC_CLASS_WALL, i * 30, j * 40, i * 30 + 18, j * 40 + 25, 100, 112);
        if (ground)
            add_box(scene, NOC_CLASS_TERRAIN, -20, -20, 180, 220, 99, 100);
        all_views(scene);
        check_overview(scene, 1.5);
        check_aerial(scene);
        noc_camera c;
        assert_int_equal(noc_scene_camera(scene, NOC_VIEWPOINT_STREET, 1.5, &c), NOC_OK);
        if (ground)
            assert_true(fabs(c.eye[2] - 101.7) < 1e-4);
        noc_scene_destroy(scene);
    }
}

/* One lamp in one street: the eye stands in it, not in a house, and sees the lamp. */
static void test_one_lamp(void **state) {
    noc_scene *scene = noc_scene_create(NULL);
    add_box(scene, NOC_CLASS_ROAD, -100, -100, 100, 100, -1, 0);
    add_box(scene, NOC_CLASS_WALL, -100, -60, 100, -6, 0, 15);
    add_box(scene, NOC_CLASS_WALL, -100, 6, 100, 60, 0, 15);
    noc_light lamp = { .kind = NOC_LIGHT_DISC,
                       .position = { 10, 0, 8 },
                       .direction = { 0, 0, -1 },
                       .radius = 0.2,
                       .emission = { 9e3f, 9e3f, 9e3f } };
    assert_true(noc_scene_add_light(scene, &lamp) == 0);
    all_views(scene);
    noc_camera c;
    double x, y;
    assert_int_equal(noc_scene_camera(scene, NOC_VIEWPOINT_STREET, 16.0 / 9, &c), NOC_OK);
    assert_true(fabs(c.eye[1]) < 6 && fabs(c.eye[2] - 1.7) < 1e-6);
    assert_true(fabs(c.target[0] - c.eye[0]) > 20); /* along the street */
    assert_true(project(&c, 16.0 / 9, lamp.position, &x, &y) && fabs(x) < 1);
    noc_scene_destroy(scene);
}

/* A panel let into the ceiling: it lights the room where it looks down, or both ways, and then the room is seen from
 * inside. */
static void test_panel(void **state) {
    for (int i = 0; i < 4; i++) {
        bool down = i & 1, both = i & 2;
        noc_scene *scene = noc_scene_create(NULL);
        add_box(scene, NOC_CLASS_OTHER, 0, 0, 6, 8, 0, 3);
        noc_material glow = { .roughness = 1, .emission = { 9, 9, 9 }, .two_sided = both };
        static const double p[12] = { 2, 3, 3, 4, 3, 3, 4, 5, 3, 2, 5, 3 };
        static const uint32_t faces[2][6] = { { 0, 1, 2, 0, 2, 3 }, { 2, 1, 0, 3, 2, 0 } };
        noc_mesh panel = { .vertex_count = 4,
                           .positions = p,
                           .triangle_count = 2,
                           .indices = faces[down],
                           .material = noc_scene_add_material(scene, &glow) };
        assert_true(noc_scene_add_mesh(scene, &panel) >= 0);
        assert_int_equal(noc_scene_commit(scene), NOC_OK);
        noc_camera c;
        assert_int_equal(noc_scene_camera(scene, NOC_VIEWPOINT_OWN, 1.5, &c), NOC_OK);
        assert_true((c.eye[0] > 0 && c.eye[0] < 6 && c.eye[1] > 0 && c.eye[1] < 8 && c.eye[2] > 0 && c.eye[2] < 3) ==
                    (down || both));
        noc_scene_destroy(scene);
    }
}

/* A city has streets, and nothing is said of them. */
static void test_no_warning(void **state) {
    char warning[128] = "";
    noc_log *log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_WARN, .message = keep_warning, .user = warning });
    noc_scene *scene = noc_scene_create(log);
    noc_city_params params = noc_city_default_params();
    params.size = 150;
    noc_camera c;
    assert_int_equal(noc_scene_add_city(scene, &params), NOC_OK);
    assert_int_equal(noc_scene_commit(scene), NOC_OK);
    assert_int_equal(noc_scene_camera(scene, NOC_VIEWPOINT_STREET, 1.5, &c), NOC_OK);
    assert_string_equal(warning, "");
    noc_scene_destroy(scene);
    noc_log_destroy(log);
}

static void assert_in_picture(const noc_camera *c, double aspect, const double lo[3], const double hi[3]) {
    for (int i = 0; i < 8; i++) {
        double p[3] = { i & 1 ? hi[0] : lo[0], i & 2 ? hi[1] : lo[1], i & 4 ? hi[2] : lo[2] }, x, y;
        assert_true(project(c, aspect, p, &x, &y));
        assert_true(fabs(x) <= 1 && fabs(y) <= 1);
    }
}

/* An object, a plate and a lamp over them, of any size: nobody stands on the object's top, all is in the picture. */
static void test_object(void **state) {
    static const double sizes[] = { 0.1, 1, 10, 1000 };
    for (size_t i = 0; i < NOC_COUNT(sizes); i++) {
        double s = sizes[i];
        noc_scene *scene = noc_scene_create(NULL);
        add_box(scene, NOC_CLASS_OTHER, -2 * s, -2 * s, 2 * s, 2 * s, -.05 * s, 0);
        add_box(scene, NOC_CLASS_OTHER, -.5 * s, -.5 * s, .5 * s, .5 * s, 0, s);
        noc_light lamp = { .kind = NOC_LIGHT_POINT, .position = { 0, 0, 1.5 * s }, .emission = { 9, 9, 9 } };
        assert_int_equal(noc_scene_add_light(scene, &lamp), 0);
        all_views(scene);
        noc_camera c;
        assert_int_equal(noc_scene_camera(scene, NOC_VIEWPOINT_OWN, 1.5, &c), NOC_OK);
        assert_in_picture(&c, 1.5, (double[]){ -2 * s, -2 * s, -.05 * s }, (double[]){ 2 * s, 2 * s, 0 });
        assert_in_picture(&c, 1.5, (double[]){ -.5 * s, -.5 * s, 0 }, (double[]){ .5 * s, .5 * s, s });
        assert_true(c.eye[2] > 0.2 * s);
        noc_scene_destroy(scene);
    }
}

/* A closed room is seen from inside, not from within its furniture; with the lamp on its roof, from outside. */
static void test_room(void **state) {
    for (int outside = 0; outside < 2; outside++)
        for (int k = 0; k < 2; k++) {
            double s = k ? 20 : 1, x = 6 * s, y = 8 * s, z = 3 * s;
            char warning[128] = "";
            noc_log *log =
                noc_log_create(&(noc_log_params){ .level = NOC_LOG_WARN, .message = keep_warning, .user = warning });
            noc_scene *scene = noc_scene_create(log);
            add_box(scene, NOC_CLASS_OTHER, 0, 0, x, y, 0, z);
            add_box(scene, NOC_CLASS_OTHER, .1 * x, .1 * y, .3 * x, .3 * y, 0, .9 * z); /* a cupboard in a corner */
            noc_light lamp = { .kind = NOC_LIGHT_POINT,
                               .position = { 3 * s, 4 * s, outside ? 3.5 * s : 2.5 * s },
                               .emission = { 9, 9, 9 } };
            assert_int_equal(noc_scene_add_light(scene, &lamp), 0);
            all_views(scene);
            noc_camera c;
            assert_int_equal(noc_scene_camera(scene, NOC_VIEWPOINT_STREET, 1.5, &c), NOC_OK);
            /* not the street asked for */
            assert_non_null(strstr(warning, outside ? "so it is seen from outside" : "so it is seen from inside"));
            *warning = 0;
            assert_int_equal(noc_scene_camera(scene, NOC_VIEWPOINT_OWN, 1.5, &c), NOC_OK);
            assert_string_equal(warning, "");
            bool inside = c.eye[0] > 0 && c.eye[0] < x && c.eye[1] > 0 && c.eye[1] < y && c.eye[2] > 0 && c.eye[2] < z;
            bool in_cupboard = c.eye[0] < .3 * x && c.eye[1] < .3 * y;
            assert_true(inside == !outside);
            assert_true(!inside || !in_cupboard);
            noc_scene_destroy(scene);
            noc_log_destroy(log);
        }
}

/* Houses of no class along a street with lamps are a city nevertheless. */
static void test_plain_street(void **state) {
    noc_scene *scene = noc_scene_create(NULL);
    add_box(scene, NOC_CLASS_OTHER, -100, -100, 100, 100, -1, 0);
    for (int i = 0; i < 8; i++) {
        add_box(scene, NOC_CLASS_OTHER, -96 + i * 24, -30, -76 + i * 24, -7, 0, 12);
        add_box(scene, NOC_CLASS_OTHER, -96 + i * 24, 7, -76 + i * 24, 30, 0, 12);
        noc_light lamp = { .kind = NOC_LIGHT_POINT, .position = { -90 + i * 24, 0, 6 }, .emission = { 900, 900, 900 } };
        assert_true(noc_scene_add_light(scene, &lamp) >= 0);
    }
    noc_camera c;
    assert_int_equal(noc_scene_camera(scene, NOC_VIEWPOINT_OWN, 1.5, &c), NOC_OK);
    assert_true(fabs(c.eye[1]) < 7 && fabs(c.eye[2] - 1.7) < 1e-6);
    noc_scene_destroy(scene);
}

/* Two rows of houses with lamps between them, in a district of many more lamps and of no houses. */
static void test_lamps_beyond_houses(void **state) {
    noc_scene *scene = noc_scene_create(NULL);
    add_box(scene, NOC_CLASS_TERRAIN, -3000, -3000, 3000, 3000, -1, 0);
    for (int i = 0; i < 12; i++)
        for (int side = -1; side <= 1; side += 2)
            add_box(scene, NOC_CLASS_WALL, 12 * i, side > 0 ? 8 : -20, 12 * i + 11.5, side > 0 ? 20 : -8, 0, 12);
    for (int i = 0; i < 400; i++) { /* the densest are far from any house */
        bool there = i < 20;
        noc_light lamp = { .kind = NOC_LIGHT_POINT,
                           .position = { there ? 7.0 * i : -2500 + 12 * (i % 20), there ? 4 : 2000 + 12 * (i / 20), 6 },
                           .emission = { 90, 90, 90 } };
        assert_true(noc_scene_add_light(scene, &lamp) >= 0);
    }
    noc_camera street, aerial;
    assert_int_equal(noc_scene_camera(scene, NOC_VIEWPOINT_STREET, 1.5, &street), NOC_OK);
    assert_int_equal(noc_scene_camera(scene, NOC_VIEWPOINT_AERIAL, 1.5, &aerial), NOC_OK);
    assert_true(fabs(street.eye[1]) < 60 && street.eye[0] > -60 && street.eye[0] < 200);
    assert_true(hypot(aerial.target[0] - 70, aerial.target[1]) < 150);
    noc_scene_destroy(scene);
}

static void test_odd_scenes(void **state) {
    noc_scene *scene = noc_scene_create(NULL);
    noc_camera c = noc_camera_default();
    for (int v = 0; v < 3; v++)
        assert_int_equal(noc_scene_camera(scene, (noc_viewpoint)v, 1, &c), NOC_ERR_ARGUMENT);
    noc_light point = { .kind = NOC_LIGHT_POINT, .emission = { 1, 1, 1 } };
    assert_int_equal(noc_scene_add_light(scene, &point), 0); /* lights alone have no shape to look at */
    assert_int_equal(noc_scene_camera(scene, NOC_VIEWPOINT_STREET, 1, &c), NOC_ERR_ARGUMENT);

    static const double triangles[][9] = {
        { 0, 0, 0, 1, 0, 0, 0, 1, 0 },                                           /* small, flat */
        { 5, 5, 0, 5, 5, 3, 5, 6, 0 },                                           /* upright */
        { -3e5, 0, 10, 4e5, 100, 20, 0, 2e5, 30 },                               /* very large */
        { 1234567, 7654321, 100, 1234568, 7654321, 100, 1234567, 7654322, 100 }, /* very far */
    };
    noc_material m = noc_class_material(NOC_CLASS_OTHER);
    for (size_t i = 0; i < NOC_COUNT(triangles); i++) {
        noc_scene *one = noc_scene_create(NULL);
        noc_mesh mesh = { .vertex_count = 3,
                          .positions = triangles[i],
                          .triangle_count = 1,
                          .indices = (uint32_t[]){ 0, 1, 2 },
                          .material = noc_scene_add_material(one, &m) };
        assert_int_equal(noc_scene_add_mesh(one, &mesh), 0);
        all_views(one);
        noc_scene_destroy(one);
    }
    add_box(scene, NOC_CLASS_WALL, 0, 0, 1, 1, 0, 1);
    all_views(scene);
    static const double bad[] = { 0, -1, NAN, INFINITY };
    for (size_t i = 0; i < NOC_COUNT(bad); i++)
        assert_int_equal(noc_scene_camera(scene, NOC_VIEWPOINT_AERIAL, bad[i], &c), NOC_ERR_ARGUMENT);
    assert_int_equal(noc_scene_camera(scene, (noc_viewpoint)(NOC_VIEWPOINT_OWN + 1), 1, &c), NOC_ERR_ARGUMENT);
    assert_true(c.fov_deg == 50); /* untouched by errors */
    noc_scene_destroy(scene);
}

/* One stray triangle far away does not pull the views off the city. */
static void test_stray(void **state) {
    noc_scene *scene = noc_scene_create(NULL);
    for (int j = 0; j < 10; j++)
        for (int i = 0; i < 10; i++)
            add_box(scene, NOC_CLASS_WALL, i * 30, j * 40, i * 30 + 18, j * 40 + 25, 0, 12);
    add_box(scene, NOC_CLASS_OTHER, 90000, 90000, 90001, 90001, 0, 1);
    for (int v = 0; v < 3; v++) {
        noc_camera c;
        assert_int_equal(noc_scene_camera(scene, (noc_viewpoint)v, 1.5, &c), NOC_OK);
        assert_true(fabs(c.target[0] - 150) < 400 && fabs(c.target[1] - 200) < 400);
    }
    noc_scene_destroy(scene);
}

/* Pictures may be slits of one pixel: every size has a view, and only what is no aspect is refused. */
static void test_slits(void **state) {
    noc_scene *scene = noc_scene_create(NULL);
    add_box(scene, NOC_CLASS_TERRAIN, -100, -100, 100, 100, -1, 0);
    add_box(scene, NOC_CLASS_WALL, 10, 10, 30, 40, 0, 12);
    static const double good[] = { 1.0 / 32768, 1 / 500.0, 4097 / 3.0, 32768 }, bad[] = { 0, -1, NAN, INFINITY };
    noc_camera c;
    for (int v = 0; v < 3; v++) {
        for (size_t i = 0; i < NOC_COUNT(good); i++) {
            assert_int_equal(noc_scene_camera(scene, (noc_viewpoint)v, good[i], &c), NOC_OK);
            check_sane(&c);
        }
        for (size_t i = 0; i < NOC_COUNT(bad); i++)
            assert_int_equal(noc_scene_camera(scene, (noc_viewpoint)v, bad[i], &c), NOC_ERR_ARGUMENT);
    }
    noc_scene_destroy(scene);
}

static noc_scene *stack_of_grounds(noc_log *log, int count) {
    noc_scene *scene = noc_scene_create(log);
    for (int i = 0; i < count; i++) {
        noc_material m = noc_class_material(NOC_CLASS_GROUND);
        const double p[12] = { 0, 0, .001 * i, 100, 0, .001 * i, 100, 100, .001 * i, 0, 100, .001 * i };
        noc_mesh mesh = { .vertex_count = 4,
                          .positions = p,
                          .triangle_count = 2,
                          .indices = (uint32_t[]){ 0, 1, 2, 0, 2, 3 },
                          .material = i ? 0 : noc_scene_add_material(scene, &m) };
        assert_true(noc_scene_add_mesh(scene, &mesh) >= 0);
    }
    return scene;
}

/* Of 1,600 places in 500 sheets of two triangles each, 500 million looks of 2,500 rays allow 200: one in eight. */
static void test_stack_is_searched_in_part(void **state) {
    for (int count = 20; count <= 500; count += 480) {
        char warning[256] = "";
        noc_log *log =
            noc_log_create(&(noc_log_params){ .level = NOC_LOG_WARN, .message = keep_warning, .user = warning });
        noc_scene *scene = stack_of_grounds(log, count);
        noc_camera c;
        assert_int_equal(noc_scene_camera(scene, NOC_VIEWPOINT_STREET, 1.5, &c), NOC_OK);
        check_sane(&c);
        assert_true(fabs(c.eye[2] - .001 * (count - 1) - 1.7) < 1e-4); /* a person stands on the highest */
        assert_int_equal(strstr(warning, "searched at 12 % of the places; --eye") != NULL, count == 500);
        assert_int_equal(*warning != '\0', count == 500);
        noc_scene_destroy(scene);
        noc_log_destroy(log);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(test_builtin_city),
                                        cmocka_unit_test(test_without_lights),
                                        cmocka_unit_test(test_one_lamp),
                                        cmocka_unit_test(test_object),
                                        cmocka_unit_test(test_room),
                                        cmocka_unit_test(test_plain_street),
                                        cmocka_unit_test(test_panel),
                                        cmocka_unit_test(test_no_warning),
                                        cmocka_unit_test(test_lamps_beyond_houses),
                                        cmocka_unit_test(test_odd_scenes),
                                        cmocka_unit_test(test_stray),
                                        cmocka_unit_test(test_slits),
                                        cmocka_unit_test(test_stack_is_searched_in_part) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
