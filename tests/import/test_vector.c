/* Lamps from OSM, GeoJSON and CSV: counts in real data, and broken files. */
#include "lamp_sink.h"

#include "import/lamps/tags.h"
#include "noc_config.h"

#if NOC_HAVE_GDAL
#include <gdal.h>
#include <ogr_api.h>
#include <ogr_srs_api.h>
#endif

/* ---- real data ---- */

static const struct {
    const char *path, *format;
    size_t lamps, skipped;
} real[] = {
    { "data/lights/helsinki/Helsinki.osm.pbf", "OpenStreetMap PBF", 586, 0 },
    /* 4986 street_lamp (three of them drawn as lines) and 90 masts with tower:type=lighting */
    { "data/lights/berlin_neukoelln/man_made.geojson.gz", "GeoJSON", 4986 + 90, 0 },
    { "data/lights/berlin_neukoelln/street_furniture.geojson.gz", "GeoJSON", 4983, 0 },
    { "data/lights/berlin_neukoelln/neukoelln_osm2streets.osm.gz", "OpenStreetMap XML", 52, 0 },
    { "data/lights/berlin_tiergarten/berlin-siegessaeule.osm.gz", "OpenStreetMap XML", 47, 0 },
    { "data/lights/heidelberg/bus.osm.pbf", "OpenStreetMap PBF", 38, 0 },
    { "data/lights/monaco/monaco-latest.osm.pbf", "OpenStreetMap PBF", 17, 0 },
    { "data/lights/paris/paris_bss.osm.pbf", "OpenStreetMap PBF", 22, 0 },
    { "data/lights/utrecht/mastoverzicht.geojson.gz", "GeoJSON", 9793, 0 },
    { "data/lights/washington_dc/streetlights.csv.gz", "CSV", 3963, 0 },
    { "data/lights/worcester_ma/street_lamps.geojson.gz", "GeoJSON", 272, 8 }, /* eight rows have no geometry */
    { "data/lights/kamiyama/street_lamps.geojson", "GeoJSON", 11, 0 },
    { "data/lights/ingolstadt/ingolstadt_street_lamps.geojson", "GeoJSON", 40, 0 },
};

static void test_real_counts(void **state) {
    for (size_t i = 0; i < NOC_COUNT(real); i++) {
        if (!NOC_HAVE_GDAL && strcmp(real[i].format, "CSV"))
            continue;
        REQUIRE_SHARED(path, real[i].path);
        lamp_sink s;
        lamp_sink_start(&s);
        assert_int_equal(read_lamps(&s, path, NULL), NOC_OK);
        assert_string_equal(s.format, real[i].format);
        assert_int_equal(s.lamps.len, real[i].lamps);
        assert_int_equal(issue_count(&s, "without a place"), real[i].skipped);
        assert_true(!strcmp(s.crs, "OGC:CRS84") || !strcmp(s.crs, "EPSG:4326"));
        assert_int_equal(s.errors, 0);
        lamp_sink_end(&s);
    }
}

static void test_washington(void **state) {
    REQUIRE_SHARED(path, "data/lights/washington_dc/streetlights.csv.gz");
    lamp_sink s;
    lamp_sink_start(&s);
    assert_int_equal(read_lamps(&s, path, NULL), NOC_OK);
    size_t by_source[8] = { 0 }, tall = 0, warm = 0, watts = 0, two = 0;
    for (size_t i = 0; i < s.lamps.len; i++) {
        const geo_lamp *l = &s.lamps.data[i];
        by_source[l->source]++;
        tall += fabs(l->height - 30 * .3048) < 1e-9;
        warm += l->kelvin == 3000;
        watts += l->watts == 400;
        two += l->count == 2;
    }
    assert_int_equal(by_source[GEO_SOURCE_SODIUM], 3220);
    assert_int_equal(by_source[GEO_SOURCE_LED], 592);
    assert_int_equal(by_source[GEO_SOURCE_METAL_HALIDE], 88);
    assert_int_equal(by_source[GEO_SOURCE_MERCURY], 43);
    assert_int_equal(by_source[GEO_SOURCE_INCANDESCENT], 20);
    assert_int_equal(tall, 1103);
    assert_int_equal(warm, 245);
    assert_int_equal(watts, 1794);
    assert_int_equal(two, 782);
    const geo_lamp *l = lamp_by_id(&s, "60206");
    assert_int_equal(l->type, GEO_LAMP_LANTERN); /* Posttop */
    assert_float_equal(l->xyz[0], -77.01292467, 1e-9);
    assert_float_equal(l->xyz[1], 38.89604969, 1e-9);
    lamp_sink_end(&s);
}

