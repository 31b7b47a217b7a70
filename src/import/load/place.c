/* Where the scene is: which CRS the coordinates of a file are in, which one the scene gets, and the way between. */
#include "import/load/load.h"

#include <ctype.h>
#include <math.h>

#define FAR_OUTSIDE 3.0   /* degrees outside the CRS's area of use that are worth a warning */
#define STRAY_METRES 20e3 /* a first object this far from the middle of the first ones does not settle the place */
#define STRAY_DEGREES 0.2
#define NOWHERE 1e8        /* m from the origin: farther than anything on Earth in any projection in use */
#define TRUE_SCALE 1e-3    /* lengths in the scene's CRS are those of the ground to within this share */
#define LOCAL_ORIGIN 100e3 /* m; local coordinates nearer to zero than this keep it as the origin */

static bool is_blank(const char *text) {
    while (text && isspace((unsigned char)*text))
        text++;
    return !text || !*text;
}

static source_crs *find_source(reading *r, const char *spelling, bool taken) {
    for (size_t i = 0; i < r->in->sources.len; i++)
        if (r->in->sources.data[i]->taken == taken && !strcmp(r->in->sources.data[i]->spelling, spelling))
            return r->in->sources.data[i];
    return NULL;
}

/* The CRS that `spelling` means for this run; *crs is NULL for local metres. */
static noc_status resolve(reading *r, const char *spelling, const char *place, geo_crs **crs) {
    *crs = NULL;
    const char *fallback = given_crs_of(r->im, r->in);
    noc_status status;
    if (*spelling) {
        *crs = geo_crs_create_plain(spelling, place, NULL, &status);
        if (*crs)
            return NOC_OK;
        if (status == NOC_ERR_MEMORY)
            return noc_no_memory(r->log, place);
        const char *why_not;
        status = geo_crs_database(&why_not);
        if (status == NOC_ERR_MEMORY)
            return noc_no_memory(r->log, place);
        if (status)
            return noc_error(r->log, status, "%s: the CRS \"%.60s\" cannot be read: %s", place, spelling, why_not);
        if (!fallback && ++r->in->strange_crs > MOST_STRANGE)
            return noc_error(r->log, NOC_ERR_FORMAT,
                             "%s: more than %d CRSs of the file are not understood, \"%.60s\" the last of them", place,
                             MOST_STRANGE, spelling);
        if (!fallback && !r->im->inspect)
            return noc_error(
                r->log, NOC_ERR_FORMAT,
                "%s: the CRS \"%.60s\" is not understood, opens files, or is neither geographic nor projected: say "
                "with --crs which one it is",
                place, spelling);
        noc_warn(r->log, "%s: the CRS \"%.60s\" is not understood: %s%s", place, spelling,
                 fallback ? "taken as " : "taken as local metres", fallback ? fallback : "");
    }
    if (!fallback)
        return NOC_OK;
    *crs = geo_crs_create(fallback, "--crs", r->log, &status);
    return given_status(status);
}

noc_status place_crs(reading *r, const char *srs_name, const char *place, bool *lat_first) {
    input *in = r->in;
    bool taken = srs_name && *srs_name == GEO_CRS_TAKEN;
    const char *spelling = is_blank(srs_name) ? "" : srs_name + taken;
    source_crs *source = find_source(r, spelling, taken);
    if (!source && r->side)
        return NOC_ERR_UNSUPPORTED; /* in its turn */
    if (!source) {
        geo_crs *crs, *named = NULL;
        noc_status status = in->crs ? given_crs_override(r, spelling, taken, place ? place : in->path, &crs)
                                    : resolve(r, spelling, place ? place : in->path, &crs);
        if (!status && !in->crs && *spelling && !taken)
            status = given_crs_replace(r, &crs, &named);
        if (status)
            return status;
        source = noc_calloc(1, sizeof(*source));
        char *kept = noc_strdup(spelling);
        if (!source || !kept || !array_push(&r->in->sources, source)) {
            free(source);
            free(kept);
            geo_crs_destroy(crs);
            geo_crs_destroy(named);
            return noc_no_memory(r->log, in->path);
        }
        *source = (source_crs){ .spelling = kept, .taken = taken, .crs = crs, .named = named };
        source->lat_first = crs && geo_crs_is_geographic(crs) && geo_crs_lat_first(crs);
        height_unit_settle(in, source);
    }
    r->source = source;
    if (lat_first)
        *lat_first = source->lat_first;
    return NOC_OK;
}

