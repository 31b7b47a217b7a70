/* What comes back from the helper. It may have been taken over by the file that it reads: nothing is believed. */
#include "import/lamps/tags.h"
#include "import/remote/remote.h"

#include <math.h>
#include <stdio.h>

static noc_status garbled(const remote_taker *t) {
    return noc_error(t->sink->log, NOC_ERR_FORMAT, "%s: what came back from the process that reads it makes no sense",
                     t->path);
}

/* Bytes that a bool may be. */
static bool is_bool(const void *at) { return *(const unsigned char *)at <= 1; }

static noc_status take_log(remote_taker *t, remote_record *one) {
    int32_t level = 0;
    remote_get(one, &level, sizeof(level));
    const char *text = remote_get_text(one);
    if (one->bad || !*text)
        return garbled(t);
    if (level == NOC_LOG_ERROR && t->error)
        return garbled(t);
    if (level == NOC_LOG_ERROR)
        return (t->error = noc_strdup(text)) ? NOC_OK : noc_no_memory(t->sink->log, t->path);
    if (level == NOC_LOG_WARN)
        noc_warn(t->sink->log, "%s", text);
    else if (level == NOC_LOG_INFO)
        noc_info(t->sink->log, "%s", text);
    else
        noc_debug(t->sink->log, "%s", text);
    return NOC_OK;
}

static noc_status take_lamp(remote_taker *t, remote_record *one) {
    geo_lamp lamp;
    if (!remote_get(one, &lamp, sizeof(lamp)))
        return garbled(t);
    lamp.id = remote_get_text(one);
    lamp.ref = remote_get_text(one);
    lamp.tags = remote_get_text(one);
    bool kinds = (unsigned)lamp.type <= GEO_LAMP_FLOOD && (unsigned)lamp.source < NOC_SOURCE_COUNT &&
                 (unsigned)lamp.mount <= GEO_MOUNT_SUSPENDED && is_bool(&lamp.head_globe) &&
                 is_bool(&lamp.tells_street) && is_bool(&lamp.metres);
    lamp.fitting = NULL;
    /* or NaN */
    bool headings = lamp.heading_count >= 0 && lamp.heading_count <= GEO_HEADINGS;
    bool numbers = headings && !(lamp.height > LAMP_MOST_METRES || lamp.bare_height < 0 ||
                                 lamp.lumens > LAMP_MOST_LUMENS || lamp.watts > LAMP_MOST_WATTS);
    if (one->bad || !kinds || !numbers || strlen(lamp.tags) >= GEO_LAMP_TAGS ||
        lamp.body_heads /* of models, not of maps */ || lamp.count < 0 || !isfinite(lamp.xyz[0]) ||
        !isfinite(lamp.xyz[1]))
        return garbled(t);
    return t->sink->lamp(t->sink->ctx, &lamp);
}

static noc_status take_object(remote_taker *t, remote_record *one) {
    remote_object o = { 0 };
    remote_get(one, &o, sizeof(o));
    const char *id = remote_get_text(one);
    if (one->bad || t->in_object || t->parts || (uint32_t)o.kind >= GEO_KIND_COUNT || o.lod < -1 || o.lod > 4)
        return garbled(t);
    t->in_object = true;
    return t->sink->begin_object(t->sink->ctx, &(geo_object){ (geo_kind)o.kind, id, o.lod });
}

/* Into t->rings and t->xyz, aligned. least: points of one. */
static noc_status take_rings(remote_taker *t, remote_record *one, uint64_t rings, uint64_t least) {
    const char *sizes = remote_get_array(one, rings, sizeof(uint64_t));
    uint64_t points = 0;
    if (one->bad || !t->placed || !rings)
        return garbled(t);
    t->rings.len = t->xyz.len = 0;
    for (uint64_t i = 0; i < rings; i++) {
        uint64_t size;
        memcpy(&size, sizes + i * sizeof(size), sizeof(size));
        if (size < least || size > one->bytes.len)
            return garbled(t);
        points += size;
        if (!array_push(&t->rings, (size_t)size))
            return noc_no_memory(t->sink->log, t->path);
    }
    const void *xyz = remote_get_array(one, points, 3 * sizeof(double));
    if (one->bad)
        return garbled(t);
    size_t count = 3 * (size_t)points;
    if (!array_reserve(&t->xyz, count))
        return noc_no_memory(t->sink->log, t->path);
    memcpy(t->xyz.data, xyz, count * sizeof(double));
    return NOC_OK;
}

