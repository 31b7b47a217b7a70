/* What one picture is set to: each row of the option tables is set and got, what is wrong is told, and a look that a
 * frame refuses is never made. */
#include "../test.h"

#include "viewer/look.h"
#include "viewer/words.h"

static viewer_source source_of(noc_preset preset) {
    viewer_source s = { .render = noc_render_default_params(), .display = noc_display_default_params() };
    noc_render_use_preset(&s.render, preset);
    return s;
}

static const char *text_of(const json_t *row, const char *key) { return json_string_value(json_object_get(row, key)); }

static double number_of(const json_t *row, const char *key) { return json_number_value(json_object_get(row, key)); }

/* Sets it, and looks whether it is. false: a frame would refuse it, for which there are words. */
static bool try(look *l, const char *name, const char *value) {
    char why[300] = "", got[200];
    look before = *l;
    if (look_set(l, name, value, why, sizeof(why))) {
        assert_true(look_get(l, name, got, sizeof(got)) > 0);
        if (strcmp(got, value) && !(!strcmp(value, "on") && !strcmp(got, "true")))
            fail_msg("%s %s: it is %s", name, value, got);
        return true;
    }
    if (!strstr(why, "render: "))
        fail_msg("%s %s: %s", name, value, why);
    assert_memory_equal(&before, l, sizeof(before));
    return false;
}

static void each_row_is_set_and_got(void **state) {
    const viewer_source source = source_of(NOC_PRESET_STILL);
    const look begin = look_default(&source);
    json_t *schema = look_schema(&begin), *values = look_values(&begin);
    size_t set = 0, count = json_array_size(schema);
    assert_true(count > 40);
    assert_int_equal(json_object_size(values), count);
    for (size_t i = 0; i < count; i++) {
        const json_t *row = json_array_get(schema, i);
        const char *name = text_of(row, "name"), *kind = text_of(row, "kind"), *value = text_of(row, "value");
        char text[60], got[200];
        look l = begin;
        assert_true(*text_of(row, "group") && *text_of(row, "help") && text_of(row, "unit"));
        assert_true(look_get(&l, name, got, sizeof(got)) >= 0);
        assert_string_equal(value, got);
        assert_string_equal(value, text_of(values, name));
        if (!strcmp(kind, "bool")) {
            set += try(&l, name, strcmp(value, "true") ? "true" : "false");
        } else if (!strcmp(kind, "int") || !strcmp(kind, "real")) {
            double min = number_of(row, "min"), max = number_of(row, "max"), wide = max > 1e6 ? 1e6 : max;
            snprintf(text, sizeof(text), "%.0f", wide);
            set += try(&l, name, text);
            snprintf(text, sizeof(text), "%.0f", min - 1);
            assert_false(look_set(&l, name, text, got, sizeof(got)));
            assert_non_null(strstr(got, name));
        } else if (!strcmp(kind, "choice")) {
            const json_t *choices = json_object_get(row, "choices");
            assert_true(json_array_size(choices) > 1);
            for (size_t k = 0; k < json_array_size(choices); k++) {
                l = begin;
                set += try(&l, name, json_string_value(json_array_get(choices, k)));
            }
        }
    }
    assert_true(set > 60);
    json_decref(schema);
    json_decref(values);
}

static void what_is_wrong_is_told(void **state) {
    static const struct {
        const char *name, *value, *says;
    } wrong[] = {
        { "metod", "ris", "there is no option \"metod\" of a picture" },
        { "width", "64", "there is no option \"width\"" }, /* the page says it otherwise */
        { "method", "rt", "method: \"rt\" is none of reference|is|ris|restir" },
        { "draws", "0", "draws: \"0\" is outside 1 to 1024" },
        { "draws", "2.5", "draws: \"2.5\" is not a whole number from 1 to 1024" },
        { "sky", "", "sky: needs a value" },
        { "sky", "-nan", "sky" },
        { "temporal", "perhaps", "neither true nor false" },
        { "show", "noise", "show: there is no mode \"noise\"" },
        { "show-range", "3", "show-range: \"3\" is neither auto nor LOW,HIGH" },
        { "show-range", "5,3", "the lower one first" },
        { "show-range", "-1,3", "show-range" },
        { "isolines", "5,3", "isolines: \"5,3\" is neither rising values, 1,2,5, nor a number of lines, 0 to 32" },
        { "isolines", "", "isolines" },
        { "isolines", "33", "isolines" },
        { "exposure", "bright", "exposure: \"bright\" is neither EV100 of -30 to 30 nor f/2.8,1/30,iso1600 nor auto" },
        { "exposure", "31", "exposure" },
        { "frames", "-1", "frames: \"-1\" is outside 0 to 1000000" },
        { "isa", "mmx", "isa" },
    };
    const viewer_source source = source_of(NOC_PRESET_STILL);
    const look begin = look_default(&source);
    for (size_t i = 0; i < sizeof(wrong) / sizeof(*wrong); i++) {
        look l = begin;
        char why[300] = "";
        if (look_set(&l, wrong[i].name, wrong[i].value, why, sizeof(why)) || !strstr(why, wrong[i].says))
            fail_msg("%s %s: \"%s\"", wrong[i].name, wrong[i].value, why);
        assert_memory_equal(&l, &begin, sizeof(l));
    }
}

