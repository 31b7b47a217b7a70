/* Materials, and meshes with their triangles. */
#include "scene/keep.h"

typedef struct kept_material {
    float albedo[3], f0, roughness, emission[3];
    uint32_t two_sided, cls, of_lights, texture, cutout;
    float transmittance;
} kept_material;

static kept_material keep(const noc_material *m) {
    kept_material k = { .f0 = m->f0,
                        .roughness = m->roughness,
                        .two_sided = m->two_sided,
                        .cls = m->cls,
                        .texture = (uint32_t)m->texture,
                        .cutout = m->cutout,
                        .transmittance = m->transmittance };
    memcpy(k.albedo, m->albedo, sizeof(k.albedo));
    memcpy(k.emission, m->emission, sizeof(k.emission));
    return k;
}

static noc_material kept(const kept_material *k) {
    noc_material m = { .f0 = k->f0, .roughness = k->roughness, .two_sided = k->two_sided != 0 };
    m.cls = (noc_class)NOC_MIN(k->cls, (uint32_t)NOC_CLASS_COUNT);
    m.transmittance = k->transmittance;
    m.cutout = k->cutout != 0;
    m.texture = (int)NOC_MIN(k->texture, (uint32_t)INT32_MAX);
    memcpy(m.albedo, k->albedo, sizeof(m.albedo));
    memcpy(m.emission, k->emission, sizeof(m.emission));
    return m;
}

void noc_keep_materials(noct_writer *w, const noc_scene *s) {
    noct_begin(w, "material");
    for (size_t i = 0; i < s->materials.len; i++) {
        kept_material k = keep(&s->materials.data[i]);
        k.of_lights = s->material_uses.data[i] != NOC_NOT_OF_LIGHTS;
        noct_put(w, &k, sizeof(k));
    }
    noct_end(w);
    if (!s->material_names.len)
        return;
    noct_begin(w, "matnames");
    for (size_t i = 0; i < s->material_names.len; i++)
        noct_put_u32(w, noct_name(w, s->material_names.data[i]));
    noct_end(w);
}

static noc_status kept_names(noct_file *f, noc_scene *s) {
    size_t count;
    const uint32_t *name = noct_array(f, "matnames", sizeof(*name), &count);
    if (f->status)
        return f->status;
    if (count > s->materials.len)
        return noct_wrong(f, "it has %zu names of materials", count);
    if (!array_reserve(&s->material_names, count))
        return noct_no_memory(f);
    for (size_t i = 0; i < count; i++)
        s->material_names.data[s->material_names.len++] = noct_name_at(f, name[i]);
    return f->status;
}

noc_status noc_kept_materials(noct_file *f, noc_scene *s) {
    size_t count;
    const kept_material *k = noct_array(f, "material", sizeof(*k), &count);
    if (count > INT32_MAX)
        return noct_wrong(f, "it has %zu materials", count);
    if (!array_reserve(&s->materials, count) || !array_reserve(&s->material_records, count) ||
        !array_reserve(&s->material_uses, count))
        return noct_no_memory(f);
    for (size_t i = 0; i < count; i++) {
        noc_material m = kept(&k[i]);
        if (noc_material_fault(s, &m))
            return noct_wrong(f, "material %zu: %s", i, noc_material_fault(s, &m));
        s->lets_through |= noc_material_lets_through(&m);
        s->materials.data[s->materials.len++] = m;
        s->material_records.data[s->material_records.len++] = noc_material_record_of(&m);
        s->material_uses.data[s->material_uses.len++] = k[i].of_lights ? 0 : NOC_NOT_OF_LIGHTS;
    }
    return kept_names(f, s);
}

/* ---- what was said of classes ---- */

typedef struct kept_class {
    uint32_t said;
    kept_material look;
} kept_class;

void noc_keep_classes(noct_writer *w, const noc_scene *s) {
    noct_begin(w, "classes");
    for (int c = 0; c < NOC_CLASS_COUNT; c++) {
        kept_class k = { s->class_said >> c & 1, keep(&s->class_looks[c]) };
        noct_put(w, &k, sizeof(k));
    }
    noct_end(w);
}

noc_status noc_kept_classes(noct_file *f, noc_scene *s) {
    size_t count;
    const kept_class *k = noct_array(f, "classes", sizeof(*k), &count);
    if (!f->status && count != NOC_CLASS_COUNT)
        return noct_wrong(f, "it has %zu classes", count);
    for (size_t c = 0; c < count; c++) {
        noc_material m = kept(&k[c].look);
        if (!k[c].said)
            continue;
        if (noc_material_fault(s, &m))
            return noct_wrong(f, "class %s: %s", noc_class_name((noc_class)c), noc_material_fault(s, &m));
        s->class_looks[c] = m;
        s->class_said |= 1u << c;
    }
    return f->status;
}

/* ---- meshes ---- */

enum { REMOVED = 1, PANES = 2 };
typedef struct kept_mesh {
    uint32_t first_triangle, triangle_count, first_vertex, material, name;
    uint16_t model, group;
    uint32_t flags, uv;
} kept_mesh;
_Static_assert(sizeof(kept_mesh) == 32, "it has no gaps");

