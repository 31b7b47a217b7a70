#version 460
/* Each pixel shares its rays out over its tile's list (core/list_rays.h). 16 invocations are a block of pixels, which
 * weighs far entries for pixels that see alike together, one such face after the other; WORKERS / 16 blocks beside each
 * other in a tile are done at once. 8 barriers a face. */
#extension GL_GOOGLE_include_directive : require
#define my_block (gl_LocalInvocationIndex / 16u) /* of the work group */
#define my_lane (gl_LocalInvocationIndex % 16u)
#define EACH16(l) for (int l = int(my_lane), once_ = l; l <= once_; l++)
#define EACH16_SUM(x) sum_of_block(x)
#define EACH16_MAX(x) most_of_block(x)
#include "bridge.glsl"
layout(local_size_x_id = 1) in;
layout(constant_id = 1) const uint WORKERS = 64u;

#include "list_pixel.glsl"
#include "core/shading.h"
#include "surfaces.glsl"

void settle() {
    memoryBarrierShared();
    barrier();
}

/* Sums and maxima of a face's 16 invocations: a cell each, 0 when the face begins. */
#define FACE_CELLS 4
shared uint cell_[WORKERS / 16u][FACE_CELLS];
uint next_cell_;
uint sum_of_block(uint x) {
    uint c = next_cell_++;
    atomicAdd(cell_[my_block][c], x);
    settle();
    return cell_[my_block][c];
}
float most_of_block(float x) { /* x >= 0 */
    uint c = next_cell_++;
    atomicMax(cell_[my_block][c], floatBitsToUint(x));
    settle();
    return uintBitsToFloat(cell_[my_block][c]);
}

#include "core/list_rays.h"

/* ---- the bridge ---- */

shared float seen_[WORKERS / 16u][15][16];
shared float far_[WORKERS / 16u][LIST_ROWS + 2][16];
shared float column_[WORKERS / 16u][17];
shared uint near_bits_[WORKERS / 16u][LIST_ROWS];
shared uint near_[WORKERS / 16u][LIST_ROOM]; /* entry, and from bit 8 on its place */
shared uint going_;
float summed_[LIST_ROOM + 1];
uint cell_of_block_;

face_pixel face_pixel_load(uint at) {
    float f[15];
    for (int c = 0; c < 15; c++)
        f[c] = seen_[my_block][c][at];
    return face_pixel(vec3(f[0], f[1], f[2]), vec3(f[3], f[4], f[5]), vec3(f[6], f[7], f[8]), vec3(f[9], f[10], f[11]),
                      f[12], f[13], f[14]);
}
face_pixels face_pixels_load(int l) {
    face_pixel q = face_pixel_load(uint(l));
    return face_pixels(surf(q.p, q.n, q.wo, q.albedo, q.f0, q.alpha), q.depth);
}
bool face_lanes(uint pixels, int l) { return (pixels >> l & 1u) != 0u; }

list_entry entry_load(uint i) { return list_entry(entry_light(i), entry_weight(i)); }
list_prior prior_load(uint at) {
    uint word = TILE_PRIORS + 2u * LIST_ROOM * cell_of_block_ + at;
    return list_prior(tile_real(word), tile_real(word + LIST_ROOM));
}
list_priors prior_row(uint row, int l) {
    list_prior b = prior_load(16u * row + uint(l));
    return list_priors(b.share, b.expect);
}
float sketch_field(uint at, uint field) { return tile_real(TILE_SKETCHES + field * LIST_ROOM + at); }
vec3 sketch_three(uint at, uint field) {
    return vec3(sketch_field(at, field), sketch_field(at, field + 1u), sketch_field(at, field + 2u));
}
list_sketch sketch_load(uint at) {
    return list_sketch(sketch_three(at, 0u), sketch_field(at, 3u), sketch_three(at, 4u), sketch_field(at, 7u),
                       floatBitsToUint(sketch_field(at, 11u)), sketch_three(at, 8u), sketch_three(at, 12u),
                       sketch_field(at, 15u));
}
list_sketch sketch_row(uint row, int l) { return sketch_load(16u * row + uint(l)); }

/* There is one face at a time. */
void far_store(uint face, uint row, int l, float sum) { far_[my_block][row][l] = sum; }
float far_sum(uint face, uint row, uint column) {
    if (column == 0u && row <= LIST_ROWS) /* the first of them */
        settle();
    return far_[my_block][row][column];
}
void column_store(uint face, uint column, float sum) {
    if (my_lane == 0u)
        column_[my_block][column] = sum;
}
void near_bits_store(uint face, uint row, int l, bool near) {
    if (near)
        atomicOr(near_bits_[my_block][row], 1u << l);
}
uint near_bits_load(uint face, uint row) { return near_bits_[my_block][row]; }
uint pixels_of_face(uint face) { return 0u; }
void near_entry_store(uint i, uint entry, uint at, uint pixels) {
    if (my_lane == 0u)
        near_[my_block][i] = entry | at << 8;
}
uint near_entry(uint i) { return near_[my_block][i] & 255u; }
uint near_place(uint i) { return near_[my_block][i] >> 8; }
bool near_pixels(uint i) { return true; }
uint near_entry_at(uint i) { return near_entry(i); }
float far_at(uint face, uint row, uint column) { return far_[my_block][row][column]; }
float column_at(uint face, uint column) { return column_[my_block][column]; }
void summed_store(uint i, float sum) { summed_[i] = sum; }
float summed_at(uint i) { return summed_[i]; }

