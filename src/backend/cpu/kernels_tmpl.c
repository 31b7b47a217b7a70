/* Kernels of reuse and shading: core/ applied to blocks of pixels. Compiled once as scalar C and once an instruction
 * set, with CORE_LANES and KERNELS (the table's name) defined by the build. */
#include "backend/cpu/lanes_tmpl.h"
#include "core/headlight.h"
#include "core/measured.h"
#include "core/primary.h"
#include "core/shading.h"

FN v3 corner_load(const struck_block *h, int corner, int l) {
    return V3(rload(h->at[corner][0] + l), rload(h->at[corner][1] + l), rload(h->at[corner][2] + l));
}

FN v3 ray_direction(const rayblock *rays, int l) {
    return V3(rload(rays->d[0] + l), rload(rays->d[1] + l), rload(rays->d[2] + l));
}

FN ray_hit hit_load(const struck_block *h, const rayblock *rays, int l) {
    return (ray_hit){ { corner_load(h, 0, l), corner_load(h, 1, l), corner_load(h, 2, l) },
                      rload(h->u + l),
                      rload(h->v + l),
                      rload(h->t + l),
                      ray_direction(rays, l),
                      uload(h->material + l),
                      uload(h->light + l) };
}

FN placement placement_load(const struck_block *h, int l) {
    v3 column[4];
    for (int k = 0; k < 4; k++)
        column[k] = V3(rload(h->transform[k] + l), rload(h->transform[4 + k] + l), rload(h->transform[8 + k] + l));
    return (placement){ V3(column[0].x, column[1].x, column[2].x), V3(column[0].y, column[1].y, column[2].y),
                        V3(column[0].z, column[1].z, column[2].z), column[3] };
}

/* Albedos of the lanes that see a texture; 0 of others. */
FN u32 texels_of(CTX const struck_block *h, const rayblock *rays, ray_hit q, v3 n, placement m, int l) {
    mask on = mload(h->textured, l);
    if (!ANY(on))
        return KU(0u);
    image_corners at = {
        V3(rload(h->image[0][0] + l), rload(h->image[1][0] + l), rload(h->image[2][0] + l)),
        V3(rload(h->image[0][1] + l), rload(h->image[1][1] + l), rload(h->image[2][1] + l)),
    };
    v3 first = V3(K(rays->d[0][0]), K(rays->d[1][0]), K(rays->d[2][0]));
    v3 below = V3(K(rays->d[0][4]), K(rays->d[1][4]), K(rays->d[2][4]));
    real scale2 = sel(mload(h->placed, l), placement_scale2(m), K(1.0f));
    real width = hit_width(q, n, rays_apart2(first, below), scale2);
    v3 albedo = materials_load(ctx->materials, selu(on, q.material, KU(0u))).albedo;
    return selu(on, hit_texel(ctx, q, uload(h->texture + l), at, width, albedo), KU(0u));
}

static void hits(const struct core_context *ctx, const rayblock *rays, const struck_block *h, gblock *g) {
    for (int l = 0; l < BLOCK; l += LANES) {
        mask on = mload(h->lanes, l), placed = mload(h->placed, l);
        receiver r = receiver_none();
        u32 texel = KU(0u);
        if (ANY(on)) {
            ray_hit q = hit_load(h, rays, l);
            placement m = placement_load(h, l);
            r = receiver_sel(on, receiver_of_hit(ctx, q, placed, m), r);
            texel = texels_of(ctx, h, rays, q, r.n, m, l);
        }
        receiver_store(g, l, r);
        ustore(g->texel + l, texel);
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
    mask on = and_(mload(lanes, l), lux_adds(e));
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
    .presample = presample_lights,
    .presampled = presampled,
    .list_build = build_list,
    .list_candidates = list_candidates,
    .list_fill = fill_list,
    .list_share = share_block,
    .list_ray = list_ray_of,
    .list_stand_in = stand_ins,
    .list_resample = resample_rays,
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
