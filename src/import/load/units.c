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

void units_check(importer *im) {
    judge(im, im->heights.data, im->heights.len, "height of a building", 8, 2, 60);
    judge(im, im->storeys.data, im->storeys.len, "height of a building's storey", 3.2, 1.8, 7);
}
