/* Who lights this: closed forms, brute force by the reference method, errors that cover what they claim, weights that
 * are wrong and must be refused; the same for any number of threads; edits, instances, profiles. */
#include "asking.h"

/* Two lamps over a floor; a wall hides a third one. What points bring is known without noise. */
static void points_bring_their_closed_form(void **state) {
    (void)state;
    noc_scene *s = noc_scene_create(NULL);
    add_floor(s, matte(s, 0.5f), 0, 0, 0, 40);
    QUAD(s, 0, 5, -10, 0, 0, 20, 0, 0, 0, 10);
    point_light(s, 0, 0, 6, 300);
    point_light(s, -8, 0, 6, 900);
    point_light(s, 10, 0, 6, 90000);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    answer a = ask_point(s, point_at(0, 0, 0), 1, 0);
    double near = 300 / 36.0, far = 900 * 6 / 1000.0;
    assert_int_equal(a.count, 2);
    assert_true(fabs(row_of(&a, 0)->lux.value - near) < 1e-5 * near);
    assert_true(fabs(row_of(&a, 1)->lux.value - far) < 1e-5 * far);
    assert_true(fabs(row_of(&a, 0)->share.value - near / (near + far)) < 1e-5);
    assert_true(a.rows[0].share.error < 1e-6 && a.sum.lux.error < 1e-5);
    assert_true(fabs(a.sum.lux.value - near - far) < 1e-4 && a.sum.rest.value < 1e-9);
    assert_int_equal(a.rows[0].emitter.kind, NOC_EMITTER_LAMP);
    assert_true(fabs(row_of(&a, 1)->distance - 10) < 1e-5);
    noc_scene_destroy(s);
}

/* An open sky of even luminance would bring pi L; ours brings what sky_radiance integrates to: held to the picture. */
static void the_sky_and_luminance_are_those_of_a_picture(void **state) {
    (void)state;
    noc_scene *s = noc_scene_create(NULL);
    add_floor(s, matte(s, 0.5f), 0, 0, 0, 40);
    QUAD(s, 0, 3, -10, 0, 0, 20, 0, 0, 0, 10);
    point_light(s, 0, 0, 6, 30);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_camera c = look(0, -12, 9, 0, 0, 0, 2);
    noc_render_params p = measure(8, 8, NOC_METHOD_REFERENCE);
    p.sky = 0.5;
    noc_image *image = render(s, &c, &p, samples(400));
    double q[3], shown = 0;
    for (int i = 0; i < 64; i++)
        shown += luma(image->rgb + 3 * i) / 64;
    noc_image_destroy(image);
    floor_point(&c, &p, 4, 4, 0, q);
    noc_view *view = own_view(s, 2, NULL);
    noc_patch y = point_at(q[0], q[1], 0);
    noc_region *region = region_of(&y, 1);
    noc_ranking *r = noc_ranking_create(view, region, &(noc_ranking_params){ &p, c.eye });
    noc_influence_sum sum;
    assert_int_equal(noc_ranking_refine(r, &(noc_ranking_target){ .rays = (uint64_t)samples(400000) }, NULL), NOC_OK);
    assert_int_equal(noc_ranking_get(r, NULL, 0, NULL, &sum), NOC_OK);
    assert_true(sum.luminance.value > 0 && sum.sky.value > 0.1);
    if (!SANITIZED) {
        assert_true(fabs(sum.luminance.value - shown) < 4 * sum.luminance.error + 4e-3 * shown);
        assert_true(fabs(sum.lux.value * 0.5 / M_PI - shown) < 4 * sum.lux.error + 4e-3 * shown);
        assert_true(sum.sky.error < 0.01 * sum.sky.value);
    }
    assert_true(fabs(sum.sky_share.value - sum.sky.value / sum.lux.value) < 1e-9);
    assert_true(fabs(sum.rest_share.value + sum.sky_share.value - 1) < 1e-9);
    noc_ranking_destroy(r);
    noc_region_destroy(region);
    close_view(view);
    noc_scene_destroy(s);
}

