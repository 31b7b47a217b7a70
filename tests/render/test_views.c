/* Views of the light sampling, held to what they mean. */
#include "views.h"
#include "../own_view.h"

static double place(int i, int k) { return fmod(0.5 + (i + 1) * (k ? 0.569840290998 : 0.754877666247), 1.0); }

/* A floor under point lights of 1, 2, ... cd. */
static noc_scene *lit_floor(int lights) {
    noc_scene *s = noc_scene_create(NULL);
    add_floor(s, matte(s, 0.5f), 0, 0, 0, 20);
    for (int i = 0; i < lights; i++)
        point_light(s, -9 + 18 * place(i, 0), -9 + 18 * place(i, 1), 1 + 0.1 * i, 1 + (float)i);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    return s;
}

static noc_camera above(void) { return look(0.3, -14, 9, 0, 0, 0, 60); }

/* Of two pixels' places on the floor, the largest distance within the pixel's tile of 16x16: such points may ask
 * together. */
static double tile_size(const noc_camera *c, const noc_render_params *p, int pixel) {
    double size = 0, q[2][3];
    int x = pixel % W & ~15, y = pixel / W & ~15;
    for (int i = 0; i < 2; i++) { /* diagonals */
        floor_point(c, p, x + 15 * i, y, 0, q[0]);
        floor_point(c, p, x + 15 * !i, y + 15, 0, q[1]);
        size = NOC_MAX(size, hypot(q[0][0] - q[1][0], q[0][1] - q[1][1]));
    }
    return size;
}

/* Influence volumes counted light by light: a point light's is a ball of radius S_r sqrt(I). One that holds the pixel
 * is found, and one that is further away than the pixels that ask with it is not. */
static void lights_found_by_the_volumes(void **state) {
    (void)state;
    enum { LIGHTS = 60 };
    noc_scene *s = lit_floor(LIGHTS);
    noc_camera c = above();
    noc_render_params p = with(NOC_METHOD_RIS, NOC_CANDIDATES_INFLUENCE, 1u << NOC_AOV_LIGHTS);
    p.influence = 1.2;
    noc_view *r = rendered(s, &c, &p, 2, 2);
    noc_channel *v = view(r, NOC_AOV_LIGHTS);
    int held = 0, most = 0, none = 0;
    for (int i = 0; i < N; i++) {
        double q[3];
        if (v->value[i] < 0) { /* beyond the floor */
            none++;
            continue;
        }
        floor_point(&c, &p, i % W, i / W, 0, q);
        int sure = 0, doubtful = 0;
        double size = tile_size(&c, &p, i);
        for (int l = 0; l < LIGHTS; l++) {
            double x = -9 + 18 * place(l, 0) - q[0], y = -9 + 18 * place(l, 1) - q[1], z = 1 + 0.1 * l - q[2];
            double beyond = sqrt(x * x + y * y + z * z) - 1.2 * sqrt(1 + l);
            sure += beyond < -1e-3;
            doubtful += beyond >= -1e-3 && beyond <= size + 1e-3;
        }
        assert_in_range((int)v->value[i], sure, sure + doubtful);
        held += sure > 0;
        most = NOC_MAX(most, sure);
    }
    assert_true(held > N / 4 && most > 5 && none > 0 && none < N / 2);
    noc_channel_destroy(v);
    close_view(r);
    noc_scene_destroy(s);
}

/* A list holds the few lights there are, and never more than its strongest and its tail. */
static void entries_of_lists(void **state) {
    (void)state;
    noc_camera c = above();
    noc_render_params p = with(NOC_METHOD_RIS, NOC_CANDIDATES_LISTS, 1u << NOC_AOV_LIGHTS);
    p.list = 6;
    p.tail = 5;
    for (int lights = 3; lights <= 60; lights += 57) {
        noc_scene *s = lit_floor(lights);
        noc_view *r = rendered(s, &c, &p, 1, 2);
        noc_channel *v = view(r, NOC_AOV_LIGHTS);
        for (int i = 0; i < N; i++)
            if (v->value[i] >= 0)
                assert_in_range((int)v->value[i], lights == 3 ? 3 : 6, lights == 3 ? 3 : 11);
        noc_channel_destroy(v);
        close_view(r);
        noc_scene_destroy(s);
    }
}

/* What a picker's definition in docs/estimator.md says of the light that was chosen; held: volumes that hold the pixel,
 * or the pixels within `apart` of it that ask with it. */
