/* What city readers emit becomes meshes: one an object and class, so that ids stay findable and a mesh has one
 * material. */
#include "import/load/load.h"

#include <math.h>

#define FLUSH_TRIANGLES 500000 /* of one object and class: terrain is not kept twice */

/* ---- materials ---- */

/* Façades and roofs differ from building to building. Diffuse reflectances, linear; their mean is near the class's own
 * material. */
static const float wall_albedo[PALETTE][3] = {
    { .58f, .54f, .47f }, /* light plaster */
    { .52f, .45f, .33f }, /* cream plaster */
    { .46f, .37f, .27f }, /* sandstone */
    { .40f, .40f, .39f }, /* concrete */
    { .33f, .20f, .15f }, /* brick */
    { .55f, .55f, .54f }, /* white paint, weathered */
    { .45f, .34f, .28f }, /* pink plaster */
    { .38f, .39f, .35f }, /* grey green plaster */
};
static const float roof_albedo[PALETTE][3] = {
    { .30f, .13f, .08f }, /* new clay tiles */
    { .23f, .11f, .08f }, /* clay tiles */
    { .18f, .10f, .08f }, /* old clay tiles */
    { .27f, .15f, .10f }, /* light clay tiles */
    { .13f, .13f, .14f }, /* slate */
    { .22f, .21f, .20f }, /* concrete tiles */
    { .17f, .12f, .10f }, /* brown tiles */
    { .30f, .29f, .27f }, /* gravel */
};

/* Neighbouring ids differ in a letter: all bits of the hash must depend on it. */
static uint32_t hash_id(const char *id) {
    uint32_t h = 2166136261u;
    for (; *id; id++)
        h = (h ^ (unsigned char)*id) * 16777619u;
    h = (h ^ h >> 16) * 0x85ebca6bu;
    h = (h ^ h >> 13) * 0xc2b2ae35u;
    return h ^ h >> 16;
}

int sink_material(importer *im, noc_class cls, const char *id) {
    const float(*albedo)[3] = cls == NOC_CLASS_WALL ? wall_albedo : cls == NOC_CLASS_ROOF ? roof_albedo : NULL;
    uint32_t h = hash_id(id);
    uint32_t k = !albedo ? 0 : (cls == NOC_CLASS_WALL ? h : h >> 8) % PALETTE;
    int *index = &im->material[cls][k];
    if (!*index) {
        noc_material m = noc_class_material(cls);
        if (albedo)
            memcpy(m.albedo, albedo[k], sizeof(m.albedo));
        *index = noc_scene_add_material(im->scene, &m) + 1;
    }
    return *index - 1;
}

/* ---- surfaces ---- */

static bool is_open_ground(noc_class cls) {
    return cls == NOC_CLASS_ROAD || cls == NOC_CLASS_SIDEWALK || cls == NOC_CLASS_GREEN || cls == NOC_CLASS_TERRAIN ||
           cls == NOC_CLASS_WATER;
}

