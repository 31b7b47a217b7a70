/* A small scene with something of all that a shader reads. */
#ifndef NOC_TEST_ALL_KINDS_H
#define NOC_TEST_ALL_KINDS_H

#include "../light/profiles.h"
#include "../render/rooms.h"

#include <nocturne/nocturne.h>

enum { SIDE = 48 };

static inline int chequers(noc_scene *scene) {
    static unsigned char rgb[3 * 32 * 32];
    for (size_t i = 0; i < sizeof(rgb); i++)
        rgb[i] = (unsigned char)((i * 37 + i / 96 * 11) % 200 + 30);
    return noc_scene_add_texture(scene, &(noc_texture){ 32, 32, rgb, .wrap = NOC_WRAP_MIRROR });
}

/* A square in the x-z plane of a model (0: the world), with places in an image or without: then it shows none. */
static inline void add_board(noc_scene *scene, int texture, int model, double size, bool placed) {
    noc_material m = { .albedo = { 0.9f, 0.8f, 0.7f }, .roughness = 0.4f, .f0 = 0.04f, .texture = texture };
    const double y = placed ? 0 : 1, xyz[] = { -size, y, 0, size, y, 0, size, y, 2 * size, -size, y, 2 * size };
    const float uv[] = { 0, 0, 3, 0, 3, 3, 0, 3 };
    noc_mesh mesh = { .vertex_count = 4,
                      .positions = xyz,
                      .triangle_count = 2,
                      .indices = (uint32_t[]){ 0, 1, 2, 0, 2, 3 },
                      .material = noc_scene_add_material(scene, &m),
                      .model = model,
                      .uv = placed ? uv : NULL };
    assert_true(noc_scene_add_mesh(scene, &mesh) >= 0);
}

static inline noc_image *bright_map(void) {
    noc_image *map = noc_image_create(32, 16, NULL);
    assert_non_null(map);
    for (int i = 0; i < 32 * 16 * 3; i++)
        map->rgb[i] = i % 96 < 12 ? 5.0f : 0.1f + 0.01f * (float)(i % 7);
    return map;
}

/* A pane of w x h metres in the x-z plane, or in the x-y plane, with `across` times the image; texture 0: none. */
static inline int add_pane(noc_scene *scene, float transmittance, int texture, int model, const double at[3], double w,
                           double h, bool flat) {
    noc_material m = { .albedo = { 0.3f, 0.5f, 0.4f },
                       .roughness = 0.5f,
                       .f0 = 0.04f,
                       .transmittance = transmittance,
                       .texture = texture,
                       .cutout = texture != 0 };
    const double x = at[0], y = at[1], z = at[2], dy = flat ? h : 0, dz = flat ? 0 : h;
    const double xyz[] = { x, y, z, x + w, y, z, x + w, y + dy, z + dz, x, y + dy, z + dz };
    const float uv[] = { -0.3f, 0, 2, 0, 2, 2.4f, -0.3f, 2.4f };
    noc_mesh mesh = { .vertex_count = 4,
                      .positions = xyz,
                      .triangle_count = 2,
                      .indices = (uint32_t[]){ 0, 1, 2, 0, 2, 3 },
                      .material = noc_scene_add_material(scene, &m),
                      .model = model,
                      .uv = texture && !flat ? uv : NULL };
    assert_true(noc_scene_add_mesh(scene, &mesh) >= 0);
    return mesh.material;
}

/* An image with holes in two of five of its texels. */
static inline int holed(noc_scene *scene, noc_wrap wrap) {
    unsigned char rgb[3 * 25], holes[25];
    for (int i = 0; i < 25; i++) {
        rgb[3 * i] = rgb[3 * i + 1] = rgb[3 * i + 2] = (unsigned char)(90 + 5 * i);
        holes[i] = i * 7 % 5 < 2;
    }
    return noc_scene_add_texture(scene, &(noc_texture){ 5, 5, rgb, .holes = holes, .wrap = wrap });
}

/* Panes before the eye and under the lights, some with holes, one with a texture but no place in it, one of a model. */
static inline void add_panes(noc_scene *s, int model) {
    add_pane(s, 0.6f, 0, 0, (double[]){ -4, -7, 0 }, 4, 4, false);
    add_pane(s, 0.5f, 0, 0, (double[]){ -6, -6, 2.5 }, 9, 9, true);
    add_pane(s, 0.2f, holed(s, NOC_WRAP_REPEAT), 0, (double[]){ 1, -6, 0 }, 2, 2, false);
    add_pane(s, 0, holed(s, NOC_WRAP_MIRROR), 0, (double[]){ -2, -3, 0 }, 4, 3, false);
    add_pane(s, 0.7f, holed(s, NOC_WRAP_CLAMP), 0, (double[]){ 2, -5, 3.5 }, 4, 4, true);
    add_pane(s, 0.5f, 0, model, (double[]){ -0.5, -0.3, 0 }, 1, 1.5, false);
}

