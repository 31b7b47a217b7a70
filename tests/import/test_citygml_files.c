/* CityGML as it is found: real models, broken ones, and models broken on purpose. */
#include "city_sink.h"

#include <glob.h>
#include <zlib.h>

static city_sink sink;

static int finish(void **state) {
    (void)state;
    city_clear(&sink);
    sink.lat_first = false;
    return 0;
}

/* Files of one level of detail: what is used must be what was counted in them by other means (shared/data/README.md).
 */
static void test_models_of_one_level(void **state) {
    (void)state;
    static const city_file files[] = {
        { "berlin/berlin_mitte_lod2_v10.gml.gz", "CityGML 1.0", 61, 1125, 5, "EPSG:25833" },
        { "dresden/LoD2_33_416_5656_2_SN_14_Buildings.gml.gz", "CityGML 1.0", 14, 586, 1,
          "urn:adv:crs:ETRS89_UTM33*DE_DHHN2016_NH" },
        { "nrw/LoD2_32_280_5659_1_NW.gml.gz", "CityGML 1.0", 109, 1441, 0,
          "urn:adv:crs:ETRS89_UTM32*DE_DHHN2016_NH*GCG2016" },
        { "zurich/zurich-lod2-citygml1.gml", "CityGML 1.0", 4, 61, 0, "CH1903" },
        { "denhaag/dh_1.gml", "CityGML 1.0", 1, 52, 0, "urn:ogc:def:crs:EPSG::28992" },
        { "potsdam/Potsdam_LoD1.gml.gz", "CityGML 1.0", 97, 1547, 0,
          "urn:ogc:def:crs,crs:EPSG:6.12:25833,crs:EPSG:6.12:5783" },
        { "helsinki/viikintiedepuisto.gml.gz", "CityGML 2.0", 23, 1080, 6, "urn:ogc:def:crs:EPSG::3879" },
        { "lyon/LYON_1ER_BATI_2015_small_house.gml", "CityGML 2.0", 1, 7, 0, "(none)" },
        { "plateau_tamana/49303414_brid_6697_op.gml.gz", "CityGML 2.0", 3, 1772, 0,
          "http://www.opengis.net/def/crs/EPSG/0/6697" },
        { "plateau_yokosuka/523965_dem_6697_05_op.gml.gz", "CityGML 2.0", 2, 1066, 0,
          "http://www.opengis.net/def/crs/EPSG/0/6697" },
        { "samples/citygml4j/lod3_building_v2.gml.gz", "CityGML 2.0", 1, 3092, 0,
          "urn:ogc:def:crs,crs:EPSG:6.12:3068,crs:EPSG:6.12:5783" },
        { "samples/ogc_xlink/3_Building_With_Nested_Features__CityGML_2.gml", "CityGML 2.0", 1, 17, 1,
          "urn:adv:crs:ETRS89_UTM32*DE_DHHN92_NH" },
        { "samples/ogc_xlink/4_Cross-Top-Level-XLink__CityGML_2.gml", "CityGML 2.0", 2, 14, 0, "(none)" },
        { "samples/ogc_xlink/5_Building_with_Building_Installation__CityGML_2.gml.gz", "CityGML 2.0", 1, 3142, 665,
          "EPSG:25832" },
        { "samples/citygml4j/lod2_buildings_v3.gml.gz", "CityGML 3.0", 100, 700, 0,
          "urn:ogc:def:crs,crs:EPSG:6.12:3068,crs:EPSG:6.12:5783" },
    };
    city_files(&sink, files, NOC_COUNT(files));
}

