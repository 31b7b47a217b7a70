/* Decks of the bridges of maps. A bridge is often cut into several ways (where a lane begins, or its name changes), and
 * forks: their common points are joints in the air. Where a way ends alone, or beside a road that is no bridge, the
 * deck lies on the ground. Between those it runs as a taut string does: the height of a joint is the mean of its
 * neighbours', each weighted by 1 / length, so that a bridge in pieces is as straight as one that is not cut. */
#include "city/city.h"
#include "scene/scene.h"

#include <math.h>

#define SAME 0.1 /* m between points of two ways that are one */
#define CELL 0.5 /* m */
#define SHORTEST 1e-3
enum { MOST_STEPS = 4000 }; /* of the solver, which needs as many as there are joints at most */

typedef struct joint {
    double xy[2], z;
    uint32_t way;    /* the last one that has it, + 1 */
    uint32_t ways;   /* that have it */
    uint32_t pieces; /* that end here */
    uint32_t root;   /* of its bridge */
    int layer;
    bool end, road;       /* a way ends here; so does a road that is no bridge, or it passes */
    bool driven;          /* it is of a bridge that is no path */
    bool fixed, anchored; /* z is the ground's; of a root: a joint of the bridge is fixed */
} joint;

/* A stretch of a way between two joints. */
typedef struct piece {
    uint32_t a, b;
    double weight; /* 1 / m */
} piece;

typedef struct decks {
    const noc_scene *scene;
    geo_road *roads;
    size_t count;
    NOC_ARRAY(joint) joints;
    NOC_ARRAY(uint32_t) joint_of; /* of the points of all bridges, one way after the other */
    NOC_ARRAY(piece) pieces;
    geo_cells cells;
} decks;

static joint *find(const decks *d, const double *xy, bool end, int layer) {
    for (int c = 0; c < 9; c++)
        for (uint32_t k = *geo_cells_at(&d->cells, xy, c); k; k = d->cells.next[k - 1]) {
            joint *j = &d->joints.data[k - 1];
            bool may = end || j->end || j->layer == layer; /* else one passes over the other */
            if (may && hypot(j->xy[0] - xy[0], j->xy[1] - xy[1]) <= SAME)
                return j;
        }
    return NULL;
}

static bool is_bridge(const geo_road *road) { return road->bridge && !road->tunnel && road->point_count >= 2; }

static bool add_way(decks *d, size_t way) {
    const geo_road *road = &d->roads[way];
    for (size_t i = 0; i < road->point_count; i++) {
        const double *xy = road->xyz + 3 * i;
        bool end = i == 0 || i + 1 == road->point_count;
        joint *j = find(d, xy, end, road->layer);
        if (!j) {
            const joint fresh = { .xy = { xy[0], xy[1] }, .z = NAN, .layer = road->layer };
            if (!array_push(&d->joints, fresh))
                return false;
            geo_cells_add(&d->cells, xy, d->joints.len - 1);
            j = &d->joints.data[d->joints.len - 1];
        }
        j->ways += j->way != way + 1;
        j->way = (uint32_t)way + 1;
        j->end = j->end || end;
        j->driven = j->driven || road->cls != GEO_ROAD_PATH;
        if (!array_push(&d->joint_of, (uint32_t)(j - d->joints.data)))
            return false;
    }
    return true;
}

/* Returns true if the road lies on the ground where it meets a bridge: stairs climb, and paths join decks from aside.
 */
static bool is_grounded(const geo_road *road) {
    const geo_highway *word = geo_highway_get(road->highway);
    return !road->bridge && !road->tunnel && road->cls != GEO_ROAD_RAIL && !(word && !strcmp(word->word, "steps"));
}

/* Roads that are no bridges hold the ends that they share. */
static void add_roads(decks *d) {
    for (size_t r = 0; r < d->count; r++) {
        const geo_road *road = &d->roads[r];
        for (size_t i = 0; i < road->point_count && is_grounded(road); i++) {
            joint *j = find(d, road->xyz + 3 * i, true, 0);
            if (j && j->end && (road->cls != GEO_ROAD_PATH || !j->driven))
                j->road = true;
        }
    }
}

static bool is_joint(const joint *j) { return j->end || j->ways > 1; }

static uint32_t root_of(decks *d, uint32_t j) {
    joint *all = d->joints.data;
    while (all[j].root != j)
        j = all[j].root = all[all[j].root].root;
    return j;
}

static bool add_pieces(decks *d) {
    const uint32_t *of = d->joint_of.data;
    for (uint32_t j = 0; j < d->joints.len; j++)
        d->joints.data[j].root = j;
    for (size_t r = 0; r < d->count; r++) {
        const geo_road *road = &d->roads[r];
        if (!is_bridge(road))
            continue;
        double length = 0;
        uint32_t from = of[0];
        for (size_t i = 1; i < road->point_count; i++) {
            const double *a = road->xyz + 3 * (i - 1);
            length += hypot(a[3] - a[0], a[4] - a[1]);
            if (!is_joint(&d->joints.data[of[i]]))
                continue;
            const piece p = { from, of[i], 1 / NOC_MAX(length, SHORTEST) };
            if (p.a != p.b && !array_push(&d->pieces, p))
                return false;
            d->joints.data[p.a].pieces += p.a != p.b;
            d->joints.data[p.b].pieces += p.a != p.b;
            d->joints.data[root_of(d, p.a)].root = root_of(d, p.b);
            from = of[i];
            length = 0;
        }
        of += road->point_count;
    }
    return true;
}

