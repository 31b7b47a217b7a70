/* render/plan: the passes of a frame as data. A plan is made from the options, and from whether there is a map;
 * backends walk it and decide nothing. Two tables stand behind it: what each buffer is, and what each pass reads,
 * writes and traces. */
#ifndef NOC_PLAN_H
#define NOC_PLAN_H

#include "base/base.h"
#include <nocturne/render.h>

/* What passes work on. The first of a kind is this frame's. */
typedef enum noc_buffer {
    NOC_BUFFER_SURFACES,     /* the G-buffer: what receivers see */
    NOC_BUFFER_PREVIOUS,     /* that of the frame before */
    NOC_BUFFER_LIST,         /* a tile's light list, or the lights that its points found */
    NOC_BUFFER_SHARED_RAYS,  /* rays that the pixels of a tile share out over its list, and what they found */
    NOC_BUFFER_RESERVOIRS,   /* the target's set of reservoirs, and which of their samples are known to be unoccluded */
    NOC_BUFFER_SOURCE,       /* the set that reuse reads */
    NOC_BUFFER_CACHE,        /* the visibility cache */
    NOC_BUFFER_OBSERVATIONS, /* what the frame's rays will tell it */
    NOC_BUFFER_COLOUR,       /* of the frame being made */
    NOC_BUFFER_PICTURE,      /* the mean of frames */
    NOC_BUFFER_COUNT
} noc_buffer;

/* An item of a buffer, or of a pass. */
typedef enum noc_domain {
    NOC_DOMAIN_PIXEL,
    NOC_DOMAIN_TILE, /* 16 x 16 pixels */
    NOC_DOMAIN_VIEW, /* all of a view: it is of places in the scene, whatever the picture's size */
} noc_domain;

typedef enum noc_lifetime {
    NOC_LIVES_TILE,  /* until the tile's passes of the stage are through: scratch */
    NOC_LIVES_FRAME, /* until the frame is complete */
    NOC_LIVES_ON,    /* the next frame reads it */
} noc_lifetime;

typedef struct noc_buffer_row {
    const char *name;
    noc_domain domain;
    noc_lifetime lifetime;
    int bytes; /* an item; 0: it depends on the picker, or on what was found */
} noc_buffer_row;

typedef enum noc_rays {
    NOC_RAYS_NONE,
    NOC_RAYS_CLOSEST,   /* nearest hits */
    NOC_RAYS_OCCLUSION, /* whether something lies between two points */
} noc_rays;

/* What a pass does to buffers: bits 1 << noc_buffer. */
typedef struct noc_pass_row {
    const char *name;
    noc_domain domain;
    uint32_t reads, writes;
    uint32_t others; /* of those read: at other pixels than the pass's own tile has */
    noc_rays rays;
} noc_pass_row;

extern const noc_buffer_row noc_buffers[NOC_BUFFER_COUNT];
extern const noc_pass_row noc_passes[NOC_PASS_COUNT];

/* Passes that may be run tile by tile, one after the other: none of them looks at another tile's buffer that an earlier
 * one of them, or one after it, writes. */
typedef struct noc_stage {
    noc_pass passes[12];
    int count;
    int source, target;      /* sets of reservoirs: read from other pixels; worked on and left behind */
    int round;               /* number of the spatial pass */
    bool resolve_visibility; /* reuse leaves no sample whose visibility at its own pixel is unknown */
} noc_stage;

/* Sets of reservoirs. A backend holds NOC_RESERVOIR_SETS of them, or as many as it was told. */
enum { NOC_RESERVOIR_SETS = 3, NOC_MAX_STAGES = 8 };

typedef struct noc_plan {
    noc_stage stages[NOC_MAX_STAGES];
    int count;
    int sets;         /* reservoir sets that are used */
    int next_history; /* set that feeds the next frame, -1: none */
    bool draws;       /* candidates, from what `candidates` names */
    noc_candidates candidates;
    int candidate_count;  /* a pixel */
    bool shares_rays;     /* lists: several rays a pixel over the entries of a list */
    bool mixes;           /* a pixel's light is shared between its reservoir and its shared rays */
    bool learns;          /* shared rays are steered by the visibility cache, and feed it */
    bool previous_lights; /* reuse asks for lights as they were in the frame before */
} noc_plan;

/* What to run for these parameters. map: the scene has one around it. history_set: set with the previous frame's
 * reservoirs, -1: none. surfaces: the frame's G-buffer is there already. */
void noc_plan_make(const noc_render_params *params, bool map, int history_set, bool surfaces, noc_plan *plan);

/* Is visibility a part of the target functions that reuse weighs with? Passes are told by FRAME_BIAS_RAYS. */
bool noc_uses_bias_rays(const noc_render_params *params);

/* Is the pass run where the scene has no lights? */
bool noc_pass_without_lights(noc_pass pass);

/* Does a stage of the plan have the pass? */
bool noc_stage_has(const noc_stage *stage, noc_pass pass);

#endif
