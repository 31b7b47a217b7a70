/* Cars along the roads of a map.
 *
 * Each way is an edge in each direction that it is driven in. Where an edge ends, it goes on with the one that begins
 * there and turns least; a chain of such edges is driven from its first to its last, and then anew. A chain has as many
 * lanes as its narrowest part, each of which is a route of its own: the cars on it keep its times, so none overtakes
 * another. Chains cross as if they were alone. What is drawn hangs on a hash of the chain's first way, never on order.
 */
#include "city/traffic/traffic.h"
#include "city/windows/windows.h"

#include <math.h>
#include <stdlib.h>

#define NARROWEST 2.2 /* m of a lane */
#define TURN 70.0     /* degrees that a chain turns at a junction, at most */
#define MOST_MEET 64  /* edges that meet in a junction */
#define MOST_CARS 100000

/* Ours, for a city at night: speeds where no limit is told, and how far apart cars are, in those of a main road. */
static const struct {
    double speed; /* km/h */
    double apart;
    int lanes; /* of a carriageway of one way */
} usual[GEO_ROAD_CLASSES] = {
    [GEO_ROAD_MOTORWAY] = { 100, .8, 2 },  [GEO_ROAD_TRUNK] = { 80, .9, 2 },   [GEO_ROAD_PRIMARY] = { 50, 1, 1 },
    [GEO_ROAD_SECONDARY] = { 50, 1.4, 1 }, [GEO_ROAD_TERTIARY] = { 45, 2, 1 }, [GEO_ROAD_MINOR] = { 35, 5, 1 },
    [GEO_ROAD_LIVING] = { 10, 10, 1 },     [GEO_ROAD_SERVICE] = { 20, 12, 1 },
};

typedef struct edge {
    const geo_road *road;
    uint64_t hash;
    double at[2][2], way[2][2]; /* where it begins and ends, and the unit vectors that it goes along there */
    int lanes;
    bool back; /* against the line as it is drawn */
    bool used;
    uint32_t next, before; /* index + 1 */
} edge;

/* Where an edge begins or ends, to a centimetre. */
typedef struct meeting {
    int64_t x, y;
    uint32_t edge;
    bool ends;
} meeting;

typedef struct turn {
    double cost;
    uint32_t from, to;
} turn;

typedef struct chain_point {
    double xy[2];
    uint32_t edge; /* of the way to the next point */
    double offset; /* m to the right, of the lane at hand */
} chain_point;

typedef struct network {
    city_traffic *traffic;
    const noc_traffic_params *params;
    NOC_ARRAY(edge) edges;
    NOC_ARRAY(meeting) meetings;
    NOC_ARRAY(turn) turns;
    NOC_ARRAY(chain_point) points;
    route_maker route;
    size_t cars;
    size_t too_long; /* lanes without cars */
    size_t left_out; /* cars beyond MOST_CARS */
    bool refused;
} network;

/* ---- edges ---- */

static bool is_driven(const geo_road *r) {
    return r->motor && !r->tunnel && r->cls <= GEO_ROAD_SERVICE && r->point_count >= 2;
}

/* Lanes of a direction. */
static int lanes_of(const geo_road *r, bool back) {
    int told = back != (r->oneway < 0) ? r->lanes_backward : r->lanes_forward;
    if (r->oneway)
        return r->lanes > 0 ? r->lanes : usual[r->cls].lanes;
    return told > 0 ? told : NOC_MAX(r->lanes / 2, 1);
}

static const double *point_of(const edge *e, size_t i) {
    return e->road->xyz + 3 * (e->back ? e->road->point_count - 1 - i : i);
}

/* The unit vector along the first step of some length, from the beginning or to the end. false: there is none. */
static bool direction_of(const edge *e, bool end, double way[2]) {
    size_t n = e->road->point_count;
    const double *at = point_of(e, end ? n - 1 : 0);
    for (size_t i = 1; i < n; i++) {
        const double *p = point_of(e, end ? n - 1 - i : i);
        double d[2] = { p[0] - at[0], p[1] - at[1] }, length = hypot(d[0], d[1]);
        if (length < .5)
            continue;
        for (int k = 0; k < 2; k++)
            way[k] = (end ? -1 : 1) * d[k] / length;
        return true;
    }
    return false;
}

