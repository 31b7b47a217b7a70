/* Kernels of reuse and shading: core/ applied to blocks of pixels. Compiled once as scalar C and once an instruction
 * set, with CORE_LANES and KERNELS (the table's name) defined by the build. */
#include "backend/cpu/lanes_tmpl.h"
#include "core/headlight.h"
#include "core/hit.h"
#include "core/shading.h"

FN v3 corner_load(const cornerblock *c, int corner, int l) {
    return V3(rload(c->at[corner][0] + l), rload(c->at[corner][1] + l), rload(c->at[corner][2] + l));
}

static void hits(const cornerblock *c, gblock *g) {
    for (int l = 0; l < BLOCK; l += LANES) {
        corners t = { corner_load(c, 0, l), corner_load(c, 1, l), corner_load(c, 2, l) };
        v3 p = hit_point(t, rload(c->u + l), rload(c->v + l));
        v3 n = hit_normal(t);
        rstore(g->px + l, p.x);
        rstore(g->py + l, p.y);
        rstore(g->pz + l, p.z);
        rstore(g->nx + l, n.x);
        rstore(g->ny + l, n.y);
        rstore(g->nz + l, n.z);
    }
}

static void texels(const struct core_context *ctx, const cornerblock *c, const imageblock *image, uint32_t lanes,
                   gblock *g) {
    for (int l = 0; l < BLOCK; l += LANES) {
        mask on = mload(lanes, l);
        if (!ANY(on))
            continue;
        corners t = { corner_load(c, 0, l), corner_load(c, 1, l), corner_load(c, 2, l) };
        image_corners at;
        at.u = V3(rload(image->at[0][0] + l), rload(image->at[1][0] + l), rload(image->at[2][0] + l));
        at.v = V3(rload(image->at[0][1] + l), rload(image->at[1][1] + l), rload(image->at[2][1] + l));
        real u = image_at(at.u, rload(c->u + l), rload(c->v + l)), v = image_at(at.v, rload(c->u + l), rload(c->v + l));
        u32 place = uload(image->place + l), m = selu(on, uload(g->material + l), KU(0u));
        v3 a = texture_albedo(ctx, place, u, v, texture_level(ctx, place, t, at, rload(image->width + l)));
        v3 of = V3(material_field(ctx->materials, m, 0), material_field(ctx->materials, m, 1),
                   material_field(ctx->materials, m, 2));
        ustore(g->texel + l, selu(on, texel_pack(tint3(a, of)), KU(0u)));
    }
}

static void segments(const struct core_context *ctx, const gblock *g, const uint32_t *id, const float *u,
                     const float *v, rayblock *out) {
    for (int l = 0; l < BLOCK; l += LANES) {
        v3 p = V3(rload(g->px + l), rload(g->py + l), rload(g->pz + l));
        v3 n = V3(rload(g->nx + l), rload(g->ny + l), rload(g->nz + l));
        segment s =
            shadow_segment(p, n, light_load(ctx, uload(id + l)), rload(u + l), rload(v + l), K(ctx->ray_offset));
        ray_store(out, l, s.o, s.d);
    }
}

/* ---- shading ---- */

/* rgb += c for `on`, unless that is not finite. Returns the lanes that were dropped. */
static uint32_t add_colour(cblock *out, int l, v3 c, uint32_t lanes) {
    mask good = colour_finite(c);
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
        reservoir q = reservoir_load(r, l);
        surf s = surf_load(ctx, g, l, ctx->frame->camera.eye);
        dropped |= add_colour(out, l, sample_shade(ctx, s, q, light_load(ctx, q.light)), lanes);
    }
    return dropped;
}

static uint32_t shade_known(const cblock *brings, const float w[BLOCK], uint32_t lanes, cblock *out) {
    uint32_t dropped = 0;
    for (int l = 0; l < BLOCK; l += LANES) {
        v3 c = V3(rload(brings->rgb[0] + l), rload(brings->rgb[1] + l), rload(brings->rgb[2] + l));
        dropped |= add_colour(out, l, mul3(c, rload(w + l)), lanes);
    }
    return dropped;
}

/* ---- sky ---- */

