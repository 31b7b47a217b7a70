/* The built-in city's streets: carriageways, markings, and what stands along them. */
#include "city/builtin/town.h"

#include <math.h>

/* ---- trees, lamps, benches, cars ---- */

/* A crown of leaf sprays: triangles strewn through an ellipsoid, denser towards its skin, tilted outwards. Light of a
 * lamp passes between them, as it does in a real tree. */
static void crown(town *t, vec2 p, double z, double radius, double height, int sprays, uint32_t seed) {
    town_mat mat = TM_LEAF + (town_mat)(seed % 4);
    town_rng rng = { town_hash(seed, 41) };
    double scale = 3.1 / sqrt((double)sprays); /* fewer are larger: the same cover */
    for (int i = 0; i < sprays; i++) {
        double up = 1 - 2 * (i + 0.5) / sprays, turn = 0.618034 * i; /* evenly over the sphere */
        double ring = sqrt(1 - up * up), out[3] = { ring * town_cos(turn), ring * town_sin(turn), up };
        double depth = i % 4 == 0 ? town_range(&rng, 0.4, 0.75) : town_range(&rng, 0.75, 1.0);
        double size = radius * scale * town_range(&rng, 0.7, 1.2), u[3], v[3], n[3], c[3], lu = 0, lv = 0;
        depth *= 0.86 + 0.14 * town_sin(3 * turn + up); /* lobes */
        for (int k = 0; k < 3; k++) {
            n[k] = out[k] + town_range(&rng, -0.7, 0.7);
            u[k] = town_range(&rng, -1, 1);
            c[k] = (k == 0   ? p.x
                    : k == 1 ? p.y
                             : z) +
                   depth * out[k] *
                       (k < 2    ? radius
                        : up < 0 ? 0.72 * height
                                 : height);
        }
        for (int k = 0; k < 3; k++)
            v[k] = n[(k + 1) % 3] * u[(k + 2) % 3] - n[(k + 2) % 3] * u[(k + 1) % 3];
        for (int k = 0; k < 3; k++)
            u[k] = v[(k + 1) % 3] * n[(k + 2) % 3] - v[(k + 2) % 3] * n[(k + 1) % 3];
        for (int k = 0; k < 3; k++)
            lu += u[k] * u[k], lv += v[k] * v[k];
        if (lu < 0.01 || lv < 0.01)
            continue;
        double q[3][3];
        for (int k = 0; k < 3; k++) {
            double a = size * u[k] / sqrt(lu), b = size * v[k] / sqrt(lv);
            q[0][k] = c[k] - a;
            q[1][k] = c[k] + 0.6 * a - 0.75 * b;
            q[2][k] = c[k] + 0.6 * a + 0.75 * b;
        }
        town_tri(t, mat, q[0], q[1], q[2]);
    }
}

void town_tree(town *t, vec2 p, double z, double height, int sprays, uint32_t seed) {
    town_rng rng = { seed };
    double h = height * town_range(&rng, 0.8, 1.2), trunk = 0.32 * h, radius = h * town_range(&rng, 0.25, 0.31);
    town_pole(t, TM_TRUNK, p, 5, 0.022 * h, 0.012 * h, z - 0.1, z + trunk + 0.3 * h);
    crown(t, p, z + 0.66 * h, radius, 0.34 * h, sprays, town_hash(seed, 3));
}

/* Light that leaves flat and downwards: Phi = pi L A. The housing above is wider than the light, so it shades only the
 * sky. */
void town_arm_lamp(town *t, vec2 p, double z, vec2 to_road) {
    const double height = 8.6, reach = 1.9, radius = 0.17, lumens = 10000;
    vec2 head = { p.x + reach * to_road.x, p.y + reach * to_road.y }, c[4];
    town_pole(t, TM_POLE, p, 6, 0.11, 0.06, z, z + height + 0.12);
    town_rect((vec2){ p.x + 0.5 * reach * to_road.x, p.y + 0.5 * reach * to_road.y }, to_road, 0.5 * reach, 0.035, c);
    town_box(t, TM_POLE, c, z + height + 0.04, z + height + 0.1);
    town_rect(head, to_road, 0.42, 0.21, c);
    town_box(t, TM_POLE, c, z + height, z + height + 0.16);
    vec2 under[4] = { c[3], c[2], c[1], c[0] };
    town_flat(t, TM_POLE, under, 4, z + height);
    noc_light l = { .kind = NOC_LIGHT_DISC,
                    .position = { head.x, head.y, z + height - 0.015 },
                    .direction = { 0, 0, -1 },
                    .radius = radius,
                    .name = "lamp",
                    .group = t->lamps };
    town_light(t, &l, LIGHT_SODIUM, lumens / (3.14159265358979 * 3.14159265358979 * radius * radius));
}

