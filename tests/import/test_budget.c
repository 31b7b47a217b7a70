/* Small files that ask for much: each is refused under the limit's name, and read where the limit allows it. */
#include "../test.h"
#include "import/load/load.h"
#include "import/mesh/obj_materials.h"
#include "noc_config.h"
#include "nocturne/nocturne.h"

#include <math.h>
#include <zlib.h>

static char folder[] = "/tmp/noc-budget-XXXXXX";
static char errors[2000];
static int error_count;

static void on_message(void *user, noc_log_level level, const char *text) {
    if (level == NOC_LOG_ERROR) {
        snprintf(errors, sizeof(errors), "%s", text);
        error_count++;
    }
}

static int set_up(void **state) { return mkdtemp(folder) ? 0 : -1; }

static int tear_down(void **state) {
    char command[300];
    snprintf(command, sizeof(command), "rm -r '%s'", folder);
    return system(command);
}

static const char *path_of(const char *name) {
    static char path[300];
    snprintf(path, sizeof(path), "%s/%s", folder, name);
    return path;
}

static FILE *create(const char *name) {
    FILE *f = fopen(path_of(name), "wb");
    assert_non_null(f);
    return f;
}

/* Inspects the file with so many GB; the report goes to *file where it is read. */
static noc_status inspect(const char *name, double gigabytes, noc_report_file *file) {
    noc_log *log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_WARN, .message = on_message });
    noc_import_params params = noc_import_default_params();
    params.max_memory = gigabytes;
    noc_report *report;
    error_count = 0;
    *errors = 0;
    noc_status status = noc_inspect(log, path_of(name), &params, &report);
    *file = status ? (noc_report_file){ 0 } : *noc_report_get_file(report, 0);
    noc_report_destroy(report);
    noc_log_destroy(log);
    return status;
}

/* The same, loaded into a scene. */
static noc_status load(const char *name, double gigabytes) {
    noc_log *log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_WARN, .message = on_message });
    noc_import_params params = noc_import_default_params();
    params.max_memory = gigabytes;
    noc_scene *scene = noc_scene_create(log);
    error_count = 0;
    *errors = 0;
    noc_status status = noc_scene_load(scene, (const char *[]){ path_of(name) }, 1, &params, NULL);
    noc_scene_destroy(scene);
    noc_log_destroy(log);
    return status;
}

static void refused(const char *name, double gigabytes, const char *limit) {
    noc_report_file file;
    noc_status status = inspect(name, gigabytes, &file);
    if (status != NOC_ERR_MEMORY)
        fail_msg("%s: %s", name, errors);
    assert_int_equal(error_count, 1);
    assert_non_null(strstr(errors, limit));
    assert_non_null(strstr(errors, name));
}

static void allowed(const char *name, double gigabytes, size_t triangles) {
    noc_report_file file;
    assert_int_equal(inspect(name, gigabytes, &file), NOC_OK);
    assert_int_equal(file.triangles, triangles);
}

/* A megabyte of gzip members that are a gigabyte and more. */
static void compressed_data_is_bounded(void **state) {
    enum { PIECE = 16 << 20, TIMES = 70 };
    unsigned char *zeros = noc_alloc_large(PIECE, 1), *packed = noc_alloc_large(1 << 18, 1);
    z_stream z = { 0 };
    assert_int_equal(deflateInit2(&z, 1, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY), Z_OK);
    z.next_in = zeros, z.avail_in = PIECE, z.next_out = packed, z.avail_out = 1 << 18;
    assert_int_equal(deflate(&z, Z_FINISH), Z_STREAM_END);
    FILE *f = create("bomb.gz");
    for (int i = 0; i < TIMES; i++)
        assert_int_equal(fwrite(packed, 1, z.total_out, f), z.total_out);
    fclose(f);
    deflateEnd(&z);
    noc_log *log = noc_log_create(&(noc_log_params){ .message = on_message });
    noc_stream *s = noc_stream_open(path_of("bomb.gz"), log, NULL);
    noc_status status = NOC_OK;
    size_t got = 1;
    error_count = 0;
    while (!status && got)
        status = noc_stream_read(s, zeros, PIECE, &got);
    assert_int_equal(status, NOC_ERR_MEMORY);
    assert_int_equal(noc_stream_read(s, zeros, PIECE, &got), NOC_ERR_MEMORY); /* and stays so, said once */
    assert_int_equal(error_count, 1);
    assert_non_null(strstr(errors, "--max-expansion is 200 times"));
    assert_int_equal(noc_stream_rewind(s), NOC_OK);
    noc_stream_budget(s)->expansion = 0; /* any */
    uint64_t total = 0;
    for (got = 1; !status || got; total += got)
        if ((status = noc_stream_read(s, zeros, PIECE, &got)) || !got)
            break;
    assert_int_equal(status, NOC_OK);
    assert_int_equal(total, (uint64_t)PIECE * TIMES);
    noc_stream_close(s);
    noc_log_destroy(log);
    free(zeros);
    free(packed);
}

