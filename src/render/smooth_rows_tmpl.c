/* Kernels of a smoother, a row each. They follow Schied et al. 2017, "Spatiotemporal Variance-Guided Filtering": light
 * without textures is accumulated along motion vectors, its variance is estimated over frames, or over the pixels
 * around where there are few, and a filter of passes with holes (a-trous: Dammertz et al. 2010) is guided by it. Four
 * things are other than there.
 *
 * - Surfaces are told apart by planes: 1 / depth is linear in the picture along a plane (its slope follows from the
 *   normal), so ground that is seen at a grazing angle is one surface, and a wall behind another is not.
 * - Surfaces are told apart by material, too, and what is glossy is remembered while the eye turns little about it, by
 * the width of its gloss: light over albedo is a number of the place alone where nothing is mirrored.
 * - A mean over the last few frames is kept beside the long one. Where the two differ over a window by more than their
 *   noise, light has changed, and both begin anew. So a lamp that is switched, or a car's light that passes, leaves a
 *   ghost of a few frames, and what rests keeps its long mean.
 * - Weights are Tukey's biweight of the distance in standard errors, which ends: a converged picture is not blurred. */
#include "render/rows.h"
#include "render/smooth.h"

#include <math.h>

#define ALIKE 0.9f          /* cosine between the normals of a surface now and then */
#define REACH 16.f          /* (standard errors)^2 of luminance at which weights are 0 */
#define RESTING 8.f         /* still frames after which REACH is half: the mean over frames takes the filter's place */
#define CHANGE_SURE 9.f     /* (standard errors)^2 of a window's light from which on it has changed, */
#define CHANGE_MAYBE 3.f    /* and under which it has not: neighbours share noise, so 3 is little */
#define CHANGE_SEEN 0.1f    /* share of the light that is a standard error at least: smaller changes may be late */
#define CHANGE_MOST 3.f     /* standard errors that a pixel counts for at most */
#define STILL_FRAMES 1024.f /* remembered while nothing moves */
#define GLOSS_LIGHT 0.02f   /* of the width of gloss: so far the eye turns while light is remembered, */
#define GLOSS_SHOWN 0.3f    /* and the finished picture */
#define SHOWN_STILL 128.f   /* frames of the finished picture that are averaged while nothing moves, */
#define SHOWN_MOVING 5.f    /* and else, and for the first */
#define SHOWN_SKY 3.f       /* frames of a pixel of the sky in motion: what else is in them is brighter */
#define SHOWN_EMITTERS 4.f  /* frames of what emitters add, in motion */
#define SHOWN_SETTLES 12    /* still frames, until light has settled */
#define NOT_ALIKE 1e30f     /* for 1 / variance */
#define CHUNK 128           /* pixels that are filtered together */

static inline float steps(float from, float to, float x) {
    float t = least_of(max_of((x - from) / (to - from), 0), 1);
    return t * t * (3 - 2 * t);
}

/* Inverse depths, of emitters under 0, and slopes of surfaces. */
static void shape(const smooth_step *s, int y) {
    const float *const *normal = (const float *const *)s->rows.normal;
    for (int x = 0; x < s->now.width; x++) {
        size_t i = (size_t)y * (size_t)s->now.width + (size_t)x;
        bool some = kind_of(s->rows.what[i]) == NOC_ROW_SURFACE;
        row_plane plane = plane_of(&s->now.camera, normal, s->rows.depth[i], x, y, i);
        s->now.inverse[i] = some ? plane.inverse : -plane.inverse;
        s->now.slope_x[i] = some ? plane.slope_x : 0;
        s->now.slope_y[i] = some ? plane.slope_y : 0;
    }
}

/* A place in the frame before: the first of the four pixels around it, and the shares of the second ones. */
typedef struct place {
    int x, y;
    float fx, fy;
    float inverse; /* depth expected there, 1/m */
} place;

