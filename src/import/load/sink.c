/* What city readers emit, placed and triangulated, is handed over object by object. */
#include "import/load/load.h"

#include <math.h>

#define FLUSH_TRIANGLES 500000 /* of one object and class: terrain is not kept twice */

noc_status sink_hand_over(reading *r, const load_part *part) {
    if (r->side)
        return side_put(r->side, part);
    return r->queue ? queue_put(r->queue, r->im, part) : take_part(r->im, r->in, part);
}

/* ---- surfaces ---- */

/* Of the object that is being read nothing lies in the box. */
static void leave_out_object(reading *r) {
    noc_report_file *file = &r->in->file;
    r->now.polygons = 0;
    memset(r->now.by_class, 0, sizeof(r->now.by_class));
    if (!r->object_id)
        return;
    geo_issue(r->in->issues, GEO_SPARED, "object outside of --bbox", r->object_id);
    file->objects--;
    if (r->now.kind != GEO_BUILDING)
        return;
    file->buildings--;
    if (r->object_lod >= 0 && r->object_lod < (int)NOC_COUNT(file->lod_used))
        file->lod_used[r->object_lod]--;
}

/* Hands over the surfaces of a class, or with NOC_CLASS_COUNT all of them, as the object ends. */
static noc_status hand_over_object(reading *r, noc_class only) {
    bool inside;
    noc_status boxed = box_object(r, &inside);
    if (boxed)
        return boxed;
    if (!inside && only == NOC_CLASS_COUNT && !r->now.given)
        leave_out_object(r);
    r->parts.len = 0;
    if (!array_reserve(&r->parts, NOC_CLASS_COUNT + r->group_count))
        return noc_no_memory(r->log, r->in->path);
    part_surface *surfaces = r->parts.data;
    load_part part = { .kind = PART_OBJECT };
    part.u.object.id = r->object_id;
    part.u.object.now = r->now;
    part.u.object.last = only == NOC_CLASS_COUNT;
    part.u.object.surfaces = surfaces;
    for (size_t i = 0; i < NOC_CLASS_COUNT + r->group_count; i++) {
        const geo_triangles *t = triangles_of(r, i);
        const look_group *group = i < NOC_CLASS_COUNT ? NULL : &r->groups.data[i - NOC_CLASS_COUNT];
        noc_class cls = group ? group->cls : (noc_class)i;
        if (t->indices.len && (part.u.object.last || cls == only))
            surfaces[part.u.object.surface_count++] =
                (part_surface){ .cls = cls,
                                .vertex_count = t->xyz.len / 3,
                                .triangle_count = t->indices.len / 3,
                                .xyz = t->xyz.data,
                                .indices = t->indices.data,
                                .uv = t->uv.len ? t->uv.data : NULL,
                                .look = group ? &r->looks.data[group->look - 1] : NULL };
    }
    if (!part.u.object.surface_count && !r->now.polygons && !r->now.given) {
        look_end_object(r);
        return NOC_OK;
    }
    noc_status status = sink_hand_over(r, &part);
    for (size_t i = 0; i < NOC_CLASS_COUNT + r->group_count; i++)
        if (part.u.object.last || i == (size_t)only ||
            (i >= NOC_CLASS_COUNT && r->groups.data[i - NOC_CLASS_COUNT].cls == only))
            triangles_clear(triangles_of(r, i));
    if (part.u.object.last)
        look_end_object(r);
    r->now.given = true;
    return status;
}

noc_status sink_flush(reading *r) {
    noc_status status = hand_over_object(r, NOC_CLASS_COUNT);
    r->now = (object_now){ 0 };
    return status;
}

static noc_status on_crs(void *ctx, const char *srs_name, const char *place, bool *lat_first) {
    return place_crs(ctx, srs_name, place, lat_first);
}

static noc_status on_appearance(void *ctx, const geo_appearance *appearance, uint32_t *number) {
    return look_number(ctx, appearance, number);
}

