/* CRS of the inputs and of the scene, axes, and where a mesh that names none lies: through the importer, from a fake
 * reader. */
#include "fake_reader.h"

#include <nocturne/render.h>
#include "../own_view.h"

static noc_import_params with_crs(const char *crs, const char *scene_crs) {
    noc_import_params p = DEFAULTS;
    p.crs = crs;
    p.scene_crs = scene_crs;
    return p;
}

/* Geographic input: the scene gets the UTM zone of its place; tuples are latitude first, and the house stays 10 m. */
static void test_geographic(void **state) {
    (void)state;
    struct run r;
    LOAD(&r, DEFAULTS,
         file("tokyo", "FAKE city\ncrs http://www.opengis.net/def/crs/EPSG/0/6697\nobject 0 b 1\n"
                       "polygon 2 35.6812 139.7671 9 35.6812 139.7672 9 35.6813 139.7672 9 35.6813 139.7671 9\nend\n"));
    assert_int_equal(r.status, NOC_OK);
    assert_string_equal(r.info.crs, "EPSG:32654 (WGS 84 / UTM zone 54N)");
    const noc_report_file *f = noc_report_get_file(r.report, 0);
    assert_string_equal(f->crs, "EPSG:6668 (JGD2011)");
    assert_close(f->extent_min[0], 139.7671, 1e-9);
    assert_close(f->extent_min[1], 35.6812, 1e-9);
    /* 1e-4 degrees: 9.05 m by 11.1 m there, the diagonal 14.3 m */
    float lo[2] = { INFINITY, INFINITY }, hi[2] = { -INFINITY, -INFINITY };
    const noc_scene_mesh *m = &r.scene->meshes.data[0];
    for (size_t k = 3 * (size_t)m->first_triangle; k < 3 * (size_t)(m->first_triangle + m->triangle_count); k++)
        for (int c = 0; c < 2; c++) {
            float x = r.scene->positions.data[3 * (size_t)r.scene->indices.data[k] + (size_t)c];
            lo[c] = NOC_MIN(lo[c], x), hi[c] = NOC_MAX(hi[c], x);
        }
    assert_close(hypot((double)(hi[0] - lo[0]), (double)(hi[1] - lo[1])), 14.4, 0.4);
    finish(&r);
}

static void test_axes(void **state) {
    (void)state;
    struct run r;
    static const struct {
        const char *text, *reason;
        double x, y; /* of the first corner, as understood */
    } cases[] = {
        /* northing first, against practice, in a CRS that has it so by the book; and in one that has not */
        { "crs EPSG:31468\npolygon 2 5400000 4458000 0 5400000 4458009 0 5400009 4458009 0\n",
          "axes exchanged to fit the CRS", 4458000, 5400000 },
        { "crs EPSG:25832\npolygon 2 5404000 678000 0 5404000 678009 0 5404009 678009 0\n",
          "axes exchanged to fit the CRS", 678000, 5404000 },
        { "crs EPSG:5514\npolygon 2 -1043000 -743100 0 -1043000 -743000 0 -1042900 -743000 0\n",
          "axes exchanged to fit the CRS", -743100, -1043000 },
        /* easting first, as practically always */
        { "crs EPSG:31468\npolygon 2 4458000 5400000 0 4458009 5400000 0 4458009 5400009 0\n", NULL, 4458000, 5400000 },
        { "crs EPSG:31256\npolygon 2 3000 341000 0 3009 341000 0 3009 341009 0\n", NULL, 3000, 341000 },
        /* longitude first under a name that has latitude first: only this order has such a place */
        { "crs EPSG:4258\npolygon 2 11.4 48.7 0 11.4001 48.7 0 11.4001 48.7001 0\n", "axes exchanged to fit the CRS",
          11.4, 48.7 },
        { "crs urn:ogc:def:crs:EPSG::4326\npolygon 2 150.1 -33.7 0 150.1001 -33.7 0 150.1001 -33.7001 0\n",
          "axes exchanged to fit the CRS", 150.1, -33.7 },
        { "crs EPSG:4326\npolygon 2 48.7 11.4 0 48.7 11.4001 0 48.7001 11.4001 0\n", NULL, 11.4, 48.7 },
        { "crs urn:adv:crs:ETRS89_UTM32*DE_DHHN92_NH\n"
          "polygon 2 32678000 5404000 0 32678009 5404000 0 32678009 5404009 0\n",
          "zone number taken off the easting", 678000, 5404000 },
    };
    for (size_t i = 0; i < NOC_COUNT(cases); i++) {
        char text[400];
        snprintf(text, sizeof(text), "FAKE city\n%s", cases[i].text);
        LOAD(&r, DEFAULTS, file("axes", text));
        assert_int_equal(r.status, NOC_OK);
        const noc_report_file *f = noc_report_get_file(r.report, 0);
        assert_close(f->extent_min[0], cases[i].x, 1e-6);
        assert_close(f->extent_min[1], NOC_MIN(cases[i].y, f->extent_max[1]), 1e-3);
        assert_int_equal(f->line_count, cases[i].reason ? 1 : 0);
        if (cases[i].reason)
            assert_true(has_line(f, cases[i].reason, 1));
        finish(&r);
    }
    /* no order of axes helps: said once, and taken as it is */
    LOAD(&r, DEFAULTS,
         file("a", "FAKE city\ncrs EPSG:31466\npolygon 2 1 1 0 3 1 0 3 4 0\npolygon 2 1 1 9 3 1 9 3 4 9\nlamp 2 2\n"));
    assert_int_equal(r.status, NOC_OK);
    assert_int_equal(r.warnings, 2); /* and that its metres are none there */
    assert_non_null(strstr(r.last_warning, "is it the right CRS?"));
    finish(&r);
    /* the decision is one of a file: a second file in the same CRS decides for itself */
    LOAD(&r, DEFAULTS,
         file("a", "FAKE city\ncrs EPSG:25832\npolygon 2 5404000 678000 0 5404000 678009 0 5404009 678009 0\n"),
         file("b", "FAKE city\ncrs EPSG:25832\npolygon 2 678000 5404000 0 678009 5404000 0 678009 5404009 0\n"));
    assert_true(has_line(noc_report_get_file(r.report, 0), "axes exchanged to fit the CRS", 1));
    assert_int_equal(noc_report_get_file(r.report, 1)->line_count, 0);
    assert_close(r.info.bounds_max[0] - r.info.bounds_min[0], 9 + 120, 1e-3); /* and the ground's margin */
    finish(&r);
}