static double expected(noc_candidates candidates, const noc_camera *c, const noc_render_params *p, int pixel, int light,
                       int held, int lights, double apart) {
    double q[3], u = held ? ceil((double)p->draws / p->uniform_every) : p->draws;
    floor_point(c, p, pixel % W, pixel / W, 0, q);
    double x = -9 + 18 * place(light, 0) - q[0], y = -9 + 18 * place(light, 1) - q[1], z = 1 + 0.1 * light - q[2];
    bool in = sqrt(x * x + y * y + z * z) <= p->influence * sqrt(1 + light) + apart;
    switch (candidates) {
    case NOC_CANDIDATES_UNIFORM: return (double)p->draws / lights;
    case NOC_CANDIDATES_POWER: return p->draws * (1.0 + light) / (lights * (lights + 1) / 2.0);
    case NOC_CANDIDATES_INFLUENCE: return (in ? (p->draws - u) / held : 0) + u / lights;
    default: return p->draws; /* one light, whichever way */
    }
}

static void densities(void **state) {
    (void)state;
    static const struct {
        noc_candidates candidates;
        int lights;
    } cases[] = {
        { NOC_CANDIDATES_UNIFORM, 20 },
        { NOC_CANDIDATES_POWER, 20 },
        { NOC_CANDIDATES_INFLUENCE, 20 },
        { NOC_CANDIDATES_LIGHT_BVH, 1 },
    };
    noc_camera c = above();
    for (size_t k = 0; k < NOC_COUNT(cases); k++) {
        noc_candidates candidates = cases[k].candidates;
        bool volumes = candidates == NOC_CANDIDATES_INFLUENCE;
        noc_scene *s = lit_floor(cases[k].lights);
        noc_render_params p = with(NOC_METHOD_RIS, candidates,
                                   1u << NOC_AOV_DENSITY | 1u << NOC_AOV_LIGHT | (uint32_t)volumes << NOC_AOV_LIGHTS);
        p.influence = 1.37;
        noc_view *r = rendered(s, &c, &p, 1, 2);
        noc_channel *density = view(r, NOC_AOV_DENSITY), *light = view(r, NOC_AOV_LIGHT);
        noc_channel *held = volumes ? view(r, NOC_AOV_LIGHTS) : NULL;
        int checked = 0, doubtful = 0;
        for (int i = 0; i < N; i++) {
            assert_int_equal(density->value[i] >= 0, light->value[i] >= 0); /* nothing here is in shadow */
            if (light->value[i] < 0)
                continue;
            double right[2];
            for (int together = 0; together < 2; together++)
                right[together] = expected(candidates, &c, &p, i, (int)light->value[i], held ? (int)held->value[i] : 0,
                                           cases[k].lights, together ? tile_size(&c, &p, i) : 0);
            assert_true(fabs(density->value[i] - right[0]) <= 1e-4 * right[0] ||
                        fabs(density->value[i] - right[1]) <= 1e-4 * right[1]);
            doubtful += right[0] != right[1];
            checked++;
        }
        assert_true(checked > N / 2 && doubtful < checked / 2);
        noc_channel_destroy(density);
        noc_channel_destroy(light);
        noc_channel_destroy(held);
        close_view(r);
        noc_scene_destroy(s);
    }
}

/* A listed light is an entry once, for certain. Of a list with one entry, drawn from many lights, W is that entry's
 * weight. */
static void densities_of_lists(void **state) {
    (void)state;
    noc_camera c = above();
    for (int lights = 1; lights <= 40; lights += 39) {
        noc_scene *s = lit_floor(lights);
        noc_render_params p = with(NOC_METHOD_RIS, NOC_CANDIDATES_LISTS, 1u << NOC_AOV_DENSITY | 1u << NOC_AOV_WEIGHT);
        p.list = lights == 1;
        p.tail = 1;
        noc_view *r = rendered(s, &c, &p, 1, 1);
        noc_channel *density = view(r, NOC_AOV_DENSITY), *weight = view(r, NOC_AOV_WEIGHT);
        int checked = 0;
        for (int i = 0; i < N; i++) {
            if (density->value[i] < 0)
                continue;
            assert_true(lights == 1 ? density->value[i] == 1 : density->value[i] < 1);
            assert_true(fabsf(weight->value[i] * density->value[i] - 1) < 1e-4f);
            checked++;
        }
        assert_true(checked > N / 2);
        noc_channel_destroy(density);
        noc_channel_destroy(weight);
        close_view(r);
        noc_scene_destroy(s);
    }
}

