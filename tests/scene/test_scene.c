/* Materials, meshes and lights: what is taken, what is refused, what the flat arrays hold. */
#include "../test.h"

#include "scene/scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

static void ignore(void *user, noc_log_level level, const char *text) { ++*(int *)user; }

typedef struct fixture {
    noc_log *log;
    int messages;
    noc_scene *scene;
    int mat;
} fixture;

static int setup(void **state) {
    fixture *f = noc_calloc(1, sizeof(*f));
    f->log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_WARN, .message = ignore, .user = &f->messages });
    f->scene = noc_scene_create(f->log);
    noc_material m = noc_class_material(NOC_CLASS_WALL);
    f->mat = noc_scene_add_material(f->scene, &m);
    *state = f;
    return 0;
}

static int teardown(void **state) {
    fixture *f = *state;
    noc_scene_destroy(f->scene);
    noc_log_destroy(f->log);
    free(f);
    return 0;
}

static void test_materials(void **state) {
    fixture *f = *state;
    for (int c = 0; c < NOC_CLASS_COUNT; c++) {
        noc_material m = noc_class_material((noc_class)c);
        assert_int_equal(m.cls, c);
        assert_true(strlen(noc_class_name((noc_class)c)) > 2);
        for (int d = 0; d < c; d++)
            assert_string_not_equal(noc_class_name((noc_class)c), noc_class_name((noc_class)d));
        assert_int_equal(noc_scene_add_material(f->scene, &m), c + 1);
        const noc_material_record *r = &f->scene->material_records.data[c + 1];
        assert_memory_equal(r->albedo, m.albedo, sizeof(m.albedo));
        assert_float_equal(r->alpha, m.roughness * m.roughness, 0);
    }
    assert_string_equal(noc_class_name((noc_class)99), "unknown");
    assert_int_equal(noc_class_material((noc_class)-1).cls, NOC_CLASS_OTHER);
    assert_int_equal(f->messages, 0);
    noc_material dry = noc_class_material(NOC_CLASS_ROAD), rain = noc_material_wet(&dry),
                 again = noc_material_wet(&rain);
    assert_true(rain.albedo[0] > .04f && rain.albedo[0] < dry.albedo[0] && rain.roughness < dry.roughness);
    assert_true(rain.cls == NOC_CLASS_ROAD && again.albedo[0] < rain.albedo[0]);
    dry.albedo[0] = 1; /* nothing is lost to what does not absorb, and nothing comes of black */
    dry.albedo[1] = 0;
    rain = noc_material_wet(&dry);
    assert_true(rain.albedo[0] == 1 && rain.albedo[1] == 0 && noc_material_wet(NULL).f0 == .02f);
    noc_material good = noc_class_material(NOC_CLASS_WALL), bad[9];
    for (int i = 0; i < 9; i++)
        bad[i] = good;
    bad[0].albedo[1] = 1.01f, bad[1].albedo[2] = NAN, bad[2].f0 = -0.1f, bad[3].roughness = 0, bad[4].roughness = NAN;
    bad[5].emission[0] = -1, bad[6].emission[1] = INFINITY, bad[7].cls = NOC_CLASS_COUNT, bad[8].f0 = 2;
    size_t before = f->scene->materials.len;
    for (int i = 0; i < 9; i++) {
        assert_int_equal(noc_scene_add_material(f->scene, &bad[i]), -1);
        assert_int_equal(f->messages, i + 1); /* reported once each */
    }
    assert_int_equal(f->scene->materials.len, before);
    assert_int_equal(f->scene->material_records.len, before);
}

