/* Smoothed stills (nocturne/smooth.h). */
#include "views.h"
#include "../memory.h"

#include <nocturne/smooth.h>
#include <string.h>

enum { WIDE = 72, HIGH = 44, PIXELS = WIDE * HIGH };

/* A floor and a wall under lamps, and posts that throw shadows; a lamp of the far row is seen. */
static noc_scene *square(void) {
    noc_scene *s = noc_scene_create(NULL);
    int grey = matte(s, 0.4f),
        road =
            noc_scene_add_material(s,
                                   &(noc_material){ .albedo = { 0.1f, 0.1f, 0.1f }, .f0 = 0.04f, .roughness = 0.8f });
    add_floor(s, road, 0, 0, 0, 30);
    QUAD(s, grey, -12, 8, 0, 24, 0, 0, 0, 0, 9);
    for (int i = 0; i < 4; i++)
        QUAD(s, grey, -6 + 4 * i, 2 + i % 2, 0, 0.6, 0, 0, 0, 0, 2.5);
    for (int i = 0; i < 24; i++) {
        noc_light l = { .kind = NOC_LIGHT_SPHERE,
                        .position = { -10 + 20 * (i % 8) / 7., -4 + 5. * (i / 8), 4.5 },
                        .radius = 0.15f,
                        .emission = { 900, 700 - 20 * (float)i, 400 } };
        assert_true(noc_scene_add_light(s, &l) >= 0);
    }
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    return s;
}

static noc_render_params still(noc_method method, int rays) {
    noc_render_params p = with(method, NOC_CANDIDATES_LISTS, 0);
    p.width = WIDE;
    p.height = HIGH;
    p.shadow_rays = rays;
    p.aovs = noc_still_aovs(&p);
    return p;
}

static noc_image *converged(const noc_scene *s, const noc_camera *c) {
    noc_render_params p = still(NOC_METHOD_RIS, 8);
    p.seed = 99;
    noc_view *v = rendered(s, c, &p, 100, 0);
    noc_image *image = noc_view_image(v);
    close_view(v);
    return image;
}

typedef struct figures {
    double relmse, mean; /* of luminance where no emitter is seen; over that of the reference */
} figures;

static figures compared(const noc_image *image, const noc_image *reference) {
    double sum = 0, of[2] = { 0 };
    int n = 0;
    for (int i = 0; i < PIXELS; i++) {
        double x = luma(image->rgb + 3 * i), r = luma(reference->rgb + 3 * i);
        if (reference->emitter[i])
            continue;
        sum += (x - r) * (x - r) / (r * r + .01);
        of[0] += x;
        of[1] += r;
        n++;
    }
    return (figures){ sum / n, of[0] / of[1] };
}

/* The picture of so many frames, as it is and smoothed. */
static void make(const noc_scene *s, const noc_camera *c, const noc_render_params *p, int frames, noc_image *out[2]) {
    noc_view *v = rendered(s, c, p, frames, 0);
    out[0] = noc_view_image(v);
    out[1] = noc_view_smoothed(v);
    assert_true(out[0] && out[1]);
    close_view(v);
}

/* Few rays leave less than half of their error, many at most what they had, and no light is made or lost. */
static void has_less_noise(void **state) {
    static const struct {
        const char *name;
        noc_method method;
        int frames, rays;
        double most, bias; /* error over that of the picture as it is; of the mean */
    } rows[] = {
        { "ris", NOC_METHOD_RIS, 1, 1, .5, .02 }, { "ris", NOC_METHOD_RIS, 4, 1, .5, .01 },
        { "ris", NOC_METHOD_RIS, 16, 1, 1, .01 }, { "restir", NOC_METHOD_RESTIR, 4, 1, .6, .02 },
        { "is", NOC_METHOD_IS, 4, 1, .5, .02 },   { "ris", NOC_METHOD_RIS, 64, 8, 1.02, .003 },
    };
    noc_scene *s = square();
    noc_camera c = along();
    noc_image *reference = converged(s, &c), *of[2];
    (void)state;
    for (size_t i = 0; i < NOC_COUNT(rows); i++) {
        noc_render_params p = still(rows[i].method, rows[i].rays);
        make(s, &c, &p, rows[i].frames, of);
        figures raw = compared(of[0], reference), smooth = compared(of[1], reference);
        double told = of[1]->smoothed_error, is = sqrt(smooth.relmse);
        print_message("# %s, %d x %d: relMSE %.4f, smoothed %.4f, mean %.4f and %.4f; off by %.3f, told %.3f\n",
                      rows[i].name, rows[i].frames, rows[i].rays, raw.relmse, smooth.relmse, raw.mean, smooth.mean, is,
                      told);
        assert_true(smooth.relmse < rows[i].most * raw.relmse);
        assert_true(fabs(smooth.mean - raw.mean) < rows[i].bias);
        assert_true(of[1]->smoothed && told > .3 * is && told < 3 * is);
        noc_image_destroy(of[0]);
        noc_image_destroy(of[1]);
    }
    noc_image_destroy(reference);
    noc_scene_destroy(s);
}

