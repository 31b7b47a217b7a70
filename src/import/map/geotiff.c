/* Rasters as cloud optimized GeoTIFF: GDAL makes the file in memory, from where it is written as all outputs are. */
#include "base/output.h"
#include "import/map/gdal.h"
#include "noc_config.h"

#include <math.h>
#include <nocturne/measure.h>
#include <stdatomic.h>
#include <stdio.h>

#if NOC_HAVE_GDAL

/* What GDAL says of a failure. */
typedef struct complaint {
    char text[200];
} complaint;

static void CPL_STDCALL on_error(CPLErr level, CPLErrorNum code, const char *text) {
    complaint *c = gdal.CPLGetErrorHandlerUserData();
    if (level >= CE_Failure && !*c->text)
        noc_snprintf(c->text, sizeof(c->text), "%s", text);
    (void)code;
}

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

static bool make_file(const noc_raster *r, const char *const (*items)[2], const char *name) {
    static const char *const options[] = { "COMPRESS=DEFLATE",   "PREDICTOR=FLOATING_POINT",
                                           "RESAMPLING=AVERAGE", "OVERVIEW_RESAMPLING=AVERAGE",
                                           "BIGTIFF=IF_SAFER",   NULL };
    GDALDriverH cog = gdal.GDALGetDriverByName("COG");
    GDALDatasetH set = cog ? as_dataset(r, items) : NULL;
    GDALDatasetH file =
        set ? gdal.GDALCreateCopy(cog, name, set, FALSE, (char **)(uintptr_t)options, NULL, NULL) : NULL;
    if (file)
        gdal.GDALClose(file);
    if (set)
        gdal.GDALClose(set);
    return file != NULL;
}

static noc_status write_out(const char *name, const char *path, noc_log *log) {
    vsi_l_offset size = 0;
    const GByte *bytes = gdal.VSIGetMemFileBuffer(name, &size, FALSE);
    output o;
    noc_status status = bytes ? output_open(&o, path, log) : noc_no_memory(log, "measure");
    if (status != NOC_OK)
        return status;
    bool written = fwrite(bytes, 1, size, o.file) == size;
    return output_close(&o, written ? NOC_OK : output_failed(&o, log), log);
}

noc_status noc_raster_write(const noc_raster *r, const char *path, const char *const (*items)[2], noc_log *log) {
    static atomic_uint number;
    if (!r || !path)
        return noc_null(log, __func__);
    const char *why = gdal_load();
    if (why)
        return noc_error(log, NOC_ERR_UNSUPPORTED, "%s: GeoTIFF is written by GDAL: %s", path, why);
    char name[64];
    complaint said = { "" };
    noc_snprintf(name, sizeof(name), "/vsimem/nocturne/raster%u.tif", atomic_fetch_add(&number, 1));
    gdal.OGRRegisterAll();
    gdal.CPLPushErrorHandlerEx(on_error, &said);
    gdal.CPLSetThreadLocalConfigOption("GDAL_PAM_ENABLED", "NO"); /* all that is told goes into the file */
    bool made = make_file(r, items, name);
    noc_status status = made ? write_out(name, path, log)
                             : noc_error(log, NOC_ERR_IO, "%s: GDAL cannot make a GeoTIFF of it: %s", path,
                                         *said.text ? said.text : "it does not say why");
    gdal.VSIUnlink(name);
    gdal.CPLSetThreadLocalConfigOption("GDAL_PAM_ENABLED", NULL);
    gdal.CPLPopErrorHandler();
    gdal.CPLErrorReset();
    return status;
}

#else

noc_status noc_raster_write(const noc_raster *r, const char *path, const char *const (*items)[2], noc_log *log) {
    (void)items;
    return r && path ? noc_error(log, NOC_ERR_UNSUPPORTED, "%s: GeoTIFF is written by GDAL: %s", path, gdal_load())
                     : noc_null(log, __func__);
}

#endif
