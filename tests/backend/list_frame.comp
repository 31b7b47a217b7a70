#version 460
/* One frame of rays over light lists as a compute shader: list building, the rays' choice, and what they find, from the
 * headers that the CPU compiles. Two dispatches: in the first a work group of 16 is a tile, and its invocations share
 * out the places of EACH16; in the second an invocation is a pixel. Not in one, and not by one invocation a tile: that
 * takes hundreds of thousands of rounds, and llvmpipe leaves all loops of an invocation after 65,535. Words of one
 * buffer hold what goes in and what comes out; list_frame.h says where. */
#extension GL_GOOGLE_include_directive : require
#define CORE_GLSL 1

layout(local_size_x = 16) in;
layout(std430, binding = 0) buffer memory { uint word[]; } mem;
layout(push_constant) uniform constants { uint dispatch; };

/* What invocations have written before is read after it. */
void settle() {
    memoryBarrierBuffer();
    barrier();
}

shared uint parts_[16];
uint sum_of_group(uint x) {
    barrier();
    parts_[gl_LocalInvocationID.x] = x;
    barrier();
    uint sum = 0u;
    for (uint i = 0u; i < 16u; i++)
        sum += parts_[i];
    return sum;
}
shared float parts1_[16];
float largest_of_group(float x) {
    barrier();
    parts1_[gl_LocalInvocationID.x] = x;
    barrier();
    float most = parts1_[0];
    for (uint i = 1u; i < 16u; i++)
        most = parts1_[i] > most ? parts1_[i] : most;
    return most;
}
#define EACH16(l) for (int l = int(gl_LocalInvocationID.x), last_ = l; l <= last_; l++)
#define EACH16_SUM(x) sum_of_group(x)
#define EACH16_MAX(x) largest_of_group(x)

#include "core/dialect.h"
#include "core/light.h"
#include "list_frame.h"

uint tile_; /* of this invocation; and of its pixel, the block and the place in it */
uint block_;
uint place_;
float summed_[LIST_ROOM + 1];

/* The block at hand: what its pixels see, and what they weigh. */
shared float seen_[15][16];
shared float far_[LIST_FACES][LIST_ROWS + 2][16];
shared float column_[LIST_FACES][17];
shared uint near_bits_[LIST_FACES][LIST_ROWS];
shared uint face_pixels_[LIST_FACES];
shared float face_all_[LIST_FACES];
shared float face_bright_[LIST_FACES];
shared uint near_entry_[LIST_ROOM];
shared uint near_place_[LIST_ROOM];
shared uint near_pixels_[LIST_ROOM];
uint face_; /* of this invocation's pixel */

uint wu(uint at) { return mem.word[at]; }
float wf(uint at) { return uintBitsToFloat(mem.word[at]); }
void put(uint at, uint x) { mem.word[at] = x; }
void put(uint at, float x) { mem.word[at] = floatBitsToUint(x); }
vec3 wv(uint at) { return vec3(wf(at), wf(at + 1u), wf(at + 2u)); }
uint scratch(uint at) { return wu(HEAD_SCRATCH) + tile_ * uint(SCRATCH_WORDS) + at; }
uint answer(uint at) { return wu(HEAD_ANSWER) + tile_ * uint(ANSWER_WORDS) + at; }
uint pixel_answer(uint at) { return answer(uint(ANSWER_PIXELS) + (block_ * 16u + place_) * uint(PIXEL_WORDS) + at); }
uint ray_answer(uint ray, uint at) { return pixel_answer(uint(PIXEL_RAYS) + ray * uint(RAY_WORDS) + at); }
uint gword(uint block, uint field, uint place) {
    return wu(HEAD_BLOCKS) + ((tile_ * 16u + block) * BLOCK_FIELDS + field) * 16u + place;
}

light light_load(uint i) {
    uint at = wu(HEAD_LIGHTS) + 16u * i;
    light l;
    l.p = wv(at);
    l.kind = wu(at + 3u);
    l.a = wv(at + 4u);
    l.radius = wf(at + 7u);
    l.b = wv(at + 8u);
    l.flags = wu(at + 11u);
    l.e = wv(at + 12u);
    l.area = wf(at + 15u);
    return l;
}
light light_splat(uint i) { return light_load(i); }
profile_cell profile_load(uint place) { return profile_cell(0.0, 0.0, 0.0, 0.0); } /* none of its lights has one */

