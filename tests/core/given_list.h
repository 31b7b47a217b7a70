/* For programs that look at how pixels share rays out over a list: a list that they make themselves, and the memory of
 * one block that weighs it, behind the bridges of core/list_rays.h. */
#ifndef NOC_TEST_GIVEN_LIST_H
#define NOC_TEST_GIVEN_LIST_H

#include "../test.h"
#include "no_lists.h"

enum { GIVEN_RAYS = 128 };

struct core_context {
    u1 count; /* entries */
    light light[LIST_ROOM];
    float weight[LIST_ROOM], visibility[LIST_ROOM]; /* what is expected of it */
    list_sketch sketch[LIST_ROOM];                  /* by row and place */
    face_pixel pixel[16];
    float far[LIST_FACES][LIST_ROWS + 2][16], column[LIST_FACES][17];
    u1 near_bits[LIST_FACES][LIST_ROWS], pixels[LIST_FACES];
    face_sums sums[LIST_FACES];
    u1 near_entry[LIST_ROOM], near_place[LIST_ROOM], near_pixels[LIST_ROOM];
    u1 place; /* of the pixel at hand, and its face */
    float summed[LIST_ROOM + 1];
    list_drawn drawn[GIVEN_RAYS];
    u1 rays, room; /* that were drawn, and that there may be; 0: as there is room */
};

#define GIVEN ((struct core_context *)(uintptr_t)ctx)

FN u1 given_entry(CTX u1 at) { return at % 16 * list_rows(ctx->count) + at / 16; }

FN light light_load(CTX u32 i) { return ctx->light[i]; }
FN light light_splat(CTX u1 i) { return light_load(PASS i); }
FN list_entry entry_load(CTX u1 i) { return (list_entry){ i, ctx->weight[i] }; }
FN u32 entry_light(CTX u32 i) { return i; }
FN real entry_weight(CTX u32 i) { return ctx->weight[i]; }
FN u32 entry_lights(CTX u1 row, int l, u1 rows, u1 count) {
    u1 i = given_entry(PASS 16 * row + (u1)l);
    return i < count ? i : count - 1;
}
FN void sketch_store(CTX u1 row, int l, list_sketch k) { GIVEN->sketch[16 * row + (u1)l] = k; }
FN list_sketch sketch_row(CTX u1 row, int l) { return ctx->sketch[16 * row + (u1)l]; }
FN list_sketch sketch_load(CTX u1 at) { return ctx->sketch[at]; }
FN list_prior prior_load(CTX u1 at) {
    u1 i = given_entry(PASS at);
    return i < ctx->count ? list_prior_of(ctx->weight[i], ctx->visibility[i]) : (list_prior){ 0, 0 };
}
FN list_priors prior_row(CTX u1 row, int l) {
    list_prior b = prior_load(PASS 16 * row + (u1)l);
    return (list_priors){ b.share, b.expect };
}
FN face_pixel face_pixel_load(CTX u1 at) { return ctx->pixel[at]; }
FN face_pixels face_pixels_load(CTX int l) {
    face_pixel q = ctx->pixel[l];
    return (face_pixels){ { V3(q.p.x, q.p.y, q.p.z), V3(q.n.x, q.n.y, q.n.z), V3(q.wo.x, q.wo.y, q.wo.z),
                            V3(q.albedo.x, q.albedo.y, q.albedo.z), q.f0, q.alpha },
                          q.depth };
}
FN mask face_lanes(CTX u1 pixels, int l) { return pixels >> l & 1; }
FN void far_store(CTX u1 face, u1 row, int l, real sum) { GIVEN->far[face][row][l] = sum; }
FN f1 far_sum(CTX u1 face, u1 row, u1 column) { return ctx->far[face][row][column]; }
FN void column_store(CTX u1 face, u1 column, f1 sum) { GIVEN->column[face][column] = sum; }
FN void near_bits_store(CTX u1 face, u1 row, int l, mask near) {
    u1 *bits = &GIVEN->near_bits[face][row];
    *bits = (*bits & ~(1u << l)) | (u1)near << l;
}
FN u1 near_bits_load(CTX u1 face, u1 row) { return ctx->near_bits[face][row]; }
FN void face_store(CTX u1 number, list_face f, face_sums sums) {
    assert_true(number < LIST_FACES);
    GIVEN->pixels[number] = f.pixels;
    GIVEN->sums[number] = sums;
}
FN u1 pixels_of_face(CTX u1 number) { return ctx->pixels[number]; }
FN void near_entry_store(CTX u1 i, u1 entry, u1 at, u1 pixels) {
    assert_true(i < LIST_ROOM && entry < ctx->count);
    GIVEN->near_entry[i] = entry;
    GIVEN->near_place[i] = at;
    GIVEN->near_pixels[i] = pixels;
}
FN u1 near_entry(CTX u1 i) { return ctx->near_entry[i]; }
FN u1 near_place(CTX u1 i) { return ctx->near_place[i]; }
FN mask near_pixels(CTX u1 i) { return ctx->near_pixels[i] >> ctx->place & 1; }
FN u32 near_entry_at(CTX u32 i) { return ctx->near_entry[i]; }
FN void summed_store(CTX u1 i, real sum) { GIVEN->summed[i] = sum; }
FN real summed_at(CTX u32 i) { return ctx->summed[i]; }
FN real far_at(CTX u32 face, u32 row, u32 column) { return ctx->far[face][row][column]; }
FN real column_at(CTX u32 face, u32 column) { return ctx->column[face][column]; }
FN void drawn_store(CTX u32 ray, mask on, list_drawn d) {
    if (!on)
        return;
    if (ray >= (ctx->room ? ctx->room : GIVEN_RAYS))
        fail_msg("ray %u, where there is room for %u", ray, ctx->room);
    GIVEN->drawn[ray] = d;
    GIVEN->rays = ray + 1;
}
FN real drawn_times(CTX u1 ray) { return ctx->drawn[ray].times; }
FN list_found found_of(CTX u32 ray) { return (list_found){ 0 }; }
FN real found_p(CTX u1 ray) { return 0; }
FN real found_w(CTX u1 ray) { return 0; }

/* The pixel at hand: what its near entries weigh, and with the far ones all. */
static inline list_sums given_sums(CTX surf s, u32 key, u1 face, u1 near) {
    list_sums sums = list_weigh(PASS s, key, near);
    sums.all += ctx->sums[face].all;
    sums.bright += ctx->sums[face].bright;
    return sums;
}

#endif
