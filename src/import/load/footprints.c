/* Buildings of maps: outlines are kept until all surfaces are in, and then stand on the ground as blocks with flat
 * roofs, where no city model has a building. */
#include "import/load/load.h"
#include "city/city.h"

#include <math.h>

#define STOREY 3.0 /* m, of building:levels */

static const uint32_t built = 1u << NOC_CLASS_WALL | 1u << NOC_CLASS_ROOF | 1u << NOC_CLASS_WINDOW |
                              1u << NOC_CLASS_DOOR | 1u << NOC_CLASS_INSTALLATION;

static void count_one(input *in) {
    in->file.objects++;
    in->file.buildings++;
    in->file.lod_used[1]++;
}

/* Side of a square as large as the outline's box [m]. */
static double width_of(const geo_footprint *f) {
    double lo[2] = { INFINITY, INFINITY }, hi[2] = { -INFINITY, -INFINITY };
    for (size_t i = 0; i < f->ring_size[0]; i++)
        for (int k = 0; k < 2; k++) {
            lo[k] = NOC_MIN(lo[k], f->xyz[3 * i + k]);
            hi[k] = NOC_MAX(hi[k], f->xyz[3 * i + k]);
        }
    return hi[0] > lo[0] ? sqrt((hi[0] - lo[0]) * (hi[1] - lo[1])) : 0;
}

noc_status footprint_keep(importer *im, input *in, size_t index, const geo_footprint *f) {
    pending_footprint p = { .footprint = *f, .input = index };
    if (!isfinite(f->height) && !isfinite(f->levels))
        geo_issue(in->issues, GEO_GUESSED, "height of a building, by --building-height", f->id);
    const building_size size = { .height = (float)f->height,
                                 .width = (float)width_of(f),
                                 .storey = f->levels >= 2 ? (float)(f->height / f->levels) : 0 };
    if (isfinite(f->height) && !array_push(&in->sizes, size))
        return noc_no_memory(im->log, in->path);
    if (im->inspect) {
        count_one(in);
        return NOC_OK;
    }
    size_t points = 0;
    for (size_t i = 0; i < f->ring_count; i++)
        points += f->ring_size[i];
    size_t *sizes = arena_alloc(&im->names, f->ring_count * sizeof(*sizes));
    double *xyz = arena_alloc(&im->names, 3 * points * sizeof(*xyz));
    p.footprint.id = arena_strdup(&im->names, f->id);
    if (!sizes || !xyz || !p.footprint.id || !array_push(&im->footprints, p))
        return noc_no_memory(im->log, in->path);
    memcpy(sizes, f->ring_size, f->ring_count * sizeof(*sizes));
    memcpy(xyz, f->xyz, 3 * points * sizeof(*xyz));
    geo_footprint *kept = &im->footprints.data[im->footprints.len - 1].footprint;
    kept->ring_size = sizes;
    kept->xyz = xyz;
    return take_kept(im, in);
}

/* ---- heights ---- */

/* From what it tells: its height with the roof, or its storeys, or the default. */
static void heights_of(const importer *im, const geo_footprint *f, double *from, double *to) {
    double roof = isfinite(f->roof_height) ? f->roof_height : 0;
    *to = isfinite(f->height)   ? f->height
          : isfinite(f->levels) ? NOC_MAX(f->levels, 1) * STOREY + roof
                                : im->params->building_height;
    *from = isfinite(f->min_height) ? f->min_height : isfinite(f->min_level) ? f->min_level * STOREY : 0;
}

/* The lowest ground under it: terrain, else what the city tells, else 0. */
static double ground_under(const importer *im, const city_ground *city, const geo_footprint *f) {
    double lowest = INFINITY, z, distance;
    for (size_t i = 0; i < f->ring_size[0]; i++) {
        const double *p = f->xyz + 3 * i;
        if (noc_scene_ground(im->scene, p[0], p[1], &z))
            lowest = NOC_MIN(lowest, z);
    }
    if (isfinite(lowest))
        return lowest;
    z = city ? city_ground_height(city, f->xyz[0], f->xyz[1], &distance) : NAN;
    return isfinite(z) ? z : 0;
}

/* ---- surfaces ---- */

typedef struct block {
    importer *im;
    input *in;
    const geo_footprint *f;
    geo_triangles surfaces[NOC_CLASS_COUNT];
    object_now now;
} block;

static bool add(void *ctx, noc_class cls, size_t rings, const size_t *sizes, const double *xyz) {
    block *b = ctx;
    const geo_polygon polygon = { cls, b->f->id, rings, sizes, xyz };
    size_t points = 0;
    for (size_t r = 0; r < rings; r++)
        points += sizes[r];
    repeat_polygon(&b->now, cls, xyz, points);
    if (geo_triangulate(&polygon, &b->surfaces[cls], b->in->issues)) {
        b->now.polygons++;
        b->now.by_class[cls]++;
    }
    return !b->surfaces[cls].no_memory;
}

