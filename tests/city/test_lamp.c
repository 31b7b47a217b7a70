/* Lamps: flux and colour in closed form, standing on the ground, shapes. */
#include "lamp_scene.h"

#include "../core/no_profiles.h"
#include "core/shadow.h"

static double luminance_of(const float e[3]) { return 0.2126 * e[0] + 0.7152 * e[1] + 0.0722 * e[2]; }

/* Lumens that a light of the scene gives off. */
static double flux(const noc_light_record *l) {
    double area = l->kind == NOC_LIGHT_SPHERE ? 4 * M_PI * l->radius * l->radius : M_PI * l->radius * l->radius;
    return M_PI * luminance_of(l->e) * area;
}

static size_t issues_with(const geo_issues *issues, const char *text) {
    size_t sum = 0;
    for (size_t i = 0; i < geo_issues_count(issues); i++) {
        const char *reason, *examples;
        bool repaired;
        size_t count;
        assert_true(geo_issues_get(issues, i, &reason, &repaired, &count, &examples));
        sum += strstr(reason, text) ? count : 0;
    }
    return sum;
}

/* xy of linear Rec.709. */
static void chromaticity(const float c[3], double xy[2]) {
    double X = 0.4124564 * c[0] + 0.3575761 * c[1] + 0.1804375 * c[2];
    double Y = 0.2126729 * c[0] + 0.7151522 * c[1] + 0.0721750 * c[2];
    double Z = 0.0193339 * c[0] + 0.1191920 * c[1] + 0.9503041 * c[2];
    xy[0] = X / (X + Y + Z);
    xy[1] = Y / (X + Y + Z);
}

static void test_kelvin(void **state) {
    /* black body chromaticities, CIE 1931 (CIE 15: illuminant A is 2856 K) */
    static const double table[][3] = {
        { 2856, .4476, .4074 }, { 4000, .3805, .3768 }, { 6500, .3135, .3237 }, { 10000, .2807, .2884 }
    };
    for (size_t i = 0; i < NOC_COUNT(table); i++) {
        float rgb[3];
        double xy[2];
        noc_kelvin_rgb(table[i][0], rgb);
        chromaticity(rgb, xy);
        assert_float_equal(xy[0], table[i][1], .002);
        assert_float_equal(xy[1], table[i][2], .002);
        assert_float_equal(luminance_of(rgb), 1, 1e-5);
    }
    for (double k = -1000; k < 1e6; k += 333) { /* anything gives a colour */
        float rgb[3];
        noc_kelvin_rgb(k, rgb);
        assert_true(rgb[0] >= 0 && rgb[1] >= 0 && rgb[2] >= 0);
        assert_float_equal(luminance_of(rgb), 1, 1e-4);
    }
}

static void test_kelvin_back(void **state) {
    static const float none[][3] = {
        { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 1, 0, 1 }, { NAN, 1, 1 }, { -1, -1, -1 }
    };
    for (double k = 1950; k < 15000; k += 350) {
        float rgb[3];
        noc_kelvin_rgb(k, rgb);
        for (int i = 0; i < 3; i++)
            rgb[i] *= 73;
        assert_float_equal(noc_rgb_kelvin(rgb), k, k * 1e-3);
    }
    for (size_t i = 0; i < NOC_COUNT(none); i++)
        assert_true(isnan(noc_rgb_kelvin(none[i])));
}

