/* The built-in city's walls: fronts with storeys of windows, shops at street level, cornices. */
#include "city/builtin/town.h"
#include "city/windows/windows.h"

#include <math.h>

town_wall town_wall_make(vec2 a, vec2 b) {
    town_wall w = { .a = a, .b = b };
    double x = b.x - a.x, y = b.y - a.y;
    w.length = sqrt(x * x + y * y);
    w.dir = (vec2){ x / w.length, y / w.length };
    w.out = (vec2){ w.dir.y, -w.dir.x };
    return w;
}

void town_wall_point(const town_wall *w, double s, double z, double before, double out[3]) {
    out[0] = w->a.x + s * w->dir.x + before * w->out.x;
    out[1] = w->a.y + s * w->dir.y + before * w->out.y;
    out[2] = z;
}

void town_wall_rect(town *t, town_mat mat, const town_wall *w, double s0, double s1, double z0, double z1,
                    double before) {
    double q[4][3];
    if (s1 - s0 < 1e-6 || z1 - z0 < 1e-6)
        return;
    town_wall_point(w, s0, z0, before, q[0]);
    town_wall_point(w, s1, z0, before, q[1]);
    town_wall_point(w, s1, z1, before, q[2]);
    town_wall_point(w, s0, z1, before, q[3]);
    town_quad(t, mat, q[0], q[1], q[2], q[3]);
}

/* A box that stands out of the wall: front, top, bottom, ends. */
static void wall_box(town *t, town_mat mat, const town_wall *w, double s0, double s1, double z0, double z1, double near,
                     double far, double out0, double out1) {
    double q[8][3]; /* back then front, each counter-clockwise seen from before the wall */
    const double z[4] = { z0, z0, z1, z1 };
    for (int i = 0; i < 4; i++) {
        bool right = i == 1 || i == 2;
        town_wall_point(w, right ? s1 : s0, z[i], near, q[i]);
        town_wall_point(w, right ? s1 + out1 : s0 - out0, z[i], far, q[4 + i]);
    }
    town_quad(t, mat, q[4], q[5], q[6], q[7]);
    town_quad(t, mat, q[7], q[6], q[2], q[3]);
    town_quad(t, mat, q[0], q[1], q[5], q[4]);
    if (out0 == 0)
        town_quad(t, mat, q[0], q[4], q[7], q[3]);
    if (out1 == 0)
        town_quad(t, mat, q[5], q[1], q[2], q[6]);
}

void town_wall_band(town *t, town_mat mat, const town_wall *w, double z0, double z1, double before) {
    wall_box(t, mat, w, 0, w->length, z0, z1, 0, before, w->mitre0 * before, w->mitre1 * before);
}

void town_wall_pane(town *t, town_mat mat, const town_wall *w, double s0, double s1, double z0, double z1,
                    double before, const town_room *room) {
    double p[3];
    const double u[3] = { w->dir.x * (s1 - s0), w->dir.y * (s1 - s0), 0 }, v[3] = { 0, 0, z1 - z0 };
    town_wall_point(w, s0, z0, before, p);
    town_pane_add(t, mat, p, u, v, room);
}

/* ---- windows ---- */

/* The share of lit rooms from which on an office is lit, by its number u. Storeys are busy or empty: where that share
 * is s, so many less of them are lit, or more, and the mean stays. */
static double office_level(double u, bool busy) {
    const double spread = 0.9;
    if (busy)
        return u < 0.5 + 0.5 * spread ? u / (1 + spread) : (u - spread) / (1 - spread);
    return u < 0.5 - 0.5 * spread ? u / (1 - spread) : (u + spread) / (1 + spread);
}

