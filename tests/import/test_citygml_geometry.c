/* CityGML: coordinates, rings, polygons and what holds them. */
#include "city_pieces.h"
#include "city_sink.h"

#include <math.h>

static city_sink sink;

static int finish(void **state) {
    (void)state;
    city_clear(&sink);
    return 0;
}

/* Reads geometry as the LOD 2 surfaces of one building; returns how many polygons came. */
static size_t read_surfaces(const char *content) {
    char *text = noc_format(MODEL(MEMBER(BUILDING("B", "<b:lod2Geometry>%s</b:lod2Geometry>"))), content);
    assert_int_equal(city_read_bytes(&sink, text, strlen(text), 3), NOC_OK);
    free(text);
    return sink.polygons.len;
}

static void expect_points(const seen_polygon *p, size_t points, const double *want) {
    assert_int_equal(p->points, points);
    for (size_t i = 0; i < 3 * points; i++)
        if (p->xyz[i] != want[i])
            fail_msg("%s: number %zu is %.17g, not %.17g", p->id, i, p->xyz[i], want[i]);
}

#define IN_POLYGON(content)                                                                                            \
    SURFACES("<g:Polygon g:id='p'><g:exterior><g:LinearRing>" content "</g:LinearRing></g:exterior></g:Polygon>")

static const double triangle[] = { 1.5, 2, 3, 4, 5, 6, 7, 8, 10 };

static void test_spellings_of_coordinates(void **state) {
    (void)state;
    const char *texts[] = {
        IN_POLYGON("<g:posList>1.5 2 3 4 5 6 7 8 10 1.5 2 3</g:posList>"),
        IN_POLYGON("<g:posList srsDimension='3'>\n\t+1.50e0 2. 3 4 5 6\r\n 7 8 1E1 1.5 2 3 </g:posList>"),
        IN_POLYGON("<g:posList><!-- in pieces -->1.<!-- -->5 2 3 4 5 6 7 8 1<![CDATA[0 1.5]]> 2 3</g:posList>"),
        IN_POLYGON("<g:posList>1&#46;5 2 3 4 5 6 7 8 &#49;0 1.5 2 3</g:posList>"),
        IN_POLYGON("<g:pos>1.5 2 3</g:pos><g:pos>4 5 6</g:pos><g:pos>7 8 10</g:pos><g:pos>1.5 2 3</g:pos>"),
        IN_POLYGON("<g:pointProperty><g:Point><g:pos>1.5 2 3</g:pos></g:Point></g:pointProperty><g:pos>4 5 6</g:pos>"
                   "<g:pointRep><g:Point><g:pos>7 8 10</g:pos></g:Point></g:pointRep><g:pos>1.5 2 3</g:pos>"),
        IN_POLYGON("<g:coordinates>1.5,2,3 4,5,6 7,8,10 1.5,2,3</g:coordinates>"),
        IN_POLYGON("<g:coordinates> 1.5, 2, 3\n4, 5, 6 7,8,10 1.5,2,3\n</g:coordinates>"),
        IN_POLYGON("<g:coordinates decimal=',' cs=' ' ts=';'>1,5 2 3;4 5 6;7 8 10;1,5 2 3</g:coordinates>"),
    };
    for (size_t i = 0; i < NOC_COUNT(texts); i++) {
        assert_int_equal(read_surfaces(texts[i]), 1);
        expect_points(city_find(&sink, "p"), 3, triangle);
        assert_int_equal(geo_issues_count(sink.sink.issues), 0);
    }
}

static void test_two_dimensions(void **state) {
    (void)state;
    const double flat[] = { 0, 0, 0, 4, 0, 0, 4, 3, 0 };
    const char *texts[] = {
        IN_POLYGON("<g:posList srsDimension='2'>0 0 4 0 4 3 0 0</g:posList>"),
        IN_POLYGON("<g:pos>0 0</g:pos><g:pos>4 0</g:pos><g:pos>4 3</g:pos><g:pos>0 0</g:pos>"),
        IN_POLYGON("<g:coordinates>0,0 4,0 4,3 0,0</g:coordinates>"),
        "<g:MultiSurface srsDimension='2'>" MEMBERS(POLYGON("p", "0 0 4 0 4 3 0 0")) "</g:MultiSurface>",
    };
    for (size_t i = 0; i < NOC_COUNT(texts); i++) {
        assert_int_equal(read_surfaces(texts[i]), 1);
        expect_points(city_find(&sink, "p"), 3, flat);
    }
}

