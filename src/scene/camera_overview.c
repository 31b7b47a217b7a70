/* A view of the whole extent. It frames what is there, not the box around it: a city is seldom as square as its box. */
#include "scene/camera.h"

#include <math.h>

enum { CELLS = 96 }; /* a side of the ground plan */

#define BORDER 1.08 /* of the picture's half height and half width, over what the city takes of them */

typedef struct cell_box {
    float lo[3], hi[3]; /* lo[0] > hi[0]: nothing in it */
} cell_box;

/* Land that a city stands on, and that may reach far beyond it. */
#define LAND (1u << NOC_CLASS_TERRAIN | 1u << NOC_CLASS_GREEN | 1u << NOC_CLASS_WATER)

static void add_point(const float v[3], const double lo[3], const double hi[3], cell_box *boxes) {
    double p[3];
    int cell[2];
    for (int k = 0; k < 3; k++)
        p[k] = NOC_CLAMP((double)v[k], lo[k], hi[k]);
    for (int k = 0; k < 2; k++)
        cell[k] = hi[k] > lo[k] ? (int)NOC_MIN(CELLS * ((p[k] - lo[k]) / (hi[k] - lo[k])), CELLS - 1.0) : 0;
    cell_box *box = &boxes[cell[1] * CELLS + cell[0]];
    for (int k = 0; k < 3; k++) {
        box->lo[k] = NOC_MIN(box->lo[k], (float)p[k]);
        box->hi[k] = NOC_MAX(box->hi[k], (float)p[k]);
    }
}

static void add_mesh(const noc_scene *s, const noc_scene_mesh *m, const double lo[3], const double hi[3],
                     cell_box *boxes) {
    for (size_t i = 3 * (size_t)m->first_triangle; i < 3 * ((size_t)m->first_triangle + m->triangle_count); i++)
        add_point(s->positions.data + 3 * (size_t)s->indices.data[i], lo, hi, boxes);
}

static void add_bodies(const noc_scene *s, const double lo[3], const double hi[3], cell_box *boxes) {
    for (size_t i = 0; i < s->bodies.len; i++) {
        size_t first, end = noc_body_vertices(s, &s->bodies.data[i], &first);
        for (size_t v = first; v < end; v++) {
            float p[3];
            noc_body_vertex(s, &s->bodies.data[i], v, p);
            add_point(p, lo, hi, boxes);
        }
    }
}

/* What lies in each cell of the plan, as a box; the land counts where there is nothing else. */
static void fill_boxes(const noc_scene *s, const double lo[3], const double hi[3], cell_box *boxes) {
    for (int i = 0; i < CELLS * CELLS; i++)
        boxes[i] = (cell_box){ { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY } };
    bool built = s->bodies.len > 0;
    add_bodies(s, lo, hi, boxes);
    for (int land = 0; land < 2 && !(land && built); land++)
        for (size_t i = 0; i < s->meshes.len; i++) {
            const noc_scene_mesh *m = &s->meshes.data[i];
            if (!m->triangle_count || !noc_mesh_in_city(s, m) ||
                (!land && LAND >> s->materials.data[m->material].cls & 1))
                continue;
            built = true;
            add_mesh(s, m, lo, hi, boxes);
        }
}

/* The points that the view has to hold, relative to centre: corners of the boxes. */
static size_t corners_of(const cell_box *boxes, const double centre[3], double (*points)[3]) {
    size_t n = 0;
    for (int i = 0; i < CELLS * CELLS; i++)
        for (int c = 0; c < 8 && boxes[i].lo[0] <= boxes[i].hi[0]; c++, n++)
            for (int k = 0; k < 3; k++)
                points[n][k] = (double)(c >> k & 1 ? boxes[i].hi[k] : boxes[i].lo[k]) - centre[k];
    return n;
}

bool noc_overview_camera(const noc_scene *scene, const double lo[3], const double hi[3], double aspect,
                         noc_camera *camera) {
    double centre[3];
    for (int k = 0; k < 3; k++)
        centre[k] = 0.5 * (lo[k] + hi[k]);
    cell_box *boxes = noc_alloc(CELLS * CELLS * sizeof(*boxes));
    double(*points)[3] = noc_alloc(CELLS * CELLS * 8 * sizeof(*points));
    if (!boxes || !points) {
        free(boxes);
        free(points);
        return false;
    }
    fill_boxes(scene, lo, hi, boxes);
    size_t n = corners_of(boxes, centre, points);
    free(boxes);
    /* from the south, or the east where the city is longer that way, turned so that no street is seen end on */
    double yaw = (hi[1] - lo[1] > 1.2 * (hi[0] - lo[0]) ? 0 : -M_PI / 2) + 0.3, pitch = 0.55;
    double d[3] = { cos(yaw) * cos(pitch), sin(yaw) * cos(pitch), sin(pitch) };
    double right[3] = { -sin(yaw), cos(yaw), 0 },
           up[3] = { -cos(yaw) * sin(pitch), -sin(yaw) * sin(pitch), cos(pitch) };
    camera->fov_deg = 36;
    /* by turns the nearest distance that holds all points, and the middle of what is then seen */
    double tv = tan(camera->fov_deg * M_PI / 360) / BORDER, th = tv * aspect;
    double shift[2] = { 0, 0 }, distance = 0.1;
    for (int round = 0; round < 4; round++) {
        double low[2] = { INFINITY, INFINITY }, high[2] = { -INFINITY, -INFINITY };
        for (int pass = 0; pass < 2; pass++) {
            for (size_t i = 0; i < n; i++) {
                double along = 0, x = -shift[0], y = -shift[1];
                for (int k = 0; k < 3; k++)
                    along += points[i][k] * d[k], x += points[i][k] * right[k], y += points[i][k] * up[k];
                if (!pass) {
                    double need = along + NOC_MAX(fabs(x) / th, fabs(y) / tv);
                    distance = i ? NOC_MAX(distance, need) : need;
                    continue;
                }
                low[0] = NOC_MIN(low[0], x / (distance - along)), high[0] = NOC_MAX(high[0], x / (distance - along));
                low[1] = NOC_MIN(low[1], y / (distance - along)), high[1] = NOC_MAX(high[1], y / (distance - along));
            }
            distance = NOC_MAX(distance, 0.1);
        }
        if (round < 3)
            for (int k = 0; k < 2; k++)
                shift[k] += 0.5 * (low[k] + high[k]) * distance;
    }
    free(points);
    for (int k = 0; k < 3; k++) {
        camera->target[k] = centre[k] + shift[0] * right[k] + shift[1] * up[k];
        camera->eye[k] = camera->target[k] + distance * d[k];
    }
    return true;
}
