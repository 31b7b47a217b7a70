/* A scene that is edited while it is looked at: its pictures are those of a scene that was made so from the start, and
 * what reservoirs hold of the frame before costs no light and leaves no ghost. */
#include "../memory.h"
#include "unbiased.h"

#include "scene/scene.h"

enum { LAMPS = 1, CARS = 2, CAR = 1, TRAFFIC = 3, PANES = 12, PANE = 5 };

/* A parallelogram at p with edges a, b, of a model or of the world; its index. */
static int quad(noc_scene *s, int material, int model, const double p[3], const double a[3], const double b[3]) {
    double xyz[12];
    for (int k = 0; k < 3; k++) {
        xyz[k] = p[k];
        xyz[3 + k] = p[k] + a[k];
        xyz[6 + k] = p[k] + a[k] + b[k];
        xyz[9 + k] = p[k] + b[k];
    }
    int index = noc_scene_add_mesh(s, &(noc_mesh){ .vertex_count = 4,
                                                   .positions = xyz,
                                                   .triangle_count = 2,
                                                   .indices = (uint32_t[]){ 0, 1, 2, 0, 2, 3 },
                                                   .material = material,
                                                   .model = model });
    assert_true(index >= 0);
    return index;
}

#define QUAD_OF(s, m, model, px, py, pz, ax, ay, az, bx, by, bz)                                                       \
    quad(s, m, model, (double[3]){ px, py, pz }, (double[3]){ ax, ay, az }, (double[3]){ bx, by, bz })

static void box(noc_scene *s, int material, int model, double x, double y, double z, double a, double b, double c) {
    QUAD_OF(s, material, model, x, y, z, a, 0, 0, 0, 0, c);
    QUAD_OF(s, material, model, x + a, y, z, 0, b, 0, 0, 0, c);
    QUAD_OF(s, material, model, x + a, y + b, z, -a, 0, 0, 0, 0, c);
    QUAD_OF(s, material, model, x, y + b, z, 0, -b, 0, 0, 0, c);
    QUAD_OF(s, material, model, x, y, z + c, a, 0, 0, 0, b, 0);
}

/* Two lamps ahead, a glowing strip behind, a point over it. */
static void add_car(noc_scene *s, int paint, int glow) {
    assert_int_equal(noc_scene_add_model(s, "car"), CAR);
    box(s, paint, CAR, -1, -.5, .2, 2, 1, .8);
    QUAD_OF(s, glow, CAR, -1.01, .4, .6, 0, -.8, 0, 0, 0, .2);
    for (int i = 0; i < 2; i++)
        assert_int_equal(noc_scene_add_light(s, &(noc_light){ .kind = NOC_LIGHT_DISC,
                                                              .position = { 1.02, i ? -.3 : .3, .5 },
                                                              .direction = { 1, 0, -.1 },
                                                              .radius = .12,
                                                              .emission = { 300, 300, 250 },
                                                              .model = CAR,
                                                              .group = CARS }),
                         i);
    assert_int_equal(noc_scene_add_light(s, &(noc_light){ .kind = NOC_LIGHT_POINT,
                                                          .position = { 0, 0, 1.6 },
                                                          .emission = { 4, 6, 9 },
                                                          .model = CAR,
                                                          .group = CARS }),
                     2);
}

/* Where a car is in a frame: they jump further than they are long, and turn. */
static void place(int car, int frame, double out[12]) {
    double yaw = .7 * frame + 2 * car, c = cos(yaw), s = sin(yaw), x = -6 + 4.5 * car + 1.7 * ((3 * frame + car) % 5),
           y = -4 + 3 * ((frame + 2 * car) % 3), rows[12] = { c, -s, 0, x, s, c, 0, y, 0, 0, 1, 0 };
    memcpy(out, rows, sizeof(rows));
}

/* What a frame has other than frame 0; all of it is edited. */
typedef struct street {
    int frame; /* where cars are */
    float lamps, cars;
    float albedo;
    float glow; /* of the sign */
    bool fence;
    bool globe, pane; /* a lamp that is added later and goes again; one of the panes of the start */
    int traffic;
} street;

