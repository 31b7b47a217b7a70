/* Built cities: what was saved is what is loaded, to the bit of a picture. */
#include "built_city.h"

#include "import/built/built.h"

static const noc_camera from_above = {
    .eye = { 60, -80, 70 }, .target = { 0, 0, 0 }, .up = { 0, 0, 1 }, .fov_deg = 60
};

static void assert_same_picture(const noc_scene *a, const noc_scene *b, const noc_camera *camera) {
    noc_image *x = picture(a, camera), *y = picture(b, camera);
    assert_int_equal(x->width, y->width);
    assert_memory_equal(x->rgb, y->rgb, sizeof(float) * 3 * (size_t)x->width * (size_t)x->height);
    assert_false(noc_image_is_black(x));
    noc_image_destroy(x);
    noc_image_destroy(y);
}

static void assert_same_info(const noc_scene *a, const noc_scene *b) {
    noc_scene_info x, y;
    char p[NOC_CONTENT_KEY], q[NOC_CONTENT_KEY];
    noc_scene_get_info(a, &x);
    noc_scene_get_info(b, &y);
    assert_string_equal(x.crs, y.crs);
    assert_string_equal(x.given_crs, y.given_crs);
    x.crs = y.crs = x.given_crs = y.given_crs = NULL;
    x.memory_bytes = y.memory_bytes = 0;
    assert_memory_equal(&x, &y, sizeof(x));
    noc_scene_content(a, p);
    noc_scene_content(b, q);
    assert_string_equal(p, q);
    assert_int_equal(a->meshes.len, b->meshes.len);
    for (size_t i = 0; i < a->meshes.len; i++)
        if (a->meshes.data[i].name)
            assert_string_equal(a->meshes.data[i].name, b->meshes.data[i].name);
        else
            assert_null(b->meshes.data[i].name);
    for (size_t i = 0; i < a->lights.len; i++) {
        noc_light_info l, m;
        noc_scene_get_light(a, i, &l);
        noc_scene_get_light(b, i, &m);
        assert_int_equal(!l.light.name, !m.light.name);
        if (l.light.name)
            assert_string_equal(l.light.name, m.light.name);
        l.light.name = m.light.name = NULL;
        assert_memory_equal(&l, &m, sizeof(l));
    }
}

/* What a load reports, but for the folders of files. */
static void assert_same_report(const noc_report *a, const noc_report *b) {
    noc_report_totals x, y;
    noc_report_get_totals(a, &x);
    noc_report_get_totals(b, &y);
    assert_memory_equal(&x, &y, sizeof(x));
    assert_int_equal(a->rule_count, b->rule_count);
    for (size_t i = 0; i < a->rule_count; i++) {
        assert_string_equal(noc_report_get_rule(a, i)->place, noc_report_get_rule(b, i)->place);
        assert_int_equal(noc_report_get_rule(a, i)->lamps, noc_report_get_rule(b, i)->lamps);
    }
    for (size_t i = 0; noc_report_get_group(a, i); i++) {
        noc_group_info g = *noc_report_get_group(a, i), h = *noc_report_get_group(b, i);
        assert_string_equal(g.name, h.name);
        g.name = h.name = NULL;
        assert_memory_equal(&g, &h, sizeof(g));
    }
    assert_int_equal(noc_report_file_count(a), noc_report_file_count(b));
    for (size_t i = 0; i < noc_report_file_count(a); i++) {
        const noc_report_file *f = noc_report_get_file(a, i), *g = noc_report_get_file(b, i);
        const char *slash = strrchr(f->path, '/');
        assert_string_equal(slash ? slash + 1 : f->path, g->path);
        assert_string_equal(f->format, g->format);
        assert_string_equal(f->crs, g->crs);
        assert_string_equal(f->crs_given, g->crs_given);
        assert_int_equal(f->line_count, g->line_count);
        for (size_t k = 0; k < f->line_count; k++) {
            assert_string_equal(f->lines[k].reason, g->lines[k].reason);
            assert_string_equal(f->lines[k].examples, g->lines[k].examples);
            assert_int_equal(f->lines[k].count, g->lines[k].count);
            assert_int_equal(f->lines[k].repaired, g->lines[k].repaired);
            assert_int_equal(f->lines[k].lossless, g->lines[k].lossless);
        }
        assert_int_equal(f->column_count, g->column_count);
        for (size_t k = 0; k < f->column_count; k++) {
            assert_string_equal(f->columns[k].name, g->columns[k].name);
            assert_string_equal(f->columns[k].example, g->columns[k].example);
            assert_int_equal(f->columns[k].values, g->columns[k].values);
        }
    }
}

