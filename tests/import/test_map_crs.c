/* Maps whose CRS names a file, read in this process: nobody opens it. The file is a pipe without a writer, on which
 * whoever opens it waits for ever. */
#include "lamp_sink.h"

#include "noc_config.h"

#if NOC_HAVE_GDAL

#include <cpl_error.h>
#include <gdal.h>
#include <ogr_api.h>
#include <ogr_srs_api.h>
#include <sys/stat.h>

/* The other name is as long, and nothing has it: GDAL writes maps that name it. */
static char folder[] = "/tmp/nocturne-map-XXXXXX", pipe_path[60], absent[60];

static int make_pipe(void **state) {
    if (!mkdtemp(folder))
        return -1;
    snprintf(pipe_path, sizeof(pipe_path), "%s/pipe", folder);
    snprintf(absent, sizeof(absent), "%s/none", folder);
    alarm(300); /* what hangs fails */
    return mkfifo(pipe_path, 0600);
}

static int remove_pipe(void **state) {
    char command[100];
    snprintf(command, sizeof(command), "rm -r %s", folder);
    return system(command);
}

#define AXES                                                                                                           \
    "CS[ellipsoidal,2],AXIS[\"latitude\",north],AXIS[\"longitude\",east],ANGLEUNIT[\"degree\",0.0174532925199433]"
#define SOURCE "GEOGCRS[\"x\",DATUM[\"d\",ELLIPSOID[\"e\",6378137,298.25]]," AXES "]"
#define TARGET                                                                                                         \
    "GEOGCRS[\"WGS 84\",DATUM[\"World Geodetic System 1984\",ELLIPSOID[\"WGS 84\",6378137,298.257223563]]," AXES ","   \
    "ID[\"EPSG\",4326]]"

/* %s is the file. GDAL 3.6 opens all but the last, of which PROJ makes a grid. */
static const char bound[] = "BOUNDCRS[SOURCECRS[" SOURCE "],TARGETCRS[" TARGET
                            "],ABRIDGEDTRANSFORMATION[\"t\",METHOD[\"NTv2\",ID[\"EPSG\",9615]],"
                            "PARAMETERFILE[\"Latitude and longitude difference file\",\"%s\",ID[\"EPSG\",8656]]]]";
static const char datum_grid[] =
    "GEOGCS[\"x\",DATUM[\"d\",SPHEROID[\"s\",6378137,298.25],EXTENSION[\"PROJ4_GRIDS\",\"%s\"]],"
    "PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]]";
static const char extension[] =
    "PROJCS[\"x\",GEOGCS[\"x\",DATUM[\"d\",SPHEROID[\"s\",6378137,298.25]],PRIMEM[\"Greenwich\",0],UNIT[\"degree\","
    "0.0174532925199433]],PROJECTION[\"Mercator_1SP\"],PARAMETER[\"scale_factor\",1],UNIT[\"metre\",1],"
    "EXTENSION[\"PROJ4\",\"+proj=merc +nadgrids=%s +wktext\"]]";
static const char *const texts[] = { "+proj=merc +nadgrids=%s", "+init=%s:x", bound, datum_grid, extension };

static void expect_error(const char *path, noc_status expected, const char *why) {
    lamp_sink s;
    lamp_sink_start(&s);
    if (read_lamps(&s, path, NULL) != expected || !strstr(s.error, why) || !strstr(s.error, path))
        fail_msg("%s: %s", path, s.error);
    lamp_sink_end(&s);
}

static void expect_refused(const char *path) { expect_error(path, NOC_ERR_FORMAT, "may open files"); }

/* ---- GeoJSON ---- */

static char *json_text(const char *text) {
    static char out[3000];
    size_t n = 0;
    for (const char *p = text; *p && n + 3 < sizeof(out); p++) {
        if (*p == '"')
            out[n++] = '\\';
        out[n++] = *p;
    }
    out[n] = 0;
    return out;
}

static void write_geojson(const char *path, const char *before, const char *inside) {
    FILE *f = fopen(path, "w");
    assert_non_null(f);
    fprintf(f,
            "{\"type\": \"FeatureCollection\", %s \"features\": [{\"type\": \"Feature\", \"properties\": "
            "{\"highway\": \"street_lamp\", \"note\": \"+proj=merc +nadgrids=x\"}, "
            "\"geometry\": {\"type\": \"Point\", %s \"coordinates\": [11.42, 48.76]}}]}",
            before, inside);
    fclose(f);
}

#define NAMED(text) "\"crs\": {\"type\": \"name\", \"properties\": {\"name\": \"" text "\"}},"

