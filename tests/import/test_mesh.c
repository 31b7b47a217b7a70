/* OBJ and MTL: units, axes, emission, gloss, n-gons, missing libraries, broken files. */
#include "mesh_file.h"

#include <math.h>

/* takes the map's origin off, as the importer does */
static noc_status from_munich(void *ctx, double *xyz, size_t count) {
    for (size_t i = 0; i < count; i++) {
        xyz[3 * i] -= 678100;
        xyz[3 * i + 1] -= 5403580;
    }
    return NOC_OK;
}

static noc_status (*place_by)(void *, double *, size_t) = as_it_is;

static void load(loaded *l, const char *name, noc_obj_up up) {
    noc_import_params params = noc_import_default_params();
    params.obj_up = up;
    load_with(l, &noc_reader_mesh, name, &params, &(mesh_place){ NULL, place_by });
}

static const char obj[] = "# a test\n"
                          "mtllib test.mtl\n"
                          "o floor\n"
                          "v 0 0 0\nv 10 0 0\nv 10 0 -10\nv 5 0 -12\nv 0 0 -10\n"
                          "usemtl ground\n"
                          "f 1 2 3 4 5\n"
                          "o lamp\n"
                          "v 4 5 -4\nv 5 5 -4\nv 5 5 -5\n"
                          "usemtl glow\n"
                          "f 8 7 6\n"
                          "l 1 2\n";
static const char mtl[] = "newmtl ground\nKd 0.2 0.3 0.4\nKs 0.04 0.04 0.04\nNs 98\nillum 2\n"
                          "newmtl glow\nKd 0.9 0.9 0.9\nKs 0.5 0.5 0.5\nNs 0\nKe 12000 8000 4000.5\nd 0.5\nillum 2\n";

static const noc_material *material_of(const loaded *l, const char *mesh) {
    for (size_t i = 0; i < l->scene->meshes.len; i++)
        if (!strcmp(l->scene->meshes.data[i].name, mesh))
            return &l->scene->materials.data[l->scene->meshes.data[i].material];
    fail_msg("no mesh %s", mesh);
    return NULL;
}

static void test_reads(void **state) {
    loaded l;
    write_file("test.mtl", mtl, strlen(mtl));
    write_file("named.anything", obj, strlen(obj)); /* the content decides */
    load(&l, "named.anything", NOC_OBJ_UP_Y);
    assert_int_equal(l.status, NOC_OK);
    assert_int_equal(l.warnings + l.errors, 0);
    assert_string_equal(l.format, "OBJ");
    noc_scene_info info;
    noc_scene_get_info(l.scene, &info);
    assert_int_equal(info.triangles, 4); /* a pentagon and a triangle; lines are left out */
    assert_float_equal(info.bounds_max[1], 12, 1e-5);
    assert_float_equal(info.bounds_max[2], 5, 1e-5);
    const noc_material *ground = material_of(&l, "floor"), *glow = material_of(&l, "lamp");
    assert_float_equal(ground->albedo[1], .3, 1e-6);
    assert_float_equal(ground->f0, .04, 1e-6);
    assert_float_equal(ground->roughness * ground->roughness, sqrt(2. / 100), 1e-5); /* alpha^2 = 2 / (98 + 2) */
    assert_float_equal(glow->emission[0], 12000, 1e-2);
    assert_float_equal(glow->emission[2], 4000.5, 1e-2);
    assert_true(glow->albedo[0] + glow->f0 <= 1.00001f);
    assert_int_equal(geo_issues_count(l.issues), 1); /* transparency */
    assert_int_equal(noc_scene_commit(l.scene), NOC_OK);
    assert_int_equal(l.scene->lights.len, 1);
    const noc_light_record *r = l.scene->lights.data;
    assert_true(r->a[0] * r->b[1] - r->a[1] * r->b[0] < 0); /* wound to face down; the turn of axes keeps it */
    assert_int_equal(r->flags & LIGHT_TWO_SIDED, 0);        /* and its back is dark */
    unload(&l);
    load(&l, "named.anything", NOC_OBJ_UP_Z);
    noc_scene_get_info(l.scene, &info);
    assert_float_equal(info.bounds_min[2], -12, 1e-5);
    assert_float_equal(info.bounds_max[1], 5, 1e-5);
    unload(&l);
}

