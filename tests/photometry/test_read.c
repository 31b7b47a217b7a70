/* Readers of luminaires: what files mean, and what is wrong with bad ones. */
#include "made.h"
#include "memory.h"

static const double first[] = { 0, 0, 0, 90, 0 }, last[] = { 0, 90, 180, 270, 360 };

/* At the file's own angles, all around. */
static void assert_same(const noc_profile *p, symmetry s, const char *what) {
    for (double c = 0; c < 360; c += 15)
        for (double g = 0; g <= 180; g += 5) {
            double got = noc_profile_intensity(p, c, g), want = made_cd(s, c, g);
            if (fabs(got - want) > 1e-5 * want)
                fail_msg("%s, symmetry %d: %g cd at C %g, gamma %g, not %g", what, (int)s, got, c, g, want);
        }
    double between = noc_profile_intensity(p, 7.5, 42.5), mean = 0;
    for (int i = 0; i < 4; i++)
        mean += made_cd(s, i & 1 ? 15 : 0, i & 2 ? 45 : 40) / 4;
    assert_true(fabs(between - mean) < 1e-5 * mean);
}

static void test_ies_symmetries(void **state) {
    static made m;
    noc_profile_info info;
    for (int s = 0; s < SYMMETRIES; s++) {
        m.len = 0;
        put(&m, "IESNA:LM-63-1995\n[LUMINAIRE] one\n[MANUFAC] us\n");
        put_ies(&m, s, first[s], last[s], 1);
        noc_profile *p = read_made(&m);
        assert_same(p, s, "IES");
        noc_profile_get_info(p, &info);
        assert_string_equal(info.format, "IES LM-63-1995, type C");
        assert_string_equal(info.name, "one");
        assert_string_equal(info.manufacturer, "us");
        assert_true(isnan(info.lamp_lumens) && isnan(info.flux_error));
        noc_profile_destroy(p);
    }
}

static void test_eulumdat_symmetries(void **state) {
    static made m;
    noc_profile_info info;
    for (int s = 0; s < SYMMETRIES; s++) {
        double flux = 0, lor = 80;
        for (int again = 0; again < 2; again++) { /* first to learn the flux, then with lamps that fit it */
            m.len = 0;
            put_eulumdat(&m, s, again ? flux * 100 / lor : 2000, lor);
            noc_profile *p = read_made(&m);
            assert_same(p, s, "EULUMDAT");
            noc_profile_get_info(p, &info);
            flux = info.lumens;
            assert_true(again ? fabs(info.flux_error) < 1e-5 : info.flux_error > 1);
            assert_string_equal(info.name, "A lamp");
            assert_true(fabs(info.size[0] - .15) < 1e-9 && fabs(info.size[1] - .25) < 1e-9);
            noc_profile_destroy(p);
        }
    }
}

/* How many warnings, and the last one. */
static int said;
static char last_said[300];
static void hear(void *ctx, noc_log_level level, const char *text) {
    said++;
    snprintf(last_said, sizeof(last_said), "%s", text);
}

static void assert_edition(const char *begins, const char *format) {
    static made m;
    m.len = 0;
    put(&m, "%s", begins);
    put_ies(&m, ABOUT_AXIS, 0, 0, 1);
    noc_log *log = noc_log_create(&(noc_log_params){ NOC_LOG_WARN, hear, NULL });
    noc_profile *p = NULL;
    noc_profile_info info;
    assert_int_equal(noc_profile_read(log, m.text, m.len, "made", &p), NOC_OK);
    noc_profile_get_info(p, &info);
    assert_string_equal(info.format, format);
    noc_profile_destroy(p);
    noc_log_destroy(log);
}

static void test_editions(void **state) {
    static const char *const begins[][2] = { { "A luminaire\nwithout a header\n", "IES LM-63-1986, type C" },
                                             { "IESNA91\n", "IES LM-63-1991, type C" },
                                             { "IESNA:LM-63-1995\r\n", "IES LM-63-1995, type C" },
                                             { "IESNA:LM-63-2002\n[TEST] 1\n", "IES LM-63-2002, type C" },
                                             { "IES:LM-63-2019\n[TEST] 1\n", "IES LM-63-2019, type C" } };
    for (size_t i = 0; i < NOC_COUNT(begins); i++)
        assert_edition(begins[i][0], begins[i][1]);
}

