/* Terrain from GeoTIFF, by GDAL: a grid of heights becomes triangles of class TERRAIN, in memory that is bounded. */
#include "import/map/crs.h"
#include "import/terrain_grid.h"

#include <math.h>

static bool probe(const char *head, size_t size) {
    static const char magic[][5] = { "II*\0", "MM\0*", "II+\0", "MM\0+" };
    for (size_t i = 0; i < NOC_COUNT(magic) && size >= 4; i++)
        if (!memcmp(head, magic[i], 4))
            return true;
    return false;
}

#if NOC_HAVE_GDAL

#define LOWEST (-12000.0) /* m: there is no ground below, nor above */
#define HIGHEST 9000.0
#define ASK 4096 /* triangles, before progress is asked */

typedef struct terrain {
    geo_sink *sink;
    const char *name;
    map_source source;
    import_budget budget;
    GDALRasterBandH band;
    double place[6];    /* GDAL's: x = place[0] + place[1] * column + place[2] * row, y so by the others */
    double metres;      /* of its unit of heights; 0: unset */
    double scale, base; /* from samples to heights */
    size_t step;        /* samples of the file a sample that is read */
    terrain_grid grid;
    size_t triangles;
    noc_status status;
} terrain;

static noc_status unsuitable(const terrain *t, const char *why) {
    return noc_error(t->sink->log, NOC_ERR_UNSUPPORTED, "%s: GeoTIFF %s", t->name, why);
}

/* ---- what the file says ---- */

/* As AUTHORITY:CODE or WKT; NULL where there is none, or memory was refused, which *refused tells. free() it. */
static char *crs_of(OGRSpatialReferenceH srs, bool *refused) {
    const char *authority = srs ? gdal.OSRGetAuthorityName(srs, NULL) : NULL,
               *code = srs ? gdal.OSRGetAuthorityCode(srs, NULL) : NULL;
    const char *const options[] = { "FORMAT=WKT2_2018", NULL };
    char *wkt = NULL, *text = NULL;
    *refused = false;
    if (authority && code)
        text = noc_format("%s:%s", authority, code);
    else if (srs && gdal.OSRExportToWktEx(srs, &wkt, options) == OGRERR_NONE && wkt && *wkt)
        text = noc_strdup(wkt);
    else
        return gdal.VSIFree(wkt), NULL;
    gdal.VSIFree(wkt);
    *refused = !text;
    return text;
}

static noc_status tell_crs(terrain *t) {
    OGRSpatialReferenceH srs = gdal.GDALGetSpatialRef(t->source.dataset);
    bool refused, lat_first;
    char *crs = crs_of(srs, &refused);
    noc_status status = refused ? noc_no_memory(t->sink->log, t->name) : NOC_OK;
    if (crs)
        status = map_check_crs_text(crs, t->name, t->sink->log);
    if (!status)
        status = t->sink->crs(t->sink->ctx, crs, t->name, &lat_first);
    free(crs);
    return status;
}

/* The unit of heights, where it is the raster's own: one of a vertical CRS goes before it. */
static void find_unit(terrain *t) {
    static const struct {
        const char *name;
        double metres;
    } units[] = { { "m", 1 },
                  { "metre", 1 },
                  { "meter", 1 },
                  { "metres", 1 },
                  { "meters", 1 },
                  { "ft", 0.3048 },
                  { "foot", 0.3048 },
                  { "feet", 0.3048 },
                  { "cm", 0.01 },
                  { "centimeter", 0.01 },
                  { "centimetre", 0.01 },
                  { "dm", 0.1 },
                  { "us survey foot", 1200. / 3937 },
                  { "us-ft", 1200. / 3937 },
                  { "ftus", 1200. / 3937 } };
    int given;
    const char *unit = gdal.GDALGetRasterUnitType(t->band);
    double scale = gdal.GDALGetRasterScale(t->band, &given), base = gdal.GDALGetRasterOffset(t->band, &given);
    OGRSpatialReferenceH srs = gdal.GDALGetSpatialRef(t->source.dataset);
    for (size_t i = 0; i < NOC_COUNT(units) && !(srs && gdal.OSRIsCompound(srs)); i++)
        if (noc_ieq(unit, units[i].name))
            t->metres = units[i].metres;
    t->scale = isfinite(scale) && scale != 0 ? scale : 1;
    t->base = isfinite(base) ? base : 0;
}

