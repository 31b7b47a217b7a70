/* CityJSON: versions, places, levels of detail, meanings, parts, templates, lamps, sequences, and what is none. */
#include "city_sink.h"

#include <math.h>

static city_sink sink;

static int start(void **state) {
    (void)state;
    city_clear(&sink);
    sink = (city_sink){ .reader = &noc_reader_cityjson };
    return 0;
}

static int finish(void **state) {
    (void)state;
    city_clear(&sink);
    return 0;
}

/* Documents are written with ' for ". */
static char *quoted(const char *text) {
    char *copy = noc_strdup(text);
    for (char *c = copy; *c; c++)
        *c = *c == '\'' ? '"' : *c;
    return copy;
}

static noc_status read_text(const char *text, int lod) {
    char *json = quoted(text);
    noc_status status = city_read_bytes(&sink, json, strlen(json), lod);
    free(json);
    return status;
}

static void read_well(const char *text, int lod) {
    if (read_text(text, lod) != NOC_OK)
        fail_msg("%s", noc_log_last_error(sink.sink.log));
}

static void refuse(const char *text, noc_status status, const char *cause) {
    noc_status got = read_text(text, 3);
    const char *error = noc_log_last_error(sink.sink.log);
    if (got != status || !strstr(error, cause))
        fail_msg("status %d, \"%s\" does not say \"%s\"", got, error, cause);
}

static size_t of_class(noc_class cls) {
    size_t count = 0;
    for (size_t i = 0; i < sink.polygons.len; i++)
        count += sink.polygons.data[i].cls == cls;
    return count;
}

static size_t issues(void) { return geo_issues_count(sink.sink.issues); }

/* A unit cube with corner 0 at (0, 0, 0), corner 6 at (1, 1, 1) of the file's numbers. */
#define VERTICES "'vertices':[[0,0,0],[1,0,0],[1,1,0],[0,1,0],[0,0,1],[1,0,1],[1,1,1],[0,1,1]]"
#define FLOOR "[[0,3,2,1]]"
#define ROOF "[[4,5,6,7]]"
#define WALLS "[[0,1,5,4]],[[1,2,6,5]],[[2,3,7,6]],[[3,0,4,7]]"
#define SHELL "[" FLOOR "," ROOF "," WALLS "]"
#define SURFACES(lod, boundaries) "{'type':'MultiSurface','lod':" lod ",'boundaries':[" boundaries "]}"
#define SOLID(lod) "{'type':'Solid','lod':" lod ",'boundaries':[" SHELL "]}"
#define OBJECT(id, type, more, geometry) "'" id "':{'type':'" type "'," more "'geometry':[" geometry "]}"
#define TRANSFORM "'transform':{'scale':[2,2,3],'translate':[100,200,10]},"
#define FILE20(objects)                                                                                                \
    "{'type':'CityJSON','version':'2.0'," TRANSFORM "'metadata':{'referenceSystem':"                                   \
    "'https://www.opengis.net/def/crs/EPSG/0/7415'},'CityObjects':{" objects "}," VERTICES "}"

/* ---- versions and places ---- */