static noc_status hand_over(block *b) {
    part_surface surfaces[NOC_CLASS_COUNT];
    load_part part = { .kind = PART_OBJECT };
    part.u.object.id = b->f->id;
    part.u.object.now = b->now;
    part.u.object.last = true;
    part.u.object.surfaces = surfaces;
    for (int c = 0; c < NOC_CLASS_COUNT; c++) {
        const geo_triangles *t = &b->surfaces[c];
        if (t->indices.len)
            surfaces[part.u.object.surface_count++] =
                (part_surface){ (noc_class)c, t->xyz.len / 3, t->indices.len / 3, t->xyz.data, t->indices.data };
    }
    return part.u.object.surface_count ? take_part(b->im, b->in, &part) : NOC_OK;
}

static noc_status stand(importer *im, const pending_footprint *p, double ground) {
    block b = { .im = im,
                .in = &im->inputs[p->input],
                .f = &p->footprint,
                .now = { .kind = GEO_BUILDING, .use = p->footprint.use } };
    double from, to;
    heights_of(im, b.f, &from, &to);
    if (to - from < 0.5) {
        geo_issue(b.in->issues, GEO_SKIPPED, "building whose height is none", b.f->id);
        return NOC_OK;
    }
    const geo_block shape = { b.f->ring_count,
                              b.f->ring_size,
                              b.f->xyz,
                              ground + from,
                              ground + to,
                              1e-3,
                              from > 0 ? (int)NOC_CLASS_OTHER : -1 };
    bool ok = geo_block_make(&shape, add, &b);
    size_t first = im->scene->meshes.len;
    noc_status status = ok ? hand_over(&b) : noc_no_memory(im->log, b.in->path);
    for (size_t i = first; i < im->scene->meshes.len; i++)
        im->scene->meshes.data[i].aloft = (float)NOC_MAX(from, 0);
    count_one(b.in);
    for (int c = 0; c < NOC_CLASS_COUNT; c++)
        geo_triangles_free(&b.surfaces[c]);
    return status;
}

/* ---- all of them ---- */

/* Does a model's building stand there? Asked in the middle of each triangle of the outline. */
static bool is_taken(const importer *im, const geo_footprint *f, bool *no_memory) {
    const geo_polygon polygon = { NOC_CLASS_OTHER, f->id, f->ring_count, f->ring_size, f->xyz };
    geo_triangles t = { 0 };
    bool taken = false;
    double z;
    geo_triangulate(&polygon, &t, NULL);
    *no_memory = t.no_memory;
    for (size_t i = 0; i + 2 < t.indices.len && !taken; i += 3) {
        const double *a = t.xyz.data + 3 * (size_t)t.indices.data[i],
                     *b = t.xyz.data + 3 * (size_t)t.indices.data[i + 1],
                     *c = t.xyz.data + 3 * (size_t)t.indices.data[i + 2];
        taken = noc_scene_highest(im->scene, built, (a[0] + b[0] + c[0]) / 3, (a[1] + b[1] + c[1]) / 3, &z);
    }
    geo_triangles_free(&t);
    return taken;
}

noc_status footprints_stand(importer *im) {
    size_t count = im->footprints.len, kept = 0, plain = 0;
    if (!count)
        return NOC_OK;
    double *ground = noc_alloc(count * sizeof(*ground));
    if (!ground)
        return noc_no_memory(im->log, "import");
    city_ground *city = im->scene->indices.len ? city_ground_start(im->scene, NULL, 0) : NULL;
    noc_status status = NOC_OK;
    for (size_t i = 0; i < count && !status; i++) { /* all are asked before any stands */
        pending_footprint p = im->footprints.data[i];
        bool no_memory;
        if (is_taken(im, &p.footprint, &no_memory)) {
            geo_issue(im->inputs[p.input].issues, GEO_SPARED, "outline of a building that a city model has",
                      p.footprint.id);
            continue;
        }
        status = no_memory ? noc_no_memory(im->log, "import") : NOC_OK;
        ground[kept] = ground_under(im, city, &p.footprint);
        plain += !isfinite(p.footprint.height) && !isfinite(p.footprint.levels);
        im->footprints.data[kept++] = p;
    }
    if (city)
        city_ground_free(city);
    for (size_t i = 0; i < kept && !status; i++) {
        status = stand(im, &im->footprints.data[i], ground[i]);
        if (i % 1024 == 0 && !import_progress(im, &im->inputs[im->footprints.data[i].input], im->bytes_before))
            status = NOC_ERR_CANCELLED;
    }
    free(ground);
    if (!status && kept)
        noc_info(im->log,
                 "%zu buildings of maps stand as blocks, %zu of them %g m high for want of a height "
                 "(--building-height)",
                 kept, plain, im->params->building_height);
    return status;
}
