/* Lamps by a rule, where the data holds none: along the edges of roads, else around the buildings.
 *
 * Candidates are taken at short steps along the edges, in the order of the scene's triangles, and the first ones win:
 * each keeps a distance from all that were accepted before it. Along roads a first round asks for twice that distance
 * on the same kerb, so that the lamps of the other kerb stand between them; a second round fills where there is no
 * other kerb. The same scene always gets the same lamps. */
#include "city/lamp.h"

#include <math.h>
#include <stdio.h>

#define ROAD_SPACING 28.0 /* m between lamps along roads: usual for poles of 6 to 8 m (EN 13201 classes P and M5) */
#define WALL_SPACING 25.0
#define WALL_DISTANCE 3.0 /* m in front of a wall */
#define KERB_DISTANCE 0.6 /* m behind the road's edge */
#define MAX_LAMPS 200000
/* Of vertical rays (noc_ground_looked) and at lamps beside a place: noc_ground_most_looks, and so many a triangle of
 * the scene. */
#define LOOKS_A_TRIANGLE 200u

/* ---- places that are taken, by cells as large as the spacing ---- */

typedef struct spot {
    double x, y, facing[2];
    uint32_t next; /* in the same bucket, index + 1 */
} spot;

typedef struct spots {
    double spacing, cell; /* cell: twice the spacing */
    bool alternate;
    size_t looks; /* so far */
    NOC_ARRAY(spot) list;
    uint32_t bucket[1 << 14]; /* index + 1 */
} spots;

static uint32_t bucket_of(int64_t cx, int64_t cy) {
    uint64_t h = (uint64_t)cx * 0x9e3779b97f4a7c15u ^ (uint64_t)cy * 0xc2b2ae3d27d4eb4fu;
    return (uint32_t)((h ^ h >> 29) * 0xbf58476d1ce4e5b9u >> 50);
}

/* Too near, or, while sides alternate, on the same kerb within twice the spacing? */
static bool conflicts(const spots *s, const spot *have, double x, double y, const double facing[2]) {
    double dx = have->x - x, dy = have->y - y, near = .9 * s->spacing, far = 1.9 * s->spacing, d2 = dx * dx + dy * dy;
    bool same_kerb =
        have->facing[0] * facing[0] + have->facing[1] * facing[1] > .7 && fabs(dx * facing[0] + dy * facing[1]) < 4;
    return d2 < near * near || (s->alternate && same_kerb && d2 < far * far);
}

static bool keeps_distance(spots *s, double x, double y, const double facing[2]) {
    int64_t cx = (int64_t)floor(x / s->cell), cy = (int64_t)floor(y / s->cell);
    for (int64_t j = cy - 1; j <= cy + 1; j++)
        for (int64_t i = cx - 1; i <= cx + 1; i++)
            for (uint32_t k = s->bucket[bucket_of(i, j)]; k; k = s->list.data[k - 1].next, s->looks++)
                if (conflicts(s, &s->list.data[k - 1], x, y, facing))
                    return false;
    return true;
}

/* False: no memory. */
static bool take(spots *s, double x, double y, const double facing[2]) {
    uint32_t *first = &s->bucket[bucket_of((int64_t)floor(x / s->cell), (int64_t)floor(y / s->cell))];
    if (!array_push(&s->list, (spot){ x, y, { facing[0], facing[1] }, *first }))
        return false;
    *first = (uint32_t)s->list.len;
    return true;
}

/* ---- the placing of one ---- */

typedef struct inference {
    noc_scene *scene;
    const city_lamp_params *params;
    geo_issues *issues;
    spots *spots;
    int lights, lamps;
    size_t looked, most_looks; /* looked: by vertical rays before the first lamp */
    size_t triangles;          /* before the first lamp */
    uint8_t *inner;            /* inner_edges of each, found in the first round */
    const noc_progress *progress;
    double done; /* 0..1 */
    unsigned asked;
    bool cancelled;
} inference;

/* By rays and at lamps, so far. */
static size_t looks(const inference *in) { return noc_ground_looked(in->scene) - in->looked + in->spots->looks; }

/* Asks now and then whether to go on. */
static bool go_on(inference *in) {
    if (in->asked++ % 256 == 0 && in->progress && in->progress->update &&
        !in->progress->update(in->progress->user, "lamps", in->done))
        in->cancelled = true;
    return !in->cancelled && !in->scene->no_memory && looks(in) <= in->most_looks;
}

