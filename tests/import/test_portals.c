/* Recipes of cities whose files users bring from portals: what they say before the files are there, and that lamps in
 * longitude and latitude fall where a model in the city's own coordinates has them. */
#include "../files.h"

#include "scene/scene.h"
#include <nocturne/nocturne.h>

#include <math.h>
#include <sys/stat.h>

static char folder[] = "/tmp/noc-portals-XXXXXX";
#include "../folder.h"
static char errors[2000], warnings[4000];

static void hear(void *user, noc_log_level level, const char *text) {
    (void)user;
    char *to = level == NOC_LOG_ERROR ? errors : warnings;
    size_t room = level == NOC_LOG_ERROR ? sizeof(errors) : sizeof(warnings), n = strlen(to);
    if (level <= NOC_LOG_WARN)
        snprintf(to + n, room - n, "%s\n", text);
}

static void copy_recipe(const char *name) {
    char path[1000], text[8000];
    const char *source = getenv("NOC_SOURCE");
    snprintf(path, sizeof(path), "%s/cities/%s", source ? source : ".", name);
    FILE *f = fopen(path, "rb");
    assert_non_null(f);
    size_t n = fread(text, 1, sizeof(text) - 1, f);
    fclose(f);
    text[n] = 0;
    write_file(name, text);
}

/* A house of 20 m by 10 m and 12 m, its corner at (x, y), without a word on its CRS or with one. Tuples are (y, x)
 * where they are exchanged. */
static void write_house(const char *name, const char *crs, double x, double y, bool exchanged) {
    static const int faces[6][4] = { { 3, 2, 1, 0 }, { 4, 5, 6, 7 }, { 0, 1, 5, 4 },
                                     { 1, 2, 6, 5 }, { 2, 3, 7, 6 }, { 3, 0, 4, 7 } };
    char text[8000];
    size_t n = (size_t)snprintf(
        text, sizeof(text),
        "<CityModel xmlns='http://www.opengis.net/citygml/2.0' xmlns:b='http://www.opengis.net/citygml/building/2.0' "
        "xmlns:g='http://www.opengis.net/gml'><cityObjectMember><b:Building g:id='b'><b:lod2Solid><g:Solid%s%s%s>"
        "<g:exterior><g:CompositeSurface>",
        crs ? " srsName='" : "", crs ? crs : "", crs ? "'" : "");
    for (int f = 0; f < 6; f++) {
        n += (size_t)snprintf(text + n, sizeof(text) - n,
                              "<g:surfaceMember><g:Polygon><g:exterior><g:LinearRing><g:posList srsDimension='3'>");
        for (int k = 0; k <= 4; k++) {
            int c = faces[f][k % 4];
            double px = x + 20 * (c % 4 == 1 || c % 4 == 2), py = y + 10 * (c % 4 >= 2);
            n += (size_t)snprintf(text + n, sizeof(text) - n, "%.3f %.3f %d ", exchanged ? py : px, exchanged ? px : py,
                                  c < 4 ? 200 : 212);
        }
        n += (size_t)snprintf(text + n, sizeof(text) - n,
                              "</g:posList></g:LinearRing></g:exterior></g:Polygon></g:surfaceMember>");
    }
    snprintf(text + n, sizeof(text) - n,
             "</g:CompositeSurface></g:exterior></g:Solid></b:lod2Solid></b:Building></cityObjectMember></CityModel>");
    write_file(name, text);
}

/* So low that it has no arm: its light is over its place. */
static void write_lamp(const char *name, double lon, double lat) {
    char text[300];
    snprintf(text, sizeof(text),
             "{\"version\":0.6,\"elements\":[{\"type\":\"node\",\"id\":1,\"lat\":%.9f,\"lon\":%.9f,"
             "\"tags\":{\"highway\":\"street_lamp\",\"height\":\"3\"}}]}",
             lat, lon);
    write_file(name, text);
}

static noc_log *told; /* for all scenes; it outlives them */

/* As the program does it; crs wins over the recipe's where it is not NULL. */
static noc_status load(const char *recipe, const char *crs, noc_scene **scene) {
    noc_recipe *r;
    errors[0] = warnings[0] = 0;
    if (!told)
        told = noc_log_create(&(noc_log_params){ .level = NOC_LOG_WARN, .message = hear });
    assert_int_equal(noc_recipe_load(in_folder(recipe), told, &r), NOC_OK);
    noc_import_params params = noc_import_default_params();
    const noc_option *o;
    for (size_t i = 0; (o = noc_recipe_option(r, i)); i++)
        for (const noc_option *row = noc_import_options(); row->name; row++)
            if (row == o)
                assert_int_equal(noc_recipe_set(r, o, &params, told), NOC_OK);
    params.crs = crs ? crs : params.crs;
    params.profiles = false;
    params.infer_lamps = params.windows = NOC_SWITCH_OFF;
    const noc_recipe_info *info = noc_recipe_get_info(r);
    *scene = noc_scene_create(told);
    noc_status status = noc_scene_load(*scene, info->inputs, info->input_count, &params, NULL);
    noc_recipe_destroy(r);
    return status;
}