static void test_scene_crs(void **state) {
    (void)state;
    struct run r;
    LOAD(&r, with_crs(NULL, "EPSG:25833"), file("a", CITY));
    assert_int_equal(r.status, NOC_OK);
    assert_string_equal(r.info.crs, "EPSG:25833 (ETRS89 / UTM zone 33N)");
    /* any CRS to local, and the scene's own */
    double p[3] = { 678000.5, 5404000.5, 370 }, q[3] = { 1, 2, 3 };
    assert_int_equal(noc_scene_to_local(r.scene, "EPSG:25832", p), NOC_OK);
    assert_close(p[0], r.info.bounds_min[0], 500); /* zone 33 is turned a little; in the ground plane's margin or so */
    assert_close(p[2], 370, 0);
    assert_int_equal(noc_scene_to_local(r.scene, NULL, q), NOC_OK);
    assert_close(q[0], 1 - r.info.origin[0], 0);
    assert_close(q[2], 3, 0);
    assert_int_equal(noc_scene_to_local(r.scene, "nonsense", q), NOC_ERR_ARGUMENT);
    double nowhere[3] = { NAN, 0, 0 };
    assert_int_equal(noc_scene_to_local(r.scene, "EPSG:4326", nowhere), NOC_ERR_ARGUMENT);
    finish(&r);
    /* a scene's CRS is projected, in metres; and must be readable */
    LOAD(&r, with_crs(NULL, "EPSG:4326"), file("a", CITY));
    assert_int_equal(r.status, NOC_ERR_ARGUMENT);
    finish(&r);
    LOAD(&r, with_crs(NULL, "EPSG:2263"), file("a", CITY));
    assert_int_equal(r.status, NOC_ERR_ARGUMENT);
    finish(&r);
    LOAD(&r, with_crs(NULL, "what"), file("a", CITY));
    assert_int_equal(r.status, NOC_ERR_ARGUMENT);
    finish(&r);
    /* set on the scene before: kept, with its origin */
    start(&r);
    noc_scene_set_crs(r.scene, "EPSG:25832", (double[]){ 678000, 5404000, 300 });
    load_with(&r, DEFAULTS, false, PATHS(file("a", CITY)));
    assert_int_equal(r.status, NOC_OK);
    assert_close(r.info.origin[2], 300, 0);
    double corner[3] = { 678000.5, 5404000.5, 370 };
    assert_int_equal(noc_scene_to_local(r.scene, "EPSG:25832", corner), NOC_OK);
    assert_close(corner[0], 0.5, 1e-6);
    assert_close(corner[2], 70, 1e-6);
    finish(&r);
}

