/* core/list_rays.h: several shadow rays a pixel over its tile's list. Asking: a pixel weighs all entries, and shares
 * its rays out over them systematically; using: what the rays found becomes light, or one sample that stands for all.
 * How many rays, and which entries, is steered by what is expected of the lights' visibility (core/learned.h), and by
 * lights in brief where they are far (core/list_sketch.h). No mean depends on that, as long as it was settled before
 * any of these rays, and each is divided by the very weight that chose it.
 *
 * Includers supply the bridge below: what one pixel (in C, LANES pixels) knows of each entry and of each of its rays.
 */
#ifndef CORE_LIST_RAYS_H
#define CORE_LIST_RAYS_H

#include "core/list_faces.h"
#include "core/list_mix.h"
#include "core/lists.h"

/* Sums over entries: steer * share, and steer * expect, cd/m2. steer: the target, about, where a light is far. */
struct list_sums {
    real all;
    real bright;
};

#ifndef CORE_GLSL
typedef struct list_sums list_sums;
#endif

/* What a pixel shares out: its sums, draws, and how many rays these became. */
struct list_shared {
    list_sums sums;
    real draws;
    u32 rays;
};

/* A ray to one of the entries. */
struct list_ray {
    u32 light;
    real u;
    real v;
    real w; /* unbiased contribution weight W of what it finds; 0: there is no such ray */
    real p; /* target there, unshadowed */
    light_sample at;
    v3 brings; /* what the surface reflects of it, unshadowed, cd/m2; times w, its part of the pixel's colour */
};

/* An entry that was drawn so often, and what it was weighed. */
struct list_drawn {
    u32 entry;
    real times;
    real weighed;
};

/* One of a pixel's rays, and its W, which stands for all of them. */
struct list_kept {
    u32 ray;
    real w; /* 0: none was seen */
};

/* What is known of one of a pixel's rays. */
struct list_found {
    u32 entry;
    real times; /* it was drawn so often */
    real w;     /* of the list_ray; 0 where it is blocked */
    real p;
};

#ifndef CORE_GLSL
typedef struct list_shared list_shared;
typedef struct list_ray list_ray;
typedef struct list_drawn list_drawn;
typedef struct list_kept list_kept;
typedef struct list_found list_found;
#endif

FN list_prior prior_load(CTX u1 place); /* of the list's rows, 16 a row, for the surfaces at hand */
FN u32 entry_light(CTX u32 i);
FN real entry_weight(CTX u32 i);
FN u1 near_entry(CTX u1 i); /* that is near for some pixels of the block */
FN u1 near_place(CTX u1 i);
FN mask near_pixels(CTX u1 i);            /* is it for those at hand? */
FN void summed_store(CTX u1 i, real sum); /* steer * share of all near entries before i */
FN real summed_at(CTX u32 i);
FN u32 near_entry_at(CTX u32 i);
FN real far_at(CTX u32 face, u32 row, u32 column); /* as far_store and column_store had them */
FN real column_at(CTX u32 face, u32 column);
FN void drawn_store(CTX u32 ray, mask on, list_drawn d); /* ray number `ray` of the lanes in `on` */
FN real drawn_times(CTX u1 ray);                         /* 0: no such ray */
FN real found_p(CTX u1 ray);                             /* of the list_ray */
FN real found_w(CTX u1 ray);                             /* 0 where the ray was blocked */
FN list_found found_of(CTX u32 ray);                     /* of each lane another ray */

/* ---- ask ---- */

/* What an entry is weighed by where it is near for the pixel's face: in full, with the place that it is evaluated at,
 * where it is near for the pixel too. */
FN real list_steer(CTX surf s, sketch_surf q, mask on, u1 entry, u1 place, u32 shift_u, u32 shift_v) {
    list_sketch k = sketch_load(PASS place);
    real d2 = sketch_distance2(k, s.p);
    mask near = and_(on, sketch_near(s, q, k, d2, K(0.0f)));
    real p = K(0.0f);
    if (ANY(and_(on, not_(near))))
        p = sel(on, sketch_target(PASS s, q, k, d2, K(0.0f), K(0.0f)), p);
    if (ANY(near)) {
        light l = light_splat(PASS entry_load(PASS entry).light);
        p = sel(near, target(PASS s, l, list_u(shift_u, KU(entry)), list_v(shift_v, KU(entry))), p);
    }
    return p;
}

/* Weighs the near ones. */
FN list_sums list_weigh(CTX surf s, u32 key, u1 near) {
    list_sums sums;
    sums.all = K(0.0f);
    sums.bright = K(0.0f);
    u32 shift_u = rng_bits(key, KU(DIM_LIST_PLACE));
    u32 shift_v = rng_bits(key, KU(DIM_LIST_PLACE + 1u));
    sketch_surf q = sketch_surf_of(s);
    for (u1 i = 0u; i < near; i++) {
        summed_store(PASS i, sums.all);
        list_prior b = prior_load(PASS near_place(PASS i));
        real p = list_steer(PASS s, q, near_pixels(PASS i), near_entry(PASS i), near_place(PASS i), shift_u, shift_v);
        EXACT real w = p * K(b.share);
        EXACT real all = sums.all + w;
        EXACT real bright = sums.bright + p * K(b.expect);
        sums.all = all;
        sums.bright = bright;
    }
    summed_store(PASS near, sums.all);
    return sums;
}

