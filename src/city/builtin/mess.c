/* Many small coloured lights on and among many objects: what a pixel sees is decided by a few lights within a hand's
 * breadth of it, of thousands, and half of these are behind something.
 *
 * Lights stand on the surfaces, evenly over their area. A fourth each are balls, squares, triangles and discs; above
 * BALLS_MOST all are squares and triangles, because the shape of a ball takes 172 triangles. Their size shrinks with
 * their distance, and their flux is shared, so that the picture is about as bright whatever their number. */
#include "city/builtin/kit.h"

#include <math.h>
#include <nocturne/option.h>

#define OBJECTS 56
#define TRIES 3000 /* to find room for them */
#define HALF 4.4   /* m, of the square that they lie on */
#define BALLS_MOST 20000
#define FLUX 5200.0 /* lm, of all lights */

typedef struct object {
    vec3 at;
    double size, turns; /* it fits into a ball of radius `size` around `at` */
    int kind;
} object;

enum { BALL, VASE, RING, BOXES, CONE, KNOT, BOWL, PRISM, STAR, KINDS };
/* Radius of the floor that each covers, in shares of its size. */
static const double footprint[KINDS] = { 0.3, 0.62, 0.5, 0.83, 0.75, 0.5, 0.36, 0.66, 0.64 };

/* ---- objects ---- */

/* Places without overlap, larger ones first. */
static int scatter(object *o, uint32_t seed) {
    town_rng rng = { town_hash(seed, 301) };
    int n = 0;
    for (int tries = 0; tries < TRIES && n < OBJECTS; tries++) {
        double size = 0.82 - 0.62 * tries / TRIES;
        object c = { .size = size * town_range(&rng, 0.9, 1.1), .turns = town_next(&rng), .kind = n % KINDS };
        c.at = v3(town_range(&rng, -1, 1) * (HALF - size), town_range(&rng, -1, 1) * (HALF - size), 0);
        bool room = true;
        for (int i = 0; i < n; i++) {
            vec3 d = sub(o[i].at, c.at);
            room = room && dot(d, d) > (o[i].size + c.size) * (o[i].size + c.size);
        }
        if (room)
            o[n++] = c;
    }
    return n;
}

static vec3 twisted(const void *shape, double u, double v) {
    double side = 4 * (u < 1 ? u : 0), f = side - floor(side), turn = 0.35 * v;
    int i = (int)side;
    static const double corner[5][2] = { { 1, 1 }, { -1, 1 }, { -1, -1 }, { 1, -1 }, { 1, 1 } };
    double x = corner[i][0] + f * (corner[i + 1][0] - corner[i][0]),
           y = corner[i][1] + f * (corner[i + 1][1] - corner[i][1]);
    double c = town_cos(turn), s = town_sin(turn), r = 0.46 * (1 - 0.25 * v);
    return v3(r * (c * x - s * y), r * (s * x + c * y), 1.7 * v);
}

