/* Who lights this: a place of the picture, or a region. */
#include "viewer/ask_parts.h"

#include "viewer/out.h"

#include <nocturne/influence.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FIRST_SECONDS 0.15 /* until the first answer */
#define MOST_SECONDS 6.0   /* until the last one, where light is hard to find */
#define MOST_PIXELS 160000 /* of a picture that a rectangle is asked of */
#define GOOD 0.01          /* relative standard error of the greatest share, that is enough */

/* ---- rows ---- */

static const char *kind_of(const noc_emitter *e) {
    static const char *const names[] = { [NOC_EMITTER_LAMP] = "lamp",
                                         [NOC_EMITTER_WINDOW] = "window",
                                         [NOC_EMITTER_VEHICLE] = "car",
                                         [NOC_EMITTER_SURFACE] = "other",
                                         [NOC_EMITTER_OTHER] = "other" };
    return e->kind == NOC_EMITTER_LAMP && e->inferred ? "inferred" : names[e->kind];
}

/* NAME and NAME_error. */
static void set_estimate(json_t *m, const char *name, const noc_estimate *e) {
    char error[32];
    snprintf(error, sizeof(error), "%s_error", name);
    json_object_set_new(m, name, ask_number(e->value));
    json_object_set_new(m, error, ask_number(e->error));
}

static json_t *row_of(const char *kind, const char *name, long light, const noc_estimate *share,
                      const noc_estimate *lux) {
    json_t *row = json_object();
    json_object_set_new(row, "light", json_integer(light));
    json_object_set_new(row, "kind", json_string(kind));
    json_object_set_new(row, "name", wire_text(name));
    json_object_set_new(row, "share", ask_number(share->value));
    json_object_set_new(row, "error", ask_number(share->error));
    json_object_set_new(row, "lux", ask_number(lux->value));
    return row;
}

static json_t *rows_of(const noc_influence_row *rows, size_t count, const noc_influence_sum *sum) {
    json_t *list = json_array();
    for (size_t i = 0; i < count; i++) {
        const noc_emitter *e = &rows[i].emitter;
        json_t *row = row_of(kind_of(e), *e->name ? e->name : e->of, (long)e->light, &rows[i].share, &rows[i].lux);
        json_object_set_new(row, "place", ask_place(e->centre));
        json_array_append_new(list, row);
    }
    if (sum->sky.value > 0)
        json_array_append_new(list, row_of("sky", "sky", -1, &sum->sky_share, &sum->sky));
    if (sum->rest.value > 0)
        json_array_append_new(list, row_of("other", "all others", -1, &sum->rest_share, &sum->rest));
    return list;
}

/* What lamps bring together, what windows, ..., and the sky. */
static json_t *kinds_of(const noc_influence_sum *sum) {
    static const char *const names[] = {
        [NOC_EMITTER_LAMP] = "lamp",       [NOC_EMITTER_WINDOW] = "window", [NOC_EMITTER_VEHICLE] = "car",
        [NOC_EMITTER_SURFACE] = "surface", [NOC_EMITTER_OTHER] = "other",   [NOC_EMITTER_KIND_COUNT] = "sky"
    };
    json_t *list = json_array();
    for (int k = 0; k <= NOC_EMITTER_KIND_COUNT; k++) {
        noc_influence_kind one = { sum->sky, sum->sky_share, 0 };
        if (k < NOC_EMITTER_KIND_COUNT)
            one = sum->kinds[k];
        if (!(one.lux.value > 0))
            continue;
        json_t *row = json_object();
        json_object_set_new(row, "kind", json_string(names[k]));
        json_object_set_new(row, "emitters", json_integer((json_int_t)one.emitters));
        json_object_set_new(row, "share", ask_number(one.share.value));
        json_object_set_new(row, "error", ask_number(one.share.error));
        set_estimate(row, "lux", &one.lux);
        json_array_append_new(list, row);
    }
    return list;
}

