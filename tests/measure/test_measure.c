/* Readings: closed forms of meters, rasters that are the same however they are cut, and their files. */
static char folder[] = "/tmp/nocturne-measureXXXXXX";
#include "../folder.h"
#include "../memory.h"
#include "../render/rooms.h"
#include "../told.h"

#include "import/map/gdal.h"

#include <nocturne/measure.h>

#define HIGH 3.0
#define CANDELA (10000 / (4 * M_PI))

/* A lamp of 10,000 lm that shines evenly, 3 m over a floor that is seen from above; what lies in `cover` over it. */
static noc_scene *lit_floor(bool cover, noc_log *log) {
    noc_scene *s = noc_scene_create(log);
    int road =
        noc_scene_add_material(s, &(noc_material){ .albedo = { 0, 0, 0 }, .roughness = 1, .cls = NOC_CLASS_ROAD });
    int car = noc_scene_add_material(s, &(noc_material){
                                            .albedo = { .5f, .5f, .5f }, .roughness = 1, .cls = NOC_CLASS_VEHICLE });
    int roof =
        noc_scene_add_material(s,
                               &(noc_material){ .albedo = { .5f, .5f, .5f }, .roughness = 1, .cls = NOC_CLASS_ROOF });
    add_floor(s, road, 0, 0, 0, 100);
    if (cover) {
        add_floor(s, car, 10.5, 0.5, 1, 1.5);   /* x 9 to 12, y -1 to 2 */
        add_floor(s, roof, -10.5, 0.5, 5, 1.5); /* x -12 to -9 */
    }
    point_light(s, 0, 0, HIGH, (float)CANDELA);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    return s;
}

static const noc_render_params dark = { NOC_RENDER_DEFAULTS(NOC_DEFAULT_IN_C) };

static noc_measure_params without_sky(noc_render_params *render) {
    *render = dark;
    render->sky = 0;
    noc_measure_params p = noc_measure_default_params();
    p.render = render;
    return p;
}

/* Kind of CIE 171's tests of direct light. A point's light is known to the last sample: its error is 0. */
static void a_lamp_by_its_distance(void **state) {
    (void)state;
    static const double want[] = { 88.42, 75.49, 50.93, 31.26, 19.10, 12.04 };
    noc_meter meters[6];
    noc_reading readings[6];
    noc_render_params render;
    noc_measure_params params = without_sky(&render);
    noc_measure_info info;
    for (int i = 0; i < 6; i++)
        meters[i] = (noc_meter){ .place = { i, 0, 0.0001 }, .normal = { 0, 0, 2 } };
    noc_scene *s = lit_floor(false, NULL);
    noc_view *v = own_view(s, 2, NULL);
    assert_int_equal(noc_measure_points(v, meters, 6, &params, NULL, readings, &info), NOC_OK);
    for (int i = 0; i < 6; i++) {
        assert_true(fabs(readings[i].lux - want[i]) < 1e-3 * want[i]);
        assert_true(readings[i].error < 1e-4 * want[i] && readings[i].share == 1);
    }
    assert_true(info.readings == 6 && info.short_of_it == 0);
    close_view(v);
    noc_scene_destroy(s);
}

/* Of one lamp: (1 + cos a) sin e I / (pi d2), sin e I / (pi d2), (1 + cos e) I / (4 d2), each by many normals. */
static void other_responses(void **state) {
    (void)state;
    const double at[3] = { 4, 3, 1.5 }, up = HIGH - at[2], flat = 5, d2 = flat * flat + up * up;
    const double sine = flat / sqrt(d2), cosine = up / sqrt(d2), faces = 0.4; /* rad from the lamp's azimuth */
    const double toward = atan2(-at[1], -at[0]);
    const double want[NOC_RESPONSE_COUNT] = { CANDELA * sine * cos(faces) / d2,
                                              (1 + cos(faces)) * sine * CANDELA / (M_PI * d2),
                                              sine * CANDELA / (M_PI * d2), (1 + cosine) * CANDELA / (4 * d2) };
    noc_render_params render;
    noc_measure_params params = without_sky(&render);
    params.error = 1e-3;
    noc_scene *s = lit_floor(false, NULL);
    noc_view *v = own_view(s, 2, NULL);
    for (int r = 0; r < NOC_RESPONSE_COUNT; r++) {
        noc_meter meter = { .place = { at[0], at[1], at[2] },
                            .normal = { cos(toward + faces), sin(toward + faces), 0 },
                            .response = (noc_response)r };
        noc_reading reading;
        assert_int_equal(noc_measure_points(v, &meter, 1, &params, NULL, &reading, NULL), NOC_OK);
        assert_true(fabs(reading.lux - want[r]) < 2e-3 * want[r]);
    }
    close_view(v);
    noc_scene_destroy(s);
}

