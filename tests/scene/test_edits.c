/* A scene that is edited: what is staged is not seen, what is published is the scene that would have been made so from
 * the start, and a commit that memory is refused to changes nothing. */
#include "../memory.h"
#include "edits.h"

#include <pthread.h>
#include <stdatomic.h>

/* The published scene, bit by bit. */
static void *photograph(const noc_scene *s, size_t *size) {
    size_t at = 0, sizes[] = { s->lights.len * sizeof(*s->lights.data),
                               s->positions.len * sizeof(float),
                               s->indices.len * sizeof(uint32_t),
                               s->triangle_material.len * sizeof(uint32_t),
                               s->triangle_light.len * sizeof(uint32_t),
                               s->meshes.len * sizeof(*s->meshes.data),
                               s->material_records.len * sizeof(*s->material_records.data),
                               s->instances.len * sizeof(*s->instances.data),
                               sizeof(s->versions) };
    const void *from[] = { s->lights.data,
                           s->positions.data,
                           s->indices.data,
                           s->triangle_material.data,
                           s->triangle_light.data,
                           s->meshes.data,
                           s->material_records.data,
                           s->instances.data,
                           &s->versions };
    *size = 0;
    for (size_t i = 0; i < NOC_COUNT(sizes); i++)
        *size += sizes[i];
    char *all = malloc(*size);
    for (size_t i = 0; i < NOC_COUNT(sizes); at += sizes[i++])
        memcpy(all + at, from[i], sizes[i]);
    return all;
}

static void edited_is_as_if_made_so(void **unused) {
    noc_scene *usual = made(NULL, NOTHING);
    state plain = state_of(usual);
    for (change to = MATERIAL; to < CHANGES; to++) {
        noc_scene *s = made(NULL, NOTHING), *want = made(NULL, to);
        size_t size[2];
        void *before = photograph(s, &size[0]);
        double z;
        noc_scene_ground(s, 0, 0, &z); /* its grids are there, and must not be taken for those of the edited scene */
        assert_int_equal(edit(s, to), NOC_OK);
        void *staged = photograph(s, &size[1]);
        assert_int_equal(size[0], size[1]);
        assert_memory_equal(before, staged, size[0]);
        assert_string_equal(state_of(s).key, plain.key);
        assert_int_equal(noc_scene_commit(s), NOC_OK);
        assert_int_equal(s->versions.commits, 1);
        if (to != INSTANCE_DARK)
            assert_alike(s, want);
        assert_string_not_equal(state_of(s).key, plain.key);
        free(before);
        free(staged);
        noc_scene_destroy(s);
        noc_scene_destroy(want);
    }
    noc_scene_destroy(usual);
    (void)unused;
}

static const change several[] = { SHINES,        RECOLOURED,     SWITCHED_OFF,   LIGHT_MOVED,
                                  LIGHT_ADDED,   LIGHT_REMOVED,  MESH_ADDED,     MESH_REMOVED,
                                  TOWER_REMOVED, INSTANCE_ADDED, INSTANCE_MOVED, INSTANCE_REMOVED };

/* Many edits are the same scene whether they are one transaction or many. */
static void transactions_add_up(void **unused) {
    noc_scene *one = made(NULL, NOTHING), *many = made(NULL, NOTHING);
    for (size_t i = 0; i < NOC_COUNT(several); i++) {
        assert_int_equal(edit(one, several[i]), NOC_OK);
        assert_int_equal(edit(many, several[i]), NOC_OK);
        assert_int_equal(noc_scene_commit(many), NOC_OK);
    }
    assert_int_equal(noc_scene_commit(one), NOC_OK);
    assert_int_equal(one->versions.commits, 1);
    assert_int_equal(many->versions.commits, NOC_COUNT(several));
    assert_alike(one, many);
    noc_scene_destroy(one);
    noc_scene_destroy(many);
    (void)unused;
}

