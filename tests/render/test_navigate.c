/* Moving about: the same path however time is cut, a walker that keeps to the ground and out of walls, and ways to
 * places. */
#include "rooms.h"

#include <nocturne/navigate.h>

typedef struct place {
    noc_scene *scene;
    noc_view *view;
    noc_navigator *nav;
} place;

static noc_status cast(void *user, const noc_ray *rays, size_t count, noc_hit *hits) {
    return noc_view_cast(user, rays, count, hits);
}

static place enter(noc_scene *s) {
    place p = { s, NULL, NULL };
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    p.view = own_view(s, 1, NULL);
    p.nav = noc_navigator_create(s, cast, p.view);
    assert_non_null(p.nav);
    return p;
}

static void leave(place *p) {
    noc_navigator_destroy(p->nav);
    close_view(p->view);
    noc_scene_destroy(p->scene);
}

static place city(void) {
    noc_scene *s = noc_scene_create(NULL);
    assert_int_equal(noc_scene_add_city(s, &(noc_city_params){ .seed = 3, .size = 180 }), NOC_OK);
    return enter(s);
}

static int of_class(noc_scene *s, noc_class cls) {
    noc_material m = noc_class_material(cls);
    int index = noc_scene_add_material(s, &m);
    assert_true(index >= 0);
    return index;
}

static void block(noc_scene *s, int m, double x, double y, double z, double a, double b, double c) {
    QUAD(s, m, x, y, z, a, 0, 0, 0, 0, c);
    QUAD(s, m, x + a, y, z, 0, b, 0, 0, 0, c);
    QUAD(s, m, x + a, y + b, z, -a, 0, 0, 0, 0, c);
    QUAD(s, m, x, y + b, z, 0, -b, 0, 0, 0, c);
    QUAD(s, m, x, y, z + c, a, 0, 0, 0, b, 0);
}

static noc_camera camera_of(const place *p) {
    noc_camera c;
    noc_navigator_camera(p->nav, &c);
    return c;
}

static void hold(place *p, uint32_t keys, double seconds) {
    for (int i = 0; i < (int)(seconds * 30 + .5); i++)
        assert_int_equal(noc_navigator_input(p->nav, &(noc_navigate_input){ .seconds = 1 / 30.0, .keys = keys }, NULL),
                         NOC_OK);
}

static void rest(place *p) {
    for (int i = 0; i < 1000 && noc_navigator_moves(p->nav); i++)
        hold(p, 0, 1 / 30.0);
    assert_false(noc_navigator_moves(p->nav));
}

static void stand(place *p, double ex, double ey, double ez, double tx, double ty, double tz) {
    noc_camera c = look(ex, ey, ez, tx, ty, tz, 50);
    assert_int_equal(noc_navigator_set_mode(p->nav, NOC_NAVIGATE_FLY), NOC_OK);
    assert_int_equal(noc_navigator_set_camera(p->nav, &c), NOC_OK);
    assert_int_equal(noc_navigator_set_mode(p->nav, NOC_NAVIGATE_WALK), NOC_OK);
    rest(p);
}

static double away(const noc_camera *a, const noc_camera *b) {
    return hypot(hypot(a->eye[0] - b->eye[0], a->eye[1] - b->eye[1]), a->eye[2] - b->eye[2]);
}

