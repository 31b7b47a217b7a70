/* The camera of a photograph: eye, rotation and field of view from places and where a picture shows them.
 *
 * Three places and a focal length have up to four cameras (Grunert 1841, as in Haralick et al. 1994, "Review and
 * analysis of solutions of the three point perspective pose estimation problem"). They are found for a row of focal
 * lengths, and the best of them, and the camera that was given, are made better by Levenberg-Marquardt over all seven
 * unknowns and all places. */
#include "base/base.h"

#include <complex.h>
#include <float.h>
#include <math.h>
#include <nocturne/scene.h>

enum { UNKNOWNS = 7, KEPT = 24, FOCAL_LENGTHS = 24, TRIPLES = 8, ROUNDS = 60, MOST_POINTS = 10000 };
#define LEAST_FOV 2.0
#define MOST_FOV 150.0
#define THIN 0.01     /* share of their extent that points may be off a line and be called one */
#define MISFIT 0.1    /* share of the picture's diagonal */
#define DECIDED 1e-13 /* least curvature of the sum of squares, of its greatest */

typedef struct pose {
    double r[3][3]; /* rows: right, down, forward */
    double eye[3];
    double focal; /* pixels */
    double rms;   /* pixels; INFINITY: something is behind it */
    double curvature;
} pose;