static void test_heights(void **state) {
    if (!NOC_HAVE_GDAL)
        skip();
    REQUIRE_SHARED(utrecht, "data/lights/utrecht/mastoverzicht.geojson.gz");
    lamp_sink s;
    lamp_sink_start(&s);
    assert_int_equal(read_lamps(&s, utrecht, NULL), NOC_OK);
    size_t four = 0, unknown = 0;
    for (size_t i = 0; i < s.lamps.len; i++) {
        four += s.lamps.data[i].height == 4;
        unknown += isnan(s.lamps.data[i].height);
    }
    assert_int_equal(four, 4021);
    assert_int_equal(unknown, 67); /* MASTLENGTE 0 */
    lamp_sink_end(&s);
    REQUIRE_SHARED(ingolstadt, "data/lights/ingolstadt/ingolstadt_street_lamps.geojson");
    lamp_sink_start(&s);
    assert_int_equal(read_lamps(&s, ingolstadt, NULL), NOC_OK);
    assert_float_equal(s.lamps.data[0].height, 8.597, 1e-9);
    assert_float_equal(s.lamps.data[0].xyz[2], 414.805, 1e-9);
    lamp_sink_end(&s);
}

/* ---- CSV ---- */

static void expect_csv(const char *text, noc_status status, size_t lamps, const char *crs) {
    lamp_sink s;
    lamp_sink_start(&s);
    assert_int_equal(read_lamps_text(&s, text, NULL), status);
    assert_int_equal(s.lamps.len, lamps);
    assert_int_equal(s.errors, status != NOC_OK);
    if (crs)
        assert_string_equal(s.crs, crs);
    lamp_sink_end(&s);
}

static void test_csv(void **state) {
    expect_csv("lon,lat,lamp_type\n8.5,50.5,LED\n8.6,50.6,SON\n", NOC_OK, 2, "OGC:CRS84");
    expect_csv("\xef\xbb\xbfL\xc3\xa4ngengrad;Breitengrad;Leuchtmittel\r\n8,5;50,5;LED\r\n\r\n", NOC_OK, 1,
               "OGC:CRS84");
    /* --crs is the sink's matter */
    expect_csv("id\tX\tY\twattage\tcct\n1\t3500000\t5600000\t70\t3000\n", NOC_OK, 1, "");
    expect_csv("X,Y,wattage,cct\n8.5,50.5,70,3000\n", NOC_OK, 1, "OGC:CRS84"); /* degrees in all rows */
    expect_csv("geo_point_2d;lampe\n\"50.5, 8.5\";LED\n", NOC_OK, 1, "OGC:CRS84");
    expect_csv("wkt,lumens,a\n\"POINT Z (8.5 50.5 3)\",900,\"say \"\"hi\"\"\nthere\"\n", NOC_OK, 1, "OGC:CRS84");
    expect_csv("lon,lat,species\n8.5,50.5,oak\n", NOC_ERR_FORMAT, 0, NULL); /* trees */
    expect_csv("lon,lat,highway\n8.5,50.5,street_lamp\n8.5,50.5,bus_stop\n", NOC_OK, 1, "OGC:CRS84");
    expect_csv("lon,lat,lamp_type\n8.5,50.5\n8.5,50.5,LED,more\n,,LED\n1e3,0,LED\n8.5,50.5,LED\n9,51,LED", NOC_OK, 2,
               NULL);
    expect_csv("lon,lat,lamp_type\n8.5,50.5,\"LED\n", NOC_ERR_FORMAT, 0, NULL);
    expect_csv("lon,lat,lamp_type\n500000,5600000,LED\n500001,5600001,LED\n", NOC_ERR_FORMAT, 0, NULL);
    /* --crs is for the city beside it: degrees stay degrees, unless they are metres there */
    static const struct {
        const char *given, *row, *crs;
    } beside[] = {
        { "EPSG:25832", "8.5,50.5", "OGC:CRS84" },
        { "EPSG:25832", "500000,5600000", "" },
        { "EPSG:4326", "8.5,50.5", "" },
        { "+proj=tmerc +lat_0=50 +lon_0=8 +datum=WGS84 +type=crs", "8.5,50.5", "" },
    };
    for (size_t i = 0; i < NOC_COUNT(beside); i++) {
        lamp_sink s;
        char text[100];
        noc_import_params params = noc_import_default_params();
        params.crs = beside[i].given;
        snprintf(text, sizeof(text), "X,Y,wattage,cct\n%s,70,3000\n", beside[i].row);
        lamp_sink_start(&s);
        assert_int_equal(read_lamps_text(&s, text, &params), NOC_OK);
        assert_string_equal(s.crs, beside[i].crs);
        lamp_sink_end(&s);
    }
    lamp_sink s;
    lamp_sink_start(&s);
    assert_int_equal(read_lamps_text(&s, "lon,lat,lamp_type\n8.5,50.5\nx,y,LED\n500,0,LED\n8.5,50.5,LED\n9,51,LED",
                                     NULL),
                     NOC_OK);
    assert_int_equal(issue_count(&s, "too few or too many"), 1);
    assert_int_equal(issue_count(&s, "without a place"), 1);
    assert_int_equal(issue_count(&s, "out of range"), 1);
    lamp_sink_end(&s);
}

