/* A scene with groups, a model and its instances, made so from the start or edited to be so. */
#ifndef NOC_TEST_EDITS_H
#define NOC_TEST_EDITS_H

#include "../render/rooms.h"

#include "scene/scene.h"

/* What the scenes below are made of; every edit has its place in the making, too. */
typedef enum change {
    NOTHING,
    MATERIAL,
    CLASS_MATERIAL,
    SHINES,
    GOES_OUT,
    RECOLOURED,
    TWO_SIDED,
    EMISSION,
    DIMMED,
    SWITCHED_OFF,
    LIGHT_MOVED,
    LIGHT_ADDED,
    LIGHT_REMOVED,
    MESH_ADDED,
    MESH_REMOVED,
    TOWER_REMOVED,
    INSTANCE_ADDED,
    INSTANCE_MOVED,
    INSTANCE_REMOVED,
    INSTANCE_DARK,
    CHANGES
} change;

enum { DARK, SIGN, WALL, BODY, GLOW }; /* materials */
enum { STREET = 1, CARS };             /* groups */
enum { CAR = 1 };                      /* models */
enum { GLOBE, SPOT, LAMP };            /* lights; then those of meshes and instances */
enum { GROUND, SHOP, TOWER, FRONT };   /* meshes, behind them the globe's and the lamp's shapes, and the car's */

static inline void piece(noc_scene *s, int material, int model, int group, const char *name, double x, double size) {
    noc_mesh mesh = { .vertex_count = 4,
                      .positions = (double[]){ x, 0, 0, x + size, 0, 0, x, size, 0, x, 0, size },
                      .triangle_count = 2,
                      .indices = (uint32_t[]){ 0, 1, 2, 0, 1, 3 },
                      .material = material,
                      .model = model,
                      .group = group,
                      .name = name };
    assert_true(noc_scene_add_mesh(s, &mesh) >= 0);
}

static inline noc_light lamp_at(double x) {
    return (noc_light){ .kind = NOC_LIGHT_DISC,
                        .position = { x, 1, 4 },
                        .direction = { 0, 0, -1 },
                        .radius = 0.1,
                        .emission = { 90, 80, 40 },
                        .name = "lamp" };
}

static inline noc_light spot_at(double x) {
    return (noc_light){ .kind = NOC_LIGHT_SPOT,
                        .position = { x, 2, 3 },
                        .direction = { 1, 1, -1 },
                        .inner_deg = 10,
                        .outer_deg = 40,
                        .emission = { 500, 500, 400 },
                        .moving = true };
}

static inline void place(double yaw, double scale, double x, double out[12]) {
    double c = scale * cos(yaw), s = scale * sin(yaw), rows[12] = { c, -s, 0, x, s, c, 0, 3, 0, 0, scale, 0.5 };
    memcpy(out, rows, sizeof(rows));
}

static inline void materials(noc_scene *s, change with) {
    noc_material m[] = { [DARK] = { .albedo = { .2f, .2f, .2f }, .roughness = 1, .cls = NOC_CLASS_ROAD },
                         [SIGN] = { .emission = { 7, 5, 3 }, .roughness = 1 },
                         [WALL] = { .albedo = { .5f, .4f, .3f }, .roughness = 1, .cls = NOC_CLASS_WALL },
                         [BODY] = { .albedo = { .1f, .2f, .3f }, .roughness = .4f, .cls = NOC_CLASS_VEHICLE },
                         [GLOW] = { .emission = { 2, 0, 0 }, .roughness = 1, .two_sided = true } };
    if (with == MATERIAL)
        m[WALL].albedo[1] = .9f, m[WALL].roughness = .5f;
    if (with == CLASS_MATERIAL)
        m[WALL].albedo[0] = .7f, m[WALL].albedo[1] = .6f, m[WALL].albedo[2] = .5f, m[WALL].f0 = .04f;
    if (with == SHINES)
        m[WALL].emission[2] = 11;
    if (with == GOES_OUT)
        memset(m[SIGN].emission, 0, sizeof(m[SIGN].emission));
    if (with == RECOLOURED)
        m[SIGN].emission[1] = 50;
    m[SIGN].two_sided = with == TWO_SIDED;
    for (size_t i = 0; i < NOC_COUNT(m); i++)
        assert_int_equal(noc_scene_add_material(s, &m[i]), i);
}

