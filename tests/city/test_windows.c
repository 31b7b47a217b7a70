/* Windows on walls: what is merged, what is left out, and that no window leaves its wall. */
#include "city/windows/parts.h"
#include "../test.h"

#include <math.h>

#define MOST 4096
#define assert_close(a, b, tolerance) assert_true(fabs((double)(a) - (double)(b)) <= (tolerance))

typedef struct walls {
    wall_triangle t[MOST];
    size_t count;
} walls;

/* A wall from a to b, seen from its right hand side, from height z0 to z1 at a and z2 at b. */
static void add(walls *w, const double a[2], const double b[2], double z0, double z1, double z2) {
    const double p[4][3] = { { a[0], a[1], z0 }, { b[0], b[1], z0 }, { b[0], b[1], z2 }, { a[0], a[1], z1 } };
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 3; k++)
            memcpy(w->t[w->count + (size_t)i].p[k], p[k ? k + i : 0], sizeof(p[0]));
    w->count += 2;
}

static void front(walls *w, double x0, double x1, double z0, double z1) {
    add(w, (double[]){ x0, 0 }, (double[]){ x1, 0 }, z0, z1, z1);
}

/* What the file says of the use decides, whatever the id. */
static void test_uses(void **state) {
    (void)state;
    walls w = { .count = 0 };
    front(&w, 0, 60, 100, 130); /* wide and high: half of such buildings are offices where nothing is told */
    noc_window_params p = noc_window_default_params();
    for (int i = 0; i < 40; i++) {
        char id[16];
        snprintf(id, sizeof(id), "b%d", i);
        for (int use = NOC_USE_FLATS; use < NOC_USE_COUNT; use++) {
            city_windows out = { 0 };
            assert_int_equal(city_windows_make(id, (noc_building_use)use, w.t, w.count, &p, NULL, SIZE_MAX, &out),
                             NOC_OK);
            size_t kinds[NOC_WINDOW_KIND_COUNT] = { 0 }, never = 0;
            for (size_t k = 0; k < out.list.len; k++) {
                kinds[out.list.data[k].kind]++;
                never += out.list.data[k].level >= 1;
            }
            bool office = use == NOC_USE_OFFICES || use == NOC_USE_SHOPS;
            assert_int_equal(out.verdicts.data[0], use == NOC_USE_BARE ? NOC_WALL_BARE : NOC_WALL_TAKEN);
            assert_int_equal(kinds[NOC_WINDOW_OFFICE] > 0, office);
            assert_int_equal(kinds[NOC_WINDOW_FLAT] > 0, !office && use != NOC_USE_BARE);
            assert_int_equal(never, use == NOC_USE_DARK ? out.list.len : 0);
            if (use == NOC_USE_SHOPS || use == NOC_USE_MIXED)
                assert_true(kinds[NOC_WINDOW_SHOP] > 0);
            else if (use != NOC_USE_OFFICES)
                assert_int_equal(kinds[NOC_WINDOW_SHOP], 0);
            city_windows_free(&out);
        }
    }
}

/* Neither shops nor offices: they have rules of their own. */
static const char *home(double height, double width) {
    static char id[16];
    for (int i = 0;; i++) {
        snprintf(id, sizeof(id), "home%d", i);
        building_use use = city_building_use(id, NOC_USE_UNKNOWN, height, width);
        if (!use.shops && !use.offices)
            return id;
    }
}

static city_windows make_as(const char *id, const walls *w, const noc_window_params *p, const city_cover *cover) {
    city_windows out = { 0 };
    assert_int_equal(city_windows_make(id, NOC_USE_UNKNOWN, w->t, w->count, p, cover, SIZE_MAX, &out), NOC_OK);
    assert_int_equal(out.verdicts.len, w->count);
    return out;
}

static city_windows make(const walls *w, const noc_window_params *p) {
    return make_as(home(6, 10), w, p ? p : &noc_window_default_params(), NULL);
}

static size_t count_of(const walls *w) {
    city_windows out = make(w, NULL);
    size_t n = out.list.len;
    city_windows_free(&out);
    return n;
}

