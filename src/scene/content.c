/* A name for all that a picture of a scene depends on, camera and parameters apart. */
#include "scene/scene.h"

#include <stdio.h>

/* FNV-1a of 128 bits: no guard against malice, but no two scenes meet by chance. */
typedef unsigned __int128 content_hash;

static const content_hash start = ((content_hash)0x6c62272e07bb0142u << 64) | 0x62b821756295c58du;

static content_hash add(content_hash h, const void *data, size_t size) {
    const content_hash prime = ((content_hash)1 << 88) | 0x13b;
    const unsigned char *p = data;
    for (size_t i = 0; i < size; i++)
        h = (h ^ p[i]) * prime;
    return h;
}

/* With its length, so that what ends one array cannot begin the next. */
static content_hash add_array(content_hash h, const void *data, size_t count, size_t size) {
    uint64_t length = count;
    h = add(h, &length, sizeof(length));
    return count ? add(h, data, count * size) : h;
}

/* Of what flags say only what a picture can show; groups are in the emission already. */
static content_hash add_light(content_hash h, noc_light_record r) {
    r.flags &= NOC_LIGHT_TWO_SIDED | NOC_LIGHT_INFERRED | NOC_LIGHT_MOVES | LIGHT_PROFILE_BITS;
    return add(h, &r, sizeof(r));
}

/* Emission apart, which lights have. */
static content_hash add_material(content_hash h, const noc_material *m) {
    noc_material_record r = noc_material_record_of(m);
    uint32_t cls = m->cls;
    memset(r.emission, 0, sizeof(r.emission));
    h = add(add(h, &r, sizeof(r)), &cls, sizeof(cls));
    uint32_t cutout = m->cutout;
    if (noc_material_lets_through(m))
        h = add(add(h, &m->transmittance, sizeof(m->transmittance)), &cutout, sizeof(cutout));
    return h;
}

/* The lights that triangles show, run by run: those of the world by what they are, a model's by number. */
static content_hash add_shown(content_hash h, const noc_scene *s, const noc_scene_mesh *m) {
    const uint32_t *light = s->triangle_light.data + m->first_triangle;
    for (uint32_t t = 0, next; t < m->triangle_count; t = next) {
        for (next = t + 1; next < m->triangle_count && light[next] == light[t];)
            next++;
        uint32_t run[] = { next, light[t] == NOC_NO_LIGHT, m->model ? light[t] : 0 };
        h = add(h, run, sizeof(run));
        if (!m->model && light[t] != NOC_NO_LIGHT)
            h = add_light(h, s->lights.data[light[t]]);
    }
    return h;
}

/* The image, and where the mesh's vertices are in it. */
static content_hash add_texture(content_hash h, const noc_scene *s, const noc_scene_mesh *m, size_t vertices) {
    size_t t = (size_t)s->materials.data[m->material].texture;
    if (!t || !m->uv)
        return h;
    h = add(h, s->textures.data[t - 1].content, sizeof(s->textures.data->content));
    return add_array(h, s->uv.data + 2 * (size_t)(m->uv - 1), 2 * vertices, sizeof(float));
}

static content_hash add_mesh(content_hash h, const noc_scene *s, size_t mesh) {
    const noc_scene_mesh *m = &s->meshes.data[mesh];
    size_t vertices = noc_mesh_end_vertex(s, mesh) - m->first_vertex;
    h = add_material(h, &s->materials.data[m->material]);
    h = add_texture(h, s, m, vertices);
    h = add_array(h, s->positions.data + 3 * (size_t)m->first_vertex, 3 * vertices, sizeof(float));
    h = add(h, &m->triangle_count, sizeof(m->triangle_count));
    for (size_t i = 3 * (size_t)m->first_triangle; i < 3 * ((size_t)m->first_triangle + m->triangle_count); i++) {
        uint32_t v = s->indices.data[i] - m->first_vertex;
        h = add(h, &v, sizeof(v));
    }
    return add_shown(h, s, m);
}

