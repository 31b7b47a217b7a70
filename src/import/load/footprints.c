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

noc_status footprint_keep(importer *im, input *in, size_t index, const geo_footprint *f) {
    pending_footprint p = { .footprint = *f, .input = index };
    if (!isfinite(f->height) && !isfinite(f->levels))
        geo_issue(in->issues, GEO_GUESSED, "height of a building, by --building-height", f->id);
    if (isfinite(f->height) && f->levels >= 2 && !array_push(&im->storeys, (float)(f->height / f->levels)))
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

static double area_of(const double *xyz, size_t points) {
    double twice = 0;
    for (size_t i = 0; i < points; i++) {
        const double *a = xyz + 3 * i, *b = xyz + 3 * ((i + 1) % points);
        twice += (a[0] - xyz[0]) * (b[1] - xyz[1]) - (a[1] - xyz[1]) * (b[0] - xyz[0]);
    }
    return twice / 2;
}

typedef struct block {
    importer *im;
    input *in;
    const geo_footprint *f;
    geo_triangles surfaces[NOC_CLASS_COUNT];
    NOC_ARRAY(double) xyz;
    object_now now;
} block;

static bool add(block *b, noc_class cls, size_t rings, const size_t *sizes, const double *xyz, size_t points) {
    const geo_polygon polygon = { cls, b->f->id, rings, sizes, xyz };
    repeat_polygon(&b->now, cls, xyz, points);
    if (geo_triangulate(&polygon, &b->surfaces[cls], b->in->issues)) {
        b->now.polygons++;
        b->now.by_class[cls]++;
    }
    return !b->surfaces[cls].no_memory;
}

/* At a height; turned over where it is seen from below. */
static bool add_lid(block *b, noc_class cls, double z, bool below) {
    const geo_footprint *f = b->f;
    size_t at = 0;
    b->xyz.len = 0;
    for (size_t r = 0; r < f->ring_count; at += f->ring_size[r++]) {
        bool turn = (area_of(f->xyz + 3 * at, f->ring_size[r]) > 0) == (below == (r == 0));
        for (size_t i = 0; i < f->ring_size[r]; i++) {
            const double *p = f->xyz + 3 * (at + (turn ? f->ring_size[r] - 1 - i : i));
            const double point[3] = { p[0], p[1], z };
            if (!array_append(&b->xyz, point, (size_t)3))
                return false;
        }
    }
    return add(b, cls, f->ring_count, f->ring_size, b->xyz.data, at);
}

static bool add_walls(block *b, double low, double high) {
    const geo_footprint *f = b->f;
    static const size_t four = 4;
    size_t at = 0;
    for (size_t r = 0; r < f->ring_count; at += f->ring_size[r++]) {
        size_t n = f->ring_size[r];
        bool turn =
            (area_of(f->xyz + 3 * at, n) > 0) != (r == 0); /* outlines run counter-clockwise, yards the other way */
        for (size_t i = 0; i < n; i++) {
            const double *p = f->xyz + 3 * (at + i), *q = f->xyz + 3 * (at + (i + 1) % n);
            const double *a = turn ? q : p, *c = turn ? p : q;
            const double wall[12] = { a[0], a[1], low, c[0], c[1], low, c[0], c[1], high, a[0], a[1], high };
            if (hypot(p[0] - q[0], p[1] - q[1]) > 1e-3 && !add(b, NOC_CLASS_WALL, 1, &four, wall, 4))
                return false;
        }
    }
    return true;
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
    bool ok = add_walls(&b, ground + from, ground + to) && add_lid(&b, NOC_CLASS_ROOF, ground + to, false) &&
              (from <= 0 || add_lid(&b, NOC_CLASS_OTHER, ground + from, true));
    size_t first = im->scene->meshes.len;
    noc_status status = ok ? hand_over(&b) : noc_no_memory(im->log, b.in->path);
    for (size_t i = first; i < im->scene->meshes.len; i++)
        im->scene->meshes.data[i].aloft = from > 0;
    count_one(b.in);
    for (int c = 0; c < NOC_CLASS_COUNT; c++)
        geo_triangles_free(&b.surfaces[c]);
    array_free(&b.xyz);
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
