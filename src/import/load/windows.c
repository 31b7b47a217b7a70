/* Windows on the walls of the buildings that were taken: made ones, or those of the model. */
#include "import/load/load.h"
#include "city/windows/windows.h"

#include <math.h>

typedef struct maker {
    importer *im;
    const noc_window_params *params;
    city_cover *cover;
    NOC_ARRAY(wall_triangle) walls;
    city_windows windows;
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

/* Of a building without classes: does it lean no more than a wall may? */
static bool is_steep(const wall_triangle *t, double tilt) {
    double a[3], b[3], n[3];
    for (int k = 0; k < 3; k++) {
        a[k] = t->p[1][k] - t->p[0][k];
        b[k] = t->p[2][k] - t->p[0][k];
    }
    for (int k = 0; k < 3; k++)
        n[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
    return fabs(n[2]) <= sin(tilt * M_PI / 180) * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}

static bool gather(maker *m, const taken_building *b, noc_class cls) {
    const noc_scene *s = m->im->scene;
    m->walls.len = 0;
    for (size_t i = b->first; i < b->end; i++) {
        const noc_scene_mesh *mesh = &s->meshes.data[i];
        if (class_of(s, i) != cls)
            continue;
        for (size_t t = mesh->first_triangle; t < (size_t)mesh->first_triangle + mesh->triangle_count; t++) {
            wall_triangle w;
            for (int k = 0; k < 9; k++)
                w.p[k / 3][k % 3] = (double)corner(s, t, k / 3)[k % 3];
            if ((cls != NOC_CLASS_OTHER || is_steep(&w, m->params->tilt)) && !array_push(&m->walls, w))
                return false;
        }
    }
    return true;
}

/* Walls of all buildings, which may stand before windows. */
static noc_status make_cover(maker *m) {
    importer *im = m->im;
    NOC_ARRAY(float) xyz = { 0 };
    bool ok = true;
    for (size_t i = 0; ok && i < im->buildings.len; i++) {
        ok = gather(m, &im->buildings.data[i], wall_class(im, &im->buildings.data[i]));
        for (size_t t = 0; ok && t < m->walls.len; t++)
            for (int k = 0; ok && k < 9; k++)
                ok = array_push(&xyz, (float)m->walls.data[t].p[k / 3][k % 3]);
    }
    m->cover = ok ? city_cover_create(xyz.data, xyz.len / 9) : NULL;
    array_free(&xyz);
    return m->cover ? NOC_OK : noc_no_memory(im->log, "windows");
}

/* All windows of a building are one mesh. */
static noc_status add_mesh(maker *m, const char *id) {
    importer *im = m->im;
    const city_window_list *list = &m->windows.list;
    m->xyz.len = m->indices.len = 0;
    if (!array_reserve(&m->xyz, 12 * list->len) || !array_reserve(&m->indices, 6 * list->len))
        return noc_no_memory(im->log, "windows");
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
                      .material = take_material(im, NOC_CLASS_WINDOW, id),
                      .name = *id ? id : NULL };
    int index = mesh.material < 0 ? -1 : noc_scene_add_mesh(im->scene, &mesh);
    if (index < 0)
        return NOC_ERR_UNSUPPORTED; /* said by the scene */
    for (size_t i = 0; i < list->len; i++) {
        const city_window *w = &list->data[i];
        noc_pane pane = { .first_triangle = 2 * (uint32_t)i,
                          .triangle_count = 2,
                          .shape = { .kind = NOC_LIGHT_PARALLELOGRAM },
                          .window = { .level = w->level, .kind = (unsigned char)w->kind } };
        memcpy(pane.shape.position, w->corner, sizeof(w->corner));
        memcpy(pane.shape.edge_u, w->edge_u, sizeof(w->edge_u));
        memcpy(pane.shape.edge_v, w->edge_v, sizeof(w->edge_v));
        memcpy(pane.window.emission, w->emission, sizeof(w->emission));
        if (!noc_scene_add_window(im->scene, index, &pane))
            return NOC_ERR_MEMORY;
    }
    return NOC_OK;
}

static noc_status add_building(maker *m, const taken_building *b) {
    const char *name = m->im->scene->meshes.data[b->first].name, *id = name ? name : "";
    if (has_class(m->im, b, NOC_CLASS_WINDOW))
        return NOC_OK; /* it has windows of its own */
    if (!gather(m, b, wall_class(m->im, b)))
        return noc_no_memory(m->im->log, "windows");
    if (city_windows_make(id, m->walls.data, m->walls.len, m->params, m->cover, &m->windows))
        return noc_no_memory(m->im->log, "windows");
    return m->windows.list.len ? add_mesh(m, id) : NOC_OK;
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

static noc_status add_all(maker *m) {
    importer *im = m->im;
    const noc_progress *progress = &im->params->progress;
    noc_status status = NOC_OK;
    for (size_t i = 0; i < im->buildings.len && !status; i++) {
        status = add_building(m, &im->buildings.data[i]);
        if (status || i % 64)
            continue;
        if (progress->update && !progress->update(progress->user, "windows", (double)i / (double)im->buildings.len))
            return NOC_ERR_CANCELLED;
        status = take_affords(im, &im->inputs[im->buildings.data[i].input], 0);
    }
    return status;
}

noc_status windows_add(importer *im) {
    maker m = { .im = im, .params = &im->params->window };
    if (!im->buildings.len)
        return NOC_OK;
    noc_status status = make_cover(&m);
    status = status ? status : add_all(&m);
    noc_scene_light_windows(im->scene, m.params);
    city_cover_destroy(m.cover);
    city_windows_free(&m.windows);
    array_free(&m.walls);
    array_free(&m.xyz);
    array_free(&m.indices);
    return status;
}
