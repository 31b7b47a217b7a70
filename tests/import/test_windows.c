/* Windows of a city that is loaded: which are lit, how they are switched, and that dark ones are glass. */
#include "digest.h"
#include "fake_reader.h"
#include "scene/facade.h"

#include <nocturne/image.h>
#include <nocturne/influence.h>
#include <nocturne/render.h>

/* A house of 40 m by 20 m, 18 m high, with all its walls; kind 0 is a building, 1 and 2 are walls and roofs. */
#define BLOCK(kind, wall)                                                                                              \
    "FAKE city\ncrs EPSG:25832\nobject " kind " block 2\n"                                                             \
    "polygon " wall " 678000 5404000 370 678040 5404000 370 678040 5404000 388 678000 5404000 388\n"                   \
    "polygon " wall " 678040 5404000 370 678040 5404020 370 678040 5404020 388 678040 5404000 388\n"                   \
    "polygon " wall " 678040 5404020 370 678000 5404020 370 678000 5404020 388 678040 5404020 388\n"                   \
    "polygon " wall " 678000 5404020 370 678000 5404000 370 678000 5404000 388 678000 5404020 388\n"                   \
    "polygon 2 678000 5404000 388 678040 5404000 388 678040 5404020 388 678000 5404020 388\nend\n"
#define LAMP "FAKE lamps\ncrs EPSG:25832\nlamp 678020 5403990\n"

static void load_seeded(struct run *r, const char *city, double lit, double hour, uint32_t seed) {
    noc_import_params p = noc_import_default_params();
    p.window.lit_windows = lit;
    p.window.hour = hour;
    p.window.seed = seed;
    LOAD(r, p, file("a", city), file("l", LAMP));
    assert_int_equal(r->status, NOC_OK);
}

static void load(struct run *r, const char *city, double lit, double hour) { load_seeded(r, city, lit, hour, 1); }

static bool is_lit(const noc_scene *s, size_t i) {
    const float *e = s->lights.data[s->windows.data[i].light].e;
    return e[0] > 0 || e[1] > 0 || e[2] > 0;
}

static void test_made(void **state) {
    (void)state;
    struct run r;
    load(&r, BLOCK("0", "1"), .35, 21);
    assert_int_equal(r.info.windows, 2 * (16 + 8) * 6); /* cells and storeys; no shops by its id */
    assert_int_equal(r.info.lights, r.info.windows + 1);
    noc_report_totals t;
    noc_report_get_totals(r.report, &t);
    assert_int_equal(t.windows.windows, 288);
    assert_int_equal(t.windows.lit, r.info.windows_lit);
    assert_int_equal(t.windows.walls[NOC_WALL_TAKEN], 4);
    assert_close(t.windows.area[NOC_WALL_TAKEN], 18 * 120, 1e-3);
    finish(&r);
    load(&r, BLOCK("0", "0"), .35, 21); /* without classes: by slope */
    assert_int_equal(r.info.windows, 288);
    finish(&r);
    load(&r,
         BLOCK("0", "1") "object 1 dem -1\npolygon 8 677900 5403900 372 678100 5403900 372 678100 5404100 372 "
                         "677900 5404100 372\nend\n",
         .35, 21); /* a storey under the ground */
    assert_int_equal(r.info.windows, 240);
    finish(&r);
    load(&r, BLOCK("6", "1"), .35, 21); /* a bridge */
    assert_int_equal(r.info.windows, 0);
    finish(&r);
    noc_import_params p = noc_import_default_params();
    p.window.width = 3;
    start(&r);
    load_with(&r, p, false, PATHS(file("a", BLOCK("0", "1"))));
    assert_int_equal(r.status, NOC_ERR_ARGUMENT);
    finish(&r);
}

#define OWN                                                                                                            \
    "FAKE city\ncrs EPSG:25832\nobject 0 own 3\n"                                                                      \
    "polygon 1 678000 5404000 370 678010 5404000 370 678010 5404000 376 678000 5404000 376\n"                          \
    "polygon 5 678002 5403999.95 371 678003 5403999.95 371 678003 5403999.95 373 678002 5403999.95 373\n"              \
    "polygon 5 678002 5404000.05 371 678002 5404000.05 373 678003 5404000.05 373 678003 5404000.05 371\n"              \
    "polygon 5 678002 5403999.95 371 678002 5404000.05 371 678003 5404000.05 371 678003 5403999.95 371\n"              \
    "polygon 5 678006 5403999.95 374 678008 5403999.95 374 678007 5403999.95 375.5\n"                                  \
    "end\n"

