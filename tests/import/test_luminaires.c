/* Rules for lamps, and groups of lights: what they match, what they make, and what is wrong with them. */
#include "test.h"

#include <math.h>
#include <nocturne/nocturne.h>
#include <sys/stat.h>
#include <unistd.h>

static char folder[] = "/tmp/noc-luminaires-XXXXXX";
#include "../folder.h"
#include "../told.h"
static noc_log *log_;

/* Six lamps, 20 m apart. */
static const char table[] = "ID;lon;lat;Lamp Type;Wattage;Mast_height_ft;Straße;Note;Arm\n"
                            "a;11,4200;48,7601;HPS-High Pressure Sodium;70;30;Bahnhofstraße;x;8 ft\n"
                            "b;11,4203;48,7601;LED;40,5;20;Bahnhofstraße;;2\n"
                            "c;11,4206;48,7601;HPS;150;30;Am Stein;y;2.5 m\n"
                            "d;11,4209;48,7601;led;;10;Ring 5;y;\n"
                            "e;11,4212;48,7601;MH;1000;40;Ring 7;N/A;long\n"
                            "f;11,4215;48,7601;;20;;;z;3\n";
static const char profile[] = "IESNA:LM-63-2002\nTILT=NONE\n1 1000 1 3 1 1 2 0 0 0\n1 1 10\n0 45 90\n0\n500 300 0\n";

static int start(void **state) {
    (void)state;
    assert_non_null(mkdtemp(folder));
    log_ = noc_log_create(&(noc_log_params){ .message = keep, .level = NOC_LOG_WARN });
    write_file("lamps.csv", table);
    write_file("road.ies", profile);
    mkdir(in_folder("inner"), 0700);
    assert_int_equal(symlink("../road.ies", in_folder("inner/link.ies")), 0);
    return 0;
}

static int end(void **state) {
    (void)state;
    unlink(in_folder("lamps.csv"));
    unlink(in_folder("lamps.geojson"));
    unlink(in_folder("road.ies"));
    unlink(in_folder("inner/link.ies"));
    rmdir(in_folder("inner"));
    noc_log_destroy(log_);
    return rmdir(folder);
}

typedef struct loaded {
    noc_scene *scene;
    noc_report *report;
    noc_status status;
} loaded;

static loaded load_file(const char *name, noc_import_params params) {
    loaded l = { .scene = noc_scene_create(log_) };
    const char *path = in_folder(name);
    *told = 0;
    params.infer_lamps = NOC_SWITCH_OFF;
    l.status = noc_scene_load(l.scene, &path, 1, &params, &l.report);
    return l;
}

static void unload(loaded *l) {
    noc_report_destroy(l->report);
    noc_scene_destroy(l->scene);
}

static noc_light_info light_of(const loaded *l, const char *id) {
    noc_scene_info info;
    noc_scene_get_info(l->scene, &info);
    for (size_t i = 0; i < info.light_slots; i++) {
        noc_light_info light;
        assert_int_equal(noc_scene_get_light(l->scene, i, &light), NOC_OK);
        if (light.light.name && !strcmp(light.light.name, id))
            return light;
    }
    fail_msg("no light %s", id);
    return (noc_light_info){ 0 };
}

/* Which of the lamps a to f hold: each that does is put into a group. */
static void assert_matches(const char *name, const char *key, const char *test, const char *expected) {
    const noc_condition condition = { key, test };
    noc_group_rule group = noc_group_default_rule();
    group.name = "those";
    group.conditions = &condition;
    group.condition_count = 1;
    noc_import_params params = noc_import_default_params();
    params.groups = &group;
    params.group_count = 1;
    loaded l = load_file(name, params);
    char found[8] = "";
    if (l.status)
        fail_msg("%s: %s: %s", key, test, told);
    for (int i = 0; i < 6; i++)
        if (light_of(&l, (char[]){ (char)('a' + i), 0 }).light.group == 1)
            found[strlen(found)] = (char)('a' + i);
    if (strcmp(found, expected))
        fail_msg("%s: %s: %s, not %s", key, test, found, expected);
    unload(&l);
}