static void add_edge(network *n, const geo_road *road, bool back) {
    edge e = { .road = road,
               .hash = city_window_hash(traffic_hash(road->id, n->params->seed), back),
               .lanes = lanes_of(road, back),
               .back = back };
    for (int end = 0; end < 2; end++) {
        memcpy(e.at[end], point_of(&e, end ? road->point_count - 1 : 0), sizeof(e.at[end]));
        if (!direction_of(&e, end, e.way[end]))
            return;
    }
    n->refused = !array_push(&n->edges, e) || n->refused;
}

static int compare_edges(const void *a, const void *b) {
    const edge *x = a, *y = b;
    if (x->hash != y->hash)
        return x->hash < y->hash ? -1 : 1;
    for (int i = 0; i < 4; i++) /* pieces of one way */
        if (x->at[i / 2][i % 2] != y->at[i / 2][i % 2])
            return x->at[i / 2][i % 2] < y->at[i / 2][i % 2] ? -1 : 1;
    return 0;
}

/* ---- junctions ---- */

static int compare_meetings(const void *a, const void *b) {
    const meeting *p = a, *q = b;
    if (p->x != q->x)
        return p->x < q->x ? -1 : 1;
    if (p->y != q->y)
        return p->y < q->y ? -1 : 1;
    return p->edge != q->edge ? (p->edge < q->edge ? -1 : 1) : p->ends - q->ends;
}

static int compare_turns(const void *a, const void *b) {
    const turn *x = a, *y = b;
    if (x->cost != y->cost)
        return x->cost < y->cost ? -1 : 1;
    return x->from != y->from ? (x->from < y->from ? -1 : 1) : (x->to > y->to) - (x->to < y->to);
}

/* Degrees, with something for another class of road, and less for the same street. */
static double cost_of(const edge *from, const edge *to) {
    double c = from->way[1][0] * to->way[0][0] + from->way[1][1] * to->way[0][1];
    double angle = acos(NOC_CLAMP(c, -1, 1)) * 180 / M_PI;
    bool same_name = *from->road->name && !strcmp(from->road->name, to->road->name);
    if (angle > TURN || from->road == to->road)
        return INFINITY;
    return angle + 10 * abs((int)from->road->cls - (int)to->road->cls) - (same_name ? 20 : 0);
}

/* The edges that meet in a place: the least turns first, each edge once. */
static void join(network *n, const meeting *meet, size_t count) {
    n->turns.len = 0;
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < count && meet[i].ends; k++) {
            turn t = { meet[k].ends ? INFINITY : cost_of(&n->edges.data[meet[i].edge], &n->edges.data[meet[k].edge]),
                       meet[i].edge, meet[k].edge };
            if (isfinite(t.cost) && !array_push(&n->turns, t))
                n->refused = true;
        }
    if (n->turns.len > 1)
        qsort(n->turns.data, n->turns.len, sizeof(turn), compare_turns);
    for (size_t i = 0; i < n->turns.len; i++) {
        edge *from = &n->edges.data[n->turns.data[i].from], *to = &n->edges.data[n->turns.data[i].to];
        if (from->next || to->before)
            continue;
        from->next = n->turns.data[i].to + 1;
        to->before = n->turns.data[i].from + 1;
    }
}

static void join_all(network *n) {
    for (uint32_t i = 0; i < n->edges.len && !n->refused; i++)
        for (int end = 0; end < 2; end++) {
            const double *p = n->edges.data[i].at[end];
            meeting m = { llround(p[0] * 100), llround(p[1] * 100), i, end };
            n->refused = !array_push(&n->meetings, m) || n->refused;
        }
    if (n->refused || n->meetings.len < 2)
        return;
    qsort(n->meetings.data, n->meetings.len, sizeof(meeting), compare_meetings);
    for (size_t i = 0, end; i < n->meetings.len; i = end) {
        const meeting *m = n->meetings.data + i;
        for (end = i + 1; end < n->meetings.len && m->x == n->meetings.data[end].x && m->y == n->meetings.data[end].y;)
            end++;
        if (end - i <= MOST_MEET)
            join(n, m, end - i);
    }
}

