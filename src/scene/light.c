/* Lights and the shapes they show. */
#include "scene/scene.h"

#include <math.h>

static void cross(const double a[3], const double b[3], double out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static double length(const double a[3]) { return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]); }

/* Two unit vectors u, v with u x v = n / |n|. */
static void frame(const double n[3], double u[3], double v[3]) {
    double l = length(n), z[3] = { n[0] / l, n[1] / l, n[2] / l };
    double helper[3] = { fabs(z[0]) < 0.5, fabs(z[0]) >= 0.5, 0 };
    cross(helper, z, u);
    l = length(u);
    for (int i = 0; i < 3; i++)
        u[i] /= l;
    cross(z, u, v);
}

static bool all_finite(const double *v, int n) {
    for (int i = 0; i < n; i++)
        if (!(fabs(v[i]) < 1e7))
            return false;
    return true;
}

enum { DISC_SIDES = 24 };

/* Of the true disc's area. */
static size_t disc_shape(const noc_light *l, const double u[3], const double v[3], double *xyz, uint32_t *indices) {
    double radius = l->radius * sqrt(2 * M_PI / DISC_SIDES / sin(2 * M_PI / DISC_SIDES));
    for (int i = 0; i < DISC_SIDES; i++) {
        double t = 2 * M_PI * i / DISC_SIDES;
        for (int k = 0; k < 3; k++)
            xyz[3 * i + k] = l->position[k] + radius * (cos(t) * u[k] + sin(t) * v[k]);
    }
    for (uint32_t i = 0; i + 2 < DISC_SIDES; i++) {
        indices[3 * i] = 0;
        indices[3 * i + 1] = i + 1;
        indices[3 * i + 2] = i + 2;
    }
    return DISC_SIDES;
}

/* An icosahedron whose faces are cut in four. */
enum { SPHERE_VERTICES = 12 + 30, SPHERE_TRIANGLES = 80 };

static void point_on_sphere(const double p[3], double out[3]) {
    double len = length(p);
    for (int k = 0; k < 3; k++)
        out[k] = p[k] / len;
}

/* The vertex in the middle of an edge: made where it is asked for first. */
static uint32_t middle(double unit[][3], uint32_t edges[][2], uint32_t *count, uint32_t a, uint32_t b) {
    uint32_t low = NOC_MIN(a, b), high = NOC_MAX(a, b), i = 12;
    while (i < *count && (edges[i][0] != low || edges[i][1] != high))
        i++;
    if (i == *count) {
        double sum[3] = { unit[a][0] + unit[b][0], unit[a][1] + unit[b][1], unit[a][2] + unit[b][2] };
        point_on_sphere(sum, unit[i]);
        edges[i][0] = low;
        edges[i][1] = high;
        ++*count;
    }
    return i;
}

/* As large as the true sphere seems, averaged over all directions: a convex body's mean projected area is a quarter of
 * its surface (Cauchy), so the surface is made 4 pi r^2; from any one side it is within 1.2 % of that. Its vertices lie
 * outside of the true sphere, within LIGHT_SPHERE_SHAPE radii, where shadow rays to the light end (core/shadow.h). */
