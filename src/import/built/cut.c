/* The part of a scene that is a tile's. Whose a place is, is decided by it and by the tiles' extents alone, so that
 * tiles which are built one by one have each place once. */
#include "import/built/cut.h"
#include "scene/facade.h"

#include <math.h>

#define SQUARE 8.0 /* m: surfaces are cut along squares of the CRS of that side */

typedef struct rect {
    double lo[2], hi[2]; /* local metres */
} rect;

typedef struct cutter {
    const noc_scene *s;
    const noc_report *report;
    const noc_tile *tile;
    uint8_t *meshes;
    bool *lights, *instances, *streets;
    NOC_ARRAY(rect) own; /* the squares that are the tile's, joined to rectangles */
    NOC_ARRAY(float) xyz;
    NOC_ARRAY(float) uv;
} cutter;

/* ---- whose a place is ---- */

static double outside(const double extent[4], const double p[2]) {
    double x = fmax(fmax(extent[0] - p[0], p[0] - extent[2]), 0), y = fmax(fmax(extent[1] - p[1], p[1] - extent[3]), 0);
    return x * x + y * y;
}

/* p: in the CRS. */
static bool is_own(const noc_tile *tile, const double p[2]) {
    double own = outside(tile->extents[tile->own], p);
    for (size_t i = 0; i < tile->count; i++) {
        double d = outside(tile->extents[i], p);
        if (d < own || (!(d > own) && i < tile->own))
            return false;
    }
    return true;
}

static bool owns(const cutter *c, double x, double y) {
    const double p[2] = { x + c->s->origin[0], y + c->s->origin[1] };
    return is_own(c->tile, p);
}

/* Where the tile's squares from row to row are the same, they are one rectangle. */
static bool add_squares(cutter *c, const long lo[2], const long hi[2]) {
    const double *origin = c->s->origin;
    size_t before = 0, row = 0; /* rectangles that end at the row, from `before` on */
    for (long y = lo[1]; y < hi[1]; y++) {
        row = c->own.len;
        for (long x = lo[0], from = lo[0]; x <= hi[0]; x++) {
            const double p[2] = { ((double)x + .5) * SQUARE, ((double)y + .5) * SQUARE };
            if (x < hi[0] && is_own(c->tile, p))
                continue;
            rect r = { { (double)from * SQUARE - origin[0], (double)y * SQUARE - origin[1] },
                       { (double)x * SQUARE - origin[0], (double)(y + 1) * SQUARE - origin[1] } };
            if (from < x && !array_push(&c->own, r))
                return false;
            from = x + 1;
        }
        bool same = y > lo[1] && c->own.len - row == row - before;
        for (size_t i = row; same && i < c->own.len; i++) {
            const rect *a = &c->own.data[before + (i - row)], *b = &c->own.data[i];
            same = !(a->lo[0] < b->lo[0] || a->lo[0] > b->lo[0] || a->hi[0] < b->hi[0] || a->hi[0] > b->hi[0]);
        }
        for (size_t i = row; same && i < c->own.len; i++)
            c->own.data[before + (i - row)].hi[1] = c->own.data[i].hi[1];
        if (same)
            c->own.len = row;
        else
            before = row;
    }
    return true;
}

static bool find_squares(cutter *c) {
    enum { MOST = 1 << 14 }; /* a side: 131 km */
    long lo[2], hi[2];
    for (int k = 0; k < 2; k++) {
        double a = c->s->bounds_min[k] + c->s->origin[k], b = c->s->bounds_max[k] + c->s->origin[k];
        if (!(a <= b))
            return true;
        lo[k] = (long)floor(a / SQUARE);
        hi[k] = NOC_MIN((long)floor(b / SQUARE) + 1, lo[k] + MOST);
    }
    return add_squares(c, lo, hi);
}

/* ---- meshes ---- */

typedef struct corner {
    double v[5]; /* x, y, z, u, v */
} corner;
enum { MOST_CORNERS = 8 }; /* of a triangle that is cut by four lines: 7 */