static street street_at(int frame) {
    return (street){ .frame = frame,
                     .lamps = frame % 2 ? 1 : .2f,
                     .cars = frame % 3 ? 1 : .5f,
                     .albedo = frame < 3 ? .3f : .6f, /* of one material, reservoirs are not reused in that frame */
                     .glow = frame < 3 ? 8 : 0,
                     .fence = frame % 2,
                     .globe = frame == 1 || frame == 3 || frame == 4,
                     .pane = frame != 2 && frame != 3,
                     .traffic = frame % 4 == 2 ? TRAFFIC - 1 : TRAFFIC };
}

enum { WALL, FLOOR, PAINT, GLOW, SIGN };

static noc_material wall_of(const street *w) {
    return (noc_material){ .albedo = { w->albedo, .5f, .4f }, .roughness = 1, .cls = NOC_CLASS_WALL };
}

static noc_material sign_of(const street *w) {
    return (noc_material){ .roughness = 1, .emission = { w->glow, w->glow, .5f * w->glow } };
}

static int add_fence(noc_scene *s) { return QUAD_OF(s, PAINT, 0, -5, -2.5, 0, 7, 0, 0, 0, 0, 1.6); }

static int add_globe(noc_scene *s) {
    noc_light globe = {
        .kind = NOC_LIGHT_SPHERE, .position = { -2, 1, 3 }, .radius = .3, .emission = { 30, 40, 60 }, .group = LAMPS
    };
    return noc_scene_add_light(s, &globe);
}

static int add_pane(noc_scene *s, int i) {
    noc_light pane = { .kind = NOC_LIGHT_PARALLELOGRAM,
                       .position = { -9 + 1.5 * i, 7.99, 1 + i % 4 },
                       .edge_u = { .5, 0, 0 },
                       .edge_v = { 0, 0, .6 },
                       .emission = { 40, 30, i == PANE ? 200 : 20 },
                       .group = i % 2 ? LAMPS : 0 };
    return noc_scene_add_light(s, &pane);
}

static int add_instance(noc_scene *s, int car, int frame) {
    noc_instance in = { .model = CAR };
    place(car, frame, in.transform);
    int index = noc_scene_add_instance(s, &in);
    assert_true(index >= 0);
    return index;
}

/* A yard with walls and boxes, lit panes on the wall, a sign that is a mesh, and cars. */
static noc_scene *made(const street *w) {
    noc_scene *s = noc_scene_create(NULL);
    noc_material materials[] = {
        [WALL] = wall_of(w),
        [FLOOR] = { .albedo = { .15f, .16f, .2f }, .f0 = .05f, .roughness = .3f, .cls = NOC_CLASS_ROAD },
        [PAINT] = { .albedo = { .6f, .2f, .2f }, .roughness = 1, .cls = NOC_CLASS_VEHICLE },
        [GLOW] = { .roughness = 1, .emission = { 30, 0, 0 } },
        [SIGN] = sign_of(w)
    };
    for (size_t i = 0; i < NOC_COUNT(materials); i++)
        assert_int_equal(noc_scene_add_material(s, &materials[i]), i);
    assert_int_equal(noc_scene_add_group(s, "lamps"), LAMPS);
    assert_int_equal(noc_scene_add_group(s, "cars"), CARS);
    QUAD_OF(s, FLOOR, 0, -15, -15, 0, 30, 0, 0, 0, 30, 0);
    QUAD_OF(s, WALL, 0, -10, 8, 0, 20, 0, 0, 0, 0, 8);
    QUAD_OF(s, SIGN, 0, -3, 7.98, 5, 6, 0, 0, 0, 0, 1);
    for (int i = 0; i < 4; i++)
        box(s, WALL, 0, -8 + 4.4 * i, 4 - 2 * (i % 2), 0, 1, 1, 2);
    for (int i = 0; i < PANES; i++)
        if (i != PANE || w->pane)
            assert_true(add_pane(s, i) >= 0);
    if (w->globe)
        assert_int_equal(add_globe(s), PANES - !w->pane);
    add_car(s, PAINT, GLOW);
    if (w->fence)
        add_fence(s);
    for (int group = LAMPS; group <= CARS; group++) {
        float scale = group == LAMPS ? w->lamps : w->cars;
        assert_int_equal(noc_scene_set_group(s, group, (float[3]){ scale, scale, scale }), NOC_OK);
    }
    for (int i = 0; i < w->traffic; i++)
        add_instance(s, i, w->frame);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    return s;
}

