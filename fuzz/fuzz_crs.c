/* Spellings of coordinate systems: understood, or refused with one error. What is understood can be
 * asked and transforms points, which takes PROJ longer than to understand it: in one run in 8. */
#include "fuzz.h"

#include <math.h>

static void use(geo_crs *crs, noc_log *log, int *errors) {
    double lonlat[2], xyz[6] = { 691000, 5336000, 500, 11.5, 48.1, 500 };
    FUZZ_REQUIRE(*geo_crs_name(crs));
    for (int i = 0; i < 6; i += 3)
        if (geo_crs_lonlat(crs, xyz[i], xyz[i + 1], lonlat))
            FUZZ_REQUIRE(fabs(lonlat[0]) <= 360 && fabs(lonlat[1]) <= 90.0001);
    FUZZ_REQUIRE(geo_crs_outside(crs, xyz[0], xyz[1]) >= 0 && geo_crs_equal(crs, crs));
    geo_crs *utm = geo_crs_utm(11.5, 48.1), *copy = geo_crs_clone(crs);
    FUZZ_REQUIRE(utm && copy && geo_crs_is_metric(utm) && geo_crs_lat_first(copy) == geo_crs_lat_first(crs));
    *errors = 0;
    geo_transform *t = geo_transform_create(crs, utm, log, NULL);
    FUZZ_REQUIRE(*errors == !t);
    if (t) {
        size_t failed = geo_transform_points(t, xyz, 2);
        FUZZ_REQUIRE(failed <= 2 && (failed || isfinite(xyz[0] + xyz[1] + xyz[3] + xyz[4])));
    }
    geo_transform_destroy(t);
    geo_crs_destroy(copy);
    geo_crs_destroy(utm);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    int errors = 0;
    noc_log *log = fuzz_log(&errors);
    char *text = noc_format("%.*s", (int)size, (const char *)data);
    fuzz_memory(data, size);
    geo_crs *crs = (size & 1 ? geo_crs_create_plain : geo_crs_create)(text, "fuzz", log, NULL); /* a file's; a user's */
    fuzz_memory_back();
    FUZZ_REQUIRE(errors == !crs);
    if (crs && fuzz_seldom(data, size, 8))
        use(crs, log, &errors);
    geo_crs_destroy(crs);
    free(text);
    noc_log_destroy(log);
    return 0;
}