/* A wall of 10 m by 6 m with a window of its own, as a body: a front, its back, a frame around it; and a gable's
 * triangle of glass. Walls get no others. */
static void test_own(void **state) {
    (void)state;
    struct run r;
    load(&r, OWN, 1, 21);
    noc_report_totals t;
    noc_report_get_totals(r.report, &t);
    assert_int_equal(t.windows.windows, 2);
    assert_int_equal(t.windows.own, 2);
    assert_int_equal(t.windows.walls[NOC_WALL_OWN], 1);
    assert_int_equal(r.info.windows, 2);
    assert_int_equal(r.info.lights_by_kind[NOC_LIGHT_PARALLELOGRAM], 1);
    assert_int_equal(r.info.lights_by_kind[NOC_LIGHT_TRIANGLE], 1);
    noc_light_info info;
    for (size_t i = 0; i < r.info.light_slots; i++) {
        assert_int_equal(noc_scene_get_light(r.scene, i, &info), NOC_OK);
        if (info.light.kind == NOC_LIGHT_PARALLELOGRAM) {
            assert_close(info.area, 2, 1e-3);
            assert_close(info.light.direction[1], -1, 1e-4);
        } else if (info.light.kind == NOC_LIGHT_TRIANGLE) {
            assert_close(info.area, 1.5, 1e-3);
        }
    }
    finish(&r);
}

/* Panes that are no rectangles, of five corners and of four: a light a triangle, and one light each to people. */
#define SLANTED                                                                                                        \
    "FAKE city\ncrs EPSG:25832\nobject 0 own 3\n"                                                                      \
    "polygon 1 678000 5404000 370 678010 5404000 370 678010 5404000 376 678000 5404000 376\n"                          \
    "polygon 5 678001 5403999.95 371 678003 5403999.95 371 678003 5403999.95 373 678002 5403999.95 374 "               \
    "678001 5403999.95 373\n"                                                                                          \
    "polygon 5 678006 5403999.95 371 678009 5403999.95 371 678008 5403999.95 373 678007 5403999.95 373\n"              \
    "end\n"

static void check_panes(const noc_scene *s) {
    noc_emitter e[5];
    int of_three = 0;
    double lumens = 0;
    for (size_t i = 0; i < 5; i++) {
        assert_int_equal(noc_scene_get_emitter(s, s->windows.data[i].light, &e[i]), NOC_OK);
        assert_int_equal(e[i].kind, NOC_EMITTER_WINDOW);
        assert_string_equal(e[i].name, "own");
        of_three += e[i].light_count == 3;
        assert_true(e[i].light_count == 3 || e[i].light_count == 2);
        assert_true((e[i].light == e[0].light) == (e[i].light_count == e[0].light_count));
        lumens += e[i].lumens / (double)e[i].light_count;
        assert_true(e[i].kelvin > 2000 && e[i].kelvin < 7000);
        assert_true(e[i].kelvin == noc_rgb_kelvin(s->lights.data[e[i].light].e));
    }
    assert_int_equal(of_three, 3);
    double all = 0;
    for (size_t i = 0; i < 5; i++)
        all += noc_light_flux(&s->lights.data[s->windows.data[i].light]);
    assert_true(all > 0);
    assert_close(lumens, all, 1e-4 * all);
}

static void test_panes(void **state) {
    (void)state;
    struct run r, again;
    load(&r, SLANTED, 1, 21);
    assert_int_equal(r.info.lights_by_kind[NOC_LIGHT_TRIANGLE], 5);
    check_panes(r.scene);
    char built[128];
    snprintf(built, sizeof(built), "%s", file("b", ""));
    assert_int_equal(noc_scene_save(r.scene, built, NULL), NOC_OK); /* a built city knows them, too */
    start(&again);
    load_with(&again, noc_import_default_params(), false, PATHS(built));
    assert_int_equal(again.status, NOC_OK);
    check_panes(again.scene);
    finish(&again);
    finish(&r);
}

