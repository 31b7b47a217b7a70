/* Views of the light sampling (noc_aov), for every backend: what a frame gathers while it is made, and what is kept
 * once it is complete. Passes write to what is gathered and read nothing of it, so a view cannot change the picture. */
#ifndef NOC_FRAME_VIEWS_H
#define NOC_FRAME_VIEWS_H

#include "core/blocks.h"
#include "render/backend.h"
#include "render/past.h"

#define NOC_AOV_BIT(aov) (1u << NOC_AOV_##aov)
/* The four views of emitters share the buffers of NOC_AOV_INFLUENTIAL. */
#define NOC_AOV_BITS_EMITTERS                                                                                          \
    (NOC_AOV_BIT(INFLUENTIAL) | NOC_AOV_BIT(INFLUENTIAL_SHARE) | NOC_AOV_BIT(RUNNER_UP) | NOC_AOV_BIT(RUNNER_UP_SHARE))

/* Views of the frame being made, and of the last complete one, which stay until the next is complete. Entries that
 * neither asks for are NULL. Zero-initialise. */
typedef struct noc_views {
    float (*made[NOC_AOV_COUNT])[BLOCK], (*kept[NOC_AOV_COUNT])[BLOCK];
    uint32_t asked, held; /* bits: buffers that the frame being made works on, that a complete frame has left */
    uint64_t frames;      /* in the moments of the luminance */
    /* illuminance: bits of which of red, green and blue the lights have (core/measured.h); of the scene after
     * `coloured`
     * - 1 commits */
    uint32_t light_colours;
    uint64_t coloured;
    /* influential: of each light of the scene the first one of its emitter; of these versions of the scene */
    float *emitter_labels;
    size_t emitter_label_count;
    uint64_t labelled[2];
} noc_views;

/* A frame, as arrays with an entry a block of 4x4 pixels. */
typedef struct noc_frame_blocks {
    const noc_scene *scene;
    noc_pool *pool;
    int width, height, blocks_x, blocks_y;
    const gblock *g;
    const rblock *r; /* reservoirs that were shaded */
    const cblock *colour, *picture;
    const uint32_t (*instance)[BLOCK]; /* NULL: none is seen */
    const uint16_t *emitter;           /* lanes that saw an emitter in a frame of the mean */
    const noc_past *past;              /* as it was while the frame was made */
    const noc_placings *placings;
} noc_frame_blocks;

/* frame_views.c */
/* Arrays of a block: gathered by passes, and kept. */
size_t noc_views_made_entries(int aov);
size_t noc_views_bytes(uint32_t aovs); /* a pixel */
/* Buffers that passes gather into where these views are asked for: bits. */
uint32_t noc_views_gathered(uint32_t aovs);
/* What a frame leaves that these views are made of, or rows where they are kept. */
bool noc_views_need_surfaces(uint32_t aovs);
bool noc_views_need_reservoirs(uint32_t aovs);
bool noc_views_need_colour(uint32_t aovs);
/* Before a frame that asks for these views: room for them, and the value that each gathered one begins with. */
noc_status noc_views_begin(noc_views *v, const noc_scene *scene, const noc_frame_blocks *b, uint32_t aovs,
                           noc_log *log);
float noc_views_start(int aov); /* that value */
/* A lane sees the scene's triangle, which the instance or body of that number shows. */
void noc_views_note_triangle(const noc_views *v, const noc_scene *scene, uint32_t triangle, uint32_t instance,
                             size_t block, int lane);
/* The frame is complete: before its lights and surfaces become those of the frame before. */
void noc_views_keep(noc_views *v, const noc_frame_blocks *b, const noc_frame *frame);
/* As noc_backend.aov; b: the last complete frame. */
bool noc_views_read(const noc_views *v, const noc_frame_blocks *b, noc_aov aov, float *value);
void noc_views_free(noc_views *v);

/* view_rows.c: as noc_backend.rows. */
void noc_views_rows(const noc_views *v, const noc_frame_blocks *b, const frame_camera *camera,
                    const noc_frame_rows *rows);

/* view_sources.c: views that sum light up as it is shaded */
/* Labels of lights that a pixel has slots for. With their sums they are twice as many arrays; behind those of emitters
 * is the sky's sum. */
size_t noc_source_slots(int aov); /* 0: the view has none */
size_t noc_source_entries(int aov);
/* Do any of the views of where light comes from gather? */
bool noc_views_note_sources(const noc_views *v);
/* Light of a block's lanes, by the lights that it is of; by the sky. */
void noc_views_note(const noc_views *v, const noc_scene *scene, const uint32_t *light, const cblock *c, uint32_t lanes,
                    size_t block);
void noc_views_note_sky(const noc_views *v, const cblock *c, uint32_t lanes, size_t block);
/* Lanes whose illuminance is summed up. */
uint32_t noc_views_measured(const float *lux);
/* Before a frame that asks for illuminance, or for emitters. */
void noc_views_find_light_colours(noc_views *v, const noc_scene *scene);
noc_status noc_views_label_emitters(noc_views *v, const noc_scene *scene, noc_log *log);
/* The frame is complete; fresh: bits of views whose sums begin with it. */
void noc_views_keep_sources(noc_views *v, size_t block, uint32_t fresh);
/* NOC_AOV_ILLUMINANCE, NOC_AOV_EXPECTED; -1: no frame saw a surface. */
float noc_views_mean(const noc_views *v, noc_aov aov, size_t block, int lane);
/* One of the views of where light comes from; -1: there is none. */
float noc_views_source(const noc_views *v, noc_aov aov, size_t block, int lane);

#endif