static bool place_before(const smooth_step *s, int x, int y, const float motion[3], place *p) {
    const smooth_frame *then = s->then;
    if (!then || !(motion[2] > 0))
        return false;
    float sx = (float)then->width / (float)s->now.width, sy = (float)then->height / (float)s->now.height;
    float px = ((float)x + 0.5f + motion[0]) * sx - 0.5f, py = ((float)y + 0.5f + motion[1]) * sy - 0.5f;
    if (!(px > -1 && py > -1 && px < (float)then->width && py < (float)then->height))
        return false;
    *p = (place){ .x = (int)(px + 1) - 1, .y = (int)(py + 1) - 1, .inverse = 1 / motion[2] };
    p->fx = px - (float)p->x;
    p->fy = py - (float)p->y;
    return true;
}

static inline float share_of(const place *p, int tap) {
    return (tap & 1 ? p->fx : 1 - p->fx) * (tap & 2 ? p->fy : 1 - p->fy);
}

static bool tap_of(const smooth_frame *then, const place *p, int tap, size_t *at) {
    int x = p->x + (tap & 1), y = p->y + (tap >> 1);
    *at = (size_t)y * (size_t)then->width + (size_t)x;
    return x >= 0 && y >= 0 && x < then->width && y < then->height && share_of(p, tap) > 0;
}

/* Was the surface of pixel i seen at `at`? dx, dy: from what `at` saw to where the surface was, in pixels of then. */
static bool same_surface(const smooth_step *s, size_t i, size_t at, const place *p, float dx, float dy) {
    const smooth_frame *then = s->then;
    if (then->what[at] != s->now.what[i])
        return false;
    float expected = then->inverse[at] + then->slope_x[at] * dx + then->slope_y[at] * dy, cosine = 0;
    for (int k = 0; k < 3; k++)
        cosine += then->normal[k][at] * s->now.normal[k][i];
    return fabsf(expected - p->inverse) < PLANE_TOLERANCE * p->inverse && cosine > ALIKE;
}

/* Light that is remembered of a surface; false: none. */
static bool remembered(const smooth_step *s, int x, int y, size_t i, float out[LIGHT_HELD]) {
    const smooth_frame *then = s->then;
    float motion[3] = { s->rows.motion[0][i], s->rows.motion[1][i], s->rows.motion[2][i] }, total = 0;
    place p;
    if (!place_before(s, x, y, motion, &p))
        return false;
    float sx = (float)then->width / (float)s->now.width, sy = (float)then->height / (float)s->now.height;
    float seen_x = ((float)x + s->now.camera.jitter[0] + motion[0]) * sx - then->camera.jitter[0];
    float seen_y = ((float)y + s->now.camera.jitter[1] + motion[1]) * sy - then->camera.jitter[1];
    for (int k = 0; k < LIGHT_HELD; k++)
        out[k] = 0;
    for (int tap = 0; tap < 4; tap++) {
        size_t at;
        if (!tap_of(then, &p, tap, &at) ||
            !same_surface(s, i, at, &p, seen_x - (float)(p.x + (tap & 1)), seen_y - (float)(p.y + (tap >> 1))))
            continue;
        float share = share_of(&p, tap);
        total += share;
        for (int k = 0; k < LIGHT_HELD; k++)
            out[k] += share * then->light[at][k];
    }
    if (!(total > 0.01f))
        return false;
    for (int k = 0; k < LIGHT_HELD; k++)
        out[k] /= total;
    return true;
}

/* What a surface gets in this frame. */
static void light_now(const smooth_step *s, size_t i, float now[3]) {
    for (int k = 0; k < 3; k++) {
        float of = s->rows.rgb[k][i] / s->rows.reflects[k][i];
        now[k] = fabsf(of) < MOST_LIGHT ? of : 0; /* false for NaN */
    }
}

