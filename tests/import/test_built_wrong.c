/* What is no built city, or a damaged one, or one of a stranger, is one error or a scene like others. */
#include "../memory.h"
#include "built_city.h"

#include "noct/inside.h"

#include <sys/stat.h>

typedef struct bytes {
    uint8_t *data;
    size_t size;
} bytes;

static bytes read_all(void) {
    struct stat st;
    FILE *file = fopen(path, "rb");
    assert_true(file && !fstat(fileno(file), &st));
    bytes b = { malloc((size_t)st.st_size), (size_t)st.st_size };
    assert_true(b.data && fread(b.data, 1, b.size, file) == b.size);
    fclose(file);
    return b;
}

static void write_all(bytes b) {
    FILE *file = fopen(path, "wb");
    assert_true(file && fwrite(b.data, 1, b.size, file) == b.size);
    assert_int_equal(fclose(file), 0);
}

/* Makes the sums of head and sections right again. */
static void mend(bytes b) {
    noct_head *head = (noct_head *)b.data;
    noct_entry *entries = (noct_entry *)(b.data + sizeof(*head));
    for (uint32_t i = 0; i < head->sections; i++) {
        uint64_t sums[64] = { 0 };
        size_t count = 0;
        for (uint64_t at = 0; at < entries[i].bytes; at += NOCT_BLOCK)
            sums[count++] =
                noct_sum(b.data + entries[i].offset + at, (size_t)NOC_MIN(entries[i].bytes - at, (uint64_t)NOCT_BLOCK));
        entries[i].sum = noct_sum(sums, count * sizeof(*sums));
    }
    head->sum = 0;
    head->sum = noct_sum(b.data, NOCT_HEAD);
}

static noc_status load_status(char message[400]) {
    const char *inputs[] = { path };
    noc_log *log = counting_log();
    refusing = (refusal){ 0 };
    noc_scene *scene = noc_scene_create(log);
    noc_status status = noc_scene_load(scene, inputs, 1, NULL, NULL);
    snprintf(message, 400, "%s", status ? noc_log_last_error(log) : "");
    assert_int_equal(refusing.errors, status != NOC_OK);
    noc_scene_info info;
    noc_scene_get_info(scene, &info); /* who asks after an error finds nothing that was not looked at */
    noc_scene_destroy(scene);
    noc_log_destroy(log);
    return status;
}

static void assert_refused_as(bytes b, const char *what) {
    char message[400];
    write_all(b);
    noc_status status = load_status(message);
    if (status != NOC_ERR_FORMAT || !strstr(message, what) || !strstr(message, "city.noct: "))
        fail_msg("status %d, \"%s\" does not say \"%s\"", status, message, what);
}

static void save_city(void) {
    noc_report *report;
    noc_scene *scene = make_city(&report);
    assert_int_equal(noc_scene_save(scene, path, &(noc_save_params){ report, "nocturne: 1\n" }), NOC_OK);
    noc_report_destroy(report);
    noc_scene_destroy(scene);
}

static void test_damage(void **state) {
    (void)state;
    save_city();
    bytes b = read_all();
    noct_head good, *head = (noct_head *)b.data;
    memcpy(&good, head, sizeof(good));
    for (size_t size = 8; size < b.size; size += 1 + size / 3)
        assert_refused_as((bytes){ b.data, size }, "is damaged: it has");
    head->order = 0x04030201;
    assert_refused_as(b, "another order of bytes");
    *head = good;
    head->version = 99;
    assert_refused_as(b, "version 99");
    *head = good;
    head->layout++;
    assert_refused_as(b, "the checksum of its head");
    mend(b);
    assert_refused_as(b, "keeps cities in another way: build it again");
    *head = good;
    b.data[b.size - 1] ^= 1;
    assert_refused_as(b, "the checksum of its section names");
    b.data[b.size - 1] ^= 1;
    head->sections = 200;
    head->sum = 0;
    head->sum = noct_sum(b.data, NOCT_HEAD);
    assert_refused_as(b, "too many sections");
    *head = good;
    noct_entry *entry = (noct_entry *)(b.data + sizeof(*head));
    entry->offset = 1u << 30;
    head->sum = 0;
    head->sum = noct_sum(b.data, NOCT_HEAD);
    assert_refused_as(b, "its table of sections");
    free(b.data);
}

/* Numbers that no writer writes, one after the other, in files whose sums are right: one error, or a scene that may be
 * asked, edited and looked at. */