static void test_missing_crs(void **state) {
    (void)state;
    struct run r;
    const char *local = file("local.city", "FAKE city\ncrs\n" HOUSE), *lamps = file("near.lamps", NEAR_LAMP);
    /* alone, it is local metres */
    LOAD(&r, DEFAULTS, local);
    assert_int_equal(r.status, NOC_OK);
    assert_string_equal(r.info.crs, "");
    double p[3] = { 11.4, 48.7, 0 };
    assert_int_equal(noc_scene_to_local(r.scene, "EPSG:4326", p), NOC_ERR_ARGUMENT);
    assert_non_null(strstr(noc_log_last_error(r.log), "local.city names no CRS"));
    finish(&r);
    /* with one that names a CRS, in either order, it is an error that names the file and the option */
    LOAD(&r, DEFAULTS, local, lamps);
    assert_int_equal(r.status, NOC_ERR_FORMAT);
    assert_non_null(strstr(noc_log_last_error(r.log), "local.city names no CRS"));
    assert_non_null(strstr(noc_log_last_error(r.log), "--crs"));
    finish(&r);
    LOAD(&r, DEFAULTS, file("a", CITY), local);
    assert_int_equal(r.status, NOC_ERR_FORMAT);
    assert_non_null(strstr(noc_log_last_error(r.log), "local.city names no CRS"));
    finish(&r);
    LOAD(&r, with_crs("EPSG:25832", NULL), local, lamps);
    assert_int_equal(r.status, NOC_OK);
    assert_string_equal(r.info.crs, "EPSG:25832 (ETRS89 / UTM zone 32N)");
    assert_int_equal(noc_report_get_file(r.report, 1)->lamps, 1);
    assert_true(r.info.lights >= 1);
    finish(&r);
    /* a name that is not understood: --crs says what to take; without it that is an error */
    const char *odd = file("odd", "FAKE city\ncrs Local Grid 7\n" HOUSE);
    LOAD(&r, with_crs("EPSG:25832", NULL), odd);
    assert_int_equal(r.status, NOC_OK);
    assert_true(r.warnings > 0);
    finish(&r);
    LOAD(&r, DEFAULTS, odd);
    assert_int_equal(r.status, NOC_ERR_FORMAT);
    assert_non_null(strstr(noc_log_last_error(r.log), "--crs"));
    finish(&r);
    LOAD(&r, with_crs("nonsense", NULL), local);
    assert_int_equal(r.status, NOC_ERR_ARGUMENT);
    finish(&r);
    LOAD(&r, with_crs(NULL, "EPSG:25832"), local);
    assert_int_equal(r.status, NOC_ERR_ARGUMENT);
    finish(&r);
}

/* A mesh names no CRS: with --crs it is in it, in doubles; without, it counts from the origin, wherever in the list it
 * is. */
static void test_mesh_place(void **state) {
    (void)state;
    struct run r;
    noc_import_params p = with_crs("EPSG:25832", NULL);
    const char *city =
        file("a", CITY "object 2 r -1\npolygon 9 678090 5403590 370 678120 5403590 370 678120 5403620 370\nend\n");
    const char *mesh = file("m", "FAKE mesh\n");
    p.infer_lamps = false;
    p.infer_lamps = false;
    mesh_x = 678100;
    mesh_y = 5403580;
    LOAD(&r, p, mesh, city);
    assert_int_equal(r.status, NOC_OK);
    assert_int_equal(r.warnings, 0);
    const noc_scene_mesh *m = r.scene->meshes.data; /* the one that shines */
    while (!(r.scene->materials.data[m->material].emission[0] > 0))
        m++;
    const float *v = &r.scene->positions.data[3 * (size_t)r.scene->indices.data[3 * (size_t)m->first_triangle]];
    assert_float_equal(v[0] + r.scene->origin[0], 678100, 1e-3);
    assert_float_equal(v[1] + r.scene->origin[1], 5403580, 1e-3);
    assert_string_equal(noc_report_get_file(r.report, 0)->crs, noc_report_get_file(r.report, 1)->crs);
    assert_float_equal(noc_report_get_file(r.report, 0)->extent_max[0], 678105, 0);
    finish(&r);
    p.crs = NULL; /* map coordinates, but nobody says so */
    LOAD(&r, p, mesh, city);
    assert_int_equal(r.status, NOC_OK);
    assert_int_equal(r.warnings, 1);
    assert_non_null(strstr(r.last_warning, "from the rest of the scene"));
    finish(&r);
    LOAD(&r, p, mesh); /* alone: local metres, near a local origin */
    assert_int_equal(r.status, NOC_OK);
    assert_int_equal(r.warnings, 0);
    assert_float_equal(r.scene->origin[0], 678103, 1);
    assert_float_equal(r.info.bounds_max[0] + r.scene->origin[0], 678105, 1e-3);
    finish(&r);
    mesh_x = mesh_y = 0;
    /* lamps settle the place just so */
    LOAD(&r, p, mesh, file("l", "FAKE lamps\ncrs EPSG:25832\nlamp 678100 5403580 5\n"));
    assert_int_equal(r.status, NOC_OK);
    assert_int_equal(r.warnings, 0);
    assert_float_equal(r.scene->origin[0], 678100, 0);
    finish(&r);
    p.crs = "EPSG:4326"; /* degrees are no metres */
    LOAD(&r, p, mesh, city);
    assert_int_equal(r.status, NOC_ERR_ARGUMENT);
    finish(&r);
}