/* ---- GeoJSON and OSM ---- */

#define POINT(props, x, y)                                                                                             \
    "{\"type\":\"Feature\",\"properties\":{" props "},\"geometry\":{\"type\":\"Point\",\"coordinates\":[" x "," y "]}}"
#define COLLECTION(crs, features) "{\"type\":\"FeatureCollection\"," crs "\"features\":[" features "]}"
#define CRS(name) "\"crs\":{\"type\":\"name\",\"properties\":{\"name\":\"" name "\"}},"
#define LAMP "\"highway\":\"street_lamp\""

static void expect_map(const char *text, const char *crs_param, noc_status status, size_t lamps, const char *crs) {
    lamp_sink s;
    lamp_sink_start(&s);
    noc_import_params params = noc_import_default_params();
    params.crs = crs_param;
    assert_int_equal(read_lamps_text(&s, text, &params), status);
    assert_int_equal(s.lamps.len, lamps);
    assert_int_equal(s.errors, status != NOC_OK);
    if (crs)
        assert_string_equal(s.crs, crs);
    if (status)
        assert_non_null(strstr(s.error, "nocturne-lamps"));
    lamp_sink_end(&s);
}

static void test_geojson(void **state) {
    if (!NOC_HAVE_GDAL)
        skip();
    expect_map(COLLECTION("", POINT(LAMP, "8.5", "50.5")), NULL, NOC_OK, 1, "EPSG:4326");
    expect_map(COLLECTION(CRS("urn:ogc:def:crs:EPSG::25832"), POINT(LAMP, "500000", "5600000")), NULL, NOC_OK, 1,
               "EPSG:25832");
    expect_map(COLLECTION(CRS("EPSG:28992"), POINT(LAMP, "136000", "455000")), NULL, NOC_OK, 1, "EPSG:28992");
    /* projected, but not said: --crs must say it */
    expect_map(COLLECTION("", POINT(LAMP, "500000", "5600000")), NULL, NOC_ERR_FORMAT, 0, NULL);
    expect_map(COLLECTION("", POINT(LAMP, "500000", "5600000")), "EPSG:25832", NOC_OK, 1, "");
    expect_map(COLLECTION("", POINT(LAMP, "8.5", "50.5")), "EPSG:25832", NOC_OK, 1, "EPSG:4326");
    /* a CRS that the file does not name is its format's: a feature's property of that name is none */
    static const struct {
        const char *text;
        bool taken;
    } named[] = {
        { COLLECTION("", POINT(LAMP, "8.5", "50.5")), true },
        { COLLECTION("\"crs\":null,", POINT(LAMP, "8.5", "50.5")), true },
        { COLLECTION("", POINT(LAMP ",\"crs\":\"EPSG:4326\"", "8.5", "50.5")), true },
        { COLLECTION("\"crs\":{\"type\":\"name\",\"properties\":{\"name\":\"urn:ogc:def:crs:OGC:1.3:CRS84\"}},",
                     POINT(LAMP, "8.5", "50.5")),
          false },
        { "lon,lat,lamp_type\n8.5,50.5,LED\n", true },
    };
    for (size_t i = 0; i < NOC_COUNT(named); i++) {
        lamp_sink s;
        lamp_sink_start(&s);
        assert_int_equal(read_lamps_text(&s, named[i].text, NULL), NOC_OK);
        assert_int_equal(s.crs_taken, named[i].taken);
        lamp_sink_end(&s);
    }
    /* one stray is skipped; nothing to see is no error */
    expect_map(COLLECTION("", POINT(LAMP, "8.5", "50.5") "," POINT(LAMP, "8.6", "50.5") "," POINT(LAMP, "999", "50")),
               NULL, NOC_OK, 2, NULL);
    /* nor does one with text or nothing for coordinates cost the others */
    static const char *const odd[] = { "\"8.6\"", "\"here\"", "true", "null", "[]", "{}" };
    for (size_t i = 0; i < NOC_COUNT(odd); i++) {
        char text[1000];
        snprintf(text, sizeof(text),
                 COLLECTION("", POINT(LAMP, "8.5", "50.5") "," POINT(LAMP, "%s", "50.6") "," POINT(LAMP, "8.7", "%s")),
                 odd[i], odd[i]);
        expect_map(text, NULL, NOC_OK, 1, NULL);
    }
    expect_map(COLLECTION("", POINT("\"amenity\":\"bench\"", "8.5", "50.5")), NULL, NOC_OK, 0, NULL);
    expect_map(COLLECTION("", ""), NULL, NOC_OK, 0, NULL);
    /* an inventory: all its points; a tagged file: only the tagged ones */
    expect_map(COLLECTION("", POINT("\"LampType\":\"Acorn\"", "8", "50") "," POINT("\"LampType\":null", "8", "51")),
               NULL, NOC_OK, 2, NULL);
    expect_map(COLLECTION("",
                          POINT(LAMP ",\"lamp_type\":\"led\"", "8", "50") "," POINT("\"highway\":\"stop\"", "8", "51")),
               NULL, NOC_OK, 1, NULL);
}

