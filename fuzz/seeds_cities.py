"""Seeds of CityGML and CityJSON."""
import gzip, json

from seedbox import put, zipped

# ---- CityGML ----

def ring(points, tag="posList", id=""):
    text = " ".join("%g %g %g" % tuple(p) for p in points)
    if tag == "posList":
        inner = "<gml:posList>%s</gml:posList>" % text
    else:
        inner = "".join("<gml:pos>%g %g %g</gml:pos>" % tuple(p) for p in points)
    inner = "<gml:posList>%s</gml:posList>" % text if tag == "posList" else "".join("<gml:pos>%g %g %g</gml:pos>" %
                                                                                    tuple(p) for p in points)
    return "<gml:LinearRing%s>%s</gml:LinearRing>" % (id, inner)


def polygon(points, id="p", hole=None, tag="posList"):
    return ('<gml:surfaceMember><gml:Polygon gml:id="%s"><gml:exterior>%s</gml:exterior>%s</gml:Polygon>'
            '</gml:surfaceMember>'
            % (id, ring(points, tag), "<gml:interior>%s</gml:interior>" % ring(hole) if hole else ""))


def box(x, y, z, a, b, c):
    p = lambda i, j, k: (x + a * i, y + b * j, z + c * k)
    floor = [p(0, 0, 0), p(0, 1, 0), p(1, 1, 0), p(1, 0, 0), p(0, 0, 0)]
    roof = [p(0, 0, 1), p(1, 0, 1), p(1, 1, 1), p(0, 1, 1), p(0, 0, 1)]
    walls = [[p(0, 0, 0), p(1, 0, 0), p(1, 0, 1), p(0, 0, 1), p(0, 0, 0)],
             [p(1, 0, 0), p(1, 1, 0), p(1, 1, 1), p(1, 0, 1), p(1, 0, 0)]]
    return floor, roof, walls


def citygml(version, crs, body, dimension=3):
    n = "http://www.opengis.net/citygml"
    spaces = " ".join('xmlns:%s="%s/%s/%s"' % (s, n, p, version) for s, p in [
        ("bldg", "building"), ("dem", "relief"), ("tran", "transportation"), ("frn", "cityfurniture"),
        ("gen", "generics"), ("luse", "landuse"),
        ("veg", "vegetation"), ("wtr", "waterbody"), ("brid", "bridge"), ("app", "appearance")])
    return ('<?xml version="1.0" encoding="UTF-8"?>\n'
            '<core:CityModel xmlns:core="%s/%s" %s xmlns:gml="http://www.opengis.net/gml" '
            'xmlns:xlink="http://www.w3.org/1999/xlink" xmlns:xAL="urn:oasis:names:tc:ciq:xsdschema:xAL:2.0">\n'
            '<gml:boundedBy><gml:Envelope srsName="%s" srsDimension="%d">'
            '<gml:lowerCorner>690000 5330000 400</gml:lowerCorner>'
            '<gml:upperCorner>691000 5331000 600</gml:upperCorner></gml:Envelope></gml:boundedBy>\n'
            '%s\n</core:CityModel>\n'
            % (n, version, spaces, crs, dimension, body))


def member(xml):
    return "<core:cityObjectMember>%s</core:cityObjectMember>\n" % xml


floor, roof, walls = box(690100, 5330100, 500, 10, 8, 6)
surface = lambda kind, poly: ('<bldg:boundedBy><bldg:%s><bldg:lod2MultiSurface><gml:MultiSurface>%s</gml:MultiSurface>'
                              '</bldg:lod2MultiSurface>'
                              '</bldg:%s></bldg:boundedBy>' % (kind, poly, kind))
lod2 = ('<bldg:Building gml:id="b1"><core:creationDate>2020-01-01</core:creationDate>'
        '<bldg:function>31001_1000</bldg:function>'
        '<bldg:measuredHeight uom="m">6</bldg:measuredHeight>' + surface("GroundSurface", polygon(floor, "g")) +
        surface("RoofSurface", polygon(roof, "r",
                                       hole=[(690102, 5330102, 506), (690104, 5330102, 506), (690104, 5330104, 506),
                                             (690102, 5330102, 506)])) +
        surface("WallSurface", polygon(walls[0], "w0") + polygon(walls[1], "w1", tag="pos")) +
        '<bldg:lod2Solid><gml:Solid><gml:exterior><gml:CompositeSurface><gml:surfaceMember xlink:href="#w0"/>'
        '<gml:surfaceMember xlink:href="#none"/>'
        '</gml:CompositeSurface></gml:exterior></gml:Solid></bldg:lod2Solid>'
        '<bldg:consistsOfBuildingPart><bldg:BuildingPart gml:id="part"><bldg:lod1Solid><gml:Solid><gml:exterior>'
        '<gml:CompositeSurface>' +
        polygon(walls[1], "q") + '</gml:CompositeSurface></gml:exterior></gml:Solid></bldg:lod1Solid>'
                                 '</bldg:BuildingPart></bldg:consistsOfBuildingPart></bldg:Building>')
