/* A courtyard with arcades on two floors, about a quarter of a million triangles, by one lantern that hangs in its
 * middle: much geometry, hard shadows of columns and balusters, and nothing to choose among lights.
 *
 * Bays run along the four sides of the court; each side is built along its own x axis, looking into the court. */
#include "city/builtin/kit.h"

#define BAY 2.7
#define LONG 9     /* bays along x */
#define SHORT 5    /* along y */
#define DEPTH 3.4  /* of the arcades */
#define GROUND 4.9 /* height of the ground floor's arcade, floor to floor */
#define UPPER 4.2
#define PIER 0.34 /* half the thickness of the wall over the arches */

/* floor, to the next; columns: to the arches' spring */
typedef struct storey {
    double z, height, column, radius;
} storey;

static const storey storeys[2] = { { 0, GROUND, 2.75, 0.26 }, { GROUND, UPPER, 2.3, 0.2 } };

typedef struct materials {
    int stone, plaster, floor, tiles, cloth[3], iron;
} materials;

/* ---- a bay: between two columns at x = 0 and x = BAY, of a wall whose middle is y = 0; the court is at y < 0 ---- */

static void column(kit *k, const storey *s) {
    const double r = s->radius, h = s->column;
    const double base[][2] = { { 0, 0.14 },        { 1.45 * r, 0.14 }, { 1.5 * r, 0.18 },
                               { 1.42 * r, 0.25 }, { 1.15 * r, 0.27 }, { 1.12 * r, 0.31 },
                               { 1.25 * r, 0.35 }, { 1.2 * r, 0.39 },  { 1.0 * r, 0.42 } };
    const double shaft[][2] = { { r, 0.42 }, { 1.0 * r, 0.3 * h }, { 0.95 * r, 0.6 * h }, { 0.84 * r, h - 0.48 } };
    const double capital[][2] = { { 0.84 * r, h - 0.48 }, { 1.0 * r, h - 0.45 },  { 1.0 * r, h - 0.42 },
                                  { 0.86 * r, h - 0.39 }, { 0.95 * r, h - 0.28 }, { 1.3 * r, h - 0.17 },
                                  { 1.45 * r, h - 0.14 }, { 0, h - 0.14 } };
    kit_box(k, v3(-1.55 * r, -1.55 * r, 0), v3(1.55 * r, 1.55 * r, 0.14));
    kit_turned(k, 28, 14, &(kit_lathe){ .profile = base, .count = (int)NOC_COUNT(base), .smooth = true });
    kit_turned(k, 60, 5,
               &(kit_lathe){
                   .profile = shaft, .count = (int)NOC_COUNT(shaft), .smooth = true, .flutes = 15, .depth = 0.1 });
    kit_turned(k, 28, 12, &(kit_lathe){ .profile = capital, .count = (int)NOC_COUNT(capital), .smooth = true });
    kit_box(k, v3(-1.6 * r, -PIER - 0.04, h - 0.14), v3(1.6 * r, PIER + 0.04, h));
}

typedef struct arch {
    double radius, spring, top, y, out;
} arch;

/* Point of the arch at u: from its left foot over the crown to its right foot. */
static vec3 arch_point(const arch *a, double u, double radius, double y) {
    double turn = 0.5 * (1 - u);
    return v3(0.5 * BAY + radius * town_cos(turn), y, a->spring + radius * town_sin(turn));
}

static vec3 intrados(const void *shape, double u, double v) {
    const arch *a = shape;
    return arch_point(a, u, a->radius, PIER * (1 - 2 * v));
}

/* The wall above the arch, from its edge straight up to the top; out tells which side it faces. */
static vec3 spandrel(const void *shape, double u, double v) {
    const arch *a = shape;
    vec3 p = arch_point(a, a->out < 0 ? u : 1 - u, a->radius, a->y);
    return v3(p.x, p.y, p.z + v * (a->top - p.z));
}

/* A round moulding along the arch's edge on the court's side. */
static vec3 moulding(const void *shape, double u, double v) {
    const arch *a = shape;
    double r = 0.055, turn = 0.5 * v;
    return arch_point(a, u, a->radius + 0.07 + r * town_cos(turn), -PIER - r * town_sin(turn));
}

static void arcade_bay(kit *k, const storey *s) {
    double foot = 1.25 * s->radius;
    arch a = { .radius = 0.5 * BAY - foot, .spring = s->column, .top = s->height - 0.25 };
    kit_patch(k, 24, 3, intrados, &a);
    kit_patch(k, 24, 6, moulding, &a);
    for (int side = -1; side <= 1; side += 2) {
        a.y = side * PIER;
        a.out = side;
        kit_patch(k, 24, 2, spandrel, &a);
        for (int end = 0; end < 2; end++) { /* over the columns */
            double x0 = end ? BAY - foot : 0, x1 = end ? BAY : foot;
            vec3 q[4] = { v3(x0, a.y, a.spring), v3(x1, a.y, a.spring), v3(x1, a.y, a.top), v3(x0, a.y, a.top) };
            if (side < 0)
                kit_quad(k, q[0], q[1], q[2], q[3]);
            else
                kit_quad(k, q[1], q[0], q[3], q[2]);
        }
    }
    /* cornice under the next floor */
    kit_box(k, v3(0, -PIER - 0.10, a.top - 0.12), v3(BAY, PIER, a.top));
    kit_box(k, v3(0, -PIER - 0.22, a.top), v3(BAY, PIER, s->height));
}