/* ---- lanes ---- */

/* Of lane `lane` from the kerb, m to the right of the line as the edge goes. */
static double offset_of(const network *n, const edge *e, int lane) {
    const geo_road *r = e->road;
    double width = geo_road_width(r);
    int all = e->lanes + (r->oneway ? 0 : lanes_of(r, !e->back));
    double one = NOC_MAX(width / all, NARROWEST), right = NOC_MAX(width, one * all) / 2 - (lane + .5) * one;
    return n->params->side == NOC_DRIVE_LEFT ? -right : right;
}

/* The points of the chain that begins with that edge, and how many lanes it has. */
static int gather(network *n, uint32_t first) {
    int lanes = GEO_ROAD_MOST_LANES;
    n->points.len = 0;
    for (uint32_t i = first + 1; i && !n->edges.data[i - 1].used; i = n->edges.data[i - 1].next) {
        edge *e = &n->edges.data[i - 1];
        e->used = true;
        lanes = NOC_MIN(lanes, e->lanes);
        for (size_t k = n->points.len ? 1 : 0; k < e->road->point_count; k++) {
            const double *p = point_of(e, k);
            chain_point *last = n->points.len ? &n->points.data[n->points.len - 1] : NULL;
            if (last && hypot(p[0] - last->xy[0], p[1] - last->xy[1]) < .05)
                continue;
            if (last)
                last->edge = i - 1;
            if (!array_push(&n->points, (chain_point){ .xy = { p[0], p[1] }, .edge = i - 1 }))
                n->refused = true;
        }
    }
    return lanes;
}

/* The point of a lane: to the right of the corner, by both sides of it. */
static void lane_point(const network *n, size_t i, double offset, double out[2]) {
    const chain_point *p = n->points.data + i;
    double right[2] = { 0, 0 };
    for (int side = 0; side < 2; side++) {
        if (side ? i + 1 == n->points.len : !i)
            continue;
        const double *a = side ? p->xy : p[-1].xy, *b = side ? p[1].xy : p->xy;
        double length = hypot(b[0] - a[0], b[1] - a[1]);
        right[0] += (b[1] - a[1]) / length;
        right[1] -= (b[0] - a[0]) / length;
    }
    double length2 = right[0] * right[0] + right[1] * right[1];
    /* the mitre: two unit vectors of an angle t add up to 2 cos(t/2) */
    bool ends = !i || i + 1 == n->points.len;
    double scale = ends ? 1 : 2 / NOC_MAX(length2, 1);
    for (int k = 0; k < 2; k++)
        out[k] = p->xy[k] + offset * scale * right[k];
}

static double speed_of(const network *n, const geo_road *r) {
    double usually = n->params->speed > 0 ? n->params->speed : usual[r->cls].speed * (r->link ? .7 : 1);
    return (r->speed > 0 ? r->speed : usually) / 3.6;
}

/* The route of a lane. Returns how many cars are expected on it. */
static double trace(network *n, int lane) {
    double expected = 0, from[2] = { 0, 0 };
    size_t count = n->points.len;
    bool inside = false;
    route_clear(&n->route);
    for (size_t i = 0; i < count && !n->route.refused; i++) {
        const edge *e = &n->edges.data[n->points.data[i].edge];
        const edge *before = &n->edges.data[n->points.data[i ? i - 1 : 0].edge];
        double at[2], offset = (offset_of(n, e, lane) + offset_of(n, before, lane)) / 2;
        lane_point(n, i, offset, at);
        bool was = inside;
        inside = route_inside(&n->route, at);
        if (!inside)
            route_end_leg(&n->route);
        double length = was ? hypot(at[0] - from[0], at[1] - from[1]) : 0;
        n->route.bridge = before->road->bridge;
        if (inside)
            route_point(&n->route, at, length / speed_of(n, before->road));
        expected += inside ? length / (n->params->spacing * usual[before->road->cls].apart) : 0;
        memcpy(from, at, sizeof(from));
    }
    route_end_leg(&n->route);
    if (n->route.too_long) {
        route_clear(&n->route);
        n->too_long++;
    }
    return expected;
}