/* What an MTL says of glass: d and Tr, else its illum with its Tf. Glass that does not say how clear it is is opaque,
 * and counted. */
static void test_glass(void **state) {
    (void)state;
    static const struct {
        const char *text;
        float transmittance;
        size_t issues;
    } rows[] = { { "d 0.05\n", .95f, 0 },
                 { "Tr 0.95\n", .95f, 0 },
                 { "d 0.05\nillum 4\nTf 0.5 0.5 0.5\n", .95f, 0 },
                 { "illum 4\nTf 0.9 0.9 0.9\n", .9f, 1 },
                 { "illum 9\nTf 1 0.5 0\n", .2126f + .3576f, 2 }, /* whose colour is not kept */
                 { "d 0.05\nTf 1 0.5 0\n", .95f, 1 },
                 { "illum 7\nTf 1 1 1\n", 0, 1 },
                 { "illum 6\n", 0, 1 },
                 { "illum 2\nTf 0.9 0.9 0.9\n", 0, 0 } };
    static const char text[] = "mtllib glass.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\no pane\nusemtl a\nf 1 2 3\n";
    write_file("glass.obj", text, strlen(text));
    for (size_t i = 0; i < NOC_COUNT(rows); i++) {
        char library[80];
        loaded l;
        snprintf(library, sizeof(library), "newmtl a\nKd 0.1 0 0\n%s", rows[i].text);
        write_file("glass.mtl", library, strlen(library));
        load(&l, "glass.obj", NOC_OBJ_UP_Y);
        assert_int_equal(l.status, NOC_OK);
        assert_float_equal(material_of(&l, "pane")->transmittance, rows[i].transmittance, 1e-6);
        assert_int_equal(geo_issues_count(l.issues), rows[i].issues);
        unload(&l);
    }
}

/* Of each mesh its name, its material's red and its triangles. */
static void test_names(void **state) {
    static const char library[] = "newmtl a\nKd 0.1 0 0\nnewmtl b\nKd 0.2 0 0\n";
    static const char text[] = "mtllib ab.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv .5 2 0\n"
                               "usemtl a\nf 1 2 3\n"           /* no name: defaultobject */
                               "o one two\nf 1 2 3\nf 1 2 3\n" /* the first word; the material goes on */
                               "usemtl b\nf 1 2 3\n"           /* in no group: called as its material */
                               "usemtl b\nf 2 3 4\n"           /* the same mesh */
                               "g north side\nusemtl a\n"      /* all words */
                               "f 1 2 3\nf 1 2 3 4\nf 2 3 4\n" /* triangles come first, the others in a mesh behind */
                               "g north side\nf 1 2 4\n"       /* the same group */
                               "usemtl b\nf 1 2 3\n"           /* called as its group */
                               "o empty\ng empty\no last\nf 1 2 3 5 4\n";
    static const struct {
        const char *name;
        float red;
        size_t triangles;
    } expected[] = { { "defaultobject", .1f, 1 }, { "one", .1f, 2 },        { "b", .2f, 2 },   { "north side", .1f, 3 },
                     { "north side", .1f, 2 },    { "north side", .2f, 1 }, { "last", .2f, 3 } };
    loaded l;
    write_file("ab.mtl", library, strlen(library));
    write_file("names.obj", text, strlen(text));
    load(&l, "names.obj", NOC_OBJ_UP_Y);
    assert_int_equal(l.status, NOC_OK);
    assert_int_equal(l.scene->meshes.len, NOC_COUNT(expected));
    for (size_t i = 0; i < NOC_COUNT(expected); i++) {
        const noc_scene_mesh *m = &l.scene->meshes.data[i];
        assert_string_equal(m->name, expected[i].name);
        assert_float_equal(l.scene->materials.data[m->material].albedo[0], expected[i].red, 1e-6);
        assert_int_equal(m->triangle_count, expected[i].triangles);
    }
    unload(&l);
}

