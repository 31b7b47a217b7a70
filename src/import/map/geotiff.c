/* Rasters as cloud optimized GeoTIFF. */
#include "import/map/made.h"

#include <math.h>
#include <nocturne/measure.h>

#if NOC_HAVE_GDAL

static bool fill_band(GDALDatasetH set, int band, const noc_raster *r, const char *what, const char *unit,
                      float *numbers) {
    GDALRasterBandH b = gdal.GDALGetRasterBand(set, band);
    gdal.GDALSetDescription(b, what);
    return b && !gdal.GDALSetRasterNoDataValue(b, NAN) && !gdal.GDALSetRasterUnitType(b, unit) &&
           !gdal.GDALRasterIO(b, GF_Write, 0, 0, r->width, r->height, numbers, r->width, r->height, GDT_Float32, 0, 0);
}

static bool describe(GDALDatasetH set, const noc_raster *r, const char *const (*items)[2]) {
    double place[6] = { r->west, r->step, 0, r->north, 0, -r->step };
    bool good = !gdal.GDALSetGeoTransform(set, place);
    if (good && r->wkt)
        good = !gdal.GDALSetProjection(set, r->wkt);
    for (; good && items && (*items)[0]; items++)
        good = !gdal.GDALSetMetadataItem(set, (*items)[0], (*items)[1], NULL);
    return good;
}

/* The raster in memory, as GDAL has it. NULL: it has said why. */
static GDALDatasetH as_dataset(const noc_raster *r, const char *const (*items)[2]) {
    GDALDriverH memory = gdal.GDALGetDriverByName("MEM");
    GDALDatasetH set = memory ? gdal.GDALCreate(memory, "", r->width, r->height, 3, GDT_Float32, NULL) : NULL;
    bool good = set && describe(set, r, items) && fill_band(set, 1, r, "illuminance", "lx", r->lux) &&
                fill_band(set, 2, r, "standard error", "lx", r->error) &&
                fill_band(set, 3, r, "share of the pixel that is ground", "", r->share);
    if (set && !good) {
        gdal.GDALClose(set);
        set = NULL;
    }
    return set;
}

/* A raster, and what its file tells beside. */
typedef struct told_raster {
    const noc_raster *r;
    const char *const (*items)[2];
} told_raster;

static bool make_file(const void *of, const char *name) {
    const told_raster *told = of;
    static const char *const options[] = { "COMPRESS=DEFLATE",   "PREDICTOR=FLOATING_POINT",
                                           "RESAMPLING=AVERAGE", "OVERVIEW_RESAMPLING=AVERAGE",
                                           "BIGTIFF=IF_SAFER",   NULL };
    GDALDriverH cog = gdal.GDALGetDriverByName("COG");
    GDALDatasetH set = cog ? as_dataset(told->r, told->items) : NULL;
    GDALDatasetH file =
        set ? gdal.GDALCreateCopy(cog, name, set, FALSE, (char **)(uintptr_t)options, NULL, NULL) : NULL;
    if (file)
        gdal.GDALClose(file);
    if (set)
        gdal.GDALClose(set);
    return file != NULL;
}

noc_status noc_raster_write(const noc_raster *r, const char *path, const char *const (*items)[2], noc_log *log) {
    /* all that is told goes into the file */
    static const map_made made = { "GeoTIFF", ".tif", "GDAL_PAM_ENABLED", "NO", make_file };
    if (!r || !path)
        return noc_null(log, __func__);
    const char *why = gdal_load();
    if (why)
        return noc_error(log, NOC_ERR_UNSUPPORTED, "%s: GeoTIFF is written by GDAL: %s", path, why);
    return map_write_made(&made, &(told_raster){ r, items }, path, log);
}

#else

noc_status noc_raster_write(const noc_raster *r, const char *path, const char *const (*items)[2], noc_log *log) {
    (void)items;
    return r && path ? noc_error(log, NOC_ERR_UNSUPPORTED, "%s: GeoTIFF is written by GDAL: %s", path, gdal_load())
                     : noc_null(log, __func__);
}

#endif
