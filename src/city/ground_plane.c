/* A ground for a city that comes without one.
 *
 * Cells of a coarse grid that hold feet of buildings or pieces of street know their height: the mean of the feet, but
 * no higher than a street there. The others are filled in from coarser grids and all are smoothed, so that the ground
 * runs evenly between the buildings; surveyed points draw it to them (ground_survey.c). It fills gaps and does not
 * cover streets; walls that then stand over it get skirts, and those that reach into it do not show it. A level city
 * gets one plane. Around it the land runs on to the horizon. */
#include "city/ground_field.h"
#include "scene/scene.h"

#include <float.h>
#include <math.h>

#define CELL 6.0 /* m */
#define MAX_SIDE 256
#define UNDER 0.02      /* m below what stands on it */
#define LEVEL 0.05      /* m: less than this is flat */
#define FOOT 1.5        /* m: what begins higher over the lowest in its cell is no foot */
#define MOST_POINTS 1e8 /* of all triangles, at which the ground is looked at; the least of each come on top */
#define STEEPEST 0.6    /* what rises faster from its surroundings is a dormer or a tower, not a foot */

typedef ground_field field;

static bool is_base(noc_class cls) {
    return cls == NOC_CLASS_WALL || cls == NOC_CLASS_GROUND || cls == NOC_CLASS_ROAD || cls == NOC_CLASS_SIDEWALK ||
           cls == NOC_CLASS_GREEN || cls == NOC_CLASS_WATER || cls == NOC_CLASS_DOOR || cls == NOC_CLASS_TERRAIN;
}

static const float *corner(const noc_scene *scene, size_t t, int i) {
    return scene->positions.data + 3 * (size_t)scene->indices.data[3 * t + i];
}

static noc_class class_of(const noc_scene *scene, size_t t) {
    return scene->materials.data[scene->triangle_material.data[t]].cls;
}

/* What the ground must not cover. */
static bool is_street(noc_class cls) {
    return is_base(cls) && cls != NOC_CLASS_WALL && cls != NOC_CLASS_GROUND && cls != NOC_CLASS_DOOR;
}

/* Without buildings and streets, what else stands on the ground. */
static bool is_thing(noc_class cls) {
    return cls == NOC_CLASS_FURNITURE || cls == NOC_CLASS_TREE || cls == NOC_CLASS_VEHICLE;
}

/* The next triangle of a mesh that tells where the ground is, from t on; `end` if there is none before. mesh: the one
 * that t is of. */
static size_t next_base(const noc_scene *scene, size_t *mesh, size_t t, size_t end) {
    while (t < end) {
        const noc_scene_mesh *m = &scene->meshes.data[*mesh];
        size_t mesh_end = (size_t)m->first_triangle + m->triangle_count;
        if (!(m->aloft > 0) && t < mesh_end)
            return t;
        t = NOC_MAX(t, mesh_end);
        ++*mesh;
    }
    return end;
}

#define EACH_BASE(scene, t)                                                                                            \
    for (size_t mesh_ = 0, end_ = (scene)->triangle_light.len, t = next_base(scene, &mesh_, 0, end_); t < end_;        \
         t = next_base(scene, &mesh_, t + 1, end_))

static bool has_bases(const noc_scene *scene) {
    EACH_BASE(scene, t)
    if (is_base(class_of(scene, t)))
        return true;
    return false;
}

static int cell_index(const field *f, int axis, double x) {
    return (int)NOC_CLAMP((x - f->min[axis]) / f->step[axis], 0, (axis ? f->ny : f->nx) - 1);
}

static size_t cell_at(const field *f, double x, double y) {
    return (size_t)cell_index(f, 1, y) * (size_t)f->nx + (size_t)cell_index(f, 0, x);
}

static void lower(field *f, double x, double y, double z, bool street) {
    size_t i = cell_at(f, x, y);
    if (!(f->height[i] <= z))
        f->height[i] = (float)z;
    if (street && z < f->street[i])
        f->street[i] = (float)z;
}