/* ---- the scene's place ---- */

/* The CRS the scene is asked to have, if any: by parameter, or set on the scene before. */
static noc_status wanted_crs(reading *r, geo_crs **crs) {
    *crs = NULL;
    bool by_parameter = !is_blank(r->im->params->scene_crs);
    const char *definition = by_parameter ? r->im->params->scene_crs : r->im->scene->crs_name;
    if (is_blank(definition) || r->im->inspect)
        return NOC_OK;
    noc_status status;
    *crs = geo_crs_create(definition, by_parameter ? "--scene-crs" : "scene", r->log, &status);
    if (!*crs)
        return given_status(status);
    if (geo_crs_is_metric(*crs))
        return NOC_OK;
    noc_error(r->log, NOC_ERR_ARGUMENT, "%s: a scene's CRS must be projected, in metres", geo_crs_name(*crs));
    geo_crs_destroy(*crs);
    *crs = NULL;
    return NOC_ERR_ARGUMENT;
}

/* Takes the crs. */
static noc_status set_place(reading *r, geo_crs *crs, const double origin[3]) {
    r->im->placed = true;
    r->im->placed_by = r->in->path;
    r->im->scene_crs = crs;
    if (crs)
        geo_crs_set_height_unit(crs, 1); /* whatever that of the first input is */
    memcpy(r->im->origin, origin, sizeof(r->im->origin));
    noc_scene_set_crs(r->im->scene, crs ? geo_crs_name(crs) : NULL, r->im->origin);
    free(r->im->scene->without_crs);
    r->im->scene->without_crs = crs ? NULL : noc_strdup(r->im->placed_by);
    if (r->im->scene->crs && r->im->scene->crs_free)
        r->im->scene->crs_free(r->im->scene->crs);
    r->im->scene->crs = crs;
    r->im->scene->crs_free = geo_crs_destroy;
    if (r->im->scene->no_memory)
        return NOC_ERR_MEMORY; /* said by the scene */
    return crs || r->im->scene->without_crs ? NOC_OK : noc_no_memory(r->log, r->im->placed_by);
}

/* Lengths must be those of the ground: light falls with their square. Where *crs has others at a point (Web Mercator, a
 * zone far away), the scene gets the UTM zone of that place instead, and *given what it would have had. */
static noc_status make_metres_true(reading *r, geo_crs **crs, double p[3], geo_crs **given) {
    const char *path = r->in->path;
    double scale = geo_crs_scale(*crs, p[0], p[1]), lonlat[2];
    *given = NULL;
    if (!(fabs(scale - 1) > TRUE_SCALE) || !geo_crs_lonlat_near(*crs, p[0], p[1], lonlat))
        return NOC_OK;
    noc_status status = NOC_OK;
    geo_crs *local = geo_crs_utm(lonlat[0], lonlat[1]);
    geo_transform *t = local ? geo_transform_create(*crs, local, r->log, &status) : NULL;
    bool ok = t && !geo_transform_points(t, p, 1);
    geo_transform_destroy(t);
    if (!ok) {
        bool refused = !local || status == NOC_ERR_MEMORY;
        geo_crs_destroy(local);
        return refused ? (status ? status : noc_no_memory(r->log, path))
                       : noc_error(r->log, NOC_ERR_FORMAT,
                                   "%s: 100 m of %s are %.1f m on the ground there, and no local CRS was found", path,
                                   geo_crs_name(*crs), 100 / scale);
    }
    if (!r->im->inspect)
        noc_warn(r->log, "%s: 100 m of %s are %.1f m on the ground there: the scene is computed in %s", path,
                 geo_crs_name(*crs), 100 / scale, geo_crs_name(local));
    *given = *crs;
    *crs = local;
    return NOC_OK;
}

