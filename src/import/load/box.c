/* The part of the inputs that --bbox takes: objects whose box meets it, terrain triangle by triangle, lamps. */
#include "import/load/load.h"

#include <math.h>

noc_status box_read(const noc_import_params *params, noc_log *log, load_box *box) {
    const char *text = params->bbox ? params->bbox : "", *at = text;
    double numbers[4];
    *box = (load_box){ 0 };
    if (!text[strspn(text, " \t")])
        return NOC_OK;
    for (int i = 0; i < 4 && at; i++) {
        at = noc_scan_double(at, at + strcspn(at, ","), &numbers[i]);
        if (at && i < 3)
            at = *at == ',' ? at + 1 : NULL;
    }
    at = at ? at + strspn(at, " \t") : NULL;
    if (!at || (*at && *at != ',') || (*at == ',' && !at[1]))
        return noc_error(log, NOC_ERR_ARGUMENT,
                         "bbox: \"%.60s\" is not X0,Y0,X1,Y1 or X0,Y0,X1,Y1,CRS, as in 4.30,52.07,4.32,52.08,EPSG:4326",
                         text);
    for (int k = 0; k < 2; k++) {
        box->lo[k] = numbers[k];
        box->hi[k] = numbers[k + 2];
        if (!(numbers[k] < numbers[k + 2]))
            return noc_error(log, NOC_ERR_ARGUMENT, "bbox: %c0 is %.10g and %c1 %.10g, which must be more", "XY"[k],
                             numbers[k], "XY"[k], numbers[k + 2]);
    }
    box->on = true;
    if (!*at)
        return NOC_OK;
    noc_status status;
    box->crs = geo_crs_create(at + 1, "--bbox", log, &status);
    return status && status != NOC_ERR_MEMORY ? NOC_ERR_ARGUMENT : status;
}

void box_free(load_box *box) { geo_crs_destroy(box->crs); }

/* The way from the scene to the CRS that the box is in, made once a reading; none where they are one. */
static noc_status prepare(reading *r) {
    importer *im = r->im;
    if (r->to_box_made)
        return NOC_OK;
    r->to_box_made = true;
    if (im->box.crs && !im->scene_crs)
        return noc_error(r->log, NOC_ERR_ARGUMENT, "bbox: the inputs name no CRS, so the box cannot have one");
    pthread_mutex_lock(&im->lock);
    const geo_crs *crs = im->box.crs ? im->box.crs : im->scene->given_crs;
    noc_status status = NOC_OK;
    if (crs)
        r->to_box = geo_transform_create(im->scene_crs, crs, r->log, &status);
    pthread_mutex_unlock(&im->lock);
    return status;
}

/* Local points where the box is, into r->in_box. */
static noc_status to_box(reading *r, const double *xyz, size_t count) {
    noc_status status = prepare(r);
    r->in_box.len = 0;
    if (status)
        return status;
    size_t values = 3 * count;
    if (!array_append(&r->in_box, xyz, values))
        return noc_no_memory(r->log, r->in->path);
    for (size_t i = 0; i < 3 * count; i++)
        r->in_box.data[i] += r->im->origin[i % 3];
    if (r->to_box)
        geo_transform_points(r->to_box, r->in_box.data, count); /* points without a place are NaN, in no box */
    return NOC_OK;
}

typedef struct bounds {
    double lo[2], hi[2];
} bounds;

static void widen(bounds *b, const double *point) {
    for (int k = 0; k < 2; k++) {
        b->lo[k] = fmin(b->lo[k], point[k]);
        b->hi[k] = fmax(b->hi[k], point[k]);
    }
}

static const bounds nowhere = { { INFINITY, INFINITY }, { -INFINITY, -INFINITY } };

static bool meets(const load_box *box, const bounds *b) {
    return b->lo[0] <= box->hi[0] && b->hi[0] >= box->lo[0] && b->lo[1] <= box->hi[1] && b->hi[1] >= box->lo[1];
}

noc_status box_line(reading *r, const double *xyz, size_t count, bool *inside) {
    bounds b = nowhere;
    *inside = true;
    if (!r->im->box.on)
        return NOC_OK;
    noc_status status = to_box(r, xyz, count);
    if (status)
        return status;
    for (size_t i = 0; i < count; i++)
        widen(&b, r->in_box.data + 3 * i);
    *inside = meets(&r->im->box, &b);
    return NOC_OK;
}

noc_status box_point(reading *r, const double *xyz, bool *inside) { return box_line(r, xyz, 1, inside); }

/* Drops triangles that lie outside. */
static noc_status clip(reading *r, geo_triangles *t) {
    noc_status status = to_box(r, t->xyz.data, t->xyz.len / 3);
    size_t kept = 0;
    for (size_t i = 0; i < t->indices.len && !status; i += 3) {
        bounds b = nowhere;
        for (size_t k = 0; k < 3; k++)
            widen(&b, r->in_box.data + 3 * (size_t)t->indices.data[i + k]);
        if (!meets(&r->im->box, &b))
            continue;
        memmove(t->indices.data + kept, t->indices.data + i, 3 * sizeof(*t->indices.data));
        kept += 3;
    }
    t->indices.len = kept;
    if (!kept)
        triangles_clear(t);
    return status;
}

noc_status box_object(reading *r, bool *inside) {
    noc_status status = NOC_OK;
    bounds b = nowhere;
    bool terrain = r->now.kind == GEO_TERRAIN && r->object_id, any = false;
    *inside = true;
    size_t count = NOC_CLASS_COUNT + r->group_count;
    for (size_t c = 0; c < count && r->im->box.on && !status; c++) {
        geo_triangles *t = triangles_of(r, c);
        any = any || t->indices.len;
        if (!t->indices.len)
            continue;
        status = terrain ? clip(r, t) : to_box(r, t->xyz.data, t->xyz.len / 3);
        for (size_t i = 0; i + 2 < r->in_box.len && !terrain && !status; i += 3)
            widen(&b, r->in_box.data + i);
    }
    if (status || !any)
        return status;
    if (terrain) {
        *inside = false;
        for (size_t c = 0; c < count; c++)
            *inside = *inside || triangles_of(r, c)->indices.len;
    } else {
        *inside = r->now.given || meets(&r->im->box, &b);
    }
    for (size_t c = 0; c < count && !*inside; c++)
        triangles_clear(triangles_of(r, c));
    return NOC_OK;
}