static size_t sphere_shape(const noc_light *l, double *xyz, uint32_t *indices, size_t *triangles) {
    static const uint8_t faces[20][3] = { { 0, 11, 5 }, { 0, 5, 1 },  { 0, 1, 7 },   { 0, 7, 10 }, { 0, 10, 11 },
                                          { 1, 5, 9 },  { 5, 11, 4 }, { 11, 10, 2 }, { 10, 7, 6 }, { 7, 1, 8 },
                                          { 3, 9, 4 },  { 3, 4, 2 },  { 3, 2, 6 },   { 3, 6, 8 },  { 3, 8, 9 },
                                          { 4, 9, 5 },  { 2, 4, 11 }, { 6, 2, 10 },  { 8, 6, 7 },  { 9, 8, 1 } };
    const double gold = (1 + sqrt(5)) / 2,
                 base[12][3] = { { -1, gold, 0 }, { 1, gold, 0 }, { -1, -gold, 0 }, { 1, -gold, 0 },
                                 { 0, -1, gold }, { 0, 1, gold }, { 0, -1, -gold }, { 0, 1, -gold },
                                 { gold, 0, -1 }, { gold, 0, 1 }, { -gold, 0, -1 }, { -gold, 0, 1 } };
    double unit[SPHERE_VERTICES][3], area = 0;
    uint32_t edges[SPHERE_VERTICES][2], count = 12;
    for (int i = 0; i < 12; i++)
        point_on_sphere(base[i], unit[i]);
    for (int i = 0; i < 20; i++) {
        uint32_t a = faces[i][0], b = faces[i][1], c = faces[i][2];
        uint32_t x = middle(unit, edges, &count, a, b), y = middle(unit, edges, &count, b, c),
                 z = middle(unit, edges, &count, c, a);
        memcpy(indices + 12 * i, (uint32_t[]){ a, x, z, x, b, y, z, y, c, x, y, z }, 12 * sizeof(uint32_t));
    }
    for (int t = 0; t < SPHERE_TRIANGLES; t++) {
        const double *p = unit[indices[3 * t]], *q = unit[indices[3 * t + 1]], *r = unit[indices[3 * t + 2]];
        double u[3] = { q[0] - p[0], q[1] - p[1], q[2] - p[2] }, v[3] = { r[0] - p[0], r[1] - p[1], r[2] - p[2] }, n[3];
        cross(u, v, n);
        area += length(n) / 2;
    }
    double radius = l->radius * sqrt(4 * M_PI / area);
    for (int i = 0; i < SPHERE_VERTICES; i++)
        for (int k = 0; k < 3; k++)
            xyz[3 * i + k] = l->position[k] + radius * unit[i][k];
    *triangles = SPHERE_TRIANGLES;
    return SPHERE_VERTICES;
}

/* The last one of these that shows lights of that emission; -1: none of those that were made last. */
static int find_material(const noc_scene *of, const noc_material *m) {
    for (size_t i = of->materials.len; i-- > 0 && i + 256 > of->materials.len;) {
        const noc_material *have = &of->materials.data[i];
        bool free = of->committed && !of->material_uses.data[i]; /* it may be another one soon */
        if (!free && noc_material_of_light(have) && !memcmp(have->emission, m->emission, sizeof(m->emission)))
            return (int)i;
    }
    return -1;
}

/* The material that shows a light: emits, reflects nothing. Lights of one colour share it. That of a profile's lumens
 * is as core/light.h's light_shown has it. */
static int light_material(noc_scene *scene, const noc_light *l) {
    noc_material m = { .roughness = 1, .cls = NOC_CLASS_LAMP, .two_sided = false };
    double shown = l->profile ? 1 / (M_PI * M_PI * l->radius * l->radius * (l->kind == NOC_LIGHT_SPHERE ? 4 : 1)) : 1;
    for (int k = 0; k < 3; k++)
        m.emission[k] = (float)(l->emission[k] * shown);
    int staged = scene->added ? find_material(scene->added, &m) : -1;
    int i = staged >= 0 ? staged + (int)scene->materials.len : find_material(scene, &m);
    return i >= 0 ? i : noc_scene_add_light_material(scene, &m);
}

static bool is_round(const noc_light *l) { return l->kind == NOC_LIGHT_SPHERE || l->kind == NOC_LIGHT_DISC; }
static bool is_point(const noc_light *l) { return l->kind == NOC_LIGHT_POINT || l->kind == NOC_LIGHT_SPOT; }
static bool is_flat(const noc_light *l) { return l->kind == NOC_LIGHT_TRIANGLE || l->kind == NOC_LIGHT_PARALLELOGRAM; }

/* Of the parallelogram or triangle that the edges span. */
static double flat_area(const noc_light *l) {
    double n[3];
    cross(l->edge_u, l->edge_v, n);
    return length(n) * (l->kind == NOC_LIGHT_TRIANGLE ? 0.5 : 1);
}