static void set(look *l, const char *name, const char *value) {
    char why[300];
    if (!look_set(l, name, value, why, sizeof(why)))
        fail_msg("%s %s: %s", name, value, why);
}

static void assert_words(const look *l, const char *expected) {
    size_t count;
    char **list = look_words(l, NULL, false, &count), *line = list ? words_line(list, count) : NULL;
    assert_non_null(line);
    assert_string_equal(line, expected);
    free(line);
    words_free(list, count);
}

/* What the command line says of the mode, a viewer opens with. */
static void a_mode_is_begun_with(void **state) {
    viewer_source source = source_of(NOC_PRESET_STILL);
    source.show = 1 + NOC_AOV_ILLUMINANCE;
    source.channel = (noc_channel_params){ .low = 1, .high = 50, .scale = NOC_BAR_LOG };
    assert_true(noc_isolines_parse("5,10", &source.channel.isolines));
    const look begin = look_default(&source);
    assert_words(&begin, "--show illuminance --show-range 1,50 --show-scale log --isolines 5,10");
    json_t *values = look_values(&begin);
    assert_string_equal(text_of(values, "show"), "illuminance");
    assert_string_equal(text_of(values, "isolines"), "5,10");
    json_decref(values);
}

static void a_frame_refuses_no_look(void **state) {
    const viewer_source source = source_of(NOC_PRESET_STILL);
    look l = look_default(&source);
    char why[300];
    set(&l, "show", "lights");
    assert_int_equal(look_params(&l, 32, 16).aovs, 1u << NOC_AOV_LIGHTS);
    assert_int_equal(look_params(&l, 32, 16).width, 32);
    assert_false(look_set(&l, "method", "reference", why, sizeof(why)));
    assert_non_null(strstr(why, "only ris and restir"));
    set(&l, "show-range", "0.5,200");
    set(&l, "show", "depth"); /* other numbers have another range */
    assert_false(look_set(&l, "show-range", "0,50", why, sizeof(why)));
    assert_non_null(strstr(why, "begins above 0"));
    set(&l, "show-scale", "linear");
    set(&l, "show-range", "0,50");
    assert_false(look_set(&l, "show-scale", "auto", why, sizeof(why)));
    set(&l, "show-range", "auto");
    set(&l, "show-scale", "log");
    char text[60];
    look_get(&l, "show-range", text, sizeof(text));
    assert_string_equal(text, "auto");
    set(&l, "method", "reference");
    set(&l, "show", "picture");
    assert_int_equal(look_params(&l, 32, 16).aovs, 0);
}

static void the_preset_sets_the_estimator(void **state) {
    const viewer_source still = source_of(NOC_PRESET_STILL), moving = source_of(NOC_PRESET_INTERACTIVE);
    look a = look_default(&still), b = look_default(&moving);
    char text[60];
    look_get(&b, "preset", text, sizeof(text));
    assert_string_equal(text, "interactive");
    set(&a, "sky", "0.5");
    set(&b, "sky", "0.5");
    set(&a, "preset", "interactive");
    assert_memory_equal(&a, &b, sizeof(a));
}

