/* Lamps along the roads of maps that are lit and have none.
 *
 * Arrangements are those of road lighting (W. van Bommel, Road Lighting, Springer 2015, section 13.1; EN 13201 asks for
 * what they give, and not for them): on one side where the carriageway is no wider than the lamps are high, by turns on
 * both up to one and a half times that, opposite each other beyond; 3 to 4 times their height apart. Heights by class
 * are usual ones (Thorn Lighting Handbook, roads: 10 m and more on main roads, 8 to 10 m on roads around and into
 * towns; 4 to 6 m where people walk), as shares of the height that lamps have for want of a better one. Flux is such
 * that with the defaults a straight carriageway of the class gets about the mean illuminance of the class of EN 13201-2
 * that is usual there (tests/import/test_road_lux.c has them).
 *
 * A way is divided evenly, so its lamps hang on nothing but itself: its id, its line and what is beside it. Lamps of
 * two ways that come too near are told apart by class, then by a hash of the way's id. So no order of files or ways
 * changes a lamp. */
#include "city/lamp.h"
#include "city/roads.h"

#include <math.h>

#define SPACING 4.0     /* heights between lamps */
#define KERB 0.6        /* m behind the carriageway's edge */
#define CLEAR 0.4       /* m that a lamp stands off other carriageways */
#define RAIL_CLEAR 2.5  /* m off the middle of a track: half of the structure gauge of EN 15273 */
#define PATH_BESIDE 8.0 /* m from a lit road's edge in which its lamps light a path */
#define OWN_WAY 0.5     /* of its spacing in which a lamp bears none of another way */
#define OWN_OTHER 0.25  /* the same of one that faces it, across the two carriageways */
#define OWN_STREET 2.0  /* spacings off mapped lamps of its street: what is lit more sparsely is not lit there */
#define MOST_LAMPS 200000
#define MOST_NEAR 4096      /* mapped lamps in a square of the spacing: there is no room for more */
#define LONGEST 200e3       /* m of a way that gets lamps */
#define MANY_PIECES 1000    /* of roads near a place: no street map has more */
#define MOST_LOOKS 50000000 /* at pieces beyond those: a second or two */

enum {
    MOTOR_LIT = 1u << GEO_ROAD_PRIMARY | 1u << GEO_ROAD_SECONDARY | 1u << GEO_ROAD_TERTIARY | 1u << GEO_ROAD_MINOR |
                1u << GEO_ROAD_LIVING | 1u << GEO_ROAD_PEDESTRIAN
};

/* Of the height and the flux that lamps have for want of better ones. */
static const struct {
    double height, flux;
} rule[GEO_ROAD_CLASSES] = {
    [GEO_ROAD_MOTORWAY] = { 2, 5.4 },       [GEO_ROAD_TRUNK] = { 5 / 3., 4 },
    [GEO_ROAD_PRIMARY] = { 5 / 3., 2.7 },   [GEO_ROAD_SECONDARY] = { 5 / 3., 2.7 },
    [GEO_ROAD_TERTIARY] = { 4 / 3., 1.17 }, [GEO_ROAD_MINOR] = { 1, .33 },
    [GEO_ROAD_LIVING] = { 3 / 4., .5 },     [GEO_ROAD_SERVICE] = { 1, .33 },
    [GEO_ROAD_PEDESTRIAN] = { 3 / 4., .5 }, [GEO_ROAD_PATH] = { 3 / 4., .5 },
    [GEO_ROAD_TRACK] = { 1, .33 },          [GEO_ROAD_RAIL] = { 0, 0 },
};

/* Ways in an order that is their own: the lamps that are one too many are the same in whatever order ways come. */
typedef struct way_order {
    uint64_t hash;
    const geo_road *road;
} way_order;