/* ---- lengths that are not those of the ground ---- */

/* A street of 120 m by 20 m with lamps 60 m apart, in Ingolstadt at 48.8 N, written in a CRS. */
static const char *street_in(const char *crs, char *text, size_t size) {
    static const double corners[6][2] = {
        { 677940, 5404080 }, { 678060, 5404080 },   { 678060, 5404100 },
        { 677940, 5404100 }, { 677970, 5404101.5 }, { 678030, 5404101.5 }
    }; /* beside it: they face it */
    geo_crs *utm = geo_crs_create("EPSG:32632", NULL, NULL, NULL), *to = geo_crs_create(crs, NULL, NULL, NULL);
    geo_transform *t = geo_transform_create(utm, to, NULL, NULL);
    size_t n = (size_t)snprintf(text, size, "FAKE city\ncrs %s\nobject 2 street -1\npolygon 9", crs);
    for (int i = 0; i < 6; i++) {
        double p[3] = { corners[i][0], corners[i][1], 370 };
        assert_int_equal(geo_transform_points(t, p, 1), 0);
        n += (size_t)snprintf(text + n, size - n, i < 4 ? " %.5f %.5f 370" : "lamp %.5f %.5f\n", p[0], p[1]);
        if (i == 3)
            n += (size_t)snprintf(text + n, size - n, "\nend\n");
    }
    geo_transform_destroy(t);
    geo_crs_destroy(utm);
    geo_crs_destroy(to);
    return file(crs, text);
}

/* Mean luminance of the street between the lamps, seen from above. */
static double luminance_between(const struct run *r) {
    const noc_light_record *l = r->scene->lights.data;
    noc_camera camera = noc_camera_default();
    noc_render_params params = noc_render_default_params();
    for (int k = 0; k < 3; k++)
        camera.eye[k] = camera.target[k] = (l[0].p[k] + l[1].p[k]) / 2;
    camera.eye[2] = 400;
    camera.target[2] = 370;
    camera.up[1] = 1;
    camera.up[2] = 0;
    camera.target[1] -= 5;
    camera.eye[1] -= 5;
    camera.fov_deg = 20;
    params.width = 32;
    params.height = 32;
    params.sky = 0;
    params.method = NOC_METHOD_REFERENCE;
    params.rays = 64;
    noc_view *renderer = own_view(r->scene, 1, r->log);
    assert_int_equal(noc_view_render(renderer, &camera, &params, NULL), NOC_OK);
    noc_image *image = noc_view_image(renderer);
    double sum = 0;
    for (size_t i = 0; i < 32 * 32; i++)
        sum += 0.2126 * image->rgb[3 * i] + 0.7152 * image->rgb[3 * i + 1] + 0.0722 * image->rgb[3 * i + 2];
    noc_image_destroy(image);
    close_view(renderer);
    return sum / (32 * 32);
}

