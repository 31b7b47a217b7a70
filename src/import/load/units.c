/* Heights of lamps that are hardly metres: no file says so; where lamps hang in their part of the world does. */
#include "import/load/load.h"

#include <math.h>

static int by_value(const void *a, const void *b) {
    float x = *(const float *)a, y = *(const float *)b;
    return x < y ? -1 : x > y;
}

/* Returns the unit, feet before all others, that brings the value between 2 m and `most`, next to 8 m; NULL: none. */
static const char *unit_for(double value, double most, double *factor) {
    static const double units[] = { 0.3048, 0.1, 0.01, 0.001 };
    const char *best = NULL;
    double nearest = INFINITY;
    for (size_t i = 0; i < NOC_COUNT(units); i++) {
        double x = value * units[i], off = fabs(log(x / 8));
        if (x < 2 || x > most || off >= nearest)
            continue;
        nearest = off;
        best = height_unit_name(units[i]);
        *factor = units[i];
        if (i == 0)
            break;
    }
    return best;
}

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

static const hanging *hanging_of(const input *in) {
    return &hangings[units_of_feet(in->lamp_given.source, in->lamp_given.xy)];
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
    array_free(&in->sizes);
    array_free(&in->feet);
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
    const char *unit = unit_for(middle, h->median, &factor), *column = height_column(&in->file);
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

noc_status units_check(importer *im) {
    for (size_t i = 0; i < im->input_count; i++)
        check_lamps(im, &im->inputs[i]);
    return units_check_buildings(im);
}