static void test_places(void **state) {
    (void)state;
    read_well(FILE20(OBJECT("b", "Building", "", SOLID("'1'"))), 3);
    assert_string_equal(sink.format, "CityJSON 2.0");
    assert_int_equal(sink.crs.len, 1);
    assert_string_equal(sink.crs.data[0], "https://www.opengis.net/def/crs/EPSG/0/7415");
    assert_int_equal(sink.polygons.len, 6);
    assert_int_equal(issues(), 0); /* rings of CityJSON are not closed */
    const seen_polygon *roof = &sink.polygons.data[1];
    assert_int_equal(roof->cls, NOC_CLASS_ROOF);
    assert_int_equal(roof->points, 4);
    const double corners[] = { 100, 200, 13, 102, 200, 13, 102, 202, 13, 100, 202, 13 };
    assert_memory_equal(roof->xyz, corners, sizeof(corners));
    assert_int_equal(of_class(NOC_CLASS_WALL), 4);
    assert_int_equal(of_class(NOC_CLASS_GROUND), 1);
    assert_int_equal(sink.objects.data[0].kind, GEO_BUILDING);
    assert_string_equal(sink.objects.data[0].id, "b");
    assert_int_equal(sink.objects.data[0].lod, 1);
    /* the axes are the authority's, as the sink says */
    sink.lat_first = true;
    read_well(FILE20(OBJECT("b", "Building", "", SOLID("'1'"))), 3);
    assert_float_equal(sink.polygons.data[1].xyz[0], 200, 0);
    assert_float_equal(sink.polygons.data[1].xyz[1], 100, 0);
    sink.lat_first = false;

    /* 1.0 needs no transform and no CRS, and has numbers for levels */
    read_well("{'type':'CityJSON','version':'1.0','CityObjects':{" OBJECT("b", "Building", "", SOLID("1")) "}," VERTICES
                                                                                                           "}",
              3);
    assert_string_equal(sink.format, "CityJSON 1.0");
    assert_string_equal(sink.crs.data[0], "(none)");
    assert_float_equal(sink.polygons.data[1].xyz[2], 1, 0);
    read_well("\xef\xbb\xbf {'CityObjects':{},'vertices':[],'version':'1.1.3','type':'CityJSON'}", 3);
    assert_string_equal(sink.format, "CityJSON 1.1");
    assert_int_equal(sink.objects.len, 0);
}

/* ---- levels of detail ---- */

static void expect_lod(const char *geometry, int most, int lod, double height) {
    char *text = noc_format(
        "{'type':'CityJSON','version':'1.0','CityObjects':{'b':{'type':'Building','geometry':[%s]}},"
        "'vertices':[[0,0,0],[9,0,0],[0,9,0],[0,0,1],[9,0,1],[0,9,1],[0,0,2],[9,0,2],[0,9,2],[0,0,3],[9,0,3],[0,9,3]]}",
        geometry);
    read_well(text, most);
    free(text);
    assert_int_equal(sink.objects.len, lod < 0 ? 0 : 1);
    assert_int_equal(sink.polygons.len, lod < 0 ? 0 : 1);
    if (lod < 0)
        return;
    assert_int_equal(sink.objects.data[0].lod, lod);
    assert_float_equal(sink.polygons.data[0].xyz[2], height, 0);
}

static void test_levels(void **state) {
    (void)state;
    static const char four[] = SURFACES("'1.2'", "[[0,1,2]]") "," SURFACES("'1.3'", "[[3,4,5]]") "," SURFACES(
        "'2.2'", "[[6,7,8]]") "," SURFACES("3", "[[9,10,11]]");
    expect_lod(four, 4, 3, 3);
    expect_lod(four, 3, 3, 3);
    expect_lod(four, 2, 2, 2);
    expect_lod(four, 1, 1, 1); /* 1.3, not 1.2 */
    expect_lod(four, 0, -1, 0);
    assert_int_equal(city_issue(&sink, "Building left out, no geometry at or under the level of detail asked for"), 1);
    expect_lod(SURFACES("1.3", "[[3,4,5]]") "," SURFACES("1.2", "[[0,1,2]]"), 3, 1, 1);
    expect_lod(SURFACES("'0.3'", "[[3,4,5]]") "," SURFACES("'0.1'", "[[0,1,2]]"), 3, 0, 1);
    assert_int_equal(sink.polygons.data[0].cls, NOC_CLASS_GROUND); /* an outline is no roof */
    expect_lod("{'type':'MultiSurface','boundaries':[[[0,1,2]]]}", 2, 2, 0);
    assert_int_equal(city_issue(&sink, "geometry without a level of detail, always drawn"), 1);
}

/* ---- parts ---- */