static void add_frame(float most, const float now[3], float light[LIGHT_HELD]) {
    float frames = least_of(light[LIGHT_FRAMES], most - 1) + 1, share = 1 / frames;
    float y = luma(now[0], now[1], now[2]);
    for (int k = 0; k < 3; k++)
        light[k] += (now[k] - light[k]) * share;
    light[LIGHT_RECENT] += (y - light[LIGHT_RECENT]) / least_of(frames, RECENT);
    light[LIGHT_SQUARES] += (y * y - light[LIGHT_SQUARES]) * share;
    light[LIGHT_FRAMES] = frames;
}

/* Of the luminance of one frame. */
static inline float variance_of(const float light[LIGHT_HELD]) {
    float mean = luma(light[0], light[1], light[2]), n = light[LIGHT_FRAMES];
    return n > 1 ? max_of(light[LIGHT_SQUARES] - mean * mean, 0) * n / (n - 1) : 0;
}

/* What a pixel adds to windows. */
static void add_sums(const float light[LIGHT_HELD], const float now[3], float sums[SUM_SQUARES]) {
    float frames = light[LIGHT_FRAMES], y = luma(now[0], now[1], now[2]), mean = luma(light[0], light[1], light[2]);
    bool known = frames > RECENT;
    float seen = CHANGE_SEEN * mean, noise = variance_of(light) * (1 / (float)RECENT - 1 / frames) + seen * seen;
    float off = (light[LIGHT_RECENT] - mean) / sqrtf(noise + 1e-30f);
    sums[SUM_CHANGE] = known ? max_of(least_of(off, CHANGE_MOST), -CHANGE_MOST) : 0;
    sums[SUM_KNOWN] = known;
    sums[SUM_PIXELS] = 1;
    sums[SUM_FRAME] = y;
}

/* In which a camera sees a place of a picture of this size. */
static void direction(const frame_camera *c, float x, float y, float out[3]) {
    float sx = 2 * x / c->width - 1, sy = 1 - 2 * y / c->height, squares = 0;
    for (int k = 0; k < 3; k++) {
        out[k] = c->forward[k] + sx * c->right[k] + sy * c->up[k];
        squares += out[k] * out[k];
    }
    float shorter = 1 / sqrtf(squares);
    for (int k = 0; k < 3; k++)
        out[k] *= shorter;
}

/* Frames in which the eye turns about a surface by so much of the width of its gloss: what is mirrored moves with the
 * eye. A camera that only turns sees the same. */
static float glossy_frames(const smooth_step *s, int x, int y, float share) {
    size_t i = (size_t)y * (size_t)s->now.width + (size_t)x;
    uint32_t alpha = s->now.what[i] >> NOC_ROW_ALPHA;
    if (s->still || alpha == NOC_ROW_MATTE)
        return STILL_FRAMES;
    if (!s->then || !(s->rows.motion[2][i] > 0))
        return 1;
    float now[3], then[3], squares = 0;
    float px = (float)x + s->now.camera.jitter[0], py = (float)y + s->now.camera.jitter[1];
    float sx = s->then->camera.width / s->now.camera.width, sy = s->then->camera.height / s->now.camera.height;
    direction(&s->now.camera, px, py, now);
    direction(&s->then->camera, (px + s->rows.motion[0][i]) * sx, (py + s->rows.motion[1][i]) * sy, then);
    for (int k = 0; k < 3; k++)
        squares += (now[k] - then[k]) * (now[k] - then[k]);
    float wide = ((float)alpha + 0.5f) / (NOC_ROW_MATTE - 1);
    return max_of(share * wide / (sqrtf(squares) + 1e-9f), 1);
}

static void gather(const smooth_step *s, int y) {
    for (int x = 0; x < s->now.width; x++) {
        size_t i = (size_t)y * (size_t)s->now.width + (size_t)x;
        float *light = s->now.light[i], now[3], sums[SUM_SQUARES] = { 0 };
        bool some = kind_of(s->now.what[i]) == NOC_ROW_SURFACE;
        if (!some || !remembered(s, x, y, i, light))
            for (int k = 0; k < LIGHT_HELD; k++)
                light[k] = 0;
        if (some) {
            light_now(s, i, now);
            float most = s->still ? STILL_FRAMES : (float)s->params->history;
            add_frame(least_of(most, glossy_frames(s, x, y, GLOSS_LIGHT)), now, light);
            add_sums(light, now, sums);
        }
        for (int k = 0; k < SUM_SQUARES; k++)
            s->sums[k][i] = sums[k];
    }
}

