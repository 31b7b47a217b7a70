/* core/light.h: every kind of light against closed forms, and on input that no city holds. */
#include "core_test.h"
#include "core/surface.h"

/* One profile: 3 + 2 cos C at gamma 0 to 60, in steps of 30 and 90 degrees, falling to 0 at 90. */
FN profile_cell profile_load(CTX u32 place) {
    static const float row[] = { 1, 1, 1, 0 };
    static const float column[] = { 5, 3, 1, 3 };
    if (place == 0)
        return (profile_cell){ real_of_bits(1), real_of_bits(3u << 16 | 4), 12, 0.25f };
    uint32_t r = (place - 1) / 4, c = (place - 1) % 4;
    return (profile_cell){ row[r] * column[c], row[r] * column[(c + 1) % 4], row[r + 1] * column[c],
                           row[r + 1] * column[(c + 1) % 4] };
}

static const float L = 100; /* cd/m2, or cd */

static light make_sphere(v3 centre, float r) {
    return (light){ .p = centre, .kind = LIGHT_SPHERE, .radius = r, .e = { L, L, L } };
}
/* radius: as the scene's records have it. */
static light make_flat(uint32_t kind, v3 p, v3 a, v3 b) {
    v3 sum = add3(a, b), difference = sub3(a, b);
    float far = kind >= LIGHT_POINT ? 0 : sqrtf(dot3(difference, difference));
    if (kind == LIGHT_PARALLELOGRAM)
        far = fmaxf(far, sqrtf(dot3(sum, sum)));
    if (kind == LIGHT_TRIANGLE)
        far = fmaxf(far, sqrtf(fmaxf(dot3(a, a), dot3(b, b))));
    if (kind == LIGHT_DISC)
        far = sqrtf(dot3(a, a));
    return (light){ .p = p, .kind = kind, .a = a, .b = b, .radius = far, .e = { L, L, L } };
}
static light make_disc(v3 centre, v3 n, float r) {
    v3 a = normalised(cross3(fabsf(n.z) < 0.9f ? V3(0, 0, 1) : V3(1, 0, 0), n));
    return make_flat(LIGHT_DISC, centre, mul3(a, r), mul3(cross3(n, a), r));
}

/* Irradiance by the midpoint rule over the unit square. */
static double irradiance(light l, v3 y, v3 n, int side) {
    double sum = 0;
    for (int i = 0; i < side; i++)
        for (int j = 0; j < side; j++) {
            light_sample s = sample_light(l, y, ((float)i + 0.5f) / (float)side, ((float)j + 0.5f) / (float)side);
            double c = (double)n.x * s.wi.x + (double)n.y * s.wi.y + (double)n.z * s.wi.z;
            sum += c > 0 ? c * s.le.x : 0;
        }
    return sum / ((double)side * side);
}

/* Lambert's formula for a polygon (corners in order, seen from its front), clipped by the receiver's horizon; doubles.
 */
static double polygon_irradiance(const v3 *corners, int count, v3 y, v3 n) {
    double p[16][3], h[16], q[16][3];
    int m = 0;
    for (int i = 0; i < count; i++) {
        p[i][0] = (double)corners[i].x - y.x;
        p[i][1] = (double)corners[i].y - y.y;
        p[i][2] = (double)corners[i].z - y.z;
        h[i] = p[i][0] * n.x + p[i][1] * n.y + p[i][2] * n.z;
    }
    for (int i = 0; i < count; i++) {
        int j = (i + 1) % count;
        if (h[i] >= 0)
            memcpy(q[m++], p[i], sizeof(p[i]));
        if ((h[i] >= 0) != (h[j] >= 0)) {
            double t = h[i] / (h[i] - h[j]);
            for (int k = 0; k < 3; k++)
                q[m][k] = p[i][k] + t * (p[j][k] - p[i][k]);
            m++;
        }
    }
    double e = 0;
    for (int i = 0; i < m; i++) {
        const double *a = q[i], *b = q[(i + 1) % m];
        double c[3] = { a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0] };
        double sine = sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]);
        if (sine > 0)
            e += atan2(sine, a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) * (c[0] * n.x + c[1] * n.y + c[2] * n.z) / sine;
    }
    return fabs(e) * L / 2;
}

