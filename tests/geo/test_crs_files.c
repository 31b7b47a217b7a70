/* Definitions of CRSs that name files: those of files are refused, those that a user types do not hang on a pipe. */
#include "geo/geo.h"
#include "../test.h"

#include <fcntl.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

static char folder[] = "/tmp/nocturne-crs-XXXXXX";
static char pipe_path[64]; /* of a pipe without a writer: whoever opens it waits for ever */

static int make_pipe(void **state) {
    if (!mkdtemp(folder))
        return -1;
    snprintf(pipe_path, sizeof(pipe_path), "%s/grid.gsb", folder);
    alarm(300); /* what hangs fails */
    return mkfifo(pipe_path, 0600);
}

static int remove_pipe(void **state) { return unlink(pipe_path) || rmdir(folder); }

#define GEOGCS                                                                                                         \
    "GEOGCS[\"x\",DATUM[\"D\",SPHEROID[\"S\",6378137,298.25]],PRIMEM[\"Greenwich\",0],"                                \
    "UNIT[\"degree\",0.0174532925199433]"
#define GEOGCRS                                                                                                        \
    "GEOGCRS[\"x\",DATUM[\"D\",ELLIPSOID[\"S\",6378137,298.25]],CS[ellipsoidal,2],AXIS[\"lat\",north],"                \
    "AXIS[\"lon\",east],ANGLEUNIT[\"degree\",0.0174532925199433]]"

#define GEOGCRS_BODY "GEOGCRS[\"x\",DATUM[\"D\",ELLIPSOID[\"S\",6378137,298.25]]"

/* %s is the pipe */
static const char *const hostile[] = {
    "+proj=longlat +ellps=GRS80 +nadgrids=%s +no_defs",
    "+proj=longlat +ellps=GRS80 +nadgrids=@%s +no_defs +type=crs",
    "+proj=longlat +ellps=GRS80 +nadgrids=@null,%s",
    "+proj=utm +zone=32 +ellps=GRS80 +geoidgrids=%s",
    "+proj=utm +zone=32 +ellps=GRS80 nadgrids=%s",
    "proj=utm zone=32 ellps=GRS80 nadgrids=%s",
    "+proj=utm +zone=32;nadgrids=%s",
    "+proj = utm +zone=32 +nadgrids = %s",
    "+title=x +proj\t=\tutm +zone=32 nadgrids\v= + %s",
    "+proj=longlat +ellps=GRS80 +nadgrids=@null ,%s",
    "+proj=longlat +ellps=GRS80 +nadgrids=@null\",%s",
    "+init=%s:x",
    "init=%s:x",
    "+title=x +init = %s:x",
    "PROJCRS[\"x\",BASE" GEOGCRS_BODY
    "],CONVERSION[\"c\",METHOD[\"PROJ merc\"],PARAMETER[\"nadgrids=%s,@null\",0]],CS[Cartesian,2],"
    "AXIS[\"e\",east],AXIS[\"n\",north],LENGTHUNIT[\"metre\",1]]",
    "+proj=pipeline +step +proj=hgridshift +grids=%s",
    "+proj=hgridshift +grids=%s +type=crs",
    "+proj=tinshift +file=%s +type=crs",
    "+proj=defmodel +model=%s +type=crs",
    GEOGCS ",EXTENSION[\"PROJ4\",\"+proj=longlat +ellps=GRS80 +nadgrids=%s +no_defs\"]]",
    "BOUNDCRS[SOURCECRS[" GEOGCRS "],TARGETCRS[" GEOGCRS
    "],ABRIDGEDTRANSFORMATION[\"t\",METHOD[\"NTv2\",ID[\"EPSG\",9615]],"
    "PARAMETERFILE[\"Latitude and longitude difference file\",\"%s\",ID[\"EPSG\",8656]]]]",
    "{\"type\":\"BoundCRS\",\"source_crs\":{\"type\":\"GeographicCRS\",\"name\":\"x\","
    "\"datum\":{\"type\":\"GeodeticReferenceFrame\",\"name\":\"D\",\"ellipsoid\":{\"name\":\"S\","
    "\"semi_major_axis\":6378137,\"inverse_flattening\":298.25}},\"coordinate_system\":"
    "{\"subtype\":\"ellipsoidal\",\"axis\":[{\"name\":\"lat\",\"abbreviation\":\"lat\",\"direction\":\"north\","
    "\"unit\":\"degree\"},{\"name\":\"lon\",\"abbreviation\":\"lon\",\"direction\":\"east\","
    "\"unit\":\"degree\"}]}},\"target_crs\":{\"type\":\"GeographicCRS\",\"name\":\"y\","
    "\"datum\":{\"type\":\"GeodeticReferenceFrame\",\"name\":\"E\",\"ellipsoid\":{\"name\":\"S\","
    "\"semi_major_axis\":6378137,\"inverse_flattening\":298.25}},"
    "\"coordinate_system\":{\"subtype\":\"ellipsoidal\",\"axis\":[{\"name\":\"lat\","
    "\"abbreviation\":\"lat\",\"direction\":\"north\",\"unit\":\"degree\"},"
    "{\"name\":\"lon\",\"abbreviation\":\"lon\",\"direction\":\"east\",\"unit\":\"degree\"}]}},"
    "\"transformation\":{\"name\":\"t\",\"method\":{\"name\":\"NTv2\",\"id\":{\"authority\":\"EPSG\","
    "\"code\":9615}},\"parameters\":[{\"name\":\"Latitude and longitude difference "
    "file\",\"value\":\"%s\",\"id\":{\"authority\":\"EPSG\",\"code\":8656}}]}}",
};

