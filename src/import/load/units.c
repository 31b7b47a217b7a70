/* Heights that are hardly metres: feet are read as metres where a file names a CRS of metres, or none. No file says so;
 * the middle of many buildings does. */
#include "import/load/load.h"

#include <math.h>

#define FEWEST 10 /* buildings that are evidence */

static int by_value(const void *a, const void *b) {
    float x = *(const float *)a, y = *(const float *)b;
    return x < y ? -1 : x > y;
}

/* Feet where they bring a value between least and most, because whole countries measure in them; else the unit that
 * brings it next to what is usual; NULL where none brings it between. */
static const char *unit_for(double value, double usual, double least, double most, double *factor) {
    static const struct {
        const char *name;
        double metres;
    } units[] = { { "feet", 0.3048 },      { "decimetres", 0.1 },
                  { "centimetres", 0.01 }, { "millimetres", 0.001 },
                  { "kilometres", 1000 },  { "metres, converted as if they were feet", 1 / 0.3048 } };
    const char *best = NULL;
    double nearest = INFINITY;
    for (size_t i = 0; i < NOC_COUNT(units); i++) {
        double x = value * units[i].metres, off = fabs(log(x / usual));
        if (x < least || x > most || off >= nearest)
            continue;
        nearest = off;
        best = units[i].name;
        *factor = units[i].metres;
        if (i == 0)
            break;
    }
    return best;
}

static void judge(const importer *im, float *values, size_t count, const char *what, double usual, double least,
                  double most) {
    if (count < FEWEST)
        return;
    qsort(values, count, sizeof(*values), by_value);
    double median = (double)values[count / 2], factor;
    if (median >= least && median <= most)
        return;
    const char *unit = unit_for(median, usual, least, most, &factor);
    if (unit)
        noc_warn(
            im->log,
            "the median %s, of %zu, is %.3g m, which is hardly one: are heights in %s? Times %.5g it would be %.3g m",
            what, count, median, unit, factor, median * factor);
    else
        noc_warn(im->log, "the median %s, of %zu, is %.3g m, which is hardly one: in which unit are heights?", what,
                 count, median);
}

/* ---- lamps ---- */

/* Where street lamps hang, m: the median of a town's, and what nine in ten of them do not exceed. Main roads have lamps
 * at 10 m and more (road_lamps.c), highways of North America at 15 m and 50 ft, high masts are few. Where poles are
 * measured in feet a number over the former is sooner one of feet, and post tops hang at half of that. */
typedef struct hanging {
    double median, most, lantern;
    size_t fewest; /* lamps that are evidence */
    const char *where;
} hanging;
static const hanging hangings[] = {
    { 16, 25, INFINITY, 5, "street lamps" },
    { 13, 18, 8, 2, "street lamps of a land of feet" },
};

/* The United States and Canada, roughly: longitudes and latitudes. */
static bool measures_in_feet(const double lonlat[2]) {
    static const double boxes[][4] = {
        { -125, 32.5, -114, 49 }, { -114, 31.3, -106.5, 49 }, { -106.5, 29, -101, 49 },   { -101, 25.8, -97, 49 },
        { -97, 24.4, -80, 49 },   { -80, 28, -66, 49 },       { -141, 49, -52, 84 },      { -66, 43, -52, 49 },
        { -170, 51, -129, 72 },   { -161, 18.5, -154, 22.5 }, { -68, 17.5, -64.5, 18.6 },
    };
    for (size_t i = 0; i < NOC_COUNT(boxes); i++)
        if (lonlat[0] >= boxes[i][0] && lonlat[1] >= boxes[i][1] && lonlat[0] <= boxes[i][2] &&
            lonlat[1] <= boxes[i][3])
            return true;
    return false;
}

