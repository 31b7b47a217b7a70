/* Streams: plain, gzip, zip; whole, cut, damaged. */
#include "test.h"

#include "import/import.h"

#include <sys/stat.h>
#include <zip.h>
#include <zlib.h>

static char dir[] = "/tmp/noc-stream-XXXXXX";
static noc_log *log_;
static int warnings;

static void count_message(void *user, noc_log_level level, const char *text) {
    (void)user;
    (void)text;
    warnings += level == NOC_LOG_WARN;
}

static int set_up(void **state) {
    (void)state;
    log_ = noc_log_create(&(noc_log_params){ .level = NOC_LOG_WARN, .message = count_message });
    return mkdtemp(dir) ? 0 : -1;
}

static int tear_down(void **state) {
    (void)state;
    char *command = noc_format("rm -r %s", dir);
    int rc = system(command);
    free(command);
    noc_log_destroy(log_);
    return rc;
}

static const char *path_of(const char *name) {
    static char path[256];
    snprintf(path, sizeof(path), "%s/%s", dir, name);
    return path;
}

static const char *write_file(const char *name, const void *data, size_t size) {
    const char *path = path_of(name);
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    assert_int_equal(fwrite(data, 1, size, f), size);
    fclose(f);
    return path;
}

/* 100 kB that compress, but not to nothing. */
static char *sample(size_t *size) {
    *size = 100000;
    char *text = noc_alloc(*size);
    uint32_t x = 1;
    for (size_t i = 0; i < *size; i++) {
        x = x * 1664525u + 1013904223u;
        text[i] = (char)('a' + (x >> 24) % 23);
    }
    return text;
}

static size_t gzip(const char *text, size_t size, unsigned char *out, size_t room) {
    z_stream z = { 0 };
    assert_int_equal(deflateInit2(&z, 9, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY), Z_OK);
    z.next_in = (unsigned char *)(uintptr_t)text;
    z.avail_in = (uInt)size;
    z.next_out = out;
    z.avail_out = (uInt)room;
    assert_int_equal(deflate(&z, Z_FINISH), Z_STREAM_END);
    deflateEnd(&z);
    return z.total_out;
}

/* Reads to the end in pieces of `piece` bytes. */
static noc_status read_all(noc_stream *s, size_t piece, char *out, size_t room, size_t *total) {
    *total = 0;
    for (;;) {
        size_t got;
        noc_status status = noc_stream_read(s, out + *total, NOC_MIN(piece, room - *total), &got);
        if (status || !got)
            return status;
        *total += got;
    }
}

static void expect_content(const char *path, const char *text, size_t size) {
    char *out = noc_alloc(size + 1);
    noc_stream *s = noc_stream_open(path, log_, NULL);
    assert_non_null(s);
    const size_t pieces[] = { size + 1, 1000, 7 };
    for (size_t i = 0; i < NOC_COUNT(pieces); i++) { /* the second and third time after a rewind */
        size_t total;
        assert_int_equal(read_all(s, pieces[i], out, size + 1, &total), NOC_OK);
        assert_int_equal(total, size);
        assert_memory_equal(out, text, size);
        assert_int_equal(noc_stream_read_bytes(s), size);
        assert_float_equal(noc_stream_progress(s), 1, 1e-3);
        assert_int_equal(noc_stream_rewind(s), NOC_OK);
        assert_int_equal(noc_stream_read_bytes(s), size); /* that it was read so far stays true */
    }
    noc_stream_close(s);
    free(out);
}

static noc_status drain(const char *path) {
    static char out[1 << 18];
    noc_stream *s = noc_stream_open(path, log_, NULL);
    if (!s)
        return NOC_ERR_FORMAT;
    size_t total;
    noc_status status = read_all(s, 5000, out, sizeof(out), &total);
    if (status) { /* a broken stream stays broken */
        size_t got;
        assert_int_equal(noc_stream_read(s, out, 10, &got), status);
        assert_int_equal(got, 0);
    }
    noc_stream_close(s);
    return status;
}

static void test_plain(void **state) {
    (void)state;
    size_t size;
    char *text = sample(&size);
    expect_content(write_file("plain.bin", text, size), text, size);
    expect_content(write_file("one", "P", 1), "P", 1);
    noc_stream *s = noc_stream_open(path_of("one"), log_, NULL);
    assert_int_equal(noc_stream_size(s), 1);
    assert_string_equal(noc_stream_name(s), path_of("one"));
    noc_stream_close(s);
    free(text);
}

static void test_refused(void **state) {
    (void)state;
    assert_null(noc_stream_open(write_file("empty", "", 0), log_, NULL));
    assert_non_null(strstr(noc_log_last_error(log_), "empty file"));
    assert_null(noc_stream_open(dir, log_, NULL));
    assert_non_null(strstr(noc_log_last_error(log_), "directory"));
    assert_null(noc_stream_open(path_of("absent"), log_, NULL));
    assert_non_null(strstr(noc_log_last_error(log_), "absent"));
    assert_int_equal(mkfifo(path_of("fifo"), 0600), 0);
    assert_null(noc_stream_open(path_of("fifo"), log_, NULL)); /* and does not wait for a writer */
    noc_stream_close(NULL);
}