typedef struct placing {
    const city_roads *roads;
    const city_road_params *params;
    noc_scene *scene;
    geo_cells mapped;
    double reach; /* m: the largest spacing */
    bool by_class, no_memory, cancelled, too_many;
    NOC_ARRAY(double) sums; /* of the present way: its length up to each point */
    NOC_ARRAY(city_road_lamp) found;
    NOC_ARRAY(way_order) ways; /* that are lit */
    road_streets streets;
    uint32_t *mapped_of;       /* of each mapped lamp its street */
    size_t without;            /* of these, ways that are left without lamps */
    size_t looks;              /* at pieces where there are too many */
    const road_piece *blocker; /* what was in the way of the last place */
} placing;

static uint64_t mix(uint64_t h) {
    h = (h ^ h >> 33) * 0xff51afd7ed558ccdu;
    h = (h ^ h >> 33) * 0xc4ceb9fe1a85ec53u;
    return h ^ h >> 33;
}

static uint64_t hash_of(const char *text) { return mix(noc_hash_text(text)); }

static bool is_lit(const placing *p, const geo_road *road) {
    if (road->cls == GEO_ROAD_RAIL || road->tunnel)
        return false;
    return p->by_class ? MOTOR_LIT >> road->cls & 1 && !road->link : road->lit == GEO_LIT_YES;
}

static double height_of(const placing *p, const geo_road *road) { return rule[road->cls].height * p->params->height; }

static double spacing_of(const placing *p, const geo_road *road) { return SPACING * height_of(p, road); }

/* ---- whether a lamp may stand somewhere ---- */

/* At another height than the road, whatever lies there. */
static bool elsewhere(const geo_road *road, const geo_road *other) {
    return other->tunnel || other->layer != road->layer ||
           (other->bridge != road->bridge && other->cls == GEO_ROAD_RAIL);
}

/* Is a place on the carriageway of a piece, on its railway, or on a path that its lamps light? */
static bool is_taken_by(const placing *p, const geo_road *road, const road_piece *piece, const double xy[2]) {
    bool path = road->cls == GEO_ROAD_PATH;
    const geo_road *other = &p->roads->roads[piece->road];
    if (elsewhere(road, other) && other != road)
        return false;
    double d = road_distance(piece, xy, NULL), half = geo_road_width(other) / 2;
    if (other->cls == GEO_ROAD_RAIL ? d < RAIL_CLEAR : d < half + CLEAR && (path || other->cls != GEO_ROAD_PATH))
        return true;
    return path && other->cls != GEO_ROAD_PATH && is_lit(p, other) && d < half + PATH_BESIDE;
}

/* Off other carriageways, so off the middle of junctions, and off railways. What was in the way last is asked first. */
static bool clear_of_roads(placing *p, const geo_road *road, const double xy[2]) {
    size_t seen = 0;
    bool taken = p->blocker && is_taken_by(p, road, p->blocker, xy);
    for (road_walk w = road_walk_start(p->roads, xy); !taken && road_walk_next(&w); seen++)
        if (is_taken_by(p, road, w.piece, xy)) {
            p->blocker = w.piece;
            taken = true;
        }
    p->looks += seen > MANY_PIECES ? seen - MANY_PIECES : 0;
    return !taken;
}

static bool on_water(const placing *p, const double xy[2]) {
    double water, ground;
    const noc_scene *scene = p->scene, *more = p->params->water;
    if (more && noc_scene_highest(more, 1u << NOC_CLASS_WATER, xy[0], xy[1], &water))
        return true;
    const uint32_t firm = 1u << NOC_CLASS_TERRAIN | 1u << NOC_CLASS_ROAD | 1u << NOC_CLASS_SIDEWALK |
                          1u << NOC_CLASS_GREEN | 1u << NOC_CLASS_BRIDGE;
    return noc_scene_highest(scene, 1u << NOC_CLASS_WATER, xy[0], xy[1], &water) &&
           !(noc_scene_highest(scene, firm, xy[0], xy[1], &ground) && ground > water);
}

