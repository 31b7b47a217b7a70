/* Cars: instances that take routes. */
#include "scene/scene.h"

#include <math.h>

int noc_scene_add_route(noc_scene *s, const noc_scene_stop *stops, size_t count) {
    size_t first = s->stops.len;
    if (!array_append(&s->stops, stops, count) || !array_push(&s->routes, (noc_scene_route){ first, count })) {
        noc_scene_out_of_memory(s);
        return -1;
    }
    return (int)s->routes.len - 1;
}

/* The stop that is left last at that second: it and the next are of one leg. */
static size_t stop_before(const noc_scene_stop *stops, size_t count, double second) {
    size_t low = 0, high = count - 1; /* the second lies from low on, and before high */
    while (high - low > 1) {
        size_t middle = low + (high - low) / 2;
        *(stops[middle].seconds <= second ? &low : &high) = middle;
    }
    return low;
}

/* The place so far along the leg of stop i, which may lie before or behind the leg's ends: straight on. */
static void place_along(const noc_scene_stop *stops, size_t count, size_t i, double along, double out[3]) {
    while (i && stops[i].along > 0 && (double)stops[i].along > along)
        i--;
    while (i + 2 < count && stops[i + 2].along > 0 && (double)stops[i + 1].along <= along)
        i++;
    const noc_scene_stop *a = &stops[i], *b = a + 1;
    double length = (double)b->along - a->along, t = length > 0 ? (along - a->along) / length : 0;
    for (int k = 0; k < 3; k++)
        out[k] = a->p[k] + t * ((double)b->p[k] - a->p[k]);
}

static void set_column(double m[12], int column, const double v[3]) {
    for (int k = 0; k < 3; k++)
        m[4 * k + column] = v[k];
}

void noc_car_pose(const noc_scene *s, const noc_scene_car *car, double time, double m[12]) {
    const noc_scene_route *route = &s->routes.data[car->route];
    const noc_scene_stop *stops = s->stops.data + route->first;
    double period = stops[route->count - 1].seconds, second = fmod(car->start + time, period);
    second += second < 0 ? period : 0;
    size_t i = stop_before(stops, route->count, second);
    double step = stops[i + 1].seconds - stops[i].seconds, t = step > 0 ? (second - stops[i].seconds) / step : 0;
    double along = stops[i].along + t * ((double)stops[i + 1].along - stops[i].along), front[3], rear[3], at[3], x[3];
    place_along(stops, route->count, i, along + car->axles / 2, front);
    place_along(stops, route->count, i, along - car->axles / 2, rear);
    double flat = hypot(front[0] - rear[0], front[1] - rear[1]), length = 0;
    for (int k = 0; k < 3; k++) {
        at[k] = (front[k] + rear[k]) / 2;
        x[k] = front[k] - rear[k];
        length += x[k] * x[k];
    }
    length = sqrt(length);
    if (!(flat > 1e-3 * length)) { /* a leg of no length, or an upright one */
        x[0] = flat = length = 1;
        x[1] = x[2] = 0;
    }
    for (int k = 0; k < 3; k++)
        x[k] /= length;
    flat = hypot(x[0], x[1]);
    const double y[3] = { -x[1] / flat, x[0] / flat, 0 };
    const double z[3] = { -x[2] * y[1], x[2] * y[0], x[0] * y[1] - x[1] * y[0] };
    set_column(m, 0, x);
    set_column(m, 1, y);
    set_column(m, 2, z);
    set_column(m, 3, at);
}

bool noc_scene_add_car(noc_scene *s, int model, int route, double start, double axles) {
    noc_scene_car car = { .route = (uint32_t)route, .start = start, .axles = axles };
    noc_instance instance = { .model = model };
    noc_car_pose(s, &car, s->time, instance.transform);
    int index = noc_scene_add_instance(s, &instance);
    if (index < 0)
        return false;
    car.instance = (uint32_t)index;
    if (array_push(&s->cars, car))
        return true;
    noc_scene_out_of_memory(s);
    return false;
}

void noc_car_forget(noc_scene *s, uint32_t instance) {
    size_t low = 0, high = s->cars.len;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        *(s->cars.data[middle].instance < instance ? &low : &high) =
            s->cars.data[middle].instance < instance ? middle + 1 : middle;
    }
    if (low == s->cars.len || s->cars.data[low].instance != instance)
        return;
    s->cars.len--;
    memmove(s->cars.data + low, s->cars.data + low + 1, (s->cars.len - low) * sizeof(*s->cars.data));
}

/* Out of sight: where the car is, 2 m under its place and as small as an instance may be. */
static void hide(double m[12]) {
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 3; column++)
            m[4 * row + column] *= 0.001;
    m[11] -= 2;
}

static noc_status place(noc_scene *scene, const noc_scene_car *car, double seconds) {
    double m[12];
    noc_car_pose(scene, car, seconds, m);
    if (scene->cars_hidden)
        hide(m);
    return noc_scene_set_transform(scene, (int)car->instance, m);
}

noc_status noc_scene_set_time(noc_scene *scene, double seconds) {
    if (!scene)
        return noc_null(NULL, __func__);
    if (!(fabs(seconds) <= 1e9))
        return noc_error(scene->log, NOC_ERR_ARGUMENT, "time of the cars: %g s is not within 1e9 s", seconds);
    noc_status status = NOC_OK;
    if (!array_reserve(&scene->edits, scene->edits.len + scene->cars.len)) /* all of them, or none */
        return noc_scene_out_of_memory(scene);
    for (size_t i = 0; i < scene->cars.len && !status; i++)
        status = place(scene, &scene->cars.data[i], seconds);
    if (!status)
        scene->time = seconds;
    return status;
}

noc_status noc_scene_show_cars(noc_scene *scene, bool shown) {
    if (!scene)
        return noc_null(NULL, __func__);
    size_t lights = 0;
    noc_status status = NOC_OK;
    if (scene->cars.len && !scene->committed)
        return noc_error(scene->log, NOC_ERR_ARGUMENT, "cars are shown and hidden once the scene is committed");
    for (size_t i = 0; i < scene->cars.len; i++)
        lights += noc_scene_model_of(scene, (int)scene->instances.data[scene->cars.data[i].instance].model)->lights.len;
    if (!array_reserve(&scene->edits, scene->edits.len + scene->cars.len + lights)) /* all of them, or none */
        return noc_scene_out_of_memory(scene);
    scene->cars_hidden = !shown;
    for (size_t i = 0; i < scene->cars.len && !status; i++) {
        const noc_scene_instance *car = &scene->instances.data[scene->cars.data[i].instance];
        const noc_scene_model *model = noc_scene_model_of(scene, (int)car->model);
        status = place(scene, &scene->cars.data[i], scene->time);
        for (size_t k = 0; k < model->lights.len && !status; k++)
            status = noc_scene_set_emission(scene, (int)car->lights[k],
                                            shown ? model->lights.data[k].e : (const float[]){ 0, 0, 0 });
    }
    return status;
}
