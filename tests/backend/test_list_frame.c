/* One frame of rays over light lists in the CPU's kernels and in a trial compute shader (list_frame.comp), over the
 * same g-buffer, clusters, priors and visibility bits: the lists, the draws, the rays, the samples that stand for a
 * pixel and its light are equal to the bit, in every kernel table, and on Vulkan devices that round as C does. */
#include "../render/rooms.h"

#include "core/learned.h"
#include "cpu_view.h"
#include "list_frame.h"

#include <math.h>
#if defined(HAVE_VULKAN)
#include "../core/vulkan_run.h"
#include "list_frame_spv.h"
#endif

enum { W = 64, H = 48, TILES_X = W / 16, TILES = W / 16 * (H / 16), SEED = 3, FRAME_NUMBER = 5 };
#define BRIGHTNESS 0.7f

typedef struct trial {
    noc_scene *scene;
    noc_render_params params;
    noc_frame frame;
    noc_plan plan;
    cpu_view *view;
    struct core_context ctx;
    float *visibility; /* expected of each light */
    uint32_t *words;   /* of the shader's buffer */
    size_t count;
} trial;

static size_t append(trial *t, const void *data, size_t words) {
    size_t at = t->count;
    t->words = noc_realloc(t->words, (t->count += words) * sizeof(*t->words));
    assert_non_null(t->words);
    if (data)
        memcpy(t->words + at, data, words * sizeof(*t->words));
    else
        memset(t->words + at, 0, words * sizeof(*t->words));
    return at;
}

_Static_assert(sizeof(gblock) == 4 * BLOCK * BLOCK_FIELDS, "the shader finds the fields of a block");

static const gblock *block_of(const trial *t, int number, int block) {
    size_t bx = (size_t)(number % TILES_X * 4 + block % 4), by = (size_t)(number / TILES_X * 4 + block / 4);
    return &t->view->b.g[0][by * (size_t)t->view->b.blocks_x + bx];
}

/* All that the shader reads, behind its head. */
static void make_words(trial *t) {
    const noc_clusters *c = t->view->sources.clusters[NOC_STANDING];
    const frame_constants *f = &t->frame.constants;
    append(t, NULL, HEAD_WORDS);
    const uint32_t head[] = { TILES, TILES_X, W, f->seed, f->index, f->list, f->tail, f->shadow_rays, f->draws };
    const float brightness = BRIGHTNESS;
    memcpy(t->words, head, sizeof(head));
    memcpy(t->words + HEAD_EYE, f->camera.eye, sizeof(f->camera.eye));
    memcpy(t->words + HEAD_BRIGHTNESS, &brightness, sizeof(brightness));
    t->words[HEAD_LEVELS] = (uint32_t)c->levels;
    t->words[HEAD_TOP_NODES] = (uint32_t)c->nodes[c->levels - 1];
    size_t at[HEAD_WORDS] = { 0 };
    at[HEAD_LIGHTS] = append(t, t->scene->lights.data, 16 * t->scene->lights.len);
    at[HEAD_MATERIALS] = append(t, t->scene->material_records.data, 8 * t->scene->material_records.len);
    at[HEAD_BLOCKS] = t->count;
    for (int i = 0; i < 16 * TILES; i++)
        append(t, block_of(t, i / 16, i % 16), sizeof(gblock) / 4);
    at[HEAD_CLUSTERS] = append(t, c->lights, c->count * (sizeof(*c->lights) / 4));
    at[HEAD_VISIBILITY] = append(t, t->visibility, t->scene->lights.len);
    for (int i = 0; i < c->levels; i++)
        at[HEAD_NODES + i] = append(t, c->level[i], (c->nodes[i] + 15) / 16 * (sizeof(**c->level) / 4));
    at[HEAD_SCRATCH] = append(t, NULL, (size_t)TILES * SCRATCH_WORDS);
    at[HEAD_ANSWER] = append(t, NULL, (size_t)TILES * ANSWER_WORDS);
    for (int i = HEAD_LIGHTS; i < HEAD_NODES + LIST_LEVELS; i++)
        t->words[i] = (uint32_t)at[i];
}

