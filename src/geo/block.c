/* Blocks: walls along an outline, with a flat roof. */
#include "geo/geo.h"

#include <math.h>

static double area_of(const double *xyz, size_t points) {
    double twice = 0;
    for (size_t i = 0; i < points; i++) {
        const double *a = xyz + 3 * i, *b = xyz + 3 * ((i + 1) % points);
        twice += (a[0] - xyz[0]) * (b[1] - xyz[1]) - (a[1] - xyz[1]) * (b[0] - xyz[0]);
    }
    return twice / 2;
}

/* At a height; turned over where it is seen from below. */
static bool add_lid(const geo_block *b, noc_class cls, double z, bool below, geo_block_add add, void *ctx) {
    NOC_ARRAY(double) xyz = { 0 };
    size_t at = 0;
    bool good = true;
    for (size_t r = 0; r < b->ring_count; at += b->ring_size[r++]) {
        bool turn = (area_of(b->xyz + 3 * at, b->ring_size[r]) > 0) == (below == (r == 0));
        for (size_t i = 0; i < b->ring_size[r] && good; i++) {
            const double *p = b->xyz + 3 * (at + (turn ? b->ring_size[r] - 1 - i : i));
            const double point[3] = { p[0], p[1], z };
            good = array_append(&xyz, point, (size_t)3);
        }
    }
    good = good && add(ctx, cls, b->ring_count, b->ring_size, xyz.data);
    array_free(&xyz);
    return good;
}

static bool add_walls(const geo_block *b, geo_block_add add, void *ctx) {
    static const size_t four = 4;
    size_t at = 0;
    for (size_t r = 0; r < b->ring_count; at += b->ring_size[r++]) {
        size_t n = b->ring_size[r];
        bool turn =
            (area_of(b->xyz + 3 * at, n) > 0) != (r == 0); /* outlines run counter-clockwise, yards the other way */
        for (size_t i = 0; i < n; i++) {
            const double *p = b->xyz + 3 * (at + i), *q = b->xyz + 3 * (at + (i + 1) % n);
            const double *a = turn ? q : p, *c = turn ? p : q;
            const double wall[12] = {
                a[0], a[1], b->low, c[0], c[1], b->low, c[0], c[1], b->high, a[0], a[1], b->high
            };
            if (hypot(p[0] - q[0], p[1] - q[1]) > b->least && !add(ctx, NOC_CLASS_WALL, 1, &four, wall))
                return false;
        }
    }
    return true;
}

bool geo_block_make(const geo_block *b, geo_block_add add, void *ctx) {
    return add_walls(b, add, ctx) && add_lid(b, NOC_CLASS_ROOF, b->high, false, add, ctx) &&
           (b->floor < 0 || add_lid(b, (noc_class)b->floor, b->low, true, add, ctx));
}
