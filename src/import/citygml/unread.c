/* unread.c: what a file tells of an object's geometry that is not read, or not in full. */
#include "import/citygml/citygml.h"

#include <math.h>
#include <stdio.h>

static void tell(cg_parser *p, const char *what, const cg_frame *frame) {
    char id[300];
    noc_snprintf(id, sizeof(id), "%.80s of %.200s", what, cg_report_id(p, NULL, frame->feature));
    cg_issue(p, GEO_SKIPPED, "geometry that is not read", id);
}

/* What says something of a geometry beside its shape. */
static bool is_remark(const char *local) {
    static const char *const remarks[] = { "metaDataProperty", "description", "descriptionReference", "identifier" };
    for (size_t i = 0; i < NOC_COUNT(remarks); i++)
        if (!strcmp(local, remarks[i]))
            return true;
    return false;
}

/* Has no surface. */
static bool is_line(const char *local) {
    size_t n = strlen(local), k = strlen("Curve");
    return (n >= k && !strcmp(local + n - k, "Curve")) || !strcmp(local, "MultiLineString") ||
           !strcmp(local, "curveMembers") || !strcmp(local, "lineStringMember");
}

/* Of a Tin, from which its triangles follow. */
static bool is_of_tin(const char *local) {
    return !strcmp(local, "controlPoint") || !strcmp(local, "stopLines") || !strcmp(local, "breakLines") ||
           !strcmp(local, "maxLength");
}

void cg_unread(cg_parser *p, const cg_frame *frame, cg_frame *parent, const char *name) {
    const char *local = cg_local_name(name);
    bool gml = !strncmp(name, "http://www.opengis.net/gml", 26);
    if (parent && parent->name.code == CG_MEMBER &&
        frame->feature == CG_NONE) /* fine, but a person should hear of it */
        cg_issue(p, GEO_SKIPPED, "object type that is not read", local);
    bool holds = parent && (parent->name.code == CG_GEOMETRY_PROPERTY || parent->name.code == CG_SURFACE_PROPERTY);
    if (!parent || frame->geometry == CG_NONE || (!gml && !holds) || is_remark(local))
        return;
    if (gml && is_of_tin(local))
        parent->of_points |= !strcmp(local, "controlPoint");
    else if (!p->in_polygon && !is_line(local))
        tell(p, local, frame);
    else if (p->in_ring)
        cg_issue(p, GEO_GUESSED, "curve of a ring that is not read", cg_report_id(p, p->polygon_id, frame->feature));
}

void cg_tin_end(cg_parser *p, const cg_frame *frame) {
    if (frame->of_points && frame->first_polygon == p->polygons)
        tell(p, "Tin of control points", frame);
}

/* Returns the surface's polygon where it lies in the world; NULL: there is none. */
static cg_polygon *polygon_of(const cg_object *o, size_t i) {
    const cg_surface *s = &o->surfaces.data[i];
    return s->polygon && !o->geometries.data[s->geometry].implicit ? s->polygon : NULL;
}

static size_t points_of(const cg_polygon *polygon) {
    size_t points = 0;
    for (uint32_t r = 0; r < polygon->ring_count; r++)
        points += polygon->ring_size[r];
    return points;
}

void cg_fill_heights(cg_parser *p) {
    const cg_object *o = &p->object;
    double low = INFINITY;
    bool flat = false;
    for (size_t i = 0; i < o->surfaces.len; i++) {
        const cg_polygon *polygon = polygon_of(o, i);
        flat = flat || (polygon && polygon->flat);
        size_t points = polygon && !polygon->flat ? points_of(polygon) : 0;
        for (size_t k = 0; k < points; k++)
            low = NOC_MIN(low, polygon->xyz[3 * k + 2]);
    }
    for (size_t i = 0; flat && isfinite(low) && i < o->surfaces.len; i++) {
        cg_polygon *polygon = polygon_of(o, i);
        if (!polygon || !polygon->flat)
            continue;
        for (size_t k = 0, points = points_of(polygon); k < points; k++)
            polygon->xyz[3 * k + 2] = low;
        cg_issue(p, GEO_GUESSED, "surface without heights: put at the lowest height of its object",
                 cg_report_id(p, polygon->id, o->geometries.data[o->surfaces.data[i].geometry].feature));
    }
}