static void shares_are_those_of_brute_force(void **state) {
    (void)state;
    static const int crowds[] = { 40, 400 }; /* all looked at; drawn from the tree */
    for (size_t n = 0; n < NOC_COUNT(crowds); n++) {
        noc_scene *s = crowd(crowds[n]);
        noc_view *view = own_view(s, 2, NULL);
        noc_camera c = from_above();
        noc_render_params p = measure(SIDE, SIDE, NOC_METHOD_REFERENCE);
        bool sees[SIDE * SIDE];
        noc_region *region = pixels(view, &c, false, sees), *wrong = pixels(view, &c, true, sees);
        double all = by_reference(s, view, &c, &p, sees, -1, 40), worst = 0;
        answer a = ask(view, region, &p, 6000000), b = ask(view, wrong, &p, 6000000);
        assert_true(off(a.sum.lux, all) < 4);
        for (size_t i = 0; i < 5; i++) {
            size_t light = a.rows[i].emitter.light;
            double truth = by_reference(s, view, &c, &p, sees, (int)light, 40);
            assert_int_equal(a.rows[i].emitter.light_count, 1);
            assert_true(off(a.rows[i].lux, truth) < 4 && off(a.rows[i].share, truth / all) < 4);
            assert_true(SANITIZED || a.rows[i].lux.error < 0.01 * truth); /* sharp enough to tell */
            const noc_influence_row *other = row_of(&b, light);
            worst = fmax(worst, other ? off(other->lux, truth) : 99);
        }
        assert_true(SANITIZED || worst > 8); /* points that count for more than their part are refused */
        double shares = a.sum.rest_share.value + a.sum.sky_share.value;
        for (size_t i = 0; i < a.count; i++)
            shares += a.rows[i].share.value;
        assert_true(fabs(shares - 1) < 1e-9);
        noc_region_destroy(region);
        noc_region_destroy(wrong);
        close_view(view);
        noc_scene_destroy(s);
    }
}

/* The crowd has lights of several kinds: with those of one alone, a picture is as bright as that kind's sum says. */
static void kinds_are_those_of_brute_force(void **state) {
    (void)state;
    enum { LIGHTS = 400 };
    noc_scene *s = crowd(LIGHTS);
    noc_view *view = own_view(s, 2, NULL);
    noc_camera c = from_above();
    noc_render_params p = measure(SIDE, SIDE, NOC_METHOD_REFERENCE);
    bool sees[SIDE * SIDE];
    noc_region *region = pixels(view, &c, false, sees);
    answer a = ask(view, region, &p, 6000000);
    double all = by_reference(s, view, &c, &p, sees, ALL_LIGHTS, 40), lux = 0, share = 0;
    size_t emitters = 0;
    int kinds = 0;
    for (int k = 0; k < NOC_EMITTER_KIND_COUNT; k++) {
        const noc_influence_kind *sum = &a.sum.kinds[k];
        noc_light_info l;
        noc_emitter e;
        float made[LIGHTS][3];
        lux += sum->lux.value;
        share += sum->share.value;
        emitters += sum->emitters;
        if (!sum->emitters) {
            assert_true(sum->lux.value == 0 && sum->lux.error == 0);
            continue;
        }
        for (int i = 0; i < LIGHTS; i++) {
            assert_int_equal(noc_scene_get_light(s, (size_t)i, &l), NOC_OK);
            memcpy(made[i], l.light.emission, sizeof(made[i]));
            assert_int_equal(noc_scene_get_emitter(s, (size_t)i, &e), NOC_OK);
            if ((int)e.kind != k)
                assert_int_equal(noc_scene_set_emission(s, i, (float[3]){ 0 }), NOC_OK);
        }
        assert_int_equal(noc_scene_commit(s), NOC_OK);
        double truth = by_reference(s, view, &c, &p, sees, ALL_LIGHTS, 40);
        for (int i = 0; i < LIGHTS; i++)
            assert_int_equal(noc_scene_set_emission(s, i, made[i]), NOC_OK);
        assert_int_equal(noc_scene_commit(s), NOC_OK);
        assert_true(off(sum->lux, truth) < 4 && off(sum->share, truth / all) < 4 && sum->lux.error > 0);
        assert_true(SANITIZED || (truth > 0.02 * all && truth < 0.98 * all && sum->lux.error < 0.01 * truth));
        kinds++;
    }
    assert_true(kinds >= 2 && emitters == a.sum.emitters);
    assert_true(fabs(lux + a.sum.sky.value - a.sum.lux.value) < 1e-9 * a.sum.lux.value);
    assert_true(fabs(share + a.sum.sky_share.value - 1) < 1e-9);
    noc_region_destroy(region);
    close_view(view);
    noc_scene_destroy(s);
}

/* ---- errors ---- */

typedef struct coverage {
    int inside, of;
    double chi;
} coverage;

static void cover(coverage *c, noc_estimate e, double truth) {
    double t = (e.value - truth) / e.error;
    c->inside += fabs(t) < 1.96;
    c->of++;
    c->chi += t * t;
}