const char *noc_light_fault(const noc_light *l) {
    if ((unsigned)l->kind >= NOC_LIGHT_KIND_COUNT)
        return "unknown kind";
    if (!all_finite(l->position, 3))
        return "its position is not finite, or further than 10 000 km from the origin";
    for (int i = 0; i < 3; i++)
        if (!(l->emission[i] >= 0 && l->emission[i] <= 1e12f))
            return "its emission is negative or not finite";
    if (is_round(l) && !(l->radius >= 1e-4 && l->radius < 1e5))
        return "its radius must be in 0.0001..100000 m";
    bool spot = l->kind == NOC_LIGHT_SPOT;
    if ((spot || l->kind == NOC_LIGHT_DISC) && !(all_finite(l->direction, 3) && length(l->direction) > 0))
        return "a disc or spot needs a direction";
    if (spot && !(l->outer_deg >= 1 && l->outer_deg <= 90 && l->inner_deg >= 0 && l->inner_deg <= l->outer_deg))
        return "a spot's outer angle must be in 1..90 degrees, its inner one in 0 to that";
    if (is_flat(l) && (!all_finite(l->edge_u, 3) || !all_finite(l->edge_v, 3) || !(flat_area(l) > 1e-10)))
        return "its edges span no area";
    return NULL;
}

float noc_flat_size(const noc_light_record *r) {
    double sum[3], difference[3], a[3] = { r->a[0], r->a[1], r->a[2] }, b[3] = { r->b[0], r->b[1], r->b[2] };
    for (int k = 0; k < 3; k++) {
        sum[k] = a[k] + b[k];
        difference[k] = a[k] - b[k];
    }
    double other = r->kind == NOC_LIGHT_PARALLELOGRAM ? length(sum) : fmax(length(a), length(b));
    return (float)fmax(length(difference), other);
}

/* What the falloff of a spot divides by. The specification's code keeps it from 0 by 0.001, which would dim cones of
 * less than 2.6 degrees; floats do with less. */
static double falloff_width(double inner, double outer) { return fmax(cos(inner) - cos(outer), 1e-5); }

static void set_cones(noc_light_record *r, const noc_light *l) {
    double inner = l->inner_deg * M_PI / 180, outer = l->outer_deg * M_PI / 180, width = falloff_width(inner, outer);
    for (int k = 0; k < 3; k++)
        r->a[k] = (float)(l->direction[k] / (length(l->direction) * width));
    r->b[0] = (float)(-cos(outer) / width);
    r->b[1] = (float)inner;
    r->b[2] = (float)outer;
}

/* Solid angle, sr, that a spot's greatest intensity would fill with its flux: the integral of ((c - cos outer) /
 * width)^2 over the cosines c between the cones, and of 1 from there to the axis. */
static double spot_angle(const noc_light_record *r) {
    double inner = r->b[1], outer = r->b[2], width = falloff_width(inner, outer);
    return 2 * M_PI * (1 - cos(outer) - width * 2 / 3);
}

/* A Lambertian emitter of luminance L sends pi L from each m2 of each side that it emits from; a point of I candela 4
 * pi I. One with a profile is told by its flux. */
double noc_light_flux(const noc_light_record *r) {
    double e = 0.2126 * r->e[0] + 0.7152 * r->e[1] + 0.0722 * r->e[2];
    if (noc_light_has_profile(r))
        return e;
    if (r->kind == NOC_LIGHT_POINT || r->kind == NOC_LIGHT_SPOT)
        return (r->kind == NOC_LIGHT_SPOT ? spot_angle(r) : 4 * M_PI) * e;
    return M_PI * e * r->area * (r->flags & NOC_LIGHT_TWO_SIDED ? 2 : 1);
}

