/* The renderer's contract: errors, empty scenes, cancelling, what is kept from frame to frame, the same picture on
 * every path and number of threads. */
#include "rooms.h"
#include "../own_view.h"

#include <nocturne/option.h>

static noc_scene *small_street(int lights, bool floor) {
    noc_scene *s = noc_scene_create(NULL);
    int wall = matte(s, 0.5f);
    int wet =
        noc_scene_add_material(s, &(noc_material){ .albedo = { 0.2f, 0.15f, 0.1f }, .f0 = 0.05f, .roughness = 0.4f });
    if (floor) {
        add_floor(s, wet, 0, 0, 0, 20);
        QUAD(s, wall, -8, 6, 0, 16, 0, 0, 0, 0, 8);
        for (int i = 0; i < 3; i++)
            QUAD(s, wall, -5 + 4 * i, 1, 0, 1.5, 0.5, 0, 0, 0, 3);
    }
    for (int i = 0; i < lights; i++) {
        noc_light l = crowd_light(i, 5.9);
        assert_true(noc_scene_add_light(s, &l) >= 0);
    }
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    return s;
}

static void drop(void *user, noc_log_level level, const char *text) { (void)user, (void)level, (void)text; }

static noc_camera view(double t) { return look(1 + t, -10, 4, 0.5 * t, 0, 2, 60); }

static bool same(const noc_image *a, const noc_image *b) {
    size_t n = (size_t)a->width * a->height;
    return a->width == b->width && a->height == b->height && !memcmp(a->rgb, b->rgb, n * 3 * sizeof(float)) &&
           !memcmp(a->emitter, b->emitter, n);
}

static bool all_finite(const noc_image *a) {
    for (size_t i = 0; i < (size_t)a->width * a->height * 3; i++)
        if (!isfinite(a->rgb[i]) || a->rgb[i] < 0)
            return false;
    return true;
}

static double brightness(const noc_image *a) {
    double sum = 0;
    size_t n = (size_t)a->width * a->height;
    for (size_t i = 0; i < n; i++)
        sum += luma(a->rgb + 3 * i);
    return sum / (double)n;
}

/* Four frames under a moving camera. */
static noc_image *moving(const noc_scene *s, const noc_render_params *p, int threads) {
    noc_view *r = own_view(s, threads, NULL);
    for (int i = 0; i < 4; i++) {
        noc_camera c = view(i < 3 ? 0.2 * i : 0.4);
        assert_int_equal(noc_view_render(r, &c, p, NULL), NOC_OK);
    }
    noc_image *image = noc_view_image(r);
    assert_true(all_finite(image));
    close_view(r);
    return image;
}

static noc_render_params variant(int i) {
    noc_render_params p = measure(45, 31, NOC_METHOD_RESTIR); /* neither a multiple of 4 nor of 16 */
    p.jitter = true;
    p.sky = 0.05;
    p.draws = 8;
    p.candidates = i < 11 ? NOC_CANDIDATES_UNIFORM : NOC_CANDIDATES_LISTS;
    p.list = 6; /* of 40 lights */
    p.tail = 5;
    switch (i) {
    case 0:
        p.method = NOC_METHOD_REFERENCE;
        p.rays = 7;
        break;
    case 1:
        p.method = NOC_METHOD_REFERENCE;
        p.rays = 100;
        break; /* more rays than lights */
    case 2: p.method = NOC_METHOD_IS; break;
    case 3: p.method = NOC_METHOD_RIS; break;
    case 4: p.bias = NOC_BIAS_BIASED; break;
    case 5:
        p.bias = NOC_BIAS_MIS;
        p.passes = 3;
        break;
    case 6:
        p.bias = NOC_BIAS_PAIRWISE;
        p.passes = 2;
        p.neighbours = 20;
        p.radius = 30;
        break;
    case 7:
        p.visibility_reuse = false;
        p.bias_rays = false;
        break;
    case 8: p.final_ray = false; break;
    case 9: p.temporal = false; break;
    case 10: p.spatial = false; break;
    case 11: p.method = NOC_METHOD_RIS; break;
    case 12: break; /* restir from lists */
    case 13: p.candidates = NOC_CANDIDATES_POWER; break;
    case 14: p.candidates = NOC_CANDIDATES_INFLUENCE; break;
    case 15: p.candidates = NOC_CANDIDATES_LIGHT_BVH; break;
    case 16:
        p.method = NOC_METHOD_RIS;
        p.shadow_rays = 8;
        p.learn = false;
        break;
    }
    return p;
}
enum { VARIANTS = 17 };

