/* Appearances of CityGML: which surfaces get which image and colour, the right way round, and what is of no use. */
#include "looks.h"

#include "import/load/load.h"

#define WALL(id, x)                                                                                                    \
    "<gml:surfaceMember><gml:Polygon gml:id='" id "'><gml:exterior><gml:LinearRing gml:id='" id "r'><gml:posList "     \
    "srsDimension='3'>" x " 0 0 " x " 5 0 " x " 5 5 " x " 0 5 " x " 0 0</gml:posList></gml:LinearRing>"                \
    "</gml:exterior></gml:Polygon></gml:surfaceMember>"
#define HEAD                                                                                                           \
    "<CityModel xmlns='http://www.opengis.net/citygml/2.0' xmlns:gml='http://www.opengis.net/gml' "                    \
    "xmlns:app='http://www.opengis.net/citygml/appearance/2.0' "                                                       \
    "xmlns:bldg='http://www.opengis.net/citygml/building/2.0'><cityObjectMember><bldg:Building gml:id='b'>"            \
    "<bldg:boundedBy><bldg:WallSurface><bldg:lod2MultiSurface><gml:MultiSurface gml:id='all'>" WALL("p1", "0")         \
        WALL("p2", "1") WALL("p3", "2") WALL(                                                                          \
            "p4",                                                                                                      \
            "3") "</gml:MultiSurface></bldg:lod2MultiSurface></bldg:WallSurface></bldg:boundedBy>"                     \
                 "</bldg:Building></cityObjectMember><app:appearanceMember><app:Appearance><app:theme>t</app:theme>"
#define TEXTURE(image, ring, coordinates)                                                                              \
    "<app:surfaceDataMember><app:ParameterizedTexture><app:imageURI>" image                                            \
    "</app:imageURI><app:wrapMode>wrap</app:wrapMode><app:target uri='#p'><app:TexCoordList>"                          \
    "<app:textureCoordinates ring='#" ring "'>" coordinates "</app:textureCoordinates></app:TexCoordList>"             \
    "</app:target></app:ParameterizedTexture></app:surfaceDataMember>"
#define SQUARE "0 0 1 0 1 1 0 1 0 0"
#define MATERIAL                                                                                                       \
    "<app:surfaceDataMember><app:X3DMaterial><app:shininess>0</app:shininess><app:diffuseColor>1 0.5 0"                \
    "</app:diffuseColor><app:target>#p2</app:target></app:X3DMaterial></app:surfaceDataMember>"
#define TAIL "</app:Appearance></app:appearanceMember></CityModel>"

static void test_citygml(void **state) {
    (void)state;
    write_image("sub.png");
    write_file("city.gml",
               HEAD TEXTURE("sub.png", "p1r", SQUARE) TEXTURE("gone.jpg", "p2r", SQUARE)
                   TEXTURE("sub.png", "p3r", "0 0 1 0 1 1") TEXTURE("../../etc/passwd", "p4r", SQUARE) MATERIAL TAIL);
    noc_report *report;
    noc_scene *s = load("city.gml", true, &report);
    const noc_material *m = wall_material(s, 0);
    assert_true(m->texture == 1 && m->albedo[0] == 1 && s->textures.len == 1);
    expect_upright(s, 0);
    const uint32_t *texel = s->texels.data + TEXTURE_HEAD;
    assert_true((texel[0] & 1023) > (texel[1] & 1023) && texel[1] == texel[2] && texel[1] == texel[3]);
    /* the material stands in for the image that is not there: sRGB 0.5 is 0.214 */
    m = wall_material(s, 1);
    assert_true(m->texture == 0 && fabsf(m->albedo[1] - 0.2140f) < 1e-3f);
    assert_true(fabsf(m->albedo[0] - 0.9f) < 1e-6f && fabsf(m->albedo[2] - 0.02f) < 1e-6f && m->roughness == 1);
    assert_int_equal(wall_material(s, 2)->texture, 0);
    assert_int_equal(wall_material(s, 3)->texture, 0);
    assert_int_equal(told(report, "image that is not there"), 1);
    assert_int_equal(told(report, "image outside of the file's folder"), 1);
    assert_int_equal(told(report, "do not fit their ring"), 1);
    assert_int_equal(noc_report_get_file(report, 0)->images, 1);
    noc_report_destroy(report);
    noc_scene_destroy(s);
    s = load("city.gml", false, &report);
    assert_true(!s->textures.len && !s->uv.len && !told(report, "image"));
    noc_report_destroy(report);
    noc_scene_destroy(s);
}

