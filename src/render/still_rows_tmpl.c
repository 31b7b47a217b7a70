/* Kernels of a smoothed still, a row each. Light without textures is fitted over the pixels around, by weighted least
 * squares on what the lists of lights expect there (Moon et al. 2014, "Adaptive Rendering Based on Weighted Local
 * Regression", with one feature): expected light has the shape that lamps give it and no noise, and where it does not
 * help, the fit is a mean. Weights are of three kinds:
 *
 * - surfaces are told apart by planes: 1 / depth is linear in the picture along a plane (smooth_rows_tmpl.c), by
 *   normals and by materials;
 * - light is told apart by pilots, means over the least windows whose standard error is small, so that a pixel's own
 *   noise does not choose its neighbours;
 * - and a bell over the distance.
 *
 * Of narrow gloss diffuse light alone is fitted: what is mirrored stays as it was. A finished picture changes by
 * rays that it did not get: where many rays say otherwise than the fit, they are right. */
#include "render/rows.h"
#include "render/still.h"

#include <math.h>

#define NARROW_FEW 12u  /* of NOC_ROW_MATTE: gloss under it mirrors what cannot be told from neighbours, */
#define NARROW_MANY 24u /* and where there are many rays: it has less noise than blur */
#define FIT 5           /* pixels: reach of the fit on each side, */
#define BELL 2.5f       /* and the standard deviation of its bell */
#define PILOT 3         /* pixels: reach of pilots at most */
#define SURE 0.2f       /* relative standard error of a pilot that is good enough */
#define ALIKE 8.f       /* sum of two pilots' variances, times this: squared distance at which weights are 0 */
#define TRUST 4.f       /* times a pilot's own variance: more is not taken from its neighbour's */
#define MANY_RAYS 8     /* from so many on rays can tell that a fit is wrong: */
#define DOUBT 6.f       /* (standard errors)^2 between them from which on it gives way, */
#define DENIED 14.f     /* and at which it is dropped */
#define CHUNK 64        /* pixels that are fitted together */

static inline size_t row_of(const still_step *s, int y) { return (size_t)y * (size_t)s->width; }
static inline float reflectance(const still_step *s, size_t i) {
    return luma(s->reflects[0][i], s->reflects[1][i], s->reflects[2][i]);
}

/* ---- light ---- */

/* What a surface gets, without its texture, and of narrow gloss without what is mirrored. */
static void light_of(const still_step *s, size_t i, float light[3]) {
    for (int k = 0; k < 3; k++) {
        float of = s->rgb[3 * i + (size_t)k] / s->reflects[k][i];
        light[k] = fabsf(of) < MOST_LIGHT ? of : 0; /* false for NaN */
    }
    float y = luma(light[0], light[1], light[2]);
    uint32_t narrow = s->rays < MANY_RAYS ? NARROW_FEW : NARROW_MANY;
    if (s->what[i] >> NOC_ROW_ALPHA < narrow && s->illuminance[i] >= 0 && y > 0)
        for (int k = 0; k < 3; k++)
            light[k] *= s->illuminance[i] / ((float)M_PI * y);
}

static void split(const still_step *s, int y) {
    for (int x = 0; x < s->width; x++) {
        size_t i = row_of(s, y) + (size_t)x;
        float light[3] = { 0 }, of = reflectance(s, i), variance = s->frame_variance[i];
        row_plane plane = plane_of(&s->camera, s->normal, s->inverse[i], x, y, i);
        s->inverse[i] = plane.inverse;
        s->slope_x[i] = plane.slope_x;
        s->slope_y[i] = plane.slope_y;
        if (kind_of(s->what[i]) == NOC_ROW_SURFACE)
            light_of(s, i, light);
        s->y[i] = luma(light[0], light[1], light[2]);
        s->r[i] = light[0];
        s->b[i] = light[2];
        s->expected[i] = s->expected[i] > 0 ? s->expected[i] / of : 0;
        s->frame_variance[i] = variance >= 0 ? variance / ((float)s->frames * of * of) : -1;
    }
}