static content_hash add_meshes(content_hash h, const noc_scene *s, uint32_t model) {
    const noc_scene_model *m = model ? &s->models.data[model - 1] : NULL;
    size_t end = m && m->end_mesh ? m->end_mesh : s->meshes.len;
    for (size_t i = m ? m->first_mesh : 0; i < end; i++)
        if (!s->meshes.data[i].removed && s->meshes.data[i].model == model)
            h = add_mesh(h, s, i);
    return h;
}

/* Windows in walls: which grid they are in, what they are of. */
static content_hash add_windows(content_hash h, const noc_scene *s) {
    for (size_t i = 0; i < s->windows.len; i++) {
        const noc_scene_window *w = &s->windows.data[i];
        if (w->removed || !w->facade)
            continue;
        const noc_facade_record *f = &s->facades.data[w->facade - 1];
        h = add(add_material(h, &s->materials.data[f->material]), f->origin, sizeof(f->origin));
        h = add_light(h, s->lights.data[w->light]);
    }
    return h;
}

/* Lights that no triangle of the world shows. */
static bool is_bare(const noc_light_record *r) {
    bool point = r->kind == NOC_LIGHT_POINT || r->kind == NOC_LIGHT_SPOT;
    return !(r->flags & (NOC_LIGHT_FREE | NOC_LIGHT_OWNED)) && (point || r->flags & NOC_LIGHT_MOVES);
}

/* Instances in turn: their model, where they stand, what they emit. */
static content_hash add_instances(content_hash h, const noc_scene *s) {
    content_hash model = 0;
    uint32_t last = 0;
    for (size_t i = 0; i < s->instances.len; i++) {
        const noc_scene_instance *in = &s->instances.data[i];
        if (!in->model)
            continue;
        model = in->model == last ? model : add_meshes(start, s, in->model);
        last = in->model;
        h = add(add(h, &model, sizeof(model)), in->transform, sizeof(in->transform));
        for (size_t k = 0; k < s->models.data[in->model - 1].lights.len; k++)
            h = add_light(h, s->lights.data[in->lights[k]]);
    }
    return h;
}

/* Bodies in turn: their model, where they stand, what they show. Models are looked at once each, where there is memory
 * to note what they are. */
static content_hash add_bodies(content_hash h, const noc_scene *s) {
    content_hash *known = s->bodies.len ? noc_calloc(s->models.len, sizeof(*known)) : NULL;
    for (size_t i = 0; i < s->bodies.len; i++) {
        const noc_scene_body *b = &s->bodies.data[i];
        content_hash model = known && known[b->model - 1] ? known[b->model - 1] : add_meshes(start, s, b->model);
        if (known)
            known[b->model - 1] = model;
        h = add(add(add(h, &model, sizeof(model)), b->p, sizeof(b->p)), b->facing, sizeof(b->facing));
        for (uint32_t k = 0; k < s->models.data[b->model - 1].shown; k++)
            h = add_light(h, s->lights.data[b->light + k]);
    }
    free(known);
    return h;
}

/* What was removed is not there, and what order lights and materials were added in does not matter but to lights that
 * nothing shows. */
void noc_scene_content(const noc_scene *s, char key[NOC_CONTENT_KEY]) {
    if (!s || !key)
        return;
    noc_scene_lock_read(s);
    content_hash h = add_windows(add_meshes(start, s, 0), s);
    for (size_t i = 0; i < s->lights.len; i++)
        if (is_bare(&s->lights.data[i]))
            h = add_light(h, s->lights.data[i]);
    h = add_bodies(add_instances(h, s), s);
    if (s->profile_cells.len)
        h = add_array(h, s->profile_cells.data, s->profile_cells.len, sizeof(float));
    if (s->environment) {
        const noc_environment *e = s->environment;
        h = add_array(h, e->texels, 3 * (size_t)e->width * (size_t)e->height, sizeof(float));
    }
    noc_scene_unlock_read(s);
    snprintf(key, NOC_CONTENT_KEY, "%016llx%016llx", (unsigned long long)(h >> 64), (unsigned long long)h);
}