/* What of the light a material of X3D lets through; what makes no sense is counted. */
static void test_transparency(void **state) {
    (void)state;
    static const struct {
        const char *said;
        float through;
        const char *counted;
    } rows[] = { { "0", 0, NULL },
                 { "0.4", .4f, NULL },
                 { " 1 ", 1, NULL },
                 { "1.5", 1, "material values out of range, clamped" },
                 { "-0.5", 0, "material values out of range, clamped" },
                 { "half", 0, "transparency that is no number, taken as opaque" } };
    for (size_t i = 0; i < NOC_COUNT(rows); i++) {
        char *text = noc_format("%s<app:surfaceDataMember><app:X3DMaterial><app:transparency>%s</app:transparency>"
                                "<app:target>#p1</app:target></app:X3DMaterial></app:surfaceDataMember>%s",
                                HEAD, rows[i].said, TAIL);
        write_file("clear.gml", text);
        noc_report *report;
        noc_scene *s = load("clear.gml", true, &report);
        assert_float_equal(wall_material(s, 0)->transmittance, rows[i].through, 1e-6);
        assert_float_equal(wall_material(s, 1)->transmittance, 0, 0);
        assert_true(!rows[i].counted || told(report, rows[i].counted) == 1);
        assert_true(rows[i].counted || (!told(report, "clamped") && !told(report, "no number")));
        noc_report_destroy(report);
        noc_scene_destroy(s);
        free(text);
    }
}

#define TEXTURED(target, ring)                                                                                         \
    "<app:surfaceDataMember><app:ParameterizedTexture><app:imageURI>one.png</app:imageURI><app:target uri='" target    \
    "'><app:TexCoordList><app:textureCoordinates" ring ">" SQUARE "</app:textureCoordinates></app:TexCoordList>"       \
    "</app:target></app:ParameterizedTexture></app:surfaceDataMember>"

/* Targets as exporters write them: ids without their #, rings in place of polygons, no name of the ring. */
static void test_targets(void **state) {
    (void)state;
    write_image("one.png");
    write_file("city.gml",
               HEAD TEXTURED("p1", " ring='p1r'") TEXTURED("#p2", "") TEXTURED("p3r", "")
                   TEXTURED("other.gml#p4",
                            "") "<app:surfaceDataMember><app:X3DMaterial><app:diffuseColor>1 0 0</app:diffuseColor>"
                                "<app:target> p4r </app:target></app:X3DMaterial></app:surfaceDataMember>" TAIL);
    noc_report *report;
    noc_scene *s = load("city.gml", true, &report);
    for (int i = 0; i < 3; i++) {
        assert_int_equal(wall_material(s, i)->texture, 1);
        expect_upright(s, i);
    }
    const noc_material *m = wall_material(s, 3);
    assert_true(m->texture == 0 && m->albedo[0] > 0.8f && m->albedo[1] < 0.1f);
    assert_int_equal(told(report, "appearance of what is in another file"), 1);
    noc_report_destroy(report);
    noc_scene_destroy(s);
}