static noc_status take_polygon(remote_taker *t, remote_record *one) {
    uint64_t numbers[2] = { 0 }; /* class, rings */
    remote_get(one, numbers, sizeof(numbers));
    const char *id = remote_get_text(one);
    if (one->bad || !t->in_object || numbers[0] >= NOC_CLASS_COUNT)
        return garbled(t);
    noc_status status = take_rings(t, one, numbers[1], 3);
    const geo_polygon polygon = { (noc_class)numbers[0], id, t->rings.len, t->rings.data, t->xyz.data };
    return status ? status : t->sink->polygon(t->sink->ctx, &polygon);
}

static noc_status take_footprint(remote_taker *t, remote_record *one) {
    remote_footprint f = { 0 };
    remote_get(one, &f, sizeof(f));
    const char *id = remote_get_text(one);
    const double most = 1000; /* m, storeys; or NaN */
    if (one->bad || t->in_object || t->parts || !t->sink->footprint || f.height > most || f.min_height < 0 ||
        f.levels > most || f.min_level < 0 || f.roof_height > most || f.use >= NOC_USE_COUNT || f.bare > 1)
        return garbled(t);
    noc_status status = take_rings(t, one, f.rings, 3);
    const geo_footprint footprint = { id,
                                      t->rings.len,
                                      t->rings.data,
                                      t->xyz.data,
                                      f.height,
                                      f.min_height,
                                      f.levels,
                                      f.min_level,
                                      f.roof_height,
                                      f.bare == 1,
                                      (noc_building_use)f.use };
    return status ? status : t->sink->footprint(t->sink->ctx, &footprint);
}

static noc_status take_road(remote_taker *t, remote_record *one) {
    geo_road road;
    if (!remote_get(one, &road, sizeof(road)))
        return garbled(t);
    road.id = remote_get_text(one);
    road.name = remote_get_text(one);
    road.deck = NULL;
    bool flags = is_bool(&road.link) && is_bool(&road.roundabout) && is_bool(&road.bridge) && is_bool(&road.tunnel) &&
                 is_bool(&road.motor);
    bool kinds = (unsigned)road.cls < GEO_ROAD_CLASSES && (unsigned)road.lit <= GEO_LIT_YES && road.oneway >= -1 &&
                 road.oneway <= 1;
    const int counts[] = { road.lanes, road.lanes_forward, road.lanes_backward };
    for (size_t i = 0; i < NOC_COUNT(counts); i++)
        kinds = kinds && counts[i] >= 0 && counts[i] <= GEO_ROAD_MOST_LANES;
    const geo_highway *highway = geo_highway_get(road.highway);
    kinds = kinds && (highway ? highway->cls == road.cls : !road.highway);
    kinds = kinds && road.layer >= -GEO_ROAD_MOST_LAYER && road.layer <= GEO_ROAD_MOST_LAYER;
    bool numbers = !(road.width <= 0) && !(road.width > LAMP_MOST_METRES) && !(road.speed <= 0) && !(road.speed > 500);
    const void *xyz = remote_get_array(one, road.point_count, 3 * sizeof(double));
    if (one->bad || !flags || !kinds || !numbers || !t->placed || t->in_object || t->parts || !t->sink->road ||
        road.point_count < 2)
        return garbled(t);
    size_t count = 3 * road.point_count;
    t->xyz.len = 0;
    if (!array_reserve(&t->xyz, count)) /* aligned */
        return noc_no_memory(t->sink->log, t->path);
    memcpy(t->xyz.data, xyz, count * sizeof(double));
    road.xyz = t->xyz.data;
    return t->sink->road(t->sink->ctx, &road);
}