static noc_raster *raster_of(const noc_scene *s, int threads, const double extent[4], double step,
                             noc_measure_info *info) {
    noc_raster_params p = noc_raster_default_params();
    noc_render_params render;
    noc_measure_params params = without_sky(&render);
    memcpy(p.extent, extent, sizeof(p.extent));
    p.step = step;
    p.height = 0;
    noc_view *v = own_view(s, threads, NULL);
    noc_raster *r = noc_measure_raster(v, &p, &params, NULL, info);
    close_view(v);
    return r;
}

/* Mean over a pixel, by a fine sum. */
static double lux_over(double x, double y, double step) {
    enum { FINE = 64 };
    double sum = 0;
    for (int i = 0; i < FINE * FINE; i++) {
        double u = x + (i % FINE + 0.5) / FINE * step, w = y + (i / FINE + 0.5) / FINE * step;
        double d2 = u * u + w * w + HIGH * HIGH;
        sum += CANDELA * HIGH / (d2 * sqrt(d2));
    }
    return sum / (FINE * FINE);
}

/* Every pixel is its area's mean, what is covered has no number, and all of it is the flux that comes down. */
static void a_raster_is_means_of_areas(void **state) {
    (void)state;
    noc_measure_info info;
    noc_scene *s = lit_floor(true, NULL);
    noc_raster *r = raster_of(s, 2, (const double[]){ -12, -4, 13.9, 6 }, 2, &info);
    assert_non_null(r);
    assert_true(r->width == 13 && r->height == 5 && r->west == -12 && r->north == 6 && !r->wkt);
    double flux = 0, want = 0;
    for (int i = 0; i < r->width * r->height; i++) {
        double x = r->west + i % r->width * r->step, y = r->north - (i / r->width + 1) * r->step;
        bool covered = (x == 10 || x == -12) && y == 0;
        if (covered) {
            assert_true(isnan(r->lux[i]) && isnan(r->error[i]) && r->share[i] == 0);
            continue;
        }
        if (x > 6 || x < -8) /* part of it is covered, or lies in a shadow */
            continue;
        double mean = lux_over(x, y, r->step);
        assert_true(fabs(r->lux[i] - mean) < 5 * r->error[i] + 1e-4 * mean);
        assert_true(r->share[i] == 1);
        flux += r->lux[i] * r->step * r->step;
        want += mean * r->step * r->step;
    }
    assert_true(fabs(flux - want) < 0.01 * want);
    noc_raster_destroy(r);
    noc_scene_destroy(s);
}

/* On open ground, lit by the sky and one lamp, the share of pixels beyond three stated errors, over seeds, by bands.
 * The sky gives all of them as much: the mean of what the lamp does not give. */
