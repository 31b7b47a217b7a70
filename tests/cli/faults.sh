#!/bin/sh
# Each opening, reading, writing, flushing and renaming of an input or output fails, in turn, in whichever process of
# the program it is, and of an input what is done to it from then on (fail_call.c). The program then ends with an error,
# leaves what stood in the output's place, and nothing else; or its output has the same numbers; or a warning names the
# file, or it is counted. Each format that is read or written has a row.
. "$(dirname "$0")/lib.sh"
here=$source_dir/tests/cli
fail_call=${NOC_FAIL_CALL:?names fail_call} seeds=${NOC_BUILD:?names the build folder}/fuzz/seeds
export ASAN_OPTIONS="${ASAN_OPTIONS:-}:detect_leaks=0" # which cannot be where a program is traced
mkdir in made
"$fail_call" "$work/in" 0 report /bin/true
if [ $? = 77 ]; then
    skip "each call fails once" "no call can be made to fail on this machine"
    finish
fi

# failing N ARGUMENT...: as run, and the N-th call on files of in/ fails
failing() {
    "$fail_call" "$work/in" "$@" >out 2>err </dev/null
    status=$?
}
# same OUTPUT: has it the bytes of the one that is whole, or its pixels?
same() {
    cmp -s "$1" "whole.${1##*.}" && return
    [ "${1##*.}" = exr ] && "$program" compare "$1" whole.exr | grep -Eq "$equal"
}
told() { sed -n 's/^  inputs *features skipped//p' out; } # what of the inputs was counted
equal='^  all pixels +[0-9]+ +0.000 +0 +0 '
# judge OUTPUT BEFORE: what is wrong after a call that failed
judge() {
    if [ $status = 0 ]; then
        warned="^nocturne: warning: .*$(head -n 1 report | sed 's|.*/||') cannot be read"
        grep -q "$warned" err || same "$1" || ! told | cmp -s - told || echo "another result, and no error"
    elif [ $status -gt 2 ] || ! grep -q '^nocturne: ' err; then
        echo "status $status without an error"
    elif [ "$(cat "$1")" != old ]; then
        echo "what was there is lost"
    elif [ "$(ls -A in made)" != "$2" ]; then
        echo "it leaves $(ls -A in made | tr '\n' ' ')"
    fi
}
# faults NAME OUTPUT ARGUMENT...
faults() {
    name=$1 output=$2 i=1 why=
    shift 2
    failing 0 report "$program" "$@"
    calls=$(tail -n 1 report)
    told >told
    cp "$output" "whole.${output##*.}" && [ $status = 0 ] && [ "$calls" -ge 2 ] || why="status $status, $calls calls"
    while [ -z "$why" ] && [ "$i" -le "$calls" ]; do
        echo old >"$output"
        before=$(ls -A in made)
        failing "$i$mode" report "$program" "$@"
        wrong=$(judge "$output" "$before")
        [ -z "$wrong" ] || why="$wrong: $i of $calls, $(head -n 1 report)"
        [ -n "${NOC_ALL_FAULTS:-}" ] && [ -n "$why" ] && echo "# $name: $why" && why=
        i=$((i + 1))
    done
    [ -z "$why" ]; result $? "$name: $calls calls" "$why"
}
# built NAME ARGUMENT...: a city of inputs that lie in in/. It lies elsewhere: how one is written has a row of its own
built() {
    name=$1
    shift
    faults "$name" made/x.noct build "$@" --threads 1 -o made/x.noct
}

cd "$work" || exit 1
cp "$here/city.gml" in
lamp_model && mv lamp.obj lamp.mtl in
python3 - "$seeds" <<'PY'
import base64, json, struct, sys, zipfile, zlib
# a checkered floor as a PNG, a glTF of a triangle that shines with its buffer beside it
def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
rows = b"".join(b"\0" + bytes(255 * ((x + y) & 1) for x in range(8) for _ in range(3)) for y in range(8))
open("in/floor.png", "wb").write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 8, 8, 8, 2, 0, 0, 0)) +
                                 chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))