terrain = ('<dem:ReliefFeature gml:id="t"><dem:lod>2</dem:lod><dem:reliefComponent><dem:TINRelief gml:id="tin">'
           '<dem:lod>2</dem:lod><dem:tin><gml:TriangulatedSurface>'
           '<gml:trianglePatches><gml:Triangle><gml:exterior>%s</gml:exterior></gml:Triangle></gml:trianglePatches>'
           '</gml:TriangulatedSurface></dem:tin>'
           '</dem:TINRelief></dem:reliefComponent></dem:ReliefFeature>'
           % ring([(690000, 5330000, 500), (690300, 5330000, 500), (690000, 5330300, 501), (690000, 5330000, 500)]))
road = ('<tran:Road gml:id="road"><tran:function>1</tran:function><tran:trafficArea><tran:TrafficArea>'
        '<tran:lod2MultiSurface><gml:MultiSurface>%s</gml:MultiSurface>'
        '</tran:lod2MultiSurface></tran:TrafficArea></tran:trafficArea></tran:Road>' % polygon(floor, "rp"))
lamp_object = ('<frn:CityFurniture gml:id="lamp"><gen:stringAttribute name="class">'
               '<gen:value>street lamp</gen:value></gen:stringAttribute>'
               '<gen:doubleAttribute name="height"><gen:value>8.5</gen:value></gen:doubleAttribute>'
               '<frn:class>1000</frn:class><frn:function>1080</frn:function>'
               '<frn:lod1ImplicitRepresentation><core:ImplicitGeometry>'
               '<core:transformationMatrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</core:transformationMatrix>'
               '<core:referencePoint><gml:Point><gml:pos>690110 5330120 500</gml:pos></gml:Point></core:referencePoint>'
               '<core:relativeGMLGeometry><gml:MultiSurface>%s'
               '</gml:MultiSurface></core:relativeGMLGeometry></core:ImplicitGeometry></frn:lod1ImplicitRepresentation>'
               '</frn:CityFurniture>'
               % polygon([(0, 0, 0), (1, 0, 0), (0, 0, 8), (0, 0, 0)], "i"))
whole = citygml("2.0", "urn:ogc:def:crs,crs:EPSG::25832,crs:EPSG::5783", member(lod2) + member(terrain) + member(road) +
                member(lamp_object))
old = citygml("1.0", "EPSG:31468", member(lod2))
degrees = citygml("2.0", "urn:ogc:def:crs:EPSG::4979",
                  member('<bldg:Building gml:id="d">' + surface("RoofSurface", polygon(
    [(48.1, 11.5, 500), (48.1001, 11.5, 500), (48.1001, 11.5001, 500), (48.1, 11.5, 500)])) + '</bldg:Building>'))
put("citygml", "whole.gml", whole)
put("citygml", "old.gml", old)
put("citygml", "degrees.gml", degrees)
look = ('<app:appearanceMember><app:Appearance><app:theme>t</app:theme><app:surfaceDataMember>%s'
        '</app:surfaceDataMember></app:Appearance></app:appearanceMember>')
looks = "".join(look % x for x in [
    '<app:ParameterizedTexture><app:imageURI>side.png</app:imageURI><app:wrapMode>wrap</app:wrapMode>'
    '<app:target uri="#w0"><app:TexCoordList><app:textureCoordinates ring="#in">0 0 1 0 1 1 0 1 0 0'
    '</app:textureCoordinates></app:TexCoordList></app:target></app:ParameterizedTexture>',
    '<app:X3DMaterial gml:id="brick"><app:shininess>.5</app:shininess><app:transparency>.1</app:transparency>'
    '<app:diffuseColor>.5 .2 .1</app:diffuseColor><app:specularColor>1 1 1</app:specularColor>'
    '<app:emissiveColor>1 0 0</app:emissiveColor><app:target>#w1</app:target><app:target>#b1</app:target>'
    '</app:X3DMaterial>',
    '<app:GeoreferencedTexture><app:imageURI>other.jpg</app:imageURI></app:GeoreferencedTexture>'])
in_image = surface("WallSurface", polygon(walls[0], "w0")).replace("<gml:LinearRing>", '<gml:LinearRing gml:id="in">')
put("citygml", "looks.gml", citygml("2.0", "EPSG:25832", member(
    '<bldg:Building gml:id="b1">' + in_image + surface("WallSurface", polygon(walls[1], "w1")) + "</bldg:Building>") +
    looks))
put("citygml", "whole.gml.gz", gzip.compress(whole.encode(), mtime=0))
put("citygml", "old.zip", zipped(city__gml=old, readme__txt="two members"))

# ---- CityJSON ----

corners = [[0, 0, 0], [10, 0, 0], [10, 8, 0], [0, 8, 0], [0, 0, 6], [10, 0, 6], [10, 8, 6], [0, 8, 6]]
shell = [[[0, 3, 2, 1]], [[4, 5, 6, 7]], [[0, 1, 5, 4]], [[1, 2, 6, 5]], [[2, 3, 7, 6]], [[3, 0, 4, 7], [0, 1, 2]]]
solid = {"type": "Solid", "lod": "2.2", "boundaries": [shell, shell], "semantics": {
    "surfaces": [{"type": "GroundSurface"}, {"type": "RoofSurface"}, {"type": "WallSurface", "children": [3]},
                 {"type": "Window", "parent": 2}, {"type": "FloorSurface"}], "values": [[0, 1, 2, 3, None, 4], None]}}