/* First lines that begin in a known way: a note of the spelling, or that there is no such edition. */
static void test_headers(void **state) {
    static const struct {
        const char *begins, *format;
        bool unknown;
    } headers[] = { { "IESNA: LM-63-2002\n", "IES LM-63-2002, type C", false },
                    { "IESNA LM-63-2002\n", "IES LM-63-2002, type C", false },
                    { "IESNA:LM-63-02\n", "IES LM-63-2002, type C", false },
                    { "iesna:lm_63_1995 \n", "IES LM-63-1995, type C", false },
                    { "IESNA 91\r\n", "IES LM-63-1991, type C", false },
                    { "IES LM-63-95\n", "IES LM-63-1995, type C", false },
                    { "\xef\xbb\xbfIES: LM-63-2002\n", "IES LM-63-2002, type C", false },
                    { "ANSI/IES LM-63-19\n", "IES LM-63-2019, type C", false },
                    { "LM-63-1986\n", "IES LM-63-1986, type C", false },
                    { "IESNA:LM-63-1999\n", "IES LM-63-2002, type C", true },
                    { "IESNA:LM-63-2077\n", "IES LM-63-2019, type C", true },
                    { "IESNA:LM-63\n", "IES LM-63-2002, type C", true },
                    { "IESNA\n", "IES LM-63-2002, type C", true } };
    for (size_t i = 0; i < NOC_COUNT(headers); i++) {
        said = 0;
        assert_edition(headers[i].begins, headers[i].format);
        if (said != 1 || !strstr(last_said, "made:1: ") || !strstr(last_said, "no edition") == headers[i].unknown)
            fail_msg("%s: %d warnings: \"%s\"", headers[i].begins, said, last_said);
    }
    said = 0;
    assert_edition("IES lamp of the town\n", "IES LM-63-1986, type C"); /* a label */
    assert_int_equal(said, 0);
}

/* A ball of 100 cd: multiplied, driven, tilted. */
static double ball_flux(const char *edition, const char *tilt, const char *numbers, noc_profile_info *info) {
    static made m;
    m.len = 0;
    put(&m, "%s\nTILT=%s\n%s\n0 90 180\n0\n100,100 100\n", edition, tilt, numbers);
    noc_profile *p = read_made(&m);
    noc_profile_get_info(p, info);
    noc_profile_destroy(p);
    return info->lumens / (400 * M_PI);
}

static void test_factors(void **state) {
    noc_profile_info info;
    assert_true(fabs(ball_flux("IESNA:LM-63-2002", "NONE", "1 -1 1 3 1 1 2 0 0 0 1 1 10", &info) - 1) < 1e-9);
    assert_true(fabs(ball_flux("IESNA:LM-63-2002", "NONE", "2 900 3 3 1 1 1 1 2 0\n.5 1.1 10", &info) - 1.5) < 1e-9);
    assert_true(fabs(info.lamp_lumens - 900) < 1e-9 && fabs(info.size[0] - .3048) < 1e-9);
    assert_true(fabs(info.flux_error - (600 * M_PI / 900 - 1)) < 1e-9);
    /* of 1991 the ballast-lamp factor counts, later it says something else */
    assert_true(fabs(ball_flux("IESNA91", "NONE", "1 9000 1 3 1 1 2 0 0 0 1 .9 10", &info) - .9) < 1e-9);
    assert_true(info.flux_error == 0);
    assert_true(
        fabs(ball_flux("IESNA:LM-63-1995", "INCLUDE\n1\n3\n-90 0 90\n.7 .95 .8", "1 -1 1 3 1 1 2 0 0 0 1 1 10", &info) -
             .95) < 1e-9);
}

/* A beam that is a function of the direction: the same whichever type it is measured by. */
static double beam(double right, double up, double ahead) {
    return ahead <= 0 ? 0 : 500 * ahead * ahead * (1 + .4 * right + .3 * up * up);
}