/* How far the one lamp stands from (x, y) of the scene's CRS, in its CRS. */
static double lamp_off(const noc_scene *scene, const char *crs, double x, double y) {
    noc_scene_info info;
    noc_scene_get_info(scene, &info);
    double off = INFINITY;
    for (size_t i = 0; i < info.light_slots; i++) {
        noc_light_info light;
        assert_int_equal(noc_scene_get_light(scene, i, &light), NOC_OK);
        double at[3] = { light.centre[0], light.centre[1], light.centre[2] };
        assert_int_equal(noc_scene_from_local(scene, crs, at), NOC_OK);
        off = fmin(off, hypot(at[0] - x, at[1] - y));
    }
    return off;
}

struct ellipsoid {
    double a, inverse;
};
static const struct ellipsoid bessel = { 6377397.155, 299.1528128 }, grs80 = { 6378137, 298.257222101 },
                              wgs84 = { 6378137, 298.257223563 };

/* Seven parameters, rotations in seconds as position vectors; degrees in, degrees out. Heights are 0. */
static void helmert(struct ellipsoid from, const double p[7], double lon, double lat, double out[2]) {
    double f = 1 / from.inverse, e2 = f * (2 - f), phi = lat * M_PI / 180, l = lon * M_PI / 180;
    double n = from.a / sqrt(1 - e2 * sin(phi) * sin(phi)), second = M_PI / 180 / 3600;
    double x = n * cos(phi) * cos(l), y = n * cos(phi) * sin(l), z = n * (1 - e2) * sin(phi), s = 1 + p[6] * 1e-6;
    double rx = p[3] * second, ry = p[4] * second, rz = p[5] * second;
    double u = p[0] + s * (x - rz * y + ry * z), v = p[1] + s * (rz * x + y - rx * z),
           w = p[2] + s * (-ry * x + rx * y + z);
    double g = 1 / wgs84.inverse, d2 = g * (2 - g), across = hypot(u, v), b = atan2(w, across * (1 - d2));
    for (int i = 0; i < 10; i++)
        b = atan2(w + d2 * wgs84.a / sqrt(1 - d2 * sin(b) * sin(b)) * sin(b), across);
    out[0] = atan2(v, u) * 180 / M_PI;
    out[1] = b * 180 / M_PI;
}

static void files_are_missing(void **state) {
    (void)state;
    static const char *const cities[] = { "prague", "montreal", "rotterdam-portal" };
    for (size_t i = 0; i < 3; i++) {
        char name[60];
        noc_scene *scene;
        snprintf(name, sizeof(name), "%s.yaml", cities[i]);
        copy_recipe(name);
        assert_int_equal(load(name, NULL, &scene), NOC_ERR_IO);
        assert_non_null(strstr(errors, folder));
        assert_non_null(strstr(errors, "No such file"));
        noc_scene_destroy(scene);
    }
}

/* The worked example of EPSG Guidance Note 7-2 for Krovak, taken to WGS 84 by the seven parameters of EPSG:5239: an
 * independent way to the lamp's longitude and latitude. The same house as surveyors write it, positive to the south and
 * the west, in either order. */
static void prague(void **state) {
    (void)state;
    const double x = -568990.997, y = -1050538.643; /* easting, northing: EPSG:5514 */
    double lonlat[2];
    noc_scene *scene;
    helmert(bessel, (double[]){ 572.213, 85.334, 461.94, 4.9732, 1.529, 5.2484, 3.5378 }, 16 + 50 / 60. + 59.179 / 3600,
            50 + 12 / 60. + 32.442 / 3600, lonlat);
    copy_recipe("prague.yaml");
    assert_int_equal(mkdir(in_folder("prague"), 0700), 0);
    write_lamp("prague/lamps.json", lonlat[0], lonlat[1]);
    write_house("prague/BD3_Prah57.gml", NULL, x - 25, y - 15, false);
    assert_int_equal(load("prague.yaml", NULL, &scene), NOC_OK);
    noc_scene_info info;
    noc_scene_get_info(scene, &info);
    assert_string_equal(info.crs, "EPSG:5514 (S-JTSK / Krovak East North)");
    assert_true(lamp_off(scene, NULL, x, y) < 0.5);
    assert_string_equal(warnings, "");
    noc_scene_destroy(scene);
    for (int exchanged = 0; exchanged < 2; exchanged++) {
        write_house("prague/BD3_Prah57.gml", NULL, -x + 5, -y + 5, exchanged);
        if (load("prague.yaml", "EPSG:5513", &scene))
            fail_msg("%s", errors);
        double corner[3] = { x - 25, y - 15, 200 };
        assert_int_equal(noc_scene_to_local(scene, "EPSG:5514", corner), NOC_OK);
        assert_true(lamp_off(scene, "EPSG:5514", x, y) < 0.5);
        double roof, beside; /* the house lies as it did */
        assert_true(noc_scene_top(scene, corner[0] - 1, corner[1] - 1, &beside));
        for (int k = 0; k < 10; k++) {
            assert_true(noc_scene_top(scene, corner[0] + 1 + 2 * k, corner[1] + .5 + k, &roof));
            assert_true(roof > beside + 10);
        }
        noc_scene_destroy(scene);
    }
    /* as they are and called what they are not: it is told what they may be */
    assert_int_equal(load("prague.yaml", NULL, &scene), NOC_ERR_FORMAT); /* its lamp is elsewhere then */
    assert_non_null(strstr(errors, "is one of the CRSs wrong"));
    assert_non_null(strstr(warnings, "far outside the area that EPSG:5514"));
    assert_non_null(strstr(warnings, "EPSG:5513"));
    noc_scene_destroy(scene);
}