static const char osm[] =
    "<?xml version='1.0' encoding='UTF-8'?>\n<osm version=\"0.6\" generator=\"test\">\n"
    "<node id=\"1\" lat=\"50.5\" lon=\"8.5\" version=\"1\"><tag k=\"highway\" v=\"street_lamp\"/>"
    "<tag k=\"light:count\" v=\"2\"/><tag k=\"note\" v=\"a &quot;quoted&quot; \\ word=&gt;\"/>"
    "<tag k=\"light:colour\" v=\"4000 K\"/></node>\n"
    "<node id=\"2\" lat=\"50.6\" lon=\"8.6\" version=\"1\"><tag k=\"disused:highway\" v=\"street_lamp\"/></node>\n"
    "<node id=\"3\" lat=\"50.6\" lon=\"8.6\" version=\"1\"/>\n"
    "<way id=\"4\" version=\"1\"><nd ref=\"1\"/><nd ref=\"3\"/><tag k=\"highway\" v=\"street_lamp\"/></way>\n</osm>\n";

static void test_osm(void **state) {
    if (!NOC_HAVE_GDAL)
        skip();
    lamp_sink s;
    lamp_sink_start(&s);
    assert_int_equal(read_lamps_text(&s, osm, NULL), NOC_OK);
    assert_int_equal(s.lamps.len, 1);
    const geo_lamp *l = lamp_by_id(&s, "node/1");
    assert_int_equal(l->count, 2);
    assert_float_equal(l->kelvin, 4000, 0);
    assert_float_equal(l->xyz[0], 8.5, 1e-9);
    assert_int_equal(issue_count(&s, "not in use"), 1);
    lamp_sink_end(&s);
}

#if NOC_HAVE_GDAL
/* Five lamps in a file of one of GDAL's other formats. */
static void write_map(const char *driver, const char *path, int epsg, double x, double y) {
    OGRRegisterAll();
    GDALDatasetH dataset = GDALCreate(GDALGetDriverByName(driver), path, 0, 0, 0, GDT_Unknown, NULL);
    assert_non_null(dataset);
    OGRSpatialReferenceH srs = OSRNewSpatialReference(NULL);
    assert_int_equal(OSRImportFromEPSG(srs, epsg), OGRERR_NONE);
    OGRLayerH layer = GDALDatasetCreateLayer(dataset, "lamps", srs, wkbPoint, NULL);
    OGRFieldDefnH type = OGR_Fld_Create("LampType", OFTString), watts = OGR_Fld_Create("wattage", OFTReal);
    assert_int_equal(OGR_L_CreateField(layer, type, 1), OGRERR_NONE);
    assert_int_equal(OGR_L_CreateField(layer, watts, 1), OGRERR_NONE);
    for (int i = 0; i < 5; i++) {
        OGRFeatureH feature = OGR_F_Create(OGR_L_GetLayerDefn(layer));
        OGR_F_SetFieldString(feature, 0, "LED");
        OGR_F_SetFieldDouble(feature, 1, 40 + i);
        OGRGeometryH point = OGR_G_CreateGeometry(wkbPoint);
        OGR_G_SetPoint_2D(point, 0, x + i, y);
        assert_int_equal(OGR_F_SetGeometryDirectly(feature, point), OGRERR_NONE);
        assert_int_equal(OGR_L_CreateFeature(layer, feature), OGRERR_NONE);
        OGR_F_Destroy(feature);
    }
    OGR_Fld_Destroy(type);
    OGR_Fld_Destroy(watts);
    OSRDestroySpatialReference(srs);
    GDALClose(dataset);
}
#endif