/* What a lamp tells, by itself or by its source, is no assumption. */
static void test_assumes(void **state) {
    geo_lamp l = lamp_at(0, 0);
    for (int what = 0; what < NOC_LAMP_DEFAULT_COUNT; what++)
        assert_int_equal(city_lamp_assumes(&l, (noc_lamp_default)what), what < NOC_LAMP_DIRECTION);
    l.height = 4;
    assert_false(city_lamp_assumes(&l, NOC_LAMP_HEIGHT));
    l.watts = 50;
    assert_false(city_lamp_assumes(&l, NOC_LAMP_FLUX));
    assert_true(city_lamp_assumes(&l, NOC_LAMP_EFFICACY)); /* its source is not known */
    geo_fitting f = geo_no_fitting();
    l.fitting = &f;
    f.efficacy = 100;
    assert_false(city_lamp_assumes(&l, NOC_LAMP_EFFICACY));
    f = geo_no_fitting();
    f.file_lumens = 5000;
    assert_true(city_lamp_assumes(&l, NOC_LAMP_EFFICACY));
    f.flux = NOC_FLUX_FILE;
    assert_false(city_lamp_assumes(&l, NOC_LAMP_EFFICACY));
    f.flux = NOC_FLUX_ANY;
    f.file_watts = 45;
    assert_false(city_lamp_assumes(&l, NOC_LAMP_EFFICACY));
    l.fitting = NULL;
    l.lumens = 4000;
    assert_false(city_lamp_assumes(&l, NOC_LAMP_EFFICACY));
    l.lumens = NAN;
    l.source = GEO_SOURCE_LED; /* white of any kind */
    assert_false(city_lamp_assumes(&l, NOC_LAMP_EFFICACY));
    assert_true(city_lamp_assumes(&l, NOC_LAMP_COLOUR));
    l.source = GEO_SOURCE_LOW_SODIUM;
    assert_false(city_lamp_assumes(&l, NOC_LAMP_COLOUR));
    l = lamp_at(0, 0);
    l.source = GEO_SOURCE_GAS;
    assert_false(city_lamp_assumes(&l, NOC_LAMP_FLUX));
    l = lamp_at(0, 0);
    l.kelvin = 2700;
    l.body_heads = 1; /* a body has its height */
    assert_false(city_lamp_assumes(&l, NOC_LAMP_COLOUR) || city_lamp_assumes(&l, NOC_LAMP_HEIGHT));
    assert_true(city_lamp_assumes(&l, NOC_LAMP_FLUX));
}

/* With profiles each light has its lamp's lumens exactly, by what kind of lamp it is, and looks across the road. */
static void test_profiles(void **state) {
    noc_scene *scene = noc_scene_create(NULL);
    add_plane(scene, NOC_CLASS_ROAD, -40, 2, 40, 8, 0, 0);
    add_plane(scene, NOC_CLASS_GREEN, -40, -8, 40, 2, 0, 0);
    noc_status status;
    city_profiles *profiles = city_profiles_create(scene, NULL, &status);
    assert_non_null(profiles);
    city_lamp_params params = defaults;
    params.profiles = profiles;
    geo_lamp lamp[4];
    for (int i = 0; i < 4; i++) {
        lamp[i] = lamp_at(-15 + 10 * i, 0);
        lamp[i].lumens = 3000 + 1000 * i;
    }
    lamp[1].type = GEO_LAMP_LANTERN;
    lamp[2].type = GEO_LAMP_FLOOD;
    lamp[3].height = 1;
    for (int i = 0; i < 4; i++)
        assert_int_equal(city_add_lamp(scene, &lamp[i], &params, false, NULL), 1);
    char text[160];
    city_profiles_tell(profiles, text, sizeof(text));
    assert_string_equal(text, "cobra-head 1, post-top 1, flood 1, bollard 1");
    assert_int_equal(noc_scene_commit(scene), NOC_OK);
    for (size_t i = 0; i < 4; i++) {
        noc_light_info info;
        assert_int_equal(noc_scene_get_light(scene, i, &info), NOC_OK);
        assert_float_equal(info.lumens, lamp[i].lumens, 1e-6 * lamp[i].lumens);
        assert_true(info.light.profile == (int)i + 1);
        if (i != 2) { /* C 0 looks at the road, the axis down */
            assert_float_equal(info.light.c0[1], 1, 1e-3);
            assert_float_equal(info.light.direction[2], -1, 1e-6);
        }
    }
    assert_true(scene->lights.data[0].flags & LIGHT_PROFILE_BITS && !(scene->lights.data[0].flags & LIGHT_TWO_SIDED));
    city_profiles_destroy(profiles);
    assert_null(city_profiles_create(scene, "/no/such/file.ies", &status));
    assert_int_equal(status, NOC_ERR_IO);
    noc_scene_destroy(scene);
}

