/* Kernels of reuse and shading: core/ applied to blocks of pixels. Compiled once as scalar C and once an instruction
 * set, with CORE_LANES and KERNELS (the table's name) defined by the build. */
#include "backend/cpu/lanes_tmpl.h"

static void candidates(const struct core_context *ctx, const gblock *g, uint32_t lanes, int x, int y, int m,
                       rblock *out) {
    for (int l = 0; l < BLOCK; l += LANES) {
        mask on = mload(lanes, l);
        resv r = resv_empty();
        if (ctx->light_count && ANY(on))
            r = resv_sel(on,
                         ris_uniform_ahead(ctx, (const float *)ctx->lights,
                                           surf_load(ctx, g, l, ctx->frame->camera.eye), key_of(ctx, x, y, l),
                                           KU(ctx->light_count), m),
                         r);
        resv_store(out, l, r);
    }
}

static uint32_t project(const struct core_context *ctx, const gblock *g, float px[BLOCK], float py[BLOCK]) {
    camera c = camera_of(ctx->frame->previous);
    uint32_t front = 0;
    for (int l = 0; l < BLOCK; l += LANES) {
        v3 q = camera_project(c, V3(rload(g->px + l), rload(g->py + l), rload(g->pz + l)));
        rstore(px + l, q.x);
        rstore(py + l, q.y);
        front |= mbits(q.z > K(0.0f)) << l;
    }
    return front;
}

static void segments(const struct core_context *ctx, const gblock *g, const uint32_t *id, const float *u,
                     const float *v, rayblock *out) {
    for (int l = 0; l < BLOCK; l += LANES) {
        v3 p = V3(rload(g->px + l), rload(g->py + l), rload(g->pz + l));
        v3 n = V3(rload(g->nx + l), rload(g->ny + l), rload(g->nz + l));
        segment s = shadow_segment(p, n, light_load(ctx, uload(id + l)), rload(u + l), rload(v + l), K(ctx->stand_off));
        ray_store(out, l, s.o, s.d);
    }
}

/* ---- combination ---- */

static stream stream_of(const combination *c, int l) {
    stream s;
    s.light = uload(c->light + l);
    s.u = rload(c->u + l);
    s.v = rload(c->v + l);
    s.p = rload(c->p + l);
    s.w_sum = rload(c->w_sum + l);
    s.m = rload(c->m + l);
    s.tag = rload(c->tag + l);
    return s;
}

static void stream_store(combination *c, int l, stream s) {
    ustore(c->light + l, s.light);
    rstore(c->u + l, s.u);
    rstore(c->v + l, s.v);
    rstore(c->p + l, s.p);
    rstore(c->w_sum + l, s.w_sum);
    rstore(c->m + l, s.m);
    rstore(c->tag + l, s.tag);
}

static real others(const neighbour *n, int k, int l) {
    real sum = K(0.0f);
    for (int i = 0; i < k; i++)
        sum = sum + rload(n[i].r.m + l);
    return sum;
}

static void offer(const struct core_context *ctx, const gblock *g, const rblock *own, const neighbour *n, int k, int x,
                  int y, uint32_t dim, combination *c) {
    for (int l = 0; l < BLOCK; l += LANES) {
        u32 key = key_of(ctx, x, y, l);
        surf s = surf_load(ctx, g, l, ctx->frame->camera.eye);
        resv r = resv_load(own, l);
        stream st = stream_add(stream_empty(), r.light, r.u, r.v, r.p, r.m * r.p * r.w, r.m, K(0.0f), K(0.0f));
        for (int i = 0; i < k; i++) {
            resv q = resv_load(&n[i].r, l);
            mask has = q.w > K(0.0f);
            real p = K(0.0f);
            if (ANY(has))
                p = sel(has, target(s, light_load(ctx, q.light), q.u, q.v), K(0.0f));
            st = stream_add(st, q.light, q.u, q.v, p, q.m * p * q.w, q.m, K(F32(i + 1)),
                            rng(key, KU(dim + 3u * U32(i) + 2u)));
        }
        stream_store(c, l, st);
    }
}

