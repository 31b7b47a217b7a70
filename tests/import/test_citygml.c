/* CityGML: objects, levels of detail, meanings, references, CRSs, and documents that are none. */
#include "city_expect.h"
#include "city_pieces.h"
#include "import/citygml/citygml.h"

#include <math.h>

/* ---- levels of detail ---- */

#define LEVELS                                                                                                         \
    MODEL(MEMBER(                                                                                                      \
        BUILDING("B",                                                                                                  \
                 "<b:lod0FootPrint>" SURFACES(                                                                         \
                     SQUARE("foot", "1",                                                                               \
                            "0")) "</b:lod0FootPrint>"                                                                 \
                                  "<b:lod0RoofEdge>" SURFACES(SQUARE("edge", "1", "3")) "</b:lod0RoofEdge>" LOD_SOLID( \
                                      "1", MEMBERS(SQUARE("block", "1", "1")))                                         \
                                      BOUND("RoofSurface", "2", SQUARE("roof2", "1", "2"))                             \
                                          BOUND("WallSurface", "3", UPRIGHT("wall3", "1"))                             \
                                              LOD_SURFACES("4", SQUARE("four", "1", "4")))))

static void test_lod_best_under_limit(void **state) {
    (void)state;
    expect(LEVELS, 4, "four");
    expect(LEVELS, 3, "wall3");
    assert_int_equal(sink.objects.data[0].lod, 3);
    expect(LEVELS, 2, "roof2");
    expect(LEVELS, 1, "block");
    expect(LEVELS, 0, "foot edge");
    assert_int_equal(city_find(&sink, "foot")->cls, NOC_CLASS_GROUND);
    assert_int_equal(city_find(&sink, "edge")->cls, NOC_CLASS_ROOF);
    /* of 3.0, where a building's own surfaces are its footprint */
    expect(MODEL(MEMBER(BUILDING("B", BOUND("RoofSurface", "0", SQUARE("edge", "1", "3"))
                                          LOD_SURFACES("0", SQUARE("foot", "1", "0"))))),
           3, "edge foot");
    assert_int_equal(city_find(&sink, "foot")->cls, NOC_CLASS_GROUND);
    assert_int_equal(city_find(&sink, "edge")->cls, NOC_CLASS_ROOF);
}

static void test_lod_per_building(void **state) {
    (void)state;
    /* clang-format off */
    expect(MODEL(MEMBER(BUILDING("B1", LOD_SOLID("1", MEMBERS(SQUARE("a", "1", "1")))))
                 MEMBER(BUILDING("B2", LOD_SOLID("1", MEMBERS(SQUARE("b", "1", "1")))
                                       BOUND("RoofSurface", "2", SQUARE("c", "1", "2"))))),
           3, "a c");
    /* clang-format on */
    assert_int_equal(sink.objects.len, 2);
    assert_int_equal(sink.objects.data[0].lod, 1);
    assert_int_equal(sink.objects.data[1].lod, 2);
    assert_string_equal(sink.objects.data[1].id, "B2");
    assert_int_equal(sink.objects.data[1].kind, GEO_BUILDING);
}

static void test_lod_of_parts(void **state) {
    (void)state;
    /* The whole's block must not stand inside its parts; a part that has only a block keeps it. */
    /* clang-format off */
    expect(MODEL(MEMBER(BUILDING("B", LOD_SOLID("1", MEMBERS(SQUARE("whole", "1", "1")))
                                      PART("P1", LOD_SOLID("1", MEMBERS(SQUARE("p1-1", "1", "1")))
                                                 BOUND("RoofSurface", "2", SQUARE("p1-2", "1", "2")))
                                      PART("P2", LOD_SOLID("1", MEMBERS(SQUARE("p2-1", "2", "1"))))))),
           3, "p1-2 p2-1");
    /* clang-format on */
    assert_int_equal(sink.objects.len, 1);
    /* An outline is no part of a body. */
    /* clang-format off */
    expect(MODEL(MEMBER(BUILDING("B", PART("P1", BOUND("RoofSurface", "2", SQUARE("p1-2", "1", "2")))
                                      PART("P2", "<b:lod0FootPrint>" SURFACES(SQUARE("p2-0", "2", "1"))
                                                 "</b:lod0FootPrint>")))),
           3, "p1-2");
    /* clang-format on */
}

static void test_lod_of_installations(void **state) {
    (void)state;
#define WITH_CHIMNEY                                                                                                   \
    MODEL(MEMBER(BUILDING("B", BOUND("RoofSurface", "2", SQUARE("roof2", "1", "2"))                                    \
                                   BOUND("RoofSurface", "3", SQUARE("roof3", "1", "2"))                                \
                                       INSTALLATION("chimney", "2", UPRIGHT("c2", "1"))                                \
                                           INSTALLATION("balcony", "3", UPRIGHT("b3", "2")))))
    expect(WITH_CHIMNEY, 3, "roof3 c2 b3");
    assert_int_equal(city_find(&sink, "c2")->cls, NOC_CLASS_INSTALLATION);
    expect(WITH_CHIMNEY, 2, "roof2 c2");
}