/* Every allocation of staging and of the commit, refused alone and with all later ones. */
static void refused_memory_changes_nothing(void **unused) {
    noc_log *log = counting_log();
    noc_scene *want = made(NULL, NOTHING);
    for (size_t i = 0; i < NOC_COUNT(several); i++)
        assert_int_equal(edit(want, several[i]), NOC_OK);
    assert_int_equal(noc_scene_commit(want), NOC_OK);
    bool reached, staged_all = false;
    FOR_EACH_REFUSAL(reached) {
        noc_scene *s = made(log, NOTHING);
        size_t size[2];
        void *before = photograph(s, &size[0]);
        bool whole = true;
        begin_refusal(n, later);
        for (size_t i = 0; i < NOC_COUNT(several); i++) {
            int errors = refusing.errors;
            noc_status status = edit(s, several[i]);
            assert_int_equal(refusing.errors - errors, status != NOC_OK); /* each refused edit says so once */
            assert_true(status == NOC_OK || status == NOC_ERR_MEMORY);
            whole = whole && status == NOC_OK;
        }
        int errors = refusing.errors;
        noc_status status = noc_scene_commit(s);
        reached = end_refusal();
        assert_int_equal(refusing.errors - errors, status != NOC_OK);
        if (status != NOC_OK) {
            assert_int_equal(status, NOC_ERR_MEMORY);
            void *after = photograph(s, &size[1]);
            assert_int_equal(size[0], size[1]);
            assert_memory_equal(before, after, size[0]);
            free(after);
            staged_all |= whole;
            assert_int_equal(noc_scene_commit(s), NOC_OK); /* what is staged stayed so */
        }
        if (whole)
            assert_string_equal(state_of(s).key, state_of(want).key);
        free(before);
        noc_scene_destroy(s);
    }
    assert_true(staged_all);
    noc_scene_destroy(want);
    noc_log_destroy(log);
    (void)unused;
}

static void versions_count_what_changed(void **unused) {
    static const struct {
        change edit;
        /* a letter a version: geometry, instances, materials, lights, moved, emission, standing, settled (d) */
        const char *counts;
    } table[] = {
        { MATERIAL, "m" },         { CLASS_MATERIAL, "m" },    { SHINES, "ml" },       { GOES_OUT, "mls" },
        { RECOLOURED, "mes" },     { TWO_SIDED, "mlesd" },     { EMISSION, "es" },     { DIMMED, "es" },
        { SWITCHED_OFF, "es" },    { LIGHT_MOVED, "o" },       { LIGHT_ADDED, "gl" },  { LIGHT_REMOVED, "gls" },
        { MESH_ADDED, "gl" },      { MESH_REMOVED, "gls" },    { TOWER_REMOVED, "g" }, { INSTANCE_ADDED, "il" },
        { INSTANCE_MOVED, "ioe" }, { INSTANCE_REMOVED, "il" }, { INSTANCE_DARK, "e" },
    };
    for (size_t i = 0; i < NOC_COUNT(table); i++) {
        noc_scene *s = made(NULL, NOTHING);
        const noc_scene_versions *v = &s->versions;
        noc_range dirty = { 0 };
        assert_int_equal(v->commits, 0);
        for (int again = 1; again <= 2; again++) { /* to what it is already: nothing changes, but what is added is */
            if (again == 2 && strpbrk(table[i].counts, "gl") && !strchr(table[i].counts, 'm'))
                break;
            assert_int_equal(edit(s, table[i].edit), NOC_OK);
            assert_int_equal(noc_scene_commit(s), NOC_OK);
            const uint64_t have[] = { v->geometry, v->instances, v->materials, v->lights,
                                      v->moved,    v->emission,  v->standing,  v->settled };
            for (size_t k = 0; k < NOC_COUNT(have); k++)
                if (have[k] != (strchr(table[i].counts, "gimloesd"[k]) != NULL))
                    fail_msg("edit %d: %c counts %d", table[i].edit, "gimloesd"[k], (int)have[k]);
            assert_int_equal(v->commits, 1);
            if (again == 1)
                dirty = s->dirty_lights;
            assert_memory_equal(&dirty, &s->dirty_lights, sizeof(dirty));
        }
        noc_scene_destroy(s);
    }
    (void)unused;
}

static void count(void *user, noc_log_level level, const char *text) { *(int *)user += level == NOC_LOG_ERROR; }