/* The one street that tests edit, as it is now. */
static struct {
    street is;
    int fence;       /* mesh */
    int globe, pane; /* lights */
} now;

static noc_scene *begin_street(int frame) {
    now.is = street_at(frame);
    noc_scene *s = made(&now.is);
    now.fence = (int)s->meshes.len - 1; /* made last, where there is one */
    now.pane = PANE;
    now.globe = PANES;
    return s;
}

/* Edits the street to what it is in a frame, in two transactions. */
static void pose(noc_scene *s, int frame) {
    street to = street_at(frame);
    noc_material wall = wall_of(&to), sign = sign_of(&to);
    assert_int_equal(noc_scene_set_material(s, WALL, &wall), NOC_OK);
    assert_int_equal(noc_scene_set_material(s, SIGN, &sign), NOC_OK);
    assert_int_equal(noc_scene_set_group(s, LAMPS, (float[3]){ to.lamps, to.lamps, to.lamps }), NOC_OK);
    assert_int_equal(noc_scene_set_group(s, CARS, (float[3]){ to.cars, to.cars, to.cars }), NOC_OK);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    for (int i = 0; i < NOC_MIN(to.traffic, now.is.traffic); i++) {
        double there[12];
        place(i, frame, there);
        assert_int_equal(noc_scene_set_transform(s, i, there), NOC_OK);
    }
    for (int i = now.is.traffic; i < to.traffic; i++)
        assert_int_equal(add_instance(s, i, frame), i);
    for (int i = to.traffic; i < now.is.traffic; i++)
        assert_int_equal(noc_scene_remove_instance(s, i), NOC_OK);
    if (to.globe && !now.is.globe)
        now.globe = add_globe(s);
    if (!to.globe && now.is.globe)
        assert_int_equal(noc_scene_remove_light(s, now.globe), NOC_OK);
    if (to.pane && !now.is.pane)
        now.pane = add_pane(s, PANE);
    if (!to.pane && now.is.pane)
        assert_int_equal(noc_scene_remove_light(s, now.pane), NOC_OK);
    if (to.fence && !now.is.fence)
        now.fence = add_fence(s);
    if (!to.fence && now.is.fence)
        assert_int_equal(noc_scene_remove_mesh(s, now.fence), NOC_OK);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    now.is = to;
}

#define RESTIR(rule) NOC_METHOD_RESTIR, NOC_BIAS_##rule, .temporal = true, .spatial = true
static const config configs[] = {
    { "ris, uniform", NOC_METHOD_RIS, .reuse = true },
    { "ris, power", NOC_METHOD_RIS, .reuse = true, .picker = NOC_CANDIDATES_POWER },
    { "ris, lists of 12", NOC_METHOD_RIS, .reuse = true, .list = 12 },
    { "pairwise + rays, uniform", RESTIR(PAIRWISE), .rays = true, .reuse = true },
    { "pairwise + rays, light-bvh", RESTIR(PAIRWISE), .rays = true, .reuse = true, .picker = NOC_CANDIDATES_LIGHT_BVH },
    { "pairwise + rays, influence", RESTIR(PAIRWISE), .rays = true, .reuse = true, .picker = NOC_CANDIDATES_INFLUENCE },
    { "pairwise + rays in time, lists of 12", NOC_METHOD_RESTIR, NOC_BIAS_PAIRWISE, .temporal = true, .rays = true,
      .reuse = true, .list = 12, .shadow_rays = 4 },
    { "pairwise unshadowed, uniform", RESTIR(PAIRWISE) },
    { "mis + rays, uniform", RESTIR(MIS), .rays = true, .reuse = true },
};

