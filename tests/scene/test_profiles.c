/* Lights with profiles in a scene: lumens, frames, models, edits, and what is refused. */
#include "../core/core_test.h"
#include "../light/profiles.h"
#include "../memory.h"
#include "core/profile.h"
#include "scene/scene.h"

struct core_context {
    const float *cells;
};

FN profile_cell profile_load(CTX u32 place) {
    profile_cell c;
    memcpy(&c, ctx->cells + 4 * (size_t)place, sizeof(c));
    return c;
}

static noc_profile *cosine(void) { /* 0 to 90, uneven around */
    double c[] = { 0, 90, 180, 270 }, gamma[] = { 0, 30, 60, 90 }, cd[16];
    for (int i = 0; i < 16; i++)
        cd[i] = i % 4 == 3 ? 0 : 1 + i / 4;
    noc_profile *p = NULL;
    assert_int_equal(noc_profile_create(NULL, &(noc_profile_params){ "uneven", 4, 4, c, gamma, cd, 90 }, &p), NOC_OK);
    return p;
}

static noc_light lamp(noc_light_kind kind, int profile) {
    return (noc_light){ .kind = kind,
                        .position = { 1, 2, 3 },
                        .direction = { 0, 0, -2 },
                        .c0 = { 1, 0, 5 },
                        .radius = .2,
                        .profile = profile,
                        .emission = { 500, 500, 500 } };
}

static const noc_light_kind kinds[] = { NOC_LIGHT_POINT, NOC_LIGHT_SPHERE, NOC_LIGHT_DISC };

static void test_light(void **state) {
    noc_scene *s = noc_scene_create(NULL);
    noc_profile *p = cosine();
    int index = noc_scene_add_profile(s, p);
    assert_int_equal(index, 1);
    for (int i = 0; i < 3; i++) {
        noc_light l = lamp(kinds[i], index);
        assert_int_equal(noc_scene_add_light(s, &l), i);
    }
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_profile_info of;
    noc_profile_get_info(p, &of);
    for (size_t i = 0; i < 3; i++) {
        noc_light_info info;
        assert_int_equal(noc_scene_get_light(s, i, &info), NOC_OK);
        assert_true(fabs(info.lumens - 500) < 1e-3 && info.light.profile == 1 && !info.two_sided);
        assert_true(fabs(info.light.direction[2] + 1) < 1e-6 && fabs(info.light.c0[0] - 1) < 1e-6);
        assert_true(fabs(info.area - (i == 0 ? 0 : i == 1 ? 4 : 1) * M_PI * .04) < 1e-6);
        const noc_light_record *r = &s->lights.data[i];
        assert_true(fabs(r->area - of.peak / of.lumens) < 1e-4 * r->area);
        /* the frame: a x b is the axis */
        double z = (double)r->a[0] * r->b[1] - (double)r->a[1] * r->b[0];
        assert_true(z < 0 && fabs(r->a[2]) < 1e-6);
    }
    noc_profile_destroy(p);
    noc_scene_destroy(s);
}

/* Files of types A and B as lights look them up: their own intensities a lumen, linear in their own angles, in all
 * directions. The first two end within a half space, the others reach behind the luminaire. */
static void test_own_angles(void **state) {
    static const char *const head = "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 ";
    static const struct {
        int type, vertical, horizontal; /* how many angles */
        const char *angles;
    } files[] = { { 3, 5, 4, "-15 -5 0 5 20\n-10 -2.5 5 30\n" },
                  { 2, 5, 4, "-15 -5 0 5 20\n-10 -2.5 5 30\n" },
                  { 3, 3, 7, "-60 0 90\n-180 -120 -60 0 60 120 180\n" },
                  { 2, 5, 3, "-150 -20 10 100 170\n0 20 90\n" } };
    dice d = { 7 };
    for (size_t i = 0; i < NOC_COUNT(files); i++) {
        char text[2000];
        size_t n = (size_t)snprintf(text, sizeof(text), "%s%d %d %d 2 0 0 0 1 1 10\n%s", head, files[i].vertical,
                                    files[i].horizontal, files[i].type, files[i].angles);
        for (int k = 0; k < files[i].vertical * files[i].horizontal; k++)
            n += (size_t)snprintf(text + n, sizeof(text) - n, "%d ", 100 + 700 * (k % 3));
        noc_scene *s = noc_scene_create(NULL);
        noc_profile *p = NULL;
        noc_profile_info info;
        assert_int_equal(noc_profile_read(NULL, text, n, "own", &p), NOC_OK);
        noc_profile_get_info(p, &info);
        assert_int_equal(noc_scene_add_profile(s, p), 1);
        const struct core_context ctx = { s->profile_cells.data };
        const v3 a = V3(2, 0, 0), b = V3(0, -2, 0); /* so that the axis is -z, and C 90 is y */
        double worst = 0;
        int lit = 0;
        for (int k = 0; k < 20000; k++) {
            v3 way = random_direction(&d);
            if (k % 2)
                way = normalised(V3(.4f * way.x, .4f * way.y, way.z - 1));
            double gamma = acos(NOC_CLAMP(-(double)way.z, -1, 1)) * 180 / M_PI;
            double want = noc_profile_intensity(p, atan2((double)way.y, (double)way.x) * 180 / M_PI, gamma);
            profile_value have = profile_look(&ctx, 1, a, b, way);
            lit += want > 0;
            if (want == 0 || have.here == 0) /* but at the edges both are none */
                worst += (want > 0) != (have.here > 0);
            else if (fabs((double)have.here * info.lumens / want - 1) > 1e-3)
                fail_msg("%zu: %g cd at (%g, %g, %g), not %g", i, (double)have.here * info.lumens, (double)way.x,
                         (double)way.y, (double)way.z, want);
            if (want > 0)
                assert_true(have.beyond <= 0 && have.most >= have.here);
        }
        assert_true(lit > 1000 && worst < 4);
        assert_true(s->profiles.data[0].upward == (i >= 2));
        noc_profile_destroy(p);
        noc_scene_destroy(s);
    }
}