static void test_sphere(void **state) {
    dice d = { 1 };
    for (int i = 0; i < 300; i++) {
        v3 c = random_in_box(&d, 50), n = random_direction(&d);
        double r = uniform(&d, 0.05, 3), dist = r * uniform(&d, 1.05, 30);
        double up = uniform(&d, r / dist, 1); /* cosine between n and the axis: the whole sphere over the horizon */
        v3 t = normalised(cross3(n, random_direction(&d)));
        v3 axis = add3(mul3(n, (float)up), mul3(t, (float)sqrt(1 - up * up)));
        v3 y = sub3(c, mul3(axis, (float)dist));
        double w[3] = { (double)c.x - y.x, (double)c.y - y.y, (double)c.z - y.z }; /* as rounded */
        double d2 = w[0] * w[0] + w[1] * w[1] + w[2] * w[2];
        double cosine = (w[0] * n.x + w[1] * n.y + w[2] * n.z) / sqrt(d2);
        double rf = (float)r;
        if (cosine < rf / sqrt(d2) + 1e-4)
            continue;
        assert_close(irradiance(make_sphere(c, (float)r), y, n, 64), CORE_PI * L * rf * rf / d2 * cosine, 2e-3);
    }
    /* point-like, and near enough to fill half the sky */
    v3 up = V3(0, 0, 1), o = V3(0, 0, 0);
    assert_close(irradiance(make_sphere(V3(0, 0, 1e5f), 0.1f), o, up, 64), CORE_PI * L * 1e-12, 1e-4);
    assert_close(irradiance(make_sphere(V3(0, 0, 1.001f), 1), o, up, 512), CORE_PI * L / (1.001 * 1.001), 2e-3);
}

static void test_disc(void **state) {
    dice d = { 2 };
    for (int i = 0; i < 100; i++) {
        v3 n = random_direction(&d), y = random_in_box(&d, 20);
        double r = uniform(&d, 0.05, 2), dist = r * uniform(&d, 0.2, 20);
        light l = make_disc(add3(y, mul3(n, (float)dist)), mul3(n, -1), (float)r);
        assert_close(irradiance(l, y, n, 256), CORE_PI * L * r * r / (r * r + dist * dist), 2e-3);
    }
}

/* Polygons at any receiver: above, below and across its horizon, from both sides. */
static void check_polygon(uint32_t kind, uint64_t seed) {
    dice d = { seed };
    int lit = 0, dark = 0;
    for (int i = 0; i < 120; i++) {
        v3 p = random_in_box(&d, 3), a = random_in_box(&d, 2), b = random_in_box(&d, 2);
        v3 y = random_in_box(&d, 5), n = random_direction(&d);
        v3 f = cross3(a, b), w = sub3(y, p);
        double height = dot3(f, w) / sqrtf(dot3(f, f));
        if (fabs(height) < 2e-3)
            continue; /* by solid angle the midpoint rule is good for all heights that floats tell apart */
        light l = make_flat(kind, p, a, b);
        double have = irradiance(l, y, n, 256);
        v3 corners[4] = { p, add3(p, a), add3(p, add3(a, b)), add3(p, b) };
        if (kind == LIGHT_TRIANGLE)
            corners[2] = corners[3];
        double want = polygon_irradiance(corners, kind == LIGHT_TRIANGLE ? 3 : 4, y, n);
        if (height < 0) {
            assert_true(have == 0);
            dark++;
            l.flags = LIGHT_TWO_SIDED;
            have = irradiance(l, y, n, 256);
        }
        if (fabs(have - want) > 2e-3 * want + 1e-4 * L)
            fail_msg("receiver %d: %g lx by sampling, %g lx by Lambert's formula", i, have, want);
        lit += want > 0.01 * L;
    }
    assert_true(lit > 20 && dark > 20);
}
static void test_parallelogram(void **state) { check_polygon(LIGHT_PARALLELOGRAM, 3); }
static void test_triangle(void **state) { check_polygon(LIGHT_TRIANGLE, 4); }