/* Joints of a bridge that is nowhere on the ground take the ground below. */
static void fix_joints(decks *d) {
    for (int pass = 0; pass < 2; pass++)
        for (uint32_t i = 0; i < d->joints.len; i++) {
            joint *j = &d->joints.data[i], *root = &d->joints.data[root_of(d, i)];
            bool lies = pass ? !root->anchored : j->pieces < 2 || j->road;
            if (!is_joint(j) || j->fixed || !lies || !noc_scene_ground(d->scene, j->xy[0], j->xy[1], &j->z))
                continue;
            j->fixed = true;
            root->anchored = root->anchored || !pass;
        }
}

/* ---- the heights of joints ---- */

/* to = A x of the free joints, A being the Laplacian of the pieces. */
static void multiply(const decks *d, const double *x, double *to) {
    memset(to, 0, d->joints.len * sizeof(*to));
    for (size_t i = 0; i < d->pieces.len; i++) {
        const piece *p = &d->pieces.data[i];
        double flow = p->weight * (x[p->a] - x[p->b]);
        to[p->a] += flow;
        to[p->b] -= flow;
    }
    for (size_t i = 0; i < d->joints.len; i++)
        to[i] = d->joints.data[i].fixed ? 0 : to[i];
}

static double dot(const double *a, const double *b, size_t n) {
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += a[i] * b[i];
    return sum;
}

/* By conjugate gradients (Hestenes and Stiefel 1952), from the mean of the fixed joints on. */
static bool solve(decks *d) {
    size_t n = d->joints.len, fixed = 0;
    double *x = noc_calloc(4 * n + 1, sizeof(*x)), *r = x ? x + n : NULL, *p = x ? r + n : NULL, *q = x ? p + n : NULL;
    double mean = 0;
    if (!x)
        return false;
    for (size_t i = 0; i < n; i++)
        if (d->joints.data[i].fixed) {
            mean += (d->joints.data[i].z - mean) / (double)++fixed;
        }
    for (size_t i = 0; i < n; i++)
        x[i] = d->joints.data[i].fixed ? d->joints.data[i].z : mean;
    multiply(d, x, q);
    for (size_t i = 0; i < n; i++)
        p[i] = r[i] = -q[i];
    double left = dot(r, r, n), first = left;
    for (int step = 0; step < MOST_STEPS && left > 1e-20 * first && left > 0; step++) {
        multiply(d, p, q);
        double pq = dot(p, q, n), by = pq > 0 ? left / pq : 0, before = left;
        for (size_t i = 0; i < n; i++) {
            x[i] += by * p[i];
            r[i] -= by * q[i];
        }
        left = dot(r, r, n);
        for (size_t i = 0; i < n; i++)
            p[i] = r[i] + left / before * p[i];
    }
    for (uint32_t i = 0; i < n; i++) {
        joint *j = &d->joints.data[i];
        const joint *root = &d->joints.data[root_of(d, i)];
        j->z = j->fixed || !root->anchored ? j->z : x[i];
    }
    free(x);
    return true;
}

/* ---- the heights of points ---- */

static void fill_deck(const decks *d, const geo_road *road, const uint32_t *of, double *deck) {
    size_t from = 0;
    double length = 0;
    for (size_t i = 1; i < road->point_count; i++) {
        const double *a = road->xyz + 3 * (i - 1);
        length += hypot(a[3] - a[0], a[4] - a[1]);
        deck[i] = length; /* until the next joint is known */
        const joint *j = &d->joints.data[of[i]];
        if (!is_joint(j))
            continue;
        double z0 = d->joints.data[of[from]].z;
        deck[from] = z0;
        for (size_t k = from + 1; k <= i; k++)
            deck[k] = z0 + (j->z - z0) * (length > 0 ? deck[k] / length : 1);
        from = i;
        length = 0;
    }
}

static noc_status level(decks *d, noc_arena *arena) {
    size_t points = 0;
    for (size_t r = 0; r < d->count; r++)
        points += is_bridge(&d->roads[r]) ? d->roads[r].point_count : 0;
    if (!points)
        return NOC_OK;
    if (points >= UINT32_MAX || !geo_cells_create(&d->cells, points + 1, CELL))
        return NOC_ERR_MEMORY;
    for (size_t r = 0; r < d->count; r++)
        if (is_bridge(&d->roads[r]) && !add_way(d, r))
            return NOC_ERR_MEMORY;
    add_roads(d);
    if (!add_pieces(d))
        return NOC_ERR_MEMORY;
    fix_joints(d);
    if (!solve(d))
        return NOC_ERR_MEMORY;
    const uint32_t *of = d->joint_of.data;
    for (size_t r = 0; r < d->count; r++) {
        geo_road *road = &d->roads[r];
        if (!is_bridge(road))
            continue;
        double *deck = arena_alloc(arena, road->point_count * sizeof(*deck));
        if (!deck)
            return NOC_ERR_MEMORY;
        fill_deck(d, road, of, deck);
        road->deck = deck;
        of += road->point_count;
    }
    return NOC_OK;
}

noc_status city_level_decks(noc_scene *scene, geo_road *roads, size_t count, noc_arena *arena) {
    decks d = { .scene = scene, .roads = roads, .count = count };
    noc_status status = level(&d, arena);
    geo_cells_free(&d.cells);
    array_free(&d.joints);
    array_free(&d.joint_of);
    array_free(&d.pieces);
    return status ? noc_scene_out_of_memory(scene) : NOC_OK;
}