/* GeoPackage, Shapefile (EPSG:31256 is northing first by the book, and written easting first) and FlatGeobuf. */
static void test_other_maps(void **state) {
#if NOC_HAVE_GDAL
    static const struct {
        const char *driver, *ending, *format, *crs;
        int epsg;
        double x, y;
    } maps[] = { { "GPKG", ".gpkg", "GeoPackage", "EPSG:25832", 25832, 500000, 5600000 },
                 { "ESRI Shapefile", ".shp", "Shapefile", "EPSG:31256", 31256, 2000, 340000 },
                 { "FlatGeobuf", ".fgb", "FlatGeobuf", "EPSG:5514", 5514, -743000, -1043000 } };
    for (size_t i = 0; i < NOC_COUNT(maps); i++) {
        char path[300];
        snprintf(path, sizeof(path), "%s%s", temp_file("", 0), maps[i].ending);
        write_map(maps[i].driver, path, maps[i].epsg, maps[i].x, maps[i].y);
        lamp_sink s;
        lamp_sink_start(&s);
        assert_int_equal(read_lamps(&s, path, NULL), NOC_OK);
        assert_string_equal(s.format, maps[i].format);
        assert_string_equal(s.crs, maps[i].crs);
        assert_int_equal(s.lamps.len, 5);
        bool seen[5] = { false };
        for (int k = 0; k < 5; k++) {
            const geo_lamp *l = &s.lamps.data[k];
            int n = (int)lround(l->watts) - 40;
            assert_true(n >= 0 && n < 5 && !seen[n]);
            seen[n] = true;
            assert_float_equal(l->xyz[0], maps[i].x + n, 1e-6);
            assert_float_equal(l->xyz[1], maps[i].y, 1e-6);
        }
        lamp_sink_end(&s);
        GDALDeleteDataset(GDALGetDriverByName(maps[i].driver), path);
    }
#else
    skip();
#endif
}

/* A table that tells of fewer rows than there are shapes: GDAL reads those that both have, and no more is said by it.
 */
static void test_a_shapefile_of_parts_that_disagree(void **state) {
#if NOC_HAVE_GDAL
    for (int rows = 4; rows <= 6; rows++) {
        char path[300];
        snprintf(path, sizeof(path), "%s.shp", temp_file("", 0));
        write_map("ESRI Shapefile", path, 25832, 500000, 5600000);
        memcpy(path + strlen(path) - 3, "dbf", 3);
        FILE *f = fopen(path, "r+b");
        assert_non_null(f);
        assert_int_equal(fseek(f, 4, SEEK_SET), 0);
        assert_int_equal(fputc(rows, f), rows);
        fclose(f);
        memcpy(path + strlen(path) - 3, "shp", 3);
        lamp_sink s;
        lamp_sink_start(&s);
        assert_int_equal(read_lamps(&s, path, NULL), NOC_OK);
        assert_int_equal(s.lamps.len, rows < 5 ? rows : 5);
        assert_int_equal(issue_count(&s, "not in both"), rows != 5);
        lamp_sink_end(&s);
        GDALDeleteDataset(GDALGetDriverByName("ESRI Shapefile"), path);
    }
#else
    skip();
#endif
}

/* ---- answers of servers ---- */

#if NOC_HAVE_GDAL

/* %s: of the collection, and the place */
#define WFS                                                                                                            \
    "<?xml version=\"1.0\"?><wfs:FeatureCollection xmlns:wfs=\"http://www.opengis.net/wfs/2.0\" "                      \
    "xmlns:gml=\"http://www.opengis.net/gml/3.2\" xmlns:g=\"http://example.invalid/g\" %s><wfs:member>"                \
    "<g:Street_light gml:id=\"s.1\"><g:lamp_type>LED</g:lamp_type><g:lamp_wattage>60</g:lamp_wattage><g:height>8"      \
    "</g:height><g:geom><gml:Point %s</gml:Point></g:geom></g:Street_light></wfs:member></wfs:FeatureCollection>"
#define ARCGIS                                                                                                         \
    "{\"geometryType\": \"esriGeometryPoint\", \"spatialReference\": {%s}, \"fields\": [{\"name\": \"lamp_type\", "    \
    "\"type\": \"esriFieldTypeString\"}, {\"name\": \"lamp_wattage\", \"type\": \"esriFieldTypeDouble\"}], "           \
    "\"features\": [{\"attributes\": {\"lamp_type\": \"LED\", \"lamp_wattage\": 60}, \"geometry\": %s}]%s}"

