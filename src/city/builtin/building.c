/* The built-in city's houses: rows around a courtyard, corner houses, towers. */
#include "city/builtin/town.h"
#include "city/windows/windows.h"

#include <math.h>

typedef enum roof_kind { ROOF_GABLE, ROOF_MANSARD, ROOF_FLAT } roof_kind;

typedef struct house {
    town_facade front, back;
    roof_kind roof;
    town_mat tiles;
    double eave, rise; /* z of the eave, height of the ridge above it */
    bool dormers, chimney;
    uint32_t seed;
} house;

/* What a house is like follows from its seed and its street alone, so that neighbours know of each other. */
static house house_make(const town *t, uint32_t seed, town_way way) {
    static const town_mat tiles[] = { TM_TILES, TM_TILES, TM_TILES_DARK, TM_SLATE };
    town_rng rng = { town_hash(seed, 11) };
    house h = { .seed = seed };
    bool avenue = way == WAY_AVENUE;
    double modern = town_next(&rng);
    int storeys = (avenue ? 4 : 3) + (int)(town_next(&rng) * 2.6);
    h.front = (town_facade){ .wall = TM_WALL + (town_mat)town_below(&rng, 10),
                             .storeys = storeys,
                             .base = TOWN_KERB,
                             .deep = true,
                             .ground = avenue ? town_range(&rng, 4.1, 4.6) : town_range(&rng, 3.3, 3.7),
                             .storey = town_range(&rng, 2.95, 3.45),
                             .seed = town_hash(seed, 12),
                             .door = true };
    h.front.shops = avenue            ? town_chance(&rng, 0.85)
                    : way == WAY_QUAY ? town_chance(&rng, 0.35)
                                      : town_chance(&rng, 0.12);
    if (h.front.shops && !avenue)
        h.front.ground = 4.1;
    if (modern < 0.22) { /* after-war: wide windows, flat roof */
        h.front.bay = town_range(&rng, 2.8, 3.4);
        h.front.width = town_range(&rng, 1.7, 2.2);
        h.front.height = 1.45;
        h.front.sill = 0.9;
        h.roof = ROOF_FLAT;
    } else {
        h.front.bay = town_range(&rng, 2.1, 2.6);
        h.front.width = town_range(&rng, 1.05, 1.3);
        h.front.height = town_range(&rng, 1.6, 1.9);
        h.front.sill = 0.75;
        h.roof = modern < 0.48 ? ROOF_MANSARD : ROOF_GABLE;
    }
    h.front.balconies = town_chance(&rng, 0.3);
    h.tiles = h.roof == ROOF_MANSARD ? (town_chance(&rng, 0.75) ? TM_SLATE : TM_COPPER) : tiles[town_below(&rng, 4)];
    h.rise = h.roof == ROOF_GABLE ? town_range(&rng, 3.8, 5.0) : h.roof == ROOF_MANSARD ? 3.9 : 0.7;
    h.dormers = h.roof == ROOF_MANSARD || (h.roof == ROOF_GABLE && town_chance(&rng, 0.65));
    h.chimney = town_chance(&rng, 0.8);
    h.eave = h.front.base + town_facade_height(&h.front);
    h.back = h.front;
    h.back.deep = h.back.shops = h.back.door = h.back.balconies = false;
    h.back.bay += 0.4;
    h.back.seed = town_hash(seed, 13);
    return h;
}

/* The ground under one house: front o0-o1 along the street, back n1-n0, world coordinates. */
typedef struct lot {
    vec2 o0, o1, n0, n1;
    double mitre0, mitre1;     /* of the front, where it turns a corner */
    const house *left, *right; /* neighbours at o0-n0 and o1-n1 */
} lot;

static vec2 mix(vec2 a, vec2 b, double f) { return (vec2){ a.x + f * (b.x - a.x), a.y + f * (b.y - a.y) }; }

static void put(double out[3], vec2 p, double z) {
    out[0] = p.x;
    out[1] = p.y;
    out[2] = z;
}