static void make_trial(trial *t, const char *scene, const noc_builtin_params *of, int list, int tail) {
    noc_camera camera;
    memset(t, 0, sizeof(*t));
    t->scene = noc_scene_create(NULL);
    assert_int_equal(noc_scene_add_builtin(t->scene, scene, of), NOC_OK);
    assert_int_equal(noc_scene_commit(t->scene), NOC_OK);
    assert_int_equal(noc_scene_camera(t->scene, NOC_VIEWPOINT_AERIAL, (double)W / H, &camera), NOC_OK);
    t->params = measure(W, H, NOC_METHOD_RIS);
    t->params.candidates = NOC_CANDIDATES_LISTS;
    t->params.list = list;
    t->params.tail = tail;
    t->params.shadow_rays = 4;
    t->params.seed = SEED;
    t->plan = (noc_plan){ .stages = { { .passes = { NOC_PASS_PRIMARY }, .count = 1 } },
                          .count = 1,
                          .draws = true,
                          .candidates = NOC_CANDIDATES_LISTS };
    t->frame = (noc_frame){ .params = &t->params, .plan = &t->plan };
    noc_make_frame_constants(&t->params, FRAME_NUMBER, false, &t->frame.constants);
    noc_make_frame_camera(&camera, &t->params, FRAME_NUMBER, &t->frame.constants.camera);
    assert_non_null(t->view = open_cpu_view(t->scene, 1, NULL));
    assert_int_equal(noc_backend_embree.resize(t->view, W, H, 1), NOC_OK);
    assert_int_equal(noc_cpu_prepare_lights(t->view, &t->plan, &t->params), NOC_OK);
    assert_int_equal(noc_backend_embree.stage(t->view, &t->frame, &t->plan.stages[0], NULL, 0, 1), NOC_OK);
    t->ctx = (struct core_context){ .frame = &t->frame.constants,
                                    .lights = t->scene->lights.data,
                                    .light_count = (uint32_t)t->scene->lights.len,
                                    .materials = t->scene->material_records.data,
                                    .clusters = { t->view->sources.clusters[0], t->view->sources.clusters[1] } };
    t->visibility = noc_calloc(t->scene->lights.len, sizeof(float));
    assert_non_null(t->visibility);
    for (size_t i = 0; i < t->scene->lights.len; i++)
        t->visibility[i] = rng(hash_u32((u32)i), 1);
    make_words(t);
}

static void free_trial(trial *t) {
    close_cpu_view(t->view);
    noc_scene_destroy(t->scene);
    free(t->visibility);
    free(t->words);
}

static void put_float(uint32_t *at, float x) { memcpy(at, &x, sizeof(x)); }

/* The rays of a block, each as far as a lane has it, and what they bring. */
static void answer_block(const trial *t, const kernels *k, const struct core_context *ctx, const gblock *g, int x,
                         int y, const priors *b, uint32_t *out) {
    list_asked *asked = noc_alloc_large(1, sizeof(*asked));
    ray_draw draws[MOST_SHADOW_RAYS];
    rayblock way;
    uint32_t lanes = lanes_with_surface(g);
    rblock shown = { 0 }, kept = { 0 };
    cblock colour = { 0 };
    assert_non_null(asked);
    memset(draws, 0, sizeof(draws));
    k->list_share(ctx, g, lanes, x, y, BRIGHTNESS, b, asked);
    for (int i = 0; i < asked->most; i++) {
        uint32_t seen = 0;
        k->list_ray(ctx, x, y, asked, i, &draws[i], &way);
        for (int l = 0; l < BLOCK; l++) {
            uint32_t pixel = (uint32_t)((y + (l >> 2)) * W + x + (l & 3));
            seen |= (uint32_t)(asked->times[i][l] > 0 && frame_sees(pixel, (u32)i)) << l;
            draws[i].r.w[l] = seen >> l & 1 ? draws[i].r.w[l] : 0;
        }
        k->shade_known(&draws[i].brings, draws[i].r.w, seen, &colour);
    }
    k->list_stand_in(ctx, x, y, draws, asked->most, asked->n, &shown);
    k->list_resample(ctx, x, y, draws, asked->most, &kept);
    for (int l = 0; l < BLOCK; l++) {
        uint32_t *pixel = out + (size_t)l * PIXEL_WORDS;
        if (!(lanes >> l & 1))
            continue;
        put_float(pixel + PIXEL_ALL, asked->all[l]);
        put_float(pixel + PIXEL_BRIGHT, asked->bright[l]);
        put_float(pixel + PIXEL_DRAWS, asked->n[l]);
        put_float(pixel + PIXEL_SHOWN, shown.w[l]);
        pixel[PIXEL_KEPT] = kept.light[l];
        put_float(pixel + PIXEL_KEPT_W, kept.w[l]);
        for (int c = 0; c < 3; c++)
            put_float(pixel + PIXEL_COLOUR + c, colour.rgb[c][l]);
        for (int i = 0; i < asked->most; i++) {
            uint32_t *ray = pixel + PIXEL_RAYS + (size_t)i * RAY_WORDS;
            if (!(asked->times[i][l] > 0))
                continue;
            ray[RAY_ENTRY] = asked->entry[i][l];
            put_float(ray + RAY_TIMES, asked->times[i][l]);
            ray[RAY_LIGHT] = draws[i].r.light[l];
            put_float(ray + RAY_U, draws[i].r.u[l]);
            put_float(ray + RAY_V, draws[i].r.v[l]);
            put_float(ray + RAY_W, draws[i].r.w[l]);
            put_float(ray + RAY_P, draws[i].r.p[l]);
            put_float(ray + RAY_WEIGHED, asked->weighed[i][l]);
        }
    }
    free(asked);
}