static void test_flux(void **state) {
    noc_scene *scene = noc_scene_create(NULL);
    add_plane(scene, NOC_CLASS_TERRAIN, -100, -100, 100, 100, 5, 0);
    geo_lamp l = lamp_at(0, 0);
    assert_int_equal(city_add_lamp(scene, &l, &defaults, false, NULL), 1); /* the parameter's lumens, a disc */
    l = lamp_at(20, 0);
    l.type = GEO_LAMP_LANTERN;
    l.lumens = 1200;
    l.height = 4;
    assert_int_equal(city_add_lamp(scene, &l, &defaults, false, NULL), 1); /* tagged lumens, a sphere */
    l = lamp_at(40, 0);
    l.source = GEO_SOURCE_LED;
    l.watts = 50;
    l.count = 3;
    l.height = 9;
    assert_int_equal(city_add_lamp(scene, &l, &defaults, true, NULL), 3); /* watts, each head */
    l = lamp_at(60, 0);
    l.type = GEO_LAMP_FLOOD;
    l.direction = 90;
    l.lumens = 20000;
    assert_int_equal(city_add_lamp(scene, &l, &defaults, false, NULL), 1);
    l = lamp_at(80, 0);
    l.height = 0.9;
    assert_int_equal(city_add_lamp(scene, &l, &defaults, false, NULL), 1); /* a bollard */
    l = lamp_at(100, 0);
    l.height = 0.9;
    l.lumens = 2400;
    assert_int_equal(city_add_lamp(scene, &l, &defaults, false, NULL), 1); /* that tells its flux */
    static const double expected[] = { 5000, 1200, 5500, 5500, 5500, 20000, CITY_BOLLARD_LUMENS, 2400 };
    assert_int_equal(scene->lights.len, NOC_COUNT(expected));
    for (size_t i = 0; i < scene->lights.len; i++)
        assert_float_equal(flux(&scene->lights.data[i]) / expected[i], 1, 1e-4);
    const noc_light_record *r = scene->lights.data;
    assert_int_equal(r[0].kind, NOC_LIGHT_DISC);
    assert_float_equal(r[0].p[2], 11, 1e-4); /* ground 5 + height 6 */
    assert_int_equal(r[1].kind, NOC_LIGHT_SPHERE);
    assert_float_equal(r[1].p[0], 20, 1e-4);
    assert_float_equal(r[1].p[2], 9, 1e-4);
    for (int i = 2; i < 5; i++)
        assert_true(r[i].flags & NOC_LIGHT_INFERRED);
    assert_float_equal(r[2].p[0] + r[3].p[0] + r[4].p[0], 120, 1e-3); /* evenly around the pole */
    /* the flood faces east and down: its normal is a x b */
    double nx = r[5].a[1] * r[5].b[2] - r[5].a[2] * r[5].b[1], nz = r[5].a[0] * r[5].b[1] - r[5].a[1] * r[5].b[0];
    assert_true(nx > 0 && nz < 0);
    noc_scene_destroy(scene);
}

static void test_direction_and_sources(void **state) {
    noc_scene *scene = noc_scene_create(NULL);
    add_plane(scene, NOC_CLASS_SIDEWALK, -50, -50, 50, 0, 0, 0);
    add_plane(scene, NOC_CLASS_ROAD, -50, 0, 50, 8, -.1, 0);
    geo_lamp l = lamp_at(0, -1); /* untagged: over the road, north of it */
    l.source = GEO_SOURCE_SODIUM;
    assert_int_equal(city_add_lamp(scene, &l, &defaults, false, NULL), 1);
    l = lamp_at(20, -1);
    l.direction = 180; /* tagged: away from it */
    l.kelvin = 6500;
    assert_int_equal(city_add_lamp(scene, &l, &defaults, false, NULL), 1);
    l = lamp_at(-20, -1);
    l.rgb[0] = 0;
    l.rgb[1] = 0;
    l.rgb[2] = 1;
    assert_int_equal(city_add_lamp(scene, &l, &defaults, false, NULL), 1);
    const noc_light_record *r = scene->lights.data;
    assert_true(r[0].p[1] > -.5 && r[1].p[1] < -1.5);
    assert_true(r[0].e[0] > 2 * r[0].e[2]);           /* sodium is orange */
    assert_float_equal(r[1].e[0] / r[1].e[2], 1, .1); /* 6500 K is white */
    assert_true(r[2].e[2] > 0 && r[2].e[0] == 0);
    for (int i = 0; i < 3; i++)
        assert_float_equal(flux(&r[i]) / 5000, 1, 1e-4);
    noc_scene_destroy(scene);
}