static void test_nothing_to_show(void **state) {
    (void)state;
    expect(MODEL(MEMBER(BUILDING("B", "")) MEMBER(BUILDING("C", LOD_SURFACES("4", SQUARE("s", "1", "1"))))), 3, "");
    assert_int_equal(sink.objects.len, 0);
    assert_int_equal(city_issue(&sink, "Building left out, no geometry"), 1);
    assert_int_equal(city_issue(&sink, "Building left out, no geometry at or under the level of detail asked for"), 1);
    expect(MODEL(""), 3, "");
}

/* ---- meanings ---- */

static void test_classes_of_buildings(void **state) {
    (void)state;
    /* clang-format off */
    expect(MODEL(MEMBER(BUILDING("B",
        BOUND("WallSurface", "3", UPRIGHT("wall", "1")) BOUND("RoofSurface", "3", SQUARE("roof", "2", "3"))
        BOUND("GroundSurface", "3", SQUARE("ground", "3", "0")) BOUND("ClosureSurface", "3", UPRIGHT("closure", "4"))
        BOUND("OuterCeilingSurface", "3", SQUARE("ceiling", "5", "2"))
        BOUND("OuterFloorSurface", "3", SQUARE("floor", "6", "2"))
        BOUND("FloorSurface", "3", SQUARE("inside", "7", "0"))
        "<b:boundedBy><b:WallSurface><b:lod3MultiSurface>" SURFACES(UPRIGHT("wall2", "8")) "</b:lod3MultiSurface>"
        "<b:opening><b:Window><b:lod3MultiSurface>" SURFACES(UPRIGHT("window", "9")) "</b:lod3MultiSurface></b:Window>"
        "</b:opening><b:opening><b:Door g:id='D'><b:lod3MultiSurface><g:MultiSurface><g:surfaceMember><g:Polygon>"
        "<g:exterior>" RING("0 0 0 1 0 0 1 0 2") "</g:exterior></g:Polygon></g:surfaceMember></g:MultiSurface>"
        "</b:lod3MultiSurface></b:Door></b:opening></b:WallSurface></b:boundedBy>"
        "<b:interiorRoom><b:Room>" BOUND("InteriorWallSurface", "3", UPRIGHT("room", "1"))
        "</b:Room></b:interiorRoom>"))),
        3, "wall roof ground closure ceiling floor wall2 window D");
    /* clang-format on */
    const struct {
        const char *id;
        noc_class cls;
    } want[] = { { "wall", NOC_CLASS_WALL },       { "roof", NOC_CLASS_ROOF },     { "ground", NOC_CLASS_GROUND },
                 { "closure", NOC_CLASS_CLOSURE }, { "window", NOC_CLASS_WINDOW }, { "D", NOC_CLASS_DOOR } };
    for (size_t i = 0; i < NOC_COUNT(want); i++)
        assert_int_equal(city_find(&sink, want[i].id)->cls, want[i].cls);
    /* what is inside is not drawn, and that is told */
    assert_int_equal(city_issue(&sink, "FloorSurface left out, it is inside"), 1);
    assert_int_equal(city_issue(&sink, "Room left out, it is inside"), 1);
}

static void test_classes_by_normal(void **state) {
    (void)state;
    /* clang-format off */
    const char *text = MODEL(MEMBER(BUILDING("B", LOD_SOLID("1",
        MEMBERS(SQUARE("up", "1", "3")) MEMBERS(UPRIGHT("side", "1"))
        MEMBERS(POLYGON("down", "1 0 0 1 1 0 2 1 0 2 0 0 1 0 0"))
        MEMBERS(POLYGON("slope", "0 0 0 1 0 0 1 1 2 0 1 2 0 0 0"))))));
    /* clang-format on */
    expect(text, 3, "up side down slope");
    assert_int_equal(city_find(&sink, "up")->cls, NOC_CLASS_ROOF);
    assert_int_equal(city_find(&sink, "side")->cls, NOC_CLASS_WALL);
    assert_int_equal(city_find(&sink, "down")->cls, NOC_CLASS_GROUND);
    assert_int_equal(city_find(&sink, "slope")->cls, NOC_CLASS_ROOF);
    /* In degrees a roof of 10 m rises 3 m: compared as numbers that would be a cliff. */
    sink.lat_first = true;
    expect(MODEL(MEMBER(BUILDING(
               "B",
               LOD_SOLID("2",
                         MEMBERS(POLYGON("slope",
                                         "35.0001 139 3 35 139 0 35 139.0001 0 35.0001 139.0001 3 35.0001 139 3")))))),
           3, "slope");
    assert_int_equal(city_find(&sink, "slope")->cls, NOC_CLASS_ROOF);
}

