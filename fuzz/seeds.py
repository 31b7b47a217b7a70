#!/usr/bin/env python3
"""seeds.py FOLDER RECORD HELPER: small inputs of every format, made here, a folder a corpus. Fuzzers start from them,
and tests replay them. RECORD (record.c) notes what the library and the helper that reads maps and OBJ say of them."""
import base64, ctypes, ctypes.util, gzip, io, json, os, sqlite3, struct, subprocess, sys, tempfile, zipfile, zlib

sys.dont_write_bytecode = True
from seedbox import parts, put, root, zipped
from seeds_cities import degrees, old, whole
import seeds_pictures

here = os.path.dirname(os.path.abspath(__file__))

# ---- meshes ----

obj = """mtllib side.mtl
o house
v 0 0 0\nv 10 0 0\nv 10 0 8\nv 0 0 8\nv 0 6 0\nv 10 6 0\nv 10 6 8\nv 0 6 8
vt 0 0\nvt 1 0\nvn 0 1 0
usemtl wall\ng walls\nf 1 2 6 5\nf 2/1/1 3/2/1 7/1/1 6/2/1\nf -8//1 -4//1 -1//1
usemtl lamp\ns off\nf 5 6 7 8
l 1 2 3\np 4
"""
mtl = "newmtl wall\nKd 0.5 0.4 0.3\nillum 2\nnewmtl lamp\nKd 0 0 0\nKe 20 18 15\nNs 10\nd 1\nmap_Kd none.png\n"
put("obj", "house", parts(obj, mtl))
put("obj", "bare", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
put("obj", "continued", parts("v 0 0 0 \\\n\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0.5 2 0\nf 1 2 \\\n3 4 5\nusemtl none\n"
                              "f 1 2 99\n", "newmtl a\n"))

put("obj", "textured", parts("mtllib side.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv .5 2 0\n"
                             "vt 0 0\nvt 1 .5 0\n vt 0.5\n"
                             "vt x\nvt 1 \\\n 1\nusemtl a\nf 1/1 2/2 3/3 4/4\n"
                             "f -1/-1 -2/-2/1 -3/-3 -4/-4 -5/-5\n"
                             "f 1/1 2/9 3/3\nf 1 2/2 3\nusemtl b\nf 1 2 3\n",
                             "newmtl a\nKd .5 .5 .5\nmap_Kd -s 2 2 -o .5 .5 0 -clamp on -mm 0 1 \"a b.png\"\n"
                             "newmtl b\nmap_Kd -x.png\nmap_Kd -o 1\nmap_Ks c.png\n"))
put("obj", "libraries", parts("mtllib side.mtl side.mtl\nmtllib a\\\\side.mtl\nmtllib \"side.mtl\"\nv 0 0 0\nv 1 0 0\n"
                              "v 1 1 0\nusemtl wall\nf -3 -2 -1\n", mtl))

positions = struct.pack("<12f", 0, 0, 0, 4, 0, 0, 4, 3, 0, 0, 3, 0) + struct.pack("<6H", 0, 1, 2, 0, 2, 3)


def gltf(buffer):
    return {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1, 2]}],
        "nodes": [{"mesh": 0, "translation": [1, 2, 3], "children": [3]},
                  {"extensions": {"KHR_lights_punctual": {"light": 0}}, "rotation": [0, 0.7071068, 0, 0.7071068]},
                  {"camera": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 9, 1]},
                  {"mesh": 0, "scale": [2, 2, 2], "extensions": {"KHR_lights_punctual": {"light": 1}}}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1, "aspectRatio": 1.5}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0, "mode": 4}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.5, 0.5, 1], "roughnessFactor": 0.7,
                                                "metallicFactor": 0},
                       "emissiveFactor": [1, 0.9, 0.7], "doubleSided": True,
                       "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 20}}}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0],
                       "max": [4, 3, 0],
                       "sparse": {"count": 1, "indices": {"bufferView": 1, "componentType": 5123},
                                  "values": {"bufferView": 0}}},
                      {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 48},
                        {"buffer": 0, "byteOffset": 48, "byteLength": 12}],
        "buffers": [buffer],
        "extensionsUsed": ["KHR_lights_punctual", "KHR_materials_emissive_strength"],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 500, "color": [1, 0.8, 0.6],
                                                           "range": 20},
                                                          {"type": "spot", "intensity": 900,
                                                           "spot": {"innerConeAngle": 0.3, "outerConeAngle": 0.8}}]}},
    }


embedded = json.dumps(gltf({"byteLength": 60, "uri": "data:application/octet-stream;base64," +
                            base64.b64encode(positions).decode()}))
text = json.dumps(gltf({"byteLength": 60})).encode()
text += b" " * (-len(text) % 4)
glb = (struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(positions)) + struct.pack("<I4s", len(text), b"JSON") +
       text +
       struct.pack("<I4s", len(positions), b"BIN\0") + positions)