/* Sums over the windows of pixels from..from + count - 1 of a row. */
static void window_sums(const smooth_step *s, int y, int from, int count, float out[SUMS][CHUNK]) {
    int width = s->now.width, low = most_int(from - AROUND, 0), high = least_int(from + count + AROUND, width);
    int top = most_int(y - AROUND, 0), bottom = least_int(y + AROUND, s->now.height - 1);
    for (int k = 0; k < SUMS; k++) {
        float column[CHUNK + 2 * AROUND] = { 0 };
        float *to = column + AROUND - from;
        for (int v = top; v <= bottom; v++) {
            const float *in = s->sums[least_int(k, SUM_FRAME)] + (size_t)v * (size_t)width;
            if (k == SUM_SQUARES)
                for (int x = low; x < high; x++)
                    to[x] += in[x] * in[x];
            else
                for (int x = low; x < high; x++)
                    to[x] += in[x];
        }
        for (int x = 0; x < count; x++) {
            float sum = 0;
            for (int u = 0; u <= 2 * AROUND; u++)
                sum += column[x + u];
            out[k][x] = sum;
        }
    }
}

/* How far light has changed within a pixel's window: 0, it is noise, to 1. Each pixel counts by its own noise, and none
 * for much: a few bright ones would hide what the others say. */
static float changed(float change, float known) {
    return steps(CHANGE_MAYBE, CHANGE_SURE, change * change / (known + 1e-30f));
}

/* Both means give way to this frame alone. */
static void forget(const smooth_step *s, size_t i, float light[LIGHT_HELD], float share) {
    float now[3];
    light_now(s, i, now);
    float y = luma(now[0], now[1], now[2]);
    for (int k = 0; k < 3; k++)
        light[k] += (now[k] - light[k]) * share;
    light[LIGHT_RECENT] += (y - light[LIGHT_RECENT]) * share;
    light[LIGHT_SQUARES] += (y * y - light[LIGHT_SQUARES]) * share;
    light[LIGHT_FRAMES] += (1 - light[LIGHT_FRAMES]) * share;
}

static void settle_pixel(const smooth_step *s, size_t i, const float sums[SUMS]) {
    float *light = s->now.light[i], variance = 0;
    if (kind_of(s->now.what[i]) == NOC_ROW_SURFACE) {
        if (light[LIGHT_FRAMES] > RECENT)
            forget(s, i, light, changed(sums[SUM_CHANGE], sums[SUM_KNOWN]));
        float mean = sums[SUM_FRAME] / sums[SUM_PIXELS];
        float around = max_of(sums[SUM_SQUARES] / sums[SUM_PIXELS] - mean * mean, 0);
        float trust = steps(1, FEW, light[LIGHT_FRAMES]), own = variance_of(light);
        variance = (around + (own - around) * trust) / light[LIGHT_FRAMES];
    }
    smooth_planes out = s->planes[0];
    out.y[i] = luma(light[0], light[1], light[2]);
    out.r[i] = light[0];
    out.b[i] = light[2];
    out.variance[i] = variance;
}

static void settle(const smooth_step *s, int y) {
    float sums[SUMS][CHUNK];
    for (int from = 0; from < s->now.width; from += CHUNK) {
        int count = least_int(CHUNK, s->now.width - from);
        window_sums(s, y, from, count, sums);
        for (int x = 0; x < count; x++) {
            float of[SUMS];
            for (int k = 0; k < SUMS; k++)
                of[k] = sums[k][x];
            settle_pixel(s, (size_t)y * (size_t)s->now.width + (size_t)(from + x), of);
        }
    }
}

/* ---- the filter ---- */