/* What of the polygon lies on one side of a line: sign * (x or y) >= sign * at. */
static int clip(const corner *from, int count, int axis, double sign, double at, corner *to) {
    int n = 0;
    for (int i = 0; i < count; i++) {
        const corner *a = &from[i], *b = &from[(i + 1) % count];
        double p = sign * (a->v[axis] - at), q = sign * (b->v[axis] - at);
        if (p >= 0)
            to[n++] = *a;
        if ((p > 0 && q < 0) || (p < 0 && q > 0)) {
            double t = p / (p - q);
            for (int k = 0; k < 5; k++)
                to[n].v[k] = a->v[k] + t * (b->v[k] - a->v[k]);
            to[n++].v[axis] = at;
        }
    }
    return n;
}

static bool push_fan(cutter *c, const corner *p, int count) {
    for (int i = 1; i + 1 < count; i++) {
        const corner *of[3] = { &p[0], &p[i], &p[i + 1] };
        float xyz[9], uv[6];
        for (int k = 0; k < 3; k++) {
            for (int a = 0; a < 3; a++)
                xyz[3 * k + a] = (float)of[k]->v[a];
            for (int a = 0; a < 2; a++)
                uv[2 * k + a] = (float)of[k]->v[3 + a];
        }
        if (!(noc_double_area(xyz, xyz + 3, xyz + 6) > 1e-6)) /* a sliver of the cut */
            continue;
        if (!array_append(&c->xyz, xyz, 9) || !array_append(&c->uv, uv, 6))
            return false;
    }
    return true;
}

static bool cut_triangle(cutter *c, const corner corners[3]) {
    double lo[2], hi[2];
    for (int k = 0; k < 2; k++) {
        lo[k] = fmin(fmin(corners[0].v[k], corners[1].v[k]), corners[2].v[k]);
        hi[k] = fmax(fmax(corners[0].v[k], corners[1].v[k]), corners[2].v[k]);
    }
    for (size_t i = 0; i < c->own.len; i++) {
        const rect *r = &c->own.data[i];
        corner a[MOST_CORNERS], b[MOST_CORNERS];
        bool upright = !(lo[0] < hi[0]) || !(lo[1] < hi[1]); /* along a border: it is of one side */
        if (hi[0] < r->lo[0] || lo[0] > r->hi[0] || hi[1] < r->lo[1] || lo[1] > r->hi[1])
            continue;
        if (upright && !(hi[0] < r->hi[0] || lo[0] < r->lo[0]) && !(lo[0] < hi[0]))
            continue;
        if (upright && !(hi[1] < r->hi[1] || lo[1] < r->lo[1]) && !(lo[1] < hi[1]))
            continue;
        int n = clip(corners, 3, 0, 1, r->lo[0], a);
        n = clip(a, n, 0, -1, r->hi[0], b);
        n = clip(b, n, 1, 1, r->lo[1], a);
        n = clip(a, n, 1, -1, r->hi[1], b);
        if (!push_fan(c, b, n))
            return false;
    }
    return true;
}

/* noc_choice.cut */
static bool cut_mesh(void *ctx, const noc_scene *s, size_t mesh, size_t *count, const float **xyz, const float **uv) {
    cutter *c = ctx;
    const noc_scene_mesh *m = &s->meshes.data[mesh];
    c->xyz.len = c->uv.len = 0;
    for (size_t t = m->first_triangle; t < (size_t)m->first_triangle + m->triangle_count; t++) {
        corner corners[3] = { 0 };
        for (size_t i = 0; i < 3; i++) {
            size_t v = s->indices.data[3 * t + i];
            for (size_t k = 0; k < 3; k++)
                corners[i].v[k] = (double)s->positions.data[3 * v + k];
            for (size_t k = 0; m->uv && k < 2; k++)
                corners[i].v[3 + k] = (double)s->uv.data[2 * (m->uv - 1 + v - m->first_vertex) + k];
        }
        if (!cut_triangle(c, corners))
            return false;
    }
    *count = c->xyz.len / 9;
    *xyz = c->xyz.data;
    *uv = c->uv.data;
    return true;
}

