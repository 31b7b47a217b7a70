/* How many light candidates (draw, point on the light, unshadowed target, reservoir) a core makes a second, by
 * instruction set, by the layout of the lights in memory, and by what is lit by what. Million a second of thread CPU
 * time, the best of RUNS. Two columns draw for each surface alone, from arrays of fields and from records; the third is
 * the renderer's kernel, whose blocks of surfaces share samples (core/presampled.h), which it draws too. All rows
 * of a column must agree on every choice and weight: the checksums are compared. Usage: bench_candidates [surfaces [M]]
 */
#include "candidates.h"

#include "backend/cpu/kernels.h"
#include "base/base.h"
#include "core/light.h"
#include "../tests/core/no_profiles.h"
#include "core/presample_limits.h"
#include "core/random.h"
#include "scene/scene.h"

#include <stdio.h>
#include <time.h>

_Static_assert(offsetof(noc_light_record, kind) == offsetof(light, kind) &&
                   offsetof(noc_light_record, a) == offsetof(light, a) &&
                   offsetof(noc_light_record, flags) == offsetof(light, flags) &&
                   offsetof(noc_light_record, e) == offsetof(light, e) &&
                   offsetof(noc_light_record, area) == offsetof(light, area) &&
                   sizeof(light) == sizeof(noc_light_record),
               "records are what core/wide_load.h loads");

enum { RUNS = 9 };

static double cpu_seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Windows on the walls of a square city of 2 km, and, with spheres, as many lamps among them. */
static void make_lights(noc_light_record *lights, uint32_t count, bool spheres) {
    for (uint32_t i = 0; i < count; i++) {
        uint32_t k = hash_u32(i + 12345u);
        noc_light_record *l = &lights[i];
        v3 side = circle(rng(k, 3));
        *l = (noc_light_record){ .p = { rng(k, 0) * 2000, rng(k, 1) * 2000, rng(k, 2) * 25 },
                                 .kind = LIGHT_PARALLELOGRAM,
                                 .a = { side.x, side.y, 0 },
                                 .b = { 0, 0, 1.5f },
                                 .radius = 0.15f,
                                 .e = { 90, 60, 30 },
                                 .area = 1.5f };
        if (spheres && i % 2)
            l->kind = LIGHT_SPHERE;
    }
}

static void make_surfaces(float *f[13], uint32_t count, float f0) {
    for (uint32_t i = 0; i < count; i++) {
        uint32_t k = hash_u32(i + 777u);
        v3 wo = cosine_hemisphere(V3(0, 0, 1), rng(k, 2), rng(k, 3));
        float values[13] = { rng(k, 0) * 2000, rng(k, 1) * 2000, 0, 0, 0, 1, wo.x, wo.y, wo.z, .2f, .2f, .2f, f0 };
        for (int j = 0; j < 13; j++)
            f[j][i] = values[j];
    }
}

/* Of the renderer, with the subsets of a picture of a million pixels, drawn for so many, too. */
static uint64_t presampled(const kernels *k, const candidates_job *job, float f0, bool first_time) {
    enum { PIXELS = 1 << 20 };
    static presample_row samples[PRESAMPLES / BLOCK];
    static presample_pick1 drawn[MOST_DRAWS * BLOCK];
    static float weighed[MOST_DRAWS][BLOCK];
    static gblock g;
    uint32_t subsets = presample_subsets((uint32_t)job->m, PIXELS / BLOCK);
    uint32_t fresh = (uint32_t)((uint64_t)subsets * job->surface_count / PIXELS) + 1;
    const noc_material_record material = { .albedo = { .2f, .2f, .2f }, .f0 = f0, .alpha = .3f };
    frame_constants frame = { .width = 16, .height = job->surface_count / 16, .blocks_x = 4, .seed = 1 };
    struct core_context ctx = { .frame = &frame,
                                .lights = (const light_record *)job->records,
                                .light_count = job->lights,
                                .materials = &material };
    frame.camera.eye[2] = 1000;
    uint64_t sum = 0;
    for (uint32_t i = 0; i < (first_time ? subsets : fresh); i++)
        k->presample(&ctx, i, job->m, false, drawn, samples + (size_t)i * (size_t)job->m);
    for (uint32_t first = 0; first < job->surface_count; first += BLOCK) {
        float *const to[6] = { g.px, g.py, g.pz, g.nx, g.ny, g.nz };
        rblock r;
        for (int j = 0; j < 6; j++)
            memcpy(to[j], job->surfaces[j] + first, BLOCK * sizeof(float));
        uint32_t pixels[BLOCK], subset = presample_subset(ctx.frame->seed, first / BLOCK, ctx.frame->index, subsets);
        for (uint32_t l = 0; l < BLOCK; l++)
            pixels[l] = first + l;
        k->presampled(&ctx, &g, 0xffff, pixels, job->m, samples + (size_t)subset * (size_t)job->m, weighed, &r);
        for (int l = 0; l < BLOCK; l++) {
            uint32_t w;
            memcpy(&w, &r.w[l], sizeof(w));
            sum += (uint64_t)r.light[l] * 2654435761u + w;
        }
    }
    return sum;
}

