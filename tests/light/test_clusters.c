/* Light clusters: each light that shines is in one, and they are full even where lights face every which way. */
#include "worlds.h"

#include "light/bound.h"
#include "light/clusters.h"

static void check_cluster(const noc_scene *s, const noc_clusters *c, size_t i, uint8_t *seen) {
    const noc_cluster_block *node = &c->level[0][i / 16];
    int lane = (int)(i % 16);
    for (int j = 0; j < NOC_CLUSTER_LIGHTS; j++) {
        if (!c->lights[i].shine[j])
            continue;
        uint32_t id = c->lights[i].id[j];
        assert_true(id < s->lights.len);
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
            noc_clusters *c = noc_clusters_create(s, NULL, NULL);
            assert_non_null(c);
            uint8_t *seen = calloc(lights, 1);
            size_t shining = 0;
            for (size_t i = 0; i < c->count; i++)
                check_cluster(s, c, i, seen);
            for (uint32_t i = 0; i < lights; i++) {
                bool shines = noc_light_intensity(&s->lights.data[i]) > 0;
                assert_int_equal(seen[i], shines);
                shining += shines;
            }
            /* Small ones are left at the end, in each direction that lights face. */
            assert_true(c->count <= shining / 11 + 16);
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
    noc_clusters *a = noc_clusters_create(s, NULL, NULL), *b = noc_clusters_create(s, pool, NULL);
    assert_int_equal(a->count, b->count);
    assert_memory_equal(a->lights, b->lights, a->count * sizeof(*a->lights));
    noc_clusters_destroy(a);
    noc_clusters_destroy(b);
    noc_pool_destroy(pool);
    noc_scene_destroy(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_light_is_in_one),
        cmocka_unit_test(threads_make_the_same),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
