/* Lamps among city furniture and generic objects: what makes one, what it says of itself, and light that its own body
 * leaves free. */
#include "city_pieces.h"
#include "city_sink.h"

#include "scene/scene.h"

#include <math.h>
#include <stdio.h>
#include <unistd.h>

static city_sink sink;

#define FURNITURE(id, content) MEMBER("<f:CityFurniture g:id='" id "'>" content "</f:CityFurniture>")
#define GENERIC(id, content) MEMBER("<gen:GenericCityObject g:id='" id "'>" content "</gen:GenericCityObject>")
#define FUNCTION(f, text) "<" f ":function>" text "</" f ":function>"
#define POINT(f, position) "<" f ":lod1Geometry><g:Point><g:pos>" position "</g:pos></g:Point></" f ":lod1Geometry>"
#define ATTRIBUTE(kind, name, value)                                                                                   \
    "<gen:" kind "Attribute name='" name "'><gen:value>" value "</gen:value></gen:" kind "Attribute>"

static void read_text(const char *text) { assert_int_equal(city_read_bytes(&sink, text, strlen(text), 3), NOC_OK); }

/* ---- what makes a lamp ---- */

static void expect_lamp(const char *what, bool generic, const char *content, bool lamp) {
    const char *open = generic ? "<gen:GenericCityObject g:id='o'>" : "<f:CityFurniture g:id='o'>";
    const char *close =
        generic ? POINT("gen", "5 6 7") "</gen:GenericCityObject>" : POINT("f", "5 6 7") "</f:CityFurniture>";
    char *text = noc_format(MODEL("<cityObjectMember>%s%s%s</cityObjectMember>"), open, content, close);
    read_text(text);
    free(text);
    if (sink.lamps.len != lamp)
        fail_msg("%s: %zu lamps", what, sink.lamps.len);
}

static void test_codes(void **state) {
    static const struct {
        const char *space, *code;
        bool lamp;
    } codes[] = {
        { "", "1150", true },
        { "", "1170", true },
        { "", "1220", true },
        { "", "1230", true },
        { "", "1080", false },
        { "", "1160", false },
        { "http://www.sig3d.de/codelists/standard/cityfurniture/2.0/CityFurniture_function.xml", "1150", true },
        { "../../codelists/CityFurniture_function.xml", "4200", true },
        { "../../codelists/CityFurniture_function.xml", "1150", false },
        { "../../codelists/CityFurniture_function.xml", "4900", false },
        { "http://example.org/own-list.xml", "1150", false },
        { "", "4200", false },
    };
    for (size_t i = 0; i < NOC_COUNT(codes); i++) {
        char *content = noc_format("<f:function codeSpace='%s'>%s</f:function>", codes[i].space, codes[i].code);
        expect_lamp(codes[i].code, false, content, codes[i].lamp);
        free(content);
    }
    expect_lamp("a code says nothing of generic objects", true, FUNCTION("gen", "1150"), false);
}

static void test_words(void **state) {
    expect_lamp("street lamp", false, FUNCTION("f", "street lamp"), true);
    expect_lamp("streetLamp", false, "<f:class>StreetLamp</f:class>", true);
    expect_lamp("Strassenlaterne", false,
                "<f:usage>Stra\xc3\x9f"
                "enlaterne</f:usage>",
                true);
    expect_lamp("Laterne", true, "<gen:class>Laterne</gen:class>", true);
    expect_lamp("lantern", true, FUNCTION("gen", "lantern"), true);
    expect_lamp("by name", true,
                "<g:name>Stra\xc3\x9f"
                "enleuchte 12</g:name>",
                true);
    expect_lamp("Japanese", false, FUNCTION("f", "\xe8\xa1\x97\xe8\xb7\xaf\xe7\x81\xaf"), true);
    expect_lamp("by an attribute", true, ATTRIBUTE("string", "Objektart", "Lichtmast mit Auslegerleuchte"), true);
    expect_lamp("an inn", true, "<g:name>Zur Laterne</g:name>", false);
    expect_lamp("described beside one", false,
                "<g:description>bench under a street light</g:description>" FUNCTION("f", "bench"), false);
    expect_lamp("gone in 2019", false, "<terminationDate>2019-05-31</terminationDate>" FUNCTION("f", "street lamp"),
                false);
    assert_int_equal(city_issue(&sink, "lamp not in use (removed, disused or planned)"), 1);
    expect_lamp("gone in 2019, 3.0", false, "<validTo>2019-05-31T12:00:00Z</validTo>" FUNCTION("f", "street lamp"),
                false);
    expect_lamp("to be gone", false, "<terminationDate>2919-05-31</terminationDate>" FUNCTION("f", "street lamp"),
                true);
    expect_lamp("no date", false, "<terminationDate>unknown</terminationDate>" FUNCTION("f", "street lamp"), true);
    expect_lamp("traffic light", false, FUNCTION("f", "traffic light"), false);
    expect_lamp("gas tank", true, FUNCTION("gen", "gas tank") ATTRIBUTE("double", "Gas volume", "4334.99"), false);
}

