/* Windows on the walls of the buildings that were taken: made ones, or those of the model. Those of some buildings at a
 * time are found on all threads, and taken in the buildings' order. */
#include "import/lamps/conditions.h"
#include "import/load/load.h"
#include "city/windows/windows.h"
#include "scene/facade.h"

#include <math.h>

typedef NOC_ARRAY(wall_triangle) wall_triangles;

/* Once, whoever met it: the scene tells what it refuses itself. */
static noc_status no_memory(const importer *im) {
    return im->scene->no_memory ? NOC_ERR_MEMORY : noc_no_memory(im->log, "windows");
}

enum { AT_ONCE = 256 }; /* buildings that are found before they are taken */

/* What windows may cost, so that a small file does not take minutes: windows that walls have room for, beside so many a
 * byte of the inputs, and looks at walls that may hide them, beside so many a triangle of walls. The blocks of
 * bench/blocks.py have .13 windows a byte and take 2,700 looks a triangle; seven cities of CityGML have at most .11 and
 * take 3 to 270. */
#define MOST_WINDOWS 1e6
#define WINDOWS_A_BYTE 1.0
#define MOST_LOOKS 1e8 /* a second */
#define LOOKS_A_TRIANGLE 8000.0

/* Windows that a mesh of a building is itself. */
typedef struct own_mesh {
    size_t mesh;
    city_own_windows windows;
} own_mesh;

/* What was found of a building. */
typedef struct found_building {
    bool own; /* it has windows of its own, and gets no others */
    bool no_memory;
    NOC_ARRAY(own_mesh) meshes;
    city_windows made;
} found_building;

/* Of a thread. */
typedef struct scratch {
    wall_triangles walls, panes;
} scratch;

typedef struct maker {
    importer *im;
    const noc_window_params *params;
    int group;    /* of the windows of the building that is taken */
    size_t input; /* its file */
    city_cover *cover;
    noc_pool *pool;
    NOC_ARRAY(double) area;      /* of the buildings' walls, m2 */
    double all_area;             /* of those that may have windows */
    double most_looks;           /* before all of these */
    size_t begin_without;        /* the first building that may have none, and all behind it */
    size_t crowded;              /* facades whose windows were too costly */
    scratch *scratch;            /* [threads] */
    found_building *found;       /* [AT_ONCE] */
    size_t first;                /* of the buildings that found[0] is */
    NOC_ARRAY(uint32_t) numbers; /* + 1, in the scene, of the facades of the building that is taken; 0: it has none */
    city_window_list before;     /* its windows that stand before walls */
    NOC_ARRAY(double) xyz;
    NOC_ARRAY(uint32_t) indices;
} maker;

static noc_class class_of(const noc_scene *s, size_t mesh) {
    return s->materials.data[s->meshes.data[mesh].material].cls;
}

static bool has_class(const importer *im, const taken_building *b, noc_class cls) {
    for (size_t i = b->first; i < b->end; i++)
        if (class_of(im->scene, i) == cls && im->scene->meshes.data[i].triangle_count)
            return true;
    return false;
}

/* Walls by class; in a building without classes what is steep is one, which slopes tell. */
static noc_class wall_class(const importer *im, const taken_building *b) {
    return has_class(im, b, NOC_CLASS_WALL) ? NOC_CLASS_WALL : NOC_CLASS_OTHER;
}

static const float *corner(const noc_scene *s, size_t triangle, int i) {
    return s->positions.data + 3 * (size_t)s->indices.data[3 * triangle + (size_t)i];
}