static double measure_presampled(const kernels *k, const candidates_job *job, float f0, uint64_t *sum) {
    double best = 0;
    presampled(k, job, f0, true);
    for (int i = 0; i < RUNS; i++) {
        double t = cpu_seconds();
        *sum = presampled(k, job, f0, false);
        t = cpu_seconds() - t;
        best = NOC_MAX(best, 1e-6 * job->surface_count * job->m / t);
    }
    return best;
}

static double measure(candidates_fn *fn, const candidates_job *job, int layout, uint64_t *sum) {
    double best = 0;
    for (int i = 0; i < RUNS; i++) {
        double t = cpu_seconds();
        *sum = fn(job, layout);
        t = cpu_seconds() - t;
        best = NOC_MAX(best, 1e-6 * job->surface_count * job->m / t);
    }
    return best;
}

static const struct {
    const char *name;
    candidates_fn *fn;
} sets[] = {
    { "scalar", candidates_scalar },
    { "baseline x4", candidates_baseline },
#if defined(HAVE_X86_WIDE)
    { "avx2 x8", candidates_avx2 },
    { "avx512 x16", candidates_avx512 },
#endif
};

static bool supported(size_t set) {
#if defined(HAVE_X86_WIDE)
    if (set == 2)
        return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi2") && __builtin_cpu_supports("fma");
    if (set == 3)
        return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
               __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl");
#endif
    return set < 2;
}

/* Returns false when the rows disagree. */
static bool bench_scene(const char *name, candidates_job *job, noc_light_record *records, float *soa, bool spheres,
                        float f0) {
    const kernels *tables[NOC_MAX_KERNELS];
    bool agree = true;
    uint64_t first_sum = 0, shared_sum = 0;
    int count = noc_runnable_kernels(tables);
    make_lights(records, job->lights, spheres);
    for (int f = 0; f < 16; f++)
        for (uint32_t i = 0; i < job->lights; i++)
            memcpy(&soa[(size_t)f * job->lights + i], (const float *)(records + i) + f, sizeof(float));
    for (int f = 0; f < 16; f++)
        job->soa[f] = soa + (size_t)f * job->lights;
    printf("%s, %u lights\n%14s %12s %12s %12s\n", name, job->lights, "", "SoA gather", "records", "presampled");
    for (size_t i = 0; i < NOC_COUNT(sets); i++) {
        if (!supported(i)) {
            printf("%14s  not on this machine\n", sets[i].name);
            continue;
        }
        printf("%14s", sets[i].name);
        for (int layout = 0; layout < LAYOUT_COUNT; layout++) {
            uint64_t sum;
            printf(" %12.0f", measure(sets[i].fn, job, layout, &sum));
            fflush(stdout);
            agree = agree && (!first_sum || sum == first_sum);
            first_sum = sum;
        }
        if ((int)i < count) {
            uint64_t sum;
            printf(" %12.0f", measure_presampled(tables[i], job, f0, &sum));
            agree = agree && (!shared_sum || sum == shared_sum);
            shared_sum = sum;
        }
        printf("\n");
    }
    return agree;
}

int main(int argc, char **argv) {
    uint32_t surfaces = argc > 1 ? (uint32_t)NOC_CLAMP(atoi(argv[1]), 16, 1 << 24) & ~15u : 1u << 14;
    candidates_job job = { .surface_count = surfaces, .m = argc > 2 ? NOC_CLAMP(atoi(argv[2]), 1, 1024) : 32 };
    float *f[13];
    for (int i = 0; i < 13; i++)
        job.surfaces[i] = f[i] = noc_alloc((size_t)surfaces * sizeof(float));
    static const uint32_t counts[] = { 60000, 1000000 };
    bool agree = true;
    for (size_t c = 0; c < NOC_COUNT(counts); c++) {
        job.lights = counts[c];
        noc_light_record *records = noc_alloc_large(job.lights, sizeof(*records));
        float *soa = noc_alloc_large((size_t)job.lights * 16, sizeof(*soa));
        if (!records || !soa)
            return 1;
        job.records = (const float *)records;
        make_surfaces(f, surfaces, 0);
        agree &= bench_scene("windows, diffuse", &job, records, soa, false, 0);
        agree &= bench_scene("windows and spheres, diffuse", &job, records, soa, true, 0);
        make_surfaces(f, surfaces, 0.04f);
        agree &= bench_scene("windows, glossy", &job, records, soa, false, 0.04f);
        free(records);
        free(soa);
    }
    for (int i = 0; i < 13; i++)
        free(f[i]);
    printf(agree ? "All rows agree.\n" : "ROWS DISAGREE.\n");
    return !agree;
}