static void test_true_lengths(void **state) {
    (void)state;
    struct run r;
    char text[1000];
    LOAD(&r, DEFAULTS, street_in("EPSG:32632", text, sizeof(text)));
    assert_int_equal(r.status, NOC_OK);
    assert_int_equal(r.warnings, 0);
    assert_string_equal(r.info.given_crs, r.info.crs);
    assert_true(r.info.given_origin[0] == r.info.origin[0] && r.info.given_origin[1] == r.info.origin[1]);
    double expected = luminance_between(&r);
    assert_true(expected > 0);
    finish(&r);
    /* Web Mercator under its names, on the ellipsoid, and a zone far away; the last one is true enough (0.45 per mille)
     */
    static const char *const crs[] = { "EPSG:3857", "EPSG:900913", "EPSG:3395", "EPSG:32630", "EPSG:25833" };
    for (size_t i = 0; i < NOC_COUNT(crs); i++) {
        bool moves = i < 4;
        LOAD(&r, DEFAULTS, street_in(crs[i], text, sizeof(text)));
        assert_int_equal(r.status, NOC_OK);
        assert_int_equal(r.warnings, moves ? i == 3 ? 2 : 1 : 0); /* 32630: it is also far outside its area */
        assert_int_equal(r.info.lights, 2);
        const noc_light_record *l = r.scene->lights.data;
        assert_close(hypot((double)l[0].p[0] - l[1].p[0], (double)l[0].p[1] - l[1].p[1]), 60, .06);
        assert_close(luminance_between(&r) / expected, 1, .01);
        if (moves) {
            geo_crs *given = geo_crs_create(crs[i], NULL, NULL, NULL);
            assert_string_equal(r.info.given_crs, geo_crs_name(given));
            assert_string_equal(r.info.crs, "EPSG:32632 (WGS 84 / UTM zone 32N)");
            geo_crs_destroy(given);
        }
        /* the scene's own coordinates are those of the files, and their origin lies at 0 */
        double origin[3] = { r.info.given_origin[0], r.info.given_origin[1], 0 }, corner[3];
        assert_int_equal(noc_scene_to_local(r.scene, NULL, origin), NOC_OK);
        assert_close(hypot(origin[0], origin[1]), 0, 1e-3);
        assert_int_equal(sscanf(strstr(text, "polygon 9"), "polygon 9 %lf %lf %lf", &corner[0], &corner[1], &corner[2]),
                         3);
        assert_int_equal(noc_scene_to_local(r.scene, NULL, corner), NOC_OK);
        double again[3] = { corner[0], corner[1], corner[2] }; /* and back */
        assert_int_equal(noc_scene_from_local(r.scene, NULL, again), NOC_OK);
        assert_int_equal(noc_scene_to_local(r.scene, NULL, again), NOC_OK);
        for (int k = 0; k < 3; k++)
            assert_close(again[k], corner[k], 1e-3);
        double utm[3] = { 677940, 5404080, 370 };
        assert_int_equal(noc_scene_to_local(r.scene, "EPSG:32632", utm), NOC_OK);
        for (int k = 0; k < 3; k++)
            assert_close(corner[k], utm[k], 1e-3);
        finish(&r);
    }
    /* asked for by --scene-crs: the same */
    LOAD(&r, with_crs(NULL, "EPSG:3857"), street_in("EPSG:32632", text, sizeof(text)));
    assert_int_equal(r.status, NOC_OK);
    assert_string_equal(r.info.given_crs, "EPSG:3857 (WGS 84 / Pseudo-Mercator)");
    assert_close(luminance_between(&r) / expected, 1, .01);
    finish(&r);
}

/* So many houses, each in a CRS of a name of its own. */
static const char *strangely_placed(const char *name, int count) {
    char text[10000] = "FAKE city\n";
    for (int i = 0; i < count; i++)
        snprintf(text + strlen(text), sizeof(text) - strlen(text),
                 "crs garbage %d\nobject 0 b%d 1\n"
                 "polygon 2 678000 5404000 0 678001 5404000 0 678001 5404001 0\nend\n",
                 i, i);
    return file(name, text);
}

/* Names that PROJ does not know cost a search of its whole database each: there is an end to them. */
static void test_strange_crs(void **state) {
    (void)state;
    struct run r;
    const char *strange = strangely_placed("strange", 9);
    start(&r);
    /* those of another file are not this one's */
    load_with(&r, DEFAULTS, true, PATHS(strangely_placed("one", 1), strange));
    assert_int_equal(r.status, NOC_ERR_FORMAT);
    assert_non_null(
        strstr(noc_log_last_error(r.log), "/strange: more than 8 CRSs of the file are not understood, \"garbage 8\""));
    finish(&r);
    start(&r); /* what the file calls them does not matter where the user says */
    load_with(&r, with_crs("EPSG:25832", NULL), true, PATHS(strange));
    assert_int_equal(r.status, NOC_OK);
    assert_int_equal(r.warnings, 9);
    finish(&r);
}

#define WRONG_LAMP "FAKE lamps\ncrs EPSG:25833\nlamp 678030 5404010\n" /* whose coordinates are those of EPSG:25832 */

static const float *light_near(const struct run *r, double x, double y) {
    static float at[3];
    for (size_t i = 0; i < r->info.lights; i++) {
        noc_light_info info;
        assert_int_equal(noc_scene_get_light(r->scene, i, &info), NOC_OK);
        for (int k = 0; k < 3; k++)
            at[k] = (float)(info.centre[k] + r->scene->origin[k]);
        if (hypot((double)at[0] - x, (double)at[1] - y) < 2) /* an arm holds it */
            return at;
    }
    return NULL;
}