/* What a building's walls, roof, windows, ... get. */
static json_t *classes_of(const noc_influence_class *classes, size_t count) {
    json_t *list = json_array();
    for (size_t i = 0; i < count; i++) {
        json_t *row = json_object();
        json_object_set_new(row, "class", json_string(noc_class_name(classes[i].cls)));
        json_object_set_new(row, "area", ask_number(classes[i].weight));
        set_estimate(row, "lamps", &classes[i].lamps);
        set_estimate(row, "windows", &classes[i].windows);
        set_estimate(row, "lux", &classes[i].lux);
        json_array_append_new(list, row);
    }
    return list;
}

/* Classes of a region's surfaces; of a place alone there are none to tell apart. Their count. */
static size_t get_classes(noc_ranking *ranking, const json_t *about, noc_influence_class *classes) {
    size_t count = 0;
    bool region = json_object_get(about, "area") != NULL;
    return region && !noc_ranking_get_classes(ranking, classes, NOC_CLASS_COUNT, &count) ? count : 0;
}

/* All rows that were found. */
static char *csv_of(const asker *a, noc_ranking *ranking, const json_t *about) {
    noc_influence_class classes[NOC_CLASS_COUNT];
    noc_influence_sum sum;
    size_t found = 0;
    char *text = NULL;
    if (noc_ranking_get(ranking, NULL, 0, &found, &sum))
        return NULL;
    size_t class_count = get_classes(ranking, about, classes);
    noc_influence_row *rows = calloc(sum.emitters + 1, sizeof(*rows));
    if (rows && !noc_ranking_get(ranking, rows, sum.emitters, &found, &sum))
        text = noc_influence_csv(world_scene(a->world), world_report(a->world), rows, found, &sum, classes, class_count,
                                 NULL);
    free(rows);
    return text;
}

/* ---- refining ---- */

static bool goes_on(void *user, const char *what, double done) {
    (void)what, (void)done;
    return !ask_stopped(user);
}

static double maintenance(const asker *a) {
    noc_scene_info info;
    noc_scene_get_info(world_scene(a->world), &info);
    return info.maintenance;
}

/* One answer of what is known by now. about: what is said of the place beside it; is not taken. */
static void tell(asker *a, const question *q, noc_ranking *ranking, json_t *about, double done) {
    noc_influence_row rows[ASK_ROWS];
    noc_influence_class classes[NOC_CLASS_COUNT];
    noc_influence_sum sum;
    size_t found;
    if (noc_ranking_get(ranking, rows, ASK_ROWS, &found, &sum))
        return;
    json_t *m = ask_begin(q, done);
    json_object_update(m, about);
    if (json_object_get(about, "area"))
        json_object_set_new(m, "classes", classes_of(classes, get_classes(ranking, about, classes)));
    set_estimate(m, "lamps", &sum.kinds[NOC_EMITTER_LAMP].lux);
    set_estimate(m, "windows", &sum.kinds[NOC_EMITTER_WINDOW].lux);
    set_estimate(m, "lux", &sum.lux);
    json_object_set_new(m, "maintenance", ask_number(maintenance(a)));
    set_estimate(m, "luminance", &sum.luminance);
    json_object_set_new(m, "emitters", json_integer((json_int_t)sum.emitters));
    json_object_set_new(m, "kinds", kinds_of(&sum));
    json_object_set_new(m, "rows", rows_of(rows, found, &sum));
    if (done >= 1)
        ask_keep(a, q->id, csv_of(a, ranking, about));
    ask_send(a, q, m);
}

/* Is the greatest share known well enough? */
static bool is_good(noc_ranking *ranking) {
    noc_influence_row first;
    size_t found;
    return !noc_ranking_get(ranking, &first, 1, &found, NULL) && found && first.share.error < GOOD * first.share.value;
}