/* A car: its body, a glowing strip of two triangles, a lamp and a point of light. */
static inline void car(noc_scene *s) {
    noc_light lamp = lamp_at(0), point = { .kind = NOC_LIGHT_POINT, .position = { 1, 1, 1 }, .emission = { 9, 9, 9 } };
    lamp.model = point.model = CAR;
    lamp.group = CARS;
    assert_int_equal(noc_scene_add_model(s, "car"), CAR);
    piece(s, BODY, CAR, 0, "body", 0, 2);
    piece(s, GLOW, CAR, 0, "strip", 2, .5);
    assert_int_equal(noc_scene_add_light(s, &lamp), 0);
    assert_int_equal(noc_scene_add_light(s, &point), 1);
}

static inline void instance(noc_scene *s, double yaw, double scale, double x) {
    noc_instance in = { .model = CAR };
    place(yaw, scale, x, in.transform);
    assert_true(noc_scene_add_instance(s, &in) >= 0);
}

/* The scene, with one thing other than usual. */
static inline noc_scene *made(noc_log *log, change with) {
    noc_scene *s = noc_scene_create(log);
    noc_light globe = { .kind = NOC_LIGHT_SPHERE,
                        .position = { 5, 5, 5 },
                        .radius = .3,
                        .emission = { 20, 20, 20 },
                        .group = STREET,
                        .name = "globe" };
    noc_light spot = spot_at(with == LIGHT_MOVED ? 7 : 0), lamp = lamp_at(0), more = lamp_at(10);
    for (int k = 0; k < 3; k++)
        globe.emission[k] *= with == SWITCHED_OFF ? 0 : with == DIMMED ? .25f : 1;
    if (with == EMISSION)
        lamp.emission[0] = 33;
    materials(s, with);
    assert_int_equal(noc_scene_add_group(s, "street"), STREET);
    assert_int_equal(noc_scene_add_group(s, "cars"), CARS);
    piece(s, DARK, 0, 0, "ground", -20, 40);
    piece(s, SIGN, 0, 0, "shop", 3, 2);
    if (with != TOWER_REMOVED)
        piece(s, WALL, 0, 0, "tower", 20, 60);
    if (with != MESH_REMOVED)
        piece(s, SIGN, 0, 0, "front", 6, 2);
    assert_int_equal(noc_scene_add_light(s, &globe), GLOBE);
    assert_int_equal(noc_scene_add_light(s, &spot), SPOT);
    if (with != LIGHT_REMOVED)
        assert_int_equal(noc_scene_add_light(s, &lamp), LAMP);
    car(s);
    if (with == MESH_ADDED)
        piece(s, SIGN, 0, 0, "kiosk", 90, 5);
    if (with == LIGHT_ADDED)
        assert_true(noc_scene_add_light(s, &more) >= 0);
    instance(s, with == INSTANCE_MOVED ? .5 : 0, with == INSTANCE_MOVED ? 2 : 1, with == INSTANCE_MOVED ? 70 : 0);
    if (with != INSTANCE_REMOVED)
        instance(s, 1, 1, 10);
    if (with == INSTANCE_ADDED)
        instance(s, 2, .5, -100);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    return s;
}

static inline noc_status or_memory(bool done) { return done ? NOC_OK : NOC_ERR_MEMORY; }

