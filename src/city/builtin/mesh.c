/* The built-in city: random numbers, surfaces, and the shapes everything is made of. */
#include "city/city.h"
#include "city/builtin/town.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>

uint32_t town_hash(uint32_t a, uint32_t b) {
    uint32_t h = a * 0x9e3779b1u ^ (b + 0x7f4a7c15u) * 0x85ebca6bu;
    h = (h ^ h >> 15) * 0x2c1b3c6du;
    h = (h ^ h >> 12) * 0x297a2d39u;
    return h ^ h >> 15;
}

double town_next(town_rng *rng) {
    rng->state = town_hash(rng->state, 0x51ed270bu);
    return (double)(rng->state >> 8) / 16777216.0;
}

double town_range(town_rng *rng, double lo, double hi) { return lo + (hi - lo) * town_next(rng); }

int town_below(town_rng *rng, int n) { return (int)(town_next(rng) * n); }

bool town_chance(town_rng *rng, double p) { return town_next(rng) < p; }

/* Parabolas over half turns, mixed with their squares: within 1.1e-3 of the sine, and smooth where they meet. */
double town_sin(double turns) {
    double x = 2 * (turns - floor(turns + 0.5)); /* -1..1 is a whole turn */
    double y = 4 * x * (1 - fabs(x));
    return 0.225 * (y * fabs(y) - y) + y;
}

double town_cos(double turns) { return town_sin(turns + 0.25); }

void town_tri(town *t, town_mat mat, const double a[3], const double b[3], const double c[3]) {
    town_batch *batch = &t->batch[mat];
    uint32_t first = (uint32_t)(batch->xyz.len / 3), corners[3] = { first, first + 1, first + 2 };
    if (!array_append(&batch->xyz, a, 3) || !array_append(&batch->xyz, b, 3) || !array_append(&batch->xyz, c, 3) ||
        !array_append(&batch->indices, corners, 3))
        t->failed = noc_scene_out_of_memory(t->scene);
}

void town_quad(town *t, town_mat mat, const double a[3], const double b[3], const double c[3], const double d[3]) {
    town_batch *batch = &t->batch[mat];
    uint32_t first = (uint32_t)(batch->xyz.len / 3),
             corners[6] = { first, first + 1, first + 2, first, first + 2, first + 3 };
    if (!array_append(&batch->xyz, a, 3) || !array_append(&batch->xyz, b, 3) || !array_append(&batch->xyz, c, 3) ||
        !array_append(&batch->xyz, d, 3) || !array_append(&batch->indices, corners, 6))
        t->failed = noc_scene_out_of_memory(t->scene);
}

static void set3(double out[3], vec2 p, double z) {
    out[0] = p.x;
    out[1] = p.y;
    out[2] = z;
}

static void upright(town *t, town_mat mat, vec2 a, vec2 b, vec2 a_top, vec2 b_top, double z0, double z1) {
    double q[4][3];
    set3(q[0], a, z0);
    set3(q[1], b, z0);
    set3(q[2], b_top, z1);
    set3(q[3], a_top, z1);
    town_quad(t, mat, q[0], q[1], q[2], q[3]);
}

void town_flat(town *t, town_mat mat, const vec2 *p, int n, double z) {
    for (int i = 1; i + 1 < n; i++) {
        double a[3], b[3], c[3];
        set3(a, p[0], z);
        set3(b, p[i], z);
        set3(c, p[i + 1], z);
        town_tri(t, mat, a, b, c);
    }
}

void town_box(town *t, town_mat mat, const vec2 c[4], double z0, double z1) {
    for (int i = 0; i < 4; i++)
        upright(t, mat, c[i], c[(i + 1) % 4], c[i], c[(i + 1) % 4], z0, z1);
    town_flat(t, mat, c, 4, z1);
}

void town_rect(vec2 centre, vec2 dir, double along, double across, vec2 out[4]) {
    static const double sign[4][2] = { { -1, -1 }, { 1, -1 }, { 1, 1 }, { -1, 1 } };
    for (int i = 0; i < 4; i++) {
        double u = sign[i][0] * along, v = sign[i][1] * across;
        out[i] = (vec2){ centre.x + u * dir.x - v * dir.y, centre.y + u * dir.y + v * dir.x };
    }
}