/* What is lit at a share is lit at a greater one; none moves; hours are shares. */
static void test_ratio(void **state) {
    (void)state;
    struct run r[4];
    const double lit[] = { 0, .3, .5, 1 };
    for (int i = 0; i < 4; i++)
        load(&r[i], BLOCK("0", "1"), lit[i], 21);
    size_t n = r[0].info.windows;
    assert_int_equal(r[0].info.windows_lit, 0);
    assert_int_equal(r[3].info.windows_lit, n);
    for (int i = 0; i < 3; i++) {
        const noc_scene *a = r[i].scene, *b = r[i + 1].scene;
        assert_int_equal(r[i + 1].info.windows, n);
        assert_memory_equal(a->positions.data, b->positions.data, a->positions.len * sizeof(float));
        for (size_t k = 0; k < n; k++)
            assert_true(!is_lit(a, k) || is_lit(b, k));
        assert_true(r[i].info.windows_lit < r[i + 1].info.windows_lit);
    }
    struct run night;
    load(&night, BLOCK("0", "1"), .5, 3);
    assert_true(night.info.windows_lit < r[2].info.windows_lit);
    finish(&night);
    for (int i = 0; i < 4; i++)
        finish(&r[i]);
}

/* Another seed lights others, as many, as a load with it does, and the first seed the first ones. */
static void test_seed(void **state) {
    (void)state;
    struct run a, b;
    char keys[4][NOC_CONTENT_KEY];
    load(&a, BLOCK("0", "1"), .4, 21);
    load_seeded(&b, BLOCK("0", "1"), .4, 21, 7);
    noc_scene_content(a.scene, keys[0]);
    noc_scene_content(b.scene, keys[1]);
    noc_report_totals t;
    noc_report_get_totals(b.report, &t);
    assert_int_equal(t.windows.lit, b.info.windows_lit);
    noc_window_params p = { .lit_windows = .4, .hour = 21, .seed = 7 };
    size_t differ = 0;
    for (size_t i = 0; i < a.info.windows; i++)
        differ += is_lit(a.scene, i) != is_lit(b.scene, i);
    assert_true(differ > a.info.windows / 4); /* 2 x .4 x .6 where the draws are independent */
    assert_true(fabs((double)b.info.windows_lit / 288 - .4) < .1);
    assert_int_equal(noc_scene_set_windows(a.scene, &p), NOC_OK);
    assert_int_equal(noc_scene_commit(a.scene), NOC_OK);
    noc_scene_content(a.scene, keys[2]);
    p.seed = 1;
    assert_int_equal(noc_scene_set_windows(a.scene, &p), NOC_OK);
    assert_int_equal(noc_scene_commit(a.scene), NOC_OK);
    noc_scene_content(a.scene, keys[3]);
    assert_string_not_equal(keys[0], keys[1]);
    assert_string_equal(keys[1], keys[2]);
    assert_string_equal(keys[0], keys[3]);
    finish(&a);
    finish(&b);
}

/* A switched scene is the one that was loaded so: the same name for all that pictures depend on. */
static void test_switched(void **state) {
    (void)state;
    struct run a, b;
    char keys[3][NOC_CONTENT_KEY];
    load(&a, BLOCK("0", "1"), .3, 21);
    load(&b, BLOCK("0", "1"), .6, 23.5);
    noc_scene_content(a.scene, keys[0]);
    noc_scene_content(b.scene, keys[1]);
    assert_string_not_equal(keys[0], keys[1]);
    noc_window_params p = { .lit_windows = .6, .hour = 23.5, .seed = 1 };
    noc_scene_versions before = a.scene->versions;
    assert_int_equal(noc_scene_set_windows(a.scene, &p), NOC_OK);
    noc_scene_content(a.scene, keys[2]);
    assert_string_equal(keys[0], keys[2]); /* staged */

    assert_int_equal(noc_scene_commit(a.scene), NOC_OK);
    noc_scene_content(a.scene, keys[2]);
    assert_string_equal(keys[1], keys[2]);
    assert_int_equal(a.scene->versions.geometry, before.geometry);
    assert_int_equal(a.scene->versions.lights, before.lights);
    assert_int_equal(a.scene->versions.emission, before.emission + 1);
    p.hour = 25;
    assert_int_equal(noc_scene_set_windows(a.scene, &p), NOC_ERR_ARGUMENT);
    /* windows that went with their wall are not switched; their lights may be others now */
    for (size_t mesh = 0; mesh < a.scene->meshes.len; mesh++)
        if (noc_facade_windows(a.scene, &a.scene->meshes.data[mesh]))
            assert_int_equal(noc_scene_remove_mesh(a.scene, (int)mesh), NOC_OK);
    assert_int_equal(noc_scene_commit(a.scene), NOC_OK);
    noc_light lamp = { .kind = NOC_LIGHT_POINT, .position = { 0, 0, 50 }, .emission = { 3, 2, 1 } };
    int light = noc_scene_add_light(a.scene, &lamp);
    assert_int_equal(noc_scene_commit(a.scene), NOC_OK);
    p.hour = 21;
    assert_int_equal(noc_scene_set_windows(a.scene, &p), NOC_OK);
    assert_int_equal(noc_scene_commit(a.scene), NOC_OK);
    assert_true(a.scene->lights.data[light].e[0] == 3);
    noc_scene_get_info(a.scene, &a.info);
    assert_int_equal(a.info.windows, 0);
    finish(&a);
    finish(&b);
}

