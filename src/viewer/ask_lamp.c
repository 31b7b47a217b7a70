/* The card of a lamp: what is known of it, and what it lights. */
#include "viewer/ask_parts.h"

#include <nocturne/influence.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { OBJECTS = 12 }; /* that it lights most, which are told */

/* What the file of a lamp says of it. */
static json_t *tags_of(const char *tags) {
    json_t *list = json_object();
    while (*tags) {
        size_t n = strcspn(tags, "\n"), key = strcspn(tags, "=");
        char name[256], value[1024];
        if (key < n) {
            snprintf(name, sizeof(name), "%.*s", (int)key, tags);
            snprintf(value, sizeof(value), "%.*s", (int)(n - key - 1), tags + key + 1);
            json_t *known = json_string(name); /* a key must be UTF-8, too */
            if (known)
                json_object_set_new(list, name, wire_text(value));
            json_decref(known);
        }
        tags += n + (tags[n] == '\n');
    }
    return list;
}

/* m over what is below it, its own post left out; NaN: nothing is. */
static double height_of(asker *a, const double centre[3]) {
    double from = centre[2];
    for (int i = 0; i < 64; i++) {
        noc_ray ray = { { centre[0], centre[1], from }, { 0, 0, -1 }, INFINITY };
        noc_hit hit;
        if (noc_view_cast(a->ask_view, &ray, 1, &hit) || !hit.hit)
            return NAN;
        if (hit.cls != NOC_CLASS_LAMP)
            return centre[2] - hit.place[2];
        from = hit.place[2] - 1e-3;
    }
    return NAN;
}

static void add_report(const asker *a, const question *q, json_t *m) {
    const noc_report_lamp *lamp = noc_report_find_lamp(world_report(a->world), q->ask.light);
    if (!lamp)
        return;
    if (isfinite(lamp->height))
        json_object_set_new(m, "height", json_real(lamp->height));
    json_object_set_new(m, "file", wire_text(lamp->file));
    json_object_set_new(m, "street", wire_text(lamp->street));
    json_object_set_new(m, "profile", wire_text(lamp->profile));
    json_object_set_new(m, "watts", ask_number(lamp->watts));
    json_object_set_new(m, "tags", tags_of(lamp->tags));
}

/* As nocturne influence --lamp tells it. */
static json_t *reach_of(const noc_reach *r, const noc_reach_object *objects, size_t count) {
    json_t *reach = json_object(), *list = json_array();
    json_object_set_new(reach, "area", ask_number(r->area));
    json_object_set_new(reach, "most", ask_number(r->most));
    json_object_set_new(reach, "most_place", ask_place(r->most_place));
    json_object_set_new(reach, "far", ask_number(r->far));
    if (r->far > 0)
        json_object_set_new(reach, "far_place", ask_place(r->far_place));
    json_object_set_new(reach, "met", ask_number(r->met));
    json_object_set_new(reach, "objects", json_integer((json_int_t)r->objects));
    for (size_t i = 0; i < count; i++) {
        json_t *one = json_object();
        json_object_set_new(one, "name", wire_text(objects[i].name));
        json_object_set_new(one, "class", json_string(noc_class_name(objects[i].cls)));
        json_object_set_new(one, "lumens", ask_number(objects[i].lumens));
        json_array_append_new(list, one);
    }
    json_object_set_new(reach, "most_lit", list);
    return reach;
}

/* What is known comes at once, and what it lights when its rays are back: some 0.1 s. */
void ask_lamp(asker *a, const question *q) {
    noc_scene_info info;
    noc_light_info l;
    noc_reach reach;
    noc_reach_object objects[OBJECTS];
    size_t found = 0;
    noc_scene_get_info(world_scene(a->world), &info);
    if (q->ask.light >= info.light_slots || noc_scene_get_light(world_scene(a->world), q->ask.light, &l) || l.removed) {
        ask_refuse(a, q, "there is no such light");
        return;
    }
    json_t *m = ask_begin(q, 0.5), *crs = ask_crs(a, l.centre);
    json_object_set_new(m, "light", json_integer((json_int_t)q->ask.light));
    json_object_set_new(m, "name", wire_text(l.light.name ? l.light.name : ""));
    json_object_set_new(m, "kind", json_string(ask_light_kind(&l)));
    json_object_set_new(m, "place", ask_place(l.centre));
    if (crs)
        json_object_set_new(m, "crs", crs);
    json_object_set_new(m, "lumens", ask_number(l.lumens));
    json_object_set_new(m, "kelvin", ask_number(noc_rgb_kelvin(l.light.emission)));
    json_object_set_new(m, "height", ask_number(height_of(a, l.centre)));
    json_object_set_new(m, "group", wire_text(world_group_name(a->world, l.light.group)));
    add_report(a, q, m);
    json_t *whole = json_copy(m);
    ask_send(a, q, m);
    if (!whole || ask_stopped(a)) {
        json_decref(whole);
        return;
    }
    json_object_set_new(whole, "done", json_real(1));
    if (!noc_view_reach(a->ask_view, q->ask.light, NULL, &reach, objects, OBJECTS, &found))
        json_object_set_new(whole, "reach", reach_of(&reach, objects, found));
    ask_send(a, q, whole);
}