static void test_other_objects(void **state) {
    (void)state;
    /* clang-format off */
    expect(MODEL(
        MEMBER("<t:Road g:id='R'><t:lod1MultiSurface>" SURFACES(SQUARE("road1", "1", "0")) "</t:lod1MultiSurface>"
               "<t:trafficArea><t:TrafficArea><t:function>1</t:function><t:lod2MultiSurface>"
               SURFACES(SQUARE("lane", "1", "0")) "</t:lod2MultiSurface></t:TrafficArea></t:trafficArea>"
               "<t:trafficArea><t:TrafficArea><t:function>2</t:function><t:lod2MultiSurface>"
               SURFACES(SQUARE("foot", "2", "0")) "</t:lod2MultiSurface></t:TrafficArea></t:trafficArea>"
               "<t:trafficArea><t:TrafficArea><t:function codeSpace='../../codelists/TrafficArea_function.xml'>2000"
               "</t:function><t:lod2MultiSurface>" SURFACES(SQUARE("hodo", "3", "0"))
               "</t:lod2MultiSurface></t:TrafficArea></t:trafficArea>"
               "<t:auxiliaryTrafficArea><t:AuxiliaryTrafficArea><t:function>1220</t:function><t:lod2MultiSurface>"
               SURFACES(SQUARE("kerb", "4", "0")) "</t:lod2MultiSurface></t:AuxiliaryTrafficArea>"
                                                  "</t:auxiliaryTrafficArea><t:auxiliaryTrafficArea>"
                                                  "<t:AuxiliaryTrafficArea><t:function>1020</t:function>"
                                                  "<t:lod2MultiSurface>"
               SURFACES(SQUARE("verge", "5", "0")) "</t:lod2MultiSurface></t:AuxiliaryTrafficArea>"
               "</t:auxiliaryTrafficArea></t:Road>")
        MEMBER("<v:SolitaryVegetationObject><v:lod2Geometry>" SURFACES(UPRIGHT("tree", "1"))
               "</v:lod2Geometry></v:SolitaryVegetationObject>")
        MEMBER("<v:PlantCover><v:lod1MultiSurface>" SURFACES(SQUARE("lawn", "1", "0"))
               "</v:lod1MultiSurface></v:PlantCover>")
        MEMBER("<w:WaterBody><w:boundedBy><w:WaterSurface><w:lod2Surface>" SURFACES(SQUARE("river", "1", "0"))
               "</w:lod2Surface></w:WaterSurface></w:boundedBy><w:boundedBy><w:WaterGroundSurface><w:lod2Surface>"
               SURFACES(SQUARE("bed", "1", "0")) "</w:lod2Surface></w:WaterGroundSurface></w:boundedBy></w:WaterBody>")
        MEMBER("<f:CityFurniture><f:function>1530</f:function><f:lod1Geometry>" SURFACES(SQUARE("bench", "1", "0"))
               "</f:lod1Geometry></f:CityFurniture>")
        MEMBER("<l:LandUse><l:class>3000</l:class><l:lod1MultiSurface>" SURFACES(SQUARE("meadow", "1", "0"))
               "</l:lod1MultiSurface></l:LandUse>")
        MEMBER("<l:LandUse><l:class>1000</l:class><l:lod1MultiSurface>" SURFACES(SQUARE("town", "1", "0"))
               "</l:lod1MultiSurface></l:LandUse>")
        MEMBER("<br:Bridge><br:boundedBy><br:WallSurface><br:lod2MultiSurface>" SURFACES(UPRIGHT("pier", "1"))
               "</br:lod2MultiSurface></br:WallSurface></br:boundedBy></br:Bridge>")
        MEMBER("<gen:GenericCityObject><gen:lod1Geometry>" SURFACES(SQUARE("thing", "1", "0"))
               "</gen:lod1Geometry></gen:GenericCityObject>")),
        3, "lane foot hodo kerb verge tree lawn river bench meadow town pier thing");
    /* clang-format on */
    const struct {
        const char *id;
        noc_class cls;
    } want[] = { { "lane", NOC_CLASS_ROAD },     { "foot", NOC_CLASS_SIDEWALK }, { "hodo", NOC_CLASS_SIDEWALK },
                 { "kerb", NOC_CLASS_SIDEWALK }, { "verge", NOC_CLASS_GREEN },   { "tree", NOC_CLASS_TREE },
                 { "lawn", NOC_CLASS_GREEN },    { "river", NOC_CLASS_WATER },   { "bench", NOC_CLASS_FURNITURE },
                 { "meadow", NOC_CLASS_GREEN },  { "town", NOC_CLASS_GROUND },   { "pier", NOC_CLASS_BRIDGE },
                 { "thing", NOC_CLASS_OTHER } };
    for (size_t i = 0; i < NOC_COUNT(want); i++)
        assert_int_equal(city_find(&sink, want[i].id)->cls, want[i].cls);
    const geo_kind kinds[] = { GEO_TRANSPORT, GEO_VEGETATION, GEO_VEGETATION, GEO_WATER, GEO_FURNITURE,
                               GEO_LANDUSE,   GEO_LANDUSE,    GEO_BRIDGE,     GEO_OTHER };
    assert_int_equal(sink.objects.len, NOC_COUNT(kinds));
    for (size_t i = 0; i < NOC_COUNT(kinds); i++)
        assert_int_equal(sink.objects.data[i].kind, kinds[i]);
}

