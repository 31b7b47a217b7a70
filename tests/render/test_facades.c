/* Windows that lie in walls, without triangles: pictures of them are those of windows that have some. */
#include "views.h"

#include "scene/facade.h"

enum { COLUMNS = 4, ROWS = 3, SHOP = 0 }; /* the first two cells of the lowest row are a shop's */

typedef struct opening {
    double x, z, width, height; /* m, from the wall's corner */
    bool lit;
} opening;

/* Windows of cells of 3 m by 3 m. */
static size_t openings(opening out[COLUMNS * ROWS]) {
    size_t n = 0;
    out[n++] = (opening){ 0.3, 0.3, 5.4, 1.8, true };
    for (int i = 2; i < COLUMNS * ROWS; i++)
        out[n++] = (opening){ 3 * (i % COLUMNS) + 0.9, 3 * (i / COLUMNS) + 0.9, 1.2, 1.4, i % 3 == 0 };
    return n;
}

static const double corner[3] = { -6, 5, 0 };

static noc_light shape_of(const opening *o) {
    return (noc_light){ .kind = NOC_LIGHT_PARALLELOGRAM,
                        .position = { corner[0] + o->x, corner[1], corner[2] + o->z },
                        .edge_u = { o->width },
                        .edge_v = { 0, 0, o->height } };
}

static void add_pane(noc_scene *s, int mesh, const opening *o, const uint32_t *triangles, uint32_t facade) {
    noc_pane p = { .triangles = triangles,
                   .triangle_count = triangles ? 2 : 0,
                   .shape = shape_of(o),
                   .window = { .level = o->lit ? 0.f : 1.f, .often = NOC_WINDOW_OFTEN, .facade = facade } };
    for (int k = 0; k < 3; k++)
        p.window.emission[k] = 40.f - 10.f * (float)k;
    assert_true(!facade || noc_scene_facade_takes(s, facade, &p.shape));
    assert_true(noc_scene_add_window(s, mesh, &p));
    assert_true(!facade || !noc_scene_facade_takes(s, facade, &p.shape));
}

static int glass(noc_scene *s) {
    return noc_scene_add_material(
        s, &(noc_material){ .albedo = { .04f, .04f, .05f }, .f0 = .04f, .roughness = .3f, .cls = NOC_CLASS_WINDOW });
}

static int plaster(noc_scene *s) {
    return noc_scene_add_material(s, &(noc_material){
                                         .albedo = { .5f, .45f, .4f }, .roughness = 1, .cls = NOC_CLASS_WALL });
}

static noc_scene *street_before(int *wall, int *pane) {
    noc_scene *s = noc_scene_create(NULL);
    *wall = plaster(s);
    *pane = glass(s);
    add_floor(s, matte(s, 0.3f), 0, 0, 0, 24);
    return s;
}

static void finish(noc_scene *s) {
    noc_light lamp = {
        .kind = NOC_LIGHT_SPHERE, .position = { 3, -2, 6 }, .radius = .2, .emission = { 900, 700, 400 }
    };
    noc_window_params params = noc_window_default_params();
    noc_scene_light_windows(s, &params);
    assert_true(noc_scene_add_light(s, &lamp) >= 0);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
}

/* The wall is one surface, and its windows cells of a facade. */
static noc_scene *in_wall(int *mesh) {
    opening o[COLUMNS * ROWS];
    int wall, pane;
    size_t count = openings(o);
    noc_scene *s = street_before(&wall, &pane);
    *mesh = (int)s->meshes.len;
    QUAD(s, wall, corner[0], corner[1], corner[2], 3 * COLUMNS, 0, 0, 0, 0, 3 * ROWS);
    noc_facade f = { .origin = { corner[0], corner[1], corner[2] }, .along = { 3 }, .up = { 0, 0, 3 } };
    f.columns = COLUMNS;
    f.rows = ROWS;
    f.material = pane;
    f.mesh = *mesh;
    uint32_t facade = noc_scene_add_facade(s, &f);
    assert_int_equal(facade, 1);
    assert_true(noc_scene_reserve_walls(s));
    const noc_scene_mesh *m = &s->meshes.data[*mesh];
    for (uint32_t t = m->first_triangle; t < m->first_triangle + m->triangle_count; t++)
        s->triangle_facade.data[t] = facade;
    for (size_t i = 0; i < count; i++)
        add_pane(s, *mesh, &o[i], NULL, facade);
    noc_light beyond = shape_of(&(opening){ 11.5, 7, 2, 1, false });
    assert_false(noc_scene_facade_takes(s, facade, &beyond));
    finish(s);
    return s;
}