/* Of about unit size, standing on z = 0. */
static void shape(kit *k, int kind) {
    static const double vase[][2] = { { 0, 0 },       { 0.42, 0 },   { 0.62, 0.3 },  { 0.66, 0.62 }, { 0.42, 1.0 },
                                      { 0.26, 1.25 }, { 0.36, 1.5 }, { 0.31, 1.47 }, { 0.22, 1.25 }, { 0, 1.2 } };
    static const double cone[][2] = { { 0, 0 }, { 0.72, 0 }, { 0.72, 0.06 }, { 0.36, 0.72 }, { 0, 1.45 } };
    static const double bowl[][2] = { { 0, 0 },       { 0.3, 0 },     { 0.34, 0.06 }, { 0.7, 0.34 },
                                      { 0.92, 0.72 }, { 0.86, 0.72 }, { 0.6, 0.38 },  { 0, 0.14 } };
    static const double star[][2] = { { 0, 0 }, { 0.62, 0 }, { 0.62, 1.3 }, { 0.5, 1.38 }, { 0, 1.38 } };
    const vec3 origin = k->origin, x = k->axis[0], y = k->axis[1], z = k->axis[2];
    double lift = kind == BALL   ? 0.8
                  : kind == RING ? 0.93
                  : kind == KNOT ? 0.36
                                 : 0,
           size = kind == BALL   ? 0.8
                  : kind == RING ? 0.7
                  : kind == KNOT ? 0.66
                                 : 1;
    k->origin = add(origin, scale(z, lift));
    k->axis[0] = scale(x, size);
    k->axis[1] = scale(kind == RING ? z : y, size); /* a ring stands on its tube */
    k->axis[2] = scale(kind == RING ? y : z, kind == RING ? -size : size);
    switch (kind) {
    case BALL: kit_sphere(k, 72, 48); break;
    case VASE:
        kit_turned(k, 64, 54, &(kit_lathe){ .profile = vase, .count = (int)NOC_COUNT(vase), .smooth = true });
        break;
    case RING: kit_torus(k, 96, 32, 0.33); break;
    case BOXES:
        kit_box(k, v3(-0.58, -0.58, 0), v3(0.58, 0.58, 0.9)), kit_box(k, v3(-0.3, -0.42, 0.9), v3(0.42, 0.3, 1.4));
        break;
    case CONE: kit_turned(k, 64, 4, &(kit_lathe){ .profile = cone, .count = (int)NOC_COUNT(cone) }); break;
    case KNOT: kit_knotted(k, 360, 28, &(kit_knot){ .p = 2, .q = 3, .ring = 0.36, .tube = 0.19 }); break;
    case BOWL:
        kit_turned(k, 64, 42, &(kit_lathe){ .profile = bowl, .count = (int)NOC_COUNT(bowl), .smooth = true });
        break;
    case PRISM:
        kit_patch(k, 64, 40, twisted, NULL);
        kit_quad(k, twisted(NULL, 0, 1), twisted(NULL, 0.25, 1), twisted(NULL, 0.5, 1), twisted(NULL, 0.75, 1));
        break;
    default:
        kit_turned(k, 80, 4, &(kit_lathe){ .profile = star, .count = (int)NOC_COUNT(star), .flutes = 5, .depth = 0.4 });
    }
    k->origin = origin;
    k->axis[0] = x;
    k->axis[1] = y;
    k->axis[2] = z;
}

/* ---- lights ---- */

static const float palette[][3] = { { 1, .05f, .03f }, { 1, .35f, .04f }, { 1, .75f, .12f },
                                    { .10f, 1, .12f }, { .05f, .65f, 1 }, { .07f, .13f, 1 },
                                    { .45f, .07f, 1 }, { 1, .10f, .5f },  { 1, .82f, .6f } };

/* Triangles of the scene by their area. */
typedef struct area_table {
    double *sum; /* up to and with each */
    size_t first, count;
} area_table;

static void corners(const noc_scene *s, size_t triangle, vec3 p[3]) {
    for (int i = 0; i < 3; i++) {
        const float *v = &s->positions.data[3 * (size_t)s->indices.data[3 * triangle + (size_t)i]];
        p[i] = v3((double)v[0], (double)v[1], (double)v[2]);
    }
}

/* sum is NULL where memory is refused. */
static area_table tabulate(const noc_scene *s, size_t first) {
    area_table t = { .first = first, .count = s->indices.len / 3 - first };
    t.sum = noc_alloc(t.count * sizeof(*t.sum));
    double sum = 0;
    if (!t.sum)
        return t;
    for (size_t i = 0; i < t.count; i++) {
        vec3 p[3];
        corners(s, first + i, p);
        vec3 n = cross(sub(p[1], p[0]), sub(p[2], p[0]));
        t.sum[i] = sum += 0.5 * sqrt(dot(n, n));
    }
    return t;
}