/* One lamp of 60 W is read there, and the last warning says so; where format is NULL, the error does. */
static void expect_answer(const char *text, const char *format, const char *crs, double x, double y, const char *said) {
    lamp_sink s;
    lamp_sink_start(&s);
    noc_status status = read_lamps(&s, temp_file(text, strlen(text)), NULL);
    if (status != (format ? NOC_OK : NOC_ERR_FORMAT) || !strstr(format ? s.warning : s.error, said))
        fail_msg("%s %s for %s", s.error, s.warning, said);
    if (format) {
        assert_string_equal(s.format, format);
        assert_string_equal(s.crs, crs);
        assert_false(s.crs_taken);
        assert_int_equal(s.lamps.len, 1);
        assert_float_equal(s.lamps.data[0].watts, 60, 0);
        assert_float_equal(s.lamps.data[0].xyz[0], x, 1e-6);
        assert_float_equal(s.lamps.data[0].xyz[1], y, 1e-6);
        assert_int_equal(s.warnings, *said != 0);
    }
    lamp_sink_end(&s);
}

/* URLs and URNs of a CRS have its own order of axes, which for these is the northing or latitude first. */
static void test_wfs(void **state) {
    char text[2000];
#define URL "srsName=\"http://www.opengis.net/def/crs/EPSG/0/3879\"><gml:pos>6673000 25496000</gml:pos>"
    snprintf(text, sizeof(text), WFS, "", URL);
    expect_answer(text, "GML", "EPSG:3879", 25496000, 6673000, "");
    snprintf(text, sizeof(text), WFS, "", "srsName=\"urn:ogc:def:crs:EPSG::4326\"><gml:pos>60.2 24.9</gml:pos>");
    expect_answer(text, "GML", "EPSG:4326", 24.9, 60.2, "");
    snprintf(text, sizeof(text), WFS, "", "srsName=\"EPSG:25832\"><gml:pos>690000 5330000</gml:pos>");
    expect_answer(text, "GML", "EPSG:25832", 690000, 5330000, "");
    snprintf(text, sizeof(text), WFS, "numberMatched=\"5000\" numberReturned=\"1\"", URL);
    expect_answer(text, "GML", "EPSG:3879", 25496000, 6673000, "the server had 5000 features and gave 1");
    snprintf(text, sizeof(text), WFS, "xsi:schemaLocation=\"http://example.invalid/g /dev/zero\"", URL);
    expect_answer(text, "GML", "EPSG:3879", 25496000, 6673000, "");
    snprintf(text, sizeof(text), WFS, "", "srsName=\"/dev/zero\"><gml:pos>1 2</gml:pos>");
    expect_answer(text, NULL, NULL, 0, 0, "\"/dev/zero\" is no name of a CRS");
    snprintf(text, sizeof(text), "<!DOCTYPE a [<!ENTITY b \"c\">]>" WFS, "", URL);
    expect_answer(text, NULL, NULL, 0, 0, "document type");
}

static void test_arcgis(void **state) {
    char text[1000];
    snprintf(text, sizeof(text), ARCGIS, "\"wkid\": 2263", "{\"x\": 1000000, \"y\": 200000}", "");
    expect_answer(text, "ArcGIS JSON", "EPSG:2263", 1000000, 200000, "");
    snprintf(text, sizeof(text), ARCGIS, "\"wkid\": 102100, \"latestWkid\": 3857", "{\"x\": 1000, \"y\": 2000}",
             ", \"exceededTransferLimit\": false");
    expect_answer(text, "ArcGIS JSON", "EPSG:3857", 1000, 2000, "");
    snprintf(text, sizeof(text), ARCGIS, "\"wkid\": 4326", "{\"x\": -75, \"y\": 40}",
             ", \"exceededTransferLimit\": true");
    expect_answer(text, "ArcGIS JSON", "EPSG:4326", -75, 40, "a part of its features (exceededTransferLimit)");
    snprintf(text, sizeof(text), ARCGIS, "\"wkt\": \"+proj=merc +nadgrids=/dev/zero\"", "{\"x\": -75, \"y\": 40}", "");
    expect_answer(text, NULL, NULL, 0, 0, "may open files");

    /* what a probe sees may be fields alone, or look like GeoJSON */
    char *fields = malloc(40000), *end = fields;
    end += sprintf(end, "{\"fields\": [{\"name\": \"coordinates\", \"type\": \"esriFieldTypeString\", \"domain\": "
                        "{\"name\": \"Feature\", \"codedValues\": [");
    for (int i = 0; i < 1000; i++)
        end += sprintf(end, "%s{\"code\": %d, \"name\": \"v\"}", i ? "," : "", i);
    sprintf(end, "]}}, {\"name\": \"lamp_type\", \"type\": \"esriFieldTypeString\"}, {\"name\": \"lamp_wattage\", "
                 "\"type\": \"esriFieldTypeDouble\"}], \"geometryType\": \"esriGeometryPoint\", "
                 "\"spatialReference\": {\"wkid\": 2263}, \"features\": ["
                 "{\"attributes\": {\"coordinates\": \"Feature\", \"lamp_type\": \"LED\", \"lamp_wattage\": 60}, "
                 "\"geometry\": {\"x\": 1000000, \"y\": 200000}}]}");
    expect_answer(fields, "ArcGIS JSON", "EPSG:2263", 1000000, 200000, "");
    free(fields);
}