static noc_status on_begin_object(void *ctx, const geo_object *object) {
    reading *r = ctx;
    noc_report_file *file = &r->in->file;
    noc_status status = sink_flush(r);
    free(r->object_id);
    r->object_id = noc_strdup(object->id ? object->id : "");
    if (!status && !r->object_id)
        status = noc_no_memory(r->log, r->in->path);
    r->now.kind = object->kind;
    r->now.use = object->use;
    r->now.storeys = object->storeys;
    r->now.outline = object->outline;
    r->object_lod = object->lod;
    file->objects++;
    if (object->kind == GEO_BUILDING) {
        file->buildings++;
        if (object->lod >= 0 && object->lod < (int)NOC_COUNT(file->lod_used))
            file->lod_used[object->lod]++;
    }
    return status;
}

static noc_status on_end_object(void *ctx) {
    reading *r = ctx;
    noc_status status = sink_flush(r);
    free(r->object_id);
    r->object_id = NULL;
    return status;
}

/* Corners of all rings to r->scratch, as the file has them. */
static noc_status copy_rings(reading *r, const double *xyz, const size_t *ring_size, size_t ring_count, size_t *count) {
    *count = 0;
    for (size_t i = 0; i < ring_count; i++)
        *count += ring_size[i];
    size_t numbers = 3 * *count;
    r->scratch.len = 0;
    return array_append(&r->scratch, xyz, numbers) ? NOC_OK : noc_no_memory(r->log, r->in->path);
}

/* Counts a height that is none, with its value. */
static noc_status tell_height(reading *r, geo_issue_kind kind, const char *reason, const char *id, double z) {
    char *told = noc_format("%s at %.6g", id ? id : "", z);
    if (!told)
        return noc_no_memory(r->log, r->in->path);
    geo_issue(r->in->issues, kind, reason, told);
    free(told);
    return NOC_OK;
}

/* Corners at -9999 and the like. All of a flat surface lie at 0 then, and are laid on the ground once it is known
 * (heights_of_surfaces); of anything else nothing is known. *usable: it is not left out. */
static noc_status check_heights(reading *r, const geo_polygon *polygon, size_t count, bool *usable) {
    noc_class cls = polygon->cls;
    bool flat = cls == NOC_CLASS_ROAD || cls == NOC_CLASS_SIDEWALK || cls == NOC_CLASS_GREEN ||
                cls == NOC_CLASS_WATER || (cls == NOC_CLASS_GROUND && r->now.kind != GEO_BUILDING) || r->now.outline;
    double *xyz = r->scratch.data, z = 0;
    size_t none = 0;
    for (size_t i = 0; i < count; i++)
        if (isfinite(xyz[3 * i + 2]) && geo_height_is_none(xyz[3 * i + 2])) {
            z = xyz[3 * i + 2];
            xyz[3 * i + 2] = 0;
            none++;
        }
    *usable = !none || (none == count && flat);
    if (!none)
        return NOC_OK;
    return *usable ? tell_height(r, GEO_GUESSED, "surface at a height such as -9999, taken as missing", polygon->id, z)
                   : tell_height(r, GEO_SKIPPED, "surface with corners at heights such as -9999", polygon->id, z);
}

