/* What scenes that are joined have in common, and have once: groups and profiles of lights, textures, materials and
 * models. */
#include "scene/join.h"

#include "noct/noct.h"

bool noc_join_name(noc_joiner *j, const char *name, const char **kept) {
    if (!name || name != j->name_before) {
        if (!noc_scene_keep_name(j->to, name, &j->kept_before))
            return noc_join_no_memory(j);
        j->name_before = name;
    }
    *kept = name ? j->kept_before : NULL;
    return true;
}

bool noc_join_no_memory(noc_joiner *j) {
    j->status = j->status ? j->status : noc_scene_out_of_memory(j->to);
    return false;
}

bool noc_join_too_many(noc_joiner *j, const char *what) {
    if (!j->status)
        j->status = noc_error(j->to->log, NOC_ERR_UNSUPPORTED, "%s: with it the scene has too many %s: open fewer",
                              j->name, what);
    return false;
}

bool noc_join_spend(noc_joiner *j, size_t *left, size_t count) {
    if (count > *left && !j->status)
        j->status = noc_error(j->to->log, NOC_ERR_FORMAT, "%s: damaged: parts of it lie over one another", j->name);
    *left -= j->status ? 0 : count;
    return !j->status;
}

static uint32_t too_many(noc_joiner *j, const char *what) {
    noc_join_too_many(j, what);
    return NOC_JOIN_NONE;
}

static uint32_t no_memory(noc_joiner *j) {
    noc_join_no_memory(j);
    return NOC_JOIN_NONE;
}

/* ---- groups of lights ---- */

static noc_status join_group(noc_joiner *j, size_t number) {
    const noc_scene_group *g = &j->from->groups.data[number - 1];
    size_t before = j->to->groups.len;
    bool nameless = !g->name && number <= before && !j->to->groups.data[number - 1].name; /* known by its number */
    int made = nameless ? (int)number : noc_scene_group_named(j->to, g->name);
    if (made <= 0)
        return j->to->no_memory ? NOC_ERR_MEMORY : NOC_ERR_UNSUPPORTED; /* said */
    noc_scene_group *there = &j->to->groups.data[made - 1];
    if (j->to->groups.len > before) {
        memcpy(there->scale, g->scale, sizeof(there->scale));
        memcpy(there->colour, g->colour, sizeof(there->colour));
    } else if (memcmp(there->scale, g->scale, sizeof(g->scale)) || memcmp(there->colour, g->colour, sizeof(g->colour)))
        return noc_error(j->to->log, NOC_ERR_ARGUMENT,
                         "%s: its lights of the group \"%.60s\" are dimmed or coloured otherwise than those of %s: "
                         "build both with the same --group",
                         j->name, g->name ? g->name : "", j->first);
    j->group[number] = (uint32_t)made;
    return NOC_OK;
}

noc_status noc_join_groups(noc_joiner *j) {
    noc_status status = NOC_OK;
    j->group[0] = 0;
    for (size_t i = 1; i <= j->from->groups.len && !status; i++)
        status = join_group(j, i);
    return status;
}

/* ---- profiles ---- */

enum { HEADS = LIGHT_PROFILE_BITS >> LIGHT_PROFILE, CELL = 4 };

/* Where a profile's table begins, with its window, and its cells. */
static size_t table_of(const noc_scene *s, size_t number, size_t *cells) {
    const float *head = s->profile_cells.data + CELL * (number - 1);
    uint32_t place, steps;
    memcpy(&place, head, sizeof(place));
    memcpy(&steps, head + 1, sizeof(steps));
    size_t window = steps >> PROFILE_POLE ? 1 : 0;
    *cells = (size_t)(steps >> 16 & PROFILE_ROWS) * (steps & 0xffff) + window;
    return place - window;
}

static bool same_profile(const noc_scene *a, size_t x, const noc_scene *b, size_t y) {
    const noc_scene_profile *p = &a->profiles.data[x - 1], *q = &b->profiles.data[y - 1];
    const float *one = a->profile_cells.data, *other = b->profile_cells.data;
    size_t cells, others, first = table_of(a, x, &cells), at = table_of(b, y, &others);
    return p->peak == q->peak && p->strength == q->strength && p->upward == q->upward && !strcmp(p->name, q->name) &&
           cells == others && !memcmp(one + CELL * (x - 1) + 1, other + CELL * (y - 1) + 1, 3 * sizeof(float)) &&
           !memcmp(one + CELL * first, other + CELL * at, CELL * cells * sizeof(float));
}

