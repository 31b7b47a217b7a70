/* Inputs that stand for several files (folders, patterns, lists), and the part of them that a box takes. */
#include "test.h"

#include "import/load/load.h"
#include <nocturne/nocturne.h>

#include <sys/stat.h>

static char folder[] = "/tmp/noc-inputs-XXXXXX";
static noc_log *log_;
static char told[2000];

static void keep(void *user, noc_log_level level, const char *text) {
    size_t n = strlen(told);
    snprintf(told + n, sizeof(told) - n, "%s\n", text);
}

static const char *in_folder(const char *name) {
    static char paths[8][300];
    static int next;
    char *path = paths[next++ % 8];
    snprintf(path, sizeof(paths[0]), "%s%s%s", *name == '@' ? "@" : "", folder, *name == '@' ? name + 1 : name);
    return path;
}

static void write_file(const char *name, const char *text) {
    FILE *f = fopen(in_folder(name), "w");
    assert_non_null(f);
    fputs(text, f);
    fclose(f);
}

/* A square of an edge of 10 m at (x, y). */
static void write_house(const char *name, const char *id, int x, int y) {
    char text[600];
    snprintf(text, sizeof(text),
             "{\"type\":\"CityJSON\",\"version\":\"1.0\",\"metadata\":{\"referenceSystem\":\"EPSG:25832\"},"
             "\"CityObjects\":{\"%s\":{\"type\":\"Building\",\"geometry\":[{\"type\":\"MultiSurface\",\"lod\":1,"
             "\"boundaries\":[[[0,1,2,3]]]}]}},\"vertices\":[[%d,%d,5],[%d,%d,5],[%d,%d,5],[%d,%d,5]]}",
             id, 690000 + x, 5330000 + y, 690010 + x, 5330000 + y, 690010 + x, 5330010 + y, 690000 + x, 5330010 + y);
    write_file(name, text);
}

static int start(void **state) {
    assert_non_null(mkdtemp(folder));
    log_ = noc_log_create(&(noc_log_params){ .message = keep, .level = NOC_LOG_INFO });
    mkdir(in_folder("/city"), 0700);
    mkdir(in_folder("/city/b"), 0700);
    mkdir(in_folder("/none"), 0700);
    mkdir(in_folder("/strange"), 0700);
    write_house("/city/c.json", "c", 200, 0);
    write_house("/city/a.json", "a", 0, 0);
    write_house("/city/b/x.json", "x", 100, 0);
    write_house("/city/b/[1]*.json", "star", 300, 0);
    write_file("/city/notes.txt", "not a city\n");
    write_file("/city/.hidden.json", "{");
    write_file("/strange/notes.txt", "not a city\n");
    write_file("/list.txt", "\xef\xbb\xbf# two of them\r\n\r\n  city/c.json  \r\ncity/b/x*.json\n");
    write_file("/bad.txt", "city/a.json\n\ncity/gone.json\n");
    write_file("/blank.txt", "\n# nothing\n");
    write_file("/@name.json", "");
    write_house("/@name.json", "at", 0, 0);
    return 0;
}

static int finish(void **state) {
    char command[100];
    noc_log_destroy(log_);
    snprintf(command, sizeof(command), "rm -r %s", folder);
    return system(command);
}

/* Names of the files, in their order, without the folder's. */
static const char *files_of(const char *const *inputs, size_t count) {
    static char text[1000];
    expanded e = { 0 };
    *text = 0;
    assert_int_equal(expand_inputs(inputs, count, log_, &e), NOC_OK);
    for (size_t i = 0, n = 0; i < e.files.len; i++) {
        const char *path = e.files.data[i].path;
        n += (size_t)snprintf(text + n, sizeof(text) - n, "%s%s", i ? " " : "",
                              strncmp(path, folder, strlen(folder)) ? path : path + strlen(folder));
    }
    expanded_free(&e);
    return text;
}

static const char *one(const char *path) { return files_of(&path, 1); }

static void refused(const char *path, const char *part) {
    expanded e = { 0 };
    assert_true(expand_inputs(&path, 1, log_, &e) != NOC_OK);
    if (!strstr(noc_log_last_error(log_), part))
        fail_msg("\"%s\" does not say \"%s\"", noc_log_last_error(log_), part);
    expanded_free(&e);
}

/* A million of inputs, and of names in a folder. */
static void test_most_files(void **state) {
    (void)state;
    const size_t most = expand_most_files;
    assert_int_equal(most, 1000000);
    expanded e = { 0 };
    const char *path = folder;
    assert_int_equal(expand_inputs(&path, 1, log_, &e), NOC_OK);
    size_t count = e.files.len;
    expanded_free(&e);
    expand_most_files = count; /* as many as there are */
    assert_int_equal(expand_inputs(&path, 1, log_, &e), NOC_OK);
    expanded_free(&e);
    expand_most_files = count - 1;
    refused(folder, "inputs");
    refused(folder, "more than");
    expand_most_files = 1; /* in one folder */
    refused(folder, "more than 1 inputs");
    expand_most_files = most;
}

