#include "import/mesh/obj_mesh.h"
#include "import/mesh/polygons.h"

static uint64_t mixed(uint64_t hash, double x) {
    uint64_t bits;
    x += 0; /* no -0 */
    memcpy(&bits, &x, sizeof(bits));
    hash = (hash ^ bits) * 0x9e3779b97f4a7c15u; /* 2^64 over the golden ratio (Knuth, TAOCP 3, 6.4) */
    return hash ^ hash >> 32;
}

static size_t slot_of(const obj_builder *b, const double *xyz, const double *places) {
    uint64_t hash = 0;
    for (int k = 0; k < 3; k++)
        hash = mixed(hash, xyz[k]);
    for (int k = 0; k < 2 && places; k++)
        hash = mixed(hash, places[k]);
    return (size_t)hash & (b->found.len - 1);
}

static bool holds(const obj_builder *b, size_t vertex, const double *xyz, const double *places) {
    const double *p = b->xyz.data + 3 * vertex, *q = places ? b->places.data + 2 * vertex : NULL;
    return p[0] == xyz[0] && p[1] == xyz[1] && p[2] == xyz[2] && (!q || (q[0] == places[0] && q[1] == places[1]));
}

/* Room for one vertex more. */
static bool widen(obj_builder *b, bool placed) {
    size_t vertices = b->xyz.len / 3, slots = NOC_MAX(b->found.len * 2, (size_t)64);
    if (2 * (vertices + 1) <= b->found.len)
        return true;
    if (!array_reserve(&b->found, slots))
        return false;
    memset(b->found.data, 0, slots * sizeof(*b->found.data));
    b->found.len = slots;
    for (size_t i = 0; i < vertices; i++) {
        size_t slot = slot_of(b, b->xyz.data + 3 * i, placed ? b->places.data + 2 * i : NULL);
        while (b->found.data[slot])
            slot = (slot + 1) & (slots - 1);
        b->found.data[slot] = (uint32_t)i + 1;
    }
    return true;
}

/* The mesh's vertex for a corner. false: no memory. */
static bool take_corner(obj_builder *b, size_t corner, bool placed, uint32_t *vertex) {
    static const double nowhere[2] = { 0, 0 };
    uint32_t from = b->text->corners.data[corner];
    uint32_t *made = &b->made[from];
    if (!placed && *made < b->from.len && b->from.data[*made] == from) {
        *vertex = *made;
        return true;
    }
    uint32_t place = placed ? b->text->uv_index.data[corner] : OBJ_NOWHERE;
    const double *places = !placed ? NULL : place == OBJ_NOWHERE ? nowhere : b->text->uv.data + 2 * (size_t)place;
    const double *xyz = b->text->xyz.data + 3 * (size_t)from;
    if (!widen(b, placed))
        return false;
    size_t slot = slot_of(b, xyz, places);
    for (; b->found.data[slot]; slot = (slot + 1) & (b->found.len - 1))
        if (holds(b, b->found.data[slot] - 1, xyz, places)) {
            *vertex = b->found.data[slot] - 1;
            return true;
        }
    *vertex = *made = (uint32_t)b->from.len;
    b->found.data[slot] = *vertex + 1;
    return array_push(&b->from, from) && array_append(&b->xyz, xyz, 3) &&
           (!placed || array_append(&b->places, places, 2));
}

/* Turned to z up, and the places to those in the image. */
static bool finish_vertices(obj_builder *b, const obj_image *image) {
    size_t vertices = b->xyz.len / 3;
    for (size_t i = 0; i < vertices; i++) {
        double *v = b->xyz.data + 3 * i, y = v[1], z = v[2];
        v[0] += 0; /* no -0 */
        v[1] = b->to->z_up ? y + 0 : 0 - z;
        v[2] = b->to->z_up ? z + 0 : y + 0;
    }
    b->uv.len = 0;
    if (!image)
        return true;
    if (!array_reserve(&b->uv, 2 * vertices))
        return false;
    for (size_t i = 0; i < 2 * vertices; i++)
        b->uv.data[i] = (float)(b->places.data[i] * image->scale[i % 2] + image->offset[i % 2]);
    b->uv.len = 2 * vertices;
    return true;
}

