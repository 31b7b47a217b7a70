/* Light clusters: each light is in one, they are full even where lights face every which way, and follow what lights
 * emit. */
#include "worlds.h"

#include "light/bound.h"
#include "light/clusters.h"

static void check_cluster(const noc_scene *s, const noc_clusters *c, size_t i, uint8_t *seen) {
    const noc_cluster_block *node = &c->level[0][i / 16];
    int lane = (int)(i % 16);
    for (int j = 0; j < NOC_CLUSTER_LIGHTS; j++) {
        uint32_t id = c->lights[i].id[j];
        if (j && id == c->lights[i].id[0])
            continue; /* a place without a light */
        assert_true(id < s->lights.len);
        assert_int_equal(c->lights[i].shine[j] >> 16 != 0, noc_light_intensity(&s->lights.data[id]) > 0);
        seen[id]++;
        noc_light_bound l = noc_bound_light(&s->lights.data[id]);
        float x = l.p[0] - node->x[lane], y = l.p[1] - node->y[lane], z = l.p[2] - node->z[lane];
        assert_true(sqrtf(x * x + y * y + z * z) + l.radius <= node->radius[lane] * 1.001f);
        if (node->cos_cone[lane] <= -1)
            continue;
        float cos = l.n[0] * node->ax[lane] + l.n[1] * node->ay[lane] + l.n[2] * node->az[lane];
        assert_true(cos >= node->cos_cone[lane] - 1e-3f);
    }
}

static void each_light_is_in_one(void **state) {
    (void)state;
    for (sort what = MIXED; what <= ALL_DARK; what++)
        for (uint32_t lights = 1; lights <= 3000; lights = lights * 3 + 1) {
            noc_scene *s = world(lights, what);
            noc_clusters *c = noc_clusters_create(s, NOC_STANDING, NULL, NULL);
            assert_non_null(c);
            uint8_t *seen = calloc(lights, 1);
            for (size_t i = 0; i < c->count; i++)
                check_cluster(s, c, i, seen);
            for (uint32_t i = 0; i < lights; i++)
                assert_int_equal(seen[i], 1);
            /* Small ones are left at the end, in each direction that lights face. */
            assert_true(c->count <= lights / 11 + 16);
            free(seen);
            noc_clusters_destroy(c);
            noc_scene_destroy(s);
        }
}

/* The same for any number of threads. */
static void threads_make_the_same(void **state) {
    (void)state;
    noc_scene *s = world(20000, MIXED);
    noc_pool *pool = noc_pool_create(3);
    noc_clusters *a = noc_clusters_create(s, NOC_STANDING, NULL, NULL),
                 *b = noc_clusters_create(s, NOC_STANDING, pool, NULL);
    assert_int_equal(a->count, b->count);
    assert_memory_equal(a->lights, b->lights, a->count * sizeof(*a->lights));
    noc_clusters_destroy(a);
    noc_clusters_destroy(b);
    noc_pool_destroy(pool);
    noc_scene_destroy(s);
}

static double power_of(const noc_clusters *c) {
    double sum = 0;
    int top = c->levels - 1;
    for (size_t i = 0; i < c->nodes[top]; i++)
        sum += c->level[top][i / 16].power[i % 16];
    return sum;
}

/* Lights that are switched: powers are those of clusters that are made of them as they are, up to rounding. */
static void switched_lights_are_followed(void **state) {
    (void)state;
    for (sort what = MIXED; what <= ALL_DARK; what++) {
        noc_scene *s = world(20000, what);
        noc_pool *pool = noc_pool_create(2);
        noc_clusters *c = noc_clusters_create(s, NOC_STANDING, pool, NULL);
        for (int round = 0; round < 4; round++) {
            for (size_t i = 0; i < s->lights.len; i++) {
                float e = round < 3 ? (float)((i * 7 + (size_t)round) % 5) * 20 : 0;
                memcpy(s->lights.data[i].e, (float[3]){ e, e, 2 * e }, sizeof(s->lights.data[i].e));
            }
            noc_clusters_relight(c, s, pool);
            noc_clusters *fresh = noc_clusters_create(s, NOC_STANDING, pool, NULL);
            uint8_t *seen = calloc(s->lights.len, 1);
            for (size_t i = 0; i < c->count; i++)
                check_cluster(s, c, i, seen);
            assert_int_equal(c->count, fresh->count);
            assert_memory_equal(c->lights, fresh->lights, c->count * sizeof(*c->lights));
            for (int level = 0; level < c->levels; level++)
                assert_memory_equal(c->level[level], fresh->level[level],
                                    (c->nodes[level] + 15) / 16 * sizeof(*c->level[level]));
            assert_true(power_of(c) > 0 || round == 3);
            free(seen);
            noc_clusters_destroy(fresh);
        }
        noc_clusters_destroy(c);
        noc_pool_destroy(pool);
        noc_scene_destroy(s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_light_is_in_one),
        cmocka_unit_test(threads_make_the_same),
        cmocka_unit_test(switched_lights_are_followed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
