/* Emitters. What comes and goes together is one: lights of an instance that share a name, triangles of a mesh that
 * shines, parts of a pane. Of what inputs call lamps, lights with one id that follow one another are one, unless they
 * lie apart: then the id is a word for many, as "lamp". */
#include "scene/emitters.h"

#include <math.h>

#define LAMP_WIDTH 5.0f /* m between lights of one lamp */

const char *noc_emitter_kind_name(noc_emitter_kind kind) {
    static const char *const names[NOC_EMITTER_KIND_COUNT] = { "lamp", "window", "vehicle", "surface", "other" };
    return (unsigned)kind < NOC_EMITTER_KIND_COUNT ? names[kind] : "unknown";
}

static bool add(noc_emitters *e, noc_emitter_kind kind, uint32_t light, uint32_t instance) {
    uint32_t number = (uint32_t)e->all.len;
    if (!array_push(&e->all, (noc_emitter_entry){ kind, light, 0, instance, 0 }))
        return false;
    e->of[light] = number;
    return true;
}

static bool same_text(const char *a, const char *b) { return a == b || (a && b && !strcmp(a, b)); }

/* of[]: of each light of a model the first one of its name. Names come in runs, and are few. */
static void find_named(const noc_scene_model *m, uint32_t *of) {
    enum { KNOWN = 16 };
    uint32_t known[KNOWN], count = 0;
    for (uint32_t i = 0; i < m->lights.len; i++) {
        uint32_t k = count;
        while (k-- > 0 && !same_text(m->light_names.data[known[k]], m->light_names.data[i]))
            ;
        of[i] = k < count ? known[k] : i;
        if (k >= count && count < KNOWN)
            known[count++] = i;
    }
}

static bool take_instances(const noc_scene *s, noc_emitters *e) {
    uint32_t *first = NULL, model = 0;
    size_t room = 0;
    bool ok = true;
    for (size_t m = 0; m < s->models.len; m++)
        room = NOC_MAX(room, s->models.data[m].lights.len);
    if (room && !(first = noc_alloc(room * sizeof(*first))))
        return false;
    for (size_t i = 0; i < s->instances.len && ok; i++) {
        const noc_scene_instance *in = &s->instances.data[i];
        const noc_scene_model *m = in->model ? &s->models.data[in->model - 1] : NULL;
        if (!m || !m->lights.len || !in->lights)
            continue;
        if (model != in->model)
            find_named(m, first);
        model = in->model;
        for (size_t k = 0; k < m->lights.len && ok; k++) {
            if (first[k] == k)
                ok = add(e, NOC_EMITTER_VEHICLE, in->lights[k], (uint32_t)i);
            else
                e->of[in->lights[k]] = e->of[in->lights[first[k]]];
        }
    }
    free(first);
    return ok;
}

static bool take_windows(const noc_scene *s, noc_emitters *e) {
    for (size_t i = 0; i < s->windows.len; i++) {
        const noc_scene_window *w = &s->windows.data[i];
        if (w->removed)
            continue;
        if (w->part && i && !w[-1].removed)
            e->of[w->light] = e->of[w[-1].light];
        else if (!add(e, NOC_EMITTER_WINDOW, w->light, UINT32_MAX))
            return false;
    }
    return true;
}

static noc_emitter_kind kind_of_class(noc_class cls) {
    return cls == NOC_CLASS_WINDOW    ? NOC_EMITTER_WINDOW
           : cls == NOC_CLASS_LAMP    ? NOC_EMITTER_LAMP
           : cls == NOC_CLASS_VEHICLE ? NOC_EMITTER_VEHICLE
                                      : NOC_EMITTER_SURFACE;
}

/* Meshes of an object follow one another (noc_scene_object_of). */
static bool take_meshes(const noc_scene *s, noc_emitters *e) {
    uint32_t number = NOC_NO_EMITTER;
    size_t object = SIZE_MAX;
    for (size_t i = 0; i < s->meshes.len; i++) {
        const noc_scene_mesh *m = &s->meshes.data[i];
        if (m->removed || m->model || m->panes || !noc_material_shines(&s->materials.data[m->material]))
            continue;
        size_t of = noc_scene_object_of(s, m->first_triangle, NO_INSTANCE);
        for (uint32_t t = m->first_triangle; t < m->first_triangle + m->triangle_count; t++) {
            uint32_t light = s->triangle_light.data[t];
            if (light == NOC_NO_LIGHT || !(s->lights.data[light].flags & NOC_LIGHT_OWNED) ||
                e->of[light] != NOC_NO_EMITTER)
                continue;
            if (of != object) {
                if (!add(e, kind_of_class(s->materials.data[m->material].cls), light, UINT32_MAX))
                    return false;
                number = (uint32_t)e->all.len - 1;
                object = of;
            }
            e->of[light] = number;
        }
    }
    return true;
}

