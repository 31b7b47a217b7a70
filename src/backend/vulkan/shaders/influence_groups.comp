#version 460
/* Which points of a tile ask the influence volumes as one (core/influence_find.h), and its pixels in sixteens
 * (core/influence_cut.h). 3 barriers a group. */
#extension GL_GOOGLE_include_directive : require
#include "list_group.glsl"
#include "bridge.glsl"
#include "tile.glsl"
#include "influence.glsl"
#include "core/influence_cut.h"

#define PENDING 0xffffffffu
#define NOBODY 256u

shared float point_[6][256]; /* place, normal */
shared uint of_[256];        /* groups; 0: does not ask */
shared uint next_;           /* the first point that has not asked; NOBODY */
shared uint lanes_[16];
shared uint place_[FOUND_MOST_GROUPS + 1];
shared uint pixel_[256];
shared influence_sixteen sixteen_[CUT_SIXTEENS];
shared uint sixteens_;

vec3 point_three(uint i, uint k) { return vec3(point_[k][i], point_[k + 1u][i], point_[k + 2u][i]); }

/* ---- core's bridges ---- */

uint cut_lanes(uint block) { return lanes_[block]; }
uint cut_group(uint block, uint lane) { return of_[16u * block + lane]; }
void cut_place_store(uint group, uint place) { place_[group] = place; }
uint cut_place(uint group) { return place_[group]; }
void cut_pixel_store(uint place, uint pixel) { pixel_[place] = pixel; }
uint cut_pixel(uint place) { return pixel_[place]; }
void sixteen_store(uint i, influence_sixteen s) { sixteen_[i] = s; }
influence_sixteen sixteen_load(uint i) { return sixteen_[i]; }

/* ---- groups ---- */

void load_points() {
    EACH_INDEX(i, 256u) {
        receiver r = receiver_none();
        if (i / 16u < tile_blocks_)
            r = receiver_at(HERE.surfaces, block_of_tile(i / 16u), i % 16u);
        of_[i] = receives(r) ? PENDING : 0u;
        for (uint k = 0u; k < 3u; k++) {
            point_[k][i] = r.p[k];
            point_[k + 3u][i] = r.n[k];
        }
    }
}

/* Points that are close to the first one that is left ask with it. Returns how many groups there are. */
uint make_groups(float close) {
    uint groups = 1u;
    for (;;) {
        settle();
        if (FIRST_WORKER)
            next_ = NOBODY;
        settle();
        EACH_INDEX(i, 256u)
            if (of_[i] == PENDING)
                atomicMin(next_, i);
        settle();
        uint first = next_;
        if (first == NOBODY)
            return groups;
        EACH_INDEX(i, 256u)
            if (of_[i] == PENDING && (i == first || points_close(point_three(first, 0u), point_three(first, 3u),
                                                                 point_three(i, 0u), point_three(i, 3u), close)))
                of_[i] = groups;
        groups++;
    }
}

void store_three(uint at, uint step, vec3 x) {
    for (uint k = 0u; k < 3u; k++)
        tile_store(at + k * step, x[k]);
}

/* The query of each group; after the last one, that of the tile. */
void store_queries(uint groups, near_query none) {
    EACH_INDEX(g, groups + 1u) {
        near_query q = none;
        uint points = 0u;
        for (uint i = 0u; i < 256u; i++)
            if (of_[i] != 0u && (of_[i] == g || g == groups)) {
                q = near_add_point(q, point_three(i, 0u), point_three(i, 3u));
                points++;
            }
        if (g < groups) {
            store_three(group_word(g, GROUP_LO), FOUND_MOST_GROUPS, q.lo);
            store_three(group_word(g, GROUP_HI), FOUND_MOST_GROUPS, q.hi);
            store_three(group_word(g, GROUP_N), FOUND_MOST_GROUPS, q.n);
            tile_store(group_word(g, GROUP_BACK), q.back);
            tile_store(group_word(g, GROUP_LEAST), q.least);
            tile_store(group_word(g, GROUP_COUNT), 0u);
            tile_store(group_word(g, GROUP_FROM), 0u);
            tile_store(group_word(g, GROUP_POINTS), points);
        } else {
            store_three(FOUND_BOX, 1u, q.lo);
            store_three(FOUND_BOX + 3u, 1u, q.hi);
        }
    }
}

/* ---- sixteens ---- */

void cut(uint groups) {
    EACH_INDEX(b, 16u) {
        uint bits = 0u;
        for (uint l = 0u; l < 16u; l++)
            bits |= (of_[16u * b + l] != 0u ? 1u : 0u) << l;
        lanes_[b] = bits;
    }
    settle();
    if (FIRST_WORKER) {
        sixteens_ = cut_tile(tile_blocks_, groups);
        tile_store(FOUND_SETS, cut_sets(sixteens_));
        tile_store(FOUND_GROUPS, groups);
    }
    settle();
}

/* Sixteens of one set have one group, or the set is one's alone. */
void store_lane(influence_sixteen s, uint lane) {
    uint pixel = 16u * s.block + lane;
    uint group = s.group;
    if (s.block == CUT_SEVERAL)
        pixel = lane < s.count ? pixel_[s.first + lane] : NOBODY;
    if (group == CUT_MIXED)
        group = pixel != NOBODY ? of_[pixel] : 0u;
    tile_store(FOUND_LANE + 16u * s.set + lane, group);
    if (pixel != NOBODY && of_[pixel] != 0u)
        tile_store(FOUND_PIXEL + pixel, of_[pixel] | lane << 16 | s.set << 20);
}

void main() {
    near_query none = asks();
    load_points();
    uint groups = make_groups(INFLUENCE_CLOSE * none.scale * volumes_real(VOLUMES_USUAL));
    store_queries(groups, none);
    cut(groups);
    EACH_INDEX(i, 16u * sixteens_) store_lane(sixteen_[i / 16u], i % 16u);
}
