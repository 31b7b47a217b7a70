/* The built-in city's open places: park, square with a church, small greens, the river with its bridges. */
#include "city/builtin/town.h"

#include <math.h>

static const vec2 EAST = { 1, 0 };

static vec2 toward(vec2 a, vec2 b, double f) { return (vec2){ a.x + f * (b.x - a.x), a.y + f * (b.y - a.y) }; }

static double distance(vec2 a, vec2 b) { return sqrt((a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y)); }

static double to_segment(vec2 p, vec2 a, vec2 b) {
    double x = b.x - a.x, y = b.y - a.y, f = ((p.x - a.x) * x + (p.y - a.y) * y) / NOC_MAX(x * x + y * y, 1e-9);
    return distance(p, toward(a, b, NOC_CLAMP(f, 0, 1)));
}

static town_poly inset_by(const town_poly *poly, double by) {
    double d[4] = { by, by, by, by };
    return town_poly_inset(poly, d);
}

static bool contains(const town_poly *poly, vec2 p) {
    for (int i = 0; i < poly->n; i++) {
        vec2 a = poly->p[i], b = poly->p[(i + 1) % poly->n];
        if ((b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x) < 0)
            return false;
    }
    return poly->n > 0;
}

/* A polygon of the plan as a flat sheet: edges cut so that they bend with the warp. */
static void sheet(town *t, town_mat mat, const town_poly *poly, double z) {
    vec2 middle = town_warp(t, town_poly_centre(poly));
    for (int i = 0; i < poly->n; i++) {
        vec2 a = poly->p[i], b = poly->p[(i + 1) % poly->n];
        int pieces = NOC_MAX((int)(distance(a, b) / 8), 1);
        for (int k = 0; k < pieces; k++) {
            vec2 c[3] = { middle, town_warp(t, toward(a, b, (double)k / pieces)),
                          town_warp(t, toward(a, b, (k + 1.0) / pieces)) };
            town_flat(t, mat, c, 3, z);
        }
    }
}

static void disc(town *t, town_mat mat, vec2 c, double rx, double ry, double z) {
    vec2 p[20];
    for (int i = 0; i < 20; i++)
        p[i] = (vec2){ c.x + rx * town_cos(i / 20.0), c.y + ry * town_sin(i / 20.0) };
    town_flat(t, mat, p, 20, z);
}

/* A stone rim around a basin. */
static void rim(town *t, vec2 c, double rx, double ry, double z0, double z1) {
    for (int i = 0; i < 20; i++) {
        double a = i / 20.0, b = (i + 1) / 20.0;
        vec2 in0 = { c.x + rx * town_cos(a), c.y + ry * town_sin(a) },
             in1 = { c.x + rx * town_cos(b), c.y + ry * town_sin(b) };
        vec2 out0 = { c.x + (rx + 0.4) * town_cos(a), c.y + (ry + 0.4) * town_sin(a) };
        vec2 out1 = { c.x + (rx + 0.4) * town_cos(b), c.y + (ry + 0.4) * town_sin(b) };
        town_wall outside = town_wall_make(out0, out1), inside = town_wall_make(in1, in0);
        vec2 top[4] = { in0, out0, out1, in1 };
        town_wall_rect(t, TM_STONE, &outside, 0, outside.length, z0, z1, 0);
        town_wall_rect(t, TM_STONE, &inside, 0, inside.length, z0, z1, 0);
        town_flat(t, TM_STONE, top, 4, z1);
    }
}

