/* Rays a second of one thread, the very same rays in different forms.
 *
 *   bench_rays [SCENE [VIEW [WIDTH HEIGHT [ROUNDS]]]]     default: city street 640 360 3
 *
 * Shadow rays: from the pixels to what they chose of 32 uniform candidates, or of their tile's list; and the same
 * samples seen from 12 pixels to the right, as bias rays are. Every form traces all rays of a tile, tile by tile, and
 * the fastest of the rounds counts (CPU seconds; sorting is counted in "as built" only). "differ" is the number of rays
 * whose answer is not that of the first form. "medium", "high": other structures over the same triangles, not robust
 * unless they say so. */
#include "bench_scene.h"

#include "../tests/backend/cpu_view.h"
#include "backend/embree/embree.h"

#include <math.h>

enum { TILE = TILE_BLOCKS * TILE_BLOCKS, TILE_RAYS = TILE * BLOCK };

typedef struct ray_set {
    shadow_block *blocks; /* TILE a tile */
    uint32_t *first;      /* answers of the first form */
    size_t tiles, count;
} ray_set;

typedef enum arrangement { BLOCKS, PIXELS, BY_OCTANT, BY_LIGHT } arrangement;
typedef enum call { ONE, SIXTEEN, STREAM, BUILT } call;

typedef struct form {
    const char *name;
    arrangement how;
    call call;
} form;

static const form forms[] = {
    { "16, blocks of pixels", BLOCKS, SIXTEEN },
    { "1", PIXELS, ONE },
    { "16, by octant", BY_OCTANT, SIXTEEN },
    { "16, by light", BY_LIGHT, SIXTEEN },
#ifdef RT_STREAMS
    { "stream", PIXELS, STREAM },
    { "stream, by light", BY_LIGHT, STREAM },
#endif
    { "as built", BLOCKS, BUILT },
};
enum { FORMS = sizeof(forms) / sizeof(forms[0]) };

static struct RTCRay ray_of(const shadow_block *own, uint16_t at) {
    const rayblock *b = &own[at / BLOCK].rays;
    int l = at % BLOCK;
    return (struct RTCRay){ .org_x = b->o[0][l],
                            .org_y = b->o[1][l],
                            .org_z = b->o[2][l],
                            .dir_x = b->d[0][l],
                            .dir_y = b->d[1][l],
                            .dir_z = b->d[2][l],
                            .tfar = 1,
                            .mask = UINT32_MAX };
}