/* What cannot be is refused where it is called, once, and stages nothing. */
static void wrong_edits_are_told(void **unused) {
    int errors = 0, wanted = 0;
    noc_log *log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_ERROR, .message = count, .user = &errors });
    noc_scene *s = made(log, NOTHING);
    char *key = state_of(s).key, before[NOC_CONTENT_KEY];
    memcpy(before, key, sizeof(before));
    noc_material m = s->materials.data[WALL], bad = m;
    noc_light lamp = lamp_at(0);
    noc_mesh mesh = { .material = DARK, .model = CAR };
    double good[12], t[12];
    place(0, 1, 0, good);
#define REFUSED(call)                                                                                                  \
    do {                                                                                                               \
        assert_int_equal(call, NOC_ERR_ARGUMENT);                                                                      \
        assert_int_equal(errors, ++wanted);                                                                            \
    } while (0)
    bad.roughness = 0;
    REFUSED(noc_scene_set_material(s, 99, &m));
    REFUSED(noc_scene_set_material(s, WALL, &bad));
    bad = s->materials.data[GLOW], bad.emission[1] = 4; /* of a model */
    REFUSED(noc_scene_set_material(s, GLOW, &bad));
    bad = s->materials.data[BODY], bad.emission[1] = 4;
    REFUSED(noc_scene_set_material(s, BODY, &bad));
    bad = m, bad.cls = NOC_CLASS_CLOSURE;
    REFUSED(noc_scene_set_material(s, WALL, &bad));
    REFUSED(noc_scene_set_class_material(s, (noc_class)99, &m));
    REFUSED(noc_scene_set_emission(s, -1, (float[3]){ 1, 1, 1 }));
    REFUSED(noc_scene_set_emission(s, LAMP, (float[3]){ 1, -1, 1 }));
    REFUSED(noc_scene_set_emission(s, LAMP, (float[3]){ 1, NAN, 1 }));
    REFUSED(noc_scene_set_group(s, 0, (float[3]){ 1, 1, 1 }));
    REFUSED(noc_scene_set_group(s, 3, (float[3]){ 1, 1, 1 }));
    REFUSED(noc_scene_set_group(s, STREET, (float[3]){ 1, INFINITY, 1 }));
    REFUSED(noc_scene_move_light(s, LAMP, &lamp)); /* was not made to */
    REFUSED(noc_scene_move_light(s, noc_scene_instance_light(s, 0, 0), &lamp));
    REFUSED(noc_scene_remove_light(s, noc_scene_instance_light(s, 0, 1)));
    REFUSED(noc_scene_remove_light(s, LAMP + 1)); /* a triangle of a mesh */
    REFUSED(noc_scene_remove_light(s, 1000));
    REFUSED(noc_scene_remove_mesh(s, 1000));
    REFUSED(noc_scene_remove_mesh(s, FRONT + 1));              /* the globe's shape */
    REFUSED(noc_scene_remove_mesh(s, (int)s->meshes.len - 1)); /* of a model */
    REFUSED(noc_scene_remove_instance(s, 2));
    REFUSED(noc_scene_set_transform(s, 2, good));
    for (int i = 0; i < 6; i++) {
        memcpy(t, good, sizeof(t));
        if (i == 0)
            t[0] = 1.01; /* two scales */
        else if (i == 1)
            t[1] = .01; /* a shear */
        else if (i == 2)
            t[10] = -1; /* a mirror */
        else if (i == 3)
            t[3] = NAN;
        else
            for (int k = 0; k < 3; k++)
                t[5 * k] = i == 4 ? 0 : 2000;
        REFUSED(noc_scene_set_transform(s, 0, t));
    }
#undef REFUSED
    assert_int_equal(noc_scene_add_mesh(s, &mesh), -1); /* its model is published */
    mesh.model = 2;
    assert_int_equal(noc_scene_add_mesh(s, &mesh), -1);
    mesh.model = 0, mesh.group = 3;
    assert_int_equal(noc_scene_add_mesh(s, &mesh), -1);
    lamp.model = CAR;
    assert_int_equal(noc_scene_add_light(s, &lamp), -1);
    lamp.model = 0, lamp.group = -1;
    assert_int_equal(noc_scene_add_light(s, &lamp), -1);
    assert_int_equal(noc_scene_add_instance(s, &(noc_instance){ .model = CAR }), -1);
    assert_int_equal(noc_scene_add_instance(s, &(noc_instance){ .model = 0, .transform = { 1, [5] = 1, [10] = 1 } }),
                     -1);
    assert_int_equal(errors, wanted + 7);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    assert_int_equal(s->versions.commits, 0);
    assert_string_equal(state_of(s).key, before);
    noc_scene_destroy(s);
    noc_log_destroy(log);
    (void)unused;
}

