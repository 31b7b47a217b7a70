/* Lamps along roads of maps: where they stand, and where they do not. */
#include "lamp_scene.h"

#include "city/roads.h"

#define MOST 12

typedef struct town {
    geo_road roads[MOST];
    double xyz[MOST][9];
    size_t count;
    double mapped[200];
    size_t mapped_count;
    noc_scene *scene;
    city_road_lamp *lamps;
    size_t found, streets;
} town;

static void begin(town *t) { *t = (town){ .scene = noc_scene_create(NULL) }; }

static geo_road *add(town *t, geo_road_class cls, double x0, double y0, double x1, double y1) {
    static const char *const ids[MOST] = { "way/1", "way/2", "way/3", "way/4",  "way/5",  "way/6",
                                           "way/7", "way/8", "way/9", "way/10", "way/11", "way/12" };
    assert_true(t->count < MOST);
    geo_road *road = &t->roads[t->count];
    *road = (geo_road){ .id = ids[t->count], .name = "", .cls = cls, .lit = GEO_LIT_YES, .width = NAN, .speed = NAN };
    double *xyz = t->xyz[t->count++];
    memcpy(xyz, (double[]){ x0, y0, NAN, x1, y1, NAN }, 6 * sizeof(*xyz));
    road->xyz = xyz;
    road->point_count = 2;
    return road;
}

static void infer_params(town *t, city_road_params params) {
    free(t->lamps);
    city_roads *roads = city_roads_create(t->roads, t->count);
    assert_non_null(roads);
    params.height = 6;
    params.mapped = t->mapped;
    params.mapped_count = t->mapped_count;
    assert_int_equal(city_road_lamps(t->scene, roads, &params, &t->lamps, &t->found, &t->streets), NOC_OK);
    city_roads_destroy(roads);
}

static size_t infer(town *t) {
    infer_params(t, (city_road_params){ 0 });
    return t->found;
}

static void end(town *t) {
    free(t->lamps);
    noc_scene_destroy(t->scene);
}

static size_t along(const town *t, const geo_road *road) {
    size_t n = 0;
    for (size_t i = 0; i < t->found; i++)
        n += t->lamps[i].road == road;
    return n;
}

/* Narrower than its lamps are high: on one side, every 24 m, and the same side however the way is drawn. */
static void one_side(void **state) {
    town t;
    double side = 0;
    for (int turned = 0; turned < 2; turned++) {
        begin(&t);
        geo_road *road = turned ? add(&t, GEO_ROAD_MINOR, 240, 0, 0, 0) : add(&t, GEO_ROAD_MINOR, 0, 0, 240, 0);
        road->name = "Main Street";
        assert_int_equal(infer(&t), 10);
        bool stands[10] = { false };
        for (size_t i = 0; i < 10; i++) {
            const city_road_lamp *l = &t.lamps[i];
            side = side != 0 ? side : l->xy[1];
            assert_true(l->xy[1] == side && fabs(fabs(side) - (5.5 / 2 + .6)) < 1e-9);
            assert_true(l->height == 6 && l->facing[0] == 0 && l->facing[1] == (side > 0 ? -1 : 1));
            int place = (int)lround((l->xy[0] - 12) / 24);
            assert_true(place >= 0 && place < 10 && !stands[place] && fabs(l->xy[0] - 12 - 24 * place) < 1e-9);
            stands[place] = true;
        }
        end(&t);
    }
}

/* Wider than that by half: by turns. Wider still: in pairs. */
static void both_sides(void **state) {
    static const struct {
        double width;
        size_t lamps, north;
    } cases[] = { { 8, 10, 5 }, { 12, 20, 10 } };
    for (size_t c = 0; c < NOC_COUNT(cases); c++) {
        town t;
        begin(&t);
        add(&t, GEO_ROAD_MINOR, 0, 0, 240, 0)->width = cases[c].width;
        assert_int_equal(infer(&t), cases[c].lamps);
        size_t north = 0;
        for (size_t i = 0; i < t.found; i++)
            north += t.lamps[i].xy[1] > 0;
        assert_int_equal(north, cases[c].north);
        end(&t);
    }
}