#endif

/* ---- broken files ---- */

static char *slurp(const char *path, size_t *size) {
    FILE *f = fopen(path, "rb");
    assert_non_null(f);
    char *data = malloc(1 << 21);
    *size = fread(data, 1, 1 << 21, f);
    fclose(f);
    return data;
}

/* Every outcome is a status with as many errors as it deserves. */
static noc_status read_bytes(const char *data, size_t size, size_t *lamps) {
    lamp_sink s;
    lamp_sink_start(&s);
    noc_status status = read_lamps(&s, temp_file(data, size), NULL);
    assert_int_equal(s.errors, status != NOC_OK);
    *lamps = s.lamps.len;
    lamp_sink_end(&s);
    return status;
}

/* A file cut anywhere is an error: XML, JSON and gzip have an end that is missed, PBF has whole blocks. */
static void test_cut(void **state) {
    if (!NOC_HAVE_GDAL)
        skip();
    static const char *const paths[] = { "data/lights/kamiyama/street_lamps.geojson",
                                         "data/lights/paris/paris_bss.osm.pbf",
                                         "data/lights/worcester_ma/street_lamps.geojson.gz",
                                         "data/lights/washington_dc/streetlights.csv.gz",
                                         "data/lights/berlin_tiergarten/berlin-siegessaeule.osm.gz" };
    for (size_t i = 0; i < NOC_COUNT(paths); i++) {
        REQUIRE_SHARED(path, paths[i]);
        size_t size, lamps;
        char *data = slurp(path, &size);
        for (int k = 1; k < 12; k++) {
            noc_status status = read_bytes(data, size * (size_t)k / 12, &lamps);
            if (status != NOC_ERR_FORMAT)
                fail_msg("%s cut at %d/12: status %d, %zu lamps", paths[i], k, status, lamps);
        }
        free(data);
    }
    for (size_t n = 100; n + 8 < strlen(osm); n += 17) {
        size_t lamps;
        assert_int_equal(read_bytes(osm, n, &lamps), NOC_ERR_FORMAT);
    }
}

static void test_mutated(void **state) {
    static const char *const texts[] = {
        "lon,lat,lamp_type,height\n8.5,50.5,LED,\"6 m\"\n8.6,50.6,SON,16'6\"\n",
        COLLECTION("", POINT(LAMP ",\"height\":\"5 m\"", "8.5", "50.5") "," POINT(LAMP, "8", "50")), osm
    };
    uint32_t seed = 7;
    for (int i = 0; i < 600; i++) {
        const char *text = texts[i % 3];
        size_t size = strlen(text), lamps;
        char *copy = malloc(size);
        memcpy(copy, text, size);
        for (int k = 0; k <= i % 5; k++) {
            seed = seed * 1664525u + 1013904223u;
            copy[(seed >> 8) % size] = (char)(seed >> 4);
        }
        read_bytes(copy, size, &lamps);
        assert_true(lamps <= 2);
        free(copy);
    }
}

static int tear_down(void **state) { return unlink(temp_file("", 0)); }

/* ---- what is not read is told ---- */

