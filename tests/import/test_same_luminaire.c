/* A luminaire is the same whether its file is IES or EULUMDAT: the lux of a lamp that has either, at the same place,
 * agree along and across the road. Light falls more to the road than behind the pole, and more to one end of the road
 * than to the other; the road is at C 0 of the IES file and at C 90 of the EULUMDAT, as tools have it that keep to the
 * standards. */
#include "../own_view.h"
#include "../photometry/made.h"
#include "../test.h"

#include <nocturne/measure.h>
#include <nocturne/nocturne.h>

static char folder[] = "/tmp/noc-same-luminaire-XXXXXX";
#include "../folder.h"

#define X0 678000.0
#define Y0 5404000.0
enum { PLANES = 24, STEPS = 19, POINTS = 10 };

/* cd, by the azimuth from the road's side, counterclockwise seen from above, and gamma: nothing goes up. */
static double candela(double azimuth, double gamma) {
    double x = cos(azimuth * M_PI / 180), y = sin(azimuth * M_PI / 180), t = cos(gamma * M_PI / 180), s = 1 - t * t;
    return gamma >= 90 ? 0 : 1300 * t * (1 + (.6 * x + .25 * y + .1 * x * y) * s);
}

/* lm, by the sum over the steps of the files. */
static double lumens(void) {
    double sum = 0;
    for (int c = 0; c < PLANES; c++)
        for (int g = 0; g < 90; g++)
            sum += candela(15 * c, g + .5) * sin((g + .5) * M_PI / 180);
    return sum * (2 * M_PI / PLANES) * (M_PI / 180);
}

static const char *write_ies(void) {
    made m = { .len = 0 };
    put(&m, "IESNA:LM-63-2002\n[TEST] made\nTILT=NONE\n1 -1 1 %d %d 1 2 .3 .3 0\n1 1 50\n", STEPS, PLANES + 1);
    put_steps(&m, 0, 90, 5);
    put_steps(&m, 0, 360, 15);
    for (int c = 0; c <= PLANES; c++)
        for (int g = 0; g < STEPS; g++)
            put(&m, "%.9g%c", candela(15 * c, 5 * g), g + 1 == STEPS ? '\n' : ' ');
    return write_file("one.ies", m.text);
}

static const char *write_ldt(void) {
    made m = { .len = 0 };
    double flux = lumens();
    put(&m, "Maker\n1\n0\n%d\n15\n%d\n5\nreport\nA lamp\nno\nfile\ndate\n", PLANES, STEPS);
    put(&m, "300\n300\n0\n300\n300\n0\n0\n0\n0\n100\n100\n1\n0\n1\n1\nLED\n%.9g\n3000\n80\n50\n", flux);
    for (int i = 0; i < 10; i++)
        put(&m, "0.5\n");
    for (int c = 0; c < PLANES; c++)
        put(&m, "%d\n", 15 * c);
    for (int g = 0; g < STEPS; g++)
        put(&m, "%d\n", 5 * g);
    for (int c = 0; c < PLANES; c++)
        for (int g = 0; g < STEPS; g++)
            put(&m, "%.9g\n", candela(15 * c - 90, 5 * g) * 1000 / flux);
    return write_file("one.ldt", m.text);
}

/* m from the lamp: towards the road, which is north, and along it; none is in the pole's shadow. */
static const double places[POINTS][2] = { { 2, 0 },  { 6, 0 },  { 12, 0 },  { -6, 2 }, { 3, 5 },
                                          { 3, 15 }, { 3, -5 }, { 3, -15 }, { 8, 10 }, { 8, -10 } };

static void lux_by(const char *profile, double lux[POINTS]) {
    char text[200];
    noc_luminaire_rule rule = noc_luminaire_default_rule();
    noc_import_params params = noc_import_default_params();
    noc_measure_params measure = noc_measure_default_params();
    noc_render_params render = noc_render_default_params();
    noc_meter meters[POINTS];
    noc_reading readings[POINTS];
    snprintf(text, sizeof(text), "id,x,y,height,direction,lamp_type\na,%.1f,%.1f,8,0,LED\n", X0, Y0);
    const char *path = write_file("lamp.csv", text);
    rule.profile = profile;
    rule.shape = NOC_LAMP_POINT;
    params.luminaires = &rule;
    params.luminaire_count = 1;
    params.crs = "EPSG:25832";
    render.sky = 0;
    measure.render = &render;
    measure.error = 1e-3;
    noc_scene *scene = noc_scene_create(NULL);
    assert_int_equal(noc_scene_load(scene, &path, 1, &params, NULL), NOC_OK);
    noc_light_info light;
    assert_int_equal(noc_scene_get_light(scene, 0, &light), NOC_OK);
    assert_float_equal(light.lumens, lumens(), .005 * lumens());
    double ground;
    assert_true(noc_scene_ground(scene, 0, 0, &ground));
    for (int i = 0; i < POINTS; i++)
        meters[i] = (noc_meter){ .place = { light.light.position[0] + places[i][1],
                                            light.light.position[1] + places[i][0], ground + .01 },
                                 .normal = { 0, 0, 1 } };
    noc_view *view = own_view(scene, 0, NULL);
    assert_int_equal(noc_measure_points(view, meters, POINTS, &measure, NULL, readings, NULL), NOC_OK);
    for (int i = 0; i < POINTS; i++)
        lux[i] = readings[i].lux;
    close_view(view);
    noc_scene_destroy(scene);
}

static void test_same_lux(void **state) {
    (void)state;
    double ies[POINTS], ldt[POINTS];
    lux_by(write_ies(), ies);
    lux_by(write_ldt(), ldt);
    for (int i = 0; i < POINTS; i++) {
        double toward = places[i][0], along = places[i][1], h = 8 - .01, d2 = h * h + toward * toward + along * along;
        double t = h / sqrt(d2), azimuth = atan2(-along, toward) * 180 / M_PI; /* west is to the left of north */
        double want = candela(azimuth, acos(t) * 180 / M_PI) * t / d2;
        print_message("# %g m, %g m: IES %.4f, EULUMDAT %.4f, %.4f lx\n", toward, along, ies[i], ldt[i], want);
        if (fabs(ies[i] - ldt[i]) > .005 * ies[i])
            fail_msg("%g m to the road, %g m along: %g lx by IES, %g by EULUMDAT", toward, along, ies[i], ldt[i]);
        assert_float_equal(ies[i], want, .01 * want); /* by the formula, between the steps of the files */
    }
    assert_true(ies[1] > 1.2 * ies[3]);                                /* the road is at the front */
    assert_true(fabs(ies[5] - ies[7]) > .1 * NOC_MAX(ies[5], ies[7])); /* and its ends differ */
}

static int start(void **state) {
    (void)state;
    return mkdtemp(folder) ? 0 : -1;
}

static int finish(void **state) {
    (void)state;
    return remove_folder();
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(test_same_lux) };
    return cmocka_run_group_tests_name("import/same_luminaire", tests, start, finish);
}