static void targets(const struct core_context *ctx, const float eye[3], const neighbour *n, int k, const uint32_t *id,
                    const float *u, const float *v, combination *c) {
    for (int l = 0; l < BLOCK; l += LANES) {
        struct light li = light_load(ctx, uload(id + l));
        for (int i = 0; i < k; i++) {
            mask on = mload(n[i].lanes, l);
            real p = K(0.0f);
            if (ANY(on))
                p = sel(on, target(surf_load(ctx, &n[i].g, l, eye), li, rload(u + l), rload(v + l)), K(0.0f));
            rstore(c->p_at[i] + l, p);
        }
    }
}

static void end_biased(const combination *c, rblock *out) {
    for (int l = 0; l < BLOCK; l += LANES) {
        stream s = stream_of(c, l);
        resv_store(out, l, stream_end(s, mis_scale(K(1.0f), s.m)));
    }
}

static void end_mis(const combination *c, const rblock *own, const neighbour *n, int k, const uint32_t *visible,
                    rblock *out) {
    for (int l = 0; l < BLOCK; l += LANES) {
        stream s = stream_of(c, l);
        real held = s.p;
        real all = rload(own->m + l) * s.p;
        for (int i = 0; i < k; i++) {
            real p = sel(mload(visible[i], l), rload(c->p_at[i] + l), K(0.0f));
            all = all + rload(n[i].r.m + l) * p;
            held = sel(s.tag == K(F32(i + 1)), p, held);
        }
        resv_store(out, l, stream_end(s, mis_scale(held, all)));
    }
}

static void end_pairwise(const struct core_context *ctx, const gblock *g, const rblock *own, const neighbour *n, int k,
                         const uint32_t *visible, int x, int y, uint32_t dim, combination *c, rblock *out) {
    for (int l = 0; l < BLOCK; l += LANES) {
        u32 key = key_of(ctx, x, y, l);
        surf s = surf_load(ctx, g, l, ctx->frame->camera.eye);
        resv r = resv_load(own, l);
        real m_n = others(n, k, l);
        real inv = mis_scale(K(1.0f), m_n);
        real m_c = sel(m_n > K(0.0f), K(0.0f), K(1.0f));
        stream st = stream_empty();
        for (int i = 0; i < k; i++) {
            resv q = resv_load(&n[i].r, l);
            real share = q.m * inv;
            real p_c = sel(mload(visible[i], l), rload(c->p_at[i] + l), K(0.0f));
            m_c = m_c + pair_canonical(share, m_n, p_c, r.m, r.p);
            mask has = q.w > K(0.0f);
            real p = K(0.0f);
            if (ANY(has))
                p = sel(has, target(s, light_load(ctx, q.light), q.u, q.v), K(0.0f));
            real w = sel(has, pair_weight(share, m_n, q.p, r.m, p, q.w), K(0.0f));
            st = stream_add(st, q.light, q.u, q.v, p, w, q.m, K(F32(i + 1)), rng(key, KU(dim + 3u * U32(i) + 2u)));
        }
        st = stream_add(st, r.light, r.u, r.v, r.p, m_c * r.p * r.w, r.m, K(0.0f),
                        rng(key, KU(dim + 3u * MAX_NEIGHBOURS)));
        stream_store(c, l, st);
        resv_store(out, l, stream_end(st, K(1.0f)));
    }
}

/* ---- shading ---- */

/* rgb += c for `on`, unless that is not finite. Returns the lanes that were dropped. */
static uint32_t add_colour(cblock *out, int l, v3 c, uint32_t lanes) {
    real y = abs_(c.x) + abs_(c.y) + abs_(c.z);
    mask good = y < K(1e30f); /* false for NaN */
    mask on = and_(mload(lanes, l), good);
    rstore(out->rgb[0] + l, rload(out->rgb[0] + l) + sel(on, c.x, K(0.0f)));
    rstore(out->rgb[1] + l, rload(out->rgb[1] + l) + sel(on, c.y, K(0.0f)));
    rstore(out->rgb[2] + l, rload(out->rgb[2] + l) + sel(on, c.z, K(0.0f)));
    return (lanes >> l & ~mbits(good) & ((1u << LANES) - 1)) << l;
}