static void test_by_attributes(void **state) {
    expect_lamp("lumen", false, ATTRIBUTE("int", "lumen", "4000"), true);
    expect_lamp("wattage and mast height", true,
                ATTRIBUTE("double", "wattage", "70") ATTRIBUTE("double", "mastheight", "6"), true);
    expect_lamp("height alone", true, ATTRIBUTE("double", "height", "6"), false);
    expect_lamp("a traffic light with lamps", false, FUNCTION("f", "1080") ATTRIBUTE("int", "lumen", "400"), false);
    expect_lamp("gone", false, FUNCTION("f", "1150") ATTRIBUTE("string", "status", "removed"), false);
    assert_int_equal(city_issue(&sink, "lamp not in use (removed, disused or planned)"), 1);
}

/* ---- what it says of itself ---- */

static void test_values(void **state) {
    /* clang-format off */
    read_text(MODEL(FURNITURE("two", FUNCTION("f", "1150") ATTRIBUTE("string", "lamp_type", "SOX")
                              ATTRIBUTE("int", "lumen", "4500")
                              "<gen:measureAttribute name='height'>"
                              "<gen:value uom='urn:ogc:def:uom:UCUM::ft'>30</gen:value></gen:measureAttribute>"
                              ATTRIBUTE("double", "Wattage", " 55.5 ") POINT("f", "5 6 7"))
                    FURNITURE("flood", FUNCTION("f", "1230") POINT("f", "5 6"))));
    /* clang-format on */
    assert_int_equal(sink.lamps.len, 2);
    const geo_lamp *two = &sink.lamps.data[0];
    assert_float_equal(two->height, 9.144, 1e-9);
    assert_float_equal(two->lumens, 4500, 0);
    assert_float_equal(two->watts, 55.5, 1e-12);
    assert_int_equal(two->source, GEO_SOURCE_LOW_SODIUM);
    assert_int_equal(two->body_heads, 0);
    assert_true(two->xyz[0] == 5 && two->xyz[1] == 6 && two->xyz[2] == 7);
    assert_int_equal(sink.lamps.data[1].type, GEO_LAMP_FLOOD);
    assert_true(isnan(sink.lamps.data[1].xyz[2])); /* two dimensions: on the ground */
    /* clang-format off */
    static const char three[] =
        "<CityModel" NAMESPACES("3.0", GML32) " xmlns:c='http://www.opengis.net/citygml/3.0'><cityObjectMember>"
                                              "<gen:GenericOccupiedSpace g:id='three'><genericAttribute>"
                                              "<gen:StringAttribute><gen:name>Leuchtmittel</gen:name>"
                                              "<gen:value>LED</gen:value></gen:StringAttribute></genericAttribute>"
        "<genericAttribute><gen:MeasureAttribute><gen:name>height</gen:name>"
        "<gen:value uom='m'>8.5</gen:value></gen:MeasureAttribute></genericAttribute>"
        "<lod0Point><g:Point><g:pos>1 2 3</g:pos></g:Point></lod0Point></gen:GenericOccupiedSpace></cityObjectMember>"
        "</CityModel>";
    /* clang-format on */
    read_text(three);
    assert_int_equal(sink.lamps.len, 1);
    assert_float_equal(sink.lamps.data[0].height, 8.5, 1e-9);
    assert_int_equal(sink.lamps.data[0].source, GEO_SOURCE_LED);
}