/* What the kernels make of the whole picture, as the shader lays it out. */
static uint32_t *answer(const trial *t, const kernels *k) {
    uint32_t *out = noc_calloc((size_t)TILES * ANSWER_WORDS, sizeof(*out));
    list_scratch *s = noc_alloc_large(1, sizeof(*s));
    struct core_context ctx = t->ctx;
    assert_true(out && s);
    ctx.at.lists = s;
    for (int number = 0; number < TILES; number++) {
        uint32_t *to = out + (size_t)number * ANSWER_WORDS, lanes[16];
        const gblock *g[16];
        priors b = { 0 };
        for (int i = 0; i < 16; i++)
            lanes[i] = lanes_with_surface(g[i] = block_of(t, number, i));
        k->list_build(&ctx, g, lanes, 16, tail_start(SEED, (u32)number, t->frame.constants.index), s);
        k->list_fill(&ctx);
        for (uint32_t i = 0, at = 0; i < s->list.count; i++, at = next_place(at, s->list.count)) {
            list_prior one = list_prior_of(s->list.weight[i], t->visibility[s->list.light[i]]);
            b.share[at] = one.share;
            b.expect[at] = one.expect;
        }
        to[ANSWER_COUNT] = s->list.count;
        to[ANSWER_COPIES] = s->list.copies;
        memcpy(to + ANSWER_LIGHT, s->list.light, s->list.count * sizeof(*to));
        memcpy(to + ANSWER_WEIGHT, s->list.weight, s->list.count * sizeof(*to));
        for (int i = 0; i < 16 && s->list.count; i++)
            answer_block(t, k, &ctx, g[i], number % TILES_X * 16 + i % 4 * 4, number / TILES_X * 16 + i / 4 * 4, &b,
                         to + ANSWER_PIXELS + (size_t)i * 16 * PIXEL_WORDS);
    }
    free(s);
    return out;
}

enum { LISTS, WEIGHTS, SUMS, DRAWS, CHOICE, PLACES, RAY_WEIGHTS, COLOURS, PARTS };
static const char *const part_names[PARTS] = { "lights of lists",     "weights of entries",
                                               "sums over entries",   "numbers of draws",
                                               "chosen rays",         "places on lights",
                                               "weights and targets", "light" };

static int part_of(size_t word) {
    if (word < ANSWER_PIXELS)
        return word < ANSWER_WEIGHT ? LISTS : WEIGHTS;
    size_t in = (word - ANSWER_PIXELS) % PIXEL_WORDS;
    if (in < PIXEL_RAYS)
        return in >= PIXEL_COLOUR                        ? COLOURS
               : in == PIXEL_ALL || in == PIXEL_BRIGHT   ? SUMS
               : in == PIXEL_DRAWS                       ? DRAWS
               : in == PIXEL_KEPT_W || in == PIXEL_SHOWN ? RAY_WEIGHTS
                                                         : CHOICE;
    in = (in - PIXEL_RAYS) % RAY_WORDS;
    return in < RAY_U ? CHOICE : in < RAY_W ? PLACES : RAY_WEIGHTS;
}

static float as_float(uint32_t bits) {
    float x;
    memcpy(&x, &bits, sizeof(x));
    return x;
}

/* Says which words differ and by how much; returns their share of all. */
static double differences(const char *what, const uint32_t *have, const uint32_t *want) {
    size_t count[PARTS] = { 0 }, all = 0;
    double most[PARTS] = { 0 };
    for (size_t i = 0; i < (size_t)TILES * ANSWER_WORDS; i++) {
        int part = part_of(i % ANSWER_WORDS);
        double a = as_float(have[i]), b = as_float(want[i]);
        if (have[i] == want[i] || (fabs(a) < 1.2e-38 && fabs(b) < 1.2e-38 && part != LISTS && part != CHOICE))
            continue;
        count[part]++;
        all++;
        most[part] = fmax(most[part], fabs(a - b) / fmax(fabs(b), 1e-30));
    }
    for (int i = 0; i < PARTS; i++)
        if (count[i])
            print_message("# %s: %zu %s differ, by %.3g of themselves at most\n", what, count[i], part_names[i],
                          most[i]);
    print_message("# %s: %zu of %zu words differ\n", what, all, (size_t)TILES * ANSWER_WORDS);
    return (double)all / ((double)TILES * ANSWER_WORDS);
}