/* A beam between -to and to degrees of both angles, every `step`; half: the angles from 0 on. */
static void put_beam(made *m, int type, double step, double to, bool half) {
    double from = half ? 0 : -to;
    int n = count_steps(from, to, step);
    put(m, "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 %d %d %d 2 0 0 0 1 1 10\n", n, n, type);
    put_steps(m, from, to, step);
    put_steps(m, from, to, step);
    for (int i = 0; i < n; i++)
        for (int k = 0; k < n; k++) {
            double a = (from + i * step) * M_PI / 180, b = (from + k * step) * M_PI / 180;
            double cd = type == 3 ? beam(cos(b) * sin(a), sin(b), cos(b) * cos(a))
                                  : beam(sin(a), cos(a) * sin(b), cos(a) * cos(b));
            put(m, "%.9g ", fmax(cd, 0));
        }
}

static void test_types(void **state) {
    static made m;
    for (int type = 2; type <= 3; type++) {
        m.len = 0;
        put_beam(&m, type, 2.5, 90, false);
        noc_profile *p = read_made(&m);
        noc_profile_info info;
        noc_profile_get_info(p, &info);
        /* 500 (2 pi / 3 + .3 pi (1/3 - 1/5)): of cos^2, and of what is squared across it */
        double flux = 500 * (2 * M_PI / 3 + .3 * M_PI * (1. / 3 - 1. / 5));
        assert_true(fabs(info.lumens / flux - 1) < 2e-3);
        for (double c = 0; c < 360; c += 17)
            for (double g = 0; g < 90; g += 7) {
                double x = sin(g * M_PI / 180), want;
                want = beam(x * cos(c * M_PI / 180), x * sin(c * M_PI / 180), cos(g * M_PI / 180));
                assert_true(fabs(noc_profile_intensity(p, c, g) - want) < 1); /* linear over 2.5 degrees */
            }
        noc_profile_destroy(p);
    }
}

/* In the file's own angles: its intensities, and the means of them halfway. The direction is worked out here. */
static double own_direction(const noc_profile *p, int type, double h, double v) {
    double a = h * M_PI / 180, b = v * M_PI / 180;
    double right = type == 3 ? cos(b) * sin(a) : sin(a), up = type == 3 ? sin(b) : cos(a) * sin(b);
    double ahead = cos(a) * cos(b);
    return noc_profile_intensity(p, atan2(up, right) * 180 / M_PI, atan2(hypot(right, up), ahead) * 180 / M_PI);
}

static void test_own_angles(void **state) {
    static made m;
    for (int type = 2; type <= 3; type++) {
        m.len = 0; /* a spike of one angle on a plateau: 1000 cd at (10, 10), 50 elsewhere within 20 degrees */
        put(&m, "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 5 5 %d 2 0 0 0 1 1 10\n-20 -10 0 10 20\n-20 -10 0 10 20\n", type);
        for (int i = 0; i < 25; i++)
            put(&m, "%d ", i == 18 ? 1000 : 50);
        noc_profile *p = read_made(&m);
        noc_profile_info info;
        noc_profile_get_info(p, &info);
        assert_true(info.peak == 1000 && fabs(own_direction(p, type, 10, 10) - 1000) < 1e-6);
        assert_true(fabs(noc_profile_intensity(p, info.peak_c, info.peak_gamma) - 1000) < 1e-6);
        assert_true(fabs(own_direction(p, type, 5, 10) - 525) < 1e-6);
        assert_true(fabs(own_direction(p, type, 15, 5) - (1000 + 3 * 50) / 4.) < 1e-6);
        assert_true(fabs(own_direction(p, type, -20, 20) - 50) < 1e-6 && own_direction(p, type, -20.1, 20) == 0);
        noc_profile_destroy(p);
    }
}