/* Lumens that `watts` of a source become: the middle of the lamp's range times 0.75, told in docs/formats.md. Low
 * pressure sodium (100..180 lm/W) is not high pressure sodium (70..140). */
static void test_efficacies(void **state) {
    static const struct {
        int source;
        double lumens_per_watt;
    } table[] = { { GEO_SOURCE_UNKNOWN, 80 },
                  { GEO_SOURCE_LED, 110 },
                  { GEO_SOURCE_SODIUM, .75 * (70 + 140) / 2 },
                  { GEO_SOURCE_LOW_SODIUM, .75 * (100 + 180) / 2 },
                  { GEO_SOURCE_MERCURY, .75 * (35 + 60) / 2 },
                  { GEO_SOURCE_METAL_HALIDE, .75 * (65 + 115) / 2 },
                  { GEO_SOURCE_FLUORESCENT, .75 * (50 + 100) / 2 },
                  { GEO_SOURCE_INCANDESCENT, .75 * (10 + 20) / 2 },
                  { GEO_SOURCE_GAS, 1.5 } };
    noc_scene *scene = noc_scene_create(NULL);
    add_plane(scene, NOC_CLASS_TERRAIN, -100, -100, 400, 100, 0, 0);
    for (size_t i = 0; i < NOC_COUNT(table); i++) {
        geo_lamp l = lamp_at(20 * (double)i, 0);
        l.source = table[i].source;
        l.watts = 55;
        l.kelvin = 1800; /* a line has no temperature */
        assert_int_equal(city_add_lamp(scene, &l, &defaults, false, NULL), 1);
        const noc_light_record *r = &scene->lights.data[i];
        assert_float_equal(flux(r) / 55, table[i].lumens_per_watt, .025 * table[i].lumens_per_watt);
        if (l.source == GEO_SOURCE_LOW_SODIUM) {
            assert_true(r->e[2] == 0);
            assert_float_equal(r->e[0] / r->e[1], 2.73 / .588, 1e-3); /* 589 nm in Rec.709 */
        }
    }
    noc_scene_destroy(scene);
}

static bool ray_hits(const noc_scene *scene, const double o[3], const double d[3], double reach) {
    double v[3][3];
    uint32_t shown;
    for (size_t t = 0; standing_triangle(scene, t, v, &shown); t++) {
        double e1[3], e2[3], p[3], s[3], q[3];
        for (int k = 0; k < 3; k++) {
            e1[k] = v[1][k] - v[0][k];
            e2[k] = v[2][k] - v[0][k];
            s[k] = o[k] - v[0][k];
        }
        for (int k = 0; k < 3; k++)
            p[k] = d[(k + 1) % 3] * e2[(k + 2) % 3] - d[(k + 2) % 3] * e2[(k + 1) % 3];
        double det = e1[0] * p[0] + e1[1] * p[1] + e1[2] * p[2];
        if (fabs(det) < 1e-14)
            continue;
        double u = (s[0] * p[0] + s[1] * p[1] + s[2] * p[2]) / det;
        for (int k = 0; k < 3; k++)
            q[k] = s[(k + 1) % 3] * e1[(k + 2) % 3] - s[(k + 2) % 3] * e1[(k + 1) % 3];
        double w = (d[0] * q[0] + d[1] * q[1] + d[2] * q[2]) / det,
               x = (e2[0] * q[0] + e2[1] * q[1] + e2[2] * q[2]) / det;
        if (u >= 0 && w >= 0 && u + w <= 1 && x > 1e-3 && x < reach && shown == NOC_NO_LIGHT)
            return true;
    }
    return false;
}

