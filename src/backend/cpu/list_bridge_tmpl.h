/* The bridge between core/list_rays.h, with all that it includes, and the CPU's memory: included by lists_tmpl.h. */
#ifndef NOC_CPU_LIST_BRIDGE_H
#define NOC_CPU_LIST_BRIDGE_H

#include "backend/cpu/lanes_tmpl.h"

#include "core/list_rays.h"

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

/* ---- entries ---- */

FN list_prior prior_load(CTX u1 at) { return (list_prior){ ctx->at.priors->share[at], ctx->at.priors->expect[at] }; }
FN list_priors prior_row(CTX u1 row, int l) {
    return (list_priors){ rload(ctx->at.priors->share + 16 * row + l), rload(ctx->at.priors->expect + 16 * row + l) };
}

FN real entry_weight(CTX u32 i) { return real_gather(ctx->at.lists->list.weight, i); }
FN u32 entry_lights(CTX u1 row, int l, u1 rows, u1 count) {
    uint32_t at[LANES];
    for (uint32_t i = 0; i < LANES; i++)
        at[i] = ctx->at.lists->list.light[NOC_MIN(((uint32_t)l + i) * rows + row, count - 1)];
    return uload(at);
}
FN void sketch_store(CTX u1 row, int l, list_sketch k) {
    const real field[SKETCH_WORDS] = { k.middle.x, k.middle.y, k.middle.z, k.radius,  k.normal.x, k.normal.y,
                                       k.normal.z, k.size,     k.shine.x,  k.shine.y, k.shine.z,  real_of_bits(k.shape),
                                       k.beside.x, k.beside.y, k.beside.z, k.level };
    for (int i = 0; i < SKETCH_WORDS; i++)
        ustore(ctx->at.lists->sketches[i] + 16 * row + l, bits_of_real(field[i]));
}
#define SKETCH_FIELDS(word)                                                                                            \
    (list_sketch) {                                                                                                    \
        V3(real_of_bits(word(0)), real_of_bits(word(1)), real_of_bits(word(2))), real_of_bits(word(3)),                \
            V3(real_of_bits(word(4)), real_of_bits(word(5)), real_of_bits(word(6))), real_of_bits(word(7)), word(11),  \
            V3(real_of_bits(word(8)), real_of_bits(word(9)), real_of_bits(word(10))),                                  \
            V3(real_of_bits(word(12)), real_of_bits(word(13)), real_of_bits(word(14))), real_of_bits(word(15))         \
    }
FN list_sketch sketch_row(CTX u1 row, int l) {
#define ROW_WORD(i) uload(ctx->at.lists->sketches[i] + 16 * row + l)
    return SKETCH_FIELDS(ROW_WORD);
#undef ROW_WORD
}
FN list_sketch sketch_load(CTX u1 at) {
#define PLACE_WORD(i) KU(ctx->at.lists->sketches[i][at])
    return SKETCH_FIELDS(PLACE_WORD);
#undef PLACE_WORD
}
FN u32 entry_light(CTX u32 i) { return word_gather(ctx->at.lists->list.light, i); }

/* ---- faces ---- */

