/* The order of axes of inputs in degrees: both orders are places on Earth, so that all inputs together tell which one
 * it is. A look into each gives its place in either order, and whether its buildings are right or mirrored. The inputs
 * meet at the place that most of them can have; of several such at the one where more lie in the order of their CRS or
 * format, and buildings face outwards; at last at that of a city in its CRS's own order. */
#include "import/load/load.h"
#include "import/remote/remote.h"

#include <math.h>

#define APART 100.0   /* km: farther apart inputs are not of one city */
#define TOGETHER 20.0 /* that are exchanged must be nearer */
#define MOST_LOOKS 64 /* inputs of a kind that are looked into */
#define ENOUGH_OBJECTS 64
#define ENOUGH_POINTS 10000
#define POLAR 75.0 /* degrees; no city lies there */

/* Of a building: its faces' vector area, their area, volume (times 6) and bounds, m from its first point. */
typedef struct shape {
    bool any;
    double origin[3], sum[3], area, volume, lo[3], hi[3];
} shape;

typedef struct look {
    reading *asker;
    input *in;
    geo_crs *crs;
    bool refused, stopped; /* memory; the load is cancelled */
    bool in_object, sampled;
    bool passed; /* it is in a CRS behind the first that has points */
    shape shape;
    size_t outwards, inwards; /* buildings whose faces do so */
    size_t points;
    NOC_ARRAY(double) xy[2]; /* of objects */
    bool boxed;              /* nothing of it is read, and it lies there: */
    double box[2];
} look;

/* What an input tells. */
typedef struct witness {
    bool city, fixed;                 /* fixed: it has one order */
    double as_given[2], exchanged[2]; /* longitude, latitude */
    int faces;                        /* 1: its buildings face outwards as given; -1: only when exchanged; 0: unknown */
} witness;

/* By the great circle, on a sphere of the Earth's size. */
double place_distance_km(const double a[2], const double b[2]) {
    const double degree = M_PI / 180;
    double dlat = (b[1] - a[1]) * degree / 2, dlon = (b[0] - a[0]) * degree / 2;
    double h = sin(dlat) * sin(dlat) + cos(a[1] * degree) * cos(b[1] * degree) * sin(dlon) * sin(dlon);
    return 2 * 6371 * asin(sqrt(fmin(h, 1)));
}

/* ---- whether a building's faces are outside ---- */

static void add_corner(const look *l, const double *xyz, double p[3]) {
    const double metres = 111e3; /* of a degree */
    const double *o = l->shape.origin;
    p[0] = (xyz[0] - o[0]) * metres * cos(o[1] * M_PI / 180);
    p[1] = (xyz[1] - o[1]) * metres;
    p[2] = xyz[2] - o[2];
}

/* A triangle of a fan, whose first point is a. */
static void add_triangle(shape *s, const double a[3], const double b[3], const double c[3]) {
    double u[3], v[3], n[3];
    for (int k = 0; k < 3; k++) {
        u[k] = b[k] - a[k];
        v[k] = c[k] - a[k];
    }
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        n[k] = u[i] * v[j] - u[j] * v[i];
        s->sum[k] += n[k];
    }
    s->area += sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    s->volume += n[0] * a[0] + n[1] * a[1] + n[2] * a[2];
}

static void add_ring(look *l, const double *xyz, size_t count) {
    shape *s = &l->shape;
    double a[3] = { 0 }, b[3] = { 0 }, c[3];
    if (!s->any)
        memcpy(s->origin, xyz, sizeof(s->origin));
    for (size_t i = 0; i < count; i++) {
        add_corner(l, xyz + 3 * i, c);
        for (int k = 0; k < 3; k++) {
            s->lo[k] = s->any ? NOC_MIN(s->lo[k], c[k]) : c[k];
            s->hi[k] = s->any ? NOC_MAX(s->hi[k], c[k]) : c[k];
        }
        s->any = true;
        if (i == 0)
            memcpy(a, c, sizeof(a));
        if (i > 1)
            add_triangle(s, a, b, c);
        memcpy(b, c, sizeof(b));
    }
}

/* Only faces that close a space, all to one side of it, tell anything. */
static void end_building(look *l) {
    const shape *s = &l->shape;
    double open = sqrt(s->sum[0] * s->sum[0] + s->sum[1] * s->sum[1] + s->sum[2] * s->sum[2]);
    double box = (s->hi[0] - s->lo[0]) * (s->hi[1] - s->lo[1]) * (s->hi[2] - s->lo[2]);
    if (s->any && s->area > 0 && open < 0.02 * s->area && fabs(s->volume) > 0.6 * box) /* a tenth of the box */
        ++*(s->volume > 0 ? &l->outwards : &l->inwards);
    l->shape = (shape){ 0 };
}

