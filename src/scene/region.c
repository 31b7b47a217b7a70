/* Regions: what is asked about. */
#include "scene/region.h"
#include "scene/scene.h"

#include <math.h>

noc_region *noc_region_create(noc_log *log) {
    noc_region *r = noc_calloc(1, sizeof(*r));
    if (!r) {
        noc_no_memory(log, "region");
        return NULL;
    }
    r->log = log;
    return r;
}

void noc_region_destroy(noc_region *r) {
    if (!r)
        return;
    array_free(&r->patches);
    free(r);
}

static const char *patch_fault(const noc_patch *p) {
    double length = 0;
    for (int k = 0; k < 3; k++) {
        if (!(fabsf(p->p[k]) < 1e7f) || !(fabsf(p->u[k]) < 1e7f) || !(fabsf(p->v[k]) < 1e7f))
            return "its place is not finite, or further than 10 000 km from the origin";
        length += (double)p->n[k] * p->n[k];
    }
    if (!(fabs(length - 1) < 1e-3))
        return "its normal is no unit vector";
    return p->weight > 0 && p->weight < 1e30f ? NULL : "its weight is not above 0";
}

noc_status noc_region_add(noc_region *r, const noc_patch *patches, size_t count) {
    if (!r || (!patches && count))
        return noc_null(r ? r->log : NULL, __func__);
    for (size_t i = 0; i < count; i++) {
        const char *fault = patch_fault(&patches[i]);
        if (fault)
            return noc_error(r->log, NOC_ERR_ARGUMENT, "region: part %zu: %s", i, fault);
    }
    return array_append(&r->patches, patches, count) ? NOC_OK : noc_no_memory(r->log, "region");
}

void noc_region_leave_out(noc_region *r, size_t count) {
    if (r)
        r->left_out += count;
}

static void middle(const noc_patch *p, double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = p->p[k] + ((double)p->u[k] + p->v[k]) / 3;
}

void noc_region_get_info(const noc_region *r, noc_region_info *info) {
    if (!info)
        return;
    *info = (noc_region_info){ 0 };
    if (!r)
        return;
    info->patches = r->patches.len;
    info->left_out = r->left_out;
    info->point = r->patches.len == 1 && noc_patch_is_point(&r->patches.data[0]);
    for (size_t i = 0; i < r->patches.len; i++) {
        const noc_patch *p = &r->patches.data[i];
        double at[3];
        middle(p, at);
        info->weight += p->weight;
        for (int k = 0; k < 3; k++)
            info->centre[k] += p->weight * at[k];
    }
    for (int k = 0; k < 3 && info->weight > 0; k++)
        info->centre[k] /= info->weight;
}

bool noc_region_get_patch(const noc_region *r, size_t index, noc_patch *patch) {
    if (!r || !patch || index >= r->patches.len)
        return false;
    *patch = r->patches.data[index];
    return true;
}

static void corner_of(const noc_patch *p, int corner, double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = p->p[k] + (corner == 1 ? (double)p->u[k] : corner == 2 ? (double)p->v[k] : 0);
}

size_t noc_region_outline(const noc_region *r, double (*corners)[3], size_t most) {
    size_t count = 0;
    double low = INFINITY, at[3];
    if (!r || !corners)
        return 0;
    for (size_t i = 0; i < most; i++) {
        double turn = 0.01 + 2 * M_PI * (double)i / (double)most, best = -INFINITY, out[3] = { 0 };
        double x = cos(turn), y = sin(turn);
        for (size_t k = 0; k < 3 * r->patches.len; k++) {
            corner_of(&r->patches.data[k / 3], (int)(k % 3), at);
            double far = at[0] * x + at[1] * y;
            low = fmin(low, at[2]);
            if (far > best) {
                best = far;
                memcpy(out, at, sizeof(out));
            }
        }
        const double *last = count ? corners[count - 1] : NULL;
        if (best > -INFINITY && !(last && last[0] == out[0] && last[1] == out[1]))
            memcpy(corners[count++], out, sizeof(out));
    }
    if (count > 1 && corners[0][0] == corners[count - 1][0] && corners[0][1] == corners[count - 1][1])
        count--;
    for (size_t i = 0; i < count; i++)
        corners[i][2] = low;
    return count;
}

