/* Who lights this, as pictures and as rankings: how often they are right, how well they know it, and what they cost.
 *
 *   bench_influential [SCENE [VIEW [WIDTH HEIGHT [FRAMES [SEEDS]]]]]
 *
 * default: builtin:city street 48 27 256 20. SCENE may also be panes:COUNT, towers with so many shining windows.
 *
 * All surfaces are made matte and grey, so that what brings the most luminance brings the most light. Brute force is a
 * ranking of each pixel's point, which looks at all lights, until the greatest share is known to 1 in 300, or
 * 50,000 rays. Told are:
 *
 * - of pictures (--show influential) after 1, 4, 16, ... FRAMES frames of the default method: the share of pixels whose
 *   light is the right one, the same of those where it brings 1.5 times the next one's, and the root of the mean square
 *   error of its share;
 * - what the pass takes beyond plain frames: medians of frames that are made in turn;
 * - of rankings, how many of SEEDS quick ones of some points hold the truth within 1.96 of their standard errors; and
 *   medians of the time until the greatest share is known to 1 %, at a point and for a street. */
#include "bench_scene.h"
#include "../tests/own_view.h"

#include "base/base.h"
#include <nocturne/influence.h>

#include <math.h>

enum { ROWS = 3, MOST_PLACES = 40, TURNS = 9 };

typedef struct bench {
    noc_log *log;
    noc_scene *scene;
    noc_camera camera;
    noc_render_params params;
    int frames, seeds;
    noc_influence_row (*truth)[ROWS]; /* a pixel */
    size_t *found;                    /* 0: nothing is asked there */
    noc_region **region;              /* NULL where there is no surface */
    size_t pixels;
} bench;

/* ---- towers of windows ---- */

static bool add_box(noc_scene *s, int material, double x, double y, double side, double height) {
    const double a = side / 2;
    const double xyz[] = { x - a, y - a, 0,      x + a, y - a, 0,      x + a, y + a, 0,      x - a, y + a, 0,
                           x - a, y - a, height, x + a, y - a, height, x + a, y + a, height, x - a, y + a, height };
    static const uint32_t faces[] = { 0, 1, 5, 0, 5, 4, 1, 2, 6, 1, 6, 5, 2, 3, 7,
                                      2, 7, 6, 3, 0, 4, 3, 4, 7, 4, 5, 6, 4, 6, 7 };
    noc_mesh m = { .vertex_count = 8, .positions = xyz, .triangle_count = 10, .indices = faces, .material = material };
    return noc_scene_add_mesh(s, &m) >= 0;
}

/* One window in four walls of ten in a row, floor by floor. */
static bool add_pane(noc_scene *s, double x, double y, double side, int number) {
    int wall = number % 4, column = number / 4 % 10, storey = number / 40;
    double along = -side / 2 + side * (column + 0.3) / 10, out = side / 2 + 0.03, z = 1 + 3 * storey;
    const double turn[4][2] = {
        { 1, 0 }, { 0, 1 }, { -1, 0 }, { 0, -1 }
    }; /* along the wall; outwards is to its right */
    const double *t = turn[wall];
    float e = 5 + 45 * (float)(((uint32_t)number * 2654435761u >> 16) % 100) / 100;
    noc_light l = { .kind = NOC_LIGHT_PARALLELOGRAM,
                    .position = { x + along * t[0] + out * t[1], y + along * t[1] - out * t[0], z },
                    .edge_u = { 1.2 * t[0], 1.2 * t[1], 0 },
                    .edge_v = { 0, 0, 1.4 },
                    .emission = { e, e * 0.8f, e * 0.5f } };
    return noc_scene_add_light(s, &l) >= 0;
}

