#include "../test.h"
#include "base/base.h"
#include <locale.h>
#include <math.h>
#include <nocturne/option.h>

static noc_render_params render;
static noc_display_params display;
static noc_import_params import;
static noc_city_params city;
static noc_device_params device;

static const struct {
    const noc_option *(*table)(void);
    void *params;
    size_t size;
} tables[] = {
    { noc_render_options, &render, sizeof(render) }, { noc_display_options, &display, sizeof(display) },
    { noc_import_options, &import, sizeof(import) }, { noc_city_options, &city, sizeof(city) },
    { noc_device_options, &device, sizeof(device) },
};

static int setup(void **state) {
    render = noc_render_default_params();
    display = noc_display_default_params();
    import = noc_import_default_params();
    city = noc_city_default_params();
    device = noc_device_default_params();
    return 0;
}

static const noc_option *find(const noc_option *table, const char *name) {
    for (; table->name; table++)
        if (!strcmp(table->name, name))
            return table;
    fail_msg("no option %s", name);
    return NULL;
}

/* Fields lie in their struct without overlapping, and names are unique over all tables, since one command line takes
 * all. */
static void rows_are_sound(void **state) {
    bool fresh;
    noc_map names = { 0 };
    for (size_t t = 0; t < NOC_COUNT(tables); t++) {
        unsigned char used[sizeof(noc_render_params) + sizeof(noc_import_params)] = { 0 };
        for (const noc_option *o = tables[t].table(); o->name; o++) {
            assert_true(map_put(&names, o->name, 1, &fresh) && fresh);
            assert_true(o->group && o->unit && o->help && *o->help && strlen(o->help) < 80);
            assert_int_equal(o->kind == NOC_OPTION_CHOICE, o->choices != NULL);
            assert_true(strncmp(o->name, "no-", 3) != 0);
            size_t size = noc_option_size(o);
            assert_true(o->offset + size <= tables[t].size && o->offset % NOC_MIN(size, sizeof(void *)) == 0);
            for (size_t i = 0; i < size; i++)
                assert_int_equal(used[o->offset + i]++, 0);
        }
    }
    map_free(&names);
}

/* The default of every option, as text, is a value that the option takes and that changes nothing. */
static void defaults_round_trip(void **state) {
    for (size_t t = 0; t < NOC_COUNT(tables); t++) {
        for (const noc_option *o = tables[t].table(); o->name; o++) {
            char before[64], after[64];
            assert_true(noc_option_get(o, tables[t].params, before, sizeof(before)) < (int)sizeof(before));
            if ((o->kind == NOC_OPTION_TEXT || o->kind == NOC_OPTION_TEXTS) && !*before)
                continue;
            unsigned char *copy = malloc(tables[t].size);
            memcpy(copy, tables[t].params, tables[t].size);
            assert_int_equal(noc_option_set(o, tables[t].params, before, NULL), NOC_OK);
            assert_memory_equal(copy, tables[t].params, tables[t].size);
            noc_option_get(o, tables[t].params, after, sizeof(after));
            assert_string_equal(before, after);
            free(copy);
        }
    }
}

/* Every choice and both ends of every range are taken and read back; one step beyond is an error that changes nothing.
 */