/* Vertices that hold the same are one, whatever their numbers; a float is the nearest to what is written. */
static void test_shared_vertices(void **state) {
    enum { SIDE = 40 };
    char *text = malloc(SIDE * SIDE * 200), *to = text;
    assert_non_null(text);
    for (int i = 0; i < SIDE * SIDE; i++) { /* each square with vertices of its own */
        static const int corner[4][2] = { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 1 } };
        for (int k = 0; k < 4; k++)
            to += sprintf(to, "v %s%d.1 %d.123456789 -0\n", k % 2 ? "" : "+", i % SIDE + corner[k][0],
                          i / SIDE + corner[k][1]);
        to += sprintf(to, "f -4 -3 -2 -1\n");
    }
    loaded l;
    write_file("names.obj", text, strlen(text));
    free(text);
    load(&l, "names.obj", NOC_OBJ_UP_Z);
    assert_int_equal(l.scene->indices.len / 3, 2 * SIDE * SIDE);
    assert_int_equal(l.scene->positions.len / 3, (SIDE + 1) * (SIDE + 1));
    for (size_t i = 0; i < l.scene->positions.len; i += 3) {
        const float *v = l.scene->positions.data + i;
        assert_true(v[0] == (float)(floor((double)v[0]) + .1) && v[1] == (float)(floor((double)v[1]) + .123456789));
        assert_true(v[2] == 0 && !signbit(v[2]));
    }
    unload(&l);
}

/* Floats have a step of 0.5 m at a northing of 5.4e6: stairs in map coordinates must keep theirs of 0.17 m. */
static void test_map_coordinates(void **state) {
    loaded l;
    char text[4000];
    for (int up = 0; up < 2; up++) {
        /* a stray vertex at zero comes first; one has a weight, one a colour */
        int n = snprintf(text, sizeof(text), "v 0 0 0\n");
        for (int i = 0; i < 20; i++) {
            double e = 678100.25, north = 5403580.5 + .17 * i, h = 517 + .17 * i;
            double y = up == NOC_OBJ_UP_Z ? north : h, z = up == NOC_OBJ_UP_Z ? h : -north;
            if (i == 3)
                n += snprintf(text + n, sizeof(text) - (size_t)n, "v %.3f %.3f %.3f 2\r\n", 2 * e, 2 * y, 2 * z);
            else
                n += snprintf(text + n, sizeof(text) - (size_t)n, "  v %.3f %.3f %.3f%s\r\n", e, y, z,
                              i == 5 ? " 1 0 0" : "");
            n += snprintf(text + n, sizeof(text) - (size_t)n, "v %.3f %.3f %.3f\n", e + 2, y, z);
        }
        n += snprintf(text + n, sizeof(text) - (size_t)n, "o stair\n");
        for (int i = 0; i < 19; i++)
            n += snprintf(text + n, sizeof(text) - (size_t)n, "f %d %d %d\n", 2 * i + 2, 2 * i + 3, 2 * i + 4);
        write_file("map.obj", text, (size_t)n);
        place_by = from_munich;
        load(&l, "map.obj", (noc_obj_up)up);
        place_by = as_it_is;
        assert_int_equal(l.status, NOC_OK);
        assert_int_equal(l.scene->indices.len, 19 * 3);
        bool seen[20] = { 0 };
        for (size_t i = 0; i < l.scene->indices.len; i++) {
            const float *v = &l.scene->positions.data[3 * (size_t)l.scene->indices.data[i]];
            int step = (int)lround((v[1] - .5) / .17);
            assert_in_range(step, 0, 19);
            seen[step] = true;
            assert_float_equal(v[0], v[0] > 1 ? 2.25 : .25, 2e-4);
            assert_float_equal(v[1], .5 + .17 * step, 2e-4);
            assert_float_equal(v[2], 517 + .17 * step, 2e-4);
        }
        for (int i = 0; i < 20; i++)
            assert_true(seen[i]);
        unload(&l);
    }
}