static void test_expansion(void **state) {
    assert_string_equal(one("builtin:city"), "builtin:city");
    assert_string_equal(one(in_folder("/gone.gml")), "/gone.gml"); /* who opens it says so */
    assert_string_equal(one(in_folder("/city")),
                        "/city/a.json /city/b/[1]*.json /city/b/x.json /city/c.json /city/notes.txt");
    assert_string_equal(one(in_folder("/city/b/")), "/city/b/[1]*.json /city/b/x.json");
    assert_string_equal(one(in_folder("/city/?.json")), "/city/a.json /city/c.json");
    assert_string_equal(one(in_folder("/c*")),
                        "/city/a.json /city/b/[1]*.json /city/b/x.json /city/c.json /city/notes.txt");
    assert_string_equal(one(in_folder("/city/b/[1]*.json")), "/city/b/[1]*.json"); /* a file of that name */
    assert_string_equal(one(in_folder("@/list.txt")), "/city/c.json /city/b/x.json");
    assert_string_equal(files_of((const char *const[]){ in_folder("/city/c.json"), in_folder("/city/a.json") }, 2),
                        "/city/c.json /city/a.json");
    refused(in_folder("/city/*.gml"), "/city/*.gml: no file is called so");
    refused(in_folder("/none"), "/none: no file is in this folder");
    refused(in_folder("@/bad.txt"), "/bad.txt:3: ");
    refused(in_folder("@/blank.txt"), "the list is empty");
    refused(in_folder("@/gone.txt"), "gone.txt");
    assert_int_equal(chdir(folder), 0);
    assert_string_equal(one("@name.json"), "@name.json"); /* a file of that name */
    assert_string_equal(one("@list.txt"), "city/c.json city/b/x.json");
}

static noc_status load(const char *path, const char *bbox, noc_scene_info *info, noc_report **report) {
    noc_scene *scene = noc_scene_create(log_);
    noc_import_params params = noc_import_default_params();
    params.bbox = bbox;
    params.infer_lamps = NOC_SWITCH_OFF;
    *told = 0;
    noc_status status = noc_scene_load(scene, &path, 1, &params, report);
    if (!status)
        noc_scene_get_info(scene, info);
    noc_scene_destroy(scene);
    return status;
}

/* A TIFF of three samples a pixel, in either order of bytes, is a texture of what lies beside it; one of a single
 * sample may be terrain. */
static void test_pictures(void **state) {
    static const unsigned char little[] = { 'I', 'I', 42, 0, 8, 0, 0, 0, 1, 0, 0x15, 1, 3, 0, 1, 0, 0, 0, 3, 0, 0, 0 },
                               big[] = { 'M', 'M', 0, 42, 0, 0, 0, 8, 0, 1, 1, 0x15, 0, 3, 0, 0, 0, 1, 0, 3, 0, 0 };
    unsigned char single[sizeof(little)];
    memcpy(single, little, sizeof(little));
    single[18] = 1;
    const unsigned char *const bytes[] = { little, big, single };
    noc_report *report;
    noc_scene_info info;
    (void)state;
    mkdir(in_folder("/textured"), 0700);
    write_house("/textured/a.json", "a", 0, 0);
    for (int i = 0; i < 3; i++) {
        FILE *f = fopen(in_folder("/textured/wall.tif"), "wb");
        assert_non_null(f);
        assert_int_equal(fwrite(bytes[i], 1, sizeof(little), f), sizeof(little));
        assert_int_equal(fclose(f), 0);
        noc_status status = load(in_folder("/textured"), NULL, &info, &report);
        assert_true((status == NOC_OK) == (i < 2));
        assert_true((strstr(told, "1 of 2 files of the folder are in no format that is read, and left out: wall.tif") !=
                     NULL) == (i < 2));
        noc_report_destroy(report);
    }
}

static void test_folder(void **state) {
    noc_report *report;
    noc_scene_info info;
    assert_int_equal(load(in_folder("/city"), NULL, &info, &report), NOC_OK);
    assert_non_null(strstr(told, "/city: 1 of 5 files of the folder are in no format that is read, and left out: "
                                 "notes.txt"));
    assert_int_equal(noc_report_file_count(report), 4);
    assert_string_equal(noc_report_get_file(report, 0)->path, in_folder("/city/a.json"));
    noc_report_destroy(report);
    assert_int_equal(load(in_folder("/strange"), NULL, &info, &report), NOC_ERR_FORMAT);
    assert_non_null(strstr(told, "no file of this folder is in a format that is read (notes.txt)"));
    noc_report_destroy(report);
}