static void test_grid(void **state) {
    (void)state;
    walls w = { .count = 0 };
    front(&w, 0, 10, 100, 106.5); /* four cells of 2.4 m, two storeys of 3 m */
    city_windows out = make(&w, NULL);
    assert_int_equal(out.list.len, 8);
    assert_int_equal(out.facades.len, 1);
    assert_int_equal(out.facades.data[0].verdict, NOC_WALL_TAKEN);
    double left = INFINITY, right = -INFINITY;
    for (size_t i = 0; i < 8; i++) {
        const city_window *v = &out.list.data[i];
        left = fmin(left, v->corner[0]);
        right = fmax(right, v->corner[0] + v->edge_u[0]);
        assert_close(v->corner[1], -.03, 1e-9); /* before the wall, which faces -y */
        assert_close(v->edge_u[0], 1.2, 1e-9);
        assert_close(v->edge_v[2], 1.4, 1e-9);
        assert_close(v->corner[2], 100 + 3 * v->storey + .896, 1e-9);
    }
    assert_close(left + right, 10, 1e-9); /* centred */
    city_windows_free(&out);
}

/* Wall of 10 m by 6.5 m in short pieces has the windows of one of one piece. */
static void test_pieces(void **state) {
    (void)state;
    walls w = { .count = 0 };
    for (int i = 0; i < 20; i++)
        front(&w, .5 * i, .5 * (i + 1), 100, 106.5);
    assert_int_equal(count_of(&w), 8);
    w.count = 0; /* pieces that share parts of their edges */
    for (int i = 0; i < 10; i++) {
        front(&w, i, i + 1, 100, 102.2 + .1 * (i % 3));
        front(&w, i, i + 1, 102.2 + .1 * (i % 3), 106.5);
    }
    assert_int_equal(count_of(&w), 8);
    w.count = 0; /* a joint at the third of a long edge */
    front(&w, 0, 10, 100, 103.2);
    front(&w, 0, 3.3, 103.2, 106.5);
    front(&w, 3.3, 10, 103.2, 106.5);
    assert_int_equal(count_of(&w), 8);
    w.count = 0; /* gaps of 2 cm, which surveys leave */
    for (int i = 0; i < 5; i++)
        front(&w, 2 * i + .01, 2 * i + 1.99, 100, 106.5);
    assert_int_equal(count_of(&w), 8);
    w.count = 0; /* of pieces that would have three columns by themselves */
    front(&w, 0, 4, 100, 106.5);
    front(&w, 4.02, 10, 100, 106.5);
    assert_int_equal(count_of(&w), 8);
    w.count = 0; /* but not of half a metre, in which a window would hang */
    for (int i = 0; i < 5; i++)
        front(&w, 2 * i + .25, 2 * i + 1.75, 100, 106.5);
    assert_int_equal(count_of(&w), 0);
}

/* A wall that is given twice is one, and its windows are not lit through each other. */
static void test_doubles(void **state) {
    (void)state;
    walls w = { .count = 0 };
    front(&w, 0, 10, 100, 106.5);
    front(&w, 0, 10, 100, 106.5);
    assert_int_equal(count_of(&w), 8);
    w.count = 0; /* half of it twice does not make a whole */
    front(&w, 0, 5, 100, 106.5);
    front(&w, 0, 5, 100, 106.5);
    w.t[w.count++] = (wall_triangle){ { { 5, 0, 100 }, { 10, 0, 100 }, { 5, 0, 106.5 } } };
    assert_true(count_of(&w) < 8);
}