/* Masts of main roads are higher, and farther apart; paths have low lamps. */
static void by_class(void **state) {
    static const struct {
        geo_road_class cls;
        double height;
        size_t lamps;
    } cases[] = { { GEO_ROAD_PRIMARY, 10, 6 }, { GEO_ROAD_TERTIARY, 8, 8 }, { GEO_ROAD_PATH, 4.5, 13 } };
    for (size_t c = 0; c < NOC_COUNT(cases); c++) {
        town t;
        begin(&t);
        add(&t, cases[c].cls, 0, 0, 240, 0);
        assert_int_equal(infer(&t), cases[c].lamps);
        assert_true(fabs(t.lamps[0].height - cases[c].height) < 1e-9);
        end(&t);
    }
}

/* No lamp in another road's carriageway; the arms of the crossing have theirs. */
static void junction(void **state) {
    town t;
    begin(&t);
    add(&t, GEO_ROAD_MINOR, -300, 0, 300, 0); /* a lamp's place, 12 m from the middle, would be in the wide one */
    geo_road *wide = add(&t, GEO_ROAD_MINOR, 0, -300, 0, 300);
    wide->width = 30;
    assert_true(infer(&t) > 40);
    assert_true(along(&t, &t.roads[0]) >= 20);
    for (size_t i = 0; i < t.found; i++) {
        assert_true(fabs(t.lamps[i].xy[0]) > 15.3);
        assert_true(fabs(t.lamps[i].xy[1]) > 5.5 / 2 + .3);
    }
    end(&t);
}

/* Only roads that are said to be lit; no railways, nothing in tunnels. */
static void dark(void **state) {
    town t;
    begin(&t);
    add(&t, GEO_ROAD_MINOR, 0, 0, 240, 0);
    add(&t, GEO_ROAD_MINOR, 0, 100, 240, 100)->lit = GEO_LIT_NO;
    add(&t, GEO_ROAD_MINOR, 0, 200, 240, 200)->lit = GEO_LIT_UNKNOWN;
    add(&t, GEO_ROAD_RAIL, 0, 300, 240, 300);
    add(&t, GEO_ROAD_MINOR, 0, 400, 240, 400)->tunnel = true;
    assert_int_equal(infer(&t), 10);
    assert_int_equal(along(&t, &t.roads[0]), 10);
    end(&t);
}

/* A map that tells nothing of light: by class, unless it has lamps. */
static void untold(void **state) {
    town t;
    begin(&t);
    static const geo_road_class classes[] = { GEO_ROAD_MINOR,   GEO_ROAD_PRIMARY, GEO_ROAD_MOTORWAY,
                                              GEO_ROAD_SERVICE, GEO_ROAD_PATH,    GEO_ROAD_TRACK };
    for (size_t i = 0; i < NOC_COUNT(classes); i++)
        add(&t, classes[i], 0, 100 * (double)i, 240, 100 * (double)i)->lit = GEO_LIT_UNKNOWN;
    assert_int_equal(infer(&t), 16);
    assert_true(along(&t, &t.roads[0]) == 10 && along(&t, &t.roads[1]) == 6);
    t.mapped_count = 1;
    t.mapped[0] = t.mapped[1] = 5000;
    assert_int_equal(infer(&t), 0);
    t.mapped_count = 0;
    t.roads[3].lit = GEO_LIT_NO;
    assert_int_equal(infer(&t), 0);
    end(&t);
}

/* Off the tracks, on both sides of the crossing; a bridge over them has its lamps. */
static void railway(void **state) {
    town t;
    begin(&t);
    geo_road *road = add(&t, GEO_ROAD_MINOR, -120, 0, 120, 0);
    for (int track = 0; track < 3; track++) /* one of them where a lamp would stand, 12 m from the middle */
        add(&t, GEO_ROAD_RAIL, 8 + 4 * track, -300, 8 + 4 * track, 300);
    assert_true(infer(&t) >= 9);
    bool between = false;
    for (size_t i = 0; i < t.found; i++)
        assert_true(t.lamps[i].xy[0] < 5.5 || t.lamps[i].xy[0] > 18.5);
    road->bridge = true;
    road->layer = 1;
    assert_int_equal(infer(&t), 10);
    for (size_t i = 0; i < t.found; i++)
        between = between || fabs(t.lamps[i].xy[0] - 12) < 1e-9;
    assert_true(between);
    end(&t);
}