/* A picture of before and one of after show the same place. */
static void test_same_views(void **state) {
    (void)state;
    static const struct {
        double lit;
        const char *off;
    } cases[] = { { .6, NULL }, { .05, NULL }, { 0, NULL }, { .3, "windows" }, { .3, "lamps" } };
    for (noc_viewpoint view = NOC_VIEWPOINT_STREET; view <= NOC_VIEWPOINT_OVERVIEW; view++) {
        noc_camera first, c;
        for (size_t i = 0; i < NOC_COUNT(cases); i++) {
            struct run r;
            load(&r, BLOCK("0", "1"), cases[i].lit, 21);
            if (cases[i].off)
                assert_int_equal(noc_scene_say_group(r.scene, noc_scene_find_group(r.scene, cases[i].off), "off"),
                                 NOC_OK);
            assert_int_equal(noc_scene_commit(r.scene), NOC_OK);
            assert_int_equal(noc_scene_camera(r.scene, view, 1.5, i ? &c : &first), NOC_OK);
            if (i)
                assert_memory_equal(&c, &first, sizeof(c));
            finish(&r);
        }
    }
}

static void test_share(void **state) {
    (void)state;
    for (int kind = 0; kind < NOC_WINDOW_KIND_COUNT; kind++) {
        assert_close(noc_window_share((noc_window_kind)kind, .35, 21), .35, 1e-6);
        for (int q = 0; q <= 96; q++) {
            double share = noc_window_share((noc_window_kind)kind, .35, q / 4.);
            assert_true(share > 0 && share <= 1);
            assert_true(noc_window_share((noc_window_kind)kind, .3, q / 4.) <= share);
        }
        assert_close(noc_window_share((noc_window_kind)kind, .35, 0), noc_window_share((noc_window_kind)kind, .35, 24),
                     1e-9);
    }
    assert_true(noc_window_share(NOC_WINDOW_FLAT, .35, 3) < noc_window_share(NOC_WINDOW_SHOP, .35, 3));
    assert_true(noc_window_share(NOC_WINDOW_OFFICE, .35, 11) > noc_window_share(NOC_WINDOW_FLAT, .35, 11));
}

/* Flats against the model of British homes by Richardson, Thomson and Infield (2008, 2009; weekday, winter): rooms lit,
 * over how many are at 21 h. Its people forget no light and there are no stairs, so there are some more, never less. */
static void test_share_of_flats(void **state) {
    (void)state;
    static const struct {
        int hour;
        double rooms;
    } crest[] = { { 17, .64 }, { 18, .84 }, { 19, .94 }, { 20, .97 }, { 22, .89 }, { 23, .58 },
                  { 0, .19 },  { 1, .07 },  { 2, .04 },  { 3, .01 },  { 6, .08 },  { 7, .29 } };
    for (size_t i = 0; i < NOC_COUNT(crest); i++) {
        double over = noc_window_share(NOC_WINDOW_FLAT, .35, crest[i].hour) / .35;
        assert_true(over >= crest[i].rooms && over < crest[i].rooms + .12);
    }
}

