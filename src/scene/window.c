/* Windows: lights that are lit or dark by the hour, and show the glass they are made of where they are dark. */
#include "scene/facade.h"

#include <math.h>

/* How many windows are lit at each full hour, over how many are at 21 h: a winter's working day. Flats from 16 to 8 h
 * by the model of homes of Richardson, Thomson and Infield (2008, 2009), with some lights that are forgotten and stairs
 * that are lit all night (docs/defaults.md). The rest is ours: offices by their hours and cleaners, shops by theirs and
 * by displays that stay lit. */
static const float hours[NOC_WINDOW_KIND_COUNT][24] = {
    [NOC_WINDOW_FLAT] = { .27f, .13f, .08f, .06f, .06f, .09f, .18f, .4f, .4f, .4f, .3f, .28f,
                          .3f,  .28f, .28f, .35f, .35f, .65f, .85f, 1,   1,   1,   .9f, .6f },
    [NOC_WINDOW_OFFICE] = { .45f, .4f,  .38f, .38f, .4f,  .6f,  1.2f, 2.2f, 2.8f, 2.8f, 2.8f, 2.8f,
                            2.8f, 2.8f, 2.8f, 2.8f, 2.8f, 2.8f, 2.3f, 1.7f, 1.3f, 1,    .75f, .55f },
    [NOC_WINDOW_SHOP] = { .6f,  .55f, .5f,  .5f,  .5f,  .7f,  1.2f, 1.8f, 2.4f, 2.8f, 2.8f, 2.8f,
                          2.8f, 2.8f, 2.8f, 2.8f, 2.8f, 2.8f, 2.8f, 2.4f, 1.6f, 1,    .8f,  .7f },
};

const char *noc_building_use_name(noc_building_use use) {
    static const char *const names[NOC_USE_COUNT] = {
        "not told", "flats", "mixed", "offices", "shops", "dark", "bare"
    };
    return (unsigned)use < NOC_USE_COUNT ? names[use] : "unknown";
}

const char *noc_wall_verdict_name(noc_wall_verdict verdict) {
    static const char *const names[NOC_WALL_VERDICT_COUNT] = {
        [NOC_WALL_UNSEEN] = "not looked at",     [NOC_WALL_TAKEN] = "with windows",
        [NOC_WALL_SMALL] = "too small",          [NOC_WALL_TILTED] = "tilted",
        [NOC_WALL_PARTY] = "party wall",         [NOC_WALL_BARE] = "of sheds and the like",
        [NOC_WALL_OWN] = "with its own windows",
    };
    return (unsigned)verdict < NOC_WALL_VERDICT_COUNT ? names[verdict] : "unknown";
}

/* Over 21 h. */
static double of_hour(noc_window_kind kind, double hour) {
    double h = fmod(hour, 24);
    h = h < 0 ? h + 24 : h;
    int a = (int)h % 24, b = (a + 1) % 24;
    double part = h - floor(h);
    return (1 - part) * (double)hours[kind][a] + part * (double)hours[kind][b];
}

double noc_window_share(noc_window_kind kind, double lit, double hour) {
    if ((unsigned)kind >= NOC_WINDOW_KIND_COUNT)
        return 0;
    return NOC_CLAMP(lit * of_hour(kind, hour), 0, 1);
}

const char *noc_window_fault(const noc_window_params *p) {
    if (!(p->lit_windows >= 0 && p->lit_windows <= 1))
        return "lit_windows must be in 0..1";
    return p->hour >= 0 && p->hour <= 24 ? NULL : "hour must be in 0..24";
}

double noc_window_level(float level, uint32_t seed) {
    uint32_t bits;
    if (seed == NOC_WINDOW_SEED || level >= 1)
        return level;
    memcpy(&bits, &level, sizeof(bits));
    uint64_t h = bits + 0x9e3779b97f4a7c15u * ((uint64_t)seed + 1); /* splitmix64 */
    h = (h ^ h >> 30) * 0xbf58476d1ce4e5b9u;
    h = (h ^ h >> 27) * 0x94d049bb133111ebu;
    return (double)((h ^ h >> 31) >> 11) * 0x1p-53;
}

static void emission_of(const noc_scene_window *w, const noc_window_switch *to,
                        const double share[NOC_WINDOW_KIND_COUNT], float e[3]) {
    double often = (double)w->often / NOC_WINDOW_OFTEN;
    bool lit = noc_window_level(w->level, to->seed) < NOC_MIN(share[w->kind] * often, 1);
    for (int k = 0; k < 3; k++)
        e[k] = lit ? w->emission[k] : 0;
}