static void test_conditions(void **state) {
    (void)state;
    static const char *const rows[][3] = {
        { "LAMP_TYPE", "HPS", "c" },
        { "lamp type", "hps*", "ac" },
        { "Lamp Type", "*sodium", "a" },
        { "Lamp Type", "led|m?", "bde" },
        { "Lamp Type", "[l-m]*", "bde" },
        { "Lamp Type", "[!l-m]*", "ac" },
        { "Lamp Type", "!LED", "ace" }, /* what has no value is not asked */
        { "Lamp Type", "absent", "f" },
        { "Lamp Type", "*", "abcde" },
        { "Lamp Type", "*S*r*u", "" },
        { "Lamp Type", "*S*r*um", "a" },
        { "Note", "absent", "be" }, /* N/A is no value */
        { "tag:Note", "y", "cd" },
        { "nowhere", "absent", "abcdef" },
        { "nowhere", "*", "" },
        { "Wattage", "> 70", "ce" },
        { "Wattage", ">= 70", "ace" },
        { "Wattage", "< 40.6", "bf" },
        { "Wattage", "<=20 W", "f" },
        { "Wattage", "= 70", "a" },
        { "Wattage", "20..70", "abf" },
        { "Wattage", "70 .. 150 W", "ac" },
        { "watts", ">= 0.5", "abcef" }, /* what the reader understood */
        { "watts", "absent", "d" },
        { "Mast_height_ft", "= 30", "ac" },     /* in the column's unit, */
        { "Mast_height_ft", "> 9.1 m", "ace" }, /* or in one that is named */
        { "height", "> 9.1", "ace" },
        { "Arm", "> 2", "acf" },     /* numbers, of whatever unit, */
        { "Arm", "> 2.3 m", "acf" }, /* or in metres, where they name none */
        { "Arm", "= 8 ft", "a" },
        { "height", "= 40 ft", "e" },
        { "source", "sodium", "ac" },
        { "source", "led", "bd" },
        { "source", "metal halide", "e" },
        { "source", "absent", "f" },
        { "id", "[ac]", "ac" },
        { "street", "Bahnhof*", "ab" },
        { "street", "ring ?", "de" },
        { "street", "absent", "f" },
        { "file", "lamps.*", "abcdef" },
        { "file", "*/noc-luminaires-*", "abcdef" },
        { "file", "other*", "" },
        { "class", "lamp", "abcdef" },
        { "class", "window", "" },
        { "inferred", "no", "abcdef" },
        { "heads", "1", "abcdef" },
    };
    for (size_t i = 0; i < sizeof(rows) / sizeof(*rows); i++)
        assert_matches("lamps.csv", rows[i][0], rows[i][1], rows[i][2]);
}

/* The same lamps as a map, which another program reads. */
static void test_conditions_reach_the_helper(void **state) {
    (void)state;
    FILE *f = fopen(in_folder("lamps.geojson"), "w");
    assert_non_null(f);
    fputs("{\"type\":\"FeatureCollection\",\"features\":[", f);
    for (int i = 0; i < 6; i++)
        fprintf(f,
                "%s{\"type\":\"Feature\",\"geometry\":{\"type\":\"Point\",\"coordinates\":[%.4f,48.7601]},"
                "\"properties\":{\"highway\":\"street_lamp\",\"ref\":\"%c\",\"lamp_type\":\"%s\",\"watts\":\"%d\","
                "\"addr:street\":\"%s\"}}",
                i ? "," : "", 11.42 + 3e-4 * i, 'a' + i, i % 2 ? "LED" : "gaslight", 10 * i + 10,
                i < 4 ? "Hauptstraße" : "Weg");
    fputs("]}", f);
    fclose(f);
    assert_matches("lamps.geojson", "lamp_type", "LED", "bdf");
    assert_matches("lamps.geojson", "tag:watts", ">= 40", "def");
    assert_matches("lamps.geojson", "street", "Haupt*", "abcd");
    assert_matches("lamps.geojson", "nowhere", "absent", "abcdef");
}

static void assert_near(double a, double b) {
    if (!(fabs(a - b) <= 1e-4 * fabs(b)))
        fail_msg("%.9g is not %.9g", a, b);
}