static uint32_t add_profile(noc_joiner *j, size_t number) {
    noc_scene *to = j->to;
    noc_scene_profile p = j->from->profiles.data[number - 1];
    size_t cells, at = table_of(j->from, number, &cells);
    size_t first = NOC_MAX(to->profile_cells.len / CELL, (size_t)HEADS), made = to->profiles.len;
    if (!noc_join_spend(j, &j->cells_left, cells))
        return NOC_JOIN_NONE;
    if (made == HEADS || first + cells > UINT32_MAX)
        return too_many(j, "profiles of lamps");
    if (!noc_join_name(j, p.name, &p.name) || !array_reserve(&to->profile_cells, CELL * (first + cells)) ||
        !array_push(&to->profiles, p))
        return no_memory(j);
    if (!to->profile_cells.len)
        memset(to->profile_cells.data, 0, CELL * first * sizeof(float));
    to->profile_cells.len = CELL * (first + cells);
    float *head = to->profile_cells.data + CELL * made;
    uint32_t steps;
    memcpy(head, j->from->profile_cells.data + CELL * (number - 1), CELL * sizeof(float));
    memcpy(&steps, head + 1, sizeof(steps));
    uint32_t place = (uint32_t)first + (steps >> PROFILE_POLE ? 1 : 0);
    memcpy(head, &place, sizeof(place));
    memcpy(to->profile_cells.data + CELL * first, j->from->profile_cells.data + CELL * at,
           CELL * cells * sizeof(float));
    return (uint32_t)made + 1;
}

uint32_t noc_join_profile(noc_joiner *j, uint32_t profile) {
    for (size_t i = 1; profile && i <= j->to->profiles.len && j->profile[profile] == NOC_JOIN_NONE; i++)
        if (same_profile(j->to, i, j->from, profile))
            j->profile[profile] = (uint32_t)i;
    if (profile && j->profile[profile] == NOC_JOIN_NONE)
        j->profile[profile] = add_profile(j, profile);
    return profile ? j->profile[profile] : 0;
}

bool noc_join_light(noc_joiner *j, noc_light_record *r) {
    uint32_t profile = noc_join_profile(j, (r->flags & LIGHT_PROFILE_BITS) >> LIGHT_PROFILE);
    uint32_t flags = r->flags & ((1u << LIGHT_PROFILE) - 1) & ~NOC_LIGHT_LATER;
    r->flags = flags | profile << LIGHT_PROFILE | j->group[noc_light_group(r)] << NOC_LIGHT_GROUP;
    return profile != NOC_JOIN_NONE;
}

/* ---- textures and materials ---- */

static size_t level_words(const uint32_t *head, uint32_t level) {
    return (size_t)(head[2 + 2 * level] & 0xffff) * (head[2 + 2 * level] >> 16);
}

static uint32_t add_texture(noc_joiner *j, const noc_scene_texture *of) {
    noc_scene *to = j->to;
    const uint32_t *head = j->from->texels.data + of->place;
    size_t first = to->texels.len, words = TEXTURE_HEAD;
    for (uint32_t l = 0; l < (head[0] & 0xff); l++)
        words += level_words(head, l);
    if (!noc_join_spend(j, &j->texels_left, words))
        return NOC_JOIN_NONE;
    if (first + words > INT32_MAX)
        return too_many(j, "textures");
    noc_scene_texture made = { (uint32_t)first, { of->content[0], of->content[1] } };
    if (!array_reserve(&to->texels, first + words) || !array_push(&to->textures, made))
        return no_memory(j);
    uint32_t *copy = to->texels.data + first;
    memcpy(copy, head, TEXTURE_HEAD * sizeof(*copy));
    size_t at = TEXTURE_HEAD;
    for (uint32_t l = 0; l < (head[0] & 0xff); l++) {
        copy[1 + 2 * l] = (uint32_t)(first + at);
        memcpy(copy + at, j->from->texels.data + head[1 + 2 * l], level_words(head, l) * sizeof(*copy));
        at += level_words(head, l);
    }
    to->texels.len = first + words;
    return (uint32_t)to->textures.len;
}