static void test_parts(void **state) {
    (void)state;
    /* clang-format off */
    read_well(FILE20(
        OBJECT("part", "BuildingPart", "'parents':['house'],", SURFACES("'2'", ROOF)) ","
        OBJECT("house", "Building", "'children':['part','dormer','room','gone'],", SURFACES("'2'", FLOOR)) ","
        OBJECT("dormer", "BuildingInstallation", "'parents':['house'],", SURFACES("'2'", "[[0,1,5,4]]")) ","
        OBJECT("room", "BuildingRoom", "'parents':['house'],", SOLID("'2'")) ","
        OBJECT("chair", "BuildingFurniture", "'parents':['room'],", SOLID("'2'")) ","
        OBJECT("orphan", "BuildingPart", "'parents':['lost'],", SURFACES("'2'", ROOF)) ","
        OBJECT("all", "CityObjectGroup", "'children':['house'],", SURFACES("'2'", ROOF)) ","
        OBJECT("a", "BuildingPart", "'parents':['b'],", SURFACES("'2'", ROOF)) ","
        OBJECT("b", "BuildingPart", "'parents':['a'],", SURFACES("'2'", ROOF))), 3);
    /* clang-format on */
    assert_int_equal(sink.objects.len, 3);
    assert_string_equal(sink.objects.data[0].id, "house");
    assert_int_equal(sink.objects.data[0].polygons, 3);
    assert_string_equal(city_find(&sink, "part")->object, "house");
    assert_string_equal(city_find(&sink, "dormer")->object, "house");
    assert_int_equal(city_find(&sink, "dormer")->cls, NOC_CLASS_INSTALLATION);
    assert_string_equal(city_find(&sink, "orphan")->object, "orphan");
    assert_string_equal(city_find(&sink, "b")->object, "a");
    assert_int_equal(city_issue(&sink, "BuildingRoom left out, it is inside"), 1);
    assert_int_equal(city_issue(&sink, "object whose parent is not in the file, drawn by itself"), 1);
    assert_int_equal(city_issue(&sink, "child that is not in the file"), 1);
    assert_int_equal(city_issue(&sink, "geometry of a group"), 1);
    assert_int_equal(city_issue(&sink, "parents that lead in circles"), 1);
    assert_int_equal(issues(), 5);
    /* children alone tell, and members of groups stay what they are */
    read_well(FILE20(OBJECT("house", "Building", "'children':['part'],", "") "," OBJECT(
                  "part", "BuildingPart", "",
                  SURFACES("'2'", ROOF)) "," OBJECT("g", "CityObjectGroup", "'children':['house','road'],",
                                                    "") "," OBJECT("road", "Road", "'parents':['g'],",
                                                                   SURFACES("'2'", ROOF))),
              3);
    assert_int_equal(sink.objects.len, 2);
    assert_string_equal(city_find(&sink, "part")->object, "house");
    assert_int_equal(city_find(&sink, "road")->cls, NOC_CLASS_ROAD);
    assert_int_equal(issues(), 0);
}

/* Parts in parts, as deep as a stranger likes. */
static void test_deep(void **state) {
    (void)state;
    enum { DEPTH = 20000 };
    char *text = noc_alloc(DEPTH * 64 + 200), *to = text;
    to += sprintf(to, "{'type':'CityJSON','version':'1.0','CityObjects':{'0':{'type':'Building'}");
    for (int i = 1; i < DEPTH; i++)
        to += sprintf(to, ",'%d':{'type':'BuildingPart','parents':['%d']}", i, i - 1);
    sprintf(to, "},'vertices':[]}");
    read_well(text, 3);
    free(text);
    assert_int_equal(city_issue(&sink, "parts nested too deep"), 1);
    assert_int_equal(issues(), 2); /* and there is nothing to draw */
}

/* ---- meanings ---- */