static void test_geojson(void **state) {
    char path[80], member[4000], text[2000];
    snprintf(path, sizeof(path), "%s/a.geojson", folder);
    for (size_t i = 0; i < NOC_COUNT(texts); i++) {
        snprintf(text, sizeof(text), texts[i], pipe_path);
        snprintf(member, sizeof(member), "\"crs\": {\"type\": \"name\", \"properties\": {\"name\": \"%s\"}},",
                 json_text(text));
        write_geojson(path, member, "");
        expect_refused(path);
        write_geojson(path, "", member);
        expect_refused(path);
    }
    static const char *const spellings[] = {
        "\"CRS\": {\"type\": \"name\", \"properties\": {\"name\": \"+proj=merc +nadgrids=%s\"}},",
        "\"\\u0063rs\": {\"type\": \"name\", \"properties\": {\"name\": \"\\u002bproj=merc +nad\\u0067rids=%s\"}},",
        "\"crs\\u0000x\" : {\"type\": \"name\", \"properties\": {\"name\": \"+proj=merc\\t+nadgrids=%s\"}},",
        "\"crs\": null, \"crs\": {\"a\": {}, \"type\": \"name\", "
        "\"properties\": {\"b\": \"\\\"\", \"name\": \"+proj=merc +nadgrids=%s\"}},",
        NAMED("ESRI::DICT:../..%s,abc"),
        NAMED("esri::ESRI:: dict:../..%s,abc"),
        NAMED("+title=x +init = %s:x"),
        NAMED("+init=epsg:4326"),
        NAMED("+title=x +proj = merc +nadgrids = %s"),
        NAMED("+proj=merc;nadgrids=%s"),
        NAMED("+proj=merc +nadgrids= +%s"),
        NAMED("+proj=merc +nadgrids=@null ,%s"),
        NAMED("+proj=merc +nadgrids=@null\\\",%s"),
        NAMED("+proj=merc\\u000bnadgrids\\u000b=%s"),
    };
    for (size_t i = 0; i < NOC_COUNT(spellings); i++) {
        snprintf(member, sizeof(member), spellings[i], pipe_path);
        write_geojson(path, member, "");
        expect_refused(path);
    }
}

/* What one reader of JSON takes for the end of a string is not where another one does. */
#define PROJJSON_CRS(name, ellipsoid)                                                                                  \
    "{\"type\": \"GeographicCRS\", \"name\": \"" name                                                                  \
    "\", \"datum\": {\"type\": \"GeodeticReferenceFrame\", \"name\": \"d\", "                                          \
    "\"ellipsoid\": {\"name\": \"" ellipsoid                                                                           \
    "\", \"semi_major_axis\": 6378137, \"inverse_flattening\": 298.257223563}}, "                                      \
    "\"coordinate_system\": {\"subtype\": \"ellipsoidal\", \"axis\": [{\"name\": \"Lat\", \"abbreviation\": \"lat\", " \
    "\"direction\": \"north\", \"unit\": \"degree\"}, {\"name\": \"Lon\", \"abbreviation\": \"lon\", \"direction\": "  \
    "\"east\", \"unit\": \"degree\"}]}}"

/* GDAL takes the text of an object in the name's place, whose strings alone name no grid. */
static void test_crs_in_parts(void **state) {
    char path[80], member[3000];
    snprintf(path, sizeof(path), "%s/parts.geojson", folder);
    snprintf(member, sizeof(member),
             "\"crs\": {\"type\": \"name\", \"properties\": {\"name\": {\"type\": \"BoundCRS\", "
             "\"source_crs\": " PROJJSON_CRS("x", "e") ", \"target_crs\": " PROJJSON_CRS(
                 "WGS 84", "WGS 84") ", \"transformation\": {\"name\": "
                                     "\"x\", \"method\": {\"name\": \"NTv2\", "
                                     "\"id\": {\"authority\": \"EPSG\", \"code\": 9615}}, "
                                     "\"parameters\": [{\"name\": \"Latitude and longitude "
                                     "difference file\", \"value\": \"%s\", "
                                     "\"id\": {\"authority\": \"EPSG\", \"code\": 8656}}]}}}},",
             pipe_path);
    write_geojson(path, member, "");
    expect_error(path, NOC_ERR_FORMAT, "a CRS in parts");
}