/* ---- a look into an input ---- */

/* The CRS that the user gives, or the input names. NULL: local metres, or it is not understood. */
static geo_crs *crs_of(look *l, const char *srs_name) {
    const input *in = l->in;
    const importer *im = l->asker->im;
    bool taken = srs_name && *srs_name == GEO_CRS_TAKEN;
    const char *spelling = srs_name ? srs_name + taken : "";
    const char *given = given_crs_of(im, in);
    bool first = given && (in->crs || !*spelling || given_crs_replaces(im, in));
    noc_status status = NOC_OK;
    geo_crs *crs = first ? NULL : geo_crs_create_plain(spelling, in->path, NULL, &status);
    if (!crs && given && status != NOC_ERR_MEMORY)
        crs = geo_crs_create(given, in->path, NULL, &status);
    l->refused |= status == NOC_ERR_MEMORY;
    return crs;
}

static noc_status on_crs(void *ctx, const char *srs_name, const char *place, bool *lat_first) {
    look *l = ctx;
    (void)place;
    l->passed = l->xy[0].len > 0;
    if (!l->passed) {
        geo_crs_destroy(l->crs);
        l->crs = crs_of(l, srs_name);
    }
    if (lat_first)
        *lat_first = l->crs && geo_crs_is_geographic(l->crs) && geo_crs_lat_first(l->crs);
    return l->refused ? NOC_ERR_MEMORY : NOC_OK;
}

/* One place an object, as ahead.c has it. A city is left as soon as there are enough; of maps, of which the helper
 * tells the format at the end, no more are kept. */
static noc_status add_points(look *l, const double *xyz, size_t count) {
    double centre[3];
    bool city = l->in->reader->reads == NOC_READS_CITY, many = l->points > ENOUGH_POINTS;
    if (!l->crs && !l->passed) {
        noc_status status = on_crs(l, NULL, NULL, NULL);
        if (status)
            return status;
    }
    if (l->passed || !l->crs || (many && !city))
        return NOC_OK;
    if (!(l->in_object && l->sampled) && place_centre(xyz, count, centre)) {
        if (!array_push(&l->xy[0], centre[0]) || !array_push(&l->xy[1], centre[1])) {
            l->refused = true;
            return NOC_ERR_MEMORY;
        }
        l->sampled = true;
    }
    l->points += count;
    return city && (many || l->xy[0].len > ENOUGH_OBJECTS) ? NOC_ERR_CANCELLED : NOC_OK;
}

static noc_status on_begin_object(void *ctx, const geo_object *object) {
    look *l = ctx;
    (void)object;
    end_building(l);
    l->in_object = true;
    l->sampled = false;
    return NOC_OK;
}

static noc_status on_end_object(void *ctx) {
    look *l = ctx;
    end_building(l);
    l->in_object = false;
    return NOC_OK;
}

static noc_status on_polygon(void *ctx, const geo_polygon *polygon) {
    look *l = ctx;
    const double *xyz = polygon->xyz;
    for (size_t i = 0; i < polygon->ring_count && l->in_object; xyz += 3 * polygon->ring_size[i++])
        add_ring(l, xyz, polygon->ring_size[i]);
    return polygon->ring_count ? add_points(l, polygon->xyz, polygon->ring_size[0]) : NOC_OK;
}

static noc_status on_area(void *ctx, const geo_polygon *area) {
    return area->ring_count ? add_points(ctx, area->xyz, area->ring_size[0]) : NOC_OK;
}

static noc_status on_lamp(void *ctx, const geo_lamp *lamp) {
    look *l = ctx;
    return l->in->reader->reads == NOC_READS_CITY ? NOC_OK : add_points(l, lamp->xyz, 1);
}

static noc_status on_footprint(void *ctx, const geo_footprint *f) {
    return f->ring_count ? add_points(ctx, f->xyz, f->ring_size[0]) : NOC_OK;
}

static noc_status on_road(void *ctx, const geo_road *road) { return add_points(ctx, road->xyz, road->point_count); }

static noc_status on_track(void *ctx, const geo_track *track) {
    return track->part_count ? add_points(ctx, track->xyz, track->part_size[0]) : NOC_OK;
}

static noc_status on_features(void *ctx, const geo_features *f) {
    look *l = ctx;
    l->boxed = f->any;
    for (int k = 0; k < 2 && f->any; k++)
        l->box[k] = (f->lo[k] + f->hi[k]) / 2;
    return NOC_OK;
}

static bool on_progress(void *ctx, double done) {
    look *l = ctx;
    reading *r = l->asker;
    (void)done;
    l->stopped =
        l->stopped || !(r->queue ? queue_progress(r->queue, 0) : import_progress(r->im, r->in, r->im->bytes_before));
    return !l->stopped;
}