/* Models that are there in version 2.0 and in 3.0: as many surfaces of each class. */
static void test_versions(void **state) {
    (void)state;
    static const char *const pairs[][2] = {
        { "berlin/Berlin_Moabit_1Bldg_v2.gml", "berlin/Berlin_Moabit_1Bldg_v3.gml" },
        { "samples/ogc_v2/Building_LOD0-EPSG25832.gml", "samples/ogc_v3/Building_LOD0-EPSG25832.gml" },
        { "samples/ogc_v2/Building_LOD1-EPSG25832.gml", "samples/ogc_v3/Building_LOD1-EPSG25832.gml" },
        { "samples/ogc_v2/Building_LOD2-EPSG25832.gml", "samples/ogc_v3/Building_LOD2-EPSG25832.gml" },
        { "samples/ogc_v2/Building_LOD3-EPSG25832.gml", "samples/ogc_v3/Building_LOD3-EPSG25832.gml.gz" },
        { "samples/ogc_xlink/1_SimpleBuilding__CityGML_2.gml", "samples/ogc_xlink/1_SimpleBuilding__CityGML_3.gml" },
        { "samples/ogc_xlink/2_SimpleBuilding_Roof_Overhangs__CityGML_2.gml",
          "samples/ogc_xlink/2_SimpleBuilding_Roof_Overhangs__CityGML_3.gml" },
        { "samples/ogc_xlink/3_Building_With_Nested_Features__CityGML_2.gml",
          "samples/ogc_xlink/3_Building_With_Nested_Features__CityGML_3.gml" },
        { "samples/ogc_xlink/5_Building_with_Building_Installation__CityGML_2.gml.gz",
          "samples/ogc_xlink/5_Building_with_Building_Installation__CityGML_3.gml.gz" },
    };
    size_t present = 0;
    for (size_t i = 0; i < NOC_COUNT(pairs); i++) {
        size_t classes[2][NOC_CLASS_COUNT] = { { 0 } }, read = 0;
        for (int version = 0; version < 2; version++) {
            char *relative = noc_format("data/cities/%s", pairs[i][version]);
            const char *path = shared_path(relative);
            free(relative);
            if (!path)
                continue;
            assert_int_equal(city_read(&sink, path, 3), NOC_OK);
            read += !version || !strcmp(sink.format, "CityGML 3.0");
            for (size_t k = 0; k < sink.polygons.len; k++)
                classes[version][sink.polygons.data[k].cls]++;
        }
        present += read == 2;
        for (int c = 0; c < NOC_CLASS_COUNT && read == 2; c++)
            if (classes[0][c] != classes[1][c])
                fail_msg("%s: %zu surfaces of %s, not %zu", pairs[i][1], classes[1][c], noc_class_name((noc_class)c),
                         classes[0][c]);
    }
    if (!present) {
        print_message("# skipped: shared/data/cities is not here\n");
        skip();
    }
}

static void test_ingolstadt(void **state) {
    (void)state;
    REQUIRE_SHARED(path, "data/cities/ingolstadt/ingolstadt_lod3_combined.gml.gz")
    assert_int_equal(city_read(&sink, path, 3), NOC_OK);
    assert_int_equal(sink.objects.len, 54);
    assert_int_equal(sink.polygons.len + city_issue(&sink, "polygon given twice"), 50696);
    assert_int_equal(geo_issues_count(sink.sink.issues), 1);
    for (size_t i = 0; i < sink.objects.len; i++)
        assert_int_equal(sink.objects.data[i].lod, 3);
    const double low[3] = { 678016.1, 5403455.7, 412.9 }, high[3] = { 678206.8, 5403946.5, 437 };
    size_t windows = 0;
    for (size_t i = 0; i < sink.polygons.len; i++) {
        const seen_polygon *p = &sink.polygons.data[i];
        windows += p->cls == NOC_CLASS_WINDOW;
        for (size_t k = 0; k < 3 * p->points; k++)
            assert_true(p->xyz[k] > low[k % 3] && p->xyz[k] < high[k % 3]);
    }
    assert_true(windows > 1054); /* each of the 1054 windows has one polygon at least */
}

static void test_levels_of_plateau(void **state) {
    (void)state;
    REQUIRE_SHARED(path, "data/cities/plateau_kawasaki/53392642_bldg_6697_op2.gml.gz")
    char *file = noc_strdup(path);
    sink.lat_first = true;
    assert_int_equal(city_read(&sink, file, 3), NOC_OK);
    assert_int_equal(sink.polygons.len, 540); /* as many as its solids refer to */
    for (size_t i = 0; i < sink.polygons.len; i++) {
        const double *q = sink.polygons.data[i].xyz;
        assert_true(q[0] > 139.6 && q[0] < 139.8 && q[1] > 35.4 && q[1] < 35.6); /* easting first */
    }
    for (int lod = 2; lod >= 0; lod--) {
        assert_int_equal(city_read(&sink, file, lod), NOC_OK);
        assert_int_equal(sink.objects.len, 8);
        for (size_t i = 0; i < sink.objects.len; i++)
            assert_int_equal(sink.objects.data[i].lod, lod);
    }
    assert_int_equal(sink.polygons.len, 8); /* an outline each */
    free(file);
}

