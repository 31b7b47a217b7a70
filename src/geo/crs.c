/* Coordinate reference systems and transforms: with crs_files.c and crs_kept.c the only PROJ calls of the library. */
#include "geo/crs_files.h"
#include "geo/crs_kept.h"
#include "geo/crs_spelling.h"
#include "geo/geo.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>

struct geo_crs {
    PJ_CONTEXT *context; /* one each: PROJ contexts are not thread-safe */
    bool strict;         /* it opens no files */
    char key[CRS_KEY];   /* what crs_kept knows it by */
    PJ *pj;              /* horizontal; a three-dimensional one is used as if at height 0 */
    PJ *to_wgs84;        /* made on first use of geo_crs_lonlat */
    enum { DEGREES_UNTOLD, DEGREES_OWN, DEGREES_NONE } degrees; /* told on first use of geo_crs_lonlat_near */
    PJ *to_degrees;                                             /* of its own datum; NULL: it is in them */
    bool degrees_lat_first;
    char *name, *definition;
    bool geographic, metric, lat_first;
    double height_unit; /* metres */
    bool height_named;  /* by a vertical part or a third axis */
    bool has_area;
    double west, south, east, north; /* area of use, degrees on WGS 84; west > east across the antimeridian */
};

/* ---- reading a definition ---- */

#define NO_DATABASE "PROJ finds no proj.db, its database: is PROJ_DATA right?"

static bool same_name(const char *a, const char *b) {
    for (;; a++, b++) {
        while (*a && !isalnum((unsigned char)*a))
            a++;
        while (*b && !isalnum((unsigned char)*b))
            b++;
        if (tolower((unsigned char)*a) != tolower((unsigned char)*b))
            return false;
        if (!*a)
            return true;
    }
}

/* WKT, PROJ strings, PROJJSON, and CRSs by their full name. PROJ also guesses from parts of names ("foo" gives
 * Amersfoort), so a name counts only if it is the name of what came out. */
static PJ *create_free_form(PJ_CONTEXT *context, const char *definition, bool *refused) {
    while (isspace((unsigned char)*definition))
        definition++;
    if (*definition == '+' && !strstr(definition, "+type=crs")) {
        char *text = noc_format("%s +type=crs", definition);
        PJ *pj = text ? proj.proj_create(context, text) : NULL;
        *refused = !text;
        free(text);
        return pj;
    }
    bool is_text = *definition == '+' || *definition == '{' || strchr(definition, '[') || strstr(definition, "+proj=");
    PJ *pj = proj.proj_create(context, definition);
    if (pj && !is_text && !same_name(proj.proj_get_name(pj), definition)) {
        proj.proj_destroy(pj);
        return NULL;
    }
    return pj;
}

static PJ *create_registered(PJ_CONTEXT *context, const char *name) {
    const char *colon = strchr(name, ':');
    char authority[sizeof((crs_spelling){ 0 }.horizontal)];
    noc_snprintf(authority, sizeof(authority), "%.*s", (int)(colon - name), name);
    PJ *pj = proj.proj_create_from_database(context, authority, colon + 1, PJ_CATEGORY_CRS, false, NULL);
    /* codes of ESRI are often given as if they were EPSG's */
    if (!pj && !strcmp(authority, "EPSG"))
        pj = proj.proj_create_from_database(context, "ESRI", colon + 1, PJ_CATEGORY_CRS, false, NULL);
    return pj;
}

static PJ *replace(PJ *old, PJ *new) {
    proj.proj_destroy(old);
    return new;
}

/* Metres of one unit of an axis; 0 where there is no such axis. */
static double axis_unit(PJ_CONTEXT *context, const PJ *crs, int axis) {
    double unit = 0;
    PJ *cs = proj.proj_crs_get_coordinate_system(context, crs);
    if (!cs || !proj.proj_cs_get_axis_info(context, cs, axis, NULL, NULL, NULL, &unit, NULL, NULL, NULL))
        unit = 0;
    proj.proj_destroy(cs);
    return unit;
}

