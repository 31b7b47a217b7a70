/* Built cities that are joined: all of each is there, where it stood, and what they share is there once. */
#include "built_city.h"

#include "../memory.h"

#include "import/built/built.h"

#include <math.h>

static char other[80];

static noc_scene *join(const char *const *paths, size_t count, noc_report **report, noc_log *log, noc_status *status) {
    const noc_import_params params = noc_import_default_params();
    noc_scene *s = noc_scene_create(log);
    *report = report_create();
    assert_true(s && *report);
    importer im = { .log = log, .scene = s, .params = &params, .memory = 1e9, .report = *report };
    *status = built_read_all(&im, paths, count);
    return s;
}

static void save(noc_scene *s, noc_report *report, const char *to) {
    assert_int_equal(noc_scene_save(s, to, &(noc_save_params){ report, NULL }), NOC_OK);
    noc_report_destroy(report);
    noc_scene_destroy(s);
}

static void save_city(void) {
    noc_report *report;
    noc_scene *s = make_city(&report);
    save(s, report, path);
}

/* Of the world, without the land around it. */
static size_t count_triangles(const noc_scene *s, bool models) {
    size_t count = 0;
    for (size_t i = 0; i < s->meshes.len; i++) {
        const noc_scene_mesh *m = &s->meshes.data[i];
        bool land = s->backdrop_count && m->first_triangle == s->backdrop_first;
        count += !land && !m->removed && (m->model > 0) == models ? m->triangle_count : 0;
    }
    return count;
}

static size_t taken_lights(const noc_scene *s) {
    size_t count = 0;
    for (size_t i = 0; i < s->lights.len; i++)
        count += !(s->lights.data[i].flags & NOC_LIGHT_FREE);
    return count;
}

/* Each light of a is in b from `first` on, moved. */
static void assert_lights(const noc_scene *a, const noc_scene *b, size_t first, double moved) {
    for (size_t i = 0, k = first; i < a->lights.len; i++) {
        noc_light_record x = a->lights.data[i], y = b->lights.data[k];
        if (x.flags & NOC_LIGHT_FREE)
            continue;
        assert_true(fabs((double)y.p[0] - x.p[0] - moved) < 1e-3);
        assert_memory_equal(x.e, y.e, sizeof(x.e));
        assert_memory_equal(x.a, y.a, sizeof(x.a));
        assert_int_equal(x.kind, y.kind);
        assert_int_equal(noc_light_has_profile(&x), noc_light_has_profile(&y));
        const char *name = a->light_names.data[i], *there = b->light_names.data[k++];
        assert_true(name == there || !strcmp(name, there));
    }
}

static void assert_sound(const noc_scene *s) {
    for (size_t i = 0; i < s->windows.len; i++)
        assert_true(!i || s->windows.data[i].light > s->windows.data[i - 1].light);
    for (size_t i = 0; i < s->bodies.len; i++)
        assert_true(s->bodies.data[i].model <= s->models.len && s->bodies.data[i].light < s->lights.len);
    assert_int_equal((uintptr_t)s->lights.data % 64, 0);
}

static void test_one(void **state) {
    (void)state;
    noc_report *report, *joined;
    noc_status status;
    const char *paths[] = { path };
    save_city();
    noc_scene *a = load_again(&report), *b = join(paths, 1, &joined, NULL, &status);
    assert_int_equal(status, NOC_OK);
    assert_sound(b);
    assert_lights(a, b, 0, 0);
    assert_int_equal(a->windows.len, b->windows.len);
    assert_int_equal(a->instances.len - 1, b->instances.len); /* one was removed */
    assert_int_equal(a->cars.len, b->cars.len);
    assert_int_equal(a->bodies.len, b->bodies.len);
    assert_int_equal(count_triangles(a, false), count_triangles(b, false));
    assert_int_equal(count_triangles(a, true), count_triangles(b, true));
    assert_int_equal(a->environment->given, b->environment->given);
    assert_int_equal(a->class_said, b->class_said);
    assert_true(b->backdrop_count && b->wet);
    assert_string_equal(a->crs_name, b->crs_name);
    noc_report_totals x, y;
    noc_report_get_totals(report, &x);
    noc_report_get_totals(joined, &y);
    assert_memory_equal(&x, &y, sizeof(x));
    for (int axis = 0; axis < 3; axis++)
        assert_true(fabs(a->bounds_min[axis] - b->bounds_min[axis]) < 1e-3 &&
                    fabs(a->bounds_max[axis] - b->bounds_max[axis]) < 1e-3);
    noc_image *p = picture(a, &in_street), *q = picture(b, &in_street);
    size_t differ = 0, pixels = (size_t)p->width * (size_t)p->height;
    for (size_t i = 0; i < pixels; i++)
        differ += memcmp(p->rgb + 3 * i, q->rgb + 3 * i, 3 * sizeof(float)) != 0;
    assert_true(differ * 10 < pixels);
    noc_image_destroy(p);
    noc_image_destroy(q);
    /* it is edited as the other, and saved */
    stage_edits(b);
    assert_int_equal(noc_scene_save(b, path, &(noc_save_params){ joined, NULL }), NOC_OK);
    noc_scene *again = load_again(NULL);
    assert_int_equal(again->lights.len, b->lights.len);
    noc_scene_destroy(again);
    noc_report_destroy(report);
    noc_report_destroy(joined);
    noc_scene_destroy(a);
    noc_scene_destroy(b);
}