/* Points of the ground around a lamp see it: its housing never stands before it, its pole only to a sliver. */
static void test_own_shape_does_not_shadow(void **state) {
    for (int kind = 0; kind < 3; kind++)
        for (int heads = 1; heads <= 4; heads++) {
            noc_scene *scene = noc_scene_create(NULL);
            geo_lamp l = lamp_at(0, 0);
            l.xyz[2] = 0;
            l.type = kind == 0 ? GEO_LAMP_STREET : kind == 1 ? GEO_LAMP_LANTERN : GEO_LAMP_FLOOD;
            l.count = heads;
            l.direction = 30;
            assert_int_equal(city_add_lamp(scene, &l, &defaults, false, NULL), heads);
            size_t rays = 0, blocked = 0;
            const noc_light_record *r = scene->lights.data;
            double n[3];
            for (int k = 0; k < 3; k++)
                n[k] = r->a[(k + 1) % 3] * r->b[(k + 2) % 3] - r->a[(k + 2) % 3] * r->b[(k + 1) % 3];
            for (int i = 0; i < 400; i++) {
                double a = 2 * M_PI * (i % 40) / 40, distance = 2 + i / 40;
                double d[3] = { distance * sin(a) - r->p[0], distance * cos(a) - r->p[1], -r->p[2] };
                if (r->kind == NOC_LIGHT_DISC && d[0] * n[0] + d[1] * n[1] + d[2] * n[2] <= 0)
                    continue;
                double len = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]), o[3];
                double start = r->kind == NOC_LIGHT_SPHERE ? r->radius : 0;
                for (int k = 0; k < 3; k++) {
                    d[k] /= len;
                    o[k] = r->p[k] + start * d[k];
                }
                rays++;
                blocked += ray_hits(scene, o, d, len - start - 1e-3);
            }
            assert_true(rays > 100);
            assert_true(blocked * 100 <= rays * (heads == 1 ? 4 : 8));
            noc_scene_info info;
            noc_scene_get_info(scene, &info);
            if (heads == 1 && kind == 0)
                assert_true(info.triangles <= 60);
            noc_scene_destroy(scene);
        }
}

static void test_inside_building(void **state) {
    noc_scene *scene = noc_scene_create(NULL);
    geo_issues *issues = geo_issues_create();
    add_plane(scene, NOC_CLASS_TERRAIN, -100, -100, 100, 100, 0, 0);
    add_building(scene, 0, 0, 30, 30, 0, 12);
    geo_lamp l = lamp_at(1, 15); /* a metre inside the western wall */
    assert_int_equal(city_add_lamp(scene, &l, &defaults, false, issues), 1);
    assert_true(scene->lights.data[0].p[0] < 0);
    l.xyz[1] = 20;
    l.mount = GEO_MOUNT_WALL;
    l.height = 4;
    assert_int_equal(city_add_lamp(scene, &l, &defaults, false, issues), 1);
    assert_true(scene->lights.data[1].p[0] < 0 && scene->lights.data[1].p[0] > -1.5);
    assert_int_equal(issues_with(issues, "moved out"), 2);
    l = lamp_at(15, 15); /* in its middle */
    assert_int_equal(city_add_lamp(scene, &l, &defaults, false, issues), 0);
    assert_int_equal(issues_with(issues, "further than 3 m"), 1);
    l = lamp_at(NAN, 0);
    assert_int_equal(city_add_lamp(scene, &l, &defaults, false, issues), 0);
    geo_issues_destroy(issues);
    noc_scene_destroy(scene);
}

static void test_odd_grounds(void **state) {
    noc_scene *scene = noc_scene_create(NULL);
    geo_issues *issues = geo_issues_create();
    add_plane(scene, NOC_CLASS_TERRAIN, -10, -10, 10, 10, 100, .1);
    geo_lamp l = lamp_at(5, 0);
    l.xyz[2] = 350; /* another height system: the ground counts */
    assert_int_equal(city_add_lamp(scene, &l, &defaults, false, issues), 1);
    assert_float_equal(scene->lights.data[0].p[2], 106.5, 1e-3);
    l = lamp_at(12, 0); /* two metres beside it */
    assert_int_equal(city_add_lamp(scene, &l, &defaults, false, issues), 1);
    assert_float_equal(scene->lights.data[1].p[2], 107, .1);
    l = lamp_at(50, 0);
    l.xyz[2] = 98;
    assert_int_equal(city_add_lamp(scene, &l, &defaults, false, issues), 1);
    assert_float_equal(scene->lights.data[2].p[2], 104, 1e-3);
    assert_int_equal(geo_issues_count(issues), 1); /* the first is told of */
    assert_int_equal(issues_with(issues, "elevation is more than 3 m off the ground"), 1);
    l = lamp_at(70, 0);
    assert_int_equal(city_add_lamp(scene, &l, &defaults, false, issues), 1);
    assert_int_equal(issues_with(issues, "height of the nearest"), 1);
    assert_float_equal(scene->lights.data[3].p[2], 107, .5); /* near the rim, 60 m off */
    for (int i = 0; i < 3; i++) {                            /* three at one place stand side by side */
        l = lamp_at(-5, -5);
        assert_int_equal(city_add_lamp(scene, &l, &defaults, false, issues), 1);
    }
    assert_int_equal(issues_with(issues, "moved apart"), 2);
    geo_issues_destroy(issues);
    noc_scene_destroy(scene);
}