/* 95 % intervals hold the truth in about 95 of 100 seeds, for a point and for a floor of triangles. What is held
 * against is a long run of another seed. */
static void errors_cover(void **state) {
    (void)state;
    noc_scene *s = crowd(400);
    noc_view *view = own_view(s, 2, NULL);
    noc_patch floor[] = { { { -6, -4, 0 }, { 12, 0, 0 }, { 0, 8, 0 }, { 0, 0, 1 }, 48, 0 },
                          { { 6, 4, 0 }, { -12, 0, 0 }, { 0, -8, 0 }, { 0, 0, 1 }, 48, 0 } };
    noc_patch y = point_at(-2, 3, 0);
    for (int point = 0; point < 2; point++) {
        noc_region *region = point ? region_of(&y, 1) : region_of(floor, 2);
        noc_render_params p = no_sky(99991);
        answer truth = ask(view, region, &p, 20000000);
        coverage lux = { 0 }, share = { 0 }, kinds = { 0 };
        for (uint32_t seed = 1; seed <= (uint32_t)samples(200); seed++) {
            p.seed = seed * 7919;
            answer a = ask(view, region, &p, 0);
            cover(&lux, a.sum.lux, truth.sum.lux.value);
            for (size_t i = 0; i < 3; i++) {
                const noc_influence_row *row = row_of(&a, truth.rows[i].emitter.light);
                if (row && row->share.error > 0)
                    cover(&share, row->share, truth.rows[i].share.value);
            }
            const noc_influence_kind *flat = &a.sum.kinds[NOC_EMITTER_SURFACE];
            cover(&kinds, flat->lux, truth.sum.kinds[NOC_EMITTER_SURFACE].lux.value);
            cover(&kinds, flat->share, truth.sum.kinds[NOC_EMITTER_SURFACE].share.value);
        }
        double of_lux = (double)lux.inside / lux.of, of_shares = (double)share.inside / share.of;
        double of_kinds = (double)kinds.inside / kinds.of;
        print_message("# %s: %.1f %% of totals, %.1f %% of shares, %.1f %% of a kind within 1.96 standard errors\n",
                      point ? "point" : "floor", 100 * of_lux, 100 * of_shares, 100 * of_kinds);
        const double low = 0.95 - slack(0.05), high = 0.95 + slack(0.04);
        assert_true(SANITIZED || (of_lux > low && of_lux < high && of_kinds > low && of_kinds < high));
        assert_true(SANITIZED || (share.of >= samples(300) && fabs(of_shares - 0.9475) < slack(0.0375)));
        noc_region_destroy(region);
    }
    close_view(view);
    noc_scene_destroy(s);
}

/* ---- manners ---- */

static void threads_change_nothing(void **state) {
    (void)state;
    noc_scene *s = crowd(400);
    noc_patch floor = { { -6, -4, 0 }, { 12, 0, 0 }, { 0, 8, 0 }, { 0, 0, 1 }, 48, 0 }, y = point_at(-2, 3, 0);
    for (int point = 0; point < 2; point++) {
        noc_region *region = region_of(point ? &y : &floor, 1);
        answer a[2];
        for (int i = 0; i < 2; i++) {
            noc_view *view = own_view(s, 1 + 4 * i, NULL);
            noc_render_params p = noc_render_default_params();
            a[i] = ask(view, region, &p, 60000);
            close_view(view);
        }
        assert_true(a[0].count > 10 && a[0].count == a[1].count);
        assert_memory_equal(&a[0].sum.lux, &a[1].sum.lux, sizeof(a[0].sum.lux));
        for (size_t i = 0; i < a[0].count; i++) {
            assert_int_equal(a[0].rows[i].emitter.light, a[1].rows[i].emitter.light);
            assert_memory_equal(&a[0].rows[i].share, &a[1].rows[i].share, sizeof(a[0].rows[i].share));
        }
        noc_region_destroy(region);
    }
    noc_scene_destroy(s);
}

static bool never(void *user, const char *what, double done) {
    (void)what;
    (void)done;
    return ++*(int *)user < 3;
}

