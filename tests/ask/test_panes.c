/* Walls behind panes: a pane before a wall does not darken what is told of the wall. */
#include "../render/rooms.h"

#include "scene/region.h"
#include "scene/region_panes.h"

#include <nocturne/influence.h>

enum { WALL = 1u << NOC_CLASS_WALL, WINDOW = 1u << NOC_CLASS_WINDOW };

#define SIDE(m, px, py, pz, ax, ay, az, bx, by, bz)                                                                    \
    named_quad(s, m, "house", (double[3]){ px, py, pz }, (double[3]){ ax, ay, az }, (double[3]){ bx, by, bz })

enum { PANES = 40 }; /* of 2.24 m2 */
#define PANE 2.24

/* A wall of 24 m by 12 m that faces a lamp, with rows of panes, the first three of which are turned a little, as before
 * a curved wall; a pane that looks the other way, and one 2 m before the wall. */
static noc_scene *house(bool panes) {
    noc_scene *s = noc_scene_create(NULL);
    int wall = grey_of(s, NOC_CLASS_WALL), glass = grey_of(s, NOC_CLASS_WINDOW);
    SIDE(wall, -12, 0, 0, 24, 0, 0, 0, 0, 12);
    for (int i = 0; i < PANES && panes; i++) {
        double x = -11 + 2.3 * (i % 10), z = 0.8 + 3 * (i / 10);
        double turn = i < 3 ? 0.15 : 0;
        SIDE(glass, x, -0.03 - 1.6 * sin(turn), z, 1.6 * cos(turn), 1.6 * sin(turn), 0, 0, 0, 1.4);
    }
    if (panes) {
        SIDE(glass, 11, -0.05, 10, -1, 0, 0, 0, 0, 1);
        SIDE(glass, 30, -2, 5, 1, 0, 0, 0, 0, 1);
    }
    point_light(s, -4, -7, 6, 900);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    return s;
}

static noc_region *region_of(const noc_scene *s, uint32_t classes) {
    noc_region *r = noc_region_create(NULL);
    assert_int_equal(noc_region_add_object(r, s, "house", classes), NOC_OK);
    return r;
}

static double area_of(const noc_region *r) {
    noc_region_info i;
    noc_region_get_info(r, &i);
    return i.weight;
}

static double lux_of(const noc_scene *s, uint32_t classes, double *error) {
    noc_view *view = own_view(s, 1, NULL);
    noc_region *region = region_of(s, classes);
    noc_render_params p = noc_render_default_params();
    p.sky = 0;
    noc_ranking *ranking = noc_ranking_create(view, region, &(noc_ranking_params){ .render = &p });
    noc_influence_sum sum;
    assert_int_equal(noc_ranking_refine(ranking, &(noc_ranking_target){ .error = 0.002 }, NULL), NOC_OK);
    assert_int_equal(noc_ranking_get(ranking, NULL, 0, NULL, &sum), NOC_OK);
    *error = sum.lux.error;
    noc_ranking_destroy(ranking);
    noc_region_destroy(region);
    close_view(view);
    return sum.lux.value;
}

/* Over the wall without panes, in closed form: a lamp's I d / r^3, summed. */
static double lux_of_bare_wall(void) {
    enum { N = 400 };
    double sum = 0;
    for (int i = 0; i < N; i++)
        for (int k = 0; k < N; k++) {
            double x = -12 + 24 * (i + .5) / N + 4, z = 12 * (k + .5) / N - 6;
            sum += 900 * 7 / pow(x * x + 49 + z * z, 1.5);
        }
    return sum / (N * N);
}

/* What a planner asks of a facade: the panes are a part of it. A few per mil are shaded by panes that stand before it.
 */
static void panes_do_not_darken_a_wall(void **state) {
    (void)state;
    noc_scene *bare = house(false), *glazed = house(true);
    double e[3], want = lux_of_bare_wall(), without = lux_of(bare, WALL, &e[0]), with = lux_of(glazed, WALL, &e[1]);
    double both = lux_of(glazed, WALL | WINDOW, &e[2]);
    print_message("# %.3f lx in closed form, %.3f without panes, %.3f with, %.3f of walls and panes\n", want, without,
                  with, both);
    assert_true(fabs(without - want) < 4 * e[0]);
    assert_true(fabs(with - want) < 0.02 * want + 4 * e[1]);
    assert_true(fabs(both - want) < 0.02 * want + 4 * e[2]);
    noc_scene_destroy(bare);
    noc_scene_destroy(glazed);
}