/* Inventories have a row a luminaire: lamps at one point, or under the arm of another, stand on what carries the first
 * one. */
static void test_lamps_do_not_stand_on_lamps(void **state) {
    enum { LAMPS = 40 };
    /* the last: beside all ground */
    static const noc_class grounds[] = { NOC_CLASS_OTHER, NOC_CLASS_TERRAIN, NOC_CLASS_COUNT };
    (void)state;
    for (size_t g = 0; g < NOC_COUNT(grounds); g++) {
        noc_scene *scene = noc_scene_create(NULL);
        bool beside = grounds[g] == NOC_CLASS_COUNT;
        add_plane(scene, beside ? NOC_CLASS_TERRAIN : grounds[g], beside ? 50 : -50, -50, 150, 50, 3, 0);
        for (int i = 0; i < LAMPS; i++) {
            geo_lamp l = lamp_at(i % 4 ? 0 : .3 * (i / 4), 0); /* some along the first one's arm */
            l.direction = 90;
            assert_int_equal(city_add_lamp(scene, &l, &defaults, false, NULL), 1);
        }
        for (int i = 0; i < LAMPS; i++)
            assert_float_equal(scene->lights.data[i].p[2], 3 + defaults.height, 1e-4);
        noc_scene_destroy(scene);
    }
}

/* However many lamps are given at one point: all shine, and what stands there, which each next one meets, is no more
 * than of a few. */
static void test_lamps_at_one_point(void **state) {
    enum { LAMPS = 600 };
    (void)state;
    noc_scene *scene = noc_scene_create(NULL);
    geo_issues *issues = geo_issues_create();
    geo_lamp l = lamp_at(0, 0);
    add_plane(scene, NOC_CLASS_TERRAIN, -50, -50, 50, 50, 0, 0);
    for (int i = 0; i < LAMPS; i++)
        assert_int_equal(city_add_lamp(scene, &l, &defaults, false, issues), 1);
    assert_int_equal(scene->lights.len, LAMPS);
    for (size_t i = 0; i < LAMPS; i++)
        assert_float_equal(flux(&scene->lights.data[i]), defaults.lumens, 1);
    size_t apart = issues_with(issues, "moved apart"), crowded = issues_with(issues, "leave no room");
    assert_int_equal(1 + apart + crowded, LAMPS);
    assert_in_range(apart, 1, 8);
    size_t places = 0;
    for (size_t i = 0; i < LAMPS; i++) {
        bool again = false;
        for (size_t k = 0; k < i && !again; k++)
            again = scene->lights.data[i].p[0] == scene->lights.data[k].p[0] &&
                    scene->lights.data[i].p[1] == scene->lights.data[k].p[1];
        places += !again;
    }
    assert_int_equal(places, 1 + apart); /* as the report says of the others: in the same place as theirs */
    assert_int_equal(issues_with(issues, "its light in the same place as theirs"), crowded);
    for (size_t i = 0; i < geo_issues_count(issues); i++) { /* a pole that is missing does not pass --strict */
        const char *reason, *examples;
        bool repaired;
        size_t count;
        assert_true(geo_issues_get(issues, i, &reason, &repaired, &count, &examples));
        assert_int_equal(geo_issues_kind(issues, i), strstr(reason, "leave no room") ? GEO_GUESSED : GEO_REPAIRED);
    }
    assert_true(noc_ground_load(scene, 0, 0) < 200);
    geo_issues_destroy(issues);
    noc_scene_destroy(scene);
}

/* Lamps without ground near them do not sink with each other's feet, in a scene with a ground far off and without any.
 */
