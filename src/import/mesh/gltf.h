/* gltf: glTF 2.0 and GLB. gltf_data.c finds the numbers, gltf_look.c makes materials, lights and cameras of them,
 * gltf_image.c finds images, gltf.c walks the nodes. The specification meant is Khronos's glTF 2.0 (ISO/IEC 12113:2022)
 * and its extensions by name. */
#ifndef NOC_IMPORT_GLTF_H
#define NOC_IMPORT_GLTF_H

#include "import/import.h"
#include "scene/scene.h"

#include <jansson.h>

typedef struct gltf_buffer {
    const unsigned char *data;
    size_t size;
    void *owned; /* to free */
} gltf_buffer;

/* What an image's data URI holds: decoded once, however many materials look like it. */
typedef struct gltf_image {
    bool looked, good;
    unsigned char *data;
    size_t size;
} gltf_image;

typedef struct gltf {
    const char *name; /* of the file, for messages */
    char *folder;     /* it lies in, with a slash at its end, or "" */
    bool anywhere;    /* its buffers may lie outside that folder */
    noc_log *log;
    noc_scene *scene;
    const mesh_place *place;
    geo_issues *issues;
    import_budget *budget;           /* of the stream */
    const import_listener *listener; /* of the stream */
    json_t *root;
    const unsigned char *chunk; /* GLB: the binary one */
    size_t chunk_size;
    gltf_buffer *buffers;
    size_t buffer_count;
    gltf_image *decoded; /* of each of its images */
    bool images;         /* are of use */
    bool told;           /* what is not read of them is counted */
    /* two each, without and with its image: index in the scene + 1, 0 if not made yet; the last is the default one */
    int *materials;
} gltf;

/* Affine map of a node: columns x, y, z, then the translation. */
typedef struct gltf_frame {
    double m[12];
} gltf_frame;

/* gltf_data.c. Reported errors say "FILE: glTF: WHAT". */
noc_status gltf_error(const gltf *g, const char *fmt, ...) NOC_PRINTF(2, 3);
json_t *gltf_item(const gltf *g, const char *list, size_t index);      /* root.list[index], NULL if there is none */
bool gltf_index(const json_t *object, const char *key, size_t *index); /* a whole number >= 0 */
double gltf_number(const json_t *object, const char *key, double otherwise);
/* count numbers of an array; false (and out as it was) where it is not that. */
bool gltf_numbers(const json_t *object, const char *key, size_t count, double *out);
json_t *gltf_extension(const json_t *object, const char *name);
noc_status gltf_open_buffers(gltf *g);
void gltf_close_buffers(gltf *g);
/* Bytes that gltf_read takes for an accessor; 0 where its numbers are not there. */
double gltf_cost(const gltf *g, size_t accessor, size_t width);
/* An accessor's elements of `width` numbers each, as doubles (integers normalised where it says so). free() *out. */
noc_status gltf_read(const gltf *g, size_t accessor, const char *type, size_t width, double **out, size_t *count);

/* The bytes of the view that an item names by "bufferView"; NULL where they are not there. */
const unsigned char *gltf_view(const gltf *g, const json_t *item, size_t *size);
/* What a data URI holds, free() it; NULL where *good is false, and where memory was refused. */
unsigned char *gltf_decode_data(const char *uri, size_t *size, bool *good);
void gltf_decode_percent(char *text); /* %20 and the like, in place */

/* gltf_image.c */
/* Notes the files of all images, for the stream's listener. */
noc_status gltf_note_images(const gltf *g, const noc_stream *stream);
/* The texture of a base colour. */
typedef struct gltf_texture {
    size_t index, set; /* in "textures"; TEXCOORD_ of that number */
    double offset[2], scale[2], rotation;
} gltf_texture;
bool gltf_texture_of(const gltf *g, const json_t *material, gltf_texture *out); /* false: it has none */
bool gltf_texture_places(const gltf_texture *t, const json_t *primitive, size_t *accessor);
/* Places of TEXCOORD_ as noc_mesh has them. NULL after reporting. */
float *gltf_texture_uv(const gltf *g, const gltf_texture *t, const double *places, size_t count);
/* That material of the scene looks like the texture's image, times the albedo. What is of no use is counted. */
noc_status gltf_texture_give(const gltf *g, const gltf_texture *t, int material, const float albedo[3], uint8_t cutoff,
                             const char *name);

/* gltf_look.c */
/* Of a primitive whose vertices have a place in the material's image, or have none. */
noc_status gltf_material(gltf *g, const json_t *primitive, bool placed, int *index);
const json_t *gltf_material_of(const gltf *g, const json_t *primitive, size_t *index); /* NULL: the default one */
noc_status gltf_light(gltf *g, const json_t *node, const gltf_frame *frame, const char *name);
noc_status gltf_camera(gltf *g, const json_t *node, const gltf_frame *frame, const char *name);
/* A point of glTF's (y up) in the scene's frame. */
noc_status gltf_place(const gltf *g, const double yup[3], double out[3]);

#endif