static void errors_hold_on_dark_ground(void **state) {
    (void)state;
    enum { SEEDS = 6, SIDE = 64, AREA = SIDE * SIDE };
    static const double bands[] = { 0, 0.03, 0.05, 0.2, 2, 1e9 };
    static float lux[SEEDS][AREA], error[SEEDS][AREA];
    static double lamp[AREA];
    noc_scene *s = lit_floor(false, NULL);
    noc_raster_params p = noc_raster_default_params();
    memcpy(p.extent, (const double[]){ 0, 0, 96, 96 }, sizeof(p.extent));
    p.step = 1.5;
    p.height = 0;
    double sky = 0;
    for (int i = 0; i < AREA; i++)
        lamp[i] = lux_over(i % SIDE * p.step, (SIDE - 1 - i / SIDE) * p.step, p.step);
    for (int seed = 0; seed < SEEDS; seed++) {
        noc_render_params render = dark;
        noc_measure_params params = noc_measure_default_params();
        params.render = &render;
        render.seed = (uint32_t)seed;
        noc_view *v = own_view(s, 2, NULL);
        noc_raster *r = noc_measure_raster(v, &p, &params, NULL, NULL);
        assert_true(r && r->width == SIDE && r->height == SIDE);
        memcpy(lux[seed], r->lux, sizeof(lux[seed]));
        memcpy(error[seed], r->error, sizeof(error[seed]));
        for (int i = 0; i < AREA; i++)
            sky += lamp[i] < 0.1 ? (r->lux[i] - lamp[i]) / SEEDS : 0;
        noc_raster_destroy(r);
        close_view(v);
    }
    double dim = 0;
    for (int i = 0; i < AREA; i++)
        dim += lamp[i] < 0.1;
    sky /= dim;
    for (size_t b = 0; b + 1 < sizeof(bands) / sizeof(*bands); b++) {
        double in = 0, beyond = 0, squares = 0;
        for (int k = 0; k < SEEDS * AREA; k++) {
            double want = lamp[k % AREA] + sky, off = fabs(lux[k / AREA][k % AREA] - want);
            bool here = want >= bands[b] && want < bands[b + 1];
            in += here;
            squares += here ? off * off / pow(error[k / AREA][k % AREA], 2) : 0;
            beyond += here && off > 3 * error[k / AREA][k % AREA];
        }
        print_message("# from %g lx: %.0f pixels, %.2f %% beyond three errors, %.2f errors off (rms)\n", bands[b], in,
                      100 * beyond / fmax(in, 1), sqrt(squares / fmax(in, 1)));
        if (in > 1000)
            assert_true(beyond <= 0.02 * in);
    }
    noc_scene_destroy(s);
}

/* A pixel of the lattice is the same in every raster that has it. */
static void cuts_and_threads_change_nothing(void **state) {
    (void)state;
    noc_scene *s = lit_floor(true, NULL);
    noc_raster *whole = raster_of(s, 3, (const double[]){ -40, -40, 40, 40 }, 1, NULL);
    noc_raster *part = raster_of(s, 1, (const double[]){ -7, -30, 33, 9 }, 1, NULL);
    assert_true(whole && part && part->width == 40 && part->height == 39);
    for (int y = 0; y < part->height; y++)
        for (int x = 0; x < part->width; x++) {
            int i = y * part->width + x, at = (y + 31) * whole->width + x + 33;
            assert_memory_equal(&part->lux[i], &whole->lux[at], sizeof(float));
            assert_memory_equal(&part->error[i], &whole->error[at], sizeof(float));
        }
    noc_raster_destroy(whole);
    noc_raster_destroy(part);
    noc_scene_destroy(s);
}

static void figures_of_readings(void **state) {
    (void)state;
    const float lux[] = { 4, NAN, 1, 10 }, share[] = { 1, 0, 0.5f, 0.5f };
    noc_lux_figures f;
    assert_int_equal(noc_lux_figures_of(lux, share, 4, &f, NULL), NOC_OK);
    assert_true(f.readings == 3 && f.least == 1 && f.most == 10 && f.median == 4 && f.low == 1 && f.high == 10);
    assert_true(f.mean == (4 + 0.5 + 5) / 2 && f.uniformity == 1 / f.mean);
    assert_int_equal(noc_lux_figures_of(lux, NULL, 4, &f, NULL), NOC_OK);
    assert_true(f.mean == 5);
    assert_int_equal(noc_lux_figures_of(lux + 1, NULL, 1, &f, NULL), NOC_OK);
    assert_true(f.readings == 0 && isnan(f.mean) && isnan(f.uniformity));
}