static void test_places(void **state) {
    /* clang-format off */
    read_text(MODEL(FURNITURE("far", FUNCTION("f", "1150") "<f:lod2ImplicitRepresentation><ImplicitGeometry>"
                                                           "<mimeType>model/x3d</mimeType>"
                                                           "<libraryObject>lamp.x3d</libraryObject><referencePoint>"
                                                           "<g:Point><g:pos>11 12 13</g:pos></g:Point></referencePoint>"
                              "</ImplicitGeometry></f:lod2ImplicitRepresentation>")));
    /* clang-format on */
    assert_int_equal(sink.lamps.len, 1);
    assert_true(sink.lamps.data[0].xyz[0] == 11 && sink.lamps.data[0].xyz[2] == 13);
    sink.lat_first = true;
    read_text(MODEL(FURNITURE("lat", FUNCTION("f", "1150") POINT("f", "48.5 11.25 400"))));
    sink.lat_first = false;
    assert_true(sink.lamps.data[0].xyz[0] == 11.25 && sink.lamps.data[0].xyz[1] == 48.5 &&
                sink.lamps.data[0].xyz[2] == 400);
}

/* ---- bodies ---- */

/* The six sides of a box, counter-clockwise from outside. */
static char *box(char *at, double x0, double y0, double z0, double x1, double y1, double z1) {
    const double c[8][3] = { { x0, y0, z0 }, { x1, y0, z0 }, { x1, y1, z0 }, { x0, y1, z0 },
                             { x0, y0, z1 }, { x1, y0, z1 }, { x1, y1, z1 }, { x0, y1, z1 } };
    static const int side[6][4] = { { 3, 2, 1, 0 }, { 4, 5, 6, 7 }, { 0, 1, 5, 4 },
                                    { 1, 2, 6, 5 }, { 2, 3, 7, 6 }, { 3, 0, 4, 7 } };
    for (int s = 0; s < 6; s++) {
        at += sprintf(at, "<g:surfaceMember><g:Polygon><g:exterior><g:LinearRing><g:posList>");
        for (int k = 0; k < 5; k++) {
            const double *p = c[side[s][k % 4]];
            at += sprintf(at, "%.3f %.3f %.3f ", p[0], p[1], p[2]);
        }
        at += sprintf(at, "</g:posList></g:LinearRing></g:exterior></g:Polygon></g:surfaceMember>");
    }
    return at;
}

#define BODY "<f:lod2Geometry><g:MultiSurface>%s</g:MultiSurface></f:lod2Geometry>"
#define X 500.0
#define Y 700.0

/* A model of lamps: pole with an arm and a head; pole with two; a lantern on a post; a block as large as all of a lamp.
 */
static void write_lamps(char *bodies[4]) {
    char *at = bodies[0];
    at = box(at, X - .06, Y - .06, 2, X + .06, Y + .06, 10);
    at = box(at, X, Y - .04, 9.8, X + 1.6, Y + .04, 9.9);
    box(at, X + 1.4, Y - .15, 9.7, X + 2, Y + .15, 9.85);
    at = bodies[1];
    at = box(at, X + 19.94, Y - .06, 2, X + 20.06, Y + .06, 10);
    at = box(at, X + 18, Y - .15, 9.8, X + 18.6, Y + .15, 10);
    at = box(at, X + 18.2, Y - .03, 10, X + 21.8, Y + .03, 10.05);
    box(at, X + 21.4, Y - .15, 9.8, X + 22, Y + .15, 10);
    at = bodies[2];
    at = box(at, X + 39.95, Y - .05, 2, X + 40.05, Y + .05, 5.5);
    box(at, X + 39.8, Y - .2, 5.5, X + 40.2, Y + .2, 6);
    box(bodies[3], X + 59, Y - 1, 2, X + 61, Y + 1, 9);
}

