/* Models, and where they stand. */
#include "scene/keep.h"

#include <math.h>

typedef struct kept_model {
    double bounds_min[3], bounds_max[3];
    uint32_t name, lights, shown, unused;
} kept_model;
_Static_assert(sizeof(kept_model) == 64, "it has no gaps");

enum { MOST_SHOWN = 1 << 16 };

void noc_keep_models(noct_writer *w, const noc_scene *s) {
    noct_begin(w, "models");
    for (size_t i = 0; i < s->models.len; i++) {
        const noc_scene_model *m = &s->models.data[i];
        kept_model k = { .name = noct_name(w, m->name), .lights = (uint32_t)m->lights.len, .shown = m->shown };
        memcpy(k.bounds_min, m->bounds_min, sizeof(k.bounds_min));
        memcpy(k.bounds_max, m->bounds_max, sizeof(k.bounds_max));
        noct_put(w, &k, sizeof(k));
    }
    noct_end(w);
    noct_begin(w, "modelli");
    for (size_t i = 0; i < s->models.len; i++)
        noct_put(w, s->models.data[i].lights.data, s->models.data[i].lights.len * sizeof(noc_light_record));
    noct_end(w);
    noct_begin(w, "modelnam");
    for (size_t i = 0; i < s->models.len; i++)
        for (size_t k = 0; k < s->models.data[i].lights.len; k++)
            noct_put_u32(w, noct_name(w, s->models.data[i].light_names.data[k]));
    noct_end(w);
}

/* Of its triangles; min > max where it has none. */
static bool bounds_fit(const kept_model *k) {
    bool none = true, ok = true;
    for (int c = 0; c < 3; c++) {
        none = none && k->bounds_min[c] == INFINITY && k->bounds_max[c] == -INFINITY;
        ok = ok && k->bounds_min[c] >= -1e7 && k->bounds_max[c] <= 1e7 && k->bounds_min[c] <= k->bounds_max[c];
    }
    return none || ok;
}

static noc_status take_model(noct_file *f, noc_scene *s, const kept_model *k, noc_light_record *lights,
                             const uint32_t *names) {
    noc_scene_model m = { .name = noct_name_at(f, k->name), .shown = k->shown };
    memcpy(m.bounds_min, k->bounds_min, sizeof(m.bounds_min));
    memcpy(m.bounds_max, k->bounds_max, sizeof(m.bounds_max));
    noc_scene_model *to = &s->models.data[s->models.len++];
    *to = m;
    if (!array_reserve(&to->light_names, k->lights))
        return noct_no_memory(f);
    array_borrow(&to->lights, lights, k->lights);
    for (uint32_t i = 0; i < k->lights; i++) {
        to->light_names.data[to->light_names.len++] = noct_name_at(f, names[i]);
        if (!noc_kept_light_fits(s, &lights[i]) || lights[i].flags & NOC_LIGHT_FREE)
            return noct_wrong(f, "a light of model %zu is none", s->models.len);
    }
    if (k->shown > MOST_SHOWN || (k->shown && k->lights))
        return noct_wrong(f, "model %zu shows %u lights", s->models.len, k->shown);
    return bounds_fit(k) ? f->status : noct_wrong(f, "model %zu lies nowhere", s->models.len);
}

noc_status noc_kept_models(noct_file *f, noc_scene *s) {
    size_t count, lights, names, taken = 0;
    const kept_model *k = noct_array(f, "models", sizeof(*k), &count);
    noc_light_record *light = noct_array(f, "modelli", sizeof(*light), &lights);
    const uint32_t *name = noct_array(f, "modelnam", sizeof(*name), &names);
    if (count > UINT16_MAX || lights != names)
        return noct_wrong(f, "it has %zu models with %zu lights", count, lights);
    if (!array_reserve(&s->models, count))
        return noct_no_memory(f);
    for (size_t i = 0; i < count && !f->status; taken += k[i++].lights)
        if (k[i].lights > lights - taken)
            noct_wrong(f, "model %zu has lights of others", i + 1);
        else
            take_model(f, s, &k[i], light + taken, name + taken);
    return f->status || taken == lights ? f->status : noct_wrong(f, "lights of no model");
}

typedef struct kept_instance {
    uint32_t model;
    float transform[12];
} kept_instance;

void noc_keep_instances(noct_writer *w, const noc_scene *s) {
    noct_begin(w, "instance");
    for (size_t i = 0; i < s->instances.len; i++) {
        kept_instance k = { .model = s->instances.data[i].model };
        memcpy(k.transform, s->instances.data[i].transform, sizeof(k.transform));
        noct_put(w, &k, sizeof(k));
    }
    noct_end(w);
    noct_begin(w, "instlit");
    for (size_t i = 0; i < s->instances.len; i++) {
        const noc_scene_instance *in = &s->instances.data[i];
        if (in->model)
            noct_put(w, in->lights, s->models.data[in->model - 1].lights.len * sizeof(*in->lights));
    }
    noct_end(w);
}

static bool transform_fits(const float m[12]) {
    double exact[12];
    for (int i = 0; i < 12; i++)
        exact[i] = m[i];
    return noc_transform_fits(exact, 1.01);
}

/* One that stands, with its lights, which are its own: edits take them out with it, and have room for each once.
 * owned: of all lights, those that earlier ones have. */