static void test_semantics(void **state) {
    (void)state;
    read_well(FILE20(
                  OBJECT("b", "Building", "",
                         "{'type':'Solid','lod':'2.2','boundaries':[" SHELL
                         "],'semantics':{'surfaces':[{'type':'RoofSurface'},"
                         "{'type':'GroundSurface'},{'type':'WallSurface','children':[3]},{'type':'Window','parent':2},"
                         "{'type':'FloorSurface'},{'type':'+Solar'}],'values':[[1,0,2,3,5,4]]}}")),
              3);
    assert_int_equal(sink.polygons.len, 5);
    assert_int_equal(of_class(NOC_CLASS_ROOF), 1);
    assert_int_equal(of_class(NOC_CLASS_GROUND), 1);
    assert_int_equal(of_class(NOC_CLASS_WALL), 2); /* one of them by its slope */
    assert_int_equal(of_class(NOC_CLASS_WINDOW), 1);
    assert_int_equal(city_issue(&sink, "FloorSurface left out, it is inside"), 1);
    /* null for one, for a shell, for all; a number that leads nowhere */
    read_well(FILE20(OBJECT("b", "Building", "",
                            "{'type':'MultiSolid','lod':'2','boundaries':[[" SHELL "],[" SHELL "],[" SHELL "]],"
                            "'semantics':{'surfaces':[{'type':'ClosureSurface'}],'values':"
                            "[[[0,null,null,null,7,0]],[null],null]}}")),
              3);
    assert_int_equal(sink.polygons.len + city_issue(&sink, "polygon given twice"), 18);
    assert_int_equal(of_class(NOC_CLASS_CLOSURE), 2);
    assert_int_equal(city_issue(&sink, "semantics that are not there"), 1);
    /* surfaces of roads, and what objects say of themselves */
    read_well(
        FILE20(OBJECT(
            "r", "Road", "",
            "{'type':'MultiSurface','lod':'2','boundaries':[" ROOF "," FLOOR "," WALLS "],"
            "'semantics':{'surfaces':[{'type':'TrafficArea','function':'footpath'},"
            "{'type':'AuxiliaryTrafficArea'},{'type':'TransportationMarking'}],"
            "'values':[0,1,2,2,2,2]}}") "," OBJECT("l", "LandUse", "'attributes':{'function':['grassland']},",
                                                   SURFACES("'1'",
                                                            ROOF)) "," OBJECT("w", "WaterBody", "",
                                                                              SURFACES(
                                                                                  "'1'",
                                                                                  ROOF)) "," OBJECT("s",
                                                                                                    "TransportSquare",
                                                                                                    "",
                                                                                                    SURFACES("'1'",
                                                                                                             ROOF))),
        3);
    assert_int_equal(of_class(NOC_CLASS_SIDEWALK), 2);
    assert_int_equal(of_class(NOC_CLASS_GREEN), 1);
    assert_int_equal(of_class(NOC_CLASS_WATER), 1);
    assert_int_equal(of_class(NOC_CLASS_ROAD), 1);
    assert_int_equal(city_issue(&sink, "object type that is not read"), 1); /* once a kind of surface */
}

static void test_kinds(void **state) {
    (void)state;
    /* clang-format off */
    read_well(FILE20(
        OBJECT("tin", "TINRelief", "",
               "{'type':'CompositeSurface','lod':'1','boundaries':[[[0,1,2]],[[0,2,3]]]},"
               "{'type':'CompositeSurface','lod':'2','boundaries':[[[4,5,6]]]}") ","
        OBJECT("tree", "SolitaryVegetationObject", "", SURFACES("'1'", ROOF)) ","
        OBJECT("bridge", "Bridge", "", SURFACES("'1'", ROOF)) ","
        OBJECT("x", "+Pavilion", "", SURFACES("'1'", ROOF)) ","
        OBJECT("y", "Castle", "", SURFACES("'1'", ROOF)) ","
        "'z':{'geometry':[" SURFACES("'1'", ROOF) "]},'n':null"), 3);
    /* clang-format on */
    assert_int_equal(sink.objects.data[0].kind, GEO_TERRAIN);
    assert_int_equal(sink.objects.data[0].polygons, 1); /* the better level alone */
    assert_int_equal(of_class(NOC_CLASS_TERRAIN), 1);
    assert_int_equal(city_find(&sink, "tree")->cls, NOC_CLASS_TREE);
    assert_int_equal(city_find(&sink, "bridge")->cls, NOC_CLASS_BRIDGE);
    assert_int_equal(city_find(&sink, "x")->cls, NOC_CLASS_OTHER);
    assert_int_equal(sink.objects.len, 6);
    assert_int_equal(city_issue(&sink, "object of an extension, drawn as a generic one"), 1);
    assert_int_equal(city_issue(&sink, "object of a type that is not known, drawn as a generic one"), 1);
    assert_int_equal(city_issue(&sink, "object without a type, drawn as a generic one"), 1);
    assert_int_equal(city_issue(&sink, "object that is none"), 1);
}

/* ---- geometries ---- */