/* Leaves the horizontal part of crs->pj; notes the unit of heights where a vertical part or a third axis names one. */
static void reduce_to_horizontal(geo_crs *crs) {
    PJ_CONTEXT *context = crs->context;
    if (crs->pj && proj.proj_get_type(crs->pj) == PJ_TYPE_COMPOUND_CRS) {
        PJ *vertical = proj.proj_crs_get_sub_crs(context, crs->pj, 1);
        if (vertical && proj.proj_get_type(vertical) == PJ_TYPE_BOUND_CRS)
            vertical = replace(vertical, proj.proj_get_source_crs(context, vertical));
        if (vertical)
            crs->height_unit = axis_unit(context, vertical, 0);
        proj.proj_destroy(vertical);
        crs->height_named = crs->height_unit > 0;
        crs->pj = replace(crs->pj, proj.proj_crs_get_sub_crs(context, crs->pj, 0));
    }
    if (!crs->pj)
        return;
    double third = axis_unit(context, crs->pj, 2);
    if (third > 0) {
        crs->height_unit = third;
        crs->height_named = true;
    }
}

static bool is_direction(const char *direction, const char *a, const char *b) {
    return noc_ieq(direction, a) || noc_ieq(direction, b);
}

/* Type, axes, units, area of use. False if it is not a CRS of the ground (geocentric, vertical, local). Without a name:
 * memory is refused. */
static bool inspect(geo_crs *crs) {
    PJ_CONTEXT *context = crs->context;
    const PJ *pj = crs->pj;
    PJ *source = NULL;
    if (proj.proj_get_type(pj) == PJ_TYPE_BOUND_CRS)
        pj = source = proj.proj_get_source_crs(context, pj);
    PJ_TYPE type = pj ? proj.proj_get_type(pj) : PJ_TYPE_UNKNOWN;
    crs->geographic = type == PJ_TYPE_GEOGRAPHIC_2D_CRS || type == PJ_TYPE_GEOGRAPHIC_3D_CRS;
    bool ok = crs->geographic || type == PJ_TYPE_PROJECTED_CRS;
    PJ *cs = ok ? proj.proj_crs_get_coordinate_system(context, pj) : NULL;
    const char *name0 = "", *direction0 = "", *direction1 = "";
    double unit0 = 0, unit1 = 0;
    ok = cs && proj.proj_cs_get_axis_info(context, cs, 0, &name0, NULL, &direction0, &unit0, NULL, NULL, NULL) &&
         proj.proj_cs_get_axis_info(context, cs, 1, NULL, NULL, &direction1, &unit1, NULL, NULL, NULL);
    if (ok) {
        bool polar = !is_direction(direction0, "east", "west") && !is_direction(direction1, "east", "west");
        crs->lat_first = polar ? !strncasecmp(name0, "northing", 8) : is_direction(direction0, "north", "south");
        crs->metric = !crs->geographic && unit0 == 1 && unit1 == 1 &&
                      noc_ieq(crs->lat_first ? direction0 : direction1, "north") &&
                      noc_ieq(crs->lat_first ? direction1 : direction0, "east");
        /* Where nothing is said about heights: a projected CRS in feet has its heights in feet too. */
        if (!(crs->height_unit > 0))
            crs->height_unit = crs->geographic ? 1 : unit0;
        crs->has_area =
            proj.proj_get_area_of_use(context, pj, &crs->west, &crs->south, &crs->east, &crs->north, NULL) &&
            crs->west > -1000; /* -1000: not known */
        const char *authority = proj.proj_get_id_auth_name(pj, 0), *code = proj.proj_get_id_code(pj, 0),
                   *name = proj.proj_get_name(pj);
        crs->name = authority && code ? noc_format("%s:%s (%s)", authority, code, name) : noc_strdup(name);
    }
    proj.proj_destroy(cs);
    proj.proj_destroy(source);
    return ok;
}

/* To a context that may open files. */
static bool make_free(geo_crs *crs) {
    PJ_CONTEXT *context = crs_context_take(false);
    if (!context)
        return false;
    PJ *moved = crs->pj ? proj.proj_clone(context, crs->pj) : NULL;
    proj.proj_destroy(crs->pj);
    crs_context_give(crs->context, true);
    crs->pj = moved;
    crs->context = context;
    crs->strict = false;
    return true;
}

static noc_status refuse(const char *definition, const char *what, const char *place, noc_log *log) {
    return noc_error(log, NOC_ERR_FORMAT, "%s%sthe CRS \"%.200s\" may open files (%s), which a file's CRS must not",
                     place, *place ? ": " : "", definition, what);
}

static noc_status no_memory(const char *definition, const char *place, noc_log *log) {
    return noc_error(log, NOC_ERR_MEMORY, "%s%sout of memory for the CRS \"%.200s\"", place, *place ? ": " : "",
                     definition);
}

