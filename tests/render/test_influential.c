/* The lights that bring a pixel the most, and their shares, held to the lights. */
#include "views.h"

enum { FOUR = 15u << NOC_AOV_INFLUENTIAL, MOST = 40 };

/* Height 1 m, a row along x, of 1, 2, ... cd. */
static double lamp_x(int k, int lamps) { return -8 + 16.0 * k / (lamps - 1); }

static noc_scene *row(int lamps) {
    noc_scene *s = noc_scene_create(NULL);
    add_floor(s, matte(s, 0.5f), 0, 0, 0, 20);
    for (int k = 0; k < lamps; k++)
        point_light(s, lamp_x(k, lamps), 0, 1, 1 + (float)k);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    return s;
}

static double lux(const double p[3], int k, int lamps) {
    double dx = lamp_x(k, lamps) - p[0], d2 = dx * dx + p[1] * p[1] + 1;
    return (1 + k) / (d2 * sqrt(d2));
}

/* The two largest, and the sum. */
static double rank(const double *of, int count, int best[2]) {
    double all = 0;
    best[0] = best[1] = -1;
    for (int k = 0; k < count; k++) {
        all += of[k];
        if (best[0] < 0 || of[k] > of[best[0]]) {
            best[1] = best[0];
            best[0] = k;
        } else if (best[1] < 0 || of[k] > of[best[1]]) {
            best[1] = k;
        }
    }
    return all;
}

typedef struct four {
    noc_channel *v[4];
} four;
static four look_at(noc_view *r) {
    four f;
    for (int i = 0; i < 4; i++)
        f.v[i] = view(r, (noc_aov)(NOC_AOV_INFLUENTIAL + i));
    assert_true(f.v[0]->scale == NOC_CHANNEL_LABELS && f.v[1]->scale == NOC_CHANNEL_LINEAR);
    return f;
}
static void drop(four *f) {
    for (int i = 0; i < 4; i++)
        noc_channel_destroy(f->v[i]);
}

static noc_camera above(void) { return look(0.3, -14, 9, 0, 0, 0, 60); }

/* With as many places as lights, the reference tells all to rounding, in one frame and in several. With more lights a
 * share is not too small, at most a sixteenth too large, and who leads by more than that is known. */
static void by_the_law(void **state) {
    (void)state;
    noc_camera c = above();
    for (int lamps = 5; lamps <= MOST; lamps += 35) {
        noc_scene *s = row(lamps);
        noc_render_params p = with(NOC_METHOD_REFERENCE, NOC_CANDIDATES_LISTS, FOUR);
        bool room = lamps <= NOC_AOV_EMITTERS;
        double slack = room ? 0 : 1.0 / NOC_AOV_EMITTERS;
        noc_view *r = rendered(s, &c, &p, 3, 2);
        four f = look_at(r);
        int sure = 0;
        for (int i = 0; i < N; i++) {
            double q[3], by[MOST];
            int best[2];
            assert_int_equal(f.v[0]->value[i] < 0, f.v[1]->value[i] < 0);
            if (f.v[0]->value[i] < 0)
                continue;
            floor_point(&c, &p, i % W, i / W, 0, q);
            for (int k = 0; k < lamps; k++)
                by[k] = lux(q, k, lamps);
            double all = rank(by, lamps, best);
            for (int k = 0; k < 4; k += 2) {
                double share = by[(int)f.v[k]->value[i]] / all, told = f.v[k + 1]->value[i];
                assert_true(told > share - 1e-4 && told < share + slack + 1e-4);
            }
            double lead = (by[best[0]] - by[best[1]]) / all;
            if (lead < slack + 1e-4)
                continue;
            assert_int_equal((int)f.v[0]->value[i], best[0]);
            if (room && by[best[1]] > 0)
                assert_true(fabs(f.v[3]->value[i] - by[best[1]] / all) < 1e-4);
            sure++;
        }
        assert_true(sure > (room ? N / 10 : 10));
        drop(&f);
        close_view(r);
        noc_scene_destroy(s);
    }
}

