/* Maps have 4,096 columns, as tables have: GDAL compares each with all others. */
#include "../told.h"

#include "base/base.h"
#include "noc_config.h"

#include <stdarg.h>

static char folder[] = "/tmp/noc-map-columns-XXXXXX";
#include "../folder.h"

#if NOC_HAVE_GDAL

static char text[2000000];
static size_t length;

__attribute__((format(printf, 1, 2))) static void put(const char *format, ...) {
    va_list list;
    va_start(list, format);
    length += (size_t)vsnprintf(text + length, sizeof(text) - length, format, list);
    va_end(list);
    assert_true(length < sizeof(text));
}

/* Writes columns c0 to c(count - 1), the first half in each feature, the other in the second alone. */
static void geojson(int count) {
    put("{\"type\":\"FeatureCollection\",\"features\":[");
    for (int i = 0; i < 2; i++) {
        put("%s{\"type\":\"Feature\",\"geometry\":{\"type\":\"Point\",\"coordinates\":[9.5,51.%d]},\"properties\":{",
            i ? "," : "", i + 3);
        for (int c = 0; c < (i ? count : count / 2) - 1; c++)
            put("\"a_rather_long_name_c%d\":%d,", c, c);
        put("\"highway\":\"street_lamp\"}}");
    }
    put("]}");
}

static void nested(int count) { /* which is one column */
    put("{\"type\":\"FeatureCollection\",\"features\":[{\"type\":\"Feature\",\"geometry\":{\"type\":\"Point\","
        "\"coordinates\":[9.5,51.3]},\"properties\":{\"highway\":\"street_lamp\",\"more\":{");
    for (int c = 0; c < count; c++)
        put("%s\"c%d\":%d", c ? "," : "", c, c);
    put("}}}]}");
}

static void arcgis(int count) {
    put("{\"geometryType\":\"esriGeometryPoint\",\"spatialReference\":{\"wkid\":4326},\"fields\":[");
    for (int c = 0; c < count - 1; c++)
        put("{\"name\":\"c%d\",\"type\":\"esriFieldTypeInteger\"},", c);
    put("{\"name\":\"lamp_type\",\"type\":\"esriFieldTypeString\"}],\"features\":[{\"attributes\":"
        "{\"lamp_type\":\"LED\"},\"geometry\":{\"x\":9.5,\"y\":51.3}}]}");
}

static void gml(int count) {
    put("<wfs:FeatureCollection xmlns:wfs='http://www.opengis.net/wfs/2.0' xmlns:gml='http://www.opengis.net/gml/3.2' "
        "xmlns:a='urn:a'>");
    for (int i = 0; i < 2; i++) {
        put("<wfs:member><a:lamp gml:id='l%d'>", i);
        for (int c = i * count / 2; c < (i ? count : count / 2) - 2 * i; c++) /* the geometry's and lamp_type */
            put("<a:c%d>%d</a:c%d>", c, c, c);
        put("<a:lamp_type>LED</a:lamp_type><a:geom><gml:Point srsName='urn:ogc:def:crs:EPSG::25832'><gml:pos>690000 "
            "533000%d</gml:pos></gml:Point></a:geom></a:lamp></wfs:member>",
            i);
    }
    put("</wfs:FeatureCollection>");
}

static void test_columns(void **state) {
    static const struct {
        void (*write)(int);
        int columns;
        const char *told; /* NULL: read */
    } rows[] = {
        { geojson, 4096, NULL },
        { geojson, 4097, "GeoJSON: more than 4096 columns" },
        { nested, 20000, NULL },
        { arcgis, 4096, NULL },
        { arcgis, 4097, "ArcGIS JSON: more than 4096 columns" },
        { gml, 4096, NULL },
        { gml, 4097, "GML: more than 4096 columns" },
    };
    (void)state;
    noc_log *log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_WARN, .message = keep });
    for (size_t i = 0; i < NOC_COUNT(rows); i++) {
        noc_report *report = NULL;
        const noc_import_params params = noc_import_default_params();
        *told = 0;
        length = 0;
        rows[i].write(rows[i].columns);
        noc_status status = noc_inspect(log, write_file("map", text), &params, &report);
        if (rows[i].told ? status != NOC_ERR_FORMAT || !strstr(told, rows[i].told)
                         : status || !noc_report_get_file(report, 0)->lamps)
            fail_msg("row %zu, %d columns: %d: %s", i, rows[i].columns, status, told);
        noc_report_destroy(report);
    }
    noc_log_destroy(log);
}

#else
static void test_columns(void **state) { skip(); }
#endif

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(test_columns) };
    assert_non_null(mkdtemp(folder));
    int failed = cmocka_run_group_tests_name("import map columns", tests, NULL, NULL);
    return remove_folder() || failed;
}