/* ---- the least ---- */

/* A street's mile of bare lamps of many sizes, whose light at a place is a sum; each frame draws few of them. */
enum { LAMPS = 400, PLACES = 1024, SEEDS = 60 };
typedef struct avenue {
    double at[LAMPS][3], candela[LAMPS];
    noc_meter meters[PLACES];
    double least, mean; /* of the places, by the sum */
} avenue;

static noc_scene *avenue_of(avenue *a) {
    noc_scene *s = noc_scene_create(NULL);
    int road =
        noc_scene_add_material(s,
                               &(noc_material){ .albedo = { .1f, .1f, .1f }, .roughness = 1, .cls = NOC_CLASS_ROAD });
    uint32_t state = 1;
    add_floor(s, road, 0, 0, 0, 200);
    for (int i = 0; i < LAMPS; i++) {
        double u[4];
        for (int k = 0; k < 4; k++)
            u[k] = (double)((state = state * 1664525u + 1013904223u) >> 8) * 0x1p-24;
        a->candela[i] = 50 * pow(60, u[3]);
        a->at[i][0] = 160 * u[0] - 80;
        a->at[i][1] = 160 * u[1] - 80;
        a->at[i][2] = 4 + 8 * u[2];
        point_light(s, a->at[i][0], a->at[i][1], a->at[i][2], (float)a->candela[i]);
    }
    a->least = INFINITY;
    a->mean = 0;
    for (int m = 0; m < PLACES; m++) {
        int patch = m / 256, x = patch % 2 * 40 + m % 16, y = patch / 2 * 40 + m / 16 % 16;
        const double p[2] = { 0.7 * x - 20, 0.7 * y - 20 };
        double lux = 0;
        a->meters[m] = (noc_meter){ .place = { p[0], p[1], 0.001 }, .normal = { 0, 0, 1 } };
        for (int i = 0; i < LAMPS; i++) {
            double d[3] = { a->at[i][0] - p[0], a->at[i][1] - p[1], a->at[i][2] - 0.001 };
            lux += a->candela[i] * d[2] / pow(d[0] * d[0] + d[1] * d[1] + d[2] * d[2], 1.5);
        }
        a->least = fmin(a->least, lux);
        a->mean += lux / PLACES;
    }
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    return s;
}

/* A figure over the seeds: its mean's distance from the truth in standard errors of the mean, and how many are within
 * three stated ones. */
static double off(const double *value, double want) {
    double sum = 0, squares = 0;
    for (int i = 0; i < SEEDS; i++) {
        sum += value[i] / SEEDS;
        squares += value[i] * value[i] / SEEDS;
    }
    return (sum - want) / sqrt((squares - sum * sum) / (SEEDS - 1));
}

static int within(const double *value, const double *error, double want) {
    int n = 0;
    for (int i = 0; i < SEEDS; i++)
        n += fabs(value[i] - want) <= 3 * error[i];
    return n;
}