static void edits_begin_anew_and_cancelling_keeps(void **state) {
    (void)state;
    noc_scene *s = noc_scene_create(NULL);
    add_floor(s, matte(s, 0.5f), 0, 0, 0, 40);
    point_light(s, 0, 0, 5, 100);
    noc_light moving = {
        .kind = NOC_LIGHT_POINT, .position = { 3, 0, 4 }, .emission = { 100, 100, 100 }, .moving = true
    };
    assert_int_equal(noc_scene_add_light(s, &moving), 1);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_view *view = own_view(s, 2, NULL);
    noc_patch y = point_at(0, 0, 0);
    noc_region *region = region_of(&y, 1);
    noc_render_params p = no_sky(1);
    noc_ranking *r = noc_ranking_create(view, region, &(noc_ranking_params){ &p, NULL });
    noc_influence_row rows[2];
    noc_influence_sum sum;
    size_t found;
    assert_int_equal(noc_ranking_get(r, rows, 2, &found, &sum), NOC_ERR_ARGUMENT); /* nothing yet */
    int calls = 0;
    noc_progress progress = { never, &calls };
    noc_ranking_target long_one = { .seconds = 60 };
    assert_int_equal(noc_ranking_refine(r, &long_one, &progress), NOC_ERR_CANCELLED);
    assert_int_equal(noc_ranking_get(r, rows, 2, &found, &sum), NOC_OK);
    assert_int_equal(found, 2);
    assert_int_equal(sum.samples, 2 * 64);
    assert_true(fabs(sum.lux.value - 4 - 100 * 4 / 125.0) < 1e-5);
    moving.position[0] = 0; /* now it is the nearer one */
    assert_int_equal(noc_scene_move_light(s, 1, &moving), NOC_OK);
    assert_int_equal(noc_scene_set_emission(s, 0, (float[3]){ 50, 50, 50 }), NOC_OK);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    assert_int_equal(noc_ranking_refine(r, NULL, NULL), NOC_OK);
    assert_int_equal(noc_ranking_get(r, rows, 2, &found, &sum), NOC_OK);
    assert_int_equal(sum.restarts, 1);
    assert_int_equal(sum.samples, 64);
    assert_true(fabs(sum.lux.value - 2 - 100 / 16.0) < 1e-5);
    assert_int_equal(rows[0].emitter.light, 1);
    assert_int_equal(rows[0].emitter.kind, NOC_EMITTER_OTHER);
    assert_int_equal(noc_scene_set_emission(s, 0, (float[3]){ 60, 60, 60 }), NOC_OK);
    assert_int_equal(noc_scene_commit(s), NOC_OK); /* and is not asked again: what was found is told */
    assert_int_equal(noc_ranking_get(r, rows, 2, &found, &sum), NOC_OK);
    assert_int_equal(rows[0].emitter.light, 1);
    assert_true(rows[0].emitter.centre[2] == 4);
    assert_int_equal(noc_scene_remove_light(s, 1), NOC_OK);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    assert_int_equal(noc_ranking_get(r, rows, 2, &found, &sum), NOC_OK);
    assert_int_equal(rows[0].emitter.light, 1);
    assert_string_equal(rows[0].emitter.name, "");
    assert_string_equal(rows[0].emitter.of, "");
    noc_ranking_destroy(r);
    noc_region_destroy(region);
    close_view(view);
    noc_scene_destroy(s);
}

/* What people call one light: a lamp of two heads, a car's headlamps, a mesh that shines, a lamp of the same name
 * elsewhere. */