static noc_status create(geo_crs *crs, const char *definition, bool strict, const char *place, noc_log *log) {
    const char *between = *place ? ": " : "";
    crs_spelling spelling;
    bool registered = crs_spelling_parse(definition, &spelling), refused = false;
    char what[40];
    const char *why_not = proj_load();
    if (why_not)
        return noc_error(log, NOC_ERR_UNSUPPORTED, "%s%sno CRS can be read: %s", place, between, why_not);
    if (!(crs->context = crs_context_take(strict)))
        return no_memory(definition, place, log);
    crs->strict = strict;
    if (!(crs->definition = noc_strdup(definition)))
        return no_memory(definition, place, log);
    if (registered || (strlen(definition) < sizeof(crs->key) && !crs_text_names_file(definition, what)))
        snprintf(crs->key, sizeof(crs->key), "%s", registered ? spelling.horizontal : definition);
    crs->pj = registered ? create_registered(crs->context, spelling.horizontal)
                         : create_free_form(crs->context, definition, &refused);
    if (refused)
        return no_memory(definition, place, log);
    if (!crs->pj && !proj.proj_context_get_database_metadata(crs->context, "EPSG.VERSION")) {
        proj.proj_context_destroy(crs->context); /* others may find it */
        crs->context = NULL;
        return noc_error(log, NOC_ERR_UNSUPPORTED, "%s%sno CRS can be read: " NO_DATABASE, place, between);
    }
    if (!crs->pj)
        return noc_error(log, NOC_ERR_FORMAT, "%s%sthe CRS \"%.200s\" is not understood%s%s", place, between,
                         definition, registered ? ": no registered " : "", registered ? spelling.horizontal : "");
    reduce_to_horizontal(crs);
    if (spelling.vertical[0]) {
        PJ *vertical = create_registered(crs->context, spelling.vertical);
        if (vertical && proj.proj_get_type(vertical) == PJ_TYPE_VERTICAL_CRS) {
            crs->height_unit = axis_unit(crs->context, vertical, 0);
            crs->height_named = crs->height_unit > 0;
        }
        proj.proj_destroy(vertical);
    }
    if (strict && crs->pj && crs_names_file(crs->context, crs->pj, what))
        return refuse(definition, what, place, log);
    if (strict && !make_free(crs)) /* it names no file: those that come now are of PROJ's own database */
        return no_memory(definition, place, log);
    if (!crs->pj || !inspect(crs))
        return noc_error(log, NOC_ERR_UNSUPPORTED, "%s%sthe CRS \"%.200s\" is neither geographic nor projected", place,
                         between, definition);
    return crs->name ? NOC_OK : no_memory(definition, place, log);
}

static geo_crs *create_crs(const char *definition, bool strict, const char *place, noc_log *log, noc_status *status) {
    geo_crs *crs = noc_calloc(1, sizeof(*crs));
    noc_status why = crs ? create(crs, definition, strict, place, log) : no_memory(definition, place, log);
    if (status)
        *status = why;
    if (why == NOC_OK)
        return crs;
    geo_crs_destroy(crs);
    return NULL;
}

geo_crs *geo_crs_create(const char *definition, const char *place, noc_log *log, noc_status *status) {
    return create_crs(definition, false, place ? place : "", log, status);
}

geo_crs *geo_crs_create_plain(const char *definition, const char *place, noc_log *log, noc_status *status) {
    char what[40];
    crs_spelling spelling;
    place = place ? place : "";
    if (crs_spelling_parse(definition, &spelling) || !crs_text_names_file(definition, what))
        return create_crs(definition, true, place, log, status);
    noc_status why = refuse(definition, what, place, log);
    if (status)
        *status = why;
    return NULL;
}

noc_status geo_crs_database(const char **why_not) {
    if ((*why_not = proj_load()))
        return NOC_ERR_UNSUPPORTED;
    PJ_CONTEXT *context = crs_context_take(true);
    if (!context)
        return NOC_ERR_MEMORY;
    bool found = proj.proj_context_get_database_metadata(context, "EPSG.VERSION") != NULL;
    if (found)
        crs_context_give(context, true);
    else
        proj.proj_context_destroy(context); /* others may find it */
    *why_not = NO_DATABASE;
    return found ? NOC_OK : NOC_ERR_UNSUPPORTED;
}