void drawn_store(uint ray, bool on, list_drawn d) {
    if (on) {
        pixel_store(ray_field(ray, RAY_DRAWN), d.entry | uint(d.times) << 8);
        pixel_store(ray_field(ray, RAY_W), d.weighed);
    }
}

/* ---- pixels ---- */

void see(surf s, float depth) {
    for (int c = 0; c < 3; c++) {
        seen_[my_block][c][my_lane] = s.p[c];
        seen_[my_block][3 + c][my_lane] = s.n[c];
        seen_[my_block][6 + c][my_lane] = s.wo[c];
        seen_[my_block][9 + c][my_lane] = s.albedo[c];
    }
    seen_[my_block][12][my_lane] = s.f0;
    seen_[my_block][13][my_lane] = s.alpha;
    seen_[my_block][14][my_lane] = depth;
}

/* Returns what the pixel expects to get. */
float share_pixel(place p, surf s, face_sums far, uint near, uint rows) {
    bool fresh = (HERE.list_flags & LIST_FRESH) != 0u && pixel_load(PIXEL_FRESH) != 0u;
    float expected = (HERE.list_flags & LIST_LEARNS) != 0u ? uintBitsToFloat(HERE.learned.at[CACHE_BRIGHT]) : 0.0;
    list_shared q = list_share(s, key_at(p, FRAME.index), true, list_sums(far.all, far.bright), near, 0u, rows,
                               list_asks(float(FRAME.shadow_rays), fresh), expected);
    pixel_store(PIXEL_ALL, q.sums.all);
    pixel_store(PIXEL_DRAWS, q.draws);
    pixel_store(PIXEL_COUNT, q.rays);
    if ((HERE.views & VK_VIEW_EXPECTED) != 0u)
        HERE.view_expected.at[p.slot] = q.sums.bright;
    return q.sums.bright;
}

/* The sum of 16 in halves. */
shared float bright_[WORKERS / 16u][16];
float quarter_bright(uint i) {
    precise float sum =
        (bright_[my_block][i] + bright_[my_block][i + 8u]) + (bright_[my_block][i + 4u] + bright_[my_block][i + 12u]);
    return sum;
}

void main() {
    uint block_x = gl_WorkGroupID.x * (WORKERS / 16u) + my_block, block_y = HERE.first_row + gl_WorkGroupID.y;
    bool inside = block_x < FRAME.blocks_x;
    place p = place_in_row(block_x * BLOCK + my_lane, block_y);
    tile_ = tile_of(inside ? block_x : 0u, block_y);
    if (!inside) /* another one of the same tile stands in */
        tile_ = tile_of(gl_WorkGroupID.x * (WORKERS / 16u), block_y);
    uint count = tile_load(TILE_COUNT), rows = list_rows(count);
    receiver r = receiver_none();
    if (inside) {
        find_pixel(p);
        r = receiver_at(HERE.surfaces, p.block, p.lane);
        pixel_store(PIXEL_ALL, 0.0);
        pixel_store(PIXEL_DRAWS, 0.0);
        pixel_store(PIXEL_COUNT, 0u);
        pixel_store(PIXEL_SEES, receives(r) ? 1u : 0u);
    }
    surf s = surf_at(HERE.surfaces, inside ? p.block : 0u, p.lane, eye_now());
    see(s, r.depth);
    cell_[my_block][0] = 0u;
    settle();
    next_cell_ = 0u;
    uint rest = sum_of_block(r.material != NO_SURFACE && count > 0u ? 1u << my_lane : 0u);
    /* A block that sees no surface has no cell, and weighs along with the others all the same. */
    cell_of_block_ = rest != 0u ? tile_load(TILE_CELL + number_in_tile(p)) : 0u;
    bright_[my_block][my_lane] = 0.0;
    for (;;) {
        settle();
        if (my_lane < FACE_CELLS)
            cell_[my_block][my_lane] = 0u;
        near_bits_[my_block][my_lane] = 0u; /* LIST_ROWS is 16 */
        if (gl_LocalInvocationIndex == 0u)
            going_ = 0u;
        settle();
        if (rest != 0u)
            going_ = 1u;
        settle();
        if (going_ == 0u)
            break;
        next_cell_ = 0u;
        list_face f = face_of(rest | (rest == 0u ? 1u : 0u));
        face_sums far = weigh_face(0u, f, rows);
        uint near = near_entries(1u, rows);
        settle();
        if (inside && face_lanes(f.pixels & rest, int(my_lane)))
            bright_[my_block][my_lane] = share_pixel(p, s, far, near, rows);
        rest &= ~f.pixels;
    }
    if (inside && my_lane == 0u && (HERE.list_flags & LIST_LEARNS) != 0u) {
        precise float sum = (quarter_bright(0u) + quarter_bright(2u)) + (quarter_bright(1u) + quarter_bright(3u));
        HERE.block_bright.at[p.block] = sum;
    }
}