static noc_status take_area(remote_taker *t, remote_record *one) {
    uint64_t head[2] = { 0, 0 };
    remote_get(one, head, sizeof(head));
    const char *id = remote_get_text(one);
    if (one->bad || t->in_object || t->parts || !t->sink->area || head[1] >= NOC_CLASS_COUNT)
        return garbled(t);
    noc_status status = take_rings(t, one, head[0], 3);
    const geo_polygon area = { (noc_class)head[1], id, t->rings.len, t->rings.data, t->xyz.data };
    return status ? status : t->sink->area(t->sink->ctx, &area);
}

static noc_status take_track(remote_taker *t, remote_record *one) {
    uint64_t head[2] = { 0, 0 };
    remote_get(one, head, sizeof(head));
    const char *id = remote_get_text(one);
    if (one->bad || t->in_object || t->parts || !t->sink->track || head[1] > 1)
        return garbled(t);
    noc_status status = take_rings(t, one, head[0], 2);
    if (status)
        return status;
    size_t points = 0;
    bool finite = true;
    for (size_t i = 0; i < t->rings.len; i++)
        points += t->rings.data[i];
    const void *seconds = head[1] ? remote_get_array(one, points, sizeof(double)) : NULL;
    if (seconds && !array_reserve(&t->seconds, points)) /* aligned */
        return noc_no_memory(t->sink->log, t->path);
    if (seconds)
        memcpy(t->seconds.data, seconds, points * sizeof(double));
    for (size_t i = 0; i < points && !one->bad; i++)
        finite = finite && isfinite(t->xyz.data[3 * i]) && isfinite(t->xyz.data[3 * i + 1]) &&
                 (!seconds || isfinite(t->seconds.data[i]));
    if (one->bad || !finite)
        return garbled(t);
    const geo_track track = { id, t->rings.len, t->rings.data, t->xyz.data, seconds ? t->seconds.data : NULL };
    return t->sink->track(t->sink->ctx, &track);
}

static noc_status take_object_end(remote_taker *t) {
    if (!t->in_object)
        return garbled(t);
    t->in_object = false;
    return t->sink->end_object(t->sink->ctx);
}

static noc_status take_material(remote_taker *t, remote_record *one) {
    noc_material material;
    remote_image told = { 0 };
    if (!remote_get(one, &material, sizeof(material)) || !t->parts || !is_bool(&material.two_sided) ||
        !is_bool(&material.cutout) || material.texture)
        return garbled(t);
    const char *name = remote_get_text(one);
    remote_get(one, &told, sizeof(told));
    mesh_image image = { .name = remote_get_text(one), .wrap = (noc_wrap)told.wrap, .cutoff = (uint8_t)told.cutoff };
    bool sound = told.there <= 1 && told.wrap <= NOC_WRAP_CLAMP && told.cutoff <= UINT8_MAX;
    for (int k = 0; k < 3; k++) {
        image.albedo[k] = told.albedo[k];
        sound = sound && told.albedo[k] >= 0 && told.albedo[k] <= 1; /* false for NaN, too */
    }
    if (one->bad || !sound)
        return garbled(t);
    int index;
    noc_status status = t->parts->material(t->parts->ctx, &material, name, told.there ? &image : NULL, &index);
    if (status)
        return status;
    return array_push(&t->materials, index) ? NOC_OK : noc_no_memory(t->sink->log, t->path);
}