void noc_keep_meshes(noct_writer *w, const noc_scene *s) {
    noct_begin(w, "meshes");
    for (size_t i = 0; i < s->meshes.len; i++) {
        const noc_scene_mesh *m = &s->meshes.data[i];
        kept_mesh k = { .first_triangle = m->first_triangle,
                        .triangle_count = m->triangle_count,
                        .first_vertex = m->first_vertex,
                        .material = (uint32_t)m->material,
                        .name = noct_name(w, m->name),
                        .model = m->model,
                        .group = m->group,
                        .uv = m->uv,
                        .flags = (m->removed ? REMOVED : 0) | (m->panes ? PANES : 0) };
        noct_put(w, &k, sizeof(k));
    }
    noct_end(w);
    noct_put_array(w, "vertices", s->positions.data, s->positions.len / 3, 3 * sizeof(float));
    noct_put_array(w, "corners", s->indices.data, s->indices.len / 3, 3 * sizeof(uint32_t));
    noct_put_array(w, "shown", s->triangle_light.data, s->triangle_light.len, sizeof(uint32_t));
    noct_put_array(w, "walls", s->walls.data, s->walls.len, sizeof(uint8_t));
}

/* Meshes lie one after the other, and share nothing. */
static bool mesh_fits(const noc_scene *s, const kept_mesh *k, size_t triangle, size_t vertex) {
    return k->first_triangle == triangle && k->triangle_count <= s->triangle_light.len - triangle &&
           k->first_vertex >= vertex && k->first_vertex <= s->positions.len / 3 && k->material < s->materials.len &&
           k->model <= s->models.len && k->group <= s->groups.len && k->flags <= (REMOVED | PANES);
}

static bool uv_fits(const noc_scene *s, size_t mesh) {
    const noc_scene_mesh *m = &s->meshes.data[mesh];
    size_t places = s->uv.len / 2;
    return !m->uv || (m->uv - 1 <= places && noc_mesh_end_vertex(s, mesh) - m->first_vertex <= places - (m->uv - 1));
}

static noc_status take_meshes(noct_file *f, noc_scene *s) {
    size_t count, triangle = 0, vertex = 0;
    const kept_mesh *k = noct_array(f, "meshes", sizeof(*k), &count);
    if (count > INT32_MAX)
        return noct_wrong(f, "it has %zu meshes", count);
    if (!array_reserve(&s->meshes, count))
        return noct_no_memory(f);
    for (size_t i = 0; i < count; i++) {
        if (!mesh_fits(s, &k[i], triangle, vertex))
            return noct_wrong(f, "mesh %zu is none", i);
        triangle += k[i].triangle_count;
        vertex = k[i].first_vertex;
        s->meshes.data[s->meshes.len++] = (noc_scene_mesh){ .first_triangle = k[i].first_triangle,
                                                            .triangle_count = k[i].triangle_count,
                                                            .first_vertex = k[i].first_vertex,
                                                            .material = (int)k[i].material,
                                                            .model = k[i].model,
                                                            .group = k[i].group,
                                                            .uv = k[i].uv,
                                                            .removed = k[i].flags & REMOVED,
                                                            .panes = (k[i].flags & PANES) != 0,
                                                            .name = noct_name_at(f, k[i].name) };
    }
    for (size_t i = 0; i < count; i++)
        if (!uv_fits(s, i))
            return noct_wrong(f, "mesh %zu has no place in an image", i);
    if (triangle != s->triangle_light.len || (!count && s->positions.len))
        return noct_wrong(f, "it has triangles of no mesh");
    return f->status;
}

static bool check_places(const void *ctx, size_t first, size_t end) {
    const noc_scene *s = ctx;
    return noc_kept_finite(s->positions.data + 3 * first, 3 * (end - first), 1e7f);
}

static bool check_walls(const void *ctx, size_t first, size_t end) {
    const uint8_t *walls = ctx;
    bool ok = true;
    for (size_t i = first; i < end; i++)
        ok &= walls[i] < NOC_WALL_VERDICT_COUNT;
    return ok;
}

typedef struct triangle_check {
    noc_scene *s;
    bool places_fit; /* all of them do: the usual case */
} triangle_check;

/* A mesh's triangles from first on have their corners in it, and show lights that there are. */
static bool check_mesh(const triangle_check *c, size_t mesh, size_t first, size_t end) {
    noc_scene *s = c->s;
    const noc_scene_mesh *m = &s->meshes.data[mesh];
    uint32_t lo = m->first_vertex, count = (uint32_t)(noc_mesh_end_vertex(s, mesh) - lo);
    const noc_scene_model *model = m->model ? &s->models.data[m->model - 1] : NULL;
    size_t lights = model ? model->lights.len + model->shown : s->lights.len;
    bool ok = true;
    for (size_t i = 3 * first; i < 3 * end; i++)
        ok &= s->indices.data[i] - lo < count;
    for (size_t i = 3 * first; ok && !c->places_fit && i < 3 * end; i++)
        ok = noc_kept_finite(s->positions.data + 3 * (size_t)s->indices.data[i], 3, 1e7f);
    for (size_t t = first; t < end; t++) {
        ok &= s->triangle_light.data[t] < lights || s->triangle_light.data[t] == NOC_NO_LIGHT;
        s->triangle_material.data[t] = (uint32_t)m->material;
    }
    return ok;
}