static void test_no_ground(void **state) {
    (void)state;
    for (int with_ground = 0; with_ground < 2; with_ground++) {
        noc_scene *scene = noc_scene_create(NULL);
        geo_issues *issues = geo_issues_create();
        if (with_ground)
            add_plane(scene, NOC_CLASS_ROAD, -5, -5, 5, 5, 30, 0);
        for (int i = 0; i < 1000; i++) {
            geo_lamp l = lamp_at(20 + 7 * (i % 40), 20 + 7 * (double)(i / 40));
            assert_int_equal(city_add_lamp(scene, &l, &defaults, false, issues), 1);
            assert_float_equal(scene->lights.data[i].p[2], (with_ground ? 30 : 0) + 6, 1e-3);
        }
        geo_issues_destroy(issues);
        noc_scene_destroy(scene);
    }
}

/* Whether a ray meets a triangle of the scene's meshes within `far` m. */
static bool is_blocked(const noc_scene *s, const double o[3], const double d[3], double far) {
    double v[3][3];
    uint32_t shown;
    for (size_t t = 0; standing_triangle(s, t, v, &shown); t++) {
        double e[2][3], p[3], q[3], u = 0, w = 0, det = 0, at = 0;
        for (int k = 0; k < 3; k++) {
            e[0][k] = v[1][k] - v[0][k];
            e[1][k] = v[2][k] - v[0][k];
        }
        for (int k = 0; k < 3; k++)
            p[k] = d[(k + 1) % 3] * e[1][(k + 2) % 3] - d[(k + 2) % 3] * e[1][(k + 1) % 3];
        for (int k = 0; k < 3; k++)
            det += e[0][k] * p[k];
        if (fabs(det) < 1e-15)
            continue;
        for (int k = 0; k < 3; k++) {
            double k1 = o[(k + 1) % 3] - v[0][(k + 1) % 3], k2 = o[(k + 2) % 3] - v[0][(k + 2) % 3];
            u += (o[k] - v[0][k]) * p[k] / det;
            q[k] = k1 * e[0][(k + 2) % 3] - k2 * e[0][(k + 1) % 3];
        }
        for (int k = 0; k < 3; k++) {
            w += d[k] * q[k] / det;
            at += e[1][k] * q[k] / det;
        }
        if (u >= 0 && w >= 0 && u + w <= 1 && at > 1e-4 && at < far)
            return true;
    }
    return false;
}

/* Whatever rules say, a light that hangs beside a pole does not lie in it: four fifths of its light leave (the pole
 * casts a shadow), by rays from its disc (all over it, by the cosine) or its sphere's lower half. At arm: 0 a half per
 * cent did. */
static void test_light_outside_its_pole(void **state) {
    static const noc_lamp_shape shapes[] = { NOC_LAMP_DISC, NOC_LAMP_SPHERE, NOC_LAMP_POINT };
    static const double arms[] = { 0, .05, .2, NAN }, radii[] = { NAN, .02, .5 }, heights[] = { 4, 8, 30 };
    for (int i = 0; i < 3 * 4 * 3 * 3 * 2; i++) {
        geo_fitting f = geo_no_fitting();
        f.shape = shapes[i % 3];
        f.arm = arms[i / 3 % 4];
        f.radius = radii[i / 12 % 3];
        geo_lamp lamp = lamp_at(0, 0);
        lamp.height = heights[i / 36 % 3];
        lamp.type = i / 108 ? GEO_LAMP_FLOOD : GEO_LAMP_STREET;
        lamp.direction = 90;
        lamp.fitting = &f;
        noc_scene *s = noc_scene_create(NULL);
        assert_int_equal(city_add_lamp(s, &lamp, &defaults, false, NULL), 1);
        const noc_light_record *l = &s->lights.data[0];
        double tilt = i / 108 ? 50 * M_PI / 180 : 0, n[3] = { sin(tilt), 0, -cos(tilt) }, up = cos(tilt);
        bool disc = f.shape == NOC_LAMP_DISC;
        for (int k = 0; k < 3 && disc; k++)
            n[k] = ((double)l->a[(k + 1) % 3] * l->b[(k + 2) % 3] - (double)l->a[(k + 2) % 3] * l->b[(k + 1) % 3]) /
                   ((double)l->radius * l->radius);
        int free = 0, rays = 0;
        for (int k = 0; k < 3000; k++) {
            double c = 2.399963 * k, z = 1 - (k + .5) / 3000, r = sqrt(1 - z * z), o[3], d[3];
            double x = r * cos(c), at = 2.399963 * 7 * k, far = sqrt(fmod(.618034 * k, 1));
            double da[3] = { x * up + z * n[0], r * sin(c), z * n[2] + x * n[0] };
            for (int m = 0; m < 3; m++)
                d[m] = disc ? sqrt(1 - r * r) * n[m] + r * (cos(c) * l->a[m] + sin(c) * l->b[m]) / l->radius : da[m];
            for (int m = 0; m < 3; m++)
                o[m] = l->p[m] + (disc ? far * (cos(at) * l->a[m] + sin(at) * l->b[m])
                                       : 1.05 * l->radius * da[m]); /* outside its shape */
            rays++;
            free += !is_blocked(s, o, d, 100);
        }
        if (free < .85 * rays)
            fail_msg("%d: arm %g, radius %g, height %g: %d of %d leave", i, f.arm, (double)l->radius, lamp.height, free,
                     rays);
        noc_scene_destroy(s);
    }
}

