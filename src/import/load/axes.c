/* The order of axes of a city in degrees: both orders are places on Earth, and other inputs tell which one it is. */
#include "import/load/load.h"

#include <math.h>

#define APART 100.0 /* km: farther apart inputs are not of one city */
#define TOGETHER 20.0

/* By the great circle, on a sphere of the Earth's size. */
static double distance_km(const double a[2], const double b[2]) {
    const double degree = M_PI / 180;
    double dlat = (b[1] - a[1]) * degree / 2, dlon = (b[0] - a[0]) * degree / 2;
    double h = sin(dlat) * sin(dlat) + cos(a[1] * degree) * cos(b[1] * degree) * sin(dlon) * sin(dlon);
    return 2 * 6371 * asin(sqrt(fmin(h, 1)));
}

/* The middle of an input in degrees whose format has one order of axes, which tables have not. */
static bool middle_of(const importer *im, const input *in, double lonlat[2]) {
    noc_import_params params = *im->params;
    params.progress = (noc_progress){ 0 };
    params.strict = false;
    noc_report *report = NULL;
    noc_status status = noc_inspect(NULL, in->path, &params, &report);
    const noc_report_file *file = !status && noc_report_file_count(report) ? noc_report_get_file(report, 0) : NULL;
    bool known = file && file->has_extent && file->degrees && strcmp(file->format, "CSV");
    for (int k = 0; known && k < 2; k++)
        lonlat[k] = (file->extent_min[k] + file->extent_max[k]) / 2;
    noc_report_destroy(report);
    return known;
}

static bool find_elsewhere(importer *im, double lonlat[2]) {
    pthread_mutex_lock(&im->lock);
    for (size_t i = 0; i < im->input_count && !im->elsewhere.asked; i++) {
        const input *in = &im->inputs[i];
        if (in->reader && in->reader->reads == NOC_READS_LAMPS && !in->left_out)
            im->elsewhere.known = im->elsewhere.known || middle_of(im, in, im->elsewhere.lonlat);
    }
    im->elsewhere.asked = true;
    bool known = im->elsewhere.known;
    memcpy(lonlat, im->elsewhere.lonlat, sizeof(im->elsewhere.lonlat));
    pthread_mutex_unlock(&im->lock);
    return known;
}

bool axes_exchanged(importer *im, const input *in, geo_crs *crs, double x, double y) {
    double other[2], given[2], exchanged[2];
    return in->reader && in->reader->reads == NOC_READS_CITY && geo_crs_is_geographic(crs) && im->input_count > 1 &&
           fabs(x - y) > 1 && geo_crs_outside(crs, y, x) == 0 && find_elsewhere(im, other) &&
           geo_crs_lonlat_near(crs, x, y, given) && geo_crs_lonlat_near(crs, y, x, exchanged) &&
           distance_km(given, other) > APART && distance_km(exchanged, other) < TOGETHER;
}
