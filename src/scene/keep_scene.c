/* The scene as a whole, its groups of lights, and its profiles. */
#include "scene/keep.h"

#include <math.h>

#define FARTHEST 1e11 /* m: no edit takes anything there */

static void put_doubles(noct_writer *w, const double *v, int n) {
    for (int i = 0; i < n; i++)
        noct_put_f64(w, v[i]);
}

void noc_keep_scene(noct_writer *w, const noc_scene *s) {
    noct_begin(w, "scene");
    put_doubles(w, s->origin, 3);
    put_doubles(w, s->given_origin, 3);
    put_doubles(w, s->bounds_min, 3);
    put_doubles(w, s->bounds_max, 3);
    put_doubles(w, s->own_camera.eye, 3);
    put_doubles(w, s->own_camera.target, 3);
    put_doubles(w, s->own_camera.up, 3);
    noct_put_f64(w, s->own_camera.fov_deg);
    noct_put_u64(w, s->triangles_dropped);
    noct_put_u64(w, s->triangles_flat);
    noct_put_u32(w, s->backdrop_first);
    noct_put_u32(w, s->backdrop_count);
    noct_put_u32(w, s->lit_elsewhere);
    noct_put_u32(w, s->scaled);
    noct_put_u32(w, s->wet);
    noct_put_f64(w, s->maintenance);
    noct_put_text(w, s->crs_name);
    noct_put_text(w, s->given_crs_name);
    noct_put_text(w, s->without_crs);
    noct_end(w);
}

static bool get_doubles(noct_cursor *c, double *v, int n, double most) {
    bool ok = true;
    for (int i = 0; i < n; i++) {
        v[i] = noct_get_f64(c);
        ok = ok && fabs(v[i]) <= most;
    }
    return ok;
}

static bool get_text(noct_file *f, noct_cursor *c, char **text) {
    const char *there = noct_get_text(c);
    *text = noc_strdup(there);
    if (there && !*text)
        noct_no_memory(f);
    return !f->status;
}

noc_status noc_kept_scene(noct_file *f, noc_scene *s) {
    noct_cursor c = noct_section(f, "scene");
    noc_camera *camera = &s->own_camera;
    bool ok = get_doubles(&c, s->origin, 3, 1e300) && get_doubles(&c, s->given_origin, 3, 1e300);
    bool bounds = get_doubles(&c, s->bounds_min, 3, FARTHEST);
    bounds = get_doubles(&c, s->bounds_max, 3, FARTHEST) && bounds;
    bool empty = s->bounds_min[0] == INFINITY && s->bounds_min[1] == INFINITY && s->bounds_min[2] == INFINITY &&
                 s->bounds_max[0] == -INFINITY && s->bounds_max[1] == -INFINITY && s->bounds_max[2] == -INFINITY;
    for (int k = 0; k < 3; k++)
        bounds = bounds && s->bounds_min[k] <= s->bounds_max[k];
    ok = ok && get_doubles(&c, camera->eye, 3, 1e7) && get_doubles(&c, camera->target, 3, 1e7) &&
         get_doubles(&c, camera->up, 3, 1e7) && get_doubles(&c, &camera->fov_deg, 1, 179) && camera->fov_deg >= 0;
    s->triangles_dropped = noct_get_u64(&c);
    s->triangles_flat = noct_get_u64(&c);
    s->backdrop_first = noct_get_u32(&c);
    s->backdrop_count = noct_get_u32(&c);
    s->lit_elsewhere = noct_get_u32(&c) != 0;
    s->scaled = noct_get_u32(&c) != 0;
    s->wet = noct_get_u32(&c) != 0;
    s->maintenance = noct_get_f64(&c);
    if (!get_text(f, &c, &s->crs_name) || !get_text(f, &c, &s->given_crs_name) || !get_text(f, &c, &s->without_crs) ||
        !noct_read_whole(f, &c, "scene"))
        return f->status;
    if (!(s->maintenance > 0 && s->maintenance <= 1))
        return noct_wrong(f, "its maintenance factor is not above 0 and at most 1");
    return ok && (bounds || empty) ? NOC_OK : noct_wrong(f, "the scene lies nowhere");
}

void noc_keep_groups(noct_writer *w, const noc_scene *s) {
    noct_begin(w, "groups");
    for (size_t i = 0; i < s->groups.len; i++) {
        noct_put_u32(w, noct_name(w, s->groups.data[i].name));
        noct_put(w, s->groups.data[i].scale, sizeof(s->groups.data[i].scale));
        noct_put(w, s->groups.data[i].colour, sizeof(s->groups.data[i].colour));
    }
    noct_end(w);
}

