/* PLY: text and both orders of bytes, in double precision, with what else elements hold, and what is broken. */
#include "test.h"

#include "import/import.h"
#include "scene/scene.h"

#include <math.h>

static char path[] = "/tmp/noc-ply-XXXXXX";
static noc_log *log_;
static geo_issues *issues;
static noc_scene *scene;
static double placed[3 * 64];
static size_t placed_count;
static const char *format;

static noc_status keep(void *ctx, double *xyz, size_t count) {
    placed_count = count;
    memcpy(placed, xyz, NOC_MIN(count, (size_t)64) * 3 * sizeof(double));
    for (size_t i = 0; i < 3 * count; i++)
        xyz[i] -= placed[i % 3];
    return NOC_OK;
}

static noc_status read_bytes(const void *data, size_t size) {
    FILE *f = fopen(path, "wb");
    assert_int_equal(fwrite(data, 1, size, f), size);
    fclose(f);
    geo_issues_destroy(issues);
    noc_scene_destroy(scene);
    issues = geo_issues_create();
    scene = noc_scene_create(log_);
    noc_import_params params = noc_import_default_params();
    noc_stream *stream = noc_stream_open(path, log_, NULL);
    noc_status status =
        noc_reader_ply.read_mesh(path, stream, &params, scene, &(mesh_place){ NULL, keep }, issues, &format);
    noc_stream_close(stream);
    return status;
}

static void refuse(const char *text, const char *part) {
    assert_int_equal(read_bytes(text, strlen(text)), NOC_ERR_FORMAT);
    if (!strstr(noc_log_last_error(log_), part))
        fail_msg("\"%s\" does not say \"%s\"", noc_log_last_error(log_), part);
}

#define HEAD(kind, vertices, faces)                                                                                    \
    "ply\nformat " kind " 1.0\ncomment by hand\nelement vertex " vertices                                              \
    "\nproperty double x\nproperty double y\nproperty double z\nproperty uchar red\nelement face " faces               \
    "\nproperty uchar flags\nproperty list uchar int vertex_indices\nelement edge 1\nproperty int a\nend_header\n"

static void test_text(void **state) {
    static const char text[] = HEAD("ascii", "5", "4") "690000.125 5330000 500 255\n690010.125 5330000 500 0\n"
                                                       "690010.125 5330010 500 0\n690000.125 5330010 500 0\nnan 0 0 1\n"
                                                       "0 4 0 1 2 3\n7 3 0 1 2\n0 2 0 1\n0 3 0 1 9\n3\n";
    assert_int_equal(read_bytes(text, sizeof(text) - 1), NOC_OK);
    assert_string_equal(format, "PLY (text)");
    assert_float_equal(placed[0], 690000.125, 0); /* no float holds it */
    assert_float_equal(placed[2], 500, 0);
    assert_int_equal(scene->indices.len, 3 * 3);
    const char *reason, *examples;
    bool repaired;
    size_t count;
    assert_true(geo_issues_get(issues, 0, &reason, &repaired, &count, &examples));
    assert_string_equal(reason, "face with fewer than three corners, or with one that is not there");
    assert_int_equal(count, 2);
}

static size_t put(unsigned char *to, const void *value, size_t size, bool big) {
    for (size_t i = 0; i < size; i++)
        to[i] = ((const unsigned char *)value)[big ? size - 1 - i : i];
    return size;
}