/* Pixels of a row that are filtered together, and what is summed for them. */
typedef struct chunk {
    int from, count; /* pixels of the row */
    size_t row;      /* its first pixel */
    float y[CHUNK], r[CHUNK], b[CHUNK], variance[CHUNK], total[CHUNK];
    float noise[CHUNK]; /* 1 / (reach * variance around the pixel) */
    float plane[CHUNK]; /* 1 / tolerated distance in 1 / depth */
} chunk;

/* Pixels of the chunk whose neighbour so far to the right is in the picture. */
static inline void inside(const chunk *c, int dx, int width, int *low, int *high) {
    *low = most_int(c->from, -dx) - c->from;
    *high = least_int(c->from + c->count, width - dx) - c->from;
}

/* Gloss under this width, as what has it, is narrower in the picture than the pass: it shows the images of lamps. */
static float sharp_of(const smooth_step *s) {
    const float *right = s->now.camera.right;
    float wide = sqrtf(right[0] * right[0] + right[1] * right[1] + right[2] * right[2]);
    float pixels = s->now.camera.width / (2 * wide); /* to the radian */
    return least_of((float)(2 << s->pass) / pixels * (NOC_ROW_MATTE - 1), NOC_ROW_MATTE);
}

/* Variance is itself noisy: it is averaged over 3 x 3 pixels. */
static void start_chunk(const smooth_step *s, const smooth_planes *in, int y, chunk *c) {
    float sum[CHUNK] = { 0 }, total[CHUNK] = { 0 };
    for (int dy = -1; dy <= 1; dy++) {
        if (y + dy < 0 || y + dy >= s->now.height)
            continue;
        for (int dx = -1; dx <= 1; dx++) {
            int low, high;
            float weight = (dx ? 1.f : 2.f) * (dy ? 1.f : 2.f);
            const float *v = in->variance + ((ptrdiff_t)c->row + (ptrdiff_t)dy * s->now.width + c->from + dx);
            inside(c, dx, s->now.width, &low, &high);
            for (int x = low; x < high; x++) {
                sum[x] += weight * v[x];
                total[x] += weight;
            }
        }
    }
    size_t first = c->row + (size_t)c->from;
    const float *inverse = s->now.inverse + first, *iy = in->y + first, *ir = in->r + first, *ib = in->b + first;
    const float *variance = in->variance + first;
    float reach = REACH * RESTING / (RESTING + (float)s->rested), sharp = sharp_of(s);
    const uint32_t *what = s->now.what + first;
    for (int x = 0; x < c->count; x++) {
        float noise = 1 / (reach * sum[x] / total[x] + 1e-30f);
        c->noise[x] = (float)(what[x] >> NOC_ROW_ALPHA) < sharp ? NOT_ALIKE : noise;
        c->plane[x] = inverse[x] > 0 ? 1 / (PLANE_TOLERANCE * inverse[x]) : 1e30f;
        c->y[x] = 4 * iy[x];
        c->r[x] = 4 * ir[x];
        c->b[x] = 4 * ib[x];
        c->variance[x] = 16 * variance[x];
        c->total[x] = 4;
    }
}