/* A file whose CRS is the wrong one is put right alone, under any of its names. */
static void test_file_crs(void **state) {
    (void)state;
    static const char *const names[] = { "wrong=EPSG:25832", "./wrong=EPSG:25832", "nocturne-load-*/wro?g=EPSG:25832",
                                         "wrong=+proj=utm +zone=32 +ellps=GRS80 +units=m", NULL };
    for (size_t i = 0; i <= NOC_COUNT(names); i++) {
        struct run r;
        char whole[300];
        noc_import_params p = DEFAULTS;
        const char *wrong = file("wrong", WRONG_LAMP);
        snprintf(whole, sizeof(whole), "%s=EPSG:25832", wrong);
        if (i < NOC_COUNT(names)) {
            p.file_crs = (noc_texts){ .text = { names[i] ? names[i] : whole }, .count = 1 };
            LOAD(&r, p, file("a", CITY), wrong, file("l", NEAR_LAMP));
        } else { /* as it is: both lamps are not where they should be, or one is lost */
            LOAD(&r, p, file("a", CITY), wrong, file("l", NEAR_LAMP));
            assert_null(light_near(&r, 678030, 5404010));
            finish(&r);
            continue;
        }
        assert_int_equal(r.status, NOC_OK);
        assert_int_equal(r.info.lights, 2);
        assert_non_null(light_near(&r, 678030, 5404010));
        double near[3] = { 11.42278, 48.76231, 0 };
        assert_int_equal(noc_scene_to_local(r.scene, "OGC:CRS84", near), NOC_OK);
        assert_non_null(light_near(&r, near[0] + r.scene->origin[0], near[1] + r.scene->origin[1]));
        if (i != 3) { /* PROJ knows no datum of that one, which is a warning more */
            assert_int_equal(r.warnings, 1);
            assert_non_null(strstr(r.last_warning,
                                   "/wrong: its coordinates are taken as EPSG:25832 (ETRS89 / UTM zone 32N), by "
                                   "--file-crs, in place of what it names, EPSG:25833 (ETRS89 / UTM zone 33N)"));
        }
        const noc_report_file *f = noc_report_get_file(r.report, 1);
        assert_true(f->crs_overridden);
        assert_string_equal(f->crs_given, "EPSG:25833");
        assert_false(noc_report_get_file(r.report, 0)->crs_overridden);
        assert_false(noc_report_get_file(r.report, 2)->crs_overridden);
        finish(&r);
    }
}

/* The last word of several counts; the right CRS brings no warning; a mesh has one of its own. */
static void test_file_crs_more(void **state) {
    (void)state;
    struct run r;
    noc_import_params p = with_crs("EPSG:25833", NULL);
    p.file_crs =
        (noc_texts){ .text = { "*=EPSG:3857", "wrong=EPSG:25832", "a=EPSG:25832", "l=OGC:CRS84", "m=EPSG:25832" },
                     .count = 5 };
    mesh_x = 678100, mesh_y = 5404000;
    LOAD(&r, p, file("a", CITY), file("wrong", WRONG_LAMP), file("l", NEAR_LAMP), file("m", "FAKE mesh\n"));
    assert_int_equal(r.status, NOC_OK);
    assert_int_equal(r.warnings, 1);
    assert_non_null(light_near(&r, 678030, 5404010));
    assert_string_equal(noc_report_get_file(r.report, 3)->crs, "EPSG:25832 (ETRS89 / UTM zone 32N)");
    finish(&r);
    static const struct {
        const char *text, *error;
    } bad[] = {
        { "lost=EPSG:25832", "--file-crs \"lost=EPSG:25832\": no input is called so" },
        { "rong=EPSG:25832", "no input is called so" },
        { "EPSG:25832", "--file-crs \"EPSG:25832\" is not FILE=CRS" },
        { "wrong=", "is not FILE=CRS" },
        { "=EPSG:25832", "is not FILE=CRS" },
        { "wrong=EPSG:no", "--file-crs wrong: the CRS \"EPSG:no\" is not understood" },
        { "m=EPSG:4326", "--file-crs EPSG:4326: " },
    };
    for (size_t i = 0; i < NOC_COUNT(bad); i++) {
        p = DEFAULTS;
        p.file_crs = (noc_texts){ .text = { bad[i].text }, .count = 1 };
        LOAD(&r, p, file("a", CITY), file("wrong", WRONG_LAMP), file("m", "FAKE mesh\n"));
        assert_int_equal(r.status, NOC_ERR_ARGUMENT);
        assert_non_null(strstr(noc_log_last_error(r.log), bad[i].error));
        finish(&r);
    }
}