static void unbiased_while_edited(void **state) {
    (void)state;
    noc_scene *s = begin_street(0);
    result reference = measure_reference(s, true, pose, samples(400));
    int wrong = 0;
    for (size_t i = 0; i < NOC_COUNT(configs); i++) {
        result x = measure_runs(s, &configs[i], true, pose, samples(500));
        wrong += !agrees(configs[i].name, &x, &reference);
    }
    noc_scene_destroy(s);
    assert_int_equal(wrong, 0);
}

/* The edited street's pictures have the mean of one that was made so: against the other's reference. */
static void edited_is_as_if_made_so(void **state) {
    (void)state;
    int wrong = 0;
    for (int frame = 1; frame <= FRAMES; frame += 2) {
        street w = street_at(frame);
        noc_scene *edited = begin_street(0), *want = made(&w);
        noc_view *look_on = own_view(edited, 2, NULL);
        noc_camera cam = camera_at(frame, true);
        noc_render_params p = params_of(&configs[3], 1);
        assert_int_equal(noc_view_render(look_on, &cam, &p, NULL), NOC_OK); /* its world is that of frame 0 */
        pose(edited, frame);
        result a = measure_reference(want, false, NULL, samples(300));
        config c = { .method = NOC_METHOD_REFERENCE };
        p = params_of(&c, 5);
        p.rays = 32;
        result b = { 0 };
        for (int f = 0; f < samples(300); f++) {
            noc_camera still = camera_at(check_at[0], false);
            assert_int_equal(noc_view_render(look_on, &still, &p, NULL), NOC_OK);
            for (int at = 0; at < CHECKS; at++)
                add_picture(&b.at[at], look_on);
        }
        char name[64];
        snprintf(name, sizeof(name), "edited to frame %d, reference", frame);
        wrong += !agrees(name, &b, &a);
        close_view(look_on);
        noc_scene_destroy(edited);
        noc_scene_destroy(want);
    }
    assert_int_equal(wrong, 0);
}

static noc_image *picture(noc_view *v, const noc_render_params *p, int frame) {
    noc_camera cam = camera_at(frame, true);
    assert_int_equal(noc_view_render(v, &cam, p, NULL), NOC_OK);
    noc_image *image = noc_view_image(v);
    assert_non_null(image);
    return image;
}

/* Where lights keep their order the bits are those of a scene made so: nothing is left of what the view and its world
 * had made for what was there before. Trees and volumes are fitted, not made as they would be, so that other candidates
 * are drawn from them. */
static void same_bits_as_if_made_so(void **state) {
    (void)state;
    for (size_t i = 0; i < NOC_COUNT(configs); i++) {
        street to = street_at(5), from = to;
        if (configs[i].picker == NOC_CANDIDATES_LIGHT_BVH || configs[i].picker == NOC_CANDIDATES_INFLUENCE)
            continue;
        from.frame = 0, from.lamps = .1f, from.cars = 3, from.albedo = .9f;
        noc_scene *edited = made(&from), *want = made(&to);
        noc_view *a = own_view(edited, 1, NULL), *b = own_view(want, 3, NULL);
        noc_render_params p = params_of(&configs[i], 8), q = p;
        q.isa = NOC_ISA_SCALAR;
        noc_image_destroy(picture(a, &p, 1));
        noc_image_destroy(picture(a, &p, 1));
        now.is = from; /* its fence is there, and stays */
        pose(edited, 5);
        noc_view_reset(a);
        for (int f = 1; f <= 3; f++) {
            noc_image *x = picture(a, &p, f), *y = picture(b, &q, f);
            assert_memory_equal(x->rgb, y->rgb, sizeof(float) * 3 * W * H);
            noc_image_destroy(x);
            noc_image_destroy(y);
        }
        close_view(a);
        close_view(b);
        noc_scene_destroy(edited);
        noc_scene_destroy(want);
    }
}

