/* Rules on a real inventory, streets of maps, and rules while memory is refused. */
#include "../memory.h"

#include <math.h>
#include <nocturne/nocturne.h>
#include <unistd.h>

static char folder[] = "/tmp/noc-lamp-files-XXXXXX";
#include "../folder.h"

static int start(void **state) {
    (void)state;
    return !mkdtemp(folder);
}

static int end(void **state) {
    (void)state;
    unlink(in_folder("map.osm"));
    unlink(in_folder("lamps.csv"));
    unlink(in_folder("a.ies"));
    return rmdir(folder);
}

/* Counts are those of the file's rows, by another program (Python's csv). */
static void test_an_inventory(void **state) {
    (void)state;
    static const struct {
        noc_condition asks[3];
        size_t count, lamps;
    } rows[] = {
        { { { "FIXTURESTYLE_DESC", "Posttop" } }, 1, 2355 },
        { { { "fixturestyle desc", "cobrahead*" } }, 1, 871 },
        { { { "POLEHEIGHT_DESC", "< 5 m" } }, 1, 1512 },
        { { { "POLEHEIGHT_DESC", "16..20 ft" } }, 1, 2308 },
        { { { "source", "sodium" } }, 1, 3220 },
        { { { "ARMLENGTH1_DESC", "absent" } }, 1, 2489 },
        { { { "WATTAGE1", ">= 250" }, { "STREETNAME", "*" }, { "NUMBERLIGHTS", "= 2" } }, 3, 618 },
    };
    enum { ROWS = sizeof(rows) / sizeof(*rows) };
    REQUIRE_SHARED(path, "data/lights/washington_dc/streetlights.csv.gz")
    noc_luminaire_rule rules[ROWS];
    for (size_t i = 0; i < ROWS; i++) {
        rules[i] = noc_luminaire_default_rule();
        rules[i].conditions = rows[i].asks;
        rules[i].condition_count = rows[i].count;
    }
    noc_import_params params = noc_import_default_params();
    noc_report *report = NULL;
    params.luminaires = rules;
    params.luminaire_count = ROWS;
    assert_int_equal(noc_inspect(NULL, path, &params, &report), NOC_OK);
    for (size_t i = 0; i < ROWS; i++)
        if (noc_report_get_rule(report, i)->lamps != rows[i].lamps)
            fail_msg("rule %zu: %zu, not %zu", i, noc_report_get_rule(report, i)->lamps, rows[i].lamps);
    noc_report_destroy(report);
}

/* A lamp without a street of its own is of the nearest road with a name; one that tells it keeps to its word. */
static void test_streets_of_a_map(void **state) {
    (void)state;
    write_file("map.osm",
               "<osm version='0.6'>"
               "<node id='1' lat='48.7600' lon='11.4200'/><node id='2' lat='48.7600' lon='11.4240'/>"
               "<node id='3' lat='48.7610' lon='11.4200'/><node id='4' lat='48.7610' lon='11.4240'/>"
               "<node id='11' lat='48.76006' lon='11.4220'><tag k='highway' v='street_lamp'/></node>"
               "<node id='12' lat='48.76095' lon='11.4220'><tag k='highway' v='street_lamp'/></node>"
               "<node id='13' lat='48.76096' lon='11.4230'><tag k='highway' v='street_lamp'/>"
               "<tag k='addr:street' v='Long Lane'/></node>"
               "<node id='14' lat='48.7605' lon='11.4220'><tag k='highway' v='street_lamp'/></node>"
               "<way id='21'><nd ref='1'/><nd ref='2'/><tag k='highway' v='residential'/><tag k='name' v='Long Lane'/>"
               "</way>"
               "<way id='22'><nd ref='3'/><nd ref='4'/><tag k='highway' v='residential'/><tag k='name' v='Short Lane'/>"
               "</way></osm>");
    const noc_condition on[] = { { "street", "long*" }, { "street", "short*" }, { "street", "absent" } };
    noc_group_rule groups[3];
    for (int i = 0; i < 3; i++) {
        groups[i] = noc_group_default_rule();
        groups[i].name = on[i].test;
        groups[i].conditions = &on[i];
        groups[i].condition_count = 1;
    }
    noc_import_params params = noc_import_default_params();
    noc_scene *scene = noc_scene_create(NULL);
    noc_group_info info[4];
    params.groups = groups;
    params.group_count = 3;
    params.infer_lamps = NOC_SWITCH_OFF;
    assert_int_equal(noc_scene_load(scene, (const char *[]){ in_folder("map.osm") }, 1, &params, NULL), NOC_OK);
    assert_int_equal(noc_scene_groups(scene, info, 4), 4);
    assert_true(info[1].lights == 2 && info[2].lights == 1 && info[3].lights == 1);
    noc_scene_destroy(scene);
}

static noc_status load(noc_log *log) {
    static const noc_condition asks[] = { { "LampType", "LED" }, { "street", "absent" }, { "watts", "> 3" } };
    char base[300];
    noc_luminaire_rule rules[2] = { noc_luminaire_default_rule(), noc_luminaire_default_rule() };
    noc_group_rule group = noc_group_default_rule();
    noc_import_params params = noc_import_default_params();
    snprintf(base, sizeof(base), "%s/", folder);
    rules[0].profile = "a.ies";
    rules[0].profile_base = base;
    rules[1].conditions = asks;
    rules[1].condition_count = 3;
    rules[1].kelvin = 4000;
    group.name = "led";
    group.conditions = asks;
    group.condition_count = 1;
    group.kelvin = 2200;
    params.luminaires = rules;
    params.luminaire_count = 2;
    params.groups = &group;
    params.group_count = 1;
    params.group_states = (noc_texts){ { "led=0.5" }, 1 };
    params.windows = NOC_SWITCH_OFF;
    params.threads = 1;
    params.each_lamp = true;
    noc_scene *scene = noc_scene_create(log);
    noc_status status =
        scene ? noc_scene_load(scene, (const char *[]){ in_folder("lamps.csv") }, 1, &params, NULL) : NOC_ERR_MEMORY;
    noc_scene_destroy(scene);
    return status;
}

static void test_memory_refused(void **state) {
    (void)state;
    write_file("lamps.csv", "id,lon,lat,LampType,Watts\na,11.42,48.76,LED,40\nb,11.421,48.76,HPS,70\n");
    write_file("a.ies", "IESNA:LM-63-2002\nTILT=NONE\n1 1000 1 3 1 1 2 0 0 0\n1 1 10\n0 45 90\n0\n500 300 0\n");
    noc_log *log = counting_log();
    if (load(log))
        fail_msg("%s", noc_log_last_error(log)); /* what PROJ found is kept */
    bool reached;
    FOR_EACH_REFUSAL(reached) {
        begin_refusal(n, later);
        noc_status status = load(log);
        reached = end_refusal();
        if (reached && status) /* or it was not needed */
            assert_refused(status, "rules");
    }
    noc_log_destroy(log);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_an_inventory),
        cmocka_unit_test(test_streets_of_a_map),
        cmocka_unit_test(test_memory_refused),
    };
    return cmocka_run_group_tests(tests, start, end);
}
