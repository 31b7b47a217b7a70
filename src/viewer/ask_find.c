/* What is called so, and what things are called: search by name, and the name of what a pointer is over. */
#include "viewer/ask_parts.h"

#include <nocturne/influence.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FOUND = 12 };     /* of each kind, that are told */
#define PAVEMENT 4.0     /* m beside a carriageway that belong to its street */
#define FROM_ABOVE 100.0 /* m over the scene */

/* ---- search ---- */

/* A byte of a name without its case: ASCII, and letters of Latin-1 behind their first byte in UTF-8. */
static unsigned char folded(const char *text, size_t i) {
    unsigned char c = (unsigned char)text[i];
    bool latin = i && (unsigned char)text[i - 1] == 0xc3 && c >= 0x80 && c <= 0x9e && c != 0x97;
    return c >= 'A' && c <= 'Z' ? c + 32 : latin ? c | 0x20 : c;
}

/* 0: it is the name; 1: the name begins with it; 2: it is in the name; -1: it is not. */
static int rank_of(const char *name, const char *text) {
    size_t size = strlen(text), most = strlen(name);
    for (size_t from = 0; size && from + size <= most; from++) {
        size_t i = 0;
        while (i < size && folded(name + from, i) == folded(text, i))
            i++;
        if (i == size)
            return from ? 2 : size < most;
    }
    return -1;
}

/* The best of one kind, in the scene's order among equals. */
typedef struct matches {
    struct match {
        const char *name;
        size_t index;
        int rank;
    } best[FOUND];
    size_t count, all;
} matches;

static void offer(matches *m, const char *name, size_t index, const char *text) {
    int rank = name ? rank_of(name, text) : -1;
    size_t at = m->count;
    if (rank < 0)
        return;
    m->all++;
    while (at && m->best[at - 1].rank > rank)
        at--;
    if (at == FOUND)
        return;
    m->count += m->count < FOUND;
    memmove(m->best + at + 1, m->best + at, (m->count - at - 1) * sizeof(*m->best));
    m->best[at] = (struct match){ name, index, rank };
}

static json_t *add_found(json_t *list, const char *kind, const char *name) {
    json_t *one = json_object();
    json_object_set_new(one, "kind", json_string(kind));
    json_object_set_new(one, "name", wire_text(name));
    json_array_append_new(list, one);
    return one;
}

static size_t find_groups(const asker *a, const char *text, json_t *list) {
    matches m = { 0 };
    const noc_group_info *g;
    for (size_t i = 0; (g = noc_report_get_group(world_report(a->world), i)); i++)
        offer(&m, g->name, i, text);
    for (size_t i = 0; i < m.count; i++)
        add_found(list, "group", m.best[i].name);
    return m.all - m.count;
}

static int by_name(const void *a, const void *b) { return strcmp(*(const char *const *)a, *(const char *const *)b); }

/* Several roads make a street. */
static size_t find_streets(const asker *a, const char *text, json_t *list) {
    matches m = { 0 };
    noc_street s;
    size_t count = 0, kept = 0;
    while (noc_scene_get_street(world_scene(a->world), count, &s))
        count++;
    const char **names = malloc((count + 1) * sizeof(*names));
    for (size_t i = 0; names && i < count && !ask_stopped(a); i++)
        if (noc_scene_get_street(world_scene(a->world), i, &s) && rank_of(s.name, text) >= 0)
            names[kept++] = s.name;
    if (names)
        qsort(names, kept, sizeof(*names), by_name);
    for (size_t i = 0; i < kept; i++)
        if (!i || strcmp(names[i - 1], names[i]) != 0)
            offer(&m, names[i], i, text);
    free(names);
    for (size_t i = 0; i < m.count; i++)
        add_found(list, "street", m.best[i].name);
    return m.all - m.count;
}

static size_t find_objects(const asker *a, const char *text, json_t *list) {
    matches m = { 0 };
    size_t slots = noc_scene_object_slots(world_scene(a->world));
    for (size_t i = 0; i < slots && !ask_stopped(a); i++)
        offer(&m, noc_scene_object_name(world_scene(a->world), i), i, text);
    for (size_t i = 0; i < m.count; i++)
        add_found(list, "object", m.best[i].name);
    return m.all - m.count;
}

/* The lights of one lamp follow one another and share its name. */
static size_t find_lamps(const asker *a, const char *text, json_t *list) {
    matches m = { 0 };
    noc_scene_info info;
    const char *last = NULL;
    noc_scene_get_info(world_scene(a->world), &info);
    for (size_t i = 0; i < info.light_slots && !ask_stopped(a); i++) {
        noc_light_info l;
        if (noc_scene_get_light(world_scene(a->world), i, &l) || l.removed || !l.lamp || !l.light.name)
            continue;
        if (!last || strcmp(last, l.light.name))
            offer(&m, l.light.name, i, text);
        last = l.light.name;
    }
    for (size_t i = 0; i < m.count; i++) {
        noc_light_info l;
        json_t *one = add_found(list, "lamp", m.best[i].name);
        json_object_set_new(one, "light", json_integer((json_int_t)m.best[i].index));
        if (!noc_scene_get_light(world_scene(a->world), m.best[i].index, &l))
            json_object_set_new(one, "place", ask_place(l.centre));
    }
    return m.all - m.count;
}