static bool stop_at_third(void *user, const char *what, double done) {
    assert_non_null(what);
    assert_true(done >= 0 && done < 1);
    return ++*(int *)user < 3;
}

static void test_builtin(void **state) {
    (void)state;
    noc_scene *scene = noc_scene_create(NULL);
    assert_int_equal(noc_scene_add_builtin(scene, "city", NULL), NOC_OK);
    assert_int_equal(noc_scene_save(scene, path, NULL), NOC_ERR_ARGUMENT); /* not committed */
    assert_int_equal(access(path, F_OK), -1);
    assert_int_equal(noc_scene_commit(scene), NOC_OK);
    int asked = 0;
    noc_save_params stopped = { .progress = { stop_at_third, &asked } };
    assert_int_equal(noc_scene_save(scene, path, &stopped), NOC_ERR_CANCELLED);
    assert_int_equal(asked, 3);
    assert_int_equal(access(path, F_OK), -1);
    assert_int_equal(noc_scene_save(scene, path, NULL), NOC_OK);
    assert_true(noc_built_is(path));
    noc_scene *again = load_again(NULL);
    assert_same_info(scene, again);
    assert_same_picture(scene, again, &from_above);
    noc_scene_destroy(scene);
    noc_scene_destroy(again);
}

static void test_everything(void **state) {
    (void)state;
    noc_report *before, *after;
    noc_scene *scene = make_city(&before);
    assert_int_equal(noc_scene_save(scene, path, &(noc_save_params){ before, NULL }), NOC_OK);
    noc_scene *again = load_again(&after);
    assert_same_info(scene, again);
    assert_same_report(before, after);
    assert_same_picture(scene, again, &in_street);
    double z[2], at[2][3] = { { 678003, 5403002, 401 }, { 678003, 5403002, 401 } };
    for (int x = -20; x < 20; x += 3) {
        assert_int_equal(noc_scene_ground(scene, x, 2, &z[0]), noc_scene_ground(again, x, 2, &z[1]));
        assert_true(z[0] == z[1]);
    }
    assert_int_equal(noc_scene_to_local(scene, "EPSG:4326", (at[0][0] = 11.43, at[0][1] = 48.77, at[0])), NOC_OK);
    assert_int_equal(noc_scene_to_local(again, "EPSG:4326", (at[1][0] = 11.43, at[1][1] = 48.77, at[1])), NOC_OK);
    assert_memory_equal(at[0], at[1], sizeof(at[0]));
    for (size_t t = 0; t < scene->triangle_light.len; t++)
        assert_int_equal(noc_scene_wall(scene, t), noc_scene_wall(again, t));
    /* the loaded one is edited as the other, where arrays lie in the file's bytes and where they grow */
    stage_edits(scene);
    stage_edits(again);
    assert_same_info(scene, again);
    assert_same_picture(scene, again, &in_street);
    assert_int_equal(noc_scene_add_group(again, "staged"), (int)scene->groups.len + 1);
    /* and what was edited is kept */
    assert_int_equal(noc_scene_save(scene, path, NULL), NOC_OK);
    noc_scene *edited = load_again(NULL);
    assert_same_info(scene, edited);
    assert_same_picture(scene, edited, &in_street);
    assert_int_equal(noc_scene_set_group(scene, 1, (float[]){ 1, 1, 1 }), NOC_OK);
    assert_int_equal(noc_scene_set_group(edited, 1, (float[]){ 1, 1, 1 }), NOC_OK);
    assert_int_equal(noc_scene_save(scene, path, NULL), NOC_ERR_ARGUMENT); /* edits wait */
    assert_int_equal(noc_scene_commit(scene), NOC_OK);
    assert_int_equal(noc_scene_commit(edited), NOC_OK);
    assert_same_info(scene, edited);
    noc_report_destroy(before);
    noc_report_destroy(after);
    noc_scene_destroy(scene);
    noc_scene_destroy(again);
    noc_scene_destroy(edited);
}