void town_park(town *t, const town_poly *block, int id) {
    town_poly lawn = inset_by(block, 4.5);
    vec2 centre = town_poly_centre(&lawn), gate[TOWN_POLY_MAX];
    town_rng rng = { town_hash(t->params.seed, 9000u + (uint32_t)id) };
    sheet(t, TM_LAWN, &lawn, TOWN_KERB + 0.04);
    disc(t, TM_GRAVEL, town_warp(t, centre), 7.5, 7.5, TOWN_KERB + 0.1);
    rim(t, town_warp(t, centre), 3, 3, TOWN_KERB, TOWN_KERB + 0.5);
    disc(t, TM_WATER, town_warp(t, centre), 3, 3, TOWN_KERB + 0.35);
    for (int i = 0; i < lawn.n; i++) { /* paths from the gates to the fountain, one above the other by millimetres */
        gate[i] = toward(lawn.p[i], lawn.p[(i + 1) % lawn.n], 0.35 + 0.3 * town_next(&rng));
        int pieces = NOC_MAX((int)(distance(gate[i], centre) / 4), 2);
        double bend = town_range(&rng, -5, 5);
        town_wall axis = town_wall_make(gate[i], centre);
        vec2 last[2];
        for (int k = 0; k <= pieces; k++) {
            double f = (double)k / pieces, side = bend * 4 * f * (1 - f), p[3];
            vec2 c[2];
            for (int m = 0; m < 2; m++) {
                town_wall_point(&axis, f * axis.length, 0, side + (m ? 1.5 : -1.5), p);
                c[m] = town_warp(t, (vec2){ p[0], p[1] });
            }
            vec2 q[4] = { last[1], c[1], c[0], last[0] };
            if (k)
                town_flat(t, TM_GRAVEL, q, 4, TOWN_KERB + 0.07 + 0.004 * (i % 6));
            if (k % 4 == 2 && f < 0.85) {
                town_wall_point(&axis, f * axis.length, 0, side + 2.1, p);
                vec2 at = town_warp(t, (vec2){ p[0], p[1] });
                town_globe_lamp(t, at, TOWN_KERB + 0.04, LIGHT_NEUTRAL);
                town_bench(t, toward(at, c[1], -0.2), town_wall_make(c[0], c[1]).out, TOWN_KERB + 0.04);
            }
            last[0] = c[0];
            last[1] = c[1];
        }
    }
    for (int i = 0; i < 6; i++) { /* around the fountain */
        vec2 c = town_warp(t, centre), at = { c.x + 6.7 * town_cos(i / 6.0), c.y + 6.7 * town_sin(i / 6.0) };
        town_bench(t, at, (vec2){ -town_sin(i / 6.0), town_cos(i / 6.0) }, TOWN_KERB + 0.1);
        if (i % 2)
            town_globe_lamp(t, (vec2){ c.x + 7 * town_cos((i + 0.5) / 6), c.y + 7 * town_sin((i + 0.5) / 6) },
                            TOWN_KERB + 0.1, LIGHT_NEUTRAL);
    }
    vec2 lo = lawn.p[0], hi = lawn.p[0];
    for (int i = 1; i < lawn.n; i++) {
        lo = (vec2){ NOC_MIN(lo.x, lawn.p[i].x), NOC_MIN(lo.y, lawn.p[i].y) };
        hi = (vec2){ NOC_MAX(hi.x, lawn.p[i].x), NOC_MAX(hi.y, lawn.p[i].y) };
    }
    town_poly inner = inset_by(&lawn, 2);
    for (double y = lo.y; y < hi.y; y += 7.5)
        for (double x = lo.x; x < hi.x; x += 7.5) {
            vec2 p = { x + town_range(&rng, 0, 6), y + town_range(&rng, 0, 6) };
            bool clear = contains(&inner, p) && distance(p, centre) > 11 && town_chance(&rng, 0.85);
            for (int i = 0; i < lawn.n; i++)
                clear = clear && to_segment(p, gate[i], centre) > 4.8;
            if (clear)
                town_tree(t, town_warp(t, p), TOWN_KERB, 10.5, 180, town_hash(rng.state, 1));
        }
    town_flush(t, "block %d/park", id);
}

/* ---- the church ---- */

/* A spot on the ground that lights a wall from below. */
static void uplight(town *t, vec2 p, vec2 at, double z, double rise, double lumens) {
    vec2 c[4], dir = town_wall_make(p, at).dir;
    double reach = distance(p, at), r = 0.14;
    town_rect(p, dir, 0.16, 0.2, c);
    town_box(t, TM_METAL, c, z, z + 0.22);
    noc_light l = { .kind = NOC_LIGHT_DISC,
                    .position = { p.x + 0.05 * dir.x, p.y + 0.05 * dir.y, z + 0.4 },
                    .direction = { dir.x * reach, dir.y * reach, rise },
                    .radius = r,
                    .name = "floodlight",
                    .group = t->lamps };
    town_light(t, &l, LIGHT_WARM, lumens / (3.14159265358979 * 3.14159265358979 * r * r));
}

/* Where it is lit all its windows are. */
static void church_windows(town *t, const town_wall *w, int n, double z0, double z1, double width, bool lit) {
    const town_room room = { NOC_WINDOW_FLAT, 0.5, TOWN_SHOPS_OFTEN, LIGHT_CANDLE, 28 };
    for (int i = 0; i < n; i++) {
        double s = w->length * (i + 0.5) / n;
        town_wall_rect(t, TM_STONE, w, s - 0.5 * width - 0.3, s + 0.5 * width + 0.3, z0 - 0.3, z1 + 0.3, 0.05);
        town_wall_rect(t, TM_GLASS, w, s - 0.5 * width, s + 0.5 * width, z0, z1, 0.07);
        if (lit)
            town_wall_pane(t, TM_GLASS, w, s - 0.5 * width + 0.08, s + 0.5 * width - 0.08, z0 + 0.1, z1 - 0.1, 0.09,
                           &room);
    }
}

static void put3(double out[3], vec2 p, double z) {
    out[0] = p.x;
    out[1] = p.y;
    out[2] = z;
}

