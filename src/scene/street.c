/* Streets by name: the middle lines of roads that maps name. They are asked for, and nothing else depends on them. */
#include "scene/keep.h"

#include <nocturne/influence.h>

bool noc_scene_add_street(noc_scene *s, const noc_scene_street *street, const double *xyz, size_t count) {
    noc_scene_street kept = *street;
    kept.first = (uint32_t)(s->street_points.len / 2);
    kept.count = (uint32_t)count;
    if (!noc_scene_keep_name(s, street->name, &kept.name) || !noc_scene_keep_name(s, street->id, &kept.id))
        return false;
    if (!array_reserve(&s->street_points, s->street_points.len + 2 * count) || !array_push(&s->streets, kept)) {
        noc_scene_out_of_memory(s);
        return false;
    }
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 2; k++)
            s->street_points.data[s->street_points.len++] = (float)xyz[3 * i + k];
    return true;
}

size_t noc_scene_streets(const noc_scene *s) { return s ? s->streets.len : 0; }

bool noc_scene_get_street(const noc_scene *s, size_t index, noc_street *out) {
    if (!s || !out || index >= s->streets.len)
        return false;
    const noc_scene_street *of = &s->streets.data[index];
    *out = (noc_street){ .name = of->name ? of->name : "",
                         .id = of->id ? of->id : "",
                         .width = of->width,
                         .point_count = of->count,
                         .points = s->street_points.data + 2 * (size_t)of->first };
    return true;
}

/* ---- in a built city ---- */

typedef struct kept_street {
    uint32_t name, id, first, count;
    float width;
} kept_street;

void noc_keep_streets(noct_writer *w, const noc_scene *s) {
    noct_begin(w, "streets");
    for (size_t i = 0; i < s->streets.len; i++) {
        const noc_scene_street *of = &s->streets.data[i];
        noct_put(w, &(kept_street){ noct_name(w, of->name), noct_name(w, of->id), of->first, of->count, of->width },
                 sizeof(kept_street));
    }
    noct_end(w);
    noct_put_array(w, "middles", s->street_points.data, s->street_points.len / 2, 2 * sizeof(float));
}

noc_status noc_kept_streets(noct_file *f, noc_scene *s) {
    size_t count, points;
    const kept_street *k = noct_array(f, "streets", sizeof(*k), &count);
    float *xy = noct_array(f, "middles", 2 * sizeof(*xy), &points);
    if (f->status)
        return f->status;
    if (!noc_kept_finite(xy, 2 * points, 1e7f))
        return noct_wrong(f, "its streets lie nowhere");
    if (!array_reserve(&s->streets, count))
        return noct_no_memory(f);
    array_borrow(&s->street_points, xy, 2 * points);
    for (size_t i = 0; i < count; i++) {
        if (k[i].count < 2 || k[i].first > points || k[i].count > points - k[i].first ||
            !noc_kept_finite(&k[i].width, 1, 1e4f))
            return noct_wrong(f, "street %zu is none", i);
        s->streets.data[s->streets.len++] = (noc_scene_street){ noct_name_at(f, k[i].name), noct_name_at(f, k[i].id),
                                                                k[i].width, k[i].first, k[i].count };
    }
    return f->status;
}
