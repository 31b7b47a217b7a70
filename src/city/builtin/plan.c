/* The built-in city's plan: convex polygons, and the warp that takes them to the world. */
#include "city/builtin/town.h"

#include <math.h>

double town_poly_area(const town_poly *poly) {
    double sum = 0;
    for (int i = 0; i < poly->n; i++) {
        vec2 a = poly->p[i], b = poly->p[(i + 1) % poly->n];
        sum += a.x * b.y - a.y * b.x;
    }
    return 0.5 * sum;
}

vec2 town_poly_centre(const town_poly *poly) {
    vec2 c = { 0, 0 };
    for (int i = 0; i < poly->n; i++) {
        c.x += poly->p[i].x / poly->n;
        c.y += poly->p[i].y / poly->n;
    }
    return c;
}

void town_poly_clip(town_poly *poly, vec2 a, vec2 d, town_way way) {
    town_poly out = { 0 };
    for (int i = 0; i < poly->n; i++) {
        vec2 p = poly->p[i], q = poly->p[(i + 1) % poly->n];
        double sp = d.x * (p.y - a.y) - d.y * (p.x - a.x), sq = d.x * (q.y - a.y) - d.y * (q.x - a.x);
        if (out.n + 2 > TOWN_POLY_MAX)
            break;
        if (sp >= 0) {
            out.way[out.n] = poly->way[i];
            out.p[out.n++] = p;
        }
        if ((sp >= 0) != (sq >= 0)) {
            double f = sp / (sp - sq);
            vec2 x = { p.x + f * (q.x - p.x), p.y + f * (q.y - p.y) };
            /* leaving: the new edge begins here; entering: the rest of the old one does */
            out.way[out.n] = sp >= 0 ? way : poly->way[i];
            out.p[out.n++] = x;
        }
    }
    /* a corner cut exactly can leave an edge of no length */
    poly->n = 0;
    for (int i = 0; i < out.n; i++) {
        vec2 p = out.p[i], q = out.p[(i + 1) % out.n];
        if ((p.x - q.x) * (p.x - q.x) + (p.y - q.y) * (p.y - q.y) > 1e-4) {
            poly->way[poly->n] = out.way[i];
            poly->p[poly->n++] = p;
        }
    }
    if (poly->n < 3)
        poly->n = 0;
}

town_poly town_poly_inset(const town_poly *poly, const double distance[4]) {
    town_poly out = *poly;
    for (int i = 0; i < poly->n && out.n; i++) {
        vec2 a = poly->p[i], b = poly->p[(i + 1) % poly->n], d = { b.x - a.x, b.y - a.y };
        double l = sqrt(d.x * d.x + d.y * d.y), by = distance[poly->way[i]];
        vec2 moved = { a.x - by * d.y / l, a.y + by * d.x / l };
        town_poly_clip(&out, moved, d, poly->way[i]);
    }
    return out;
}

/* Two crossed waves a direction. Slopes stay under 0.25, so streets keep their width within a few per cent. */
vec2 town_warp(const town *t, vec2 p) {
    uint32_t s = t->params.seed;
    double phase[4];
    for (uint32_t i = 0; i < 4; i++)
        phase[i] = (double)(town_hash(s, 900 + i) >> 8) / 16777216.0;
    vec2 q = p;
    q.x += 8.5 * town_sin(p.y / 410 + phase[0]) + 3.0 * town_sin((p.x + 0.6 * p.y) / 260 + phase[1]);
    q.y += 9.5 * town_sin(p.x / 450 + phase[2]) + 3.0 * town_sin((p.y - 0.5 * p.x) / 230 + phase[3]);
    return q;
}

void town_diagonal(const town *t, vec2 *a, vec2 *dir, double *half_width) {
    /* through the south west of the plan, falling towards the east */
    *a = (vec2){ -0.16 * t->half, -0.34 * t->half };
    *dir = (vec2){ 0.8, -0.6 };
    *half_width = 7.5;
}
