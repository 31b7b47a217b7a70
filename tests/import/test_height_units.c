/* Units of heights: what CRSs, files and the user name, what is assumed, and what heights of buildings say of that. */
#include "base/base.h"

#include "../told.h"

#include <math.h>

static char folder[] = "/tmp/noc-height-units-XXXXXX";
#include "../folder.h"
static noc_log *log_;

#define NEW_YORK 985000, 200000
#define NEW_YORK_UTM 583000, 4507000
#define MUNICH 690000, 5330000
#define COMPOUND(v) "urn:ogc:def:crs,crs:EPSG::2263,crs:EPSG::" v

typedef struct city {
    const char *crs;
    double x, y;
    int count;
    double width, height; /* as the file has them */
    double base;
    const char *storeys; /* NULL: none */
} city;

static void put_square(char *at, size_t size, double x, double y, double width, double z) {
    size_t n = strlen(at);
    snprintf(at + n, size - n,
             "<g:surfaceMember><g:Polygon><g:exterior><g:LinearRing><g:posList>%.7f %.7f %g %.7f %.7f %g %.7f %.7f %g "
             "%.7f %.7f %g %.7f %.7f %g</g:posList></g:LinearRing></g:exterior></g:Polygon></g:surfaceMember>",
             x, y, z, x + width, y, z, x + width, y + width, z, x, y + width, z, x, y, z);
}

static void put_wall(char *at, size_t size, double x, double y, double width, double low, double high) {
    size_t n = strlen(at);
    snprintf(at + n, size - n,
             "<g:surfaceMember><g:Polygon><g:exterior><g:LinearRing><g:posList>%.7f %.7f %g %.7f %.7f %g %.7f %.7f %g "
             "%.7f %.7f %g %.7f %.7f %g</g:posList></g:LinearRing></g:exterior></g:Polygon></g:surfaceMember>",
             x, y, low, x + width, y, low, x + width, y, high, x, y, high, x, y, low);
}

/* Roofs, floors and a wall. The first building is 1 % higher than the others, so that none is another one again. */
static const char *write_city(const char *name, const city *c) {
    static char text[60000];
    snprintf(
        text, sizeof(text),
        "<CityModel xmlns='http://www.opengis.net/citygml/2.0' xmlns:b='http://www.opengis.net/citygml/building/2.0' "
        "xmlns:g='http://www.opengis.net/gml'><g:boundedBy><g:Envelope srsName='%s' srsDimension='3'/>"
        "</g:boundedBy>",
        c->crs);
    for (int i = 0; i < c->count; i++) {
        size_t n = strlen(text);
        snprintf(text + n, sizeof(text) - n, "<cityObjectMember><b:Building g:id='b%d'>", i);
        n = strlen(text);
        if (c->storeys)
            snprintf(text + n, sizeof(text) - n, "<b:storeysAboveGround>%s</b:storeysAboveGround>", c->storeys);
        strcat(text, "<b:lod1MultiSurface><g:MultiSurface>");
        double x = c->x + 3 * c->width * i, high = c->height * (i ? 1 : 1.01);
        put_square(text, sizeof(text), x, c->y, c->width, c->base);
        put_square(text, sizeof(text), x, c->y, c->width, c->base + high);
        put_wall(text, sizeof(text), x, c->y, c->width, c->base, c->base + high);
        strcat(text, "</g:MultiSurface></b:lod1MultiSurface></b:Building></cityObjectMember>");
    }
    strcat(text, "</CityModel>");
    return write_file(name, text);
}

static noc_import_params plain(void) {
    noc_import_params p = noc_import_default_params();
    p.infer_lamps = p.windows = NOC_SWITCH_OFF;
    return p;
}

/* Height of the scene's highest building [m], after what is told. */
static double height_of(const char *const *paths, size_t count, const noc_import_params *params, char *by,
                        size_t size) {
    noc_scene *scene = noc_scene_create(log_);
    noc_report *report;
    *told = 0;
    assert_int_equal(noc_scene_load(scene, paths, count, params, &report), NOC_OK);
    noc_scene_info info;
    noc_scene_get_info(scene, &info);
    snprintf(by, size, "%s", noc_report_get_file(report, 0)->height_unit_by);
    noc_report_destroy(report);
    noc_scene_destroy(scene);
    return info.bounds_max[2] - info.bounds_min[2];
}