/* Adds the pixels that lie (dx, dy) away. */
static void add_tap(const smooth_step *s, const smooth_planes *in, int dx, int dy, float share, chunk *c) {
    int low, high;
    size_t here = c->row + (size_t)c->from;
    ptrdiff_t there = (ptrdiff_t)here + (ptrdiff_t)dy * s->now.width + dx;
    const float *i = s->now.inverse + here, *sx = s->now.slope_x + here, *sy = s->now.slope_y + here;
    const float *nx = s->now.normal[0] + here, *ny = s->now.normal[1] + here, *nz = s->now.normal[2] + here;
    const float *y = in->y + here, *qi = s->now.inverse + there, *qx = s->now.normal[0] + there;
    const float *qy = s->now.normal[1] + there, *qz = s->now.normal[2] + there, *ty = in->y + there;
    const float *tr = in->r + there, *tb = in->b + there, *tv = in->variance + there;
    const uint32_t *what = s->now.what + here, *other = s->now.what + there;
    float ox = (float)dx, oy = (float)dy;
    inside(c, dx, s->now.width, &low, &high);
    for (int x = low; x < high; x++) {
        float off = fabsf(qi[x] - (i[x] + sx[x] * ox + sy[x] * oy)), step = ty[x] - y[x];
        float cosine = nx[x] * qx[x] + ny[x] * qy[x] + nz[x] * qz[x];
        float plane = max_of(1 - off * c->plane[x], 0);
        float turn = max_of(1 - NORMAL_SHARPNESS * (1 - cosine), 0);
        float alike = max_of(1 - step * step * c->noise[x], 0);
        float same = what[x] == other[x] ? share : 0;
        float weight = same * plane * turn * alike * alike;
        c->y[x] += weight * ty[x];
        c->r[x] += weight * tr[x];
        c->b[x] += weight * tb[x];
        c->variance[x] += weight * weight * tv[x];
        c->total[x] += weight;
    }
}

static void filter(const smooth_step *s, int y) {
    const smooth_planes *in = &s->planes[s->pass & 1], *out = &s->planes[1 - (s->pass & 1)];
    int step = 1 << s->pass;
    chunk c = { .row = (size_t)y * (size_t)s->now.width };
    for (c.from = 0; c.from < s->now.width; c.from += CHUNK) {
        c.count = least_int(CHUNK, s->now.width - c.from);
        start_chunk(s, in, y, &c);
        for (int dy = -step; dy <= step; dy += step)
            for (int dx = -step; dx <= step; dx += step)
                if ((dx || dy) && y + dy >= 0 && y + dy < s->now.height)
                    add_tap(s, in, dx, dy, (dx ? 1.f : 2.f) * (dy ? 1.f : 2.f), &c);
        size_t first = c.row + (size_t)c.from;
        for (int x = 0; x < c.count; x++) {
            float inverse = 1 / c.total[x];
            out->y[first + (size_t)x] = c.y[x] * inverse;
            out->r[first + (size_t)x] = c.r[x] * inverse;
            out->b[first + (size_t)x] = c.b[x] * inverse;
            out->variance[first + (size_t)x] = c.variance[x] * inverse * inverse;
        }
    }
}

/* ---- the picture ---- */

/* The pixel of the nearest thing of the 3 x 3 around. */
static size_t nearest_around(const smooth_step *s, int x, int y) {
    size_t at = (size_t)y * (size_t)s->now.width + (size_t)x;
    float nearest = 0;
    for (int v = most_int(y - 1, 0); v <= least_int(y + 1, s->now.height - 1); v++)
        for (int u = most_int(x - 1, 0); u <= least_int(x + 1, s->now.width - 1); u++) {
            size_t i = (size_t)v * (size_t)s->now.width + (size_t)u;
            float inverse = fabsf(s->now.inverse[i]);
            at = inverse > nearest ? i : at;
            nearest = max_of(inverse, nearest);
        }
    return at;
}

static void make(const smooth_step *s, int y) {
    const smooth_planes *in = &s->planes[s->pass & 1];
    for (int x = 0; x < s->now.width; x++) {
        size_t i = (size_t)y * (size_t)s->now.width + (size_t)x;
        float rgb[3] = { in->r[i], green(in->y[i], in->r[i], in->b[i]), in->b[i] };
        bool surface = kind_of(s->now.what[i]) == NOC_ROW_SURFACE;
        for (int k = 0; k < 3; k++) {
            float seen = s->rows.rgb[k][i], light = max_of(rgb[k], 0) * s->rows.reflects[k][i];
            seen = fabsf(seen) < MOST_LIGHT ? seen : 0;
            s->rows.rgb[k][i] = surface ? light : seen;
        }
    }
}