static void test_shapes(void **state) {
    (void)state;
    walls w = { .count = 0 };
    /* a gable: none but in the middle of its upper part */
    front(&w, 0, 10, 100, 103);
    w.t[w.count++] = (wall_triangle){ { { 0, 0, 103 }, { 10, 0, 103 }, { 5, 0, 109 } } };
    city_windows out = make(&w, NULL);
    size_t above = 0;
    for (size_t i = 0; i < out.list.len; i++)
        above += out.list.data[i].storey == 1;
    assert_int_equal(out.list.len - above, 4);
    assert_int_equal(above, 2);
    city_windows_free(&out);
    w.count = 0; /* a door's hole in the middle, ground floor */
    front(&w, 0, 4, 100, 106.5);
    front(&w, 6, 10, 100, 106.5);
    front(&w, 4, 6, 102.5, 106.5);
    assert_int_equal(count_of(&w), 8 - 2);
    w.count = 0; /* an edge that slants: the top is 106.5 at one end and 100.5 at the other */
    add(&w, (double[]){ 0, 0 }, (double[]){ 10, 0 }, 100, 106.5, 100.5);
    size_t slanted = count_of(&w);
    assert_true(slanted >= 2 && slanted < 6);
    w.count = 0; /* too small */
    front(&w, 0, 3, 100, 103);
    out = make(&w, NULL);
    assert_int_equal(out.list.len, 0);
    assert_int_equal(out.verdicts.data[0], NOC_WALL_SMALL);
    city_windows_free(&out);
    w.count = 0; /* a roof that is called a wall */
    w.t[w.count++] = (wall_triangle){ { { 0, 0, 100 }, { 20, 0, 100 }, { 10, 15, 115 } } };
    out = make(&w, NULL);
    assert_int_equal(out.list.len, 0);
    assert_int_equal(out.verdicts.data[0], NOC_WALL_TILTED);
    city_windows_free(&out);
}

/* A round tower in facets of a metre: each alone is too narrow. */
static void test_curved(void **state) {
    (void)state;
    walls w = { .count = 0 };
    const int sides = 48;
    const double radius = sides / (2 * M_PI);
    for (int i = 0; i < sides; i++) {
        double a[2][2];
        for (int k = 0; k < 2; k++) {
            a[k][0] = radius * cos(2 * M_PI * (i + k) / sides);
            a[k][1] = radius * sin(2 * M_PI * (i + k) / sides);
        }
        add(&w, a[0], a[1], 0, 7, 7);
    }
    city_windows out = make(&w, NULL);
    assert_int_equal(out.facades.len, 1);
    assert_in_range(out.list.len, 36, 40); /* 48 m are 20 cells, on two storeys; one may be lost where it is cut */
    for (size_t i = 0; i < out.list.len; i++)
        for (int c = 0; c < 4; c++) { /* before the wall, and not far */
            const city_window *v = &out.list.data[i];
            double x = v->corner[0] + (c & 1) * v->edge_u[0] + (c >> 1) * v->edge_v[0],
                   y = v->corner[1] + (c & 1) * v->edge_u[1] + (c >> 1) * v->edge_v[1];
            assert_true(hypot(x, y) > radius * cos(M_PI / sides) && hypot(x, y) < radius + .15);
            assert_true(v->corner[0] * v->edge_u[1] - v->corner[1] * v->edge_u[0] > 0); /* faces out */
        }
    city_windows_free(&out);
}

static city_cover *cover_of(const walls *w) {
    float xyz[9 * 64];
    assert_true(w->count <= 64);
    for (size_t i = 0; i < 9 * w->count; i++)
        xyz[i] = (float)w->t[i / 9].p[i % 9 / 3][i % 3];
    city_cover *cover = city_cover_create(xyz, w->count, NULL);
    assert_non_null(cover);
    return cover;
}