static void test_cities(void **state) {
    static const struct {
        city c;
        const char *option; /* of --height-unit; NULL: none */
        double height;      /* m, of the others than the first */
        const char *by;
        const char *doubted; /* NULL: nothing */
    } rows[] = {
        /* plain CRSs of feet */
        { { "EPSG:2263", NEW_YORK, 12, 40, 30, 20, NULL }, NULL, 9.144, "as x and y are", NULL },
        { { "EPSG:2263", NEW_YORK, 12, 40, 9, 6, NULL },
          NULL,
          2.743,
          "as x and y are",
          "the median height of a building, of 12, is 2.74 m, which is hardly one: are heights in metres? Times 3.2808 "
          "it would be 9 m: pass --height-unit " },
        { { "EPSG:2263", NEW_YORK, 4, 40, 9, 6, NULL }, NULL, 2.743, "as x and y are", "are heights in metres?" },
        { { "EPSG:2263", NEW_YORK, 12, 40, 9, 6, NULL }, "m", 9, "by --height-unit", NULL },
        { { "EPSG:2263", NEW_YORK, 12, 40, 9, 6, NULL }, "*.gml=m", 9, "by --height-unit", NULL },
        { { "EPSG:2263", NEW_YORK, 12, 40, 9, 6, NULL }, "us-ft", 2.743, "by --height-unit", NULL },
        { { "EPSG:2263", NEW_YORK, 12, 60, 30, 6, "10" }, NULL, 9.144, "as x and y are", "storey, of 12, is 0.9" },
        { { "EPSG:2263", NEW_YORK, 12, 60, 190, 6, NULL }, NULL, 57.912, "as x and y are", NULL },
        /* compound ones, with a unit of their own */
        { { COMPOUND("6360"), NEW_YORK, 12, 40, 30, 20, NULL }, NULL, 9.144, "by the CRS", NULL },
        { { COMPOUND("5703"), NEW_YORK, 12, 40, 9, 6, NULL }, NULL, 9, "by the CRS", NULL },
        { { COMPOUND("5703"), NEW_YORK, 12, 40, 82, 6, NULL }, NULL, 82, "by the CRS", "is 82 m" },
        { { COMPOUND("5703"), NEW_YORK, 12, 40, 30, 6, NULL },
          NULL,
          30,
          "by the CRS",
          "is 30 m, which is hardly one: are heights in feet?" },
        { { COMPOUND("6360"), NEW_YORK, 12, 40, 8, 6, NULL }, NULL, 2.438, "by the CRS", "are heights in metres?" },
        { { "urn:ogc:def:crs,crs:EPSG::26918,crs:EPSG::6360", NEW_YORK_UTM, 12, 12, 30, 20, NULL },
          NULL,
          9.144,
          "by the CRS",
          NULL },
        /* metres */
        { { "EPSG:26918", NEW_YORK_UTM, 12, 12, 9, 20, NULL }, NULL, 9, "as x and y are", NULL },
        { { "EPSG:26918", NEW_YORK_UTM, 12, 12, 28, 20, NULL },
          NULL,
          28,
          "as x and y are",
          "is 28 m, which is hardly one: are heights in feet? Times 0.3048 it would be 8.53 m" },
        { { "EPSG:26918", NEW_YORK_UTM, 12, 12, 28, 20, NULL }, "ft", 8.534, "by --height-unit", NULL },
        { { "EPSG:26918", NEW_YORK_UTM, 12, 12, 28, 20, "9" }, NULL, 28, "as x and y are", NULL },  /* storeys agree */
        { { "EPSG:26918", NEW_YORK_UTM, 12, 35, 28, 20, NULL }, NULL, 28, "as x and y are", NULL }, /* blocks */
        { { "EPSG:25832", MUNICH, 12, 12, 28, 20, NULL }, NULL, 28, "as x and y are", NULL }, /* no land of feet */
        { { "EPSG:4326", 40.7, -74, 12, .0001, 9, 20, NULL }, NULL, 9, "as nothing names a unit", NULL },
        { { "", 0, 0, 12, 12, 30, 20, NULL }, "ft", 9.144, "by --height-unit", NULL },
    };
    (void)state;
    for (size_t i = 0; i < NOC_COUNT(rows); i++) {
        const char *path = write_city("city.gml", &rows[i].c);
        char by[60];
        noc_import_params params = plain();
        if (rows[i].option)
            params.height_unit = (noc_texts){ .text = { rows[i].option }, .count = 1 };
        double height = height_of(&path, 1, &params, by, sizeof(by));
        const char *doubt = strstr(told, "hardly");
        if (fabs(height - 1.01 * rows[i].height) > .25 || strcmp(by, rows[i].by) != 0 ||
            (rows[i].doubted ? !strstr(told, rows[i].doubted) : doubt != NULL))
            fail_msg("row %zu: %s: %g m, %s: %s", i, rows[i].c.crs, height, by, told);
        params.strict = true;
        params.infer_lamps = NOC_SWITCH_ON;
        noc_scene *scene = noc_scene_create(log_);
        *told = 0;
        noc_status status = noc_scene_load(scene, &path, 1, &params, NULL);
        if (rows[i].doubted && (status != NOC_ERR_FORMAT || !strstr(told, "in a unit that is doubtful")))
            fail_msg("row %zu: %d: %s", i, status, told);
        noc_scene_destroy(scene);
    }
}