/* Three bytes of JSON are a list of 144. */
static void json_is_bounded(void **state) {
    FILE *f = create("lists.gltf");
    fputs("{\"asset\":{\"version\":\"2.0\"},\"extras\":[[]", f);
    for (int i = 0; i < 200000; i++)
        fputs(",[]", f);
    fputs("]}", f);
    fclose(f);
    refused("lists.gltf", 0.03, "its JSON would take");
    refused("lists.gltf", 0.03, "the limit --max-memory is 0.03 GB");
    allowed("lists.gltf", 0.1, 0);
    f = create("lists.json");
    fputs("{\"version\":0.6,\"generator\":\"x\",\"elements\":[{}", f);
    for (int i = 0; i < 100000; i++)
        fputs(",{}", f);
    fputs("]}", f);
    fclose(f);
    refused("lists.json", 0.02, "max-memory");
    allowed("lists.json", 0.1, 0);
}

/* A glTF whose nodes show one mesh of so many vertices, that lie in no buffer but for three of them. */
static void write_gltf(const char *name, int vertices, int nodes) {
    FILE *f = create(name);
    fprintf(
        f,
        "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":48,\"uri\":\"data:application/octet-stream;"
        "base64,AAAAAAEAAAACAAAAAAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA\"}],\"bufferViews\":[{\"buffer\":0,"
        "\"byteLength\":12},{\"buffer\":0,\"byteOffset\":12,\"byteLength\":36}],\"accessors\":[{\"componentType\":5126,"
        "\"type\":\"VEC3\",\"count\":%d,\"sparse\":{\"count\":3,\"indices\":{\"bufferView\":0,\"componentType\":5125},"
        "\"values\":{\"bufferView\":1}}}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"
        "\"nodes\":[{\"mesh\":0}",
        vertices);
    for (int i = 1; i < nodes; i++)
        fputs(",{\"mesh\":0}", f);
    fputs("]}", f);
    fclose(f);
}

static void gltf_copies_are_bounded(void **state) {
    write_gltf("copies.gltf", 999, 400);
    refused("copies.gltf", 0.005, "what its nodes and meshes ask for would take");
    allowed("copies.gltf", 0.05, 400);
}

/* What all nodes ask for is known before the first is read: of 3.8 GB nothing is taken. */
static void gltf_is_added_up_first(void **state) {
    write_gltf("zeros.gltf", 4000000, 40);
    refused("zeros.gltf", 0, "what its nodes and meshes ask for would take 3.84 GB, of a file of");
    assert_non_null(strstr(errors, "--max-expansion is 200 times"));
}

/* 101 instances of a template of 100,000 points: a file of .2 MB. */
static void instances_are_bounded(void **state) {
    enum { POINTS = 100000, INSTANCES = 101 };
    FILE *f = create("instances.json");
    fputs("{\"type\":\"CityJSON\",\"version\":\"1.1\",\"transform\":{\"scale\":[1,1,1],\"translate\":[0,0,0]},"
          "\"vertices\":[[0,0,0]],\"geometry-templates\":{\"vertices-templates\":[[0,0,0]],\"templates\":[{\"type\":"
          "\"MultiSurface\",\"lod\":\"1\",\"boundaries\":[[[0",
          f);
    for (int i = 1; i < POINTS; i++)
        fputs(",0", f);
    fputs("]]]}]},\"CityObjects\":{", f);
    for (int i = 0; i < INSTANCES; i++)
        fprintf(f,
                "%s\"o%d\":{\"type\":\"CityFurniture\",\"geometry\":[{\"type\":\"GeometryInstance\",\"template\":0,"
                "\"boundaries\":[0]}]}",
                i ? "," : "", i);
    fputs("}}", f);
    fclose(f);
    refused("instances.json", 0, "instances of its templates would place over 10 million points, of a file of 0.2");
    assert_non_null(strstr(errors, "the limit --max-instances is 5 a byte"));
    noc_log *log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_WARN, .message = on_message });
    noc_import_params params = noc_import_default_params();
    params.max_instances = 60; /* points a byte: 12 million */
    noc_report *report;
    assert_int_equal(noc_inspect(log, path_of("instances.json"), &params, &report), NOC_OK);
    noc_report_destroy(report);
    noc_log_destroy(log);
}

