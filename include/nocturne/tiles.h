/* nocturne/tiles.h: a city as many built cities, one a tile, and an index of them: `nocturne build --each`. What a tile
 * is, and how one is saved, is in nocturne/built.h. */
#ifndef NOCTURNE_TILES_H
#define NOCTURNE_TILES_H

#include <nocturne/built.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct noc_tile_entry {
    const char *location; /* of its file, from the index's folder on */
    noc_tile_info info;
    unsigned long long bytes; /* of its file */
} noc_tile_entry;

/* Writes FOLDER/index.geojson, which noc_tiles_find reads: a rectangle a tile with its location, as gdaltindex writes
 * them, buildings, windows, lamps, triangles and bytes; and FOLDER/index.gpkg with the same where GDAL is there, which
 * is no error where it is not. crs: that the extents are in, as "EPSG:25832"; NULL: none. Both files appear when they
 * are whole, and are the same for the same entries. NOC_ERR_IO after reporting. */
NOC_API noc_status noc_tiles_write(const char *folder, const char *crs, const noc_tile_entry *entries, size_t count,
                                   noc_log *log);

/* Is the path an index, or a folder that holds one? An index.gpkg is one where its index.geojson lies beside it. */
NOC_API bool noc_tiles_is(const char *path);

/* The files of the tiles of an index that meet a box, "X0,Y0,X1,Y1" or "X0,Y0,X1,Y1,CRS", else in the index's CRS;
 * NULL: all of them. *paths is a NULL-ended list, which free() frees together with its texts. NOC_ERR_ARGUMENT after
 * reporting: it is no box, or no tile meets it; NOC_ERR_FORMAT: it is no index. */
NOC_API noc_status noc_tiles_find(const char *index, const char *bbox, noc_log *log, char ***paths, size_t *count);

#ifdef __cplusplus
}
#endif
#endif
