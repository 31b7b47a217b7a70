/* What the tests of rankings share: questions, and answers by the reference method. */
#ifndef NOC_TEST_ASKING_H
#define NOC_TEST_ASKING_H

#include "rooms.h"

#include <nocturne/influence.h>

enum { MOST_ROWS = 64 };

typedef struct answer {
    noc_influence_row rows[MOST_ROWS];
    size_t count;
    noc_influence_sum sum;
} answer;

static inline noc_patch point_at(double x, double y, double z) {
    return (noc_patch){ .p = { (float)x, (float)y, (float)z }, .n = { 0, 0, 1 }, .weight = 1, .material = 0 };
}

static inline noc_region *region_of(const noc_patch *patches, size_t count) {
    noc_region *region = noc_region_create(NULL);
    assert_int_equal(noc_region_add(region, patches, count), NOC_OK);
    return region;
}

static inline noc_render_params no_sky(uint32_t seed) {
    noc_render_params p = noc_render_default_params();
    p.sky = 0;
    p.seed = seed;
    return p;
}

static inline answer ask(noc_view *view, const noc_region *region, const noc_render_params *p, uint64_t rays) {
    answer a = { .count = 0 };
    noc_ranking_params params = { .render = p, .count_windows = true };
    noc_ranking *r = noc_ranking_create(view, region, &params);
    assert_non_null(r);
    noc_ranking_target target = { .rays = (uint64_t)samples((int)rays) };
    assert_int_equal(noc_ranking_refine(r, &target, NULL), NOC_OK);
    assert_int_equal(noc_ranking_get(r, a.rows, MOST_ROWS, &a.count, &a.sum), NOC_OK);
    noc_ranking_destroy(r);
    return a;
}

static inline answer ask_point(const noc_scene *s, noc_patch y, uint32_t seed, uint64_t rays) {
    noc_view *view = own_view(s, 2, NULL);
    noc_region *region = region_of(&y, 1);
    noc_render_params p = no_sky(seed);
    answer a = ask(view, region, &p, rays);
    noc_region_destroy(region);
    close_view(view);
    return a;
}

static inline const noc_influence_row *row_of(const answer *a, size_t light) {
    for (size_t i = 0; i < a->count; i++)
        if (a->rows[i].emitter.light == light)
            return &a->rows[i];
    return NULL;
}

/* ---- a crowd: lights of all kinds among walls ---- */

static inline noc_scene *crowd(int lights) {
    noc_scene *s = noc_scene_create(NULL);
    add_floor(s, matte(s, 0.5f), 0, 0, 0, 30);
    QUAD(s, 0, -10, 2, 0, 6, 0, 0, 0, 0, 4);
    QUAD(s, 0, 1, 1, 0, 0, 5, 0, 0, 0, 3);
    for (int i = 0; i < lights; i++) {
        noc_light l = crowd_light(i % 60, 4.8 - 0.9 * (i / 60));
        l.position[0] += 0.17 * (i / 60);
        assert_true(noc_scene_add_light(s, &l) >= 0);
    }
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    return s;
}

enum { SIDE = 16 };

static inline noc_camera from_above(void) {
    noc_camera c = look(0, 0, 60, 0, 0, 0, 12);
    c.up[1] = 1, c.up[2] = 0;
    return c;
}

/* The places that the pixels of a picture from above see, where that is the floor. */
static inline noc_region *pixels(noc_view *view, const noc_camera *c, bool wrong, bool sees[SIDE * SIDE]) {
    noc_patch patches[SIDE * SIDE];
    size_t count = 0;
    for (int i = 0; i < SIDE * SIDE; i++) {
        noc_ray ray;
        noc_hit hit;
        assert_int_equal(noc_camera_ray(c, SIDE, SIDE, (double[2]){ i % SIDE + 0.5, i / SIDE + 0.5 }, &ray), NOC_OK);
        assert_int_equal(noc_view_cast(view, &ray, 1, &hit), NOC_OK);
        sees[i] = hit.hit && hit.material == 0 && hit.place[2] < 1e-3;
        patches[count] = point_at(hit.place[0], hit.place[1], 0);
        patches[count].weight = wrong ? 1 + 0.1f * (float)(i % SIDE) : 1;
        count += sees[i];
    }
    assert_true(count > SIDE * SIDE / 2);
    return region_of(patches, count);
}

/* Mean illuminance of those pixels, by the reference method, of light `only` and what else lights by `given`. */
enum { ALL_LIGHTS = -1, NO_LIGHTS = -2 };
static inline double by_reference(noc_scene *s, noc_view *view, const noc_camera *c, const noc_render_params *given,
                                  const bool sees[SIDE * SIDE], int only, int frames) {
    noc_scene_info info;
    noc_scene_get_info(s, &info);
    float(*made)[3] = calloc(info.light_slots, sizeof(*made));
    for (size_t i = 0; i < info.light_slots; i++) {
        noc_light_info l;
        assert_int_equal(noc_scene_get_light(s, i, &l), NOC_OK);
        memcpy(made[i], l.light.emission, sizeof(made[i]));
        if (only != ALL_LIGHTS && (int)i != only)
            assert_int_equal(noc_scene_set_emission(s, (int)i, (float[3]){ 0 }), NOC_OK);
    }
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_render_params p = *given;
    p.rays = 1024;
    p.emitters = false;
    noc_view_reset(view);
    for (int i = 0; i < samples(frames); i++)
        assert_int_equal(noc_view_render(view, c, &p, NULL), NOC_OK);
    noc_image *image = noc_view_image(view);
    double sum = 0;
    int count = 0;
    for (int i = 0; i < SIDE * SIDE; i++) {
        sum += sees[i] ? luma(image->rgb + 3 * i) * M_PI / 0.5 : 0;
        count += sees[i];
    }
    noc_image_destroy(image);
    for (size_t i = 0; i < info.light_slots; i++)
        assert_int_equal(noc_scene_set_emission(s, (int)i, made[i]), NOC_OK);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    free(made);
    return sum / count;
}

/* As many standard errors as the estimate is off the truth, which is known to one in a thousand; of few samples it is
 * not judged. */
static inline double off(noc_estimate e, double truth) {
    return SANITIZED ? 0 : fabs(e.value - truth) / hypot(e.error, 1e-3 * truth);
}

#endif
