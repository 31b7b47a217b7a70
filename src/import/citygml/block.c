/* block.c: buildings of which a file has outlines and heights alone become blocks, as those of maps do. */
#include "import/citygml/citygml.h"

#include <math.h>

#define STOREY 3.0       /* m, where storeys are all that is told */
#define LEAST_HEIGHT 0.5 /* m: a lower one is none */

/* m, of the part that has it or of what it is a part of; 0: nothing tells. */
static double height_of(const cg_parser *p, uint32_t feature) {
    const cg_object *object = &p->object;
    for (; feature != CG_NONE; feature = object->features.data[feature].parent)
        if (object->features.data[feature].height > 0)
            return object->features.data[feature].height;
    return object->storeys * STOREY;
}

/* Outlines on the ground are taken before those of roofs, and these before what says neither. */
static cg_role best_role(const cg_parser *p) {
    static const cg_role order[] = { CG_ROLE_FOOTPRINT, CG_ROLE_ROOF_EDGE, CG_ROLE_SURFACES, CG_ROLE_SOLID };
    const cg_selection *s = &p->selection;
    for (size_t k = 0; k < NOC_COUNT(order); k++)
        for (size_t i = 0; i < s->items.len; i++)
            if (s->items.data[i].shown && p->object.geometries.data[s->items.data[i].geometry].role == order[k])
                return order[k];
    return CG_ROLE_SOLID;
}

typedef struct emission {
    cg_parser *p;
    const char *id;
} emission;

static bool emit(void *ctx, noc_class cls, size_t rings, const size_t *sizes, const double *xyz) {
    const emission *e = ctx;
    const geo_polygon polygon = { .cls = cls, .id = e->id, .ring_count = rings, .ring_size = sizes, .xyz = xyz };
    cg_stop(e->p, e->p->sink->polygon(e->p->sink->ctx, &polygon));
    e->p->emitted++;
    return !e->p->status;
}

static void emit_block(cg_parser *p, const cg_polygon *polygon, const cg_geometry *g, double height) {
    cg_tell_crs(p, polygon->srs);
    cg_emit_begin(p);
    if (p->status)
        return;
    cg_transform(p, polygon, NULL, false);
    if (p->status)
        return;
    height /= p->sink->height_unit ? p->sink->height_unit(p->sink->ctx) : 1;
    double z = INFINITY, degree = p->lat_first || (p->out.len && fabs(p->out.data[0]) <= 180) ? 1e-8 : 1e-3;
    for (size_t i = 2; i < p->out.len; i += 3)
        z = fmin(z, p->out.data[i]);
    if (geo_height_is_none(z)) {
        geo_issue(p->sink->issues, GEO_GUESSED, "outline of a building at a height such as -9999, taken as missing",
                  cg_report_id(p, polygon->id, g->feature));
        z = 0;
    }
    /* an edge of a roof at 0 lies there for want of a height */
    double low = g->role == CG_ROLE_ROOF_EDGE && z != 0 ? z - height : z;
    const geo_block block = { p->out_rings.len, p->out_rings.data, p->out.data, low, low + height,
                              degree,           NOC_CLASS_GROUND };
    emission e = { p, cg_report_id(p, polygon->id, g->feature) };
    if (!geo_block_make(&block, emit, &e) && !p->status)
        cg_no_memory(p);
}

bool cg_emit_blocks(cg_parser *p) {
    const cg_object *object = &p->object;
    const cg_selection *s = &p->selection;
    if (s->lod != 0 || s->above || !s->shown || object->features.data[0].type->kind != GEO_BUILDING)
        return false;
    cg_role role = best_role(p);
    for (size_t i = 0; i < s->items.len; i++) {
        const cg_item *item = &s->items.data[i];
        const cg_geometry *g = &object->geometries.data[item->geometry];
        if (!item->shown || g->role != role || (!g->implicit && height_of(p, g->feature) >= LEAST_HEIGHT))
            continue;
        geo_issue(p->sink->issues, GEO_GUESSED, "building that is a flat outline, without a height",
                  cg_report_id(p, NULL, g->feature));
        return false;
    }
    for (size_t i = 0; i < s->items.len && !p->status; i++) {
        const cg_item *item = &s->items.data[i];
        const cg_geometry *g = &object->geometries.data[item->geometry];
        if (item->shown && g->role == role)
            emit_block(p, item->polygon, g, height_of(p, g->feature));
    }
    geo_issue(p->sink->issues, GEO_GUESSED, "building of an outline and a height: a block with a flat roof",
              cg_report_id(p, NULL, 0));
    cg_emit_end(p);
    return true;
}