#include "core/list_rays.h"

/* ---- the bridge ----
 *
 * A score is written by the invocation whose place it has, all else by the first. */

bool first() { return gl_LocalInvocationID.x == 0u; }

float score_load(uint group, int l) { return wf(scratch(16u * group + uint(l))); }
void score_store(uint group, int l, float score) {
    settle();
    put(scratch(16u * group + uint(l)), score);
    settle();
}
float score_at(uint group, uint place) { return wf(scratch(16u * group + place)); }
void score_clear(uint group, uint place) {
    settle();
    if (gl_LocalInvocationID.x == place)
        put(scratch(16u * group + place), 0.0);
    settle();
}
void parent_store(uint i, float score) {
    settle();
    if (first())
        put(scratch(uint(SCRATCH_PARENTS) + i), score);
    settle();
}
float parent_load(uint i) { return wf(scratch(uint(SCRATCH_PARENTS) + i)); }
void list_group_store(uint group, list_group g) {
    uint at = scratch(uint(SCRATCH_GROUPS) + 3u * group);
    settle();
    if (first()) {
        put(at, g.part);
        put(at + 1u, g.level);
        put(at + 2u, g.block);
    }
    settle();
}
list_group list_group_load(uint group) {
    uint at = scratch(uint(SCRATCH_GROUPS) + 3u * group);
    return list_group(wu(at), wu(at + 1u), wu(at + 2u));
}
void line_store(uint group, uint before) {
    settle();
    if (first())
        put(scratch(uint(SCRATCH_LINE) + group), before);
    settle();
}
uint line_load(uint group) { return wu(scratch(uint(SCRATCH_LINE) + group)); }
void entry_store(uint i, list_entry e) {
    settle();
    if (first()) {
        put(answer(uint(ANSWER_LIGHT) + i), e.light);
        put(answer(uint(ANSWER_WEIGHT) + i), e.weight);
    }
    settle();
}
list_entry entry_load(uint i) {
    return list_entry(wu(answer(uint(ANSWER_LIGHT) + i)), wf(answer(uint(ANSWER_WEIGHT) + i)));
}

uint tile_pixels(uint block) {
    uint bits = 0u;
    for (uint i = 0u; i < 16u; i++)
        bits |= (wu(gword(block, 7u, i)) != NO_SURFACE ? 1u : 0u) << i;
    return bits;
}
list_point tile_point(uint block, uint place) {
    vec3 p = vec3(wf(gword(block, 0u, place)), wf(gword(block, 1u, place)), wf(gword(block, 2u, place)));
    vec3 n = vec3(wf(gword(block, 3u, place)), wf(gword(block, 4u, place)), wf(gword(block, 5u, place)));
    return list_point(p, n, wf(gword(block, 6u, place)), wu(gword(block, 7u, place)));
}
list_material list_material_load(uint material) {
    uint at = wu(HEAD_MATERIALS) + 8u * material;
    return list_material(wv(at), wf(at + 3u), wf(at + 7u));
}
void piece_store(uint i, uint pixels) {
    settle();
    if (first())
        put(scratch(uint(SCRATCH_PIECES) + i), pixels);
    settle();
}
uint piece_load(uint i) { return wu(scratch(uint(SCRATCH_PIECES) + i)); }
void patch_store(uint i, list_patch t) {
    uint at = scratch(uint(SCRATCH_PATCHES) + 16u * i);
    settle();
    if (first()) {
        for (uint k = 0u; k < 3u; k++) {
            put(at + k, t.c[k]);
            put(at + 4u + k, t.axis[k]);
            put(at + 10u + k, t.wo[k]);
        }
        put(at + 3u, t.radius);
        put(at + 7u, t.spread);
        put(at + 8u, t.share);
        put(at + 9u, t.reflectance);
        put(at + 13u, t.gloss);
        put(at + 14u, t.alpha2);
    }
    settle();
}
list_patch patch_load(uint i) {
    uint at = scratch(uint(SCRATCH_PATCHES) + 16u * i);
    return list_patch(wv(at), wf(at + 3u), wv(at + 4u), wf(at + 7u), wf(at + 8u), wf(at + 9u), wv(at + 10u),
                      wf(at + 13u), wf(at + 14u));
}