static void test_geometries(void **state) {
    (void)state;
    read_well(FILE20(OBJECT("b", "Building", "",
                            "{'type':'CompositeSolid','lod':'1','boundaries':[[" SHELL "," SHELL "]]},"
                            "{'type':'MultiPoint','lod':'1','boundaries':[0]},"
                            "{'type':'MultiLineString','lod':'1','boundaries':[[0,1]]},"
                            "{'type':'Sphere','lod':'1','boundaries':[0]},{}")),
              3);
    assert_int_equal(sink.polygons.len, 6); /* and the hollow inside is not seen */
    assert_int_equal(city_issue(&sink, "shell of a hollow in a solid, left out, it is inside"), 1);
    assert_int_equal(city_issue(&sink, "points, which are not drawn"), 1);
    assert_int_equal(city_issue(&sink, "lines, which are not drawn"), 1);
    assert_int_equal(city_issue(&sink, "geometry of a type that is not known"), 2);
    /* holes; broken rings cost themselves alone */
    /* clang-format off */
    read_well("{'type':'CityJSON','version':'1.0','CityObjects':{"
              OBJECT("b", "LandUse", "",
                     SURFACES("1", "[[0,1,2,3],[4,5,6]],[[0,1,99]],[[0,1,-1]],[[0,1]],[[0,1,7]],[[0,1,'2']],"
                                   "[[0,1,2,3,0]],[],5,[7]") ",{'type':'Solid','lod':1,'boundaries':[7]}")
              "},'vertices':[[0,0,0],[9,0,0],[9,9,0],[0,9,0],[1,1,0],[1,2,0],[2,2,0],[1,'x',0]]}", 3);
    /* clang-format on */
    assert_int_equal(sink.polygons.len, 2);
    assert_int_equal(sink.polygons.data[0].rings, 2);
    assert_int_equal(sink.polygons.data[0].points, 7);
    assert_int_equal(sink.polygons.data[1].points, 4);
    assert_int_equal(city_issue(&sink, "vertex that is not there"), 3);
    assert_int_equal(city_issue(&sink, "coordinates that are not numbers"), 1);
    assert_int_equal(city_issue(&sink, "ring with too few points"), 2);
    assert_int_equal(city_issue(&sink, "boundaries that are not nested as their type has it"), 2);
}

#define INSTANCE(template, more) "{'type':'GeometryInstance','template':" template ",'boundaries':[6]" more "}"
#define TURNED ",'transformationMatrix':[0,-1,0,5,1,0,0,0,0,0,2,0,0,0,0,1]"

static void test_templates(void **state) {
    (void)state;
    /* clang-format off */
    read_well("{'type':'CityJSON','version':'1.1'," TRANSFORM "'geometry-templates':{'templates':["
              SURFACES("'2'", "[[0,1,2]]") "],'vertices-templates':[[1,0,0],[0,1,0],[0,0,1.5]]},'CityObjects':{"
              OBJECT("t", "SolitaryVegetationObject", "", INSTANCE("0", TURNED)) ","
              OBJECT("u", "SolitaryVegetationObject", "", INSTANCE("0", "")) ","
              OBJECT("v", "SolitaryVegetationObject", "", INSTANCE("3", "")) "}," VERTICES "}", 3);
    /* clang-format on */
    assert_int_equal(sink.polygons.len, 2);
    const double turned[] = { 107, 203, 13, 106, 202, 13, 107, 202, 16 },
                 plain[] = { 103, 202, 13, 102, 203, 13, 102, 202, 14.5 };
    assert_memory_equal(sink.polygons.data[0].xyz, turned, sizeof(turned));
    assert_memory_equal(sink.polygons.data[1].xyz, plain, sizeof(plain));
    assert_int_equal(city_issue(&sink, "template that is not there"), 1);
    /* values alone, and a matrix that is none */
    read_well(FILE20(OBJECT("t", "SolitaryVegetationObject", "", INSTANCE("0", TURNED))), 3);
    assert_int_equal(city_issue(&sink, "template that is not there"), 1);
    /* clang-format off */
    read_well("{'type':'CityJSON','version':'1.0','geometry-templates':{'templates':["
              SURFACES("2", "[[0,1,2]]") "],'vertices-templates':[[1,0,0],[0,1,0],[0,0,1.5]]},'CityObjects':{"
              OBJECT("t", "PlantCover", "", INSTANCE("0", ",'transformationMatrix':[1]")
              ",{'type':'GeometryInstance','template':0,'boundaries':[]}") "}," VERTICES "}",
        /* clang-format on */
        3);
    assert_int_equal(sink.polygons.len, 1);
    assert_float_equal(sink.polygons.data[0].xyz[0], 2, 0);
    assert_int_equal(city_issue(&sink, "transformation matrix that is not 4 x 4, left out"), 1);
    assert_int_equal(city_issue(&sink, "implicit geometry without a reference point"), 1);
}

