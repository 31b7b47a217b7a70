/* obj_mesh: from meshes of an OBJ's text to those of a scene. */
#ifndef NOC_IMPORT_OBJ_MESH_H
#define NOC_IMPORT_OBJ_MESH_H

#include "import/import.h"
#include "import/mesh/obj_library.h"
#include "import/mesh/obj_text.h"
#include "import/mesh/obj_up.h"

typedef struct obj_target {
    const mesh_parts *parts;
    const obj_images *images;
    bool z_up;
    obj_spread *spread;
} obj_target;

/* Arrays that are used for one mesh after the other. Zero-initialise the rest. */
typedef struct obj_builder {
    const obj_target *to;
    const obj_text *text;
    uint32_t *made;            /* of each vertex of the text: which one of the mesh, where that was made of it */
    NOC_ARRAY(uint32_t) from;  /* of each vertex of the mesh: which one of the text */
    NOC_ARRAY(uint32_t) found; /* hash table: vertices of the mesh, from 1, by what they hold */
    NOC_ARRAY(double) xyz;
    NOC_ARRAY(double) places;
    NOC_ARRAY(float) uv;
    NOC_ARRAY(uint32_t) indices, corners;
} obj_builder;

/* Adds its triangles as one mesh, and its faces of more corners as another of the same name, so that lights keep their
 * order. Vertices that hold the same are one. image: NULL: none, or the mesh has no places in it. */
noc_status obj_add_mesh(obj_builder *b, size_t mesh, int material, const obj_image *image);
void obj_builder_free(obj_builder *b);

#endif