/* One second of input in so many parts. */
static noc_camera in_parts(noc_navigate_mode mode, int parts, double *speed) {
    place p = city();
    *speed = 0;
    noc_camera c;
    assert_int_equal(noc_scene_camera(p.scene, NOC_VIEWPOINT_STREET, 1.5, &c), NOC_OK);
    assert_int_equal(noc_navigator_set_camera(p.nav, &c), NOC_OK);
    assert_int_equal(noc_navigator_set_mode(p.nav, mode), NOC_OK);
    rest(&p);
    static const uint32_t keys[3] = { NOC_KEY_FORWARD | NOC_KEY_FAST, NOC_KEY_FORWARD | NOC_KEY_LEFT, NOC_KEY_RIGHT };
    for (int second = 0; second < 3; second++)
        for (int i = 0; i < parts; i++) {
            noc_navigate_input in = { .seconds = 1.0 / parts,
                                      .keys = keys[second],
                                      .turn = { .3 / parts, second == 1 ? .1 / parts : 0 },
                                      .at = { .5, .5 } };
            assert_int_equal(noc_navigator_input(p.nav, &in, &c), NOC_OK);
            *speed = fmax(*speed, 4 * noc_navigator_speed(p.nav));
        }
    leave(&p);
    return c;
}

static void a_path_is_the_same_however_time_is_cut(void **state) {
    (void)state;
    static const int cuts[] = { 24, 333 };
    for (noc_navigate_mode mode = 0; mode < NOC_NAVIGATE_COUNT; mode++) {
        double speed;
        noc_camera whole = in_parts(mode, 1, &speed);
        for (size_t i = 0; i < NOC_COUNT(cuts); i++) {
            noc_camera c = in_parts(mode, cuts[i], &speed);
            print_message("# %s in %d parts: %g m away, at up to %g m/s\n", noc_navigate_mode_name(mode), cuts[i],
                          away(&c, &whole), speed);
            /* keys are pressed and let go on whole steps of 1/120 s, three times */
            assert_true(away(&c, &whole) < 1e-3 + (cuts[i] == 333 ? 3 * speed / 120 : 0));
        }
    }
}

static void what_rests_is_the_same_to_the_bit(void **state) {
    (void)state;
    place p = city();
    for (noc_navigate_mode mode = 0; mode < NOC_NAVIGATE_COUNT; mode++) {
        assert_int_equal(noc_navigator_set_mode(p.nav, mode), NOC_OK);
        hold(&p, NOC_KEY_FORWARD, .5);
        rest(&p);
        noc_camera a = camera_of(&p), b;
        for (int i = 0; i < 50; i++) {
            noc_navigate_input in = { .seconds = .0173 };
            assert_int_equal(noc_navigator_input(p.nav, &in, &b), NOC_OK);
            assert_memory_equal(&a, &b, sizeof(a));
        }
    }
    leave(&p);
}

static void speed_comes_smoothly_and_as_set(void **state) {
    (void)state;
    noc_scene *s = noc_scene_create(NULL);
    add_floor(s, of_class(s, NOC_CLASS_ROAD), 0, 0, 0, 200);
    place p = enter(s);
    stand(&p, 0, -50, 1.7, 0, 0, 1.7);
    noc_camera a = camera_of(&p);
    assert_true(fabs(a.eye[2] - 1.7) < 1e-6);
    hold(&p, NOC_KEY_FORWARD, 1 / 30.0);
    noc_camera b = camera_of(&p);
    assert_true(away(&a, &b) > 0 && away(&a, &b) < .5 * 2 / 30.0);
    hold(&p, NOC_KEY_FORWARD, 1);
    a = camera_of(&p);
    hold(&p, NOC_KEY_FORWARD, 1);
    b = camera_of(&p);
    assert_true(fabs(away(&a, &b) - 2) < .02);
    assert_int_equal(noc_navigator_set_speed(p.nav, 5), NOC_OK);
    hold(&p, NOC_KEY_FORWARD | NOC_KEY_RIGHT, 1);
    a = camera_of(&p);
    hold(&p, NOC_KEY_FORWARD | NOC_KEY_RIGHT, 1); /* aslant one is no faster */
    b = camera_of(&p);
    assert_true(fabs(away(&a, &b) - 5) < .05);
    hold(&p, NOC_KEY_FORWARD | NOC_KEY_SLOW, 1);
    a = camera_of(&p);
    hold(&p, NOC_KEY_FORWARD | NOC_KEY_SLOW, 1);
    b = camera_of(&p);
    assert_true(fabs(away(&a, &b) - 1.25) < .05);
    assert_int_equal(noc_navigator_set_speed(p.nav, -1), NOC_ERR_ARGUMENT);
    assert_int_equal(noc_navigator_set_speed(p.nav, NAN), NOC_ERR_ARGUMENT);
    leave(&p);
}