/* A lamp at (x, y), facing (dx, dy), unless the place will not do. */
static void propose(inference *in, double x, double y, double dx, double dy, double near_z) {
    const double facing[2] = { dx, dy };
    if (in->lamps >= MAX_LAMPS || !go_on(in) || !keeps_distance(in->spots, x, y, facing))
        return;
    double z;
    if (!noc_scene_ground(in->scene, x, y, &z))
        z = near_z;
    if (fabs(z - near_z) > 4 || site_covered(in->scene, x, y, z))
        return;
    char id[32];
    snprintf(id, sizeof(id), "inferred-%d", in->lamps + 1);
    geo_lamp lamp = { .xyz = { x, y, z },
                      .height = NAN,
                      .direction = atan2(dx, dy) * 180 / M_PI,
                      .lumens = NAN,
                      .watts = NAN,
                      .kelvin = NAN,
                      .rgb = { -1, -1, -1 },
                      .id = id };
    geo_fitting fitting = geo_no_fitting();
    if (in->params->dress) {
        in->params->dress(in->params->dresser, &lamp, &fitting);
        lamp.fitting = &fitting;
    }
    int lights = city_add_lamp(in->scene, &lamp, in->params, true, in->issues);
    if (!lights)
        return;
    if (!take(in->spots, x, y, facing))
        noc_scene_out_of_memory(in->scene);
    in->lights += lights;
    in->lamps++;
}

static const float *corner(const noc_scene *scene, size_t t, int i) {
    return scene->positions.data + 3 * (size_t)scene->indices.data[3 * t + i];
}

static noc_class class_of(const noc_scene *scene, size_t t) {
    return scene->materials.data[scene->triangle_material.data[t]].cls;
}

/* Candidates along an edge, `off` metres to its right; facing back over it (or, with `outward`, on to the right). */
static void along_edge(inference *in, const float *a, const float *b, double off, bool outward) {
    /* copied: adding lamps moves the scene's arrays */
    double p[3] = { a[0], a[1], a[2] }, d[3] = { (double)b[0] - a[0], (double)b[1] - a[1], (double)b[2] - a[2] };
    double length = hypot(d[0], d[1]);
    if (length < .5)
        return;
    double right[2] = { d[1] / length, -d[0] / length };
    int steps = (int)NOC_CLAMP(length / 4, 1, 1e5);
    for (int i = 0; i < steps && !in->cancelled && !in->scene->no_memory; i++) {
        double t = (i + .5) / steps, sign = outward ? 1 : -1;
        propose(in, p[0] + t * d[0] + off * right[0], p[1] + t * d[1] + off * right[1], sign * right[0],
                sign * right[1], p[2] + t * d[2]);
    }
}

/* Is the spot a little to the right of the middle of an edge on a road? */
static bool road_beside(inference *in, const float *a, const float *b, double off) {
    double d[2] = { (double)b[0] - a[0], (double)b[1] - a[1] }, length = hypot(d[0], d[1]), z;
    double x = (a[0] + (double)b[0]) / 2 + off * d[1] / length, y = (a[1] + (double)b[1]) / 2 - off * d[0] / length;
    return noc_scene_highest(in->scene, 1u << NOC_CLASS_ROAD, x, y, &z) && fabs(z - (a[2] + (double)b[2]) / 2) < 2;
}

/* An edge of a triangle of road, so that what is right of it is outside: counter-clockwise, seen from above. */
static void edge_of(const noc_scene *scene, size_t t, int edge, const float **a, const float **b) {
    const float *v[3] = { corner(scene, t, 0), corner(scene, t, 1), corner(scene, t, 2) };
    double area = ((double)v[1][0] - v[0][0]) * ((double)v[2][1] - v[0][1]) -
                  ((double)v[1][1] - v[0][1]) * ((double)v[2][0] - v[0][0]);
    *a = v[area > 0 ? edge : (edge + 1) % 3];
    *b = area == 0 ? *a : v[area > 0 ? (edge + 1) % 3 : edge];
}