static void ranges_and_choices(void **state) {
    for (size_t t = 0; t < NOC_COUNT(tables); t++) {
        for (const noc_option *o = tables[t].table(); o->name; o++) {
            char text[64], back[64], before[64];
            if (o->kind == NOC_OPTION_CHOICE) {
                const char *c = o->choices;
                for (int i = 0; *c; i++) {
                    int n = (int)strcspn(c, "|"), stored;
                    snprintf(text, sizeof(text), "%.*s", n, c);
                    assert_int_equal(noc_option_set(o, tables[t].params, text, NULL), NOC_OK);
                    memcpy(&stored, (char *)tables[t].params + o->offset, sizeof(stored));
                    assert_int_equal(stored, i);
                    noc_option_get(o, tables[t].params, back, sizeof(back));
                    assert_string_equal(back, text);
                    c += n + (c[n] == '|');
                }
            } else if (o->kind == NOC_OPTION_SWITCH) {
                static const char *const said[] = { "false", "true", "auto" };
                for (int i = 0, stored; i < 3; i++) {
                    assert_int_equal(noc_option_set(o, tables[t].params, said[i], NULL), NOC_OK);
                    memcpy(&stored, (char *)tables[t].params + o->offset, sizeof(stored));
                    assert_int_equal(stored, i); /* OFF, ON, AUTO */
                    noc_option_get(o, tables[t].params, back, sizeof(back));
                    assert_string_equal(back, said[i]);
                }
                assert_int_equal(noc_option_set(o, tables[t].params, "perhaps", NULL), NOC_ERR_ARGUMENT);
            } else if (o->kind != NOC_OPTION_BOOL && o->kind != NOC_OPTION_TEXT && o->kind != NOC_OPTION_TEXTS) {
                double ends[] = { o->min, o->max }, beyond[] = { o->min - 1, o->max + 1 };
                for (int i = 0; i < 2; i++) {
                    snprintf(text, sizeof(text), "%.17g", ends[i]);
                    assert_int_equal(noc_option_set(o, tables[t].params, text, NULL), NOC_OK);
                    noc_option_get(o, tables[t].params, before, sizeof(before));
                    assert_true(strtod(before, NULL) == ends[i]);
                    snprintf(text, sizeof(text), "%.17g", beyond[i]);
                    assert_int_equal(noc_option_set(o, tables[t].params, text, NULL), NOC_ERR_ARGUMENT);
                    noc_option_get(o, tables[t].params, back, sizeof(back));
                    assert_string_equal(back, before);
                }
            }
        }
    }
}

/* Each alias of a table stands for a choice, and for another than itself. */
static void aliases_name_choices(void **state) {
    size_t tried = 0;
    for (size_t t = 0; t < NOC_COUNT(tables); t++) {
        for (const noc_option *o = tables[t].table(); o->name; o++) {
            for (const char *a = o->aliases; a && *a; a += *a == '|', tried++) {
                char alias[32], name[32], back[32];
                int length = (int)strcspn(a, "="), n = (int)strcspn(a + length + 1, "|");
                snprintf(alias, sizeof(alias), "%.*s", length, a);
                snprintf(name, sizeof(name), "%.*s", n, a + length + 1);
                assert_int_equal(noc_option_set(o, tables[t].params, alias, NULL), NOC_OK);
                noc_option_get(o, tables[t].params, back, sizeof(back));
                assert_string_equal(back, name);
                assert_string_not_equal(alias, name);
                a += length + 1 + n;
            }
        }
    }
    assert_true(tried >= 2);
}

/* A choice is an enum's value, and what goes round an enum goes to its count. */
static void choices_are_as_many_as_values(void **state) {
    static const struct {
        const char *name;
        int values;
    } enums[] = { { "candidates", NOC_CANDIDATES_COUNT }, { "isa", NOC_ISA_COUNT } };
    for (size_t i = 0; i < NOC_COUNT(enums); i++) {
        int choices = 1;
        for (const char *c = find(noc_render_options(), enums[i].name)->choices; *c; c++)
            choices += *c == '|';
        assert_int_equal(choices, enums[i].values);
    }
}

/* The names that candidates had once are still taken. */
static void former_names_of_candidates(void **state) {
    const noc_option *o = find(noc_render_options(), "candidates");
    static const struct {
        const char *name;
        noc_candidates value;
    } former[] = { { "bvh", NOC_CANDIDATES_INFLUENCE }, { "tree", NOC_CANDIDATES_LIGHT_BVH } };
    for (size_t i = 0; i < NOC_COUNT(former); i++) {
        render.candidates = NOC_CANDIDATES_LISTS;
        assert_int_equal(noc_option_set(o, &render, former[i].name, NULL), NOC_OK);
        assert_int_equal(render.candidates, former[i].value);
    }
    static const char *const bad[] = { "bv", "bvh=influence", "tre", "light", "bvh|tree" };
    for (size_t i = 0; i < NOC_COUNT(bad); i++)
        assert_int_equal(noc_option_set(o, &render, bad[i], NULL), NOC_ERR_ARGUMENT);
}

/* ---- what takes params holds them to the same rows ---- */

static void ignore(void *user, noc_log_level level, const char *text) {}

static noc_status take_render(noc_log *log) { return noc_render_check(&render, log); }

/* The params are looked at before the file, and that is missing. */
static noc_status take_import(noc_log *log) {
    const char *path = "/nonexistent/city.gml";
    noc_scene *scene = noc_scene_create(log);
    noc_status status = noc_scene_load(scene, &path, 1, &import, NULL);
    noc_scene_destroy(scene);
    return status;
}