/* Stages what makes the usual scene that one. */
static inline noc_status edit(noc_scene *s, change to) {
    noc_material m = s->materials.data[WALL], sign = s->materials.data[SIGN];
    noc_light spot = spot_at(7), lamp = lamp_at(10);
    noc_instance in = { .model = CAR };
    double moved[12];
    switch (to) {
    case MATERIAL: m.albedo[1] = .9f, m.roughness = .5f; return noc_scene_set_material(s, WALL, &m);
    case CLASS_MATERIAL:
        m = (noc_material){ .albedo = { .7f, .6f, .5f }, .f0 = .04f, .roughness = 1, .emission = { 5, 5, 5 } };
        return noc_scene_set_class_material(s, NOC_CLASS_WALL, &m); /* its emission is not read */
    case SHINES: m.emission[2] = 11; return noc_scene_set_material(s, WALL, &m);
    case GOES_OUT: memset(sign.emission, 0, sizeof(sign.emission)); return noc_scene_set_material(s, SIGN, &sign);
    case RECOLOURED: sign.emission[1] = 50; return noc_scene_set_material(s, SIGN, &sign);
    case TWO_SIDED: sign.two_sided = true; return noc_scene_set_material(s, SIGN, &sign);
    case EMISSION: return noc_scene_set_emission(s, LAMP, (float[3]){ 33, 80, 40 });
    case DIMMED: return noc_scene_set_group(s, STREET, (float[3]){ .25f, .25f, .25f });
    case SWITCHED_OFF: return noc_scene_set_group(s, STREET, (float[3]){ 0, 0, 0 });
    case LIGHT_MOVED: return noc_scene_move_light(s, SPOT, &spot);
    case LIGHT_ADDED: return or_memory(noc_scene_add_light(s, &lamp) >= 0);
    case LIGHT_REMOVED: return noc_scene_remove_light(s, LAMP);
    case MESH_ADDED: {
        noc_mesh mesh = { .vertex_count = 4,
                          .positions = (double[]){ 90, 0, 0, 95, 0, 0, 90, 5, 0, 90, 0, 5 },
                          .triangle_count = 2,
                          .indices = (uint32_t[]){ 0, 1, 2, 0, 1, 3 },
                          .material = SIGN,
                          .name = "kiosk" };
        return or_memory(noc_scene_add_mesh(s, &mesh) >= 0);
    }
    case MESH_REMOVED: return noc_scene_remove_mesh(s, FRONT);
    case TOWER_REMOVED: return noc_scene_remove_mesh(s, TOWER);
    case INSTANCE_ADDED: place(2, .5, -100, in.transform); return or_memory(noc_scene_add_instance(s, &in) >= 0);
    case INSTANCE_MOVED: place(.5, 2, 70, moved); return noc_scene_set_transform(s, 0, moved);
    case INSTANCE_REMOVED: return noc_scene_remove_instance(s, 1);
    case INSTANCE_DARK: return noc_scene_set_group(s, CARS, (float[3]){ 0, 0, 0 });
    default: return NOC_OK;
    }
}

typedef struct state {
    char key[NOC_CONTENT_KEY];
    noc_scene_info info;
} state;

static inline state state_of(const noc_scene *s) {
    state is;
    noc_scene_content(s, is.key);
    noc_scene_get_info(s, &is.info);
    return is;
}

static inline void assert_alike(const noc_scene *have, const noc_scene *want) {
    state a = state_of(have), b = state_of(want);
    assert_string_equal(a.key, b.key);
    assert_int_equal(a.info.triangles, b.info.triangles);
    assert_int_equal(a.info.vertices, b.info.vertices);
    assert_int_equal(a.info.meshes, b.info.meshes);
    assert_int_equal(a.info.instances, b.info.instances);
    assert_int_equal(a.info.lights, b.info.lights);
    assert_memory_equal(a.info.lights_by_kind, b.info.lights_by_kind, sizeof(a.info.lights_by_kind));
    assert_memory_equal(a.info.triangles_by_class, b.info.triangles_by_class, sizeof(a.info.triangles_by_class));
    for (int k = 0; k < 3; k++) {
        assert_float_equal(a.info.bounds_min[k], b.info.bounds_min[k], 1e-4);
        assert_float_equal(a.info.bounds_max[k], b.info.bounds_max[k], 1e-4);
    }
    assert_int_equal(noc_scene_city_triangles(have), noc_scene_city_triangles(want));
    for (size_t i = 0; i < noc_scene_city_triangles(have); i++) {
        size_t t[2] = { noc_scene_city_triangle(have, i), noc_scene_city_triangle(want, i) };
        for (int k = 0; k < 9; k++) /* the same triangles, in the same order */
            assert_true(have->positions.data[3 * (size_t)have->indices.data[3 * t[0] + k / 3] + k % 3] ==
                        want->positions.data[3 * (size_t)want->indices.data[3 * t[1] + k / 3] + k % 3]);
    }
    for (double x = -15; x < 30; x += 2.5) { /* vertical rays know what is there now */
        double z[2] = { 0, 0 };
        assert_int_equal(noc_scene_top(have, x, .1, &z[0]), noc_scene_top(want, x, .1, &z[1]));
        assert_true(z[0] == z[1]);
    }
}

#endif
