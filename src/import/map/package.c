/* A GeoPackage of what a GeoJSON holds. */
#include "import/import.h"
#include "import/map/made.h"

#if NOC_HAVE_GDAL

static bool make(const void *of, const char *name) {
    const char *from = of;
    const char *const drivers[] = { "GeoJSON", NULL };
    GDALDriverH driver = gdal.GDALGetDriverByName("GPKG");
    GDALDatasetH set = driver ? gdal.GDALOpenEx(from, GDAL_OF_VECTOR, drivers, NULL, NULL) : NULL;
    GDALDatasetH file = set ? gdal.GDALCreate(driver, name, 0, 0, 0, GDT_Unknown, NULL) : NULL;
    bool made = file && gdal.GDALDatasetCopyLayer(file, gdal.GDALDatasetGetLayer(set, 0), "tiles", NULL);
    if (file)
        gdal.GDALClose(file);
    if (set)
        gdal.GDALClose(set);
    return made;
}

noc_status map_write_package(const char *geojson, const char *path, noc_log *log) {
    /* a date of its own, so that it has the same bytes each time */
    static const map_made made = { "GeoPackage", ".gpkg", "OGR_CURRENT_DATE", "2000-01-01T00:00:00.000Z", make };
    const char *why = gdal_load();
    if (!why)
        return map_write_made(&made, geojson, path, log);
    noc_info(log, "%s: not written, for a GeoPackage is GDAL's: %s", path, why);
    return NOC_OK;
}

#else

noc_status map_write_package(const char *geojson, const char *path, noc_log *log) {
    (void)geojson;
    noc_info(log, "%s: not written, for a GeoPackage is GDAL's: %s", path, gdal_load());
    return NOC_OK;
}

#endif