static noc_status look(terrain *t) {
    GDALDatasetH set = t->source.dataset;
    int bands = gdal.GDALGetRasterCount(set), width = gdal.GDALGetRasterXSize(set),
        height = gdal.GDALGetRasterYSize(set);
    if (bands != 1)
        return unsuitable(t, bands ? "of several bands: a picture, no terrain" : "without a band");
    if (width < 2 || height < 2)
        return unsuitable(t, "of fewer than 2 x 2 samples");
    t->band = gdal.GDALGetRasterBand(set, 1);
    GDALDataType type = gdal.GDALGetRasterDataType(t->band);
    if (gdal.GDALDataTypeIsComplex(type) || gdal.GDALGetRasterColorTable(t->band))
        return unsuitable(t, "of colours or complex numbers: no terrain");
    bool placed = gdal.GDALGetGeoTransform(set, t->place) == CE_None;
    for (int i = 0; i < 6; i++)
        placed = placed && isfinite(t->place[i]);
    if (!placed || t->place[1] * t->place[5] == t->place[2] * t->place[4])
        return unsuitable(t, "that does not say where it lies");
    size_t longest = (size_t)NOC_MAX(width, height);
    t->step = (longest + TERRAIN_MOST - 1) / TERRAIN_MOST;
    t->grid.width = NOC_MAX((size_t)width / t->step, 1);
    t->grid.height = NOC_MAX((size_t)height / t->step, 1);
    if (t->grid.width < 2 || t->grid.height < 2)
        return unsuitable(t, "far longer than it is wide");
    if (t->step > 1)
        noc_info(t->sink->log, "%s: of its %d x %d heights every %zu. is taken each way", t->name, width, height,
                 t->step);
    find_unit(t);
    return NOC_OK;
}

/* ---- heights ---- */

/* What stands for none where the file does not say so. */

static void clean(terrain *t) {
    int given;
    double none = gdal.GDALGetRasterNoDataValue(t->band, &given);
    size_t count = t->grid.width * t->grid.height, guessed = 0, wild = 0;
    for (size_t i = 0; i < count; i++) {
        float *z = &t->grid.z[i];
        double metres = (double)*z * t->scale + t->base;
        bool missing = given && ((double)*z == none || *z == (float)none || (isnan(none) && isnan(*z)));
        bool taken = !given && geo_height_stands_for_none((double)*z);
        bool is_wild = !missing && !taken && !(metres >= LOWEST && metres <= HIGHEST);
        guessed += taken;
        wild += is_wild;
        *z = missing || taken || is_wild ? NAN : (float)metres;
    }
    if (guessed)
        geo_issues_add(t->sink->issues, GEO_GUESSED, "height such as -9999, taken as missing", guessed, "");
    if (wild)
        geo_issues_add(t->sink->issues, GEO_SKIPPED, "height that no ground has", wild, "");
}

static noc_status read_heights(terrain *t) {
    terrain_grid *g = &t->grid;
    double bytes = sizeof(float) * (double)g->width * (double)g->height + terrain_grid_bytes(g->width, g->height);
    noc_status status = import_affords(&t->budget, bytes, t->name, "its grid of heights", t->sink->log);
    if (status)
        return status;
    if (!(g->z = noc_alloc_large(g->width * g->height, sizeof(*g->z))))
        return noc_no_memory(t->sink->log, t->name);
    for (size_t row = 0; row < g->height && !status; row++) {
        int y = (int)(row * t->step + t->step / 2), columns = (int)(g->width * t->step);
        CPLErr error = gdal.GDALRasterIO(t->band, GF_Read, 0, y, columns, 1, g->z + row * g->width, (int)g->width, 1,
                                         GDT_Float32, 0, 0);
        if (error != CE_None)
            status = map_source_error(&t->source);
        else if (row % 64 == 0 && !t->sink->progress(t->sink->ctx, 0.5 * (double)row / (double)g->height))
            status = NOC_ERR_CANCELLED;
    }
    if (!status)
        clean(t);
    return status;
}

/* ---- triangles ---- */