#define LIST_RAYS_MOST 8.0f /* that a pixel can ask for */

/* Rays that a pixel asks for: twice as many where hardly any frame stands behind it, whose samples would be reused. */
FN real list_asks(f1 rays, mask fresh) { return sel(fresh, K(min1(2.0f * rays, LIST_RAYS_MOST)), K(rays)); }

/* Draws of a pixel: as many as asked for where nothing is known, more where little light is expected to get through, up
 * to twice as many. A hundredth of the picture's brightness is dark enough not to look for more. */
FN real list_draws(list_sums sums, real rays, f1 brightness, real rounding) {
    EXACT f1 unknown = LEARNED_UNKNOWN / learned_pull(LEARNED_UNKNOWN);
    EXACT real mean = rays * K(unknown) * sums.all / (sums.bright + K(0.01f * brightness));
    /* a sum that is rounded up must not be a draw too many: there is no room for it */
    real n = to_real(to_u32(min_(max_(mean, K(1.0f)) + rounding, rays + rays)));
    return sel(sums.all > K(0.0f), n, K(0.0f));
}

/* The near entry where `goal` falls: the last one before which no more than that has been summed up. A goal that
 * rounding has pushed past the end is of the last entry with any weight. */
FN list_drawn near_at(CTX u1 count, real end, real goal) {
    list_drawn d;
    u32 i = KU(0u);
    for (u1 step = U32(LIST_ROOM) / 2u; step > 0u; step = step / 2u) {
        if (step < count) {
            u32 next = i + KU(step);
            mask there = next < KU(count);
            real sum = summed_at(PASS selu(there, next, KU(0u)));
            i = selu(and_(there, and_(sum <= goal, sum < end)), next, i);
        }
    }
    EXACT real weighed = summed_at(PASS i + KU(1u)) - summed_at(PASS i);
    d.entry = near_entry_at(PASS i);
    d.weighed = weighed;
    d.times = K(1.0f);
    return d;
}

/* The same of a face's far entries: the column first, then the row. */
FN list_drawn far_entry_at(CTX u32 face, u1 rows, real all, real goal) {
    list_drawn d;
    u32 column = KU(0u);
    real before = K(0.0f);
    for (u1 step = 8u; step > 0u; step = step / 2u) {
        u32 next = column + KU(step);
        real sum = column_at(PASS face, next);
        mask there = and_(sum <= goal, sum < all);
        column = selu(there, next, column);
        before = sel(there, sum, before);
    }
    EXACT real rest = goal - before;
    u32 row = KU(0u);
    before = K(0.0f);
    real end = far_at(PASS face, KU(rows), column);
    for (u1 step = U32(LIST_ROWS) / 2u; step > 0u; step = step / 2u) {
        if (step < rows) {
            u32 next = row + KU(step);
            mask there = next < KU(rows);
            real sum = far_at(PASS face, selu(there, next, KU(0u)), column);
            there = and_(there, and_(sum <= rest, sum < end));
            row = selu(there, next, row);
            before = sel(there, sum, before);
        }
    }
    EXACT real weighed = far_at(PASS face, row + KU(1u), column) - before;
    d.entry = column * KU(rows) + row;
    d.weighed = weighed;
    d.times = K(1.0f);
    return d;
}

/* Systematic draws: draw k < n is of the entry where the share (k + start) / n of all the weights lies, and the near
 * entries come before the far ones. Draws of one entry follow each other and are one ray. Returns the number of rays.
 * all: of list_sums. */
FN u32 list_share_out(CTX real all, u1 near, u32 face, u1 rows, real n, real start) {
    EXACT real step = all / max_(n, K(1.0f));
    EXACT real goal = step * start;
    real end = summed_at(PASS KU(near));
    real far = column_at(PASS face, KU(16u));
    u32 last = KU(LIST_ROOM);
    real times = K(0.0f);
    u32 rays = KU(0u);
    mask on = n > K(0.0f);
    for (real drawn = K(0.0f); ANY(on); on = drawn < n) {
        mask close = or_(goal < end, not_(far > K(0.0f)));
        list_drawn d;
        d.entry = KU(0u);
        d.weighed = K(1.0f);
        if (ANY(and_(on, close)))
            d = near_at(PASS near, end, goal);
        if (ANY(and_(on, not_(close)))) {
            EXACT real rest = goal - end;
            list_drawn f = far_entry_at(PASS face, rows, far, rest);
            d.entry = selu(close, d.entry, f.entry);
            d.weighed = sel(close, d.weighed, f.weighed);
        }
        mask same = d.entry == last;
        times = sel(same, times, K(0.0f)) + K(1.0f);
        rays = selu(and_(on, not_(same)), rays + KU(1u), rays);
        last = d.entry;
        d.times = times;
        drawn_store(PASS rays - KU(1u), on, d);
        EXACT real beyond = goal + step;
        goal = beyond;
        drawn = drawn + K(1.0f);
    }
    return rays;
}