/* Whole frames on every instruction set of this machine, each asked for by its name. */
static void instruction_sets_agree(void **state) {
    (void)state;
    noc_scene *s = small_street(40, true);
    for (int i = 0; i < VARIANTS; i++) {
        noc_render_params p = variant(i);
        p.isa = NOC_ISA_SCALAR;
        noc_image *a = moving(s, &p, 2);
        assert_true(brightness(a) > 0.01);
        for (p.isa = NOC_ISA_BASELINE; p.isa < NOC_ISA_COUNT; p.isa++) {
            if (!noc_isa_runs(p.isa))
                continue;
            noc_image *b = moving(s, &p, 2);
            if (!same(a, b))
                fail_msg("%s differs from scalar in variant %d", noc_isa_name(p.isa), i);
            noc_image_destroy(b);
        }
        noc_image_destroy(a);
    }
    for (noc_isa isa = NOC_ISA_BASELINE; isa < NOC_ISA_COUNT; isa++)
        print_message("# %s %s\n", noc_isa_name(isa),
                      noc_isa_runs(isa) ? "compared with scalar" : "not compared: this processor has none");
    noc_scene_destroy(s);
}

/* The code that a frame ran, "" where it was refused; *error: of the log. */
static const char *code_of(const noc_scene *s, noc_isa isa, noc_status *status, char error[200]) {
    static char ran[40];
    noc_render_params p = measure(8, 8, NOC_METHOD_IS);
    noc_log *log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_ERROR, .message = drop });
    noc_view *r = own_view(s, 0, log);
    noc_camera c = view(0);
    noc_frame_stats stats;
    p.isa = isa;
    *status = noc_view_render(r, &c, &p, NULL);
    noc_view_get_stats(r, &stats);
    snprintf(ran, sizeof(ran), "%s", *status ? "" : stats.path);
    snprintf(error, 200, "%s", noc_log_last_error(log));
    close_view(r);
    noc_log_destroy(log);
    return ran;
}

static void an_instruction_set_is_forced(void **state) {
    (void)state;
    static const char *const code[] = { NULL, "scalar", "baseline x4", "avx2 x8", "avx512 x16" };
    noc_scene *s = small_street(5, true);
    noc_status status;
    noc_isa widest = NOC_ISA_SCALAR;
    char error[200], *outer = noc_strdup(getenv("NOCTURNE_ISA"));
    for (noc_isa isa = NOC_ISA_SCALAR; isa < NOC_ISA_COUNT; isa++) {
        bool here = noc_isa_runs(isa);
        widest = here ? isa : widest;
        for (int by_name = 0; by_name < 2; by_name++) {
            setenv("NOCTURNE_ISA", by_name ? noc_isa_name(isa) : "scalar", 1); /* what a frame says goes first */
            assert_string_equal(code_of(s, by_name ? NOC_ISA_AUTO : isa, &status, error), here ? code[isa] : "");
            assert_int_equal(status, here ? NOC_OK : NOC_ERR_UNSUPPORTED);
            assert_true(here || (strstr(error, noc_isa_name(isa)) && strstr(error, "it runs scalar")));
        }
    }
    setenv("NOCTURNE_ISA", "mmx", 1);
    assert_string_equal(code_of(s, NOC_ISA_AUTO, &status, error), "");
    assert_int_equal(status, NOC_ERR_ARGUMENT);
    assert_string_equal(error,
                        "NOCTURNE_ISA: \"mmx\" is no instruction set, must be auto, scalar, baseline, avx2 or avx512");
    unsetenv("NOCTURNE_ISA");
    assert_string_equal(code_of(s, NOC_ISA_AUTO, &status, error), code[widest]);
    if (outer)
        setenv("NOCTURNE_ISA", outer, 1);
    free(outer);
    noc_scene_destroy(s);
}