/* And before the scene, which takes no more. */
static noc_status take_city(noc_log *log) {
    noc_scene *scene = noc_scene_create(log);
    assert_int_equal(noc_scene_commit(scene), NOC_OK);
    noc_status status = noc_scene_add_city(scene, &city);
    noc_scene_destroy(scene);
    return status;
}

static noc_status take_device(noc_log *log) {
    noc_device_info info;
    return noc_device_find(&device, &info, log);
}

/* The field's number; of texts, how many there are. */
static void put(const noc_option *o, void *params, double value) {
    void *field = (char *)params + o->offset;
    noc_texts texts = { .count = (size_t)value };
    for (size_t i = 0; i < NOC_TEXTS; i++)
        texts.text[i] = "x";
    if (o->kind == NOC_OPTION_REAL)
        memcpy(field, &value, sizeof(value));
    else if (o->kind == NOC_OPTION_TEXTS)
        memcpy(field, &texts, sizeof(texts));
    else
        memcpy(field, &(int){ (int)value }, sizeof(int));
}

static void rows_hold_for_params(void **state) {
    static const struct {
        const noc_option *(*table)(void);
        void *params;
        noc_status (*take)(noc_log *log);
        const char *of;
    } takers[] = {
        { noc_render_options, &render, take_render, "render" },
        { noc_import_options, &import, take_import, "import" },
        { noc_city_options, &city, take_city, "city" },
        { noc_device_options, &device, take_device, "device" },
    };
    for (size_t t = 0; t < NOC_COUNT(takers); t++)
        for (const noc_option *o = takers[t].table(); o->name; o++) {
            double lo = o->min, hi = o->max;
            if (o->kind == NOC_OPTION_CHOICE)
                for (const char *c = o->choices; *c; c++)
                    hi += *c == '|';
            if (o->kind == NOC_OPTION_TEXTS)
                hi = NOC_TEXTS;
            if (o->kind == NOC_OPTION_BOOL || o->kind == NOC_OPTION_UINT || o->kind == NOC_OPTION_TEXT)
                continue; /* no value of the field is wrong */
            const double values[] = { lo, hi, hi + 1, lo - 1, NAN };
            size_t count = o->kind == NOC_OPTION_REAL ? 5 : o->kind == NOC_OPTION_TEXTS ? 3 : 4;
            for (size_t i = 0; i < count; i++) {
                char told[100], *c = told;
                snprintf(told, sizeof(told), "%s: %s%s is ", takers[t].of, o->name,
                         o->kind == NOC_OPTION_TEXTS ? ".count" : "");
                for (c += strcspn(c, ":"); *c; c++)
                    *c = *c == '-' ? '_' : *c;
                setup(NULL);
                put(o, takers[t].params, values[i]);
                noc_log *log = noc_log_create(&(noc_log_params){ .message = ignore });
                noc_status status = takers[t].take(log);
                const char *error = noc_log_last_error(log);
                bool refused = status == NOC_ERR_ARGUMENT && error && !strncmp(error, told, strlen(told)) &&
                               strstr(error, ", must be in ");
                if (refused != (i > 1))
                    fail_msg("%s %.17g: \"%s\"", o->name, values[i], error);
                noc_log_destroy(log);
            }
        }
}

/* A field, its value and its range, in one line. */
static void wrong_params_are_told(void **state) {
    static const struct {
        const char *option;
        double value;
        const char *told;
    } cases[] = {
        { "shadow-rays", 9, "render: shadow_rays is 9, must be in 1..8" },
        { "width", 1 << 30, "render: width is 1073741824, must be in 1..32768 px" },
        { "sky", -0.5, "render: sky is -0.5, must be in 0..1000000 cd/m2" },
        { "bias", 4, "render: bias is 4, must be in 0..3, of biased|mis|pairwise|counted" },
    };
    for (size_t i = 0; i < NOC_COUNT(cases); i++) {
        render = noc_render_default_params();
        put(find(noc_render_options(), cases[i].option), &render, cases[i].value);
        noc_log *log = noc_log_create(&(noc_log_params){ .message = ignore });
        assert_int_equal(noc_option_check(noc_render_options(), &render, "render", log), NOC_ERR_ARGUMENT);
        assert_string_equal(noc_log_last_error(log), cases[i].told);
        noc_log_destroy(log);
    }
}