static void test_hidden(void **state) {
    static const char *const hidden[] = {
        "/* \" */ \"crs\": {\"type\": \"name\", \"properties\": {\"name\": \"+proj=merc +nadgrids=%s\"}}, \"x\": \"\",",
        "'\"': 1, \"crs\": {\"type\": \"name\", \"properties\": {\"name\": \"+proj=merc +nadgrids=%s\"}}, \"x\": \"\",",
    };
    for (size_t i = 0; i < NOC_COUNT(hidden); i++) {
        char path[80], member[400];
        snprintf(path, sizeof(path), "%s/b.geojson", folder);
        snprintf(member, sizeof(member), hidden[i], pipe_path);
        write_geojson(path, member, "");
        lamp_sink s;
        lamp_sink_start(&s);
        assert_int_equal(read_lamps(&s, path, NULL), NOC_ERR_FORMAT);
        assert_non_null(strstr(s.error, "outside of strings"));
        lamp_sink_end(&s);
    }
}

/* Properties are nobody's CRS, and these are CRSs that maps do hold. */
static void test_plain(void **state) {
    static const char *const plain[] = {
        "",
        "\"crs\": null,",
        "\"crs\": {\"type\": \"name\", \"properties\": {\"name\": \"urn:ogc:def:crs:OGC:1.3:CRS84\"}},",
        "\"crs\": {\"type\": \"name\", \"properties\": {\"name\": \"EPSG:4326\"}}, \"grids\": \"+proj=x +file=y\",",
    };
    for (size_t i = 0; i < NOC_COUNT(plain); i++) {
        char path[80];
        snprintf(path, sizeof(path), "%s/c.geojson", folder);
        write_geojson(path, plain[i], "");
        lamp_sink s;
        lamp_sink_start(&s);
        if (read_lamps(&s, path, NULL) || s.lamps.len != 1)
            fail_msg("%s: %s", plain[i], s.error);
        lamp_sink_end(&s);
    }
}

/* ---- the others ---- */

/* A lamp in a CRS of this text (NULL: of none), by GDAL. */
static void write_map(const char *driver, const char *path, const char *text) {
    OGRRegisterAll();
    CPLPushErrorHandler(CPLQuietErrorHandler); /* that it finds no grid */
    OGRSpatialReferenceH srs = text ? OSRNewSpatialReference(NULL) : NULL;
    if (srs)
        assert_int_equal(OSRSetFromUserInput(srs, text), OGRERR_NONE);
    GDALDatasetH dataset = GDALCreate(GDALGetDriverByName(driver), path, 0, 0, 0, GDT_Unknown, NULL);
    assert_non_null(dataset);
    OGRLayerH layer = GDALDatasetCreateLayer(dataset, "lamps", srs, wkbPoint, NULL);
    OGRFieldDefnH type = OGR_Fld_Create("LampType", OFTString);
    assert_int_equal(OGR_L_CreateField(layer, type, 1), OGRERR_NONE);
    OGRFeatureH feature = OGR_F_Create(OGR_L_GetLayerDefn(layer));
    OGR_F_SetFieldString(feature, 0, "LED");
    OGRGeometryH point = OGR_G_CreateGeometry(wkbPoint);
    OGR_G_SetPoint_2D(point, 0, 11.42, 48.76);
    assert_int_equal(OGR_F_SetGeometryDirectly(feature, point), OGRERR_NONE);
    assert_int_equal(OGR_L_CreateFeature(layer, feature), OGRERR_NONE);
    OGR_F_Destroy(feature);
    OGR_Fld_Destroy(type);
    if (srs)
        OSRDestroySpatialReference(srs);
    GDALClose(dataset);
    CPLPopErrorHandler();
}

/* Where a file holds `from`, n bytes, it holds `to` afterwards. */
static void replace_bytes(const char *path, const char *from, const char *to, size_t n) {
    static char data[1 << 20];
    FILE *f = fopen(path, "rb+");
    assert_non_null(f);
    size_t size = fread(data, 1, sizeof(data), f), found = 0;
    assert_true(size < sizeof(data));
    for (char *p = data; (p = memmem(p, size - (size_t)(p - data), from, n)); found++)
        memcpy(p, to, n);
    assert_true(found > 0);
    rewind(f);
    assert_int_equal(fwrite(data, 1, size, f), size);
    fclose(f);
}

static void test_flatgeobuf(void **state) {
    const char *const kinds[] = { texts[0], bound, datum_grid, extension };
    for (size_t i = 0; i < NOC_COUNT(kinds); i++) {
        char path[80], text[2000];
        snprintf(path, sizeof(path), "%s/%zu.fgb", folder, i);
        snprintf(text, sizeof(text), kinds[i], absent);
        write_map("FlatGeobuf", path, text);
        replace_bytes(path, absent, pipe_path, strlen(absent));
        expect_refused(path);
    }
}