/* Rooms are lit in groups: two windows of one flat share lamp and brightness, an office storey often works as one. */
static town_room room_behind(const town *t, const town_facade *f, int storey, int column) {
    uint32_t group = town_hash(f->seed, (uint32_t)(storey * 64 + (f->office ? column / 3 : column / 2)));
    town_rng rng = { group }, whole = { town_hash(f->seed, 7777u + (uint32_t)storey) };
    double u = town_next(&rng), v = town_next(&rng);
    town_room r = { .kind = f->office ? NOC_WINDOW_OFFICE : NOC_WINDOW_FLAT,
                    .level = f->office ? office_level(u, town_chance(&whole, 0.5)) : u,
                    .often = t->often };
    if (f->office)
        r.colour = v < 0.35 ? LIGHT_COOL : v < 0.8 ? LIGHT_NEUTRAL : LIGHT_WHITE;
    else
        r.colour = v < 0.16   ? LIGHT_CANDLE
                   : v < 0.66 ? LIGHT_WARM
                   : v < 0.84 ? LIGHT_WHITE
                   : v < 0.94 ? LIGHT_NEUTRAL
                              : LIGHT_SCREEN;
    double brightness = town_next(&rng);
    r.luminance = r.colour == LIGHT_SCREEN ? city_window_screen(brightness) : city_window_luminance(r.kind, brightness);
    return r;
}

/* Blinds and curtains take part of the pane, which stays dark. Those that cover it let some light through. */
static void glass(town *t, const town_wall *w, const town_facade *f, int storey, int column, const double r[4],
                  double before) {
    town_room room = room_behind(t, f, storey, column);
    double s0 = r[0], s1 = r[1], z0 = r[2], z1 = r[3];
    town_rng rng = { town_hash(f->seed ^ 0x5bd1e995u, (uint32_t)(storey * 64 + column)) };
    double u = town_next(&rng), width = s1 - s0, height = z1 - z0;
    if (u < 0.2)
        z1 -= height * town_range(&rng, 0.2, 0.6);
    else if (u < 0.3)
        s1 -= width * town_range(&rng, 0.3, 0.55);
    else if (u < 0.4)
        s0 += width * town_range(&rng, 0.3, 0.55);
    else if (u < 0.7 && !f->office)
        room.luminance *= city_window_curtain((u - 0.4) / 0.3);
    town_wall_rect(t, TM_GLASS, w, r[0], s0, z0, z1, before);
    town_wall_rect(t, TM_GLASS, w, s1, r[1], z0, z1, before);
    town_wall_rect(t, TM_GLASS, w, s0, s1, z1, r[3], before);
    town_wall_pane(t, TM_GLASS, w, s0, s1, z0, z1, before, &room);
}

/* An opening cut into the wall, without its back at -depth. */
static void reveals(town *t, town_mat side, town_mat floor, const town_wall *w, const double r[4], double depth) {
    double f[4][3], b[4][3];
    const double s[4] = { r[0], r[1], r[1], r[0] }, z[4] = { r[2], r[2], r[3], r[3] };
    for (int i = 0; i < 4; i++) {
        town_wall_point(w, s[i], z[i], 0, f[i]);
        town_wall_point(w, s[i], z[i], -depth, b[i]);
    }
    for (int i = 0; i < 4; i++) /* floor, right, ceiling, left; all face into the opening */
        town_quad(t, i ? side : floor, f[i], f[(i + 1) % 4], b[(i + 1) % 4], b[i]);
}

/* A thin slab: its front and top only, the rest is seen by nobody. */
static void sill(town *t, const town_wall *w, double s0, double s1, double z) {
    double q[4][3];
    town_wall_rect(t, TM_STONE, w, s0, s1, z - 0.09, z - 0.01, 0.09);
    town_wall_point(w, s0, z - 0.01, 0.09, q[0]);
    town_wall_point(w, s1, z - 0.01, 0.09, q[1]);
    town_wall_point(w, s1, z - 0.01, 0, q[2]);
    town_wall_point(w, s0, z - 0.01, 0, q[3]);
    town_quad(t, TM_STONE, q[0], q[1], q[2], q[3]);
}