static noc_scene *panes(int count, noc_log *log) {
    enum { TOWER = 2000 }; /* windows: 50 storeys */
    noc_scene *s = noc_scene_create(log);
    int grey = noc_scene_add_material(s, &(noc_material){ .albedo = { .5f, .5f, .5f }, .roughness = 1 });
    int towers = (count + TOWER - 1) / TOWER, row = (int)ceil(sqrt(towers));
    double half = 30.0 * row + 60;
    const double xyz[] = { -half, -half, 0, half, -half, 0, half, half, 0, -half, half, 0 };
    noc_mesh ground = { .vertex_count = 4,
                        .positions = xyz,
                        .triangle_count = 2,
                        .indices = (uint32_t[]){ 0, 1, 2, 0, 2, 3 },
                        .material = grey };
    bool ok = noc_scene_add_mesh(s, &ground) >= 0;
    for (int i = 0; ok && i < count; i++) {
        double x = 60.0 * (i / TOWER % row) - 30.0 * row + 30, y = 60.0 * (i / TOWER / row) - 30.0 * row + 30;
        ok = (i % TOWER || add_box(s, grey, x, y, 30, 151)) && add_pane(s, x, y, 30, i % TOWER);
    }
    double middle = row % 2 ? 30 : 0; /* between towers */
    noc_camera c = {
        .eye = { middle, middle - 100, 12 }, .target = { middle + 8, middle, 8 }, .up = { 0, 0, 1 }, .fov_deg = 60
    };
    if (ok && !noc_scene_set_camera(s, &c) && !noc_scene_commit(s))
        return s;
    noc_scene_destroy(s);
    return NULL;
}

static bool make_matte(noc_scene *s) {
    const noc_material grey = { .albedo = { .5f, .5f, .5f }, .roughness = 1 };
    for (int c = 0; c < NOC_CLASS_COUNT; c++)
        if (c != NOC_CLASS_CLOSURE && noc_scene_set_class_material(s, (noc_class)c, &grey))
            return false;
    return !noc_scene_commit(s);
}

/* ---- rankings ---- */

static noc_ranking *rank(const bench *b, noc_view *view, const noc_region *region, uint32_t seed,
                         const noc_ranking_target *target) {
    noc_render_params p = b->params;
    p.seed = seed;
    noc_ranking *r = noc_ranking_create(view, region, &(noc_ranking_params){ &p, NULL });
    if (r && !noc_ranking_refine(r, target, NULL))
        return r;
    noc_ranking_destroy(r);
    return NULL;
}

/* The place that each pixel's middle sees, and who lights it. */
static bool find_truth(bench *b, noc_view *view) {
    const noc_ranking_target target = { .rays = 50000, .error = 1 / 300.0 };
    for (size_t i = 0; i < b->pixels; i++) {
        int w = b->params.width;
        double at[2] = { (double)(i % (size_t)w) + 0.5, (double)(i / (size_t)w) + 0.5 };
        noc_ray ray;
        noc_hit hit;
        if (noc_camera_ray(&b->camera, w, b->params.height, at, &ray) || noc_view_cast(view, &ray, 1, &hit))
            return false;
        if (!hit.hit || hit.shines)
            continue;
        noc_patch y = noc_hit_patch(&hit, 1, NULL, NULL);
        b->region[i] = noc_region_create(b->log);
        noc_ranking *r = noc_region_add(b->region[i], &y, 1) ? NULL : rank(b, view, b->region[i], 77, &target);
        if (!r || noc_ranking_get(r, b->truth[i], ROWS, &b->found[i], NULL))
            return false;
        noc_ranking_destroy(r);
    }
    return true;
}

/* Places all over the picture: the n-th of so many that light reaches. */
static size_t place_of(const bench *b, size_t n, size_t of) {
    size_t i = (2 * n + 1) * b->pixels / (2 * of);
    for (size_t k = 0; k < b->pixels; k++, i = (i + 1) % b->pixels)
        if (b->found[i])
            return i;
    return SIZE_MAX;
}