static void test_hostile(void **state) {
    (void)state;
    save_city();
    bytes b = read_all();
    const noct_head *head = (const noct_head *)b.data;
    const noct_entry *entries = (const noct_entry *)(b.data + sizeof(*head));
    static const uint32_t words[] = { UINT32_MAX, 0x7fc00000, 0x7f800000, 0xfe967699, 1000, 0 };
    size_t refused = 0, taken = 0;
    for (uint32_t i = 0; i < head->sections; i++)
        for (size_t n = 0, at = 0; at + 4 <= entries[i].bytes;
             n++, at += 4 + (n > 8 ? entries[i].bytes / 24 & ~3u : 0)) {
            uint8_t *place = b.data + entries[i].offset + at;
            uint32_t before;
            char message[400];
            memcpy(&before, place, 4);
            memcpy(place, &words[n % NOC_COUNT(words)], 4);
            mend(b);
            write_all(b);
            noc_status status = load_status(message);
            if (status && status != NOC_ERR_FORMAT)
                fail_msg("section %.8s, byte %zu: status %d, \"%s\"", entries[i].name, at, status, message);
            *(status ? &refused : &taken) += 1;
            if (!status && !strncmp(entries[i].name, "lights", 8)) {
                noc_scene *scene = load_again(NULL);
                stage_edits(scene);
                noc_image_destroy(picture(scene, &in_street));
                noc_scene_destroy(scene);
            }
            memcpy(place, &before, 4);
        }
    assert_true(refused > 100 && taken > 20);
    free(b.data);
}

static uint32_t *section(bytes b, const char *name, size_t *words) {
    const noct_head *head = (const noct_head *)b.data;
    const noct_entry *e = (const noct_entry *)(b.data + sizeof(*head)), *end = e + head->sections;
    while (e < end && strncmp(e->name, name, sizeof(e->name)))
        e++;
    assert_true(e < end && e->bytes);
    *words = (size_t)e->bytes / 4;
    return (uint32_t *)(void *)(b.data + e->offset);
}

static uint32_t bits_of(float value) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof(bits));
    return bits;
}

/* What no single number tells: two things that share what is one's own, and numbers that do not go together. */
static void test_together(void **state) {
    (void)state;
    save_city();
    bytes b = read_all();
    size_t words[7], shown = 0;
    uint32_t *lit = section(b, "instlit", &words[0]), *instances = section(b, "instance", &words[1]),
             *windows = section(b, "windows", &words[2]), *tables = section(b, "tables", &words[3]),
             *facades = section(b, "facades", &words[4]), *cells = section(b, "cells", &words[5]),
             *fronts = section(b, "fronts", &words[6]);
    while (cells[shown] == NOC_NO_LIGHT)
        shown++;
    size_t lights = words[0] / 2; /* of each of the two that stand */
    assert_true(lights > 1 && words[1] == 3 * 13 && !instances[13] && instances[0] == instances[26]);
    assert_true(windows[0] < windows[7] && windows[7] < lit[0]); /* lights of cars come last */
    size_t own = words[2] / 7 - 1;
    const struct {
        uint32_t *word, value;
        const char *what;
    } wrong[] = { { &lit[lights], lit[0], "instance 2 has lights of others" },
                  { &lit[1], lit[0], "instance 0 has lights of others" },
                  { &lit[0], windows[0], "instance 0 has lights of others" },
                  { &instances[1 + 1], bits_of(1), "instance 0 is none" },      /* a shear */
                  { &instances[27 + 10], bits_of(-1), "instance 2 is none" },   /* a mirror */
                  { &instances[1 + 10], bits_of(1e-9f), "instance 0 is none" }, /* flat */
                  { &windows[7 * own], lit[0], "one of its windows is none" },
                  { &windows[7 * own + 6], 5000, "is in a facade that there is not" },
                  { &cells[shown], lit[0], "a cell of a facade shows what is no window of it" },
                  { &cells[shown], 1u << 31, "a cell of a facade shows what is no window of it" },
                  { &facades[3], 1, "facade 0 is none" },          /* begins elsewhere */
                  { &facades[7], 0x80000000, "facade 0 is none" }, /* columns */
                  { &facades[12], 1u << 30, "facade 0 is none" },  /* material */
                  { &facades[0], 0x7fc00000, "facade 0 is none" }, /* nowhere */
                  { &fronts[0], 5000, "cells or walls of no facade" },
                  { &tables[0], 1, "the table of profile 1 lies elsewhere" } }; /* among the heads */
    for (size_t i = 0; i < NOC_COUNT(wrong); i++) {
        uint32_t before = *wrong[i].word;
        *wrong[i].word = wrong[i].value;
        mend(b);
        assert_refused_as(b, wrong[i].what);
        *wrong[i].word = before;
    }
    free(b.data);
}

/* Meshes that show lights of others: an edit of such a scene would take out more than it has made room for. */
static void test_shown(void **state) {
    (void)state;
    save_city();
    bytes b = read_all();
    size_t words;
    uint32_t *shown = section(b, "shown", &words), count = (uint32_t)words, last = 0;
    noc_scene *s = load_again(NULL);
    size_t owned = 0, shape = count;
    while (owned < s->lights.len &&
           (s->lights.data[owned].flags & (NOC_LIGHT_OWNED | NOC_LIGHT_MOVES)) != NOC_LIGHT_OWNED)
        owned++;
    for (uint32_t t = count; t-- > 0;)
        if (!s->meshes.data[noc_scene_mesh_of(s, t)].model) {
            shape = shown[t] == NOC_LIGHT_SPHERE ? t : shape;
            last = shown[t] == NOC_NO_LIGHT ? NOC_MAX(last, t) : last;
        }
    assert_true(owned < s->lights.len && shape < count && last);
    noc_scene_destroy(s);
    const struct {
        size_t triangle;
        uint32_t light;
    } wrong[] = { { shape + 1, (uint32_t)owned }, /* goes with the sphere, and with its own mesh */
                  { shape + 1, NOC_NO_LIGHT },
                  { last, NOC_LIGHT_SPHERE } };
    for (size_t i = 0; i < NOC_COUNT(wrong); i++) {
        uint32_t before = shown[wrong[i].triangle];
        shown[wrong[i].triangle] = wrong[i].light;
        mend(b);
        assert_refused_as(b, "shows a light that is not its own");
        shown[wrong[i].triangle] = before;
    }
    free(b.data);
}