static void window(town *t, const town_wall *w, const town_facade *f, int storey, int column, const double r[4]) {
    if (!f->deep) {
        glass(t, w, f, storey, column, r, 0.03);
        return;
    }
    const double depth = 0.14;
    double middle = 0.5 * (r[0] + r[1]), transom = r[2] + 0.68 * (r[3] - r[2]);
    reveals(t, f->wall, f->wall, w, r, depth);
    glass(t, w, f, storey, column, r, -depth);
    town_wall_rect(t, TM_FRAME, w, middle - 0.035, middle + 0.035, r[2], r[3], -depth + 0.025);
    if (r[3] - r[2] > 1.5)
        town_wall_rect(t, TM_FRAME, w, r[0], r[1], transom - 0.03, transom + 0.03, -depth + 0.03);
    sill(t, w, r[0] - 0.08, r[1] + 0.08, r[2]);
}

static void balcony(town *t, const town_wall *w, const double r[4], double floor) {
    double s0 = r[0] - 0.35, s1 = r[1] + 0.35;
    wall_box(t, TM_CONCRETE, w, s0, s1, floor - 0.14, floor, 0, 1.0, 0, 0);
    wall_box(t, TM_METAL, w, s0, s1, floor + 0.95, floor + 1.0, 0.94, 1.0, 0, 0);
    for (double s = s0 + 0.04; s < s1; s += (s1 - s0 - 0.08) / 7 - 1e-6)
        town_wall_rect(t, TM_METAL, w, s - 0.012, s + 0.012, floor, floor + 0.95, 0.97);
}

/* ---- shops ---- */