static void test_broken(void **state) {
    (void)state;
    write_file("broken.jpg", "\xff\xd8\xff\xe0 and no more");
    write_file("other.tif", "II*");
    write_file("city.gml", HEAD TEXTURE("broken.jpg", "p1r", SQUARE) TEXTURE("other.tif", "p2r", SQUARE) TAIL);
    noc_report *report;
    noc_scene *s = load("city.gml", true, &report);
    assert_true(!s->textures.len && noc_report_get_file(report, 0)->images == 0);
    assert_int_equal(told(report, "image of a format that is not read") + told(report, "broken image"), 2);
    for (size_t i = 0; i < s->materials.len; i++)
        assert_true(s->materials.data[i].texture == 0 && s->materials.data[i].albedo[0] < 1);
    noc_report_destroy(report);
    noc_scene_destroy(s);
}

static void copy_file(const char *from, const char *to, size_t most) {
    char at[96], bytes[1000];
    snprintf(at, sizeof(at), "%s/%s", folder, from);
    FILE *f = fopen(at, "rb");
    assert_non_null(f);
    size_t size = fread(bytes, 1, NOC_MIN(most, sizeof(bytes)), f);
    fclose(f);
    snprintf(at, sizeof(at), "%s/%s", folder, to);
    assert_non_null(f = fopen(at, "wb"));
    assert_true(fwrite(bytes, 1, size, f) == size && !fclose(f));
}

static int texture_of_wall(const noc_scene *s, int number) { return wall_material(s, number)->texture; }

/* A large image of one colour is next to no bytes: images have no more pixels than theirs explain. */
static void test_pixels_are_bounded(void **state) {
    (void)state;
    double before = look_least_pixels;
    noc_image *black = noc_image_create(1024, 1024, NULL);
    noc_report *report;
    write_image("a.png");
    assert_int_equal(noc_image_write(black, in_folder("large.png"), NULL, NULL, NULL), NOC_OK);
    noc_image_destroy(black);
    write_file("city.gml", HEAD TEXTURE("large.png", "p1r", SQUARE) TEXTURE("a.png", "p2r", SQUARE) TAIL);
    for (int bounded = 0; bounded < 2; bounded++) {
        look_least_pixels = bounded ? 4 : before;
        noc_scene *s = load("city.gml", true, &report);
        assert_int_equal(texture_of_wall(s, 0) > 0, !bounded);
        assert_true(texture_of_wall(s, 1) > 0);
        assert_int_equal(told(report, "beyond the pixels"), bounded);
        noc_report_destroy(report);
        noc_scene_destroy(s);
    }
    look_least_pixels = before;
}

/* Files that hold the same are one texture, whatever their names; what is of no use is counted for each. */
static void test_alike(void **state) {
    (void)state;
    write_image("a.png");
    copy_file("a.png", "b.png", 1000);
    copy_file("a.png", "c.png", 40);
    copy_file("c.png", "d.png", 40);
    write_file("city.gml", HEAD TEXTURE("a.png", "p1r", SQUARE) TEXTURE("c.png", "p2r", SQUARE)
                               TEXTURE("b.png", "p3r", SQUARE) TEXTURE("d.png", "p4r", SQUARE) TAIL);
    noc_report *report;
    noc_scene *s = load("city.gml", true, &report);
    const noc_report_file *file = noc_report_get_file(report, 0);
    int first = texture_of_wall(s, 0);
    assert_true(first > 0 && texture_of_wall(s, 2) == first && s->textures.len == 1);
    assert_true(texture_of_wall(s, 1) == 0 && texture_of_wall(s, 3) == 0 && file->images == 2);
    assert_int_equal(told(report, "broken image"), 2);
    noc_report_destroy(report);
    noc_scene_destroy(s);
    /* one that ends otherwise at its edges is another */
    write_file(
        "city.gml",
        HEAD TEXTURE("a.png", "p1r",
                     SQUARE) "<app:surfaceDataMember><app:ParameterizedTexture>"
                             "<app:imageURI>b.png</app:imageURI><app:wrapMode>mirror</app:wrapMode>"
                             "<app:target uri='#p'><app:TexCoordList><app:textureCoordinates ring='#p3r'>" SQUARE
                             "</app:textureCoordinates></app:TexCoordList></app:target></app:ParameterizedTexture>"
                             "</app:surfaceDataMember>" TAIL);
    s = load("city.gml", true, &report);
    assert_true(s->textures.len == 2 && texture_of_wall(s, 0) != texture_of_wall(s, 2));
    noc_report_destroy(report);
    noc_scene_destroy(s);
}

