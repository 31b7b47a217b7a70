/* Views derived from any city: what its triangles cover and where its lights are decides, never a name or a place.
 * What is switched does not: by day and by night, lamps on or off, with or without cars, a city has the same views.
 *
 * All choices are maxima over a fixed list of candidates in a fixed order, so the same scene gives the same camera. */
#include "scene/camera.h"

#include <float.h>
#include <math.h>

typedef struct view_light {
    double p[3];
    double weight;
    bool lamp; /* as opposed to a window */
} view_light;

/* One beside an eye. */
typedef struct view_beside {
    double x, y, d; /* from the eye, m */
    double light;
    bool lamp;
} view_beside;

/* The city as the presets see it. */
typedef struct view_city {
    const noc_scene *scene;
    double min[3], max[3];
    double middle[2];             /* half of the triangles lie to each side */
    double hot[2];                /* middle of the densest lit part */
    bool classes;                 /* something says that it is a wall, a roof, a road, ...: a city, not just any mesh */
    NOC_ARRAY(view_light) lights; /* around it */
    NOC_ARRAY(view_beside) beside;
    double share; /* of the places that the search for a street tried */
    bool no_memory;
} view_city;

enum { SAMPLES = 8192, HOT_CELLS = 64, NEAR_LIGHTS = 4000 };