/* Bodies that each show two lights of the crowd's kinds, of two models. */
static inline void add_bodies(noc_scene *s) {
    double xyz[] = { -0.1, 0, 0, 0.1, 0, 0, 0.1, 0, 2, -0.1, 0, 2, 0, -0.1, 0, 0, 0.1, 0, 0, 0.1, 2, 0, -0.1, 2 };
    int material = noc_scene_add_material(s, &(noc_material){ .albedo = { .4f, .4f, .4f }, .roughness = 1 }), model[2];
    noc_mesh post = { .vertex_count = 8,
                      .positions = xyz,
                      .triangle_count = 4,
                      .indices = (uint32_t[]){ 0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7 },
                      .material = material };
    noc_light heads[2] = {
        { .kind = NOC_LIGHT_DISC, .position = { 0.4, 0, 2 }, .direction = { 0, 0, -1 }, .radius = 0.2 },
        { .kind = NOC_LIGHT_SPHERE, .position = { -0.4, 0, 2 }, .radius = 0.15 },
    };
    for (int i = 0; i < 2; i++)
        assert_true((model[i] = noc_scene_add_body_model(s, i ? NULL : &post, heads, 2)) > 0);
    for (int i = 0; i < 6; i++) {
        float angle = 0.7f * (float)i, at[3] = { -3 + 1.2f * (float)i, -5.5f + 0.3f * (float)i, 0 };
        noc_scene_body body = {
            (uint32_t)model[i % 2], (uint32_t)s->lights.len, { at[0], at[1], at[2] }, { cosf(angle), sinf(angle) }
        };
        for (int k = 0; k < 2; k++) {
            noc_light l = heads[k];
            double x = l.position[0];
            l.position[0] = at[0] + body.facing[0] * x;
            l.position[1] = at[1] + body.facing[1] * x;
            for (int c = 0; c < 3; c++)
                l.emission[c] = (float)(100 + 20 * c + 50 * i);
            l.name = "post";
            assert_true(noc_scene_add_body_light(s, &l) >= 0);
        }
        assert_true(noc_scene_add_body(s, &body));
    }
}

/* A glossy floor, a board with an image, models that move and shine, lights of every kind, some with profiles; not
 * committed. */
static inline noc_scene *all_kinds_open(bool panes, int *car) {
    noc_scene *s = noc_scene_create(NULL);
    int texture = chequers(s), profiles = add_test_profiles(s);
    int wet = noc_scene_add_material(s, &(noc_material){ .albedo = { .2f, .2f, .25f }, .f0 = .05f, .roughness = .3f });
    add_floor(s, wet, 0, 0, 0, 12);
    add_board(s, texture, 0, 3, true);
    add_board(s, texture, 0, 4, false); /* behind: its upper edge is seen */
    int model = noc_scene_add_model(s, "car");
    int groups[2] = { noc_scene_add_group(s, "left"), noc_scene_add_group(s, "right") };
    add_board(s, texture, model, 0.5, true);
    if (panes)
        add_panes(s, model);
    noc_light head = { .kind = NOC_LIGHT_DISC,
                       .position = { 0, -0.1, 1.2 },
                       .direction = { 0, -1, -0.3 },
                       .radius = 0.1,
                       .emission = { 3000, 2500, 2000 },
                       .model = model };
    assert_true(noc_scene_add_light(s, &head) >= 0);
    for (int i = 0; i < 60; i++) {
        noc_light l = crowd_light(i, -2);
        l.group = i % 3 ? groups[i % 3 - 1] : 0;
        if (l.kind == NOC_LIGHT_SPHERE) {
            l.profile = profiles + i % TEST_PROFILES;
            l.direction[1] = 0;
            l.direction[2] = -1;
        }
        assert_true(noc_scene_add_light(s, &l) >= 0);
    }
    add_bodies(s);
    for (int i = 0; i < 3; i++) {
        noc_instance in = { model, { 1.5, 0, 0, -4 + 4 * i, 0, 1.5, 0, -4, 0, 0, 1.5, 0 } };
        int index = noc_scene_add_instance(s, &in);
        assert_true(index >= 0);
        *car = index;
    }
    return s;
}

static inline noc_scene *all_kinds_with(bool panes, int *car) {
    noc_scene *s = all_kinds_open(panes, car);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    return s;
}

static inline noc_scene *all_kinds(int *car) { return all_kinds_with(false, car); }

static inline noc_render_params all_kinds_params(noc_method method, bool map) {
    noc_render_params p = noc_render_default_params();
    p.width = p.height = SIDE;
    p.method = method;
    p.candidates = NOC_CANDIDATES_UNIFORM;
    p.environment_light = map;
    p.environment_rotation = 50;
    return p;
}

#endif
