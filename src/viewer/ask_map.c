/* All lights, streets and buildings for the map; the camera of a photograph. */
#include "viewer/ask_parts.h"
#include "viewer/option.h"

#include <math.h>
#include <nocturne/map.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_LIGHTS = 100000, MOST_CARS = 20000, MOST_STOPS = 200000 };
enum { SECTION_LIGHTS = 1, SECTION_CARS, SECTION_TRACKS, SECTION_BUILDINGS = 5, SECTION_STREETS, SECTION_NAMES };
enum { LIGHT_BYTES = 24, CAR_BYTES = 16, STOP_BYTES = 12, MOST_CELLS = 512 /* along a side of the buildings */ };
enum { KIND_OTHER, KIND_MAPPED, KIND_INFERRED, KIND_WINDOW, KIND_CAR };

/* What the map calls a light. */
static int kind_of(const noc_light_info *l) {
    bool flat = l->light.kind == NOC_LIGHT_TRIANGLE || l->light.kind == NOC_LIGHT_PARALLELOGRAM;
    if (l->light.moving)
        return KIND_CAR;
    if (l->lamp)
        return l->light.inferred ? KIND_INFERRED : KIND_MAPPED;
    return flat ? KIND_WINDOW : KIND_OTHER;
}

const char *ask_light_kind(const noc_light_info *light) {
    static const char *const names[] = { "other", "lamp", "inferred", "window", "car" };
    return names[kind_of(light)];
}

static void put_light(unsigned char *out, const noc_light_info *l, size_t index) {
    for (int k = 0; k < 3; k++)
        wire_put_f32(out + 4 * k, (float)l->centre[k]);
    wire_put_f32(out + 12, (float)l->lumens);
    const float *e = l->light.emission;
    viewer_colour((double[3]){ e[0], e[1], e[2] }, out + 16);
    out[19] = (unsigned char)kind_of(l);
    wire_put_u32(out + 20, (uint32_t)index);
}

/* The message as it grows. */
typedef struct map {
    unsigned char *data; /* NULL: memory was refused */
    size_t size, room;
} map;

static unsigned char *more(map *m, size_t bytes) {
    if (m->data && m->size + bytes > m->room) {
        m->room = 2 * (m->size + bytes);
        unsigned char *grown = realloc(m->data, m->room);
        if (!grown)
            free(m->data);
        m->data = grown;
    }
    m->size += bytes;
    return m->data ? m->data + m->size - bytes : NULL;
}

/* A section whose records are to follow: its count is written where it ends. */
static size_t begin_section(map *m, uint32_t kind) {
    unsigned char *at = more(m, 8);
    if (at)
        wire_put_u32(at, kind);
    return m->size;
}

static void end_section(const map *m, size_t from, size_t record) {
    if (m->data)
        wire_put_u32(m->data + from - 4, (uint32_t)((m->size - from) / record));
}

/* Lamps first, then all others, as far as there is room: a map shows so many. */
static void add_lights(const asker *a, map *m, size_t slots) {
    size_t from = begin_section(m, SECTION_LIGHTS), count = 0;
    for (int pass = 0; pass < 2; pass++)
        for (size_t i = 0; i < slots && count < MOST_LIGHTS && !ask_stopped(a); i++) {
            noc_light_info l;
            if (noc_scene_get_light(world_scene(a->world), i, &l) || l.removed || !(l.lumens > 0) || l.lamp == pass)
                continue;
            unsigned char *at = more(m, LIGHT_BYTES);
            if (at)
                put_light(at, &l, i);
            count++;
        }
    end_section(m, from, LIGHT_BYTES);
}

static void add_cars(const asker *a, map *m, size_t cars) {
    size_t from = begin_section(m, SECTION_CARS);
    for (size_t i = 0; i < cars && i < MOST_CARS && !ask_stopped(a); i++) {
        noc_car_info car;
        unsigned char *at = noc_scene_get_car(world_scene(a->world), i, &car) ? NULL : more(m, CAR_BYTES);
        for (int k = 0; at && k < 3; k++)
            wire_put_f32(at + 4 * k, (float)car.place[k]);
        if (at)
            wire_put_f32(at + 12, (float)car.heading);
    }
    end_section(m, from, CAR_BYTES);
}

/* Each part of a track is a line. */
static void add_tracks(const asker *a, map *m) {
    static const size_t most = 2000; /* stops of one */
    noc_track_stop *stops = malloc(most * sizeof(*stops));
    size_t from = begin_section(m, SECTION_TRACKS), total = 0;
    uint32_t line = 0;
    for (size_t i = 0; stops && i < noc_scene_track_count(world_scene(a->world)) && total < MOST_STOPS; i++) {
        size_t count = noc_scene_get_track(world_scene(a->world), i, stops, most);
        line++;
        for (size_t k = 0; k < count && k < most && !ask_stopped(a); k++, total++) {
            unsigned char *at = more(m, STOP_BYTES);
            line += stops[k].begins && k;
            if (!at)
                break;
            wire_put_f32(at, (float)stops[k].place[0]);
            wire_put_f32(at + 4, (float)stops[k].place[1]);
            wire_put_u32(at + 8, line);
        }
    }
    free(stops);
    end_section(m, from, STOP_BYTES);
}