text = open("in/lamp.mtl").read().replace("Kd .5 .5 .5", "Kd .5 .5 .5\nmap_Kd floor.png")
open("in/lamp.mtl", "w").write(text)
open("in/lit.bin", "wb").write(struct.pack("<9f", 0, 0, 0, 4, 0, 0, 0, 4, 0))
json.dump({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
           "materials": [{"emissiveFactor": [1, 1, 1]}],
           "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
           "buffers": [{"byteLength": 36, "uri": "lit.bin"}], "bufferViews": [{"buffer": 0, "byteLength": 36}],
           "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0],
                          "max": [4, 4, 0]}]}, open("in/lit.gltf", "w"))
open("in/sky.hdr", "wb").write(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 8\n" + b"\x80\x80\x80\x80" * 32)
open("in/lamps.csv", "w").write("lon,lat,lumens,height\n11.4215,48.7545,5000,6\n11.4217,48.7546,4000,6\n")
json.dump({"type": "FeatureCollection", "features": [
    {"type": "Feature", "properties": {"highway": "street_lamp", "height": "6"},
     "geometry": {"type": "Point", "coordinates": [11.4215, 48.7545]}}]}, open("in/lamps.geojson", "w"))
open("in/map.osm", "w").write("""<osm version="0.6"><node id="1" lat="48.7544" lon="11.4210"/>
<node id="2" lat="48.7546" lon="11.4220"/><way id="3"><nd ref="1"/><nd ref="2"/><tag k="highway" v="residential"/>
<tag k="lit" v="yes"/></way></osm>
""")
open("in/down.ies", "w").write("""IESNA:LM-63-2002
TILT=NONE
1 1000 1 3 1 1 2 0.1 0.1 0.1
1 1 10
0 45 90
0
300 200 0
""")
open("in/city.yaml", "w").write("nocturne: 1\ninputs: [city.gml, lamps.geojson]\nlamp-profile: down.ies\n")
# a street and a place of it, points of a luxmeter, and corners as a camera of 240 x 160 pixels at 8, -8, 6 sees them
open("street.osm", "w").write("""<osm version="0.6"><node id="1" lat="52.5" lon="13.4"/>
<node id="2" lat="52.5" lon="13.4002"/>
<node id="11" lat="52.50003" lon="13.4001"><tag k="highway" v="street_lamp"/></node>
<way id="21"><nd ref="1"/><nd ref="2"/><tag k="highway" v="residential"/><tag k="name" v="Well Lane"/></way></osm>
""")
corners = [[13.4, 52.49998], [13.4002, 52.49998], [13.4002, 52.50002], [13.4, 52.50002], [13.4, 52.49998]]
json.dump({"type": "Polygon", "coordinates": [corners]}, open("in/area.geojson", "w"))
open("in/points.txt", "w").write("0 0 0.001 0 0 1\n1 0 0.001 0 0 1\n")
dot = lambda a, b: sum(i * j for i, j in zip(a, b))
eye, ahead, right, up = (8, -8, 6), (-.64, .64, -.424), (.7071, .7071, 0), (-.3, .3, .906)
photo = "240,160\n"
for p in (5, 5, 0), (-5, 5, 0), (-5, -5, 0), (5, -5, 0), (.5, .5, 2), (-.5, -.5, 2):
    d = [a - b for a, b in zip(p, eye)]
    photo += "%g,%g,%g,%g,%g\n" % (120 + 150 * dot(d, right) / dot(d, ahead), 80 - 150 * dot(d, up) / dot(d, ahead), *p)
open("in/photo.csv", "w").write(photo)
for name, text in ("jpeg.mtl", "newmtl floor\nmap_Kd grey.jpg\n"), ("jpeg.obj",
        "mtllib jpeg.mtl\nv 0 0 0\nv 1 0 0\nv 1 0 1\nvt 0 0\nvt 1 0\nvt 1 1\nusemtl floor\nf 3/3 2/2 1/1\n"):
    open("in/" + name, "w").write(text)
zipfile.ZipFile(sys.argv[1] + "/shp/lamps.zip").extractall("in")
PY
cp "$seeds/ply/text.ply" "$seeds/cityjson/whole.json" "$seeds/tracks/small.gpx" "$seeds/ldt/0.ldt" \
    "$seeds/overpass/roads.json" "$seeds/terrain/floats.tif" "$seeds/pbf/lamps.pbf" "$seeds/fgb/lamps.fgb" \
    "$seeds/pixels/grey.jpg" in
python3 "$here/geopackage.py" in/lamps.gpkg plain
gzip -c in/city.gml >in/city.gml.gz
cp in/lamp.obj in/lamp.mtl in/floor.png .
"$program" build lamp.obj -q -o lamp.noct 2>err
"$program" build street.osm --map-surfaces -q -o street.noct 2>err
"$program" render lamp.noct -q --size 8x4 --frames 1 -o in/sky.exr
mode=+
built "OBJ, MTL, PNG, glTF, its buffer, and an environment light" in/lamp.obj in/lit.gltf --environment in/sky.hdr
built "PLY" in/text.ply
built "CityJSON" in/whole.json
built "CityGML in gzip, and a track" in/city.gml.gz in/small.gpx
built "EULUMDAT" "$here/city.gml" --lamp-profile in/0.ldt
built "a JPEG and an EXR" in/jpeg.obj --environment in/sky.exr
built "Overpass JSON" in/roads.json
faults "points of a photograph" made/x.exr render lamp.noct --photo-points in/photo.csv --size 24x16 --frames 1 \
    --threads 1 -o made/x.exr
if [ "$("$program" --version | grep -ci gdal)" != 0 ]; then
    built "a recipe, CityGML, GeoJSON and a luminaire file" in/city.yaml
    built "OpenStreetMap" in/map.osm
    built "OSM PBF" in/lamps.pbf
    built "a table of lamps" in/lamps.csv
    built "a GeoPackage" in/lamps.gpkg
    built "a Shapefile" in/lamps.shp
    built "FlatGeobuf" in/lamps.fgb
    built "a GeoTIFF of heights" in/floats.tif
    faults "a region of a file" made/x.csv influence street.noct --error 0.5 --threads 1 \
        --region polygon:in/area.geojson --csv made/x.csv
else
    skip "what GDAL reads, and a region of a file" "no GDAL"
fi
mode=
faults "a PNG" in/x.png render builtin:single --size 24x16 --frames 1 --threads 1 -o in/x.png
faults "a table of who lights a place" in/x.csv influence in/city.gml --error 0.3 --threads 1 --region object:house \
    --csv in/x.csv
faults "influence volumes as OBJ" in/x.obj render builtin:single --candidates influence --size 24x16 --frames 1 \
    --threads 1 -o away.png --influence-obj in/x.obj
quick="--sky 0 --error 0.5 --samples 16 --threads 1"
# shellcheck disable=SC2086 # options
faults "a raster of lux" in/x.tif measure lamp.noct $quick --grid 5 -o in/x.tif
# shellcheck disable=SC2086
faults "readings at points of a file" in/x.csv measure lamp.noct $quick --points in/points.txt -o in/x.csv
# shellcheck disable=SC2086
faults "figures of streets" in/x.geojson measure street.noct $quick --streets in/x.geojson
faults "an EXR, an HDR and their difference" in/x.png compare in/sky.exr in/sky.hdr -o in/x.png
faults "two PNG" made/x.png compare in/floor.png in/floor.png -o made/x.png
faults "a built city as it is written" in/x.noct build lamp.obj --threads 1 -o in/x.noct
"$program" build in/city.gml -q -o in/city.noct 2>err
faults "a built city, and an EXR" in/x.exr render in/city.noct --size 24x16 --frames 1 --threads 1 -o in/x.exr
# A film: it is whole or what was there, and so is each picture of those that stay beside it.
pictures="--animate --frames 2 --samples 1 --size 16x16 --threads 1"
if command -v ffmpeg >/dev/null; then
    mkdir films
    # shellcheck disable=SC2086 # options
    "$program" render lamp.noct -q $pictures --no-mp4 -o films/%d.png 2>err
    calls=0 i=0 why=
    while [ -z "$why" ] && [ "$i" -le "$calls" ]; do
        rm -rf in && mkdir in && echo old >in/x.mp4
        # shellcheck disable=SC2086
        failing "$i" report "$program" render lamp.noct $pictures -o in/x.mp4
        if [ "$i" = 0 ]; then
            calls=$(tail -n 1 report) && cp in/x.mp4 films && [ "$calls" -ge 20 ] || why="status $status, $calls calls"
        fi
        if [ $status = 0 ]; then
            cmp -s in/x.mp4 films/x.mp4 || why="another film, and no error"
        elif [ $status -gt 2 ] || ! grep -q '^nocturne: ' err; then
            why="status $status without an error"
        elif [ "$(cat in/x.mp4)" != old ]; then
            why="what was there is lost"
        fi
        for file in $(find in -type f ! -name x.mp4); do
            cmp -s "$file" "films/$(echo "$file" | tr -dc '12').png" || why="$why it leaves $file"
        done
        [ -z "$why" ] || why="$why: $i of $calls, $(head -n 1 report)"
        [ -n "${NOC_ALL_FAULTS:-}" ] && [ -n "$why" ] && echo "# film: $why" && why=
        i=$((i + 1))
    done
    [ -z "$why" ]; result $? "a film: $calls calls" "$why"
else
    skip "a film" "ffmpeg is not here"
fi
mkdir -p in
cp "$here/city.gml" in
# A recipe that init makes has its name when it is on the disk.
mkdir in/made
failing 0 report "$program" init in/made in/city.gml
calls=$(tail -n 1 report) why= synced=
[ $status = 0 ] && mv in/made/city.yaml made.yaml || why="status $status: $(cat err)"
i=1
while [ -z "$why" ] && [ "$i" -le "$calls" ]; do
    failing "$i" report "$program" init in/made in/city.gml
    case $(head -n 1 report) in fsync*city.yaml*) synced=1 ;; esac
    if [ $status = 0 ]; then
        cmp -s in/made/city.yaml made.yaml || why="another recipe, and no error"
    elif [ -n "$(ls -A in/made)" ] || ! grep -q '^nocturne: ' err; then
        why="status $status, it leaves $(ls -A in/made)"
    fi
    [ -z "$why" ] || why="$why: $i of $calls, $(head -n 1 report)"
    rm -f in/made/city.yaml
    i=$((i + 1))
