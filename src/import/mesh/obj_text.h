/* obj_text: what the text of an OBJ says: vertices, and meshes of faces. */
#ifndef NOC_IMPORT_OBJ_TEXT_H
#define NOC_IMPORT_OBJ_TEXT_H

#include "geo/geo.h"
#include "import/mesh/obj_chunks.h"

#define OBJ_NOWHERE UINT32_MAX /* the place in a texture of a corner that has none */

/* Faces up to the next mesh's. */
typedef struct obj_mesh {
    const char *name, *material; /* NULL: none is said */
    size_t first_face, first_corner;
    bool placed; /* a face of it has places in textures */
} obj_mesh;

/* Zero-initialise. */
typedef struct obj_text {
    NOC_ARRAY(double) xyz;        /* 3 a vertex, as they are written; NAN where they are none */
    NOC_ARRAY(double) uv;         /* 2 a place in textures */
    NOC_ARRAY(uint32_t) faces;    /* corners of each */
    NOC_ARRAY(uint32_t) corners;  /* vertex of each corner */
    NOC_ARRAY(uint32_t) uv_index; /* place of each corner; empty where places are of no use */
    NOC_ARRAY(obj_mesh) meshes;
    noc_arena names;
} obj_text;

/* Reads the statements of a text whose lines are counted. Indices count from 1 over the whole file; negative ones count
 * back from the last vertex before the face. A weight is divided by, colours, normals and remarks are passed over.
 * Faces with vertices that are not there, or of fewer than three, are left out and counted, as are those with a vertex
 * that is not three numbers. places: those in textures are of use. false: no memory. */
bool obj_text_read(obj_text *t, obj_chunks *text, bool places, geo_issues *issues);
void obj_text_free(obj_text *t);

#endif