/* gzip that grows to 1.2 GB is refused once it looks strange, and not after a gigabyte of it. */
static void archives_are_measured(void **state) {
    enum { PIECE = 8 << 20, TIMES = 150 };
    unsigned char *rows = noc_alloc(PIECE), *packed = noc_alloc(PIECE);
    for (size_t i = 0; i < PIECE; i++)
        rows[i] = (unsigned char)"1.5,2.5,x\n"[i % 10];
    z_stream z = { .next_in = rows, .avail_in = PIECE, .next_out = packed, .avail_out = PIECE };
    assert_int_equal(deflateInit2(&z, 9, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY), Z_OK);
    assert_int_equal(deflate(&z, Z_FINISH), Z_STREAM_END);
    FILE *f = create("rows.csv.gz");
    for (int i = 0; i < TIMES; i++)
        assert_int_equal(fwrite(packed, 1, z.total_out, f), z.total_out);
    fclose(f);
    deflateEnd(&z);
    free(rows);
    free(packed);
    noc_log *log = noc_log_create(&(noc_log_params){ .message = on_message });
    noc_status status;
    noc_stream *s = noc_stream_open(path_of("rows.csv.gz"), log, &status);
    char *some = noc_alloc(1 << 16);
    error_count = 0;
    for (size_t got = 1; !status && got;)
        status = noc_stream_read(s, some, 1 << 16, &got);
    assert_int_equal(status, NOC_ERR_MEMORY);
    assert_int_equal(error_count, 1);
    assert_non_null(strstr(errors, "its content would take 1.07 GB"));
    assert_true(noc_stream_read_bytes(s) < 20 << 20); /* not after a gigabyte of them */
    noc_stream_close(s);
    s = noc_stream_open(path_of("rows.csv.gz"), log, &status);
    noc_stream_budget(s)->expansion = 2000; /* measured, found to be within it, and read */
    uint64_t total = 0;
    for (size_t got = 1; got; total += got)
        assert_int_equal(noc_stream_read(s, some, 1 << 16, &got), NOC_OK);
    assert_int_equal(total, (uint64_t)PIECE * TIMES);
    noc_stream_close(s);
    noc_log_destroy(log);
    free(some);
}

/* Lamps that wait, and what they and their poles become in the scene. */
static void lamps_are_bounded(void **state) {
    FILE *f = create("many.csv");
    fputs("x,y,lamp_type\n", f);
    for (int i = 0; i < 20000; i++)
        fprintf(f, "%d,%d,LED\n", 300000 + i % 150 * 30, 5600000 + i / 150 * 30);
    fclose(f);
    assert_int_equal(load("many.csv", 0.004), NOC_ERR_MEMORY);
    assert_non_null(strstr(errors, "many.csv: the scene with it would take"));
    assert_non_null(strstr(errors, "the limit --max-memory is 0.004 GB"));
    assert_int_equal(load("many.csv", 0.012), NOC_ERR_MEMORY); /* they can wait in that, but not stand */
    assert_int_equal(error_count, 1);
    assert_int_equal(load("many.csv", 1), NOC_OK);
}

/* A city's surfaces, and one object that is most of it. */
static void cities_are_bounded(void **state) {
    FILE *f = create("city.gml");
    fputs("<CityModel xmlns=\"http://www.opengis.net/citygml/2.0\" xmlns:gml=\"http://www.opengis.net/gml\""
          " xmlns:bldg=\"http://www.opengis.net/citygml/building/2.0\">",
          f);
    for (int i = 0; i < 2000; i++) {
        if (i < 1000 || i == 1000)
            fprintf(f, "<cityObjectMember><bldg:Building gml:id=\"b%d\">", i);
        for (int k = 0; k < 10; k++) {
            int x = 10 * i + k;
            fprintf(f,
                    "<bldg:lod1MultiSurface><gml:MultiSurface><gml:surfaceMember><gml:Polygon><gml:exterior>"
                    "<gml:LinearRing><gml:posList srsDimension=\"3\">%d 0 0 %d 1 0 %d 1 5 %d 0 5 %d 0 0</gml:posList>"
                    "</gml:LinearRing></gml:exterior></gml:Polygon></gml:surfaceMember></gml:MultiSurface>"
                    "</bldg:lod1MultiSurface>",
                    x, x, x, x, x);
        }
        if (i < 1000 || i == 1999)
            fputs("</bldg:Building></cityObjectMember>", f);
    }
    fputs("</CityModel>", f);
    fclose(f);
    refused("city.gml", 0.0005, "city.gml: the scene with it would take");
    refused("city.gml", 0.0018, "city.gml: an object (\"b1000\") would take");
    allowed("city.gml", 0.1, 40000);
}