/* A room behind an open front, or panes, or a closed one, which nobody lights; a sign above it. */
static void shop(town *t, const town_wall *w, const town_facade *f, int column, const double r[4], double sign) {
    static const double levels[] = { 200, 280, 380, 500, 650, 800 };
    town_rng rng = { town_hash(f->seed ^ 0x1234567u, (uint32_t)column) };
    double kind = town_next(&rng);
    town_room room = { .kind = NOC_WINDOW_SHOP, .often = TOWN_SHOPS_OFTEN };
    room.colour = LIGHT_WARM + town_below(&rng, 4);
    double level = levels[town_below(&rng, NOC_COUNT(levels))];
    town_rng number = { town_hash(f->seed ^ 0x2545f491u, (uint32_t)column) };
    room.level = town_next(&number);
    if (kind < 0.7 && r[0] > 6 && r[1] < w->length - 6) { /* rooms keep clear of the corners */
        const double depth = 2.6, sm = 0.5 * (r[0] + r[1]), z = r[3] - 0.03;
        reveals(t, TM_SHOP, TM_SHOP_FLOOR, w, r, depth);
        town_wall_rect(t, TM_SHOP, w, r[0], r[1], r[2], r[3], -depth);
        double p[3]; /* the corner of a panel in the ceiling, facing down */
        const double u[3] = { 1.8 * w->dir.x, 1.8 * w->dir.y, 0 }, v[3] = { w->out.x, w->out.y, 0 };
        town_wall_point(w, sm - 0.9, z, -depth + 0.7, p);
        room.luminance = 4 * level;
        town_pane_add(t, TM_SHOP, p, u, v, &room);
        /* something to sell: a counter and shelves */
        wall_box(t, TM_WOOD, w, r[0] + 0.3, r[1] - 0.3, r[2] + 0.5, r[2] + 0.55, -depth, -depth + 0.35, 0, 0);
        wall_box(t, TM_AWNING + (town_mat)town_below(&rng, 3), w, r[0] + 0.4, sm - 0.2, r[2] + 0.55, r[2] + 1.1, -depth,
                 -depth + 0.3, 0, 0);
        wall_box(t, TM_WOOD, w, r[0] + 0.3, r[1] - 0.3, r[2] + 1.3, r[2] + 1.34, -depth, -depth + 0.35, 0, 0);
        wall_box(t, TM_AWNING + (town_mat)town_below(&rng, 3), w, sm, r[1] - 0.5, r[2] + 1.34, r[2] + 1.7, -depth,
                 -depth + 0.3, 0, 0);
        wall_box(t, TM_WOOD, w, sm - 0.7, sm + 0.5, r[2], r[2] + 0.8, -1.3, -0.8, 0, 0);
    } else {
        reveals(t, TM_FRAME, TM_FRAME, w, r, 0.22);
        town_wall_rect(t, TM_SHOP_DARK, w, r[0], r[1], r[2], r[3], -0.22);
        if (kind < 0.87) {
            int panes = 3;
            for (int i = 0; i < panes; i++) { /* one brightness a pane: displays, a poster, the door */
                double a = r[0] + (r[1] - r[0]) * i / panes, b = r[0] + (r[1] - r[0]) * (i + 1) / panes;
                double lo = town_chance(&rng, 0.35) ? r[2] + 0.7 : r[2] + 0.12;
                room.luminance = city_window_luminance(NOC_WINDOW_SHOP, town_next(&rng));
                town_wall_pane(t, TM_SHOP_DARK, w, a + 0.05, b - 0.05, lo, r[3] - 0.08, -0.2, &room);
                if (i)
                    town_wall_rect(t, TM_FRAME, w, a - 0.05, a + 0.05, r[2], r[3], -0.17);
            }
        }
    }
    double u = town_next(&rng), s0 = r[0] + 0.3, s1 = r[1] - 0.3;
    wall_box(t, u < 0.5 ? TM_METAL : TM_WOOD, w, r[0], r[1], sign, sign + 0.55, 0, 0.08, 0, 0);
    if (u < 0.45 && kind < 0.9) { /* letters as one bright strip */
        static const float hue[5][3] = { { 2.6f, 0.55f, 0.5f },
                                         { 0.4f, 1.1f, 1.7f },
                                         { 1.7f, 0.85f, 0.3f },
                                         { 0.5f, 1.25f, 0.5f },
                                         { 2.1f, 0.5f, 2.1f } };
        noc_light l = { .kind = NOC_LIGHT_PARALLELOGRAM, .name = "sign" };
        int h = town_below(&rng, 5);
        double width = (s1 - s0) * town_range(&rng, 0.45, 0.95), start = s0 + 0.5 * (s1 - s0 - width);
        double strength = town_chance(&rng, 0.5) ? 90 : 180;
        town_wall_point(w, start, sign + 0.14, 0.1, l.position);
        l.edge_u[0] = w->dir.x * width;
        l.edge_u[1] = w->dir.y * width;
        l.edge_v[2] = 0.27;
        for (int k = 0; k < 3; k++)
            l.emission[k] = (float)strength * hue[h][k];
        t->failed = t->failed || noc_scene_add_light(t->scene, &l) < 0;
    }
    if (town_chance(&rng, 0.3)) { /* awning */
        double q[4][3];
        town_wall_point(w, r[0], sign - 0.75, 1.3, q[0]);
        town_wall_point(w, r[1], sign - 0.75, 1.3, q[1]);
        town_wall_point(w, r[1], sign - 0.1, 0.02, q[2]);
        town_wall_point(w, r[0], sign - 0.1, 0.02, q[3]);
        town_quad(t, TM_AWNING + (town_mat)town_below(&rng, 3), q[0], q[1], q[2], q[3]);
    }
}

/* ---- fronts ---- */

double town_facade_height(const town_facade *f) { return f->ground + f->storeys * f->storey; }

enum { COLUMNS_MAX = 60 };

/* The wall of one storey around a row of openings of one height. */
static void wall_row(town *t, town_mat mat, const town_wall *w, const double (*open)[4], int n, double z0, double z1) {
    if (!n) {
        town_wall_rect(t, mat, w, 0, w->length, z0, z1, 0);
        return;
    }
    double s = 0;
    town_wall_rect(t, mat, w, 0, w->length, z0, open[0][2], 0);
    for (int i = 0; i < n; i++) {
        town_wall_rect(t, mat, w, s, open[i][0], open[0][2], open[0][3], 0);
        s = open[i][1];
    }
    town_wall_rect(t, mat, w, s, w->length, open[0][2], open[0][3], 0);
    town_wall_rect(t, mat, w, 0, w->length, open[0][3], z1, 0);
}