static int compare_doubles(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Bounds of what is rendered; where strays make them much larger than nearly all triangles need, those of nearly all.
 */
static void city_bounds(view_city *city) {
    const noc_scene *s = city->scene;
    size_t triangles = noc_scene_city_triangles(s), n = NOC_MIN(triangles, (size_t)SAMPLES);
    double *v = noc_alloc(n * sizeof(*v));
    city->no_memory = city->no_memory || !v;
    for (int k = 0; v && k < 3; k++) {
        for (size_t i = 0; i < n; i++)
            v[i] = s->positions
                       .data[3 * (size_t)s->indices.data[3 * noc_scene_city_triangle(s, i * triangles / n) + i % 3] +
                             (size_t)k];
        qsort(v, n, sizeof(*v), compare_doubles);
        double lo = v[n / 50], hi = v[n - 1 - n / 50], margin = (hi - lo) * 0.02 + 1;
        if (k < 2)
            city->middle[k] = v[n / 2];
        city->min[k] = s->bounds_min[k];
        city->max[k] = s->bounds_max[k];
        if (n > 400 && city->max[k] - city->min[k] > 3 * (hi - lo) + 100) {
            city->min[k] = NOC_MAX(city->min[k], lo - margin);
            city->max[k] = NOC_MIN(city->max[k], hi + margin);
        }
    }
    free(v);
}

void noc_light_centre(const noc_light_record *r, double p[3]) {
    double share = r->kind == NOC_LIGHT_TRIANGLE ? 1.0 / 3 : r->kind == NOC_LIGHT_PARALLELOGRAM ? 0.5 : 0;
    for (int k = 0; k < 3; k++)
        p[k] = r->p[k] + share * ((double)r->a[k] + r->b[k]);
}

double noc_light_weight(const noc_light_record *r) { return sqrt(noc_light_flux(r)); }

/* What the maintenance factor has made of a light's flux; lights of cars have none. */
static double maintenance_of(const noc_scene *s, const noc_light_record *r) {
    uint32_t group = noc_light_group(r);
    bool car = group && group <= s->groups.len && !strcmp(s->groups.data[group - 1].name, "cars");
    return noc_light_is_lamp(r) && !car ? s->maintenance : 1;
}

/* A light as it was made: what is off or dimmed for now is looked at all the same, and windows as they are lit by
 * default. */
static bool light_get(const noc_scene *s, uint32_t i, view_light *out) {
    noc_light_record r = noc_light_made(s, i);
    if (r.flags & NOC_LIGHT_MOVES)
        return false;
    const noc_scene_window *window = noc_window_of(s, i);
    if (window && !window->removed)
        noc_window_first(window, r.e);
    noc_light_centre(&r, out->p);
    out->weight = noc_light_weight(&r) / sqrt(maintenance_of(s, &r));
    out->lamp = r.kind != NOC_LIGHT_TRIANGLE && r.kind != NOC_LIGHT_PARALLELOGRAM;
    return out->weight > 0;
}

/* Without lights, or where those are not the city's, buildings stand in for them: a corner of every so many of their
 * triangles. */
static bool by_lights(const noc_scene *s) { return s->lights.len && !s->lit_elsewhere; }

static size_t source_count(const view_city *city) {
    const noc_scene *s = city->scene;
    return by_lights(s) ? s->lights.len : NOC_MIN(noc_scene_city_triangles(s), (size_t)4 * SAMPLES);
}

static bool source_get(const view_city *city, size_t i, view_light *out) {
    const noc_scene *s = city->scene;
    *out = (view_light){ .weight = 1 };
    if (by_lights(s))
        return light_get(s, (uint32_t)i, out);
    size_t t = noc_scene_city_triangle(s, i * noc_scene_city_triangles(s) / source_count(city));
    noc_class cls = s->materials.data[s->triangle_material.data[t]].cls;
    for (int k = 0; k < 3; k++)
        out->p[k] = s->positions.data[3 * (size_t)s->indices.data[3 * t] + (size_t)k];
    return cls == NOC_CLASS_WALL || cls == NOC_CLASS_ROOF || cls == NOC_CLASS_OTHER;
}

static void find_classes(view_city *city) {
    const noc_scene *s = city->scene;
    for (size_t i = 0; i < s->meshes.len && !city->classes; i++) {
        noc_class cls = s->materials.data[s->meshes.data[i].material].cls;
        city->classes = cls != NOC_CLASS_OTHER && cls != NOC_CLASS_LAMP && noc_mesh_in_city(s, &s->meshes.data[i]);
    }
}

static int hot_cell(const view_city *city, int k, double x) {
    double c = (x - city->min[k]) / (city->max[k] - city->min[k]) * HOT_CELLS;
    return !(c > 0) ? 0 : c >= HOT_CELLS ? HOT_CELLS - 1 : (int)c;
}

static double distance2(const double a[2], const double b[2]) { return hypot(a[0] - b[0], a[1] - b[1]); }

#define BESIDE 60.0    /* m from a building within which lights are the city's */
#define FEW_BESIDE 0.5 /* of all weights: where fewer are, lamps lie over an area much greater than the buildings */

/* Lamps of a whole district around a few streets of buildings: only those beside buildings count. h as it is where most
 * lights are beside buildings, and where there are none of either. */
static void weigh_by_buildings(view_city *city, double *h) {
    const noc_scene *s = city->scene;
    size_t triangles = noc_scene_city_triangles(s), n = NOC_MIN(triangles, (size_t)4 * SAMPLES);
    double cell[2], all = 0, beside = 0;
    bool *near = noc_calloc(HOT_CELLS * HOT_CELLS, sizeof(*near));
    city->no_memory = city->no_memory || !near;
    for (int k = 0; k < 2; k++)
        cell[k] = NOC_MAX((city->max[k] - city->min[k]) / HOT_CELLS, 1e-6);
    int rx = (int)NOC_MIN(ceil(BESIDE / cell[0]), HOT_CELLS), ry = (int)NOC_MIN(ceil(BESIDE / cell[1]), HOT_CELLS);
    for (size_t i = 0; near && i < n; i++) {
        size_t t = noc_scene_city_triangle(s, i * triangles / n);
        noc_class cls = s->materials.data[s->triangle_material.data[t]].cls;
        if (cls != NOC_CLASS_WALL && cls != NOC_CLASS_ROOF)
            continue;
        const float *p = s->positions.data + 3 * (size_t)s->indices.data[3 * t];
        int x = hot_cell(city, 0, (double)p[0]), y = hot_cell(city, 1, (double)p[1]);
        for (int v = NOC_MAX(y - ry, 0); v <= NOC_MIN(y + ry, HOT_CELLS - 1); v++)
            for (int u = NOC_MAX(x - rx, 0); u <= NOC_MIN(x + rx, HOT_CELLS - 1); u++)
                near[v * HOT_CELLS + u] = true;
    }
    for (int i = 0; near && i < HOT_CELLS * HOT_CELLS; i++) {
        all += h[i];
        beside += near[i] ? h[i] : 0;
    }
    for (int i = 0; near && i < HOT_CELLS * HOT_CELLS && beside > 0 && beside < FEW_BESIDE * all; i++)
        h[i] = near[i] ? h[i] : 0;
    free(near);
}

/* The densest lit part: the best window of a histogram of weights, the middle of the city where nothing shines. */
static void find_hot(view_city *city) {
    double *h = noc_calloc(HOT_CELLS * HOT_CELLS, sizeof(*h)), best = 0, cell[2];
    size_t n = source_count(city);
    view_light l;
    city->no_memory = city->no_memory || !h;
    if (!h)
        return;
    for (int k = 0; k < 2; k++) {
        city->hot[k] = 0.5 * (city->min[k] + city->max[k]);
        cell[k] = (city->max[k] - city->min[k]) / HOT_CELLS;
    }
    /* where there are lamps they decide: an office tower is bright, but streets are what one looks at */
    size_t lamps = 0;
    for (size_t i = 0; i < n; i++)
        lamps += source_get(city, i, &l) && l.lamp;
    for (size_t i = 0; i < n; i++)
        if (source_get(city, i, &l) && (lamps < 8 || l.lamp))
            h[hot_cell(city, 1, l.p[1]) * HOT_CELLS + hot_cell(city, 0, l.p[0])] += NOC_MIN(l.weight, 200.0);
    weigh_by_buildings(city, h);
    int rx = (int)NOC_CLAMP(50 / NOC_MAX(cell[0], 1e-6), 1, 12),
        ry = (int)NOC_CLAMP(50 / NOC_MAX(cell[1], 1e-6), 1, 12);
    for (int y = 0; y < HOT_CELLS; y++)
        for (int x = 0; x < HOT_CELLS; x++) {
            double sum = 0;
            for (int v = NOC_MAX(y - ry, 0); v <= NOC_MIN(y + ry, HOT_CELLS - 1); v++)
                for (int u = NOC_MAX(x - rx, 0); u <= NOC_MIN(x + rx, HOT_CELLS - 1); u++)
                    sum += h[v * HOT_CELLS + u];
            if (sum > best * 1.0001) {
                best = sum;
                city->hot[0] = city->min[0] + (x + 0.5) * cell[0];
                city->hot[1] = city->min[1] + (y + 0.5) * cell[1];
            }
        }
    free(h);
}

/* Keeps the lights around the hot spot, thinned evenly if they are many. */
static void gather_lights(view_city *city, double radius) {
    size_t n = source_count(city), inside = 0;
    view_light l;
    for (int pass = 0; pass < 2; pass++) {
        size_t seen = 0, stride = inside / NEAR_LIGHTS + 1;
        for (size_t i = 0; i < n; i++) {
            if (!source_get(city, i, &l) || distance2(l.p, city->hot) > radius)
                continue;
            if (pass && seen % stride == 0 && !array_push(&city->lights, l))
                city->no_memory = true;
            seen++;
        }
        inside = seen;
    }
}

/* Light that a view from above takes in along (dx, dy); at 200 m a light counts half as much as at none. */
static double light_from_above(const view_city *city, const double eye[3], double dx, double dy, double half_angle) {
    double sum = 0, cosine = cos(half_angle);
    for (size_t i = 0; i < city->lights.len; i++) {
        const view_light *l = &city->lights.data[i];
        double x = l->p[0] - eye[0], y = l->p[1] - eye[1], d = sqrt(x * x + y * y);
        if (d > 6 && d < 500 && x * dx + y * dy > cosine * d)
            sum += l->weight / (d + 200);
    }
    return sum;
}

static double half_width(double fov_deg, double aspect) { return atan(tan(fov_deg * M_PI / 360) * aspect); }

/* Highest surface within r of (x, y), on a pattern of 25 points; fallback where nothing is. */
static double top_around(const noc_scene *scene, double x, double y, double r, double fallback) {
    double best = -DBL_MAX, z;
    for (int j = -2; j <= 2; j++)
        for (int i = -2; i <= 2; i++)
            if (noc_scene_top(scene, x + i * r / 2, y + j * r / 2, &z))
                best = NOC_MAX(best, z);
    return best == -DBL_MAX ? fallback : best;
}

/* How much of the way from eye to target runs clear over the roofs, 0..1. */
static double clear_share(const noc_scene *scene, const double eye[3], const double target[3]) {
    enum { STEPS = 40 };
    for (int i = 1; i < STEPS; i++) {
        double t = (double)i / STEPS, p[3], z;
        for (int k = 0; k < 3; k++)
            p[k] = eye[k] + t * (target[k] - eye[k]);
        if (noc_scene_top(scene, p[0], p[1], &z) && z > p[2])
            return t;
    }
    return 1;
}

/* The same to both sides of the target: nothing tall may stand across the picture. */
static double clear_aside(const noc_scene *scene, const double eye[3], const double target[3]) {
    double dx = target[0] - eye[0], dy = target[1] - eye[1];
    double left[3] = { target[0] - 0.35 * dy, target[1] + 0.35 * dx, target[2] + 4 },
           right[3] = { target[0] + 0.35 * dy, target[1] - 0.35 * dx, target[2] + 4 };
    return 0.5 * (clear_share(scene, eye, left) + clear_share(scene, eye, right));
}

static void aerial(view_city *city, double aspect, noc_camera *camera) {
    const noc_scene *scene = city->scene;
    double extent = NOC_MAX(city->max[0] - city->min[0], city->max[1] - city->min[1]);
    double reach = NOC_CLAMP(0.36 * extent, 2, 170), ground = city->min[2], best = -1;
    camera->fov_deg = 48;
    gather_lights(city, 500);
    if (!noc_scene_ground(scene, city->hot[0], city->hot[1], &ground))
        noc_scene_top(scene, city->hot[0], city->hot[1], &ground);
    for (int i = 0; i < 24; i++) {
        double yaw = 2 * M_PI * (i + 0.35) / 24, dx = cos(yaw), dy = sin(yaw);
        double eye[3] = { city->hot[0] - dx * reach, city->hot[1] - dy * reach, 0 };
        double target[3] = { city->hot[0], city->hot[1], ground + NOC_MIN(6, 0.04 * reach) };
        double roofs = top_around(scene, eye[0], eye[1], 0.25 * reach, ground);
        eye[2] = NOC_MAX(roofs + 0.1 * reach, ground + 0.36 * reach);
        double inside = 1; /* looking in from beyond the edge, or out over it, is worse than from over the city */
        for (int k = 0; k < 2; k++) {
            double edge = 0.1 * (city->max[k] - city->min[k]);
            inside *= eye[k] > city->min[k] + edge && eye[k] < city->max[k] - edge ? 1 : 0.45;
        }
        /* with the city behind the lights rather than behind the eye */
        double mx = city->middle[0] - city->hot[0], my = city->middle[1] - city->hot[1];
        inside *= 1 + 0.6 * (mx * dx + my * dy) / NOC_MAX(hypot(mx, my), reach);
        double steep = (eye[2] - ground) / reach; /* a tower below would lift the eye too high */
        double score = (1e-6 + light_from_above(city, eye, dx, dy, half_width(camera->fov_deg, aspect))) * inside *
                       (0.1 + clear_share(scene, eye, target)) * (0.1 + clear_aside(scene, eye, target)) /
                       (1 + NOC_MAX(steep - 0.5, 0) * 3);
        if (score > best * 1.0001) {
            best = score;
            memcpy(camera->eye, eye, sizeof(eye));
            memcpy(camera->target, target, sizeof(target));
        }
    }
}

/* Where a person stands: ground, or for models without it, whatever is lowest of what can be stood on. */
static bool standing(const noc_scene *scene, double x, double y, double *z) {
    double top;
    if (!noc_scene_top(scene, x, y, &top))
        return false;
    if (!noc_scene_ground(scene, x, y, z))
        *z = top;
    return top - *z < 0.3;
}

/* Room to stand: level ground, open sky, for a metre and a half around. */
static bool open_place(const noc_scene *scene, double x, double y, double *z) {
    if (!standing(scene, x, y, z))
        return false;
    for (int i = 0; i < 8; i++) {
        double h;
        if (!standing(scene, x + 1.5 * cos(i * M_PI / 4), y + 1.5 * sin(i * M_PI / 4), &h) || fabs(h - *z) > 0.8)
            return false;
    }
    return true;
}

enum { STREET_REACH = 130 };

/* Distance to the first thing as high as the eye along a direction, and whether it is a wall, or a tree, rather than a
 * car. Leaving the model ends the view too. */
static double free_distance(const noc_scene *scene, const double eye[3], double dx, double dy, bool *wall) {
    double step = 1.2;
    *wall = false;
    for (double d = step; d < STREET_REACH; d += step) {
        double z;
        /* nearby, anything over the knee is in the way (a parked car); further on, what reaches over the eye is */
        if (!noc_scene_top(scene, eye[0] + d * dx, eye[1] + d * dy, &z))
            return d;
        if (z > eye[2] + (d < 14 ? -1.2 : -0.1 + 0.03 * d)) {
            *wall = z > eye[2] + 2;
            return d;
        }
        step = 1.2 + 0.02 * d;
    }
    return STREET_REACH;
}

/* Lights up to 100 m around an eye: what directions are judged by, worked out once for all of them. */
static bool find_beside(view_city *city, const double eye[3]) {
    city->beside.len = 0;
    for (size_t i = 0; i < city->lights.len; i++) {
        const view_light *l = &city->lights.data[i];
        double x = l->p[0] - eye[0], y = l->p[1] - eye[1], d = sqrt(x * x + y * y);
        if (d < 100 && !array_push(&city->beside, (view_beside){ x, y, d, l->weight / (d + 30), l->lamp })) {
            city->no_memory = true;
            return false;
        }
    }
    return true;
}

typedef struct view_way {
    double lamps, all; /* light of the picture that way; at 30 m a light counts half as much as at none */
    bool pole;         /* rays march past poles, and a lamp this near has one right before the eye */
} view_way;

static view_way way_of(const view_city *city, double dx, double dy, double cosine) {
    view_way way = { 0 };
    for (size_t i = 0; i < city->beside.len; i++) {
        const view_beside *l = &city->beside.data[i];
        double along = l->x * dx + l->y * dy;
        if (l->d > 6 && along > cosine * l->d) {
            way.all += l->light;
            way.lamps += l->lamp ? l->light : 0;
        }
        way.pole = way.pole || (l->lamp && l->d < 8 && along > cosine * l->d - 1);
    }
    return way;
}

static double light_of_way(view_way way) {
    return 1e-3 + way.lamps + 0.5 * NOC_MIN(way.all - way.lamps, 2 * way.lamps + 10);
}

enum { DIRECTIONS = 32 };

#define MOST_OF_WAY (110 * 1.2 * 6 * 1.001) /* of a score, over its light: street_look */

/* Nothing says what the triangles of a mesh are. A street is where walls stand around, and lights not far above; a
 * small model must enclose the place, or it is an object on a plate, seen better from outside. */
static bool is_street(const view_city *city, const double eye[3], const bool wall[DIRECTIONS],
                      const double free_way[DIRECTIONS]) {
    double extent = NOC_MAX(city->max[0] - city->min[0], city->max[1] - city->min[1]);
    int around = 0;
    for (int i = 0; i < DIRECTIONS; i++)
        around += wall[i] && free_way[i] < 70;
    bool light = false;
    for (size_t i = 0; i < city->lights.len && !light; i++) {
        const view_light *l = &city->lights.data[i];
        light = distance2(l->p, eye) < 100 && l->p[2] - eye[2] < 40;
    }
    return light && around >= (extent < 50 ? DIRECTIONS * 3 / 4 : DIRECTIONS / 6);
}

/* Best direction from one place, which is to beat so much; returns its score, 0 where it surely does not. */
static double street_look(view_city *city, const double eye[3], double aspect, double fov, double beat, double *yaw) {
    double best = 0, free_way[DIRECTIONS], cosine = cos(half_width(fov, aspect));
    bool wall[DIRECTIONS], may = false;
    view_way ways[DIRECTIONS];
    if (!find_beside(city, eye))
        return 0;
    for (int i = 0; i < DIRECTIONS; i++) {
        ways[i] = way_of(city, cos(2 * M_PI * i / DIRECTIONS), sin(2 * M_PI * i / DIRECTIONS), cosine);
        may = may || MOST_OF_WAY * light_of_way(ways[i]) > beat;
    }
    if (!may) /* no need to ask what stands around */
        return 0;
    for (int i = 0; i < DIRECTIONS; i++)
        free_way[i] =
            free_distance(city->scene, eye, cos(2 * M_PI * i / DIRECTIONS), sin(2 * M_PI * i / DIRECTIONS), &wall[i]);
    if (!city->classes && !is_street(city, eye, wall, free_way))
        return 0;
    for (int i = 0; i < DIRECTIONS; i++) {
        double beside = NOC_MIN(free_way[(i + 1) % DIRECTIONS], free_way[(i + DIRECTIONS - 1) % DIRECTIONS]);
        /* a long way ahead, some room beside it, lamps along it; lit fronts help */
        double way = NOC_MIN(free_way[i], 110.0) * NOC_MIN(beside, 12.0) / 12;
        int fronts = 0; /* a street has houses to its sides */
        for (int j = i + DIRECTIONS - 4; j <= i + DIRECTIONS + 4; j++)
            fronts += wall[j % DIRECTIONS] && free_way[j % DIRECTIONS] < 70;
        double aside = NOC_MIN(free_way[(i + 2) % DIRECTIONS], free_way[(i + DIRECTIONS - 2) % DIRECTIONS]);
        way *= (0.2 + NOC_MIN(aside, 9.0) / 9) * (ways[i].pole ? 0.2 : 1);
        double score = way * (1 + NOC_MIN(fronts, 5)) * light_of_way(ways[i]);
        if (score > best * 1.0001) {
            best = score;
            *yaw = 2 * M_PI * i / DIRECTIONS;
        }
    }
    return best;
}

enum { LIGHTS = 60, AROUND = 12, GRID = 40 }; /* lights, places beside each; edge of the grid over the city */

/* Places that a round of the search tries. */
typedef struct street_places {
    bool grid;            /* over the city, instead of beside lights */
    bool lamps;           /* beside lamps alone, rather than lit fronts */
    size_t count, stride; /* of lights: each stride-th is chosen */
    size_t edge;          /* of the grid */
} street_places;

static size_t place_count(const street_places *p) { return p->grid ? p->edge * p->edge : p->count * AROUND; }

/* Fills eye with place i; false if it is beside a light that is not chosen. n: lights so far. */
static bool place_of(const view_city *city, const street_places *p, size_t i, size_t *n, double eye[2]) {
    if (p->grid) {
        const double at[2] = { (double)(i % p->edge) + 0.5, (double)(i / p->edge) + 0.5 };
        for (int k = 0; k < 2; k++)
            eye[k] = city->min[k] + (city->max[k] - city->min[k]) * at[k] / (double)p->edge;
        return true;
    }
    const view_light *light = &city->lights.data[i / AROUND];
    if (p->lamps && !light->lamp)
        return false;
    *n += i % AROUND == 0;
    if ((*n - 1) % p->stride)
        return false;
    double a = 2 * M_PI * (double)(i % AROUND) / AROUND + (double)(i / AROUND), r = 3 + 3.2 * (double)(i % AROUND % 3);
    eye[0] = light->p[0] + r * cos(a);
    eye[1] = light->p[1] + r * sin(a);
    return true;
}

#define MOST_LOOKS 5e8 /* rays of one round times the triangles whose rectangles they are in: some seconds */
#define MOST_RAYS 2500 /* that judging a place takes */

/* Returns an estimate of how many triangles' upright rectangles contain a point, by SAMPLES * 16 triangles. */
static double stacked_at(const noc_scene *s, const double p[2]) {
    size_t triangles = noc_scene_city_triangles(s), n = NOC_MIN(triangles, (size_t)16 * SAMPLES), found = 0;
    for (size_t i = 0; i < n; i++) {
        const uint32_t *corners = s->indices.data + 3 * noc_scene_city_triangle(s, i * triangles / n);
        bool in = true;
        for (size_t k = 0; k < 2 && in; k++) {
            float a = s->positions.data[3 * (size_t)corners[0] + k], b = s->positions.data[3 * (size_t)corners[1] + k],
                  c = s->positions.data[3 * (size_t)corners[2] + k];
            in = p[k] >= NOC_MIN(a, NOC_MIN(b, c)) && p[k] <= NOC_MAX(a, NOC_MAX(b, c));
        }
        found += in;
    }
    return n ? (double)found * (double)triangles / (double)n : 0;
}

/* Returns the share of the places that MOST_LOOKS allows. It depends on the scene alone, as the camera does. */
static double affordable(const view_city *city, const street_places *p) {
    enum { PROBES = 64 };
    double stacked = 0, eye[2];
    size_t places = 0, probes = 0, n = 0;
    for (size_t i = 0; i < place_count(p); i++)
        places += place_of(city, p, i, &n, eye);
    n = 0;
    for (size_t i = 0, k = 0; i < place_count(p); i++)
        if (place_of(city, p, i, &n, eye) && k++ % (places / PROBES + 1) == 0) {
            stacked += stacked_at(city->scene, eye);
            probes++;
        }
    return stacked > 0 ? NOC_MIN(1, MOST_LOOKS / MOST_RAYS / (double)places / (stacked / (double)probes)) : 1;
}

/* Beside lamps (or lit fronts); if none of those places will do, on a grid over the city. */
static street_places choose_places(view_city *city, bool grid) {
    street_places p = { .grid = grid, .count = city->lights.len, .edge = GRID };
    size_t lamps = 0;
    for (size_t i = 0; i < city->lights.len; i++)
        lamps += city->lights.data[i].lamp;
    size_t of = lamps ? lamps : city->lights.len;
    p.lamps = lamps > 0;
    p.stride = of / LIGHTS + 1;
    double share = affordable(city, &p);
    if (share < 1) {
        p.stride = of / (size_t)NOC_MAX(2, LIGHTS * share) + 1;
        p.edge = (size_t)NOC_MAX(4, GRID * sqrt(share));
        city->share = NOC_MIN(city->share, share);
    }
    return p;
}

static bool street(view_city *city, double aspect, noc_camera *camera) {
    double best = 0;
    camera->fov_deg = 55;
    gather_lights(city, 250);
    for (int round = 0; round < 2 && !(best > 0); round++) {
        street_places places = choose_places(city, round > 0);
        for (size_t i = 0, n = 0; i < place_count(&places); i++) {
            double eye[3], z, yaw = 0;
            if (!place_of(city, &places, i, &n, eye) || !open_place(city->scene, eye[0], eye[1], &z))
                continue;
            eye[2] = z + 1.7;
            double score = street_look(city, eye, aspect, camera->fov_deg, best * 1.0001, &yaw);
            if (score > best * 1.0001) {
                best = score;
                memcpy(camera->eye, eye, sizeof(eye));
                camera->target[0] = eye[0] + 30 * cos(yaw);
                camera->target[1] = eye[1] + 30 * sin(yaw);
                camera->target[2] = eye[2] + 2.2; /* a little up: fronts rather than pavement */
            }
        }
    }
    return best > 0;
}

noc_status noc_scene_set_camera(noc_scene *scene, const noc_camera *camera) {
    if (!scene || !camera)
        return noc_null(scene ? scene->log : NULL, __func__);
    double along = 0, up = 0;
    for (int k = 0; k < 3; k++) {
        along += fabs(camera->target[k] - camera->eye[k]);
        up += fabs(camera->up[k]);
    }
    if (!(along > 0 && along < 1e8 && up > 0 && isfinite(up) && camera->fov_deg >= 1 && camera->fov_deg <= 170))
        return noc_error(scene->log, NOC_ERR_ARGUMENT,
                         "camera: it looks nowhere, or its field of view is not within 1 to 170 degrees");
    if (scene->committed)
        return noc_error(scene->log, NOC_ERR_ARGUMENT, "camera: the scene is committed");
    if (!(scene->own_camera.fov_deg > 0))
        scene->own_camera = *camera;
    return NOC_OK;
}

static noc_status derive(const noc_scene *scene, noc_viewpoint view, double aspect, noc_camera *camera) {
    if (!(aspect > 0 && isfinite(aspect)))
        return noc_error(scene->log, NOC_ERR_ARGUMENT, "camera: the aspect is %g, must be finite and more than 0",
                         aspect);
    aspect = NOC_CLAMP(aspect, 0.01, 100); /* what slits of pictures see decides nothing */
    if ((unsigned)view > NOC_VIEWPOINT_OWN)
        return noc_error(scene->log, NOC_ERR_ARGUMENT, "camera: no view %d", (int)view);
    if (!noc_scene_city_triangles(scene))
        return noc_error(scene->log, NOC_ERR_ARGUMENT, "camera: the scene is empty, so no view can be derived from it");
    if (view == NOC_VIEWPOINT_OWN && scene->own_camera.fov_deg > 0) {
        *camera = scene->own_camera;
        return NOC_OK;
    }
    if (view != NOC_VIEWPOINT_OVERVIEW && noc_ground_ready(scene) != NOC_OK)
        return NOC_ERR_MEMORY;
    view_city city = { .scene = scene, .share = 1 };
    noc_camera c = noc_camera_default();
    city_bounds(&city);
    find_classes(&city);
    if (view != NOC_VIEWPOINT_OVERVIEW)
        find_hot(&city);
    if (city.no_memory)
        return noc_error(scene->log, NOC_ERR_MEMORY, "camera: no memory to look at the scene");
    bool stand = view == NOC_VIEWPOINT_STREET || view == NOC_VIEWPOINT_OWN;
    /* a room is looked at from inside, another model with nowhere to stand from outside */
    bool room = stand && !city.classes && noc_room_camera(scene, city.min, city.max, aspect, &c);
    bool found = room || (stand && street(&city, aspect, &c));
    if (view == NOC_VIEWPOINT_AERIAL)
        aerial(&city, aspect, &c);
    else if (!found)
        city.no_memory = city.no_memory || !noc_overview_camera(scene, city.min, city.max, aspect, &c);
    array_free(&city.lights);
    array_free(&city.beside);
    if (city.no_memory)
        return noc_error(scene->log, NOC_ERR_MEMORY, "camera: no memory to look at the scene");
    if (view == NOC_VIEWPOINT_STREET && (room || !found))
        noc_warn(scene->log, "view street: the scene has none, so it is seen from %s",
                 room ? "inside, as a room" : "outside");
    if (city.share < 1)
        noc_warn(scene->log,
                 "camera: so many triangles lie over one another that the view was searched at %.2g %% of the places; "
                 "--eye and --target choose another",
                 100 * city.share);
    *camera = c;
    return NOC_OK;
}

noc_status noc_scene_camera(const noc_scene *scene, noc_viewpoint view, double aspect, noc_camera *camera) {
    if (!scene || !camera)
        return noc_null(scene ? scene->log : NULL, __func__);
    noc_scene_lock_read(scene);
    noc_status status = derive(scene, view, aspect, camera);
    noc_scene_unlock_read(scene);
    return status;
}