/* A wall between two lights: each side's reservoirs hold its own light, or nothing. */
static void the_chosen_light(void **state) {
    (void)state;
    noc_scene *s = noc_scene_create(NULL);
    int wall = matte(s, 0.5f);
    add_floor(s, wall, 0, 0, 0, 20);
    QUAD(s, wall, 0, -20, 0, 0, 40, 0, 0, 0, 8);
    point_light(s, -2, 0, 1, 10);
    point_light(s, 2, 0, 1, 10);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_render_params p = with(NOC_METHOD_RIS, NOC_CANDIDATES_UNIFORM, 1u << NOC_AOV_LIGHT | 1u << NOC_AOV_WEIGHT);
    p.draws = 3;
    noc_camera top = look(0, 0, 25, 0, 0.001, 0, 40);
    noc_view *r = rendered(s, &top, &p, 1, 2);
    noc_channel *light = view(r, NOC_AOV_LIGHT), *weight = view(r, NOC_AOV_WEIGHT);
    int seen[2] = { 0, 0 }, nothing = 0;
    for (int i = 0; i < N; i++) {
        double q[3];
        floor_point(&top, &p, i % W, i / W, 0, q);
        if (fabs(q[0]) < 0.5) /* the wall's foot */
            continue;
        assert_int_equal(light->value[i] >= 0, weight->value[i] > 0);
        nothing += light->value[i] < 0;
        if (light->value[i] >= 0) {
            assert_int_equal((int)light->value[i], q[0] > 0);
            seen[q[0] > 0]++;
        }
    }
    assert_true(seen[0] > N / 10 && seen[1] > N / 10 && nothing > N / 10);
    noc_channel_destroy(light);
    noc_channel_destroy(weight);
    close_view(r);
    noc_scene_destroy(s);
}

/* W is an estimate of 1 / density: E[W; light k is chosen] = 1 for every light k that lights the pixel. */
static void weights(void **state) {
    (void)state;
    enum { LIGHTS = 4, FRAMES = 80 };
    noc_scene *s = lit_floor(LIGHTS);
    noc_camera c = above();
    static const noc_candidates from[] = { NOC_CANDIDATES_UNIFORM, NOC_CANDIDATES_POWER, NOC_CANDIDATES_LISTS };
    for (size_t k = 0; k < NOC_COUNT(from); k++) {
        noc_render_params p = with(NOC_METHOD_RIS, from[k], 1u << NOC_AOV_LIGHT | 1u << NOC_AOV_WEIGHT);
        p.draws = 2;
        p.list = 2;
        p.tail = 1;
        double sum[LIGHTS] = { 0 }, squares[LIGHTS] = { 0 };
        noc_view *r = own_view(s, 0, NULL);
        for (int frame = 0; frame < FRAMES; frame++) {
            assert_int_equal(noc_view_render(r, &c, &p, NULL), NOC_OK);
            noc_channel *light = view(r, NOC_AOV_LIGHT), *weight = view(r, NOC_AOV_WEIGHT);
            double of_frame[LIGHTS] = { 0 }, pixels = 0;
            for (int i = 0; i < N; i++) {
                pixels += weight->value[i] >= 0;
                if (light->value[i] >= 0)
                    of_frame[(int)light->value[i]] += weight->value[i];
            }
            /* the pixels of a list's tile share its tail: only frames are independent */
            for (int l = 0; l < LIGHTS; l++) {
                sum[l] += of_frame[l] / pixels;
                squares[l] += of_frame[l] / pixels * of_frame[l] / pixels;
            }
            noc_channel_destroy(light);
            noc_channel_destroy(weight);
        }
        for (int l = 0; l < LIGHTS; l++) {
            double mean = sum[l] / FRAMES, error = sqrt((squares[l] / FRAMES - mean * mean) / (FRAMES - 1));
            assert_true(error < 0.1 && fabs(mean - 1) < 4.5 * error + 1e-5);
        }
        close_view(r);
    }
    noc_scene_destroy(s);
}

/* M: the draws of one frame, one more frame's worth with every frame of history, up to the cap; one more with each
 * neighbour. */
static void confidence(void **state) {
    (void)state;
    noc_scene *s = lit_floor(10);
    noc_camera c = look(0, 0, 9, 0, 0.01, 0, 60); /* floor all over */
    noc_render_params p = with(NOC_METHOD_RESTIR, NOC_CANDIDATES_UNIFORM, 1u << NOC_AOV_CONFIDENCE);
    p.spatial = false;
    p.history = 3;
    noc_view *r = own_view(s, 0, NULL);
    for (int frame = 1; frame <= 6; frame++) {
        assert_int_equal(noc_view_render(r, &c, &p, NULL), NOC_OK);
        noc_channel *m = view(r, NOC_AOV_CONFIDENCE);
        for (int i = 0; i < N; i++)
            assert_true(m->value[i] == (float)(8 * NOC_MIN(frame, 1 + 3)));
        noc_channel_destroy(m);
    }
    close_view(r);
    p.spatial = true;
    p.temporal = false;
    p.neighbours = 4;
    r = rendered(s, &c, &p, 1, 2);
    noc_channel *m = view(r, NOC_AOV_CONFIDENCE);
    int all = 0;
    for (int i = 0; i < N; i++) {
        assert_true(m->value[i] >= 8 && m->value[i] <= 8 * 5 && fmodf(m->value[i], 8) == 0);
        all += m->value[i] == 8 * 5;
    }
    assert_true(all > N / 4 && all < N); /* not at the picture's edge */
    noc_channel_destroy(m);
    close_view(r);
    noc_scene_destroy(s);
}