/* Buildings whose storeys and heights are all plausible, beside terrain that is not in their unit. */
static void test_terrain(void **state) {
    static const struct {
        double terrain;
        const char *told; /* NULL: nothing */
    } rows[] = {
        { 300, NULL },
        { 305, NULL }, /* they stand in it */
        { 91.44, "stand at 91.44 m and the ground there lies at 27.87 m, 0.305 times as high: one is in feet" },
        { 984.3, "the ground there lies at 300 m, 3.28 times as high" },
        { 500, NULL },
    };
    (void)state;
    for (size_t i = 0; i < NOC_COUNT(rows); i++) {
        const city c = { "EPSG:2263", NEW_YORK, 12, 60, 90, 300, NULL };
        char text[1000], by[60];
        snprintf(
            text, sizeof(text),
            "{\"type\":\"CityJSON\",\"version\":\"1.0\",\"metadata\":{\"referenceSystem\":\"EPSG:2263\"},"
            "\"CityObjects\":{\"t\":{\"type\":\"TINRelief\",\"geometry\":[{\"type\":\"CompositeSurface\",\"lod\":1,"
            "\"boundaries\":[[[0,1,2]],[[0,2,3]]]}]}},\"vertices\":[[980000,190000,%g],[999000,190000,%g],"
            "[999000,210000,%g],[980000,210000,%g]]}",
            rows[i].terrain, rows[i].terrain, rows[i].terrain, rows[i].terrain);
        const char *paths[] = { write_city("city.gml", &c), write_file("terrain.json", text) };
        noc_import_params params = plain();
        height_of(paths, 2, &params, by, sizeof(by));
        if (rows[i].told ? !strstr(told, rows[i].told) : strstr(told, "times as high") != NULL)
            fail_msg("%g: %s", rows[i].terrain, told);
    }
}

/* Elevations of lamps: in the CRS's unit, or in that of their column. */
static void test_lamps(void **state) {
    static const struct {
        const char *heading, *option;
        double z; /* m, of what is written as 100 */
    } rows[] = {
        { "elevation", NULL, 30.48 }, { "elevation", "m", 100 },         { "elevation_ft", NULL, 30.48 },
        { "elevation_m", NULL, 100 }, { "elevation (m)", "us-ft", 100 }, { "ele", NULL, 30.48 },
    };
    (void)state;
    for (size_t i = 0; i < NOC_COUNT(rows); i++) {
        char text[500];
        snprintf(text, sizeof(text),
                 "id,x,y,%s,lamp_type,height_m\n1,985000,200000,100,LED,8\n2,985100,200000,100,LED,8\n"
                 "3,985200,200000,100,LED,8\n",
                 rows[i].heading);
        const char *path = write_file("lamps.csv", text);
        noc_import_params params = plain();
        params.crs = "EPSG:2263";
        if (rows[i].option)
            params.height_unit = (noc_texts){ .text = { rows[i].option }, .count = 1 };
        noc_scene *scene = noc_scene_create(log_);
        noc_light_info light;
        *told = 0;
        assert_int_equal(noc_scene_load(scene, &path, 1, &params, NULL), NOC_OK);
        assert_int_equal(noc_scene_get_light(scene, 0, &light), NOC_OK);
        double z = light.centre[2] - 8;
        if (fabs(z - rows[i].z) > .3)
            fail_msg("%s: %g: %s", rows[i].heading, z, told);
        noc_scene_destroy(scene);
    }
}

/* Elevations that are none of the city's ground: the unit that would bring them there is offered. */
static void test_lamps_on_ground(void **state) {
    const city c = { "EPSG:2263", NEW_YORK, 12, 60, 90, 300, NULL };
    (void)state;
    for (int metres = 0; metres < 2; metres++) {
        char text[500];
        double z = metres ? 300 * .3048 : 300;
        snprintf(text, sizeof(text),
                 "id,x,y,elevation,lamp_type,height_m\n1,985030,199950,%.1f,LED,8\n2,985230,199950,%.1f,LED,8\n"
                 "3,985430,199950,%.1f,LED,8\n",
                 z, z, z);
        const char *paths[] = { write_city("city.gml", &c), write_file("lamps.csv", text) };
        noc_import_params params = plain();
        params.crs = "EPSG:2263";
        noc_scene *scene = noc_scene_create(log_);
        *told = 0;
        assert_int_equal(noc_scene_load(scene, paths, 2, &params, NULL), NOC_OK);
        if ((strstr(told, "lamps.csv=m if they are in that unit") != NULL) != (metres == 1))
            fail_msg("%g: %s", z, told);
        noc_scene_destroy(scene);
    }
}