static int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The wall is cut around its windows, which have two triangles each. */
static noc_scene *cut_out(void) {
    opening o[COLUMNS * ROWS];
    int wall, pane;
    size_t count = openings(o), xs = 0, zs = 0;
    double x[2 * COLUMNS * ROWS + 2] = { 0, 3 * COLUMNS }, z[2 * COLUMNS * ROWS + 2] = { 0, 3 * ROWS };
    noc_scene *s = street_before(&wall, &pane);
    for (xs = zs = 2; (xs - 2) / 2 < count; xs += 2, zs += 2) {
        const opening *at = &o[(xs - 2) / 2];
        x[xs] = at->x;
        x[xs + 1] = at->x + at->width;
        z[zs] = at->z;
        z[zs + 1] = at->z + at->height;
    }
    qsort(x, xs, sizeof(*x), compare);
    qsort(z, zs, sizeof(*z), compare);
    for (size_t i = 0; i + 1 < xs; i++)
        for (size_t j = 0; j + 1 < zs; j++) {
            double mx = (x[i] + x[i + 1]) / 2, mz = (z[j] + z[j + 1]) / 2;
            bool open = x[i + 1] - x[i] < 1e-9 || z[j + 1] - z[j] < 1e-9;
            for (size_t k = 0; k < count; k++)
                open = open || (mx > o[k].x && mx < o[k].x + o[k].width && mz > o[k].z && mz < o[k].z + o[k].height);
            if (!open)
                QUAD(s, wall, corner[0] + x[i], corner[1], corner[2] + z[j], x[i + 1] - x[i], 0, 0, 0, 0,
                     z[j + 1] - z[j]);
        }
    for (size_t k = 0; k < count; k++) {
        int mesh = (int)s->meshes.len;
        QUAD(s, pane, corner[0] + o[k].x, corner[1], corner[2] + o[k].z, o[k].width, 0, 0, 0, 0, o[k].height);
        add_pane(s, mesh, &o[k], (const uint32_t[]){ 0, 1 }, 0);
    }
    finish(s);
    return s;
}

static noc_camera before(void) { return look(-2, -9, 2, 0, 5, 4, 60); }

/* Pixels that differ, but for those on an edge of a window: triangles of two scenes are met at other roundings. */
static int differing(const noc_image *a, const noc_image *b) {
    int n = 0;
    for (int i = 0; i < N; i++) {
        bool same = true;
        for (int k = 0; k < 3; k++)
            same = same && fabsf(a->rgb[3 * i + k] - b->rgb[3 * i + k]) <= 1e-3f * (1e-3f + a->rgb[3 * i + k]);
        n += !same;
    }
    return n;
}

static double mean_of(const noc_image *image) {
    double sum = 0;
    for (int i = 0; i < 3 * N; i++)
        sum += image->rgb[i];
    return sum / (3 * N);
}

/* The same lights, the same surfaces, the same numbers drawn: the same pictures, in every method. */
static void pictures_are_those_of_triangles(void **state) {
    (void)state;
    static const struct {
        noc_method method;
        noc_candidates candidates;
    } ways[] = {
        { NOC_METHOD_REFERENCE, NOC_CANDIDATES_UNIFORM }, { NOC_METHOD_IS, NOC_CANDIDATES_POWER },
        { NOC_METHOD_RIS, NOC_CANDIDATES_UNIFORM },       { NOC_METHOD_RIS, NOC_CANDIDATES_LISTS },
        { NOC_METHOD_RESTIR, NOC_CANDIDATES_LIGHT_BVH },
    };
    int mesh;
    noc_camera c = before();
    noc_scene *a = in_wall(&mesh), *b = cut_out();
    assert_true(a->triangle_light.len + 22 < b->triangle_light.len);
    for (size_t i = 0; i < NOC_COUNT(ways); i++) {
        noc_render_params p = with(ways[i].method, ways[i].candidates, 0);
        noc_view *of_cells = rendered(a, &c, &p, 3, 2), *of_triangles = rendered(b, &c, &p, 3, 2);
        noc_image *one = noc_view_image(of_cells), *other = noc_view_image(of_triangles);
        int n = differing(one, other);
        print_message("# way %zu: %d of %d pixels differ, means %g and %g\n", i, n, N, mean_of(one), mean_of(other));
        assert_true(n <= N / 50 && fabs(mean_of(one) / mean_of(other) - 1) < 0.01 && mean_of(one) > 0.1);
        noc_image_destroy(one);
        noc_image_destroy(other);
        close_view(of_cells);
        close_view(of_triangles);
    }
    noc_scene_destroy(a);
    noc_scene_destroy(b);
}