static void idle_options_say_why(void **state) {
    const viewer_source source = source_of(NOC_PRESET_STILL);
    look l = look_default(&source);
    set(&l, "method", "ris");
    json_t *idle = look_idle(&l, false);
    assert_non_null(strstr(text_of(idle, "radius"), "it needs method restir"));
    assert_non_null(strstr(text_of(idle, "environment-lux"), "no map"));
    assert_null(json_object_get(idle, "draws") && json_object_get(idle, "list") ? idle : NULL);
    assert_null(json_object_get(idle, "tonemap"));
    assert_null(json_object_get(idle, "smooth"));
    json_decref(idle);
    set(&l, "show", "depth");
    idle = look_idle(&l, true);
    assert_non_null(json_object_get(idle, "tonemap"));
    assert_non_null(json_object_get(idle, "exposure"));
    assert_non_null(strstr(text_of(idle, "smooth"), "not smoothed"));
    assert_null(json_object_get(idle, "environment-lux"));
    json_decref(idle);
}

static void modes_are_the_views_of_render(void **state) {
    json_t *modes = look_modes();
    assert_int_equal(json_array_size(modes), 1 + NOC_AOV_COUNT);
    size_t ranges = 0;
    for (size_t i = 0; i < json_array_size(modes); i++) {
        const json_t *mode = json_array_get(modes, i);
        assert_true(*text_of(mode, "name") && *text_of(mode, "text") && text_of(mode, "unit"));
        ranges += json_is_true(json_object_get(mode, "range"));
    }
    assert_true(ranges >= 8 && ranges < NOC_AOV_COUNT);
    json_decref(modes);
}

/* Of a look only what the program does not do by itself. */
static void words_say_what_differs(void **state) {
    const viewer_source still = source_of(NOC_PRESET_STILL), moving = source_of(NOC_PRESET_INTERACTIVE);
    look l = look_default(&still);
    assert_words(&l, "");
    l = look_default(&moving);
    assert_words(&l, "--preset interactive");
    set(&l, "learn", "off");
    set(&l, "exposure", "-1.5");
    set(&l, "white-balance", "3200");
    set(&l, "environment-lux", "3"); /* there is no map */
    assert_words(&l, "--preset interactive --no-learn --white-balance 3200 --exposure -1.5");
    l = look_default(&still);
    set(&l, "show", "depth");
    set(&l, "show-range", "1,200");
    set(&l, "exposure", "3"); /* numbers have none */
    assert_words(&l, "--show depth --show-range 1,200");
    set(&l, "show-scale", "linear");
    set(&l, "isolines", "5");
    assert_words(&l, "--show depth --show-range 1,200 --show-scale linear --isolines 5");
    set(&l, "isolines", "5,7.5,10,20");
    assert_words(&l, "--show depth --show-range 1,200 --show-scale linear --isolines 5,7.5,10,20");
    set(&l, "isolines", "5,");
    set(&l, "show", "luminance"); /* lines are kept, the range is not */
    assert_words(&l, "--show luminance --isolines 5,");
    set(&l, "show", "class"); /* which has no bar */
    assert_words(&l, "--show class");
}

static void words_are_quoted_for_a_shell(void **state) {
    const char *const given[] = { "plain-1.5,x=y", "", "two words", "it's", "$HOME `x` \"q\" \\", "*", "\n", "~" };
    enum { COUNT = sizeof(given) / sizeof(*given) };
    words list = { 0 };
    size_t count;
    words_add(&list, "printf");
    words_add(&list, "<%s>");
    for (size_t i = 0; i < COUNT; i++)
        words_add(&list, given[i]);
    char **all = words_take(&list, &count), *line = words_line(all, count), got[300] = "", expected[300] = "";
    FILE *shell = popen(line, "r");
    assert_non_null(shell);
    got[fread(got, 1, sizeof(got) - 1, shell)] = 0;
    pclose(shell);
    for (size_t i = 0; i < COUNT; i++)
        snprintf(expected + strlen(expected), sizeof(expected) - strlen(expected), "<%s>", given[i]);
    assert_string_equal(got, expected);
    free(line);
    words_free(all, count);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_row_is_set_and_got), cmocka_unit_test(what_is_wrong_is_told),
        cmocka_unit_test(a_frame_refuses_no_look), cmocka_unit_test(the_preset_sets_the_estimator),
        cmocka_unit_test(idle_options_say_why),    cmocka_unit_test(modes_are_the_views_of_render),
        cmocka_unit_test(words_say_what_differs),  cmocka_unit_test(words_are_quoted_for_a_shell),
        cmocka_unit_test(a_mode_is_begun_with),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