static void lights_are_told_as_people_mean_them(void **state) {
    (void)state;
    noc_scene *s = noc_scene_create(NULL);
    add_floor(s, matte(s, 0.5f), 0, 0, 0, 40);
    for (int i = 0; i < 3; i++) {
        noc_light l = { .kind = NOC_LIGHT_DISC,
                        .position = { i < 2 ? i : 12, 0, 6 },
                        .direction = { 0, 0, -1 },
                        .radius = 0.2,
                        .emission = { 4000, 4000, 4000 },
                        .name = "lamp" };
        assert_int_equal(noc_scene_add_light(s, &l), i);
    }
    int glow =
        noc_scene_add_material(s, &(noc_material){ .roughness = 1, .emission = { 50, 50, 50 }, .two_sided = true });
    QUAD(s, glow, -4, 3, 2, 1, 0, 0, 0, 0, 1);
    int car = noc_scene_add_model(s, "car");
    for (int i = 0; i < 3; i++) {
        noc_light l = { .kind = NOC_LIGHT_SPOT,
                        .position = { 0.5 * i, 0, 1 },
                        .direction = { 1, 0, -0.3 },
                        .outer_deg = 80,
                        .emission = { 900, 900, 900 },
                        .model = car,
                        .name = i < 2 ? "headlamp" : "tail lamp" };
        assert_int_equal(noc_scene_add_light(s, &l), i);
    }
    for (int i = 0; i < 2; i++)
        assert_int_equal(noc_scene_add_instance(s,
                                                &(noc_instance){ car, { 1, 0, 0, -3.0 - i, 0, 1, 0, 0, 0, 0, 1, 0 } }),
                         i);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    answer a = ask_point(s, point_at(0.5, 0.5, 0), 3, 0);
    static const struct {
        noc_emitter_kind kind;
        const char *name, *of;
        size_t lights;
        int times;
    } want[] = { { NOC_EMITTER_LAMP, "lamp", "", 2, 1 },
                 { NOC_EMITTER_LAMP, "lamp", "", 1, 1 },
                 { NOC_EMITTER_SURFACE, "", "", 2, 1 },
                 { NOC_EMITTER_VEHICLE, "headlamp", "car", 2, 2 },
                 { NOC_EMITTER_VEHICLE, "tail lamp", "car", 1, 2 } };
    assert_int_equal(a.count, 7);
    for (size_t w = 0; w < NOC_COUNT(want); w++) {
        int times = 0;
        for (size_t i = 0; i < a.count; i++) {
            const noc_emitter *e = &a.rows[i].emitter;
            times += e->kind == want[w].kind && !strcmp(e->name, want[w].name) && !strcmp(e->of, want[w].of) &&
                     e->light_count == want[w].lights;
        }
        assert_int_equal(times, want[w].times);
    }
    assert_true(fabs(row_of(&a, 0)->emitter.lumens - 2 * M_PI * M_PI * 0.04 * 4000) < 1);
    noc_scene_destroy(s);
}

/* A point light of I cd at h over a floor brings I h / r^3, r m away: 1 lx within a circle, 0.1 lx at r = (I h /
 * 0.1)^1/3. A wall hides what is behind it, and gets its solid angle's flux; two heads count once each. */
static void a_lamp_lights_its_closed_form(void **state) {
    (void)state;
    for (int heads = 1; heads <= 2; heads++) {
        noc_scene *s = noc_scene_create(NULL);
        double h = 5, intensity = 120, r1 = cbrt(intensity * h), r2 = cbrt(intensity * h / 0.1);
        add_floor(s, matte(s, 0.5f), 0, 0, 0, 300);
        for (int i = 0; i < heads; i++) {
            noc_light l = { .kind = NOC_LIGHT_POINT, .position = { 0, 0, h }, .name = "lamp" };
            for (int k = 0; k < 3; k++)
                l.emission[k] = (float)(intensity / heads);
            assert_int_equal(noc_scene_add_light(s, &l), i);
        }
        assert_int_equal(noc_scene_commit(s), NOC_OK);
        noc_view *view = own_view(s, 2, NULL);
        noc_reach reach;
        noc_reach_object object;
        size_t found;
        assert_int_equal(noc_view_reach(view, 0, NULL, &reach, &object, 1, &found), NOC_OK);
        assert_int_equal(found, 1);
        assert_int_equal(reach.emitter.light_count, heads);
        assert_true(fabs(reach.area / (M_PI * (r1 * r1 - h * h)) - 1) < 2e-3);
        assert_true(fabs(reach.far - r2) < 0.02 * r2 &&
                    fabs(hypot(reach.far_place[0], reach.far_place[1]) - sqrt(r2 * r2 - h * h)) < 0.5);
        assert_true(fabs(reach.most - intensity / (h * h)) < 1e-3 * reach.most);
        assert_true(fabs(reach.met / (2 * M_PI * intensity) - 1) < 0.02 && fabs(object.lumens - reach.met) < 1e-6);
        assert_int_equal(noc_view_reach(view, 7, NULL, &reach, NULL, 0, NULL), NOC_ERR_ARGUMENT);
        assert_int_equal(noc_view_reach(view, 0, &(noc_reach_params){ 0 }, &reach, NULL, 0, NULL), NOC_ERR_ARGUMENT);
        close_view(view);
        noc_scene_destroy(s);
    }
    noc_scene *s = noc_scene_create(NULL);
    add_floor(s, matte(s, 0.5f), 0, 0, 0, 300);
    QUAD(s, 0, 2, -100, 0, 0, 200, 0, 0, 0, 200); /* half of all that goes sideways */
    point_light(s, 0, 0, 5, 120);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_view *view = own_view(s, 2, NULL);
    noc_reach reach;
    assert_int_equal(noc_view_reach(view, 0, NULL, &reach, NULL, 0, NULL), NOC_OK);
    assert_true(reach.far > 5 && reach.far_place[0] <= 2.001); /* nothing behind the wall */
    assert_true(fabs(reach.most - 30) < 0.1);                  /* on the wall, 2 m away */
    noc_emitter emitter;
    assert_int_equal(noc_scene_get_emitter(s, 0, &emitter), NOC_OK);
    assert_true(emitter.light_count == 1 && emitter.kind == NOC_EMITTER_LAMP);
    close_view(view);
    noc_scene_destroy(s);
}

