/* The cityscape: some streets of the built-in city with few lit windows, and strings of coloured lights that zigzag
 * over them from post to post: lamp posts that light streets, and thousands of weak lights that each matter on a few
 * metres. */
#include "city/builtin/kit.h"

#include <math.h>

#define SIZE 270.0 /* m: three by three blocks */
#define LIT 0.06   /* share of rooms that are, where those of other cities are by default */
#define POST_APART 7.5
#define POST_HEIGHT 6.1
#define SAG 0.8
#define BULB_APART 0.5
#define BULB_RADIUS 0.045
#define BULB_LUMENS 110.0
#define SPOT_LUMENS 2600.0
#define BENCH_LUMENS 12.0

static const float colours[][3] = { { 1, .06f, .03f }, { 1, .42f, .04f }, { 1, .80f, .18f },
                                    { .10f, 1, .12f }, { .06f, .35f, 1 }, { .75f, .08f, .9f } };

/* Does a place of the plan lie on the slanting avenue? */
static bool on_diagonal(const town *t, vec2 p) {
    vec2 a, d;
    double w;
    town_diagonal(t, &a, &d, &w);
    return fabs((p.x - a.x) * d.y - (p.y - a.y) * d.x) < w + 1.5;
}

static void bulb(town *t, vec3 p, int colour) {
    vec2 socket[4];
    town_rect((vec2){ p.x, p.y }, (vec2){ 1, 0 }, 0.02, 0.02, socket);
    town_box(t, TM_METAL, socket, p.z - 0.07, p.z + 0.02);
    const double luminance = BULB_LUMENS / (4 * 3.14159265358979 * 3.14159265358979 * BULB_RADIUS * BULB_RADIUS);
    noc_light l = { .kind = NOC_LIGHT_SPHERE,
                    .position = { p.x, p.y, p.z - 0.08 - BULB_RADIUS },
                    .radius = BULB_RADIUS,
                    .name = "party light" };
    for (int c = 0; c < 3; c++)
        l.emission[c] = (float)luminance * colours[colour][c];
    t->failed = t->failed || noc_scene_add_light(t->scene, &l) < 0;
}

/* A cable of three sides between two points; so short that it may be straight. */
static void cable(town *t, vec3 a, vec3 b) {
    vec3 along = unit(sub(b, a)), side = unit(cross(along, v3(0, 0, 1))), up = cross(side, along), corner[3];
    for (int i = 0; i < 3; i++)
        corner[i] = add(scale(side, 0.012 * town_cos(i / 3.0)), scale(up, 0.012 * town_sin(i / 3.0)));
    for (int i = 0; i < 3; i++) {
        vec3 q[4] = { add(a, corner[i]), add(a, corner[(i + 1) % 3]), add(b, corner[(i + 1) % 3]), add(b, corner[i]) };
        double p[4][3];
        memcpy(p, q, sizeof(p));
        town_quad(t, TM_TYRE, p[0], p[1], p[2], p[3]);
    }
}

/* Sags as a parabola, which a catenary is nearly. */
static void string_of_lights(town *t, vec2 a, vec2 b, town_rng *rng) {
    double dx = b.x - a.x, dy = b.y - a.y, length = sqrt(dx * dx + dy * dy), z = TOWN_KERB + POST_HEIGHT - 0.1;
    int n = NOC_MAX((int)(length / BULB_APART), 2), colour = town_below(rng, (int)NOC_COUNT(colours));
    vec3 last = v3(a.x, a.y, z);
    for (int i = 1; i <= n; i++) {
        double f = (double)i / n;
        vec3 p = v3(a.x + f * dx, a.y + f * dy, z - SAG * 4 * f * (1 - f));
        cable(t, last, p);
        if (i < n)
            bulb(t, p, (colour + i) % (int)NOC_COUNT(colours));
        last = p;
    }
}

/* A coloured floodlight at a post, turned to the fronts behind it: `out` leads away from the street. */
static void spot(town *t, vec2 post, vec2 out, int colour) {
    const double r = 0.09, z = TOWN_KERB + 3.1;
    vec2 body[4], c = { post.x + 0.16 * out.x, post.y + 0.16 * out.y };
    town_rect(c, out, 0.11, 0.1, body);
    town_box(t, TM_METAL, body, z - 0.1, z + 0.1);
    noc_light l = { .kind = NOC_LIGHT_DISC,
                    .position = { c.x + 0.125 * out.x, c.y + 0.125 * out.y, z },
                    .direction = { out.x, out.y, 0.35 },
                    .radius = r,
                    .name = "coloured floodlight" };
    for (int k = 0; k < 3; k++)
        l.emission[k] = (float)(SPOT_LUMENS / (3.14159265358979 * 3.14159265358979 * r * r)) * colours[colour][k];
    t->failed = t->failed || noc_scene_add_light(t->scene, &l) < 0;
}