/* A random place on the surfaces and the normal there, outside of the objects. */
static vec3 pick_place(const noc_scene *s, const area_table *t, const object *o, int objects, town_rng *rng,
                       vec3 *normal) {
    vec3 at = { 0 };
    for (int tries = 0; tries < 64; tries++) {
        double want = town_next(rng) * t->sum[t->count - 1], u = sqrt(town_next(rng)), v = town_next(rng);
        size_t lo = 0, hi = t->count - 1;
        while (lo < hi) {
            size_t middle = (lo + hi) / 2;
            if (t->sum[middle] > want)
                hi = middle;
            else
                lo = middle + 1;
        }
        vec3 p[3];
        corners(s, t->first + lo, p);
        at = add(scale(p[0], 1 - u), add(scale(p[1], u * (1 - v)), scale(p[2], u * v)));
        *normal = unit(cross(sub(p[1], p[0]), sub(p[2], p[0])));
        bool clear = at.z > 0.02 || normal->z > 0; /* no undersides */
        for (int i = 0; i < objects && at.z < 0.02; i++) {
            double x = at.x - o[i].at.x, y = at.y - o[i].at.y, r = o[i].size * footprint[o[i].kind];
            clear = clear && x * x + y * y > r * r;
        }
        if (clear)
            break;
    }
    return at;
}

/* A light that stands on a surface at p with normal n. Flat ones lean back on their lower edge and shine over the
 * surface. */
static noc_light stand(noc_light_kind kind, vec3 p, vec3 n, double r, town_rng *rng) {
    noc_light l = { .kind = kind, .radius = r, .name = "light" };
    vec3 any = unit(v3(town_range(rng, -1, 1), town_range(rng, -1, 1), town_range(rng, -1, 1)));
    vec3 side = cross(n, any);
    side = dot(side, side) > 1e-6 ? unit(side) : unit(cross(n, v3(n.y, n.z, n.x + 1)));
    vec3 rise = add(scale(n, 0.6), scale(cross(n, side), 0.8)), face = cross(side, rise); /* 53 degrees off upright */
    vec3 at = add(p, scale(n, 0.05 * r));
    if (kind == NOC_LIGHT_SPHERE)
        at = add(p, scale(n, 1.02 * r));
    else if (kind == NOC_LIGHT_DISC)
        at = add(at, scale(rise, r));
    else
        at = sub(at, scale(side, r));
    vec3 u = scale(side, 2 * r),
         v = kind == NOC_LIGHT_TRIANGLE ? add(scale(side, r), scale(rise, 2 * r)) : scale(rise, 2 * r);
    memcpy(l.position, &at, sizeof(l.position));
    memcpy(l.direction, &face, sizeof(l.direction));
    memcpy(l.edge_u, &u, sizeof(l.edge_u));
    memcpy(l.edge_v, &v, sizeof(l.edge_v));
    return l;
}

/* Which object a place belongs to, or lies before; what its lights' colour goes by. */
static int nearest(const object *o, int objects, vec3 p) {
    int best = 0;
    double least = 1e9;
    for (int i = 0; i < objects; i++) {
        double x = p.x - o[i].at.x, y = p.y - o[i].at.y, d = x * x + y * y - o[i].size * o[i].size;
        if (d < least)
            least = d, best = i;
    }
    return best;
}