/* Where no surface is lit nothing is smoothed. */
static void leaves_emitters_and_the_sky(void **state) {
    noc_scene *s = square();
    noc_camera c = along();
    noc_render_params p = still(NOC_METHOD_RIS, 1);
    noc_image *of[2];
    int emitters = 0, changed = 0, sky = 0;
    (void)state;
    c.target[2] = 5; /* over the wall */
    make(s, &c, &p, 2, of);
    for (int i = 0; i < PIXELS; i++) {
        bool same = !memcmp(of[0]->rgb + 3 * i, of[1]->rgb + 3 * i, 3 * sizeof(float));
        bool emitter = of[0]->coverage[4 * i + 3] > 0;
        bool above = i < WIDE; /* the first row */
        emitters += emitter;
        sky += above;
        changed += !same;
        assert_true(same || !(emitter || above));
    }
    assert_memory_equal(of[0]->coverage, of[1]->coverage, 4 * PIXELS * sizeof(float));
    assert_memory_equal(of[0]->emitter, of[1]->emitter, PIXELS);
    assert_true(emitters > 10 && changed > PIXELS / 4 && sky == WIDE);
    noc_image_destroy(of[0]);
    noc_image_destroy(of[1]);
    noc_scene_destroy(s);
}

static void is_the_same_everywhere(void **state) {
    noc_scene *s = street(30);
    noc_camera c = along();
    noc_render_params p = still(NOC_METHOD_RIS, 1);
    noc_image *first = NULL;
    (void)state;
    for (int threads = 1; threads <= 3; threads += 2)
        for (p.isa = NOC_ISA_BASELINE; p.isa < NOC_ISA_COUNT; p.isa++) {
            if (!noc_isa_runs(p.isa))
                continue;
            noc_view *v = rendered(s, &c, &p, 2, threads);
            noc_image *image = noc_view_smoothed(v);
            assert_non_null(image);
            first = first ? first : image;
            assert_memory_equal(image->rgb, first->rgb, 3 * PIXELS * sizeof(float));
            assert_true(image->smoothed_error == first->smoothed_error); /* NOLINT */
            if (image != first)
                noc_image_destroy(image);
            close_view(v);
        }
    noc_image_destroy(first);
    noc_scene_destroy(s);
}

static void drop(void *user, noc_log_level level, const char *text) { (void)user, (void)level, (void)text; }

static bool stop(void *user, const char *what, double done) {
    (void)user, (void)what, (void)done;
    return false;
}

static void says_what_is_missing(void **state) {
    noc_log *log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_ERROR, .message = drop });
    noc_scene *s = street(5);
    noc_camera c = along();
    noc_view *v = own_view(s, 1, log);
    noc_render_params p = still(NOC_METHOD_RIS, 1);
    (void)state;
    assert_null(noc_view_smoothed(NULL));
    assert_null(noc_view_smoothed(v));
    assert_non_null(strstr(noc_log_last_error(log), "still: the view has no frame"));
    uint32_t all = p.aovs;
    for (int aov = 0; aov < NOC_AOV_COUNT; aov++) {
        if (!(all >> aov & 1))
            continue;
        p.aovs = all & ~(1u << aov);
        assert_int_equal(noc_view_render(v, &c, &p, NULL), NOC_OK);
        assert_null(noc_view_smoothed(v));
        assert_non_null(strstr(noc_log_last_error(log), noc_aov_name((noc_aov)aov)));
        noc_view_reset(v);
    }
    p.aovs = all;
    assert_int_equal(noc_view_render(v, &c, &p, NULL), NOC_OK);
    assert_int_equal(noc_view_render(v, &c, &p, &(noc_progress){ stop, NULL }), NOC_ERR_CANCELLED);
    assert_null(noc_view_smoothed(v));
    assert_non_null(strstr(noc_log_last_error(log), "was dropped"));
    p.method = NOC_METHOD_HEADLIGHT;
    assert_int_equal(noc_still_aovs(&p), 0);
    p.aovs = 0;
    assert_int_equal(noc_view_render(v, &c, &p, NULL), NOC_OK);
    assert_null(noc_view_smoothed(v));
    assert_non_null(strstr(noc_log_last_error(log), "headlight"));
    close_view(v);
    noc_log_destroy(log);
    noc_scene_destroy(s);
}

static void bears_refused_memory(void **state) {
    noc_scene *s = street(5);
    noc_camera c = along();
    noc_render_params p = still(NOC_METHOD_RIS, 1);
    noc_view *v = rendered(s, &c, &p, 2, 1);
    noc_image *image = NULL;
    int refused = 0;
    (void)state;
    for (uint64_t i = 1; !image; i++) {
        uint64_t before = noc_allocations();
        noc_refuse_allocation(before + i, false);
        image = noc_view_smoothed(v);
        noc_refuse_allocation(0, false);
        refused += !image;
        assert_true(i < 100);
    }
    assert_true(refused >= 5);
    noc_image_destroy(image);
    close_view(v);
    noc_scene_destroy(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(has_less_noise),         cmocka_unit_test(leaves_emitters_and_the_sky),
        cmocka_unit_test(is_the_same_everywhere), cmocka_unit_test(says_what_is_missing),
        cmocka_unit_test(bears_refused_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