/* Solid angle of a triangle of directions in doubles (Van Oosterom and Strackee 1983). */
static double solid_angle(const v3 *corners, int i, int j, int k, v3 y) {
    int at[3] = { i, j, k };
    double p[3][3];
    for (int m = 0; m < 3; m++) {
        double w[3] = { (double)corners[at[m]].x - y.x, (double)corners[at[m]].y - y.y,
                        (double)corners[at[m]].z - y.z };
        double len = sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
        for (int c = 0; c < 3; c++)
            p[m][c] = w[c] / len;
    }
    double det = 0, dots = 1;
    for (int c = 0; c < 3; c++) {
        int d = (c + 1) % 3, e = (c + 2) % 3;
        det += p[0][c] * (p[1][d] * p[2][e] - p[1][e] * p[2][d]);
        for (int m = 0; m < 3; m++)
            dots += p[m][c] * p[(m + 1) % 3][c];
    }
    return 2 * atan2(fabs(det), dots);
}

/* From close by every place stands for the same solid angle, so a sample's light only differs by the receiver's cosine;
 * places cover the light evenly in solid angle: all receivers' irradiances are Lambert's. */
static void check_close(uint32_t kind, uint64_t seed) {
    dice d = { seed };
    int checked = 0;
    for (int i = 0; i < 200; i++) {
        v3 p = random_in_box(&d, 3), a = random_in_box(&d, 2), b = random_in_box(&d, 2), f = cross3(a, b);
        double area = sqrt(dot3(f, f)), gap = pow(10, uniform(&d, -2, 0.5));
        if (area < 0.3)
            continue;
        v3 foot = add3(p, add3(mul3(a, (float)uniform(&d, -0.3, 1.3)), mul3(b, (float)uniform(&d, -0.3, 1.3))));
        v3 y = add3(foot, mul3(f, (float)(gap / area))), n = random_direction(&d);
        light l = make_flat(kind, p, a, b);
        v3 w = sub3(p, y), corners[4] = { p, add3(p, a), add3(p, add3(a, b)), add3(p, b) };
        if (dot3(w, w) > 3.9f * l.radius * l.radius)
            continue;
        bool whole = kind == LIGHT_PARALLELOGRAM;
        double angle = whole ? solid_angle(corners, 0, 1, 2, y) + solid_angle(corners, 0, 2, 3, y)
                             : solid_angle(corners, 0, 1, 3, y);
        for (int k = 0; k < 16; k++) {
            light_sample s = sample_light(l, y, (float)uniform(&d, 0, 1), (float)uniform(&d, 0, 1));
            assert_close(s.le.x, L * angle, 1e-4);
        }
        if (!whole)
            corners[2] = corners[3];
        double have = irradiance(l, y, n, 160), want = polygon_irradiance(corners, whole ? 4 : 3, y, n);
        if (fabs(have - want) > 5e-3 * L)
            fail_msg("receiver %d, %g m away: %g lx by sampling, %g lx by Lambert's formula", i, gap, have, want);
        checked++;
    }
    assert_true(checked > 60);
}
static void test_close_parallelogram(void **state) { check_close(LIGHT_PARALLELOGRAM, 10); }
static void test_close_triangle(void **state) { check_close(LIGHT_TRIANGLE, 11); }

/* A window of 1 x 1.5 m, 1 cm over a table: its middle, under an edge, beside a corner. One sample is never far off:
 * where the window is all that is seen, no place gives more than twice the mean (the cosine's range); by area it is
 * 15,000 / pi times. */
static void test_close_window(void **state) {
    const v3 up = V3(0, 0, 1),
             places[] = { { 0.5f, 0.75f, 0 }, { 0.3f, 0.2f, 0 }, { 0, 0.6f, 0 }, { 1.005f, 1.502f, 0 } };
    light l = make_flat(LIGHT_PARALLELOGRAM, V3(0, 0, 0.01f), V3(0, 1.5f, 0), V3(1, 0, 0));
    for (size_t i = 0; i < sizeof(places) / sizeof(*places); i++) {
        v3 y = places[i], corners[4] = { l.p, add3(l.p, l.a), add3(l.p, add3(l.a, l.b)), add3(l.p, l.b) };
        double want = polygon_irradiance(corners, 4, y, up), squares = 0, most = 0;
        assert_close(irradiance(l, y, up, 256), want, 2e-3);
        dice d = { 12 + i };
        for (int k = 0; k < 20000; k++) {
            light_sample s = sample_light(l, y, (float)uniform(&d, 0, 1), (float)uniform(&d, 0, 1));
            double e = s.wi.z > 0 ? (double)s.wi.z * s.le.x / want : 0;
            squares += (e - 1) * (e - 1) / 20000;
            most = fmax(most, e);
        }
        assert_true(squares < 0.6 && most < (i < 2 ? 2.05 : 3)); /* of the whole half space: 1/3 and 2 */
        l.radius = 0; /* by area, to see that this test sees the difference */
        most = 0;
        for (int k = 0; k < 20000; k++) {
            light_sample s = sample_light(l, y, (float)uniform(&d, 0, 1), (float)uniform(&d, 0, 1));
            most = fmax(most, (double)s.wi.z * s.le.x / want);
        }
        assert_true(most > 50);
        l = make_flat(LIGHT_PARALLELOGRAM, l.p, l.a, l.b);
    }
}