/* Puts the polygons' triangles behind the others. */
static bool join_polygons(obj_builder *b, cut_mesh *cut) {
    size_t vertices = b->xyz.len / 3, corners = cut->extra.indices.len;
    b->indices.len = 3 * cut->triangle_count;
    bool memory = !cut->extra.no_memory && array_append(&b->xyz, cut->extra.xyz.data, cut->extra.xyz.len) &&
                  (!cut->uv || array_append(&b->uv, cut->extra.uv.data, cut->extra.uv.len)) &&
                  array_reserve(&b->indices, b->indices.len + corners);
    for (size_t i = 0; i < corners && memory; i++)
        b->indices.data[b->indices.len++] = (uint32_t)vertices + cut->extra.indices.data[i];
    return memory;
}

/* Vertices of the faces of that kind, in the order in which they name them. */
static bool take_faces(obj_builder *b, const obj_mesh *mesh, size_t last, bool polygons, bool placed, size_t *faces) {
    b->from.len = b->found.len = b->xyz.len = b->places.len = b->corners.len = *faces = 0;
    for (size_t face = mesh->first_face, corner = mesh->first_corner; face < last; face++) {
        size_t count = b->text->faces.data[face];
        for (size_t i = 0; i < count && polygons == (count > 3); i++) {
            uint32_t vertex = 0;
            if (!take_corner(b, corner + i, placed, &vertex) || !array_push(&b->corners, vertex))
                return false;
        }
        corner += count;
        *faces += polygons == (count > 3);
    }
    return true;
}

static bool cut_faces(obj_builder *b, const obj_mesh *mesh, size_t last, bool polygons, size_t faces, cut_mesh *cut) {
    if (!array_reserve(&b->indices, 6 * faces))
        return false;
    cut->xyz = b->xyz.data;
    cut->uv = b->uv.len ? b->uv.data : NULL;
    cut->indices = b->indices.data;
    for (size_t face = mesh->first_face, corner = 0; face < last; face++) {
        size_t count = b->text->faces.data[face];
        if (polygons != (count > 3))
            continue;
        cut_face(cut, b->corners.data + corner, count);
        corner += count;
    }
    return join_polygons(b, cut);
}

static noc_status add_faces(obj_builder *b, const obj_mesh *mesh, size_t last, bool polygons, int material,
                            const obj_image *image) {
    const mesh_parts *parts = b->to->parts;
    const char *name = mesh->name ? mesh->name : "unnamed";
    size_t faces;
    cut_mesh cut = { .issues = parts->issues, .name = name };
    bool memory = take_faces(b, mesh, last, polygons, image != NULL, &faces);
    if (memory && !faces)
        return NOC_OK;
    memory = memory && finish_vertices(b, image) && cut_faces(b, mesh, last, polygons, faces, &cut);
    geo_triangles_free(&cut.extra);
    if (!memory)
        return noc_no_memory(parts->log, name);
    size_t vertices = b->xyz.len / 3, triangles = b->indices.len / 3;
    obj_spread_add(b->to->spread, b->xyz.data, vertices, b->indices.data, triangles);
    noc_mesh made = { .vertex_count = vertices,
                      .positions = b->xyz.data,
                      .triangle_count = triangles,
                      .indices = b->indices.data,
                      .material = material,
                      .uv = b->uv.len ? b->uv.data : NULL,
                      .name = mesh->name };
    return parts->mesh(parts->ctx, &made, b->xyz.data);
}

noc_status obj_add_mesh(obj_builder *b, size_t mesh, int material, const obj_image *image) {
    const obj_text *t = b->text;
    const obj_mesh *of = &t->meshes.data[mesh];
    size_t last = mesh + 1 < t->meshes.len ? of[1].first_face : t->faces.len;
    if (!b->made && !(b->made = noc_calloc(t->xyz.len / 3 + 1, sizeof(*b->made))))
        return noc_no_memory(b->to->parts->log, "OBJ");
    noc_status status = add_faces(b, of, last, false, material, image);
    return status ? status : add_faces(b, of, last, true, material, image);
}

void obj_builder_free(obj_builder *b) {
    free(b->made);
    array_free(&b->from);
    array_free(&b->found);
    array_free(&b->xyz);
    array_free(&b->places);
    array_free(&b->uv);
    array_free(&b->indices);
    array_free(&b->corners);
}