/* By the middle of the meshes between these. */
static uint8_t choose_whole(const cutter *c, size_t from, size_t to) {
    const noc_scene *s = c->s;
    double lo[2] = { INFINITY, INFINITY }, hi[2] = { -INFINITY, -INFINITY };
    for (size_t m = from; m < to; m++)
        for (size_t v = s->meshes.data[m].first_vertex; v < noc_mesh_end_vertex(s, m); v++)
            for (size_t k = 0; k < 2; k++) {
                lo[k] = fmin(lo[k], (double)s->positions.data[3 * v + k]);
                hi[k] = fmax(hi[k], (double)s->positions.data[3 * v + k]);
            }
    return lo[0] <= hi[0] && owns(c, (lo[0] + hi[0]) / 2, (lo[1] + hi[1]) / 2) ? NOC_MESH_TAKE : NOC_MESH_LEAVE;
}

static bool shows_lights(const noc_scene *s, const noc_scene_mesh *m) {
    for (size_t t = m->first_triangle; t < (size_t)m->first_triangle + m->triangle_count; t++)
        if (s->triangle_light.data[t] != NOC_NO_LIGHT || noc_scene_facade_of(s, t))
            return true;
    return false;
}

cut_file built_cut_file(const noc_tile *tile, const char *path) {
    for (size_t i = 0; i < tile->count; i++)
        if (tile->paths[i] && !strcmp(tile->paths[i], path))
            return i == tile->own ? CUT_OWN : CUT_OTHERS;
    return CUT_COMMON;
}

/* A city that is common, or a tile, is cut; what is no city's as a whole. */
static void choose_part(const cutter *c, const report_part *p) {
    const noc_report_file *file = &c->report->files.data[p->file];
    cut_file of = built_cut_file(c->tile, file->path);
    uint8_t whole = p->whole && of == CUT_COMMON ? choose_whole(c, p->from, p->to) : NOC_MESH_CUT;
    for (size_t m = p->first; m < p->end && m < c->s->meshes.len; m++)
        c->meshes[m] = of == CUT_OWN ? NOC_MESH_TAKE : of == CUT_OTHERS ? NOC_MESH_LEAVE : whole;
}

static void choose_meshes(const cutter *c) {
    const noc_scene *s = c->s;
    for (size_t m = 0; m < s->meshes.len; m++)
        c->meshes[m] = NOC_MESH_CUT;
    for (size_t i = 0; i < c->report->parts.len; i++)
        if (!c->report->parts.data[i].whole)
            choose_part(c, &c->report->parts.data[i]);
    for (size_t i = 0; i < c->report->parts.len; i++)
        if (c->report->parts.data[i].whole)
            choose_part(c, &c->report->parts.data[i]);
    for (size_t m = 0; m < s->meshes.len; m++)
        if (c->meshes[m] == NOC_MESH_CUT && !s->meshes.data[m].model && shows_lights(s, &s->meshes.data[m]))
            c->meshes[m] = choose_whole(c, m, m + 1);
}

static void choose_others(const cutter *c) {
    const noc_scene *s = c->s;
    for (size_t i = 0; i < s->lights.len; i++)
        c->lights[i] = owns(c, (double)s->lights.data[i].p[0], (double)s->lights.data[i].p[1]);
    for (size_t i = 0; i < s->bodies.len; i++) {
        const noc_scene_body *b = &s->bodies.data[i];
        for (uint32_t k = 0; k < s->models.data[b->model - 1].shown; k++)
            c->lights[b->light + k] = owns(c, (double)b->p[0], (double)b->p[1]);
    }
    for (size_t i = 0; i < s->instances.len; i++)
        c->instances[i] = owns(c, (double)s->instances.data[i].transform[3], (double)s->instances.data[i].transform[7]);
    for (size_t i = 0; i < s->streets.len; i++) {
        const float *p = s->street_points.data + 2 * (size_t)s->streets.data[i].first;
        c->streets[i] = owns(c, (double)p[0], (double)p[1]);
    }
}