/* What lists score lights by: of a light that falls off with the cosine, and of an even one, its peak; of a beam of 5
 * degrees, whose cosine is 1, the root of its share of what the squared cosine has over a hemisphere, 2 pi / 3. A light
 * that is all at its axis, and gone a step h from it, has h^2 pi / 6: what is scored 0 is never drawn. */
static void test_strength(void **state) {
    enum { STEPS = 181 };
    double c = 0, gamma[STEPS], cd[4][STEPS];
    noc_scene *s = noc_scene_create(NULL);
    for (int i = 0; i < STEPS; i++) {
        gamma[i] = i;
        cd[0][i] = i < 90 ? cos(i * M_PI / 180) : 0;
        cd[1][i] = 1;
        cd[2][i] = i <= 5;
        cd[3][i] = i == 0;
    }
    const double beam = sqrt(2 * M_PI * (1 - cos(5.5 * M_PI / 180)) / (2 * M_PI / 3)),
                 want[] = { 1, 1, beam, M_PI / 360 };
    for (int i = 0; i < 4; i++) {
        noc_profile *p = NULL;
        assert_int_equal(noc_profile_create(NULL, &(noc_profile_params){ "p", 1, STEPS, &c, gamma, cd[i], 90 }, &p),
                         NOC_OK);
        assert_int_equal(noc_scene_add_profile(s, p), i + 1);
        const noc_scene_profile *made = &s->profiles.data[i];
        double have = (double)made->strength / (double)made->peak;
        if (fabs(have / want[i] - 1) > (i < 2 ? 1e-3 : .05)) /* its edge is a slope of a degree */
            fail_msg("%d: %g, not %g", i, have, want[i]);
        noc_profile_destroy(p);
    }
    noc_scene_destroy(s);
}

/* The street's C angle looks where it is asked to. */
static void test_orient(void **state) {
    noc_profile *p = cosine();
    const double axes[][3] = { { 0, 0, -1 }, { .5, 0, -1 }, { 0, 1, 0 } },
                 streets[][3] = { { 1, 1, 0 }, { 1, 0, 0 }, { 0, 0, 1 } };
    for (int i = 0; i < 3; i++) {
        double c0[3], n[3], l = sqrt(axes[i][0] * axes[i][0] + axes[i][1] * axes[i][1] + axes[i][2] * axes[i][2]);
        noc_profile_orient(p, axes[i], streets[i], c0);
        for (int k = 0; k < 3; k++)
            n[k] = axes[i][k] / l;
        /* C 90 = -(n x c0) is the street, made upright to the axis */
        double c90[3] = { c0[1] * n[2] - c0[2] * n[1], c0[2] * n[0] - c0[0] * n[2], c0[0] * n[1] - c0[1] * n[0] };
        double along = 0, dot = 0, s2 = 0;
        for (int k = 0; k < 3; k++)
            along += streets[i][k] * n[k];
        for (int k = 0; k < 3; k++) {
            double upright = streets[i][k] - along * n[k];
            dot += c90[k] * upright;
            s2 += upright * upright;
        }
        assert_true(fabs(dot / sqrt(s2) - 1) < 1e-9);
    }
    double none[3] = { 1, 1, 1 };
    noc_profile_orient(p, axes[0], axes[0], none);
    assert_true(none[0] == 0 && none[1] == 0 && none[2] == 0);
    noc_profile_destroy(p);
}