static void test_gzip(void **state) {
    (void)state;
    size_t size;
    char *text = sample(&size);
    unsigned char *packed = noc_alloc(2 * size);
    size_t n = gzip(text, size, packed, 2 * size);
    expect_content(write_file("named-wrongly.txt", packed, n), text, size);

    /* Members one after the other, the second one empty. */
    n = gzip(text, 60000, packed, 2 * size);
    n += gzip("", 0, packed + n, 2 * size - n);
    n += gzip(text + 60000, size - 60000, packed + n, 2 * size - n);
    expect_content(write_file("members.gz", packed, n), text, size);

    warnings = 0;
    memcpy(packed + n, "garbage", 7);
    expect_content(write_file("trailing.gz", packed, n + 7), text, size);
    assert_int_equal(warnings, 0); /* the caller says it, once, however often the file is read */
    noc_stream *s = noc_stream_open(path_of("trailing.gz"), log_, NULL);
    char *out = noc_alloc(size + 1);
    size_t total;
    assert_int_equal(read_all(s, 1000, out, size + 1, &total), NOC_OK);
    assert_true(noc_stream_trailing(s));
    noc_stream_close(s);
    free(out);
    free(packed);
    free(text);
}

static void test_gzip_damaged(void **state) {
    (void)state;
    char text[3000];
    for (size_t i = 0; i < sizeof(text); i++)
        text[i] = (char)('a' + i * i % 26);
    unsigned char packed[4000];
    size_t n = gzip(text, sizeof(text), packed, sizeof(packed));
    assert_int_equal(drain(write_file("whole.gz", packed, n)), NOC_OK);
    for (size_t cut = 2; cut < n; cut++) { /* the first two bytes are what makes it a gzip file */
        assert_int_equal(drain(write_file("cut.gz", packed, cut)), NOC_ERR_FORMAT);
        assert_non_null(strstr(noc_log_last_error(log_), "truncated"));
    }
    packed[n - 5] ^= 1; /* the checksum */
    assert_int_equal(drain(write_file("crc.gz", packed, n)), NOC_ERR_FORMAT);
}

typedef struct member {
    const char *name, *text;
} member;

static const char *make_zip(const char *name, const member *members, size_t count) {
    const char *path = path_of(name);
    int error;
    zip_t *zip = zip_open(path, ZIP_CREATE | ZIP_TRUNCATE, &error);
    assert_non_null(zip);
    for (size_t i = 0; i < count; i++) {
        if (!members[i].text) {
            assert_true(zip_dir_add(zip, members[i].name, 0) >= 0);
            continue;
        }
        zip_source_t *source = zip_source_buffer(zip, members[i].text, strlen(members[i].text), 0);
        assert_true(zip_file_add(zip, members[i].name, source, 0) >= 0);
    }
    assert_int_equal(zip_close(zip), 0);
    return path;
}

static void expect_member(const char *path, const char *name, const char *text) {
    noc_stream *s = noc_stream_open(path, log_, NULL);
    assert_non_null(s);
    const char *bang = strchr(noc_stream_name(s), '!');
    assert_non_null(bang);
    assert_string_equal(bang + 1, name);
    noc_stream_close(s);
    expect_content(path, text, strlen(text));
}

static void test_zip(void **state) {
    (void)state;
    const member model[] = { { "data", NULL },
                             { "readme.txt", "read me" },
                             { "__MACOSX/._city.gml", "shadow" },
                             { "data/city.GML", "<CityModel/>" },
                             { "other.xml", "<x/>" } };
    expect_member(make_zip("model.zip", model, NOC_COUNT(model)), "data/city.GML", "<CityModel/>");
    /* metadata before the model; then a tile among tiles */
    const member metadata[] = { { "metadata.xml", "<meta/>" }, { "a.json", "{}" }, { "tile.gml", "<CityModel/>" } };
    expect_member(make_zip("metadata.zip", metadata, NOC_COUNT(metadata)), "tile.gml", "<CityModel/>");
    const member tiles[] = { { "m.xml", "<m/>" }, { "1.gml", "<A/>" }, { "2.gml", "<B/>" }, { "3.obj", "v" } };
    expect_member(make_zip("tiles.zip", tiles, NOC_COUNT(tiles)), "1.gml", "<A/>");
    noc_stream *s = noc_stream_open(path_of("tiles.zip"), log_, NULL);
    assert_int_equal(noc_stream_unread(s), 2);
    noc_stream_close(s);
    s = noc_stream_open(path_of("metadata.zip"), log_, NULL);
    assert_int_equal(noc_stream_unread(s), 0);
    noc_stream_close(s);
    const member unknown[] = { { "d", NULL }, { "first.dat", "one" }, { "second.dat", "two" } };
    expect_member(make_zip("unknown.zip", unknown, NOC_COUNT(unknown)), "first.dat", "one");
    const member none[] = { { "d", NULL } };
    assert_null(noc_stream_open(make_zip("none.zip", none, 1), log_, NULL));
    assert_non_null(strstr(noc_log_last_error(log_), "without a file"));
}

static void test_zip_damaged(void **state) {
    (void)state;
    size_t size;
    char *text = sample(&size);
    text[3000] = 0;
    const member one[] = { { "city.gml", text } };
    const char *path = make_zip("good.zip", one, 1);
    FILE *f = fopen(path, "rb");
    unsigned char bytes[8000];
    size_t n = fread(bytes, 1, sizeof(bytes), f);
    fclose(f);
    assert_true(n > 500 && n < sizeof(bytes));
    for (size_t cut = 4; cut < n; cut += cut < n - 120 ? 37 : 1)
        assert_int_equal(drain(write_file("cut.zip", bytes, cut)), NOC_ERR_FORMAT);
    bytes[300] ^= 0x55;
    assert_int_equal(drain(write_file("bad.zip", bytes, n)), NOC_ERR_FORMAT);
    free(text);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_plain),        cmocka_unit_test(test_refused), cmocka_unit_test(test_gzip),
        cmocka_unit_test(test_gzip_damaged), cmocka_unit_test(test_zip),     cmocka_unit_test(test_zip_damaged),
    };
    return cmocka_run_group_tests_name("import/stream", tests, set_up, tear_down);
}