/* The task, in units that make it well posed: places less their middle, over their extent. */
typedef struct task {
    const noc_camera_point *points;
    size_t count;
    double middle[3], extent;
    double half[2]; /* of the picture, pixels */
    size_t triple[TRIPLES][3];
    int triples;
} task;

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void cross(const double a[3], const double b[3], double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

static bool unit(double a[3]) {
    double length = sqrt(dot(a, a));
    for (int k = 0; k < 3; k++)
        a[k] /= length > 0 ? length : 1;
    return length > 0;
}

static void place(const task *t, size_t i, double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = (t->points[i].xyz[k] - t->middle[k]) / t->extent;
}

/* ---- least squares ---- */

/* A place as the camera has it, and its pixel less where it was seen. false: behind. */
static bool residual(const task *t, const pose *p, size_t i, double seen[3], double out[2]) {
    double at[3];
    place(t, i, at);
    for (int k = 0; k < 3; k++)
        at[k] -= p->eye[k];
    for (int k = 0; k < 3; k++)
        seen[k] = dot(p->r[k], at);
    for (int k = 0; k < 2; k++)
        out[k] = p->focal * seen[k] / seen[2] + t->half[k] - t->points[i].pixel[k];
    return seen[2] > 1e-9;
}

static void judge(const task *t, pose *p) {
    double sum = 0, seen[3], e[2];
    bool before = true;
    for (size_t i = 0; i < t->count && before; i++) {
        before = residual(t, p, i, seen, e);
        sum += e[0] * e[0] + e[1] * e[1];
    }
    p->rms = before && isfinite(sum) ? sqrt(sum / (double)t->count) : INFINITY;
}

/* Normal equations. Unknowns: a small rotation, the eye, the logarithm of the focal length. */
static void normal_equations(const task *t, const pose *p, double a[UNKNOWNS][UNKNOWNS], double b[UNKNOWNS]) {
    memset(a, 0, sizeof(double[UNKNOWNS][UNKNOWNS]));
    memset(b, 0, sizeof(double[UNKNOWNS]));
    for (size_t i = 0; i < t->count; i++) {
        double s[3], e[2];
        residual(t, p, i, s, e);
        for (int k = 0; k < 2; k++) {
            double by[3] = { 0, 0, -p->focal * s[k] / (s[2] * s[2]) }, j[UNKNOWNS];
            by[k] = p->focal / s[2];
            cross(s, by, j); /* of a rotation w: by . (w x s) = w . (s x by) */
            for (int c = 0; c < 3; c++)
                j[3 + c] = -(by[0] * p->r[0][c] + by[1] * p->r[1][c] + by[2] * p->r[2][c]);
            j[6] = p->focal * s[k] / s[2];
            for (int row = 0; row < UNKNOWNS; row++) {
                b[row] -= j[row] * e[k];
                for (int c = 0; c < UNKNOWNS; c++)
                    a[row][c] += j[row] * j[c];
            }
        }
    }
}

/* a x = b by elimination, a symmetric and positive; false: it is singular. */
static bool solve(double a[UNKNOWNS][UNKNOWNS], double b[UNKNOWNS]) {
    for (int i = 0; i < UNKNOWNS; i++) {
        if (!(a[i][i] > 0))
            return false;
        for (int row = i + 1; row < UNKNOWNS; row++) {
            double f = a[row][i] / a[i][i];
            for (int c = i; c < UNKNOWNS; c++)
                a[row][c] -= f * a[i][c];
            b[row] -= f * b[i];
        }
    }
    for (int i = UNKNOWNS - 1; i >= 0; i--) {
        for (int c = i + 1; c < UNKNOWNS; c++)
            b[i] -= a[i][c] * b[c];
        b[i] /= a[i][i];
    }
    return true;
}

/* Rotates by w: Rodrigues' formula. */
static void rotate(pose *p, const double w[3]) {
    double angle = sqrt(dot(w, w)), k[3] = { w[0], w[1], w[2] };
    if (!unit(k))
        return;
    for (int c = 0; c < 3; c++) { /* columns turn */
        double v[3] = { p->r[0][c], p->r[1][c], p->r[2][c] }, x[3], along = dot(k, v) * (1 - cos(angle));
        cross(k, v, x);
        for (int row = 0; row < 3; row++)
            p->r[row][c] = v[row] * cos(angle) + x[row] * sin(angle) + k[row] * along;
    }
}

static void straighten(pose *p) {
    unit(p->r[2]);
    double along = dot(p->r[0], p->r[2]);
    for (int k = 0; k < 3; k++)
        p->r[0][k] -= along * p->r[2][k];
    unit(p->r[0]);
    cross(p->r[2], p->r[0], p->r[1]);
}

static double focal_of(const task *t, double fov) { return t->half[1] / tan(fov * M_PI / 360); }

static void improve(const task *t, pose *p) {
    double damp = 1e-3;
    judge(t, p);
    for (int round = 0; round < ROUNDS && isfinite(p->rms) && damp < 1e12; round++) {
        double a[UNKNOWNS][UNKNOWNS], b[UNKNOWNS];
        normal_equations(t, p, a, b);
        for (int i = 0; i < UNKNOWNS; i++)
            a[i][i] *= 1 + damp;
        pose next = *p;
        if (!solve(a, b) || !(fabs(b[6]) < 2) || !(dot(b, b) < 10)) {
            damp = 10 * damp + 1e-12;
            continue;
        }
        rotate(&next, b);
        straighten(&next);
        for (int k = 0; k < 3; k++)
            next.eye[k] += b[3 + k];
        next.focal = NOC_CLAMP(p->focal * exp(b[6]), focal_of(t, MOST_FOV), focal_of(t, LEAST_FOV));
        judge(t, &next);
        if (!(next.rms <= p->rms)) {
            damp *= 10;
            continue;
        }
        bool done = p->rms - next.rms < 1e-12 * p->rms + 1e-13;
        *p = next;
        damp = NOC_MAX(damp / 10, 1e-14);
        if (done)
            break;
    }
}

/* Least eigenvalue over the greatest of the equations, scaled to a diagonal of 1 (by inverse iteration). */
static double decided(const task *t, const pose *p) {
    double a[UNKNOWNS][UNKNOWNS], b[UNKNOWNS], scale[UNKNOWNS], v[UNKNOWNS], grown = 0;
    normal_equations(t, p, a, b);
    for (int i = 0; i < UNKNOWNS; i++) {
        if (!(a[i][i] > 0))
            return 0;
        scale[i] = sqrt(a[i][i]);
        v[i] = 1 + .1 * i;
    }
    for (int round = 0; round < 12; round++) {
        double m[UNKNOWNS][UNKNOWNS], length = 0;
        for (int i = 0; i < UNKNOWNS; i++)
            for (int k = 0; k < UNKNOWNS; k++)
                m[i][k] = a[i][k] / (scale[i] * scale[k]);
        if (!solve(m, v))
            return 0;
        for (int i = 0; i < UNKNOWNS; i++)
            length += v[i] * v[i];
        grown = sqrt(length);
        for (int i = 0; i < UNKNOWNS; i++)
            v[i] /= grown;
    }
    return 1 / (grown * UNKNOWNS);
}

/* ---- three points ---- */

/* Real roots of a quartic, by the iteration of Durand and Kerner. */
static int real_roots(const double c[5], double out[4]) {
    double most = 0;
    for (int i = 0; i < 5; i++)
        most = fmax(most, fabs(c[i]));
    if (!(fabs(c[4]) > 1e-12 * most))
        return 0;
    double complex z[4];
    for (int i = 0; i < 4; i++)
        z[i] = cpow(.4 + .9 * I, i);
    for (int round = 0; round < 200; round++) {
        double moved = 0;
        for (int i = 0; i < 4; i++) {
            double complex f = 1, below = 1;
            for (int k = 3; k >= 0; k--)
                f = f * z[i] + c[k] / c[4];
            for (int k = 0; k < 4; k++)
                below *= k == i ? 1 : z[i] - z[k];
            if (cabs(below) < 1e-300)
                continue;
            z[i] -= f / below;
            moved = fmax(moved, cabs(f / below));
        }
        if (moved < 1e-14)
            break;
    }
    int count = 0;
    for (int i = 0; i < 4; i++)
        if (fabs(cimag(z[i])) < 1e-4 * (1 + fabs(creal(z[i]))))
            out[count++] = creal(z[i]);
    return count;
}

/* Axes of three points: rows. */
static bool axes_of(const double a[3], const double b[3], const double c[3], double out[3][3]) {
    double side[3];
    for (int k = 0; k < 3; k++) {
        out[0][k] = b[k] - a[k];
        side[k] = c[k] - a[k];
    }
    cross(out[0], side, out[2]);
    bool good = unit(out[0]) && unit(out[2]);
    cross(out[2], out[0], out[1]);
    return good;
}

/* The camera that has world points w at distances s along the rays j. */
static bool pose_of(const double w[3][3], const double j[3][3], const double s[3], pose *out) {
    double q[3][3], from[3][3], to[3][3];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            q[i][k] = s[i] * j[i][k];
    if (!axes_of(w[0], w[1], w[2], from) || !axes_of(q[0], q[1], q[2], to))
        return false;
    for (int row = 0; row < 3; row++)
        for (int c = 0; c < 3; c++)
            out->r[row][c] = to[0][row] * from[0][c] + to[1][row] * from[1][c] + to[2][row] * from[2][c];
    for (int k = 0; k < 3; k++) /* eye = w - R^T q */
        out->eye[k] = w[0][k] - (out->r[0][k] * q[0][0] + out->r[1][k] * q[0][1] + out->r[2][k] * q[0][2]);
    return true;
}

static double apart2(const double a[3], const double b[3]) {
    double d[3] = { a[0] - b[0], a[1] - b[1], a[2] - b[2] };
    return dot(d, d);
}

/* Haralick et al. 1994, equation 9: coefficients of v = s3 / s1. */
static int three_points(const double w[3][3], const double j[3][3], double focal, pose out[4]) {
    double b2 = apart2(w[0], w[2]), a2 = apart2(w[1], w[2]) / b2, c2 = apart2(w[0], w[1]) / b2;
    double ca = dot(j[1], j[2]), cb = dot(j[0], j[2]), cg = dot(j[0], j[1]), d = a2 - c2, e = a2 + c2, roots[4];
    const double c[5] = {
        (1 + d) * (1 + d) - 4 * a2 * cg * cg, 4 * (-d * (1 + d) * cb + 2 * a2 * cg * cg * cb - (1 - e) * ca * cg),
        2 * (d * d - 1 + 2 * d * d * cb * cb + 2 * (1 - c2) * ca * ca - 4 * e * ca * cb * cg + 2 * (1 - a2) * cg * cg),
        4 * (d * (1 - d) * cb - (1 - e) * ca * cg + 2 * c2 * ca * ca * cb), (d - 1) * (d - 1) - 4 * c2 * ca * ca
    };
    int n = real_roots(c, roots), count = 0;
    for (int i = 0; i < n; i++) {
        double v = roots[i], under = 2 * (cg - v * ca), square = 1 + v * v - 2 * v * cb;
        if (!(fabs(under) > 1e-12) || !(square > 0))
            continue;
        double u = ((d - 1) * v * v - 2 * d * cb * v + 1 + d) / under, s = sqrt(b2 / square);
        out[count] = (pose){ .focal = focal };
        count += u > 0 && v > 0 && pose_of(w, j, (const double[3]){ s, u * s, v * s }, &out[count]);
    }
    return count;
}

/* ---- starts ---- */

/* The best so far, best first. */
static void keep(pose kept[KEPT], int *count, const pose *p) {
    if (!isfinite(p->rms) || (*count == KEPT && kept[KEPT - 1].rms <= p->rms))
        return;
    *count += *count < KEPT;
    int at = *count - 1;
    for (; at > 0 && p->rms < kept[at - 1].rms; at--)
        kept[at] = kept[at - 1];
    kept[at] = *p;
}

/* Triples that span much: area in the picture times area in space, the greatest ones. */
static void choose_triples(task *t) {
    double best[TRIPLES] = { 0 };
    size_t n = NOC_MIN(t->count, (size_t)24), stride = t->count / n;
    for (size_t a = 0; a < n; a++)
        for (size_t b = a + 1; b < n; b++)
            for (size_t c = b + 1; c < n; c++) {
                const noc_camera_point *p[3] = { &t->points[a * stride], &t->points[b * stride],
                                                 &t->points[c * stride] };
                double u[3], v[3], x[3];
                for (int k = 0; k < 3; k++) {
                    u[k] = (p[1]->xyz[k] - p[0]->xyz[k]) / t->extent;
                    v[k] = (p[2]->xyz[k] - p[0]->xyz[k]) / t->extent;
                }
                cross(u, v, x);
                double seen = fabs((p[1]->pixel[0] - p[0]->pixel[0]) * (p[2]->pixel[1] - p[0]->pixel[1]) -
                                   (p[1]->pixel[1] - p[0]->pixel[1]) * (p[2]->pixel[0] - p[0]->pixel[0]));
                double worth = seen * sqrt(dot(x, x));
                size_t now[3] = { a * stride, b * stride, c * stride };
                for (int i = 0; i < TRIPLES; i++)
                    if (worth > best[i]) { /* the others move on */
                        double w = best[i];
                        size_t was[3];
                        memcpy(was, t->triple[i], sizeof(was));
                        best[i] = worth;
                        memcpy(t->triple[i], now, sizeof(now));
                        worth = w;
                        memcpy(now, was, sizeof(now));
                    }
            }
    for (t->triples = 0; t->triples < TRIPLES && best[t->triples] > 0;)
        t->triples++;
}

static int find_starts(const task *t, pose kept[KEPT]) {
    int count = 0;
    for (int step = 0; step < FOCAL_LENGTHS; step++) {
        double fov = 4 * pow(120 / 4.0, step / (FOCAL_LENGTHS - 1.0)), focal = focal_of(t, fov);
        for (int i = 0; i < t->triples; i++) {
            double w[3][3], j[3][3];
            pose found[4];
            for (int k = 0; k < 3; k++) {
                size_t at = t->triple[i][k];
                place(t, at, w[k]);
                for (int c = 0; c < 2; c++)
                    j[k][c] = t->points[at].pixel[c] - t->half[c];
                j[k][2] = focal;
                unit(j[k]);
            }
            int n = three_points(w, j, focal, found);
            for (int k = 0; k < n; k++) {
                judge(t, &found[k]);
                keep(kept, &count, &found[k]);
            }
        }
    }
    return count;
}

static bool start_of(const task *t, const noc_camera *c, pose *out) {
    double forward[3], right[3];
    for (int k = 0; k < 3; k++)
        forward[k] = c->target[k] - c->eye[k];
    cross(forward, c->up, right);
    if (!unit(forward) || !unit(right) || !(c->fov_deg > LEAST_FOV && c->fov_deg < MOST_FOV))
        return false;
    *out = (pose){ .focal = focal_of(t, c->fov_deg) };
    memcpy(out->r[0], right, sizeof(right));
    memcpy(out->r[2], forward, sizeof(forward));
    cross(forward, right, out->r[1]);
    for (int k = 0; k < 3; k++)
        out->eye[k] = (c->eye[k] - t->middle[k]) / t->extent;
    judge(t, out);
    return isfinite(out->rms);
}

/* ---- what cannot be ---- */

/* Greatest extent of points, and how far one is off the line through those two. size: 2 or 3 numbers of each. */
static double off_line(const task *t, int size, double *extent) {
    const double *a = NULL, *b = NULL;
    double most = 0, off = 0;
#define NUMBERS(i) (size == 3 ? t->points[i].xyz : t->points[i].pixel)
    for (size_t i = 0; i < t->count; i++) { /* far from the first, then far from that */
        double d = 0;
        for (int k = 0; k < size; k++)
            d = hypot(d, NUMBERS(i)[k] - NUMBERS(0)[k]);
        if (d >= most)
            a = NUMBERS(i), most = d;
    }
    most = 0;
    for (size_t i = 0; i < t->count; i++) {
        double d = 0;
        for (int k = 0; k < size; k++)
            d = hypot(d, NUMBERS(i)[k] - a[k]);
        if (d >= most)
            b = NUMBERS(i), most = d;
    }
    for (size_t i = 0; i < t->count && most > 0; i++) {
        double along = 0, way2 = 0;
        for (int k = 0; k < size; k++) {
            along += (NUMBERS(i)[k] - a[k]) * (b[k] - a[k]) / most;
            way2 += (NUMBERS(i)[k] - a[k]) * (NUMBERS(i)[k] - a[k]);
        }
        off = fmax(off, sqrt(fmax(way2 - along * along, 0)));
    }
#undef NUMBERS
    *extent = most;
    return most > 0 ? off / most : 0;
}

static noc_status check(task *t, int width, int height, noc_log *log) {
    if (t->count < 4 || t->count > MOST_POINTS)
        return noc_error(log, NOC_ERR_ARGUMENT, "camera of a photograph: %zu points, must be 4 to %d", t->count,
                         MOST_POINTS);
    if (width < 1 || height < 1)
        return noc_error(log, NOC_ERR_ARGUMENT, "camera of a photograph: it has %d x %d pixels", width, height);
    for (size_t i = 0; i < t->count; i++) {
        const noc_camera_point *p = &t->points[i];
        bool good = fabs(p->pixel[0]) < 1e6 && fabs(p->pixel[1]) < 1e6;
        for (int k = 0; k < 3; k++) {
            good = good && fabs(p->xyz[k]) < 1e7;
            t->middle[k] += p->xyz[k] / (double)t->count;
        }
        if (!good)
            return noc_error(log, NOC_ERR_ARGUMENT, "camera of a photograph: point %zu is no place within 10 000 km",
                             i + 1);
    }
    double seen;
    if (off_line(t, 3, &t->extent) < THIN || !(t->extent > 1e-6))
        return noc_error(log, NOC_ERR_ARGUMENT,
                         "camera of a photograph: the places lie on a line: no camera follows from them");
    if (off_line(t, 2, &seen) < THIN || !(seen > 1))
        return noc_error(log, NOC_ERR_ARGUMENT,
                         "camera of a photograph: the pixels lie on a line: no camera follows from them");
    return NOC_OK;
}

static void camera_of(const task *t, const pose *p, noc_camera *out) {
    *out = (noc_camera){ .fov_deg = 360 / M_PI * atan(t->half[1] / p->focal) };
    for (int k = 0; k < 3; k++) {
        out->eye[k] = t->middle[k] + t->extent * p->eye[k];
        out->target[k] = out->eye[k] + t->extent * p->r[2][k];
        out->up[k] = -p->r[1][k];
    }
}

/* Of all that fit about as well the one that is held most upright: four points may have several cameras. */
static const pose *choose(const pose *poses, int count) {
    double best = INFINITY;
    const pose *chosen = NULL;
    for (int i = 0; i < count; i++)
        best = fmin(best, poses[i].rms);
    for (int i = 0; i < count; i++)
        if (poses[i].rms <= 1.05 * best + .05 &&
            (!chosen || poses[i].r[1][2] < chosen->r[1][2] - 1e-3 ||
             (poses[i].r[1][2] < chosen->r[1][2] + 1e-3 && poses[i].rms < chosen->rms)))
            chosen = &poses[i];
    return chosen;
}

noc_status noc_camera_align(const noc_camera_point *points, size_t count, int width, int height,
                            const noc_camera *start, noc_camera *camera, double *residual_px, noc_log *log) {
    if (!points || !camera)
        return noc_null(log, __func__);
    task t = { .points = points, .count = count, .half = { width / 2.0, height / 2.0 } };
    noc_status status = check(&t, width, height, log);
    if (status)
        return status;
    pose poses[KEPT + 1];
    choose_triples(&t);
    int n = find_starts(&t, poses);
    n += start && start_of(&t, start, &poses[n]);
    for (int i = 0; i < n; i++)
        improve(&t, &poses[i]);
    const pose *p = choose(poses, n);
    if (!p || p->rms > MISFIT * hypot(width, height))
        return noc_error(log, NOC_ERR_ARGUMENT,
                         "camera of a photograph: no camera sees these places at these pixels: is one of them wrong?");
    if (decided(&t, p) < DECIDED || p->focal <= 1.001 * focal_of(&t, MOST_FOV) ||
        p->focal >= .999 * focal_of(&t, LEAST_FOV))
        return noc_error(log, NOC_ERR_ARGUMENT,
                         "camera of a photograph: many cameras see these places at these pixels: take some that are "
                         "nearer, further away, or higher");
    camera_of(&t, p, camera);
    if (residual_px)
        *residual_px = p->rms;
    return NOC_OK;
}