/* The table of types A and B: the file's own angles, no more than it measured, and a lumen in all. */
static void test_own_table(void **state) {
    static made m;
    photometry_table t;
    for (int i = 0; i < 4; i++) {
        int type = 2 + i % 2;
        bool half = i >= 2;
        m.len = 0;
        put_beam(&m, type, 2.5, 40, half);
        noc_profile *p = read_made(&m);
        noc_profile_info info;
        noc_profile_get_info(p, &info);
        assert_int_equal(photometry_table_make(&t, p, NULL), NOC_OK);
        assert_true(t.type == (type == 2 ? 'B' : 'A') && t.rows == 32 && t.columns == 32 && !t.upward);
        assert_true(t.row_from == -40 && t.row_to == 40 && t.column_from == -40 && t.column_to == 40);
        double corner = acos(pow(cos(40 * M_PI / 180), 2)) * 180 / M_PI;
        assert_true(t.gamma_max >= corner && t.gamma_max < corner + .01);
        for (int r = 0; r < 32; r++)
            for (int c = 0; c < 32; c++) {
                double row = 2.5 * r - 40, column = 2.5 * c - 40;
                double want = type == 3 ? own_direction(p, type, column, row) : own_direction(p, type, row, column);
                assert_true(fabs(t.cells.data[4 * (32 * r + c)] * info.lumens / want - 1) < 1e-5);
            }
        photometry_table_free(&t);
        noc_profile_destroy(p);
    }
}

/* By the light itself, so that a luminaire looks the same way whichever kind of file it is in. Those of QUARTERS send
 * more along C 0 than along C 90, and so along the road. */
static void test_street(void **state) {
    static made m;
    static const double street[] = { 0, 90, 0, 90, 0 };
    noc_profile_info info;
    for (int i = 0; i < 2 * SYMMETRIES; i++) {
        int s = i / 2;
        m.len = 0;
        if (i % 2) {
            put_eulumdat(&m, s, 1000, 100);
        } else {
            put(&m, "IESNA91\n");
            put_ies(&m, s, first[s], last[s], 1);
        }
        noc_profile *p = read_made(&m);
        noc_profile_get_info(p, &info);
        if (info.street != (s == ABOUT_AXIS && i % 2 ? 90 : street[s])) /* which is the same all around */
            fail_msg("%d: C %g", i, info.street);
        double forward = info.forward.low + info.forward.medium + info.forward.high + info.forward.very_high;
        double back = info.back.low + info.back.medium + info.back.high + info.back.very_high;
        assert_true(fabs(forward + back + info.up_low + info.up_high - info.lumens) < 1e-6 * info.lumens);
        assert_true(s == HALVES || s == HALVES_ACROSS || s == NO_SYMMETRY ? forward > 1.05 * back
                                                                          : fabs(forward / back - 1) < 1e-6);
        noc_profile_destroy(p);
    }
}

/* A rotation of all planes rotates the street, in steps of 90 degrees: backwards, and along the other axis. */
static void test_street_turned(void **state) {
    double c[24], gamma[19], cd[24 * 19];
    for (int turn = 0; turn < 360; turn += 90)
        for (int kind = 0; kind < 2; kind++) {
            static made m;
            m.len = 0;
            put(&m, "IESNA91\nTILT=NONE\n1 -1 1 19 24 1 2 0 0 0\n1 1 1\n");
            for (int i = 0; i < 19; i++)
                put(&m, "%g ", gamma[i] = 5 * i);
            for (int i = 0; i < 24; i++)
                put(&m, "%g ", c[i] = 15 * i);
            for (int i = 0; i < 24 * 19; i++) {
                double at = (c[i / 19] - turn) * M_PI / 180;
                cd[i] = kind ? 100 * (2 + cos(at)) : 100 * (2 - cos(2 * at)); /* ahead; along the road */
                put(&m, "%g ", cd[i]);
            }
            noc_profile *p = read_made(&m);
            noc_profile_info info;
            noc_profile_get_info(p, &info);
            if (info.street != (kind ? turn : turn % 180))
                fail_msg("%d turned by %d: C %g", kind, turn, info.street);
            noc_profile_destroy(p);
        }
}

/* EULUMDAT's intensities are cd/klm times the conversion factor (line 24). */
static void test_conversion_factor(void **state) {
    static made m;
    m.len = 0;
    put_eulumdat(&m, QUARTERS, 2000, 100);
    char *factor = strstr(m.text, "\n1\n0\n1\n1\nLED\n");
    assert_non_null(factor);
    factor[1] = '3';
    noc_profile *p = read_made(&m);
    for (int i = 0; i < 90; i += 15)
        assert_true(fabs(noc_profile_intensity(p, 2 * i, i) / made_cd(QUARTERS, 2 * i, i) - 3) < 1e-6);
    noc_profile_destroy(p);
}