static void test_binary(void **state) {
    for (int big = 0; big < 2; big++) {
        unsigned char data[2000];
        int n = sprintf((char *)data, "%s",
                        big ? HEAD("binary_big_endian", "4", "1") : HEAD("binary_little_endian", "4", "1"));
        size_t size = (size_t)n;
        const double corners[4][3] = { { 690000.125, 5, 1 }, { 690004, 5, 1 }, { 690004, 9, 1 }, { 690000.125, 9, 1 } };
        for (size_t i = 0; i < 4; i++) {
            for (size_t k = 0; k < 3; k++)
                size += put(data + size, &corners[i][k], 8, big);
            data[size++] = 7;
        }
        data[size++] = 1; /* flags */
        data[size++] = 4;
        for (int32_t i = 0; i < 4; i++)
            size += put(data + size, &i, 4, big);
        size += put(data + size, &n, 4, big);
        assert_int_equal(read_bytes(data, size), NOC_OK);
        assert_string_equal(format, big ? "PLY (big-endian)" : "PLY (little-endian)");
        assert_float_equal(placed[0], 690000.125, 0);
        assert_float_equal(placed[10], 9, 0);
        assert_int_equal(scene->indices.len, 6);
        for (size_t cut = (size_t)n; cut < size; cut += 5) { /* anywhere behind the header */
            assert_int_equal(read_bytes(data, cut), NOC_ERR_FORMAT);
            assert_non_null(strstr(noc_log_last_error(log_), "too early"));
        }
    }
}

static void test_broken(void **state) {
    refuse("ply\nformat ascii 1.0\nelement vertex 1\n", "ends in its header");
    refuse("ply\nformat morse 1.0\nend_header\n", "format that is not known");
    refuse("ply\nelement vertex 0\nend_header\n", "no format");
    refuse("ply\nformat ascii 1.0\nproperty float x\nend_header\n", "before the first element");
    refuse("ply\nformat ascii 1.0\nelement vertex -1\nend_header\n", "element that is not understood");
    refuse("ply\nformat ascii 1.0\nelement vertex 1\nproperty quad x\nend_header\n", "type that is not known");
    refuse("ply\nformat ascii 1.0\nwhatever\nend_header\n", "line of the header");
    refuse("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
           "end_header\n1 2 3\n4 5 6\n",
           "too early");
    refuse("ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_index\nend_header\n-4 1 2 3\n",
           "length that is none");
    refuse("ply\nformat ascii 1.0\nelement vertex 99999999999\nproperty float x\nend_header\n1\n", "more vertices");
    /* an element without properties takes no time, however many there are */
    static const char none[] = "ply\nformat ascii 1.0\nelement nothing 99999999999\nend_header\n";
    assert_int_equal(read_bytes(none, sizeof(none) - 1), NOC_OK);
    assert_int_equal(scene->indices.len, 0);
}

/* An element has 64 properties at most. */
static void test_most_properties(void **state) {
    (void)state;
    for (int count = 64; count < 66; count++) {
        char text[4000];
        size_t n = (size_t)snprintf(text, sizeof(text), "ply\nformat ascii 1.0\nelement vertex 0\n");
        for (int i = 0; i < count; i++)
            n += (size_t)snprintf(text + n, sizeof(text) - n, "property float p%d\n", i);
        snprintf(text + n, sizeof(text) - n, "end_header\n");
        if (count == 64)
            assert_int_equal(read_bytes(text, strlen(text)), NOC_OK);
        else
            refuse(text, "a property that is not understood, or too many of them");
    }
}

static void test_probe(void **state) {
    static const char yes[] = "ply\r\nformat ascii 1.0\r\n", no[] = "plywood\nformat ";
    assert_true(noc_reader_ply.probe(yes, strlen(yes)));
    assert_false(noc_reader_ply.probe(no, strlen(no)));
    assert_false(noc_reader_ply.probe("", 0));
}

static int start(void **state) {
    close(mkstemp(path));
    log_ = noc_log_create(NULL);
    return 0;
}

static int finish(void **state) {
    geo_issues_destroy(issues);
    noc_scene_destroy(scene);
    noc_log_destroy(log_);
    return unlink(path);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_text),   cmocka_unit_test(test_binary),
        cmocka_unit_test(test_broken), cmocka_unit_test(test_most_properties),
        cmocka_unit_test(test_probe),
    };
    return cmocka_run_group_tests_name("import/ply", tests, start, finish);
}
