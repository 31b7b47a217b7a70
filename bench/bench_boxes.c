/* Visibility-aware boxes of influence volumes: what they cost, cut away, and lose.
 *
 *   bench_boxes [SCENE [VIEW [SHARED [POINTS]]]]     default: city street 1 400
 *
 * SHARED: so many lights may share a volume. For POINTS pixels of a view and every light whose sphere holds the surface
 * there, a ray to the light's middle tells whether it is seen. "seen" is how many of those that are seen the boxes
 * keep, "light" how much of what they give, "hidden" how many of those that are not seen they keep; all at the scene's
 * S_r, and at 4 times as much, as points ask that find too few. */
#include "bench_scene.h"

#include "../tests/backend/cpu_view.h"
#include "light/bound.h"

#include "core/surface.h"
#include "../tests/core/no_profiles.h"

#include <math.h>

typedef struct tally {
    double pairs, seen, seen_kept, light, light_kept, hidden, hidden_kept, points, dark;
} tally;

typedef struct bench {
    cpu_view *e;
    const noc_scene *s;
    noc_influence *spheres, *boxes;
    const gblock *g;
    int lane;
    noc_probes probes; /* from the surface to lights that wait to be told seen or not */
    struct {
        bool kept;
        double light;
    } waiting[NOC_PROBES];
    int count;
    bool found; /* the surface sees a light that a box keeps */
    tally t;
} bench;

static void tell(bench *b) {
    for (int i = b->count; i < NOC_PROBES; i++)
        for (int k = 0; k < 3; k++) {
            b->probes.o[k][i] = b->probes.o[k][0];
            b->probes.d[k][i] = b->probes.d[k][0];
        }
    if (b->count)
        noc_cpu_probe(b->e->world, &b->probes);
    for (int i = 0; i < b->count; i++) {
        bool seen = b->probes.t[i] >= 1, kept = b->waiting[i].kept;
        b->t.pairs++;
        *(seen ? &b->t.seen : &b->t.hidden) += 1;
        *(seen ? &b->t.seen_kept : &b->t.hidden_kept) += kept;
        b->t.light += seen ? b->waiting[i].light : 0;
        b->t.light_kept += seen && kept ? b->waiting[i].light : 0;
        b->found |= kept;
    }
    b->count = 0;
}

static void look_at(bench *b, uint32_t id, bool kept) {
    const gblock *g = b->g;
    int l = b->lane;
    noc_light_bound at = noc_bound_light(&b->s->lights.data[id]);
    light record;
    memcpy(&record, &b->s->lights.data[id], sizeof(record));
    surf y = { .p = { g->px[l], g->py[l], g->pz[l] },
               .n = { g->nx[l], g->ny[l], g->nz[l] },
               .albedo = { 0.3f, 0.3f, 0.3f } };
    y.wo = y.n;
    b->waiting[b->count].kept = kept;
    b->waiting[b->count].light = target(NULL, y, record, 0.5f, 0.5f);
    float o[3] = { y.p.x + 0.01f * y.n.x, y.p.y + 0.01f * y.n.y, y.p.z + 0.01f * y.n.z }, length = 0;
    for (int k = 0; k < 3; k++)
        length += (at.p[k] - o[k]) * (at.p[k] - o[k]);
    length = sqrtf(length);
    bool flat = at.n[0] != 0 || at.n[1] != 0 || at.n[2] != 0;
    for (int k = 0; k < 3; k++) {
        float share = flat ? 1 : fmaxf(0, 1 - (at.radius + 0.01f) / length);
        b->probes.o[k][b->count] = o[k];
        b->probes.d[k][b->count] = (at.p[k] - o[k]) * share + (flat ? 0.02f * at.n[k] : 0);
    }
    if (b->waiting[b->count].light > 0 && ++b->count == NOC_PROBES)
        tell(b);
}