/* A road below crosses without leaving a gap in the lamps above, nor they in its. */
static void layers(void **state) {
    town t;
    begin(&t);
    add(&t, GEO_ROAD_MINOR, -120, 0, 120, 0)->layer = 1;
    add(&t, GEO_ROAD_MINOR, 12, -120, 12, 120)->tunnel = true;
    add(&t, GEO_ROAD_MINOR, -12, -120, -12, 120)->lit = GEO_LIT_NO;
    assert_int_equal(infer(&t), 10);
    for (size_t i = 0; i < t.found; i++)
        assert_true(fabs(fmod(fabs(t.lamps[i].xy[0]), 24) - 12) < 1e-9);
    end(&t);
}

/* Along a quay all stand on land, though their side is that of the water; a bridge crosses it with its lamps. */
static void water(void **state) {
    town t;
    begin(&t);
    add_plane(t.scene, NOC_CLASS_TERRAIN, -400, 0, 400, 400, 2, 0);
    add_plane(t.scene, NOC_CLASS_WATER, -400, -400, 400, 0, 1, 0);
    geo_road *quay = add(&t, GEO_ROAD_MINOR, -120, 2, 120, 2);
    quay->oneway = 1; /* lamps on its right, in the water */
    assert_int_equal(infer(&t), 10);
    for (size_t i = 0; i < t.found; i++)
        assert_true(t.lamps[i].xy[1] > 4);
    t.count = 0;
    geo_road *over = add(&t, GEO_ROAD_MINOR, 0, -240, 0, 0);
    assert_int_equal(infer(&t), 0);
    over->bridge = true;
    assert_int_equal(infer(&t), 10);
    end(&t);
}

/* Each carriageway has its own, on the outer side. */
static void dual_carriageway(void **state) {
    town t;
    begin(&t);
    add(&t, GEO_ROAD_PRIMARY, 0, 0, 400, 0)->oneway = 1;
    add(&t, GEO_ROAD_PRIMARY, 400, 10, 0, 10)->oneway = 1;
    assert_int_equal(infer(&t), 20);
    for (size_t i = 0; i < t.found; i++)
        assert_true(t.lamps[i].road == &t.roads[0] ? t.lamps[i].xy[1] < -3 : t.lamps[i].xy[1] > 13);
    end(&t);
}

/* Lamps are mapped along half of a road: the other half gets some, from a spacing on. */
static void half_mapped(void **state) {
    town t;
    begin(&t);
    add(&t, GEO_ROAD_MINOR, 0, 0, 480, 0);
    for (int i = 0; i < 10; i++) {
        t.mapped[2 * i] = 12 + 24 * i;
        t.mapped[2 * i + 1] = 4;
    }
    t.mapped_count = 10;
    infer(&t);
    assert_true(t.found >= 9 && t.found <= 10);
    for (size_t i = 0; i < t.found; i++)
        assert_true(t.lamps[i].xy[0] > 228 + 22);
    end(&t);
}

/* The lamps of a road light the pavement beside it. */
static void path_beside(void **state) {
    town t;
    begin(&t);
    geo_road *road = add(&t, GEO_ROAD_MINOR, 0, 0, 240, 0);
    add(&t, GEO_ROAD_PATH, 0, 6, 240, 6);
    geo_road *park = add(&t, GEO_ROAD_PATH, 0, 60, 240, 60);
    assert_int_equal(infer(&t), 10 + 13);
    assert_true(along(&t, road) == 10 && along(&t, park) == 13);
    road->lit = GEO_LIT_NO; /* then the pavement has its own */
    assert_int_equal(infer(&t), 13 + 13);
    end(&t);
}