static noc_status take_mesh(remote_taker *t, remote_record *one) {
    remote_mesh m = { 0 };
    remote_get(one, &m, sizeof(m));
    const char *name = remote_get_text(one);
    const void *positions = remote_get_array(one, m.vertices, 3 * sizeof(double));
    const void *indices = remote_get_array(one, m.triangles, 3 * sizeof(uint32_t));
    const void *places = remote_get_array(one, m.places ? m.vertices : 0, 2 * sizeof(float));
    if (one->bad || !t->parts || m.material < 0 || (size_t)m.material >= t->materials.len || m.places > 1)
        return garbled(t);
    float *uv = m.places ? noc_alloc_large((size_t)m.vertices * 2, sizeof(*uv)) : NULL;
    double *xyz = noc_alloc_large((size_t)m.vertices * 3, sizeof(*xyz)); /* aligned */
    uint32_t *corners = noc_alloc_large((size_t)m.triangles * 3, sizeof(*corners));
    noc_status status = NOC_OK;
    if (!xyz || !corners || (m.places && !uv)) {
        status = noc_no_memory(t->sink->log, t->path);
    } else {
        memcpy(xyz, positions, (size_t)m.vertices * 3 * sizeof(*xyz));
        memcpy(corners, indices, (size_t)m.triangles * 3 * sizeof(*corners));
        if (uv)
            memcpy(uv, places, (size_t)m.vertices * 2 * sizeof(*uv));
        noc_mesh mesh = { .vertex_count = (size_t)m.vertices,
                          .positions = xyz,
                          .triangle_count = (size_t)m.triangles,
                          .indices = corners,
                          .material = t->materials.data[m.material],
                          .uv = uv,
                          .name = *name ? name : NULL };
        status = t->parts->mesh(t->parts->ctx, &mesh, xyz);
    }
    free(xyz);
    free(uv);
    free(corners);
    return status;
}

static noc_status take_issue(remote_taker *t, remote_record *one) {
    unsigned char kind = 0;
    size_t count = 0;
    remote_get(one, &kind, sizeof(kind));
    remote_get(one, &count, sizeof(count));
    const char *reason = remote_get_text(one), *examples = remote_get_text(one);
    if (one->bad || kind >= GEO_ISSUE_KINDS)
        return garbled(t);
    geo_issues_add(t->sink->issues, (geo_issue_kind)kind, reason, count, examples);
    return NOC_OK;
}

static noc_status take_columns(remote_taker *t, remote_record *one) {
    uint64_t points = 0, count = 0;
    bool kept = true;
    NOC_ARRAY(geo_column) columns = { 0 };
    remote_get(one, &points, sizeof(points));
    remote_get(one, &count, sizeof(count));
    for (uint64_t i = 0; i < count && !one->bad && kept; i++) {
        uint64_t values = 0;
        unsigned char mapped = 0;
        remote_get(one, &values, sizeof(values));
        remote_get(one, &mapped, sizeof(mapped));
        geo_column c = { .values = (size_t)values, .mapped = mapped != 0 };
        c.name = remote_get_text(one);
        c.field = remote_get_text(one);
        c.unit = remote_get_text(one);
        c.example = remote_get_text(one);
        kept = array_push(&columns, c);
    }
    noc_status status = one->bad ? garbled(t) : kept ? NOC_OK : noc_no_memory(t->sink->log, t->path);
    if (!status && t->sink->columns)
        status = t->sink->columns(t->sink->ctx, (size_t)points, columns.data, columns.len);
    array_free(&columns);
    return status;
}

static noc_status take_features(remote_taker *t, remote_record *one) {
    geo_features f;
    if (!remote_get(one, &f, sizeof(f)) || !is_bool(&f.any))
        return garbled(t);
    if (f.any && !(isfinite(f.lo[0]) && isfinite(f.lo[1]) && isfinite(f.hi[0]) && isfinite(f.hi[1])))
        return garbled(t);
    return t->sink->features ? t->sink->features(t->sink->ctx, &f) : NOC_OK;
}

static noc_status take_end(remote_taker *t, remote_record *one) {
    remote_end end = { 0 };
    remote_get(one, &end, sizeof(end));
    const char *format = remote_get_text(one);
    if (one->bad || (t->in_object && !end.status) || end.status < NOC_OK || end.status > NOC_ERR_CANCELLED ||
        (end.status != NOC_OK) != (t->error != NULL) || !is_bool(&end.trailing))
        return garbled(t);
    snprintf(t->result->format, sizeof(t->result->format), "%s", format);
    t->result->bytes_read = end.bytes_read;
    t->result->trailing = end.trailing;
    if (t->sink->lamps_lost)
        *t->sink->lamps_lost += (size_t)end.lamps_lost;
    t->ended = true;
    return t->error ? noc_error(t->sink->log, (noc_status)end.status, "%s", t->error) : NOC_OK;
}

