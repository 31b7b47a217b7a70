/* Receivers of camera rays against doubles: places and normals of triangles that instances show, sides, lights, and how
 * wide a pixel is on a surface. */
#include "core_test.h"

#include "core/records.h"

enum { ONE_SIDED, TWO_SIDED, DARK, LIGHTS_HERE };
struct core_context {
    const struct frame_constants *frame;
};

#include "core/primary.h"

FN light light_load(CTX u32 i) {
    (void)ctx;
    assert_true(i < LIGHTS_HERE);
    light l = { .kind = LIGHT_TRIANGLE, .flags = i == TWO_SIDED ? LIGHT_TWO_SIDED : 0 };
    l.e.y = i == DARK ? 0 : 2; /* green alone */
    return l;
}
FN u32 texel_load(CTX u32 place) {
    (void)ctx;
    return place;
}
FN profile_cell profile_load(CTX u32 place) {
    (void)ctx;
    (void)place;
    return (profile_cell){ 0 };
}

static dice die = { 11 };
static const struct core_context *const none = NULL;

static placement any_placement(void) {
    v3 z = random_direction(&die), x = normalised(cross3(random_direction(&die), z)), y = cross3(z, x);
    float scale = (float)uniform(&die, 0.2, 5);
    return (placement){ mul3(x, scale), mul3(y, scale), mul3(z, scale), random_in_box(&die, 500) };
}

static void row(const v3 *row, float at, v3 p, v3 n, double *q, double *m) {
    *q = (double)row->x * p.x + (double)row->y * p.y + (double)row->z * p.z + at;
    *m = (double)row->x * n.x + (double)row->y * n.y + (double)row->z * n.z;
}

/* A hit of a ray from `eye` at the middle of a triangle, in the coordinates that m places. */
static ray_hit hit_from(v3 eye, const placement *m, bool placed, double p[3], double n[3]) {
    ray_hit h = { { random_in_box(&die, 3), random_in_box(&die, 3), random_in_box(&die, 3) }, 0.25f, 0.5f, 0 };
    v3 q = hit_point(h.at, h.u, h.v), k = hit_normal(h.at);
    const v3 rows[3] = { m->x, m->y, m->z };
    const float at[3] = { m->at.x, m->at.y, m->at.z };
    for (int i = 0; i < 3; i++)
        if (placed)
            row(&rows[i], at[i], q, k, &p[i], &n[i]);
        else
            p[i] = (&q.x)[i], n[i] = (&k.x)[i];
    double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int i = 0; i < 3; i++)
        n[i] /= length;
    h.far_ = 2;
    h.d = V3((float)(p[0] - eye.x) / 2, (float)(p[1] - eye.y) / 2, (float)(p[2] - eye.z) / 2);
    h.light = NO_LIGHT;
    h.material = 7;
    return h;
}

static void receivers_are_those_of_doubles(void **state) {
    (void)state;
    for (int i = 0; i < samples(20000); i++) {
        bool placed = i % 2;
        placement m = any_placement();
        v3 eye = random_in_box(&die, 100);
        double p[3], n[3];
        ray_hit h = hit_from(eye, &m, placed, p, n);
        receiver r = receiver_of_hit(none, h, placed, m);
        double far = sqrt(pow(p[0] - eye.x, 2) + pow(p[1] - eye.y, 2) + pow(p[2] - eye.z, 2));
        double side = n[0] * (double)h.d.x + n[1] * (double)h.d.y + n[2] * (double)h.d.z;
        for (int k = 0; k < 3; k++) {
            assert_true(fabs((&r.p.x)[k] - p[k]) < 1e-4);
            if (fabs(side) > 1e-3) /* else rounding may choose the other side */
                assert_true(fabs((&r.n.x)[k] - (side < 0 ? n[k] : -n[k])) < 1e-5);
        }
        assert_close(r.depth, far, 1e-5);
        assert_true(r.material == 7 && r.light == NO_LIGHT);
        assert_close(placement_scale2(m), m.z.x * m.z.x + m.z.y * m.z.y + m.z.z * m.z.z, 1e-4);
    }
}

/* A triangle that faces +z, seen from above and from below. */
static uint32_t seen_light(uint32_t id, bool front) {
    float z = front ? -1 : 1;
    ray_hit h = { { V3(0, 0, 0), V3(1, 0, 0), V3(0, 1, 0) }, 0.3f, 0.3f, 1, V3(0.1f, 0, z), 0, id };
    receiver r = receiver_of_hit(none, h, false, (placement){ V3(0, 0, 0), V3(0, 0, 0), V3(0, 0, 0), V3(0, 0, 0) });
    assert_true(r.n.z == -z);
    return r.light;
}

static void lights_are_seen_on_their_emitting_side(void **state) {
    (void)state;
    for (int front = 0; front < 2; front++) {
        assert_int_equal(seen_light(ONE_SIDED, front), front ? ONE_SIDED : NO_LIGHT);
        assert_int_equal(seen_light(TWO_SIDED, front), TWO_SIDED);
        assert_int_equal(seen_light(DARK, front), NO_LIGHT);
        assert_int_equal(seen_light(NO_LIGHT, front), NO_LIGHT);
    }
}

/* On a plane that a camera looks at straight on, at a slant, and along: the way from one row's ray to the next across
 * the ray, over the cosine, which counts as a hundredth at least. */
static void pixels_widen_at_a_slant(void **state) {
    (void)state;
    const double far = 40, apart = 0.002;
    for (int i = 0; i <= 90; i += 5) {
        double a = i * M_PI / 180;
        ray_hit h = { .far_ = (float)far, .d = V3(0, 0, -1) };
        v3 n = V3((float)sin(a), 0, (float)cos(a));
        double want = far * apart / fmax(cos(a), 0.01);
        float apart2 = rays_apart2(h.d, V3(0, (float)apart, -1));
        assert_close(hit_width(h, n, apart2, 1), want, 1e-4);
        assert_close(hit_width(h, n, apart2, 4), want / 2, 1e-4); /* an instance twice as large */
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(receivers_are_those_of_doubles),
        cmocka_unit_test(lights_are_seen_on_their_emitting_side),
        cmocka_unit_test(pixels_widen_at_a_slant),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