geo_crs *geo_crs_utm(double lon, double lat) {
    int zone = (int)NOC_CLAMP(floor((lon + 180) / 6) + 1, 1, 60);
    char text[24];
    snprintf(text, sizeof(text), "EPSG:%d", (lat < 0 ? 32700 : 32600) + zone);
    return geo_crs_create(text, NULL, NULL, NULL);
}

geo_crs *geo_crs_clone(const geo_crs *crs) {
    if (!crs)
        return NULL;
    geo_crs *copy = noc_alloc(sizeof(*copy));
    if (!copy)
        return NULL;
    *copy = *crs;
    copy->to_wgs84 = copy->to_degrees = NULL;
    copy->degrees = DEGREES_UNTOLD;
    copy->context = crs_context_take(false);
    copy->pj = copy->context ? proj.proj_clone(copy->context, crs->pj) : NULL;
    copy->name = noc_strdup(crs->name);
    copy->definition = noc_strdup(crs->definition);
    if (copy->pj && copy->name && copy->definition)
        return copy;
    geo_crs_destroy(copy);
    return NULL;
}

void geo_crs_destroy(geo_crs *crs) {
    if (!crs)
        return;
    if (crs->context) { /* else PROJ may not be loaded, and made nothing */
        proj.proj_destroy(crs->to_wgs84);
        proj.proj_destroy(crs->to_degrees);
        proj.proj_destroy(crs->pj);
        crs_context_give(crs->context, crs->strict);
    }
    free(crs->name);
    free(crs->definition);
    free(crs);
}

const char *geo_crs_name(const geo_crs *crs) { return crs ? crs->name : ""; }
const char *geo_crs_definition(const geo_crs *crs) { return crs->definition; }

char *geo_crs_wkt(const geo_crs *crs) {
    const char *wkt = proj.proj_as_wkt(crs->context, crs->pj, PJ_WKT2_2019, NULL);
    return wkt ? noc_strdup(wkt) : NULL;
}

bool geo_crs_is_geographic(const geo_crs *crs) { return crs->geographic; }
bool geo_crs_is_metric(const geo_crs *crs) { return crs->metric; }
bool geo_crs_lat_first(const geo_crs *crs) { return crs->lat_first; }

double geo_crs_height_unit(const geo_crs *crs, bool *named) {
    *named = crs->height_named;
    return crs->height_unit;
}

void geo_crs_set_height_unit(geo_crs *crs, double metres) { crs->height_unit = metres; }

bool geo_crs_equal(const geo_crs *a, const geo_crs *b) {
    return a && b && (a == b || proj.proj_is_equivalent_to_with_ctx(a->context, a->pj, b->pj, PJ_COMP_EQUIVALENT));
}

/* ---- area of use ---- */

#define FARTHEST_TURN 3600.0 /* degrees of longitude: ten times round, which no file means */

/* By a way to longitude and latitude, NULL where x and y are those. */
static bool take_way(const geo_crs *crs, PJ *way, bool lat_first, double x, double y, double lonlat[2]) {
    if (!isfinite(x) || !isfinite(y) || (crs->geographic && fabs(y) > 400))
        return false;
    PJ_COORD c = way ? proj.proj_coord(crs->lat_first ? y : x, crs->lat_first ? x : y, 0, HUGE_VAL)
                     : proj.proj_coord(x, y, 0, 0);
    if (way) {
        c = proj.proj_trans(way, PJ_FWD, c);
        proj.proj_errno_reset(way);
    }
    double lon = lat_first ? c.xy.y : c.xy.x, lat = lat_first ? c.xy.x : c.xy.y;
    if (!isfinite(lon) || fabs(lon) > FARTHEST_TURN || !isfinite(lat) || fabs(lat) > 90)
        return false;
    lonlat[0] = lon;
    lonlat[1] = lat;
    return true;
}

bool geo_crs_lonlat(geo_crs *crs, double x, double y, double lonlat[2]) {
    if (!crs->to_wgs84 && !(crs->to_wgs84 = crs_kept(crs->context, crs->key, "OGC:CRS84"))) {
        PJ *wgs84 = proj.proj_create(crs->context, "OGC:CRS84");
        crs->to_wgs84 = wgs84 ? proj.proj_create_crs_to_crs_from_pj(crs->context, crs->pj, wgs84, NULL, NULL) : NULL;
        proj.proj_destroy(wgs84);
        crs_keep(crs->to_wgs84, crs->key, "OGC:CRS84");
    }
    return crs->to_wgs84 && take_way(crs, crs->to_wgs84, false, x, y, lonlat);
}

