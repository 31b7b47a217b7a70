/* What cars look like: bodies of our own making, with their lamps. A model's x is forward, y left, z up, and its origin
 * lies on the ground between the axles. */
#include "city/city.h"
#include "city/traffic/traffic.h"

#include <math.h>

typedef struct part {
    NOC_ARRAY(double) xyz;
    NOC_ARRAY(uint32_t) indices;
    bool refused;
} part;

enum { PAINT, GLASS, TYRE, PARTS };

/* Seen from the left, x and z: the body from the bumper over the bonnet and the boot to the rear, and the cabin on it,
 * from the foot of the windscreen to that of the rear window. */
typedef struct shape {
    const char *name;
    double body[8][2], cabin[4][2];
    double half_width, half_roof, axle[2], wheel;
    double headlamp[2], tail_lamp[2]; /* x where the body ends, and height */
    double lamps_apart;               /* half */
} shape;

static const shape shapes[] = {
    { "sedan",
      { { 2.2, .3 },
        { 2.27, .58 },
        { 2.15, .76 },
        { .95, .94 },
        { -1.7, .97 },
        { -2.2, .9 },
        { -2.27, .58 },
        { -2.2, .3 } },
      { { .95, .94 }, { .2, 1.43 }, { -1.05, 1.46 }, { -1.7, .97 } },
      .88,
      .64,
      { 1.32, -1.32 },
      .31,
      { 2.27, .64 },
      { -2.25, .8 },
      .64 },
    { "van",
      { { 2.4, .3 },
        { 2.48, .62 },
        { 2.36, .88 },
        { 1.75, 1.12 },
        { -2.4, 1.12 },
        { -2.42, .9 },
        { -2.46, .58 },
        { -2.4, .3 } },
      { { 1.75, 1.12 }, { 1.05, 1.92 }, { -2.3, 1.96 }, { -2.4, 1.12 } },
      .95,
      .84,
      { 1.55, -1.45 },
      .33,
      { 2.47, .7 },
      { -2.45, .86 },
      .72 },
};

static const struct {
    int shape;
    float paint[3];
    double kelvin;
    double share; /* of the cars */
} kinds[] = {
    { 0, { .03f, .03f, .035f }, TRAFFIC_LED, .2 },     { 0, { .45f, .45f, .46f }, TRAFFIC_HALOGEN, .18 },
    { 0, { .62f, .62f, .60f }, TRAFFIC_LED, .17 },     { 0, { .16f, .17f, .18f }, TRAFFIC_HALOGEN, .13 },
    { 0, { .05f, .09f, .24f }, TRAFFIC_LED, .1 },      { 0, { .30f, .03f, .03f }, TRAFFIC_HALOGEN, .08 },
    { 1, { .62f, .62f, .60f }, TRAFFIC_HALOGEN, .09 }, { 1, { .25f, .26f, .28f }, TRAFFIC_LED, .05 },
};

/* ---- bodies ---- */

static uint32_t vertex(part *p, double x, double y, double z) {
    const double v[3] = { x, y, z };
    p->refused = !array_append(&p->xyz, v, (size_t)3) || p->refused;
    return (uint32_t)(p->xyz.len / 3 - 1);
}

static void triangle(part *p, uint32_t a, uint32_t b, uint32_t c) {
    const uint32_t t[3] = { a, b, c };
    p->refused = !array_append(&p->indices, t, (size_t)3) || p->refused;
}

/* The band between two points of the side's outline, from the right half width to the left. The outline runs over the
 * top from the front to the rear, so that the band looks outwards. */
static void band(part *p, const double a[2], const double b[2], double width_a, double width_b) {
    uint32_t v[4] = { vertex(p, a[0], -width_a, a[1]), vertex(p, a[0], width_a, a[1]), vertex(p, b[0], width_b, b[1]),
                      vertex(p, b[0], -width_b, b[1]) };
    triangle(p, v[0], v[1], v[2]);
    triangle(p, v[0], v[2], v[3]);
}

/* Both sides of an outline, as a fan from its first point. widths: half, at each point. */
static void sides(part *p, const double (*outline)[2], const double *widths, int count) {
    for (int side = -1; side <= 1; side += 2)
        for (int i = 1; i + 1 < count; i++) {
            uint32_t v[3];
            const int at[3] = { 0, i, i + 1 };
            for (int k = 0; k < 3; k++)
                v[k] = vertex(p, outline[at[k]][0], side * widths[at[k]], outline[at[k]][1]);
            triangle(p, v[0], v[side < 0 ? 2 : 1], v[side < 0 ? 1 : 2]);
        }
}

