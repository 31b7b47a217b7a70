/* lamp.c: city furniture, generic objects, and installations of buildings that are lamps.
 *
 * Function, class and usage say so, by the standard's code list or in words, or the name, or attributes that only lamps
 * have. A lamp that is modelled keeps its body, and its light goes where the body leaves it free: under the ends of
 * arms, or in a globe around the head of a post. Whether it is free is asked of rays against the body itself. A body
 * that is but a block around the lamp would swallow any light in it: such a lamp gets a pole of ours in its stead. */
#include "import/citygml/citygml.h"
#include "import/lamps/tags.h"

#include <math.h>
#include <time.h>

#define FREE 0.75   /* share of a light that must leave the body */
#define ARM 0.45    /* m off the foot from which on a head hangs on an arm */
#define END 0.8     /* m: what belongs to the end of an arm */
#define GAP 0.03    /* m under it */
#define DISC 0.15   /* m; the radius of a lamp's disc */
#define GLOBE 0.6   /* m; the largest globe */
#define NO_POLE 1.2 /* m; a body lower than this is a luminaire without a pole */
#define RAYS 64
#define ASK 1024 /* features and surfaces that are looked at before progress is asked */

/* ---- is it one? ---- */

static bool tags_of(cg_parser *p, uint32_t feature, lamp_tag *tags, size_t *count) {
    const cg_object *object = &p->object;
    const cg_feature *of = &object->features.data[feature];
    bool sure = false;
    *count = 0;
    for (size_t i = of->first_attribute; i < of->end_attribute; i++) {
        const cg_attribute *a = &object->attributes.data[i];
        if (a->feature != feature)
            continue;
        sure = sure || lamp_object_word(a->value) > 1;
        if (a->generic)
            tags[(*count)++] = (lamp_tag){ a->key, a->value };
    }
    return sure;
}

static bool is_lamp(cg_parser *p, uint32_t feature, const lamp_tag *tags, size_t count, bool sure) {
    const cg_object *object = &p->object;
    if (object->features.data[feature].function == NOC_CLASS_LAMP || sure)
        return true;
    if (feature == 0 && object->other_function)
        return false;
    const char **names = noc_calloc(count + 1, sizeof(*names));
    if (!names) {
        cg_no_memory(p);
        return false;
    }
    for (size_t i = 0; i < count; i++)
        names[i] = tags[i].key;
    bool tell = lamp_columns_tell(p->keys, names, count);
    free(names);
    return tell;
}

/* ---- its body ---- */

typedef struct body {
    geo_triangles mesh; /* metres about `origin` */
    double origin[3];   /* easting northing height, as the file has them */
    double scale[2];    /* metres a unit of x and y */
    double low, high, foot[2];
} body;