/* ---- lamps ---- */

static void test_lamps(void **state) {
    (void)state;
    /* clang-format off */
    read_well(FILE20(
        OBJECT("point", "CityFurniture", "'attributes':{'function':'1150','Lichtpunkthoehe':4.5,'watt':30},",
               "{'type':'MultiPoint','lod':'0','boundaries':[6]}") ","
        OBJECT("post", "CityFurniture", "'attributes':{'class':'street lamp'},", SOLID("'1'")) ","
        OBJECT("+lamp", "+StreetLamp", "'attributes':{'name':'Street lamp'},",
               "{'type':'MultiPoint','lod':'0','boundaries':[1]}") ","
        OBJECT("bench", "CityFurniture", "'attributes':{'function':'1080'},", SOLID("'1'"))), 3);
    /* clang-format on */
    assert_int_equal(sink.lamps.len, 3);
    const geo_lamp *l = &sink.lamps.data[0];
    assert_float_equal(l->xyz[0], 102, 0);
    assert_float_equal(l->xyz[1], 202, 0);
    assert_float_equal(l->xyz[2], 13, 0);
    assert_float_equal(l->height, 4.5, 0);
    assert_float_equal(l->watts, 30, 0);
    assert_float_equal(sink.lamps.data[2].xyz[0], 102, 0);
    assert_int_equal(sink.polygons.len, 6); /* the bench's; the post is a block around its light */
    /* a vertex that is none is no place */
    read_well("{'type':'CityJSON','version':'1.0','CityObjects':{" OBJECT(
                  "a", "CityFurniture", "'attributes':{'function':'1150'},",
                  "{'type':'MultiPoint','lod':'0','boundaries':[0]}") "},'vertices':[[1,'x',2]]}",
              3);
    assert_int_equal(sink.lamps.len, 0);
    assert_int_equal(city_issue(&sink, "points, which are not drawn"), 1);
}

/* ---- sequences ---- */

#define HEAD(version) "{'type':'CityJSON','version':'" version "'," TRANSFORM "'CityObjects':{},'vertices':[]}\n"
#define FEATURE(id)                                                                                                    \
    "{'type':'CityJSONFeature','id':'" id "','CityObjects':{" OBJECT(id, "Building", "", SOLID("'1'")) "}," VERTICES   \
                                                                                                       "}\n"

static void test_sequence(void **state) {
    (void)state;
    read_well(HEAD("1.1") FEATURE("a") "\n" FEATURE("b"), 3);
    assert_string_equal(sink.format, "CityJSONSeq 1.1");
    assert_int_equal(sink.objects.len, 2);
    assert_int_equal(sink.polygons.len, 12);
    assert_float_equal(sink.polygons.data[7].xyz[2], 13, 0);
    /* the signs of RFC 7464, no line between two; a second head moves what follows */
    read_well(
        "\x1e" HEAD("2.0") "\x1e" FEATURE("a") FEATURE(
            "b") "{'type':'CityJSON','version':'2.0','transform':{'scale':[1,1,1],'translate':[0,0,0]},'metadata':"
                 "{'referenceSystem':'EPSG:7415'},'CityObjects':{},'vertices':[]}" FEATURE("c"),
        3);
    assert_string_equal(sink.format, "CityJSONSeq 2.0");
    assert_int_equal(sink.objects.len, 3);
    assert_float_equal(sink.polygons.data[13].xyz[2], 1, 0);
    assert_int_equal(sink.crs.len, 2);
    refuse(HEAD("2.0") FEATURE("a") "{'type':'CityJSONFeature',\n'CityObjects':{},\n\n 'vertices':}", NOC_ERR_FORMAT,
           ":6: ");
    refuse(HEAD("2.0") FEATURE("a") "{'type':'CityJSONFeature','CityObjects':{}}", NOC_ERR_FORMAT,
           ":3: \"vertices\" is missing");
    refuse(FEATURE("a"), NOC_ERR_FORMAT, "a CityJSONFeature before the CityJSON");
    refuse(HEAD("2.0") "{'type':'Feature'}", NOC_ERR_FORMAT, ":2: \"type\" is \"Feature\"");
    refuse(HEAD("2.0") "and so on", NOC_ERR_FORMAT, ":2: ");
}