/* Of all kinds, beyond 1 where the hour says so: what is lit seldom follows it still. */
static void shares(const noc_window_switch *to, double share[NOC_WINDOW_KIND_COUNT]) {
    for (int kind = 0; kind < NOC_WINDOW_KIND_COUNT; kind++)
        share[kind] = to->lit * of_hour((noc_window_kind)kind, to->hour);
}

bool noc_scene_reserve_walls(noc_scene *s) {
    size_t count = s->triangle_light.len;
    if (!array_reserve(&s->walls, count) || !array_reserve(&s->triangle_facade, count)) {
        noc_scene_out_of_memory(s);
        return false;
    }
    while (s->walls.len < count)
        s->walls.data[s->walls.len++] = NOC_WALL_UNSEEN;
    while (s->triangle_facade.len < count)
        s->triangle_facade.data[s->triangle_facade.len++] = 0;
    return true;
}

bool noc_scene_add_window(noc_scene *s, int mesh, const noc_pane *pane) {
    noc_scene_mesh *m = &s->meshes.data[mesh];
    uint32_t light = (uint32_t)s->lights.len;
    if (!array_reserve(&s->lights, light + 1) || !array_reserve(&s->light_names, light + 1) ||
        !array_reserve(&s->windows, s->windows.len + 1)) {
        noc_scene_out_of_memory(s);
        return false;
    }
    noc_scene_window w = pane->window;
    noc_light_record r = noc_light_record_of(s, &pane->shape);
    w.light = light;
    r.flags |= NOC_LIGHT_OWNED;
    memset(r.e, 0, sizeof(r.e));
    m->panes |= !w.facade;
    s->windows.data[s->windows.len++] = w;
    s->lights.data[s->lights.len++] = r;
    s->light_names.data[s->light_names.len++] = m->name;
    for (size_t t = 0; t < pane->triangle_count; t++)
        s->triangle_light.data[m->first_triangle + pane->triangles[t]] = light;
    if (w.facade)
        noc_facade_put(s, w.facade, light);
    return true;
}

void noc_scene_light_windows(noc_scene *s, const noc_window_params *params) {
    double share[NOC_WINDOW_KIND_COUNT];
    noc_window_switch to = { params->lit_windows, params->hour, params->seed };
    shares(&to, share);
    for (size_t i = 0; i < s->windows.len; i++)
        emission_of(&s->windows.data[i], &to, share, s->lights.data[s->windows.data[i].light].e);
}

void noc_windows_switch(noc_scene *s, const noc_window_switch *to, noc_changes *c) {
    double share[NOC_WINDOW_KIND_COUNT];
    shares(to, share);
    for (size_t i = 0; i < s->windows.len; i++) {
        const noc_scene_window *w = &s->windows.data[i];
        if (w->removed)
            continue;
        noc_light_record r = noc_light_made(s, w->light);
        emission_of(w, to, share, r.e);
        noc_light_change(s, w->light, &r, c);
    }
}

/* They lie in the order of their lights, and where a load has made them there is no other light between two. */
noc_scene_window *noc_window_of(const noc_scene *s, uint32_t light) {
    size_t low = 0, high = s->windows.len, likely = high ? (size_t)light - s->windows.data[0].light : 0;
    if (likely < high && s->windows.data[likely].light == light)
        return &s->windows.data[likely];
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (s->windows.data[middle].light < light)
            low = middle + 1;
        else
            high = middle;
    }
    return low < s->windows.len && s->windows.data[low].light == light ? &s->windows.data[low] : NULL;
}

void noc_window_first(const noc_scene_window *w, float e[3]) {
    const noc_window_params params = noc_window_default_params();
    const noc_window_switch to = { params.lit_windows, params.hour, params.seed };
    double share[NOC_WINDOW_KIND_COUNT];
    shares(&to, share);
    emission_of(w, &to, share, e);
}

void noc_window_forget(noc_scene *s, uint32_t light) {
    noc_scene_window *window = noc_window_of(s, light);
    if (window)
        window->removed = true;
}

noc_status noc_scene_set_windows(noc_scene *scene, const noc_window_params *params) {
    if (!scene || !params)
        return noc_null(scene ? scene->log : NULL, __func__);
    const char *wrong = noc_window_fault(params);
    if (wrong)
        return noc_error(scene->log, NOC_ERR_ARGUMENT, "windows: %s", wrong);
    if (scene->no_memory)
        return NOC_ERR_MEMORY;
    noc_edit edit = { .kind = NOC_EDIT_WINDOWS, .windows = { params->lit_windows, params->hour, params->seed } };
    return array_push(&scene->edits, edit) ? NOC_OK : noc_scene_out_of_memory(scene);
}