/* --crs moves no map that names another CRS, and says so. Formats that have one are expected beside what it is for. */
static void test_crs_not_used(void **state) {
    (void)state;
    struct run r;
    noc_import_params p = with_crs("EPSG:25832", NULL);
    const char *taken = file("t", "FAKE lamps\ncrs =OGC:CRS84\nlamp 11.42278 48.76231\n");
    const char *other = file("o", "FAKE lamps\ncrs OGC:CRS84\nlamp 11.42279 48.76234\n");
    LOAD(&r, p, file("a", CITY), taken); /* which names it, so that it is used */
    assert_int_equal(r.status, NOC_OK);
    assert_int_equal(r.warnings, 0);
    assert_false(noc_report_get_file(r.report, 0)->crs_overridden);
    finish(&r);
    LOAD(&r, p, file("a", CITY), taken, other);
    assert_int_equal(r.status, NOC_OK);
    assert_int_equal(r.info.lights, 2);
    assert_int_equal(r.warnings, 1);
    assert_non_null(
        strstr(r.last_warning, "--crs EPSG:25832 is for cities and inputs that name no CRS, and is not used for "));
    assert_non_null(strstr(r.last_warning, "/o (OGC:CRS84 (WGS 84 (CRS84)));"));
    assert_non_null(strstr(r.last_warning, "/o=EPSG:25832"));
    assert_null(strstr(r.last_warning, "/t ("));
    finish(&r);
    p.crs = "EPSG:31468"; /* which the coordinates do not fit: of use to none */
    LOAD(&r, p, file("a", CITY), taken);
    assert_int_equal(r.status, NOC_OK);
    assert_int_equal(r.info.lights, 1);
    assert_int_equal(r.warnings, 1);
    assert_non_null(strstr(r.last_warning, "/a (EPSG:25832 (ETRS89 / UTM zone 32N)), "));
    assert_non_null(strstr(r.last_warning, "/t (OGC:CRS84 (WGS 84 (CRS84)), its format's)"));
    finish(&r);
}

/* A city of the given name of a CRS, with the house's coordinates in that order. */
static const char *house_in(const char *name, const char *crs, const char *x, const char *y) {
    char text[600];
    snprintf(text, sizeof(text),
             "FAKE city\ncrs %s\nobject 0 house 1\npolygon 2 %s %s 380 %s1 %s 380 %s1 %s1 380\nend\n", crs, x, y, x, y,
             x, y);
    return file(name, text);
}

/* --crs counts in place of what a city names; a warning has the file, both CRSs and the way between. */
static void test_crs_replaces(void **state) {
    (void)state;
    struct run r;
    static const struct {
        const char *named, *x, *y, *given, *crs, *moved; /* moved: NULL: it is as the file names it */
    } cases[] = {
        { "EPSG:25833", "678000.", "5404000.", "EPSG:25832", "EPSG:25832 (ETRS89 / UTM zone 32N)",
          "440 km from there" },
        { "EPSG:25832", "678000.", "5404000.", "EPSG:32632", "EPSG:32632 (WGS 84 / UTM zone 32N)", "km from there" },
        { "EPSG:4326", "678000.", "5404000.", "EPSG:25832", "EPSG:25832 (ETRS89 / UTM zone 32N)",
          "where they have no place" },
        /* its order, too: latitude first by the name, which is not what the file has */
        { "EPSG:4326", "11.4227", "48.7623", "OGC:CRS84", "OGC:CRS84 (WGS 84 (CRS84))", "5393 km from there" },
        /* what does not fit is the file's own, in its order */
        { "EPSG:25832", "678000.", "5404000.", "EPSG:4326", "EPSG:25832 (ETRS89 / UTM zone 32N)", NULL },
        { "EPSG:4326", "48.7623", "11.4227", "EPSG:25832", "EPSG:4326 (WGS 84)", NULL },
        { "EPSG:25832", "678000.", "5404000.", "EPSG:25832", "EPSG:25832 (ETRS89 / UTM zone 32N)", "" },
    };
    for (size_t i = 0; i < NOC_COUNT(cases); i++) {
        const char *lamp = file("lamp", "FAKE lamps\ncrs =OGC:CRS84\nlamp 11.42278 48.76231\n");
        noc_import_params p = with_crs(cases[i].given, NULL);
        LOAD(&r, p, house_in("house", cases[i].named, cases[i].x, cases[i].y), lamp);
        assert_int_equal(r.status, NOC_OK);
        assert_int_equal(r.info.lights, 1); /* lamps stay where they are: the house comes to them */
        const noc_report_file *f = noc_report_get_file(r.report, 0);
        assert_string_equal(f->crs, cases[i].crs);
        assert_string_equal(f->crs_given, cases[i].named);
        assert_int_equal(f->crs_overridden, cases[i].moved && *cases[i].moved);
        assert_int_equal(r.warnings, cases[i].moved && !*cases[i].moved ? 0 : 1);
        if (cases[i].moved && *cases[i].moved) {
            assert_non_null(strstr(r.last_warning, "/house: its coordinates are taken as "));
            assert_non_null(strstr(r.last_warning, cases[i].named));
            assert_non_null(strstr(r.last_warning, cases[i].moved));
        } else if (!cases[i].moved) {
            assert_non_null(strstr(r.last_warning, "is not used for "));
        }
        finish(&r);
    }
}