/* Is this geographic CRS in degrees from Greenwich? */
static bool from_greenwich(PJ_CONTEXT *context, const PJ *geographic) {
    double longitude = NAN;
    PJ *meridian = proj.proj_get_prime_meridian(context, geographic);
    bool told = meridian && proj.proj_prime_meridian_get_parameters(context, meridian, &longitude, NULL, NULL);
    proj.proj_destroy(meridian);
    double unit = axis_unit(context, geographic, 0);
    return told && longitude == 0 && fabs(unit - M_PI / 180) < 1e-12;
}

static void find_degrees(geo_crs *crs) {
    PJ_CONTEXT *context = crs->context;
    bool plain = proj.proj_get_type(crs->pj) != PJ_TYPE_BOUND_CRS;
    PJ *own = plain ? proj.proj_crs_get_geodetic_crs(context, crs->pj) : NULL;
    PJ *cs = own ? proj.proj_crs_get_coordinate_system(context, own) : NULL;
    const char *direction = "";
    bool known = cs && proj.proj_cs_get_axis_info(context, cs, 0, NULL, NULL, &direction, NULL, NULL, NULL, NULL) &&
                 from_greenwich(context, own);
    if (known && !crs->geographic) {
        crs->degrees_lat_first = noc_ieq(direction, "north");
        crs->to_degrees = proj.proj_create_crs_to_crs_from_pj(context, crs->pj, own, NULL, NULL);
        known = crs->to_degrees != NULL;
    }
    crs->degrees = known ? DEGREES_OWN : DEGREES_NONE;
    proj.proj_destroy(cs);
    proj.proj_destroy(own);
}

/* In degrees of the CRS's own datum. PROJ searches its database for a way to another one, 4 to 40 ms. */
bool geo_crs_lonlat_near(geo_crs *crs, double x, double y, double lonlat[2]) {
    if (crs->degrees == DEGREES_UNTOLD)
        find_degrees(crs);
    return crs->degrees == DEGREES_OWN ? take_way(crs, crs->to_degrees, crs->degrees_lat_first, x, y, lonlat)
                                       : geo_crs_lonlat(crs, x, y, lonlat);
}

double geo_crs_outside(geo_crs *crs, double x, double y) {
    double p[2];
    if (!geo_crs_lonlat_near(crs, x, y, p))
        return INFINITY;
    if (!crs->has_area)
        return 0;
    double east = crs->east < crs->west ? crs->east + 360 : crs->east, lon = p[0];
    while (lon < crs->west - 180)
        lon += 360;
    double dx = NOC_MAX(crs->west - lon, lon - east);
    if (dx > 0) /* perhaps nearer the other way round */
        dx = NOC_MIN(dx, NOC_MAX(crs->west - (lon + 360), lon + 360 - east));
    double dy = NOC_MAX(crs->south - p[1], p[1] - crs->north);
    return NOC_MAX(NOC_MAX(dx, dy), 0);
}

/* Semi-axes in metres; false where they are not told. */
static bool ellipsoid(const geo_crs *crs, double *a, double *b) {
    PJ *pj = proj.proj_get_ellipsoid(crs->context, crs->pj);
    bool told = pj && proj.proj_ellipsoid_get_parameters(crs->context, pj, a, b, NULL, NULL) && *a > 0 && *b > 0;
    proj.proj_destroy(pj);
    return told;
}

/* By differences over some metres: PROJ's own factors take as long as a search of its database. The columns of way are
 * metres eastwards and northwards of the ground, a unit of x and of y. */
