/* Rays of whoever picks, measures or walks. */
#include "render/view.h"

#include <math.h>

static bool in_order(const noc_ray *r) {
    double most = 0;
    for (int k = 0; k < 3; k++) {
        if (!(fabs(r->origin[k]) < 1e7 && isfinite(r->direction[k])))
            return false;
        most = fmax(most, fabs(r->direction[k]));
    }
    return most > 1e-100 && most < 1e100 && !isnan(r->far);
}

noc_status noc_view_cast(noc_view *v, const noc_ray *rays, size_t count, noc_hit *hits) {
    if (!v || (count && (!rays || !hits)))
        return noc_null(v ? v->log : NULL, __func__);
    for (size_t i = 0; i < count; i++)
        if (!in_order(&rays[i]))
            return noc_error(v->log, NOC_ERR_ARGUMENT,
                             "cast: ray %zu: its origin must be within 10 000 km, its direction finite and not 0, its "
                             "far a number",
                             i);
    noc_scene_lock_frame(v->scene); /* the structure follows what is published, and stays as it is */
    noc_status status = v->backend->cast(v->state, rays, count, hits);
    noc_scene_unlock_frame(v->scene);
    return status;
}

#define LOOKED_THROUGH                                                                                                 \
    (1u << NOC_CLASS_TREE | 1u << NOC_CLASS_LAMP | 1u << NOC_CLASS_FURNITURE | 1u << NOC_CLASS_VEHICLE |               \
     1u << NOC_CLASS_INSTALLATION)
enum { THROUGH = 8, DOWN_CHUNK = 4096 }; /* surfaces that a ray goes through; rays at once */

#define COVERS 2.5 /* m: what is lower over the ground covers it */
#define LEVEL 0.5  /* cosine of 60 degrees: what is steeper is the side of something */
#define OVER 0.05  /* m over the ground: rays to the sides, which are so long: trunks and poles are narrower */
#define WIDE 3.0
enum { SIDES = 5 };

/* Rays that go down, which of the places they are for, and what they have gone through. */
typedef struct down_rays {
    noc_ray ray[DOWN_CHUNK];
    noc_hit hit[DOWN_CHUNK];
    size_t of[DOWN_CHUNK];
    int inside[DOWN_CHUNK];    /* bodies that it has entered and not left */
    double lowest[DOWN_CHUNK]; /* of those surfaces */
    size_t under[DOWN_CHUNK];  /* places of ground that lies under something */
    size_t under_count;
} down_rays;

/* Behind that surface; ray i becomes ray `to`. */
static void go_through(down_rays *d, size_t i, size_t to) {
    const noc_hit *h = &d->hit[i];
    d->of[to] = d->of[i];
    d->ray[to] = d->ray[i];
    d->ray[to].origin[2] = h->place[2] - 1e-3;
    d->inside[to] = d->inside[i] + (h->front ? 1 : -1);
    d->lowest[to] = h->place[2];
}

static bool is_ground(const noc_hit *h, uint32_t classes) {
    return h->hit && classes >> h->cls & 1 && h->normal[2] > LEVEL;
}

static bool is_open(const down_rays *d, size_t i) {
    return d->inside[i] <= 0 && d->lowest[i] > d->hit[i].place[2] + COVERS;
}

static noc_status cast_down(noc_view *v, down_rays *d, size_t count, uint32_t classes, noc_hit *hits) {
    for (int turn = 0; turn < THROUGH && count; turn++) {
        noc_status status = noc_view_cast(v, d->ray, count, d->hit);
        if (status != NOC_OK)
            return status;
        size_t left = 0;
        for (size_t i = 0; i < count; i++) {
            const noc_hit *h = &d->hit[i];
            if (h->hit && (LOOKED_THROUGH >> h->cls & 1 || h->light >= 0))
                go_through(d, i, left++);
            else if (is_ground(h, classes)) {
                hits[d->of[i]] = *h;
                hits[d->of[i]].hit = is_open(d, i);
                if (is_open(d, i) && isfinite(d->lowest[i]))
                    d->under[d->under_count++] = d->of[i];
            }
        }
        count = left;
    }
    return NOC_OK;
}

/* A trunk or a pole may have no lid, and its top lie in what it carries: then rays down do not enter it. What stands
 * there is known by all rays to the sides meeting it from within. */
static noc_status leave_out_insides(noc_view *v, down_rays *d, noc_hit *hits) {
    for (size_t from = 0; from < d->under_count;) {
        size_t n = NOC_MIN(d->under_count - from, (size_t)DOWN_CHUNK / SIDES);
        for (size_t i = 0; i < n * SIDES; i++) {
            const double *p = hits[d->under[from + i / SIDES]].place;
            double angle = 0.37 + 2 * M_PI * (double)(i % SIDES) / SIDES;
            d->ray[i] = (noc_ray){ { p[0], p[1], p[2] + OVER }, { cos(angle), sin(angle), 0 }, WIDE };
        }
        noc_status status = noc_view_cast(v, d->ray, n * SIDES, d->hit);
        for (size_t i = 0; i < n && !status; i++) {
            bool inside = true;
            for (size_t k = i * SIDES; k < (i + 1) * SIDES; k++)
                inside = inside && d->hit[k].hit && !d->hit[k].front && LOOKED_THROUGH >> d->hit[k].cls & 1;
            hits[d->under[from + i]].hit = !inside;
        }
        if (status)
            return status;
        from += n;
    }
    return NOC_OK;
}

noc_status noc_view_cast_down(noc_view *v, const double (*xy)[2], size_t count, uint32_t classes, noc_hit *hits) {
    static const noc_hit none = { .material = -1, .object = -1, .instance = -1, .light = -1 };
    if (!v || (count && (!xy || !hits)))
        return noc_null(v ? v->log : NULL, __func__);
    down_rays *d = noc_alloc(sizeof(*d));
    if (!d)
        return noc_no_memory(v->log, "cast");
    noc_scene_info info;
    noc_scene_get_info(v->scene, &info);
    noc_status status = NOC_OK;
    for (size_t i = 0; i < count && !status;) {
        size_t n = 0;
        for (; n < DOWN_CHUNK && i < count; i++, n++) {
            hits[i] = none;
            d->of[n] = i;
            d->inside[n] = 0;
            d->lowest[n] = INFINITY;
            d->ray[n] = (noc_ray){ { xy[i][0], xy[i][1], info.bounds_max[2] + 1 }, { 0, 0, -1 }, INFINITY };
        }
        d->under_count = 0;
        status = cast_down(v, d, n, classes, hits);
        status = status ? status : leave_out_insides(v, d, hits);
    }
    free(d);
    return status;
}