/* What the parts of an object say of themselves counts as its surfaces do. */
static void attributes_are_bounded(void **state) {
    FILE *f = create("words.gml");
    fputs(
        "<CityModel xmlns='http://www.opengis.net/citygml/2.0' xmlns:gml='http://www.opengis.net/gml' "
        "xmlns:gen='http://www.opengis.net/citygml/generics/2.0' xmlns:b='http://www.opengis.net/citygml/building/2.0'>"
        "<cityObjectMember><b:Building gml:id='house'>",
        f);
    for (int i = 0; i < 400; i++) {
        fputs("<b:outerBuildingInstallation><b:BuildingInstallation>", f);
        for (int k = 0; k < 250; k++)
            fputs("<gen:stringAttribute name='a'><gen:value>1</gen:value></gen:stringAttribute>", f);
        fputs("</b:BuildingInstallation></b:outerBuildingInstallation>", f);
    }
    fputs("<b:lod1MultiSurface><gml:MultiSurface><gml:surfaceMember><gml:Polygon><gml:exterior><gml:LinearRing>"
          "<gml:posList>0 0 0 1 0 0 1 1 0 0 0 0</gml:posList></gml:LinearRing></gml:exterior></gml:Polygon>"
          "</gml:surfaceMember></gml:MultiSurface></b:lod1MultiSurface></b:Building></cityObjectMember></CityModel>",
          f);
    fclose(f);
    /* 100,000 of them take 2.4 MB beside their texts */
    refused("words.gml", 0.0045, "words.gml: an object (\"house\") would take");
    allowed("words.gml", 0.02, 1);
}

/* Fifty buildings of a kilobyte in all: each refers twice to all that the one before it shows. */
static void city_links_are_bounded(void **state) {
    FILE *f = create("links.gml");
    fputs(
        "<CityModel xmlns=\"http://www.opengis.net/citygml/2.0\" xmlns:gml=\"http://www.opengis.net/gml\" xmlns:xlink="
        "\"http://www.w3.org/1999/xlink\" xmlns:bldg=\"http://www.opengis.net/citygml/building/2.0\">",
        f);
    for (int i = 0; i <= 50; i++) {
        fprintf(
            f,
            "<cityObjectMember><bldg:Building gml:id=\"b%d\"><bldg:lod1MultiSurface><gml:MultiSurface gml:id=\"m%d\">",
            i, i);
        for (int k = 0; k < 2 && i; k++)
            fprintf(f, "<gml:surfaceMember xlink:href=\"#m%d\"/>", i - 1);
        if (!i)
            fputs("<gml:surfaceMember><gml:Polygon><gml:exterior><gml:LinearRing>"
                  "<gml:posList>0 0 0 1 0 0 1 1 0 0 0 0</gml:posList></gml:LinearRing></gml:exterior></gml:Polygon>"
                  "</gml:surfaceMember>",
                  f);
        fputs("</gml:MultiSurface></bldg:lod1MultiSurface></bldg:Building></cityObjectMember>", f);
    }
    fputs("</CityModel>", f);
    fclose(f);
    refused("links.gml", 0.01, "what xlinks lead to, of this object (\"b1");
    assert_non_null(strstr(errors, "the limit --max-memory is 0.01 GB"));
}

/* expat looks at a tag again with each piece of the file, until it ends. One just before the limit is read. */
static void city_tags_are_bounded(void **state) {
    for (int longer = 0; longer < 2; longer++) {
        FILE *f = create("tag.gml");
        fputs("<CityModel xmlns=\"http://www.opengis.net/citygml/2.0\" "
              "xmlns:bldg=\"http://www.opengis.net/citygml/building/2.0\">\n"
              "<cityObjectMember><bldg:Building name=\"",
              f);
        for (int i = 0; i < (4 << 20) + (longer ? 1 << 19 : -100); i++)
            fputc('x', f);
        fputs("\"/></cityObjectMember></CityModel>", f);
        fclose(f);
        noc_report_file file;
        assert_int_equal(inspect("tag.gml", 0, &file), longer ? NOC_ERR_FORMAT : NOC_OK);
        assert_int_equal(error_count, longer);
        assert_true(!longer || strstr(errors, "tag.gml:2: a tag or comment of more than 4 MB"));
    }
}