/* Shares out the rays of a pixel. far: sums of its face; wanted: rays that it asks for (list_asks). */
FN list_shared list_share(CTX surf s, u32 key, mask on, list_sums far, u1 near, u32 face, u1 rows, real wanted,
                          f1 brightness) {
    list_shared q;
    list_sums sums = list_weigh(PASS s, key, near);
    EXACT real all = sums.all + far.all;
    EXACT real bright = sums.bright + far.bright;
    q.sums.all = sel(on, all, K(0.0f));
    q.sums.bright = sel(on, bright, K(0.0f));
    q.draws = list_draws(q.sums, wanted, brightness, rng(key, KU(DIM_LIST_RAYS)));
    q.rays = list_share_out(PASS q.sums.all, near, face, rows, q.draws, rng(key, KU(DIM_LIST_START)));
    return q;
}

/* The ray to an entry that was drawn, whose light is l. There is none to a place that brings nothing. */
FN list_ray list_ask(CTX surf s, list_sums sums, real n, u32 key, list_drawn d, light l) {
    list_ray r;
    EXACT real w = d.times * sums.all / (n * d.weighed) * entry_weight(PASS d.entry);
    r.light = entry_light(PASS d.entry);
    r.u = list_u(rng_bits(key, KU(DIM_LIST_PLACE)), d.entry);
    r.v = list_v(rng_bits(key, KU(DIM_LIST_PLACE + 1u)), d.entry);
    r.at = shining_sample(PASS l, s.p, r.u, r.v);
    lobes f = reflect_lobes(s, r.at.wi);
    r.p = target_of(s, r.at, f);
    r.brings = tint3(reflect_both(s, f), r.at.le);
    r.w = sel(and_(d.times > K(0.0f), r.p > K(0.0f)), w, K(0.0f));
    return r;
}

/* ---- use ---- */

/* One of the draws, at random, as the ray that it became: it stands for the pixel in views of the candidates. */
FN u32 list_shown(CTX u1 rays, real n, real xi) {
    EXACT real at = min_(xi * n, n - K(1.0f));
    u32 ray = KU(0u);
    mask beyond = n > K(0.0f);
    for (u1 k = 0u; k < rays; k++) {
        real times = drawn_times(PASS k);
        beyond = and_(beyond, at >= times);
        at = sel(beyond, at - times, at);
        ray = selu(beyond, KU(k + 1u), ray);
    }
    return ray;
}

/* One of the samples that are seen, by what each adds; its W stands for all of them. */
FN list_kept list_resample(CTX u1 rays, real xi) {
    list_kept kept;
    kept.ray = KU(0u);
    real all = K(0.0f);
    real sum = K(0.0f);
    real p = K(0.0f);
    for (u1 k = 0u; k < rays; k++) {
        EXACT real more = all + found_p(PASS k) * found_w(PASS k);
        all = more;
    }
    EXACT real goal = xi * all;
    mask on = all == all;
    for (u1 k = 0u; k < rays; k++) {
        EXACT real w = found_p(PASS k) * found_w(PASS k);
        on = and_(on, not_(and_(p > K(0.0f), sum > goal)));
        EXACT real more = sum + w;
        sum = sel(on, more, sum);
        mask take = and_(on, w > K(0.0f));
        kept.ray = selu(take, KU(k), kept.ray);
        p = sel(take, found_p(PASS k), p);
    }
    mask some = p > K(0.0f);
    EXACT real w = all / sel(some, p, K(1.0f));
    kept.w = sel(some, w, K(0.0f));
    return kept;
}

/* An entry's sample with such a W. */
FN reservoir list_sample(CTX u32 key, u32 entry, real w, real p, real m) {
    reservoir r;
    r.light = entry_light(PASS entry);
    r.u = list_u(rng_bits(key, KU(DIM_LIST_PLACE)), entry);
    r.v = list_v(rng_bits(key, KU(DIM_LIST_PLACE + 1u)), entry);
    r.w = w;
    r.m = m;
    r.p = p;
    return r;
}

/* The reservoir that stands for a pixel of n draws in views of the candidates; empty where its ray was blocked. */
FN reservoir list_stand_in(CTX u32 key, u1 rays, real n, real m) {
    mask some = n > K(0.0f);
    u32 ray = list_shown(PASS rays, n, rng(key, KU(DIM_LIST_SHOWN)));
    list_found f = found_of(PASS selu(some, ray, KU(0u)));
    EXACT real w = f.w * n / f.times;
    reservoir r = reservoir_empty();
    r.m = m;
    return reservoir_sel(some, list_sample(PASS key, f.entry, w, f.p, m), r);
}

/* The pixel's own reservoir: one of the samples that are seen, if there is one. */
FN reservoir list_resampled(CTX u32 key, u1 rays, reservoir own) {
    list_kept kept = list_resample(PASS rays, rng(key, KU(DIM_LIST_KEPT)));
    list_found f = found_of(PASS kept.ray);
    own.w = K(0.0f);
    return reservoir_sel(kept.w > K(0.0f), list_sample(PASS key, f.entry, kept.w, f.p, own.m), own);
}

#endif