/* A city of shared/ and its lamps, if any. */
static void check_city(const char *city, const char *lamps) {
    const char *inputs[2] = { city, lamps };
    noc_report *before, *after;
    noc_camera camera;
    noc_scene *scene = noc_scene_create(NULL);
    assert_int_equal(noc_scene_load(scene, inputs, lamps ? 2 : 1, NULL, &before), NOC_OK);
    assert_int_equal(noc_scene_save(scene, path, &(noc_save_params){ before, NULL }), NOC_OK);
    noc_scene *again = load_again(&after);
    assert_same_info(scene, again);
    assert_same_report(before, after);
    noc_camera_params params = noc_camera_default_params();
    params.viewpoint = NOC_VIEWPOINT_AERIAL;
    assert_int_equal(noc_scene_place_camera(scene, &params, 16 / 9.0, &camera, NULL), NOC_OK);
    assert_same_picture(scene, again, &camera);
    noc_report_destroy(before);
    noc_report_destroy(after);
    noc_scene_destroy(scene);
    noc_scene_destroy(again);
}

static void test_ingolstadt(void **state) {
    (void)state;
    REQUIRE_SHARED(found, "data/lights/ingolstadt/ingolstadt_street_lamps.geojson");
    char lamps[4096];
    snprintf(lamps, sizeof(lamps), "%s", found);
    REQUIRE_SHARED(city, "data/cities/ingolstadt/ingolstadt_lod3_combined.gml.gz");
    check_city(city, lamps);
}

static void test_rotterdam(void **state) {
    (void)state;
    REQUIRE_SHARED(city, "data/cities/rotterdam");
    check_city(city, NULL);
}

static void test_helsinki(void **state) {
    (void)state;
    REQUIRE_SHARED(city, "data/cities/helsinki/viikintiedepuisto.gml.gz");
    check_city(city, NULL);
}

/* ---- the report's fields ---- */

/* Each byte of a report's file is 1, which all its numbers can be: a field that is not kept would be 0 again. Gaps
 * between fields are smaller than the numbers. The seconds of the load alone are not kept. */
static void test_fields(void **state) {
    (void)state;
    noc_report *report = report_create(), *after;
    noc_report_file file;
    memset(&file, 1, sizeof(file));
    report->lamps_inferred = 3, report->road_cars = 4, report->roads_drawn = 5, report->images_reduced = 6;
    file.path = "a/b.gml", file.format = "F", file.crs = "C", file.crs_given = "", file.height_unit_by = "H";
    file.columns = NULL;
    file.lines = NULL;
    file.column_count = file.line_count = 0;
    assert_true(array_push(&report->files, file));
    noc_scene *scene = noc_scene_create(NULL);
    assert_int_equal(noc_scene_commit(scene), NOC_OK);
    assert_int_equal(noc_scene_save(scene, path, &(noc_save_params){ report, NULL }), NOC_OK);
    noc_scene *again = load_again(&after);
    noc_report_file kept = *noc_report_get_file(after, 0);
    assert_memory_equal(&report->lamps_inferred, &after->lamps_inferred, 4 * sizeof(size_t));
    kept.path = file.path, kept.format = file.format, kept.crs = file.crs, kept.crs_given = file.crs_given;
    assert_string_equal(kept.height_unit_by, file.height_unit_by);
    kept.height_unit_by = file.height_unit_by;
    kept.columns = file.columns;
    kept.lines = file.lines;
    assert_true(kept.seconds == 0);
    kept.seconds = file.seconds;
    const char *a = (const char *)&file, *b = (const char *)&kept;
    for (size_t i = 0, lost = 0; i < sizeof(file); i++) {
        lost = a[i] == b[i] ? 0 : lost + 1;
        if (lost == sizeof(size_t))
            fail_msg("the field of noc_report_file that ends at byte %zu is not in import/built/report.c", i + 1);
    }
    noc_report_destroy(report);
    noc_report_destroy(after);
    noc_scene_destroy(scene);
    noc_scene_destroy(again);
}

/* From the author's own programs (xxhsum -H64, python-xxhash's README). */
static void test_sums(void **state) {
    (void)state;
    assert_true(noct_sum("", 0) == 0xef46db3751d8e999);
    assert_true(noct_sum("a", 1) == 0xd24ec4f1a98c6e5b);
    assert_true(noct_sum("abc", 3) == 0x44bc2cf5ad770999);
    assert_true(noct_sum("Nobody inspects the spammish repetition", 39) == 0xfbcea83c8a378bf1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sums),       cmocka_unit_test(test_builtin),   cmocka_unit_test(test_everything),
        cmocka_unit_test(test_ingolstadt), cmocka_unit_test(test_rotterdam), cmocka_unit_test(test_helsinki),
        cmocka_unit_test(test_fields),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
