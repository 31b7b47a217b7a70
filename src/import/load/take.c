/* The scene's side: parts of files into the scene, in the order of the files, whatever the order they were read in. One
 * mesh an object and class, so that ids stay findable and a mesh has one material. */
#include "city/city.h"
#include "import/load/load.h"

#include <math.h>

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

int take_material(importer *im, noc_class cls, const char *id) {
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

static double area_from_above(const part_surface *s) {
    double sum = 0;
    for (size_t i = 0; i < 3 * s->triangle_count; i += 3) {
        const double *a = s->xyz + 3 * (size_t)s->indices[i], *b = s->xyz + 3 * (size_t)s->indices[i + 1],
                     *c = s->xyz + 3 * (size_t)s->indices[i + 2];
        sum += fabs((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2;
    }
    return sum;
}

noc_status take_affords(importer *im, const input *in, size_t more) {
    size_t scene = noc_scene_bytes(im->scene) + more, made = scene - NOC_MIN(scene, im->scene_before);
    size_t waiting = im->lamps.cap * sizeof(*im->lamps.data) + im->footprints.cap * sizeof(*im->footprints.data) +
                     im->roads.cap * sizeof(*im->roads.data) + im->tracks.cap * sizeof(*im->tracks.data) +
                     (im->water.xyz.cap + im->green.xyz.cap + im->squares.xyz.cap + im->lots.xyz.cap) * sizeof(double) +
                     (im->water.indices.cap + im->green.indices.cap + im->squares.indices.cap + im->lots.indices.cap) *
                         sizeof(uint32_t) +
                     im->lost.cap * sizeof(*im->lost.data) + im->names.bytes + im->image_bytes +
                     im->records.list.cap * sizeof(*im->records.list.data);
    import_budget memory = { .memory = im->memory }, growth = { INFINITY, 0, (double)in->bytes };
    if (in->reader && in->reader->reads == NOC_READS_CITY) /* other readers see themselves to what files grow to */
        growth.expansion = im->params->max_expansion;
    noc_status status = import_affords(&memory, (double)(scene + waiting), in->path, "the scene with it", im->log);
    return status ? status : import_affords(&growth, (double)made, in->path, "its part of the scene", im->log);
}

noc_status take_kept(importer *im, const input *in) {
    enum { ASK = 1 << 20 };
    if (im->names.bytes - im->names_asked < ASK)
        return NOC_OK;
    im->names_asked = im->names.bytes;
    return take_affords(im, in, 0);
}

static noc_status take_surface(importer *im, input *in, const char *id, const part_surface *s) {
    noc_mesh mesh = { .vertex_count = s->vertex_count,
                      .positions = s->xyz,
                      .triangle_count = s->triangle_count,
                      .indices = s->indices,
                      .uv = s->uv,
                      .name = *id ? id : NULL };
    noc_status status = s->look ? look_material(im, in, s->cls, s->look, &mesh.material) : NOC_OK;
    if (status)
        return status;
    if (!s->look)
        mesh.material = take_material(im, s->cls, id);
    if (mesh.material < 0 || noc_scene_add_mesh(im->scene, &mesh) < 0)
        return NOC_ERR_UNSUPPORTED; /* said by the scene */
    in->file.triangles += mesh.triangle_count;
    status = take_affords(im, in, 0);
    if (!status && is_open_ground(s->cls))
        im->open_area += area_from_above(s);
    im->has_roads = im->has_roads || s->cls == NOC_CLASS_ROAD || s->cls == NOC_CLASS_SIDEWALK;
    return status;
}

static noc_status take_object(importer *im, input *in, const load_part *part) {
    const object_now *now = &part->u.object.now;
    const char *id = part->u.object.id ? part->u.object.id : "";
    noc_status status = NOC_OK;
    if (!in->object_begun)
        im->object_mesh = im->scene->meshes.len;
    in->object_begun = !part->u.object.last;
    if (part->u.object.id && part->u.object.surface_count)
        status = repeat_object(im, in, now, id);
    for (size_t i = 0; i < part->u.object.surface_count && !status && !in->object_repeated; i++) {
        status = take_surface(im, in, id, &part->u.object.surfaces[i]);
        if (now->kind == GEO_BUILDING)
            faces_add(&in->faces, &part->u.object.surfaces[i]);
        bool ground = part->u.object.surfaces[i].cls == NOC_CLASS_GROUND;
        if (!status && ground && now->kind != GEO_BUILDING)
            im->scene->meshes.data[im->scene->meshes.len - 1].land = true;
    }
    if (status || !part->u.object.last)
        return status;
    for (int c = 0; c < NOC_CLASS_COUNT && !in->object_repeated; c++)
        in->file.polygons_by_class[c] += now->by_class[c];
    in->file.polygons += in->object_repeated ? 0 : now->polygons;
    faces_end(in);
    if (!in->object_repeated && !units_see_building(im, in, now))
        return noc_no_memory(im->log, in->path);
    if (now->kind == GEO_BUILDING && im->object_mesh < im->scene->meshes.len && im->params->windows != NOC_SWITCH_OFF &&
        !array_push(&im->buildings, (taken_building){ (uint32_t)im->object_mesh, (uint32_t)im->scene->meshes.len,
                                                      (size_t)(in - im->inputs), now->use }))
        return noc_no_memory(im->log, in->path);
    if (now->outline && im->object_mesh < im->scene->meshes.len &&
        !array_push(&im->outlines, (city_outline){ (uint32_t)im->object_mesh, (uint32_t)im->scene->meshes.len,
                                                   (size_t)(in - im->inputs) }))
        return noc_no_memory(im->log, in->path);
    in->object_decided = in->object_repeated = false;
    return NOC_OK;
}

/* ---- lamps ---- */

static noc_status take_lamp(importer *im, input *in, pending_lamp p) {
    if (im->lamps.len == im->lamps.cap) { /* it doubles */
        noc_status status = take_affords(im, in, im->lamps.cap * sizeof(p));
        if (status)
            return status;
    }
    p.lamp.id = arena_strdup(&im->names, p.lamp.id);
    p.lamp.ref = *p.lamp.ref ? arena_strdup(&im->names, p.lamp.ref) : "";
    bool tagged = p.lamp.tags && *p.lamp.tags;
    p.lamp.tags = tagged ? arena_strdup(&im->names, p.lamp.tags) : NULL;
    bool kept = p.lamp.id && p.lamp.ref && (p.lamp.tags || !tagged) && array_push(&im->lamps, p);
    return kept ? NOC_OK : noc_no_memory(im->log, in->path);
}

static void tell(noc_log *log, noc_log_level level, const char *text) {
    switch (level) {
    case NOC_LOG_ERROR: noc_error(log, NOC_OK, "%s", text); break;
    case NOC_LOG_WARN: noc_warn(log, "%s", text); break;
    case NOC_LOG_INFO: noc_info(log, "%s", text); break;
    case NOC_LOG_DEBUG: noc_debug(log, "%s", text); break;
    }
}

taking take_start(importer *im, input *in) {
    in->started = true;
    in->first_mesh = im->scene->meshes.len;
    im->scene_before = noc_scene_bytes(im->scene);
    return (taking){ im, in, im->log, im->scene->log };
}

noc_status take_part(importer *im, input *in, const load_part *part) {
    switch (part->kind) {
    case PART_OBJECT: return take_object(im, in, part);
    case PART_LAMP: return take_lamp(im, in, part->u.lamp);
    case PART_LOST: return array_push(&im->lost, part->u.lost) ? NOC_OK : noc_no_memory(im->log, in->path);
    case PART_MESSAGE: tell(im->log, part->u.message.level, part->u.message.text); return NOC_OK;
    case PART_QUIET: im->log = im->scene->log = NULL; return NOC_OK;
    }
    return NOC_OK;
}

/* What was found as parts were taken stands behind what the reader found. */
static bool add_found(input *in) {
    for (size_t i = 0; i < geo_issues_count(in->found); i++) {
        const char *reason, *examples;
        bool repaired;
        size_t count;
        if (!geo_issues_get(in->found, i, &reason, &repaired, &count, &examples))
            return false;
        geo_issues_add(in->issues, geo_issues_kind(in->found, i), reason, count, examples);
    }
    return !geo_issues_refused(in->found);
}

noc_status take_finish(const taking *t, noc_status status) {
    t->im->log = t->log; /* PART_QUIET took them away */
    t->im->scene->log = t->of_scene;
    t->im->bytes_before += (double)t->in->bytes;
    t->in->end_mesh = t->im->scene->meshes.len;
    bool added = add_found(t->in);
    return status || added ? status : noc_no_memory(t->im->log, t->in->path);
}

void take_destroy(importer *im) {
    repeat_free(&im->records);
    array_free(&im->lamps);
    array_free(&im->footprints);
    array_free(&im->roads);
    city_roads_destroy(im->roads_by_place);
    map_free(&im->road_places);
    array_free(&im->tracks);
    geo_triangles_free(&im->water);
    geo_triangles_free(&im->green);
    geo_triangles_free(&im->squares);
    geo_triangles_free(&im->lots);
    array_free(&im->lost);
    array_free(&im->buildings);
    array_free(&im->outlines);
    map_free(&im->looks);
    map_free(&im->image_numbers);
    look_images_free(im);
    arena_free(&im->names);
}