list_top top_load(uint part) {
    if (part != 0u)
        return list_top(0u, 0u);
    return list_top(wu(HEAD_LEVELS), wu(HEAD_TOP_NODES));
}
list_node node_load(uint part, uint level, uint block, int l) {
    uint at = wu(uint(HEAD_NODES) + level) + 160u * block + uint(l);
    return list_node(vec3(wf(at), wf(at + 16u), wf(at + 32u)), wf(at + 48u),
                     vec3(wf(at + 64u), wf(at + 80u), wf(at + 96u)), wf(at + 112u), wf(at + 128u), wf(at + 144u));
}
list_cluster cluster_load(uint part, uint cluster) {
    list_node n = node_load(part, 0u, cluster / 16u, int(cluster % 16u));
    return list_cluster(n.c, n.radius, n.power);
}
list_brief brief_load(uint part, uint cluster, int l) {
    uint at = wu(HEAD_CLUSTERS) + 48u * cluster + uint(l);
    return list_brief(wu(at + 16u), wu(at + 32u));
}
uint cluster_light(uint part, uint cluster, uint place) { return wu(wu(HEAD_CLUSTERS) + 48u * cluster + place); }

uint count_of_list() { return wu(answer(uint(ANSWER_COUNT))); }
uint entry_light(uint i) { return entry_load(i).light; }
float entry_weight(uint i) { return entry_load(i).weight; }
uint entry_in(uint at, uint rows) { return at % 16u * rows + at / 16u; }
list_prior prior_load(uint at) {
    uint count = count_of_list();
    uint i = entry_in(at, list_rows(count));
    if (i >= count)
        return list_prior(0.0, 0.0);
    list_entry e = entry_load(i);
    return list_prior_of(e.weight, wf(wu(HEAD_VISIBILITY) + e.light));
}
list_priors prior_row(uint row, int l) {
    list_prior b = prior_load(16u * row + uint(l));
    return list_priors(b.share, b.expect);
}
uint entry_lights(uint row, int l, uint rows, uint count) {
    return entry_light(minu1(entry_in(16u * row + uint(l), rows), count - 1u));
}
uint sketch_word(uint at, int field) { return scratch(uint(SCRATCH_SKETCHES + field * LIST_ROOM) + at); }
void sketch_store(uint row, int l, list_sketch k) {
    uint at = 16u * row + uint(l);
    for (int c = 0; c < 3; c++) {
        put(sketch_word(at, c), k.middle[c]);
        put(sketch_word(at, 4 + c), k.normal[c]);
        put(sketch_word(at, 8 + c), k.shine[c]);
        put(sketch_word(at, 12 + c), k.beside[c]);
    }
    put(sketch_word(at, 3), k.radius);
    put(sketch_word(at, 7), k.size);
    put(sketch_word(at, 11), k.shape);
    put(sketch_word(at, 15), k.level);
}
list_sketch sketch_load(uint at) {
    float f[SKETCH_WORDS];
    for (int c = 0; c < SKETCH_WORDS; c++)
        f[c] = wf(sketch_word(at, c));
    return list_sketch(vec3(f[0], f[1], f[2]), f[3], vec3(f[4], f[5], f[6]), f[7], wu(sketch_word(at, 11)),
                       vec3(f[8], f[9], f[10]), vec3(f[12], f[13], f[14]), f[15]);
}
list_sketch sketch_row(uint row, int l) { return sketch_load(16u * row + uint(l)); }

/* ---- faces, in memory that the block's invocations share ---- */