/* Bits of the edges of a triangle of road that are too short or have road on their other side. */
static unsigned inner_edges(inference *in, size_t t) {
    unsigned bits = 0;
    for (int i = 0; i < 3; i++) {
        const float *a, *b;
        edge_of(in->scene, t, i, &a, &b);
        double dx = (double)b[0] - a[0], dy = (double)b[1] - a[1];
        if (!(dx * dx + dy * dy >= .25) || road_beside(in, a, b, .3))
            bits |= 1u << i;
    }
    return bits;
}

/* The outer edges of roads: those with no road on their other side. */
static void along_roads(inference *in, int round) {
    for (size_t t = 0; t < in->triangles && go_on(in); t++) {
        in->done = (round + (double)t / (double)in->triangles) / 2;
        if (class_of(in->scene, t) != NOC_CLASS_ROAD)
            continue;
        if (round == 0)
            in->inner[t] = (uint8_t)inner_edges(in, t);
        for (int i = 0; i < 3; i++) {
            const float *a, *b;
            edge_of(in->scene, t, i, &a, &b); /* arrays may have moved meanwhile */
            if (!(in->inner[t] >> i & 1))
                along_edge(in, a, b, KERB_DISTANCE, false);
        }
    }
}

/* In front of walls, seen from above: the lower edge of each wall triangle that begins near the ground. */
static void around_buildings(inference *in) {
    for (size_t t = 0; t < in->triangles && go_on(in); t++) {
        in->done = (double)t / (double)in->triangles;
        if (class_of(in->scene, t) != NOC_CLASS_WALL)
            continue;
        int low = 0;
        for (int i = 1; i < 3; i++) /* the edge whose opposite corner is highest */
            if (corner(in->scene, t, i)[2] > corner(in->scene, t, low)[2])
                low = i;
        const float *a = corner(in->scene, t, (low + 1) % 3), *b = corner(in->scene, t, (low + 2) % 3);
        double x = (a[0] + (double)b[0]) / 2, y = (a[1] + (double)b[1]) / 2, z;
        if (fabs((double)a[2] - b[2]) > 1 || (site_ground(in->scene, x, y, &z) && NOC_MIN(a[2], b[2]) > z + 1))
            continue;
        /* a wall seen from outside runs counter-clockwise, so the street is on the right of its lower edge; where the
         * wall is given inside out, the left side is tried */
        double d[2] = { (double)b[0] - a[0], (double)b[1] - a[1] }, l = hypot(d[0], d[1]);
        if (l < .5)
            continue;
        bool inside_out = site_covered(in->scene, x + d[1] / l, y - d[0] / l, NOC_MIN(a[2], b[2]));
        along_edge(in, inside_out ? b : a, inside_out ? a : b, WALL_DISTANCE, true);
    }
}

noc_status city_infer_lamps(noc_scene *scene, const city_lamp_params *params, const noc_progress *progress,
                            geo_issues *issues, int *lights) {
    inference in = { .scene = scene,
                     .params = params,
                     .issues = issues,
                     .progress = progress,
                     .spots = noc_calloc(1, sizeof(spots)),
                     .looked = noc_ground_looked(scene),
                     .triangles = scene->triangle_light.len };
    noc_scene_info info;
    *lights = 0;
    in.most_looks = noc_ground_most_looks + LOOKS_A_TRIANGLE * in.triangles;
    in.inner = noc_alloc(NOC_MAX(in.triangles, 1u));
    if (!in.spots || !in.inner) {
        free(in.spots);
        free(in.inner);
        return noc_scene_out_of_memory(scene);
    }
    noc_scene_get_info(scene, &info);
    bool roads = info.triangles_by_class[NOC_CLASS_ROAD] > 0;
    in.spots->spacing = roads ? ROAD_SPACING : WALL_SPACING;
    in.spots->cell = 2 * in.spots->spacing;
    for (int round = 0; roads && round < 2; round++) {
        in.spots->alternate = round == 0;
        along_roads(&in, round);
    }
    if (!roads)
        around_buildings(&in);
    if (looks(&in) > in.most_looks)
        noc_warn(
            scene->log,
            "lamps by a rule end after %d: so many edges of roads or walls lie over one another that finding where "
            "the others stand would take too long",
            in.lamps);
    array_free(&in.spots->list);
    free(in.spots);
    free(in.inner);
    *lights = in.lights;
    return scene->no_memory ? NOC_ERR_MEMORY : in.cancelled ? NOC_ERR_CANCELLED : NOC_OK;
}