/* By the CRS of the file, whose unit may be the foot, or by where its first lamp stands. */
static const hanging *hanging_of(const input *in) {
    const source_crs *source = in->lamp_given.source;
    double lonlat[2];
    if (!source || !source->crs)
        return &hangings[0];
    bool feet = !geo_crs_is_geographic(source->crs) && !geo_crs_is_metric(source->crs);
    feet = feet || (geo_crs_lonlat_near(source->crs, in->lamp_given.xy[0], in->lamp_given.xy[1], lonlat) &&
                    measures_in_feet(lonlat));
    return &hangings[feet];
}

bool units_see_lamp(input *in, const pending_lamp *p) {
    float bare = (float)p->lamp.bare_height;
    if (!(bare > 0) || !isfinite(bare) || p->lamp.type == GEO_LAMP_FLOOD) /* masts of floodlights are high */
        return true;
    if (!in->lamp_heights.len)
        in->lamp_given = p->given;
    return array_push(&in->lamp_heights, bare) &&
           (p->lamp.type != GEO_LAMP_LANTERN || array_push(&in->lantern_heights, bare));
}

void units_forget(input *in) {
    array_free(&in->lamp_heights);
    array_free(&in->lantern_heights);
}

/* The column that most of the heights come from. */
static const char *height_column(const noc_report_file *file) {
    const noc_report_column *best = NULL;
    for (size_t i = 0; i < file->column_count; i++) {
        const noc_report_column *c = &file->columns[i];
        if (!strcmp(c->field, "height") && (!best || c->values > best->values))
            best = c;
    }
    return best ? best->name : "COLUMN";
}

/* Heights that no unit makes plausible are told of one by one. */
static void warn_of_lamps(importer *im, input *in, const hanging *h, const char *what, double value, double middle) {
    double factor;
    const char *unit = unit_for(middle, 8, 2, h->median, &factor), *column = height_column(&in->file);
    if (!unit)
        return;
    noc_warn(
        im->log,
        "%s: the %s, of %zu, is %.3g m, which is hardly where %s hang: are heights in %s? Times %.5g the median is "
        "%.3g m: --lamp-columns height_%s=%.60s says so, and height_m=%.60s that they are metres",
        in->path, what, in->lamp_heights.len, value, h->where, unit, factor, middle * factor,
        factor == .3048 ? "ft"
        : factor == .1  ? "dm"
        : factor == .01 ? "cm"
                        : "mm",
        column, column);
    geo_issues_add(in->issues, GEO_GUESSED, "height of a lamp without a unit, hardly in metres", in->lamp_heights.len,
                   "");
}

static double share_of(float *values, size_t count, double share) {
    return (double)values[(size_t)(share * (double)(count - 1) + .5)];
}

static void check_lamps(importer *im, input *in) {
    const hanging *h = hanging_of(in);
    size_t count = in->lamp_heights.len, lanterns = in->lantern_heights.len;
    float *heights = in->lamp_heights.data, *low = in->lantern_heights.data;
    if (count < h->fewest)
        return;
    qsort(heights, count, sizeof(*heights), by_value);
    double middle = share_of(heights, count, .5), high = share_of(heights, count, .9);
    if (middle > h->median)
        warn_of_lamps(im, in, h, "median height of a lamp", middle, middle);
    else if (high > h->most)
        warn_of_lamps(im, in, h, "height that nine in ten lamps do not exceed", high, middle);
    else if (lanterns >= h->fewest) {
        qsort(low, lanterns, sizeof(*low), by_value);
        double lantern = share_of(low, lanterns, .5);
        if (lantern > h->lantern)
            warn_of_lamps(im, in, h, "median height of a lantern", lantern, middle);
    }
}

void units_check(importer *im) {
    judge(im, im->heights.data, im->heights.len, "height of a building", 8, 2, 60);
    judge(im, im->storeys.data, im->storeys.len, "height of a building's storey", 3.2, 1.8, 7);
    for (size_t i = 0; i < im->input_count; i++)
        check_lamps(im, &im->inputs[i]);
}
