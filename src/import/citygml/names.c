/* names.c: what each element means. Elements are known by local name and family of namespaces (GML 3.1 and 3.2,
 * CityGML of any version and module), never by prefix. Lookups are remembered: a city has millions of elements and a
 * few dozen names. */
#include "import/citygml/citygml.h"

#include <ctype.h>

/* clang-format off */
const cg_feature_type cg_feature_types[] = {
    { "Building", CG_PART_BODY, GEO_BUILDING, NOC_CLASS_OTHER },
    { "BuildingPart", CG_PART_BODY, GEO_BUILDING, NOC_CLASS_OTHER },
    { "BuildingInstallation", CG_PART_INSTALLATION, GEO_BUILDING, NOC_CLASS_INSTALLATION },
    { "BuildingConstructiveElement", CG_PART_INSTALLATION, GEO_BUILDING, NOC_CLASS_INSTALLATION },
    { "IntBuildingInstallation", CG_PART_INTERIOR, GEO_BUILDING, 0 },
    { "Room", CG_PART_INTERIOR, GEO_BUILDING, 0 },
    { "BuildingRoom", CG_PART_INTERIOR, GEO_BUILDING, 0 },
    { "BuildingUnit", CG_PART_INTERIOR, GEO_BUILDING, 0 },
    { "Storey", CG_PART_INTERIOR, GEO_BUILDING, 0 },
    { "BuildingFurniture", CG_PART_INTERIOR, GEO_BUILDING, 0 },
    { "WallSurface", CG_PART_BOUNDARY, GEO_BUILDING, NOC_CLASS_WALL },
    { "RoofSurface", CG_PART_BOUNDARY, GEO_BUILDING, NOC_CLASS_ROOF },
    { "GroundSurface", CG_PART_BOUNDARY, GEO_BUILDING, NOC_CLASS_GROUND },
    { "ClosureSurface", CG_PART_BOUNDARY, GEO_BUILDING, NOC_CLASS_CLOSURE },
    { "OuterCeilingSurface", CG_PART_BOUNDARY, GEO_BUILDING, NOC_CLASS_WALL },
    { "OuterFloorSurface", CG_PART_BOUNDARY, GEO_BUILDING, NOC_CLASS_ROOF },
    { "CeilingSurface", CG_PART_BOUNDARY, GEO_BUILDING, NOC_CLASS_WALL },
    { "FloorSurface", CG_PART_INTERIOR, GEO_BUILDING, 0 },
    { "InteriorWallSurface", CG_PART_INTERIOR, GEO_BUILDING, 0 },
    { "Window", CG_PART_OPENING, GEO_BUILDING, NOC_CLASS_WINDOW },
    { "WindowSurface", CG_PART_OPENING, GEO_BUILDING, NOC_CLASS_WINDOW },
    { "Door", CG_PART_OPENING, GEO_BUILDING, NOC_CLASS_DOOR },
    { "DoorSurface", CG_PART_OPENING, GEO_BUILDING, NOC_CLASS_DOOR },
    { "Bridge", CG_PART_BODY, GEO_BRIDGE, NOC_CLASS_BRIDGE },
    { "BridgePart", CG_PART_BODY, GEO_BRIDGE, NOC_CLASS_BRIDGE },
    { "BridgeInstallation", CG_PART_INSTALLATION, GEO_BRIDGE, NOC_CLASS_BRIDGE },
    { "BridgeConstructionElement", CG_PART_INSTALLATION, GEO_BRIDGE, NOC_CLASS_BRIDGE },
    { "BridgeConstructiveElement", CG_PART_INSTALLATION, GEO_BRIDGE, NOC_CLASS_BRIDGE },
    { "IntBridgeInstallation", CG_PART_INTERIOR, GEO_BRIDGE, 0 },
    { "BridgeRoom", CG_PART_INTERIOR, GEO_BRIDGE, 0 },
    { "BridgeFurniture", CG_PART_INTERIOR, GEO_BRIDGE, 0 },
    { "Tunnel", CG_PART_BODY, GEO_BRIDGE, NOC_CLASS_BRIDGE },
    { "TunnelPart", CG_PART_BODY, GEO_BRIDGE, NOC_CLASS_BRIDGE },
    { "TunnelInstallation", CG_PART_INSTALLATION, GEO_BRIDGE, NOC_CLASS_BRIDGE },
    { "TunnelConstructiveElement", CG_PART_INSTALLATION, GEO_BRIDGE, NOC_CLASS_BRIDGE },
    { "IntTunnelInstallation", CG_PART_INTERIOR, GEO_BRIDGE, 0 },
    { "HollowSpace", CG_PART_INTERIOR, GEO_BRIDGE, 0 },
    { "TunnelFurniture", CG_PART_INTERIOR, GEO_BRIDGE, 0 },
    { "OtherConstruction", CG_PART_BODY, GEO_OTHER, NOC_CLASS_OTHER },
    { "Road", CG_PART_BODY, GEO_TRANSPORT, NOC_CLASS_ROAD },
    { "Track", CG_PART_BODY, GEO_TRANSPORT, NOC_CLASS_ROAD },
    { "Square", CG_PART_BODY, GEO_TRANSPORT, NOC_CLASS_ROAD },
    { "Railway", CG_PART_BODY, GEO_TRANSPORT, NOC_CLASS_ROAD },
    { "TransportationComplex", CG_PART_BODY, GEO_TRANSPORT, NOC_CLASS_ROAD },
    { "Waterway", CG_PART_BODY, GEO_TRANSPORT, NOC_CLASS_WATER },
    { "Section", CG_PART_BODY, GEO_TRANSPORT, NOC_CLASS_ROAD },
    { "Intersection", CG_PART_BODY, GEO_TRANSPORT, NOC_CLASS_ROAD },
    { "TrafficSpace", CG_PART_SPACE, GEO_TRANSPORT, NOC_CLASS_ROAD },
    { "AuxiliaryTrafficSpace", CG_PART_SPACE, GEO_TRANSPORT, NOC_CLASS_SIDEWALK },
    { "ClearanceSpace", CG_PART_INTERIOR, GEO_TRANSPORT, 0 },
    { "TrafficArea", CG_PART_BOUNDARY, GEO_TRANSPORT, NOC_CLASS_ROAD },
    { "AuxiliaryTrafficArea", CG_PART_BOUNDARY, GEO_TRANSPORT, NOC_CLASS_SIDEWALK },
    { "Marking", CG_PART_UNREAD, GEO_TRANSPORT, 0 },
    { "SolitaryVegetationObject", CG_PART_BODY, GEO_VEGETATION, NOC_CLASS_TREE },
    { "PlantCover", CG_PART_BODY, GEO_VEGETATION, NOC_CLASS_GREEN },
    { "WaterBody", CG_PART_BODY, GEO_WATER, NOC_CLASS_WATER },
    { "WaterSurface", CG_PART_BOUNDARY, GEO_WATER, NOC_CLASS_WATER },
    { "WaterGroundSurface", CG_PART_INTERIOR, GEO_WATER, 0 },
    { "WaterClosureSurface", CG_PART_BOUNDARY, GEO_WATER, NOC_CLASS_CLOSURE },
    { "CityFurniture", CG_PART_BODY, GEO_FURNITURE, NOC_CLASS_FURNITURE },
    { "LandUse", CG_PART_BODY, GEO_LANDUSE, NOC_CLASS_GROUND },
    { "GenericCityObject", CG_PART_BODY, GEO_OTHER, NOC_CLASS_OTHER },
    { "GenericOccupiedSpace", CG_PART_BODY, GEO_OTHER, NOC_CLASS_OTHER },
    { "GenericUnoccupiedSpace", CG_PART_INTERIOR, GEO_OTHER, 0 },
    { "GenericLogicalSpace", CG_PART_INTERIOR, GEO_OTHER, 0 },
    { "GenericThematicSurface", CG_PART_BOUNDARY, GEO_OTHER, NOC_CLASS_OTHER },
    { "ReliefFeature", CG_PART_BODY, GEO_TERRAIN, NOC_CLASS_TERRAIN },
    { "TINRelief", CG_PART_BODY, GEO_TERRAIN, NOC_CLASS_TERRAIN },
    { "MassPointRelief", CG_PART_UNREAD, GEO_TERRAIN, 0 },
    { "BreaklineRelief", CG_PART_UNREAD, GEO_TERRAIN, 0 },
    { "RasterRelief", CG_PART_UNREAD, GEO_TERRAIN, 0 },
    { "CityObjectGroup", CG_PART_GROUP, GEO_OTHER, 0 },
};
/* clang-format on */