/* How wide a pixel is where its ray meets a surface, along it. */
static double pixel_width(const noc_ray *ray, const noc_ray *next, const noc_hit *hit) {
    double apart = 0, toward = 0, d2 = 0;
    for (int k = 0; k < 3; k++) {
        double step = next->direction[k] - ray->direction[k];
        apart += step * step;
        toward += hit->normal[k] * ray->direction[k];
        d2 += ray->direction[k] * ray->direction[k];
    }
    return hit->distance * sqrt(apart) / fmax(fabs(toward), 0.01 * sqrt(d2));
}

noc_patch noc_hit_patch(const noc_hit *hit, double weight, const noc_ray *ray, const noc_ray *next) {
    noc_patch p = { .weight = (float)weight, .material = NOC_NO_MATERIAL };
    if (!hit)
        return p;
    for (int k = 0; k < 3; k++) {
        p.p[k] = (float)hit->place[k];
        p.n[k] = (float)hit->normal[k];
    }
    if (hit->material >= 0)
        p.material = (uint32_t)hit->material;
    p.textured = hit->texels > 0;
    for (int k = 0; k < 2 && p.textured; k++)
        p.image[k] = (float)hit->image[k];
    if (p.textured && ray && next)
        p.level = (float)log2(fmax(1, hit->texels * pixel_width(ray, next, hit)));
    return p;
}

noc_class noc_patch_class(const noc_patch *p, const noc_scene *s) {
    return p->material < s->materials.len ? s->materials.data[p->material].cls : NOC_CLASS_OTHER;
}

typedef struct sort_key {
    uint64_t key;
    uint32_t patch;
} sort_key;

static int by_key(const void *a, const void *b) {
    const sort_key *x = a, *y = b;
    if (x->key != y->key)
        return x->key < y->key ? -1 : 1;
    return x->patch < y->patch ? -1 : x->patch > y->patch;
}

/* The class, then 19 bits a coordinate, one after the other from the highest on. */
static uint64_t place_key(noc_class cls, const double at[3], const double lo[3], double size) {
    uint64_t key = (uint64_t)cls, cell[3];
    for (int k = 0; k < 3; k++)
        cell[k] = (uint64_t)NOC_CLAMP((at[k] - lo[k]) / size * 0x1p19, 0, 0x7ffff);
    for (int bit = 18; bit >= 0; bit--)
        for (int k = 0; k < 3; k++)
            key = key << 1 | (cell[k] >> bit & 1);
    return key;
}

noc_region *noc_region_sorted(const noc_region *from, const noc_scene *scene) {
    noc_region *r = noc_region_create(NULL);
    size_t n = from->patches.len;
    sort_key *keys = noc_alloc(NOC_MAX(n, 1) * sizeof(*keys));
    if (!r || !keys || !array_reserve(&r->patches, NOC_MAX(n, 1))) {
        noc_region_destroy(r);
        free(keys);
        return NULL;
    }
    double lo[3] = { INFINITY, INFINITY, INFINITY }, hi[3] = { -INFINITY, -INFINITY, -INFINITY }, size = 1e-3;
    for (size_t i = 0; i < n; i++) {
        double at[3];
        middle(&from->patches.data[i], at);
        for (int k = 0; k < 3; k++) {
            lo[k] = fmin(lo[k], at[k]);
            hi[k] = fmax(hi[k], at[k]);
        }
    }
    for (int k = 0; k < 3 && n; k++)
        size = fmax(size, hi[k] - lo[k]);
    for (size_t i = 0; i < n; i++) {
        double at[3];
        middle(&from->patches.data[i], at);
        keys[i] = (sort_key){ place_key(noc_patch_class(&from->patches.data[i], scene), at, lo, size), (uint32_t)i };
    }
    qsort(keys, n, sizeof(*keys), by_key);
    for (size_t i = 0; i < n; i++)
        r->patches.data[r->patches.len++] = from->patches.data[keys[i].patch];
    free(keys);
    return r;
}