static void test_numbers_exact(void **state) {
    (void)state;
    /* Long decimals take another way than short ones; both must give what the C library gives. */
    const char *words[] = { "35.672789148820186",
                            "139.66581885090204",
                            "5403455.767",
                            "-0.1",
                            "678016.20000000001",
                            "9007199254740993",
                            "1e-300",
                            "0.30000000000000004",
                            "123456789012345678901234567890",
                            "-.5",
                            "00012.2500",
                            "4.35" };
    for (size_t i = 0; i < NOC_COUNT(words); i++) {
        char *text = noc_format(IN_POLYGON("<g:posList>%s 0 0 0 1 0 0 0 1</g:posList>"), words[i]);
        assert_int_equal(read_surfaces(text), 1);
        assert_true(sink.polygons.data[0].xyz[0] == strtod(words[i], NULL));
        free(text);
    }
}

static void test_bad_rings(void **state) {
    (void)state;
    const struct {
        const char *positions, *reason;
        size_t polygons;
    } cases[] = {
        { "0 0 0 1 0 0 0 0 0", "ring with too few points", 0 },
        { "", "ring with too few points", 0 },
        { "0 0 0 1 0 0 1 1 0 7 0 0 0", "incomplete coordinates", 0 },
        { "0 0 0 1 0 0 1 x 0 0 0 0", "coordinates that are not numbers", 0 },
        { "0 0 0 1 0 0 1 nan 0 0 0 0", "coordinates that are not numbers", 0 },
        { "0 0 0 1 0 0 1 1e999 0 0 0 0", "coordinates that are not numbers", 0 },
        { "0 0 0 1 0 0 1 0x1 0 0 0 0", "coordinates that are not numbers", 0 },
        { "0 0 0 1 0 0 1 1,5 0 0 0 0", "coordinates that are not numbers", 0 },
        { "0 0 0 1 0 0 1 1111111111111111111111111111111111111111111111111111111111111111111111 0 0 0 0",
          "coordinates that are not numbers", 0 },
        { "0 0 0 1 0 0 1 1 0", "ring not closed", 1 },
    };
    for (size_t i = 0; i < NOC_COUNT(cases); i++) {
        char *text = noc_format(SURFACES(POLYGON("bad", "%s") SQUARE("good", "1", "1")), cases[i].positions);
        /* the good one stands outside a surfaceMember, and does not mind */
        assert_int_equal(read_surfaces(text), cases[i].polygons + 1);
        assert_int_equal(city_issue(&sink, cases[i].reason), 1);
        assert_int_equal(geo_issues_count(sink.sink.issues), 1);
        free(text);
    }
    const char *reason, *examples;
    bool repaired;
    size_t count;
    assert_true(geo_issues_get(sink.sink.issues, 0, &reason, &repaired, &count, &examples));
    assert_true(repaired);
    assert_string_equal(examples, "bad");
}

