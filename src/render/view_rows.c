/* The last complete frame alone, as planes of rows: for the smoother. */
#include "render/frame_views.h"

#include "core/texel.h"

#include <math.h>

struct rows_run {
    const noc_views *v;
    const noc_frame_blocks *b;
    const frame_camera *from;
    const noc_frame_rows *rows;
};

/* What a surface mirrors of light from everywhere at least is its f0. Nothing is black, so that all can be divided by
 * it. */
static v3 reflects(const noc_scene *scene, const gblock *g, int l) {
    static const float least = 0.01f;
    const noc_material_record *m = &scene->material_records.data[g->material[l]];
    v3 albedo = g->texel[l] ? texel_albedo(g->texel[l]) : V3(m->albedo[0], m->albedo[1], m->albedo[2]);
    return V3(fmaxf(albedo.x + m->f0, least), fmaxf(albedo.y + m->f0, least), fmaxf(albedo.z + m->f0, least));
}

/* Neighbours that differ in it are not of one surface; two in sixteen million that differ have the same. */
static uint32_t surface_of(const noc_scene *scene, const gblock *g, int l, uint32_t instance) {
    const noc_material_record *m = &scene->material_records.data[g->material[l]];
    uint32_t alpha = m->f0 > 0 ? (uint32_t)(m->alpha * (NOC_ROW_MATTE - 1)) : NOC_ROW_MATTE;
    uint32_t number = (instance * 0x9e3779b9u ^ (uint32_t)g->material[l]) * 0x85ebca6bu;
    return alpha << NOC_ROW_ALPHA | (number >> (32 - NOC_ROW_ALPHA) & ~3u);
}

static void store(float *const to[3], size_t i, v3 v) {
    if (!to[0])
        return;
    to[0][i] = v.x;
    to[1][i] = v.y;
    to[2][i] = v.z;
}

static void pixel(const struct rows_run *run, size_t at, int l, size_t to) {
    const noc_frame_blocks *b = run->b;
    const noc_frame_rows *out = run->rows;
    const gblock *g = &b->g[at];
    const cblock *c = &b->colour[at];
    bool some = g->material[l] != NO_SURFACE;
    const float *eye = run->from->eye, *sight = run->from->forward;
    store(out->rgb, to, V3(c->rgb[0][l], c->rgb[1][l], c->rgb[2][l]));
    if (out->motion[0]) {
        float(*motion)[BLOCK] = &run->v->kept[NOC_AOV_MOTION][3 * at];
        store(out->motion, to, V3(motion[0][l], motion[1][l], motion[2][l]));
    }
    store(out->normal, to, some ? V3(g->nx[l], g->ny[l], g->nz[l]) : V3(0, 0, 0));
    store(out->reflects, to, some ? reflects(b->scene, g, l) : V3(1, 1, 1));
    out->depth[to] =
        !some ? 0 : (g->px[l] - eye[0]) * sight[0] + (g->py[l] - eye[1]) * sight[1] + (g->pz[l] - eye[2]) * sight[2];
    noc_row_kind kind = !some ? NOC_ROW_NOTHING : g->light[l] != NO_LIGHT ? NOC_ROW_EMITTER : NOC_ROW_SURFACE;
    uint32_t instance = some && b->instance ? b->instance[at][l] + 1 : 0; /* of none it is UINT32_MAX */
    out->what[to] = (uint32_t)kind | (some ? surface_of(b->scene, g, l, instance) : 0);
}

static void block_row(void *arg, size_t row, int index) {
    const struct rows_run *run = arg;
    const noc_frame_blocks *b = run->b;
    (void)index;
    for (int y = (int)row * BLOCK_SIDE; y < NOC_MIN((int)(row + 1) * BLOCK_SIDE, b->height); y++)
        for (int x = 0; x < b->width; x++)
            pixel(run, row * (size_t)b->blocks_x + (size_t)(x / BLOCK_SIDE), (y & 3) * 4 + (x & 3),
                  (size_t)y * (size_t)b->width + (size_t)x);
}

void noc_views_rows(const noc_views *v, const noc_frame_blocks *b, const frame_camera *camera,
                    const noc_frame_rows *rows) {
    struct rows_run run = { v, b, camera, rows };
    noc_pool_run(b->pool, (size_t)b->blocks_y, block_row, &run);
}
