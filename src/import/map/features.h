/* features: what the reader of maps (vector.c) and that of their shapes (shapes.c) share. */
#ifndef NOC_IMPORT_MAP_FEATURES_H
#define NOC_IMPORT_MAP_FEATURES_H

#include "import/lamps/tags.h"
#include "import/map/source.h"
#include "import/tracks/tracks.h"

#if NOC_HAVE_GDAL

typedef struct tag_buffer {
    NOC_ARRAY(lamp_tag) tags;
    NOC_ARRAY(char *) owned;
    char id[128];
    bool refused; /* memory, to one of them; stays set */
} tag_buffer;

typedef struct map_reading {
    const map_format *format;
    noc_stream *stream;
    const noc_import_params *params;
    lamp_writer writer;
    tag_buffer tags;
    map_source source;
    bool building_layer;         /* by its name */
    int crs_field, broken_field; /* of a GML's layer, that gml_places.c made; -1: none */
    int crs_now;                 /* the CRS that the sink was told of last, of several; -1: none */
    char broken[64];             /* lamp_writer.broken */
    bool lines;                  /* the shape that is being read is made of lines */
    NOC_ARRAY(size_t) rings;
    NOC_ARRAY(double) xyz;
    NOC_ARRAY(double) times; /* of the line that is being read */
    OGRFeatureDefnH columns_of;
    track_columns track_columns; /* of that layer */
    track_rows rows;             /* points of tracks, of the layer */
} map_reading;

noc_status map_no_memory(const map_reading *m); /* reported */
/* Fills b with the tags or columns of a feature. False: memory was refused. */
bool map_collect_fields(OGRFeatureH feature, OGRFeatureDefnH defn, bool osm, tag_buffer *b);

/* Hands on a feature that is a building, a road or water, where the sink wants such; *is: whether it is one of the
 * first two. */
noc_status map_read_shape(map_reading *m, OGRFeatureH feature, OGRFeatureDefnH defn, bool *is);
/* The same of all lines and areas of a file of OpenStreetMap, from its beginning. */
noc_status map_read_osm_shapes(map_reading *m);
/* tracks.c, of files that the user names as tracks. A line that tells when each of its points was reached, whose tags
 * are collected. *is: it does. */
noc_status map_read_timed_line(map_reading *m, OGRFeatureH feature, OGRFeatureDefnH defn, bool *is);
/* A point; *is: its layer has a column of times. */
noc_status map_read_track_point(map_reading *m, OGRFeatureH feature, OGRFeatureDefnH defn, const double xyz[3],
                                bool *is);
noc_status map_end_tracks(map_reading *m); /* hands on the tracks that a layer's points make */
/* Layers of OpenStreetMap that are to be read; geometries of others are not assembled. */
void map_choose_layers(map_reading *m, const char *layers);

#endif
#endif
