/* gdal: the functions of GDAL that are called. Its library, and the hundred that it needs, are loaded when a map or a
 * terrain is read. */
#ifndef NOC_IMPORT_MAP_GDAL_H
#define NOC_IMPORT_MAP_GDAL_H

#include "noc_config.h"

#if NOC_HAVE_GDAL

#include "base/library.h"

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_http.h>
#include <cpl_string.h>
#include <cpl_vsi.h>
#include <gdal.h>
#include <ogr_api.h>
#include <ogr_srs_api.h>

/* clang-format off */
#define GDAL_FUNCTIONS(X)                                                                                              \
    X(CPLCalloc) X(CPLErrorReset) X(CPLGetErrorHandlerUserData) X(CPLHTTPPopFetchCallback)                             \
    X(CPLHTTPPushFetchCallback) X(CPLPopErrorHandler) X(CPLPushErrorHandlerEx) X(CPLSetThreadLocalConfigOption)        \
    X(CPLStrdup) X(CSLDestroy) X(GDALClose) X(GDALCreate) X(GDALCreateCopy) X(GDALDatasetExecuteSQL)                   \
    X(GDALDatasetGetLayer) X(GDALDatasetGetLayerByName) X(GDALDatasetGetLayerCount) X(GDALDatasetGetNextFeature)       \
    X(GDALDatasetReleaseResultSet) X(GDALDataTypeIsComplex) X(GDALGetDriverByName) X(GDALGetGeoTransform)              \
    X(GDALGetRasterBand) X(GDALGetRasterColorTable) X(GDALGetRasterCount) X(GDALGetRasterDataType)                     \
    X(GDALGetRasterNoDataValue) X(GDALGetRasterOffset) X(GDALGetRasterScale) X(GDALGetRasterUnitType)                  \
    X(GDALGetRasterXSize) X(GDALGetRasterYSize) X(GDALGetSpatialRef) X(GDALOpenEx) X(GDALRasterIO)                     \
    X(GDALSetDescription) X(GDALSetGeoTransform) X(GDALSetMetadataItem) X(GDALSetProjection)                           \
    X(GDALSetRasterNoDataValue) X(GDALSetRasterUnitType) X(OGR_F_Destroy) X(OGR_F_GetFID)                              \
    X(OGR_F_GetFieldAsDateTimeEx) X(OGR_F_GetFieldAsDoubleList) X(OGR_F_GetFieldAsInteger64List)                       \
    X(OGR_F_GetFieldAsIntegerList) X(OGR_F_GetFieldAsString) X(OGR_F_GetFieldAsStringList) X(OGR_F_GetGeometryRef)     \
    X(OGR_F_IsFieldSetAndNotNull) X(OGR_FD_GetFieldCount) X(OGR_FD_GetFieldDefn) X(OGR_FD_GetFieldIndex)               \
    X(OGR_Fld_GetNameRef) X(OGR_Fld_GetType) X(OGR_G_GetDimension) X(OGR_G_GetEnvelope) X(OGR_G_GetGeometryCount)      \
    X(OGR_G_GetGeometryRef) X(OGR_G_GetGeometryType) X(OGR_G_GetPointCount) X(OGR_G_GetX) X(OGR_G_GetY) X(OGR_G_GetZ)  \
    X(OGR_G_Is3D) X(OGR_G_IsEmpty) X(OGR_GT_Flatten) X(OGR_L_GetFeatureCount) X(OGR_L_GetLayerDefn) X(OGR_L_GetName)   \
    X(OGR_L_GetNextFeature) X(OGR_L_GetSpatialRef) X(OGR_L_ResetReading) X(OGRRegisterAll) X(OSRExportToWktEx)         \
    X(OSRGetAuthorityCode) X(OSRGetAuthorityName) X(OSRIsCompound) X(OSRIsGeographic) X(VSIFCloseL)                    \
    X(VSIFEofL) X(VSIFileFromMemBuffer) X(VSIFOpenL) X(VSIFReadL) X(VSIFree) X(VSIGetMemFileBuffer) X(VSIReadDir)      \
    X(VSIUnlink) X(GDALDatasetCopyLayer)
/* clang-format on */

typedef struct gdal_functions {
    GDAL_FUNCTIONS(LIBRARY_POINTER)
} gdal_functions;

extern gdal_functions gdal;

#endif

/* Loads the library, once a process. NULL, or why it cannot be loaded; `gdal` must not be called then. A process whose
 * files or memory are confined calls it before. */
const char *gdal_load(void);

#endif