/* Every ray belongs to a pixel. */
static void rays(void **state) {
    (void)state;
    noc_scene *s = street(30);
    noc_camera c = along();
    for (int i = 0; i < 6; i++) {
        noc_render_params p = with(i < 2   ? NOC_METHOD_REFERENCE
                                   : i < 4 ? NOC_METHOD_RIS
                                           : NOC_METHOD_RESTIR,
                                   i & 1 ? NOC_CANDIDATES_LISTS : NOC_CANDIDATES_UNIFORM, 1u << NOC_AOV_RAYS);
        p.sky = i & 1 ? 0.1 : 0;
        p.bias = i == 4 ? NOC_BIAS_MIS : NOC_BIAS_PAIRWISE;
        noc_view *r = rendered(s, &c, &p, 3, 2);
        noc_channel *v = view(r, NOC_AOV_RAYS);
        noc_frame_stats stats;
        noc_view_get_stats(r, &stats);
        double sum = 0;
        for (int k = 0; k < N; k++)
            sum += v->value[k];
        assert_true(stats.rays_shadow > 0 && sum == (double)stats.rays_shadow);
        noc_channel_destroy(v);
        close_view(r);
    }
    noc_scene_destroy(s);
}

/* Against the sample variance of the same frames, one by one; asked for in the second, and again from the fourth on. */
static void variance(void **state) {
    (void)state;
    enum { FRAMES = 14, FIRST = 3, USED = FRAMES - FIRST };
    noc_scene *s = street(30);
    noc_camera c = along();
    noc_render_params p = with(NOC_METHOD_RIS, NOC_CANDIDATES_UNIFORM, 0), alone = p;
    alone.accumulate = false;
    static double sum[N], squares[N];
    memset(sum, 0, sizeof(sum));
    memset(squares, 0, sizeof(squares));
    noc_view *r = own_view(s, 0, NULL), *single = own_view(s, 0, NULL);
    noc_image *mask = NULL;
    for (int frame = 0; frame < FRAMES; frame++) {
        p.aovs = frame == 1 || frame >= FIRST ? MOMENTS : 0;
        assert_int_equal(noc_view_render(r, &c, &p, NULL), NOC_OK);
        assert_int_equal(noc_view_render(single, &c, &alone, NULL), NOC_OK);
        noc_image *image = noc_view_image(single);
        for (int i = 0; i < N && frame >= FIRST; i++) {
            double y = luma(image->rgb + 3 * i);
            sum[i] += y;
            squares[i] += y * y;
        }
        noc_image_destroy(mask);
        mask = image;
        if (frame == FIRST) { /* of one frame there is no variance */
            noc_channel *v = view(r, NOC_AOV_VARIANCE);
            for (int i = 0; i < N; i++)
                assert_true(v->value[i] == -1);
            noc_channel_destroy(v);
        }
    }
    noc_frame_stats stats;
    noc_view_get_stats(r, &stats);
    assert_int_equal(stats.frames, FRAMES); /* asking for a view starts nothing anew */
    noc_channel *v = view(r, NOC_AOV_VARIANCE), *e = view(r, NOC_AOV_ERROR);
    int some = 0, emitters = 0;
    for (int i = 0; i < N; i++) {
        double mean = sum[i] / USED, right = (squares[i] - sum[i] * mean) / (USED - 1);
        if (v->value[i] < 0) {
            emitters += mask->emitter[i];
            assert_true(mask->emitter[i] || mean == 0); /* an emitter, or the sky, which is off */
            continue;
        }
        assert_true(fabs(v->value[i] - right) <= 1e-4 * right + 1e-6 * mean * mean);
        if (mean > 0)
            assert_true(fabs(e->value[i] - sqrt(right / USED) / mean) <=
                        1e-3 * e->value[i] + 1e-3 * (right < 1e-4 * mean * mean));
        else
            assert_true(e->value[i] == -1);
        some += right > 0;
    }
    assert_true(some > N / 2 && emitters > 0);
    noc_image_destroy(mask);
    noc_channel_destroy(v);
    noc_channel_destroy(e);
    close_view(r);
    close_view(single);
    noc_scene_destroy(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lights_found_by_the_volumes),
        cmocka_unit_test(entries_of_lists),
        cmocka_unit_test(densities),
        cmocka_unit_test(densities_of_lists),
        cmocka_unit_test(the_chosen_light),
        cmocka_unit_test(weights),
        cmocka_unit_test(confidence),
        cmocka_unit_test(rays),
        cmocka_unit_test(variance),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