/* Stairs of 17 cm, a ramp of 20 degrees, a bank of 70, a wall, a kerb, a car. */
static place yard(void) {
    noc_scene *s = noc_scene_create(NULL);
    int ground = of_class(s, NOC_CLASS_ROAD), wall = of_class(s, NOC_CLASS_WALL), car = of_class(s, NOC_CLASS_VEHICLE);
    add_floor(s, ground, 0, 0, 0, 60);
    for (int i = 0; i < 10; i++)
        block(s, wall, -1, 5 + .29 * i, 0, 2, 8 - .29 * i, .17 * (i + 1));
    QUAD(s, ground, 9, 5, 0, 2, 0, 0, 0, 10, 3.64);
    QUAD(s, ground, 19, 5, 0, 2, 0, 0, 0, 1, 2.75);
    block(s, wall, 27, 5, 0, 6, 1, 3);
    block(s, ground, 39, 5, 0, 2, 4, .15);
    block(s, car, 48, 5, .25, 2, 4.5, 1.2);
    return enter(s);
}

static void climbs_what_feet_can(void **state) {
    (void)state;
    place p = yard();
    const struct {
        double x, y, z; /* where three seconds' way north from (x, 3) ends: at least, or at most, at y, on z */
        bool goes_on;
    } ways[] = {
        { 0, 8, 1.7, true },    { 10, 8, 1.09, true }, { 20, 5.2, 0, false },
        { 30, 4.72, 0, false }, { 40, 8, .15, true },  { 49, 4.72, 0, false },
    };
    for (size_t i = 0; i < NOC_COUNT(ways); i++) {
        stand(&p, ways[i].x, 3, 1.7, ways[i].x, 4, 1.7);
        hold(&p, NOC_KEY_FORWARD, ways[i].goes_on ? 2.7 : 5);
        rest(&p);
        noc_camera c = camera_of(&p);
        double foot = c.eye[2] - 1.7;
        print_message("# way %zu: y %.3f, feet %.3f\n", i, c.eye[1], foot);
        assert_true(fabs(c.eye[0] - ways[i].x) < .2);
        assert_true(ways[i].goes_on ? c.eye[1] > ways[i].y : c.eye[1] <= ways[i].y);
        assert_true(fabs(foot - ways[i].z) < (i == 1 ? .35 : .02));
    }
    leave(&p);
}

static void slides_along_walls_and_round_corners(void **state) {
    (void)state;
    place p = yard();
    stand(&p, 28, 3, 1.7, 30, 5, 1.7); /* north-east, into a wall along x that ends at 33 */
    hold(&p, NOC_KEY_FORWARD, 4.5);
    noc_camera c = camera_of(&p);
    assert_true(c.eye[0] > 32.9);
    hold(&p, NOC_KEY_FORWARD, 4);
    c = camera_of(&p);
    assert_true(c.eye[1] > 6 && c.eye[0] > 33.25);
    leave(&p);
}

static void falls_softly_and_keeps_off_the_edge(void **state) {
    (void)state;
    noc_scene *s = noc_scene_create(NULL);
    int ground = of_class(s, NOC_CLASS_ROAD), roof = of_class(s, NOC_CLASS_ROOF);
    add_floor(s, ground, 0, 0, 0, 12);
    block(s, roof, -2, -2, 0, 4, 4, 6);
    place p = enter(s);
    stand(&p, 0, 0, 7.7, 0, 1, 7.7);
    noc_camera c = camera_of(&p), before = c;
    assert_true(fabs(c.eye[2] - 7.7) < 1e-6);
    for (int i = 0; i < 300; i++) {
        hold(&p, NOC_KEY_FORWARD, 1 / 30.0);
        c = camera_of(&p);
        assert_true(before.eye[2] - c.eye[2] < 6.2 / 30);
        before = c;
    }
    rest(&p);
    c = camera_of(&p);
    assert_true(fabs(c.eye[2] - 1.7) < 1e-4);
    assert_true(c.eye[1] > 11 && c.eye[1] <= 12.16);
    leave(&p);
}