/* Does somebody read the pipe? Opening it for writing without waiting succeeds only then. */
static void *watch(void *seen) {
    for (int i = 0; i < 400 && !*(bool *)seen; i++) {
        int fd = open(pipe_path, O_WRONLY | O_NONBLOCK);
        if (fd >= 0) {
            *(bool *)seen = true;
            close(fd); /* and whoever waits goes on */
        }
        usleep(5000);
    }
    return NULL;
}

static void test_of_files(void **state) {
    bool seen = false;
    pthread_t watcher;
    assert_int_equal(pthread_create(&watcher, NULL, watch, &seen), 0);
    for (size_t i = 0; i < NOC_COUNT(hostile); i++) {
        char text[2000];
        snprintf(text, sizeof(text), hostile[i], pipe_path);
        if (geo_crs_create_plain(text, "file", NULL, NULL))
            fail_msg("accepted: %s", text);
    }
    pthread_join(watcher, NULL);
    assert_false(seen);
}

static void test_typed(void **state) {
    for (size_t i = 0; i < NOC_COUNT(hostile); i++) {
        char text[2000];
        snprintf(text, sizeof(text), hostile[i], pipe_path);
        geo_crs *crs = geo_crs_create(text, "--crs", NULL, NULL), *utm = geo_crs_utm(11, 48);
        geo_transform *t = crs ? geo_transform_create(crs, utm, NULL, NULL) : NULL;
        double xyz[3] = { 11, 48, 0 };
        if (t)
            geo_transform_points(t, xyz, 1);
        if (crs)
            geo_crs_outside(crs, 11, 48);
        geo_transform_destroy(t);
        geo_crs_destroy(crs);
        geo_crs_destroy(utm);
    }
}