typedef struct profile {
    int n;
    double f[6], z[6];
} profile; /* across a roof, front to back */

static profile roof_profile(const house *h, double depth) {
    double f = NOC_MIN(1.5 / depth, 0.3);
    if (h->roof == ROOF_MANSARD)
        return (profile){ 5, { 0, f, 0.5, 1 - f, 1 }, { 0, 2.9, h->rise, 2.9, 0 } };
    return (profile){ 3, { 0, 0.5, 1 }, { 0, h->rise, 0 } };
}

/* The wall between two houses, as far as it shows above the other one. a is at the front. */
static void party_wall(town *t, const house *h, const house *other, const profile *roof, vec2 a, vec2 b,
                       bool facing_back_to_front) {
    double from = other ? other->eave : h->front.base, q[4][3];
    if (other && other->seed == h->seed)
        return;
    if (from < h->eave) {
        town_wall w = facing_back_to_front ? town_wall_make(b, a) : town_wall_make(a, b);
        double top = h->eave + (h->roof == ROOF_FLAT ? h->rise : 0);
        town_wall_rect(t, h->front.wall, &w, 0, w.length, from, top, 0);
    }
    if (h->roof == ROOF_FLAT || (other && other->eave > h->eave + h->rise))
        return;
    for (int i = 1; i + 1 < roof->n; i++) {
        put(q[0], a, h->eave);
        put(q[1], mix(a, b, roof->f[i]), h->eave + roof->z[i]);
        put(q[2], mix(a, b, roof->f[i + 1]), h->eave + roof->z[i + 1]);
        if (facing_back_to_front)
            town_tri(t, h->front.wall, q[0], q[1], q[2]);
        else
            town_tri(t, h->front.wall, q[0], q[2], q[1]);
    }
}

/* A small window house on the slope: its face stands `back` metres behind the front wall. */
static void dormer(town *t, const town_wall *w, const house *h, double s, double back, double z0, double reach,
                   int index) {
    double q[8][3], s0 = s - 0.75, s1 = s + 0.75, z1 = z0 + 1.75;
    const double ss[4] = { s0, s1, s1, s0 }, zz[4] = { z0, z0, z1, z1 };
    for (int i = 0; i < 4; i++) {
        town_wall_point(w, ss[i], zz[i], -back, q[i]);
        town_wall_point(w, ss[i], zz[i], -back - reach, q[4 + i]);
    }
    town_quad(t, h->front.wall, q[0], q[1], q[2], q[3]);
    town_quad(t, h->tiles, q[3], q[2], q[6], q[7]);
    town_quad(t, h->front.wall, q[4], q[0], q[3], q[7]);
    town_quad(t, h->front.wall, q[1], q[5], q[6], q[2]);
    town_rng rng = { town_hash(h->seed, 300 + (uint32_t)index) };
    town_room room = { .kind = NOC_WINDOW_FLAT,
                       .level = town_next(&rng),
                       .often = t->often,
                       .colour = h->front.seed & 1 ? LIGHT_WARM : LIGHT_CANDLE,
                       .luminance = city_window_luminance(NOC_WINDOW_FLAT, town_next(&rng)) };
    town_wall_pane(t, TM_GLASS, w, s0 + 0.2, s1 - 0.2, z0 + 0.3, z1 - 0.2, -back + 0.03, &room);
}

static void chimney(town *t, const house *h, vec2 p, vec2 dir, double z) {
    vec2 c[4];
    town_rect(p, dir, 0.65, 0.4, c);
    town_box(t, h->front.wall, c, z - 1.5, z + 1.3);
    for (int i = -1; i <= 1; i++)
        town_pole(t, TM_TILES, (vec2){ p.x + 0.38 * i * dir.x, p.y + 0.38 * i * dir.y }, 5, 0.14, 0.11, z + 1.3,
                  z + 1.75);
}