static void threads_and_seeds(void **state) {
    (void)state;
    noc_scene *s = small_street(40, true);
    for (int i = 0; i < VARIANTS; i++) {
        noc_render_params p = variant(i);
        noc_image *a = moving(s, &p, 1), *b = moving(s, &p, 2), *c = moving(s, &p, 3);
        p.seed++;
        noc_image *d = moving(s, &p, 2);
        assert_true(same(a, b) && same(b, c));
        assert_false(same(a, d));
        noc_image_destroy(a);
        noc_image_destroy(b);
        noc_image_destroy(c);
        noc_image_destroy(d);
    }
    noc_scene_destroy(s);
}

static void empty_scenes(void **state) {
    (void)state;
    for (int i = 0; i < VARIANTS; i++)
        for (int kind = 0; kind < 4; kind++) {
            noc_scene *s = small_street(kind & 1, kind >> 1); /* no or one light, no or some surfaces */
            noc_render_params p = variant(i);
            noc_image *image = moving(s, &p, 2);
            assert_true(brightness(image) > 0); /* the sky */
            noc_image_destroy(image);
            p.sky = 0;
            image = moving(s, &p, 2);
            if (!(kind & 1))
                assert_true(brightness(image) == 0);
            noc_image_destroy(image);
            noc_scene_destroy(s);
        }
    noc_scene *s = noc_scene_create(NULL); /* nothing at all, not even a material */
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_render_params p = variant(4);
    noc_image *image = moving(s, &p, 2);
    assert_true(brightness(image) > 0);
    noc_image_destroy(image);
    noc_scene_destroy(s);
}

/* Lamps brighter than the sun that touch, hold or lie in what they light, slivers, a camera in a wall: not one number
 * that is not finite reaches the picture. */
static void hostile_scenes(void **state) {
    (void)state;
    noc_scene *s = noc_scene_create(NULL);
    int mirror = noc_scene_add_material(s, &(noc_material){ .albedo = { 1, 1, 1 }, .f0 = 1, .roughness = 0.05f });
    add_floor(s, mirror, 0, 0, 0, 20);
    QUAD(s, mirror, -20, 3, -1, 40, 0, 0, 0, 0, 1e-5);
    QUAD(s, mirror, 1, -10, 3.5, 1e-3, 0, 0, 0, 0, 9); /* through the camera's eye */
    for (int i = 0; i < 25; i++) {
        noc_light l = { .kind = (noc_light_kind)(i % NOC_LIGHT_KIND_COUNT),
                        .inner_deg = 30,
                        .outer_deg = 60,
                        .position = { -2 + 0.2 * i, 0.1 * (i % 4), i < 10 ? 0 : 1e-4 * i },
                        .edge_u = { i % 3 ? 1e-4 : 3, 0, 0 },
                        .edge_v = { 0, 2, i % 2 },
                        .direction = { 0, 0, -1 },
                        .radius = i % 2 ? 1e-4 : 4,
                        .emission = { 1e12f, 1e-30f, 1e12f } };
        assert_true(noc_scene_add_light(s, &l) >= 0);
    }
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    for (int i = 0; i < VARIANTS; i++) {
        noc_render_params p = variant(i);
        noc_image_destroy(moving(s, &p, 2)); /* checks every number */
    }
    noc_scene_destroy(s);
}

/* ---- errors ---- */

