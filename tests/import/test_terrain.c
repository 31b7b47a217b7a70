/* Terrain: triangles of a grid without cracks and within their error, and GeoTIFFs that GDAL writes here. */
#include "city_sink.h"

#include "import/load/load.h"
#include "import/terrain_grid.h"
#include "noc_config.h"
#include <nocturne/nocturne.h>

#include <math.h>

/* ---- the grid ---- */

static terrain_grid grid_of(size_t width, size_t height, double (*z)(double x, double y)) {
    terrain_grid g = { .width = width, .height = height, .z = noc_alloc(width * height * sizeof(float)) };
    for (size_t y = 0; y < height; y++)
        for (size_t x = 0; x < width; x++)
            g.z[y * width + x] = (float)z((double)x, (double)y);
    assert_true(terrain_grid_measure(&g));
    return g;
}

static double plane(double x, double y) { return 3 + 0.25 * x - 0.5 * y; }
static double hill(double x, double y) {
    return 20 * exp(-((x - 40) * (x - 40) + (y - 25) * (y - 25)) / 150) + sin(x / 3) * cos(y / 5);
}
static double island(double x, double y) { return hypot(x - 20, y - 20) < 15.3 ? hill(x, y) : (double)NAN; }

typedef struct surface {
    const terrain_grid *g;
    double area, worst;
    NOC_ARRAY(uint64_t) sides; /* of triangles, in their direction */
} surface;

static uint64_t side_of(const uint32_t a[2], const uint32_t b[2]) {
    return (uint64_t)a[0] << 48 | (uint64_t)a[1] << 32 | (uint64_t)b[0] << 16 | b[1];
}

static bool add(void *ctx, const uint32_t c[3][2]) {
    surface *s = ctx;
    const double ax = c[0][0], ay = c[0][1], bx = c[1][0], by = c[1][1], cx = c[2][0], cy = c[2][1];
    double twice = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
    s->area += fabs(twice) / 2;
    for (int i = 0; i < 3; i++)
        assert_true(array_push(&s->sides, side_of(c[i], c[(i + 1) % 3])));
    size_t w = s->g->width;
    for (size_t y = 0; y < s->g->height; y++)
        for (size_t x = 0; x < w; x++) {
            double u = (((double)x - ax) * (cy - ay) - ((double)y - ay) * (cx - ax)) / twice;
            double v = ((bx - ax) * ((double)y - ay) - (by - ay) * ((double)x - ax)) / twice;
            if (u < 0 || v < 0 || u + v > 1)
                continue;
            double za = (double)s->g->z[c[0][1] * w + c[0][0]], zb = (double)s->g->z[c[1][1] * w + c[1][0]],
                   zc = (double)s->g->z[c[2][1] * w + c[2][0]];
            s->worst = fmax(s->worst, fabs(za + u * (zb - za) + v * (zc - za) - (double)s->g->z[y * w + x]));
        }
    return true;
}

static int by_value(const void *a, const void *b) {
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return x < y ? -1 : x > y;
}

/* Sides that no neighbour has: those of the rim, and of cracks. */
static double open_length(surface *s) {
    double length = 0;
    qsort(s->sides.data, s->sides.len, sizeof(uint64_t), by_value);
    for (size_t i = 0; i < s->sides.len; i++) {
        uint64_t side = s->sides.data[i], other = side >> 32 | side << 32;
        double x = (double)(side >> 48) - (double)(side >> 16 & 0xffff),
               y = (double)(side >> 32 & 0xffff) - (double)(side & 0xffff);
        if (!bsearch(&other, s->sides.data, s->sides.len, sizeof(uint64_t), by_value))
            length += hypot(x, y);
    }
    return length;
}

static size_t check(terrain_grid *g, double error, double area, double rim) {
    surface s = { .g = g };
    assert_true(terrain_grid_emit(g, error, add, &s));
    size_t triangles = s.sides.len / 3;
    assert_int_equal(triangles, terrain_grid_count(g, error));
    assert_float_equal(s.area, area, 1e-6);
    assert_float_equal(open_length(&s), rim, 1e-6);
    assert_true(s.worst <= 2 * error + 1e-4); /* errors of halves of halves may add up */
    array_free(&s.sides);
    return triangles;
}