static int by_key(const void *a, const void *b) {
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* The tile's rays in an order, gaps being UINT16_MAX; returns how many. */
static int arrange(const shadow_block *own, arrangement how, uint16_t *out) {
    uint64_t keys[TILE_RAYS];
    int n = 0;
    for (uint16_t i = 0; i < TILE_RAYS; i++) {
        bool ray = own[i / BLOCK].valid >> i % BLOCK & 1;
        out[i] = ray ? i : UINT16_MAX;
        struct RTCRay r = ray_of(own, i);
        uint64_t octant = (r.dir_x < 0) | (r.dir_y < 0) << 1 | (r.dir_z < 0) << 2;
        uint64_t light = own[i / BLOCK].light[i % BLOCK];
        if (ray)
            keys[n++] = (how == BY_LIGHT ? light << 24 | octant << 16 : how == BY_OCTANT ? octant << 16 : 0) | i;
    }
    if (how == BLOCKS)
        return TILE_RAYS;
    qsort(keys, (size_t)n, sizeof(*keys), by_key);
    for (int i = 0; i < n; i++)
        out[i] = (uint16_t)keys[i];
    return n;
}

static void answer(shadow_block *own, uint16_t at, bool clear) {
    own[at / BLOCK].unoccluded |= (uint32_t)clear << at % BLOCK;
}

static void trace_packets(RTCScene scene, shadow_block *own, const uint16_t *at, int n) {
    for (int first = 0; first < n; first += BLOCK) {
        ALIGNED int valid[BLOCK];
        ALIGNED struct RTCRay16 p = { 0 };
        bool any = false;
        for (int l = 0; l < BLOCK; l++) {
            bool on = first + l < n && at[first + l] != UINT16_MAX;
            struct RTCRay r = ray_of(own, on ? at[first + l] : 0);
            valid[l] = -(int)on;
            any |= on;
            p.org_x[l] = r.org_x, p.org_y[l] = r.org_y, p.org_z[l] = r.org_z;
            p.dir_x[l] = r.dir_x, p.dir_y[l] = r.dir_y, p.dir_z[l] = r.dir_z;
            p.tfar[l] = r.tfar, p.mask[l] = r.mask;
        }
        if (any)
            rt_occluded16(valid, scene, &p);
        for (int l = 0; l < BLOCK; l++)
            if (valid[l])
                answer(own, at[first + l], p.tfar[l] >= 0);
    }
}

static void trace_rays(RTCScene scene, shadow_block *own, const uint16_t *at, int n, bool stream) {
    struct RTCRay r[TILE_RAYS];
    for (int i = 0; i < n; i++)
        r[i] = ray_of(own, at[i]);
#ifdef RT_STREAMS
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    if (stream && n)
        rt_occluded_stream(scene, r, (unsigned)n);
    for (int i = 0; !stream && i < n; i++)
        rtcOccluded1(scene, &context, &r[i]);
#else
    for (int i = 0; i < n; i++)
        rtcOccluded1(scene, &r[i], NULL);
#endif
    for (int i = 0; i < n; i++)
        answer(own, at[i], r[i].tfar >= 0);
}

static double trace(RTCScene scene, const ray_set *set, const form *f, int rounds) {
    uint16_t *at = noc_alloc(set->tiles * TILE_RAYS * sizeof(*at));
    int *n = noc_alloc(set->tiles * sizeof(*n));
    double best = INFINITY;
    for (size_t t = 0; t < set->tiles; t++)
        n[t] = arrange(set->blocks + t * TILE, f->how, at + t * TILE_RAYS);
    for (int round = 0; round < rounds; round++) {
        double start = noc_cpu_seconds();
        for (size_t t = 0; t < set->tiles; t++) {
            shadow_block *own = set->blocks + t * TILE;
            for (int i = 0; i < TILE; i++)
                own[i].unoccluded = 0;
            if (f->call == BUILT)
                noc_embree_trace_many(scene, own, TILE);
            else if (f->call == ONE || f->call == STREAM)
                trace_rays(scene, own, at + t * TILE_RAYS, n[t], f->call == STREAM);
            else
                trace_packets(scene, own, at + t * TILE_RAYS, n[t]);
        }
        best = fmin(best, noc_cpu_seconds() - start);
    }
    free(at);
    free(n);
    return best;
}

static void measure(RTCScene scene, ray_set *set, const form *f, int rounds, bool first) {
    double seconds = trace(scene, set, f, rounds);
    int differ = 0;
    uint64_t clear = 0;
    for (size_t i = 0; i < set->tiles * TILE; i++) {
        if (first)
            set->first[i] = set->blocks[i].unoccluded;
        differ += __builtin_popcount(set->blocks[i].unoccluded ^ set->first[i]);
        clear += (uint64_t)__builtin_popcount(set->blocks[i].unoccluded);
    }
    printf("  %-24s %6.2f M/s   free %4.1f%%   differ %d\n", f->name, 1e-6 * (double)set->count / seconds,
           100.0 * (double)clear / (double)NOC_MAX(set->count, (size_t)1), differ);
    fflush(stdout);
}

static RTCScene build(RTCDevice device, const noc_scene *scene, enum RTCBuildQuality quality,
                      enum RTCSceneFlags flags) {
    RTCScene s = rtcNewScene(device);
    RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSceneFlags(s, flags);
    rtcSetSceneBuildQuality(s, quality);
    rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, scene->positions.data, 0, 12,
                               scene->positions.len / 3);
    rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, scene->indices.data, 0, 12,
                               scene->indices.len / 3);
    rtcCommitGeometry(g);
    rtcAttachGeometry(s, g);
    rtcReleaseGeometry(g);
    rtcCommitScene(s);
    return s;
}

/* Segments from the surfaces of every block, or of the one `shift` to the right, to the block's samples. */
static void collect(const cpu_view *s, const struct core_context *ctx, int shift, ray_set *set) {
    const frame_buffers *b = &s->b;
    set->count = 0;
    memset(set->blocks, 0, set->tiles * TILE * sizeof(*set->blocks));
    for (int by = 0; by < b->blocks_y; by++)
        for (int bx = 0; bx + shift < b->blocks_x; bx++) {
            size_t at = (size_t)by * b->blocks_x + bx, t = (size_t)(by / TILE_BLOCKS) * b->tiles_x + bx / TILE_BLOCKS;
            const gblock *g = &b->g[0][at + shift];
            const rblock *r = &b->r[0][at];
            shadow_block *out = &set->blocks[t * TILE + by % TILE_BLOCKS * TILE_BLOCKS + bx % TILE_BLOCKS];
            s->kernels->segments(ctx, g, r->light, r->u, r->v, &out->rays);
            memcpy(out->light, r->light, sizeof(out->light));
            out->valid = lanes_with_surface(g);
            for (int l = 0; l < BLOCK; l++)
                out->valid &= ~((uint32_t) !(r->w[l] > 0) << l);
            set->count += (size_t)__builtin_popcount(out->valid);
        }
}