static void test_party(void **state) {
    (void)state;
    walls own = { .count = 0 }, all = { .count = 0 };
    front(&own, 0, 10, 100, 106.5);
    const double distance[] = { 0, .02, .8, 3 };
    for (int i = 0; i < 4; i++) {
        all = own;
        add(&all, (double[]){ 20, -distance[i] }, (double[]){ -10, -distance[i] }, 90, 120, 120); /* faces ours */
        city_cover *cover = cover_of(&all);
        city_windows out = make_as(home(6, 10), &own, &noc_window_default_params(), cover);
        bool open = distance[i] > WINDOW_PARTY_M;
        assert_int_equal(out.list.len, open ? 8 : 0);
        assert_int_equal(out.verdicts.data[0], open ? NOC_WALL_TAKEN : NOC_WALL_PARTY);
        city_windows_free(&out);
        city_cover_destroy(cover);
    }
    for (double reach = 100; reach < 1e6; reach *= 10) /* oblique walls, however long, where they are near, and not */
        for (int near = 0; near < 2; near++) {
            const double y = near ? -.5 : -8;
            all = own;
            add(&all, (double[]){ reach, y - .01 * reach }, (double[]){ -reach, y + .01 * reach }, 90, 120, 120);
            city_cover *cover = cover_of(&all);
            city_windows out = make_as(home(6, 10), &own, &noc_window_default_params(), cover);
            assert_int_equal(out.list.len, near ? 0 : 8);
            city_windows_free(&out);
            city_cover_destroy(cover);
        }
    all = own; /* a lower neighbour hides the lower storey */
    add(&all, (double[]){ 20, 0 }, (double[]){ -10, 0 }, 90, 103, 103);
    city_cover *cover = cover_of(&all);
    city_windows out = make_as(home(6, 10), &own, &noc_window_default_params(), cover);
    assert_int_equal(out.list.len, 4);
    for (size_t i = 0; i < out.list.len; i++)
        assert_int_equal(out.list.data[i].storey, 1);
    city_windows_free(&out);
    city_cover_destroy(cover);
    cover = cover_of(&own); /* its own wall hides nothing */
    out = make_as(home(6, 10), &own, &noc_window_default_params(), cover);
    assert_int_equal(out.list.len, 8);
    city_windows_free(&out);
    city_cover_destroy(cover);
}

/* A small generator, the same everywhere. */
static double next(uint64_t *s) {
    *s = *s * 6364136223846793005u + 1442695040888963407u;
    return (double)(*s >> 11) * 0x1p-53;
}

/* Pieces of a wall of 14 m by 11 m with a gable and holes, cut at random; turned about z and moved. */
static double random_wall(walls *w, uint64_t *s) {
    double turn = 2 * M_PI * next(s), x[9], z[7];
    w->count = 0;
    x[0] = z[0] = 0;
    for (int i = 1; i < 9; i++)
        x[i] = x[i - 1] + .3 + 3 * next(s);
    for (int i = 1; i < 7; i++)
        z[i] = z[i - 1] + .3 + 3 * next(s);
    for (int i = 0; i < 8; i++)
        for (int j = 0; j < 6; j++) {
            if (next(s) < .15)
                continue;
            double a[2] = { x[i] * cos(turn), x[i] * sin(turn) }, b[2] = { x[i + 1] * cos(turn), x[i + 1] * sin(turn) };
            add(w, a, b, z[j], z[j + 1], next(s) < .2 ? z[j] + .1 : z[j + 1]);
        }
    return turn;
}

static double side(const double a[2], const double b[2], const double p[2]) {
    return ((b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])) / hypot(b[0] - a[0], b[1] - a[1]);
}

/* Is a place of the turned wall, along and up, on one of its triangles, or within a gap's half of one? */
static bool on_wall(const walls *w, double turn, const double p[2]) {
    for (size_t i = 0; i < w->count; i++) {
        double q[3][2];
        for (int k = 0; k < 3; k++) {
            q[k][0] = w->t[i].p[k][0] * cos(turn) + w->t[i].p[k][1] * sin(turn);
            q[k][1] = w->t[i].p[k][2];
        }
        bool in = true;
        for (int k = 0; k < 3; k++)
            in = in && side(q[k], q[(k + 1) % 3], p) >= -WINDOW_GAP_MM / 2000 - 1e-6;
        if (in)
            return true;
    }
    return false;
}

static void test_inside(void **state) {
    (void)state;
    uint64_t s = 5;
    size_t windows = 0;
    for (int round = 0; round < 200; round++) {
        walls w;
        double turn = random_wall(&w, &s);
        city_windows out = make_as(home(12, 20), &w, &noc_window_default_params(), NULL);
        windows += out.list.len;
        for (size_t i = 0; i < out.list.len; i++) {
            const city_window *v = &out.list.data[i];
            for (int k = 0; k < 60; k++) {
                double a = next(&s), b = next(&s), p[3];
                for (int j = 0; j < 3; j++)
                    p[j] = v->corner[j] + a * v->edge_u[j] + b * v->edge_v[j];
                assert_true(on_wall(&w, turn, (double[]){ p[0] * cos(turn) + p[1] * sin(turn), p[2] }));
            }
        }
        city_windows_free(&out);
    }
    assert_true(windows > 500);
}