/* The same city, some way to the east of the first. */
static void save_moved(double metres) {
    noc_report *report;
    save_city();
    noc_scene *s = load_again(&report);
    s->origin[0] += metres;
    snprintf(other, sizeof(other), "%s/other.noct", folder);
    save(s, report, other);
}

static void test_two(void **state) {
    (void)state;
    noc_report *report;
    noc_status status;
    save_moved(500);
    const char *paths[] = { path, other };
    noc_scene *a = load_again(NULL), *b = join(paths, 2, &report, NULL, &status);
    assert_int_equal(status, NOC_OK);
    assert_sound(b);
    size_t lights = taken_lights(a);
    assert_int_equal(taken_lights(b), 2 * lights);
    assert_lights(a, b, 0, 0);
    assert_lights(a, b, lights, 500);
    assert_int_equal(b->windows.len, 2 * a->windows.len);
    assert_int_equal(b->bodies.len, 2 * a->bodies.len);
    assert_int_equal(b->cars.len, 2 * a->cars.len);
    assert_int_equal(b->streets.len, 2 * a->streets.len);
    assert_int_equal(count_triangles(b, false), 2 * count_triangles(a, false));
    assert_int_equal(count_triangles(b, true), count_triangles(a, true)); /* once */
    assert_int_equal(b->models.len, a->models.len);
    assert_int_equal(b->profiles.len, a->profiles.len);
    assert_int_equal(b->textures.len, a->textures.len);
    assert_true(b->materials.len <= a->materials.len + 1);
    assert_int_equal(b->groups.len, a->groups.len);
    assert_true(b->bounds_max[0] >= a->bounds_max[0] + 499);
    noc_report_totals t;
    noc_report_get_totals(report, &t);
    assert_int_equal(t.windows.windows * 2, 2 * b->windows.len);
    assert_int_equal(noc_report_follow(report, b), NOC_OK);
    noc_report_destroy(report);
    noc_scene_destroy(a);
    noc_scene_destroy(b);
    unlink(other);
}

static char told[400];

static void hear(void *user, noc_log_level level, const char *text) {
    (void)user;
    if (level == NOC_LOG_ERROR)
        snprintf(told, sizeof(told), "%s", text);
}

static void refuse(const char *expected) {
    noc_log *log = noc_log_create(&(noc_log_params){ .message = hear });
    const char *paths[] = { path, other };
    noc_report *report;
    noc_status status;
    noc_scene *s = join(paths, 2, &report, log, &status);
    assert_int_equal(status, NOC_ERR_ARGUMENT);
    assert_non_null(strstr(told, "other.noct: "));
    assert_non_null(strstr(told, expected));
    noc_report_destroy(report);
    noc_scene_destroy(s);
    noc_log_destroy(log);
}

static void test_unlike(void **state) {
    (void)state;
    save_moved(0);
    noc_scene *s = load_again(NULL);
    assert_int_equal(noc_scene_set_group(s, 1, (float[]){ .5f, 1, 2 }), NOC_OK);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    assert_int_equal(noc_scene_save(s, other, NULL), NOC_OK);
    refuse("\"street\" are dimmed or coloured otherwise");
    noc_scene_destroy(s);
    s = load_again(NULL);
    s->wet = false;
    assert_int_equal(noc_scene_save(s, other, NULL), NOC_OK);
    refuse("is built dry");
    s->wet = true;
    s->crs_kept = "EPSG:25833";
    assert_int_equal(noc_scene_save(s, other, NULL), NOC_OK);
    refuse("--scene-crs");
    noc_scene_destroy(s);
    unlink(other);
}

/* Refused memory, here and there, is told once, and nothing is lost. */
static void test_memory(void **state) {
    (void)state;
    save_moved(500);
    const char *paths[] = { path, other };
    noc_import_params params = noc_import_default_params();
    params.threads = 1;
    bool reached = true;
    for (uint64_t number = 1; reached; number += 1 + number / 16) {
        noc_log *log = counting_log();
        noc_report *report;
        noc_status status;
        noc_scene *s = noc_scene_create(log);
        report = report_create();
        importer im = { .log = log, .scene = s, .params = &params, .memory = 1e9, .report = report };
        begin_refusal(number, true);
        status = built_read_all(&im, paths, 2);
        reached = end_refusal();
        assert_int_equal(status, reached ? NOC_ERR_MEMORY : NOC_OK);
        assert_int_equal(refusing.errors, reached);
        noc_report_destroy(report);
        noc_scene_destroy(s);
        noc_log_destroy(log);
    }
    unlink(other);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_one),
        cmocka_unit_test(test_two),
        cmocka_unit_test(test_unlike),
        cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