static void test_refused(void **state) {
    noc_log *log = counting_log();
    noc_scene *s = noc_scene_create(log);
    int first = add_test_profiles(s);
    noc_light wrong[] = { lamp(NOC_LIGHT_POINT, first + TEST_PROFILES), lamp(NOC_LIGHT_POINT, -1),
                          lamp(NOC_LIGHT_SPOT, first), lamp(NOC_LIGHT_SPHERE, first) };
    wrong[2].outer_deg = 30;
    wrong[3].direction[2] = 0;
    static const char *const says[] = { "no such profile", "no such profile", "only points", "needs a direction" };
    for (size_t i = 0; i < NOC_COUNT(wrong); i++) {
        refusing = (refusal){ 0 };
        assert_int_equal(noc_scene_add_light(s, &wrong[i]), -1);
        assert_true(refusing.errors == 1 && strstr(refusing.first_error, says[i]));
    }
    noc_scene_destroy(s);
    noc_log_destroy(log);
}

/* A model's light is turned with it, and keeps its lumens; a moved one keeps its profile. */
static void test_models_and_edits(void **state) {
    noc_scene *s = noc_scene_create(NULL);
    noc_profile *p = cosine();
    int index = noc_scene_add_profile(s, p), model = noc_scene_add_model(s, "car");
    noc_light l = lamp(NOC_LIGHT_DISC, index);
    l.model = model;
    assert_int_equal(noc_scene_add_light(s, &l), 0);
    l = lamp(NOC_LIGHT_POINT, index);
    l.moving = true;
    int mover = noc_scene_add_light(s, &l);
    int car = noc_scene_add_instance(s, &(noc_instance){ model, { 0, -2, 0, 5, 2, 0, 0, 0, 0, 0, 2, 0 } });
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_light_info info;
    assert_int_equal(noc_scene_get_light(s, (size_t)noc_scene_instance_light(s, car, 0), &info), NOC_OK);
    assert_true(fabs(info.lumens - 500) < 1e-3 && fabs(info.light.c0[1] - 1) < 1e-6 &&
                fabs(info.light.radius - .4) < 1e-6);
    noc_light to = lamp(NOC_LIGHT_POINT, 0);
    to.direction[0] = 2;
    assert_int_equal(noc_scene_move_light(s, mover, &to), NOC_OK);
    int later = noc_scene_add_profile(s, p);
    assert_int_equal(later, 2);
    l = lamp(NOC_LIGHT_SPHERE, later);
    int added = noc_scene_add_light(s, &l);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    assert_int_equal(noc_scene_get_light(s, (size_t)mover, &info), NOC_OK);
    assert_true(info.light.profile == index && fabs(info.light.direction[0] - M_SQRT1_2) < 1e-6);
    assert_int_equal(noc_scene_get_light(s, (size_t)added, &info), NOC_OK);
    assert_true(info.light.profile == later && fabs(info.lumens - 500) < 1e-3);
    noc_profile_destroy(p);
    noc_scene_destroy(s);
}

/* Scenes that differ in a profile alone differ. */
static void test_content(void **state) {
    char key[3][NOC_CONTENT_KEY];
    for (int i = 0; i < 3; i++) {
        noc_scene *s = noc_scene_create(NULL);
        int first = add_test_profiles(s);
        noc_light l = lamp(NOC_LIGHT_DISC, first + i / 2);
        assert_true(noc_scene_add_light(s, &l) >= 0);
        assert_int_equal(noc_scene_commit(s), NOC_OK);
        noc_scene_content(s, key[i]);
        noc_scene_destroy(s);
    }
    assert_string_equal(key[0], key[1]);
    assert_string_not_equal(key[0], key[2]);
}

static void test_memory(void **state) {
    noc_profile *p = cosine();
    bool reached;
    FOR_EACH_REFUSAL(reached) {
        noc_log *log = counting_log();
        noc_scene *s = noc_scene_create(log);
        begin_refusal(n, later);
        int index = noc_scene_add_profile(s, p);
        reached = end_refusal();
        assert_true(reached ? index == -1 && refusing.errors == 1 : index == 1);
        noc_scene_destroy(s);
        noc_log_destroy(log);
    }
    noc_profile_destroy(p);
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(test_light),    cmocka_unit_test(test_own_angles),
                                        cmocka_unit_test(test_strength), cmocka_unit_test(test_orient),
                                        cmocka_unit_test(test_refused),  cmocka_unit_test(test_models_and_edits),
                                        cmocka_unit_test(test_content),  cmocka_unit_test(test_memory) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