static char *lamp_city(const char *crs) {
    char *bodies[4], *text = noc_format("%s", "");
    for (int i = 0; i < 4; i++)
        bodies[i] = noc_calloc(1, 20000);
    write_lamps(bodies);
    for (int i = 0; i < 4; i++) {
        char *longer =
            noc_format("%s" FURNITURE("lamp%d", FUNCTION("f", "1150") ATTRIBUTE("int", "lumen", "3000") BODY), text, i,
                       bodies[i]);
        free(text);
        free(bodies[i]);
        text = longer;
    }
    /* clang-format off */
    char *model = noc_format("<CityModel" NAMESPACES("2.0", GML31) "><g:boundedBy><g:Envelope srsName='%s'/>"
                                                                   "</g:boundedBy>%s"
                             MEMBER("<l:LandUse g:id='ground'><l:lod1MultiSurface>"
                                    SURFACES(POLYGON("ground", "400 600 2 700 600 2 700 800 2 400 800 2 400 600 2"))
                                    "</l:lod1MultiSurface></l:LandUse>") "</CityModel>", crs, text);
    /* clang-format on */
    free(text);
    return model;
}

static void test_bodies(void **state) {
    char *text = lamp_city("EPSG:25832");
    read_text(text);
    free(text);
    assert_int_equal(sink.lamps.len, 4);
    const geo_lamp *l = sink.lamps.data;
    assert_int_equal(l[0].body_heads, 1);
    assert_false(l[0].head_globe);
    /* under its head, not its pole */
    assert_true(fabs(l[0].head[0][0] - (X + 1.7)) < .3 && fabs(l[0].head[0][1] - Y) < .01);
    assert_true(l[0].head[0][2] < 9.7 && l[0].head[0][2] > 9.6);
    assert_float_equal(l[0].xyz[0], X, 1e-6);
    assert_float_equal(l[0].xyz[2], 2, 1e-9);
    assert_float_equal(l[0].height, 8, 1e-9);
    assert_int_equal(l[1].body_heads, 2);
    assert_true((l[1].head[0][0] - X - 20) * (l[1].head[1][0] - X - 20) < 0);
    assert_int_equal(l[2].body_heads, 1);
    assert_true(l[2].head_globe && l[2].head_radius > .28 && l[2].head_radius <= .6); /* around the lantern */
    assert_int_equal(l[3].body_heads, 0);
    assert_int_equal(city_issue(&sink, "lamp whose body is a block around its light: a pole stands in its place"), 1);
    size_t of_lamps = 0;
    for (size_t i = 0; i < sink.polygons.len; i++)
        of_lamps += sink.polygons.data[i].cls == NOC_CLASS_LAMP;
    assert_int_equal(of_lamps, 6 * (3 + 4 + 2)); /* bodies stay, but for the block's */
}

/* ---- on buildings ---- */

#define INSTALLED(id, words, surfaces)                                                                                 \
    "<b:outerBuildingInstallation><b:BuildingInstallation g:id='" id "'>" words                                        \
    "<b:lod2Geometry><g:MultiSurface>" surfaces                                                                        \
    "</g:MultiSurface></b:lod2Geometry></b:BuildingInstallation></b:outerBuildingInstallation>"

/* A luminaire that is open below, a closed block that would swallow its light, a lamp that is gone, a balcony. */
static void test_installations(void **state) {
    char bodies[4][4000];
    box(bodies[0], X, Y - .1, 4, X + .4, Y + .1, 4.2);
    box(bodies[1], X + 9, Y - 1, 3, X + 11, Y + 1, 5);
    box(bodies[2], X + 20, Y, 4, X + 21, Y + 1, 5);
    box(bodies[3], X + 30, Y, 4, X + 31, Y + 1, 5);
    char *text = noc_format(
        MODEL(MEMBER(BUILDING(
            "house",
            LOD_SURFACES("2", SQUARE("wall", "1", "0"))
                INSTALLED("wall lamp", FUNCTION("b", "street light") ATTRIBUTE("int", "lumen", "700"), "%s")
                    INSTALLED("block", "<g:name>Laterne 5</g:name><b:class>Laterne</b:class>", "%s")
                        INSTALLED("gone", FUNCTION("b", "lamp") "<terminationDate>2019-05-31</terminationDate>", "%s")
                            INSTALLED("balcony", "<g:name>Zur Laterne</g:name>" FUNCTION("b", "1000"), "%s")))),
        bodies[0], bodies[1], bodies[2], bodies[3]);
    read_text(text);
    free(text);
    assert_int_equal(sink.lamps.len, 2);
    const geo_lamp *lamp = &sink.lamps.data[0], *block = &sink.lamps.data[1];
    assert_float_equal(lamp->lumens, 700, 0);
    assert_int_equal(lamp->body_heads, 1);
    assert_true(!lamp->head_globe && lamp->head[0][2] < 4 && lamp->head[0][2] > 3.9 &&
                fabs(lamp->head[0][0] - X - .2) < 1e-6);
    assert_true(isnan(block->lumens)); /* that is the other one's */
    assert_true(block->body_heads == 1 && block->head_globe && fabs(block->head[0][2] - 4) < 1e-9 &&
                fabs(block->head[0][0] - X - 10) < 1e-6);
    assert_int_equal(city_issue(&sink, "lamp whose body is a block around its light: a globe in its place"), 1);
    assert_int_equal(city_issue(&sink, "lamp not in use (removed, disused or planned)"), 1);
    assert_int_equal(sink.polygons.len, 1 + 6 + 6 + 6); /* the block's alone are left away */
}

