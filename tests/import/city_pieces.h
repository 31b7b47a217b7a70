/* Pieces of CityGML documents, written for the tests. */
#ifndef NOC_TEST_CITY_PIECES_H
#define NOC_TEST_CITY_PIECES_H

#define NAMESPACES(version, gml)                                                                                       \
    " xmlns='http://www.opengis.net/citygml/" version "'"                                                              \
    " xmlns:b='http://www.opengis.net/citygml/building/" version "'"                                                   \
    " xmlns:t='http://www.opengis.net/citygml/transportation/" version "'"                                             \
    " xmlns:w='http://www.opengis.net/citygml/waterbody/" version "'"                                                  \
    " xmlns:v='http://www.opengis.net/citygml/vegetation/" version "'"                                                 \
    " xmlns:f='http://www.opengis.net/citygml/cityfurniture/" version "'"                                              \
    " xmlns:l='http://www.opengis.net/citygml/landuse/" version "'"                                                    \
    " xmlns:d='http://www.opengis.net/citygml/relief/" version "'"                                                     \
    " xmlns:br='http://www.opengis.net/citygml/bridge/" version "'"                                                    \
    " xmlns:gr='http://www.opengis.net/citygml/cityobjectgroup/" version "'"                                           \
    " xmlns:gen='http://www.opengis.net/citygml/generics/" version "'"                                                 \
    " xmlns:con='http://www.opengis.net/citygml/construction/" version "'"                                             \
    " xmlns:g='" gml "' xmlns:x='http://www.w3.org/1999/xlink'"
#define GML31 "http://www.opengis.net/gml"
#define GML32 "http://www.opengis.net/gml/3.2"

#define MODEL(content) "<CityModel" NAMESPACES("2.0", GML31) ">" content "</CityModel>"
#define MEMBER(content) "<cityObjectMember>" content "</cityObjectMember>"
#define BUILDING(id, content) "<b:Building g:id='" id "'>" content "</b:Building>"

#define RING(positions) "<g:LinearRing><g:posList>" positions "</g:posList></g:LinearRing>"
#define POLYGON(id, positions) "<g:Polygon g:id='" id "'><g:exterior>" RING(positions) "</g:exterior></g:Polygon>"
/* Level square, edge 1, corner at (x, 0, z); counter-clockwise seen from above. */
#define SQUARE(id, x, z) POLYGON(id, x ".0 0 " z " " x ".9 0 " z " " x ".9 1 " z " " x ".0 1 " z " " x ".0 0 " z)
#define UPRIGHT(id, x) POLYGON(id, x ".0 0 0 " x ".9 0 0 " x ".9 0 3 " x ".0 0 3 " x ".0 0 0")
#define MEMBERS(content) "<g:surfaceMember>" content "</g:surfaceMember>"
#define SURFACES(content) "<g:MultiSurface>" MEMBERS(content) "</g:MultiSurface>"
#define SHELL(content)                                                                                                 \
    "<g:Solid><g:exterior><g:CompositeSurface>" content "</g:CompositeSurface></g:exterior></g:Solid>"
#define LINK(id) "<g:surfaceMember x:href='#" id "'/>"
#define BOUND(type, lod, content)                                                                                      \
    "<b:boundedBy><b:" type " g:id='" type "-" lod "'><b:lod" lod                                                      \
    "MultiSurface>" SURFACES(content) "</b:lod" lod "MultiSurface></b:" type "></b:boundedBy>"
#define LOD_SURFACES(lod, content) "<b:lod" lod "MultiSurface>" SURFACES(content) "</b:lod" lod "MultiSurface>"
#define LOD_SOLID(lod, content) "<b:lod" lod "Solid>" SHELL(content) "</b:lod" lod "Solid>"
#define INSTALLATION(id, lod, content)                                                                                 \
    "<b:outerBuildingInstallation><b:BuildingInstallation g:id='" id "'><b:lod" lod                                    \
    "Geometry>" SURFACES(content) "</b:lod" lod "Geometry></b:BuildingInstallation></b:outerBuildingInstallation>"
#define PART(id, content)                                                                                              \
    "<b:consistsOfBuildingPart><b:BuildingPart g:id='" id "'>" content "</b:BuildingPart></b:consistsOfBuildingPart>"

#endif