static void test_unread(void **state) {
    (void)state;
    if (!NOC_HAVE_GDAL)
        skip();
    static const char outlines[] =
        "{\"type\": \"FeatureCollection\", \"features\": [\n"
        "{\"type\": \"Feature\", \"properties\": {\"a\": 1}, \"geometry\": {\"type\": \"Polygon\", \"coordinates\": "
        "[[[8, 50], [8.5, 50], [8.5, 50.25], [8, 50]]]}},\n"
        "{\"type\": \"Feature\", \"properties\": {\"a\": 2}, \"geometry\": {\"type\": \"LineString\", "
        "\"coordinates\": [[8, 50], [9, 51]]}}]}";
    lamp_sink s;
    lamp_sink_start(&s);
    assert_int_equal(read_lamps_text(&s, outlines, NULL), NOC_OK);
    assert_int_equal(issue_count(&s, "polygon that is not read"), 1);
    assert_int_equal(issue_count(&s, "line that is not read"), 1);
    assert_int_equal(s.warnings, 1);
    assert_non_null(
        strstr(s.warning,
               "1 line, 1 polygon are not read: of maps only lamps are read, and with --footprints buildings"));
    lamp_sink_end(&s);
    static const char ways[] =
        "<?xml version='1.0'?><osm version='0.6'><node id='1' lat='50' lon='8'>"
        "<tag k='highway' v='street_lamp'/></node><node id='2' lat='50' lon='8.1'/>"
        "<way id='1'><nd ref='1'/><nd ref='2'/><tag k='building' v='yes'/></way>"
        "<way id='2'><nd ref='1'/><nd ref='2'/><tag k='highway' v='footway'/></way>"
        "<way id='3'><nd ref='1'/><nd ref='2'/><tag k='building' v='no'/></way>"
        "<way id='4'><nd ref='1'/><nd ref='2'/><tag k='highway' v='service'/><tag k='building' v='roof'/></way>"
        "<relation id='5'><member type='way' ref='1' role='outer'/><tag k='building' v='church'/></relation></osm>";
    lamp_sink_start(&s);
    assert_int_equal(read_lamps_text(&s, ways, NULL), NOC_OK);
    assert_int_equal(s.lamps.len, 1);
    assert_int_equal(issue_count(&s, "building that is not read"), 3);
    assert_int_equal(issue_count(&s, "street or path that is not read"), 1);
    assert_non_null(strstr(s.warning, "3 buildings, 1 street or path are not read"));
    lamp_sink_end(&s);
}

/* PBF packs its tags, so they are found by another way than those of XML. */
static void test_unread_pbf(void **state) {
    if (!NOC_HAVE_GDAL)
        skip();
    REQUIRE_SHARED(path, "data/lights/helsinki/Helsinki.osm.pbf");
    lamp_sink s;
    lamp_sink_start(&s);
    assert_int_equal(read_lamps(&s, path, NULL), NOC_OK);
    assert_int_equal(issue_count(&s, "building that is not read"), 632);
    assert_int_equal(issue_count(&s, "street or path that is not read"), 2680);
    assert_non_null(strstr(s.warning, "632 buildings, 2,680 streets and paths are not read"));
    lamp_sink_end(&s);
}

#define LAMP_OF(geometry)                                                                                              \
    "{\"type\":\"Feature\",\"properties\":{\"highway\":\"street_lamp\",\"type\":\"Kind\"},\"geometry\":" geometry "}"
#define OF_TYPE(type) LAMP_OF("{\"type\":\"" type "\",\"coordinates\":[8,50]}")

/* GDAL passes over geometries of a type that is none: they are named. */
static void test_strange_geometries(void **state) {
    if (!NOC_HAVE_GDAL)
        skip();
    (void)state;
    lamp_sink s;
    lamp_sink_start(&s);
    assert_int_equal(
        read_lamps_text(&s,
                        "{\"type\":\"FeatureCollection\",\"features\":[" OF_TYPE("Point") "," OF_TYPE(
                            "Pointt") "," LAMP_OF("null") "," LAMP_OF("{\"coordinates\":[8,50],\"type\":"
                                                                      "\"Kurve\"}") "," OF_TYPE("Pointt") "]}",
                        NULL),
        NOC_OK);
    assert_int_equal(s.lamps.len, 1);
    assert_int_equal(issue_count(&s, "geometry of a type that GeoJSON has not"), 3);
    bool named = false;
    for (size_t i = 0; i < geo_issues_count(s.sink.issues); i++) {
        const char *reason, *examples;
        bool repaired;
        size_t n;
        assert_true(geo_issues_get(s.sink.issues, i, &reason, &repaired, &n, &examples));
        named = named || !strcmp(examples, "Pointt, Kurve");
    }
    assert_true(named);
    lamp_sink_end(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_strange_geometries),
        cmocka_unit_test(test_real_counts),
        cmocka_unit_test(test_washington),
        cmocka_unit_test(test_heights),
        cmocka_unit_test(test_csv),
        cmocka_unit_test(test_geojson),
        cmocka_unit_test(test_osm),
        cmocka_unit_test(test_other_maps),
        cmocka_unit_test(test_a_shapefile_of_parts_that_disagree),
        cmocka_unit_test(test_cut),
        cmocka_unit_test(test_mutated),
        cmocka_unit_test(test_unread),
        cmocka_unit_test(test_unread_pbf),
#if NOC_HAVE_GDAL
        cmocka_unit_test(test_wfs),
        cmocka_unit_test(test_arcgis),
#endif
    };
    return cmocka_run_group_tests_name("import/vector", tests, NULL, tear_down);
}
