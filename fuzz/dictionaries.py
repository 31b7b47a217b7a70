#!/usr/bin/env python3
"""dictionaries.py FOLDER: libFuzzer's dictionaries, of the words that the readers themselves look for, and of formats'
own."""
import glob, os, re, sys

root = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "src")
# name: sources whose words it takes, words besides them
dictionaries = {
    "citygml": (["import/citygml/*.[ch]"], ["gml:id=\"", "xlink:href=\"#", "srsDimension=\"2\"", "<!--", "<![CDATA[",
                                            "&amp;", "&#x10FFFF;", "<!DOCTYPE a [<!ENTITY b \"c\">]>",
                                          "encoding=\"UTF-16\"", "encoding=\"ISO-8859-1\"", "lod0", "lod1", "lod2",
                                          "lod3", "lod4"]),
    "cityjson": (["import/cityjson/*.c", "import/citygml/names.c"],
                 ["attributes", "metadata", "\x1e", "MultiPoint", "EPSG:7415", "1.0", "1.1", "2.0", "2.2"]),
    "gltf": (["import/mesh/gltf*.[ch]"], ["5120", "5121", "5122", "5123", "5125", "5126", "VEC2", "VEC4", "MAT4",
                                          "data:application/octet-stream;base64,", "%2e%2e/",
                                          "KHR_draco_mesh_compression"]),
    "obj": (["import/mesh/obj*.c"], ["mtllib ", "usemtl ", "newmtl ", "f ", "v ", "vn ", "vt ", "//", "\\\n", "Ke ",
                                     "Kd ", "map_Ke ", "Tr ", "curv ", "surf ", "end", "#", "s off", "-1"]),
    "lamps": (["import/lamps/*.c", "import/map/overpass.c", "import/map/vector.c"],
              ["street_lamp", "highway", "FeatureCollection", "coordinates", "\x1e", "POINT (", "POINT Z (",
               "EPSG:25832", "<osm>", "<node ", "<nd ref=", "<tag k=", "OSMData", "OSMHeader",
               "SELECT ", "CREATE VIEW ", "CREATE VIRTUAL TABLE [", "USING rtree", "all_tags", "other_tags", "\"=>\"",
               "\"crs\"", "urn:ogc:def:crs:OGC:1.3:CRS84"]),
    "tracks": (["import/tracks/*.c", "import/lamps/keys.c"],
               ["<gpx ", "<trk>", "<trkseg>", "<trkpt ", "<rtept ", "<wpt ", "lat=\"", "lon=\"", "<time>", "<name>",
                "2026-11-22T22:00:00Z", "+01:00", "end=\"true\"", "LineString", "MultiLineString",
                "<tag k=\"highway\" ", "xmlns:g=\"", "<g:",
                "<!DOCTYPE a [<!ENTITY b \"c\">]>", "&amp;", "nan", "1e308"]),
    "crs": (["geo/crs*.c"], ["urn:ogc:def:crs:", "EPSG::", "urn:adv:crs:", "http://www.opengis.net/def/crs/EPSG/0/",
                             "+proj=", "+zone=32", "+init=epsg:", "+nadgrids=", "+towgs84=", "+type=crs",
                             "PROJCS[", "GEOGCS[", "COMPD_CS[", "BOUNDCRS[", "UNIT[\"metre\",1]", "PARAMETER[",
                             "AUTHORITY[\"EPSG\",\"4326\"]", "AXIS[\"N\",NORTH]", "utm", "longlat", "webmerc"]),
    "profile": (["photometry/*.c"], ["TILT=", "TILT=INCLUDE\n", "TILT=NONE\n", "[LUMINAIRE]", "-1", "0 90 180\n",
                                     "1 -1 1 ", "0 90\n", "90 270\n"]),
    "spec": (["lab/*.c", "render/options.c"],
             ["builtin:city", "builtin:mess", "../", "16x9", "street", "aerial", "overview"]),
    "recipe": (["recipe/*.c", "render/options.c", "scene/material.c"],
               ["nocturne: 1\n", "inputs: [", "cameras:\n  ", "materials:\n  ", ": {", "}, ", "---\n", "&a ", "*a",
                "<<: ", "!!", "|\n", ">\n", "? ", "%YAML 1.1\n", "builtin:mess", "../"]),
    "viewer": (["viewer/wire.c"], ["\"t\":\"", "\":[", "null", "true", "1e999", "-0", "\\ud800", "\\u0000", "[[0,0],"]),
}


def quoted(word):
    return '"' + "".join(c if 32 <= ord(c) < 127 and c not in '"\\' else "".join("\\x%02x" % b for b in c.encode())
                         for c in word) + '"'


os.makedirs(sys.argv[1], exist_ok=True)
for name, (sources, more) in dictionaries.items():
    words = set(more)
    for path in (p for s in sources for p in glob.glob(os.path.join(root, s))):
        words |= {w for w in re.findall(r'"([^"\\%\s]{2,32})"', open(path, encoding="utf-8").read())
                  if not w.endswith(".h")}
    with open(os.path.join(sys.argv[1], name + ".dict"), "w") as f:
        f.write("".join(quoted(w) + "\n" for w in sorted(words)))
