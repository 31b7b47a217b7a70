/* The bridge between core/lists.h and the CPU's memory, and list building: included by lists_tmpl.h. */
#ifndef NOC_CPU_LIST_BUILD_H
#define NOC_CPU_LIST_BUILD_H

#include "backend/cpu/lanes_tmpl.h"

#include "core/lists.h"

FN real score_load(CTX u1 group, int l) { return rload(ctx->at.lists->scores[group] + l); }
FN void score_store(CTX u1 group, int l, real score) { rstore(ctx->at.lists->scores[group] + l, score); }
FN f1 score_at(CTX u1 group, u1 place) { return ctx->at.lists->scores[group][place]; }
FN void score_clear(CTX u1 group, u1 place) { ctx->at.lists->scores[group][place] = 0; }
FN const float *score_row(CTX u1 group) { return ctx->at.lists->scores[group]; }
FN void list_group_store(CTX u1 group, list_group g) {
    ctx->at.lists->groups[group] = (group_record){ g.block, (uint8_t)g.part, (uint8_t)g.level };
}
FN list_group list_group_load(CTX u1 group) {
    const group_record *g = &ctx->at.lists->groups[group];
    return (list_group){ g->part, g->level, g->block };
}
FN void parent_store(CTX u1 i, f1 score) { ctx->at.lists->parents[i] = score; }
FN f1 parent_load(CTX u1 i) { return ctx->at.lists->parents[i]; }
FN void line_store(CTX u1 group, u1 before) { ctx->at.lists->line[group] = before; }
FN u1 line_load(CTX u1 group) { return ctx->at.lists->line[group]; }
FN void entry_store(CTX u1 i, list_entry e) {
    ctx->at.lists->list.light[i] = e.light;
    ctx->at.lists->list.weight[i] = e.weight;
}
FN list_entry entry_load(CTX u1 i) {
    return (list_entry){ ctx->at.lists->list.light[i], ctx->at.lists->list.weight[i] };
}

/* ---- surfaces ---- */

FN f3 three(const float a[3]) { return F3(a[0], a[1], a[2]); }
FN u1 tile_pixels(CTX u1 block) { return ctx->at.tile_pixels[block]; }
FN list_point tile_point(CTX u1 block, u1 at) {
    const gblock *g = ctx->at.tile[block];
    return (list_point){ F3(g->px[at], g->py[at], g->pz[at]), F3(g->nx[at], g->ny[at], g->nz[at]), g->depth[at],
                         g->material[at] };
}
FN list_material list_material_load(CTX u1 material) {
    const material_record *m = &ctx->materials[material];
    return (list_material){ three(m->albedo), ctx->frame->flags & FRAME_MATTE ? 0 : m->f0, m->alpha };
}
_Static_assert(sizeof(patch_record) == sizeof(list_patch) && offsetof(patch_record, wo) == offsetof(list_patch, wo) &&
                   offsetof(patch_record, alpha2) == offsetof(list_patch, alpha2),
               "a record is a patch");
FN void piece_store(CTX u1 i, u1 pixels) { ctx->at.lists->pieces[i] = pixels; }
FN u1 piece_load(CTX u1 i) { return ctx->at.lists->pieces[i]; }
FN void patch_store(CTX u1 i, list_patch t) {
    ctx->at.lists->patches[i] = (patch_record){ { t.c.x, t.c.y, t.c.z },
                                                t.radius,
                                                { t.axis.x, t.axis.y, t.axis.z },
                                                t.spread,
                                                t.share,
                                                t.reflectance,
                                                { t.wo.x, t.wo.y, t.wo.z },
                                                t.gloss,
                                                t.alpha2 };
}
FN list_patch patch_load(CTX u1 i) {
    list_patch t;
    memcpy(&t, &ctx->at.lists->patches[i], sizeof(t));
    return t;
}

/* ---- lights ---- */

FN list_top top_load(CTX u1 part) {
    const noc_clusters *c = ctx->clusters[part];
    if (!c || !c->count)
        return (list_top){ 0, 0 };
    return (list_top){ (u1)c->levels, (u1)c->nodes[c->levels - 1] };
}
FN list_node node_load(CTX u1 part, u1 level, u1 block, int l) {
    const noc_cluster_block *c = &ctx->clusters[part]->level[level][block];
    return (list_node){ V3(rload(c->x + l), rload(c->y + l), rload(c->z + l)),
                        rload(c->radius + l),
                        V3(rload(c->ax + l), rload(c->ay + l), rload(c->az + l)),
                        rload(c->cos_cone + l),
                        rload(c->sin_cone + l),
                        rload(c->power + l) };
}
FN list_cluster cluster_load(CTX u1 part, u1 cluster) {
    const noc_cluster_block *c = &ctx->clusters[part]->level[0][cluster / 16];
    u1 l = cluster % 16;
    return (list_cluster){ F3(c->x[l], c->y[l], c->z[l]), c->radius[l], c->power[l] };
}
FN list_brief brief_load(CTX u1 part, u1 cluster, int l) {
    const noc_light_block *b = &ctx->clusters[part]->lights[cluster];
    return (list_brief){ uload(b->place + l), uload(b->shine + l) };
}
FN u1 cluster_light(CTX u1 part, u1 cluster, u1 at) { return ctx->clusters[part]->lights[cluster].id[at]; }

static void build_list(const struct core_context *frame, const gblock *const *g, const uint32_t *lanes, int blocks,
                       uint32_t start, list_scratch *scratch) {
    const frame_constants *f = frame->frame;
    struct core_context tile = *frame, *ctx = &tile;
    ctx->at.tile = g;
    ctx->at.tile_pixels = lanes;
    ctx->at.lists = scratch;
    list_size size = list_build(ctx, (u1)blocks, three(f->camera.eye), f->list, f->tail, start);
    scratch->list.count = size.count;
    scratch->list.copies = size.copies;
}

#endif