FN surf seen_surf(const seen_block *b, int l) {
    surf s;
    s.p = V3(rload(b->p[0] + l), rload(b->p[1] + l), rload(b->p[2] + l));
    s.n = V3(rload(b->n[0] + l), rload(b->n[1] + l), rload(b->n[2] + l));
    s.wo = V3(rload(b->wo[0] + l), rload(b->wo[1] + l), rload(b->wo[2] + l));
    s.albedo = V3(rload(b->albedo[0] + l), rload(b->albedo[1] + l), rload(b->albedo[2] + l));
    s.f0 = rload(b->f0 + l);
    s.alpha = rload(b->alpha + l);
    return s;
}
FN void seen_store(seen_block *b, int l, surf s, real depth) {
    const v3 three[4] = { s.p, s.n, s.wo, s.albedo };
    float(*const to[4])[BLOCK] = { b->p, b->n, b->wo, b->albedo };
    for (int i = 0; i < 4; i++) {
        rstore(to[i][0] + l, three[i].x);
        rstore(to[i][1] + l, three[i].y);
        rstore(to[i][2] + l, three[i].z);
    }
    rstore(b->f0 + l, s.f0);
    rstore(b->alpha + l, s.alpha);
    rstore(b->depth + l, depth);
}
FN face_pixels face_pixels_load(CTX int l) {
    const seen_block *b = &ctx->at.asked->seen;
    return (face_pixels){ seen_surf(b, l), rload(b->depth + l) };
}
FN face_pixel face_pixel_load(CTX u1 at) {
    const seen_block *b = &ctx->at.asked->seen;
    return (face_pixel){ F3(b->p[0][at], b->p[1][at], b->p[2][at]),
                         F3(b->n[0][at], b->n[1][at], b->n[2][at]),
                         F3(b->wo[0][at], b->wo[1][at], b->wo[2][at]),
                         F3(b->albedo[0][at], b->albedo[1][at], b->albedo[2][at]),
                         b->f0[at],
                         b->alpha[at],
                         b->depth[at] };
}
FN mask face_lanes(CTX u1 pixels, int l) { return mload(pixels, l); }
FN void far_store(CTX u1 face, u1 row, int l, real sum) { rstore(ctx->at.asked->face[face].far[row] + l, sum); }
FN f1 far_sum(CTX u1 face, u1 row, u1 column) { return ctx->at.asked->face[face].far[row][column]; }
FN void column_store(CTX u1 face, u1 column, f1 sum) { ctx->at.asked->face[face].column[column] = sum; }
FN void near_bits_store(CTX u1 face, u1 row, int l, mask near) {
    uint32_t *bits = &ctx->at.asked->face[face].near[row];
    *bits = (l ? *bits : 0) | lane_bits(near) << l;
}
FN u1 near_bits_load(CTX u1 face, u1 row) { return ctx->at.asked->face[face].near[row]; }
FN void face_store(CTX u1 number, list_face f, face_sums sums) {
    list_asked *a = ctx->at.asked;
    a->face[number].pixels = f.pixels;
    for (uint32_t bits = f.pixels; bits; bits &= bits - 1) {
        int l = __builtin_ctz(bits);
        a->face_of[l] = number;
        a->all[l] = sums.all;
        a->bright[l] = sums.bright;
    }
}
FN u1 pixels_of_face(CTX u1 face) { return ctx->at.asked->face[face].pixels; }
FN void near_entry_store(CTX u1 i, u1 entry, u1 at, u1 pixels) {
    ctx->at.asked->near[i] = (near_record){ entry, (uint16_t)at, (uint16_t)pixels };
}
FN u1 near_entry(CTX u1 i) { return ctx->at.asked->near[i].entry; }
FN u1 near_place(CTX u1 i) { return ctx->at.asked->near[i].place; }
FN mask near_pixels(CTX u1 i) { return mload(ctx->at.asked->near[i].pixels, ctx->at.lane); }
FN u32 near_entry_at(CTX u32 i) { return word_gather(ctx->at.asked->near, i * KU(2u)); }
FN u32 face_words(u32 face) { return face * KU(sizeof(face_weights) / 4); }
FN real far_at(CTX u32 face, u32 row, u32 column) {
    return real_gather(ctx->at.asked->face[0].far, face_words(face) + row * KU(16u) + column);
}
FN real column_at(CTX u32 face, u32 column) {
    return real_gather(ctx->at.asked->face[0].column, face_words(face) + column);
}
FN void summed_store(CTX u1 i, real sum) { rstore(ctx->at.asked->summed[i] + ctx->at.lane, sum); }
FN real summed_at(CTX u32 i) {
    return real_gather(ctx->at.asked->summed[0] + ctx->at.lane, i * KU(BLOCK) + lane_numbers(0));
}
FN void drawn_store(CTX u32 ray, mask on, list_drawn d) {
    list_asked *a = ctx->at.asked;
    uint32_t k[LANES], e[LANES];
    float t[LANES], w[LANES];
    ustore(k, ray);
    ustore(e, d.entry);
    rstore(t, d.times);
    rstore(w, d.weighed);
    for (uint32_t bits = lane_bits(on); bits; bits &= bits - 1) {
        int l = __builtin_ctz(bits);
        a->entry[k[l]][ctx->at.lane + l] = e[l];
        a->times[k[l]][ctx->at.lane + l] = t[l];
        a->weighed[k[l]][ctx->at.lane + l] = w[l];
    }
}
FN real drawn_times(CTX u1 ray) {
    float times[LANES];
    for (int l = 0; l < LANES; l++)
        times[l] = ctx->at.found[ray].times[ctx->at.lane + l];
    return rload(times);
}
FN list_found found_of(CTX u32 ray) {
    uint32_t of[LANES], entry[LANES];
    float times[LANES], w[LANES], p[LANES];
    ustore(of, ray);
    for (int i = 0, l = ctx->at.lane; i < LANES; i++, l++) {
        const ray_draw *d = &ctx->at.found[of[i]];
        entry[i] = d->entry[l];
        times[i] = d->times[l];
        w[i] = d->r.w[l];
        p[i] = d->r.p[l];
    }
    return (list_found){ uload(entry), rload(times), rload(w), rload(p) };
}
FN real found_p(CTX u1 ray) { return rload(ctx->at.found[ray].r.p + ctx->at.lane); }
FN real found_w(CTX u1 ray) { return rload(ctx->at.found[ray].r.w + ctx->at.lane); }

#endif