/* Where the map changes, the light does not. */
static void test_close_and_far_agree(void **state) {
    dice d = { 13 };
    for (int i = 0; i < 60; i++) {
        uint32_t kind = LIGHT_DISC + (uint32_t)(roll(&d) % 3);
        v3 p = random_in_box(&d, 3), away = random_direction(&d), n = random_direction(&d);
        light l = make_flat(kind, p, random_in_box(&d, 2), random_in_box(&d, 2));
        if (kind == LIGHT_DISC)
            l = make_disc(p, random_direction(&d), 1);
        l.flags = LIGHT_TWO_SIDED;
        float edge = kind == LIGHT_DISC ? LIGHT_CLOSE_DISC : LIGHT_CLOSE;
        double near = irradiance(l, add3(p, mul3(away, 0.9999f * edge * l.radius)), n, 128);
        double far = irradiance(l, add3(p, mul3(away, 1.0001f * edge * l.radius)), n, 128);
        if (fabs(near - far) > 0.02 * far + 1e-3 * L)
            fail_msg("light %d of kind %u: %g lx from within, %g lx from beyond", i, kind, near, far);
    }
}

static void test_turn_of(void **state) {
    dice d = { 14 };
    for (int i = 0; i < 100000; i++) {
        double size = pow(10, uniform(&d, -12, 6));
        float x = (float)uniform(&d, -size, size), y = (float)fabs(uniform(&d, -1, 1) * pow(10, uniform(&d, -12, 6)));
        double want = atan2((double)y, (double)x) / (2 * M_PI);
        if (x > 1e-20 || y > 1e-20)
            assert_close(turn_of(x, y), want, 4e-7);
    }
    assert_true(turn_of(1, 0) == 0 && turn_of(0, 0) == 0 && turn_of(-1, 0) == 0.5f && turn_of(0, 1) == 0.25f);
}

static void test_point(void **state) {
    dice d = { 5 };
    for (int i = 0; i < 300; i++) {
        light l = { .p = random_in_box(&d, 30), .kind = LIGHT_POINT, .e = { L, L, L } };
        v3 y = random_in_box(&d, 30), n = random_direction(&d);
        double w[3] = { (double)l.p.x - y.x, (double)l.p.y - y.y, (double)l.p.z - y.z };
        double d2 = w[0] * w[0] + w[1] * w[1] + w[2] * w[2];
        double c = (w[0] * n.x + w[1] * n.y + w[2] * n.z) / sqrt(d2);
        if (fabs(c) > 0.01)
            assert_close(irradiance(l, y, n, 2), c > 0 ? L * c / d2 : 0, 1e-4);
    }
}

/* A spot with the cones' cosines ci and co, by the extension's own words: scale 1 / (ci - co), offset -co times that.
 */
static light make_spot(v3 p, v3 axis, double ci, double co) {
    float s = (float)(1 / (ci - co));
    v3 b = V3((float)(-co / (ci - co)), 0, 0);
    return (light){ .p = p, .kind = LIGHT_SPOT, .a = mul3(axis, s), .b = b, .e = { L, L, L } };
}

/* E = I f^2 cos / d^2: f is 1 within the inner cone, 0 beyond the outer one, linear in the angle's cosine between them.
 */