static void views_tell_windows(void **state) {
    (void)state;
    int mesh, windows = 0, walls = 0;
    noc_camera c = before();
    noc_scene *s = in_wall(&mesh);
    noc_render_params p = with(NOC_METHOD_RIS, NOC_CANDIDATES_LISTS, 1u << NOC_AOV_CLASS | 1u << NOC_AOV_OBJECT);
    noc_view *v = rendered(s, &c, &p, 1, 1);
    noc_channel *cls = view(v, NOC_AOV_CLASS), *object = view(v, NOC_AOV_OBJECT);
    for (int i = 0; i < N; i++) {
        windows += cls->value[i] == NOC_CLASS_WINDOW;
        walls += cls->value[i] == NOC_CLASS_WALL;
        assert_true((object->value[i] == mesh) ==
                    (cls->value[i] == NOC_CLASS_WINDOW || cls->value[i] == NOC_CLASS_WALL));
    }
    assert_true(windows > 20 && walls > 100);
    noc_channel_destroy(cls);
    noc_channel_destroy(object);
    close_view(v);
    noc_scene_destroy(s);
}

/* Middles of windows and places just beyond their edges. */
static void rays_meet_windows(void **state) {
    (void)state;
    opening o[COLUMNS * ROWS];
    int mesh;
    size_t count = openings(o);
    noc_scene *s = in_wall(&mesh);
    noc_view *v = own_view(s, 1, NULL);
    for (size_t i = 0; i < count; i++)
        for (int beyond = 0; beyond < 2; beyond++) {
            double x = corner[0] + o[i].x + (beyond ? o[i].width + .01 : o[i].width / 2);
            noc_ray ray = { { x, 0, o[i].z + .1 }, { 0, 1, 0 }, INFINITY };
            noc_hit hit;
            assert_int_equal(noc_view_cast(v, &ray, 1, &hit), NOC_OK);
            assert_true(hit.hit && fabs(hit.place[1] - 5) < 1e-5 && hit.object == mesh);
            assert_int_equal(hit.cls, beyond ? NOC_CLASS_WALL : NOC_CLASS_WINDOW);
            assert_int_equal(hit.light, beyond ? -1 : (int)i);
            assert_int_equal(hit.shines, !beyond && o[i].lit);
        }
    close_view(v);
    noc_scene_destroy(s);
}

/* They are switched where they are, and go with their wall. */
static void windows_follow_edits(void **state) {
    (void)state;
    int mesh;
    noc_camera c = before();
    noc_scene *s = in_wall(&mesh);
    noc_scene_info info;
    noc_render_params p = with(NOC_METHOD_RIS, NOC_CANDIDATES_UNIFORM, 0);
    noc_window_params dark = noc_window_default_params();
    noc_view *v = rendered(s, &c, &p, 2, 1);
    noc_image *lit = noc_view_image(v);
    dark.lit_windows = 0;
    assert_int_equal(noc_scene_set_windows(s, &dark), NOC_OK);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    assert_int_equal(noc_view_render(v, &c, &p, NULL), NOC_OK);
    noc_image *out = noc_view_image(v);
    assert_true(mean_of(out) < 0.8 * mean_of(lit) && mean_of(out) > 0);
    noc_scene_get_info(s, &info);
    assert_int_equal(info.windows, COLUMNS * ROWS - 1);
    size_t lights = info.lights;

    assert_int_equal(noc_scene_remove_mesh(s, mesh), NOC_OK);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_scene_get_info(s, &info);
    assert_int_equal(info.windows, 0);
    assert_int_equal(info.lights, lights - (COLUMNS * ROWS - 1));
    assert_int_equal(noc_view_render(v, &c, &p, NULL), NOC_OK);
    noc_ray ray = { { 0, 0, 2 }, { 0, 1, 0 }, INFINITY };
    noc_hit hit;
    assert_int_equal(noc_view_cast(v, &ray, 1, &hit), NOC_OK);
    assert_false(hit.hit);
    noc_image_destroy(lit);
    noc_image_destroy(out);
    close_view(v);
    noc_scene_destroy(s);
}

/* Another name for another window, the same for the same. */
static void contents_are_told_apart(void **state) {
    (void)state;
    char key[3][NOC_CONTENT_KEY];
    int mesh;
    noc_scene *a = in_wall(&mesh), *b = in_wall(&mesh);
    noc_scene_content(a, key[0]);
    noc_scene_content(b, key[1]);
    b->lights.data[1].a[0] += 0.1f;
    noc_scene_content(b, key[2]);
    assert_string_equal(key[0], key[1]);
    assert_string_not_equal(key[1], key[2]);
    noc_scene_destroy(a);
    noc_scene_destroy(b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pictures_are_those_of_triangles),
        cmocka_unit_test(views_tell_windows),
        cmocka_unit_test(rays_meet_windows),
        cmocka_unit_test(windows_follow_edits),
        cmocka_unit_test(contents_are_told_apart),
    };
    return cmocka_run_group_tests_name("render/facades", tests, NULL, NULL);
}