/* Steps in which a triangle's sides are looked at: half a cell. */
static int steps_of(const field *f, const noc_scene *scene, size_t t) {
    const float *a = corner(scene, t, 0), *b = corner(scene, t, 1), *c = corner(scene, t, 2);
    double span =
        NOC_MAX(hypot((double)b[0] - a[0], (double)b[1] - a[1]), hypot((double)c[0] - a[0], (double)c[1] - a[1]));
    return (int)NOC_CLAMP(2 * span / NOC_MIN(f->step[0], f->step[1]), 1, 600);
}

/* Corners and, where a triangle is larger than a cell, points on it. */
static void add_triangle(field *f, const noc_scene *scene, size_t t, int n, bool street) {
    const float *a = corner(scene, t, 0), *b = corner(scene, t, 1), *c = corner(scene, t, 2);
    for (int i = 0; i <= n; i++)
        for (int j = 0; i + j <= n; j++) {
            double u = (double)i / n, v = (double)j / n, w = 1 - u - v;
            lower(f, w * a[0] + u * b[0] + v * c[0], w * a[1] + u * b[1] + v * c[1], w * a[2] + u * b[2] + v * c[2],
                  street);
        }
    f->points += (size_t)(n + 1) * (size_t)(n + 2) / 2;
}

static int compare_floats(const void *a, const void *b) {
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* Forgets cells that stand higher over any other than the steepest ground would: walls that begin on a roof. */
static void drop_towers(field *f) {
    size_t n = (size_t)f->nx * (size_t)f->ny;
    float *limit = (float *)f->scratch;
    for (size_t i = 0; i < n; i++)
        limit[i] = isnan(f->height[i]) ? INFINITY : f->height[i];
    float rise = (float)(STEEPEST * NOC_MIN(f->step[0], f->step[1]));
    for (int pass = 0; pass < 4; pass++) { /* sweeps there and back carry the limit over the whole grid */
        bool back = pass & 1;
        for (int j = 0; j < f->ny; j++)
            for (int i = 0; i < f->nx; i++) {
                int x = back ? f->nx - 1 - i : i, y = back ? f->ny - 1 - j : j, d = back ? 1 : -1;
                size_t k = (size_t)y * (size_t)f->nx + (size_t)x;
                if (x + d >= 0 && x + d < f->nx)
                    limit[k] = NOC_MIN(limit[k], limit[k + (size_t)(ptrdiff_t)d] + rise);
                if (y + d >= 0 && y + d < f->ny)
                    limit[k] = NOC_MIN(limit[k], limit[(size_t)(y + d) * (size_t)f->nx + (size_t)x] + rise);
            }
    }
    for (size_t i = 0; i < n; i++)
        if (f->height[i] > limit[i] + .01f)
            f->height[i] = NAN;
}

/* Forgets cells that lie absurdly below or above the rest (a building at height 0 in a town at 400 m). Returns how many
 * cells know their height, with the lowest and highest. */
static size_t drop_outliers(field *f, double *lo, double *hi) {
    size_t n = (size_t)f->nx * (size_t)f->ny, known = 0;
    float *sorted = (float *)f->scratch;
    for (size_t i = 0; i < n; i++)
        if (!isnan(f->height[i]))
            sorted[known++] = f->height[i];
    *lo = *hi = 0;
    size_t kept = 0;
    if (known) {
        qsort(sorted, known, sizeof(*sorted), compare_floats);
        double q1 = sorted[known / 4], q3 = sorted[known - 1 - known / 4], slack = 30 + 4 * (q3 - q1);
        *lo = DBL_MAX;
        *hi = -DBL_MAX;
        for (size_t i = 0; i < n; i++) {
            if (f->height[i] < q1 - slack || f->height[i] > q3 + slack)
                f->height[i] = NAN;
        }
        drop_towers(f);
        for (size_t i = 0; i < n; i++) {
            f->fixed[i] = !isnan(f->height[i]);
            if (f->fixed[i]) {
                *lo = NOC_MIN(*lo, f->height[i]);
                *hi = NOC_MAX(*hi, f->height[i]);
                kept++;
            }
        }
    }
    return kept;
}

/* Relaxes the free cells towards the mean of their neighbours. */
static void relax(field *f, int rounds) {
    for (int r = 0; r < rounds; r++)
        for (int y = 0; y < f->ny; y++)
            for (int x = 0; x < f->nx; x++) {
                size_t i = (size_t)y * (size_t)f->nx + (size_t)x;
                if (f->fixed[i])
                    continue;
                float sum = 0;
                int n = 0;
                const int step[4][2] = { { -1, 0 }, { 1, 0 }, { 0, -1 }, { 0, 1 } };
                for (int k = 0; k < 4; k++) {
                    int u = x + step[k][0], v = y + step[k][1];
                    if (u >= 0 && v >= 0 && u < f->nx && v < f->ny) {
                        sum += f->height[(size_t)v * (size_t)f->nx + (size_t)u];
                        n++;
                    }
                }
                if (n)
                    f->height[i] = sum / (float)n;
            }
}

/* Fills the unknown cells: from a grid of half the size, then relaxed. At least one cell is known. False: no memory. */
static bool fill(field *f) {
    if (f->nx == 1 && f->ny == 1)
        return true;
    field half = { .nx = (f->nx + 1) / 2, .ny = (f->ny + 1) / 2 };
    size_t n = (size_t)half.nx * (size_t)half.ny;
    half.height = noc_calloc(n, sizeof(*half.height) + sizeof(int) + sizeof(*half.fixed)); /* and count, and fixed */
    if (!half.height)
        return false;
    int *count = (int *)(half.height + n);
    half.fixed = (bool *)(count + n);
    for (int y = 0; y < f->ny; y++)
        for (int x = 0; x < f->nx; x++) {
            size_t i = (size_t)y * (size_t)f->nx + (size_t)x, k = (size_t)(y / 2) * (size_t)half.nx + (size_t)(x / 2);
            if (f->fixed[i]) {
                half.height[k] += f->height[i];
                count[k]++;
            }
        }
    for (size_t k = 0; k < n; k++) {
        half.fixed[k] = count[k] > 0;
        half.height[k] = count[k] ? half.height[k] / (float)count[k] : NAN;
    }
    bool filled = fill(&half);
    for (int y = 0; y < f->ny && filled; y++)
        for (int x = 0; x < f->nx; x++) {
            size_t i = (size_t)y * (size_t)f->nx + (size_t)x;
            if (!f->fixed[i])
                f->height[i] = half.height[(size_t)(y / 2) * (size_t)half.nx + (size_t)(x / 2)];
        }
    free(half.height);
    if (filled)
        relax(f, 40);
    return filled;
}

/* Raises known cells from the lowest point in them to the mean of the feet there. */
static void raise_to_feet(field *f, const noc_scene *scene, bool land) {
    size_t n = (size_t)f->nx * (size_t)f->ny;
    double *sum = f->scratch, *weight = sum + n;
    memset(sum, 0, 2 * n * sizeof(*sum));
    EACH_BASE(scene, t) {
        noc_class cls = class_of(scene, t);
        bool told = land || !scene->meshes.data[mesh_].land;
        for (int i = 0; i < 3 && told && (cls == NOC_CLASS_WALL || cls == NOC_CLASS_GROUND); i++) {
            const float *a = corner(scene, t, i), *b = corner(scene, t, (i + 1) % 3),
                        *c = corner(scene, t, (i + 2) % 3);
            if (cls == NOC_CLASS_WALL && !city_wall_foot(a, b, c))
                continue;
            double length = hypot((double)b[0] - a[0], (double)b[1] - a[1]);
            int steps = (int)NOC_CLAMP(length / 3, 1, 1000);
            for (int k = 0; k < steps; k++) {
                double u = (k + .5) / steps, z = a[2] + u * ((double)b[2] - a[2]);
                size_t cell = cell_at(f, a[0] + u * ((double)b[0] - a[0]), a[1] + u * ((double)b[1] - a[1]));
                if (f->fixed[cell] && z <= f->height[cell] + FOOT) {
                    sum[cell] += z * length / steps;
                    weight[cell] += length / steps;
                }
            }
        }
    }
    for (size_t i = 0; i < n; i++)
        if (weight[i] > 0)
            f->height[i] = f->foot[i] = (float)(sum[i] / weight[i]);
}

/* Cells beside streets must not rise over them where the two meet. */
static void spread_streets(field *f) {
    size_t n = (size_t)f->nx * (size_t)f->ny;
    float *own = (float *)f->scratch;
    memcpy(own, f->street, n * sizeof(*own));
    for (int y = 0; y < f->ny; y++)
        for (int x = 0; x < f->nx; x++) {
            size_t i = (size_t)y * (size_t)f->nx + (size_t)x;
            for (int k = 0; k < 9 && isinf(own[i]); k++) {
                int u = NOC_CLAMP(x + k % 3 - 1, 0, f->nx - 1), v = NOC_CLAMP(y + k / 3 - 1, 0, f->ny - 1);
                f->street[i] = NOC_MIN(f->street[i], own[(size_t)v * (size_t)f->nx + (size_t)u]);
            }
        }
}

/* Evens out what differs from cell to cell. */
static void smooth(field *f, int rounds) {
    size_t n = (size_t)f->nx * (size_t)f->ny;
    float *old = (float *)f->scratch;
    for (int r = 0; r <= rounds; r++) {
        for (size_t i = 0; i < n; i++)
            old[i] = f->height[i] = NOC_MIN(f->height[i], f->street[i]);
        for (int y = 0; y < f->ny && r < rounds; y++)
            for (int x = 0; x < f->nx; x++) {
                float sum = 0;
                for (int k = 0; k < 9; k++) {
                    static const float kernel[3] = { .25f, .5f, .25f };
                    int u = NOC_CLAMP(x + k % 3 - 1, 0, f->nx - 1), v = NOC_CLAMP(y + k / 3 - 1, 0, f->ny - 1);
                    sum += kernel[k % 3] * kernel[k / 3] * old[(size_t)v * (size_t)f->nx + (size_t)u];
                }
                f->height[(size_t)y * (size_t)f->nx + (size_t)x] = sum;
            }
    }
}

/* The rim of an nx by ny grid of vertices, counter-clockwise. */
static void surround(noc_scene *scene, const double *xyz, int nx, int ny, int material) {
    size_t count = 2 * (size_t)(nx - 1) + 2 * (size_t)(ny - 1), n = 0;
    double *rim = noc_alloc(count * 3 * sizeof(*rim));
    if (!rim) {
        noc_scene_out_of_memory(scene);
        return;
    }
    for (int side = 0; side < 4; side++)
        for (int i = 0; i < (side % 2 ? ny : nx) - 1; i++) {
            int x = side == 0 ? i : side == 1 ? nx - 1 : side == 2 ? nx - 1 - i : 0;
            int y = side == 0 ? 0 : side == 1 ? i : side == 2 ? ny - 1 : ny - 1 - i;
            memcpy(rim + 3 * n++, xyz + 3 * ((size_t)y * (size_t)nx + (size_t)x), 3 * sizeof(*rim));
        }
    city_add_surroundings(scene, rim, count, material);
    free(rim);
}

static void add_mesh(noc_scene *scene, const field *f, double z, bool level) {
    noc_material m = noc_class_material(NOC_CLASS_TERRAIN);
    int nx = level ? 2 : f->nx, ny = level ? 2 : f->ny;
    double *xyz = noc_alloc((size_t)nx * (size_t)ny * 3 * sizeof(*xyz));
    uint32_t *indices = noc_alloc((size_t)(nx - 1) * (size_t)(ny - 1) * 6 * sizeof(*indices));
    size_t v = 0, t = 0;
    if (!xyz || !indices) {
        noc_scene_out_of_memory(scene);
        nx = ny = 0;
    }
    for (int y = 0; y < ny; y++)
        for (int x = 0; x < nx; x++) {
            /* cell centres; the outermost run to the rim */
            double u = x == 0 ? 0 : x == nx - 1 ? f->nx : x + .5, w = y == 0 ? 0 : y == ny - 1 ? f->ny : y + .5;
            xyz[v++] = f->min[0] + u * f->step[0];
            xyz[v++] = f->min[1] + w * f->step[1];
            xyz[v++] = (level ? z : f->height[(size_t)y * (size_t)f->nx + (size_t)x]) - UNDER;
        }
    for (int y = 0; y + 1 < ny; y++)
        for (int x = 0; x + 1 < nx; x++) {
            uint32_t a = (uint32_t)(y * nx + x), b = a + 1, c = a + (uint32_t)nx, d = c + 1;
            uint32_t quad[6] = { a, b, d, a, d, c };
            memcpy(indices + t, quad, sizeof(quad));
            t += 6;
        }
    noc_mesh mesh = { .vertex_count = v / 3,
                      .positions = xyz,
                      .triangle_count = t / 3,
                      .indices = indices,
                      .material = noc_scene_add_material(scene, &m),
                      .name = "ground" };
    if (mesh.material >= 0 && noc_scene_add_mesh(scene, &mesh) >= 0)
        surround(scene, xyz, nx, ny, mesh.material);
    free(xyz);
    free(indices);
}

/* Cells of what is there; the ground is to reach under all of it, and the points. False: no memory. */
static bool make_field(field *f, const noc_scene *scene, const double *points, size_t point_count) {
    double size[2];
    for (int k = 0; k < 2; k++) {
        double lo = scene->bounds_min[k], hi = scene->bounds_max[k];
        for (size_t i = 0; i < point_count; i++) {
            lo = NOC_MIN(lo, points[3 * i + (size_t)k]);
            hi = NOC_MAX(hi, points[3 * i + (size_t)k]);
        }
        double margin = NOC_MAX(60, .1 * (hi - lo));
        f->min[k] = lo - margin;
        size[k] = hi - lo + 2 * margin;
    }
    f->nx = (int)NOC_CLAMP(ceil(size[0] / CELL), 2, MAX_SIDE);
    f->ny = (int)NOC_CLAMP(ceil(size[1] / CELL), 2, MAX_SIDE);
    f->step[0] = size[0] / f->nx;
    f->step[1] = size[1] / f->ny;
    size_t n = (size_t)f->nx * (size_t)f->ny;
    f->height = noc_alloc(n * sizeof(*f->height));
    f->street = noc_alloc(n * sizeof(*f->street));
    f->foot = noc_alloc(n * sizeof(*f->foot));
    f->away = noc_alloc(n * sizeof(*f->away));
    f->fixed = noc_calloc(n, sizeof(*f->fixed));
    f->scratch = noc_alloc(2 * n * sizeof(*f->scratch));
    bool made = f->height && f->street && f->foot && f->away && f->fixed && f->scratch;
    for (size_t i = 0; made && i < n; i++) {
        f->height[i] = f->foot[i] = NAN;
        f->street[i] = INFINITY;
    }
    return made;
}

struct city_ground {
    noc_scene *scene;
    field f;
    bool streets; /* and land tell heights, too */
    bool known;   /* something in the scene tells a height */
    bool level;
    double z; /* of a level one */
    size_t first_mesh;
};

/* Where nothing else tells it: the lowest point, of what begins above the ground the ground below it. */
static double lowest(const noc_scene *scene) {
    double z = INFINITY;
    for (size_t m = 0; m < scene->meshes.len; m++) {
        const noc_scene_mesh *mesh = &scene->meshes.data[m];
        for (size_t v = mesh->first_vertex; v < noc_mesh_end_vertex(scene, m); v++)
            z = NOC_MIN(z, (double)scene->positions.data[3 * v + 2] - (double)mesh->aloft);
    }
    return isfinite(z) ? z : 0;
}

/* Heights from what is known in the cells. False: no memory. */
static bool settle(city_ground *g) {
    field *f = &g->f;
    double lo, hi;
    g->known = drop_outliers(f, &lo, &hi) > 0;
    field_measure(f);
    g->level = !g->known || hi - lo < LEVEL;
    g->z = g->known ? lo : lowest(g->scene);
    if (g->level) {
        for (size_t i = 0; i < (size_t)f->nx * (size_t)f->ny; i++) {
            f->height[i] = (float)g->z;
            f->foot[i] = f->fixed[i] ? (float)g->z : NAN;
        }
        return true;
    }
    raise_to_feet(f, g->scene, g->streets);
    spread_streets(f);
    if (!fill(f))
        return false;
    smooth(f, 6);
    return true;
}

void city_ground_free(city_ground *g) {
    free(g->f.height);
    free(g->f.street);
    free(g->f.foot);
    free(g->f.away);
    free(g->f.fixed);
    free(g->f.scratch);
    free(g);
}

static bool tells(noc_class cls, bool land, bool bases, bool streets) {
    if (!streets)
        return is_base(cls) && !land && (!is_street(cls) || cls == NOC_CLASS_TERRAIN);
    return bases ? is_base(cls) : is_thing(cls);
}

/* By how much the steps are fewer than half a cell asks for, so that those of all triangles together are no more than
 * MOST_POINTS: many large ones lie over one another, or are long and thin. 1 in a city as it is. */
static double share_of_steps(const city_ground *g, bool bases) {
    const noc_scene *scene = g->scene;
    double points = 0;
    EACH_BASE(scene, t)
    if (tells(class_of(scene, t), scene->meshes.data[mesh_].land, bases, g->streets)) {
        double n = steps_of(&g->f, scene, t);
        points += (n + 1) * (n + 2) / 2;
    }
    return points > MOST_POINTS ? sqrt(MOST_POINTS / points) : 1;
}

/* Returns whether there is one that tells a height. */
static bool add_triangles(city_ground *g) {
    const noc_scene *scene = g->scene;
    bool bases = has_bases(scene), any = false;
    double share = share_of_steps(g, bases);
    if (share < 1)
        noc_warn(scene->log,
                 "ground: so many surfaces lie over one another that it is found in steps %.1f times as wide",
                 1 / share);
    EACH_BASE(scene, t) {
        noc_class cls = class_of(scene, t);
        if (!tells(cls, scene->meshes.data[mesh_].land, bases, g->streets))
            continue;
        int n = (int)NOC_MAX(share * steps_of(&g->f, scene, t), 1);
        add_triangle(&g->f, scene, t, n, is_street(cls));
        any = true;
    }
    return any;
}

static city_ground *start(noc_scene *scene, const double *points, size_t count, bool streets) {
    if ((!scene->indices.len && !count) || scene->committed)
        return NULL;
    city_ground *g = noc_calloc(1, sizeof(*g));
    if (!g || !make_field(&g->f, scene, points, count)) {
        noc_scene_out_of_memory(scene);
        if (g)
            city_ground_free(g);
        return NULL;
    }
    g->scene = scene;
    g->streets = streets;
    bool any = add_triangles(g);
    for (size_t i = 0; i < count && !any; i++) /* nothing else tells a height */
        if (isfinite(points[3 * i + 2]))
            lower(&g->f, points[3 * i], points[3 * i + 1], points[3 * i + 2], false);
    if (settle(g))
        return g;
    noc_scene_out_of_memory(scene);
    city_ground_free(g);
    return NULL;
}

city_ground *city_ground_start(noc_scene *scene, const double *points, size_t count) {
    return start(scene, points, count, true);
}

city_ground *city_ground_of_buildings(noc_scene *scene) {
    city_ground *g = start(scene, NULL, 0, false);
    if (!g || g->known)
        return g;
    city_ground_free(g);
    return NULL;
}

double city_ground_height(const city_ground *g, double x, double y, double *distance) {
    *distance = field_distance(&g->f, x, y);
    return field_height(&g->f, x, y);
}

size_t city_ground_points(const city_ground *g) { return g->f.points; }

void city_ground_keep(city_ground *g, size_t first_mesh) { g->first_mesh = first_mesh; }

void city_ground_lay(city_ground *g, const double *points, size_t count) {
    bool off = false;
    for (size_t i = 0; i < count && !off; i++)
        off = isfinite(points[3 * i + 2]) &&
              fabs(points[3 * i + 2] - field_height(&g->f, points[3 * i], points[3 * i + 1])) > LEVEL / 2;
    if (off || !g->level)
        field_follow(&g->f, points, count);
    add_mesh(g->scene, &g->f, g->z, g->level && !off);
    city_add_skirts(g->scene, g->first_mesh);
    city_ground_free(g);
}

void city_add_ground(noc_scene *scene, const double *points, size_t point_count) {
    city_ground *g = city_ground_start(scene, points, point_count);
    if (g)
        city_ground_lay(g, points, point_count);
}