/* Of what the same transaction removes they do nothing. */
static void edits_of_what_is_removed(void **unused) {
    noc_scene *s = made(NULL, NOTHING);
    noc_light spot = spot_at(0);
    double good[12];
    place(0, 1, 0, good);
    assert_int_equal(noc_scene_remove_light(s, SPOT), NOC_OK);
    assert_int_equal(noc_scene_move_light(s, SPOT, &spot), NOC_OK);
    assert_int_equal(noc_scene_remove_light(s, SPOT), NOC_OK);
    for (int i = 0; i < 2; i++) {
        assert_int_equal(noc_scene_remove_instance(s, 1), NOC_OK);
        assert_int_equal(noc_scene_remove_mesh(s, FRONT), NOC_OK);
    }
    assert_int_equal(noc_scene_set_transform(s, 1, good), NOC_OK);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_scene_info info;
    noc_scene_get_info(s, &info);
    assert_int_equal(info.instances, 1);
    assert_int_equal(info.lights_by_kind[NOC_LIGHT_SPOT], 0);
    noc_scene_destroy(s);
    (void)unused;
}

static void bounds_are(const noc_scene *s, double low, double high) {
    noc_scene_info info;
    noc_scene_get_info(s, &info);
    assert_true(info.bounds_min[0] == low);
    assert_true(info.bounds_max[0] == high);
}

/* The first mesh is the backdrop only where there is one. */
static void bounds_shrink_with_the_first_mesh(void **unused) {
    noc_scene *s = noc_scene_create(NULL);
    materials(s, NOTHING);
    piece(s, WALL, 0, 0, "far", 5000, 10);
    piece(s, WALL, 0, 0, "near", 0, 10);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    bounds_are(s, 0, 5010);
    assert_int_equal(noc_scene_remove_mesh(s, 0), NOC_OK);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    bounds_are(s, 0, 10);
    noc_scene_destroy(s);
    (void)unused;
}

enum { CLOSED_WORLD = 1, CLOSED_LATER = 2, CLOSED_MODEL = 4 };

/* A floor under a light, and closures between the two. */
static noc_scene *closed(int where) {
    noc_scene *s = noc_scene_create(NULL);
    noc_material closure = noc_class_material(NOC_CLASS_CLOSURE);
    closure.emission[0] = 100;
    int floor = matte(s, .5f), m = noc_scene_add_material(s, &closure);
    noc_instance in = { .model = noc_scene_add_model(s, "gate"), .transform = { 1, [5] = 1, [10] = 1 } };
    add_floor(s, floor, 0, 0, 0, 5);
    if (where & CLOSED_WORLD)
        add_floor(s, m, 0, 0, 1, 30);
    if (where & CLOSED_MODEL) {
        piece(s, m, in.model, 0, "closure", 0, 40);
        assert_int_equal(noc_scene_add_instance(s, &in), 0);
    }
    point_light(s, 0, 0, 4, 100);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    if (where & CLOSED_LATER) {
        add_floor(s, m, 0, 0, 2, 30);
        assert_int_equal(noc_scene_commit(s), NOC_OK);
    }
    return s;
}

static void closures_are_counted_not_seen(void **unused) {
    noc_camera c = look(0, -4, .5, 0, 0, 0, 60);
    noc_render_params p = measure(16, 16, NOC_METHOD_REFERENCE);
    noc_scene *open = closed(0);
    noc_image *want = render(open, &c, &p, 1);
    for (int where = 1; where < 8; where++) {
        noc_scene *s = closed(where);
        noc_image *have = render(s, &c, &p, 1);
        noc_scene_info info;
        noc_scene_get_info(s, &info);
        assert_memory_equal(have->rgb, want->rgb, sizeof(float) * 3 * 16 * 16);
        assert_int_equal(info.triangles_by_class[NOC_CLASS_CLOSURE], 2 * (where & 1) + (where & 2) + (where & 4) / 2);
        bounds_are(s, -5, 5);
        assert_int_equal(noc_scene_remove_mesh(s, 0), NOC_OK); /* bounds are found anew */
        assert_int_equal(noc_scene_commit(s), NOC_OK);
        bounds_are(s, 0, 0);
        noc_image_destroy(have);
        noc_scene_destroy(s);
    }
    noc_image_destroy(want);
    noc_scene_destroy(open);
    (void)unused;
}