/* GML 3.3's compact ones have a ring that closes by itself: nothing of it is repaired. */
static void test_compact(void **state) {
    (void)state;
    /* clang-format off */
#define COMPACT(name, id, places)                                                                                      \
    "<g:surfaceMember><ce:" name " xmlns:ce='http://www.opengis.net/gml/3.3/ce' g:id='" id "'><g:posList " \
    "srsDimension='3'>" places "</g:posList></ce:" name "></g:surfaceMember>"
    const char *text = SURFACES(COMPACT("SimplePolygon", "p", "0 0 0 9 0 0 9 9 0 5 12 0 0 9 0")
        COMPACT("SimpleRectangle", "r", "0 0 1 9 0 1 9 9 1 0 9 1") COMPACT("SimpleTriangle", "t", "0 0 2 9 0 2 9 9 2"));
    /* clang-format on */
    assert_int_equal(read_surfaces(text), 3);
    assert_int_equal(city_find(&sink, "p")->points, 5);
    assert_int_equal(city_find(&sink, "r")->points, 4);
    assert_int_equal(city_find(&sink, "t")->points, 3);
    assert_int_equal(geo_issues_count(sink.sink.issues), 0);
    assert_int_equal(read_surfaces(SURFACES(COMPACT("SimplePolygon", "p", "0 0 0 9 0 0"))), 0);
    assert_int_equal(city_issue(&sink, "ring with too few points"), 1);
}

static void test_holes(void **state) {
    (void)state;
    /* clang-format off */
    const char *good = SURFACES("<g:Polygon g:id='p'><g:exterior>" RING("0 0 0 9 0 0 9 9 0 0 9 0 0 0 0") "</g:exterior>"
        "<g:interior>" RING("1 1 0 1 2 0 2 2 0 1 1 0") "</g:interior><g:interior>" RING("5 5 0 5 6 0 6 6 0 5 5 0")
        "</g:interior></g:Polygon>");
    /* clang-format on */
    assert_int_equal(read_surfaces(good), 1);
    assert_int_equal(city_find(&sink, "p")->rings, 3);
    assert_int_equal(city_find(&sink, "p")->points, 4 + 3 + 3);
    /* A bad hole goes, the polygon stays. */
    assert_int_equal(
        read_surfaces(SURFACES("<g:Polygon g:id='p'><g:exterior>" RING(
            "0 0 0 9 0 0 9 9 0 0 0 0") "</g:exterior><g:interior>" RING("1 1 0 1 2 0") "</g:interior></g:Polygon>")),
        1);
    assert_int_equal(city_find(&sink, "p")->rings, 1);
    assert_int_equal(city_issue(&sink, "ring with too few points"), 1);
    /* Without an exterior there is no polygon. */
    assert_int_equal(read_surfaces(SURFACES("<g:Polygon/><g:Polygon><g:interior>" RING(
                         "0 0 0 9 0 0 9 9 0 0 0 0") "</g:interior></g:Polygon>")),
                     0);
    assert_int_equal(city_issue(&sink, "polygon without an exterior ring"), 2);
    /* The old names, in the wrong order. */
    /* clang-format off */
    assert_int_equal(read_surfaces(SURFACES("<g:Polygon g:id='p'><g:innerBoundaryIs>" RING("1 1 0 1 2 0 2 2 0 1 1 0")
        "</g:innerBoundaryIs><g:outerBoundaryIs>" RING("0 0 0 9 0 0 9 9 0 0 0 0")
        "</g:outerBoundaryIs></g:Polygon>")), 1);
    /* clang-format on */
    const double outer[] = { 0, 0, 0, 9, 0, 0, 9, 9, 0 };
    expect_points(city_find(&sink, "p"), 3, outer);
    assert_int_equal(city_issue(&sink, "interior ring before the exterior one"), 1);
    assert_int_equal(
        read_surfaces(SURFACES(
            "<g:Polygon g:id='p'><g:exterior>" RING("0 0 0 9 0 0 9 9 0 0 0 0") "</g:exterior><g:exterior>" RING(
                "1 1 0 1 2 0 2 2 0 1 1 0") "</g:exterior></g:Polygon>")),
        1);
    assert_int_equal(city_issue(&sink, "polygon with a second exterior ring"), 1);
}