static void wrong_arguments(void **state) {
    (void)state;
    noc_log *log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_ERROR, .message = drop });
    noc_scene *s = small_street(3, true), *raw = noc_scene_create(NULL);
    assert_null(own_view(raw, 0, log));
    assert_non_null(strstr(noc_log_last_error(log), "not committed"));
    assert_null(noc_device_create(&(noc_device_params){ .backend = (noc_backend_id)17 }, log));
    assert_non_null(strstr(noc_log_last_error(log), "device: backend is 17, must be in 0..2"));
    assert_null(own_view(s, -3, log));
    noc_view *r = own_view(s, 0, log);
    noc_camera c = view(0);
    const struct {
        const char *name;
        size_t at;
        bool real;
    } fields[] = {
        { "width", offsetof(noc_render_params, width) },
        { "height", offsetof(noc_render_params, height) },
        { "draws", offsetof(noc_render_params, draws) },
        { "rays", offsetof(noc_render_params, rays) },
        { "neighbours", offsetof(noc_render_params, neighbours) },
        { "passes", offsetof(noc_render_params, passes) },
        { "radius", offsetof(noc_render_params, radius), true },
        { "history", offsetof(noc_render_params, history), true },
        { "reject_normal", offsetof(noc_render_params, reject_normal), true },
        { "reject_depth", offsetof(noc_render_params, reject_depth), true },
        { "sky", offsetof(noc_render_params, sky), true },
        { "influence", offsetof(noc_render_params, influence), true },
        { "uniform_every", offsetof(noc_render_params, uniform_every) },
        { "influence_cluster", offsetof(noc_render_params, influence_cluster) },
    };
    for (size_t i = 0; i < NOC_COUNT(fields); i++) {
        noc_render_params p = noc_render_default_params();
        if (fields[i].real)
            *(double *)((char *)&p + fields[i].at) = i & 1 ? NAN : -1e9;
        else
            *(int *)((char *)&p + fields[i].at) = i & 1 ? -1 : 1 << 30;
        assert_int_equal(noc_view_render(r, &c, &p, NULL), NOC_ERR_ARGUMENT);
        assert_non_null(strstr(noc_log_last_error(log), fields[i].name));
    }
    noc_render_params p = measure(16, 16, (noc_method)9);
    assert_int_equal(noc_view_render(r, &c, &p, NULL), NOC_ERR_ARGUMENT);
    p = measure(16, 16, NOC_METHOD_RIS);
    noc_camera bad[] = { c, c, c, c, c };
    bad[0].eye[1] = NAN;
    bad[1].fov_deg = 180;
    memcpy(bad[2].target, bad[2].eye, sizeof(bad[2].eye));
    memset(bad[3].up, 0, sizeof(bad[3].up));
    bad[4].target[0] = 1e30;
    for (size_t i = 0; i < NOC_COUNT(bad); i++)
        assert_int_equal(noc_view_render(r, &bad[i], &p, NULL), NOC_ERR_ARGUMENT);
    assert_null(noc_view_image(r));          /* nothing has been rendered */
    p.width = p.height = NOC_IMAGE_MAX_SIDE; /* 170 GB and more: refused before anything is allocated */
    if ((uint64_t)sysconf(_SC_PHYS_PAGES) * (uint64_t)sysconf(_SC_PAGESIZE) < (uint64_t)150e9) {
        assert_int_equal(noc_view_render(r, &c, &p, NULL), NOC_ERR_MEMORY);
        assert_non_null(strstr(noc_log_last_error(log), "GB"));
    }
    p = measure(16, 16, NOC_METHOD_RIS);
    assert_int_equal(noc_view_render(r, &c, &p, NULL), NOC_OK); /* and it still works */
    noc_camera down = look(0, 0, 9, 0, 0, 0, 60);               /* along up */
    assert_int_equal(noc_view_render(r, &down, &p, NULL), NOC_OK);
    close_view(r);
    close_view(NULL);
    noc_scene_destroy(s);
    noc_scene_destroy(raw);
    noc_log_destroy(log);
}