static void test_meshes(void **state) {
    fixture *f = *state;
    double nan_far[] = { 0, 0, 0, 1, 0, 0, 0, 1, 0, NAN, 0, 0, 0, 0, 1e9, 2, 0, 0 };
    uint32_t indices[] = { 0,           1, 2, /* good */ 0,    1, 3,
                           /* NaN */ 0, 1, 4, /* too far */ 0, 1, 6, /* no such vertex */
                           0,           1, 5, /* no area */ 1, 1, 2 };
    noc_mesh mesh = { .vertex_count = 6,
                      .positions = nan_far,
                      .triangle_count = 6,
                      .indices = indices,
                      .material = f->mat,
                      .name = "house" };
    assert_int_equal(noc_scene_add_mesh(f->scene, &mesh), 0);
    char name[] = "copied";
    mesh.triangle_count = 1;
    mesh.name = name;
    assert_int_equal(noc_scene_add_mesh(f->scene, &mesh), 1);
    name[0] = 'X';
    noc_scene_info info;
    noc_scene_get_info(f->scene, &info);
    assert_int_equal(info.triangles, 2);
    assert_int_equal(info.triangles_dropped, 5);
    assert_int_equal(info.meshes, 2);
    assert_int_equal(info.triangles_by_class[NOC_CLASS_WALL], 2);
    for (int k = 0; k < 3; k++) {
        assert_true(info.bounds_min[k] == 0);
        assert_true(info.bounds_max[k] == (k < 2)); /* dropped triangles do not widen it */
    }
    assert_int_equal(f->scene->meshes.data[1].first_triangle, 1);
    assert_int_equal(f->scene->indices.data[3], 6); /* the second mesh's own vertices */
    assert_string_equal(f->scene->meshes.data[0].name, "house");
    assert_string_equal(f->scene->meshes.data[1].name, "copied");
    assert_int_equal(f->messages, 0);

    mesh.material = 5;
    assert_int_equal(noc_scene_add_mesh(f->scene, &mesh), -1);
    mesh.material = -1;
    assert_int_equal(noc_scene_add_mesh(f->scene, &mesh), -1);
    mesh.material = f->mat;
    mesh.positions = NULL;
    assert_int_equal(noc_scene_add_mesh(f->scene, &mesh), -1);
    mesh = (noc_mesh){ .vertex_count = SIZE_MAX / 16, .positions = nan_far, .material = f->mat };
    assert_int_equal(noc_scene_add_mesh(f->scene, &mesh), -1);
    assert_int_equal(f->messages, 4);
    assert_int_equal(f->scene->meshes.len, 2);
    mesh = (noc_mesh){ .material = f->mat }; /* nothing in it: allowed, as after dropping all */
    assert_int_equal(noc_scene_add_mesh(f->scene, &mesh), 2);
}

