/* map_source: a map file as GDAL opens it, and nothing but that file. */
#ifndef NOC_IMPORT_MAP_SOURCE_H
#define NOC_IMPORT_MAP_SOURCE_H

#include "import/import.h"
#include "import/map/gdal.h"
#include "import/scratch.h"

typedef struct map_format {
    const char *name;
    const char *drivers[3]; /* GDAL's, ended by NULL */
    bool (*probe)(const char *head, size_t size);
    enum { MAP_GEOJSON, MAP_ARCGIS, MAP_FLATGEOBUF, MAP_OSM, MAP_GEOPACKAGE, MAP_SHAPEFILE, MAP_GML, MAP_GEOTIFF } kind;
} map_format;

#if NOC_HAVE_GDAL

/* A CRS as a GML names it, and the line where it does first. */
typedef struct map_gml_crs {
    char name[200];
    size_t line;
} map_gml_crs;

typedef struct map_source {
    GDALDatasetH dataset;
    char error[512];   /* GDAL's first failure since it was opened, "" if none */
    char link[200];    /* the first address that a content asked for, "" if none: it is not fetched */
    char unpaired[64]; /* of a Shapefile: rows and shapes, where they are not as many, else "" */
    bool entered;      /* GDAL is there, and this thread's settings of it are ours */
    bool plain;        /* GDAL reads the file itself, neither unpacked nor from an archive */
    bool parts;        /* and it is a Shapefile, with parts beside it */
    char strange[200]; /* of a GeoJSON: types of geometries that are none, which GDAL passes over; "": there are none */
    size_t strange_count;
    bool crs_named;    /* false: a GeoJSON without one, whose CRS is its format's */
    char odd_crs[400]; /* of a GeoJSON: the first feature whose CRS is not the file's, and both; "": there is none */
    const char *name, *format;
    noc_log *log;
    scratch_folder copy; /* with our own copy of the file, where it is not read in place */
    char *content;       /* of a GML, and what GDAL knows it by; "": nothing */
    char memory[64];
    NOC_ARRAY(map_gml_crs) gml_crs;
    bool gml_several; /* its geometries are in more than one of them */
} map_source;

/* Opens the stream's file by the format's drivers alone, for reading alone: nothing is written beside it, nothing
 * fetched. Until it is closed GDAL's messages in this thread go to m->error. Parts of a Shapefile and of a GeoPackage
 * that are no regular files, or lie outside the file's folder (unless `anywhere`), are an error, and so are CRSs that
 * name files. To be closed after an error, too. */
noc_status map_source_open(map_source *m, noc_stream *stream, const map_format *format, bool anywhere, noc_log *log);
noc_status map_source_error(const map_source *m); /* reports m->error */
/* After GDAL has read it: can all of a plain file be read? GDAL takes one that cannot be read on for one that ends, and
 * a Shapefile whose CRS or encoding cannot be read for one that tells none. */
noc_status map_source_check(const map_source *m, noc_stream *stream);
void map_source_close(map_source *m);

/* gml.c: the path by which GDAL finds the stream's content, in place of *path; checked, and reported. */
noc_status map_gml_open(map_source *m, noc_stream *stream, char **path);
void map_gml_close(map_source *m);

/* gml_places.c: fills gml_crs and gml_several, and rewrites the content where that is needed: geometries without
 * numbers are taken out. Features then have these fields. */
#define MAP_GML_CRS "nocturne_crs"       /* place in gml_crs, where gml_several */
#define MAP_GML_BROKEN "nocturne_broken" /* what stands where coordinates should */
noc_status map_gml_look_at_places(map_source *m);

#endif

#endif
