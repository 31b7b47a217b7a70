/* Textures in a scene: pyramids against means of areas, what is refused, edits, and the scene's name. */
#include "../memory.h"
#include "scene/scene.h"

#include <math.h>

static unsigned char image[3 * 64 * 64];

static noc_texture texture(int width, int height) {
    for (size_t i = 0; i < sizeof(image); i++)
        image[i] = (unsigned char)(i * 2654435761u >> 7);
    return (noc_texture){ .width = width, .height = height, .rgb = image };
}

static double albedo(int code, bool linear) { /* IEC 61966-2-1, within the range of textures */
    double x = code / 255.0, a = linear ? x : x > 0.04045 ? pow((x + 0.055) / 1.055, 2.4) : x / 12.92;
    return fmin(fmax(a, 0.02), 0.9);
}

static double red_of(const uint32_t *texel) {
    double root = (*texel & 1023) / 1023.0;
    return root * root;
}

/* The mean of an image's red over a part of it, by a fine grid. */
static double mean(const noc_texture *t, double x0, double x1, double y0, double y1) {
    enum { FINE = 60 };
    double sum = 0;
    for (int y = 0; y < FINE; y++)
        for (int x = 0; x < FINE; x++) {
            int column = (int)(x0 + (x1 - x0) * (x + 0.5) / FINE), row = (int)(y0 + (y1 - y0) * (y + 0.5) / FINE);
            sum += albedo(t->rgb[3 * (row * t->width + column)], t->linear);
        }
    return sum / (FINE * FINE);
}

static void test_pyramid(void **state) {
    (void)state;
    const int sides[][2] = { { 8, 8 }, { 5, 3 }, { 1, 7 }, { 1, 1 }, { 13, 6 } };
    for (size_t s = 0; s < NOC_COUNT(sides); s++)
        for (int linear = 0; linear < 2; linear++) {
            noc_scene *scene = noc_scene_create(NULL);
            noc_texture t = texture(sides[s][0], sides[s][1]);
            t.linear = linear;
            assert_int_equal(noc_scene_add_texture(scene, &t), 1);
            const uint32_t *head = scene->texels.data;
            uint32_t levels = head[0] & 255, w = (uint32_t)t.width, h = (uint32_t)t.height;
            for (uint32_t l = 0; l<levels; l++, w = w> 1 ? w / 2 : 1, h = h > 1 ? h / 2 : 1) {
                assert_int_equal(head[2 + 2 * l], w | h << 16);
                const uint32_t *texel = scene->texels.data + head[1 + 2 * l];
                for (uint32_t i = 0; i < w * h; i++) {
                    double x = i % w, y = i / w, sx = (double)t.width / w, sy = (double)t.height / h;
                    /* each level is made of the one before, so areas of odd sides are not quite those of the whole */
                    double off = l > 1 ? 0.09 : l ? 0.02 : 2e-3;
                    assert_true(fabs(red_of(texel + i) - mean(&t, x * sx, (x + 1) * sx, y * sy, (y + 1) * sy)) < off);
                }
            }
            assert_true(w == 1 && h == 1);
            noc_scene_info info;
            noc_scene_get_info(scene, &info);
            assert_int_equal(info.textures, 1);
            assert_int_equal(info.texture_bytes, 4 * noc_texture_words(t.width, t.height));
            noc_scene_destroy(scene);
        }
}

/* What is left when the finest levels are left out is the rest of the same pyramid. */
static void test_leave_out(void **state) {
    (void)state;
    for (int out = 0; out < 9; out++) {
        noc_scene *scene = noc_scene_create(NULL);
        noc_texture t = texture(37, 50);
        assert_int_equal(noc_scene_add_texture(scene, &t), 1);
        t.leave_out = out;
        assert_int_equal(noc_scene_add_texture(scene, &t), 2);
        const uint32_t *whole = scene->texels.data, *part = whole + scene->textures.data[1].place;
        uint32_t levels = whole[0] & 255, left = part[0] & 255;
        assert_int_equal(left, out < (int)levels ? levels - (uint32_t)out : 1);
        for (uint32_t l = 0; l < left; l++) {
            uint32_t of = levels - left + l, size = part[2 + 2 * l];
            assert_int_equal(size, whole[2 + 2 * of]);
            assert_memory_equal(scene->texels.data + part[1 + 2 * l], scene->texels.data + whole[1 + 2 * of],
                                (size_t)(size & 0xffff) * (size >> 16) * sizeof(uint32_t));
        }
        noc_scene_destroy(scene);
    }
}

static int triangle(noc_scene *scene, int material, const float *uv) {
    return noc_scene_add_mesh(scene, &(noc_mesh){ .vertex_count = 3,
                                                  .positions = (double[]){ 0, 0, 0, 4, 0, 0, 0, 4, 0 },
                                                  .triangle_count = 1,
                                                  .indices = (uint32_t[]){ 0, 1, 2 },
                                                  .material = material,
                                                  .uv = uv });
}

static int textured(noc_scene *scene, int texture_index) {
    noc_material m = noc_class_material(NOC_CLASS_WALL);
    m.texture = texture_index;
    return noc_scene_add_material(scene, &m);
}

static const float corner_uv[6] = { 0, 0, 1, 0, 0, 1 };