/* A bench with a dim lamp under its seat, which no other light reaches: what a picker of lights overlooks first. */
static void bench(town *t, vec2 p, vec2 along) {
    const double r = 0.06, z = TOWN_KERB + 0.40,
                 luminance = BENCH_LUMENS / (3.14159265358979 * 3.14159265358979 * r * r);
    vec2 c[4], across = { -along.y, along.x };
    town_rect(p, along, 1.1, 0.3, c);
    town_box(t, TM_METAL, c, z, z + 0.08);
    for (int side = -1; side < 2; side++) { /* two feet, and a panel behind */
        vec2 at = side ? (vec2){ p.x + side * 1.0 * along.x, p.y + side * 1.0 * along.y }
                       : (vec2){ p.x - 0.27 * across.x, p.y - 0.27 * across.y };
        town_rect(at, along, side ? 0.05 : 1.1, side ? 0.25 : 0.03, c);
        town_box(t, TM_METAL, c, TOWN_KERB, z);
    }
    noc_light l = { .kind = NOC_LIGHT_DISC,
                    .position = { p.x, p.y, z - 0.02 },
                    .direction = { 0, 0, -1 },
                    .radius = r,
                    .name = "bench light" };
    for (int k = 0; k < 3; k++)
        l.emission[k] = (float)luminance * colours[3][k];
    t->failed = t->failed || noc_scene_add_light(t->scene, &l) < 0;
}

static vec2 in_plan(int axis, double across, double along) {
    return axis == 0 ? (vec2){ across, along } : (vec2){ along, across };
}

/* Posts along both kerbs of one street beside one block, in turn left and right, and a string from each to the next. */
static void garland(town *t, int axis, const town_gap *street, double from, double to, town_rng *rng) {
    vec2 last = { 0, 0 };
    bool linked = false;
    int side = 0;
    for (double s = from + 5; s < to - 4; s += POST_APART, side = !side) {
        vec2 plan = in_plan(axis, side ? street->hi + 0.35 : street->lo - 0.35, s), p = town_warp(t, plan);
        if (on_diagonal(t, plan)) {
            linked = false;
            continue;
        }
        town_pole(t, TM_POLE, p, 6, 0.06, 0.045, TOWN_KERB, TOWN_KERB + POST_HEIGHT);
        vec2 beyond = town_warp(t, in_plan(axis, side ? street->hi + 1.35 : street->lo - 1.35, s));
        spot(t, p, (vec2){ beyond.x - p.x, beyond.y - p.y }, town_below(rng, (int)NOC_COUNT(colours)));
        if (linked)
            string_of_lights(t, last, p, rng);
        last = p;
        linked = true;
    }
}

static void dress(town *t) {
    town_rng rng = { town_hash(t->params.seed, 700) };
    for (int axis = 0; axis < 2; axis++) {
        int streets = (int)t->axis[axis].gaps.len, blocks = (int)t->axis[!axis].gaps.len - 1;
        for (int i = 1; i + 1 < streets; i++)
            for (int j = 0; j < blocks; j++) {
                const town_gap *g = &t->axis[!axis].gaps.data[j];
                garland(t, axis, &t->axis[axis].gaps.data[i], g[0].hi, g[1].lo, &rng);
            }
    }
    town_flush(t, "party lights");
    const town_gap *street = &t->axis[0].gaps.data[2]; /* a narrow one, where the strings hang low and close */
    double along = t->axis[1].gaps.data[1].hi;
    vec2 seat = town_warp(t, (vec2){ street->hi + 1.3, along + 8.5 }),
         end = town_warp(t, (vec2){ street->hi + 1.3, along + 9.5 });
    double length = sqrt((end.x - seat.x) * (end.x - seat.x) + (end.y - seat.y) * (end.y - seat.y));
    bench(t, seat, (vec2){ (end.x - seat.x) / length, (end.y - seat.y) / length });
    town_flush(t, "bench");
    vec2 eye = town_warp(t, (vec2){ street->lo + 1.8, along - 3 }),
         target = town_warp(t, (vec2){ street->hi - 2, along + 35 });
    noc_camera c = {
        .eye = { eye.x, eye.y, 1.9 }, .target = { target.x, target.y, 5.0 }, .up = { 0, 0, 1 }, .fov_deg = 58
    };
    t->failed = t->failed || noc_scene_set_camera(t->scene, &c) != NOC_OK;
}

noc_status scene_cityscape(noc_scene *scene, const noc_builtin_params *params, bool windows) {
    noc_city_params city = noc_city_default_params();
    city.seed = params->seed;
    city.size = SIZE;
    return town_build(scene, &city, &(town_style){ windows, LIT / noc_window_default_params().lit_windows, dress });
}