/* Before another library sees a text. */
static void test_text(void **state) {
    char what[40];
    for (size_t i = 0; i < NOC_COUNT(hostile); i++) {
        char text[2000];
        snprintf(text, sizeof(text), hostile[i], pipe_path);
        if (!geo_crs_text_names_file(text, what) || !*what)
            fail_msg("not seen: %s", text);
    }
    static const char *const others[] = {
        GEOGCS ",DATUM[\"D\",SPHEROID[\"S\",1,2],EXTENSION[\"PROJ4_GRIDS\",\"a.gsb\"]]]",
        "dict:a,b",
        "+init=epsg:25832 +nadgrids=a",
        "ESRI::DICT:a,b",
        " esri::ESRI::\tDict:a,b",
        "ESRI::{\"value\": \"a\"}",
        "+init=epsg:25832",
        "+init = epsg:25832",
        "+proj=merc +nadgrids=@null:0",
        GEOGCS ",DATUM[\"D\",SPHEROID[\"S\",1,2],EXTENSION[\"PROJ4_GRIDS\",\"@null\"\"/a\"]]]",
        "{\"method\": {\"name\": \"PROJ merc\"}}",
        "PARAMETERFILE[\"a\",\"@null.gsb\"]",
        "PARAMETERFILE[\"a,\"\"@null\",\"b.gsb\"]",
        "{\"type\": \"Bound\\u0043RS\"}",
    };
    for (size_t i = 0; i < NOC_COUNT(others); i++)
        if (!geo_crs_text_names_file(others[i], what))
            fail_msg("not seen: %s", others[i]);
    static const char *const fine[] = { "PARAMETERFILE[\"Latitude and longitude difference file\",\"@null\"]",
                                        "a city",
                                        "Predict: a, b",
                                        "OSGB36 / British National Grid",
                                        "{\"type\": \"x\", \"value\": 1}",
                                        "" };
    for (size_t i = 0; i < NOC_COUNT(fine); i++)
        if (geo_crs_text_names_file(fine[i], what))
            fail_msg("refused for %s: %s", what, fine[i]);
}

static void silent(void *user, noc_log_level level, const char *text) {}

static void test_why(void **state) {
    noc_log *log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_ERROR, .message = silent });
    assert_null(geo_crs_create_plain("+proj=longlat +ellps=GRS80 +nadgrids=a.gsb", "lamps.gpkg", log, NULL));
    assert_non_null(strstr(noc_log_last_error(log), "lamps.gpkg: the CRS"));
    assert_non_null(strstr(noc_log_last_error(log), "nadgrids"));
    noc_log_destroy(log);
}

/* What files do hold. */
static void test_plain(void **state) {
    static const char *const plain[] = {
        "EPSG:25832",
        "urn:ogc:def:crs:EPSG::25832",
        "+proj=utm +zone=32 +datum=WGS84 +units=m +no_defs",
        "+proj=merc +a=6378137 +b=6378137 +lat_ts=0 +lon_0=0 +x_0=0 +y_0=0 +k=1 +units=m +nadgrids=@null +wktext "
        "+no_defs",
        "+proj=tmerc +lat_0=0 +lon_0=9 +k=1 +x_0=3500000 +y_0=0 +ellps=bessel +towgs84=598.1,73.7,418.2,0.202,0.045,"
        "-2.455,6.7 +units=m +no_defs",
        GEOGCS ",REMARK[\"a=b c=d\"]]",
        GEOGCRS,
        "PROJCS[\"WGS 84 / Pseudo-Mercator\"," GEOGCS
        "],PROJECTION[\"Mercator_1SP\"],PARAMETER[\"central_meridian\",0],"
        "PARAMETER[\"scale_factor\",1],PARAMETER[\"false_easting\",0],PARAMETER[\"false_northing\",0],"
        "UNIT[\"metre\",1],EXTENSION[\"PROJ4\",\"+proj=merc +a=6378137 +b=6378137 +lat_ts=0.0 +lon_0=0.0 +x_0=0.0 "
        "+y_0=0 +k=1.0 +units=m +nadgrids=@null +wktext +no_defs\"]]",
    };
    noc_log *log = noc_log_create(NULL);
    for (size_t i = 0; i < NOC_COUNT(plain); i++) {
        char what[40];
        geo_crs *crs = geo_crs_create_plain(plain[i], "file", log, NULL);
        if (!crs || geo_crs_text_names_file(plain[i], what))
            fail_msg("refused: %s", plain[i]);
        geo_crs_destroy(crs);
    }
    noc_log_destroy(log);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_of_files), cmocka_unit_test(test_typed), cmocka_unit_test(test_text),
        cmocka_unit_test(test_why),      cmocka_unit_test(test_plain),
    };
    return cmocka_run_group_tests(tests, make_pipe, remove_pipe);
}