static void buildings(void **state) {
    town t;
    begin(&t);
    add_plane(t.scene, NOC_CLASS_TERRAIN, -400, -400, 400, 400, 0, 0);
    add_building(t.scene, -100, 2.9, 500, 20, 0, 10); /* to the kerb */
    add(&t, GEO_ROAD_MINOR, 0, 0, 240, 0)->name = "a";
    geo_road *other = add(&t, GEO_ROAD_MINOR, 0, -100, 240, -100);
    other->name = "a";
    assert_int_equal(infer(&t), 20);
    for (size_t i = 0; i < t.found; i++)
        assert_true(t.lamps[i].xy[1] < 0);
    end(&t);
}

/* Whatever order the roads come in, and whatever lies beyond. */
static void stable(void **state) {
    town a, b;
    begin(&a);
    add(&a, GEO_ROAD_MINOR, -200, 0, 200, 0);
    add(&a, GEO_ROAD_TERTIARY, 0, -200, 0, 200);
    add(&a, GEO_ROAD_PATH, -200, -190, 200, 190);
    begin(&b);
    b.roads[0] = a.roads[2];
    b.roads[1] = a.roads[0];
    b.roads[2] = a.roads[1];
    b.count = 3;
    add(&b, GEO_ROAD_MINOR, 1000, 1000, 1200, 1000);
    infer(&a);
    infer(&b);
    size_t same = 0;
    for (size_t i = 0; i < b.found; i++) {
        const city_road_lamp *l = &b.lamps[i];
        if (l->road == &b.roads[3])
            continue;
        bool there = false;
        for (size_t k = 0; k < a.found; k++)
            there = there || !memcmp(a.lamps[k].xy, l->xy, sizeof(l->xy));
        assert_true(there);
        same++;
    }
    assert_true(same == a.found && same > 20);
    end(&a);
    end(&b);
}

static bool north(void *user, const double xy[2]) { return xy[1] > *(double *)user; }
static bool stop(void *user, const char *what, double done) { return false; }

/* A lamp that is mapped every so many metres along a street from (x, y) east. */
static void map_along(town *t, double x, double y, double length, double each) {
    for (double at = each / 2; at < length; at += each) {
        t->mapped[2 * t->mapped_count] = x + at;
        t->mapped[2 * t->mapped_count++ + 1] = y;
    }
}

/* How far east the first of its lamps stands. */
static double first_along(const town *t, const geo_road *road) {
    double least = INFINITY;
    for (size_t i = 0; i < t->found; i++)
        least = t->lamps[i].road == road ? NOC_MIN(least, t->lamps[i].xy[0]) : least;
    return least;
}

/* Each street by itself: lamps of one silence no other, and its own keep the rule off for two spacings, whichever of
 * its ways they stand beside. */
static void streets(void **state) {
    town t;
    begin(&t);
    geo_road *a = add(&t, GEO_ROAD_MINOR, 0, 0, 240, 0), *b = add(&t, GEO_ROAD_MINOR, 240, 0, 288, 0);
    geo_road *c = add(&t, GEO_ROAD_MINOR, 0, 200, 240, 200), *d = add(&t, GEO_ROAD_MINOR, 0, 400, 480, 400);
    a->name = b->name = "Main Street"; /* b has no lamp of its own, and is the same street */
    map_along(&t, 0, 4, 240, 60);
    infer(&t);
    assert_int_equal(along(&t, a), 0);          /* every 60 m where the rule has 24 */
    assert_true(first_along(&t, b) > 210 + 47); /* the last one of Main Street stands at 210 */
    assert_int_equal(along(&t, c), 10);
    assert_int_equal(along(&t, d), 20);
    assert_int_equal(t.streets, 3);
    b->name = "Another"; /* one spacing off the lamps of others */
    infer(&t);
    assert_int_equal(along(&t, a), 0);
    assert_float_equal(first_along(&t, b), 252, 1e-9);
    assert_int_equal(along(&t, b), 2);
    assert_int_equal(t.streets, 3);
    c->name = "Main Street"; /* which does not meet the other of that name */
    infer(&t);
    assert_int_equal(along(&t, c), 10);
    /* one lamp in a long street keeps the rule off for 48 m to both sides */
    t.mapped_count = 0;
    map_along(&t, 228, 404, 24, 24);
    infer(&t);
    assert_int_equal(along(&t, a), 10);
    assert_int_equal(along(&t, d), 16);
    for (size_t i = 0; i < t.found; i++)
        assert_true(t.lamps[i].road != d || fabs(t.lamps[i].xy[0] - 240) > 47);
    end(&t);
}