static void test_spot(void **state) {
    dice d = { 15 };
    int inside = 0, between = 0, outside = 0;
    for (int i = 0; i < 3000; i++) {
        double outer = uniform(&d, 0.05, M_PI / 2), inner = uniform(&d, 0, 0.95) * outer, co = cos(outer),
               ci = cos(inner);
        v3 axis = random_direction(&d), n = random_direction(&d), y = random_in_box(&d, 30);
        light l = make_spot(random_in_box(&d, 30), axis, ci, co);
        if (i % 2) /* near the axis */
            y = add3(l.p, add3(mul3(axis, (float)uniform(&d, 2, 30)), random_in_box(&d, 2)));
        double w[3] = { (double)l.p.x - y.x, (double)l.p.y - y.y, (double)l.p.z - y.z };
        double d2 = w[0] * w[0] + w[1] * w[1] + w[2] * w[2];
        double c = (w[0] * n.x + w[1] * n.y + w[2] * n.z) / sqrt(d2);
        double t = -(w[0] * axis.x + w[1] * axis.y + w[2] * axis.z) / sqrt(d2);
        double f = t >= ci ? 1 : t <= co ? 0 : (t - co) / (ci - co);
        if (!(fabs(c) > 0.01) || (f > 0 && f < 0.01))
            continue; /* floats hold less there */
        inside += f == 1;
        outside += f == 0;
        between += f > 0 && f < 1;
        assert_close(irradiance(l, y, n, 2), c > 0 ? L * f * f * c / d2 : 0, 2e-3);
        double axial = irradiance(l, add3(l.p, mul3(axis, 2)), mul3(axis, -1), 2);
        assert_close(axial, L / 4, 1e-4); /* on the axis, from two metres */
    }
    assert_true(inside > 300 && between > 300 && outside > 300);
}

/* The place a sample stands for lies on the light, on the side that y sees, in the direction that is told. */
/* Of the profile above, cd a lumen. */
static double profile_of_angles(double c, double gamma) {
    double column[] = { 5, 3, 1, 3, 5 }, row[] = { 1, 1, 1, 0 }, x = c / 90, z = gamma / 30;
    int i = (int)fmin(x, 3), k = (int)fmin(z, 2);
    return gamma > 90
               ? 0
               : (column[i] + (column[i + 1] - column[i]) * (x - i)) * (row[k] + (row[k + 1] - row[k]) * (z - k));
}

/* A light of 100 lm whose axis is n and whose C 0 is a. */
static light make_profiled(uint32_t kind, v3 p, v3 n, v3 a, float radius) {
    float length = kind == LIGHT_DISC ? radius : 1;
    light l = { .p = p, .kind = kind, .radius = radius, .e = { L, L, L }, .flags = 1u << LIGHT_PROFILE };
    l.a = mul3(a, length);
    l.b = mul3(cross3(n, a), length);
    return l;
}

/* E = I cos / d^2 under a point, whichever way it is turned; under what is small and far away, too. */
static void test_profile(void **state) {
    dice d = { 91 };
    for (int i = 0; i < samples(20000); i++) {
        v3 n = random_direction(&d), a = normalised(cross3(n, random_direction(&d))), b = cross3(n, a);
        double c = uniform(&d, 0, 360), gamma = uniform(&d, 0, 170), dist = uniform(&d, 0.5, 40);
        double cc = cos(c * M_PI / 180), sc = sin(c * M_PI / 180), cg = cos(gamma * M_PI / 180),
               sg = sin(gamma * M_PI / 180);
        v3 way = V3((float)(sg * (cc * a.x - sc * b.x) + cg * n.x), (float)(sg * (cc * a.y - sc * b.y) + cg * n.y),
                    (float)(sg * (cc * a.z - sc * b.z) + cg * n.z));
        v3 p = random_in_box(&d, 10), y = add3(p, mul3(way, (float)dist));
        double want = L * profile_of_angles(c, gamma) / (dist * dist);
        float u = (float)uniform(&d, 0, 1), v = (float)uniform(&d, 0, 1);
        light point = make_profiled(LIGHT_POINT, p, n, a, 0), disc = make_profiled(LIGHT_DISC, p, n, a, 1e-3f);
        light sphere = make_profiled(LIGHT_SPHERE, p, n, a, 0.3f);
        assert_true(fabs(shining_sample(NULL, point, y, u, v).le.x - want) <= 2e-4 * L * 5 / (dist * dist));
        if (gamma > 10 && fabs(gamma - 90) > 1) /* C turns fast next to the axis */
            assert_true(fabs(shining_sample(NULL, disc, y, u, v).le.x - want) <= 0.02 * L * 5 / (dist * dist));
        light_sample s = shining_sample(NULL, sphere, y, u, v);
        assert_true(fabs(s.le.x - want) <= 2e-4 * L * 5 / (dist * dist));
        assert_true(s.dist < (float)dist &&
                    s.dist > (float)dist - 0.301f); /* its shape is what shadows are cast from */
    }
}