static void test_street_lamps(void **state) {
    (void)state;
    expect(MODEL(MEMBER("<f:CityFurniture g:id='L'><f:function>1150</f:function><f:lod2Geometry>" SURFACES(
               POLYGON("post", "5 7 1 5.1 7 1 5.1 7 7 5 7 7")
                   MEMBERS(POLYGON("arm", "5 7 7 9 7 7 9 8 7"))) "</f:lod2Geometry></f:CityFurniture>")
                     MEMBER(
                         "<f:CityFurniture g:id='M'><f:function codeSpace='../../codelists/CityFurniture_function.xml'>"
                         "1150</f:function><f:lod2Geometry>" SURFACES(
                             UPRIGHT("marking", "1")) "</f:lod2Geometry></f:CityFurniture>")),
           3, "post arm marking"); /* other code lists mean other things; the body stays */
    assert_int_equal(sink.lamps.len, 1);
    const geo_lamp *lamp = &sink.lamps.data[0];
    assert_float_equal(lamp->xyz[0], 5.05, 1e-9); /* the post's foot, not the arm */
    assert_float_equal(lamp->xyz[1], 7, 1e-9);
    assert_float_equal(lamp->xyz[2], 1, 1e-9);
    assert_float_equal(lamp->height, 6, 1e-9);
}

static void test_group_members(void **state) {
    (void)state;
    expect(MODEL(MEMBER("<gr:CityObjectGroup><gr:groupMember x:href='#B'/><gr:groupMember>" BUILDING(
               "B", LOD_SURFACES("2", SQUARE("s", "1", "1"))) "</gr:groupMember></gr:CityObjectGroup>")),
           3, "s");
}

/* ---- references ---- */

static void test_solid_of_references(void **state) {
    (void)state;
    /* clang-format off */
    expect(MODEL(MEMBER(BUILDING("B", LOD_SOLID("2", LINK("r") LINK("w"))
                                      BOUND("RoofSurface", "2", SQUARE("r", "1", "2"))
                                      BOUND("WallSurface", "2", UPRIGHT("w", "1"))))), 3, "r w");
    /* clang-format on */
    assert_int_equal(city_find(&sink, "r")->cls, NOC_CLASS_ROOF);
    /* The solid's own polygons say the same again, without a meaning. */
    /* clang-format off */
    expect(MODEL(MEMBER(BUILDING("B", LOD_SOLID("2", MEMBERS(SQUARE("s1", "1", "2")) MEMBERS(UPRIGHT("s2", "1")))
                                      BOUND("RoofSurface", "2", SQUARE("r", "1", "2"))))), 3, "r");
    /* clang-format on */
    /* Without surfaces of a meaning, the solid is all there is, whichever way it refers. */
    /* clang-format off */
    expect(MODEL(MEMBER(BUILDING("B", LOD_SOLID("2", "<g:surfaceMember><g:CompositeSurface g:id='all'>"
                                      MEMBERS(SQUARE("s1", "1", "2")) LINK("s1") "</g:CompositeSurface>"
                                      "</g:surfaceMember>") LOD_SURFACES("2", SQUARE("s1-again", "1", "2")))
                        ) MEMBER(BUILDING("C", "<b:lod1Solid><g:Solid><g:exterior x:href='#shell'/></g:Solid>"
                        "</b:lod1Solid><b:lod2MultiSurface><g:MultiSurface g:id='shell'>" MEMBERS(SQUARE("c", "1", "1"))
                        "</g:MultiSurface></b:lod2MultiSurface>"))), 3, "s1 c");
    /* clang-format on */
    assert_int_equal(city_issue(&sink, "polygon given twice"), 1);
}