typedef struct cg_word {
    const char *name;
    uint8_t code;
} cg_word;

/* clang-format off */
static const cg_word gml_words[] = {
    { "FeatureCollection", CG_MODEL }, { "featureMember", CG_MEMBER }, { "featureMembers", CG_MEMBER },
    { "member", CG_MEMBER }, { "boundedBy", CG_BOUNDED_BY }, { "Envelope", CG_ENVELOPE },
    { "MultiSurface", CG_AGGREGATE }, { "CompositeSurface", CG_AGGREGATE }, { "MultiSolid", CG_AGGREGATE },
    { "CompositeSolid", CG_AGGREGATE }, { "Solid", CG_AGGREGATE }, { "Shell", CG_AGGREGATE },
    { "MultiGeometry", CG_AGGREGATE }, { "GeometricComplex", CG_AGGREGATE }, { "Surface", CG_AGGREGATE },
    { "PolyhedralSurface", CG_AGGREGATE }, { "TriangulatedSurface", CG_AGGREGATE }, { "Tin", CG_AGGREGATE },
    { "surfaceMember", CG_SURFACE_PROPERTY }, { "surfaceMembers", CG_SURFACE_PROPERTY },
    { "solidMember", CG_SURFACE_PROPERTY }, { "solidMembers", CG_SURFACE_PROPERTY },
    { "baseSurface", CG_SURFACE_PROPERTY }, { "geometryMember", CG_SURFACE_PROPERTY },
    { "geometryMembers", CG_SURFACE_PROPERTY }, { "element", CG_SURFACE_PROPERTY },
    { "patches", CG_SURFACE_PROPERTY }, { "polygonPatches", CG_SURFACE_PROPERTY },
    { "trianglePatches", CG_SURFACE_PROPERTY }, { "OrientableSurface", CG_ORIENTABLE },
    { "Point", CG_POINT }, { "MultiPoint", CG_PLAIN }, { "pointMember", CG_PLAIN }, { "pointMembers", CG_PLAIN },
    { "name", CG_LABEL },
    { "Polygon", CG_POLYGON }, { "PolygonPatch", CG_POLYGON }, { "Triangle", CG_POLYGON }, { "Rectangle", CG_POLYGON },
    { "exterior", CG_EXTERIOR }, { "outerBoundaryIs", CG_EXTERIOR }, { "interior", CG_INTERIOR },
    { "innerBoundaryIs", CG_INTERIOR }, { "LinearRing", CG_RING }, { "Ring", CG_RING },
    { "Arc", CG_ARC }, { "ArcString", CG_ARC }, { "Circle", CG_ARC }, { "CubicSpline", CG_ARC }, { "Bezier", CG_ARC },
    { "posList", CG_POS_LIST }, { "pos", CG_POS }, { "coordinates", CG_COORDINATES },
    { "pointProperty", CG_PLAIN }, { "pointRep", CG_PLAIN }, { "curveMember", CG_PLAIN },
    { "LineString", CG_PLAIN }, { "Curve", CG_PLAIN }, { "segments", CG_PLAIN }, { "LineStringSegment", CG_PLAIN },
};
/* clang-format on */