/* A globe on a post: Phi = pi L 4 pi r^2. */
void town_globe_lamp(town *t, vec2 p, double z, int colour) {
    const double height = 4.4, radius = 0.2, lumens = 3600;
    town_pole(t, TM_POLE, p, 6, 0.12, 0.1, z, z + 0.6);
    town_pole(t, TM_POLE, p, 5, 0.06, 0.045, z + 0.6, z + height - radius - 0.02);
    noc_light l = { .kind = NOC_LIGHT_SPHERE,
                    .position = { p.x, p.y, z + height },
                    .radius = radius,
                    .name = "lamp",
                    .group = t->lamps };
    town_light(t, &l, colour, lumens / (4 * 3.14159265358979 * 3.14159265358979 * radius * radius));
}

void town_bench(town *t, vec2 p, vec2 dir, double z) {
    vec2 c[4], back = { p.x - 0.25 * -dir.y, p.y - 0.25 * dir.x };
    town_rect(p, dir, 0.9, 0.22, c);
    town_box(t, TM_WOOD, c, z + 0.38, z + 0.45);
    town_rect(back, dir, 0.9, 0.03, c);
    town_box(t, TM_WOOD, c, z + 0.55, z + 0.9);
    for (int i = -1; i <= 1; i += 2) {
        town_rect((vec2){ p.x + 0.7 * i * dir.x, p.y + 0.7 * i * dir.y }, dir, 0.04, 0.2, c);
        town_box(t, TM_METAL, c, z, z + 0.38);
    }
}

/* A section along x (front +) lofted across: body to the waist, then a narrower cabin. */
void town_car(town *t, vec2 p, vec2 dir, double z, bool lights, uint32_t seed) {
    static const double body[7][2] = { { 2.1, 0.3 },   { 2.15, 0.55 }, { 1.9, 0.75 }, { 0.95, 0.92 },
                                       { -1.7, 0.95 }, { -2.1, 0.8 },  { -2.1, 0.3 } };
    static const double cabin[4][2] = { { 0.95, 0.92 }, { 0.25, 1.42 }, { -1.05, 1.45 }, { -1.75, 0.95 } };
    town_mat paint = TM_CAR + (town_mat)(seed % 6);
    town_wall w = { .a = p, .dir = dir, .out = { dir.y, -dir.x }, .length = 1 }; /* s forward, before to the right */
    double q[4][3], waist = 0.86, roof = 0.66;
    for (int i = 0; i + 1 < 7; i++) {
        if (i == 3)
            continue; /* under the cabin */
        town_wall_point(&w, body[i][0], z + body[i][1], waist, q[0]);
        town_wall_point(&w, body[i][0], z + body[i][1], -waist, q[1]);
        town_wall_point(&w, body[i + 1][0], z + body[i + 1][1], -waist, q[2]);
        town_wall_point(&w, body[i + 1][0], z + body[i + 1][1], waist, q[3]);
        town_quad(t, paint, q[1], q[0], q[3], q[2]);
    }
    for (int side = -1; side <= 1; side += 2) {
        for (int i = 1; i + 1 < 7; i++) {
            town_wall_point(&w, body[0][0], z + body[0][1], side * waist, q[0]);
            town_wall_point(&w, body[i][0], z + body[i][1], side * waist, q[1]);
            town_wall_point(&w, body[i + 1][0], z + body[i + 1][1], side * waist, q[2]);
            town_tri(t, paint, q[0], side > 0 ? q[1] : q[2], side > 0 ? q[2] : q[1]);
        }
        for (int i = 0; i < 4; i++)
            town_wall_point(&w, cabin[i][0], z + cabin[i][1], side * (i == 0 || i == 3 ? waist : roof), q[i]);
        town_quad(t, TM_CAR_GLASS, side > 0 ? q[0] : q[3], side > 0 ? q[1] : q[2], side > 0 ? q[2] : q[1],
                  side > 0 ? q[3] : q[0]);
        for (int i = -1; i <= 1; i += 2) { /* wheels */
            vec2 c[4];
            double hub[3];
            town_wall_point(&w, 1.3 * i, 0, side * 0.78, hub);
            town_rect((vec2){ hub[0], hub[1] }, dir, 0.3, 0.1, c);
            town_box(t, TM_TYRE, c, z, z + 0.56);
        }
    }
    for (int i = 0; i < 3; i++) { /* windscreen, roof, rear window */
        double a = i == 0 ? waist : roof, b = i == 2 ? waist : roof;
        town_wall_point(&w, cabin[i][0], z + cabin[i][1], -a, q[0]);
        town_wall_point(&w, cabin[i][0], z + cabin[i][1], a, q[1]);
        town_wall_point(&w, cabin[i + 1][0], z + cabin[i + 1][1], b, q[2]);
        town_wall_point(&w, cabin[i + 1][0], z + cabin[i + 1][1], -b, q[3]);
        town_quad(t, i == 1 ? paint : TM_CAR_GLASS, q[0], q[1], q[2], q[3]);
    }
    for (int side = -1; lights && side <= 1; side += 2) {
        noc_light head = { .kind = NOC_LIGHT_DISC,
                           .radius = 0.08,
                           .direction = { dir.x, dir.y, -0.12 },
                           .name = "headlamp",
                           .group = t->cars };
        noc_light tail = { .kind = NOC_LIGHT_DISC,
                           .radius = 0.07,
                           .direction = { -dir.x, -dir.y, 0 },
                           .emission = { 650, 25, 12 },
                           .name = "tail lamp",
                           .group = t->cars };
        town_wall_point(&w, 2.2, z + 0.6, side * 0.62, head.position);
        town_wall_point(&w, -2.12, z + 0.68, side * 0.66, tail.position);
        town_light(t, &head, LIGHT_WHITE, 7000);
        t->failed = t->failed || noc_scene_add_light(t->scene, &tail) < 0;
    }
}