/* A negative number of lamps: candela, or cd/klm, whichever makes the flux that is stated, or nearly so. */
static void test_absolute_eulumdat(void **state) {
    static made m;
    m.len = 0;
    put(&m, "IESNA91\n");
    put_ies(&m, HALVES, 0, 180, 1);
    noc_profile *p = read_made(&m);
    noc_profile_info info;
    noc_profile_get_info(p, &info);
    double whole = info.lumens; /* of made_cd */
    noc_profile_destroy(p);
    for (int i = 0; i < 5; i++) { /* the last one states a flux that is none */
        double off = i < 2 ? 1 : 1.03, lumens = i < 4 ? whole * off : 1e-320;
        m.len = 0;
        put_eulumdat(&m, HALVES, i % 2 || i == 4 ? 1000 : lumens / off, 100); /* cd, or cd/klm of the lamps */
        char *lamps = strstr(m.text, "\n1\nLED\n"), *rest = strdup(strchr(lamps + 8, '\n'));
        m.len = (size_t)(lamps - m.text);
        put(&m, "\n-1\nLED\n%.9g%s", lumens, rest);
        free(rest);
        p = read_made(&m);
        noc_profile_get_info(p, &info);
        assert_string_equal(info.format, i % 2 || i == 4 ? "EULUMDAT, absolute" : "EULUMDAT, absolute in cd/klm");
        double want = i % 2 || i == 4 ? whole : lumens;
        if (fabs(info.lumens / want - 1) > 1e-5 || (i < 4 && fabs(info.flux_error - (want / lumens - 1)) > 1e-5))
            fail_msg("%d: %g lm, not %g", i, info.lumens, want);
        assert_true(fabs(noc_profile_intensity(p, 15, 40) / made_cd(HALVES, 15, 40) - want / whole) < 1e-5);
        noc_profile_destroy(p);
    }
}

static void test_colours(void **state) {
    static const struct {
        const char *label;
        double kelvin;
    } ies[] = { { "[LAMP] LED 4000K", 4000 },
                { "[LUMINAIRE] Road 38 W 2200 K CRI 70", 2200 },
                { "[_CCT] 3000", 3000 },
                { "[_CCT] 830", 3000 },
                { "[LAMP] 2700K-6500K tunable", 0 },
                { "[LAMP] HPS 250W 28000 LM", 0 },
                { "[LUMCAT] A4000K1", 0 } };
    static const struct {
        const char *type, *colour;
        double kelvin;
    } ldt[] = { { "LED", "3000", 3000 },        { "LED", "4000 K", 4000 }, { "T16 35W", "840", 4000 },
                { "LED 2700K", "1B/80", 2700 }, { "SON-T", "", 0 },        { "LED", "warm white", 0 } };
    static made m;
    noc_profile_info info;
    for (size_t i = 0; i < NOC_COUNT(ies) + NOC_COUNT(ldt); i++) {
        size_t k = i - NOC_COUNT(ies);
        bool labels = i < NOC_COUNT(ies);
        m.len = 0;
        if (labels) {
            put(&m, "IESNA:LM-63-2002\n%s\n", ies[i].label);
            put_ies(&m, ABOUT_AXIS, 0, 0, 1);
        } else {
            put_eulumdat(&m, HALVES, 1000, 100);
            char *lamps = strstr(m.text, "\nLED\n1000\n3000\n"), *rest = strdup(lamps + 14);
            m.len = (size_t)(lamps - m.text);
            put(&m, "\n%s\n1000\n%s%s", ldt[k].type, ldt[k].colour, rest);
            free(rest);
        }
        noc_profile *p = read_made(&m);
        noc_profile_get_info(p, &info);
        if (info.kelvin != (labels ? ies[i].kelvin : ldt[k].kelvin))
            fail_msg("%s: %g K", labels ? ies[i].label : ldt[k].colour, info.kelvin);
        noc_profile_destroy(p);
    }
}