/* clang-format off */
static const cg_word city_words[] = {
    { "CityModel", CG_MODEL }, { "cityObjectMember", CG_MEMBER }, { "groupMember", CG_MEMBER },
    { "function", CG_FUNCTION }, { "usage", CG_FUNCTION }, { "class", CG_FUNCTION },
    { "storeysAboveGround", CG_FUNCTION }, { "measuredHeight", CG_FUNCTION }, { "Height", CG_HEIGHT },
    { "terminationDate", CG_LABEL }, { "validTo", CG_LABEL },
    { "ImplicitGeometry", CG_IMPLICIT }, { "transformationMatrix", CG_MATRIX },
    { "referencePoint", CG_REFERENCE_POINT }, { "relativeGMLGeometry", CG_RELATIVE_GEOMETRY },
    { "relativeGeometry", CG_RELATIVE_GEOMETRY }, { "TexturedSurface", CG_ORIENTABLE },
    { "stringAttribute", CG_ATTRIBUTE }, { "intAttribute", CG_ATTRIBUTE }, { "doubleAttribute", CG_ATTRIBUTE },
    { "measureAttribute", CG_ATTRIBUTE }, { "uriAttribute", CG_ATTRIBUTE }, { "dateAttribute", CG_ATTRIBUTE },
    { "StringAttribute", CG_ATTRIBUTE }, { "IntAttribute", CG_ATTRIBUTE }, { "DoubleAttribute", CG_ATTRIBUTE },
    { "MeasureAttribute", CG_ATTRIBUTE }, { "CodeAttribute", CG_ATTRIBUTE }, { "UriAttribute", CG_ATTRIBUTE },
    { "DateAttribute", CG_ATTRIBUTE }, { "name", CG_ATTRIBUTE_NAME }, { "value", CG_ATTRIBUTE_VALUE },
    { "appearance", CG_FOREIGN }, { "appearanceMember", CG_FOREIGN }, { "Appearance", CG_FOREIGN },
    { "address", CG_FOREIGN }, { "Address", CG_FOREIGN },
};
/* clang-format on */

static bool starts_with(const char *text, const char *start) { return !strncmp(text, start, strlen(start)); }

const char *cg_local_name(const char *name) {
    const char *separator = strrchr(name, '\n');
    return separator ? separator + 1 : name;
}

static uint8_t find_word(const cg_word *words, size_t count, const char *local, uint8_t otherwise) {
    for (size_t i = 0; i < count; i++)
        if (!strcmp(words[i].name, local))
            return words[i].code;
    return otherwise;
}

/* lod2MultiSurface and the like; curves and terrain intersections hold nothing to render, points only where a lamp
 * stands. */