/* Where an input may name no CRS, such as a mesh, --crs is for it alone. */
static void test_crs_of_mesh(void **state) {
    (void)state;
    struct run r;
    mesh_x = 678010, mesh_y = 5404000;
    LOAD(&r, with_crs("EPSG:25832", NULL), file("a", "FAKE city\ncrs EPSG:25833\n" HOUSE), file("m", "FAKE mesh\n"));
    assert_int_equal(r.status, NOC_OK);
    assert_string_equal(noc_report_get_file(r.report, 0)->crs, "EPSG:25833 (ETRS89 / UTM zone 33N)");
    assert_false(noc_report_get_file(r.report, 0)->crs_overridden);
    finish(&r);
}

/* Lamps of one's own, added before the load as scene.h tells: they stay where they were put, beside the lamps of the
 * files. */
static void test_planned_lamps(void **state) {
    (void)state;
    struct run r;
    start(&r);
    assert_int_equal(noc_scene_set_crs(r.scene, "EPSG:25832", (double[]){ 678000, 5404000, 370 }), NOC_OK);
    double at[3] = { 678020.5, 5404003.25, 378 };
    assert_int_equal(noc_scene_to_local(r.scene, NULL, at), NOC_OK);
    noc_light lamp = { .kind = NOC_LIGHT_DISC,
                       .position = { at[0], at[1], at[2] },
                       .direction = { 0, 0, -1 },
                       .radius = 0.15,
                       .emission = { 1000, 1000, 1000 },
                       .name = "planned 1" };
    assert_int_equal(noc_scene_add_light(r.scene, &lamp), 0);
    load_with(&r, DEFAULTS, false, PATHS(file("a", CITY), file("l", NEAR_LAMP)));
    assert_int_equal(r.status, NOC_OK);
    assert_int_equal(r.info.lights, 2);
    assert_int_equal(r.info.lights_inferred, 0);
    noc_light_info info;
    assert_int_equal(noc_scene_get_light(r.scene, 0, &info), NOC_OK);
    assert_string_equal(info.light.name, "planned 1");
    double wgs84[3] = { info.centre[0], info.centre[1], info.centre[2] };
    assert_int_equal(noc_scene_from_local(r.scene, NULL, info.centre), NOC_OK);
    assert_close(info.centre[0], 678020.5, 1e-3);
    assert_close(info.centre[1], 5404003.25, 1e-3);
    assert_close(info.centre[2], 378, 1e-3);
    assert_int_equal(noc_scene_from_local(r.scene, "OGC:CRS84", wgs84), NOC_OK); /* as cs2cs has it */
    assert_close(wgs84[0], 11.4225333, 1e-6);
    assert_close(wgs84[1], 48.7635595, 1e-6);
    finish(&r);
}

/* What came before a reader's error goes to the report, and what is wrong with that is no second error: here a lamp on
 * the Moon, to which no transformation leads. LOAD looks that one error is told. */
static void test_error_after_error(void **state) {
    (void)state;
    struct run r;
    const char *lamps = file("moon", "FAKE lamps\ncrs +proj=longlat +R=1737400 +no_defs\nlamp 11.4 48.7\nfail\n");
    noc_import_params params = DEFAULTS;
    params.scene_crs = "EPSG:25832";
    LOAD(&r, params, lamps);
    assert_int_equal(r.status, NOC_ERR_FORMAT);
    finish(&r);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_error_after_error),
        cmocka_unit_test(test_geographic),
        cmocka_unit_test(test_axes),
        cmocka_unit_test(test_scene_crs),
        cmocka_unit_test(test_missing_crs),
        cmocka_unit_test(test_mesh_place),
        cmocka_unit_test(test_true_lengths),
        cmocka_unit_test(test_planned_lamps),
        cmocka_unit_test(test_strange_crs),
        cmocka_unit_test(test_file_crs),
        cmocka_unit_test(test_file_crs_more),
        cmocka_unit_test(test_crs_not_used),
        cmocka_unit_test(test_crs_replaces),
        cmocka_unit_test(test_crs_of_mesh),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