#define RULE(...) ((noc_luminaire_rule){ NOC_LUMINAIRE_DEFAULTS(NOC_DEFAULT_IN_C) __VA_ARGS__ })
#define ASKS(...)                                                                                                      \
    .conditions = (const noc_condition[]){ __VA_ARGS__ },                                                              \
    .condition_count = sizeof((const noc_condition[]){ __VA_ARGS__ }) / sizeof(noc_condition)

#pragma GCC diagnostic ignored "-Woverride-init"
#ifdef __clang__
#pragma clang diagnostic ignored "-Winitializer-overrides"
#endif

static void test_what_rules_make(void **state) {
    (void)state;
    const noc_luminaire_rule rules[] = {
        RULE(.efficacy = 100, .kelvin = 3500, .height = 7),
        RULE(ASKS({ "Lamp Type", "HPS*" }), .kelvin = 2050, .place = "town.yaml:9"),
        RULE(ASKS({ "Lamp Type", "HPS*" }, { "Wattage", ">= 100" }), .lumens = 14000, .shape = NOC_LAMP_SPHERE,
             .radius = 0.3, .profile = "none"),
        RULE(ASKS({ "id", "d" }), .watts = 33, .colour = "#0000ff", .shape = NOC_LAMP_POINT, .tilt = 0),
        RULE(ASKS({ "id", "b" }), .tilt = 90, .profile = "flood", .heads = 2),
        RULE(ASKS({ "id", "gone" }), .watts = 1),
    };
    noc_import_params params = noc_import_default_params();
    params.luminaires = rules;
    params.luminaire_count = sizeof(rules) / sizeof(*rules);
    loaded l = load_file("lamps.csv", params);
    assert_int_equal(l.status, NOC_OK);
    noc_light_info a = light_of(&l, "a"), b = light_of(&l, "b"), c = light_of(&l, "c"), d = light_of(&l, "d");
    float sodium[3], warm[3];
    noc_kelvin_rgb(2050, sodium);
    noc_kelvin_rgb(3500, warm);
    assert_near(a.lumens, 7000);
    assert_near(a.light.emission[0] / a.light.emission[1], sodium[0] / sodium[1]);
    assert_near(b.lumens, 4050);
    assert_near(b.light.emission[0] / b.light.emission[1], warm[0] / warm[1]);
    assert_near(c.lumens, 14000);
    assert_near(d.lumens, 3300);
    assert_true(a.light.kind == NOC_LIGHT_DISC && a.light.profile && c.light.kind == NOC_LIGHT_SPHERE);
    assert_true(!c.light.profile && fabs(c.light.radius - 0.3) < 1e-6);
    assert_true(d.light.kind == NOC_LIGHT_POINT && d.light.profile && d.light.emission[0] == 0 &&
                d.light.emission[2] > 0);
    assert_true(fabs(b.light.direction[2]) < 1e-6 && a.light.direction[2] == -1);
    assert_true(fabs(a.light.position[2] - d.light.position[2]) < 1e-6);         /* 7 m, whatever the file says */
    assert_true(fabs(c.light.position[2] - (a.light.position[2] - 0.3)) < 1e-6); /* below its housing */
    noc_scene_info info;
    noc_scene_get_info(l.scene, &info);
    assert_int_equal(info.lights, 7); /* b has two heads */
    static const size_t matched[] = { 6, 2, 1, 1, 1, 0 };
    for (size_t i = 0; i < 6; i++)
        assert_int_equal(noc_report_get_rule(l.report, i)->lamps, matched[i]);
    assert_null(noc_report_get_rule(l.report, 6));
    assert_string_equal(noc_report_get_rule(l.report, 1)->place, "town.yaml:9");
    assert_string_equal(told, "rule 6: the rule matches no lamp\n");
    assert_int_equal(noc_report_get_file(l.report, 0)->lamps_assumed[NOC_LAMP_HEIGHT], 0);
    unload(&l);
}