/* ---- what is kept ---- */

/* A value that is no choice is told as it was given; no params are the defaults. */
static void negative_choices_and_no_params(void **state) {
    (void)state;
    noc_log *log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_ERROR, .message = drop });
    noc_scene *s = small_street(3, true);
    noc_view *r = own_view(s, 0, log);
    noc_camera c = view(0);
    static const struct {
        const char *says;
        size_t at;
    } fields[] = {
        { "method is -1,", offsetof(noc_render_params, method) },
        { "candidates is -1,", offsetof(noc_render_params, candidates) },
        { "bias is -1,", offsetof(noc_render_params, bias) },
        { "isa is -1,", offsetof(noc_render_params, isa) },
    };
    for (size_t i = 0; i < NOC_COUNT(fields); i++) {
        noc_render_params p = noc_render_default_params();
        memcpy((char *)&p + fields[i].at, &(int){ -1 }, sizeof(int));
        assert_int_equal(noc_view_render(r, &c, &p, NULL), NOC_ERR_ARGUMENT);
        assert_non_null(strstr(noc_log_last_error(log), fields[i].says));
    }
    assert_int_equal(noc_view_render(r, &c, NULL, NULL), NOC_OK);
    noc_image *image = noc_view_image(r);
    assert_int_equal(image->width, noc_render_default_params().width);
    assert_int_equal(image->height, noc_render_default_params().height);
    noc_image_destroy(image);
    close_view(r);
    noc_scene_destroy(s);
    noc_log_destroy(log);
}

static bool count_down(void *user, const char *what, double done) {
    (void)what;
    assert_true(done >= 0 && done <= 1);
    return --*(int *)user > 0;
}

/* What emitters add to the mean, and the share of the frames that saw one, apart from the rest. */
static void coverage_of_emitters(void **state) {
    noc_scene *s = noc_scene_create(NULL);
    int lamp = noc_scene_add_material(s, &(noc_material){ .roughness = 1, .emission = { 30, 20, 10 } });
    QUAD(s, lamp, 0, 0, 0, 20, 0, 0, 0, 20, 0); /* its edges run through pixels */
    add_floor(s, matte(s, 0.5f), 0, 0, -0.01, 20);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_render_params p = measure(24, 16, NOC_METHOD_RIS);
    p.jitter = true;
    noc_camera c = look(0, 0, 30, 0, 0.001, 0, 60);
    noc_image *image = render(s, &c, &p, 32);
    int edges = 0, inside = 0;
    double covered = 0;
    for (int i = 0; i < 24 * 16; i++) {
        const float *v = image->coverage + 4 * i;
        assert_true(v[3] >= 0 && v[3] <= 1);
        for (int k = 0; k < 3; k++) {
            assert_true(fabs(v[k] - v[3] * (30 - 10 * k)) < 1e-3);
            assert_true(v[3] == 0 || v[3] == 1 || image->rgb[3 * i + k] >= v[k] - 1e-3);
        }
        edges += v[3] > 0 && v[3] < 1;
        inside += v[3] == 1;
        covered += v[3];
    }
    assert_true(edges >= 8 && inside >= 40);
    /* From 30 m under 60 degrees the picture is 34.64 m high, so a pixel 2.165 m wide; the part of the quad in it
     * is 17.32 x 20 m. */
    assert_true(fabs(covered - 17.32 * 20 / (2.165 * 2.165)) < 1);
    noc_image_destroy(image);
    noc_scene_destroy(s);
}

static void count_message(void *user, noc_log_level level, const char *text) { ++*(int *)user; }