static double area_from_above(const geo_triangles *t) {
    double sum = 0;
    for (size_t i = 0; i < t->indices.len; i += 3) {
        const double *a = t->xyz.data + 3 * (size_t)t->indices.data[i],
                     *b = t->xyz.data + 3 * (size_t)t->indices.data[i + 1],
                     *c = t->xyz.data + 3 * (size_t)t->indices.data[i + 2];
        sum += fabs((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2;
    }
    return sum;
}

noc_status sink_affords(importer *im, size_t more) {
    const input *in = &im->inputs[im->current];
    size_t scene = noc_scene_bytes(im->scene) + more, made = scene - NOC_MIN(scene, im->scene_before);
    size_t waiting = im->lamps.cap * sizeof(*im->lamps.data) + im->lost.cap * sizeof(*im->lost.data) + im->names.bytes +
                     im->records.list.cap * sizeof(*im->records.list.data);
    import_budget memory = { .memory = im->memory }, growth = { INFINITY, 0, (double)in->bytes };
    if (in->reader && in->reader->reads == NOC_READS_CITY) /* other readers see themselves to what files grow to */
        growth.expansion = im->params->max_expansion;
    noc_status status = import_affords(&memory, (double)(scene + waiting), in->path, "the scene with it", im->log);
    return status ? status : import_affords(&growth, (double)made, in->path, "its part of the scene", im->log);
}

static noc_status flush_class(importer *im, noc_class cls) {
    geo_triangles *t = &im->surfaces[cls];
    if (!t->indices.len)
        return NOC_OK;
    const char *id = im->object_id ? im->object_id : "";
    bool repeated = false;
    noc_status status = im->object_id ? repeat_object(im, id, &repeated) : NOC_OK;
    if (status || repeated) {
        t->xyz.len = t->indices.len = 0;
        return status;
    }
    noc_mesh mesh = { .vertex_count = t->xyz.len / 3,
                      .positions = t->xyz.data,
                      .triangle_count = t->indices.len / 3,
                      .indices = t->indices.data,
                      .material = sink_material(im, cls, id),
                      .name = *id ? id : NULL };
    if (mesh.material < 0 || noc_scene_add_mesh(im->scene, &mesh) < 0)
        return NOC_ERR_UNSUPPORTED; /* said by the scene */
    im->inputs[im->current].file.triangles += mesh.triangle_count;
    status = sink_affords(im, 0);
    if (status)
        return status;
    if (is_open_ground(cls))
        im->open_area += area_from_above(t);
    im->has_roads = im->has_roads || cls == NOC_CLASS_ROAD || cls == NOC_CLASS_SIDEWALK;
    t->xyz.len = t->indices.len = 0;
    return NOC_OK;
}

noc_status sink_flush(importer *im) {
    for (int c = 0; c < NOC_CLASS_COUNT; c++) {
        noc_status status = flush_class(im, (noc_class)c);
        if (status)
            return status;
    }
    noc_report_file *file = &im->inputs[im->current].file;
    for (int c = 0; c < NOC_CLASS_COUNT && !im->now.repeated; c++)
        file->polygons_by_class[c] += im->now.by_class[c];
    file->polygons += im->now.repeated ? 0 : im->now.polygons;
    im->now = (object_now){ 0 };
    return NOC_OK;
}

static noc_status on_crs(void *ctx, const char *srs_name, const char *place, bool *lat_first) {
    return place_crs(ctx, srs_name, place, lat_first);
}

static noc_status on_begin_object(void *ctx, const geo_object *object) {
    importer *im = ctx;
    noc_report_file *file = &im->inputs[im->current].file;
    noc_status status = sink_flush(im);
    free(im->object_id);
    im->object_id = noc_strdup(object->id ? object->id : "");
    if (!status && !im->object_id)
        status = noc_no_memory(im->log, im->inputs[im->current].path);
    im->now.kind = object->kind;
    file->objects++;
    if (object->kind == GEO_BUILDING) {
        im->buildings++;
        file->buildings++;
        if (object->lod >= 0 && object->lod < (int)NOC_COUNT(file->lod_used))
            file->lod_used[object->lod]++;
    }
    return status;
}

static noc_status on_end_object(void *ctx) {
    importer *im = ctx;
    noc_status status = sink_flush(im);
    free(im->object_id);
    im->object_id = NULL;
    return status;
}

static noc_status on_polygon(void *ctx, const geo_polygon *polygon) {
    importer *im = ctx;
    input *in = &im->inputs[im->current];
    noc_class cls = (unsigned)polygon->cls < NOC_CLASS_COUNT ? polygon->cls : NOC_CLASS_OTHER;
    size_t count = 0;
    for (size_t r = 0; r < polygon->ring_count; r++)
        count += polygon->ring_size[r];
    size_t numbers = 3 * count;
    im->scratch.len = 0;
    if (!array_append(&im->scratch, polygon->xyz, numbers))
        return noc_no_memory(im->log, in->path);
    bool usable;
    noc_status status = place_points(im, im->scratch.data, count, polygon->id, &usable);
    if (status || !usable)
        return status;
    if (im->now.repeated)
        return NOC_OK;
    if (im->object_id && !im->now.decided)
        repeat_polygon(&im->now, cls, im->scratch.data, count);
    if (cls != NOC_CLASS_CLOSURE) {
        geo_polygon local = *polygon;
        local.xyz = im->scratch.data;
        if (!geo_triangulate(&local, &im->surfaces[cls], in->issues))
            return im->surfaces[cls].no_memory ? noc_no_memory(im->log, in->path) : NOC_OK;
    }
    im->now.polygons++;
    im->now.by_class[cls]++;
    return im->surfaces[cls].indices.len >= 3 * FLUSH_TRIANGLES ? flush_class(im, cls) : NOC_OK;
}

_Static_assert((int)GEO_SOURCE_LED == NOC_SOURCE_LED && (int)GEO_SOURCE_LOW_SODIUM == NOC_SOURCE_LOW_SODIUM,
               "sources are those of the report");

/* Counts a value that is known, and widens the range of those. */
static void count_value(double value, size_t *count, double *min, double *max) {
    if (!isfinite(value) || value <= 0)
        return;
    *min = *count ? NOC_MIN(*min, value) : value;
    *max = *count ? NOC_MAX(*max, value) : value;
    ++*count;
}

/* What a lamp tells of itself, for the report. */
static void count_lamp(noc_report_file *file, const geo_lamp *lamp) {
    file->lamps++;
    file->lamp_heads += (size_t)NOC_CLAMP(lamp->count, 1, GEO_MAX_HEADS);
    size_t with_kelvin = file->lamps_with_kelvin;
    count_value(lamp->height, &file->lamps_with_height, &file->lamp_height_min, &file->lamp_height_max);
    count_value(lamp->lumens, &file->lamps_with_lumens, &file->lamp_lumens_min, &file->lamp_lumens_max);
    count_value(lamp->watts, &file->lamps_with_watts, &file->lamp_watts_min, &file->lamp_watts_max);
    count_value(lamp->kelvin, &file->lamps_with_kelvin, &file->lamp_kelvin_min, &file->lamp_kelvin_max);
    file->lamps_with_colour += file->lamps_with_kelvin > with_kelvin || lamp->rgb[0] >= 0;
    file->lamps_with_direction += isfinite(lamp->direction) != 0;
    file->lamps_by_source[(unsigned)lamp->source < NOC_SOURCE_COUNT ? lamp->source : GEO_SOURCE_UNKNOWN]++;
}

static noc_status on_lamp(void *ctx, const geo_lamp *lamp) {
    importer *im = ctx;
    pending_lamp p = { .lamp = *lamp, .input = im->current };
    bool usable;
    double points[1 + GEO_BODY_HEADS][3]; /* with its heads, so that they stay where the body has them */
    size_t heads = (size_t)NOC_CLAMP(lamp->body_heads, 0, GEO_BODY_HEADS);
    memcpy(points[0], lamp->xyz, sizeof(points[0]));
    memcpy(points[1], lamp->head, heads * sizeof(points[0]));
    noc_status status = place_points(im, points[0], 1 + heads, lamp->id ? lamp->id : "", &usable);
    p.given = (given_place){ { NAN, NAN }, im->source };
    if (!status && im->given.len >= 2)
        memcpy(p.given.xy, im->given.data, sizeof(p.given.xy));
    if (!status && !usable) {
        im->inputs[im->current].lamps_lost++;
        if (!array_push(&im->lost, p.given))
            status = noc_no_memory(im->log, im->inputs[im->current].path);
    }
    if (status || !usable)
        return status;
    memcpy(p.lamp.xyz, points[0], sizeof(points[0]));
    memcpy(p.lamp.head, points[1], heads * sizeof(points[0]));
    count_lamp(&im->inputs[im->current].file, lamp);
    if (im->inspect) {
        report_assumed(&im->inputs[im->current].file, lamp);
        return NOC_OK;
    }
    if (im->lamps.len == im->lamps.cap && (status = sink_affords(im, im->lamps.cap * sizeof(p)))) /* it doubles */
        return status;
    p.lamp.id = arena_strdup(&im->names, lamp->id ? lamp->id : "");
    p.lamp.ref = lamp->ref && *lamp->ref ? arena_strdup(&im->names, lamp->ref) : "";
    return p.lamp.id && p.lamp.ref && array_push(&im->lamps, p) ? NOC_OK
                                                                : noc_no_memory(im->log, im->inputs[im->current].path);
}

/* Of a file that has been read. */
static noc_status on_columns(void *ctx, size_t points, const geo_column *columns, size_t count) {
    importer *im = ctx;
    noc_report_file *file = &im->inputs[im->current].file;
    noc_arena *arena = &im->report->arena;
    noc_report_column *kept = arena_alloc(arena, (count + 1) * sizeof(*kept));
    for (size_t i = 0; i < count && kept; i++)
        kept[i] = (noc_report_column){ .name = arena_strdup(arena, columns[i].name),
                                       .field = arena_strdup(arena, columns[i].field),
                                       .unit = arena_strdup(arena, columns[i].unit),
                                       .values = columns[i].values,
                                       .example = arena_strdup(arena, columns[i].example),
                                       .mapped = columns[i].mapped };
    if (arena->refused)
        return noc_no_memory(im->log, im->inputs[im->current].path);
    file->points = points;
    file->columns = kept;
    file->column_count = count;
    return NOC_OK;
}

/* A file of which nothing is read still says where it is, to those who ask what it holds. */
static noc_status on_features(void *ctx, const geo_features *features) {
    importer *im = ctx;
    noc_report_file *file = &im->inputs[im->current].file;
    file->map_points = (size_t)features->total[GEO_POINTS];
    file->map_lines = (size_t)features->total[GEO_LINES];
    file->map_areas = (size_t)features->total[GEO_AREAS];
    file->buildings_unread = (size_t)features->buildings;
    file->streets_unread = (size_t)features->streets;
    if (!im->inspect || !features->any)
        return NOC_OK;
    bool usable;
    double corners[2][3] = { { features->lo[0], features->lo[1], NAN }, { features->hi[0], features->hi[1], NAN } };
    return place_points(im, corners[0], 2, "", &usable);
}

static bool on_progress(void *ctx, double done) {
    importer *im = ctx;
    const noc_progress *progress = &im->params->progress;
    double bytes = im->bytes_before + NOC_CLAMP(done, 0, 1) * (double)im->inputs[im->current].bytes;
    if (progress->update && !progress->update(progress->user, im->inputs[im->current].path,
                                              0.9 * (im->bytes_total > 0 ? bytes / im->bytes_total : 1)))
        im->cancelled = true;
    return !im->cancelled;
}

geo_sink sink_create(importer *im) {
    return (geo_sink){ .ctx = im,
                       .log = im->log,
                       .issues = im->inputs[im->current].issues,
                       .lamps_lost = &im->inputs[im->current].lamps_lost,
                       .decimal_sign = &im->inputs[im->current].file.decimal_sign,
                       .crs = on_crs,
                       .begin_object = on_begin_object,
                       .polygon = on_polygon,
                       .end_object = on_end_object,
                       .lamp = on_lamp,
                       .columns = on_columns,
                       .features = on_features,
                       .progress = on_progress,
                       .named_lamps = im->inputs[im->current].named_lamps,
                       .inspect = im->inspect };
}

void sink_destroy(importer *im) {
    for (int c = 0; c < NOC_CLASS_COUNT; c++)
        geo_triangles_free(&im->surfaces[c]);
    array_free(&im->scratch);
    repeat_free(&im->records);
    free(im->object_id);
    array_free(&im->lamps);
    array_free(&im->lost);
    arena_free(&im->names);
}