/* Its intensity straight down tells the file's own distribution from a built-in one. */
static void test_profiles_of_rules(void **state) {
    (void)state;
    char base[300];
    snprintf(base, sizeof(base), "%s/", folder);
    noc_luminaire_rule rules[] = { RULE(.profile = "road.ies", .profile_base = base),
                                   RULE(ASKS({ "id", "a" }), .profile = "wall") };
    noc_import_params params = noc_import_default_params();
    params.luminaires = rules;
    params.luminaire_count = 2;
    loaded l = load_file("lamps.csv", params);
    noc_report_totals totals;
    noc_report_get_totals(l.report, &totals);
    assert_int_equal(l.status, NOC_OK);
    assert_string_equal(totals.profiles, "wall 1, road.ies 5");
    unload(&l);

    /* a picture of a file that is elsewhere is not its author's to ask for */
    char inner[320];
    snprintf(inner, sizeof(inner), "%s/inner/", folder);
    static const char *const wrong[][2] = { { "../road.ies", "outside the folder" },
                                            { "link.ies", "outside the folder" },
                                            { "gone.ies", "No such file" },
                                            { "streetlight", "no built-in one is called so" } };
    for (size_t i = 0; i < 4; i++) {
        rules[0] = RULE(.profile = wrong[i][0], .profile_base = inner, .place = "town.yaml:7");
        l = load_file("lamps.csv", params);
        if (l.status != NOC_ERR_IO || strncmp(told, "town.yaml:7: profile ", 21) || !strstr(told, wrong[i][1]))
            fail_msg("%s: %s", wrong[i][0], told);
        unload(&l);
    }
    params.allow_outside = true;
    rules[0] = RULE(.profile = "link.ies", .profile_base = inner);
    l = load_file("lamps.csv", params);
    assert_int_equal(l.status, NOC_OK);
    unload(&l);
    write_file("road.ies", "IESNA:LM-63-2002\nTILT=NONE\n1 1000 1 x\n");
    rules[0] = RULE(.profile = "road.ies", .profile_base = base);
    l = load_file("lamps.csv", params);
    assert_true(l.status == NOC_ERR_FORMAT && strstr(told, "road.ies:3: "));
    unload(&l);
    write_file("road.ies", profile);
}

/* A file's flux, watts and colour are those of lamps that tell none. It is 1000 / 2 pi cd over a half space, so that
 * it has 1,000 lm, 50 a watt. */
static void test_what_files_give(void **state) {
    (void)state;
    enum { FLUXES = 4 };
    static const char *const ids[] = { "a", "c", "d", "f" }; /* sodium, HPS, LED without watts; nothing but watts */
    static const double lumens[FLUXES][4] = { { 70 * 78, 150 * 78, 1000, 20 * 50 },
                                              { 1000, 1000, 1000, 1000 },
                                              { 70 * 78, 150 * 78, 5000, 20 * 80 },
                                              { 800, 1000, 800, 800 } };
    char base[300];
    snprintf(base, sizeof(base), "%s/", folder);
    write_file("road.ies", "IESNA:LM-63-2002\n[LAMP] LED 2200K\nTILT=NONE\n1 -1 1 2 1 1 2 0 0 0\n1 1 20\n0 90\n0\n"
                           "159.154943 159.154943\n");
    noc_luminaire_rule rules[] = { RULE(.profile = "road.ies", .profile_base = base),
                                   RULE(ASKS({ "id", "c" }), .flux = NOC_FLUX_FILE) };
    noc_import_params params = noc_import_default_params();
    params.luminaires = rules;
    params.each_lamp = true;
    for (int i = 0; i < FLUXES + 1; i++) {
        bool all = i == FLUXES; /* --lamp-profile, without rules */
        params.luminaire_count = all ? 0 : i == 3 ? 2 : 1;
        params.lamp_profile = all ? in_folder("road.ies") : NULL;
        rules[0].flux = i == 1 ? NOC_FLUX_FILE : i == 2 ? NOC_FLUX_LAMP : NOC_FLUX_ANY;
        rules[0].lumens = i == 3 ? 800 : (double)NAN;
        loaded l = load_file("lamps.csv", params);
        assert_int_equal(l.status, NOC_OK);
        assert_string_equal(told, "");
        for (int k = 0; k < 4; k++) {
            double have = light_of(&l, ids[k]).lumens, want = lumens[all ? 0 : i][k];
            if (fabs(have / want - 1) > 1e-5)
                fail_msg("%d: %s has %g lm, not %g", i, ids[k], have, want);
        }
        noc_light_info d = light_of(&l, "d"), a = light_of(&l, "a");
        float warm[3], sodium[3];
        noc_kelvin_rgb(2200, warm);
        noc_kelvin_rgb(2050, sodium);
        assert_near(d.light.emission[0] / d.light.emission[1], warm[0] / warm[1]);
        assert_near(a.light.emission[0] / a.light.emission[1], sodium[0] / sodium[1]);
        const noc_report_file *file = noc_report_get_file(l.report, 0);
        assert_int_equal(file->lamps_assumed[NOC_LAMP_FLUX], i == 2);
        assert_int_equal(file->lamps_assumed[NOC_LAMP_COLOUR], 0);
        for (size_t k = 0; noc_report_get_lamp(l.report, k); k++) {
            const noc_report_lamp *lamp = noc_report_get_lamp(l.report, k);
            noc_light_info light;
            noc_scene_get_light(l.scene, lamp->light, &light);
            if (!strcmp(light.light.name, "d"))
                assert_true(lamp->watts == 20);
        }
        unload(&l);
    }
    /* a rule that asks for what there is not */
    params.luminaire_count = 1;
    params.lamp_profile = NULL;
    rules[0] = RULE(.flux = NOC_FLUX_FILE);
    loaded l = load_file("lamps.csv", params);
    assert_true(strstr(told, "\"lumens: file\" of 6 lamps whose profile is no file"));
    assert_near(light_of(&l, "a").lumens, 70 * 78);
    unload(&l);
    write_file("road.ies", profile);
}