/* Errors are the real reading's to report. */
static noc_status read_look(look *l, const char **format, remote_result *result) {
    const importer *im = l->asker->im;
    input *in = l->in;
    noc_import_params params = *im->params;
    params.crs = given_crs_of(im, in);
    geo_issues *issues = geo_issues_create();
    noc_stream *stream = noc_stream_open(in->path, NULL, NULL);
    geo_sink sink = { .ctx = l,
                      .issues = issues,
                      .crs = on_crs,
                      .begin_object = on_begin_object,
                      .polygon = on_polygon,
                      .end_object = on_end_object,
                      .lamp = on_lamp,
                      .footprint = im->params->footprints ? on_footprint : NULL,
                      .road = roads_wanted(im) || in->named_tracks ? on_road : NULL,
                      .track = on_track,
                      .area = roads_wanted(im) ? on_area : NULL,
                      .features = on_features,
                      .progress = on_progress,
                      .named_lamps = in->named_lamps,
                      .named_tracks = in->named_tracks,
                      .given_metres = in->crs && !in->crs_degrees,
                      .given_degrees = in->crs && in->crs_degrees,
                      .inspect = true };
    noc_status status = issues ? NOC_OK : NOC_ERR_MEMORY;
    *format = in->reader->name;
    if (stream && !status) {
        noc_stream_limit(stream, im->params);
        status = in->remote
                     ? remote_read(in->reader, in->path, &params, &sink, NULL, noc_stream_listener(stream), result)
                     : in->reader->read(stream, &params, &sink, format);
    }
    end_building(l);
    l->refused |= status == NOC_ERR_MEMORY;
    noc_stream_close(stream);
    geo_issues_destroy(issues);
    return l->refused ? NOC_ERR_MEMORY : l->stopped ? NOC_ERR_CANCELLED : NOC_OK;
}