static void cross_edges(const wall_triangle *t, double n[3]) {
    double a[3], b[3];
    for (int k = 0; k < 3; k++) {
        a[k] = t->p[1][k] - t->p[0][k];
        b[k] = t->p[2][k] - t->p[0][k];
    }
    for (int k = 0; k < 3; k++)
        n[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

/* Of a building without classes: does it lean no more than a wall may? */
static bool is_steep(const wall_triangle *t, double tilt) {
    double n[3];
    cross_edges(t, n);
    return fabs(n[2]) <= sin(tilt * M_PI / 180) * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}

static wall_triangle triangle_of(const noc_scene *s, size_t t) {
    wall_triangle w;
    for (int k = 0; k < 9; k++)
        w.p[k / 3][k % 3] = (double)corner(s, t, k / 3)[k % 3];
    return w;
}

static bool is_wall(const maker *m, noc_class cls, const wall_triangle *w) {
    return cls != NOC_CLASS_OTHER || is_steep(w, m->params->tilt);
}

static bool gather(const maker *m, size_t first, size_t end, noc_class cls, wall_triangles *out) {
    const noc_scene *s = m->im->scene;
    out->len = 0;
    for (size_t i = first; i < end; i++) {
        const noc_scene_mesh *mesh = &s->meshes.data[i];
        if (class_of(s, i) != cls)
            continue;
        for (size_t t = mesh->first_triangle; t < (size_t)mesh->first_triangle + mesh->triangle_count; t++) {
            wall_triangle w = triangle_of(s, t);
            if (is_wall(m, cls, &w) && !array_push(out, w))
                return false;
        }
    }
    return true;
}

/* How many buildings, in their order, may have windows, and what is spent on them. */
static void limit(maker *m, size_t triangles) {
    const noc_window_params *p = m->params;
    double most = MOST_WINDOWS, windows = 0;
    for (size_t i = 0; i < m->im->input_count; i++)
        most += WINDOWS_A_BYTE * (double)NOC_MAX(m->im->inputs[i].bytes, m->im->inputs[i].file.bytes_read);
    m->most_looks = MOST_LOOKS + LOOKS_A_TRIANGLE * (double)triangles;
    for (m->begin_without = 0; m->begin_without < m->area.len; m->begin_without++) {
        windows += m->area.data[m->begin_without] / (p->cell * p->storey_height);
        if (windows > most)
            break;
        m->all_area += m->area.data[m->begin_without];
    }
    if (m->begin_without < m->area.len)
        noc_warn(m->im->log,
                 "%s: %zu of %zu buildings have no windows: walls have room for over %.3g million, which is too many "
                 "for files of %.3g MB; --windows off leaves all out",
                 m->im->inputs[m->im->buildings.data[m->begin_without].input].path, m->area.len - m->begin_without,
                 m->area.len, most / 1e6, (most - MOST_WINDOWS) / WINDOWS_A_BYTE / 1e6);
}

/* At walls before the windows of a building: each has as many a square metre of its own. */
static size_t looks_of(const maker *m, size_t building) {
    if (building >= m->begin_without)
        return 0;
    return (size_t)(m->most_looks * m->area.data[building] / NOC_MAX(m->all_area, 1)) + 1;
}

static double area_of(const wall_triangles *walls) {
    double sum = 0, n[3];
    for (size_t t = 0; t < walls->len; t++) {
        cross_edges(&walls->data[t], n);
        sum += sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) / 2;
    }
    return sum;
}

/* Walls of all buildings, which may stand before windows. */
static noc_status make_cover(maker *m) {
    importer *im = m->im;
    NOC_ARRAY(float) xyz = { 0 };
    bool ok = array_reserve(&m->area, im->buildings.len);
    for (size_t i = 0; ok && i < im->buildings.len; i++) {
        const taken_building *b = &im->buildings.data[i];
        const wall_triangles *walls = &m->scratch->walls;
        ok = gather(m, b->first, b->end, wall_class(im, b), &m->scratch->walls);
        for (size_t t = 0; ok && t < walls->len; t++)
            for (int k = 0; ok && k < 9; k++)
                ok = array_push(&xyz, (float)walls->data[t].p[k / 3][k % 3]);
        m->area.data[m->area.len++] = ok && !has_class(im, b, NOC_CLASS_WINDOW) ? area_of(walls) : 0;
    }
    if (ok)
        limit(m, xyz.len / 9);
    m->cover = ok ? city_cover_create(xyz.data, xyz.len / 9, im->inspect ? NULL : im->scene) : NULL;
    array_free(&xyz);
    return m->cover ? NOC_OK : no_memory(im);
}

/* Is it lit in the beginning? */
static bool is_lit(const maker *m, const city_window *w) {
    return noc_window_level(w->level, m->params->seed) <
           noc_window_share(w->kind, m->params->lit_windows, m->params->hour);
}

static const char *id_of(const importer *im, const taken_building *b) {
    const char *name = im->scene->meshes.data[b->first].name;
    return name ? name : "";
}

static noc_pane pane_of(const maker *m, const city_window *w, noc_light_kind kind) {
    noc_pane pane = { .shape = { .kind = kind, .group = m->group },
                      .window = { .level = w->level, .kind = (unsigned char)w->kind, .often = NOC_WINDOW_OFTEN } };
    memcpy(pane.shape.position, w->corner, sizeof(w->corner));
    memcpy(pane.shape.edge_u, w->edge_u, sizeof(w->edge_u));
    memcpy(pane.shape.edge_v, w->edge_v, sizeof(w->edge_v));
    memcpy(pane.window.emission, w->emission, sizeof(w->emission));
    return pane;
}

/* counts: as a window, and is no further pane of one. */
static bool add_pane(const maker *m, int mesh, const noc_pane *pane, bool counts) {
    if (!report_pane(m->im->report, m->input, counts)) {
        noc_scene_out_of_memory(m->im->scene);
        return false;
    }
    return noc_scene_add_window(m->im->scene, mesh, pane);
}

/* Those windows of a building that stand before its walls are one mesh. */
static noc_status add_mesh(maker *m, const char *id, int material, const city_window_list *list) {
    importer *im = m->im;
    m->xyz.len = m->indices.len = 0;
    if (!list->len)
        return NOC_OK;
    if (!array_reserve(&m->xyz, 12 * list->len) || !array_reserve(&m->indices, 6 * list->len))
        return no_memory(im);
    for (size_t i = 0; i < list->len; i++) {
        const city_window *w = &list->data[i];
        for (uint32_t j = 0; j < 6; j++)
            m->indices.data[m->indices.len++] = 4 * (uint32_t)i + (const uint32_t[]){ 0, 1, 2, 0, 2, 3 }[j];
        for (int j = 0; j < 4; j++)
            for (int k = 0; k < 3; k++)
                m->xyz.data[m->xyz.len++] =
                    w->corner[k] + (j == 1 || j == 2 ? w->edge_u[k] : 0) + (j > 1 ? w->edge_v[k] : 0);
    }
    noc_mesh mesh = { .vertex_count = 4 * list->len,
                      .positions = m->xyz.data,
                      .triangle_count = 2 * list->len,
                      .indices = m->indices.data,
                      .material = material,
                      .name = *id ? id : NULL };
    int index = noc_scene_add_mesh(im->scene, &mesh);
    if (index < 0)
        return NOC_ERR_UNSUPPORTED; /* said by the scene */
    for (size_t i = 0; i < list->len; i++) {
        const uint32_t both[2] = { 2 * (uint32_t)i, 2 * (uint32_t)i + 1 };
        noc_pane pane = pane_of(m, &list->data[i], NOC_LIGHT_PARALLELOGRAM);
        pane.triangles = both;
        pane.triangle_count = 2;
        if (!add_pane(m, index, &pane, true))
            return NOC_ERR_MEMORY;
    }
    return NOC_OK;
}

/* ---- windows in walls ---- */

/* The window where it belongs in its flat wall. */
static city_window put_back(const city_window *w) {
    city_window in = *w;
    double n[3], length = 0;
    for (int k = 0; k < 3; k++) {
        n[k] = w->edge_u[(k + 1) % 3] * w->edge_v[(k + 2) % 3] - w->edge_u[(k + 2) % 3] * w->edge_v[(k + 1) % 3];
        length += n[k] * n[k];
    }
    for (int k = 0; k < 3; k++)
        in.corner[k] -= w->back / sqrt(length) * n[k];
    return in;
}

/* Rays that pass a wall know nothing of windows in it. */
static bool passes_walls(const importer *im, const taken_building *b) {
    bool any = false;
    for (size_t i = b->first; i < b->end; i++)
        any = any || noc_mesh_lets_through(im->scene, &im->scene->meshes.data[i]);
    return any;
}

/* A grid has at most so many cells beside so many a window: walls of odd outlines lie in wide ones. */
#define LEAST_CELLS 256.0
#define CELLS_A_WINDOW 16.0

/* The facade's number in the scene, + 1, in *number; 0: its windows stand before it. mesh: of its walls. */
static noc_status add_facade(const maker *m, const city_facade *f, int material, int mesh, uint32_t *number) {
    *number = 0;
    if (!f->windows || !f->columns || (double)f->columns * f->rows > LEAST_CELLS + CELLS_A_WINDOW * (double)f->windows)
        return NOC_OK;
    noc_facade facade = { .columns = f->columns, .rows = f->rows, .material = material, .mesh = mesh };
    memcpy(facade.origin, f->origin, sizeof(f->origin));
    memcpy(facade.along, f->along, sizeof(f->along));
    memcpy(facade.up, f->up, sizeof(f->up));
    *number = noc_scene_add_facade(m->im->scene, &facade);
    return *number ? NOC_OK : NOC_ERR_MEMORY;
}

/* Takes what windows lie in their walls; the others come into m->before. */
static noc_status add_in_walls(maker *m, const taken_building *b, const city_windows *made, int material) {
    noc_scene *s = m->im->scene;
    size_t first_wall = b->first;
    bool none = passes_walls(m->im, b);
    noc_class cls = wall_class(m->im, b);
    while (class_of(s, first_wall) != cls)
        first_wall++;
    m->before.len = m->numbers.len = 0;
    if (!array_reserve(&m->numbers, made->facades.len))
        return no_memory(m->im);
    for (size_t i = 0; i < made->facades.len; i++) {
        uint32_t number = 0;
        noc_status status = none ? NOC_OK : add_facade(m, &made->facades.data[i], material, (int)first_wall, &number);
        if (status)
            return status;
        m->numbers.data[m->numbers.len++] = number;
    }
    for (size_t i = 0; i < made->list.len; i++) {
        const city_window *w = &made->list.data[i];
        const city_window in = put_back(w);
        noc_pane pane = pane_of(m, &in, NOC_LIGHT_PARALLELOGRAM);
        pane.window.facade = m->numbers.data[w->facade];
        bool ok = pane.window.facade && noc_scene_facade_takes(s, pane.window.facade, &pane.shape)
                      ? add_pane(m, (int)first_wall, &pane, true)
                      : array_push(&m->before, *w);
        if (!ok)
            return no_memory(m->im);
    }
    return NOC_OK;
}

static noc_status add_windows(maker *m, const taken_building *b, const city_windows *made) {
    int material = take_material(m->im, NOC_CLASS_WINDOW, id_of(m->im, b));
    if (material < 0)
        return NOC_ERR_UNSUPPORTED; /* said by the scene */
    noc_status status = add_in_walls(m, b, made, material);
    return status ? status : add_mesh(m, id_of(m->im, b), material, &m->before);
}

/* Those of the model shine themselves, where they are. */
static noc_status take_own(maker *m, const own_mesh *o, noc_window_counts *counts) {
    const city_own_windows *own = &o->windows;
    for (size_t i = 0; i < own->panes.len; i++) {
        const city_own_pane *p = &own->panes.data[i];
        counts->windows += p->leads;
        counts->own += p->leads;
        counts->lit += p->leads && is_lit(m, &p->window);
        noc_pane pane = pane_of(m, &p->window, p->whole ? NOC_LIGHT_PARALLELOGRAM : NOC_LIGHT_TRIANGLE);
        pane.triangles = own->triangles.data + p->first;
        pane.triangle_count = p->count;
        pane.window.part = p->part;
        if (!add_pane(m, (int)o->mesh, &pane, p->leads))
            return NOC_ERR_MEMORY;
    }
    return NOC_OK;
}

static void count_walls(const maker *m, const found_building *found, noc_window_counts *counts) {
    for (size_t i = 0; i < found->made.facades.len; i++) {
        const city_facade *f = &found->made.facades.data[i];
        noc_wall_verdict verdict = found->own ? NOC_WALL_OWN : f->verdict;
        counts->walls[verdict]++;
        counts->area[verdict] += f->area;
    }
    for (size_t i = 0; !found->own && i < found->made.list.len; i++) {
        counts->windows++;
        counts->lit += is_lit(m, &found->made.list.data[i]);
    }
}

/* Of the triangles that were gathered, in that order. numbers: facades in the scene, NULL: no window is in a wall. */
static void keep_verdicts(const maker *m, const taken_building *b, const found_building *found,
                          const uint32_t *numbers) {
    noc_scene *s = m->im->scene;
    noc_class cls = wall_class(m->im, b);
    size_t n = 0;
    for (size_t i = b->first; i < b->end; i++) {
        const noc_scene_mesh *mesh = &s->meshes.data[i];
        for (size_t t = mesh->first_triangle;
             class_of(s, i) == cls && t < (size_t)mesh->first_triangle + mesh->triangle_count; t++) {
            wall_triangle w = triangle_of(s, t);
            if (!is_wall(m, cls, &w))
                continue;
            uint32_t of = found->made.of.data[n];
            if (numbers && of != CITY_NO_FACADE)
                s->triangle_facade.data[t] = numbers[of];
            s->walls.data[t] = found->own ? NOC_WALL_OWN : found->made.verdicts.data[n];
            n++;
        }
    }
}

/* Those of a mesh of the building itself. false: memory was refused. */
static bool find_own(const maker *m, scratch *at, size_t mesh, const taken_building *b, found_building *found) {
    if (!gather(m, mesh, mesh + 1, NOC_CLASS_WINDOW, &at->panes) || !array_push(&found->meshes, (own_mesh){ mesh }))
        return false;
    return city_own_windows_find(id_of(m->im, b), b->use, at->panes.data, at->panes.len, at->walls.data, at->walls.len,
                                 m->params, &found->meshes.data[found->meshes.len - 1].windows) == NOC_OK;
}

/* On any thread: it reads the scene, and writes what is its own. */
static void find_building(void *ctx, size_t item, int worker) {
    const maker *m = ctx;
    const taken_building *b = &m->im->buildings.data[m->first + item];
    found_building *found = &m->found[item];
    scratch *at = &m->scratch[worker];
    bool ok = gather(m, b->first, b->end, wall_class(m->im, b), &at->walls);
    found->own = has_class(m->im, b, NOC_CLASS_WINDOW);
    for (size_t i = b->first; ok && found->own && i < b->end; i++)
        ok = class_of(m->im->scene, i) != NOC_CLASS_WINDOW || find_own(m, at, i, b, found);
    /* walls of a building that has its own windows are counted, and no more */
    ok = ok && !city_windows_make(id_of(m->im, b), b->use, at->walls.data, at->walls.len, m->params,
                                  found->own ? NULL : m->cover, found->own ? SIZE_MAX : looks_of(m, m->first + item),
                                  &found->made);
    found->no_memory = !ok;
}

static noc_status take_building(maker *m, const taken_building *b, found_building *found) {
    input *in = &m->im->inputs[b->input];
    noc_window_counts *counts = &in->file.windows;
    m->group = luminaires_group(m->im, &(lamp_subject){ .cls = "window", .file = in->path });
    m->input = b->input;
    noc_status status = found->no_memory ? no_memory(m->im) : NOC_OK;
    for (size_t i = 0; i < found->meshes.len && !status; i++)
        status = take_own(m, &found->meshes.data[i], counts);
    if (status)
        return status;
    counts->buildings[b->use]++;
    m->crowded += found->own || b >= &m->im->buildings.data[m->begin_without] ? 0 : found->made.crowded;
    count_walls(m, found, counts);
    bool windows = !found->own && found->made.list.len;
    size_t meshes = m->im->scene->meshes.len;
    status = windows ? add_windows(m, b, &found->made) : NOC_OK;
    if (!status)
        keep_verdicts(m, b, found, windows ? m->numbers.data : NULL);
    report_part part = { (uint32_t)meshes,   (uint32_t)m->im->scene->meshes.len,
                         (uint32_t)b->input, true,
                         b->first,           b->end };
    bool kept = part.first == part.end || array_push(&m->im->report->parts, part);
    return status || kept ? status : no_memory(m->im);
}

static void forget_own(found_building *found) {
    for (size_t i = 0; i < found->meshes.len; i++)
        city_own_windows_free(&found->meshes.data[i].windows);
    found->meshes.len = 0;
}

noc_status windows_check(const noc_import_params *params, noc_log *log) {
    const noc_window_params *p = &params->window;
    if (p->width > p->cell)
        return noc_error(log, NOC_ERR_ARGUMENT, "import: windows %g m wide do not fit into cells of %g m", p->width,
                         p->cell);
    if (p->height > p->storey_height)
        return noc_error(log, NOC_ERR_ARGUMENT, "import: windows %g m high do not fit into storeys of %g m", p->height,
                         p->storey_height);
    return NOC_OK;
}

/* Some buildings. The ground is made ready first, so that no thread finds it wanting. */
static noc_status add_some(maker *m, size_t count) {
    importer *im = m->im;
    if (!im->inspect && noc_ground_ready(im->scene))
        return NOC_ERR_MEMORY;
    noc_pool_run(m->pool, count, find_building, m);
    noc_status status = NOC_OK;
    for (size_t i = 0; i < count; i++) {
        if (!status)
            status = take_building(m, &im->buildings.data[m->first + i], &m->found[i]);
        forget_own(&m->found[i]);
    }
    return status;
}

static noc_status add_all(maker *m) {
    importer *im = m->im;
    const noc_progress *progress = &im->params->progress;
    size_t buildings = im->buildings.len;
    noc_status status = NOC_OK;
    for (m->first = 0; m->first < buildings && !status; m->first += AT_ONCE) {
        status = add_some(m, NOC_MIN(buildings - m->first, (size_t)AT_ONCE));
        if (status)
            break;
        if (progress->update && !progress->update(progress->user, "windows",
                                                  import_done(im, DONE_WINDOWS, (double)m->first / (double)buildings)))
            return NOC_ERR_CANCELLED;
        status = take_affords(im, &im->inputs[im->buildings.data[m->first].input], 0);
    }
    return status;
}

/* What it works with; false: memory was refused. */
static bool equip(maker *m) {
    m->pool = noc_pool_create((int)import_threads(m->im->params, m->im->buildings.len));
    m->scratch = m->pool ? noc_calloc((size_t)noc_pool_threads(m->pool), sizeof(*m->scratch)) : NULL;
    m->found = noc_calloc(AT_ONCE, sizeof(*m->found));
    return m->scratch && m->found;
}

static void put_away(maker *m) {
    for (int i = 0; m->scratch && i < noc_pool_threads(m->pool); i++) {
        array_free(&m->scratch[i].walls);
        array_free(&m->scratch[i].panes);
    }
    for (int i = 0; m->found && i < AT_ONCE; i++) {
        array_free(&m->found[i].meshes);
        city_windows_free(&m->found[i].made);
    }
    free(m->scratch);
    free(m->found);
    if (m->pool)
        noc_pool_destroy(m->pool);
    city_cover_destroy(m->cover);
    array_free(&m->numbers);
    array_free(&m->before);
    array_free(&m->xyz);
    array_free(&m->area);
    array_free(&m->indices);
}

noc_status windows_add(importer *im) {
    maker m = { .im = im, .params = &im->params->window };
    if (im->scene->no_memory)
        return NOC_ERR_MEMORY;
    if (!im->buildings.len)
        return NOC_OK;
    noc_status status = equip(&m) ? NOC_OK : no_memory(im);
    if (!status)
        status = noc_scene_reserve_walls(im->scene) ? make_cover(&m) : NOC_ERR_MEMORY;
    status = status ? status : add_all(&m);
    if (!status && m.crowded)
        noc_warn(im->log,
                 "windows: %zu facades have none, or not all: so many walls stand close to one another that finding "
                 "what hides them would take too long",
                 m.crowded);
    noc_scene_light_windows(im->scene, m.params);
    put_away(&m);
    return status;
}

noc_status windows_of_builtin(importer *im, input *in, size_t first) {
    noc_scene *s = im->scene;
    noc_scene_light_windows(s, &im->params->window);
    for (size_t i = first; i < s->windows.len; i++) {
        const float *e = s->lights.data[s->windows.data[i].light].e;
        in->file.windows.windows++;
        in->file.windows.lit += e[0] > 0 || e[1] > 0 || e[2] > 0;
        if (!report_pane(im->report, (size_t)(in - im->inputs), true))
            return noc_scene_out_of_memory(s);
    }
    return NOC_OK;
}
