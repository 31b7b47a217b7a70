#!/bin/sh
# Each opening, reading, writing, flushing and renaming of an input or output fails, in turn, in whichever process of
# the program it is, and of an input what is done to it from then on (fail_call.c). The program then ends with an error,
# leaves what stood in the output's place, and nothing else; or its output has the same numbers; or a warning names the
# file.
. "$(dirname "$0")/lib.sh"
here=$source_dir/tests/cli
fail_call=${NOC_FAIL_CALL:?names fail_call}
export ASAN_OPTIONS="${ASAN_OPTIONS:-}:detect_leaks=0" # which cannot be where a program is traced
mkdir in
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
equal='^  all pixels +[0-9]+ +0.000 +0 +0 '
# judge OUTPUT BEFORE: what is wrong after a call that failed
judge() {
    if [ $status = 0 ]; then
        warned="^nocturne: warning: .*$(head -n 1 report | sed 's|.*/||') cannot be read"
        grep -q "$warned" err || same "$1" || echo "another result, and no error"
    elif [ $status -gt 2 ] || ! grep -q '^nocturne: ' err; then
        echo "status $status without an error"
    elif [ "$(cat "$1")" != old ]; then
        echo "what was there is lost"
    elif [ "$(ls -A in)" != "$2" ]; then
        echo "it leaves $(ls -A in | tr '\n' ' ')"
    fi
}
# faults NAME OUTPUT ARGUMENT...
faults() {
    name=$1 output=$2 i=1 why=
    shift 2
    failing 0 report "$program" "$@"
    calls=$(tail -n 1 report)
    cp "$output" "whole.${output##*.}" && [ $status = 0 ] && [ "$calls" -ge 3 ] || why="status $status, $calls calls"
    while [ -z "$why" ] && [ "$i" -le "$calls" ]; do
        echo old >"$output"
        before=$(ls -A in)
        failing "$i$mode" report "$program" "$@"
        wrong=$(judge "$output" "$before")
        [ -z "$wrong" ] || why="$wrong: $i of $calls, $(head -n 1 report)"
        [ -n "${NOC_ALL_FAULTS:-}" ] && [ -n "$why" ] && echo "# $name: $why" && why=
        i=$((i + 1))
    done
    [ -z "$why" ]; result $? "$name: $calls calls" "$why"
}
# picture NAME INPUT...: of inputs
picture() {
    name=$1
    shift
    faults "$name" in/x.exr render "$@" --size 24x16 --frames 1 --threads 1 -o in/x.exr
}

cd "$work" || exit 1
cp "$here/city.gml" in
lamp_model && mv lamp.obj lamp.mtl in
python3 - <<'PY'
import base64, json, struct, zlib
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
open("in/city.yaml", "w").write("nocturne: 1\ninputs: [city.gml, lamps.geojson, map.osm]\nlamp-profile: down.ies\n")
PY
mode=+
picture "OBJ, MTL, PNG, glTF, its buffer, and an environment light" in/lamp.obj in/lit.gltf --environment in/sky.hdr
if [ "$("$program" --version | grep -ci gdal)" != 0 ]; then
    picture "a recipe, CityGML, GeoJSON, a map and a luminaire file" in/city.yaml
    python3 "$here/geopackage.py" in/lamps.gpkg plain
    picture "a GeoPackage and a table of lamps" in/lamps.gpkg in/lamps.csv
else
    skip "a recipe, CityGML, GeoJSON, a map and a luminaire file" "no GDAL"
    skip "a GeoPackage and a table of lamps" "no GDAL"
fi
mode=
faults "a PNG" in/x.png render builtin:single --size 24x16 --frames 1 --threads 1 -o in/x.png
faults "a table of who lights a place" in/x.csv influence in/city.gml --error 0.3 --threads 1 --region object:house \
    --csv in/x.csv
faults "influence volumes as OBJ" in/x.obj render builtin:single --candidates influence --size 24x16 --frames 1 \
    --threads 1 -o away.png --influence-obj in/x.obj
"$program" build in/city.gml -q -o in/city.noct 2>err
picture "a built city" in/city.noct
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