/* ---- along the kerb ---- */

static bool sodium_street(town_way way) { return way == WAY_AVENUE; }

void town_kerbside(town *t, const town_poly *block, int id) {
    for (int k = 0; k < block->n; k++) {
        town_way way = block->way[k];
        town_wall e = town_wall_make(block->p[k], block->p[(k + 1) % block->n]);
        town_rng rng = { town_hash(t->params.seed, 8000u + (uint32_t)(id * TOWN_POLY_MAX + k)) };
        if (way == WAY_NONE || e.length < 14)
            continue;
        bool avenue = sodium_street(way);
        double spacing = avenue ? 26 : 21, first = 6 + ((k + id) & 1 ? 0.5 * spacing : 0) * (e.length > 40);
        double road[3];
        for (double s = first; s < e.length - 4; s += spacing) {
            town_wall_point(&e, s, 0, -0.65, road);
            vec2 at = town_warp(t, (vec2){ road[0], road[1] }), over;
            town_wall_point(&e, s, 0, 1.0, road);
            over = town_warp(t, (vec2){ road[0], road[1] });
            if (avenue)
                town_arm_lamp(t, at, TOWN_KERB, town_wall_make(at, over).dir);
            else
                town_globe_lamp(t, at, TOWN_KERB, LIGHT_NEUTRAL);
        }
        double step = avenue ? 10.3 : 13;
        for (double s = 3.5 + 0.37 * spacing; s < e.length - 5 && (avenue || way == WAY_QUAY || (id + k) % 3 == 0);
             s += step) {
            double phase = (s - first) / spacing, off = fabs(phase - floor(phase + 0.5)) * spacing;
            if (off < 2.4 || town_chance(&rng, 0.1))
                continue; /* clear of the lamps */
            town_wall_point(&e, s, 0, -1.3, road);
            town_tree(t, town_warp(t, (vec2){ road[0], road[1] }), TOWN_KERB, avenue ? 8.6 : 7, 220,
                      town_hash(rng.state, 77));
        }
        for (double s = 9; s < e.length - 9; s += 5.7) {
            if (!town_chance(&rng, avenue ? 0.3 : 0.42))
                continue;
            town_wall_point(&e, s, 0, 1.15, road);
            vec2 at = town_warp(t, (vec2){ road[0], road[1] }), ahead;
            town_wall_point(&e, s + 1, 0, 1.15, road);
            ahead = town_warp(t, (vec2){ road[0], road[1] });
            town_car(t, at, town_wall_make(at, ahead).dir, 0, false, town_hash(rng.state, 5));
        }
        if (avenue && e.length > 40)
            for (double s = town_range(&rng, 10, 30); s < e.length - 8; s += town_range(&rng, 25, 60)) {
                town_wall_point(&e, s, 0, 4.4, road);
                vec2 at = town_warp(t, (vec2){ road[0], road[1] }), ahead;
                town_wall_point(&e, s + 1, 0, 4.4, road);
                ahead = town_warp(t, (vec2){ road[0], road[1] });
                town_car(t, at, town_wall_make(at, ahead).dir, 0, true, town_hash(rng.state, 6));
            }
    }
    town_flush(t, "block %d/kerbside", id);
}