/* Other methods find the same where one clearly leads; shares come near. */
static void by_samples(void **state) {
    (void)state;
    enum { LAMPS = 5 };
    static const struct {
        noc_method method;
        noc_candidates candidates;
        int frames;
        double near;
    } cases[] = { { NOC_METHOD_RIS, NOC_CANDIDATES_LISTS, 64, 0.05 },
                  { NOC_METHOD_RIS, NOC_CANDIDATES_POWER, 400, 0.12 },
                  { NOC_METHOD_RESTIR, NOC_CANDIDATES_LISTS, 1000, 0.12 } };
    noc_camera c = above();
    noc_scene *s = row(LAMPS);
    for (size_t k = 0; k < NOC_COUNT(cases); k++) {
        noc_render_params p = with(cases[k].method, cases[k].candidates, FOUR);
        noc_view *r = rendered(s, &c, &p, cases[k].frames, 2);
        four f = look_at(r);
        int sure = 0, far = 0, wrong = 0;
        for (int i = 0; i < N; i++) {
            double q[3], by[LAMPS];
            int best[2];
            if (f.v[0]->value[i] < 0)
                continue;
            floor_point(&c, &p, i % W, i / W, 0, q);
            for (int n = 0; n < LAMPS; n++)
                by[n] = lux(q, n, LAMPS);
            double all = rank(by, LAMPS, best);
            if (by[best[0]] < 2 * by[best[1]])
                continue;
            sure++;
            wrong += (int)f.v[0]->value[i] != best[0];
            far += fabs(f.v[1]->value[i] - by[best[0]] / all) > cases[k].near;
        }
        print_message("# method %d, candidates %d: %d pixels, %d wrong, %d far off\n", cases[k].method,
                      cases[k].candidates, sure, wrong, far);
        assert_true(sure > N / 10 && wrong * 50 <= sure && far * 20 <= sure);
        drop(&f);
        close_view(r);
    }
    noc_scene_destroy(s);
}

/* The sky has its part of the whole: of one light, share = 1 - sky's part. */
static void the_sky_counts(void **state) {
    (void)state;
    noc_camera c = above();
    noc_scene *s = noc_scene_create(NULL);
    add_floor(s, matte(s, 0.5f), 0, 0, 0, 20);
    point_light(s, 0, 0, 2, 3);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_render_params p = with(NOC_METHOD_RIS, NOC_CANDIDATES_LISTS, FOUR | 1u << NOC_AOV_ILLUMINANCE);
    p.sky = 0.1;
    noc_view *r = rendered(s, &c, &p, 300, 2);
    four f = look_at(r);
    for (int i = N / 2; i < N; i++) {
        double q[3];
        floor_point(&c, &p, i % W, i / W, 0, q);
        double d2 = q[0] * q[0] + q[1] * q[1] + 4, lamp = 3 * 2 / (d2 * sqrt(d2));
        assert_int_equal((int)f.v[0]->value[i], 0);
        assert_true(fabs(f.v[1]->value[i] - lamp / (lamp + 1.2 * M_PI * 0.1)) < 0.01);
        assert_true(f.v[2]->value[i] == -1 && f.v[3]->value[i] == 0);
    }
    drop(&f);
    close_view(r);
    noc_scene_destroy(s);
}

/* What people call one lamp is one: lights of one id, triangles of a mesh that shines. An emitter that is seen is its
 * own. */
static void lamps_of_several_lights(void **state) {
    (void)state;
    noc_scene *s = noc_scene_create(NULL);
    add_floor(s, matte(s, 0.5f), 0, 0, 0, 20);
    int shining =
        noc_scene_add_material(s, &(noc_material){
                                      .albedo = { 0.5f, 0.5f, 0.5f }, .roughness = 1, .emission = { 9, 9, 9 } });
    QUAD(s, shining, -3, 6, 0.5, 6, 0, 0, 0, 0, 3); /* two triangles, facing the camera */
    for (int i = 0; i < 4; i++) {
        noc_light l = { .kind = NOC_LIGHT_POINT,
                        .position = { (i < 2 ? -8 : 8) + 0.3 * i, -4, 2 },
                        .emission = { 30, 30, 30 },
                        .name = i < 2 ? "left" : "right" };
        assert_true(noc_scene_add_light(s, &l) >= 0);
    }
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_camera c = look(0, -14, 7, 0, 0, 0.5, 70);
    noc_render_params p = with(NOC_METHOD_REFERENCE, NOC_CANDIDATES_LISTS, FOUR | 1u << NOC_AOV_CLASS);
    noc_view *r = rendered(s, &c, &p, 2, 2);
    four f = look_at(r);
    int seen[8] = { 0 }, different = 0, own = 0;
    for (int i = 0; i < N; i++) {
        if (f.v[0]->value[i] < 0)
            continue;
        seen[(int)f.v[0]->value[i]]++;
        own += (int)f.v[0]->value[i] >= 4 && f.v[1]->value[i] > 0.99f;
    }
    for (int i = 0; i < 8; i++)
        different += seen[i] > 0;
    assert_int_equal(different, 3);
    assert_true(seen[0] > 20 && seen[2] > 20 && seen[4] + seen[5] > 10 && own > 10);
    drop(&f);
    close_view(r);
    noc_scene_destroy(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(by_the_law),
        cmocka_unit_test(by_samples),
        cmocka_unit_test(the_sky_counts),
        cmocka_unit_test(lamps_of_several_lights),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