static noc_status take_instance(noct_file *f, noc_scene *s, const kept_instance *k, const uint32_t *lights,
                                bool *owned) {
    noc_scene_model *model = &s->models.data[k->model - 1];
    noc_scene_instance *in = &s->instances.data[s->instances.len - 1];
    in->lights = noc_calloc(NOC_MAX(model->lights.len, 1u), sizeof(*in->lights));
    if (!in->lights)
        return noct_no_memory(f);
    in->model = k->model;
    model->instances++;
    for (size_t i = 0; i < model->lights.len; i++) {
        uint32_t flags = lights[i] < s->lights.len ? s->lights.data[lights[i]].flags : 0;
        if (!(flags & NOC_LIGHT_OWNED) || !(flags & NOC_LIGHT_MOVES) || flags & NOC_LIGHT_FREE || owned[lights[i]])
            return noct_wrong(f, "instance %zu has lights of others", s->instances.len - 1);
        in->lights[i] = lights[i];
        owned[lights[i]] = true;
    }
    return NOC_OK;
}

noc_status noc_kept_instances(noct_file *f, noc_scene *s) {
    size_t count, lights, taken = 0, empty = 0;
    const kept_instance *k = noct_array(f, "instance", sizeof(*k), &count);
    const uint32_t *light = noct_array(f, "instlit", sizeof(*light), &lights);
    for (size_t i = 0; i < count; i++)
        empty += !k[i].model;
    if (count >= INT32_MAX)
        return noct_wrong(f, "it has %zu instances", count);
    bool *owned = noc_calloc(s->lights.len, sizeof(*owned));
    if (!owned || !array_reserve(&s->instances, count) || !array_reserve(&s->instance_slots.free, empty)) {
        free(owned);
        return noct_no_memory(f);
    }
    for (size_t i = 0; i < count && !f->status; i++) {
        s->instances.data[s->instances.len++] = (noc_scene_instance){ .model = 0 };
        memcpy(s->instances.data[i].transform, k[i].transform, sizeof(k[i].transform));
        size_t own = k[i].model && k[i].model <= s->models.len ? s->models.data[k[i].model - 1].lights.len : 0;
        if (!k[i].model)
            s->instance_slots.free.data[s->instance_slots.free.len++] = (uint32_t)i;
        else if (k[i].model > s->models.len || !transform_fits(k[i].transform) || own > lights - taken)
            noct_wrong(f, "instance %zu is none", i);
        else
            take_instance(f, s, &k[i], light + taken, owned);
        taken += own;
    }
    free(owned);
    return f->status || taken == lights ? f->status : noct_wrong(f, "lights of no instance");
}

/* ---- bodies ---- */

void noc_keep_bodies(noct_writer *w, const noc_scene *s) {
    noct_put_array(w, "bodies", s->bodies.data, s->bodies.len, sizeof(*s->bodies.data));
}

static bool body_fits(const noc_scene *s, const noc_scene_body *b, size_t from) {
    const noc_scene_model *m = b->model && b->model <= s->models.len ? &s->models.data[b->model - 1] : NULL;
    double turn = (double)b->facing[0] * b->facing[0] + (double)b->facing[1] * b->facing[1];
    if (!m || !m->shown || !m->end_mesh || b->light < from || b->light > s->lights.len - m->shown ||
        m->shown > s->lights.len)
        return false;
    for (uint32_t i = 0; i < m->shown; i++)
        if (s->lights.data[b->light + i].flags & (NOC_LIGHT_OWNED | NOC_LIGHT_MOVES))
            return false;
    return noc_kept_finite(b->p, 3, 1e7f) && fabs(turn - 1) < 1e-5;
}

/* The meshes of models that bodies show follow one another. false: those of one do not. */
static bool find_ranges(noc_scene *s) {
    for (uint32_t i = 0; i < s->meshes.len; i++) {
        const noc_scene_mesh *mesh = &s->meshes.data[i];
        noc_scene_model *m = mesh->model ? &s->models.data[mesh->model - 1] : NULL;
        if (!m || !m->shown)
            continue;
        if ((m->end_mesh && m->end_mesh != i) || mesh->removed)
            return false;
        m->first_mesh = m->end_mesh ? m->first_mesh : i;
        m->end_mesh = i + 1;
    }
    return true;
}

/* Slots whose lights were removed are the bodies' for good. */
static void keep_slots(noc_scene *s) {
    size_t kept = 0;
    for (size_t i = 0; i < s->light_slots.free.len; i++)
        if (!noc_body_of(s, s->light_slots.free.data[i]))
            s->light_slots.free.data[kept++] = s->light_slots.free.data[i];
    s->light_slots.free.len = kept;
}

noc_status noc_kept_bodies(noct_file *f, noc_scene *s) {
    size_t count, from = 0;
    noc_scene_body *b = noct_array(f, "bodies", sizeof(*b), &count);
    if (f->status || count >= INT32_MAX || !find_ranges(s))
        return noct_wrong(f, "it has %zu bodies of lamps", count);
    for (size_t i = 0; i < count; i++) {
        if (!body_fits(s, &b[i], from))
            return noct_wrong(f, "the body of lamp %zu is none", i);
        noc_scene_model *m = &s->models.data[b[i].model - 1];
        from = b[i].light + m->shown;
        m->instances++;
    }
    array_borrow(&s->bodies, b, count);
    keep_slots(s);
    return noc_bodies_file(s, 0) ? f->status : noct_no_memory(f);
}