static void test_references_between_objects(void **state) {
    (void)state;
    /* Each solid borrows a wall of the other: shown once, by its owner. */
    /* clang-format off */
    expect(MODEL(MEMBER(BUILDING("A", LOD_SOLID("2", LINK("a") LINK("b")) BOUND("WallSurface", "2", UPRIGHT("a", "1"))))
                 MEMBER(BUILDING("B", LOD_SOLID("2", LINK("b") LINK("a"))
                                      BOUND("WallSurface", "2", UPRIGHT("b", "2"))))),
           3, "b a");
    /* clang-format on */ /* B in the second pass, when a is known; A, whose reference leads forward, in the third */
    assert_int_equal(geo_issues_count(sink.sink.issues), 0);
    assert_int_equal(sink.objects.len, 2);
    assert_int_equal(sink.crs.len, 1);
    /* C's block is made of what B has, but does not show at the level chosen for it. */
    expect(MODEL(MEMBER(BUILDING("C", "<b:lod1MultiSurface x:href='#low'/>")) MEMBER(BUILDING(
               "B",
               "<b:lod1MultiSurface><g:MultiSurface g:id='low'>" MEMBERS(SQUARE(
                   "l1", "1", "1")) "</g:MultiSurface></b:lod1MultiSurface>" LOD_SURFACES("2", SQUARE("b2", "1", "2"))))
                     MEMBER(BUILDING("D", LOD_SOLID("1", LINK("l1") MEMBERS(SQUARE("d", "3", "1")))))),
           3, "b2 l1 d"); /* D in the second pass; C would be next, but all that it has is shown by then */
    assert_int_equal(geo_issues_count(sink.sink.issues), 0);
}

static void test_references_that_fail(void **state) {
    (void)state;
    expect(
        MODEL(MEMBER(BUILDING(
            "A",
            LOD_SURFACES("2", SQUARE("a", "1", "1") LINK("nowhere") LINK(
                                  "nowhere") "<g:surfaceMember x:href='other.gml#p'/><g:surfaceMember x:href='#'/>")))
                  MEMBER(BUILDING("B", LOD_SOLID("2", LINK("gone")) LOD_SOLID("1", MEMBERS(SQUARE("b", "1", "1")))))),
        3, "a b"); /* a level of nothing but dead references is no level */
    assert_int_equal(city_issue(&sink, "unresolved xlink"), 4);
    assert_int_equal(city_issue(&sink, "xlink into another file"), 1);
    /* In a circle, and many times over. */
    /* clang-format off */
    expect(MODEL(MEMBER(BUILDING("A", "<b:lod2MultiSurface><g:MultiSurface g:id='m'>" LINK("m") LINK("m") LINK("m")
                                      MEMBERS(SQUARE("a", "1", "1")) "</g:MultiSurface></b:lod2MultiSurface>"))),
           3, "a");
    /* clang-format on */
#define TEN(x) x x x x x x x x x x
    /* clang-format off */
    expect(MODEL(MEMBER(BUILDING("A", "<b:lod2MultiSurface><g:MultiSurface g:id='m'>" TEN(TEN(LINK("m")))
                                      "</g:MultiSurface></b:lod2MultiSurface>"))), 3, "");
    /* clang-format on */
    assert_int_equal(city_issue(&sink, "xlinks that lead in circles"), 1);
}

static void test_implicit_geometry(void **state) {
    (void)state;
#define TREE(id, position, content)                                                                                    \
    MEMBER("<v:SolitaryVegetationObject g:id='" id "'><v:lod2ImplicitRepresentation><ImplicitGeometry>"                \
           "<transformationMatrix>0 -2 0 0  2 0 0 0  0 0 2 0  0 0 0 1</transformationMatrix>" content                  \
           "<referencePoint><g:Point><g:pos>" position "</g:pos></g:Point></referencePoint></ImplicitGeometry>"        \
           "</v:lod2ImplicitRepresentation></v:SolitaryVegetationObject>")
#define PROTOTYPE                                                                                                      \
    "<relativeGMLGeometry><g:MultiSurface g:id='proto'>" MEMBERS(                                                      \
        POLYGON("p", "0 0 0 1 0 0 1 0 1")) "</g:MultiSurface></relativeGMLGeometry>"
    /* One prototype, referred to from before and from behind it. */
    expect(MODEL(TREE("t1", "100 200 5", "<relativeGMLGeometry x:href='#proto'/>") TREE("t2", "0 0 0", PROTOTYPE)
                     TREE("t3", "50 60 7", "<relativeGMLGeometry x:href='#proto'/>")
                         TREE("t4", "1 1 1", "<libraryObject>tree.wrl</libraryObject>")),
           3, "p p p");
    assert_int_equal(city_issue(&sink, "implicit geometry in an external file"), 1);
    bool seen[2] = { false };
    for (size_t i = 0; i < 3; i++) {
        const double *q = sink.polygons.data[i].xyz;
        bool first = !strcmp(sink.polygons.data[i].object, "t1"), third = !strcmp(sink.polygons.data[i].object, "t3");
        double x = first ? 100 : third ? 50 : 0, y = first ? 200 : third ? 60 : 0, z = first ? 5 : third ? 7 : 0;
        const double want[9] = { x, y, z, x, y + 2, z, x, y + 2, z + 2 }; /* turned by 90 degrees and doubled */
        for (int k = 0; k < 9; k++)
            assert_float_equal(q[k], want[k], 1e-9);
        seen[0] |= first;
        seen[1] |= third;
    }
    assert_true(seen[0] && seen[1]);
    /* About a point in degrees the metres are turned into degrees: a second of latitude is 30.8 m or so. */
    sink.lat_first = true;
    expect(MODEL(TREE("t2", "48 11 5", PROTOTYPE)), 3, "p");
    const double *q = sink.polygons.data[0].xyz;
    assert_float_equal(q[0], 11, 1e-12);
    assert_true(fabs(q[4] - 48 - 2 / 111190.0) < 1e-9); /* 111 190 m a degree at 48 degrees, as tables have it */
}