/* GDAL takes an authority's name, ":" and the code for a CRS. */
static void test_flatgeobuf_authority(void **state) {
    static const char name[] = "authority with a name of no use", text[] = "+proj=merc      +nadgrids=@null";
    char path[80], wkt[1000];
    assert_int_equal(sizeof(name), sizeof(text));
    snprintf(path, sizeof(path), "%s/authority.fgb", folder);
    snprintf(wkt, sizeof(wkt), "GEOGCRS[\"x\",DATUM[\"d\",ELLIPSOID[\"e\",6378137,298.25]]," AXES ",ID[\"%s\",5]]",
             name);
    write_map("FlatGeobuf", path, wkt);
    lamp_sink s;
    lamp_sink_start(&s);
    if (read_lamps(&s, path, NULL) || s.lamps.len != 1)
        fail_msg("%s", s.error);
    lamp_sink_end(&s);
    replace_bytes(path, name, text, sizeof(name)); /* with its 0: what the WKT says stays */
    expect_refused(path);
}

/* That only its header is looked at before GDAL reads it makes it no smaller. */
static void test_packed(void **state) {
    char path[80], packed[90], command[200];
    struct stat st;
    snprintf(path, sizeof(path), "%s/packed.fgb", folder);
    snprintf(packed, sizeof(packed), "%s.gz", path);
    snprintf(command, sizeof(command), "gzip -k %s", path);
    write_map("FlatGeobuf", path, "EPSG:4326");
    assert_int_equal(stat(path, &st), 0);
    assert_int_equal(system(command), 0);
    noc_import_params params = noc_import_default_params();
    lamp_sink s;
    lamp_sink_start(&s);
    noc_stream *stream = noc_stream_open(packed, s.log, NULL);
    assert_non_null(stream);
    assert_int_equal(noc_reader_vector.read(stream, &params, &s.sink, &s.format), NOC_OK);
    assert_int_equal(noc_stream_read_bytes(stream), st.st_size);
    noc_stream_close(stream);
    lamp_sink_end(&s);
}

/* The index begins as the shapes do: it is none, so that a folder has them once. */
static void test_shapefile_in_a_folder(void **state) {
    char path[100], inner[60];
    snprintf(inner, sizeof(inner), "%s/inner", folder);
    assert_int_equal(mkdir(inner, 0700), 0);
    snprintf(path, sizeof(path), "%s/lamps.shp", inner);
    write_map("ESRI Shapefile", path, "EPSG:25832");
    noc_scene *scene = noc_scene_create(NULL);
    noc_report *report = NULL;
    noc_import_params params = noc_import_default_params();
    const char *input = inner;
    assert_int_equal(noc_scene_load(scene, &input, 1, &params, &report), NOC_OK);
    size_t count = noc_report_file_count(report), shapefiles = 0;
    for (size_t i = 0; i < count; i++)
        shapefiles += !strcmp(noc_report_get_file(report, i)->format, "Shapefile");
    assert_int_equal(shapefiles, 1);
    noc_report_destroy(report);
    noc_scene_destroy(scene);
}

/* GDAL puts the lines of a .prj together with nothing between, and leaves out what a 0 hides in one. */
static void test_shapefile(void **state) {
    static const struct {
        const char *within, *between;
        size_t length;
    } parted[] = { { "", "", 0 },         { "_GRIDS", "\n", 1 }, { "grids", "\r\n", 2 }, { "xtension", "\r", 1 },
                   { "ID", "\0no\n", 4 }, { "rids", "\0\r", 2 }, { ",", "\n", 1 } };
    const char *const kinds[] = { datum_grid, extension };
    for (size_t i = 0; i < NOC_COUNT(kinds) * NOC_COUNT(parted); i++) {
        char path[80], prj[80], text[2000];
        size_t k = i / NOC_COUNT(kinds);
        snprintf(path, sizeof(path), "%s/s%zu.shp", folder, i);
        snprintf(prj, sizeof(prj), "%s/s%zu.%s", folder, i, i % 4 < 2 ? "PRJ" : "prj");
        snprintf(text, sizeof(text), kinds[i % NOC_COUNT(kinds)], pipe_path);
        write_map("ESRI Shapefile", path, NULL);
        FILE *f = fopen(prj, "w");
        assert_non_null(f);
        for (const char *p = text; *p; p++) {
            if (k && !strncasecmp(p, parted[k].within, strlen(parted[k].within)))
                fwrite(parted[k].between, 1, parted[k].length, f);
            fputc(*p, f);
        }
        fclose(f);
        expect_refused(path);
    }
}