/* Nothing stands between where the walker was and is, no wall is in its body, and it is on the ground. */
static void check_walker(place *p, const noc_camera *was, const noc_camera *is) {
    noc_hit hit[23];
    noc_ray ray[23];
    for (int i = 0; i < 16; i++)
        ray[i] = (noc_ray){ { is->eye[0], is->eye[1], is->eye[2] - .2 }, { cos(i * .3927), sin(i * .3927), 0 }, .15 };
    ray[16] = (noc_ray){ { is->eye[0], is->eye[1], is->eye[2] }, { 0, 0, -1 }, 100 };
    ray[17] = (noc_ray){ { is->eye[0], is->eye[1], is->eye[2] }, { 0, 0, 1 }, 1000 };
    double d = away(was, is);
    ray[18] = (noc_ray){ { was->eye[0], was->eye[1], was->eye[2] }, { 1, 0, 0 }, d };
    for (int k = 0; k < 3 && d > 0; k++)
        ray[18].direction[k] = is->eye[k] - was->eye[k];
    for (int i = 19; i < 23; i++) { /* a foot's breadth around: it may be the edge of the world, or of a crack */
        ray[i] = ray[16];
        ray[i].origin[i & 1] += i < 21 ? .15 : -.15;
    }
    assert_int_equal(noc_view_cast(p->view, ray, 23, hit), NOC_OK);
    for (int i = 19; i < 23; i++)
        hit[16] = hit[16].hit ? hit[16] : hit[i];
    for (int i = 0; i < 16; i++)
        assert_false(hit[i].hit && hit[i].cls != NOC_CLASS_VEHICLE);
    assert_true(hit[16].hit && hit[16].front && hit[16].distance > .9);
    assert_false(hit[17].hit && hit[17].cls >= NOC_CLASS_TERRAIN && hit[17].cls <= NOC_CLASS_GREEN);
    assert_false(d > 0 && hit[18].hit);
}

static uint32_t draw(uint32_t below) {
    static uint32_t seed = 12345;
    seed = seed * 1664525u + 1013904223u;
    return (seed >> 8) % below;
}

static void a_walker_is_never_in_a_wall_nor_under_the_ground(void **state) {
    (void)state;
    place p = city();
    noc_camera c;
    assert_int_equal(noc_scene_camera(p.scene, NOC_VIEWPOINT_STREET, 1.5, &c), NOC_OK);
    assert_int_equal(noc_navigator_set_camera(p.nav, &c), NOC_OK);
    assert_int_equal(noc_navigator_set_mode(p.nav, NOC_NAVIGATE_WALK), NOC_OK);
    rest(&p);
    noc_camera was = camera_of(&p), start = was;
    double way = 0, far = 0;
    for (int i = 0; i < samples(3000); i++) {
        noc_navigate_input in = { .seconds = (1 + draw(80)) * 1e-3,
                                  .keys = NOC_KEY_FORWARD | draw(256),
                                  .at = { .5, .5 } };
        in.keys &= draw(3) ? ~(uint32_t)NOC_KEY_SLOW : ~0u;
        in.turn[0] = (draw(200) / 100.0 - 1) * (draw(20) ? .05 : 2);
        in.turn[1] = (draw(200) / 100.0 - 1) * .02;
        in.pan[0] = draw(40) ? 0 : draw(100) / 50.0 - 1;
        in.zoom = draw(60) ? 0 : (int)(draw(7)) - 3;
        assert_int_equal(noc_navigator_input(p.nav, &in, &c), NOC_OK);
        check_walker(&p, &was, &c);
        way += away(&was, &c);
        far = fmax(far, away(&start, &c));
        was = c;
    }
    print_message("# walked %.0f m, up to %.0f m away\n", way, far);
    if (!SANITIZED)
        assert_true(way > samples(150) && (far > 30 || is_quick()));
    leave(&p);
}