/* The comparison would be worth nothing over empty lists and pixels without rays. repeats: whether lists hold each of
 * their lights several times. */
static void expect_alive(const uint32_t *a, bool repeats) {
    size_t entries = 0, drawn = 0, rays = 0, blocked = 0;
    for (int number = 0; number < TILES; number++) {
        const uint32_t *t = a + (size_t)number * ANSWER_WORDS;
        entries += t[ANSWER_COUNT];
        assert_int_equal(t[ANSWER_COPIES] > 1, repeats);
        for (uint32_t i = 0; i < t[ANSWER_COUNT]; i++)
            drawn += as_float(t[ANSWER_WEIGHT + i]) != 1;
        for (int i = 0; i < 256 * 16; i++) {
            const uint32_t *ray = t + ANSWER_PIXELS + i / 16 * PIXEL_WORDS + PIXEL_RAYS + i % 16 * RAY_WORDS;
            rays += as_float(ray[RAY_TIMES]) > 0;
            blocked += as_float(ray[RAY_TIMES]) > 0 && !(as_float(ray[RAY_W]) > 0);
        }
    }
    print_message("# %zu entries, %zu of the tails, %zu rays, %zu blocked\n", entries, drawn, rays, blocked);
    assert_true(drawn > TILES && entries > 16 * TILES && rays > 2 * 256 * TILES / 2 && blocked > rays / 5 &&
                blocked < rays / 2);
}

#if defined(HAVE_VULKAN)
static bool dispatch(vulkan_run *gpu, uint32_t what, uint32_t groups, uint32_t *words, size_t count) {
    return vulkan_compute(gpu, list_frame_spv, sizeof(list_frame_spv), &what, sizeof(what), groups, words,
                          count * sizeof(*words));
}
#endif

static void compare(const char *scene, const noc_builtin_params *of, int list, int tail, bool repeats) {
    trial t;
    make_trial(&t, scene, of, list, tail);
    const kernels *all[NOC_MAX_KERNELS];
    int tables = noc_runnable_kernels(all);
    uint32_t *want = answer(&t, all[0]);
    expect_alive(want, repeats);
    for (int i = 1; i < tables; i++) {
        uint32_t *have = answer(&t, all[i]);
        assert_true(differences(all[i]->name, have, want) == 0);
        free(have);
    }
#if defined(HAVE_VULKAN)
    vulkan_run gpu;
    uint32_t number = 0;
    for (; vulkan_open(&gpu, number); number++) {
        uint32_t *words = noc_alloc(t.count * sizeof(*words));
        assert_non_null(words);
        memcpy(words, t.words, t.count * sizeof(*words));
        bool ok = dispatch(&gpu, DISPATCH_TILES, TILES, words, t.count) &&
                  dispatch(&gpu, DISPATCH_PIXELS, 16 * TILES, words, t.count);
        print_message("# %s %s\n", gpu.device, ok ? "" : gpu.why);
        vulkan_close(&gpu);
        assert_true(ok);
        assert_int_equal(gpu.messages, 0);
        double off = differences(gpu.device, words + t.words[HEAD_ANSWER], want);
        /* others round their divisions and roots in their own way, and where a choice tips over, what follows differs
         */
        assert_true(gpu.software ? off == 0 : off < 0.02);
        free(words);
    }
    if (!number)
        print_message("# no Vulkan device: %s\n", gpu.why);
#else
    print_message("# built without Vulkan or without glslangValidator\n");
#endif
    free(want);
    free_trial(&t);
}

static void city(double size, int list, int tail) {
    noc_builtin_params of = noc_builtin_default_params();
    of.city.size = size;
    compare("city", &of, list, tail, false);
}

static void lists_with_tails(void **state) {
    (void)state;
    city(150, 16, 24);
}

static void longest_lists(void **state) {
    (void)state;
    city(150, LIST_ENTRIES, LIST_ENTRIES);
}

/* 11,000: most of the tail is below nodes that stayed closed. */
static void many_lights(void **state) {
    (void)state;
    city(600, 64, 64);
}

/* Fewer than lists have room for: they hold each of them several times. */
static void few_lights(void **state) {
    (void)state;
    noc_builtin_params of = noc_builtin_default_params();
    of.lights = 30;
    compare("mess", &of, 64, 96, true);
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(lists_with_tails), cmocka_unit_test(longest_lists),
                                        cmocka_unit_test(many_lights), cmocka_unit_test(few_lights) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