static bool tell_rankings(const bench *b, noc_view *view) {
    double seconds[MOST_PLACES], street[TURNS];
    long inside = 0, of = 0;
    int streets = 0;
    for (int n = 0; n < MOST_PLACES; n++) {
        size_t i = place_of(b, (size_t)n, MOST_PLACES);
        if (i == SIZE_MAX)
            return false;
        noc_ranking *long_one = rank(b, view, b->region[i], 78, &(noc_ranking_target){ .rays = 1000000 });
        noc_influence_row truth[ROWS], rows[2 * ROWS];
        size_t found, have;
        if (!long_one || noc_ranking_get(long_one, truth, ROWS, &found, NULL))
            return false;
        noc_ranking_destroy(long_one);
        for (int seed = 0; seed < b->seeds; seed++) {
            noc_ranking *r = rank(b, view, b->region[i], 1000 + 7919 * (uint32_t)seed, NULL);
            if (!r || noc_ranking_get(r, rows, 2 * ROWS, &have, NULL))
                return false;
            noc_ranking_destroy(r);
            for (size_t k = 0; k < found; k++)
                for (size_t j = 0; j < have; j++)
                    if (rows[j].emitter.light == truth[k].emitter.light && rows[j].share.error > 1e-6) {
                        double e = hypot(rows[j].share.error, truth[k].share.error);
                        inside += fabs(rows[j].share.value - truth[k].share.value) < 1.96 * e;
                        of++;
                    }
        }
        double began = noc_wall_seconds();
        noc_ranking_destroy(rank(b, view, b->region[i], 1, &(noc_ranking_target){ .seconds = 10, .error = 0.01 }));
        seconds[n] = noc_wall_seconds() - began;
    }
    printf("rankings: %.1f %% of %ld shares within 1.96 standard errors; 1 %% at a point in %.3f s",
           of ? 100.0 * (double)inside / (double)of : 0.0, of, bench_median(seconds, MOST_PLACES));
    noc_street s;
    for (size_t i = 0, all = noc_scene_streets(b->scene); all && i < NOC_MIN(all, TURNS); i++) {
        char words[160];
        if (!noc_scene_get_street(b->scene, i * all / NOC_MIN(all, TURNS), &s))
            continue;
        noc_snprintf(words, sizeof(words), "street:%s", *s.name ? s.name : s.id);
        double began = noc_wall_seconds();
        noc_region *region = noc_region_find(view, b->scene, words, NULL, NULL);
        noc_ranking *r =
            region ? rank(b, view, region, 1, &(noc_ranking_target){ .seconds = 10, .error = 0.01 }) : NULL;
        if (r)
            street[streets++] = noc_wall_seconds() - began;
        noc_ranking_destroy(r);
        noc_region_destroy(region);
    }
    if (streets)
        printf(", of a street in %.2f s", bench_median(street, streets));
    printf("\n");
    return of > 0;
}

/* ---- pictures ---- */

static bool tell_pictures(const bench *b, int frames, noc_view *view) {
    noc_channel *light = noc_view_aov(view, NOC_AOV_INFLUENTIAL),
                *share = noc_view_aov(view, NOC_AOV_INFLUENTIAL_SHARE);
    size_t right = 0, of = 0, clear_right = 0, clear = 0;
    double square = 0;
    for (size_t i = 0; light && share && i < b->pixels; i++) {
        const noc_influence_row *t = b->truth[i];
        if (!b->found[i] || !(light->value[i] >= 0))
            continue;
        bool same = (size_t)light->value[i] == t[0].emitter.light;
        bool is_clear = b->found[i] < 2 || t[0].share.value > 1.5 * t[1].share.value;
        double off = share->value[i] - t[0].share.value;
        square += off * off;
        right += same;
        of++;
        clear += is_clear;
        clear_right += is_clear && same;
    }
    if (of)
        printf("%4d frames: %5.1f %% right (%.1f %% of %.0f %% that are clear), share off by %.3f, %zu pixels\n",
               frames, 100.0 * (double)right / (double)of, clear ? 100.0 * (double)clear_right / (double)clear : 0.0,
               100.0 * (double)clear / (double)of, sqrt(square / (double)of), of);
    noc_channel_destroy(light);
    noc_channel_destroy(share);
    return of > 0;
}