/* Each takes memory, whatever little it says. */
static void test_many_materials(void **state) {
    (void)state;
    enum { MATERIALS = 100000 };
    const char *path = in_folder("city.gml");
    FILE *f = fopen(path, "wb");
    assert_true(f && fputs(HEAD "<app:surfaceDataMember>", f) >= 0);
    for (int i = 0; i < MATERIALS; i++)
        assert_true(fputs("<app:X3DMaterial/>", f) >= 0);
    assert_true(fputs("</app:surfaceDataMember>" TAIL, f) >= 0 && !fclose(f));
    const char *paths[] = { path };
    noc_import_params p = noc_import_default_params();
    p.max_memory = 0.008;
    noc_log *log = noc_log_create(NULL);
    noc_scene *scene = noc_scene_create(log);
    assert_int_equal(noc_scene_load(scene, paths, 1, &p, NULL), NOC_ERR_MEMORY);
    assert_non_null(strstr(noc_log_last_error(log), "its appearances"));
    noc_scene_destroy(scene);
    noc_log_destroy(log);
}

/* An image of 512 x 512 and one of 128 x 128: the larger one is halved until both fit, and no texel more. */
static void test_halved(void **state) {
    (void)state;
    static const struct {
        double most; /* MB */
        int sides[2];
        size_t reduced;
    } wanted[] = { { 2, { 512, 128 }, 0 }, { 1, { 256, 128 }, 1 }, { 0.2, { 128, 128 }, 1 }, { 0.1, { 64, 64 }, 2 } };
    for (int i = 0; i < 2; i++) {
        int side = i ? 128 : 512;
        noc_image *image = noc_image_create(side, side, NULL);
        noc_display_params linear = noc_display_default_params();
        linear.auto_exposure = false;
        assert_int_equal(noc_image_write(image, in_folder(i ? "small.png" : "large.png"), &linear, NULL, NULL), NOC_OK);
        noc_image_destroy(image);
    }
    write_file("city.gml", HEAD TEXTURE("large.png", "p1r", SQUARE) TEXTURE("small.png", "p2r", SQUARE) TAIL);
    for (size_t i = 0; i < NOC_COUNT(wanted); i++) {
        noc_import_params p = looks_params(true);
        noc_report *report;
        noc_scene_info info;
        p.texture_memory = wanted[i].most;
        noc_scene *s = load_by("city.gml", &p, &report);
        for (int k = 0; k < 2; k++) {
            int texture = wall_material(s, k)->texture;
            assert_true(texture > 0);
            uint32_t size = s->texels.data[s->textures.data[texture - 1].place + 2];
            if ((int)(size & 0xffff) != wanted[i].sides[k] || size >> 16 != (size & 0xffff))
                fail_msg("%g MB: image %d is %u x %u", wanted[i].most, k, size & 0xffff, size >> 16);
        }
        noc_scene_get_info(s, &info);
        assert_true((double)info.texture_bytes <= wanted[i].most * 1e6);
        noc_report_totals totals;
        noc_report_get_totals(report, &totals);
        assert_int_equal(totals.images_reduced, wanted[i].reduced);
        noc_report_destroy(report);
        noc_scene_destroy(s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_citygml),
        cmocka_unit_test(test_targets),
        cmocka_unit_test(test_pixels_are_bounded),
        cmocka_unit_test(test_transparency),
        cmocka_unit_test(test_broken),
        cmocka_unit_test(test_halved),
        cmocka_unit_test(test_alike),
        cmocka_unit_test(test_many_materials),
    };
    return run_looks(tests, NOC_COUNT(tests));
}