/* ---- carriageways ---- */

static double crossing(const town_axis *axis, double v, double margin) { /* where the gap around v ends, or v itself */
    for (size_t i = 0; i < axis->gaps.len; i++)
        if (v > axis->gaps.data[i].lo - margin && v < axis->gaps.data[i].hi + margin)
            return axis->gaps.data[i].hi + margin;
    return v;
}

/* A quad of the plan, warped, at a height. along: the axis (0: x) that s runs on. */
static void plan_quad(town *t, town_mat mat, int along, double s0, double s1, double c0, double c1, double z) {
    vec2 p[4] = { { s0, c0 }, { s1, c0 }, { s1, c1 }, { s0, c1 } };
    vec2 q[4];
    for (int i = 0; i < 4; i++)
        q[i] = town_warp(t, along ? (vec2){ p[i].y, p[i].x } : p[i]);
    if (along) {
        vec2 r[4] = { q[0], q[3], q[2], q[1] };
        town_flat(t, mat, r, 4, z);
    } else {
        town_flat(t, mat, q, 4, z);
    }
}

/* Streets along one axis: dashes between the lanes, zebra crossings where avenues meet others. */
static void markings(town *t, int along) {
    const town_axis *own = &t->axis[!along], *other = &t->axis[along];
    vec2 da, dd;
    double dw;
    town_diagonal(t, &da, &dd, &dw);
    for (size_t i = 1; i + 1 < own->gaps.len; i++) {
        const town_gap *g = &own->gaps.data[i];
        double middle = 0.5 * (g->lo + g->hi);
        if (g->river)
            continue;
        for (double s = -t->half + 2; s < t->half - 5; s += 7) {
            double after = crossing(other, s + 1.5, 6);
            if (after != s + 1.5) {
                s = after - 7 + 1;
                continue;
            }
            vec2 p = along ? (vec2){ middle, s + 1.5 } : (vec2){ s + 1.5, middle };
            if (fabs(dd.x * (p.y - da.y) - dd.y * (p.x - da.x)) < dw + 6 && g->kind != WAY_AVENUE)
                continue;
            if (g->kind == WAY_AVENUE)
                plan_quad(t, TM_MARKING, along, s, s + 3, middle - 0.07, middle + 0.07, 0.004);
        }
        for (size_t j = 1; j + 1 < other->gaps.len && g->kind == WAY_AVENUE; j++)
            for (int side = 0; side < 2; side++) { /* bars lie along the traffic they stop */
                const town_gap *o = &other->gaps.data[j];
                double s = side ? o->hi + 1.0 : o->lo - 4.0;
                if (o->river) /* before the bridge */
                    continue;
                for (double c = g->lo + 0.8; c < g->hi - 0.8; c += 1.05)
                    plan_quad(t, TM_MARKING, along, s, s + 3, c, c + 0.52, 0.004);
            }
    }
}

void town_roads(town *t) {
    /* the carriageway is one sheet under the blocks, with the river left out */
    int columns = NOC_MAX((int)(2 * t->half / 11), 8);
    for (int i = 0; i < columns; i++) {
        double x0 = -t->half + 2 * t->half * i / columns, x1 = -t->half + 2 * t->half * (i + 1) / columns;
        for (size_t j = 0; j + 1 < t->axis[1].gaps.len; j++) {
            const town_gap *a = &t->axis[1].gaps.data[j], *b = &t->axis[1].gaps.data[j + 1];
            double y0 = a->river ? a->hi - TOWN_QUAY_STREET : j ? 0.5 * (a->lo + a->hi) : a->lo;
            double y1 = b->river                      ? b->lo + TOWN_QUAY_STREET
                        : j + 2 < t->axis[1].gaps.len ? 0.5 * (b->lo + b->hi)
                                                      : b->hi;
            for (int k = 0; k < 4; k++)
                plan_quad(t, TM_ROAD, 0, x0, x1, y0 + (y1 - y0) * k / 4, y0 + (y1 - y0) * (k + 1) / 4, 0);
        }
    }
    town_flush(t, "streets");
    markings(t, 0);
    markings(t, 1);
    town_flush(t, "road markings");
}
