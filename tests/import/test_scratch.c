/* Temporary folders: why there is none, and how large the copies of maps in them become. */
#include "../test.h"
#include "import/map/parts.h"

#include <errno.h>
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>

static char error[500];

static void on_message(void *user, noc_log_level level, const char *text) {
    snprintf(error, sizeof(error), "%s", text);
}

static void without_files_to_open(void **state) {
    noc_log *log = noc_log_create(&(noc_log_params){ .message = on_message });
    scratch_folder folder;
    struct rlimit before, none;
    int next = dup(0);
    close(next);
    assert_int_equal(getrlimit(RLIMIT_NOFILE, &before), 0);
    none = (struct rlimit){ (rlim_t)next, before.rlim_max };
    assert_int_equal(setrlimit(RLIMIT_NOFILE, &none), 0);
    noc_status status = scratch_make(&folder, "map.gpkg", log);
    assert_int_equal(setrlimit(RLIMIT_NOFILE, &before), 0);
    assert_int_equal(status, NOC_ERR_IO);
    assert_non_null(strstr(error, "map.gpkg: no temporary folder in "));
    assert_non_null(strstr(error, strerror(EMFILE)));
    assert_int_equal(scratch_make(&folder, "map.gpkg", log), NOC_OK);
    scratch_remove(&folder);
    noc_log_destroy(log);
}

static void write_at(const char *path, off_t at, const char *text) {
    int fd = open(path, O_RDWR | O_CREAT, 0600);
    assert_true(fd >= 0);
    assert_int_equal(pwrite(fd, text, strlen(text), at), strlen(text));
    close(fd);
}

/* A GeoPackage of 64 MB that are holes but for its ends, with a log. */
static void holes_are_not_copied(void **state) {
    enum { SIZE = 64 << 20 };
    char place[] = "/tmp/noc-holes-XXXXXX", map[100], wal[100], copy[500], end[6] = "";
    assert_non_null(mkdtemp(place));
    snprintf(map, sizeof(map), "%s/map.gpkg", place);
    snprintf(wal, sizeof(wal), "%s/map.gpkg-wal", place);
    write_at(map, 0, "begin");
    write_at(map, SIZE - 5, "ended");
    write_at(wal, 0, "changes");
    noc_log *log = noc_log_create(&(noc_log_params){ .message = on_message });
    scratch_folder folder;
    struct stat is, was;
    assert_int_equal(map_copy_geopackage(map, false, &(import_budget){ .memory = 2 * SIZE }, NULL, log, &folder),
                     NOC_OK);
    snprintf(copy, sizeof(copy), "%s/" MAP_COPY_NAME, folder.path);
    assert_int_equal(stat(map, &was) | stat(copy, &is), 0);
    assert_int_equal(is.st_size, SIZE);
    assert_in_range(is.st_blocks, 1, was.st_blocks + 64);
    int fd = open(copy, O_RDONLY);
    assert_int_equal(pread(fd, end, 5, SIZE - 5), 5);
    close(fd);
    assert_string_equal(end, "ended");
    scratch_remove(&folder);
    assert_int_equal(map_copy_geopackage(map, false, &(import_budget){ .memory = 100 }, NULL, log, &folder),
                     NOC_ERR_MEMORY);
    assert_non_null(strstr(error, "map.gpkg: its copy, which its log needs, would take"));
    assert_non_null(strstr(error, "the limit --max-memory is"));
    scratch_remove(&folder);
    noc_log_destroy(log);
    assert_int_equal(unlink(map) | unlink(wal) | rmdir(place), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(without_files_to_open),
                                        cmocka_unit_test(holes_are_not_copied) };
    return cmocka_run_group_tests_name("import/scratch", tests, NULL, NULL);
}
