/* Appearances of CityJSON: themes, what is told at each depth of the lists, templates, sequences, and what is wrong. */
#include "looks.h"

/* Walls at x = 0 to 5, each 5 m wide and high: corners 4n to 4n + 3, counter-clockwise from the foot at y = 0. */
#define CORNERS(x) "[" x ",0,0],[" x ",5,0],[" x ",5,5],[" x ",0,5]"
#define VERTICES                                                                                                       \
    "'vertices':[" CORNERS("0") "," CORNERS("1") "," CORNERS("2") "," CORNERS("3") "," CORNERS("4") "," CORNERS("5") "]"
#define WALLS "[[0,1,2,3]],[[4,5,6,7]],[[8,9,10,11]],[[12,13,14,15]],[[16,17,18,19]],[[20,21,22,23]]"
#define FILE(appearance, geometry)                                                                                     \
    "{'type':'CityJSON','version':'2.0','transform':{'scale':[1,1,1],'translate':[0,0,0]},'appearance':{" appearance   \
    "},'CityObjects':{'b':{'type':'Building','geometry':[{" geometry "}]}}," VERTICES "}"
#define SEMANTICS "'semantics':{'surfaces':[{'type':'WallSurface'}],'values':"
#define PLACES "'vertices-texture':[[0,0],[1,0],[1,1],[0,1]]"
#define MATERIALS                                                                                                      \
    "'materials':[{'name':'orange','diffuseColor':[1,0.5,0],'shininess':0},{'name':'grey','diffuseColor':[0.5,0.5,"    \
    "0.5],'transparency':0.5},{'name':'its name alone'}]"
#define TEXTURES                                                                                                       \
    "'textures':[{'type':'PNG','image':'sub.png','wrapMode':'wrap'},{'type':'JPG','image':'gone.jpg'},"                \
    "{'type':'PNG','image':'../../etc/passwd'}]"

static void write_json(const char *name, const char *text) {
    char *copy = noc_strdup(text);
    for (char *c = copy; *c; c++)
        *c = *c == '\'' ? '"' : *c;
    write_file(name, copy);
    free(copy);
}

static void expect_plain(const noc_scene *s, int number) {
    const noc_material *m = wall_material(s, number);
    assert_true(m->texture == 0 && !wall_number(s, number)->uv);
}

static void expect_image(const noc_scene *s, int number) {
    const noc_material *m = wall_material(s, number);
    assert_true(m->texture == 1 && m->albedo[0] == 1 && s->textures.len == 1);
    expect_upright(s, number);
}

/* sRGB 0.5 is 0.214; the brightest and the darkest colours are 0.9 and 0.02. */
static void expect_orange(const noc_scene *s, int number) {
    const noc_material *m = wall_material(s, number);
    expect_plain(s, number);
    assert_true(m->transmittance == 0);
    assert_true(fabsf(m->albedo[0] - 0.9f) < 1e-6f && fabsf(m->albedo[1] - 0.2140f) < 1e-3f && m->roughness == 1);
}

static void expect_grey(const noc_scene *s, int number) {
    expect_plain(s, number);
    assert_true(fabsf(wall_material(s, number)->albedo[0] - 0.2140f) < 1e-3f);
}

static void test_surfaces(void **state) {
    (void)state;
    noc_report *report;
    write_image("sub.png");
    /* 0: an image. 1: its image is not there, so its material is seen. 2: coordinates for three of four corners, and a
     * material of the other theme. 3: outside. 4: a place that is not there, a material that is not there. 5: nothing.
     */
    write_json("city.json",
               FILE(MATERIALS "," TEXTURES "," PLACES ",'default-theme-material':'night'",
                    "'type':'MultiSurface','lod':'2','boundaries':[" WALLS "]," SEMANTICS "[0,0,0,0,0,0]},"
                    "'material':{'day':{'values':[1,1,1,null,7,null]},'night':{'values':[0,0,null,null,null,null]}},"
                    "'texture':{'t':{'values':[[[0,0,1,2,3]],[[1,0,1,2,3]],[[0,0,1,2]],[[2,0,1,2,3]],[[0,0,1,2,9]],"
                    "[[null]]]}}"));
    noc_scene *s = load("city.json", true, &report);
    expect_image(s, 0);
    expect_orange(s, 1);
    expect_grey(s, 2);
    assert_true(wall_material(s, 2)->transmittance == 0.5f);
    for (int i = 3; i < 6; i++)
        expect_plain(s, i);
    assert_true(wall_material(s, 5)->albedo[0] != wall_material(s, 2)->albedo[0]);
    const char *const reasons[] = { "image that is not there", "image outside of the file's folder",
                                    "do not fit their ring", "material, texture or place in one that is not there" };
    for (size_t i = 0; i < NOC_COUNT(reasons); i++)
        if (told(report, reasons[i]) != 1)
            fail_msg("told %zu times: %s", told(report, reasons[i]), reasons[i]);
    assert_int_equal(noc_report_get_file(report, 0)->images, 1);
    noc_report_destroy(report);
    noc_scene_destroy(s);
    s = load("city.json", false, &report);
    assert_true(!s->textures.len && !s->uv.len && !told(report, "image") && !told(report, "material"));
    noc_report_destroy(report);
    noc_scene_destroy(s);
}