static void who_begins_in_a_house_comes_out(void **state) {
    (void)state;
    noc_scene *s = noc_scene_create(NULL);
    add_floor(s, of_class(s, NOC_CLASS_ROAD), 0, 0, 0, 60);
    block(s, of_class(s, NOC_CLASS_WALL), -5, -5, 0, 10, 10, 8);
    place p = enter(s);
    stand(&p, 1, 0, 1.7, 2, 0, 1.7);
    noc_camera c = camera_of(&p);
    assert_true(fmax(fabs(c.eye[0]), fabs(c.eye[1])) > 5.2);
    assert_true(fabs(c.eye[2] - 1.7) < 1e-6);
    leave(&p);
}

/* A room that shows its walls' fronts is for who is in it. */
static void who_begins_in_a_room_stays_in_it(void **state) {
    (void)state;
    noc_scene *s = noc_scene_create(NULL);
    int wall = of_class(s, NOC_CLASS_WALL), floor = of_class(s, NOC_CLASS_GROUND);
    QUAD(s, floor, -3, -3, 0, 6, 0, 0, 0, 6, 0);
    QUAD(s, wall, -3, -3, 2.6, 0, 6, 0, 6, 0, 0);
    QUAD(s, wall, -3, -3, 0, 0, 6, 0, 0, 0, 2.6);
    QUAD(s, wall, 3, -3, 0, 0, 0, 2.6, 0, 6, 0);
    QUAD(s, wall, -3, -3, 0, 0, 0, 2.6, 6, 0, 0);
    QUAD(s, wall, -3, 3, 0, 6, 0, 0, 0, 0, 2.6);
    place p = enter(s);
    stand(&p, -1, 0, 1.2, 2, 0, 1.2);
    for (int i = 0; i < 4; i++) {
        hold(&p, NOC_KEY_FORWARD, 4);
        noc_camera c = camera_of(&p);
        assert_true(fmax(fabs(c.eye[0]), fabs(c.eye[1])) < 2.72);
        assert_true(fmax(fabs(c.eye[0]), fabs(c.eye[1])) > 2.5);
        assert_true(fabs(c.eye[2] - 1.7) < .01);
        noc_navigate_input in = { .turn = { .9, 0 } };
        assert_int_equal(noc_navigator_input(p.nav, &in, NULL), NOC_OK);
    }
    leave(&p);
}

static void zooming_goes_to_the_pointer(void **state) {
    (void)state;
    noc_scene *s = noc_scene_create(NULL);
    add_floor(s, of_class(s, NOC_CLASS_ROAD), 0, 0, 0, 300);
    place p = enter(s);
    noc_camera c = look(0, -100, 80, 0, 0, 0, 50);
    assert_int_equal(noc_navigator_set_camera(p.nav, &c), NOC_OK);
    double pixel[2] = { 400, 300 }, back[2];
    noc_ray ray;
    c = camera_of(&p);
    assert_int_equal(noc_camera_ray(&c, 1600, 1000, pixel, &ray), NOC_OK);
    noc_hit hit;
    assert_int_equal(noc_view_cast(p.view, &ray, 1, &hit), NOC_OK);
    noc_navigate_input in = { .zoom = 6, .at = { .25, .3 }, .aspect = 1.6 };
    noc_camera was = c;
    assert_int_equal(noc_navigator_input(p.nav, &in, NULL), NOC_OK);
    rest(&p);
    c = camera_of(&p);
    assert_true(noc_camera_project(&c, 1600, 1000, hit.place, back, NULL));
    assert_true(hypot(back[0] - pixel[0], back[1] - pixel[1]) < .5); /* what is under the pointer stays there */
    double ratio =
        hypot(hypot(c.eye[0] - hit.place[0], c.eye[1] - hit.place[1]), c.eye[2] - hit.place[2]) / hit.distance;
    assert_true(fabs(ratio - pow(.85, 6)) < .01);
    in.zoom = -6;
    assert_int_equal(noc_navigator_input(p.nav, &in, NULL), NOC_OK);
    rest(&p);
    c = camera_of(&p);
    assert_true(away(&c, &was) < .5);
    leave(&p);
}