/* ---- what is none, or too much ---- */

static void test_refused(void **state) {
    (void)state;
    refuse("{'type':'CityJSON','version':'2.0'", NOC_ERR_FORMAT, ":1: ");
    refuse("{'type':'CityJSON','version':'0.9','CityObjects':{},'vertices':[]}", NOC_ERR_UNSUPPORTED, "CityJSON 0.9");
    refuse("{'type':'CityJSON','version':'2.0','vertices':[]}", NOC_ERR_FORMAT, "\"CityObjects\" is missing");
    refuse("{'type':'CityJSON','version':'2.0','CityObjects':[],'vertices':[]}", NOC_ERR_FORMAT,
           "\"CityObjects\" is not an object");
    refuse("{'type':'CityJSON','version':'2.0','CityObjects':{},'vertices':7}", NOC_ERR_FORMAT,
           "\"vertices\" is not a list");
    refuse("{'type':'CityJSON','version':'1.1','CityObjects':{" OBJECT("b", "Building", "", SOLID("'1'")) "}," VERTICES
                                                                                                          "}",
           NOC_ERR_FORMAT, "\"transform\" is missing");
    refuse("{'type':'CityJSON','version':'2.0','transform':{'scale':[1,1],'translate':[0,0,0]},'CityObjects':{},"
           "'vertices':[]}",
           NOC_ERR_FORMAT, "\"transform\".\"scale\" is not a list of three numbers");
    refuse("{'type':'CityJSON','version':'2.0','transform':{'scale':[1,1,1]},'CityObjects':{},'vertices':[]}",
           NOC_ERR_FORMAT, "\"translate\"");
    refuse("{'type':'CityJSON','version':'1.0','geometry-templates':{'templates':7,'vertices-templates':[]},"
           "'CityObjects':{},'vertices':[]}",
           NOC_ERR_FORMAT, "\"templates\" is not a list");
    refuse("{'type':'CityJSON','version':'1.0','geometry-templates':{},'CityObjects':{},'vertices':[]}", NOC_ERR_FORMAT,
           "\"vertices-templates\" is missing");
    refuse("{'type':'City'}", NOC_ERR_FORMAT, "\"type\" is \"City\", not \"CityJSON\"");
    refuse("[]", NOC_ERR_FORMAT, "\"type\" is \"\"");
    refuse(" \n ", NOC_ERR_FORMAT, "no CityJSON in this file");
    /* JSON keeps the last of two equal keys, and so do we */
    read_well(FILE20(OBJECT("b", "Building", "", SOLID("'1'")) "," OBJECT("b", "Building", "", SURFACES("'1'", ROOF))),
              3);
    assert_int_equal(sink.polygons.len, 1);
    assert_int_equal(city_issue(&sink, "object whose id is given twice, of which the last is taken"), 1);
}

/* Memory is that of a value, so a sequence takes no more than its largest feature. */
static void test_memory(void **state) {
    (void)state;
    enum { MANY = 6000 };
    NOC_ARRAY(char) text = { 0 };
    char *head = quoted(HEAD("1.1"));
    assert_true(array_append(&text, head, strlen(head)));
    for (int i = 0; i < MANY; i++) {
        char *feature = quoted(FEATURE("a"));
        assert_true(array_append(&text, feature, strlen(feature)));
        free(feature);
    }
    sink.max_memory = 0.001; /* a MB */
    assert_true(text.len > 1000000);
    assert_int_equal(city_read_bytes(&sink, text.data, text.len, 3), NOC_OK);
    assert_int_equal(sink.objects.len, MANY);
    for (size_t i = 0; i < text.len; i++) /* as one value */
        if (text.data[i] == '\n')
            text.data[i] = ' ';
    text.len = 0;
    char *first = quoted("{'type':'CityJSON','version':'1.0','CityObjects':{},'vertices':[");
    assert_true(array_append(&text, first, strlen(first)));
    for (int i = 0; i < MANY; i++)
        assert_true(array_append(&text, "[1,2,3],", (size_t)8));
    assert_true(array_append(&text, "[1,2,3]]}", (size_t)9));
    assert_int_equal(city_read_bytes(&sink, text.data, text.len, 3), NOC_ERR_MEMORY);
    assert_non_null(strstr(noc_log_last_error(sink.sink.log), "--max-memory"));
    free(first);
    free(head);
    array_free(&text);
}