/* Outlines with a height in metres, in a CRS of feet: the block is as high as it says, on its own ground. */
static void test_outline(void **state) {
    static const char text[] =
        "<CityModel xmlns='http://www.opengis.net/citygml/2.0' xmlns:b='http://www.opengis.net/citygml/building/2.0' "
        "xmlns:g='http://www.opengis.net/gml'><cityObjectMember><b:Building g:id='b'>"
        "<b:measuredHeight uom='m'>20</b:measuredHeight><b:lod0FootPrint><g:MultiSurface srsName='EPSG:2263' "
        "srsDimension='3'><g:surfaceMember><g:Polygon><g:exterior><g:LinearRing><g:posList>985000 200000 100 985100 "
        "200000 100 985100 200100 100 985000 200100 100 985000 200000 100</g:posList></g:LinearRing></g:exterior>"
        "</g:Polygon></g:surfaceMember></g:MultiSurface></b:lod0FootPrint></b:Building></cityObjectMember></CityModel>";
    const char *path = write_file("outline.gml", text);
    char by[60];
    noc_import_params params = plain();
    (void)state;
    assert_float_equal(height_of(&path, 1, &params, by, sizeof(by)), 20,
                       .25); /* over the ground that is put under it */
}

/* Heights of a map's outlines in the United States, without a unit. */
static void test_footprints(void **state) {
    (void)state;
    for (int i = 0; i < 4; i++) {
        char text[4000] = "{\"type\":\"FeatureCollection\",\"features\":[";
        for (int k = 0; k < 12; k++) {
            size_t n = strlen(text);
            double x = -83.1 + k * 3e-4;
            snprintf(text + n, sizeof(text) - n,
                     "%s{\"type\":\"Feature\",\"properties\":{\"building\":\"yes\",\"BLDGHEIGHT\":%s},\"geometry\":{"
                     "\"type\":\"Polygon\",\"coordinates\":[[[%.4f,40.1],[%.4f,40.1],[%.4f,40.1001],[%.4f,40.1]]]}}",
                     k ? "," : "",
                     i == 1   ? "9"
                     : i == 3 ? "\"28 ft\""
                              : "28",
                     x, x + 1e-4, x + 1e-4, x);
        }
        strcat(text, "]}");
        const char *path = write_file("outlines.geojson", text);
        char by[60];
        noc_import_params params = plain();
        params.footprints = true;
        if (i == 2)
            params.height_unit = (noc_texts){ .text = { "ft" }, .count = 1 };
        double height = height_of(&path, 1, &params, by, sizeof(by));
        assert_float_equal(height, i == 0 ? 28 : i == 1 ? 9 : 28 * .3048, .25);
        assert_int_equal(strstr(told, "are heights in feet?") != NULL, i == 0);
    }
}

static void test_refused(void **state) {
    static const struct {
        const char *option, *told;
    } rows[] = {
        { "furlong", "--height-unit \"furlong\": pass a unit or FILE=UNIT; units are m, ft, us-ft" },
        { "=ft", "pass a unit or FILE=UNIT" },
        { "other.gml=ft", "no input is called so" },
    };
    const city c = { "EPSG:2263", NEW_YORK, 12, 60, 90, 300, NULL };
    const char *path = write_city("city.gml", &c);
    (void)state;
    for (size_t i = 0; i < NOC_COUNT(rows); i++) {
        noc_import_params params = plain();
        params.height_unit = (noc_texts){ .text = { rows[i].option }, .count = 1 };
        noc_scene *scene = noc_scene_create(log_);
        *told = 0;
        assert_int_equal(noc_scene_load(scene, &path, 1, &params, NULL), NOC_ERR_ARGUMENT);
        assert_non_null(strstr(told, rows[i].told));
        noc_scene_destroy(scene);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cities),          cmocka_unit_test(test_terrain), cmocka_unit_test(test_lamps),
        cmocka_unit_test(test_lamps_on_ground), cmocka_unit_test(test_outline), cmocka_unit_test(test_footprints),
        cmocka_unit_test(test_refused),
    };
    assert_non_null(mkdtemp(folder));
    log_ = noc_log_create(&(noc_log_params){ .level = NOC_LOG_WARN, .message = keep });
    int failed = cmocka_run_group_tests_name("import height units", tests, NULL, NULL);
    noc_log_destroy(log_);
    return remove_folder() || failed;
}