static int compare_windows(const void *a, const void *b) { return memcmp(a, b, sizeof(city_window)); }

/* Whatever the order of the polygons: the same windows, to the bit. */
static void test_order(void **state) {
    (void)state;
    uint64_t s = 9;
    for (int round = 0; round < 20; round++) {
        walls w;
        random_wall(&w, &s);
        city_windows a = make_as("b", &w, &noc_window_default_params(), NULL);
        for (size_t i = w.count - 1; i > 0; i--) {
            size_t j = (size_t)(next(&s) * (double)(i + 1));
            wall_triangle t = w.t[i];
            w.t[i] = w.t[j];
            w.t[j] = t;
        }
        city_windows b = make_as("b", &w, &noc_window_default_params(), NULL);
        assert_int_equal(a.list.len, b.list.len);
        if (a.list.len) {
            qsort(a.list.data, a.list.len, sizeof(*a.list.data), compare_windows);
            qsort(b.list.data, b.list.len, sizeof(*b.list.data), compare_windows);
            assert_memory_equal(a.list.data, b.list.data, a.list.len * sizeof(*a.list.data));
        }
        city_windows_free(&a);
        city_windows_free(&b);
    }
}

/* Shares by use, and that what is lit does not depend on what else there is. */
static void test_levels(void **state) {
    (void)state;
    walls w = { .count = 0 };
    front(&w, 0, 240, 0, 60);
    const char *id = home(60, 240);
    city_windows out = make_as(id, &w, &noc_window_default_params(), NULL);
    size_t lit = 0;
    for (size_t i = 0; i < out.list.len; i++) {
        const city_window *v = &out.list.data[i];
        double y = .2126 * v->emission[0] + .7152 * v->emission[1] + .0722 * v->emission[2];
        lit += v->level < .35f;
        assert_true(v->level >= 0 && v->level < 1 && y > 0 && y < 64);
    }
    assert_int_equal(out.list.len, 2000);
    assert_close((double)lit, 700, 75);
    walls two = w; /* a second facade elsewhere moves none of the first */
    add(&two, (double[]){ 240, 0 }, (double[]){ 240, 80 }, 0, 60, 60);
    city_windows more = make_as(id, &two, &noc_window_default_params(), NULL);
    size_t same = 0;
    for (size_t i = 0; i < more.list.len; i++)
        for (size_t k = 0; k < out.list.len; k++)
            same +=
                more.list.data[i].hash == out.list.data[k].hash && more.list.data[i].level == out.list.data[k].level;
    assert_true(same >= out.list.len);
    city_windows_free(&out);
    city_windows_free(&more);
}

