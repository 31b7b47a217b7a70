/* Bridges between core/ and buffers of the device: the record of addresses that a dispatch gets, and what core reads
 * through it. A shader includes this first. */
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

#define CORE_GLSL 1
#define HERE push.binding
#define FRAME HERE.frame.constants
#include "core/dialect.h"
#include "core/records.h"
#include "core/frame.h"
#include "core/blocks.h"
#include "backend/vulkan/records.h"

#define NO_HIT 0xffffffffu

/* Candidates that blocks share, 16 a row: presample_row of backend/cpu/kernels.h. */
struct sample_row {
    float x[3][BLOCK];
    float normal[3][BLOCK];
    float shine[3][BLOCK];
    float bare[BLOCK];
    float sided[BLOCK];
    float close2[BLOCK];
    float radius[BLOCK];
    float inverse[BLOCK];
    uint light[BLOCK];
    uint place[BLOCK];
};

/* Nearest hits of a block's rays. */
struct hit_block {
    uint triangle[BLOCK]; /* gl_PrimitiveID; 0xffffffff: none */
    uint entry[BLOCK];    /* of the TLAS */
    float u[BLOCK];
    float v[BLOCK];
    float t[BLOCK];
};

#define ARRAY(name, type) layout(buffer_reference, scalar, buffer_reference_align = 4) buffer name { type at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Frame { frame_constants constants; };
ARRAY(Lights, light_record)
ARRAY(Materials, material_record)
ARRAY(Floats, float)
ARRAY(Words, uint)
ARRAY(Instances, vk_instance_record)
ARRAY(Panes, vk_pane_record)
ARRAY(Backs, placing_back)
ARRAY(Facades, facade_record)

/* vk_entry */
struct tlas_entry {
    Words order; /* the scene's triangle numbers, by gl_PrimitiveID */
    uint instance;
    uint placed;
};
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer Entries { tlas_entry at[]; };
ARRAY(SurfaceBlocks, gblock)
ARRAY(ReservoirBlocks, rblock)
ARRAY(ColourBlocks, cblock)
ARRAY(Coverages, vec4)
ARRAY(RayBlocks, rayblock)
ARRAY(HitBlocks, hit_block)
ARRAY(SampleRows, sample_row)

#define ADDRESS_FIELD(type, name) type name;
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer Binding {
    VK_BINDING(ADDRESS_FIELD, ADDRESS_FIELD)
};
layout(push_constant, scalar) uniform Push { Binding binding; } push;

/* ---- what core reads ---- */

#include "core/light.h"

light light_load(uint i) { return light_of_record(HERE.lights.at[i]); }
light light_splat(uint i) { return light_load(i); }
light past_light_load(uint i) { return light_of_record(HERE.past_lights.at[i]); }
profile_cell profile_load(uint i) {
    uint at = 4u * i;
    return profile_cell(HERE.profiles.at[at], HERE.profiles.at[at + 1u], HERE.profiles.at[at + 2u],
                        HERE.profiles.at[at + 3u]);
}

#include "core/camera.h"
#include "core/random.h"
#include "core/receiver.h"
#include "core/reservoir.h"
#include "core/alias.h"

alias_slot slot_of(Words slots, uint i) {
    uint at = 4u * i;
    return alias_slot(uintBitsToFloat(slots.at[at]), slots.at[at + 1u], uintBitsToFloat(slots.at[at + 2u]),
                      uintBitsToFloat(slots.at[at + 3u]));
}
alias_slot alias_load(uint i) { return slot_of(HERE.alias, i); }
alias_slot environment_slot(uint i) { return slot_of(HERE.environment_slots, i); }
vec3 three_of(Floats f, uint i) {
    uint at = 3u * i;
    return vec3(f.at[at], f.at[at + 1u], f.at[at + 2u]);
}
vec3 environment_texel(uint i) { return three_of(HERE.environment, i); }
vec3 backdrop_texel(uint i) { return three_of(HERE.backdrop, i); }
float environment_sine(uint i) { return HERE.environment_sines.at[i]; }

/* ---- pixels ---- */

/* A pixel of the picture's blocks: lane `lane` of block `block`. `slot` numbers it. */
struct place {
    uint block;
    uint lane;
    uint slot;
    uint x;
    uint y;
    bool inside; /* the picture, which need not fill its last blocks */
};