static void pitched_roof(town *t, const house *h, const lot *l, const profile *r, const town_wall *front) {
    double over = 0.42; /* the eave overhangs the cornice a little; it turns corners with the mitre */
    vec2 e0 = { l->o0.x + over * (front->out.x - front->mitre0 * front->dir.x),
                l->o0.y + over * (front->out.y - front->mitre0 * front->dir.y) };
    vec2 e1 = { l->o1.x + over * (front->out.x + front->mitre1 * front->dir.x),
                l->o1.y + over * (front->out.y + front->mitre1 * front->dir.y) };
    for (int i = 0; i + 1 < r->n; i++) {
        double q[4][3];
        put(q[0], i ? mix(l->o0, l->n0, r->f[i]) : e0, h->eave + (i ? r->z[i] : -0.01));
        put(q[1], i ? mix(l->o1, l->n1, r->f[i]) : e1, h->eave + (i ? r->z[i] : -0.01));
        put(q[2], mix(l->o1, l->n1, r->f[i + 1]), h->eave + r->z[i + 1]);
        put(q[3], mix(l->o0, l->n0, r->f[i + 1]), h->eave + r->z[i + 1]);
        town_quad(t, h->tiles, q[0], q[1], q[2], q[3]);
    }
    if (h->dormers) {
        bool mansard = h->roof == ROOF_MANSARD;
        /* not through the slope around the corner */
        double from = front->mitre0 > 0 ? 5 : 1.5, to = front->length - (front->mitre1 > 0 ? 5 : 1.5);
        int n = NOC_CLAMP((int)((to - from) / 3.1), 0, 8);
        for (int i = 0; i < n; i++) {
            double s = from + (to - from) * (i + 0.5) / n;
            dormer(t, front, h, s, mansard ? 0.35 : 1.3, h->eave + (mansard ? 0.75 : 1.0), mansard ? 1.5 : 2.4, i);
        }
    }
    if (h->chimney) {
        vec2 a = mix(l->o0, l->n0, 0.5), b = mix(l->o1, l->n1, 0.5);
        town_rng rng = { town_hash(h->seed, 21) };
        chimney(t, h, mix(a, b, town_range(&rng, 0.25, 0.4)), front->dir, h->eave + h->rise);
        if (front->length > 15)
            chimney(t, h, mix(a, b, town_range(&rng, 0.65, 0.8)), front->dir, h->eave + h->rise - 0.3);
    }
}

/* A roof terrace behind a parapet, with what stands on such roofs. */
static void flat_roof(town *t, const vec2 *p, int n, double z, double parapet, town_mat wall, uint32_t seed) {
    vec2 inner[TOWN_POLY_MAX] = { { 0 } }, centre = { 0, 0 };
    for (int i = 0; i < n; i++) {
        vec2 a = p[(i + n - 1) % n], b = p[i], c = p[(i + 1) % n];
        town_wall u = town_wall_make(a, b), v = town_wall_make(b, c);
        double turn = 1 + u.dir.x * v.dir.x + u.dir.y * v.dir.y; /* two edges' offset lines meet here */
        inner[i] = (vec2){ b.x - 0.28 * (u.out.x + v.out.x) / turn, b.y - 0.28 * (u.out.y + v.out.y) / turn };
        centre.x += b.x / n;
        centre.y += b.y / n;
    }
    town_flat(t, TM_FLAT_ROOF, inner, n, z);
    for (int i = 0; i < n; i++) {
        int j = (i + 1) % n;
        double q[4][3];
        put(q[0], p[i], z + parapet), put(q[1], p[j], z + parapet), put(q[2], inner[j], z + parapet),
            put(q[3], inner[i], z + parapet);
        town_quad(t, TM_STONE, q[0], q[1], q[2], q[3]);
        town_wall inside = town_wall_make(inner[j], inner[i]);
        town_wall_rect(t, wall, &inside, 0, inside.length, z, z + parapet, 0);
    }
    town_rng rng = { town_hash(seed, 31) };
    for (int i = 0; i < 3; i++) {
        vec2 c[4], at = mix(centre, p[town_below(&rng, n)], town_range(&rng, 0, 0.45));
        double k = i ? town_range(&rng, 0.5, 0.9) : town_range(&rng, 1.4, 1.9);
        town_rect(at, town_wall_make(p[0], p[1]).dir, k, k * 0.8, c);
        if (i == 0)
            at = centre, town_rect(at, town_wall_make(p[0], p[1]).dir, k, k * 0.8, c);
        town_box(t, i ? TM_METAL : wall, c, z, z + (i ? 0.9 : 2.3));
    }
    town_pole(t, TM_POLE, mix(centre, p[0], 0.3), 4, 0.04, 0.03, z, z + 4);
}