static void rank(asker *a, const question *q, const noc_region *region, json_t *about) {
    /* Windows count: the answer explains a picture that they light, too. */
    noc_ranking_params params = { .render = &q->view.render, .eye = q->view.camera.eye, .count_windows = true };
    noc_ranking *ranking = noc_ranking_create(a->ask_view, region, &params);
    noc_status status = ranking ? NOC_OK : NOC_ERR_MEMORY;
    double spent = 0, next = FIRST_SECONDS;
    bool told = false;
    while (!status && spent < MOST_SECONDS) {
        status = noc_ranking_refine(ranking, &(noc_ranking_target){ .seconds = next, .error = GOOD },
                                    &(noc_progress){ goes_on, a });
        spent += next;
        next = fmin(2 * next, 1.5);
        if (status)
            break;
        bool last = spent >= MOST_SECONDS || is_good(ranking);
        tell(a, q, ranking, about, last ? 1 : spent / MOST_SECONDS);
        told = true;
        if (last)
            break;
    }
    if (status == NOC_ERR_CANCELLED && told) /* who has enough may save what there is */
        ask_keep(a, q->id, csv_of(a, ranking, about));
    else if (status && status != NOC_ERR_CANCELLED)
        ask_refuse(a, q, *a->wrong ? a->wrong : noc_status_text(status));
    noc_ranking_destroy(ranking);
}

/* ---- places ---- */

/* The command that asks the same. camera: where pixels say the region; else NULL. */
static void add_command(const asker *a, const question *q, const char *region, const noc_camera *camera,
                        const noc_region_params *of, json_t *about) {
    char *line =
        out_influence(a->source, a->world, &q->view.render, region, camera, of ? of->width : 0, of ? of->height : 0);
    if (line)
        json_object_set_new(about, "command", wire_text(line));
    free(line);
}

/* A place of the scene in the CRS that its coordinates are asked in: that of the scene, where it has one. */
static void to_asked(const asker *a, double place[3]) {
    noc_scene_info info;
    noc_scene_get_info(world_scene(a->world), &info);
    if (*info.given_crs)
        noc_scene_from_local(world_scene(a->world), NULL, place);
}

static void add_point_command(const asker *a, const question *q, const noc_hit *hit, json_t *about) {
    double p[3] = { hit->place[0], hit->place[1], hit->place[2] };
    const double *n = hit->normal;
    char region[240];
    to_asked(a, p);
    snprintf(region, sizeof(region), "point:%.12g,%.12g,%.9g,%.9g,%.9g,%.9g", p[0], p[1], p[2], n[0], n[1], n[2]);
    add_command(a, q, region, NULL, NULL, about);
}

static json_t *about_hit(const asker *a, const noc_hit *hit) {
    const char *object = hit->object < 0 ? NULL : noc_scene_object_name(world_scene(a->world), (size_t)hit->object);
    json_t *about = json_object();
    json_object_set_new(about, "place", ask_place(hit->place));
    json_t *crs = ask_crs(a, hit->place);
    if (crs)
        json_object_set_new(about, "crs", crs);
    json_object_set_new(about, "class", json_string(noc_class_name(hit->cls)));
    if (object)
        json_object_set_new(about, "object", wire_text(object));
    const char *street = ask_street_of(a, hit);
    if (street)
        json_object_set_new(about, "street", wire_text(street));
    if (hit->light >= 0)
        json_object_set_new(about, "light", json_integer(hit->light));
    return about;
}

/* What the pixel sees, and its ray and the one below it. */
static noc_status cast(asker *a, const question *q, noc_hit *hit, noc_ray ray[2]) {
    const ask_view *v = &q->view;
    noc_status status = NOC_OK;
    for (int i = 0; i < 2 && !status; i++)
        status = noc_camera_ray(&v->camera, v->width, v->height,
                                (double[2]){ q->ask.x * v->width, q->ask.y * v->height + i }, &ray[i]);
    return status ? status : noc_view_cast(a->ask_view, ray, 1, hit);
}

void ask_pixel(asker *a, const question *q) {
    noc_hit hit;
    noc_ray ray[2];
    noc_status status = cast(a, q, &hit, ray);
    if (status || !hit.hit) { /* the sky has no place */
        if (status)
            ask_refuse(a, q, noc_status_text(status));
        else
            ask_send(a, q, ask_begin(q, 1));
        return;
    }
    noc_patch patch = noc_hit_patch(&hit, 1, &ray[0], &ray[1]);
    noc_region *region = noc_region_create(a->log);
    json_t *about = about_hit(a, &hit);
    add_point_command(a, q, &hit, about);
    if (region && !noc_region_add(region, &patch, 1))
        rank(a, q, region, about);
    else
        ask_refuse(a, q, *a->wrong ? a->wrong : "there is no memory for it");
    json_decref(about);
    noc_region_destroy(region);
}