/* ---- windows ---- */

/* Pixels of a row that are worked on together. */
typedef struct chunk {
    int from, count;    /* pixels of the row */
    size_t first;       /* the first one's place */
    float plane[CHUNK]; /* 1 / tolerated distance in 1 / depth */
    float weight[CHUNK];
    int low, high; /* of those whose neighbour is in the picture */
} chunk;

static chunk start_chunk(const still_step *s, int y, int from) {
    chunk c = { .from = from, .count = least_int(CHUNK, s->width - from), .first = row_of(s, y) + (size_t)from };
    for (int x = 0; x < c.count; x++) {
        float inverse = s->inverse[c.first + (size_t)x];
        c.plane[x] = inverse > 0 ? 1 / (PLANE_TOLERANCE * inverse) : MOST_LIGHT;
    }
    return c;
}

/* Weights of the pixels that lie (dx, dy) away: 0 of other surfaces. Returns the place of the first one's neighbour. */
static ptrdiff_t weigh(const still_step *s, chunk *c, int dx, int dy) {
    size_t here = c->first;
    ptrdiff_t there = (ptrdiff_t)here + (ptrdiff_t)dy * s->width + dx;
    const float *i = s->inverse + here, *sx = s->slope_x + here, *sy = s->slope_y + here, *qi = s->inverse + there;
    const float *nx = s->normal[0] + here, *ny = s->normal[1] + here, *nz = s->normal[2] + here;
    const float *qx = s->normal[0] + there, *qy = s->normal[1] + there, *qz = s->normal[2] + there;
    const uint32_t *what = s->what + here, *other = s->what + there;
    float ox = (float)dx, oy = (float)dy;
    c->low = most_int(c->from, -dx) - c->from;
    c->high = least_int(c->from + c->count, s->width - dx) - c->from;
    for (int x = c->low; x < c->high; x++) {
        float off = fabsf(qi[x] - (i[x] + sx[x] * ox + sy[x] * oy));
        float cosine = nx[x] * qx[x] + ny[x] * qy[x] + nz[x] * qz[x];
        float plane = max_of(1 - off * c->plane[x], 0);
        float turn = max_of(1 - NORMAL_SHARPNESS * (1 - cosine), 0);
        float weight = plane * turn;
        c->weight[x] = what[x] == other[x] ? weight : 0;
    }
    return there;
}

static inline bool in_picture(const still_step *s, int y) { return y >= 0 && y < s->height; }

/* ---- variance ---- */

/* Of the mean, from frames: averaged over 3 x 3 pixels, for it is itself noisy. */
static void vary_by_frames(const still_step *s, int y, chunk *c) {
    float sum[CHUNK] = { 0 }, total[CHUNK] = { 0 };
    for (int dy = -1; dy <= 1; dy++)
        for (int dx = -1; dx <= 1 && in_picture(s, y + dy); dx++) {
            const float *v = s->frame_variance + weigh(s, c, dx, dy);
            for (int x = c->low; x < c->high; x++) {
                float weight = v[x] >= 0 ? c->weight[x] : 0;
                sum[x] += weight * max_of(v[x], 0);
                total[x] += weight;
            }
        }
    for (int x = 0; x < c->count; x++)
        s->variance[c->first + (size_t)x] = total[x] > 0 ? sum[x] / total[x] : 0;
}

/* Of one frame, from the pixels around. */
static void vary_by_window(const still_step *s, int y, chunk *c) {
    float sum[CHUNK] = { 0 }, squares[CHUNK] = { 0 }, total[CHUNK] = { 0 };
    for (int dy = -PILOT; dy <= PILOT; dy++)
        for (int dx = -PILOT; dx <= PILOT && in_picture(s, y + dy); dx++) {
            const float *v = s->y + weigh(s, c, dx, dy);
            for (int x = c->low; x < c->high; x++) {
                sum[x] += c->weight[x] * v[x];
                squares[x] += c->weight[x] * v[x] * v[x];
                total[x] += c->weight[x];
            }
        }
    for (int x = 0; x < c->count; x++) {
        float mean = sum[x] / total[x];
        s->variance[c->first + (size_t)x] = total[x] > 0 ? max_of(squares[x] / total[x] - mean * mean, 0) : 0;
    }
}