/* Two spacings from mapped lamps of its own street, and one from others. */
static bool is_mapped(const placing *p, const geo_road *road, const double xy[2]) {
    uint32_t street = p->streets.of[road - p->roads->roads];
    double spacing = spacing_of(p, road);
    for (int c = 0; c < 9; c++) {
        size_t seen = 0;
        for (uint32_t k = *geo_cells_at(&p->mapped, xy, c); k; k = p->mapped.next[k - 1]) {
            const double *at = p->params->mapped + 2 * (size_t)(k - 1);
            double within = spacing * (p->mapped_of[k - 1] == street ? OWN_STREET : 1);
            if (hypot(at[0] - xy[0], at[1] - xy[1]) < within || seen++ == MOST_NEAR)
                return true;
        }
    }
    return false;
}

static bool may_stand(placing *p, const geo_road *road, const double xy[2]) {
    double z;
    if (!(fabs(xy[0]) < ROADS_FARTHEST && fabs(xy[1]) < ROADS_FARTHEST))
        return false;
    if (is_mapped(p, road, xy) || (p->params->inside && !p->params->inside(p->params->user, xy)) ||
        !clear_of_roads(p, road, xy) || (!road->bridge && on_water(p, xy)))
        return false;
    return !site_covered(p->scene, xy[0], xy[1], noc_scene_ground(p->scene, xy[0], xy[1], &z) ? z : -INFINITY);
}

/* ---- along one way ---- */

static bool measure(placing *p, const geo_road *road) {
    double sum = 0;
    p->sums.len = 0;
    for (size_t i = 0; i < road->point_count; i++) {
        const double *a = road->xyz + 3 * i;
        sum += i ? hypot(a[0] - a[-3], a[1] - a[-2]) : 0;
        if (!array_push(&p->sums, sum))
            return false;
    }
    return true;
}

/* The place on the way so far along it, and where it goes there. */
static void point_at(const placing *p, const geo_road *road, double along, double at[2], double way[2]) {
    size_t low = 0, high = road->point_count - 1;
    while (high - low > 1) {
        size_t middle = (low + high) / 2;
        *(p->sums.data[middle] <= along ? &low : &high) = middle;
    }
    const double *a = road->xyz + 3 * low, *b = a + 3;
    double length = p->sums.data[high] - p->sums.data[low], t = length > 0 ? (along - p->sums.data[low]) / length : 0;
    for (int k = 0; k < 2; k++) {
        at[k] = a[k] + NOC_CLAMP(t, 0, 1) * (b[k] - a[k]);
        way[k] = length > 0 ? (b[k] - a[k]) / length : k == 0;
    }
}

/* side: 1 right of the line as it is drawn, -1 left. */
static bool propose(placing *p, const geo_road *road, double along, int side, uint64_t rank, uint32_t number) {
    double at[2], way[2];
    point_at(p, road, along, at, way);
    double off = side * (geo_road_width(road) / 2 + KERB);
    city_road_lamp lamp = {
        .road = road, .number = number, .rank = rank, .height = height_of(p, road), .flux = rule[road->cls].flux
    };
    lamp.xy[0] = at[0] + off * way[1];
    lamp.xy[1] = at[1] - off * way[0];
    lamp.facing[0] = -side * way[1];
    lamp.facing[1] = side * way[0];
    if (!may_stand(p, road, lamp.xy))
        return false;
    p->no_memory = p->no_memory || !array_push(&p->found, lamp);
    return true;
}

/* A lamp in the middle of its share of the way, else a little before or behind, else, where it may, across it. */
static void put(placing *p, const geo_road *road, double along, double share, int side, bool either, uint64_t rank,
                uint32_t number) {
    static const double moves[] = { 0, -.15, .15, -.3, .3 };
    for (int across = 0; across <= either; across++)
        for (size_t i = 0; i < NOC_COUNT(moves); i++)
            if (propose(p, road, along + moves[i] * share, across ? -side : side, rank, number))
                return;
}

/* The side of the street on which lamps stand: of one way the outer one, else any, but the same along the street,
 * however its ways are drawn. */