/* The last scale of a group is the one that counts: to there and back is nowhere. */
static void the_last_scale_of_a_group_holds(void **unused) {
    noc_scene *s = made(NULL, NOTHING), *want = made(NULL, DIMMED);
    float one[3] = { 1, 1, 1 };
    assert_int_equal(edit(s, DIMMED), NOC_OK);
    assert_int_equal(edit(s, INSTANCE_DARK), NOC_OK);
    for (int group = STREET; group <= CARS; group++)
        assert_int_equal(noc_scene_set_group(s, group, one), NOC_OK);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    assert_int_equal(s->versions.commits, 0);
    assert_int_equal(edit(s, INSTANCE_DARK), NOC_OK);
    assert_int_equal(edit(s, SWITCHED_OFF), NOC_OK);
    assert_int_equal(edit(s, DIMMED), NOC_OK);
    assert_int_equal(noc_scene_set_group(s, CARS, one), NOC_OK);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    assert_int_equal(s->versions.emission, 1);
    assert_alike(s, want);
    noc_scene_destroy(s);
    noc_scene_destroy(want);
    (void)unused;
}

/* Of a class, too, though black lamps in between would be what lights show. */
static void the_last_material_of_a_class_holds(void **unused) {
    noc_scene *s = noc_scene_create(NULL);
    noc_material m = noc_class_material(NOC_CLASS_LAMP), black = { .roughness = 1 }, white = { .roughness = 1 };
    white.albedo[0] = white.albedo[1] = white.albedo[2] = .9f;
    assert_int_equal(noc_scene_add_material(s, &m), 0);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    assert_int_equal(noc_scene_set_class_material(s, NOC_CLASS_LAMP, &black), NOC_OK);
    assert_int_equal(noc_scene_set_class_material(s, NOC_CLASS_LAMP, &white), NOC_OK);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    assert_true(s->materials.data[0].albedo[1] == .9f);
    noc_scene_destroy(s);
    (void)unused;
}

/* A scene in the making: its second instance goes again, the first one moves, and its slot is another's then. */
static void instances_are_edited_before_the_first_commit(void **unused) {
    noc_scene *s[2];
    noc_log *log = counting_log();
    for (int i = 0; i < 2; i++) {
        s[i] = noc_scene_create(log);
        double there[12];
        materials(s[i], NOTHING);
        noc_scene_add_group(s[i], "street");
        noc_scene_add_group(s[i], "cars");
        car(s[i]);
        instance(s[i], 0, 1, i ? 0 : 70);
        if (i) {
            assert_int_equal(noc_scene_set_group(s[i], CARS, (float[3]){ 1, 1, 1 }), NOC_OK);
            instance(s[i], 1, 1, 10);
            place(0, 1, 70, there);
            assert_int_equal(noc_scene_set_transform(s[i], 0, there), NOC_OK);
            assert_int_equal(noc_scene_remove_instance(s[i], 1), NOC_OK);
            assert_int_equal(noc_scene_remove_instance(s[i], 1), NOC_OK);
            assert_int_equal(noc_scene_remove_instance(s[i], 2), NOC_ERR_ARGUMENT);
        }
        assert_int_equal(noc_scene_commit(s[i]), NOC_OK);
    }
    assert_alike(s[1], s[0]);
    assert_int_equal(noc_scene_add_instance(s[1],
                                            &(noc_instance){ .model = CAR, .transform = { 1, [5] = 1, [10] = 1 } }),
                     1);
    assert_int_equal(noc_scene_commit(s[1]), NOC_OK);
    noc_scene_destroy(s[0]);
    noc_scene_destroy(s[1]);
    noc_log_destroy(log);
    (void)unused;
}

/* Frames never see half of a transaction, though readers follow each other without a gap. */
enum { COMMITS = 300, LOOKS = 200 };

typedef struct watch {
    noc_scene *scene;
    atomic_bool over;
    atomic_int torn, looks;
} watch;