static void measure(bench *b, int points, float scale) {
    const frame_buffers *f = &b->e->b;
    size_t pixels = (size_t)f->blocks_x * (size_t)f->blocks_y * BLOCK, step = pixels / (size_t)points | 1;
    b->t = (tally){ 0 };
    for (size_t i = 0; i < pixels; i += step) {
        b->g = &f->g[0][i / BLOCK];
        b->lane = (int)(i % BLOCK);
        if (!(lanes_with_surface(b->g) >> b->lane & 1) || b->g->light[b->lane] != NOC_NO_LIGHT)
            continue;
        const float p[3] = { b->g->px[b->lane], b->g->py[b->lane], b->g->pz[b->lane] };
        const float n[3] = { b->g->nx[b->lane], b->g->ny[b->lane], b->g->nz[b->lane] };
        noc_near_query q = noc_near_point(p, n, scale);
        b->found = false;
        for (uint32_t id = 0; id < b->spheres->count; id++)
            if (noc_influence_finds(b->spheres, id, &q))
                look_at(b, id, noc_influence_finds(b->boxes, id, &q));
        tell(b);
        b->t.points++;
        b->t.dark += !b->found;
    }
    const tally *t = &b->t;
    printf("S_r %6.2f: %7.1f lights a point, %7.1f seen; kept: %6.2f%% of those seen, %6.2f%% of their light, "
           "%6.2f%% of those hidden; %.1f%% of the points find none\n",
           scale, t->pairs / t->points, t->seen / t->points, 100 * t->seen_kept / t->seen,
           100 * t->light_kept / t->light, 100 * t->hidden_kept / t->hidden, 100 * t->dark / t->points);
}

static bool run(const noc_scene *s, noc_viewpoint view, int shared, int points, noc_log *log) {
    enum { WIDTH = 320, HEIGHT = 180 };
    void *state = NULL;
    if (!(state = open_cpu_view(s, 0, log)))
        return false;
    bench b = { .e = state, .s = s };
    noc_camera camera;
    noc_render_params p = noc_render_default_params();
    p.width = WIDTH;
    p.height = HEIGHT;
    p.method = NOC_METHOD_RIS;
    p.candidates = NOC_CANDIDATES_UNIFORM;
    p.jitter = false;
    noc_plan plan = { .stages = { { .passes = { NOC_PASS_PRIMARY }, .count = 1 } },
                      .count = 1,
                      .draws = true,
                      .candidates = p.candidates };
    noc_frame f = { .params = &p, .plan = &plan };
    noc_make_frame_constants(&p, 0, false, &f.constants);
    bool ok = noc_scene_camera(s, view, (double)WIDTH / HEIGHT, &camera) == NOC_OK;
    if (ok) {
        noc_make_frame_camera(&camera, &p, 0, &f.constants.camera);
        noc_backend_embree.resize(state, WIDTH, HEIGHT, 1);
        ok = noc_cpu_prepare_lights(b.e, &plan, &p) == NOC_OK &&
             noc_backend_embree.stage(state, &f, &plan.stages[0], NULL, 0, 1) == NOC_OK;
    }
    noc_influence_params params = { .cluster = shared, .pool = b.e->pool };
    b.spheres = ok ? noc_influence_create(s, &params, log) : NULL;
    params.probe = noc_cpu_probe;
    params.user = b.e->world;
    double wall = noc_wall_seconds(), cpu = noc_cpu_seconds();
    b.boxes = ok ? noc_influence_create(s, &params, log) : NULL;
    wall = noc_wall_seconds() - wall;
    cpu = noc_cpu_seconds() - cpu;
    if (b.spheres && b.boxes) {
        printf("%zu lights, %u volumes, %u boxes: %.3f s wall, %.3f s CPU, %.1f bytes a light\n", s->lights.len,
               b.boxes->volume_count, b.boxes->box_count, wall, cpu, (double)b.boxes->bytes / (double)s->lights.len);
        measure(&b, points, b.boxes->scale);
        measure(&b, points, 4 * b.boxes->scale);
    }
    ok = b.spheres && b.boxes;
    noc_influence_destroy(b.spheres);
    noc_influence_destroy(b.boxes);
    close_cpu_view(state);
    return ok;
}

int main(int argc, char **argv) {
    int shared = argc > 3 ? atoi(argv[3]) : 1, points = argc > 4 ? atoi(argv[4]) : 400;
    noc_log *log = bench_log();
    noc_scene *scene = shared > 0 && points > 0 ? bench_scene(argc > 1 ? argv[1] : "city", log) : NULL;
    bool ok = scene && run(scene, bench_view(argc > 2 ? argv[2] : "street"), shared, points, log);
    noc_scene_destroy(scene);
    noc_log_destroy(log);
    return ok ? 0 : 1;
}