static void test_containers(void **state) {
    (void)state;
    /* clang-format off */
    assert_int_equal(read_surfaces(
        "<g:MultiGeometry><g:geometryMember><g:MultiSolid><g:solidMember><g:CompositeSolid><g:solidMember>"
        SHELL(MEMBERS(SQUARE("a", "1", "1"))) "</g:solidMember></g:CompositeSolid></g:solidMember></g:MultiSolid>"
        "</g:geometryMember><g:geometryMember>" SURFACES("<g:CompositeSurface><g:surfaceMembers>" SQUARE("b", "1", "2")
        SQUARE("c", "1", "3") "</g:surfaceMembers></g:CompositeSurface>") "</g:geometryMember></g:MultiGeometry>"
        "<g:TriangulatedSurface><g:trianglePatches><g:Triangle><g:exterior>" RING("0 0 0 1 0 0 1 1 0 0 0 0")
        "</g:exterior></g:Triangle></g:trianglePatches></g:TriangulatedSurface>"
        "<g:Tin g:id='t'><g:trianglePatches><g:Triangle><g:exterior>" RING("0 0 0 1 0 0 1 1 0 0 0 0")
        "</g:exterior></g:Triangle></g:trianglePatches><g:controlPoint><g:posList>0 0 0 1 1 1</g:posList>"
        "</g:controlPoint></g:Tin>"
        "<g:Surface g:id='s'><g:patches><g:PolygonPatch><g:exterior>" RING("0 0 0 1 0 0 1 1 0 0 0 0")
        "</g:exterior></g:PolygonPatch><g:Rectangle><g:exterior>" RING("0 0 0 1 0 0 1 1 0 0 1 0 0 0 0")
        "</g:exterior></g:Rectangle></g:patches></g:Surface>"
        "<g:Solid><g:interior><g:Shell>" MEMBERS(SQUARE("void", "1", "1")) "</g:Shell></g:interior></g:Solid>"
        "<g:MultiCurve><g:curveMember><g:LineString><g:posList>0 0 0 1 1 1</g:posList></g:LineString></g:curveMember>"
        "</g:MultiCurve>"), 3 + 1 + 1 + 2 + 1);
    /* clang-format on */
    assert_int_equal(geo_issues_count(sink.sink.issues), 0);
}

/* What is not read is counted with the object that holds it, beside what is. */
static void test_unread(void **state) {
    (void)state;
#define GOOD POLYGON("p", "0 0 5 1 0 5 1 1 5 0 0 5")
#define UNREAD "geometry that is not read"
    static const struct {
        const char *content, *example; /* example NULL: nothing is lost */
        size_t polygons;
    } cases[] = {
        { SURFACES(GOOD "</g:surfaceMember><g:surfaceMember><g:Cylinder><g:pos>1 2 3</g:pos></g:Cylinder>"),
          "Cylinder of B", 1 },
        { "<g:Cone/>", "Cone of B", 0 },
        { "<v:Pipe xmlns:v='http://example.invalid/v'/>" SURFACES(GOOD), "Pipe of B", 1 },
        { SURFACES(GOOD) "<g:Tin><g:trianglePatches/><g:controlPoint><g:posList>0 0 0 1 0 0 1 1 0</g:posList>"
                         "</g:controlPoint></g:Tin>",
          "Tin of control points of B", 1 },
        { "<g:Tin><g:controlPoint><g:posList>0 0 0 1 0 0 1 1 0</g:posList></g:controlPoint></g:Tin>",
          "Tin of control points of B", 0 },
        { "<g:MultiSurface><g:description>ours</g:description>" MEMBERS(GOOD) "</g:MultiSurface>", NULL, 1 },
        { "<g:MultiGeometry><g:geometryMember><g:CompositeCurve/></g:geometryMember></g:MultiGeometry>" SURFACES(GOOD),
          NULL, 1 },
    };
    for (size_t i = 0; i < NOC_COUNT(cases); i++) {
        const char *reason, *examples = "";
        bool repaired;
        size_t count = 0;
        if (read_surfaces(cases[i].content) != cases[i].polygons || city_issue(&sink, UNREAD) != !!cases[i].example)
            fail_msg("%zu: %zu polygons, %zu counted", i, sink.polygons.len, city_issue(&sink, UNREAD));
        for (size_t k = 0; cases[i].example && k < geo_issues_count(sink.sink.issues); k++)
            if (geo_issues_get(sink.sink.issues, k, &reason, &repaired, &count, &examples) && !strcmp(reason, UNREAD))
                assert_string_equal(examples, cases[i].example);
    }
    assert_int_equal(read_surfaces(SURFACES("<g:Polygon><g:exterior><g:Ring><g:curveMember><g:Curve><g:segments>"
                                            "<g:ArcByBulge/><g:LineStringSegment><g:posList>0 0 0 4 0 0 4 3 0 0 0 0"
                                            "</g:posList></g:LineStringSegment></g:segments></g:Curve></g:curveMember>"
                                            "</g:Ring></g:exterior></g:Polygon>")),
                     1);
    assert_int_equal(city_issue(&sink, "curve of a ring that is not read"), 1);
}