static size_t spared(const noc_report *report) {
    size_t count = 0;
    for (size_t i = 0; i < noc_report_file_count(report); i++) {
        const noc_report_file *file = noc_report_get_file(report, i);
        for (size_t k = 0; k < file->line_count; k++)
            if (!strcmp(file->lines[k].reason, "object outside of --bbox") && file->lines[k].lossless)
                count += file->lines[k].count;
    }
    return count;
}

static size_t houses(const char *bbox, size_t *left) {
    noc_report *report;
    noc_scene_info info;
    size_t count = 0;
    noc_status status = load(in_folder("/city"), bbox, &info, &report);
    if (status)
        fail_msg("%s: %s", bbox, noc_log_last_error(log_));
    for (size_t i = 0; i < noc_report_file_count(report); i++)
        count += noc_report_get_file(report, i)->buildings;
    *left = spared(report);
    noc_report_destroy(report);
    return count;
}

static void test_box(void **state) {
    size_t left;
    assert_int_equal(houses("690000,5330000,690400,5330001", &left), 4);
    assert_int_equal(left, 0);
    assert_int_equal(houses("690005, 5330002, 690120, 5330003", &left), 2); /* a and x: they meet it */
    assert_int_equal(left, 2);
    /* a alone, in degrees */
    assert_int_equal(houses("11.5518,48.0948,11.5525,48.0952,EPSG:4326", &left), 1);
    assert_int_equal(left, 3);
    noc_report *report;
    noc_scene_info info;
    static const struct {
        const char *bbox, *part;
    } bad[] = { { "1,2,3,4", "bbox: nothing of the inputs lies in 1,2,3,4 of EPSG:25832" },
                { "1,2,3", "is not X0,Y0,X1,Y1" },
                { "1,2,3,4,", "is not X0,Y0,X1,Y1" },
                { "1,2,x,4", "is not X0,Y0,X1,Y1" },
                { "5,2,3,4", "X0 is 5 and X1 3" },
                { "1,2,3,2", "Y0 is 2 and Y1 2" },
                { "1,2,3,4,EPSG:1", "--bbox" } };
    for (size_t i = 0; i < NOC_COUNT(bad); i++) {
        assert_int_equal(load(in_folder("/city"), bad[i].bbox, &info, &report), NOC_ERR_ARGUMENT);
        noc_report_destroy(report);
        if (!strstr(noc_log_last_error(log_), bad[i].part))
            fail_msg("\"%s\" does not say \"%s\"", noc_log_last_error(log_), bad[i].part);
    }
}

/* Of a terrain the triangles that meet the box, and lamps within it. */
static void test_terrain_and_lamps(void **state) {
    write_file("/tin.json",
               "{\"type\":\"CityJSON\",\"version\":\"1.0\",\"metadata\":{\"referenceSystem\":\"EPSG:25832\"},"
               "\"CityObjects\":{\"t\":{\"type\":\"TINRelief\",\"geometry\":[{\"type\":"
               "\"CompositeSurface\",\"lod\":1,\"boundaries\":[[[0,1,2]],[[3,4,5]]]}]},"
               "\"in\":{\"type\":\"CityFurniture\",\"attributes\":{\"function\":\"1150\"},\"geometry\":["
               "{\"type\":\"MultiPoint\",\"lod\":1,\"boundaries\":[0]}]},"
               "\"out\":{\"type\":\"CityFurniture\",\"attributes\":{\"function\":\"1150\"},\"geometry\":["
               "{\"type\":\"MultiPoint\",\"lod\":1,\"boundaries\":[3]}]}},\"vertices\":["
               "[690000,5330000,5],[690010,5330000,5],[690000,5330010,5],[690500,5330000,5],"
               "[690510,5330000,5],[690500,5330010,5]]}");
    noc_report *report;
    noc_scene_info info;
    assert_int_equal(load(in_folder("/tin.json"), NULL, &info, &report), NOC_OK);
    size_t whole = info.triangles_by_class[NOC_CLASS_TERRAIN];
    assert_int_equal(noc_report_get_file(report, 0)->lamps, 2);
    noc_report_destroy(report);
    assert_int_equal(whole, 2);
    assert_int_equal(load(in_folder("/tin.json"), "690000,5329990,690020,5330020", &info, &report), NOC_OK);
    assert_int_equal(info.triangles_by_class[NOC_CLASS_TERRAIN], 1);
    assert_int_equal(noc_report_get_file(report, 0)->lamps, 1);
    noc_report_destroy(report);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_expansion), cmocka_unit_test(test_most_files), cmocka_unit_test(test_folder),
        cmocka_unit_test(test_pictures),  cmocka_unit_test(test_box),        cmocka_unit_test(test_terrain_and_lamps),
    };
    return cmocka_run_group_tests_name("import/inputs", tests, start, finish);
}
