/* For programs that share no rays out over lists: bridges of core/list_rays.h that nothing asks. */
#ifndef NOC_TEST_NO_RAYS_H
#define NOC_TEST_NO_RAYS_H

#include "no_lists.h"

FN light light_splat(CTX u1 i) { return (light){ .kind = 0 }; }
FN list_entry entry_load(CTX u1 i) { return (list_entry){ 0, 0 }; }
FN u32 entry_light(CTX u32 i) { return 0; }
FN u32 entry_lights(CTX u1 row, int l, u1 rows, u1 count) { return 0; }
FN real entry_weight(CTX u32 i) { return 0; }
FN void sketch_store(CTX u1 row, int l, list_sketch k) {}
FN list_sketch sketch_row(CTX u1 row, int l) { return (list_sketch){ .radius = 0 }; }
FN list_sketch sketch_load(CTX u1 place) { return (list_sketch){ .radius = 0 }; }
FN list_prior prior_load(CTX u1 place) { return (list_prior){ 0, 0 }; }
FN list_priors prior_row(CTX u1 row, int l) { return (list_priors){ 0, 0 }; }
FN face_pixel face_pixel_load(CTX u1 place) { return (face_pixel){ .f0 = 0 }; }
FN face_pixels face_pixels_load(CTX int l) { return (face_pixels){ .depth = 0 }; }
FN mask face_lanes(CTX u1 pixels, int l) { return false; }
FN void far_store(CTX u1 face, u1 row, int l, real sum) {}
FN f1 far_sum(CTX u1 face, u1 row, u1 column) { return 0; }
FN void column_store(CTX u1 face, u1 column, f1 sum) {}
FN void near_bits_store(CTX u1 face, u1 row, int l, mask near) {}
FN u1 near_bits_load(CTX u1 face, u1 row) { return 0; }
FN void face_store(CTX u1 number, list_face f, face_sums sums) {}
FN u1 pixels_of_face(CTX u1 number) { return 0; }
FN void near_entry_store(CTX u1 i, u1 entry, u1 place, u1 pixels) {}
FN u1 near_entry(CTX u1 i) { return 0; }
FN u1 near_place(CTX u1 i) { return 0; }
FN mask near_pixels(CTX u1 i) { return false; }
FN u32 near_entry_at(CTX u32 i) { return 0; }
FN void summed_store(CTX u1 i, real sum) {}
FN real summed_at(CTX u32 i) { return 0; }
FN real far_at(CTX u32 face, u32 row, u32 column) { return 0; }
FN real column_at(CTX u32 face, u32 column) { return 0; }
FN void drawn_store(CTX u32 ray, mask on, list_drawn d) {}
FN real drawn_times(CTX u1 ray) { return 0; }
FN list_found found_of(CTX u32 ray) { return (list_found){ 0 }; }
FN real found_p(CTX u1 ray) { return 0; }
FN real found_w(CTX u1 ray) { return 0; }

#endif