/* The first item of the geometry, or of a later one: items are in the order of geometries. */
static size_t first_item(const cg_parser *p, uint32_t geometry) {
    size_t low = 0, high = p->selection.items.len;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (p->selection.items.data[middle].geometry < geometry)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

typedef struct item_range {
    size_t first, end;
} item_range;

/* The items of a feature and of its parts, whose geometries follow each other. */
static item_range items_of(cg_parser *p, uint32_t feature) {
    const cg_feature *of = &p->object.features.data[feature];
    item_range range = { first_item(p, of->first_geometry), first_item(p, of->end_geometry) };
    p->looked += range.end - range.first;
    return range;
}

/* The feature's shown surfaces as triangles; false if there are none. */
static bool read_body(cg_parser *p, uint32_t feature, body *b) {
    bool first = true;
    const item_range range = items_of(p, feature);
    for (size_t i = range.first; i < range.end && p->selection.lod >= 0 && !p->status; i++) {
        const cg_item *item = &p->selection.items.data[i];
        if (!item->shown)
            continue;
        const cg_implicit *implicit = p->object.geometries.data[item->geometry].implicit;
        cg_tell_crs(p, implicit ? implicit->srs : item->polygon->srs);
        cg_transform(p, item->polygon, implicit, false);
        if (p->status)
            break;
        if (first) {
            memcpy(b->origin, p->out.data, sizeof(b->origin));
            cg_metres(p, b->origin, &b->scale[0], &b->scale[1]);
            first = false;
        }
        for (size_t k = 0; k < p->out.len; k++)
            p->out.data[k] = (p->out.data[k] - b->origin[k % 3]) * (k % 3 < 2 ? b->scale[k % 3] : 1);
        geo_polygon polygon = { .cls = NOC_CLASS_LAMP,
                                .id = "",
                                .ring_count = p->out_rings.len,
                                .ring_size = p->out_rings.data,
                                .xyz = p->out.data };
        geo_triangulate(&polygon, &b->mesh, NULL);
        if (b->mesh.no_memory)
            cg_no_memory(p);
    }
    return b->mesh.indices.len > 0 && !p->status;
}

/* Lowest and highest point, and the middle of what is near the lowest: the foot, not the arm. */
static void measure(body *b) {
    const double *xyz = b->mesh.xyz.data;
    size_t n = b->mesh.xyz.len, count = 0;
    b->low = INFINITY;
    b->high = -INFINITY;
    for (size_t i = 0; i < n; i += 3) {
        b->low = fmin(b->low, xyz[i + 2]);
        b->high = fmax(b->high, xyz[i + 2]);
    }
    b->foot[0] = b->foot[1] = 0;
    for (size_t i = 0; i < n; i += 3)
        if (xyz[i + 2] <= b->low + 0.3) {
            b->foot[0] += xyz[i];
            b->foot[1] += xyz[i + 1];
            count++;
        }
    b->foot[0] /= (double)count;
    b->foot[1] /= (double)count;
}

static bool hits(const body *b, const double o[3], const double d[3]) {
    for (size_t t = 0; t < b->mesh.indices.len; t += 3) {
        const double *v[3];
        double e1[3], e2[3], s[3], c[3], q[3];
        for (int i = 0; i < 3; i++)
            v[i] = b->mesh.xyz.data + 3 * (size_t)b->mesh.indices.data[t + (size_t)i];
        for (int k = 0; k < 3; k++) {
            e1[k] = v[1][k] - v[0][k];
            e2[k] = v[2][k] - v[0][k];
            s[k] = o[k] - v[0][k];
        }
        for (int k = 0; k < 3; k++) {
            c[k] = d[(k + 1) % 3] * e2[(k + 2) % 3] - d[(k + 2) % 3] * e2[(k + 1) % 3];
            q[k] = s[(k + 1) % 3] * e1[(k + 2) % 3] - s[(k + 2) % 3] * e1[(k + 1) % 3];
        }
        double det = e1[0] * c[0] + e1[1] * c[1] + e1[2] * c[2];
        if (fabs(det) < 1e-14)
            continue;
        double u = (s[0] * c[0] + s[1] * c[1] + s[2] * c[2]) / det, w = (d[0] * q[0] + d[1] * q[1] + d[2] * q[2]) / det;
        double x = (e2[0] * q[0] + e2[1] * q[1] + e2[2] * q[2]) / det;
        if (u >= 0 && w >= 0 && u + w <= 1 && x > 1e-4)
            return true;
    }
    return false;
}

/* The share of a light's flux that leaves the body: rays by its cosine, from all of its surface. */
static double share_free(const body *b, const double centre[3], double radius, bool globe) {
    const double golden = 2.399963229728653; /* the golden angle spreads points evenly over discs and spheres */
    int away = 0;
    for (int i = 0; i < RAYS; i++) {
        double s = (i + 0.5) / RAYS, a = golden * i, n[3] = { 0, 0, -1 }, o[3], d[3];
        if (globe) {
            double z = 1 - 2 * s, r = sqrt(1 - z * z);
            n[0] = r * cos(a);
            n[1] = r * sin(a);
            n[2] = z;
        }
        for (int k = 0; k < 3; k++)
            o[k] = centre[k] + (globe ? (radius + 1e-3) * n[k] : 0);
        if (!globe) {
            o[0] += radius * sqrt(s) * cos(a);
            o[1] += radius * sqrt(s) * sin(a);
        }
        /* normal + a point of the unit sphere is distributed by the cosine */
        double z = 1 - 2 * fmod(s + 0.381966 * (i % 8), 1), r = sqrt(fmax(1 - z * z, 0)), f = golden * 7 * i;
        d[0] = n[0] + 0.999 * r * cos(f);
        d[1] = n[1] + 0.999 * r * sin(f);
        d[2] = n[2] + 0.999 * z;
        away += !hits(b, o, d);
    }
    return (double)away / RAYS;
}

/* ---- where its light goes ---- */

static double offset(const body *b, const double *point) { return hypot(point[0] - b->foot[0], point[1] - b->foot[1]); }

/* Centre under what is within END of a point; false if the light would not be free there. */
static bool head_under(const body *b, const double *end, double above, double head[3]) {
    double lo[3] = { INFINITY, INFINITY, INFINITY }, hi[2] = { -INFINITY, -INFINITY };
    for (size_t i = 0; i < b->mesh.xyz.len; i += 3) {
        const double *q = b->mesh.xyz.data + i;
        if (q[2] < above || hypot(q[0] - end[0], q[1] - end[1]) > END)
            continue;
        for (int k = 0; k < 3; k++)
            lo[k] = fmin(lo[k], q[k]);
        for (int k = 0; k < 2; k++)
            hi[k] = fmax(hi[k], q[k]);
    }
    head[0] = (lo[0] + hi[0]) / 2;
    head[1] = (lo[1] + hi[1]) / 2;
    head[2] = lo[2] - GAP;
    return share_free(b, head, DISC, false) >= FREE;
}

/* Discs under the ends of arms, the farthest first. Returns how many are free; 0 where the lamp has no arms. */
static int find_arms(const body *b, double above, double heads[GEO_BODY_HEADS][3]) {
    double ends[GEO_BODY_HEADS][2], longest = 0;
    int count = 0, tried = 0;
    while (tried < GEO_BODY_HEADS) {
        const double *end = NULL;
        double farthest = fmax(ARM, 0.6 * longest);
        for (size_t i = 0; i < b->mesh.xyz.len; i += 3) {
            const double *q = b->mesh.xyz.data + i;
            bool taken = q[2] < above;
            for (int e = 0; e < tried && !taken; e++)
                taken = hypot(q[0] - ends[e][0], q[1] - ends[e][1]) < 1.5 * END;
            if (taken || offset(b, q) <= farthest)
                continue;
            farthest = offset(b, q);
            end = q;
        }
        if (!end)
            break;
        longest = fmax(longest, farthest);
        memcpy(ends[tried++], end, sizeof(ends[0]));
        count += head_under(b, end, above, heads[count]);
    }
    return count;
}

/* A globe around the head of a post, as large as it needs to be. */
static bool find_globe(const body *b, double above, double head[3], double *radius) {
    double wide = 0, bottom = b->high, lo[2] = { INFINITY, INFINITY }, hi[2] = { -INFINITY, -INFINITY };
    for (size_t i = 0; i < b->mesh.xyz.len; i += 3)
        if (b->mesh.xyz.data[i + 2] >= above)
            wide = fmax(wide, offset(b, b->mesh.xyz.data + i));
    for (size_t i = 0; i < b->mesh.xyz.len; i += 3) { /* the head is the wide part of the top */
        const double *q = b->mesh.xyz.data + i;
        if (q[2] < above || offset(b, q) < 0.5 * wide)
            continue;
        bottom = fmin(bottom, q[2]);
        for (int k = 0; k < 2; k++) {
            lo[k] = fmin(lo[k], q[k]);
            hi[k] = fmax(hi[k], q[k]);
        }
    }
    for (int k = 0; k < 2; k++)
        head[k] = (lo[k] + hi[k]) / 2;
    head[2] = (b->high + bottom) / 2;
    double least = hypot(hypot(hi[0] - lo[0], hi[1] - lo[1]) / 2, (b->high - bottom) / 2) + 0.02;
    for (*radius = fmax(least, 0.08); *radius <= GLOBE; *radius *= 1.25)
        if (share_free(b, head, *radius, true) >= FREE)
            return true;
    return false;
}

/* Sets the lamp's heads, if its body leaves a light free. */
static void find_heads(const body *b, geo_lamp *lamp) {
    double height = b->high - b->low, above = b->high - fmax(0.5, 0.25 * height), heads[GEO_BODY_HEADS][3];
    int count = height >= NO_POLE ? find_arms(b, above, heads) : head_under(b, b->foot, b->low, heads[0]);
    lamp->head_radius = DISC;
    if (!count) {
        count = find_globe(b, above, heads[0], &lamp->head_radius);
        lamp->head_globe = count > 0;
    }
    lamp->body_heads = count;
    for (int i = 0; i < count; i++)
        for (int k = 0; k < 3; k++)
            lamp->head[i][k] = b->origin[k] + heads[i][k] / (k < 2 ? b->scale[k] : 1);
}

/* What is mounted on something has no pole: a body that leaves no light free gives way to a globe in its middle. */
static void shine_from(geo_lamp *lamp, const double xyz[3], double radius) {
    lamp->body_heads = 1;
    lamp->head_globe = true;
    lamp->head_radius = fmin(fmax(radius, DISC / 2), GLOBE);
    memcpy(lamp->head[0], xyz, sizeof(lamp->head[0]));
}

/* Where the lamp stands by its body; false if it has none. */
static bool place_by_body(cg_parser *p, uint32_t feature, geo_lamp *lamp, bool *gives_way) {
    body b = { .scale = { 1, 1 } };
    bool any = read_body(p, feature, &b);
    if (any) {
        measure(&b);
        find_heads(&b, lamp);
        double height = b.high - b.low;
        lamp->xyz[0] = b.origin[0] + b.foot[0] / b.scale[0];
        lamp->xyz[1] = b.origin[1] + b.foot[1] / b.scale[1];
        lamp->xyz[2] = b.origin[2] + b.low;
        if (!isfinite(lamp->height) && height >= 2 && height <= 25)
            lamp->height = height;
        *gives_way = !lamp->body_heads;
        const double middle[3] = { lamp->xyz[0], lamp->xyz[1], b.origin[2] + (b.low + b.high) / 2 };
        if (*gives_way && feature)
            shine_from(lamp, middle, height / 2);
    }
    geo_triangles_free(&b.mesh);
    return any;
}

/* By the reference point of a prototype in another file, or by a point. */
static bool place_by_point(cg_parser *p, uint32_t feature, geo_lamp *lamp) {
    const cg_feature *of = &p->object.features.data[feature];
    for (uint32_t i = of->first_geometry; i < of->end_geometry; i++) {
        const cg_implicit *implicit = p->object.geometries.data[i].implicit;
        if (!implicit || !implicit->has_point)
            continue;
        cg_tell_crs(p, implicit->srs);
        memset(lamp->xyz, 0, sizeof(lamp->xyz));
        cg_place_point(p, implicit, lamp->xyz);
        if (feature)
            shine_from(lamp, lamp->xyz, DISC);
        return true;
    }
    if (!p->object.has_point || feature)
        return false;
    cg_tell_crs(p, p->object.point_srs);
    memcpy(lamp->xyz, p->object.point, sizeof(lamp->xyz));
    if (p->lat_first) {
        lamp->xyz[0] = p->object.point[1];
        lamp->xyz[1] = p->object.point[0];
    }
    return true;
}

/* ---- on its way to the sink ---- */

/* What the words of class, function, usage and name say of source and fixture counts like a column of them. */
static void read_lamp(cg_parser *p, uint32_t feature, lamp_tag *tags, size_t count, geo_lamp *lamp) {
    const cg_object *object = &p->object;
    const cg_feature *of = &object->features.data[feature];
    lamp->id = of->id;
    for (size_t i = 0; i < count; i++)
        lamp_keys_note(p->keys, &tags[i]);
    for (size_t i = of->first_attribute; i < of->end_attribute; i++)
        if (object->attributes.data[i].feature == feature && !object->attributes.data[i].generic)
            tags[count++] = (lamp_tag){ "fixture", object->attributes.data[i].value };
    lamp->xyz[2] = 0; /* no elevation: the geometry says where it is */
    if (!lamp_read(p->keys, tags, count, lamp, p->sink->issues))
        cg_no_memory(p);
    const char *function = feature ? NULL : cg_attribute_get(object, 0, "function");
    if (function && (!strcmp(function, "1220") || !strcmp(function, "1230")) && !object->other_function)
        lamp->type = GEO_LAMP_FLOOD;
}

/* Is the object gone by today (UTC)? Dates are "2019-05-31", and "2019-05-31T12:00:00". */
static bool is_gone(const cg_object *object, uint32_t feature) {
    static const char *const ends[] = { "terminationDate", "validTo" };
    char today[16];
    time_t now = time(NULL);
    struct tm utc;
    if (!gmtime_r(&now, &utc) || strftime(today, sizeof(today), "%Y-%m-%d", &utc) != 10)
        return false;
    for (size_t i = 0; i < NOC_COUNT(ends); i++) {
        const char *date = cg_attribute_get(object, feature, ends[i]);
        if (date && strlen(date) >= 10 && date[4] == '-' && date[7] == '-' && *date >= '0' && *date <= '9' &&
            strncmp(date, today, 10) < 0)
            return true;
    }
    return false;
}

/* Reads the feature as a lamp. False: it is none, or none that shines, and what there is of it is drawn. *gives_way:
 * its body would swallow its light. */
static bool make_lamp(cg_parser *p, uint32_t feature, geo_lamp *lamp, bool *gives_way) {
    cg_object *object = &p->object;
    const cg_feature *of = &object->features.data[feature];
    lamp_tag *tags = noc_calloc(of->attributes + 1, sizeof(*tags));
    if (!tags) {
        cg_no_memory(p);
        return false;
    }
    size_t count;
    bool sure = tags_of(p, feature, tags, &count), mine = is_lamp(p, feature, tags, count, sure);
    lamp_verdict verdict = mine ? lamp_verdict_of(p->keys, tags, count, true) : LAMP_NONE;
    *lamp = (geo_lamp){ .id = "" };
    *gives_way = false;
    if (verdict == LAMP_ACTIVE && is_gone(object, feature))
        verdict = LAMP_INACTIVE;
    if (mine && cg_in_turn(p)) {
        read_lamp(p, feature, tags, count, lamp);
        mine = place_by_body(p, feature, lamp, gives_way) || (!p->status && place_by_point(p, feature, lamp));
    }
    free(tags);
    return !p->status && mine && lamp_accept(verdict, of->id, p->sink->issues);
}

bool cg_emit_lamp(cg_parser *p) {
    cg_feature *object = &p->object.features.data[0];
    geo_lamp lamp;
    bool gives_way;
    if (!cg_may_be_lamp(object->type))
        return false;
    if (!make_lamp(p, 0, &lamp, &gives_way))
        return p->status != NOC_OK;
    object->function = NOC_CLASS_LAMP;
    if (lamp.body_heads)
        cg_emit_shown(p);
    else if (p->selection.shown)
        geo_issue(p->sink->issues, GEO_GUESSED,
                  "lamp whose body is a block around its light: a pole stands in its place", cg_report_id(p, NULL, 0));
    if (!p->status)
        cg_stop(p, p->sink->lamp(p->sink->ctx, &lamp));
    return true;
}

/* Progress is asked as the work goes on: one object may hold very many lamps. */
static bool goes_on(cg_parser *p) {
    if (p->status || ++p->looked < ASK)
        return !p->status;
    p->looked = 0;
    if (!p->sink->progress(p->sink->ctx, cg_progress(p)))
        cg_stop(p, NOC_ERR_CANCELLED);
    return !p->status;
}

void cg_emit_installed_lamps(cg_parser *p) {
    for (uint32_t f = 1; f < p->object.features.len && goes_on(p); f++) {
        geo_lamp lamp;
        bool gives_way;
        const cg_feature *of = &p->object.features.data[f];
        if (!of->attributes || !cg_may_be_lamp(of->type) || !make_lamp(p, f, &lamp, &gives_way))
            continue;
        const item_range range = items_of(p, f);
        for (size_t i = range.first; i < range.end && gives_way; i++)
            p->selection.items.data[i].shown = false;
        if (gives_way)
            geo_issue(p->sink->issues, GEO_GUESSED, "lamp whose body is a block around its light: a globe in its place",
                      cg_report_id(p, NULL, f));
        cg_stop(p, p->sink->lamp(p->sink->ctx, &lamp));
    }
}