/* ---- CRSs ---- */

#define ENVELOPE(crs)                                                                                                  \
    "<g:boundedBy><g:Envelope srsName='" crs "' srsDimension='2'><g:lowerCorner>0 0</g:lowerCorner>"                   \
    "<g:upperCorner>9 9</g:upperCorner></g:Envelope></g:boundedBy>"

static void test_crs(void **state) {
    (void)state;
    expect(MODEL(MEMBER(BUILDING("A", LOD_SURFACES("2", SQUARE("a", "1", "1"))))
                     MEMBER(BUILDING("B", LOD_SURFACES("2", SQUARE("b", "1", "1"))))),
           3, "a b");
    assert_int_equal(sink.crs.len, 1);
    assert_string_equal(sink.crs.data[0], "(none)");

    /* clang-format off */
    expect(MODEL(ENVELOPE("EPSG:1") MEMBER(BUILDING("A", LOD_SURFACES("2", SQUARE("a", "1", "1"))))
                 MEMBER(BUILDING("B", ENVELOPE("EPSG:2") LOD_SURFACES("2", SQUARE("b", "1", "1")
                        "<g:Polygon g:id='b2' srsName='EPSG:3'><g:exterior>" RING("0 0 0 1 0 0 1 1 0")
                        "</g:exterior></g:Polygon>") ))
                 MEMBER(BUILDING("C", LOD_SURFACES("2", SQUARE("c", "1", "1"))))), 3, "a b b2 c");
    /* clang-format on */
    const char *want[] = { "EPSG:1", "EPSG:2", "EPSG:3", "EPSG:1" };
    assert_int_equal(sink.crs.len, NOC_COUNT(want));
    for (size_t i = 0; i < NOC_COUNT(want); i++) {
        assert_string_equal(sink.crs.data[i], want[i]);
        assert_int_equal(sink.polygons.data[i].crs, i + 1);
    }

    sink.lat_first = true;
    expect(MODEL(ENVELOPE("EPSG:1") MEMBER(BUILDING("A", LOD_SURFACES("2", POLYGON("a", "1 2 3 4 5 6 7 9 9"))))), 3,
           "a");
    const double swapped[9] = { 2, 1, 3, 5, 4, 6, 9, 7, 9 };
    assert_memory_equal(sink.polygons.data[0].xyz, swapped, sizeof(swapped));
}

/* ---- versions, roots, encodings ---- */

static void test_versions(void **state) {
    (void)state;
#define OLD_OR_NEW(version, gml)                                                                                       \
    "<any:CityModel xmlns:any='http://www.opengis.net/citygml/" version                                                \
    "'" NAMESPACES(version, gml) "><cityObjectMember>" BUILDING(                                                       \
        "B", BOUND("RoofSurface", "2", SQUARE("r", "1", "2"))) "</cityObjectMember></any:CityModel>"
    expect(OLD_OR_NEW("1.0", GML31), 3, "r");
    assert_string_equal(sink.format, "CityGML 1.0");
    expect(OLD_OR_NEW("2.0", GML31), 3, "r");
    assert_string_equal(sink.format, "CityGML 2.0");
    /* 3.0 has other names for the same structure. */
    /* clang-format off */
    expect("<CityModel" NAMESPACES("3.0", GML32) "><cityObjectMember><b:Building><boundary><con:WallSurface>"
           "<lod3MultiSurface>" SURFACES(UPRIGHT("wall", "1")) "</lod3MultiSurface><con:fillingSurface>"
           "<con:WindowSurface><lod3MultiSurface>" SURFACES(UPRIGHT("window", "2")) "</lod3MultiSurface>"
           "</con:WindowSurface></con:fillingSurface></con:WallSurface></boundary></b:Building></cityObjectMember>"
           "</CityModel>", 3, "wall window");
    /* clang-format on */
    assert_string_equal(sink.format, "CityGML 3.0");
    assert_int_equal(city_find(&sink, "window")->cls, NOC_CLASS_WINDOW);
    refuse(OLD_OR_NEW("4.0", GML32), NOC_ERR_UNSUPPORTED, "CityGML 4");
    refuse("<CityModel xmlns='http://www.citygml.org/citygml/0/4/0'/>", NOC_ERR_UNSUPPORTED, "citygml/0/4/0");
}