static void write_obj(const char *name, const char *library, int materials) {
    FILE *f = create(name);
    fprintf(f, "%sv 0 0 0\nv 1 0 0\nv 0 1 0\n", library);
    for (int i = 0; i < materials; i++)
        fprintf(f, "usemtl paint %d\nf 1 2 3\n", i);
    fclose(f);
}

/* A line of a material takes Assimp 36 kB: where a library defines it, as the others can be one. */
static void obj_materials_are_bounded(void **state) {
    enum { MATERIALS = 3000 };
    FILE *f = create("many.mtl");
    for (int i = 0; i < MATERIALS; i++)
        fprintf(f, "newmtl paint %d\n", i);
    fclose(f);
    write_obj("defined.obj", "mtllib many.mtl\n", MATERIALS);
    refused("defined.obj", 0.05, "its faces and materials would take");
    allowed("defined.obj", 0.5, MATERIALS);
    write_obj("undefined.obj", "", MATERIALS);
    allowed("undefined.obj", 0.05, MATERIALS);
}

/* A library that is named again and again is read once: Assimp would take the product of the two files' sizes. */
static void obj_libraries_are_read_once(void **state) {
    FILE *f = create("once.mtl");
    fputs("newmtl paint\n", f);
    fclose(f);
    char text[] = "mtllib once.mtl\nmtllib once.mtl \nmtllib other.mtl\nmtllib once.mtl\nv 0 0 0\n", place[300];
    snprintf(place, sizeof(place), "%s/", folder);
    obj_folder beside = { .path = place };
    import_budget all = { .memory = 1e9 };
    geo_issues *issues = geo_issues_create();
    obj_chunks chunks = { 0 };
    assert_true(obj_chunks_cut(&chunks, text, strlen(text), 1));
    assert_int_equal(obj_plain_materials(&chunks, &beside, NULL, &all, issues, "once.obj", NULL), NOC_OK);
    assert_string_equal(text, "mtllib once.mtl\n                \nmtllib other.mtl\n               \nv 0 0 0\n");
    obj_chunks_free(&chunks);
    free(beside.missing);
    geo_issues_destroy(issues);
}

/* An OBJ whose text itself is too large, and parameters that are none. */
static void limits_are_checked(void **state) {
    refused("undefined.obj", 0.00001, "its content would take");
    noc_report_file file;
    assert_int_equal(inspect("undefined.obj", -1, &file), NOC_ERR_ARGUMENT);
}

#if NOC_HAVE_GDAL
/* Lakes of a map that wait for the ground. */
static void areas_of_maps_are_bounded(void **state) {
    enum { LAKES = 8000, POINTS = 40 };
    FILE *f = create("lakes.osm");
    fputs("<osm version='0.6'>", f);
    for (int i = 0; i < POINTS; i++)
        fprintf(f, "<node id='%d' lat='%.6f' lon='%.6f'/>", i + 1, 48 + .01 * cos(2 * M_PI * i / POINTS),
                11 + .01 * sin(2 * M_PI * i / POINTS));
    for (int i = 1; i <= LAKES; i++) {
        fprintf(f, "<way id='%d'>", i);
        for (int k = 0; k <= POINTS; k++)
            fprintf(f, "<nd ref='%d'/>", k % POINTS + 1);
        fputs("<tag k='natural' v='water'/></way>", f);
    }
    fputs("</osm>", f);
    fclose(f);
    assert_int_equal(load("lakes.osm", 0.01), NOC_ERR_MEMORY);
    assert_int_equal(error_count, 1);
    assert_non_null(strstr(errors, "lakes.osm"));
    assert_non_null(strstr(errors, "the scene with it"));
    assert_int_not_equal(load("lakes.osm", 1), NOC_ERR_MEMORY);
}
#endif

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(compressed_data_is_bounded),
        cmocka_unit_test(json_is_bounded),
        cmocka_unit_test(gltf_copies_are_bounded),
        cmocka_unit_test(gltf_is_added_up_first),
        cmocka_unit_test(instances_are_bounded),
        cmocka_unit_test(archives_are_measured),
        cmocka_unit_test(lamps_are_bounded),
        cmocka_unit_test(cities_are_bounded),
        cmocka_unit_test(attributes_are_bounded),
        cmocka_unit_test(city_links_are_bounded),
        cmocka_unit_test(obj_materials_are_bounded),
        cmocka_unit_test(obj_libraries_are_read_once),
        cmocka_unit_test(city_tags_are_bounded),
        cmocka_unit_test(limits_are_checked),
#if NOC_HAVE_GDAL
        cmocka_unit_test(areas_of_maps_are_bounded),
#endif
    };
    return cmocka_run_group_tests_name("budgets", tests, set_up, tear_down);
}