/* Catmull-Rom weights of the four pixels around a place. */
static inline void cubic(float f, float out[4]) {
    out[0] = f * (-0.5f + f * (1 - 0.5f * f));
    out[1] = 1 + f * f * (-2.5f + 1.5f * f);
    out[2] = f * (0.5f + f * (2 - 1.5f * f));
    out[3] = f * f * (-0.5f + 0.5f * f);
}

static void add_shown(const smooth_frame *then, size_t at, float share, float out[SHOWN_HELD]) {
    for (int k = 0; k < SHOWN_HELD; k++)
        out[k] += share * then->shown[at][k];
}

/* Of what surfaces and sky show, and of what emitters add. */
enum { KNOWN_SURFACE = 1, KNOWN_EMITTER = 2 };

/* By cubics, which keep the picture sharp. */
static void cubics_at(const smooth_frame *then, const place *p, float out[SHOWN_HELD]) {
    float wx[4], wy[4], frames = out[SHOWN_FRAMES];
    if (!(p->x >= 1 && p->y >= 1 && p->x + 2 < then->width && p->y + 2 < then->height))
        return;
    cubic(p->fx, wx);
    cubic(p->fy, wy);
    for (int k = 0; k < SHOWN_HELD; k++)
        out[k] = 0;
    for (int v = 0; v < 4; v++)
        for (int u = 0; u < 4; u++)
            add_shown(then, (size_t)(p->y + v - 1) * (size_t)then->width + (size_t)(p->x + u - 1), wx[u] * wy[v], out);
    out[SHOWN_FRAMES] = frames;
}

/* What was shown there; which of the two, and no number where neither is known. Whether it is of the same things is
 * not asked, but it is held to what they are now. */
static int shown_at(const smooth_step *s, const place *p, float out[SHOWN_HELD]) {
    const smooth_frame *then = s->then;
    float surfaces = 0, emitters = 0, missing = 0;
    for (int tap = 0; tap < 4; tap++) {
        size_t at;
        float share = share_of(p, tap);
        bool there = tap_of(then, p, tap, &at), surface = there && then->shown[at][SHOWN_FRAMES] > 0;
        emitters += there ? share : 0;
        surfaces += surface ? share : 0;
        missing += surface ? 0 : share;
        for (int k = SHOWN_EMITTER; k < SHOWN_HELD && there; k++)
            out[k] += share * then->shown[at][k];
        for (int k = 0; k < SHOWN_EMITTER && surface; k++)
            out[k] += share * then->shown[at][k];
    }
    bool known[2] = { surfaces > 0.01f, emitters > 0.01f };
    for (int k = 0; k < SHOWN_EMITTER; k++) {
        out[k] = known[0] ? out[k] / surfaces : 0;
        out[SHOWN_EMITTER + k] = known[1] ? out[SHOWN_EMITTER + k] / emitters : 0;
    }
    if (!(missing > 0) && !s->still)
        cubics_at(then, p, out);
    return (known[0] ? KNOWN_SURFACE : 0) | (known[1] ? KNOWN_EMITTER : 0);
}

/* What this frame has of a pixel, as shown. */
static inline void made_at(const smooth_step *s, size_t i, float out[SHOWN_HELD]) {
    bool emitter = kind_of(s->now.what[i]) == NOC_ROW_EMITTER;
    for (int k = 0; k < 3; k++) {
        out[k] = emitter ? 0 : s->rows.rgb[k][i];
        out[SHOWN_EMITTER + k] = emitter ? s->rows.rgb[k][i] : 0;
    }
    out[SHOWN_FRAMES] = !emitter;
    out[SHOWN_SHARE] = emitter;
}

/* What was shown, held to what this frame has around the pixel: surfaces and sky in the cross of five, so that little
 * of an edge comes to the dark beside it, emitters in all nine. So no light of theirs lies farther off than a pixel. */