/* One building with very many: each looks at its own surfaces alone, and the import can be called off amid them. */
static void test_many_installations(void **state) {
    enum { LAMPS = 1500 };
    char body[4000], *text = NULL;
    size_t size;
    FILE *f = open_memstream(&text, &size);
    fputs("<CityModel" NAMESPACES("2.0", GML31) "><cityObjectMember><b:Building g:id='house'>", f);
    for (int i = 0; i < LAMPS; i++) {
        box(body, X + 3 * i, Y - 1, 3, X + 3 * i + 2, Y + 1, 5);
        fprintf(f, INSTALLED("l", FUNCTION("b", "lamp"), "%s"), body);
    }
    fputs("</b:Building></cityObjectMember></CityModel>", f);
    assert_int_equal(fclose(f), 0);
    read_text(text);
    assert_int_equal(sink.lamps.len, LAMPS);
    assert_int_equal(sink.polygons.len, 0); /* all of them give way */
    assert_true(fabs(sink.lamps.data[LAMPS - 1].xyz[0] - X - 3 * LAMPS + 2) < 1.1);
    assert_in_range(sink.asked_amid, 10, 30); /* 13 features and surfaces a lamp */
    sink.stop_amid = true;
    assert_int_equal(city_read_bytes(&sink, text, size, 3), NOC_ERR_CANCELLED);
    assert_in_range(sink.lamps.len, 1, LAMPS / 5);
    sink.stop_amid = false;
    free(text);
}

/* ---- in a scene ---- */

static bool blocked(const noc_scene *scene, const double o[3], const double d[3]) {
    for (size_t t = 0; t < scene->triangle_material.len; t++) {
        const float *v[3];
        double e1[3], e2[3], s[3], p[3], q[3];
        if (scene->materials.data[scene->triangle_material.data[t]].cls != NOC_CLASS_LAMP ||
            scene->triangle_light.data[t] != NOC_NO_LIGHT)
            continue;
        for (int i = 0; i < 3; i++)
            v[i] = scene->positions.data + 3 * (size_t)scene->indices.data[3 * t + (size_t)i];
        for (int k = 0; k < 3; k++) {
            e1[k] = (double)v[1][k] - v[0][k];
            e2[k] = (double)v[2][k] - v[0][k];
            s[k] = o[k] - v[0][k];
        }
        for (int k = 0; k < 3; k++) {
            p[k] = d[(k + 1) % 3] * e2[(k + 2) % 3] - d[(k + 2) % 3] * e2[(k + 1) % 3];
            q[k] = s[(k + 1) % 3] * e1[(k + 2) % 3] - s[(k + 2) % 3] * e1[(k + 1) % 3];
        }
        double det = e1[0] * p[0] + e1[1] * p[1] + e1[2] * p[2];
        if (fabs(det) < 1e-14)
            continue;
        double u = (s[0] * p[0] + s[1] * p[1] + s[2] * p[2]) / det, w = (d[0] * q[0] + d[1] * q[1] + d[2] * q[2]) / det;
        double x = (e2[0] * q[0] + e2[1] * q[1] + e2[2] * q[2]) / det;
        if (u >= 0 && w >= 0 && u + w <= 1 && x > 0 && x < 1)
            return true;
    }
    return false;
}