static bool has_issue(const loaded *l, const char *reason, size_t count, const char *example) {
    for (size_t i = 0; i < geo_issues_count(l->issues); i++) {
        const char *r, *examples;
        bool repaired;
        size_t n;
        assert_true(geo_issues_get(l->issues, i, &r, &repaired, &n, &examples));
        if (!strcmp(r, reason))
            return n == count && strstr(examples, example);
    }
    return false;
}

/* A bad face costs itself, not the file; those around it, and indices of every spelling, stay. */
static void test_bad_faces(void **state) {
    static const char text[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\n"
                               "f 1 2 3\n"
                               "f 1 2 4\n" /* line 7: the vertex comes later, which is right */
                               "f -1 -2 -3\n"
                               "f -1 -2 -4\n" /* line 9: bad, before the fourth vertex */
                               "v 1 1 0\n"
                               "f -1 -2 -4\n"
                               "f 1/1/1 2/1/1 3/1/1\n"
                               "f 1//1 2//1 3//1\n"
                               "f 1/1 2/1 3/1 # a remark\n"
                               "f 1/2 2/1 3/1\n"                 /* no second texture place, but it is not used */
                               "f 1//1 2//1 3//9\n"              /* nor is a ninth normal */
                               "f 0 1 2\n"                       /* line 17 */
                               "f 1 2 99999999999999999999999\n" /* line 18 */
                               "f 1 2 \\\n 77\n"                 /* lines 19 and 20 */
                               "f 1 2 \\\r\n 3\r\n"
                               "f one two three\n"; /* line 23 */
    loaded l;
    write_file("faces.obj", text, strlen(text));
    load(&l, "faces.obj", NOC_OBJ_UP_Y);
    assert_int_equal(l.status, NOC_OK);
    assert_int_equal(l.errors + l.warnings, 0);
    assert_int_equal(l.scene->indices.len / 3, 10);
    assert_true(has_issue(&l, "face with an index that is not there", 5, "line 9, line 17, line 18, line 19, line 23"));
    unload(&l);
}

static void load_text(loaded *l, const char *text) {
    write_file("bad.obj", text, strlen(text));
    load(l, "bad.obj", NOC_OBJ_UP_Z);
}

static double total_area(const loaded *l) {
    double sum = 0;
    for (size_t i = 0; i < l->scene->indices.len; i += 3) {
        double v[3][3], n[3];
        for (size_t c = 0; c < 3; c++)
            for (size_t k = 0; k < 3; k++)
                v[c][k] =
                    (double)l->scene->positions.data[3 * (size_t)l->scene->indices.data[i + c] + k] - (c ? v[0][k] : 0);
        for (int k = 0; k < 3; k++)
            n[k] = v[1][(k + 1) % 3] * v[2][(k + 2) % 3] - v[1][(k + 2) % 3] * v[2][(k + 1) % 3];
        sum += sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) / 2;
    }
    return sum;
}