static void *watch_lights(void *arg) {
    watch *w = arg;
    while (!atomic_load(&w->over)) {
        noc_scene_lock_frame(w->scene);
        const noc_light_record *l = w->scene->lights.data;
        float first = l[GLOBE].e[0];
        noc_light_info info;
        for (int i = 0; i < 100; i++)
            if (l[GLOBE].e[0] != first || l[LAMP].e[0] != first)
                atomic_fetch_add(&w->torn, 1);
        if (noc_scene_get_light(w->scene, LAMP, &info) != NOC_OK || info.light.emission[0] != first)
            atomic_fetch_add(&w->torn, 1); /* a frame may ask */
        noc_scene_unlock_frame(w->scene);
        atomic_fetch_add(&w->looks, 1);
    }
    return NULL;
}

static void frames_see_whole_transactions(void **unused) {
    watch w = { .scene = made(NULL, NOTHING) };
    pthread_t threads[2];
    float same[3] = { 20, 20, 20 };
    assert_int_equal(noc_scene_set_emission(w.scene, LAMP, same), NOC_OK);
    assert_int_equal(noc_scene_commit(w.scene), NOC_OK);
    for (int i = 0; i < 2; i++)
        assert_int_equal(pthread_create(&threads[i], NULL, watch_lights, &w), 0);
    for (int i = 0; i < COMMITS || atomic_load(&w.looks) < LOOKS; i++) {
        same[0] = (float)(1 + i % 7);
        assert_int_equal(noc_scene_set_emission(w.scene, LAMP, same), NOC_OK);
        assert_int_equal(noc_scene_set_emission(w.scene, GLOBE, same), NOC_OK);
        if (i % 10 == 0 && i < COMMITS) /* the arrays move */
            assert_int_equal(edit(w.scene, LIGHT_ADDED), NOC_OK);
        assert_int_equal(noc_scene_commit(w.scene), NOC_OK);
    }
    atomic_store(&w.over, true);
    for (int i = 0; i < 2; i++)
        pthread_join(threads[i], NULL);
    assert_int_equal(atomic_load(&w.torn), 0);
    noc_scene_destroy(w.scene);
    (void)unused;
}

/* Of what is not there the error gives the number. */
static void numbers_are_told(void **unused) {
    noc_log *log = counting_log();
    noc_scene *s = made(log, NOTHING);
    const noc_mesh meshes[] = { { .material = 123 },
                                { .material = DARK, .group = 124 },
                                { .material = DARK, .model = 125 },
                                { .material = DARK, .model = CAR } };
    static const char *const says[] = { "there is no material 123", "there is no group 124", "there is no model 125",
                                        "model 1 is committed" };
    for (size_t i = 0; i < NOC_COUNT(meshes); i++) {
        noc_light l = lamp_at(0);
        l.group = meshes[i].group, l.model = meshes[i].model;
        refusing = (refusal){ 0 };
        assert_int_equal(noc_scene_add_mesh(s, &meshes[i]), -1);
        assert_true(refusing.errors == 1 && strstr(refusing.first_error, says[i]));
        refusing = (refusal){ 0 };
        if (!i)
            continue; /* a light has no material */
        assert_int_equal(noc_scene_add_light(s, &l), -1);
        assert_true(refusing.errors == 1 && strstr(refusing.first_error, says[i]));
    }
    noc_scene_destroy(s);
    noc_log_destroy(log);
    (void)unused;
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(edited_is_as_if_made_so),
                                        cmocka_unit_test(transactions_add_up),
                                        cmocka_unit_test(refused_memory_changes_nothing),
                                        cmocka_unit_test(versions_count_what_changed),
                                        cmocka_unit_test(wrong_edits_are_told),
                                        cmocka_unit_test(edits_of_what_is_removed),
                                        cmocka_unit_test(numbers_are_told),
                                        cmocka_unit_test(frames_see_whole_transactions),
                                        cmocka_unit_test(bounds_shrink_with_the_first_mesh),
                                        cmocka_unit_test(closures_are_counted_not_seen),
                                        cmocka_unit_test(the_last_scale_of_a_group_holds),
                                        cmocka_unit_test(instances_are_edited_before_the_first_commit),
                                        cmocka_unit_test(the_last_material_of_a_class_holds) };
    return cmocka_run_group_tests_name("scene edits", tests, NULL, NULL);
}