static void measure_all(cpu_view *s, ray_set *set, const char *name, int rounds) {
    static const struct {
        const char *name;
        enum RTCBuildQuality quality;
        enum RTCSceneFlags flags;
    } builds[] = { { "medium", RTC_BUILD_QUALITY_MEDIUM, RTC_SCENE_FLAG_NONE },
                   { "medium robust compact", RTC_BUILD_QUALITY_MEDIUM,
                     RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_COMPACT },
                   { "high robust", RTC_BUILD_QUALITY_HIGH, RTC_SCENE_FLAG_ROBUST } };
    printf("%s: %zu rays\n", name, set->count);
    for (int f = 0; f < FORMS; f++)
        measure(((const embree_structure *)s->world->rays)->now.base->rtc[LAYER_SOLID], set, &forms[f], rounds, f == 0);
    for (size_t i = 0; i < sizeof(builds) / sizeof(builds[0]); i++) {
        RTCScene other = build(((const embree_device *)s->world->device->rays)->device, s->scene, builds[i].quality,
                               builds[i].flags);
        measure(other, set, &(form){ builds[i].name, BLOCKS, BUILT }, rounds, false);
        rtcReleaseScene(other);
    }
}

int main(int argc, char **argv) {
    const char *spec = argc > 1 ? argv[1] : "city", *view = argc > 2 ? argv[2] : "street";
    int width = argc > 4 ? atoi(argv[3]) : 640, height = argc > 4 ? atoi(argv[4]) : 360,
        rounds = argc > 5 ? atoi(argv[5]) : 3;
    if (width < 1 || height < 1 || rounds < 1) {
        fprintf(stderr, "usage: bench_rays [SCENE [VIEW [WIDTH HEIGHT [ROUNDS]]]]\n");
        return 2;
    }
    noc_log *log = bench_log();
    noc_scene *scene = bench_scene(spec, log);
    noc_camera camera;
    void *state = NULL;
    if (!scene || noc_scene_camera(scene, bench_view(view), (double)width / height, &camera) != NOC_OK ||
        !(state = open_cpu_view(scene, 1, log)) || noc_backend_embree.resize(state, width, height, 1) != NOC_OK)
        return 1;
    cpu_view *s = state;
    printf("%s, %s, %d x %d: %zu triangles, %zu lights\n", spec, view, width, height, scene->indices.len / 3,
           scene->lights.len);
    ray_set set = { .tiles = (size_t)s->b.tiles_x * s->b.tiles_y };
    set.blocks = noc_alloc_large(set.tiles * TILE, sizeof(*set.blocks));
    set.first = noc_calloc(set.tiles * TILE, sizeof(*set.first));
    noc_render_params p = noc_render_default_params();
    p.width = width;
    p.height = height;
    p.method = NOC_METHOD_RIS;
    noc_plan plan;
    noc_frame frame = { .params = &p, .plan = &plan };
    noc_make_frame_constants(&p, 0, false, &frame.constants);
    noc_make_frame_camera(&camera, &p, 0, &frame.constants.camera);
    struct core_context ctx = { .lights = scene->lights.data,
                                .light_count = (uint32_t)scene->lights.len,
                                .materials = scene->material_records.data,
                                .frame = &frame.constants };
    static const noc_candidates sources[] = { NOC_CANDIDATES_UNIFORM, NOC_CANDIDATES_LISTS };
    for (int i = 0; set.blocks && i < 4; i++) {
        p.candidates = sources[i / 2];
        noc_plan_make(&p, false, -1, false, &plan);
        if (noc_backend_embree.stage(state, &frame, &plan.stages[0], NULL, 0, 1) != NOC_OK)
            return 1;
        collect(s, &ctx, i % 2 ? 3 : 0, &set);
        measure_all(s, &set, (const char *const[]){ "uniform", "uniform, bias rays", "lists", "lists, bias rays" }[i],
                    rounds);
    }
    free(set.blocks);
    free(set.first);
    close_cpu_view(state);
    noc_scene_destroy(scene);
    noc_log_destroy(log);
    return 0;
}