/* A polygon of the map as WKT, in the CRS that the scene's coordinates are asked in. */
static void write_polygon(FILE *out, const asker *a, const wire_ask *ask) {
    fputs("polygon:POLYGON((", out);
    for (int i = 0; i <= ask->points; i++) {
        const double *p = ask->point[i % ask->points];
        double there[3] = { p[0], p[1], 0 };
        to_asked(a, there);
        fprintf(out, "%s%.12g %.12g", i ? ", " : "", there[0], there[1]);
    }
    fputs("))", out);
}

/* The region as nocturne influence --region says it. */
static char *words_of(const asker *a, const wire_ask *ask, int w, int h) {
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    if (!out)
        return NULL;
    if (ask->has_rect) {
        const double *r = ask->rect;
        int x0 = (int)fmax(0, floor(fmin(r[0], r[2]) * w)), x1 = (int)fmin(w - 1, ceil(fmax(r[0], r[2]) * w) - 1);
        int y0 = (int)fmax(0, floor(fmin(r[1], r[3]) * h)), y1 = (int)fmin(h - 1, ceil(fmax(r[1], r[3]) * h) - 1);
        fprintf(out, "rect:%d,%d,%d,%d", x0, y0, x1 < x0 ? x0 : x1, y1 < y0 ? y0 : y1);
    } else if (ask->points) {
        write_polygon(out, a, ask);
    } else {
        fprintf(out, ask->street ? "street:%s" : "object:%s", ask->street ? ask->street : ask->object);
    }
    return fclose(out) ? (free(text), NULL) : text;
}

/* Of a picture with so few pixels that a rectangle of it asks for few rays. */
static noc_region *find(asker *a, const question *q, json_t *about) {
    double w = q->view.width, h = q->view.height, scale = fmin(1, sqrt(MOST_PIXELS / (w * h)));
    noc_region_params params = { .camera = &q->view.camera,
                                 .width = (int)fmax(1, w * scale),
                                 .height = (int)fmax(1, h * scale) };
    char *words = words_of(a, &q->ask, params.width, params.height);
    noc_region *region = words ? noc_region_find(a->ask_view, world_scene(a->world), words, &params, a->log) : NULL;
    if (region)
        add_command(a, q, words, q->ask.has_rect ? &q->view.camera : NULL, &params, about);
    free(words);
    return region;
}

/* ---- outlines ---- */

enum { OUTLINE = 96, ROADS = 64 }; /* points of a ring, about; roads of a street that are outlined */

/* Ray number i of count along the outline of what was asked. */
static bool outline_ray(const question *q, double top, int i, int count, noc_ray *ray) {
    const wire_ask *ask = &q->ask;
    double way = (double)i / count * (ask->has_rect ? 4 : ask->points), along = way - floor(way);
    int side = (int)way;
    if (ask->has_rect) {
        const double *r = ask->rect, x[] = { r[0], r[2], r[2], r[0], r[0] }, y[] = { r[1], r[1], r[3], r[3], r[1] };
        double at[2] = { (x[side] + along * (x[side + 1] - x[side])) * q->view.width,
                         (y[side] + along * (y[side + 1] - y[side])) * q->view.height };
        return !noc_camera_ray(&q->view.camera, q->view.width, q->view.height, at, ray);
    }
    const double *from = ask->point[side], *to = ask->point[(side + 1) % ask->points];
    *ray = (noc_ray){ { from[0] + along * (to[0] - from[0]), from[1] + along * (to[1] - from[1]), top },
                      { 0, 0, -1 },
                      INFINITY };
    return true;
}