/* The lists are as deep as the type; one material may be that of all. */
static void test_depths(void **state) {
    (void)state;
    static const char *const types[] = { "CompositeSurface", "Solid", "CompositeSolid" };
    static const char *const opens[] = { "", "[", "[[" }, *const closes[] = { "", "]", "]]" };
    for (size_t i = 0; i < NOC_COUNT(types); i++) {
        noc_report *report;
        char *text =
            noc_format(FILE(MATERIALS "," TEXTURES "," PLACES,
                            "'type':'%s','lod':'2','boundaries':[%s" WALLS "%s]," SEMANTICS "[%s0,0,0,0,0,0%s]},"
                            "'material':{'one':{'value':0}},"
                            "'texture':{'a':{'values':[%snull,null,[[null]]%s]},"
                            "'b':{'values':[%snull,[[0,0,1,2,3]],null%s]}}"),
                       types[i], opens[i], closes[i], opens[i], closes[i], opens[i], closes[i], opens[i], closes[i]);
        write_image("sub.png");
        write_json("city.json", text);
        free(text);
        noc_scene *s = load("city.json", true, &report);
        expect_orange(s, 0);
        expect_image(s, 1);
        for (int n = 2; n < 6; n++)
            expect_orange(s, n);
        noc_report_destroy(report);
        noc_scene_destroy(s);
    }
}

/* A hole of an image's surface has places, too: without them the surface has no image. */
static void test_holes(void **state) {
    (void)state;
    noc_report *report;
    write_image("sub.png");
    for (int whole = 0; whole < 2; whole++) {
        char *text = noc_format(
            "{'type':'CityJSON','version':'1.0','appearance':{" TEXTURES "," PLACES "},'CityObjects':{'b':{'type':"
            "'Building','geometry':[{'type':'MultiSurface','lod':2,'boundaries':[[[0,1,2,3],[4,5,6]]]," SEMANTICS
            "[0]},'texture':{'t':{'values':[[[0,0,1,2,3]%s]]}}}]}},'vertices':[[0,0,0],[0,5,0],[0,5,5],[0,0,5],"
            "[0,1,1],[0,1,2],[0,2,1]]}",
            whole ? ",[0,0,3,1]" : "");
        write_json("city.json", text);
        free(text);
        noc_scene *s = load("city.json", true, &report);
        assert_int_equal(wall_material(s, 0)->texture, whole);
        noc_report_destroy(report);
        noc_scene_destroy(s);
    }
}

/* Templates look as the head has it, features as they have it themselves, or else as the head. */
static void test_sequence(void **state) {
    (void)state;
    noc_report *report;
    write_image("sub.png");
    const char *const head =
        "{'type':'CityJSON','version':'2.0','transform':{'scale':[1,1,1],'translate':[0,0,0]},'CityObjects':{},"
        "'vertices':[],'appearance':{" MATERIALS "," TEXTURES "," PLACES "},'geometry-templates':{"
        "'vertices-templates':[[0,0,0],[0,5,0],[0,5,5],[0,0,5]],'templates':[{'type':'MultiSurface','lod':'2',"
        "'boundaries':[[[0,1,2,3]]]," SEMANTICS "[0]},'texture':{'t':{'values':[[[0,0,1,2,3]]]}}}]}}\n";
    const char *const feature =
        "{'type':'CityJSONFeature','id':'b%d','CityObjects':{'b%d':{'type':'Building','geometry':[%s]}},%s"
        "'vertices':[[%d,0,0],[%d,5,0],[%d,5,5],[%d,0,5]]}\n";
    const char *const wall =
        "{'type':'MultiSurface','lod':'2','boundaries':[[[0,1,2,3]]]," SEMANTICS "[0]},'material':{'m':{'value':0}}}";
    const char *const instance =
        "{'type':'GeometryInstance','template':0,'boundaries':[0],'transformationMatrix':[1,0,0,0,0,1,0,0,0,0,1,0,0,0,"
        "0,1]}";
    const char *const own = "'appearance':{'materials':[{'name':'grey','diffuseColor':[0.5,0.5,0.5]}]},";
    char *text = noc_strdup(head);
    for (int i = 0; i < 4; i++) {
        char *one = noc_format(feature, i, i, i == 2 ? instance : wall, i == 1 || i == 2 ? own : "", i, i, i, i);
        char *all = noc_format("%s%s", text, one);
        free(text);
        free(one);
        text = all;
    }
    write_json("city.jsonl", text);
    free(text);
    noc_scene *s = load("city.jsonl", true, &report);
    expect_orange(s, 0);
    expect_grey(s, 1);
    expect_image(s, 2);
    expect_orange(s, 3);
    assert_int_equal(s->materials.data[wall_number(s, 0)->material].cls, NOC_CLASS_WALL);
    assert_int_equal(wall_number(s, 0)->material, wall_number(s, 3)->material);
    noc_report_destroy(report);
    noc_scene_destroy(s);
}