static void test_bad(void **state) {
    static const struct {
        const char *text, *says;
    } bad[] = {
        { "", "neither an IES" },
        { "hello\nworld\n", "neither an IES" },
        { "IESNA:LM-63-2077\nTILT=NONE\n", "bad:3: ends before the number of lamps" },
        { "IESNA:LM-63-2002\n[TEST] x\n", "bad:2: no line of TILT" },
        { "IESNA:LM-63-2002\nTILT=lamp.tlt\n1 1 1\n", "bad:2: its tilt factors are in a file" },
        { "IESNA91\nTILT=NONE\n1 -1 1\n2 1 1 2 0\n", "ends before the length" },
        { "IESNA91\nTILT=NONE\n1 -1 one 2 1 1 2 0 0 0 1 1 1\n", "bad:3: the multiplier is no number: \"one\"" },
        { "IESNA91\nTILT=NONE\n1 -1 0 2 1 1 2 0 0 0 1 1 1\n", "bad:3: a multiplier of 0" },
        { "IESNA91\nTILT=NONE\n1 -1 1 2 1 4 2 0 0 0 1 1 1\n", "bad:3: the photometric type must be" },
        { "IESNA91\nTILT=NONE\n1 -1 1 2 1 1 2 0 0 0\n1 1 1\n0 90\n0\n100\n", "ends before an intensity" },
        { "IESNA91\nTILT=NONE\n1 -1 1 2 1 1 2 0 0 0\n1 1 1\n0 90\n0\n100\n-5\n", "bad:8: an intensity is negative" },
        { "IESNA91\nTILT=NONE\n1 -1 1 2 1 1 2 0 0 0\n1 1 1\n0 0\n0\n1 1\n", "bad:5: vertical angles do not ascend" },
        { "IESNA91\nTILT=NONE\n1 -1 1 3 1 1 2 0 0 0\n1 1 1\n0 1e-320 90\n0\n1 1 1\n",
          "two vertical angles are nearly" },
        { "IESNA91\nTILT=NONE\n1 -1 1 3600 3600 1 2 0 0 0\n1 1 1\n0 90\n", "and 4194304 values" },
        { "IESNA91\nTILT=NONE\n1 -1 1 2 2 1 2 0 0 0\n1 1 1\n0 90\n0 45\n1 1 1 1\n", "horizontal angles do not go" },
        { "IESNA91\nTILT=NONE\n1 -1 1 2 1 1 2 0 0 0\n1 1 1\n0 90\n0\n0 0\n", "sends no light" },
        { "IESNA91\nTILT=NONE\n1 -1 1 2 1 1 2 0 0 0\n1 1 1\n0 90\n0\n1e-320 1e-320\n", "sends no light" },
        { "IESNA91\nTILT=NONE\n1 -1 1 4000 4000 1 2 0 0 0\n1 1 1\n0 90\n", "planes of 4000 angles" },
        { "a\n1\n1\n1\n0\n2\n90\n", "bad:7: ends before" },
        { "a\n1\n3\n6\n0\n2\n0\n", "bad:7: ends before" },
    };
    for (size_t i = 0; i < NOC_COUNT(bad); i++) {
        noc_log *log = counting_log();
        noc_profile *p = (noc_profile *)log;
        refusing = (refusal){ 0 };
        noc_status status = noc_profile_read(log, bad[i].text, strlen(bad[i].text), "bad", &p);
        if (!status || p || refusing.errors != 1 || !strstr(refusing.first_error, bad[i].says))
            fail_msg("%zu: status %d, %d errors: \"%s\", not \"%s\"", i, (int)status, refusing.errors,
                     refusing.first_error, bad[i].says);
        noc_log_destroy(log);
    }
}