/* The class that is seen at a window, and what it looks like: dark, it is a surface that reflects. */
static void test_glass(void **state) {
    (void)state;
    noc_device *device = noc_device_create(NULL, NULL);
    for (int lit = 0; lit < 2; lit++) {
        struct run r;
        load(&r, BLOCK("0", "1"), lit, 21);
        noc_render_params p = noc_render_default_params();
        p.width = p.height = 32;
        p.sky = 0;
        noc_view *view = noc_view_create(device, r.scene);
        assert_non_null(view);
        size_t at = 0; /* one of the front that the lamp lights */
        while (r.scene->lights.data[r.scene->windows.data[at].light].a[0] <= 0)
            at++;
        const noc_scene_window *w = &r.scene->windows.data[at];
        const noc_light_record *l = &r.scene->lights.data[w->light];
        noc_camera c = noc_camera_default();
        double n[3];
        for (int k = 0; k < 3; k++) {
            int i = (k + 1) % 3, j = (k + 2) % 3;
            n[k] = ((double)l->a[i] * l->b[j] - (double)l->a[j] * l->b[i]) / l->area;
            c.target[k] = l->p[k] + .5 * ((double)l->a[k] + l->b[k]);
            c.eye[k] = c.target[k] + n[k];
        }
        c.fov_deg = 10;
        for (int k = 0; k < 4; k++)
            assert_int_equal(noc_view_render(view, &c, &p, NULL), NOC_OK);
        noc_image *image = noc_view_image(view);
        assert_non_null(image);
        const float *rgb = image->rgb + 3 * (16 * 32 + 16);
        assert_int_equal(image->emitter && image->emitter[16 * 32 + 16], lit);
        if (lit)
            assert_close(rgb[1], w->emission[1], 1e-3 * (double)w->emission[1]);
        else
            assert_true(rgb[1] > 0 && rgb[1] < 5);
        noc_image_destroy(image);
        noc_view_reset(view);
        p.aovs = 1u << NOC_AOV_CLASS;
        c.fov_deg = 100;
        assert_int_equal(noc_view_render(view, &c, &p, NULL), NOC_OK);
        noc_channel *cls = noc_view_aov(view, NOC_AOV_CLASS);
        assert_non_null(cls);
        assert_int_equal(cls->value[16 * 32 + 16], NOC_CLASS_WINDOW);
        int walls = 0;
        for (int k = 0; k < 32 * 32; k++)
            walls += cls->value[k] == (float)(NOC_CLASS_COUNT + NOC_WALL_TAKEN - 1);
        assert_true(walls > 100);
        assert_string_equal(cls->labels[NOC_CLASS_COUNT + NOC_WALL_TAKEN - 1], "wall with windows");
        noc_channel_destroy(cls);
        noc_view_destroy(view);
        finish(&r);
    }
    noc_device_destroy(device);
}

/* Wherever memory is refused to windows, that is the status, told once. */
static void test_no_memory(void **state) {
    (void)state;
    const char *const cities[] = { BLOCK("0", "1"), OWN };
    for (int i = 0; i < 2; i++) {
        bool reached = true;
        for (uint64_t n = 1; reached; n += 1 + n / 16) {
            struct run r;
            const char *paths[] = { file("a", cities[i]), file("l", LAMP) };
            noc_import_params p = noc_import_default_params();
            start(&r);
            noc_refuse_allocation(n, false);
            r.status = load_inputs(r.scene, fakes, paths, 2, &p, false, &r.report);
            reached = noc_allocations() >= n;
            noc_refuse_allocation(0, false);
            /* some things are left out where they are refused: a thread of the pool */
            if ((r.status && r.status != NOC_ERR_MEMORY) || (r.status && !reached) || r.errors != (r.status != NOC_OK))
                fail_msg("city %d, allocation %llu: status %d, %d errors", i, (unsigned long long)n, r.status,
                         r.errors);
            finish(&r);
        }
    }
}

/* A row of houses that touch, some with windows of their own: more than are found at once. The same scene and report
 * by any number of threads. */
