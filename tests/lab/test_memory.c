/* Memory that is refused to the laboratory, allocation by allocation: a status, one message, and what an interrupted
 * run left is gone on with. */
#include "../memory.h"

#include <nocturne/nocturne.h>

#define HEAD                                                                                                           \
    "{ \"scene\": { \"name\": \"one\", \"inputs\": [\"%s/tests/cli/city.gml\"] },"                                     \
    "  \"cameras\": [ { \"name\": \"up\", \"eye\": [20, -20, 30], \"target\": [0, 0, 0] } ],"
#define TAIL                                                                                                           \
    "  \"size\": \"8x6\", \"frames\": 2, \"repetitions\": 1, \"reference\": { \"rays\": 1, \"frames\": 2 },"           \
    "  \"configurations\": [ { \"name\": \"ris, *\", \"method\": \"ris\","                                             \
    "                          \"candidates\": [\"uniform\", \"power\"] } ] }"

static char folder[] = "/tmp/nocturne-lab-memory-XXXXXX", text[2000];

static int make_folder(void **state) {
    const char *source = getenv("NOC_SOURCE");
    (void)state;
    snprintf(text, sizeof(text), HEAD TAIL, source ? source : ".");
    return !mkdtemp(folder);
}

static void clear(void) {
    char command[200];
    snprintf(command, sizeof(command), "rm -rf '%s'/* '%s'/.lock", folder, folder);
    assert_int_equal(system(command), 0);
}

static int remove_folder(void **state) {
    (void)state;
    clear();
    return rmdir(folder);
}

static void test_spec(void **state) {
    (void)state;
    noc_log *log = counting_log();
    noc_lab_spec *spec;
    bool reached;
    FOR_EACH_REFUSAL(reached) {
        begin_refusal(n, later);
        noc_status status = noc_lab_spec_parse(text, "a.json", &spec, log);
        reached = end_refusal();
        if (status)
            assert_refused(status, "spec");
        else
            assert_unharmed(spec, "spec");
        assert_true(!spec == (status != NOC_OK) && (status == NOC_OK || reached));
        noc_lab_spec_destroy(spec);
    }
    noc_log_destroy(log);
}

/* All of it: create, run, report. */
static noc_status work(const noc_lab_spec *spec, noc_log *log, size_t *rows) {
    char cache[100];
    noc_lab *lab;
    noc_lab_state told;
    snprintf(cache, sizeof(cache), "%s/cache", folder);
    noc_lab_params params = { .folder = folder, .cache = cache, .device.threads = 1 };
    noc_status status = noc_lab_create(spec, &params, &lab, log);
    status = status ? status : noc_lab_run(lab);
    status = status ? status : noc_lab_write_report(lab);
    noc_lab_get_state(lab, &told);
    *rows = told.rows;
    noc_lab_destroy(lab);
    return status;
}

/* The same by two parts, one after the other. */
static noc_status work_parts(const noc_lab_spec *spec, noc_log *log, size_t *rows) {
    char cache[100];
    noc_lab *lab;
    noc_lab_state told;
    noc_status status = NOC_OK;
    bool joined = false;
    snprintf(cache, sizeof(cache), "%s/cache", folder);
    *rows = 0;
    for (int part = 1; part <= 2 && !status; part++) {
        noc_lab_params params = { folder, cache, part, 2, .device.threads = 1 };
        status = noc_lab_create(spec, &params, &lab, log);
        status = status ? status : noc_lab_run(lab);
        noc_lab_get_state(lab, &told);
        *rows += told.rows;
        noc_lab_destroy(lab);
        status = status ? status : noc_lab_join(spec, &params, &joined, log);
        assert_true(!joined || !status);
    }
    assert_true(joined || status);
    return status;
}

static void run_refused(noc_status (*run)(const noc_lab_spec *, noc_log *, size_t *)) {
    noc_log *log = counting_log();
    noc_lab_spec *spec;
    size_t whole, rows;
    bool reached;
    assert_int_equal(noc_lab_spec_parse(text, "a.json", &spec, log), NOC_OK);
    clear();
    assert_int_equal(run(spec, log, &whole), NOC_OK);
    assert_int_equal(whole, 2 * 2 * 2);
    /* Allocations of a frame are refused by tests/render, so they are passed over in ever longer steps. */
    for (int later = 0; later < 2; later++)
        for (uint64_t n = (reached = true, 1); reached; n = n + 1 + (n > 30 ? n / 3 : 0)) {
            clear();
            begin_refusal(n, later);
            noc_status status = run(spec, log, &rows);
            reached = end_refusal();
            if (status) {
                if (status == NOC_ERR_FORMAT) /* a picture that is read has no other word for it */
                    assert_true(strstr(refusing.first_error, "EXR") || strstr(refusing.first_error, "no memory for"));
                assert_refused(status == NOC_ERR_FORMAT ? NOC_ERR_MEMORY : status, "run");
                assert_int_equal(run(spec, log, &rows), NOC_OK);
            } else {
                assert_int_equal(refusing.errors, 0);
            }
            assert_int_equal(rows, whole);
        }
    noc_lab_spec_destroy(spec);
    noc_log_destroy(log);
}

static void test_run(void **state) {
    (void)state;
    run_refused(work);
}

static void test_parts(void **state) {
    (void)state;
    run_refused(work_parts);
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(test_spec), cmocka_unit_test(test_run),
                                        cmocka_unit_test(test_parts) };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