static void vary(const still_step *s, int y) {
    for (int from = 0; from < s->width; from += CHUNK) {
        chunk c = start_chunk(s, y, from);
        (s->frames > 1 ? vary_by_frames : vary_by_window)(s, y, &c);
    }
}

/* ---- pilots ---- */

/* Adds the pixels at a distance of `ring` to the sums. */
static void add_ring(const still_step *s, int y, chunk *c, int ring, float sums[3][CHUNK]) {
    for (int dy = -ring; dy <= ring; dy++) {
        int step = dy == -ring || dy == ring ? 1 : 2 * ring;
        for (int dx = -ring; dx <= ring && in_picture(s, y + dy); dx += most_int(step, 1)) {
            ptrdiff_t there = weigh(s, c, dx, dy);
            const float *v = s->y + there, *variance = s->variance + there;
            for (int x = c->low; x < c->high; x++) {
                float weight = c->weight[x];
                sums[0][x] += weight * v[x];
                sums[1][x] += weight * weight * variance[x];
                sums[2][x] += weight;
            }
        }
    }
}

/* Radius of pilots at most: the more rays there are, the less a pilot may blur. */
static int most_ring(const still_step *s) { return s->rays < 3 ? PILOT : s->rays < MANY_RAYS ? 2 : 1; }

static void guess(const still_step *s, int y) {
    for (int from = 0; from < s->width; from += CHUNK) {
        chunk c = start_chunk(s, y, from);
        float sums[3][CHUNK] = { { 0 } };
        bool done[CHUNK] = { false };
        for (int ring = 0; ring <= most_ring(s); ring++) {
            add_ring(s, y, &c, ring, sums);
            for (int x = 0; x < c.count && (ring || s->frames > 1); x++) {
                size_t i = c.first + (size_t)x;
                if (done[x])
                    continue;
                bool some = sums[2][x] > 0;
                s->pilot[i] = some ? sums[0][x] / sums[2][x] : s->y[i];
                s->deviation[i] = some ? sums[1][x] / (sums[2][x] * sums[2][x]) : s->variance[i];
                done[x] = s->deviation[i] < SURE * SURE * s->pilot[i] * s->pilot[i];
            }
        }
    }
}

/* ---- the fit ---- */

/* Sums of weights: alone, times the difference in expected light and its square; light's, plain and times the
 * difference; and of squared weights the variance. */
enum { ONE, SLOPE, SLOPES, LIGHT, LIGHT_SLOPE = LIGHT + 3, NOISE = LIGHT_SLOPE + 3, SUMS };

static void add_tap(const still_step *s, chunk *c, int dx, int dy, float sums[SUMS][CHUNK]) {
    float bell = expf(-(float)(dx * dx + dy * dy) / (2 * BELL * BELL));
    ptrdiff_t there = weigh(s, c, dx, dy);
    const float *pilot = s->pilot + c->first, *deviation = s->deviation + c->first, *expected = s->expected + c->first;
    const float *other = s->pilot + there, *others = s->deviation + there, *expects = s->expected + there;
    const float *qy = s->y + there, *qr = s->r + there, *qb = s->b + there, *variance = s->variance + there;
    for (int x = c->low; x < c->high; x++) {
        float off = pilot[x] - other[x];
        float noise = ALIKE * (deviation[x] + least_of(others[x], TRUST * deviation[x])) + 1e-30f;
        float alike = max_of(1 - off * off / noise, 0), weight = c->weight[x] * bell * alike * alike;
        float slope = expects[x] - expected[x], sloped = weight * slope;
        sums[ONE][x] += weight;
        sums[SLOPE][x] += sloped;
        sums[SLOPES][x] += sloped * slope;
        sums[LIGHT][x] += weight * qy[x];
        sums[LIGHT + 1][x] += weight * qr[x];
        sums[LIGHT + 2][x] += weight * qb[x];
        sums[LIGHT_SLOPE][x] += sloped * qy[x];
        sums[LIGHT_SLOPE + 1][x] += sloped * qr[x];
        sums[LIGHT_SLOPE + 2][x] += sloped * qb[x];
        sums[NOISE][x] += weight * weight * variance[x];
    }
}