/* A surface without heights lies where its object begins, not at 0. */
static void test_heights_of_others(void **state) {
    (void)state;
#define HIGH3D POLYGON("high", "0 0 300 4 0 300 4 3 310 0 0 300")
#define FLAT2D "<g:posList srsDimension='2'>0 0 4 0 4 3 0 0</g:posList>"
    const double flat[] = { 0, 0, 300, 4, 0, 300, 4, 3, 300 };
    static const char reason[] = "surface without heights: put at the lowest height of its object";
    assert_int_equal(read_surfaces(IN_POLYGON(FLAT2D) SURFACES(HIGH3D)), 2);
    expect_points(city_find(&sink, "p"), 3, flat);
    assert_int_equal(city_issue(&sink, reason), 1);
    assert_int_equal(read_surfaces(SURFACES(HIGH3D) IN_POLYGON("<g:pos>0 0</g:pos><g:pos>4 0</g:pos><g:pos>4 3</g:pos>"
                                                               "<g:pos>0 0</g:pos>")),
                     2);
    expect_points(city_find(&sink, "p"), 3, flat);
    assert_int_equal(read_surfaces(IN_POLYGON(FLAT2D)), 1); /* alone: the terrain tells, once all is there */
    assert_int_equal(city_issue(&sink, reason), 0);
    assert_int_equal(read_surfaces(IN_POLYGON("<g:pos>0 0</g:pos><g:pos>4 0 300</g:pos><g:pos>4 3 300</g:pos>")
                                       SURFACES(HIGH3D)),
                     1);
    assert_int_equal(city_issue(&sink, "ring whose points have no heights, beside others"), 1);
    const char *terrain = MODEL(MEMBER("<d:ReliefFeature><d:reliefComponent><d:TINRelief g:id='T'><d:tin>"
                                       "<g:TriangulatedSurface><g:trianglePatches><g:Triangle><g:exterior>"
                                       "<g:LinearRing>" FLAT2D "</g:LinearRing></g:exterior></g:Triangle>"
                                       "</g:trianglePatches></g:TriangulatedSurface></d:tin></d:TINRelief>"
                                       "</d:reliefComponent></d:ReliefFeature>"));
    assert_int_equal(city_read_bytes(&sink, terrain, strlen(terrain), 3), NOC_OK);
    assert_int_equal(city_issue(&sink, "terrain without heights: put at 0"), 1);
}

static void test_rings_of_curves(void **state) {
    (void)state;
    const double joined[] = { 0, 0, 0, 4, 0, 0, 4, 0, 0, 4, 3, 0 };
    assert_int_equal(
        read_surfaces(SURFACES(
            "<g:Polygon g:id='p'><g:exterior><g:Ring><g:curveMember><g:LineString>"
            "<g:posList>0 0 0 4 0 0</g:posList></g:LineString></g:curveMember><g:curveMember><g:Curve><g:segments>"
            "<g:LineStringSegment><g:posList>4 0 0 4 3 0 0 0 0</g:posList></g:LineStringSegment></g:segments></g:Curve>"
            "</g:curveMember></g:Ring></g:exterior></g:Polygon>")),
        1);
    expect_points(city_find(&sink, "p"), 4, joined); /* repeated points are geo's business */
    assert_int_equal(
        read_surfaces(SURFACES(
            "<g:Polygon g:id='p'><g:exterior><g:Ring><g:curveMember><g:Curve><g:segments>"
            "<g:Arc><g:posList>0 0 0 2 2 0 4 0 0</g:posList></g:Arc><g:LineStringSegment>"
            "<g:posList>4 0 0 0 0 0</g:posList></g:LineStringSegment></g:segments></g:Curve></g:curveMember></g:Ring>"
            "</g:exterior></g:Polygon>")),
        1);
    assert_int_equal(city_issue(&sink, "arc taken as straight lines"), 1);
}

