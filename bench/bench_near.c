/* How far pixels close to a large light are off in one frame: a window of 1 x 1.5 m over a floor.
 *
 *   bench_near [SEEDS]     default: 16
 *
 * "facing": the window lies parallel to the floor, this gap above it, and shines down on it. "standing": it stands on
 * edge, its lower edge this gap above the floor. Alone, or among 2,000 windows 20 to 300 m away. The floor below
 * (before) it, 1 x 1.5 m (1 x 1 m), is seen through the window, which was made to move and so has no shape. The truth
 * is Lambert's formula. Printed: median, largest and root mean square error of the ratio to the truth of a pixel of one
 * frame, and the mean ratio. */
#include "bench_scene.h"
#include "../tests/own_view.h"

#include <math.h>

enum { W = 48, H = 48, CROWD = 2000 };

typedef struct quad {
    double p[3], a[3], b[3];
} quad;

static void cross(const double *a, const double *b, double *c) {
    for (int k = 0; k < 3; k++)
        c[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

/* Irradiance of a horizontal floor by a parallelogram of radiance 1 that lies above it: Lambert's formula. */
static double irradiance(const quad *q, const double y[3]) {
    double c[4][3], n[3], back = 0, e = 0;
    cross(q->a, q->b, n);
    for (int k = 0; k < 3; k++) {
        c[0][k] = q->p[k] - y[k];
        c[1][k] = c[0][k] + q->a[k];
        c[2][k] = c[1][k] + q->b[k];
        c[3][k] = c[0][k] + q->b[k];
        back += n[k] * c[0][k];
    }
    for (int i = 0; i < 4 && back < 0; i++) {
        double s[3], *u = c[i], *v = c[(i + 1) % 4];
        cross(u, v, s);
        double sine = sqrt(s[0] * s[0] + s[1] * s[1] + s[2] * s[2]);
        if (sine > 0)
            e += atan2(sine, u[0] * v[0] + u[1] * v[1] + u[2] * v[2]) * s[2] / sine;
    }
    return fabs(e) / 2;
}

static void add(noc_scene *s, const quad *q) {
    noc_light l = { .kind = NOC_LIGHT_PARALLELOGRAM, .emission = { 10, 10, 10 }, .moving = true };
    memcpy(l.position, q->p, sizeof(l.position));
    memcpy(l.edge_u, q->a, sizeof(l.edge_u));
    memcpy(l.edge_v, q->b, sizeof(l.edge_v));
    noc_scene_add_light(s, &l);
}

typedef struct view {
    int standing;
    double gap;
    int lights;
    quad quads[1 + CROWD];
} view;

static void measure(const view *v, const char *name, noc_candidates candidates, noc_method method, int seeds) {
    noc_scene *s = noc_scene_create(NULL);
    noc_material matte = { .albedo = { .5f, .5f, .5f }, .roughness = 1 };
    const double floor[12] = { -40, -40, 0, 40, -40, 0, 40, 40, 0, -40, 40, 0 };
    noc_mesh m = { .vertex_count = 4,
                   .positions = floor,
                   .triangle_count = 2,
                   .indices = (uint32_t[]){ 0, 1, 2, 0, 2, 3 },
                   .material = noc_scene_add_material(s, &matte) };
    noc_scene_add_mesh(s, &m);
    for (int i = 0; i < v->lights; i++)
        add(s, &v->quads[i]);
    noc_scene_commit(s);
    noc_view *r = own_view(s, 0, NULL);
    noc_render_params p = noc_render_default_params();
    p.width = W;
    p.height = H;
    p.sky = 0;
    p.jitter = p.accumulate = p.emitters = false;
    p.method = method;
    p.candidates = candidates;
    double side = 1, height = 60; /* half a metre around the middle at this distance: nearly parallel rays */
    noc_camera c = { .eye = { 0, 0, height },
                     .target = { 0, 0, 0 },
                     .up = { 0, 1, 0 },
                     .fov_deg = 2 * atan(side / 2 / height) * 180 / M_PI };
    static double ratio[64 * W * H];
    double truth[W * H], sum = 0, square = 0;
    size_t n = 0;
    for (int i = 0; i < W * H; i++) {
        double y[3] = { ((i % W + .5) / W - .5) * side, (.5 - (i / W + .5) / H) * side, 0 };
        truth[i] = 0;
        for (int k = 0; k < v->lights; k++)
            truth[i] += 10 * .5 / M_PI * irradiance(&v->quads[k], y);
    }
    for (int i = 0; i < seeds; i++) {
        p.seed = 1000 + (uint32_t)i;
        noc_view_reset(r);
        noc_view_render(r, &c, &p, NULL);
        noc_image *image = noc_view_image(r);
        for (int k = 0; k < W * H; k++, n++) {
            ratio[n] = image->rgb[3 * k + 1] / truth[k];
            sum += ratio[n];
            square += (ratio[n] - 1) * (ratio[n] - 1);
        }
        noc_image_destroy(image);
    }
    double median = bench_median(ratio, (int)n);
    printf("%-9s %6.2f m %5d lights  %-20s median %6.3f  most %8.2f  rms error %7.3f  mean %.4f\n",
           v->standing ? "standing" : "facing", v->gap, v->lights, name, median, ratio[n - 1], sqrt(square / (double)n),
           sum / (double)n);
    fflush(stdout);
    close_view(r);
    noc_scene_destroy(s);
}

int main(int argc, char **argv) {
    int seeds = argc > 1 ? atoi(argv[1]) : 16;
    static view v;
    if (seeds < 1 || seeds > 64) {
        fprintf(stderr, "usage: bench_near [SEEDS]\n");
        return 2;
    }
    for (v.standing = 0; v.standing <= 1; v.standing++) {
        static const double gaps[] = { 0.01, 0.1, 1 };
        for (int i = 0; i < 3; i++) {
            v.gap = gaps[i];
            v.quads[0] = v.standing ? (quad){ { -.5, .5, v.gap }, { 1, 0, 0 }, { 0, 0, 1.5 } } /* faces -y */
                                    : (quad){ { -.5, -.75, v.gap }, { 0, 1.5, 0 }, { 1, 0, 0 } };
            for (int k = 0; k < CROWD; k++) {
                double t = 2.399963 * k, d = 20 + 280 * sqrt((k + .5) / CROWD), h = 1 + 3 * (k % 5);
                v.quads[1 + k] = (quad){ { d * cos(t), d * sin(t), h }, { -sin(t), cos(t), 0 }, { 0, 0, 1.5 } };
                for (int j = 0; j < 3; j++) /* faces the middle */
                    v.quads[1 + k].a[j] = -v.quads[1 + k].a[j];
            }
            for (v.lights = 1; v.lights <= 1 + CROWD; v.lights += CROWD) {
                measure(&v, "is", NOC_CANDIDATES_UNIFORM, NOC_METHOD_IS, seeds);
                measure(&v, "ris, uniform", NOC_CANDIDATES_UNIFORM, NOC_METHOD_RIS, seeds);
                measure(&v, "ris, lists", NOC_CANDIDATES_LISTS, NOC_METHOD_RIS, seeds);
                measure(&v, "restir, lists", NOC_CANDIDATES_LISTS, NOC_METHOD_RESTIR, seeds);
            }
        }
    }
    return 0;
}
