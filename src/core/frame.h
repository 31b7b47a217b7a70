/* core/frame.h: what is the same for all pixels of a frame. render/ fills it once a frame from the options and the
 * cameras; kernels and shaders read nothing else of them. */
#ifndef CORE_FRAME_H
#define CORE_FRAME_H

#include "core/records.h"

/* A camera as rays use it, in the scene's local frame: the fields of struct camera, and the place of this frame's rays
 * in their pixels, 0..1. */
struct frame_camera {
    float eye[3];
    float right[3];
    float up[3];
    float forward[3];
    float inv_right2;
    float inv_up2;
    float width;
    float height;
    float jitter[2];
};

#if !defined(CORE_GLSL)
typedef struct frame_camera frame_camera;
#endif

#define FRAME_HISTORY 1u   /* the previous frame's reservoirs can be reused */
#define FRAME_EMITTERS 2u  /* emitters that are seen directly are shown */
#define FRAME_FINAL_RAY 4u /* shadow rays to what is shaded; without it nothing is shadowed */
#define FRAME_BIAS_RAYS 8u /* visibility is a part of the targets of a combination: core/reuse.h */

#define FRAME_ENVIRONMENT 16u /* a map is the background */
#define FRAME_MAP_LIGHTS 32u  /* a map lights, in the sky's place */
#define FRAME_MATTE 64u       /* surfaces without gloss */

#define MAX_NEIGHBOURS 20
#define SKY_RAYS 4          /* of a pixel that nothing but the sky lights */
#define REFERENCE_CHUNK 32u /* lights that the reference method sums at once */

/* How reservoirs are combined: core/reuse.h. */
#define BIAS_BIASED 0u
#define BIAS_MIS 1u
#define BIAS_PAIRWISE 2u
#define BIAS_COUNTED 3u

struct frame_constants {
    frame_camera camera;
    frame_camera previous; /* of the frame before */
    uint32_t width;
    uint32_t height;
    uint32_t blocks_x; /* blocks of 4x4 pixels in a row */
    uint32_t seed;
    uint32_t index; /* of the frame since the last reset: its random numbers */
    uint32_t flags;
    uint32_t bias;
    uint32_t draws;             /* M: candidates a pixel */
    uint32_t list;              /* lights of a tile's list */
    uint32_t tail;              /* draws from all others */
    uint32_t shadow_rays;       /* over a list, a pixel: a target */
    uint32_t uniform_every;     /* influence: of so many draws one is from all lights */
    uint32_t rays;              /* reference: shadow rays a pixel */
    uint32_t neighbours;        /* k: of the spatial passes */
    float influence;            /* S_r, m; 0: found for the scene */
    float radius;               /* pixels, of the neighbours */
    float m_max;                /* cap of M for history */
    float reject_depth;         /* relative distance to a neighbour's plane that rejects it */
    float reject_normal;        /* cosine between normals that rejects it */
    float sky;                  /* luminance at the zenith, cd/m2; 0: none */
    uint32_t environment_width; /* texels of the map that lights: core/environment.h */
    uint32_t environment_height;
    uint32_t backdrop_width; /* of the map that is seen */
    uint32_t backdrop_height;
    float environment_turn;          /* of its left edge, counter-clockwise from x, 0 to 1 */
    float environment_scale;         /* cd/m2 for 1 in the file */
    float environment_inverse_power; /* 1 over luminance summed over solid angles, as in the file */
    float environment_level;         /* what it lights an upward surface with, over pi: cd/m2 */
};

#if !defined(CORE_GLSL)
typedef struct frame_constants frame_constants;

RECORD_SIZE(frame_camera, 18);
RECORD_FIELD(frame_camera, eye, 0);
RECORD_FIELD(frame_camera, right, 3);
RECORD_FIELD(frame_camera, up, 6);
RECORD_FIELD(frame_camera, forward, 9);
RECORD_FIELD(frame_camera, inv_right2, 12);
RECORD_FIELD(frame_camera, inv_up2, 13);
RECORD_FIELD(frame_camera, width, 14);
RECORD_FIELD(frame_camera, height, 15);
RECORD_FIELD(frame_camera, jitter, 16);

RECORD_SIZE(frame_constants, 64);
RECORD_FIELD(frame_constants, camera, 0);
RECORD_FIELD(frame_constants, previous, 18);
RECORD_FIELD(frame_constants, width, 36);
RECORD_FIELD(frame_constants, height, 37);
RECORD_FIELD(frame_constants, blocks_x, 38);
RECORD_FIELD(frame_constants, seed, 39);
RECORD_FIELD(frame_constants, index, 40);
RECORD_FIELD(frame_constants, flags, 41);
RECORD_FIELD(frame_constants, bias, 42);
RECORD_FIELD(frame_constants, draws, 43);
RECORD_FIELD(frame_constants, list, 44);
RECORD_FIELD(frame_constants, tail, 45);
RECORD_FIELD(frame_constants, shadow_rays, 46);
RECORD_FIELD(frame_constants, uniform_every, 47);
RECORD_FIELD(frame_constants, rays, 48);
RECORD_FIELD(frame_constants, neighbours, 49);
RECORD_FIELD(frame_constants, influence, 50);
RECORD_FIELD(frame_constants, radius, 51);
RECORD_FIELD(frame_constants, m_max, 52);
RECORD_FIELD(frame_constants, reject_depth, 53);
RECORD_FIELD(frame_constants, reject_normal, 54);
RECORD_FIELD(frame_constants, sky, 55);
RECORD_FIELD(frame_constants, environment_width, 56);
RECORD_FIELD(frame_constants, environment_height, 57);
RECORD_FIELD(frame_constants, backdrop_width, 58);
RECORD_FIELD(frame_constants, backdrop_height, 59);
RECORD_FIELD(frame_constants, environment_turn, 60);
RECORD_FIELD(frame_constants, environment_scale, 61);
RECORD_FIELD(frame_constants, environment_inverse_power, 62);
RECORD_FIELD(frame_constants, environment_level, 63);
#endif

/* The constants of the frame at hand, in functions that take CTX; includers may say what that is. */
#if !defined(FRAME)
#if defined(CORE_GLSL)
#define FRAME frame
#else
#define FRAME (*ctx->frame)
#endif
#endif

#endif