static void orbits_about_the_middle_and_stays_over_the_ground(void **state) {
    (void)state;
    noc_scene *s = noc_scene_create(NULL);
    add_floor(s, of_class(s, NOC_CLASS_TERRAIN), 0, 0, 0, 300);
    place p = enter(s);
    noc_camera c = look(0, -40, 30, 0, -20, 15, 50), d; /* what it looks at is (0, 0, 0) */
    assert_int_equal(noc_navigator_set_camera(p.nav, &c), NOC_OK);
    noc_navigate_input in = { .turn = { .5, 0 } };
    assert_int_equal(noc_navigator_input(p.nav, &in, &d), NOC_OK);
    assert_true(fabs(d.eye[0] + 40) < 1e-3 && fabs(d.eye[1]) < 1e-3 && fabs(d.eye[2] - 30) < 1e-3);
    in = (noc_navigate_input){ .seconds = .5, .turn = { 0, -5 } };
    assert_int_equal(noc_navigator_input(p.nav, &in, &d), NOC_OK);
    assert_true(d.eye[2] > .4);
    leave(&p);
}

static void flies_over_the_ground_and_not_out_of_the_world(void **state) {
    (void)state;
    noc_scene *s = noc_scene_create(NULL);
    add_floor(s, of_class(s, NOC_CLASS_TERRAIN), 0, 0, 0, 100);
    place p = enter(s);
    noc_camera c = look(0, -40, 30, 0, -20, 15, 50);
    assert_int_equal(noc_navigator_set_mode(p.nav, NOC_NAVIGATE_FLY), NOC_OK);
    assert_int_equal(noc_navigator_set_camera(p.nav, &c), NOC_OK);
    hold(&p, NOC_KEY_FORWARD, 6);
    c = camera_of(&p);
    assert_true(c.eye[2] > .49 && c.eye[2] < .8);
    assert_int_equal(noc_navigator_set_speed(p.nav, 1e6), NOC_OK);
    for (int i = 0; i < 3; i++)
        hold(&p, NOC_KEY_UP | NOC_KEY_BACK | NOC_KEY_FAST, 10);
    c = camera_of(&p);
    double far = sqrt(c.eye[0] * c.eye[0] + c.eye[1] * c.eye[1] + c.eye[2] * c.eye[2]);
    assert_true(far < 5.1 * hypot(200, 200) && far > 500);
    leave(&p);
}