noc_light_record noc_light_record_of(const noc_scene *scene, const noc_light *l) {
    noc_light_record r = { .kind = (uint32_t)l->kind,
                           .flags = (l->inferred ? NOC_LIGHT_INFERRED : 0) | (l->moving ? NOC_LIGHT_MOVES : 0) |
                                    (uint32_t)l->group << NOC_LIGHT_GROUP,
                           .radius = is_round(l) ? (float)l->radius : 0 };
    double u[3] = { 0 }, v[3] = { 0 };
    if (l->kind == NOC_LIGHT_DISC)
        frame(l->direction, u, v);
    if (l->kind == NOC_LIGHT_SPHERE)
        r.area = (float)(4 * M_PI * l->radius * l->radius);
    else if (l->kind == NOC_LIGHT_DISC)
        r.area = (float)(M_PI * l->radius * l->radius);
    else if (is_flat(l))
        r.area = (float)flat_area(l);
    for (int k = 0; k < 3; k++) {
        r.p[k] = (float)l->position[k];
        r.a[k] = (float)(is_flat(l) ? l->edge_u[k] : l->radius * u[k]);
        r.b[k] = (float)(is_flat(l) ? l->edge_v[k] : l->radius * v[k]);
        r.e[k] = l->emission[k];
    }
    if (is_flat(l))
        r.radius = noc_flat_size(&r);
    if (l->kind == NOC_LIGHT_SPOT)
        set_cones(&r, l);
    if (l->profile)
        noc_light_set_profile(scene, l, &r);
    return r;
}

static size_t flat_shape(const noc_light *l, double *xyz, uint32_t *indices) {
    bool whole = l->kind == NOC_LIGHT_PARALLELOGRAM;
    for (int k = 0; k < 3; k++) {
        xyz[k] = l->position[k];
        xyz[3 + k] = l->position[k] + l->edge_u[k];
        xyz[6 + k] = l->position[k] + whole * l->edge_u[k] + l->edge_v[k];
        xyz[9 + k] = l->position[k] + l->edge_v[k];
    }
    memcpy(indices, (uint32_t[]){ 0, 1, 2, 0, 2, 3 }, 6 * sizeof(uint32_t));
    return whole ? 4 : 3;
}

noc_light_record noc_triangle_light(const float *a, const float *b, const float *c, const noc_material *material) {
    noc_light_record r = { .kind = NOC_LIGHT_TRIANGLE,
                           .flags = (material->two_sided ? NOC_LIGHT_TWO_SIDED : 0) | NOC_LIGHT_OWNED };
    for (int k = 0; k < 3; k++) {
        r.p[k] = a[k];
        r.a[k] = b[k] - a[k];
        r.b[k] = c[k] - a[k];
        r.e[k] = material->emission[k];
    }
    r.area = (float)(0.5 * noc_double_area(a, b, c));
    r.radius = noc_flat_size(&r);
    return r;
}

/* The mesh that shows the light of this index; name: the scene's. */
static bool add_shape(noc_scene *scene, const noc_light *l, uint32_t index, const char *name) {
    double xyz[3 * SPHERE_VERTICES], u[3], v[3];
    uint32_t indices[3 * SPHERE_TRIANGLES];
    size_t vertices, triangles;
    if (l->kind == NOC_LIGHT_SPHERE) {
        vertices = sphere_shape(l, xyz, indices, &triangles);
    } else if (l->kind == NOC_LIGHT_DISC) {
        frame(l->direction, u, v);
        vertices = disc_shape(l, u, v, xyz, indices);
        triangles = DISC_SIDES - 2;
    } else {
        vertices = flat_shape(l, xyz, indices);
        triangles = vertices - 2;
    }
    noc_scene *to = noc_scene_adding(scene);
    int material = to ? light_material(scene, l) : -1;
    size_t first = to ? to->triangle_light.len : 0;
    noc_mesh mesh = { .vertex_count = vertices,
                      .positions = xyz,
                      .triangle_count = triangles,
                      .indices = indices,
                      .material = material,
                      .model = l->model,
                      .name = l->name };
    bool staged = false;
    if (material < 0 || (!l->model && noc_shape_stage(scene, &mesh, index, name, &staged) != NOC_OK))
        return false;
    if (staged)
        return true;
    if (noc_scene_add_mesh(scene, &mesh) < 0)
        return false;
    for (size_t t = first; t < to->triangle_light.len; t++)
        to->triangle_light.data[t] = index;
    return true;
}