static noc_status fill_lane(network *n, uint64_t hash, double expected) {
    size_t cars = (size_t)NOC_MIN(expected + city_window_number(hash, 1), 1e9), room = MOST_CARS - n->cars;
    if (!n->route.stops.len || !cars)
        return NOC_OK;
    size_t some = NOC_MIN(cars, room);
    n->left_out += cars - some;
    if (!some)
        return NOC_OK;
    double period = n->route.stops.data[n->route.stops.len - 1].seconds;
    int route = noc_scene_add_route(traffic_scene(n->traffic), n->route.stops.data, n->route.stops.len);
    for (size_t i = 0; i < some && route >= 0; i++) {
        uint64_t car = city_window_hash(hash, 2 + i);
        double where = ((double)i + .5 + .7 * (city_window_number(car, 2) - .5)) / (double)cars;
        if (!traffic_add_car(n->traffic, route, car, where * period))
            return traffic_failed(n->traffic);
        n->cars++;
    }
    return route < 0 ? NOC_ERR_MEMORY : NOC_OK;
}

static noc_status drive_chain(network *n, uint32_t first) {
    int lanes = gather(n, first);
    noc_status status = NOC_OK;
    for (int lane = 0; lane < lanes && n->points.len > 1 && !status; lane++) {
        double expected = trace(n, lane);
        n->refused = n->refused || n->route.refused;
        if (n->refused)
            return noc_scene_out_of_memory(traffic_scene(n->traffic));
        status = fill_lane(n, city_window_hash(n->edges.data[first].hash, (uint64_t)lane), expected);
    }
    return status;
}

/* Chains from their beginnings, then those that have none, which are rings. */
static noc_status drive_all(network *n, const noc_progress *progress) {
    noc_status status = NOC_OK;
    for (int rings = 0; rings < 2; rings++)
        for (uint32_t i = 0; i < n->edges.len && !status; i++) {
            double done = (rings + (double)i / (double)n->edges.len) / 2;
            if (i % 64 == 0 && progress->update && !progress->update(progress->user, "cars", done))
                return NOC_ERR_CANCELLED;
            if (!n->edges.data[i].used && (rings || !n->edges.data[i].before))
                status = drive_chain(n, i);
        }
    return status;
}

noc_status city_traffic_roads(city_traffic *traffic, const geo_road *roads, size_t count, const noc_progress *progress,
                              size_t *cars) {
    network n = { .traffic = traffic, .params = traffic_params(traffic), .route = { .scene = traffic_scene(traffic) } };
    for (size_t i = 0; i < count && !n.refused; i++) {
        if (!is_driven(&roads[i]))
            continue;
        if (roads[i].oneway >= 0)
            add_edge(&n, &roads[i], false);
        if (roads[i].oneway <= 0)
            add_edge(&n, &roads[i], true);
    }
    if (n.edges.len > 1)
        qsort(n.edges.data, n.edges.len, sizeof(edge), compare_edges);
    join_all(&n);
    noc_status status = n.refused ? noc_scene_out_of_memory(traffic_scene(traffic)) : drive_all(&n, progress);
    if (n.too_long)
        noc_warn(traffic_scene(traffic)->log, "%zu lanes of roads have no cars: they are too long, or too many",
                 n.too_long);
    if (n.left_out)
        noc_warn(traffic_scene(traffic)->log,
                 "%zu cars along roads of maps are left out, for %d are the most: a larger "
                 "--traffic-spacing asks for fewer",
                 n.left_out, MOST_CARS);
    *cars = n.cars;
    array_free(&n.edges);
    array_free(&n.meetings);
    array_free(&n.turns);
    array_free(&n.points);
    route_free(&n.route);
    return status;
}