static void add_lights(kit *k, size_t first, const object *o, int objects, const noc_builtin_params *params) {
    static const noc_light_kind kinds[2][4] = {
        { NOC_LIGHT_SPHERE, NOC_LIGHT_PARALLELOGRAM, NOC_LIGHT_TRIANGLE, NOC_LIGHT_DISC },
        { NOC_LIGHT_PARALLELOGRAM, NOC_LIGHT_TRIANGLE, NOC_LIGHT_PARALLELOGRAM, NOC_LIGHT_TRIANGLE }
    };
    const double pi = 3.14159265358979;
    area_table t = tabulate(k->scene, first);
    if (!t.sum) {
        k->failed = noc_scene_out_of_memory(k->scene);
        return;
    }
    town_rng rng = { town_hash(params->seed, 302) };
    double apart = sqrt(t.sum[t.count - 1] / params->lights), r = NOC_MIN(0.11 * apart, 0.022);
    for (int i = 0; i < params->lights && !k->failed; i++) {
        vec3 n, p = pick_place(k->scene, &t, o, objects, &rng, &n);
        noc_light_kind kind = kinds[params->lights > BALLS_MOST][i % 4];
        noc_light l = stand(kind, p, n, r, &rng);
        double area = r * r *
                      (kind == NOC_LIGHT_SPHERE     ? 4 * pi
                       : kind == NOC_LIGHT_DISC     ? pi
                       : kind == NOC_LIGHT_TRIANGLE ? 2
                                                    : 4);
        double dim = town_next(&rng), flux = FLUX / params->lights * (0.25 + 2.25 * dim * dim); /* 1 in the mean */
        uint32_t of = town_hash(params->seed, 400u + (uint32_t)nearest(o, objects, p));
        const float *rgb = palette[town_chance(&rng, 0.75) ? of % NOC_COUNT(palette)
                                                           : (uint32_t)town_below(&rng, (int)NOC_COUNT(palette))];
        for (int c = 0; c < 3; c++)
            l.emission[c] = (float)(flux / (pi * area)) * rgb[c];
        kit_light(k, &l);
    }
    free(t.sum);
}

static vec3 rug(const void *side, double u, double v) {
    return v3((u - 0.5) * *(const double *)side, (v - 0.5) * *(const double *)side, 0);
}

noc_status scene_mess(noc_scene *scene, const noc_builtin_params *params, bool windows) {
    if (noc_option_check(noc_builtin_options(), params, "mess", scene->log))
        return NOC_ERR_ARGUMENT;
    static const float paint[][3] = { { .62f, .60f, .56f }, { .55f, .30f, .24f }, { .26f, .42f, .52f },
                                      { .56f, .50f, .28f }, { .34f, .50f, .32f }, { .45f, .36f, .52f } };
    kit k = kit_start(scene);
    object o[OBJECTS];
    int objects = scatter(o, params->seed), material[NOC_COUNT(paint)];
    for (size_t i = 0; i < NOC_COUNT(paint); i++)
        material[i] = kit_material(&k, paint[i][0], paint[i][1], paint[i][2], i % 2 ? .04f : 0, i % 2 ? .35f : 1);
    int floor_material = kit_material(&k, .42f, .41f, .40f, 0, 1);
    const double inner = 2 * (HALF + 0.3), outer = 30, h = 0.5 * inner;
    const vec3 in[4] = { v3(-h, -h, 0), v3(h, -h, 0), v3(h, h, 0), v3(-h, h, 0) };
    for (int i = 0; i < 4; i++) {
        vec3 a = in[i], b = in[(i + 1) % 4];
        kit_quad(&k, scale(a, outer), scale(b, outer), b, a);
    }
    kit_flush(&k, floor_material, "floor");
    size_t first = scene->indices.len / 3;
    kit_patch(&k, 24, 24, rug, &inner);
    kit_flush(&k, floor_material, "floor");
    for (int i = 0; i < objects; i++) {
        kit_place(&k, o[i].at, o[i].turns, o[i].size);
        shape(&k, o[i].kind);
        kit_flush(&k, material[town_hash(params->seed, 500u + (uint32_t)i) % NOC_COUNT(paint)], "object");
    }
    kit_place(&k, v3(0, 0, 0), 0, 1);
    if (!k.failed)
        add_lights(&k, first, o, objects, params);
    kit_camera(&k, v3(0.8, -7.6, 4.3), v3(0, -0.35, 0.35), 42);
    return kit_finish(&k);
}