static bool look(const bench *b, noc_render_params p) {
    noc_view *view = own_view(b->scene, 0, b->log);
    bool ok = view != NULL;
    for (int f = 1, next = 1; ok && f <= b->frames; f++) {
        ok = !noc_view_render(view, &b->camera, &p, NULL);
        if (ok && f == next) {
            ok = tell_pictures(b, f, view);
            next *= 4;
        }
    }
    close_view(view);
    return ok;
}

static bool time_pass(const bench *b, noc_render_params told) {
    noc_render_params p[2] = { b->params, told };
    noc_view *view[2] = { NULL, NULL };
    double cpu[2][TURNS];
    bool ok = true;
    for (int i = 0; i < 2; i++) {
        p[i].width = 640;
        p[i].height = 360;
        view[i] = own_view(b->scene, 0, b->log);
        ok = ok && view[i] && !noc_view_render(view[i], &b->camera, &p[i], NULL);
    }
    for (int f = 0; f < TURNS; f++)
        for (int i = 0; ok && i < 2; i++) {
            noc_frame_stats stats;
            ok = !noc_view_render(view[i], &b->camera, &p[i], NULL);
            noc_view_get_stats(view[i], &stats);
            cpu[i][f] = stats.cpu_seconds;
        }
    if (ok) {
        double plain = bench_median(cpu[0], TURNS), with = bench_median(cpu[1], TURNS);
        printf("640 x 360: %.0f CPU ms a plain frame, %.0f with the pass: %+.1f %%\n", 1e3 * plain, 1e3 * with,
               100 * (with / plain - 1));
    }
    close_view(view[0]);
    close_view(view[1]);
    return ok;
}

int main(int argc, char **argv) {
    const char *spec = argc > 1 ? argv[1] : "builtin:city", *which = argc > 2 ? argv[2] : "street";
    int width = argc > 4 ? atoi(argv[3]) : 48, height = argc > 4 ? atoi(argv[4]) : 27;
    bench b = { .frames = argc > 5 ? atoi(argv[5]) : 256, .seeds = argc > 6 ? atoi(argv[6]) : 20 };
    bool towers = !strncmp(spec, "panes:", 6);
    if (width < 1 || height < 1 || width > 4096 || height > 4096 || b.frames < 1 || b.seeds < 1) {
        fprintf(stderr, "usage: bench_influential [SCENE [VIEW [WIDTH HEIGHT [FRAMES [SEEDS]]]]]\n");
        return 2;
    }
    b.log = bench_log();
    b.scene = towers ? panes(atoi(spec + 6), b.log) : bench_scene(spec, b.log);
    b.params = noc_render_default_params();
    b.params.width = width;
    b.params.height = height;
    b.params.jitter = false;
    b.pixels = (size_t)width * (size_t)height;
    b.truth = noc_calloc(b.pixels, sizeof(*b.truth));
    b.found = noc_calloc(b.pixels, sizeof(*b.found));
    b.region = noc_calloc(b.pixels, sizeof(noc_region *));
    noc_render_params told = b.params;
    told.aovs = 1u << NOC_AOV_INFLUENTIAL | 1u << NOC_AOV_INFLUENTIAL_SHARE;
    bool ok =
        b.scene && b.truth && b.found && b.region && make_matte(b.scene) &&
        !noc_scene_camera(b.scene, towers ? NOC_VIEWPOINT_OWN : bench_view(which), (double)width / height, &b.camera);
    noc_view *view = ok ? own_view(b.scene, 0, b.log) : NULL;
    noc_scene_info info = { 0 };
    if (ok)
        noc_scene_get_info(b.scene, &info);
    printf("%s: %zu lights\n", spec, info.light_slots);
    ok = view && find_truth(&b, view) && look(&b, told) && time_pass(&b, told) && tell_rankings(&b, view);
    for (size_t i = 0; b.region && i < b.pixels; i++)
        noc_region_destroy(b.region[i]);
    free(b.region);
    free(b.truth);
    free(b.found);
    close_view(view);
    noc_scene_destroy(b.scene);
    noc_log_destroy(b.log);
    return ok ? 0 : 1;
}