static void asked(void **state) {
    town t;
    double from = 0;
    begin(&t);
    add(&t, GEO_ROAD_MINOR, 0, -120, 0, 120);
    infer_params(&t, (city_road_params){ .inside = north, .user = &from });
    assert_int_equal(t.found, 5);
    noc_progress progress = { stop, NULL };
    city_roads *roads = city_roads_create(t.roads, t.count);
    city_road_params params = { .height = 6, .progress = &progress };
    city_road_lamp *lamps;
    size_t count, streets;
    assert_int_equal(city_road_lamps(t.scene, roads, &params, &lamps, &count, &streets), NOC_ERR_CANCELLED);
    assert_true(!lamps && !count);
    city_roads_destroy(roads);
    end(&t);
}

/* Lines that are none, and one across the Earth. */
static void odd(void **state) {
    town t;
    begin(&t);
    add(&t, GEO_ROAD_MINOR, 5, 5, 5, 5);
    add(&t, GEO_ROAD_MINOR, -8e6, 0, 8e6, 0);
    add(&t, GEO_ROAD_MINOR, 1e300, 0, 1e300, 100);
    assert_int_equal(infer(&t), 0);
    end(&t);
}

/* What lights a road looks across it, and a path only where no road is. */
static void facing(void **state) {
    town t;
    begin(&t);
    add(&t, GEO_ROAD_MINOR, -100, 0, 100, 0);
    add(&t, GEO_ROAD_PATH, -100, 6, 100, 6);
    add(&t, GEO_ROAD_RAIL, -100, 4.6, 100, 4.6);
    city_roads *roads = city_roads_create(t.roads, t.count);
    double to[2] = { 0 };
    assert_true(city_roads_beside(roads, (double[]){ 50, 4 }, to) && fabs(to[1] + 1) < 1e-9);
    assert_true(city_roads_beside(roads, (double[]){ 50, 9 }, to) && fabs(to[1] + 1) < 1e-9);
    assert_true(city_roads_beside(roads, (double[]){ 104, -3 }, to) && fabs(to[0] + .8) < 1e-9);
    assert_null(city_roads_beside(roads, (double[]){ 0, 40 }, to));
    city_roads_destroy(roads);
    end(&t);
}

static void on_message(void *user, noc_log_level level, const char *text) {
    *(size_t *)user += level == NOC_LOG_WARN &&
                       strstr(text, "lit roads of maps have no lamps, or not all: 200000 are the most") != NULL;
}

static void on_crowd(void *user, noc_log_level level, const char *text) {
    *(size_t *)user += level == NOC_LOG_WARN && strstr(text, "too many roads lie over one another there") != NULL;
}

/* Nine thousand wide roads across one square, with very many pieces near each place: the search ends, and says so. A
 * tenth of them is searched to its end. */
static void crowded(void **state) {
    enum { ROADS = 9000 };
    size_t warned = 0;
    geo_road *roads = calloc(ROADS, sizeof(*roads));
    double(*xyz)[6] = calloc(ROADS, sizeof(*xyz));
    noc_log *log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_WARN, .message = on_crowd, .user = &warned });
    noc_scene *scene = noc_scene_create(log);
    for (int i = 0; i < ROADS; i++) {
        double angle = M_PI * fmod(i * 0.6180339887, 1), x = 100 * fmod(i * 0.7548776662, 1) - 50,
               y = 100 * fmod(i * 0.5698402910, 1) - 50, dx = 150 * cos(angle), dy = 150 * sin(angle);
        memcpy(xyz[i], (double[]){ x - dx, y - dy, NAN, x + dx, y + dy, NAN }, sizeof(xyz[i]));
        roads[i] = (geo_road){ .id = "way/1",
                               .name = "",
                               .cls = GEO_ROAD_PRIMARY,
                               .lit = GEO_LIT_YES,
                               .width = NAN,
                               .speed = NAN,
                               .point_count = 2,
                               .xyz = xyz[i] };
    }
    for (size_t count = ROADS / 10; count <= ROADS; count *= 10) {
        city_roads *of = city_roads_create(roads, count);
        city_road_lamp *lamps;
        size_t found, streets;
        assert_int_equal(city_road_lamps(scene, of, &(city_road_params){ .height = 6 }, &lamps, &found, &streets),
                         NOC_OK);
        assert_int_equal(warned, count == ROADS);
        free(lamps);
        city_roads_destroy(of);
    }
    noc_scene_destroy(scene);
    noc_log_destroy(log);
    free(xyz);
    free(roads);
}