/* A shining strip in 40 triangles lights as the same one in 2: from afar as one that is small. */
static void many_lights_of_one_emitter_all_count(void **state) {
    (void)state;
    noc_reach reach[2];
    for (int fine = 0; fine < 2; fine++) {
        noc_scene *s = noc_scene_create(NULL);
        add_floor(s, matte(s, 0.5f), 0, 0, 0, 300);
        int glow = noc_scene_add_material(s, &(noc_material){ .roughness = 1, .emission = { 90, 90, 90 } });
        double xyz[3 * 42];
        uint32_t triangles[3 * 40];
        int steps = fine ? 20 : 1;
        for (int i = 0; i <= steps; i++)
            for (int k = 0; k < 2; k++)
                memcpy(xyz + 3 * (2 * i + k), (double[]){ 0, 2.0 * i / steps, 4 + 0.5 * k }, 3 * sizeof(double));
        for (uint32_t i = 0; i < (uint32_t)steps; i++)
            memcpy(triangles + 6 * i, (uint32_t[]){ 2 * i, 2 * i + 2, 2 * i + 1, 2 * i + 1, 2 * i + 2, 2 * i + 3 },
                   6 * sizeof(uint32_t));
        noc_mesh mesh = { .vertex_count = 2 * (size_t)steps + 2,
                          .positions = xyz,
                          .triangle_count = 2 * (size_t)steps,
                          .indices = triangles,
                          .material = glow };
        assert_true(noc_scene_add_mesh(s, &mesh) >= 0);
        assert_int_equal(noc_scene_commit(s), NOC_OK);
        noc_view *view = own_view(s, 2, NULL);
        assert_int_equal(noc_view_reach(view, 0, NULL, &reach[fine], NULL, 0, NULL), NOC_OK);
        assert_int_equal(reach[fine].emitter.light_count, 2 * (size_t)steps);
        close_view(view);
        noc_scene_destroy(s);
    }
    assert_true(fabs(reach[1].emitter.lumens / reach[0].emitter.lumens - 1) < 1e-4);
    assert_true(reach[0].met > 10 && fabs(reach[1].met / reach[0].met - 1) < 0.02);
    assert_true(reach[0].far > 5 && fabs(reach[1].far / reach[0].far - 1) < 0.02);
}

static void wrong_parts_are_refused(void **state) {
    (void)state;
    noc_patch wrong[] = { point_at(0, 0, 0), point_at(NAN, 0, 0), point_at(0, 0, 0), point_at(0, 0, 0) };
    wrong[0].n[2] = 0.5f;
    wrong[2].weight = 0;
    wrong[3].u[1] = INFINITY;
    noc_region *region = noc_region_create(NULL);
    for (size_t i = 0; i < NOC_COUNT(wrong); i++)
        assert_int_equal(noc_region_add(region, &wrong[i], 1), NOC_ERR_ARGUMENT);
    noc_scene *s = crowd(3);
    noc_view *view = own_view(s, 1, NULL);
    assert_null(noc_ranking_create(view, region, NULL)); /* it is empty */
    noc_region_info info;
    noc_region_get_info(region, &info);
    assert_int_equal(info.patches, 0);
    noc_region_destroy(region);
    close_view(view);
    noc_scene_destroy(s);
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(points_bring_their_closed_form),
                                        cmocka_unit_test(the_sky_and_luminance_are_those_of_a_picture),
                                        cmocka_unit_test(shares_are_those_of_brute_force),
                                        cmocka_unit_test(kinds_are_those_of_brute_force),
                                        cmocka_unit_test(errors_cover),
                                        cmocka_unit_test(threads_change_nothing),
                                        cmocka_unit_test(edits_begin_anew_and_cancelling_keeps),
                                        cmocka_unit_test(lights_are_told_as_people_mean_them),
                                        cmocka_unit_test(a_lamp_lights_its_closed_form),
                                        cmocka_unit_test(many_lights_of_one_emitter_all_count),
                                        cmocka_unit_test(wrong_parts_are_refused) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