/* Middles of streets, each a line; then a name of each, ended by a 0. */
static void add_streets(const asker *a, map *m) {
    const noc_scene *scene = world_scene(a->world);
    size_t from = begin_section(m, SECTION_STREETS), total = 0, count = 0;
    noc_street s;
    for (; noc_scene_get_street(scene, count, &s) && total < MOST_STOPS && !ask_stopped(a); count++)
        for (size_t k = 0; k < s.point_count; k++, total++) {
            unsigned char *at = more(m, STOP_BYTES);
            if (!at)
                return;
            wire_put_f32(at, s.points[2 * k]);
            wire_put_f32(at + 4, s.points[2 * k + 1]);
            wire_put_u32(at + 8, (uint32_t)count);
        }
    end_section(m, from, STOP_BYTES);
    from = begin_section(m, SECTION_NAMES);
    for (size_t i = 0; i < count && noc_scene_get_street(scene, i, &s); i++) {
        unsigned char *at = more(m, strlen(s.name) + 1);
        if (at)
            memcpy(at, s.name, strlen(s.name) + 1);
    }
    end_section(m, from, 1);
}

static noc_status cast_down(void *user, const noc_ray *rays, size_t count, noc_hit *hits) {
    return noc_view_cast(user, rays, count, hits);
}

static bool goes_on(void *user, const char *what, double done) {
    (void)what, (void)done;
    return !ask_stopped(user);
}

bool ask_of_building(uint8_t cls) {
    return cls == NOC_CLASS_WALL || cls == NOC_CLASS_ROOF || cls == NOC_CLASS_WINDOW || cls == NOC_CLASS_DOOR ||
           cls == NOC_CLASS_INSTALLATION;
}

/* Where buildings are, as seen from above: a rectangle, its cells, and a byte of each from the north, 1: a building. */
static void add_buildings(asker *a, map *m, const noc_scene_info *info) {
    const double *low = info->bounds_min, *high = info->bounds_max;
    double wide = high[0] - low[0], deep = high[1] - low[1], cell = fmax(wide, deep) / MOST_CELLS;
    if (!(wide > 0 && deep > 0))
        return;
    noc_map_params p = { .min = { low[0], low[1] }, .max = { high[0], high[1] }, .from = INFINITY };
    p.width = (int)ceil(wide / cell);
    p.height = (int)ceil(deep / cell);
    p.width = p.width > MOST_CELLS ? MOST_CELLS : p.width;
    p.height = p.height > MOST_CELLS ? MOST_CELLS : p.height;
    size_t cells = (size_t)p.width * (size_t)p.height;
    uint8_t *cls = malloc(cells);
    noc_progress progress = { goes_on, a };
    if (cls && !noc_scene_map(world_scene(a->world), &p, cast_down, a->ask_view, &progress, NULL, cls, NULL)) {
        size_t from = begin_section(m, SECTION_BUILDINGS);
        unsigned char *at = more(m, 24 + cells);
        for (int k = 0; at && k < 2; k++) {
            wire_put_f32(at + 4 * k, (float)p.min[k]);
            wire_put_f32(at + 8 + 4 * k, (float)p.max[k]);
            wire_put_u32(at + 16 + 4 * k, (uint32_t)(k ? p.height : p.width));
        }
        for (size_t i = 0; at && i < cells; i++)
            at[24 + i] = ask_of_building(cls[i]);
        end_section(m, from, 1);
    }
    free(cls);
}

void ask_lights(asker *a, const question *q) {
    noc_scene_info info;
    noc_scene_get_info(world_scene(a->world), &info);
    map m = { malloc(OUTBOX_ROOM + WIRE_HEAD), OUTBOX_ROOM + WIRE_HEAD, OUTBOX_ROOM + WIRE_HEAD };
    if (!q->ask.moving) {
        add_lights(a, &m, info.light_slots);
        add_tracks(a, &m);
        add_streets(a, &m);
        add_buildings(a, &m, &info);
    }
    add_cars(a, &m, info.cars);
    if (!m.data) {
        ask_refuse(a, q, "there is no memory for it");
        return;
    }
    wire_write_head(&(wire_head){ .kind = WIRE_IS_LIGHTS, .number = q->id }, m.data + OUTBOX_ROOM);
    if (ask_stopped(a))
        free(m.data);
    else
        outbox_binary(a->box, q->id, m.data, m.size - OUTBOX_ROOM);
}

void ask_align(asker *a, const question *q) {
    enum { HEIGHT = 1000 };
    noc_camera_point points[WIRE_PAIRS];
    noc_camera camera = noc_camera_default();
    double width = fmax(1, HEIGHT * q->ask.aspect), residual;
    for (int i = 0; i < q->ask.pairs; i++) {
        memcpy(points[i].xyz, q->ask.place[i], sizeof(points[i].xyz));
        points[i].pixel[0] = q->ask.photo[i][0] * width;
        points[i].pixel[1] = q->ask.photo[i][1] * HEIGHT;
    }
    noc_status status =
        noc_camera_align(points, (size_t)q->ask.pairs, (int)lrint(width), HEIGHT, NULL, &camera, &residual, a->log);
    if (status) {
        ask_refuse(a, q, *a->wrong ? a->wrong : noc_status_text(status));
        return;
    }
    json_t *m = ask_begin(q, 1), *to = json_object();
    json_object_set_new(to, "eye", ask_place(camera.eye));
    json_object_set_new(to, "target", ask_place(camera.target));
    json_object_set_new(to, "fov", json_real(camera.fov_deg));
    json_object_set_new(m, "camera", to);
    json_object_set_new(m, "error", ask_number(residual / HEIGHT));
    ask_send(a, q, m);
    wire_message go = { .kind = WIRE_CAMERA };
    memcpy(go.camera.to.eye, camera.eye, sizeof(camera.eye));
    memcpy(go.camera.to.target, camera.target, sizeof(camera.target));
    go.camera.to.fov = camera.fov_deg;
    inbox_put(a->in, &go);
}