/* The least of noisy readings is that of their noise; that of noc_measure_least is the field's. */
static void the_least_is_not_that_of_the_noise(void **state) {
    (void)state;
    static avenue a;
    static noc_reading readings[PLACES];
    double noisy[SEEDS], least[SEEDS], error[SEEDS], uo[SEEDS], uo_error[SEEDS];
    int between = 0, resolved = 0;
    noc_scene *s = avenue_of(&a);
    noc_view *v = own_view(s, 2, NULL);
    for (int seed = 0; seed < SEEDS; seed++) {
        noc_render_params render;
        noc_measure_params params = without_sky(&render);
        noc_measure_info info;
        noc_lux_least l;
        render.seed = (uint32_t)seed;
        render.draws = 1;
        params.error = 1;
        assert_int_equal(noc_measure_points(v, a.meters, PLACES, &params, NULL, readings, &info), NOC_OK);
        params.error = 0.01;
        assert_int_equal(noc_measure_least(v, a.meters, PLACES, readings, &info, &params, NULL, &l), NOC_OK);
        noisy[seed] = INFINITY;
        for (int i = 0; i < PLACES; i++)
            noisy[seed] = fmin(noisy[seed], readings[i].lux);
        least[seed] = l.lux;
        error[seed] = l.error;
        uo[seed] = l.uniformity;
        uo_error[seed] = l.uniformity_error;
        between += l.low <= a.least && a.least <= l.high;
        resolved += l.candidates == 1;
        assert_true(l.low <= l.high && l.candidates >= 1);
    }
    double want = a.least / a.mean;
    print_message("# least %g lx, Uo %g: readings %.1f, least %+.2f, Uo %+.2f errors of their means off; within three: "
                  "%d, %d; between: %d; resolved: %d of %d; last %g +- %g\n",
                  a.least, want, off(noisy, a.least), off(least, a.least), off(uo, want), within(least, error, a.least),
                  within(uo, uo_error, want), between, resolved, SEEDS, least[0], error[0]);
    assert_true(off(noisy, a.least) < -10);
    assert_true(fabs(off(least, a.least)) <= 3 && fabs(off(uo, want)) <= 3);
    assert_true(within(least, error, a.least) * 20 >= SEEDS * 19 && within(uo, uo_error, want) * 20 >= SEEDS * 19);
    assert_true(between * 20 >= SEEDS * 19);
    close_view(v);
    noc_scene_destroy(s);
}

/* Four sides from z0 to z1, and a lid and a floor where it has them. */
static void add_box(noc_scene *s, int material, double x, double half, double z0, double z1, bool lid, bool floor) {
    double w = 2 * half, h = z1 - z0, l = x - half, r = x + half;
    QUAD(s, material, l, -half, z0, w, 0, 0, 0, 0, h);
    QUAD(s, material, r, -half, z0, 0, w, 0, 0, 0, h);
    QUAD(s, material, r, half, z0, -w, 0, 0, 0, 0, h);
    QUAD(s, material, l, half, z0, 0, -w, 0, 0, 0, h);
    if (lid)
        QUAD(s, material, l, -half, z1, w, 0, 0, 0, w, 0);
    if (floor)
        QUAD(s, material, l, half, z0, w, 0, 0, 0, -w, 0);
}

/* Ground in a pole, in a trunk without a lid that ends in its crown, and under a car is left out and known as such;
 * ground under the crown, under a lamp's head and beside a pole is not. */
static void what_stands_there_is_left_out(void **state) {
    (void)state;
    static const double xy[][2] = { { 0, 0 }, { 0, 0.3 }, { 10, 0.02 }, { 10, 0.8 }, { 20, 0 }, { 30, 0 }, { 500, 0 } };
    static const bool open[] = { false, true, false, true, true, false, false };
    noc_scene *s = noc_scene_create(NULL);
    int of[4];
    const noc_class classes[] = { NOC_CLASS_ROAD, NOC_CLASS_LAMP, NOC_CLASS_TREE, NOC_CLASS_VEHICLE };
    for (int i = 0; i < 4; i++)
        of[i] =
            noc_scene_add_material(s,
                                   &(noc_material){ .roughness = 1, .albedo = { .1f, .1f, .1f }, .cls = classes[i] });
    add_floor(s, of[0], 0, 0, 0, 100);
    add_box(s, of[1], 0, 0.1, 0, 8, true, false);
    add_box(s, of[2], 10, 0.1, 0, 3, false, false);
    add_box(s, of[2], 10, 1, 2.6, 5, true, true);
    add_box(s, of[1], 20, 0.3, 8, 8.2, true, true);
    add_box(s, of[3], 30, 1, 0.2, 1.5, true, true);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_view *v = own_view(s, 1, NULL);
    noc_hit hits[7];
    assert_int_equal(noc_view_cast_down(v, xy, 7, 1u << NOC_CLASS_ROAD, hits), NOC_OK);
    for (int i = 0; i < 7; i++)
        assert_true(hits[i].hit == open[i] && (hits[i].material == of[0]) == (i < 6));
    noc_region *r =
        noc_region_find(v, s, "polygon:POLYGON((-1 -1,1 -1,1 1,-1 1,-1 -1))", &(noc_region_params){ 0 }, NULL);
    noc_region_info info;
    noc_region_get_info(r, &info);
    print_message("# %zu points, %zu in the pole\n", info.patches, info.left_out);
    assert_true(info.left_out >= 1 && info.left_out < 0.03 * (double)info.patches);
    noc_region_destroy(r);
    close_view(v);
    noc_scene_destroy(s);
}