static void cancelled_frames(void **state) {
    (void)state;
    noc_scene *s = small_street(40, true);
    noc_render_params p = measure(160, 96, NOC_METHOD_RESTIR);
    p.jitter = true; /* each frame sees other edges of emitters */
    noc_camera c = view(0);
    int left = 3, messages = 0;
    noc_log *log = noc_log_create(&(noc_log_params){ .message = count_message, .user = &messages });
    noc_view *r = own_view(s, 2, log);
    noc_progress stop = { count_down, &left };
    assert_int_equal(noc_view_render(r, &c, &p, &stop), NOC_ERR_CANCELLED);
    assert_string_equal(noc_log_last_error(log), "render: cancelled"); /* the reason, though nobody is alarmed */
    assert_int_equal(messages, 0);
    assert_null(noc_view_image(r)); /* not one frame yet */
    for (int i = 0; i < 3; i++)
        assert_int_equal(noc_view_render(r, &c, &p, NULL), NOC_OK);
    noc_image *before = noc_view_image(r);
    for (int i = 1; i < 60; i++) { /* in every stage */
        left = i;
        noc_status status = noc_view_render(r, &c, &p, &stop);
        if (status == NOC_OK)
            break;
        assert_int_equal(status, NOC_ERR_CANCELLED);
        noc_image *after = noc_view_image(r);
        assert_true(same(before, after));
        noc_image_destroy(after);
        noc_frame_stats stats;
        noc_view_get_stats(r, &stats);
        assert_int_equal(stats.frames, 3);
    }
    assert_int_equal(noc_view_render(r, &c, &p, NULL), NOC_OK);
    noc_image_destroy(before);
    close_view(r);
    noc_log_destroy(log);
    noc_scene_destroy(s);
}

/* A small picture may leave the calling thread no tile, yet it can be cancelled; what was reused is reused by the next
 * frame. */
static void history_outlives_a_cancelled_frame(void **state) {
    (void)state;
    noc_scene *s = small_street(40, true);
    noc_render_params p = measure(16, 16, NOC_METHOD_RESTIR);
    p.candidates = NOC_CANDIDATES_LISTS;
    p.spatial = false;
    p.history = 4;
    p.aovs = 1u << NOC_AOV_CONFIDENCE;
    noc_camera c = view(0);
    noc_view *r = own_view(s, 4, NULL);
    for (int i = 0; i < 3; i++)
        assert_int_equal(noc_view_render(r, &c, &p, NULL), NOC_OK);
    for (int i = 0; i < 20; i++) {
        int left = 1;
        noc_progress stop = { count_down, &left };
        assert_int_equal(noc_view_render(r, &c, &p, &stop), NOC_ERR_CANCELLED);
    }
    assert_int_equal(noc_view_render(r, &c, &p, NULL), NOC_OK);
    noc_channel *m = noc_view_aov(r, NOC_AOV_CONFIDENCE);
    float most = 0;
    for (int i = 0; i < 16 * 16; i++)
        most = NOC_MAX(most, m->value[i]);
    assert_true(most == 4.f * (float)p.draws);
    noc_channel_destroy(m);
    close_view(r);
    noc_scene_destroy(s);
}

static uint64_t frames_of(noc_view *r) {
    noc_frame_stats stats;
    noc_view_get_stats(r, &stats);
    return stats.frames;
}

