/* Reading OpenEXR: what its files share. */
#ifndef NOC_IMAGE_EXR_H
#define NOC_IMAGE_EXR_H

#include "image/internal.h"

#include <openexr.h>

typedef enum exr_layout {
    EXR_RGB,
    EXR_GREY,  /* Y alone */
    EXR_CHROMA /* Y with RY and BY: R = (RY + 1) Y, B alike */
} exr_layout;

/* How the numbers of the picture become light: exr_colour.c */
typedef struct exr_colours {
    bool convert; /* by the matrix; otherwise they are in the working space */
    double to_working[3][3];
    double scale;        /* cd/m2 of RGB (1, 1, 1) */
    double luminance[3]; /* what R, G and B add to Y, of EXR_CHROMA */
} exr_colours;

typedef struct exr_reader {
    exr_context_t context;
    int part;
    const uint8_t *data;
    size_t size;
    const char *name;
    noc_log *log;
    noc_status status;
    noc_image *image;
    float *mask; /* emitter channel, as floats */
    exr_attr_box2i_t window;
    char layer[256]; /* what its channels' names begin with: "", or "ViewLayer.Combined." */
    exr_layout layout;
    exr_colours colours;
    bool has_mask;
    bool tiled;
    int x, y; /* of the chunk being unpacked, relative to the window */
} exr_reader;

/* exr_read.c. Returns false when a step failed; the handler has reported it, or it is reported here. */
bool exr_ok(exr_reader *r, exr_result_t result);

/* exr_choose.c: the part and the layer that is the picture. false after reporting that there is none, or several. */
bool exr_choose(exr_reader *r);
/* exr_colour.c. false after reporting attributes that tell no colours. */
bool exr_read_colours(exr_reader *r);
void exr_apply_colours(const exr_reader *r); /* to all pixels */

#endif