/* Land to the horizon stays around a tile as around the city; where tiles are joined it goes. */
static noc_status add_land(const noc_scene *s, noc_scene *to) {
    for (size_t i = 0; i < s->meshes.len && s->backdrop_count; i++) {
        const noc_scene_mesh *m = &s->meshes.data[i];
        if (m->first_triangle != s->backdrop_first || !m->triangle_count)
            continue;
        size_t vertices = noc_mesh_end_vertex(s, i) - m->first_vertex, corners = 3 * (size_t)m->triangle_count;
        double *xyz = noc_alloc(3 * vertices * sizeof(*xyz));
        uint32_t *indices = noc_alloc(corners * sizeof(*indices));
        for (size_t k = 0; xyz && k < 3 * vertices; k++)
            xyz[k] = (double)s->positions.data[3 * (size_t)m->first_vertex + k];
        for (size_t k = 0; indices && k < corners; k++)
            indices[k] = s->indices.data[3 * (size_t)m->first_triangle + k] - m->first_vertex;
        noc_mesh mesh = { .vertex_count = vertices,
                          .positions = xyz,
                          .triangle_count = m->triangle_count,
                          .indices = indices,
                          .material = xyz && indices ? noc_scene_add_material(to, &s->materials.data[m->material]) : -1,
                          .name = m->name };
        bool added = mesh.material >= 0 && noc_scene_add_backdrop(to, &mesh);
        free(xyz);
        free(indices);
        return added ? NOC_OK : noc_scene_out_of_memory(to);
    }
    return NOC_OK;
}

static noc_status cut(cutter *c, noc_scene *to, bool *taken) {
    const noc_scene *s = c->s;
    c->meshes = noc_calloc(s->meshes.len + 1, sizeof(*c->meshes));
    c->lights = noc_calloc(s->lights.len + 1, sizeof(*c->lights));
    c->instances = noc_calloc(s->instances.len + 1, sizeof(*c->instances));
    c->streets = noc_calloc(s->streets.len + 1, sizeof(*c->streets));
    if (!c->meshes || !c->lights || !c->instances || !c->streets || !find_squares(c) || !built_copy_head(s, to))
        return noc_scene_out_of_memory(to);
    memcpy(to->class_looks, s->class_looks, sizeof(to->class_looks));
    to->class_said = s->class_said;
    choose_meshes(c);
    choose_others(c);
    const noc_choice choice = { c->meshes, c->lights, c->instances, c->streets, cut_mesh, c };
    noc_joiner *j = noc_joiner_create(to);
    noc_status status = j ? NOC_OK : NOC_ERR_MEMORY;
    if (!status)
        status = noc_joiner_add(j, s, (double[3]){ 0 }, &choice, c->tile->paths[c->tile->own],
                                c->tile->paths[c->tile->own], taken);
    status = status ? status : add_land(s, to);
    status = status ? status : noc_joiner_finish(j);
    noc_joiner_destroy(j);
    return status;
}

noc_status built_cut(const noc_scene *s, const noc_report *report, const noc_tile *tile, noc_scene **out,
                     noc_report **told) {
    cutter c = { .s = s, .report = report, .tile = tile };
    bool *taken = noc_calloc(s->windows.len + 1, sizeof(*taken));
    noc_scene *to = *out = noc_scene_create(s->log);
    *told = NULL;
    noc_status status = !to ? NOC_ERR_MEMORY : taken ? cut(&c, to, taken) : noc_scene_out_of_memory(to);
    if (!status && !(*told = built_cut_report(to, s, report, tile, taken, c.lights)))
        status = noc_scene_out_of_memory(to);
    if (!status && s->environment) { /* it is made anew where it is read */
        to->environment = s->environment;
    }
    free(taken);
    free(c.meshes);
    free(c.lights);
    free(c.instances);
    free(c.streets);
    array_free(&c.own);
    array_free(&c.xyz);
    array_free(&c.uv);
    return status;
}

void built_cut_free(noc_scene *cut, noc_report *told) {
    if (cut)
        cut->environment = NULL; /* it is the whole scene's */
    noc_scene_destroy(cut);
    noc_report_destroy(told);
}