static void test_orientation(void **state) {
    (void)state;
    const double forth[] = { 0, 0, 0, 1, 0, 0, 1, 1, 0 }, back[] = { 1, 1, 0, 1, 0, 0, 0, 0, 0 };
#define P(id) POLYGON(id, "0 0 0 1 0 0 1 1 0 0 0 0")
#define ORIENTED(sign, content) "<g:OrientableSurface orientation='" sign "'>" content "</g:OrientableSurface>"
#define BASE(content) "<g:baseSurface>" content "</g:baseSurface>"
    assert_int_equal(read_surfaces(ORIENTED("+", BASE(P("plus"))) ORIENTED("-", BASE(P("minus")))
                                       ORIENTED("-", BASE(ORIENTED("-", BASE(P("twice")))))),
                     3);
    expect_points(city_find(&sink, "plus"), 3, forth);
    expect_points(city_find(&sink, "minus"), 3, back);
    expect_points(city_find(&sink, "twice"), 3, forth);
    /* Turned by reference: what the reference says counts, not where the polygon is written. */
    char *text =
        noc_format(MODEL(MEMBER(BUILDING(
                       "B", "<b:lod1MultiSurface>%s</b:lod1MultiSurface><b:lod2MultiSurface>%s</b:lod2MultiSurface>"))),
                   ORIENTED("-", BASE(P("p"))) ORIENTED("-", "<g:baseSurface>" P("q") "</g:baseSurface>"),
                   SURFACES("</g:surfaceMember><g:surfaceMember x:href='#p'/><g:surfaceMember>" ORIENTED(
                       "-", "<g:baseSurface x:href='#q'/>")));
    assert_int_equal(city_read_bytes(&sink, text, strlen(text), 3), NOC_OK);
    free(text);
    expect_points(city_find(&sink, "p"), 3, forth);
    expect_points(city_find(&sink, "q"), 3, back);
}

static void test_terrain(void **state) {
    (void)state;
#define FACE(positions) "<g:Triangle><g:exterior>" RING(positions) "</g:exterior></g:Triangle>"
    /* clang-format off */
    const char *text = MODEL(MEMBER(
        "<d:ReliefFeature g:id='R'><d:lod>1</d:lod><d:reliefComponent>"
        "<d:TINRelief g:id='T'><d:extent>" POLYGON("extent", "0 0 0 9 0 0 9 9 0 0 0 0")
        "</d:extent><d:tin><g:TriangulatedSurface>"
        "<g:trianglePatches>" FACE("0 0 0 1 0 0 1 1 0 0 0 0") FACE("0 0 0 1 1 0 0 1 0 0 0 0") FACE("0 0 0 1 1 0")
        "</g:trianglePatches></g:TriangulatedSurface></d:tin></d:TINRelief></d:reliefComponent><d:reliefComponent>"
        "<d:MassPointRelief g:id='M'><d:reliefPoints><g:MultiPoint/></d:reliefPoints></d:MassPointRelief>"
        "</d:reliefComponent><d:reliefComponent><d:BreaklineRelief/></d:reliefComponent></d:ReliefFeature>"));
    /* clang-format on */
    assert_int_equal(city_read_bytes(&sink, text, strlen(text), 3), NOC_OK);
    assert_int_equal(sink.polygons.len, 2);
    assert_int_equal(sink.objects.len, 1);
    assert_int_equal(sink.objects.data[0].kind, GEO_TERRAIN);
    assert_string_equal(sink.objects.data[0].id, "R");
    assert_int_equal(sink.polygons.data[0].cls, NOC_CLASS_TERRAIN);
    assert_string_equal(sink.polygons.data[0].id, "T");
    assert_int_equal(city_issue(&sink, "ring with too few points"), 1);
    assert_int_equal(city_issue(&sink, "relief that is not triangulated"), 2);
}