surfaces = lambda lod: {"type": "MultiSurface", "lod": lod, "boundaries": shell[:2]}
instance = {"type": "GeometryInstance", "template": 0, "boundaries": [2],
            "transformationMatrix": [2, 0, 0, 1, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1]}
city_objects = {
    "house": {"type": "Building", "children": ["part", "dormer"],
              "geometry": [surfaces("0.2"), surfaces("1.3"), solid]},
    "part": {"type": "BuildingPart", "parents": ["house"], "geometry": [
        {"type": "MultiSolid", "lod": "2", "boundaries": [[shell]]}]},
    "dormer": {"type": "BuildingInstallation", "parents": ["house"], "geometry": [surfaces("2")]},
    "room": {"type": "BuildingRoom", "parents": ["house"], "geometry": [surfaces("2")]},
    "tree": {"type": "SolitaryVegetationObject", "geometry": [instance]},
    "tin": {"type": "TINRelief", "geometry": [{"type": "CompositeSurface", "lod": "1",
                                               "boundaries": [[[0, 1, 2]], [[0, 2, 3]]]}]},
    "lamp": {"type": "CityFurniture", "attributes": {"function": "1150", "watt": 30, "name": ["a", "b"]},
             "geometry": [{"type": "MultiPoint", "lod": "0", "boundaries": [1]}]},
    "road": {"type": "Road", "attributes": {"class": "1040"}, "geometry": [dict(surfaces("2"), semantics={
        "surfaces": [{"type": "TrafficArea", "function": "footpath"}], "values": [0, 0]})]},
    "+thing": {"type": "+Thing", "geometry": [surfaces("2")]},
    "group": {"type": "CityObjectGroup", "children": ["house", "road"]}}
city_head = {"type": "CityJSON", "version": "2.0", "transform": {"scale": [0.5, 0.5, 0.5],
                                                                 "translate": [690000, 5330000, 500]},
             "metadata": {"referenceSystem": "https://www.opengis.net/def/crs/EPSG/0/25832"},
             "geometry-templates": {"templates": [surfaces("2")], "vertices-templates": corners}}
put("cityjson", "whole.json", json.dumps(dict(city_head, CityObjects=city_objects, vertices=corners)))
put("cityjson", "old.json", json.dumps({"type": "CityJSON", "version": "1.0", "vertices": corners, "CityObjects": {
    "b": {"type": "Building", "geometry": [dict(surfaces(1), lod=1)]}}}, indent=1))
put("cityjson", "lines.jsonl", "".join(json.dumps(v) + "\n" for v in [dict(city_head, CityObjects={}, vertices=[])] + [
    {"type": "CityJSONFeature", "id": i, "CityObjects": {i: dict(city_objects["house"], children=[])},
     "vertices": corners} for i in ["a", "b"]]))
appearance = {"default-theme-texture": "t", "vertices-texture": [[0, 0], [1, 0], [1, 1], [0, 1]],
              "materials": [{"name": "brick", "diffuseColor": [0.5, 0.2, 0.1], "specularColor": [1, 1, 1],
                             "emissiveColor": [1, 0, 0], "shininess": 0.5, "transparency": 0.1}, {"name": "plain"}],
              "textures": [{"type": "PNG", "image": "side.png", "wrapMode": "mirror"},
                           {"type": "JPG", "image": "other.jpg"}]}
drawn = dict(surfaces("2"), material={"m": {"values": [0, None]}, "n": {"value": 1}},
             texture={"s": {"values": [[[1, 0, 1, 2, 3]], [[None]]]}, "t": {"values": [[[0, 0, 1, 2, 3]], None]}})
looks_head = dict(city_head, appearance=appearance)
looks_head["geometry-templates"] = {"templates": [drawn], "vertices-templates": corners}
drawn_objects = {"house": {"type": "Building", "geometry": [drawn, dict(
    solid, material={"m": {"values": [[0, 1, 1, None, 0, 1], None]}},
    texture={"t": {"values": [[[[0, 0, 1, 2, 3]], None, [[1, 3, 2, 1, 0]], None, None, [[0, 0, 1, 2, 3], [0, 0, 1, 2]]],
                              None]}})]},
                 "tree": city_objects["tree"]}
put("cityjson", "looks.json", json.dumps(dict(looks_head, CityObjects=drawn_objects, vertices=corners)))
put("cityjson", "looks.jsonl", "".join(json.dumps(v) + "\n" for v in [
    dict(looks_head, CityObjects={}, vertices=[])] + [
    dict({"type": "CityJSONFeature", "id": i, "CityObjects": {i: drawn_objects["house"]}, "vertices": corners}, **own)
    for i, own in [("a", {}), ("b", {"appearance": dict(appearance, textures=[])})]]))