static void lot_build(town *t, const house *h, const lot *l) {
    town_wall front = town_wall_make(l->o0, l->o1), back = town_wall_make(l->n1, l->n0);
    double dx = 0.5 * (l->o0.x + l->o1.x - l->n0.x - l->n1.x), dy = 0.5 * (l->o0.y + l->o1.y - l->n0.y - l->n1.y);
    profile roof = roof_profile(h, sqrt(dx * dx + dy * dy));
    front.mitre0 = l->mitre0;
    front.mitre1 = l->mitre1;
    town_facade_build(t, &front, &h->front);
    if (back.length > 1.5)
        town_facade_build(t, &back, &h->back);
    party_wall(t, h, l->left, &roof, l->o0, l->n0, true);
    party_wall(t, h, l->right, &roof, l->o1, l->n1, false);
    if (h->roof == ROOF_FLAT) {
        vec2 p[4] = { l->o0, l->o1, l->n1, l->n0 };
        town_wall_rect(t, h->front.wall, &front, 0, front.length, h->eave, h->eave + h->rise, 0);
        town_wall_rect(t, h->front.wall, &back, 0, back.length, h->eave, h->eave + h->rise, 0);
        if (back.length > 1.5)
            flat_roof(t, p, 4, h->eave, h->rise, h->front.wall, h->seed);
        else
            town_flat(t, TM_FLAT_ROOF, p, 4, h->eave + h->rise);
        return;
    }
    pitched_roof(t, h, l, &roof, &front);
}

/* ---- the row around a block ---- */

static town_poly inner_line(const town_poly *line, double depth) {
    double d[4] = { depth, depth, depth, depth };
    return town_poly_inset(line, d);
}

bool town_perimeter_fits(const town_poly *line, double depth) {
    town_poly yard = inner_line(line, depth);
    if (yard.n != line->n || town_poly_area(&yard) < 90)
        return false;
    /* each edge of the yard behind its own edge of the line, long enough for a house */
    for (int i = 0; i < yard.n; i++) {
        town_wall w = town_wall_make(line->p[i], line->p[(i + 1) % line->n]);
        vec2 a = yard.p[i], b = yard.p[(i + 1) % yard.n];
        if ((b.x - a.x) * w.dir.x + (b.y - a.y) * w.dir.y < 4 ||
            fabs((a.x - w.a.x) * w.out.x + (a.y - w.a.y) * w.out.y + depth) > 0.01)
            return false;
    }
    return true;
}

static double mitre_of(vec2 before, vec2 corner, vec2 after) {
    town_wall u = town_wall_make(before, corner), v = town_wall_make(corner, after);
    double c = u.dir.x * v.dir.x + u.dir.y * v.dir.y, s = u.dir.x * v.dir.y - u.dir.y * v.dir.x;
    return s / (1 + NOC_MAX(c, -0.9));
}

enum { LOTS_MAX = 24 };