static uint32_t join_texture(noc_joiner *j, uint32_t texture) {
    if (!texture || j->texture[texture] != NOC_JOIN_NONE)
        return texture ? j->texture[texture] : 0;
    const noc_scene_texture *of = &j->from->textures.data[texture - 1];
    const uint32_t *head = j->from->texels.data + of->place;
    char key[80];
    uint64_t number;
    noc_snprintf(key, sizeof(key), "%016llx%016llx %x %x", (unsigned long long)of->content[0],
                 (unsigned long long)of->content[1], head[0], head[2]);
    if (!map_get(&j->textures, key, &number)) {
        number = add_texture(j, of);
        if (number == NOC_JOIN_NONE)
            return NOC_JOIN_NONE;
        if (!map_put(&j->textures, key, number, NULL))
            return no_memory(j);
    }
    return j->texture[texture] = (uint32_t)number;
}

static uint32_t add_material(noc_joiner *j, const noc_material *m, uint32_t uses, const char *name) {
    noc_scene *to = j->to;
    size_t made = to->materials.len;
    const char *kept;
    if (made >= INT32_MAX - 1)
        return too_many(j, "materials");
    if (!noc_join_name(j, name, &kept) || !array_push(&to->materials, *m) ||
        !array_push(&to->material_records, noc_material_record_of(m)) || !array_push(&to->material_uses, uses))
        return no_memory(j);
    to->lets_through |= noc_material_lets_through(m);
    for (size_t i = to->material_names.len; kept && i <= made; i++)
        if (!array_push(&to->material_names, i < made ? NULL : kept))
            return no_memory(j);
    return (uint32_t)made;
}

/* What tells a material. NULL: no memory. */
static char *material_key(const noc_material *m, uint32_t uses, const char *name) {
    struct {
        float albedo[3], emission[3], f0, roughness, transmittance;
        int32_t cls, texture, two_sided, cutout, of_lights;
    } key = { .f0 = m->f0,
              .roughness = m->roughness,
              .transmittance = m->transmittance,
              .cls = (int32_t)m->cls,
              .texture = m->texture,
              .two_sided = m->two_sided,
              .cutout = m->cutout,
              .of_lights = uses != NOC_NOT_OF_LIGHTS };
    memcpy(key.albedo, m->albedo, sizeof(key.albedo));
    memcpy(key.emission, m->emission, sizeof(key.emission));
    char text[2 * sizeof(key) + 1];
    const unsigned char *bytes = (const unsigned char *)&key;
    for (size_t i = 0; i < sizeof(key); i++)
        snprintf(text + 2 * i, 3, "%02x", bytes[i]);
    return noc_format("%s%s%s", text, name ? "=" : "", name ? name : "");
}

uint32_t noc_join_material(noc_joiner *j, uint32_t material) {
    if (j->material[material] != NOC_JOIN_NONE)
        return j->material[material];
    const noc_scene *from = j->from;
    noc_material m = from->materials.data[material];
    const char *name = material < from->material_names.len ? from->material_names.data[material] : NULL;
    uint32_t uses = from->material_uses.data[material] == NOC_NOT_OF_LIGHTS ? NOC_NOT_OF_LIGHTS : 0;
    uint32_t texture = join_texture(j, (uint32_t)m.texture);
    if (texture == NOC_JOIN_NONE)
        return NOC_JOIN_NONE;
    m.texture = (int)texture;
    uint64_t number;
    char *key = material_key(&m, uses, name);
    if (!key)
        return no_memory(j);
    if (!map_get(&j->materials, key, &number)) {
        number = add_material(j, &m, uses, name);
        if (number != NOC_JOIN_NONE && !map_put(&j->materials, key, number, NULL))
            number = no_memory(j);
    }
    free(key);
    return j->material[material] = (uint32_t)number;
}

/* ---- models ---- */

static uint64_t sum_of(const void *data, size_t count, size_t size) { return count ? noct_sum(data, count * size) : 0; }