/* The ground within 10 m sees the lights: points of it look at the near side of each. */
static void test_light_reaches_the_ground(void **state) {
    char path[] = "/tmp/noc-lamps-XXXXXX", *text = lamp_city("EPSG:25832");
    int fd = mkstemp(path);
    assert_true(fd >= 0 && write(fd, text, strlen(text)) == (ssize_t)strlen(text) && !close(fd));
    free(text);
    noc_scene *scene = noc_scene_create(NULL);
    const char *paths[] = { path };
    noc_import_params params = noc_import_default_params();
    noc_report *report;
    assert_int_equal(noc_scene_load(scene, paths, 1, &params, &report), NOC_OK);
    const noc_report_file *file = noc_report_get_file(report, 0);
    assert_int_equal(file->lamps, 4);
    assert_int_equal(file->lights, 5);
    assert_int_equal(scene->lights.len, 5); /* none is made up beside them */
    assert_int_equal(file->polygons_by_class[NOC_CLASS_LAMP], 6 * 9);
    assert_int_equal(file->column_count, 1);
    assert_string_equal(file->columns[0].field, "lumens");
    for (size_t i = 0; i < scene->lights.len; i++) {
        const noc_light_record *l = &scene->lights.data[i];
        assert_float_equal(noc_light_flux(l) / 3000, 1, 1e-3);
        assert_false(l->flags & NOC_LIGHT_INFERRED);
        int seen = 0, all = 0;
        for (int a = 0; a < 12; a++)
            for (int k = 1; k <= 5; k++, all++) {
                double o[3] = { l->p[0] + 2 * k * cos(a * M_PI / 6), l->p[1] + 2 * k * sin(a * M_PI / 6), 2.01 }, d[3];
                for (int j = 0; j < 3; j++)
                    d[j] = l->p[j] - o[j];
                double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]),
                       shorter = l->kind == NOC_LIGHT_SPHERE ? (length - l->radius) / length : 1;
                for (int j = 0; j < 3; j++)
                    d[j] *= shorter;
                seen += !blocked(scene, o, d);
            }
        if (seen * 10 < all * 9)
            fail_msg("light %zu: %d of %d points of the ground see it", i, seen, all);
    }
    noc_report_destroy(report);
    noc_scene_destroy(scene);
    unlink(path);
}

/* ---- what is left out ---- */

static void test_left_out(void **state) {
    read_text(MODEL(FURNITURE("a", "<f:class>1000</f:class>" FUNCTION("f", "1080"))
                        FURNITURE("b", "<f:class>1000</f:class>" FUNCTION("f", "1080"))
                            GENERIC("c", "<gen:class>Sirene</gen:class>") MEMBER("<l:LandUse g:id='d'/>")));
    assert_int_equal(city_issue(&sink, "CityFurniture left out, no geometry (class '1000', function '1080')"), 2);
    assert_int_equal(city_issue(&sink, "GenericCityObject left out, no geometry (class 'Sirene')"), 1);
    assert_int_equal(city_issue(&sink, "LandUse left out, no geometry"), 1);
    char *text = noc_format("%s", "");
    for (int i = 0; i < 500; i++) { /* as many classes as objects: some are told apart */
        char *longer = noc_format("%s" MEMBER("<f:CityFurniture><f:class>k%d</f:class></f:CityFurniture>"), text, i);
        free(text);
        text = longer;
    }
    char *model = noc_format(MODEL("%s"), text);
    read_text(model);
    assert_true(geo_issues_count(sink.sink.issues) < 80);
    assert_true(city_issue(&sink, "CityFurniture left out, no geometry") > 400);
    free(text);
    free(model);
}

static int clear(void **state) {
    city_clear(&sink);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_codes),
        cmocka_unit_test(test_words),
        cmocka_unit_test(test_by_attributes),
        cmocka_unit_test(test_values),
        cmocka_unit_test(test_places),
        cmocka_unit_test(test_bodies),
        cmocka_unit_test(test_installations),
        cmocka_unit_test(test_many_installations),
        cmocka_unit_test(test_light_reaches_the_ground),
        cmocka_unit_test(test_left_out),
    };
    return cmocka_run_group_tests_name("import/citygml_lamps", tests, NULL, clear);
}
