/* The built-in city's river: water, embankments, promenades, and a bridge for every avenue. */
#include "city/builtin/town.h"

#include <math.h>

#define BRIDGE_WALK 3.0
#define DECK_UNDER (-0.9)

static vec2 at(const town *t, double x, double y) { return town_warp(t, (vec2){ x, y }); }

static void patch(town *t, town_mat mat, double x0, double x1, double y0, double y1, double z) {
    vec2 p[4] = { at(t, x0, y0), at(t, x1, y0), at(t, x1, y1), at(t, x0, y1) };
    town_flat(t, mat, p, 4, z);
}

/* Upright rectangle between two points of the plan, facing right of a to b. */
static void face(town *t, town_mat mat, vec2 a, vec2 b, double z0, double z1) {
    town_wall w = town_wall_make(a, b);
    town_wall_rect(t, mat, &w, 0, w.length, z0, z1, 0);
}

/* A low wall from a to b (plan), with thickness to its left. */
static void parapet(town *t, vec2 a, vec2 b, vec2 a_left, vec2 b_left, double z0, double z1) {
    face(t, TM_QUAY, a, b, z0, z1);
    face(t, TM_QUAY, b_left, a_left, z0, z1);
    vec2 top[4] = { a, b, b_left, a_left };
    town_flat(t, TM_STONE, top, 4, z1);
}

/* Both banks between x0 and x1, where there is no bridge. */
static void banks(town *t, const town_gap *g, double x0, double x1) {
    int n = NOC_MAX((int)((x1 - x0) / 9), 1);
    double s_street = g->lo + TOWN_QUAY_STREET, s_edge = s_street + TOWN_PROMENADE, n_street = g->hi - TOWN_QUAY_STREET,
           n_edge = n_street - TOWN_PROMENADE;
    for (int i = 0; i < n; i++) {
        double a = x0 + (x1 - x0) * i / n, b = x0 + (x1 - x0) * (i + 1) / n;
        patch(t, TM_PAVING, a, b, s_street, s_edge, TOWN_KERB);
        patch(t, TM_PAVING, a, b, n_edge, n_street, TOWN_KERB);
        face(t, TM_KERBSTONE, at(t, a, s_street), at(t, b, s_street), -0.02, TOWN_KERB);
        face(t, TM_KERBSTONE, at(t, b, n_street), at(t, a, n_street), -0.02, TOWN_KERB);
        parapet(t, at(t, b, s_edge), at(t, a, s_edge), at(t, b, s_edge - 0.35), at(t, a, s_edge - 0.35), TOWN_KERB,
                TOWN_KERB + 0.95);
        parapet(t, at(t, a, n_edge), at(t, b, n_edge), at(t, a, n_edge + 0.35), at(t, b, n_edge + 0.35), TOWN_KERB,
                TOWN_KERB + 0.95);
    }
    for (int side = 0; side < 2; side++) { /* lamps by the parapet, trees by the street */
        double lamp = side ? n_edge + 0.9 : s_edge - 0.9, tree = side ? n_street - 1.1 : s_street + 1.1;
        int lamps = (int)((x1 - x0 - 6) / 19) + 1;
        for (int i = 0; i < lamps && x1 - x0 > 12; i++) {
            double x = x0 + (x1 - x0) * (i + 0.5) / lamps;
            town_globe_lamp(t, at(t, x, lamp), TOWN_KERB, LIGHT_NEUTRAL);
            for (int k = -1; k <= 1; k += 2)
                if (fabs(x + 4.8 * k - x0) > 4 && fabs(x + 4.8 * k - x1) > 4)
                    town_tree(t, at(t, x + 4.8 * k, tree), TOWN_KERB, 6.8, 200,
                              town_hash(t->params.seed, (uint32_t)(int)(x * 8 + 40000) + (uint32_t)side));
        }
    }
    town_flush(t, "river/bank");
}