static void test_other_roots(void **state) {
    (void)state;
#define ONE BUILDING("B", LOD_SURFACES("2", SQUARE("s", "1", "1")))
    /* clang-format off */
    expect("<g:FeatureCollection" NAMESPACES("2.0", GML31) "><g:featureMembers>" ONE ONE "</g:featureMembers>"
           "</g:FeatureCollection>", 3, "s s");
    /* clang-format on */
    expect("<b:Building" NAMESPACES("2.0", GML31) ">" LOD_SURFACES("2", SQUARE("s", "1", "1")) "</b:Building>", 3, "s");
    refuse("<g:FeatureCollection" NAMESPACES("2.0", GML31) "/>", NOC_ERR_FORMAT, "no CityGML");
    refuse("<IndoorFeatures xmlns='http://www.opengis.net/indoorgml/1.0/core'/>", NOC_ERR_FORMAT, "<IndoorFeatures>");
    /* Objects of extensions stand among the others. */
    expect(MODEL(MEMBER("<u:Thing xmlns:u='urn:x'><u:a/></u:Thing>") MEMBER("<d:Unheard/>") MEMBER(ONE)), 3, "s");
    assert_int_equal(city_issue(&sink, "object type that is not read"), 2);
}

static void test_encodings(void **state) {
    (void)state;
    expect("\xef\xbb\xbf<?xml version='1.0' encoding='UTF-8'?>" MODEL(MEMBER(ONE)), 3, "s");
    expect("<?xml version='1.0' encoding='ISO-8859-1'?><!-- \xfc -->" MODEL(MEMBER(ONE)), 3, "s");
    const char *text = MODEL(MEMBER(ONE));
    size_t n = strlen(text);
    char *wide = noc_calloc(n + 1, 2);
    memcpy(wide, "\xff\xfe", 2);
    for (size_t i = 0; i < n; i++)
        wide[2 + 2 * i] = text[i];
    assert_int_equal(city_read_bytes(&sink, wide, 2 * n + 2, 3), NOC_OK);
    assert_int_equal(sink.polygons.len, 1);
    assert_true(noc_reader_citygml.probe(wide, 2 * n + 2));
    free(wide);
    refuse("<?xml version='1.0' encoding='Shift_JIS'?>" MODEL(""), NOC_ERR_UNSUPPORTED, "encoding");
    refuse("<?xml version='1.0'?><!-- \xfc -->" MODEL(""), NOC_ERR_FORMAT, ":1: ");
}

static void test_probe(void **state) {
    (void)state;
    const char *yes[] = { MODEL(""), "\n<?xml version='1.0'?><!-- <osm> --><core:CityModel ", "<!DOCTYPE x><CityModel>",
                          "<g:FeatureCollection xmlns:b='http://www.opengis.net/citygml/building/2.0'>" };
    const char *no[] = { "<osm version='0.6'>",
                         "{\"type\":\"CityJSON\"}",
                         "",
                         "v 0 0 0",
                         "<CityModels/>",
                         "<",
                         "<!--",
                         "CityModel http://www.opengis.net/citygml/2.0" };
    for (size_t i = 0; i < NOC_COUNT(yes); i++)
        assert_true(noc_reader_citygml.probe(yes[i], strlen(yes[i])));
    for (size_t i = 0; i < NOC_COUNT(no); i++)
        assert_false(noc_reader_citygml.probe(no[i], strlen(no[i])));
}

/* ---- what must not pass, and must not crash ---- */