static void wheel(part *p, double x, double y, double radius) {
    enum { SPOKES = 10 };
    double out = y > 0 ? .04 : -.04;
    uint32_t rim[SPOKES], inner[SPOKES];
    for (int i = 0; i < SPOKES; i++) {
        double c = cos(2 * M_PI * i / SPOKES), d = sin(2 * M_PI * i / SPOKES);
        rim[i] = vertex(p, x + radius * c, y + out, radius + radius * d);
        inner[i] = vertex(p, x + radius * c, y - 4 * out, radius + radius * d);
    }
    for (int i = 0; i < SPOKES; i++) {
        int k = (i + 1) % SPOKES, a = y > 0 ? k : i, b = y > 0 ? i : k;
        triangle(p, rim[a], rim[b], inner[b]);
        triangle(p, rim[a], inner[b], inner[a]);
        if (i > 0 && i + 1 < SPOKES)
            triangle(p, rim[0], rim[b], rim[a]);
    }
}

static void build(const shape *s, part parts[PARTS]) {
    double full[8], roof[4] = { s->half_width, s->half_roof, s->half_roof, s->half_width };
    for (int i = 0; i < 8; i++)
        full[i] = s->half_width;
    for (int i = 0; i < 7; i++)
        if (i != 3) /* under the cabin */
            band(&parts[PAINT], s->body[i], s->body[i + 1], s->half_width, s->half_width);
    band(&parts[PAINT], s->body[7], s->body[0], s->half_width, s->half_width);
    sides(&parts[PAINT], s->body, full, 8);
    for (int i = 0; i < 3; i++)
        band(&parts[i == 1 ? PAINT : GLASS], s->cabin[i], s->cabin[i + 1], roof[i], roof[i + 1]);
    sides(&parts[GLASS], s->cabin, roof, 4);
    for (int i = 0; i < 4; i++)
        wheel(&parts[TYRE], s->axle[i / 2], (i % 2 ? 1 : -1) * (s->half_width - .03), s->wheel);
}

static bool add_body(noc_scene *scene, int model, const shape *s, const int material[PARTS]) {
    part parts[PARTS] = { 0 };
    bool good = true;
    build(s, parts);
    for (int i = 0; i < PARTS; i++) {
        const noc_mesh mesh = { parts[i].xyz.len / 3,
                                parts[i].xyz.data,
                                parts[i].indices.len / 3,
                                parts[i].indices.data,
                                material[i],
                                model,
                                0,
                                s->name };
        if (parts[i].refused) {
            noc_scene_out_of_memory(scene);
            good = false;
        }
        good = good && noc_scene_add_mesh(scene, &mesh) >= 0;
        array_free(&parts[i].xyz);
        array_free(&parts[i].indices);
    }
    return good;
}

/* ---- models ---- */

static bool add_kind(noc_scene *scene, int kind, int material[PARTS], const noc_traffic_params *params, int beam,
                     traffic_models *models) {
    const shape *s = &shapes[kinds[kind].shape];
    noc_material paint = { .f0 = .05f, .roughness = .2f, .cls = NOC_CLASS_VEHICLE };
    traffic_lamp_places at;
    memcpy(paint.albedo, kinds[kind].paint, sizeof(paint.albedo));
    material[PAINT] = noc_scene_add_material(scene, &paint);
    int model = material[PAINT] < 0 ? -1 : noc_scene_add_model(scene, s->name);
    for (int side = 0; side < 2; side++) {
        double y = (side ? 1 : -1) * s->lamps_apart;
        memcpy(at.head[side], (double[]){ s->headlamp[0], y, s->headlamp[1] }, sizeof(at.head[side]));
        memcpy(at.tail[side], (double[]){ s->tail_lamp[0], y, s->tail_lamp[1] }, sizeof(at.tail[side]));
    }
    if (model < 0 || !add_body(scene, model, s, material) ||
        !traffic_lamps(scene, model, &at, params, beam, kinds[kind].kelvin))
        return false;
    const traffic_model made = { model, kinds[kind].share, s->axle[0] - s->axle[1] };
    if (array_push(&models->of, made))
        return true;
    noc_scene_out_of_memory(scene);
    return false;
}

bool traffic_our_models(noc_scene *scene, const noc_traffic_params *params, traffic_models *models) {
    const noc_material glass = { { .02f, .02f, .025f }, .06f, .1f, { 0 }, false, NOC_CLASS_VEHICLE };
    const noc_material rubber = { { .03f, .03f, .03f }, 0, 1, { 0 }, false, NOC_CLASS_VEHICLE };
    int material[PARTS] = { 0, noc_scene_add_material(scene, &glass), noc_scene_add_material(scene, &rubber) };
    int beam = params->headlamp > 0 ? traffic_beam(scene, params->side) : 1;
    bool good = material[GLASS] >= 0 && material[TYRE] >= 0 && beam;
    for (size_t i = 0; i < NOC_COUNT(kinds) && good; i++)
        good = add_kind(scene, (int)i, material, params, beam, models);
    return good;
}