static void what_makes_no_sense_is_refused(void **state) {
    (void)state;
    noc_log *log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_WARN, .message = keep });
    noc_scene *s = lit_floor(false, log);
    noc_view *v = own_view(s, 1, log);
    noc_reading r;
    const noc_meter flat = { .normal = { 0, 0, 0 } }, away = { .place = { NAN, 0, 0 }, .normal = { 0, 0, 1 } };
    const noc_meter half = { .normal = { 0, 0, 1 }, .response = NOC_RESPONSE_SEMICYLINDER };
    noc_measure_params p = noc_measure_default_params();
    noc_raster_params raster = noc_raster_default_params();
    assert_int_equal(noc_measure_points(v, &flat, 1, NULL, NULL, &r, NULL), NOC_ERR_ARGUMENT);
    assert_int_equal(noc_measure_points(v, &away, 1, NULL, NULL, &r, NULL), NOC_ERR_ARGUMENT);
    assert_int_equal(noc_measure_points(v, &half, 1, NULL, NULL, &r, NULL), NOC_ERR_ARGUMENT);
    p.samples = 7;
    assert_int_equal(noc_measure_points(v, &flat, 1, &p, NULL, &r, NULL), NOC_ERR_ARGUMENT);
    memcpy(raster.extent, (const double[]){ 0, 0, 1e6, 1e6 }, sizeof(raster.extent));
    assert_null(noc_measure_raster(v, &raster, NULL, NULL, NULL)); /* 1e12 pixels */
    raster = noc_raster_default_params();
    raster.crs = "EPSG:25832";
    assert_null(noc_measure_raster(v, &raster, NULL, NULL, NULL)); /* the scene lies nowhere */
    assert_non_null(strstr(told, "faces nowhere"));
    assert_non_null(strstr(told, "a smaller extent, or larger pixels"));
    assert_non_null(strstr(told, "has no CRS"));
    close_view(v);
    noc_scene_destroy(s);
    noc_log_destroy(log);
}

static bool stop(void *user, const char *what, double done) {
    (void)user;
    (void)what;
    return done < 0.5;
}

static void it_can_be_stopped(void **state) {
    (void)state;
    noc_scene *s = lit_floor(false, NULL);
    noc_view *v = own_view(s, 1, NULL);
    noc_raster_params raster = noc_raster_default_params();
    memcpy(raster.extent, (const double[]){ -64, -64, 64, 64 }, sizeof(raster.extent));
    assert_null(noc_measure_raster(v, &raster, NULL, &(noc_progress){ stop, NULL }, NULL));
    close_view(v);
    noc_scene_destroy(s);
}

/* Each allocation, once: no raster and one error, or the same raster. */
static void memory_is_refused(void **state) {
    (void)state;
    noc_log *log = counting_log();
    noc_scene *s = lit_floor(false, log);
    noc_view *v = own_view(s, 1, log);
    noc_raster_params p = noc_raster_default_params();
    memcpy(p.extent, (const double[]){ 0, 0, 4, 4 }, sizeof(p.extent));
    noc_raster *good = noc_measure_raster(v, &p, NULL, NULL, NULL);
    assert_non_null(good);
    uint64_t refused = 0;
    for (uint64_t n = 1;; n++) {
        begin_refusal(n, false);
        noc_raster *r = noc_measure_raster(v, &p, NULL, NULL, NULL);
        bool reached = end_refusal();
        refused += !r;
        if (r)
            assert_memory_equal(r->lux, good->lux, 16 * sizeof(float));
        else
            assert_int_equal(refusing.errors, 1);
        noc_raster_destroy(r);
        if (!reached)
            break;
    }
    assert_true(refused >= 5);
    noc_raster_destroy(good);
    close_view(v);
    noc_scene_destroy(s);
    noc_log_destroy(log);
}