/* ---- what is broken ---- */

static void test_bad_files(void **state) {
    (void)state;
    REQUIRE_SHARED(bad, "data/bad")
    char *pattern = noc_format("%s/*/*.gml*", bad);
    glob_t files;
    assert_int_equal(glob(pattern, 0, NULL, &files), 0);
    free(pattern);
    assert_true(files.gl_pathc > 0);
    size_t errors = 0;
    for (size_t i = 0; i < files.gl_pathc; i++) {
        noc_status status = city_read(&sink, files.gl_pathv[i], 3);
        errors += status != NOC_OK;
        /* An error says what and where; otherwise there is something to show, or the reason why not. */
        if (status)
            assert_non_null(strstr(noc_log_last_error(sink.sink.log), ".gml"));
        else
            assert_true(sink.polygons.len > 0 || geo_issues_count(sink.sink.issues) > 0);
    }
    globfree(&files);
    assert_true(errors < files.gl_pathc);
}

static void test_known_faults(void **state) {
    (void)state;
    const struct {
        const char *path, *reason;
        size_t count;
    } faults[] = {
        { "citygml-qie/i101_1.gml", "ring with too few points", 1 },
        { "citygml-qie/i103_1.gml", "ring not closed", 1 },
        { "plateau/53396570_squr_crossfile_xlinks.gml.gz", "xlink into another file", 5512 },
    };
    REQUIRE_SHARED(there, "data/bad")
    (void)there;
    for (size_t i = 0; i < NOC_COUNT(faults); i++) {
        char *relative = noc_format("data/bad/%s", faults[i].path);
        assert_int_equal(city_read(&sink, shared_path(relative), 3), NOC_OK);
        assert_int_equal(city_issue(&sink, faults[i].reason), faults[i].count);
        free(relative);
    }
    assert_int_equal(city_read(&sink, shared_path("data/bad/plateau/53392642_unbound_prefix.gml.gz"), 3),
                     NOC_ERR_FORMAT);
    assert_non_null(strstr(noc_log_last_error(sink.sink.log), "unbound_prefix.gml.gz:538: unbound prefix"));
}

/* ---- what we break ---- */

static const char small[] =
    "<?xml version='1.0' encoding='UTF-8'?>\n"
    "<core:CityModel xmlns:core='http://www.opengis.net/citygml/2.0' xmlns:gml='http://www.opengis.net/gml'\n"
    " xmlns:bldg='http://www.opengis.net/citygml/building/2.0' xmlns:xlink='http://www.w3.org/1999/xlink'>\n"
    "<gml:boundedBy><gml:Envelope srsName='EPSG:25832'/></gml:boundedBy>\n"
    "<core:cityObjectMember><bldg:Building gml:id='A'><bldg:lod2Solid><gml:Solid><gml:exterior><gml:CompositeSurface>\n"
    "<gml:surfaceMember xlink:href='#r'/><gml:surfaceMember xlink:href='#w'/></gml:CompositeSurface></gml:exterior>\n"
    "</gml:Solid></bldg:lod2Solid><bldg:boundedBy><bldg:RoofSurface><bldg:lod2MultiSurface><gml:MultiSurface>\n"
    "<gml:surfaceMember><gml:Polygon gml:id='r'><gml:exterior><gml:LinearRing><gml:posList>1 2 3 4 5 6 7 8 9 1 2 3\n"
    "</gml:posList></gml:LinearRing></gml:exterior><gml:interior><gml:LinearRing><gml:pos>1 2 3</gml:pos>"
    "<gml:pos>1 3 3\n"
    "</gml:pos><gml:pos>2 2 3</gml:pos><gml:pos>1 2 3</gml:pos></gml:LinearRing></gml:interior></gml:Polygon>\n"
    "</gml:surfaceMember></gml:MultiSurface></bldg:lod2MultiSurface></bldg:RoofSurface></bldg:boundedBy>"
    "</bldg:Building>\n"
    "</core:cityObjectMember><core:cityObjectMember><bldg:Building><bldg:lod2MultiSurface><gml:MultiSurface>\n"
    "<gml:surfaceMember><gml:OrientableSurface orientation='-'><gml:baseSurface><gml:Polygon gml:id='w'>"
    "<gml:exterior>\n"
    "<gml:LinearRing><gml:coordinates>0,0,0 1,0,0 1,1,0 0,0,0</gml:coordinates></gml:LinearRing></gml:exterior>\n"
    "</gml:Polygon></gml:baseSurface></gml:OrientableSurface></gml:surfaceMember></gml:MultiSurface>\n"
    "</bldg:lod2MultiSurface></bldg:Building></core:cityObjectMember></core:CityModel>\n";

