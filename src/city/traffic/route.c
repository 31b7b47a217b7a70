/* Points of a track or a road become stops of a route, on the ground. */
#include "city/traffic/traffic.h"

#include <math.h>

#define STEP 6.0      /* m between stops at most: what the ground does in less, a car does not follow */
#define SHORTEST 10.0 /* m of a leg that is worth driving */
#define MARGIN 5.0    /* m outside of the city's extent */

/* m around a stop in which the next but one takes the place of the next: a car that stands is two stops, however often
 * its track says so, and places along a route are found within a few. */
#define STANDS 0.05

enum { MOST_STOPS = 2000000, MOST_IN_ALL = 20000000 }; /* of a route: 12000 km; of all tracks, and of all roads */

void route_clear(route_maker *m) {
    m->stops.len = m->leg = m->groundless = 0;
    m->seconds = m->along = 0;
    m->bridge = m->too_long = false;
}

void route_free(route_maker *m) { array_free(&m->stops); }

bool route_inside(const route_maker *m, const double xy[2]) {
    const noc_scene *s = m->scene;
    return xy[0] >= s->bounds_min[0] - MARGIN && xy[0] <= s->bounds_max[0] + MARGIN &&
           xy[1] >= s->bounds_min[1] - MARGIN && xy[1] <= s->bounds_max[1] + MARGIN;
}

static void push(route_maker *m, double x, double y, double seconds, double along, bool on_bridge) {
    double z;
    if (on_bridge ? !noc_scene_highest(m->scene, 1u << NOC_CLASS_BRIDGE, x, y, &z)
                  : !noc_scene_ground(m->scene, x, y, &z))
        z = NAN;
    if (!array_push(&m->stops, (noc_scene_stop){ seconds, { (float)x, (float)y, (float)z }, (float)along }))
        m->refused = true;
    m->made++;
}

static bool stands(const route_maker *m, const double xy[2]) {
    const noc_scene_stop *last = m->stops.data + m->stops.len - 1;
    return m->stops.len >= m->leg + 2 &&
           hypot((double)last->p[0] - last[-1].p[0], (double)last->p[1] - last[-1].p[1]) < STANDS &&
           hypot(xy[0] - last[-1].p[0], xy[1] - last[-1].p[1]) < STANDS;
}

void route_point(route_maker *m, const double xy[2], double seconds) {
    if (m->too_long)
        return;
    if (m->stops.len == m->leg) {
        m->along = 0;
        push(m, xy[0], xy[1], m->seconds, 0, false);
    } else {
        if (stands(m, xy)) {
            const noc_scene_stop *before = &m->stops.data[--m->stops.len - 1];
            m->made--;
            m->along = before->along;
            m->xy[0] = before->p[0];
            m->xy[1] = before->p[1];
        }
        double from[2] = { m->xy[0], m->xy[1] }, length = hypot(xy[0] - from[0], xy[1] - from[1]);
        int steps = (int)NOC_CLAMP(ceil(length / STEP), 1, MOST_STOPS);
        m->too_long = m->stops.len + (size_t)steps > MOST_STOPS || m->made + (size_t)steps > MOST_IN_ALL;
        if (m->too_long)
            return;
        for (int i = 1; i <= steps && !m->refused; i++) {
            double t = (double)i / steps;
            push(m, from[0] + t * (xy[0] - from[0]), from[1] + t * (xy[1] - from[1]), m->seconds + t * seconds,
                 m->along + t * length, m->bridge && i < steps);
        }
        m->seconds += seconds;
        m->along += length;
    }
    memcpy(m->xy, xy, sizeof(m->xy));
}

/* Where there is no ground (water, a bridge) the way goes straight from what is before to what is behind. false: there
 * is none at all. */
static bool bridge_gaps(noc_scene_stop *stops, size_t count) {
    size_t known = count;
    for (size_t i = 0; i < count; i++) {
        if (isnan(stops[i].p[2]))
            continue;
        for (size_t k = known < count ? known + 1 : 0; k < i; k++) {
            float length = known < count ? stops[i].along - stops[known].along : 0;
            float t = length > 0 ? (stops[k].along - stops[known].along) / length : 1, low = stops[i].p[2];
            stops[k].p[2] = length > 0 ? stops[known].p[2] + t * (low - stops[known].p[2]) : low;
        }
        known = i;
    }
    for (size_t k = known + 1; known < count && k < count; k++)
        stops[k].p[2] = stops[known].p[2];
    return known < count;
}

void route_end_leg(route_maker *m) {
    noc_scene_stop *leg = m->stops.data + m->leg;
    size_t count = m->stops.len - m->leg;
    bool kept = count > 1 && m->along >= SHORTEST && m->seconds > leg->seconds;
    if (kept && !bridge_gaps(leg, count)) {
        kept = false;
        m->groundless++;
    }
    if (!kept && count) {
        m->seconds = leg->seconds;
        m->stops.len = m->leg;
    }
    m->leg = m->stops.len;
    m->along = 0;
}