static bool geometry_property(const char *local, cg_name *out) {
    static const struct {
        const char *name;
        uint8_t role;
    } roles[] = {
        { "MultiSurface", CG_ROLE_SURFACES },
        { "Surface", CG_ROLE_SURFACES },
        { "Geometry", CG_ROLE_SURFACES },
        { "GenericGeometry", CG_ROLE_SURFACES },
        { "ImplicitRepresentation", CG_ROLE_SURFACES },
        { "Solid", CG_ROLE_SOLID },
        { "MultiSolid", CG_ROLE_SOLID },
        { "Point", CG_ROLE_SURFACES },
        { "MultiPoint", CG_ROLE_SURFACES },
        { "FootPrint", CG_ROLE_FOOTPRINT },
        { "RoofEdge", CG_ROLE_ROOF_EDGE },
    };
    if (!strcmp(local, "tin")) {
        *out = (cg_name){ .code = CG_GEOMETRY_PROPERTY, .value = 1 * 16 + CG_ROLE_SURFACES };
        return true;
    }
    if (strncmp(local, "lod", 3) || local[3] < '0' || local[3] > '4' || !local[4])
        return false;
    *out = (cg_name){ .code = CG_FOREIGN };
    for (size_t i = 0; i < NOC_COUNT(roles); i++)
        if (!strcmp(local + 4, roles[i].name))
            *out = (cg_name){ .code = CG_GEOMETRY_PROPERTY, .value = (uint8_t)((local[3] - '0') * 16 + roles[i].role) };
    return true;
}

const cg_feature_type *cg_feature_type_of(const char *name) {
    for (size_t i = 0; i < NOC_COUNT(cg_feature_types); i++)
        if (!strcmp(cg_feature_types[i].name, name))
            return &cg_feature_types[i];
    return NULL;
}

static cg_name city_name(const char *local) {
    cg_name name;
    if (geometry_property(local, &name))
        return name;
    const cg_feature_type *type = cg_feature_type_of(local);
    if (type)
        return (cg_name){ .code = CG_FEATURE, .value = (uint8_t)(type - cg_feature_types) };
    return (cg_name){ .code = find_word(city_words, NOC_COUNT(city_words), local, CG_PLAIN) };
}

static cg_name gml_name(const char *local) {
    static const char *const simple[] = { "SimplePolygon", "SimpleTriangle", "SimpleRectangle" };
    for (size_t i = 0; i < NOC_COUNT(simple); i++)
        if (!strcmp(local, simple[i]))
            return (cg_name){ .code = CG_POLYGON, .value = CG_SIMPLE };
    return (cg_name){ .code = find_word(gml_words, NOC_COUNT(gml_words), local, CG_FOREIGN) };
}

static cg_name classify(const char *name) {
    const char *local = cg_local_name(name);
    if (starts_with(name, "http://www.opengis.net/gml\n") || starts_with(name, "http://www.opengis.net/gml/") ||
        starts_with(name, "http://www.opengis.net/wfs\n") || starts_with(name, "http://www.opengis.net/wfs/"))
        return gml_name(local);
    if (!starts_with(name, "http://www.opengis.net/citygml/"))
        return (cg_name){ .code = CG_FOREIGN };
    cg_name result = city_name(local);
    const char *digit = local - 1; /* the namespace ends in "/2.0" */
    while (digit > name && digit[-1] != '/')
        digit--;
    if (isdigit((unsigned char)*digit))
        result.version = (uint8_t)(*digit - '0');
    return result;
}

/* ---- memory of names ---- */

#define NAME_SLOTS 4096 /* a power of two; names beyond half of it are classified anew each time */

struct cg_name_slot {
    const char *name;
    cg_name value;
};

static uint32_t hash(const char *name) {
    uint32_t h = 2166136261u;
    for (; *name; name++)
        h = (h ^ (unsigned char)*name) * 16777619u;
    return h;
}

cg_name cg_names_get(cg_names *names, const char *name) {
    if (!names->slots && !(names->slots = noc_calloc(NAME_SLOTS, sizeof(*names->slots))))
        return classify(name); /* nothing is lost but time */
    uint32_t i = hash(name) & (NAME_SLOTS - 1);
    for (; names->slots[i].name; i = (i + 1) & (NAME_SLOTS - 1))
        if (!strcmp(names->slots[i].name, name))
            return names->slots[i].value;
    cg_name value = classify(name);
    const char *kept = names->len < NAME_SLOTS / 2 ? arena_strdup(&names->arena, name) : NULL;
    if (kept) {
        names->slots[i] = (struct cg_name_slot){ kept, value };
        names->len++;
    }
    return value;
}

void cg_names_free(cg_names *names) {
    free(names->slots);
    arena_free(&names->arena);
    *names = (cg_names){ 0 };
}