static void test_edits(void **state) {
    (void)state;
    noc_scene *scene = noc_scene_create(NULL);
    noc_texture t = texture(4, 4);
    const float odd[6] = { NAN, 1e9f, 3, -INFINITY, 0.5f, -7 };
    int first = noc_scene_add_texture(scene, &t), plain = textured(scene, 0), wall = textured(scene, first);
    assert_true(first == 1 && triangle(scene, plain, NULL) == 0 && triangle(scene, wall, odd) == 1);
    assert_int_equal(noc_scene_commit(scene), NOC_OK);
    assert_int_equal(scene->meshes.data[0].uv, 0);
    assert_int_equal(scene->meshes.data[1].uv, 1);
    const float kept[6] = { 0, 0, 3, 0, 0.5f, -7 };
    assert_memory_equal(scene->uv.data, kept, sizeof(kept));
    /* later ones lie behind */
    int second = noc_scene_add_texture(scene, &t), other = textured(scene, second);
    assert_true(second == 2 && triangle(scene, other, corner_uv) == 2 && triangle(scene, plain, NULL) == 3);
    assert_int_equal(noc_scene_commit(scene), NOC_OK);
    assert_int_equal(scene->meshes.data[2].uv, 4);
    assert_int_equal(scene->meshes.data[3].uv, 0);
    assert_memory_equal(scene->uv.data + 6, corner_uv, sizeof(corner_uv));
    /* a material of a class takes the texture away, and may bring another */
    uint64_t before = scene->versions.materials;
    noc_material of = noc_class_material(NOC_CLASS_WALL);
    assert_int_equal(noc_scene_set_class_material(scene, NOC_CLASS_WALL, &of), NOC_OK);
    assert_int_equal(noc_scene_commit(scene), NOC_OK);
    assert_true(scene->materials.data[wall].texture == 0 && scene->versions.materials > before);
    of.texture = second;
    assert_int_equal(noc_scene_set_material(scene, plain, &of), NOC_OK);
    assert_int_equal(noc_scene_commit(scene), NOC_OK);
    assert_int_equal(scene->materials.data[plain].texture, second);
    noc_scene_destroy(scene);
}

static void test_refused(void **state) {
    (void)state;
    noc_scene *scene = noc_scene_create(NULL);
    noc_texture t = texture(4, 4);
    const noc_texture bad[] = { { .width = 0, .height = 4, .rgb = image },
                                { .width = 4, .height = NOC_TEXTURE_SIDE + 1, .rgb = image },
                                { .width = 4, .height = 4, .rgb = image, .wrap = (noc_wrap)3 },
                                { .width = 4, .height = 4, .rgb = image, .leave_out = -1 },
                                { .width = 4, .height = 4 } };
    for (size_t i = 0; i < NOC_COUNT(bad); i++)
        assert_int_equal(noc_scene_add_texture(scene, &bad[i]), -1);
    assert_int_equal(textured(scene, 1), -1);
    assert_int_equal(textured(scene, -1), -1);
    assert_int_equal(noc_scene_add_texture(scene, &t), 1);
    assert_int_equal(textured(scene, 1), 0);
    noc_material m = noc_class_material(NOC_CLASS_WALL);
    m.texture = 2;
    assert_int_equal(noc_scene_set_material(scene, 0, &m), NOC_ERR_ARGUMENT);
    assert_int_equal(noc_scene_set_class_material(scene, NOC_CLASS_WALL, &m), NOC_ERR_ARGUMENT);
    noc_scene_destroy(scene);
}

/* A name of a scene with a triangle; change: 0 none, 1 a pixel, 2 a place, 3 the wrap, 4 no texture, 5 the order. */
static void name_of(int change, char key[NOC_CONTENT_KEY]) {
    noc_scene *scene = noc_scene_create(NULL);
    noc_texture t = texture(8, 4);
    float uv[6];
    memcpy(uv, corner_uv, sizeof(uv));
    if (change == 5) {
        noc_texture before = texture(2, 2);
        noc_scene_add_texture(scene, &before);
        t = texture(8, 4);
    }
    image[7] ^= change == 1 ? 64 : 0;
    uv[2] += change == 2 ? 0.25f : 0;
    t.wrap = change == 3 ? NOC_WRAP_CLAMP : NOC_WRAP_REPEAT;
    int index = noc_scene_add_texture(scene, &t);
    triangle(scene, textured(scene, change == 4 ? 0 : index), uv);
    assert_int_equal(noc_scene_commit(scene), NOC_OK);
    noc_scene_content(scene, key);
    noc_scene_destroy(scene);
}

static void test_content(void **state) {
    (void)state;
    char whole[NOC_CONTENT_KEY], key[NOC_CONTENT_KEY];
    name_of(0, whole);
    for (int change = 0; change < 6; change++) {
        name_of(change, key);
        if (change == 0 || change == 5)
            assert_string_equal(key, whole);
        else
            assert_string_not_equal(key, whole);
    }
}

/* Before the first commit, and after it. */
static noc_status fill(noc_scene *scene) {
    noc_texture t = texture(16, 8);
    noc_status status = NOC_OK;
    t.leave_out = 1;
    for (int i = 0; i < 3 && !status; i++) {
        int index = noc_scene_add_texture(scene, &t), material = index < 0 ? -1 : textured(scene, index);
        if (material < 0 || triangle(scene, material, corner_uv) < 0)
            return NOC_ERR_MEMORY;
        status = noc_scene_commit(scene);
    }
    return status;
}

static void test_memory(void **state) {
    (void)state;
    noc_log *log = counting_log();
    bool reached;
    FOR_EACH_REFUSAL(reached) {
        begin_refusal(n, later);
        noc_scene *scene = noc_scene_create(log);
        noc_status status = scene ? fill(scene) : NOC_ERR_MEMORY;
        reached = end_refusal();
        if (status == NOC_OK)
            assert_true(scene->textures.len == 3 && scene->meshes.len == 3 && !reached);
        else
            assert_refused(status, "textures");
        noc_scene_destroy(scene);
    }
    noc_log_destroy(log);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pyramid), cmocka_unit_test(test_leave_out), cmocka_unit_test(test_edits),
        cmocka_unit_test(test_refused), cmocka_unit_test(test_content),   cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