/* Whatever comes: either it is read, or there is an error with a text. */
static void expect_civil(const char *data, size_t size) {
    if (city_read_bytes(&sink, data, size, 3) != NOC_OK)
        assert_true(*noc_log_last_error(sink.sink.log));
}

static void test_mutations(void **state) {
    (void)state;
    assert_int_equal(city_read_bytes(&sink, small, sizeof(small) - 1, 3), NOC_OK);
    assert_int_equal(sink.polygons.len, 2);
    assert_int_equal(geo_issues_count(sink.sink.issues), 0);
    uint32_t x = 12345;
    char *text = noc_alloc(2 * sizeof(small));
    for (int round = 0; round < 1500; round++) {
        size_t n = sizeof(small) - 1;
        memcpy(text, small, n);
        for (int change = 0; change <= round % 4; change++) {
            x = x * 1664525u + 1013904223u;
            size_t at = (x >> 8) % n, from = (x >> 3) % n, length = NOC_MIN((x >> 20) % 90, n - NOC_MAX(at, from));
            if (x >> 31)
                text[at] = "0<>/'\"# -.,9e&\n\xff"[x >> 5 & 15];
            else
                memmove(text + at, text + from, length);
        }
        expect_civil(text, n);
    }
    free(text);
}

static void test_garbage(void **state) {
    (void)state;
    uint32_t x = 99;
    char text[4096];
    for (int round = 0; round < 100; round++) {
        for (size_t i = 0; i < sizeof(text); i++)
            text[i] = (char)((x = x * 1664525u + 1013904223u) >> 24);
        text[0] = '<'; /* past the stream's magic numbers */
        assert_int_not_equal(city_read_bytes(&sink, text, sizeof(text), 3), NOC_OK);
    }
}

/* A real building, cut at many places: before decompression and after. */
static void test_cut_building(void **state) {
    (void)state;
    REQUIRE_SHARED(path, "data/cities/ingolstadt/lod3/4018302/4018302.gml.gz")
    gzFile gz = gzopen(path, "rb");
    assert_non_null(gz);
    NOC_ARRAY(char) text = { 0 };
    for (int n = 1; n > 0; text.len += (size_t)n) {
        assert_true(array_reserve(&text, text.len + 65536));
        n = gzread(gz, text.data + text.len, 65536);
        assert_true(n >= 0);
    }
    gzclose(gz);
    assert_int_equal(city_read_bytes(&sink, text.data, text.len, 3), NOC_OK);
    assert_true(sink.polygons.len > 0);
    size_t end = text.len;
    while (text.data[end - 1] != '>') /* blanks after the end are no loss */
        end--;
    for (size_t i = 1; i <= 40; i++)
        assert_int_equal(city_read_bytes(&sink, text.data, (end - 1) * i / 40, 3), NOC_ERR_FORMAT);
    array_free(&text);

    FILE *f = fopen(path, "rb");
    assert_non_null(f);
    static char packed[1 << 20];
    size_t n = fread(packed, 1, sizeof(packed), f);
    fclose(f);
    for (size_t i = 1; i <= 20; i++)
        assert_int_equal(city_read_bytes(&sink, packed, (n - 1) * i / 20, 3), NOC_ERR_FORMAT);
}

int main(void) {
#define T(f) cmocka_unit_test_teardown(f, finish)
    const struct CMUnitTest tests[] = {
        T(test_models_of_one_level), T(test_versions),  T(test_ingolstadt),
        T(test_levels_of_plateau),   T(test_bad_files), T(test_known_faults),
        T(test_mutations),           T(test_garbage),   T(test_cut_building),
    };
    return cmocka_run_group_tests_name("import/citygml_files", tests, NULL, NULL);
}
