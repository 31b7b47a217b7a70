/* Spellings of CRSs, and conversions against published points and against formulas written here a second time. */
#include "geo/geo.h"
#include "../test.h"

#include <math.h>

#define assert_close(a, b, tolerance)                                                                                  \
    do {                                                                                                               \
        double a_ = (a), b_ = (b);                                                                                     \
        if (!(fabs(a_ - b_) <= (tolerance)))                                                                           \
            fail_msg("%s is %.12g, not %.12g", #a, a_, b_);                                                            \
    } while (0)

#define METRE 9e-6 /* degrees of latitude */

static void silent(void *user, noc_log_level level, const char *text) { (void)user, (void)level, (void)text; }

static noc_log *quiet_log(void) {
    return noc_log_create(&(noc_log_params){ .level = NOC_LOG_WARN, .message = silent });
}

static void test_spellings(void **state) {
    (void)state;
    static const struct {
        const char *spelling, *name;
        bool geographic, lat_first;
    } cases[] = {
        { "urn:adv:crs:ETRS89_UTM32*DE_DHHN2016_NH*GCG2016", "EPSG:25832 (ETRS89 / UTM zone 32N)", false, false },
        { "urn:adv:crs:ETRS89_UTM33*DE_DHHN2016_NH", "EPSG:25833 (ETRS89 / UTM zone 33N)", false, false },
        { "urn:adv:crs:DE_DHDN_3GK2_NW101", "EPSG:31466 (DHDN / 3-degree Gauss-Kruger zone 2)", false, true },
        { "urn:adv:crs:DE_DHDN_3GK4*DE_DHHN92_NH", "EPSG:31468 (DHDN / 3-degree Gauss-Kruger zone 4)", false, true },
        { "urn:adv:crs:ETRS89_Lat-Lon", "EPSG:4258 (ETRS89)", true, true },
        { "urn:ogc:def:crs,crs:EPSG:6.12:25833,crs:EPSG:6.12:5783", "EPSG:25833 (ETRS89 / UTM zone 33N)", false,
          false },
        { "urn:ogc:def:crs,crs:EPSG:6.12:3068,crs:EPSG:6.12:5783", "EPSG:3068 (DHDN / Soldner Berlin)", false, true },
        { "urn:ogc:def:crs:EPSG::7415", "EPSG:28992 (Amersfoort / RD New)", false, false },
        { "urn:ogc:def:crs:EPSG:6.9:4326", "EPSG:4326 (WGS 84)", true, true },
        { "urn:x-ogc:def:crs:EPSG:4326", "EPSG:4326 (WGS 84)", true, true },
        { "urn:ogc:def:crs:OGC:1.3:CRS84", "OGC:CRS84 (WGS 84 (CRS84))", true, false },
        { "http://www.opengis.net/def/crs/OGC/1.3/CRS84", "OGC:CRS84 (WGS 84 (CRS84))", true, false },
        { "https://www.opengis.net/def/crs/OGC/0/CRS84h", "OGC:CRS84h (WGS 84 longitude-latitude-height)", true,
          false },
        { "ogc:crs84H", "OGC:CRS84h (WGS 84 longitude-latitude-height)", true, false },
        { "http://www.opengis.net/def/crs/EPSG/0/6697", "EPSG:6668 (JGD2011)", true, true },
        { "https://www.opengis.net/def/crs/EPSG/0/2056", "EPSG:2056 (CH1903+ / LV95)", false, false },
        { "http://www.opengis.net/gml/srs/epsg.xml#4326", "EPSG:4326 (WGS 84)", true, true },
        { "http://www.opengis.net/def/crs-compound?1=http://www.opengis.net/def/crs/EPSG/0/28992&"
          "2=http://www.opengis.net/def/crs/EPSG/0/5709",
          "EPSG:28992 (Amersfoort / RD New)", false, false },
        { "EPSG:25833", "EPSG:25833 (ETRS89 / UTM zone 33N)", false, false },
        { "epsg:31256", "EPSG:31256 (MGI / Austria GK East)", false, true },
        { "EPSG:25832+7837", "EPSG:25832 (ETRS89 / UTM zone 32N)", false, false },
        { "EPSG:25832 (ETRS89 / UTM zone 32N)", "EPSG:25832 (ETRS89 / UTM zone 32N)", false, false },
        { "EPSG:900913", "EPSG:3857 (WGS 84 / Pseudo-Mercator)", false, false },
        { " 25832\n", "EPSG:25832 (ETRS89 / UTM zone 32N)", false, false },
        { "CH1903", "EPSG:21781 (CH1903 / LV03)", false, false },
        { "CH1903+", "EPSG:2056 (CH1903+ / LV95)", false, false },
        { "CH1903+ / LV95", "EPSG:2056 (CH1903+ / LV95)", false, false },
        { "LV95", "EPSG:2056 (CH1903+ / LV95)", false, false },
        { "RGF93 v1 / Lambert-93", "EPSG:2154 (RGF93 v1 / Lambert-93)", false, false },
        { "+proj=utm +zone=32 +datum=WGS84", "unknown", false, false },
        { "GEOGCS[\"plain\",DATUM[\"D\",SPHEROID[\"S\",6378137,298.25]],PRIMEM[\"Greenwich\",0],"
          "UNIT[\"degree\",0.0174532925199433]]",
          "plain", true, false },
    };
    noc_log *log = noc_log_create(NULL);
    for (size_t i = 0; i < NOC_COUNT(cases); i++) {
        geo_crs *crs = geo_crs_create(cases[i].spelling, "test", log, NULL);
        if (!crs)
            fail_msg("%s", cases[i].spelling);
        assert_string_equal(geo_crs_name(crs), cases[i].name);
        assert_int_equal(geo_crs_is_geographic(crs), cases[i].geographic);
        assert_int_equal(geo_crs_is_metric(crs), !cases[i].geographic);
        if (geo_crs_lat_first(crs) != cases[i].lat_first)
            fail_msg("axis order of %s", cases[i].spelling);
        geo_crs *copy = geo_crs_clone(crs);
        assert_true(geo_crs_equal(crs, copy));
        geo_crs_destroy(copy);
        geo_crs_destroy(crs);
    }
    noc_log_destroy(log);
}

static void test_not_understood(void **state) {
    (void)state;
    noc_log *log = quiet_log();
    char *longest = noc_alloc(100001);
    memset(longest, 'E', 100000);
    longest[100000] = 0;
    const char *cases[] = { "",
                            " ",
                            "foo",
                            "Local",
                            "local cartesian",
                            "EPSG:",
                            "EPSG:999999",
                            "EPSG:abc",
                            "urn:ogc:def:crs:",
                            "urn:ogc:def:crs,crs:",
                            "http://www.opengis.net/def/crs/",
                            "EPSG:4978" /* geocentric */,
                            "EPSG:5783" /* heights */,
                            "+proj=",
                            "+proj=nonsense",
                            "PROJCS[",
                            "{}",
                            "[[[[[[",
                            "%s%n%s",
                            "\xff\xfe",
                            longest };
    for (size_t i = 0; i < NOC_COUNT(cases); i++) {
        geo_crs *crs = geo_crs_create(cases[i], "city.gml:12", log, NULL);
        if (crs)
            fail_msg("%.100s gives %s", cases[i], geo_crs_name(crs));
        assert_memory_equal(noc_log_last_error(log), "city.gml:12: ", 13);
    }
    uint32_t random_state = 7;
    static const char alphabet[] = "EPSGepsg:0123456789/+#*?&,urn:ogc:def:crs [](\"ETRS89_UTM32";
    for (int round = 0; round < 300; round++) { /* anything may come of it but a crash */
        char text[64];
        size_t n = (random_state >> 8) % 63;
        for (size_t i = 0; i < n; i++) {
            random_state = random_state * 1664525u + 1013904223u;
            text[i] = alphabet[(random_state >> 8) % (sizeof(alphabet) - 1)];
        }
        text[n] = 0;
        geo_crs_destroy(geo_crs_create(text, NULL, NULL, NULL));
    }
    free(longest);
    noc_log_destroy(log);
}

/* ---- formulas, a second time ---- */

struct ellipsoid {
    double a, inverse_f;
};
static const struct ellipsoid bessel = { 6377397.155, 299.1528128 }, grs80 = { 6378137, 298.257222101 },
                              wgs84 = { 6378137, 298.257223563 };

/* Transverse Mercator by Krueger's series in n to the fourth order (Karney, J. Geodesy 85, 2011), below a millimetre.
 */
static void transverse_mercator(struct ellipsoid e, double lon0, double k0, double e0, double n0, double lon,
                                double lat, double out[2]) {
    double f = 1 / e.inverse_f, n = f / (2 - f), n2 = n * n, n3 = n2 * n, n4 = n3 * n;
    double A = e.a / (1 + n) * (1 + n2 / 4 + n4 / 64);
    double alpha[] = { n / 2 - 2 * n2 / 3 + 5 * n3 / 16 + 41 * n4 / 180, 13 * n2 / 48 - 3 * n3 / 5 + 557 * n4 / 1440,
                       61 * n3 / 240 - 103 * n4 / 140, 49561 * n4 / 161280 };
    double s = sin(lat * M_PI / 180), l = (lon - lon0) * M_PI / 180, ecc = 2 * sqrt(n) / (1 + n);
    double t = sinh(atanh(s) - ecc * atanh(ecc * s)), xi = atan2(t, cos(l)), eta = atanh(sin(l) / sqrt(1 + t * t));
    double x = eta, y = xi;
    for (int j = 1; j <= 4; j++) {
        x += alpha[j - 1] * cos(2 * j * xi) * sinh(2 * j * eta);
        y += alpha[j - 1] * sin(2 * j * xi) * cosh(2 * j * eta);
    }
    out[0] = e0 + k0 * A * x;
    out[1] = n0 + k0 * A * y;
}

/* Seven parameters as position vector (m, arc seconds, ppm), height 0. */
static void helmert(struct ellipsoid from, const double p[7], struct ellipsoid to, double lon, double lat,
                    double out[2]) {
    double f = 1 / from.inverse_f, e2 = f * (2 - f), phi = lat * M_PI / 180, lambda = lon * M_PI / 180;
    double nu = from.a / sqrt(1 - e2 * sin(phi) * sin(phi));
    double v[3] = { nu * cos(phi) * cos(lambda), nu * cos(phi) * sin(lambda), nu * (1 - e2) * sin(phi) };
    double r[3], s = 1 + p[6] * 1e-6;
    for (int i = 0; i < 3; i++)
        r[i] = p[3 + i] / 3600 * M_PI / 180;
    double x = p[0] + s * (v[0] - r[2] * v[1] + r[1] * v[2]), y = p[1] + s * (r[2] * v[0] + v[1] - r[0] * v[2]),
           z = p[2] + s * (-r[1] * v[0] + r[0] * v[1] + v[2]);
    f = 1 / to.inverse_f, e2 = f * (2 - f);
    double rho = hypot(x, y);
    phi = atan2(z, rho * (1 - e2));
    for (int i = 0; i < 10; i++)
        phi = atan2(z + e2 * to.a * sin(phi) / sqrt(1 - e2 * sin(phi) * sin(phi)), rho);
    out[0] = atan2(y, x) * 180 / M_PI;
    out[1] = phi * 180 / M_PI;
}

/* Converts, and back again. */
static void convert(const char *from, const char *to, const double in[3], double out[3]) {
    noc_log *log = noc_log_create(NULL);
    geo_crs *a = geo_crs_create(from, NULL, log, NULL), *b = geo_crs_create(to, NULL, log, NULL);
    assert_non_null(a);
    assert_non_null(b);
    geo_transform *there = geo_transform_create(a, b, log, NULL), *back = geo_transform_create(b, a, log, NULL);
    assert_non_null(there);
    assert_non_null(back);
    memcpy(out, in, 3 * sizeof(double));
    assert_int_equal(geo_transform_points(there, out, 1), 0);
    double again[3] = { out[0], out[1], out[2] };
    assert_int_equal(geo_transform_points(back, again, 1), 0);
    /* datum shifts by small angles invert to millimetres */
    double tolerance = geo_crs_is_geographic(a) ? 5e-3 * METRE : 5e-3;
    for (int k = 0; k < 3; k++)
        assert_close(again[k], in[k], tolerance);
    geo_transform_destroy(there);
    geo_transform_destroy(back);
    geo_crs_destroy(a);
    geo_crs_destroy(b);
    noc_log_destroy(log);
}

/* Points of the Netherlands as published with RD and WGS 84 coordinates: the origin in Amersfoort, Westertoren and
 * Martinitoren (Schreutelkamp and Strang van Hees, Geodesia 2001; good to some decimetres). */
static void test_netherlands_28992(void **state) {
    (void)state;
    static const double points[][4] = { { 155000, 463000, 5.38720621, 52.15517440 },
                                        { 120700.723, 487525.501, 4.88352559, 52.37453253 },
                                        { 233883.131, 582065.167, 6.56820053, 53.21938317 } };
    for (size_t i = 0; i < NOC_COUNT(points); i++) {
        double out[3];
        convert("urn:ogc:def:crs:EPSG::28992", "OGC:CRS84", (double[]){ points[i][0], points[i][1], 12.5 }, out);
        assert_close(out[0], points[i][2], METRE);
        assert_close(out[1], points[i][3], 0.5 * METRE);
        assert_close(out[2], 12.5, 0);
    }
}

/* Krovak: the worked example of EPSG Guidance Note 7-2 (S-JTSK, without a datum shift), then Prague to WGS 84 by the
 * seven parameters of EPSG:5239 (coordinate frame: its rotations have the other sign) from the CRS's own geographic
 * base. */
static void test_czechia_5514(void **state) {
    (void)state;
    double out[3], base[3], expected[2];
    convert("EPSG:4156", "EPSG:5514", (double[]){ 16 + 50 / 60. + 59.179 / 3600, 50 + 12 / 60. + 32.442 / 3600, 0 },
            out);
    assert_close(out[0], -568990.997, 0.02);
    assert_close(out[1], -1050538.643, 0.02);
    double prague[] = { -743100, -1043000, 190 };
    convert("EPSG:5514", "EPSG:4156", prague, base);
    helmert(bessel, (double[]){ 572.213, 85.334, 461.94, 4.9732, 1.529, 5.2484, 3.5378 }, wgs84, base[0], base[1],
            expected);
    convert("EPSG:5514", "EPSG:4326", prague, out);
    assert_close(out[0], expected[0], 0.01 * METRE);
    assert_close(out[1], expected[1], 0.01 * METRE);
}

/* Vienna: transverse Mercator on Bessel, then MGI to WGS 84 (3), EPSG:1618. */
static void test_austria_31256(void **state) {
    (void)state;
    double lon = 16.3738, lat = 48.2085, plane[2], expected[2], out[3];
    transverse_mercator(bessel, 16 + 1 / 3., 1, 0, -5000000, lon, lat, plane);
    helmert(bessel, (double[]){ 577.326, 90.129, 463.919, 5.137, 1.474, 5.297, 2.4232 }, wgs84, lon, lat, expected);
    convert("http://www.opengis.net/def/crs/EPSG/0/31256", "EPSG:4326", (double[]){ plane[0], plane[1], 170 }, out);
    assert_close(out[0], expected[0], 0.01 * METRE);
    assert_close(out[1], expected[1], 0.01 * METRE);
}

/* Montreal, MTM zone 8 on NAD83(CSRS); WGS 84 is within two metres of it. */
static void test_montreal_2950(void **state) {
    (void)state;
    double plane[2], out[3], wgs[3];
    transverse_mercator(grs80, -73.5, 0.9999, 304800, 0, -73.5617, 45.5088, plane);
    convert("EPSG:2950", "EPSG:4617", (double[]){ plane[0], plane[1], 20 }, out);
    assert_close(out[0], -73.5617, 1e-3 * METRE);
    assert_close(out[1], 45.5088, 1e-3 * METRE);
    convert("EPSG:2950", "EPSG:4326", (double[]){ plane[0], plane[1], 20 }, wgs);
    assert_close(wgs[0], -73.5617, 3 * METRE);
    assert_close(wgs[1], 45.5088, 2 * METRE);
}

/* ETRS89 and WGS 84 are one within the accuracy of the maps. */
static void test_utm_25832(void **state) {
    (void)state;
    double plane[2], out[3];
    transverse_mercator(grs80, 9, 0.9996, 500000, 0, 11.4237, 48.7651, plane); /* Ingolstadt */
    convert("urn:adv:crs:ETRS89_UTM32*DE_DHHN2016_NH*GCG2016", "EPSG:4326", (double[]){ plane[0], plane[1], 370 }, out);
    assert_close(out[0], 11.4237, 1e-3 * METRE);
    assert_close(out[1], 48.7651, 1e-3 * METRE);
}

/* Tokyo: the tuples of the file are latitude longitude, ours are longitude latitude. */
static void test_japan_6697(void **state) {
    (void)state;
    double expected[2], out[3];
    transverse_mercator(grs80, 141, 0.9996, 500000, 0, 139.7671, 35.6812, expected);
    convert("http://www.opengis.net/def/crs/EPSG/0/6697", "EPSG:32654", (double[]){ 139.7671, 35.6812, 3.5 }, out);
    assert_close(out[0], expected[0], 1e-3);
    assert_close(out[1], expected[1], 1e-3);
    assert_close(out[2], 3.5, 0);
}

static void test_transform_details(void **state) {
    (void)state;
    noc_log *log = quiet_log();
    geo_crs *utm = geo_crs_create("EPSG:25832", NULL, log, NULL),
            *lonlat = geo_crs_create("EPSG:4326", NULL, log, NULL);
    geo_transform *t = geo_transform_create(lonlat, utm, log, NULL);
    /* a height that is not known stays so; a point that is nowhere becomes NaN, its neighbours do not */
    double p[] = { 9, 48, NAN, NAN, 48, 0, 9, 48, 7, INFINITY, 0, 0 };
    assert_int_equal(geo_transform_points(t, p, 4), 2);
    assert_close(p[0], 500000, 1e-3);
    assert_true(isnan(p[2]));
    assert_true(isnan(p[3]) && isnan(p[4]) && isnan(p[5]));
    assert_close(p[6], 500000, 1e-3);
    assert_close(p[8], 7, 0);
    geo_transform_destroy(t);
    t = geo_transform_create(utm, utm, log, NULL); /* nothing to do, and nothing done */
    double q[] = { 1e6 / 3, -1, 5 };
    assert_int_equal(geo_transform_points(t, q, 1), 0);
    assert_true(q[0] == 1e6 / 3 && q[1] == -1 && q[2] == 5);
    geo_transform_destroy(t);

    /* New York, US survey feet: heights are in feet too, unless the compound says otherwise */
    geo_crs *feet = geo_crs_create("EPSG:2263", NULL, log, NULL),
            *metres = geo_crs_create("urn:ogc:def:crs,crs:EPSG::2263,crs:EPSG::5703", NULL, log, NULL);
    assert_false(geo_crs_is_metric(feet));
    double a[] = { 980000, 200000, 100 }, b[] = { 980000, 200000, 100 };
    geo_transform *from_feet = geo_transform_create(feet, lonlat, log, NULL),
                  *from_metres = geo_transform_create(metres, lonlat, log, NULL);
    geo_transform_points(from_feet, a, 1);
    geo_transform_points(from_metres, b, 1);
    assert_close(a[2], 100 * 1200 / 3937., 1e-9);
    assert_close(b[2], 100, 0);
    assert_close(a[0], b[0], 0);
    geo_transform_destroy(from_feet);
    geo_transform_destroy(from_metres);
    geo_crs_destroy(feet);
    geo_crs_destroy(metres);
    geo_crs_destroy(utm);
    geo_crs_destroy(lonlat);
    noc_log_destroy(log);
}

static void test_equal(void **state) {
    (void)state;
    static const struct {
        const char *a, *b;
        bool equal;
    } cases[] = { { "urn:ogc:def:crs:EPSG::7415", "EPSG:28992", true },
                  { "EPSG:25832", "EPSG:25833", false },
                  { "CH1903", "EPSG:21781", true },
                  { "CH1903", "CH1903+", false },
                  { "EPSG:4326", "EPSG:4258", false } };
    for (size_t i = 0; i < NOC_COUNT(cases); i++) {
        geo_crs *a = geo_crs_create(cases[i].a, NULL, NULL, NULL), *b = geo_crs_create(cases[i].b, NULL, NULL, NULL);
        assert_int_equal(geo_crs_equal(a, b), cases[i].equal);
        geo_crs_destroy(a);
        geo_crs_destroy(b);
    }
}

static void test_area_of_use(void **state) {
    (void)state;
    static const struct {
        const char *crs;
        double x, y;
    } inside[] = { { "EPSG:5514", -743100, -1043000 }, { "EPSG:28992", 155000, 463000 },
                   { "EPSG:2950", 300000, 5040000 },   { "EPSG:31256", 3000, 341000 },
                   { "EPSG:25832", 678000, 5404000 },  { "EPSG:6697", 139.7, 35.6 } };
    for (size_t i = 0; i < NOC_COUNT(inside); i++) {
        geo_crs *crs = geo_crs_create(inside[i].crs, NULL, NULL, NULL);
        assert_close(geo_crs_outside(crs, inside[i].x, inside[i].y), 0, 0);
        if (!(geo_crs_outside(crs, inside[i].y, inside[i].x) > 0))
            fail_msg("%s: exchanged axes do not show", inside[i].crs);
        assert_true(geo_crs_outside(crs, NAN, 0) > 0);
        assert_true(geo_crs_outside(crs, 1e300, -1e300) > 0);
        geo_crs_destroy(crs);
    }
    /* an area across the antimeridian: New Zealand's CRS reaches from 160.6 E to 171.2 W */
    geo_crs *nz = geo_crs_create("EPSG:4167", NULL, NULL, NULL);
    assert_close(geo_crs_outside(nz, 174.8, -41.3), 0, 0);
    assert_close(geo_crs_outside(nz, -176.5, -44), 0, 0);
    assert_close(geo_crs_outside(nz, 0, -41.3), 160.6, 0.1);
    geo_crs_destroy(nz);
    static const struct {
        double lon, lat;
        const char *name;
    } zones[] = { { 14.42, 50.09, "EPSG:32633" },
                  { -58.4, -34.6, "EPSG:32721" },
                  { 180, 10, "EPSG:32660" },
                  { -180, 10, "EPSG:32601" } };
    for (size_t i = 0; i < NOC_COUNT(zones); i++) {
        geo_crs *utm = geo_crs_utm(zones[i].lon, zones[i].lat);
        assert_memory_equal(geo_crs_name(utm), zones[i].name, 10);
        assert_true(geo_crs_is_metric(utm));
        geo_crs_destroy(utm);
    }
}

/* Point scales against the formulas of Snyder 1987 (Map Projections, USGS PP 1395): Mercator's eq. 7-8, and for Web
 * Mercator the sphere's easting and northing over the ellipsoid's radii of curvature. */
static void test_scale(void **state) {
    (void)state;
    const double a = 6378137, e2 = 0.00669437999014, lat = 48.8 * M_PI / 180, s = sin(lat), w = 1 - e2 * s * s;
    const double along = a / (a * (1 - e2) / (w * sqrt(w))) / cos(lat), across = sqrt(w) / cos(lat);
    static const struct {
        const char *crs;
        double lon, lat;
    } places[] = {
        { "EPSG:3857", 11.4, 48.8 }, { "EPSG:3395", 11.4, 48.8 }, { "EPSG:32632", 9, 48.8 }, { "EPSG:31468", 12, 48.8 }
    };
    const double expected[] = { fabs(along - 1) > fabs(across - 1) ? along : across, across, .9996, 1 };
    for (size_t i = 0; i < NOC_COUNT(places); i++) {
        geo_crs *crs = geo_crs_create(places[i].crs, NULL, NULL, NULL),
                *degrees = geo_crs_create("OGC:CRS84", NULL, NULL, NULL);
        geo_transform *t = geo_transform_create(degrees, crs, NULL, NULL);
        double p[3] = { places[i].lon, places[i].lat, 0 };
        assert_int_equal(geo_transform_points(t, p, 1), 0);
        assert_close(geo_crs_scale(crs, p[0], p[1]), expected[i], 2e-6);
        assert_true(isnan(geo_crs_scale(degrees, 11.4, 48.8)));
        geo_transform_destroy(t);
        geo_crs_destroy(crs);
        geo_crs_destroy(degrees);
    }
}

/* Degrees that are none, of a broken file: going round the Earth until they fit would never end. */
static void test_far_longitude(void **state) {
    (void)state;
    double lonlat[2];
    geo_crs *crs = geo_crs_create("EPSG:4326", NULL, NULL, NULL);
    for (double lon = -1e4; lon > -1e300; lon *= 1e20)
        assert_true(isinf(geo_crs_outside(crs, lon, 48)) && !geo_crs_lonlat(crs, lon, 48, lonlat));
    assert_true(geo_crs_outside(crs, -350, 48) == 0);
    geo_crs_destroy(crs);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_scale),          cmocka_unit_test(test_spellings),
        cmocka_unit_test(test_not_understood), cmocka_unit_test(test_netherlands_28992),
        cmocka_unit_test(test_czechia_5514),   cmocka_unit_test(test_austria_31256),
        cmocka_unit_test(test_montreal_2950),  cmocka_unit_test(test_utm_25832),
        cmocka_unit_test(test_japan_6697),     cmocka_unit_test(test_transform_details),
        cmocka_unit_test(test_equal),          cmocka_unit_test(test_area_of_use),
        cmocka_unit_test(test_far_longitude),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