void settle_block() {
    memoryBarrierShared();
    barrier();
}
face_pixel face_pixel_load(uint at) {
    float f[15];
    for (int c = 0; c < 15; c++)
        f[c] = seen_[c][at];
    return face_pixel(vec3(f[0], f[1], f[2]), vec3(f[3], f[4], f[5]), vec3(f[6], f[7], f[8]), vec3(f[9], f[10], f[11]),
                      f[12], f[13], f[14]);
}
face_pixels face_pixels_load(int l) {
    face_pixel q = face_pixel_load(uint(l));
    return face_pixels(surf(q.p, q.n, q.wo, q.albedo, q.f0, q.alpha), q.depth);
}
bool face_lanes(uint pixels, int l) { return (pixels >> l & 1u) != 0u; }
void far_store(uint face, uint row, int l, float sum) { far_[face][row][l] = sum; }
float far_sum(uint face, uint row, uint column) {
    settle_block();
    return far_[face][row][column];
}
void column_store(uint face, uint column, float sum) {
    if (first())
        column_[face][column] = sum;
}
void near_bits_store(uint face, uint row, int l, bool near) {
    uint bits = sum_of_group(near ? 1u << l : 0u);
    if (first())
        near_bits_[face][row] = bits;
}
uint near_bits_load(uint face, uint row) {
    settle_block();
    return near_bits_[face][row];
}
void face_store(uint number, list_face f, face_sums sums) {
    if (first()) {
        face_pixels_[number] = f.pixels;
        face_all_[number] = sums.all;
        face_bright_[number] = sums.bright;
    }
    if (face_lanes(f.pixels, int(place_)))
        face_ = number;
    settle_block();
}
uint pixels_of_face(uint number) { return face_pixels_[number]; }
void near_entry_store(uint i, uint entry, uint at, uint pixels) {
    if (first()) {
        near_entry_[i] = entry;
        near_place_[i] = at;
        near_pixels_[i] = pixels;
    }
    settle_block();
}
uint near_entry(uint i) { return near_entry_[i]; }
uint near_place(uint i) { return near_place_[i]; }
bool near_pixels(uint i) { return face_lanes(near_pixels_[i], int(place_)); }
uint near_entry_at(uint i) { return near_entry_[i]; }
float far_at(uint face, uint row, uint column) { return far_[face][row][column]; }
float column_at(uint face, uint column) { return column_[face][column]; }

void summed_store(uint i, float sum) { summed_[i] = sum; }
float summed_at(uint i) { return summed_[i]; }
void drawn_store(uint ray, bool on, list_drawn d) {
    if (on) {
        put(ray_answer(ray, uint(RAY_ENTRY)), d.entry);
        put(ray_answer(ray, uint(RAY_TIMES)), d.times);
        put(ray_answer(ray, uint(RAY_WEIGHED)), d.weighed);
    }
}
float drawn_times(uint ray) { return wf(ray_answer(ray, uint(RAY_TIMES))); }
list_found found_of(uint ray) {
    return list_found(wu(ray_answer(ray, uint(RAY_ENTRY))), drawn_times(ray), wf(ray_answer(ray, uint(RAY_W))),
                      wf(ray_answer(ray, uint(RAY_P))));
}
float found_p(uint ray) { return wf(ray_answer(ray, uint(RAY_P))); }
float found_w(uint ray) { return wf(ray_answer(ray, uint(RAY_W))); }

/* ---- the frame ---- */

/* What this invocation's pixel sees. */
surf surf_here() {
    vec3 eye = wv(uint(HEAD_EYE));
    list_point q = tile_point(block_, place_);
    list_material m = list_material_load(q.material);
    surf s;
    s.p = q.p;
    s.n = q.n;
    v3 d = sub3(eye, s.p);
    EXACT float inv = 1.0 / sqrt(max_(dot3(d, d), 1e-20));
    s.wo = mul3(d, inv);
    s.albedo = m.albedo;
    s.f0 = m.f0;
    s.alpha = m.alpha;
    return s;
}

void see(surf s, float depth) {
    for (int c = 0; c < 3; c++) {
        seen_[c][place_] = s.p[c];
        seen_[3 + c][place_] = s.n[c];
        seen_[6 + c][place_] = s.wo[c];
        seen_[9 + c][place_] = s.albedo[c];
    }
    seen_[12][place_] = s.f0;
    seen_[13][place_] = s.alpha;
    seen_[14][place_] = depth;
    settle_block();
}