static void sky_rays(const struct core_context *ctx, const gblock *g, int x, int y, const uint32_t *number,
                     rayblock *out) {
    for (int l = 0; l < BLOCK; l += LANES) {
        segment r = sky_ray(ctx, surf_load(ctx, g, l, ctx->frame->camera.eye), key_in(ctx, x, y, l, 0),
                            uload(number + l), K(ctx->ray_offset));
        ray_store(out, l, r.o, r.d);
    }
}

static uint32_t sky_light(const struct core_context *ctx, const gblock *g, const rayblock *rays, const float *share,
                          uint32_t lanes, cblock *out) {
    uint32_t dropped = 0;
    for (int l = 0; l < BLOCK; l += LANES) {
        v3 way = V3(rload(rays->d[0] + l), rload(rays->d[1] + l), rload(rays->d[2] + l));
        surf s = surf_load(ctx, g, l, ctx->frame->camera.eye);
        dropped |= add_colour(out, l, sky_shade(ctx, s, way, rload(share + l)), lanes);
    }
    return dropped;
}

/* ---- illuminance ---- */

static void add_lux(float *lux, int l, real e, uint32_t lanes) {
    mask on = and_(mload(lanes, l), and_(e >= K(0.0f), e < K(1e30f)));
    rstore(lux + l, rload(lux + l) + sel(on, e, K(0.0f)));
}

static void samples_lux(const struct core_context *ctx, const gblock *g, const rblock *r, uint32_t lanes, float *lux) {
    for (int l = 0; l < BLOCK; l += LANES) {
        reservoir q = reservoir_load(r, l);
        surf s = surf_load(ctx, g, l, ctx->frame->camera.eye);
        add_lux(lux, l, sample_lux(ctx, s, q, light_load(ctx, q.light)), lanes);
    }
}

static void sky_illuminance(const struct core_context *ctx, const gblock *g, const rayblock *rays, const float *share,
                            uint32_t lanes, float *lux) {
    for (int l = 0; l < BLOCK; l += LANES) {
        v3 way = V3(rload(rays->d[0] + l), rload(rays->d[1] + l), rload(rays->d[2] + l));
        surf s = surf_load(ctx, g, l, ctx->frame->camera.eye);
        add_lux(lux, l, sky_lux(ctx, s, way, rload(share + l)), lanes);
    }
}

static void sky_background(const struct core_context *ctx, uint32_t lanes, int x, int y, cblock *out) {
    for (int l = 0; l < BLOCK; l += LANES)
        add_colour(out, l, sky_behind(ctx, lane_x(x, l), lane_y(y, l)), lanes);
}

static void headlight(const struct core_context *ctx, const gblock *g, uint32_t lanes, cblock *out) {
    for (int l = 0; l < BLOCK; l += LANES)
        add_colour(out, l,
                   headlight_shade(surf_load(ctx, g, l, ctx->frame->camera.eye), rload(g->depth + l),
                                   K(ctx->frame->sky)),
                   lanes);
}

#include "backend/cpu/reuse_tmpl.h"
#include "backend/cpu/lists_tmpl.h"
#include "backend/cpu/picks_tmpl.h"
#include "backend/cpu/presampled_tmpl.h"
#include "backend/cpu/influence_tmpl.h"
#include "backend/cpu/reference_tmpl.h"

const kernels KERNELS = {
    .name = KERNELS_NAME,
    .hits = hits,
    .texels = texels,
    .presample = presample_lights,
    .subset_of = subset_of,
    .presampled = presampled,
    .list_build = build_list,
    .list_candidates = list_candidates,
    .list_fill = fill_list,
    .list_share = list_share,
    .list_ray = list_ray_of,
    .list_show = list_show,
    .list_keep = list_keep,
    .list_mix = list_mix,
    .pick_tree = pick_tree,
    .influence_volumes = influence_volumes,
    .influence_find = find_influence,
    .influence_draw = draw_influence,
    .given = given,
    .history_places = history_places,
    .neighbours = fetch_neighbours,
    .segments = segments,
    .reuse_begin = combine_begin,
    .reuse_ask = combine_ask,
    .reuse_end = combine_end,
    .shade = shade,
    .shade_known = shade_known,
    .reference = reference,
    .reference_place = reference_places,
    .sky_rays = sky_rays,
    .sky_shade = sky_light,
    .samples_lux = samples_lux,
    .sky_lux = sky_illuminance,
    .headlight = headlight,
    .sky_background = sky_background,
};
