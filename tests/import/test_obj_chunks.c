/* The text of an OBJ says the same whole and in chunks, for any number of threads. */
#include "import/mesh/obj_materials.h"
#include "import/mesh/obj_text.h"
#include "test.h"

#include <stdio.h>

static unsigned number;

static unsigned draw(unsigned below) {
    number = number * 1664525u + 1013904223u;
    return (number >> 8) % below;
}

/* Statements of all kinds, good and bad, in an order that leaves nothing to the chunks' ends. */
static char *write_text(size_t statements, size_t *size) {
    char *text = NULL;
    FILE *f = open_memstream(&text, size);
    for (size_t i = 0; i < statements; i++)
        switch (draw(24)) {
        case 0: fprintf(f, "o house%u and more\n", draw(3)); break;
        case 1: fprintf(f, "g row%u\n", draw(3)); break;
        case 2: fprintf(f, "  usemtl paint%u\n", draw(4)); break;
        case 3: fprintf(f, "v nowhere %u\n", draw(9)); break;
        case 4: fprintf(f, "f 1 2 %u\n", 1 + draw(1000000)); break;
        case 5: fputs("f -1 -2\ng \nusemtl\no\n", f); break;
        case 6: fprintf(f, "v 1 \\\r\n 2 \\\n %u # v 9 9 9\n", draw(9)); break;
        case 7: fputs("# v 1 2 3 \\\nv 7 7 7\n\n\r\n", f); break;
        case 8: fputs("vt 1e9 x\nvt .5\n", f); break;
        case 9: fprintf(f, "f -1/-1 -2/-1 -3/%u\n", draw(2000)); break;
        case 10: fputs("f -1/1 \\\n-2/1 \\\n-3/1 \\\n-4/1\n", f); break;
        case 11: fprintf(f, "mtllib none%u.mtl\n", draw(2)); break;
        case 12: fprintf(f, "vt .%u %u\nvn 0 0 1\n", draw(999), draw(3)); break;
        case 13:
        case 14:
        case 15:
        case 16: fprintf(f, "f -%u -%u//-1 -%u\n", 1 + draw(4), 1 + draw(4), 1 + draw(9)); break;
        default: fprintf(f, "v %u.%u -%u 3\n", draw(999), draw(999), draw(99));
        }
    fputs("f -1 -2 -3", f);
    fclose(f);
    return text;
}

/* threads: 0: all in one chunk. */
static obj_text read_text(const char *text, size_t size, int threads, bool places, geo_issues *issues) {
    char *copy = strdup(text), empty[] = "/";
    obj_chunks chunks = { 0 };
    obj_text t = { 0 };
    obj_folder folder = { .path = empty, .why = "" };
    obj_images none = { 0 };
    import_budget budget = { .memory = 1e9 };
    assert_true(obj_chunks_cut(&chunks, copy, size, NOC_MAX(threads, 1)));
    assert_true(chunks.list.len > 9);
    if (!threads) {
        chunks.list.data[0].end = copy + size;
        chunks.list.len = 1;
    }
    assert_int_equal(obj_plain_materials(&chunks, &folder, places ? &none : NULL, &budget, issues, "x.obj", NULL), 0);
    assert_true(obj_text_read(&t, &chunks, places, issues));
    obj_chunks_free(&chunks);
    obj_images_free(&none);
    free(folder.missing);
    free(copy);
    return t;
}

#define assert_same(a, b)                                                                                              \
    (assert_int_equal((a).len, (b).len), assert_memory_equal((a).data, (b).data, (a).len * sizeof(*(a).data)))

static void assert_same_text(const obj_text *a, const obj_text *b) {
    assert_same(a->xyz, b->xyz); /* NAN, too */
    if (a->uv.len || b->uv.len)
        assert_same(a->uv, b->uv);
    assert_same(a->faces, b->faces);
    assert_same(a->corners, b->corners);
    if (a->uv_index.len || b->uv_index.len)
        assert_same(a->uv_index, b->uv_index);
    assert_int_equal(a->meshes.len, b->meshes.len);
    for (size_t i = 0; i < a->meshes.len; i++) {
        const obj_mesh *m = &a->meshes.data[i], *n = &b->meshes.data[i];
        assert_string_equal(m->name, n->name);
        assert_string_equal(m->material ? m->material : "", n->material ? n->material : "");
        assert_int_equal(m->first_face, n->first_face);
        assert_int_equal(m->first_corner, n->first_corner);
        assert_int_equal(m->placed, n->placed);
    }
}

static void assert_same_issues(geo_issues *a, geo_issues *b) {
    assert_int_equal(geo_issues_count(a), geo_issues_count(b));
    for (size_t i = 0; i < geo_issues_count(a); i++) {
        const char *reason[2], *examples[2];
        bool repaired[2];
        size_t count[2];
        assert_true(geo_issues_get(a, i, &reason[0], &repaired[0], &count[0], &examples[0]));
        assert_true(geo_issues_get(b, i, &reason[1], &repaired[1], &count[1], &examples[1]));
        assert_string_equal(reason[0], reason[1]);
        assert_string_equal(examples[0], examples[1]);
        assert_int_equal(count[0], count[1]);
        assert_int_equal(repaired[0], repaired[1]);
    }
}

static void chunks_say_what_the_whole_says(void **state) {
    for (int round = 0; round < 4; round++) {
        size_t size;
        char *text = write_text(60000, &size);
        geo_issues *issues = geo_issues_create();
        obj_text whole = read_text(text, size, 0, round % 2, issues);
        assert_true(geo_issues_count(issues) >= 4 && whole.meshes.len > 100 && whole.faces.len > 1000);
        for (int threads = 1; threads <= 3; threads++) {
            geo_issues *again = geo_issues_create();
            obj_text t = read_text(text, size, threads, round % 2, again);
            assert_same_text(&whole, &t);
            assert_same_issues(issues, again);
            geo_issues_destroy(again);
            obj_text_free(&t);
        }
        obj_text_free(&whole);
        geo_issues_destroy(issues);
        free(text);
    }
}

/* Lines that one number tells: those of the file. */
static void lines_are_those_of_the_file(void **state) {
    size_t size;
    char *text = NULL;
    FILE *f = open_memstream(&text, &size);
    for (int i = 1; i <= 100000; i++)
        fputs(i == 70000 ? "v nowhere\n" : i == 90000 ? "f 1 2 99999999\n" : "v 1 2 3\n", f);
    fclose(f);
    geo_issues *issues = geo_issues_create();
    obj_text t = read_text(text, size, 2, false, issues);
    const char *reason, *examples;
    bool repaired;
    size_t count;
    assert_int_equal(geo_issues_count(issues), 2);
    assert_true(geo_issues_get(issues, 0, &reason, &repaired, &count, &examples));
    assert_string_equal(examples, "line 70000");
    assert_true(geo_issues_get(issues, 1, &reason, &repaired, &count, &examples));
    assert_string_equal(examples, "line 90000");
    obj_text_free(&t);
    geo_issues_destroy(issues);
    free(text);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(chunks_say_what_the_whole_says),
        cmocka_unit_test(lines_are_those_of_the_file),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