static void church_nave(town *t, const vec2 c[4], double z, double eave, double ridge) {
    double q[4][3];
    vec2 end[2] = { toward(c[0], c[3], 0.5), toward(c[1], c[2], 0.5) };
    for (int i = 0; i < 4; i++) {
        town_wall w = town_wall_make(c[i], c[(i + 1) % 4]);
        town_wall_rect(t, TM_CONCRETE, &w, 0, w.length, z, eave, 0);
        if (i % 2 == 0) { /* long sides: windows between buttresses, then the roof */
            church_windows(t, &w, 6, z + 3, z + 8.5, 1.5, true);
            for (int k = 0; k <= 6; k++) {
                vec2 b[4], at;
                double p[3];
                town_wall_point(&w, NOC_CLAMP(w.length * k / 6, 0.5, w.length - 0.5), 0, 0.35, p);
                at = (vec2){ p[0], p[1] };
                town_rect(at, w.dir, 0.4, 0.4, b);
                town_box(t, TM_STONE, b, z, eave - 1.6);
            }
            put3(q[0], c[i], eave), put3(q[1], c[i + 1], eave);
            put3(q[2], end[i == 0], ridge), put3(q[3], end[i != 0], ridge);
            town_quad(t, TM_SLATE, q[0], q[1], q[2], q[3]);
        } else {
            put3(q[0], c[i], eave), put3(q[1], c[(i + 1) % 4], eave), put3(q[2], end[i == 1], ridge);
            town_tri(t, TM_CONCRETE, q[0], q[1], q[2]);
        }
    }
}

void town_church(town *t, vec2 centre, vec2 dir) {
    const double z = TOWN_KERB, eave = z + 11.5, ridge = z + 21, tower = z + 35, tip = z + 57;
    vec2 nave[4], shaft[4], crown[4], across = { -dir.y, dir.x };
    vec2 front = { centre.x - 18 * dir.x, centre.y - 18 * dir.y };
    town_rect(centre, dir, 15, 6.8, nave);
    church_nave(t, nave, z, eave, ridge);
    town_rect(front, dir, 4.2, 4.2, shaft);
    town_rect(front, dir, 4.6, 4.6, crown);
    for (int i = 0; i < 4; i++) {
        town_wall w = town_wall_make(shaft[i], shaft[(i + 1) % 4]), e = town_wall_make(crown[i], crown[(i + 1) % 4]);
        double q[3][3];
        town_wall_rect(t, TM_CONCRETE, &w, 0, w.length, z, tower, 0);
        for (int b = 0; b < 3; b++) {
            w.mitre0 = w.mitre1 = 1;
            town_wall_band(t, TM_STONE, &w, z + 12 + 11 * b, z + 12.5 + 11 * b, 0.3);
        }
        church_windows(t, &w, 2, tower - 8, tower - 2.5, 1.3, false);
        put3(q[0], crown[i], tower), put3(q[1], crown[(i + 1) % 4], tower), put3(q[2], front, tip);
        town_tri(t, TM_COPPER, q[0], q[1], q[2]);
        town_wall_rect(t, TM_STONE, &e, 0, e.length, tower - 0.6, tower, 0);
        noc_light clock = {
            .kind = NOC_LIGHT_DISC, .radius = 1.4, .direction = { w.out.x, w.out.y, 0 }, .name = "clock"
        };
        town_wall_point(&w, 0.5 * w.length, z + 25.1, 0.06, clock.position);
        town_light(t, &clock, LIGHT_WHITE, 95);
        double hands[2][4] = { { -0.06, 0.06, -0.2, 1.1 }, { -0.2, 0.8, -0.07, 0.07 } };
        for (int k = 0; k < 2; k++)
            town_wall_rect(t, TM_METAL, &w, 0.5 * w.length + hands[k][0], 0.5 * w.length + hands[k][1],
                           z + 25.1 + hands[k][2], z + 25.1 + hands[k][3], 0.09 + 0.01 * k);
    }
    town_wall portal = town_wall_make(shaft[3], shaft[0]);
    town_wall_band(t, TM_STONE, &portal, z, z + 0.3, 1.0);
    town_wall_rect(t, TM_STONE, &portal, 2.4, 6.0, z + 0.3, z + 5.2, 0.06);
    town_wall_rect(t, TM_DOOR, &portal, 2.9, 5.5, z + 0.3, z + 4.6, 0.09);
    for (int side = -1; side <= 1; side += 2) {
        for (int k = 0; k < 3; k++) {
            vec2 at = { centre.x + (k - 1) * 10 * dir.x + side * 6.8 * across.x,
                        centre.y + (k - 1) * 10 * dir.y + side * 6.8 * across.y };
            uplight(t, (vec2){ at.x + side * 4.5 * across.x, at.y + side * 4.5 * across.y }, at, z, 6, 2600);
        }
        vec2 at = { front.x + side * 4.2 * across.x, front.y + side * 4.2 * across.y };
        uplight(t, (vec2){ at.x + side * 6 * across.x, at.y + side * 6 * across.y }, at, z, 17, 9000);
    }
    uplight(t, (vec2){ front.x - 12 * dir.x + 3 * across.x, front.y - 12 * dir.y + 3 * across.y }, front, z, 22, 9000);
    uplight(t, (vec2){ front.x - 12 * dir.x - 3 * across.x, front.y - 12 * dir.y - 3 * across.y }, front, z, 22, 9000);
}