void town_pole(town *t, town_mat mat, vec2 centre, int sides, double r0, double r1, double z0, double z1) {
    vec2 top[16];
    sides = NOC_CLAMP(sides, 3, 16);
    for (int i = 0; i < sides; i++) {
        double c0 = town_cos((double)i / sides), s0 = town_sin((double)i / sides);
        double c1 = town_cos((i + 1.0) / sides), s1 = town_sin((i + 1.0) / sides);
        vec2 a = { centre.x + r0 * c0, centre.y + r0 * s0 }, b = { centre.x + r0 * c1, centre.y + r0 * s1 };
        vec2 c = { centre.x + r1 * c1, centre.y + r1 * s1 };
        top[i] = (vec2){ centre.x + r1 * c0, centre.y + r1 * s0 };
        upright(t, mat, a, b, top[i], c, z0, z1);
    }
    town_flat(t, mat, top, sides, z1);
}

void town_pane_add(town *t, town_mat mat, const double p[3], const double u[3], const double v[3],
                   const town_room *room) {
    town_pane pane = { .mat = mat,
                       .triangle = (uint32_t)(t->batch[mat].indices.len / 3),
                       .shape = { .kind = NOC_LIGHT_PARALLELOGRAM, .group = t->windows },
                       .window = { .level = (float)NOC_MIN(room->level, 1 - 0x1p-24),
                                   .kind = (unsigned char)room->kind,
                                   .often = (unsigned short)(room->often * NOC_WINDOW_OFTEN + 0.5) } };
    double corner[3][3];
    for (int k = 0; k < 3; k++) {
        pane.window.emission[k] = (float)(room->luminance * t->white[room->colour][k]);
        pane.shape.position[k] = p[k];
        pane.shape.edge_u[k] = u[k];
        pane.shape.edge_v[k] = v[k];
        corner[0][k] = p[k] + u[k];
        corner[1][k] = p[k] + u[k] + v[k];
        corner[2][k] = p[k] + v[k];
    }
    town_quad(t, mat, p, corner[0], corner[1], corner[2]);
    if (t->switched && !t->failed && !array_push(&t->panes, pane))
        t->failed = noc_scene_out_of_memory(t->scene);
}

/* Those that triangles of a batch show, which became that mesh. */
static void add_windows(town *t, town_mat mat, int mesh) {
    for (size_t i = 0; i < t->panes.len && !t->failed; i++) {
        const town_pane *p = &t->panes.data[i];
        const uint32_t both[2] = { p->triangle, p->triangle + 1 };
        if (p->mat == mat)
            t->failed = !noc_scene_add_window(
                t->scene, mesh,
                &(noc_pane){ .triangles = both, .triangle_count = 2, .shape = p->shape, .window = p->window });
    }
}

void town_flush(town *t, const char *fmt, ...) {
    char name[96], poles[104]; /* those of lamps have a name of their own beside what they stand on */
    va_list ap;
    va_start(ap, fmt);
    noc_vsnprintf(name, sizeof(name), fmt, ap);
    va_end(ap);
    noc_snprintf(poles, sizeof(poles), "%s/poles", name);
    for (int m = 0; m < TM_COUNT; m++) {
        town_batch *b = &t->batch[m];
        if (!b->indices.len)
            continue;
        noc_mesh mesh = { .vertex_count = b->xyz.len / 3,
                          .positions = b->xyz.data,
                          .triangle_count = b->indices.len / 3,
                          .indices = b->indices.data,
                          .material = t->material[m],
                          .name = m == TM_POLE ? poles : name };
        int index = t->failed ? -1 : noc_scene_add_mesh(t->scene, &mesh);
        t->failed = index < 0;
        add_windows(t, (town_mat)m, index);
        b->xyz.len = b->indices.len = 0;
    }
    t->panes.len = 0;
}

void town_light(town *t, const noc_light *light, int colour, double luminance) {
    noc_light l = *light;
    luminance *= light->group == t->lamps ? t->scene->maintenance : 1;
    for (int k = 0; k < 3; k++)
        l.emission[k] = (float)(luminance * t->white[colour][k]);
    t->failed = t->failed || noc_scene_add_light(t->scene, &l) < 0;
}