static int compare_doubles(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Of formats whose elements are called lat and lon. */
static bool names_both(const input *in, const char *format) {
    return in->reader->reads == NOC_READS_TRACKS || !strncmp(format, "OpenStreetMap", 13) ||
           !strncmp(format, "Overpass", 8);
}

/* Returns false if it tells nothing. */
static bool testify(look *l, witness *w) {
    double p[2];
    for (int k = 0; k < 2; k++) {
        size_t n = l->xy[k].len;
        if (n)
            qsort(l->xy[k].data, n, sizeof(double), compare_doubles);
        p[k] = n ? l->xy[k].data[(n - 1) / 2] : l->box[k];
    }
    if (!l->crs || (!l->xy[0].len && !l->boxed))
        return false;
    bool inside = geo_crs_outside(l->crs, p[0], p[1]) == 0, other = geo_crs_outside(l->crs, p[1], p[0]) == 0;
    *w = (witness){ .city = l->in->reader->reads == NOC_READS_CITY,
                    .fixed = !inside || !other || !geo_crs_is_geographic(l->crs) || l->in->one_order };
    if (inside && !geo_crs_lonlat_near(l->crs, p[0], p[1], w->as_given))
        return false;
    if (other && !geo_crs_lonlat_near(l->crs, p[1], p[0], inside ? w->exchanged : w->as_given))
        return false; /* which is the only way where the coordinates fit the CRS only so */
    size_t all = l->outwards + l->inwards, most = NOC_MAX(l->outwards, l->inwards);
    if (!w->fixed && all && 10 * most >= 9 * all)
        w->faces = l->outwards == most ? 1 : -1;
    return inside || other;
}

static noc_status look_into(reading *r, input *in, witness *w, bool *known) {
    look l = { .asker = r, .in = in };
    const char *format;
    remote_result result = { 0 };
    noc_status status = read_look(&l, &format, &result);
    format = *result.format ? result.format : format;
    in->one_order = names_both(in, format);
    *known = !status && testify(&l, w);
    geo_crs_destroy(l.crs);
    array_free(&l.xy[0]);
    array_free(&l.xy[1]);
    return status;
}

/* ---- where they meet ---- */

enum { NOT_THERE, AS_GIVEN, EXCHANGED };
static int way_to(const witness *w, const double place[2]) {
    if (place_distance_km(w->as_given, place) < APART)
        return AS_GIVEN;
    return !w->fixed && place_distance_km(w->exchanged, place) < TOGETHER ? EXCHANGED : NOT_THERE;
}

/* How many can be there, and how likely they are: each that is as given counts one, faces twice as much. Files of
 * cities have one maker, and count together as one. Returns whether one of them is there as it is given. */
static bool weigh(const witness *all, size_t count, const double place[2], size_t *there, double *likely) {
    size_t cities = 0;
    double as_given[2] = { 0 }, faces = 0; /* of others and of cities */
    *there = 0;
    for (size_t i = 0; i < count; i++) {
        int way = way_to(&all[i], place);
        cities += all[i].city;
        *there += way != NOT_THERE;
        as_given[all[i].city] += way == AS_GIVEN;
        faces += way == AS_GIVEN ? all[i].faces : way == EXCHANGED ? -all[i].faces : 0;
    }
    *likely = as_given[0] + (as_given[1] + 2 * faces) / (double)NOC_MAX(cities, 1) - (fabs(place[1]) > POLAR ? 3 : 0);
    return as_given[0] + as_given[1] > 0;
}

/* Places of cities as given come first, then of others, then exchanged ones: of equals the first is taken. */
static void choose(const witness *all, size_t count, meeting_place *place) {
    size_t most = 1;
    double likeliest = 0;
    for (int turn = 0; turn < 4; turn++)
        for (size_t i = 0; i < count; i++) {
            size_t there;
            double likely;
            const double *at = turn < 2 ? all[i].as_given : all[i].exchanged;
            if (all[i].city != (turn % 2 == 0) || (turn >= 2 && all[i].fixed) ||
                !weigh(all, count, at, &there, &likely) || there < 2)
                continue;
            if (there < most || (there == most && likely <= likeliest && place->known))
                continue;
            place->known = true;
            memcpy(place->lonlat, at, sizeof(place->lonlat));
            most = there;
            likeliest = likely;
        }
}

/* Of NOC_READS_CITY, LAMPS and TRACKS; -1: it tells nothing. */
static int kind_of(const input *in) {
    if (!in->reader || in->left_out || in->repeated)
        return -1;
    switch (in->reader->reads) {
    case NOC_READS_CITY: return 0;
    case NOC_READS_LAMPS: return 1;
    case NOC_READS_TRACKS: return 2;
    default: return -1;
    }
}

static noc_status find_place(reading *r) {
    importer *im = r->im;
    size_t inputs = 0;
    for (size_t i = 0; i < im->input_count; i++)
        inputs += kind_of(&im->inputs[i]) >= 0;
    if (inputs < 2)
        return NOC_OK;
    size_t most = NOC_MIN(im->input_count, 3 * MOST_LOOKS), looks[3] = { 0 }, count = 0;
    witness *all = noc_calloc(most + 1, sizeof(*all));
    noc_status status = all ? NOC_OK : noc_no_memory(r->log, r->in->path);
    for (size_t i = 0; i < im->input_count && !status; i++) {
        input *in = &im->inputs[i];
        int kind = kind_of(in);
        bool known = false;
        if (kind < 0)
            continue;
        in->one_order = kind > 0; /* until it is looked into */
        if (looks[kind]++ >= MOST_LOOKS)
            continue;
        status = look_into(r, in, &all[count], &known);
        count += known;
        if (status == NOC_ERR_MEMORY)
            noc_no_memory(r->log, in->path);
    }
    if (!status)
        choose(all, count, &im->meeting);
    im->meeting.asked = true;
    free(all);
    return status;
}

/* Where lamps lie with a city that is there already, no look is needed. */
static bool is_odd(const importer *im, const input *in, const double given[2], const double exchanged[2]) {
    double at[2];
    if (in->reader->reads == NOC_READS_CITY || !im->placed)
        return true;
    return im->scene_crs && geo_crs_lonlat_near(im->scene_crs, im->origin[0], im->origin[1], at) &&
           place_distance_km(given, at) > APART && place_distance_km(exchanged, at) < APART;
}

noc_status meeting_exchanges(reading *r, geo_crs *crs, double x, double y, bool *exchange) {
    importer *im = r->im;
    double given[2], exchanged[2];
    *exchange = false;
    bool reads = r->in->reader && (r->in->reader->reads == NOC_READS_CITY || r->in->reader->reads == NOC_READS_LAMPS);
    if (!reads || im->input_count < 2 || !geo_crs_is_geographic(crs) || fabs(x - y) <= 1 ||
        geo_crs_outside(crs, y, x) != 0 || !geo_crs_lonlat_near(crs, x, y, given) ||
        !geo_crs_lonlat_near(crs, y, x, exchanged))
        return NOC_OK;
    noc_status status = NOC_OK;
    pthread_mutex_lock(&im->lock);
    if (!im->meeting.asked && is_odd(im, r->in, given, exchanged))
        status = find_place(r);
    const meeting_place *m = &im->meeting;
    *exchange = !status && m->known && place_distance_km(given, m->lonlat) > APART &&
                place_distance_km(exchanged, m->lonlat) < TOGETHER && !r->in->one_order;
    pthread_mutex_unlock(&im->lock);
    return status;
}