static int side_of(const geo_road *road) {
    if (road->oneway)
        return road->oneway;
    const double *a = road->xyz, *b = road->xyz + 3 * (road->point_count - 1);
    double east = b[0] - a[0], north = b[1] - a[1];
    bool turned = fabs(east) > fabs(north) ? east < 0 : north < 0;
    bool right = hash_of(*road->name ? road->name : road->id) & 1;
    return right != turned ? 1 : -1;
}

static void along_way(placing *p, const geo_road *road) {
    if (!measure(p, road)) {
        p->no_memory = true;
        return;
    }
    double length = p->sums.data[p->sums.len - 1], height = height_of(p, road), width = geo_road_width(road);
    double spacing = spacing_of(p, road);
    if (!(length > 0) || length > LONGEST)
        return;
    uint64_t hash = hash_of(road->id);
    /* one that is shorter than the spacing has its share of a lamp */
    double share = length / spacing, chance = (double)(hash >> 11) / 9007199254740992.0;
    uint32_t count = (uint32_t)(share >= 1 ? floor(share + .5) : chance < share);
    bool opposite = width > 1.5 * height, turns = !opposite && width > height;
    int side = side_of(road);
    for (uint32_t i = 0; i < count; i++) {
        p->too_many = p->too_many || p->found.len >= MOST_LAMPS || p->looks > MOST_LOOKS;
        if (p->too_many)
            return;
        double along = (i + .5) * length / count;
        uint64_t rank = (uint64_t)road->cls << 56 | mix(hash + i) >> 8;
        int here = turns && i % 2 ? -side : side;
        put(p, road, along, length / count, here, !opposite, rank, opposite ? 2 * i : i);
        if (opposite)
            put(p, road, along, length / count, -here, false, rank, 2 * i + 1);
    }
}

/* ---- all of them ---- */

/* Pieces of one way have its id: then by where they are. */
static int by_hash(const void *a, const void *b) {
    const way_order *x = a, *y = b;
    if (x->hash != y->hash)
        return x->hash < y->hash ? -1 : 1;
    const double *p = x->road->xyz, *q = y->road->xyz;
    if (p[0] != q[0])
        return p[0] < q[0] ? -1 : 1;
    return (p[1] > q[1]) - (p[1] < q[1]);
}

/* Lit ways, and the streets of mapped lamps. */
static void find_ways(placing *p) {
    size_t count = p->roads->count, mapped = p->params->mapped_count;
    bool *lit = noc_alloc((count + 1) * sizeof(*lit));
    p->mapped_of = noc_alloc((mapped + 1) * sizeof(*p->mapped_of));
    p->no_memory = p->no_memory || !lit || !p->mapped_of || !road_streets_create(p->roads, &p->streets);
    for (size_t i = 0; i < count && !p->no_memory; i++) {
        const geo_road *road = &p->roads->roads[i];
        lit[i] = is_lit(p, road);
        if (lit[i])
            p->no_memory = !array_push(&p->ways, (way_order){ hash_of(road->id), road });
    }
    for (size_t i = 0; i < mapped && !p->no_memory; i++)
        p->mapped_of[i] = road_streets_beside(p->roads, &p->streets, lit, p->params->mapped + 2 * i);
    free(lit);
}

static void along_all(placing *p) {
    const noc_progress *progress = p->params->progress;
    if (p->ways.len > 1)
        qsort(p->ways.data, p->ways.len, sizeof(*p->ways.data), by_hash);
    for (size_t i = 0; i < p->ways.len && !p->no_memory && !p->cancelled; i++) {
        along_way(p, p->ways.data[i].road);
        p->without += p->too_many;
        p->cancelled = i % 256 == 0 && progress && progress->update &&
                       !progress->update(progress->user, "lamps", (double)i / (double)p->ways.len);
    }
}