/* Vertices in every spelling; one that is none costs its faces, and moves no other's number. */
static void test_vertices(void **state) {
    static const struct {
        const char *text;
        double area;
        const char *bad;
    } texts[] = {
        { "\xef\xbb\xbfv 0 0 0\nv 2 0 0\nv 0 2 0\nf 1 2 3\n", 2, NULL },
        { "  v 0 0 0\n\tv +2 +0 0\n v .0 2. 0\n  f 1 2 3\n", 2, NULL },
        { "v 0 0 0 1\nv 4 0 0 2\nv 0 2 0 1.0\nf 1 2 3\n", 2, NULL },
        { "v 0 0 0 .5 .5 .5\nv 2 0 0 1 0\nv 0 2 0 # here\nf 1 2 3\n", 2, NULL },
        { "v 0 \\\n 0 0\nv 2 0 \\\r\n 0\r\nv 0 2 0\r\nf 1 2 \\\r\n 3\r\n", 2, NULL },
        { "v 0 0 0\nv 9 9\nv 2 0 0\nv 0 2 0\nf 1 2 3\nf 1 3 4\n", 2, "line 2" },
        { "v 0 0 0\nv a b c\nv 2 0 0\nv 0 2 0\nf 1 2 3\nf 1 3 4\n", 2, "line 2" },
        { "v 0 0 0\nv 1 1 1 0\nv 2 0 0\nv 0 2 0\nf 1 2 3\nf 1 3 4\n", 2, "line 2" },
        { "v 0 0 0\nv 1e400 \\\n 0 0\nv 2 0 0\nv nan 0 0\nv 0 2 0\nf 1 2 3\nf 1 3 5\n", 2, "line 2, line 5" },
        { "v nan 0 0\nv 0 0 0\nv 2 0 0\nv 0 2 0\nf 1 2 3\nf 2 3 4\nf -3 -4 -2\n", 2, "line 1" },
        { "v 1e300 -inf 0\rv 0 0 0\rv 2 0 0\rv 0 2 0\rf 1 2 3\rf 2 3 4\r", 2, "line 1" },
        { "v 0 0 0\nv 2 0 0\nv 0 2 0\nvt\nvt a\nvn 1\nvn nan nan nan\nf 1/1/1 2/2/2 3/3/3\n", 2, NULL },
        { "v 0 0 0\nv 2e-5 0 0\nv 0 2e-5 0\nv 2e-5 +2e-5 0\nf 1 2 4 3\n", 4e-10, NULL },
    };
    for (size_t i = 0; i < NOC_COUNT(texts); i++) {
        loaded l;
        load_text(&l, texts[i].text);
        assert_string_equal(l.error, "");
        assert_int_equal(l.status, NOC_OK);
        assert_float_equal(total_area(&l), texts[i].area, 1e-5 * texts[i].area);
        if (texts[i].bad) /* told, and so are the faces that would need it */
            assert_true(
                has_issue(&l, "vertex that is not three numbers", strchr(texts[i].bad, ',') ? 2 : 1, texts[i].bad));
        else
            assert_int_equal(geo_issues_count(l.issues), 0);
        unload(&l);
    }
}

/* The area is what is inside, whatever the shape, the size and the number of corners. */
static void test_polygons(void **state) {
    static const char *const shapes[] = {
        "v 0 0 0\nv %g 0 0\nv %g %g 0\nv 0 %g 0\nf 1 2 3 4\n",
        "v 0 0 0\nv %g 0 0\nv %g %g 0\nv 0 %g 0\nf 2 3 4 1\n",
    };
    loaded l;
    for (size_t i = 0; i < NOC_COUNT(shapes); i++)
        for (double s = 1e-2; s < 2e4; s *= 1e3) {
            char text[400];
            /* an arrow: the third corner is pushed in */
            snprintf(text, sizeof(text), shapes[i], s, .25 * s, .25 * s, s);
            load_text(&l, text);
            assert_int_equal(l.scene->indices.len, 6);
            assert_float_equal(total_area(&l) / (s * s), .25, 1e-5); /* two triangles of 1 by 1/4 */
            unload(&l);
        }
    load_text(&l, "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 2 1 0\nv 0 4 0\nf 1 2 3 4 5\n");
    assert_float_equal(total_area(&l), 16 - 6, 1e-4); /* a square less a wedge 4 wide and 3 deep */
    unload(&l);
    load_text(&l, "v 0 0 0\nv 2 2 0\nv 2 0 0\nv 0 2 0\nf 1 2 3 4\n");
    assert_float_equal(total_area(&l), 2, 1e-4); /* a bow tie: two triangles that meet where its edges cross */
    unload(&l);
    enum { CORNERS = 100000 };
    char *text = malloc(64 * (size_t)CORNERS), *to = text;
    assert_non_null(text);
    for (int i = 0; i < CORNERS; i++)
        to += sprintf(to, "v %.6f %.6f 7\n", 1000 * cos(2 * M_PI * i / CORNERS), 1000 * sin(2 * M_PI * i / CORNERS));
    to += sprintf(to, "f");
    for (int i = 0; i < CORNERS; i++)
        to += sprintf(to, " %d", i + 1);
    load_text(&l, text);
    assert_float_equal(total_area(&l) / (M_PI * 1e6), 1, 1e-4);
    unload(&l);
    free(text);
    load_text(&l, "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1\nf 1 2\nf\nf 1 1 1\nf 1 2 2\nf 1 2 3\n");
    assert_int_equal(l.scene->indices.len, 3);
    assert_true(has_issue(&l, "face of fewer than three vertices", 2, "line 4, line 5"));
    unload(&l);
    /* nothing that can be drawn is no error of the file's */
    load_text(&l, "v 0 0 0\nv 1 0 0\nv 1 1 0\nl 1 2 3\nf 1 2 9\n");
    assert_int_equal(l.status, NOC_OK);
    assert_int_equal(l.errors + (int)l.scene->indices.len, 0);
    unload(&l);
}