/* Runs SQL over a GeoPackage: one statement or two. */
static void change(const char *path, const char *first, const char *second) {
    GDALDatasetH dataset = GDALOpenEx(path, GDAL_OF_VECTOR | GDAL_OF_UPDATE, NULL, NULL, NULL);
    assert_non_null(dataset);
    assert_null(GDALDatasetExecuteSQL(dataset, first, NULL, NULL));
    if (second)
        assert_null(GDALDatasetExecuteSQL(dataset, second, NULL, NULL));
    GDALClose(dataset);
}

static void test_geopackage(void **state) {
    const char *const kinds[] = { bound, datum_grid, extension };
    for (size_t i = 0; i < NOC_COUNT(kinds); i++) {
        char path[80], text[2000], sql[3000];
        snprintf(path, sizeof(path), "%s/%zu.gpkg", folder, i);
        snprintf(text, sizeof(text), kinds[i], pipe_path);
        write_map("GPKG", path, "EPSG:4326");
        snprintf(sql, sizeof(sql), "UPDATE gpkg_spatial_ref_sys SET organization = 'x', definition = '%s'", text);
        change(path, sql, NULL);
        expect_refused(path);
    }
}

/* A view may give another answer each time, and so may what is computed; an index holds what whoever made it wrote
 * there. */
static void test_geopackage_table(void **state) {
    static const char rename[] = "ALTER TABLE gpkg_spatial_ref_sys RENAME TO kept";
    static const struct {
        const char *first, *second, *why;
    } others[] = {
        { rename,
          "CREATE VIEW \"gpkg_spatial_ref_sys\" AS SELECT srs_name, srs_id, 'x' AS organization, "
          "organization_coordsys_id, CASE WHEN random() > 0 THEN definition ELSE '+proj=merc +nadgrids=x' END AS "
          "definition, description FROM kept",
          "a view" },
        { rename,
          "CREATE VIRTUAL TABLE \"gpkg_spatial_ref_sys\" USING rtree(srs_id, a, b, +srs_name, +organization, "
          "+organization_coordsys_id, +definition, +description)",
          "a virtual table" },
        { rename,
          "CREATE TABLE gpkg_spatial_ref_sys (srs_name TEXT, srs_id INTEGER NOT NULL PRIMARY KEY, organization TEXT, "
          "organization_coordsys_id INTEGER, kept TEXT, definition TEXT GENERATED ALWAYS AS (kept) VIRTUAL, "
          "description TEXT)",
          "a hidden or generated column" },
        { rename,
          "CREATE TABLE gpkg_spatial_ref_sys (srs_name TEXT, srs_id INTEGER NOT NULL PRIMARY KEY, organization TEXT, "
          "organization_coordsys_id INTEGER, definition TEXT GENERATED ALWAYS AS ('+proj=merc +nadgrids=x') STORED, "
          "description TEXT)",
          "a hidden or generated column" },
        { "CREATE INDEX i ON gpkg_spatial_ref_sys (srs_id, definition, organization)", NULL, "an index" },
        { rename,
          "CREATE TABLE gpkg_spatial_ref_sys (srs_name TEXT, srs_id INTEGER NOT NULL PRIMARY KEY, organization TEXT, "
          "organization_coordsys_id INTEGER, definition TEXT UNIQUE, description TEXT)",
          "an index" },
        { rename,
          "CREATE TABLE gpkg_spatial_ref_sys (srs_name TEXT, srs_id INTEGER, organization TEXT, "
          "organization_coordsys_id INTEGER, definition TEXT, description TEXT, PRIMARY KEY (srs_id, "
          "definition)) WITHOUT ROWID",
          "an index" },
    };
    for (size_t i = 0; i < NOC_COUNT(others); i++) {
        char path[80];
        snprintf(path, sizeof(path), "%s/table%zu.gpkg", folder, i);
        write_map("GPKG", path, "EPSG:4326");
        change(path, others[i].first, others[i].second);
        expect_error(path, NOC_ERR_UNSUPPORTED, others[i].why);
    }
}

#endif

int main(void) {
#if NOC_HAVE_GDAL
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_geojson),          cmocka_unit_test(test_crs_in_parts),
        cmocka_unit_test(test_hidden),           cmocka_unit_test(test_plain),
        cmocka_unit_test(test_flatgeobuf),       cmocka_unit_test(test_flatgeobuf_authority),
        cmocka_unit_test(test_packed),           cmocka_unit_test(test_shapefile_in_a_folder),
        cmocka_unit_test(test_shapefile),        cmocka_unit_test(test_geopackage),
        cmocka_unit_test(test_geopackage_table),
    };
    return cmocka_run_group_tests(tests, make_pipe, remove_pipe);
#else
    return 0;
#endif
}