/* Expat hands text over in pieces: wherever a piece ends, the numbers must be the same. */
static void test_pieces(void **state) {
    (void)state;
    /* clang-format off */
    const char *shape = MEMBER(BUILDING("B", "<b:lod2MultiSurface>"
        SURFACES(POLYGON("p", "678016.20123 5403455.76712 412.9291 678017.2 5403455.7 412.9 678017.2 5403456.7 412.9"))
        "</b:lod2MultiSurface>"));
    /* clang-format on */
    const char *head = "<CityModel" NAMESPACES("2.0", GML31) "><!--", *tail = "-->";
    const double want[] = { 678016.20123, 5403455.76712, 412.9291,  678017.2, 5403455.7,
                            412.9,        678017.2,      5403456.7, 412.9 };
    const size_t chunk = 128 * 1024; /* of the reader */
    size_t lead = strlen(head) + strlen(tail), first = (size_t)(strstr(shape, "678016") - shape);
    char *text = noc_alloc(2 * chunk);
    for (size_t back = 0; back < 100; back += 3) { /* the number's piece ends `back` bytes after its beginning */
        size_t padding = chunk - lead - first - back;
        int n = snprintf(text, 2 * chunk, "%s%*s%s%s</CityModel>", head, (int)padding, "", tail, shape);
        assert_int_equal(city_read_bytes(&sink, text, (size_t)n, 3), NOC_OK);
        expect_points(city_find(&sink, "p"), 3, want);
    }
    free(text);
}

/* One ring of a million points and a very long blank: neither overflows anything. */
static void test_long_text(void **state) {
    (void)state;
    NOC_ARRAY(char) text = { 0 };
    const char *head = "<CityModel" NAMESPACES(
        "2.0", GML31) "><cityObjectMember><b:Building><b:lod2MultiSurface>"
                      "<g:MultiSurface><g:surfaceMember><g:Polygon><g:exterior><g:LinearRing><g:posList>";
    const char *tail = "</g:posList></g:LinearRing></g:exterior></g:Polygon></g:surfaceMember></g:MultiSurface>"
                       "</b:lod2MultiSurface></b:Building></cityObjectMember></CityModel>";
    const size_t points = 300000;
    assert_true(array_append(&text, head, strlen(head)));
    for (size_t i = 0; i < points; i++) {
        char number[64];
        int n = snprintf(number, sizeof(number), "%zu.125 %zu 7 ", i, i % 1000);
        assert_true(array_append(&text, number, (size_t)n));
    }
    assert_true(array_reserve(&text, text.len + (1 << 20)));
    memset(text.data + text.len, ' ', 1 << 20);
    text.len += 1 << 20;
    assert_true(array_append(&text, tail, strlen(tail)));
    assert_int_equal(city_read_bytes(&sink, text.data, text.len, 3), NOC_OK);
    assert_int_equal(sink.polygons.len, 1);
    assert_int_equal(sink.polygons.data[0].points, points);
    assert_true(sink.polygons.data[0].xyz[3 * (points - 1)] == (double)(points - 1) + 0.125);
    array_free(&text);
}

int main(void) {
#define T(f) cmocka_unit_test_teardown(f, finish)
    const struct CMUnitTest tests[] = {
        T(test_spellings_of_coordinates),
        T(test_two_dimensions),
        T(test_numbers_exact),
        T(test_bad_rings),
        T(test_holes),
        T(test_compact),
        T(test_containers),
        T(test_unread),
        T(test_heights_of_others),
        T(test_rings_of_curves),
        T(test_orientation),
        T(test_terrain),
        T(test_pieces),
        T(test_long_text),
    };
    return cmocka_run_group_tests_name("import/citygml_geometry", tests, NULL, NULL);
}