static void balustrade(kit *k, const storey *s) {
    static const double baluster[][2] = { { 0.055, 0 },    { 0.06, 0.06 },  { 0.035, 0.1 },
                                          { 0.05, 0.18 },  { 0.072, 0.3 },  { 0.06, 0.42 },
                                          { 0.032, 0.58 }, { 0.036, 0.64 }, { 0.055, 0.7 } };
    const vec3 origin = k->origin;
    double from = 1.55 * s->radius, to = BAY - from;
    kit_box(k, v3(from, -0.09, 0), v3(to, 0.09, 0.12));
    kit_box(k, v3(from, -0.11, 0.82), v3(to, 0.11, 0.94));
    for (int i = 0; i < 8; i++) {
        k->origin = add(origin, add(scale(k->axis[0], from + (to - from) * (i + 0.5) / 8), scale(k->axis[2], 0.12)));
        kit_turned(k, 10, 14, &(kit_lathe){ .profile = baluster, .count = (int)NOC_COUNT(baluster), .smooth = true });
    }
    k->origin = origin;
}

/* Back wall of the arcade, its floor and ceiling, with a doorway in every second bay. */
static void gallery(kit *k, const storey *s, const materials *m, bool doorway) {
    double y = PIER + DEPTH, h = s->height - 0.25;
    if (doorway) {
        kit_box(k, v3(0, y, 0), v3(0.65, y + 0.35, h));
        kit_box(k, v3(BAY - 0.65, y, 0), v3(BAY, y + 0.35, h));
        kit_box(k, v3(0.65, y, 2.5), v3(BAY - 0.65, y + 0.35, h));
        kit_box(k, v3(0.65, y + 0.3, 0), v3(BAY - 0.65, y + 0.35, 2.5));
    } else {
        kit_box(k, v3(0, y, 0), v3(BAY, y + 0.35, h));
    }
    kit_flush(k, m->plaster, "wall");
    kit_box(k, v3(0, PIER, h), v3(BAY, y + 0.35, s->height));
    kit_flush(k, m->plaster, "ceiling");
    if (doorway) {
        kit_box(k, v3(0.53, y - 0.06, 0), v3(0.67, y, 2.6));
        kit_box(k, v3(BAY - 0.67, y - 0.06, 0), v3(BAY - 0.53, y, 2.6));
        kit_box(k, v3(0.53, y - 0.08, 2.5), v3(BAY - 0.53, y, 2.66));
        kit_flush(k, m->stone, "door frame");
    }
}

/* ---- cloths that hang from the upper gallery ---- */

typedef struct drape {
    double width, length, phase;
} drape;

static vec3 cloth(const void *shape, double u, double v) {
    const drape *d = shape;
    double fold = 0.05 + 0.07 * v,
           wave = town_sin(4.5 * u + d->phase) + 0.4 * town_sin(10 * u + 0.35 * v + 2 * d->phase);
    double narrow = 1 - 0.16 * v * (1 - 0.3 * v);
    return v3(0.5 * BAY + d->width * (u - 0.5) * narrow, -PIER - 0.3 - fold * wave - 0.12 * v,
              GROUND + 0.94 - d->length * v);
}

static void add_side(kit *k, const materials *m, int bays, vec3 from, double turns, int first_bay) {
    for (int s = 0; s < 2; s++)
        for (int i = 0; i < bays; i++) {
            kit_place(k, from, turns, 1); /* for its axes */
            vec3 foot = add(add(from, scale(k->axis[0], i * BAY)), v3(0, 0, storeys[s].z));
            kit_place(k, foot, turns, 1);
            column(k, &storeys[s]);
            kit_flush(k, m->stone, "column");
            arcade_bay(k, &storeys[s]);
            kit_flush(k, m->stone, "arch");
            gallery(k, &storeys[s], m, (i + s) % 2 == 0);
            if (s == 1) {
                balustrade(k, &storeys[1]);
                kit_flush(k, m->stone, "balustrade");
                kit_box(k, v3(0, -PIER - 0.35, UPPER), v3(BAY, PIER + DEPTH + 0.35, UPPER + 0.18));
                kit_flush(k, m->tiles, "eaves");
            } else if ((i + first_bay) % 3 == 1) {
                drape d = { .width = 1.7, .length = 3.4, .phase = 0.37 * (i + first_bay) };
                kit_patch(k, 48, 30, cloth, &d);
                kit_flush(k, m->cloth[(i + first_bay) / 3 % 3], "cloth");
                const double rod = -PIER - 0.3, z = GROUND + 0.93; /* before the balustrade's rail, on two brackets */
                kit_box(k, v3(0.4, rod - 0.015, z), v3(BAY - 0.4, rod + 0.015, z + 0.03));
                for (int end = 0; end < 2; end++)
                    kit_box(k, v3(end ? BAY - 0.52 : 0.5, rod, z - 0.02), v3(end ? BAY - 0.5 : 0.52, -0.1, z));
                kit_flush(k, m->iron, "rod");
            }
        }
}

