/* The Vulkan device refuses no option: `auto` has nothing to fall back from. */
#include "../render/unbiased.h"

#include "../own_view.h"

#include <nocturne/option.h>

/* Of the renderer's table, those that choose steps of a plan. */
static const char *const chosen[] = { "method", "candidates", "bias", "bias-rays" };
enum { CHOSEN = sizeof(chosen) / sizeof(*chosen) };

static noc_log *device_log;
static noc_device *device;
static size_t rendered;

/* A floor and a wall under a few lamps, some of them lit windows. */
static noc_scene *yard(void) {
    noc_scene *s = noc_scene_create(NULL);
    int grey = matte(s, 0.5f);
    add_floor(s, grey, 0, 0, 0, 14);
    QUAD(s, grey, -10, 10, 0, 20, 0, 0, 0, 0, 10);
    for (int i = 0; i < 12; i++) {
        noc_light l = { .kind = NOC_LIGHT_PARALLELOGRAM,
                        .position = { -9.5 + 1.6 * i, 9.99, 1.5 },
                        .edge_u = { 0.7, 0, 0 },
                        .edge_v = { 0, 0, 0.9 },
                        .emission = { 3, 4, 1 + (float)i } };
        assert_true(noc_scene_add_light(s, &l) >= 0);
    }
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    return s;
}

static const noc_option *find_option(const char *name) {
    const noc_option *o = noc_render_options();
    while (o->name && strcmp(o->name, name))
        o++;
    assert_non_null(o->name);
    return o;
}

/* All views that these options have, on any backend. */
static uint32_t views_of(noc_render_params p) {
    uint32_t all = 0;
    for (int aov = 0; aov < NOC_AOV_COUNT; aov++) {
        p.aovs = 1u << aov;
        all |= noc_render_check(&p, NULL) == NOC_OK ? p.aovs : 0;
    }
    return all;
}

/* Two frames, so that the second one reuses samples. */
static void render_with(const noc_scene *scene, const noc_render_params *p) {
    noc_camera camera = { .eye = { 0, -6, 3 }, .target = { 0, 10, 3 }, .up = { 0, 0, 1 }, .fov_deg = 60 };
    noc_view *view = noc_view_create(device, scene);
    assert_non_null(view);
    for (int frame = 0; frame < 2; frame++) {
        noc_status status = noc_view_render(view, &camera, p, NULL);
        char text[300];
        if (status) {
            noc_log_copy_error(device_log, text, sizeof(text));
            print_message("# %s\n", text);
        }
        for (size_t i = 0; status && i < CHOSEN; i++) {
            noc_option_get(find_option(chosen[i]), p, text, sizeof(text));
            print_message("# %s %s\n", chosen[i], text);
        }
        assert_int_equal(status, NOC_OK);
    }
    noc_image *image = noc_view_image(view);
    assert_non_null(image);
    noc_image_destroy(image);
    noc_view_destroy(view);
    rendered++;
}

/* All values of the options from `at` on, each where it changes something beside those before it. */
static void try_values(const noc_scene *scene, noc_render_params p, size_t at) {
    char why[160], choices[200], *rest = choices;
    if (at == CHOSEN) {
        render_with(scene, &p);
        p.aovs = views_of(p);
        assert_true(p.aovs);
        render_with(scene, &p);
        return;
    }
    const noc_option *o = find_option(chosen[at]);
    bool idle = noc_option_idle(o, noc_render_options(), &p, why, sizeof(why));
    snprintf(choices, sizeof(choices), "%s", o->choices ? o->choices : "on|off");
    for (char *value; (value = strsep(&rest, "|"));) {
        if (!idle)
            assert_int_equal(noc_option_set(o, &p, value, NULL), NOC_OK);
        try_values(scene, p, at + 1);
        if (idle)
            return;
    }
}

static void all_options_are_rendered(void **state) {
    (void)state;
    noc_scene *scene = yard();
    noc_render_params p = noc_render_default_params();
    p.width = 16;
    p.height = 9;
    try_values(scene, p, 0);
    assert_true(rendered > 80); /* ris by all candidates, restir by all of them and all values of bias */
    noc_scene_destroy(scene);
}

/* And one by one, since views decide what a frame keeps. */
static void all_views_are_rendered(void **state) {
    (void)state;
    noc_scene *scene = yard();
    noc_render_params p = noc_render_default_params();
    p.width = 16;
    p.height = 9;
    p.method = NOC_METHOD_RESTIR;
    static const noc_candidates from[] = { NOC_CANDIDATES_UNIFORM, NOC_CANDIDATES_LISTS, NOC_CANDIDATES_INFLUENCE };
    for (size_t c = 0; c < sizeof(from) / sizeof(*from); c++)
        for (int aov = 0; aov < NOC_AOV_COUNT; aov++) {
            p.candidates = from[c];
            p.aovs = views_of(p) & 1u << aov;
            if (p.aovs)
                render_with(scene, &p);
        }
    noc_scene_destroy(scene);
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(all_options_are_rendered),
                                        cmocka_unit_test(all_views_are_rendered) };
    device_log = noc_log_create(NULL);
    device = noc_device_create(&(noc_device_params){ .backend = NOC_BACKEND_VULKAN }, device_log);
    if (!device) {
        printf("1..0 # SKIP %s\n", noc_log_last_error(device_log));
        noc_log_destroy(device_log);
        return 0;
    }
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    noc_device_destroy(device);
    noc_log_destroy(device_log);
    return failed;
}