static void triangle_geometry(const noc_scene *scene, size_t t, double normal[3], double centre[3]) {
    const float *p[3];
    for (int i = 0; i < 3; i++)
        p[i] = scene->positions.data + 3 * (size_t)scene->indices.data[3 * t + i];
    double u[3], v[3];
    for (int k = 0; k < 3; k++) {
        u[k] = (double)p[1][k] - p[0][k], v[k] = (double)p[2][k] - p[0][k];
        centre[k] = ((double)p[0][k] + p[1][k] + p[2][k]) / 3;
    }
    for (int k = 0; k < 3; k++) /* twice the area long */
        normal[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* Shapes close, face the light's way, and have (nearly, for inscribed round ones) the light's area. */
static void test_shapes(void **state) {
    fixture *f = *state;
    static const noc_light lights[] = {
        { .kind = NOC_LIGHT_SPHERE,
          .position = { 10, 20, 5 },
          .radius = 0.3,
          .emission = { 9, 8, 7 },
          .name = "globe" },
        { .kind = NOC_LIGHT_DISC,
          .position = { -3, 2, 8 },
          .direction = { 0, 0, -2 },
          .radius = 0.2,
          .emission = { 1, 2, 3 } },
        { .kind = NOC_LIGHT_DISC,
          .position = { -3, 2, 8 },
          .direction = { 1, 1, 0.1 },
          .radius = 2,
          .emission = { 1, 2, 3 } },
        { .kind = NOC_LIGHT_TRIANGLE,
          .position = { 1, 1, 1 },
          .edge_u = { 2, 0, 0 },
          .edge_v = { 0, 3, 0 },
          .emission = { 5, 5, 5 } },
        { .kind = NOC_LIGHT_PARALLELOGRAM,
          .position = { 0, 0, 3 },
          .edge_u = { 1, 1, 0 },
          .edge_v = { 0, 0, 2 },
          .emission = { 5, 5, 5 },
          .inferred = true },
        { .kind = NOC_LIGHT_POINT, .position = { 4, 5, 6 }, .emission = { 100, 0, 0 } },
        { .kind = NOC_LIGHT_SPOT,
          .position = { 4, 5, 6 },
          .direction = { 0, 2, 0 },
          .inner_deg = 5,
          .outer_deg = 20,
          .emission = { 100, 0, 0 } },
    };
    static const double area[] = { 4 * M_PI * 0.09, M_PI * 0.04, M_PI * 4, 3, 2 * M_SQRT2, 0, 0 };
    for (size_t i = 0; i < NOC_COUNT(lights); i++) {
        const noc_light *l = &lights[i];
        size_t first = f->scene->indices.len / 3;
        assert_int_equal(noc_scene_add_light(f->scene, l), i);
        size_t end = f->scene->indices.len / 3;
        const noc_light_record *r = &f->scene->lights.data[i];
        assert_int_equal(r->kind, l->kind);
        assert_true(fabs(r->area - area[i]) <= 1e-5 * area[i]);
        assert_memory_equal(r->e, l->emission, sizeof(r->e));
        assert_int_equal((r->flags & NOC_LIGHT_INFERRED) != 0, l->inferred);
        double a[3] = { r->a[0], r->a[1], r->a[2] }, b[3] = { r->b[0], r->b[1], r->b[2] }, facing[3], sum = 0,
               closed[3] = { 0 };
        for (int k = 0; k < 3; k++)
            facing[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
        if (l->kind == NOC_LIGHT_DISC) { /* orthogonal, a radius long, facing its direction */
            assert_true(fabs(dot(a, b)) < 1e-6 * l->radius && fabs(sqrt(dot(a, a)) - l->radius) < 1e-6 * l->radius);
            double cosine = dot(facing, l->direction) / sqrt(dot(facing, facing) * dot(l->direction, l->direction));
            assert_true(cosine > 0.999999);
        }
        for (size_t t = first; t < end; t++) {
            double n[3], c[3];
            triangle_geometry(f->scene, t, n, c);
            sum += 0.5 * sqrt(dot(n, n));
            for (int k = 0; k < 3; k++)
                closed[k] += n[k];
            if (l->kind == NOC_LIGHT_SPHERE)
                for (int k = 0; k < 3; k++)
                    facing[k] = c[k] - l->position[k];
            assert_true(dot(n, facing) > 0);
            assert_int_equal(f->scene->triangle_light.data[t], i);
        }
        /* a closed shape shows a quarter of it on average (Cauchy) */
        assert_true(fabs(sum - area[i]) <= 2e-5 * area[i]);
        if (l->kind == NOC_LIGHT_SPHERE)
            assert_true(dot(closed, closed) < 1e-10);
        assert_int_equal(end > first, l->kind < NOC_LIGHT_POINT);
    }
    noc_scene_info info;
    noc_scene_get_info(f->scene, &info);
    assert_int_equal(info.lights, 7);
    assert_int_equal(info.lights_inferred, 1);
    assert_int_equal(info.lights_by_kind[NOC_LIGHT_DISC], 2);
    assert_int_equal(info.lights_by_kind[NOC_LIGHT_SPOT], 1);
    assert_int_equal(info.triangles_dropped, 0);
    assert_string_equal(f->scene->light_names.data[0], "globe");
    assert_null(f->scene->light_names.data[1]);
    assert_int_equal(noc_scene_commit(f->scene), NOC_OK);
    noc_scene_get_info(f->scene, &info);
    assert_int_equal(info.lights, 7); /* shapes do not become lights of their own */
    assert_int_equal((uintptr_t)f->scene->lights.data % 64, 0);
    assert_true(f->scene->positions.cap > f->scene->positions.len);
    assert_int_equal(f->messages, 0);
}

static void test_bad_lights(void **state) {
    fixture *f = *state;
    noc_light sphere = { .kind = NOC_LIGHT_SPHERE, .radius = 1, .emission = { 1, 1, 1 } }, disc = sphere, quad, spot,
              bad[19];
    disc.kind = NOC_LIGHT_DISC;
    disc.direction[0] = 1;
    quad = (noc_light){
        .kind = NOC_LIGHT_PARALLELOGRAM, .edge_u = { 1, 0, 0 }, .edge_v = { 0, 1, 0 }, .emission = { 1, 1, 1 }
    };
    spot = (noc_light){
        .kind = NOC_LIGHT_SPOT, .direction = { 0, 0, -1 }, .inner_deg = 10, .outer_deg = 30, .emission = { 1, 1, 1 }
    };
    for (int i = 0; i < 19; i++)
        bad[i] = i < 6 ? sphere : i < 9 ? disc : i < 14 ? quad : spot;
    bad[0].position[2] = NAN, bad[1].position[0] = 1e9, bad[2].radius = 0, bad[3].radius = NAN, bad[4].emission[1] = -1;
    bad[5].emission[2] = INFINITY, bad[6].direction[0] = 0, bad[7].direction[1] = NAN, bad[8].radius = -1;
    bad[9].edge_u[0] = 0, bad[10].edge_v[0] = INFINITY, bad[11].edge_v[0] = 1, bad[11].edge_v[1] = 0,
    bad[12].kind = (noc_light_kind)7;
    bad[13].kind = NOC_LIGHT_TRIANGLE, bad[13].edge_v[1] = 0;
    bad[14].direction[2] = 0, bad[15].outer_deg = 91, bad[16].inner_deg = 31, bad[17].inner_deg = -1,
    bad[18].outer_deg = NAN;
    for (int i = 0; i < 19; i++) {
        assert_int_equal(noc_scene_add_light(f->scene, &bad[i]), -1);
        assert_int_equal(f->messages, i + 1);
    }
    noc_scene_info info;
    noc_scene_get_info(f->scene, &info);
    assert_int_equal(info.lights + info.triangles + info.meshes, 0);
    assert_int_equal(f->scene->light_names.len, 0);
    assert_true(noc_scene_add_light(f->scene, &quad) == 0);
}

/* Lights of one emission share one material, so that a city of windows does not have one a window. */
static void test_light_materials(void **state) {
    fixture *f = *state;
    noc_light l = { .kind = NOC_LIGHT_PARALLELOGRAM, .edge_u = { 1, 0, 0 }, .edge_v = { 0, 1, 0 } };
    for (int i = 0; i < 300; i++) {
        l.position[0] = i;
        l.emission[0] = (float)(1 + i % 10);
        assert_int_equal(noc_scene_add_light(f->scene, &l), i);
        assert_float_equal(f->scene->material_records.data[f->scene->triangle_material.data[2 * i]].emission[0],
                           1 + i % 10, 0);
    }
    assert_int_equal(f->scene->materials.len, 11);
}

static void test_emissive_meshes(void **state) {
    fixture *f = *state;
    noc_material glow = noc_class_material(NOC_CLASS_OTHER);
    glow.emission[1] = 40;
    glow.two_sided = true;
    int lit = noc_scene_add_material(f->scene, &glow);
    glow.cls = NOC_CLASS_CLOSURE;
    int virtual = noc_scene_add_material(f->scene, &glow);
    double xyz[] = { 0, 0, 0, 2, 0, 0, 2, 2, 0, 0, 2, 0 };
    noc_mesh mesh = { .vertex_count = 4,
                      .positions = xyz,
                      .triangle_count = 2,
                      .indices = (uint32_t[]){ 0, 1, 2, 0, 2, 3 },
                      .material = f->mat,
                      .name = "dark" };
    assert_int_equal(noc_scene_add_mesh(f->scene, &mesh), 0);
    mesh.material = lit;
    mesh.name = "sign";
    assert_int_equal(noc_scene_add_mesh(f->scene, &mesh), 1);
    mesh.material = virtual;
    assert_int_equal(noc_scene_add_mesh(f->scene, &mesh), 2);
    assert_int_equal(noc_scene_commit(f->scene), NOC_OK);
    assert_int_equal(noc_scene_commit(f->scene), NOC_OK); /* again: nothing happens */
    noc_scene_info info;
    noc_scene_get_info(f->scene, &info);
    assert_int_equal(info.lights, 2);
    for (uint32_t i = 0; i < 2; i++) {
        const noc_light_record *r = &f->scene->lights.data[i];
        assert_int_equal(r->kind, NOC_LIGHT_TRIANGLE);
        assert_int_equal(r->flags, NOC_LIGHT_TWO_SIDED | NOC_LIGHT_OWNED);
        assert_float_equal(r->area, 2, 1e-6);
        assert_float_equal(r->e[1], 40, 0);
        assert_float_equal(r->a[0] * r->b[1] - r->a[1] * r->b[0], 4, 1e-6); /* faces up, as the mesh does */
        assert_int_equal(f->scene->triangle_light.data[2 + i], i);
        assert_int_equal(f->scene->triangle_light.data[i], NOC_NO_LIGHT);
        assert_int_equal(f->scene->triangle_light.data[4 + i], NOC_NO_LIGHT);
        assert_string_equal(f->scene->light_names.data[i], "sign");
    }
}

static void test_empty(void **state) {
    fixture *f = *state;
    assert_int_equal(noc_scene_commit(f->scene), NOC_OK);
    noc_scene_info info;
    noc_scene_get_info(f->scene, &info);
    assert_int_equal(info.triangles + info.lights + info.meshes, 0);
    assert_string_equal(info.crs, "");
    for (int k = 0; k < 3; k++)
        assert_true(info.bounds_min[k] == 0 && info.bounds_max[k] == 0);
    assert_int_equal(noc_scene_set_crs(f->scene, "EPSG:25832", (double[]){ 1, NAN, 0 }), NOC_ERR_ARGUMENT);
    assert_int_equal(noc_scene_set_crs(f->scene, "EPSG:25832", NULL), NOC_ERR_ARGUMENT);
    assert_int_equal(noc_scene_set_crs(f->scene, "EPSG:25832", (double[]){ 1, 2, 3 }), NOC_OK);
    assert_int_equal(noc_scene_set_crs(f->scene, NULL, (double[]){ 4, 5, 6 }), NOC_OK);
    noc_scene_get_info(f->scene, &info);
    assert_string_equal(info.crs, "");
    assert_true(info.origin[2] == 6);
    noc_scene_destroy(NULL);
}

/* What is added to a committed scene is staged: the arrays stay as they are. */
static void test_committed(void **state) {
    fixture *f = *state;
    assert_int_equal(noc_scene_commit(f->scene), NOC_OK);
    size_t materials = f->scene->materials.len;
    noc_material m = noc_class_material(NOC_CLASS_WALL);
    noc_mesh mesh = { .material = f->mat };
    noc_light light = { .kind = NOC_LIGHT_POINT, .emission = { 1, 1, 1 } };
    assert_int_equal(noc_scene_add_material(f->scene, &m), (int)materials);
    assert_int_equal(noc_scene_add_mesh(f->scene, &mesh), 0);
    assert_int_equal(noc_scene_add_light(f->scene, &light), 0);
    assert_int_equal(f->messages, 0);
    assert_int_equal(f->scene->materials.len, materials);
    assert_int_equal(f->scene->meshes.len + f->scene->lights.len, 0);
    assert_int_equal(noc_scene_commit(f->scene), NOC_OK);
    assert_int_equal(f->scene->materials.len, materials + 1);
    assert_int_equal(f->scene->meshes.len, 1);
    assert_int_equal(f->scene->lights.len, 1);
}

/* Lights that move have no shape, of any kind; moving one writes the record that adding it there would have made. */
static void test_moving_lights(void **state) {
    fixture *f = *state;
    const noc_light stands = { .kind = NOC_LIGHT_POINT, .position = { 1, 2, 3 }, .emission = { 5, 5, 5 } };
    assert_int_equal(noc_scene_add_light(f->scene, &stands), 0);
    for (int kind = 0; kind < NOC_LIGHT_KIND_COUNT; kind++) {
        noc_light l = { .kind = (noc_light_kind)kind,
                        .position = { 1, 2, 3 },
                        .edge_u = { 1, 0, 0 },
                        .edge_v = { 0, 2, 0 },
                        .direction = { 0, 1, -1 },
                        .radius = 0.5,
                        .inner_deg = 5,
                        .outer_deg = 30,
                        .emission = { 5, 6, 7 },
                        .inferred = true,
                        .moving = true };
        noc_light there = l, again;
        there.position[0] = 9, there.edge_u[1] = 3, there.direction[0] = 2, there.radius = 0.25, there.emission[2] = 0;
        noc_scene *other = noc_scene_create(NULL);
        assert_int_equal(noc_scene_add_light(other, &there), 0);
        int i = noc_scene_add_light(f->scene, &l);
        assert_int_equal(i, 1);
        assert_int_equal(noc_scene_commit(f->scene), NOC_OK);
        assert_int_equal(f->scene->triangle_light.len, 0);
        assert_int_equal(f->scene->moving.len, 1);
        there.moving = there.inferred = false; /* not read */
        const noc_scene_versions *v = &f->scene->versions;
        assert_int_equal(noc_scene_move_light(f->scene, i, &there), NOC_OK);
        assert_memory_not_equal(&f->scene->lights.data[i], &other->lights.data[0], sizeof(noc_light_record));
        assert_int_equal(noc_scene_commit(f->scene), NOC_OK);
        assert_memory_equal(&f->scene->lights.data[i], &other->lights.data[0], sizeof(noc_light_record));
        assert_int_equal(v->moved, 1);
        assert_int_equal(v->emission, 1);
        there.position[1] = -4; /* a move alone does not change what it emits; to where it is, is no move */
        for (int twice = 0; twice < 2; twice++) {
            assert_int_equal(noc_scene_move_light(f->scene, i, &there), NOC_OK);
            assert_int_equal(noc_scene_commit(f->scene), NOC_OK);
        }
        assert_int_equal(v->moved, 2);
        assert_int_equal(v->commits, 2);
        assert_int_equal(v->emission, 1);
        assert_int_equal(v->standing + v->lights + v->geometry, 0);

        noc_light_record before = f->scene->lights.data[i], still = f->scene->lights.data[0];
        f->messages = 0;
        assert_int_equal(noc_scene_move_light(f->scene, 2, &there), NOC_ERR_ARGUMENT);
        assert_int_equal(noc_scene_move_light(f->scene, -1, &there), NOC_ERR_ARGUMENT);
        assert_int_equal(noc_scene_move_light(f->scene, 0, &stands), NOC_ERR_ARGUMENT); /* it stands */
        again = there, again.kind = (noc_light_kind)((kind + 1) % NOC_LIGHT_KIND_COUNT);
        assert_int_equal(noc_scene_move_light(f->scene, i, &again), NOC_ERR_ARGUMENT);
        again = there, again.position[2] = NAN;
        assert_int_equal(noc_scene_move_light(f->scene, i, &again), NOC_ERR_ARGUMENT);
        again = there, again.emission[1] = -1;
        assert_int_equal(noc_scene_move_light(f->scene, i, &again), NOC_ERR_ARGUMENT);
        assert_int_equal(f->messages, 6); /* each reported once */
        assert_int_equal(noc_scene_commit(f->scene), NOC_OK);
        assert_int_equal(v->commits, 2);
        assert_memory_equal(&f->scene->lights.data[i], &before, sizeof(before));
        assert_memory_equal(&f->scene->lights.data[0], &still, sizeof(still));

        noc_scene_destroy(other);
        noc_scene_destroy(f->scene);
        f->scene = noc_scene_create(f->log);
        assert_int_equal(noc_scene_add_light(f->scene, &stands), 0);
    }
}

/* From now on the process may grow by so many bytes; false where that cannot be set. */
static bool leave_memory(size_t bytes, struct rlimit *was) {
    unsigned long pages = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    bool ok = file && fscanf(file, "%lu", &pages) == 1 && !getrlimit(RLIMIT_AS, was);
    if (file)
        fclose(file);
    struct rlimit now = { (rlim_t)pages * (rlim_t)sysconf(_SC_PAGESIZE) + bytes, was->rlim_max };
    return ok && !setrlimit(RLIMIT_AS, &now);
}

/* A scene that memory is refused to: one message, what was there stays as it is, nothing more comes, and no commit. */
static void test_no_memory(void **state) {
    fixture *f = *state;
    enum { MANY = 2000000, LEFT = 16 << 20 };
    struct rlimit was;
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    skip(); /* its shadow memory knows no limit */
#endif
    noc_material lit = noc_class_material(NOC_CLASS_OTHER);
    lit.emission[0] = 1;
    double xyz[9] = { 0, 0, 0, 1, 0, 0, 0, 1, 0 }, *far = noc_calloc(MANY, 3 * sizeof(double));
    uint32_t *indices = noc_calloc(MANY, 3 * sizeof(uint32_t));
    for (size_t i = 0; i < 3 * MANY; i++)
        indices[i] = (uint32_t)(i % 3);
    for (int way = 0; way < 5; way++) { /* many vertices, triangles, lights, lights that commit makes, materials */
        noc_scene *scene = noc_scene_create(f->log);
        noc_mesh small = { .vertex_count = 3,
                           .positions = xyz,
                           .triangle_count = 1,
                           .indices = indices,
                           .material = noc_scene_add_material(scene, &lit) };
        noc_mesh large = small;
        noc_light light = { .kind = NOC_LIGHT_POINT, .emission = { 1, 1, 1 } };
        f->messages = 0;
        assert_int_equal(noc_scene_add_mesh(scene, &small), 0);
        if (way == 0)
            large.vertex_count = MANY, large.positions = far;
        if (way == 1 || way == 3)
            large.triangle_count = MANY;
        if (way == 3)
            assert_int_equal(noc_scene_add_mesh(scene, &large), 1);
        if (!leave_memory(LEFT, &was))
            skip();
        int added = 0;
        if (way < 2)
            assert_int_equal(noc_scene_add_mesh(scene, &large), -1);
        while (way == 2 && added < MANY && noc_scene_add_light(scene, &light) >= 0)
            added++;
        int materials = 1;
        while (way == 4 && materials < MANY && noc_scene_add_material(scene, &lit) >= 0)
            materials++;
        assert_true(added < MANY && (added > 1000) == (way == 2) && materials < MANY &&
                    (materials > 1000) == (way == 4));
        assert_int_equal(noc_scene_commit(scene), NOC_ERR_MEMORY);
        assert_int_equal(setrlimit(RLIMIT_AS, &was), 0);
        assert_int_equal(noc_scene_add_mesh(scene, &small), -1);
        assert_int_equal(noc_scene_add_light(scene, &light), -1);
        assert_int_equal(noc_scene_add_material(scene, &lit), -1);
        assert_int_equal(noc_scene_commit(scene), NOC_ERR_MEMORY);
        assert_int_equal(f->messages, 1);
        assert_int_equal(scene->materials.len, materials);
        assert_int_equal(scene->lights.len, added);
        assert_int_equal(scene->meshes.len, way == 3 ? 2 : 1);
        assert_int_equal(scene->triangle_light.len, way == 3 ? MANY + 1 : 1);
        noc_scene_destroy(scene);
    }
    free(far);
    free(indices);
}

/* A scene of a quad and a lamp, one thing of it other than usual. */
static void key_of(int other, char key[NOC_CONTENT_KEY]) {
    noc_scene *s = noc_scene_create(NULL);
    noc_material m = noc_class_material(NOC_CLASS_WALL);
    m.albedo[1] = other == 1 ? 0.2f : 0.1f;
    m.emission[0] = other == 2 ? 5 : 10;
    m.cls = other == 3 ? NOC_CLASS_CLOSURE : NOC_CLASS_WALL;
    m.two_sided = other == 4;
    m.roughness = other == 5 ? 0.5f : 1;
    double p[] = { 0, 0, 0, 1, 0, 0, 0, other == 6 ? 1.001 : 1, 0, 1, 1, 0 };
    uint32_t v[] = { 0, 1, 2, other == 7 ? 3 : 1, other == 7 ? 1 : 3, 2 };
    noc_light l = { .kind = NOC_LIGHT_POINT,
                    .position = { 0, 0, other == 8 ? 3 : 2 },
                    .emission = { 1, 1, other == 9 ? 2 : 1 },
                    .moving = true };
    int material = noc_scene_add_material(s, &m);
    noc_mesh mesh = { .vertex_count = 4,
                      .positions = p,
                      .triangle_count = other == 10 ? 1 : 2,
                      .indices = v,
                      .material = material,
                      .name = other == 12 ? "another name" : "name" };
    assert_int_equal(noc_scene_add_mesh(s, &mesh), 0);
    int light = noc_scene_add_light(s, &l);
    assert_true(light >= 0);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    if (other == 11) {
        l.position[0] = 1;
        assert_int_equal(noc_scene_move_light(s, light, &l), NOC_OK);
        assert_int_equal(noc_scene_commit(s), NOC_OK);
    }
    noc_scene_content(s, key);
    noc_scene_destroy(s);
}

/* Whatever a picture shows changes the key; a name does not, nor does making the scene again. */
static void test_content(void **state) {
    char keys[13][NOC_CONTENT_KEY], again[NOC_CONTENT_KEY];
    (void)state;
    for (int i = 0; i < 13; i++) {
        key_of(i, keys[i]);
        assert_int_equal(strlen(keys[i]), 32);
        for (int k = 0; k < i && i < 12; k++)
            assert_string_not_equal(keys[i], keys[k]);
    }
    assert_string_equal(keys[12], keys[0]);
    key_of(0, again);
    assert_string_equal(again, keys[0]);
}

/* docs/views.md tells the luminance of each class, by which lux are worked out, and which have a gloss. */
static void test_reflectances_in_docs(void **state) {
    char *path = noc_format("%s/docs/views.md", getenv("NOC_SOURCE")), text[65536];
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    text[fread(text, 1, sizeof(text) - 1, file)] = 0;
    fclose(file);
    free(path);
    (void)state;
    for (int c = 0; c < NOC_CLASS_COUNT; c++) {
        noc_material m = noc_class_material(c);
        double rho = 0.2126 * (double)m.albedo[0] + 0.7152 * (double)m.albedo[1] + 0.0722 * (double)m.albedo[2];
        char row[80], gloss[16];
        snprintf(row, sizeof(row), "| %d %s | %.3f |", c, noc_class_name(c), rho);
        const char *at = strstr(text, row);
        if (!at)
            fail_msg("docs/views.md lacks \"%s\"", row);
        snprintf(gloss, sizeof(gloss), "%.7s", at + strlen(row));
        assert_int_equal(m.f0 > 0, !strcmp(gloss, " gloss "));
    }
}

int main(void) {
#define TEST(name) cmocka_unit_test_setup_teardown(name, setup, teardown)
    const struct CMUnitTest tests[] = { TEST(test_materials),
                                        TEST(test_meshes),
                                        TEST(test_shapes),
                                        TEST(test_bad_lights),
                                        TEST(test_light_materials),
                                        TEST(test_emissive_meshes),
                                        TEST(test_empty),
                                        TEST(test_committed),
                                        TEST(test_moving_lights),
                                        TEST(test_no_memory),
                                        cmocka_unit_test(test_content),
                                        cmocka_unit_test(test_reflectances_in_docs) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