static noc_status on_polygon(void *ctx, const geo_polygon *polygon) {
    reading *r = ctx;
    input *in = r->in;
    noc_class cls = (unsigned)polygon->cls < NOC_CLASS_COUNT ? polygon->cls : NOC_CLASS_OTHER;
    size_t count;
    bool usable;
    noc_status status = copy_rings(r, polygon->xyz, polygon->ring_size, polygon->ring_count, &count);
    if (!status)
        status = check_heights(r, polygon, count, &usable);
    if (!status && usable)
        status = place_points(r, r->scratch.data, count, polygon->id, &usable);
    if (status || !usable)
        return status;
    if (r->object_id && !r->now.given)
        repeat_polygon(&r->now, cls, r->scratch.data, count);
    geo_triangles *to = &r->surfaces[cls];
    if (cls != NOC_CLASS_CLOSURE) {
        geo_polygon local = *polygon;
        local.xyz = r->scratch.data;
        bool image = polygon->appearance && r->looks.data[polygon->appearance - 1].image;
        local.uv = image ? polygon->uv : NULL;
        if (polygon->appearance && (!image || polygon->uv) && !(to = look_triangles(r, polygon->appearance, cls)))
            return noc_no_memory(r->log, in->path);
        if (!geo_triangulate(&local, to, in->issues))
            return to->no_memory ? noc_no_memory(r->log, in->path) : NOC_OK;
    }
    r->now.polygons++;
    r->now.by_class[cls]++;
    return to->indices.len >= 3 * FLUSH_TRIANGLES ? hand_over_object(r, cls) : NOC_OK;
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
    reading *r = ctx;
    pending_lamp p = { .lamp = *lamp, .input = r->index };
    bool usable;
    double points[1 + GEO_BODY_HEADS][3]; /* with its heads, so that they stay where the body has them */
    size_t heads = (size_t)NOC_CLAMP(lamp->body_heads, 0, GEO_BODY_HEADS);
    memcpy(points[0], lamp->xyz, sizeof(points[0]));
    memcpy(points[1], lamp->head, heads * sizeof(points[0]));
    noc_status status = NOC_OK;
    if (isfinite(lamp->xyz[2]) && geo_height_is_none(lamp->xyz[2])) {
        points[0][2] = NAN;
        status =
            tell_height(r, GEO_GUESSED, "elevation of a lamp such as -9999, taken as missing", lamp->id, lamp->xyz[2]);
    }
    if (lamp->metres)
        points[0][2] /= height_unit_now(r);
    status = status ? status : place_points(r, points[0], 1 + heads, lamp->id ? lamp->id : "", &usable);
    p.given = (given_place){ { NAN, NAN }, r->source };
    if (!status && r->given.len >= 2)
        memcpy(p.given.xy, r->given.data, sizeof(p.given.xy));
    if (!status && !usable) {
        r->in->lamps_lost++;
        status = sink_hand_over(r, &(load_part){ .kind = PART_LOST, .u.lost = p.given });
    }
    if (status || !usable)
        return status;
    bool inside;
    status = box_point(r, points[0], &inside);
    if (!status && !inside)
        geo_issue(r->in->issues, GEO_SPARED, "lamp outside of --bbox", lamp->id ? lamp->id : "");
    if (status || !inside)
        return status;
    memcpy(p.lamp.xyz, points[0], sizeof(points[0]));
    memcpy(p.lamp.head, points[1], heads * sizeof(points[0]));
    count_lamp(&r->in->file, lamp);
    if (!units_see_lamp(r->in, &p))
        return noc_no_memory(r->log, r->in->path);
    if (r->im->inspect) {
        pthread_mutex_lock(&r->im->lock);
        luminaires_see(r->im, r->in, &p.lamp);
        pthread_mutex_unlock(&r->im->lock);
        seen_lamp seen = { { p.lamp.xyz[0], p.lamp.xyz[1] }, p.given };
        return array_push(&r->in->lamps_seen, seen) ? NOC_OK : noc_no_memory(r->log, r->in->path);
    }
    p.lamp.id = lamp->id ? lamp->id : "";
    p.lamp.ref = lamp->ref ? lamp->ref : "";
    return sink_hand_over(r, &(load_part){ .kind = PART_LAMP, .u.lamp = p });
}

static noc_status on_footprint(void *ctx, const geo_footprint *footprint) {
    reading *r = ctx;
    size_t count;
    bool usable, inside = true;
    noc_status status = copy_rings(r, footprint->xyz, footprint->ring_size, footprint->ring_count, &count);
    if (!status)
        status = place_points(r, r->scratch.data, count, footprint->id, &usable);
    if (!status && usable)
        status = box_point(r, r->scratch.data, &inside);
    if (!status && !inside)
        geo_issue(r->in->issues, GEO_SPARED, "object outside of --bbox", footprint->id);
    if (status || !usable || !inside)
        return status;
    geo_footprint local = *footprint;
    local.xyz = r->scratch.data;
    if (footprint->bare && r->in->unit > 0)
        local.height *= r->in->unit;
    return footprint_keep(r->im, r->in, r->index, &local);
}