#if NOC_HAVE_GDAL
/* What GDAL reads of a file is what was written. */
static void a_geotiff_has_place_units_and_numbers(void **state) {
    (void)state;
    noc_scene *s = noc_scene_create(NULL);
    int road =
        noc_scene_add_material(s,
                               &(noc_material){ .albedo = { .1f, .1f, .1f }, .roughness = 1, .cls = NOC_CLASS_ROAD });
    assert_int_equal(noc_scene_set_crs(s, "EPSG:25832", (double[3]){ 678000, 5403000, 0 }), NOC_OK);
    add_floor(s, road, 0, 0, 0, 30);
    point_light(s, 0, 0, HIGH, (float)CANDELA);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_raster *r = raster_of(s, 1, (const double[]){ 677990, 5402990, 678050, 5403010 }, 1, NULL);
    assert_non_null(r);
    assert_non_null(r->wkt);
    const char *const items[][2] = { { "NOCTURNE_SKY_CD_M2", "0" }, { NULL, NULL } };
    const char *path = in_folder("lux.tif");
    assert_int_equal(noc_raster_write(r, path, items, NULL), NOC_OK);
    assert_null(gdal_load());
    GDALDatasetH d = gdal.GDALOpenEx(path, GDAL_OF_RASTER, NULL, NULL, NULL);
    assert_non_null(d);
    double place[6];
    assert_int_equal(gdal.GDALGetGeoTransform(d, place), CE_None);
    assert_true(place[0] == 677990 && place[1] == 1 && place[3] == 5403010 && place[5] == -1);
    assert_string_equal(gdal.OSRGetAuthorityCode(gdal.GDALGetSpatialRef(d), NULL), "25832");
    assert_int_equal(gdal.GDALGetRasterCount(d), 3);
    float lux[60 * 20];
    GDALRasterBandH band = gdal.GDALGetRasterBand(d, 1);
    assert_string_equal(gdal.GDALGetRasterUnitType(band), "lx");
    assert_true(isnan(gdal.GDALGetRasterNoDataValue(band, NULL)));
    assert_int_equal(gdal.GDALRasterIO(band, GF_Read, 0, 0, 60, 20, lux, 60, 20, GDT_Float32, 0, 0), CE_None);
    assert_memory_equal(lux, r->lux, sizeof(lux));
    assert_true(isnan(lux[59]) && lux[10 * 60 + 10] > 80); /* beyond the floor; under the lamp */
    gdal.GDALClose(d);
    noc_raster_destroy(r);
    noc_scene_destroy(s);
}
#endif

static int make_folder(void **state) {
    (void)state;
    return mkdtemp(folder) ? 0 : -1;
}

static int leave_folder(void **state) {
    (void)state;
    return remove_folder();
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_lamp_by_its_distance),
        cmocka_unit_test(other_responses),
        cmocka_unit_test(a_raster_is_means_of_areas),
        cmocka_unit_test(errors_hold_on_dark_ground),
        cmocka_unit_test(cuts_and_threads_change_nothing),
        cmocka_unit_test(figures_of_readings),
        cmocka_unit_test(the_least_is_not_that_of_the_noise),
        cmocka_unit_test(what_stands_there_is_left_out),
        cmocka_unit_test(what_makes_no_sense_is_refused),
        cmocka_unit_test(it_can_be_stopped),
        cmocka_unit_test(memory_is_refused),
#if NOC_HAVE_GDAL
        cmocka_unit_test(a_geotiff_has_place_units_and_numbers),
#endif
    };
    return cmocka_run_group_tests(tests, make_folder, leave_folder);
}