static void place(const terrain *t, const uint32_t corner[2], double xyz[3]) {
    double column = ((double)corner[0] + 0.5) * (double)t->step, row = ((double)corner[1] + 0.5) * (double)t->step;
    xyz[0] = t->place[0] + t->place[1] * column + t->place[2] * row;
    xyz[1] = t->place[3] + t->place[4] * column + t->place[5] * row;
    xyz[2] = (double)t->grid.z[corner[1] * t->grid.width + corner[0]];
}

static bool emit(void *ctx, const uint32_t corners[3][2]) {
    terrain *t = ctx;
    static const size_t three = 3;
    double xyz[9];
    for (int i = 0; i < 3; i++)
        place(t, corners[i], xyz + 3 * i);
    bool up = (xyz[3] - xyz[0]) * (xyz[7] - xyz[1]) > (xyz[4] - xyz[1]) * (xyz[6] - xyz[0]);
    if (!up) {
        double other[3];
        memcpy(other, xyz + 3, sizeof(other));
        memcpy(xyz + 3, xyz + 6, sizeof(other));
        memcpy(xyz + 6, other, sizeof(other));
    }
    const geo_polygon polygon = {
        .cls = NOC_CLASS_TERRAIN, .id = "terrain", .ring_count = 1, .ring_size = &three, .xyz = xyz
    };
    t->status = t->sink->polygon(t->sink->ctx, &polygon);
    if (!t->status && ++t->triangles % ASK == 0 && !t->sink->progress(t->sink->ctx, 0.75))
        t->status = NOC_ERR_CANCELLED;
    return !t->status;
}

static noc_status emit_all(terrain *t, const noc_import_params *params) {
    double error = terrain_grid_error(&t->grid, params->terrain_error / (t->metres > 0 ? t->metres : 1),
                                      (size_t)params->terrain_triangles);
    const geo_object object = { .kind = GEO_TERRAIN, .id = "terrain", .lod = -1 };
    noc_status status = t->sink->begin_object(t->sink->ctx, &object);
    if (status)
        return status;
    terrain_grid_emit(&t->grid, error, emit, t);
    status = t->status ? t->status : t->sink->end_object(t->sink->ctx);
    if (status)
        return status;
    if (!t->triangles)
        return noc_error(t->sink->log, NOC_ERR_FORMAT, "%s: GeoTIFF without a height", t->name);
    noc_info(t->sink->log, "%s: %zu x %zu heights as %zu triangles, to %.2g m (--terrain-error, --terrain-triangles)",
             t->name, t->grid.width, t->grid.height, t->triangles, error * (t->metres > 0 ? t->metres : 1));
    return NOC_OK;
}

static noc_status read_terrain(noc_stream *stream, const noc_import_params *params, geo_sink *sink,
                               const char **format) {
    static const map_format tiff = { "GeoTIFF", { "GTiff" }, probe, MAP_GEOTIFF };
    terrain t = { .sink = sink, .name = noc_stream_name(stream), .budget = *noc_stream_budget(stream) };
    *format = tiff.name;
    noc_status status = map_source_open(&t.source, stream, &tiff, params->allow_outside, sink->log);
    if (!status)
        status = look(&t);
    if (!status)
        status = tell_crs(&t);
    if (!status && t.metres > 0 && sink->heights)
        status = sink->heights(sink->ctx, t.metres);
    if (!status)
        status = read_heights(&t);
    if (!status && !terrain_grid_measure(&t.grid))
        status = noc_no_memory(sink->log, t.name);
    if (!status)
        status = emit_all(&t, params);
    terrain_grid_free(&t.grid);
    map_source_close(&t.source);
    return status;
}

#define MISSING NULL
#else

static noc_status read_terrain(noc_stream *stream, const noc_import_params *params, geo_sink *sink,
                               const char **format) {
    return NOC_ERR_UNSUPPORTED;
}

#define MISSING "this build is without GDAL"
#endif

static bool foreign(const char *head, size_t size) { return true; }

const noc_reader noc_reader_terrain = { .name = "GeoTIFF",
                                        .reads = NOC_READS_CITY,
                                        .probe = probe,
                                        .read = read_terrain,
                                        .foreign = foreign,
                                        .load = gdal_load,
                                        .missing = MISSING };