/* One side of the arches: from the deck's edge down to the curve. */
static void bridge(town *t, const town_gap *g, const town_gap *way, int number) {
    enum { SPANS = 3, STEPS = 8 };
    double x[4] = { way->lo - BRIDGE_WALK, way->lo, way->hi, way->hi + BRIDGE_WALK };
    double y0 = g->lo + TOWN_QUAY_STREET, y1 = g->hi - TOWN_QUAY_STREET, w0 = y0 + TOWN_PROMENADE,
           w1 = y1 - TOWN_PROMENADE;
    double pier = 0.9, span = (w1 - w0 - (SPANS - 1) * 2 * pier) / SPANS;
    for (int i = 0; i < 6; i++) { /* deck, warped in pieces */
        double a = y0 + (y1 - y0) * i / 6, b = y0 + (y1 - y0) * (i + 1) / 6;
        patch(t, TM_ROAD, x[1], x[2], a, b, 0);
        for (int side = 0; side < 2; side++) {
            double in = x[side ? 2 : 1], out = x[side ? 3 : 0], rail = side ? out - 0.4 : out + 0.4;
            patch(t, TM_SIDEWALK, NOC_MIN(in, out), NOC_MAX(in, out), a, b, TOWN_KERB);
            vec2 k0 = at(t, in, side ? b : a), k1 = at(t, in, side ? a : b), o0 = at(t, out, side ? a : b),
                 o1 = at(t, out, side ? b : a);
            face(t, TM_KERBSTONE, k0, k1, -0.02, TOWN_KERB);
            parapet(t, o0, o1, at(t, rail, side ? a : b), at(t, rail, side ? b : a), TOWN_KERB, TOWN_KERB + 1.0);
        }
    }
    for (int s = 0; s < SPANS; s++) {
        double from = w0 + s * (span + 2 * pier);
        for (int i = 0; i < STEPS; i++) {
            double f0 = (double)i / STEPS, f1 = (i + 1.0) / STEPS, a = from + span * f0, b = from + span * f1;
            double za = DECK_UNDER - 2.4 * (2 * f0 - 1) * (2 * f0 - 1),
                   zb = DECK_UNDER - 2.4 * (2 * f1 - 1) * (2 * f1 - 1);
            vec2 p[4] = { at(t, x[0], a), at(t, x[0], b), at(t, x[3], b), at(t, x[3], a) };
            double q[4][3], soffit[4][3];
            for (int side = 0; side < 2; side++) {
                vec2 pa = side ? p[3] : p[0], pb = side ? p[2] : p[1];
                memcpy(q[0], (double[]){ pb.x, pb.y, zb }, sizeof(q[0]));
                memcpy(q[1], (double[]){ pa.x, pa.y, za }, sizeof(q[1]));
                memcpy(q[2], (double[]){ pa.x, pa.y, TOWN_KERB }, sizeof(q[2]));
                memcpy(q[3], (double[]){ pb.x, pb.y, TOWN_KERB }, sizeof(q[3]));
                if (side)
                    town_quad(t, TM_BRIDGE, q[1], q[0], q[3], q[2]);
                else
                    town_quad(t, TM_BRIDGE, q[0], q[1], q[2], q[3]);
            }
            for (int k = 0; k < 4; k++)
                memcpy(soffit[k], (double[]){ p[k].x, p[k].y, k == 0 || k == 3 ? za : zb }, sizeof(soffit[k]));
            town_quad(t, TM_BRIDGE, soffit[0], soffit[1], soffit[2], soffit[3]);
        }
        if (s + 1 < SPANS) { /* the pier sticks out of the bridge's sides a little */
            double a = from + span, b = a + 2 * pier;
            vec2 c[4] = { at(t, x[0] - 0.5, a), at(t, x[3] + 0.5, a), at(t, x[3] + 0.5, b), at(t, x[0] - 0.5, b) };
            town_box(t, TM_QUAY, c, TOWN_WATER - 0.5, TOWN_KERB - 0.3);
            face(t, TM_BRIDGE, at(t, x[0], b), at(t, x[0], a), TOWN_KERB - 0.3, TOWN_KERB);
            face(t, TM_BRIDGE, at(t, x[3], a), at(t, x[3], b), TOWN_KERB - 0.3, TOWN_KERB);
        }
    }
    for (int i = 0; i < 4; i++)
        for (int side = 0; side < 2; side++)
            town_globe_lamp(t, at(t, side ? x[3] - 0.8 : x[0] + 0.8, y0 + (y1 - y0) * (i + 0.5) / 4), TOWN_KERB,
                            LIGHT_WARM);
    town_flush(t, "bridge %d", number);
}

void town_river(town *t) {
    const town_gap *g = NULL;
    for (size_t j = 0; j < t->axis[1].gaps.len; j++)
        if (t->axis[1].gaps.data[j].river)
            g = &t->axis[1].gaps.data[j];
    if (!g)
        return;
    double w0 = g->lo + TOWN_QUAY_STREET + TOWN_PROMENADE, w1 = g->hi - TOWN_QUAY_STREET - TOWN_PROMENADE;
    int n = NOC_MAX((int)(2 * t->half / 9), 4);
    for (int i = 0; i < n; i++) {
        double a = -t->half + 2 * t->half * i / n, b = -t->half + 2 * t->half * (i + 1) / n;
        patch(t, TM_WATER, a, b, w0, w1, TOWN_WATER);
        face(t, TM_QUAY, at(t, b, w0), at(t, a, w0), TOWN_WATER - 0.3, TOWN_KERB);
        face(t, TM_QUAY, at(t, a, w1), at(t, b, w1), TOWN_WATER - 0.3, TOWN_KERB);
    }
    /* the river ends at the rim in a culvert's face */
    face(t, TM_QUAY, at(t, -t->half, w0), at(t, -t->half, w1), TOWN_WATER - 0.3, TOWN_KERB + 0.95);
    face(t, TM_QUAY, at(t, t->half, w1), at(t, t->half, w0), TOWN_WATER - 0.3, TOWN_KERB + 0.95);
    town_flush(t, "river");
    double from = -t->half;
    int number = 0;
    for (size_t i = 1; i + 1 < t->axis[0].gaps.len; i++) {
        const town_gap *way = &t->axis[0].gaps.data[i];
        if (way->kind != WAY_AVENUE)
            continue;
        banks(t, g, from, way->lo - BRIDGE_WALK);
        bridge(t, g, way, number++);
        from = way->hi + BRIDGE_WALK;
    }
    banks(t, g, from, t->half);
}