void town_perimeter(town *t, const town_poly *line, double depth, int block) {
    town_poly yard = inner_line(line, depth);
    uint32_t block_seed = town_hash(t->params.seed, 5000u + (uint32_t)block);
    house corner[TOWN_POLY_MAX]; /* a corner house belongs to both its streets; the greater one decides */
    for (int k = 0; k < line->n; k++) {
        town_way a = line->way[k], b = line->way[(k + line->n - 1) % line->n];
        corner[k] =
            house_make(t, town_hash(block_seed, (uint32_t)k), a == WAY_AVENUE || b == WAY_AVENUE ? WAY_AVENUE : a);
    }
    int number = 0;
    for (int k = 0; k < line->n; k++) {
        int next = (k + 1) % line->n, prev = (k + line->n - 1) % line->n, after = (next + 1) % line->n;
        town_wall edge = town_wall_make(line->p[k], line->p[next]);
        double s_first = (yard.p[k].x - edge.a.x) * edge.dir.x + (yard.p[k].y - edge.a.y) * edge.dir.y;
        double s_last = (yard.p[next].x - edge.a.x) * edge.dir.x + (yard.p[next].y - edge.a.y) * edge.dir.y;
        town_rng rng = { town_hash(block_seed, 100u + (uint32_t)k) };
        double first = NOC_MAX(s_first, 0) + 2.5 + 4 * town_next(&rng),
               last = NOC_MIN(s_last, edge.length) - 2.5 - 4 * town_next(&rng);
        double cut[LOTS_MAX + 1] = { 0 };
        house row[LOTS_MAX];
        int n = 0;
        row[n++] = corner[k];
        if (last - first > 9) {
            int between = NOC_CLAMP((int)((last - first) / town_range(&rng, 13, 19) + 0.5), 1, LOTS_MAX - 2);
            for (int i = 0; i < between; i++) {
                double jitter = i ? town_range(&rng, -0.18, 0.18) : 0;
                cut[n] = first + (last - first) * (i + jitter) / between;
                row[n++] = house_make(t, town_hash(block_seed, 1000u + (uint32_t)(k * LOTS_MAX + i)), line->way[k]);
            }
            cut[n] = last;
            row[n++] = corner[next];
        } else {
            cut[n] = 0.5 * (NOC_MAX(s_first, 0) + NOC_MIN(s_last, edge.length));
            row[n++] = corner[next];
        }
        cut[n] = edge.length;
        vec2 o[LOTS_MAX + 1], b[LOTS_MAX + 1];
        for (int i = 0; i <= n; i++) {
            double p[3];
            town_wall_point(&edge, cut[i], 0, 0, p);
            o[i] = town_warp(t, (vec2){ p[0], p[1] });
            town_wall_point(&edge, cut[i], 0, -depth, p);
            b[i] = town_warp(t, i == 0 ? yard.p[k] : i == n ? yard.p[next] : (vec2){ p[0], p[1] });
        }
        for (int i = 0; i < n; i++) {
            lot l = { .o0 = o[i],
                      .o1 = o[i + 1],
                      .n0 = b[i],
                      .n1 = b[i + 1],
                      .left = i ? &row[i - 1] : &corner[k],
                      .right = i + 1 < n ? &row[i + 1] : &corner[next] };
            if (i == 0)
                l.mitre0 = mitre_of(town_warp(t, line->p[prev]), o[0], o[1]);
            if (i == n - 1)
                l.mitre1 = mitre_of(o[n - 1], o[n], town_warp(t, line->p[after]));
            house h = row[i];
            bool at_corner = i == 0 || i == n - 1;
            if (at_corner && line->way[k] != WAY_AVENUE) /* the side street's front of a corner house */
                h.front.shops = false;
            h.front.seed = town_hash(h.front.seed, (uint32_t)(k * 64 + i));
            h.back.seed = town_hash(h.back.seed, (uint32_t)(k * 64 + i));
            h.chimney = h.chimney && !at_corner;
            lot_build(t, &h, &l);
            town_flush(t, "block %d/building %d", block, number++);
        }
    }
}

/* ---- single houses ---- */

