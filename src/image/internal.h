/* image, inside: what the files of this room share. */
#ifndef NOC_IMAGE_INTERNAL_H
#define NOC_IMAGE_INTERNAL_H

#include "base/base.h"
#include "base/output.h"
#include "image/pixels.h"
#include <nocturne/image.h>
#include <stdio.h>

/* Photometric luminance of linear Rec.709. */
static inline double image_luminance(const float rgb[3]) { return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]; }
static inline bool image_finite(const float rgb[3]) {
    return __builtin_isfinite(rgb[0]) && __builtin_isfinite(rgb[1]) && __builtin_isfinite(rgb[2]);
}
static inline size_t image_pixels(const noc_image *image) { return (size_t)image->width * (size_t)image->height; }

/* image.c. Zeroed; NULL after reporting when refused. */
void *image_alloc_pixels(int width, int height, size_t size, noc_log *log);
/* file.c */
bool image_path_ends_in(const char *path, const char *ending);
bool image_size_allowed(int width, int height);
typedef enum image_format { IMAGE_UNKNOWN, IMAGE_PNG, IMAGE_EXR, IMAGE_HDR } image_format;
image_format image_probe(const uint8_t *data, size_t size); /* by its first 8 bytes */
/* metadata.c. Where in the file the value of that key begins, of *length bytes; 0: it has none */
size_t image_find_text(const uint8_t *data, size_t size, const char *key, size_t *length);
/* The mask all zero; false after reporting when refused. */
bool image_add_mask(noc_image *image, noc_log *log);
/* Luminance of 1.2 cd/m2 * 2^EV100 is where a camera of that exposure saturates. */
#define IMAGE_SATURATION 1.2

/* srgb.c: the transfer function of IEC 61966-2-1, exactly. */
double srgb_encode(double linear); /* display linear -> code value, both 0..1 */
double srgb_decode(double code);
typedef struct srgb8_table {
    float threshold[255];
} srgb8_table; /* linear value where code i turns into i + 1 */
void srgb8_table_init(srgb8_table *table);
uint8_t srgb8_encode(const srgb8_table *table, float linear); /* the nearest code; clamps; NaN gives 0 */

/* primaries.c: CIE 1931 x, y of red, green, blue and white */
typedef struct colour_space {
    double xy[4][2];
} colour_space;
extern const colour_space colour_rec709;                        /* with D65: the working space */
bool colour_near(const colour_space *a, const colour_space *b); /* to 1e-6, as far as floats go */
/* Linear colours of a file to the working space: RGB of a space whose white becomes D65, and CIE XYZ in which the x, y
 * of neutral (NULL: D65) do; by Bradford's transform, as OpenEXR's AcesInputFile has it. They, and what RGB add to
 * luminance, return what is wrong with "them", the chromaticities, that have no such matrix, and NULL otherwise. */
const char *colour_from_rgb(const colour_space *space, double to[3][3]);
const char *colour_from_xyz(const double *neutral, double to[3][3]);
const char *colour_luminance(const colour_space *space, double y[3]);
void colour_apply(const double m[3][3], const double from[3], double to[3]);

#define DISPLAY_WHITE 6500.0                            /* K, where colours are shown as they are */
double display_white(const noc_display_params *params); /* K that is shown as white; NULL: default */

/* display.c: from cd/m2 to 8-bit sRGB, one pixel at a time. */
typedef struct display_map {
    noc_tonemap tonemap;
    double scale[3]; /* multiplies cd/m2: exposure and white balance */
    srgb8_table srgb;
} display_map;
/* ev100 is the exposure in effect (display_ev100); params NULL: filmic, without white balance. */
void display_init(display_map *d, const noc_display_params *params, double ev100);
/* params NULL: defaults. False: memory was refused. */
bool display_ev100(const noc_image *image, const noc_display_params *params, double *ev100) NOC_MUST_USE;
void display_pixel(const display_map *d, const float rgb[3], uint8_t out[3]);
double tonemap_curve(noc_tonemap tonemap, double x);
const char *tonemap_name(noc_tonemap tonemap);

/* Metadata of a file: the caller's and ours; the caller's win where the keys are equal. */
typedef struct meta_entry {
    const char *key, *value;
} meta_entry;
typedef struct meta_list {
    NOC_ARRAY(meta_entry) entries;
    noc_arena text;
} meta_list;
void meta_add(meta_list *list, const char *key, const char *fmt, ...) NOC_PRINTF(3, 4); /* ours, first; short text */
/* both outlive the list; NULL: no memory for it */
void meta_add_long(meta_list *list, const char *key, const char *value);
/* The caller's; replaces ours of the same key. An error where a key or value cannot be written, or memory was refused
 * to one of ours. */
noc_status meta_add_all(meta_list *list, const noc_image_meta *meta, const char *path, noc_log *log);
void meta_free(meta_list *list);

/* png.c, exr_read.c, exr_write.c and hdr.c. Readers take the whole file; name is for messages. */
noc_status image_write_png(output *o, const uint8_t *rgb, int width, int height, const meta_list *meta, noc_log *log);
/* The same in memory, in little time; what `to` held goes. */
typedef NOC_ARRAY(uint8_t) byte_buffer;
noc_status image_encode_png(byte_buffer *to, const uint8_t *rgb, int width, int height, noc_log *log);
noc_status image_write_exr(output *o, const noc_image *image, const meta_list *meta, noc_log *log);
noc_status image_write_exr_channel(output *o, const noc_channel *channel, const meta_list *meta, noc_log *log);
noc_image *image_read_png(const uint8_t *data, size_t size, const char *name, noc_log *log);
/* Its pixels as 8-bit sRGB, whatever is transparent in it, and its holes; `out` holds the size that is expected. */
noc_status image_read_png8(const uint8_t *data, size_t size, const char *name, int cutoff, noc_log *log,
                           pixel_bytes *out);
noc_image *image_read_exr(const uint8_t *data, size_t size, const char *name, noc_log *log);
noc_image *image_read_hdr(const uint8_t *data, size_t size, const char *name, noc_log *log);
bool image_is_hdr(const uint8_t *data, size_t size); /* by its first six bytes */
/* Any of them, told apart by their first bytes. is_linear may be NULL. */
noc_image *image_read_memory(const uint8_t *data, size_t size, const char *name, noc_log *log, bool *is_linear);

/* compare.c. Same size, and every pixel finite: a figure that silently left some out would not be one. */
noc_status image_check_pair(const noc_image *x, const noc_image *r, noc_log *log);

#endif