/* The flux through a ball around the light is what it is said to be: the light's lumens, times those of the profile. */
static void test_profile_flux(void **state) {
    double profile = 0, sums[3] = { 0 };
    const int steps = 600;
    v3 n = { 0, 0, -1 }, a = { 1, 0, 0 };
    light l[] = { make_profiled(LIGHT_POINT, V3(0, 0, 0), n, a, 0),
                  make_profiled(LIGHT_SPHERE, V3(0, 0, 0), n, a, 0.2f),
                  make_profiled(LIGHT_DISC, V3(0, 0, 0), n, a, 0.2f) };
    dice d = { 92 };
    for (int i = 0; i < steps; i++)
        for (int k = 0; k < steps; k++) {
            double g = M_PI * (i + .5) / steps, c = 2 * M_PI * (k + .5) / steps,
                   area = 2 * M_PI * M_PI / steps / steps * sin(g);
            v3 y = V3((float)(20 * sin(g) * cos(c)), (float)(20 * sin(g) * sin(c)), (float)(-20 * cos(g)));
            profile += area * profile_of_angles(c * 180 / M_PI, g * 180 / M_PI);
            for (int m = 0; m < 3; m++) {
                light_sample s = shining_sample(NULL, l[m], y, (float)uniform(&d, 0, 1), (float)uniform(&d, 0, 1));
                double cosine = -((double)s.wi.x * y.x + (double)s.wi.y * y.y + (double)s.wi.z * y.z) / 20;
                sums[m] += area * 400 * s.le.x * cosine;
            }
        }
    for (int m = 0; m < 3; m++)
        assert_true(fabs(sums[m] / (L * profile) - 1) < (m ? 3e-3 : 1e-4));
}

/* From a metre to a millimetre from a disc: finite, and never more than from its nearest place. */
static void test_profile_near(void **state) {
    light l = make_profiled(LIGHT_DISC, V3(0, 0, 0), V3(0, 0, -1), V3(1, 0, 0), 0.15f);
    dice d = { 93 };
    for (double z = 1; z > 1e-3; z /= 2)
        for (int i = 0; i < 100; i++) {
            light_sample s =
                shining_sample(NULL, l, V3(0.05f, 0, (float)-z), (float)uniform(&d, 0, 1), (float)uniform(&d, 0, 1));
            assert_true(s.le.x >= 0 && s.le.x <= L * 5 / (z * z) * 1.001);
            assert_true(shining_sample(NULL, l, V3(0.05f, 0, (float)z), 0.3f, 0.3f).le.x == 0);
        }
}

/* A plain light is what it was. */
static void test_profile_of_none(void **state) {
    light l = make_disc(V3(0, 0, 3), V3(0, 0, -1), 0.2f);
    light_sample s = sample_light(l, V3(1, 0, 0), 0.3f, 0.7f), t = shining_sample(NULL, l, V3(1, 0, 0), 0.3f, 0.7f);
    assert_memory_equal(&s, &t, sizeof(s));
    assert_true(light_shown(l).x == L);
    l = make_profiled(LIGHT_DISC, V3(0, 0, 3), V3(0, 0, -1), V3(1, 0, 0), 0.2f);
    assert_true(fabs(light_shown(l).x * M_PI * M_PI * .2 * .2 / L - 1) < 1e-5);
}