put("gltf", "embedded.gltf", embedded)
put("gltf", "binary.glb", glb)
strip = gltf({"byteLength": 60, "uri": "side.bin"})
del strip["accessors"][0]["sparse"]
strip["meshes"][0]["primitives"] = [{"attributes": {"POSITION": 0}, "mode": 5},
                                    {"attributes": {"POSITION": 0}, "indices": 1, "mode": 6}]
strip["bufferViews"][0]["byteStride"] = 12
put("gltf", "strip", parts(json.dumps(strip), positions))
picture = seeds_pictures.rgb
drawn = gltf({"byteLength": 60, "uri": "data:application/octet-stream;base64," + base64.b64encode(positions).decode()})
drawn["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = 2
drawn["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {
    "index": 0, "extensions": {"KHR_texture_transform": {"offset": [0.5, 0], "rotation": 1, "scale": [2, 3]}}}
drawn["accessors"].append({"bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC2"})
drawn["bufferViews"] += [{"buffer": 0, "byteLength": 32}, {"buffer": 1, "byteLength": len(picture)}]
drawn["buffers"].append({"byteLength": len(picture), "uri": "data:image/png;base64," +
                         base64.b64encode(picture).decode()})
drawn["textures"] = [{"source": 0, "sampler": 0}]
drawn["samplers"] = [{"wrapS": 33648, "wrapT": 10497}]
drawn["images"] = [{"bufferView": 3, "mimeType": "image/png"}]
put("gltf", "image.gltf", json.dumps(drawn))
drawn["images"] = [{"uri": "data:image/png;base64," + base64.b64encode(picture).decode()}]
put("gltf", "image-uri.gltf", json.dumps(drawn))
put("gltf", "beside", parts(json.dumps(gltf({"byteLength": 60, "uri": "side.bin"})), positions))

# ---- PLY ----

ply = ("ply\nformat %s 1.0\ncomment made here\nelement vertex 5\nproperty %s x\nproperty %s y\nproperty %s z\n"
       "property uchar red\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n")
ply_points = [(0, 0, 0), (10, 0, 0), (10, 8, 0), (0, 8, 0), (5, 4, 6)]
put("ply", "text.ply", ply % (("ascii",) + ("double",) * 3) + "".join("%g %g %g 255\n" % p for p in ply_points) +
    "4 0 1 2 3\n3 0 1 4\n")
for order, name in (("<", "little"), (">", "big")):
    put("ply", name + ".ply", (ply % (("binary_%s_endian" % name,) + ("float",) * 3)).encode() +
        b"".join(struct.pack(order + "fffB", *p, 7) for p in ply_points) + struct.pack(order + "B4i", 4, 0, 1, 2, 3) +
        struct.pack(order + "B3i", 3, 0, 1, 4))

# ---- terrain: little-endian TIFFs of one strip, by hand ----

def tiff(width, height, values, code, bits, sample, extra=()):
    data = b"".join(struct.pack("<" + code, v) for v in values)
    entries = [(256, 3, 1, width), (257, 3, 1, height), (258, 3, 1, bits), (259, 3, 1, 1), (262, 3, 1, 1),
               (277, 3, 1, 1), (278, 3, 1, height), (279, 4, 1, len(data)), (339, 3, 1, sample)]
    arrays = [(33550, "d", (2, 2, 0)), (33922, "d", (0, 0, 0, 690000, 5330000, 0)),
              (34735, "H", (1, 1, 0, 2, 1024, 0, 1, 1, 3072, 0, 1, 25832))] + list(extra)
    count = len(entries) + len(arrays) + 1
    at = 8 + 2 + 12 * count + 4
    body = b""
    for tag, kind, numbers in arrays:
        packed = numbers if kind == "s" else struct.pack("<%d%s" % (len(numbers), kind), *numbers)
        entries.append((tag, {"d": 12, "H": 3, "s": 2}[kind], len(numbers), at + len(body)))
        body += packed + b"\0" * (len(packed) % 2)
    entries.append((273, 4, 1, at + len(body)))
    rows = b"".join(struct.pack("<HHI", t, k, n) + (struct.pack("<HH", v, 0) if k == 3 and n == 1 else
                                                    struct.pack("<I", v)) for t, k, n, v in sorted(entries))
    return b"II*\0" + struct.pack("<IH", 8, count) + rows + struct.pack("<I", 0) + body + data


put("terrain", "floats.tif", tiff(9, 7, [500 + (i % 9) * (i // 9) / 3 for i in range(63)], "f", 32, 3,
                                  [(42113, "s", b"-9999\0")]))
put("terrain", "whole.tif", tiff(5, 5, [i * 7 % 13 if i != 12 else -9999 for i in range(25)], "h", 16, 2))

# ---- lamps ----

csv = ("id,lon,lat,height,lumens,watt,lamp_type,colour,direction\n1,11.5,48.1,8,5000,50,LED,3000K,90\n"
       "2,11.501,48.1002,\"6,5\",,70,SON,#ffaa00,W\n3,x,48,,,,,,\n")
put("csv", "comma.csv", csv)
put("csv", "semicolon.csv", "\ufeffLeuchtennummer;Rechtswert;Hochwert;Lichtpunkth\u00f6he;Leuchtmittel\n"
                            "A;4468000,5;5333000,25;8,5;NAV 70 W\nB;4468010;5333010;;LED\n")
put("csv", "wkt.csv", "lamp_type\tWKT\tmounting_height (ft)\nLED\tPOINT (11.5 48.1)\t24\n"
                      "SON\tMULTIPOINT ((11.5 48.1))\t\n")
tags = {"highway": "street_lamp", "height": "8 m", "light:count": "2", "lamp_type": "led", "light:lumens": "5000",
        "lamp_mount": "bent_mast",
        "light:direction": "NE", "light:colour": "white", "light:colour_temperature": "3000 K", "ref": "12"}
put("overpass", "nodes.json",
    json.dumps({"version": 0.6, "generator": "Overpass API", "osm3s": {"timestamp_osm_base": "2020-01-01T00:00:00Z"},
                "elements": [
    {"type": "node", "id": 1, "lat": 48.1, "lon": 11.5, "tags": tags},
    {"type": "way", "id": 2, "center": {"lat": 48.1, "lon": 11.501}, "tags": tags},
    {"type": "relation", "id": 3, "bounds": {"minlat": 48, "minlon": 11, "maxlat": 48.2, "maxlon": 11.1},
     "tags": {"highway": "street_lamp"}}], "remark": "timed out"}))
street = {"highway": "primary_link", "lanes": "3", "lanes:forward": "2", "oneway": "-1", "maxspeed": "30 mph",
          "width": "8,5 m", "lit": "yes", "name": "Main Street", "bridge": "yes", "layer": "1", "access": "private"}
put("overpass", "roads.json", json.dumps({"version": 0.6, "elements": [
    {"type": "node", "id": 1, "lat": 48.1, "lon": 11.5}, {"type": "node", "id": 2, "lat": 48.101, "lon": 11.5},
    {"type": "way", "id": 3, "nodes": [1, 2, 9], "tags": street},
    {"type": "way", "id": 4, "geometry": [{"lat": 48.1, "lon": 11.5}, None, {"lat": 48.1, "lon": 11.502}],
     "tags": {"railway": "tram", "tunnel": "yes"}}]}))
corner = lambda x, y: {"lat": 48.1 + y / 1000, "lon": 11.5 + x / 1000}
put("overpass", "areas.json", json.dumps({"version": 0.6, "elements": [
    {"type": "node", "id": 1, **corner(0, 0)}, {"type": "node", "id": 2, **corner(1, 0)},
    {"type": "node", "id": 3, **corner(1, 1)}, {"type": "way", "id": 4, "nodes": [1, 2, 3]},
    {"type": "way", "id": 5, "nodes": [1, 2, 3, 1], "tags": {"building": "yes", "building:levels": "3"}},
    {"type": "relation", "id": 6, "members": [
        {"type": "way", "ref": 4, "role": "outer"},
        {"type": "way", "ref": 7, "role": "outer", "geometry": [corner(1, 1), corner(0, 0)]},
        {"type": "way", "ref": 8, "role": "inner", "geometry": [corner(.5, .2), corner(.6, .2), corner(.6, .3),
                                                                 corner(.5, .2)]}],
     "tags": {"type": "multipolygon", "natural": "water"}}]}))
point = lambda x, y, **p: {"type": "Feature", "id": 7, "properties": p,
                           "geometry": {"type": "Point", "coordinates": [x, y]}}
features = {"type": "FeatureCollection", "name": "lamps",
            "crs": {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::25832"}},
            "features": [point(690100, 5330100, **tags),
                         point(690120, 5330100, highway="street_lamp", height=7, watt=70.5, other=None, list=[1, 2]),
                         {"type": "Feature", "properties": {"man_made": "street_lamp"},
                          "geometry": {"type": "MultiPoint", "coordinates": [[1, 2, 3], [4, 5]]}},
                         {"type": "Feature", "properties": {"highway": "residential"},
                          "geometry": {"type": "LineString", "coordinates": [[1, 2], [4, 5]]}},
                         {"type": "Feature", "properties": None,
                          "geometry": {"type": "GeometryCollection",
                                       "geometries": [{"type": "Polygon",
                                                       "coordinates": [[[0, 0], [1, 0], [1, 1], [0, 0]]]}]}}]}
put("geojson", "collection.json", json.dumps(features))
put("geojson", "buildings.json", json.dumps({"type": "FeatureCollection", "name": "buildings", "features": [
    {"type": "Feature", "properties": {"building": "yes", "height": "12 m", "min_height": 3, "roof:height": 2},
     "geometry": {"type": "MultiPolygon", "coordinates": [[[[11.5, 48.1], [11.501, 48.1], [11.501, 48.101],
                                                            [11.5, 48.1]],
                                                           [[11.5005, 48.1002], [11.5007, 48.1002], [11.5007, 48.1004],
                                                            [11.5005, 48.1002]]]]}},
    {"type": "Feature", "properties": {"building:levels": "3", "building": "house"},
     "geometry": {"type": "Polygon", "coordinates": [[[11.5, 48.2], [11.501, 48.2], [11.501, 48.201],
                                                      [11.5, 48.2]]]}}]}))
put("geojson", "roads.json", json.dumps({"type": "FeatureCollection", "features": [
    {"type": "Feature", "properties": dict(street, **{"@id": "way/3"}),
     "geometry": {"type": "LineString", "coordinates": [[11.5, 48.1], [11.5, 48.101]]}},
    {"type": "Feature", "properties": {"railway": "rail"},
     "geometry": {"type": "MultiLineString", "coordinates": [[[11.5, 48.1], [11.502, 48.1]], [[11.5, 48.1]]]}},
    {"type": "Feature", "properties": {"natural": "water"},
     "geometry": {"type": "Polygon", "coordinates": [[[11.5, 48.1003], [11.501, 48.1003], [11.501, 48.1006],
                                                      [11.5, 48.1003]]]}}]}))
put("geojson", "plain.json",
    json.dumps({"type": "FeatureCollection", "features": [point(11.5, 48.1, highway="street_lamp")]}))
hstore = ",".join('"%s"=>"%s"' % (key, value.replace("8 m", 'a \\"quote\\" and \\\\')) for key, value in tags.items())
put("geojson", "hstore.json",
    json.dumps({"type": "FeatureCollection",
                "features": [point(11.5, 48.1, osm_id="7", highway="street_lamp", other_tags=hstore)]}))
put("geojson", "lines.json", "\x1e" + json.dumps(point(11.5, 48.1, highway="street_lamp")) + "\n\x1e" +
    json.dumps(point(11.6, 48.1, **tags)) + "\n")
osm = ('<?xml version="1.0" encoding="UTF-8"?>\n'
       '<osm version="0.6" generator="x"><bounds minlat="48" minlon="11" maxlat="49" maxlon="12"/>\n'
       '<node id="1" lat="48.1" lon="11.5" version="1">%s</node><node id="2" lat="48.1001" lon="11.5"/>'
       '<node id="3" lat="48.1" lon="11.5002"/>\n'
       '<way id="4"><nd ref="1"/><nd ref="2"/><nd ref="3"/><nd ref="1"/><tag k="building" v="yes"/></way>\n'
       '<relation id="5"><member type="way" ref="4" role="outer"/><tag k="type" v="multipolygon"/>'
       '<tag k="highway" v="street_lamp"/></relation></osm>\n'
       % "".join('<tag k="%s" v="%s"/>' % t for t in tags.items()))
put("osm", "lamps.osm", osm)
put("osm", "roads.osm", '<osm version="0.6"><node id="1" lat="48.1" lon="11.5"/><node id="2" lat="48.101" lon="11.5"/>'
    '<way id="3"><nd ref="1"/><nd ref="2"/>%s</way></osm>'
    % "".join('<tag k="%s" v="%s"/>' % t for t in street.items()))


def varint(n):
    n &= (1 << 64) - 1
    out = b""
    while n > 127:
        out += bytes([n & 127 | 128])
        n >>= 7
    return out + bytes([n])


zigzag = lambda n: varint(n << 1 ^ n >> 63)
field = lambda number, data: varint(number << 3 | 2) + varint(len(data)) + data
number = lambda n, value: varint(n << 3) + varint(value)


def blob(kind, data, packed=True):
    body = number(2, len(data)) + field(3, zlib.compress(data)) if packed else field(1, data)
    header = field(1, kind) + number(3, len(body))
    return struct.pack(">I", len(header)) + header + body


def deltas(values):
    out, last = b"", 0
    for v in values:
        out += zigzag(v - last)
        last = v
    return out


words = [b"", b"highway", b"street_lamp", b"height", b"8", b"building", b"yes", b"type", b"multipolygon", b"outer"]
dense = (field(1, deltas([1, 2, 3])) + field(8, deltas([481000000, 481001000, 481000000])) +
         field(9, deltas([115000000, 115000000, 115002000])) +
         field(10, b"".join(map(varint, [1, 2, 3, 4, 0, 1, 2, 0, 0]))))
way = number(1, 4) + field(2, varint(5)) + field(3, varint(6)) + field(8, deltas([1, 2, 3, 1]))
relation = (number(1, 5) + field(2, varint(7)) + field(3, varint(8)) + field(8, varint(9)) + field(9, deltas([4])) +
            field(10, varint(1)))
node = (number(1, 9 << 1) + field(2, varint(1)) + field(3, varint(2)) + number(8, 481000000 << 1) +
        number(9, 115000000 << 1))
group = lambda n, data: field(2, field(n, data))
block = (field(1, b"".join(field(1, w) for w in words)) + group(2, dense) + group(1, node) + group(3, way) +
         group(4, relation) + number(17, 100))
head = (field(1, number(1, 11 * 10**9 << 1) + number(2, 12 * 10**9 << 1)) + field(4, b"OsmSchema-V0.6") +
        field(4, b"DenseNodes") + field(16, b"x"))
put("pbf", "lamps.pbf", blob(b"OSMHeader", head) + blob(b"OSMData", block))
put("pbf", "raw.pbf", blob(b"OSMHeader", head, False) + blob(b"OSMData", block, False))


def geopackage(more=""):
    path = tempfile.mktemp(suffix=".gpkg")
    db = sqlite3.connect(path)
    wkb = lambda x, y: b"GP\0\1" + struct.pack("<i", 4326) + struct.pack("<BIdd", 1, 1, x, y)
    db.executescript("""PRAGMA page_size = 512; PRAGMA application_id = 0x47504B47; PRAGMA user_version = 10200;
        CREATE TABLE gpkg_spatial_ref_sys (srs_name TEXT NOT NULL, srs_id INTEGER PRIMARY KEY,
            organization TEXT NOT NULL, organization_coordsys_id INTEGER NOT NULL, definition TEXT NOT NULL,
            description TEXT);
        INSERT INTO gpkg_spatial_ref_sys VALUES ('WGS 84', 4326, 'EPSG', 4326,
            'GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],' ||
            'PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]]', '');
        CREATE TABLE gpkg_contents (table_name TEXT PRIMARY KEY, data_type TEXT NOT NULL, identifier TEXT,
            description TEXT, last_change DATETIME, min_x DOUBLE, min_y DOUBLE, max_x DOUBLE, max_y DOUBLE,
            srs_id INTEGER);
        INSERT INTO gpkg_contents VALUES ('lamps', 'features', 'lamps', '', '2020-01-01T00:00:00.000Z', 11, 48, 12, 49,
            4326);
        CREATE TABLE gpkg_geometry_columns (table_name TEXT NOT NULL, column_name TEXT NOT NULL,
            geometry_type_name TEXT NOT NULL, srs_id INTEGER NOT NULL, z TINYINT NOT NULL, m TINYINT NOT NULL);
        INSERT INTO gpkg_geometry_columns VALUES ('lamps', 'geom', 'POINT', 4326, 0, 0);
        CREATE TABLE lamps (fid INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, geom POINT, highway TEXT, height REAL,
            watt INTEGER);""")
    db.executemany("INSERT INTO lamps (geom, highway, height, watt) VALUES (?, 'street_lamp', ?, ?)",
                   [(wkb(11.5, 48.1), 8.5, 70), (wkb(11.501, 48.1), None, 50)])
    db.commit()
    db.executescript(more)
    db.commit()
    db.close()
    with open(path, "rb") as f:
        data = f.read()
    os.unlink(path)
    return data


put("gpkg", "lamps.gpkg", geopackage())
put("gpkg", "index.gpkg", geopackage("""CREATE VIRTUAL TABLE "rtree_lamps_geom" USING rtree(id, x0, x1);
    CREATE VIRTUAL TABLE [b] USING rtree_i32(id, x0, x1);"""))


def shapefile():
    places = [(11.5, 48.1), (11.501, 48.1)]
    records, index = b"", b""
    for i, (x, y) in enumerate(places):
        index += struct.pack(">ii", 50 + len(records) // 2, 10)
        records += struct.pack(">ii", i + 1, 10) + struct.pack("<idd", 1, x, y)
    head = lambda size: (struct.pack(">7i", 9994, 0, 0, 0, 0, 0, (100 + size) // 2) +
                         struct.pack("<ii4d4d", 1000, 1, 11.5, 48.1, 11.501, 48.1, 0, 0, 0, 0))
    columns = [(b"highway", b"C", 12, 0), (b"height", b"N", 8, 2), (b"watt", b"N", 5, 0)]
    dbf = struct.pack("<BBBBIHH20x", 3, 120, 1, 1, len(places), 33 + 32 * len(columns), 1 + sum(c[2] for c in columns))
    dbf += b"".join(struct.pack("<11sc4xBB14x", *c) for c in columns) + b"\r"
    dbf += b" street_lamp     8.50   70" + b" street_lamp     6.00   50" + b"\x1a"
    prj = ('GEOGCS["GCS_WGS_1984",DATUM["D_WGS_1984",SPHEROID["WGS_1984",6378137.0,298.257223563]],'
           'PRIMEM["Greenwich",0.0],UNIT["Degree",0.0174532925199433]]')
    return head(len(records)) + records, head(len(index)) + index, dbf, prj


shp, shx, dbf, prj = shapefile()
put("shp", "lamps.zip", zipped(lamps__shp=shp, lamps__shx=shx, lamps__dbf=dbf, lamps__prj=prj, lamps__cpg="UTF-8"))
put("shp", "alone.shp", shp)



def flatgeobuf(source):
    """By GDAL's library: the format is not one to write by hand. b"" without it."""
    library = ctypes.util.find_library("gdal")
    if not library:
        return b""
    gdal = ctypes.CDLL(library)
    gdal.GDALOpenEx.restype = gdal.GDALVectorTranslate.restype = ctypes.c_void_p
    gdal.GDALVectorTranslateOptionsNew.restype = ctypes.c_void_p
    gdal.GDALAllRegister()
    with tempfile.TemporaryDirectory() as folder:
        paths = [os.path.join(folder, name).encode() for name in ("a.json", "a.fgb")]
        with open(paths[0], "w") as f:
            f.write(source)
        options = gdal.GDALVectorTranslateOptionsNew((ctypes.c_char_p * 3)(b"-f", b"FlatGeobuf", None), None)
        opened = ctypes.c_void_p(gdal.GDALOpenEx(paths[0], 4, None, None, None)) # 4: GDAL_OF_VECTOR
        made = gdal.GDALVectorTranslate(paths[1], None, 1, ctypes.byref(opened), ctypes.c_void_p(options),
                                        None) if opened else None
        if made:
            gdal.GDALClose(ctypes.c_void_p(made))
        return open(paths[1], "rb").read() if os.path.exists(paths[1]) else b""


put("fgb", "short.fgb", b"fgb\3fgb\0" + struct.pack("<I", 0))
put("fgb", "lamps.fgb", flatgeobuf(json.dumps({"type": "FeatureCollection", "features": [
    point(11.5, 48.1, highway="street_lamp", height=8.5), point(11.6, 48.1, highway="street_lamp")]})))

# ---- streams ----

put("stream", "plain", "abc" * 50)
put("stream", "one.gz", gzip.compress(b"abc" * 500, mtime=0))
put("stream", "two.gz", gzip.compress(b"abc" * 5, mtime=0) + gzip.compress(b"def", mtime=0) + b"tail")
put("stream", "members.zip", zipped(a__txt="text", model__gml="<gml/>" * 40, map__geojson="{}"))

# ---- coordinate systems ----

for i, spelling in enumerate([
        "EPSG:25832", "epsg:4326", "urn:ogc:def:crs:EPSG::25832",
        "urn:ogc:def:crs,crs:EPSG:6.12:31466,crs:EPSG:6.12:5783", "25832", "CH1903", "CRS84",
        "http://www.opengis.net/gml/srs/epsg.xml#31467", "http://www.opengis.net/def/crs/EPSG/0/3857",
        "urn:adv:crs:ETRS89_UTM32*DE_DHHN2016_NH", "urn:adv:crs:DE_DHDN_3GK4*DE_DHHN92_NH",
        "urn:ogc:def:crs:OGC:1.3:CRS84", "EPSG:7415", "EPSG:25832+5783", "ETRS89_UTM33",
        "+proj=utm +zone=32 +ellps=GRS80 +units=m +no_defs",
        "+proj=tmerc +lat_0=0 +lon_0=9 +k=1 +x_0=3500000 +y_0=0 +ellps=bessel +units=m",
        "+proj=longlat +datum=WGS84", "+proj=pipeline +step +proj=utm +zone=32", prj,
        'PROJCS["ETRS89 / UTM zone 32N",GEOGCS["ETRS89",DATUM["European_Terrestrial_Reference_System_1989",'
        'SPHEROID["GRS 1980",6378137,298.257222101]],'
        'PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],'
        'PARAMETER["latitude_of_origin",0],'
        'PARAMETER["central_meridian",9],PARAMETER["scale_factor",0.9996],PARAMETER["false_easting",500000],'
        'PARAMETER["false_northing",0],UNIT["metre",1]]']):
    put("crs", "%02d" % i, spelling)

# ---- luminaires ----


def ies(head, planes, gammas, kind=1, tilt="NONE", lamp="1 1000 1"):
    lines = [*head, "TILT=" + tilt, "%s %d %d %d 2 .1 .1 0" % (lamp, len(gammas), len(planes), kind), "1 1 20",
             " ".join("%g" % g for g in gammas), " ".join("%g" % c for c in planes)]
    lines += [" ".join("%g" % (100 + (c % 7) * (90 - abs(g))) for g in gammas) for c in planes]
    return "\r\n".join(lines) + "\r\n"


quarter = range(0, 91, 15)
put("ies", "1986.ies", ies(["A luminaire"], [0], quarter))
put("ies", "1991.ies", ies(["IESNA91", "[LUMINAIRE] one"], [0, 45, 90], quarter))
put("ies", "1995.ies", ies(["IESNA:LM-63-1995"], range(0, 181, 30), range(0, 181, 30), lamp="2 -1 1.5"))
put("ies", "2002.ies", ies(["IESNA:LM-63-2002", "[LAMP] x"], range(90, 271, 30), quarter))
put("ies", "2019.ies", ies(["IES:LM-63-2019"], range(0, 361, 45), [0, 45, 90, 180]))
put("ies", "tilt.ies", ies(["IESNA:LM-63-1995"], [0], quarter, tilt="INCLUDE\r\n1\r\n2\r\n0 90\r\n1 .9"))
put("ies", "a.ies", ies(["IESNA:LM-63-1995"], range(-90, 91, 30), range(-90, 91, 30), 3))
put("ies", "b.ies", ies(["IESNA:LM-63-1995"], range(0, 91, 30), range(-90, 91, 30), 2))


def ldt(isym, planes, stored, gammas, sets=1):
    lines = ["maker", "1", isym, planes, 360 / planes, len(gammas), 15, "report", "name", "no", "file", "date", 300,
             200, 100, 250, 150, 0, 0, 0, 0, 100, 80, 1, 0, sets]
    lines += [1, "LED", 1000, "3000", "80", 20] * sets + [.5] * 10
    lines += [360 / planes * i for i in range(planes)] + list(gammas)
    lines += [100 + (c % 5) * (90 - g) for c in range(stored) for g in gammas]
    return "\r\n".join(str(line) for line in lines) + "\r\n"


for isym, stored in enumerate([12, 1, 7, 7, 4]):
    put("ldt", "%d.ldt" % isym, ldt(isym, 12, stored, quarter, 1 + isym % 2))

# ---- specs ----

folder = os.path.join(here, "..", "experiments")
for name in sorted(os.listdir(folder)):
    if name.endswith(".json"):
        put("spec", name, open(os.path.join(folder, name), "rb").read())
put("spec", "small", json.dumps({
    "title": "t", "size": "16x9", "frames": 4, "repetitions": 2, "accumulate": "both", "seed": 3, "crop": "0,0,4,4",
    "equal-time": [1, 2], "measured": [1, 4], "shown": [1],
    "scene": {"name": "s", "inputs": ["builtin:city"], "city-size": 200}, "options": {"sky": 0},
    "reference": {"frames": 2, "rays": 16},
    "cameras": [{"name": "a", "view": "street"},
                {"name": "b", "view": "street",
                 "path": {"frames": 3, "dolly": [0, 1, 0], "pan": 10, "before": {"view": "aerial"}, "cut": 2}}],
    "configurations": [{"name": "x", "method": "ris", "draws": [4, 8]},
                       {"name": "y", "method": "restir", "bias": "mis", "seconds": 2}]}))

# ---- tracks ----

trkpt = '<trkpt lat="%s" lon="%s"><ele>500</ele><time>2026-11-22T22:00:%02dZ</time></trkpt>'
gpx = ('<?xml version="1.0"?><gpx version="1.1" xmlns="http://www.topografix.com/GPX/1/1"><wpt lat="1" lon="2"/><trk>'
       '<name>a</name><trkseg>%s</trkseg><trkseg>%s</trkseg></trk><rte><rtept lat="48" lon="11"/>'
       '<rtept lat="48.1" lon="11"/></rte></gpx>'
       % ("".join(trkpt % (48.1 + i / 1000, 11.5, i) for i in range(3)),
          "".join(trkpt % (48.1, 11.5 + i / 1000, i + 9) for i in range(2))))
put("tracks", "small.gpx", gpx)
put("tracks", "points.xml", '<points><point lat="48.1" lon="11.5" end="false"/>'
    '<point lat="48.2" lon="11.5" end="true"/>'
    '<p><latitude>48</latitude><longitude>11</longitude><end>false</end></p></points>')
put("tracks", "rows.csv", "track_id,time,lon,lat\na,1,11.5,48.1\nb,2026-11-22T22:00:00+01:00,11.6,48.1\n"
    "a,2,11.5,48.2\n")
put("tracks", "lines.json", json.dumps({"type": "FeatureCollection", "features": [
    {"type": "Feature", "properties": {"@id": "way/7"}, "geometry":
     {"type": "MultiLineString", "coordinates": [[[11.5, 48.1], [11.5, 48.2]], [[11, 48], [11, 48.1]]]}}]}))

put("tracks", "times.json", json.dumps({"type": "FeatureCollection", "features": [
    {"type": "Feature", "properties": {"coordTimes": [["2026-11-22T22:00:00Z", "2026-11-22T22:00:09Z"], [10, 20]]},
     "geometry": {"type": "MultiLineString", "coordinates": [[[11.5, 48.1], [11.5, 48.2]], [[11, 48], [11, 48.1]]]}},
    {"type": "Feature", "properties": {"times": [1, 2]}, "geometry":
     {"type": "LineString", "coordinates": [[11.5, 48.1], [11.5, 48.2]]}}]}))
put("tracks", "points.json", json.dumps({"type": "FeatureCollection", "features": [
    {"type": "Feature", "properties": {"track": "ab"[i % 2], "time": "2026-11-22T22:00:%02dZ" % i}, "geometry":
     {"type": "Point", "coordinates": [11.5, 48.1 + i / 1000]}} for i in range(4)]}))

# ---- recipes ----

put("recipe", "small", "nocturne: 1\ninputs: builtin:city\n")
put("recipe", "whole", """# remark
nocturne: 1
name: "A: b"
inputs: [a.gml, /b/c.osm, 'builtin:mess']
crs: EPSG:25832
preset: interactive
sky: 1e-2
lamps: { files: [l.csv], columns: 'height=H', height: 8.5 }
luminaires:
  - { match: { LAMP: [HPS*, 'S[a-o]?'], watts: '>= 70 W', 'tag:id': '1..2 ft' }, kelvin: 2050, tilt: 5 }
  - { profile: a/b.ies, arm: 2 }
  - { match: { street: '!Main *', x: absent }, shape: sphere, radius: .2, colour: '#ff8000', heads: 2, source: LED }
groups:
  main: { match: { file: '*.csv', class: window }, scale: 0.5, kelvin: 2200 }
  lamps: { on: off }
materials: { wall: { albedo: 0.5, roughness: 0.8 }, road: { albedo: [.1, .2, .3], f0: .05 } }
cameras:
  near: { eye: &e [1, -2.5, 3], target: '4,5,6', crs: scene, fov: 70 }
  far: { view: aerial }
paths:
  way: { loop: on, keys: [{ camera: near }, { eye: [1, 2, 3], target: [4, 5, 6], seconds: 2, hour: 23 }] }
  round: { keys: [{ eye: [1, 2, 3], target: [4, 5, 6] }, { eye: [9, 2, 3], target: [4, 5, 6], fov: 20 }] }
""")

# ---- several inputs, to a scene ----

lamps = json.dumps({"type": "FeatureCollection", "features": [point(11.5560, 48.1, highway="street_lamp")]})
put("pipeline", "city-lamps", parts(whole, json.dumps(features)))
put("pipeline", "city-csv", parts(old, csv))
put("pipeline", "mesh-lamps", parts(obj, "highway,x,y\nstreet_lamp,5,5\n"))
put("pipeline", "gltf", parts(embedded))
put("pipeline", "two-cities", parts(whole, degrees))
put("pipeline", "osm", parts(osm, whole))
put("pipeline", "zip", parts(gzip.compress(whole.encode(), mtime=0), zipped(lamps__geojson=lamps)))

# ---- messages to the viewer ----

camera = {"eye": [1, 2, 3], "target": [4, 5, 6], "fov": 50}
messages = {
    "begin": [{"t": "hello", "width": 1280, "height": 720}, {"t": "layout", "name": "methods"},
              {"t": "watch", "on": False}, {"t": "navigate", "mode": "walk", "speed": 2},
              {"t": "ack", "pane": 5, "n": 7}],
    "inputs": [{"t": "input", "n": n, "seconds": 0.02, "keys": keys, "turn": [0.1, -0.2], "pan": [0, 0], "zoom": -1,
                "at": [0.5, 0.25]} for n, keys in enumerate(([], ["forward", "fast"], ["forward", "fast"], ["up"]))],
    "go": [{"t": "camera", "name": "street", "n": 3}, {"t": "camera", **camera},
           {"t": "jump", "x": 0.5, "y": 0.5, "pane": 0, "n": 4}],
    "set": [{"t": "set", "pane": -1, "name": "method", "value": "restir"},
            {"t": "world", "name": "group.lamps", "value": "0.3,2200K"}],
    "ask": [{"t": "ask", "id": 1, "what": "pixel", "pane": 0, "x": 0.5, "y": 0.5}, {"t": "cancel", "id": 1},
            {"t": "ask", "id": 2, "what": "region", "rect": [0, 0, 1, 1]},
            {"t": "ask", "id": 3, "what": "region", "polygon": [[0, 0], [1, 0], [0, 1e3]]},
            {"t": "ask", "id": 4, "what": "region", "object": "DEBY_1"}, {"t": "ask", "id": 5, "what": "lights"},
            {"t": "ask", "id": 6, "what": "lamp", "light": 12},
            {"t": "ask", "id": 7, "what": "align", "aspect": 1.5,
             "pairs": [{"photo": [0, 1], "place": [1, 2, 3]}] * 4}],
    "save": [{"t": "save", "id": 1, "what": "png", "pane": 1}, {"t": "save", "id": 2, "what": "csv", "of": 3},
             {"t": "save", "id": 3, "what": "recipe", "cameras": [{"name": "square", **camera}]}],
    "wrong": [{"t": "hello", "width": 0, "height": 1e9}, {"t": "input"}, {"t": 3}, [], {"t": "set", "name": 1},
              {"t": "camera", "eye": [1, 2, 3], "target": [1, 2, 3], "fov": 50}, {"t": "ask", "id": -1, "what": "all"}],
}
for name, said in messages.items():
    put("viewer", name, "\n".join(map(json.dumps, said)))
put("viewer", "deep", '{"t":"hello","x":' + "[" * 3000 + "]" * 3000 + "}")
put("viewer", "text", b'{"t":"set","name":"\xff\xfe","value":"\\ud800"}\n'
                      b'{"t":"set","name":"a\\u0000b","value":"\xc3\xa4"}')

# ---- the library and its helper ----

for corpus in "wire", "request", "noct":
    os.makedirs(os.path.join(root, corpus), exist_ok=True)
foreign = [os.path.join(root, corpus, name) for corpus in ("obj", "osm", "pbf", "geojson", "gpkg", "fgb", "shp")
           for name in os.listdir(os.path.join(root, corpus))]
subprocess.run([sys.argv[2], sys.argv[3], root, *sorted(foreign)], check=True)