static bool check_triangles(const void *ctx, size_t first, size_t end) {
    const triangle_check *c = ctx;
    bool ok = true;
    for (size_t mesh = noc_scene_mesh_of(c->s, first), t = first; ok && t < end; mesh++) {
        const noc_scene_mesh *m = &c->s->meshes.data[mesh];
        size_t last = NOC_MIN((size_t)m->first_triangle + m->triangle_count, end);
        if (last > t)
            ok = check_mesh(c, mesh, t, last);
        t = NOC_MAX(t, last);
    }
    return ok;
}

/* Of a light that was added as one a mesh shows that alone; of others those that come and go with it. */
static bool shows_its_own(const noc_scene *s, uint32_t mesh, uint32_t *shown_by) {
    const noc_scene_mesh *m = &s->meshes.data[mesh];
    const uint32_t *light = s->triangle_light.data + m->first_triangle, none = NOC_NO_LIGHT;
    bool shape = light[0] != none && !(s->lights.data[light[0]].flags & NOC_LIGHT_OWNED);
    for (uint32_t t = 0; t < m->triangle_count; t++) {
        if (light[t] == none && !shape)
            continue;
        uint32_t flags = light[t] == none ? NOC_LIGHT_FREE : s->lights.data[light[t]].flags;
        if (flags & (NOC_LIGHT_FREE | NOC_LIGHT_MOVES) || (shape ? light[t] != light[0] : !(flags & NOC_LIGHT_OWNED)) ||
            (shown_by[light[t]] && shown_by[light[t]] != mesh + 1))
            return false;
        shown_by[light[t]] = mesh + 1;
    }
    return true;
}

/* Commits reserve room for what goes with an edit: they rely on it that no light is shown by two meshes. */
static noc_status check_shown(noct_file *f, const noc_scene *s) {
    uint32_t *shown_by = noc_calloc(s->lights.len, sizeof(*shown_by)); /* number of the mesh + 1 */
    if (!shown_by)
        return noct_no_memory(f);
    for (uint32_t i = 0; i < s->meshes.len && !f->status; i++) {
        const noc_scene_mesh *m = &s->meshes.data[i];
        if (m->triangle_count && !m->removed && !m->model && !shows_its_own(s, i, shown_by))
            noct_wrong(f, "mesh %u shows a light that is not its own", i);
    }
    free(shown_by);
    return f->status;
}

noc_status noc_kept_meshes(noct_file *f, noc_scene *s) {
    size_t vertices, triangles, shown, walls;
    float *places = noct_array(f, "vertices", 3 * sizeof(float), &vertices);
    uint32_t *corners = noct_array(f, "corners", 3 * sizeof(uint32_t), &triangles),
             *lights = noct_array(f, "shown", sizeof(uint32_t), &shown);
    uint8_t *verdicts = noct_array(f, "walls", sizeof(uint8_t), &walls);
    if (f->status || vertices > UINT32_MAX || triangles >= UINT32_MAX || shown != triangles || walls > triangles)
        return noct_wrong(f, "it has %zu vertices, %zu triangles", vertices, triangles);
    array_borrow(&s->positions, places, 3 * vertices);
    array_borrow(&s->indices, corners, 3 * triangles);
    array_borrow(&s->triangle_light, lights, triangles);
    array_borrow(&s->walls, verdicts, walls);
    if (!array_reserve(&s->triangle_material, triangles))
        return noct_no_memory(f);
    s->triangle_material.len = triangles;
    if (take_meshes(f, s))
        return f->status;
    triangle_check check = { s, noct_each(f, vertices, check_places, s) };
    if (!noct_each(f, triangles, check_triangles, &check))
        return noct_wrong(f, "a triangle has no corners, or shows a light that is none");
    if (check_shown(f, s))
        return f->status;
    return noct_each(f, walls, check_walls, verdicts) ? NOC_OK : noct_wrong(f, "the verdict on a wall is none");
}

void noc_kept_take(noct_file *f, noc_scene *s) {
    s->pages = f->bytes;
    s->page_bytes = f->pages;
    f->bytes = NULL;
}

void noc_kept_forget(noc_scene *s) {
    s->meshes.len = s->lights.len = s->windows.len = s->facades.len = s->triangle_facade.len = 0;
    s->profile_cells.len = 0;
}

noc_status noc_kept_done(noct_file *f, noc_scene *s) {
    if (!array_reserve(&s->gaps, s->meshes.len))
        return noct_no_memory(f);
    for (size_t i = 0; i < s->meshes.len; i++) {
        const noc_scene_mesh *m = &s->meshes.data[i];
        if (!noc_mesh_in_city(s, m))
            noc_scene_add_gap(s, m->first_triangle, m->triangle_count);
        if (!m->removed)
            noc_material_use(s, m);
    }
    s->first_later = s->meshes.len;
    s->committed = true;
    return NOC_OK;
}