/* C 0 as seen from above, counter-clockwise, by as many degrees as a rule says. */
static void test_turned_profiles(void **state) {
    (void)state;
    static const double turns[] = { NAN, 0, 90, -30 };
    double first[2] = { 0 };
    for (size_t i = 0; i < 4; i++) {
        noc_luminaire_rule rule = RULE(.profile = "cobra-head", .turn = turns[i]);
        noc_import_params params = noc_import_default_params();
        params.luminaires = &rule;
        params.luminaire_count = 1;
        loaded l = load_file("lamps.csv", params);
        assert_int_equal(l.status, NOC_OK);
        noc_light_info a = light_of(&l, "a");
        const double *c0 = a.light.c0, angle = i > 1 ? turns[i] * M_PI / 180 : 0;
        if (i == 0)
            memcpy(first, c0, sizeof(first));
        assert_true(fabs(c0[0] - (cos(angle) * first[0] - sin(angle) * first[1])) < 1e-6);
        assert_true(fabs(c0[1] - (sin(angle) * first[0] + cos(angle) * first[1])) < 1e-6 && fabs(c0[2]) < 1e-6);
        unload(&l);
    }
}

/* What cannot hang over a street. */
static void test_no_street_light(void **state) {
    (void)state;
    static const char *const files[][2] = { { "90 180\n0\n500 500\n", "sends 100 % of its light upward" },
                                            { "0 90\n0\n.159154943 .159154943\n", "its flux is 1 lm" },
                                            { "0 180\n0\n500 0\n", "" } }; /* a globe's half upward */
    noc_import_params params = noc_import_default_params();
    for (size_t i = 0; i < 3; i++) {
        char text[200];
        snprintf(text, sizeof(text), "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 2 1 1 2 0 0 0\n1 1 20\n%s", files[i][0]);
        write_file("road.ies", text);
        params.lamp_profile = in_folder("road.ies");
        loaded l = load_file("lamps.csv", params);
        assert_int_equal(l.status, NOC_OK);
        if (!*files[i][1] ? *told : !strstr(told, files[i][1]))
            fail_msg("%zu: %s", i, told);
        unload(&l);
    }
    write_file("road.ies", profile);
}

#define GROUP(...) ((noc_group_rule){ NOC_GROUP_DEFAULTS(NOC_DEFAULT_IN_C) __VA_ARGS__ })