static noc_status take_heights(remote_taker *t, remote_record *one) {
    double metres = 0;
    remote_get(one, &metres, sizeof(metres));
    if (one->bad || !t->placed || !(metres > 0) || !isfinite(metres))
        return garbled(t);
    return t->sink->heights ? t->sink->heights(t->sink->ctx, metres) : NOC_OK;
}

static noc_status take_named(remote_taker *t, remote_record *one) {
    const char *path = remote_get_text(one);
    if (one->bad || !*path)
        return garbled(t);
    if (t->listener && t->listener->on_named)
        t->listener->on_named(t->listener->user, path);
    return NOC_OK;
}

static noc_status take(remote_taker *t, uint32_t kind, remote_record *one) {
    switch (kind) {
    case REMOTE_LOG: return take_log(t, one);
    case REMOTE_CRS: {
        const char *srs_name = remote_get_text(one), *place = remote_get_text(one);
        bool lat_first;
        t->placed = !one->bad;
        return one->bad ? garbled(t) : t->sink->crs(t->sink->ctx, srs_name, place, &lat_first);
    }
    case REMOTE_HEIGHTS: return take_heights(t, one);
    case REMOTE_LAMP: return take_lamp(t, one);
    case REMOTE_MATERIAL: return take_material(t, one);
    case REMOTE_MESH: return take_mesh(t, one);
    case REMOTE_ISSUE: return take_issue(t, one);
    case REMOTE_PROGRESS: return remote_get(one, &t->done, sizeof(t->done)) && isfinite(t->done) ? NOC_OK : garbled(t);
    case REMOTE_COLUMNS: return take_columns(t, one);
    case REMOTE_FEATURES: return take_features(t, one);
    case REMOTE_OBJECT: return take_object(t, one);
    case REMOTE_POLYGON: return take_polygon(t, one);
    case REMOTE_OBJECT_END: return take_object_end(t);
    case REMOTE_FOOTPRINT: return take_footprint(t, one);
    case REMOTE_ROAD: return take_road(t, one);
    case REMOTE_AREA: return take_area(t, one);
    case REMOTE_TRACK: return take_track(t, one);
    case REMOTE_NAMED: return take_named(t, one);
    case REMOTE_END: return take_end(t, one);
    default: return garbled(t);
    }
}

bool remote_take(remote_taker *t, noc_status *status) {
    remote_head head;
    size_t left = t->bytes.len - t->pos;
    if (t->ended || left < sizeof(head))
        return false;
    memcpy(&head, t->bytes.data + t->pos, sizeof(head));
    uint64_t size = (uint64_t)head.size_high << 32 | head.size_low;
    if (left - sizeof(head) < size)
        return false;
    remote_record one = { .bytes = { .data = t->bytes.data + t->pos + sizeof(head), .len = (size_t)size } };
    t->pos += sizeof(head) + (size_t)size;
    *status = take(t, head.kind, &one);
    return true;
}

char *remote_room(remote_taker *t, size_t size) {
    if (t->pos) {
        memmove(t->bytes.data, t->bytes.data + t->pos, t->bytes.len - t->pos);
        t->bytes.len -= t->pos;
        t->pos = 0;
    }
    size_t room = t->bytes.len + size;
    if (room > t->bytes.cap && !array_reserve(&t->bytes, NOC_MAX(room, t->bytes.len * 2))) {
        noc_no_memory(t->sink->log, t->path);
        return NULL;
    }
    return t->bytes.data + t->bytes.len;
}

void remote_taker_free(remote_taker *t) {
    array_free(&t->bytes);
    array_free(&t->materials);
    array_free(&t->rings);
    array_free(&t->seconds);
    array_free(&t->xyz);
    free(t->error);
}