bool noc_scene_add_shape(noc_scene *scene, const noc_light *l, uint32_t number) {
    return is_point(l) || add_shape(scene, l, number, NULL);
}

/* Of a model: the number that it has there. */
static int add_to_model(noc_scene *scene, const noc_light *l, const char *name) {
    noc_scene_model *m = noc_scene_model_of(scene, l->model);
    uint32_t index = (uint32_t)m->lights.len;
    if (!array_reserve(&m->lights, index + 1) || !array_reserve(&m->light_names, index + 1)) {
        noc_scene_out_of_memory(scene);
        return -1;
    }
    if (!is_point(l) && !add_shape(scene, l, index, name))
        return -1;
    m->lights.data[m->lights.len++] = noc_light_record_of(scene, l);
    m->light_names.data[m->light_names.len++] = name;
    return (int)index;
}

/* Straight into the arrays, before the first commit. bare: without a shape. */
static int add_to_arrays(noc_scene *scene, const noc_light *l, const char *name, bool bare) {
    uint32_t index = (uint32_t)scene->lights.len;
    if (!array_reserve(&scene->lights, index + 1) || !array_reserve(&scene->light_names, index + 1) ||
        (l->moving && !array_reserve(&scene->moving, scene->moving.len + 1))) {
        noc_scene_out_of_memory(scene);
        return -1;
    }
    if (!bare && !is_point(l) && !l->moving && !add_shape(scene, l, index, name))
        return -1;
    scene->lights.data[scene->lights.len++] = noc_light_record_of(scene, l);
    scene->light_names.data[scene->light_names.len++] = name;
    if (l->moving)
        scene->moving.data[scene->moving.len++] = index;
    scene->lights_inferred += l->inferred;
    return (int)index;
}

/* Into the slot that commit will find free. */
static int stage_light(noc_scene *scene, const noc_light *l, const char *name) {
    uint32_t slot = noc_slot_next(&scene->light_slots, scene->lights.len);
    if (!array_reserve(&scene->edits, scene->edits.len + 2)) { /* the shape's material may be one, too */
        noc_scene_out_of_memory(scene);
        return -1;
    }
    if (!is_point(l) && !l->moving && !add_shape(scene, l, slot, name))
        return -1;
    noc_slot_take(&scene->light_slots);
    scene->edits.data[scene->edits.len++] =
        (noc_edit){ .kind = NOC_EDIT_ADD_LIGHT, .index = slot, .name = name, .light = noc_light_record_of(scene, l) };
    return (int)slot;
}

/* Reports what is wrong with it; keeps its name. */
static bool takes_light(noc_scene *scene, const noc_light *l, const char **name) {
    if (scene->no_memory)
        return false;
    const char *wrong = noc_light_fault(l);
    if (!wrong)
        wrong = noc_light_profile_fault(scene, l);
    char text[NOC_FAULT];
    if (!wrong && !noc_scene_takes(scene, l->group, l->model, text))
        wrong = text;
    if (wrong) {
        noc_error(scene->log, NOC_ERR_ARGUMENT, "light %s: %s", l->name ? l->name : "unnamed", wrong);
        return false;
    }
    return noc_scene_keep_name(scene, l->name, name);
}

int noc_scene_add_light(noc_scene *scene, const noc_light *l) {
    const char *name;
    if (!scene || !l) {
        noc_null(scene ? scene->log : NULL, __func__);
        return -1;
    }
    if (!takes_light(scene, l, &name))
        return -1;
    if (l->model)
        return add_to_model(scene, l, name);
    return scene->committed ? stage_light(scene, l, name) : add_to_arrays(scene, l, name, false);
}

int noc_scene_add_body_light(noc_scene *scene, const noc_light *l) {
    const char *name;
    return takes_light(scene, l, &name) ? add_to_arrays(scene, l, name, true) : -1;
}