/* Of a map whose lines are tracks. */
static noc_status road_to_track(reading *r, const geo_road *road) {
    const geo_track track = { road->id, 1, &road->point_count, road->xyz, NULL };
    if (road->cls != GEO_ROAD_RAIL && road->motor)
        return track_keep(r->im, r->in, r->index, &track);
    geo_issue(r->in->issues, GEO_SPARED, "line that cars do not drive on", road->id);
    return NOC_OK;
}

static noc_status on_road(void *ctx, const geo_road *road) {
    reading *r = ctx;
    size_t numbers = 3 * road->point_count;
    r->scratch.len = 0;
    if (!array_append(&r->scratch, road->xyz, numbers))
        return noc_no_memory(r->log, r->in->path);
    bool usable, inside = true;
    noc_status status = place_points(r, r->scratch.data, road->point_count, road->id, &usable);
    if (!status && usable)
        status = box_line(r, r->scratch.data, road->point_count, &inside);
    if (!status && !inside)
        geo_issue(r->in->issues, GEO_SPARED, "road outside of --bbox", road->id);
    if (status || !usable || !inside)
        return status;
    geo_road local = *road;
    local.xyz = r->scratch.data;
    if (r->in->named_tracks)
        return road_to_track(r, &local);
    return road_keep(r->im, r->in, &local);
}

static noc_status on_track(void *ctx, const geo_track *track) {
    reading *r = ctx;
    size_t count = 0;
    for (size_t i = 0; i < track->part_count; i++)
        count += track->part_size[i];
    size_t numbers = 3 * count;
    r->scratch.len = 0;
    if (!array_append(&r->scratch, track->xyz, numbers))
        return noc_no_memory(r->log, r->in->path);
    bool usable, inside = false;
    noc_status status = place_points(r, r->scratch.data, count, track->id, &usable);
    if (!status && !usable)
        geo_issue(r->in->issues, GEO_SKIPPED, "track without a place", track->id);
    for (size_t i = 0; i < count && !status && usable && !inside; i++)
        status = box_point(r, r->scratch.data + 3 * i, &inside);
    if (!status && usable && !inside)
        geo_issue(r->in->issues, GEO_SPARED, "track outside of --bbox", track->id);
    if (status || !usable || !inside)
        return status;
    geo_track local = *track;
    local.xyz = r->scratch.data;
    return track_keep(r->im, r->in, r->index, &local);
}

static noc_status on_area(void *ctx, const geo_polygon *area) {
    reading *r = ctx;
    size_t count = 0;
    for (size_t i = 0; i < area->ring_count; i++)
        count += area->ring_size[i];
    size_t numbers = 3 * count;
    r->scratch.len = 0;
    if (!array_append(&r->scratch, area->xyz, numbers))
        return noc_no_memory(r->log, r->in->path);
    bool usable, inside = true;
    noc_status status = place_points(r, r->scratch.data, count, area->id, &usable);
    if (!status && usable)
        status = box_line(r, r->scratch.data, count, &inside);
    if (status || !usable || !inside || r->im->inspect)
        return status;
    geo_polygon local = *area;
    local.xyz = r->scratch.data;
    geo_triangles *to = area_kept(r->im, area->cls);
    if (!to)
        return NOC_OK;
    geo_triangulate(&local, to, NULL); /* what is wrong with it is little of a city: nothing of it is told */
    return to->no_memory ? noc_no_memory(r->log, r->in->path) : take_affords(r->im, r->in, 0);
}

/* Of a file that has been read. */
static noc_status on_columns(void *ctx, size_t points, const geo_column *columns, size_t count) {
    reading *r = ctx;
    noc_report_file *file = &r->in->file;
    noc_arena *arena = &r->im->report->arena;
    noc_report_column *kept = arena_alloc(arena, (count + 1) * sizeof(*kept));
    for (size_t i = 0; i < count && kept; i++)
        kept[i] = (noc_report_column){ .name = arena_strdup(arena, columns[i].name),
                                       .field = arena_strdup(arena, columns[i].field),
                                       .unit = arena_strdup(arena, columns[i].unit),
                                       .values = columns[i].values,
                                       .example = arena_strdup(arena, columns[i].example),
                                       .mapped = columns[i].mapped };
    if (arena->refused)
        return noc_no_memory(r->log, r->in->path);
    file->points = points;
    file->columns = kept;
    file->column_count = count;
    return NOC_OK;
}