static void ground_floor(town *t, const town_wall *w, const town_facade *f, double margin) {
    double open[COLUMNS_MAX][4], z0 = f->base, z1 = f->base + f->ground;
    double bay = f->shops ? 4.4 : f->bay, span = w->length - 2 * margin;
    int n = NOC_CLAMP((int)(span / bay), 0, COLUMNS_MAX);
    double step = n ? span / n : 0, width = f->shops ? step - 0.7 : f->width;
    for (int i = 0; i < n; i++) {
        double s = margin + (i + 0.5) * step;
        open[i][0] = s - 0.5 * width;
        open[i][1] = s + 0.5 * width;
        open[i][2] = z0 + (f->shops ? 0.25 : 1.05);
        open[i][3] = f->shops ? z1 - 1.0 : z0 + 1.05 + NOC_MIN(f->height, f->ground - 1.5);
    }
    if (f->deep)
        wall_row(t, f->wall, w, open, n, z0 - 0.2, z1);
    else
        town_wall_rect(t, f->wall, w, 0, w->length, z0 - 0.2, z1, 0);
    int door = f->door && n > 1 ? n / 2 : -1;
    for (int i = 0; i < n; i++) {
        if (f->shops)
            shop(t, w, f, i, open[i], z1 - 0.85);
        else if (i != door)
            window(t, w, f, 0, i, open[i]);
        else { /* the door stands on the pavement, before what would be a window */
            double r[4] = { open[i][0] - 0.1, open[i][1] + 0.1, z0, z0 + 2.5 };
            wall_box(t, TM_STONE, w, r[0] - 0.2, r[1] + 0.2, z0, r[3] + 0.25, 0, 0.1, 0, 0);
            town_wall_rect(t, TM_DOOR, w, r[0], r[1], z0 + 0.05, r[3], 0.115);
            if (f->deep) /* closes the opening behind it */
                town_wall_rect(t, f->wall, w, open[i][0], open[i][1], open[i][2], open[i][3], 0);
        }
    }
}

void town_facade_build(town *t, const town_wall *w, const town_facade *f) {
    double margin = f->office ? 0.5 : 0.8, span = w->length - 2 * margin;
    int n = NOC_CLAMP((int)(span / f->bay), 0, COLUMNS_MAX);
    double step = n ? span / n : 0, top = f->base + town_facade_height(f);
    double width = NOC_MIN(f->width, step - 0.3);
    ground_floor(t, w, f, margin);
    if (!f->deep)
        town_wall_rect(t, f->wall, w, 0, w->length, f->base + f->ground, top, 0);
    for (int j = 0; j < f->storeys; j++) {
        double open[COLUMNS_MAX][4], z0 = f->base + f->ground + j * f->storey;
        for (int i = 0; i < n; i++) {
            double s = margin + (i + 0.5) * step;
            open[i][0] = s - 0.5 * width;
            open[i][1] = s + 0.5 * width;
            open[i][2] = z0 + f->sill;
            open[i][3] = z0 + f->sill + f->height;
        }
        if (f->deep)
            wall_row(t, f->wall, w, open, n, z0, z0 + f->storey);
        for (int i = 0; i < n; i++) {
            window(t, w, f, j + 1, i, open[i]);
            if (f->balconies && i % 3 == 1 && j < f->storeys)
                balcony(t, w, open[i], z0 + 0.1);
        }
    }
    if (f->deep) {
        town_wall_band(t, TM_STONE, w, f->base + f->ground - 0.18, f->base + f->ground + 0.06, 0.14);
        town_wall_band(t, TM_STONE, w, top - 0.42, top - 0.02, 0.38);
    }
}