/* Keeps the CRS that the user speaks, and where the scene's origin lies in it. */
static noc_status set_given(reading *r, geo_crs *given) {
    noc_scene *scene = r->im->scene;
    noc_status status;
    geo_transform *t = geo_transform_create(scene->crs, given, r->log, &status);
    double origin[3] = { r->im->origin[0], r->im->origin[1], 0 };
    if (t && geo_transform_points(t, origin, 1))
        status = NOC_ERR_UNSUPPORTED;
    geo_transform_destroy(t);
    char *name = status ? NULL : noc_strdup(geo_crs_name(given));
    if (!status && !name)
        status = noc_no_memory(r->log, r->im->placed_by);
    if (status) {
        geo_crs_destroy(given);
        return status;
    }
    if (scene->given_crs)
        scene->crs_free(scene->given_crs);
    free(scene->given_crs_name);
    scene->given_crs = given;
    scene->given_crs_name = name;
    memcpy(scene->given_origin, origin, sizeof(origin));
    return NOC_OK;
}

/* Settles CRS and origin by a point, given in their own CRS. Heights stay what they are: z has no origin. */
static noc_status settle(reading *r, const source_crs *source, const double point[3]) {
    geo_crs *crs;
    bool preset = r->im->scene->crs_name && is_blank(r->im->params->scene_crs) && !r->im->inspect;
    noc_status status = wanted_crs(r, &crs);
    if (status)
        return status;
    if (!source->crs) {
        if (crs) {
            geo_crs_destroy(crs);
            return noc_error(r->log, NOC_ERR_ARGUMENT, "%s names no CRS: say with --crs which one it is in",
                             r->in->path);
        }
        bool near_zero = fabs(point[0]) < LOCAL_ORIGIN && fabs(point[1]) < LOCAL_ORIGIN;
        return set_place(r, NULL, (double[3]){ near_zero ? 0 : round(point[0]), near_zero ? 0 : round(point[1]), 0 });
    }
    double lonlat[2], p[3] = { point[0], point[1], 0 };
    bool metric = geo_crs_is_metric(source->crs),
         made = !crs && (metric || geo_crs_lonlat_near(source->crs, point[0], point[1], lonlat));
    if (made)
        crs = metric ? geo_crs_clone(source->crs) : geo_crs_utm(lonlat[0], lonlat[1]);
    if (made && !crs)
        return noc_no_memory(r->log, r->in->path);
    geo_transform *t = crs ? geo_transform_create(source->crs, crs, r->log, &status) : NULL;
    bool ok = t && !geo_transform_points(t, p, 1);
    geo_transform_destroy(t);
    if (status == NOC_ERR_MEMORY) {
        geo_crs_destroy(crs);
        return status;
    }
    if (!ok) {
        geo_crs_destroy(crs);
        return noc_error(r->log, NOC_ERR_FORMAT, "%s: the first coordinates (%.10g %.10g) have no place in %s",
                         r->in->path, point[0], point[1], geo_crs_name(source->crs));
    }
    double outside = preset || is_blank(r->im->params->scene_crs) ? 0 : geo_crs_outside(crs, p[0], p[1]);
    if (outside > FAR_OUTSIDE)
        noc_warn(r->log, "%s: the coordinates lie far outside the area that --scene-crs %s is for", r->in->path,
                 geo_crs_name(crs));
    geo_crs *given = NULL;
    if (!preset) /* else meshes may be there already, in metres of the CRS that was set */
        status = make_metres_true(r, &crs, p, &given);
    if (status) {
        geo_crs_destroy(crs);
        return status;
    }
    status = set_place(r, crs, preset ? r->im->scene->origin : (double[3]){ round(p[0]), round(p[1]), 0 });
    if (status)
        geo_crs_destroy(given);
    return status || !given ? status : set_given(r, given);
}