static uint32_t shade(const struct core_context *ctx, const gblock *g, const rblock *r, uint32_t lanes, cblock *out) {
    uint32_t dropped = 0;
    for (int l = 0; l < BLOCK; l += LANES) {
        mask on = mload(lanes, l);
        if (!ANY(on))
            continue;
        surf s = surf_load(ctx, g, l, ctx->frame->camera.eye);
        light_sample ls = sample_light(light_load(ctx, uload(r->light + l)), s.p, rload(r->u + l), rload(r->v + l));
        dropped |= add_colour(out, l, mul3(reflected(s, ls), rload(r->w + l)), lanes);
    }
    return dropped;
}

/* ---- sky ---- */

static void sky_rays(const struct core_context *ctx, const gblock *g, int x, int y, const uint32_t *number,
                     rayblock *out) {
    const float reach = 1e7f; /* further than any scene */
    for (int l = 0; l < BLOCK; l += LANES) {
        v3 at = sky_numbers(key_in(ctx, x, y, l, 0), uload(number + l));
        surf s = surf_load(ctx, g, l, ctx->frame->camera.eye);
        mask on = dot3(s.n, s.n) > K(0.5f);
        s.n = sel3(on, s.n, V3(K(0.0f), K(0.0f), K(1.0f)));
        v3 d = sky_direction(s, at.x, at.y);
        ray_store(out, l, add3(s.p, mul3(s.n, stand_off(max_abs3(s.p), K(ctx->stand_off)))), mul3(d, K(reach)));
    }
}

static uint32_t sky_shade(const struct core_context *ctx, const gblock *g, const rayblock *rays, const float *share,
                          uint32_t lanes, cblock *out) {
    uint32_t dropped = 0;
    real zenith = K(ctx->frame->sky);
    for (int l = 0; l < BLOCK; l += LANES) {
        surf s = surf_load(ctx, g, l, ctx->frame->camera.eye);
        v3 d = V3(rload(rays->d[0] + l), rload(rays->d[1] + l), rload(rays->d[2] + l));
        d = mul3(d, K(1e-7f));
        real p = sky_density(s, d);
        mask some = p > K(0.0f);
        v3 f = mul3(tint3(reflect(s, d), sky_radiance(d, zenith)),
                    sel(some, rload(share + l) / sel(some, p, K(1.0f)), K(0.0f)));
        dropped |= add_colour(out, l, f, lanes);
    }
    return dropped;
}

static void sky_background(const struct core_context *ctx, uint32_t lanes, int x, int y, cblock *out) {
    camera cam = camera_of(ctx->frame->camera);
    real zenith = K(ctx->frame->sky);
    for (int l = 0; l < BLOCK; l += LANES) {
        v3 d = camera_direction(cam, to_real(lane_x(x, l)) + K(ctx->frame->camera.jitter[0]),
                                to_real(lane_y(y, l)) + K(ctx->frame->camera.jitter[1]));
        d = mul3(d, K(1.0f) / sqrt_(dot3(d, d)));
        add_colour(out, l, sky_backdrop(d, zenith), lanes);
    }
}

#include "backend/cpu/lists_tmpl.h"
#include "backend/cpu/picks_tmpl.h"
#include "backend/cpu/influence_tmpl.h"
#include "backend/cpu/reference_tmpl.h"

const kernels KERNELS = {
    .name = KERNELS_NAME,
    .candidates = candidates,
    .list_build = build_list,
    .list_candidates = list_candidates,
    .list_fill = fill_list,
    .list_share = list_share,
    .list_ray = list_ray_of,
    .list_show = list_show,
    .list_keep = list_keep,
    .list_mix = list_mix,
    .pick_power = pick_power,
    .pick_tree = pick_tree,
    .influence_find = influence_find,
    .pick_influence = pick_influence,
    .given = given,
    .project = project,
    .segments = segments,
    .offer = offer,
    .targets = targets,
    .end_biased = end_biased,
    .end_mis = end_mis,
    .end_pairwise = end_pairwise,
    .shade = shade,
    .reference = reference,
    .reference_place = reference_place,
    .sky_rays = sky_rays,
    .sky_shade = sky_shade,
    .sky_background = sky_background,
};