static float apart(const noc_light_record *a, const noc_light_record *b) {
    float d[3] = { a->p[0] - b->p[0], a->p[1] - b->p[1], a->p[2] - b->p[2] };
    return sqrtf(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
}

static noc_emitter_kind kind_of_light(const noc_scene *s, const noc_light_record *l) {
    if (noc_light_is_lamp(l))
        return NOC_EMITTER_LAMP;
    if (l->flags & NOC_LIGHT_MOVES)
        return NOC_EMITTER_OTHER;
    uint32_t group = noc_light_group(l);
    const char *name = group && group <= s->groups.len ? s->groups.data[group - 1].name : NULL;
    return name && !strcmp(name, "windows") ? NOC_EMITTER_WINDOW : NOC_EMITTER_SURFACE;
}

static bool take_others(const noc_scene *s, noc_emitters *e) {
    uint32_t last = NOC_NO_LIGHT; /* first light of the lamp at hand */
    for (uint32_t i = 0; i < s->lights.len; i++) {
        const noc_light_record *l = &s->lights.data[i];
        const char *name = s->light_names.data[i];
        if (l->flags & NOC_LIGHT_FREE || e->of[i] != NOC_NO_EMITTER) {
            last = NOC_NO_LIGHT;
            continue;
        }
        noc_emitter_kind kind = kind_of_light(s, l);
        if (kind == NOC_EMITTER_LAMP && last != NOC_NO_LIGHT && name && same_text(name, s->light_names.data[last]) &&
            apart(l, &s->lights.data[last]) <= LAMP_WIDTH) {
            e->of[i] = e->of[last];
            continue;
        }
        if (!add(e, kind, i, UINT32_MAX))
            return false;
        last = kind == NOC_EMITTER_LAMP ? i : NOC_NO_LIGHT;
    }
    return true;
}

bool noc_emitters_make(const noc_scene *s, noc_emitters *out) {
    *out = (noc_emitters){ .lights = s->lights.len };
    if (s->lights.len && !(out->of = noc_alloc(s->lights.len * sizeof(*out->of))))
        return false;
    for (size_t i = 0; i < s->lights.len; i++)
        out->of[i] = NOC_NO_EMITTER;
    if (!take_instances(s, out) || !take_windows(s, out) || !take_meshes(s, out) || !take_others(s, out)) {
        noc_emitters_free(out);
        return false;
    }
    for (size_t i = 0; i < s->lights.len; i++)
        if (out->of[i] != NOC_NO_EMITTER) {
            noc_emitter_entry *of = &out->all.data[out->of[i]];
            of->count++;
            of->lumens += (float)noc_light_flux(&s->lights.data[i]);
        }
    return true;
}

void noc_emitters_free(noc_emitters *e) {
    free(e->of);
    array_free(&e->all);
    *e = (noc_emitters){ 0 };
}

void noc_emitter_describe(const noc_scene *s, const noc_emitters *e, uint32_t i, noc_emitter *out) {
    const noc_emitter_entry *of = &e->all.data[i];
    *out = (noc_emitter){ .kind = of->kind,
                          .name = "",
                          .of = "",
                          .light = of->first,
                          .light_count = of->count,
                          .instance = -1,
                          .lumens = of->lumens,
                          .kelvin = NAN };
    if (!s)
        return;
    const noc_light_record *r = &s->lights.data[of->first];
    const char *name = s->light_names.data[of->first];
    bool triangle = r->kind == NOC_LIGHT_TRIANGLE, flat = triangle || r->kind == NOC_LIGHT_PARALLELOGRAM;
    out->name = name ? name : "";
    out->kelvin = noc_rgb_kelvin(r->e);
    out->inferred = (r->flags & NOC_LIGHT_INFERRED) != 0;
    if (of->instance != UINT32_MAX) {
        const char *model = s->models.data[s->instances.data[of->instance].model - 1].name;
        out->instance = (int)of->instance;
        out->of = model ? model : "";
    }
    for (int k = 0; k < 3; k++)
        out->centre[k] = r->p[k] + (flat ? ((double)r->a[k] + r->b[k]) / (triangle ? 3 : 2) : 0);
}

noc_status noc_scene_get_emitter(const noc_scene *s, size_t light, noc_emitter *out) {
    if (!s || !out)
        return noc_null(s ? s->log : NULL, __func__);
    noc_emitters e = { 0 };
    noc_scene_lock_read(s);
    bool there = light < s->lights.len && !(s->lights.data[light].flags & NOC_LIGHT_FREE);
    bool made = there && noc_emitters_make(s, &e);
    if (made)
        noc_emitter_describe(s, &e, e.of[light], out);
    noc_scene_unlock_read(s);
    noc_emitters_free(&e);
    return !there ? noc_error(s->log, NOC_ERR_ARGUMENT, "there is no light %zu", light)
           : made ? NOC_OK
                  : noc_no_memory(s->log, "emitters");
}