static void bools(void **state) {
    const noc_option *o = find(noc_render_options(), "temporal");
    static const struct {
        const char *text;
        bool value;
    } good[] = { { NULL, true }, { "off", false }, { "on", true },     { "No", false }, { "YES", true },
                 { "0", false }, { "1", true },    { "false", false }, { "true", true } };
    for (size_t i = 0; i < NOC_COUNT(good); i++) {
        render.temporal = !good[i].value;
        assert_int_equal(noc_option_set(o, &render, good[i].text, NULL), NOC_OK);
        assert_int_equal(render.temporal, good[i].value);
    }
    static const char *const bad[] = { "", "2", "maybe", "true " };
    for (size_t i = 0; i < NOC_COUNT(bad); i++)
        assert_int_equal(noc_option_set(o, &render, bad[i], NULL), NOC_ERR_ARGUMENT);
}

static void bad_values_are_told(void **state) {
    static const struct {
        const noc_option *(*table)(void);
        const char *name, *value, *part;
    } bad[] = {
        { noc_render_options, "width", "abc", "not a number" },
        { noc_render_options, "width", "0", "1 to 32768 px" },
        { noc_render_options, "width", "-3", "outside" },
        { noc_render_options, "width", "100000", "outside" },
        { noc_render_options, "width", "12.5", "not a whole number" },
        { noc_render_options, "width", "", "needs a value" },
        { noc_render_options, "width", NULL, "needs a value" },
        { noc_render_options, "seed", "4294967296", "outside" },
        { noc_render_options, "radius", "nan", "not a number" },
        { noc_render_options, "radius", "1e999", "not a number" },
        { noc_render_options, "radius", "5 m", "not a number" },
        { noc_render_options, "method", "reSTIR", "reference|is|ris|restir" },
        { noc_render_options, "method", "is|ris", "none of" },
        { noc_render_options, "method", "i", "none of" },
        { noc_display_options, "tonemap", "aces", "filmic|reinhard|linear" },
        { noc_import_options, "crs", "", "needs a value" },
        { noc_city_options, "city-size", "149", "150 to 5000 m" },
    };
    for (size_t i = 0; i < NOC_COUNT(bad); i++) {
        void *params = bad[i].table == noc_render_options    ? (void *)&render
                       : bad[i].table == noc_display_options ? (void *)&display
                       : bad[i].table == noc_import_options  ? (void *)&import
                                                             : (void *)&city;
        noc_log *log = noc_log_create(&(noc_log_params){ .message = ignore });
        assert_int_equal(noc_option_set(find(bad[i].table(), bad[i].name), params, bad[i].value, log),
                         NOC_ERR_ARGUMENT);
        if (!strstr(noc_log_last_error(log), bad[i].part) || !strstr(noc_log_last_error(log), bad[i].name))
            fail_msg("%s=%s: \"%s\"", bad[i].name, bad[i].value ? bad[i].value : "", noc_log_last_error(log));
        noc_log_destroy(log);
    }
}

static void text_points_at_the_callers(void **state) {
    char text[] = "EPSG:25832", back[4];
    const noc_option *o = find(noc_import_options(), "crs");
    assert_int_equal(noc_option_set(o, &import, text, NULL), NOC_OK);
    assert_ptr_equal(import.crs, text);
    assert_int_equal(noc_option_get(o, &import, back, sizeof(back)), (int)strlen(text)); /* like snprintf */
    assert_string_equal(back, "EPS");
    assert_int_equal(noc_option_get(o, &import, NULL, 0), (int)strlen(text));
}

static void texts_add_up(void **state) {
    const noc_option *o = find(noc_import_options(), "lamps");
    char back[16];
    assert_int_equal(noc_option_set(o, &import, "a.csv", NULL), NOC_OK);
    assert_int_equal(noc_option_set(o, &import, "b, c.csv", NULL), NOC_OK);
    assert_int_equal(import.lamps.count, 2);
    assert_string_equal(import.lamps.text[1], "b, c.csv");
    assert_int_equal(noc_option_get(o, &import, back, sizeof(back)), 14);
    assert_string_equal(back, "a.csv,b, c.csv");
    assert_int_equal(noc_option_get(o, &import, back, 8), 14); /* like snprintf */
    assert_string_equal(back, "a.csv,b");
    assert_int_equal(noc_option_get(o, &import, NULL, 0), 14);
    while (import.lamps.count < NOC_TEXTS)
        assert_int_equal(noc_option_set(o, &import, "d.csv", NULL), NOC_OK);
    assert_int_equal(noc_option_set(o, &import, "e.csv", NULL), NOC_ERR_ARGUMENT);
    assert_int_equal(import.lamps.count, NOC_TEXTS);
}

