/* What the option tables say that options need is so: without it an option changes no bit of any picture, with it it
 * does. */
#include "rooms.h"

#include <nocturne/option.h>

enum { SIDE = 24, FRAMES = 3 };

/* Another value than the default for each option that needs something. */
static const struct {
    const char *name, *value;
} others[] = {
    { "candidates", "power" },
    { "draws", "5" },
    { "list", "8" },
    { "tail", "4" },
    { "shadow-rays", "2" },
    { "learn", "false" },
    { "influence", "0.5" },
    { "influence-boxes", "visible" },
    { "influence-cluster", "16" },
    { "uniform-every", "2" },
    { "rays", "3" },
    { "final-ray", "false" },
    { "temporal", "false" },
    { "spatial", "false" },
    { "neighbours", "2" },
    { "radius", "2" },
    { "passes", "2" },
    { "history", "1" },
    { "bias", "biased" },
    { "bias-rays", "false" },
    { "visibility-reuse", "false" },
    { "reject-depth", "0" },
    { "reject-normal", "1" },
};

static const char *other_value(const char *option) {
    for (size_t i = 0; i < NOC_COUNT(others); i++)
        if (!strcmp(others[i].name, option))
            return others[i].value;
    fail_msg("%s: give this test another value of it", option);
    return NULL;
}

static const noc_option *find(const char *name, size_t length) {
    for (const noc_option *o = noc_render_options(); o->name; o++)
        if (strlen(o->name) == length && !strncmp(o->name, name, length))
            return o;
    fail_msg("no option %.*s", (int)length, name);
    return NULL;
}

static noc_render_params set(const noc_option *option, noc_render_params p, const char *value) {
    assert_int_equal(noc_option_set(option, &p, value, NULL), NOC_OK);
    return p;
}

/* A floor with walls to hide behind, one of them from end to end, and more lamps than a list holds. */
static noc_scene *yard(void) {
    noc_scene *s = noc_scene_create(NULL);
    int grey = matte(s, 0.6f);
    add_floor(s, grey, 0, 0, 0, 20);
    for (int i = -2; i <= 2; i++)
        QUAD(s, grey, 3 * i - 1, 0.5 * i, 0, 2, 0.7, 0, 0, 0, 4);
    QUAD(s, grey, -20, 3.05, 0, 40, 0, 0, 0, 0, 20);
    for (int i = 0; i < 225; i++)
        assert_true(noc_scene_add_light(s, &(noc_light){ .kind = NOC_LIGHT_SPHERE,
                                                         .radius = 0.1,
                                                         .emission = { 90, 80 + i % 9, 60 },
                                                         .position = { i % 15 - 7, 1.1 * (i / 15 - 7),
                                                                       2 + 0.1 * (i % 7) } }) >= 0);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    return s;
}

static bool changes(const noc_scene *s, const noc_option *o, const noc_render_params *p) {
    noc_camera c = look(2, -13, 5, 0, 0, 0.5, 60);
    noc_render_params q = set(o, *p, other_value(o->name));
    noc_image *a = render(s, &c, p, FRAMES), *b = render(s, &c, &q, FRAMES);
    bool differ = memcmp(a->rgb, b->rgb, sizeof(float) * 3 * SIDE * SIDE) != 0;
    noc_image_destroy(a);
    noc_image_destroy(b);
    return differ;
}

/* Next of the choices that an option has, a bool's too, which begin at *at; "" at their end. */
static void next_choice(const noc_option *o, const char **at, char value[32]) {
    const char *choices = o->kind == NOC_OPTION_BOOL ? "true|false" : o->choices;
    *at = *at ? *at : choices;
    size_t n = strcspn(*at, "|");
    snprintf(value, 32, "%.*s", (int)n, *at);
    *at += n + ((*at)[n] == '|');
}

/* All that is needed is there. */
static noc_render_params satisfied(const noc_option *o) {
    noc_render_params p = measure(SIDE, SIDE, NOC_METHOD_RIS);
    for (const char *need = o->needs; *need;) {
        size_t name = strcspn(need, "="), first = strcspn(need + name + 1, "|,");
        char value[32];
        snprintf(value, sizeof(value), "%.*s", (int)first, need + name + 1);
        p = set(find(need, name), p, value);
        need += strcspn(need, ",");
        need += *need == ',';
    }
    return p;
}

static void with_all_that_it_needs_an_option_counts(void **state) {
    noc_scene *s = yard();
    size_t tried = 0;
    for (const noc_option *o = noc_render_options(); o->name; o++) {
        char why[120] = "";
        if (!o->needs)
            continue;
        noc_render_params p = satisfied(o);
        assert_false(noc_option_idle(o, noc_render_options(), &p, why, sizeof(why)));
        if (!changes(s, o, &p))
            fail_msg("%s changes nothing, though nothing is missing", o->name);
        tried++;
    }
    assert_int_equal(tried, NOC_COUNT(others));
    noc_scene_destroy(s);
}

/* Every value of every option that is needed: where it is not the right one, the picture stays. */
static void without_it_does_not(void **state) {
    noc_scene *s = yard();
    for (const noc_option *o = noc_render_options(); o->name; o++) {
        for (const char *need = o->needs; need && *need;) {
            const noc_option *other = find(need, strcspn(need, "="));
            const char *at = NULL;
            char value[32], why[120] = "";
            for (next_choice(other, &at, value); *value; next_choice(other, &at, value)) {
                noc_render_params p = set(other, satisfied(o), value);
                if (!noc_option_idle(o, noc_render_options(), &p, why, sizeof(why)))
                    continue;
                assert_non_null(strstr(why, other->name));
                assert_non_null(strstr(why, value));
                if (changes(s, o, &p))
                    fail_msg("%s changes the picture with %s %s", o->name, other->name, value);
            }
            assert_true(*why); /* one of them at least was not the right one */
            need += strcspn(need, ",");
            need += *need == ',';
        }
    }
    noc_scene_destroy(s);
}

static void it_is_told_what_is_missing(void **state) {
    static const struct {
        const char *option, *other, *value, *why;
    } cases[] = {
        { "shadow-rays", "method", "is", "it needs method ris|restir, not is" },
        { "draws", "candidates", "lists", "it needs candidates uniform|power|influence|light-bvh, not lists" },
        { "learn", "final-ray", "false", "it needs final-ray true, not false" },
        { "temporal", "method", "ris", "it needs method restir, not ris" },
    };
    for (size_t i = 0; i < NOC_COUNT(cases); i++) {
        const noc_option *other = find(cases[i].other, strlen(cases[i].other));
        char why[120];
        noc_render_params p = set(other, noc_render_default_params(), cases[i].value);
        assert_true(noc_option_idle(find(cases[i].option, strlen(cases[i].option)), noc_render_options(), &p, why,
                                    sizeof(why)));
        assert_string_equal(why, cases[i].why);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(with_all_that_it_needs_an_option_counts),
        cmocka_unit_test(without_it_does_not),
        cmocka_unit_test(it_is_told_what_is_missing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