/* Where the outline of a rectangle or a polygon lies in the scene. */
static json_t *drawn_ring(asker *a, const question *q) {
    int sides = q->ask.has_rect ? 4 : q->ask.points, count = sides ? sides * (1 + OUTLINE / sides) : 0;
    noc_ray *rays = calloc((size_t)count + 1, sizeof(*rays));
    noc_hit *hits = calloc((size_t)count + 1, sizeof(*hits));
    noc_scene_info info;
    noc_scene_get_info(world_scene(a->world), &info);
    bool there = count && rays && hits;
    for (int i = 0; there && i < count; i++)
        there = outline_ray(q, info.bounds_max[2] + 100, i, count, &rays[i]);
    json_t *list = there && !noc_view_cast(a->ask_view, rays, (size_t)count, hits) ? json_array() : NULL;
    for (int i = 0; list && i < count; i++)
        if (hits[i].hit) /* the sky has no place */
            json_array_append_new(list, ask_place(hits[i].place));
    free(rays);
    free(hits);
    return list;
}

/* The convex outline of an object, at its lowest height. */
static json_t *object_ring(const noc_region *region) {
    double corner[OUTLINE / 2][3];
    size_t count = noc_region_outline(region, corner, OUTLINE / 2);
    json_t *list = json_array();
    for (size_t i = 0; i < count; i++)
        json_array_append_new(list, ask_place(corner[i]));
    return list;
}

/* So far to the left of point i of a road, on the ground. */
static json_t *beside_road(asker *a, const noc_street *s, size_t i, double left) {
    const float *p = s->points + 2 * i, *from = i ? p - 2 : p, *to = i + 1 < s->point_count ? p + 2 : p;
    double d[2] = { (double)to[0] - from[0], (double)to[1] - from[1] }, length = fmax(hypot(d[0], d[1]), 1e-9);
    double at[3] = { p[0] - left * d[1] / length, p[1] + left * d[0] / length, 0 };
    noc_hit hit;
    if (!noc_scene_ground(world_scene(a->world), at[0], at[1], &at[2]) && ask_top(a, at, &hit))
        at[2] = hit.place[2];
    return ask_place(at);
}

/* Up one side of a road and down the other, by every `step`th point and the last. */
static json_t *road_ring(asker *a, const noc_street *s) {
    size_t sides = s->point_count - 1, step = 1 + sides / (OUTLINE / 2), told = (sides + step - 1) / step + 1;
    double half = s->width / 2 + ASK_PAVEMENT;
    json_t *list = json_array();
    for (size_t k = 0; k < 2 * told; k++) {
        size_t i = k < told ? k : 2 * told - 1 - k;
        i = i * step < sides ? i * step : sides;
        json_array_append_new(list, beside_road(a, s, i, k < told ? half : -half));
    }
    return list;
}

/* Rings around what was asked. */
static json_t *outline_of(asker *a, const question *q, const noc_region *region) {
    json_t *list = json_array();
    noc_street s;
    if (q->ask.object)
        json_array_append_new(list, object_ring(region));
    else if (!q->ask.street)
        json_array_append_new(list, drawn_ring(a, q));
    for (size_t i = 0; q->ask.street && noc_scene_get_street(world_scene(a->world), i, &s); i++)
        if (s.point_count > 1 && json_array_size(list) < ROADS &&
            (!strcmp(s.name, q->ask.street) || !strcmp(s.id, q->ask.street)))
            json_array_append_new(list, road_ring(a, &s));
    return list;
}

void ask_region(asker *a, const question *q) {
    json_t *about = json_object();
    noc_region *region = find(a, q, about);
    if (!region) {
        json_decref(about);
        ask_refuse(a, q, *a->wrong ? a->wrong : "there is no memory for it");
        return;
    }
    noc_region_info info;
    noc_region_get_info(region, &info);
    json_t *outline = outline_of(a, q, region), *crs = ask_crs(a, info.centre);
    json_object_set_new(about, "place", ask_place(info.centre));
    if (crs)
        json_object_set_new(about, "crs", crs);
    json_object_set_new(about, "outline", outline);
    if (!q->ask.has_rect)
        json_object_set_new(about, "area", ask_number(info.weight));
    rank(a, q, region, about);
    json_decref(about);
    noc_region_destroy(region);
}