static noc_status prepare_alone(reading *r, source_crs *s, const double point[3]) {
    const char *path = r->in->path;
    if (!r->im->placed) {
        noc_status status = settle(r, s, point);
        if (status)
            return status;
    }
    if (!s->crs && r->im->scene_crs && *s->spelling)
        return noc_error(r->log, NOC_ERR_FORMAT,
                         "%s: the CRS \"%.60s\" is not understood, and %s has another (%s): say with --crs which one "
                         "it is",
                         path, s->spelling, r->im->placed_by, geo_crs_name(r->im->scene_crs));
    if (!s->crs && r->im->scene_crs)
        return noc_error(r->log, NOC_ERR_FORMAT, "%s names no CRS, but %s does (%s): say with --crs which one it is in",
                         path, r->im->placed_by, geo_crs_name(r->im->scene_crs));
    if (s->crs && !r->im->scene_crs)
        return noc_error(r->log, NOC_ERR_FORMAT, "%s names no CRS, but %s does (%s): say with --crs which one it is in",
                         r->im->placed_by, path, geo_crs_name(s->crs));
    if (s->crs) {
        noc_status status;
        s->to_scene = geo_transform_create(s->crs, r->im->scene_crs, r->log, &status);
        if (!s->to_scene)
            return status;
    }
    s->ready = true;
    given_crs_replaced(r, s, point);
    noc_report_file *file = &r->in->file;
    const char *name = s->crs ? geo_crs_name(s->crs) : "";
    s->further = file->crs && strcmp(file->crs, name);
    if (s->further)
        geo_issue(r->in->issues, GEO_REPAIRED, "CRS beside another in one file: each place is taken by its own", name);
    if (!file->crs) {
        file->crs = s->crs ? arena_strdup(&r->im->report->arena, name) : "";
        file->degrees = s->crs && geo_crs_is_geographic(s->crs);
        file->crs_given = arena_strdup(&r->im->report->arena, s->taken ? "" : s->spelling);
        file->crs_overridden = r->in->crs || s->replaced;
        file->crs_taken = s->taken && s->crs && !r->in->crs;
        bool heights = r->in->reader && r->in->reader->reads != NOC_READS_MESH;
        file->height_unit = heights ? s->unit : 0;
        file->height_unit_by = heights ? s->unit_by : "";
    }
    return r->im->report->arena.refused ? noc_no_memory(r->log, path) : NOC_OK;
}

/* Makes the way from the source to the scene, once. */
static noc_status prepare(reading *r, source_crs *s, const double point[3]) {
    pthread_mutex_lock(&r->im->lock);
    noc_status status = prepare_alone(r, s, point);
    pthread_mutex_unlock(&r->im->lock);
    return status;
}

/* Bounds of the finite coordinates; heights may have none (lo > hi). False if no place at all is finite. */
static bool bounds_of(const double *xyz, size_t count, double lo[3], double hi[3]) {
    for (int k = 0; k < 3; k++) {
        lo[k] = INFINITY;
        hi[k] = -INFINITY;
    }
    for (size_t i = 0; i < 3 * count; i++)
        if (isfinite(xyz[i])) {
            lo[i % 3] = NOC_MIN(lo[i % 3], xyz[i]);
            hi[i % 3] = NOC_MAX(hi[i % 3], xyz[i]);
        }
    return lo[0] <= hi[0] && lo[1] <= hi[1];
}

static void centre_of(const double lo[3], const double hi[3], double centre[3]) {
    for (int k = 0; k < 3; k++)
        centre[k] = lo[k] <= hi[k] ? lo[k] + (hi[k] - lo[k]) / 2 : 0;
}

bool place_centre(const double *xyz, size_t count, double centre[3]) {
    double lo[3], hi[3];
    bool any = bounds_of(xyz, count, lo, hi);
    if (any)
        centre_of(lo, hi, centre);
    return any;
}

static void widen_extent(noc_report_file *file, const double lo[3], const double hi[3]) {
    bool has_height = lo[2] <= hi[2]; /* lamps may have none */
    for (int k = 0; k < 3; k++) {
        double a = lo[k], b = hi[k];
        if (k == 2 && !has_height)
            a = b = file->has_extent ? file->extent_min[2] : 0;
        file->extent_min[k] = file->has_extent ? NOC_MIN(file->extent_min[k], a) : a;
        file->extent_max[k] = file->has_extent ? NOC_MAX(file->extent_max[k], b) : b;
    }
    file->has_extent = true;
}