static void test_grid(void **state) {
    terrain_grid g = grid_of(33, 33, plane);
    assert_int_equal(check(&g, 0.001, 32 * 32, 4 * 32), 2); /* flat */
    terrain_grid_free(&g);
    g = grid_of(65, 65, hill);
    size_t whole = check(&g, 0, 64 * 64, 4 * 64), some = check(&g, 0.1, 64 * 64, 4 * 64),
           few = check(&g, 1, 64 * 64, 4 * 64);
    assert_true(whole <= 2 * 64 * 64 && some < whole && few < some / 3 && few > 20);
    /* a budget: the error grows until it is kept */
    double error = terrain_grid_error(&g, 0.1, some / 2);
    size_t half = terrain_grid_count(&g, error);
    assert_true(error > 0.1 && half <= some / 2 && half > some / 4);
    assert_true(terrain_grid_error(&g, 0.1, some) == 0.1);
    terrain_grid_free(&g);
    /* sides that are no power of two, and the smallest grid */
    g = grid_of(50, 21, hill);
    check(&g, 0.2, 49 * 20, 2 * (49 + 20));
    terrain_grid_free(&g);
    g = grid_of(2, 2, hill);
    assert_int_equal(check(&g, 0, 1, 4), 2);
    terrain_grid_free(&g);
}

static void test_holes(void **state) {
    terrain_grid g = grid_of(41, 41, island);
    surface fine = { .g = &g }, coarse = { .g = &g };
    assert_true(terrain_grid_emit(&g, 0, add, &fine) && terrain_grid_emit(&g, 5, add, &coarse));
    assert_true(coarse.sides.len < fine.sides.len);
    assert_float_equal(coarse.area, fine.area, 1e-6); /* the shore stays where it is */
    assert_true(fine.area > 0.85 * 3.14159 * 15.3 * 15.3);
    double rim = open_length(&fine), other = open_length(&coarse);
    assert_float_equal(rim, other, 1e-6);
    array_free(&fine.sides);
    array_free(&coarse.sides);
    terrain_grid_free(&g);
}

/* ---- GeoTIFF ---- */

#if NOC_HAVE_GDAL
#include <cpl_error.h>
#include <gdal.h>
#include <ogr_srs_api.h>

typedef struct tiff {
    const char *crs, *unit;
    double none; /* NaN: not said */
    double scale;
    int width, height, bands;
    bool nowhere;
    GDALDataType type;
} tiff;

static char path[] = "/tmp/noc-terrain-XXXXXX";

static void write_tiff(const tiff *of, const float *z) {
    GDALAllRegister();
    GDALDatasetH set = GDALCreate(GDALGetDriverByName("GTiff"), path, of->width, of->height, of->bands ? of->bands : 1,
                                  of->type ? of->type : GDT_Float32, NULL);
    assert_non_null(set);
    double place[] = { 690000, 2, 0, 5330000, 0, -2 };
    if (!of->nowhere)
        GDALSetGeoTransform(set, place);
    OGRSpatialReferenceH srs = OSRNewSpatialReference(NULL);
    if (of->crs && OSRSetFromUserInput(srs, of->crs) == OGRERR_NONE)
        GDALSetSpatialRef(set, srs);
    OSRDestroySpatialReference(srs);
    GDALRasterBandH band = GDALGetRasterBand(set, 1);
    if (isfinite(of->none))
        GDALSetRasterNoDataValue(band, of->none);
    if (of->unit)
        GDALSetRasterUnitType(band, of->unit);
    if (of->scale > 0)
        GDALSetRasterScale(band, of->scale);
    assert_int_equal(GDALRasterIO(band, GF_Write, 0, 0, of->width, of->height, (void *)z, of->width, of->height,
                                  GDT_Float32, 0, 0),
                     CE_None);
    GDALClose(set);
}

static noc_status read_tiff(city_sink *s, const tiff *of, const float *z) {
    write_tiff(of, z);
    s->reader = &noc_reader_terrain;
    return city_read(s, path, 3);
}