static double sum_of(const city_road_lamp *lamps, size_t count) {
    double sum = 0;
    for (size_t i = 0; i < count; i++)
        sum += lamps[i].xy[0] * 1e-3 + lamps[i].xy[1];
    return sum;
}

/* More lamps than are kept are said, and those that are kept are the same in any order of ways. */
static void too_many(void **state) {
    enum { ROADS = 13 };
    size_t warned = 0;
    double sum = 0;
    static char ids[ROADS][16];
    static geo_road roads[ROADS], turned[ROADS];
    static double xyz[ROADS][6];
    noc_log *log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_WARN, .message = on_message, .user = &warned });
    noc_scene *scene = noc_scene_create(log);
    for (int i = 0; i < ROADS; i++) {
        memcpy(xyz[i], (double[]){ 0, 1e3 * i, NAN, 199e3, 1e3 * i, NAN }, sizeof(xyz[i]));
        snprintf(ids[i], sizeof(ids[i]), "way/%d", i);
        roads[i] = (geo_road){ .id = ids[i],
                               .name = "",
                               .cls = GEO_ROAD_MINOR,
                               .lit = GEO_LIT_YES,
                               .width = 12,
                               .speed = NAN,
                               .point_count = 2,
                               .xyz = xyz[i] };
        turned[(i * 5 + 3) % ROADS] = roads[i];
    }
    for (size_t count = ROADS - 1; count <= ROADS; count++) {
        city_roads *of = city_roads_create(roads, count);
        city_road_lamp *lamps;
        size_t found, streets;
        assert_int_equal(city_road_lamps(scene, of, &(city_road_params){ .height = 6 }, &lamps, &found, &streets),
                         NOC_OK);
        assert_true(count == ROADS ? found >= 200000 && found < 200002 : found > 190000 && found < 200000);
        assert_int_equal(warned, count == ROADS);
        sum = sum_of(lamps, found);
        free(lamps);
        city_roads_destroy(of);
    }
    city_roads *of = city_roads_create(turned, ROADS);
    city_road_lamp *lamps;
    size_t found, streets;
    assert_int_equal(city_road_lamps(scene, of, &(city_road_params){ .height = 6 }, &lamps, &found, &streets), NOC_OK);
    assert_true(fabs(sum_of(lamps, found) - sum) < 1e-6 * sum);
    free(lamps);
    city_roads_destroy(of);
    noc_scene_destroy(scene);
    noc_log_destroy(log);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_side),         cmocka_unit_test(both_sides),  cmocka_unit_test(by_class),
        cmocka_unit_test(junction),         cmocka_unit_test(dark),        cmocka_unit_test(untold),
        cmocka_unit_test(railway),          cmocka_unit_test(layers),      cmocka_unit_test(water),
        cmocka_unit_test(dual_carriageway), cmocka_unit_test(half_mapped), cmocka_unit_test(path_beside),
        cmocka_unit_test(buildings),        cmocka_unit_test(stable),      cmocka_unit_test(asked),
        cmocka_unit_test(streets),          cmocka_unit_test(odd),         cmocka_unit_test(facing),
        cmocka_unit_test(too_many),         cmocka_unit_test(crowded),
    };
    return cmocka_run_group_tests_name("city/road_lamps", tests, NULL, NULL);
}