static int compare_doubles(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The CRS that most samples are in, the earlier one of equals. */
static source_crs *commonest_source(const place_sample *samples, size_t count) {
    source_crs *best = NULL;
    size_t most = 0;
    for (size_t i = 0; i < count; i++) {
        size_t n = 0;
        for (size_t j = 0; j < count; j++)
            n += samples[j].source == samples[i].source;
        if (n > most) {
            most = n;
            best = samples[i].source;
        }
    }
    return best;
}

noc_status place_settle(reading *r, const place_sample *samples, size_t count) {
    if (!count)
        return NOC_OK;
    source_crs *s = commonest_source(samples, count);
    double *both = noc_alloc(2 * count * sizeof(double));
    if (!both)
        return noc_no_memory(r->log, r->in->path);
    double *const axis[2] = { both, both + count };
    double first[3] = { 0 }, point[3] = { 0 };
    size_t n = 0, in_area = 0;
    noc_status status = NOC_OK;
    for (int pass = 0; pass < 3; pass++) /* decides about the axes; counts; takes */
        for (size_t i = 0; i < count && !status; i++) {
            double p[3];
            memcpy(p, samples[i].xyz, sizeof(p));
            status = axes_fix(r, samples[i].source, p, 1, samples[i].id);
            if (pass == 0 || samples[i].source != s)
                continue;
            bool inside = s->crs && geo_crs_outside(s->crs, p[0], p[1]) <= FAR_OUTSIDE;
            in_area += pass == 1 && inside;
            if (pass == 1 || (in_area && !inside)) /* what lies where the CRS is not for, only if all does */
                continue;
            if (n == 0)
                memcpy(first, p, sizeof(p));
            axis[0][n] = p[0];
            axis[1][n++] = p[1];
        }
    for (int k = 0; k < 2 && n; k++) {
        qsort(axis[k], n, sizeof(double), compare_doubles);
        point[k] = axis[k][(n - 1) / 2];
    }
    free(both);
    if (status)
        return status;
    double stray = s->crs && geo_crs_is_geographic(s->crs) ? STRAY_DEGREES : STRAY_METRES;
    bool by_first = fabs(first[0] - point[0]) <= stray && fabs(first[1] - point[1]) <= stray;
    return prepare(r, s, by_first ? first : point);
}

noc_status place_points(reading *r, double *xyz, size_t count, const char *id, bool *usable) {
    *usable = false;
    input *in = r->in;
    if (!r->source) {
        noc_status status = place_crs(r, NULL, in->path, NULL);
        if (status)
            return status;
    }
    source_crs *s = r->source;
    double lo[3], hi[3], centre[3];
    noc_status fixed = axes_fix(r, s, xyz, count, id);
    r->given.len = 0;
    if (fixed)
        return fixed;
    if (!bounds_of(xyz, count, lo, hi)) {
        geo_issue(in->issues, GEO_SKIPPED, "coordinates that are not finite", id);
        return NOC_OK;
    }
    centre_of(lo, hi, centre);
    if (r->side && lo[2] > hi[2])
        return NOC_ERR_UNSUPPORTED; /* what it does to the extent depends on what was before */
    if (!s->ready) {
        noc_status status = prepare(r, s, centre);
        if (status)
            return status;
    }
    size_t numbers = 3 * count;
    if (!array_append(&r->given, xyz, numbers))
        return noc_no_memory(r->log, in->path);
    size_t astray = 0, failed = 0;
    for (size_t i = 0; i < count && !s->crs && s->unit != 1; i++)
        xyz[3 * i + 2] *= s->unit;
    if (s->to_scene)
        failed = geo_transform_points(s->to_scene, xyz, count);
    for (size_t i = 0; i < numbers; i++)
        if (isfinite(xyz[i]) && !(fabs(xyz[i] - r->im->origin[i % 3]) < NOWHERE)) {
            xyz[i] = NAN;
            astray++;
        }
    if (failed || astray) {
        geo_issue(in->issues, GEO_SKIPPED,
                  failed ? "coordinates that have no place in the scene's CRS"
                         : "coordinates that lie nowhere on Earth",
                  id);
        return NOC_OK;
    }
    for (size_t i = 0; i < 3 * count; i++)
        xyz[i] -= r->im->origin[i % 3];
    if (!s->further)
        widen_extent(&in->file, lo, hi);
    *usable = true;
    return NOC_OK;
}

bool place_exchanged(importer *im, const given_place *given, double xy[2]) {
    double p[3] = { given->xy[1], given->xy[0], 0 };
    const source_crs *s = given->source;
    if (s->crs && (!s->to_scene || geo_transform_points(s->to_scene, p, 1)))
        return false;
    for (int k = 0; k < 2; k++)
        xy[k] = p[k] - im->origin[k];
    return isfinite(xy[0]) && isfinite(xy[1]);
}

/* A mesh whose coordinates count from the scene's origin may be the first input, or the only one. */
static noc_status settle_by_scene(reading *r) {
    geo_crs *crs;
    bool preset = r->im->scene->crs_name && is_blank(r->im->params->scene_crs) && !r->im->inspect;
    noc_status status = wanted_crs(r, &crs);
    return !status && crs ? set_place(r, crs, preset ? r->im->scene->origin : (double[3]){ 0, 0, 0 }) : status;
}

noc_status place_mesh(reading *r) {
    const char *path = r->in->path;
    r->source = NULL;
    r->mesh_from_origin = false;
    const char *given = given_crs_of(r->im, r->in), *option = r->in->crs ? "--file-crs" : "--crs";
    if (given) {
        noc_status status;
        geo_crs *crs = geo_crs_create(given, option, r->log, &status);
        bool metric = crs && geo_crs_is_metric(crs);
        geo_crs_destroy(crs);
        if (status)
            return given_status(status);
        if (metric)
            return NOC_OK;
        return noc_error(r->log, NOC_ERR_ARGUMENT, "%s %s: %s is in metres, so its CRS must be projected, in metres",
                         option, given, path);
    }
    if (!r->im->placed) {
        noc_status status = settle_by_scene(r);
        if (status)
            return status;
    }
    r->mesh_from_origin = r->im->placed && r->im->scene_crs;
    if (r->mesh_from_origin)
        noc_info(r->log, "%s: coordinates are taken as metres from the scene's origin (%.0f %.0f)", path,
                 r->im->origin[0], r->im->origin[1]);
    return NOC_OK;
}

noc_status place_mesh_points(void *ctx, double *xyz, size_t count) {
    reading *r = ctx;
    bool usable;
    noc_status status = take_affords(r->im, r->in, 3 * count * sizeof(float));
    if (status)
        return status;
    if (r->mesh_from_origin) {
        double lo[3], hi[3];
        if (bounds_of(xyz, count, lo, hi))
            widen_extent(&r->in->file, lo, hi);
        return NOC_OK;
    }
    status = place_points(r, xyz, count, "", &usable);
    if (status || usable)
        return status;
    /* what has no place is NaN: the scene leaves out its triangles alone */
    for (size_t i = 0; i < 3 * count; i++) {
        xyz[i] -= r->im->origin[i % 3];
        if (i < r->given.len && !isfinite(xyz[i]))
            r->given.data[i] = NAN;
    }
    double lo[3], hi[3];
    if (r->given.len == 3 * count && bounds_of(r->given.data, count, lo, hi))
        widen_extent(&r->in->file, lo, hi);
    return NOC_OK;
}

void place_finish_file(reading *r, bool read) {
    r->source = NULL;
    for (size_t i = 0; i < r->in->sources.len; i++) {
        const source_crs *s = r->in->sources.data[i];
        if (read && axes_doubtful(s) && s->outside > FAR_OUTSIDE)
            noc_warn(r->log, "%s: the coordinates lie far outside the area that %s is for: is it the right CRS?%s",
                     r->in->path, geo_crs_name(s->crs),
                     s->opposite
                         ? " With the other sign they fit: what is counted southwards and westwards has a CRS of "
                           "its own, which for S-JTSK is EPSG:5513"
                         : "");
    }
}

void place_forget(input *in) {
    for (size_t i = 0; i < in->sources.len; i++) {
        source_crs *s = in->sources.data[i];
        geo_transform_destroy(s->to_scene);
        geo_crs_destroy(s->crs);
        geo_crs_destroy(s->named);
        free(s->spelling);
        free(s);
    }
    array_free(&in->sources);
}