void town_solid(town *t, const town_poly *line, int block) {
    uint32_t seed = town_hash(t->params.seed, 6000u + (uint32_t)block);
    bool avenue = false;
    for (int i = 0; i < line->n; i++)
        avenue = avenue || line->way[i] == WAY_AVENUE;
    house h = house_make(t, seed, avenue ? WAY_AVENUE : WAY_SIDE);
    vec2 p[TOWN_POLY_MAX], centre = { 0, 0 };
    for (int i = 0; i < line->n; i++) {
        p[i] = town_warp(t, line->p[i]);
        centre.x += p[i].x / line->n;
        centre.y += p[i].y / line->n;
    }
    for (int i = 0; i < line->n; i++) {
        int j = (i + 1) % line->n;
        town_wall w = town_wall_make(p[i], p[j]);
        w.mitre0 = mitre_of(p[(i + line->n - 1) % line->n], p[i], p[j]);
        w.mitre1 = mitre_of(p[i], p[j], p[(j + 1) % line->n]);
        town_facade f = h.front;
        f.seed = town_hash(f.seed, (uint32_t)i);
        f.shops = f.shops && line->way[i] == WAY_AVENUE;
        town_facade_build(t, &w, &f);
        if (h.roof == ROOF_FLAT)
            town_wall_rect(t, f.wall, &w, 0, w.length, h.eave, h.eave + h.rise, 0);
        else { /* a tent over the whole house, its foot on the cornice */
            double q[3][3];
            town_wall_point(&w, -0.42 * w.mitre0, h.eave - 0.01, 0.42, q[0]);
            town_wall_point(&w, w.length + 0.42 * w.mitre1, h.eave - 0.01, 0.42, q[1]);
            put(q[2], centre, h.eave + 1.5 * h.rise);
            town_tri(t, h.tiles, q[0], q[1], q[2]);
        }
    }
    if (h.roof == ROOF_FLAT)
        flat_roof(t, p, line->n, h.eave, h.rise, h.front.wall, seed);
    town_flush(t, "block %d/building 0", block);
}

static void tower_body(town *t, vec2 c[4], town_facade *f, double parapet, uint32_t seed) {
    double top = f->base + town_facade_height(f);
    for (int i = 0; i < 4; i++) {
        town_wall w = town_wall_make(c[i], c[(i + 1) % 4]);
        f->seed = town_hash(seed, 50u + (uint32_t)i);
        town_facade_build(t, &w, f);
        town_wall_rect(t, f->wall, &w, 0, w.length, top, top + parapet, 0);
    }
    flat_roof(t, c, 4, top, parapet, f->wall, seed);
}

/* An office or residential tower in the middle of its block. */
void town_tower(town *t, const town_poly *line, int block, bool square) {
    uint32_t seed = town_hash(t->params.seed, 7000u + (uint32_t)block);
    town_rng rng = { seed };
    bool office = town_chance(&rng, 0.6);
    vec2 centre = town_warp(t, town_poly_centre(line)), ahead = town_poly_centre(line), c[4];
    ahead.x += 10;
    vec2 dir = town_wall_make(centre, town_warp(t, ahead)).dir;
    double reach = 0.5 * sqrt(town_poly_area(line)), along = NOC_MIN(reach * town_range(&rng, 0.5, 0.62), 17),
           across = square ? along : NOC_MIN(0.72 * along, 11.5);
    town_facade f = { .wall = office ? TM_METAL : TM_CONCRETE,
                      .storeys = 12 + town_below(&rng, 9),
                      .base = TOWN_KERB,
                      .ground = 4.6,
                      .storey = office ? 3.5 : 3.0,
                      .bay = office ? 2.1 : 3.0,
                      .width = office ? 1.85 : 1.7,
                      .height = office ? 2.3 : 1.5,
                      .sill = office ? 0.6 : 0.9,
                      .office = office };
    town_rect(centre, dir, along, across, c);
    tower_body(t, c, &f, 1.1, seed);
    town_flush(t, "block %d/building 0", block);
}