static void goes_to_cameras_and_clicked_places(void **state) {
    (void)state;
    place p = city();
    noc_camera street, aerial, c;
    assert_int_equal(noc_scene_camera(p.scene, NOC_VIEWPOINT_STREET, 1.5, &street), NOC_OK);
    assert_int_equal(noc_scene_camera(p.scene, NOC_VIEWPOINT_AERIAL, 1.5, &aerial), NOC_OK);
    assert_int_equal(noc_navigator_set_camera(p.nav, &street), NOC_OK);
    noc_camera was = camera_of(&p);
    assert_true(away(&was, &street) < 1e-9);
    assert_int_equal(noc_navigator_go(p.nav, &aerial), NOC_OK);
    double most = 0;
    for (int i = 0; i < 120 && noc_navigator_moves(p.nav); i++, was = c) {
        hold(&p, 0, 1 / 30.0);
        c = camera_of(&p);
        most = fmax(most, away(&was, &c));
    }
    assert_false(noc_navigator_moves(p.nav));
    assert_true(away(&c, &aerial) < 1e-9 && most < .2 * away(&street, &aerial));
    for (noc_navigate_mode mode = 0; mode < NOC_NAVIGATE_COUNT; mode++)
        for (int i = 0; i < 9; i++) {
            const double at[2] = { .2 + .3 * (i % 3), .5 + .2 * (i / 3) };
            assert_int_equal(noc_navigator_set_mode(p.nav, NOC_NAVIGATE_FLY), NOC_OK);
            assert_int_equal(noc_navigator_set_camera(p.nav, &aerial), NOC_OK);
            assert_int_equal(noc_navigator_set_mode(p.nav, mode), NOC_OK);
            rest(&p);
            was = camera_of(&p);
            if (!noc_navigator_jump(p.nav, at, 1.5)) /* the sky, from where a walker stands */
                continue;
            assert_true(noc_navigator_moves(p.nav));
            rest(&p);
            c = camera_of(&p);
            assert_true(away(&was, &c) > 0);
            if (mode == NOC_NAVIGATE_WALK)
                check_walker(&p, &c, &c);
        }
    assert_false(noc_navigator_jump(p.nav, (double[2]){ 2, 0 }, 1.5));
    assert_false(noc_navigator_jump(p.nav, (double[2]){ NAN, 0 }, 1.5));
    leave(&p);
}

/* A place between two high walls is looked at from along them, one in a box from nowhere. */
static void looks_at_places_past_walls(void **state) {
    (void)state;
    noc_scene *s = noc_scene_create(NULL);
    int ground = of_class(s, NOC_CLASS_TERRAIN), wall = of_class(s, NOC_CLASS_WALL);
    QUAD(s, ground, -100, -100, 0, 200, 0, 0, 0, 200, 0);
    block(s, wall, -80, 3, 0, 160, 5, 40);
    block(s, wall, -80, -8, 0, 160, 5, 40);
    block(s, wall, 60, -90, 0, 3, 3, 3);
    place p = enter(s);
    noc_camera from = look(0, -60, 5, 0, 0, 0, 50);
    for (noc_navigate_mode mode = 0; mode < NOC_NAVIGATE_COUNT; mode++) {
        const double at[3] = { 5, 0, .1 };
        assert_int_equal(noc_navigator_set_mode(p.nav, NOC_NAVIGATE_FLY), NOC_OK);
        assert_int_equal(noc_navigator_set_camera(p.nav, &from), NOC_OK);
        assert_int_equal(noc_navigator_set_mode(p.nav, mode), NOC_OK);
        rest(&p);
        assert_true(noc_navigator_look(p.nav, at, 30));
        rest(&p);
        noc_camera c = camera_of(&p);
        double way[3], length = 0;
        for (int k = 0; k < 3; k++) {
            way[k] = at[k] - c.eye[k];
            length += way[k] * way[k];
        }
        length = sqrt(length);
        noc_hit hit;
        noc_ray ray = { { c.eye[0], c.eye[1], c.eye[2] }, { way[0], way[1], way[2] }, INFINITY };
        assert_int_equal(noc_view_cast(p.view, &ray, 1, &hit), NOC_OK);
        assert_true(length > 15 && length < 31.5 && hit.distance > length - .01);
        assert_true(fabs(c.eye[1]) < 3 || c.eye[2] > 20);
    }
    assert_false(noc_navigator_look(p.nav, (double[3]){ 61.5, -88.5, 1.5 }, 30));
    assert_false(noc_navigator_look(p.nav, (double[3]){ NAN, 0, 0 }, 30));
    assert_false(noc_navigator_look(p.nav, (double[3]){ 0, 0, 0 }, 0));
    leave(&p);
}