/* A distribution holds its housing's shadow already: shadow rays from above end before the head of a light that has
 * one. Without one the head blocks all or nearly all of them. The arm shades some, of a small head up to a tenth. */
static void test_head_of_a_profile(void **state) {
    static const noc_lamp_shape shapes[] = { NOC_LAMP_DISC, NOC_LAMP_SPHERE };
    static const double radii[] = { .03, .15, .4 };
    for (int i = 0; i < 2 * 2 * 3 * 2; i++) {
        bool profiled = i % 2;
        geo_fitting f = geo_no_fitting();
        f.shape = shapes[i / 2 % 2];
        f.radius = radii[i / 4 % 3];
        geo_lamp lamp = lamp_at(0, 0);
        lamp.type = i / 12 ? GEO_LAMP_FLOOD : GEO_LAMP_STREET;
        lamp.direction = 90;
        lamp.fitting = &f;
        noc_scene *s = noc_scene_create(NULL);
        noc_status status = NOC_OK;
        city_lamp_params params = defaults;
        params.profiles = profiled ? city_profiles_create(s, NULL, &status) : NULL;
        assert_int_equal(status, NOC_OK);
        assert_int_equal(city_add_lamp(s, &lamp, &params, false, NULL), 1);
        light l = light_of_record(s->lights.data[0]);
        int blocked = 0, rays = 2000;
        for (int k = 0; k < rays; k++) {
            double up = .4 + .6 * (k + .5) / rays, r = sqrt(1 - up * up), c = 2.399963 * k;
            v3 n = V3((float)(r * cos(c)), (float)(r * sin(c)), (float)up);
            segment way = shadow_segment(add3(l.p, mul3(n, 20)), mul3(n, -1), l, (float)fmod(.618034 * k, 1),
                                         (float)fmod(.754878 * k, 1), 1e-4f);
            blocked +=
                is_blocked(s, (double[]){ way.o.x, way.o.y, way.o.z }, (double[]){ way.d.x, way.d.y, way.d.z }, 1);
        }
        if (profiled ? blocked > (f.radius < .1 ? rays / 10 : rays / 50) : blocked < rays / 4)
            fail_msg("%d: radius %g, %s: %d of %d blocked", i, f.radius, profiled ? "profile" : "none", blocked, rays);
        city_profiles_destroy(params.profiles);
        noc_scene_destroy(s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_head_of_a_profile),
        cmocka_unit_test(test_light_outside_its_pole),
        cmocka_unit_test(test_kelvin),
        cmocka_unit_test(test_kelvin_back),
        cmocka_unit_test(test_assumes),
        cmocka_unit_test(test_profiles),
        cmocka_unit_test(test_flux),
        cmocka_unit_test(test_direction_and_sources),
        cmocka_unit_test(test_efficacies),
        cmocka_unit_test(test_own_shape_does_not_shadow),
        cmocka_unit_test(test_inside_building),
        cmocka_unit_test(test_odd_grounds),
        cmocka_unit_test(test_lamps_do_not_stand_on_lamps),
        cmocka_unit_test(test_lamps_at_one_point),
        cmocka_unit_test(test_no_ground),
    };
    return cmocka_run_group_tests_name("city/lamp", tests, NULL, NULL);
}