static bool too_near(const placing *p, const city_road_lamp *a, const city_road_lamp *b) {
    if (a->road == b->road)
        return false;
    double across = a->facing[0] * b->facing[0] + a->facing[1] * b->facing[1] < -.5 ? OWN_OTHER : OWN_WAY;
    double spacing = NOC_MIN(spacing_of(p, a->road), spacing_of(p, b->road));
    return hypot(a->xy[0] - b->xy[0], a->xy[1] - b->xy[1]) < across * spacing;
}

/* Ways of one rank and number are one way, given twice. */
static int by_rank(const void *a, const void *b) {
    const city_road_lamp *x = a, *y = b;
    if (x->rank != y->rank)
        return x->rank < y->rank ? -1 : 1;
    if (x->number != y->number)
        return x->number < y->number ? -1 : 1;
    return (x->xy[0] > y->xy[0]) - (x->xy[0] < y->xy[0]);
}

/* Keeps those that no better one is too near to. */
static void thin_out(placing *p) {
    geo_cells cells;
    size_t kept = 0;
    if (p->found.len > 1)
        qsort(p->found.data, p->found.len, sizeof(*p->found.data), by_rank);
    if (!geo_cells_create(&cells, p->found.len + 1, p->reach)) {
        p->no_memory = true;
        return;
    }
    for (size_t i = 0; i < p->found.len; i++) {
        const city_road_lamp lamp = p->found.data[i];
        bool alone = true;
        for (int c = 0; c < 9 && alone; c++)
            for (uint32_t k = *geo_cells_at(&cells, lamp.xy, c); k && alone; k = cells.next[k - 1])
                alone = !too_near(p, &lamp, &p->found.data[k - 1]);
        if (!alone)
            continue;
        p->found.data[kept] = lamp;
        geo_cells_add(&cells, lamp.xy, kept++);
    }
    p->found.len = kept;
    geo_cells_free(&cells);
}

/* Does the map tell of no road whether it is lit? */
static bool tells_nothing(const city_roads *roads) {
    for (size_t i = 0; i < roads->count; i++)
        if (roads->roads[i].lit != GEO_LIT_UNKNOWN)
            return false;
    return true;
}

noc_status city_road_lamps(noc_scene *scene, const city_roads *roads, const city_road_params *params,
                           city_road_lamp **lamps, size_t *count, size_t *streets) {
    placing p = { .roads = roads, .params = params, .scene = scene, .reach = SPACING * 2 * params->height };
    p.by_class = !params->mapped_count && tells_nothing(roads);
    *lamps = NULL;
    *count = 0;
    p.no_memory = !geo_cells_create(&p.mapped, params->mapped_count + 1, OWN_STREET * p.reach);
    for (size_t i = 0; i < params->mapped_count && !p.no_memory; i++)
        geo_cells_add(&p.mapped, params->mapped + 2 * i, i);
    find_ways(&p);
    along_all(&p);
    geo_cells_free(&p.mapped);
    array_free(&p.ways);
    array_free(&p.sums);
    if (!p.no_memory && !p.cancelled)
        thin_out(&p);
    *streets = p.no_memory || p.cancelled ? 0 : road_streets_count(roads, &p.streets, p.found.data, p.found.len);
    road_streets_free(&p.streets);
    free(p.mapped_of);
    if (p.looks > MOST_LOOKS && !p.no_memory && !p.cancelled)
        noc_warn(scene->log,
                 "%zu lit roads of maps have no lamps, or not all: too many roads lie over one another there. --bbox "
                 "takes less of the maps",
                 p.without);
    else if (p.too_many && !p.no_memory && !p.cancelled)
        noc_warn(scene->log,
                 "%zu lit roads of maps have no lamps, or not all: %d are the most. --bbox takes less of the "
                 "maps",
                 p.without, MOST_LAMPS);
    if (!p.no_memory && !p.cancelled) {
        *lamps = p.found.data;
        *count = p.found.len;
        return NOC_OK;
    }
    array_free(&p.found);
    return p.no_memory ? noc_scene_out_of_memory(scene) : NOC_ERR_CANCELLED;
}