void share_pixel(surf s, uint near, uint count, uint x, uint y) {
    uint pixel = y * wu(HEAD_WIDTH) + x;
    uint key = rng_key(wu(HEAD_SEED), pixel, wu(HEAD_FRAME));
    list_sums sums = list_weigh(s, key, near);
    EXACT float all = sums.all + face_all_[face_];
    EXACT float bright = sums.bright + face_bright_[face_];
    sums.all = all;
    sums.bright = bright;
    float n = list_draws(sums, float(wu(HEAD_RAYS)), wf(HEAD_BRIGHTNESS), rng(key, DIM_LIST_RAYS));
    uint rays = list_share_out(sums.all, near, face_, list_rows(count), n, rng(key, DIM_LIST_START));
    put(pixel_answer(uint(PIXEL_ALL)), sums.all);
    put(pixel_answer(uint(PIXEL_BRIGHT)), sums.bright);
    put(pixel_answer(uint(PIXEL_DRAWS)), n);
    vec3 colour = vec3(0.0);
    for (uint k = 0u; k < rays; k++) {
        list_drawn d = list_drawn(wu(ray_answer(k, uint(RAY_ENTRY))), drawn_times(k),
                                  wf(ray_answer(k, uint(RAY_WEIGHED))));
        list_ray r = list_ask(s, sums, n, key, d, light_load(entry_light(d.entry)));
        bool seen = frame_sees(pixel, k);
        r.w = seen ? r.w : 0.0;
        put(ray_answer(k, uint(RAY_LIGHT)), r.light);
        put(ray_answer(k, uint(RAY_U)), r.u);
        put(ray_answer(k, uint(RAY_V)), r.v);
        put(ray_answer(k, uint(RAY_W)), r.w);
        put(ray_answer(k, uint(RAY_P)), r.p);
        v3 c = mul3(r.brings, r.w);
        if (seen && abs(c.x) + abs(c.y) + abs(c.z) < 1e30)
            colour = add3(colour, c);
    }
    put(pixel_answer(uint(PIXEL_SHOWN)), list_stand_in(key, rays, n, 0.0).w);
    reservoir own = reservoir(0u, 0.0, 0.0, 0.0, 0.0, 0.0);
    reservoir kept = list_resampled(key, rays, own);
    put(pixel_answer(uint(PIXEL_KEPT)), kept.light);
    put(pixel_answer(uint(PIXEL_KEPT_W)), kept.w);
    for (uint k = 0u; k < 3u; k++)
        put(pixel_answer(uint(PIXEL_COLOUR) + k), colour[k]);
}

void build_tile() {
    uint start = tail_start(wu(HEAD_SEED), tile_, wu(HEAD_FRAME));
    list_size size = list_build(16u, wv(uint(HEAD_EYE)), wu(HEAD_LIST), wu(HEAD_TAIL), start);
    size = list_fill(size, wu(HEAD_LIST) + wu(HEAD_TAIL), wu(HEAD_RAYS), wu(HEAD_DRAWS));
    list_sketches(size.count);
    if (first()) {
        put(answer(uint(ANSWER_COUNT)), size.count);
        put(answer(uint(ANSWER_COPIES)), size.copies);
    }
}

void main() {
    if (dispatch == DISPATCH_TILES) {
        tile_ = gl_WorkGroupID.x;
        build_tile();
        return;
    }
    tile_ = gl_WorkGroupID.x / 16u;
    block_ = gl_WorkGroupID.x % 16u;
    place_ = gl_LocalInvocationID.x;
    uint count = wu(answer(uint(ANSWER_COUNT)));
    uint x = tile_ % wu(HEAD_TILES_X) * 16u + block_ % 4u * 4u + place_ % 4u;
    uint y = tile_ / wu(HEAD_TILES_X) * 16u + block_ / 4u * 4u + place_ / 4u;
    uint pixels = tile_pixels(block_);
    if (count == 0u || pixels == 0u)
        return;
    bool sees = face_lanes(pixels, int(place_));
    surf s;
    if (sees)
        s = surf_here();
    see(s, sees ? tile_point(block_, place_).depth : 0.0);
    uint near = weigh_faces(pixels, list_rows(count));
    if (sees)
        share_pixel(s, near, count, x, y);
}