/* The sink may end the reading at any call. */
static void test_stopped(void **state) {
    (void)state;
    for (sink.stop_at = 1;; sink.stop_at++) {
        noc_status status = read_text(HEAD("1.1") FEATURE("a") FEATURE("b"), 3);
        if (status == NOC_OK)
            break;
        assert_int_equal(status, NOC_ERR_CANCELLED);
    }
    assert_int_equal(sink.stop_at, 1 + 2 * 8 + 1); /* CRS, and of each object its begin, end and six polygons */
    sink.stop_at = 0;
}

static void test_probe(void **state) {
    (void)state;
    static const char *const yes[] = { "{\"type\":\"CityJSON\"", "\xef\xbb\xbf\n{\"type\": \"CityJSON\"}",
                                       "{\"CityObjects\":{", "\x1e{\"type\":\"CityJSONFeature\"" };
    static const char *const no[] = { "", "CityJSON", "{\"type\":\"FeatureCollection\"}", "<a>\"CityJSON\"</a>" };
    for (size_t i = 0; i < NOC_COUNT(yes); i++)
        assert_true(noc_reader_cityjson.probe(yes[i], strlen(yes[i])));
    for (size_t i = 0; i < NOC_COUNT(no); i++)
        assert_false(noc_reader_cityjson.probe(no[i], strlen(no[i])));
}

/* ---- files as they are found; counts by other means (shared/data/README.md) ---- */

static void test_files(void **state) {
    (void)state;
    static const city_file files[] = {
        { "denhaag/DenHaag_01.city.json.gz", "CityJSON 2.0", 845, 21804 },
        { "delft/delft_3dfier_testarea_v10.city.json.gz", "CityJSON 1.0", 570, 24488 },
        { "delft/delft_3dfier_v20.city.json.gz", "CityJSON 2.0", 570, 36271 },
        { "delft/delft_3dbag_v11.city.jsonl.gz", "CityJSONSeq 1.1", 99, 12914, 45 }, /* of level 2.2 */
        { "rotterdam/rotterdam_ommoord_converted.city.json.gz", "CityJSON 1.0", 63, 710, 31 },
        { "zurich/zurich_subset_lod2.city.json.gz", "CityJSON 1.1", 49, 2039, 4 },
        { "samples/citygml4j/lod2_buildings_features.city.jsonl.gz", "CityJSONSeq 2.0", 100, 700 },
        { "samples/citygml4j/lod2_buildings_v2.city.json.gz", "CityJSON 2.0", 100, 700 },
        { "samples/bertt/building_with_innerring.city.json", "CityJSON 1.0", 1, 102, 7 },
        { "samples/cjval/texture4.city.json", "CityJSON 2.0", 1, 186, 41 },
        { "samples/val3dity/geomtemplate_1.city.json", "CityJSON 1.0", 1, 36 },
        { "samples/val3dity/msol.json", "CityJSON 1.0", 1, 12 },
    };
    city_files(&sink, files, NOC_COUNT(files));
}

int main(void) {
    const struct CMUnitTest tests[] = {
#define TEST(name) cmocka_unit_test_setup_teardown(name, start, finish)
        TEST(test_places),  TEST(test_levels),     TEST(test_parts),     TEST(test_deep),  TEST(test_semantics),
        TEST(test_kinds),   TEST(test_geometries), TEST(test_templates), TEST(test_lamps), TEST(test_sequence),
        TEST(test_refused), TEST(test_memory),     TEST(test_stopped),   TEST(test_probe), TEST(test_files),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
