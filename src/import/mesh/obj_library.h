/* obj_library: material libraries (MTL) as they are written, under the names that they are given. */
#ifndef NOC_OBJ_LIBRARY_H
#define NOC_OBJ_LIBRARY_H

#include "geo/geo.h"
#include "import/import.h"

/* The image of a material's diffuse colour: map_Kd. */
typedef struct obj_image {
    char *name;
    bool clamp;
    double scale[2], offset[2]; /* of the places in it */
} obj_image;
typedef struct obj_images {
    noc_map of; /* material -> index in list */
    NOC_ARRAY(obj_image) list;
} obj_images;
void obj_images_free(obj_images *images);

/* Where libraries are looked for. */
typedef struct obj_folder {
    const char *path;                /* with a slash at its end, or "" */
    bool anywhere;                   /* they may lie outside it */
    const import_listener *listener; /* gets their paths and those of all textures; NULL: none */
    const char *why;                 /* the last one could not be opened */
    char *missing;                   /* the first one that could not be read, and why; free() it */
    bool refused;                    /* memory was, to one of them, which then is not there; stays set */
    bool textures;                   /* are wanted: those that are not read are counted */
} obj_folder;

/* The text of a library named by mtllib, with a 0 behind it, free() it; NULL where there is none. The name may hold
 * blanks, be several names, or a path of another machine, whose last part is then looked for in the folder. Statements
 * with numbers that are none are blanked out and counted, as are textures. images: gets those of diffuse colours; NULL:
 * they are passed over. */
char *obj_open_library(obj_folder *folder, const char *name, size_t *size, obj_images *images, geo_issues *issues);

#endif