/* Standard deviation of what the middle of a board shows that moves towards the camera, over its mean. */
static double noise_of_board(double step) {
    noc_scene *s = noc_scene_create(NULL);
    int m = matte(s, .5f);
    assert_int_equal(noc_scene_add_model(s, "board"), CAR);
    QUAD_OF(s, m, CAR, -4, 0, -3, 8, 0, 0, 0, 0, 6);
    for (int i = 0; i < 200; i++) /* of which few matter, so that candidates alone are noisy */
        point_light(s, -20 + .2 * i, -8 + .01 * i, 3, i % 20 ? .5f : 100);
    assert_int_equal(noc_scene_add_instance(s, &(noc_instance){ .model = CAR, .transform = { 1, [5] = 1, [10] = 1 } }),
                     0);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_view *v = own_view(s, 1, NULL);
    noc_camera cam = look(0, -12, 0, 0, 0, 0, 30);
    double sum = 0, square = 0, n = 0;
    for (int run = 0; run < 12; run++) {
        config c = {
            .method = NOC_METHOD_RESTIR, .bias = NOC_BIAS_PAIRWISE, .temporal = true, .rays = true, .reuse = true
        };
        noc_render_params p = params_of(&c, (uint32_t)run + 3);
        p.draws = 2;
        p.history = 20;
        p.reject_depth = .02;
        noc_view_reset(v);
        for (int f = 0; f < 10; f++) {
            double at[12] = { 1, 0, 0, 0, 0, 1, 0, -step * f, 0, 0, 1, 0 };
            assert_int_equal(noc_scene_set_transform(s, 0, at), NOC_OK);
            assert_int_equal(noc_scene_commit(s), NOC_OK);
            assert_int_equal(noc_view_render(v, &cam, &p, NULL), NOC_OK);
        }
        noc_image *image = noc_view_image(v);
        for (int y = H / 2 - 3; y < H / 2 + 3; y++)
            for (int x = W / 2 - 3; x < W / 2 + 3; x++) {
                double l = luma(image->rgb + 3 * (y * W + x));
                sum += l, square += l * l, n++;
            }
        noc_image_destroy(image);
    }
    close_view(v);
    noc_scene_destroy(s);
    return sqrt(square / n - sum / n * (sum / n)) / (sum / n);
}

/* What the frames before found on a surface goes with it: one that moves is no noisier than one that stands. */
static void reuse_goes_with_what_moves(void **state) {
    (void)state;
    double still = noise_of_board(0), moving = noise_of_board(.4);
    print_message("# noise of a board that stands %.3f, that moves %.3f\n", still, moving);
    assert_true(moving < 1.5 * still);
}

/* A frame that memory is refused to while it follows edits fails once, and the next one is as if nothing had been. */
static void refused_memory_is_a_status(void **state) {
    (void)state;
    noc_log *log = counting_log();
    noc_render_params p = params_of(&configs[3], 8);
    street to = street_at(5), from = street_at(4);
    noc_scene *want = made(&to);
    noc_view *b = own_view(want, 1, NULL);
    noc_image *wanted = picture(b, &p, 5);
    bool reached;
    from.traffic = to.traffic, from.globe = to.globe, from.pane = to.pane; /* lights keep their order */
    FOR_EACH_REFUSAL(reached) {
        noc_scene *s = made(&from);
        noc_view *a = own_view(s, 1, log);
        noc_camera cam = camera_at(5, true);
        now.is = from;
        noc_image_destroy(picture(a, &p, 4));
        pose(s, 5);
        noc_view_reset(a);
        begin_refusal(n, later);
        noc_status status = noc_view_render(a, &cam, &p, NULL);
        reached = end_refusal();
        if (status != NOC_OK)
            assert_refused(status, "a frame after edits");
        assert_int_equal(status != NOC_OK, reached);
        noc_view_reset(a);
        noc_image *x = picture(a, &p, 5);
        assert_memory_equal(x->rgb, wanted->rgb, sizeof(float) * 3 * W * H);
        noc_image_destroy(x);
        close_view(a);
        noc_scene_destroy(s);
    }
    noc_image_destroy(wanted);
    close_view(b);
    noc_scene_destroy(want);
    noc_log_destroy(log);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(same_bits_as_if_made_so),    cmocka_unit_test(reuse_goes_with_what_moves),
        cmocka_unit_test(refused_memory_is_a_status), cmocka_unit_test(edited_is_as_if_made_so),
        cmocka_unit_test(unbiased_while_edited),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
