/* nocturne/smooth.h: moving pictures for the eye. A smoother takes the frames of a view one after the other, each
 * alone, and makes of each a picture that is calm: light is accumulated along motion vectors, and a filter that its
 * variance guides takes what noise is left (docs/animation.md, "Smoothing").
 *
 * It is for display alone. It is biased: light is blurred where its noise hides its edges, and what changes is seen
 * some frames late. Its pictures say so: noc_image.smoothed, which noc_image_write writes into files, and
 * noc_image_compare refuses. */
#ifndef NOCTURNE_SMOOTH_H
#define NOCTURNE_SMOOTH_H

#include <nocturne/render.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What noc_render_params.aovs must have for frames that are smoothed. */
#define NOC_SMOOTH_AOVS (1u << NOC_AOV_MOTION)

typedef struct noc_smooth_params {
    /* frames that a moving picture remembers, 1..256; while nothing moves at all it remembers more, and comes to the
     * mean of frames */
    int history;
    int passes; /* of the filter, 0..6, each over twice the distance of the one before; 0: no filter */
    bool
        antialias; /* the finished picture is accumulated, too, over a few frames: edges and small lamps flicker less */
} noc_smooth_params;

#define NOC_SMOOTH_DEFAULTS(set) set(history, 32) set(passes, 5) set(antialias, true)
#ifdef __cplusplus
NOC_DEFAULT_PARAMS(noc_smooth_params, noc_smooth_default_params, NOC_SMOOTH_DEFAULTS)
#else
#define noc_smooth_default_params() ((noc_smooth_params){ NOC_SMOOTH_DEFAULTS(NOC_DEFAULT_IN_C) })
#endif

/* Threads. A smoother belongs to one thread at a time, that of the view whose frames it takes: no call of the view may
 * run during a step. The device's threads do the work. The picture of a step is the smoother's. */
typedef struct noc_smoother noc_smoother;

/* The device must outlive it. About 265 bytes a pixel, made with the first step. NULL after reporting an error. */
NOC_API noc_smoother *noc_smoother_create(noc_device *device);
NOC_API void noc_smoother_destroy(noc_smoother *smoother);

/* Takes the last complete frame of a view of the same device, alone, whether or not the view averages frames, and
 * returns what is to be shown: linear Rec.709, cd/m2, with coverage and emitters. It stays as it is until the next call
 * with this smoother. NULL params are the defaults. Each frame of the view is to be taken once, in its turn; taken
 * again it gives the same picture. Where one was left out, another view is given, or the view was reset, the smoother
 * begins anew. A change of the picture's size keeps what it knows, and needs memory; nothing else does. NULL after
 * reporting an error: there is no frame, it has not kept NOC_SMOOTH_AOVS, parameters, another device, memory. */
NOC_API const noc_image *noc_smoother_step(noc_smoother *smoother, noc_view *view, const noc_smooth_params *params);
/* Forgets all frames. */
NOC_API void noc_smoother_reset(noc_smoother *smoother);

/* Stills: the mean of a view's frames at rest. What noc_render_params.aovs must have for noc_view_smoothed, by method,
 * candidates and accumulate, in every frame of the mean. 0: there is nothing to smooth (headlight). NULL params are the
 * defaults. */
NOC_API uint32_t noc_still_aovs(const noc_render_params *params);

#define NOC_STILL_BYTES 88 /* a pixel */
/* The picture of the view's frames, as noc_view_image has it, with less noise: the light of a pixel's surface is a
 * regression over the pixels around that see the same one, on what the lists of lights expect there (docs/animation.md,
 * "Smoothed stills"). With more frames it comes to their mean. The caller's, noc_image_destroy; while it is made it
 * takes NOC_STILL_BYTES a pixel beside. Its noise is estimated from that of the frames (noc_image.smoothed_error). NULL
 * after reporting an error: there is no frame, or one was begun and dropped since; its aovs lack noc_still_aovs;
 * memory. */
NOC_API noc_image *noc_view_smoothed(noc_view *view);

#ifdef __cplusplus
}
#endif
#endif