/* Luminance, red and blue at the pixel itself: the constant of the two equations, or the mean where they tell nothing
 * of a slope. */
static void solve(float sums[SUMS][CHUNK], int x, float out[3]) {
    float one = sums[ONE][x], slope = sums[SLOPE][x], slopes = sums[SLOPES][x];
    float determinant = one * slopes - slope * slope;
    bool sloped = determinant > 1e-3f * one * slopes && slopes > 0;
    for (int k = 0; k < 3; k++) {
        float of = sloped ? (slopes * sums[LIGHT + k][x] - slope * sums[LIGHT_SLOPE + k][x]) / determinant
                          : sums[LIGHT + k][x] / one;
        out[k] = max_of(of, 0);
    }
}

/* How far the pixel's own rays are believed before the fit: a ray finds the light of the list or nothing. Of one frame
 * that is twice what was expected: of no visibility anything was known. */
static float denied(const still_step *s, size_t i, float fitted) {
    float expected = s->expected[i] > 0 ? s->expected[i] * (s->frames > 1 ? 1 : 2) : fitted;
    float arrives = expected > 0 ? least_of(fitted / expected, 1) : 0, off = s->y[i] - fitted;
    float noise = expected * expected * max_of(arrives * (1 - arrives), 0.05f) / (float)s->rays;
    noise = s->frames > 1 ? max_of(noise, s->variance[i]) : noise;
    float far = off * off / (noise + 1e-4f * fitted * fitted + 1e-30f);
    return s->rays < MANY_RAYS ? 0 : least_of(max_of((far - DOUBT) / (DENIED - DOUBT), 0), 1);
}

/* Adds to the mean picture what the fit has more or less than the pixel's own light. */
static void change(const still_step *s, size_t i, const float fitted[3], float own, float noise) {
    float was[3] = { s->y[i], s->r[i], s->b[i] }, by[3];
    for (int k = 0; k < 3; k++)
        by[k] = (fitted[k] - was[k]) * (1 - own);
    const float rgb[3] = { by[1], green(by[0], by[1], by[2]), by[2] };
    float *to = s->rgb + 3 * i, of = reflectance(s, i), left = own * s->variance[i] + (1 - own) * noise;
    for (int k = 0; k < 3; k++)
        to[k] = max_of(to[k] + s->reflects[k][i] * rgb[k], 0);
    float y = luma(to[0], to[1], to[2]);
    s->told[i] = least_of(of * of * left / (y * y + 0.01f), 1);
}

static void fit(const still_step *s, int y) {
    for (int from = 0; from < s->width; from += CHUNK) {
        chunk c = start_chunk(s, y, from);
        float sums[SUMS][CHUNK] = { { 0 } };
        for (int dy = -FIT; dy <= FIT; dy++)
            for (int dx = -FIT; dx <= FIT && in_picture(s, y + dy); dx++)
                add_tap(s, &c, dx, dy, sums);
        for (int x = 0; x < c.count; x++) {
            size_t i = c.first + (size_t)x;
            float fitted[3], one = sums[ONE][x];
            s->told[i] = 0;
            if (kind_of(s->what[i]) != NOC_ROW_SURFACE || !(one > 0))
                continue;
            solve(sums, x, fitted);
            change(s, i, fitted, denied(s, i, fitted[0]), sums[NOISE][x] / (one * one));
        }
    }
}

const still_rows STILL_ROWS = { split, vary, guess, fit };