static void test_alone(void **state) {
    (void)state;
    save_city();
    noc_log *log = counting_log();
    noc_scene *scene = noc_scene_create(log);
    const char *two[] = { path, city_file() };
    assert_int_equal(noc_scene_load(scene, two, 2, NULL, NULL), NOC_ERR_ARGUMENT);
    assert_non_null(strstr(noc_log_last_error(log), "is a built city, and"));
    noc_scene_destroy(scene);
    scene = noc_scene_create(log);
    noc_material m = noc_class_material(NOC_CLASS_WALL);
    noc_scene_add_material(scene, &m);
    assert_int_equal(noc_scene_load(scene, two, 1, NULL, NULL), NOC_ERR_ARGUMENT);
    noc_scene_destroy(scene);
    /* in a folder it is left out */
    scene = noc_scene_create(log);
    const char *in[] = { folder };
    assert_int_equal(noc_scene_load(scene, in, 1, NULL, NULL), NOC_ERR_FORMAT);
    noc_scene_destroy(scene);
    noc_import_params params = noc_import_default_params();
    params.max_memory = 1e-5;
    scene = noc_scene_create(log);
    assert_int_equal(noc_scene_load(scene, two, 1, &params, NULL), NOC_ERR_MEMORY);
    assert_non_null(strstr(noc_log_last_error(log), "--max-memory"));
    noc_scene_destroy(scene);
    noc_log_destroy(log);
}

static void test_recipe(void **state) {
    (void)state;
    char *text;
    noc_recipe *recipe;
    save_city();
    assert_int_equal(noc_built_get_recipe(path, NULL, &text), NOC_OK);
    assert_string_equal(text, "nocturne: 1\n");
    free(text);
    assert_int_equal(noc_recipe_load(path, NULL, &recipe), NOC_OK);
    assert_int_equal(noc_recipe_get_info(recipe)->input_count, 1);
    assert_string_equal(noc_recipe_get_info(recipe)->inputs[0], path);
    noc_recipe_destroy(recipe);
    noc_built_info info;
    assert_int_equal(noc_built_get_info(path, NULL, &info), NOC_OK);
    assert_int_equal(info.version, NOCT_VERSION);
    assert_string_equal(info.writer, noc_version());
    assert_true(info.section_count > 10 && info.section_count < NOC_BUILT_SECTIONS);
    noc_log *log = counting_log();
    noc_scene *scene = noc_scene_create(log);
    assert_int_equal(noc_scene_commit(scene), NOC_OK);
    assert_int_equal(noc_scene_save(scene, path, &(noc_save_params){ NULL, "nocturne: 1\ninputs: [a]\n" }), NOC_OK);
    assert_int_equal(noc_recipe_load(path, log, &recipe), NOC_ERR_FORMAT);
    assert_non_null(strstr(noc_log_last_error(log), "city.noct:2: the recipe of a built city names no inputs"));
    noc_scene_destroy(scene);
    noc_log_destroy(log);
}

/* ---- memory ---- */

static void test_memory(void **state) {
    (void)state;
    bool reached;
    noc_report *report, *after;
    noc_scene *city = make_city(&report);
    noc_log *log = counting_log(), *own = city->log;
    const char *inputs[] = { path };
    city->log = log;
    FOR_EACH_REFUSAL(reached) {
        unlink(path);
        begin_refusal(n, later);
        noc_status status = noc_scene_save(city, path, &(noc_save_params){ report, "nocturne: 1\n" });
        reached = end_refusal();
        if (status)
            assert_refused(status, "save");
        assert_int_equal(access(path, F_OK), status ? -1 : 0);
    }
    FOR_EACH_REFUSAL(reached) {
        noc_scene *scene = noc_scene_create(log);
        begin_refusal(n, later);
        noc_status status = noc_scene_load(scene, inputs, 1, NULL, &after);
        reached = end_refusal();
        if (status)
            assert_refused(status, "load");
        else
            assert_unharmed(scene->triangle_light.len == city->triangle_light.len, "load");
        noc_report_destroy(after);
        noc_scene_destroy(scene);
    }
    city->log = own;
    noc_report_destroy(report);
    noc_scene_destroy(city);
    noc_log_destroy(log);
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(test_damage),   cmocka_unit_test(test_hostile),
                                        cmocka_unit_test(test_together), cmocka_unit_test(test_shown),
                                        cmocka_unit_test(test_alone),    cmocka_unit_test(test_recipe),
                                        cmocka_unit_test(test_memory) };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