/* What is no appearance is none, whatever it is. */
static void test_odd(void **state) {
    (void)state;
    static const char *const odd[] = {
        "'materials':7,'textures':'x','vertices-texture':{}",
        "'materials':[null,7,{}],'textures':[null,[],{'image':9}],'vertices-texture':[null,[],[1],['a','b']]",
        "'materials':[{'diffuseColor':['a',null,{}],'shininess':[]}],'default-theme-material':5",
        ("'materials':[{'diffuseColor':[1e300,-1e300,9],'specularColor':[1e300,0,0],'shininess':-1e300}],"
         "'textures':[{'image':'sub.png'}],'vertices-texture':[[1e300,-1e300],[0,0],[0,0],[0,0]]"),
    };
    static const char *const of[] = {
        "'material':{'a':{'values':[0,1,2,3,4,5]}},'texture':{'a':{'values':[[[0,0,1,2,3]],[[1,0,0,0,0]]]}}",
        "'material':{'a':7,'b':{'value':[0]},'c':{'values':{}}},'texture':{'a':[],'b':{'values':[7,[7],[[]],[[[]]]]}}",
        "'material':[],'texture':7",
    };
    for (size_t i = 0; i < NOC_COUNT(odd); i++)
        for (size_t k = 0; k < NOC_COUNT(of); k++) {
            noc_report *report;
            char *text = noc_format(FILE("%s", "'type':'MultiSurface','lod':'2','boundaries':[" WALLS "]," SEMANTICS
                                               "[0,0,0,0,0,0]},%s"),
                                    odd[i], of[k]);
            write_json("city.json", text);
            free(text);
            noc_scene *s = load("city.json", true, &report);
            assert_int_equal(noc_report_get_file(report, 0)->polygons_by_class[NOC_CLASS_WALL], 6);
            noc_report_destroy(report);
            noc_scene_destroy(s);
        }
}

/* A real file, beside images of our own. */
static void test_file(void **state) {
    (void)state;
    const char *shared = getenv("NOC_SHARED");
    static const char *const images[] = { "Brick", "Roof", "Wood" };
    char *command = noc_format("cp %s/data/cities/samples/cjval/texture4.city.json %s/city.json 2>/dev/null && mkdir "
                               "%s/appearance && chmod u+w %s/city.json",
                               shared ? shared : "", folder, folder, folder);
    bool there = !system(command);
    free(command);
    if (!there)
        skip();
    noc_report *report;
    noc_scene *s = load("city.json", true, &report);
    assert_true(!s->textures.len);
    assert_int_equal(told(report, "image that is not there"), 3);
    noc_report_destroy(report);
    noc_scene_destroy(s);
    for (size_t i = 0; i < NOC_COUNT(images); i++) {
        char name[60], png[96];
        snprintf(name, sizeof(name), "appearance/%s-Station-KIT.jpg", images[i]);
        write_image("one.png");
        snprintf(png, sizeof(png), "%s", in_folder("one.png"));
        assert_int_equal(rename(png, in_folder(name)), 0); /* its bytes say what it is */
    }
    s = load("city.json", true, &report);
    assert_int_equal(noc_report_get_file(report, 0)->images, 3 - told(report, "image that is not there"));
    assert_true(s->textures.len == 1 && s->uv.len); /* they hold the same */
    noc_report_destroy(report);
    noc_scene_destroy(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_surfaces), cmocka_unit_test(test_depths), cmocka_unit_test(test_holes),
        cmocka_unit_test(test_sequence), cmocka_unit_test(test_odd),    cmocka_unit_test(test_file),
    };
    return run_looks(tests, NOC_COUNT(tests));
}