/* L = 108,000 * 10^(-0.4 m) cd/m2: 22 is 0.17 mcd/m2, 17 is 17 (lightpollution.pk.edu.pl). Classes are
 * docs/defaults.md's. */
static void skies_have_words(void **state) {
    (void)state;
    static const struct {
        const char *text;
        double luminance, sqm;
    } good[] = { { "sqm:22", 1.711685e-4, 22 },     { "sqm:17", 1.711685e-2, 17 },
                 { "sqm:19.5", 1.711685e-3, 19.5 }, { "bortle:1", 1.876825e-4, 21.9 },
                 { "bortle:5", 1.298446e-3, 19.8 }, { "bortle:9", 2.057898e-2, 16.8 },
                 { "0.0108", .0108, 17.5 } };
    static const char *const bad[] = { "sqm:13.9",  "sqm:25.1",   "sqm:",    "sqm:nan", "sqm:19x",  "bortle:0",
                                       "bortle:10", "bortle:4.5", "bortle:", "bortle",  "Bortle:5", "dark" };
    const noc_option *o = find(noc_render_options(), "sky");
    double before = INFINITY;
    for (size_t i = 0; i < NOC_COUNT(good); i++) {
        assert_int_equal(noc_option_set(o, &render, good[i].text, NULL), NOC_OK);
        assert_true(fabs(render.sky - good[i].luminance) < 1e-6 * good[i].luminance);
        assert_true(fabs(noc_sky_sqm(render.sky) - good[i].sqm) < 1e-5);
        assert_true(fabs(noc_sky_luminance(good[i].sqm) - render.sky) < 1e-6 * render.sky);
    }
    for (int class = 9; class >= 1; class --) {
        char text[32];
        snprintf(text, sizeof(text), "bortle:%d", class);
        assert_int_equal(noc_option_set(o, &render, text, NULL), NOC_OK);
        assert_true(render.sky < before);
        before = render.sky;
    }
    for (size_t i = 0; i < NOC_COUNT(bad); i++)
        assert_int_equal(noc_option_set(o, &render, bad[i], NULL), NOC_ERR_ARGUMENT);
    assert_true(render.sky == before && isnan(noc_sky_sqm(0)));
    assert_true(fabs(noc_sky_sqm(noc_render_default_params().sky) - 18.8) < .05);
}

static void reals_survive_locales(void **state) {
    const noc_option *o = find(noc_render_options(), "sky");
    static const char *const locales[] = { "de_DE.UTF-8", "de_DE", "fr_FR.UTF-8", "cs_CZ.UTF-8", "C" };
    for (size_t i = 0; i < NOC_COUNT(locales); i++) {
        if (!setlocale(LC_ALL, locales[i]))
            continue;
        char text[40];
        render.sky = 0.1;
        noc_option_get(o, &render, text, sizeof(text));
        assert_string_equal(text, "0.1");
        assert_int_equal(noc_option_set(o, &render, "0.30000000000000004", NULL), NOC_OK);
        noc_option_get(o, &render, text, sizeof(text));
        assert_string_equal(text, "0.30000000000000004");
        setlocale(LC_ALL, "C");
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(rows_are_sound, setup),
        cmocka_unit_test_setup(defaults_round_trip, setup),
        cmocka_unit_test_setup(ranges_and_choices, setup),
        cmocka_unit_test(choices_are_as_many_as_values),
        cmocka_unit_test_setup(aliases_name_choices, setup),
        cmocka_unit_test_setup(former_names_of_candidates, setup),
        cmocka_unit_test_setup(bools, setup),
        cmocka_unit_test_setup(rows_hold_for_params, setup),
        cmocka_unit_test_setup(wrong_params_are_told, setup),
        cmocka_unit_test_setup(bad_values_are_told, setup),
        cmocka_unit_test_setup(text_points_at_the_callers, setup),
        cmocka_unit_test_setup(texts_add_up, setup),
        cmocka_unit_test_setup(reals_survive_locales, setup),
        cmocka_unit_test_setup(skies_have_words, setup),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
