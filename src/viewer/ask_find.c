/* What is called so, and what things are called: search by name, and the name of what a pointer is over. */
#include "viewer/ask_parts.h"

#include <nocturne/influence.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FOUND = 12 };     /* of each kind, that are told */
#define FROM_ABOVE 100.0 /* m over the scene */

/* ---- search ---- */

/* Names of one kind, and what each is the name of. */
typedef struct names {
    struct named {
        const char *name;
        size_t index;
        char *folded; /* NULL: not yet */
    } * of;
    size_t count, room;
} names;

static void add_name(names *list, const char *name, size_t index) {
    if (list->count == list->room) {
        size_t room = list->room ? 2 * list->room : 64;
        struct named *more = realloc(list->of, room * sizeof(*more));
        if (!more)
            return;
        list->of = more;
        list->room = room;
    }
    list->of[list->count++] = (struct named){ name, index, NULL };
}

static void free_names(names *list) {
    for (size_t i = 0; i < list->count; i++)
        free(list->of[i].folded);
    free(list->of);
}

static int by_name(const void *a, const void *b) {
    return strcmp(((const struct named *)a)->name, ((const struct named *)b)->name);
}

/* Several roads make a street. */
static void list_streets(const asker *a, names *list) {
    noc_street s;
    size_t kept = 0;
    for (size_t i = 0; noc_scene_get_street(world_scene(a->world), i, &s); i++)
        add_name(list, s.name, i);
    if (list->count)
        qsort(list->of, list->count, sizeof(*list->of), by_name);
    for (size_t i = 0; i < list->count; i++)
        if (!kept || strcmp(list->of[kept - 1].name, list->of[i].name) != 0)
            list->of[kept++] = list->of[i];
    list->count = kept;
}

/* The lights of one lamp follow one another and share its name. */
static void list_lamps(const asker *a, names *list) {
    noc_scene_info info;
    const char *last = NULL;
    noc_scene_get_info(world_scene(a->world), &info);
    for (size_t i = 0; i < info.light_slots && !ask_stopped(a); i++) {
        noc_light_info l;
        if (noc_scene_get_light(world_scene(a->world), i, &l) || l.removed || !l.lamp || !l.light.name)
            continue;
        if (!last || strcmp(last, l.light.name))
            add_name(list, l.light.name, i);
        last = l.light.name;
    }
}

/* The body of a lamp is no object of its own. */
static void list_objects(const asker *a, names *list) {
    names lamps = { 0 };
    list_lamps(a, &lamps);
    if (lamps.count)
        qsort(lamps.of, lamps.count, sizeof(*lamps.of), by_name);
    size_t slots = noc_scene_object_slots(world_scene(a->world));
    for (size_t i = 0; i < slots && !ask_stopped(a); i++) {
        struct named one = { noc_scene_object_name(world_scene(a->world), i), i, NULL };
        if (one.name && !(lamps.count && bsearch(&one, lamps.of, lamps.count, sizeof(one), by_name)))
            add_name(list, one.name, i);
    }
    free_names(&lamps);
}

static void list_groups(const asker *a, names *list) {
    const noc_group_info *g;
    for (size_t i = 0; (g = noc_report_get_group(world_report(a->world), i)); i++)
        add_name(list, g->name, i);
}

static const struct {
    const char *kind;
    void (*list)(const asker *a, names *list);
} kinds[] = {
    { "street", list_streets }, { "object", list_objects }, { "lamp", list_lamps }, { "group", list_groups }
};
enum { KINDS = sizeof(kinds) / sizeof(*kinds), LAMPS = 2 };

/* 0: it is the name; 1: the name begins with it; 2: it is in the name; -1: it is not. Both are folded. */
static int rank_of(const char *name, const char *text) {
    const char *at = *text ? strstr(name, text) : NULL;
    return !at ? -1 : at != name ? 2 : name[strlen(text)] ? 1 : 0;
}

/* The best of one kind, in their order among equals. */
typedef struct matches {
    struct match {
        const struct named *of;
        int rank;
    } best[FOUND];
    size_t count, all;
} matches;

static void offer(matches *m, const struct named *of, const char *text) {
    int rank = of->folded ? rank_of(of->folded, text) : -1;
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
    m->best[at] = (struct match){ of, rank };
}

static void add_found(const asker *a, json_t *list, int kind, const struct named *of) {
    json_t *one = json_object();
    noc_light_info l;
    json_object_set_new(one, "kind", json_string(kinds[kind].kind));
    json_object_set_new(one, "name", wire_text(of->name));
    if (kind == LAMPS) {
        json_object_set_new(one, "light", json_integer((json_int_t)of->index));
        if (!noc_scene_get_light(world_scene(a->world), of->index, &l))
            json_object_set_new(one, "place", ask_place(l.centre));
    }
    json_array_append_new(list, one);
}

/* The best of a kind are added to the list; how many more there are. */
static size_t find_kind(const asker *a, int kind, names *of, const char *text, json_t *list) {
    matches m = { 0 };
    for (size_t i = 0; i < of->count && !ask_stopped(a); i++) {
        of->of[i].folded = noc_text_fold(of->of[i].name, true);
        offer(&m, &of->of[i], text);
    }
    for (size_t i = 0; i < m.count; i++)
        add_found(a, list, kind, m.best[i].of);
    return m.all - m.count;
}

/* The name of a kind that may have been meant. */
static void add_nearest(const asker *a, int kind, const names *of, const char *text, json_t *list) {
    const char **folded = malloc((of->count + 1) * sizeof(*folded));
    for (size_t i = 0; folded && i < of->count; i++)
        folded[i] = of->of[i].folded ? of->of[i].folded : "";
    const char *nearest = folded && !ask_stopped(a) ? noc_text_nearest(text, folded, of->count) : NULL;
    for (size_t i = 0; nearest && i < of->count; i++)
        if (folded[i] == nearest) {
            add_found(a, list, kind, &of->of[i]);
            break;
        }
    free(folded);
}

void ask_find(asker *a, const question *q) {
    json_t *m = ask_begin(q, 1), *found = json_array(), *near = json_array();
    names of[KINDS] = { 0 };
    char *text = noc_text_fold(q->ask.text, false);
    size_t more = 0;
    for (int k = 0; k < KINDS && text && *text; k++) {
        kinds[k].list(a, &of[k]);
        more += find_kind(a, k, &of[k], text, found);
    }
    for (int k = 0; k < KINDS && text && *text && !json_array_size(found); k++)
        add_nearest(a, k, &of[k], text, near);
    for (int k = 0; k < KINDS; k++)
        free_names(&of[k]);
    free(text);
    json_object_set_new(m, "found", found);
    json_object_set_new(m, "near", near);
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
        if (away > (paved ? ASK_PAVEMENT : 0) || away >= best)
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