static void refuse(city_sink *s, const tiff *of, const float *z, const char *part) {
    assert_true(read_tiff(s, of, z) != NOC_OK);
    if (!strstr(noc_log_last_error(s->sink.log), part))
        fail_msg("\"%s\" does not say \"%s\"", noc_log_last_error(s->sink.log), part);
}

static double highest(const city_sink *s) {
    double z = -INFINITY;
    for (size_t i = 0; i < s->polygons.len; i++)
        for (size_t k = 0; k < s->polygons.data[i].points; k++)
            z = fmax(z, s->polygons.data[i].xyz[3 * k + 2]);
    return z;
}

static void test_tiff(void **state) {
    city_sink s = { 0 };
    const float z[] = { 100, 101, 102, 100, 150, 102, 100, 101, 102 };
    tiff of = { .crs = "EPSG:25832", .none = NAN, .width = 3, .height = 3 };
    assert_int_equal(read_tiff(&s, &of, z), NOC_OK);
    assert_string_equal(s.format, "GeoTIFF");
    assert_string_equal(s.crs.data[0], "EPSG:25832");
    assert_int_equal(s.objects.len, 1);
    assert_int_equal(s.objects.data[0].kind, GEO_TERRAIN);
    assert_int_equal(s.polygons.len, 4);
    double area = 0;
    for (size_t i = 0; i < s.polygons.len; i++) {
        const double *p = s.polygons.data[i].xyz;
        double twice = (p[3] - p[0]) * (p[7] - p[1]) - (p[4] - p[1]) * (p[6] - p[0]);
        assert_int_equal(s.polygons.data[i].cls, NOC_CLASS_TERRAIN);
        assert_true(twice > 0); /* seen from above */
        area += twice / 2;
        for (int k = 0; k < 3; k++) { /* heights are those of the middles of cells */
            int column = (int)lround((p[3 * k] - 690001) / 2), row = (int)lround((5329999 - p[3 * k + 1]) / 2);
            assert_float_equal(p[3 * k], 690001 + 2 * column, 1e-6);
            assert_float_equal(p[3 * k + 2], (double)z[3 * row + column], 1e-4);
        }
    }
    assert_float_equal(area, 16, 1e-6);
    /* units, scales, heights that are missing */
    of.unit = "ft";
    assert_int_equal(read_tiff(&s, &of, z), NOC_OK);
    assert_float_equal(highest(&s), 150, 1e-3);
    assert_float_equal(s.metres, 0.3048, 1e-9);
    of.unit = "metre"; /* whatever the CRS's unit is */
    assert_int_equal(read_tiff(&s, &of, z), NOC_OK);
    assert_float_equal(s.metres, 1, 1e-9);
    of.unit = NULL, of.scale = 0.1;
    assert_int_equal(read_tiff(&s, &of, z), NOC_OK);
    assert_float_equal(highest(&s), 15, 1e-3);
    of.scale = 0, of.none = 102;
    assert_int_equal(read_tiff(&s, &of, z), NOC_OK);
    assert_int_equal(s.polygons.len, 3); /* of the two cells of the first columns */
    assert_int_equal(geo_issues_count(s.sink.issues), 0);
    const float holes[] = { 1, 2, -9999, 4, 5, 6, 7, 1e9f, 9 };
    of.none = NAN;
    assert_int_equal(read_tiff(&s, &of, holes), NOC_OK);
    assert_float_equal(highest(&s), 9, 1e-3);
    assert_int_equal(city_issue(&s, "height such as -9999, taken as missing"), 1);
    assert_int_equal(city_issue(&s, "height that no ground has"), 1);
    /* what is no terrain */
    of.bands = 3;
    refuse(&s, &of, z, "a picture, no terrain");
    of.bands = 1, of.nowhere = true;
    refuse(&s, &of, z, "does not say where it lies");
    of.nowhere = false, of.width = 1;
    refuse(&s, &of, z, "fewer than 2 x 2");
    of.width = 3, of.none = 7;
    const float nothing[] = { 7, 7, 7, 7, 7, 7, 7, 7, 7 };
    refuse(&s, &of, nothing, "without a height");
    FILE *f = fopen(path, "r+");
    assert_int_equal(ftruncate(fileno(f), 100), 0);
    fclose(f);
    assert_true(city_read(&s, path, 3) != NOC_OK);
    /* the sink may end it */
    of.none = NAN;
    s.stop_at = 4;
    assert_int_equal(read_tiff(&s, &of, z), NOC_ERR_CANCELLED);
    s.stop_at = 0;
    s.max_memory = 1e-8;
    of.width = of.height = 3;
    assert_int_equal(read_tiff(&s, &of, z), NOC_ERR_MEMORY);
    city_clear(&s);
}