/* Westertoren: RD and WGS 84 as published (Schreutelkamp and Strang van Hees, Geodesia 2001). */
static void rotterdam(void **state) {
    (void)state;
    noc_scene *scene;
    copy_recipe("rotterdam-portal.yaml");
    assert_int_equal(mkdir(in_folder("rotterdam"), 0700), 0);
    write_lamp("rotterdam/lamps.json", 4.88352559, 52.37453253);
    write_house("rotterdam/gebouwen.gml", NULL, 120700.723 + 5, 487525.501 + 5, false);
    assert_int_equal(load("rotterdam-portal.yaml", NULL, &scene), NOC_OK);
    assert_true(lamp_off(scene, NULL, 120700.723, 487525.501) < 0.5);
    noc_scene_destroy(scene);
}

/* Transverse Mercator of zone 8 (central meridian -73.5, scale .9999, false easting 304800) by the series of EPSG
 * Guidance Note 7-2, USGS formulas: near the meridian their first terms are good to a millimetre. Then NAD83(CSRS) to
 * WGS 84 (2) of EPSG (coordinate frame, so its rotations have the other sign): a metre between the two. */
static void montreal(void **state) {
    (void)state;
    const double lon = -73.5617, lat = 45.5088;
    double f = 1 / 298.257222101, e2 = f * (2 - f), d2 = e2 / (1 - e2), phi = lat * M_PI / 180, a = 6378137;
    double n = a / sqrt(1 - e2 * sin(phi) * sin(phi)), t = tan(phi) * tan(phi), c = d2 * cos(phi) * cos(phi),
           q = (lon + 73.5) * M_PI / 180 * cos(phi);
    double m =
        a * ((1 - e2 / 4 - 3 * e2 * e2 / 64 - 5 * e2 * e2 * e2 / 256) * phi -
             (3 * e2 / 8 + 3 * e2 * e2 / 32 + 45 * e2 * e2 * e2 / 1024) * sin(2 * phi) +
             (15 * e2 * e2 / 256 + 45 * e2 * e2 * e2 / 1024) * sin(4 * phi) - 35 * e2 * e2 * e2 / 3072 * sin(6 * phi));
    double x = 304800 + 0.9999 * n * (q + (1 - t + c) * q * q * q / 6);
    double y = 0.9999 * (m + n * tan(phi) * (q * q / 2 + (5 - t + 9 * c + 4 * c * c) * q * q * q * q / 24));
    noc_scene *scene;
    copy_recipe("montreal.yaml");
    assert_int_equal(mkdir(in_folder("montreal"), 0700), 0);
    double lonlat[2];
    helmert(grs80, (double[]){ -0.991, 1.9072, 0.5129, 0.0257899, 0.0096501, 0.0116599, 0 }, lon, lat, lonlat);
    write_lamp("montreal/lamps.json", lonlat[0], lonlat[1]);
    write_house("montreal/VM05_2009.gml", NULL, x + 5, y + 5, false);
    assert_int_equal(load("montreal.yaml", NULL, &scene), NOC_OK);
    print_message("# the lamp is %.3f m off\n", lamp_off(scene, NULL, x, y));
    assert_true(lamp_off(scene, NULL, x, y) < 0.5);
    noc_scene_destroy(scene);
}

static int start(void **state) {
    (void)state;
    return !mkdtemp(folder);
}

static int finish(void **state) {
    char command[100];
    (void)state;
    snprintf(command, sizeof(command), "rm -r %s", folder);
    noc_log_destroy(told);
    return system(command);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(files_are_missing),
        cmocka_unit_test(prague),
        cmocka_unit_test(rotterdam),
        cmocka_unit_test(montreal),
    };
    return cmocka_run_group_tests(tests, start, finish);
}