void ask_find(asker *a, const question *q) {
    json_t *m = ask_begin(q, 1), *list = json_array();
    size_t more = find_streets(a, q->ask.text, list);
    more += find_objects(a, q->ask.text, list);
    more += find_lamps(a, q->ask.text, list);
    more += find_groups(a, q->ask.text, list);
    json_object_set_new(m, "found", list);
    json_object_set_new(m, "more", json_integer((json_int_t)more));
    ask_send(a, q, m);
}

/* ---- names ---- */

bool ask_top(asker *a, const double at[2], noc_hit *hit) {
    noc_scene_info info;
    noc_scene_get_info(world_scene(a->world), &info);
    noc_ray ray = { { at[0], at[1], info.bounds_max[2] + FROM_ABOVE }, { 0, 0, -1 }, INFINITY };
    return !noc_view_cast(a->ask_view, &ray, 1, hit) && hit->hit;
}

/* m from a line; its width does not count. */
static double beside(const noc_street *s, const double at[2]) {
    double least = INFINITY;
    for (size_t i = 0; i + 1 < s->point_count; i++) {
        const float *p = s->points + 2 * i;
        double d[2] = { (double)p[2] - p[0], (double)p[3] - p[1] }, v[2] = { at[0] - p[0], at[1] - p[1] };
        double length = d[0] * d[0] + d[1] * d[1];
        double t = length > 0 ? fmin(1, fmax(0, (d[0] * v[0] + d[1] * v[1]) / length)) : 0;
        least = fmin(least, hypot(v[0] - t * d[0], v[1] - t * d[1]));
    }
    return least;
}

const char *ask_street_of(const asker *a, const noc_hit *hit) {
    const char *name = NULL;
    double best = INFINITY;
    noc_street s;
    bool paved = hit->cls == NOC_CLASS_ROAD || hit->cls == NOC_CLASS_SIDEWALK || hit->cls == NOC_CLASS_BRIDGE;
    if (!paved && hit->cls != NOC_CLASS_TERRAIN && hit->cls != NOC_CLASS_GROUND && hit->cls != NOC_CLASS_OTHER)
        return NULL;
    for (size_t i = 0; noc_scene_get_street(world_scene(a->world), i, &s); i++) {
        double away = beside(&s, hit->place) - s.width / 2;
        if (away > (paved ? PAVEMENT : 0) || away >= best)
            continue;
        best = away;
        name = s.name;
    }
    return name;
}

/* Somewhere on it: on its roof, or where its middle is. */
static bool place_object(asker *a, const char *id, double place[3]) {
    noc_region *region = noc_region_create(a->log);
    noc_region_info info;
    noc_hit hit;
    bool there = region && !noc_region_add_object(region, world_scene(a->world), id, 0);
    if (there) {
        noc_region_get_info(region, &info);
        memcpy(place, ask_top(a, info.centre, &hit) ? hit.place : info.centre, sizeof(info.centre));
    }
    noc_region_destroy(region);
    return there;
}

/* The middle of its longest road. */
static bool place_street(asker *a, const char *name, double place[3]) {
    noc_street s, longest = { 0 };
    noc_hit hit;
    for (size_t i = 0; noc_scene_get_street(world_scene(a->world), i, &s); i++)
        if (!strcmp(s.name, name) && s.point_count > longest.point_count)
            longest = s;
    if (!longest.point_count)
        return false;
    const float *middle = longest.points + 2 * (longest.point_count / 2);
    place[0] = middle[0];
    place[1] = middle[1];
    place[2] = 0;
    if (ask_top(a, place, &hit))
        place[2] = hit.place[2];
    return true;
}

static bool name_light(asker *a, const question *q, json_t *m) {
    noc_scene_info info;
    noc_light_info l;
    noc_scene_get_info(world_scene(a->world), &info);
    if (q->ask.light >= info.light_slots || noc_scene_get_light(world_scene(a->world), q->ask.light, &l) || l.removed)
        return false;
    json_object_set_new(m, "light", json_integer((json_int_t)q->ask.light));
    json_object_set_new(m, "name", wire_text(l.light.name ? l.light.name : ""));
    json_object_set_new(m, "kind", json_string(ask_light_kind(&l)));
    json_object_set_new(m, "lumens", ask_number(l.lumens));
    json_object_set_new(m, "place", ask_place(l.centre));
    return true;
}

static bool name_there(asker *a, const question *q, json_t *m) {
    noc_hit hit;
    if (!ask_top(a, q->ask.at, &hit))
        return false;
    const char *object = hit.object < 0 ? NULL : noc_scene_object_name(world_scene(a->world), (size_t)hit.object);
    const char *street = ask_street_of(a, &hit);
    json_object_set_new(m, "class", json_string(noc_class_name(hit.cls)));
    json_object_set_new(m, "building", json_boolean(ask_of_building((uint8_t)hit.cls)));
    json_object_set_new(m, "place", ask_place(hit.place));
    if (object)
        json_object_set_new(m, "object", wire_text(object));
    if (street)
        json_object_set_new(m, "street", wire_text(street));
    return true;
}

void ask_name(asker *a, const question *q) {
    json_t *m = ask_begin(q, 1);
    double place[3];
    bool there = q->ask.has_light ? name_light(a, q, m)
                 : q->ask.has_at  ? name_there(a, q, m)
                 : q->ask.street  ? place_street(a, q->ask.street, place)
                                  : place_object(a, q->ask.object, place);
    if (!there) {
        json_decref(m);
        ask_refuse(a, q, "nothing of that name is there");
        return;
    }
    if (!q->ask.has_light && !q->ask.has_at)
        json_object_set_new(m, "place", ask_place(place));
    ask_send(a, q, m);
}