void town_square(town *t, const town_poly *block, int id) {
    town_poly paving = inset_by(block, 3), ring = inset_by(block, 7);
    vec2 centre = town_poly_centre(block), c = town_warp(t, (vec2){ centre.x + 6, centre.y + 2 });
    vec2 ahead = town_warp(t, (vec2){ centre.x + 16, centre.y + 2 }), dir = town_wall_make(c, ahead).dir;
    town_rng rng = { town_hash(t->params.seed, 9500u + (uint32_t)id) };
    sheet(t, TM_PAVING, &paving, TOWN_KERB + 0.03);
    town_flush(t, "block %d/square", id);
    bool room = town_poly_area(&ring) > 2600;
    if (room)
        town_church(t, c, dir);
    town_flush(t, "block %d/church", id);
    for (int i = 0; i < ring.n; i++) {
        town_wall e = town_wall_make(ring.p[i], ring.p[(i + 1) % ring.n]);
        for (double s = 5; s < e.length - 3; s += 8.5) {
            double p[3];
            town_wall_point(&e, s, 0, 0, p);
            vec2 at = town_warp(t, (vec2){ p[0], p[1] });
            if (room && distance(at, c) < 14)
                continue;
            if (((int)(s / 8.5)) % 2 == 0)
                town_globe_lamp(t, at, TOWN_KERB + 0.03, LIGHT_WHITE);
            else if (town_chance(&rng, 0.75))
                town_tree(t, at, TOWN_KERB, 7.5, 160, town_hash(rng.state, 2));
            else
                town_bench(t, at, e.dir, TOWN_KERB + 0.03);
        }
    }
    /* a column with a statue before the church */
    vec2 m = town_warp(t, (vec2){ centre.x - 27, centre.y + (room ? -8 : 0) });
    if (contains(&ring, (vec2){ centre.x - 27, centre.y - 8 }) || !room) {
        vec2 box[4];
        town_rect(m, EAST, 1.3, 1.3, box);
        town_box(t, TM_STONE, box, TOWN_KERB, TOWN_KERB + 1.2);
        town_pole(t, TM_STONE, m, 10, 0.42, 0.34, TOWN_KERB + 1.2, TOWN_KERB + 7.5);
        town_rect(m, EAST, 0.6, 0.6, box);
        town_box(t, TM_STONE, box, TOWN_KERB + 7.5, TOWN_KERB + 7.8);
        town_pole(t, TM_COPPER, m, 6, 0.4, 0.16, TOWN_KERB + 7.8, TOWN_KERB + 9.6);
    }
    town_flush(t, "block %d/furniture", id);
}

void town_plaza(town *t, const town_poly *block, int id) {
    town_poly inner = inset_by(block, 2);
    if (inner.n && town_poly_area(&inner) > 60) {
        vec2 c = town_poly_centre(&inner);
        town_globe_lamp(t, town_warp(t, c), TOWN_KERB, LIGHT_WHITE);
        for (int i = 0; i < inner.n; i++) {
            vec2 p = toward(c, inner.p[i], 0.62);
            if (distance(p, c) > 3.5)
                town_tree(t, town_warp(t, p), TOWN_KERB, 7.5, 160, town_hash(t->params.seed, (uint32_t)(id * 32 + i)));
        }
    }
    town_flush(t, "block %d/plaza", id);
}

void town_courtyard(town *t, const town_poly *yard, int id) {
    vec2 c = town_poly_centre(yard);
    double area = town_poly_area(yard);
    town_rng rng = { town_hash(t->params.seed, 9800u + (uint32_t)id) };
    sheet(t, TM_LAWN, yard, TOWN_KERB + 0.04);
    for (int i = 0; i < yard->n && area > 250; i++) {
        vec2 p = toward(c, yard->p[i], town_range(&rng, 0.3, 0.55));
        if (town_chance(&rng, 0.8))
            town_tree(t, town_warp(t, p), TOWN_KERB, 7.5, 160, town_hash(rng.state, 9));
    }
    if (area > 500)
        town_globe_lamp(t, town_warp(t, c), TOWN_KERB + 0.04, LIGHT_WARM);
    town_flush(t, "block %d/courtyard", id);
}
