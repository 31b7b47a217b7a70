/* pixels: files of pictures that others name, as 8-bit sRGB: textures. PNG and JPEG, told apart by their first bytes.
 * What is transparent in one is taken as opaque, or as a hole. */
#ifndef NOC_IMAGE_PIXELS_H
#define NOC_IMAGE_PIXELS_H

#include "base/base.h"

#define PIXELS_SIDE 16384         /* of a picture at most */
#define PIXELS_COUNT (100u << 20) /* the same of all its pixels: no file makes a reader take more */

typedef struct pixel_bytes {
    int width, height;
    uint8_t *rgb;   /* 3 a pixel, rows from the top; free() it */
    uint8_t *holes; /* 1 a pixel: not 0 where its alpha is below what was asked for; free() it. NULL: nowhere */
    bool damaged;   /* a part of it could not be read, and is whatever the library makes of it */
} pixel_bytes;

/* The size that the file's head tells. NOC_ERR_UNSUPPORTED: neither format, or one that this build does not read;
 * NOC_ERR_FORMAT: broken, or larger than a picture may be. Reported, as all that fails here; name is for messages. */
noc_status pixels_size(const uint8_t *data, size_t size, const char *name, noc_log *log, int *width, int *height);
/* All of it. cutoff: pixels of a smaller alpha, 0..255, are holes. */
noc_status pixels_read(const uint8_t *data, size_t size, const char *name, int cutoff, noc_log *log, pixel_bytes *out);

#endif
