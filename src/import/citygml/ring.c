/* ring.c: from coordinates to polygons. */
#include "import/citygml/citygml.h"

#include <math.h>

const char *cg_report_id(const cg_parser *p, const char *polygon_id, uint32_t feature) {
    if (polygon_id)
        return polygon_id;
    const cg_feature *f = NULL;
    for (; feature < p->object.features.len; feature = f->parent) {
        f = &p->object.features.data[feature];
        if (*f->id)
            return f->id;
    }
    return f ? f->type->name : "";
}

void cg_polygon_begin(cg_parser *p, const char *id, bool simple) {
    p->in_polygon = true;
    p->polygons++;
    p->has_exterior = p->polygon_counted = p->polygon_flat = false;
    p->polygon_id = id;
    p->xyz.len = 0;
    p->rings.len = 0;
    p->ring_uv.len = 0;
    p->polygon_texture = p->polygon_material = 0;
    p->polygon_unplaced = false;
    if (simple)
        cg_ring_begin(p, true, id);
}

void cg_ring_begin(cg_parser *p, bool exterior, const char *id) {
    p->ring_id.len = 0;
    if (!array_append(&p->ring_id, id ? id : "", (id ? strlen(id) : 0) + 1))
        cg_no_memory(p);
    p->in_ring = true;
    p->ring_exterior = exterior;
    p->ring_fault = NULL;
    p->ring_curved = p->ring_flat = p->ring_high = false;
    p->ring_first = p->xyz.len;
}

/* Tuples of 2 or 3 numbers; 2 lie at height 0 until cg_fill_heights. Joints of a ring's curves, which repeat the point
 * before, stay: cleaning polygons is geo's business. */
static void add_tuples(cg_parser *p, uint32_t dimension) {
    const double *values = p->numbers.values.data;
    size_t count = p->numbers.values.len;
    if (!array_reserve(&p->xyz, p->xyz.len + count / dimension * 3)) {
        cg_no_memory(p);
        return;
    }
    p->ring_flat |= dimension == 2;
    p->ring_high |= dimension == 3;
    for (size_t i = 0; i < count; i += dimension) {
        double *xyz = p->xyz.data + p->xyz.len;
        xyz[0] = values[i];
        xyz[1] = values[i + 1];
        xyz[2] = dimension == 3 ? values[i + 2] : 0;
        p->xyz.len += 3;
    }
}

void cg_ring_add(cg_parser *p, cg_code code, uint32_t dimension) {
    cg_numbers_end(&p->numbers);
    size_t count = p->numbers.values.len;
    if (code == CG_POS)
        dimension = count == 2 || count == 3 ? (uint32_t)count : 0;
    else if (code == CG_COORDINATES)
        dimension = p->numbers.tuple;
    else if (!dimension)
        dimension = 3;
    if (p->numbers.bad)
        p->ring_fault = "coordinates that are not numbers";
    else if (p->numbers.many || p->xyz.len + count > cg_most_numbers)
        p->ring_fault = "polygon with too many points";
    else if (!count && code != CG_POS)
        return; /* an empty list: too few points, found at the ring's end */
    else if ((dimension != 2 && dimension != 3) || count % dimension)
        p->ring_fault = "incomplete coordinates";
    else
        add_tuples(p, dimension);
}