/* Libraries under names as they are found in the wild, and with lines that are none. */
static void test_libraries(void **state) {
    static const char *const names[] = { "my test.mtl",      "my test.mtl  \r",      "C:\\work\\my test.mtl",
                                         "sub\\my test.mtl", "/nowhere/my test.mtl", "test.mtl other.mtl" };
    static const char good[] = "newmtl a\nKd 0.1 0.2 0.3\nKe 5 6 7\nnewmtl b\nKd 1 1 1\n";
    static const char odd[] =
        "newmtl a\nKd nan inf -3\n Kd 0.1 0.2 0.3\nKe 1e400 nan 1\nKe spectral x.rfl\nNs\nd -halo\nKe 5 6 7\n"
        "map_Kd wall.png\n\xff\xfe\n";
    loaded l;
    write_file("my test.mtl", good, strlen(good));
    write_file("other.mtl", "newmtl c\nKd 1 0 0\n", 18);
    for (size_t i = 0; i <= NOC_COUNT(names); i++) {
        char text[300];
        write_file("test.mtl", i < NOC_COUNT(names) ? good : odd, strlen(i < NOC_COUNT(names) ? good : odd));
        snprintf(text, sizeof(text), "mtllib %s\nv 0 0 0\nv 1 0 0\nv 0 1 0\no it\nusemtl a\nf 1 2 3\n",
                 i < NOC_COUNT(names) ? names[i] : "test.mtl");
        load_text(&l, text);
        assert_string_equal(l.error, "");
        assert_string_equal(l.warning, "");
        const noc_material *m = material_of(&l, "it");
        assert_float_equal(m->albedo[1], .2, 1e-6);
        assert_float_equal(m->emission[2], 7, 1e-6);
        if (i == NOC_COUNT(names)) {
            assert_true(
                has_issue(&l, "material statement with a number that is none", 5, "test.mtl line 2, test.mtl line 4"));
            assert_true(has_issue(&l, "texture without places in it, plain material", 1, "a"));
        }
        unload(&l);
    }
}

static void test_missing_library(void **state) {
    loaded l;
    const char text[] = "mtllib sub/none.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n";
    write_file("missing.obj", text, strlen(text));
    load(&l, "missing.obj", NOC_OBJ_UP_Y);
    assert_int_equal(l.status, NOC_OK);
    assert_int_equal(l.warnings, 1);
    assert_non_null(strstr(l.warning, "sub/none.mtl"));
    assert_int_equal(l.scene->indices.len, 3);
    unload(&l);
}

/* Counted, and no lossless repair, wherever it is asked for. */
static void test_missing_material(void **state) {
    loaded l;
    const char text[] =
        "mtllib test.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl nowhere\nf 1 2 3\nusemtl ground\nf 1 2 3\nusemtl nowhere\n"
        "f 1 3 2\n";
    write_file("test.mtl", mtl, strlen(mtl));
    write_file("material.obj", text, strlen(text));
    load(&l, "material.obj", NOC_OBJ_UP_Y);
    assert_int_equal(l.status, NOC_OK);
    assert_true(has_issue(&l, "material that is not there, the default one instead", 2, "nowhere"));
    assert_int_equal(geo_issues_count(l.issues), 1);
    assert_int_equal(geo_issues_kind(l.issues, 0), GEO_GUESSED);
    unload(&l);
}