static void test_samples_lie_on_the_light(void **state) {
    dice d = { 6 };
    for (int i = 0; i < 20000; i++) {
        uint32_t kind = (uint32_t)(roll(&d) % (LIGHT_SPOT + 1));
        v3 p = random_in_box(&d, 10), y = random_in_box(&d, 20);
        v3 a = random_in_box(&d, 2), b = random_in_box(&d, 2);
        light l = make_flat(kind, p, a, b);
        l.flags = LIGHT_TWO_SIDED;
        if (kind == LIGHT_DISC)
            l = make_disc(p, random_direction(&d), (float)uniform(&d, 0.1, 2));
        if (kind == LIGHT_SPHERE)
            l = make_sphere(p, (float)uniform(&d, 0.1, 2));
        float u = (float)uniform(&d, 0, 1), v = (float)uniform(&d, 0, 1);
        light_sample s = sample_light(l, y, u, v);
        if ((kind == LIGHT_SPHERE || kind == LIGHT_DISC) && s.le.x == 0)
            continue; /* inside; beside the disc, in the square around it */
        v3 x = add3(y, mul3(s.wi, s.dist)), w = sub3(x, l.p);
        assert_true(fabsf(dot3(s.wi, s.wi) - 1) < 1e-5f);
        if (kind >= LIGHT_POINT) {
            assert_true(dot3(w, w) < 1e-8f);
        } else if (kind == LIGHT_SPHERE) {
            assert_true(fabsf(sqrtf(dot3(w, w)) - l.radius) < 2e-3f * l.radius + 2e-4f);
            assert_true(dot3(w, s.wi) <= 2e-2f * l.radius);
        } else {
            v3 n = cross3(l.a, l.b);
            assert_true(fabsf(dot3(w, n)) < 2e-5f * (1 + sqrtf(dot3(n, n))) * 20);
            /* coordinates along the edges, by Cramer's rule in the light's plane */
            double n2 = dot3(n, n);
            double cu = dot3(cross3(w, l.b), n) / n2, cv = dot3(cross3(l.a, w), n) / n2, e = 2e-4 / sqrt(n2) + 1e-4;
            if (kind == LIGHT_DISC)
                assert_true(cu * cu + cv * cv < 1 + 2 * e);
            else
                assert_true(cu > -e && cv > -e &&
                            (kind == LIGHT_TRIANGLE ? cu + cv < 1 + 2 * e : cu < 1 + e && cv < 1 + e));
        }
    }
}

static void test_receiver_where_no_light_comes(void **state) {
    dice d = { 7 };
    for (int i = 0; i < 2000; i++) {
        float u = (float)uniform(&d, 0, 1), v = (float)uniform(&d, 0, 1);
        light s = make_sphere(random_in_box(&d, 100), (float)uniform(&d, 0.1, 5));
        v3 inside = add3(s.p, mul3(random_direction(&d), s.radius * (float)uniform(&d, 0, 0.999)));
        light_sample got = sample_light(s, inside, u, v);
        assert_true(got.le.x == 0 && got.le.y == 0 && got.le.z == 0 && finite3(got.wi) && isfinite(got.dist));
        /* in the plane of a flat light: a horizontal one, so that the heights are equal to the bit */
        uint32_t kind = LIGHT_DISC + (uint32_t)(roll(&d) % 3);
        light f = make_flat(kind, V3(1, 2, 3), V3(2, 0, 0), V3(0, 2, 0));
        v3 beside = V3((float)uniform(&d, -5, 5), (float)uniform(&d, -5, 5), 3);
        got = sample_light(f, beside, u, v);
        assert_true(got.le.x == 0 && finite3(got.wi) && isfinite(got.dist));
        /* behind: nothing, unless the light has two sides */
        v3 behind = V3(beside.x, beside.y, (float)uniform(&d, -5, 2.9));
        assert_true(sample_light(f, behind, u, v).le.x == 0);
        f.flags = LIGHT_TWO_SIDED;
        light_sample two = sample_light(f, behind, u, v);
        f.flags = 0;
        assert_true(two.le.x > 0 || kind == LIGHT_DISC); /* there may be no disc at (u, v) */
        assert_close(two.le.x, sample_light(f, V3(behind.x, behind.y, 6 - behind.z), u, v).le.x, 1e-4);
    }
}

/* Numbers that break things. */
static float odd_number(dice *d, double largest) {
    switch (roll(d) % 8) {
    case 0: return 0;
    case 1: return (float)uniform(d, -1e-6, 1e-6);
    case 2: return (float)uniform(d, -1e-30, 1e-30);
    case 3: return (float)(roll(d) & 1 ? largest : -largest);
    case 4: return (float)floor(uniform(d, -3, 3));
    default: return (float)(uniform(d, -1, 1) * pow(10, uniform(d, -6, log10(largest))));
    }
}
static v3 odd_v3(dice *d, double largest) {
    return V3(odd_number(d, largest), odd_number(d, largest), odd_number(d, largest));
}