static void hold(const smooth_step *s, int x, int y, float shown[SHOWN_HELD]) {
    float low[SHOWN_HELD], high[SHOWN_HELD];
    for (int k = 0; k < SHOWN_HELD; k++) {
        low[k] = MOST_LIGHT;
        high[k] = -1;
    }
    for (int v = most_int(y - 1, 0); v <= least_int(y + 1, s->now.height - 1); v++)
        for (int u = most_int(x - 1, 0); u <= least_int(x + 1, s->now.width - 1); u++) {
            float made[SHOWN_HELD];
            made_at(s, (size_t)v * (size_t)s->now.width + (size_t)u, made);
            int from = made[SHOWN_FRAMES] > 0 && (u == x || v == y) ? 0 : SHOWN_EMITTER;
            for (int k = from; k < SHOWN_HELD; k++) {
                low[k] = least_of(made[k], low[k]);
                high[k] = max_of(made[k], high[k]);
            }
        }
    for (int k = 0; k < 3 && high[0] >= 0; k++)
        shown[k] = max_of(least_of(shown[k], high[k]), low[k]);
    for (int k = SHOWN_EMITTER; k < SHOWN_HELD && !s->still; k++)
        shown[k] = max_of(least_of(shown[k], high[k]), low[k]);
}

/* What was shown of a pixel, by the motion of the nearest thing around: edges move with what is before them. */
static int shown_before(const smooth_step *s, int x, int y, float out[SHOWN_HELD]) {
    float motion[3] = { 0, 0, 1 };
    size_t at = nearest_around(s, x, y);
    place p;
    for (int k = 0; k < 3 && !s->still; k++)
        motion[k] = s->rows.motion[k][at];
    int known = s->params->antialias && place_before(s, x, y, motion, &p) ? shown_at(s, &p, out) : 0;
    if (known && s->rested < SHOWN_SETTLES)
        hold(s, x, y, out);
    return known;
}

/* Frames of the finished picture that are remembered at most. */
static float most_shown(const smooth_step *s, int x, int y) {
    if (s->rested >= SHOWN_SETTLES)
        return SHOWN_STILL;
    noc_row_kind kind = kind_of(s->now.what[(size_t)y * (size_t)s->now.width + (size_t)x]);
    if (kind == NOC_ROW_NOTHING)
        return s->still ? SHOWN_MOVING : SHOWN_SKY;
    return kind == NOC_ROW_SURFACE ? least_of(SHOWN_MOVING, glossy_frames(s, x, y, GLOSS_SHOWN)) : SHOWN_MOVING;
}

static void add_shown_frame(const smooth_step *s, float most, const float made[SHOWN_HELD], int known,
                            float out[SHOWN_HELD]) {
    if (made[SHOWN_FRAMES] > 0) {
        out[SHOWN_FRAMES] = least_of(out[SHOWN_FRAMES], most - 1) + 1;
        for (int k = 0; k < 3; k++)
            out[k] += (made[k] - out[k]) / out[SHOWN_FRAMES];
    }
    float frames = known & KNOWN_EMITTER ? SHOWN_EMITTERS + least_of((float)s->rested, SHOWN_STILL) : 1;
    for (int k = SHOWN_EMITTER; k < SHOWN_HELD; k++)
        out[k] += (made[k] - out[k]) / frames;
}

static void show(const smooth_step *s, int y) {
    for (int x = 0; x < s->now.width; x++) {
        size_t i = (size_t)y * (size_t)s->now.width + (size_t)x;
        float out[SHOWN_HELD] = { 0 }, made[SHOWN_HELD];
        made_at(s, i, made);
        int known = shown_before(s, x, y, out);
        add_shown_frame(s, most_shown(s, x, y), made, known, out);
        for (int k = 0; k < SHOWN_HELD; k++)
            s->now.shown[i][k] = out[k];
        for (int k = 0; k < 3; k++)
            s->image->rgb[3 * i + (size_t)k] = out[k] * (1 - out[SHOWN_SHARE]) + out[SHOWN_EMITTER + k];
        for (int k = 0; k < 4; k++)
            s->image->coverage[4 * i + (size_t)k] = out[SHOWN_EMITTER + k];
    }
}

const smooth_rows SMOOTH_ROWS = { shape, gather, settle, filter, make, show };