static void test_threads(void **state) {
    (void)state;
    enum { HOUSES = 300, ROOM = 800 };
    char *text = noc_alloc(HOUSES * ROOM);
    assert_non_null(text);
    size_t n = (size_t)sprintf(text, "FAKE city\ncrs EPSG:25832\n");
    for (int i = 0; i < HOUSES; i++) {
        double x = 678000 + 12 * i, top = 376 + i % 5;
        n += (size_t)snprintf(text + n, HOUSES * ROOM - n,
                              "object 0 h%d 2\npolygon 1 %g 5404000 370 %g 5404000 370 %g 5404000 %g %g 5404000 %g\n"
                              "polygon 1 %g 5404000 370 %g 5404008 370 %g 5404008 %g %g 5404000 %g\n",
                              i, x, x + 12, x + 12, top, x, top, x + 12, x + 12, x + 12, top, x + 12, top);
        if (i % 7 == 3)
            n += (size_t)snprintf(text + n, HOUSES * ROOM - n,
                                  "polygon 5 %g 5403999.95 371 %g 5403999.95 371 %g 5403999.95 373 %g 5403999.95 373\n",
                                  x + 2, x + 3, x + 3, x + 2);
        n += (size_t)snprintf(text + n, HOUSES * ROOM - n, "end\n");
    }
    const char *city = file("row", text);
    uint64_t first = 0;
    static const int threads[] = { 1, 2, 3, 8, 8, 8 };
    for (size_t t = 0; t < NOC_COUNT(threads); t++) {
        struct run r;
        noc_import_params p = noc_import_default_params();
        p.threads = threads[t];
        LOAD(&r, p, city, file("l", LAMP));
        assert_int_equal(r.status, NOC_OK);
        assert_true(r.info.windows > 10 * HOUSES);
        uint64_t sum = digest_of(r.scene, r.report);
        assert_true(!t || sum == first);
        first = sum;
        finish(&r);
    }
    free(text);
}

static bool rises(void *user, const char *what, double done) {
    double *last = user;
    assert_true(done >= *last && done <= 1);
    *last = done;
    return strcmp(what, "windows") || done < .8;
}

/* One progress, from the first byte to the last window; it stops windows, too. */
static void test_progress(void **state) {
    (void)state;
    enum { HOUSES = 600, ROOM = 150 };
    char *text = noc_alloc(HOUSES * ROOM);
    assert_non_null(text);
    size_t n = (size_t)sprintf(text, "FAKE city\ncrs EPSG:25832\n");
    for (int i = 0; i < HOUSES; i++)
        n += (size_t)
            snprintf(text + n, HOUSES * ROOM - n,
                     "object 0 h%d 2\npolygon 1 %d 5404000 370 %d 5404000 370 %d 5404000 376 %d 5404000 376\nend\n", i,
                     678000 + 12 * i, 678010 + 12 * i, 678010 + 12 * i, 678000 + 12 * i);
    struct run r;
    double last = 0;
    noc_import_params p = noc_import_default_params();
    p.progress = (noc_progress){ rises, &last };
    LOAD(&r, p, file("row", text), file("l", LAMP));
    assert_int_equal(r.status, NOC_ERR_CANCELLED);
    assert_true(last >= .8 && last < 1);
    finish(&r);
    free(text);
}

/* Walls of 20 km by 1 km have room for two million windows, in a file of a kilobyte: they get none, which is said, and
 * the house before them keeps its own. */
static void test_too_many(void **state) {
    (void)state;
    struct run r;
    load(&r,
         BLOCK("0", "1") "object 0 huge 1\npolygon 1 678100 5404000 370 698100 5404000 370 698100 5404000 1370 678100 "
                         "5404000 1370\nend\n",
         .35, 21);
    assert_int_equal(r.info.windows, 288);
    noc_report_totals t;
    noc_report_get_totals(r.report, &t);
    assert_int_equal(t.windows.walls[NOC_WALL_PARTY], 1);
    assert_non_null(strstr(r.last_warning, "a: 1 of 2 buildings have no windows: walls have room for over 1 million"));
    finish(&r);
    load(&r,
         BLOCK("0", "1") "object 0 wide 1\npolygon 1 678100 5404000 370 682100 5404000 370 682100 5404000 1370 678100 "
                         "5404000 1370\nend\n",
         .35, 21); /* a fifth of that */
    assert_true(r.info.windows > 400000);
    finish(&r);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_made),           cmocka_unit_test(test_own),      cmocka_unit_test(test_panes),
        cmocka_unit_test(test_ratio),          cmocka_unit_test(test_switched), cmocka_unit_test(test_share),
        cmocka_unit_test(test_share_of_flats), cmocka_unit_test(test_glass),    cmocka_unit_test(test_no_memory),
        cmocka_unit_test(test_threads),        cmocka_unit_test(test_progress), cmocka_unit_test(test_same_views),
        cmocka_unit_test(test_seed),           cmocka_unit_test(test_too_many),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