static void test_bad_eulumdat(void **state) {
    static made m;
    static const struct {
        int line;
        const char *text, *says;
    } bad[] = { { 3, "5", "neither an IES" },
                { 4, "23", "cannot have symmetry 3" },
                { 24, "0", "conversion factor of 0" },
                { 26, "none", "bad:26: the number of lamp sets is no number" },
                { 29, "0", "lamps of 0 lm" },
                { 44, "x", "bad:44: a C angle is no number" },
                { 300, "-1", "bad:300: an intensity is negative" } };
    for (size_t i = 0; i < NOC_COUNT(bad); i++) {
        m.len = 0;
        put_eulumdat(&m, HALVES_ACROSS, 1000, 100);
        char *at = m.text;
        for (int line = 1; line < bad[i].line; line++)
            at = strchr(at, '\n') + 1;
        char *rest = strdup(strchr(at, '\n'));
        m.len = (size_t)(at - m.text);
        put(&m, "%s%s", bad[i].text, rest);
        free(rest);
        noc_log *log = counting_log();
        noc_profile *p = NULL;
        refusing = (refusal){ 0 };
        assert_int_not_equal(noc_profile_read(log, m.text, m.len, "bad", &p), NOC_OK);
        assert_null(p);
        if (refusing.errors != 1 || !strstr(refusing.first_error, bad[i].says))
            fail_msg("line %d: \"%s\", not \"%s\"", bad[i].line, refusing.first_error, bad[i].says);
        noc_log_destroy(log);
    }
}

static void test_memory(void **state) {
    static made m[2];
    bool reached;
    m[0].len = m[1].len = 0;
    put(&m[0], "IESNA91\n[LAMP] x\n");
    put_ies(&m[0], HALVES, 0, 180, 1);
    put_eulumdat(&m[1], HALVES, 1000, 3000);
    for (int i = 0; i < 2; i++)
        FOR_EACH_REFUSAL(reached) {
            noc_log *log = counting_log();
            noc_profile *p = NULL;
            begin_refusal(n, later);
            noc_status status = noc_profile_read(log, m[i].text, m[i].len, "made", &p);
            reached = end_refusal();
            if (reached && status)
                assert_refused(status, "profile");
            else
                assert_unharmed(p != NULL, "profile");
            noc_profile_destroy(p);
            noc_log_destroy(log);
        }
}

static void test_numbers(void **state) {
    const double c[] = { 0, 90 }, gamma[] = { 0, 45, 90 }, cd[] = { 1, 2, 3, 4, 5, 6 };
    noc_profile_params params = { "mine", 2, 3, c, gamma, cd, 90 };
    noc_profile *p = NULL;
    noc_profile_info info;
    assert_int_equal(noc_profile_create(NULL, &params, &p), NOC_OK);
    assert_true(noc_profile_intensity(p, 270, 45) == 5 && noc_profile_intensity(p, 180, 90) == 3);
    assert_true(fabs(noc_profile_intensity(p, -45, 22.5) - 3) < 1e-12 && noc_profile_intensity(p, 0, 90.01) == 0);
    noc_profile_get_info(p, &info);
    assert_true(info.street == 90 && info.c_count == 4);
    double half = noc_profile_flux(p, 0, 90, 280), back = info.back.low;
    for (int turn = -5; turn <= 5; turn++) { /* a direction is the same after any turns */
        assert_true(fabs(noc_profile_flux(p, 0, 90, 280 + 360 * turn) - half) < 1e-9);
        params.street = 90 + 360 * turn;
        noc_profile_destroy(p);
        assert_int_equal(noc_profile_create(NULL, &params, &p), NOC_OK);
        noc_profile_get_info(p, &info);
        assert_true(info.street == 90 && fabs(info.back.low - back) < 1e-9);
    }
    noc_profile_destroy(p);
    for (int i = 0; i < 2; i++) {
        params.street = i ? INFINITY : NAN;
        assert_int_equal(noc_profile_create(NULL, &params, &p), NOC_ERR_ARGUMENT);
    }
    params.planes = 0;
    assert_int_equal(noc_profile_create(NULL, &params, &p), NOC_ERR_ARGUMENT);
    assert_null(p);
}

/* The regular table meets the file's angles, sends a lumen, and nothing beyond the horizon where the file does not. */
static void test_table(void **state) {
    static made m;
    photometry_table t;
    for (int s = 0; s < SYMMETRIES; s++) {
        m.len = 0;
        put(&m, "IESNA91\n");
        put_ies(&m, s, first[s], last[s], 1);
        noc_profile *p = read_made(&m);
        noc_profile_info info;
        noc_profile_get_info(p, &info);
        assert_int_equal(photometry_table_make(&t, p, NULL), NOC_OK);
        assert_true(t.rows == 36 && t.columns == (s == ABOUT_AXIS ? 1 : 24) && t.gamma_max == 180 && t.upward);
        for (int r = 0; r < t.rows; r++)
            for (int i = 0; i < t.columns; i++)
                for (int k = 0; k < 4; k++) {
                    double want = made_cd(s, 15 * (i + k % 2), 5 * (r + k / 2));
                    assert_true(fabs(t.cells.data[4 * (r * t.columns + i) + k] * info.lumens / want - 1) < 1e-5);
                }
        photometry_table_free(&t);
        noc_profile_destroy(p);
    }
}