static void test_hostile(void **state) {
    (void)state;
    refuse("<!DOCTYPE c [<!ENTITY a 'aaaa'><!ENTITY b '&a;&a;&a;&a;'>]><CityModel>&b;</CityModel>", NOC_ERR_FORMAT,
           "entity");
    refuse("<?xml version='1.0'?>\n<CityModel xmlns='http://www.opengis.net/citygml/2.0'>\n<a:b/></CityModel>",
           NOC_ERR_FORMAT, ":3: unbound prefix");
    refuse(MODEL("") "<more/>", NOC_ERR_FORMAT, "junk");
    char *deep = noc_strdup("");
    for (int i = 0; i < 20000; i++) {
        deep = noc_realloc(deep, strlen(deep) + 4);
        strcat(deep, "<a>");
    }
    char *text = noc_format("<CityModel xmlns='http://www.opengis.net/citygml/2.0'>%s", deep);
    refuse(text, NOC_ERR_FORMAT, "nested");
    free(text);
    free(deep);
    NOC_ARRAY(char) many = { 0 };
    const char *head = "<CityModel" NAMESPACES("2.0", GML31) ">";
    assert_true(array_append(&many, head, strlen(head)));
    for (int i = 0; i < 100; i++) {
        char *piece =
            noc_format(MEMBER("<b:Building><g:boundedBy><g:Envelope srsName='EPSG:%d'/></g:boundedBy></b:Building>"),
                       i);
        assert_true(array_append(&many, piece, strlen(piece)));
        free(piece);
    }
    assert_int_equal(city_read_bytes(&sink, many.data, many.len, 3), NOC_ERR_FORMAT);
    array_free(&many);
}

/* Geometry in all the wrong places. */
static void test_misplaced(void **state) {
    (void)state;
    /* clang-format off */
    expect(MODEL(SQUARE("p1", "1", "1") MEMBER(SQUARE("p2", "1", "1"))
                 MEMBER(BUILDING("B", SQUARE("p3", "1", "1") LOD_SURFACES("2",
                        "<g:Polygon g:id='p4'><g:exterior>" RING("0 0 0 1 0 0 1 1 0" SQUARE("p5", "1", "1"))
                        "</g:exterior>"
                        SQUARE("p6", "1", "1") ONE LOD_SURFACES("2", SQUARE("p7", "1", "1")) "</g:Polygon>")
                        "<transformationMatrix>1</transformationMatrix><referencePoint>"
                        "<g:pos>1 2 3</g:pos></referencePoint><g:posList>1 2 3</g:posList><b:function>"
                        "<b:function>x</b:function></b:function>"))
                 "<g:boundedBy><g:boundedBy><g:Envelope srsName='x'/></g:boundedBy></g:boundedBy>"), 3, "p4");
    /* clang-format on */
}

static void test_cut_anywhere(void **state) {
    (void)state;
    const char *text = "<?xml version='1.0'?>" MODEL(
        ENVELOPE("EPSG:25832") TREE("t1", "1 2 3", "<relativeGMLGeometry x:href='#proto'/>")
            TREE("t2", "1 2 3", PROTOTYPE)
                MEMBER(BUILDING("B", LOD_SOLID("2", LINK("r")) BOUND("RoofSurface", "2", SQUARE("r", "1", "2")))));
    size_t n = strlen(text);
    assert_int_equal(read_text(text, 3), NOC_OK);
    assert_int_equal(sink.polygons.len, 3);
    for (size_t cut = 1; cut < n; cut++) {
        assert_int_equal(city_read_bytes(&sink, text, cut, 3), NOC_ERR_FORMAT);
        assert_true(*noc_log_last_error(sink.sink.log));
    }
}

static void test_sink_stops(void **state) {
    (void)state;
    const char *text =
        MODEL(TREE("t1", "1 2 3", "<relativeGMLGeometry x:href='#proto'/>") TREE("t2", "1 2 3", PROTOTYPE) MEMBER(ONE));
    sink.stop_at = 0;
    assert_int_equal(read_text(text, 3), NOC_OK);
    size_t calls = sink.calls;
    assert_true(calls >= 9);
    for (size_t i = 1; i <= calls; i++) {
        sink.stop_at = i;
        assert_int_equal(read_text(text, 3), NOC_ERR_CANCELLED);
        assert_int_equal(sink.calls, i); /* and hears no more */
    }
}

int main(void) {
#define T(f) cmocka_unit_test_setup_teardown(f, start, finish)
    const struct CMUnitTest tests[] = {
        T(test_lod_best_under_limit),
        T(test_lod_per_building),
        T(test_lod_of_parts),
        T(test_lod_of_installations),
        T(test_nothing_to_show),
        T(test_classes_of_buildings),
        T(test_classes_by_normal),
        T(test_other_objects),
        T(test_street_lamps),
        T(test_group_members),
        T(test_solid_of_references),
        T(test_references_between_objects),
        T(test_references_that_fail),
        T(test_implicit_geometry),
        T(test_crs),
        T(test_versions),
        T(test_other_roots),
        T(test_encodings),
        T(test_probe),
        T(test_hostile),
        T(test_misplaced),
        T(test_cut_anywhere),
        T(test_sink_stops),
    };
    return cmocka_run_group_tests_name("import/citygml", tests, NULL, NULL);
}