void cg_ring_end(cg_parser *p, const cg_frame *frame) {
    p->in_ring = false;
    const char *id = cg_report_id(p, p->polygon_id, frame->feature);
    size_t points = (p->xyz.len - p->ring_first) / 3;
    bool closed = false;
    if (!p->ring_fault && points > 1) {
        const double *first = p->xyz.data + p->ring_first, *last = p->xyz.data + p->xyz.len - 3;
        closed = first[0] == last[0] && first[1] == last[1] && first[2] == last[2];
        points -= closed;
        p->xyz.len -= closed ? 3 : 0;
    }
    if (!p->ring_fault && points < 3)
        p->ring_fault = "ring with too few points";
    else if (!p->ring_fault && p->ring_exterior && p->has_exterior)
        p->ring_fault = "polygon with a second exterior ring";
    else if (!p->ring_fault && p->ring_flat && (p->ring_high || (p->has_exterior && !p->polygon_flat)))
        p->ring_fault = "ring whose points have no heights, beside others";
    if (p->ring_fault) {
        cg_issue(p, GEO_SKIPPED, p->ring_fault, id);
        p->polygon_counted = true;
        p->xyz.len = p->ring_first;
        return;
    }
    if (!closed && frame->name.value != CG_SIMPLE)
        cg_issue(p, GEO_REPAIRED, "ring not closed", id);
    if (p->ring_curved)
        cg_issue(p, GEO_GUESSED, "arc taken as straight lines", id);
    if (p->ring_exterior && p->rings.len) {
        /* The schema has the exterior first, so holes before it have lost their place. */
        cg_issue(p, GEO_SKIPPED, "interior ring before the exterior one", id);
        memmove(p->xyz.data, p->xyz.data + p->ring_first, points * 3 * sizeof(double));
        p->xyz.len = points * 3;
        p->rings.len = 0;
        p->ring_uv.len = 0;
    }
    cg_ring_look(p, p->ring_id.data, points, id);
    p->has_exterior |= p->ring_exterior;
    p->polygon_flat |= p->ring_flat;
    if (!array_push(&p->rings, points))
        cg_no_memory(p);
}

static void *arena_copy(noc_arena *arena, const void *data, size_t size) {
    void *to = arena_alloc(arena, size);
    return to ? memcpy(to, data, size) : NULL;
}

void cg_polygon_end(cg_parser *p, const cg_frame *frame) {
    if (frame->name.value == CG_SIMPLE)
        cg_ring_end(p, frame);
    p->in_polygon = false;
    if (!p->has_exterior) {
        if (!p->polygon_counted)
            cg_issue(p, GEO_SKIPPED, "polygon without an exterior ring",
                     cg_report_id(p, p->polygon_id, frame->feature));
        return;
    }
    cg_object *object = &p->object;
    cg_polygon polygon = { .id = p->polygon_id,
                           .srs = frame->srs,
                           .flat = p->polygon_flat,
                           .ring_count = (uint32_t)p->rings.len,
                           .ring_size = p->rings.data,
                           .xyz = p->xyz.data,
                           .material = p->polygon_material ? p->polygon_material : cg_material_of(p, p->polygon_id) };
    if (p->polygon_texture && !p->polygon_unplaced) {
        polygon.texture = p->polygon_texture;
        polygon.uv = p->ring_uv.data;
    }
    /* Terrain has no levels to choose from and no references: it goes straight through, however large it is. */
    if (object->features.data[0].type->kind == GEO_TERRAIN) {
        if (p->pass != 1)
            return;
        if (polygon.flat)
            geo_issue(p->sink->issues, GEO_GUESSED, "terrain without heights: put at 0",
                      cg_report_id(p, p->polygon_id, frame->feature));
        cg_emit_polygon(p, &polygon, frame->geometry, frame->flip);
        return;
    }
    if (!cg_object_room(p))
        return;
    polygon.ring_size = arena_copy(&object->arena, p->rings.data, p->rings.len * sizeof(size_t));
    polygon.xyz = arena_copy(&object->arena, p->xyz.data, p->xyz.len * sizeof(double));
    if (polygon.uv)
        polygon.uv = arena_copy(&object->arena, p->ring_uv.data, p->ring_uv.len * sizeof(float));
    cg_surface surface = { .polygon = arena_copy(&object->arena, &polygon, sizeof(polygon)),
                           .geometry = frame->geometry,
                           .flip = frame->flip };
    if (!polygon.ring_size || !polygon.xyz || (polygon.texture && !polygon.uv) || !surface.polygon ||
        !array_push(&object->surfaces, surface))
        cg_no_memory(p);
}