static void test_groups(void **state) {
    (void)state;
    const noc_group_rule groups[] = {
        GROUP(.name = "lamps", .scale = 0.25), /* says how those begin that no other group takes */
        GROUP(.name = "station", ASKS({ "street", "Bahnhof*" }), .kelvin = 2200),
        GROUP(.name = "weak", ASKS({ "Wattage", "< 100" }), .on = false),
        GROUP(.name = "nobody", ASKS({ "class", "window" })),
    };
    noc_import_params params = noc_import_default_params();
    loaded plain = load_file("lamps.csv", params);
    params.groups = groups;
    params.group_count = 4;
    loaded l = load_file("lamps.csv", params);
    assert_int_equal(l.status, NOC_OK);
    static const char *const of[] = { "station", "station", "lamps", "lamps", "lamps", "weak" };
    static const double scale[] = { 1, 1, 0.25, 0.25, 0.25, 0 };
    float warm[3];
    noc_kelvin_rgb(2200, warm);
    for (int i = 0; i < 6; i++) {
        const char id[] = { (char)('a' + i), 0 };
        noc_light_info light = light_of(&l, id), was = light_of(&plain, id);
        assert_int_equal(light.light.group, noc_scene_find_group(l.scene, of[i]));
        assert_near(light.lumens, scale[i] * was.lumens); /* recoloured ones shine as bright */
        if (i < 2)
            assert_near(light.light.emission[0] / light.light.emission[1], warm[0] / warm[1]);
        else if (i < 5)
            assert_near(light.light.emission[0], 0.25 * was.light.emission[0]);
    }
    noc_group_info info[8];
    assert_int_equal(noc_scene_groups(l.scene, info, 8), 5);
    assert_string_equal(info[3].name, "weak");
    assert_true(info[0].lights == 0 && info[1].lights == 3 && info[2].lights == 2 && info[3].lights == 1 &&
                info[4].lights == 0 && info[3].lumens == 0);
    assert_string_equal(noc_report_get_group(l.report, 2)->name, "station");
    assert_near(noc_report_get_group(l.report, 2)->lumens, info[2].lumens);
    assert_null(noc_report_get_group(l.report, 5));

    /* at run time */
    int station = noc_scene_find_group(l.scene, "station");
    assert_int_equal(noc_scene_say_group(l.scene, station, "own,0.5"), NOC_OK);
    assert_int_equal(noc_scene_commit(l.scene), NOC_OK);
    noc_light_info a = light_of(&l, "a"), was = light_of(&plain, "a");
    for (int k = 0; k < 3; k++)
        assert_near(a.light.emission[k], 0.5 * was.light.emission[k]);
    assert_int_equal(noc_scene_say_group(l.scene, station, "on,#ff0000"), NOC_OK);
    assert_int_equal(noc_scene_commit(l.scene), NOC_OK);
    a = light_of(&l, "a");
    assert_near(a.lumens, was.lumens);
    assert_true(a.light.emission[0] > 0 && a.light.emission[1] == 0 && a.light.emission[2] == 0);
    static const char *const wrong[] = { "", "bright", "-1", "0.5,", "900K", "#12", "#000000", "nan", "off off" };
    for (size_t i = 0; i < sizeof(wrong) / sizeof(*wrong); i++) {
        *told = 0;
        assert_int_equal(noc_scene_say_group(l.scene, station, wrong[i]), NOC_ERR_ARGUMENT);
        assert_non_null(strstr(told, "is no state"));
    }
    unload(&l);
    unload(&plain);
}

static void assert_refused(noc_import_params params, const char *message) {
    loaded l = load_file("lamps.csv", params);
    if (l.status != NOC_ERR_ARGUMENT || !strstr(told, message))
        fail_msg("%d: %s", (int)l.status, told);
    unload(&l);
}

