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

/* Walls, gloss, all kinds of light, emitters and sky. */
static noc_scene *street(int lights) {
    noc_scene *s = noc_scene_create(NULL);
    int wall = matte(s, 0.5f);
    int wet =
        noc_scene_add_material(s, &(noc_material){ .albedo = { 0.2f, 0.15f, 0.1f }, .f0 = 0.05f, .roughness = 0.4f });
    int lamp =
        noc_scene_add_material(s, &(noc_material){
                                      .albedo = { 0.5f, 0.5f, 0.5f }, .roughness = 1, .emission = { 30, 20, 10 } });
    add_floor(s, wet, 0, 0, 0, 20);
    QUAD(s, wall, -8, 6, 0, 16, 0, 0, 0, 0, 5);
    QUAD(s, wall, -3, 1, 0, 1.5, 0.5, 0, 0, 0, 3);
    QUAD(s, lamp, 0, 5.9, 1, 2, 0, 0, 0, 0, 1);
    for (int i = 0; i < lights; i++) {
        noc_light l = { .kind = (noc_light_kind)(i % NOC_LIGHT_KIND_COUNT),
                        .inner_deg = 30,
                        .outer_deg = 60,
                        .position = { -7 + 0.31 * i, 5.7 - 0.2 * (i % 5), 1 + i % 7 },
                        .edge_u = { 0.4, 0, 0 },
                        .edge_v = { 0, 0, 0.7 },
                        .direction = { 0, -1, -0.5 },
                        .radius = 0.1,
                        .emission = { 20.f + (float)i, 25, 10 } };
        assert_true(noc_scene_add_light(s, &l) >= 0);
    }
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    return s;
}

static noc_camera above(void) { return look(0.3, -14, 9, 0, 0, 0, 60); }
static noc_camera along(void) { return look(1, -10, 4, 0, 0, 2.5, 60); }

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

/* ---- what no view may change, and what may not change a view ---- */

static noc_render_params any(int i) {
    static const noc_candidates from[] = { NOC_CANDIDATES_INFLUENCE, NOC_CANDIDATES_LISTS, NOC_CANDIDATES_LIGHT_BVH,
                                           NOC_CANDIDATES_POWER };
    noc_render_params p = with(i < 4    ? NOC_METHOD_RESTIR
                               : i < 6  ? NOC_METHOD_RIS
                               : i == 6 ? NOC_METHOD_REFERENCE
                                        : NOC_METHOD_IS,
                               from[i % 4], ALL);
    p.width = 45; /* neither a multiple of 4 nor of 16 */
    p.height = 31;
    p.jitter = true;
    p.sky = 0.05;
    p.list = 6;
    p.tail = 5;
    if (p.method == NOC_METHOD_IS || p.method == NOC_METHOD_REFERENCE || i % 4 > 1)
        p.aovs &= ~(1u << NOC_AOV_LIGHTS);
    if (p.method == NOC_METHOD_REFERENCE)
        p.aovs &= 1u << NOC_AOV_RAYS | MOMENTS;
    return p;
}
enum { KINDS = 8 };

static void assert_same_views(noc_view *a, noc_view *b, uint32_t aovs) {
    for (int aov = 0; aov < NOC_AOV_COUNT; aov++) {
        if (!(aovs >> aov & 1))
            continue;
        noc_channel *v = view(a, (noc_aov)aov), *w = view(b, (noc_aov)aov);
        assert_memory_equal(v->value, w->value, sizeof(float) * (size_t)v->width * v->height);
        noc_channel_destroy(v);
        noc_channel_destroy(w);
    }
}

static void same_on_every_instruction_set_and_number_of_threads(void **state) {
    (void)state;
    noc_scene *s = street(30);
    noc_camera c = along();
    for (int i = 0; i < KINDS; i++) {
        noc_render_params p = any(i), forced = p;
        noc_view *a = rendered(s, &c, &p, 3, 1), *b = rendered(s, &c, &p, 3, 3);
        assert_same_views(a, b, p.aovs);
        close_view(b);
        for (forced.isa = NOC_ISA_SCALAR; forced.isa < NOC_ISA_COUNT; forced.isa++) {
            if (!noc_isa_runs(forced.isa))
                continue;
            b = rendered(s, &c, &forced, 3, 2);
            assert_same_views(a, b, p.aovs);
            close_view(b);
        }
        close_view(a);
    }
    noc_scene_destroy(s);
}

static void the_picture_is_the_same(void **state) {
    (void)state;
    noc_scene *s = street(30);
    noc_camera c = along();
    for (int i = 0; i < KINDS; i++) {
        noc_render_params p = any(i), without = p;
        without.aovs = 0;
        noc_view *a = rendered(s, &c, &without, 4, 2), *b = own_view(s, 0, NULL);
        noc_image *x = noc_view_image(a);
        for (int frame = 0; frame < 4; frame++) /* asked for in turn */
            assert_int_equal(noc_view_render(b, &c, frame % 2 ? &p : &without, NULL), NOC_OK);
        noc_image *y = noc_view_image(b);
        assert_memory_equal(x->rgb, y->rgb, sizeof(float) * 3 * (size_t)x->width * x->height);
        noc_image_destroy(x);
        noc_image_destroy(y);
        close_view(a);
        close_view(b);
    }
    noc_scene_destroy(s);
}

