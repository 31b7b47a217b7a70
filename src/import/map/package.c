/* A GeoPackage of what a GeoJSON holds, made by GDAL in memory. */
#include "base/output.h"
#include "import/import.h"
#include "import/map/gdal.h"

#include <stdatomic.h>

#if NOC_HAVE_GDAL

static void CPL_STDCALL on_error(CPLErr level, CPLErrorNum code, const char *text) {
    char *said = gdal.CPLGetErrorHandlerUserData();
    if (level >= CE_Failure && !*said)
        noc_snprintf(said, 200, "%s", text);
    (void)code;
}

static bool make(const char *from, const char *name) {
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

static noc_status write_out(const char *name, const char *path, noc_log *log) {
    vsi_l_offset size = 0;
    const GByte *bytes = gdal.VSIGetMemFileBuffer(name, &size, FALSE);
    output o;
    noc_status status = bytes ? output_open(&o, path, log) : noc_no_memory(log, path);
    if (status)
        return status;
    bool written = fwrite(bytes, 1, size, o.file) == size;
    return output_close(&o, written ? NOC_OK : output_failed(&o, log), log);
}

noc_status map_write_package(const char *geojson, const char *path, noc_log *log) {
    static atomic_uint number;
    const char *why = gdal_load();
    if (why) {
        noc_info(log, "%s: not written, for a GeoPackage is GDAL's: %s", path, why);
        return NOC_OK;
    }
    char name[64], said[200] = "";
    noc_snprintf(name, sizeof(name), "/vsimem/nocturne/package%u.gpkg", atomic_fetch_add(&number, 1));
    gdal.OGRRegisterAll();
    gdal.CPLPushErrorHandlerEx(on_error, said);
    gdal.CPLSetThreadLocalConfigOption("OGR_CURRENT_DATE", "2000-01-01T00:00:00.000Z"); /* the same bytes each time */
    noc_status status = make(geojson, name) ? write_out(name, path, log)
                                            : noc_error(log, NOC_ERR_IO, "%s: GDAL cannot make a GeoPackage of it: %s",
                                                        path, *said ? said : "it does not say why");
    gdal.VSIUnlink(name);
    gdal.CPLSetThreadLocalConfigOption("OGR_CURRENT_DATE", NULL);
    gdal.CPLPopErrorHandler();
    gdal.CPLErrorReset();
    return status;
}

#else

noc_status map_write_package(const char *geojson, const char *path, noc_log *log) {
    (void)geojson;
    noc_info(log, "%s: not written, for a GeoPackage is GDAL's: %s", path, gdal_load());
    return NOC_OK;
}

#endif