static void test_what_is_wrong(void **state) {
    (void)state;
    const struct {
        noc_luminaire_rule rule;
        const char *message;
    } rules[] = {
        { RULE(.kelvin = 3), "rule 1: kelvin is 3, must be in 1000..25000 K" },
        { RULE(.kelvin = (double)INFINITY), "rule 1: kelvin is inf" },
        { RULE(.heads = 99, .place = "b.yaml:3"), "b.yaml:3: heads is 99" },
        { RULE(.colour = "red"), "rule 1: colour \"red\" is no #rrggbb" },
        { RULE(ASKS({ "a", "b[" })), "rule 1: match a: \"b[\" has a [" },
        { RULE(ASKS({ NULL, "b" })), "has no key" },
        { RULE(ASKS({ "a", NULL })), "is empty" },
    };
    noc_import_params params = noc_import_default_params();
    for (size_t i = 0; i < sizeof(rules) / sizeof(*rules); i++) {
        params.luminaires = &rules[i].rule;
        params.luminaire_count = 1;
        assert_refused(params, rules[i].message);
    }
    params.luminaire_count = 0;
    noc_group_rule groups[2] = { GROUP(.name = "a", .scale = -1), GROUP(.name = "a") };
    params.groups = groups;
    params.group_count = 1;
    assert_refused(params, "group 1: scale is -1");
    groups[0] = groups[1];
    params.group_count = 2;
    assert_refused(params, "group 2: there are two groups a");
    groups[0].name = "";
    assert_refused(params, "group 1: it has no name");
    groups[0].name = "b";
    params.group_states = (noc_texts){ { "c=off" }, 1 };
    assert_refused(params, "there is no group c; the scene's are: b, a");
    params.group_states = (noc_texts){ { "off" }, 1 };
    assert_refused(params, "\"off\" is not NAME=STATE");
}

/* A reader's lamps are looked at without being stood. */
static void test_they_are_told_of_a_file(void **state) {
    (void)state;
    const noc_luminaire_rule rules[] = { RULE(ASKS({ "Lamp Type", "LED" }), .lumens = 1000, .heads = 2) };
    noc_import_params params = noc_import_default_params();
    noc_report *report = NULL;
    params.luminaires = rules;
    params.luminaire_count = 1;
    assert_int_equal(noc_inspect(log_, in_folder("lamps.csv"), &params, &report), NOC_OK);
    assert_int_equal(noc_report_get_rule(report, 0)->lamps, 2);
    assert_int_equal(noc_report_get_file(report, 0)->lamps_assumed[NOC_LAMP_COLOUR], 3); /* of the LEDs, and of f */
    assert_null(noc_report_get_group(report, 0));
    noc_report_destroy(report);
}

/* Lights of the built-in city are in groups of their own. */
static void test_groups_of_the_built_in_city(void **state) {
    (void)state;
    noc_builtin_params city = noc_builtin_default_params();
    noc_import_params params = noc_import_default_params();
    noc_scene *scene = noc_scene_create(log_);
    noc_group_info info[4];
    city.city.size = 250; /* a smaller one has no cars */
    params.builtin = &city;
    params.group_states = (noc_texts){ { "windows=off", "cars=0.5" }, 2 };
    assert_int_equal(noc_scene_load(scene, (const char *[]){ "builtin:city" }, 1, &params, NULL), NOC_OK);
    assert_int_equal(noc_scene_groups(scene, info, 4), 4);
    for (int i = 1; i < 4; i++) {
        static const char *const names[] = { "", "lamps", "windows", "cars" };
        assert_string_equal(info[i].name, names[i]);
        assert_true(info[i].lights > 0 && (info[i].lumens > 0) == (i != 2));
    }
    noc_scene_destroy(scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_conditions),
        cmocka_unit_test(test_conditions_reach_the_helper),
        cmocka_unit_test(test_what_rules_make),
        cmocka_unit_test(test_profiles_of_rules),
        cmocka_unit_test(test_what_files_give),
        cmocka_unit_test(test_no_street_light),
        cmocka_unit_test(test_turned_profiles),
        cmocka_unit_test(test_groups),
        cmocka_unit_test(test_what_is_wrong),
        cmocka_unit_test(test_they_are_told_of_a_file),
        cmocka_unit_test(test_groups_of_the_built_in_city),
    };
    return cmocka_run_group_tests(tests, start, end);
}
