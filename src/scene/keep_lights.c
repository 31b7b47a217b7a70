/* Lights as they are, their names, and windows. */
#include "scene/keep.h"

/* Records that no edit makes could take what is made of lights out of its numbers. */
#define FARTHEST 1e11f
#define BRIGHTEST 1e18f /* of an emission and a group's scale */
#define MOST_FLUX 1e36  /* emission times area, which floats hold */
#define LARGEST_AREA 1e22f

void noc_keep_lights(noct_writer *w, const noc_scene *s) {
    noct_put_array(w, "lights", s->lights.data, s->lights.len, sizeof(*s->lights.data));
    noct_begin(w, "lightnam");
    for (size_t i = 0; i < s->lights.len; i++)
        noct_put_u32(w, noct_name(w, s->light_names.data[i]));
    noct_end(w);
    if (s->scaled)
        noct_put_array(w, "made", s->light_made.data, s->lights.len, sizeof(*s->light_made.data));
    noct_put_array(w, "dark", s->dark_slots.data, s->dark_slots.len, sizeof(*s->dark_slots.data));
}

static bool fits_profile(const noc_scene *s, const noc_light_record *r) {
    uint32_t profile = (r->flags & LIGHT_PROFILE_BITS) >> LIGHT_PROFILE;
    bool may = r->kind == NOC_LIGHT_POINT || r->kind == NOC_LIGHT_SPHERE || r->kind == NOC_LIGHT_DISC;
    return !profile || (may && profile <= s->profiles.len);
}

bool noc_kept_light_fits(const noc_scene *s, const noc_light_record *r) {
    bool ok = r->kind < NOC_LIGHT_KIND_COUNT && noc_light_group(r) <= s->groups.len && fits_profile(s, r);
    ok = ok && noc_kept_finite(r->p, 3, FARTHEST) && noc_kept_finite(r->a, 3, FARTHEST) &&
         noc_kept_finite(r->b, 3, FARTHEST) && r->radius >= 0 && r->radius <= FARTHEST && r->area >= 0 &&
         r->area <= LARGEST_AREA;
    for (int k = 0; k < 3; k++)
        ok = ok && r->e[k] >= 0 && r->e[k] <= BRIGHTEST && (double)r->e[k] * (double)r->area <= MOST_FLUX;
    return ok;
}

static bool check_lights(const void *ctx, size_t first, size_t end) {
    const noc_scene *s = ctx;
    bool ok = true;
    for (size_t i = first; ok && i < end; i++) {
        const noc_light_record *r = &s->lights.data[i];
        bool free_slot = r->flags & NOC_LIGHT_FREE;
        ok = noc_kept_light_fits(s, r) && (!free_slot || (r->flags == NOC_LIGHT_FREE && r->kind == NOC_LIGHT_POINT &&
                                                          r->e[0] == 0 && r->e[1] == 0 && r->e[2] == 0));
        if (s->scaled)
            for (int k = 0; k < 3; k++)
                ok = ok && s->light_made.data[i].v[k] >= 0 && s->light_made.data[i].v[k] <= BRIGHTEST;
    }
    return ok;
}

static int by_index(const void *a, const void *b) {
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

/* Lights that are of the moving half, slots that are free, and what is counted. */
static noc_status sort_lights(noct_file *f, noc_scene *s) {
    size_t dark, next = 0, moving = 0, empty = 0;
    const uint32_t *slots = noct_array(f, "dark", sizeof(*slots), &dark);
    for (size_t i = 0; i < s->lights.len; i++) {
        uint32_t flags = s->lights.data[i].flags;
        empty += (flags & NOC_LIGHT_FREE) != 0;
        moving += !noc_light_stands(flags);
    }
    if (!array_reserve(&s->moving, moving) || !array_reserve(&s->light_slots.free, empty) ||
        !array_append(&s->dark_slots, slots, dark))
        return noct_no_memory(f);
    if (dark)
        qsort(s->dark_slots.data, dark, sizeof(*s->dark_slots.data), by_index);
    for (uint32_t i = 0; i < s->lights.len; i++) {
        uint32_t flags = s->lights.data[i].flags;
        s->lights_inferred += (flags & NOC_LIGHT_INFERRED) != 0;
        s->later += (flags & NOC_LIGHT_LATER) != 0;
        if (!noc_light_stands(flags))
            s->moving.data[s->moving.len++] = i;
        else if (flags & NOC_LIGHT_FREE && next < dark && s->dark_slots.data[next] == i)
            next++;
        else if (flags & NOC_LIGHT_FREE)
            s->light_slots.free.data[s->light_slots.free.len++] = i;
    }
    return next == dark ? f->status : noct_wrong(f, "its dark slots of lights are none");
}

noc_status noc_kept_lights(noct_file *f, noc_scene *s) {
    size_t count, names, made = 0;
    noc_light_record *lights = noct_array(f, "lights", sizeof(*lights), &count);
    const uint32_t *name = noct_array(f, "lightnam", sizeof(*name), &names);
    noc_rgb *before = s->scaled ? noct_array(f, "made", sizeof(*before), &made) : NULL;
    if (f->status || names != count || count >= INT32_MAX || made != (s->scaled ? count : 0))
        return noct_wrong(f, "it has %zu lights with %zu names", count, names);
    if (!array_reserve(&s->light_names, count))
        return noct_no_memory(f);
    array_borrow(&s->lights, lights, count);
    array_borrow(&s->light_made, before, made);
    for (size_t i = 0; i < count; i++)
        s->light_names.data[s->light_names.len++] = noct_name_at(f, name[i]);
    if (!noct_each(f, count, check_lights, s))
        return noct_wrong(f, "one of its lights is none");
    return f->status ? f->status : sort_lights(f, s);
}

/* ---- windows ---- */

void noc_keep_windows(noct_writer *w, const noc_scene *s) {
    noct_put_array(w, "windows", s->windows.data, s->windows.len, sizeof(noc_scene_window));
}

static bool window_fits(const noc_scene *s, const noc_scene_window *w) {
    bool ok = w->light < s->lights.len && w->kind < NOC_WINDOW_KIND_COUNT && !w->none && w->level >= 0 && w->level <= 1;
    for (int c = 0; c < 3; c++)
        ok = ok && w->emission[c] >= 0 && w->emission[c] <= 1e12f;
    uint32_t own = NOC_LIGHT_OWNED | NOC_LIGHT_MOVES | NOC_LIGHT_FREE; /* a mesh's, which goes with that alone */
    return ok && (w->removed || (s->lights.data[w->light].flags & own) == NOC_LIGHT_OWNED);
}

static bool check_windows(const void *ctx, size_t first, size_t end) {
    const noc_scene *s = ctx;
    bool ok = true;
    for (size_t i = first; ok && i < end; i++)
        ok = window_fits(s, &s->windows.data[i]) && (!i || s->windows.data[i].light > s->windows.data[i - 1].light);
    return ok;
}

noc_status noc_kept_windows(noct_file *f, noc_scene *s) {
    size_t count;
    noc_scene_window *windows = noct_array(f, "windows", sizeof(*windows), &count);
    array_borrow(&s->windows, windows, count);
    return noct_each(f, count, check_windows, s) ? f->status : noct_wrong(f, "one of its windows is none");
}