/* Light goes on to the first angle without any, beyond the horizon, too, and begins at the file's first angle. Fluxes
 * by hand: of 1 cd up to 60 degrees that falls to 0 at 180, 2 pi (1/2 + (sin u - u cos u) / u) with u = 2 pi / 3. */
static void test_table_ends(void **state) {
    const double zero = 0, u = 2 * M_PI / 3, beyond = 2 * M_PI * (.5 + (sin(u) - u * cos(u)) / u);
    static const struct {
        double gamma[5], cd[5];
        int gammas, rows;
        double last, at, cd_at, lumens;
        bool upward;
    } cases[] = {
        { { 0, 60, 180 }, { 1, 1, 0 }, 3, 3, 180, 120, .5, 0, true },
        { { 0, 30, 85, 95, 180 }, { 3, 3, 2, 0, 0 }, 5, 19, 95, 90, 1, NAN, true },
        { { 0, 30, 60, 90, 180 }, { 1, 1, 1, 0, 0 }, 5, 3, 90, 60, 1, NAN, false },
        { { 0, 45, 60 }, { 1, 1, 1 }, 3, 4, 60, 45, 1, M_PI, false },
        { { 90, 135, 180 }, { 1, 1, 1 }, 3, 4, 180, 135, 1, 2 * M_PI, true },
    };
    for (size_t i = 0; i < NOC_COUNT(cases); i++) {
        noc_profile *p = NULL;
        photometry_table t;
        noc_profile_params params = { NULL, 1, cases[i].gammas, &zero, cases[i].gamma, cases[i].cd, 0 };
        assert_int_equal(noc_profile_create(NULL, &params, &p), NOC_OK);
        assert_int_equal(photometry_table_make(&t, p, NULL), NOC_OK);
        if (t.gamma_max != cases[i].last || t.upward != cases[i].upward || t.rows != cases[i].rows)
            fail_msg("%zu: %d rows to %g degrees", i, t.rows, t.gamma_max);
        noc_profile_info info;
        noc_profile_get_info(p, &info);
        double lumens = isnan(cases[i].lumens) ? info.lumens : cases[i].lumens > 0 ? cases[i].lumens : beyond;
        int row = (int)lround(cases[i].at / t.gamma_max * t.rows);
        float upper = t.cells.data[4 * (row - 1) + 2], lower = row < t.rows ? t.cells.data[4 * row] : upper;
        assert_true(fabs(lower * lumens / cases[i].cd_at - 1) < 1e-6);
        if (fabs(upper * lumens / cases[i].cd_at - 1) > 1e-6)
            fail_msg("%zu: %g, not %g", i, upper * lumens, cases[i].cd_at);
        if (cases[i].gamma[0] > 0) /* none below */
            assert_true(t.cells.data[4 + 2] == 0 && t.cells.data[4 * 2] > 0);
        photometry_table_free(&t);
        noc_profile_destroy(p);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ies_symmetries),
        cmocka_unit_test(test_eulumdat_symmetries),
        cmocka_unit_test(test_editions),
        cmocka_unit_test(test_headers),
        cmocka_unit_test(test_factors),
        cmocka_unit_test(test_conversion_factor),
        cmocka_unit_test(test_absolute_eulumdat),
        cmocka_unit_test(test_colours),
        cmocka_unit_test(test_types),
        cmocka_unit_test(test_own_angles),
        cmocka_unit_test(test_own_table),
        cmocka_unit_test(test_street),
        cmocka_unit_test(test_street_turned),
        cmocka_unit_test(test_bad),
        cmocka_unit_test(test_bad_eulumdat),
        cmocka_unit_test(test_memory),
        cmocka_unit_test(test_numbers),
        cmocka_unit_test(test_table),
        cmocka_unit_test(test_table_ends),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