done
[ -z "$why" ] && [ -n "$synced" ]; result $? "a recipe that is made: $calls calls" "${why:-it is not written through}"

# Rows of an experiment that goes on behind a row that was cut short: the run after the one that failed ends with each
# row once, and those that were there are there at any time.
cat >spec.json <<'SPEC'
{ "scene": { "name": "one", "inputs": ["builtin:single"] }, "cameras": [ { "name": "own", "view": "own" } ],
  "size": "16x9", "reference": { "rays": 1, "frames": 1 }, "frames": 1, "repetitions": 1, "shown": [],
  "configurations": [ { "name": "a" }, { "name": "b", "method": "is" } ] }
SPEC
mkdir after again
"$program" experiment spec.json -o all --cache cache -q >out 2>err
{ head -n 3 all/results.csv && sed -n 4p all/results.csv | head -c 40; } >start.csv
calls=0 i=0
while [ "$i" -le "$calls" ]; do
    rm -rf in && mkdir in && cp start.csv in/results.csv
    failing "$i" report "$program" experiment spec.json -o in --cache cache -q
    [ "$i" != 0 ] || calls=$(tail -n 1 report)
    cp in/results.csv "after/$i"
    { [ $status = 0 ] || { [ $status = 1 ] && grep -q '^nocturne: ' err; }; } && echo $status >"after/$i.status"
    "$program" experiment spec.json -o in --cache cache -q >out 2>err && cp in/results.csv "again/$i"
    i=$((i + 1))
done
python3 - "$calls" >why 2>&1 <<'PY'
import csv, sys
def rows(path):
    return list(csv.reader(open(path, newline="")))
header, *kept = rows("start.csv")[:3]
whole = [(c, mode) for c in "ab" for mode in ("accumulated", "alone")]
def is_whole(table):
    return sorted((r[2], r[4]) for r in table[1:]) == whole
assert int(sys.argv[1]) >= 20
for i in range(int(sys.argv[1]) + 1):
    first, last = rows(f"after/{i}"), rows(f"again/{i}")
    assert first[:3] == [header] + kept, f"{i}: a row is lost"
    assert open(f"after/{i}.status").read().strip() == "1" or is_whole(first), f"{i}: rows are missing without an error"
    assert all(last.count(r) == 1 for r in kept), f"{i}: a row is lost or doubled later"
    assert is_whole(last) and all(len(r) == len(header) for r in last), f"{i}: rows are not whole"
PY
[ ! -s why ]; result $? "rows of an experiment: $calls calls" "$(tail -n 1 why)"
finish