static int by_size(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* cd/m2 of a facade of that use; storey: of these windows alone, where it is not negative. The number of windows. */
static size_t luminances(noc_building_use use, int storey, double *y) {
    static walls w;
    w.count = 0;
    front(&w, 0, 1200, 0, 60);
    city_windows out = { 0 };
    size_t n = 0;
    assert_int_equal(city_windows_make("h", use, w.t, w.count, &noc_window_default_params(), NULL, SIZE_MAX, &out),
                     NOC_OK);
    for (size_t i = 0; i < out.list.len; i++) {
        const float *e = out.list.data[i].emission;
        if (storey < 0 || out.list.data[i].storey == storey)
            y[n++] = .2126 * e[0] + .7152 * e[1] + .0722 * e[2];
    }
    city_windows_free(&out);
    qsort(y, n, sizeof(*y), by_size);
    return n;
}

static double mean_of(const double *y, size_t n) {
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += y[i];
    return sum / (double)n;
}

/* Exposure tables (ANSI PH2.7): homes EV 5 to 7, through glass 3 to 12 cd/m2, behind a curtain 1 to 7; shops and
 * offices EV 7 to 8, 16 to 32 cd/m2, and bright displays twice that. */
static void test_luminances(void **state) {
    (void)state;
    static double y[20000];
    size_t n = luminances(NOC_USE_FLATS, -1, y);
    print_message("# %zu flats: mean %.1f cd/m2, %.1f %.1f %.1f at 16, 50, 84 %%\n", n, mean_of(y, n), y[n * 16 / 100],
                  y[n / 2], y[n * 84 / 100]);
    assert_true(n > 5000 && y[n / 2] > 5 && y[n / 2] < 7.5);
    assert_close(y[n * 16 / 100], 1.6, .1); /* the most by a closed curtain: the figures of docs/defaults.md */
    assert_close(y[n * 84 / 100], 20, 1);
    assert_close(mean_of(y, n), 10, .5);
    n = luminances(NOC_USE_OFFICES, 3, y);
    assert_true(n > 200 && y[n / 2] > 16 && y[n / 2] < 32);
    n = luminances(NOC_USE_SHOPS, 0, y);
    assert_true(n > 100 && y[n / 2] > 16 && y[n / 2] < 64);
}

static void test_no_memory(void **state) {
    (void)state;
    walls w;
    uint64_t s = 11;
    random_wall(&w, &s);
    bool done = false;
    for (uint64_t n = 1; !done; n++) {
        city_windows out = { 0 };
        noc_refuse_allocation(n, false);
        noc_status status =
            city_windows_make("b", NOC_USE_UNKNOWN, w.t, w.count, &noc_window_default_params(), NULL, SIZE_MAX, &out);
        done = noc_allocations() < n;
        noc_refuse_allocation(0, false);
        assert_int_equal(status, done ? NOC_OK : NOC_ERR_MEMORY);
        city_windows_free(&out);
    }
}

/* Where many walls stand close to one another, as many are looked at as is allowed; windows after those are left out,
 * and their facades are counted. */
static void test_crowded(void **state) {
    (void)state;
    enum { BEHIND = 30 };
    walls own = { .count = 0 }, all;
    front(&own, 0, 60, 100, 106.5);
    all = own;
    for (int i = 0; i < BEHIND; i++)
        add(&all, (double[]){ -10, 2 + .05 * i }, (double[]){ 70, 2 + .05 * i }, 90, 120, 120);
    city_cover *cover = cover_of(&all);
    city_windows unbounded = make_as(home(6, 60), &own, &noc_window_default_params(), cover);
    size_t whole = unbounded.list.len, last = 0;
    city_windows_free(&unbounded);
    assert_int_equal(whole, 2 * 25);
    /* 5 rays a window look at 62 triangles, in up to four cells */
    for (size_t looks = 0; looks <= 20 * 62 * whole; looks += 62 * whole) {
        city_windows out = { 0 };
        assert_int_equal(city_windows_make(home(6, 60), NOC_USE_UNKNOWN, own.t, own.count, &noc_window_default_params(),
                                           cover, looks, &out),
                         NOC_OK);
        assert_int_equal(out.crowded, out.list.len < whole);
        assert_true(looks ? out.list.len >= last && out.list.len >= looks / (20 * 62) : !out.list.len);
        assert_int_equal(out.verdicts.data[0], out.list.len ? NOC_WALL_TAKEN : NOC_WALL_PARTY);
        last = out.list.len;
        city_windows_free(&out);
    }
    assert_int_equal(last, whole);
    city_cover_destroy(cover);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_grid),    cmocka_unit_test(test_pieces),     cmocka_unit_test(test_doubles),
        cmocka_unit_test(test_shapes),  cmocka_unit_test(test_curved),     cmocka_unit_test(test_party),
        cmocka_unit_test(test_uses),    cmocka_unit_test(test_inside),     cmocka_unit_test(test_order),
        cmocka_unit_test(test_levels),  cmocka_unit_test(test_luminances), cmocka_unit_test(test_no_memory),
        cmocka_unit_test(test_crowded),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
