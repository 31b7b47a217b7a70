/* For programs that weigh the entries of a list that was given: bridges of how lists are made, that nothing asks. */
#ifndef NOC_TEST_NO_LISTS_H
#define NOC_TEST_NO_LISTS_H

#include "no_scores.h"

#include "core/list_rays.h"

FN u1 tile_pixels(CTX u1 block) { return 0; }
FN list_point tile_point(CTX u1 block, u1 place) { return (list_point){ 0 }; }
FN list_material list_material_load(CTX u1 material) { return (list_material){ 0 }; }
FN void piece_store(CTX u1 i, u1 pixels) {}
FN u1 piece_load(CTX u1 i) { return 0; }
FN void patch_store(CTX u1 i, list_patch t) {}
FN list_patch patch_load(CTX u1 i) { return (list_patch){ 0 }; }
FN list_top top_load(CTX u1 part) { return (list_top){ 0 }; }
FN u1 cluster_light(CTX u1 part, u1 cluster, u1 place) { return 0; }
FN void list_group_store(CTX u1 group, list_group g) {}
FN list_group list_group_load(CTX u1 group) { return (list_group){ 0 }; }
FN void parent_store(CTX u1 i, f1 score) {}
FN f1 parent_load(CTX u1 i) { return 0; }
FN void line_store(CTX u1 group, u1 before) {}
FN u1 line_load(CTX u1 group) { return 0; }
FN void entry_store(CTX u1 i, list_entry e) {}

#endif