/* Coordinates to 10,000 km, lights to 10 km, 1e9 cd/m2: nothing but finite numbers comes out. */
static void test_extreme_input(void **state) {
    dice d = { 8 };
    size_t lit = 0;
    for (int i = 0; i < 400000; i++) {
        light l = { .p = odd_v3(&d, 1e7),
                    .kind = (uint32_t)(roll(&d) % (LIGHT_SPOT + 1)),
                    .a = odd_v3(&d, 1e4),
                    .b = odd_v3(&d, 1e4),
                    .radius = fabsf(odd_number(&d, 1e4)),
                    .flags = (uint32_t)(roll(&d) & 1),
                    .e = { 1e9f, 1e9f, 1e9f } };
        surf s = { .p = roll(&d) % 4 ? odd_v3(&d, 1e7) : add3(l.p, odd_v3(&d, 1)),
                   .n = random_direction(&d),
                   .albedo = { .5f, .5f, .5f },
                   .f0 = roll(&d) & 1 ? 0 : 0.5f,
                   .alpha = roll(&d) & 1 ? 0.0025f : 1 };
        s.wo = roll(&d) % 4 ? random_direction(&d) : s.n;
        float u = (float)(roll(&d) % 3) / 2, v = (float)uniform(&d, 0, 1);
        light_sample got = sample_light(l, s.p, u, v);
        v3 c = reflected(s, got);
        float p = target(NULL, s, l, u, v);
        if (!finite3(got.wi) || !isfinite(got.dist) || !finite3(got.le) || !finite3(c))
            fail_msg("case %d, kind %u: wi %g %g %g, dist %g, le %g", i, l.kind, got.wi.x, got.wi.y, got.wi.z, got.dist,
                     got.le.x);
        assert_true(got.le.x >= 0 && got.dist >= -l.radius && p >= 0 && isfinite(p));
        lit += p > 0;
    }
    assert_true(lit > 10000);
}

/* Whatever is put in, even NaN and infinity: a target is a finite number that is not negative. */
static void test_target_of_nonsense(void **state) {
    dice d = { 9 };
    static const float bad[] = { NAN, INFINITY, -INFINITY, 1e38f, -1e38f, 0, 1, 1e-45f };
    for (int i = 0; i < 100000; i++) {
        float f[32];
        for (int j = 0; j < 32; j++)
            f[j] = roll(&d) % 3 ? (float)uniform(&d, -2, 2) : bad[roll(&d) % 8];
        light l = { .p = { f[0], f[1], f[2] },
                    .kind = (uint32_t)(roll(&d) % (LIGHT_SPOT + 1)),
                    .a = { f[3], f[4], f[5] },
                    .b = { f[6], f[7], f[8] },
                    .radius = f[9],
                    .e = { f[10], f[11], f[12] } };
        surf s = { .p = { f[13], f[14], f[15] },
                   .n = { f[16], f[17], f[18] },
                   .wo = { f[19], f[20], f[21] },
                   .albedo = { f[22], f[23], f[24] },
                   .f0 = f[25],
                   .alpha = f[26] };
        float p = target(NULL, s, l, (float)uniform(&d, 0, 1), (float)uniform(&d, 0, 1));
        assert_true(p >= 0 && isfinite(p));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sphere),
        cmocka_unit_test(test_disc),
        cmocka_unit_test(test_parallelogram),
        cmocka_unit_test(test_triangle),
        cmocka_unit_test(test_close_parallelogram),
        cmocka_unit_test(test_close_triangle),
        cmocka_unit_test(test_close_window),
        cmocka_unit_test(test_close_and_far_agree),
        cmocka_unit_test(test_turn_of),
        cmocka_unit_test(test_point),
        cmocka_unit_test(test_spot),
        cmocka_unit_test(test_profile),
        cmocka_unit_test(test_profile_flux),
        cmocka_unit_test(test_profile_near),
        cmocka_unit_test(test_profile_of_none),
        cmocka_unit_test(test_samples_lie_on_the_light),
        cmocka_unit_test(test_receiver_where_no_light_comes),
        cmocka_unit_test(test_extreme_input),
        cmocka_unit_test(test_target_of_nonsense),
    };
    return cmocka_run_group_tests_name("light", tests, NULL, NULL);
}