place place_at(uint x, uint y) {
    place p;
    p.x = x;
    p.y = y;
    p.block = (y >> 2) * FRAME.blocks_x + (x >> 2);
    p.lane = (y & 3u) * 4u + (x & 3u);
    p.slot = p.block * BLOCK + p.lane;
    p.inside = x < FRAME.width && y < FRAME.height;
    return p;
}

/* The pixel of lane `column % 16` in block `column / 16` of a row of blocks. */
place place_in_row(uint column, uint row) {
    uint lane = column % BLOCK;
    return place_at((column / BLOCK) * 4u + (lane & 3u), row * 4u + (lane >> 2));
}

uint key_at(place p, uint index) { return rng_key(FRAME.seed, p.y * FRAME.width + p.x, index); }

receiver receiver_at(SurfaceBlocks g, uint block, uint l) {
    receiver r;
    r.p = vec3(g.at[block].px[l], g.at[block].py[l], g.at[block].pz[l]);
    r.n = vec3(g.at[block].nx[l], g.at[block].ny[l], g.at[block].nz[l]);
    r.depth = g.at[block].depth[l];
    r.material = g.at[block].material[l];
    r.light = g.at[block].light[l];
    return r;
}

void receiver_put(SurfaceBlocks g, uint block, uint l, receiver r, uint texel) {
    g.at[block].px[l] = r.p.x;
    g.at[block].py[l] = r.p.y;
    g.at[block].pz[l] = r.p.z;
    g.at[block].nx[l] = r.n.x;
    g.at[block].ny[l] = r.n.y;
    g.at[block].nz[l] = r.n.z;
    g.at[block].depth[l] = r.depth;
    g.at[block].material[l] = r.material;
    g.at[block].light[l] = r.light;
    g.at[block].texel[l] = texel;
}

reservoir reservoir_at(ReservoirBlocks r, uint block, uint l) {
    return reservoir(r.at[block].light[l], r.at[block].u[l], r.at[block].v[l], r.at[block].w[l], r.at[block].m[l],
                     r.at[block].p[l]);
}

void reservoir_put(ReservoirBlocks r, uint block, uint l, reservoir q) {
    r.at[block].light[l] = q.light;
    r.at[block].u[l] = q.u;
    r.at[block].v[l] = q.v;
    r.at[block].w[l] = q.w;
    r.at[block].m[l] = q.m;
    r.at[block].p[l] = q.p;
}

vec3 colour_at(ColourBlocks c, place p) {
    return vec3(c.at[p.block].rgb[0][p.lane], c.at[p.block].rgb[1][p.lane], c.at[p.block].rgb[2][p.lane]);
}

void colour_put(ColourBlocks c, place p, vec3 rgb) {
    c.at[p.block].rgb[0][p.lane] = rgb.x;
    c.at[p.block].rgb[1][p.lane] = rgb.y;
    c.at[p.block].rgb[2][p.lane] = rgb.z;
}

/* ---- counters ---- */

void count_one(uint kind, uint at) { atomicAdd(HERE.counters.at[kind * VK_COUNTERS + at % VK_COUNTERS], 1u); }

/* ---- rays ---- */

/* The pixel in a band whose rays are kept for it alone. */
uint slot_in_band(place p) { return p.slot - HERE.first_row * FRAME.blocks_x * BLOCK; }

/* Segment i of a pixel, o to o + d; without `on` there is none. Shaders of other rays than shadow rays define
 * UNCOUNTED. */
void ray_put(place p, uint i, bool on, vec3 o, vec3 d) {
    uint slot = i * HERE.slots + p.slot;
    HERE.answers.at[slot] = on ? VK_ANSWER_WANTED : VK_ANSWER_NONE;
    if (!on)
        return;
#if !defined(UNCOUNTED)
    if ((HERE.views & VK_VIEW_RAYS) != 0u)
        atomicAdd(HERE.view_rays.at[p.block * BLOCK + p.lane], 1u);
#endif
    uint block = slot / BLOCK;
    for (int k = 0; k < 3; k++) {
        HERE.rays.at[block].o[k][p.lane] = o[k];
        HERE.rays.at[block].d[k][p.lane] = d[k];
    }
}
