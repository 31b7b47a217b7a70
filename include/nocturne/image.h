/* nocturne/image.h: linear pictures, PNG, OpenEXR and Radiance HDR, exposure and tone mapping, error figures.
 *
 * A noc_image holds linear Rec.709 in cd/m2, three floats a pixel, rows from the top. */
#ifndef NOCTURNE_IMAGE_H
#define NOCTURNE_IMAGE_H

#include <nocturne/log.h>

#ifdef __cplusplus
extern "C" {
#endif

#define NOC_IMAGE_MAX_SIDE 32768

typedef struct noc_image {
    int width, height;
    float *rgb;       /* width * height * 3; owned */
    uint8_t *emitter; /* NULL, or width * height: 1 where the pixel, or one next to it, sees an emitter; owned */
    /* NULL, or width * height * 4: what emitters seen directly add to rgb, and the share of
     * the frames that saw one; owned. Displays alone look at it: noc_image_to_srgb8. Not kept in
     * files */
    float *coverage;
    /* What the file says that noc_image_read read it from: */
    char channel[32]; /* the name of a view ("class", "depth"), whose numbers are no light; "" of a picture */
    double ev100;     /* exposure that a PNG was written with; NaN where it is not told */
    /* it is for display alone (nocturne/smooth.h): files say so, under "smoothed", noc_image_read reads it from there,
     * and no figures are made of it */
    bool smoothed;
    /* of a smoothed still: its noise as estimated, relative to its light; else 0. Files say it, nothing reads it back
     */
    double smoothed_error;
} noc_image;

NOC_API noc_image *noc_image_create(int width, int height, noc_log *log); /* black; NULL after reporting an error */
NOC_API void noc_image_destroy(noc_image *image);
NOC_API bool noc_image_is_black(const noc_image *image); /* no pixel holds light; NULL is black */

typedef enum noc_tonemap { NOC_TONEMAP_FILMIC, NOC_TONEMAP_REINHARD, NOC_TONEMAP_LINEAR } noc_tonemap;

typedef struct noc_display_params {
    bool auto_exposure; /* default true */
    /* used when auto_exposure is false: luminance of 1.2 * 2^ev100 maps to 1 before tone mapping */
    double ev100;
    double compensation; /* stops added to the automatic exposure, positive is brighter; default 0 */
    noc_tonemap tonemap;
    double white_kelvin; /* K, held to 2500..15000; a black body of it is shown as the screen's white; default 3700;
                          * 0 is the screen's own, 6500 */
} noc_display_params;

#define NOC_DISPLAY_DEFAULTS(set) set(auto_exposure, true) set(tonemap, NOC_TONEMAP_FILMIC) set(white_kelvin, 3700)
#ifdef __cplusplus
NOC_DEFAULT_PARAMS(noc_display_params, noc_display_default_params, NOC_DISPLAY_DEFAULTS)
#else
#define noc_display_default_params() ((noc_display_params){ NOC_DISPLAY_DEFAULTS(NOC_DEFAULT_IN_C) })
#endif

/* Fills *ev100 from a number of -30 to 30, or from a camera's settings: "f/2.8,1/30,iso1600" is log2(N^2 / t) - log2(S
 * / 100), N the f-number, t the exposure time [s], S the sensitivity. Returns NULL, or what is wrong with the text: "is
 * neither ...". */
NOC_API const char *noc_exposure_read(const char *text, double *ev100);

/* The automatic exposure of a picture, as EV100. NaN when memory is refused (256 KiB). */
NOC_API double noc_image_auto_ev100(const noc_image *image);
/* 8-bit sRGB, 3 bytes a pixel into out (width * height * 3). Where the image has coverage, the emitter's part of a
 * pixel and the rest go through the tone curve apart and are mixed by the share that each covers, so that edges of
 * windows are as smooth as those of other things; the mean of both would be white wherever a window covers a tenth.
 * What fills no pixel, such as a lamp far away, is shown by that mean all the same: as the bright point that it is.
 * NOC_ERR_MEMORY, with out as it was, where the automatic exposure is refused its memory. */
NOC_API noc_status noc_image_to_srgb8(const noc_image *image, const noc_display_params *params, uint8_t *out);

/* Text recorded in the file: PNG tEXt / EXR string attributes. */
typedef struct noc_image_meta {
    size_t count;
    const char *const *keys;
    const char *const *values;
} noc_image_meta;

/* Writers write beside the target and rename at the end, so a failure or an interruption leaves no half-written file.
 * The format follows the name's ending, .png or .exr. EXR keeps linear float cd/m2 and the emitter mask; PNG is
 * displayed. */
NOC_API noc_status noc_image_write(const noc_image *image, const char *path, const noc_display_params *display,
                                   const noc_image_meta *meta, noc_log *log);
NOC_API noc_status noc_image_write_srgb8(const uint8_t *rgb, int width, int height, const char *path,
                                         const noc_image_meta *meta, noc_log *log);
/* Pictures as bytes in memory, for who sends many of them. An encoder keeps its memory from picture to picture, and is
 * for one thread at a time. */
typedef struct noc_image_encoder noc_image_encoder;
typedef enum noc_image_codec {
    NOC_IMAGE_JPEG, /* lossy: colours at half the resolution (4:2:0) */
    NOC_IMAGE_PNG   /* lossless, packed in little time rather than into few bytes */
} noc_image_codec;
NOC_API bool noc_image_codec_built(noc_image_codec codec); /* is it in this build? PNG always is */
/* NULL after reporting that there is no memory; the log must outlive it. */
NOC_API noc_image_encoder *noc_image_encoder_create(noc_log *log);
NOC_API void noc_image_encoder_destroy(noc_image_encoder *encoder); /* NULL is allowed */
/* Encodes 8-bit sRGB, rows from the top. quality: 1..100, of JPEG. *data is the encoder's until its next call. After an
 * error, which is reported, *data is NULL and *size 0: NOC_ERR_UNSUPPORTED where the build has no such codec (take PNG
 * then), NOC_ERR_ARGUMENT, NOC_ERR_MEMORY. */
NOC_API noc_status noc_image_encode_srgb8(noc_image_encoder *encoder, noc_image_codec codec, int quality,
                                          const uint8_t *rgb, int width, int height, const uint8_t **data,
                                          size_t *size);
/* Writes text into such a picture: letters of 5 x 7 pixels times scale (1 or more), from the left end of their top row
 * at (x, y) on; g, p, q and y reach two more pixels below. What falls outside is not drawn. text is UTF-8: ASCII,
 * superscript two and the multiplication sign are drawn, other characters as boxes. Returns how many pixels wide it is;
 * rgb may be NULL, to ask for that alone. 0 where text is NULL, or colour beside an rgb. */
#define NOC_TEXT_HEIGHT 7
NOC_API int noc_text_srgb8(uint8_t *rgb, int width, int height, int x, int y, const char *text, int scale,
                           const uint8_t colour[3]);
/* Could a file be written under this name? Makes and removes the writers' file beside it; the target is left alone. To
 * be asked before long work. */
NOC_API noc_status noc_image_check_path(const char *path, noc_log *log);
/* Reads by content: PNG, OpenEXR, Radiance HDR. PNG is taken as sRGB and turned linear with white = 1 (units are lost;
 * compare says so). */
NOC_API noc_image *noc_image_read(const char *path, noc_log *log, bool *is_linear);
/* What the metadata of a PNG or OpenEXR file says under that key, as noc_image_meta wrote it: *text is a copy (free
 * it), NULL where the file says nothing, and after an error. Its pixels are not read, nor more than its first MiB. */
NOC_API noc_status noc_image_read_text(const char *path, const char *key, char **text, noc_log *log);

/* Error figures of picture x against reference r (docs/estimator.md, "Error figures"). */
typedef struct noc_metrics {
    double rmse8;  /* 8-bit sRGB, 0..255, both shown with the reference's exposure */
    double rmse;   /* linear luminance, cd/m2 */
    double relmse; /* mean((x-r)^2 / (r^2 + e^2)), e = 1% of the reference's mean */
    double bias;   /* mean(x) / mean(r) */
    double mean_x, mean_r;
    size_t pixels;
    size_t unlit;        /* pixels that are 0 in r and lit in x: in relmse each counts (x / e)^2 */
    double relmse_unlit; /* their part of relmse */
} noc_metrics;

typedef struct noc_comparison {
    noc_metrics all;         /* every pixel */
    noc_metrics all_clamped; /* both clamped to ceiling */
    noc_metrics dark;        /* pixels that see no emitter within one pixel (needs a mask in r, else equal to all) */
    noc_metrics dark_clamped;
    double ceiling; /* cd/m2 */
    double ev100;   /* exposure of both pictures in RMSE-8; without meaning where they are relative */
    bool has_mask;
} noc_comparison;

typedef struct noc_compare_params {
    double ceiling;             /* cd/m2; default 10 */
    noc_display_params display; /* for RMSE-8 */
    /* both pictures have no unit but white = 1, as noc_image_read gives PNG: RMSE-8 takes
     * them as they were displayed, without exposure or tone map, and luminances are shares
     * of white */
    bool relative;
} noc_compare_params;

#define NOC_COMPARE_DEFAULTS(set)                                                                                      \
    set(ceiling, 10) set(display.auto_exposure, true) set(display.tonemap, NOC_TONEMAP_FILMIC)                         \
        set(display.white_kelvin, 6500)
#ifdef __cplusplus
NOC_DEFAULT_PARAMS(noc_compare_params, noc_compare_default_params, NOC_COMPARE_DEFAULTS)
#else
#define noc_compare_default_params() ((noc_compare_params){ NOC_COMPARE_DEFAULTS(NOC_DEFAULT_IN_C) })
#endif

NOC_API noc_status noc_image_compare(const noc_image *x, const noc_image *r, const noc_compare_params *params,
                                     noc_comparison *out, noc_log *log);
/* A number or a vector a pixel that is no colour, such as a view of the light sampling (noc_view_aov). Rows from
 * the top. */
typedef enum noc_channel_scale {
    NOC_CHANNEL_LINEAR,
    NOC_CHANNEL_LOG,   /* best shown by a colour bar with even steps, or even ratios */
    NOC_CHANNEL_LABELS /* numbers are names: each is shown in a colour of its own */
} noc_channel_scale;

typedef struct noc_channel {
    int width, height;
    int components; /* 1, or 3: a vector a pixel, of unit length where unit is "" */
    float *value;   /* width * height * components, owned; where there is none -1 (vectors: 0 0 0) */
    noc_channel_scale scale;
    /* "rays", "rays a pixel"; unit "" for plain ratios and labels. These and title are not owned */
    const char *name, *unit;
    const char *title; /* what the numbers are, for the legend: Latin-1 */
    /* of NOC_CHANNEL_LABELS, names of the numbers 0 to label_count - 1: ASCII; not owned. NULL: none */
    const char *const *labels;
    size_t label_count;
    const uint32_t *label_numbers; /* the names are of these numbers, and others have none; not owned. NULL: of 0, 1 */
    const uint8_t (*label_colours)[3]; /* label_count of them, 8-bit sRGB; not owned. NULL: any that differ */
} noc_channel;

/* None all over; NULL after reporting an error. */
NOC_API noc_channel *noc_channel_create(int width, int height, int components, noc_log *log);
NOC_API void noc_channel_destroy(noc_channel *channel);

typedef enum noc_bar_scale { NOC_BAR_OF_CHANNEL, NOC_BAR_LINEAR, NOC_BAR_LOG } noc_bar_scale;
/* The picture over its legend, or one of them alone. */
typedef enum noc_channel_part { NOC_CHANNEL_WHOLE, NOC_CHANNEL_PICTURE, NOC_CHANNEL_LEGEND } noc_channel_part;

#define NOC_ISOLINES 32 /* of a picture at most */

/* Lines where the numbers, smoothed over 5 x 5 pixels against noise (of wide pictures over more), pass these values,
 * and do not jump. A bar whose ends are found reaches to them. */
typedef struct noc_isolines {
    double value[NOC_ISOLINES]; /* count of them, above 0, rising */
    int count;
    int round; /* without any: about so many, at round values within the bar */
} noc_isolines;

/* Reads "5,7.5,10" as values (one of them: "5,"), and "6" as that many round ones; "0" are none. false: it is neither,
 * and lines are as they were. */
NOC_API bool noc_isolines_parse(const char *text, noc_isolines *lines);
/* Writes what noc_isolines_parse reads; the length, as snprintf has it. */
NOC_API int noc_isolines_text(const noc_isolines *lines, char *text, size_t size);

/* A colour bar: its ends, round numbers within them, and the isolines. */
#define NOC_BAR_TICKS 16
typedef struct noc_bar {
    double low, high;
    bool logarithmic;
    int tick_count, isoline_count;
    double ticks[NOC_BAR_TICKS], isolines[NOC_ISOLINES];
} noc_bar;

/* How numbers are shown. All 0, and NULL, is as the channel says. */
typedef struct noc_channel_params {
    double low, high;    /* values at the ends of the colour bar; equal: taken from the channel */
    noc_bar_scale scale; /* of the bar, in place of noc_channel.scale */
    /* That of the picture before: ends that are taken from the channel stay those, so that colours keep their meanings,
     * until the numbers reach a quarter beyond them, or a third of the way alone. NULL: there was none */
    const noc_bar *last;
    noc_isolines isolines;
    noc_channel_part part;
    int legend_width; /* pixels that a legend alone has at least; 0: as under the picture */
} noc_channel_params;

/* In colours, with a legend below: a bar, or the names of those labels that are seen, where labels have names. Pixels
 * without a value are grey, vectors are (v + 1) / 2 as red, green, blue. Isolines have their values written beside
 * them, and below the bar. 8-bit sRGB, *out is malloc'ed (free it), its size in *width, *height. NULL params: the bar's
 * ends are round numbers around all but the lowest and highest half percent. A picture of 1280 x 720 takes some
 * milliseconds (bench/bench_channel). */
NOC_API noc_status noc_channel_to_srgb8(const noc_channel *channel, const noc_channel_params *params, uint8_t **out,
                                        int *width, int *height, noc_log *log);

/* The bar that a picture of these params has, for a legend of one's own, and for `last` of the next picture.
 * NOC_ERR_ARGUMENT after reporting: labels and vectors have none, or what the params say cannot be. */
NOC_API noc_status noc_channel_bar(const noc_channel *channel, const noc_channel_params *params, noc_bar *bar,
                                   noc_log *log);
NOC_API void noc_bar_colour(double at, uint8_t rgb[3]); /* of every bar: at 0 its low end, at 1 its high one */
/* The colour of a number that is a name: it depends on that alone, and on the names and colours that the channel has
 * for it. A NULL channel has none: so colours of NOC_AOV_LIGHT and NOC_AOV_INFLUENTIAL are those of NULL. */
NOC_API void noc_label_colour(const noc_channel *channel, uint32_t label, uint8_t rgb[3]);
/* By the name's ending: .png in colours, as above; .exr with the numbers, floats in one channel "Y" (vectors: "X", "Y",
 * "Z"), the unit as "units". The metadata of both have the name as "channel", and the names of labels as "labels":
 * "1 wall #c08060, ..." (EXR: without the colour). */
NOC_API noc_status noc_channel_write(const noc_channel *channel, const char *path, const noc_channel_params *params,
                                     const noc_image_meta *meta, noc_log *log);

/* How the difference of two pictures is shown. All 0, and NULL: with a legend, ends found from the two. */
typedef struct noc_difference_params {
    const char *unit;    /* of the legend, Latin-1; NULL: cd/m2 */
    double limit;        /* difference at the ends of the bar; 0: found, so that 99 % of the pixels lie within */
    const noc_bar *last; /* as noc_channel_params has it */
    noc_channel_part part;
} noc_difference_params;

/* Signed difference of luminance in a diverging colour map (blue: x darker, red: x brighter), as 8-bit sRGB. *out is
 * malloc'ed (free it), its size in *width, *height. */
NOC_API noc_status noc_image_difference(const noc_image *x, const noc_image *r, const noc_difference_params *params,
                                        uint8_t **out, int *width, int *height, noc_log *log);
/* The bar of that picture. */
NOC_API noc_status noc_image_difference_bar(const noc_image *x, const noc_image *r, const noc_difference_params *params,
                                            noc_bar *bar, noc_log *log);
NOC_API void noc_difference_colour(double at, uint8_t rgb[3]); /* of its bar: at 0 its low end, at 1 its high one */

#ifdef __cplusplus
}
#endif
#endif