static vec3 paving(const void *shape, double u, double v) {
    double x = (LONG * BAY + 2 * DEPTH + 2) * (u - 0.5), y = (SHORT * BAY + 2 * DEPTH + 2) * (v - 0.5);
    return v3(x, y, 0);
}

/* The rooms' corners, where two arcades meet. */
static void corner(kit *k, const materials *m, double x, double y) {
    double sx = x < 0 ? -1 : 1, sy = y < 0 ? -1 : 1, deep = PIER + DEPTH + 0.35, top = GROUND + UPPER;
    double x1 = x + sx * deep, y1 = y + sy * deep, lx = x < x1 ? x : x1, hx = x < x1 ? x1 : x, ly = y < y1 ? y : y1,
           hy = y < y1 ? y1 : y;
    for (int s = 0; s < 2; s++)
        kit_box(k, v3(lx, ly, storeys[s].z + storeys[s].height - 0.25), v3(hx, hy, storeys[s].z + storeys[s].height));
    kit_box(k, v3(lx, sy < 0 ? ly : hy - 0.35, 0), v3(hx, sy < 0 ? ly + 0.35 : hy, top - 0.25));
    kit_box(k, v3(sx < 0 ? lx : hx - 0.35, ly, 0), v3(sx < 0 ? lx + 0.35 : hx, hy, top - 0.25));
    kit_flush(k, m->plaster, "corner");
    kit_box(k, v3(lx, ly, top), v3(hx, hy, top + 0.18));
    kit_flush(k, m->tiles, "eaves");
}

/* On a cord from a cable across the court. */
static void lantern(kit *k, const materials *m, double half_width) {
    const double z = 5.6, r = 0.24, cable = GROUND + UPPER - 0.5;
    static const double cap[][2] = { { 0.16, 0 }, { 0.2, 0.02 }, { 0.12, 0.1 }, { 0.05, 0.2 }, { 0, 0.22 } };
    kit_box(k, v3(-0.012, -half_width, cable - 0.012), v3(0.012, half_width, cable + 0.012));
    kit_box(k, v3(-0.01, -0.01, z + r + 0.2), v3(0.01, 0.01, cable));
    kit_place(k, v3(0, 0, z + r + 0.01), 0, 1);
    kit_turned(k, 32, 12, &(kit_lathe){ .profile = cap, .count = (int)NOC_COUNT(cap), .smooth = true });
    kit_place(k, v3(0, 0, 0), 0, 1);
    kit_flush(k, m->iron, "lantern");
    /* 12 klm: Phi = pi L 4 pi r^2 */
    const double luminance = 12000 / (4 * 3.14159265358979 * 3.14159265358979 * r * r);
    noc_light l = { .kind = NOC_LIGHT_SPHERE,
                    .position = { 0, 0, z },
                    .radius = r,
                    .name = "lantern",
                    .emission = { (float)(1.34 * luminance), (float)(0.95 * luminance), (float)(0.5 * luminance) } };
    kit_light(k, &l);
}

noc_status scene_atrium(noc_scene *scene, const noc_builtin_params *params, bool windows) {
    kit k = kit_start(scene);
    const materials m = { .stone = kit_material(&k, .52f, .48f, .41f, 0, 1),
                          .plaster = kit_material(&k, .58f, .52f, .43f, 0, 1),
                          .floor = kit_material(&k, .34f, .31f, .28f, .04f, .3f),
                          .tiles = kit_material(&k, .32f, .16f, .10f, .02f, .7f),
                          .cloth = { kit_material(&k, .45f, .06f, .05f, 0, 1), kit_material(&k, .07f, .13f, .38f, 0, 1),
                                     kit_material(&k, .10f, .30f, .12f, 0, 1) },
                          .iron = kit_material(&k, .05f, .05f, .05f, .06f, .4f) };
    const double x = 0.5 * LONG * BAY, y = 0.5 * SHORT * BAY;
    kit_patch(&k, 32, 24, paving, NULL);
    kit_flush(&k, m.floor, "floor");
    add_side(&k, &m, LONG, v3(x, -y, 0), 0.5, 0); /* south, then on clockwise; the court is at each side's y < 0 */
    add_side(&k, &m, SHORT, v3(-x, -y, 0), 0.25, LONG);
    add_side(&k, &m, LONG, v3(-x, y, 0), 0, LONG + SHORT);
    add_side(&k, &m, SHORT, v3(x, y, 0), 0.75, 2 * LONG + SHORT);
    kit_place(&k, v3(0, 0, 0), 0, 1);
    for (int i = 0; i < 4; i++)
        corner(&k, &m, i & 1 ? x : -x, i & 2 ? y : -y);
    lantern(&k, &m, y);
    kit_camera(&k, v3(-x + 2.2, -2.6, 1.75), v3(1.5, 0.9, 3.5), 62);
    return kit_finish(&k);
}