static void test_probe(void **state) {
    static const char *const yes[] = { "v 1 2 3\n",
                                       "# x\n\nmtllib a.mtl\no b\nv 1",
                                       "\r\ng roof\r\nusemtl x\r\n",
                                       "v 1 2 \\\n 3\nf 1 2 \\\r\n 3\n",
                                       "\xef\xbb\xbfv 1 2 3\n",
                                       "v 1 2 3\ncstype bezier\ncurv 0 1 1 2\nend\n" };
    static const char *const no[] = { "",
                                      "<?xml version='1.0'?>",
                                      "{\"a\": 1}",
                                      "vertex 1 2 3\n",
                                      "lon,lat,lamp\n1,2,3\n",
                                      "ply\nformat ascii 1.0\n",
                                      "# only a comment\n",
                                      "\xef\xbb\xbf{}" };
    for (size_t i = 0; i < NOC_COUNT(yes); i++)
        assert_true(noc_reader_mesh.probe(yes[i], strlen(yes[i])));
    for (size_t i = 0; i < NOC_COUNT(no); i++)
        assert_false(noc_reader_mesh.probe(no[i], strlen(no[i])));
}

/* Cut, with bytes changed, with mad indices: an error with the file's name, or a scene; never a crash. */
static void test_broken(void **state) {
    static const char *const bad[] = { "v 0 0 0\nf 1 2 3\n# an index too large\n",
                                       "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -7 -8 -9\n# negative\n",
                                       "v nan inf 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n# numbers\n",
                                       "v\nv 1\nf\nf 1\nusemtl\nmtllib\no\ng\n",
                                       "f 99999999999999999999 1 2\nv 1 2 3\n# overflow\n",
                                       "v 1 2 3\n",
                                       "o only\ng names\n# no faces\n" };
    loaded l;
    for (size_t i = 0; i < NOC_COUNT(bad); i++) {
        write_file("bad.obj", bad[i], strlen(bad[i]));
        load(&l, "bad.obj", NOC_OBJ_UP_Y);
        assert_int_equal(l.errors, l.status != NOC_OK);
        if (l.status)
            assert_non_null(strstr(l.error, "bad.obj"));
        unload(&l);
    }
    uint32_t seed = 1;
    for (int i = 0; i < 400; i++) {
        char text[sizeof(obj)], library[sizeof(mtl)];
        memcpy(text, obj, sizeof(obj));
        memcpy(library, mtl, sizeof(mtl));
        size_t size = strlen(obj);
        for (int k = 0; k < i % 7; k++) {
            seed = seed * 1664525u + 1013904223u;
            text[(seed >> 8) % size] = (char)(seed >> 3);
            library[(seed >> 7) % strlen(mtl)] = (char)(seed >> 5);
        }
        if (i % 2)
            size = size * (size_t)(i % 50) / 50 + 1;
        write_file("test.mtl", library, strlen(mtl));
        write_file("bad.obj", text, size);
        load(&l, "bad.obj", NOC_OBJ_UP_Y);
        assert_int_equal(l.errors > 0, l.status != NOC_OK);
        unload(&l);
    }
}

static int set_up(void **state) { return make_mesh_folder(); }

static int tear_down(void **state) {
    static const char *const files[] = { "test.mtl",  "named.anything", "missing.obj", "material.obj", "bad.obj",
                                         "map.obj",   "faces.obj",      "my test.mtl", "other.mtl",    "ab.mtl",
                                         "names.obj", "glass.obj",      "glass.mtl" };
    return remove_mesh_folder(files, NOC_COUNT(files));
}

int main(void) {
    if (noc_reader_mesh.missing) {
        print_message("1..0 # SKIP built without Assimp\n");
        return 0;
    }
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_reads),
        cmocka_unit_test(test_map_coordinates),
        cmocka_unit_test(test_glass),
        cmocka_unit_test(test_names),
        cmocka_unit_test(test_shared_vertices),
        cmocka_unit_test(test_missing_library),
        cmocka_unit_test(test_missing_material),
        cmocka_unit_test(test_bad_faces),
        cmocka_unit_test(test_vertices),
        cmocka_unit_test(test_polygons),
        cmocka_unit_test(test_libraries),
        cmocka_unit_test(test_probe),
        cmocka_unit_test(test_broken),
    };
    return cmocka_run_group_tests_name("import/mesh", tests, set_up, tear_down);
}