/* A number for all of a mesh that is seen; false after reporting. */
static bool sum_mesh(noc_joiner *j, size_t mesh, uint64_t sum[8]) {
    const noc_scene *s = j->from;
    const noc_scene_mesh *m = &s->meshes.data[mesh];
    size_t vertices = noc_mesh_end_vertex(s, mesh) - m->first_vertex, corners = 3 * (size_t)m->triangle_count;
    uint32_t material = noc_join_material(j, (uint32_t)m->material);
    uint32_t *own = noc_alloc(NOC_MAX(corners, (size_t)1) * sizeof(*own));
    if (material == NOC_JOIN_NONE || !own) {
        free(own);
        return material != NOC_JOIN_NONE && noc_join_no_memory(j);
    }
    for (size_t i = 0; i < corners; i++)
        own[i] = s->indices.data[3 * (size_t)m->first_triangle + i] - m->first_vertex;
    sum[1] = sum_of(s->positions.data + 3 * (size_t)m->first_vertex, 3 * vertices, sizeof(float));
    sum[2] = sum_of(own, corners, sizeof(*own));
    sum[3] = sum_of(s->triangle_light.data + m->first_triangle, m->triangle_count, sizeof(uint32_t));
    sum[4] = m->uv ? 1 + sum_of(s->uv.data + 2 * (size_t)(m->uv - 1), 2 * vertices, sizeof(float)) : 0;
    sum[5] = (uint64_t)material << 32 | (uint64_t)j->group[m->group] << 1 | m->panes;
    sum[6] = (uint64_t)m->triangle_count << 32 | vertices;
    sum[7] = m->name ? sum_of(m->name, strlen(m->name), 1) : 1;
    sum[0] = sum_of(sum, 8, sizeof(*sum)); /* with that of the meshes before */
    free(own);
    return true;
}

/* What tells a model; NULL after reporting. lights: its own, as `to` has them. */
static char *model_key(noc_joiner *j, uint32_t model, const noc_light_record *lights) {
    const noc_scene_model *m = &j->from->models.data[model - 1];
    uint64_t sum[8] = { 0 };
    size_t meshes = 0;
    for (uint32_t i = j->model_mesh[model]; i; i = j->next_mesh[i - 1], meshes++)
        if (!sum_mesh(j, i - 1, sum))
            return NULL;
    char *key = noc_format("%016llx %016llx %zu %zu %u %s", (unsigned long long)sum[0],
                           (unsigned long long)sum_of(lights, m->lights.len, sizeof(*lights)), meshes, m->lights.len,
                           m->shown, m->name ? m->name : "");
    if (!key)
        no_memory(j);
    return key;
}

/* Its lights, as `to` has them; NULL after reporting. */
static noc_light_record *lights_of(noc_joiner *j, const noc_scene_model *m) {
    noc_light_record *lights = noc_calloc(NOC_MAX(m->lights.len, (size_t)1), sizeof(*lights));
    if (!lights)
        no_memory(j);
    for (size_t i = 0; lights && i < m->lights.len; i++) {
        lights[i] = m->lights.data[i];
        if (!noc_join_light(j, &lights[i])) {
            free(lights);
            return NULL;
        }
    }
    return lights;
}

static uint32_t add_model(noc_joiner *j, uint32_t model, const noc_light_record *lights) {
    const noc_scene_model *m = &j->from->models.data[model - 1];
    noc_scene_model made = { .shown = m->shown };
    memcpy(made.bounds_min, m->bounds_min, sizeof(made.bounds_min));
    memcpy(made.bounds_max, m->bounds_max, sizeof(made.bounds_max));
    if (j->to->models.len == UINT16_MAX)
        return too_many(j, "models");
    if (!noc_join_name(j, m->name, &made.name) || !array_push(&j->to->models, made))
        return no_memory(j);
    uint32_t number = (uint32_t)j->to->models.len;
    noc_scene_model *to = &j->to->models.data[number - 1];
    to->first_mesh = (uint32_t)j->to->meshes.len;
    if (!array_append(&to->lights, lights, m->lights.len) || !array_reserve(&to->light_names, m->lights.len))
        return no_memory(j);
    for (size_t i = 0; i < m->lights.len; i++)
        if (!noc_join_name(j, m->light_names.data[i], &to->light_names.data[to->light_names.len++]))
            return NOC_JOIN_NONE;
    for (uint32_t i = j->model_mesh[model]; i; i = j->next_mesh[i - 1])
        if (!noc_join_mesh(j, i - 1, number))
            return NOC_JOIN_NONE;
    to->end_mesh = (uint32_t)j->to->meshes.len;
    return number;
}

uint32_t noc_join_model(noc_joiner *j, uint32_t model) {
    if (j->model[model] != NOC_JOIN_NONE)
        return j->model[model];
    uint64_t number = NOC_JOIN_NONE;
    noc_light_record *lights = lights_of(j, &j->from->models.data[model - 1]);
    char *key = lights ? model_key(j, model, lights) : NULL;
    if (key && !map_get(&j->models, key, &number)) {
        number = add_model(j, model, lights);
        if (number != NOC_JOIN_NONE && !map_put(&j->models, key, number, NULL))
            number = no_memory(j);
    }
    free(key);
    free(lights);
    return j->model[model] = (uint32_t)number;
}