static void numbers_of_any_kind_harm_nobody(void **state) {
    (void)state;
    place p = city();
    static const double odd[] = { NAN, INFINITY, -INFINITY, 1e300, -1e300, -1, 0 };
    noc_camera c;
    for (noc_navigate_mode mode = 0; mode < NOC_NAVIGATE_COUNT; mode++) {
        assert_int_equal(noc_navigator_set_mode(p.nav, mode), NOC_OK);
        for (size_t i = 0; i < NOC_COUNT(odd) * 7; i++) {
            double x = odd[i / 7];
            noc_navigate_input in = { .seconds = i % 7 == 0 ? x : .02, .keys = ~0u };
            in.turn[0] = i % 7 == 1 ? x : 0;
            in.turn[1] = i % 7 == 2 ? x : 0;
            in.pan[1] = i % 7 == 3 ? x : 0;
            in.zoom = i % 7 == 4 ? x : 0;
            in.at[0] = i % 7 == 5 ? x : .5;
            in.aspect = i % 7 == 6 ? x : 1;
            assert_int_equal(noc_navigator_input(p.nav, &in, &c), NOC_OK);
            for (int k = 0; k < 3; k++)
                assert_true(isfinite(c.eye[k]) && isfinite(c.target[k]));
        }
    }
    assert_int_equal(noc_navigator_set_mode(p.nav, NOC_NAVIGATE_COUNT), NOC_ERR_ARGUMENT);
    noc_camera nowhere = look(0, 0, 0, 0, 0, 0, 50);
    assert_int_equal(noc_navigator_set_camera(p.nav, &nowhere), NOC_ERR_ARGUMENT);
    assert_int_equal(noc_navigator_go(p.nav, &nowhere), NOC_ERR_ARGUMENT);
    leave(&p);
}

static noc_status refuse(void *user, const noc_ray *rays, size_t count, noc_hit *hits) {
    (void)user, (void)rays, (void)count, (void)hits;
    return NOC_ERR_MEMORY;
}

static void rays_that_are_refused_are_told(void **state) {
    (void)state;
    place p = city();
    noc_navigator *n = noc_navigator_create(p.scene, refuse, NULL);
    assert_non_null(n);
    noc_navigate_input in = { .seconds = .1, .keys = NOC_KEY_FORWARD };
    assert_int_equal(noc_navigator_input(n, &in, NULL), NOC_ERR_MEMORY);
    assert_int_equal(noc_navigator_set_mode(n, NOC_NAVIGATE_WALK), NOC_ERR_ARGUMENT);
    noc_navigator_destroy(n);
    leave(&p);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_path_is_the_same_however_time_is_cut),
        cmocka_unit_test(what_rests_is_the_same_to_the_bit),
        cmocka_unit_test(speed_comes_smoothly_and_as_set),
        cmocka_unit_test(climbs_what_feet_can),
        cmocka_unit_test(slides_along_walls_and_round_corners),
        cmocka_unit_test(falls_softly_and_keeps_off_the_edge),
        cmocka_unit_test(a_walker_is_never_in_a_wall_nor_under_the_ground),
        cmocka_unit_test(who_begins_in_a_house_comes_out),
        cmocka_unit_test(who_begins_in_a_room_stays_in_it),
        cmocka_unit_test(zooming_goes_to_the_pointer),
        cmocka_unit_test(orbits_about_the_middle_and_stays_over_the_ground),
        cmocka_unit_test(flies_over_the_ground_and_not_out_of_the_world),
        cmocka_unit_test(goes_to_cameras_and_clicked_places),
        cmocka_unit_test(looks_at_places_past_walls),
        cmocka_unit_test(numbers_of_any_kind_harm_nobody),
        cmocka_unit_test(rays_that_are_refused_are_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