/* A grid that is larger than what is kept of it. */
static void test_large(void **state) {
    enum { SIDE = 9000 };
    city_sink s = { 0 };
    float *z = noc_calloc((size_t)SIDE * 4, sizeof(*z));
    for (size_t i = 0; i < (size_t)SIDE * 4; i++)
        z[i] = i % SIDE < SIDE / 2 ? 10 : 20;
    assert_int_equal(read_tiff(&s, &(tiff){ .crs = "EPSG:25832", .none = NAN, .width = SIDE, .height = 4 }, z),
                     NOC_ERR_UNSUPPORTED); /* of its four rows one would stay */
    free(z);
    enum { WIDE = 4500, HIGH = 40 };
    z = noc_calloc((size_t)WIDE * HIGH, sizeof(*z));
    for (size_t i = 0; i < (size_t)WIDE * HIGH; i++)
        z[i] = i % WIDE < WIDE / 2 ? 10 : 20;
    assert_int_equal(read_tiff(&s, &(tiff){ .crs = "EPSG:25832", .none = NAN, .width = WIDE, .height = HIGH }, z),
                     NOC_OK);
    free(z);
    double low = INFINITY, high = -INFINITY;
    for (size_t i = 0; i < s.polygons.len; i++)
        for (size_t k = 0; k < 3; k++) {
            low = fmin(low, s.polygons.data[i].xyz[3 * k]);
            high = fmax(high, s.polygons.data[i].xyz[3 * k]);
        }
    assert_float_equal(low, 690002, 1e-6); /* middles of 2 x 2 cells */
    assert_float_equal(high, 690000 + 2 * WIDE - 2, 1e-6);
    assert_float_equal(highest(&s), 20, 0);
    city_clear(&s);
}

/* By the helper and in this process, the same scene. */
static void test_isolated(void **state) {
    float z[25 * 25];
    for (int i = 0; i < 25 * 25; i++)
        z[i] = (float)hill(2 * (i % 25), 2. * (i / 25));
    write_tiff(&(tiff){ .crs = "EPSG:25832", .none = NAN, .width = 25, .height = 25 }, z);
    noc_log *log = noc_log_create(NULL);
    size_t triangles[2];
    for (int isolate = 0; isolate < 2; isolate++) {
        noc_import_params params = noc_import_default_params();
        params.isolate = isolate;
        params.infer_lamps = NOC_SWITCH_OFF;
        noc_scene *scene = noc_scene_create(log);
        const char *paths[] = { path };
        noc_scene_info info;
        if (noc_scene_load(scene, paths, 1, &params, NULL) != NOC_OK)
            fail_msg("%s", noc_log_last_error(log));
        noc_scene_get_info(scene, &info);
        triangles[isolate] = info.triangles_by_class[NOC_CLASS_TERRAIN];
        assert_true(triangles[isolate] > 100);
        noc_scene_destroy(scene);
    }
    assert_int_equal(triangles[0], triangles[1]);
    noc_log_destroy(log);
}

static int make_path(void **state) {
    int fd = mkstemp(path);
    close(fd);
    return fd < 0;
}
static int remove_path(void **state) { return unlink(path); }
#endif

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_grid),
        cmocka_unit_test(test_holes),
#if NOC_HAVE_GDAL
        cmocka_unit_test_setup_teardown(test_tiff, make_path, NULL),
        cmocka_unit_test(test_large),
        cmocka_unit_test_setup_teardown(test_isolated, NULL, remove_path),
#endif
    };
    return cmocka_run_group_tests_name("import/terrain", tests, NULL, NULL);
}
