/* Bounds of lights, with a profile and without: from anywhere a light is no stronger than its intensity, lies in its
 * sphere, and sends nothing behind the plane that it looks away from. What a light sends is core's, by its record. A
 * bound that is too tight in any of the three is found. */
#include "worlds.h"

#include "light/bound.h"

#include "core/light.h"

struct core_context {
    char nothing;
};

enum { LIGHTS = 480, POINTS = 600 };

static v3 any_direction(void) {
    float z = real_in(-1, 1), a = real_in(0, 6.2831853f), r = sqrtf(1 - z * z);
    return V3(r * cosf(a), r * sinf(a), z);
}

typedef struct found {
    int stronger, outside, behind;
    float share; /* greatest, of the bound's intensity */
} found;

static found ask(const noc_light_record *r, const noc_light_bound *b) {
    const struct core_context ctx = { 0 };
    light l; /* which is its record */
    memcpy(&l, r, sizeof(l));
    found f = { 0 };
    for (int i = 0; i < POINTS; i++) {
        v3 y = add3(l.p, mul3(any_direction(), real_in(8, 40)));
        light_sample s = shining_sample(&ctx, l, y, real_in(0, 1), real_in(0, 1));
        float power = 0.2126f * s.le.x + 0.7152f * s.le.y + 0.0722f * s.le.z;
        v3 at = r->kind == NOC_LIGHT_SPHERE ? l.p : add3(y, mul3(s.wi, s.dist)), to = sub3(y, at);
        v3 off = sub3(at, V3(b->p[0], b->p[1], b->p[2]));
        if (!(power > 0))
            continue;
        float share = power * dot3(to, to) / b->intensity, along = dot3(to, V3(b->n[0], b->n[1], b->n[2]));
        f.share = fmaxf(f.share, share);
        f.stronger += !(share <= 1.002f); /* a sphere from 8 m is 0.1 % stronger than from afar */
        f.outside += !(dot3(off, off) <= 1.001f * b->radius * b->radius + 1e-8f);
        f.behind += along < -1e-4f * sqrtf(dot3(to, to));
    }
    return f;
}

static noc_scene *made(void) {
    noc_scene *s = world(LIGHTS, MIXED);
    cells_ = s->profile_cells.data;
    return s;
}

static void bounds_hold(void **state) {
    (void)state;
    noc_scene *s = made();
    float share[TEST_PROFILES + 1] = { 0 };
    uint32_t first = 0;
    for (uint32_t i = 0; i < LIGHTS; i++) {
        const noc_light_record *r = &s->lights.data[i];
        noc_light_bound b = noc_bound_light(r);
        found f = ask(r, &b);
        if (f.stronger || f.outside || f.behind)
            fail_msg("light %u of kind %u: %d stronger, %d outside, %d behind", i, r->kind, f.stronger, f.outside,
                     f.behind);
        uint32_t profile = (r->flags & LIGHT_PROFILE_BITS) >> LIGHT_PROFILE;
        first = !first || (profile && profile < first) ? profile : first;
        uint32_t kind = profile ? profile - first + 1 : 0;
        share[kind] = fmaxf(share[kind], f.share);
    }
    for (int i = 0; i <= TEST_PROFILES; i++)
        if (!(share[i] > 0.9f)) /* and none is looser than it must be */
            fail_msg("profile %d: no light reaches more than %g of its bound", i, (double)share[i]);
    noc_scene_destroy(s);
}

/* Of lights with a profile: a weaker one; one that looks one way where light goes behind; one of half the radius. */
static void a_bound_that_is_too_tight_is_found(void **state) {
    (void)state;
    noc_scene *s = made();
    int stronger = 0, behind = 0, outside = 0, discs = 0;
    for (uint32_t i = 0; i < LIGHTS; i++) {
        const noc_light_record *r = &s->lights.data[i];
        if (!noc_light_has_profile(r))
            continue;
        noc_light_bound b = noc_bound_light(r), weak = b, turned = b, small = b;
        weak.intensity *= 0.85f;
        small.radius *= 0.5f;
        v3 axis = cross3(V3(r->a[0], r->a[1], r->a[2]), V3(r->b[0], r->b[1], r->b[2]));
        axis = mul3(axis, 1 / sqrtf(dot3(axis, axis)));
        turned.n[0] = axis.x;
        turned.n[1] = axis.y;
        turned.n[2] = axis.z;
        stronger += ask(r, &weak).stronger > 0;
        behind += ask(r, &turned).behind > 0;
        outside += ask(r, &small).outside > 0;
        discs += r->kind == NOC_LIGHT_DISC;
    }
    assert_true(stronger > 30 && behind > 10 && discs > 10 && outside == discs);
    noc_scene_destroy(s);
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(bounds_hold),
                                        cmocka_unit_test(a_bound_that_is_too_tight_is_found) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