static void areas_are_those_of_the_wall(void **state) {
    (void)state;
    noc_scene *s = house(true);
    noc_region *wall = region_of(s, WALL), *window = region_of(s, WINDOW), *both = region_of(s, 0);
    double panes = area_of(window), covered = PANES * PANE - 3 * PANE * (1 - cos(0.15));
    assert_true(fabs(area_of(wall) - 288) < 1e-3 * 288);
    assert_true(fabs(panes - PANES * PANE - 2) < 1e-3 * panes);
    assert_true(fabs(area_of(both) - panes - (288 - covered)) < 1e-3 * 288);
    size_t out = 0;
    for (size_t i = 0; i < wall->patches.len; i++) {
        const noc_patch *p = &wall->patches.data[i];
        out += p->p[1] < -0.03f;
        assert_true(p->material == wall->patches.data[0].material && p->n[1] < -0.999f && p->p[1] > -0.4f);
    }
    assert_true(out >= 2 * PANES);
    for (size_t i = 0; i < both->patches.len; i++) /* none of the wall's is behind a pane */
        assert_true(noc_patch_class(&both->patches.data[i], s) == NOC_CLASS_WINDOW || both->patches.data[i].p[1] == 0);
    noc_region_destroy(wall);
    noc_region_destroy(window);
    noc_region_destroy(both);
    noc_scene_destroy(s);
}

/* The image of a wall goes on over its pieces. */
static void pieces_lie_where_they_lay_in_the_image(void **state) {
    (void)state;
    noc_region *to = noc_region_create(NULL);
    noc_patch wall = { .u = { 4, 0, 0 },
                       .v = { 1, 0, 3 },
                       .n = { 0, -1, 0 },
                       .weight = 6,
                       .textured = true,
                       .image = { 0.1f, 0.2f },
                       .image_u = { 0.5f, 0.1f },
                       .image_v = { 0, 0.6f } };
    noc_patch pane = { .p = { 1, -0.03f, 0.5f }, .u = { 1, 0, 0 }, .v = { 0, 0, 1 }, .n = { 0, -1, 0 }, .weight = .5f };
    region_panes panes = { 0 };
    assert_true(region_panes_add(&panes, &pane));
    region_panes_sort(&panes);
    assert_int_equal(region_panes_cut(&panes, &wall, to), NOC_OK);
    assert_true(to->patches.len > 4 && fabs(area_of(to) - 6) < 1e-4);
    for (size_t i = 0; i < to->patches.len; i++) {
        const noc_patch *p = &to->patches.data[i];
        double t = (double)p->p[2] / 3, u = ((double)p->p[0] - t) / 4;
        assert_true(fabs(0.1 + 0.5 * u - (double)p->image[0]) < 1e-5);
        assert_true(fabs(0.2 + 0.1 * u + 0.6 * t - (double)p->image[1]) < 1e-5);
    }
    region_panes_free(&panes);
    noc_region_destroy(to);
}

/* Long panes across one another make pieces by the square of their count: more than so many are refused. */
static void too_many_pieces_are_refused(void **state) {
    (void)state;
    noc_region *to = noc_region_create(NULL);
    noc_patch wall = { .u = { 9000, 0, 0 }, .v = { 0, 0, 9000 }, .n = { 0, -1, 0 }, .weight = 40.5e6f };
    region_panes panes = { .pieces = REGION_PIECES - 3 };
    for (int i = 0; i < 4; i++) {
        noc_patch p = { .p = { 500.f * (float)i, -0.1f, 0 }, .u = { 2, 0, 0 }, .v = { 0, 0, 900 }, .n = { 0, -1, 0 } };
        assert_true(region_panes_add(&panes, &p));
    }
    region_panes_sort(&panes);
    assert_int_equal(region_panes_cut(&panes, &wall, to), NOC_ERR_ARGUMENT);
    region_panes_free(&panes);
    noc_region_destroy(to);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(panes_do_not_darken_a_wall),
        cmocka_unit_test(areas_are_those_of_the_wall),
        cmocka_unit_test(pieces_lie_where_they_lay_in_the_image),
        cmocka_unit_test(too_many_pieces_are_refused),
    };
    return cmocka_run_group_tests_name("ask/panes", tests, NULL, NULL);
}
