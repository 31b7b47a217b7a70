/* Cars: their routes, and which instances take them. */
#include "scene/keep.h"

#include <math.h>

#define LONGEST 100 /* m between the axles of a car */
#define LATEST 1e30 /* s: tracks whose times are nanoseconds make routes of a hundred thousand years and more */

typedef struct kept_route {
    uint64_t first, count;
} kept_route;

typedef struct kept_car {
    double start, axles;
    uint32_t instance, route;
} kept_car;
_Static_assert(sizeof(noc_scene_stop) == 24 && sizeof(kept_car) == 24, "they have no gaps");

void noc_keep_traffic(noct_writer *w, const noc_scene *s) {
    noct_put_array(w, "stops", s->stops.data, s->stops.len, sizeof(*s->stops.data));
    noct_begin(w, "routes");
    for (size_t i = 0; i < s->routes.len; i++)
        noct_put(w, &(kept_route){ s->routes.data[i].first, s->routes.data[i].count }, sizeof(kept_route));
    noct_end(w);
    noct_begin(w, "cars");
    for (size_t i = 0; i < s->cars.len; i++) {
        const noc_scene_car *car = &s->cars.data[i];
        noct_put(w, &(kept_car){ car->start, car->axles, car->instance, car->route }, sizeof(kept_car));
    }
    noct_end(w);
    noct_put_array(w, "time", &s->time, 1, sizeof(s->time));
}

static bool check_stops(const void *ctx, size_t first, size_t end) {
    const noc_scene_stop *stops = ctx;
    bool ok = true;
    for (size_t i = first; ok && i < end; i++)
        ok = stops[i].seconds >= 0 && stops[i].seconds <= LATEST && stops[i].along >= 0 && stops[i].along <= 1e12f &&
             noc_kept_finite(stops[i].p, 3, 1e7f);
    return ok;
}

/* Time goes on along it. */
static bool route_fits(const noc_scene *s, const kept_route *k) {
    if (k->count < 2 || k->first > s->stops.len || k->count > s->stops.len - k->first)
        return false;
    const noc_scene_stop *stops = s->stops.data + k->first;
    bool ok = stops[k->count - 1].seconds > 0;
    for (size_t i = 1; i < k->count; i++)
        ok &= stops[i].seconds >= stops[i - 1].seconds;
    return ok;
}

noc_status noc_kept_traffic(noct_file *f, noc_scene *s) {
    size_t stops, routes, cars, times;
    noc_scene_stop *stop = noct_array(f, "stops", sizeof(*stop), &stops);
    const kept_route *route = noct_array(f, "routes", sizeof(*route), &routes);
    const kept_car *car = noct_array(f, "cars", sizeof(*car), &cars);
    const double *time = noct_array(f, "time", sizeof(*time), &times);
    if (f->status || times != 1 || !(fabs(*time) <= 1e9) || !noct_each(f, stops, check_stops, stop))
        return noct_wrong(f, "its cars stop nowhere");
    if (!array_reserve(&s->routes, routes) || !array_reserve(&s->cars, cars))
        return noct_no_memory(f);
    array_borrow(&s->stops, stop, stops);
    s->time = *time;
    for (size_t i = 0; i < routes; i++) {
        if (!route_fits(s, &route[i]))
            return noct_wrong(f, "route %zu of its cars is none", i);
        s->routes.data[s->routes.len++] = (noc_scene_route){ (size_t)route[i].first, (size_t)route[i].count };
    }
    for (size_t i = 0; i < cars; i++) {
        bool there = car[i].instance < s->instances.len && s->instances.data[car[i].instance].model;
        if (!there || car[i].route >= routes || !(fabs(car[i].start) <= LATEST) ||
            !(car[i].axles > 0 && car[i].axles <= LONGEST) || (i && car[i].instance <= car[i - 1].instance))
            return noct_wrong(f, "car %zu is none", i);
        s->cars.data[s->cars.len++] = (noc_scene_car){ car[i].instance, car[i].route, car[i].start, car[i].axles };
    }
    return f->status;
}
