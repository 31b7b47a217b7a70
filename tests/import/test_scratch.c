/* Temporary folders: why there is none. */
#include "../test.h"
#include "import/scratch.h"

#include <errno.h>
#include <sys/resource.h>

static char error[500];

static void on_message(void *user, noc_log_level level, const char *text) { snprintf(error, sizeof(error), "%s", text); }

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

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(without_files_to_open) };
    return cmocka_run_group_tests_name("import/scratch", tests, NULL, NULL);
}