static void scenes_of_nothing(void **state) {
    (void)state;
    noc_camera c = along();
    for (int kind = 0; kind < 2; kind++) {
        noc_scene *s = noc_scene_create(NULL);
        if (kind)
            add_floor(s, matte(s, 0.5f), 0, 0, 0, 20);
        assert_int_equal(noc_scene_commit(s), NOC_OK);
        for (int i = 0; i < KINDS; i++) {
            noc_render_params p = any(i);
            noc_view *r = rendered(s, &c, &p, 2, 2);
            for (int aov = 0; aov < NOC_AOV_COUNT; aov++)
                if (p.aovs >> aov & 1)
                    noc_channel_destroy(view(r, (noc_aov)aov));
            close_view(r);
        }
        noc_scene_destroy(s);
    }
}

/* ---- errors ---- */

static void drop(void *user, noc_log_level level, const char *text) { (void)user, (void)level, (void)text; }

static void wrong_requests(void **state) {
    (void)state;
    noc_log *log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_ERROR, .message = drop });
    noc_scene *s = street(3);
    noc_camera c = along();
    noc_view *r = own_view(s, 0, log);
    static const struct {
        noc_method method;
        noc_candidates candidates;
        uint32_t aovs;
        const char *says;
    } bad[] = {
        { NOC_METHOD_RIS, NOC_CANDIDATES_UNIFORM, 1u << NOC_AOV_LIGHTS, "\"lights\": only" },
        { NOC_METHOD_RESTIR, NOC_CANDIDATES_LIGHT_BVH, 1u << NOC_AOV_LIGHTS, "\"lights\": only" },
        { NOC_METHOD_IS, NOC_CANDIDATES_INFLUENCE, 1u << NOC_AOV_LIGHTS, "\"lights\": only" },
        { NOC_METHOD_REFERENCE, NOC_CANDIDATES_INFLUENCE, 1u << NOC_AOV_DENSITY, "\"density\": the reference" },
        { NOC_METHOD_REFERENCE, NOC_CANDIDATES_INFLUENCE, 1u << NOC_AOV_WEIGHT, "\"weight\": the reference" },
        { NOC_METHOD_RIS, NOC_CANDIDATES_INFLUENCE, 1u << NOC_AOV_COUNT, "aovs is 0x" },
    };
    for (size_t i = 0; i < NOC_COUNT(bad); i++) {
        noc_render_params p = with(bad[i].method, bad[i].candidates, bad[i].aovs);
        assert_int_equal(noc_render_check(&p, log), NOC_ERR_ARGUMENT);
        assert_int_equal(noc_view_render(r, &c, &p, NULL), NOC_ERR_ARGUMENT);
        assert_non_null(strstr(noc_log_last_error(log), bad[i].says));
    }
    noc_render_params p = with(NOC_METHOD_RIS, NOC_CANDIDATES_INFLUENCE, 1u << NOC_AOV_ERROR);
    p.accumulate = false;
    assert_int_equal(noc_view_render(r, &c, &p, NULL), NOC_ERR_ARGUMENT);
    assert_non_null(strstr(noc_log_last_error(log), "\"error\": frames must be accumulated"));
    assert_null(noc_view_aov(r, NOC_AOV_LIGHT)); /* before the first frame */
    p.aovs = 1u << NOC_AOV_LIGHT;
    assert_int_equal(noc_view_render(r, &c, &p, NULL), NOC_OK);
    assert_null(noc_view_aov(r, NOC_AOV_WEIGHT));
    assert_non_null(strstr(noc_log_last_error(log), "did not keep the view \"weight\""));
    assert_null(noc_view_aov(r, NOC_AOV_COUNT));
    assert_null(noc_view_aov(r, (noc_aov)-1));
    noc_channel_destroy(view(r, NOC_AOV_LIGHT));
    noc_view_reset(r);
    assert_null(noc_view_aov(r, NOC_AOV_LIGHT));
    assert_string_equal(noc_aov_name((noc_aov)99), "unknown");
    close_view(r);
    noc_scene_destroy(s);
    noc_log_destroy(log);
}

static bool stop_late(void *user, const char *what, double done) {
    (void)what, (void)done;
    return --*(int *)user > 0;
}

static uint64_t memory_of(const noc_view *r) {
    noc_frame_stats stats;
    noc_view_get_stats(r, &stats);
    return stats.memory_bytes;
}

/* What a dropped frame had gathered is forgotten with it, and what the last complete one kept stays, whichever views
 * the dropped one asked for. */
static void cancelled_frames(void **state) {
    (void)state;
    noc_scene *s = street(30);
    noc_camera c = along();
    for (int kind = 0; kind < 2; kind++) {
        noc_render_params p = any(kind);
        p.width = 160;
        p.height = 96;
        noc_view *a = rendered(s, &c, &p, 3, 1), *b = rendered(s, &c, &p, 3, 1);
        noc_render_params other = p;
        for (int i = 0; i < 9; i++) {
            int n = 1 + i / 3 * 20;
            other.aovs = i % 3 == 0 ? p.aovs : i % 3 == 1 ? 0 : 1u << NOC_AOV_RAYS | 1u << NOC_AOV_DEPTH;
            assert_int_equal(noc_view_render(b, &c, &other, &(noc_progress){ stop_late, &n }), NOC_ERR_CANCELLED);
            assert_same_views(a, b, p.aovs);
        }
        assert_int_equal(noc_view_render(a, &c, &p, NULL), NOC_OK);
        assert_int_equal(noc_view_render(b, &c, &other, NULL), NOC_OK);
        assert_true(memory_of(a) > memory_of(b)); /* which has dropped the others */
        close_view(a);
        close_view(b);
    }
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
        cmocka_unit_test(same_on_every_instruction_set_and_number_of_threads),
        cmocka_unit_test(the_picture_is_the_same),
        cmocka_unit_test(scenes_of_nothing),
        cmocka_unit_test(wrong_requests),
        cmocka_unit_test(cancelled_frames),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