static void frames_and_resets(void **state) {
    (void)state;
    noc_scene *s = small_street(40, true);
    noc_render_params p = measure(32, 32, NOC_METHOD_RESTIR);
    noc_camera c = view(0), d = view(1);
    noc_view *r = own_view(s, 0, NULL);
    assert_int_equal(noc_view_render(r, &c, &p, NULL), NOC_OK);
    noc_image *first = noc_view_image(r);
    assert_int_equal(noc_view_render(r, &c, &p, NULL), NOC_OK);
    assert_int_equal(frames_of(r), 2);
    assert_int_equal(noc_view_render(r, &d, &p, NULL), NOC_OK); /* moved: the mean starts anew */
    assert_int_equal(frames_of(r), 1);
    assert_int_equal(noc_view_render(r, &d, &p, NULL), NOC_OK);
    assert_int_equal(frames_of(r), 2);
    p.radius = 7;
    assert_int_equal(noc_view_render(r, &d, &p, NULL), NOC_OK); /* other parameters too */
    assert_int_equal(frames_of(r), 1);
    p.radius = measure(1, 1, NOC_METHOD_RESTIR).radius;
    noc_view_reset(r);
    assert_null(noc_view_image(r));
    assert_int_equal(noc_view_render(r, &c, &p, NULL), NOC_OK);
    noc_image *again = noc_view_image(r);
    assert_true(same(first, again)); /* a reset forgets everything */
    noc_frame_stats stats;
    noc_view_get_stats(r, &stats);
    assert_int_equal(stats.rays_primary, 32 * 32);
    assert_true(stats.rays_shadow > 0 && stats.memory_bytes > 0 && stats.wall_seconds > 0);
    assert_true(stats.picture_bytes > 0 && stats.picture_bytes % (8 * 8) == 0 &&
                stats.structure_bytes > 0); /* blocks */
    assert_true(stats.picture_bytes + stats.structure_bytes + stats.learned_bytes <= stats.memory_bytes);
    noc_trace_floor floor = { 0 };
    assert_int_equal(noc_view_trace_floor(r, &c, &p, NULL, &floor), NOC_OK);
    assert_true(floor.wall_seconds > 0 && floor.cpu_seconds > 0);
    assert_int_equal(frames_of(r), 2); /* it was a frame like any other */
    noc_image_destroy(first);
    noc_image_destroy(again);
    close_view(r);
    noc_scene_destroy(s);
}

static void emitter_mask(void **state) {
    (void)state;
    noc_scene *s = noc_scene_create(NULL);
    noc_light l = { .kind = NOC_LIGHT_PARALLELOGRAM,
                    .position = { -0.5, 0, -0.5 },
                    .edge_u = { 1, 0, 0 },
                    .edge_v = { 0, 0, 1 },
                    .emission = { 5, 5, 5 } }; /* faces -y, and fills a tenth of the picture */
    assert_true(noc_scene_add_light(s, &l) >= 0);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_render_params p = measure(40, 40, NOC_METHOD_RIS);
    for (int back = 0; back < 2; back++) {
        noc_camera c = look(0, back ? 5 : -5, 0, 0, 0, 0, 35);
        noc_image *image = render(s, &c, &p, 1);
        int lit = 0, masked = 0;
        for (int y = 0; y < 40; y++)
            for (int x = 0; x < 40; x++) {
                bool on = image->rgb[3 * (y * 40 + x)] > 0, near = false;
                for (int j = -1; j <= 1; j++)
                    for (int i = -1; i <= 1; i++)
                        if (x + i >= 0 && x + i < 40 && y + j >= 0 && y + j < 40)
                            near |= image->rgb[3 * ((y + j) * 40 + x + i)] > 0;
                lit += on;
                masked += image->emitter[y * 40 + x];
                assert_int_equal(image->emitter[y * 40 + x], near);
                assert_true(!on || image->rgb[3 * (y * 40 + x)] == 5);
            }
        assert_true(back ? lit == 0 && masked == 0 : lit > 100 && masked > lit);
        noc_image_destroy(image);
    }
    p.emitters = false;
    noc_camera c = look(0, -5, 0, 0, 0, 0, 35);
    noc_image *image = render(s, &c, &p, 1);
    assert_true(brightness(image) == 0);
    noc_image_destroy(image);
    noc_scene_destroy(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(instruction_sets_agree), cmocka_unit_test(an_instruction_set_is_forced),
        cmocka_unit_test(threads_and_seeds),      cmocka_unit_test(empty_scenes),
        cmocka_unit_test(coverage_of_emitters),   cmocka_unit_test(wrong_arguments),
        cmocka_unit_test(cancelled_frames),       cmocka_unit_test(history_outlives_a_cancelled_frame),
        cmocka_unit_test(frames_and_resets),      cmocka_unit_test(emitter_mask),
        cmocka_unit_test(hostile_scenes),         cmocka_unit_test(negative_choices_and_no_params),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