double geo_crs_scale(geo_crs *crs, double x, double y) {
    enum { STEP = 50 };
    double p[2], a, b, way[2][2];
    if (crs->geographic || !geo_crs_lonlat_near(crs, x, y, p) || !ellipsoid(crs, &a, &b))
        return NAN;
    double sine = sin(p[1] * M_PI / 180), e2 = 1 - b * b / (a * a), w = sqrt(1 - e2 * sine * sine);
    const double metres[2] = { a / w * cos(p[1] * M_PI / 180) * M_PI / 180, a * (1 - e2) / (w * w * w) * M_PI / 180 };
    for (int k = 0; k < 2; k++) {
        double from[2], to[2], dx = k ? 0 : STEP, dy = k ? STEP : 0;
        if (!geo_crs_lonlat_near(crs, x - dx, y - dy, from) || !geo_crs_lonlat_near(crs, x + dx, y + dy, to))
            return NAN;
        for (int i = 0; i < 2; i++)
            way[i][k] = remainder(to[i] - from[i], 360) * metres[i] / (2 * STEP);
    }
    double area = fabs(way[0][0] * way[1][1] - way[0][1] * way[1][0]);
    double parallel = hypot(way[1][0], way[1][1]) / area, meridian = hypot(way[0][0], way[0][1]) / area;
    if (!isfinite(parallel) || !isfinite(meridian))
        return NAN;
    return fabs(meridian - 1) > fabs(parallel - 1) ? meridian : parallel;
}

/* ---- transforms ---- */

struct geo_transform {
    PJ_CONTEXT *context;
    PJ *pj; /* NULL: identity */
    bool swap_from, swap_to;
    double height_scale;
    noc_log *log;
    char *names; /* for the message about accuracy; NULL once it was checked */
};

static noc_status make_transform(geo_transform *t, const geo_crs *from, const geo_crs *to, noc_log *log) {
    t->swap_from = from->lat_first;
    t->swap_to = to->lat_first;
    t->height_scale = from->height_unit / to->height_unit;
    if (geo_crs_equal(from, to))
        return NOC_OK;
    t->log = log;
    t->names = noc_format("%s to %s", from->name, to->name);
    t->context = crs_context_take(false);
    if (!t->names || !t->context)
        return noc_no_memory(log, "transformation");
    if (!(t->pj = crs_kept(t->context, from->key, to->key))) {
        t->pj = proj.proj_create_crs_to_crs_from_pj(t->context, from->pj, to->pj, NULL, NULL);
        crs_keep(t->pj, from->key, to->key);
    }
    return t->pj
               ? NOC_OK
               : noc_error(log, NOC_ERR_UNSUPPORTED, "no transformation is known from %s to %s", from->name, to->name);
}

geo_transform *geo_transform_create(const geo_crs *from, const geo_crs *to, noc_log *log, noc_status *status) {
    geo_transform *t = noc_calloc(1, sizeof(*t));
    noc_status why = t ? make_transform(t, from, to, log) : noc_no_memory(log, "transformation");
    if (status)
        *status = why;
    if (why == NOC_OK)
        return t;
    geo_transform_destroy(t);
    return NULL;
}

void geo_transform_destroy(geo_transform *t) {
    if (!t)
        return;
    if (t->context) {
        proj.proj_destroy(t->pj);
        crs_context_give(t->context, false);
    }
    free(t->names);
    free(t);
}

/* Where PROJ knows no path between two datums it takes them for one: that may be 100 m off, so it is said once. */
static void check_accuracy(geo_transform *t) {
    PJ *used = proj.proj_trans_get_last_used_operation(t->pj);
    if (!used)
        return;
    if (proj.proj_coordoperation_has_ballpark_transformation(t->context, used))
        noc_warn(t->log, "%s: no datum shift is known here, positions may be off by up to a few hundred metres",
                 t->names);
    proj.proj_destroy(used);
    free(t->names);
    t->names = NULL;
}

size_t geo_transform_points(geo_transform *t, double *xyz, size_t count) {
    if (t->height_scale != 1)
        for (size_t i = 0; i < count; i++)
            xyz[3 * i + 2] *= t->height_scale;
    size_t failed = 0;
    if (t->pj && count) {
        double *first = xyz + t->swap_from, *second = xyz + !t->swap_from;
        /* without z: it is the height's own business, and NaN there (a lamp on the ground) must not spoil x and y */
        proj.proj_trans_generic(t->pj, PJ_FWD, first, 3 * sizeof(double), count, second, 3 * sizeof(double), count,
                                NULL, 0, 0, NULL, 0, 0);
        proj.proj_errno_reset(t->pj);
    }
    for (size_t i = 0; i < count; i++) {
        double *p = xyz + 3 * i;
        if (!isfinite(p[0]) || !isfinite(p[1])) {
            p[0] = p[1] = p[2] = NAN;
            failed++;
        } else if (t->pj && t->swap_from != t->swap_to) {
            double x = p[0];
            p[0] = p[1];
            p[1] = x;
        }
    }
    if (t->names && failed < count)
        check_accuracy(t);
    return failed;
}