/* A file of which nothing is read still says where it is, to those who ask what it holds. */
static noc_status on_features(void *ctx, const geo_features *features) {
    reading *r = ctx;
    noc_report_file *file = &r->in->file;
    file->map_points = (size_t)features->total[GEO_POINTS];
    file->map_lines = (size_t)features->total[GEO_LINES];
    file->map_areas = (size_t)features->total[GEO_AREAS];
    file->buildings_unread = (size_t)features->buildings;
    file->streets_unread = (size_t)features->streets;
    if (!r->im->inspect || !features->any)
        return NOC_OK;
    bool usable;
    double corners[2][3] = { { features->lo[0], features->lo[1], NAN }, { features->hi[0], features->hi[1], NAN } };
    return place_points(r, corners[0], 2, "", &usable);
}

double import_done(const importer *im, load_part_done part, double share) {
    /* windows take most of a city whose walls are plain, reading most of one that is detailed */
    static const double begins[2][4] = { { 0, 0.9, 1, 1 }, { 0, 0.6, 0.65, 1 } };
    const double *at = begins[im->params->windows != NOC_SWITCH_OFF] + part;
    return at[0] + (at[1] - at[0]) * NOC_CLAMP(share, 0, 1);
}

bool import_progress(importer *im, const input *in, double bytes) {
    const noc_progress *progress = &im->params->progress;
    double done = im->bytes_total > 0 ? bytes / im->bytes_total : 1;
    if (progress->update && !progress->update(progress->user, in->path, import_done(im, DONE_READING, done)))
        im->cancelled = true;
    return !im->cancelled;
}

static bool on_progress(void *ctx, double done) {
    reading *r = ctx;
    bool go_on;
    if (r->queue) /* another thread counts what is read */
        go_on = queue_progress(r->queue, done);
    else
        go_on = import_progress(r->im, r->in, r->im->bytes_before + NOC_CLAMP(done, 0, 1) * (double)r->in->bytes);
    r->stopped = r->stopped || !go_on;
    return go_on;
}

geo_sink sink_create(reading *r) {
    return (geo_sink){ .ctx = r,
                       .log = r->log,
                       .issues = r->in->issues,
                       .lamps_lost = &r->in->lamps_lost,
                       .decimal_sign = &r->in->file.decimal_sign,
                       .crs = on_crs,
                       .heights = height_unit_heights,
                       .height_unit = height_unit_now,
                       .appearance = r->im->params->textures ? on_appearance : NULL,
                       .begin_object = on_begin_object,
                       .polygon = on_polygon,
                       .end_object = on_end_object,
                       .lamp = on_lamp,
                       .footprint = r->im->params->footprints ? on_footprint : NULL,
                       .road = roads_wanted(r->im) || r->in->named_tracks ? on_road : NULL,
                       .track = on_track,
                       .area = roads_wanted(r->im) ? on_area : NULL,
                       .columns = on_columns,
                       .features = on_features,
                       .progress = on_progress,
                       .sides = r->sides.threads > 1 ? &r->sides : NULL,
                       .named_lamps = r->in->named_lamps,
                       .named_tracks = r->in->named_tracks,
                       .given_metres = r->in->crs && !r->in->crs_degrees,
                       .given_degrees = r->in->crs && r->in->crs_degrees,
                       .inspect = r->im->inspect };
}

void reading_free(reading *r) {
    for (int c = 0; c < NOC_CLASS_COUNT; c++)
        geo_triangles_free(&r->surfaces[c]);
    look_free(r);
    array_free(&r->parts);
    array_free(&r->scratch);
    array_free(&r->in_box);
    geo_transform_destroy(r->to_box);
    array_free(&r->given);
    free(r->object_id);
}