noc_status noc_kept_groups(noct_file *f, noc_scene *s) {
    typedef struct kept {
        uint32_t name;
        float scale[3], colour[3];
    } kept;
    size_t count;
    const kept *k = noct_array(f, "groups", sizeof(*k), &count);
    if (count > UINT16_MAX)
        return noct_wrong(f, "it has %zu groups of lights", count);
    if (!array_reserve(&s->groups, count))
        return noct_no_memory(f);
    for (size_t i = 0; i < count; i++) {
        noc_scene_group g = { .name = noct_name_at(f, k[i].name) };
        memcpy(g.scale, k[i].scale, sizeof(g.scale));
        memcpy(g.colour, k[i].colour, sizeof(g.colour));
        for (int c = 0; c < 3; c++)
            if (!(g.scale[c] >= 0 && g.scale[c] <= 1e6f && g.colour[c] >= 0 && g.colour[c] <= 20))
                return noct_wrong(f, "group %zu of its lights has no scale or colour", i + 1);
        s->groups.data[s->groups.len++] = g;
    }
    return f->status;
}

/* ---- profiles ---- */

typedef struct kept_profile {
    uint32_t name;
    float peak, strength;
    uint32_t upward;
} kept_profile;

void noc_keep_profiles(noct_writer *w, const noc_scene *s) {
    noct_begin(w, "profiles");
    for (size_t i = 0; i < s->profiles.len; i++) {
        const noc_scene_profile *p = &s->profiles.data[i];
        noct_put(w, &(kept_profile){ noct_name(w, p->name), p->peak, p->strength, p->upward }, sizeof(kept_profile));
    }
    noct_end(w);
    noct_put_array(w, "tables", s->profile_cells.data, s->profile_cells.len, sizeof(float));
}

/* A head's table lies in the cells: core/profile.h looks up what it says. */
static bool fits(const noc_scene *s, size_t number, size_t heads) {
    const float *head = s->profile_cells.data + 4 * number;
    uint32_t place, steps;
    memcpy(&place, head, sizeof(place));
    memcpy(&steps, head + 1, sizeof(steps));
    uint64_t cells = (uint64_t)(steps >> 16 & PROFILE_ROWS) * (steps & 0xffff);
    uint32_t pole = steps >> PROFILE_POLE; /* not the axis: a window lies before the table */
    return cells && pole <= PROFILE_LEFT && place >= heads + (pole > 0) && place + cells <= s->profile_cells.len / 4 &&
           head[2] > 0 && head[2] < 1e9f && head[3] > 0 && head[3] <= 1;
}

static bool check_cells(const void *ctx, size_t first, size_t end) {
    const float *cells = ctx;
    bool ok = true;
    for (size_t i = 4 * first; i < 4 * end; i++)
        ok &= cells[i] >= 0 && cells[i] <= 1e6f;
    return ok;
}

noc_status noc_kept_profiles(noct_file *f, noc_scene *s) {
    size_t count, cells, heads = LIGHT_PROFILE_BITS >> LIGHT_PROFILE;
    const kept_profile *k = noct_array(f, "profiles", sizeof(*k), &count);
    float *table = noct_array(f, "tables", 4 * sizeof(float), &cells);
    if (count > heads || (count && cells < heads))
        return noct_wrong(f, "it has %zu profiles in %zu cells", count, cells);
    if (!array_reserve(&s->profiles, count))
        return noct_no_memory(f);
    array_borrow(&s->profile_cells, table, 4 * cells);
    for (size_t i = 0; i < count; i++) {
        noc_scene_profile p = { noct_name_at(f, k[i].name), k[i].peak, k[i].strength, k[i].upward != 0 };
        s->profiles.data[s->profiles.len++] = p;
        if (!p.name || !(p.peak >= 0 && p.peak <= 1e6f) ||
            !(p.strength <= p.peak && (p.strength > 0 || p.peak == 0))) /* none is never drawn */
            return noct_wrong(f, "profile %zu is none", i + 1);
    }
    for (size_t i = 0; i < count; i++)
        if (!fits(s, i, heads))
            return noct_wrong(f, "the table of profile %zu lies elsewhere", i + 1);
    if (count && !noct_each(f, cells - heads, check_cells, table + 4 * heads))
        return noct_wrong(f, "an intensity of a profile is none");
    return f->status;
}
